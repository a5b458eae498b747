"""FMUs in whole runs: what they miss stands at its line, and what goes wrong leaves a result up to there."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

pytest.importorskip("fmpy", reason="FMUs need FMPy")

from external.fmus import MOODS, c_fmu
from ropewalk import Scenario, simulate
from ropewalk.cli.app import app

FILE = """\
lines:
  string: {start: [0, 0], end: [20, 0], tension: 10 kN, mass: 1, axial_stiffness: 1 MN, elements: 40}
loads:
  cart:
    kind: fmu
    on: string
    file: CART
    contacts:
      wheel: {force: forse, height: height}
    travel: {speed: 20}
    parameters: {mass: heavy}
run: {kind: dynamic, until: 0.3, every: 0.01}
"""


def run(file: Path, mood: str = "good", **more: Any) -> Any:
    line = {"start": [0, 0], "end": [20, 0], "tension": 1e4, "mass": 1.0, "axial_stiffness": 1e6, "elements": 20}
    cart = {
        "kind": "fmu", "on": "string", "file": str(file), "contacts": {"w": {"force": "force", "height": "height"}},
        "travel": {"speed": 20.0}, "parameters": {"mood": mood, "at": 0.2}, **more,
    }  # fmt: skip
    ask = {"kind": "dynamic", "until": 0.3, "every": 0.01}
    return simulate(Scenario.model_validate({"lines": {"string": line}, "loads": {"cart": cart}, "run": ask}))


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return c_fmu(tmp_path_factory.mktemp("fmu"))


def test_a_good_fmu_runs_to_the_end_and_is_the_same_in_its_own_process(file: Path) -> None:
    here, apart = run(file), run(file, isolated=True)
    assert here.outcome == apart.outcome
    assert here.outcome in ("completed", "doubtful")  # its force comes suddenly, on a coarse line
    np.testing.assert_array_equal(here.position, apart.position)
    assert float(here.exchange_work[-1, 0]) > 0.0


@pytest.mark.parametrize(
    ("mood", "said", "isolated"),
    [
        ("nan", "gives no number for force", False),
        ("discard", "refuses the step from t = 0.2 s to 0.201 s", False),
        ("error", "t = 0.2 s", False),
        ("segfault", "ended by SIGSEGV, in the step from t = 0.2 s", True),
        ("hang", "has not answered for 1 s on the clock", True),
    ],
)
def test_an_fmu_that_misbehaves_leaves_a_result_up_to_there(file: Path, mood: str, said: str, isolated: bool) -> None:
    assert mood in MOODS
    found = run(file, mood, isolated=isolated, patience=1.0)
    assert found.outcome == "load failed"
    assert said in found.advice
    assert 0.2 <= float(found.time[-1]) < 0.22
    assert np.isfinite(found.position.values).all()


def test_an_fmu_that_ends_the_process_is_no_success(tmp_path: Path, file: Path) -> None:
    """C's exit(0) in the process of the run; where that has gone well, its own end is no failure."""
    text = FILE.replace("CART", str(file)).replace("force: forse", "force: force")
    ended = "load cart: its FMU .* has ended the whole process; write isolated"
    for mood, codes, message in (("quit", (1,), ended), ("good", (0, 4), "$")):  # its force comes suddenly: doubtful
        (tmp_path / "case.yaml").write_text(text.replace("mass: heavy", f"mood: {mood}, at: 0.2"), encoding="utf-8")
        command = [sys.executable, "-m", "ropewalk", "run", "case.yaml", "--quiet", "-o", f"{mood}.nc"]
        found = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert found.returncode in codes, found.stderr
        assert re.match(message, found.stderr), found.stderr


def test_mistakes_about_an_fmu_stand_at_their_lines(tmp_path: Path, file: Path) -> None:
    scenario = tmp_path / "case.yaml"
    scenario.write_text(FILE.replace("CART", str(file)), encoding="utf-8")
    done = CliRunner().invoke(app, ["check", str(scenario)])
    assert done.exit_code == 2
    assert f"{scenario}:9: loads.cart.contacts.wheel.force: the FMU has no such variable" in done.stderr
    assert f"{scenario}:11: loads.cart.parameters.mass: " in done.stderr
    missing = CliRunner().invoke(app, ["run", str(scenario), "--set", "loads.cart.file=gone.fmu"])
    assert missing.exit_code == 2
    assert "--set loads.cart.file: there is no such file, given gone.fmu" in missing.stderr
    assert not list(tmp_path.glob("*.nc"))


def test_inputs_that_nothing_sets_are_remarked(file: Path) -> None:
    """The vehicle has a damper, which feels no velocity that it is not given."""
    (said,) = [line for line in str(run(file).attrs["warnings"]).splitlines() if "nothing sets" in line]
    assert "velocity, place, push" in said
    given = {"w": {"force": "force", "height": "height", "velocity": "velocity", "place": "place"}}
    told = run(file, contacts=given, start_values={"push": 0.0})
    assert "nothing sets" not in told.attrs["warnings"]


@pytest.mark.parametrize("until", ["crossing", "crossing + 0.1 s"])
def test_a_run_lasts_until_it_has_crossed(file: Path, until: str) -> None:
    line = {"start": [0, 0], "end": [20, 0], "length": 20.1, "mass": 1.0, "axial_stiffness": 1e6, "elements": 20}
    cart = {"kind": "fmu", "on": "string", "file": str(file), "contacts": {"w": {"force": "force", "height": "height"}},
            "travel": {"speed": 20.0}}  # fmt: skip
    ask = {"kind": "dynamic", "until": until, "every": 0.01}
    scenario = Scenario.model_validate({"lines": {"string": line}, "loads": {"cart": cart}, "run": ask})
    assert float(scenario.run.until) == pytest.approx(20.1 / 20.0 + (0.1 if "+" in until else 0.0), rel=1e-9)  # type: ignore[union-attr]
