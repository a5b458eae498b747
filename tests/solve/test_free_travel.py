"""Masses that travel freely: on the ellipse, with friction, drives, drivers and brakes, and at the end of the line.

Each of them on ropes, and in still air, which the engine of the system computes.

Exact values: `ropewalk.theory.bead` (a bead on a weightless inextensible rope) and the motion on an inclined plane,
which a very taut line is.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp

from closed_forms import beads
from ropewalk.model import Dynamic, FreeTravel, Guided, Line, MovingMass, Scenario, Start
from ropewalk.model.wind import Wind
from ropewalk.simulate import simulate
from ropewalk.theory import bead

SPAN, LENGTH, MASS, G = 20.0, 22.0, 10.0, 9.81
RISE, RUN = 5.0, 20.0
SINE, COSINE = RISE / np.hypot(RISE, RUN), RUN / np.hypot(RISE, RUN)
STILL_AIR = Wind.model_validate({"speed": 0.0, "direction": [1, 0]})


def in_still_air(scenario: Scenario) -> xr.Dataset:
    return simulate(scenario.model_copy(update={"wind": STILL_AIR}))


run = simulate


@pytest.fixture(params=["ropes", "system"], autouse=True)
def engine(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let everything be computed by one engine."""
    if request.param == "system":
        monkeypatch.setitem(globals(), "run", in_still_air)


def form(result: xr.Dataset, name: str) -> np.ndarray:
    return np.asarray(result.energy.sel(form=name).values)


def slide(start: float, until: float, *, elements: int = 25, **travel: Any) -> xr.Dataset:
    """A bead of 10 kg on a rope of 20 g that stretches by 0.1 mm per m; its length is that of the loaded one."""
    stiffness = 1e6
    length = LENGTH / (1.0 + 105.0 / stiffness)  # the tension is 105 N, give or take 15
    place = (LENGTH**2 - SPAN**2 + 2.0 * SPAN * start) / (2.0 * LENGTH) * length / LENGTH
    line = Line(
        start=(0, 0), end=(SPAN, 0), length=length, mass=1e-3, axial_stiffness=stiffness, elements=elements,
        law={"kind": "tension_only"},
    )  # fmt: skip
    load = MovingMass(on="rope", mass=MASS, travel=FreeTravel.model_validate({"from": place, **travel}))
    motion = Dynamic(until=until, every=0.05, start=Start(with_loads=True))
    return run(Scenario(lines={"rope": line}, loads={"bead": load}, run=motion))


def incline(
    until: float = 2.0, start: float = 1.0, air_drag: float = 0.0, elements: int = 20, **travel: Any
) -> xr.Dataset:
    """A line so taut that it is an inclined plane: down 5 m in 20 m, 10 kg on 200 kN."""
    line = Line(start=(0, RISE), end=(RUN, 0), tension=2e5, mass=0.2, axial_stiffness=4e7, elements=elements)
    load = MovingMass(
        on="line", mass=MASS, air_drag=air_drag, travel=FreeTravel.model_validate({"from": start, **travel})
    )
    motion = Dynamic(until=until, every=0.05, start=Start(with_loads=True))
    return run(Scenario(lines={"line": line}, loads={"load": load}, run=motion))


def way(result: xr.Dataset) -> np.ndarray:
    place = result.contact_position.values[:, 0]
    return np.hypot(place[:, 0] - place[0, 0], place[:, 1] - place[0, 1])


def test_a_bead_without_friction_swings_on_its_ellipse() -> None:
    result = slide(5.0, 10.0)
    exact = beads.swing(result.time.values, start=5.0, mass=MASS, span=SPAN, length=LENGTH)
    # The mass of the rope is 0.2 % of the bead's, its stretch varies by 0.3 mm.
    assert np.abs(result.contact_position.values[:, 0, 0] - exact.x).max() < 0.03
    assert np.abs(result.contact_position.values[:, 0, 1] - exact.z).max() < 0.01
    # 196 J are turned over in each half of a swing; 25 nodes are passed, and passed again.
    assert np.abs(form(result, "imbalance")).max() < 0.2


