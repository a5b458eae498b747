"""Lengths of droppers in the summary of an equilibrium: what they have to be made to."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import groupby
from typing import Any

from ropewalk.results.display_units import Column, Row, number

_MOST = 12  # rows; JSON and tables have the lengths of all droppers


def equal_spans(
    droppers: Mapping[str, Mapping[str, Any]], label: Callable[[float | None], str]
) -> list[tuple[str, str, str]]:
    """Return first span, last span and lengths of droppers of each group of adjacent spans with the same ones.

    Args:
        droppers: of an overhead line, by names that end in the numbers of the span and of the dropper in it.
        label: gives the text of a length in m.
    """
    rows = groupby(droppers.items(), key=lambda item: item[0].rpartition(".")[0].rpartition(".")[2])
    texts = [(span, ", ".join(label(dropper["length"]) for _, dropper in own)) for span, own in rows]
    groups = [([span for span, _ in own], text) for text, own in groupby(texts, key=lambda item: item[1])]
    return [(spans[0], spans[-1], text) for spans, text in groups]


def length_rows(droppers: Mapping[str, Mapping[str, Any]], say: Column) -> Iterator[Row]:
    """Rows of a table: unstrained lengths of the droppers of each span, equal ones of spans that follow as one row.

    Args:
        droppers: of an overhead line, by names that end in the numbers of the span and of the dropper in it.
        say: numbers in words.
    """
    size = say.length.size
    groups = equal_spans(droppers, lambda length: number(None if length is None else length / size))
    for first, last, text in groups[:_MOST]:
        where = f"span {first}" if first == last else f"spans {first} to {last}"
        yield f"lengths of droppers, {where}", f"{text.count(',') + 1} in {say.length.symbol}", text
    if len(groups) > _MOST:
        yield "lengths of droppers", "–", f"of {len(groups) - _MOST} more spans: show --json, or -o OUT.csv"
