"""Several forces on a string by superposition."""

import numpy as np
import pytest

from closed_forms import strings
from ropewalk.theory import string

UNIT = {"length": 1.0, "tension": 1.0, "mass": 1.0}
STRING = {"length": 1.7, "tension": 8.0, "mass": 2.0}  # wave speed 2


def test_several_forces_are_the_sum_of_each() -> None:
    x, t = np.linspace(0.0, 1.7, 7), np.linspace(-1.0, 5.0, 11)[:, np.newaxis]
    together = strings.moving_forces(
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
    nothing = strings.moving_forces(x, t, forces=[2.0, -2.0], speeds=1.1, entries=0.2, **STRING)
    assert np.all(nothing == 0.0)
    single = strings.moving_forces(x, t, forces=2.0, speeds=1.1, entries=0.2, **STRING)
    assert np.max(np.abs(single - string.moving_force(x, 0.7, force=2.0, speed=1.1, **STRING))) < 1e-15


def test_many_close_forces_tend_to_one_of_their_sum() -> None:
    x, t = 0.6, 1.3
    axles = strings.moving_forces(x, t, forces=np.full(5, 0.2), speeds=0.6, entries=1e-6 * np.arange(5), **UNIT)
    assert axles == pytest.approx(float(string.moving_force(x, t, force=1.0, speed=0.6, **UNIT)), abs=1e-5)


def test_wrong_load_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^speed must"):
        strings.moving_forces(0.5, 0.5, forces=1.0, speeds=[1.0, -1.0], entries=0.0, **STRING)
