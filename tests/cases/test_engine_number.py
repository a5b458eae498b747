"""Results and checkpoints of another engine are not continued."""

from __future__ import annotations

from pathlib import Path

import netCDF4
import pytest

import ropewalk
from resume_cases import case
from ropewalk.checkpoint import ENGINE_NUMBER
from ropewalk.results import ResultError, open_result, slots
from ropewalk.results.checksums import HEAD, NONE


def finished(file: Path) -> Path:
    ropewalk.simulate(case("force"), file=file)
    return file


def test_a_result_carries_the_engine_number_and_is_continued_by_the_same_engine(tmp_path):
    file = finished(tmp_path / "out.nc")
    assert open_result(file).attrs["engine_number"] == ENGINE_NUMBER == 1
    assert ropewalk.resume(file, 0.4).attrs["outcome"] == "completed"


@pytest.mark.parametrize(("number", "words"), [(2, "computed by engine 2"), (None, "an older version, without an")])
def test_a_result_of_another_engine_is_refused_and_left_unchanged(tmp_path, number, words):
    file = finished(tmp_path / "out.nc")
    with netCDF4.Dataset(file, "r+") as data:
        if number is None:
            data.delncattr("engine_number")
        else:
            data.engine_number = number
        data.setncattr(HEAD, NONE)
    before = file.read_bytes()
    with pytest.raises(ResultError, match=f"{words}.* Run the scenario again from the start"):
        ropewalk.resume(file, 0.4)
    assert file.read_bytes() == before


def test_a_checkpoint_of_another_engine_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(slots, "ENGINE_NUMBER", 7)
    file = finished(tmp_path / "out.nc")
    with pytest.raises(ResultError, match="the checkpoint was computed by engine 7"):
        ropewalk.resume(file, 0.4)
