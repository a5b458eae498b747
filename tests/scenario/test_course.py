"""The exact course of a travel against fine summation."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from ropewalk.model import SpeedTable
from ropewalk.model.course import between, course, first_at_most, place_at

speeds = st.floats(-5, 5).map(lambda v: round(v, 3))
times = st.floats(-1, 4).map(lambda t: round(t, 3))
tables = st.lists(st.tuples(times, speeds), min_size=1, max_size=5).map(
    lambda knots: SpeedTable(time=tuple(sorted(t for t, _ in knots)), value=tuple(v for _, v in knots))
)
UNTIL = 3.0


def summed(table: SpeedTable, start: float) -> tuple[np.ndarray, np.ndarray]:
    """Place by the trapezoidal rule between all knots and a fine grid."""
    grid = np.linspace(0.0, UNTIL, 30_001)
    middle = 0.5 * (grid[1:] + grid[:-1])
    steps = np.interp(middle, table.time, table.value) * np.diff(grid)
    return grid, start + np.concatenate([[0.0], np.cumsum(steps)])


@given(tables, st.floats(0, 5))
def test_the_place_is_the_integral_of_the_speed(table: SpeedTable, start: float) -> None:
    assume(len(set(table.time)) == len(table.time) or len(table.time) == 1)
    grid, place = summed(table, start)
    segments = course(table, start, UNTIL)
    for index in (0, 7_000, 15_000, 30_000):
        # the midpoint sum errs by at most a kink per knot: 5 knots, 10 m/s, (0.1 ms)
        assert place_at(segments, grid[index]) == pytest.approx(place[index], abs=5e-3)


@given(tables, st.floats(0, 5))
def test_the_first_time_below_a_level_is_the_first(table: SpeedTable, start: float) -> None:
    level = start - 1.0
    segments = course(table, start, UNTIL)
    time = first_at_most(segments, level)
    before = [place_at(segments, t) for t in np.linspace(0.0, UNTIL if time is None else time, 200)]
    assert min(before[:-1]) > level - 1e-9
    if time is not None:
        assert place_at(segments, time) == pytest.approx(level, abs=1e-6)


@given(tables, tables)
def test_the_distance_of_two_courses_is_the_difference_of_their_places(one: SpeedTable, two: SpeedTable) -> None:
    a, b = course(one, 2.0, UNTIL), course(two, 1.0, UNTIL)
    for time in (0.0, 0.6, 1.7, UNTIL):
        expected = place_at(a, time) - place_at(b, time)
        assert place_at(between(a, b), time) == pytest.approx(expected, abs=1e-9)


def test_equal_times_make_a_jump_of_the_speed() -> None:
    segments = course(SpeedTable(time=(1, 1), value=(1, 3)), 0.0, 2.0)
    assert place_at(segments, 1.0) == 1.0
    assert place_at(segments, 2.0) == 4.0
