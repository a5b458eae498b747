"""A mass that travels as prescribed: taut strings, waves that it outruns, the self-similar contact, mirrors.

Sources of the exact values: `ropewalk.theory.string.moving_mass` (docs/notes/moving-mass-on-a-string.md) and
`ropewalk.theory.selfsimilar` (docs/notes/travelling-node.md).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from motion_cases import order
from ropewalk.mechanics import multibody_system
from ropewalk.model import Dynamic, Line, MovingForce, MovingMass, Scenario, SpeedTable, Travel
from ropewalk.simulate import simulate
from ropewalk.solve import initial_loads
from ropewalk.theory import selfsimilar, string

WEIGHT = 1e-5  # N per kg, so small beside the tension of 1 N that the motion is linear
STIFFNESS = 1e4  # N
STRETCH = 1.0 + 1.0 / STIFFNESS
LENGTH = 1.0 / STRETCH  # m, unstrained; in the material coordinate the string has this length and the tension 1/STRETCH
WAVE = np.sqrt(1.0 / STRETCH)  # m/s, material speed of a transverse wave, for 1 kg/m


def passage(
    elements: int, mass: float, alpha: float, part: float, *, outputs: int = 200, line_mass: float = 1.0
) -> xr.Dataset:
    """A mass passes `part` of a string of 1 N, 1 m and EA = 10 kN at alpha times the wave speed; only it has weight."""
    speed = alpha * WAVE / np.sqrt(line_mass)
    until = part * LENGTH / speed
    scenario = Scenario(
        gravity=0.0,
        lines={
            "string": Line(
                start=(0, 0), end=(1, 0), length=LENGTH, mass=line_mass, axial_stiffness=STIFFNESS, elements=elements
            )
        },
        loads={
            "mass": MovingMass(
                on="string", mass=mass, force=(0.0, -WEIGHT * mass), travel=Travel(speed=speed, at_end="leave")
            )
        },
        run=Dynamic(until=until, every=until / outputs),
    )
    return simulate(scenario)


def misses(result: xr.Dataset, mass: float, alpha: float) -> tuple[np.ndarray, np.ndarray]:
    """Errors of deflection (in m g L/P) and contact force (in m g) against the string with mass."""
    exact = string.moving_mass(
        result.time.values, load_mass=mass, speed=alpha * WAVE, length=LENGTH, tension=1.0 / STRETCH, mass=1.0,
        gravity=WEIGHT,
    )  # fmt: skip
    deflection = -result.contact_position.values[:, 0, 1] - exact.deflection
    force = -result.contact_force.values[:, 0, 1] - exact.contact_force
    return deflection / (mass * WEIGHT), force[1:] / (mass * WEIGHT)


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


@pytest.mark.parametrize("alpha", [0.2, 0.5, 0.8])
def test_deflection_on_a_string_with_mass_is_of_second_order(alpha: float, monkeypatch: pytest.MonkeyPatch) -> None:
    # A support bears its load over a part of the first link, which is of first order: here as good as not at all.
    monkeypatch.setattr(initial_loads, "STEPS_OF_CAPACITY", 0.0)
    monkeypatch.setattr(multibody_system, "LEAST_CAPACITY", 1e-3)
    links, found = [50, 100, 200], []
    for n in links:
        deflection, _ = misses(passage(n, LENGTH, alpha, 0.9), LENGTH, alpha)
        found.append(float(np.abs(deflection).max()))
    assert 1.5 < order([1.0 / n for n in links], found) < 2.3
    assert found[-1] < 1e-4


@pytest.mark.parametrize(("ratio", "tolerance"), [(1.0, 1e-4), (4.0, 4e-5)])
def test_deflection_is_right_with_the_first_part_of_a_link_borne_by_the_support(ratio: float, tolerance: float) -> None:
    deflection, _ = misses(passage(100, ratio * LENGTH, 0.5, 0.9), ratio * LENGTH, 0.5)
    # Measured 9.0e-5 and 2.6e-5; with four times the part of the link, 1.1e-4 and 8.7e-5.
    assert np.abs(deflection).max() < tolerance


@pytest.mark.parametrize(("alpha", "tolerance"), [(0.5, 0.01), (0.8, 0.04)])
def test_contact_force_hardly_shows_the_nodes(alpha: float, tolerance: float) -> None:
    """Until the first wave comes back, 100 links; what is left is 0.006 m g at 0.5, 0.027 m g at 0.8."""
    until = 0.9 * 2.0 * alpha / (1.0 + alpha)
    _, force = misses(passage(100, LENGTH, alpha, until, outputs=500), LENGTH, alpha)
    assert rms(force[100:]) < tolerance


def test_contact_force_after_the_reflection_converges() -> None:
    links = [50, 100, 200, 400]
    found = [rms(misses(passage(n, LENGTH, 0.5, 0.9), LENGTH, 0.5)[1]) for n in links]
    # Wave fronts disperse on a chain: between first and half order.
    assert 0.4 < order([1.0 / n for n in links], found) < 1.2
    assert found[-1] < 0.05


@pytest.mark.parametrize("quotient", [1.0, 3.0, 8.0, 50.0])
def test_trajectory_on_a_massless_string(quotient: float) -> None:
    """PL/(m V^2) = quotient; a string of 1e-3 of the mass of the load."""
    mass, line_mass = 1.0, 1e-3
    alpha = np.sqrt(line_mass / (mass * quotient) * LENGTH)
    result = passage(25, mass, alpha, 0.9, line_mass=line_mass, outputs=90)
    exact = string.moving_mass(
        result.time.values, load_mass=mass, speed=alpha * WAVE / np.sqrt(line_mass), length=LENGTH,
        tension=1.0 / STRETCH, mass=0.0, gravity=WEIGHT,
    )  # fmt: skip
    deflection = -result.contact_position.values[:, 0, 1] - exact.deflection
    force = (-result.contact_force.values[:, 0, 1] - exact.contact_force) / (mass * WEIGHT)
    # It leaves the support late by up to a hundredth of a link, times the slope of 1: 4e-4; and 1e-3 of inertia.
    assert np.abs(deflection).max() < 1e-3 * mass * WEIGHT
    assert np.abs(force[2:]).max() < 1e-2


@pytest.mark.parametrize("alpha", [1.3, 2.0])
def test_a_mass_that_outruns_the_waves_rides_at_rest_with_its_weight(alpha: float) -> None:
    for mass in (0.3, 3.0):
        deflection, force = misses(passage(100, mass, alpha, 0.95), mass, alpha)
        # Two links from the support the jump of the start has been passed on.
        assert np.abs(force[20:]).max() < 0.12
        assert rms(force[100:]) < 0.03
        assert np.abs(deflection).max() < 2e-3


def test_a_mass_of_nearly_nothing_does_what_its_force_does() -> None:
    mass, alpha, n = 1e-4, 0.5, 50
    light = passage(n, mass, alpha, 0.8)
    assert light.attrs["method"] == "verlet"
    line = Line(start=(0, 0), end=(1, 0), length=LENGTH, mass=1.0, axial_stiffness=STIFFNESS, elements=n)
    force = MovingForce(on="string", force=(0.0, -WEIGHT * mass), travel=Travel(speed=alpha * WAVE, at_end="leave"))
    run = Dynamic(until=float(light.time[-1]), every=float(light.time[1]), method="verlet")
    forced = simulate(Scenario(gravity=0.0, lines={"string": line}, loads={"force": force}, run=run))
    largest = np.abs(forced.position.values[:, :, 1]).max()
    # The inertia of 5e-3 of a link, and steps of another length.
    np.testing.assert_allclose(light.position.values, forced.position.values, atol=1e-2 * largest, rtol=0.0)


def test_light_and_heavy_wheels_agree_where_one_becomes_the_other() -> None:
    """From one link's mass on a wheel has its own place; the difference of both ways falls with the mesh."""
    links, changes = [25, 50, 100], []
    for n in links:
        node = LENGTH / n
        below, above = (passage(n, part * node, 0.5, 0.8) for part in (1.0 - 1e-6, 1.0 + 1e-6))
        change = (below.position.values - above.position.values)[:, :, 1] / (node * WEIGHT)
        changes.append(float(np.abs(change).max()))
    # Each way is off by first order here, as a moving force is.
    assert 0.6 < order([1.0 / n for n in links], changes) < 1.6
    assert changes[1] < 1e-2


