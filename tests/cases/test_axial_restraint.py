"""Beams that their supports hold along their axis are named with these supports, and sliding supports free them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from ropewalk import load
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

FILE = Path(__file__).parent / "held-along-its-axis.yaml"
BEAM: dict[str, Any] = {
    "start": [0, 0], "end": [10, 0], "length": 10, "mass": 480, "bending_stiffness": 1.05e6, "axial_stiffness": 12.6e9,
    "elements": 8,
}  # fmt: skip
FORCE: dict[str, Any] = {"kind": "force", "on": "b", "force": [0, -48e3], "travel": {"speed": 10.0, "from": 5.0}}
STILL = {"kind": "equilibrium"}
MOVES = {"kind": "dynamic", "until": 0.2, "every": 0.02}
SLIDES = {"kind": "guided", "along": [1, 0]}


def answer(lines: dict[str, Any], run: dict[str, Any] = STILL, **more: Any) -> xr.Dataset:
    scenario = {"gravity": 0.0, "lines": lines, "loads": {"f": FORCE}, "run": run, **more}
    return simulate(Scenario.model_validate(scenario))


def held(result: xr.Dataset) -> str:
    return next((text for text in str(result.warnings).splitlines() if "is held along its axis" in text), "")


def test_a_beam_with_default_supports_is_named_and_the_remedy_lets_it_sag() -> None:
    stiff = simulate(load(FILE))
    assert held(stiff).startswith("beam b is held along its axis by lines.b.start_support, lines.b.end_support")
    assert "write {kind: guided, along: [10, 0]} instead of lines.b.end_support" in held(stiff)
    free = simulate(load(FILE, ["lines.b.end_support={kind: guided, along: [10, 0]}"]))
    assert not held(free)
    sags = [-float(each.position.sel(axis="z").min()) for each in (stiff, free)]
    assert sags == pytest.approx([0.085, 1.55], rel=0.01)  # m, 2 to 3 figures of the case


@pytest.mark.parametrize("run", [STILL, {"kind": "quasistatic", "positions": 5}, MOVES])
@pytest.mark.parametrize("end", [[10, 0], [8, 6], [8, 3.6, 4.8]])
def test_every_run_and_direction_names_the_supports(run: dict[str, Any], end: list[float]) -> None:
    line = {**BEAM, "start": [0.0] * len(end), "end": end}
    assert "lines.b.start_support, lines.b.end_support" in held(answer({"b": line}, run))
    slides = {**line, "end_support": {"kind": "guided", "along": end}}
    assert not held(answer({"b": slides}, run))


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"end_support": SLIDES}, False),
        ({"start_support": SLIDES}, False),
        ({"start_support": {"kind": "guided", "along": [0, 1], "stiffness": 1e9}}, True),
        ({"end_support": {"kind": "elastic", "stiffness": 1e9}}, True),
        ({"start_support": {"kind": "fixed", "clamped": True}}, True),
        ({"bending_stiffness": 1.05e12}, False),  # it hardly deflects
        ({"length": None, "tension": 1e6}, False),  # tension is intended
        ({"length": None, "tension": 1e3}, True),  # of 100 kN that bending bears
        ({"length": 10.2}, False),  # sag is intended
        ({"foundation": 1e8}, False),  # the bed bears
    ],
)
def test_only_what_stiffens_a_beam_is_named(changes: dict[str, Any], named: bool) -> None:
    gravity = 9.81 if changes.get("length") == 10.2 else 0.0
    assert bool(held(answer({"b": {**BEAM, **changes}}, STILL, gravity=gravity))) == named


def test_small_deflections_are_not_named() -> None:
    small = {**FORCE, "force": [0, -100.0]}
    assert not held(answer({"b": BEAM}, MOVES, loads={"f": small}))


def test_piers_are_named_and_slide() -> None:
    pier = {"kind": "fixed", "at": 5.0}
    roller = {"kind": "guided", "at": 5.0, "along": [1, 0]}
    force = {**FORCE, "force": [0, -480e3], "travel": {"speed": 1.0, "from": 2.5}}
    text = held(answer({"b": {**BEAM, "supports": {"pier": pier}}}, loads={"f": force}))
    assert "lines.b.start_support, lines.b.end_support, lines.b.supports.pier" in text
    assert "instead of lines.b.end_support and of lines.b.supports.pier, without a change of at" in text
    slides = {**BEAM, "supports": {"pier": roller}, "end_support": SLIDES}
    assert not held(answer({"b": slides}, loads={"f": force}))


def test_joined_beams_are_held_by_the_supports_of_their_neighbours() -> None:
    joined = {"kind": "joined", "to": "m"}
    strut = {**BEAM, "start": [14, 0], "length": 4, "elements": 4, "end_support": joined}
    post = {**strut, "start": [10, -4]}
    lines = {"b": {**BEAM, "end_support": joined}, "c": strut, "post": post}
    text = held(answer(lines, MOVES, joints={"m": {"mass": 1.0}}))
    assert "lines.b.start_support" in text
    assert "lines.c.start_support" in text
    freed = {**lines, "c": {**strut, "start_support": SLIDES}, "post": {**post, "start_support": SLIDES}}
    assert not held(answer(freed, MOVES, joints={"m": {"mass": 1.0}}))
