"""The command `sweep`: text in, files and exit codes out; stopped by anything, it goes on where it was."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time

import pandas as pd
import pytest
from typer.testing import CliRunner

import sweep_cases as cases
from ropewalk.cli.app import app

RUNNER = CliRunner()
OVER = ["--over", "lines.rope.length=10.5:10.7:0.1 m"]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rope.yaml").write_text(cases.TEXT, encoding="utf-8")
    return tmp_path


def run(*words, code=0):
    done = RUNNER.invoke(app, ["sweep", "rope.yaml", *words, "--workers", "0"])
    assert done.exit_code == code, done.output
    return done


def test_it_writes_what_it_is_asked_for_and_prints_the_table(folder):
    done = run(*OVER, "--record", "largest_sag", *(w for k in ("nc", "csv", "png") for w in ("-o", f"out.{k}")))
    assert "length [m]" in done.stdout
    assert done.stderr.splitlines() == [
        *(f"out.{kind} written" for kind in ("nc", "csv", "png")),
        "3 cases: 3 completed",
    ]
    table = pd.read_csv("out.csv")
    assert table["length [m]"].tolist() == [10.5, 10.6, 10.7]
    assert (folder / "rope.sweep.jsonl").exists()
    displayed = RUNNER.invoke(app, ["show", "out.nc", "-o", "again.csv"])
    assert "again.csv written" in displayed.stderr
    assert (folder / "again.csv").read_bytes() == (folder / "out.csv").read_bytes()
    message = json.loads(run(*OVER, "--record", "largest_sag", "--json").stdout)
    assert [row["largest_sag [m]"] for row in message["cases"]] == table["largest_sag [m]"].tolist()


def test_failed_cases_are_said_with_the_exit_code_of_runs(folder):
    done = run("--over", "lines.rope.length=10.5,-1", "-o", "out.csv", code=3)
    assert "2 cases: 1 completed, 1 failed" in done.stderr


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--over", "lines.rope.length"], "--over: this is not KEY=VALUE"),
        (["--over", "lines.rope.length=5:1:1"], "--over: lines.rope.length: the step does not lead"),
        ([*OVER, "--record", "largest_sga"], "--record: sweep.record: a run of this kind has no such quantity"),
        (
            [*OVER, "--derive", "run.until=5 s / sped"],
            "--derive: sweep.derived: run.until = 5 s / sped",
        ),
        ([*OVER, *OVER], "is given twice"),
        ([], "rope.yaml:1: sweep.over: nothing varies"),
        ([*OVER, "-o", "out.txt"], "a sweep is written as"),
        ([*OVER, "-o", "nowhere/out.csv"], "the folder nowhere does not exist"),
        ([*OVER, "--store", "rope.yaml"], "exists and is no store of a sweep"),
    ],
)
def test_mistakes_are_told(words, message):
    assert message in run(*words, code=2).stderr


def start(*words):
    command = [sys.executable, "-m", "ropewalk", "sweep", "rope.yaml", *words, "--workers", "1"]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)


def is_gone(group):
    """Whether no process of a group is left; Python's own tracker of resources ends by itself soon after."""
    for _ in range(1000):
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.02)
    return False


@pytest.fixture(autouse=True)
def _heard():
    """Shells let what they run in the background ignore Ctrl-C: tests, too, and all that these start."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def lines(folder):
    store = folder / "rope.sweep.jsonl"
    return store.read_bytes().splitlines()[1:] if store.exists() else []


MANY = ["--over", "lines.rope.length=10.5:10.9:0.01 m", "--record", "largest_sag", "-o", "out.csv"]


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_with_the_part_that_is_done_and_leaves_no_process(folder, how):
    process = start(*MANY)
    while len(lines(folder)) < 3 and process.poll() is None:
        time.sleep(0.01)
    os.killpg(process.pid, how) if how == signal.SIGINT else process.send_signal(how)
    _, message = process.communicate(timeout=60)
    assert process.returncode == 130, message
    assert "of 41 cases are finished and kept in rope.sweep.jsonl: the same command continues it" in message
    table = pd.read_csv("out.csv")
    assert (table["outcome"] == "completed").sum() == len(lines(folder)) < 41
    assert is_gone(process.pid)


def test_killed_at_random_it_loses_nothing_and_computes_nothing_twice(folder):
    chance, before = random.Random(4), 0
    for _ in range(2):
        process = start(*MANY)
        aim = before + chance.randrange(1, 10)
        while len(lines(folder)) < aim and process.poll() is None:
            time.sleep(0.005)
        process.kill()
        process.communicate()
        assert len(lines(folder)) >= before
        before = len(lines(folder))
    with start(*MANY) as process:
        process.communicate()
    keys = [json.loads(line)["key"] for line in lines(folder)]
    assert len(keys) == len(set(keys)) == 41
    table = pd.read_csv("out.csv").drop(columns="seconds [s]")
    (folder / "rope.sweep.jsonl").unlink()
    run(*MANY)
    pd.testing.assert_frame_equal(table, pd.read_csv("out.csv").drop(columns="seconds [s]"), check_exact=True)
