"""Oscillators and vehicles: taut strings, stiff limits, soft and lost contacts, natural motion, several axles.

Sources of the exact values: `ropewalk.theory.string.moving_oscillator` and `moving_oscillator_infinite`, and the
exponential of the vehicle's own matrices.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.linalg import expm

from closed_forms import strings
from motion_cases import order
from ropewalk.chains.beginning import initial_state
from ropewalk.errors import RopewalkError
from ropewalk.model import Dynamic, Line, Scenario
from ropewalk.simulate import simulate
from ropewalk.solve.choice import choose
from ropewalk.solve.motion import Progress, move
from ropewalk.solve.start import setting_of
from ropewalk.theory import string

WEIGHT = 1e-5  # N per kg, so small beside the tension of 1 N that the motion is linear
STIFFNESS = 1e5  # N
STRETCH = 1.0 + 1.0 / STIFFNESS
LENGTH = 1.0 / STRETCH  # m, unstrained; in the material coordinate the string has this length and the tension 1/STRETCH
WAVE = np.sqrt(1.0 / STRETCH)  # m/s, material speed of a transverse wave, for 1 kg/m


def sprung(body: float, wheel: float, stiffness: float, damping: float, travel: dict[str, Any]) -> dict[str, Any]:
    """An oscillator as matrices, which may have a weight where there is no gravity: the string keeps straight."""
    one = np.array([[1.0, -1.0], [-1.0, 1.0]])
    return {
        "kind": "matrices", "on": "string", "coordinates": ["body", "wheel"], "mass": [[body, 0.0], [0.0, wheel]],
        "stiffness": (stiffness * one).tolist(), "damping": (damping * one).tolist(),
        "wheels": {"wheel": {"coordinate": "wheel"}}, "weight": [WEIGHT * body, WEIGHT * wheel], "travel": travel,
    }  # fmt: skip


def on_string(elements: int, load: dict[str, Any], until: float, length: float = 1.0) -> xr.Dataset:
    """A string of 1 kg/m, 1 N and EA = 100 kN without weight of its own."""
    line = {"start": (0, 0), "end": (length, 0), "length": length / STRETCH, "mass": 1.0, "elements": elements}
    lines = {"string": Line(axial_stiffness=STIFFNESS, **line)}
    return simulate(
        Scenario(gravity=0.0, lines=lines, loads={"load": load}, run=Dynamic(until=until, every=until / 200))
    )


def passage(elements: int, wheel: float, alpha: float, stiffness: float, damping: float) -> list[float]:
    """Errors of deflection, body (in weight times L/P) and contact force (in weights) of a body of 1 kg on its way."""
    until = 0.9 * LENGTH / (alpha * WAVE)
    load = sprung(1.0, wheel, stiffness, damping, {"speed": float(alpha * WAVE), "at_end": "leave"})
    found = on_string(elements, load, until)
    exact = string.moving_oscillator(
        found.time.values, sprung_mass=1.0, contact_mass=wheel, stiffness=stiffness, damping=damping,
        speed=alpha * WAVE, length=LENGTH, tension=1.0 / STRETCH, mass=1.0, gravity=WEIGHT,
    )  # fmt: skip
    whole = (1.0 + wheel) * WEIGHT
    wheel_error = -found.contact_position.values[:, 0, 1] - exact.deflection
    body = -found.body_position.values[:, 0, 1] - WEIGHT / stiffness - exact.body_deflection
    force = -found.contact_force.values[1:, 0, 1] - exact.contact_force[1:]
    return [float(np.abs(e).max()) / whole for e in (wheel_error, body, force)]


@pytest.mark.parametrize(("wheel", "alpha"), [(0.0, 0.5), (0.5, 0.2), (0.5, 0.8)])
def test_an_oscillator_passes_a_taut_string(wheel: float, alpha: float) -> None:
    links = [25, 50, 100]
    found = [passage(n, wheel, alpha, 20.0, 0.5) for n in links]
    rate = order([1.0 / n for n in links], [f[0] for f in found])
    assert rate > (0.85 if wheel == 0.0 else 1.1)  # a light wheel rides as a force does, at first order
    assert found[-1][0] < (3e-3 if wheel == 0.0 else 4e-4)
    assert found[-1][1] < (5e-4 if wheel == 0.0 else 1e-4)  # what the body does is far smoother


@pytest.mark.parametrize("wheel", [0.0, 0.5])
def test_an_oscillator_on_a_long_string_settles_as_on_an_infinite_one(wheel: float) -> None:
    load = sprung(1.0, wheel, 20.0, 0.5, {"speed": float(0.5 * WAVE), "from": 1.3, "at_end": "leave"})
    found = on_string(400, load, 1.2, length=4.0)  # before a wave comes back
    exact = strings.moving_oscillator_infinite(
        found.time.values, sprung_mass=1.0, contact_mass=wheel, stiffness=20.0, damping=0.5, tension=1.0 / STRETCH,
        mass=1.0, gravity=WEIGHT,
    )  # fmt: skip
    deflection = -found.contact_position.values[:, 0, 1] - exact.deflection
    force = -found.contact_force.values[1:, 0, 1] - exact.contact_force[1:]
    assert np.abs(deflection).max() < (1.2e-3 if wheel == 0.0 else 6e-5) * WEIGHT  # first order of 1 link in 100
    assert np.sqrt(np.mean(force**2)) < 0.02 * WEIGHT


TRAVEL = {"speed": 10.0, "from": 4.0, "at_end": "leave"}


def on_rope(
    load: dict[str, Any], *, elements: int = 40, until: float = 1.0, with_loads: bool = False, tension: float = 5e3
) -> xr.Dataset:
    """A taut rope of 20 m, 1 kg/m and EA = 1 MN."""
    line = Line(start=(0, 0), end=(20, 0), tension=tension, mass=1.0, axial_stiffness=1e6, elements=elements)
    run = Dynamic(until=until, every=until / 100, start={"with_loads": with_loads})
    load = {"on": "rope", "travel": TRAVEL, **load}
    return simulate(Scenario(lines={"rope": line}, loads={"load": load}, run=run))


def apart(one: xr.Dataset, two: xr.Dataset) -> float:
    return float(np.nanmax(np.abs(one.contact_position.values - two.contact_position.values)))


def missed(result: xr.Dataset) -> float:
    return float(np.abs(result.energy.sel(form="imbalance").values).max())


@pytest.mark.parametrize("wheel", [0.0, 5.0])
def test_an_oscillator_on_stiff_springs_is_a_mass(wheel: float) -> None:
    mass = on_rope({"kind": "mass", "mass": 50.0 + wheel})
    springs, found = [1e4, 1e5, 1e6], []
    for k in springs:
        load = {"kind": "oscillator", "mass": 50.0, "wheel_mass": wheel, "stiffness": k, "damping": np.sqrt(k * 50.0)}
        found.append(apart(on_rope(load), mass))
    assert 0.85 < order([1.0 / k for k in springs], found) < 1.1  # what the chain is off by stays: 2e-4 m
    assert found[-1] < 2e-3


@pytest.mark.parametrize("wheel", [0.0, 5.0])
def test_a_damper_of_any_strength_costs_no_smaller_step(wheel: float) -> None:
    mass = on_rope({"kind": "mass", "mass": 50.0 + wheel})
    for damping in (1e6, 1e10):  # N s/m: an explicit one explodes from 2 m / dt = 3e5 on
        load = {"kind": "oscillator", "mass": 50.0, "wheel_mass": wheel, "stiffness": 1e4, "damping": damping}
        found = on_rope(load)
        assert found.attrs["outcome"] == "completed"
        assert found.attrs["steps"] < 1.5 * mass.attrs["steps"]
        assert apart(found, mass) < 1e-3  # of 1 m: welded to the wheel


def test_a_stiff_contact_that_can_only_push_is_a_rigid_one() -> None:
    load = {
        "kind": "oscillator", "mass": 50.0, "wheel_mass": 5.0, "stiffness": [1e7, 1e4], "damping": [4e4, 500.0],
        "lift_off": True,
    }  # fmt: skip
    rigid = on_rope(load, with_loads=True)
    contacts, found = [1e4, 1e5, 1e6], []
    for k in contacts:
        soft = on_rope({**load, "stiffness": 1e4, "damping": 500.0, "contact_stiffness": k}, with_loads=True)
        found.append(apart(soft, rigid))
        assert missed(soft) < 1.0  # J of 500 J
    assert order([1.0 / k for k in contacts], found) > 0.5  # rattles a little where it is stiff
    assert found[-1] < 3e-3


def test_a_wheel_on_its_contact_stiffness_needs_a_mass() -> None:
    load = {"kind": "oscillator", "mass": 50.0, "stiffness": 1e4, "lift_off": True, "contact_stiffness": 1e5}
    with pytest.raises(RopewalkError, match="wheel_mass"):
        on_rope(load)


FIRM = {"start": (0, 0), "end": (10, 0), "tension": 1e9, "mass": 1e3, "axial_stiffness": 1e12, "elements": 20}
CAR = {"mass": 1000.0, "inertia": 800.0, "at": 0.1}
AXLES = {"front": (1.2, 4e4, 900.0), "rear": (-1.1, 6e4, 1500.0)}  # m, N/m, N s/m


def car(wheel: float, travel: dict[str, Any], scale: float = 1.0, **more: Any) -> dict[str, Any]:
    """A body that bounces and pitches on two axles; `scale` makes it lighter and softer."""
    return {
        "kind": "vehicle", "bodies": {"car": {**CAR, "mass": scale * CAR["mass"], "inertia": scale * CAR["inertia"]}},
        "wheels": {name: {"at": at, "mass": wheel} for name, (at, _, _) in AXLES.items()},
        "springs": {
            name: {"between": ["car", name], "stiffness": scale * k, "damping": scale * c}
            for name, (_, k, c) in AXLES.items()
        },
        "travel": travel, **more,
    }  # fmt: skip


def released(load: dict[str, Any], moved: list[float], until: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, coordinates from rest, and time in the air: a vehicle on a firm line, let go elsewhere than at rest."""
    lines = {"rope": Line.model_validate(FIRM)}
    run = Dynamic(until=until, every=until / 20, start={"with_loads": True})
    scenario = Scenario(lines=lines, loads={"load": {"on": "rope", **load}}, run=run)
    setting = setting_of(scenario, until)
    state, bodies = initial_state(setting, scenario)
    assert bodies is not None
    rest = bodies.coordinates["q"].copy()
    bodies.coordinates["q"] += moved
    choice = choose(
        setting.strands, setting.loads, state, method="auto", step=None, accuracy=1e-3, duration=until,
        supports=setting.supports, bodies=bodies,
    )  # fmt: skip
    times, found = np.linspace(0.0, until, 21), [np.array(moved)]
    travels = move(setting.strands, setting.loads, state, choice, 1e-3, times[1:], Progress(), setting.supports, bodies)
    found += [bodies.coordinates["q"] - rest for _ in travels]
    return times, np.array(found), bodies.wheels["in_air"]


