"""What the engine of cable runs and joints supports."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

from ropewalk.model._base import Finding
from ropewalk.model.capabilities import (
    LAWS_OF_STRAIN,
    OF_LINEAR_THEORY,
    STATIC_LOADS,
    WITHOUT_KIND,
    Capabilities,
    supported_by_tension,
    without_retardation,
)
from ropewalk.model.division import links_of_line
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.history import rows
from ropewalk.model.joint import Joined
from ropewalk.model.law import Inextensible
from ropewalk.model.line import Line
from ropewalk.model.load import ExternalModel, MovingForce
from ropewalk.model.mass import MovingMass
from ropewalk.model.matrices import Matrices
from ropewalk.model.mean_speed import MeanSpeed
from ropewalk.model.missing import missing
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.overlap import course_of
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.parts import Parts
from ropewalk.model.run import HIGH_ORDER, Dynamic, Linear, Quasistatic
from ropewalk.model.support import Fixed, Moving
from ropewalk.model.travel import FreeTravel
from ropewalk.model.vehicle import Vehicle
from ropewalk.model.walker import Walker
from ropewalk.system.lines_over_sheaves import beside_sheaves, of_several_lines, over_sheaves
from ropewalk.system.methods import of_methods

_BY_PANTOGRAPHS = "pantographs of the sixth order, implicitly, that whirl or in linear theory"
_SYSTEM = "joined lines, nets, lines on inner supports, lines in wind and lines with bending stiffness"


def _only_lines(parts: Parts) -> Iterator[Finding]:
    run = parts.run
    for name, line in parts.lines.items():
        if line is not None and line.segments:
            yield from _of_segments(name, line)
        if line is not None and line.cut is not None:
            yield from _of_cuts(name, line, run)
        if line is not None and line.hysteresis is not None:
            yield from _of_hysteresis(name, line, run)
        if line is not None:
            yield from _of_winches(name, line, run)
        if line is not None and line.sheaves:
            yield from over_sheaves(name, line, parts)
        if line is not None and line.saddles:
            yield from _over_saddles(name, line, parts)


def _overhead(parts: Parts) -> Iterator[Finding]:
    """Overhead lines move by themselves, from rest; other ways of theirs are known to another engine."""
    run, what = parts.run, "overhead lines together with such loads, travel or methods"
    if not parts.overhead:
        return
    if parts.lines or parts.nets:
        yield missing(("overhead_lines",), _SYSTEM, remedy="compute them in a scenario of their own")
    if not isinstance(run, Dynamic | Linear):
        yield missing(("overhead_lines",), _SYSTEM, remedy="ask for kind: dynamic", feature="rest")
        return
    if isinstance(run, Linear):
        yield from _overhead_in_modes(parts)
    elif run.start.kind == "result":
        yield missing(("run", "start", "kind"), what, run.start.kind, "start from equilibrium, or from a mode")
    for name, line in parts.overhead.items():
        if line is None:
            continue
        for key in ("strength", "cut"):
            failing = getattr(line.droppers, key) is not None
            if failing and isinstance(run, Dynamic) and run.window is not None:
                path, feature = ("overhead_lines", name, "droppers", key), "a dropper that fails"
                yield missing(path, "motions in a window", remedy="leave run.window out", feature=feature)
        for key in ("contact_wire", "messenger_wire"):
            if late := getattr(line, key).retardation:
                remedy = "leave retardation out, or use drag"
                yield missing(("overhead_lines", name, key, "retardation"), what, f"{late:g} s", remedy)


def _overhead_in_modes(parts: Parts) -> Iterator[Finding]:
    """What has other modes afterwards, and what goes over from one wire to another, is no superposition."""
    for name, line in parts.overhead.items():
        for key in ("strength", "cut"):
            if line is not None and getattr(line.droppers, key) is not None:
                wrong = "a line has other modes after a dropper fails: no superposition"
                path, remedy = ("overhead_lines", name, "droppers", key), f"leave {key} out, or {_DYNAMIC}"
                yield Finding(path, wrong, remedy=remedy)
    for name, load in parts.loads.items():
        if isinstance(load, Pantograph) and load.on in parts.overhead and len(course_of(parts.overhead, load.on)) > 1:
            wrong = "a pantograph passes from one contact wire to the next, and leaves the first"
            remedy = f"{_DYNAMIC}, or leave overlap out"
            yield Finding(("loads", name, "on"), wrong, load.on, remedy)


def _of_pantographs(parts: Parts) -> Iterator[Finding]:
    """Heads that roll have other levers from place to place, and irregularities jump in slope."""
    for name, load in parts.loads.items():
        if not isinstance(load, Pantograph) or load.on not in parts.overhead:
            continue
        if load.irregularity is not None:
            remedy = "leave irregularity out, or method and start of the run"
            yield missing(("loads", name, "irregularity"), _BY_PANTOGRAPHS, remedy=remedy)
        if load.head is not None and load.head.roll is not None:
            yield missing(("loads", name, "head", "roll"), _BY_PANTOGRAPHS, "a block", "leave roll out")


def _over_profiles(parts: Parts) -> Iterator[Finding]:
    """What does not follow the profile of its line, although it would feel it."""
    for name, line in parts.lines.items():
        if line is None or line.profile is None:
            continue
        path = ("lines", name, "profile")
        if isinstance(line.law, Inextensible):
            yield missing(path, "inextensible lines", remedy="leave profile out, or give an axial_stiffness")
        if line.sheaves:
            yield missing(path, "lines over sheaves", remedy="leave profile out")


def _of_segments(name: str, line: Line) -> Iterator[Finding]:
    """The pieces of a line at its sheaves, and the steps of one that does not stretch, know one mass per length."""
    path = ("lines", name, "segments")
    if line.sheaves:
        yield missing(path, "lines over sheaves", ", ".join(line.segments), "leave segments out, or end the line there")
    if isinstance(line.law, Inextensible):
        yield missing(path, "inextensible lines", ", ".join(line.segments), "give an axial_stiffness with law hooke")


def _of_cuts(name: str, line: Line, run: object) -> Iterator[Finding]:
    """Parts of a cut line fly wherever they are pulled, which only a motion with all geometry by steps shows."""
    path, what = ("lines", name, "cut"), "a cut line"
    for key in ("bending_stiffness", "foundation", "sheaves", "saddles", "profile", "segments"):
        if value := getattr(line, key):
            given = f"{value:g}" if isinstance(value, float) else "a block"
            yield missing(("lines", name, key), what, given, f"leave {key} out, or cut another line")
    if isinstance(line.law, Inextensible):
        yield missing(("lines", name, "law", "kind"), what, "inextensible", "give an axial_stiffness with law hooke")
    if not isinstance(run, Dynamic):
        yield missing(path, "all but motions", "a block", _DYNAMIC, feature="a cut")
        return
    if run.start.kind == "result":
        remedy = "start from equilibrium, or from a mode"
        yield missing(path, "runs that begin from a result", "a block", remedy, feature="a cut")
    if run.geometry == "linearised":
        yield missing(("run", "geometry"), what, "linearised", "write geometry: nonlinear")
    yield from _by_steps(run, what)


def _of_winches(name: str, line: Line, run: object) -> Iterator[Finding]:
    """At rest a winch is the force that it is set to; in motion its dead band rubs, and its speed is bounded."""
    for end in line.winches:
        path = ("lines", name, end, "winch")
        if isinstance(run, Linear):
            remedy = f"{_DYNAMIC}, also with geometry: linearised"
            yield Finding(path, "a winch that stands within its dead band is no linear spring", "a block", remedy)
        winch = getattr(getattr(line, end), "winch", None)
        if isinstance(run, Quasistatic) and winch is not None and winch.dead_band:
            wrong = "within its dead band the position of a winch depends on the history"
            yield Finding((*path, "dead_band"), wrong, f"{winch.dead_band:g} N", f"leave dead_band out, or {_DYNAMIC}")
        if isinstance(run, Dynamic):
            yield from _by_steps(run, "lines that a winch pulls at")


def _of_hysteresis(name: str, line: Line, run: object) -> Iterator[Finding]:
    """A first equilibrium is on the curve of loading; from there on it is the history of strain that decides."""
    path, what = ("lines", name, "hysteresis"), "lines with hysteresis"
    two = "has no linearised motion: the stiffness differs between loading and unloading"
    if line.sheaves:
        yield missing(("lines", name, "sheaves"), what, remedy="end the line at the sheave, or leave hysteresis out")
    if isinstance(run, Linear):
        yield Finding(path, two, "a block", f"leave it out, or {_DYNAMIC}")
    if not isinstance(run, Dynamic):
        return
    if run.start.kind == "result":  # which does not hold how far its links have been let off
        yield missing(path, "runs that begin from a result", "a block", "start from equilibrium", feature="hysteresis")
    if run.geometry == "linearised":
        yield Finding(path, two, "a block", "leave it out, or write geometry: nonlinear")
    yield from () if run.geometry == "linearised" else _all_of_it(run, what, inertia=True)


def _by_steps(run: Dynamic, what: str) -> Iterator[Finding]:
    """What moves by plain steps with its own inertia, all of it."""
    if run.method in HIGH_ORDER:
        yield missing(("run", "method"), what, run.method, "use auto or verlet")
    yield from _all_of_it(run, what)


def _all_of_it(run: Dynamic, what: str, *, inertia: bool = False) -> Iterator[Finding]:
    """What moves with its own inertia, all of it."""
    if run.window is not None:
        yield missing(("run", "window"), what, "a window", "leave it out")
    if run.axial_inertia != 1.0 and not inertia:
        yield missing(("run", "axial_inertia"), what, f"{run.axial_inertia:g}", "leave it out")


def _over_saddles(name: str, line: Line, parts: Parts) -> Iterator[Finding]:
    """Lines lie on saddles by what their links stretch, and rub there in motion."""
    what, run = "lines over saddles", parts.run
    if line.foundation:
        yield missing(("lines", name, "foundation"), what, f"{line.foundation:g}", "leave foundation out")
    if isinstance(line.law, Inextensible):
        yield missing(("lines", name, "law", "kind"), what, "inextensible", "give an axial_stiffness with law hooke")
    if isinstance(run, Dynamic) and run.start.kind == "result":
        for saddle, own in line.saddles.items():
            if not isinstance(own.support, Fixed):  # results do not hold where it stands
                path, remedy = ("lines", name, "saddles", saddle, "support"), "start from equilibrium, or fix saddles"
                yield missing(path, "runs that begin from a result", own.support.kind, remedy)


def between_nodes(name: str, elements: int) -> Finding:
    """Say that something is joined between nodes to a line that bends there, or holds it."""
    feature = "a line joined between two nodes of another, or an inner support there,"
    remedy = "choose elements so that one of its nodes is there"
    return missing(("lines", name, "elements"), "lines with bending stiffness", str(elements), remedy, feature=feature)


def _inextensible(parts: Parts) -> Iterator[Finding]:
    """What moves inextensible lines has no stiffness beside their tension, and begins at the rest of lines alone."""
    run, what = parts.run, "inextensible lines"
    found = [name for name, line in parts.lines.items() if line is not None and isinstance(line.law, Inextensible)]
    for name in found:
        line = parts.lines[name]
        if line is not None and line.sheaves:
            yield missing(("lines", name, "sheaves"), what, remedy="end the line at the sheave, or give it a law")
        for key in ("bending_stiffness", "foundation"):
            if line is not None and getattr(line, key):
                remedy = f"leave {key} out, or give an axial_stiffness with law hooke"
                yield missing(("lines", name, key), what, f"{getattr(line, key):g}", remedy)
    if not found or not isinstance(run, Dynamic):
        return
    alone = len(found) == len(parts.lines) and not parts.nets
    if alone and run.axial_inertia != 1.0:
        wrong = "lines that do not stretch have no waves along them that could be slower"
        yield Finding(("run", "axial_inertia"), wrong, f"{run.axial_inertia:g}", "leave it out")
    elif run.axial_inertia != 1.0:
        yield missing(("run", "axial_inertia"), what, f"{run.axial_inertia:g}", "leave it out")
    if run.window is not None:
        wrong = "a line that does not stretch passes tension on at once, and nothing of it stands still beyond a window"
        remedy = "leave window out, or give an axial_stiffness with law hooke"
        yield Finding(("run", "window"), wrong, run.written_window, remedy)
    for name, load in parts.loads.items():
        travel = getattr(load, "travel", None)
        if not isinstance(travel, FreeTravel):
            continue
        if run.start.with_loads:
            feature, remedy = "a load that travels freely from rest on them", "leave with_loads out"
            yield missing(("loads", name, "travel", "kind"), what, "free", remedy, feature=feature)


def _joined_between_nodes(parts: Parts) -> Iterator[Finding]:
    for name, line in parts.lines.items():
        if line is None or not line.bending_stiffness:
            continue
        length, joined = line.length or line.distance, list(_joined_to(name, parts))
        links = links_of_line(line, joined)
        for at in (*joined, *(support.at for support in line.supports.values())):
            if abs(at / length * links - round(at / length * links)) > 1e-9 * links:
                yield between_nodes(name, line.elements)


def _joined_to(name: str, parts: Parts) -> Iterator[float]:
    """Where along a line others are joined to it, m."""
    for other in parts.lines.values():
        for _, support in other.ends() if other is not None else ():
            if isinstance(support, Joined) and support.to == name and isinstance(support.at, float):
                yield support.at


def _accuracy(parts: Parts) -> Iterator[Finding]:
    """Verlet's steps are as long as they are stable; what that makes of the accuracy is not known."""
    run = parts.run
    if isinstance(run, Dynamic) and run.accuracy is not None and run.method not in HIGH_ORDER:
        remedy = "write method: rkn6 or implicit, or step, or leave accuracy out"
        yield missing(("run", "accuracy"), f"{_SYSTEM} by Verlet's method", f"{run.accuracy:g} m", remedy)


