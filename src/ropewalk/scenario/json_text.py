"""JSON as plain values with line numbers; duplicate keys are reported."""

from __future__ import annotations

import re
from json import JSONDecodeError
from json.decoder import scanstring  # type: ignore[attr-defined]
from typing import Any

from ropewalk.scenario.source import Key, Source, syntax_error, too_deep

_SPACE = re.compile(r"[ \t\r\n]*")
_NUMBER = re.compile(r"-?(?:0|[1-9]\d*)(\.\d+)?([eE][+-]?\d+)?")
_WORDS = {"true": True, "false": False, "null": None, "NaN": float("nan"), "Infinity": float("inf")}


def read_json(text: str, name: str) -> Source:
    """Read JSON text.

    Raises:
        ScenarioError: the text is not JSON; duplicate keys are kept as problems in the source.
    """
    source = Source(name)
    if not text.strip():
        return source
    try:
        _JsonReader(text, source).document()
    except JSONDecodeError as error:
        wrong = f"this is not JSON, column {error.colno}: {error.msg}"
        raise syntax_error(
            name,
            error.lineno,
            wrong,
            "put keys in double quotes, commas between entries, and close all brackets",
        ) from None
    except RecursionError:
        raise too_deep(text, name) from None
    return source


class _JsonReader:
    """A recursive descent over the text that notes the line of every key and entry."""

    def __init__(self, text: str, source: Source) -> None:
        self.text, self.source = text, source
        self.at, self.line, self.counted = 0, 1, 0

    def document(self) -> None:
        self.space()
        self.source.lines[()] = self.here()
        self.source.tree = self.value(())
        self.space()
        if self.at < len(self.text):
            raise self.error("there is text after the end of the document")

    def error(self, what: str) -> JSONDecodeError:
        return JSONDecodeError(what, self.text, self.at)

    def here(self) -> int:
        self.line += self.text.count("\n", self.counted, self.at)
        self.counted = self.at
        return self.line

    def space(self) -> str:
        """Skip blanks and look at the next character."""
        match = _SPACE.match(self.text, self.at)
        self.at = match.end() if match else self.at
        return self.text[self.at : self.at + 1]

    def value(self, key: Key) -> Any:
        sign = self.space()
        if sign == "{":
            return self.object(key)
        if sign == "[":
            return self.array(key)
        if sign == '"':
            return self.string()
        for word, meaning in _WORDS.items():
            if self.text.startswith(word, self.at):
                self.at += len(word)
                return meaning
        match = _NUMBER.match(self.text, self.at)
        if match is None:
            raise self.error("expected a value here" if sign else "the text ends too early")
        self.at = match.end()
        if match[1] or match[2] or len(match[0]) > 400:
            return float(match[0])
        return int(match[0])

    def string(self) -> str:
        value, self.at = scanstring(self.text, self.at + 1, True)
        return str(value)

    def object(self, key: Key) -> dict[str, Any]:
        values: dict[str, Any] = {}
        self.at += 1
        if self.space() == "}":
            self.at += 1
            return values
        while True:
            if self.space() != '"':
                raise self.error("expected a key in double quotes here")
            line = self.here()
            name = self.string()
            if self.space() != ":":
                raise self.error("expected a colon after the key")
            self.at += 1
            self.member(values, (*key, name), line)
            sign = self.space()
            self.at += 1
            if sign == "}":
                return values
            if sign != ",":
                self.at -= 1
                raise self.error("expected a comma or } here")

    def member(self, values: dict[str, Any], key: Key, line: int) -> None:
        first = self.source.lines.get(key) if key[-1] in values else None
        self.source.lines[key] = line
        if first is None:
            values[key[-1]] = self.value(key)
            return
        remedy = f"keep one ({self.source.name}:{first})"
        self.source.problems.append(self.source.problem(key, "the key occurs twice in this block", remedy=remedy))
        kept = dict(self.source.lines)
        self.value(key)
        self.source.lines = kept | {key: first}

    def array(self, key: Key) -> list[Any]:
        values: list[Any] = []
        self.at += 1
        if self.space() == "]":
            self.at += 1
            return values
        while True:
            self.space()
            at = (*key, str(len(values)))
            self.source.lines[at] = self.here()
            values.append(self.value(at))
            sign = self.space()
            self.at += 1
            if sign == "]":
                return values
            if sign != ",":
                self.at -= 1
                raise self.error("expected a comma or ] here")
