"""Differences between two outcomes, by variable, relative to the size of the variable."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from .running import CRASH, DONE, OWNERS, WITH_AXIS, Fields, Outcome
from .trees import Tree

ROUNDING = 1e-5
"""Relative difference that rounding makes: equilibria end at a residual of 1e-9, motions repeat it for 1e3 steps."""

SMALLEST_SAG = 1e-4
"""Of the extent of the structure: displacements are not compared with less."""

QUIET = 1e-6
"""Of all energy, and of the largest tension times the sag: less than this is no motion."""

LEAST_FORCE = 1.0
"""Newton; all loads are heavier."""

EVENTS = 1
"""Instants at which a contact may be on the line on one side only: rounding decides about one that comes just then."""

TWO_ENGINES = 1e-3
"""Relative difference of the time steps of two engines, in places."""

DOUBTFUL = "one side is doubtful"
"""Note of a difference."""

MODEST = 0.02
"""Relative difference between two models that agree in the limit (slow, small, another kind of body)."""


FORCES = ("tension", "reaction", "contact_force")
RINGING = 20.0
"""By which forces of motions and their work are compared more roughly: they repeat the residual of the start."""

PLACES = ("position", "contact_position", "body_position")
STATIC = tuple(name for name in OWNERS if name != "energy")


def comparable(tree: Tree) -> tuple[str, ...]:
    """Return the variables that two discretisations of one thing agree on in the limit.

    In motion, forces ring at the frequencies of the mesh after each sudden start, and do not converge at an instant.
    """
    return PLACES if tree["run"]["kind"] == "dynamic" else STATIC


@dataclass(frozen=True)
class Sides:
    """Two outcomes that mechanics relates, the second one mapped back to the first."""

    left: Outcome
    right: Outcome
    tolerance: float = ROUNDING
    only: tuple[str, ...] = tuple(OWNERS)
    scales: dict[str, float] | None = None  # by variable, instead of those of the left side
    note: str = ""  # added to the difference
    engines: str = ""  # that differ
    path: bool = True  # whether both have the same instants, or positions of the load


@dataclass(frozen=True)
class Difference:
    """The largest relative difference of two sides: 0 where they agree, infinite where they are no like things."""

    size: float
    what: str = ""


def difference(sides: Sides) -> Difference:
    """Return the largest difference, relative to the size of its variable and in units of the tolerance.

    Two refusals agree, and so do two runs that stop; one of either kind on its own side does not, nor does a crash.
    """
    left, right = sides.left, sides.right
    if CRASH in (left.kind, right.kind):
        return Difference(np.inf, f"crash: {left.text if left.kind == CRASH else right.text}")
    if left.kind != right.kind:
        return Difference(np.inf, f"{left.kind} and {right.kind}: {left.text or right.text}{_notes(sides)}")
    if left.kind != DONE or (left.doubts and right.doubts):
        return Difference(0.0, left.kind)
    found = max(_differences(sides), key=_first_of_paths, default=Difference(0.0))
    return Difference(found.size, found.what + _notes(sides))


def _first_of_paths(found: Difference) -> tuple[bool, float]:
    """Order differences by size, after those of instants or load paths, by which all else differs."""
    return found.size > 1.0 and found.what.startswith(("time", "load_path")), found.size


def _notes(sides: Sides) -> str:
    """Return what sides tell of themselves, in brackets."""
    doubtful = DOUBTFUL if sides.left.doubts or sides.right.doubts else ""
    notes = ", ".join(note for note in (sides.note, sides.engines, doubtful) if note)
    return f" ({notes})" if notes else ""


def _differences(sides: Sides) -> Iterable[Difference]:
    left, right = sides.left.fields, sides.right.fields
    path = ("time", "load_path") if sides.path else ()
    static = (
        ("energy",) if ("load_path", "") in left else ()
    )  # a part of it is known to the tolerance of the equilibrium
    names = [key for key in left if key[0] in (*sides.only, *path) and key[0] not in static]
    scales = {**sizes(left), **(sides.scales or {})}
    for key in names:
        label = " ".join(part for part in key if part)
        if key not in right:
            yield Difference(np.inf, f"{label} is missing")
            continue
        if key[0] in FORCES and scales[key[0]] <= LEAST_FORCE:
            continue  # nothing presses, as a mass without gravity: what is left is rounding
        a, b = left[key], right[key]
        if a.shape != b.shape:
            yield Difference(np.inf, f"{label} has {a.shape} and {b.shape} values")
        elif int((np.isnan(a) != np.isnan(b)).reshape(len(a), -1).any(axis=1).sum()) > EVENTS:
            yield Difference(np.inf, f"{label} is NaN on one side")
        elif np.isfinite(a - b).any():
            if key[0] == "energy":  # its zero moves with the scenario
                a, b = a - a[0], b - b[0]
            apart = float(np.nanmax(np.abs(a - b))) / scales[key[0]]
            allowed = sides.tolerance * (RINGING if key[0] in (*FORCES, "energy") and ("time", "") in left else 1.0)
            yield Difference(apart / allowed, f"{label} differs by {apart:.2g} of {scales[key[0]]:.3g}")


def sizes(fields: Fields) -> dict[str, float]:
    """Return the size of each variable: the largest distance of lines from their chords, the largest force, ..."""
    found: dict[str, float] = {}
    for (name, _), values in fields.items():
        if name in (*OWNERS, "time", "load_path") and values.size and np.isfinite(values).any():
            size = float(np.nanmax(np.abs(values)))
            if name == "energy":
                size = float(np.nanmax(np.abs(values - values[0]))) + QUIET * size
            found[name] = max(found.get(name, 0.0), size)
    places = [values for (name, _), values in fields.items() if name == "position" and values.ndim == 3]
    extent = max((float(np.ptp(values, axis=(0, 1)).max()) for values in places), default=1.0)
    sag = max([SMALLEST_SAG * extent, *map(_sag, places)])
    force = max((found.get(name, 0.0) for name in ("contact_force", "reaction")), default=0.0)
    found |= {name: sag for name in WITH_AXIS if name.endswith("position")}
    tension = max(found.get("tension", 0.0), force, LEAST_FORCE)
    found |= {"reaction": max(force, QUIET * tension, 1e-3 * LEAST_FORCE), "tension": tension}
    found["contact_force"] = max(found.get("contact_force", 0.0), QUIET * tension)
    found["energy"] = max(found.get("energy", 0.0), QUIET * tension * sag)
    if found["contact_force"] <= LEAST_FORCE:  # nothing presses: friction works by the rounding of forces
        found["energy"] = max(found["energy"], LEAST_FORCE * _distance(fields))
    return {name: size or 1.0 for name, size in found.items()}


def _distance(fields: Fields) -> float:
    """Return the largest distance that a load moves."""
    places = [v for (name, _), v in fields.items() if name == "contact_position" and np.isfinite(v).any()]
    return max((float(np.nanmax(np.linalg.norm(v - v[0], axis=-1), initial=0.0)) for v in places), default=0.0)


def _sag(values: np.ndarray) -> float:
    """Return the largest distance of nodes from the line through the first and the last one of the first frame."""
    first = values[0, 0]
    chord = values[0, -1] - first
    chord = chord / max(float(np.linalg.norm(chord)), 1e-12)
    off = values - first
    off = off - (off @ chord)[..., None] * chord
    return float(np.linalg.norm(off, axis=-1).max())
