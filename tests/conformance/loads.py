"""Loads of the matrix: every kind of the schema, sized to the structure that it travels on."""

from __future__ import annotations

import math
from typing import Any

from .structures import DOWN, Structure, Tree

STEPPER = "pressing.py:Pressing"
"""A file in the folder in which runs are computed."""

PATH = [[0.5, 1.4], [3.5, 1.6]]


def fmu_file(kg: float) -> str:
    """The FMU of a vehicle of this mass, in the folder in which runs are computed."""
    return f"vehicle-{kg:g}.fmu"


def travel(structure: Structure, **changes: Any) -> Tree:
    """How loads travel on a structure; None takes a key out."""
    if changes.get("kind") == "free":
        found: Tree = {"from": structure.start, "speed": structure.speed, **changes}
    else:
        found = {"speed": structure.speed, "from": structure.start, **changes}
    if structure.is_surface:
        found.setdefault("path", PATH)
        found["from"] = max(found["from"] - structure.start, 0.0)
    return {k: v for k, v in found.items() if v is not None}


def force(s: Structure, **more: Any) -> Tree:
    return {"kind": "force", "force": [0.0, -s.mass * DOWN], **more}


def axles(s: Structure, **more: Any) -> Tree:
    """A train of two axles, of which the second one comes to the line later on short lines."""
    return {"kind": "axles", "forces": 0.5 * s.mass * DOWN, "at": [0.0, 0.8], **more}


def mass(s: Structure, **more: Any) -> Tree:
    return {"kind": "mass", "mass": s.mass, **more}


def oscillator(s: Structure, wheel: float = 0.2, **more: Any) -> Tree:
    k = s.mass * (2.0 * math.pi * 3.0) ** 2
    return {
        "kind": "oscillator", "mass": (1.0 - wheel) * s.mass, "wheel_mass": wheel * s.mass, "stiffness": k,
        "damping": 0.1 * math.sqrt(k * s.mass), **more,
    }  # fmt: skip


def trolley(s: Structure, **more: Any) -> Tree:
    payload = {"mass": 0.7 * s.mass, "length": 2.0, "swing": "10 deg", "stiffness": 0.7 * s.mass * DOWN / 0.01}
    return {"kind": "trolley", "mass": 0.3 * s.mass, "payload": payload, **more}


def vehicle(s: Structure, wheel: float = 0.15, **more: Any) -> Tree:
    body = (1.0 - 2.0 * wheel) * s.mass
    k = 0.5 * s.mass * (2.0 * math.pi * 3.0) ** 2
    spring = {"stiffness": k, "damping": 0.1 * math.sqrt(k * s.mass)}
    return {
        "kind": "vehicle", "bodies": {"box": {"mass": body, "inertia": 0.5 * body}},
        "wheels": {"front": {"at": 0.8, "mass": wheel * s.mass}, "rear": {"at": -0.8, "mass": wheel * s.mass}},
        "springs": {"front": {"between": ["box", "front"], **spring}, "rear": {"between": ["box", "rear"], **spring}},
        **more,
    }  # fmt: skip


def train(s: Structure, **more: Any) -> Tree:
    """Two vehicles of which the second one comes to the line later on short lines."""
    car = {key: part for key, part in vehicle(s).items() if key != "kind"}
    half = {"box": {"mass": 0.35 * s.mass, "inertia": 0.1 * s.mass}}
    wheels = {name: {"at": at, "mass": 0.075 * s.mass} for name, at in (("front", 0.3), ("rear", -0.3))}
    return {"kind": "train", "vehicles": {"car": {**car, "length": 1.2, "bodies": half, "wheels": wheels}},
            "order": ["2 car"], **more}  # fmt: skip


def matrices(s: Structure, **more: Any) -> Tree:
    k, m = s.mass * (2.0 * math.pi * 3.0) ** 2, s.mass
    return {
        "kind": "matrices", "coordinates": ["body", "wheel"], "mass": [[0.8 * m, 0.0], [0.0, 0.2 * m]],
        "stiffness": [[k, -k], [-k, k]], "wheels": {"wheel": {"coordinate": "wheel"}}, **more,
    }  # fmt: skip


def way(s: Structure) -> Tree:
    """Where loads without a travel begin."""
    return {"path": PATH} if s.is_surface else {"from": s.start}


