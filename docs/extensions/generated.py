"""What pages get from the program itself: `<!-- made: NAME -->` becomes the commands, the public names, or a file."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gallery
import make_reference
import typer.main
from pydantic import BaseModel
from scenario_reference import SECTIONS, declarations, placed
from sphinx.application import Sphinx

import ropewalk
from ropewalk.cli.app import app as command_line

ROOT = Path(__file__).parent.parent.parent
CODE = re.compile(r"(?<![`:\w])`([^`]+)`(?!`)")
MARK = re.compile(r"^<!-- made: ([\w.]+) -->$", re.MULTILINE)


def commands() -> str:
    """All commands with their arguments and options."""
    group = typer.main.get_command(command_line)
    with_context = group.make_context("ropewalk", [], resilient_parsing=True)
    return "\n".join(command(name, group.get_command(with_context, name)) for name in group.list_commands(with_context))


def command(name: str, declared: Any) -> str:
    """One command as a section."""
    context = declared.make_context(name, [], resilient_parsing=True)
    usage = " ".join(["ropewalk", name, *declared.collect_usage_pieces(context)])
    rows = [record for option in declared.get_params(context) if (record := row(option, context))]
    table = ["| | |", "|---|---|", *rows, ""] if rows else []
    return "\n".join([f"## `ropewalk {name}`", "", plain(declared.help or ""), "", "```text", usage, "```", "", *table])


def row(option: Any, context: Any) -> str:
    """One argument or option as a row of a table; nothing where it is hidden."""
    if getattr(option, "hidden", False) or option.name == "help":
        return ""
    names, text = option.get_help_record(context) or ("", "")
    return f"| `{escaped(names)}` | {plain(text)} |"


def escaped(text: str) -> str:
    """Text in a cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")


def plain(text: str) -> str:
    """Text of the program as Markdown that reads as it is written."""
    return re.sub(r"([*_<>\[\]])", r"\\\1", escaped(text.replace("\b", "")))


def names() -> str:
    """All public names: declarations, then functions and results, with their docstrings."""
    sections = {title: declarations(modules) for title, modules in SECTIONS.items()}
    home = placed()
    lines = ["## What is declared", "", "Fields are the keys of the file, listed in its reference.", ""]
    for title, listed in sections.items():
        keys = ", ".join(f"[{name}]({home[name]}#{name.lower()})" for name in listed)
        lines += [f"### {title}", "", f"Keys: {keys}.", "", "```{eval-rst}"]
        lines += [*(f".. autoclass:: ropewalk.{name}\n" for name in listed), "```", ""]
    lines += ["## What is called, and what it answers", ""]
    for title, listed in make_reference.FUNCTIONS.items():
        if title not in ("Calculators", "Closed forms"):
            lines += [f"### {title}", "", "```{eval-rst}", *map(directive, listed), "```", ""]
    return "\n".join(lines)


def directive(name: str) -> str:
    """What autodoc is told of a function, a result or an error."""
    value = getattr(ropewalk, name)
    if not isinstance(value, type):
        return f".. autofunction:: ropewalk.{name}\n"
    members = "" if issubclass(value, (Exception, BaseModel)) else "   :members:\n"
    return f".. autoclass:: ropewalk.{name}\n{members}"


def file(name: str) -> Callable[[], str]:
    """A file beside docs/."""
    return (ROOT / name).read_text


MADE: dict[str, Callable[[], str]] = {
    "commands": commands,
    "names": names,
    "trades": gallery.trades,
    **{name: file(name) for name in ("CONTRIBUTING.md", "CHANGELOG.md", "CODE_OF_CONDUCT.md", "SECURITY.md")},
}


def read(_: Sphinx, __: str, source: list[str]) -> None:
    """Put in what a page asks for."""
    source[0] = MARK.sub(lambda mark: MADE[mark[1]](), source[0])


def signature(_: Sphinx, what: str, __: str, value: Any, ___: Any, given: str | None, returns: str | None) -> Any:
    """Declarations are known by their fields, which the reference of the file lists: no list of arguments."""
    if what == "class" and issubclass(value, BaseModel):
        return "", None
    return given, returns


def documented(_: Sphinx, what: str, name: str, value: Any, __: Any, lines: list[str]) -> None:
    """Docstrings are Markdown in their code spans; declarations lead to their keys."""
    if what == "module":
        return
    lines[:] = [marked(line) for line in lines]


def marked(line: str) -> str:
    """A line of a docstring: single backticks are code, bars outside of code are bars."""
    parts = CODE.split(line)
    parts[::2] = [part if "``" in part else part.replace("|", "\\|") for part in parts[::2]]
    parts[1::2] = [f"``{part}``" for part in parts[1::2]]
    return "".join(parts)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register what is done when pages are read."""
    app.connect("source-read", read, priority=100)
    app.connect("autodoc-process-signature", signature)
    app.connect("autodoc-process-docstring", documented, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
