"""A mistake in many rows of a file or entries of a list is one message: first place, count, value and remedy."""

from __future__ import annotations

from pathlib import Path

import pytest

from ropewalk.designs.measurements import Measurements
from ropewalk.errors import Problem, ScenarioError
from ropewalk.overhead.irregularity import read_irregularity
from ropewalk.results import ResultError
from ropewalk.scenario import loads

ROWS = 3000
ROPE = """
lines: {rope: {start: [0, 0], end: [20, 0], length: 20.1, mass: 1, axial_stiffness: 1 MN, elements: 6}}
run: {kind: dynamic, until: 1}
"""


def message(text: str) -> str:
    with pytest.raises(ScenarioError) as caught:
        loads(text, "rope.yaml")
    return str(caught.value)


@pytest.mark.parametrize(
    ("row", "first", "wrong", "count"),
    [
        ("{i}, 0.001, 7", 1, "has 3 values instead of 2, given 0, 0.001, 7", ROWS),
        ("{i}, abc", 1, "is not two numbers, given 0, abc", ROWS),
        ("{j}, 0.001", 2, "x must rise, the row before has 0, given 0, 0.001", ROWS // 2),
        ("{i}, {i}", 3, "an irregularity of more than 1 m, given 2, 2", ROWS - 2),
    ],
)
def test_a_mistake_in_every_row_of_a_csv_file_is_one_line(tmp_path: Path, row, first, wrong, count) -> None:
    file = tmp_path / "rough.csv"
    file.write_text("\n".join(row.format(i=i, j=i // 2) for i in range(ROWS)))
    with pytest.raises(ScenarioError) as caught:
        read_irregularity(file)
    said = str(caught.value)
    assert "\n" not in said
    assert said.startswith(f"{file}:{first}: irregularity: {wrong}; ")
    assert said.endswith(f"; {count} entries have this problem, the last is line {ROWS}")


@pytest.mark.parametrize(
    ("load", "key"),
    [
        ("kind: force, force: [0, -9], travel: {from: 1, speed: {time: TIME, value: WRONG}}", "travel.speed.value"),
        ("kind: force, force: [0, -9], travel: {from: 1, speed: {time: WRONG, value: TIME}}", "travel.speed.time"),
        ("kind: axles, forces: 100, at: WRONG, travel: {from: 1, speed: 1}", "at"),
        ("kind: axles, forces: WRONG, at: TIME, travel: {from: 1, speed: 1}", "forces"),
    ],
)
@pytest.mark.parametrize("between", [", ", ",\n    "])
def test_a_mistake_in_every_entry_of_a_list_is_one_line(load: str, key: str, between: str) -> None:
    time, wrong = (between.join(f"{i}{unit}" for i in range(ROWS)) for unit in ("", " kg"))
    load = load.replace("TIME", f"[{time}]").replace("WRONG", f"[{wrong}]")
    said = message(ROPE + f"loads: {{w: {{on: rope, {load}}}}}")
    assert "\n" not in said, said[:500]
    assert f": loads.w.{key}.0: kg does not fit" in said
    assert "given '0 kg'" in said
    assert f"; {ROWS} entries have this problem, the last is " in said
    assert said.endswith(f"{key}.{ROWS - 1}" if "\n" not in between else str(said.rpartition("line ")[2]))


def test_problems_with_different_causes_stay_apart() -> None:
    problems = [Problem(f"loads.w.at.{i}", f"{unit} does not fit", f"{i} {unit}") for i in range(5) for unit in "sN"]
    said = str(ScenarioError(problems)).splitlines()
    assert said == [
        f"loads.w.at.0: {unit} does not fit, given 0 {unit}; 5 entries have this problem, the last is loads.w.at.4"
        for unit in "sN"
    ]


def test_the_names_of_many_loads_with_one_mistake_are_counted() -> None:
    said = str(ScenarioError([Problem(f"loads.a{i}.mass", "is missing") for i in range(500)]))
    assert said.endswith("(also a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, 489 more)")


@pytest.mark.parametrize(("cell", "given"), [("abc", "'abc'"), ("", "an empty cell")])
def test_measured_series_name_the_first_bad_row_and_their_number(tmp_path: Path, cell: str, given: str) -> None:
    file = tmp_path / "measured.csv"
    file.write_text("time [s],force [N]\n0,1\n" + f"1,{cell}\n" * ROWS)
    with pytest.raises(ResultError, match=f"row 2 below the head is no number, given {given}; .*; {ROWS} cells have"):
        Measurements.read(file)
