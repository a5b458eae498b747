"""Supports of lines, sheaves and saddles, and what keeps nodes together, from a scenario laid out."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.mechanics.assembly import components, restrained_by, vector_table
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.restrained_points import supports_of
from ropewalk.model.joint import Joined
from ropewalk.model.scenario import Scenario
from ropewalk.system.assembling.laid import Laid
from ropewalk.system.assembling.surface_paths import Nets
from ropewalk.system.elements.structure import Restraints


def restraints_of(
    scenario: Scenario, laid: Laid, sections: list[tuple[str, Integers, Array]], original: Integers, gravity: Array,
    until: float, axes: tuple[str, ...], nets: Nets | None,
) -> Restraints:  # fmt: skip
    """Supports of lines and sheaves, and what keeps nodes together."""
    dim = gravity.size
    members = {int(i): np.flatnonzero(original == i) for i in np.unique(original)}
    found: dict[int, dict[str, Any]] = {
        i: {"node": nodes, "free": np.eye(dim)} for i, nodes in members.items() if nodes.size > 1
    }
    none: dict[str, Any] = {
        "mass": 0.0, "force": np.zeros(dim), "stiffness": np.zeros((dim, dim)), "damping": np.zeros((dim, dim)),
        "place": np.zeros(dim), "table": (np.zeros(1), np.zeros((dim, 1))),
        "winch": np.zeros(2),
    }  # fmt: skip
    for name, line in scenario.lines.items():
        mine = [(node, station) for own, node, station in sections if own == name]
        nodes, stations = (np.concatenate(parts) for parts in zip(*mine, strict=True))
        for _, place, support, at in supports_of(line, float(stations[-1])):
            node = nodes[np.abs(stations - at).argmin()]
            entry = found.setdefault(int(node), {"node": members[int(node)], "free": np.eye(dim)})
            if isinstance(support, Joined):
                if support.to in scenario.joints:
                    joint = scenario.joints[support.to]
                    entry |= {"mass": joint.mass, "force": joint.mass * gravity + components(joint.force, axes)}
                continue
            entry |= _restrained(support, place, gravity, until, axes)
    crowns = [saddle for line in scenario.lines.values() for saddle in line.saddles.values()]
    for over in laid.sheaves:
        node, sheave = over.node, scenario.lines[over.line].sheaves[over.name]
        entry = found.setdefault(node, {"node": members[node], "free": np.eye(dim)})
        if sheave.to is None:
            entry |= {"free": np.zeros((dim, dim)), "place": components(sheave.at, axes)}
        else:
            joint = scenario.joints[sheave.to]
            entry |= {"mass": joint.mass, "force": joint.mass * gravity + components(joint.force, axes)}
    for number, saddle in zip(original[original.size - len(crowns) :].tolist(), crowns, strict=True):
        found[number] = {"node": members[number], **_restrained(saddle.support, saddle.at, gravity, until, axes)}
    for number, more in nets.restrained() if nets is not None else ():
        found.setdefault(number, {"node": members[number], "free": np.eye(dim)}).update(more)
    parting = _cut_nodes(scenario, sections)
    empty = {"node": np.zeros(0, dtype=np.int64), "free": np.zeros((dim, dim))}
    entries = [none | own for i, entry in found.items() for own in ((entry, empty) if i in parting else (entry,))]

    def column(key: str) -> Array:
        return np.array([entry[key] for entry in entries], dtype=float)

    counts = np.array([entry["node"].size for entry in entries], dtype=np.int64)
    sizes = np.array([entry["table"][0].size for entry in entries], dtype=np.int64)
    return Restraints(
        np.cumsum(counts) - counts, counts, np.concatenate([e["node"] for e in entries]).astype(np.int64),
        column("mass"), column("force"), column("free"), column("stiffness"), column("damping"), column("place"),
        np.cumsum(sizes) - sizes, sizes, np.concatenate([e["table"][0] for e in entries]),
        np.ascontiguousarray(np.hstack([e["table"][1] for e in entries])), column("winch"),
    )  # fmt: skip


def _cut_nodes(scenario: Scenario, sections: list[tuple[str, Integers, Array]]) -> set[int]:
    """Nodes at which lines are cut on the way: the second one of each gets a restraint of its own then."""
    found = set()
    for name, node, station in sections:
        cut = scenario.lines[name].cut if name in scenario.lines else None
        if cut is not None and abs(station[0] - cut.at) <= 1e-6 * cut.at:
            found.add(int(node[0]))
    return found


def _restrained(support: Any, place: Any, gravity: Array, until: float, axes: tuple[str, ...]) -> dict[str, Any]:
    """What a support does at its place."""
    free, stiffness, damping, force = restrained_by(support, axes)
    winch = getattr(support, "winch", None)
    mass, history = getattr(support, "mass", 0.0), getattr(support, "displacement", (0.0,) * gravity.size)
    return {
        "mass": mass, "force": force + mass * gravity, "free": free, "stiffness": stiffness, "damping": damping,
        "place": components(place, axes), "table": vector_table(history, until, axes),
        "winch": np.zeros(2) if winch is None else np.array([winch.speed_limit, winch.dead_band or 0.0]),
    }  # fmt: skip
