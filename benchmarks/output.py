"""What an instant of output costs next to the motion, and large results."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
import time as clock
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

from ropewalk.model import Scenario
from ropewalk.simulate import simulate

from .cost import joined_ropes, rope
from .nets import crossing

EVERY = 1e-3  # s
ROUNDS = 5
HALF_CAR = {
    "kind": "vehicle", "on": "bridge", "travel": {"speed": 10.0, "from": 2.0, "at_end": "leave"},
    "bodies": {"box": {"mass": 16e3, "inertia": 6e4}},
    "wheels": {"front": {"at": 1.5, "mass": 1e3}, "rear": {"at": -1.5, "mass": 1e3}},
    "springs": {
        name: {"between": ["box", name], "stiffness": 4e5, "damping": 1e4, "at": at}
        for name, at in (("front", 1.5), ("rear", -1.5))
    },
}  # fmt: skip
LARGE = """
gravity: 0
lines: {string: {start: [0, 0], end: [10, 0], tension: 1 kN, mass: 0.1, axial_stiffness: 100 kN, elements: 1000000}}
loads: {one: {kind: force, on: string, force: [0, -10], travel: {speed: 10}}}
run: {kind: dynamic, until: %r, every: 5 ns, step: 5 ns}
"""


def bridge() -> Scenario:
    """A bridge of 25 m under a half-car, in small motion."""
    line = {
        "start": (0, 0), "end": (25, 0), "length": 25.0, "mass": 4800.0, "bending_stiffness": 3.3e9,
        "axial_stiffness": 1e10, "elements": 48,
    }  # fmt: skip
    run = {"kind": "dynamic", "geometry": "linearised", "until": 2.4, "every": EVERY}
    return Scenario.model_validate({"lines": {"bridge": line}, "loads": {"car": HALF_CAR}, "run": run})


def _often(scenario: Scenario, until: float) -> Scenario:
    return scenario.model_copy(
        update={"run": scenario.run.model_copy(update={"until": until, "every": EVERY})}
    )  # fmt: skip


CASES: dict[str, Callable[[], Scenario]] = {
    "bridge, half-car": bridge,
    "rope, force": lambda: _often(rope(200, 0.0), 1.0),
    "joined ropes, mass": lambda: _often(joined_ropes({"kind": "mass", "mass": 30.0}, 200), 0.5),
    "net of 20 x 20": lambda: _often(crossing(20, 0.5), 0.5),
}


def instants() -> None:
    """Print what an output instant costs: a run with all of them less one with four, over their number."""
    print(f"\nCPU time of an output instant, every {1e3 * EVERY:g} ms, and of whole runs; medians of {ROUNDS}")
    for name, make in CASES.items():
        often = make()
        seldom = often.model_copy(update={"run": often.run.model_copy(update={"every": often.run.until / 4})})
        simulate(often), simulate(seldom)
        each, whole = [], []
        for _ in range(ROUNDS):
            (long, many), (short, few) = _timed(often), _timed(seldom)
            each.append((long - short) / (many - few))
            whole.append(long)
        print(f"  {name:20} {1e3 * median(each):7.4f} ms {median(whole):7.3f} s of {many} instants", flush=True)


def _timed(scenario: Scenario) -> tuple[float, int]:
    begin = clock.process_time()
    count = simulate(scenario).sizes["time"]
    return clock.process_time() - begin, count


def large(frames: int) -> dict[str, Any]:
    """Peak memory in GB and seconds of a string of a million links with some frames, written to a file."""
    from ropewalk.scenario import loads

    with tempfile.TemporaryDirectory() as folder:
        file, begin = Path(folder) / "large.nc", clock.process_time()
        found = simulate(loads(LARGE % (5e-9 * (frames - 1)), "large.yaml"), file=file)
        count, size = found.sizes["time"], file.stat().st_size / 1e9
        found.close()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9
    return {"frames": count, "file": size, "peak": peak, "seconds": clock.process_time() - begin}


def memory() -> None:
    """Print what results of a million links take: it must not grow with their frames."""
    print("\nA million links, written to a file")
    for frames in (3, 30, 100):
        command = [sys.executable, "-m", "benchmarks.output", str(frames)]
        found = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
        print("  {frames:5} frames {file:7.2f} GB {peak:6.2f} GB peak {seconds:7.1f} s CPU".format(**found), flush=True)


def main() -> None:
    """Print all tables."""
    instants()
    memory()


if __name__ == "__main__":
    print(json.dumps(large(int(sys.argv[1]))))
