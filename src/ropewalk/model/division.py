"""How many links a line has: as many as are asked for, or some more where inner supports are to stand at nodes."""

from __future__ import annotations

from collections.abc import Iterable

from ropewalk.model.line import Line

_CLOSE = 1e-9  # of all links, by which a support may be off a node


def links_of_line(line: Line, joined: Iterable[float] = ()) -> int:
    """Number of equal links of a line: the fewest with nodes at its inner supports, or `elements` where none fits.

    Args:
        line: of given length, or without inner supports.
        joined: m along the line, where others are joined to it.
    """
    if not line.supports or line.length is None:
        return line.elements
    parts = [at / line.length for at in (*(support.at for support in line.supports.values()), *joined)]
    for links in range(max(line.elements, 2), 2 * max(line.elements, 2) + 1):
        if all(abs(part * links - round(part * links)) <= _CLOSE * links for part in parts):
            return links
    return line.elements
