"""What a result is worth: finite, its audit closed, its forces within reason; measured from the result alone."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ropewalk.results.frame import ENERGY_FORMS, OFF_LINE
from ropewalk.results.statistics import turnover

from .structures import DOWN, Tree

WORKS, DOUBTFUL, STOPPED, REFUSED, WRONG, CRASH = "works", "doubtful", "stopped", "refused", "WRONG", "CRASH"
DIFFERS = "DIFFERS"
"""Works by itself, and is not what another engine says to the same thing."""

AUDIT = 0.05  # imbalance over the energy turned over; a coarse mesh of a right engine stays below
ABSURD = 50.0  # times the static scale: sudden loads double it, and blows on slack ropes make it tenfold
FOLDED = 0.02  # compression at rest over the largest tension there: a cable hangs, it does not push
ROUND_OFF = 3e-7  # of all energy there is: what a line at rest may move by
NOTHING = 1e-9  # J
BALANCE = 0.01  # support forces at rest against the weights
LOADED = "rope"  # the line with the loads
SOFT = 1e3  # N m^2
_PLACES = 9  # of a trace


@dataclass
class Verdict:
    """What came of a case."""

    verdict: str
    note: str = ""
    numbers: dict[str, float] = field(default_factory=dict)
    trace: dict[str, list[float]] = field(default_factory=dict)  # to be compared with another engine

    def as_dict(self) -> Tree:
        """Plain values for a line of JSON."""
        return {"verdict": self.verdict, "note": self.note, "numbers": self.numbers, "trace": self.trace}


def judge(result: xr.Dataset) -> Verdict:
    """The verdict on a result, with numbers that prove it."""
    tree: Tree = json.loads(result.attrs["scenario"])
    numbers = measured(result, tree)
    outcome = result.attrs["outcome"]
    if outcome not in ("completed", "doubtful"):
        return Verdict(STOPPED, f"{outcome}: {result.attrs['advice']}", numbers)
    if outcome == "doubtful":
        return Verdict(DOUBTFUL, result.attrs["doubts"], numbers, trace_of(result))
    wrong = "; ".join(mistakes(result, tree, numbers))
    return Verdict(WRONG if wrong else WORKS, wrong, numbers, trace_of(result))


def measured(result: xr.Dataset, tree: Tree) -> dict[str, float]:
    """Audit, largest forces and tensions, and their static scales."""
    found: dict[str, float] = {"frames": float(len(_path(result)))}
    energy = result["energy"].values
    if energy.size and "time" in result.dims:
        moved, audit = float(turnover(energy).max()), energy[:, ENERGY_FORMS.index("imbalance")]
        found |= {
            "turnover": moved,
            "imbalance": float(np.abs(audit).max()),
            "energy": float(np.nanmax(np.abs(energy))),
        }  # NaN stays NaN
    tension = np.abs(result["tension"].values)
    if tension.size:
        inner = _inner(result, np.broadcast_to(result["link_xi"].values, tension.shape))
        found |= {"tension": _largest(tension[inner]), "tension at an end": _largest(tension[~inner]),
                  "tension at first": _largest(tension[0])}  # fmt: skip
    found |= {name: size for name, size in _pressed(result) if np.isfinite(size)}
    found["weight"] = sum(_weight(load) for load in tree["loads"].values())
    return found


def _pressed(result: xr.Dataset) -> Iterator[tuple[str, float]]:
    """The largest contact forces, N; those beside an end of a line stand apart.

    A mass at prescribed speed comes to a support with a force that grows without bound on the way, and with it the
    tension of the piece that is left; it is stopped, or put on the line, by a blow.
    """
    force = np.linalg.norm(result["contact_force"].values, axis=2)
    inner = _inner(result, result["contact_xi"].values)
    yield "contact force", _largest(force[inner])
    yield "contact force at an end", _largest(force[~inner])
    if "sampled_force" in result:
        force, inner = np.abs(result["sampled_force"].values), _inner(result, result["sampled_station"].values)
        yield "sampled force", _largest(force[inner])
        yield "sampled force at an end", _largest(force[~inner])


def _inner(result: xr.Dataset, xi: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether places on the line with the loads are further from both its ends than three links."""
    nodes = result["xi"].values[result["line"].values == LOADED]
    if nodes.size < 2:
        return np.ones(xi.shape, dtype=bool)
    margin = 3.0 * float(nodes[1] - nodes[0])
    return ~np.isfinite(xi) | (xi > nodes.min() + margin) & (xi < nodes.max() - margin)


