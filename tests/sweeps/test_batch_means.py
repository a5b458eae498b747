"""Intervals of statistics over long records."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from ropewalk.scenario import loads
from ropewalk.simulate import simulate
from ropewalk.sweeps.batch_means import half_width
from ropewalk.sweeps.quantities import measured

MEMORY = 0.95  # of x' = 0.95 x + noise: 39 values tell as much as one that is independent


def records(count: int, size: int) -> np.ndarray:
    """Stationary records of a process of the first order with a variance of one."""
    noise = np.random.default_rng(7).standard_normal((count, size + 200)) * np.sqrt(1.0 - MEMORY**2)
    return lfilter([1.0], [1.0, -MEMORY], noise, axis=1)[:, 200:]


@pytest.mark.parametrize("of", ["mean", "std"])
def test_intervals_hold_what_is_true_as_often_as_they_say(of: str) -> None:
    """250 records: 95 %, with 1.4 % of scatter, and 2 % less as batches are never quite independent. As if all values
    were independent it would be 24 %."""
    true = 0.0 if of == "mean" else 1.0
    inside, widths = [], []
    for values in records(250, 12_000):
        half = half_width(values, of)
        if half is not None:
            inside.append(abs(getattr(values, of)() - true) < half)
            widths.append(half)
    assert len(inside) > 225, "a record of 300 memories is long enough"
    assert 0.905 < np.mean(inside) < 0.98
    if of == "mean":  # 1.96 deviations of the mean, whose variance is (1 + a) / (1 - a) / n; a little more by Student
        assert np.mean(widths) == pytest.approx(1.96 * np.sqrt(39.0 / 12_000), rel=0.08)


def test_records_that_are_too_short_or_drift_have_no_interval() -> None:
    drift = np.linspace(0.0, 1.0, 5000) + 0.01 * np.random.default_rng(0).standard_normal(5000)
    assert half_width(drift) is None
    assert half_width(records(1, 5000)[0][:60]) is None
    assert half_width(np.array([1.0, np.nan] * 500)) is None
    assert half_width(np.ones(1000)) == 0.0
    short = sum(half_width(values) is None for values in records(60, 200))
    assert short > 20, "200 values are five independent ones: often that is noticed"


def test_an_interval_is_asked_for_in_words() -> None:
    text = """\
lines: {deck: {start: [0, 0], end: [20, 0], length: 20, mass: 10e3, bending_stiffness: 16e9, axial_stiffness: 1e10}}
gravity: 0
loads: {train: {kind: axles, on: deck, forces: 9e3, at: [0, 3, 9, 14], travel: {speed: 1}}}
run: {kind: linear, until: 20, every: 50 ms, modes: 2}
outputs: {places: {middle: {on: deck, at: 10}}}
"""
    with simulate(loads(text)) as result:
        names = ["mean middle.deflection", "interval of mean middle.deflection", "interval of std middle.deflection"]
        found = measured(result, names)
        assert found[names[0]][1] == found[names[1]][1] == "m"
        assert found[names[1]][0] is None, "a crossing is not stationary"
        with pytest.raises(ValueError, match="no such interval"):
            measured(result, ["interval of max middle.deflection"])