@pytest.mark.parametrize("wheel", [0.0, 100.0])
def test_a_vehicle_on_a_firm_line_bounces_and_pitches_as_its_matrices_say(wheel: float) -> None:
    """The exponential of the matrices holds both frequencies (9.3 and 13.3 rad/s) and both dampings."""
    M, K, C = np.diag([CAR["mass"], CAR["inertia"]]), np.zeros((2, 2)), np.zeros((2, 2))
    for at, k, c in AXLES.values():
        row = np.array([1.0, at - CAR["at"]])
        K, C = K + k * np.outer(row, row), C + c * np.outer(row, row)
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    times, found, _ = released(car(wheel, {"speed": 0.0, "from": 5.0}), [0.03, 0.02], 0.5)
    exact = np.array([expm(A * t)[:2] @ [0.03, 0.02, 0.0, 0.0] for t in times])
    assert found == pytest.approx(exact, abs=2e-5)  # the line gives by 1 in 10000 of the springs


def test_a_wheel_thrown_up_from_its_contact_flies_and_lands() -> None:
    """Body and wheel let go 5 cm up: the equations of two masses above a spring that can only push."""
    from scipy.integrate import solve_ivp

    body, wheel, k, c, contact = 100.0, 20.0, 2e4, 400.0, 2e5
    load = {
        "kind": "vehicle", "bodies": {"car": {"mass": body}},
        "wheels": {"w": {"mass": wheel, "contact_stiffness": contact}},
        "springs": {"s": {"between": ["car", "w"], "stiffness": k, "damping": c}}, "lift_off": True,
        "travel": {"speed": 0.0, "from": 5.0},
    }  # fmt: skip
    times, found, in_air = released(load, [0.05, 0.05], 0.6)
    rest = (body + wheel) * 9.81 / contact

    def rate(_: float, u: np.ndarray) -> list[float]:
        spring = k * (u[0] - u[1]) + c * (u[2] - u[3]) - body * 9.81
        push = contact * max(rest - u[1], 0.0)
        return [u[2], u[3], -spring / body - 9.81, (spring + push) / wheel - 9.81]

    exact = solve_ivp(rate, (0.0, 0.6), [0.05, 0.05, 0.0, 0.0], t_eval=times, rtol=1e-9, atol=1e-11, max_step=1e-3)
    assert found == pytest.approx(exact.y[:2].T, abs=1e-4)
    fine = solve_ivp(rate, (0.0, 0.6), [0.05, 0.05, 0.0, 0.0], t_eval=np.linspace(0.0, 0.6, 6001), max_step=1e-3)
    assert in_air[0] == pytest.approx(0.6 * np.mean(fine.y[1] > rest), abs=2e-3)
    assert in_air[0] > 0.06


