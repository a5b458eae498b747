"""From a tree of plain values to a scenario, or to the list of everything that is wrong with it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from typing import Any

from pydantic import TypeAdapter, ValidationError
from pydantic_core import ErrorDetails

from ropewalk.errors import Problem, Refused, ScenarioError, did_you_mean, nearest
from ropewalk.model import Dynamic, Line, Load, Run, Scenario
from ropewalk.model._base import Declaration, Finding
from ropewalk.model.consistency import check
from ropewalk.model.joint import Joint
from ropewalk.model.line import contradictions
from ropewalk.model.load import assembled
from ropewalk.model.net import AnyNet
from ropewalk.model.outputs import Outputs
from ropewalk.model.overhead import OverheadLine
from ropewalk.model.parts import Parts
from ropewalk.model.people import with_people
from ropewalk.model.quantity import Acceleration, unit_of
from ropewalk.model.track import Track
from ropewalk.model.wind import Wind
from ropewalk.scenario.fields import block_at, choices_of, known_keys
from ropewalk.scenario.source import Key, Source, displayed, is_within


def validate(source: Source) -> Scenario:
    """Make the scenario.

    Raises:
        ScenarioError: with every problem found, in the order of the file.
    """
    problems = list(source.problems)
    tree = _without_empty(source, source.tree, (), problems)
    scenario: Scenario | None = None
    try:
        scenario = Scenario.model_validate(tree)
    except ValidationError as error:
        problems += _translated(error, source, tree, {problem.key for problem in problems})
    if scenario is None or problems:
        raise ScenarioError(in_order(problems, source.name))
    return scenario


def in_declaration(error: ValidationError, declaration: type[Declaration], keys: dict[str, Any]) -> list[Problem]:
    """Problems of a declaration made in Python, in the words in which a file is told.

    Args:
        error: pydantic's.
        declaration: that was called.
        keys: with which it was called.
    """
    where = "" if declaration is Scenario else declaration.__name__
    found = []
    for detail in error.errors(include_url=False):
        key = _key(detail)
        found.append(Problem(".".join(key), *_words(detail, key, keys, declaration), file=where))
    return list(dict.fromkeys(found))


def in_order(problems: Iterable[Problem], name: str) -> list[Problem]:
    """Sort problems as they stand in the file, overrides last, and drop repetitions."""
    unique = list({(p.file, p.line, p.key, p.wrong): p for p in problems}.values())
    return sorted(unique, key=lambda p: (p.file != name, p.line or 0, _by_index(p.key)))


def _by_index(key: str) -> list[tuple[bool, int, str]]:
    """What keys are sorted by: indices of lists by their value."""
    return [(part.isdigit(), int(part) if part.isdigit() else 0, part) for part in key.split(".")]


def _without_empty(source: Source, value: Any, key: Key, problems: list[Problem]) -> Any:
    """Copy a tree without the keys that were left empty, which are reported."""
    if isinstance(value, list):
        return [_without_empty(source, entry, (*key, str(i)), problems) for i, entry in enumerate(value)]
    if not isinstance(value, dict):
        return value
    kept = {}
    for name, entry in value.items():
        if entry is None and not is_within(key, source.broken):
            remedy = "write a value or remove the key"
            problems.append(source.problem((*key, name), "is empty", remedy=remedy))
        else:
            kept[name] = _without_empty(source, entry, (*key, name), problems)
    return kept


def _translated(error: ValidationError, source: Source, tree: Any, reported: set[str]) -> list[Problem]:
    """Turn pydantic's errors into problems, and add what does not fit together among the valid parts."""
    details = _without_lengths(error.errors(include_url=False))
    meant = _meant(details, tree)
    silent = reported | {".".join(key) for key in meant.values()}
    incomplete, excused = _incomplete_lines(tree, meant, reported)
    found = [(_key(detail), *_words(detail, _key(detail), tree)) for detail in details]
    for finding in (*incomplete, *check(_parts(tree, silent))):
        path = tuple(str(part) for part in finding.path)
        found.append((path, finding.wrong, finding.given, finding.remedy))
    return [
        source.problem(key, *words)
        for key, *words in found
        # a misspelt or empty key is reported as such, not as missing, too
        if not (words[0].startswith("is required") and ".".join(key) in silent)
        and (key, words[0]) not in excused
        and not is_within(key, source.broken)
    ]


def _without_lengths(details: list[ErrorDetails]) -> list[ErrorDetails]:
    """Leave out that a list is too short where its entries are refused: only those accepted were counted."""
    inside = {detail["loc"][:k] for detail in details for k in range(1, len(detail["loc"]))}
    return [detail for detail in details if detail["type"] != "too_short" or detail["loc"] not in inside]


def _key(detail: ErrorDetails) -> Key:
    return tuple(str(part) for part in detail["loc"] if part != "[key]")


def _meant(details: list[ErrorDetails], tree: Any) -> dict[Key, Key]:
    """Map each unknown key to the key of its block that was meant, where that is clear and not written."""
    meant = {}
    for detail in details:
        if detail["type"] == "extra_forbidden":
            key = _key(detail)
            block = block_at(key[:-1], tree)
            close = nearest(key[-1], known_keys(block)) if block else None
            if close is not None:
                meant[key] = (*key[:-1], close)
    return meant


