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

BODIES = """
lines:
  one: {start: [0, 0], end: [19.5, 0], length: 20, mass: 1, axial_stiffness: 1e5, axial_damping: 50, drag: 0.1 Hz,
    elements: 12}
  two: {start: [0, 0], end: [19.5, 1], length: 20, mass: 1, axial_stiffness: 1e5, axial_damping: 5, elements: 15}
  three: {start: [0, 0], end: [40, -2], length: 40, mass: 2, axial_stiffness: 1e6, axial_damping: 5, elements: 30}
loads:
  goes: {kind: mass, on: one, mass: 40, travel: {speed: 12, from: 10, at_end: leave}}
  near: {kind: mass, on: one, mass: 4, travel: {speed: 12, from: 9.6, at_end: leave}}
  comes: {kind: mass, on: one, mass: 10, lift_off: true, travel: {speed: 5, from: 2, at_end: leave}}
  swings: {kind: oscillator, on: two, mass: 30, stiffness: 4 kN/m, damping: 50, travel: {speed: 7, from: 4,
    at_end: leave}}
  rolls: {kind: mass, on: two, mass: 10, air_drag: 0.2, travel: {kind: free, speed: 3, from: 14 m, friction: 0.02}}
  car: {kind: vehicle, on: three, bodies: {box: {mass: 60, inertia: 20}}, wheels: {front: {at: 1 m}, rear: {at: -1 m,
    mass: 5}}, springs: {front: {between: [box, front], stiffness: 9 kN/m, damping: 200}, rear: {between: [box, rear],
    stiffness: 9 kN/m, damping: 200}}, travel: {speed: 12, from: 8 m, at_end: leave}, lift_off: true}
  crane: {kind: trolley, on: three, mass: 20, payload: {mass: 50, length: 3, swing: 20 deg}, travel: {kind: free,
    speed: 3, from: 30 m}}
run: {kind: dynamic, until: 1.9 s, every: 20 ms}
"""
ENDS = """
lines:
  one: {start: [0, 0], end: [19.5, 0], length: 20, mass: 1, axial_stiffness: 1e5, axial_damping: 50, drag: 0.1 Hz,
    elements: 12, start_support: {kind: elastic, stiffness: 100 kN/m, damping: 50, mass: 2, displacement: {time:
    [0, 0.1, 0.5], value: [[0, 0], [0, 0.05], [0, -0.05]]}}, end_support: {kind: moving, displacement: {time: [0, 0.5],
    value: [[0, 0], [0, 0.1]]}}}
  two: {start: [0, 0], end: [19.5, 1], length: 19.6, mass: 1, axial_stiffness: 1e5, axial_damping: 5, elements: 15,
    end_support: {kind: guided, along: [1, 0], force: 500 N, mass: 10, damping: 100}}
loads:
  goes: {kind: force, on: one, force: [0, -800], travel: {speed: 12, from: 10, at_end: leave}}
  comes: {kind: mass, on: two, mass: 30, travel: {speed: 12, from: 4, at_end: leave}}
run: {kind: dynamic, until: 1.9 s, every: 20 ms}
"""
SPACE = """
lines:
  one: {start: [0, 0, 0], end: [19.5, 0, 0], length: 20, mass: 1, axial_stiffness: 1e5, axial_damping: 50, elements: 16}
loads:
  slides: {kind: mass, on: one, mass: 40, contact: frictionless, travel: {speed: 12, from: 10, at_end: leave}}
  blown: {kind: mass, on: one, mass: 4, force: [0, 30, 0], travel: {speed: 3, from: 3, at_end: leave}}
run: {kind: dynamic, until: 1.9 s, every: 20 ms}
"""


@pytest.mark.parametrize(
    "text",
    [TEXT.replace("CONTACT", "clamped"), TEXT.replace("CONTACT", "frictionless"), BODIES, ENDS, SPACE],
    ids=["clamped", "frictionless", "bodies", "ends", "space"],
)
def test_frames_at_once_are_those_of_each_instant(text, monkeypatch):
    """Loads ride on nodes, share and divide links, stand on supports, fly, have left; ends yield and move.

    To the last bit: a run that is taken up again is to give what it would have given.
    """
    scenario = loads(text)
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
        np.testing.assert_array_equal(together[name], apart[name], err_msg=str(name))
    assert together.attrs["warnings"] == apart.attrs["warnings"]
