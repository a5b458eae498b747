"""Scenarios drawn by a seed, with fixed weights over structures, loads, travel, supports and run kinds.

Sizes are such that a run takes a tenth of a second to a second: few elements, and a fraction of a passage.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from random import Random
from typing import Any

from conformance import loads as vocabulary
from conformance.structures import BY_NAME, DOWN, Structure
from ropewalk.units import to_si

from .trees import Tree, copied, in_space, measures, mirrored, turned

RUNS = {"dynamic": 6, "linearised": 2, "linear": 4, "quasistatic": 3, "equilibrium": 2}
LOADS = {
    "dynamic": {"force": 4, "axles": 1, "mass": 3, "oscillator": 2, "trolley": 1, "vehicle": 2, "matrices": 1,
                "footsteps": 1, "train": 1, "walker": 1},
    "linear": {"force": 5, "axles": 1, "mass": 1, "oscillator": 1, "vehicle": 1, "matrices": 1,
               "train": 1},
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


def draw(rng: Random) -> Tree:
    """Draw a scenario; it may be one that is refused."""
    kind = choose(rng, RUNS)
    s: Structure = choose(rng, STRUCTURES)(rng)
    tree: Tree = {"gravity": rng.choice([DOWN, DOWN, DOWN, 0.0]), **s.parts, "loads": {}}
    if kind == "equilibrium" or s.family in ("slack", "joined", "overhead"):
        tree["gravity"] = DOWN
    number = choose(rng, NUMBER) if kind in ("dynamic", "linearised", "equilibrium") else choose(rng, {1: 7, 2: 3})
    tree["run"] = _run(rng, kind, s)
    _add_loads(rng, tree, s, kind, number)
    if kind == "linear" and any(load["kind"] not in ("force", "axles") for load in tree["loads"].values()):
        _shorten(tree)
    return _placed(rng, tree, s)


def _shorten(tree: Tree) -> None:
    """Let a run of bodies on modes take half the links and less time: its steps follow the shortest wave."""
    for line in tree.get("lines", {}).values():
        line["elements"] = max(line["elements"] // 2, 4)
    tree["run"] |= {key: 0.4 * tree["run"][key] for key in ("until", "every")}


def _run(rng: Random, kind: str, s: Structure) -> Tree:
    if kind in ("quasistatic", "equilibrium"):
        return {"kind": kind} | ({"positions": 5} if kind == "quasistatic" else {})
    run: Tree = {"kind": "linear" if kind == "linear" else "dynamic", "until": s.until, "every": s.until / 8.0}
    if kind == "linearised":
        run["geometry"] = "linearised"
    if kind != "linear" and rng.random() < 0.25:
        run["start"] = {"with_loads": True}
    return run


def _placed(rng: Random, tree: Tree, s: Structure) -> Tree:
    """Lay the scenario in the plane as drawn, towards -x, in space, or askew in plan."""
    how = choose(rng, PLACED)
    if s.family in ("surface", "overhead") or ("horizontal" in measures(tree) and how != "in space"):
        return tree
    if how == "to the left":
        return mirrored(tree)
    if how == "in space":
        return in_space(tree)
    return turned(tree, rng.uniform(0.3, 1.2)) if how == "askew" else tree


# -- Structures --------------------------------------------------------------------------------------------------


def _sized(
    parts: Tree, length: float, mass: float, speed: float, until: float, family: str, on: str = "rope"
) -> Structure:
    return Structure(family, "", parts, on, length, mass=mass, speed=speed, until=until, family=family)


def _ends(rng: Random, chord: float, stiffness: float) -> Tree:
    """Ends of a line, level or on a slope, on supports that are mostly fixed."""
    slope = rng.choice([0.0, 0.0, rng.uniform(-0.5, 0.5)])
    table = {"time": [0.0, 0.1, 0.2], "value": [[0.0, 0.0], [0.0, 0.02], [0.0, 0.0]]}
    supports: dict[str, Tree] = {
        "elastic": {"kind": "elastic", "stiffness": 50 * stiffness, "damping": stiffness / 5, "mass": 5.0},
        "slider": {"kind": "guided", "along": [0.0, 1.0], "stiffness": 10 * stiffness},
        "moving": {"kind": "moving", "displacement": [0.0, 0.05]},
        "shaken": {"kind": "moving", "displacement": table},
    }
    drawn = {end: choose(rng, SUPPORTS) for end in ("start_support", "end_support")}
    return {"start": [0.0, 0.0], "end": [chord * math.cos(slope), chord * math.sin(slope)],
            **{end: supports[how] for end, how in drawn.items() if how != "fixed"}}  # fmt: skip


def taut(rng: Random) -> Structure:
    length, tension, mass = rng.uniform(12, 30), rng.uniform(5e3, 2e4), rng.uniform(0.5, 2)
    wave = math.sqrt(tension / mass)
    line = {**_ends(rng, length, tension / 2), "tension": tension, "mass": mass,
            "axial_stiffness": rng.uniform(5e5, 2e6), "elements": 32}  # fmt: skip
    if rng.random() < 0.4:
        line |= {"axial_damping": 500.0, "drag": 0.5}
    size = 0.01 * tension / DOWN * rng.uniform(1, 4)
    return _sized({"lines": {"rope": line}}, length, size, 0.2 * wave, 1.5 * length / wave, "taut")


def slack(rng: Random) -> Structure:
    chord = rng.uniform(15, 25)
    length = chord * rng.uniform(1.01, 1.06)
    law = rng.choice([{}, {}, {"law": {"kind": "tension_only"}}, {"law": {"kind": "second_piola_kirchhoff"}}])
    line = {**_ends(rng, chord, 1e4), "length": length, "mass": 1.0, "axial_stiffness": 1e6, "elements": 40, **law}
    if rng.random() < 0.15:
        line |= {"law": {"kind": "inextensible"}}
        line.pop("axial_stiffness")
    elif rng.random() < 0.7:
        line["axial_damping"] = 200.0
    return _sized({"lines": {"rope": line}}, length, 5.0, 3.0, 0.4, "slack")


def cable(rng: Random) -> Structure:
    drawn = rng.choice([taut, taut, slack])(rng)
    line = drawn.with_line(bending_stiffness=rng.choice([100.0, 1e4]), law=None, axial_stiffness=1e6)
    return replace(drawn, parts=line, family="stiff")


def beam(rng: Random) -> Structure:
    length, mass, first = rng.uniform(15, 30), rng.uniform(1000, 3000), rng.uniform(3, 8)
    bending = mass * (2 * math.pi * first * (length / math.pi) ** 2) ** 2
    pier = {"pier": {"at": 0.5 * length, "kind": "guided", "along": [1.0, 0.0]}}
    bearing = {"bearing": {"at": 0.75 * length, "kind": "elastic", "stiffness": [0.0, 1e8]}}
    more: Tree = rng.choice([
        {}, {}, {"end_support": {"kind": "fixed", "clamped": True}}, {"drag": 0.6},
        {"end_support": {"kind": "guided", "along": [1.0, 0.0]}}, {"supports": pier}, {"supports": pier | bearing},
        {"foundation": 0.1 * bending * (math.pi / length) ** 4},
        {"segments": {"haunch": {"from": 0.0, "to": 0.25 * length, "bending_stiffness": 2 * bending}}},
    ])  # fmt: skip
    line: Tree = {"start": [0.0, 0.0], "end": [length, 0.0], "length": length, "mass": mass,
                  "bending_stiffness": bending, "axial_stiffness": 1e10, "elements": 20, **more}  # fmt: skip
    return _sized({"lines": {"rope": line}}, length, mass, 20.0, rng.uniform(0.15, 0.4), "beam")


def network(rng: Random) -> Structure:
    """Return ropes that are joined or run over a sheave or saddle, as in the matrix, with coarser meshes."""
    s = BY_NAME[rng.choice(["joined", "hung", "ring", "sheave", "shoe"])]
    parts = copied(s.parts)
    for line in (*parts["lines"].values(), *parts.get("hangers", {}).values()):
        line["elements"] = max(line.get("elements", 1) // 3, 1)
        line |= {key: to_si(line[key], "N") for key in ("tension", "axial_stiffness") if key in line}
    if s.name == "joined":
        parts["lines"]["hanger"]["end_support"]["at"] = rng.uniform(9.5, 10.5)
    elif s.name == "sheave":
        tower = {"at": [rng.uniform(9, 13), 1.0], "friction": rng.choice([0.0, 0.05])}
        parts["lines"]["rope"]["sheaves"]["tower"] = tower
    elif s.name == "shoe":
        tower = {"at": [rng.uniform(9, 13), 0.5], "radius": rng.uniform(1, 3), "friction": rng.choice([0.0, 0.1])}
        parts["lines"]["rope"]["saddles"]["tower"] = tower
    short = s.name in ("ring", "sheave", "shoe")
    return replace(s, parts=parts, length=min(s.length, 11.9) if short else s.length)


def track(rng: Random) -> Structure:
    """Return a rail on sleepers, on a bridge in the middle, with coarser meshes."""
    s = BY_NAME["track"]
    parts = copied(s.parts)
    for line in parts["lines"].values():
        line["elements"] //= 2
        for key, unit in (("bending_stiffness", "N*m^2"), ("axial_stiffness", "N")):
            line[key] = to_si(line[key], unit)
    parts["tracks"]["track"]["sleepers"]["spacing"] = rng.choice([0.6, 0.8, 1.0])
    return replace(s, parts=parts)


def surface(rng: Random) -> Structure:
    sides = [[rng.uniform(3, 5), 0.0, 0.0], [0.0, rng.uniform(2, 4), 0.0]]
    kind = rng.choice([{"kind": "net", "axial_stiffness": 1e4, "mass": 0.05, "tension": 100.0},
                       {"kind": "membrane", "stiffness": 1e5, "mass": 0.3, "tension": 500.0}])  # fmt: skip
    net = {"corner": [0.0, 0.0, 0.0], "sides": sides, "cells": [8, 6], **kind}
    return _sized({"nets": {"net": net}}, 2.0, 2.0, 3.0, 0.15, "surface", "net")


def overhead(rng: Random) -> Structure:
    wires: Tree = {"spans": {"count": 3, "length": rng.uniform(30, 50)}, "droppers": {"per_span": rng.choice([3, 4])},
                   "element": 2.0, "analysed_spans": [2, 2]}  # fmt: skip
    if rng.random() < 0.3:
        wires |= {"contact_wire": {"drag": 0.05}, "messenger_wire": {"drag": 0.05}}
    length = 3 * wires["spans"]["length"]
    return _sized({"overhead_lines": {"section": wires}}, length, 10.0, 30.0, 0.4, "overhead", "section")


STRUCTURES: dict[Callable[[Random], Structure], float] = {
    taut: 5, slack: 4, cable: 3, beam: 6, network: 4, surface: 3, overhead: 1.5, track: 1,
}  # fmt: skip

# -- Loads -------------------------------------------------------------------------------------------------------


def _add_loads(rng: Random, tree: Tree, s: Structure, kind: str, number: int) -> None:
    """Put loads on the structure, of which the second begins 0.17 lengths ahead of the first, alike in its travel."""
    weights = LOADS["dynamic" if kind == "linearised" else kind]
    how, base = choose(rng, TRAVEL), s.length * rng.uniform(0.15, 0.35)
    if kind == "quasistatic" and how == "standing":
        how = "material"
    for k, name in enumerate(("first", "second")[:number]):
        sort = choose(rng, weights)
        if s.family == "overhead" and kind in ("dynamic", "linearised") and rng.random() < 0.6:
            sort = "pantograph"
        load = _load(rng, sort, replace(s, mass=s.mass * rng.uniform(0.3, 1.0) / number))
        start = base + 0.17 * k * s.length
        if sort in ("footsteps", "walker"):
            load |= {"from": start} | ({"path": vocabulary.PATH} if s.is_surface else {})
        else:
            load["travel"] = _travel(how, sort, s, start)
        tree["loads"][name] = load


def _load(rng: Random, sort: str, s: Structure) -> Tree:
    """Return a load of the vocabulary with all numbers that have a dimension, and some variety."""
    load: Tree = {**vocabulary.KINDS[sort](s), "on": s.on}
    if sort == "force":
        variety: Tree = rng.choice(
            [{}, {}, {"contact": "frictionless"}, {"force": [0.2 * s.mass * DOWN, -s.mass * DOWN]}]
        )
        load |= variety
    elif sort == "vehicle":
        load["bodies"]["box"]["at"] = rng.choice([0.0, 0.2])
        load["wheels"]["rear"]["at"] = -0.6
    elif sort == "trolley":
        load["payload"] = {"at": [0.3, -1.99], **load["payload"]}
        load["payload"].pop("swing")
    elif sort == "footsteps":
        load = {"kind": sort, "mass": s.mass, "phase": rng.choice([0.0, 0.7]), "frequency": 2.0, "step_length": 0.7,
                "on": s.on}  # fmt: skip
    return load


def _travel(how: str, sort: str, s: Structure, start: float) -> Tree:
    """Return the travel of a load, as far as loads of its sort have it."""
    found: Tree = {"speed": s.speed, "from": start} | ({"path": vocabulary.PATH} if s.is_surface else {})
    plain = s.is_surface or sort in ("pantograph", "train")
    if how in ("horizontal", "slip", "arc") and not plain:
        found["measured"] = how
    elif how == "backwards":
        found |= {"speed": -s.speed, "from": start + 0.3 * s.length}
    elif how == "standing":
        found["speed"] = 0.0
    elif how == "table":
        t = s.until
        found["speed"] = {"time": [0.0, 0.5 * t, t], "value": [s.speed, 1.2 * s.speed, 0.8 * s.speed]}
    elif how in ("stay", "leave") and sort not in ("axles", "train") and not plain:
        late = start + 0.65 * s.length - 0.5 * s.speed * s.until
        found |= {"at_end": how, "from": min(late, 0.97 * s.length)}
    elif how == "free" and sort in ("mass", "trolley", "oscillator"):
        found |= {"kind": "free", "friction": 0.1}
    return found
