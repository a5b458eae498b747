"""Wheels that leave a beam and land: a stiff, strongly damped contact, flight parabolas, balance of energy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ropewalk.theory import beam, beam_vehicle
from ropewalk.theory.beam import Flight
from ropewalk.theory.beam_vehicle import Vehicle

UNIT = {"length": 1.0, "bending_stiffness": 1.0, "mass": 1.0}
HEAVY = {"vehicle": beam_vehicle.point_mass(0.5, gravity=2.0), "speed": 0.5 * np.pi}  # (mu, alpha) = (0.5, 0.5)
CAR = {
    "vehicle": beam_vehicle.rigid_body(
        0.5, pitch_inertia=0.02, centre=0.2, axles=[0.0, 0.4], load_stiffness=40.0, load_damping=0.2, wheel_mass=0.05,
        gravity=2.0,
    ),
    "speed": 2.5,
}  # fmt: skip
NOTHING = np.zeros((2, 2))
PAIR = {  # the second one meets the beam while it swings up: an impact on the support
    "vehicle": Vehicle(np.diag([0.3, 0.2]), NOTHING, NOTHING, np.array([0.0, 2.1]), np.array([0.6, 0.4])),
    "speed": 2.5,
}
SUDDEN = {"vehicle": beam_vehicle.point_mass(0.3, gravity=2.0), "speed": 0.8, "start": 0.35}


def pushed(
    t: np.ndarray, modes: int, stiffness: float, vehicle: Vehicle, speed: float, start: float = 0.0
) -> np.ndarray:
    """Displacements of the wheels over springs that only push, damped ten times more than critically."""
    n, bodies = np.arange(1, modes + 1) * np.pi, vehicle.bodies
    size, masses = len(vehicle.mass), np.diag(vehicle.mass)
    damping = 20.0 * np.sqrt(stiffness * masses[bodies:])

    def rate(s: float, y: np.ndarray) -> np.ndarray:
        q, v, u, du = np.split(y, [modes, 2 * modes, 2 * modes + size])
        x = start + speed * s - vehicle.axles
        on = np.sqrt(2.0) * ((x >= 0.0) & (x <= 1.0))[:, np.newaxis]
        shape, slope = on * np.sin(np.outer(x, n)), on * n * np.cos(np.outer(x, n))
        deep = u[bodies:] - shape @ q
        force = stiffness * deep + damping * (du[bodies:] - shape @ v - speed * slope @ q)
        force = np.where(deep > 0.0, np.maximum(force, 0.0), 0.0)
        given = np.concatenate([np.zeros(bodies), vehicle.static_load - force])
        a = (given - vehicle.stiffness @ u - vehicle.damping @ du) / masses
        return np.concatenate([v, -(n**4) * q + shape.T @ force, du, a])

    y = np.zeros(2 * (modes + size))
    y[2 * modes + bodies : 2 * modes + size] = vehicle.static_load / stiffness
    solution = solve_ivp(rate, (0.0, t[-1]), y, "LSODA", t_eval=t, rtol=1e-8, atol=1e-11, max_step=t[-1] / 300)
    return solution.y[2 * modes + bodies : 2 * modes + size].T


@pytest.mark.parametrize(("case", "landings"), [(CAR, 4), (PAIR, 1), (HEAVY, 1)], ids=["car", "pair", "heavy"])
def test_a_stiff_damped_contact_converges_to_it(case: dict, landings: int) -> None:
    t = np.linspace(0.0, 0.95, 200)
    flight = beam.flying_vehicle(t, modes=3, tolerance=1e-6, **case, **UNIT)
    scale = np.max(np.abs(flight.wheel))
    soft, stiff = (np.max(np.abs(pushed(t, 3, k, **case) - flight.wheel)) / scale for k in (1e4, 1e6))
    print("gaps", soft, stiff)
    assert stiff < 2e-3  # between the first and the half power of the stiffness: 7e-5 to 1.3e-3 seen
    assert soft > 10.0 * stiff
    assert len(flight.landed_at) == landings


def test_it_leaves_where_the_bilateral_solution_begins_to_pull_and_flies_a_parabola() -> None:
    t = np.linspace(0.0, 1.0, 401)
    line = UNIT | {"modes": 4}
    flight = beam.flying_vehicle(t, tolerance=1e-7, **HEAVY, **line)
    restrained = beam.moving_vehicle(t, tolerance=1e-7, **HEAVY, **line)
    assert np.min(restrained.contact_force) < -1.0  # weights
    left, landed = flight.left_at[0], flight.landed_at[0]
    assert left == pytest.approx(restrained.contact_lost_at, abs=1e-3)  # which is the next stage of a step
    before = t < left
    assert flight.contact_force[before] == pytest.approx(
        restrained.contact_force[before], abs=2e-5
    )  # forces converge later
    assert np.min(flight.contact_force) > -1e-9
    there = beam.moving_vehicle(left, tolerance=1e-9, **HEAVY, **line)
    u, v = float(there.deflection[0, 0]), float(there.velocity[0, 0])
    flying = (t > left) & (t < landed)
    after = t[flying] - left
    assert flight.wheel[flying, 0] == pytest.approx(u + v * after + after**2, abs=1e-6)  # gravity 2
    assert np.all(flight.in_air[:, 0] == flying)
    assert flight.time_in_air[-1, 0] == pytest.approx(landed - left)
    # The ground is level again where it comes down.
    fall = 0.5 * (-v + np.sqrt(v**2 - 4.0 * u))
    assert landed == pytest.approx(left + fall, abs=1e-6)
    assert flight.impact_loss[-1] == pytest.approx(0.25 * (v + 2.0 * fall) ** 2, rel=1e-5)
    assert np.all(flight.impact_loss[t < landed] == 0.0)


def test_what_never_pulls_is_not_changed() -> None:
    t = np.linspace(0.0, 0.9, 91)
    case = {"vehicle": beam_vehicle.oscillator(0.2, load_stiffness=20.0, load_damping=0.3), "speed": 1.2}
    flight = beam.flying_vehicle(t, modes=6, tolerance=1e-7, **case, **UNIT)
    restrained = beam.moving_vehicle(t, modes=6, tolerance=1e-7, **case, **UNIT)
    assert restrained.contact_lost_at is None
    assert flight.left_at == ()
    for name in ("deflection", "body", "body_velocity", "body_acceleration", "contact_force"):
        assert getattr(flight, name) == pytest.approx(getattr(restrained, name), abs=1e-5), name
    assert flight.wheel_velocity == pytest.approx(restrained.velocity, abs=1e-5)
    x = np.array([0.2, 0.7])
    assert flight.beam_deflection(x) == pytest.approx(restrained.beam_deflection(x), abs=1e-7)
    assert restrained.beam_velocity(x) == pytest.approx(flight.beam_velocity(x), abs=1e-6)
    assert flight.beam_velocity(x) == pytest.approx(np.gradient(flight.beam_deflection(x), t, axis=0), abs=2e-2)


def test_a_wheel_that_meets_a_beam_swinging_up_gives_its_speed_to_the_support() -> None:
    flight = beam.flying_vehicle(np.array([0.839, 0.841]), modes=3, tolerance=1e-6, **PAIR, **UNIT)
    slope = flight.beam_deflection(0.0, 1).mean()  # at 0.84 s, when it enters
    assert slope < 0.0
    lost = 0.5 * 0.2 * (2.5 * slope) ** 2
    assert np.diff(flight.impact_loss)[0] == pytest.approx(lost, rel=1e-3)  # of the mean of two instants
    # The beam swings back faster than the wheel falls: it leaves at once.
    assert flight.left_at[-1] == pytest.approx(0.84, abs=1e-9)


def energy(flight: Flight, vehicle: Vehicle) -> np.ndarray:
    """Of the beam by its shape, of the vehicle by its matrices, less the work of its weight."""
    x = np.linspace(0.0, 1.0, 201)
    beams = 0.5 * np.trapezoid(flight.beam_velocity(x) ** 2 + flight.beam_deflection(x, 2) ** 2, x, axis=1)
    u = np.hstack([flight.body, flight.wheel])
    rate = np.hstack([flight.body_velocity, flight.wheel_velocity])
    own = 0.5 * np.einsum("ti,ij,tj->t", rate, vehicle.mass, rate)
    own += 0.5 * np.einsum("ti,ij,tj->t", u, vehicle.stiffness, u) - flight.wheel @ vehicle.static_load
    return beams + own


@pytest.mark.parametrize("case", [CAR, HEAVY], ids=["car", "heavy"])
def test_energy_is_lost_in_impacts_and_given_by_what_drives_along_the_slope(case: dict) -> None:
    """A wheel in contact takes V N w_x less than the line gets; impacts here meet next to no slope."""
    t = np.linspace(0.0, 0.95, 3001)
    vehicle = case["vehicle"]
    undamped = Vehicle(vehicle.mass, 0.0 * vehicle.damping, vehicle.stiffness, vehicle.axles, vehicle.static_load)
    flight = beam.flying_vehicle(t, modes=3, tolerance=1e-6, **(case | {"vehicle": undamped}), **UNIT)
    on = (flight.place >= 0.0) & (flight.place <= 1.0)
    slope = np.array([flight.beam_deflection(np.clip(x, 0.0, 1.0), 1)[i] for i, x in enumerate(flight.place)]) * on
    power = case["speed"] * np.sum(flight.contact_force * slope, axis=1)
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(t))])
    balance = energy(flight, undamped) + flight.impact_loss + work
    assert flight.impact_loss[-1] > 1e-3
    largest = np.max(np.abs(work))
    # jumps of the force within an interval of the sum for the work
    assert np.max(np.abs(balance)) < 5e-3 * largest


@pytest.mark.parametrize("damping", [0.0, 2.0])
def test_a_wheel_without_mass_is_the_limit_of_light_ones(damping: float) -> None:
    t = np.linspace(0.0, 1.0, 101)
    load = {"load_mass": 0.5, "load_stiffness": 300.0, "load_damping": damping, "gravity": 2.0}
    case = UNIT | {"speed": 0.5 * np.pi, "modes": 2, "tolerance": 1e-5}
    none = beam.flying_vehicle(t, vehicle=beam_vehicle.oscillator(**load), **case)
    assert len(none.landed_at) > 0
    assert none.impact_loss[-1] == 0.0
    gaps = []
    for mass in (4e-3, 4e-4):
        light = beam.flying_vehicle(t, vehicle=beam_vehicle.oscillator(wheel_mass=mass, **load), **case)
        gaps.append(np.max(np.abs(light.body - none.body)) / np.max(np.abs(none.body)))
    print("gaps", gaps)
    assert gaps[1] < 0.3 * gaps[0]  # the first order; the time of the first landing moves
    assert gaps[1] < 0.01


def test_masses_that_couple_wheels_are_refused() -> None:
    mass = np.array([[1.0, 0.1], [0.1, 0.2]])
    vehicle = Vehicle(mass, np.zeros((2, 2)), np.array([[1.0, -1.0], [-1.0, 1.0]]), np.zeros(1), np.ones(1))
    with pytest.raises(ValueError, match="count all of them from the ground"):
        beam.flying_vehicle(0.1, vehicle=vehicle, speed=1.0, **UNIT)
    with pytest.raises(ValueError, match=r"^start must"):
        beam.flying_vehicle(0.1, vehicle=HEAVY["vehicle"], speed=1.0, start=np.nan, **UNIT)


def test_a_start_before_the_beam_is_a_delay_and_one_on_it_sets_the_weight_down() -> None:
    t = np.linspace(0.0, 1.0, 51)
    line = UNIT | {"vehicle": CAR["vehicle"], "speed": 2.0, "modes": 4, "tolerance": 1e-8}
    late, now = beam.moving_vehicle(t, start=-0.6, **line), beam.moving_vehicle(t - 0.3, **line)
    for name in ("deflection", "body", "contact_force", "place"):  # steps differ, and forces converge later
        assert getattr(late, name) == pytest.approx(getattr(now, name), abs=1e-5), name
    sudden = beam.moving_vehicle(t, modes=3, tolerance=1e-8, **SUDDEN, **UNIT)
    assert sudden.contact_lost_at is None
    assert sudden.deflection == pytest.approx(pushed(t, 3, 1e7, **SUDDEN), abs=3e-6)  # by the spring, 6e-8 at rest
