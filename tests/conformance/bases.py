"""Scenarios in which keys apply: between them they have every declaration of the schema, in milliseconds each."""

from __future__ import annotations

from typing import Any

from .loads import KINDS, STEPPER, fmu_file
from .structures import BEAM, BED, DECK, DOWN, OVERHEAD, RAIL, TRACK, Structure, Tree

UNTIL = 0.12  # s
HILLS = "hills.csv"
"""A file of irregularities, in the folder in which runs are computed."""
EARLIER = "earlier.nc"
"""The result of the base `plain`, in the same folder."""
VEHICLE = 50.0  # kg, of the vehicle in the FMU

TAUT: Tree = {
    "start": [0.0, 0.0], "end": [20.0, 0.0], "tension": "10 kN", "mass": 1.0, "axial_stiffness": "1 MN",
    "axial_damping": "50 N*s", "drag": 0.5, "elements": 20,
}  # fmt: skip
SPATIAL: Tree = {**TAUT, "start": [0.0, 0.0, 0.0], "end": [19.0, 5.0, 2.0]}
LONG: Tree = {k: v for k, v in TAUT.items() if k != "tension"} | {"length": 20.2}
STILL: Tree = {k: v for k, v in TAUT.items() if k != "drag"}
STIFF: Tree = {k: v for k, v in TAUT.items() if k != "axial_damping"} | {"bending_stiffness": "10 kN*m^2"}
SOFT_BED: Tree = {**BED, "elements": 20, "drag": 0.5}
SPANS: Tree = {**OVERHEAD, "spans": {"count": 3, "length": 20.0}, "droppers": {"per_span": 3}, "element": 1.0}
NET: Tree = {
    "kind": "net", "corner": [0.0, 0.0, 0.0], "sides": [[4.0, 0.0, 0.0], [0.0, 3.0, 0.0]], "cells": [8, 6],
    "axial_stiffness": 1e4, "mass": 0.05, "tension": 100.0, "axial_damping": 1.0, "drag": 0.1,
}  # fmt: skip
OUTLINE: Tree = {"boundary": [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 3.0, 0.0], [0.0, 3.0, 0.0]], "spacing": 0.8}
SHEET: Tree = {"kind": "membrane", "stiffness": 1e5, "mass": 0.3, "tension": 500.0, "damping": 20.0}
PATH = [[0.5, 1.4], [3.5, 1.6]]

_ROPE = Structure("rope", "", {}, until=UNTIL)
_HEAVY = Structure("heavy", "", {}, mass=2000.0, until=UNTIL)


def shaken(up: float = 0.02) -> Tree:
    """A displacement in time."""
    return {"time": [0.0, 0.5 * UNTIL, UNTIL], "value": [[0.0, 0.0], [0.0, up], [0.0, 0.0]]}


def way(speed: Any = 20.0, start: float = 5.0, **more: Any) -> Tree:
    return {"speed": speed, "from": start, **more}


def free(speed: float = 20.0, start: float = 5.0, **more: Any) -> Tree:
    return {"kind": "free", "speed": speed, "from": start, **more}


def load(kind: str, moved: Tree | None = None, s: Structure = _ROPE, on: str = "rope", **more: Any) -> Tree:
    """A load of the matrix, on the rope."""
    tree: Tree = {**KINDS[kind](s), "on": on, **more}
    return tree if moved is None else {**tree, "travel": moved}


def moves(**more: Any) -> Tree:
    return {"kind": "dynamic", "until": UNTIL, "every": 0.01, **more}


def one(line: Tree, load: Tree | None = None, run: Tree | None = None, **more: Any) -> Tree:
    """A scenario of a line and a load."""
    return {"lines": {"rope": line}, "loads": {"load": load} if load else {}, "run": run or moves(), **more}


def sheet(net: Tree, load: Tree, run: Tree | None = None) -> Tree:
    return {"nets": {"net": net}, "loads": {"load": {**load, "on": "net"}}, "run": run or moves()}


def section(line: Tree, load: Tree, **run: Any) -> Tree:
    return {
        "overhead_lines": {"section": line}, "loads": {"load": {**load, "on": "section"}},
        "run": moves(until=0.2, **run),
    }  # fmt: skip


def overlap(line: Tree, load: Tree, **run: Any) -> Tree:
    """A scenario of two overhead lines, the second of which begins half a metre from the start of the first."""
    tree = section(line, load, **run)
    tree["overhead_lines"]["next"] = {
        **SPANS,
        "start": [0.5, 0.0],
        "heights": [0.3, 0.12, 0.0, 0.0],
        "messenger_supports": {"stiffness": "500 kN/m"},
    }
    tree["run"]["until"] = 0.6  # the head has to rise to the wires
    return tree


