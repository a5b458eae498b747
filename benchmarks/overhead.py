"""Overhead lines against real time: the EN 50318:2002 reference model at 300 km/h, on one core."""

from __future__ import annotations

import re
import subprocess
import sys
import time as clock
from collections.abc import Callable
from pathlib import Path
from statistics import median

import numpy as np
from numba import njit
from numpy.typing import NDArray
from tests import hermite

from ropewalk.model import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.results.running import TimeHistory
from ropewalk.scenario import load
from ropewalk.wires.frames import Wires
from ropewalk.wires.prescribed_motion import inputs_of
from ropewalk.wiring import task_of

EXAMPLE = Path(__file__).parents[1] / "examples" / "en50318-2002-300.yaml"
Array = NDArray[np.float64]
SPEED, TURNS = 300.0 / 3.6, 5


def reference(spans: int = 10, element: float = 0.25, **run: object) -> Scenario:
    """The example with other numbers."""
    scenario = load(EXAMPLE)
    line = scenario.overhead_lines["line"]
    line = line.model_copy(update={"spans": (60.0,) * spans, "element": element, "analysed_spans": None})
    until = (60.0 * spans - 20.0) / SPEED
    asked = scenario.run.model_copy(update={"until": until, "every": 0.05, **run})
    return scenario.model_copy(update={"overhead_lines": {"line": line}, "run": asked})


def motion_alone(scenario: Scenario, seconds: float = 2.0) -> tuple[float, float]:
    """CPU seconds for a second of motion, without set-up and output, the median of some turns; and the step in ms."""
    run_info, times = RunInfo(), np.arange(0.0, scenario.run.until, 0.05)
    run = Wires(task_of(scenario), times, run_info)
    rows = int(seconds / run.sample / TURNS)
    found, t = [], 0.0
    for turn in range(TURNS + 1):
        drive = inputs_of(run.task.plan, run.task.prescribed_motions, t + run.sample * np.arange(rows + 1.0))
        begin = clock.process_time()
        run.motion.go(drive, run.steps)
        if turn:  # the first one may have to compile
            found.append((clock.process_time() - begin) / (rows * run.sample))
        t += rows * run.sample
    return median(found), 1e3 * run_info.step


def everything(scenario: Scenario) -> float:
    """CPU seconds of a whole run, form finding, frames and all, for a second of motion."""
    begin = clock.process_time()
    run_info = RunInfo()
    times = np.arange(0.0, scenario.run.until, 0.05)
    for _ in TimeHistory(Wires(task_of(scenario), times, run_info), run_info).frames():
        pass
    return (clock.process_time() - begin) / float(times[-1])


def by_hermite(element: float = 0.5, step: float = 1e-3, seconds: float = 2.0) -> float:
    """The same of the implicit reference."""
    run = Wires(task_of(reference(element=element)), np.array([0.0, 0.05]), RunInfo())
    model = hermite.rest_of(run.task.plan, element)
    moving_loads = [prescribed_motion.moving_load for prescribed_motion in run.task.prescribed_motions]
    rows = int(seconds / step)
    drive = inputs_of(run.task.plan, run.task.prescribed_motions, step * np.arange(rows + 0.0))
    own = hermite.StepInputs(station=drive.station, rough=drive.rough, given=drive.given, push=drive.push)
    hermite.run(model, moving_loads, own, step)
    found = []
    for _ in range(TURNS):
        begin = clock.process_time()
        hermite.run(model, moving_loads, own, step)
        found.append((clock.process_time() - begin) / seconds)
    return median(found)


@njit(error_model="numpy", fastmath={"contract", "nsz"}, _nrt=False)
def _stencil(u: Array, v: Array) -> None:
    for i in range(u.size - 4):
        bent = 1e-3 * (u[i + 1] + u[i + 3]) - 1e-4 * (u[i] + u[i + 4]) - 1.8e-3 * u[i + 2]
        v[i + 2] = u[i + 2] + (u[i + 2] - v[i + 2]) + bent


