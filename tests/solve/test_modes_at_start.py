"""A motion that begins with a mode: which lines, which way, how far, how fast, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.errors import EquilibriumError, ScenarioError
from ropewalk.model import Scenario
from ropewalk.scenario import loads
from ropewalk.simulate import simulate
from ropewalk.theory import chain, whirl

STRING: dict[str, Any] = {
    "start": [0, 0], "end": [3, 4], "tension": 100.0, "mass": 0.1, "axial_stiffness": 1e4, "elements": 24,
}  # fmt: skip
CHORD = np.array([0.6, 0.0, 0.8])


def begun(start: dict[str, Any], *, gravity: float = 0.0, until: float = 1e-3, **lines: Any) -> xr.Dataset:
    run = {"kind": "dynamic", "until": until, "every": until, "start": {"kind": "mode", **start}}
    return simulate(Scenario.model_validate({"gravity": gravity, "lines": lines or {"string": STRING}, "run": run}))


def test_the_deflection_is_a_sine_across_the_line_whatever_the_direction() -> None:
    result = begun({"amplitude": 0.2, "number": 3, "direction": [1, 1, 0]})
    place, velocity = result.position.values[0], result.velocity.values[0]
    across = np.array([1.0, 1.0, 0.0]) - 0.6 * CHORD
    across /= np.linalg.norm(across)
    sine = 0.2 * np.sin(3.0 * np.pi * np.linspace(0.0, 1.0, 25))
    assert place @ across == pytest.approx(sine, abs=1e-14)
    assert place @ np.cross(CHORD, across) == pytest.approx(0.0, abs=1e-14)
    assert not velocity.any()
    assert result.tension.values[0] == pytest.approx(result.tension.values[0, 0], rel=1e-9)  # rounding times EA/T
    assert (place[[0, -1]] == [[0, 0, 0], [3, 0, 4]]).all()


def test_upwards_is_the_direction_where_none_is_given() -> None:
    result = begun({"amplitude": 0.2}, string={**STRING, "end": [5, 0]})
    assert result.sizes["axis"] == 2
    assert result.position.values[0, 12] == pytest.approx([2.5, 0.2], abs=1e-12)


def test_a_whirl_turns_right_handed_about_the_line_from_start_to_end() -> None:
    result = begun({"amplitude": 1e-3, "number": 2, "direction": [0, 1, 0], "whirl": True})
    turn = np.cross(CHORD, [0.0, 1.0, 0.0])
    sine = 1e-3 * np.sin(2.0 * np.pi * np.linspace(0.0, 1.0, 25))
    rate = result.velocity.values[0] @ turn / np.where(sine == 0.0, 1.0, sine)
    inner = np.r_[1:12, 13:24]
    stretch = 1.0 + 100.0 / 1e4
    about = {"links": 24, "length": 5.0 / stretch, "axial_stiffness": 1e4, "mass": 0.1}
    exact = chain.transverse_frequencies(**about, stretch=stretch)[1]
    # The amplitude's part of the tension: EA/T (k A)^2 / 4 = 4e-5.
    assert rate[inner] == pytest.approx(exact, rel=1e-4)
    string = whirl.whirl_frequency(
        1e-3, length=5.0, tension=100.0, mass=0.1 / stretch, axial_stiffness=1e4, half_waves=2
    )
    assert rate[inner] == pytest.approx(float(string), rel=(2.0 * np.pi / 24) ** 2 / 24 + 1e-4)  # the links


def test_all_lines_have_the_mode_or_the_one_that_is_named() -> None:
    lines = {"one": {**STRING, "end": [5, 0]}, "two": {**STRING, "start": [0, 1], "end": [5, 1]}}
    both, named = begun({"amplitude": 0.1}, **lines), begun({"amplitude": 0.1, "line": "two"}, **lines)
    assert both.position.values[0, [12, 37], 1] == pytest.approx([0.1, 1.1], abs=1e-12)
    assert named.position.values[0, [12, 37], 1] == pytest.approx([0.0, 1.1], abs=1e-12)


def test_the_mode_is_added_to_a_sagging_line_at_rest() -> None:
    cable = {**STRING, "end": [5, 0], "tension": 10.0, "axial_stiffness": 1e3}
    rest, result = (begun(start, gravity=9.81, cable=cable) for start in ({"amplitude": 1e-9}, {"amplitude": 0.02}))
    sag = -rest.position.values[0, 12, 1]
    assert sag > 0.2
    assert result.position.values[0, 12, 1] + sag == pytest.approx(0.02, abs=1e-7)
    gain = result.tension.values[0] - rest.tension.values[0]
    assert gain == pytest.approx(gain[0], rel=2e-2)  # all links get longer by the same part of their length
    assert gain[0] < 0.0  # the cable is raised


def test_a_load_rides_on_the_deflected_line() -> None:
    force = {"kind": "force", "on": "string", "force": [0, -1], "travel": {"speed": 1, "from": 1.17}}
    run = {"kind": "dynamic", "until": 1e-3, "every": 1e-3, "start": {"kind": "mode", "amplitude": 0.1}}
    string = {**STRING, "end": [5, 0]}
    given = {"gravity": 0, "lines": {"string": string}, "loads": {"force": force}, "run": run}
    result = simulate(Scenario.model_validate(given))
    z = 0.1 * np.sin(np.pi * 1.17 * 1.01 / 5.0)
    assert result.contact_position.values[0, 0, 1] == pytest.approx(z, abs=1e-12)
    assert result.tension.values[0] == pytest.approx(result.tension.values[0, 0], rel=1e-9)


@pytest.mark.parametrize(
    ("amplitude", "number", "why"),
    [
        (0.5, 3, "it hangs too steep for a mode of a string; tighten it"),
        (1.0, 1, "deflected so far it would be pushed together; write a smaller amplitude"),  # up: it sags by 3 m
    ],
)
def test_a_line_too_slack_for_the_mode_is_refused(amplitude: float, number: int, why: str) -> None:
    cable = {**STRING, "end": [4, 0], "tension": None, "length": 8.0}
    with pytest.raises(EquilibriumError, match=f"line cable: {why}"):
        begun({"amplitude": amplitude, "number": number}, gravity=9.81, cable=cable)


PAGE = """
lines:
  string: {start: [0, 0], end: [5, 0], tension: 100, mass: 0.1, axial_stiffness: 1e4, elements: 10}
