"""Gradients against closed forms and complex steps through them."""

from __future__ import annotations

import numpy as np
import pytest

import design_cases as cases
import ropewalk
from ropewalk.errors import RopewalkError, ScenarioError

FORCE = "loads.man.force.1"


def sag(tension, force, axial=cases.AXIAL, length=10.0):
    """Of a massless string under a force in its middle, of complex arguments, too: Newton's method on

    2 T sin a = F, T = EA (L / cos a / L0 - 1), L0 = L / (1 + T0 / EA)."""
    tangent = force / (2.0 * tension) + 0j
    for _ in range(60):
        stretch = (1.0 + tension / axial) * np.sqrt(1.0 + tangent**2)
        root = np.sqrt(1.0 + tangent**2)
        residual = 2.0 * axial * (stretch - 1.0) * tangent / root - force
        slope = 2.0 * axial * ((1.0 + tension / axial) - 1.0 / root**3)
        tangent = tangent - residual / slope
    return 0.5 * length * tangent


def test_of_rest_as_complex_steps_through_the_closed_form():
    """Two straight halves; runs are at rest to 1e-9 of their forces, and steps of 0.001 leave 1e-9 of a derivative."""
    found = ropewalk.gradient(cases.scenario(), "largest_sag", [cases.TENSION, FORCE], workers=0)
    step = 1e-30j
    exact = [
        float(sag(1000.0 + step, cases.FORCE).imag / 1e-30),
        -float(sag(1000.0, cases.FORCE + step).imag / 1e-30),  # the key is the force upwards
    ]
    np.testing.assert_allclose(found["gradient"].values[0], exact, rtol=1e-6)
    assert (found["error"].values > np.abs(found["gradient"].values - exact)).all()
    assert (found["error"].values < 1e-4 * np.abs(exact)).all()
    assert found["key_units"].values.tolist() == ["N", "N"]
    assert found["quantity_units"].values.tolist() == ["m"]


def test_of_the_linear_theory_in_proportion():
    """Deflections of the linear theory are F times what depends on the line: the derivative is their quotient."""
    run = {"kind": "linear", "until": 0.1, "every": 0.02}
    loads = {"man": cases.TREE["loads"]["man"] | {"travel": {"speed": 10, "from": 0}}}
    scenario = cases.scenario(run=run, loads=loads)
    found = ropewalk.gradient(scenario, "largest_sag", FORCE, workers=0)
    with ropewalk.simulate(scenario) as result:
        whole = ropewalk.summary(result)["largest_sag"]["value"]
    assert float(found["gradient"][0, 0]) == pytest.approx(-whole / cases.FORCE, rel=1e-9)


@pytest.mark.parametrize(
    ("of", "to", "more", "wrong"),
    [
        ("largest_sga", cases.TENSION, {}, "did you mean largest_sag"),
        ("largest_sag", "lines.string.tensoin", {}, "did you mean lines.string.tension"),
        ("largest_sag", "run.kind", {}, "only numbers other than 0"),
        ("largest_sag", "loads.man.force.0", {}, "only numbers other than 0"),
        ("largest_sag", cases.TENSION, {"step": 0.9}, "part of the value"),
    ],
)
def test_mistakes_are_told(of, to, more, wrong):
    with pytest.raises(ScenarioError, match=wrong):
        ropewalk.gradient(cases.scenario(), of, to, workers=0, **more)


def test_a_run_without_a_value_has_no_gradient():
    loads = {"man": cases.TREE["loads"]["man"] | {"travel": {"speed": 1, "from": 9.9999}}}
    with pytest.raises(RopewalkError, match="there is no gradient: with"):
        ropewalk.gradient(cases.scenario(loads=loads), "largest_sag", "loads.man.travel.from", workers=0)
