"""Weak scaling of a sweep to more processes than there are cores, by simulation with measured costs.

The model is that of `ropewalk/sweeps/pool.py`: one process reads all scenarios, sends chunks of cases to others that
are free, one chunk each, and takes their answers, one thing after another; every other process first imports what it
needs, and then computes what it gets. Each has a core. Memory, disks, and what is done once for a sweep are not in the
model, and nobody has compared it with a machine of eight cores.
"""

from __future__ import annotations

import heapq
import os
import time as clock
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

from ropewalk.scenario import loads
from ropewalk.sweeps.case import computed
from ropewalk.sweeps.plan import Plan, asked
from ropewalk.sweeps.pool import BRIEF, CHUNK, each

ROPE = """\
lines: {rope: {start: [0, 0], end: [10, 0], length: 10.5, mass: 1, axial_stiffness: 1e5, elements: 10}}
loads: {man: {kind: force, on: rope, force: [0, -100], travel: {speed: 1, from: 5}}}
run: {kind: equilibrium}
"""
WALK = ROPE.replace("{kind: equilibrium}", "{kind: dynamic, until: 2 s, every: 20 ms}")
CASES = 400
"""For each process."""
PROCESSES = (1, 2, 4, 8)


@dataclass(frozen=True)
class Costs:
    """What was measured, s of a processor.

    Args:
        read: to read and check the scenario of a case.
        case: of cases, one after another.
        start: until a process has computed its first case, without that case.
        send: to send a chunk and take its answers, of the one that sends.
        take: the same of the one that computes.
    """

    read: float
    case: Sequence[float]
    start: float
    send: float
    take: float


def nothing(_: int) -> float:
    """The seconds of its processor that a process has used so far."""
    return clock.process_time()


def started(case: object) -> float:
    """The same, after a case."""
    computed(case)  # type: ignore[arg-type]
    return clock.process_time()


def measured(text: str, count: int = 30) -> Costs:
    """Measure, each by itself."""
    scenario = loads(text)
    wish = asked(scenario, {"loads.man.force.1": [f"-{100 + k} N" for k in range(count)]}, record=("max tension",))
    Plan.of(scenario, wish)
    begin = clock.process_time()
    cases = [row.case for row in Plan.of(scenario, wish).rows if row.case is not None]
    read = (clock.process_time() - begin) / count
    seconds = []
    for case in cases:
        begin = clock.process_time()
        computed(case)
        seconds.append(clock.process_time() - begin)
    seconds[0] = median(seconds)
    first = next(at for _, at in each(cases[:1], started, 1, 0.0)) - seconds[0]
    # Tasks of nothing come in chunks of CHUNK.
    going = each(range(50 * CHUNK), nothing, 1, 0.0)
    next(going)
    begin, answers = clock.process_time(), [at for _, at in going]
    send = (clock.process_time() - begin) / 50
    return Costs(read, seconds, first, send, (answers[-1] - answers[0]) / 50)


def simulated(processes: int, cases: int, costs: Costs) -> float:
    """Seconds from the first scenario to the last answer."""
    sender = cases * costs.read
    free = [(sender, number) for number in range(processes)]  # events: when a process waits for its next chunk
    heapq.heapify(free)
    fresh, left, together, done = set(range(processes)), cases, 1, 0.0
    while left:
        at, number = heapq.heappop(free)
        sender = max(sender, at) + costs.send
        size = min(together, left)
        own = [costs.case[(left - k) % len(costs.case)] for k in range(size)]
        busy = sum(own) + (costs.start if number in fresh else 0.0)
        fresh.discard(number)
        left -= size
        together = max(1, min(CHUNK, int(BRIEF * size / busy)))
        done = max(done, sender + busy + costs.take)
        heapq.heappush(free, (sender + busy + costs.take, number))
    return done


def main() -> None:
    """Print the table."""
    print(f"\n{CASES} cases for each process, simulated with costs of this machine (load {os.getloadavg()[0]:.1f})\n")
    for name, text in (("equilibrium of a rope, 10 links", ROPE), ("walk over it, 2 s", WALK)):
        costs = measured(text)
        print(
            f"  {name}: {1e3 * median(costs.case):.2f} ms a case, {1e3 * costs.read:.2f} to read it; a chunk "
            f"{1e3 * costs.send:.2f} ms here and {1e3 * costs.take:.2f} there; a process {costs.start:.1f} s to start"
        )
        one = simulated(1, CASES, costs)
        for processes in PROCESSES:
            took = simulated(processes, CASES * processes, costs)
            rate = CASES * processes / took
            print(f"    {processes} processes: {took:7.2f} s, {rate:7.1f} cases a second, efficiency {one / took:.2f}")


if __name__ == "__main__":
    main()
