"""Stagger: with all geometry the wires run where they are in plan view, and move sideways, too."""

from __future__ import annotations

import numpy as np
import pytest

from ropewalk.model import Scenario
from ropewalk.scenario import loads
from ropewalk.simulate import simulate


def staggered(geometry: str, until: str = "0.3 s", arms: str = "stagger: 200 mm", supports: str = "{}") -> Scenario:
    return loads(
        f"""
        overhead_lines:
          line:
            spans: {{count: 4, length: 50 m}}
            element: 0.5 m
            droppers: {{per_span: 6}}
            steady_arms: {{{arms}}}
            messenger_supports: {supports}
        loads:
          front: {{kind: pantograph, on: line, model: en50318-2002, travel: {{speed: 50 m/s, from: 10 m}}}}
        run: {{kind: dynamic, geometry: {geometry}, until: {until}, every: 50 ms}}
        """,
        "line.yaml",
    )


@pytest.mark.parametrize("supports", ["{}", "{stagger: straight}"])
def test_a_staggered_line_rests_where_its_arms_hold_it(supports: str) -> None:
    scenario = staggered("nonlinear", supports=supports)
    still = simulate(scenario.model_copy(update={"loads": {}}))
    assert still.sizes["axis"] == 3
    # Equilibrium is found to 1e-9 m; a dropper that leans by that pulls with 1e-4 N.
    assert float(still["energy"].sel(form=still["form"] == "kinetic").max()) < 1e-6
    place = still["position"].values[0][still["line"].values == "line.contact"]
    aside = np.interp(np.arange(0.0, 201.0, 50.0), place[:, 0], place[:, 1])
    # Arms are found for upright droppers and a plan without sideways motion: what leans pulls the wire by 3 mm more.
    assert aside == pytest.approx([0.2, -0.2, 0.2, -0.2, 0.2], abs=1e-3 if supports == "{}" else 4e-3)
    height = np.interp([50.0, 100.0, 150.0], place[:, 0], place[:, 2])
    assert height == pytest.approx(0.0, abs=1e-3)
    messenger = still["position"].values[0][still["line"].values == "line.messenger"]
    # Droppers that lean pull a straight messenger aside by 6 mm.
    assert np.abs(messenger[:, 1]).max() == pytest.approx(0.2 if supports == "{}" else 0.0, abs=1e-2)


def test_the_contact_sweeps_the_head_and_feels_what_the_linearised_motion_says() -> None:
    space, plane = (simulate(staggered(geometry, "2.4 s")) for geometry in ("nonlinear", "linearised"))
    x, y = space["contact_position"].values[1:, 0, 0], space["contact_position"].values[1:, 0, 1]
    polygon = np.interp(x, np.arange(0.0, 201.0, 50.0), [0.2, -0.2, 0.2, -0.2, 0.2])
    assert y == pytest.approx(polygon, abs=0.01)  # it swings sideways by some millimetres
    forces = [result["sampled_force"].values[1:].ravel() for result in (space, plane)]
    # 6 N rms, of a force that varies by 30 N: what the linearised motion leaves out, with unfiltered forces of short
    # waves that come out of step.
    assert np.sqrt(np.mean((forces[0] - forces[1]) ** 2)) < 8.0
    assert forces[0].mean() == pytest.approx(forces[1].mean(), abs=0.5)
