"""What of lines over sheaves, and of loads on them, is not supported."""

from __future__ import annotations

from collections.abc import Iterator

from ropewalk.model._base import Finding
from ropewalk.model.axles import Axles
from ropewalk.model.capabilities import WITHOUT_KIND
from ropewalk.model.joint import Joined
from ropewalk.model.law import Inextensible
from ropewalk.model.line import Line
from ropewalk.model.load import MovingForce
from ropewalk.model.mass import MovingMass
from ropewalk.model.matrices import Matrices
from ropewalk.model.missing import missing
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.parts import Parts
from ropewalk.model.run import HIGH_ORDER, Dynamic, Linear
from ropewalk.model.trolley import Trolley
from ropewalk.model.vehicle import Vehicle

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


_KNOWN = Axles | MovingForce | MovingMass | Oscillator | Trolley | Vehicle | Matrices


def over_sheaves(name: str, line: Line, parts: Parts) -> Iterator[Finding]:
    """Lines bend sharply at sheaves, which have no size; results do not hold how far they have run over these."""
    what, run = "lines over sheaves", parts.run
    for key in ("bending_stiffness", "foundation"):
        if getattr(line, key):
            yield missing(("lines", name, key), what, str(getattr(line, key)), f"leave {key} out")
    for sheave, wheel in line.sheaves.items():
        if wheel.to is not None and wheel.to in parts.joints and not _has_mass(wheel.to, parts):
            remedy = f"give joints.{wheel.to} a mass"
            feature = "a joint without mass that hangs on sheaves alone"
            yield missing(("lines", name, "sheaves", sheave, "to"), what, wheel.to, remedy, feature=feature)
    if isinstance(run, Dynamic) and run.start.kind == "result":  # results do not hold where sheaves are that move
        for sheave, wheel in line.sheaves.items():
            if wheel.to is not None and not _ends_at(wheel.to, parts):
                path, remedy = (
                    ("lines", name, "sheaves", sheave, "to"),
                    f"start from equilibrium, or let a line end at {wheel.to}",
                )
                feature = "a sheave on a joint at which no line ends, not stored in results,"
                yield missing(path, "runs that begin from a result", wheel.to, remedy, feature=feature)


def beside_sheaves(parts: Parts) -> Iterator[Finding]:
    """At rest lines are divided at their sheaves, and where loads stand."""
    what = "equilibria of lines over sheaves"
    if isinstance(parts.run, Dynamic | Linear) or not parts.runs_over_sheaves:
        return
    for name, load in parts.loads.items():
        if load is None:
            continue
        line = parts.lines.get(load.on)
        if load.on in parts.nets or (line is not None and line.has_bending_stiffness):
            feature, remedy = "a load on a net or a line with bending stiffness", "let it travel on a rope"
            yield missing(("loads", name, "on"), what, load.on, remedy, feature=feature)
        if not isinstance(load, _KNOWN):
            yield missing(("loads", name, "kind"), what, load.kind, WITHOUT_KIND)
        for key, least in (("lift_off", False), ("air_drag", 0.0)):
            if (given := getattr(load, key, least)) != least:
                yield missing(("loads", name, key), what, str(given), f"leave {key} out")


def _has_mass(joint: str, parts: Parts) -> bool:
    """Whether a joint has a mass, or an end of a line."""
    return _ends_at(joint, parts) or bool(getattr(parts.joints[joint], "mass", 1.0))


def _ends_at(joint: str, parts: Parts) -> bool:
    """Whether a line ends at a joint."""
    ends = (support for line in parts.lines.values() if line is not None for _, support in line.ends())
    return any(isinstance(support, Joined) and support.to == joint for support in ends)
