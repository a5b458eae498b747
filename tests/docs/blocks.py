"""The code blocks of a page of the documentation, and how they are done: as a reader would, one after the other.

A block with a `:caption:` is a file of that name; every line of a `shell` block is a command; a `python` block
goes on where the one before ended; a `text` block after commands is an extract of what they print. Blocks of any other
kind (`console`: what sets up a machine or takes long) are read only.
"""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from typer.testing import CliRunner

from ropewalk.cli.app import app

FENCE = re.compile(r"^```(?:\{code-block\} )?(\w+)\n((?::\w+:[^\n]*\n)*)(.*?)^```$", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
CODE = re.compile(r"\s+# exit code (\d+)$")
CLOSE = 0.01
"""How far printed numbers may be from those of the page: other processors round otherwise, and waves spread that."""


@dataclass(frozen=True)
class Block:
    """A block: its language, its caption if it has one, its text, and the line of the page where it begins."""

    language: str
    caption: str
    text: str
    line: int


def blocks(page: Path) -> list[Block]:
    """All blocks of a page."""
    source = page.read_text(encoding="utf-8")
    return [
        Block(found[1], found[2].partition(":caption:")[2].strip(), found[3], source.count("\n", 0, found.start()) + 1)
        for found in FENCE.finditer(source)
    ]


def follow(page: Path, folder: Path) -> None:
    """Do what a page says, in a folder where the process already is.

    Raises:
        AssertionError: something is not as the page says.
    """
    printed, names = "", dict[str, Any]({"__name__": "page"})
    for block in blocks(page):
        where = f"{page.name}:{block.line}"
        if block.caption:
            (folder / block.caption).write_text(block.text, encoding="utf-8")
        elif block.language == "shell":
            printed = "".join(command(line, where) for line in joined(block.text))
        elif block.language == "python":
            exec(compile(block.text, where, "exec"), names)
        elif block.language == "text" and printed:
            missing = [line for line in block.text.splitlines() if line.strip() and not stands_in(line, printed)]
            assert not missing, f"{where}: not printed: {missing}\n{printed}"


def joined(text: str) -> list[str]:
    """The commands of a block; a backslash at its end continues a line."""
    return [line for line in text.replace("\\\n", " ").splitlines() if line.strip()]


def command(line: str, where: str) -> str:
    """What a command prints; it must end as the page says, with exit code 0 if it does not say."""
    wanted = CODE.search(line)
    program, *arguments = shlex.split(CODE.sub("", line))
    if program == "pythonfmu":
        return subprocess.run(
            [sys.executable, "-m", program, *arguments], check=True, capture_output=True, text=True
        ).stdout
    assert program == "ropewalk", f"{where}: {line}"
    found = CliRunner().invoke(app, arguments)
    assert found.exit_code == int(wanted[1] if wanted else 0), f"{where}: {line}\n{found.output}"
    return found.output


def stands_in(line: str, printed: str) -> bool:
    """Whether a line was printed, with other blanks and numbers that are close."""
    return any(same(line, other) for other in printed.splitlines())


def same(one: str, other: str) -> bool:
    """Whether two lines have the same words, and numbers that are close."""
    if NUMBER.sub("#", " ".join(one.split())) != NUMBER.sub("#", " ".join(other.split())):
        return False
    pairs = zip(NUMBER.findall(one), NUMBER.findall(other), strict=True)
    return all(abs(float(a) - float(b)) <= CLOSE * max(abs(float(a)), abs(float(b))) for a, b in pairs)
