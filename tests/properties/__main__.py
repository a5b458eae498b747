"""The long run, in the folder of tests: `python -m properties`; `--pair "1-7 mirror"` examines one pair again."""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any

from .pairs import Verdict, again
from .workers import Worker

ALLOWED = 0.05
"""Share of expected failures."""


def examined(seeds: list[int], pairs: int, workers: list[Worker]) -> Iterator[Verdict]:
    """Yield the verdicts on pairs of scenarios of some seeds in turn."""
    tasks = ((seed, number) for number in range(10**9) for seed in seeds)
    busy, count = list(workers), 0
    for worker in workers:
        worker.give(next(tasks))
    while busy:
        ready = wait([worker.connection for worker in busy], timeout=1.0)
        for worker in list(busy):
            verdict, free = None, False
            if worker.connection in ready:
                free, verdict = worker.take()
            elif worker.is_late:
                free, verdict = True, worker.give_up()
            if verdict is not None:
                count += 1
                yield verdict
            if free and count >= pairs:
                worker.give(None)
                busy.remove(worker)
            elif free:
                worker.give(next(tasks))


def report(found: list[Verdict], cpu: float) -> dict[str, Any]:
    """Return the counts by relation and kind, the violations and the expected failures."""
    new = [verdict for verdict in found if verdict.is_violated and not verdict.case]
    cases = Counter(verdict.case for verdict in found if verdict.is_violated and verdict.case)
    return {
        "pairs": len(found), "cpu_seconds": round(cpu, 1),
        "by_relation": Counter(verdict.relation for verdict in found), "by_kind": Counter(v.kind for v in found),
        "expected": cases, "expected_share": sum(cases.values()) / max(len(found), 1),
        "violations": [asdict(verdict) for verdict in sorted(new, key=lambda v: (v.relation, v.pair))],
    }  # fmt: skip


def printed(told: dict[str, Any]) -> None:
    """Print a report."""
    for title in ("by_relation", "by_kind", "expected"):
        print(f"\n{title.replace('_', ' ')}")
        for name, count in sorted(told[title].items(), key=lambda item: -item[1]):
            print(f"  {count:5d}  {name or '(none)'}")
    print(f"\n{len(told['violations'])} violations that are not expected")
    for one in told["violations"]:
        print(f"  {one['pair']} ({one['kind']}): {one['what']}")
    print(f"\n{told['pairs']} pairs, expected failures {100 * told['expected_share']:.1f} %, "
          f"{told['cpu_seconds']:g} s of CPU")  # fmt: skip


def main() -> int:
    """Run, print a report, and return 1 where something is wrong that is not expected, or too much is."""
    parser = argparse.ArgumentParser(prog="python -m properties", description=__doc__)
    parser.add_argument("--pairs", type=int, default=2000)
    parser.add_argument("--seeds", default="1")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--json", type=Path, help="file for the report")
    parser.add_argument("--pair", help="examine one pair, and print its scenario")
    given = parser.parse_args()
    if given.pair:
        tree, verdict = again(given.pair)
        print(json.dumps(tree), verdict, sep="\n")
        return int(verdict is not None and verdict.is_violated)
    workers = [Worker() for _ in range(given.workers)]
    found = []
    try:
        for verdict in examined([int(seed) for seed in given.seeds.split(",")], given.pairs, workers):
            found.append(verdict)
            if verdict.is_violated:
                print(f"{verdict.pair} ({verdict.kind}) [{verdict.case or 'VIOLATION'}]: {verdict.what}", flush=True)
    except KeyboardInterrupt:  # report the pairs up to now
        print("interrupted")
    told = report(found, sum(worker.cpu for worker in workers))
    printed(told)
    if given.json:
        given.json.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
    return int(bool(told["violations"]) or told["expected_share"] > ALLOWED)


if __name__ == "__main__":
    sys.exit(main())
