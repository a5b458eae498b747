"""Damaged result files are told: truncated, with spoilt headers, with bytes that are not what was written."""

from __future__ import annotations

import shutil
import time
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from travelling_wave import frames, layout, run_info, scenario

from ropewalk.results import ResultError, open_result
from ropewalk.results.checksums import CHECKED, FRAMES, HEAD, NONE, CutShortError, check_whole, head_of
from ropewalk.results.slots import Past

PATIENCE = 5.0  # s, in which a damage must be told


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished result."""
    from ropewalk.results import Recorder

    path, plan = tmp_path_factory.mktemp("whole") / "out.nc", layout(links=40)
    with Recorder(plan, scenario(), run_info(), path) as recorder:
        for frame in list(frames(plan))[:30]:
            recorder.append(frame)
    return path


def test_what_is_whole_is_opened_and_its_checksums_are_no_part_of_it(file: Path) -> None:
    check_whole(file)
    assert not {CHECKED, FRAMES, HEAD} & set(open_result(file).attrs)
    head = head_of(file)
    assert head.frames == 30
    assert head.begin + 30 * head.size == file.stat().st_size
    with netCDF4.Dataset(file) as stored:  # a route of its own to the same figures
        assert len(stored.dimensions["time"]) == 30
        assert head.attributes["outcome"].decode() == stored.outcome
        records = [v for v in stored.variables.values() if v.dimensions[:1] == ("time",)]
        assert head.size == sum(8 * int(np.prod(v.shape[1:])) for v in records)
    assert NONE not in (head.attributes[HEAD].decode(), head.attributes[FRAMES].decode())


@pytest.mark.parametrize("part", [0.0, 1e-4, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.999, 0.99999])
def test_a_part_of_a_file_is_told(part: float, file: Path, tmp_path: Path) -> None:
    """Half of one was shown as completed, with zeros for what was missing."""
    cut = tmp_path / "cut.nc"
    data = file.read_bytes()
    cut.write_bytes(data[: int(part * len(data))])
    with pytest.raises(ResultError, match=r"truncated|ends within|is empty|ends before|no NetCDF file"):
        open_result(cut)


@pytest.mark.parametrize("seed", range(60))
def test_a_byte_that_is_not_what_was_written_is_told(seed: int, file: Path, tmp_path: Path) -> None:
    """Anywhere, but half of them in the header; soon, and by an error of ours."""
    data, chance = bytearray(file.read_bytes()), np.random.default_rng(seed)
    at = int(chance.integers(0, head_of(file).begin if seed % 2 else len(data)))
    data[at] ^= int(chance.integers(1, 256))
    spoilt, begun = tmp_path / "spoilt.nc", time.process_time()
    spoilt.write_bytes(data)
    with pytest.raises(ResultError):
        open_result(spoilt)
    assert time.process_time() - begun < PATIENCE


@pytest.mark.parametrize("seed", range(20))
def test_a_header_of_noise_is_told(seed: int, file: Path, tmp_path: Path) -> None:
    """As many bytes as counts have: lengths in it are of any size."""
    data, chance = bytearray(file.read_bytes()), np.random.default_rng(100 + seed)
    for at in chance.integers(8, 400, 6) // 4 * 4:
        data[at : at + 4] = chance.bytes(4)
    spoilt, begun = tmp_path / "spoilt.nc", time.process_time()
    spoilt.write_bytes(data)
    with pytest.raises(ResultError):
        open_result(spoilt)
    assert time.process_time() - begun < PATIENCE


def test_of_a_large_result_that_stays_on_disk_only_its_frames_are_not_read(file: Path, tmp_path: Path) -> None:
    data = bytearray(file.read_bytes())
    data[-9] ^= 1
    spoilt = tmp_path / "spoilt.nc"
    spoilt.write_bytes(data)
    open_result(spoilt, lazy=True).close()
    with pytest.raises(ResultError, match="checksum of its frames"):
        open_result(spoilt)


def test_what_is_cut_short_can_be_taken_up_from_the_frames_that_are_there(file: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.nc"
    shutil.copy(file, cut)
    head = head_of(file)
    with cut.open("r+b") as stream:
        stream.truncate(head.begin + 12 * head.size + 5)
    with pytest.raises(CutShortError, match="12 of its 30"):
        check_whole(cut)
    past = Past.of(cut)
    assert past.stored == 12
    assert past.cut_short
