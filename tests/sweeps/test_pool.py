"""Tasks in processes that may die."""

from __future__ import annotations

import multiprocessing
from multiprocessing.connection import wait

import pytest

import sweep_cases as cases
from ropewalk.sweeps import pool
from ropewalk.sweeps.pool import each


def test_only_the_task_that_kills_its_process_is_lost():
    assert dict(each(range(6), cases.deadly, 2, -1)) == {0: 0, 1: 1, 2: 4, 3: -1, 4: 16, 5: 25}


def test_a_process_that_is_killed_once_costs_nothing(tmp_path):
    tasks = [(number, str(tmp_path / "killed")) for number in range(4)]
    found = {number: answer for (number, _), answer in each(tasks, cases.once_deadly, 1, -1)}
    assert found == {0: 0, 1: 1, 2: 4, 3: 9}


def test_tasks_are_asked_for_when_there_is_room():
    asked = []
    tasks = (asked.append(number) or number for number in range(9))
    going = each(tasks, cases.squared, 1, -1)
    next(going)
    assert asked == [0, 1]
    going.close()


def test_an_interrupt_ends_the_processes_whatever_they_do():
    def stopped():
        yield 1
        raise KeyboardInterrupt

    before = set(multiprocessing.active_children())
    with pytest.raises(KeyboardInterrupt):
        next(each(stopped(), cases.slow, 2, -1))
    # What has just been reaped by the pool's own thread may be counted as a child a moment longer: ask its pipe.
    assert all(
        wait([process.sentinel], timeout=5.0) for process in multiprocessing.active_children() if process not in before
    )


def test_brief_tasks_are_sent_together(monkeypatch):
    """200 of them one by one are 200 sendings; in chunks of 16 some 14, and a few while their time is not known."""
    sent = []
    submit = pool._submit
    monkeypatch.setattr(pool, "_submit", lambda *words: sent.append(words) or submit(*words))
    assert dict(each(range(200), cases.squared, 1, -1)) == {number: number**2 for number in range(200)}
    assert len(sent) < 40
