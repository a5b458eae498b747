"""Relations between scenarios that say the same thing in other words, or add something that has no effect."""

from __future__ import annotations

from random import Random

import numpy as np

from .compare import MODEST, PLACES, TWO_ENGINES, Sides, comparable
from .geometry import with_fields
from .running import DONE, Fields, engines, length_of, run
from .trees import Tree, copied, measures

APART = 1e-7
"""Of the length of the line, by which two halves of a load are apart: loads at one place are refused."""


# -- Halves ------------------------------------------------------------------------------------------------------


def plain_forces(tree: Tree) -> list[str]:
    """Return the names of forces that no friction holds."""
    return [name for name, load in tree["loads"].items() if load["kind"] == "force" and "contact" not in load]


def halves(tree: Tree, rng: Random) -> Sides:
    """Replace a force by two of half its size at the same place."""
    name = rng.choice(plain_forces(tree))
    found = copied(tree)
    load = found["loads"][name]
    load["force"] = [0.5 * component for component in load["force"]]
    twin = copied(load)
    on = load["on"]
    length = length_of(tree, on) if on in tree.get("lines", {}) else 20.0
    twin["travel"]["from"] += APART * length
    found["loads"]["twin"] = twin

    def back(fields: Fields) -> Fields:
        one = dict(fields)
        one["contact_force", name] = fields["contact_force", name] + fields["contact_force", "twin"]
        return one

    right = with_fields(run(found), back)
    return Sides(run(tree), right, TWO_ENGINES, comparable(tree), engines=engines(tree, found))


# -- Joined lines ------------------------------------------------------------------------------------------------


def splits(tree: Tree) -> bool:
    """Whether the loaded line is a plain rope that can be written as two."""
    if len(tree.get("lines", {})) != 1 or tree["run"]["kind"] == "linear":
        return False
    (line,) = tree["lines"].values()
    extra = {"bending_stiffness", "supports", "sheaves", "saddles", "segments", "foundation"} & set(line)
    return not extra and measures(tree) <= {"material"}


def _moves_forward(load: Tree) -> bool:
    speed = load["travel"]["speed"]
    return max(speed["value"] if isinstance(speed, dict) else [speed]) > 0.0


