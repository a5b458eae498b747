"""The error of a path over the CPU seconds of its whole run, against the continuum; and the same of another version.

    python -m benchmarks accuracy                    errors and CPU seconds of meshes
    python -m benchmarks.accuracy --before FOLDER    CPU seconds for the same error over those of another checkout

A force on a soft string has an exact self-similar path until a wave comes back; forces and masses on taut strings and
beams have exact answers all the way. Where paths of meshes lead somewhere they are extrapolated, too. FOLDER is a
checkout with a `.venv`; this file runs in it as it is.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import time as clock
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

import ropewalk
from ropewalk.model import Scenario
from ropewalk.simulate import simulate
from ropewalk.theory import beam_crossing, selfsimilar, string

Array = np.ndarray
Row = tuple[int, float, float]
"""Elements, error in m, CPU seconds."""

ROUNDS, OUTPUTS = 5, 60
EA, WEIGHT = 1e4, 1e-5
LENGTH = 1.0 / (1.0 + 1.0 / EA)
TAUT = {"length": LENGTH, "tension": LENGTH, "mass": 1.0}
SPEED = 0.5 * float(np.sqrt(LENGTH))
BEAM = {"length": 1.0, "bending_stiffness": 1.0, "mass": 1.0}
KINK, PACE = 0.46 * float(np.sqrt(0.05 / 1.05)), 0.5 * np.pi


@dataclass(frozen=True)
class Problem:
    """A load whose path is known: lines and load for a mesh, the end in s, the exact path (time,), and meshes."""

    line: dict[str, Any]
    load: dict[str, Any]
    until: float
    exact: Callable[[Array], Array]  # (time, axis) m, of the contact
    meshes: tuple[int, ...]
    linearised: bool = False

    def on(self, elements: int, **more: Any) -> Scenario:
        """The scenario on a mesh."""
        run = {"kind": "dynamic", "until": self.until, "every": self.until / OUTPUTS} | more
        if self.linearised:
            run["geometry"] = "linearised"
        lines = {"line": self.line | {"elements": elements}}
        return Scenario.model_validate({"gravity": 0.0, "lines": lines, "loads": {"load": self.load}, "run": run})


def _below(deflection: Array) -> Array:
    """A path whose height alone is asked for."""
    return np.stack([np.full(deflection.size, np.nan), -deflection], axis=1)


def _self_similar(t: Array) -> Array:
    wave = selfsimilar.moving_force(
        force=0.01, speed=KINK, axial_stiffness=1.0, mass=1.0, prestrain=0.05, contact="clamped"
    )
    return np.array([1.05, 0.0]) + t[:, None] * np.array([wave.contact_velocity[0], -abs(wave.contact_velocity[1])])


SOFT = {"start": [0, 0], "end": [2.1, 0], "length": 2.0, "mass": 1.0, "axial_stiffness": 1.0}
STRAIGHT = {"start": [0, 0], "end": [1, 0], "length": LENGTH, "mass": 1.0, "axial_stiffness": EA}
STIFF = {"start": [0, 0], "end": [1, 0], "length": 1.0, "mass": 1.0, "axial_stiffness": EA, "bending_stiffness": 1.0}
PROBLEMS = {
    "force on a soft string, self-similar": Problem(
        SOFT, {"kind": "force", "on": "line", "force": [0, -0.01], "travel": {"speed": KINK, "from": 1.0}},
        0.95, _self_similar, (100, 400, 1600, 6400),
    ),
    "force on a taut string": Problem(
        STRAIGHT, {"kind": "force", "on": "line", "force": [0, -WEIGHT], "travel": {"speed": SPEED}},
        0.9 * LENGTH / SPEED, lambda t: _below(string.moving_force_path(t, force=WEIGHT, speed=SPEED, **TAUT)),
        (48, 100, 200, 400, 800),
    ),
    "mass on a taut string": Problem(
        STRAIGHT, {"kind": "mass", "on": "line", "mass": 1.0, "force": [0, -WEIGHT], "travel": {"speed": SPEED}},
        0.9 * LENGTH / SPEED,
        lambda t: _below(string.moving_mass(t, load_mass=1.0, speed=SPEED, gravity=WEIGHT, **TAUT).deflection),
        (48, 100, 200, 400, 800),
    ),
    "mass on a beam": Problem(
        STIFF, {"kind": "mass", "on": "line", "mass": 0.3, "force": [0, -3e-3], "travel": {"speed": PACE}},
        0.95 / PACE,
        lambda t: _below(
            beam_crossing.moving_mass(t, load_mass=0.3, speed=PACE, gravity=1e-2, **BEAM).deflection[:, 0]
        ),
        (20, 40, 80, 160, 320, 640), linearised=True,
    ),
}  # fmt: skip


def miss(paths: Array, exact: Array) -> float:
    """Distance of a path from the exact one, rms over the instants, m."""
    off = (paths - exact)[:, np.isfinite(exact).any(axis=0)]
    return float(np.sqrt(np.nanmean(np.sum(np.square(off), axis=1))))


def measured(name: str, rounds: int = ROUNDS) -> dict[str, list[Row]]:
    """Errors and medians of CPU seconds on the meshes of a problem, as computed and, where possible, extrapolated."""
    problem, found = PROBLEMS[name], dict[str, list[Row]]()
    for elements in problem.meshes:
        for way, more in (("computed", {}), ("extrapolated", {"mesh_error": True})):
            if more and not hasattr(ropewalk, "extrapolated"):
                continue
            scenario = problem.on(elements, **more)
            simulate(scenario)  # kernels are loaded, or compiled
            times = []
            for _ in range(rounds):
                begin = clock.process_time()
                result = simulate(scenario)
                times.append(clock.process_time() - begin)
            path = result.contact_position
            if more:
                try:
                    path = ropewalk.extrapolated(result)
                except ropewalk.RopewalkError:
                    continue
            error = miss(path.values[:, 0], problem.exact(result.time.values))
            found.setdefault(way, []).append((elements, error, median(times)))
    return found


def cheapest(rows: list[Row], error: float) -> float:
    """CPU seconds with which an error is reached, between meshes by powers; NaN where none does."""
    rows = sorted(rows)
    for (_, coarse, less), (_, fine, more) in pairwise(rows):
        if fine <= error < coarse:
            return float(less * (more / less) ** (np.log(coarse / error) / np.log(coarse / fine)))
    return rows[0][2] if rows and rows[0][1] <= error else float("nan")


def table(name: str, found: dict[str, list[Row]]) -> None:
    """Print what was measured of a problem."""
    print(f"\n{name}: rms error of the path, m, and CPU s of the run")
    plain, better = ({row[0]: row[1:] for row in found.get(way, [])} for way in ("computed", "extrapolated"))
    print(f"{'elements':>10}{'error':>11}{'CPU s':>9}{'extrapolated':>15}{'CPU s':>9}{'of that for the same':>23}")
    for elements, (error, seconds) in plain.items():
        more = ""
        if elements in better:
            nearer, took = better[elements]
            alone = cheapest(found["computed"], nearer)
            more = f"{nearer:15.2e}{took:9.3f}" + (f"{took / alone:23.2f}" if alone > 0.0 else f"{'no mesh':>23}")
        print(f"{elements:10}{error:11.2e}{seconds:9.3f}{more}", flush=True)


def against(folder: Path, pairs: int) -> None:
    """Print the CPU seconds for the same error, by the best of both ways, over those of another version."""
    for name in PROBLEMS:
        ratios: dict[float, list[float]] = {}
        for _ in range(pairs):
            before, now = (_apart(root, name) for root in (folder, Path.cwd()))
            for _, error, seconds in before["computed"]:
                ways = [cheapest(rows, error) for rows in now.values()]
                ratios.setdefault(error, []).append(float(np.nanmin([*ways, np.inf])) / seconds)
        print(f"\n{name}: CPU s for the same error, of those of {folder.name}; medians of {pairs} pairs")
        for error, found in ratios.items():
            print(f"{error:11.2e} m {median(found):8.2f}  ({min(found):.2f} to {max(found):.2f})", flush=True)


def _apart(root: Path, name: str) -> dict[str, list[Row]]:
    """What a checkout measures of a problem in a process of its own, each mesh once."""
    command = [str(root / ".venv" / "bin" / "python"), str(Path(__file__).resolve()), "--problem", name]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=root)
    return json.loads(done.stdout)  # type: ignore[no-any-return]


def main() -> None:
    """Print the tables."""
    for name in PROBLEMS:
        table(name, measured(name))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--before", type=Path, metavar="FOLDER", help="checkout of another version, with a .venv")
    parser.add_argument("--pairs", type=int, default=5, help="of runs of both versions")
    parser.add_argument("--problem", choices=PROBLEMS, help="one of them, as JSON")
    asked = parser.parse_args()
    if asked.problem:
        print(json.dumps(measured(asked.problem, 3)))
    elif asked.before:
        against(asked.before.resolve(), asked.pairs)
    else:
        main()
