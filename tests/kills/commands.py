"""The commands that are killed, and what is left of them."""

from __future__ import annotations

import hashlib
import json
import math
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ropewalk.results import open_result

ROPE = """
title: Killed
lines:
  rope: {start: [0, 0], end: [100, 0], tension: 20 kN, mass: 1, axial_stiffness: 2 MN, elements: 100}
loads:
  one: LOAD
run: {kind: dynamic, until: 4 s, every: 20 ms}
"""
JOINED = """
title: Killed
joints: {knot: {}}
lines:
  left: {start: [0, 0], end_support: {kind: joined, to: knot}, end: [50, 0], tension: 20 kN, mass: 1,
    axial_stiffness: 2 MN, elements: 50}
  right: {start: [50, 0], start_support: {kind: joined, to: knot}, end: [100, 0], tension: 20 kN, mass: 1,
    axial_stiffness: 2 MN, elements: 50}
loads:
  one: {kind: mass, mass: 50, on: left, travel: {speed: 10, from: 10 m, at_end: stay}}
run: {kind: dynamic, until: 4 s, every: 20 ms}
"""
EXAMPLES = Path(__file__).parents[2] / "examples"
SCENARIOS = {
    "chain": ROPE.replace("LOAD", "{kind: force, on: rope, force: [0, -500], travel: {speed: 15, from: 10 m}}"),
    "bodies": ROPE.replace(
        "LOAD", "{kind: oscillator, on: rope, mass: 50, stiffness: 40 kN/m, travel: {speed: 15, from: 10 m}}"
    ),
    "network": JOINED,
    "overhead line": (EXAMPLES / "en50318-2002-250.yaml").read_text(encoding="utf-8"),
    "adequacy": ROPE.replace("LOAD", "{kind: force, on: rope, force: [0, -500], travel: {speed: 15, from: 10 m}}"),
    "sweep": ROPE.replace("LOAD", "{kind: force, on: rope, force: [0, -500], travel: {speed: 15, from: 10 m}}"),
}
SETTINGS = {"overhead line": ["--set", "run.until=2 s", "--set", "run.every=20 ms"]}
MAP = ["--x", "loads.one.travel.speed=5:20:3", "--y", "lines.rope.mass=1:2:2", "--set", "run.until=0.5 s"]
SWEEP = ["--over", "loads.one.travel.speed=5:20:2", "--over", "lines.rope.mass=1,2", "--set", "run.until=0.5 s",
         "--record", "max tension, largest_sag, turnover", "-o", "one.csv"]  # fmt: skip
STORES = {"adequacy": "one.adequacy.jsonl", "sweep": "one.sweep.jsonl"}


@dataclass(frozen=True)
class Command:
    """One of the commands, in a folder of its own.

    Args:
        name: of the scenario.
        folder: where it writes.
    """

    name: str
    folder: Path

    def __post_init__(self) -> None:
        self.folder.mkdir(parents=True, exist_ok=True)
        (self.folder / "one.yaml").write_text(SCENARIOS[self.name], encoding="utf-8")

    @property
    def result(self) -> Path:
        """What it writes."""
        return self.folder / STORES.get(self.name, "one.nc")

    def start(self, *, resume: bool = False) -> subprocess.Popen[str]:
        """Begin it, or take it up again."""
        if self.name == "adequacy":
            words = ["adequacy", "one.yaml", *MAP, "--workers", "2", "--json"]
        elif self.name == "sweep":
            words = ["sweep", "one.yaml", *SWEEP, "--workers", "2", "--quiet"]
        elif resume:
            words = ["resume", "one.nc"]
        else:
            words = ["run", "one.yaml", *SETTINGS.get(self.name, [])]
        command = [sys.executable, "-m", "ropewalk", *words]
        pipe = subprocess.PIPE
        return subprocess.Popen(
            command, stdout=pipe, stderr=pipe, text=True, cwd=self.folder, start_new_session=True, env=os.environ
        )

    def whole(self, *, resume: bool = False) -> None:
        """Let it come to its end."""
        with self.start(resume=resume) as process:
            _, message = process.communicate()
        if process.returncode:
            raise AssertionError(f"{self.name}: {message}")

    def killed(self, after: float, kept: float = math.inf) -> bool:
        """Kill it after some seconds, or when it has kept so many points; whether it was still running."""
        end = time.monotonic() + after
        with self.start() as process:
            while (
                process.poll() is None
                and time.monotonic() < end
                and not (self.name in STORES and self.frames() >= kept)
            ):
                time.sleep(0.01)
            running = process.poll() is None
            process.kill()
            process.communicate()
        return running

    def frames(self) -> int:
        """How much there is of it, all of which is right; 0: nothing.

        Raises:
            ResultError: what is there cannot be read.
        """
        if not self.result.exists():
            return 0
        if self.name in STORES:
            return len(self.result.read_text(encoding="utf-8").splitlines())
        with open_result(self.result) as result:
            return int(result.sizes["time"])

    def may_have_compiled(self) -> bool:
        """Whether kernels may have been compiled, which stores do not tell."""
        if self.name in STORES:
            return True
        with open_result(self.result) as result:
            return bool(result.attrs["compile_seconds"] > 0.0)

    def content(self, frames: int | None = None) -> str:
        """Hash of all numbers of the first frames."""
        if self.name in STORES:
            lines = self.result.read_text(encoding="utf-8").splitlines()
            points = [json.loads(line) for line in lines]
            for point in points:
                point.pop("seconds", None)
            table = self.folder / "one.csv"
            cases = [row.rpartition(",")[0] for row in table.read_text("utf-8").splitlines()] if table.exists() else []
            return hashlib.sha256(json.dumps([*sorted(map(str, points)), *cases]).encode()).hexdigest()
        found = hashlib.sha256()
        with open_result(self.result) as result:
            for name in sorted(map(str, result.variables)):
                values = result[name].isel(time=slice(frames)) if "time" in result[name].dims else result[name]
                if values.dtype.kind == "f" and name != "checkpoint":
                    found.update(np.ascontiguousarray(values.values).tobytes())
        return found.hexdigest()


def trial(name: str, folder: Path, after: float, whole: Command, kept: float = math.inf) -> str:
    """Kill a command, look at what it leaves, and take it up again; what was wrong, empty if nothing."""
    one = Command(name, folder)
    if not one.killed(after, kept):
        return "" if one.content() == whole.content() else "differs, though it was not killed"
    frames = one.frames()
    if frames and name not in STORES and one.content(frames) != whole.content(frames):
        return f"{frames} frames differ"
    with one.start(resume=bool(frames)) as process:
        _, message = process.communicate()
    if process.returncode and "no checkpoint" not in message and "is complete" not in message:
        return f"not taken up again after {frames} frames: {message}"
    if process.returncode and "no checkpoint" in message:
        one.whole()
    return "" if one.content() == whole.content() else f"differs when it is taken up again after {frames} frames"


def lasting(name: str, folder: Path) -> tuple[Command, float]:
    """A command that has come to its end, and how many seconds that takes with kernels from the cache."""
    whole = Command(name, folder)
    begin = time.monotonic()
    whole.whole()
    if whole.may_have_compiled():
        whole.result.unlink()
        begin = time.monotonic()
        whole.whole()
    return whole, time.monotonic() - begin