def _words(detail: ErrorDetails, key: Key, tree: Any, start: type[Declaration] = Scenario) -> tuple[str, str, str]:
    """Say what is wrong, what was given and what to do; keys lead from a declaration."""
    kind, context = detail["type"], detail.get("ctx", {})
    given = displayed(detail["input"])
    cause = context.get("error")
    if isinstance(cause, Refused):
        return cause.wrong, given if cause.given is None else cause.given, cause.remedy
    block = block_at(key[:-1], tree, start) if key else None
    keys = known_keys(block) if block else {}
    field = keys.get(key[-1]) if key else None
    if kind == "missing":
        return "is required", "", _addition(key[-1], keys)
    if kind == "extra_forbidden":
        return "unknown key", "", did_you_mean(key[-1], keys)
    if kind == "literal_error" and field is not None:
        word = detail["input"] if isinstance(detail["input"], str) else ""
        return "unknown choice", given, did_you_mean(word, choices_of(field))
    if kind in ("too_short", "too_long"):
        if not detail["input"]:
            return "is empty", "", f"add {field.description if field and field.description else 'an entry'}"
        bound = context.get("min_length", context.get("max_length"))
        count = f"{context.get('actual_length')} entries"
        return (
            "the list has the wrong length",
            count,
            f"write at {kind[4:]} {bound}".replace("short", "least"),
        )
    simple = {
        "string_type": ("expected text", f'put it in quotes: "{detail["input"]}"'),
        "bool_parsing": ("expected true or false", "write true or false"),
        "bool_type": ("expected true or false", "write true or false"),
        "tuple_type": ("expected a list", "write [ ..., ... ]"),
        "dict_type": ("expected a block of named entries", "write  name: {...}  in it"),
        "model_type": ("expected a block of keys", f"write its keys: {_listed(key, tree, start)}"),
    }
    wrong, remedy = simple.get(kind, (re.sub(r"^Input should", "should", detail["msg"]), ""))
    if kind == "string_type" and isinstance(detail["input"], dict | list):
        remedy = "write a word"
    return wrong, given, remedy


def _listed(key: Key, tree: Any, start: type[Declaration]) -> str:
    block = block_at(key, tree, start)
    return ", ".join(name for name in known_keys(block) if name != "kind") if block else "key: value"


def _addition(name: str, keys: dict[str, Any]) -> str:
    field = keys.get(name)
    if field is None:
        return f"add {name}"
    unit = unit_of(field)
    meaning = f" ({field.description}{f', in {unit}' if unit else ''})" if field.description else ""
    return f"add {name}{meaning}"


def _incomplete_lines(
    tree: Any, meant: dict[Key, Key], reported: set[str]
) -> tuple[list[Finding], set[tuple[Key, str]]]:
    """Look for missing and contradicting keys of lines that are not valid, from their names alone.

    Returns them, and those that the line itself has found only because it knows no misspelt or empty keys.
    """
    findings: list[Finding] = []
    excused: set[tuple[Key, str]] = set()
    for name, line in _members(tree, "lines").items():
        if not isinstance(line, dict) or _valid(Line, line) is not None:
            continue
        given = set(line) | {key[-1] for key in meant.values() if key[:2] == ("lines", name)}
        given |= {key.rsplit(".", 1)[1] for key in reported if key.startswith(f"lines.{name}.")}
        law = line.get("law", None if "law" in given else {"kind": "hooke"})
        kind = law.get("kind") if isinstance(law, dict) else None
        if block_at(("law",), {"law": law}, start=Line) is None:
            kind = None
        informed = contradictions(given, kind)
        excused |= {
            (("lines", name, *map(str, found.path)), found.wrong)
            for found in contradictions(set(line), kind or "hooke")
            if found not in informed
        }
        findings += [
            Finding(("lines", name, *found.path), found.wrong, found.given, found.remedy) for found in informed
        ]
    return findings, excused


def _parts(tree: Any, uncertain: set[str]) -> Parts:
    """Collect the valid parts; what hides behind a misspelt or empty key is not known."""
    lines = {name: _valid(Line, line) for name, line in _members(tree, "lines").items()}
    loads = {name: _valid(Load, load) for name, load in _members(tree, "loads").items()}
    on = {
        name: load["on"]
        for name, load in _members(tree, "loads").items()
        if isinstance(load, dict) and isinstance(load.get("on"), str)
    }
    overhead = {name: _valid(OverheadLine, line) for name, line in _members(tree, "overhead_lines").items()}
    nets = {name: _valid(AnyNet, net) for name, net in _members(tree, "nets").items()}
    loads = with_people(loads, lines, overhead, nets)
    on |= {name: load.on for name, load in loads.items() if load is not None}
    tree = tree if isinstance(tree, dict) else {}
    run = _valid(Run, tree["run"]) if "run" in tree else Dynamic(until=1.0)
    gravity = _valid(Acceleration, tree.get("gravity", 9.81))
    if {"run", "loads"} & uncertain:
        run = None
    if "gravity" in uncertain:
        gravity = None
    joints = {name: _valid(Joint, joint) for name, joint in _members(tree, "joints").items()}
    tracks = {name: _valid(Track, track) for name, track in _members(tree, "tracks").items()}
    wind = _valid(Wind, tree["wind"]) if "wind" in tree else None
    outputs = _valid(Outputs, tree.get("outputs", {})) or Outputs()
    complete = not {"lines", "overhead_lines", "nets"} & uncertain and isinstance(tree.get("lines", {}), dict)
    on = on if lines or overhead or nets else {}
    parted = assembled(loads, run)
    on |= {name: load.on for name, load in parted.items() if on and name not in loads}
    return Parts(lines, parted, run, gravity, on, overhead, nets, joints, wind, outputs, complete, tracks)


def _members(tree: Any, name: str) -> dict[str, Any]:
    block = tree.get(name) if isinstance(tree, dict) else None
    return block if isinstance(block, dict) else {}


def _valid(kind: Any, value: Any) -> Any:
    try:
        return _reader(kind).validate_python(value)
    except ValidationError:
        return None


@cache
def _reader(kind: Any) -> TypeAdapter[Any]:
    """What reads one of its kind: made where something is wrong only, for each takes milliseconds."""
    return TypeAdapter(kind)
