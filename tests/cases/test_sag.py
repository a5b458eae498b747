"""A line that hangs has no sag, although its ends are not exactly above each other."""

from __future__ import annotations

from typing import Any

import pytest

from ropewalk.model import Scenario
from ropewalk.results import summary
from ropewalk.simulate import simulate


@pytest.mark.parametrize("aside", [0.0, 1e-6, 0.02, -1.0])
@pytest.mark.parametrize("down", [True, False])
def test_a_line_that_hangs_has_no_sag(aside: float, down: bool) -> None:
    ends = [[0.0, 400.0], [aside, 0.0]][:: 1 if down else -1]
    line = {"start": ends[0], "end": ends[1], "length": 399.9, "mass": 1, "axial_stiffness": 1e7, "elements": 8}
    found = simulate(Scenario.model_validate({"lines": {"s": line}, "run": {"kind": "equilibrium"}}))
    assert summary(found)["largest_sag"] is None


def test_a_steep_line_has_a_sag() -> None:
    line = {"start": [0, 400], "end": [20, 0], "length": 401, "mass": 1, "axial_stiffness": 1e7, "elements": 8}
    found = simulate(Scenario.model_validate({"lines": {"s": line}, "run": {"kind": "equilibrium"}}))
    assert summary(found)["largest_sag"]["value"] > 1.0


@pytest.mark.parametrize("wind", [False, True])  # from the side: results in space
@pytest.mark.parametrize("written", [2, 3])
def test_a_line_over_a_saddle_has_one_sag_however_many_components_are_written(written: int, wind: bool) -> None:
    places = {"start": [0, 0], "end": [20, 0]}
    line: dict[str, Any] = {"length": 20.3, "mass": 1.0, "axial_stiffness": 1e6, "elements": 20}
    blows = {"wind": {"direction": [0, 1, 0], "speed": 1.0}} if wind else {}
    line |= {"wind_drag": 1e-6} if wind else {}

    def point(x: float, z: float) -> list[float]:
        return [x, z] if written == 2 else [x, 0, z]

    line |= {key: point(*place) for key, place in places.items()}
    line["saddles"] = {"tower": {"at": point(9, 0.5), "radius": 2.0}}
    found = simulate(Scenario.model_validate({"lines": {"s": line}, "run": {"kind": "equilibrium"}, **blows}))
    assert found.sizes["axis"] == (3 if wind else 2)
    assert summary(found)["largest_sag"]["value"] == pytest.approx(
        0.85256, rel=1e-4
    )  # as written and computed in the plane


@pytest.mark.parametrize("wind", [False, True])
@pytest.mark.parametrize("written", [2, 3])
def test_a_line_over_a_sheave_has_one_sag_however_many_components_are_written(written: int, wind: bool) -> None:
    def point(x: float, z: float) -> list[float]:
        return [x, z] if written == 2 else [x, 0, z]

    line: dict[str, Any] = {"start": point(0, 0), "end": point(20, 0), "length": 20.3, "mass": 1.0,
                            "axial_stiffness": 1e6, "elements": 20, "sheaves": {"tower": {"at": point(9, 0.5)}},
                            **({"wind_drag": 1e-6} if wind else {})}  # fmt: skip
    blows = {"wind": {"direction": [0, 1, 0], "speed": 1.0}} if wind else {}
    found = simulate(Scenario.model_validate({"lines": {"s": line}, "run": {"kind": "equilibrium"}, **blows}))
    assert found.sizes["axis"] == (3 if wind else 2)
    assert summary(found)["largest_sag"]["value"] == pytest.approx(
        0.86589, rel=1e-4
    )  # as written and computed in the plane
