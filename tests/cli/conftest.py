"""The command line with a stand-in for the solver, in this process and in one of its own."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

sys.path.insert(0, str(Path(__file__).parent))

import standin

import ropewalk
from ropewalk.cli.app import app
from ropewalk.scenario import template


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty working folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def scenario(folder):
    """Writes rope.yaml with a title and gives its name."""

    def write(title="Rope", name="rope.yaml"):
        (folder / name).write_text(template(title), encoding="utf-8")
        return name

    return write


@pytest.fixture
def call(monkeypatch):
    """Runs the command line in this process."""
    for name, module in (("simulate", standin.SIMULATE), ("paper", standin.PAPER)):
        monkeypatch.setitem(sys.modules, f"ropewalk.{name}", module)
        monkeypatch.setattr(ropewalk, name, module, raising=False)
    return lambda *arguments: CliRunner().invoke(app, [str(a) for a in arguments])


@pytest.fixture(autouse=True)
def _heard():
    """Shells let what they run in the background ignore Ctrl-C: tests, too, and all that these start."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def start(folder):
    """Starts the command line in a process of its own, which does not outlive the test."""
    started = []

    def begin(*arguments):
        command = [sys.executable, standin.__file__, *map(str, arguments)]
        pipe = subprocess.PIPE
        started.append(subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, cwd=folder))
        return started[-1]

    yield begin
    for process in started:
        process.kill()
