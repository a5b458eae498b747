"""The page: what was computed, both numbers, their difference, the tolerance and its reason."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape
from typing import Any

import ropewalk
from ropewalk.validation.known_case import KnownCase
from ropewalk.validation.known_number import KnownNumber
from ropewalk.validation.registry import GROUPS
from ropewalk.validation.row_result import AGREES, DIFFERS, FAILED, MISSING, VERDICTS, RowResult

TITLE = "Validation"
INTRODUCTION = (
    "Every row is a number that is known from a book, a standard, another program or another route, and the same "
    "number as this version computes it. `ropewalk validate` makes this page, on any machine and without the "
    "repository: no number of the column *ours* is written down anywhere. `--only` chooses rows by name, `--list` "
    "lists them, `--json` prints them. Exit codes: 0 all rows that were computed agree, 3 one could not be computed, "
    "4 one differs.",
    "A row differs if the difference is above its tolerance, or if the observed order of convergence is below the one "
    "that is expected. References are computed by `ropewalk.theory`, which the engines do not know, unless a published "
    "number stands there. *Citation checked* means that title, authors and place of a publication were compared with a "
    "second source, not that its numbers were; where nothing was found the citation is from memory and says so.",
    "Every row has a fault: a change of its scenario, most by a few percent, that must make it differ. "
    "`ropewalk validate --faults` computes all rows with their faults, and its exit code is 0 if all of them differ; "
    "the tests do so with the rows of `--quick`.",
)
HEAD = ("row", "what", "reference", "ours", "difference", "verdict", "allowed, and why")


def number(value: float) -> str:
    """With six digits; empty if there is none."""
    return "" if math.isnan(value) else f"{value:.6g}"


def reference_of(finding: RowResult) -> str:
    """The number, or both ends of the range."""
    if finding.low == finding.high or math.isnan(finding.low):
        return number(finding.low)
    return f"{number(finding.low)} to {number(finding.high)}"


def as_dict(found: Sequence[RowResult]) -> dict[str, Any]:
    """All there is to say, as plain values."""
    by_id = {finding.id: finding for finding in found}
    rows = []
    for group, case, row in _rows():
        if (finding := by_id.get(f"{case.id}.{row.name}")) is not None:
            about = {"group": group, "case": case.what, "what": row.what, "unit": row.unit, "kind": row.kind}
            source = {"source": case.source.text, "citation_checked": case.source.seen, "tolerance": row.reason}
            rows.append(finding.as_dict() | about | source)
    return {"ropewalk": ropewalk.__version__, "rows": rows, "verdicts": _counts(found)}


def markdown(found: Sequence[RowResult]) -> str:
    """The page as Markdown."""
    lines = [f"# {TITLE}", "", *(f"{text}\n" for text in INTRODUCTION), _total(found), ""]
    lines += [_line(("what", "rows", *VERDICTS)), _line(("---",) * (2 + len(VERDICTS)))]
    lines += [_line(cells) for cells in _overview(found)]
    for group, cases in _grouped(found):
        lines += ["", f"## {group}"]
        for case, rows in cases:
            lines += ["", f"### {case.what}", "", _source(case), ""]
            lines += [_line(HEAD), _line(("---",) * len(HEAD))]
            lines += [_line(_cells(case, row, finding)) for row, finding in rows]
    return "\n".join([*lines, ""])


def html(found: Sequence[RowResult]) -> str:
    """The page as HTML that needs nothing else."""
    body = [f"<h1>{escape(TITLE)}</h1>", *(f"<p>{escape(text)}</p>" for text in INTRODUCTION)]
    body += [f"<p>{escape(_total(found))}</p>", "<table>", _tagged("th", ("what", "rows", *VERDICTS), "")]
    body += [*(_tagged("td", cells, "") for cells in _overview(found)), "</table>"]
    for group, cases in _grouped(found):
        body.append(f"<h2>{escape(group)}</h2>")
        for case, rows in cases:
            body += [f"<h3>{escape(case.what)}</h3>", f"<p>{escape(_source(case))}</p>", "<table>"]
            body.append(_tagged("th", HEAD, ""))
            body += [_tagged("td", _cells(case, row, one), one.verdict.replace(" ", "-")) for row, one in rows]
            body.append("</table>")
    style = (
        "body{font:16px/1.5 sans-serif;max-width:80em;margin:2em auto;padding:0 1em}"
        "table{border-collapse:collapse;display:block;overflow-x:auto}td,th{border:1px solid #ccc;padding:.2em .5em;"
        "text-align:left;vertical-align:top}.differs,.failed{background:#fdd}.not-computed{color:#777}"
    )
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(TITLE)}</title>'
        f"<style>{style}</style></head>\n<body>\n" + "\n".join(body) + "\n</body></html>\n"
    )


def said_of(found: Sequence[RowResult]) -> str:
    """How many there are of each verdict, in words."""
    one = {AGREES: "agrees", DIFFERS: "differs", FAILED: "failed", MISSING: "not computed"}
    many = one | {AGREES: "agree", DIFFERS: "differ"}
    return ", ".join(f"{n} {(one if n == 1 else many)[verdict]}" for verdict, n in _counts(found).items() if n)


def _rows() -> list[tuple[str, KnownCase, KnownNumber]]:
    return [(group, case, row) for group, cases in GROUPS.items() for case in cases for row in case.rows]


def _grouped(
    found: Sequence[RowResult],
) -> list[tuple[str, list[tuple[KnownCase, list[tuple[KnownNumber, RowResult]]]]]]:
    """What was found by group and case."""
    by_id = {finding.id: finding for finding in found}
    groups = []
    for group, cases in GROUPS.items():
        inside = []
        for case in cases:
            rows = [(row, by_id[key]) for row in case.rows if (key := f"{case.id}.{row.name}") in by_id]
            if rows:
                inside.append((case, rows))
        if inside:
            groups.append((group, inside))
    return groups


def _overview(found: Sequence[RowResult]) -> list[tuple[str, ...]]:
    """Counts of each group."""
    inside = {group: [one for _, rows in cases for _, one in rows] for group, cases in _grouped(found)}
    return [
        (group, str(len(rows)), *(str(many or "") for many in _counts(rows).values()))
        for group, rows in inside.items()
    ]  # fmt: skip


def _source(case: KnownCase) -> str:
    """Where the numbers of a case are from, and what they are."""
    return f"Source: {case.source}. Reference: {case.rows[0].kind}."


def _counts(found: Sequence[RowResult]) -> dict[str, int]:
    return {verdict: sum(one.verdict == verdict for one in found) for verdict in VERDICTS}


def _total(found: Sequence[RowResult]) -> str:
    return f"ropewalk {ropewalk.__version__}, {len(found)} rows: {said_of(found)}."


def _cells(case: KnownCase, row: KnownNumber, finding: RowResult) -> tuple[str, ...]:
    unit = f" {row.unit}" if row.unit else ""
    allowed = "" if math.isnan(finding.allowed) else f"{finding.allowed:.2g}{unit}: "
    apart = "" if math.isnan(finding.ours) else f"{finding.difference:.1e}{unit}"
    if not math.isnan(finding.ours) and finding.low == finding.high != 0.0:
        apart += f" ({100.0 * finding.difference / abs(finding.low):+.3f} %)"
    if not math.isnan(finding.order):
        apart += f", order {finding.order:.1f}"
    return (
        f"{case.id}.{row.name}", row.what, f"{reference_of(finding)}{unit}" if finding.low == finding.low else "",
        f"{number(finding.ours)}{unit}" if finding.ours == finding.ours else "", apart,
        finding.verdict, f"{allowed}{row.reason}",
    )  # fmt: skip


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _tagged(tag: str, cells: Sequence[str], kind: str) -> str:
    inside = "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells)
    return f'<tr class="{kind}">{inside}</tr>' if kind else f"<tr>{inside}</tr>"
