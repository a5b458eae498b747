"""Pictures of the gallery: every example has one, and the summaries kept with them agree with runs."""

from __future__ import annotations

from pathlib import Path

import pictures  # of docs/: see conftest.py
import pytest

CHEAP = ["bridge-biggs", "cable-crane-two-ropes", "moving-force", "overhead-line-dc", "ropeway-saddle", "zip-line"]
LARGEST = 8e6  # bytes: every renewal adds them to the history of the repository
FILES = {f"{name}{suffix}" for name in pictures.examples() for suffix in pictures.SUFFIXES}


def test_every_example_has_its_pictures_and_no_picture_is_left_of_another() -> None:
    kept = {path.name for path in pictures.FOLDER.iterdir()}
    assert sorted(FILES ^ kept) == [], "run  make pictures"


def test_pictures_belong_to_the_examples_as_they_are() -> None:
    changed = [name for name in pictures.examples() if pictures.read(name)[0] != pictures.key(name)]
    assert changed == [], f'run  make pictures NAMES="{" ".join(changed)}"'


def test_pictures_together_are_small() -> None:
    assert sum(path.stat().st_size for path in pictures.FOLDER.iterdir()) < LARGEST


@pytest.mark.parametrize("name", CHEAP)
def test_a_run_still_prints_the_numbers_that_are_kept(name: str, tmp_path: Path) -> None:
    """Within 2 %: see `pictures.TOLERANCE`."""
    _, kept = pictures.read(name)
    assert len(pictures.numbers(kept)) >= 5
    assert pictures.differences(kept, pictures.run(name, tmp_path / "result.nc")) == [], "run  make pictures"


OLD = """Title: completed, 1.500 s, 151 frames

Supports
rope.start    999.0 N  t = 0.8800 s
largest sag   3.102 m  rope at x = 9.371 m

Method
largest step  131.1 µs  11573 steps
"""


@pytest.mark.parametrize(
    ("new", "expected"),
    [
        (OLD.replace("999.0 N", "1.005 kN"), []),
        (OLD.replace("131.1", "200.0").replace("9.371", "4.2").replace("0.8800", "0.1"), []),
        (OLD.replace("999.0 N", "1.050 kN"), ["Supports: rope.start: 999 and 1050 N"]),
        (OLD.replace("3.102 m", "3.102 mm"), ["Supports: largest sag: 3.102 and 0.003102 m"]),
        (OLD.replace("rope.start", "rope.upper"), ["Supports: rope.start: only one of two summaries has it"]),
    ],
    ids=["other prefix", "places and steps", "other force", "other unit", "other row"],
)
def test_numbers_agree_within_two_per_cent_whatever_their_prefix(new: str, expected: list[str]) -> None:
    assert pictures.differences(OLD, new)[: len(expected) or None] == expected
