"""The audit of motion on wires is computed: what dampers and drag take is counted where they act."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ropewalk.results.frame import ENERGY_FORMS, RunInfo
from ropewalk.scenario.loading import load, loads
from ropewalk.simulate import iterate
from ropewalk.theory import beam_vehicle
from ropewalk.wires.prescribed_motion import PrescribedMotion
from wire_cases import course, force, rolling, straight

STRING = {"length": 20.0, "tension": 2e4, "mass": 1.35}
BEAM = {"length": 25.0, "tension": 0.0, "mass": 2303.0, "stiffness": 2.87e9 * 2.90}
SPEED = 100 / 3.6
GEOMETRIES = ["linearised", "nonlinear"]
_DAMPING, _AUDIT = ENERGY_FORMS.index("line_damping"), ENERGY_FORMS.index("imbalance")


def audit(energy: np.ndarray) -> tuple[float, float]:
    """Largest imbalance, and what drag and dampers have taken; both over the energy that has changed its form."""
    assert np.isfinite(energy).all()
    moved = 0.5 * np.abs(np.delete(energy - energy[0], _AUDIT, axis=1)).sum(axis=1).max()
    return float(np.abs(energy[:, _AUDIT]).max() / moved), float(energy[-1, _DAMPING] / moved)


def energies(frames) -> np.ndarray:
    return np.array([frame.energy for frame in frames])


@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("damping", [{"drag": 3.0}, {"retardation": 1e-3}, {"drag": 3.0, "retardation": 1e-3}])
@pytest.mark.parametrize(("line", "size"), [(STRING, 10.0), (BEAM, 1e5)])
def test_a_damped_string_and_a_damped_beam_close_their_audit(line, size, damping, geometry):
    """Under a force that stops in the middle, while they swing down. Half the step leaves half, or next to nothing."""
    times, wire = np.linspace(0.0, 1.5, 151), straight(**line, **damping)
    stops = PrescribedMotion(
        force(1.0, 1.0).moving_load, lambda t: np.minimum(t, 0.3) * 30.0, given=lambda t: np.full((t.size, 1), -size)
    )
    frames, run_info = course(wire, [stops], times, 24, geometry=geometry)
    missed, taken = audit(energies(frames))
    assert taken > 0.01  # it is damping that is audited here
    assert missed < 0.01
    fine, _ = course(wire, [stops], times, 24, geometry=geometry, step=0.5 * run_info.step)
    assert audit(energies(fine))[0] < max(0.6 * missed, 1e-3)


@pytest.mark.parametrize("ends", [("held", "held"), ("clamped", "clamped"), ("clamped", "held")])
def test_retardation_of_a_clamped_beam_on_a_bed_is_counted(ends):
    """All of the stiffness is retarded: that against turning at clamped ends, and the bed."""
    wire = straight(**BEAM, bed=5e5, retardation=5e-3, ends=ends)
    frames, _ = course(wire, [force(5e4, SPEED)], np.linspace(0.0, 1.5, 301), 40)
    missed, taken = audit(energies(frames))
    assert taken > 0.03
    assert missed < 1e-3


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_a_vehicle_on_a_damped_beam_closes_its_audit(geometry):
    """In soft and in rigid contact, with dampers of its own, onto the beam and off it."""
    wire = straight(**BEAM, drag=1.0)
    for vehicle in (
        beam_vehicle.oscillator(5750.0, load_stiffness=1595e3, load_damping=2e4), beam_vehicle.point_mass(5750.0)
    ):  # fmt: skip
        frames, _ = course(wire, [rolling(vehicle, SPEED)], np.linspace(0.0, 1.2, 241), 48, geometry=geometry)
        missed, taken = audit(energies(frames))
        assert taken > 0.01
        assert missed < 3e-3


OVERHEAD = Path(__file__).parents[2] / "examples" / "en50318-2002-250.yaml"
DAMPED = {
    "nothing": [],
    "droppers": ["overhead_lines.line.droppers.damping=100 N*s/m"],
    "supports": ["overhead_lines.line.messenger_supports={stiffness: 100 kN/m, damping: 500 N*s/m}"],
    "drag": ["overhead_lines.line.contact_wire.drag=1 Hz", "overhead_lines.line.messenger_wire.drag=1 Hz"],
    "retardation": ["overhead_lines.line.contact_wire.retardation=0.05 ms"],
}


@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("damped", DAMPED)
def test_an_overhead_line_closes_its_audit(damped, geometry):
    """Droppers slacken, the contact is lost for moments; as documented, 1 to 4 % at 1 ms without damping."""
    scenario = load(OVERHEAD, ["run.until=2 s", f"run.geometry={geometry}", *DAMPED[damped]])
    missed, taken = audit(energies(iterate(scenario, RunInfo())[1]))
    assert missed < 0.025
    assert (taken > 0.01) == (damped != "nothing")


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_rough_contact_wire_is_audited(geometry, tmp_path):
    """1 mm high and 5 m long waves of a contact wire take up energy like a slope."""
    x = np.arange(0.0, 650.0, 0.5)
    table = "\n".join(f"{a},{1e-3 * np.sin(0.4 * np.pi * a)}" for a in x)
    (tmp_path / "rough.csv").write_text(f"station,height\n{table}")
    changes = ["run.until=2 s", f"run.geometry={geometry}", f"loads.pantograph.irregularity={tmp_path / 'rough.csv'}"]
    missed, _ = audit(energies(iterate(load(OVERHEAD, changes), RunInfo())[1]))
    assert missed < 0.02


def test_dampers_at_supports_do_not_shorten_the_step():
    """They act exactly within a step: with the velocity of half a step ago, 500 N s/m would throw half a kilogram."""
    run_info = RunInfo()
    for frame in iterate(load(OVERHEAD, ["run.until=1 s", *DAMPED["supports"]]), run_info)[1]:
        uplift = np.abs(frame.sampled_uplift).max(initial=0.0)
    assert run_info.outcome == "running"
    assert run_info.step == pytest.approx(1e-3, rel=1e-9)
    assert 0.0 < uplift < 0.1


CROSSING = """
lines:
  rope: {{start: [0, 0], end: [10, 0], tension: 1 kN, mass: 0.1, axial_stiffness: 1 MN, bending_stiffness: 1e-9,
         elements: 40}}
loads:
  m: {{kind: {kind}, on: rope, travel: {{speed: 80 m/s, from: 2.5 m}}}}
run: {{kind: dynamic, until: 80 ms, every: 1 ms, geometry: {geometry}, step: {step}}}
"""


@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("kind", ["mass, mass: 1 kg", "oscillator, mass: 1 kg, wheel_mass: 0.1 kg, stiffness: 5 kN/m"])
def test_the_audit_of_a_load_that_starts_within_a_rope_closes_with_the_step(kind, geometry):
    """Rigid contact, joined at the end of each step: of the first order at least."""
    found = []
    for step in ("40 us", "20 us"):
        _, frames, _ = iterate(loads(CROSSING.format(kind=kind, geometry=geometry, step=step), "rope.yaml"), RunInfo())
        found.append(audit(energies(frames))[0])
    assert found[0] < 5e-3
    assert found[1] < 0.6 * found[0]