@pytest.mark.parametrize("part", [0.17, 0.25, 0.33])
def test_result_does_not_depend_on_when_a_node_is_carried(monkeypatch: pytest.MonkeyPatch, part: float) -> None:
    """The start is moved instead of D0, which is compiled in: where the nodes lie must not matter."""
    mass, alpha, n = LENGTH, 0.5, 100
    whole = passage(n, mass, alpha, 0.6).contact_position.values[:, 0, 1]
    moved = passage(n + round(10 * part), mass, alpha, 0.6).contact_position.values[:, 0, 1]
    assert np.abs(whole - moved).max() < 1e-4 * mass * WEIGHT


def self_similar(
    elements: int, contact: str, measured: str, speed: float, mass: float
) -> tuple[np.ndarray, float, float]:
    """Mean velocity of a mass under 0.01 N on the string of motion_cases.long_string, hold force, power of the hold."""
    h, begin, end = 2.0 / elements, 0.4, 0.95
    begin, end = (round(t * 0.1 / h) * h / 0.1 for t in (begin, end))
    start = 1.0 if measured == "material" else 1.05
    travel = Travel.model_validate({"speed": speed, "from": start, "measured": measured})
    line = Line(start=(0, 0), end=(2.1, 0), length=2.0, mass=1.0, axial_stiffness=1.0, elements=elements)
    load = MovingMass(on="string", mass=mass, force=(0.0, -0.01), contact=contact, travel=travel)
    run = Dynamic(until=end, every=(end - begin) / 20)
    result = simulate(Scenario(gravity=0.0, lines={"string": line}, loads={"mass": load}, run=run))
    time, place = result.time.values, result.contact_position.values[:, 0]
    work = result.energy.sel(form="hold_work").values
    at = np.array([np.interp(begin, time, place[:, a]) for a in range(2)])
    done = work[-1] - np.interp(begin, time, work)
    imbalance = np.abs(result.energy.sel(form="imbalance").values).max()
    assert imbalance < 0.02 * result.energy.sel(form="load_work").values[-1]
    return (place[-1] - at) / (time[-1] - begin), done / (place[-1, 0] - at[0]), done / (time[-1] - begin)


