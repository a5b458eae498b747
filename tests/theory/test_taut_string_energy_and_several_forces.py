"""Energy of the string under a moving force, and several forces by superposition."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ropewalk.theory import string

UNIT = {"length": 1.0, "tension": 1.0, "mass": 1.0}
STRING = {"length": 1.7, "tension": 8.0, "mass": 2.0}  # wave speed 2


def work(alpha: float, t: float) -> float:
    """Integral of F times the mean velocity under the force, constant between the meetings with reflected waves."""
    meetings = [2.0 * k / abs(1.0 + sign * alpha) for k in range(1, 200) for sign in (-1.0, 1.0)]
    ends = np.unique([0.0, t, *(m for m in meetings if m < t)])
    middle = 0.5 * (ends[1:] + ends[:-1])
    return float(np.diff(ends) @ string.moving_force_velocity(alpha * middle, middle, force=1.0, speed=alpha, **UNIT))


@settings(deadline=None)
@given(st.floats(0.03, 4.0), st.floats(0.01, 0.99))
def test_energy_is_the_work_done(alpha: float, progress: float) -> None:
    assume(abs(alpha - 1.0) > 1e-3)
    t = progress / alpha
    stored = string.moving_force_energy(t, force=1.0, speed=alpha, **UNIT)
    # rounding of the breaks, magnified by the squared slopes
    assert stored == pytest.approx(work(alpha, t), abs=1e-13 * t / (1.0 - alpha) ** 2)


def test_energy_before_the_first_reflection_and_after_the_exit() -> None:
    def energy(t: np.ndarray | float, alpha: float) -> np.ndarray:
        return string.moving_force_energy(t, force=3.0, speed=2.0 * alpha, **STRING)

    t = np.array([0.1, 0.4, 0.8])
    below = 9.0 / 8.0 * 0.6 / (2.0 * (1.0 - 0.36)) * 2.0 * t  # F^2 V t / (2 P (1 - alpha^2))
    assert energy(t, 0.6) == pytest.approx(below, rel=1e-13)  # roundings
    above = 9.0 / 8.0 * 1.5 / (2.0 * (1.5**2 - 1.0)) * 2.0 * t[:2]
    assert energy(t[:2], 1.5) == pytest.approx(above, rel=1e-13)
    late = energy(np.array([1.7 / 1.2 + 1e-9, 2.0, 17.3]), 0.6)
    assert late == pytest.approx(np.full(3, late[0]), rel=1e-7)  # the first is 1e-9 s late
    assert np.all(energy(np.array([-1.0, 0.0]), 0.6) == 0.0)
    assert energy(3.0, 0.0) == 0.0


def test_energy_at_the_wave_speed_is_refused_as_infinite() -> None:
    with pytest.raises(ValueError, match="energy is infinite"):
        string.moving_force_energy(0.3, force=1.0, speed=2.0, **STRING)


def test_several_forces_are_the_sum_of_each() -> None:
    x, t = np.linspace(0.0, 1.7, 7), np.linspace(-1.0, 5.0, 11)[:, np.newaxis]
    together = string.moving_forces(
        x, t, forces=[3.0, -1.0, 2.0], speeds=[0.7, 2.0, 3.0], entries=[0.0, 0.5, -0.8], **STRING
    )
    one_by_one = (
        string.moving_force(x, t, force=3.0, speed=0.7, **STRING)
        + string.moving_force(x, t - 0.5, force=-1.0, speed=2.0, **STRING)
        + string.moving_force(x, t + 0.8, force=2.0, speed=3.0, **STRING)
    )
    assert together.shape == (11, 7)
    assert np.max(np.abs(together - one_by_one)) < 1e-15  # roundings of the sum


def test_two_opposite_forces_together_cancel_and_one_load_broadcasts() -> None:
    x, t = np.linspace(0.0, 1.7, 7), 0.9
    nothing = string.moving_forces(x, t, forces=[2.0, -2.0], speeds=1.1, entries=0.2, **STRING)
    assert np.all(nothing == 0.0)
    single = string.moving_forces(x, t, forces=2.0, speeds=1.1, entries=0.2, **STRING)
    assert np.max(np.abs(single - string.moving_force(x, 0.7, force=2.0, speed=1.1, **STRING))) < 1e-15


def test_many_close_forces_tend_to_one_of_their_sum() -> None:
    x, t = 0.6, 1.3
    axles = string.moving_forces(x, t, forces=np.full(5, 0.2), speeds=0.6, entries=1e-6 * np.arange(5), **UNIT)
    assert axles == pytest.approx(float(string.moving_force(x, t, force=1.0, speed=0.6, **UNIT)), abs=1e-5)


def test_wrong_load_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^speed must"):
        string.moving_forces(0.5, 0.5, forces=1.0, speeds=[1.0, -1.0], entries=0.0, **STRING)
