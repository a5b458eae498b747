"""A few of the kills of `make kills`, of each command."""

from __future__ import annotations

import pytest

from kills.commands import SCENARIOS, lasting, trial


@pytest.mark.parametrize("name", SCENARIOS)
def test_what_is_killed_is_taken_up_again_to_the_same_last_bit(name, tmp_path):
    whole, seconds = lasting(name, tmp_path / "whole")
    assert trial(name, tmp_path / "killed", 0.8 * seconds, whole) == ""
