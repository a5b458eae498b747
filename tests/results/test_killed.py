"""Runs that end badly leave a readable file: killed, without space, without permission."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from ropewalk.results import ResultError, check_target, open_result

HERE = Path(__file__).parent
RUN = f"""
import resource, sys, time
from pathlib import Path
sys.path.insert(0, {str(HERE)!r})
import travelling_wave as wave
from ropewalk.results import Recorder, WriteError, recorder

recorder.SYNC_SECONDS, pause, most = float(sys.argv[2]), float(sys.argv[3]), int(sys.argv[4])
if most:
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
plan = wave.layout(links=400)
some = list(wave.frames(plan))[:20]
try:
    with Recorder(plan, wave.scenario(), wave.run_info(), Path(sys.argv[1])) as record:
        for count in range(20_000):
            record.append(some[count % 20])
            time.sleep(pause)
            if count == 30:
                print("going", flush=True)
except WriteError as problem:
    sys.exit(str(problem))
"""


@contextmanager
def start(file: Path, *, sync: float, pause: float = 0.0, most_bytes: int = 0) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-c", RUN, str(file), str(sync), str(pause), str(most_bytes)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        try:
            yield run
        finally:
            run.kill()


def check_whole(file: Path) -> int:
    """Every frame in the file must be one of the repeating twenty."""
    result = open_result(file)
    assert result.attrs["outcome"] == "running"
    assert result.attrs["method"] == "rkn6"
    values = result["position"].values
    expected = np.resize(values[:20], values.shape)
    np.testing.assert_array_equal(values, expected)
    return result.sizes["time"]


@pytest.mark.parametrize("wait", np.linspace(0.0, 0.09, 4))
def test_a_run_killed_at_any_moment_leaves_a_readable_file(tmp_path, wait):
    with start(tmp_path / "out.nc", sync=0.0) as run:  # synchronise every frame: the kill falls into a write
        assert run.stdout.readline() == "going\n"
        time.sleep(wait)
        run.send_signal(signal.SIGKILL)
        run.wait()
    assert check_whole(tmp_path / "out.nc") >= 31


def test_a_running_file_can_be_read_and_is_never_far_behind(tmp_path):
    with start(tmp_path / "out.nc", sync=0.1, pause=1e-3) as run:
        run.stdout.readline()
        seen, patience = check_whole(tmp_path / "out.nc"), time.monotonic() + 100.0  # on however slow a machine
        while check_whole(tmp_path / "out.nc") == seen and time.monotonic() < patience:
            time.sleep(0.1)
        assert check_whole(tmp_path / "out.nc") > seen


def test_a_full_disk_is_told_clearly_and_keeps_what_was_written(tmp_path):
    with start(tmp_path / "out.nc", sync=0.05, most_bytes=2_000_000) as run:
        _, message = run.communicate(timeout=120)
    assert run.returncode == 1  # and not a crash
    assert "cannot be written any further" in message
    assert "is the disk full?" in message
    assert "Traceback" not in message
    assert check_whole(tmp_path / "out.nc") > 1


def test_a_folder_without_permission_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # the superuser may write anywhere
    with pytest.raises(ResultError, match="no permission to write"):
        check_target(tmp_path / "out.nc")


def test_a_folder_or_a_device_is_no_result_file(tmp_path):
    with pytest.raises(ResultError, match="is a folder"):
        check_target(tmp_path)
    with pytest.raises(ResultError, match="not an ordinary file"):
        check_target(Path(os.devnull))