@pytest.mark.parametrize(("model", "coefficient"), [("capstan", 0.1), ("block", 0.1), ("capstan", 0.02)])
def test_a_bead_with_friction_stops_where_and_when_it_should(model: str, coefficient: float) -> None:
    result = slide(5.0, 5.5, friction=coefficient, friction_model=model)
    times = result.time.values
    exact = bead.slide(times, start=5.0, mass=MASS, friction=model, coefficient=coefficient, span=SPAN, length=LENGTH)
    x, speed = result.contact_position.values[:, 0, 0], result.contact_speed.values[:, 0]
    # The rope is of 0.2 % of the mass; with half the friction the bead would be 2 m off.
    assert np.abs(x - exact.x).max() < 0.03
    last = int(np.searchsorted(times, exact.stop_times[0]))
    assert x[last - 1 : last + 1].mean() == pytest.approx(exact.stop_places[0], abs=0.03)
    if exact.rests:
        assert np.abs(speed[last + 1 :]).max() == 0.0
        assert (result.contact_state.values[last + 1 :, 0] == 2.0).all()
        assert x[-1] == pytest.approx(exact.stop_places[0], abs=0.03)
    lost = MASS * G * (result.contact_position.values[0, 0, 1] - result.contact_position.values[-1, 0, 1])
    assert form(result, "friction")[-1] == pytest.approx(lost, rel=0.02 if exact.rests else 0.2)
    assert np.abs(form(result, "imbalance")).max() < 0.02


