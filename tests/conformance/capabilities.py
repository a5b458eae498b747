"""The page of capabilities: what works on what, and why the rest is refused; written from the verdicts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from .cases import TABLES, Case
from .judging import CRASH, DIFFERS, DOUBTFUL, REFUSED, STOPPED, WORKS, WRONG
from .refusals import MISSING, NO_SENSE, REFUSALS
from .structures import BY_NAME
from .verdicts import UNKNOWN, Verdicts, counts, reason_of

FILE = Path(__file__).parents[2] / "docs" / "capabilities.md"

_HEAD = """# Capabilities

Every structure with every load, way of travel, support, kind of run, contact and tool, as {count} short runs; written
by `make matrix`, which computes all of them, and held to the program by `tests/conformance`. A run works when it is
finite, its energy audit closed to 5 % of the energy turned over, its forces within reason, and, where the same thing
can be said in other words, another engine agrees.

| sign | |
|---|---|
| **yes** | works |
| 3/4 | works with so many of the loads tried; the notes are of the others |
| ? | doubtful: the result says that it is not to be trusted, and why |
| stops | ends early, and says why |
| **wrong** | completes, and is wrong without a word: a fault |
| **untrue** | refused for a reason that is none: a fault |
| **differs** | looks right, and is not what another engine says to the same thing: a fault |
| <sup>1</sup> | refused: {missing}; the notes below say what |
| <sup>a</sup> | refused: {no_sense} |
"""


def page(cases: Iterable[Case], verdicts: Verdicts) -> str:
    """The whole page as Markdown."""
    every = list(cases)
    notes = _Notes()
    body = "\n".join(part for title, table in _TABLES.items() for part in table(title, every, verdicts, notes))
    head = _HEAD.format(count=len(every), missing=MISSING, no_sense=NO_SENSE)
    return "\n".join([head, _counted(every, verdicts), body, *notes.rows(), ""])


def _counted(every: list[Case], verdicts: Verdicts) -> str:
    """Counts by table and verdict."""
    kinds = (WORKS, DOUBTFUL, STOPPED, f"{REFUSED}, {MISSING}", f"{REFUSED}, {NO_SENSE}", WRONG, DIFFERS, CRASH)
    lines = ["## Counts", "", f"| | {' | '.join(kinds)} | all |", "|---|" + "---:|" * (len(kinds) + 1)]
    totals: Counter[str] = Counter()
    for table in TABLES:
        found = counts({case.name: verdicts[case.name] for case in every if case.table == table})
        totals += found
        lines.append(f"| {table} | {' | '.join(str(found[kind]) for kind in kinds)} | {sum(found.values())} |")
    lines.append(f"| all | {' | '.join(str(totals[kind]) for kind in kinds)} | {sum(totals.values())} |")
    return "\n".join([*lines, ""])


class _Notes:
    """Reasons in the order in which they come up, numbers for what is missing and letters for what has no sense."""

    def __init__(self) -> None:
        self._signs: dict[str, str] = {}
        self._given = {MISSING: 0, NO_SENSE: 0}

    def sign(self, verdict: str) -> str:
        refusal = reason_of(verdict)
        if refusal is None:
            return "?!"
        if refusal.reason not in self._signs:
            number = self._given[refusal.kind] = self._given[refusal.kind] + 1
            self._signs[refusal.reason] = str(number) if refusal.kind == MISSING else _letters(number)
        return self._signs[refusal.reason]

    def rows(self) -> Iterator[str]:
        yield "## Why not\n"
        for kind in (MISSING, NO_SENSE):
            yield f"{kind.capitalize()}:\n"
            own = {refusal.reason for refusal in REFUSALS if refusal.kind == kind}
            for reason, sign in self._signs.items():
                if reason in own:
                    yield f"- <sup>{sign}</sup> {reason}"
            yield ""


def _letters(number: int) -> str:
    return (_letters((number - 1) // 26) if number > 26 else "") + chr(ord("a") + (number - 1) % 26)


def _in_order(sign: str) -> tuple[bool, int, str]:
    """Numbers before letters."""
    return not sign.isdigit(), int(sign) if sign.isdigit() else len(sign), sign


def _cell(found: list[str], notes: _Notes) -> str:
    """Verdicts of the loads of one field."""
    if not found:
        return ""
    if any(verdict.endswith(UNKNOWN) for verdict in found):
        return "**untrue**"
    if any(verdict in (WRONG, CRASH) for verdict in found):
        return "**wrong**" if CRASH not in found else "**crash**"
    if DIFFERS in found:
        return "**differs**"
    working = found.count(WORKS)
    if working == len(found):
        return "**yes**"
    signs = [notes.sign(verdict) for verdict in dict.fromkeys(found) if verdict.startswith(REFUSED)]
    message = [*(["?"] if DOUBTFUL in found else []), *(["stops"] if STOPPED in found else [])]
    share = [f"{working}/{len(found)}"] if working else []
    return " ".join([*share, *message, *([f"<sup>{', '.join(sorted(signs, key=_in_order))}</sup>"] if signs else [])])


def _table(
    title: str, every: list[Case], verdicts: Verdicts, notes: _Notes, table: str, column: Callable[[Case], str]
) -> Iterator[str]:
    own = [case for case in every if case.table == table]
    columns, rows = list(dict.fromkeys(map(column, own))), list(dict.fromkeys(case.structure for case in own))
    yield f"## {title}\n"
    yield f"| | {' | '.join(columns)} |"
    yield "|---|" + "---|" * len(columns)
    for row in rows:
        cells = [
            _cell([verdicts[case.name] for case in own if case.structure == row and column(case) == name], notes)
            for name in columns
        ]
        yield f"| {BY_NAME[row].label} | {' | '.join(cells)} |"
    yield ""


def _by_load(case: Case) -> str:
    return "none" if case.row == "none" else case.load if case.row == "one" else "two loads"


def _by_row(case: Case) -> str:
    return case.row


_TABLES: dict[str, Callable[..., Iterator[str]]] = {
    "Loads": lambda *given: _table(*given, "loads", _by_load),
    "Travel": lambda *given: _table(*given, "travel", _by_row),
    "Supports": lambda *given: _table(*given, "supports", _by_row),
    "Edges of nets and membranes": lambda *given: _table(*given, "edges", _by_row),
    "Runs": lambda *given: _table(*given, "runs", _by_row),
    "Contacts": lambda *given: _table(*given, "contacts", _by_row),
    "Tools": lambda *given: _table(*given, "tools", _by_row),
}
