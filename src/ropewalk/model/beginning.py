"""The beginning of a motion: what of it does not go with the lines."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ropewalk.errors import did_you_mean
from ropewalk.model._base import Finding
from ropewalk.model.line import spatial
from ropewalk.model.parts import Parts
from ropewalk.model.run import Dynamic

UP = (0.0, 1.0)
"""The direction of a mode where none is given."""


def check_beginning(parts: Parts) -> Iterator[Finding]:
    """Find problems of a start from a mode."""
    if not isinstance(parts.run, Dynamic) or parts.run.start.kind != "mode":
        return
    start = parts.run.start
    known = [*parts.lines, *parts.overhead]
    if start.line is not None and start.line not in known:
        remedy = did_you_mean(start.line, known, otherwise=f"lines here: {', '.join(known)}")
        yield Finding(("run", "start", "line"), "no such line", repr(start.line), remedy)
        return
    for name, line in parts.lines.items():
        if line is None or start.line not in (None, name):
            continue
        number = start.number or 1
        if number >= line.elements:
            wrong = f"{name} has {line.elements} elements, and its nodes cannot show so many half waves"
            remedy = f"write at most {line.elements - 1}, better a tenth of it, or raise elements"
            yield Finding(("run", "start", "number"), wrong, str(number), remedy)
        if start.amplitude is not None and start.amplitude > line.distance:
            wrong, remedy = f"the ends of {name} are only {line.distance:g} m apart", "write a smaller one"
            yield Finding(("run", "start", "amplitude"), wrong, f"{start.amplitude:g} m", remedy)
        if parts.is_network:  # what moves in the direction is seen when modes are known
            continue
        chord = np.subtract(spatial(line.end), spatial(line.start))
        given = start.direction or UP
        across = np.linalg.norm(np.cross(chord, spatial(given)))
        if across <= 1e-9 * np.linalg.norm(chord) * np.linalg.norm(given):
            key = ("run", "start", "direction") if start.direction is not None else ("run", "start")
            example = "[0, 1]" if chord[0] or chord[1] else "[1, 0]"
            remedy = f"write one across the line, for example {example}"
            text = str([float(value) for value in given])
            yield Finding(key, f"the direction has no part across {name}", text, remedy)
