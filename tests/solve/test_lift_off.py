"""Masses that leave their line and come back: where contact is lost, the flight, the landing.

Exact values: `ropewalk.theory.string.moving_mass` for the loss of contact on a massless string, and the parabola.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.chains.beginning import initial_state
from ropewalk.mechanics.bodies import FLYING, LOCATED, Bodies
from ropewalk.mechanics.chain import ChainState
from ropewalk.model import Dynamic, ForceTable, FreeTravel, Guided, Line, MovingMass, Scenario, Start, Travel
from ropewalk.simulate import simulate
from ropewalk.solve.choice import choose
from ropewalk.solve.motion import Progress, move
from ropewalk.solve.start import setting_of
from ropewalk.theory import string

IN_AIR, MOVES = 1.0, 3.0
TAKEN_OFF, G = 0.3, 9.81


def form(result: xr.Dataset, name: str) -> np.ndarray:
    return np.asarray(result.energy.sel(form=name).values)


@pytest.mark.parametrize("quotient", [7.0, 8.0, 9.0, 10.0, 11.0])
@pytest.mark.parametrize("lift_off", [False, True])
def test_contact_is_lost_where_the_massless_string_says(quotient: float, lift_off: bool) -> None:
    """PL/(m V^2) = quotient: the place from the sign of the force, and from the state of a load that may lift off."""
    stretch, line_mass, weight = 1.01, 1e-4, 1e-6
    length = 1.0 / stretch
    speed = float(np.sqrt(length / stretch / quotient))
    scenario = Scenario(
        gravity=1e-12 if lift_off else 0.0,  # only so that above and below exist
        lines={
            "string": Line(start=(0, 0), end=(1, 0), length=length, mass=line_mass, axial_stiffness=100.0, elements=25)
        },
        loads={
            "mass": MovingMass(
                on="string", mass=1.0, force=(0.0, -weight), lift_off=lift_off,
                travel=Travel(speed=speed, at_end="leave"),
            )
        },
        run=Dynamic(until=length / speed, every=length / speed / 1000),
    )  # fmt: skip
    result = simulate(scenario)
    exact = string.moving_mass(
        0.0, load_mass=1.0, speed=speed, length=length, tension=1.0 / stretch, mass=0.0, gravity=weight
    ).contact_lost_at
    assert exact is not None
    lost = result.contact_state.values[:, 0] == IN_AIR if lift_off else result.contact_force.values[:, 0, 1] > 0.0
    late = result.time.values > 0.2 * length / speed
    place = result.time.values[late & lost][0] * speed / length
    # The first output after it, a thousandth of the way; the mass of the string is 1e-4 of that of the load.
    assert 0.0 <= place - exact * speed / length < 1.2e-3


def hop(elements: int, *, upwards: float = 1500.0, side: str = "above", until: float = 2.4, **more: Any) -> xr.Dataset:
    """A rope of 20 kN that a kick upwards of 0.2 s lets 40 kg take off from; 5 m/s along it."""
    sign = 1.0 if side == "above" else -1.0
    kick = ForceTable(
        time=(0.0, TAKEN_OFF, TAKEN_OFF, 0.4, 0.4, 9.0),
        value=((0, 0), (0, 0), (0, sign * upwards), (0, sign * upwards), (0, 0), (0, 0)),
    )
    line = Line(
        start=(0, 0), end=(20, 0), tension=2e4, mass=1.0, axial_stiffness=1e6, elements=elements,
        **more.pop("line", {}),
    )  # fmt: skip
    load = MovingMass(
        on="rope", mass=40.0, lift_off=True, side=side, force=kick,
        travel=Travel.model_validate({"speed": 5.0, "from": 4.0}), **more,
    )  # fmt: skip
    run = Dynamic(until=until, every=0.002, start=Start(with_loads=True))
    return simulate(Scenario(lines={"rope": line}, loads={"mass": load}, run=run))


@pytest.fixture(scope="module")
def hopped() -> xr.Dataset:
    return hop(50)


def changes(result: xr.Dataset) -> np.ndarray:
    """Outputs at which the load has just taken off or landed."""
    return np.flatnonzero(np.diff(result.contact_state.values[:, 0]) != 0.0) + 1


def test_in_the_air_it_flies_along_a_parabola(hopped: xr.Dataset) -> None:
    first, last = changes(hopped)[:2]
    time, place = hopped.time.values, hopped.contact_position.values[:, 0]
    free = slice(max(first, int(np.searchsorted(time, 0.4)) + 1), last)
    # With a kick that ended at an output the steps of the second order in time are exact for a constant force.
    t = time[free] - time[free][0]
    z = np.polyfit(t, place[free, 1], 2)
    x = np.polyfit(t, place[free, 0], 1)
    assert 2.0 * z[0] == pytest.approx(-G, rel=1e-6)
    assert np.abs(np.polyval(z, t) - place[free, 1]).max() < 1e-9
    assert np.abs(np.polyval(x, t) - place[free, 0]).max() < 1e-9
    assert (hopped.contact_force.values[free, 0] == 0.0).all()


def test_the_time_in_the_air_is_what_the_result_says(hopped: xr.Dataset) -> None:
    state, time = hopped.contact_state.values[:, 0], hopped.time.values
    in_air = 0.002 * np.count_nonzero(state == IN_AIR)
    assert state[0] == MOVES
    assert in_air > 0.3
    # One output for each change.
    assert hopped.contact_in_air.values[-1, 0] == pytest.approx(in_air, abs=0.002 * changes(hopped).size)
    off = changes(hopped)[0]
    assert (hopped.contact_in_air.values[:off, 0] == 0.0).all()
    assert 0.0 < time[off] - TAKEN_OFF < 0.1  # the line, which it had pushed down, follows for a while


def test_it_lands_on_the_line(hopped: xr.Dataset) -> None:
    last = changes(hopped)[1]
    assert hopped.contact_state.values[last, 0] == MOVES
    xi, nodes = hopped.contact_xi.values[last, 0], hopped.position.values[last]
    on_line = np.array([np.interp(xi, hopped.xi.values, nodes[:, a]) for a in range(2)])
    # The link below it at the landing is straight, and 0.04 s later it is where the load is.
    assert np.abs(hopped.contact_position.values[last, 0] - on_line).max() < 0.02
    x = hopped.contact_position.values[:, 0, 0]
    assert np.abs(np.diff(x)).max() < 0.002 * 9.0  # nothing jumps


@pytest.mark.parametrize("elements", [20, 40, 80])
def test_landing_costs_a_small_part_of_its_energy(elements: int) -> None:
    result = hop(elements)
    landing, energy = changes(result)[1], form(result, "imbalance")
    # The node it lands on or beside takes its velocity; how much depends on where it lands: 0.02 to 1.2 J of 1000 J.
    assert abs(float(energy[landing + 5] - energy[landing - 1])) < 4e-3 * form(result, "load_kinetic").max()


def momentum_of(state: ChainState, bodies: Bodies, node: float, axis: int) -> float:
    """Of a mass and its line, whose nodes have the mass `node`: what the mass carries of a node is noted beside it."""
    mass = bodies.wheels[0]
    line = node * state.w[axis]
    line[[0, -1]] *= 0.5
    if mass["phase"] == LOCATED:
        line[mass["at"]] = mass["store"][axis]
    return float(mass["mass"][axis] * mass["v"][axis] + line.sum())


@pytest.mark.parametrize("elements", [20, 33])
@pytest.mark.parametrize(("axis", "carried"), [(0, 40.0), (1, 0.0)])
def test_momentum_is_kept_when_it_lands_on_a_line_that_nothing_holds(axis: int, carried: float, elements: int) -> None:
    """Both ends slide on rails along the axis; a force lifts the mass and another one throws it back."""
    along, force = ((1, 0), 1000.0) if axis == 0 else ((0, 1), 0.0)
    line = Line(
        start=(0, 0), end=(20.2, 0), length=20.0, mass=1.0, axial_stiffness=1e5, elements=elements,
        start_support=Guided(along=along, force=-force), end_support=Guided(along=along, force=force),
    )  # fmt: skip
    # Linear between corners, at which steps end: 18.75 N s upwards and 37.5 N s downwards without an error.
    back = 0.15
    throw = ForceTable(time=(0.0, 0.025, 0.05, 0.1, back), value=((0, 0), (0, 750.0), (0, 0), (0, -750.0), (0, 0)))
    way = {"from": 8.03, "speed": 4.0}  # free where x is looked at, with friction, which is between mass and line
    travel = FreeTravel.model_validate({**way, "viscous": 20.0}) if axis == 0 else Travel.model_validate(way)
    load = MovingMass(on="line", mass=10.0, lift_off=True, force=throw, travel=travel)
    # Hardly any gravity: only so that above and below exist.
    scenario = Scenario(gravity=1e-12, lines={"line": line}, loads={"mass": load}, run=Dynamic(until=0.5, every=0.01))
    setting = setting_of(scenario, 0.5)
    state, bodies = initial_state(setting, scenario)
    assert bodies is not None
    choice = choose(
        setting.strands, setting.loads, state, method="auto", step=None, accuracy=1e-3, duration=0.5,
        supports=setting.supports, bodies=bodies,
    )  # fmt: skip
    times, node = np.linspace(0.01, 0.5, 50), 20.0 / elements
    phases, momenta = [], []
    for now in move(setting.strands, setting.loads, state, choice, 1e-3, times, Progress(), setting.supports, bodies):
        phases.append(int(bodies.wheels["phase"][0]))
        momenta.append(momentum_of(now, bodies, node, axis))
    in_air = np.flatnonzero(np.array(phases) == FLYING)
    free = times > back + 1e-9
    assert free[in_air[-1]]
    assert in_air[-1] < 40  # it has landed long before the end
    kept = np.array(momenta)[free]
    assert np.ptp(kept) < 1e-11 * 40.0
    assert kept[0] == pytest.approx(carried - (18.75 if axis == 1 else 0.0), abs=1e-9)
    # What it had in the air has become the line's.
    assert abs(float(bodies.wheels["mass"][0, axis] * bodies.wheels["v"][0, axis]) - kept[-1]) > 0.5


def test_what_runs_below_the_line_takes_off_downwards() -> None:
    result = hop(40, side="below", upwards=3000.0, until=0.7)
    off = changes(result)
    assert off.size >= 1
    free = slice(off[0] + 1, None)
    below = []
    for xi, nodes, place in zip(
        result.contact_xi.values[free, 0], result.position.values[free], result.contact_position.values[free, 0],
        strict=True,
    ):  # fmt: skip
        below.append(place[1] - np.interp(xi, result.xi.values, nodes[:, 1]))
    assert max(below) < 0.01


def test_without_lift_off_the_line_pulls_it_back() -> None:
    restrained = hop(40, until=0.6).contact_state.values[:, 0]
    assert (restrained == IN_AIR).any()
    line = Line(start=(0, 0), end=(20, 0), tension=2e4, mass=1.0, axial_stiffness=1e6, elements=40)
    kick = ForceTable(time=(0.0, 0.3, 0.3, 9.0), value=((0, 0), (0, 0), (0, 1500.0), (0, 1500.0)))
    load = MovingMass(on="rope", mass=40.0, force=kick, travel=Travel.model_validate({"speed": 5.0, "from": 4.0}))
    result = simulate(Scenario(lines={"rope": line}, loads={"mass": load}, run=Dynamic(until=0.6, every=0.002)))
    assert (result.contact_state.values[:, 0] == MOVES).all()
    assert result.contact_force.values[:, 0, 1].max() > 100.0
    assert (result.contact_in_air.values == 0.0).all()
