"""What long work says where no terminal is: how far it is, and which file it leaves behind."""

from __future__ import annotations

import subprocess
import sys

import pytest

from ropewalk.cli import console
from ropewalk.interrupts import EXIT_CODE


def test_long_work_tells_each_tenth_and_not_more_often_than_every_half_minute(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = 0.0
    monkeypatch.setattr(console.clock, "monotonic", lambda: now)
    with console.progress_of_many(quiet=False) as report:
        assert report is not None
        for percent in range(101):
            now = 9.0 * percent  # s: half a minute is 3.3 of a hundred
            report("running", 0.01 * percent)
    said = capsys.readouterr().err.split("\n")
    # 900 s in all, of which 864 and 774 are left then
    assert said[:2] == ["running: 4%, about 14 min left", "running: 14%, about 13 min left"]
    assert 10 <= len(said) <= 11


def test_brief_work_says_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    with console.progress_of_many(quiet=False) as report:
        assert report is not None
        for percent in range(101):
            report("running", 0.01 * percent)
    assert not capsys.readouterr().err


def test_a_process_that_ends_at_once_names_the_file_that_it_leaves() -> None:
    script = "from ropewalk import interrupts as i; i.note_kept(lambda: '; kept in a.nc'); i._leave()"
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stderr) == (EXIT_CODE, "interrupted; kept in a.nc\n")
