"""Where a result may be written: not over what is none, nor over what somebody else writes or another scenario gave."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ropewalk.results.files import ResultError, beside, check_result, is_netcdf

if TYPE_CHECKING:
    from ropewalk.model import Scenario

_LONGEST = 240  # bytes of the name of a file, which has to leave room for the names of those next to it


def check_target(file: Path) -> Path:
    """Make sure that a result can be written to `file`, without touching anything, and give its full path.

    Raises:
        ResultError: the folder is missing or not writable, `file` is a folder or a file of another kind, or another
            process is writing it.
    """
    try:
        with suppress(FileNotFoundError):  # else there is no loop of links, which resolve takes for a file from 3.13 on
            Path(file).expanduser().stat()
        target = Path(file).expanduser().resolve()
        folder = target.parent
        if not folder.is_dir():
            raise ResultError(f"{file}: the folder {folder} does not exist; create it or choose another place")
        if not os.access(folder, os.W_OK | os.X_OK):
            raise ResultError(f"{file}: no permission to write in the folder {folder}; choose another place")
        if target.is_dir():
            raise ResultError(f"{file}: is a folder; give the name of a file in it")
        if len(os.fsencode(target.name)) > _LONGEST:
            raise ResultError(f"{file}: the name is too long; write at most {_LONGEST} letters")
        target.name.encode()
        if target.exists() and not target.is_file():
            raise ResultError(f"{file}: is not an ordinary file; choose another name")
        if target.is_file() and target.stat().st_size and not is_netcdf(target):
            raise ResultError(f"{file}: exists and is not a result; it is not overwritten, choose another name")
    except UnicodeEncodeError:
        name = os.fsencode(file).decode("utf-8", "backslashreplace")
        raise ResultError(f"{name}: the name is not UTF-8; choose another one") from None
    except (OSError, RuntimeError, ValueError) as problem:
        why = getattr(problem, "strerror", None) or str(problem)
        raise ResultError(f"{file}: cannot be written to ({why}); choose another place") from problem
    if beside(target, "lock").exists():
        with alone(target):
            pass
    return target


def check_own(file: Path, scenario: Scenario) -> None:
    """Make sure that a result which is there is one of the same scenario, as it is now or as it was.

    That has the same title, or the same lines, nets and loads.

    Raises:
        ResultError: it is of another scenario, or cannot be read.
    """
    if not file.is_file() or not file.stat().st_size:
        return
    remedy = "choose another name (-o), or write --overwrite"
    import netCDF4

    try:
        check_result(file, lazy=True)
        with netCDF4.Dataset(file) as stored:
            title, text = str(stored.getncattr("title")), str(stored.getncattr("scenario"))
        names = _names(json.loads(text))
    except (ResultError, OSError, RuntimeError, ValueError, AttributeError, TypeError, MemoryError) as problem:
        raise ResultError(f"{file}: exists, but its scenario cannot be read; {remedy}") from problem
    if title == scenario.title or names == _names(scenario.model_dump(include=set(_NAMED))):
        return
    raise ResultError(f"{file}: holds a result of another scenario, {title!r}; {remedy}")


_NAMED = ("lines", "overhead_lines", "nets", "loads")


def _names(tree: Any) -> tuple[tuple[str, ...], ...]:
    return tuple(tuple(sorted(tree.get(block) or {})) for block in _NAMED)


@contextmanager
def alone(path: Path) -> Iterator[None]:
    """Keep a result to oneself, whether it is there yet or not, as long as nobody else does.

    A hidden file next to it is locked, and says who does. It goes with its lock; a kill leaves it, unlocked.

    Raises:
        ResultError: another process does.
    """
    try:
        import fcntl
    except ImportError:  # not on Windows
        yield
        return
    lock = beside(path, "lock")
    try:
        while True:
            stream = lock.open("a+", encoding="utf-8")
            try:
                fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                stream.seek(0)
                who = stream.read(200).strip()
                stream.close()
                by = f"by process {who}" if who else "by another process"
                raise ResultError(f"{path}: is being written {by}; wait until that ends") from None
            except OSError:  # some network folders know no locks
                break
            with suppress(OSError):
                if os.fstat(stream.fileno()).st_ino == lock.stat().st_ino:
                    break
            stream.close()  # the one before has just gone
    except OSError as problem:
        raise ResultError(f"{path}: cannot be locked ({problem.strerror})") from problem
    with stream:
        try:
            stream.truncate(0)
            stream.write(f"{os.getpid()} since {time.strftime('%Y-%m-%d %H:%M:%S')}\n")
            stream.flush()
            yield
        finally:
            with suppress(OSError):
                lock.unlink()
