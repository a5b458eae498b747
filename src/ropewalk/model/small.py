"""What overhead lines and pantographs need, and what small motion about a straight line cannot be about."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ropewalk.model._base import Finding
from ropewalk.model.history import rows
from ropewalk.model.inner_support import InnerSupport
from ropewalk.model.line import SHORTEST, Line
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.parts import Parts
from ropewalk.model.run import Dynamic, Linear
from ropewalk.model.support import Fixed, Guided

# Euler's load of a strut over that on hinges, with none, one and both of its ends clamped.
_BUCKLES = (1.0, 2.0457, 4.0)
_LEVEL = 1e-9  # slope of a line that is level
_Lack = tuple[tuple[str, ...], str, str, str]


def check_overhead(parts: Parts) -> Iterator[Finding]:
    """Find pantographs off overhead lines, and overhead lines without weight."""
    for name, load in parts.loads.items():
        if isinstance(load, Pantograph) and load.on in parts.lines:
            remedy = f"name one of overhead_lines: {', '.join(parts.overhead) or 'there are none'}"
            yield Finding(("loads", name, "on"), "a pantograph runs under an overhead line", repr(load.on), remedy)
    if parts.gravity == 0.0 and parts.overhead and not isinstance(parts.run, Linear):
        yield Finding(("gravity",), "an overhead line hangs by its weight", "0 m/s^2", "leave gravity out")


def check_small(parts: Parts) -> Iterator[Finding]:
    """Find lines that are not straight enough, or whose tensions change, in linearised motion."""
    if not isinstance(parts.run, Dynamic) or parts.run.geometry != "linearised" or not parts.has_bending_stiffness:
        return
    for name, line in parts.lines.items():
        for key, wrong, given, remedy in _slack(line) if line is not None else ():
            yield Finding(("lines", name, *key), f"in linearised motion {wrong}", given, remedy)


def _slack(line: Line) -> Iterator[_Lack]:
    """What linearised motion about a straight line cannot be about: a line that is slack, or buckles."""
    supports = [support for _, support in line.ends()]
    if line.distance < SHORTEST:
        remedy = "write run.geometry: nonlinear, or other ends"
        yield ("end",), "it is about the straight line from start to end, which coincide", "", remedy
        return
    yield from _constant(line)
    if line.length is None or not line.axial_stiffness or not all(isinstance(support, Fixed) for support in supports):
        return
    if line.supports:  # at which load such a line buckles is found when it rests
        return
    push = line.axial_stiffness * (1.0 - line.distance / line.length)
    clamped = sum(isinstance(support, Fixed) and support.clamped for support in supports)
    limit = _BUCKLES[clamped] * line.bending_stiffness * (math.pi / line.distance) ** 2
    given, remedy = f"{line.length:g} m over {line.distance:g} m", "write run.geometry: nonlinear, or give tension"
    if not line.bending_stiffness and push >= 0.0:
        yield ("length",), "a line without bending_stiffness needs a tension", given, f"{remedy}, or less length"
    elif line.bending_stiffness and not line.foundation and push >= limit:
        wrong = f"a line longer than its chord is a strut, and this one buckles at {limit:.4g} N; it bears {push:.4g} N"
        yield ("length",), wrong, given, remedy


def _constant(line: Line) -> Iterator[_Lack]:
    """Supports that would change the tension to the first order, which linearised motion has constant."""
    level, constant = abs(line.start[-1] - line.end[-1]) <= _LEVEL * line.distance, "tensions are constant"
    inner = tuple((("supports", name), support) for name, support in line.supports.items())
    for key, support in (*(((key,), support) for key, support in line.ends()), *inner):
        slides = isinstance(support, Guided) and not support.along[-1]
        if isinstance(support, Guided) and support.along[0] and support.along[-1]:
            wrong = f"{constant}, and an end on an inclined rail changes them"
            yield (*key, "along"), wrong, str(list(support.along)), "write [1, 0] or [0, 1], or geometry: nonlinear"
        elif not (level or slides or isinstance(support, Fixed)):
            wrong = f"{constant}, and an end of an inclined line that moves up and down stretches it"
            yield key, wrong, support.kind, "write run.geometry: nonlinear, or kind: fixed"
        history = getattr(support, "displacement", (0.0, 0.0))
        if len({row[0] for row in rows(history)}) > 1:  # callables are looked at when they are tabulated
            remedy = "write a table with constant x, or geometry: nonlinear"
            yield (*key, "displacement"), f"{constant}, and a support that moves along x changes them", "", remedy
    for name, restrained in line.supports.items():
        for own, wrong, given, remedy in _restrained(line, restrained):
            yield ("supports", name, *own), f"{constant}, and {wrong}", given, remedy


def _restrained(line: Line, support: InnerSupport) -> Iterator[_Lack]:
    """What makes an inner support that holds its line along it change the tension there."""
    if isinstance(support, Guided) and not support.along[-1]:
        if support.force:
            wrong, remedy = "a support that pulls along the line changes them", "leave it out, or geometry: nonlinear"
            yield ("force",), wrong, f"{support.force:g} N", remedy
        return
    if line.length is None:
        return
    remedy = "write kind: guided with along: [1, 0], or geometry: nonlinear"
    history = getattr(support, "displacement", (0.0, 0.0))
    moved = float(history(0.0)[0]) if callable(history) else rows(history)[0][0]
    x, straight = line.place_of(support, line.length)[0] + moved, line.start[0]
    straight += support.at / line.length * (line.end[0] - line.start[0])
    if abs(x - straight) > _LEVEL * line.distance:
        yield (), "a support off the place that the straight line has there changes them", f"x = {x:g} m", remedy
    elif not all(isinstance(end, Fixed) for _, end in line.ends()):
        yield (), "one that holds the line along it, between ends that yield, changes them", support.kind, remedy
