"""An equilibrium of an overhead line reports the lengths to which its droppers have to be made."""

from __future__ import annotations

from pathlib import Path

import pytest

import ropewalk
from ropewalk.results import summary, tables, text
from ropewalk.results.display_units import DisplayUnits
from ropewalk.scenario import load

LINE = Path(__file__).parent / "a-10-dropper-lengths.yaml"
COARSE = "overhead_lines.line.element=2.5"


def droppers(*settings: str) -> dict:
    return summary(ropewalk.simulate(load(LINE, [COARSE, *settings])))["overhead_lines"]["line"]["droppers"]


def test_the_equilibrium_has_the_lengths_forces_and_stations_of_all_droppers():
    found = ropewalk.simulate(load(LINE, [COARSE]))
    own = summary(found)["overhead_lines"]["line"]["droppers"]
    assert len(own) == 20
    assert own["line.1.3"]["station"] == 27.5
    assert own["line.1.3"]["largest"] == own["line.1.3"]["smallest"] == pytest.approx(119.2, rel=0.02)
    assert "overhead_lines.line.droppers.line.1.3.length" in tables(found)["summary"]["quantity"].tolist()
    row = next(row for row in text(summary(found)).splitlines() if row.startswith("lengths of droppers, span 1"))
    assert f"{own['line.1.3']['length']:#.4g}" in row
    row = next(row for row in text(summary(found), DisplayUnits.read("ft")).splitlines() if "droppers, span 1" in row)
    assert f"{own['line.1.3']['length'] / 0.3048:#.4g}" in row


def test_the_lengths_are_those_of_a_motion_from_the_same_rest():
    at_rest = droppers()
    loads = "loads={p: {kind: pantograph, on: line, model: en50318-2002, travel: {speed: 20, from: 10}}}"
    moving = droppers(loads, "run={kind: dynamic, geometry: linearised, until: 0.02, every: 0.02}")
    assert moving.keys() == at_rest.keys()
    for name, dropper in moving.items():
        assert dropper["length"] == pytest.approx(at_rest[name]["length"], abs=1e-3)  # of one metre


def test_declared_lengths_are_reported_as_declared():
    lengths = [1.2, 0.9, 0.8, 0.9, 1.2]
    found = droppers(f"overhead_lines.line.droppers.lengths={[lengths] * 4}")
    assert [found[f"line.2.{k + 1}"]["length"] for k in range(5)] == lengths
