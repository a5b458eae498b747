"""Result files: how one is opened, and where one may be written: not over what is none, nor over another one's."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.results.checksums import ATTRIBUTES, CutShortError, DamagedError, check_whole
from ropewalk.results.contract import CHECKPOINT, CONVENTIONS, COORDINATES, NUMBERS, VARIABLES, is_present, path_name

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario

_AGAIN, _PAUSE = 3, 0.1  # times, and s between, that a running result is looked at again
LOAD_BELOW = 256e6  # bytes; larger results stay on disk and are read piece by piece
_MAGIC = (b"\x89HDF\r\n\x1a\n", b"CDF\x01", b"CDF\x02", b"CDF\x05")


class ResultError(RopewalkError):
    """A result file that cannot be opened, or a place where none can be written."""


class WriteError(ResultError):
    """Writing a result failed on the way (a full disk, a quota, a lost network folder)."""


def is_netcdf(file: Path) -> bool:
    """Whether a file begins as one of NetCDF does."""
    try:
        with file.open("rb") as stream:
            return stream.read(8).startswith(_MAGIC)
    except OSError:
        return False


def open_result(path: str | Path, *, lazy: bool | None = None) -> xr.Dataset:
    """Open a result file, whether its run was completed, interrupted or killed.

    Args:
        path: the NetCDF file.
        lazy: leave the arrays on disk until they are used; by default from 256 MB on. A lazy dataset holds
            the file open until its `close()`.

    Raises:
        ResultError: there is no such file, it cannot be read, or it is no result of ropewalk.
    """
    import xarray as xr

    path = Path(path)
    if not os.path.isfile(path):  # of any name: Path.is_file raises an error where it is too long
        raise ResultError(f"{path}: there is no such file")
    check_result(path, lazy=lazy)
    try:
        dataset = xr.open_dataset(path, engine="netcdf4", decode_times=False, cache=not lazy, drop_variables=CHECKPOINT)
    except (OSError, ValueError, RuntimeError, KeyError, MemoryError) as problem:
        raise ResultError(f"{path}: {_why_unreadable(path, problem)}") from problem
    if dataset.attrs.get("Conventions") != CONVENTIONS:
        dataset.close()
        raise ResultError(f"{path}: not a result of ropewalk (attribute Conventions is not {CONVENTIONS})")
    dataset = _tidy(dataset)
    if lazy is None:
        lazy = dataset.nbytes >= LOAD_BELOW
    if not lazy:
        with dataset:
            return dataset.load()
    return dataset


def beside(path: Path, what: str) -> Path:
    """A hidden file next to another one."""
    return path.with_name(f".{path.name}.{what}")


def _check_running(path: Path, *, read: bool) -> None:
    """Make sure that a file is what was written; one that is being written may change while it is read."""
    for _ in range(_AGAIN):
        try:
            return check_whole(path, read=read)
        except DamagedError:
            if not beside(path.resolve(), "lock").exists():
                raise
            time.sleep(_PAUSE)
    return check_whole(path, read=read)


def check_result(path: Path, *, lazy: bool | None = None) -> None:
    """Make sure that a result is what was written; of a large one that stays on disk, that nothing is missing.

    Raises:
        ResultError: it is damaged.
    """
    try:
        _check_running(path, read=not (path.stat().st_size >= LOAD_BELOW if lazy is None else lazy))
    except DamagedError as problem:
        remedy = "copy it again from its source, or repeat the run"
        if isinstance(problem, CutShortError):
            remedy += "; `ropewalk resume` continues from its last checkpoint"
        raise ResultError(f"{path}: {problem}; {remedy}") from problem
    except OSError as problem:
        raise ResultError(f"{path}: {_why_unreadable(path, problem)}") from problem


def _why_unreadable(path: Path, problem: Exception) -> str:
    if not os.access(path, os.R_OK):
        return "no permission to read it"
    if not is_netcdf(path):
        return "is no NetCDF file"
    return f"cannot be read ({problem})"


def _tidy(dataset: xr.Dataset) -> xr.Dataset:
    """Give a dataset the form it has in memory: types of names and attributes, empty quantities (no loads)."""
    size: dict[Any, int] = {**dict.fromkeys(("node", "link", "contact", "body", "support"), 0), **dataset.sizes}
    coordinates: dict[str, Any] = {}
    for name, quantity in COORDINATES.items():
        if not is_present(quantity, size):
            continue
        values = dataset[name].values if name in dataset.variables else np.empty(size[quantity.dims[0]])
        if quantity.unit == "1" and name not in NUMBERS:
            values = np.array(values.tolist(), dtype=np.str_)
        coordinates[name] = (quantity.dims, values, quantity.attributes)
    path = path_name(dataset)
    for name, quantity in VARIABLES.items():
        if name not in dataset.variables and is_present(quantity, size):
            dims = (path, *quantity.dims)
            dataset[name] = (dims, np.full([size[d] for d in dims], np.nan), quantity.attributes)
    dataset = dataset.assign_coords(coordinates)
    dataset.attrs = in_memory(dataset.attrs)
    return dataset


def in_memory(attributes: Mapping[Any, Any]) -> dict[Any, Any]:
    """Attributes of a file with the types that they have in memory, without those that check it."""
    own = {key: value for key, value in attributes.items() if key not in ATTRIBUTES}
    plain = {key: getattr(value, "item", lambda v=value: v)() for key, value in own.items()}
    return {**plain, "steps": int(plain["steps"])}


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
