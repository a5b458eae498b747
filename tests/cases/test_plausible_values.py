"""Strains beyond the range of a law, and values with likely mistakes of units, are named in warnings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from ropewalk import load
from ropewalk.effort import foreseen
from ropewalk.model import Scenario
from ropewalk.model.plausibility import implausible, strain_range
from ropewalk.simulate import simulate

FILE = Path(__file__).parent / "misprint.yaml"
STEEL: dict[str, Any] = {
    "start": [0, 0], "end": [20, 0], "length": 20.02, "mass": 1.0, "axial_stiffness": 15e6, "elements": 8
}  # fmt: skip
WEB: dict[str, Any] = {"start": [0, 0], "end": [95, 0], "tension": 3e3, "mass": 0.065, "elements": 8}
TABLE = {"kind": "table", "strain": [0, 0.06, 0.105], "tension": [0, 2e3, 4e3]}


def strained(line: dict[str, Any], **more: Any) -> str:
    more = {"run": {"kind": "equilibrium"}, **more}
    return str(simulate(Scenario.model_validate({"lines": {"a": line}, **more})).warnings)


def test_a_misprinted_length_is_named_with_the_strain_and_its_remedy_works() -> None:
    misprinted = str(simulate(load(FILE)).warnings)
    assert "conductor has a strain of 77.3 % and a tension of 3.864e+07 N at x = 10.89 m" in misprinted
    assert "check lines.conductor.axial_stiffness and length (220 m, its path is 390 m)" in misprinted
    assert "suspension" not in misprinted
    assert " strain of " not in simulate(load(FILE, ["lines.conductor.length=390.2 m"])).warnings


@pytest.mark.parametrize(
    ("line", "beyond"),
    [
        (STEEL, False),
        ({**STEEL, "length": 19.95}, False),  # 0.25 %
        ({**STEEL, "length": 19.7}, True),  # 1.5 %
        ({**STEEL, "length": 19.7, "law": {"kind": "tension_only"}}, True),
        ({**STEEL, "length": 19.7, "law": {"kind": "second_piola_kirchhoff"}}, True),
        ({**STEEL, "length": 19.7, "bending_stiffness": 1e3}, True),
        ({**STEEL, "length": 19.7, "mass": 15.0}, False),  # 1 km/s: a textile rope
        ({**STEEL, "length": 15.0, "mass": 15.0}, True),
        ({**STEEL, "length": 8.0, "mass": 1.0, "axial_stiffness": 2e3}, False),  # rubber, 150 %
        ({**WEB, "law": TABLE}, False),
        ({**WEB, "tension": 5e3, "law": TABLE}, True),
        ({**WEB, "law": {"kind": "webbing", "name": "pinkTube"}}, False),
        ({**WEB, "tension": 40e3, "law": {"kind": "webbing", "name": "pinkTube"}}, True),
        ({**WEB, "law": {"kind": "polynomial", "coefficients": [50e3, -1e5]}}, False),  # turns at 25 %
    ],
)
def test_a_strain_beyond_the_law_is_named(line: dict[str, Any], beyond: bool) -> None:
    assert ("has a strain of" in strained(line)) == beyond


@pytest.mark.parametrize("run", [
    {"kind": "quasistatic", "positions": 3}, {"kind": "linear", "until": 0.1}, {"kind": "dynamic", "until": 0.02},
])  # fmt: skip
@pytest.mark.parametrize("bending", [0.0, 1e3])
def test_every_kind_of_run_names_it(run: dict[str, Any], bending: float) -> None:
    push = {"kind": "force", "on": "a", "force": [0, -1e3], "travel": {"speed": 1.0, "from": 8.0}}
    line = {**STEEL, "length": 19.7, "bending_stiffness": bending}
    warnings = strained(line, run=run, loads={"f": push})
    assert "a has a strain of 1.5" in warnings
    assert "check lines.a.axial_stiffness and length" in warnings


def test_a_membrane_is_named_too() -> None:
    net = {"kind": "membrane", "corner": [0, 0, 0], "sides": [[4, 0, 0], [0, 3, 0]], "cells": [4, 3], "mass": 1.0,
           "stiffness": 2e5}  # fmt: skip
    push = {"kind": "force", "on": "net", "force": [0, 0, -10.0],
            "travel": {"speed": 1.0, "path": [[1, 1], [3, 1]], "from": 0.0}}  # fmt: skip
    for tension, beyond in ((2e3, False), (1e5, True)):
        ask = {"nets": {"net": {**net, "tension": tension}}, "loads": {"f": push}, "run": {"kind": "equilibrium"}}
        assert ("net has a strain of about" in simulate(Scenario.model_validate(ask)).warnings) == beyond


def test_the_limit_of_a_polynomial_is_where_its_tension_turns() -> None:
    line = Scenario.model_validate({"lines": {"a": {**WEB, "law": {"kind": "polynomial", "coefficients": [1e4, 2e4]}}}})
    low, high, _ = strain_range(line.lines["a"])
    assert low == pytest.approx(-0.25, rel=0.02)
    assert high == float("inf")


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({}, None),
        ({"axial_stiffness": 15e3}, "tension"),  # kN for MN
        ({"tension": 30e6}, "tension"),
        ({"tension": 30.0}, "tension"),  # kN forgotten
        ({"mass": 1000.0, "axial_stiffness": 15e4}, "mass"),  # kg/m for g/m
        ({"axial_stiffness": 15e9, "tension": 3e3}, "axial_stiffness"),
        ({"bending_stiffness": 1e3}, None),
        ({"bending_stiffness": 1e9}, "bending_stiffness"),
    ],
)
def test_values_that_are_off_by_orders_of_magnitude_are_named_by_their_keys(changes: dict[str, Any], key: Any) -> None:
    line = {**STEEL, "length": None, "tension": 10e3, **changes}
    scenario = Scenario.model_validate({"lines": {"a": line}, "run": {"kind": "equilibrium"}})
    found = list(implausible(scenario))
    assert bool(found) == (key is not None)
    assert foreseen(scenario)[1] == found  # `ropewalk check` has them
    if key is not None:
        assert any(text.startswith(f"lines.a.{key}: ") and "check the units" in text for text in found)


@pytest.mark.parametrize("kind", ["dynamic", "linear"])
@pytest.mark.parametrize("changes", [{}, {"bending_stiffness": 1e3}, {"length": None, "tension": 10e3}])
@pytest.mark.parametrize(("mass", "beyond"), [(1.0, False), (0.1, False), (0.01, True)])  # 4, 12 and 39 km/s
def test_waves_faster_than_in_any_material_are_named(
    kind: str, changes: dict[str, Any], mass: float, beyond: bool
) -> None:
    lines = {"a": {**STEEL, "mass": mass, **changes}}
    given = Scenario.model_validate({"lines": lines, "run": {"kind": kind, "until": 1.0}})
    assert any(text.startswith("lines.a.mass: ") and "km/s" in text for text in implausible(given)) == beyond


def test_hangers_with_waves_faster_than_in_any_material_are_named() -> None:
    lines = {name: {**STEEL, "start": [0, z], "end": [20, z]} for name, z in (("a", 0), ("b", -2))}
    for mass, beyond in ((0.5, False), (0.5e-3, True)):
        row = {"from": "a", "to": "b", "count": 2, "mass": mass, "axial_stiffness": 5e6}
        given = {"lines": lines, "hangers": {"rods": row}, "run": {"kind": "dynamic", "until": 1.0}}
        assert any("hangers.rods.mass" in text for text in implausible(Scenario.model_validate(given))) == beyond
