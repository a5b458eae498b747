"""Panels of a run below an overhead line: contact force, heights, droppers, and what frequencies are in it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.ticker import PercentFormatter

from ropewalk.model.overlap import analysed_of, course_of, reach_of
from ropewalk.results import style
from ropewalk.results.acceptance import FAIL, Judgement
from ropewalk.results.contact_statistics import (
    BETWEEN,
    CUTOFF,
    ContactStatistics,
    LineStatistics,
    analysed_stations,
    contact_statistics,
    filtered,
    has_samples,
    interval_of,
    line_statistics,
    samples,
    scenario_of,
)
from ropewalk.results.contact_summary import limits_of
from ropewalk.results.course import courses, on_lines, on_strips, transitions
from ropewalk.results.frame import Array
from ropewalk.results.shape_views import bar
from ropewalk.results.table import ROUND_OFF

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    from ropewalk.model import Scenario
    from ropewalk.model.overhead import OverheadLine

POINTS = 6000  # most points drawn of one curve
LABELLED = 25  # with more supports than these their uplifts are not written beside them
FORCE, STATION = "pantograph_force", "distance along the line (m)"
FASTEST = 100.0  # Hz, end of the spectrum
BINS = 40
_SHADE: dict[str, Any] = {"color": style.SKY, "alpha": 0.12, "linewidth": 0.0, "zorder": 0}


@dataclass(frozen=True)
class _LoadHistory:
    """What is drawn of a pantograph: arrays (instant,), NaN off the line."""

    name: str
    colour: str
    found: ContactStatistics
    interval: float  # s
    station: Array  # m
    raw: Array  # N
    force: Array  # N, filtered
    height: Array  # m
    judgement: Judgement | None  # beside the limits of its line
    shares: dict[str, Array] = field(default_factory=dict)  # N, of each line as computed while it goes over, of strips


def is_of_overhead_line(dataset: xr.Dataset) -> bool:
    """Whether a result has pantographs with samples, of which this figure can be drawn."""
    return has_samples(dataset) and bool(contact_statistics(dataset))


@dataclass(frozen=True)
class Collection:
    """What the panels of a run below an overhead line are drawn from."""

    histories: tuple[_LoadHistory, ...]
    lines: dict[str, LineStatistics]  # those with pantographs
    line: OverheadLine | None  # the first of them, as declared
    limits: tuple[float, float] | None = None  # m, stations between which statistics are made
    ends: tuple[float, float] | None = None  # m, stations between which there is a contact wire

    @classmethod
    def of(cls, dataset: xr.Dataset) -> Collection:
        """Take a result with pantographs and samples apart."""
        histories = _histories(dataset)
        names, scenario = {history.found.line for history in histories}, scenario_of(dataset)
        every = line_statistics(dataset)
        if scenario is None or not names & scenario.overhead_lines.keys():
            lines = {name: found for name, found in every.items() if not names - {""} or name in names}
            return cls(tuple(histories), lines, _declared(scenario, next(iter(lines), "")))
        own = next(name for name in every if name in names)
        ahead = {key: value for name in names for key, value in course_of(scenario.overhead_lines, name).items()}
        ahead |= course_of(scenario.overhead_lines, own)  # stations of all count from the start of the first line
        lines = {name: _ahead(found, ahead[name]) for name, found in every.items() if name in ahead}
        limits, ends = (of(scenario.overhead_lines, own) for of in (analysed_of, reach_of))
        return cls(tuple(histories), lines, scenario.overhead_lines[own], limits, ends)

    @property
    def panels(self) -> list[str]:
        """Names of all panels that there is something to show in: with the force of each pantograph."""
        hung = any(found.droppers for found in self.lines.values())
        forces = [f"{FORCE}.{history.name}" for history in self.histories]
        return [*forces, "pantograph_height", *(["droppers"] if hung else []), "force_spectrum", "force_histogram"]

    def draw(self, panel: str, ax: Axes) -> None:
        """Draw a panel on empty axes.

        Args:
            panel: one of `panels`.
        """
        if panel.startswith(f"{FORCE}."):
            mine = [history for history in self.histories if history.name == panel.removeprefix(f"{FORCE}.")]
            _force(ax, mine[0], alone=len(self.histories) == 1)
        elif panel == "pantograph_height":
            _height(ax, self.histories, self.lines, 0.0 if self.line is None else self.line.start[-1])
        elif panel == "droppers":
            _droppers(ax, self.lines)
        elif panel == "force_spectrum":
            _spectrum(ax, self.histories, self.line)
            return
        else:
            _share(ax, self.histories)
            return
        for found in self.lines.values():
            for support in found.supports.values():
                ax.axvline(support.station, color=style.FAINT, linewidth=0.6, linestyle=(0, (2, 2)), zorder=0)
        limits = self.limits or analysed_stations(self.line)
        if all(map(math.isfinite, limits)):
            ax.axvspan(*limits, **_SHADE)
        ax.set_xlim(*(self.ends or _reach(self.histories)))


def _ahead(found: LineStatistics, ahead: float) -> LineStatistics:
    """A line whose stations count from a point so many metres before its start."""
    supports = {name: replace(one, station=one.station + ahead) for name, one in found.supports.items()}
    droppers = {name: replace(one, station=one.station + ahead) for name, one in found.droppers.items()}
    return LineStatistics(supports, droppers)


def _declared(scenario: Scenario | None, name: str) -> OverheadLine | None:
    return None if scenario is None else scenario.overhead_lines.get(name)


def _histories(dataset: xr.Dataset) -> list[_LoadHistory]:
    flat = samples(dataset.drop_vars("sampled_tie_force", errors="ignore"))
    interval = interval_of(flat)
    names, out = flat["load"].values.tolist(), []
    every = contact_statistics(dataset)
    scenario = scenario_of(dataset)
    judgements, several = limits_of(dataset, scenario, every), courses(scenario, names)
    going_over = transitions(scenario, flat)
    for i, (name, found) in enumerate(every.items()):
        k = names.index(name)
        station, raw, height = (flat[key].values[:, k] for key in ("station", "force", "height"))
        raw, height = (np.where(np.isfinite(station), values, np.nan) for values in (raw, height))
        colour = style.CYCLE[i % len(style.CYCLE)]
        both = np.zeros(station.size, dtype=np.bool_)
        for passed in going_over.get(name, ()):
            low, high = sorted((passed["first"], passed["last"]))
            both |= (station >= low) & (station <= high)
        shares = dict[str, Array]()
        if (course := several.get(name)) is not None:
            lines, strips = on_lines(course, flat["share"].values), on_strips(course, flat["share"].values)
            shares = {line: np.where(both, own, np.nan) for line, own in lines.items() if len(lines) > 1}
            shares |= {f"the {strip} strip": filtered(own, interval) for strip, own in strips.items()}
        known = interval, station, raw, filtered(raw, interval), height
        out.append(_LoadHistory(name, colour, found, *known, judgements.get(name), shares))
    return out


def _reach(histories: Sequence[_LoadHistory]) -> tuple[float, float]:
    stations = np.concatenate([history.station[np.isfinite(history.station)] for history in histories])
    return float(stations.min()), float(stations.max())


def _force(ax: Axes, history: _LoadHistory, *, alone: bool) -> None:
    some = style.thinned(history.station.size, POINTS)
    faint: dict[str, Any] = {"color": style.FAINT, "alpha": 0.75, "linewidth": 0.5}
    ax.plot(history.station[some], history.raw[some], **faint, label="as computed")
    bold: dict[str, Any] = {"color": history.colour, "linewidth": style.LINE}
    ax.plot(history.station[some], history.force[some], **bold, label=f"up to {CUTOFF:g} Hz")
    found = history.found
    for i, (line, share) in enumerate(history.shares.items()):
        mine: dict[str, Any] = {"color": style.CYCLE[-1 - i], "linewidth": style.THIN}
        ax.plot(history.station[some], share[some], **mine, label=f"part on {line}")
    if math.isfinite(found.mean):
        ends = [found.first, found.last]
        level: dict[str, Any] = {"color": style.BLACK, "linewidth": style.LINE}
        ax.plot(ends, [found.mean] * 2, **level, label=f"mean {found.mean:.1f} N")
        bounds = found.statistical_minimum, found.statistical_maximum
        for i, bound in enumerate(bounds):
            caption = "" if i else f"mean ± 3σ: {bounds[0]:.1f} and {bounds[1]:.1f} N"
            ax.plot(ends, [bound] * 2, **level, linestyle=(0, (5, 2)), label=caption or "_mean + 3σ")
        if math.isfinite(found.target):
            target: dict[str, Any] = {"color": style.GREEN, "linewidth": style.LINE, "linestyle": ":"}
            ax.plot(ends, [found.target] * 2, **target, label=f"target: {found.target:.1f} N")
    # A spike as a pantograph leaves the line would hide everything else.
    seen = history.force[np.isfinite(history.force)]
    high = float(np.percentile(seen, 99.9)) if seen.size else 1.0
    low = min(0.0, found.statistical_minimum) if math.isfinite(found.deviation) else 0.0
    if history.judgement is not None and math.isfinite(found.mean):
        check = next(check for check in history.judgement.checks if check.quantity == "maximum")
        high = max(high, check.high / 1.1)
        strict: dict[str, Any] = {"color": style.RED, "linewidth": style.LINE, "linestyle": (0, (1, 1))}
        caption = f"largest allowed: {check.high:g} N; {check.verdict}"
        ax.plot([found.first, found.last], [check.high] * 2, **strict, label=caption)
        if others := [name for name in history.judgement.broken if name != check.what]:
            ax.plot([], [], linestyle="none", label=f"{FAIL}: {', '.join(others)}")
    ax.set_ylim(low - 0.04 * high, 1.35 * high)
    style.dress(ax, "Contact force" if alone else f"Contact force of {history.name}", STATION, "force (N)")
    style.legend(ax)


def _height(ax: Axes, histories: Sequence[_LoadHistory], lines: dict[str, LineStatistics], level: float) -> None:
    for i, history in enumerate(histories):
        some = style.thinned(history.station.size, POINTS)
        label = "contact" if len(histories) == 1 else f"contact of {history.name}"
        drawn: dict[str, Any] = {"linewidth": style.LINE, **style.marks(i, len(histories), some.size), "label": label}
        ax.plot(history.station[some], history.height[some] - level, color=history.colour, **drawn)
    supports = [support for found in lines.values() for support in found.supports.values()]
    if supports:
        dots: dict[str, Any] = {"linestyle": "none", "marker": "^", "markeredgecolor": "white"}
        uplift = [support.uplift for support in supports]
        stations = [support.station for support in supports]
        label = "largest uplift at supports"
        ax.plot(stations, uplift, color=style.BLACK, markersize=style.sized(7), **dots, label=label, zorder=4)
        if len(supports) <= LABELLED:
            note: dict[str, Any] = {"ha": "center", "va": "top", "fontsize": style.NOTE, "color": style.BLACK}
            ground = {"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none"}
            for station, value in zip(stations, uplift, strict=True):
                caption = f"{1e3 * value:.1f}" if abs(value) > ROUND_OFF else "0"
                ax.text(station, 0.99, caption, transform=ax.get_xaxis_transform(), bbox=ground, **note)
            style.remark(ax, "numbers: uplift in mm")
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.12 * (high - low))
    style.dress(ax, "Height of the contact over the wire's ends", STATION, "height (m)")
    style.legend(ax)


def _droppers(ax: Axes, lines: dict[str, LineStatistics]) -> None:
    droppers = [dropper for found in lines.values() for dropper in found.droppers.values()]
    style.dress(ax, "Droppers: least to largest force", STATION, "force (N)")
    if not droppers:
        return
    station, low, high, slack = (
        np.array([getattr(dropper, key) for dropper in droppers]) for key in ("station", "smallest", "largest", "slack")
    )
    most = float(np.nanmax(slack, initial=0.0))
    scale = Normalize(0.0, most if most > 0.0 else 1.0)
    shades = style.colours(style.TENSION)
    ax.vlines(station, low, high, colors=shades(scale(slack)), linewidth=style.sized(2.0))
    loose = slack > 0.0
    dash: dict[str, Any] = {"color": style.INK, "marker": "_", "markersize": style.sized(5), "linestyle": "none"}
    dots: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": style.sized(3.5), "markeredgewidth": 0.9}
    ax.plot(station, high, **dash, label="_largest")
    ax.plot(station[~loose], low[~loose], **dash, label="_least")
    if loose.any():
        ax.plot(station[loose], low[loose], color=style.RED, markerfacecolor="white", **dots, label="slackens")
    bar(ax, ScalarMappable(scale, shades), "time slack (%)").yaxis.set_major_formatter(PercentFormatter(1.0, symbol=""))
    style.legend(ax)


def _spectrum(ax: Axes, histories: Sequence[_LoadHistory], line: OverheadLine | None) -> None:
    """Amplitudes of the unfiltered force in the analysed spans, with a Hann window."""
    for i, history in enumerate(histories):
        force = history.raw[_analysed(history)]
        if force.size < 16:
            continue
        window = np.hanning(force.size)
        amplitude = 2.0 * np.abs(np.fft.rfft((force - force.mean()) * window)) / window.sum()
        frequency = np.fft.rfftfreq(force.size, history.interval)
        displayed = (frequency > 0.0) & (frequency <= FASTEST)
        curve, label = (frequency[displayed], amplitude[displayed]), history.name if len(histories) > 1 else "_force"
        drawn: dict[str, Any] = {"linewidth": style.THIN, **style.marks(i, len(histories), int(displayed.sum()))}
        ax.plot(*curve, color=history.colour, **drawn, label=label)
        ax.fill_between(*curve, color=history.colour, alpha=0.15, linewidth=0.0)
    marks: list[tuple[float, str, str]] = [(f, f"{f:g} Hz", style.FAINT) for f in (BETWEEN, CUTOFF)]
    speed = histories[0].found.speed if histories else math.nan
    if line is not None and math.isfinite(speed):
        marks.append((speed * len(line.span_lengths) / line.length, "spans", style.RED))
        if gaps := [b - a for row in line.dropper_places for a, b in pairwise(row)]:
            marks.append((speed / float(np.median(gaps)), "droppers", style.RED))
    for rate, label, colour in marks:
        ax.axvline(rate, color=colour, linewidth=style.THIN, linestyle="--", zorder=0)
        row, side = (0.89, "right") if label == "droppers" else (0.99, "left")
        x = rate * (1.04 if side == "left" else 0.96)
        place: dict[str, Any] = {"transform": ax.get_xaxis_transform(), "va": "top", "ha": side}
        ax.text(x, row, label, **place, fontsize=style.NOTE, color=colour)
    ax.set_xscale("log")
    ax.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    ax.set_ylim(0.0, 1.3 * ax.get_ylim()[1])
    style.dress(ax, "Spectrum of the force as computed", "frequency (Hz)", "amplitude (N)")
    style.legend(ax)


def _share(ax: Axes, histories: Sequence[_LoadHistory]) -> None:
    """How often which force acts, in the analysed spans."""
    parts = [(history, history.force[_analysed(history)], history.raw[_analysed(history)]) for history in histories]
    parts = [part for part in parts if part[1].size]
    if parts:
        every = np.concatenate([raw for _, _, raw in parts])
        edges = np.linspace(min(0.0, every.min()), every.max(), BINS + 1)
        for history, force, raw in parts:
            middle, alone = 0.5 * (edges[1:] + edges[:-1]), len(histories) == 1
            shares = [100.0 * np.histogram(values, edges)[0] / force.size for values in (raw, force)]
            step: dict[str, Any] = {"drawstyle": "steps-mid", "linewidth": style.THIN}
            name = "" if alone else f"{history.name}, "
            ax.plot(middle, shares[0], color=style.FAINT if alone else history.colour, linestyle=(0, (1, 1)), **step,
                    label=f"{name}as computed")  # fmt: skip
            ax.plot(middle, shares[1], color=history.colour, **step, label=f"{name}up to {CUTOFF:g} Hz")
            ax.fill_between(middle, shares[1], step="mid", color=history.colour, alpha=0.35, linewidth=0.0)
        ax.set_ylim(bottom=0.0)
    style.dress(ax, "Share of the time", "force (N)", "time (%)")
    style.legend(ax)


def _analysed(history: _LoadHistory) -> Any:
    here = (history.station >= history.found.first) & (history.station <= history.found.last)
    return here & np.isfinite(history.force)
