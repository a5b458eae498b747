"""A valid scenario, damaged at random: it loads or is refused, and nothing else happens."""

from __future__ import annotations

import contextlib
import copy
import json
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ruamel.yaml import YAML

from ropewalk.errors import ScenarioError
from ropewalk.model import Scenario
from ropewalk.scenario import dump, loads

TEXT = """
gravity: 9.81
lines:
  rope:
    start: [0, 0]
    end: [19.5 m, 0, 1]
    length: 20 m
    mass: 1 kg/m
    law: {kind: table, strain: [0, 0.1], tension: [0, 1 kN]}
    elements: 10
  wire: {start: [0, 0], end: [9, 0], tension: 1 kN, mass: 1, axial_stiffness: 1e5}
loads:
  a: {kind: force, on: rope, force: {time: [0, 1], value: [[0, 1], [0, 2]]}, travel: {speed: 1, from: 1}}
  b: {kind: force, on: wire, force: [0, 1], travel: {speed: {time: [0, 1], value: [1, 2]}, measured: arc}}
run: {kind: dynamic, until: 1, every: 0.1, start: {kind: rest, with_loads: true}}
"""
BODIES = """
lines: {rope: {start: [0, 0], end: [40, 0], length: 41, mass: 1, axial_stiffness: 1e5, elements: 10}}
loads:
  a: {kind: mass, on: rope, mass: 80, travel: {kind: free, friction: 0.1, driver: {speed: 1, force: 9}, drive: 2}}
  b: {kind: trolley, on: rope, mass: 8, payload: {mass: 9, length: 2, at: [0, 1]}, travel: {speed: 1, from: 3}}
  c:
    {kind: vehicle, on: rope, bodies: {b: {mass: 9, inertia: 1}}, wheels: {f: {at: 1, mass: 1}, r: {at: 0}},
    springs: {f: {between: [b, f], stiffness: 5}, r: {between: [r, b], stiffness: 5}}, travel: {speed: 1, from: 6}}
  d:
    {kind: matrices, on: rope, coordinates: [a, b], mass: [[1, 0], [0, 1]], stiffness: [[1, 0], [0, 1]],
    wheels: {w: {coordinate: a}}, weight: [1, 1], travel: {speed: 1, from: 9}}
  e: {kind: footsteps, on: rope, mass: 70, from: 11, model: [{amplitude: 0.4}, {amplitude: 0.1, phase: 90 deg}]}
  f: {kind: walker, on: rope, from: 20}
  g: {kind: stepper, on: rope, model: "a.b:c", options: {n: 1, more: {x: [1, true, text]}}, from: 30}
  i:
    {kind: fmu, on: rope, file: a.fmu, contacts: {w: {force: F, gives: motion, height: z, at: 1}}, travel: {speed: 3,
    from: 24}, parameters: {m: 3, b: true}, exchange: {stiffness: 5, scheme: parallel, order: 2}, isolated: false}
  h:
    {kind: oscillator, on: rope, mass: 8, stiffness: 2, lift_off: true, contact_stiffness: 9,
    travel: {speed: 0, from: 35}}
"""
TREE: dict[str, Any] = YAML(typ="safe", pure=True).load(TEXT)
TREES: list[dict[str, Any]] = [TREE, YAML(typ="safe", pure=True).load(BODIES)]

junk = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.sampled_from([0, -1, 1e-300, 1e300, 10**400, 1e30, "1e30 m", "", "nan m", "rope", "wire", "result", "dynamic"])
    | st.sampled_from(
        ["hooke", "horizontal", "quasistatic", "equilibrium", "-5 m/s", "1 kN", "2 s", "leave", "stay", "free"]
    )
    | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=6), inner, max_size=3),
    max_leaves=6,
)


def places(tree: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    entries = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    return [where for key, value in entries for where in [(*path, key), *places(value, (*path, key))]]


def at(tree: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        tree = tree[key]
    return tree


@st.composite
def damaged(draw: st.DrawFn) -> Any:
    tree = copy.deepcopy(draw(st.sampled_from(TREES)))
    for _ in range(draw(st.integers(1, 4))):
        where = places(tree)
        if not where:
            break
        *outer, last = draw(st.sampled_from(where))
        block = at(tree, tuple(outer))
        action = draw(st.sampled_from(["delete", "replace", "replace", "rename", "copy"]))
        if action == "delete":
            del block[last]
        elif action == "replace":
            block[last] = draw(junk)
        elif action == "rename" and isinstance(block, dict):
            block[draw(st.text(max_size=6))] = block.pop(last)
        else:
            *outer, new = draw(st.sampled_from(where))
            at(tree, tuple(outer))[new] = copy.deepcopy(block[last])
    return tree


def survives(text: str, name: str) -> Scenario | None:
    try:
        return loads(text, name)
    except ScenarioError as error:
        problems = error.problems
    assert problems
    for problem in problems:
        assert problem.wrong
        assert str(problem).isprintable()
        assert str(problem).startswith(f"{name}:")
    return None


@pytest.mark.parametrize("text", [TEXT, BODIES])
def test_the_scenario_is_valid_before_it_is_damaged(text: str) -> None:
    assert loads(text).lines


@settings(max_examples=500, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(damaged())
def test_a_damaged_tree_is_refused_or_loads_and_survives_writing(tree: Any) -> None:
    scenario = survives(json.dumps(tree), "case.json")
    if scenario is not None:
        assert loads(dump(scenario)) == scenario


@settings(max_examples=300, deadline=None)
@given(st.data())
def test_damaged_text_is_refused_or_loads(data: st.DataObject) -> None:
    rows = data.draw(st.sampled_from([TEXT, BODIES])).splitlines()
    for _ in range(data.draw(st.integers(1, 3))):
        row = data.draw(st.integers(0, len(rows) - 1))
        action = data.draw(st.sampled_from(["twice", "drop", "shift", "insert"]))
        if action == "twice":
            rows.insert(row, rows[row])
        elif action == "drop" and len(rows) > 1:
            del rows[row]
        elif action == "shift":
            rows[row] = data.draw(st.sampled_from([" ", "\t", "- ", "&a ", "*a", "? ", "!!x ", "%", "'"])) + rows[row]
        else:
            column = data.draw(st.integers(0, len(rows[row])))
            rows[row] = rows[row][:column] + data.draw(st.text(max_size=3)) + rows[row][column:]
    survives("\n".join(rows), "case.yaml")


@settings(max_examples=200, deadline=None)
@given(st.data(), st.sampled_from([TEXT, BODIES]), junk)
def test_an_override_is_refused_or_loads(data: st.DataObject, text: str, value: Any) -> None:
    known = [".".join(map(str, path)) for path in places(TREES[text == BODIES])]
    key = data.draw(st.sampled_from(known) | st.text(max_size=12))
    with contextlib.suppress(ScenarioError):
        loads(text, "case.yaml", [f"{key}={json.dumps(value)}"])