def joined_lines(tree: Tree, rng: Random) -> Sides | None:
    """Replace a line by two that are joined where no load comes."""
    (name,) = tree["lines"]
    if tree["run"]["kind"] == "quasistatic" and any(_moves_forward(load) for load in tree["loads"].values()):
        return None  # the path ends with the line
    line, length, left = tree["lines"][name], length_of(tree, name), run(tree)
    if left.kind != DONE:
        return None
    places = [values for (variable, _), values in left.fields.items() if variable == "contact_xi"]
    last = max((float(np.nanmax(xi)) for xi in places if np.isfinite(xi).any()), default=0.0)
    count = line["elements"]
    first = max(int(np.ceil(last / length * count)) + 4, count // 3)
    if first > count - 4:
        return None
    part = first / count
    middle = [a + part * (b - a) for a, b in zip(line["start"], line["end"], strict=True)]
    plain = {key: value for key, value in line.items() if key not in ("tension", "start_support", "end_support")}
    hung = {"kind": "joined", "to": "knot"}
    parts = {
        name: {**plain, "end": middle, "length": part * length, "elements": first, "end_support": hung},
        "rest": {**plain, "start": middle, "length": (1 - part) * length, "elements": count - first,
                 "start_support": hung},
    }  # fmt: skip
    for which, own, end in ((name, line, "start_support"), ("rest", line, "end_support")):
        if end in own:
            parts[which][end] = own[end]
    joined = {**tree, "lines": parts, "joints": {"knot": {}}}

    def back(fields: Fields) -> Fields:
        one = dict(fields)
        for variable, skipped in (("position", 1), ("tension", 0)):
            both = fields[variable, name], fields[variable, "rest"][:, skipped:]
            one[variable, name] = np.concatenate(both, axis=1)
        one["reaction", f"{name}.end"] = fields["reaction", "rest.end"]
        return one

    right = with_fields(run(joined), back)
    return Sides(left, right, TWO_ENGINES, comparable(tree), engines=engines(tree, joined))


# -- Nothing added -----------------------------------------------------------------------------------------------


def _far_line(tree: Tree, **more: float) -> Tree:
    line = {"start": [300.0, 40.0], "end": [310.0, 40.0], "tension": 5e3, "mass": 1.0, "axial_stiffness": 1e6,
            "elements": 10, **more}  # fmt: skip
    return {**tree, "lines": {**tree.get("lines", {}), "far": line}}


def _no_wind(tree: Tree) -> Tree:
    lines = {name: {**line, "wind_drag": 0.01} for name, line in tree["lines"].items()}
    return {**tree, "lines": lines, "wind": {"direction": [1.0, 0.0], "speed": 0.0, "air_density": 1.2}}


def _no_spring(tree: Tree) -> Tree:
    name = "rope"
    support = {"kind": "elastic", "at": 0.625 * length_of(tree, name), "stiffness": 0.0}
    line = tree["lines"][name]
    return {**tree, "lines": {**tree["lines"], name: {**line, "supports": {**line.get("supports", {}), "no": support}}}}


def _no_force(tree: Tree) -> Tree:
    load = {"kind": "force", "on": "rope", "force": [0.0, 0.0],
            "travel": {"speed": 0.0, "from": 0.06 * length_of(tree, "rope")}}  # fmt: skip
    return {**tree, "loads": {**tree["loads"], "none": load}}


def _defaults(tree: Tree) -> Tree:
    zero = {"foundation": 0.0, "bending_stiffness": 0.0, "axial_damping": 0.0, "drag": 0.0, "wind_drag": 0.0}
    return {**tree, "lines": {name: {**zero, **line} for name, line in tree["lines"].items()}}


def _impact(tree: Tree) -> Tree:
    return {**tree, "outputs": {"impact": True}}


ADDITIONS = {
    "wind of 0 m/s": _no_wind, "spring without stiffness": _no_spring, "force of 0 N": _no_force,
    "keys of 0": _defaults, "static part (outputs.impact)": _impact, "rope far away": _far_line,
    "stiff line far away": lambda tree: _far_line(tree, bending_stiffness=100.0),
}  # fmt: skip


def _is_joined(line: Tree) -> bool:
    return any(line.get(end, {}).get("kind") == "joined" for end in ("start_support", "end_support"))


def addition(tree: Tree, rng: Random) -> tuple[str, Tree]:
    """Return a scenario with something more that has no effect, and its name."""
    names = list(ADDITIONS)
    if "rope" not in tree.get("lines", {}) or any(len(line["start"]) == 3 for line in tree["lines"].values()):
        names = ["rope far away", "stiff line far away"]
    speeds = [load.get("travel", {}).get("speed") for load in tree["loads"].values()]
    if not all(speeds) or not speeds or tree["run"]["kind"] != "dynamic":  # which need loads that move
        names = [name for name in names if not name.startswith("static")]
    if any({"sheaves", "saddles"} & set(line) or _is_joined(line) for line in tree.get("lines", {}).values()):
        names = [name for name in names if not name.startswith("spring")]  # inner supports are not for such lines
    if tree["run"]["kind"] == "quasistatic":
        names.remove("force of 0 N") if "force of 0 N" in names else None
    name = rng.choice(names)
    return name, ADDITIONS[name](tree)


def nothing_added(tree: Tree, rng: Random) -> Sides:
    """Add something that has no effect."""
    name, more = addition(tree, rng)
    left = run(tree)

    def back(fields: Fields) -> Fields:
        """Compare the nodes that both have: a support is at a node, so that there may be more or others."""
        found = dict(fields)
        for (variable, own), values in left.fields.items():
            other = fields.get(("xi", own)) if variable == "xi" else None
            if other is not None and (len(other) != len(values) or np.abs(other - values).max() > 1e-9 * values[-1]):
                nodes = [int(np.abs(other - xi).argmin()) for xi in values]
                same = np.abs(other[nodes] - values) <= 1e-9 * values[-1]
                r = fields["position", own][:, nodes]
                found["position", own] = np.where(same[:, None], r, left.fields["position", own][: len(r)])
                found["tension", own] = left.fields["tension", own]
        return found

    right = with_fields(run(more), back)
    return Sides(left, right, TWO_ENGINES, comparable(tree), note=name, engines=engines(tree, more))


# -- Bodies ------------------------------------------------------------------------------------------------------


def _bodies(tree: Tree) -> list[str]:
    return [
        name
        for name, load in tree["loads"].items()
        if load["kind"] in ("mass", "oscillator", "vehicle") and load["travel"].get("kind") != "free"
    ]


def has_body(tree: Tree) -> bool:
    """Whether a load is a body that has other names, on level lines: on slopes an oscillator springs along, too."""
    level = all(line["start"][-1] == line["end"][-1] for line in tree.get("lines", {}).values())
    return bool(_bodies(tree)) and level and not tree.get("nets") and tree["run"]["kind"] in ("dynamic", "linear")


def other_body(tree: Tree, rng: Random) -> Sides:
    """Write a mass or an oscillator as a vehicle, and a vehicle by its matrices."""
    name = rng.choice(_bodies(tree))
    found = copied(tree)
    load = found["loads"][name]
    exact = load["kind"] == "vehicle"
    own, owners = (_as_matrices if exact else _as_vehicle)(load, tree["gravity"])
    found["loads"][name] = own | {key: load[key] for key in ("on", "travel")}

    def back(fields: Fields) -> Fields:
        mine = {name + new: name + old for new, old in owners.items()}
        return {(variable, mine.get(owner, owner)): values for (variable, owner), values in fields.items()}

    def heights(fields: Fields) -> Fields:
        """Leave out where bodies are along the line: matrices do not say it, nor vehicles that have left."""
        up = [False, False, True]
        return {key: np.where(up, v, 0.0) if key[0] == "body_position" else v for key, v in fields.items()}

    left, right = with_fields(run(tree), heights), with_fields(run(found), lambda f: heights(back(f)))
    return Sides(left, right, tolerance=1e-5 if exact else MODEST, only=PLACES)


def _as_vehicle(load: Tree, gravity: float) -> tuple[Tree, dict[str, str]]:
    """A mass or an oscillator as a vehicle of one wheel, and the owners of its fields."""
    vehicle: Tree = {"kind": "vehicle", "wheels": {"w": {"mass": load.get("wheel_mass", load["mass"])}}}
    if load["kind"] == "oscillator":
        spring = {"between": ["m", "w"], "stiffness": load["stiffness"], "damping": load["damping"]}
        vehicle |= {"bodies": {"m": {"mass": load["mass"]}}, "springs": {"s": spring}}
    return vehicle, {".w": "", ".m": ""}


def _as_matrices(load: Tree, gravity: float) -> tuple[Tree, dict[str, str]]:
    """A vehicle of one box on two wheels by its matrices, and the owners of its fields."""
    box = load["bodies"]["box"]
    wheels = load["wheels"]
    names = ["box", "pitch", *wheels]
    mass = np.diag([box["mass"], box["inertia"], *(wheel["mass"] for wheel in wheels.values())])
    stiffness, damping = np.zeros((4, 4)), np.zeros((4, 4))
    for name, spring in load["springs"].items():
        row = np.zeros(4)
        row[:2], row[names.index(name)] = (1.0, wheels[name]["at"] - box["at"]), -1.0
        stiffness += spring["stiffness"] * np.outer(row, row)
        damping += spring["damping"] * np.outer(row, row)
    return {
        "kind": "matrices", "coordinates": names, "mass": mass.tolist(), "stiffness": stiffness.tolist(),
        "damping": damping.tolist(), "weight": [gravity * m if k != 1 else 0.0 for k, m in enumerate(np.diag(mass))],
        "wheels": {name: {"at": wheel["at"], "coordinate": name} for name, wheel in wheels.items()},
    }, {f".{name}": f".{name}" for name in ("box", *wheels)}  # fmt: skip
