"""One motion with its states and its CPU seconds, riding on a node or sharing the force between two nodes."""

from __future__ import annotations

import time as clock
from dataclasses import dataclass

import numpy as np

from ropewalk.mechanics.chain import SHARED, SHARING, ChainState
from ropewalk.model import Scenario
from ropewalk.solve.choice import choose
from ropewalk.solve.motion import Progress, move
from ropewalk.solve.start import PreparedRun, setting_of, start_state

Array = np.ndarray


@dataclass(frozen=True)
class March:
    """States at the times asked for, CPU seconds of the motion alone, and how it ended."""

    setting: PreparedRun
    states: list[ChainState]
    seconds: float
    status: int


def march(scenario: Scenario, times: Array, sharing: bool) -> March:
    """Move a scenario from rest without loads to each of the times, which are later than 0."""
    setting = setting_of(scenario, scenario.run.until)
    strands, loads = setting.strands, setting.loads
    state, run, progress = start_state(setting, with_loads=False), scenario.run, Progress()
    if sharing:
        loads = loads._replace(contact=np.full_like(loads.contact, SHARING))
        for k, b in enumerate(state.moving_load):  # the seat taken at the start is given back
            if b >= 0:
                s = loads.strand[k]
                state.X[b] = (b - strands.first[s]) * strands.h[s]
                state.r[:, b] = 0.5 * (state.r[:, b - 1] + state.r[:, b + 1])
                state.moving_load[k] = SHARED
    begin = clock.process_time()
    choice = choose(
        strands, loads, state, method=run.method, step=run.step, accuracy=run.accuracy, duration=float(times[-1])
    )
    states = [now.copy() for now in move(strands, loads, state, choice, run.precision, times, progress)]
    return March(setting, states, clock.process_time() - begin, progress.status)
