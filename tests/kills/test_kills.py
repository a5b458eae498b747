"""A few of the kills of `make kills`, of each command."""

from __future__ import annotations

import pytest

from kills.commands import SCENARIOS, STORES, Command, lasting, trial


@pytest.mark.parametrize("name", [name for name in SCENARIOS if name not in STORES])
def test_a_run_that_is_killed_is_taken_up_again_to_the_same_last_bit(name, tmp_path):
    whole, seconds = lasting(name, tmp_path / "whole")
    assert trial(name, tmp_path / "killed", 0.8 * seconds, whole) == ""


@pytest.mark.parametrize("name", STORES)
def test_points_that_are_kept_when_it_is_killed_are_those_of_the_whole(name, tmp_path):
    """Killed when half of them are there, however long the kernels take."""
    (whole := Command(name, tmp_path / "whole")).whole()
    assert trial(name, tmp_path / "killed", 600.0, whole, kept=whole.frames() // 2) == ""
    assert (tmp_path / "killed" / STORES[name]).exists()
