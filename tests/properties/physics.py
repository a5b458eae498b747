"""Relations between models: superposition, reciprocity, limits that are slow or small, energy and equilibrium."""

from __future__ import annotations

from random import Random

import numpy as np

from .compare import MODEST, Sides, difference, sizes
from .draw import DOWN
from .geometry import with_fields
from .running import DONE, Fields, Outcome, length_of, run
from .trees import Tree, copied, loads_of, measures, numbers

GIVEN = ("force", "axles", "footsteps")


def _with_loads(tree: Tree, loads: Tree) -> Tree:
    return {**tree, "loads": loads}


def _is_linear(tree: Tree) -> bool:
    """Whether the run is linear in its forces: droppers of moving overhead lines slacken."""
    linearised = tree["run"].get("geometry") == "linearised" and not tree.get("overhead_lines")
    return (tree["run"]["kind"] == "linear" or linearised) and "start" not in tree["run"]


def superposes(tree: Tree) -> bool:
    """Whether responses add up: of given forces in linear kinds."""
    loads = loads_of(tree)
    given = all(load["kind"] in GIVEN and "contact" not in load for load in loads)
    return _is_linear(tree) and bool(loads) and given and measures(tree) <= {"material"}


def _enlarged(tree: Tree, factors: dict[str, float]) -> Outcome:
    """Run a tree with forces, and people, of other sizes."""
    found = copied(tree)
    for name, factor in factors.items():
        load = found["loads"][name]
        for key in {"force", "forces", "mass"} & set(load):
            own = load[key]
            load[key] = [factor * value for value in own] if isinstance(own, list) else factor * own
    return run(found)


def superposition(tree: Tree, rng: Random) -> Sides:
    """Enlarge loads one by one and together: what each adds adds up, and of one load each size adds as much."""
    names = list(tree["loads"])
    base, whole = run(tree), _enlarged(tree, dict.fromkeys(names, 2.0 if len(names) > 1 else 3.0))
    outcomes = [_enlarged(tree, {name: 2.0}) for name in (names if len(names) > 1 else names * 2)]
    failed = [one for one in (base, *outcomes) if one.kind != DONE]
    right = failed[0] if failed else Outcome(DONE, _sum(base.fields, [one.fields for one in outcomes]))
    return Sides(whole, right, only=("position", "reaction"), scales=_motion(whole.fields, base.fields))


def _sum(none: Fields, parts: list[Fields]) -> Fields:
    return {key: base + sum(part[key] - base for part in parts) if key[0] in ("position", "reaction") else base
            for key, base in none.items()}  # fmt: skip


def _motion(fields: Fields, none: Fields) -> dict[str, float]:
    """The largest displacement by the loads, as the size of positions."""
    own = [np.abs(values - none[key]).max() for key, values in fields.items() if key[0] == "position" and key in none]
    return {"position": float(max(own, default=1.0)) or 1.0}


def reciprocates(tree: Tree) -> bool:
    """Whether a line moves linearly, and by the force alone: what supports excite depends on the step, too."""
    line = tree.get("lines", {}).get("rope")
    moves = line is not None and not {"sheaves", "saddles"} & set(line)  # over which its nodes move
    ends = [(line or {}).get(key, {}) for key in ("start_support", "end_support")]
    moves = moves and not any(isinstance(end.get("displacement"), dict) for end in ends)
    return _is_linear(tree) and moves and not tree.get("tracks")


def reciprocity(tree: Tree, rng: Random) -> Sides:
    """Exchange the places of a vertical force and of the deflection that is looked at."""
    line, none = tree["lines"]["rope"], run({**tree, "loads": {}})
    parts = [k / 8 for k in rng.sample(range(2, 7), 2)]
    xi = none.fields.get(("xi", "rope"), np.linspace(0.0, length_of(tree, "rope"), 9))
    nodes = [int(np.abs(xi - part * xi[-1]).argmin()) for part in parts]
    force = [0.0] * (len(line["start"]) - 1) + [-1e-3 * (line.get("tension") or 1e3 * line["mass"])]
    outcomes, largest = [], []
    for node, other in (nodes, nodes[::-1]):
        load = {"kind": "force", "on": "rope", "force": force, "travel": {"speed": 0.0, "from": float(xi[node])}}
        outcome = run({**tree, "loads": {"force": load}})
        if outcome.kind == none.kind == DONE:
            moved = (outcome.fields["position", "rope"] - none.fields["position", "rope"])[..., 2]
            largest.append(float(np.abs(moved).max()))
            outcome = Outcome(DONE, {("deflection", ""): moved[:, other]}, doubts=outcome.doubts)
        outcomes.append(outcome)
    scale = {"deflection": max(largest, default=1.0) or 1.0}
    return Sides(*outcomes, only=("deflection",), scales=scale, tolerance=1e-3, path=False)


