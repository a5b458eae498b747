"""Files of a sweep: the dataset as NetCDF, its table, its figure."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from ropewalk.results import ResultError, save_tables
from ropewalk.results.files import is_netcdf
from ropewalk.results.table_export import SUFFIXES as TABLES
from ropewalk.results.table_export import check_tables
from ropewalk.sweeps.dataset import KIND, sweep_table

if TYPE_CHECKING:
    import xarray as xr

FIGURES = (".png", ".svg", ".pdf")
SUFFIXES = (".nc", *TABLES, *FIGURES)


def check_outputs(files: list[Path]) -> None:
    """Refuse files that cannot be written, before anything is computed.

    Raises:
        ResultError: another suffix, no such folder, or a package that is missing.
    """
    for file in files:
        if file.suffix.lower() not in SUFFIXES:
            raise ResultError(f"{file}: a sweep is written as {', '.join(SUFFIXES)}")
        if not file.parent.is_dir():
            raise ResultError(f"{file}: the folder {file.parent} does not exist; create it or choose another place")
        try:
            file.stat()
        except FileNotFoundError:
            pass
        except OSError as problem:
            raise ResultError(f"{file}: cannot be written ({problem.strerror}); choose another place") from None
        if file.suffix.lower() in TABLES:
            check_tables(file)


def read(file: Path) -> xr.Dataset | None:
    """Read a sweep that was written as NetCDF, None if the file is anything else."""
    import xarray as xr

    if not is_netcdf(file):
        return None
    import netCDF4

    try:
        with netCDF4.Dataset(file) as stored:
            if getattr(stored, "kind", "") != KIND:
                return None
        return xr.load_dataset(file, engine="netcdf4")
    except (OSError, RuntimeError, ValueError):
        return None  # the reader of results reports it


def write(dataset: xr.Dataset, file: Path) -> None:
    """Write a sweep as the name of the file says; a NetCDF file is replaced at once, or not at all.

    Raises:
        ResultError: it cannot be written.
        ScenarioError: there would be too many curves for a figure.
    """
    suffix = file.suffix.lower()
    try:
        if suffix in FIGURES:
            from ropewalk.sweeps.figure import sweep_figure

            sweep_figure(dataset).savefig(file)
        elif suffix == ".nc":
            beside = file.with_name(f".{file.name}.{os.getpid()}")
            try:
                dataset.to_netcdf(beside, engine="netcdf4")
                os.replace(beside, file)
            finally:
                beside.unlink(missing_ok=True)
        else:
            save_tables({"cases": sweep_table(dataset)}, file)
    except OSError as problem:
        raise ResultError(f"{file}: cannot be written ({problem.strerror or problem})") from None
