"""Interrupt commands of all kinds at random moments, set-up included, and measure how soon they end.

The commands know nothing of the engine that computes: the same table serves whatever replaces it.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from random import Random

from kills.commands import EXAMPLES, MAP, ROPE, SWEEP

EXIT_CODE = 130
"""Exit code of a command that a signal has ended."""
SHORTEST = 0.3
"""Shortest time after the start at which a command is interrupted, s: before, Python itself is starting."""
LONGEST = 10.0
"""Longest time after the start at which a command is interrupted, s; less for those that end sooner."""
PATIENCE = 60.0
"""Time after which an interrupted command counts as deaf, s."""
_TICK = os.sysconf("SC_CLK_TCK") if hasattr(os, "sysconf") else 100
_FORCE = "{kind: force, on: rope, force: [0, -500], travel: {speed: 15, from: 10 m}}"
_WAY = "travel: {speed: 15, from: 10 m, at_end: leave}"
_OSCILLATOR = f"{{kind: oscillator, on: rope, mass: 50, stiffness: 40 kN/m, {_WAY}}}"
_BEAM = """
lines:
  rope: {start: [0, 0], end: [40, 0], length: 40 m, mass: 1000, axial_stiffness: 1 GN, bending_stiffness: 2 GN*m^2,
    elements: 80}
loads: {one: LOAD}
run: {kind: dynamic, until: 2 s, every: 10 ms}
"""
_NET = """
nets:
  net: {kind: net, corner: [0, 0, 0], sides: [[30, 0, 0], [0, 20, 0]], cells: [60, 40], mesh: 500 mm,
    axial_stiffness: 12 kN, mass: 0.02, tension: 40}
loads: {one: {kind: force, on: net, force: [0, 0, -50], travel: {speed: 1, path: [[6, 10], [24, 10]]}}}
run: {kind: RUN, RANGE}
"""
_BRIDGE = (EXAMPLES / "suspension-bridge.yaml").read_text(encoding="utf-8")
TEXTS = {
    "rope": ROPE.replace("LOAD", _FORCE),
    "rope, implicit": ROPE.replace("LOAD", _FORCE).replace("elements: 100", "elements: 300, axial_damping: 50 kN*s")
    .replace("every: 20 ms", "every: 20 ms, method: implicit, step: 50 us"),
    "rope, quasi-static": ROPE.replace("LOAD", _FORCE).replace("elements: 100", "elements: 800")
    .replace("{kind: dynamic, until: 4 s, every: 20 ms}", "{kind: quasistatic, positions: 2000}"),
    "rope, linear": ROPE.replace("LOAD", _OSCILLATOR).replace("dynamic, until: 4 s", "linear, until: 40 s"),
    "beam, linearised": _BEAM.replace("LOAD", _OSCILLATOR).replace("dynamic,", "dynamic, geometry: linearised,"),
    "beam, nonlinear": _BEAM.replace("LOAD", _FORCE),
    "beam, linear": _BEAM.replace("LOAD", _OSCILLATOR).replace("dynamic, until: 2 s", "linear, until: 20 s"),
    "net, equilibrium": _NET.replace("RUN, RANGE", "equilibrium"),
    "net, quasi-static": _NET.replace("RUN, RANGE", "quasistatic, positions: 201"),
    "net, dynamic": _NET.replace("RUN, RANGE", "dynamic, until: 15 s, every: 10 ms"),
    "suspension bridge": _BRIDGE,
    "suspension bridge, many hangers": re.sub(r"count: *\d+", "count: 150", _BRIDGE),
    "sheaves": (EXAMPLES / "sheaves.yaml").read_text(encoding="utf-8"),
    "saddle": (EXAMPLES / "ropeway-saddle.yaml").read_text(encoding="utf-8"),
    "overhead line": (EXAMPLES / "en50318-2002-250.yaml").read_text(encoding="utf-8"),
    "train": (EXAMPLES / "bridge-coaches.yaml").read_text(encoding="utf-8"),
    "walker": (EXAMPLES / "highline-walker.yaml").read_text(encoding="utf-8"),
    "ropeway": (EXAMPLES / "ropeway-tramway.yaml").read_text(encoding="utf-8"),
}  # fmt: skip
"""Scenarios, by what computes them."""
COMMANDS: dict[str, tuple[str, tuple[str, ...]]] = {
    **{f"run {name}": (name, ("run", "one.yaml")) for name in TEXTS},
    "check": ("train", ("check", "one.yaml")),
    "spectrum": ("suspension bridge", ("spectrum", "one.yaml")),
    "sweep": ("rope", ("sweep", "one.yaml", *SWEEP, "--workers", "2", "--quiet")),
    "adequacy": ("rope", ("adequacy", "one.yaml", *MAP, "--workers", "2", "--json")),
    "compare": ("rope", ("compare", "one.yaml")),
}
"""Name of the scenario and words after `ropewalk`, by name of the command."""


@dataclass(frozen=True)
class Answer:
    """What an interrupted command did.

    Args:
        wall: time from the signal to the end of the process, s.
        cpu: CPU time that the process used in between, s: on a busy machine the fairer number.
        code: exit code.
        stderr: text.
    """

    wall: float
    cpu: float
    code: int
    stderr: str

    @property
    def fault(self) -> str:
        """Description of the fault; empty if the command ended as it should."""
        if self.code not in (0, EXIT_CODE):  # 0: it had just come to its end
            return f"exit code {self.code}: {self.stderr[-300:]}"
        return f"traceback: {self.stderr[-300:]}" if "Traceback" in self.stderr else ""


def interrupted(name: str, folder: Path, after: float, number: int = signal.SIGINT) -> Answer | None:
    """Start a command, interrupt it after some seconds and return its answer; None if it ended before."""
    text, words = COMMANDS[name]
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "one.yaml").write_text(TEXTS[text], encoding="utf-8")
    command = [sys.executable, "-m", "ropewalk", *words]
    pipes = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, "preexec_fn": _listens}
    with subprocess.Popen(command, text=True, cwd=folder, start_new_session=True, **pipes) as process:  # type: ignore[call-overload]
        time.sleep(after)
        if process.poll() is not None:
            return None
        used, began = _cpu(process.pid), time.monotonic()
        process.send_signal(number)
        latest = used
        while process.poll() is None and time.monotonic() < began + PATIENCE:
            latest = max(latest, _cpu(process.pid))
            time.sleep(0.005)
        wall = time.monotonic() - began
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        assert process.stderr is not None
        return Answer(wall, latest - used, process.wait(), process.stderr.read())


def trials(count: int, seed: int, folder: Path) -> Iterator[tuple[str, float, Answer | None]]:
    """Interrupt as many commands in turns: name, seconds after the start, and answer of each."""
    chance, names = Random(seed), list(COMMANDS)
    latest = dict.fromkeys(names, LONGEST)
    for number in range(count):
        name = names[number % len(names)]
        after = SHORTEST * (latest[name] / SHORTEST) ** chance.random()  # as many in set-up as in motion
        answer = interrupted(name, folder / str(number), after)
        if answer is None:
            latest[name] = max(2.0 * SHORTEST, after)
        yield name, after, answer


def _listens() -> None:
    """Let a process hear Ctrl-C, which processes in the background of a shell ignore, with all that they start."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _cpu(process: int) -> float:
    """Return the CPU time of a process so far, s; 0 where the system does not say."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / _TICK
