"""The code blocks of a page of the documentation, and how they are done: as a reader would, one after the other.

A block with a `:caption:` is a file of that name, or what changes in it; every line of a `shell` block is a command; a
`python` block goes on where the one before ended; a `text` block after commands or Python is an extract of what they
print; any other `yaml` block is a scenario, or a part that is put into one, and is checked. Of a `console` block (what
sets up a machine, takes long or never ends) commands are parsed, and not run. What a page takes for granted stands in
`surroundings.py`.
"""

from __future__ import annotations

import contextlib
import io
import json
import re
import shlex
import subprocess
import sys
import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import click
import typer.main
from markdown_it import MarkdownIt
from ruamel.yaml import YAML
from typer.testing import CliRunner

from ropewalk.cli.app import app
from ropewalk.errors import ScenarioError
from ropewalk.scenario import load

CAPTION = re.compile(r":caption: (.*)\n")
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
CODE = re.compile(r"\s+# exit code (\d+)$")
TARGET = re.compile(r"^([\w-]+):", re.MULTILINE)
CLOSE = 0.01
"""How far printed numbers may be from those of the page: other processors round otherwise, and waves spread that."""

Told = TypeVar("Told")
ROOT = Path(__file__).parents[2]
COMMANDS: click.Group = typer.main.get_command(app)  # type: ignore[assignment]


@dataclass(frozen=True)
class Block:
    """A block: its language, its caption if it has one, its text, and the line of the page where it begins."""

    language: str
    caption: str
    text: str
    line: int

    def of(self, told: dict[str, Told]) -> Told | None:
        """What is told of the block that begins so."""
        return next((told[begin] for begin in told if self.text.strip().startswith(begin)), None)


@dataclass(frozen=True)
class Part:
    """What a part of a scenario is put into: an example or a text, and where in it."""

    base: str
    place: str = ""


@dataclass(frozen=True)
class Surroundings:
    """What a page takes for granted: files, what parts are parts of, and what a test does in a smaller way.

    Files are by their names, what is shorter by the text that is replaced, all else by how the block begins.
    """

    files: dict[str, str | bytes]
    captions: dict[str, str]
    parts: dict[str, Part]
    shorter: dict[str, str]
    unseen: dict[str, str]


def blocks(page: Path) -> list[Block]:
    """All code blocks of a page but directives of the site; one that is only set in has no language."""
    tokens = MarkdownIt("commonmark").parse(page.read_text(encoding="utf-8"))
    found = [
        block(one.info, one.content, (one.map or [0])[0] + 1) for one in tokens if one.type in ("fence", "code_block")
    ]
    return [one for one in found if not one.language.startswith("{")]


def block(info: str, text: str, line: int) -> Block:
    """A block, as Markdown has it or as the site has it, with options."""
    directive = re.fullmatch(r"\{code-block\} (\w+)", info)
    caption = CAPTION.match(text) if directive else None
    rest = text[caption.end() :] if caption else text
    return Block(directive[1] if directive else info, caption[1] if caption else "", rest, line)


def follow(page: Path, folder: Path, around: Surroundings) -> None:
    """Do what a page says, in a folder where the process already is.

    Raises:
        AssertionError: something is not as the page says.
    """
    for name, text in around.files.items():
        (folder / name).write_bytes(text if isinstance(text, bytes) else base_text(text, folder).encode())
    printed, names = "", dict[str, Any]({"__name__": "page"})
    for block in blocks(page):
        where, text = f"{page.name}:{block.line}", block.text
        for old, new in around.shorter.items():
            text = text.replace(old, new)
        caption = block.caption or block.of(around.captions)
        of = block.of(around.parts)
        if caption:
            whole = json.dumps(put(YAML().load(base_text(of.base, folder)), [], YAML().load(text))) if of else text
            (folder / caption).write_text(whole, encoding="utf-8")
        elif block.language == "shell":
            printed = "".join(command(line, where) for line in joined(text))
        elif block.language == "console":
            for line in joined(text):
                parse(line.removeprefix("$ "), where)
        elif block.language == "python" and block.of(around.unseen):
            compile(text, where, "exec")
        elif block.language == "python":
            with contextlib.redirect_stdout(io.StringIO()) as caught:
                exec(compile(text, where, "exec"), names)
            printed = caught.getvalue()
        elif block.language == "yaml":
            part(text, of, folder, where)
        elif block.language == "text" and printed and not block.of(around.unseen):
            missing = [line for line in text.splitlines() if line.strip() and not stands_in(line, printed)]
            assert not missing, f"{where}: not printed: {missing}\n{printed}"


