"""`until: crossing` ends when the last load is at the end of its overhead line; on nets it is refused."""

from __future__ import annotations

from typing import Any

import pytest

from ropewalk.model import Scenario

LINE = {
    "spans": {"count": 10, "length": 50},
    "contact_wire": {"mass": 1.0, "tension": 12e3},
    "messenger_wire": {"mass": 1.0, "tension": 12e3},
    "droppers": {"per_span": 5, "stiffness": 1e5},
    "system_height": 1.2,
    "element": 2.0,
}


def end(travels: list[dict[str, Any]], until: str = "crossing", **line: Any) -> float:
    loads = {
        f"p{k}": {"kind": "pantograph", "on": "line", "model": "simple-ac", "travel": travel}
        for k, travel in enumerate(travels)
    }
    run = {"kind": "dynamic", "geometry": "linearised", "until": until}
    tree = {"overhead_lines": {"line": LINE | line}, "loads": loads, "run": run}
    return float(Scenario.model_validate(tree).run.until)  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("travels", "expected"),
    [
        ([{"speed": 40.0, "from": 20.0}], 12.0),
        ([{"speed": -40.0, "from": 480.0}], 12.0),
        ([{"speed": 40.0, "from": 110.0}, {"speed": 40.0, "from": 10.0}], 12.25),
        ([{"speed": {"time": [0, 5], "value": [40, 20]}, "from": 20.0}], 21.5),  # 150 m in 5 s, 330 m at 20 m/s
    ],
    ids=["forwards", "backwards", "two", "brakes"],
)
def test_a_crossing_ends_at_the_end_of_the_overhead_line(travels: list[dict[str, Any]], expected: float) -> None:
    leaving = [travel | {"at_end": "leave"} for travel in travels]
    assert end(leaving) == pytest.approx(expected, abs=1e-6)
    assert end(leaving, "crossing + 2 s") == pytest.approx(expected + 2.0, abs=1e-6)
    if len(travels) == 1:
        assert end(travels) == pytest.approx(expected, abs=1e-6)


def test_spans_may_be_listed() -> None:
    assert end([{"speed": 50.0, "from": 0.0}], spans=[40.0, 60.0, 50.0]) == pytest.approx(3.0)
