"""Scenarios drawn with fixed weights over structures, loads, travel, supports and run kinds; a seed gives the same ones.

Sizes are such that a run takes a tenth of a second to a second: few elements, and a fraction of a passage.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from random import Random
from typing import Any

from .trees import Tree, in_space, mirrored, turned

DOWN = 9.81


@dataclass
class Drawn:
    """A structure, and the size of what may travel on it."""

    parts: Tree
    on: str = "rope"
    length: float = 20.0  # m, along which loads travel
    mass: float = 50.0  # kg, of a load
    speed: float = 20.0  # m/s, of a load
    until: float = 0.2  # s
    family: str = "rope"


RUNS = {"dynamic": 6, "linearised": 2, "linear": 4, "quasistatic": 3, "equilibrium": 2}
LOADS = {
    "dynamic": {"force": 4, "axles": 1, "mass": 3, "oscillator": 2, "trolley": 1, "vehicle": 2, "matrices": 1,
                "footsteps": 1},
    "linear": {"force": 5, "axles": 1, "mass": 1, "oscillator": 1, "vehicle": 1, "matrices": 1, "footsteps": 1},
    "quasistatic": {"force": 5, "axles": 1, "mass": 1},
    "equilibrium": {"force": 5, "mass": 2},
}  # fmt: skip
NUMBER = {1: 6, 2: 3, 0: 1}
TRAVEL = {"material": 5, "horizontal": 2, "slip": 1, "arc": 1, "backwards": 2, "standing": 2, "table": 1, "stay": 1,
          "leave": 1, "free": 2}  # fmt: skip
PLACED = {"plane": 5, "to the left": 2, "in space": 1, "askew": 2}
SUPPORTS = {"fixed": 7, "elastic": 2, "slider": 1, "moving": 1, "shaken": 1}


def choose(rng: Random, weights: dict[Any, Any]) -> Any:
    """Draw a key by its weight."""
    return rng.choices(list(weights), list(weights.values()))[0]


def draw(rng: Random, kind: str = "") -> Tree:
    """Draw a scenario.

    Args:
        rng: gives all choices.
        kind: of the run (default: drawn).
    """
    kind = kind or choose(rng, RUNS)
    s: Drawn = choose(rng, STRUCTURES)(rng)
    tree: Tree = {"gravity": rng.choice([DOWN, DOWN, DOWN, 0.0]), **s.parts, "loads": {}}
    if kind == "equilibrium" or s.family in ("slack", "joined"):
        tree["gravity"] = DOWN
    number = choose(rng, NUMBER) if kind in ("dynamic", "linearised", "equilibrium") else choose(rng, {1: 7, 2: 3})
    tree["run"] = _run(rng, kind, s)
    _add_loads(rng, tree, s, kind, number)
    return _placed(rng, tree, s)


def _run(rng: Random, kind: str, s: Drawn) -> Tree:
    if kind == "quasistatic":
        return {"kind": kind, "positions": 5}
    if kind == "equilibrium":
        return {"kind": kind}
    run: Tree = {"kind": "linear" if kind == "linear" else "dynamic", "until": s.until, "every": s.until / 8.0}
    if kind == "linearised":
        run["geometry"] = "linearised"
    if kind in ("dynamic", "linearised") and rng.random() < 0.25:
        run["start"] = {"with_loads": True}
    return run


def _placed(rng: Random, tree: Tree, s: Drawn) -> Tree:
    """Lay the scenario in the plane as drawn, towards -x, in space, or askew in plan."""
    if s.family in ("surface", "overhead"):
        return tree
    how = choose(rng, PLACED)
    horizontal = any(load.get("travel", {}).get("measured") == "horizontal" for load in tree["loads"].values())
    if how == "to the left" and not horizontal:
        return mirrored(tree)
    if how == "in space":
        return in_space(tree)
    return turned(tree, rng.uniform(0.3, 1.2)) if how == "askew" and not horizontal else tree


# -- Structures --------------------------------------------------------------------------------------------------


def _ends(rng: Random, chord: float) -> Tree:
    """Ends of a line: level, or on a slope."""
    slope = rng.choice([0.0, 0.0, rng.uniform(-0.5, 0.5)])
    return {"start": [0.0, 0.0], "end": [chord * math.cos(slope), chord * math.sin(slope)]}


def taut(rng: Random) -> Drawn:
    length, tension, mass = rng.uniform(12, 30), rng.uniform(5e3, 2e4), rng.uniform(0.5, 2)
    wave = math.sqrt(tension / mass)
    line = {**_ends(rng, length), "tension": tension, "mass": mass, "axial_stiffness": rng.uniform(5e5, 2e6),
            "elements": 32, **_end_supports(rng, tension / 2)}  # fmt: skip
    if rng.random() < 0.4:
        line |= {"axial_damping": 500.0, "drag": 0.5}
    return Drawn({"lines": {"rope": line}}, "rope", length, 0.01 * tension / DOWN * rng.uniform(1, 4),
                 0.2 * wave, length / wave, "taut")  # fmt: skip


def slack(rng: Random) -> Drawn:
    chord = rng.uniform(15, 25)
    length = chord * rng.uniform(1.01, 1.06)
    law = rng.choice([{}, {}, {"law": {"kind": "tension_only"}}, {"law": {"kind": "second_piola_kirchhoff"}}])
    line = {**_ends(rng, chord), "length": length, "mass": 1.0, "axial_stiffness": 1e6, "elements": 40, **law,
            **_end_supports(rng, 1e4)}  # fmt: skip
    if rng.random() < 0.7:
        line["axial_damping"] = 200.0
    return Drawn({"lines": {"rope": line}}, "rope", length, 5.0, 3.0, 0.4, "slack")


def cable(rng: Random) -> Drawn:
    drawn = rng.choice([taut, taut, slack])(rng)
    drawn.parts["lines"]["rope"]["bending_stiffness"] = rng.choice([100.0, 1e4])
    drawn.parts["lines"]["rope"].pop("law", None)
    drawn.family = "stiff"
    return drawn


def beam(rng: Random) -> Drawn:
    length, mass, first = rng.uniform(15, 30), rng.uniform(1000, 3000), rng.uniform(3, 8)
    bending = mass * (2 * math.pi * first * (length / math.pi) ** 2) ** 2
    line: Tree = {"start": [0.0, 0.0], "end": [length, 0.0], "length": length, "mass": mass,
                  "bending_stiffness": bending, "axial_stiffness": 1e10, "elements": 20}  # fmt: skip
    extra = rng.choice(["", "", "clamped", "roller", "drag", "piers", "piers", "bed", "segment"])
    if extra == "clamped":
        line["end_support"] = {"kind": "fixed", "clamped": True}
    elif extra == "roller":
        line["end_support"] = {"kind": "guided", "along": [1.0, 0.0]}
    elif extra == "drag":
        line["drag"] = 0.6
    elif extra == "bed":
        line |= {"foundation": 0.1 * bending * (math.pi / length) ** 4}
    elif extra == "segment":
        line["segments"] = {"haunch": {"from": 0.0, "to": 0.25 * length, "bending_stiffness": 2 * bending}}
    elif extra == "piers":
        line["supports"] = {"pier": {"at": 0.5 * length, "kind": "guided", "along": [1.0, 0.0]}}
        if rng.random() < 0.5:
            line["supports"]["bearing"] = {"at": 0.75 * length, "kind": "elastic", "stiffness": [0.0, 0.0, 1e8][1:]}
    return Drawn({"lines": {"rope": line}}, "rope", length, mass, 20.0, rng.uniform(0.1, 0.25), "beam")


def joined(rng: Random) -> Drawn:
    """A rope hung from a hanger, ropes joined at a ring, a rope on a row of hangers under another one."""
    line: Tree = {"start": [0.0, 0.0], "end": [20.0, 0.0], "mass": 1.0, "axial_stiffness": 1e6, "elements": 24}
    which = rng.choice(["hanger", "ring", "row"])
    if which == "hanger":
        at = rng.uniform(8, 12)
        hanger = {"start": [at, 4.0], "end": [at, 0.0], "length": 4.05, "mass": 0.5, "axial_stiffness": 5e5,
                  "elements": 6, "end_support": {"kind": "joined", "to": "rope", "at": at}}  # fmt: skip
        parts: Tree = {"lines": {"rope": {**line, "tension": 1e4}, "hanger": hanger}}
    elif which == "ring":
        right = {**line, "start": [12.0, 0.0], "start_support": {"kind": "joined", "to": "ring"}, "length": 7.95,
                 "elements": 16}  # fmt: skip
        left = {**line, "end": [12.0, 0.0], "end_support": {"kind": "joined", "to": "ring"}, "length": 11.9}
        parts = {"joints": {"ring": {"mass": 3.0}}, "lines": {"rope": left, "right": right}}
        return Drawn(parts, "rope", 11.9, 50.0, 15.0, 0.2, "joined")
    else:
        above = {**line, "start": [0.0, 4.0], "end": [20.0, 4.0], "tension": 2e4}
        row = {"from": "cable", "to": "rope", "count": 3, "mass": 0.5, "axial_stiffness": 5e5}
        parts = {"lines": {"cable": above, "rope": {**line, "tension": 1e4}}, "hangers": {"hanger": row}}
    return Drawn(parts, "rope", 20.0, 50.0, 20.0, 0.2, "joined")


def sheave(rng: Random) -> Drawn:
    at = rng.uniform(9, 13)
    line: Tree = {"start": [0.0, 0.0], "end": [20.0, 0.0], "mass": 1.0, "axial_stiffness": 1e6, "elements": 40,
                  "length": 19.95, "sheaves": {"tower": {"at": [at, 1.0], "friction": rng.choice([0.0, 0.05])}}}  # fmt: skip
    return Drawn({"lines": {"rope": line}}, "rope", at, 50.0, 15.0, 0.15, "sheave")


def surface(rng: Random) -> Drawn:
    sides = [[rng.uniform(3, 5), 0.0, 0.0], [0.0, rng.uniform(2, 4), 0.0]]
    net: Tree = {"corner": [0.0, 0.0, 0.0], "sides": sides, "cells": [8, 6]}
    if rng.random() < 0.5:
        net |= {"kind": "net", "axial_stiffness": 1e4, "mass": 0.05, "tension": 100.0}
    else:
        net |= {"kind": "membrane", "stiffness": 1e5, "mass": 0.3, "tension": 500.0}
    return Drawn({"nets": {"net": net}}, "net", sides[0][0] - 0.7, 2.0, 3.0, 0.15, "surface")


def overhead(rng: Random) -> Drawn:
    wires: Tree = {"spans": {"count": 3, "length": rng.uniform(30, 50)}, "droppers": {"per_span": rng.choice([3, 4])},
                   "element": 2.0, "analysed_spans": [2, 2]}  # fmt: skip
    if rng.random() < 0.3:
        wires |= {"contact_wire": {"drag": 0.05}, "messenger_wire": {"drag": 0.05}}
    length = 3 * wires["spans"]["length"]
    return Drawn({"overhead_lines": {"section": wires}}, "section", length, 10.0, 30.0, 0.4, "overhead")


def _end_supports(rng: Random, stiffness: float) -> Tree:
    """Supports at the ends: mostly fixed."""
    table = {"time": [0.0, 0.1, 0.2], "value": [[0.0, 0.0], [0.0, 0.02], [0.0, 0.0]]}
    trees: dict[str, Tree] = {
        "elastic": {"kind": "elastic", "stiffness": 50 * stiffness, "damping": stiffness / 5, "mass": 5.0},
        "slider": {"kind": "guided", "along": [0.0, 1.0], "stiffness": 10 * stiffness},
        "moving": {"kind": "moving", "displacement": [0.0, 0.05]},
        "shaken": {"kind": "moving", "displacement": table},
    }
    drawn = {end: choose(rng, SUPPORTS) for end in ("start_support", "end_support")}
    return {end: trees[how] for end, how in drawn.items() if how != "fixed"}


STRUCTURES: dict[Callable[[Random], Drawn], float] = {
    taut: 5, slack: 4, cable: 3, beam: 6, joined: 3, sheave: 1, surface: 3, overhead: 1.5,
}  # fmt: skip

# -- Loads -------------------------------------------------------------------------------------------------------


def _add_loads(rng: Random, tree: Tree, s: Drawn, kind: str, number: int) -> None:
    """Put loads on the structure, of which the second runs 0.17 lengths ahead of the first, alike in its travel."""
    weights = LOADS["dynamic" if kind == "linearised" else kind]
    travel, base = choose(rng, TRAVEL), s.length * rng.uniform(0.15, 0.35)
    if tree["run"]["kind"] == "quasistatic" and travel == "standing":
        travel = "material"
    for k, name in enumerate(("first", "second")[:number]):
        sort = choose(rng, weights)
        if s.family == "overhead" and kind in ("dynamic", "linearised") and rng.random() < 0.6:
            sort = "pantograph"
        load = KINDS[sort](s.mass * rng.uniform(0.3, 1.0) / number, rng)
        load["on"] = s.on
        where = base + 0.17 * k * s.length
        if sort == "footsteps":
            load |= {"path": _PATH, "from": 0.17 * k} if s.family == "surface" else {"from": where}
        else:
            load["travel"] = _travel(travel, sort, s, where)
        tree["loads"][name] = load


_PATH = [[0.5, 0.9], [2.8, 1.3]]


def _travel(how: str, sort: str, s: Drawn, start: float) -> Tree:
    """Return the travel of a load of some sort, of a kind that the sort has."""
    found: Tree = {"speed": s.speed, "from": start}
    if s.family == "surface":
        found |= {"path": _PATH, "from": start - 0.15 * s.length}
    if how in ("horizontal", "slip", "arc") and s.family != "surface" and sort != "pantograph":
        found["measured"] = how
    elif how == "backwards":
        found |= {"speed": -s.speed, "from": start + 0.3 * s.length if s.family != "surface" else start + 0.8}
    elif how == "standing":
        found["speed"] = 0.0
    elif how == "table":
        t = s.until
        found["speed"] = {"time": [0.0, 0.5 * t, t], "value": [s.speed, 1.2 * s.speed, 0.8 * s.speed]}
    elif how in ("stay", "leave") and sort not in ("axles", "pantograph") and s.family != "surface":
        found |= {"at_end": how, "from": start + s.length - 0.5 * s.speed * s.until - 0.35 * s.length}
        found["from"] = min(found["from"], 0.97 * s.length)
    elif how == "free" and sort in ("mass", "trolley", "oscillator"):
        found |= {"kind": "free", "friction": 0.1}
    return found


def _force(m: float, rng: Random) -> Tree:
    ahead = rng.choice([0.0, 0.0, 0.2])
    found: Tree = {"kind": "force", "force": [ahead * m * DOWN, -m * DOWN]}
    if rng.random() < 0.2:
        found |= {"contact": "frictionless", "force": [0.0, -m * DOWN]}
    return found


def _axles(m: float, rng: Random) -> Tree:
    return {"kind": "axles", "forces": [0.6 * m * DOWN, 0.4 * m * DOWN], "at": [0.0, 0.8]}


def _mass(m: float, rng: Random) -> Tree:
    return {"kind": "mass", "mass": m}


def _oscillator(m: float, rng: Random) -> Tree:
    k = m * (2 * math.pi * rng.uniform(2, 5)) ** 2
    return {"kind": "oscillator", "mass": 0.8 * m, "wheel_mass": 0.2 * m, "stiffness": k, "damping": 0.05 * k / 10}


def _trolley(m: float, rng: Random) -> Tree:
    payload = {"mass": 0.7 * m, "length": 2.0, "at": [0.3, -1.99], "stiffness": 0.7 * m * DOWN / 0.01}
    return {"kind": "trolley", "mass": 0.3 * m, "payload": payload}


def _vehicle(m: float, rng: Random) -> Tree:
    k = 0.5 * m * (2 * math.pi * 3.0) ** 2
    spring = {"stiffness": k, "damping": 0.02 * k}
    return {
        "kind": "vehicle", "bodies": {"box": {"mass": 0.7 * m, "inertia": 0.35 * m, "at": rng.choice([0.0, 0.2])}},
        "wheels": {"front": {"at": 0.8, "mass": 0.15 * m}, "rear": {"at": -0.6, "mass": 0.15 * m}},
        "springs": {"front": {"between": ["box", "front"], **spring}, "rear": {"between": ["box", "rear"], **spring}},
    }  # fmt: skip


def _matrices(m: float, rng: Random) -> Tree:
    k = m * (2 * math.pi * 3.0) ** 2
    return {
        "kind": "matrices", "coordinates": ["body", "wheel"], "mass": [[0.8 * m, 0.0], [0.0, 0.2 * m]],
        "stiffness": [[k, -k], [-k, k]], "damping": [[0.01 * k, -0.01 * k], [-0.01 * k, 0.01 * k]],
        "wheels": {"wheel": {"coordinate": "wheel"}},
    }  # fmt: skip


def _footsteps(m: float, rng: Random) -> Tree:
    return {"kind": "footsteps", "mass": m, "phase": rng.choice([0.0, 0.7]), "frequency": 2.0, "step_length": 0.7}


def _pantograph(m: float, rng: Random) -> Tree:
    return {"kind": "pantograph", "model": "en50318-2002"}


KINDS: dict[str, Callable[[float, Random], Tree]] = {
    "force": _force, "axles": _axles, "mass": _mass, "oscillator": _oscillator, "trolley": _trolley,
    "vehicle": _vehicle, "matrices": _matrices, "footsteps": _footsteps, "pantograph": _pantograph,
}  # fmt: skip
