"""Kernels stay within their arrays: compiled they do not look, and write wherever an index leads."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import plain_runs


def test_no_kernel_reaches_beyond_its_arrays() -> None:
    """As plain Python every index is looked at; a negative one counts from the end, compiled or not."""
    here = Path(__file__).parent
    place = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(
        [sys.executable, str(here / "plain_runs.py")], env=place, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    message = dict(row.rsplit(": ", 1) for row in done.stdout.splitlines())
    assert set(message) == {*plain_runs.scenarios(), *plain_runs.CASES}
    # Short runs on coarse meshes may be doubtful, but each of them has gone through.
    assert set(message.values()) <= {"completed", "doubtful"}, message
