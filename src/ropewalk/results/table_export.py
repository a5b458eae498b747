"""Results as tables: series over time, samples between outputs and the summary, every column with its unit."""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results.contact_statistics import sampled_instants
from ropewalk.results.contract import path_name
from ropewalk.results.display_units import PLACE, DisplayUnits
from ropewalk.results.files import ResultError
from ropewalk.results.frame import Array
from ropewalk.results.line_response import histories
from ropewalk.results.ropeway import courses
from ropewalk.results.sag import sag
from ropewalk.results.statistics import blocks, lines, summary

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

SUFFIXES = (".csv", ".xlsx", ".parquet")
SERIES, SAMPLES, SUMMARY = "series", "samples", "summary"
_NEEDS = {".xlsx": "openpyxl", ".parquet": "pyarrow"}
_ROWS, _SHEET = 1_048_575, 31  # of a sheet: rows without its head, letters of its name
# Quantities of single points in the order of the columns, with the dimension that names the point.
_OF_POINTS = (
    ("contact", "load"), ("body", "body"), ("support", "support"), ("tie", "tie"), ("foreign", "foreign"),
    ("compared", "compared"),
    ("form", "form"),
)  # fmt: skip
_HEAD = re.compile(r"(.+) \[(.+)\]")
_DISPLACEMENT = re.compile(r"sag|sideways|uplift|sway|height_range")  # lengths that are no places
_UNITS = {"relative": "1", "order": "1", "together": "s"}  # of numbers in what has another unit
_WHERE = {"line": "line", "xi": "xi [m]", "x": "x [m]", "y": "y [m]", "time": "time [s]", "load_path": "load_path [m]"}


def tables(
    dataset: xr.Dataset,
    *,
    every: float | None = None,
    at: Sequence[float] | None = None,
    units: DisplayUnits | None = None,
) -> dict[str, pd.DataFrame]:
    """Give a result as tables whose columns are named `NAME.QUANTITY.COMPONENT [UNIT]`.

    Args:
        dataset: a result, in memory or lazy.
        every: s (m of a quasi-static motion), one row for each such interval; without it all output instants.
        at: s (m), rows at these instants only. Both take the output instants that are nearest.
        units: of the quantities (default: SI), each the same in all columns of a table; instants are in s, and
            places in m or in a unit of length that is no part of the metre.

    Returns:
        `series`: over the output instants, of every line its largest and smallest tension and its sag, and all
        quantities of loads, bodies, supports, ties and energies, of carriages wheel loads, sway and pulls. `samples`:
        what is sampled between them, if anything is. `summary`: the numbers of `summary`, one in each row.

    Raises:
        ResultError: an interval that is not above zero, or an instant that the result does not reach.
    """
    import pandas as pd

    found = {SERIES: _series(dataset, _chosen(dataset, every, at))}
    if dataset.sizes.get("sample", 0):
        found[SAMPLES] = _samples(dataset)
    rows = [row for row in _rows("", summary(dataset), "1") if row.get("value") is not None or "text" in row]
    found[SUMMARY] = pd.DataFrame(rows, columns=["quantity", "value", "unit", "text", *_WHERE.values()]).dropna(
        axis="columns", how="all"
    )
    return found if units is None else {name: _in_units(table, units) for name, table in found.items()}


def _in_units(table: pd.DataFrame, units: DisplayUnits) -> pd.DataFrame:
    """A table in the units to show: one unit for all that is measured in the same SI unit."""
    table = table.copy()
    if "quantity" in table.columns:  # a summary, with its units in the rows
        keys = [_measured(*pair) for pair in zip(table["quantity"], table["unit"].fillna(""), strict=True)]
        for column in [column for column in table.columns if str(column).endswith("[m]")]:
            table[column] /= units.place.size
            table = table.rename(columns={column: str(column).replace("[m]", f"[{units.place.symbol}]")})
        for key in dict.fromkeys(key for key in keys if key):
            here = np.array([k == key for k in keys])
            displayed = units.place if key == PLACE else units.of(key, [table.loc[here, "value"].to_numpy(dtype=float)])
            table.loc[here, "value"] /= displayed.size
            table.loc[here, "unit"] = displayed.symbol or "1"
        return table
    heads = [_HEAD.fullmatch(str(column)) for column in table.columns]
    measured = [_measured(*head.groups()) if head is not None else "" for head in heads]
    names, columns = list(table.columns), list(table.columns)
    for key in dict.fromkeys(key for key in measured if key):
        mine = [k for k, each in enumerate(measured) if each == key]
        displayed = units.place if key == PLACE else units.of(key, [table[columns[k]].to_numpy() for k in mine])
        for k in mine:
            table[columns[k]] /= displayed.size
            names[k] = re.sub(r"\[.*\]$", f"[{displayed.symbol or '1'}]", str(names[k]))
    table.columns = names
    if (head := _HEAD.fullmatch(str(table.index.name))) is not None and head[2] == "m":
        table.index = (table.index / units.place.size).rename(f"{head[1]} [{units.place.symbol}]")
    return table


