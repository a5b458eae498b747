"""Kernels compiled ahead of the first run."""

import os
import subprocess
import sys

import pytest

from ropewalk import warming
from ropewalk.errors import RopewalkError
from ropewalk.scenario import loads

LINE = """
lines:
  rope: {start: [0, 0], end: [9, 0], length: 10, mass: 1, axial_stiffness: 1e5, elements: 4}
loads:
  one: {kind: force, force: [0, -1], on: rope, travel: {speed: 5, from: 1 m}}
run: {kind: dynamic, until: 1, every: 0.5, method: verlet}
"""


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A folder of kernels of its own, in which plain Python keeps nothing but marks."""
    monkeypatch.setattr(warming, "folder", lambda: tmp_path)
    return tmp_path


def message_of(groups, monkeypatch, answer):
    asked = []

    def each(tasks, compute, processes, lost):
        for task in tasks:
            asked.append((task[0], processes))
            yield task, answer

    monkeypatch.setattr(warming, "each", each)
    message = []
    return warming.warm_up(groups, 2, lambda what, part: message.append((what, part))), asked, message


def test_groups_are_compiled_once_side_by_side(place, monkeypatch):
    groups = {"one": ["a"], "two": ["b", "c"], "three": ["d"]}
    done, asked, message = message_of(groups, monkeypatch, (7, 12.3))
    assert done == dict.fromkeys(groups, "7 kernels compiled in 12 s")
    assert asked == [("one", 2), ("two", 2), ("three", 2)]
    assert [round(part, 2) for _, part in message] == [0.0, 0.33, 0.67, 1.0]
    done, asked, _ = message_of({"one": ["a"], "two": ["b"]}, monkeypatch, (0, 0.0))
    assert done == {"one": "there already", "two": "there already"}
    assert asked == [("two", 1)]  # other scenarios than those of before


def test_marks_are_for_one_processor(place, monkeypatch):
    message_of({"one": ["a"]}, monkeypatch, (7, 12.3))
    monkeypatch.setattr(warming, "processor", lambda: "another")
    assert message_of({"one": ["a"]}, monkeypatch, (7, 12.3))[1] == [("one", 1)]


def test_a_process_that_died_leaves_no_mark(place, monkeypatch):
    with pytest.raises(RopewalkError, match="one: the process that compiled died"):
        message_of({"one": ["a"]}, monkeypatch, None)
    assert message_of({"one": ["a"]}, monkeypatch, (7, 12.3))[1] == [("one", 1)]


def test_long_runs_are_cut_short(monkeypatch):
    lengths = []
    monkeypatch.setattr(warming, "simulate", lambda scenario: lengths.append((scenario.run.until, scenario.run.every)))
    warming._compile(("one", [LINE]))
    assert lengths == [(1e-4, 1e-4)]


def test_what_most_runs_need_are_scenarios():
    for texts in warming.COMMON.values():
        for text in texts:
            loads(text)


def test_the_command_compiles_what_a_scenario_needs(tmp_path):
    (tmp_path / "one.yaml").write_text(LINE)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache"), "NUMBA_DISABLE_JIT": "1"}
    command = [sys.executable, "-m", "ropewalk", "warm-up", "one.yaml"]
    run = subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert "one.yaml" in run.stdout
    assert len(list(tmp_path.glob("cache/kernels-*/warm-*"))) == 1
    (tmp_path / "one.yaml").write_text(LINE.replace("length: 10", "length: -1"))
    run = subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode != 0
    assert "lines.rope.length" in run.stderr
