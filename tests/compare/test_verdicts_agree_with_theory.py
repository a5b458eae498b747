"""The verdicts of the ladder are what exact theory says of the simpler models (../shared/theory.md, by section)."""

from __future__ import annotations

import numpy as np
import pytest

from ropewalk.theory import string

G = 9.81


def displayed(model_hierarchy):
    for row in model_hierarchy.table():
        print(" | ".join(row))
    print(model_hierarchy.verdict)


def under(model_hierarchy, model, place):
    """Deflection under the only load of a rung when it is at a place, m."""
    (trace,) = model_hierarchy.of(model).traces.values()
    on = np.isfinite(trace.xi)
    order = np.argsort(trace.xi[on])
    return float(np.interp(place, trace.xi[on][order], trace.depth[on][order]))


def test_figure_5_near_the_far_support_the_linear_theory_is_not_adequate(climbed):
    model_hierarchy = climbed("figure_5")
    displayed(model_hierarchy)
    (reach,) = model_hierarchy.assumptions.linear.values()
    assert not model_hierarchy.adequate("linear")
    assert reach.beyond[-1][1] == reach.end  # up to the support
    assert reach.to_end == 0.0
    # section 1: the classical string is at F L/(2P) there, at its largest; the real one has been pulled up to the
    # support's height already. Half a per cent: the place of the last frame, and 1/(1 + alpha)
    half = 80.0 * 10.0 / (2.0 * 4e3)
    assert under(model_hierarchy, "linear", 9.99 / 1.02) == pytest.approx(half, rel=5e-3)
    assert abs(under(model_hierarchy, "full", 9.75)) < 0.5 * half
    assert model_hierarchy.of("moving force") is model_hierarchy.of("full")  # which is the scenario
    # So close to the wave speed the answer depends on the mesh: a third of the energy is missing.
    assert "doubtful" in model_hierarchy.verdict
    assert "No model can be recommended" in model_hierarchy.verdict


def test_a_light_slow_force_on_a_taut_string_is_a_case_for_the_linear_theory(climbed):
    model_hierarchy = climbed("light_and_slow")
    displayed(model_hierarchy)
    assert model_hierarchy.adequate("linear")
    assert all((model_hierarchy.errors["linear"][name] or 0.0) < 0.02 for name in model_hierarchy.allowed)
    (reach,) = model_hierarchy.assumptions.linear.values()
    middle = 0.5 * 10.0 / 1.02
    assert not any(a <= middle <= b for a, b in reach.beyond)
    assert model_hierarchy.verdict.endswith(
        "The simplest model that is adequate is the linear theory with constant forces."
    )
    assert model_hierarchy.assumptions.slope["value"] < 2e-3


def test_the_moving_mass_end_paradox_is_no_case_for_a_moving_force(climbed):
    model_hierarchy = climbed("mass_to_the_end")
    displayed(model_hierarchy)
    assert not any(
        model_hierarchy.adequate(model) for model in ("linear", "quasi-static", "moving force", "feedback cut")
    )
    assert model_hierarchy.models["moving mass"].same_as == "full"
    assert model_hierarchy.models["feedback cut"].same_as == "moving force"
    weight, unit = 4.0 * G, 4.0 * G * 10.0 / 4e3
    line = {"length": 10.0, "tension": 4e3, "mass": 0.4}
    known = string.moving_mass(np.array([0.1, 0.15]), load_mass=4.0, speed=50.0, gravity=G, **line)
    # section 2b, alpha = 1/2, kappa = 2: y(0.5), y(0.75) in m g L/P; two in a thousand: 2 % of strain scale the line
    assert known.deflection / unit == pytest.approx([0.26124, 0.44416], rel=1e-3)
    for place, exact in zip((5.0, 7.5), known.deflection, strict=True):
        # three per cent: a rope that tightens, 100 links, and its own sag
        assert under(model_hierarchy, "full", place / 1.02) == pytest.approx(exact, rel=0.03)
    # section 1, after the reflection: 2 alpha F (L - V t)/(P (1 - alpha^2)), a quarter below the mass at 0.75 L
    force = 2.0 * 0.5 * 0.25 / 0.75 * unit
    assert under(model_hierarchy, "moving force", 7.5 / 1.02) == pytest.approx(force, rel=0.02)
    # the contact force, N/mg = 4.81 at 0.9 L, grows without bound; a force knows nothing of it
    contact = model_hierarchy.models["full"].quantities.wheels["mass"]["contact_force"]["value"]
    assert contact > 4.8 * weight
    assert model_hierarchy.errors["moving force"]["contact force"] > 0.79
    assert model_hierarchy.errors["moving force"]["path"] > 0.5
    assert model_hierarchy.assumptions.feedback_largest == pytest.approx(contact / weight - 1.0, rel=1e-6)


