"""Balance to the side: the gait on still ground, and what a deck that sways feels on average."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

from closed_forms import lateral_steps
from ropewalk.theory import lateral_balance

# Macdonald's person: the equivalent pendulum, the margin, 1.8 steps a second.
HIM = {"margin": 0.0157, "leg_length": 1.17}
STEP = 0.5 / 0.9
MASS = 70.0
RATE = np.sqrt(9.81 / 1.17)


def test_the_gait_on_still_ground_is_that_of_lateral_walk() -> None:
    t = np.linspace(0.0, 2.0 * STEP, 4001)[:-1]
    walk = lateral_steps.lateral_walk(t, mass=MASS, step_time=STEP, **HIM)
    assert lateral_steps.peak_force(mass=MASS, step_time=STEP, **HIM) == pytest.approx(walk.force.max(), rel=1e-12)
    assert walk.force.mean() == pytest.approx(0.0, abs=1e-9)  # N


def still(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.zeros_like(t), np.zeros_like(t)


def test_a_walk_step_by_step_on_a_still_deck_is_the_closed_form() -> None:
    t = np.linspace(0.0, 9.9 * STEP, 300)
    start = {"position": 0.02, "velocity": -0.05}
    landings = np.arange(10) * STEP
    walk = lateral_steps.deck_walk(t, still, mass=MASS, landings=landings, side=-1, **HIM, **start)
    exact = lateral_steps.lateral_walk(t, mass=MASS, step_time=STEP, side=-1, **HIM, **start)
    # 5 times the rounding in each of ten steps
    assert walk.position == pytest.approx(exact.position, abs=1e-8)
    assert walk.velocity == pytest.approx(exact.velocity, abs=1e-8)
    assert walk.force == pytest.approx(exact.force, abs=1e-5)


def test_on_a_deck_in_uniform_motion_one_walks_as_on_still_ground() -> None:
    t = np.linspace(0.0, 9.9 * STEP, 100)
    start = {"position": 0.02, "velocity": -0.05}
    arguments = {"mass": MASS, "landings": np.arange(10) * STEP, **HIM}
    walk = lateral_steps.deck_walk(t, still, **arguments, **start)
    faster = {"position": 0.52, "velocity": 0.15}
    moved = lateral_steps.deck_walk(t, lambda s: (0.5 + 0.2 * s, 0.2 + 0.0 * s), **arguments, **faster)
    assert moved.position - 0.5 - 0.2 * t == pytest.approx(walk.position, abs=1e-8)
    assert moved.feet == pytest.approx(walk.feet, abs=1e-8)


@pytest.mark.parametrize("frequency", [0.23, 0.5, 0.77, 1.03, 1.45, 2.6])
def test_the_mean_force_in_phase_with_a_swaying_deck_is_the_closed_form(frequency: float) -> None:
    w, amplitude = 2.0 * np.pi * frequency, 0.01
    steps, fine = 200, 16
    at, weights = np.polynomial.legendre.leggauss(fine)
    landings = np.arange(steps) * STEP
    t = (landings[:, None] + 0.5 * STEP * (1.0 + at)).ravel()
    walk = lateral_steps.deck_walk(
        t, lambda s: (amplitude * np.sin(w * s), amplitude * w * np.cos(w * s)), mass=MASS, landings=landings,
        position=0.0, velocity=0.1, **HIM,
    )  # fmt: skip
    gait_alone = lateral_steps.lateral_walk(t, mass=MASS, step_time=STEP, **HIM).force
    # A window that begins and ends flat, so that what is left of other frequencies falls with its length.
    window = np.sin(np.pi * t / (steps * STEP)) ** 4 * np.tile(weights, steps)
    force = walk.force - gait_alone
    velocity, place = amplitude * w * np.cos(w * t), amplitude * np.sin(w * t)
    driving = (window * force * velocity).sum() / (window * velocity**2).sum()
    added = (window * force * place).sum() / (window * place**2).sum() / w**2
    damping, mass = lateral_balance.self_excited_force(frequency, mass=MASS, step_time=STEP, leg_length=1.17)
    print(frequency, driving, damping, added, mass)
    assert driving == pytest.approx(damping, abs=1e-4)  # N s/m: what the window lets through after 200 steps
    assert added == pytest.approx(mass, abs=1e-4)  # kg


def test_walkers_drive_a_bridge_at_one_hertz_and_damp_one_at_a_half() -> None:
    damping, mass = lateral_balance.self_excited_force([0.5, 1.0], mass=MASS, step_time=STEP, leg_length=1.17)
    print(damping, mass)
    assert damping[0] < -50.0
    assert 100.0 < damping[1] < 300.0  # N s/m; about 300 on the Millennium Bridge (Dallard et al., 2001)
    slow, carried = lateral_balance.self_excited_force(1e-4, mass=MASS, step_time=STEP, leg_length=1.17)
    assert abs(slow) < 1e-3
    assert carried == pytest.approx(MASS, rel=1e-3)  # a deck that moves slowly takes people along
    fast, free = lateral_balance.self_excited_force(1e3, mass=MASS, step_time=STEP, leg_length=1.17)
    assert abs(free) < 1e-3 * MASS  # under a fast one they stay where they are
    assert abs(fast) < 1.0


def followed(number: int, *, frequency: float, damping_rate: float, modal_mass: float, until: float) -> float:
    """Growth rate of a deck under people alike, in step one after another, 1/s: exact from landing to landing."""
    omega, rate, size = 2.0 * np.pi * frequency, np.sqrt(9.81 / 1.17), 2 + 2 * number
    k = MASS * rate**2
    A, foot = np.zeros((size + number, size + number)), slice(size, None)  # deck, bodies, offsets of feet
    A[0, 1] = 1.0
    A[1, :2] = -(omega**2) + number * k / modal_mass, -damping_rate
    A[1, foot] = k / modal_mass
    for i in range(number):
        y, u = 2 + 2 * i, size + i
        A[y, y + 1], A[1, y] = 1.0, -k / modal_mass
        A[y + 1, [y, 0, u]] = rate**2, -(rate**2), -(rate**2)
    on, z = scipy.linalg.expm(A * STEP / number), np.zeros(size + number)
    z[0], logs = 1.0, []
    for n in range(round(until / STEP * number)):
        y, u = 2 + 2 * (n % number), size + n % number
        z[u] = z[y] - z[0] + (z[y + 1] - z[1]) / rate
        z = on @ z
        logs.append(0.5 * np.log(z[0] ** 2 + (z[1] / omega) ** 2))
    half = len(logs) // 4
    return float(np.polyfit(np.arange(half, len(logs)) * STEP / number, logs[half:], 1)[0])


@pytest.mark.parametrize("frequency", [0.6, 1.1, 1.4])
def test_a_crowd_beyond_the_critical_number_makes_a_deck_sway_more_and_more(frequency: float) -> None:
    keys = {"damping_rate": 0.06, "modal_mass": 5000.0}
    one = {"mass": MASS, "step_time": STEP, "leg_length": 1.17}
    drive = float(lateral_balance.self_excited_force(frequency, **one)[0])
    for number in (3, 12):
        every = {**one, "mass": np.full(number, MASS)}
        root = lateral_balance.sway_growth(frequency, share=1.0, **keys, **every)
        seen = followed(number, frequency=frequency, until=120.0, **keys)
        print(frequency, number, root, seen)
        # Landings are not spread evenly, but one after another: second order in what a person drives.
        assert root.real == pytest.approx(seen, abs=5e-4)
    if drive > 0.0:
        ratio = 0.06 / (4.0 * np.pi * frequency)
        critical = lateral_balance.critical_number(frequency, ratio, 5000.0, drive, share=1.0)
        root = lateral_balance.sway_growth(frequency, share=critical, **keys, **one)
        assert abs(root.real) < 2e-3  # the people change the frequency a little, too
        assert lateral_balance.critical_number(1.0, 0.01, 1e4, 300.0) == pytest.approx(8.0 * np.pi * 0.01 * 1e4 / 300.0)
    else:
        assert lateral_balance.sway_growth(frequency, share=10.0, **keys, **one).real < -0.035


def test_nonsense_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^drive must"):
        lateral_balance.critical_number(1.0, 0.01, 1e4, 0.0)
    with pytest.raises(ValueError, match=r"^step_time must"):
        lateral_balance.sway_growth(1.0, damping_rate=0.1, modal_mass=1e4, mass=70.0, step_time=0.0, leg_length=1.17)
    with pytest.raises(ValueError, match=r"^frequency must"):
        lateral_balance.self_excited_force(0.0, mass=MASS, step_time=STEP, leg_length=1.17)
    with pytest.raises(ValueError, match=r"^mass must"):
        lateral_steps.peak_force(mass=-1.0, step_time=STEP, **HIM)
    arguments = {"mass": MASS, "position": 0.0, "velocity": 0.0, **HIM}
    with pytest.raises(ValueError, match=r"^landings must rise"):
        lateral_steps.deck_walk(1.0, still, landings=[0.0, 0.0], **arguments)
    with pytest.raises(ValueError, match=r"^t must not lie before"):
        lateral_steps.deck_walk(-1.0, still, landings=[0.0, 0.5], **arguments)