run: {kind: dynamic, until: 1, start: %s}
"""
MISTAKES = {
    "{kind: mode}": "run.start.amplitude: is required for a start from a mode; add amplitude: the largest "
    "deflection, for example 10 mm",
    "{kind: mode, amplitude: 0}": "run.start.amplitude: must be positive, given 0; write a value above 0 m",
    "{amplitude: 0.1}": "run.start.amplitude: is for kind: mode only; leave it out, or write kind: mode",
    "{kind: mode, amplitude: 0.1, with_loads: true}": "run.start.with_loads: is for kind: rest only; leave it out, "
    "or write kind: rest",
    "{kind: result, file: a.nc, whirl: true}": "run.start.whirl: is for kind: mode only; leave it out: all "
    "positions are read from the result, or write kind: mode",
    "{kind: mode, amplitude: 0.1, direction: [0, 0]}": "run.start.direction: has no direction, given [0.0, 0.0]; "
    "write for example [0, 1]",
    "{kind: mode, amplitude: 0.1, direction: [2, 0]}": "run.start.direction: the direction has no part across string, "
    "given [2.0, 0.0]; write one across the line, for example [0, 1]",
    "{kind: mode, amplitude: 0.1, number: 10}": "run.start.number: string has 10 elements, and its nodes cannot show "
    "so many half waves, given 10; write at most 9, better a tenth of it, or raise elements",
    "{kind: mode, amplitude: 6}": "run.start.amplitude: the ends of string are only 5 m apart, given 6 m; write a "
    "smaller one",
    "{kind: mode, amplitude: 0.1, line: strng}": "run.start.line: no such line, given 'strng'; did you mean string?",
}


@pytest.mark.parametrize("start", MISTAKES)
def test_what_makes_no_sense_is_refused(start: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        loads(PAGE % start, "a.yaml")
    assert str(caught.value) == f"a.yaml:4: {MISTAKES[start]}"


def test_a_rope_without_a_shape_at_rest_cannot_begin_with_a_mode() -> None:
    page = PAGE.replace("tension: 100", "length: 6") % "{kind: mode, amplitude: 0.1}" + "gravity: 0\n"
    with pytest.raises(ScenarioError, match="equilibrium of a line longer than the distance of its ends"):
        loads(page, "a.yaml")
