"""The command line in a process of its own: signals, pipes, terminals."""

from __future__ import annotations

import os
import pty
import select
import signal
import subprocess
import sys

import standin

from ropewalk.results import open_result


def test_ctrl_c_keeps_the_partial_result(start, scenario, folder):
    with start("run", scenario("slow")) as run:
        assert any("step 10" in line for line in run.stderr)
        run.send_signal(signal.SIGINT)
        stdout, stderr = run.communicate(timeout=120)
    assert run.returncode == 130
    assert stdout == ""
    assert "interrupted; the computed part is kept in rope.nc. `ropewalk show rope.nc` prints its summary" in stderr
    result = open_result(folder / "rope.nc")
    assert result.attrs["outcome"] == "interrupted"
    assert 10 <= result.sizes["time"] < 61


def test_a_kill_leaves_a_result_that_show_understands(start, scenario, folder):
    with start("run", scenario("slow")) as run:
        assert any("step 20" in line for line in run.stderr)
        run.kill()
        run.communicate()
    assert open_result(folder / "rope.nc").attrs["outcome"] == "running"
    with start("show", "rope.nc") as show:
        stdout, _ = show.communicate(timeout=120)
    assert show.returncode == 0
    assert "incomplete (still running, or killed)" in stdout


def test_stdout_and_stderr_are_separate_and_without_a_bar_when_not_terminals(start, scenario):
    with start("run", scenario()) as run:
        stdout, stderr = run.communicate(timeout=120)
    assert run.returncode == 0
    assert "largest tension" in stdout
    assert stderr == "result written to rope.nc\n"


def test_a_terminal_gets_a_bar_on_stderr_only(scenario, folder):
    ours, theirs = pty.openpty()
    command = [sys.executable, standin.__file__, "run", scenario(), "--json"]
    environment = {**os.environ, "TERM": "xterm"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=theirs, cwd=folder, env=environment) as run:
        os.close(theirs)
        seen = b""
        while select.select([ours], [], [], 120)[0]:
            try:
                piece = os.read(ours, 4096)
            except OSError:  # Linux says so when the other side is closed
                break
            if not piece:
                break
            seen += piece
        stdout = run.stdout.read()
    os.close(ours)
    assert b"running" in seen
    assert stdout.startswith(b"{")
    assert b"\x1b" not in stdout


def test_a_closed_pipe_is_no_fault(start, scenario):
    with start("schema") as run:
        run.stdout.close()
        stderr = run.stderr.read()
        run.wait(timeout=120)
    assert "Traceback" not in stderr
    assert "fault" not in stderr
