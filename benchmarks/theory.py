"""Closed forms on a field of 1000 places and 1000 instants: median CPU seconds of five calls."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from statistics import median

import numpy as np

from ropewalk.theory import beam, string
from ropewalk.theory.image_sum import travelling_force

X, T = np.linspace(0.0, 1.0, 1000)[None, :], np.linspace(0.0, 3.0, 1000)[:, None]
STRING = {"length": 1.0, "tension": 1.0, "mass": 1.0}
BEAM = {"length": 1.0, "bending_stiffness": 0.01, "mass": 1.0, "tension": 1.0}

FIELDS: dict[str, Callable[[], object]] = {
    "string, exact, below the wave speed": lambda: string.moving_force(X, T, force=1.0, speed=0.5, **STRING),
    "string, exact, above the wave speed": lambda: string.moving_force(X, T, force=1.0, speed=1.5, **STRING),
    "string, 149 modes": lambda: string.moving_force(X, T, force=1.0, speed=0.5, modes=149, **STRING),
    "string, exact, accelerated force": lambda: travelling_force(
        X, T, path=lambda t: 0.2 * t**2, force=1.0, length=1.0, tension=1.0, mass=1.0
    ),
    "beam, 50 modes": lambda: beam.moving_force(X, T, force=1.0, speed=0.5, modes=50, **BEAM),
    "beam, converged to 1e-9": lambda: beam.moving_force(X, T, force=1.0, speed=0.5, **BEAM),
}


def seconds(call: Callable[[], object], times: int = 5) -> float:
    """Median CPU time of a call, s."""
    call()
    taken = []
    for _ in range(times):
        begin = clock.process_time()
        call()
        taken.append(clock.process_time() - begin)
    return median(taken)


def main() -> None:
    """Print the table."""
    print("\nClosed forms, 1000 x 1000 points:\n")
    for name, call in FIELDS.items():
        print(f"  {name:40} {seconds(call):7.3f} s")


if __name__ == "__main__":
    main()
