"""The figure of a run below an overhead line: contact force, heights, droppers, and what frequencies are in it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from ropewalk.results import style
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
from ropewalk.results.frame import Array

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    from ropewalk.model import Scenario
    from ropewalk.model.overhead import OverheadLine

POINTS = 6000  # most points drawn of one curve
FASTEST = 100.0  # Hz, end of the spectrum
BINS = 40
_SHADE: dict[str, Any] = {"color": style.SKY, "alpha": 0.12, "linewidth": 0.0, "zorder": 0}


@dataclass(frozen=True)
class _Ride:
    """What is drawn of a pantograph: arrays (instant,), NaN off the line."""

    name: str
    colour: str
    found: ContactStatistics
    interval: float  # s
    station: Array  # m
    raw: Array  # N
    force: Array  # N, filtered
    height: Array  # m


def is_of_overhead_line(dataset: xr.Dataset) -> bool:
    """Whether a result has pantographs with samples, of which this figure can be drawn."""
    return has_samples(dataset) and bool(contact_statistics(dataset))


def contact_figure(dataset: xr.Dataset) -> Figure:
    """Draw what pantographs and overhead line do to each other, over the distance along the line.

    Args:
        dataset: a result with pantographs and samples.
    """
    scenario = scenario_of(dataset)
    rides = _rides(dataset)
    names = {ride.found.line for ride in rides}
    lines = {name: found for name, found in line_statistics(dataset).items() if not names - {""} or name in names}
    line = _declared(scenario, next(iter(lines), ""))
    fig = Figure(figsize=(11.0, 11.5), dpi=style.DPI, layout="constrained")
    layout: list[Any] = [["force", "force"], ["height", "height"], ["droppers", "droppers"], ["spectrum", "share"]]
    ax = fig.subplot_mosaic(layout, height_ratios=(1.35, 1.0, 1.0, 1.0))
    _headline(fig, dataset)
    _force(ax["force"], rides)
    _height(ax["height"], rides, lines, 0.0 if line is None else line.start[-1])
    _droppers(ax["droppers"], lines)
    _spectrum(ax["spectrum"], rides, line)
    _share(ax["share"], rides)
    along = [ax[name] for name in ("force", "height", "droppers")]
    stations = [support.station for found in lines.values() for support in found.supports.values()]
    for panel in along:
        for station in stations:
            panel.axvline(station, color=style.FAINT, linewidth=0.6, linestyle=(0, (2, 2)), zorder=0)
        limits = analysed_stations(line)
        if all(map(math.isfinite, limits)):
            panel.axvspan(*limits, **_SHADE)
    for panel in along[1:]:
        panel.sharex(along[0])
    for panel in along[:-1]:
        panel.set_xlabel("")
        panel.tick_params(labelbottom=False)
    along[0].set_xlim(*_reach(rides, line))
    style.lift_titles([ax["spectrum"], ax["share"]])
    fig.align_ylabels([*along, ax["spectrum"]])
    return fig


def _declared(scenario: Scenario | None, name: str) -> OverheadLine | None:
    return None if scenario is None else scenario.overhead_lines.get(name)


def _rides(dataset: xr.Dataset) -> list[_Ride]:
    flat = samples(dataset.drop_vars("sampled_tie_force", errors="ignore"))
    interval = interval_of(flat)
    names, out = flat["load"].values.tolist(), []
    for i, (name, found) in enumerate(contact_statistics(dataset).items()):
        k = names.index(name)
        station, raw, height = (flat[key].values[:, k] for key in ("station", "force", "height"))
        raw, height = (np.where(np.isfinite(station), values, np.nan) for values in (raw, height))
        colour = style.CYCLE[i % len(style.CYCLE)]
        out.append(_Ride(name, colour, found, interval, station, raw, filtered(raw, interval), height))
    return out


def _reach(rides: list[_Ride], line: OverheadLine | None) -> tuple[float, float]:
    stations = np.concatenate([ride.station[np.isfinite(ride.station)] for ride in rides])
    ends = (0.0, line.length) if line is not None else (stations.min(), stations.max())
    return float(ends[0]), float(ends[1])


def _headline(fig: Figure, dataset: xr.Dataset) -> None:
    outcome = dataset.attrs.get("outcome", "")
    note = "" if outcome == "completed" else f"  ({outcome})"
    title = f"{dataset.attrs.get('title', '')}{note}"
    fig.suptitle(title, fontsize=style.TITLE + 2, color=style.INK, fontweight="bold", x=0.01, ha="left")


def _force(ax: Axes, rides: list[_Ride]) -> None:
    alone = len(rides) == 1
    for ride in rides:
        some = style.thinned(ride.station.size, POINTS)
        faint: dict[str, Any] = {"color": style.FAINT if alone else ride.colour, "alpha": 0.75 if alone else 0.35}
        ax.plot(ride.station[some], ride.raw[some], linewidth=0.5, **faint, label="as computed" if alone else None)
        label = f"up to {CUTOFF:g} Hz" if alone else ride.name
        ax.plot(ride.station[some], ride.force[some], color=ride.colour, linewidth=style.LINE, label=label)
        found = ride.found
        if not math.isfinite(found.mean):
            continue
        ends = [found.first, found.last]
        level: dict[str, Any] = {"color": style.RED if alone else ride.colour, "linewidth": style.LINE}
        ax.plot(ends, [found.mean] * 2, **level, label=f"mean {found.mean:.1f} N" if alone else None)
        bounds = found.statistical_minimum, found.statistical_maximum
        for i, bound in enumerate(bounds):
            told = f"mean ± 3σ: {bounds[0]:.1f} and {bounds[1]:.1f} N" if alone and not i else None
            ax.plot(ends, [bound] * 2, **level, linestyle=(0, (5, 2)), label=told)
        if math.isfinite(found.target):
            told = f"asked for: {found.target:.1f} N" if alone else None
            ax.plot(ends, [found.target] * 2, color=style.GREEN, linewidth=style.LINE, linestyle=":", label=told)
    # A spike as a pantograph leaves the line would hide everything else.
    seen = np.concatenate([ride.force[np.isfinite(ride.force)] for ride in rides])
    high = float(np.percentile(seen, 99.9)) if seen.size else 1.0
    low = min([0.0, *(r.found.statistical_minimum for r in rides if math.isfinite(r.found.deviation))])
    ax.set_ylim(min(1.1 * low, -0.03 * high), 1.35 * high)
    title = "Contact force, with mean and mean ± 3σ of the analysed spans (shaded)"
    style.dress(ax, title, "distance along the line (m)", "force (N)")
    style.legend(ax)


def _height(ax: Axes, rides: list[_Ride], lines: dict[str, LineStatistics], level: float) -> None:
    for ride in rides:
        some = style.thinned(ride.station.size, POINTS)
        label = "contact" if len(rides) == 1 else f"contact of {ride.name}"
        height = 1e3 * (ride.height[some] - level)
        ax.plot(ride.station[some], height, color=ride.colour, linewidth=style.LINE, label=label)
    supports = [support for found in lines.values() for support in found.supports.values()]
    if supports:
        dots: dict[str, Any] = {"linestyle": "none", "marker": "^", "markersize": 7, "markeredgecolor": "white"}
        uplift = [1e3 * support.uplift for support in supports]
        stations = [support.station for support in supports]
        ax.plot(stations, uplift, color=style.RED, **dots, label="largest uplift at supports", zorder=4)
        if len(supports) <= 25:
            note: dict[str, Any] = {"ha": "center", "va": "top", "fontsize": style.NOTE, "color": style.RED}
            ground = {"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none"}
            for station, value in zip(stations, uplift, strict=True):
                ax.text(station, 0.99, f"{value:.1f}", transform=ax.get_xaxis_transform(), bbox=ground, **note)
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.12 * (high - low))
    title, label = "Height of the contact over the wire's ends, and uplift at supports", "height (mm)"
    style.dress(ax, title, "distance along the line (m)", label)
    style.legend(ax)


def _droppers(ax: Axes, lines: dict[str, LineStatistics]) -> None:
    droppers = [dropper for found in lines.values() for dropper in found.droppers.values()]
    style.dress(ax, "Droppers: least to largest force", "distance along the line (m)", "force (N)")
    if not droppers:
        return
    station, low, high, slack = (
        np.array([getattr(dropper, key) for dropper in droppers]) for key in ("station", "smallest", "largest", "slack")
    )
    most = float(np.nanmax(slack, initial=0.0))
    scale = Normalize(0.0, most if most > 0.0 else 1.0)
    shades = style.colours(style.TENSION)
    ax.vlines(station, low, high, colors=shades(scale(slack)), linewidth=2.0)
    ax.plot(station, high, color=style.INK, marker="_", markersize=5, linestyle="none")
    loose = slack > 0.0
    dots: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 3.5, "markeredgewidth": 0.9}
    taut = low[~loose]
    ax.plot(station[~loose], taut, color=style.INK, marker="_", markersize=5, linestyle="none")
    ax.plot(station[loose], low[loose], color=style.RED, markerfacecolor="white", **dots, label="slackens")
    bar = ax.figure.colorbar(ScalarMappable(scale, shades), ax=ax, fraction=0.03, pad=0.01, aspect=18)
    bar.set_label("time slack (%)", fontsize=style.LABEL, color=style.INK)
    bar.ax.yaxis.set_major_formatter(PercentFormatter(1.0, symbol=""))
    bar.ax.tick_params(labelsize=style.TICK, colors=style.INK, width=0.6, length=3)
    bar.outline.set_visible(False)
    style.legend(ax)


def _spectrum(ax: Axes, rides: list[_Ride], line: OverheadLine | None) -> None:
    """Amplitudes of the unfiltered force in the analysed spans, with a Hann window."""
    for ride in rides:
        force = ride.raw[_analysed(ride)]
        if force.size < 16:
            continue
        window = np.hanning(force.size)
        amplitude = 2.0 * np.abs(np.fft.rfft((force - force.mean()) * window)) / window.sum()
        frequency = np.fft.rfftfreq(force.size, ride.interval)
        shown = (frequency > 0.0) & (frequency <= FASTEST)
        ax.plot(frequency[shown], amplitude[shown], color=ride.colour, linewidth=style.THIN)
        ax.fill_between(frequency[shown], amplitude[shown], color=ride.colour, alpha=0.15, linewidth=0.0)
    marks: list[tuple[float, str, str]] = [(f, f"{f:g} Hz", style.FAINT) for f in (BETWEEN, CUTOFF)]
    speed = rides[0].found.speed if rides else math.nan
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


def _share(ax: Axes, rides: list[_Ride]) -> None:
    """How often which force acts, in the analysed spans."""
    parts = [(ride, ride.force[_analysed(ride)], ride.raw[_analysed(ride)]) for ride in rides]
    parts = [part for part in parts if part[1].size]
    if parts:
        every = np.concatenate([raw for _, _, raw in parts])
        edges = np.linspace(min(0.0, every.min()), every.max(), BINS + 1)
        for ride, force, raw in parts:
            options: dict[str, Any] = {"bins": edges, "weights": np.full(force.size, 100.0 / force.size)}
            alone = len(rides) == 1
            faint = style.FAINT if alone else ride.colour
            ax.hist(raw, **options, histtype="step", color=faint, linewidth=style.THIN,
                    label="as computed" if alone else None)  # fmt: skip
            label = f"up to {CUTOFF:g} Hz" if alone else ride.name
            ax.hist(force, **options, color=ride.colour, alpha=0.45, label=label)
    style.dress(ax, "Share of the time", "force (N)", "time (%)")
    style.legend(ax)


def _analysed(ride: _Ride) -> Any:
    here = (ride.station >= ride.found.first) & (ride.station <= ride.found.last)
    return here & np.isfinite(ride.force)
