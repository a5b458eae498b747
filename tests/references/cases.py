"""Cases with a reference: the matrix of capabilities, the examples, and capabilities that neither shows."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from zlib import crc32

from conformance.cases import cases as matrix
from conformance.structures import Tree
from ropewalk.results.contract import scenario_text
from ropewalk.scenario import load

from . import additional as more

FOLDER = Path(__file__).parent
ROOT = FOLDER.parent.parent
FAULTS = FOLDER.parent / "cases"
SLOW = ("b-slow-to-compile.yaml",)
"""Inputs of faults that compile kernels of their own."""
SETTINGS = {"footbridge-crowd.yaml": ("run.until=6 s",), "ropeway-tower-speed.yaml": ("run.until=40 s",)}
"""Settings that shorten what takes more than ten seconds."""


@dataclass(frozen=True)
class ReferenceCase:
    """A scenario, as a tree of plain values or as a file, and the tool that answers it."""

    name: str
    source: Tree = field(default_factory=dict)
    tool: str = "run"
    options: Tree = field(default_factory=dict)
    file: str = ""

    @property
    def shard(self) -> int:
        """A number that depends on the name only."""
        return crc32(self.name.encode())

    @property
    def tree(self) -> Tree:
        """The scenario as plain values; of a file in SI, with all defaults."""
        if not self.file:
            return self.source
        scenario = load(ROOT / self.file, SETTINGS.get(Path(self.file).name, ()))
        found: Tree = json.loads(scenario_text(scenario))
        return found


def cases() -> list[ReferenceCase]:
    """Return all cases, the examples first because they take longest."""
    return [*examples(), *additional(), *of_matrix()]


def of_matrix() -> Iterator[ReferenceCase]:
    """Return the cases of the matrix."""
    for case in matrix():
        yield ReferenceCase(case.name, case.scenario, case.tool, case.options)


def examples() -> Iterator[ReferenceCase]:
    """Return every example, shortened where it takes long."""
    for path in sorted((ROOT / "examples").glob("*.yaml")):
        yield ReferenceCase(f"example / {path.stem}", file=str(path.relative_to(ROOT)))


def additional() -> Iterator[ReferenceCase]:
    """Return the additional cases, and the inputs of tests of single faults."""
    for path in sorted(FAULTS.glob("*.yaml")):
        if path.name not in SLOW:
            yield ReferenceCase(f"fault / {path.stem}", file=str(path.relative_to(ROOT)))
    for name, tree, tool, options in more.additional():
        yield ReferenceCase(name, tree, tool, options)


def selected(
    every: Iterable[ReferenceCase], only: Collection[str], without: Collection[str], shard: str
) -> list[ReferenceCase]:
    """Return the cases of a shard "i/n" (from 0) by texts of which their names contain one of the first, and none of
    the others.
    """
    k, n = (int(part) for part in shard.split("/"))
    return [
        case for case in every
        if case.shard % n == k and (not only or any(part in case.name for part in only))
        and not any(part in case.name for part in without)
    ]  # fmt: skip