def _measured(name: str, unit: str) -> str:
    """The SI unit by which a unit is chosen, of lengths that are places `PLACE`; empty for what has no unit."""
    if "strain" in name:
        return "strain"
    if unit == "m" and not _DISPLACEMENT.search(name):
        return PLACE
    return "" if unit in ("1", "", "s") else unit


def series_table(dataset: xr.Dataset) -> pd.DataFrame:
    """The table `series` of `tables`, of all output instants."""
    return _series(dataset, _chosen(dataset, None, None))


def named_numbers(dataset: xr.Dataset, only: Collection[str] | None = None) -> dict[str, tuple[float | None, str]]:
    """The numbers of a summary by the names that they have in tables, with their units; absent ones are None.

    Args:
        dataset: a result.
        only: entries of the summary that are wanted; others may be missing (default: all).
    """
    rows = _rows("", summary(dataset, only), "1")
    return {row["quantity"]: (row["value"], row["unit"]) for row in rows if "text" not in row}


def named_texts(dataset: xr.Dataset, only: Collection[str] | None = None) -> dict[str, str]:
    """The texts of a summary by the names that they have in tables; empty ones are left out.

    Args:
        dataset, only: as of `named_numbers`.
    """
    return {row["quantity"]: row["text"] for row in _rows("", summary(dataset, only), "1") if "text" in row}


def write_tables(
    dataset: xr.Dataset,
    path: str | Path,
    *,
    every: float | None = None,
    at: Sequence[float] | None = None,
    units: DisplayUnits | None = None,
) -> list[Path]:
    """Write the tables of a result: sheets of one `.xlsx`, or `OUT.csv`, `OUT.summary.csv`, ... next to each other.

    Args:
        dataset: a result.
        path: where to write; ends in `.csv`, `.xlsx` or `.parquet`.
        every: s (m), see `tables`.
        at: s (m), see `tables`.
        units: see `tables`.

    Returns:
        The files written.

    Raises:
        ResultError: another suffix, a package that is missing, too many rows for a sheet, or a file that cannot be
            written.
    """
    check_tables(path)
    return save_tables(tables(dataset, every=every, at=at, units=units), path)


