"""Texts of files reach the terminal without signs that control it, whatever command prints them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from ropewalk.cli.app import app

EVIL = "\x1b]0;pwned\x07\x1b[31mred\x9b2J\x7f\u202e"
TREE = {
    "title": EVIL,
    "lines": {"s": {"start": [0, 0], "end": [20, 0], "tension": 2e4, "mass": 1, "axial_stiffness": 2e6, "elements": 4}},
    "loads": {"w": {"kind": "force", "on": "s", "force": [0, -100], "travel": {"speed": 5, "from": 2}}},
    "run": {"kind": "dynamic", "until": 0.02, "every": 0.01},
    "sweep": {"over": {"lines.s.tension": [2e4, EVIL], "lines.s.mass": [1.0]}},
}


@pytest.mark.parametrize(
    "command",
    [
        ["check", "s.json"], ["run", "s.json", "-o", "out.nc"], ["run", "s.json", "-o", "out.nc", "--json"],
        ["sweep", "s.json", "--workers", "0"], ["run", f"{EVIL}.json"], ["run", "s.json", "--set", f"lines.{EVIL}=1"],
        ["show", "out.nc"], ["show", "out.nc", "--json"], ["spectrum", "s.json"], ["compare", "s.json"],
        ["feedback", "s.json"], ["calc", EVIL], ["run", "s.json", "--units", EVIL],
    ],
    ids=lambda command: " ".join(command).replace(EVIL, "EVIL"),
)  # fmt: skip
def test_no_sign_that_controls_a_terminal_is_printed(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("s.json").write_text(json.dumps(TREE))
    runner = CliRunner()
    if command[0] == "show":
        runner.invoke(app, ["run", "s.json", "-o", "out.nc", "-q"])
    output = runner.invoke(app, command).output
    assert output
    bad = {sign for sign in output if not sign.isprintable() and sign not in "\n\t"}
    assert not (bad if "--json" not in command else bad - {"\u202e"}), output[:200]


def test_json_stays_what_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("s.json").write_text(json.dumps(TREE))
    found = CliRunner().invoke(app, ["run", "s.json", "--json", "-q"])
    assert json.loads(found.stdout)["title"] == EVIL
