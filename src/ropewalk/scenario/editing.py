"""Values changed in the text of a scenario file: comments, order and all else stay as they were written."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.nodes import MappingNode, Node, SequenceNode

from ropewalk.errors import ScenarioError
from ropewalk.model.writing import dump
from ropewalk.scenario.loading import loads

_BARE = re.compile(r"-?[\w.+-]+( [\w/*^]+)?", re.ASCII)


def edited(text: str, name: str, overrides: Iterable[str]) -> str:
    """Set values in a text.

    Where that cannot be done in place (JSON, aliases, keys that `<<` brings), the whole scenario is written anew, and
    says so in its first line.

    Args:
        text: of a scenario file.
        name: of it, as for `loads`.
        overrides: "key=value", as for `loads`.

    Raises:
        ScenarioError: the scenario with these values cannot be.
    """
    overrides = list(overrides)
    wanted = loads(text, name, overrides)
    changed: str | None = text
    for override in overrides:
        key, _, value = override.partition("=")
        changed = changed if changed is None else _set(changed, key.strip().split("."), value.strip())
    try:
        if changed is not None and loads(changed, name) == wanted:
            return changed
    except ScenarioError:
        pass
    return f"# {name}, written anew\n{dump(wanted)}"


def _set(text: str, key: list[str], value: str) -> str | None:
    """One value in place, None if its place cannot be found."""
    value = value if _BARE.fullmatch(value) or value[:1] in '[{"' else f'"{value}"'
    node: Node | None = YAML(typ="safe", pure=True).compose(text)
    for depth, part in enumerate(key):
        inner = _within(node, part)
        if inner is None:
            if isinstance(node, MappingNode) and node.value:
                return _added(text, node, key[depth:], value)
            return None
        node = inner
    assert node is not None
    begin, end = node.start_mark.index, node.end_mark.index
    if isinstance(node, MappingNode | SequenceNode) and not node.flow_style:
        return None
    return text[:begin] + value + text[end:]


def _within(node: Any, part: str) -> Node | None:
    if isinstance(node, MappingNode):
        return next((inner for name, inner in node.value if name.value == part), None)
    if isinstance(node, SequenceNode) and part.isdecimal() and int(part) < len(node.value):
        found: Node = node.value[int(part)]
        return found
    return None


def _added(text: str, node: MappingNode, key: list[str], value: str) -> str:
    """A key that a block did not have, before its first one."""
    first: int = node.value[0][0].start_mark.index
    entry = value
    for part in reversed(key[1:]):
        entry = f"{{{part}: {entry}}}"
    indent = text[text.rfind("\n", 0, first) + 1 : first]
    return f"{text[:first]}{key[0]}: {entry}{', ' if node.flow_style else chr(10) + indent}{text[first:]}"
