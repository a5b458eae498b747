"""Supports between the ends of a line, as files declare them."""

from __future__ import annotations

from typing import Any

import pytest

from ropewalk.capabilities import SUPERPOSED, SYSTEM, WIRES, engine_of
from ropewalk.errors import ScenarioError
from ropewalk.model import InnerGuided, Line
from ropewalk.model.writing import dump
from ropewalk.scenario import loads

FILE = """
lines:
  deck:
    start: [0 m, 0 m]
    end: [20 m, 0 m]
    length: 20 m
    mass: 50 kg/m
    axial_stiffness: 1 GN
    bending_stiffness: 2 MN*m^2
    elements: 40
    supports:
      pier: {at: 8 m, kind: guided, along: [1, 0]}
      soft: {at: 12 m, kind: elastic, stiffness: [0 N/m, 5 MN/m], position: [12 m, 1 cm]}
run: {kind: dynamic, until: 1 s}
"""
OFF = "{at: 8 m, kind: fixed, position: [8.1 m, 0 m]}"
PLAIN = ("lines.deck.bending_stiffness=0",)


def test_a_file_with_inner_supports_is_read_and_written() -> None:
    scenario = loads(FILE)
    assert isinstance(scenario.lines["deck"].supports["pier"], InnerGuided)
    assert loads(dump(scenario)) == scenario
    moved = loads(FILE, overrides=["lines.deck.supports.pier.at=9 m"])
    assert moved.lines["deck"].supports["pier"].at == 9.0


@pytest.mark.parametrize(
    ("overrides", "engine"),
    [
        ((), SYSTEM),
        (("run.geometry=linearised",), WIRES),
        (("run.geometry=linearised", "lines.deck.supports.soft.mass=1 t"), SYSTEM),
        (("run.geometry=linearised", f"lines.deck.supports.pier={OFF}"), SYSTEM),
        (("run.geometry=linearised", "lines.deck.supports.pier.force=1 kN"), SYSTEM),
        (("run.kind=equilibrium", "run.until=null"), WIRES),
        (("lines.deck.supports.pier.at=7.77777 m",), WIRES),
        (PLAIN, SYSTEM),
        ((*PLAIN, "run.kind=equilibrium", "run.until=null"), SYSTEM),
        (("run.kind=linear",), SUPERPOSED),
    ],
    ids=[
        "beam", "small motion", "a mass in small motion", "a pier off its place", "a pull", "beam at rest",
        "between nodes", "rope", "rope at rest", "the linear theory",
    ],
)  # fmt: skip
def test_who_computes_them(overrides: tuple[str, ...], engine: Any) -> None:
    assert engine_of(loads(FILE, overrides=overrides)) is engine


MISTAKES = {
    "supports.pier.at=20 m": (("supports", "pier", "at"), "not between the ends"),
    "supports.pier.at=12 m": (("supports", "soft", "at"), "pier is at the same place"),
    "supports.pier.kind=joined": (("supports", "pier", "kind"), "unknown kind"),
    "supports.soft={at: 3 m, kind: fixed, clamped: true}": (("supports", "soft", "clamped"), "lets the line turn"),
    "supports.start={at: 3 m, kind: fixed}": (("supports", "start"), "same name"),
    "sheaves={wheel: {at: [10 m, 1 m]}}": (("supports",), "over sheaves"),
}


@pytest.mark.parametrize("override", MISTAKES)
def test_what_does_not_fit_is_said_at_its_key(override: str) -> None:
    key, wrong = MISTAKES[override]
    with pytest.raises(ScenarioError) as caught:
        loads(FILE, overrides=[f"lines.deck.{override}"])
    found = {problem.key: str(problem) for problem in caught.value.problems}
    assert wrong in found[".".join(("lines", "deck", *key))]


REFUSED = {
    "a tension": (("lines.deck.length=null", "lines.deck.tension=1 kN"), "lines.deck.tension"),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_not_computed_is_refused_at_its_key(what: str) -> None:
    overrides, key = REFUSED[what]
    with pytest.raises(ScenarioError) as caught:
        loads(FILE, overrides=overrides)
    assert key in [problem.key for problem in caught.value.problems]


def test_a_line_that_is_joined_must_say_where_it_is_held() -> None:
    line = loads(FILE, overrides=PLAIN).lines["deck"].model_dump() | {"end_support": {"kind": "joined", "to": "knot"}}
    with pytest.raises(ValueError, match="the path of a joined line"):
        Line.model_validate(line)
