"""Statistics of current collection: the contact force of pantographs, the uplift of supports, the droppers."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.results.course import together
from ropewalk.results.frame import Array

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario
    from ropewalk.model.overhead import OverheadLine
    from ropewalk.model.pantograph import Pantograph

# The force counts up to 20 Hz, as the standards have it. They leave the filter open; here it is a Butterworth filter
# of order 4 run forwards and backwards: without phase, so that peaks stay where they are, at -6 dB at its limit. The
# order matters more than the mesh: from order 2 over 4 to 12, sigma of the EN 50318:2002 model is 26.6, 27.9, 28.1 N at
# 250 km/h and 30.9, 33.4, 34.2 N at 300 km/h.
CUTOFF, BETWEEN = 20.0, 5.0  # Hz: the highest frequency, and where its two bands meet
ORDER = 4
SHORTEST_ARC = 5e-3  # s; shorter losses of contact do not count as arcs (TSI Energy, recalled)
_DROPPER = re.compile(r"(.+)\.\d+\.\d+")  # names of droppers: line, span, number in the span
_SAMPLED = ("station", "force", "height", "tie_force", "uplift")  # quantities with `sampled_` before their names


@dataclass(frozen=True)
class ContactStatistics:
    """A pantograph within the analysed spans, of the force up to 20 Hz where nothing else is said; NaN is unknown."""

    line: str
    first: float  # m, stations between which it was
    last: float
    complete: bool  # whether these are the analysed spans from end to end
    speed: float  # m/s, mean
    fastest: float  # Hz, the highest frequency that the samples hold; below 20 Hz nothing is filtered
    target: float  # N, mean force that the scenario asks for
    mean: float  # N
    deviation: float  # N, standard deviation
    deviation_low: float  # N, of 0 to 5 Hz
    deviation_high: float  # N, of 5 to 20 Hz
    maximum: float  # N
    maximum_at: float  # m
    minimum: float  # N
    minimum_at: float  # m
    loss: float  # share of the time without contact
    long_loss: float  # the same of losses of 5 ms and more, which count as arcs; unknown from coarse samples
    lowest: float  # m, height of the contact
    highest: float  # m
    uplift: float  # m, the largest at a support of the analysed spans while no other pantograph was closer to it
    raw_deviation: float  # N, of the force as computed
    raw_maximum: float  # N
    raw_minimum: float  # N

    @property
    def statistical_maximum(self) -> float:
        """Mean and three standard deviations, N."""
        return self.mean + 3.0 * self.deviation

    @property
    def statistical_minimum(self) -> float:
        """Mean less three standard deviations, N."""
        return self.mean - 3.0 * self.deviation

    @property
    def height_range(self) -> float:
        """Between the lowest and the highest contact, m."""
        return self.highest - self.lowest

    @property
    def relative_deviation(self) -> float:
        """Standard deviation per mean; 0.3 is a usual limit."""
        return self.deviation / self.mean if self.mean else math.nan

    @property
    def target_ratio(self) -> float:
        """Mean force per the one that is asked for."""
        return self.mean / self.target


UNITS = {
    "first": "m", "last": "m", "speed": "m/s", "fastest": "Hz", "target": "N", "target_ratio": "1", "mean": "N",
    "deviation": "N", "deviation_low": "N", "deviation_high": "N", "relative_deviation": "1",
    "statistical_maximum": "N", "statistical_minimum": "N", "maximum": "N",
    "maximum_at": "m", "minimum": "N", "minimum_at": "m", "loss": "1", "long_loss": "1",
    "lowest": "m", "highest": "m", "height_range": "m", "uplift": "m", "raw_deviation": "N", "raw_maximum": "N",
    "raw_minimum": "N",
}  # fmt: skip


@dataclass(frozen=True)
class SupportStatistics:
    """A support between spans, over the whole run."""

    station: float  # m
    analysed: bool  # whether it is one of the analysed spans, their ends included
    uplift: float  # m, the largest height over rest


@dataclass(frozen=True)
class DropperStatistics:
    """A dropper, over the whole run."""

    station: float  # m
    analysed: bool
    length: float  # m, unstrained; NaN: unknown
    largest: float  # N
    smallest: float  # N
    slack: float  # share of the time without a force
    slack_time: float  # s


@dataclass(frozen=True)
class LineStatistics:
    """An overhead line: what its supports and droppers went through, by name."""

    supports: dict[str, SupportStatistics]
    droppers: dict[str, DropperStatistics]


def has_samples(dataset: xr.Dataset) -> bool:
    """Whether a result tells of its contacts between output instants, too."""
    return "sampled_force" in dataset and dataset.sizes.get("contact", 0) > 0 and dataset.sizes.get("time", 0) > 1


def samples(dataset: xr.Dataset) -> xr.Dataset:
    """Line up the samples of all intervals along one dimension `instant`.

    A frame holds the samples of the interval that ends with it: the first one has none, and the last one, where the
    run ends within an interval, has fewer.

    Args:
        dataset: a result with samples.

    Returns:
        `time` in s, `station` in m, `force` in N, `height` in m (instant, contact), `tie_force` in N (instant, tie),
        and `uplift` in m (instant, watched); the latter two where the result has them. A pantograph below lines that
        overlap has its first contact for all of them: the force is that of its head, stations go on, and `share` in N
        (instant, contact) is what each of the wires has of it.
    """
    import xarray as xr

    time, kept = sampled_instants(dataset)
    out = {
        short: ((kind := dataset[name]).dims[2:] and ("instant", *kind.dims[2:]), kind.values[kept], kind.attrs)
        for short in _SAMPLED
        if (name := f"sampled_{short}") in dataset
    }
    if {"station", "force", "height"} <= out.keys():
        dims = out["force"][0]
        plain = {key: out[key][1] for key in ("station", "force", "height")}
        merged = together(scenario_of(dataset), dataset["load"].values.tolist(), plain)
        out |= {key: (dims, values, out.get(key, out["force"])[2]) for key, values in merged.items()}
    names = [n for n in ("load", "tie", "tie_station", "watched", "watched_station") if n in dataset.coords]
    coordinates: dict[str, Any] = {n: dataset[n].variable for n in names}
    coordinates["time"] = ("instant", time, dataset["time"].attrs)
    return xr.Dataset(out, coordinates, dataset.attrs)


def sampled_instants(dataset: xr.Dataset) -> tuple[Array, NDArray[np.bool_]]:
    """Instants of the samples in s, and which entries (time, sample) they are: those within the run, each once."""
    end, offset = dataset["time"].values, dataset["sample"].values
    begin = np.concatenate([end[:1], end[:-1]])  # the first frame ends no interval
    time = end[:, None] + offset
    kept = time >= begin[:, None] - 0.5 * _interval(offset)
    return time[kept], kept


def _interval(offset: Array) -> float:
    return float(offset[-1] - offset[0]) / (offset.size - 1) if offset.size > 1 else float(abs(offset[0]))


def interval_of(flat: xr.Dataset) -> float:
    """Time in s from one sample to the next, of what `samples` gives."""
    time = flat["time"].values
    return float(np.median(np.diff(time))) if time.size > 1 else 1.0


def filtered(signal: Array, interval: float, low: float = 0.0, high: float = CUTOFF) -> Array:
    """What a signal has between two frequencies: Butterworth of order 4, forwards and backwards, -6 dB at its limits.

    Args:
        signal: (instant,), NaN where there is none: every stretch in between is filtered for itself.
        interval: of the instants, s.
        low: Hz; 0: everything below `high`.
        high: Hz; samples too far apart to hold it limit the band by themselves.
    """
    from scipy.signal import butter, sosfiltfilt

    fastest = 0.5 / interval
    if low >= fastest:
        return np.where(np.isfinite(signal), 0.0, np.nan)
    kind, limits = ("lowpass", [high]) if low == 0.0 else ("bandpass", [low, high])
    if high >= fastest:
        if low == 0.0:
            return signal.copy()
        kind, limits = "highpass", [low]
    sections = butter(ORDER, limits if len(limits) > 1 else limits[0], kind, fs=1.0 / interval, output="sos")
    out = np.full_like(signal, np.nan)
    for part in _stretches(np.isfinite(signal)):
        # Mirrored ends, a period of the lowest limit long: turned round as well (odd), they would double a last spike.
        reach = min(part.stop - part.start - 1, max(int(1.0 / (limits[0] * interval)), 6 * len(sections)))
        out[part] = sosfiltfilt(sections, signal[part], padtype="even", padlen=reach)
    return out


def _stretches(there: NDArray[np.bool_]) -> Iterator[slice]:
    steps = np.diff(np.concatenate([[0], there.astype(np.int8), [0]]))
    for first, last in zip(np.flatnonzero(steps == 1), np.flatnonzero(steps == -1), strict=True):
        yield slice(int(first), int(last))


def scenario_of(dataset: xr.Dataset) -> Scenario | None:
    """The scenario of a result, or None where its text cannot be read back (callables of the Python API)."""
    return _read(str(dataset.attrs.get("scenario", "")))


def contacts_by_load(dataset: xr.Dataset, *kinds: type) -> dict[str, list[int]]:
    """The contacts of each load of some kinds, by its name."""
    scenario, names = scenario_of(dataset), dataset["load"].values.tolist()
    if scenario is None:
        return {}
    return {
        name: [k for k, contact in enumerate(names) if contact.partition(".")[0] == name]
        for name, load in scenario.loads.items()
        if isinstance(load, kinds)
    }


@lru_cache(maxsize=4)
def _read(text: str) -> Scenario | None:
    from ropewalk.model import Scenario

    try:
        return Scenario.model_validate_json(text)
    except ValueError:
        return None


def pantographs(dataset: xr.Dataset, scenario: Scenario | None) -> dict[int, Pantograph | None]:
    """Contacts that are those of pantographs, by number; None where more than that is not known."""
    from ropewalk.model.pantograph import Pantograph

    loads = dataset["load"].values.tolist()
    if scenario is not None:
        given = ((k, scenario.loads.get(name)) for k, name in enumerate(loads))
        return {k: load for k, load in given if isinstance(load, Pantograph)}
    try:
        statistics = json.loads(dataset.attrs.get("scenario", ""))["loads"]
    except (ValueError, KeyError, TypeError):  # nothing is told at all: a result with ties is of an overhead line
        return dict.fromkeys(range(len(loads)) if dataset.sizes.get("tie", 0) else ())
    return {k: None for k, name in enumerate(loads) if statistics.get(name, {}).get("kind") == "pantograph"}


def analysed_stations(line: OverheadLine | None) -> tuple[float, float]:
    """Stations in m between which statistics are made: everything, where a line is not known."""
    from ropewalk.model.overhead import stations_of

    if line is None:
        return -math.inf, math.inf
    stations, (first, last) = stations_of(line), line.analysed
    return stations[first - 1], stations[last]


def contact_statistics(dataset: xr.Dataset) -> dict[str, ContactStatistics]:
    """Statistics of every pantograph of a result with samples, by name; none where it has no samples."""
    if not has_samples(dataset):
        return {}
    from ropewalk.model.overlap import analysed_of, course_of

    scenario = scenario_of(dataset)
    every = pantographs(dataset, scenario)
    if not every:
        return {}
    flat = samples(dataset.drop_vars("sampled_tie_force", errors="ignore"))
    names = dataset["load"].values.tolist()
    lines = {k: pantograph.on if pantograph is not None else "" for k, pantograph in every.items()}
    found = {}
    for k, pantograph in every.items():
        name = lines[k]
        line = scenario.overhead_lines[name] if scenario is not None and name in scenario.overhead_lines else None
        limits, course = analysed_stations(line), {name: 0.0}
        if scenario is not None and line is not None:
            limits, course = analysed_of(scenario.overhead_lines, name), course_of(scenario.overhead_lines, name)
        ahead = {j: course[lines[j]] for j in every if lines[j] in course}
        uplift = _own_uplift(flat, course, limits, k, ahead)
        found[names[k]] = _of_contact(flat.isel(contact=k), name, limits, pantograph, uplift)
    return found


def _own_uplift(
    flat: xr.Dataset, course: dict[str, float], limits: tuple[float, float], k: int, ahead: dict[int, float]
) -> float:
    """The largest rise in m of an analysed support while contact k is the closest of those on its lines.

    Args:
        flat: samples.
        course: how far ahead of the line of the contact each of its lines begins, m.
        limits: stations, m.
        k: the contact.
        ahead: the contacts of all pantographs there, and the same of their own lines, m.
    """
    if "uplift" not in flat:
        return math.nan
    labels, places = flat["watched"].values.tolist(), flat["watched_station"].values.copy()
    here = []
    for w, label in enumerate(labels):
        line = label.partition(".support.")[0] if next(iter(course)) else ""
        places[w] += course.get(line, 0.0)
        if line in course and limits[0] <= places[w] <= limits[1]:
            here.append(w)
    others = list(ahead)
    station, rise = flat["station"].values[:, others] + list(ahead.values()), flat["uplift"].values
    largest = math.nan
    for w in here:
        away = np.abs(station - places[w])
        away[np.isnan(away)] = np.inf  # who is off the line lifts nothing
        mine = (away.argmin(axis=1) == others.index(k)) & np.isfinite(away.min(axis=1))
        largest = float(np.fmax(largest, _largest(rise[mine, w])))
    return largest


def _of_contact(
    flat: xr.Dataset, line: str, limits: tuple[float, float], pantograph: Pantograph | None, uplift: float
) -> ContactStatistics:
    time, station, raw, height = (flat[n].values for n in ("time", "station", "force", "height"))
    interval = interval_of(flat)
    raw = np.where(np.isfinite(station), raw, np.nan)  # off the line there is no force, which is not one of 0 N
    bands = (0.0, CUTOFF), (0.0, BETWEEN), (BETWEEN, CUTOFF)
    force, slow, fast = (filtered(raw, interval, *band) for band in bands)
    here = np.flatnonzero((station >= limits[0]) & (station <= limits[1]) & np.isfinite(force))
    nothing = dict.fromkeys((f.name for f in fields(ContactStatistics) if f.type == "float"), math.nan)
    if here.size < 2:
        return ContactStatistics(line=line, complete=False, **(nothing | {"uplift": uplift}))
    force, slow, fast, raw, height, station, time = (v[here] for v in (force, slow, fast, raw, height, station, time))
    stride = float(np.abs(np.diff(station)).max())
    speed = float(np.ptp(station) / np.ptp(time))
    top, bottom = int(np.argmax(force)), int(np.argmin(force))
    return ContactStatistics(
        line=line, first=float(station.min()), last=float(station.max()),
        complete=bool(station.min() <= limits[0] + stride and station.max() >= limits[1] - stride),
        speed=speed, fastest=0.5 / interval, target=_target(pantograph, speed),
        mean=float(force.mean()), deviation=float(force.std()),
        deviation_low=float(slow.std()), deviation_high=float(fast.std()),
        maximum=float(force[top]), maximum_at=float(station[top]),
        minimum=float(force[bottom]), minimum_at=float(station[bottom]), loss=float(np.mean(raw == 0.0)),
        long_loss=_long_loss(raw, interval),
        lowest=float(height.min()), highest=float(height.max()), uplift=uplift,
        raw_deviation=float(raw.std()), raw_maximum=float(raw.max()), raw_minimum=float(raw.min()),
    )  # fmt: skip


def _long_loss(force: Array, interval: float) -> float:
    """Share of the samples of a force that are within losses of contact of an arc's least duration."""
    if interval > SHORTEST_ARC * (1.0 + 1e-9):
        return math.nan
    count = sum(
        part.stop - part.start
        for part in _stretches(force == 0.0)
        if (part.stop - part.start) * interval >= SHORTEST_ARC * (1.0 - 1e-9)
    )
    return float(count / force.size)


