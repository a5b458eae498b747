"""Mistakes of one cause are told once."""

from __future__ import annotations

import pytest

from ropewalk.errors import Problem, ScenarioError
from ropewalk.scenario import loads

AXLES = 9
FILE = """\
gravity: 9.81
lines:
  bridge: {start: [0, 0], end: [20, 0], tension: 1 kN, mass: 1000, axial_stiffness: 1 GN}
loads:
LOADS
run: {kind: dynamic, until: 0.5 s}
"""


def said(load: str) -> list[str]:
    text = "\n".join("  " + load.replace("SLOWER", str(60 - 6 * k)).replace("K", str(k)) for k in range(AXLES))
    with pytest.raises(ScenarioError) as caught:
        loads(FILE.replace("LOADS", text), "train.yaml")
    return str(caught.value).splitlines()


@pytest.mark.parametrize(("load", "first", "others"), [
    ("aK: {kind: mass, on: bridge, mass: 100, travel: {speed: 9}}", "a1.travel.from: starts at the same place", 7),
    ("aK: {kind: mass, on: bridge, mass: 100, travel: {speed: 9, from: 3 s}}", "a0.travel.from: s does not fit", 8),
    ("aK: {kind: mass, on: bridge, mass: 1 kN, travel: {speed: 9, from: K}}", "a0.mass: kN does not fit", 8),
    ("aK: {kind: mass, on: bridge, mas: 100, travel: {speed: 9, from: K}}", "a0.mas: unknown key", 8),
])  # fmt: skip
def test_nine_axles_make_one_line(load: str, first: str, others: int) -> None:
    rows = said(load)
    assert len(rows) == 1, rows
    assert rows[0].startswith(f"train.yaml:{5 + (8 - others)}: loads.{first}")
    names = ", ".join(f"a{k}" for k in range(AXLES - others, AXLES))
    assert rows[0].endswith(f"(also {names}: lines {5 + AXLES - others} to {4 + AXLES})")


def test_who_meets_several_is_told_of_one() -> None:
    rows = said("aK: {kind: mass, on: bridge, mass: 100, travel: {speed: SLOWER, from: K}}")
    assert len(rows) == 1, rows
    assert "the load meets load a0" in rows[0]


def test_two_of_a_kind_are_two_lines_and_all_problems_stay() -> None:
    problems = [Problem(f"loads.{name}.mass", "is missing") for name in "ab"]
    error = ScenarioError(problems)
    assert str(error).splitlines() == ["loads.a.mass: is missing", "loads.b.mass: is missing"]
    error = ScenarioError([*problems, Problem("loads.c.mass", "is missing"), Problem("loads.c.force", "is missing")])
    assert str(error).splitlines() == ["loads.a.mass: is missing (also b, c)", "loads.c.force: is missing"]
    assert len(error.problems) == 4


def test_other_values_are_other_mistakes() -> None:
    error = ScenarioError([Problem(f"loads.{k}.mass", "is too small", f"{k} kg") for k in range(AXLES)])
    assert len(str(error).splitlines()) == AXLES
