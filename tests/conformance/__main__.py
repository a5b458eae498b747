"""The whole matrix by one command: `python -m tests.conformance`; goes on where it was stopped."""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections import Counter
from pathlib import Path

from .cases import Case, cases
from .pool import answers
from .structures import Tree
from .working import furnish


def main() -> None:
    """Compute what is missing, and print the counts."""
    parser = argparse.ArgumentParser(prog="python -m tests.conformance", description=__doc__)
    parser.add_argument("--store", type=Path, default=Path("out/matrix.jsonl"), help="finished cases, one a line")
    parser.add_argument("--workers", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--only", default="", help="cases whose names contain this")
    asked = parser.parse_args()
    asked.store.parent.mkdir(parents=True, exist_ok=True)
    wanted = [case for case in cases() if asked.only in case.name]
    done = stored(asked.store)
    missing = [case for case in wanted if done.get(case.name, {}).get("digest") != case.digest]
    folder = asked.store.parent.resolve() / "matrix"
    if missing:
        furnish(folder)
    begin = time.monotonic()
    with asked.store.open("a", encoding="utf-8") as store:

        def told(case: Case, found: Tree) -> None:
            done[case.name] = {"name": case.name, "digest": case.digest, **found}
            store.write(json.dumps(done[case.name]) + "\n")
            store.flush()
            count = sum(case.name in done for case in wanted)
            if sys.stderr.isatty() or count % 100 == 0:
                print(f"\r{count} of {len(wanted)}, {time.monotonic() - begin:.0f} s", end="", file=sys.stderr)

        answers(missing, folder, asked.workers, told)
    print(file=sys.stderr)
    print(dict(Counter(done[case.name]["verdict"] for case in wanted).most_common()))


def stored(file: Path) -> dict[str, Tree]:
    """Cases that are done, by name; a last line cut short by a kill is none."""
    found: dict[str, Tree] = {}
    if file.exists():
        for text in file.read_text(encoding="utf-8").splitlines():
            try:
                line = json.loads(text)
            except json.JSONDecodeError:
                continue
            found[line["name"]] = line
    return found


if __name__ == "__main__":
    main()
