"""Lines in another condition than fitted: droppers missing, contact wire worn, warm and cold, against other routes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.optimize import brentq

from overhead_cases import EN_2002, formed
from ropewalk.errors import EquilibriumError
from ropewalk.model import Scenario
from ropewalk.overhead.condition import flat_bending
from ropewalk.overhead.section import Section
from ropewalk.simulate import simulate

LINE: dict[str, Any] = {**EN_2002, "spans": {"count": 4, "length": "60 m"}, "analysed_spans": [2, 3]}
G = 9.81


def heights(section: Section) -> Any:
    """Heights of the control points of the contact wire, m."""
    return section.rest.position[2][section.mesh().of(0)]


def in_condition(line: dict[str, Any] = LINE, **condition: Any) -> Section:
    return formed({**line, "condition": condition})


def test_without_a_dropper_the_line_rests_as_one_that_never_had_it() -> None:
    """Lengths given to the others, no arm to hold the wire: there form finding starts from lengths."""
    heavy = {"stiffness": "100 kN/m", "mass": 0.1, "contact_clamp": 0.2, "messenger_clamp": 0.5}
    line = {**LINE, "steady_arms": {"mass": 0.333, "free": True}, "droppers": {"at": LINE["droppers"]["at"], **heavy}}
    fitted, failed = formed(line), in_condition(line, missing_droppers=[[2, 5]])
    at = list(LINE["droppers"]["at"])
    places = [at, at[:4] + at[5:], at, at]
    kept = [i for i, name in enumerate(fitted.droppers) if name != "section.2.5"]
    rows = np.split(fitted.lengths[kept], np.cumsum([9, 8, 9]))
    lengths = [row.tolist() for row in rows]
    other = formed({**line, "droppers": {"at": places, "lengths": lengths, **heavy}})
    np.testing.assert_allclose(heights(failed), heights(other), atol=1e-8)
    np.testing.assert_allclose(failed.pull, other.pull, atol=1e-4)
    assert list(failed.droppers)[12:15] == ["section.2.4", "section.2.6", "section.2.7"]
    # What it carried goes to its neighbours, most of it to the nearest two: 6.5 m of wire, half of itself and a clamp.
    gained = failed.pull[12:14] - fitted.pull[[12, 14]]
    assert fitted.pull[13] == pytest.approx((1.35 * 6.5 + 0.05 + 0.2) * G, abs=0.5)
    assert gained.sum() > 0.8 * fitted.pull[13]


def test_all_droppers_gone_leave_a_string_under_its_own_weight() -> None:
    line = {**LINE, "spans": {"count": 2, "length": "60 m"}, "analysed_spans": [1, 1], "steady_arms": {"mass": 0}}
    gone = [[span, number] for span in (1, 2) for number in range(1, 10)]
    failed = in_condition(line, missing_droppers=gone)
    fitted = formed(line)
    z = heights(failed)
    # The arm goes on to press as it did: with half of the weight that the outer droppers leave, 1.35 g * 10 m / 2.
    lift = 1.35 * G * 5.0
    assert fitted.plan.holds[fitted.holds["section.arm.1"]].force[2] == pytest.approx(lift, rel=1e-6)
    exact = -1.35 * G * 120.0**2 / (8 * 20e3) + lift * 120.0 / (4 * 20e3)
    assert z[z.size // 2] == pytest.approx(exact, abs=1e-4)


def test_warm_droppers_hang_the_wire_as_longer_ones_do() -> None:
    line = {**LINE, "steady_arms": {"mass": 0.333, "free": True}}
    warm, lengths = in_condition(line, temperature_rise=60.0, expansion=1e-4), 1.006 * formed(line).lengths
    other = formed({**line, "droppers": {**LINE["droppers"], "lengths": lengths.reshape(4, 9).tolist()}})
    np.testing.assert_allclose(heights(warm), heights(other), atol=1e-7)
    assert np.abs(heights(warm) - heights(formed(line))).max() > 2e-3


@pytest.mark.parametrize("wear", [1e-3, 0.1, 0.2, 0.5])
def test_a_flat_takes_bending_stiffness_as_the_integral_over_what_is_left_says(wear: float) -> None:
    y = np.linspace(-1.0, 1.0, 400_001)
    width = 2.0 * np.sqrt(1.0 - y**2)
    below = np.cumsum(width) * (y[1] - y[0])
    left = below >= wear * np.pi
    area = np.trapezoid(width[left], y[left])
    middle = np.trapezoid(width[left] * y[left], y[left]) / area
    second = np.trapezoid(width[left] * (y[left] - middle) ** 2, y[left])
    assert area == pytest.approx(np.pi * (1.0 - wear), rel=1e-4)
    assert flat_bending(wear) == pytest.approx(second / (np.pi / 4.0), rel=1e-4)
    assert flat_bending(0.0) == 1.0


def test_weights_keep_the_tension_of_worn_and_of_warm_wires() -> None:
    section = in_condition(wear=0.2, temperature_rise=40.0)
    contact, messenger = section.plan.wires[:2]
    assert (contact.tension, messenger.tension) == (20e3, 16e3)
    assert contact.mass == pytest.approx(0.8 * 1.35)
    assert contact.axial_stiffness == pytest.approx(0.8 * 17e6)
    # What is worn off no longer hangs: 0.2 of 1.35 g over 240 m less for droppers, arms and ends.
    assert heights(section).max() > heights(formed(LINE)).max()
    lengths = section.lengths / formed(LINE).lengths
    np.testing.assert_allclose(lengths, 1.0 + 1.7e-5 * 40.0, rtol=1e-12)


def test_a_wire_between_anchored_ends_loses_tension_as_it_loses_section() -> None:
    """At the same strain: a level wire, but for the 0.05 % by which it rises."""
    section = in_condition({**LINE, "ends": "anchored"}, wear=0.3)
    assert section.plan.wires[0].tension == pytest.approx(0.7 * 20e3, rel=1e-3)


@pytest.mark.parametrize("rise", [-30.0, 40.0])
def test_a_messenger_between_anchored_ends_follows_the_equation_of_state(rise: float) -> None:
    """A messenger that carries next to nothing is a parabola: S = L (1 + (q L / H)^2 / 24) / (1 + H / EA)."""
    line = {
        **LINE, "contact_wire": {"mass": 1e-3, "tension": 10, "bending_stiffness": 0, "axial_stiffness": 5e3},
        "messenger_wire": {"mass": 1.07, "tension": 3e3, "bending_stiffness": 0, "axial_stiffness": 14e6},
        "droppers": {"per_span": 3}, "system_height": "3 m", "steady_arms": {"mass": 0}, "ends": "anchored",
    }  # fmt: skip
    found = in_condition(line, temperature_rise=rise).plan.wires[1].tension
    q, L, EA = (1.07 + 1e-3) * G, 60.0, 14e6

    def S(H: float) -> float:
        u = q * L / H
        return L * (1.0 + u**2 / 24.0 - u**4 / 640.0) / (1.0 + H / EA)

    exact = brentq(lambda H: S(H) - S(3e3) * (1.0 + 1.7e-5 * rise), 500.0, 20e3)
    assert abs(exact / 3e3 - 1.0) > 0.1
    assert found == pytest.approx(exact, rel=2e-3)  # slopes to 0.1: tension along the chord beside that of the links


def test_what_cannot_hang_is_refused() -> None:
    with pytest.raises(EquilibriumError, match=r"overhead line section: .*anchored"):
        in_condition({**LINE, "ends": "anchored"}, temperature_rise=5000.0)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"condition": {"missing_droppers": [[5, 1]]}}, "no such span.*1 to 4"),
        ({"condition": {"missing_droppers": [[2, 10]]}}, "no such dropper.*1 to 9"),
        ({"condition": {"missing_droppers": [[2, 1], [2, 1]]}}, "is named twice"),
        ({"condition": {"missing_droppers": [5]}}, "expected a span and the number"),
        ({"condition": {"missing_droppers": 5}}, "expected droppers"),
        ({"condition": {"wear": "60 %"}}, "the wear is larger than that of any contact wire"),
        ({"condition": {"expansion": 2e-5}}, "there is no change of temperature"),
        ({"condition": {"wear": 0.1}, "ends": "anchored", "steady_arms": {"stagger": 0.2}}, "requires ends: weights"),
    ],
)
def test_conditions_that_cannot_be_are_refused(change: dict[str, Any], says: str) -> None:
    with pytest.raises(ValidationError, match=says):
        Scenario.model_validate({"overhead_lines": {"line": {**LINE, **change}}})


@pytest.mark.parametrize("geometry", ["linearised", "nonlinear"])
def test_a_pantograph_feels_a_missing_dropper_where_it_was(geometry: str) -> None:
    """Before it the runs are one; under it the wire is lower at rest, by what statics say."""
    line = {**LINE, "spans": {"count": 3, "length": "60 m"}, "analysed_spans": [2, 2], "element": 1.0}
    load = {"kind": "pantograph", "on": "line", "model": "en50318-2002",
            "travel": {"speed": "50 m/s", "from": "40 m"}}  # fmt: skip
    run = {"kind": "dynamic", "geometry": geometry, "until": 1.2, "every": 0.05}

    def result(**more: Any) -> Any:
        tree = {"overhead_lines": {"line": {**line, **more}}, "loads": {"ride": load}, "run": run}
        return simulate(Scenario.model_validate(tree))

    whole, failed = result(), result(condition={"missing_droppers": [[2, 5]]})
    assert "line.2.5" in whole.tie.values.tolist()
    assert "line.2.5" not in failed.tie.values.tolist()
    contact = failed.line.values == "line.contact"
    lower = (failed.position[0, contact, -1] - whole.position[0, contact, -1]).values
    statics = heights(in_condition(line, missing_droppers=[[2, 5]])) - heights(formed(line))
    assert lower.min() == pytest.approx(statics.min(), rel=0.02)
    force = [r.sampled_force.values[1:, :, 0].ravel() for r in (whole, failed)]
    size = min(map(np.size, force))
    near = np.abs(force[0][:size] - force[1][:size])
    assert np.nanmax(near[: int(0.3 / 1e-3)]) < 0.25 * np.nanmax(near)
