"""Problems of loads that meet lines, with exact answers or another scheme next to them.

A problem gives its error by any scheme on any mesh (docs/notes/gate-of-contacts.md).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from tests import continuous_beams, held_strings

from ropewalk.model import Scenario
from ropewalk.results.frame import ENERGY_FORMS, Frame
from ropewalk.theory import bead, beam, selfsimilar, string
from ropewalk.theory.moving_oscillator import moving_oscillator

from .schemes import ROPES, SPLINES, STIFF

Array = np.ndarray
Ways = Callable[[Scenario, Array], list[Frame]]

EA, SPAN = 1e4, 1.0
STRETCH = 1.0 + 1.0 / EA
LENGTH, WAVE, TENSION = SPAN / STRETCH, 1.0 / np.sqrt(STRETCH), 1.0 / STRETCH  # in the coordinate of the material
WEIGHT = 1e-5  # N/kg: motion is linear


OLD: dict[str, Ways] = {"ropes": ROPES, "stiff lines": STIFF}
NEW = SPLINES


@dataclass(frozen=True)
class Problem:
    """A line of the gate: name, measure of its error, meshes, old scheme ("": none), error of a way on a mesh."""

    name: str
    measure: str
    meshes: tuple[int, ...]
    old: str
    error: Callable[[Ways, int], float]
    core: bool = False
    """Whether the compiled core computes it, too."""


def motion_of(lines: dict[str, Any], loads: dict[str, Any], until: float, **more: Any) -> Scenario:
    run = {"kind": "dynamic", "until": float(until), "every": float(until)}
    tree = {"gravity": 0.0, "lines": lines, "loads": loads} | more
    return Scenario.model_validate(tree | {"run": run | more.get("run", {})})


def series(frames: list[Frame], name: str, axis: int = -1) -> Array:
    return np.array([getattr(frame, name)[0, axis] for frame in frames])


def rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def form(frames: list[Frame], name: str) -> Array:
    return np.array([frame.energy[ENERGY_FORMS.index(name)] for frame in frames])


# -- Taut strings ------------------------------------------------------------------------------------------------


def taut(elements: int, **more: Any) -> dict[str, Any]:
    return {"start": [0, 0], "end": [1, 0], "length": LENGTH, "mass": 1.0, "axial_stiffness": EA,
            "elements": elements} | more  # fmt: skip


def crossing(load: dict[str, Any], alpha: float) -> dict[str, Any]:
    return {"p": load | {"on": "s", "travel": {"speed": float(alpha * WAVE), "at_end": "leave"}}}


def force(alpha: float) -> Callable[[Ways, int], float]:
    def error(way: Ways, n: int) -> float:
        until = 0.75 * LENGTH / (alpha * WAVE)
        load = crossing({"kind": "force", "force": [0, -1e-6]}, alpha)
        xi = np.linspace(0.0, LENGTH, n + 1)
        found = way(motion_of({"s": taut(n)}, load, until), np.linspace(0.0, until, 5))
        return rms(np.array([
            frame.position[:, 1] / -1e-6 - string.moving_force(
                xi, frame.path, force=1.0, speed=alpha * WAVE, length=LENGTH, tension=TENSION, mass=1.0)
            for frame in found[1:]
        ]))  # fmt: skip

    return error


def mass(alpha: float, m: float = 1.0, of: str = "deflection", part: float = 0.9) -> Callable[[Ways, int], float]:
    """Largest error of the deflection in m g L/P, or of the contact force in m g, in the mean square."""

    def error(way: Ways, n: int) -> float:
        speed, until = alpha * WAVE, part * LENGTH / (alpha * WAVE)
        load = crossing({"kind": "mass", "mass": m, "force": [0, -m * WEIGHT]}, alpha)
        found = way(motion_of({"s": taut(n)}, load, until), np.linspace(0.0, until, 201))
        exact = string.moving_mass(
            np.array([frame.path for frame in found]), load_mass=m, speed=speed, length=LENGTH, tension=TENSION,
            mass=1.0, gravity=WEIGHT,
        )  # fmt: skip
        if of == "deflection":
            return float(np.abs(-series(found, "contact_position") - exact.deflection).max()) / (m * WEIGHT)
        return rms((-series(found, "contact_force") - exact.contact_force)[1:]) / (m * WEIGHT)

    return error


def oscillator(stiffness: float, wheel: float) -> Callable[[Ways, int], float]:
    """Contact force over the weight, in the mean square; half the wave speed."""

    def error(way: Ways, n: int) -> float:
        speed, until, sprung = 0.5 * WAVE, 0.9 * LENGTH / (0.5 * WAVE), 0.5
        load = {
            "kind": "matrices", "mass": [[sprung, 0], [0, wheel]], "coordinates": ["body", "wheel"],
            "stiffness": [[stiffness, -stiffness], [-stiffness, stiffness]], "wheels": {"w": {"coordinate": "wheel"}},
            "weight": [sprung * WEIGHT, wheel * WEIGHT],
        }  # fmt: skip
        found = way(motion_of({"s": taut(n)}, crossing(load, 0.5), until), np.linspace(0.0, until, 101))
        exact = moving_oscillator(
            np.array([frame.path for frame in found]), sprung_mass=sprung, contact_mass=wheel, stiffness=stiffness,
            speed=speed, length=LENGTH, tension=TENSION, mass=1.0, gravity=WEIGHT,
        )  # fmt: skip
        return rms((-series(found, "contact_force") - exact.contact_force)[1:]) / ((sprung + wheel) * WEIGHT)

    return error


def two_masses(way: Ways, n: int) -> float:
    """Two masses of half a string at 0.4 of the wave speed, the second half a string behind: as of one."""
    speed, apart, m = float(0.4 * WAVE), 0.45, 0.5
    until, late = 0.95 * LENGTH / speed, apart * LENGTH / speed
    wheels = {"a": {"coordinate": "first"}, "b": {"coordinate": "second", "at": -apart * LENGTH}}
    load = {"kind": "matrices", "mass": [[m, 0], [0, m]], "stiffness": [[0, 0], [0, 0]], "wheels": wheels,
            "coordinates": ["first", "second"], "weight": [m * WEIGHT, m * WEIGHT]}  # fmt: skip
    found = way(motion_of({"s": taut(n)}, crossing(load, 0.4), until), times := np.linspace(0.0, until, 101))
    bare = held_strings.HeldString(LENGTH, TENSION, 1.0, held_strings.Station(0.5 * LENGTH))
    moving_loads = [held_strings.MovingLoad(enters, m * WEIGHT, m) for enters in (0.0, late)]
    _, exact = held_strings.crossed(bare, speed, times, *moving_loads)
    off = [np.array([frame.contact_position[k, -1] for frame in found]) + exact[k] for k in (0, 1)]
    return float(np.nanmax(np.abs(off))) / (m * WEIGHT)


# -- Ropes that stretch, stiff lines --------------------------------------------------------------------------------


def begins(alpha: float, contact: str, bends: bool = False) -> Callable[[Ways, int], float]:
    """A force that starts to move on a soft string: horizontal drift of the contact, over that."""

    def error(way: Ways, n: int) -> float:
        speed = float(alpha * np.sqrt(0.05 / 1.05))
        begin, end = (round(t * speed * n / 2.0) * 2.0 / n / speed for t in (0.35, 0.95))  # whole passages of nodes
        line = {"start": [0, 0], "end": [2.1, 0], "length": 2.0, "mass": 1.0, "axial_stiffness": 1.0, "elements": n}
        line |= {"bending_stiffness": 1e-12} if bends else {}
        load = {"kind": "force", "on": "s", "force": [0, -0.01], "contact": contact,
                "travel": {"speed": speed, "from": 1.0}}  # fmt: skip
        found = way(motion_of({"s": line}, {"p": load}, end), times := np.linspace(0.0, end, 201))
        wave = selfsimilar.moving_force(
            force=0.01, speed=speed, axial_stiffness=1.0, mass=1.0, prestrain=0.05, contact=contact
        )
        x = series(found, "contact_position", 0)
        way_gone = x[-1] - np.interp(begin, times, x)
        drift = wave.contact_velocity[0] - 1.05 * speed
        return abs((way_gone / (end - begin) - wave.contact_velocity[0]) / drift)

    return error


BEAM = {"length": 1.0, "bending_stiffness": 0.5, "mass": 1.0, "tension": 1.0}


def on_beam(m: float) -> Callable[[Ways, int], float]:
    """A force or a mass across a hinged beam under tension: largest deflection, over that."""

    def error(way: Ways, n: int) -> float:
        line = {"start": [0, 0], "end": [1, 0], "tension": 1.0, "mass": 1.0, "bending_stiffness": 0.5,
                "axial_stiffness": 1e6, "elements": n}  # fmt: skip
        load = {"kind": "mass", "mass": m} if m else {"kind": "force"}
        load |= {"on": "s", "force": [0, -1e-5], "travel": {"speed": 1.0, "from": 0.0, "at_end": "leave"}}
        found = way(motion_of({"s": line}, {"p": load}, 0.9), times := np.linspace(0.0, 0.9, 46))
        x = np.linspace(0.0, 1.0, n + 1)
        if m:
            own = beam.moving_mass(times, load_mass=m, speed=1.0, gravity=1e-5 / m, tolerance=1e-5, **BEAM)
            exact = own.beam_deflection(x)
        else:
            exact = beam.moving_force(x, times[:, None], force=1e-5, speed=1.0, **BEAM)
        off = np.array([frame.position[:, -1] for frame in found]) + exact[: len(found)]
        return float(np.abs(off).max() / np.abs(exact).max())

    return error


# -- Stations --------------------------------------------------------------------------------------------------------

AT, CROSSES = 7.2, 20.0  # m, m/s
STRING = {"start": [0, 0], "end": [20, 0], "tension": 1e4, "mass": 1.0, "axial_stiffness": 1e8}


def station(m: float, of: str, **restrained: float) -> Callable[[Ways, int], float]:
    """A force or a mass that crosses a string on a support that yields: rms of the deflection over the largest."""

    def error(way: Ways, n: int) -> float:
        yields = 1.0 + 1e-4  # strain
        own = {"at": AT / yields, "kind": "elastic", "stiffness": [0.0, restrained.get("stiffness", 0.0)]}
        own |= {"mass": restrained.get("mass", 0.0)}
        load = {"kind": "mass", "mass": m} if m else {"kind": "force"}
        load |= {"on": "s", "force": [0, -1e-3], "travel": {"speed": CROSSES, "at_end": "leave"}}
        lines = {"s": STRING | {"elements": n, "supports": {"station": own}}}
        found = way(motion_of(lines, {"p": load}, 0.9), times := np.linspace(0.0, 0.9, 91))
        exact = held_strings.crossed(
            held_strings.HeldString(20.0, 1e4, 1.0 / yields, held_strings.Station(AT, **restrained)),
            CROSSES * yields, times,
            held_strings.MovingLoad(force=1e-3, mass=m),
        )  # fmt: skip
        if of == "load":
            return rms(series(found, "contact_position") + exact[1][0]) / float(np.abs(exact[1]).max())
        node = round(AT / 20.0 * n)
        z = np.array([frame.position[node, -1] for frame in found])
        return rms(z + exact[0]) / float(np.abs(exact[0]).max())

    return error


def pier(way: Ways, n: int) -> float:
    """A force crosses the pier between two spans of a beam: largest deflection, over that."""
    spans = (7.2, 12.8)
    line = {"start": [0, 0], "end": [20, 0], "length": 20.0, "mass": continuous_beams.MASS, "axial_stiffness": 1e8,
            "bending_stiffness": continuous_beams.EI, "elements": n}  # fmt: skip
    line |= {"supports": {"pier": {"at": spans[0], "kind": "guided", "along": [1, 0]}}}
    load = {"kind": "force", "on": "s", "force": [0, -1.0], "travel": {"speed": CROSSES, "at_end": "leave"}}
    found = way(motion_of({"s": line}, {"p": load}, 1.0), times := np.linspace(0.0, 1.0, 51))
    exact = continuous_beams.under_a_moving_force(spans, CROSSES, np.linspace(0.0, 20.0, n + 1), times)
    off = np.array([frame.position[:, -1] for frame in found]) + exact[: len(found)]
    return float(np.abs(off).max() / np.abs(exact).max())


# -- Energy ----------------------------------------------------------------------------------------------------------


def audit(load: dict[str, Any], **more: Any) -> Callable[[Ways, int], float]:
    """What the audit of a slack rope misses, over the energy in motion: meshes are steps in a twentieth of a second."""

    def error(way: Ways, n: int) -> float:
        rope = {"start": [0, 0], "end": [20, 1], "length": 20.4, "mass": 1.0, "axial_stiffness": 1e5, "elements": 40}
        loads = {"p": {"kind": "mass", "mass": 20.0, "on": "r"} | load}
        run = {"step": 0.05 / n}
        found = way(motion_of({"r": rope}, loads, 1.0, gravity=9.81, run=run, **more), np.linspace(0.0, 1.0, 21))
        turned = max(np.abs(form(found, name)).max() for name in ("kinetic", "load_kinetic", "hold_work"))
        return float(np.abs(form(found, "imbalance")).max() / turned)

    return error


def lost(way: Ways, n: int) -> float:
    """Where a mass on a string of nearly no mass loses contact, P L = 9 m V^2, over the length."""
    stretch = 1.01
    speed, length = float(np.sqrt(1.0 / 9.0) / stretch), 1.0 / stretch
    load = {
        "kind": "mass",
        "mass": 1.0,
        "on": "s",
        "force": [0, -WEIGHT],
        "travel": {"speed": speed, "at_end": "leave"},
    }
    until, lines = length / speed, {"s": taut(n, mass=1e-4, axial_stiffness=100.0, length=length)}
    found = way(motion_of(lines, {"p": load}, until), np.linspace(0.0, until, 501))
    exact = string.moving_mass(
        0.0, load_mass=1.0, speed=speed, length=length, tension=length, mass=0.0, gravity=WEIGHT
    ).contact_lost_at
    force, t = series(found, "contact_force"), np.array([frame.path for frame in found])
    i = int(np.argmax((force > 0.0) & (t > 0.2 * until)))
    at = t[i - 1] - force[i - 1] * (t[i] - t[i - 1]) / (force[i] - force[i - 1])
    return abs(at - exact) / until


def slides(coefficient: float) -> Callable[[Ways, int], float]:
    """A bead on a light rope, beside one on an ellipse: largest error of its x within 3 s, m."""

    def error(way: Ways, n: int) -> float:
        rope = {"start": [0, 0], "end": [20, 0], "length": 22.0, "mass": 1e-3, "axial_stiffness": 1e6, "elements": n}
        load = {"kind": "mass", "mass": 10.0, "on": "r", "travel": {"kind": "free", "friction": coefficient}}
        start = 5.0
        high = bead.slide(0.0, start=start, mass=10.0, friction="capstan", coefficient=0.0, span=20.0, length=22.0).z
        load["travel"]["from"] = float(np.hypot(start, high))
        run = {"start": {"kind": "rest", "with_loads": True}}
        found = way(motion_of({"r": rope}, {"p": load}, 3.0, gravity=9.81, run=run), times := np.linspace(0.0, 3.0, 61))
        exact = bead.slide(
            times, start=start, mass=10.0, friction="capstan", coefficient=coefficient, span=20.0, length=22.0
        )
        return float(np.abs(series(found, "contact_position", 0) - exact.x).max())

    return error


def saddle(way: Ways, n: int) -> float:
    """Speed of a bead that rolls over a saddle, beside what it has by its energy, over what that changes."""
    m, speed, tension = 10.0, 8.0, 1e4
    load = {"kind": "mass", "mass": m, "on": "s", "travel": {"kind": "free", "speed": speed, "from": 6.0}}
    line = STRING | {"mass": 0.05, "elements": n, "supports": {"saddle": {"at": 10.0, "kind": "fixed"}}}
    run = {"start": {"kind": "rest", "with_loads": True}}
    found = way(motion_of({"s": line}, {"p": load}, 1.0, gravity=9.81, run=run), np.linspace(0.0, 1.0, 101))
    xi, seen = (np.array([getattr(frame, name)[0] for frame in found]) for name in ("contact_xi", "contact_speed"))
    s = np.mod(xi, 10.0)
    yields = m * 9.81 * s * (10.0 - s) / (10.0 * tension)
    exact = np.sqrt(speed**2 - 9.81 * (yields[0] - yields)) * seen[0] / speed
    away = np.interp(np.r_[7.0:9.1:0.25, 11.0:13.1:0.25], xi, seen - exact)
    return rms(away) / float(np.ptp(exact))


# -- Each beside the other -------------------------------------------------------------------------------------------


def beside(of: Callable[[Ways, int], Array], old: str, fine: int) -> Callable[[Ways, int], float]:
    """Error beside the other scheme on a fine mesh, in the mean square."""

    @lru_cache
    def reference(way: Ways) -> Array:
        return of(way, fine)

    def error(way: Ways, n: int) -> float:
        return float(np.sqrt(np.nanmean(np.square(of(way, n) - reference(NEW if way is not NEW else OLD[old])))))

    return error


def course(load: dict[str, Any], line: dict[str, Any], until: float, name: str = "contact_position") -> Any:
    """Where a load comes to on a line, (time, axis)."""

    def places(way: Ways, n: int) -> Array:
        scenario = motion_of({"r": line | {"elements": n}}, {"p": load | {"on": "r"}}, until, gravity=9.81)
        return np.array([getattr(frame, name)[0] for frame in way(scenario, np.linspace(0.0, until, 51))])

    return places


ROPE = {"start": [0, 0], "end": [20, 1], "length": 20.2, "mass": 1.0, "axial_stiffness": 1e5, "axial_damping": 2e3}
DECK = {"start": [0, 0], "end": [20, 0], "tension": 160e3, "mass": 100.0, "axial_stiffness": 1e8, "axial_damping": 1e4}
WALKER = {"kind": "walker", "mass": 80.0, "speed": 1.2, "from": 5.0, "foot_mass": 1.0, "leg_damping": 100.0}
KICK = {"time": [0.0, 0.3, 0.31, 0.36, 0.37], "value": [[0, 0], [0, 0], [0, 2500], [0, 2500], [0, 0]]}
THROWN = {"kind": "mass", "mass": 20.0, "lift_off": True, "force": KICK, "travel": {"speed": 5.0, "from": 5.0}}
ASIDE = {"kind": "mass", "mass": 30.0, "force": [0, 60, 0], "travel": {"speed": 6.0, "from": 4.0}}
STAYS = {"kind": "mass", "mass": 30.0, "travel": {"speed": 6.0, "from": 15.0, "at_end": "stay"}}
VEHICLE = {
    "kind": "vehicle", "travel": {"speed": 6.0, "from": 4.0}, "bodies": {"car": {"mass": 30.0, "inertia": 10.0}},
    "wheels": {"front": {"at": 0.75, "mass": 1.0}, "rear": {"at": -0.75, "mass": 1.0}},
    "springs": {"a": {"between": ["car", "front"], "stiffness": 3e3, "damping": 50.0},
                "b": {"between": ["car", "rear"], "stiffness": 3e3, "damping": 50.0}},
}  # fmt: skip
IN_SPACE = ROPE | {"start": [0, 0, 0], "end": [20, 0, 1]}

LINKS, FINER, FEW = (100, 200, 400), (50, 100, 200), (20, 40, 80)
RESTRAINED_BY = {"stiffness": 2e3}
PROBLEMS = (
    *(Problem(f"force on a string, {a} c", "field, F L/P, rms", LINKS, "ropes", force(a), core=True)
      for a in (0.5, 0.9, 1.3)),
    *(Problem(f"force that starts, {kind}, {a} c", "drift", (384, 768, 1536), "ropes", begins(a, kind))
      for kind, a in (("clamped", 0.46), ("clamped", 0.85), ("frictionless", 0.46), ("frictionless", 0.85))),
    Problem("the same on a stiff line, 0.85 c", "drift", (192, 384, 768), "stiff lines", begins(0.85, "clamped", True)),
    *(Problem(f"mass of the string, {a} c", "deflection, m g L/P", FINER, "ropes", mass(a), core=a < 0.9)
      for a in (0.2, 0.5, 0.8, 0.95)),
    *(Problem(f"mass of the string, {a} c", "force, m g, rms", FINER, "ropes", mass(a, of="force"))
      for a in (0.2, 0.5, 0.8)),
    Problem("  until waves come back, 0.8 c", "force, m g, rms", FINER, "ropes", mass(0.8, of="force", part=0.85)),
    *(Problem(f"mass of {m} of the string, 0.3 c", "deflection, m g L/P", FINER, "ropes", mass(0.3, m))
      for m in (0.006, 0.02, 0.08, 4.0)),
    *(Problem(f"mass of {m} of the string, {a} c", "force, m g, rms", FINER, "ropes", mass(a, m, "force"))
      for a, m in ((1.3, 0.3), (1.3, 3.0), (2.0, 3.0))),
    Problem("two masses, 0.4 c", "deflection, m g L/P", FINER, "ropes", two_masses),
    *(Problem(f"oscillator, K = {k}, wheel {w}", "force, m g, rms", FINER, "ropes", oscillator(k, w))
      for k, w in ((5.0, 0.0), (50.0, 0.0), (50.0, 0.1))),
    Problem("force across a beam", "largest, of the largest", (12, 24, 48), "stiff lines", on_beam(0.0)),
    Problem("mass across a beam", "largest, of the largest", (12, 24, 48), "stiff lines", on_beam(0.5)),
    Problem("mass that loses contact", "place, of the length", (25, 50, 100), "ropes", lost),
    Problem("bead that slides", "x, m", (25, 50, 100), "ropes", slides(0.0)),
    Problem("bead that rubs", "x, m", (25, 50, 100), "ropes", slides(0.1)),
    Problem("mass thrown up and landing", "m, rms", FEW, "ropes", beside(course(THROWN, ROPE, 1.2), "ropes", 160)),
    Problem("walker on a deck", "m, rms", FEW, "ropes",
            beside(course(WALKER, DECK, 1.5, "body_position"), "ropes", 160)),
    Problem("mass pushed to the side", "m, rms", FEW, "ropes", beside(course(ASIDE, IN_SPACE, 0.6), "ropes", 320)),
    Problem("mass that stays at the end", "m, rms", FEW, "ropes", beside(course(STAYS, ROPE, 1.2), "ropes", 320)),
    Problem("vehicle", "m, rms", FEW, "ropes", beside(course(VEHICLE, ROPE, 0.6, "body_position"), "ropes", 320)),
    *(Problem(f"audit, mass, {of}", "imbalance; steps", (160, 320, 640), "ropes",
              audit({"travel": {"speed": 6.0, "from": 5.0, "measured": of}}))
      for of in ("material", "slip", "horizontal")),
    Problem("audit, frictionless mass", "imbalance; steps", (160, 320, 640), "ropes",
            audit({"contact": "frictionless", "travel": {"speed": 6.0, "from": 5.0}})),
    Problem("audit, bead", "imbalance; steps", (160, 320, 640), "ropes",
            audit({"travel": {"kind": "free", "speed": 3.0, "from": 5.0}})),
    Problem("audit, bead that rubs", "imbalance; steps", (160, 320, 640), "ropes",
            audit({"travel": {"kind": "free", "speed": 3.0, "from": 5.0, "friction": 0.05}})),
    Problem("audit, bead that comes to the end", "imbalance; steps", (160, 320, 640), "ropes",
            audit({"travel": {"kind": "free", "speed": 12.0, "from": 14.0, "at_end": "stay"}})),
    Problem("force over a spring", "at the spring, rms", (25, 50, 100), "", station(0.0, "station", stiffness=2e3)),
    Problem("force over a held mass", "at the mass, rms", (25, 50, 100), "", station(0.0, "station", mass=5.0)),
    Problem("mass over a spring", "at the spring, rms", (25, 50, 100), "", station(10.0, "station", stiffness=2e3)),
    Problem("mass over a spring", "below the mass, rms", (25, 50, 100), "", station(10.0, "load", stiffness=2e3)),
    Problem("force over a pier of a beam", "largest, of the largest", (25, 50, 100), "", pier),
    Problem("bead over a saddle", "speed, of its change, rms", (20, 40, 80), "", saddle),
)  # fmt: skip
