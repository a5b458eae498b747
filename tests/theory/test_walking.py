"""Walking: Bachmann's and Young's harmonics, Geyer, Seyfarth and Blickhan 2006, and Hof's balance to the side."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from closed_forms import lateral_steps, spring_legs
from ropewalk.theory import gait

G = 80.0 * 9.81
LEGS = spring_legs.SpringLegs(mass=80.0, leg_length=1.0, stiffness=14e3, attack_angle=math.radians(69.0))
LATERAL = {"margin": 0.0157, "step_time": 0.5 / 0.9, "leg_length": 1.17}


def test_bachmanns_factors() -> None:
    for frequency, first in ((2.0, 0.4), (2.2, 0.45), (2.4, 0.5)):
        force = gait.bachmann(weight=700.0, step_frequency=frequency)
        assert force.factors == pytest.approx((first, 0.1, 0.1), rel=1e-14)
    assert force.phases == (0.0, math.pi / 2, math.pi / 2)
    # t = 0: sin(-pi/2) twice; a quarter of a step later sin(pi/2), sin(pi/2), sin(pi)
    assert force.total([0.0, 0.25 / 2.4]) == pytest.approx([700 * 0.8, 700 * 1.6], rel=1e-14)


def test_youngs_factors() -> None:
    assert gait.young(weight=1.0, step_frequency=2.0).factors == pytest.approx(
        (0.4305, 0.0914, 0.0714, 0.065), rel=1e-14
    )
    assert gait.young(weight=1.0, step_frequency=2.4).factors[0] == 0.56
    assert gait.young(weight=1.0, step_frequency=1.0).factors[0] == pytest.approx(0.0205)


@given(frequency=st.floats(1.0, 2.8), phases=st.tuples(*[st.floats(-3.0, 3.0)] * 4))
def test_total_has_the_harmonics_it_is_made_of(frequency: float, phases: tuple[float, ...]) -> None:
    force = gait.young(weight=G, step_frequency=frequency, phases=phases)
    samples = force.total(np.arange(16) / (16 * frequency)) / G
    series = np.fft.rfft(samples) / 16
    assert series[0].real == pytest.approx(1.0, rel=1e-14)
    for order, (factor, phase) in enumerate(zip(force.factors, phases, strict=True), start=1):
        assert 2j * series[order] == pytest.approx(factor * np.exp(-1j * phase), abs=1e-14)
    assert np.abs(series[5:]) == pytest.approx(0.0, abs=1e-14)


@given(
    frequency=st.floats(2.0, 2.4),
    overlap=st.floats(0.0, 1.0),
    landing=st.none() | st.floats(-1.0, 1.0),
    begin=st.floats(-5.0, 5.0),
)
def test_feet_together_give_the_total(frequency: float, overlap: float, landing: float | None, begin: float) -> None:
    force = gait.bachmann(weight=G, step_frequency=frequency)
    t = begin + np.linspace(0.0, 2.0, 83)
    steps = np.arange(-20, 25)[:, np.newaxis]
    feet = force.foot(t, steps, overlap=overlap, landing=landing)
    assert feet.sum(axis=0) == pytest.approx(force.total(t), rel=1e-14)
    assert np.all(feet >= 0.0)
    assert np.max(np.sum(feet > 0.0, axis=0)) <= 2
    # the next foot does the same one step later
    later = force.foot(t + 1.0 / frequency, steps + 1, overlap=overlap, landing=landing)
    if overlap > 0.01:  # without an overlap the force jumps, and rounding says when
        assert later == pytest.approx(feet, abs=1e-10 * G)


def test_a_foot_stands_for_one_step_and_the_overlap() -> None:
    force, overlap, landing = gait.bachmann(weight=G, step_frequency=2.0), 0.3, 0.1
    leaves = landing + (1.0 + overlap) / 2.0
    t = [landing - 1e-9, landing + 1e-3, landing + 0.075, landing + 0.3, leaves - 1e-3, leaves + 1e-9]
    found = force.foot(t, 0, overlap=overlap, landing=landing) / force.total(t)
    assert found[[0, 5]].tolist() == [0.0, 0.0]
    assert found[2:4] == pytest.approx([0.5, 1.0], rel=1e-12)  # half of the overlap, alone
    assert found[1] == pytest.approx(found[4], rel=1e-9)
    assert 0.0 < found[1] < 1e-3
    # by default the crest of the first harmonic is where both feet carry half
    assert force.foot(0.125, [0, -1], overlap=overlap) == pytest.approx([0.5 * force.total(0.125)] * 2, rel=1e-12)
    assert force.foot([0.1249, 0.1251], 0, overlap=0.0).tolist() == [0.0, force.total(0.1251)]


@pytest.fixture(scope="module")
def steady() -> spring_legs.Gait:
    (found,) = spring_legs.gaits(LEGS, energy=816.0)
    return found


def test_gait_is_that_of_the_catalogue(steady: spring_legs.Gait) -> None:
    # half a unit of the last digit printed
    assert steady.height == pytest.approx(0.9708346674, abs=0.6e-10)
    assert steady.speed == pytest.approx(1.0969803625, abs=0.6e-10)
    assert steady.step_time == pytest.approx(0.4445327, abs=0.5e-7)
    assert steady.step_length == pytest.approx(0.5142361, abs=0.5e-7)
    # printed as the quotient of the two rounded numbers
    assert steady.mean_speed == pytest.approx(1.1568016, abs=1e-7)
    assert steady.largest_force / G == pytest.approx(1.864, abs=5e-4)
    assert np.abs(steady.multipliers) == pytest.approx([0.978, 0.978], abs=5e-4)
    assert LEGS.energy(steady.height, steady.speed) == pytest.approx(816.0, rel=1e-14)


def test_gait_walks_on_with_energy_impulse_and_symmetry(steady: spring_legs.Gait) -> None:
    t = np.linspace(0.0, 4 * steady.step_time, 8001)
    walk = spring_legs.walk(t, LEGS, height=steady.height, speed=steady.speed)
    assert np.diff(walk.feet[:5]) == pytest.approx(steady.step_length, rel=1e-8)
    assert np.diff(walk.upright[:5]) == pytest.approx(steady.step_time, rel=1e-8)
    assert walk.x[-1] == pytest.approx(4 * steady.step_length, rel=1e-8)
    # mirrored about the upright leg
    assert walk.y == pytest.approx(walk.y[::-1], abs=1e-7)
    assert walk.x + walk.x[::-1] == pytest.approx(walk.x[-1], abs=1e-7)
    # springs: energy from the forces' lengths
    stored = np.sum(np.sum(walk.forces**2, axis=2), axis=1) / (2 * LEGS.stiffness)
    kinetic = 40.0 * (walk.x_velocity**2 + walk.y_velocity**2)
    assert kinetic + stored + G * walk.y == pytest.approx(816.0, rel=1e-10)
    # impulses, by the trapezoidal rule with steps of 2e-4 s
    total = walk.forces.sum(axis=1)
    assert np.trapezoid(total[:, 1], t) / t[-1] == pytest.approx(G, rel=1e-6)
    assert np.trapezoid(total[:, 0], t) == pytest.approx(0.0, abs=1e-3)
    assert total[:, 1].max() == pytest.approx(steady.largest_force, rel=1e-6)
    # who stands when
    for foot in range(1, 4):
        on = (t > walk.landings[foot]) & (t < walk.departures[foot])
        assert np.all(walk.forces[on, foot, 1] > 0.0)
        assert np.all(walk.forces[~on, foot] == 0.0)
    assert np.all(walk.landings[1:5] < walk.departures[:4])


def test_a_plain_walker_of_small_steps_does_the_same(steady: spring_legs.Gait) -> None:
    """Velocity Verlet at 10 microseconds from the rules alone: a leg lands at its angle and never pulls."""
    dt, mass = 1e-5, LEGS.mass
    x, y, vx, vy = 0.0, steady.height, steady.speed, 0.0
    feet, air = [0.0], LEGS.leg_length * math.cos(LEGS.attack_angle)

    def push() -> tuple[float, float]:
        ax, ay = 0.0, -9.81
        for foot in feet:
            length = math.hypot(x - foot, y)
            force = LEGS.stiffness * max(0.0, LEGS.leg_length / length - 1.0) / mass
            ax, ay = ax + force * (x - foot), ay + force * y
        return ax, ay

    landing = departure = 0.0
    steps = round(steady.step_time / dt)
    ax, ay = push()
    for step in range(steps):
        vx, vy = vx + 0.5 * dt * ax, vy + 0.5 * dt * ay
        x, y = x + dt * vx, y + dt * vy
        if len(feet) == 1 and vy < 0.0 and y < LEGS.landing_height:
            feet.append(x + air)
            landing = step * dt
        if len(feet) == 2 and not departure and math.hypot(x, y) > LEGS.leg_length:
            departure = step * dt
        ax, ay = push()
        vx, vy = vx + 0.5 * dt * ax, vy + 0.5 * dt * ay
    walk = spring_legs.walk([steps * dt], LEGS, height=steady.height, speed=steady.speed)
    # events are late by up to a step of 1e-5 s, of 1 m/s and 10 m/s^2
    assert [x, y, vx] == pytest.approx([walk.x[0], walk.y[0], walk.x_velocity[0]], abs=2e-5)
    assert vy == pytest.approx(walk.y_velocity[0], abs=2e-4)
    assert [landing, departure] == pytest.approx([walk.landings[1], walk.departures[0]], abs=3e-5)
    assert feet[1] == pytest.approx(walk.feet[1], abs=2e-5)


def test_multipliers_are_those_of_a_disturbed_walk(steady: spring_legs.Gait) -> None:
    """Heights and climbs of ten steps after a push of 1 mm/s obey a linear map with these eigenvalues."""
    height, energy = steady.height, 816.0
    rise = 1e-3
    first = spring_legs.walk([4.0], LEGS, height=height, speed=LEGS.speed(energy, height, rise), rise=rise)
    again = spring_legs.walk(first.upright, LEGS, height=height, speed=LEGS.speed(energy, height, rise), rise=rise)
    states = np.stack([again.y - height, again.y_velocity])[:, : len(first.upright) - 1]
    matrix = np.linalg.lstsq(states[:, :-1].T, states[:, 1:].T, rcond=None)[0].T
    found = np.sort_complex(np.linalg.eigvals(matrix))
    assert found == pytest.approx(np.sort_complex(steady.multipliers), abs=2e-3)  # next order in 1 mm/s
    # 0.978^8: the disturbance dies out
    assert np.abs(steady.multipliers[0]) < 1.0


def test_walkers_that_cannot_walk_say_why(steady: spring_legs.Gait) -> None:
    for speed, word in ((0.2, "thrown off the new leg"), (2.5, "upright at t = ")):
        with pytest.raises(ValueError, match=word):
            spring_legs.walk([2.0], LEGS, height=steady.height, speed=speed)
    with pytest.raises(ValueError, match="turns back"):
        spring_legs.walk([3.0], LEGS, height=0.95, speed=0.2)
    with pytest.raises(ValueError, match="takes off"):
        spring_legs.walk([1.0], LEGS, height=0.9999, speed=2.0, rise=0.5)
    with pytest.raises(ValueError, match=r"must move forwards"):
        spring_legs.walk([1.0], LEGS, height=0.9, speed=1.0)
    assert spring_legs.gaits(LEGS, energy=100.0) == ()
    with pytest.raises(ValueError, match="too little"):
        LEGS.speed(100.0, 0.97)


def test_step_width_is_that_of_the_catalogue() -> None:
    # f = 0.9 strides per second, two steps each; 15 digits are given
    assert lateral_steps.step_width(**LATERAL) == pytest.approx(0.0941403536091502, abs=1e-16)


@pytest.mark.parametrize(("start", "side"), [((None, None), 1), ((None, None), -1), ((0.02, -0.05), 1)])
def test_balance_to_the_side_is_that_of_the_integrated_pendulum(start, side) -> None:
    position, velocity = start
    lateral = {"margin": 0.0157, "leg_length": 1.17}
    t = np.linspace(0.0, 7.0 * LATERAL["step_time"] - 1e-9, 141)
    walk = lateral_steps.lateral_walk(t, mass=80.0, side=side, position=position, velocity=velocity, **LATERAL)
    state = np.array([walk.position[0], walk.velocity[0]])
    if position is not None:
        assert state == pytest.approx([position, velocity], rel=1e-12)
    square, feet = 9.81 / 1.17, []
    for step in range(7):
        foot = float(lateral_steps.foot_place(position=state[0], velocity=state[1], side=side, **lateral))
        feet.append(foot)
        begin, end = step * LATERAL["step_time"], (step + 1) * LATERAL["step_time"]
        inside = (t >= begin) & (t < end - 1e-10)
        ode = solve_ivp(
            lambda _, s, foot=foot: [s[1], square * (s[0] - foot)],
            (begin, end), state, t_eval=np.append(t[inside], end), rtol=1e-11, atol=1e-13, method="DOP853",
        )  # fmt: skip
        # e^1.6 for each step on the integration's 1e-13
        assert walk.position[inside] == pytest.approx(ode.y[0, :-1], abs=1e-9)
        assert walk.velocity[inside] == pytest.approx(ode.y[1, :-1], abs=1e-9)
        assert walk.force[inside] == pytest.approx(80.0 * square * (foot - ode.y[0, :-1]), abs=1e-6)
        state, side = ode.y[:, -1], -side
    assert walk.feet == pytest.approx(feet, abs=1e-9)
    assert np.abs(np.diff(walk.feet)) == pytest.approx(float(lateral_steps.step_width(**LATERAL)), rel=1e-12)
    if position is None:
        assert walk.feet[0] == pytest.approx(-walk.feet[1], rel=1e-12)
        assert np.abs(walk.position).max() < 0.5 * float(lateral_steps.step_width(**LATERAL))


def test_nonsense_is_refused() -> None:
    for frequency in (1.9, 2.5):
        with pytest.raises(ValueError, match=r"^step_frequency must"):
            gait.bachmann(weight=G, step_frequency=frequency)
    with pytest.raises(ValueError, match=r"^step_frequency must"):
        gait.young(weight=G, step_frequency=2.9)
    with pytest.raises(ValueError, match=r"^phases must be as many"):
        gait.WalkingForce(G, 2.0, (0.4, 0.1), (0.0,))
    with pytest.raises(ValueError, match=r"^overlap must"):
        gait.bachmann(weight=G, step_frequency=2.0).foot(0.0, 0, overlap=1.1)
    with pytest.raises(ValueError, match=r"^attack_angle must"):
        spring_legs.SpringLegs(80.0, 1.0, 14e3, 69.0)
    for name in LATERAL:
        with pytest.raises(ValueError, match=f"^{name} must"):
            lateral_steps.lateral_walk(1.0, mass=80.0, **(LATERAL | {name: -1.0}))
        with pytest.raises(ValueError, match=f"^{name} must"):
            lateral_steps.step_width(**(LATERAL | {name: -1.0}))
    with pytest.raises(ValueError, match=r"^side must"):
        lateral_steps.foot_place(position=0.0, velocity=0.0, side=0, margin=0.01, leg_length=1.0)
