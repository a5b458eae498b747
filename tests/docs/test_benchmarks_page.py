"""The page of benchmarks is what was kept of their runs: nobody writes a number of it by hand."""

from __future__ import annotations

import importlib
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture
def record(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(sys, "path", [str(ROOT), *sys.path])
    return importlib.import_module("benchmarks.record")


def test_the_page_is_the_written_one(record) -> None:
    assert record.PAGE.read_text(encoding="utf-8") == record.page(), "run  python -m benchmarks.record --page"


def test_each_table_that_others_write_of_is_named_and_its_place_is_there(record) -> None:
    assert record.ELSEWHERE.keys() <= record.TABLES.keys()
    assert {path.stem for path in record.KEPT.glob("*.json")} <= record.TABLES.keys()
    assert all((ROOT / "docs" / place.partition("#")[0]).is_file() for place, _ in record.ELSEWHERE.values())


@pytest.mark.parametrize(
    ("texts", "said"),
    [
        (["a 1.0 s"], "run once"),
        (["a 1.0 s", "a 1.0 s"], "with the same numbers"),
        (["a 1.0 s", "b 1.0 s 2"], "not compared"),
        (["x 2.0 3e-2 10 s", "x 2.2 3e-2 8 s"], "2 of 3 numbers .* by 18 % in the median and 25 % at most"),
    ],
)
def test_it_says_how_far_a_second_run_was_off(record, texts: list[str], said: str) -> None:
    assert re.search(said, record.scatter(texts))


def test_a_table_that_is_not_there_is_refused(record, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["benchmarks.record", "nothing"])
    with pytest.raises(SystemExit):
        record.main()