def _of_loads(parts: Parts) -> Iterator[Finding]:
    for name, load in parts.loads.items():
        start = parts.run.start if isinstance(parts.run, Dynamic) else None
        contact = load.contact if isinstance(load, MovingForce | MovingMass) else "clamped"
        if contact != "clamped" and start is not None and start.with_loads:
            kind = "frictionless contact" if contact == "frictionless" else f"contact of kind {contact}"
            feature, remedy = f"rest with a {kind}", "leave with_loads out, or write clamped"
            yield missing(("run", "start", "with_loads"), _SYSTEM, "true", remedy, feature=feature)
        if isinstance(load, Walker | ExternalModel) and start is not None and start.with_loads:
            feature, remedy = f"rest with a load of kind {load.kind}", "leave with_loads out"
            yield missing(("run", "start", "with_loads"), _SYSTEM, "true", remedy, feature=feature)
        if isinstance(load, Footsteps) and load.balance is not None and start is not None and start.with_loads:
            feature, remedy = "rest with people who balance", "leave with_loads out"
            yield missing(("run", "start", "with_loads"), _SYSTEM, "true", remedy, feature=feature)
        if isinstance(load, Oscillator) and isinstance(load.travel, FreeTravel) and not load.wheel_mass:
            feature, remedy = "free travel of a wheel without mass", "give it a wheel_mass, or a travel with its speed"
            yield missing(("loads", name, "travel", "kind"), _SYSTEM, "free", remedy, feature=feature)


