"""A motion that is computed in portions, as those of very many links are: a million links take one step in a call."""

from __future__ import annotations

import numpy as np
import pytest

import ropewalk
from ropewalk.scenario import loads
from ropewalk.solve import motion

TEXT = """
lines: {rope: {start: [0, 0], end: [19.5, 0], length: 20, mass: 1, axial_stiffness: 1e5, axial_damping: 5, elements: 8}}
loads: {one: {kind: %s, on: rope, travel: {speed: 5, from: 2.3 m}}}
run: {kind: dynamic, until: 40 ms, every: 2 ms, step: 0.5 ms}
"""


@pytest.mark.parametrize("load", ["force, force: [0, -300]", "mass, mass: 30"])
@pytest.mark.parametrize("steps", [1, 3, 4, 5])
def test_it_comes_to_its_end_whether_or_not_an_instant_is_that_of_a_portion(load, steps, monkeypatch):
    """Four steps lead to each instant."""
    scenario = loads(TEXT % load)
    whole = ropewalk.simulate(scenario)
    monkeypatch.setattr(motion, "_portion", lambda choice, state: steps)
    found = ropewalk.simulate(scenario)
    assert found.attrs["outcome"] == whole.attrs["outcome"]
    assert found.sizes["time"] == 21
    # The same steps; where a portion ends, what dampers take the next velocities for is guessed anew. Seen 1e-8 m.
    np.testing.assert_allclose(found["position"], whole["position"], rtol=0, atol=1e-7)
