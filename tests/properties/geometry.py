"""Relations of geometry and dimension: mirror, reversal, translation, rotation, units, scaling, names and order."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from random import Random
from typing import Any

import numpy as np

from .compare import ROUNDING, TWO_ENGINES, Sides, comparable, sizes
from .running import WITH_AXIS, Fields, Outcome, engines, length_of, read, run
from .trees import Tree, copied, dimension, get, in_space, loads_of, measures, mirrored, moved, numbers, put, turned
from .trees import unit_of as unit_at

Map = Callable[[Fields], Fields]


def with_fields(outcome: Outcome, change: Map) -> Outcome:
    """Return an outcome with its fields changed, if it has any."""
    fields = change(outcome.fields) if outcome.fields else {}
    return Outcome(outcome.kind, fields, outcome.text, outcome.doubts)


def transformed(fields: Fields, matrix: Any, origin: Any = (0.0, 0.0, 0.0)) -> Fields:
    """Return fields with vectors multiplied by a matrix, and places translated before that."""
    found = dict(fields)
    for key, values in fields.items():
        if key[0] in WITH_AXIS:
            own = values - np.asarray(origin) if key[0].endswith("position") else values
            found[key] = _product(own, np.asarray(matrix))
    return found


def _product(vectors: Any, matrix: Any) -> Any:
    """Multiply vectors by a matrix; a component that is NaN leaves those alone which do not depend on it."""
    parts = [[vectors[..., b] * factor for b, factor in enumerate(row) if factor] for row in matrix]
    return np.stack([np.sum(part, axis=0) for part in parts], axis=-1)


# -- Mirror, translation, rotation -------------------------------------------------------------------------------


def mirrors(tree: Tree) -> bool:
    """Whether the scenario may run towards -x."""
    return not tree.get("overhead_lines") and "horizontal" not in measures(tree)


def mirror(tree: Tree, rng: Random) -> Sides:
    """Change x to -x."""
    back = np.diag([-1.0, 1.0, 1.0])
    return Sides(run(tree), with_fields(run(mirrored(tree)), lambda f: transformed(f, back)))


def translation(tree: Tree, rng: Random) -> Sides:
    """Move all supports, joints and sheaves; tracks within the x-z plane, which they cannot leave."""
    aside = rng.uniform(-50, 50) if _is_spatial(tree) and turns(tree) and not tree.get("tracks") else 0.0
    by = (rng.uniform(-90, 90), aside, rng.uniform(-30, 30))
    away = moved(tree, by)
    left, right = run(tree), with_fields(run(away), lambda f: transformed(f, np.eye(3), by))
    if other := engines(tree, away):  # beside the x-z plane another engine may compute it
        return Sides(left, right, TWO_ENGINES, comparable(tree), engines=other)
    size = sizes(left.fields) if left.fields else {}
    least = _rounded_friction(tree, float(np.linalg.norm(by))) / ROUNDING
    scales = {name: max(size.get(name, 0.0), least) for name in ("contact_position", "body_position") if least}
    return Sides(left, right, scales=scales)


def _rounded_friction(tree: Tree, reach: float) -> float:
    """Return how far rounding of the places of a beam drives loads that slide on it with friction, m.

    Places are rounded in proportion to their distance from the origin, which changes the bending forces 12 EI / h^3 per
    metre, and with them the friction of a load, whose place has no other restraint.
    """
    found = 0.0
    for load in loads_of(tree):
        line, friction = tree.get("lines", {}).get(load["on"], {}), load.get("travel", {}).get("friction", 0.0)
        if friction and line.get("bending_stiffness") and "until" in tree["run"]:
            h = np.linalg.norm(np.subtract(line["end"], line["start"])) / line["elements"]
            force = 12.0 * line["bending_stiffness"] / h**3 * np.spacing(reach)
            found = max(found, 0.5 * friction * force / load["mass"] * tree["run"]["until"] ** 2)
    return float(found)


def _is_spatial(tree: Tree) -> bool:
    return bool(tree.get("nets")) or any(len(line["start"]) == 3 for line in tree["lines"].values())


def turns(tree: Tree) -> bool:
    """Whether the scenario can be rotated about the vertical: two stiffnesses leave out the third direction."""
    two = any(path[0] == "lines" and path[-2] in ("stiffness", "damping") for path, _ in numbers(tree))
    frictionless = any(load.get("contact") == "frictionless" for load in loads_of(tree))
    return mirrors(tree) and not two and not frictionless and not _is_buckled(tree)


def _is_buckled(tree: Tree) -> bool:
    """Whether a stiff line is too long without weight: in space its bow may turn about the chord, without stiffness."""
    stiff = [line for line in tree.get("lines", {}).values() if "bending_stiffness" in line and "length" in line]
    slack = any(line["length"] > 1.001 * np.linalg.norm(np.subtract(line["end"], line["start"])) for line in stiff)
    return slack and tree["gravity"] == 0.0


def rotation(tree: Tree, rng: Random) -> Sides:
    """Rotate everything about the vertical; a scenario in the plane leaves it."""
    angle = rng.choice([0.0, rng.uniform(0.2, 1.3), math.pi / 2, math.pi, rng.uniform(-3.0, 3.0)])
    c, s = math.cos(angle), math.sin(angle)
    back = [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]
    aside = turned(tree, angle)
    right = with_fields(run(aside), lambda f: transformed(f, back))
    start = tree if not _is_spatial(tree) and rng.random() < 0.5 else in_space(tree)
    if start is tree or engines(start, aside):  # another engine may compute what leaves the x-z plane
        return Sides(run(start), right, TWO_ENGINES, comparable(tree), engines=engines(start, aside))
    return Sides(run(start), right)


# -- Reversal ----------------------------------------------------------------------------------------------------


def reverses(tree: Tree) -> bool:
    """Whether lines can be written from the other end: arc lengths are counted from one of them."""
    rows = [load for load in loads_of(tree) if load["kind"] in ("axles", "train")]  # behind each other, by direction
    standing = any(load["travel"]["speed"] == 0 for load in rows)
    return bool(tree.get("lines")) and measures(tree) <= {"material"} and not standing


def reversal(tree: Tree, rng: Random) -> Sides:
    """Write one line from its end to its start, and send its loads the other way."""
    name = rng.choice(sorted(tree["lines"]))
    return Sides(run(tree), with_fields(run(reversed_line(tree, name)), lambda f: _line_back(f, tree, name)))


def reversed_line(tree: Tree, name: str) -> Tree:
    """Return the tree with a line that runs from its end to its start."""
    found, length = copied(tree), length_of(tree, name)
    line = found["lines"][name]
    line["start"], line["end"] = line["end"], line["start"]
    ends = line.pop("start_support", None), line.pop("end_support", None)
    line |= {key: value for key, value in zip(("end_support", "start_support"), ends, strict=True) if value}
    for support in line.get("supports", {}).values():
        support["at"] = length - support["at"]
    for track in found.get("tracks", {}).values():
        if track["rail"] == name:  # its first sleeper is as far from the start as the last one was from the end
            spacing = track["sleepers"]["spacing"]
            track["sleepers"]["first"] = max(length - spacing * int(length / spacing + 1e-9), 0.0)
    for part in line.get("segments", {}).values():
        part["from"], part["to"] = length - part["to"], length - part["from"]
    for other in found["lines"].values():
        for end in ("start_support", "end_support"):
            if other.get(end, {}).get("to") == name and "at" in other[end]:
                other[end]["at"] = length - other[end]["at"]
    for load in loads_of(found, name):
        reverse_load(load, length)
    return found


def reverse_load(load: Tree, length: float) -> None:
    """Let a load begin as far from the other end, and move the other way."""
    if load["kind"] in ("footsteps", "walker"):
        load |= {"from": length - load["from"], "towards": "start" if load.get("towards") != "start" else "end"}
        return
    travel = load["travel"]
    travel["from"], speed = length - travel["from"], travel["speed"]
    travel["speed"] = {**speed, "value": [-v for v in speed["value"]]} if isinstance(speed, dict) else -speed
    for part in ("bodies", "wheels", "springs"):
        for own in load.get(part, {}).values():
            if "at" in own:
                own["at"] = -own["at"]


def _line_back(fields: Fields, tree: Tree, name: str) -> Fields:
    found = dict(fields)
    for variable in ("position", "tension"):
        found[variable, name] = fields[variable, name][:, ::-1]
    for a, b in (("start", "end"), ("end", "start")):
        found.pop(("reaction", f"{name}.{a}"), None)
        if ("reaction", f"{name}.{b}") in fields:
            found["reaction", f"{name}.{a}"] = fields["reaction", f"{name}.{b}"]
    for row, hangers in tree.get("hangers", {}).items():
        count = hangers["count"]
        for k in range(1, count + 1) if hangers["to"] == name else ():
            for variable in ("position", "tension"):
                found[variable, f"{row}-{k}"] = fields[variable, f"{row}-{count + 1 - k}"]
    return found


def overhead_from_the_other_end(tree: Tree, rng: Random) -> Sides:
    """Let loads pass a symmetric overhead line from its other end."""
    spans = tree["overhead_lines"]["section"]["spans"]
    length, found = spans["count"] * spans["length"], copied(tree)
    for load in loads_of(found):
        if load["kind"] == "train" and load["travel"]["speed"] == 0.0:
            load["travel"]["speed"] = 1e-9  # a sign, which the reversal turns: its vehicles are on the other side then
        reverse_load(load, length)
        if load["kind"] == "force":
            load["force"] = [-load["force"][0], *load["force"][1:]]
        if "payload" in load:
            load["payload"]["at"] = [-load["payload"]["at"][0], *load["payload"]["at"][1:]]

    def back(fields: Fields) -> Fields:
        flipped = {key: v[:, ::-1] if key[0] in ("position", "tension") else v for key, v in fields.items()}
        return transformed(flipped, np.diag([-1.0, 1.0, 1.0]), (length, 0.0, 0.0))

    only = ("position", "tension", "contact_position", "contact_force", "body_position")
    return Sides(run(tree), with_fields(run(found), back), tolerance=1e-3, only=only)


# -- Units and scaling -------------------------------------------------------------------------------------------

_ALTERNATIVES: dict[str, list[tuple[str, float]]] = {
    "m": [("cm", 0.01), ("ft", 0.3048), ("km", 1e3)], "kg": [("t", 1e3), ("lb", 0.45359237)],
    "s": [("ms", 1e-3), ("min", 60.0)], "N": [("kN", 1e3), ("lbf", 4.4482216152605)], "1": [("1", 1.0)],
}  # fmt: skip


def _in_other_units(value: float, unit: str, rng: Random) -> str:
    factor, text = 1.0, ""
    for sign, name, power in re.findall(r"(^|[*/])(\w+)(?:\^(\d))?", unit):
        symbol, size = rng.choice(_ALTERNATIVES[name])
        factor *= size ** ((-1 if sign == "/" else 1) * int(power or 1))
        text += sign + symbol + (f"^{power}" if power else "")
    return f"{value / factor!r} {text}"


def _is_matrix(tree: Tree, path: Any) -> bool:
    matrices = path[0] == "loads" and get(tree, path[:2])["kind"] == "matrices"
    return matrices and path[2] in ("mass", "stiffness", "damping")


def units(tree: Tree, rng: Random) -> Sides:
    """Write every number with another unit."""
    found = copied(tree)
    for path, value in list(numbers(tree)):
        if (unit := unit_at(path)) and not _is_matrix(tree, path) and path[0] != "nets":
            put(found, path, _in_other_units(value, unit, rng))
    return Sides(run(tree), run(found))


def scales(tree: Tree) -> bool:
    """Whether the scenario is of lines, without people and tracks, which have sizes by default."""
    people = any(load["kind"] in ("footsteps", "walker") for load in loads_of(tree))
    return bool(tree.get("lines")) and not people and not tree.get("tracks")


def with_steps(tree: Tree) -> Tree:
    """Return the tree with the keys of a motion that have a dimension, as far as its engine has them."""
    keys = {"accuracy": 1e-4, "sample": tree["run"].get("until", 0.0) / 100.0}
    for names in (("accuracy", "sample"), ("sample",), ("accuracy",)) if tree["run"]["kind"] == "dynamic" else ():
        found = {**tree, "run": {**tree["run"], **{name: keys[name] for name in names}}}
        try:
            read(found)
        except Exception:
            continue
        return found
    return tree


def scaling(tree: Tree, rng: Random) -> Sides:
    """Multiply all lengths, masses and times by factors of their own."""
    base = with_steps(copied(tree))
    for load in loads_of(base):
        if load["kind"] == "train":
            load["gravity"] = 9.81  # its default, also where that of the scenario is 0
    factors = tuple(rng.choice([1.0, rng.uniform(0.2, 5.0)]) for _ in range(3))

    def factor(unit: str) -> float:
        return math.prod(f**n for f, n in zip(factors, dimension(unit), strict=True))

    found = copied(base)
    for path, value in list(numbers(base)):
        if unit := unit_at(path):
            put(found, path, value * factor(unit))
    of = {"tension": "N", "reaction": "N", "contact_force": "N", "energy": "N*m", "time": "s"}

    def back(fields: Fields) -> Fields:
        return {key: values / factor(of.get(key[0], "m")) for key, values in fields.items()}

    return Sides(run(base), with_fields(run(found), back))


# -- Names and order ---------------------------------------------------------------------------------------------

_NAMED = ("lines", "loads", "joints", "nets", "hangers", "overhead_lines", "supports", "sheaves", "saddles", "segments",
          "bodies", "wheels", "springs", "tracks")  # fmt: skip
_REFERENCES = ("on", "to", "from", "between", "coordinate", "coordinates", "rail", "over")


def names_and_order(tree: Tree, rng: Random) -> Sides:
    """Rename everything that has a name, and write keys, lines, loads, wheels and coordinates in another order."""
    names: dict[str, str] = {}
    _collect(tree, names, rng)
    right = run(_rewritten(tree, names, rng))
    original = {new: old for old, new in names.items()}

    def back(fields: Fields) -> Fields:
        return {(variable, _owner_back(owner, original)): values for (variable, owner), values in fields.items()}

    return Sides(run(tree), with_fields(right, back))


def _collect(tree: Any, names: dict[str, str], rng: Random) -> None:
    for key, value in tree.items() if isinstance(tree, dict) else ():
        if key in _NAMED and isinstance(value, dict):
            for name in value:
                names.setdefault(name, f"{rng.choice('azmQ')}{len(names)}{rng.choice('xb')}")
        if key == "coordinates":
            names |= {name: f"{rng.choice('azmQ')}{len(names) + k}q" for k, name in enumerate(value)}
        _collect(value, names, rng)


def _rewritten(tree: Any, names: dict[str, str], rng: Random, key: str = "") -> Any:
    if isinstance(tree, dict):
        if tree.get("kind") == "matrices":
            tree = _permuted(tree, rng)
        items = list(tree.items())
        rng.shuffle(items)
        named = key in _NAMED
        return {names[k] if named else k: _rewritten(v, names, rng, "" if named else k) for k, v in items}
    if isinstance(tree, list):
        return [_rewritten(value, names, rng, key) for value in tree]
    return names.get(tree, tree) if key in _REFERENCES else tree


def _permuted(load: Tree, rng: Random) -> Tree:
    order = rng.sample(range(len(load["coordinates"])), len(load["coordinates"]))
    found = {**load, "coordinates": [load["coordinates"][i] for i in order]}
    for key in {"mass", "stiffness", "damping"} & set(load):
        found[key] = [[load[key][i][j] for j in order] for i in order]
    return found


def _owner_back(owner: str, original: dict[str, str]) -> str:
    parts = [part.rsplit("-", 1) for part in owner.split(".")]
    return ".".join("-".join([original.get(part[0], part[0]), *part[1:]]) for part in parts)
