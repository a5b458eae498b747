"""Histories of travel, forces and drives as tables."""

from __future__ import annotations

from typing import NamedTuple

from ropewalk.mechanics.chain import Array

WHERE = ["speed_first", "speed_count", "force_first", "force_count", "drive_first", "drive_count"]
"""Fields of contacts that locate their entries in these tables; tables of a longer run are longer."""


class Tables(NamedTuple):
    """Histories of all contacts, one after the other."""

    speed_time: Array
    speed_value: Array
    speed_path: Array
    force_time: Array
    force_value: Array  # (axis, entry)
    drive_time: Array
    drive_value: Array
