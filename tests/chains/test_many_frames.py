"""Frames of many instants at once are those of each instant by itself."""

from __future__ import annotations

import numpy as np
import pytest

import ropewalk
from ropewalk.chains.frames import ChainFrameBuilder
from ropewalk.scenario import loads

TEXT = """
lines:
  one: {start: [0, 0], end: [19.5, 0], length: 20, mass: 1, axial_stiffness: 1e5, axial_damping: 50, drag: 0.1 Hz,
    elements: 12}
  two: {start: [0, 0], end: [19.5, 1], length: 20, mass: 1, axial_stiffness: 1e5, axial_damping: 5, elements: 7}
loads:
  goes: {kind: force, on: one, force: [0, -800], travel: {speed: 12, from: 10, at_end: leave}}
  comes: {kind: force, on: one, force: {time: [0 s, 2 s], value: [[0, 0], [0, 300]]}, travel: {speed: -5, from: 8,
    at_end: leave}}
  slips: {kind: force, on: two, force: [3, -80], contact: CONTACT, travel: {speed: 12, from: 2, at_end: leave}}
run: {kind: dynamic, until: 1.9 s, every: 20 ms}
"""


@pytest.mark.parametrize("contact", ["clamped", "frictionless"])
def test_frames_at_once_are_those_of_each_instant(contact, monkeypatch):
    """Loads ride on nodes, share links, stand on supports, have left: to rounding, with sums in another order."""
    scenario = loads(TEXT.replace("CONTACT", contact))
    together = ropewalk.simulate(scenario)
    begin = ChainFrameBuilder.__init__

    def one_by_one(self, *arguments):
        begin(self, *arguments)
        assert self.together
        self.together = False

    monkeypatch.setattr(ChainFrameBuilder, "__init__", one_by_one)
    apart = ropewalk.simulate(scenario)
    assert np.isnan(apart["contact_force"]).any()
    assert (apart["contact_state"] > 0).any()
    for name in apart.data_vars:
        scale = float(np.nanmax(np.abs(apart[name]))) if apart[name].size else 0.0
        np.testing.assert_allclose(together[name], apart[name], rtol=1e-9, atol=1e-12 * scale, err_msg=str(name))
    assert together.attrs["warnings"] == apart.attrs["warnings"]
