"""Natural frequencies of stiff and overhead lines against the closed forms of beams and strings."""

from __future__ import annotations

import numpy as np
import pytest

from ropewalk.model import Scenario
from ropewalk.results.spectrum_figure import mode_figure
from ropewalk.simulate import spectrum_of
from ropewalk.solve.spectrum import Modes
from ropewalk.theory import beam
from ropewalk.wires.plan import WirePlan
from ropewalk.wires.spectrum import spectrum
from ropewalk.wires.task import WireTask
from wire_cases import straight

LENGTH, MASS, EI = 10.0, 50.0, 2e6
MESHES = (20, 40, 80)


def found(elements: int, **line: object) -> Modes:
    """The lowest modes of a beam without weight."""
    given = {"start": [0, 0], "end": [LENGTH, 0], "mass": MASS, "axial_stiffness": 1e9, "bending_stiffness": EI}
    length = {} if "tension" in line else {"length": LENGTH}
    scenario = {"gravity": 0.0, "lines": {"beam": {**given, **length, "elements": elements, **line}}}
    modes = spectrum_of(Scenario.model_validate({**scenario, "run": {"kind": "equilibrium"}}), how_many=12).modes
    assert modes is not None
    return modes


@pytest.mark.parametrize(
    ("line", "known"),
    [
        ({}, {}),
        ({"foundation": 2e5}, {"foundation": 2e5}),
        # mass and bending stiffness are those of the unstrained beam: it must not get longer by its tension
        ({"tension": 4e5, "axial_stiffness": 1e12}, {"tension": 4e5}),
        ({"start_support": {"kind": "fixed", "clamped": True}, "end_support": {"kind": "fixed", "clamped": True}},
         {"ends": "clamped"}),
    ],
    ids=["beam", "on a bed", "under tension", "clamped"],
)  # fmt: skip
def test_beams_have_the_frequencies_of_euler_and_bernoulli_with_the_second_order(line, known) -> None:
    exact = beam.natural_frequencies(3, length=LENGTH, bending_stiffness=EI, mass=MASS, **known)
    errors = np.array([np.abs(_of(found(n, **line), exact) / exact - 1.0) for n in MESHES])
    order = np.log2(errors[:-1] / errors[1:])
    print("errors", errors, "orders", order)
    assert (errors[-1] < 2.5e-3).all()  # (n pi h / L)^2 / 12 with n = 3 and 80 elements: 1.2e-3; clamped twice that
    assert np.abs(order - 2.0).max() < 0.1


def _of(modes: Modes, exact: np.ndarray) -> np.ndarray:
    """The frequencies next to exact ones: each comes twice, up and sideways."""
    return np.array([modes.frequency[np.abs(modes.frequency - w).argmin()] for w in exact])


def test_a_beam_swings_sideways_as_it_does_upwards() -> None:
    modes = found(40)
    assert modes.frequency[0] == pytest.approx(modes.frequency[1], rel=1e-9)
    sideways = found(40, foundation=2e5).frequency[0]  # the bed bears upwards only
    assert sideways == pytest.approx(modes.frequency[0], rel=1e-9)


def test_drag_damps_all_modes_alike_in_time() -> None:
    modes = found(40, drag=0.8)
    assert modes.ratio == pytest.approx(0.5 * 0.8 / modes.frequency, rel=1e-9)  # x'' + drag x' + w^2 x = 0


def test_the_largest_displacement_of_a_mode_is_one_and_it_is_a_sine() -> None:
    modes = found(40)
    assert np.linalg.norm(modes.shape, axis=2).max(axis=1) == pytest.approx(1.0)
    first = np.linalg.norm(modes.shape[0], axis=1)
    assert first == pytest.approx(np.sin(np.pi * modes.position[:, 0] / LENGTH), abs=1e-6)


def test_modes_are_drawn_a_panel_each_with_frequencies_in_hertz() -> None:
    scenario = {
        "lines": {"wire": {"start": [0, 0], "end": [20, 0], "tension": 500.0, "mass": 0.5, "axial_stiffness": 1e6}},
        "run": {"kind": "equilibrium"},
    }
    spectrum = spectrum_of(Scenario.model_validate(scenario))
    figure = mode_figure(spectrum, displayed=4)
    titles = [ax.get_title(loc="left") for ax in figure.axes if ax.get_visible()]
    assert len(titles) == 4
    assert spectrum.modes is not None
    assert titles[0] == f"1: {spectrum.modes.frequency[0] / (2 * np.pi):.4g} Hz"


def test_retardation_damps_a_wire_under_tension_in_proportion_to_its_frequency() -> None:
    """beta K of Rayleigh: the ratio is beta w / 2, of what tension and bending hold alike."""
    wire = straight(60.0, 2e4, 1.35, 195.0, retardation=1e-3)
    modes = spectrum(WireTask(WirePlan((wire,), gravity=0.0), (), (), element=[60])).modes
    assert modes is not None
    assert modes.ratio == pytest.approx(0.5e-3 * modes.frequency, rel=1e-4)  # the wire stretches by 1e-4