def _largest(values: NDArray[np.float64]) -> float:
    return float(np.nanmax(values)) if np.isfinite(values).any() else np.nan


def mistakes(result: xr.Dataset, tree: Tree, numbers: dict[str, float]) -> list[str]:
    """What is wrong with a result that says that it has been completed."""
    no_audit = result.attrs.get("audit", "") or ("theory" if tree["run"]["kind"] == "linear" else "")
    found = (
        _not_finite(result), _audit(numbers, no_audit), _absurd(numbers), _unloaded(result, tree),
        _at_rest(result, tree),
    )  # fmt: skip
    return [text for text in found if text]


def _path(result: xr.Dataset) -> NDArray[np.float64]:
    values: NDArray[np.float64] = result["time" if "time" in result.dims else "load_path"].values
    return values


def _weight(load: Tree) -> float:
    """Of a load, or the size of a given force, N."""
    if load["kind"] == "force":
        force = load["force"]
        rows = force["value"] if isinstance(force, dict) else [force]
        return max(float(np.linalg.norm(row)) for row in rows)
    if load["kind"] == "matrices":
        return DOWN * float(np.sum(load["mass"]))
    if load["kind"] == "vehicle":
        return DOWN * sum(part.get("mass", 0.0) for block in ("bodies", "wheels") for part in load[block].values())
    if load["kind"] == "train":
        count = sum(int(one.split()[0]) if " " in one else 1 for one in load["order"])
        return count * _weight({**load["vehicles"]["car"], "kind": "vehicle"})
    if load["kind"] == "crowd":
        return DOWN * float(load["number"] * load["mass"]["mean"])
    if load["kind"] == "stepper":
        return float(load["options"]["force"])
    if load["kind"] == "fmu":
        return DOWN * float(load["file"].removeprefix("vehicle-").removesuffix(".fmu"))
    if load["kind"] == "pantograph":
        return 120.0
    total = load.get("mass", 0.0) + load.get("wheel_mass", 0.0) + load.get("payload", {}).get("mass", 0.0)
    return DOWN * float(total)


def _not_finite(result: xr.Dataset) -> str:
    for name in ("position", "velocity", "tension"):
        if result[name].size and not np.isfinite(result[name].values).all():
            return f"{name} is not finite"
    return ""


def _audit(numbers: dict[str, float], why_none: str) -> str:
    """What the audit misses, if it is too much; a run that keeps none says why."""
    if "turnover" not in numbers or why_none:
        return ""
    moved, audit = numbers["turnover"], numbers["imbalance"]
    if not np.isfinite(audit):
        return "the imbalance is NaN"
    if audit > max(AUDIT * moved, ROUND_OFF * numbers["energy"], NOTHING):
        return f"imbalance {audit:.3g} J, {100 * audit / max(moved, 1e-300):.3g} % of {moved:.3g} J turned over"
    return ""


def _absurd(numbers: dict[str, float]) -> str:
    weight, first = numbers["weight"], numbers.get("tension at first", 0.0)
    force = max(numbers.get("contact force", 0.0), numbers.get("sampled force", 0.0))
    if weight and force > ABSURD * weight:
        return f"contact force {force:.3g} N for {weight:.3g} N of weight"
    tension = numbers.get("tension", 0.0)
    if weight and tension > ABSURD * (first + weight):
        return f"tension {tension:.3g} N, at first {first:.3g} N, under {weight:.3g} N of weight"
    return ""


