"""Scenario trees (nested dicts as read from YAML, SI numbers): units and directions of their values, and changes."""

from __future__ import annotations

import copy
import math
import re
from collections.abc import Callable, Iterator
from typing import Any

Tree = dict[str, Any]
Path = tuple[str | int, ...]

UNITS = {
    "gravity": "m/s^2", "start": "m", "end": "m", "at": "m", "position": "m", "displacement": "m", "length": "m",
    "from": "m", "to": "m", "path": "m", "corner": "m", "sides": "m", "margin": "m", "wind_drag": "m", "radius": "m",
    "mass": "kg", "wheel_mass": "kg", "foot_mass": "kg", "leg_stiffness": "N/m", "leg_damping": "N*s/m", "spacing": "m",
    "inertia": "kg*m^2", "tension": "N", "force": "N", "forces": "N",
    "axial_stiffness": "N", "axial_damping": "N*s", "bending_stiffness": "N*m^2", "foundation": "N/m^2",
    "stiffness": "N/m", "damping": "N*s/m", "drag": "1/s", "air_drag": "kg/m", "viscous": "N*s/m", "drive": "N",
    "speed": "m/s", "time": "s", "until": "s", "every": "s", "step": "s", "sample": "s", "accuracy": "m", "weight": "N",
    "frequency": "1/s", "step_length": "m", "air_density": "kg/m^3",
}  # fmt: skip
"""SI units of keys; `mass` and `tension` differ by block, and `value` of a table has the unit of the table."""

VECTORS = ("start", "end", "at", "position", "displacement", "force", "along", "direction", "corner", "sides")
POINTS = ("start", "end", "position", "corner")


def unit_of(path: Path) -> str:
    """Return the SI unit of the number at a path, empty for plain numbers."""
    names = [part for part in path if isinstance(part, str)]
    key = names[-2] if names[-1] == "value" else names[-1]
    if key == "mass" and (names[0] == "hangers" or (names[0] == "lines" and (len(names) == 3 or "segments" in names))):
        return "kg/m"
    if names[0] == "nets" and key in ("mass", "tension", "stiffness"):
        return {"mass": "kg/m", "tension": "N", "stiffness": "N"}[key] if len(names) < 4 else ""
    return UNITS.get(key, "")


def dimension(unit: str) -> tuple[int, int, int]:
    """Return the exponents of metre, kilogram and second of a unit such as "N*m^2" or "kg/m"."""
    base = {"m": (1, 0, 0), "kg": (0, 1, 0), "s": (0, 0, 1), "N": (1, 1, -2), "J": (2, 1, -2), "1": (0, 0, 0)}
    total = [0, 0, 0]
    for sign, name, power in re.findall(r"(^|[*/])(\w+)(?:\^(\d))?", unit):
        for k, exponent in enumerate(base[name]):
            total[k] += (-1 if sign == "/" else 1) * int(power or 1) * exponent
    return total[0], total[1], total[2]


def numbers(tree: Any, path: Path = ()) -> Iterator[tuple[Path, float]]:
    """Yield every number of a tree with its path."""
    if isinstance(tree, dict | list):
        for key, value in tree.items() if isinstance(tree, dict) else enumerate(tree):
            yield from numbers(value, (*path, key))
    elif isinstance(tree, int | float) and not isinstance(tree, bool):
        yield path, tree


def vectors(tree: Any, path: Path = ()) -> Iterator[tuple[Path, list[float]]]:
    """Yield every point and vector, [x, z] or [x, y, z], with its path."""
    key = next((part for part in reversed(path) if isinstance(part, str) and part != "value"), "")
    if isinstance(tree, list) and key in VECTORS and tree and all(isinstance(x, int | float) for x in tree):
        if len(tree) in (2, 3) and not (key in ("at", "force") and _is_list_of_scalars(path)):
            yield path, tree
    elif isinstance(tree, dict | list):
        for part, value in tree.items() if isinstance(tree, dict) else enumerate(tree):
            if part != "time":
                yield from vectors(value, (*path, part))


def _is_list_of_scalars(path: Path) -> bool:
    """Distances of axles, and places of hangers."""
    return path[0] in ("loads", "hangers") and path[-1] == "at" and path[-2] != "payload"


def is_point(path: Path) -> bool:
    """Whether the vector at a path is a place (it moves with a translation)."""
    return path[-1] in POINTS or (path[-1] == "at" and path[0] == "lines")


def get(tree: Any, path: Path) -> Any:
    """Return the value at a path."""
    for part in path:
        tree = tree[part]
    return tree


def put(tree: Any, path: Path, value: Any) -> None:
    """Set the value at a path, in place."""
    get(tree, path[:-1])[path[-1]] = value


def copied(tree: Tree) -> Tree:
    """Return a deep copy in which nothing is shared."""
    return copy.deepcopy(tree)


def mapped(tree: Tree, change: Callable[[Path, list[float]], list[float]]) -> Tree:
    """Return the tree with every point and vector changed."""
    found = copied(tree)
    for path, vector in list(vectors(found)):
        put(found, path, change(path, vector))
    return found


def in_space(tree: Tree) -> Tree:
    """Return the tree with three components in every point and vector."""
    return mapped(tree, lambda _, v: [v[0], 0.0, v[1]] if len(v) == 2 else v)


def turned(tree: Tree, angle: float) -> Tree:
    """Return the tree, in space, rotated about the vertical through the origin."""
    c, s = math.cos(angle), math.sin(angle)
    return mapped(in_space(tree), lambda _, v: [c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]])


def mirrored(tree: Tree) -> Tree:
    """Return the tree with x changed to -x."""
    return mapped(tree, lambda _, v: [-v[0], *v[1:]])


def moved(tree: Tree, by: tuple[float, float, float]) -> Tree:
    """Return the tree translated."""

    def change(path: Path, v: list[float]) -> list[float]:
        own = by if len(v) == 3 else (by[0], by[2])
        return [a + b for a, b in zip(v, own, strict=True)] if is_point(path) else v

    return mapped(tree, change)


def refined(tree: Tree, factor: int = 2) -> Tree:
    """Return the tree with a finer mesh, and finer steps and output (on which steps depend)."""
    found = copied(tree)
    for line in found.get("lines", {}).values():
        line["elements"] = factor * line.get("elements", 100)
    for row in found.get("hangers", {}).values():
        row["elements"] = factor * row.get("elements", 1)
    for net in found.get("nets", {}).values():
        net["cells"] = [factor * n for n in net["cells"]]
    for wires in found.get("overhead_lines", {}).values():
        wires["element"] = wires["element"] / factor
    for key, power in (("every", 1), ("accuracy", 2)):
        if key in found["run"]:
            found["run"][key] /= factor**power
    return found


def loads_of(tree: Tree, line: str = "") -> list[Tree]:
    """Return the loads, or those of a line."""
    return [load for load in tree["loads"].values() if not line or load["on"] == line]


def measures(tree: Tree) -> set[str]:
    """Return what the travels of loads measure."""
    return {load.get("travel", {}).get("measured", "material") for load in loads_of(tree)}
