"""Cases with a reference: the matrix of capabilities, the examples, and capabilities that neither shows."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from zlib import crc32

from conformance.cases import cases as matrix
from conformance.structures import Tree
from ropewalk.results.contract import scenario_text
from ropewalk.scenario import load
from ropewalk.scenario.yaml_text import read_yaml

FOLDER = Path(__file__).parent
EXAMPLES = FOLDER.parent.parent / "examples"

SETTINGS: dict[str, tuple[str, ...]] = json.loads((FOLDER / "examples.json").read_text(encoding="utf-8"))
"""Settings that shorten an example, so that it takes at most about ten seconds; an empty list runs it as it is."""


@dataclass(frozen=True)
class ReferenceCase:
    """A scenario, as a tree of plain values or as the file of an example, and the tool that answers it."""

    name: str
    source: Tree = field(default_factory=dict)
    tool: str = "run"
    options: Tree = field(default_factory=dict)
    example: str = ""

    @property
    def shard(self) -> int:
        """A number that depends on the name only."""
        return crc32(self.name.encode())

    @property
    def tree(self) -> Tree:
        """The scenario as plain values; of an example in SI, with all defaults."""
        if not self.example:
            return self.source
        scenario = load(EXAMPLES / self.example, SETTINGS.get(self.example, ()))
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
    for path in sorted(EXAMPLES.glob("*.yaml")):
        yield ReferenceCase(f"example / {path.stem}", example=path.name)


def additional() -> Iterator[ReferenceCase]:
    """Return the cases of `additional.yaml`: capabilities that the matrix and the examples do not show."""
    file = FOLDER / "additional.yaml"
    tree: Any = read_yaml(file.read_text(encoding="utf-8"), file.name).tree
    bases: dict[str, Tree] = tree["bases"]
    for name, case in tree["cases"].items():
        own = {key: value for key, value in case.items() if key not in ("base", "tool", "options")}
        scenario = _merged(bases[case["base"]], own) if "base" in case else own
        yield ReferenceCase(f"additional / {name}", scenario, case.get("tool", "run"), case.get("options", {}))


def _merged(base: Any, changes: Any) -> Any:
    """Return a tree with changes; None removes a key."""
    if not (isinstance(base, dict) and isinstance(changes, dict)):
        return changes
    found = {**base, **{key: _merged(base.get(key), value) for key, value in changes.items()}}
    return {key: value for key, value in found.items() if value is not None}


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
