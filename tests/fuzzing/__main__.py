"""Spoil files for some seconds, in the folder of tests: `python -m fuzzing SECONDS [SEED [check]]`; print faults.

With `check`, each is checked as the command does: its files, its sweep and how its run would begin.
"""

from __future__ import annotations

import os
import sys
import time
from collections import Counter
from contextlib import suppress

from fuzzing.mutants import EXAMPLES, extreme, mutant
from fuzzing.reading import MEMORY, READ, REFUSED, checked, outcome


def main(seconds: float, seed: int, is_checked: bool) -> int:
    """Read mutants until the time is over; 1 if one was not read or refused as it should."""
    with suppress(ImportError):
        import resource

        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
    os.chdir(EXAMPLES)
    end, found, number = time.monotonic() + seconds, Counter[str](), 0
    while time.monotonic() < end:
        name, text = (extreme if is_checked and number % 2 else mutant)(seed, number)
        begin = time.process_time()
        print(f"mutant {seed} {number} of {name}", end="\r", file=sys.stderr, flush=True)  # the last one, where it dies
        what = outcome(text, read=checked if is_checked else None)
        slow = "" if what not in (READ, REFUSED) or time.process_time() - begin < 5.0 else "slow"
        found[what if what in (READ, REFUSED) else "wrong"] += 1
        if slow or what not in (READ, REFUSED):
            print(f"mutant {seed} {number} of {name}: {what} {slow}", flush=True)
        number += 1
    print(f"seed {seed}: {number} mutants in {seconds:g} s:", dict(found))
    return int(found["wrong"] > 0)


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0, sys.argv[3:] == ["check"]))
