"""Spoil files for some seconds, in the folder of tests: `python -m fuzzing SECONDS [SEED]`; tells what went wrong."""

from __future__ import annotations

import sys
import time
from collections import Counter

from fuzzing.mutants import mutant
from fuzzing.reading import READ, REFUSED, outcome


def main(seconds: float, seed: int) -> int:
    """Read mutants until the time is over; 1 if one was not read or refused as it should."""
    end, found, number = time.monotonic() + seconds, Counter[str](), 0
    while time.monotonic() < end:
        name, text = mutant(seed, number)
        what = outcome(text)
        found[what if what in (READ, REFUSED) else "wrong"] += 1
        if what not in (READ, REFUSED):
            print(f"mutant {seed} {number} of {name}: {what}", flush=True)
        number += 1
    print(f"seed {seed}: {number} mutants in {seconds:g} s:", dict(found))
    return int(found["wrong"] > 0)


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0))
