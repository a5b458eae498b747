"""Starting from a stored result."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array, State
from ropewalk.model.run import Start
from ropewalk.solve.start import Setting


def stored_instant(start: Start, nodes: int, axes: int) -> tuple[Array, Array]:
    """Positions and velocities of all nodes at a stored instant, (axis, node) m and m/s.

    Args:
        start: file and time (the last instant if None).
        nodes, axes: how many the scenario has.

    Raises:
        RopewalkError: the file does not fit the scenario, or has no such time.
    """
    return _instant(start, nodes, axes)[:2]


def _instant(start: Start, nodes: int, axes: int) -> tuple[Array, Array, int, Any]:
    """The same, with the number of the instant and the stored result."""
    from ropewalk.results.files import open_result

    assert start.file is not None
    stored = open_result(Path(start.file))
    if "time" not in stored.dims:
        raise RopewalkError(f"{start.file} holds no motion (it has no time): start from a dynamic result")
    if stored.sizes["node"] != nodes or stored.sizes["axis"] != axes:
        raise RopewalkError(
            f"{start.file} has {stored.sizes['node']} nodes and {stored.sizes['axis']} axes, the scenario "
            f"{nodes} and {axes}: use the same lines and elements"
        )
    times = stored["time"].values
    index = int(np.argmin(np.abs(times - start.time))) if start.time is not None else times.size - 1
    spacing = float(np.diff(times).min()) if times.size > 1 else 1.0
    if start.time is not None and abs(times[index] - start.time) > 1e-6 * spacing:
        raise RopewalkError(
            f"{start.file} has no frame at t = {start.time:g} s, the nearest is at {times[index]:g} s: take that one"
        )
    return stored["position"].values[index].T, stored["velocity"].values[index].T, index, stored


def take_up(setting: Setting, state: State, start: Start) -> None:
    """Put positions and velocities of a stored instant into a state at its beginning; the loads begin anew.

    Args:
        setting, state: the model and its state of rest; the state is changed.
        start: file and time (the last instant if None).

    Raises:
        RopewalkError: the file does not fit the lines, or has no such time.
    """
    position, velocity, index, stored = _instant(start, state.X.size, state.r.shape[0])
    state.r[:], state.w[:] = position, velocity
    strands = setting.strands
    for k, b in enumerate(state.rider):  # a riding node begins on the link that its load stands on
        if b < 0:
            continue
        s = int(setting.loads.strand[k])
        i, j = int(strands.first[s]), int(strands.first[s] + strands.links[s])
        home = np.arange(j - i + 1) * strands.h[s]
        for values in (state.r, state.w):
            line = stored["position" if values is state.r else "velocity"].values[index, i : j + 1]
            values[:, b] = [np.interp(state.X[b], home, component) for component in line.T]