def footsteps(s: Structure, **more: Any) -> Tree:
    return {"kind": "footsteps", "mass": s.mass, **way(s), **more}


def crowd(s: Structure, **more: Any) -> Tree:
    """Three people who stand and walk anywhere."""
    return {"kind": "crowd", "number": 3, "mass": {"mean": s.mass / 3.0, "deviation": 0.05 * s.mass},
            **({"path": PATH} if s.is_surface else {}), **more}  # fmt: skip


def walker(s: Structure, **more: Any) -> Tree:
    return {"kind": "walker", "mass": s.mass, "leg_stiffness": 175.0 * s.mass, "foot_mass": 0.02 * s.mass,
            "leg_damping": 2.0 * s.mass, **way(s), **more}  # fmt: skip


def stepper(s: Structure, **more: Any) -> Tree:
    options = {"force": s.mass * DOWN, "start": way(s).get("from", 0.0), "speed": s.speed}
    return {"kind": "stepper", "model": STEPPER, "options": options, "every": 1e-3, **way(s), **more}


def fmu(s: Structure, **more: Any) -> Tree:
    contacts = {"front": {"force": "contact1.force", "height": "contact1.height", "velocity": "contact1.velocity",
                          "force_factor": 1.0, "height_from": "zero"}}  # fmt: skip
    return {"kind": "fmu", "file": fmu_file(s.mass), "contacts": contacts, "every": 5e-4, **more}


def pantograph(s: Structure, **more: Any) -> Tree:
    return {"kind": "pantograph", "model": "en50318-2002", **more}


_HEAD: Tree = {"spacing": 2.0, "pitch": {"inertia": 2.0, "spring_spacing": 1.5},
               "roll": {"inertia": 1.0, "spring_spacing": 0.9}}  # fmt: skip
"""Strips two of the links of a metre apart that contact wires have here."""


def load(s: Structure, kind: str, moved: Tree | None = None, **more: Any) -> Tree:
    """A load of a kind or variant on a structure, travelling as said (default: along it, at constant speed)."""
    tree = KINDS[kind](s)
    own = moved if moved is not None else travel(s, **({"kind": "free"} if kind == "carriage" else {}))
    if tree["kind"] in ("axles", "train"):
        own = {key: own[key] for key in ("speed", "from", "measured") if key in own}
    if tree["kind"] not in ("footsteps", "crowd", "walker", "stepper"):
        tree["travel"] = own
    return {**tree, "on": s.on, **more}


def carriage(s: Structure, **more: Any) -> Tree:
    cabin = {"mass": 0.6 * s.mass, "hanger": 2.0, "inertia": 0.1 * s.mass, "damping": 0.2 * s.mass}
    return {"kind": "carriage", "mass": 0.4 * s.mass, "rockers": [0.3, 0.8], "cabin": cabin, **more}


KINDS: dict[str, Any] = {
    "force": force,
    "force in a table": lambda s: force(s, force={
        "time": [0.0, 0.5 * s.until, s.until], "value": [[0.0, 0.0], [0.0, -s.mass * DOWN], [0.0, 0.0]]}),
    "force ahead": lambda s: force(s, force=[0.2 * s.mass * DOWN, -s.mass * DOWN]),
    "force aside": lambda s: force(s, force=[0.0, 0.2 * s.mass * DOWN, -s.mass * DOWN]),
    "axles": axles,
    "mass": mass,
    "pushed mass": lambda s: mass(s, force=[0.0, -0.5 * s.mass * DOWN]),
    "mass in air": lambda s: mass(s, air_drag=0.01 * s.mass / 5.0),
    "oscillator": oscillator,
    "light oscillator": lambda s: oscillator(s, 0.0),
    "trolley": trolley,
    "carriage": carriage,
    "vehicle": vehicle,
    "train": train,
    "light vehicle": lambda s: vehicle(s, 0.0),
    "matrices": matrices,
    "footsteps": footsteps,
    "crowd": crowd,
    "footsteps aside": lambda s: footsteps(s, lateral="bachmann"),
    "walker": walker,
    "walker aside": lambda s: walker(s, balance={}),
    "stepper": stepper,
    "fmu": fmu,
    "pantograph": pantograph,
    "pantograph with strips": lambda s: pantograph(s, head=_HEAD),
}  # fmt: skip
"""Every kind of load, with variants that engines treat on their own."""
