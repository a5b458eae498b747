"""A sample of the pairs that `make properties` examines, and faults that it has to find."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.simulate import simulate

from . import running
from .known import KNOWN
from .pairs import verdicts
from .relations import BY_NAME
from .running import Fields, fields_of
from .trees import Tree

SEED, SCENARIOS = 11, 14

ROPE: Tree = {
    "gravity": 9.81,
    "lines": {"rope": {"start": [0.0, 0.0], "end": [20.0, 0.0], "length": 20.4, "mass": 1.0, "axial_stiffness": 1e6,
                       "axial_damping": 200.0, "elements": 20}},
    "loads": {"load": {"kind": "force", "on": "rope", "force": [0.0, -50.0], "travel": {"speed": 3.0, "from": 5.0}}},
    "run": {"kind": "dynamic", "until": 0.2, "every": 0.05},
}  # fmt: skip


def test_relations_hold_in_a_sample_of_scenarios() -> None:
    found = [verdict for number in range(SCENARIOS) for _, verdict in verdicts(SEED, number) if verdict is not None]
    assert len(found) > 2 * SCENARIOS
    new = [f"{one.pair} ({one.kind}): {one.what}" for one in found if one.is_violated and not one.case]
    assert not new, "\n".join(new)


def _planted(monkeypatch: pytest.MonkeyPatch, change: Any) -> None:
    """Let results of lines that run towards -x be changed."""

    def changed(result: xr.Dataset) -> Fields:
        fields = fields_of(result)
        position = fields["position", "rope"]
        if position[0, -1, 0] < position[0, 0, 0]:
            change(fields)
        return fields

    running._run.cache_clear()
    monkeypatch.setattr(running, "fields_of", changed)


@pytest.fixture(autouse=True)
def _forget() -> Any:
    """Let no run of a planted fault be found by another test."""
    yield
    running._run.cache_clear()


@pytest.mark.parametrize("variable", ["tension", "position", "contact_force", "reaction"])
def test_a_fault_of_one_direction_is_found(monkeypatch: pytest.MonkeyPatch, variable: str) -> None:
    def fault(fields: Fields) -> None:
        fields.update({key: values * 1.001 for key, values in fields.items() if key[0] == variable})

    assert BY_NAME["mirror"].compared(ROPE, "1").size < 1.0
    _planted(monkeypatch, fault)
    found = BY_NAME["mirror"].violation(ROPE, "1")
    assert found is not None
    assert found.size > 1.0
    assert variable in found.what


def test_a_difference_that_shrinks_with_the_mesh_is_no_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    def error_of_the_mesh(fields: Fields) -> None:
        fields["tension", "rope"] = fields["tension", "rope"] * (1.0 + 0.1 / fields["tension", "rope"].shape[1])

    _planted(monkeypatch, error_of_the_mesh)
    assert BY_NAME["mirror"].compared(ROPE, "1").size > 1.0
    assert BY_NAME["mirror"].violation(ROPE, "1").size == 0.0


def test_a_refusal_of_one_side_and_a_crash_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    _planted(monkeypatch, lambda fields: 1 / 0)
    found = BY_NAME["mirror"].violation(ROPE, "1")
    assert found is not None
    assert np.isinf(found.size)
    refused = {**ROPE, "lines": {"rope": {**ROPE["lines"]["rope"], "mass": -1.0}}}
    assert BY_NAME["mirror"].violation(refused, "1").size == 0.0  # both sides are


def test_expected_failures_name_a_case_and_a_stage() -> None:
    assert all(one.case and one.reason and 2 <= one.stage <= 5 for one in KNOWN)
    assert len({one.case for one in KNOWN}) == len(KNOWN)


def test_fields_name_owners_as_the_contract_does() -> None:
    fields = fields_of(simulate(running.read(ROPE)))
    assert {("reaction", "rope.start"), ("contact_force", "load"), ("energy", "imbalance")} <= set(fields)
