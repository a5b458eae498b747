"""Irregularities from files: what is read, and each row that is wrong with its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ropewalk.errors import ScenarioError
from ropewalk.overhead.irregularity import read_irregularity


@pytest.mark.parametrize(
    "text",
    [
        "0, 0\n10, 0.002\n20, -0.004\n",
        "x [m], z [m]\n0;0\n10;0.002\n20;-0.004",
        "\n# measured\n0 0\n10\t2e-3 # here\n20 -4e-3",
    ],
)
def test_rows_are_read_however_they_are_divided(text: str, tmp_path: Path) -> None:
    file = tmp_path / "wire.csv"
    file.write_text(text, encoding="utf-8")
    found = read_irregularity(file)
    np.testing.assert_array_equal(found.x, [0.0, 10.0, 20.0])
    np.testing.assert_allclose(found.at(np.array([-1.0, 5.0, 15.0, 21.0])), [0.0, 0.001, -0.001, 0.0])


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("0, 0\n10, 0.002, 7\n", 2, "has 3 values instead of 2, given 10, 0.002, 7; write rows of two numbers"),
        ("x, z\n0, 0\n5, wide\n", 3, "is not two numbers, given 5, wide"),
        ("0, 0\n5, nan\n", 2, "is not two numbers"),
        ("0, 0\n5, 0\n4, 0\n", 3, "x must rise, the row before has 5, given 4, 0; sort the rows by x"),
        ("0, 0\n5, 2\n", 2, "an irregularity of more than 1 m, given 5, 2; write z in m"),
        ("x, z\n0, 0\n", None, "at least two rows are needed, given 1 row"),
        ("", None, "at least two rows are needed, given 0 rows"),
    ],
)
def test_a_bad_row_is_named_with_its_line(text: str, line: int | None, says: str, tmp_path: Path) -> None:
    file = tmp_path / "wire.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ScenarioError) as caught:
        read_irregularity(file, "loads.first.irregularity")
    (problem,) = caught.value.problems
    place = str(file) if line is None else f"{file}:{line}"
    assert str(problem).startswith(f"{place}: loads.first.irregularity: ")
    assert says in str(problem)


def test_every_bad_row_is_named(tmp_path: Path) -> None:
    file = tmp_path / "wire.csv"
    file.write_text("0, 0\na, 1\n3\n4, 0\n", encoding="utf-8")
    with pytest.raises(ScenarioError) as caught:
        read_irregularity(file)
    assert [problem.line for problem in caught.value.problems] == [2, 3]


def test_a_file_that_is_not_there_or_not_text_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"cannot be read, given .*none\.csv .*No such file"):
        read_irregularity(tmp_path / "none.csv")
    (tmp_path / "film.mp4").write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(ScenarioError, match="it is not text in UTF-8"):
        read_irregularity(tmp_path / "film.mp4")
