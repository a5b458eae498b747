"""YAML 1.2 as plain values with line numbers; every duplicate key, tag and odd key is reported."""

from __future__ import annotations

import re
import warnings
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode
from ruamel.yaml.reader import ReaderError

from ropewalk.errors import Problem
from ropewalk.scenario.source import Key, Source, dotted, syntax_error, too_deep

_TAG = "tag:yaml.org,2002:"
# It is read at 7000 lines of keys or 25 000 numbers in a second, and 3 MB of comments.
_MOST_ENTRIES, _MOST_TEXT = 50_000, 16_000_000
_MOST_REPETITIONS = 100_000  # aliases of aliases grow exponentially: stop there

_HINTS = {
    "found character '\\t'": "indent with spaces, not with tabs",
    "mapping values are not allowed": "indent keys of one block equally; put text that holds ': ' in quotes",
    "could not find expected ':'": "write every key as  key: value",
    "expected ',' or ']'": "close the list with ]",
    "expected ',' or '}'": "close the block with }",
    "expected <block end>": "indent keys of one block equally",
    "undefined alias": "define it before with &name",
    "found unexpected end of stream": "close the quotation",
    "expected the node content": "put text that begins with a special character in quotes",
    "expected a single document": "keep one scenario per file: remove the line ---",
    "expected '<document start>'": "indent keys of one block equally",
}


def read_yaml(text: str, name: str) -> Source:
    """Read YAML text.

    Raises:
        ScenarioError: the text is not YAML; problems that leave it readable are kept in the source.
    """
    _refuse_endless(text, name)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # an anchor defined twice
            root = YAML(typ="safe", pure=True).compose(text)
    except RecursionError:
        raise too_deep(text, name) from None
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        if error.context == "while scanning a quoted scalar" and error.context_mark:
            mark = error.context_mark  # where the quotation begins, not where the file ends
        what = " ".join(part for part in (error.context, error.problem) if part)
        hint = next((advice for sign, advice in _HINTS.items() if sign in what), "")
        line = mark.line + 1 if mark else None
        column = f", column {mark.column + 1}" if mark else ""
        raise syntax_error(name, line, f"this is not YAML{column}: {_plain(what)}", hint) from None
    except ReaderError as error:
        line = len(text[: error.position].splitlines()) or 1
        wrong = "this is a control character"
        raise syntax_error(name, line, wrong, "remove it, or check that this is a text file") from None
    except (YAMLError, ValueError, AttributeError, IndexError, TypeError, AssertionError) as error:
        first = str(error).splitlines()[:1]
        raise syntax_error(name, None, f"this is not YAML: {_plain(''.join(first))}") from None
    source = Source(name)
    if root is None:
        return source
    try:
        _Builder(source).build(root)
    except RecursionError:
        raise too_deep(text, name) from None
    return source


def _refuse_endless(text: str, name: str) -> None:
    """Refuse what would take more than seconds to read."""
    entries = text.count("\n") + text.count(",")
    if len(text) > _MOST_TEXT or entries > _MOST_ENTRIES:
        wrong = f"{entries} entries in {len(text) / 1e6:.1f} MB of YAML take too long to read"
        remedy = f"write large tables as JSON; YAML may have {_MOST_ENTRIES} entries in {_MOST_TEXT // 1_000_000} MB"
        raise syntax_error(name, 1, wrong, remedy)


def _plain(what: str) -> str:
    return re.sub(r"\s+", " ", what).strip()[:200]


