"""The table of samples has one row for each instant sampled within the run."""

from __future__ import annotations

import numpy as np
import pytest

import ropewalk
from ropewalk.results import tables
from ropewalk.scenario import loads

LINE = """
overhead_lines: {line: {spans: {count: 4, length: 50}, element: 2, analysed_spans: [2, 3]}}
loads: {p: {kind: pantograph, on: line, model: en50318-2002, travel: {speed: 20, from: 10}}}
run: {kind: dynamic, geometry: linearised, until: UNTIL, every: 0.02}
"""


@pytest.mark.parametrize("until", [0.06, 0.05])  # the last interval is whole, or cut short
def test_samples_lie_within_the_run_and_have_values(until):
    samples = tables(ropewalk.simulate(loads(LINE.replace("UNTIL", str(until)))))["samples"]
    instants = samples.index.to_numpy()
    assert instants.min() >= 0.0
    assert until - 0.0011 < instants.max() <= until  # samples are 1 ms apart
    assert np.all(np.diff(instants) > 0.0)
    assert not samples.isna().all(axis=1).any()
