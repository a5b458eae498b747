"""Deflection, acceleration, moment and shear of beams, static parts and impact factors."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ropewalk.errors import ScenarioError
from ropewalk.results.line_response import responses
from ropewalk.results.statistics import summary
from ropewalk.results.table import text
from ropewalk.results.table_export import series_table
from ropewalk.scenario import loads
from ropewalk.simulate import simulate
from ropewalk.sweeps.quantities import measured

BEAM = """\
gravity: 0
lines:
  deck: {start: [0, 0], end: [20, 0], length: 20, mass: 1e4, axial_stiffness: 1e10, elements: ELEMENTS,
         bending_stiffness: 1.6e10, drag: 0.6}
loads:
  axle: {kind: axles, on: deck, forces: 100 kN, at: [0], travel: {speed: 50 m/s, from: START}}
outputs: {places: {quarter: {on: deck, at: 5}}}
run: RUN
"""
MOVES = "{kind: dynamic, geometry: linearised, until: crossing, every: 4 ms}"
SLOW = "{kind: quasistatic, positions: 201}"


def beam(run: str, elements: int = 20, start: float = 0.0, **settings: str) -> Any:
    told = BEAM.replace("ELEMENTS", str(elements)).replace("START", str(start)).replace("RUN", run)
    return simulate(loads(told, overrides=[f"{key.replace('__', '.')}={value}" for key, value in settings.items()]))


def known_moment(x: Any, a: Any, force: float = 100e3, length: float = 20.0) -> Any:
    """Of a force at a on a beam on two supports, N m."""
    return force * np.where(x < a, x * (length - a), a * (length - x)) / length


def test_the_moment_has_its_corner_under_an_axle_wherever_that_stands() -> None:
    """Exact at rest but within a link of the ends, where the spline is mirrored; without the corner 3 % are missing."""
    slow = beam(SLOW)
    deck = responses(slow)[0]["deck"]
    at = slow.contact_xi.values
    inner = (at[:, 0] > 2.0) & (at[:, 0] < 18.0)
    missed = np.abs(deck.moment - known_moment(deck.xi, at))[inner].max()
    assert missed < 1e-6 * 500e3
    assert deck.moment.max() == pytest.approx(500e3, rel=1e-5)


def test_the_moment_over_a_pier_has_its_corner() -> None:
    """Two spans of 10 m, F in the middle of the first: -3 F l / 32 over the pier; second order of the links."""
    pier = "{pier: {at: 10, kind: guided, along: [1, 0]}}"
    missed = []
    for elements in (20, 40):
        rest = beam("{kind: equilibrium}", elements, 5.0, lines__deck__supports=pier)
        here = responses(rest)[0]["deck"]
        missed.append(abs(float(here.moment[0, elements // 2]) + 3.0 * 100e3 * 10.0 / 32.0))
    assert missed[0] < 5e-3 * 93750.0
    assert missed[1] < 0.3 * missed[0]


def test_sine_modes_give_moments_from_exact_deflections() -> None:
    """Fourth order of the links but for the corners, which are put back: 0.3 % by the modes that are left out."""
    result = beam("{kind: linear, until: 40 s, every: 0.5 s}", loads__axle__travel__speed="0.5 m/s",
                  lines__deck__drag="50 Hz")  # fmt: skip
    deck, at = responses(result)[0]["deck"], result.contact_xi.values
    on = np.isfinite(at[:, 0])
    assert np.abs(deck.moment - known_moment(deck.xi, at))[on].max() < 5e-3 * 500e3


def test_shear_is_the_slope_of_the_moment() -> None:
    rest = beam("{kind: equilibrium}", 20, 7.5)
    deck = responses(rest)[0]["deck"]
    middle = 0.5 * (deck.xi[1:] + deck.xi[:-1])
    away = np.abs(middle - 7.5) > 1.1
    known = np.where(middle < 7.5, 100e3 * 12.5 / 20.0, -100e3 * 7.5 / 20.0)
    assert np.abs(deck.shear[0] - known)[away].max() < 1.0


def test_accelerations_are_filtered_without_delay() -> None:
    """A free swing of the first mode, 5 Hz, is left alone; one of the third, 45 Hz, by 1 / (1 + 1.5^8) of it."""
    for number, frequency in ((1, 1.0), (3, 9.0)):
        start = f"{{kind: mode, number: {number}, amplitude: 1 mm}}"
        result = simulate(
            loads(f"""\
gravity: 0
lines: {{deck: {{start: [0, 0], end: [20, 0], length: 20, mass: 1e4, axial_stiffness: 1e10, elements: 60,
                bending_stiffness: 1.6e10}}}}
run: {{kind: dynamic, geometry: linearised, until: 2 s, every: 1 ms, start: {start}}}
""")
        )
        deck = responses(result)[0]["deck"]
        w = frequency * np.pi**2 / 400.0 * np.sqrt(1.6e6)
        # The filter is one of instants 1 ms apart, whose frequencies go with the tangent of half a phase.
        left = 1.0 / (1.0 + (np.tan(0.5e-3 * w) / np.tan(np.pi * 30.0 * 1e-3)) ** 8)
        inside = slice(500, 1500)  # the filter begins and ends a little beside it
        z = result.position.sel(axis="z").values[:, 10 if number == 3 else 30]
        a = deck.acceleration[:, 10 if number == 3 else 30]
        # Velocities are half a step old: 0.4 % of a phase at 45 Hz.
        assert np.abs(a + left * w**2 * z)[inside].max() < 0.01 * left * w**2 * 1e-3, number


def test_too_long_an_interval_gives_no_accelerations_and_says_so() -> None:
    coarse = beam(MOVES.replace("4 ms", "10 ms"))
    assert "shorter run.every" in text(summary(coarse))
    with pytest.raises(ScenarioError, match="too far apart"):
        measured(coarse, ["max acceleration of deck"])
    assert measured(coarse, ["max deflection of deck"])["max deflection of deck"][0] > 0.0


def test_quantities_are_asked_for_in_words() -> None:
    result = beam(MOVES, outputs__impact="true")
    names = [
        "max acceleration of deck", "max deflection of quarter", "min moment of deck", "impact factor of deck",
        "impact factor of moment of quarter", "static deflection of deck", "max shear of deck",
    ]  # fmt: skip
    found = measured(result, names)
    lines = summary(result)["lines"]
    assert found["max acceleration of deck"] == (lines["deck"]["acceleration"]["largest"]["value"], "m/s^2")
    assert found["min moment of deck"] == (lines["deck"]["moment"]["min"], "N*m")
    # F l^3 / (48 EI), the largest of 50 positions along the deck; 20 links miss 0.4 %.
    assert found["static deflection of deck"][0] == pytest.approx(100e3 * 8000.0 / (48.0 * 1.6e10), rel=5e-3)
    phi, unit = found["impact factor of deck"]
    assert unit == "1"
    assert phi == pytest.approx(lines["deck"]["deflection"]["largest"]
                                ["value"] / found["static deflection of deck"][0])  # fmt: skip
    table = series_table(result)
    assert table["quarter.deflection [m]"].max() == pytest.approx(found["max deflection of quarter"][0])


def test_the_static_part_does_not_depend_on_the_speed() -> None:
    slow, fast = (
        summary(beam(MOVES, outputs__impact="true", loads__axle__travel__speed=speed))["lines"]["deck"]["moment"]
        for speed in ("30 m/s", "60 m/s")
    )
    assert slow["static"] == fast["static"] == pytest.approx(500e3, rel=0.02)
    assert slow["impact"] != fast["impact"]
