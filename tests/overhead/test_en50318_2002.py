"""The reference model of EN 50318:2002 against its acceptance ranges, and what would put it outside.

Ranges and answers come from public secondary sources and independent calculations, as collected in the notes on
overhead lines; the standard itself is not open. Spans 5 and 6 are evaluated, the force filtered at 20 Hz by a
Butterworth filter of fourth order, forwards and backwards.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

import hermite
from core_overhead import RANGES
from ropewalk.model.pantograph import Pantograph
from ropewalk.overhead.pantograph_loads import moving_load_of, push_of
from ropewalk.overhead.section import section_of
from ropewalk.scenario import load
from ropewalk.simulate import simulate

Array = NDArray[np.float64]

EXAMPLES = Path(__file__).parents[2] / "examples"
FIRST, LAST = 240.0, 360.0  # m, spans 5 and 6
AT_THEIR_SUPPORTS = slice(3, 6)
HALF = ("overhead_lines.line.element=0.5 m",)
FINE = ("overhead_lines.line.element=0.125 m", "run.step=0.5 ms", "run.sample=0.5 ms")
LARGE = (*HALF, "run.geometry=nonlinear", "run.axial_inertia=1")
PUSHING = ("overhead_lines.line.droppers.pushes=100 kN/m",)
STIFF = (
    "overhead_lines.line.contact_wire.bending_stiffness=195 N*m^2",
    "overhead_lines.line.messenger_wire.bending_stiffness=131.7 N*m^2",
)


@dataclass(frozen=True)
class Passage:
    """What one run gives: stations and forces in spans 5 and 6, and the quantities of the table."""

    station: Array
    raw: Array
    filtered: Array
    eight: dict[str, float]

    def outside(self, speed: int) -> list[str]:
        found = {key: (self.eight[key], both[speed]) for key, both in RANGES.items()}
        return [f"{key} {x:.4g} not in {a}..{b}" for key, (x, (a, b)) in found.items() if not a <= x <= b]


def evaluated(station: Array, force: Array, uplift: Array, dt: float) -> Passage:
    smooth = sosfiltfilt(butter(4, 20.0, fs=1.0 / dt, output="sos"), force)
    inside = (station >= FIRST) & (station <= LAST)
    F, raw = smooth[inside], force[inside]
    mean, sigma = F.mean(), F.std()
    values = (
        mean, sigma, mean + 3.0 * sigma, mean - 3.0 * sigma, F.max(), F.min(),
        1e3 * np.nanmax(uplift[:, AT_THEIR_SUPPORTS]), 100.0 * (raw == 0.0).mean(),
    )  # fmt: skip
    return Passage(station[inside], raw, F, dict(zip(RANGES, map(float, values), strict=True)))


@cache
def passage(speed: int, settings: tuple[str, ...] = ()) -> Passage:
    result = simulate(load(EXAMPLES / f"en50318-2002-{speed}.yaml", settings))
    assert result.attrs["outcome"] == "completed", result.attrs["advice"]
    force, station = result.sampled_force.values.ravel(), result.sampled_station.values.ravel()
    uplift = result.sampled_uplift.values.reshape(force.size, -1)
    known = np.isfinite(station)
    return evaluated(station[known], force[known], uplift, float(np.diff(result.sample)[0]))


@pytest.mark.parametrize("settings", [(), HALF, FINE, LARGE], ids=["as it is", "0.5 m", "0.125 m, 0.5 ms", "nonlinear"])
@pytest.mark.parametrize("speed", [250, 300])
def test_all_quantities_are_inside_their_ranges(speed: int, settings: tuple[str, ...]) -> None:
    found = passage(speed, settings)
    assert found.outside(speed) == []
    # The unfiltered force: a run that swings at the contact may well pass the ranges of the filtered one. It is that of
    # the independent calculation within 2 N; nonlinear, at 0.5 m, within 3 N.
    sigma = {250: 32.8, 300: 41.6}[speed]
    assert found.raw.std() == pytest.approx(sigma, abs=3.0 if settings == LARGE else 2.0)
    assert found.raw.min() > 10.0
    assert found.raw.max() < 280.0


@pytest.mark.parametrize("speed", [250, 300])
def test_half_the_mesh_and_half_the_step_hardly_change_them(speed: int) -> None:
    coarse, fine = passage(speed).eight, passage(speed, FINE).eight
    assert coarse["sigma"] == pytest.approx(fine["sigma"], abs=0.5)
    # Converged answers, on which two formulations agree, with what is left to 0.125 m and to their last digits.
    known = {250: (116.0, 28.2, 190.0, 54.0, 52.9), 300: (115.3, 33.3, 203.0, 42.0, 60.2)}[speed]
    found = [fine[key] for key in ("mean", "sigma", "maximum", "minimum", "uplift")]
    for value, answer, apart in zip(found, known, (0.1, 0.2, 1.5, 1.5, 0.2), strict=True):
        assert value == pytest.approx(answer, abs=apart)


@pytest.mark.parametrize("speed", [250, 300])
def test_small_and_large_motion_differ_little(speed: int) -> None:
    """One key apart: geometry."""
    small, large = passage(speed, HALF), passage(speed, LARGE)
    apart = {key: large.eight[key] - small.eight[key] for key in RANGES}
    said = ", ".join(f"{key} {value:+.2f}" for key, value in apart.items())
    print(f"{speed} km/h, nonlinear less linearised: {said}")
    # Measured at 250/300 km/h: 0.0/0.0, +0.7/-0.1, +5.2/-0.3 and +1.7/+0.5 N, and -0.1/-0.3 mm.
    most = {"mean": 0.3, "sigma": 1.0, "maximum": 7.0, "minimum": 3.0, "uplift": 0.6}
    assert all(abs(apart[key]) < most[key] for key in most), said
    # But they are two: the messenger moves along the line, droppers lean, tensions change.
    assert np.abs(np.interp(small.station, large.station, large.filtered) - small.filtered).max() > 1.0, said


@pytest.mark.parametrize("speed", [250, 300])
def test_droppers_that_push_are_found_out(speed: int) -> None:
    """The table tells: the fault of droppers that cannot slacken."""
    found = passage(speed, PUSHING)
    assert 39.0 < found.eight["sigma"] < 55.0
    assert len(found.outside(speed)) >= 4


@pytest.mark.parametrize("speed", [250, 300])
def test_the_unfiltered_force_is_outside(speed: int) -> None:
    assert passage(speed).raw.std() > RANGES["sigma"][speed][1]


@pytest.mark.parametrize(("speed", "known"), [(250, (28.0, 186.0, 46.0, 52.3)), (300, (32.3, 210.0, 38.0, 60.0))])
def test_with_bending_stiffness_the_answers_stay_what_they_were(speed: int, known: tuple[float, ...]) -> None:
    """Regression: the converged answers with EI = 195 and 131.7 N m^2; at 250 km/h they miss the smallest force."""
    found = passage(speed, STIFF)
    got = [found.eight[key] for key in ("sigma", "maximum", "minimum", "uplift")]
    # At 0.25 m, as without stiffness: 0.4 N of sigma, 2 N of the extremes; the known ones are given in whole N.
    for value, answer, apart in zip(got, known, (0.5, 2.5, 2.0, 0.3), strict=True):
        assert value == pytest.approx(answer, abs=apart)
    assert [said.split()[0] for said in found.outside(speed)] == (["minimum"] if speed == 250 else [])


def by_hermite_elements(element: float, dt: float, settings: tuple[str, ...] = ()) -> Passage:
    """The same plan and pantograph at 250 km/h, by the other formulation and its implicit steps."""
    scenario = load(EXAMPLES / "en50318-2002-250.yaml", settings)
    section = section_of("line", scenario.overhead_lines["line"], scenario.gravity)
    declared = scenario.loads["pantograph"]
    assert isinstance(declared, Pantograph)
    t = np.arange(round(8.35 / dt)) * dt
    speed = np.full(t.size, 250.0 / 3.6)
    station, none = (10.0 + speed * t)[:, np.newaxis], np.zeros((t.size, 1))
    push = push_of(declared, section.level)(t, speed)[:, np.newaxis]
    moving_load, model = moving_load_of("pantograph", declared), hermite.rest_of(section.plan, element)
    record = hermite.run(model, [moving_load], hermite.StepInputs(station, none, none, push), dt)
    return evaluated(station[:, 0], record.contact_force[:, 0], record.watched, dt)


@pytest.mark.parametrize(
    ("element", "dt", "settings", "likeness", "most"),
    # Implicit steps of 1 ms turn the fast part of the force a little: halving them and the elements changes Hermite's
    # force by 3.4 N rms, that of the splines by 2.3 N rms, and brings both together.
    [(0.5, 1e-3, (), 0.98, 5.0), (0.125, 5e-4, FINE, 0.997, 2.2)],
)
def test_hermite_elements_give_the_same_force(
    element: float, dt: float, settings: tuple[str, ...], likeness: float, most: float
) -> None:
    other, here = by_hermite_elements(element, dt, settings), passage(250, settings)
    assert other.outside(250) == []
    assert here.eight["sigma"] == pytest.approx(other.eight["sigma"], abs=0.5)
    assert here.eight["mean"] == pytest.approx(other.eight["mean"], abs=0.3)
    assert here.eight["uplift"] == pytest.approx(other.eight["uplift"], abs=0.3)
    then = np.interp(other.station, here.station, here.filtered)
    apart = float(np.sqrt(np.mean((then - other.filtered) ** 2)))
    print(f"correlation {np.corrcoef(then, other.filtered)[0, 1]:.5f}, {apart:.3g} N rms apart")
    assert np.corrcoef(then, other.filtered)[0, 1] > likeness
    assert apart < most


@pytest.mark.parametrize("restrained", [False, True])
def test_a_line_that_nothing_touches_stays_where_it_is(restrained: bool) -> None:
    """Fifteen inner steps for axial waves in each step of droppers, which push once in each: not to be felt at rest."""
    more = (
        ["overhead_lines.line.messenger_supports={along: held}", "overhead_lines.line.ends=anchored"]
        if restrained
        else []
    )
    scenario = load(EXAMPLES / "en50318-2002-250.yaml", ["run.geometry=nonlinear", "run.until=0.5 s", *more])
    still = simulate(scenario.model_copy(update={"loads": {}}))
    # Rounding of positions of 600 m, pulled on by 17 MN: 1e-11 J.
    assert float(still["energy"].sel(form=still["form"] == "kinetic").max()) < 1e-9
