"""Description of the frames of a run for all renderers: colours, diagrams, symbols, factors of exaggeration.

The page of the studio and the films of Matplotlib draw the same description:

- Places: nodes at `reference + factor * (position - reference)`, and heights `height_factor` times as large. Contacts
  and bodies have places without displacement too, `contact_reference` and `body_reference`, and the same factor.
- Colour: one quantity of links, nodes or cells, chosen by the structure; `None` where lines have one colour.
- Diagrams: quantities of nodes, drawn below the lines over the same coordinates.
- Symbols: see `ropewalk.results.symbols`.
- Lines: bent where loads touch them, though nodes beside a load lie on a curve. Beside a sharp bend nodes are up to a
  tenth of a link away from the line (docs/notes/gate-of-contacts.md): a load would be seen to hang below it. What
  results say of nodes stays as it is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results import style
from ropewalk.results.contact_statistics import scenario_of
from ropewalk.results.declared import declared, line_of, ties
from ropewalk.results.display_units import DisplayUnits
from ropewalk.results.frame import IN_AIR, Array
from ropewalk.results.line_response import LineResponse
from ropewalk.results.nets import is_spatial
from ropewalk.results.symbols import Symbol, Wheels, symbols_of

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario
    from ropewalk.model.line import Line

VISIBLE = 0.015  # of the extent: displacements at least as large are drawn to scale
DRAWN = 0.1  # of the extent: most of exaggerated displacements
FLAT, HIGH = 0.07, 0.35  # height to width: lines that are flatter are drawn with larger heights, at most so high
STRAIGHT = 1e-3  # height to width, below which lines are straight
AROUND = 45.0  # m, of an overhead line on each side of its pantographs
_STILL = 1e-9  # of the extent: smaller displacements are round-off
_NOTHING = 1e-9  # of any quantity in SI: round-off
_SEEN = 0.02  # of a link: nearer to the straight line between its nodes no contact is seen to be off it


@dataclass(frozen=True)
class DrawnQuantity:
    """A quantity that is drawn as a colour or as a diagram.

    Args:
        name: of the array that holds it, of a result or of `Picture.add`.
        label: for readers.
        unit: SI unit of the array.
        of: "link", "node" or "cell": what the array has an entry of.
        lines: names of the lines that it is drawn along; empty: all.
        down: whether diagrams draw positive values downwards, as of deflections and sagging moments.
    """

    name: str
    label: str
    unit: str
    of: str
    lines: tuple[str, ...] = ()
    down: bool = False


TENSION = DrawnQuantity("tension", "tension", "N", "link")
NET_TENSION = DrawnQuantity("net_tension", "tension per width", "N/m", "cell")


class Picture:
    """Description of the frames of a run, for one renderer after the other.

    Args:
        dataset: a result, or the first frames of it.
        is_static: whether displacements of beams are measured from straight lines, as of an equilibrium, rather than
            from the first frame.
    """

    def __init__(self, dataset: xr.Dataset, is_static: bool = False) -> None:
        scenario = scenario_of(dataset)
        self.lines = list(dict.fromkeys(dataset["line"].values.tolist()))
        self.is_spatial = is_spatial(dataset)
        self.beams = _beams(scenario, self.lines)
        self.is_overhead = scenario is not None and bool(scenario.overhead_lines)
        self.colour: DrawnQuantity | None = self._colour(dataset, scenario)
        self.diagrams = self._diagrams()
        self.reference = np.array(dataset["position"].values[0], dtype=float)
        if is_static or (scenario is not None and scenario.run.kind == "equilibrium"):
            self._straighten(dataset)
        self.symbols: list[Symbol] = symbols_of(dataset, scenario, self.reference)
        self.ranges: dict[str, tuple[float, float]] = {}
        self._wheels = Wheels(dataset, scenario)
        self._loads, self._ties = declared(dataset, "loads"), ties(dataset)
        self._displaced, self._low = 0.0, np.full(dataset.sizes["axis"], np.nan)
        self._high = self._low

    @classmethod
    def of(cls, dataset: xr.Dataset) -> Picture:
        """Return the description of a whole result, with the factors and ranges of all its frames."""
        picture = cls(dataset)
        picture.add(dataset)
        return picture

    def _colour(self, dataset: xr.Dataset, scenario: Scenario | None) -> DrawnQuantity | None:
        if not dataset.sizes["link"]:
            return NET_TENSION if "cell_tension" in dataset else None
        if self.is_overhead:
            wires = tuple(line for line in self.lines if line.endswith((".contact", ".messenger")))
            return DrawnQuantity("uplift", "uplift", "m", "node", wires)
        if self.beams or _is_linear(scenario):
            return DrawnQuantity("deflection", "deflection", "m", "node", down=True)
        return TENSION

    def _diagrams(self) -> list[DrawnQuantity]:
        if self.is_overhead:
            wires = tuple(line for line in self.lines if line.endswith(".contact"))
            return [DrawnQuantity("uplift", "uplift of the contact wire", "m", "node", wires)]
        if self.colour is None or self.colour.name != "deflection":
            return []
        beams = tuple(self.beams)
        bending = [DrawnQuantity("moment", "bending moment", "N*m", "node", beams, down=True)] if beams else []
        return [DrawnQuantity("deflection", "deflection", "m", "node", beams or tuple(self.lines), down=True), *bending]

    def _straighten(self, dataset: xr.Dataset) -> None:
        """Measure the displacements of beams from straight lines between their ends."""
        reference = self.reference
        for name in self.beams:
            own = np.flatnonzero(dataset["line"].values == name)
            part = (dataset["xi"].values[own] / max(float(dataset["xi"].values[own[-1]]), 1e-12))[:, None]
            reference[own] = (1.0 - part) * reference[own[0]] + part * reference[own[-1]]

    @property
    def quantities(self) -> dict[str, DrawnQuantity]:
        """The quantities of diagrams and colours, by name."""
        return {q.name: q for q in (*self.diagrams, self.colour) if q is not None}

    def add(self, dataset: xr.Dataset) -> dict[str, Array]:
        """Return the arrays to draw of some frames, and extend ranges and factors by them.

        Args:
            dataset: the next frames of the result.

        Returns:
            By name, (frame, ...) in SI units: `position` (node, axis), with bends at contacts; `contact_position` and
            `body_position` with their references; `wheel_position` (contact, axis) with wheels of trains before and
            behind the line too, if there are trains; the quantities of `colour` and `diagrams`.
        """
        position = drawn_position(dataset)
        arrays: dict[str, Array] = {"position": position, **self._references(dataset, position)}
        if self._wheels.trains:
            arrays["wheel_position"] = self._wheels.places(dataset)
        for name in self.quantities:
            arrays[name] = self._values(dataset, position, name)
            kept = arrays[name][np.isfinite(arrays[name])]
            if kept.size:
                low, high = self.ranges.get(name, (np.inf, -np.inf))
                self.ranges[name] = min(low, float(kept.min())), max(high, float(kept.max()))
        self._extend(dataset, position)
        return arrays

    def _values(self, dataset: xr.Dataset, position: Array, name: str) -> Array:
        if name == "tension":
            return np.asarray(dataset["tension"].values)
        if name == "net_tension":
            return np.asarray(np.fmax.reduce(dataset["cell_tension"].values, axis=-1))
        if name == "moment":
            return self._moment(dataset)
        rise = dataset["position"].values[..., -1] - self.reference[:, -1]
        return np.asarray(rise if name == "uplift" else -rise)

    def _moment(self, dataset: xr.Dataset) -> Array:
        """Return the bending moments (frame, node), N m; NaN of lines without bending stiffness."""
        out = np.full(dataset["position"].shape[:2], np.nan)
        for name, line in self.beams.items():
            response = LineResponse(dataset, name, line, 0.0)
            if response.moment is not None:
                out[:, response.nodes] = response.moment
        return out

    def _references(self, dataset: xr.Dataset, position: Array) -> dict[str, Array]:
        """Return places of contacts and bodies, and these places without the displacement of their lines."""
        place, xi = dataset["contact_position"].values, dataset["contact_xi"].values
        moved, names, away = np.zeros(place.shape), dataset["line"].values, position - self.reference
        for k, contact in enumerate(dataset["load"].values.tolist()):
            line, section = line_of(contact, self._loads), contact.rpartition(".")[2]
            wires = (f"{section}.contact", line, f"{line}.contact")  # of a section that overlaps, or the declared one
            own = np.flatnonzero(names == next((wire for wire in wires if wire in self.lines), ""))
            there, at = np.flatnonzero(np.isfinite(xi[:, k])), dataset["xi"].values[own]
            if own.size < 2 or not np.isfinite(at).all():  # nodes of nets have no xi
                continue
            i = np.clip(np.searchsorted(at, xi[there, k], side="right") - 1, 0, own.size - 2)
            part = ((xi[there, k] - at[i]) / (at[i + 1] - at[i]))[:, None]
            moved[there, k] = (1.0 - part) * away[there, own[i]] + part * away[there, own[i + 1]]
        bodies = dataset["body_position"].values
        shift = np.zeros(bodies.shape)
        for i in {i for i, _ in self._ties}:
            tied = [k for body, k in self._ties if body == i]
            shift[:, i] = moved[:, tied[len(tied) // 2]]
        return {
            "contact_position": place, "contact_reference": place - moved,
            "body_position": bodies, "body_reference": bodies - shift,
        }  # fmt: skip

    def _extend(self, dataset: xr.Dataset, position: Array) -> None:
        """Note the extent of the positions (frame, node, axis) of some frames, and the displacements to be visible."""
        names, axes = dataset["line"].values, position.shape[-1]
        loads = () if self.beams else (dataset["contact_position"].values, dataset["body_position"].values)
        known = np.stack([self._low, self._high])
        points = np.concatenate([known, *(places.reshape(-1, axes) for places in (position, *loads))])
        self._low, self._high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
        for name in self.beams or self.lines:
            own = np.flatnonzero(names == name)
            reference = self.reference[own]
            if not self.beams and not self.is_overhead and own.size > 1:  # the sag of ropes is seen without a factor
                part = np.linspace(0.0, 1.0, own.size)[:, None]
                reference = (1.0 - part) * reference[0] + part * reference[-1]
            away = np.linalg.norm(position[:, own] - reference, axis=-1)
            self._displaced = max(self._displaced, float(np.nanmax(away, initial=0.0)))

    @property
    def extent(self) -> float:
        """Width of the picture, m."""
        wide = 2.0 * AROUND if self.is_overhead else np.inf
        return min(float(np.max(self._high - self._low, initial=0.0)), wide) or 1.0

    @property
    def height_factor(self) -> float:
        """How many times as large heights are drawn: 1, or a round number where the lines are flat but not straight."""
        if (self.is_spatial and not self.is_overhead) or not len(self.reference):
            return 1.0
        rise, is_curved = float(self._high[-1] - self._low[-1]), np.ptp(self.reference[:, -1]) > STRAIGHT * self.extent
        return style.nice(HIGH * self.extent / rise) if is_curved and rise < FLAT * self.extent else 1.0

    @property
    def factor(self) -> float:
        """How many times as large displacements are drawn: a round number, 1 where they are visible anyhow."""
        seen = self._displaced * self.height_factor / self.extent
        return 1.0 if seen >= VISIBLE or seen < _STILL else max(style.nice(DRAWN / seen), 1.0)

    def range(self, quantity: DrawnQuantity) -> dict[str, Any] | None:
        """Return the range of a quantity over the frames so far, in the unit that readers use.

        Returns:
            `low`, `high`, `unit`, and `size` of this unit in SI; None where there is nothing to see.
        """
        low, high = self.ranges.get(quantity.name, (0.0, 0.0))
        if max(abs(low), abs(high)) <= _NOTHING:
            return None
        unit = DisplayUnits.read(None).of(quantity.unit, [low, high])
        return {"low": low / unit.size, "high": high / unit.size, "unit": unit.symbol, "size": unit.size}

    def state(self) -> dict[str, Any]:
        """Return what grows with the frames, for messages: `factor`, `height_factor`, and `ranges` by quantity."""
        ranges = {name: self.range(quantity) for name, quantity in self.quantities.items()}
        return {"factor": self.factor, "height_factor": self.height_factor, "ranges": ranges}

    def described(self) -> dict[str, Any]:
        """Return what stays the same over all frames, for messages."""
        return {
            "colour": vars(self.colour) if self.colour else None, "diagrams": [vars(q) for q in self.diagrams],
            "symbols": [symbol.described() for symbol in self.symbols],
            "around": AROUND if self.is_overhead else None,
        }  # fmt: skip


def _beams(scenario: Scenario | None, there: list[str]) -> Mapping[str, Line]:
    """Return the lines with bending stiffness that no pretension holds, by name."""
    if scenario is None:
        return {}
    return {
        name: line
        for name, line in scenario.lines.items()
        if name in there and line.bending_stiffness and not line.tension
        and (line.length is None or line.length >= line.distance * (1.0 - 1e-6))
    }  # fmt: skip


def _is_linear(scenario: Scenario | None) -> bool:
    """Whether tensions stay as they are at first."""
    run: Any = getattr(scenario, "run", None)
    return run is not None and (run.kind == "linear" or getattr(run, "geometry", "") == "linearised")


def drawn_position(dataset: xr.Dataset) -> Array:
    """Return positions of nodes (frame, node, axis), m; those within a link of a load are on straight lines there.

    Args:
        dataset: the frames of a result that are to be drawn.
    """
    position = np.array(dataset["position"].values, dtype=float)
    places, xi, loads = dataset["contact_position"].values, dataset["contact_xi"].values, declared(dataset, "loads")
    touch = (dataset["contact_state"].values > IN_AIR) & np.isfinite(xi) & np.isfinite(places).all(axis=-1)
    names, node_xi = dataset["line"].values, dataset["xi"].values
    on = np.array([line_of(contact, loads) for contact in dataset["load"].values.tolist()], dtype=object)
    for name in dict.fromkeys(on.tolist()):
        own, here = np.flatnonzero(names == name), on == name
        stations = node_xi[own]
        if own.size <= 2 or not np.isfinite(stations).all():
            continue
        for frame in np.flatnonzero((touch & here).any(axis=1)):
            k = touch[frame] & here
            position[frame, own] = _bent(position[frame, own], stations, places[frame, k], xi[frame, k])
    return position


def _bent(nodes: Array, stations: Array, places: Array, xi: Array) -> Array:
    """The nodes of a line, which is bent at places of contacts that are seen not to be on its links."""
    links = np.diff(stations)
    link = np.clip(np.searchsorted(stations, xi, side="right") - 1, 0, links.size - 1)
    h = links[link]
    part = np.clip((xi - stations[link]) / h, 0.0, 1.0)[:, None]
    off = np.linalg.norm(places - (1.0 - part) * nodes[link] - part * nodes[link + 1], axis=1)
    seen = (off > _SEEN * h) & (xi > stations[0]) & (xi < stations[-1])
    if not seen.any():
        return nodes
    places, xi, h = places[seen], xi[seen], h[seen]
    near = (np.abs(stations[:, None] - xi) < h).any(axis=1)
    near[[0, -1]] = False
    corners = np.concatenate([stations[~near], xi])
    order = np.argsort(corners, kind="stable")
    shape = np.concatenate([nodes[~near], places])[order]
    bent = nodes.copy()
    for axis in range(nodes.shape[1]):
        bent[near, axis] = np.interp(stations[near], corners[order], shape[:, axis])
    nearest = 1 + np.abs(stations[1:-1, None] - xi).argmin(axis=0)
    bent[nearest] = places
    return bent