_DOWN = [0.0, -50.0 * DOWN]
_HUNG: Tree = {"mass": 35.0, "length": 2.0, "swing": "10 deg", "stiffness": 35e3, "damping": 100.0, "air_drag": 0.1}
_ELASTIC: Tree = {"kind": "elastic", "stiffness": "100 kN/m", "damping": 500.0, "mass": 5.0}
_CONTACT: Tree = {"force": "contact1.force", "height": "contact1.height", "velocity": "contact1.velocity",
                  "force_factor": 1.0, "height_from": "zero"}  # fmt: skip
_FMU: Tree = {"kind": "fmu", "file": fmu_file(VEHICLE), "contacts": {"front": _CONTACT}, "every": 1e-3, "on": "rope"}
_STEPPER: Tree = {"kind": "stepper", "model": STEPPER, "options": {"force": 490.0, "start": 18.5, "speed": 20.0},
                  "every": 1e-3, "on": "rope"}  # fmt: skip
_OWN: Tree = {
    "kind": "pantograph", "masses": [15.0, 7.2], "stiffness": [50.0, 4200.0], "damping": [90.0, 10.0],
    "static_force": 120.0, "aerodynamic": 0.01, "irregularity": HILLS, "ramp": 0.05,
    "head": {"spacing": 2.0, "pitch": {"inertia": 0.3, "spring_spacing": 0.5},
             "roll": {"inertia": 1.0, "spring_spacing": 0.9}},
}  # fmt: skip
_WALKING: Tree = {"frequency": 12.0, "model": [{"amplitude": 0.4}, {"amplitude": 0.1, "phase": "90 deg"}]}
_RING: Tree = {"joints": {"ring": {"mass": 3.0, "force": [0.0, -50.0]}}, "lines": {
    "rope": {**LONG, "end": [12.0, 0.0], "length": 11.9, "end_support": {"kind": "joined", "to": "ring"}},
    "right": {**LONG, "start": [12.0, 0.0], "length": 7.95, "start_support": {"kind": "joined", "to": "ring"},
              "end_support": {**_ELASTIC, "displacement": [0.0, 0.01]}},
}}  # fmt: skip
_HANGER: Tree = {**LONG, "start": [10.0, 4.0], "end": [10.0, 0.0], "length": 4.05, "elements": 4,
                 "law": {"kind": "tension_only"},
                 "end_support": {"kind": "joined", "to": "rope", "at": 9.9}}  # fmt: skip