def exact_wave(contact: str) -> selfsimilar.SelfSimilarWave:
    return selfsimilar.moving_force(
        force=0.01, speed=0.1, axial_stiffness=1.0, mass=1.0, prestrain=0.05, contact=contact
    )


def test_a_mass_that_has_settled_moves_as_the_self_similar_contact() -> None:
    """Once the mass no longer accelerates, only its force counts: after 0.4 s, nine times m / (2 rho c)."""
    wave, drift = exact_wave("clamped"), exact_wave("clamped").contact_velocity[0] - 0.105
    velocity, _, power = self_similar(768, "clamped", "material", 0.1, 0.02)
    # Measured 2.4e-3 of the drift and 8e-4; forces shared between nodes are 9e-2 off on any mesh.
    assert velocity[0] == pytest.approx(wave.contact_velocity[0], abs=5e-3 * abs(drift))
    assert abs(velocity[1]) == pytest.approx(abs(wave.contact_velocity[1]), rel=2e-3)
    # The motor that hides in a vertical force is here seen as the power of the hold.
    assert power == pytest.approx(-wave.dissipation, rel=2e-2)


def test_frictionless_mass_needs_the_exact_hold_force() -> None:
    wave = exact_wave("frictionless")
    velocity, hold, _ = self_similar(768, "frictionless", "material", 0.1, 0.02)
    assert hold == pytest.approx(wave.hold_force, rel=5e-3)  # measured 1.3e-3
    # Measured 2.1e-3 of the drift; of a clamped mass, whose power is almost the same, it is smaller by a third.
    drift = wave.contact_velocity[0] - 0.105
    assert velocity[0] == pytest.approx(wave.contact_velocity[0], abs=5e-3 * drift)
    assert abs(velocity[1]) == pytest.approx(abs(wave.contact_velocity[1]), rel=2e-3)


