"""Mass, sprung mass and vehicle on a beam: Yang and Yau 1997; Yang, Lin and Yau 2004; own routes."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ropewalk.theory import beam, beam_vehicle
from ropewalk.theory.beam_vehicle import Vehicle

YAU = {"length": 25.0, "bending_stiffness": 2.87e9 * 2.90, "mass": 2303.0, "speed": 100 / 3.6}
LIN = {"length": 25.0, "bending_stiffness": 27.5e9 * 0.12, "mass": 4800.0, "speed": 10.0}
UNIT = {"length": 1.0, "bending_stiffness": 1.0, "mass": 1.0}


def around(*instants: float) -> np.ndarray:
    """Times close enough for the maxima there."""
    return np.concatenate([[0.0], *(np.linspace(t - 3e-4, t + 3e-4, 61) for t in instants)])


def test_yang_and_yau_1997_sprung_mass() -> None:
    t, data = around(0.371118, 0.151224, 0.44793), {"load_mass": 5750.0, "load_stiffness": 1595e3} | YAU
    crossing = beam.moving_oscillator(t, modes=20, tolerance=1e-7, **data)
    assert np.max(crossing.beam_deflection(12.5)) == pytest.approx(0.0024073013, abs=6e-11)  # digits given
    assert np.max(crossing.body_acceleration) == pytest.approx(0.14219, abs=5e-6)  # digits given
    assert np.min(crossing.body_acceleration) == pytest.approx(-0.14797, abs=5e-6)
    assert crossing.contact_lost_at is None
    one = beam.moving_oscillator(np.linspace(0.3, 0.5, 8001), modes=1, tolerance=1e-8, **data)
    assert np.max(one.beam_deflection(12.5)) == pytest.approx(0.0023838886, abs=6e-11)


def test_yang_and_yau_1997_sprung_mass_is_where_it_was_seen_to_be_largest() -> None:
    crossing = beam.moving_oscillator(np.linspace(0.3, 0.9, 401), load_mass=5750.0, load_stiffness=1595e3, **YAU)
    assert np.max(crossing.beam_deflection(12.5)) == pytest.approx(0.0024073013, abs=3e-8)  # steps of time
    assert crossing.change < 1e-5
    assert crossing.modes > 20


def test_yang_and_yau_1997_mass() -> None:
    crossing = beam.moving_mass(np.linspace(0.34, 0.42, 801), load_mass=5750.0, modes=20, tolerance=1e-7, **YAU)
    assert np.max(crossing.beam_deflection(12.5)) == pytest.approx(0.0024266681, abs=6e-10)  # tolerance


def test_steps_need_not_resolve_the_highest_mode_under_a_mass() -> None:
    """Exact steps of the modes would blow up here: 12000 rad/s and 600 steps in 0.9 s."""
    crossing = beam.moving_mass(0.38, load_mass=5750.0, modes=20, tolerance=1e-3, **YAU)
    assert crossing.steps < 1000
    fine = beam.moving_mass(0.38, load_mass=5750.0, modes=20, tolerance=1e-7, **YAU)
    assert crossing.deflection == pytest.approx(fine.deflection, rel=1e-4)


def test_yang_lin_and_yau_2004() -> None:
    data = {name: LIN[name] for name in ("length", "bending_stiffness", "mass")}
    frequency = beam.natural_frequencies(1, **data)[0] / (2 * np.pi)
    assert frequency == pytest.approx(2.08389681522, abs=5e-12)  # digits given
    vehicle = beam_vehicle.oscillator(1200.0, load_stiffness=500e3)
    assert vehicle.natural_frequencies() / (2 * np.pi) == pytest.approx(3.24873667181, abs=5e-12)
    crossing = beam.moving_vehicle(around(1.3235, 1.5629, 1.33832), vehicle=vehicle, modes=20, tolerance=1e-8, **LIN)
    assert np.max(crossing.beam_deflection(12.5)) == pytest.approx(1.2738549e-3, abs=6e-11)  # digits given
    assert np.max(crossing.body_acceleration) == pytest.approx(0.031704, abs=1.5e-6)  # converged: 0.0317052
    assert np.min(crossing.body_acceleration) == pytest.approx(-0.036866, abs=5e-7)  # digits given


@pytest.mark.parametrize(
    ("ratio", "alpha", "factor", "place"),
    [
        (0.2, 0.25, 1.318164, 0.444),
        (0.2, 0.5, 1.824591, 0.745),
        (0.2, 1.0, 1.731315, 1.0),
        (0.5, 0.5, 2.022125, 0.8545),
    ],
)
def test_impact_factor_of_a_mass_and_loss_of_contact(ratio: float, alpha: float, factor: float, place: float) -> None:
    t = np.linspace(max(place - 0.05, 0.0), 1.0 if ratio == 0.5 else place, 301) / (alpha * np.pi)
    crossing = beam.moving_mass(
        t, load_mass=ratio, speed=alpha * np.pi, gravity=1.0 / ratio, modes=30, tolerance=1e-6, **UNIT
    )
    assert 48.0 * np.max(crossing.beam_deflection(0.5)) == pytest.approx(factor, abs=1e-6)  # digits given
    if ratio == 0.5:
        assert np.min(crossing.contact_force) == pytest.approx(-1.71, abs=5e-3)
        assert crossing.contact_lost_at is not None
        lost = np.argmax(crossing.contact_force[:, 0] < 0.0)
        assert crossing.contact_lost_at == pytest.approx(t[lost], abs=t[1] - t[0])
    else:
        assert crossing.contact_lost_at is None


def passed(t: np.ndarray, modes: int, mass: float, wheel: float, k: float, c: float, axles: list[float]) -> np.ndarray:
    """Bodies on wheels one after the other, by plain Galerkin equations and a Runge-Kutta method; speed 1.5."""
    speed, count = 1.5, len(axles)
    n = np.arange(1, modes + 1) * np.pi

    def rate(s: float, y: np.ndarray) -> np.ndarray:
        q, v, z, zv = np.split(y, [modes, 2 * modes, 2 * modes + count])
        matrix, force = np.eye(modes) * 0.5, -0.5 * (n**4 * q + 0.7 * v)  # damping 0.7
        for j, axle in enumerate(axles):
            x = speed * s - axle
            if 0.0 <= x <= 1.0:
                shape, slope, bend = np.sin(n * x), speed * n * np.cos(n * x), -((speed * n) ** 2) * np.sin(n * x)
                matrix = matrix + wheel * np.outer(shape, shape)
                pull = k * (z[j] - shape @ q) + c * (zv[j] - shape @ v - slope @ q)
                force = force + shape * ((mass + wheel) * 9.81 + pull - wheel * (2.0 * slope @ v + bend @ q))
        ground = [0.0 <= speed * s - a <= 1.0 for a in axles]
        u = np.array([np.sin(n * (speed * s - a)) @ q if g else 0.0 for a, g in zip(axles, ground, strict=True)])
        du = np.array(
            [
                np.sin(n * (speed * s - a)) @ v + speed * (n * np.cos(n * (speed * s - a))) @ q if g else 0.0
                for a, g in zip(axles, ground, strict=True)
            ]
        )
        return np.concatenate([v, np.linalg.solve(matrix, force), zv, -(k * (z - u) + c * (zv - du)) / mass])

    edges = sorted({0.0, t[-1], *(a / speed for a in axles), *((a + 1.0) / speed for a in axles)})
    y, rows = np.zeros(2 * modes + 2 * count), []
    for start, stop in pairwise(edges):
        inside = t[(t > start) & (t <= stop)]
        solution = solve_ivp(rate, (start, stop), y, "DOP853", t_eval=np.union1d(inside, stop), rtol=1e-9, atol=1e-11)
        rows.append(solution.y[:, : len(inside)].T)
        y = solution.y[:, -1]
    return np.vstack(rows)


@pytest.mark.parametrize("wheel", [0.0, 0.08])
def test_two_sprung_bodies_agree_with_a_runge_kutta_method(wheel: float) -> None:
    axles, t = [0.0, 0.37], np.linspace(0.02, 1.1, 55)
    data = {"mass": 0.3, "wheel": wheel, "k": 40.0, "c": 0.9}
    modes = 3
    reference = passed(t, modes, axles=axles, **data)
    stretch = np.hstack([np.eye(2), -np.eye(2)])
    vehicle = Vehicle(
        np.diag([0.3, 0.3, wheel, wheel]),
        0.9 * stretch.T @ stretch,
        40.0 * stretch.T @ stretch,
        np.array(axles),
        np.full(2, (0.3 + wheel) * 9.81),
    )
    crossing = beam.moving_vehicle(t, vehicle=vehicle, speed=1.5, damping=0.7, modes=modes, tolerance=1e-8, **UNIT)
    scale = np.max(np.abs(reference[:, :modes]))
    x = np.array([0.3, 0.5, 0.9])
    expected = reference[:, :modes] @ np.sin(np.pi * np.outer(np.arange(1, modes + 1), x))
    assert crossing.beam_deflection(x) == pytest.approx(expected, abs=1e-7 * scale)
    bodies = slice(2 * modes, 2 * modes + 2)
    assert crossing.body == pytest.approx(reference[:, bodies], abs=1e-7 * scale)
    assert crossing.body_velocity == pytest.approx(reference[:, 2 * modes + 2 :], abs=1e-6 * scale)


def test_forces_without_inertia_are_moving_forces() -> None:
    t, x = np.linspace(-0.1, 1.5, 33), np.linspace(0.0, 1.0, 11)
    line = UNIT | {"tension": 4.0, "foundation": 30.0, "damping": 0.6, "modes": 12}
    for kind in ("simply_supported", "clamped"):
        vehicle = beam_vehicle.row_of_forces([3.0, 5.0], [0.0, 0.4])
        crossing = beam.moving_vehicle(t, vehicle=vehicle, speed=1.7, tolerance=1e-8, ends=kind, **line)
        expected = sum(
            beam.moving_force(x, t[:, np.newaxis] - d / 1.7, force=f, speed=1.7, ends=kind, **line)
            for f, d in ((3.0, 0.0), (5.0, 0.4))
        )
        assert crossing.beam_deflection(x) == pytest.approx(expected, abs=1e-7 * np.max(expected))
        assert crossing.contact_force == pytest.approx(np.broadcast_to([3.0, 5.0], (33, 2)), rel=1e-12)


def test_stiff_spring_is_rigid_contact() -> None:
    t = np.linspace(0.0, 0.6, 13)
    line = UNIT | {"speed": 1.5, "modes": 3, "gravity": 10.0}
    mass = beam.moving_mass(t, load_mass=0.2, tolerance=1e-7, **line)
    sprung = beam.moving_oscillator(t, load_mass=0.2, load_stiffness=1e6, load_damping=300.0, tolerance=1e-5, **line)
    # the spring gives way by 2e-6 of the weight
    assert sprung.deflection == pytest.approx(mass.deflection, abs=1e-4 * np.max(mass.deflection))
    assert mass.contact_force[0] == pytest.approx([2.0])


def test_the_same_vehicle_in_other_coordinates_moves_alike() -> None:
    """A body counted from its wheel couples both by inertia; so do jumps of the slope where wheels enter and leave."""
    t = np.linspace(0.0, 1.2, 25)
    stretch = np.hstack([np.eye(2), -np.eye(2)])
    plain = Vehicle(
        np.diag([0.3, 0.2, 0.0, 0.0]),
        0.1 * stretch.T @ stretch,
        20.0 * stretch.T @ stretch,
        np.array([0.0, 0.4]),
        np.array([3.0, 2.0]),
    )
    turn = np.block([[np.eye(2), np.eye(2)], [np.zeros((2, 2)), np.eye(2)]])  # body = relative + wheel
    turned = Vehicle(
        turn.T @ plain.mass @ turn,
        turn.T @ plain.damping @ turn,
        turn.T @ plain.stiffness @ turn,
        plain.axles,
        plain.static_load,
    )
    line = UNIT | {"speed": 1.5, "modes": 4, "tolerance": 1e-8}
    one, other = (beam.moving_vehicle(t, vehicle=vehicle, **line) for vehicle in (plain, turned))
    assert other.deflection == pytest.approx(one.deflection, abs=1e-7)
    assert other.body + other.deflection == pytest.approx(one.body, abs=1e-7)
    # off the beam as well, where the jump has been taken
    assert other.contact_force == pytest.approx(one.contact_force, abs=1e-5)


def test_rigid_body_rests_on_its_axles_and_rocks() -> None:
    vehicle = beam_vehicle.rigid_body(
        1000.0, pitch_inertia=2000.0, centre=1.0, axles=[0.0, 3.0], load_stiffness=[2e5, 1e5], wheel_mass=50.0
    )
    # lever rule: two thirds in front
    assert vehicle.static_load == pytest.approx([(2000 / 3 + 50) * 9.81, (1000 / 3 + 50) * 9.81], rel=1e-12)
    front, rear = 1.0, -2.0  # of the centre
    matrix = np.array([[3e5, 2e5 * front + 1e5 * rear], [2e5 * front + 1e5 * rear, 2e5 * front**2 + 1e5 * rear**2]])
    squares = np.linalg.eigvals(np.diag([1e-3, 5e-4]) @ matrix)
    assert vehicle.natural_frequencies() == pytest.approx(np.sqrt(np.sort(squares)), rel=1e-12)
    three = beam_vehicle.rigid_body(900.0, pitch_inertia=1.0, centre=2.0, axles=[0.0, 2.0, 4.0], load_stiffness=1e5)
    assert three.static_load == pytest.approx(np.full(3, 300 * 9.81), rel=1e-12)


def test_rigid_body_on_far_axles_is_two_oscillators() -> None:
    """With pitch inertia m (d/2)^2 the ends of the body do not feel each other."""
    t = np.linspace(0.0, 1.4, 29)
    body = beam_vehicle.rigid_body(
        0.4, pitch_inertia=0.4 * 0.25**2, centre=0.25, axles=[0.0, 0.5], load_stiffness=15.0, load_damping=0.2
    )
    stretch = np.hstack([np.eye(2), -np.eye(2)])
    loose = Vehicle(
        np.diag([0.2, 0.2, 0.0, 0.0]),
        0.2 * stretch.T @ stretch,
        15.0 * stretch.T @ stretch,
        np.array([0.0, 0.5]),
        np.full(2, 0.2 * 9.81),
    )
    line = UNIT | {"speed": 1.5, "modes": 5, "tolerance": 1e-8}
    one, two = (beam.moving_vehicle(t, vehicle=vehicle, **line) for vehicle in (body, loose))
    assert one.contact_force == pytest.approx(two.contact_force, abs=1e-6)
    assert one.body @ np.array([[1.0, 1.0], [0.25, -0.25]]) == pytest.approx(two.body, abs=1e-7)


def test_crossing_is_a_history_of_what_it_says() -> None:
    """Velocity of the wheel is the rate of its deflection, contact force weight less inertia."""
    t = np.linspace(0.1, 0.3, 201)
    crossing = beam.moving_mass(t, load_mass=0.3, speed=1.5, modes=3, tolerance=1e-9, gravity=2.0, **UNIT)
    path = np.polynomial.Chebyshev.fit(t, crossing.deflection[:, 0], 25)
    assert crossing.velocity[:, 0] == pytest.approx(path.deriv()(t), abs=1e-7)
    inner = slice(20, -20)  # the fit is poor at its ends
    force = 0.3 * (2.0 - path.deriv(2)(t))
    assert crossing.contact_force[inner, 0] == pytest.approx(force[inner], abs=1e-5)
    assert crossing.place[:, 0] == pytest.approx(1.5 * t)


def test_free_vibration_after_the_exit_is_converged_too() -> None:
    line = UNIT | {"load_mass": 0.3, "load_stiffness": 30.0, "speed": 1.5}
    late = beam.moving_oscillator(1.1, **line)  # the wheel is off the beam and sees nothing
    fine = beam.moving_oscillator(1.1, modes=40, tolerance=1e-8, **line)
    w, expected = late.beam_deflection(0.5), fine.beam_deflection(0.5)
    assert w == pytest.approx(expected, abs=1e-4 * 0.3 * 9.81 / 48)
    assert late.body == pytest.approx(fine.body, rel=1e-4)


def test_slow_loads_are_refused_with_advice() -> None:
    with pytest.raises(ValueError, match="static deflection of a load as slow"):
        beam.moving_mass(1e6, load_mass=1.0, speed=1e-6, **UNIT)


def test_order_of_instants_does_not_matter() -> None:
    t = np.array([0.5, -1.0, 0.1, 0.5, 0.0, 3.0])
    line = UNIT | {"speed": 1.5, "modes": 3, "load_mass": 0.1, "tolerance": 1e-4}
    mixed, ordered = beam.moving_mass(t, **line), beam.moving_mass(np.sort(t), **line)
    assert mixed.deflection == pytest.approx(ordered.deflection[[3, 0, 2, 3, 1, 5]], abs=1e-15)
    assert mixed.contact_force[[1, 4], 0] == pytest.approx(0.981)


@pytest.mark.parametrize("load_mass", [0.0, 1e-12, 1e3])
@pytest.mark.parametrize("speed", [0.0, 1e-3, 5.0, 100.0])
def test_extremes_stay_finite(load_mass: float, speed: float) -> None:
    t = np.array([-1.0, 0.0, 0.1, 0.5, 0.9]) / max(speed, 1.0)
    crossing = beam.moving_mass(t, load_mass=load_mass, speed=speed, modes=3, tolerance=1e-3, **UNIT)
    for values in (crossing.deflection, crossing.contact_force, crossing.velocity, crossing.beam_deflection(0.4)):
        assert np.all(np.isfinite(values))
    if speed == 0.0 or load_mass == 0.0:
        assert np.all(crossing.deflection == 0.0)
        assert crossing.contact_force == pytest.approx(np.full((5, 1), load_mass * 9.81))


def test_one_mode_under_a_very_heavy_mass_goes_slowly() -> None:
    """Static limit: a crawling mass presses as its weight."""
    t = np.array([0.3, 0.5]) / 0.01
    crossing = beam.moving_mass(t, load_mass=100.0, speed=0.01, modes=1, tolerance=1e-4, gravity=1.0, **UNIT)
    static = 100.0 * 2.0 / np.pi**4 * np.sin(np.pi * np.array([0.3, 0.5])) ** 2
    assert crossing.deflection[:, 0] == pytest.approx(static, rel=0.05)  # free vibrations of the start
    assert crossing.contact_lost_at is None


@pytest.mark.parametrize(
    ("build", "said"),
    [
        (lambda: beam_vehicle.point_mass(-1.0), "^load_mass must"),
        (lambda: beam_vehicle.point_mass(1.0, gravity=math.nan), "^gravity must"),
        (lambda: beam_vehicle.oscillator(1.0, load_stiffness=0.0), "^load_stiffness must"),
        (lambda: beam_vehicle.oscillator(1.0, load_stiffness=1.0, wheel_mass=-1.0), "^wheel_mass must"),
        (lambda: beam_vehicle.row_of_forces([1.0], [0.0, 1.0]), "one length"),
        (lambda: beam_vehicle.row_of_forces([1.0], [-1.0]), "^axles must not be negative"),
        (lambda: beam_vehicle.row_of_forces([math.inf], [0.0]), "^static_load must"),
        (
            lambda: beam_vehicle.rigid_body(1.0, pitch_inertia=1.0, centre=0.0, axles=[1.0, 1.0], load_stiffness=1.0),
            "tip over",
        ),
        (
            lambda: beam_vehicle.rigid_body(
                1.0, pitch_inertia=1.0, centre=0.0, axles=[0.0, 1.0], load_stiffness=[1.0, -1.0]
            ),
            "^load_stiffness must",
        ),
        (lambda: Vehicle(np.zeros((2, 2)), np.eye(2), np.eye(2), np.zeros(1), np.ones(1)), "positive definite"),
        (lambda: Vehicle(np.eye(2), np.eye(3), np.eye(2), np.zeros(1), np.ones(1)), "^damping must be square"),
        (lambda: Vehicle(np.eye(2), np.tri(2), np.eye(2), np.zeros(1), np.ones(1)), "^damping must be symmetric"),
        (lambda: beam.moving_mass(0.1, load_mass=1.0, speed=-1.0, **UNIT), "^speed must"),
        (lambda: beam.moving_mass(math.nan, load_mass=1.0, speed=1.0, **UNIT), "^t must"),
        (lambda: beam.moving_mass(0.1, load_mass=1.0, speed=1.0, tension=-10.0, **UNIT), "buckles"),
        (lambda: beam.moving_mass(0.1, load_mass=1.0, speed=1.0, modes=0, **UNIT), "^modes must"),
        (lambda: beam.moving_mass(0.1, load_mass=1.0, speed=1.0, modes=1001, **UNIT), "^modes must"),
        (lambda: beam.moving_mass(0.6, load_mass=1.0, speed=1.0, tolerance=0.0, **UNIT), "^tolerance must"),
    ],
)
def test_nonsense_is_refused(build: object, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        build()  # type: ignore[operator]