def _target(pantograph: Pantograph | None, speed: float) -> float:
    from ropewalk.model.pantographs import mean_force

    wanted = None if pantograph is None else pantograph.wanted_mean
    if isinstance(wanted, str):
        return mean_force(wanted, speed)
    return math.nan if wanted is None else wanted


def line_statistics(dataset: xr.Dataset, *, ties: bool = True) -> dict[str, LineStatistics]:
    """Statistics of supports and droppers of every overhead line, from samples, or without them at output instants.

    Args:
        dataset: a result.
        ties: look at droppers, too.
    """
    sampled = has_samples(dataset)
    scenario = scenario_of(dataset)
    watched = dataset["watched"].values.tolist() if "watched" in dataset.coords else []
    hung = dataset["tie"].values.tolist() if "tie" in dataset.coords else []
    known = {} if scenario is None else scenario.overhead_lines
    names = list(known) or sorted({m[1] for tie in hung if (m := _DROPPER.fullmatch(tie))})
    kept = sampled_instants(dataset)[1] if sampled else None
    out = {}
    for name in names:
        line = known.get(name)
        low, high = analysed_stations(line)
        supports = {}
        for k, label in enumerate(watched if kept is not None else ()):
            if label.startswith(f"{name}.support."):
                station = float(dataset["watched_station"].values[k])
                uplift = dataset["sampled_uplift"][:, :, k].values[kept]
                supports[label] = SupportStatistics(station, low <= station <= high, _largest(uplift))
        which = [k for k, tie in enumerate(hung) if (m := _DROPPER.fullmatch(tie)) and m[1] == name] if ties else []
        out[name] = LineStatistics(supports, _droppers(dataset, line, which, kept, (low, high)))
    return out


