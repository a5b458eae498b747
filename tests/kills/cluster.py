"""Sweeps on a Dask cluster of real processes of which any is killed: a worker, the scheduler, the command."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from random import Random

ROPE = """\
title: Killed
lines: {rope: {start: [0, 0], end: [10, 0], length: 10.5, mass: 1, axial_stiffness: 1e5, elements: 10}}
loads: {man: {kind: force, on: rope, force: [0, -100], travel: {speed: 1, from: 5}}}
run: {kind: equilibrium}
"""
CASES = 240
SWEEP = ["--over", f"loads.man.force.1=-{CASES}:-1:1 N", "--record", "max tension, largest_sag", "-o", "one.csv"]
WORKERS, PATIENCE = 2, 300.0
"""PATIENCE: seconds in which something must go on."""
_WHAT = ("worker", "worker", "worker", "command", "command", "scheduler")
_QUIET = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "start_new_session": True}
_ONE = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")


class Cluster:
    """A scheduler and workers of one thread each, all of which may be killed and begun again."""

    def __init__(self, folder: Path) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.address, self._folder = f"tcp://127.0.0.1:{self.port}", folder
        folder.mkdir(parents=True, exist_ok=True)
        self.workers = list[subprocess.Popen[bytes]]()
        self.begin()

    def begin(self) -> None:
        """A scheduler, and workers that know it."""
        port = ("--host", "127.0.0.1", "--port", str(self.port))
        self.scheduler = self._start("dask_scheduler", *port, "--no-dashboard", "--no-jupyter")
        self.workers = [self._worker() for _ in range(WORKERS)]

    def kill_worker(self, which: int) -> None:
        """Kill one; another takes its place."""
        _end(self.workers.pop(which))
        self.workers.append(self._worker())

    def kill_scheduler(self) -> None:
        """Kill it; its workers go, and all begin again."""
        self.close()
        self.begin()

    def close(self) -> None:
        """End all of it."""
        for process in (self.scheduler, *self.workers):
            _end(process)

    def _worker(self) -> subprocess.Popen[bytes]:
        words = (self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--death-timeout", "60")
        return self._start("dask_worker", *words)

    def _start(self, program: str, *words: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.{program}", *words]
        return subprocess.Popen(command, cwd=self._folder, env=os.environ | _ONE, **_QUIET)  # type: ignore[call-overload,no-any-return]


def _end(process: subprocess.Popen[bytes]) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _command(folder: Path, *where: str) -> subprocess.Popen[bytes]:
    words = [sys.executable, "-m", "ropewalk", "sweep", "one.yaml", *SWEEP, *where, "--quiet"]
    return subprocess.Popen(words, cwd=folder, env=os.environ | _ONE, **_QUIET)  # type: ignore[call-overload,no-any-return]


def _kept(folder: Path) -> int:
    """Lines of the store."""
    store = folder / "one.sweep.jsonl"
    return store.read_bytes().count(b"\n") if store.exists() else 0


def content(folder: Path) -> str:
    """What is wrong with the store; else a hash of its cases, and of the table without the seconds."""
    lines = (folder / "one.sweep.jsonl").read_text(encoding="utf-8").splitlines()[1:]
    points = [json.loads(line) for line in lines]
    times = Counter(point["key"] for point in points)
    if len(times) != CASES or len(points) != CASES:
        return f"{len(points)} lines of {len(times)} cases instead of {CASES}"
    for point in points:
        point.pop("seconds")
    rows = [row.rpartition(",")[0] for row in (folder / "one.csv").read_text(encoding="utf-8").splitlines()]
    text = json.dumps([*sorted(json.dumps(point, sort_keys=True) for point in points), *rows])
    return hashlib.sha256(text.encode()).hexdigest()


def whole(folder: Path) -> str:
    """The content of the sweep by processes of this machine that nobody kills."""
    _prepare(folder)
    if _command(folder, "--workers", "1").wait():
        raise AssertionError("the sweep fails without a kill")
    return content(folder)


def _prepare(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "one.yaml").write_text(ROPE, encoding="utf-8")


def trial(folder: Path, cluster: Cluster, chance: Random, most: int) -> tuple[Counter[str], str]:
    """A sweep during which processes are killed after some more cases each time, up to its end.

    Args:
        folder: for its files.
        cluster: on which it is computed.
        chance: draws what is killed, and when.
        most: kills.

    Returns:
        How many of what were killed, and its content.
    """
    _prepare(folder)
    killed, kept, until = Counter[str](), 0, time.monotonic() + PATIENCE
    command = _command(folder, "--cluster", cluster.address)
    due = chance.randint(1, 30)
    while time.monotonic() < until:
        time.sleep(0.02)
        if _kept(folder) > kept:  # on a busy machine it takes long
            kept, until = _kept(folder), time.monotonic() + PATIENCE
        if command.poll() is not None:
            if command.returncode == 0:
                return killed, content(folder)
            command = _command(
                folder, "--cluster", cluster.address
            )  # the scheduler has gone: it goes on from its store
        if killed.total() == most or _kept(folder) < due:
            continue
        what = chance.choice(_WHAT)
        killed[what] += 1
        due = _kept(folder) + chance.randint(1, 2 * CASES // (most + 1))
        until = time.monotonic() + PATIENCE
        if what == "worker":
            cluster.kill_worker(chance.randrange(WORKERS))
        elif what == "scheduler":
            cluster.kill_scheduler()
        else:
            _end(command)
            command = _command(folder, "--cluster", cluster.address)
    _end(command)
    return killed, f"has not gone on for {PATIENCE:g} s, with {_kept(folder)} lines"
