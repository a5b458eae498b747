"""Kill at random moments, in the folder of tests; tells what went wrong.

`python -m kills COUNT [SEED]` kills commands, `python -m kills cluster COUNT [SEED]` workers, schedulers and commands
of sweeps on a Dask cluster.
"""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from pathlib import Path
from random import Random

from kills import cluster
from kills.commands import SCENARIOS, lasting, trial

KILLS = 8
"""In a sweep."""


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


if __name__ == "__main__":
    words = sys.argv[1:]
    call = on_a_cluster if words[0] == "cluster" else main
    numbers = [int(word) for word in words if word != "cluster"]
    sys.exit(call(numbers[0], numbers[1] if len(numbers) > 1 else 0))