def _largest(values: Array) -> float:
    return float(np.nanmax(values)) if np.isfinite(values).any() else math.nan


def _droppers(
    dataset: xr.Dataset,
    line: OverheadLine | None,
    which: list[int],
    kept: NDArray[np.bool_] | None,
    limits: tuple[float, float],
) -> dict[str, DropperStatistics]:
    """Read in pieces: long lines have many droppers."""
    lengths = dropper_lengths(dataset, line, which)
    interval = math.nan if kept is None else _interval(dataset["sample"].values)
    out = {}
    for first in range(0, len(which), 100):
        piece = which[first : first + 100]
        sampled = dataset["tie_force" if kept is None else "sampled_tie_force"].isel(tie=piece).values
        force = sampled if kept is None else sampled[kept]
        for i, k in enumerate(piece):
            station, pull = float(dataset["tie_station"].values[k]), force[:, i][np.isfinite(force[:, i])]
            is_slack = pull <= 0.0
            out[str(dataset["tie"].values[k])] = DropperStatistics(
                station, limits[0] <= station <= limits[1], float(lengths[first + i]),
                float(pull.max(initial=-np.inf)) if pull.size else math.nan,
                float(pull.min(initial=np.inf)) if pull.size else math.nan,
                float(is_slack.mean()) if pull.size else math.nan, float(is_slack.sum() * interval),
            )  # fmt: skip
    return out


