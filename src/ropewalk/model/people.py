"""People: crowds as the single persons that are computed, and what is wrong with those as wrong with their crowd."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

from ropewalk.model._base import Finding
from ropewalk.model.crowd import Crowd
from ropewalk.model.hangers import unstrained
from ropewalk.model.line import Line
from ropewalk.model.overhead import OverheadLine


def with_people(
    loads: Mapping[str, Any], lines: Mapping[str, Line | None], overhead: Mapping[str, OverheadLine | None],
    nets: Collection[str],
) -> dict[str, Any]:  # fmt: skip
    """The same loads with every crowd as its people, `crowd.1`, `crowd.2`, ...; None where its line is not known."""
    found: dict[str, Any] = {}
    for name, load in loads.items():
        if not isinstance(load, Crowd):
            found[name] = load
            continue
        line, section = lines.get(load.on), overhead.get(load.on)
        if load.on in nets:
            length = sum(math.dist(a, b) for a, b in pairwise(load.path or ()) if len(a) == len(b))
        elif line is not None:
            length = unstrained(line)
        elif section is not None:
            length = section.length
        else:
            found[name] = None
            continue
        found |= {f"{name}.{i}": one for i, one in enumerate(load.people(length), start=1)}
    return found


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
