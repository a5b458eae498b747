"""Where external code is forbidden none runs, whatever leads to it: a load of the file, a case, a design, a map."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from ropewalk.cli.app import app
from ropewalk.errors import ScenarioError
from ropewalk.external.models import model_of
from ropewalk.mechanics.contact_points import contacts_of
from ropewalk.model.fmu import Fmu
from ropewalk.model.stepper import Stepper
from ropewalk.permission import VARIABLE

CODE = 'import pathlib\npathlib.Path("has_run").touch()\nclass X:\n    pass\n'
STEPPER = '{kind: stepper, on: s, model: "evil.py:X", every: 10 ms}'
REFUSED = "loads.w.model: is external code, which --no-code refuses, given evil.py:X; omit --no-code"


def scenario(force: float = -100.0) -> dict[str, Any]:
    rope = {"start": [0, 0], "end": [20, 0], "tension": 2e4, "mass": 1.0, "axial_stiffness": 2e6, "elements": 8}
    push = {"kind": "force", "on": "s", "force": [0, force], "travel": {"speed": 5.0, "from": 2.0}}
    return {"lines": {"s": rope}, "loads": {"w": push}, "run": {"kind": "dynamic", "until": 0.03, "every": 0.01}}


SWEEP = {"over": {"loads.w": [STEPPER]}}
MIXED = {"over": {"loads.w": [json.dumps(scenario()["loads"]["w"]), STEPPER]}}
# Ways to a stepper that the file itself does not hold: command, and what is added to the file.
WAYS = {
    "sweep of the file": (["sweep"], SWEEP),
    "sweep of the file, some cases sound": (["sweep"], MIXED),
    "sweep in this process": (["sweep", "--workers", "0"], SWEEP),
    "zip": (["sweep", "--combine", "zip"], SWEEP),
    "a setting of design": (["design", "--minimise", "largest_sag", "--vary", "lines.s.tension=10:20 kN",
                             "--set", f"loads.w={STEPPER}"], None),
    "a setting of fit": (["fit", "--data", "d.csv", "--vary", "lines.s.tension=10:20 kN",
                          "--set", f"loads.w={STEPPER}"], None),
    "a setting of adequacy": (["adequacy", "--x", "lines.s.tension=1e4:2e4:2", "--y", "lines.s.mass=1:2:2",
                               "--set", f"loads.w={STEPPER}"], None),
    "a setting": (["run", "--set", f"loads.w={STEPPER}"], None),
    "a setting of compare": (["compare", "--set", f"loads.w={STEPPER}"], None),
    "a setting of feedback": (["feedback", "--set", f"loads.w={STEPPER}"], None),
    "a setting of export": (["export", "--line", "s", "-o", "x.fmu", "--set", f"loads.w={STEPPER}"], None),
}  # fmt: skip


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "evil.py").write_text(CODE)
    (tmp_path / "d.csv").write_text("quantity, value\nlargest_sag, 30 mm\n")
    return tmp_path


@pytest.mark.parametrize("way", WAYS)
def test_no_code_runs_in_any_case_where_it_is_forbidden(way: str, here: Path) -> None:
    (command, *options), sweep = WAYS[way]
    (here / "s.yaml").write_text(json.dumps(scenario() | ({"sweep": sweep} if sweep else {})))
    found = CliRunner().invoke(app, [command, "s.yaml", *options, "--no-code"])
    assert not (here / "has_run").exists(), found.output
    assert found.exit_code != 0 or "some cases" in way
    assert not isinstance(found.exception, AssertionError | AttributeError | KeyError), found.output


def test_a_case_of_external_code_is_refused_with_key_and_remedy(here: Path) -> None:
    (here / "s.yaml").write_text(json.dumps(scenario() | {"sweep": SWEEP}))
    found = CliRunner().invoke(app, ["sweep", "s.yaml", "--no-code"])
    assert found.exit_code == 2
    assert REFUSED in found.output


def test_sound_cases_are_computed_and_the_others_say_why_not(here: Path) -> None:
    (here / "s.yaml").write_text(json.dumps(scenario() | {"sweep": MIXED | {"record": ["max tension"]}}))
    found = CliRunner().invoke(app, ["sweep", "s.yaml", "--no-code", "--workers", "0", "-o", "s.csv"])
    table = (here / "s.csv").read_text()
    assert "completed" in table, found.output
    assert "is external code, which --no-code refuses" in table


def test_the_environment_forbids_code_in_python_too(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The two functions through which all external code is loaded ask, so that later work cannot pass them by."""
    monkeypatch.setenv(VARIABLE, "1")
    travel = {"speed": 1.0}
    fmu = Fmu(on="s", file="car.fmu", contacts={"a": {"force": "f"}}, travel=travel)
    with pytest.raises(ScenarioError, match=r"loads\.car\.file: is external code"):
        model_of("car", fmu, 1.0, 2)
    stepper = Stepper(on="s", model="evil.py:X", every=0.01)
    with pytest.raises(ScenarioError, match=r"loads\.w\.model: is external code"):
        contacts_of("w", stepper)
    with pytest.raises(ScenarioError, match=r"loads\.w\.model: is external code"):
        model_of("w", stepper, 1.0, 2)
    assert not (here / "has_run").exists()


def test_what_one_command_forbids_the_next_may_do(here: Path) -> None:
    (here / "s.yaml").write_text(json.dumps(scenario()))
    runner = CliRunner()
    assert runner.invoke(app, ["run", "s.yaml", "--no-code", "-q"]).exit_code == 0
    runner.invoke(app, ["run", "s.yaml", "--set", f"loads.w={STEPPER}"])
    assert (here / "has_run").exists()
