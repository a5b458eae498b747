"""Vehicles are drawn above their wheels, in films alone; what hangs is drawn below."""

from __future__ import annotations

import numpy as np
import pytest

import ropewalk
from ropewalk.results import figure
from ropewalk.results.declared import hanging_bodies
from ropewalk.results.stage import Stage
from ropewalk.results.tempo import tempo
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
def test_bodies_of_vehicles_are_drawn_above_the_line_or_not_at_all(kind):
    found = ropewalk.simulate(loads(DECK + KINDS[kind]))
    assert (found["body_position"].values[..., -1] < 0.0).any()  # so it is stored
    assert np.isnan(hanging_bodies(found)).all()
    labels = [line.get_label() for line in figure(found, panels=["shapes"]).axes[0].lines]
    assert "path of t" in "".join(labels)
    assert not [label for label in labels if label.endswith(("box", "bogie", "mass"))]
    stage = Stage(found, tempo(found))
    k = len(stage) // 3
    stage.picture(k)
    wheels = stage._view(stage._arrays.contacts[k])
    boxes = [path.vertices[:4] for path in stage._shapes.get_paths() if len(path.vertices) < 7]
    assert boxes
    assert min(box[:, 1].min() for box in boxes) > np.nanmin(wheels[:, 1])


def test_a_payload_is_drawn_where_it_hangs():
    rope = "lines: {rope: {start: [0, 0], end: [40, 0], length: 40.5, mass: 1, axial_stiffness: 1 MN, elements: 10}}\n"
    load = "{kind: trolley, on: rope, mass: 50, payload: {mass: 100, length: 3}, travel: {speed: 0, from: 20}}"
    run = "run: {kind: dynamic, until: 0.02, every: 0.01}"
    found = ropewalk.simulate(loads(f"{rope}loads: {{t: {load}}}\n{run}"))
    assert np.array_equal(hanging_bodies(found), found["body_position"].values)