def _in_a_window(parts: Parts) -> Iterator[Finding]:
    """What would move far from the contacts, or comes to a line anywhere."""
    run = parts.run
    if not isinstance(run, Dynamic) or run.window is None:
        return
    path, given, remedy = ("run", "window"), run.written_window, "leave window out"
    if parts.nets:
        yield Finding(path, "a window is measured along lines, and a net has none", given, remedy)
    if run.start.kind != "rest":
        yield missing(path, _SYSTEM, given, remedy, feature=f"a window with start.kind: {run.start.kind}")
    if parts.wind is not None and not parts.wind.is_calm:
        yield Finding(path, "wind moves the whole line, not only its part near a load", given, remedy)
    for name, line in parts.lines.items():
        for key, support in (*line.ends(), *line.supports.items()) if line is not None else ():
            if isinstance(support, Moving):
                where = key if key in ("start_support", "end_support") else f"supports.{key}"
                yield Finding(path, f"lines.{name}.{where} moves its line far from a load, too", given, remedy)
    for load in parts.loads.values():
        if isinstance(load, Footsteps | Walker | ExternalModel):
            yield missing(path, _SYSTEM, given, remedy, feature=f"a window with a load of kind {load.kind}")
        elif getattr(getattr(load, "travel", None), "measured", "") == "arc":
            yield missing(path, _SYSTEM, given, remedy, feature="a window with measured: arc")