@pytest.mark.parametrize("wheel", [0.0, 0.2, 20.0])
def test_axles_bear_at_the_start_what_levers_say(wheel: float) -> None:
    found = on_rope(car(wheel, {"speed": 0.0, "from": 10.0}, 0.1), with_loads=True, until=0.1)
    body, weight = 98.1, wheel * 9.81
    levers = [body * 10.0 * 1.2 / 2.3 / 1.0 + weight, body * 10.0 * 1.1 / 2.3 + weight]
    node = 0.5 * 9.81  # N: a heavy wheel that carries a node bears its weight, too
    assert -found.contact_force.values[0, :, 1] == pytest.approx(levers, abs=1e-6 if wheel < 1.0 else 1.01 * node)
    assert np.abs(found.body_velocity.values).max() < 2e-3  # m/s: it is at rest


@pytest.mark.parametrize("wheel", [0.0, 0.2, 20.0])
def test_matrices_are_the_vehicle_that_they_describe(wheel: float) -> None:
    vehicle = car(wheel, TRAVEL, 0.1)
    K, C = np.zeros((4, 4)), np.zeros((4, 4))
    for i, (at, k, c) in enumerate(AXLES.values()):
        row = np.array([1.0, at - CAR["at"], 0.0, 0.0])
        row[2 + i] = -1.0
        K, C = K + 0.1 * k * np.outer(row, row), C + 0.1 * c * np.outer(row, row)
    mixed = np.ix_([2, 0, 3, 1], [2, 0, 3, 1])
    matrices = {
        "kind": "matrices", "coordinates": ["one", "height", "two", "pitch"],
        "mass": np.diag([wheel, 100.0, wheel, 80.0]).tolist(), "stiffness": K[mixed].tolist(),
        "damping": C[mixed].tolist(), "weight": [wheel * 9.81, 981.0, wheel * 9.81, 0.0], "travel": TRAVEL,
        "wheels": {"front": {"at": 1.2, "coordinate": "one"}, "rear": {"at": -1.1, "coordinate": "two"}},
    }  # fmt: skip
    one, two = on_rope(vehicle), on_rope(matrices)
    assert apart(one, two) < 1e-9
    assert one.contact_force.values == pytest.approx(two.contact_force.values, abs=1e-5)


