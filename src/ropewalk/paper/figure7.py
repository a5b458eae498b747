"""Figure 7: a pantograph below an overhead line, fully nonlinear and linearised, one key apart.

The paper shows an engineering application of its own and does not give its data, so that its curves cannot be
reproduced. Taken instead is the reference model of EN 50318:2002 as public secondary sources give it
(docs/overhead-lines.md), at 250 km/h; its numbers are printed in the figure.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.model import Scenario
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.run import Geometry
from ropewalk.results.contact_statistics import (
    CUTOFF,
    analysed_stations,
    contact_statistics,
    filtered,
    interval_of,
    samples,
)
from ropewalk.results.style import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    INSTANTS,
    LABEL,
    LINE,
    NOTE,
    RED,
    SKY,
    THIN,
    colours,
    dress,
    legend,
)
from ropewalk.scenario import loads
from ropewalk.scenario.examples import examples
from ropewalk.simulate import simulate

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

SPEED, START, STOP = 250.0 / 3.6, 10.0, 430.0  # m/s, m, m
STRIDE = 2.5  # m, from frame to frame
DISPLAYED = 295.0  # m, place of the pantograph in the first panel: droppers slacken before and behind a support
PLACES = (250.0, 280.0, 310.0, 340.0)  # m, of the second panel
RANGE = (210.0, 390.0)  # m
HEAD, APART = 0.9, 0.17  # m, half length of the head, and by how much the frame is drawn below it


class Shape(NamedTuple):
    """An overhead line at one instant."""

    place: float  # m, of the pantograph
    contact: Array  # (node, 2) m
    messenger: Array  # (node, 2) m
    droppers: Array  # (dropper, end, 2) m
    pull: Array  # (dropper,) N
    touched: Array  # (2,) m, where the pantograph touches


def scenario(geometry: Geometry = "nonlinear", element: float = 0.25) -> Scenario:
    """The reference line of ten spans; statistics are those of the two in the middle."""
    settings = {
        "title": "Figure 7", "overhead_lines.line.element": f"{element} m", "run.geometry": geometry,
        "run.until": f"{(STOP - START) / SPEED} s", "run.every": f"{STRIDE / SPEED} s",
    }  # fmt: skip
    text = examples()["en50318-2002-250"]
    return loads(text, overrides=[f"{key}={value}" for key, value in settings.items()])


def shape_at(result: xr.Dataset, place: float) -> Shape:
    """The line when the pantograph is nearest to a station in m."""
    frame = result.isel(time=int(np.nanargmin(np.abs(result.contact_xi.values[:, 0] - place))))
    wire, position = frame["line"].values, frame.position.values
    contact, messenger = position[wire == "line.contact"], position[wire == "line.messenger"]
    station = frame.tie_station.values
    ends = [np.column_stack([station, np.interp(station, *both.T)]) for both in (contact, messenger)]
    return Shape(
        float(frame.contact_xi[0]), contact, messenger, np.stack(ends, axis=1), frame.tie_force.values,
        frame.contact_position.values[0],
    )  # fmt: skip


def force_along(result: xr.Dataset) -> tuple[Array, Array]:
    """Stations in m and contact forces in N, up to 20 Hz."""
    flat = samples(result)
    known = np.isfinite(flat.station.values[:, 0])
    return flat.station.values[known, 0], filtered(flat.force.values[known, 0], interval_of(flat))


def runs(element: float = 0.25) -> dict[Geometry, xr.Dataset]:
    """Both motions."""
    return {
        "nonlinear": simulate(scenario("nonlinear", element)),
        "linearised": simulate(scenario("linearised", element)),
    }


def draw() -> Figure:
    """Compute both motions and draw them."""
    from matplotlib.figure import Figure

    large, results = scenario(), runs()
    figure = Figure(figsize=(8.5, 8.6), layout="constrained")
    line, rise, force = figure.subplots(3, 1, height_ratios=(1.25, 1.0, 1.15), sharex=True)
    at_rest = shape_at(results["nonlinear"], START)
    _line(line, shape_at(results["nonlinear"], DISPLAYED), at_rest)
    _rises(rise, [shape_at(results["nonlinear"], place) for place in PLACES], at_rest)
    _forces(force, results, analysed_stations(large.overhead_lines["line"]))
    for panel in (line, rise, force):
        for support in np.arange(60.0, 600.0, 60.0):
            panel.axvline(support, color=FAINT, linewidth=0.6, linestyle=(0, (2, 2)), zorder=0)
    line.set_xlim(*RANGE)
    figure.align_ylabels([line, rise, force])
    figure.supxlabel(_note(large), fontsize=NOTE, color=FAINT)
    _exaggerate(figure, line)
    return figure


def _line(ax: Axes, now: Shape, rest: Shape) -> None:
    from matplotlib.collections import LineCollection

    dress(ax, f"Overhead line with the pantograph at {now.place:.1f} m, fully nonlinear (dashed: at rest)", "", "z (m)")
    for wire, at_rest, width in ((now.contact, rest.contact, 1.8), (now.messenger, rest.messenger, 1.2)):
        ax.plot(*at_rest.T, color=FAINT, linewidth=0.7, linestyle=(0, (4, 2)))
        ax.plot(*wire.T, color=INK, linewidth=width)
    tight = now.pull > 0.0
    for chosen, colour, name in ((tight, GREEN, "droppers"), (~tight, RED, "slack ones")):
        ax.add_collection(LineCollection(list(now.droppers[chosen]), colors=colour, linewidths=1.3, label=name))
    x, z = now.touched
    ax.plot(
        [x - HEAD, x + HEAD],
        [z, z],
        color=BLUE,
        linewidth=4.0,
        solid_capstyle="butt",
        label="pantograph",
    )
    ax.plot([x, x], [z, z - 2.0 * APART], color=BLUE, linewidth=LINE, marker="s", markersize=6, markevery=[1])
    ax.set_ylim(-0.42, 1.28)
    legend(ax)


def _exaggerate(figure: Figure, ax: Axes) -> None:
    """Say how many times as high as long the heights are drawn."""
    figure.draw_without_rendering()  # settles the layout
    box, (left, right), (low, high) = ax.get_window_extent(), ax.get_xlim(), ax.get_ylim()
    factor = (box.height / (high - low)) / (box.width / (right - left))
    ax.set_ylabel(f"z (m), drawn {factor:.0f} times as high", fontsize=LABEL, color=INK)


def _rises(ax: Axes, shapes: list[Shape], rest: Shape) -> None:
    dress(ax, "Rise of the contact wire with the pantograph at four places (dots)", "", "rise (mm)")
    shades = colours(INSTANTS)
    for i, now in enumerate(shapes):
        colour = shades(i / (len(shapes) - 1))
        rise = 1e3 * (now.contact[:, 1] - rest.contact[:, 1])
        ax.plot(now.contact[:, 0], rise, color=colour, linewidth=LINE)
        ax.plot(now.place, np.interp(now.place, now.contact[:, 0], rise), "o", color=colour, markersize=5)
    ax.set_ylim(-35.0, 85.0)


def _forces(ax: Axes, results: dict[Geometry, xr.Dataset], analysed: tuple[float, float]) -> None:
    title = f"Contact force up to {CUTOFF:g} Hz, with mean and σ of the analysed spans (shaded)"
    dress(ax, title, "distance along the line (m)", "force (N)")
    for (kind, result), colour, style in zip(results.items(), (BLUE, RED), ("-", (0, (4, 1.5))), strict=True):
        found = contact_statistics(result)["pantograph"]
        text = "fully nonlinear" if kind == "nonlinear" else kind
        label = f"{text}: {found.mean:.1f} N, σ {found.deviation:.1f} N"
        ax.plot(*force_along(result), color=colour, linewidth=LINE, linestyle=style, label=label)
    (x, large), (station, small) = force_along(results["nonlinear"]), force_along(results["linearised"])
    apart = large - np.interp(x, station, small)
    ax.plot(x, apart, color=GREEN, linewidth=THIN, label="the difference of both")
    ax.axvspan(*analysed, color=SKY, alpha=0.12, linewidth=0.0, zorder=0)
    ax.set_ylim(-20.0, 205.0)
    legend(ax)


def _note(large: Scenario) -> str:
    line, parts = large.overhead_lines["line"], large.loads["pantograph"]
    contact, messenger = line.contact_wire, line.messenger_wire
    assert isinstance(parts, Pantograph)
    (frame, head), (base, spring), (slow, quick) = parts.parts.masses, parts.parts.stiffness, parts.parts.damping
    at = ", ".join(f"{x:g}" for x in line.dropper_places[0])
    return (
        f"{len(line.span_lengths)} spans of {line.span_lengths[0]:g} m, contact wire {contact.mass:g} kg/m, "
        f"{contact.tension / 1e3:g} kN, messenger {messenger.mass:g} kg/m, {messenger.tension / 1e3:g} kN, "
        f"EI = 0, no damping,\ndroppers {line.droppers.stiffness / 1e3:g} kN/m at {at} m of each span, "
        f"system height {line.system_height:g} m, steady arms {line.steady_arms.moving_mass:.2g} kg,\n"
        f"pantograph {frame:g} and {head:g} kg on {base:g} and {spring:g} N/m, {slow:g} and {quick:g} N s/m, "
        f"{parts.pressed_with:g} N, contact {parts.contact_stiffness / 1e3:g} kN/m, V = {3.6 * SPEED:g} km/h, "
        f"links of {line.element:g} m"
    )