def _unloaded(result: xr.Dataset, tree: Tree) -> str:
    """Loads that are never there, or press on nothing."""
    if not tree["loads"] or not result.sizes.get("contact"):
        return "there is no contact" if tree["loads"] else ""
    names = result["load"].values.tolist()
    for load in tree["loads"]:
        own = [k for k, name in enumerate(names) if name == load or name.startswith(f"{load}.")]
        if (result["contact_state"][:, own].values == OFF_LINE).all():
            return f"{load} is never on its line"
    force = result["contact_force"].values
    if tree["gravity"] and not (np.abs(np.nan_to_num(force)) > 0.0).any():
        return "nothing presses on the line"
    return ""


def _at_rest(result: xr.Dataset, tree: Tree) -> str:
    """Of lines at rest: no compression in what hangs, supports bear the weight."""
    lines = tree["lines"]
    if not lines or tree["nets"] or tree["overhead_lines"] or "wind" in tree:
        return ""
    first = result["tension"].values[0]
    from_rest = tree["run"].get("start", {"kind": "rest"})["kind"] == "rest"
    if from_rest and all(map(_hangs, lines.values())) and first.min() < -FOLDED * np.abs(first).max():
        return f"folded at rest: {first.min():.3g} N beside {first.max():.3g} N"
    if tree["run"]["kind"] != "equilibrium" or tree["loads"] or tree["joints"] or not tree["gravity"]:
        return ""
    if any(line["foundation"] for line in lines.values()):
        return ""
    xi, owner = result["xi"].values, result["line"].values
    weight = 0.0
    for name in set(owner.tolist()):
        line = lines[name] if name in lines else tree["hangers"][name.rsplit("-", 1)[0]]
        mass = line["mass"] * float(xi[owner == name].max())
        for part in line.get("segments", {}).values():
            mass += (part.get("mass", line["mass"]) - line["mass"]) * (part["to"] - part["from"])
        weight += tree["gravity"] * mass
    for track in tree["tracks"].values():
        sleepers, length = track["sleepers"], float(xi[owner == track["rail"]].max())
        count = int((length - sleepers["first"]) / sleepers["spacing"] + 1e-6) + 1
        weight += tree["gravity"] * count * (sleepers["mass"] + track["ballast"]["mass"])
    borne = float(np.nansum(result["reaction"].values[0, :, -1]))
    return f"supports bear {borne:.5g} N of {weight:.5g} N" if abs(borne - weight) > BALANCE * weight else ""


def _hangs(line: Tree) -> bool:
    """Whether a line is longer than its chord, and too soft to stand by its bending stiffness."""
    chord = float(np.linalg.norm(np.subtract(line["end"], line["start"])))
    return line.get("length", 0.0) > chord and line["bending_stiffness"] < SOFT


def trace_of(result: xr.Dataset) -> dict[str, list[float]]:
    """A few numbers of a result: rest, first state, path and force of the first contact, tensions, audit."""
    found: dict[str, list[float]] = {}
    frames = np.unique(np.linspace(0, len(_path(result)) - 1, _PLACES).round().astype(int))
    here = np.flatnonzero(result["line"].values == LOADED)
    if here.size:
        nodes = here[np.linspace(0, here.size - 1, _PLACES).round().astype(int)]
        found["rest"] = result["position"].values[0, nodes, -1].tolist()
        found["last"] = result["position"].values[-1, nodes, -1].tolist()
        links = np.flatnonzero(result["link_line"].values == LOADED)
        found["tension"] = result["tension"].values[frames][:, links].max(axis=1).tolist()
    if result.sizes.get("contact"):
        found["first"] = result["contact_position"].values[0, 0].tolist()
        found["path"] = result["contact_position"].values[frames, 0, -1].tolist()
        found["along"] = result["contact_position"].values[frames, 0, 0].tolist()
        found["force"] = result["contact_force"].values[frames, 0, -1].tolist()
    return found
