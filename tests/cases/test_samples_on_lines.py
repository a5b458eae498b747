"""Samples of irregularities, profiles and ground lie on their lines, and heights that are unlikely are questioned."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from ropewalk import load
from ropewalk.errors import ScenarioError
from ropewalk.model import Scenario
from ropewalk.overhead.irregularity import check_samples
from ropewalk.simulate import simulate

HERE = Path(__file__).parent
BRIDGE: dict[str, Any] = {
    "start": [0, 0], "end": [20, 0], "length": 20, "mass": 500, "axial_stiffness": 1e9, "bending_stiffness": 1e8,
    "elements": 8,
}  # fmt: skip
VEHICLE = {"kind": "mass", "on": "b", "mass": 100, "travel": {"speed": 10.0, "from": 2.0, "at_end": "leave"}}


def road(tmp_path: Path, rows: str, **more: Any) -> Scenario:
    file = tmp_path / "road.csv"
    file.write_text(rows)
    lines = {"b": {**BRIDGE, "profile": {"file": str(file)}}}
    run = {"kind": "dynamic", "until": 0.01, "every": 0.01}
    return Scenario.model_validate({"lines": lines, "loads": {"m": VEHICLE}, "run": run, **more})


def test_an_irregularity_whose_samples_lie_off_the_line_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(HERE)
    with pytest.raises(ScenarioError, match=r"loads\.front\.irregularity: no sample lies on line, from 0 m to 300 m"):
        simulate(load(HERE / "irregularity-in-mm.yaml"))


def test_the_remedy_is_accepted_and_heights_in_mm_are_questioned(tmp_path: Path) -> None:
    rows = [line.split(",") for line in (HERE / "irregularity-in-mm.csv").read_text().splitlines()]
    scenario = load(HERE / "irregularity-in-mm.yaml")
    for factor, questioned in ((1.0, True), (1e-3, False)):
        file = tmp_path / "in-m.csv"
        file.write_text("\n".join(f"{float(x) / 1000.0}, {factor * float(z)}" for x, z in rows))
        front = scenario.loads["front"].model_copy(update={"irregularity": str(file)})
        warnings = check_samples(scenario.model_copy(update={"loads": {"front": front}}))
        assert len(warnings) == questioned
        assert not questioned or "divide values in mm by 1000" in warnings[0]


@pytest.mark.parametrize(
    ("rows", "wrong"),
    [
        ("1000, 0\n2000, 0.001\n3000, 0", "no sample lies on b"),  # x in mm
        ("0, 0\n1000, 0.001\n2000, 0", "only one sample lies on b"),  # x in mm, from the start of the line
        ("-1000, 0\n0, 0.001", "only one sample lies on b"),
        ("-30, 0\n-20, 0.001\n-1, 0", "no sample lies on b"),  # before the line
        ("20.5, 0\n21, 0.001", "no sample lies on b"),  # behind it
        ("-5000, 0\n5000, 0.1", "no sample lies on b"),
        ("15, 0\n40, 0.001", ""),  # covers a part
        ("-10, 0\n30, 0.001", ""),
        ("0, 0\n20, 0.01", ""),
    ],
)
@pytest.mark.parametrize("kind", ["dynamic", "quasistatic"])
def test_a_profile_needs_samples_on_its_line(tmp_path: Path, rows: str, wrong: str, kind: str) -> None:
    run = {"kind": "dynamic", "until": 0.01, "every": 0.01} if kind == "dynamic" else {"kind": kind, "positions": 2}
    scenario = road(tmp_path, rows, run=run)
    if not wrong:
        assert not check_samples(scenario)
        return
    with pytest.raises(ScenarioError, match=rf"lines\.b\.profile\.file: {wrong}"):
        simulate(scenario)


def test_a_profile_before_the_line_counts_for_vehicles_that_begin_there(tmp_path: Path) -> None:
    wheels = {"one": {"at": 0.0, "mass": 50.0}, "two": {"at": -3.0, "mass": 50.0}}
    travel = {"speed": 10.0, "from": -8.0, "at_end": "leave"}
    cart = {"kind": "vehicle", "on": "b", "bodies": {}, "wheels": wheels, "travel": travel}
    assert not check_samples(road(tmp_path, "-20, 0\n-10, 0.001\n-1, 0", loads={"cart": cart}))


@pytest.mark.parametrize(
    ("rows", "questioned"),
    [
        ("0, 0\n5, 0.3\n10, 0.4\n15, 0.3\n20, 0", False),  # camber, 6 %
        ("0, 0\n1, 0.003\n2, -0.004\n20, 0", False),  # roughness in m
        ("0, 0\n1, 0.3\n2, -0.4\n20, 0", True),  # the same in mm, a tenth of it
    ],
)
def test_heights_of_a_profile_are_questioned_where_they_are_steeper_than_roads(
    tmp_path: Path, rows: str, questioned: bool
) -> None:
    result = simulate(road(tmp_path, rows))
    assert ("check the unit: z is in m" in result.warnings) == questioned


def test_ground_needs_points_below_the_lines_and_a_likely_distance() -> None:
    lines = {"r": {"start": [0, 0], "end": [20, 0], "length": 20.1, "mass": 1, "axial_stiffness": 1e5, "elements": 4}}
    ask: dict[str, Any] = {"lines": lines, "run": {"kind": "equilibrium"}}
    for points in ([[5000, -9000], [20000, -9000]], [[-9, -5], [-1, -5]]):
        with pytest.raises(ScenarioError, match=r"outputs\.ground: no part of it lies below the lines"):
            Scenario(**ask, outputs={"ground": points})  # type: ignore[arg-type]
    for points, questioned in (([[0, -9000], [20000, -9000]], True), ([[-1, -9], [20, -90]], False)):
        result = simulate(Scenario.model_validate({**ask, "outputs": {"ground": points}}))
        assert ("outputs.ground: lines of 20 m are 9000 m" in result.warnings) == questioned
