"""How a motion of plain ropes begins: at rest, in a mode, or as a stored result ended."""

from __future__ import annotations

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.bodies import Bodies
from ropewalk.mechanics.chain import ChainState
from ropewalk.model.run import Dynamic, Start
from ropewalk.model.scenario import Scenario
from ropewalk.results.stored import stored_instant
from ropewalk.solve.ends import ends_of, location_ends
from ropewalk.solve.initial_loads import place_loads
from ropewalk.solve.modes_at_start import deflect
from ropewalk.solve.start import PreparedRun, start_state
from ropewalk.solve.vehicle_statics import resting_forces


def initial_state(setting: PreparedRun, scenario: Scenario) -> tuple[ChainState, Bodies | None]:
    """The first state of a motion, and all that has a mass."""
    run = scenario.run
    assert isinstance(run, Dynamic)
    state = start_state(setting, run.start.with_loads, resting_forces(setting.loading))
    if run.start.kind == "result":
        take_up(setting, state, run.start)
        _check_ends(setting, state)
        location_ends(setting.strands, setting.supports, state)
    elif run.start.kind == "mode":
        deflect(setting, state, run.start)
    return state, place_loads(setting, state, run.start.with_loads)


def _check_ends(setting: PreparedRun, state: ChainState) -> None:
    """Refuse to take up a motion at supports that are prescribed to stand elsewhere: the line would be torn there."""
    ends = ends_of(setting.strands, setting.supports)
    for number, node in zip(ends.number, ends.node, strict=True) if ends is not None else ():
        s, side = divmod(int(number), 2)
        restrained = setting.restrained(s, float(state.t[0]))
        stuck = np.eye(len(setting.axes)) - restrained.free[side]
        away = float(np.linalg.norm(stuck @ (state.r[:, node] - restrained.place[side])))
        if away > 1e-9 * setting.strands.h[s] * setting.strands.links[s]:
            name = f"lines: {setting.lines[s]}: {('start', 'end')[side]}_support"
            raise RopewalkError(
                f"{name} stands {away:.3g} m elsewhere in the stored result; let its place and displacement begin there"
            )


def take_up(setting: PreparedRun, state: ChainState, start: Start) -> None:
    """Put positions and velocities of a stored instant into a state at its beginning; the loads begin anew.

    Args:
        setting, state: the model and its state of rest; the state is changed.
        start: file and time (the last instant if None).

    Raises:
        RopewalkError: the file does not fit the lines, or has no such time.
    """
    position, velocity = stored_instant(start, state.X.size, state.r.shape[0])
    state.r[:], state.w[:] = position, velocity
    strands = setting.strands
    for k, b in enumerate(state.moving_load):  # a riding node begins on the link that its load stands on
        if b < 0:
            continue
        s = int(setting.loads.strand[k])
        i, j = int(strands.first[s]), int(strands.first[s] + strands.links[s])
        home = np.arange(j - i + 1) * strands.h[s]
        for values, stored in ((state.r, position), (state.w, velocity)):
            values[:, b] = [np.interp(state.X[b], home, component) for component in stored[:, i : j + 1]]
