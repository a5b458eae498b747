"""The whole matrix by one command: `make matrix`, or `python -m tests.conformance`.

It goes on where it was stopped, on all cores; at the end it prints the counts, and writes the verdicts beside this file
and docs/capabilities.md. What was computed by another state of the program, or of this folder, is computed anew.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Iterable, Mapping
from pathlib import Path

from tests.sources import digest, program

from . import capabilities, differences, verdicts
from .agreement import compared
from .cases import Case, cases
from .judging import CRASH, DIFFERS, WRONG
from .pool import answers
from .structures import Tree
from .working import furnish

DECIDE = ("cases", "judging", "loads", "pressing", "structures", "working")
"""Modules that, beside the program, decide what comes of a case."""
PACE = 1.0  # s between two lines of progress on a terminal
SELDOM = 250  # cases between two lines elsewhere


def main() -> None:
    """Compute what is missing, print the counts, write verdicts and page."""
    asked = _arguments()
    asked.store.parent.mkdir(parents=True, exist_ok=True)
    every = cases()
    wanted = [case for case in every if any(part in case.name for part in asked.only)]
    state = digest([*program(), *(Path(__file__).with_name(f"{name}.py") for name in DECIDE)])
    done = stored(asked.store, state)
    missing = [case for case in wanted if case.name not in done]
    if missing:
        folder = asked.store.parent.resolve() / "matrix"
        furnish(folder)
        compute(missing, folder, asked.workers, asked.store, state, done)
    found = compared({case.name: done[case.name] for case in wanted})
    report(wanted, found)
    if len(wanted) == len(every) or asked.carry:
        words = verdicts.read() if asked.carry else {}
        words |= {name: verdicts.verdict_of(answer) for name, answer in found.items()}
        verdicts.write(every, words)
        capabilities.FILE.write_text(capabilities.page(every, words), encoding="utf-8")
        differences.write()
        print(f"\n{verdicts.FILE}, {differences.FILE} and {capabilities.FILE} are written")


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.conformance", description=__doc__)
    parser.add_argument("--store", type=Path, default=Path("out/matrix.jsonl"), help="finished cases, one a line")
    parser.add_argument("--workers", type=int, default=len(os.sched_getaffinity(0)), help="processes")
    parser.add_argument(
        "--only", nargs="+", default=[""], help="cases whose names contain one of these; writes no page"
    )
    parser.add_argument("--carry", action="store_true", help="write it all the same, other verdicts stay as they are")
    return parser.parse_args()


def compute(missing: list[Case], folder: Path, workers: int, file: Path, state: str, done: dict[str, Tree]) -> None:
    """Answer cases, and put each into the store as it is done."""
    begin = last = time.monotonic()
    count = 0
    with file.open("a", encoding="utf-8") as store:

        def message(case: Case, found: Tree) -> None:
            nonlocal last, count
            count += 1
            done[case.name] = {"name": case.name, "state": state, **found}
            store.write(json.dumps(done[case.name]) + "\n")
            store.flush()
            now = time.monotonic()
            if count % SELDOM == 0 or count == len(missing) or (sys.stderr.isatty() and now - last > PACE):
                last = now
                ending = "\r" if sys.stderr.isatty() and count < len(missing) else "\n"
                print(f"{count} of {len(missing)} cases, {now - begin:.0f} s", end=ending, file=sys.stderr, flush=True)

        answers(missing, folder, workers, message)


def stored(file: Path, state: str) -> dict[str, Tree]:
    """Cases that are done by this state of the sources, by name; a last line cut short by a kill is none."""
    found: dict[str, Tree] = {}
    if file.exists():
        for text in file.read_text(encoding="utf-8").splitlines():
            try:
                line = json.loads(text)
            except json.JSONDecodeError:
                continue
            if line["state"] == state:
                found[line["name"]] = line
    return found


def report(wanted: Iterable[Case], found: Mapping[str, Tree]) -> None:
    """Print what is at fault, and the counts by verdict and reason."""
    words = {case.name: verdicts.verdict_of(found[case.name]) for case in wanted}
    for name, word in words.items():
        if word in (WRONG, CRASH, DIFFERS) or word.endswith(verdicts.UNKNOWN):
            print(f"{word}: {name}: {found[name]['note'].splitlines()[0][:160]}")
    print(f"\n{len(words)} cases")
    for word, count in verdicts.counts(words).most_common():
        print(f"{count:6} {word}")
    print("\nrefused because")
    reasons = {}
    for word in words.values():
        if (refusal := verdicts.reason_of(word)) is not None:
            reasons[refusal] = reasons.get(refusal, 0) + 1
    for refusal, count in sorted(reasons.items(), key=lambda entry: (entry[0].kind, -entry[1])):
        print(f"{count:6} {refusal.kind}: {refusal.reason}")


if __name__ == "__main__":
    main()