@pytest.mark.parametrize("wheel", [0.0, 20.0])
def test_a_vehicle_of_one_body_and_one_wheel_is_an_oscillator(wheel: float) -> None:
    spring = {"between": ["car", "w"], "stiffness": 4e4, "damping": 900.0}
    vehicle = {"bodies": {"car": {"mass": 100.0}}, "wheels": {"w": {"mass": wheel}}, "springs": {"s": spring}}
    oscillator = {"mass": 100.0, "wheel_mass": wheel, "stiffness": [1e9, 4e4], "damping": [1e5, 900.0]}
    one, two = on_rope({"kind": "vehicle", **vehicle}), on_rope({"kind": "oscillator", **oscillator})
    assert apart(one, two) < 1e-4  # the oscillator's spring along the line is stiff, the vehicle has none


@pytest.mark.parametrize("wheel", [0.0, 0.2, 20.0])
@pytest.mark.parametrize("base", [0.1, 0.8])
def test_axles_within_one_link_go_their_way_whatever_the_mesh(base: float, wheel: float) -> None:
    """Links of 1, 1/2 and 1/8 m: axles that share a link, that hand a node over, and that are links apart."""
    load = {
        "kind": "vehicle", "bodies": {"car": {"mass": 100.0, "inertia": 12.0 * base**2}},
        "wheels": {"front": {"at": 0.5 * base, "mass": wheel}, "rear": {"at": -0.5 * base, "mass": wheel}},
        "springs": {
            "f": {"between": ["car", "front"], "stiffness": 4e4, "damping": 900.0},
            "r": {"between": ["car", "rear"], "stiffness": 6e4, "damping": 1500.0},
        },
    }  # fmt: skip
    coarse, middle, fine = (on_rope(load, elements=n) for n in (20, 40, 160))
    assert all(result.attrs["outcome"] == "completed" for result in (coarse, middle, fine))
    assert all(missed(result) < 2.5 for result in (coarse, middle, fine))  # J of 900 J
    assert apart(coarse, fine) < 6e-3  # of 1 m, with links of 1 m
    assert apart(middle, fine) < 0.7 * apart(coarse, fine)
    total = [result.contact_force.values[5:, :, 1].sum(axis=1) for result in (middle, fine)]
    rms = np.sqrt(np.mean((total[0] - total[1]) ** 2))
    assert rms < 0.1 * (100.0 + 2.0 * wheel) * 9.81  # nodes that are passed


