"""The commands that are killed, and what is left of them."""

from __future__ import annotations

import contextlib
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
from typer.testing import CliRunner

from ropewalk.cli.app import app
from ropewalk.results import ResultError, open_result

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
SETTINGS = {  # so that computing takes a second or two
    "chain": ["--set", "lines.rope.elements=300"], "bodies": ["--set", "lines.rope.elements=200"],
    "network": ["--set", "lines.left.elements=100"],
    "overhead line": ["--set", "run.until=2 s", "--set", "run.every=20 ms"],
}  # fmt: skip
MAP = ["--x", "loads.one.travel.speed=5:20:2", "--y", "lines.rope.mass=1:2:2", "--set", "run.until=0.2 s"]
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

    def words(self, *, resume: bool = False, workers: int = 2) -> list[str]:
        """What is said to `ropewalk`."""
        if self.name == "adequacy":
            return ["adequacy", "one.yaml", *MAP, "--workers", str(workers or 1), "--json"]
        if self.name == "sweep":
            return ["sweep", "one.yaml", *SWEEP, "--workers", str(workers), "--quiet"]
        return ["resume", "one.nc"] if resume else ["run", "one.yaml", *SETTINGS.get(self.name, [])]

    def start(self) -> subprocess.Popen[str]:
        """Begin it."""
        command = [sys.executable, "-m", "ropewalk", *self.words()]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "start_new_session": True}
        return subprocess.Popen(command, text=True, cwd=self.folder, env=os.environ, **quiet)  # type: ignore[call-overload,no-any-return]

    def attempt(self, *, resume: bool = False) -> str:
        """Let it come to its end, or take it up again, in this process, which spares the imports; how it fails."""
        with contextlib.chdir(self.folder):
            found = CliRunner().invoke(app, self.words(resume=resume, workers=0))
        return found.output or repr(found.exception) if found.exit_code else ""

    def whole(self) -> None:
        """Let it come to its end."""
        if message := self.attempt():
            raise AssertionError(f"{self.name}: {message}")

    def killed(self, after: float, kept: float = math.inf) -> bool:
        """Kill it after some seconds, or when it has kept so many frames or points; whether it was still running."""
        end = time.monotonic() + after
        with self.start() as process:
            while process.poll() is None and time.monotonic() < end and not self._has(kept):
                time.sleep(0.01)
            running = process.poll() is None
            process.kill()
        return running

    def _has(self, kept: float) -> bool:
        """Whether so much is there while it is being written."""
        try:
            return math.isfinite(kept) and self.frames() >= kept
        except ResultError:  # not yet
            return False

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
    message = one.attempt(resume=bool(frames))
    if message and "no checkpoint" not in message and "is complete" not in message:
        return f"not taken up again after {frames} frames: {message}"
    if "no checkpoint" in message:
        one.whole()
    return "" if one.content() == whole.content() else f"differs when it is taken up again after {frames} frames"


def lasting(name: str, folder: Path) -> tuple[Command, float]:
    """A command that has come to its end, and how many seconds that takes in a process of its own with kernels kept."""
    whole = Command(name, folder)
    whole.whole()
    whole.result.unlink()
    begin = time.monotonic()
    whole.start().wait()
    return whole, time.monotonic() - begin