def dropper_lengths(dataset: xr.Dataset, line: OverheadLine | None, which: list[int]) -> Array:
    """Unstrained lengths of droppers in m: those given, or as the first frame shows them less their strain.

    Args:
        dataset: a result that begins at rest.
        line: the overhead line as declared; NaN without it, or where droppers lean and the result is in a plane.
        which: the droppers, by their number among the ties.
    """
    unknown = np.full(len(which), np.nan)
    if line is None or not which:
        return unknown
    if line.dropper_lengths is not None:
        lengths = {f"{i}.{k}": length for i, row in enumerate(line.dropper_lengths, start=1)
                   for k, length in enumerate(row, start=1)}  # fmt: skip
        own = line.condition
        longer = 1.0 if own is None else 1.0 + own.expansion * own.temperature_rise
        return longer * np.array([lengths[".".join(str(dataset["tie"].values[k]).rsplit(".", 2)[1:])] for k in which])
    axes = dataset["axis"].values.tolist()
    if line.messenger_supports.stagger == "straight" and "y" not in axes:
        return unknown
    name = _DROPPER.fullmatch(str(dataset["tie"].values[which[0]]))
    assert name is not None
    wires = dataset["line"].values
    first = dataset["position"][0].values
    x = line.start[0] + dataset["tie_station"].values[which]

    def on(wire: str) -> Array:
        nodes = first[wires == wire]
        inside = (x >= nodes[0, 0]) & (x <= nodes[-1, 0])
        at = np.stack([np.interp(x, nodes[:, 0], nodes[:, i]) for i in range(1, len(axes))], axis=1)
        return np.where(inside[:, None], at, np.nan)

    high = on(f"{name[1]}.messenger")
    for wire in dict.fromkeys(w for w in wires.tolist() if w.startswith(f"{name[1]}.stitch.")):
        stitch = on(wire)
        high = np.where(np.isfinite(stitch), stitch, high)
    stretched = np.linalg.norm(high - on(f"{name[1]}.contact"), axis=1)
    pull = dataset["tie_force"][0].values[which]
    return np.asarray(stretched - np.maximum(pull, 0.0) / line.droppers.stiffness)
