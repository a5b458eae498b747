"""Lengths of droppers in the summary of an equilibrium: what they have to be made to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from ropewalk.results.display_units import Column, number

Row = tuple[str, str, str]
_MOST = 12  # rows; JSON and tables have the lengths of all droppers


def length_rows(droppers: Mapping[str, Mapping[str, Any]], say: Column) -> Iterator[Row]:
    """Rows of a table: unstrained lengths of the droppers of each span, equal ones of spans that follow as one row.

    Args:
        droppers: of an overhead line, by names that end in the numbers of the span and of the dropper in it.
        say: numbers in words.
    """
    spans: dict[str, list[str]] = {}
    for name, dropper in droppers.items():
        length = dropper["length"]
        label = number(None if length is None else length / say.length.size)
        spans.setdefault(name.rpartition(".")[0].rpartition(".")[2], []).append(label)
    groups: list[tuple[str, str, str]] = []
    for span, lengths in spans.items():
        text = ", ".join(lengths)
        if groups and groups[-1][2] == text:
            groups[-1] = groups[-1][0], span, text
        else:
            groups.append((span, span, text))
    for first, last, text in groups[:_MOST]:
        where = f"span {first}" if first == last else f"spans {first} to {last}"
        yield f"lengths of droppers, {where}", f"{text.count(',') + 1} in {say.length.symbol}", text
    if len(groups) > _MOST:
        yield "lengths of droppers", "–", f"of {len(groups) - _MOST} more spans: show --json, or -o OUT.csv"