def _on_nets(parts: Parts) -> Iterator[Finding]:
    """A net has no axis, and who balances on one does so across a straight way."""
    if parts.nets and isinstance(parts.run, Dynamic) and parts.run.start.whirl:
        yield Finding(("run", "start", "whirl"), "a net has no axis to whirl about", "true", "leave whirl out")
    if parts.nets and isinstance(parts.run, Dynamic) and parts.run.axial_inertia != 1.0:
        wrong, remedy = "a net has no axis along which its inertia could be larger", "leave axial_inertia out"
        yield Finding(("run", "axial_inertia"), wrong, f"{parts.run.axial_inertia:g}", remedy)
    for name, load in parts.loads.items():
        if load is None or load.on not in parts.nets:
            continue
        if not isinstance(load, Walker | Footsteps) or load.balance is None or load.path is None:
            continue
        if _turns(load.path):
            path, remedy = ("loads", name, "balance"), "give it a straight path, or leave balance out"
            yield missing(path, "paths that turn", "a block", remedy)


def _turns(path: tuple[tuple[float, ...], ...]) -> bool:
    """Whether a path on a net has a corner where it goes on in another direction."""
    runs = [(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(path) if a != b]
    return any(
        abs(p * v - q * u) > 1e-9 * math.hypot(p, q) * math.hypot(u, v) or p * u + q * v < 0.0
        for (p, q), (u, v) in pairwise(runs)
    )


def _of_tracks(parts: Parts) -> Iterator[Finding]:
    """What is not known of masses between ties: results hold places of lines alone, and nothing pulls at them along."""
    run, what = parts.run, "tracks"
    if not parts.tracks:
        return
    for block, there in (("overhead_lines", parts.overhead), ("nets", parts.nets)):
        for other in there:
            yield missing((block, other), what, remedy="compute it in a scenario of its own")
    for other, line in parts.lines.items():
        if line is not None and line.sheaves:
            feature, remedy = "a line over sheaves", "end it at the sheave, or leave it out"
            yield missing(("lines", other, "sheaves"), what, remedy=remedy, feature=feature)
        if line is not None and isinstance(line.law, Inextensible):
            feature, remedy = "an inextensible line", "give it an axial_stiffness with law hooke"
            yield missing(("lines", other, "law", "kind"), what, "inextensible", remedy, feature=feature)
    if isinstance(run, Dynamic) and run.start.kind == "result":
        feature, remedy = "a start from a result, which does not hold where sleepers are,", "start from equilibrium"
        yield missing(("run", "start", "kind"), what, run.start.kind, remedy, feature=feature)


_LINEAR, _DYNAMIC = "kind: linear", "ask for kind: dynamic"
_MORE = (
    _accuracy, _only_lines, _over_profiles, _overhead, _of_pantographs, _inextensible, _in_a_window,
    _joined_between_nodes, _of_loads, beside_sheaves, _of_tracks, _on_nets, supported_by_tension, of_methods,
    of_several_lines,
)  # fmt: skip
MOTION = Capabilities(
    _SYSTEM,
    only={
        "run.kind": ("dynamic",),
        "run.method": ("auto", "explicit", "verlet", "rkn6", "implicit"),
        "run.sample": (None,),
        "lines.law.kind": (*LAWS_OF_STRAIN, "inextensible"),
        "loads.kind": (*STATIC_LOADS, "carriage", "footsteps", "walker", "stepper", "fmu", "pantograph"),
        "loads.contact": ("clamped", "frictionless", "coulomb", "dragged"),
    },
    instead={
        "run.sample": "write every, which is the interval of all output",
        "lines.law.kind": "give an axial_stiffness with law hooke",
        "loads.travel.kind": "give a speed",
    },
    more=(*_MORE, without_retardation(_SYSTEM, "write geometry: linearised on straight beams, or use drag")),
)
AT_REST = replace(
    MOTION,
    what=f"{_SYSTEM}, equilibria or quasi-static runs",
    only={
        **MOTION.only,
        "run.kind": ("quasistatic", "equilibrium"),
        "loads.travel.margin": (None,),
        "loads.kind": STATIC_LOADS,
        "loads.travel.kind": ("prescribed",),
        "loads.travel.measured": ("material",),
    },
    more=_MORE,
    instead={**MOTION.instead, "loads.kind": WITHOUT_KIND},
)


def _moves_little(parts: Parts) -> Iterator[Finding]:
    """What of lines and air is not small motion about a rest that stays the same."""
    run = parts.run
    if parts.wind is not None and parts.is_airy and isinstance(run, Linear) and run.until > 0.0:
        speed = MeanSpeed.of(parts.wind.speed, run.until)
        if speed.is_gusty:
            wrong = "gusts push with the square of their speed, which is linear only about a mean wind that is stronger"
            given = f"mean {speed.mean:.3g} m/s, gusts of {speed.rms:.3g} m/s rms"
            yield Finding(("wind", "speed"), wrong, given, f"give the wind a larger mean, or {_DYNAMIC}")
    for name, line in parts.lines.items():
        if line is None:
            continue
        inner = ((("supports", key), support) for key, support in line.supports.items())
        for key, support in (*(((key,), support) for key, support in line.ends()), *inner):
            moved = getattr(support, "displacement", (0.0, 0.0))
            if callable(moved) or len(rows(moved)) > 1:
                feature, remedy = "a support that moves", f"write one displacement, or {_DYNAMIC}"
                path = ("lines", name, *key, "displacement")
                yield missing(path, _LINEAR, "a history", remedy, feature=feature)


def _stays_in_contact(parts: Parts) -> Iterator[Finding]:
    """What of loads with a mass is not linear, or not known."""
    for name, load in parts.loads.items():
        stiffness = getattr(load, "contact_stiffness", None)
        if stiffness is not None and not isinstance(load, Pantograph):
            yield missing(("loads", name, "contact_stiffness"), _LINEAR, f"{stiffness:g} N/m", "leave it out")
        if not isinstance(load, MovingMass | Oscillator | Vehicle | Matrices):
            continue
        if getattr(load, "contact", "clamped") == "frictionless":
            feature = "a frictionless contact of a mass"
            yield missing(("loads", name, "contact"), _LINEAR, "frictionless", "write clamped", feature=feature)
        if not isinstance(load.travel, FreeTravel) and load.travel.at_end == "stay":
            feature, remedy = "a mass that stays on the line", "write leave, or end the run before"
            yield missing(("loads", name, "travel", "at_end"), _LINEAR, "stay", remedy, feature=feature)
        for wheel, its in load.wheels.items() if isinstance(load, Vehicle) else ():
            if its.contact_stiffness is not None:
                path, given = ("loads", name, "wheels", wheel, "contact_stiffness"), f"{its.contact_stiffness:g} N/m"
                yield missing(path, _LINEAR, given, f"leave it out, or {_DYNAMIC}")


LINEAR = replace(
    MOTION,
    what=_LINEAR,
    only={
        "run.kind": ("linear",),
        "lines.law.kind": (*LAWS_OF_STRAIN, "inextensible"),
        **{key: values for key, values in OF_LINEAR_THEORY.items() if key != "loads.contact_stiffness"},
        "loads.kind": (*OF_LINEAR_THEORY["loads.kind"], "pantograph"),
        "loads.lift_off": (False,),
    },
    instead={
        **MOTION.instead,
        "loads.kind": WITHOUT_KIND,
        "loads.lift_off": f"leave it out to be warned where contact would be lost, or {_DYNAMIC}",
        "loads.air_drag": f"leave it out, or {_DYNAMIC}",
    },
    more=(
        _only_lines, _over_profiles, _overhead, _of_pantographs, _inextensible, _joined_between_nodes, _of_tracks,
        _on_nets, supported_by_tension, _moves_little, _stays_in_contact, without_retardation(_LINEAR, _DYNAMIC),
    ),
)  # fmt: skip
"""Small motion about rest, by modes."""
