"""Disks that are full at any moment: what was there stays, and what could be written can be read and taken up again."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import ropewalk
from ropewalk.results import open_result

resource = pytest.importorskip("resource")

ROPE = """
title: Full
lines:
  rope: {start: [0, 0], end: [100, 0], tension: 20 kN, mass: 1, axial_stiffness: 2 MN, elements: 40}
loads:
  one: {kind: force, on: rope, force: [0, -500], travel: {speed: 15, from: 10 m}}
run: {kind: dynamic, until: 1 s, every: 2 ms}
"""


def run(folder: Path, *words: str, most: int | None = None) -> subprocess.CompletedProcess[str]:
    """The command line, with files that cannot grow beyond a number of bytes."""

    def limit() -> None:
        if most is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (most, resource.RLIM_INFINITY))

    command = [sys.executable, "-m", "ropewalk", *words]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, preexec_fn=limit)


def numbers(file: Path, frames: int | None = None) -> list[bytes]:
    with open_result(file) as result:
        return [result[name].values[:frames].tobytes() for name in ("time", "position", "velocity", "contact_force")]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("whole")
    (folder / "one.yaml").write_text(ROPE, encoding="utf-8")
    assert run(folder, "run", "one.yaml").returncode == 0
    return folder / "one.nc"


@pytest.mark.parametrize("tenth", [1, 5, 9])
def test_a_disk_that_is_full_loses_nothing(whole: Path, tmp_path: Path, tenth: int) -> None:
    (tmp_path / "one.yaml").write_text(ROPE, encoding="utf-8")
    earlier = whole.read_bytes()
    (tmp_path / "one.nc").write_bytes(earlier)
    found = run(tmp_path, "run", "one.yaml", most=int((tenth + 0.5) / 10.0 * len(earlier)))
    assert found.returncode == 3, found.stderr
    assert "is the disk full?" in found.stderr
    assert "Traceback" not in found.stderr
    assert sorted(os.listdir(tmp_path)) == ["one.nc", "one.yaml"]
    with open_result(tmp_path / "one.nc") as result:
        frames = result.sizes["time"]
    assert numbers(tmp_path / "one.nc") == numbers(whole, frames)
    if (tmp_path / "one.nc").read_bytes() != earlier:
        ropewalk.resume(tmp_path / "one.nc").close()
        assert numbers(tmp_path / "one.nc") == numbers(whole)