# -- Limits ------------------------------------------------------------------------------------------------------


def _with_a_force(tree: Tree, part: float, way: float) -> tuple[Tree, Tree]:
    """Return the tree with one vertical force on its first line, a part of its tension or weight, and this load."""
    name, line = next(iter(tree["lines"].items()))
    length = length_of({**tree, "loads": {}}, name)
    size = part * (line.get("tension") or DOWN * line["mass"] * length)
    travel = {"speed": way / tree["run"]["until"], "from": 0.3 * length}
    force = [0.0] * (len(line["start"]) - 1) + [-size]
    load = {"kind": "force", "on": name, "force": force, "travel": travel}
    return {**tree, "loads": {"force": load}, "run": dict(tree["run"])}, load


def moves_slowly(tree: Tree) -> bool:
    """Whether lines whose supports stand still are in motion."""
    ends = [line.get(end, {}) for line in tree.get("lines", {}).values() for end in ("start_support", "end_support")]
    still = bool(ends) and not any(end.get("kind") == "moving" for end in ends)
    return tree["run"]["kind"] == "dynamic" and "geometry" not in tree["run"] and still


def slow_motion(tree: Tree, rng: Random) -> Sides:
    """Let a load move slowly from equilibrium: its motion is a row of equilibria."""
    until = 2.0 * tree["run"]["until"]
    found, load = _with_a_force({**tree, "run": {**tree["run"], "until": until}}, 0.01, 0.1)
    found["run"] |= {"every": until / 8, "start": {"with_loads": True}}
    last = with_fields(run(found), lambda f: {key: values[-1:] for key, values in f.items()})
    only = ("position", "tension", "reaction", "contact_position")
    still = _at(found, [load["travel"]["from"] + 0.1])
    return Sides(run(still), last, tolerance=2.0 * MODEST, only=only, path=False)


def _at(tree: Tree, places: list[float]) -> Tree:
    """The equilibrium with loads at places."""
    found = copied(tree)
    found["run"] = {"kind": "equilibrium"}
    for load, place in zip(found["loads"].values(), places, strict=True):
        load["travel"]["from"] = place
    return found


def is_quasistatic(tree: Tree) -> bool:
    """Whether a run is quasi-static, on lines."""
    axles = any(load["kind"] == "axles" for load in loads_of(tree))
    quasistatic = tree["run"]["kind"] == "quasistatic" and bool(tree.get("lines"))
    return quasistatic and measures(tree) <= {"material"} and not axles


def equilibria(tree: Tree, rng: Random) -> Sides | None:
    """Compare a position of a quasi-static run with the equilibrium of the loads there."""
    slowly = run(tree)
    if slowly.kind != DONE:
        return None
    frame = rng.choice([0, 1, 2])
    if any("displacement" in path and "time" in path for path, _ in numbers(tree["lines"])):
        frame = 0  # supports move on the way
    places = [float(slowly.fields["contact_xi", name][frame]) for name in tree["loads"]]
    if not np.isfinite(places).all():
        return None
    left = with_fields(slowly, lambda f: {key: v[frame : frame + 1] for key, v in f.items()})
    return Sides(left, run(_at(tree, places)), path=False)


def is_small(tree: Tree) -> bool:
    """Whether the run is that of one straight, level, plain line."""
    lines = list(tree.get("lines", {}).values())
    if len(lines) != 1 or tree["run"]["kind"] not in ("dynamic", "linear"):
        return False
    level = lines[0]["start"][-1] == lines[0]["end"][-1]
    straight = "tension" in lines[0] or lines[0]["mass"] > 500
    return level and straight and not {"start_support", "end_support", "supports", "sheaves", "saddles"} & set(lines[0])


def small_amplitude(tree: Tree, rng: Random) -> Sides:
    """Let a small vertical force act without gravity: the linear theory is the limit."""
    keys = {key: tree["run"][key] for key in ("until", "every")}
    ((name, line),) = tree["lines"].items()
    damping = {"axial_damping"} | ({"drag"} if "bending_stiffness" not in line else set())  # left out with a warning
    plain = {name: {key: value for key, value in line.items() if key not in damping}}
    base = {**tree, "gravity": 0.0, "lines": plain, "run": {"kind": "dynamic", **keys}}
    found, _ = _with_a_force(base, 1e-5, 4.0)
    left, right = run(found), run({**found, "run": {"kind": "linear", **keys}})

    def height(fields: Fields) -> Fields:
        return {key: values * [0.0, 0.0, 1.0] if key[0] == "position" else values for key, values in fields.items()}

    left, right = with_fields(left, height), with_fields(right, height)
    moved = [np.ptp(values) for key, values in left.fields.items() if key[0] == "position"]
    scale = {"position": float(max(moved, default=1.0)) or 1.0}
    return Sides(left, right, tolerance=MODEST, only=("position",), scales=scale)


