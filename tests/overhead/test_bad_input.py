"""What cannot be is refused, or ends with a partial result: every message says what is wrong, given, and to be done."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

from overhead_cases import EN_2002, formed, rested
from ropewalk.cli.app import app
from ropewalk.errors import RopewalkError
from ropewalk.model import Scenario
from ropewalk.results import open_result
from ropewalk.scenario import load, loads
from ropewalk.simulate import simulate

EXAMPLE = Path(__file__).parents[2] / "examples" / "en50318-2002-250.yaml"
LINE, LOAD = "overhead_lines.line.", "loads.pantograph."


def said(*settings: str) -> str:
    """What a run of the example with other settings is refused with."""
    with pytest.raises(RopewalkError) as caught:
        simulate(load(EXAMPLE, settings))
    return str(caught.value)


@pytest.mark.parametrize(
    ("settings", "parts"),
    [
        (
            [f"{LINE}droppers.at=[5 m, 10.5 m, 62 m]"],
            [f"{LINE}droppers.at.2: the dropper stands outside its span", "given 62 m in span 1 of 60 m",
             "write places between 0 m and 60 m, from the start of the span"],
        ),
        (
            [f"{LINE}system_height=0.6 m"],
            ["overhead line line: dropper line.1.5 would have to be -0.0685", "m long (30 of 90 are too short)",
             "give more system_height (it is 0.6 m), more tension to messenger_wire (it is 16000 N), or shorter spans"],
        ),
        (
            [f"{LOAD}travel.from=700 m"],
            [f"{LOAD}travel.from: the load would start beyond the end of line, given 700 m", "start at most 600 m"],
        ),
        ([f"{LOAD}travel.from=-5 m"], [f"{LOAD}travel.from: must not be negative, given '-5 m'; write 0 m or more"]),
        (
            ["run.until=9 s"],
            [f"{LOAD}travel.speed: the load passes the end of line at 8.496 s and the run ends at 9 s",
             "write run.until: 8.496 s, change speed or from, or write at_end: leave"],
        ),
        (
            [f"{LOAD}travel.speed=-250 km/h"],
            [f"{LOAD}travel.speed: the load passes the start of line at 0.144 s", "or write at_end: leave"],
        ),
        ([f"{LOAD}on=lin"], [f"{LOAD}on: no such line, given 'lin'; did you mean line?"]),
        ([f"{LOAD}on=rail"], [f"{LOAD}on: no such line, given 'rail'; lines here: line"]),
        ([f"{LOAD}model=simple_ac"], [f"{LOAD}model: no such published pantograph", "did you mean simple-ac?"]),
        ([f"{LOAD}mean_force=acc"], [f"{LOAD}mean_force: no such mean force, given 'acc'; did you mean ac?"]),
        (
            [f"{LOAD}irregularity=missing.csv"],
            [f"{LOAD}irregularity: the file cannot be read", "missing.csv (No such file or directory)",
             "name a text file next to the scenario"],
        ),
    ],
)  # fmt: skip
def test_settings_that_cannot_be_are_refused(settings: list[str], parts: list[str]) -> None:
    message = said(*settings)
    print(message)
    for part in parts:
        assert part in message


def problems(text: str) -> str:
    with pytest.raises(RopewalkError) as caught:
        loads(text, "line.yaml")
    print(caught.value)
    return str(caught.value)


DYNAMIC = "  kind: dynamic\n  geometry: linearised\n  until: 8.35 s\n  every: 50 ms"


def test_a_pantograph_runs_under_overhead_lines_only() -> None:
    wire = "  wire: {start: [0, 0], end: [600, 0], tension: 1 kN, mass: 1, axial_stiffness: 100 kN}"
    text = EXAMPLE.read_text(encoding="utf-8").replace("loads:", f"lines:\n{wire}\nloads:")
    message = problems(text.replace("on: line", "on: wire"))
    assert "loads.pantograph.on: a pantograph runs under an overhead line, given 'wire'" in message
    assert "name one of overhead_lines: line" in message


def test_trolleys_do_not_rest_on_overhead_lines() -> None:
    trolley = "    mass: 100 kg\n    payload: {mass: 50 kg, length: 2 m}\n"
    text = EXAMPLE.read_text(encoding="utf-8").replace("    model: en50318-2002\n", trolley)
    text = text.replace("kind: pantograph", "kind: trolley")
    loads(text, "line.yaml")  # in motion they do
    message = problems(text.replace(DYNAMIC, "  kind: equilibrium"))
    assert "loads.pantograph.kind: is not implemented for" in message
    assert "overhead lines, given trolley; ask for kind: dynamic" in message


def test_masses_that_start_beyond_the_end_or_meet_are_refused() -> None:
    """As they are on lines."""
    text = EXAMPLE.read_text(encoding="utf-8").replace("    model: en50318-2002\n", "    mass: 100 kg\n")
    text = text.replace("kind: pantograph", "kind: mass")
    assert "would start beyond the end of line" in problems(text.replace("from: 10 m", "from: 601 m"))
    other = "loads:\n  other: {kind: mass, mass: 5 kg, on: line, travel: {speed: 10 m/s, from: 30 m}}"
    assert "meets load other at" in problems(text.replace("loads:", other))


def test_droppers_that_are_much_too_long_hang_slack_and_the_wire_alone() -> None:
    droppers = EN_2002["droppers"] | {"lengths": [2.0] * 9}
    arms = {"mass": 0.0, "free": False}
    section = formed(EN_2002, spans=[60.0] * 3, droppers=droppers, steady_arms=arms, analysed_spans=[2, 2])
    assert section.slack == tuple(section.droppers)
    assert section.pull == pytest.approx(np.zeros(27))
    _, heights = rested(section)
    # w L^2 / (8 T) in the middle of each span; second order of links of 0.5 m: none, as a parabola has none.
    assert heights[[4, 13, 22]] == pytest.approx(np.full(3, -1.35 * 9.81 * 60.0**2 / (8.0 * 20e3)), rel=1e-6)


@pytest.mark.parametrize(("geometry", "step"), [("linearised", "5 ms"), ("nonlinear", "10 ms")])
def test_an_unstable_step_ends_with_a_partial_result_and_advice(geometry: str, step: str, tmp_path: Path) -> None:
    """Steps are parts of the interval of samples: long steps need such samples, too."""
    target = tmp_path / "blown-up.nc"
    settings = [f"run.geometry={geometry}", f"run.step={step}", f"run.sample={step}", "run.until=2 s"]
    arguments = ["run", str(EXAMPLE), "-o", str(target), "-q", *(part for s in settings for part in ("--set", s))]
    outcome = CliRunner().invoke(app, arguments)
    assert outcome.exit_code == 3
    assert "the run stopped early: diverged; the computed part is kept in" in outcome.stderr
    assert f"its step of {float(step[:-3]) / 1e3:g} s is larger than the stable one of 0.001" in outcome.stderr
    assert "write a smaller run.step, or leave it out" in outcome.stderr
    with open_result(target) as result:
        assert isinstance(result, xr.Dataset)
        assert result.attrs["outcome"] == "diverged"
        assert 1 <= result.sizes["time"] < 41
        # What is kept is from before it was noticed: nothing has moved further than lines do.
        assert np.isfinite(result.position.values).all()
        assert np.abs(result.position.values - result.position.values[0]).max() < 2.0 * 600.0
    displayed = CliRunner().invoke(app, ["show", str(target)])
    assert displayed.exit_code == 0, displayed.output
    assert "advice: after t = " in displayed.output


def test_an_unstable_step_that_stays_bounded_is_warned_of() -> None:
    """Droppers that slacken and wires that stretch keep the swinging at bay: only the warning and the audit tell."""
    settings = ("run.geometry=nonlinear", "run.step=3 ms", "run.sample=3 ms", "run.until=0.6 s", f"{LINE}element=0.5 m")
    result = simulate(load(EXAMPLE, settings))
    assert result.attrs["outcome"] == "doubtful"
    assert "the step of 0.00294 s is larger than " in result.attrs["warnings"]
    assert "up to which the motion is stable" in result.attrs["warnings"]
    assert "write a smaller run.step, or leave it out" in result.attrs["warnings"]
    assert not simulate(load(EXAMPLE, ("run.until=0.1 s",))).attrs["warnings"]


@pytest.mark.parametrize("geometry", ["linearised", "nonlinear"])
def test_outputs_may_stand_as_close_as_they_are_asked_for(geometry: str) -> None:
    """Closer than a billionth of a second, of which intervals of several models are multiples."""
    line = {**EN_2002, "spans": {"count": 3, "length": "60 m"}, "analysed_spans": [2, 2], "element": "3 m"}
    tree = {
        "overhead_lines": {"line": line},
        "loads": {"one": {"kind": "pantograph", "on": "line", "model": "en50318-2002", "travel": {"speed": 50.0}}},
        "run": {"kind": "dynamic", "geometry": geometry, "until": "1e-12 s", "every": "5e-14 s"},
    }  # fmt: skip
    result = simulate(Scenario.model_validate(tree))
    np.testing.assert_allclose(result["time"], 5e-14 * np.arange(21), atol=1e-15)
    assert "(loads.one.ramp)" in result.attrs["doubts"]  # it has hardly begun to press
