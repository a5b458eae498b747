"""Cold and warm starts: commands of their own, cold ones with an empty folder of their own for kernels.

CPU seconds are those of a command and of all processes that it begins; on the clock, what somebody waits for.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time as clock
from pathlib import Path
from statistics import median

EXAMPLES = Path(__file__).parents[1] / "examples"
JOINED = """
joints: {knot: {}}
lines:
  left: {start: [0, 0], end: [50, 0], end_support: {kind: joined, to: knot}, tension: 20 kN, mass: 1,
    axial_stiffness: 2 MN, elements: 50}
  right: {start: [50, 0], end: [100, 0], start_support: {kind: joined, to: knot}, tension: 20 kN, mass: 1,
    axial_stiffness: 2 MN, elements: 50}
loads: {one: {kind: mass, mass: 50, on: left, travel: {speed: 10, from: 10 m}}}
run: {kind: dynamic, until: 0.1 s, every: 20 ms}
"""
RUNS: dict[str, tuple[str, tuple[str, ...]]] = {
    "first example": ((EXAMPLES / "moving-force.yaml").read_text(encoding="utf-8"), ()),
    "a mass on joined ropes": (JOINED, ()),
    "a net": ((EXAMPLES / "trampoline-net.yaml").read_text(encoding="utf-8"), ("run.until=0.1 s", "run.every=20 ms")),
}
"""Scenarios, and how they are shortened, by name."""
ROUNDS = 5
"""Of what is warm; what is cold is done once."""


def spent(words: list[str], kernels: Path) -> tuple[float, float]:
    """CPU seconds of a command and its processes, and seconds on the clock, with the kernels in a folder."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(kernels)}
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), clock.monotonic()
    subprocess.run(
        [sys.executable, "-m", "ropewalk", *words], env=environment, cwd=kernels, check=True, capture_output=True
    )
    wall, after = clock.monotonic() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall


def often(words: list[str], kernels: Path) -> list[float]:
    """Medians of the same."""
    return [median(each) for each in zip(*(spent(words, kernels) for _ in range(ROUNDS)), strict=True)]


def runs() -> None:
    """Print what runs take without kernels, and with those that they have left behind."""
    print(f"s of CPU and on the clock       cold            warm, medians of {ROUNDS}")
    for name, (text, settings) in RUNS.items():
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "one.yaml").write_text(text, encoding="utf-8")
            words = ["run", "one.yaml", *(word for one in settings for word in ("--set", one))]
            cold, warm = spent(words, Path(folder)), often(words, Path(folder))
        print(f"  {name:24}{cold[0]:8.1f}{cold[1]:8.1f}    {warm[0]:8.2f}{warm[1]:8.2f}", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        warm = often(["--help"], Path(folder))
    print(f"  {'--help':24}{'-':>8}{'-':>8}    {warm[0]:8.2f}{warm[1]:8.2f}", flush=True)


def ahead() -> None:
    """Print what it takes to compile what most runs need, in one process and side by side."""
    print("\nropewalk warm-up, s of CPU and on the clock")
    for workers in sorted({1, 2, os.cpu_count() or 1}):
        with tempfile.TemporaryDirectory() as folder:
            cpu, wall = spent(["warm-up", "--workers", str(workers)], Path(folder))
        print(f"  {workers:2} {'process' if workers == 1 else 'processes':21}{cpu:8.1f}{wall:8.1f}", flush=True)


def main() -> None:
    """Print all tables."""
    runs()
    ahead()
