"""Malformed scenarios: each mistake is reported once, at its file, line and key, with a remedy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

from ropewalk.errors import Problem, ScenarioError
from ropewalk.scenario import loads

NAME = "case.yaml"
MISTAKES: dict[str, dict[str, Any]] = YAML(typ="safe", pure=True).load(
    Path(__file__).with_name("mistakes.yaml").read_text(encoding="utf-8")
)


def problems_of(text: str, name: str = NAME) -> tuple[Problem, ...]:
    with pytest.raises(ScenarioError) as caught:
        loads(text, name)
    assert str(caught.value).splitlines() == [str(problem) for problem in caught.value.problems]
    return caught.value.problems


@pytest.mark.parametrize("mistake", MISTAKES.values(), ids=MISTAKES)
def test_the_mistake_has_one_problem_with_its_place_and_remedy(example: str, mistake: dict[str, Any]) -> None:
    text = mistake.get("text", example)
    for old, new in mistake.get("replace", {}).items():
        assert old in text
        text = text.replace(old, new, 1)

    problems = problems_of(text)

    assert [problem.key for problem in problems] == [mistake["key"]]
    row = str(problems[0])
    assert row.startswith(
        f"{NAME}:{mistake['at']}: {mistake['key']}: " if mistake["key"] else f"{NAME}:{mistake['at']}: "
    )
    assert mistake["says"] in row


def test_there_are_at_least_sixty_mistakes() -> None:
    assert len(MISTAKES) >= 60


def test_all_mistakes_are_reported_at_once_in_the_order_of_the_file(example: str) -> None:
    text = example.replace("mass: 1 kg/m", "mass: 1 m").replace("on: rope", "on: rop")
    text = text.replace("every: 10 ms", "every: 2 s").replace("length: 20 m", "lenght: 20 m")

    problems = problems_of(text)

    assert [(problem.line, problem.key) for problem in problems] == [
        (7, "lines.rope.lenght"),
        (8, "lines.rope.mass"),
        (15, "loads.walker.on"),
        (21, "run.every"),
    ]


def test_a_line_with_a_bad_value_is_still_searched_for_missing_keys(example: str) -> None:
    text = example.replace("mass: 1 kg/m", "mass: 1 m").replace("    length: 20 m ", "    #")
    assert [problem.key for problem in problems_of(text)] == ["lines.rope", "lines.rope.mass"]


def test_each_duplicate_is_reported(example: str) -> None:
    text = example.replace("mass: 1 kg/m", "mass: 1\n    mass: 2\n    mass: 3")
    assert [(p.line, p.key) for p in problems_of(text)] == [(9, "lines.rope.mass"), (10, "lines.rope.mass")]


def test_numbers_as_keys_at_the_top_ask_for_quotes() -> None:
    assert 'put it in quotes: "1"' in str(problems_of("1: 2\nlines: {}\n")[0])


def test_aliases_of_aliases_are_stopped() -> None:
    text = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
        f"a{i + 1}: &a{i + 1} [{', '.join([f'*a{i}'] * 10)}]\n" for i in range(12)
    )
    (problem,) = problems_of(text)
    assert "the aliases repeat more than 100000 values" in str(problem)


@pytest.mark.parametrize("name", ["deep.yaml", "deep.json"])
def test_endless_brackets_are_refused(name: str) -> None:
    (problem,) = problems_of("[" * 3000, name)
    assert str(problem).startswith(f"{name}:1: the blocks are nested too deeply")


def test_a_message_stays_printable() -> None:
    problems = problems_of('{"lines": {"\\ud800\\n": {}}, "title": 3, "\\ud800": 1}', "case.json")
    assert all(row.isprintable() for row in map(str, problems))