BASES: dict[str, Tree] = {
    # Ropes, and what travels on them.
    "plain": one(TAUT, load("force", way())),
    "earlier": one(TAUT, load("force", way()), moves(start={"kind": "result", "file": EARLIER})),
    "force in time": one(
        {**SPATIAL, "law": {"kind": "second_piola_kirchhoff"}},
        load("force in a table", way({"time": [0.0, UNTIL], "value": [20.0, 30.0]})),
    ),
    "mass": one(TAUT, load("pushed mass", way(at_end="leave", start=16.5, margin=1.5), air_drag=0.1, lift_off=True)),
    "free mass": one(
        {**TAUT, "start_support": {**_ELASTIC, "displacement": shaken()}},
        load("mass", free(friction=0.1, viscous=5.0, rolling=0.01, drive={"time": [0.0, UNTIL], "value": [50.0, 90.0]},
                          driver={"speed": {"time": [0.0, UNTIL], "value": [30.0, 25.0]}, "force": 200.0},
                          brake={"force": 100.0, "within": 14.5})),
    ),
    "free end": one(TAUT, load("mass", free(start=18.0))),
    "oscillator": one(
        {**LONG, "end_support": {"kind": "guided", "along": [1.0, 0.2], "stiffness": "50 kN/m", "damping": 500.0,
                                 "force": "5 kN", "mass": 5.0}},
        load("oscillator", way(), lift_off=True, contact_stiffness=1e6),
    ),
    "free oscillator": one(TAUT, load("oscillator", free(), lift_off=True)),
    "light wheel": one(TAUT, load("oscillator", way(), air_drag=0.1)),
    "trolley": one(
        {**TAUT, "end_support": {"kind": "moving", "displacement": shaken()}},
        load("trolley", free(), payload=_HUNG, air_drag=0.1, lift_off=True, force=[20.0, -20.0]),
    ),
    "carriage": one(
        SPATIAL, load("carriage", free(speed=0.0, start=8.0), lift_off=True, haul={
            "to": "end", "speed": {"time": [0.0, UNTIL], "value": [5.0, 4.0]}, "axial_stiffness": 1e5, "mass": 0.5,
            "sags": True, "counter": {"tension": 500.0, "mass": 0.4}, "sheave": {"friction": 0.8, "wrap": 6.0}}),
        moves(start={"with_loads": True}),
    ),
    "two carriages": {
        "lines": {"rope": {**TAUT, "end": [20.0, 5.0]}, "other": {**TAUT, "start": [0.0, 3.0], "end": [20.0, 8.0]}},
        "loads": {
            "load": load("carriage", free(speed=0.0, start=8.0),
                         haul={"over_to": "back", "axial_stiffness": 1e5, "axial_damping": 1e3, "mass": 0.3}),
            "back": load("carriage", free(speed=0.0, start=8.0), on="other", cabin=None),
        },
        "run": moves(start={"with_loads": True}),
    },
    "hoisted": one(TAUT, load("trolley", way(start=8.0), payload={**_HUNG, "hoist": 1.0})),
    "crab": {
        "lines": {"rope": TAUT, "other": {**TAUT, "axial_stiffness": "500 kN"}},
        "loads": {"load": load("trolley", way(start=8.0, measured="horizontal"), also_on=["other"], payload=_HUNG)},
        "run": moves(),
    },
    "vehicle": one(
        {**TAUT, "law": {"kind": "tension_only"}}, load("vehicle", way(), lift_off=True),
        moves(start={"with_loads": True})
    ),
    "matrices": one(
        {**TAUT, "axial_stiffness": None, "law": {"kind": "polynomial", "coefficients": [1e6, 5e6]}},
        load("matrices", way(), lift_off=True, damping=[[100.0, -100.0], [-100.0, 100.0]], weight=[400.0, 90.0]),
    ),
    "footsteps": one(SPATIAL, load("footsteps", at_end="leave", **{"from": 18.5},
                                   lateral=[{"amplitude": 0.05, "phase": "20 deg"}], **_WALKING),
                     moves(until=0.3)),
    "crowd": one(SPATIAL, load("crowd", number=2, lateral="bachmann", mass={"mean": 30.0, "deviation": 2.0},
                               frequency={"mean": 2.0, "deviation": 0.1},
                               step_length={"mean": 0.7, "deviation": 0.05})),
    "walker": one({**SPATIAL, "elements": 10}, load("walker", balance={}, push_off=0.5, **{"from": 18.8}),
                  moves(until=0.9)),
    "stepper": one(TAUT, {**_STEPPER, "exchange": {"damping": 20.0}}),
    "fmu": one(TAUT, {**_FMU, "travel": way(start=18.5), "exchange": {"scheme": "iterated"}}),
    "tabulated": one(
        {**TAUT, "axial_stiffness": None,
         "law": {"kind": "table", "strain": [0, 0.02, 0.05], "tension": [0, 15e3, 60e3]}},
        load("force", way()), moves(method="implicit"),
    ),
    "mode": {
        "gravity": 0.0, "lines": {name: {**SPATIAL, "elements": 12} for name in ("rope", "other")},
        "run": moves(start={"kind": "mode", "amplitude": 0.05, "whirl": True}),
    },
    "rough": one(
        {**TAUT, "profile": {"spectrum": "ISO 8608 C", "wavelengths": [0.5, 20.0]}}, load("mass", way(at_end="leave")),
    ),
    # At rest, and slowly.
    "slow": one(TAUT, load("force", way(), contact="dragged", friction=0.3), {"kind": "quasistatic", "positions": 5}),
    "inextensible": one(
        {**LONG, "axial_stiffness": None, "axial_damping": 0.0, "law": {"kind": "inextensible"}},
        load("force", way()), {"kind": "quasistatic", "positions": 3, "turn": "5 deg"},
    ),
    "rest": one(LONG, load("force", way()), {"kind": "equilibrium"}),
    # Trains: the first axle is on the line, others come.
    "train": one(
        {**STIFF, "drag": 0.0, "damping": {"ratio": 0.02, "at": [4.0]}},
        {"kind": "axles", "on": "rope", "forces": [4e3, 5e3], "at": [0.0, 1.0], "coaches": {"count": 2, "length": 2.5},
         "travel": way(start=5.0)}, moves(geometry="linearised")
    ),
    "train on a rope": one(
        TAUT, {"kind": "axles", "on": "rope", "forces": 200.0, "at": [0.0, 1.0],
               "travel": way({"time": [0.0, UNTIL], "value": [20.0, 30.0]}, start=0.5)},
    ),
    "known train": one(STILL, {"kind": "axles", "on": "rope", "train": "HSLM-A1", "travel": way(start=12.0)},
                       {"kind": "linear", "until": UNTIL, "every": 0.01, "modes": 20}),
    "train of vehicles": one(
        {**STIFF, "drag": 0.5}, load("train", {"speed": 20.0, "from": 5.0}), moves(geometry="linearised")
    ),
    # The linear theory.
    "linear": one(STILL, load("force", way(start=0.0)), {"kind": "linear", "until": UNTIL, "every": 0.01, "modes": 20}),
    "linear mass": one(STILL, load("mass", way(start=0.0)), {"kind": "linear", "until": UNTIL, "every": 0.01}),
    "linear vehicle": one(
        SOFT_BED, load("vehicle", way(), _HEAVY, lift_off=True),
        {"kind": "linear", "until": UNTIL, "every": 0.01, "modes": 10},
    ),
    # Stiff lines, and lines on beds.
    "stiff": one(
        {**STIFF, "length": 20.1, "tension": None, "start_support": {"kind": "fixed", "clamped": True},
         "end_support": {"kind": "guided", "along": [1.0, 0.0], "force": "10 kN"}},
        load("oscillator", way(), lift_off=True),
    ),
    "stiff fmu": one(
        STIFF, {**_FMU, "travel": way(), "exchange": {"scheme": "parallel", "order": 1}}, moves(geometry="linearised")
    ),
    "bed": one(SOFT_BED, load("vehicle", way(), _HEAVY), moves(geometry="linearised", window=8.0)),
    "shoe": one(
        {**TAUT, "tension": None, "length": 19.9,
         "saddles": {"tower": {"at": [12.0, 1.0], "radius": 3.0, "friction": 0.05}}},
        load("mass", way()),
    ),
    "cut": one({**LONG, "cut": {"at": 15.0, "time": 0.3 * UNTIL}}, load("mass", way())),
    "webbing": one(
        {**TAUT, "tension": "2 kN", "axial_stiffness": None, "law": {"kind": "webbing", "name": "halfMarathon"},
         "hysteresis": {"ratio": 0.7, "stiffness": "60 kN"}},
        load("mass", way()),
    ),
    "measured webbing": one(
        {**TAUT, "tension": "2 kN", "axial_stiffness": None,
         "hysteresis": {"unloading": [0, 4e3, 20e3], "stiffness": 1e5},
         "law": {"kind": "table", "strain": [0, 0.03, 0.1], "tension": [0, 6e3, 25e3]}},
        load("mass", way()),
    ),
    "stretch": one(
        {**TAUT, "axial_stiffness": None, "law": {"kind": "webbing", "stretch": "4 %"}}, load("mass", way())
    ),
    "steps": one(
        {**BEAM, "segments": {"plates": {"from": 4.0, "to": 9.0, "bending_stiffness": "3 GN*m^2", "mass": 2400.0},
                              "damage": {"from": 11.0, "to": 13.0, "damage": 0.4, "foundation": "2 MN/m^2"}}},
        load("mass", way(), _HEAVY), moves(geometry="linearised"),
    ),
    "stiff rest": one(STIFF, None, {"kind": "equilibrium"}),
    # Overhead lines.
    "pantograph": overlap(
        {**SPANS, "element": 0.5, "heights": [0.0, 0.0, 0.12, 0.3], "overlap": "next",
         "condition": {"wear": 0.1, "temperature_rise": 10.0},
         "stitch_wire": {"length": 8.0, "retardation": 1e-4},
         "messenger_supports": {"stiffness": "500 kN/m"}},
        {"kind": "pantograph", "model": "en50318-2002", "travel": way(15.0, 24.0)},
        geometry="linearised",
    ),
    "staggered": section(
        {**SPANS, "contact_wire": {"drag": 0.05, "retardation": 1e-4}, "pre_sag": 0.01,
         "steady_arms": {"stagger": "200 mm", "mass_per_length": 0.7}, "analysed_spans": [2, 2],
         "droppers": {"per_span": 3, "cut": {"droppers": [[1, 2]], "time": 0.1}},
         "messenger_supports": {"stiffness": [1e6, 1e6], "damping": 100.0}},
        {**_OWN, "travel": way(30.0, 22.0)},
    ),
    # Lines held between their ends.
    "held": one(
        {**LONG, "elements": 21, "supports": {
            "saddle": {"at": 4.0, "kind": "fixed"},
            "bearing": {"at": 8.0, "kind": "elastic", "stiffness": [0.0, "200 kN/m"]},
            "slider": {"at": 12.0, "kind": "guided", "along": [1.0, 0.0]},
            "shaker": {"at": 16.0, "kind": "moving", "displacement": shaken()},
        }},
        load("force", way()),
    ),
    "winch": one(
        {**LONG, "end_support": {"kind": "guided", "along": [1.0, 0.0], "force": "5 kN", "damping": 2e3,
                                 "winch": {"speed_limit": 0.05, "dead_band": 20.0}}},
        load("force", way()),
    ),
    # Webs.
    "joined": {"lines": {"rope": TAUT, "hanger": _HANGER}, "loads": {"load": load("mass", way(), air_drag=0.0)},
               "run": moves()},
    "hung": {
        "lines": {"rope": {**TAUT, "elements": 22},
                  "cable": {**LONG, "start": [0.0, 4.0], "end": [20.0, 4.0], "length": 20.4}},
        "hangers": {"row": {"from": "cable", "to": "rope", "count": 2, "mass": 0.2, "axial_stiffness": 1e6}},
        "loads": {"load": load("force", way())}, "run": {"kind": "equilibrium"},
    },
    "tracked": {
        "lines": {"rope": {**RAIL, "end": [12.0, 0.0], "length": 12.0, "elements": 20},
                  "deck": {**DECK, "start": [3.0, -1.0], "end": [9.0, -1.0], "length": 6.0, "elements": 6}},
        "tracks": {"track": {**TRACK, "sleepers": {"spacing": 0.8, "first": 0.3}}},
        "loads": {"load": load("force", way())}, "run": moves(geometry="linearised"),
    },
    "ring": {**_RING, "loads": {"load": load("force", way(start=2.0))}, "run": moves()},
    "block": {
        "joints": {"hook": {"mass": 10.0}},
        "lines": {"rope": {"start": [0, 0], "end": [1, 0.3], "length": 4.5, "mass": 0.1, "axial_stiffness": 1e5,
                           "elements": 30, "drag": 0.5,
                           "sheaves": {"block": {"at": [0.5, -2.0], "to": "hook", "friction": 0.05}}}},
        "loads": {"load": {"kind": "force", "on": "rope", "force": [0.0, -20.0], "travel": way(2.0, 0.5)}},
        "run": moves(),
    },
    "wind": one(
        {**SPATIAL, "wind_drag": 0.02, "end_support": {"kind": "guided", "along": [1.0, 0.0, 0.0], "force": "9 kN",
                                                       "stiffness": "50 kN/m", "damping": 100.0, "mass": 2.0},
         "tension": None, "length": 19.8},
        load("footsteps", **_WALKING),
        wind={"direction": [0.0, 1.0, 0.0], "speed": {"time": [0.0, UNTIL], "value": [20.0, 30.0]}},
    ),
    "net": sheet(NET, load("force", way(3.0, 0.5, path=PATH))),
    "outline": sheet(
        {**{k: v for k, v in NET.items() if k not in ("corner", "sides", "cells")}, **OUTLINE, "mesh": 0.5,
         "edge": {"kind": "soft", "stiffness": "50 kN/m^2", "damping": "50 N*s/m^2"}},
        load("mass", way(3.0, 0.5, path=PATH), mass=2.0),
    ),
    "membrane": sheet({**SHEET, **{k: NET[k] for k in ("corner", "sides", "cells")}},
                      load("mass", way(3.0, 0.5, path=PATH), mass=2.0)),
    "awning": sheet(
        {**SHEET, **OUTLINE, "edge": {"kind": "cable", "axial_stiffness": "2 MN", "mass": 0.5, "tension": "3 kN"}},
        load("footsteps", path=PATH, mass=20.0, model="young", **{"from": 0.2}),
    ),
    "net at rest": sheet(NET, load("force", way(3.0, 0.5, path=PATH)), {"kind": "equilibrium"}),
}  # fmt: skip


def without(tree: Any) -> Any:
    """A tree without what is None."""
    if isinstance(tree, dict):
        return {key: without(value) for key, value in tree.items() if value is not None}
    return [without(value) for value in tree] if isinstance(tree, list) else tree


BASES = {name: without(tree) for name, tree in BASES.items()}
