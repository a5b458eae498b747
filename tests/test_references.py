"""References: a sample of them is compared every day, and the comparison finds what it is there to find."""

from __future__ import annotations

import copy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from conformance.keys import furnish
from conformance.working import read_scenario
from references import store
from references.answering import answer
from references.cases import ReferenceCase, cases
from references.changes import PLANTED, half, planted
from references.comparing import Accepted, accepted, differences, is_better, without_accepted
from references.observing import Observation, low_passed
from references.recording import Record, append, read, record, record_shard
from references.tolerances import CAP, FLOOR, TRUSTED, Held, Reference, reference_of

HASH = "8c443b74a97ef3d781d6cb9fb6e1b2843e2fc196df4862f78e5889b114508fbe"
"""SHA-256 of the reference file, which is frozen."""
SAMPLE = 80  # cases compared here
CHEAP = 0.3  # s of CPU of a case
ACCEPTED = 0.01  # of the trusted cases

BY_NAME = {case.name: case for case in cases()}
MASS = BY_NAME["loads / one / string / mass"]
BEAM = BY_NAME["loads / one / beam / force"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the files that scenarios name."""
    found = tmp_path_factory.mktemp("references")
    furnish(found)
    return found


@pytest.fixture(scope="module")
def recorded() -> Record:
    """A mass on a string."""
    return record(MASS)


@pytest.fixture(scope="module")
def reference(recorded: Record, tmp_path_factory: pytest.TempPathFactory) -> Reference:
    """Its reference as stored."""
    file = tmp_path_factory.mktemp("stored") / "references.xz"
    store.write([reference_of(recorded, "")], file)
    return store.read(file)[MASS.name]


def compared(reference: Reference, found: Observation) -> dict[str, str]:
    return {difference.quantity: difference.text for difference in differences(reference, found)}


def test_names_of_cases_are_unique() -> None:
    assert len(BY_NAME) == len(cases())


def test_a_sample_of_cases_does_not_differ(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each day the same cases, of all tables by chance; `make references` compares all."""
    monkeypatch.chdir(folder)
    references = store.read()
    known = [case for case in cases() if case.name in references and references[case.name].cpu < CHEAP]
    faults = []
    for case in sorted(known, key=lambda case: case.shard)[:SAMPLE]:
        found = answer(lambda case=case: case.tree, case.tool, case.options)
        faults += without_accepted(differences(references[case.name], found), found, accepted())
    assert not faults, "\n".join(map(str, faults))


def test_the_references_are_frozen() -> None:
    assert store.digest() == HASH


def test_every_reference_has_its_case_and_few_differences_are_accepted() -> None:
    references = store.read()
    assert set(references) <= set(BY_NAME)
    assert len({entry.case for entry in accepted()}) <= ACCEPTED * sum(r.mark == TRUSTED for r in references.values())
    assert all(entry.source for entry in accepted())
    assert store.FILE.stat().st_size < 20e6


def test_the_same_state_does_not_differ(recorded: Record, reference: Reference) -> None:
    assert reference.mark == TRUSTED
    assert compared(reference, recorded.full) == {}
    assert compared(reference, record(MASS, halved=False).full) == {}


@pytest.mark.parametrize(
    ("case", "change"), [(MASS, "EA"), (BEAM, "EI"), ("loads / one / slack / mass", "damping"),
                         ("travel / free with friction / string / mass", "friction"),
                         ("contacts / soft contact / beam / oscillator", "contact_stiffness"),
                         ("travel / material / overhead-linearised / mass", "dropper stiffness")],
)  # fmt: skip
def test_a_planted_change_is_found(case: ReferenceCase | str, change: str) -> None:
    case = BY_NAME[case] if isinstance(case, str) else case
    one, tree = record(case), planted(read_scenario(case.tree), change)
    assert tree is not None
    reference = reference_of(one, "")
    assert compared(reference, one.full) == {}
    assert compared(reference, answer(lambda: tree)) != {}


def test_every_planted_change_changes_only_its_keys() -> None:
    scenario = read_scenario(MASS.tree)
    assert planted(scenario, "EI") is None
    tree = planted(scenario, "EA")
    assert tree is not None
    assert tree["lines"]["rope"]["axial_stiffness"] == pytest.approx(1.02e6)
    assert read_scenario(planted(scenario, "nothing") or {}) == scenario
    assert set(PLANTED) == {"nothing", "EA", "EI", "damping", "friction", "contact_stiffness", "dropper stiffness"}


def test_a_missing_part_of_the_structure_is_found(recorded: Record, reference: Reference) -> None:
    def without(change: str) -> dict[str, str]:
        found = copy.deepcopy(recorded.full)
        own = found.structure["result"]
        match change:
            case "variable":
                del own["variables"]["hold_force"]
            case "dimension":
                own["variables"]["tension"][0] = ["time", "node"]
            case "unit":
                own["variables"]["tension"][2] = "kN"
            case "attribute of a variable":
                own["variables"]["tension"][3].remove("long_name")
            case "attribute":
                own["attributes"].remove("method")
            case "key":
                own["summary"].remove("/largest_tension/unit")
            case "name":
                own["names"]["load"] = ["weight"]
        return compared(reference, found)

    assert without("variable") == {"result variables": "hold_force is missing"}
    assert without("dimension") == {"result variables": "dimensions of tension: ['time', 'node'], was ['time', 'link']"}
    assert without("unit") == {"result variables": "units of tension: kN, was N"}
    assert without("attribute of a variable") == {"result variables": "attribute long_name of tension is missing"}
    assert without("attribute") == {"result attributes": "method is missing"}
    assert without("key") == {"result summary": "/largest_tension/unit is missing"}
    assert without("name") == {"result names": "load is ['weight'], was ['load']"}


def test_a_quantity_beyond_its_tolerance_is_found_and_one_within_is_not(recorded: Record, reference: Reference) -> None:
    name = "force:contact 0 z"
    for times, found in ((0.8, set()), (1.3, {name})):
        changed = copy.deepcopy(recorded.full)
        held = reference.quantities[name]
        changed.quantities[name][len(held.values) - 1] += times * held.tolerance
        assert compared(reference, changed).keys() == found
    del changed.quantities[name]
    assert compared(reference, changed) == {name: "missing"}


def test_outcomes_and_exit_codes_are_compared_and_a_better_one_is_no_difference(reference: Reference) -> None:
    refused = Observation("refused", 2, "loads.load.mass: too light")
    assert list(compared(reference, refused)) == ["outcome"]
    was = Reference("case", "doubtful", "refused", 2)
    assert compared(was, refused) == {}
    better = Observation("doubtful", 4)
    assert compared(was, better) == {}
    assert is_better(was, better)
    assert "exit code 1" in compared(was, replace(refused, exit_code=1))["outcome"]


def test_numbers_that_are_not_trusted_are_not_compared(recorded: Record) -> None:
    wrong = reference_of(recorded, "a reason")
    changed = copy.deepcopy(recorded.full)
    changed.quantities.clear()
    changed.numbers.clear()
    assert compared(wrong, changed) == {}
    changed.structure.clear()
    assert compared(wrong, changed) == {"result": "missing"}


def observed(values: list[float], name: str = "force:x") -> Observation:
    return Observation("completed", 0, quantities={name: np.array(values)})


@pytest.mark.parametrize(
    ("half", "held", "tolerance"),
    [
        ([0.0, 50.0, 100.0], 3, FLOOR * 100.0),  # the same
        ([0.0, 51.0, 100.0], 3, 2.0),  # twice the difference
        ([0.0, 50.0, 106.0], 3, CAP["force"] * 100.0),  # more than a cap, and the finer mesh may be good enough
        ([0.0, 50.0, 140.0], 2, FLOOR * 100.0),  # rings: the instants before are held
        ([40.0, 50.0, 100.0], 0, None),
    ],
)
def test_tolerances_come_from_half_the_elements(half: list[float], held: int, tolerance: float | None) -> None:
    full = observed([0.0, 50.0, 100.0])
    found = reference_of(Record("case", full, observed(half)), "").quantities.get("force:x", Held(np.empty(0), np.nan))
    assert len(found.values) == held
    assert tolerance is None or found.tolerance == pytest.approx(tolerance)


def test_half_the_elements_are_half_of_lines_nets_and_overhead_lines() -> None:
    tree = {
        "lines": {"a": {"elements": 81}},
        "nets": {"n": {"cells": [8, 5]}},
        "overhead_lines": {"o": {"element": 1.0}},
    }
    assert half(tree) == {
        "lines": {"a": {"elements": 41}}, "nets": {"n": {"cells": [4, 3]}}, "overhead_lines": {"o": {"element": 2.0}}
    }  # fmt: skip
    assert half({"lines": {"a": {"length": 3.0}}}) is None


def test_stored_values_are_within_an_eighth_of_their_tolerance(tmp_path: Path) -> None:
    values = np.random.default_rng(1).normal(size=(9, 3, 2))
    values[2, 1] = np.nan
    case = Reference("case", TRUSTED, "completed", 0, quantities={"force:x": Held(values, 1e-3)},
                     numbers={"/a": (1.5, 0.01), "/b": (-2e9, 1e3)})  # fmt: skip
    store.write([case], tmp_path / "one.xz")
    found = store.read(tmp_path / "one.xz")["case"]
    held = found.quantities["force:x"]
    assert 1e-3 <= held.tolerance < 1.08e-3
    np.testing.assert_allclose(held.values, values, atol=0.13 * held.tolerance, rtol=0.0)
    assert found.numbers["/b"][0] == pytest.approx(-2e9, rel=1e-6)


def test_an_accepted_difference_needs_its_independent_number(reference: Reference, recorded: Record) -> None:
    changed = copy.deepcopy(recorded.full)
    path = "/largest_tension/value"
    changed.numbers[path] *= 1.5
    found = list(differences(reference, changed))
    assert [difference.quantity for difference in found] == [path]
    right = Accepted(MASS.name, path, changed.numbers[path], 1.0, "a closed form")
    assert without_accepted(found, changed, [right]) == []
    assert without_accepted(found, changed, [replace(right, value=right.value + 2.0)]) == found
    assert without_accepted(found, changed, [replace(right, case="another")]) == found


def test_a_recording_that_was_cut_short_is_completed(tmp_path: Path, recorded: Record) -> None:
    file = tmp_path / "shard-00.bin"
    with file.open("ab") as stream:
        append(stream, recorded)
        append(stream, replace(recorded, name="second"))
    whole = file.read_bytes()
    file.write_bytes(whole[:-10])
    assert [found.name for found in read(file)] == [MASS.name]
    record_shard([MASS], file, tmp_path)  # nothing to do
    assert [found.name for found in read(file)] == [MASS.name]
    assert len(file.read_bytes()) < len(whole) - 10


def test_low_passed_forces_keep_their_mean_and_lose_their_ringing() -> None:
    t = np.linspace(0.0, 1.0, 1001)
    ringing = low_passed(t, 100.0 + 50.0 * np.sin(2.0 * np.pi * 200.0 * t))
    np.testing.assert_allclose(ringing[100:-100], 100.0, atol=1.0)  # 10 periods in a window of 51 instants
