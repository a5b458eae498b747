"""Result files: where one may be written, and how one is opened."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.results.contract import CHECKPOINT, CONVENTIONS, COORDINATES, NUMBERS, VARIABLES, is_present, path_name

if TYPE_CHECKING:
    import xarray as xr

LOAD_BELOW = 256e6  # bytes; larger results stay on disk and are read piece by piece
_MAGIC = (b"\x89HDF\r\n\x1a\n", b"CDF\x01", b"CDF\x02", b"CDF\x05")


class ResultError(RopewalkError):
    """A result file that cannot be opened, or a place where none can be written."""


class WriteError(ResultError):
    """Writing a result failed on the way (a full disk, a quota, a lost network folder)."""


def check_target(file: Path) -> Path:
    """Make sure that a result can be written to `file`, without touching anything, and give its full path.

    Raises:
        ResultError: the folder is missing or not writable, or `file` is a folder or a file of another kind.
    """
    target = Path(file).expanduser().resolve()
    folder = target.parent
    if not folder.is_dir():
        raise ResultError(f"{file}: the folder {folder} does not exist; create it or choose another place")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise ResultError(f"{file}: no permission to write in the folder {folder}; choose another place")
    if target.is_dir():
        raise ResultError(f"{file}: is a folder; give the name of a file in it")
    if target.exists() and not target.is_file():
        raise ResultError(f"{file}: is not an ordinary file; choose another name")
    if target.is_file() and target.stat().st_size and not _is_netcdf(target):
        raise ResultError(f"{file}: exists and is no result; it is left alone, choose another name")
    return target


def _is_netcdf(file: Path) -> bool:
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
    if not path.is_file():
        raise ResultError(f"{path}: there is no such file")
    try:
        dataset = xr.open_dataset(path, engine="netcdf4", decode_times=False, cache=not lazy, drop_variables=CHECKPOINT)
    except (OSError, ValueError, RuntimeError, KeyError) as problem:
        raise ResultError(f"{path}: {_why_unreadable(path, problem)}") from problem
    if dataset.attrs.get("Conventions") != CONVENTIONS:
        dataset.close()
        raise ResultError(f"{path}: no result of ropewalk (attribute Conventions is not {CONVENTIONS})")
    dataset = _tidy(dataset)
    if lazy is None:
        lazy = dataset.nbytes >= LOAD_BELOW
    if not lazy:
        with dataset:
            return dataset.load()
    return dataset


def _why_unreadable(path: Path, problem: Exception) -> str:
    if not os.access(path, os.R_OK):
        return "no permission to read it"
    if not _is_netcdf(path):
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
    dataset.attrs = {key: getattr(value, "item", lambda v=value: v)() for key, value in dataset.attrs.items()}
    dataset.attrs["steps"] = int(dataset.attrs["steps"])
    return dataset
