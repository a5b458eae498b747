"""Where loads begin on stiff lines: on the line as it rests there, moving along it, as on a rope without stiffness."""

from __future__ import annotations

import numpy as np
import pytest

from ropewalk.results.frame import Frame, Layout, RunInfo
from ropewalk.scenario.loading import loads
from ropewalk.simulate import iterate

ROPE = """
lines:
  rope: {{start: [0, 10], end: [{end}], length: 31 m, mass: 2, axial_stiffness: 1 MN, elements: 124{stiff}}}
loads:
  {loads}
run: {{kind: dynamic, until: 20 ms, every: 20 ms, geometry: nonlinear}}
"""
MASS = "m: {kind: mass, on: rope, mass: 20 kg, travel: {speed: 5 m/s, from: 12 m}}"
LOADS = {
    "mass": MASS,
    "a second one behind": f"{MASS}\n  n: {MASS[3:].replace('12', '4')}",
    "oscillator": "m: {kind: oscillator, on: rope, mass: 20 kg, wheel_mass: 2 kg, stiffness: 5 kN/m, damping: 100, "
    "travel: {speed: 5 m/s, from: 12 m}}",
    "oscillator, backwards": "m: {kind: oscillator, on: rope, mass: 20 kg, wheel_mass: 2 kg, stiffness: 5 kN/m, "
    "damping: 100, travel: {speed: -5 m/s, from: 12 m}}",
    "oscillator, horizontally": "m: {kind: oscillator, on: rope, mass: 20 kg, wheel_mass: 2 kg, stiffness: 5 kN/m, "
    "travel: {speed: 5 m/s, from: 12 m, measured: horizontal}}",
    "vehicle": "m: {kind: vehicle, on: rope, bodies: {car: {mass: 40 kg, inertia: 30, at: 0.2 m}}, "
    "wheels: {a: {at: 0 m, mass: 3 kg}, b: {at: 2 m, mass: 3 kg}}, "
    "springs: {f: {between: [car, a], stiffness: 10 kN/m}, g: {between: [car, b], stiffness: 10 kN/m}}, "
    "travel: {speed: 5 m/s, from: 12 m}}",
    "matrices": "m: {kind: matrices, on: rope, coordinates: [z, w], mass: [[20, 0], [0, 3]], "
    "stiffness: [[5000, -5000], [-5000, 5000]], wheels: {a: {coordinate: w}}, travel: {speed: 5 m/s, from: 12 m}}",
}


def frames_of(text: str) -> tuple[Layout, list[Frame]]:
    layout, frames, _ = iterate(loads(text, "line.yaml"), RunInfo())
    return layout, list(frames)


@pytest.mark.parametrize("end", ["30, 10", "30, 6"])
@pytest.mark.parametrize("load", LOADS)
def test_loads_begin_where_they_would_on_a_rope_without_stiffness(load: str, end: str) -> None:
    """On a slack rope, level or not: 31 m long, 3 m of sag. Links of 0.25 m are chords there: 1 mm of their arc."""
    rope, line = (
        frames_of(ROPE.format(end=end, loads=LOADS[load], stiff=stiff))[1][0]
        for stiff in ("", ", bending_stiffness: 1e-9")
    )
    assert line.contact_position == pytest.approx(rope.contact_position, abs=1e-3)
    assert line.contact_xi == pytest.approx(rope.contact_xi, abs=2e-3)
    assert line.contact_speed == pytest.approx(rope.contact_speed, rel=1e-6)
    assert line.body_position == pytest.approx(rope.body_position, abs=1e-3)
    assert line.body_velocity == pytest.approx(rope.body_velocity, abs=1e-2)


BEAM = """
lines:
  beam: {{start: [0, 0], end: [25, 0], length: 25 m, mass: 2303, axial_stiffness: 10 GN, bending_stiffness: 8.323e9,
         elements: {elements}}}
loads:
  m: {{kind: mass, on: beam, mass: 17 t, travel: {{speed: 100 km/h, from: {start}, at_end: leave}}}}
run: {{kind: dynamic, until: {until}, every: 10 ms, geometry: {geometry}}}
"""
WEIGHT = 17e3 * 9.81


def forces(elements: int, start: str, until: str, geometry: str) -> np.ndarray:
    _, frames = frames_of(BEAM.format(elements=elements, start=start, until=until, geometry=geometry))
    return -np.concatenate([frame.sampled_force[:, 0] for frame in frames[1:]])


@pytest.mark.parametrize("geometry", ["linearised", "nonlinear"])
def test_a_rigid_mass_crosses_a_beam_with_a_force_that_no_mesh_changes(geometry: str) -> None:
    """From support to support: its path is bent by less than a tenth of g, and nothing strikes it."""
    coarse, fine = (forces(elements, "0 m", "0.88 s", geometry) for elements in (24, 48))
    for found in (coarse, fine):
        assert found.min() > 0.85 * WEIGHT
        assert found.max() < 1.15 * WEIGHT
    assert np.abs(coarse - fine).max() < 0.04 * WEIGHT  # most next to the support


@pytest.mark.parametrize("geometry", ["linearised", "nonlinear"])
def test_a_rigid_mass_set_down_within_a_beam_presses_with_twice_its_weight_at_most(geometry: str) -> None:
    """The beam swings around its rest below the load, the more slowly the farther it gives way."""
    for elements in (24, 48):
        found = forces(elements, "5 m", "0.2 s", geometry)
        assert found.min() > 0.0
        assert found.max() < 2.0 * WEIGHT


SLACK = """
lines:
  rope: {{start: [0, 0], end: [15, 0], length: 20 m, mass: 1, axial_stiffness: 100 kN, bending_stiffness: 10,
         elements: 80}}
loads:
  m: {{kind: {kind}, on: rope, travel: {{speed: 4 m/s, from: 1 m, measured: {measured}}}}}
run: {{kind: dynamic, until: 1 s, every: 0.5 s, geometry: nonlinear}}
"""


@pytest.mark.parametrize("kind", ["force, force: [0, -20]", "mass, mass: 2 kg"])
def test_a_load_measured_as_material_stays_with_the_particles(kind: str) -> None:
    layout, frames = frames_of(SLACK.format(kind=kind, measured="material"))
    for xi, frame in zip((1.0, 3.0, 5.0), frames, strict=True):
        assert frame.contact_xi[0] == pytest.approx(xi, abs=1e-9)
        particle = [np.interp(xi, layout.node_xi, values) for values in frame.position.T]
        assert frame.contact_position[0] == pytest.approx(particle, abs=5e-3)  # a spline between links of 0.25 m


def test_a_load_measured_horizontally_tells_on_which_particle_it_is() -> None:
    layout, frames = frames_of(SLACK.format(kind="mass, mass: 2 kg", measured="horizontal"))
    for x, frame in zip((1.0, 3.0, 5.0), frames, strict=True):
        assert frame.contact_position[0, 0] == pytest.approx(x, abs=1e-4)  # what gives way along the line
        assert frame.contact_speed[0] == pytest.approx(4.0, rel=1e-9)
        assert np.interp(frame.contact_xi[0], layout.node_xi, frame.position[:, 0]) == pytest.approx(x, abs=2e-3)