def joined(text: str) -> list[str]:
    """The commands of a block; a backslash at its end continues a line."""
    return [line for line in text.replace("\\\n", " ").splitlines() if line.strip()]


def command(line: str, where: str) -> str:
    """What a command prints; it must end as the page says, with exit code 0 if it does not say."""
    wanted = CODE.search(line)
    program, *arguments = shlex.split(CODE.sub("", line), comments=True)
    if program == "pythonfmu":
        return subprocess.run(
            [sys.executable, "-m", program, *arguments], check=True, capture_output=True, text=True
        ).stdout
    assert program == "ropewalk", f"{where}: {line}"
    found = CliRunner().invoke(app, arguments)
    assert found.exit_code == int(wanted[1] if wanted else 0), f"{where}: {line}\n{found.output}"
    return found.output


def parse(line: str, where: str) -> None:
    """See whether the command line knows a command and its options, and the Makefile its target.

    Raises:
        AssertionError: it does not.
    """
    program, *arguments = shlex.split(line, comments=True)
    if program == "make":
        targets = TARGET.findall((ROOT / "Makefile").read_text(encoding="utf-8"))
        unknown = [one for one in arguments if "=" not in one and one not in targets]
        assert not unknown, f"{where}: no such target: {unknown}"
    if program != "ropewalk":
        return
    try:
        above = COMMANDS.make_context("ropewalk", [], resilient_parsing=True)
        arguments = COMMANDS.make_parser(above).parse_args(arguments)[1]
        if not arguments or arguments[0] == "COMMAND":
            return
        name, called, arguments = COMMANDS.resolve_command(above, arguments)
        assert called, f"{where}: no such command: {line}"
        context = called.make_context(name, [], resilient_parsing=True)
        left = called.make_parser(context).parse_args(arguments)[1]
    except click.UsageError as error:
        raise AssertionError(f"{where}: {line}: {error.format_message()}") from None
    assert set(left) <= {"..."}, f"{where}: {line}: too much: {left}"


def part(text: str, of: Part | None, folder: Path, where: str) -> None:
    """Check a scenario, or parts of one, each of which is put where it belongs."""
    for one in alternatives(textwrap.dedent(text)):
        whole = put(YAML().load(base_text(of.base, folder)), of.place.split("."), one) if of else one
        (folder / "part.yaml").write_text(json.dumps(whole), encoding="utf-8")
        try:  # read and held against what works, as by `check`, which would go on to the beginning of its run
            load(folder / "part.yaml")
        except ScenarioError as mistakes:
            raise AssertionError(f"{where}: {mistakes}") from None


def base_text(base: str, folder: Path) -> str:
    """The file that the page has written, or the example of a name; any other text is one itself."""
    if "\n" in base:
        return base
    written = folder / base
    return (written if written.is_file() else ROOT / "examples" / f"{base}.yaml").read_text(encoding="utf-8")


def alternatives(text: str) -> list[Any]:
    """The parts of a block: a key that comes again at its margin begins another one."""
    first = text.split(":", 1)[0]
    pieces = re.split(rf"^(?={re.escape(first)}:)", text, flags=re.MULTILINE)
    return [YAML().load(piece) for piece in pieces if piece]


def put(whole: Any, place: list[str], one: Any) -> Any:
    """The base with a part in its place: what the part says, and of the rest what it leaves out."""
    if place and place[0]:
        return {**whole, place[0]: put(whole[place[0]], place[1:], one)}
    if not isinstance(one, dict) or not isinstance(whole, dict) or ("kind" in one and "..." not in one):
        return one
    said = {key: put(whole.get(key), [], value) for key, value in one.items() if key != "..."}
    return {**whole, **said}


def stands_in(line: str, printed: str) -> bool:
    """Whether a line was printed, with other blanks and numbers that are close."""
    return any(same(line, other) for other in printed.splitlines())


def same(one: str, other: str) -> bool:
    """Whether two lines have the same words, and numbers that are close."""
    if NUMBER.sub("#", " ".join(one.split())) != NUMBER.sub("#", " ".join(other.split())):
        return False
    pairs = zip(NUMBER.findall(one), NUMBER.findall(other), strict=True)
    return all(abs(float(a) - float(b)) <= CLOSE * max(abs(float(a)), abs(float(b))) for a, b in pairs)
