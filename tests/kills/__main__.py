"""Kill commands at random moments, in the folder of tests: `python -m kills COUNT [SEED]`; tells what went wrong."""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from pathlib import Path
from random import Random

from kills.commands import SCENARIOS, lasting, trial


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


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0))
