"""The same scenario in two engines: how far apart they are in rest, first state, path, force, tension and audit."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from .judging import DIFFERS, WORKS
from .structures import BY_NAME, Tree

ALLOWED = {"rest": 0.01, "first": 0.02, "path": 0.02, "force": 0.1, "tension": 0.1}
"""Shape at rest, place of the first contact at the beginning, its path, the force there, largest tension: what a
mesh may leave between two right engines. Forces and tensions ring with the links, and how much depends on the step.
What has no mass gives way by a fifth of F h/T at once on splines, a hundredth of the deflection here."""


def compared(found: Mapping[str, Tree]) -> dict[str, Tree]:
    """The cases, with those that differ from the same thing said in other words marked so."""
    message = dict(found)
    for name, case in found.items():
        table, row, structure, load = name.split(" / ")
        base = found.get(f"{table} / {row} / {BY_NAME[structure].twin} / {load}") if structure in BY_NAME else None
        if base is not None and case["verdict"] == base["verdict"] == WORKS and case["trace"]:
            beyond = {k: v for k, v in apart(base, case).items() if v > ALLOWED[k]}
            if beyond:
                note = ", ".join(f"{aspect} {100 * size:.2g} %" for aspect, size in beyond.items())
                message[name] = {**case, "verdict": DIFFERS, "note": f"differs from {BY_NAME[structure].twin}: {note}"}
    return message


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
            if (
                aspect == "force"
            ):  # at the instant at which a load is set down it is shared by its mass and one particle
                away = away[1:]
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
