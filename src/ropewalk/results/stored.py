"""A stored instant, to start from."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.model.run import Start
from ropewalk.results.frame import Array

if TYPE_CHECKING:
    import xarray as xr


def stored_instant(start: Start, nodes: int, axes: int) -> tuple[Array, Array]:
    """Positions and velocities of all nodes at a stored instant, (axis, node) m and m/s.

    Args:
        start: file and time (the last instant if None).
        nodes, axes: how many the scenario has.

    Raises:
        RopewalkError: the file does not fit the scenario, or has no such time.
    """
    stored, index = _instant(start)
    if stored.sizes["node"] != nodes or stored.sizes["axis"] != axes:
        raise RopewalkError(
            f"{start.file} has {stored.sizes['node']} nodes and {stored.sizes['axis']} axes, the scenario "
            f"{nodes} and {axes}: use the same lines and elements"
        )
    return stored["position"].values[index].T, stored["velocity"].values[index].T


def stored_stations(start: Start, sheaves: int) -> Array:
    """Where lines are over their sheaves at a stored instant, (sheave,) m; as many as the scenario has.

    Raises:
        RopewalkError: the file does not fit the scenario, or has no such time.
    """
    stored, index = _instant(start)
    if (count := stored.sizes.get("sheave", 0)) != sheaves:
        raise RopewalkError(
            f"{start.file} has {count} sheaves, the scenario {sheaves}: use the same lines, and a new result"
        )
    return np.asarray(stored["sheave_station"].values[index])


def _instant(start: Start) -> tuple[xr.Dataset, int]:
    """The stored motion, and which instant it is."""
    from ropewalk.results.files import open_result

    assert start.file is not None
    stored = open_result(Path(start.file))
    if "time" not in stored.dims:
        raise RopewalkError(f"{start.file} holds no motion (it has no time): start from a dynamic result")
    times = stored["time"].values
    index = int(np.argmin(np.abs(times - start.time))) if start.time is not None else times.size - 1
    spacing = float(np.diff(times).min()) if times.size > 1 else 1.0
    if start.time is not None and abs(times[index] - start.time) > 1e-6 * spacing:
        raise RopewalkError(
            f"{start.file} has no frame at t = {start.time:g} s, the nearest is at {times[index]:g} s: take that one"
        )
    return stored, index