def test_a_pantograph_is_no_constant_force(climbed):
    model_hierarchy = climbed("pantograph")
    displayed(model_hierarchy)
    assert not model_hierarchy.adequate("moving force")
    assert model_hierarchy.models["linear"].same_as == "moving force"
    full = model_hierarchy.models["full"].quantities.wheels["pantograph"]["contact_force"]
    alone = model_hierarchy.models["moving force"].quantities.wheels["pantograph"]["contact_force"]
    # its mean is what the force was given; a part in a thousand: the filter at the ends of the span
    assert alone["mean"] == pytest.approx(full["mean"], rel=1e-3)
    assert alone["deviation"] < 1e-3 * alone["mean"]
    # EN 50318:2002 has 26 to 31 N of 110 to 120 N in the middle of ten spans; here the line has two neighbours less
    assert 15.0 < full["deviation"] < 45.0
    assert model_hierarchy.errors["moving force"]["contact force"] > 0.2
    assert "quasi-static" in model_hierarchy.models["quasi-static"].reason
    assert "no weight" in model_hierarchy.models["moving mass"].reason


def test_on_a_slack_rope_the_linear_theory_fails_and_a_pure_force_is_a_moving_force(climbed):
    model_hierarchy = climbed("slack_rope")
    displayed(model_hierarchy)
    assert not model_hierarchy.adequate("linear")
    assert not model_hierarchy.adequate("quasi-static")
    assert {model_hierarchy.models[name].same_as for name in ("moving force", "moving mass", "feedback cut")} == {
        "full"
    }
    assert model_hierarchy.adequate("moving force")
    assert model_hierarchy.errors["linear"]["deflection"] > 1.0
    assert model_hierarchy.assumptions.slope["value"] > 0.5
    assert "the same as full" in model_hierarchy.verdict


def test_on_the_bridge_of_yang_and_yau_a_moving_force_tells_the_deflection_but_not_the_contact_force(climbed):
    model_hierarchy = climbed("bridge", 0.01)
    displayed(model_hierarchy)
    errors = model_hierarchy.errors["moving force"]
    assert errors["deflection"] < 0.01
    middle = {}
    for name in ("full", "moving force"):
        result = model_hierarchy.models[name].result
        at = int(np.argmin(np.abs(result["xi"].values - 12.5)))
        middle[name] = -float(result["position"].values[:, at, -1].min())
    # section 3: 2.4073013e-3 m under the sprung mass, 2.3968268e-3 m under the force, 0.44 % less; half a per cent and
    # a tenth of one: 32 elements, frames every 3 ms
    assert middle["full"] == pytest.approx(2.4073013e-3, rel=5e-3)
    assert 1.0 - middle["moving force"] / middle["full"] == pytest.approx(0.0044, abs=1e-3)
    # the sprung mass is accelerated by up to 0.148 m/s^2, which its contact force feels: 5750 kg of 56407.5 N
    assert errors["contact force"] == pytest.approx(5750.0 * 0.14797 / 56407.5, rel=0.05)
    assert not model_hierarchy.adequate("moving force")
    assert errors["contact force"] > 0.01
    assert model_hierarchy.models["feedback cut"].same_as == "moving force"


def test_of_a_slow_heavy_trolley_the_quasi_static_simpler_model_is_enough_and_the_linear_is_not(climbed):
    model_hierarchy = climbed("slow_trolley")
    displayed(model_hierarchy)
    assert model_hierarchy.adequate("quasi-static")
    assert not model_hierarchy.adequate("linear")
    assert model_hierarchy.errors["linear"]["deflection"] > 0.1
    assert "the quasi-static one" in model_hierarchy.verdict.splitlines()[-1]
    assert model_hierarchy.assumptions.mach_transverse < 0.05
