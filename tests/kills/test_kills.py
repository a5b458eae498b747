"""A few of the kills of `make kills`, of each command."""

from __future__ import annotations

import pytest

from kills.commands import SCENARIOS, Command, trial


@pytest.mark.parametrize("name", SCENARIOS)
def test_what_is_killed_is_taken_up_again_to_the_same_last_bit(name, tmp_path):
    """Killed when some frames or points are there, however long the kernels take; what is kept is that of the whole."""
    (whole := Command(name, tmp_path / "whole")).whole()
    assert trial(name, tmp_path / "killed", 600.0, whole, kept=2 + whole.frames() // 10) == ""
    assert (tmp_path / "killed" / whole.result.name).exists()
