"""Finished cases in a file of JSON lines: readable at any moment, shared by sweeps, gone on with after any kill."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import ModuleType
from typing import Any

from ropewalk.results.files import ResultError, WriteError
from ropewalk.sweeps.case import FINE, Outcome

fcntl: ModuleType | None
try:
    import fcntl
except ImportError:  # not everywhere can a file be locked
    fcntl = None

FORMAT, VERSION = "ropewalk sweep", 1
_HEAD = json.dumps({"format": FORMAT, "version": VERSION}).encode() + b"\n"


class Store:
    """Outcomes by the keys of their cases; in memory only, or in a file as well.

    A line is written whole, under a lock, by one call; what a kill has cut off is cut away by the next one to write.
    Nobody keeps the lock, so several sweeps may write to one store: each sees what the others have finished.

    Args:
        file: of JSON lines: a head, and one case in each further line. None: nothing is written.
        retry: forget cases that have failed before.

    Raises:
        ResultError: the file is something else, or cannot be opened or read.
    """

    def __init__(self, file: Path | None, retry: bool = False) -> None:
        self.file = file
        self.done: dict[str, Outcome] = {}
        self._handle = -1
        self._read_to = self._lines = 0
        if file is None:
            return
        try:
            self._handle = os.open(file, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
        except OSError as error:
            raise ResultError(f"{file}: cannot be opened ({error.strerror}); choose another store") from None
        try:
            with self._locked():
                self._begin()
            self.look()
        except BaseException:
            self.close()
            raise
        if retry:
            self.done = {key: outcome for key, outcome in self.done.items() if outcome.outcome in FINE}

    def look(self) -> None:
        """Read what has been finished since the last look, here or elsewhere.

        Raises:
            ResultError: a line cannot be read.
        """
        if self._handle < 0 or os.fstat(self._handle).st_size <= self._read_to:
            return
        data = _read(self._handle, self._read_to)
        data = data[: data.rfind(b"\n") + 1]  # another process may be writing
        for line in data.splitlines():
            self._lines += 1
            try:
                found = json.loads(line)
                if self._lines > 1:
                    self.done[str(found["key"])] = Outcome.from_dict(found)
            except (ValueError, KeyError, TypeError, AttributeError):
                what = "this line cannot be read; delete it, and its case is computed again"
                raise ResultError(f"{self.file}:{self._lines}: {what}") from None
        self._read_to += len(data)

    def add(self, key: str, outcome: Outcome, settings: list[str]) -> None:
        """Keep a case, in the file at once, unless another sweep has done so.

        Args:
            key: of the case.
            outcome: of the case.
            settings: overrides that give its scenario, for those who read the file.

        Raises:
            WriteError: the file cannot be written.
        """
        if self._handle < 0:
            self.done[key] = outcome
            return
        line = json.dumps({"key": key, "set": settings, **outcome.as_dict()}, ensure_ascii=False, allow_nan=False)
        with self._locked():
            self._cut()
            self.look()
            if key in self.done:
                return
            self._write(line.encode() + b"\n")
            self._read_to = os.fstat(self._handle).st_size
            self._lines += 1
        self.done[key] = outcome

    def close(self) -> None:
        """Let go of the file."""
        if self._handle >= 0:
            with suppress(OSError):
                os.fsync(self._handle)
            os.close(self._handle)
            self._handle = -1

    def _begin(self) -> None:
        """Write the head of a new file, or see whether an old one is a store."""
        first = _read(self._handle, 0)[: len(_HEAD)]
        if _HEAD.startswith(first) and first != _HEAD:  # new, or killed while the head was written
            os.ftruncate(self._handle, 0)
            self._write(_HEAD)
        elif first != _HEAD:
            same = first.startswith(_HEAD[: _HEAD.index(b",")])
            what = "was written in another version of the format" if same else "exists and is no store of a sweep"
            raise ResultError(f"{self.file}: {what}; it is not overwritten, choose another name")
        else:
            self._cut()

    def _cut(self) -> None:
        """Cut away what a kill has left of a line; nobody else is writing."""
        data = _read(self._handle, self._read_to)
        whole = self._read_to + data.rfind(b"\n") + 1
        if whole < self._read_to + len(data):
            os.ftruncate(self._handle, whole)

    def _write(self, line: bytes) -> None:
        try:
            written = os.write(self._handle, line)
            if written < len(line):
                raise OSError(28, "no space is left")
        except OSError as error:
            raise WriteError(
                f"{self.file}: cannot be written ({error.strerror}); free some space, and run the same command again"
            ) from None

    @contextmanager
    def _locked(self) -> Iterator[None]:
        """Be the only one who writes."""
        if fcntl is not None:
            with suppress(OSError):  # some network folders know no locks
                fcntl.flock(self._handle, fcntl.LOCK_EX)
        try:
            yield
        finally:
            if fcntl is not None:
                with suppress(OSError):
                    fcntl.flock(self._handle, fcntl.LOCK_UN)

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()


def _read(handle: int, begin: int) -> bytes:
    os.lseek(handle, begin, os.SEEK_SET)
    data = bytearray()
    while piece := os.read(handle, 1 << 20):
        data += piece
    return bytes(data)
