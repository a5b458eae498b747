"""The command `design`: text in; the best scenario with the comments of the first one, the course, exit codes out."""

from __future__ import annotations

import json

import pandas as pd
import pytest
from typer.testing import CliRunner

import design_cases as cases
import ropewalk
from ropewalk.cli.app import app
from ropewalk.scenario.editing import edited

ASKED = ["--vary", "lines.string.tension=0.5:4 kN", "--maximise", "lines.string.tension",
         "--subject-to", "max strain < 2 %"]  # fmt: skip


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "string.yaml").write_text(cases.TEXT, encoding="utf-8")
    return tmp_path


def run(*words, code=0):
    done = CliRunner().invoke(app, ["design", "string.yaml", *words, "--workers", "0"])
    assert done.exit_code == code, done.output
    return done


def test_it_writes_the_best_scenario_its_course_and_a_figure(folder):
    done = run(*ASKED, *(w for kind in ("yaml", "csv", "png") for w in ("-o", f"best.{kind}")))
    assert "reached" in done.stdout
    assert "max strain < 2 %" in done.stdout
    written = (folder / "best.yaml").read_text("utf-8")
    assert [row for row in written.splitlines() if "tension" not in row] == [
        row for row in cases.TEXT.splitlines() if "tension" not in row
    ]
    assert "# of steel" in written
    best = ropewalk.load("best.yaml")
    assert best.lines["string"].tension == pytest.approx(cases.tension_before(0.02), rel=2e-4)
    course = pd.read_csv("best.csv")
    assert course["max strain [1]" if "max strain [1]" in course else "max strain"].max() > 0.02
    again = json.loads(run(*ASKED, "--json").stdout)
    assert again["values"]["lines.string.tension"] == f"{best.lines['string'].tension / 1e3!r} kN"


def test_what_cannot_be_is_told_with_the_exit_code_of_runs():
    words = [*ASKED[:4], "--subject-to", "max strain < 0.1 %", "--most", "4"]
    assert "no design keeps the limits: closest to them is" in run(*words, code=3).stderr


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--vary", "lines.string.tension", *ASKED[2:]], "--vary: this is not KEY=LOW:HIGH"),
        ([*ASKED[:2], *ASKED], "is given twice"),
        ([*ASKED, "--subject-to", "strain"], "--subject-to: subject_to: this is no limit"),
        ([*ASKED, "-o", "string.yaml"], "is the scenario that is varied"),
        ([*ASKED, "-o", "best.txt"], "this is written as"),
        (ASKED[:2], "must be minimised or maximised"),
    ],
)
def test_mistakes_are_told(words, message):
    assert message in run(*words, code=2).stderr


def test_a_key_in_a_block_of_blocks_that_is_not_there_is_added():
    text = edited(cases.TEXT, "s.yaml", ["loads.man.friction=0.3", "outputs.cut_off=20 Hz"])
    assert "man: {friction: 0.3, kind: force" in text
    assert text.startswith("outputs: {cut_off: 20 Hz}\ntitle: String\n")


def test_what_cannot_be_set_in_place_is_written_anew():
    text = cases.TEXT.replace("mass: 1,", "mass: &one 1,").replace("speed: 1", "speed: *one")
    changed = edited(text, "s.yaml", ["lines.string.mass=2"])
    assert changed.startswith("# s.yaml, written anew\n")
    assert "speed: 1 m/s" in changed
