"""Keys of a scenario: what stands at them, in which unit, and how they are called in short."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

_WRITTEN = re.compile(r"-?\d\S* (\S+)")  # as declarations write themselves: "10 m/s"


def leaves(tree: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """The single values of a tree of blocks and lists, by their keys."""
    entries = tree.items() if isinstance(tree, Mapping) else enumerate(tree) if isinstance(tree, list | tuple) else None
    if entries is None:
        yield key, tree
        return
    for name, value in entries:
        yield from leaves(value, f"{key}.{name}" if key else str(name))


def unit_at(tree: Mapping[str, Any], key: str) -> str:
    """The SI unit of what stands at a key of a scenario as it writes itself; empty where it is not one quantity."""
    value = dict(leaves(tree)).get(key)
    found = _WRITTEN.fullmatch(value) if isinstance(value, str) else None
    return found[1] if found else ""


def ends_with(key: str, name: str) -> bool:
    """Whether a name is a key, or its last parts."""
    return key == name or key.endswith(f".{name}")


def short_names(keys: Sequence[str], taken: Collection[str] = ()) -> list[str]:
    """The last parts of keys, as few as tell them apart; a number never stands alone."""
    names = [_tail(key, 1) for key in keys]
    for size in range(2, 1 + max(key.count(".") + 1 for key in keys)):
        count = Counter(names)
        names = [
            _tail(key, size) if count[name] > 1 or name in taken else name
            for key, name in zip(keys, names, strict=True)
        ]
    return [key if name in taken else name for key, name in zip(keys, names, strict=True)]


def _tail(key: str, size: int) -> str:
    parts = key.split(".")
    while size < len(parts) and parts[-size].isdecimal():
        size += 1
    return ".".join(parts[-size:])


def overlap(one: Iterable[str], other: Iterable[str]) -> list[str]:
    """Keys of two sets that touch the same thing, whole or in part."""
    others = list(other)
    return [a for a in one if any(a == b or a.startswith(f"{b}.") or b.startswith(f"{a}.") for b in others)]
