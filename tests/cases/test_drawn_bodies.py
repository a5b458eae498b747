"""Vehicles are drawn above their wheels, and only while they are on their lines; what hangs is drawn below."""

from __future__ import annotations

import numpy as np
import pytest

import ropewalk
from ropewalk.results import figure
from ropewalk.results.drawn_bodies import drawn_bodies
from ropewalk.scenario import loads

DECK = """
lines: {deck: {start: [0, 0], end: [32, 0], length: 32, mass: 12 t/m, bending_stiffness: 90 GN*m^2,
  axial_stiffness: 20 GN, elements: 16}}
run: {kind: dynamic, geometry: linearised, until: 0.9, every: 0.02}
loads:
"""
VEHICLE = """
      length: 18.5 m
      bodies: {box: {mass: 60 t, inertia: 1300 t*m^2}, bogie: {mass: 9 t, inertia: 12 t*m^2}}
      wheels: {w1: {mass: 3 t, at: 1.5 m}, w2: {mass: 3 t, at: -1.5 m}}
      springs:
        s1: {between: [box, bogie], stiffness: 2 MN/m, at: 1 m}
        s2: {between: [box, bogie], stiffness: 2 MN/m, at: -1 m}
        p1: {between: [bogie, w1], stiffness: 2.4 MN/m}
        p2: {between: [bogie, w2], stiffness: 2.4 MN/m}
"""
KINDS = {
    "train": "  t:\n    kind: train\n    on: deck\n    travel: {speed: 50}\n    vehicles:\n     v:" + VEHICLE,
    "oscillator": "  t: {kind: oscillator, on: deck, mass: 5 t, wheel_mass: 1 t, stiffness: 1 MN/m, "
    "travel: {speed: 50, at_end: leave}}",
}


@pytest.mark.parametrize("kind", KINDS)
def test_bodies_of_vehicles_are_drawn_above_the_line_while_they_are_on_it(kind):
    found = ropewalk.simulate(loads(DECK + KINDS[kind]))
    drawn, on = drawn_bodies(found), (found["contact_state"].values > 0.0).any(axis=1)
    assert on.any()
    assert not on.all()
    assert np.isnan(drawn[~on]).all()
    assert (found["body_position"].values[..., -1] < 0.0).any()  # so it is stored
    assert (drawn[on][..., -1] > np.nanmax(found["contact_position"].values[..., -1])).all()
    names = [name.rpartition(".")[2] for name in found["body"].values.tolist()]
    if "box" in names:
        assert (drawn[on][:, names.index("box"), -1] > drawn[on][:, names.index("bogie"), -1]).all()
    labels = [line.get_label() for line in figure(found, panels=["shapes"]).axes[0].lines]
    assert [label for label in labels if label.endswith(", raised above its wheels")]


def test_a_payload_is_drawn_where_it_hangs():
    rope = "lines: {rope: {start: [0, 0], end: [40, 0], length: 40.5, mass: 1, axial_stiffness: 1 MN, elements: 10}}\n"
    load = "{kind: trolley, on: rope, mass: 50, payload: {mass: 100, length: 3}, travel: {speed: 0, from: 20}}"
    run = "run: {kind: dynamic, until: 0.02, every: 0.01}"
    found = ropewalk.simulate(loads(f"{rope}loads: {{t: {load}}}\n{run}"))
    assert np.array_equal(drawn_bodies(found), found["body_position"].values)
