"""Walking people push to the side: given forces, balance on still ground and on a deck that sways, and the accounts."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import xarray as xr

from closed_forms import lateral_steps
from gait_cases import GAIT
from ropewalk.mechanics.footfall import Footfall
from ropewalk.mechanics.sideways import Sideways
from ropewalk.model import Dynamic, Footsteps, Line, Scenario
from ropewalk.simulate import simulate

GRAVITY = 9.81
# Hardly moves: the ground of test_walkers.py.
GROUND = {"start": (0, 0), "end": (10, 0), "tension": 1e9, "mass": 1000.0, "axial_stiffness": 1e12, "elements": 20}
# Sways to the side at 1 Hz.
DECK = {"start": (0, 0), "end": (20, 0), "tension": 160e3, "mass": 100.0, "axial_stiffness": 1e8, "elements": 40}
WALKER = {"kind": "walker", "speed": GAIT.speed, "from": 3.0, "balance": {"height": 1.17, "width": 0.0157}}
STEPPING = {"kind": "footsteps", "mass": 70.0, "frequency": 2.0, "step_length": 0.6, "from": 2.0, "lateral": "bachmann"}
HIM = {"margin": 0.0157, "leg_length": 1.17}
ALONG_X = Sideways.across(np.array([[1.0, 0.0]]), "end", "left")
RATE = float(np.sqrt(GRAVITY / 1.17))
STIFFNESS = 80.0 * RATE**2


def goes(line: dict[str, Any], load: dict[str, Any], until: float, every: float, **run: Any) -> xr.Dataset:
    scenario = Scenario(
        lines={"line": Line.model_validate(line)},
        loads={"her": {"on": "line", **load}},
        run=Dynamic(until=until, every=every, **run),
    )
    return simulate(scenario)


def across(result: xr.Dataset, name: str) -> np.ndarray:
    return np.asarray(np.nan_to_num(result[name].sel(axis="y").values))


def integral(t: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.concatenate(([0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(t))))


# Footsteps -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("model", "amplitudes"), [("bachmann", (0.1, 0.1)), ("setra", (0.05,))])
def test_both_feet_together_push_with_the_published_force(model: str, amplitudes: tuple[float, ...]) -> None:
    spring_leg_walker = Footsteps(on="line", mass=70.0, frequency=1.8, lateral=model, overlap=0.3)
    feet = [Footfall(spring_leg_walker, foot, GRAVITY, ALONG_X) for foot in (0, 1)]
    t = feet[0].instants(3.0)
    total = sum(foot(t)[:, 1] for foot in feet)
    exact = 70.0 * GRAVITY * sum(a * np.sin((2 * j + 1) * np.pi * 1.8 * t) for j, a in enumerate(amplitudes))
    assert total == pytest.approx(exact, abs=1e-9 * 70.0 * GRAVITY)
    alone = (t * 1.8 % 1.0 > 0.3 + 1e-9) & (t * 1.8 < 1.0 - 1e-9)
    assert feet[1](t[alone])[:, 1] == pytest.approx(0.0, abs=1e-9)  # its share is nothing while the other stands alone
    half = 70.0 * GRAVITY * np.array([-0.3, 0.4])
    listed = Footsteps.model_validate(
        {"on": "line", "mass": 70.0, "frequency": 1.8, "lateral": [{"amplitude": 0.5, "phase": np.arctan2(3.0, 4.0)}]}
    )
    both = sum(Footfall(listed, foot, GRAVITY, ALONG_X)(np.array([0.0, 0.5 / 1.8])) for foot in (0, 1))
    assert both[:, 1] == pytest.approx(half, rel=1e-12)


def test_the_force_to_the_side_has_odd_multiples_of_half_the_step_frequency_only() -> None:
    spring_leg_walker = Footsteps(on="line", mass=70.0, frequency=2.0, lateral="bachmann")
    t = 1.0 + np.arange(512) / 512.0  # two steps, after the first one
    total = sum(Footfall(spring_leg_walker, foot, GRAVITY, ALONG_X)(t)[:, 1] for foot in (0, 1))
    lines = 2.0 * np.abs(np.fft.rfft(total))[:16] / t.size / (70.0 * GRAVITY)
    expected = np.zeros(16)
    expected[[1, 3]] = 0.1
    assert lines == pytest.approx(expected, abs=1e-12)


def test_it_pushes_across_the_chord_and_level() -> None:
    def side(towards: str, foot: str, **ends: Any) -> np.ndarray:
        load = {"kind": "footsteps", "on": "line", "mass": 70.0, "towards": towards, "from": 5.0}
        scenario = {"lines": {"line": {**DECK, **ends}}, "loads": {"her": load}}
        known = Scenario.model_validate({**scenario, "run": {"kind": "dynamic", "until": 0.1}})
        return Sideways.of(known, known.loads["her"], foot).side[0]

    assert side("end", "left") == pytest.approx([0.0, 1.0])
    assert side("end", "right") == pytest.approx([0.0, -1.0])
    assert side("start", "left") == pytest.approx([0.0, -1.0])
    assert side("end", "left", start=(1, 2, 0), end=(4, 6, 12)) == pytest.approx([-0.8, 0.6])
    assert side("end", "left", start=(0, 0, 0), end=(0, 0, 12)) == pytest.approx([0.0, 1.0])


@pytest.fixture(scope="module")
def stepping() -> xr.Dataset:
    return goes(DECK, STEPPING, 3.0, 0.005)


def test_what_the_feet_push_moves_the_line_or_its_supports(stepping: xr.Dataset) -> None:
    t, force = stepping.time.values, across(stepping, "contact_force").sum(axis=1)
    exact = 70.0 * GRAVITY * 0.1 * (np.sin(2.0 * np.pi * t) + np.sin(6.0 * np.pi * t))
    assert force == pytest.approx(exact, abs=0.02)  # N: linear between 200 samples in a step
    momentum = DECK["mass"] * np.trapezoid(across(stepping, "velocity"), stepping.xi.values, axis=1)
    given = integral(t, force) + integral(t, across(stepping, "reaction").sum(axis=1))
    assert np.abs(momentum).max() > 20.0  # N s
    # A node that rides is shown at its own place, the trapezoids over 5 ms: 1 % of the momentum.
    assert momentum - momentum[0] == pytest.approx(given, abs=0.01 * np.abs(momentum).max())
    plane = goes(DECK, {**STEPPING, "lateral": None}, 3.0, 0.005)
    work, left = (
        stepping.energy.sel(form=form).values - plane.energy.sel(form=form).values
        for form in ("load_work", "imbalance")
    )
    assert np.abs(work).max() > 1.0  # J
    assert np.abs(left).max() < 0.01 * np.abs(work).max()  # the kinks over a link, second order in its length


def test_without_a_force_to_the_side_space_is_the_plane() -> None:
    plane = goes(DECK, {**STEPPING, "lateral": None}, 1.0, 0.1)
    space = goes(DECK, {**STEPPING, "lateral": [{"amplitude": 0.0}]}, 1.0, 0.1)
    assert plane.sizes["axis"] == 2
    assert not across(space, "position").any()
    # rounding: nothing but the order in which squares are added
    moved = space.position.sel(axis=["x", "z"]).values
    assert moved == pytest.approx(plane.position.values, abs=1e-11)


def test_who_comes_late_and_leaves_balances_in_between() -> None:
    load = {**STEPPING, "lateral": None, "balance": {}, "from": -0.9, "step_length": 7.0, "at_end": "leave"}
    result = goes(DECK, load, 2.4, 0.01)
    force, t = np.abs(across(result, "contact_force")).sum(axis=1), result.time.values
    on = np.isfinite(result.contact_xi.values).any(axis=1)
    assert t[on][0] == pytest.approx(0.5, abs=0.011)
    assert t[on][-1] == pytest.approx(1.5, abs=0.011)  # the fourth foot would stand at 20.1 m
    assert force[on][1:].min() > 5.0
    assert not force[~on].any()
    energy = result.energy.sel(form=["load_kinetic", "drive_work"]).values
    assert energy[~on & (t < 1.0)] == pytest.approx(0.0, abs=1e-12)
    assert energy[-1, 0] == 0.0  # who has left stands on firm ground
    assert np.abs(result.energy.sel(form="imbalance").values).max() < 0.01 * np.abs(energy[:, 1]).max()


@pytest.mark.parametrize("lateral", ["young", 0.1])
def test_an_unknown_model_is_refused(lateral: Any) -> None:
    with pytest.raises(ValueError, match="bachmann"):
        Footsteps(on="line", mass=70.0, lateral=lateral)


# Walkers -------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def on_ground() -> xr.Dataset:
    return goes(GROUND, WALKER, 4.0, 0.002)


def feet_of(result: xr.Dataset, deck: np.ndarray) -> tuple[np.ndarray, list[slice]]:
    """Offset of the foot that bears, read off the force, and the stretches of time in which it is the same."""
    body = across(result, "body_position")[:, 0]
    foot = body + across(result, "contact_force").sum(axis=1) / STIFFNESS - deck
    foot[0] = foot[1]  # no force has been found yet
    cuts = [0, *(np.flatnonzero(np.abs(np.diff(foot)) > 0.02) + 1).tolist(), foot.size]
    return foot, [slice(a, b) for a, b in pairwise(cuts)]


def test_on_still_ground_every_step_is_exact(on_ground: xr.Dataset) -> None:
    t = on_ground.time.values
    y, v = across(on_ground, "body_position")[:, 0], across(on_ground, "body_velocity")[:, 0]
    feet, steps = feet_of(on_ground, np.zeros_like(y))
    assert len(steps) > 6
    for number, step in enumerate(steps[:-1]):
        first = step.start
        since, u = t[first : step.stop] - t[first], feet[first]
        c, s = np.cosh(RATE * since), np.sinh(RATE * since)
        # The ground gives way by 1e-6 m, which falls with the body.
        assert y[first : step.stop] == pytest.approx(u + (y[first] - u) * c + v[first] / RATE * s, abs=1e-5)
        if number > 0:  # placed within the 2 ms of output before the first frame of the step
            side = (-1.0) ** number
            ahead = side * (feet[first] - y[first] - v[first] / RATE) / HIM["margin"]
            assert 1.0 - 1e-3 < ahead < np.exp(RATE * 0.0021)
    widths = np.abs(np.diff([feet[step.start] for step in steps]))
    exact = float(lateral_steps.step_width(step_time=GAIT.step_time, **HIM))
    # The gait comes back to itself after a disturbance of 2 % a step, and output of 2 ms does not matter here.
    assert widths[1:] == pytest.approx(exact, rel=3e-3)
    force = across(on_ground, "contact_force").sum(axis=1)
    peak = float(lateral_steps.peak_force(mass=80.0, step_time=GAIT.step_time, **HIM))
    assert np.abs(force[t > 1.5]).max() < 1.15 * peak  # what is left of the beginning has shifted the path


def test_nothing_is_left_over_of_the_force_on_still_ground(on_ground: xr.Dataset) -> None:
    _, steps = feet_of(on_ground, np.zeros(on_ground.sizes["time"]))
    begin, end = steps[-6].start, steps[-2].start
    t, force = on_ground.time.values[begin:end], across(on_ground, "contact_force").sum(axis=1)[begin:end]
    mean = np.trapezoid(force, t) / (t[-1] - t[0])
    assert np.abs(force).max() > 20.0
    assert abs(mean) < 0.5  # N: half a frame of the jumps of 50 N, and the beginning that decays


def test_the_line_gets_what_the_body_loses(on_ground: xr.Dataset) -> None:
    t, force = on_ground.time.values, across(on_ground, "contact_force").sum(axis=1)
    lost = 80.0 * across(on_ground, "body_velocity")[:, 0]
    given = integral(t, force)
    _, steps = feet_of(on_ground, np.zeros_like(t))
    for step in steps:  # within a step, where trapezoids are right to (2 ms)^2
        own = slice(step.start + 1, step.stop)
        assert lost[own][0] - lost[own] == pytest.approx(given[own] - given[own][0], abs=2e-4)


def test_the_plane_of_walking_knows_nothing_of_the_balance(on_ground: xr.Dataset) -> None:
    plane = goes(GROUND, {**WALKER, "balance": None}, 1.2, 0.002)
    assert plane.sizes["axis"] == 2
    body = on_ground.body_position.sel(axis=["x", "z"]).values[: plane.sizes["time"]]
    assert body == pytest.approx(plane.body_position.values, abs=1e-10)  # rounding, over three steps
    both = [run.energy.sel(form="imbalance").values[: plane.sizes["time"]] for run in (on_ground, plane)]
    assert both[0] == pytest.approx(both[1], abs=1e-5)  # J


def test_the_right_foot_first_is_the_mirror_image(on_ground: xr.Dataset) -> None:
    right = goes(GROUND, {**WALKER, "first_foot": "right"}, 1.2, 0.002)
    same = right.sizes["time"]
    for name in ("body_position", "contact_force"):
        mirrored = right[name].values * np.array([1.0, -1.0, 1.0])
        assert np.nan_to_num(mirrored) == pytest.approx(np.nan_to_num(on_ground[name].values[:same]), abs=1e-9)
    assert list(on_ground.coords["load"].values) == ["her.left", "her.right"]
    assert list(right.coords["load"].values) == ["her.right", "her.left"]
    assert across(on_ground, "body_position")[0, 0] > 0.0  # over the left foot, which stands on the left


def landings_of(result: xr.Dataset) -> np.ndarray:
    """When feet land on still ground, s: from how far the body has fallen away from where they were put."""
    y, v = across(result, "body_position")[:, 0], across(result, "body_velocity")[:, 0]
    feet, steps = feet_of(result, np.zeros_like(y))
    begin = np.array([step.start for step in steps[1:]])
    ahead = np.abs(feet - y - v / RATE)[begin] / HIM["margin"]
    return np.asarray(result.time.values[begin] - np.log(ahead) / RATE)


def test_on_a_deck_that_is_swayed_the_body_is_where_the_theory_has_it(on_ground: xr.Dataset) -> None:
    w, amplitude = 2.0 * np.pi, 0.02

    def deck(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return amplitude * np.sin(w * s) ** 3, 3.0 * amplitude * w * np.sin(w * s) ** 2 * np.cos(w * s)

    times = np.linspace(0.0, 2.2, 2201)
    places = [[0.0, place, 0.0] for place in deck(times)[0].tolist()]
    moved = {"kind": "moving", "displacement": {"time": times.tolist(), "value": places}}
    result = goes({**GROUND, "start_support": moved, "end_support": moved}, WALKER, 2.2, 0.002)
    t = result.time.values
    y, v = across(result, "body_position")[:, 0], across(result, "body_velocity")[:, 0]
    force = across(result, "contact_force").sum(axis=1)
    landings = landings_of(on_ground)
    i = int(np.searchsorted(t, landings[0]))
    back = t[i] - landings[0]  # less than 2 ms
    walk = lateral_steps.deck_walk(
        t[i:], deck, mass=80.0, landings=landings[landings < 2.2], side=-1, **HIM,
        position=y[i] - v[i] * back - 0.5 * force[i] / 80.0 * back**2, velocity=v[i] + force[i] / 80.0 * back,
    )  # fmt: skip
    assert walk.feet.size >= 5
    print(np.abs(y[i:] - walk.position).max(), np.ptp(y))
    # The middle of the line lags by y'' L^2/(8 c^2) = 3e-5 m and is 8e-4 m/s off at landings: over Omega, and 5 times
    # as much after a step.
    assert y[i:] == pytest.approx(walk.position, abs=1e-3)
    assert np.ptp(y) > 0.05


@pytest.fixture(scope="module")
def on_deck() -> xr.Dataset:
    return goes(DECK, {**WALKER, "from": 5.0}, 3.0, 0.005, start={"with_loads": True})


def test_body_line_and_supports_share_the_momentum(on_deck: xr.Dataset) -> None:
    t = on_deck.time.values
    line = DECK["mass"] * np.trapezoid(across(on_deck, "velocity"), on_deck.xi.values, axis=1)
    whole = line + 80.0 * across(on_deck, "body_velocity")[:, 0]
    given = integral(t, across(on_deck, "reaction").sum(axis=1))
    assert np.ptp(given) > 30.0  # N s
    # A node that rides is shown at its own place: 1 % of the momentum.
    assert whole - whole[0] == pytest.approx(given, abs=0.01 * np.ptp(given))


def test_the_energy_of_the_balance_is_accounted_for(on_deck: xr.Dataset) -> None:
    plane = goes(DECK, {**WALKER, "from": 5.0, "balance": None}, 3.0, 0.005, start={"with_loads": True})
    given = [run.energy.sel(form="drive_work").values for run in (on_deck, plane)]
    assert np.abs(given[0] - given[1]).max() > 0.2  # J: the work of feet that are put elsewhere
    left = [run.energy.sel(form="imbalance").values for run in (on_deck, plane)]
    # Feet that land stop the node below them, in the plane as well; to the side that is 1 % of the work at most.
    assert np.abs(left[0] - left[1]).max() < 0.01 * np.abs(given[0] - given[1]).max()


def test_who_steps_in_time_balances_as_the_theory_has_it() -> None:
    """Footsteps with balance on a deck that is swayed, beside the pendulum by quadrature, steps at given times."""
    w, amplitude, a, period = 2.0 * np.pi * 1.1, 0.02, RATE, 0.5

    def deck(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return amplitude * np.sin(w * s) ** 3, 3.0 * amplitude * w * np.sin(w * s) ** 2 * np.cos(w * s)

    times = np.linspace(0.0, 3.2, 3201)
    places = [[0.0, place, 0.0] for place in deck(times)[0].tolist()]
    moved = {"kind": "moving", "displacement": {"time": times.tolist(), "value": places}}
    load = {"kind": "footsteps", "mass": 80.0, "frequency": 1.0 / period, "from": 3.0, "balance": {}}
    # Feet are found to 1e-11 of a link, along it, too: with the EA of GROUND that is 1 N.
    ground = {**GROUND, "axial_stiffness": 1e11, "start_support": moved, "end_support": moved}
    result = goes(ground, load, 3.2, 0.002)
    force = across(result, "contact_force").sum(axis=1)
    t, nearest = result.time.values, HIM["margin"] * np.exp(0.5 * a * period)
    walk = lateral_steps.deck_walk(
        t, deck, mass=80.0, landings=period * np.arange(7), side=1, position=0.0,
        velocity=nearest * a * np.sinh(0.5 * a * period), **HIM,
    )  # fmt: skip
    within = np.abs(t / period - np.round(t / period)) > 0.01  # a jump of force belongs to the frame before or after
    print(np.abs(force - walk.force)[within].max(), np.ptp(walk.force))
    assert np.ptp(walk.force) > 150.0  # N; 41 N on still ground
    # The middle of the line lags, as above: 1e-3 m of the body, times m g/height.
    assert force[within] == pytest.approx(walk.force[within], abs=1e-3 * STIFFNESS)
    vertical = result.contact_force.sel(axis="z").fillna(0.0).values.sum(axis=1)
    plain = Footsteps(on="line", mass=80.0, frequency=1.0 / period)
    given = sum(Footfall(plain, foot, GRAVITY)(t)[:, -1] for foot in (0, 1))
    assert vertical == pytest.approx(given, abs=1.0)  # N of 785: linear between 200 samples in a step
    assert np.abs(result.energy.sel(form="imbalance").values).max() < 1.0  # J


@pytest.mark.parametrize("angle", [30.0, 90.0, 200.0])
@pytest.mark.parametrize(
    "load",
    [{**WALKER, "from": 5.0}, STEPPING, {**STEPPING, "lateral": None, "balance": {}}],
    ids=["walker", "footsteps", "balance"],
)
def test_a_turned_scenario_gives_the_turned_answer(load: dict[str, Any], angle: float) -> None:
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turned = {**DECK, "end": (20.0 * c, 20.0 * s, 0.0)}
    here, there = (goes(line, load, 1.5, 0.1).position.values for line in (DECK, turned))
    rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    assert there == pytest.approx(here @ rotation.T, abs=1e-8)


def test_nobody_balances_on_a_light_rope() -> None:
    rope = {"start": (0, 0), "end": (40, 0), "tension": 1500.0, "mass": 0.07, "axial_stiffness": 55e3, "drag": 20.0}
    result = goes(rope, {**WALKER, "from": 8.0}, 3.0, 0.05, start={"with_loads": True})
    assert result.attrs["outcome"] == "load failed"
    assert "fallen" in result.attrs["advice"]
    assert np.isfinite(result.position.values).all()
