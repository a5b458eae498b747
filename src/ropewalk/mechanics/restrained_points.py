"""Where a line is held: at its ends, and at its inner supports."""

from __future__ import annotations

from collections.abc import Iterator

from ropewalk.model.inner_support import InnerSupport
from ropewalk.model.line import Line, spatial
from ropewalk.model.support import Support


def supports_of(
    line: Line, length: float
) -> Iterator[tuple[str, tuple[float, float, float], Support | InnerSupport, float]]:
    """All supports of a line of an unstrained length in m: name, place [x, y, z] in m, support, and where along it, m.

    Those of its ends come first.
    """
    yield "start", spatial(line.start), line.start_support, 0.0
    yield "end", spatial(line.end), line.end_support, length
    for name, support in line.supports.items():
        yield name, line.place_of(support, length), support, support.at