def test_prescribed_x_gives_the_same_contact_from_the_other_side() -> None:
    wave = exact_wave("frictionless")
    velocity, hold, _ = self_similar(768, "clamped", "horizontal", wave.contact_velocity[0], 0.02)
    assert velocity[0] == pytest.approx(wave.contact_velocity[0], rel=1e-9)
    assert hold == pytest.approx(wave.hold_force, rel=1e-2)  # measured 4e-3
    assert abs(velocity[1]) == pytest.approx(abs(wave.contact_velocity[1]), rel=2e-3)


def rope(load: dict[str, Any], until: float = 1.0, elements: int = 60, **line: Any) -> Scenario:
    shape = {"start": (0, 0), "end": (20, 0), "length": 19.8, "mass": 1.0, "axial_stiffness": 1e5, **line}
    loads = {name: MovingMass.model_validate({"on": "rope", "mass": 40.0, **given}) for name, given in load.items()}
    return Scenario(lines={"rope": Line(elements=elements, **shape)}, loads=loads, run=Dynamic(until=until, every=0.02))


def travel(speed: Any, start: float, **more: Any) -> dict[str, Any]:
    return {"travel": {"speed": speed, "from": start, **more}}


@pytest.mark.parametrize("measured", ["material", "slip", "horizontal"])
def test_mirrored_travel_gives_the_mirrored_answer(measured: str) -> None:
    start = {"material": 19.8 - 2.0, "slip": None, "horizontal": 18.0}[measured]
    forth = simulate(rope({"m": travel(9.0, 2.0, measured=measured)}))
    if start is None:  # the arc length at rest from the other end
        d = np.diff(forth.position.values[0], axis=0)
        start = float(np.sqrt((d * d).sum(axis=1)).sum()) - 2.0
    back = simulate(rope({"m": travel(-9.0, start, measured=measured)}))
    mirrored = back.position.values[:, ::-1] * [-1.0, 1.0] + [20.0, 0.0]
    # A rounding error moves an event by a step: 1e-7 m.
    np.testing.assert_allclose(forth.position.values, mirrored, atol=1e-6)


def test_a_vertical_plane_may_be_turned_about_z() -> None:
    flat = simulate(rope({"m": travel(9.0, 2.0)}))
    c, s = 0.6, 0.8
    turned = simulate(rope({"m": travel(9.0, 2.0)}, start=(0, 0, 0), end=(20 * c, 20 * s, 0)))
    x, z = turned.position.values[:, :, 0] * c + turned.position.values[:, :, 1] * s, turned.position.values[:, :, 2]
    np.testing.assert_allclose(x, flat.position.values[:, :, 0], atol=1e-6)
    np.testing.assert_allclose(z, flat.position.values[:, :, 1], atol=1e-6)


SIDEWAYS: dict[str, dict[str, Any]] = {
    "heavy": {"mass": 40.0},
    "light": {"mass": 0.2},
    "frictionless": {"mass": 40.0, "contact": "frictionless"},
    "free": {"mass": 40.0, "travel": {"kind": "free", "from": 2.0, "speed": 9.0, "rolling": 0.05}},
    "in air": {"mass": 40.0, "air_drag": 5.0},
}


@pytest.mark.parametrize("case", SIDEWAYS)
def test_a_push_sideways_is_a_push_downwards_turned_about_x(case: str) -> None:
    """Without gravity, line and force are turned by a right angle: (x, y, z) becomes (x, -z, y)."""
    load = {**travel(9.0, 2.0), **SIDEWAYS[case]}
    rise = 0.0 if case == "frictionless" else 3.0  # what holds such a contact acts along x: no line aside knows it
    down = rope({"m": {**load, "force": (0, 30.0, -400.0)}}, start=(0, 0, 0), end=(20, 0, -rise), length=19.8)
    aside = rope({"m": {**load, "force": (0, 400.0, 30.0)}}, start=(0, 0, 0), end=(20, rise, 0), length=19.8)
    one, two = (simulate(scenario.model_copy(update={"gravity": 0.0})) for scenario in (down, aside))
    assert np.abs(one.position.values[:, :, 1]).max() > 1e-3  # in space, not in a plane
    turned = one.position.values[:, :, [0, 2, 1]] * [1.0, -1.0, 1.0]
    # Rounding alone, as sums over axes have another order.
    np.testing.assert_allclose(two.position.values, turned, atol=1e-9)
    turned = one.contact_force.values[:, :, [0, 2, 1]] * [1.0, -1.0, 1.0]
    np.testing.assert_allclose(two.contact_force.values, turned, atol=1e-5)