def check_tables(path: str | Path) -> None:
    """Refuse a file for tables whose kind is not known, or needs a package that is missing.

    Raises:
        ResultError: so it is.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        raise ResultError(f"{path}: tables end in {', '.join(SUFFIXES)}")
    package = _NEEDS.get(suffix)
    if package and importlib.util.find_spec(package) is None:
        raise ResultError(f"{path}: {package} is not installed; pip install 'ropewalk[tables]', or write a .csv")


def save_tables(found: dict[str, pd.DataFrame], path: str | Path) -> list[Path]:
    """Write tables as sheets of a workbook, or as files next to each other, of which the first one has the name given.

    Args:
        found: by name; those with an index that has a name are written with it.
        path: where to write; ends in `.csv`, `.xlsx` or `.parquet`.

    Returns:
        The files written.

    Raises:
        ResultError: see `write_tables`.
    """
    import pandas as pd

    check_tables(path)
    path, suffix = Path(path), Path(path).suffix.lower()
    try:
        if suffix == ".xlsx":
            for name, table in found.items():
                if len(table) > _ROWS:
                    raise ResultError(f"{path}: {name} has {len(table)} rows, a sheet {_ROWS}; write a .csv")
            with pd.ExcelWriter(path, engine="openpyxl") as book:
                for name, table in found.items():
                    index = table.index.name is not None
                    table.to_excel(book, sheet_name=name[:_SHEET], index=index, freeze_panes=(1, int(index)))
            return [path]
        files = [path.with_suffix(f".{name}{suffix}") if k else path for k, name in enumerate(found)]
        for file, table in zip(files, found.values(), strict=True):
            index = table.index.name is not None
            if suffix == ".csv":
                table.to_csv(file, index=index)
            else:
                table.to_parquet(file, engine="pyarrow", index=index)
        return files
    except OSError as problem:
        raise ResultError(f"{path}: cannot be written ({problem.strerror or problem})") from None


def _chosen(dataset: xr.Dataset, every: float | None, at: Sequence[float] | None) -> list[int]:
    """Numbers of the frames that are asked for, in order."""
    name = path_name(dataset)
    instants, unit = dataset[name].values, dataset[name].attrs["units"]
    if every is None and at is None:
        return list(range(instants.size))
    if every is not None and not every > 0.0:
        raise ResultError(f"every is {every:g} {unit}; it must be above zero")
    wanted = list(at or ())
    outside = [t for t in wanted if not instants[0] <= t <= instants[-1]]
    if outside:
        reach = f"from {instants[0]:g} to {instants[-1]:g} {unit}"
        raise ResultError(f"at {outside[0]:g} {unit}: the result covers {reach}")
    if every is not None:
        wanted += list(np.arange(instants[0], instants[-1] * (1.0 + 1e-12), every))
    return sorted({int(np.abs(instants - t).argmin()) for t in wanted})


def _series(dataset: xr.Dataset, chosen: list[int]) -> pd.DataFrame:
    import pandas as pd

    name = path_name(dataset)
    watched = {f"{what} [{unit}]": values[chosen] for what, values, unit in histories(dataset)}
    watched |= {what: values[chosen] for what, values in _of_carriages(dataset)}
    dataset = dataset.isel({name: chosen})
    parts = [dict([*_of_lines(block), *_of_points(block)]) for block in blocks(dataset)] or [{}]
    columns = {column: np.concatenate([part[column] for part in parts]) for column in parts[0]}
    columns |= watched
    head = f"{name} [{dataset[name].attrs['units']}]"
    return pd.DataFrame(columns, index=pd.Index(dataset[name].values, name=head))


def _of_lines(dataset: xr.Dataset) -> Iterator[tuple[str, Array]]:
    """Largest and smallest tension and strain of every line, and its largest sag."""
    for line in lines(dataset):
        here = np.flatnonzero(dataset["link_line"].values == line)
        for quantity in ("tension", "strain"):
            values, unit = dataset[quantity].values[:, here], dataset[quantity].attrs["units"]
            yield f"{line}.largest_{quantity} [{unit}]", values.max(axis=1)
            yield f"{line}.smallest_{quantity} [{unit}]", values.min(axis=1)
        yield f"{line}.largest_sag [m]", np.fmax.reduce(sag(dataset, line).value, axis=1)


def _of_carriages(dataset: xr.Dataset) -> Iterator[tuple[str, Array]]:
    """Sway, pulls of ropes and wheel loads of carriages."""
    for name, course in courses(dataset).items():
        for what, (values, unit) in course.items():
            for k, one in enumerate(np.atleast_2d(values.T)):
                yield f"{name}.{what}{f'.{k + 1}' if values.ndim > 1 else ''} [{unit}]", one


def _of_points(dataset: xr.Dataset) -> Iterator[tuple[str, Array]]:
    """All quantities of points that have names: a column for each component."""
    path = path_name(dataset)
    for dim, label in _OF_POINTS:
        names = dataset[label].values.tolist() if label in dataset.variables else []
        quantities = [q for q in dataset.data_vars if dataset[q].dims[:2] == (path, dim)]
        for k, name in enumerate(names):
            for quantity in quantities:
                values, unit = dataset[quantity].isel({dim: k}), dataset[quantity].attrs["units"]
                what = f"energy.{name}" if dim == "form" else f"{name}.{_alone(str(quantity))}"
                if values.ndim == 1:
                    yield f"{what} [{unit}]", values.values
                else:
                    for j, part in enumerate(dataset[str(values.dims[1])].values.tolist()):
                        yield f"{what}.{part} [{unit}]", values.values[:, j]


def _alone(quantity: str) -> str:
    """Name of a quantity behind the name of its point: `force`, not `contact_force`, of a load."""
    for known in ("sampled_", "contact_", "tie_"):  # bodies keep theirs: loads may bear the same name
        quantity = quantity.removeprefix(known)
    return quantity


def _samples(dataset: xr.Dataset) -> pd.DataFrame:
    """What is sampled between outputs, one row for each sample."""
    import pandas as pd

    instants, kept = sampled_instants(dataset)
    columns = {}
    for quantity in (q for q in dataset.data_vars if "sample" in dataset[q].dims):
        dim = str(dataset[quantity].dims[-1])
        label, unit = {"contact": "load"}.get(dim, dim), dataset[quantity].attrs["units"]
        values = dataset[quantity].values[kept]
        for k, point in enumerate(dataset[label].values.tolist()):
            columns[f"{point}.{_alone(str(quantity))} [{unit}]"] = values[:, k]
    return pd.DataFrame(columns, index=pd.Index(instants, name=f"{path_name(dataset)} [s]"))


def _rows(name: str, found: Any, unit: str | Mapping[str, str]) -> Iterator[dict[str, Any]]:
    """The numbers and texts of a summary, one in each row, with unit, place and instant; absent numbers are None.

    Args:
        name: of what was found.
        found: a part of the summary.
        unit: of its numbers, or of each by the last part of its name.
    """
    if isinstance(found, dict):
        unit = found.get("unit", unit)
        where = [key for key in _WHERE if key in found and "value" in found]
        for key, value in found.items():
            if key in ("unit", "always_zero", *where):
                continue
            if key == "value":
                place = {_WHERE[at]: found[at] for at in where}
                yield from (row | place for row in _rows(name, value, unit))
            else:
                yield from _rows(f"{name}.{key}".lstrip("."), value, _UNITS.get(key, unit))
    elif isinstance(found, list | tuple):
        for k, value in enumerate(found):
            yield from _rows(f"{name}.{k + 1}", value, unit)
    elif isinstance(found, bool | str):
        if found != "":
            yield {"quantity": name, "text": str(found)}
    else:
        own = unit if isinstance(unit, str) else unit.get(name.rpartition(".")[2], "1")
        yield {"quantity": name, "value": None if found is None else float(found), "unit": own}
