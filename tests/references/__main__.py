"""References by one command: `make references` compares this state of the program with them.

python -m references                     compare all cases (in tests/)
python -m references record --shards 16  record what the shard files lack, one shard after another
python -m references merge               write the reference file from the shard files
python -m references planted             count the cases that detect each planted change
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML

from ropewalk.errors import RopewalkError

from . import recording, store
from .cases import FOLDER, ReferenceCase, cases, selected
from .changes import CONTROL, PLANTED, planted
from .comparing import Difference, accepted, differences, is_better, without_accepted
from .recording import records
from .tolerances import TRUSTED, Reference, reference_of

HEAVY = 6.0  # s of CPU of a case; heavier ones are compared with --all only
FEWEST = 10  # cases that have to detect a planted change


def main() -> None:
    """Run a command."""
    asked = _arguments()
    COMMANDS[asked.command](asked)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m references", description=__doc__)
    parser.add_argument("command", choices=COMMANDS, nargs="?", default="compare")
    parser.add_argument("--only", nargs="+", default=[], help="cases whose names contain one of these texts")
    parser.add_argument("--without", nargs="+", default=[], help="no cases whose names contain one of these texts")
    parser.add_argument("--shard", default="0/1", help="i/n: every n-th case, beginning with i (from 0)")
    parser.add_argument("--shards", type=int, default=16, help="number of shard files")
    parser.add_argument("--folder", type=Path, default=Path("../out/references"), help="shard files and scratch files")
    parser.add_argument("--file", type=Path, default=store.FILE, help="reference file")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--all", action="store_true", help="compare heavy cases, too")
    parser.add_argument("--change", choices=PLANTED, nargs="+", help="planted changes (default: all)")
    parser.add_argument("--most", type=int, default=40, help="cases per planted change")
    return parser.parse_args()


def record(asked: argparse.Namespace) -> None:
    """Record the cases that the shard files lack."""
    every = selected(cases(), asked.only, asked.without, asked.shard)
    scratch = asked.folder.resolve() / "scratch"
    for k in range(asked.shards):
        own = [case for case in every if case.shard % asked.shards == k]
        recording.record_shard(own, asked.folder / f"shard-{k:02}.bin", scratch, asked.workers)


def merge(asked: argparse.Namespace) -> None:
    """Write the reference file from the shard files."""
    reasons: list[dict[str, Any]] = YAML(typ="safe").load(FOLDER / "known_wrong.yaml")
    known = {case.name for case in cases()}
    found: dict[str, Reference] = {}
    for file in sorted(asked.folder.glob("shard-*.bin")):
        for one in recording.read(file):
            if one.name in known:
                wrong = next((own["reason"] for own in reasons if all(part in one.name for part in own["parts"])), "")
                found[one.name] = reference_of(one, wrong)
    store.write((found[name] for name in sorted(found)), asked.file)
    marks = Counter(reference.mark for reference in found.values())
    print(f"{len(found)} of {len(known)} cases: {dict(marks)}; {asked.file.stat().st_size / 1e6:.2f} MB")
    print(f"without a reference: {sorted(known - found.keys())[:20]}")
    print(f"sha256 {store.digest(asked.file)}")


def compare(asked: argparse.Namespace) -> None:
    """Compare this state of the program with the references; exit code 1 if there is a difference."""
    references = store.read(asked.file)
    chosen = _compared(asked, references)
    begin, count, better, own = time.monotonic(), 0, 0, accepted()
    found: list[Difference] = []
    for one in records(chosen, asked.folder.resolve() / "scratch", False, asked.workers):
        reference = references[one.name]
        apart = without_accepted(differences(reference, one.full), one.full, own)
        found.extend(apart)
        better += is_better(reference, one.full)
        count += 1
        for difference in apart:
            print(difference, flush=True)
        if count % SELDOM == 0:
            print(f"{count} of {len(chosen)} cases, {time.monotonic() - begin:.0f} s", file=sys.stderr, flush=True)
    bad = len({difference.case for difference in found})
    print(f"{count} cases compared in {time.monotonic() - begin:.0f} s: {bad} differ, {better} have a better outcome")
    sys.exit(1 if bad else 0)


def _compared(asked: argparse.Namespace, references: dict[str, Reference]) -> list[ReferenceCase]:
    return [
        case for case in selected(cases(), asked.only, asked.without, asked.shard)
        if case.name in references and (asked.all or references[case.name].cpu <= HEAVY)
    ]  # fmt: skip


def plant(asked: argparse.Namespace) -> None:
    """Count the cases that detect each planted change; exit code 1 if a change is detected by too few."""
    references = store.read(asked.file)
    chosen = [case for case in _compared(asked, references) if references[case.name].mark == TRUSTED]
    missed = []
    for change in asked.change or PLANTED:
        detecting: list[str] = []
        changed = list(_changed(chosen, change, asked.most))
        for one in records(changed, asked.folder.resolve() / "scratch", False, asked.workers):
            if any(differences(references[one.name], one.full)):
                detecting.append(one.name)
        print(f"{change}: detected by {len(detecting)} of {len(changed)} cases, such as {detecting[:3]}", flush=True)
        if detecting if change == CONTROL else len(detecting) < FEWEST:
            missed.append(change)
    sys.exit(1 if missed else 0)


def _changed(chosen: Sequence[ReferenceCase], change: str, most: int) -> Iterator[ReferenceCase]:
    """Return at most so many cases with a planted change."""
    from conformance.working import read_scenario

    count = 0
    for case in sorted(chosen, key=lambda case: case.shard % 997):
        try:
            tree = planted(read_scenario(case.tree), change)
        except RopewalkError:
            continue
        if tree is not None and count < most:
            count += 1
            yield ReferenceCase(case.name, tree, case.tool, case.options)


SELDOM = 250  # cases between two lines of progress
COMMANDS = {"record": record, "merge": merge, "compare": compare, "planted": plant}

if __name__ == "__main__":
    main()
