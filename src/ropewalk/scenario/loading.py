"""Scenario files in: YAML or JSON text, overrides, and every problem at once."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

from ropewalk.errors import ScenarioError
from ropewalk.model import Scenario
from ropewalk.scenario import overrides as _overrides
from ropewalk.scenario.json_text import read_json
from ropewalk.scenario.problems import validate
from ropewalk.scenario.source import Source, copied, read_text, syntax_error
from ropewalk.scenario.yaml_text import read_yaml


def load(path: str | os.PathLike[str], overrides: Iterable[str] = ()) -> Scenario:
    """Read a scenario file, YAML 1.2 or JSON.

    Args:
        path: the file.
        overrides: values to set before checking, each "key=value" such as "run.until=2 s".

    Raises:
        ScenarioError: the file cannot be read, or the scenario cannot be run; it holds every problem found.
    """
    return loads(read_text(path), os.fspath(path), overrides)


def loads(text: str, name: str = "scenario", overrides: Iterable[str] = ()) -> Scenario:
    """Read a scenario from text, YAML 1.2 or JSON.

    Args:
        text: the scenario.
        name: what to call it in messages; the suffix .json asks for JSON, .yaml and .yml for YAML.
        overrides: values to set before checking, each "key=value" such as "run.until=2 s".

    Raises:
        ScenarioError: the scenario cannot be read or run; it holds every problem found.
    """
    overrides = list(overrides)
    scenario = _changed(_checked(text, name), overrides)
    if not overrides and not text.lstrip().startswith("{"):  # JSON is for programs
        scenario.__dict__["source_text"] = text  # of a property that is cached: scenarios are compared without it
    return scenario


def varying(text: str, name: str = "scenario") -> Callable[[Iterable[str]], Scenario]:
    """Read text once, to make many scenarios of it: the function that is given takes the overrides of one.

    Args:
        text: as for `loads`.
        name: as for `loads`.

    Raises:
        ScenarioError: the text cannot be read.
    """
    source = _checked(text, name)
    return lambda overrides: _changed(_copied(source), overrides)


def _copied(source: Source) -> Source:
    return replace(
        source, tree=copied(source.tree), lines=dict(source.lines), origins=dict(source.origins),
        problems=list(source.problems), broken=set(source.broken),
    )  # fmt: skip


def _checked(text: str, name: str) -> Source:
    """The text as a block of plain values."""
    source = _read(text, name)
    if source.tree is None and not source.problems:
        raise syntax_error(name, 1, "the scenario is empty", "begin with  ropewalk new NAME")
    if not isinstance(source.tree, dict):
        what = "a list" if isinstance(source.tree, list) else "a single value"
        line = source.lines.get(())
        remedy = "write the keys lines, loads and run"
        error = syntax_error(name, line, f"{what} instead of a scenario", remedy)
        raise ScenarioError([*source.problems, *error.problems])
    return source


def _changed(source: Source, overrides: Iterable[str]) -> Scenario:
    for override in overrides:
        _overrides.apply(source, override)
    return validate(source)


def placed(error: ScenarioError, path: str | os.PathLike[str], overrides: Iterable[str] = ()) -> ScenarioError:
    """The same mistakes, found after a scenario was read, with file and line where they are known by their keys.

    Args:
        error: with the mistakes.
        path: the file that was read.
        overrides: as they were given to `load`.
    """
    source = _read(read_text(path), os.fspath(path))
    for override in overrides:
        _overrides.apply(source, override)
    problems = []
    for problem in error.problems:
        if not problem.file and problem.key:
            file, line = source.place(tuple(problem.key.split(".")))
            problem = replace(problem, file=file, line=line)
        problems.append(problem)
    return ScenarioError(problems)


def _read(text: str, name: str) -> Source:
    suffix = Path(name).suffix.lower()
    if suffix == ".json":
        return read_json(text, name)
    if suffix not in (".yaml", ".yml") and text.lstrip().startswith("{"):
        try:
            return read_json(text, name)
        except ScenarioError:
            return read_yaml(text, name)  # a YAML block in braces
    return read_yaml(text, name)
