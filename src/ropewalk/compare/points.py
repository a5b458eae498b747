"""Finished points of a map, kept in a file of JSON lines as they come: what is killed goes on where it was."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType, TracebackType
from typing import IO, Any

from ropewalk.results.files import ResultError, WriteError

fcntl: ModuleType | None
try:
    import fcntl
except ImportError:  # not everywhere can a file be locked
    fcntl = None

FORMAT = "ropewalk adequacy"
VERSION = 1
_OTHER = {  # what may differ between a store and a map, and how it is said
    "version": "was written in another version of the format",
    "ropewalk": "was computed by another version of ropewalk, numbers may differ",
    "scenario": "belongs to another scenario",
    "x": "has another axis x",
    "y": "has another axis y",
}

Place = tuple[int, int]
"""Where a point is in the grid: its numbers along x and y."""
Distances = dict[str, dict[str, float | None]]
"""Relative distance from the full model, by model and quantity."""


@dataclass(frozen=True)
class PointOutcome:
    """What became of a point: its distances, or the reason why there are none."""

    distances: Distances | None = None
    reason: str = ""
    settings: tuple[str, ...] = ()  # overrides that give the scenario of the point
    seconds: float = 0.0

    def as_dict(self) -> dict[str, Any]:
        """The outcome as plain values."""
        found: dict[str, Any] = {"set": list(self.settings), "seconds": round(self.seconds, 3)}
        return found | ({"reason": self.reason} if self.distances is None else {"distances": self.distances})


class MapPoints:
    """The finished points of one map; in memory only, or in a file as well.

    Args:
        file: of JSON lines: the first says what is computed, each further one is a point. None: nothing is written.
        head: what is computed; a file with another head is refused.
        retry: forget points that have failed.

    Raises:
        ResultError: the file is something else, belongs to another map, is in use, or cannot be opened.
    """

    def __init__(self, file: Path | None, head: dict[str, Any], retry: bool = False) -> None:
        self.file = file
        self.done: dict[Place, PointOutcome] = {}
        self._stream: IO[bytes] | None = None
        if file is None:
            return
        whole = {"format": FORMAT, "version": VERSION, **head}
        try:
            self._stream = open(file, "a+b")  # noqa: SIM115  # kept open, and locked
        except OSError as error:
            raise ResultError(f"{file}: cannot be opened ({error.strerror}); choose another store") from None
        try:
            self._lock()
            self._read(whole)
        except BaseException:
            self._stream.close()
            raise
        if retry:
            self.done = {place: outcome for place, outcome in self.done.items() if outcome.distances is not None}

    def add(self, place: Place, outcome: PointOutcome) -> None:
        """Keep a point, in the file at once.

        Raises:
            WriteError: the file cannot be written.
        """
        self.done[place] = outcome
        self._write({"point": list(place), **outcome.as_dict()})

    def _lock(self) -> None:
        assert self._stream is not None
        if fcntl is not None:
            try:
                fcntl.flock(self._stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                raise ResultError(f"{self.file}: another run is writing there; wait, or choose another store") from None

    def _write(self, line: dict[str, Any]) -> None:
        if self._stream is None:
            return
        try:
            self._stream.write(json.dumps(line, ensure_ascii=False, allow_nan=False).encode() + b"\n")
            self._stream.flush()
        except OSError as error:
            raise WriteError(
                f"{self.file}: cannot be written ({error.strerror}); free some space, and run the same command again"
            ) from None

    def _read(self, head: dict[str, Any]) -> None:
        assert self._stream is not None
        self._stream.seek(0)
        data = self._stream.read()
        begin = json.dumps({"format": FORMAT})[:-1].encode()
        if not data.startswith(begin) and not (begin.startswith(data) and b"\n" not in data):
            raise ResultError(f"{self.file}: exists and is no store of points; it is left alone, choose another name")
        whole = data.rfind(b"\n") + 1
        if whole < len(data):  # a line that a kill has cut in half
            self._stream.truncate(whole)
        lines = data[:whole].splitlines()
        if not lines:
            self._write(head)
            return
        self._compare(self._line(1, lines[0]), head)
        shape = len(head["x"]["values"]), len(head["y"]["values"])
        for number, line in enumerate(lines[1:], start=2):
            found = self._line(number, line)
            try:
                i, j = (int(index) for index in found["point"])
                outcome = PointOutcome(found.get("distances"), found.get("reason", ""), tuple(found["set"]),
                                  float(found["seconds"]))  # fmt: skip
                if not (0 <= i < shape[0] and 0 <= j < shape[1]):
                    raise ValueError
            except (KeyError, TypeError, ValueError):
                raise self._broken(number) from None
            self.done[i, j] = outcome

    def _compare(self, found: dict[str, Any], head: dict[str, Any]) -> None:
        for key, message in _OTHER.items():
            if found.get(key) != head[key]:
                advice = "choose another store, or delete it to compute all points anew"
                was = (
                    f" ({found[key]} instead of {head[key]})" if key in ("version", "ropewalk") and key in found else ""
                )
                raise ResultError(f"{self.file}: {message}{was}; {advice}")

    def _line(self, number: int, line: bytes) -> dict[str, Any]:
        try:
            found = json.loads(line)
        except ValueError:
            raise self._broken(number) from None
        if not isinstance(found, dict):
            raise self._broken(number)
        return found

    def _broken(self, number: int) -> ResultError:
        return ResultError(
            f"{self.file}:{number}: this line cannot be read; delete it, and its point is computed again"
        )

    def close(self) -> None:
        """Let go of the file."""
        if self._stream is not None:
            self._stream.flush()
            os.fsync(self._stream.fileno())
            self._stream.close()
            self._stream = None

    def __enter__(self) -> MapPoints:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()
