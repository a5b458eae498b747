"""What the system knows of loads on several lines."""

from __future__ import annotations

from collections.abc import Iterator

from ropewalk.model._base import Finding
from ropewalk.model.law import Inextensible
from ropewalk.model.missing import missing
from ropewalk.model.parts import Parts
from ropewalk.model.run import HIGH_ORDER, Dynamic
from ropewalk.model.trolley import Trolley

_WHAT = "loads on several lines"


def of_several_lines(parts: Parts) -> Iterator[Finding]:
    """They roll by plain steps; at rest nobody rolls their wheels but the start of a motion."""
    run = parts.run
    for name, load in parts.loads.items():
        if not isinstance(load, Trolley) or not load.also_on:
            continue
        if load.lift_off:
            yield missing(("loads", name, "lift_off"), _WHAT, "true", "leave it out: lifting makes the run doubtful")
        for key in load.lines:
            line = parts.lines.get(key)
            for block in ("sheaves", "cut") if line is not None else ():
                if getattr(line, block):
                    yield missing(("lines", key, block), _WHAT, "a block", f"leave {block} out")
            if line is not None and isinstance(line.law, Inextensible):
                remedy = "give an axial_stiffness with law hooke"
                yield missing(("lines", key, "law", "kind"), _WHAT, "inextensible", remedy)
        if not isinstance(run, Dynamic):
            remedy = "write kind: dynamic with start: {with_loads: true}; its first instant is the equilibrium"
            yield missing(
                ("loads", name, "also_on"), "all but motions", remedy=remedy, feature="a load on several lines"
            )
            continue
        if run.geometry == "linearised":
            yield missing(("run", "geometry"), _WHAT, "linearised", "write geometry: nonlinear")
        if run.method in HIGH_ORDER:
            yield missing(("run", "method"), _WHAT, run.method, "use auto or verlet")
        if run.window is not None:
            yield missing(("run", "window"), _WHAT, "a window", "leave it out")