class _Builder:
    """Turns the nodes of a document into plain values."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.open: list[Node] = []
        self.seen: set[int] = set()
        self.repeated = 0

    def build(self, root: Node) -> None:
        self.source.lines[()] = root.start_mark.line + 1
        self.source.tree = self.value(root, ())

    def problem(self, key: Key, node: Node, wrong: str, remedy: str, given: str = "") -> None:
        line = node.start_mark.line + 1
        self.source.problems.append(Problem(dotted(key), wrong, given, remedy, self.source.name, line))

    def value(self, node: Node, key: Key) -> Any:
        self.repeated += id(node) in self.seen
        self.seen.add(id(node))
        if self.repeated > _MOST_REPETITIONS:
            wrong, remedy = "the aliases repeat more than 100000 values", "write fewer of them"
            raise syntax_error(self.source.name, node.start_mark.line + 1, wrong, remedy)
        if any(node is other for other in self.open):
            self.source.broken.add(key)
            self.problem(key, node, "the alias is inside of the block that it repeats", "write the values out")
            return {}
        if isinstance(node, ScalarNode):
            return self.scalar(node, key)
        kind = "seq" if isinstance(node, SequenceNode) else "map"
        if node.tag != _TAG + kind:
            self.tagged(node, key)
        self.open.append(node)
        try:
            if isinstance(node, SequenceNode):
                return self.sequence(node, key)
            return self.mapping(node, key) if isinstance(node, MappingNode) else None
        finally:
            self.open.pop()

    def sequence(self, node: SequenceNode, key: Key) -> list[Any]:
        values = []
        for index, item in enumerate(node.value):
            self.source.lines[(*key, str(index))] = item.start_mark.line + 1
            values.append(self.value(item, (*key, str(index))))
        return values

    def mapping(self, node: MappingNode, key: Key) -> dict[str, Any]:
        values: dict[str, Any] = {}
        merged: list[Node] = []
        for name_node, value_node in node.value:
            if name_node.tag == _TAG + "merge":
                merged.append(value_node)
                continue
            name = self.name(name_node, key)
            if name is None:
                continue
            at = (*key, name)
            if name in values:
                remedy = f"keep one ({self.source.name}:{self.source.lines[at]})"
                self.problem(at, name_node, "the key occurs twice in this block", remedy)
                continue
            self.source.lines[at] = name_node.start_mark.line + 1
            values[name] = self.value(value_node, at)
        for value_node in merged:
            self.merge(value_node, key, values)
        return values

    def merge(self, node: Node, key: Key, values: dict[str, Any]) -> None:
        """Take over the keys of `<<: *other` that are not written here."""
        nodes = node.value if isinstance(node, SequenceNode) else [node]
        for one in nodes:
            if not isinstance(one, MappingNode) or any(one is other for other in self.open):
                self.problem((*key, "<<"), node, "<< merges the keys of another block", "write <<: *name")
                continue
            self.open.append(one)
            before = dict(self.source.lines)
            for name, value in self.mapping(one, key).items():
                values.setdefault(name, value)  # what is written here counts, and so does its line
            self.source.lines.update(before)
            self.open.pop()

    def name(self, node: Node, key: Key) -> str | None:
        if not isinstance(node, ScalarNode):
            self.problem(key, node, "a key must be a word", "write key: value")
            return None
        if node.tag != _TAG + "str" and node.style is None:
            at = (*key, str(node.value))
            remedy = f'put it in quotes: "{node.value}"'
            self.problem(at, node, "a key must be text", remedy, str(node.value) or "nothing")
        return str(node.value)

    def scalar(self, node: ScalarNode, key: Key) -> Any:
        kind, text = str(node.tag).removeprefix(_TAG), str(node.value)
        try:
            if kind in ("str", "timestamp", "merge", "value"):
                return text
            if kind == "null":
                return None
            if kind == "bool":
                return {"true": True, "yes": True, "on": True}.get(text.lower(), False)
            if kind == "int":
                return _integer(text)
            if kind == "float":
                return float(text.replace("_", "").replace(".inf", "inf").replace(".nan", "nan").lower())
        except ValueError:
            self.source.broken.add(key)
            self.problem(key, node, "cannot be read as a number", "write digits", repr(text[:40]))
            return text
        self.tagged(node, key)
        return text

    def tagged(self, node: Node, key: Key) -> None:
        tag = str(node.tag)
        displayed = "!!" + tag.removeprefix(_TAG) if tag.startswith(_TAG) else tag
        self.source.broken.add(key)
        self.problem(key, node, "tags are not used in scenarios", "remove the tag", displayed)


def _integer(text: str) -> int | float:
    digits = text.replace("_", "").lower()
    sign = -1 if digits.startswith("-") else 1
    digits = digits.lstrip("+-")
    for prefix, base in (("0x", 16), ("0o", 8), ("0b", 2)):
        if digits.startswith(prefix):
            return sign * int(digits[2:], base)
    return sign * int(digits) if len(digits) < 400 else sign * float("inf")
