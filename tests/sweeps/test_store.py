"""The store: whole at any moment, shared, and never of something else."""

from __future__ import annotations

import json

import pytest

from ropewalk.results import ResultError
from ropewalk.sweeps.case import Outcome
from ropewalk.sweeps.store import Store

FINE = Outcome("completed", {"max tension": (1.1, "N"), "none": (None, "m")}, seconds=0.5)
FAILED = Outcome("failed", {}, (), "why")
BROKEN = Outcome("completed", {"limits.failures": (2.0, "1")}, broken={"limits.failures": "largest force; uplift"})


def filled(file, *keys):
    with Store(file) as store:
        for key in keys:
            store.add(key, FINE, ["a=1"])


def keys_in(file):
    return [json.loads(line)["key"] for line in file.read_bytes().splitlines()[1:]]


def test_what_is_kept_is_read_again(tmp_path):
    file = tmp_path / "s.jsonl"
    filled(file, "a", "b")
    with Store(file) as store:
        assert store.done == {"a": FINE, "b": FINE}


def test_cut_off_anywhere_it_is_whole_up_to_there_and_goes_on(tmp_path):
    """As a kill at any moment leaves it."""
    file = tmp_path / "s.jsonl"
    filled(file, "a", "b")
    whole = file.read_bytes()
    ends = [k + 1 for k, sign in enumerate(whole) if sign == 10]
    for size in range(len(whole)):
        file.write_bytes(whole[:size])
        with Store(file) as store:
            assert list(store.done) == ["a", "b"][: max(sum(end <= size for end in ends) - 1, 0)]
            for key in ("a", "b"):
                store.add(key, FINE, ["a=1"])
        assert file.read_bytes() == whole


def test_two_sweeps_see_what_the_other_has_finished_and_write_nothing_twice(tmp_path):
    file = tmp_path / "s.jsonl"
    with Store(file) as one, Store(file) as other:
        one.add("a", FINE, [])
        other.add("a", FINE, [])
        other.add("b", FINE, [])
        one.look()
        assert set(one.done) == set(other.done) == {"a", "b"}
        one.add("c", FINE, [])
        other.add("d", FINE, [])
        other.look()
        assert set(other.done) == {"a", "b", "c", "d"}
    assert keys_in(file) == ["a", "b", "c", "d"]


def test_half_a_line_of_somebody_who_was_killed_is_cut_away_by_the_next(tmp_path):
    file = tmp_path / "s.jsonl"
    with Store(file) as store:
        store.add("a", FINE, [])
        with file.open("ab") as other:
            other.write(b'{"key": "half')
        store.look()
        store.add("b", FINE, [])
    assert keys_in(file) == ["a", "b"]


def test_failures_are_computed_again_if_asked(tmp_path):
    file = tmp_path / "s.jsonl"
    with Store(file) as store:
        store.add("a", FAILED, [])
    with Store(file) as store:
        assert store.done == {"a": FAILED}
    with Store(file, retry=True) as store:
        assert store.done == {}
        store.add("a", FINE, [])
    with Store(file) as store:
        assert store.done == {"a": FINE}


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("lines: {}\n", "exists and is no store of a sweep; it is not overwritten"),
        ('{"format": "ropewalk sweep", "version": 2}\n', "written in another version"),
        ('{"format": "ropewalk adequacy", "version": 1}\n', "no store of a sweep"),
    ],
)
def test_a_file_of_something_else_is_left_alone(tmp_path, text, wrong):
    file = tmp_path / "s.jsonl"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ResultError, match=wrong):
        Store(file)
    assert file.read_text(encoding="utf-8") == text


def test_a_spoilt_line_is_told_with_its_number(tmp_path):
    file = tmp_path / "s.jsonl"
    filled(file, "a", "b")
    lines = file.read_bytes().splitlines(keepends=True)
    file.write_bytes(lines[0] + lines[1][:-20] + b"\n" + lines[2])
    with pytest.raises(ResultError, match=":2: this line cannot be read; delete it"):
        Store(file)


def test_names_of_broken_limits_are_kept_and_stores_from_before_are_read(tmp_path):
    file = tmp_path / "s.jsonl"
    with Store(file) as store:
        store.add("a", BROKEN, [])
        store.add("b", FINE, [])
    assert b'"broken"' not in file.read_bytes().splitlines()[2]  # as lines were before there were names
    with Store(file) as store:
        assert store.done == {"a": BROKEN, "b": FINE}