CASES: dict[str, tuple[dict[str, Any], Callable[[float], float]]] = {
    "nothing": ({}, lambda v: 0.0),
    "drive": ({"drive": -15.0}, lambda v: -1.5),
    "viscous": ({"viscous": 8.0}, lambda v: -0.8 * v),
    "rolling": ({"rolling": 0.1}, lambda v: -0.1 * G * COSINE),
    "capstan": ({"friction": 0.1}, lambda v: -0.1 * G * COSINE),
    "air": ({"air_drag": 1.0}, lambda v: -0.1 * v * v),
    "all": (
        {"drive": 5.0, "viscous": 2.0, "rolling": 0.02, "friction": 0.03, "friction_model": "block", "air_drag": 0.2},
        lambda v: 0.5 - 0.2 * v - 0.05 * G * COSINE - 0.02 * v * v,
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_on_a_very_taut_line_it_moves_as_on_an_inclined_plane(case: str) -> None:
    given, slowing = CASES[case]
    result = incline(**given)
    plane = solve_ivp(
        lambda t, y: [y[1], G * SINE + slowing(y[1])], (0.0, 2.0), [0.0, 0.0], t_eval=result.time.values, rtol=1e-9
    )
    # It sags by half a millimetre to 2.5 mm, a slope of 5e-4, and carries a node of 0.2 kg about with it.
    assert np.abs(way(result) - plane.y[0]).max() < 0.025
    assert np.abs(result.contact_speed.values[:, 0] - plane.y[1]).max() < 0.02
    assert np.abs(form(result, "imbalance")).max() < 0.3


def test_in_air_it_comes_to_its_terminal_speed() -> None:
    result = incline(until=3.0, air_drag=10.0)
    terminal = np.sqrt(MASS * G * SINE / 10.0)
    assert result.contact_speed.values[-1, 0] == pytest.approx(terminal, rel=5e-3)


def test_rolling_and_friction_add_up_to_what_holds_it() -> None:
    needed = SINE / COSINE  # 0.25
    restrained = incline(rolling=0.15, friction=0.11, until=1.0)
    slips = incline(rolling=0.12, friction=0.12, until=1.0)
    assert needed == pytest.approx(0.25)
    assert np.abs(np.diff(restrained.contact_xi.values[5:, 0])).max() < 1e-3
    assert np.diff(slips.contact_xi.values[-2:, 0])[0] > 1e-3


def test_a_driver_holds_its_speed_up_and_down() -> None:
    down = incline(driver={"speed": 2.0, "force": 300.0})
    assert np.abs(down.contact_speed.values[2:, 0] - 2.0).max() < 2e-3
    # It brakes: what gravity gives less what the load moves with.
    fallen = MASS * G * (down.contact_position.values[0, 0, 1] - down.contact_position.values[-1, 0, 1])
    assert form(down, "drive_work")[-1] == pytest.approx(0.5 * MASS * 4.0 - fallen, abs=0.5)
    up = incline(start=15.0, speed=-2.0, driver={"speed": -2.0, "force": 300.0})
    assert np.abs(up.contact_speed.values[2:, 0] + 2.0).max() < 2e-3


def test_a_driver_who_is_too_weak_gives_all_that_he_can() -> None:
    result = incline(start=12.0, speed=-2.0, driver={"speed": -2.0, "force": 15.0})
    expected = -2.0 + (G * SINE - 1.5) * result.time.values
    assert np.abs(result.contact_speed.values[1:, 0] - expected[1:]).max() < 0.03


def test_a_brake_stops_it_before_the_end() -> None:
    result = incline(until=4.0, start=4.0, brake={"force": 60.0, "within": 10.0})
    speed, xi = result.contact_speed.values[:, 0], result.contact_xi.values[:, 0]
    length = float(result.xi.values[-1])
    before = length - 10.0 - 4.0
    # v^2 = 2 a s on both sides of the place where it begins to brake.
    expected = length - 10.0 + before * SINE * G / (6.0 - SINE * G)
    assert xi[-1] == pytest.approx(expected, rel=5e-3)
    assert speed[-1] == 0.0
    assert result.contact_state.values[-1, 0] == 2.0
    assert form(result, "friction")[-1] == pytest.approx(60.0 * (xi[-1] - (length - 10.0)), rel=5e-3)


@pytest.mark.parametrize(("drive", "viscous"), [(0.0, 0.0), (20.0, 0.0), (0.0, 5.0)])
def test_on_a_line_that_nothing_holds_along_x_momentum_is_kept(drive: float, viscous: float) -> None:
    """Both ends slide on rails along x, pulled apart by equal forces; what acts between mass and line is their own."""
    n, length = 20, 20.0
    ends = {
        "start_support": Guided(along=(1, 0), force=-1000.0),
        "end_support": Guided(along=(1, 0), force=1000.0),
    }
    line = Line(start=(0, 0), end=(20.2, 0), length=length, mass=1.0, axial_stiffness=1e5, elements=n, **ends)
    travel = FreeTravel.model_validate({"from": 3.0, "speed": 4.0, "drive": drive, "viscous": viscous})
    load = MovingMass(on="line", mass=10.0, travel=travel)
    motion = Dynamic(until=1.5, every=0.05)
    result = run(Scenario(gravity=0.0, lines={"line": line}, loads={"mass": load}, run=motion))
    w, h = result.velocity.values[:, :, 0], length / n
    momentum = h * w[:, 1:-1].sum(axis=1) + 0.5 * h * (w[:, 0] + w[:, -1])
    momentum += 10.0 * np.sqrt(2.0 * form(result, "load_kinetic") / 10.0)  # it moves along x only
    assert np.ptp(momentum) < 1e-11 * momentum[0]
    assert abs(form(result, "load_kinetic")[-1] - 80.0) > 10.0 or drive == viscous == 0.0
    assert np.abs(form(result, "imbalance")).max() < 6.0  # of 300 J: the drive shakes the line, which nothing damps


def test_at_the_end_it_is_stopped_or_refused_or_leaves() -> None:
    stayed, refused, left = (incline(until=4.0, start=10.0, at_end=end) for end in ("stay", "refuse", "leave"))
    length, margin = float(stayed.xi.values[-1]), 0.25 * float(stayed.xi.values[1])
    assert np.nanmax(stayed.contact_xi.values) <= length - margin + 1e-9
    assert np.nanmax(stayed.contact_xi.values) == pytest.approx(length - margin, rel=1e-2)
    assert refused.attrs["outcome"] == "travel ended"
    assert "at_end" in refused.attrs["advice"]
    assert refused.contact_xi.values[-1, 0] == pytest.approx(length - margin, rel=1e-9)
    assert left.attrs["outcome"] == "completed"
    assert left.contact_state.values[-1, 0] == 0.0
    assert np.isnan(left.contact_xi.values[-1, 0])
    gone = int(np.flatnonzero(left.contact_state.values[:, 0] == 0.0)[0])
    # From there on it takes its horizontal energy along, and the line swings by itself.
    assert np.ptp(form(left, "load_kinetic")[gone:]) == 0.0


def test_from_rest_at_the_support_it_sets_off() -> None:
    result = incline(start=0.0, until=1.0)
    assert way(result)[-1] == pytest.approx(0.5 * G * SINE, rel=0.02)


def test_without_anything_that_pulls_it_stays() -> None:
    line = Line(start=(0, 0), end=(20, 0), tension=1e4, mass=0.5, axial_stiffness=1e6, elements=20)
    load = MovingMass(on="line", mass=MASS, travel=FreeTravel.model_validate({"from": 10.0}))
    tension = Dynamic(until=1.0, every=0.05, start=Start(with_loads=True))
    result = run(Scenario(lines={"line": line}, loads={"m": load}, run=tension))
    mid = 0.5 * float(result.xi.values[-1])
    start = abs(float(result.contact_xi.values[0, 0]) - mid)
    assert start < 0.1
    assert np.abs(result.contact_xi.values[:, 0] - mid).max() < 2.0 * start + 1e-6
