"""Largest deflections and accelerations of lines under trains, straight from their modes.

They are those of the result of a run of kind linear, whose frames are not made: all that stands between the coordinates
of the modes and what is read of a line, the filter and splines, is linear in them. A line is made ready once, for all
trains and speeds of a sweep.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from ropewalk.linear.chord import Chord, chords
from ropewalk.linear.field import FEW
from ropewalk.linear.steady import SteadyForces
from ropewalk.mechanics.chain import Array
from ropewalk.model.axles import Axles
from ropewalk.model.mesh import is_asked_for
from ropewalk.model.run import Linear
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.results.line_response import evenly_fine, extremes, filtered_derivative, spline_weights
from ropewalk.results.verdict import NOTHING
from ropewalk.solve.start import setting_of

QUANTITIES = ("deflection", "acceleration")


@dataclass(frozen=True)
class _Lines:
    """The lines of a scenario; the same text stands for the same lines."""

    text: str
    scenario: Scenario = field(compare=False)


@lru_cache(maxsize=16)
def _ready(lines: _Lines) -> dict[str, tuple[Chord, Array]]:
    """Lines as chords, and where their nodes are, m."""
    scenario = lines.scenario
    setting = setting_of(scenario, 1.0)
    found = chords(setting, scenario, RunInfo())
    xi = [np.arange(n + 1) * h for n, h in zip(setting.strands.links, setting.strands.h, strict=True)]
    return dict(zip(scenario.lines, zip(found, xi, strict=True), strict=True))


def peaks(
    scenario: Scenario, times: Array, asked: Sequence[tuple[str, str]]
) -> Mapping[tuple[str, str], tuple[float, float]] | None:
    """The largest and the smallest value of quantities, as the summary of the run has them.

    Args:
        scenario: which the linear theory computes line by line.
        times: (instant,) s, its output instants.
        asked: names of lines or places of `outputs`, and which of `QUANTITIES`.

    Returns:
        None where only the run itself can tell: under other loads than trains of more than a few axles that come to
        their line and press on it, or with output instants that accelerations ask too much of.

    Raises:
        EquilibriumError: a line has no rest shape, or is slack.
    """
    run, trains = scenario.run, {name: load for name, load in scenario.loads.items() if isinstance(load, Axles)}
    alone = len({train.on for train in trains.values()}) == len(scenario.loads)
    if not isinstance(run, Linear) or not alone:
        return None
    cut_off = scenario.outputs.cut_off
    even = evenly_fine(times, cut_off)
    if (
        scenario.outputs.impact
        or is_asked_for(scenario.parts)
        or (not even and any(q == "acceleration" for _, q in asked))
    ):
        return None
    text = "\n".join(
        [repr(scenario.gravity), *(name + line.model_dump_json() for name, line in scenario.lines.items())]
    )
    lines = _ready(_Lines(text, scenario))
    on = {train.on: _steady(train, lines[train.on][0], run.modes, times) for train in trains.values()}
    found = dict[tuple[str, str], tuple[float, float]]()
    for name, quantity in asked:
        place = scenario.outputs.places.get(name)
        forces = on.get(name if place is None else place.on)
        if forces is None or any(each is None for each in on.values()):
            return None
        chord, xi = lines[name if place is None else place.on]
        nodes = forces.shape(np.linspace(0.0, chord.length, xi.size)) * -chord.across[0][-1]
        shape = nodes if place is None else nodes @ spline_weights(xi, place.at)[:, None]
        found[name, quantity] = extremes(quantity, _values(forces, quantity, shape, times, even, cut_off))
    return found


def _steady(train: Axles, chord: Chord, modes: int | None, times: Array) -> SteadyForces | None:
    """The axles of a train as forces; None where the run goes another way, or has something to doubt."""
    travel, V = train.travel, train.travel.speed
    if not (isinstance(V, float) and V > 0.0 and travel.measured == "material"):
        return None
    if travel.start > chord.material or (chord.is_string and modes is None):
        return None
    behind, size = np.array(train.axles).T
    scale = chord.length / chord.material
    if size.size <= FEW or size.max() <= NOTHING * max(chord.tension, 9.81 * chord.mass * chord.length):
        return None
    down = -chord.across[0][-1]
    begin, speed = scale * (travel.start - behind), np.full(size.size, scale * V)
    gone = speed[0] * times
    if not any(((x >= 0.0) & (x <= chord.length)).any() for x in (at + gone for at in begin)):
        return None
    return SteadyForces(chord, begin, speed, size * down, modes)


def _values(forces: SteadyForces, quantity: str, shape: Array, times: Array, even: int, cut_off: float) -> Array:
    """A quantity (instant, place) by shapes (mode, place), downwards for deflections, else upwards."""
    z, rates = forces.coordinates(times)
    if quantity == "deflection":
        return np.asarray((z - z[0]) @ shape)
    rates = rates[:even]
    if shape.shape[0] > shape.shape[1]:  # the fewer are filtered
        return filtered_derivative(times[:even], rates @ -shape, cut_off)
    return filtered_derivative(times[:even], rates, cut_off) @ -shape
