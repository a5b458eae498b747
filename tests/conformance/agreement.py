"""The same scenario in two engines: how far apart they are in rest, first state, path, force, tension and audit."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .cases import scenario
from .judging import AUDIT, DIFFERS, DOUBTFUL, NOTHING, REFUSED, ROUND_OFF, STOPPED, WORKS
from .loads import load, travel
from .structures import BY_NAME, STRUCTURES, Structure, Tree
from .working import answer

ALLOWED = {"rest": 0.01, "first": 0.01, "path": 0.02, "force": 0.1, "tension": 0.1}
"""Shape at rest, place of the first contact at the beginning, its path, the force there, largest tension: what a
mesh may leave between two right engines. Forces and tensions ring with the links, and how much depends on the step."""

TWINS = [structure.name for structure in STRUCTURES if structure.twin]
LOADS = ("none", "force", "mass", "fast mass", "oscillator", "vehicle", "footsteps")
FAST = 3.5
"""A mass at 0.7 and 0.8 of the wave speed, where engines differ most."""

FILE = Path(__file__).with_name("known_differences.json")
"""Structure, load, aspect: how far apart they are known to be; the command writes it anew."""

_START = "loads on stiff lines start from level ground at the height of the start, not from the line at rest (P4)"
_PLACE = "on stiff lines a contact is at a place of x, not at a particle (P2)"
_SPREAD = "another contact: a force is shared by the nodes around it (P3, P7)"
_ENGINE = "one line with bending stiffness, or wind, changes the engine for all lines (P6)"
REASONS: dict[tuple[str, str], str] = {
    **{(engine, aspect): f"{_START}; {_PLACE}" for engine in ("ei", "beside") for aspect in ("first", "path", "audit")},
    **{(engine, aspect): f"{_START}; {_SPREAD}" for engine in ("ei", "beside") for aspect in ("force", "tension")},
    **{(engine, aspect): _START for engine in ("ei", "beside") for aspect in (STOPPED,)},
    **{("wind", aspect): _SPREAD for aspect in ("first", "path", "force", "tension", "audit", DOUBTFUL)},
    **{(engine, REFUSED): _ENGINE for engine in ("ei", "beside", "wind")},
}
"""Why engines differ in an aspect; the next issues remove each."""


def compared(found: Mapping[str, Tree]) -> dict[str, Tree]:
    """The cases, with those that differ from the same thing said in other words marked so."""
    told = dict(found)
    for name, case in found.items():
        table, row, structure, load = name.split(" / ")
        base = found.get(f"{table} / {row} / {BY_NAME[structure].twin} / {load}") if structure in BY_NAME else None
        if base is not None and case["verdict"] == base["verdict"] == WORKS and case["trace"]:
            beyond = {k: v for k, v in apart(base, case).items() if v > ALLOWED[k]}
            if beyond:
                note = ", ".join(f"{aspect} {100 * size:.2g} %" for aspect, size in beyond.items())
                told[name] = {**case, "verdict": DIFFERS, "note": f"differs from {BY_NAME[structure].twin}: {note}"}
    return told


def apart(one: Tree, other: Tree) -> dict[str, float]:
    """Distances of two answers, each over what it is measured by; what one of them has not is left out.

    Rest, first state and path over the deflection of the line under the load, force over its weight, tension over the
    largest one.
    """
    first, second = one["trace"], other["trace"]
    depth = _depth(first)
    scales = {
        "rest": max(np.ptp(_of(first, "rest")), depth), "first": depth, "path": depth,
        "force": max(one["numbers"].get("weight", 0.0), 1e-9), "tension": float(np.abs(_of(first, "tension")).max()),
    }  # fmt: skip
    found = {}
    for aspect, scale in scales.items():
        if aspect in first and aspect in second:
            away = np.abs(_of(first, aspect) - _of(second, aspect))
            if np.isfinite(away).any():  # both are on their lines at one instant at least
                found[aspect] = float(np.nanmax(away)) / scale
    return found


def _of(trace: dict[str, list[float]], aspect: str) -> NDArray[np.float64]:
    return np.asarray(trace[aspect], dtype=float)


def _depth(trace: dict[str, list[float]]) -> float:
    """How far the line goes down under its load, or hangs at rest, m."""
    if "path" in trace:
        return float(np.nanmax(np.abs(_of(trace, "path") - _of(trace, "path")[0]))) or 1.0
    return float(np.ptp(_of(trace, "rest"))) or 1.0


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
    rows = []
    for name in TWINS:
        own = {kind: {k: float(f"{v:.2g}") for k, v in differences(name, kind).items()} for kind in LOADS}
        lines = [f"    {json.dumps(kind)}: {json.dumps(sizes)}" for kind, sizes in own.items() if sizes]
        rows.append(
            f"  {json.dumps(name)}: {{\n" + ",\n".join(lines) + "\n  }" if lines else f"  {json.dumps(name)}: {{}}"
        )
    FILE.write_text("{\n" + ",\n".join(rows) + "\n}\n", encoding="utf-8")


def _audit(case: Tree) -> float:
    """Imbalance over the energy turned over; a motion that is none has none."""
    numbers = case["numbers"]
    if numbers["imbalance"] <= max(ROUND_OFF * numbers["energy"], NOTHING):
        return 0.0
    return float(numbers["imbalance"] / numbers["turnover"])
