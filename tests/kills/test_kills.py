"""A few of the kills of `make kills`, of each command, and a few interrupts of `make interrupts`."""

from __future__ import annotations

import pytest

from kills.commands import SCENARIOS, Command, trial
from kills.interrupts import TEXTS, interrupted
from ropewalk.scenario import loads


@pytest.mark.parametrize("name", SCENARIOS)
def test_what_is_killed_is_taken_up_again_to_the_same_last_bit(name, tmp_path):
    """Killed when some frames or points are there, however long the kernels take; what is kept is that of the whole."""
    (whole := Command(name, tmp_path / "whole")).whole()
    assert trial(name, tmp_path / "killed", 600.0, whole, kept=2 + whole.frames() // 10) == ""
    assert (tmp_path / "killed" / whole.result.name).exists()


@pytest.mark.parametrize("name", TEXTS)
def test_what_is_interrupted_would_run(name):
    loads(TEXTS[name], "one.yaml")


@pytest.mark.parametrize(
    "name", ["run rope, quasi-static", "run beam, linear", "run net, equilibrium", "run train", "run ropeway", "sweep"]
)
def test_an_interrupt_ends_a_command_wherever_it_is(name, tmp_path):
    """In imports or set-up (0.5 s) and later (1.5 s); counted is the CPU time, since machines of tests are busy."""
    for after in (0.5, 1.5):
        answer = interrupted(name, tmp_path / f"{after}", after)
        if answer is not None:
            assert answer.fault == ""
            assert answer.cpu < 1.0, answer  # 0.5 s are the aim; an import that cannot be left takes 0.3 s of it
