"""Motion of wires, small and large, against the linear theory of strings and beams."""

from __future__ import annotations

import numpy as np
import pytest

from ropewalk.scenario.loading import loads
from ropewalk.simulate import simulate
from ropewalk.theory import beam, beam_vehicle, string
from wire_cases import course, force, rolling, straight

STRING = {"length": 20.0, "tension": 2e4, "mass": 1.35}
YAU = {"length": 25.0, "bending_stiffness": 2.87e9 * 2.90, "mass": 2303.0}
SPEED = 100 / 3.6


def middle(frames, axis=-1):
    return np.array([frame.sampled_uplift[0, 0] for frame in frames[1:]])


def string_error(links, speed, geometry="linearised", size=10.0):
    times = np.linspace(0.0, 0.9 * 20.0 / speed, 181)
    frames, _ = course(straight(**STRING), [force(size, speed)], times, links, geometry=geometry, watched=[7.0])
    exact = -string.moving_force(7.0, times[:-1], force=size, speed=speed, **STRING)
    return np.abs(middle(frames) - exact).max() / np.abs(exact).max()


@pytest.mark.parametrize("speed", [30.0, 75.0])
def test_a_force_on_a_string_moves_it_as_fryba_says(speed):
    """Below the wave speed of 121.7 m/s; a kink that comes by is rounded over a link: of the first order at worst."""
    errors = [string_error(links, speed) for links in (50, 100, 200)]
    assert errors[-1] < 5e-3
    assert 1.9 < np.log2(errors[0] / errors[2]) < 2.8  # two refinements


def test_large_motion_agrees_where_deflections_are_small():
    # The force pushes once in a step of 2 ms, in which small motion takes one step and large motion several.
    assert string_error(100, 50.0, "nonlinear", size=1.0) == pytest.approx(string_error(100, 50.0), abs=2e-3)


@pytest.mark.parametrize("ends", ["simply_supported", "clamped"])
def test_a_force_on_a_beam_moves_it_as_fryba_says(ends):
    times = np.linspace(0.0, 0.9, 181)
    kind = "clamped" if ends == "clamped" else "held"
    wire = straight(25.0, 0.0, 2303.0, YAU["bending_stiffness"], ends=(kind, kind))
    exact = -beam.moving_force(12.5, times[:-1], force=5e4, speed=SPEED, ends=ends, **YAU)
    errors = []
    for links in (20, 40):
        frames, _ = course(wire, [force(5e4, SPEED)], times, links)
        errors.append(np.abs(middle(frames) - exact).max() / np.abs(exact).max())
    assert errors[1] < 7e-5
    assert 2.8 < np.log2(errors[0] / errors[1]) < 4.0  # see test_beams_of_fourth_order.py


def test_yang_and_yau_1997_sprung_mass():
    """Largest deflection at midspan 2.4073 mm (20 modes, tests/theory); modes miss 1e-5 of it."""
    vehicle = beam_vehicle.oscillator(5750.0, load_stiffness=1595e3)
    times = np.linspace(0.0, 0.9, 901)
    wire = straight(25.0, 0.0, 2303.0, YAU["bending_stiffness"])
    exact = beam.moving_vehicle(times[:-1], vehicle=vehicle, speed=SPEED, modes=20, tolerance=1e-6, **YAU)
    found = []
    for links in (12, 24):
        frames, _ = course(wire, [rolling(vehicle, SPEED)], times, links)
        found.append(middle(frames))
        force_found = np.array([frame.sampled_force[0, 0] for frame in frames[1:]])
    reference = -exact.beam_deflection(12.5)
    errors = [np.abs(z - reference).max() / np.abs(reference).max() for z in found]
    assert found[1].min() == pytest.approx(-0.0024073013, rel=1.5e-4)
    assert errors[1] < 1.5e-4
    assert 2.6 < np.log2(errors[0] / errors[1]) < 4.0
    inside = (times[:-1] > 0.05) & (times[:-1] < 0.85)
    assert force_found[inside] == pytest.approx(-exact.contact_force[inside, 0], rel=2e-3)


def test_yang_and_yau_1997_mass_in_rigid_contact():
    """Largest deflection at midspan 2.42667 mm (20 modes, tests/theory)."""
    times = np.linspace(0.0, 0.9, 901)
    wire = straight(25.0, 0.0, 2303.0, YAU["bending_stiffness"])
    frames, _ = course(wire, [rolling(beam_vehicle.point_mass(5750.0), SPEED)], times, 48)
    assert middle(frames).min() == pytest.approx(-0.0024266681, rel=5e-5)


