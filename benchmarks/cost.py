"""Cost per node and step from 50 to a million links, and of two joined ropes beside one."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from copy import deepcopy
from statistics import median

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics.chain import ChainBuffers
from ropewalk.mechanics.compiled import entry_of
from ropewalk.model import Dynamic, Line, MovingForce, Scenario, Travel
from ropewalk.results.frame import RunInfo
from ropewalk.solve.choice import RKN6_LIMIT, bounds, verlet_step
from ropewalk.solve.composition import RKN6, VERLET
from ropewalk.solve.start import setting_of, start_state
from ropewalk.solve.stops import Stops, advance
from ropewalk.system.dynamics.intervals import Intervals
from ropewalk.system.dynamics.intervals import advance as along_intervals
from ropewalk.system.dynamics.moving import SystemMotion

from .bare import bare_loop

Array = NDArray[np.float64]
LINKS = (50, 200, 800, 3200, 12_800, 100_000, 1_000_000)
WORK = 4e6  # node steps per measurement


def rope(elements: int, damping: float) -> Scenario:
    """A taut rope under a travelling force."""
    return Scenario(
        lines={
            "rope": Line(
                start=(0, 0), end=(20.2, 0), length=20.0, mass=1.0, axial_stiffness=1e5, axial_damping=damping,
                elements=elements,
            )
        },
        loads={
            "force": MovingForce(
                on="rope", force=(0.0, -300.0), travel=Travel.model_validate({"speed": 10.0, "from": 5.0})
            )
        },
        run=Dynamic(until=1.0),
    )  # fmt: skip


def rope_steps(elements: int, method: str, damping: float) -> Callable[[], float]:
    """What times some steps of one rope: CPU s of each (of Verlet; of RKN6 they are eleven force evaluations)."""
    setting = setting_of(rope(elements, damping), 1.0)
    state = start_state(setting, with_loads=False)
    limits = bounds(setting.strands, state.r, state.X, with_moving_loads=True)
    kicks, drifts = RKN6 if method == "rkn6" else VERLET
    step = RKN6_LIMIT / limits.frequency if method == "rkn6" else verlet_step(limits)
    count = max(min(int(WORK / elements / drifts.size), int(1.4 / step)), 20)

    def timed() -> float:
        now, buffers = state.copy(), ChainBuffers.for_state(state)
        start = clock.process_time()
        stops = Stops.to(count * step)
        _, steps = advance(setting.strands, setting.loads, now, buffers, kicks, drifts, stops, step, 10**9)
        return (clock.process_time() - start) / steps

    return timed


def nanoseconds(elements: int, method: str, damping: float) -> float:
    """Median CPU time per node and step (one force evaluation for Verlet, eleven for RKN6) in ns."""
    timed = rope_steps(elements, method, damping)
    return 1e9 * median([timed() for _ in range(8)][1:]) / elements


def bare(elements: int, *, damped: bool = False) -> float:
    """The same of a loop in C over links in the plane and nothing else (`bare.py`), without a load; ns."""
    count = max(int(WORK / elements), 20)
    repeat = bare_loop(elements, count, damped=damped)
    return 1e9 * median([repeat() for _ in range(8)][1:]) / count / elements


def scaling() -> None:
    """Print the cost over the number of links; it should stay flat until the arrays leave the caches."""
    print("\nCost per node and step, ns (RKN6: per node and force evaluation); a bare loop has no load and no account")
    print(f"{'links':>8}{'bare':>10}{'verlet':>10}{'rkn6':>10}{'bare':>10}{'damped':>10}")
    for elements in LINKS:
        row = [
            bare(elements),
            nanoseconds(elements, "verlet", 0.0),
            nanoseconds(elements, "rkn6", 0.0) / 11,
            bare(elements, damped=True),
            nanoseconds(elements, "verlet", 50.0),
        ]
        print(f"{elements:8}" + "".join(f"{value:10.2f}" for value in row), flush=True)


def joined_ropes(load: dict[str, object], elements: int) -> Scenario:
    """The same rope in two halves, joined in its middle."""
    half = {"length": 10.0, "mass": 1.0, "axial_stiffness": 1e5, "elements": elements // 2}
    joint = {"kind": "joined", "to": "knot"}
    return Scenario.model_validate({
        "lines": {
            "one": {**half, "start": (0, 0), "end": (10.1, 0), "end_support": joint},
            "two": {**half, "start": (10.1, 0), "end": (20.2, 0), "start_support": joint},
        },
        "joints": {"knot": {}},
        "loads": {"load": {**load, "on": "one", "travel": {"speed": 10.0, "from": 3.0}}},
        "run": {"kind": "dynamic", "until": 0.5},
    })  # fmt: skip


def joined_steps(load: dict[str, object], elements: int) -> Callable[[], float]:
    """What times some steps of two joined ropes: CPU s of each."""
    moving = SystemMotion(joined_ropes(load, elements), RunInfo(), np.linspace(0.0, 0.5, 3))
    system, step = moving._system(), moving.run_info.step
    count = max(min(int(WORK / 10 / elements), int(0.5 / step)), 20)  # while the load is on its line
    nowhere = Intervals.nowhere(system.bodies)
    begin, arguments = deepcopy(system.changing()), (*system.arguments, step, count, nowhere)
    go = entry_of(along_intervals, arguments)

    def timed() -> float:
        system.put(begin)
        start = clock.process_time()
        go(*arguments)
        return (clock.process_time() - start) / count

    return timed


def joined() -> None:
    """Print what a node of two joined ropes costs in a step beside one of a single rope, timed in turns."""
    loads: dict[str, dict[str, object]] = {
        "force": {"kind": "force", "force": (0.0, -300.0)},
        "mass": {"kind": "mass", "mass": 30.0},
        "oscillator": {"kind": "oscillator", "mass": 30.0, "stiffness": 2e4, "damping": 100.0},
    }
    print("\nOne rope under a force and two joined ropes, ns per node and step, in turns; in brackets over one rope")
    print(f"{'links':>8}{'one rope':>10}" + "".join(f"{name:>17}" for name in loads))
    for elements in LINKS[:4]:
        timed = [rope_steps(elements, "verlet", 0.0), *(joined_steps(load, elements) for load in loads.values())]
        times = np.array([[one() for one in timed] for _ in range(30)][1:]) * 1e9 / elements
        one, *others = np.median(times, axis=0)
        ratios = np.median(times[:, 1:] / times[:, :1], axis=0)
        row = "".join(f"{value:10.2f} ({ratio:.1f})" for value, ratio in zip(others, ratios, strict=True))
        print(f"{elements:8}{one:10.2f}  {row}", flush=True)


def main() -> None:
    """Print scaling and joined ropes."""
    scaling()
    joined()
