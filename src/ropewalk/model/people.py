"""People: crowds as the single persons that are computed, and what is wrong with those as wrong with their crowd."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from ropewalk.errors import did_you_mean
from ropewalk.model._base import Finding
from ropewalk.model.crowd import Crowd
from ropewalk.model.hangers import unstrained
from ropewalk.model.line import Line


def with_people(loads: Mapping[str, Any], lines: Mapping[str, Line | None]) -> dict[str, Any]:
    """The same loads with every crowd as its people, `crowd.1`, `crowd.2`, ...; None where its line is not known."""
    found: dict[str, Any] = {}
    for name, load in loads.items():
        if not isinstance(load, Crowd):
            found[name] = load
        elif (line := lines.get(load.on)) is None:
            found[name] = None
        else:
            found |= {f"{name}.{i}": one for i, one in enumerate(load.people(unstrained(line)), start=1)}
    return found


def check_crowds(
    loads: Mapping[str, Any], lines: Mapping[str, Line | None], others: Iterable[str]
) -> Iterator[Finding]:
    """Find crowds on what is no line; names of other things to walk on are given."""
    for name, load in loads.items():
        if isinstance(load, Crowd) and load.on not in lines and load.on in others:
            otherwise = "let it walk on one of lines, or write its people one by one"
            remedy = did_you_mean(load.on, [*lines], otherwise=otherwise)
            yield Finding(("loads", name, "on"), "a crowd walks on one of lines", repr(load.on), remedy)


def of_crowds(findings: Iterable[Finding], people: Collection[str]) -> list[Finding]:
    """The same findings, those about loads that are people as of their crowds, for each key of these one."""
    found, known = [], set[tuple[Any, ...]]()
    for finding in findings:
        if finding.path[:1] == ("loads",) and (name := str(finding.path[1])) in people:
            crowd, key = name.partition(".")[0], [k for k in finding.path[2:3] if k in Crowd.model_fields]
            finding = replace(finding, path=("loads", crowd, *key))
            if finding.path in known:
                continue
            known.add(finding.path)
        found.append(finding)
    return found