@njit(error_model="numpy", fastmath={"contract", "nsz"}, _nrt=False)
def _stencils(steps: int, u: Array, v: Array, other: Array, last: Array) -> None:
    for _ in range(steps // 2):
        _stencil(u, v)
        _stencil(other, last)
        _stencil(v, u)
        _stencil(last, other)


def bare_stencil(element: float, step: float = 1e-3) -> float:
    """CPU seconds for a second of the stencil of one wire after the other and nothing else: what no code can beat."""
    nodes, steps, found = round(600.0 / element) + 1, 2000, []
    for _ in range(TURNS):
        wires = [1e-3 * np.sin(np.arange(nodes)) for _ in range(4)]
        _stencils(2, *wires)
        begin = clock.process_time()
        _stencils(steps, *wires)
        found.append((clock.process_time() - begin) / (steps * step))
    return median(found)


def _line(name: str, seconds: float, more: str = "") -> None:
    print(f"{name:58s} {1.0 / seconds:8.0f} times real time  {more}", flush=True)


def _try(name: str, what: Callable[[], tuple[float, float]]) -> None:
    seconds, step = what()
    _line(name, seconds, f"step {step:.3g} ms")


def peak(spans: int) -> tuple[float, float]:
    """Largest memory in GB, and CPU seconds, of a process that computes two seconds of a long line, output and all."""
    ran = subprocess.run([sys.executable, "-m", "benchmarks.overhead", str(spans)], capture_output=True, text=True)
    memory, seconds = ran.stdout.split()
    return float(memory), float(seconds)


def main(whole: bool = False) -> None:
    """Print the table.

    Args:
        whole: with a line of 10 000 spans, which takes minutes and some GB.
    """
    print("Overhead line and pantograph, EN 50318:2002 at 300 km/h; CPU time of the motion alone\n")
    for element in (0.5, 0.25):
        _line(f"for comparison: the bare stencil of 2 wires, {element} m", bare_stencil(element), "step 1 ms")
    for element in (0.5, 0.25):
        _try(f"linearised, 10 spans, {element} m",
             lambda e=element: motion_alone(reference(element=e, geometry="linearised")))  # fmt: skip
    for spans in (10, 20, 40, 200, 1000):
        _try(f"linearised, {spans} spans, 0.25 m, window of 180 m",
             lambda n=spans: motion_alone(reference(n, geometry="linearised", window=180.0)))  # fmt: skip
    for spans, element in ((10, 0.5), (20, 0.5), (40, 0.5), (10, 0.25)):
        _try(f"nonlinear, {spans} spans, {element} m",
             lambda n=spans, e=element: motion_alone(reference(n, e, geometry="nonlinear"), 0.5))  # fmt: skip
    for spans in (10, 20, 40, 200, 1000):
        _try(f"nonlinear, {spans} spans, 0.5 m, window of 180 m",
             lambda n=spans: motion_alone(reference(n, 0.5, geometry="nonlinear", window=180.0)))  # fmt: skip
    _try("nonlinear, 10 spans, 0.25 m, axial inertia x 4",
         lambda: motion_alone(reference(geometry="nonlinear", axial_inertia=4.0), 0.5))  # fmt: skip
    _line("Hermite elements, Newmark, 10 spans, 0.5 m", by_hermite(), "step 1 ms")
    print()
    _line("a whole run, linearised, 10 spans, 0.25 m", everything(reference(geometry="linearised")))
    _line("a whole run, nonlinear, 10 spans, 0.25 m", everything(reference(geometry="nonlinear")))
    print("\nA process that forms a line with links of 0.25 m and moves it linearised for 2 s in a window of 180 m")
    for spans in (10, 200, 1000, *((10_000,) if whole else ())):
        memory, seconds = peak(spans)
        print(f"{spans:6d} spans {memory:8.2f} GB at most, {seconds:6.0f} s of CPU", flush=True)


def _one(spans: int) -> None:
    """What `peak` measures: in a process of its own."""
    run_info, times = RunInfo(), np.arange(0.0, 2.0, 0.05)
    scenario = reference(spans, geometry="linearised", window=180.0, until=2.0)
    for _ in TimeHistory(Wires(task_of(scenario), times, run_info), run_info).frames():
        pass
    print(_largest(), clock.process_time())


def _largest() -> float:
    """Most memory that this process has had, GB; what getrusage tells of a child begins with what its parent had."""
    found = re.search(r"VmHWM:\s+(\d+)", Path("/proc/self/status").read_text(encoding="utf-8"))
    assert found is not None
    return int(found[1]) * 1024 / 1e9


if __name__ == "__main__":
    if len(sys.argv) > 1:
        _one(int(sys.argv[1]))
    else:
        main()
