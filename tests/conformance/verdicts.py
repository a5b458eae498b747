"""The verdicts on all cases, in a file beside this one: what tests and the page of capabilities are held to."""

from __future__ import annotations

import json
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path

from .cases import Case
from .judging import REFUSED
from .refusals import REFUSALS, Refusal, refusals_in
from .structures import Tree

FILE = Path(__file__).with_name("verdicts.json")

UNKNOWN = "for a reason that nobody knows"

Verdicts = dict[str, str]
"""Name of a case: its verdict, of a refusal `refused: reason`."""


def verdict_of(found: Tree) -> str:
    """The verdict in a word; of a refusal the reason, the physical one where several are given."""
    if found["verdict"] != REFUSED:
        return str(found["verdict"])
    reasons = refusals_in(found["note"])
    if not reasons or None in reasons:
        return f"{REFUSED}: {UNKNOWN}"
    first = min((reason for reason in reasons if reason is not None), key=REFUSALS.index)
    return f"{REFUSED}: {first.reason}"


def reason_of(verdict: str) -> Refusal | None:
    """Why a case is refused; None: it is not, or nobody knows."""
    reason = verdict.removeprefix(f"{REFUSED}: ")
    return next((refusal for refusal in REFUSALS if refusal.reason == reason), None)


def write(cases: Iterable[Case], verdicts: Mapping[str, str], file: Path = FILE) -> None:
    """Write the verdicts, a line for each structure in each row of each table."""
    words = sorted(set(verdicts.values()))
    rows: dict[str, dict[str, int]] = defaultdict(dict)
    for case in cases:
        rows[f"{case.table} / {case.row} / {case.structure}"][case.load] = words.index(verdicts[case.name])
    lines = [f"  {json.dumps(row)}: {json.dumps(entries)}" for row, entries in rows.items()]
    head = ",\n".join(f"  {json.dumps(word)}" for word in words)
    file.write_text(f'{{"words": [\n{head}\n],\n"rows": {{\n' + ",\n".join(lines) + "\n}}\n", encoding="utf-8")


def read(file: Path = FILE) -> Verdicts:
    """The verdicts as they were written last."""
    stored = json.loads(file.read_text(encoding="utf-8"))
    return {
        f"{row} / {load}": stored["words"][word]
        for row, entries in stored["rows"].items()
        for load, word in entries.items()
    }


def counts(verdicts: Verdicts) -> Counter[str]:
    """How many cases have each verdict, refusals by their kind."""
    found: Counter[str] = Counter()
    for verdict in verdicts.values():
        refusal = reason_of(verdict)
        found[f"{REFUSED}, {refusal.kind}" if refusal is not None else verdict] += 1
    return found
