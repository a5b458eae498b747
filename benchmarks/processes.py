"""CPU time of commands with all processes that they begin, warm and cold, and of fresh processes of either engine."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median

EXAMPLES = Path(__file__).parents[1] / "examples"
NAMES = (
    "moving-force", "mass-approaching-support", "tightrope", "bridge-coaches", "vehicle-on-rough-bridge",
    "suspension-bridge", "trampoline-net", "sheaves", "en50318-2002-300", "zip-line",
)  # fmt: skip
"""Examples of different kinds."""
ROUNDS = 3
CORE_PROCESS = """
import time
import numpy as np
from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import Builder, RunProperties
builder, x = Builder(), np.linspace(0.0, 20.2, 201)
builder.fix(*builder.add_run(np.array([x, 0.0 * x]), RunProperties(0.1, 1.0, 1e5)))
builder.add_force(0, [0.0, -300.0], 5.0, 10.0)
bound = Bound(*builder.build())
begun = time.process_time()
bound.advance(10_000, 1e-4, "avx2")
print(begun, time.process_time())
"""
TODAY_PROCESS = """
import time
import numpy as np
from ropewalk.chains.moving import Chain
from ropewalk.results.frame import RunInfo
from benchmarks.cost import rope
scenario = rope(200, 0.0)
run = scenario.run.model_copy(update={"method": "verlet", "step": 1e-4})
engine = Chain(scenario.model_copy(update={"run": run}), RunInfo(), np.array([0.0, 1.0]))
engine.advance(0)
begun = time.process_time()
engine.advance(1)
print(begun, time.process_time())
"""
"""A rope of 200 links under a force and 10 000 steps, without reading a scenario."""


def spent(words: Sequence[str], folder: Path, kernels: Path | None = None) -> float:
    """Return CPU seconds of a command and its processes.

    Args:
        words: of the command ropewalk.
        folder: in which it is run.
        kernels: folder of compiled kernels, if it is another one.
    """
    environment = {**os.environ, **({} if kernels is None else {"NUMBA_CACHE_DIR": str(kernels)})}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, "-m", "ropewalk", *words]
    subprocess.run(command, env=environment, cwd=folder, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def processes(
    table: Callable[[Sequence[str], Sequence[Sequence[object]]], None], cold: Sequence[str] = (),
    names: Sequence[str] = NAMES, rounds: int = ROUNDS,
) -> None:  # fmt: skip
    """Print CPU seconds of commands.

    Args:
        table: prints one.
        cold: names of examples that are run with an empty folder for kernels, too.
        names: of examples.
        rounds: of which medians are taken.
    """
    rows = list[list[object]]()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        helped = median(spent(["--help"], folder) for _ in range(rounds))
        for example in names:
            file, result = str(EXAMPLES / f"{example}.yaml"), f"{example}.nc"
            commands = (["check", file], ["run", file, "--overwrite", "-o", result], ["show", result])
            cells = [f"{median(spent(words, folder) for _ in range(rounds)):.2f}" for words in commands]
            if example in cold:
                with tempfile.TemporaryDirectory() as kernels:
                    cells.append(f"{spent(commands[1], folder, Path(kernels)):.0f}")
            rows.append([example, *cells, *([""] if example not in cold else [])])
    table([f"CPU, s; `--help` {helped:.2f}", "check", "run", "show", "run, without kernels"], rows)
    fresh = [
        [name, *fresh_process(code, rounds)]
        for name, code in (("core", CORE_PROCESS), ("today, kernels kept", TODAY_PROCESS))
    ]
    table(["fresh process, CPU, s", "before motion", "10 000 steps of 200 links"], fresh)


def fresh_process(code: str, rounds: int) -> list[str]:
    """Return CPU seconds of a process before its motion, and of the motion."""
    runs = [subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
            for _ in range(rounds)]  # fmt: skip
    begun, whole = (median(float(each[k]) for each in runs) for k in (0, 1))
    return [f"{begun:.2f}", f"{whole - begun:.3f}"]
