"""Capabilities: what an engine supports, declared by the engine in the words of scenarios."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from ropewalk.errors import Problem, ScenarioError
from ropewalk.model._base import Declaration, Finding, Path
from ropewalk.model.missing import missing
from ropewalk.model.parts import Parts
from ropewalk.model.quantity import unit_of

_DECIDES = {"kind": "", "contact": "friction"}
"""Keys without whose value other keys of the same block, which begin so, are not looked at."""

LAWS_OF_STRAIN = ("hooke", "tension_only", "second_piola_kirchhoff", "polynomial", "table", "webbing")
"""Axial laws by which tension follows from strain."""
STATIC_LOADS = ("force", "axles", "mass", "oscillator", "trolley", "vehicle", "train", "matrices")
"""Kinds of loads that stand still, too."""
WITHOUT_KIND = "ask for kind: dynamic, or write kind: force with its weight as force"
"""Remedy for a kind of load that is not supported."""
OF_LINEAR_THEORY: Mapping[str, tuple[Any, ...]] = {
    "loads.kind": ("force", "axles", "mass", "oscillator", "vehicle", "train", "matrices"),
    "loads.travel.kind": ("prescribed",),
    "loads.travel.margin": (None,),
    "loads.contact": ("clamped", "frictionless"),
    "loads.friction": (None,),
    "loads.friction_model": ("capstan",),
    "loads.contact_stiffness": (None,),
    "loads.air_drag": (0.0,),
}
"""What the linear theory supports of loads, by closed forms as by modes."""


@dataclass(frozen=True)
class Capabilities:
    """What an engine supports of what a scenario can say.

    Args:
        what: what it computes, as messages name it.
        only: of a key, the values that it supports: `loads.travel.measured` is that key of every load that has it. Of
            other keys it supports all values. `kind` stands before other keys of its block, `contact` before friction.
        instead: of a key, what to write instead, where that is more than to leave it out or to write one of the values.
        more: what is not a matter of one key.
    """

    what: str
    only: Mapping[str, tuple[Any, ...]]
    instead: Mapping[str, str] = field(default_factory=dict)
    more: tuple[Callable[[Parts], Iterator[Finding]], ...] = ()

    def unsupported(self, parts: Parts) -> Iterator[Finding]:
        """Find what of a scenario is not implemented."""
        yield from self._keys("run", ("run",), parts.run)
        for block, members in (("lines", parts.lines), ("loads", parts.loads)):
            for name, member in members.items():
                yield from self._keys(block, (block, name), member)
        for look in self.more:
            yield from look(parts)

    @cached_property
    def _of_blocks(self) -> dict[str, list[tuple[str, list[str], tuple[Any, ...]]]]:
        """By blocks: keys, their parts within the block, and the values."""
        found = dict[str, list[tuple[str, list[str], tuple[Any, ...]]]]()
        for key, values in self.only.items():
            block, *inner = key.split(".")
            found.setdefault(block, []).append((key, inner, values))
        return found

    def _keys(self, block: str, path: Path, declaration: Declaration | None) -> Iterator[Finding]:
        refused: list[str] = []
        for key, inner, values in self._of_blocks.get(block, ()) if declaration is not None else ():
            if refused and key.startswith(tuple(refused)):
                continue
            owner: Any = declaration
            for part in inner[:-1]:
                owner = getattr(owner, part, None)
            if not hasattr(owner, inner[-1]) or (value := getattr(owner, inner[-1])) in values:
                continue
            if inner[-1] in _DECIDES:
                refused.append(key.removesuffix(inner[-1]) + _DECIDES[inner[-1]])
            known = type(owner).model_fields[inner[-1]]
            remedy = self.instead.get(key) or (f"write {_or(values)}" if isinstance(value, str) else "leave it out")
            yield missing((*path, *inner), self.what, _displayed(value, unit_of(known)), remedy)


def without_retardation(what: str, remedy: str) -> Callable[[Parts], Iterator[Finding]]:
    """Make the check for lines whose damping grows with their stiffness, where that is not implemented."""

    def look(parts: Parts) -> Iterator[Finding]:
        for name, line in parts.lines.items():
            if line is not None and line.beta:
                key, given = ("damping", "two frequencies") if line.damping is not None else ("retardation", "")
                feature = "damping in proportion to stiffness"
                yield missing(("lines", name, key), what, given or f"{line.beta:g} s", remedy, feature=feature)

    return look


def supported_by_tension(parts: Parts) -> Iterator[Finding]:
    """Find stiff lines on inner supports whose length is still to be found: where their nodes are is not known."""
    for name, line in parts.lines.items():
        if (
            line is not None
            and line.supports
            and line.length is None
            and (line.has_bending_stiffness or parts.has_bending_stiffness)
        ):
            feature, remedy = "a tension instead of the length", "give length (unstrained, in m)"
            what = "lines with bending stiffness or foundation on inner supports"
            yield missing(("lines", name, "tension"), what, f"{line.tension:g} N", remedy, feature=feature)


def refusal(finding: Finding) -> ScenarioError:
    """The error of what is found out only while a scenario is computed, to be raised."""
    key = ".".join(map(str, finding.path))
    return ScenarioError([Problem(key, finding.wrong, finding.given, finding.remedy)])


def _or(values: tuple[Any, ...]) -> str:
    *first, last = map(str, values)
    return f"{', '.join(first)} or {last}" if first else last


def _displayed(value: Any, unit: str) -> str:
    if isinstance(value, str | bool):
        return str(value) if isinstance(value, str) else str(value).lower()
    return f"{value:g}" if unit in ("", "dimensionless") else f"{value:g} {unit}"
