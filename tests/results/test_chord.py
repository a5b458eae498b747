"""Sag of lines: over inner supports and saddles that of their spans, m g L^2/8T of a shallow parabola; at loads."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ropewalk.model import Scenario
from ropewalk.results import summary, tables
from ropewalk.simulate import simulate

MASS, TENSION, SPAN, HIGH = 2.0, 50e3, 100.0, 8.0
LINE = {
    "start": [0, 0], "end": [2.0 * SPAN, 0], "mass": MASS, "axial_stiffness": 1e8, "elements": 200,
    "end_support": {"kind": "guided", "along": [1, 0], "force": TENSION},
}  # fmt: skip


@pytest.mark.parametrize(
    ("supported", "radius"),
    [
        ({"supports": {"pier": {"kind": "guided", "along": [1, 0], "at": SPAN, "position": [SPAN, HIGH]}}}, 0.0),
        ({"saddles": {"tower": {"at": [SPAN, HIGH], "radius": 20.0}}}, 20.0),
    ],
    ids=["pier", "saddle"],
)
def test_the_sag_over_a_tower_is_that_of_the_span(supported: dict[str, Any], radius: float) -> None:
    """Below the chord of the ends it would be nothing. From a saddle the line goes on a from its top, a s/2 lower."""
    length = 2.0 * float(np.hypot(SPAN, HIGH))
    tree = {"lines": {"track": LINE | supported | {"length": length}}, "run": {"kind": "equilibrium"}}
    found = summary(simulate(Scenario.model_validate(tree)))["largest_sag"]
    w = MASS * 9.81 / TENSION
    s = HIGH / SPAN + w * SPAN / 2.0
    a = radius * s
    exact = w * (SPAN - a) ** 2 / 8.0 - 0.5 * (HIGH - a * s / 2.0) + 0.5 * HIGH * (SPAN - a) / SPAN
    # The line is 0.5 % longer than its spans, and as much tauter than the force at its end.
    assert found["value"] == pytest.approx(exact, rel=0.015)
    assert abs(abs(found["x"] - SPAN) - 0.5 * SPAN) < 6.0


SHEAVES = {
    "one, counterweight below": ({"mast": {"at": [100, 12]}}, [100, 3], 109.6),
    "one, end behind and high": ({"mast": {"at": [100, 12]}}, [130, 20], 131.5),
    "two": ({"a": {"at": [20, 14]}, "b": {"at": [100, 12]}}, [100, 3], 110.0),
}


@pytest.mark.parametrize("name", SHEAVES)
@pytest.mark.parametrize("mirrored", [1.0, -1.0])
@pytest.mark.parametrize("loaded", [True, False])
def test_the_sag_over_sheaves_is_that_of_the_longest_span(name: str, mirrored: float, loaded: bool) -> None:
    """w L^2/8H + P a(L - a)/L H below the chord from sheave to sheave, not below that of the ends."""
    sheaves, end, length = SHEAVES[name]
    places = {key: {"at": [mirrored * one["at"][0], one["at"][1]]} for key, one in sheaves.items()}
    guided = {"kind": "guided", "along": [0, 1], "force": -40e3} if end[0] == 100 else {"kind": "fixed"}
    line = {
        "start": [0, 10], "sheaves": places, "end": [mirrored * end[0], end[1]], "end_support": guided,
        "length": length, "mass": 2.0, "axial_stiffness": 1e7, "elements": 220,
    }  # fmt: skip
    weight = {"kind": "force", "on": "rope", "force": [0, -1e3], "travel": {"from": 60.0, "speed": 0.0}}
    tree = {"lines": {"rope": line}, "run": {"kind": "equilibrium"}, **({"loads": {"w": weight}} if loaded else {})}
    result = simulate(Scenario.model_validate(tree))
    found, x = summary(result)["largest_sag"], mirrored * result["position"].sel(axis="x").values[0]
    z, tension = result["position"].sel(axis="z").values[0], float(result["tension"].values[0, 60])
    knots = sorted([(0.0, 10.0), *((abs(one["at"][0]), one["at"][1]) for one in places.values())])
    span = x < 100.0 - 1e-6
    assert found["value"] == pytest.approx((np.interp(x, *zip(*knots, strict=True)) - z)[span].max(), rel=2e-3)
    low, P = knots[-2][0], 1e3 if loaded else 0.0
    L, a = 100.0 - low, abs(found["x"]) - low
    shallow = 2.0 * 9.81 * a * (L - a) / 2.0 / tension + P * a * (L - a) / L / tension
    assert found["value"] == pytest.approx(shallow, rel=0.03)  # the slope of the chord and of the rope


@pytest.mark.parametrize("wind", [None, {"direction": [1, 0], "speed": 0.0}], ids=["chain", "system"])
def test_a_line_is_deepest_at_its_load(wind: dict[str, Any] | None) -> None:
    """a(L - a)/L times P/T below the chord, between nodes: those beside it are a part of it higher."""
    line = {"start": [0, 0], "end": [10, 0], "mass": 1e-6, "tension": 1e4, "axial_stiffness": 1e8, "elements": 10}
    load = {"kind": "force", "on": "wire", "force": [0, -50.0], "travel": {"from": 4.5, "speed": 0.0}}
    tree: dict[str, Any] = {"lines": {"wire": line}, "loads": {"weight": load}, "run": {"kind": "equilibrium"}}
    if wind:
        tree["wind"], line["wind_drag"] = wind, 1e-30
    result = simulate(Scenario.model_validate(tree))
    found = summary(result)["largest_sag"]
    tension = float(result.contact_tension.values.mean())  # the load stretches the line
    assert found["value"] == pytest.approx(50.0 * 4.5 * 5.5 / 10.0 / tension, rel=1e-3)
    assert found["x"] == pytest.approx(4.5, abs=1e-3)
    assert float(tables(result)["series"]["wire.largest_sag [m]"].iloc[0]) == found["value"]