def test_a_turn_while_a_node_is_carried_goes_back_the_same_way() -> None:
    """The mass turns a tenth of a link beyond a node, which it holds; it comes back to its start."""
    h, speed, half = 19.8 / 60, 9.0, 0.4
    away = (20.1 * h - 4.0) / speed - 0.5 * half
    table = SpeedTable(time=(0.0, away, away + 2 * half, 2 * (away + half)), value=(speed, speed, -speed, -speed))
    result = simulate(rope({"m": travel(table, 4.0)}, until=2 * (away + half)))
    assert np.abs(result.contact_xi.values).max() == pytest.approx(20.1 * h, abs=0.1)
    assert result.contact_xi.values[-1, 0] == pytest.approx(4.0, abs=1e-9)
    imbalance = np.abs(result.energy.sel(form="imbalance").values).max()
    assert imbalance < 2e-3 * np.abs(result.energy.sel(form="load_kinetic").values).max()


def test_small_masses_superpose() -> None:
    def deflection(*loads: str) -> np.ndarray:
        both = {"a": travel(9.0, 3.0), "b": travel(-7.0, 15.0)}
        chosen = {name: {**both[name], "mass": 1.0, "force": (0, -1e-4)} for name in loads}
        result = simulate(rope(chosen, until=0.4).model_copy(update={"gravity": 0.0}))
        return np.asarray(result.position.values[:, :, 1])

    a, b, both = deflection("a"), deflection("b"), deflection("a", "b")
    # Each feels the waves of the other: what one mass of three links' mass reflects of a wave of the other.
    early = slice(0, 6)  # before the waves meet the other mass
    np.testing.assert_allclose(both[early], a[early] + b[early], atol=1e-3 * np.abs(both[early]).max())


def test_two_masses_in_one_link_weigh_as_one() -> None:
    pair = {"a": {**travel(9.0, 4.0), "mass": 20.0}, "b": {**travel(9.0, 4.12), "mass": 20.0}}
    two, one = simulate(rope(pair)), simulate(rope({"m": travel(9.0, 4.06)}))
    assert two.attrs["outcome"] == "completed"
    # Half a gap of 12 cm beside a span of 20 m; a lost load would be 0.5 m off.
    assert np.abs(two.position.values - one.position.values).max() < 0.02
    assert np.abs(two.energy.sel(form="imbalance").values).max() < 20.0


def test_loads_that_meet_end_the_run() -> None:
    chase = {"a": travel(9.0, 4.0), "b": travel(0.0, 6.0, measured="slip")}
    result = simulate(rope(chase, until=1.5))
    assert result.attrs["outcome"] == "loads met"
    gap = float(np.diff(result.contact_xi.values[-1])[0])
    assert 0.0 < gap < 0.05 * 19.8 / 60
    assert np.isfinite(result.position.values).all()


def test_a_speed_that_jumps_loses_no_way() -> None:
    """Nor gains: a table with two values at one instant."""
    table = SpeedTable(time=(0.0, 0.31, 0.31, 1.0), value=(9.0, 9.0, 5.0, 5.0))
    result = simulate(rope({"m": travel(table, 4.0)}))
    assert result.contact_xi.values[-1, 0] == pytest.approx(4.0 + 9.0 * 0.31 + 5.0 * 0.69, abs=1e-9)


def test_a_mass_that_runs_into_a_free_one_ends_the_run_and_says_so() -> None:
    free = {"travel": {"kind": "free", "from": 9.0}}
    result = simulate(rope({"tug": travel(9.0, 8.0), "car": free}, until=1.2))
    assert result.attrs["outcome"] == "loads met"
    assert "load tug meets load car at" in result.attrs["advice"]
    assert result.time.values[-1] == pytest.approx(1.0 / 9.0, rel=0.05)  # the car hardly moves until then
    gap = np.diff(result.contact_xi.values, axis=1) / (19.8 / 60)
    assert 0.07 < gap[-1, 0] < 0.1  # links; a step is 0.017
    assert np.abs(result.energy.sel(form="imbalance").values).max() < 3.0  # J of 1700; 35 at a fiftieth of a link
