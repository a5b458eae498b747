"""What is not implemented is declared by the engines: in one shape, in the words of scenarios, and nowhere else."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import ropewalk
from ropewalk.capabilities import LINEAR, ROPES, SYSTEM, WIRES, engine_of
from ropewalk.model import Scenario
from ropewalk.model._base import Declaration
from ropewalk.model.capabilities import Capabilities

HOUSE = Path(ropewalk.__file__).parent
SAYS_SO = re.compile(r"not implemented|\bnot know\b|\b(not|are|is) known\b|\bknows?\b[^.;]* only\b|\bknown only\b")
# Physics, input and advice that use such words of other things than features of the program.
OTHERWISE = {"results", "theory", "compare", "cosim", "external", "paper", "validation"}
ROPE = {"start": [0, 0], "end": [20, 0], "tension": 1e4, "mass": 1, "axial_stiffness": 1e6}
WINDY = {
    "lines": {"a": {**ROPE, "wind_drag": 0.1}}, "wind": {"direction": [1, 0], "speed": 1},
    "run": {"kind": "dynamic", "until": 1},
}  # fmt: skip
PUSH = {"kind": "force", "on": "a", "force": [0, -1], "travel": {"speed": 1}}
SCENARIOS: dict[str, tuple[dict[str, Any], Any]] = {
    "ropes": ({"lines": {"a": ROPE}}, ROPES),
    "wires": ({"lines": {"a": {**ROPE, "bending_stiffness": 10}}}, WIRES),
    "system": (WINDY, SYSTEM),
    "bare": ({**WINDY, "run": {"kind": "equilibrium"}}, SYSTEM),
    "webs": ({**WINDY, "run": {"kind": "equilibrium"}, "loads": {"p": PUSH}}, SYSTEM),
    "linear": ({"lines": {"a": ROPE}, "run": {"kind": "linear", "until": 1}}, LINEAR),
}


def sentences(source: str) -> Iterator[tuple[int, str]]:
    """Line and words of every text of a module that is no docstring; of what is put in, nothing."""
    tree = ast.parse(source)
    silent = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if id(node) in silent:
            continue
        if isinstance(node, ast.JoinedStr):
            parts = [str(part.value) for part in node.values if isinstance(part, ast.Constant)]
            silent |= {id(part) for part in node.values}
            yield node.lineno, " … ".join(parts)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.lineno, node.value


def test_nothing_else_says_what_is_not_implemented() -> None:
    found = [
        f"{path.relative_to(HOUSE)}:{line}: {words}"
        for path in sorted(HOUSE.rglob("*.py"))
        if path.name not in ("capabilities.py", "missing.py") and path.relative_to(HOUSE).parts[0] not in OTHERWISE
        for line, words in sentences(path.read_text(encoding="utf-8"))
        if SAYS_SO.search(words)
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    "source", ['raise E(f"{who} knows fixed supports only")', 'wrong = "drag is not known"', 'x = "not implemented"']
)
def test_a_refusal_elsewhere_is_seen(source: str) -> None:
    assert [line for line, words in sentences(source) if SAYS_SO.search(words)] == [1]


@pytest.mark.parametrize("name", SCENARIOS)
def test_the_engine_is_chosen_by_what_is_there_and_what_is_asked(name: str) -> None:
    tree, engine = SCENARIOS[name]
    assert engine_of(Scenario.model_validate(tree)) is engine


def declarations(base: type = Declaration) -> Iterator[type[Any]]:
    yield base
    for model in base.__subclasses__():
        yield from declarations(model)


@pytest.mark.parametrize("engine", [ROPES, WIRES, LINEAR])
def test_capabilities_speak_the_words_of_scenarios(engine: Any) -> None:
    """Every key is one of a declaration, every word one that it accepts."""
    fields = {(name, repr(field.annotation)) for model in declarations() for name, field in model.model_fields.items()}
    for capabilities in (engine.motion, engine.at_rest):
        assert isinstance(capabilities, Capabilities)
        assert set(capabilities.instead) <= set(capabilities.only)
        for key, values in capabilities.only.items():
            block, *_, last = key.split(".")
            assert block in ("run", "lines", "loads")
            known = [annotation for name, annotation in fields if name == last]
            assert known, key
            for value in values:
                assert not isinstance(value, str) or any(repr(value) in annotation for annotation in known), (
                    key,
                    value,
                )


def test_to_check_a_scenario_is_light() -> None:
    script = """
import sys
from ropewalk import Scenario
rope = dict(start=(0, 0), end=(20, 0), tension=1e4, mass=1, axial_stiffness=1e6, bending_stiffness=10)
Scenario(lines={"a": rope})
heavy = {"numba", "scipy", "matplotlib", "xarray", "netCDF4"} & set(sys.modules)
assert not heavy, heavy
assert "ropewalk.wires.capabilities" in sys.modules
"""
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False)
    assert run.returncode == 0, run.stderr


def test_all_mistakes_are_told_at_once_even_where_others_hide_the_run() -> None:
    """What neither a motion nor rest can be computed with is told although the run itself is wrong."""
    from ropewalk.errors import ScenarioError
    from ropewalk.scenario import loads

    text = """lines:
  a: {start: [0, 0], end: [20, 0], length: 19.9, mass: 1, axial_stiffness: 1e6, bending_stiffness: 10,
      sheaves: {s: {at: [12, 1]}}}
loads:
  p: {kind: trolley, mass: 1, on: a, travel: {speed: 1}, payload: {mass: 1, length: 1}}
run: {kind: dynamic, untill: 1}
"""
    with pytest.raises(ScenarioError) as caught:
        loads(text, "case.yaml")
    found = [(problem.line, problem.key) for problem in caught.value.problems]
    assert found == [(2, "lines.a.bending_stiffness"), (6, "run.untill")]
