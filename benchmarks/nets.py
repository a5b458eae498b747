"""Nets: a mass that crosses the same net, computed with more and more nodes; CPU time and memory on one core."""

from __future__ import annotations

import resource
import subprocess
import sys
import time as clock

import numpy as np

from ropewalk.model import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.results.running import TimeHistory
from ropewalk.system.dynamics.moving import SystemMotion

SIDES, MESH = (4.0, 3.0), 0.05  # m; of the net, and between its threads
UNTIL, EVERY = 2.0, 0.02  # s
SIZES = ((10, 2.0), (20, 2.0), (50, 2.0), (100, 2.0), (200, 0.1))  # nodes each way, and how much of the 2 s is computed


def crossing(nodes: int, until: float) -> Scenario:
    """A net of 4 m x 3 m with threads every 5 cm, in so many nodes each way, under 60 kg at 1 m/s."""
    a, b = SIDES
    net = {
        "kind": "net", "corner": [0.0, 0.0, 0.0], "sides": [[a, 0.0, 0.0], [0.0, b, 0.0]],
        "cells": [nodes - 1, nodes - 1], "mesh": MESH, "axial_stiffness": 1e4, "mass": 0.05, "tension": 100.0,
    }  # fmt: skip
    mass = {"kind": "mass", "on": "net", "mass": 60.0,
            "travel": {"speed": 1.0, "path": [[0.9, 1.37], [3.1, 1.61]], "from": 0.0}}  # fmt: skip
    run = {"kind": "dynamic", "until": until, "every": EVERY}
    return Scenario.model_validate({"nets": {"net": net}, "loads": {"mass": mass}, "run": run})


def go(nodes: int, until: float) -> tuple[float, float, int, str]:
    """CPU seconds until the first frame, and of the motion with its frames; steps and how it ended."""
    run_info, scenario = RunInfo(), crossing(nodes, until)
    begin = clock.process_time()
    times = np.linspace(0.0, until, round(until / EVERY) + 1)
    moving = TimeHistory(SystemMotion(scenario, run_info, times), run_info).frames()
    next(moving)
    start = clock.process_time()
    for _ in moving:
        pass
    return start - begin, clock.process_time() - start, run_info.steps, run_info.outcome


def alone(nodes: int, until: float) -> None:
    """Print a row of the table, in a process of its own, for its peak of memory."""
    go(5, 0.02)  # kernels are compiled, or come from the cache
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    setup, motion, steps, outcome = go(nodes, until)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    each, whole = 1e9 * motion / steps / nodes**2, motion * UNTIL / until
    size, note = f"{nodes} x {nodes}", "" if outcome == "running" else outcome  # nobody but a failure ends it here
    print(f"{size:10s} {steps:8d} {until:6.2f} s {setup:8.2f} s {motion:8.2f} s {whole:9.1f} s {each:8.1f} ns "
          f"{before:6.0f} -> {peak:5.0f} MB  {note}", flush=True)  # fmt: skip


def main() -> None:
    """Print the table."""
    print("60 kg at 1 m/s on a net of 4 m x 3 m, threads every 5 cm, 100 N, EA 10 kN, undamped; CPU time on one core\n")
    print("nodes         steps  computed  set-up   motion     2 s      node, step   memory", flush=True)
    for nodes, until in SIZES:
        subprocess.run([sys.executable, "-m", "benchmarks.nets", str(nodes), str(until)], check=True)


if __name__ == "__main__":
    if len(sys.argv) == 3:
        alone(int(sys.argv[1]), float(sys.argv[2]))
    else:
        main()
