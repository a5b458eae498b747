"""The folder that the studio was opened in: what is in it can be read and written, and nothing else."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from ropewalk.errors import Problem, RopewalkError, ScenarioError

SCENARIOS, RESULTS = (".yaml", ".yml", ".json"), (".nc",)
LARGEST_TEXT = 1_000_000  # bytes of a scenario on a page
_MOST_FILES = 500


class OutsideError(RopewalkError):
    """A name that leads out of the folder, or is of no kind that the studio touches."""


class Folder:
    """A folder, with the files of scenarios and results in it.

    Args:
        path: of the folder.
        most: bytes that they may take; 0: no limit.
    """

    def __init__(self, path: Path, most: int = 0) -> None:
        self.path, self._most = path.resolve(), most

    def file(self, name: str, kinds: tuple[str, ...]) -> Path:
        """A file in it by its name, which need not exist.

        Raises:
            OutsideError: the name leads elsewhere, or the kind is another one.
        """
        if not name or len(name) > 200 or any(sign in name for sign in "/\\\0:") or name.startswith("."):
            raise OutsideError("name a file in the folder of the studio, without a path")
        found = _resolved(self.path / name)
        if found.parent != self.path or found.suffix.lower() not in kinds:
            raise OutsideError(f"{name}: must be a file of this folder that ends in {', '.join(kinds)}")
        return found

    def bytes_left(self) -> int:
        """Return how many bytes may still be written, 0 where there is no limit.

        Raises:
            RopewalkError: none.
        """
        kinds, used = (*SCENARIOS, *RESULTS, ".jsonl"), 0
        for entry in os.scandir(self.path):
            if Path(entry.name).suffix.lower() in kinds:
                with suppress(OSError):
                    used += entry.stat().st_size
        if used >= self._most > 0:
            taken, most = (f"{number / 1e9:.3g} GB" for number in (used, self._most))
            remedy = "delete results, or start the studio with a larger limit"
            raise RopewalkError(f"scenarios and results in the folder take {taken}, at most {most}: {remedy}")
        return max(self._most - used, 0)

    def files(self) -> dict[str, list[str]]:
        """Names of scenarios and results."""
        names = sorted(entry.name for entry in os.scandir(self.path) if entry.is_file() and entry.name[0] != ".")
        return {
            what: [name for name in names if Path(name).suffix.lower() in kinds][:_MOST_FILES]
            for what, kinds in (("scenarios", SCENARIOS), ("results", RESULTS))
        }

    def read(self, name: str) -> dict[str, Any]:
        """A scenario's text, with the stamp that tells whether it has changed since.

        Raises:
            OutsideError: see `file`.
            RopewalkError: it cannot be read as text.
        """
        file = self.file(name, SCENARIOS)
        try:
            if file.stat().st_size > LARGEST_TEXT:
                raise RopewalkError(f"{name}: is larger than 1 MB, the limit of the studio")
            return {"name": name, "text": file.read_text(encoding="utf-8"), "stamp": _stamp(file)}
        except (OSError, UnicodeError) as problem:
            raise RopewalkError(f"{name}: cannot be read ({getattr(problem, 'strerror', None) or problem})") from None

    def save(self, name: str, text: str, stamp: str) -> dict[str, Any]:
        """Write a scenario's text, whole or not at all.

        Raises:
            OutsideError: see `file`.
            RopewalkError: the file is not as it was read (another program has written it), or cannot be written.
        """
        self.bytes_left()
        file = self.file(name, SCENARIOS)
        if len(text.encode()) > LARGEST_TEXT:
            raise RopewalkError("the text is larger than 1 MB")
        if (is_now := _stamp(file)) != stamp:
            what = "exists already" if not stamp else "was changed on disk after opening" if is_now else "was deleted"
            raise RopewalkError(f"{name}: {what}; open it again, or save under another name")
        made = file.with_name(f".{file.name}.{os.getpid()}.new")
        try:
            made.write_text(text, encoding="utf-8")
            made.replace(file)
        except OSError as problem:
            with suppress(OSError):
                made.unlink(missing_ok=True)
            raise RopewalkError(f"{name}: cannot be written ({problem.strerror or problem})") from None
        return {"name": name, "stamp": _stamp(file)}


def _resolved(file: Path) -> Path:
    """Return a file with all links followed.

    Raises:
        OutsideError: they lead in a loop, which only some versions of Python report.
    """
    try:
        with suppress(FileNotFoundError, NotADirectoryError):
            file.stat()
        return file.resolve()
    except (OSError, RuntimeError, ValueError):
        raise OutsideError(f"{file.name}: is a link to no file") from None


def _stamp(file: Path) -> str:
    """What changes when a file is written; empty if there is none."""
    with suppress(OSError):
        status = file.stat()
        return f"{status.st_ino}-{status.st_mtime_ns}-{status.st_size}"
    return ""


def check_inside(tree: Any, folder: Path) -> None:
    """Refuse a scenario that reads files outside of the folder: profiles, earlier results, models.

    Args:
        tree: the scenario as plain values.
        folder: where it may read.

    Raises:
        ScenarioError: with all that it names.
    """
    problems = []
    for key, given in _files(tree, ()):
        try:
            is_inside = _resolved(folder / given).is_relative_to(folder)
        except OutsideError:
            is_inside = False
        if not is_inside:
            remedy = "move the file into the folder, or open the studio where it is"
            problems.append(Problem(".".join(key), "lies outside of the folder of the studio", given, remedy))
    if problems:
        raise ScenarioError(problems)


def _files(node: Any, key: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], str]]:
    """Names of files in a tree, with their keys; `irregularity` is a file, or a file for each line."""
    entries = node.items() if isinstance(node, Mapping) else enumerate(node) if isinstance(node, list | tuple) else ()
    for name, entry in entries:
        if not isinstance(entry, str):
            yield from _files(entry, (*key, str(name)))
        elif name in ("file", "irregularity") or key[-1:] == ("irregularity",):
            yield (*key, str(name)), entry
