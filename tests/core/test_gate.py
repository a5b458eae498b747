"""The yardsticks of `benchmarks gate` on coarse meshes: what they compare is the same, and they print tables."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture
def gate(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.setattr(sys, "path", [str(ROOT), *sys.path])
    return importlib.import_module("benchmarks.gate")


def cells(text: str) -> list[list[str]]:
    """Rows of the last table of a text without its head."""
    lines = text.strip().split("\n\n")[-1].splitlines()
    return [[cell.strip(" *") for cell in line.strip("|").split("|")] for line in lines[2:]]


def test_times_between_meshes_follow_powers_and_beyond_them_the_power_of_all(gate: ModuleType) -> None:
    errors = np.array([0.4, 0.1, 0.025])
    for at in (0.2, 0.05, 0.001, 2.0):
        assert gate.seconds_at(at, errors, 3.0 * errors**-1.5) == pytest.approx(3.0 * at**-1.5, rel=1e-12)


def test_force_on_a_string_is_compared_at_the_same_error(gate: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    gate.errors(["force on a string, 0.5"], rounds=1, coarser=4)
    ((_, meshes, today, core, error, *times),) = cells(capsys.readouterr().out)
    assert meshes == "25, 50, 100"
    for column in (today.split(": ")[1], core):
        coarse, _, fine = map(float, column.split(", "))
        assert fine < float(error) * 1.1 < coarse * 1.2  # printed with two digits
    assert all(float(time) > 0.0 for time in times)


def test_core_stays_at_the_rest_of_todays_system_and_moves_as_it_does(
    gate: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    scenario = gate.bridge(16 * 4, 3)
    load = scenario.loads["load"].model_copy(update={"force": (0.0, 0.0)})
    frames = gate.CORE(scenario.model_copy(update={"loads": {"load": load}}), np.array([0.0, 0.3]))
    # rounding of forces of 1e5 N on links
    np.testing.assert_allclose(frames[1].position, frames[0].position, rtol=0, atol=1e-9)
    gate.agreement(["joined"], coarser=2)
    rows = cells(capsys.readouterr().out)
    # the same scheme with other steps, which miss by less than this part of the motion
    assert len(rows) == 3
    assert all(0.0 < float(row[3]) < 1e-4 for row in rows)


def test_set_up_is_timed_for_growing_sizes(gate: ModuleType) -> None:
    head, rows = gate.setup({"axles on a bridge": (6, 12)})
    assert len(rows[0]) == len(head)
    assert float(rows[0][-1]) < 4.0


def test_a_fresh_process_of_the_core_is_timed(gate: ModuleType) -> None:
    processes = sys.modules[gate.processes.__module__]
    before, motion = map(float, processes.fresh_process(processes.CORE_PROCESS, 1))
    assert before > 0.0
    assert 0.0 < motion < 5.0
