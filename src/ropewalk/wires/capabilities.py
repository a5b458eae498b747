"""What the engine of lines with bending stiffness, lines on foundations and overhead lines supports."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ropewalk.model._base import Finding
from ropewalk.model.capabilities import WITHOUT_KIND, Capabilities, supported_by_tension
from ropewalk.model.history import rows
from ropewalk.model.load import ExternalModel, MovingForce
from ropewalk.model.mass import MovingMass
from ropewalk.model.matrices import Matrices
from ropewalk.model.missing import missing
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.parts import Parts
from ropewalk.model.run import Dynamic, common_interval, every_of
from ropewalk.model.small import check_small
from ropewalk.model.travel import Travel
from ropewalk.model.vehicle import Vehicle

_BEAMS = "beams, lines on foundations and overhead lines"
_Borne = MovingForce | MovingMass | Oscillator | Vehicle | Matrices
_LONGEST = 1e4  # s between two outputs: ten million samples
_AT_REST = ("force", "axles", "mass", "oscillator", "vehicle", "train", "matrices", "pantograph")


def _in_the_plane(parts: Parts) -> Iterator[Finding]:
    """What moves or acts across the x-z plane, or along the line."""
    for name, line in parts.lines.items():
        if line is not None and any(len(point) == 3 and point[1] != 0.0 for point in (line.start, line.end)):
            feature, remedy = "a line outside the x-z plane", "write [x, z]"
            yield missing(("lines", name, "start"), _BEAMS, "a point with y", remedy, feature=feature)
    for name, load in parts.loads.items():
        if isinstance(load, MovingForce | MovingMass):
            force = load.force
            if callable(force) or any(any(row[:-1]) for row in rows(force)):
                feature, remedy = "a force that is not vertical", "write [0, Fz], or a table of such"
                yield missing(("loads", name, "force"), _BEAMS, "another force", remedy, feature=feature)
        if isinstance(load, Oscillator):
            for key in ("stiffness", "damping"):
                if isinstance(values := getattr(load, key), tuple):
                    feature, remedy = "a spring or damper that is not vertical", f"write {values[-1]:g}"
                    yield missing(("loads", name, key), _BEAMS, str(list(values)), remedy, feature=feature)
    start = parts.run.start if isinstance(parts.run, Dynamic) else None
    if start is not None and start.direction is not None and len(start.direction) == 3 and start.direction[1]:
        given, remedy = str([float(value) for value in start.direction]), "write [x, z], or leave it out"
        feature = "a mode outside the x-z plane"
        yield missing(("run", "start", "direction"), _BEAMS, given, remedy, feature=feature)


def _of_loads(parts: Parts) -> Iterator[Finding]:
    for name, load in parts.loads.items():
        if isinstance(load, _Borne) and isinstance(load.travel, Travel) and load.travel.at_end == "stay":
            remedy = "write leave, or end the run before"
            yield missing(("loads", name, "travel", "at_end"), _BEAMS, "stay", remedy)
        if isinstance(load, Matrices) and load.has_gyroscopic_damping:
            feature, given = "gyroscopic damping", "a matrix that is not symmetric"
            yield missing(("loads", name, "damping"), _BEAMS, given, "make it symmetric", feature=feature)


def _of_the_run(parts: Parts) -> Iterator[Finding]:
    run, own = parts.run, {name: load for name, load in parts.loads.items() if isinstance(load, ExternalModel)}
    if not isinstance(run, Dynamic):
        return
    if run.accuracy is not None and not run.finds_window:
        remedy = "write step, or window: auto" if parts.overhead else "write step, or leave accuracy out"
        yield missing(("run", "accuracy"), _BEAMS, f"{run.accuracy:g} m", remedy)
    if run.window is not None and run.start.kind != "rest":  # which moves what is far from the contacts, too
        feature, remedy = f"a window with start.kind: {run.start.kind}", "leave window out, or start from equilibrium"
        yield missing(("run", "window"), _BEAMS, run.written_window, remedy, feature=feature)
    if (every := every_of(run)) > _LONGEST:
        what = "is too long: contact forces of every millisecond in between are kept"
        yield Finding(("run", "every"), what, f"{every:g} s", f"write {_LONGEST:g} s or less")
    if common_interval([every_of(run), *(load.every for load in own.values())]) is None:
        (name, load), *_ = own.items()
        feature = f"an interval without a common part with run.every, {every_of(run):g} s,"
        remedy = "let run.every be a whole multiple of it"
        yield missing(("loads", name, "every"), _BEAMS, f"{load.every:g} s", remedy, feature=feature)


def _on_inner_supports(parts: Parts) -> Iterator[Finding]:
    """Masses there are spread over the nodes of a spline: the reaction is not told from their weight and inertia.

    A window that comes to a rigid one or leaves it does not keep the energy.
    """
    run = parts.run
    if parts.is_supported and isinstance(run, Dynamic) and run.window is not None:
        feature, remedy = "a window on lines with inner supports", "leave window out"
        yield missing(("run", "window"), _BEAMS, run.written_window, remedy, feature=feature)
    for name, line in parts.lines.items():
        for key, support in line.supports.items() if line is not None else ():
            if mass := getattr(support, "mass", 0.0):
                remedy = "leave it out, or ask for kind: dynamic with geometry: nonlinear"
                path, feature = ("lines", name, "supports", key, "mass"), "a mass on an inner support"
                yield missing(
                    path, "statics, spectrum and linearisation of beams", f"{mass:g} kg", remedy, feature=feature
                )


MOTION = Capabilities(
    _BEAMS,
    only={
        "run.method": ("auto", "explicit", "verlet"),  # Störmer's is Verlet's
        "run.start.whirl": (False,),
        "lines.law.kind": ("hooke",),
        "lines.axial_damping": (0.0,),
        "loads.kind": (*_AT_REST, "stepper", "fmu"),
        "loads.travel.kind": ("prescribed",),
        "loads.travel.measured": ("material", "horizontal"),
        "loads.travel.margin": (None,),
        "loads.contact": ("clamped",),
        "loads.friction": (None,),
        "loads.friction_model": ("capstan",),
        "loads.air_drag": (0.0,),
    },
    instead={
        "lines.law.kind": "leave law out",
        "lines.axial_damping": "leave it out, or use drag",
        "loads.travel.kind": "give a speed",
    },
    more=(check_small, _in_the_plane, _of_loads, _of_the_run, _on_inner_supports, supported_by_tension),
)
AT_REST = replace(
    MOTION,
    what="equilibria and quasi-static runs of beams, lines on foundations and overhead lines",
    only={**MOTION.only, "run.accuracy": (None,), "loads.kind": _AT_REST},
    instead={**MOTION.instead, "loads.kind": WITHOUT_KIND},
)
