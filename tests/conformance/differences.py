"""Differences between engines that are known: measured, written beside this file, and each with a reason."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

from .agreement import ALLOWED, apart
from .cases import scenario
from .judging import AUDIT, DOUBTFUL, NOTHING, REFUSED, ROUND_OFF
from .loads import load, travel
from .structures import BY_NAME, STRUCTURES, Structure, Tree
from .working import answer

TWINS = [structure.name for structure in STRUCTURES if structure.twin]
LOADS = ("none", "force", "mass", "fast mass", "oscillator", "vehicle", "footsteps")
FAST = 3.5
"""A mass at 0.7 and 0.8 of the wave speed, where engines differ most."""

FILE = Path(__file__).with_name("known_differences.json")
"""Structure, load, aspect: how far apart they are known to be; the command writes it anew."""

_SPREAD = "another contact: a force is shared by the nodes around it (P3, P7)"
_UPRIGHT = "on stiff lines loads move up and down only, their inertia along the line is left out (P7)"
_ENGINE = "one line with bending stiffness, or wind, changes the engine for all lines (P6)"
REASONS: dict[tuple[str, str], str] = {
    **{
        (engine, aspect): f"{_SPREAD}; {_UPRIGHT}"
        for engine in ("ei", "beside")
        for aspect in ("path", "force", "tension", "audit")
    },
    **{("wind", aspect): _SPREAD for aspect in ("first", "path", "force", "tension", "audit", DOUBTFUL)},
    **{(engine, REFUSED): _ENGINE for engine in ("ei", "beside", "wind")},
}
"""Why engines differ in an aspect; the next issues remove each."""


def pair(name: str, kind: str) -> tuple[Tree, Tree]:
    """What two engines say: of a structure said in plain words, and in others."""
    return _answered(BY_NAME[name].twin, kind), _answered(name, kind)


@cache
def _answered(name: str, kind: str) -> Tree:
    structure = BY_NAME[name]
    tree = scenario(structure, {"load": _load(structure, kind)} if kind != "none" else {})
    return answer({"scenario": tree, "tool": "run", "options": {}})


def _load(s: Structure, kind: str) -> Tree:
    if kind == "fast mass":
        return load(s, "mass", travel(s, speed=FAST * s.speed, **{"from": 1.0}))
    return load(s, kind)


def differences(name: str, kind: str) -> dict[str, float]:
    """Where two engines are further apart than their meshes may make them, and by how much.

    An audit that is open where that of the plain words is closed is a difference, too; who refuses, or stops, differs
    altogether.
    """
    one, other = pair(name, kind)
    if not other["trace"]:
        return {other["verdict"]: 1.0} if one["trace"] else {}
    found = {aspect: size for aspect, size in apart(one, other).items() if size > ALLOWED[aspect]}
    if (audit := _audit(other)) > AUDIT >= _audit(one):
        found["audit"] = audit
    return found


def known() -> dict[str, dict[str, dict[str, float]]]:
    """The known differences, as written last."""
    found: dict[str, dict[str, dict[str, float]]] = json.loads(FILE.read_text(encoding="utf-8"))
    return found


def write() -> None:
    """Measure all differences, and write them as those that are known."""
    found = {}
    for name in TWINS:
        sizes = {kind: {k: float(f"{v:.2g}") for k, v in differences(name, kind).items()} for kind in LOADS}
        found[name] = {kind: own for kind, own in sizes.items() if own}
    FILE.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


def _audit(case: Tree) -> float:
    """Imbalance over the energy turned over; a motion that is none has none."""
    numbers = case["numbers"]
    if numbers["imbalance"] <= max(ROUND_OFF * numbers["energy"], NOTHING):
        return 0.0
    return float(numbers["imbalance"] / numbers["turnover"])
