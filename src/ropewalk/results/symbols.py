"""Symbols of a picture: vehicles, trains, cabins, pantographs, people, towers, sheaves, droppers."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results.contract import path_name
from ropewalk.results.frame import Array

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario

KINDS = {
    "oscillator": "vehicle", "vehicle": "vehicle", "matrices": "vehicle", "train": "coach", "axles": "coach",
    "crowd": "person", "footsteps": "person", "walker": "person", "trolley": "trolley", "carriage": "cabin",
    "pantograph": "pantograph", "force": "force",
}  # fmt: skip
"""Symbol of each kind of load; all others are a mass."""
_HUMAN = re.compile(r"person|walker|jumper|rider|climber|people|runner", re.IGNORECASE)
_BOGIE = 4.5  # m: axles that are no further apart belong to one bogie
_SHARED = 2  # bogies of a coach


@dataclass(frozen=True)
class Symbol:
    """Something that is drawn at a legible size, as what it is.

    Args:
        kind: "coach" or "vehicle" (a box above wheels), "trolley" and "cabin" (wheels on the line, bodies below, joined
            by a hanger), "pantograph", "person", "mass", "force"; "tower", "saddle", "sheave" (on a post down to
            `foot`), "bearing", "dropper" (a line between two nodes), "place" (a place whose curve is asked for).
        name: of the load, support or place.
        contacts: numbers of its contacts, of wheels, feet, the head.
        bodies: numbers of its bodies.
        nodes: numbers of nodes: both ends of a dropper, or the node at the symbol.
        at: (axis,) m of what does not move.
        size: m, radius of a saddle; 0: of no size.
        foot: m, height at which a post begins; None: no post.
    """

    kind: str
    name: str
    contacts: tuple[int, ...] = ()
    bodies: tuple[int, ...] = ()
    nodes: tuple[int, ...] = ()
    at: tuple[float, ...] = ()
    size: float = 0.0
    foot: float | None = None

    def described(self) -> dict[str, Any]:
        """Return it for messages, without what is empty."""
        return {key: value for key, value in vars(self).items() if value not in ((), None)}


def symbols_of(dataset: xr.Dataset, scenario: Scenario | None, reference: Array) -> list[Symbol]:
    """Return the symbols of a result, those in front last.

    Args:
        dataset: a result, or frames of it.
        scenario: of the result, None where it cannot be read back.
        reference: (node, axis) m, positions without displacement.
    """
    found = [*_droppers(dataset, reference)]
    if scenario is not None:
        found += [*_posts(dataset, scenario, reference), *_places(dataset, scenario)]
    return [*found, *_loads(dataset, scenario)]


def _loads(dataset: xr.Dataset, scenario: Scenario | None) -> Iterator[Symbol]:
    contacts, bodies = dataset["load"].values.tolist(), dataset["body"].values.tolist()
    declared: Any = scenario.loads if scenario is not None else {}
    for name in dict.fromkeys(one.partition(".")[0] for one in (*contacts, *bodies)):
        load = declared.get(name)
        kind = KINDS.get(getattr(load, "kind", ""), "vehicle" if bodies and load is None else "mass")
        if kind == "mass" and _HUMAN.search(name):
            kind = "person"
        own = [k for k, one in enumerate(contacts) if one.partition(".")[0] == name]
        its = [k for k, one in enumerate(bodies) if one.partition(".")[0] == name]
        if getattr(load, "kind", "") == "axles":
            for part in _coaches(load, own):
                yield Symbol(kind, name, tuple(part))
            continue
        heads = {k: (contacts[k].rpartition(".")[0] or name) if kind in ("coach", "person") else name for k in own}
        row = dict.fromkeys([*heads.values(), *([] if own else [name])])
        groups = {head: [k for k in own if heads[k] == head] for head in row}
        shared = [_is_shared(vehicle) for _, vehicle in getattr(load, "composition", ())]
        for n, (head, part) in enumerate(groups.items()):
            after = [*groups.values()][n + 1 : n + 2] if n < len(shared) and shared[n] else []
            of_head = [k for k in its if len(row) < 2 or bodies[k].startswith(f"{head}.")]
            yield Symbol(kind, head, tuple(part + [one[0] for one in after]), tuple(of_head))


def _is_shared(vehicle: Any) -> bool:
    """Whether a vehicle of a train stands on a bogie of the next one."""
    return any(end.startswith("next.") for spring in vehicle.springs.values() for end in spring.between)


def _coaches(axles: Any, own: list[int]) -> list[list[int]]:
    """Return the axles of each coach: as declared, or two bogies of neighbouring axles each."""
    if axles.coaches is not None:
        each = len(own) // axles.coaches.count
        return [own[i : i + each] for i in range(0, len(own), each)]
    behind = [at for at, _ in axles.axles]
    bogies: list[list[int]] = []
    for k, contact in enumerate(own):
        if k == 0 or behind[k] - behind[k - 1] > _BOGIE:
            bogies.append([])
        bogies[-1].append(contact)
    return [[*chain(*bogies[i : i + _SHARED])] for i in range(0, len(bogies), _SHARED)]


def _posts(dataset: xr.Dataset, scenario: Scenario, reference: Array) -> Iterator[Symbol]:
    """Towers and bearings between the ends of lines, saddles and sheaves."""
    axes, names, ground = reference.shape[1], dataset["line"].values, scenario.outputs.ground
    lowest = float(reference[:, -1].min()) if len(reference) else 0.0

    def foot(at: tuple[float, ...]) -> float | None:
        if ground is not None:
            return float(np.interp(at[0], *np.transpose(ground)))
        return lowest if at[-1] > lowest + 1e-6 else None

    for name, line in scenario.lines.items():
        nodes = np.flatnonzero(names == name)
        for support, inner in line.supports.items() if nodes.size else ():
            node = int(nodes[np.abs(dataset["xi"].values[nodes] - inner.at).argmin()])
            at = tuple(reference[node].tolist())
            post = foot(at)
            yield Symbol("bearing" if post is None else "tower", support, nodes=(node,), at=at, foot=post)
        for kind, round_bodies in (("saddle", line.saddles), ("sheave", line.sheaves)):
            for support, body in round_bodies.items():
                place = body.at if len(body.at) == axes else (body.at[0], 0.0, body.at[-1])
                is_fixed = getattr(body, "to", None) is None
                yield Symbol(kind, support, at=tuple(place), size=getattr(body, "radius", 0.0),
                             foot=foot(place) if is_fixed else None)  # fmt: skip


def _places(dataset: xr.Dataset, scenario: Scenario) -> Iterator[Symbol]:
    for name, place in scenario.outputs.places.items():
        nodes = np.flatnonzero(dataset["line"].values == place.on)
        if nodes.size:
            node = int(nodes[np.abs(dataset["xi"].values[nodes] - place.at).argmin()])
            yield Symbol("place", name, nodes=(node,))


def _droppers(dataset: xr.Dataset, reference: Array) -> Iterator[Symbol]:
    """Droppers of overhead lines: from the contact wire to the wire above it, at the same distance."""
    if "tie" not in dataset.coords:
        return
    wires = dataset["line"].values
    for name, station in zip(dataset["tie"].values.tolist(), dataset["tie_station"].values, strict=True):
        line = name.partition(".")[0]
        below = np.flatnonzero(wires == f"{line}.contact")
        if ".arm." in name or not below.size:
            continue
        low = int(below[np.abs(dataset["xi"].values[below] - station).argmin()])
        of_line = np.char.startswith(wires.astype(str), f"{line}.") & (wires != f"{line}.contact")
        above = np.flatnonzero(of_line)
        away = np.abs(reference[above, 0] - reference[low, 0])
        near = above[away <= away.min() + 1e-6] if above.size else above
        if near.size:
            yield Symbol("dropper", name, nodes=(low, int(near[reference[near, -1].argmin()])))


class Wheels:
    """Wheels of trains, also before and behind their lines, where results have no places of them.

    Args:
        dataset: a result, or its first frames.
        scenario: of the result.
    """

    def __init__(self, dataset: xr.Dataset, scenario: Scenario | None) -> None:
        contacts = dataset["load"].values.tolist()
        self.trains: list[tuple[str, list[int], Array]] = []
        for name, load in scenario.loads.items() if scenario is not None else ():
            own = [k for k, contact in enumerate(contacts) if contact.partition(".")[0] == name]
            if getattr(load, "kind", "") in ("axles", "train", "vehicle") and own:
                at = {place.label: place.start for place in load.starts()}
                offsets = [at.get(contacts[k].partition(".")[2], np.nan) for k in own]
                self.trains.append((str(load.on), own, np.array(offsets)))
        self._last = [(np.zeros(0), np.zeros(0))] * len(self.trains)  # instants and advances that were known last

    def places(self, dataset: xr.Dataset) -> Array:
        """Return the places (frame, contact, axis) of all contacts, m; NaN of trains that are not there yet."""
        place = np.array(dataset["contact_position"].values, dtype=float)
        path, names = dataset[path_name(dataset)].values, dataset["line"].values
        for train, (line, own, offsets) in enumerate(self.trains):
            nodes = np.flatnonzero(names == line)
            if nodes.size < 2 or not np.isfinite(offsets).all():
                continue
            ends = dataset["position"].values[0, nodes[[0, -1]]]
            span = float(np.linalg.norm(ends[1] - ends[0]))
            onward = (ends[1] - ends[0]) / span
            along = (place[:, own] - ends[0]) @ onward - offsets
            lead = offsets + self._advance(train, path, along)[:, None]
            level = ends[0] + lead[..., None] * onward
            level[..., -1] = np.where(lead <= 0.5 * span, ends[0, -1], ends[1, -1])
            place[:, own] = np.where(np.isfinite(place[:, own]), place[:, own], level)
        return place

    def _advance(self, train: int, path: Array, along: Array) -> Array:
        """Return the advance of a train, (frame,) m; at the last speed where no wheel is on the line; NaN: unknown."""
        known = np.isfinite(along).any(axis=1)
        instants = np.append(self._last[train][0], path[known])
        advances = np.append(self._last[train][1], np.nanmean(along[known], axis=1))
        self._last[train] = instants[-2:], advances[-2:]
        if instants.size < 2:
            return np.where(known, advances[0] if advances.size else np.nan, np.nan)
        i = np.clip(np.searchsorted(instants, path) - 1, 0, instants.size - 2)
        slope = (advances[i + 1] - advances[i]) / (instants[i + 1] - instants[i])
        return np.asarray(advances[i] + slope * (path - instants[i]))
