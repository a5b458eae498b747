"""Cases per second of a sweep on one and two cores, beside a plain loop, and what a sweep adds to each case.

Medians of three turns of everything, one after another, so that other work on the machine falls on all alike.
"""

from __future__ import annotations

import resource
import time as clock
from collections.abc import Callable
from statistics import median

import ropewalk
from ropewalk.scenario import loads
from ropewalk.sweeps.quantities import measured

ROPE = """\
lines: {rope: {start: [0, 0], end: [10, 0], length: 10.5, mass: 1, axial_stiffness: 1e5, elements: 10}}
loads: {man: {kind: force, on: rope, force: [0, -100], travel: {speed: 1, from: 5}}}
run: {kind: equilibrium}
"""
WALK = ROPE.replace("{kind: equilibrium}", "{kind: dynamic, until: 2 s, every: 20 ms}")
VALUES = [f"{100 + k} N" for k in range(100)]
RECORD = "max tension"
TURNS = 3


def used(call: Callable[[], object]) -> tuple[float, float]:
    """Seconds on the wall, and of all processors, of a call and the processes that it has ended."""

    def seconds() -> float:
        found = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
        return sum(each.ru_utime + each.ru_stime for each in found)

    wall, cpu = clock.perf_counter(), seconds()
    call()
    return clock.perf_counter() - wall, seconds() - cpu


def looped(text: str, values: list[str]) -> None:
    """What a script of one's own does."""
    for value in values:
        scenario = loads(text, overrides=[f"loads.man.force.1=-{value}"])
        with ropewalk.simulate(scenario) as result:
            measured(result, (RECORD,))


def swept(text: str, values: list[str], workers: int) -> None:
    """The same as a sweep, without a store."""
    over = {"loads.man.force.1": [f"-{value}" for value in values]}
    ropewalk.sweep(loads(text), over, record=RECORD, workers=workers)


def main() -> None:
    """Print the table."""
    print("\n100 cases, seconds each: on the wall, of processors; medians of three\n")
    for name, text in (("equilibrium of a rope, 10 links", ROPE), ("walk over it, 2 s", WALK)):
        looped(text, VALUES[:2])
        ways: dict[str, Callable[[], None]] = {"a plain loop": lambda text=text: looped(text, VALUES)}
        for workers, told in ((0, "sweep, no processes"), (1, "sweep, one process"), (2, "sweep, two processes")):
            ways[told] = lambda text=text, workers=workers: swept(text, VALUES, workers)
        taken: dict[str, list[tuple[float, float]]] = {told: [] for told in ways}
        for _ in range(TURNS):
            for told, call in ways.items():
                taken[told].append(used(call))
        loop = median(cpu for _, cpu in taken["a plain loop"])
        for told, found in taken.items():
            wall, cpu = (median(part) / len(VALUES) for part in zip(*found, strict=True))
            ratio = cpu * len(VALUES) / loop
            print(f"  {name:32} {told:22} {1e3 * wall:8.2f} ms {1e3 * cpu:8.2f} ms  {ratio:5.2f} of the loop")


if __name__ == "__main__":
    main()