# -- Balance -----------------------------------------------------------------------------------------------------


def energy(tree: Tree, rng: Random) -> Sides | None:
    """Compare the energy balance with zero."""
    outcome = run(tree)
    if outcome.kind != DONE:
        return None
    forms = {key: values for key, values in outcome.fields.items() if key[0] == "energy"}
    moved = max(float(np.ptp(values)) for key, values in forms.items() if key[1] != "imbalance")
    total = max(float(np.abs(values).max()) for values in forms.values())
    key = "energy", "imbalance"
    left, right = Outcome(DONE, {key: forms[key]}, doubts=outcome.doubts), Outcome(DONE, {key: 0.0 * forms[key]})
    size = max(moved, 1e-5 * total, 1e-6)
    return Sides(left, Outcome(DONE, right.fields, doubts=outcome.doubts), MODEST, scales={"energy": size}, path=False)


def _is_borne(tree: Tree) -> bool:
    """Whether supports alone bear loads and weights of lines."""
    lines = tree.get("lines", {}).values()
    extra = any({"foundation", "segments", "drag"} & set(line) for line in lines)
    heavy = any(line.get(end, {}).get("mass") for line in lines for end in ("start_support", "end_support"))
    return bool(lines) and not (extra or heavy or tree.keys() & {"joints", "hangers", "tracks"})


def is_static(tree: Tree) -> bool:
    """Whether forces balance at rest."""
    given = all(load["kind"] in ("force", "mass") for load in loads_of(tree))
    return tree["run"]["kind"] in ("equilibrium", "quasistatic") and given and _is_borne(tree)


def _forces(tree: Tree, fields: Fields) -> np.ndarray:
    """Return the sum of support forces, contact forces and weights of lines, (frame, 3) N."""
    parts = [np.nan_to_num(values) for key, values in fields.items() if key[0] in ("reaction", "contact_force")]
    mass = sum(line["mass"] * fields["xi", name][-1] for name, line in tree["lines"].items())
    return np.asarray(sum(parts) - np.array([0.0, 0.0, tree["gravity"] * mass]))


def support_forces(tree: Tree, rng: Random) -> Sides | None:
    """Compare the sum of all forces at rest with zero."""
    outcome = run(tree)
    if outcome.kind != DONE:
        return None
    borne = {("reaction", "sum"): _forces(tree, outcome.fields)}
    right = Outcome(DONE, {key: 0.0 * values for key, values in borne.items()})
    return Sides(Outcome(DONE, borne, doubts=outcome.doubts), right, 1e-4, scales=sizes(outcome.fields), path=False)


def has_momentum(tree: Tree) -> bool:
    """Whether a motion from rest is by forces that results show."""
    return tree["run"]["kind"] == "dynamic" and "geometry" not in tree["run"] and _is_borne(tree)


def momentum(tree: Tree, rng: Random) -> Sides | None:
    """Compare the way of the centre of mass with the double integral of all forces, by the trapezoidal rule.

    Forces that ring faster than 200 instants resolve are integrated by 800.
    """
    sides = _momentum(tree, 25)
    return _momentum(tree, 100) if sides is not None and difference(sides).size > 1.0 else sides


def _momentum(tree: Tree, instants: int) -> Sides | None:
    """Integrate forces at so many instants for each of output."""
    keys = tree["run"]
    outcome = run({**tree, "run": {**keys, "every": keys["every"] / instants}})
    if outcome.kind != DONE:
        return None
    fields, moved, mass = outcome.fields, 0.0, 0.0
    for name, line in tree["lines"].items():
        step = np.diff(fields["xi", name])
        nodes = line["mass"] * 0.5 * (np.append(step, 0.0) + np.append(0.0, step))
        away = fields["position", name] - fields["position", name][0]
        moved, mass = moved + np.einsum("n,tna->ta", nodes, away), mass + nodes.sum()
    time = fields["time", ""]
    force = _forces(tree, fields) / mass
    speed = np.vstack([np.zeros(3), np.cumsum(0.5 * np.diff(time)[:, None] * (force[1:] + force[:-1]), axis=0)])
    way = np.vstack([np.zeros(3), np.cumsum(0.5 * np.diff(time)[:, None] * (speed[1:] + speed[:-1]), axis=0)])
    up = np.array([0.0, 0.0, 1.0])
    left, right = (Outcome(DONE, {("position", "centre"): v * up}, doubts=outcome.doubts) for v in (moved / mass, way))
    size = float(np.abs(left.fields["position", "centre"]).max())
    return Sides(left, right, 2.0 * MODEST, scales={"position": max(size, 1e-6)}, path=False)
