"""What long runs, large lines and large results take, each in a process of its own; and what checkpoints cost."""

from __future__ import annotations

import json
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

EXAMPLES = Path(__file__).parent.parent / "examples"
STRING = """
title: Long
gravity: 0
lines:
  string: {start: [0, 0], end: [10, 0], tension: 1 kN, mass: 0.1, axial_stiffness: 100 kN, elements: %d}
%s
run: {kind: dynamic, until: %r, every: %r, step: %r%s}
"""
FORCE = "loads: {one: {kind: force, on: string, force: [0, -10], travel: {speed: 10}}}"
WITH_CHECKPOINTS = ("moving-force", "mass-approaching-support", "highline-walker", "suspension-footbridge")
LIMIT = 1_200_000_000  # bytes of address space beyond what the program has taken before it begins


def main() -> None:
    """Print all tables."""
    print("\nLong, large, and larger than memory (peak memory of the whole process; 0.25 GB of it are the program)")
    for name, what in (("2e7 undamped steps", long), ("1e6 links", large), ("a result larger than memory", larger)):
        found = _apart(what)
        peak, seconds = found.pop("peak"), found.pop("seconds")
        print(f"{name:30s} {peak:6.2f} GB {seconds:8.1f} s CPU   {', '.join(f'{k} {v}' for k, v in found.items())}")
    print("\nCPU time of checkpoints, as a part of that of the run (median of 5 runs)")
    for example in WITH_CHECKPOINTS:
        print(
            f"{example:30s} {100.0 * statistics.median(_apart(checkpoints, example)['share'] for _ in range(5)):8.3f} %"
        )


def long(folder: Path) -> dict[str, Any]:
    """A string that swings freely in its third mode, far beyond the small: its energy must stay."""
    from ropewalk import load, simulate

    steps, step = 20_000_000, 2e-4
    start = ", start: {kind: mode, number: 3, amplitude: 0.2 m}"
    file = folder / "long.yaml"
    file.write_text(STRING % (20, "", steps * step, steps * step / 200, step, start), encoding="utf-8")
    result = simulate(load(file))
    stored = result["energy"].sel(form=["kinetic", "elastic"]).sum("form").values
    drift = float(abs(stored - stored[0]).max() / result["energy"].sel(form="kinetic").values.max())
    return {
        "steps": result.attrs["steps"],
        "outcome": result.attrs["outcome"],
        "largest change of energy": f"{drift:.1e}",
    }


def large(folder: Path) -> dict[str, Any]:
    """A force on a string of a million links, for some steps."""
    from ropewalk import load, simulate

    file, step = folder / "large.yaml", 5e-9
    file.write_text(STRING % (1_000_000, FORCE, 50 * step, 25 * step, step, ""), encoding="utf-8")
    result = simulate(load(file), file=folder / "large.nc")
    return {"steps": result.attrs["steps"], "outcome": result.attrs["outcome"]}


def larger(folder: Path) -> dict[str, Any]:
    """A result that the process could not hold, written and summed up."""
    from ropewalk import load, simulate, summary

    file, step, frames = folder / "larger.yaml", 5e-8, 400
    file.write_text(STRING % (100_000, FORCE, frames * step, step, step, ""), encoding="utf-8")
    simulate(load(EXAMPLES / "moving-force.yaml", ["run.until=0.01 s"]))  # all that is imported and compiled
    now = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (now + LIMIT, now + LIMIT))
    result = simulate(load(file), file=folder / "larger.nc")
    size = (folder / "larger.nc").stat().st_size
    return {"result": f"{size / 1e9:.2f} GB", "allowed": f"{LIMIT / 1e9:.1f} GB", "outcome": summary(result)["outcome"]}


def checkpoints(folder: Path, example: str) -> dict[str, Any]:
    """The share of a run that its checkpoints take."""
    from ropewalk import load, simulate
    from ropewalk.results.slots import Slots

    taken, write = [0.0], Slots.write

    def timed(self: Slots, file: Any) -> None:
        begin = time.process_time()
        write(self, file)
        taken[0] += time.process_time() - begin

    Slots.write = timed  # type: ignore[method-assign]
    scenario = load(EXAMPLES / f"{example}.yaml")
    begin = time.process_time()
    simulate(scenario, file=folder / "one.nc")
    return {"share": taken[0] / (time.process_time() - begin)}


def _apart(what: Callable[..., dict[str, Any]], *words: str) -> dict[str, Any]:
    command = [sys.executable, "-m", "benchmarks.endurance", what.__name__, *words]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=Path(__file__).parent.parent)
    if done.returncode:
        raise RuntimeError(done.stderr)
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found


def _alone(name: str, words: list[str]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        begin = time.process_time()
        found = {"long": long, "large": large, "larger": larger, "checkpoints": checkpoints}[name](Path(folder), *words)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9
    print(json.dumps({**found, "peak": peak, "seconds": time.process_time() - begin}))


if __name__ == "__main__":
    _alone(sys.argv[1], sys.argv[2:])