@pytest.mark.parametrize("wheel", [0.0, 20.0])
def test_wheels_come_onto_the_line_one_after_the_other(wheel: float) -> None:
    load = car(wheel, {"speed": 10.0, "from": 0.0, "at_end": "leave"}, 0.1)
    load["wheels"] = {"front": {"at": 0.0, "mass": wheel}, "rear": {"at": -2.3, "mass": wheel}}
    load["bodies"]["car"]["at"] = -1.1
    found = on_rope(load, until=1.8, elements=80)
    t, states = found.time.values, found.contact_state.values
    assert (states[t < 0.22, 1] == 0.0).all()  # the rear axle is on firm ground
    assert (states[(t > 0.24), 1] == 3.0).all()
    assert (found.contact_force.values[(t > 0.0) & (t < 0.22), 1] == 0.0).all()
    # It is as far behind as on the line, which is stretched by T/EA.
    waits = 1.005 * (10.0 * t[t < 0.22] - 2.3)
    assert found.contact_position.values[t < 0.22, 1, 0] == pytest.approx(waits, abs=1e-4)
    assert found.body_position.values[1, 0, 0] == pytest.approx(-1.1 + 10.0 * t[1], abs=0.02)
    assert missed(found) < 60.0  # J of 5000 J: the rope is longer by 1 % than at rest when the rear comes
    with pytest.raises(ValueError, match="at_end: leave"):
        on_rope({**load, "travel": {"speed": 10.0, "from": 0.0}}, until=0.5)


@pytest.mark.parametrize("wheel", [0.0, 5.0])
def test_springs_of_a_load_that_has_left_are_accounted_for(wheel: float) -> None:
    load = {"kind": "oscillator", "mass": 50.0, "wheel_mass": wheel, "stiffness": 2e4, "damping": 400.0}
    found = on_rope({**load, "travel": {**TRAVEL, "from": 0.0}}, until=2.4)
    gone = np.isnan(found.contact_xi.values[:, 0])
    left = found.energy.sel(form="imbalance").values[gone]
    assert left.size > 10
    assert np.ptp(left[2:]) < 0.1  # J of 1000 J, the step


def test_a_coordinate_without_mass_is_refused() -> None:
    load = sprung(0.0, 5.0, 1e4, 0.0, TRAVEL)
    with pytest.raises(RopewalkError, match="no mass"):
        on_rope({**load, "on": "rope"})


@pytest.mark.parametrize("wheel", [0.0, 0.05, 0.2])
def test_the_force_of_a_light_wheel_that_is_set_down_begins_where_it_goes_on(wheel: float) -> None:
    """Newton's law for wheel and particle together: of the whole force the line gets m / (m + M)."""
    m, weight = 20.0 / 1.01 / 80, 50.0 * 9.81
    line = {"start": [0, 0], "end": [20, 0], "tension": 1e4, "mass": 1.0, "axial_stiffness": 1e6, "elements": 80}
    load = {"kind": "oscillator", "on": "rope", "mass": 50.0, "wheel_mass": wheel, "stiffness": 8750.0,
            "travel": {"speed": 0.0, "from": 5.0}}  # fmt: skip
    asked = {"kind": "dynamic", "until": 2e-6, "every": 1e-6}
    found = simulate(Scenario.model_validate({"lines": {"rope": line}, "loads": {"load": load}, "run": asked}))
    force = -found.contact_force.values[:, 0, 1]
    assert force[0] == pytest.approx((weight + 9.81 * wheel) * m / (m + wheel), rel=1e-4)  # its tension is a mean
    assert force[1:] == pytest.approx(force[0], rel=2e-3)  # it falls by 0.04 % in a microsecond
