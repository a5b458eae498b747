"""Kill at random moments, in the folder of tests; tells what went wrong.

`python -m kills COUNT [SEED]` kills commands, `python -m kills cluster COUNT [SEED]` workers, schedulers and commands
of sweeps on a Dask cluster, `python -m kills signals COUNT [SEED]` interrupts commands of all kinds and measures how
soon they end.
"""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from pathlib import Path
from random import Random

from kills import cluster
from kills.commands import SCENARIOS, lasting, trial
from kills.interrupts import trials

KILLS = 8
"""In a sweep."""
SOON = 0.5
"""Within this time an interrupted command has ended, s."""


def main(count: int, seed: int) -> int:
    """As many kills, in turns of all commands; 1 if one of them has lost something."""
    chance, wrong, done = Random(seed), 0, Counter[str]()
    with tempfile.TemporaryDirectory() as folder:
        wholes = {name: lasting(name, Path(folder) / "whole" / name) for name in SCENARIOS}
        for number in range(count):
            name = list(SCENARIOS)[number % len(SCENARIOS)]
            whole, seconds = wholes[name]
            after = seconds * chance.uniform(0.1, 1.0)
            message = trial(name, Path(folder) / str(number), after, whole)
            done[name] += 1
            if message:
                wrong += 1
                print(f"kill {number} of {name} after {after:.3f} s: {message}", flush=True)
    print(f"seed {seed}: {count} kills ({dict(done)}), {wrong} of them wrong")
    return int(wrong > 0)


def on_a_cluster(count: int, seed: int) -> int:
    """As many kills during sweeps on a cluster; 1 if one of these is not what it is without."""
    chance, wrong, done, sweeps = Random(seed), 0, Counter[str](), 0
    with tempfile.TemporaryDirectory() as folder:
        right = cluster.whole(Path(folder) / "whole")
        one = cluster.Cluster(Path(folder) / "cluster")
        try:
            while done.total() < count:
                killed, found = cluster.trial(Path(folder) / str(sweeps), one, chance, KILLS)
                done, sweeps = done + killed, sweeps + 1
                wrong += found != right
                print(
                    f"sweep {sweeps}: killed {dict(killed)}; {'' if found == right else found or 'differs'}", flush=True
                )
        finally:
            one.close()
    print(f"seed {seed}: {done.total()} kills ({dict(done)}) during {sweeps} sweeps, {wrong} of them wrong")
    return int(wrong > 0)


def signals(count: int, seed: int) -> int:
    """Interrupt as many commands; 1 if one of them needs more than `SOON` or ends otherwise than it should."""
    late, wrong, walls = Counter[str](), 0, list[float]()
    with tempfile.TemporaryDirectory() as folder:
        for name, after, answer in trials(count, seed, Path(folder)):
            if answer is None:
                continue
            walls.append(answer.wall)
            wrong += bool(answer.fault)
            late[name] += answer.wall > SOON
            if answer.fault or answer.wall > SOON:
                how = f"{answer.wall:.2f} s, {answer.cpu:.2f} s of CPU, {answer.fault or 'late'}"
                print(f"{name} after {after:.2f} s: {how}", flush=True)
    walls.sort()
    print(
        f"seed {seed}: {len(walls)} of {count} commands interrupted; median {walls[len(walls) // 2]:.2f} s, largest "
        f"{walls[-1]:.2f} s; {late.total()} later than {SOON} s ({dict(+late)}), {wrong} wrong"
    )
    return int(wrong + late.total() > 0)


CALLS = {"cluster": on_a_cluster, "signals": signals}

if __name__ == "__main__":
    words = sys.argv[1:]
    numbers = [int(word) for word in words if word not in CALLS]
    sys.exit(CALLS.get(words[0], main)(numbers[0], numbers[1] if len(numbers) > 1 else 0))