def test_a_vehicle_on_two_axles_agrees_with_the_modal_solution():
    vehicle = beam_vehicle.rigid_body(
        20e3, pitch_inertia=9e4, centre=4.0, axles=[0.0, 8.0], load_stiffness=6e5, load_damping=2e4, wheel_mass=800.0
    )
    times = np.linspace(0.0, 1.1, 1101)
    exact = beam.moving_vehicle(times[:-1], vehicle=vehicle, speed=SPEED, modes=20, **YAU)
    wire = straight(25.0, 0.0, 2303.0, YAU["bending_stiffness"])
    frames, _ = course(wire, [rolling(vehicle, SPEED)], times, 48)
    reference = -exact.beam_deflection(12.5)
    assert middle(frames) == pytest.approx(reference, abs=5e-3 * np.abs(reference).max())


def test_a_force_on_a_stiff_string_on_a_bed():
    line = {"length": 40.0, "tension": 2e4, "mass": 1.35, "bending_stiffness": 195.0, "foundation": 400.0}
    times = np.linspace(0.0, 0.6, 121)
    wire = straight(40.0, 2e4, 1.35, 195.0, bed=400.0)
    frames, _ = course(wire, [force(100.0, 60.0)], times, 160, watched=[20.0])
    exact = -beam.moving_force(20.0, times[:-1], force=100.0, speed=60.0, **line)
    # The kink comes by within an interval of output.
    assert middle(frames) == pytest.approx(exact, abs=0.02 * np.abs(exact).max())
    assert np.abs(middle(frames) - exact).mean() < 1e-3 * np.abs(exact).max()


def test_drag_takes_what_it_should():
    """A plucked string swings down as exp(-alpha t / 2)."""
    line = STRING | {"drag": 3.0}
    times = np.linspace(0.0, 1.5, 301)
    touched = force(100.0, 20.0)
    touched = type(touched)(
        touched.moving_load, lambda t: 10.0 + 0.0 * t, given=lambda t: np.where(t < 0.05, -100.0, 0.0)[:, None]
    )
    free = middle(course(straight(**STRING), [touched], times, 80)[0])
    damped = middle(course(straight(**line), [touched], times, 80)[0])
    late = times[:-1] > 0.3
    assert damped[late] == pytest.approx(
        free[late] * np.exp(-1.5 * (times[:-1][late] - 0.025)), abs=0.03 * np.abs(free).max()
    )


def test_forces_near_a_held_end_do_not_move_it():
    wire = straight(25.0, 0.0, 2303.0, YAU["bending_stiffness"], axial_stiffness=1e8)
    times, found = np.linspace(0.0, 0.3, 61), []
    for geometry in ("linearised", "nonlinear"):
        frames, _ = course(wire, [force(5e4, 0.0, 1.0)], times, 24, geometry=geometry)
        assert frames[-1].position[0] == pytest.approx([0.0, 0.0], abs=1e-12)
        found.append(middle(frames))
    assert found[1] == pytest.approx(found[0], abs=3e-2 * np.abs(found[0]).max())  # of the second order in 24 links


GUIDED = """
lines:
  beam: {start: [0, 0], end: [25, 0], length: 25 m, mass: 2303, axial_stiffness: 10 GN, bending_stiffness: 8.323e9,
         elements: 48, end_support: {kind: guided, along: [1, 0], force: 0}}
run: {kind: equilibrium}
"""


def test_a_guided_end_slides_and_the_other_does_not():
    place = simulate(loads(GUIDED, "beam.yaml"))["position"].values[0]
    assert place[0] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert 24.9999 < place[-1, 0] < 25.0
    sag = 5.0 * 2303.0 * 9.81 * 25.0**4 / (384.0 * 8.323e9)
    assert place[24, 1] == pytest.approx(-sag, rel=2e-3)  # second order in 48 links


def test_energies_and_works_close():
    """A vehicle, a mass in rigid contact and a force; the step is small beside what moves."""
    times = np.linspace(0.0, 0.8, 161)
    beam_wire = straight(25.0, 0.0, 2303.0, YAU["bending_stiffness"])
    sprung = rolling(beam_vehicle.oscillator(5750.0, load_stiffness=1595e3, load_damping=2e4), SPEED)
    for wire, prescribed_motion, part in (
        (beam_wire, sprung, 1e-3), (beam_wire, rolling(beam_vehicle.point_mass(5750.0), SPEED), 1e-4),
        (straight(**STRING), force(10.0, 20.0), 2e-3),
    ):  # fmt: skip
        energy = np.array([frame.energy for frame in course(wire, [prescribed_motion], times, 48)[0]])
        turned = np.abs(energy[:, :-1]).max()
        assert turned > 0.01
        assert np.abs(energy[:, -1]).max() < part * turned
