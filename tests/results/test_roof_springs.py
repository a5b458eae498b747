"""A pantograph that stands on a stiff spring is remarked, and those of the standard are not."""

from __future__ import annotations

from typing import Any

import pytest

from ropewalk.model import Scenario
from ropewalk.model.pantographs import PUBLISHED
from ropewalk.results.scenario_warnings import stiff_below

WIRE = {"mass": 1.0, "tension": 2e4}
LINE: dict[str, Any] = {
    "spans": {"count": 3, "length": 50.0}, "contact_wire": WIRE, "messenger_wire": WIRE, "system_height": 1.2,
    "droppers": {"at": [10.0, 25.0, 40.0], "stiffness": 1e5},
}  # fmt: skip


def said(**keys: Any) -> list[str]:
    load = {"kind": "pantograph", "on": "line", "travel": {"speed": 40.0}, **keys}
    run = {"kind": "dynamic", "until": 1.0}
    return list(
        stiff_below(Scenario.model_validate({"overhead_lines": {"line": LINE}, "loads": {"one": load}, "run": run}))
    )


@pytest.mark.parametrize(("first", "count"), [(7e3, 1), (1e3, 1), (200.0, 0), (0.0, 0)])
def test_a_stiff_spring_on_the_roof_is_remarked(first: float, count: int) -> None:
    found = said(masses=[9.0, 6.0], stiffness=[first, 7e3], damping=[100.0, 50.0], static_force=120.0)
    assert len(found) == count
    assert all(line.startswith(f"pantograph one stands on a spring of {first:.4g} N/m") for line in found)


@pytest.mark.parametrize("model", PUBLISHED)
def test_published_ones_are_not(model: str) -> None:
    assert said(model=model) == []
    assert PUBLISHED[model].stiffness[0] < 1e3
