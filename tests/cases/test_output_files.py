"""Commands write every file that is requested, or refuse a second one."""

from __future__ import annotations

import pytest
from typer.testing import CliRunner

from ropewalk.cli.app import app

ROPE = """
lines: {rope: {start: [0, 0], end: [20, 0], length: 20.1, mass: 1, axial_stiffness: 1 MN, elements: 6}}
run: {kind: equilibrium}
"""


@pytest.fixture
def call(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rope.yaml").write_text(ROPE)
    return lambda *arguments: CliRunner().invoke(app, list(arguments))


def test_show_writes_each_of_several_files(call, tmp_path):
    assert call("run", "rope.yaml", "-q").exit_code == 0
    found = call("show", "rope.nc", "-o", "a.png", "-o", "b.csv", "-o", "c.html")
    assert found.exit_code == 0
    assert {file.name for file in tmp_path.iterdir()} >= {"a.png", "b.csv", "b.summary.csv", "c.html"}
    assert found.stderr.splitlines() == ["a.png written", "b.csv and b.summary.csv written", "c.html written"]


def test_show_checks_all_files_before_it_writes_one(call, tmp_path):
    call("run", "rope.yaml", "-q")
    assert call("show", "rope.nc", "-o", "a.png", "-o", "b.jpeg2").exit_code == 2
    assert not (tmp_path / "a.png").exists()


def test_spectrum_writes_each_of_several_figures(call, tmp_path):
    assert call("spectrum", "rope.yaml", "-o", "a.png", "-o", "b.svg").exit_code == 0
    assert {file.name for file in tmp_path.iterdir()} >= {"a.png", "b.svg"}


def test_a_second_file_of_a_command_that_writes_one_is_refused(call, tmp_path):
    found = call("run", "rope.yaml", "-o", "a.nc", "-o", "b.nc")
    assert found.exit_code == 2
    assert "--output: is given 2 times, but this command writes one file; give it once" in found.stderr
    assert not (tmp_path / "a.nc").exists()


def test_of_other_options_the_last_value_counts(call):
    call("run", "rope.yaml", "-q")
    assert " kN " in call("show", "rope.nc", "--units", "SI", "--units", "kN").stdout
