"""Single values set from outside (`--set run.until=2 s`), on the plain tree before it is checked."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from ropewalk.errors import Problem, ScenarioError, did_you_mean
from ropewalk.scenario.fields import block_at, is_block_of_names, known_keys
from ropewalk.scenario.source import Key, Source, copied, displayed, dotted
from ropewalk.scenario.yaml_text import read_yaml


def apply(source: Source, override: str) -> None:
    """Set one value, written as `key=value`; the value is read as YAML, and null takes the key out.

    A key that cannot be set is kept in the source as a problem.
    """
    name, sign, text = override.partition("=")
    name = name.strip()
    origin = f"--set {name}"
    key = tuple(name.split("."))
    try:
        if not sign or not all(key):
            raise _Unset("this is not key=value", override, "write for example --set run.until=2s")
        if not text.strip():
            raise _Unset("no value is given", remedy="write a value, or null to remove the key")
        value = _value(text, origin)
        block, last = _holder(source, key)
        _put(source, block, key, last, value)
    except _Unset as error:
        source.problems.append(Problem(name, error.wrong, error.given, error.remedy, origin))
    except ScenarioError as error:
        source.problems += [Problem(name, p.wrong, p.given, p.remedy, origin) for p in error.problems]
    else:
        for kept in [at for at in (*source.lines, *source.origins) if at[: len(key)] == key]:
            source.lines.pop(kept, None)
            source.origins.pop(kept, None)
        source.problems = [p for p in source.problems if p.key != name or p.file != source.name]
        if value is not None:
            source.origins[key] = origin


class _Unset(Exception):
    """An override that cannot be applied."""

    def __init__(self, wrong: str, given: str = "", remedy: str = "") -> None:
        self.wrong, self.given, self.remedy = wrong, given, remedy
        super().__init__(wrong)


def _value(text: str, origin: str) -> Any:
    return copied(_read(text.strip(), origin))


@lru_cache(maxsize=1024)
def _read(text: str, origin: str) -> Any:
    """A value as it is written; sweeps give the same ones again and again."""
    read = read_yaml(text, origin)
    if read.problems:
        raise ScenarioError(read.problems)
    return read.tree


def _holder(source: Source, key: Key) -> tuple[Any, str]:
    """Find the block or list that holds a key; blocks that the file may have but leaves out are added."""
    block = source.tree
    for depth, part in enumerate(key[:-1]):
        at = key[: depth + 1]
        _check_known(source, block, at, inner=True)
        if isinstance(block, list):
            block = block[int(part)]
        else:
            if block.get(part) is None:
                block[part] = {}
                source.origins[at] = f"--set {dotted(key)}"
            block = block[part]
    _check_known(source, block, key, inner=False)
    return block, key[-1]


def _check_known(source: Source, block: Any, key: Key, *, inner: bool) -> None:
    """Refuse a key that its block cannot have."""
    part, outer = key[-1], key[:-1]
    if isinstance(block, list):
        if not part.isdecimal() or int(part) >= len(block):
            raise _Unset("the index is out of range", part, f"{dotted(outer)} has the entries 0 to {len(block) - 1}")
        return
    if not isinstance(block, dict):
        raise _Unset(f"{dotted(outer)} is a value, not a block", displayed(block), f"set {dotted(outer)} itself")
    if part in block:
        return
    if is_block_of_names(outer, source.tree):
        if inner:
            raise _Unset(f"unknown key {part} in {dotted(outer)}", remedy=did_you_mean(part, block))
        return
    declaration = block_at(outer, source.tree)
    if declaration is not None and part not in known_keys(declaration):
        remedy = did_you_mean(part, known_keys(declaration))
        raise _Unset(f"unknown key {part}", remedy=remedy)


def _put(source: Source, block: Any, key: Key, last: str, value: Any) -> None:
    if isinstance(block, list):
        if value is None:
            raise _Unset("an entry of a list cannot be removed", remedy=f"set {dotted(key[:-1])} itself")
        block[int(last)] = value
    elif value is None:
        block.pop(last, None)
    else:
        block[last] = value
