"""What bridge engineers read of lines: deflection, acceleration, bending moment and shear, of lines and at places."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.mechanics.along_lines import bending_along
from ropewalk.model.line import spatial
from ropewalk.results.contact_statistics import scenario_of
from ropewalk.results.contract import CURVATURE, STATIC, path_name
from ropewalk.results.frame import MEAN, SPLINE, Array

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario
    from ropewalk.model.line import Line

UNITS = {
    "deflection": "m", "acceleration": "m/s^2", "lateral_deflection": "m", "lateral_acceleration": "m/s^2",
    "moment": "N*m", "shear": "N",
}  # fmt: skip
_BOTH_WAYS = ("acceleration", "lateral_acceleration", "shear")  # quantities of which both directions count alike
_ORDER = 4  # of the filter, twice that forwards and backwards
_FINE = 4.0  # output instants in a period of the cut-off: with fewer, what is faster would pass for slower
LEAST = 40  # frames that the filter needs
_EVEN = 1e-6  # of an interval


@dataclass(frozen=True)
class LineResponse:
    """Quantities of one line over all frames of a result.

    Args:
        dataset: the result.
        name: of the line.
        line: as declared.
        cut_off: Hz, of accelerations.
    """

    dataset: xr.Dataset
    name: str
    line: Line
    cut_off: float

    @cached_property
    def nodes(self) -> Any:
        """Numbers of its nodes."""
        return np.flatnonzero(self.dataset["line"].values == self.name)

    @cached_property
    def xi(self) -> Array:
        """(node,) m."""
        return np.asarray(self.dataset["xi"].values[self.nodes])

    @cached_property
    def path(self) -> Array:
        """(frame,) of the leading dimension."""
        return np.asarray(self.dataset[path_name(self.dataset)].values)

    @cached_property
    def _position(self) -> Array:
        return np.asarray(self.dataset["position"].values[:, self.nodes])

    @cached_property
    def deflection(self) -> Array:
        """(frame, node) m, downwards from the first frame."""
        z = self._position[..., -1]
        return np.asarray(z[0] - z)

    @cached_property
    def acceleration(self) -> Array | None:
        """(frame, node) m/s^2, vertical and filtered; None where output instants are too few or too far apart."""
        return accelerations(self.dataset, "velocity", self.nodes, self.cut_off)

    @cached_property
    def lateral_deflection(self) -> Array | None:
        """(frame, node) m, to the left of the chord, level, from the first frame; None in the plane."""
        if self._left is None:
            return None
        y = self._position @ self._left
        return np.asarray(y - y[0])

    @cached_property
    def lateral_acceleration(self) -> Array | None:
        """(frame, node) m/s^2, in that direction, filtered as the vertical one; None as there, and in the plane."""
        if self._left is None:
            return None
        return accelerations(self.dataset, "velocity", self.nodes, self.cut_off, self._left)

    @cached_property
    def _left(self) -> Array | None:
        """(axis,) level unit vector to the left of the chord; None in the plane, and of an upright line."""
        run = self._position[0, -1] - self._position[0, 0]
        if run.size < 3 or not run[:2].any():
            return None
        return np.array([-run[1], run[0], 0.0]) / float(np.hypot(run[0], run[1]))

    @cached_property
    def moment(self) -> Array | None:
        """(frame, node) N m, EI times curvature, sagging positive; None without bending stiffness.

        Differences give it as a mean over both links, which cuts its corners under point forces: these are put back.
        """
        r = self._position
        if not self.line.bending_stiffness or self.xi.size < 4:
            return None
        run = r[:, -1, :-1] - r[:, 0, :-1]
        onward = run / np.maximum(np.linalg.norm(run, axis=1, keepdims=True), 1e-300)
        x, z = np.einsum("fna,fa->fn", r[..., :-1], onward), r[..., -1]
        dx, dz = 0.5 * (x[:, 2:] - x[:, :-2]), 0.5 * (z[:, 2:] - z[:, :-2])
        bent = dx * np.diff(z, 2, axis=1) - dz * np.diff(x, 2, axis=1)
        out, EI = np.zeros(z.shape), bending_along(self.line, self.xi)
        way = np.subtract(spatial(self.line.end), spatial(self.line.start))
        level, rise = np.array([np.hypot(way[0], way[1]), way[2]]) / np.linalg.norm(way)
        out[:, 1:-1] = EI[1:-1] * bent / np.maximum((dx**2 + dz**2) ** 1.5, 1e-300)
        if self._is_spline:
            for end in self._clamped:  # its curvature is that of twice the turn of its link
                one, other = (0, 1) if end == 0 else (-2, -1)
                turn = level * (z[:, other] - z[:, one]) - rise * (x[:, other] - x[:, one])
                out[:, end] = (2.0 if end == 0 else -2.0) * EI[end] * turn / (self.xi[1] - self.xi[0]) ** 2
            out += self._smoothed(out, EI)
        corners, kinks = self._corners
        out += corners
        for end, (a, b) in ((0, (1, 2)), (-1, (-2, -3))):
            if end not in self._clamped:
                out[:, end] = 0.0
            elif not self._is_spline:
                out[:, end] = 2.0 * out[:, a] - out[:, b]
        if self._is_mean:  # of what has no kinks, too
            out[:, 1:-1] -= np.diff(out - kinks, 2, axis=1) / 12.0
        return out

    @property
    def _is_spline(self) -> bool:
        return self.dataset.attrs.get(CURVATURE) == SPLINE

    @property
    def _is_mean(self) -> bool:
        return self.dataset.attrs.get(CURVATURE) == MEAN

    @property
    def _clamped(self) -> list[int]:
        """Ends, 0 and -1, at which the line cannot turn."""
        ends = ((0, self.line.start_support), (-1, self.line.end_support))
        return [end for end, support in ends if getattr(support, "clamped", False)]

    def _smoothed(self, moment: Array, EI: Array) -> Array:
        """What to moments by second differences is missing to be those in equilibrium with what nodes bear, N m.

        The energy of bending EI kappa^2 / 2 has in each link a sixth of EI (kappa' - kappa)^2 / 2 besides, but for
        links in which EI steps.
        """
        within = np.where(np.isclose(EI[1:], EI[:-1], rtol=1e-12), np.diff(moment, axis=1), 0.0) / 6.0
        out = -np.diff(within, axis=1, prepend=0.0, append=0.0)
        out[:, self._clamped] *= 2.0  # a clamped end is the middle of what is mirrored there
        return np.asarray(out)

    @cached_property
    def _corners(self) -> tuple[Array, Array]:
        """(frame, node) N m, what differences miss of moments whose slopes jump by point forces, and these kinks.

        Next to a force F at a distance of u links a moment goes as -(F h / 2) |u|. The second difference of exact
        deflections is its mean with a hat, less by (F h / 6) (1 - |u|)^3 for |u| < 1. On a mesh it is what nodes bear,
        which share F as the sharpened spline of `docs/notes/wires.md` tells: less by as much, but for (F h / 6) B(u)
        with the cubic B-spline B. Where bending is that of a spline, nodes share F in another way, see `_lacking`;
        forces of supports are those of their nodes.
        """
        exact = self._is_mean or self.dataset.attrs.get("method") == "linear theory"
        h = float(self.xi[1] - self.xi[0])
        out, kinks = np.zeros((2, self.path.size, self.xi.size))
        given, place = self.dataset["contact_force"].values[..., -1], self.dataset["contact_xi"].values
        on = [k for k, load in enumerate(self.dataset["load"].values.tolist()) if self._carries(load)]
        forces = [(-given[:, k], place[:, k]) for k in on]
        names = self.dataset["support"].values.tolist()
        for name, support in self.line.supports.items():
            if (label := f"{self.name}.{name}") in names and not self._is_spline:
                reaction = self.dataset["reaction"].values[:, names.index(label), -1]
                forces.append((-reaction, np.full(self.path.size, support.at)))
        for force, at in forces:
            there = np.flatnonzero(np.isfinite(force) & np.isfinite(at) & (force != 0.0))
            near = (at[there] / h).astype(np.int64)
            if self._is_mean:
                kinks[there] -= 0.5 * force[there, None] * np.abs(self.xi - at[there, None])
            for side in range(-3, 5) if self._is_spline else range(-1, 3):
                i = near + side
                inside = (i >= 0) & (i < self.xi.size)
                u = np.abs(at[there][inside] / h - i[inside])
                if self._is_spline:
                    missed = _lacking(at[there][inside] / h - i[inside])
                else:
                    missed = np.maximum(1.0 - u, 0.0) ** 3 - (0.0 if exact else _b_spline(u))
                out[there[inside], i[inside]] += force[there][inside] * h / 6.0 * missed
        return out, kinks

    def _carries(self, contact: str) -> bool:
        load = self._loads.get(contact) or self._loads.get(contact.partition(".")[0])
        return load is not None and load.on == self.name

    @cached_property
    def _loads(self) -> Mapping[str, Any]:
        scenario = scenario_of(self.dataset)
        return scenario.loads if scenario is not None else {}

    @cached_property
    def shear(self) -> Array | None:
        """(frame, link) N, the slope of the moment, towards the end of the line."""
        return None if self.moment is None else np.asarray(np.diff(self.moment, axis=1) / np.diff(self.xi))

    def at(self, xi: float) -> dict[str, Array]:
        """The quantities at a place in m, (frame,) each; deflections and accelerations by splines through the nodes."""
        found, weights = {}, spline_weights(self.xi, xi)
        for quantity in ("deflection", "acceleration", "lateral_deflection", "lateral_acceleration"):
            values = getattr(self, quantity)
            if values is not None:
                found[quantity] = values @ weights
        if self.moment is not None and self.shear is not None:
            i = int(np.clip(np.searchsorted(self.xi, xi, side="right") - 1, 0, self.xi.size - 2))
            part = (xi - self.xi[i]) / (self.xi[i + 1] - self.xi[i])
            found["moment"] = (1.0 - part) * self.moment[:, i] + part * self.moment[:, i + 1]
            found["shear"] = self.shear[:, i]
        return found


def spline_weights(xi: Array, at: float) -> Array:
    """(node,) how much each node at xi (m) adds to what a spline through all of them is at a place in m."""
    from scipy.interpolate import CubicSpline

    unit = np.eye(xi.size)
    return np.asarray(CubicSpline(xi, unit)(at) if xi.size > 2 else unit[-1])


def is_fine(dataset: xr.Dataset, cut_off: float) -> bool:
    """Whether output instants are close enough for accelerations up to a frequency in Hz."""
    return path_name(dataset) == "time" and evenly_fine(dataset["time"].values, cut_off) > 0


def evenly_fine(path: Array, cut_off: float) -> int:
    """How many instants in s follow one another evenly, zero where they are too few or too far apart for accelerations
    up to a frequency in Hz."""
    fine = _even(path) >= LEAST and float(path[1] - path[0]) * _FINE * cut_off <= 1.0 + _EVEN
    return _even(path) if fine else 0


def _even(path: Array) -> int:
    """How many frames follow one another evenly: the last one may come sooner."""
    steps = np.diff(path)
    return path.size - int(steps.size > 1 and abs(steps[-1] / steps[0] - 1.0) > _EVEN)


def accelerations(
    dataset: xr.Dataset, velocity: str, which: Any, cut_off: float, along: Array | None = None
) -> Array | None:
    """(frame, which) m/s^2, the derivative of a spline through velocities that are filtered.

    Args:
        dataset: a result.
        velocity: name of a quantity (frame, something, axis) in m/s.
        which: numbers of that something.
        cut_off: Hz, of a Butterworth filter of the fourth order, forwards and backwards.
        along: unit vector (axis,); None: vertical.

    Returns:
        None where output instants are too few or too far apart.
    """
    if not is_fine(dataset, cut_off):
        return None
    path = dataset[path_name(dataset)].values
    time, values = path[: _even(path)], dataset[velocity].values[: _even(path), which]
    return filtered_derivative(time, values[..., -1] if along is None else values @ along, cut_off)


def filtered_derivative(time: Array, values: Array, cut_off: float) -> Array:
    """(instant, ...) the derivative of a spline through values that are filtered, as accelerations are of velocities.

    Args:
        time: (instant,) s, even.
        values: (instant, ...).
        cut_off: Hz, of a Butterworth filter of the fourth order, forwards and backwards.
    """
    from scipy.linalg.lapack import dgtsv

    rows = np.reshape(values, (time.size, -1)).T
    smooth = _smooth(rows, *_filter(cut_off, float(time[1] - time[0])))
    slope = np.diff(smooth) / ((time[-1] - time[0]) / (time.size - 1.0))
    # A cubic spline with even knots, of which the first inner one and the last are none.
    right = np.empty((rows.shape[0], time.size))
    right[:, 1:-1] = 3.0 * (slope[:, :-1] + slope[:, 1:])
    right[:, 0], right[:, -1] = 2.5 * slope[:, 0] + 0.5 * slope[:, 1], 0.5 * slope[:, -2] + 2.5 * slope[:, -1]
    below, middle, above = np.ones(time.size - 1), np.full(time.size, 4.0), np.ones(time.size - 1)
    middle[[0, -1]], above[0], below[-1] = 1.0, 2.0, 2.0
    *_, found, _ = dgtsv(below, middle, above, right.T, 1, 1, 1, 1)
    return np.asarray(found.reshape(values.shape))


def _smooth(rows: Array, sections: Any, settled: Any, edge: int) -> Array:
    """Rows filtered forwards and backwards, as `scipy.signal.sosfiltfilt` does it, which settles anew each time."""
    from scipy.signal import sosfilt

    before, after = 2.0 * rows[:, :1] - rows[:, edge:0:-1], 2.0 * rows[:, -1:] - rows[:, -2 : -edge - 2 : -1]
    out = np.concatenate([before, rows, after], axis=1)
    for _ in range(2):
        out = sosfilt(sections, out, zi=settled[:, None, :] * out[None, :, :1])[0][:, ::-1]
    return np.asarray(out[:, edge:-edge])


@lru_cache(maxsize=64)
def _filter(cut_off: float, interval: float) -> tuple[Any, Any, int]:
    """The filter for samples at an interval in s: sections, their state when settled, samples it needs at an edge."""
    from scipy.signal import butter, sosfilt_zi

    sections = butter(_ORDER, cut_off, fs=1.0 / interval, output="sos")
    return sections, sosfilt_zi(sections), 3 * (_ORDER + 1)


def _b_spline(u: Array) -> Array:
    """The cubic B-spline at distances of u >= 0 links from its middle."""
    return np.asarray(np.where(u < 1.0, 2.0 / 3.0 - u**2 + 0.5 * u**3, np.maximum(2.0 - u, 0.0) ** 3 / 6.0))


def _lacking(u: Array) -> Array:
    """What the moment of a force lacks, in F h / 6, at a node u links before it, by how nodes share it: w |j| for |u|.

    With quintic B-splines, sharpened by a quarter of their second differences (`system/elements/spline.py`).
    """
    at = np.floor(u) + np.arange(-2.0, 4.0)[:, None]
    shared = (_quintic(at - u) * np.abs(at)).sum(axis=0) - 0.5 * _quintic(u)
    return np.asarray(3.0 * (shared - np.abs(u)))


def _quintic(u: Array) -> Array:
    """The quintic B-spline at distances of u links from its middle."""
    far = np.abs(u)
    parts = ((1.0, 3.0), (-6.0, 2.0), (15.0, 1.0))
    return np.asarray(sum(part * np.maximum(end - far, 0.0) ** 5 for part, end in parts) / 120.0)


def responses(dataset: xr.Dataset) -> tuple[dict[str, LineResponse], Scenario | None]:
    """The responses of the lines that have bending stiffness or a named place, and the scenario."""
    scenario = scenario_of(dataset)
    if scenario is None or not dataset.sizes[path_name(dataset)]:
        return {}, scenario
    outputs, there = scenario.outputs, set(dataset["line"].values.tolist())
    looked = {place.on for place in outputs.places.values()}
    return {
        name: LineResponse(dataset, name, line, outputs.cut_off)
        for name, line in scenario.lines.items()
        if name in there and (line.bending_stiffness or name in looked)
    }, scenario


def histories(dataset: xr.Dataset) -> Iterator[tuple[str, Array, str]]:
    """Name, values (frame,) and unit of each quantity at each named place; NaN where there is none."""
    found, scenario = responses(dataset)
    for name, place in scenario.outputs.places.items() if scenario is not None else ():
        if place.on in found:
            frames = found[place.on].path.size
            for quantity, values in found[place.on].at(place.at).items():
                padded = np.append(values, np.full(frames - values.size, np.nan))
                yield f"{name}.{quantity}", padded, UNITS[quantity]


def response_summary(dataset: xr.Dataset) -> dict[str, Any]:
    """Largest values by line and place, as `deck.deflection`, with those of the static part where they are known."""
    found, scenario = responses(dataset)
    static = json.loads(str(dataset.attrs.get(STATIC, "{}")))
    out: dict[str, Any] = {}
    for name, response in found.items():
        quantities = {key: values for key in UNITS if (values := getattr(response, key)) is not None}
        out[name] = _largest(response, quantities, static.get(name, {}))
    for name, place in scenario.outputs.places.items() if scenario is not None else ():
        if place.on in found:
            here = found[place.on].at(place.at)
            out[name] = _largest(found[place.on], here, static.get(name, {})) | {"xi": place.at, "line": place.on}
    return out


def extremes(quantity: str, values: Array) -> tuple[float, float]:
    """The largest and the smallest value of a quantity; of accelerations and shear the largest in both directions."""
    most, least = float(np.nanmax(values)), float(np.nanmin(values))
    return (max(most, -least) if quantity in _BOTH_WAYS else most), least


def _largest(response: LineResponse, quantities: Mapping[str, Array], static: Mapping[str, float]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if "acceleration" not in quantities and path_name(response.dataset) == "time":
        quantities = {**quantities, "acceleration": np.full((response.path.size, 1), np.nan)}
    for quantity, values in quantities.items():
        if np.isnan(values).all():
            found[quantity] = {"unit": UNITS[quantity], "max": None, "min": None, "largest": None}
            continue
        size = np.abs(values)
        at = np.unravel_index(int(np.nanargmax(size)), size.shape)
        where: dict[str, Any] = {path_name(response.dataset): float(response.path[at[0]])}
        if len(at) > 1:
            middle = 0.5 * (response.xi[1:] + response.xi[:-1]) if quantity == "shear" else response.xi
            where |= {"line": response.name, "xi": float(middle[at[1]])}
        most, least = extremes(quantity, values)
        entry = {
            "unit": UNITS[quantity], "max": most, "min": least,
            "largest": {"value": float(size[at]), "unit": UNITS[quantity], **where},
        }  # fmt: skip
        if quantity in static:
            entry["static"] = static[quantity]
            if static[quantity] > 0.0:
                entry["impact"] = {"value": float(size[at]) / static[quantity], "unit": "1"}
        found[quantity] = entry
    return found
