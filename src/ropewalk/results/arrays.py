"""A result file as arrays: enough for its summary, without the second that it takes to import xarray with all it knows.

What is asked of them in other ways, their dataset answers, which is opened then.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, cast

import numpy as np
from numpy.typing import NDArray

from ropewalk.results.contract import COORDINATES, NUMBERS, PATHS, VARIABLES, ResultVariable, is_present
from ropewalk.results.files import LOAD_BELOW, check_result, in_memory, open_result

if TYPE_CHECKING:
    import xarray as xr


class ResultArray:
    """A variable of a result: its values with their dimensions.

    Args:
        values: numbers or names.
        dims: names of the dimensions.
        attrs: attributes, such as `units`.
        whole: what gives the same as xarray has it.
    """

    def __init__(
        self, values: NDArray[Any], dims: tuple[str, ...], attrs: Mapping[str, Any], whole: Callable[[], xr.DataArray]
    ) -> None:
        self.values, self.dims, self.attrs, self._whole = values, dims, attrs, whole

    def isel(self, **at: Any) -> Any:
        """A part, by numbers, slices or arrays of numbers for each dimension."""
        values = self.values
        for axis, dim in reversed(list(enumerate(self.dims))):  # an axis that goes leaves those before as they were
            if dim in at:
                values = values[(slice(None),) * axis + (at[dim],)]
        whole = slice(None)
        dims = tuple(dim for dim in self.dims if np.ndim(at.get(dim, ())) or isinstance(at.get(dim, whole), slice))
        return ResultArray(np.asarray(values), dims, self.attrs, lambda: self._whole().isel(**at))

    def __getitem__(self, key: Any) -> Any:
        """A part, in the order of the dimensions."""
        keys = key if isinstance(key, tuple) else (key,)
        return self.isel(**dict(zip(self.dims, keys, strict=False)))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """The values."""
        return np.array(self.values, dtype, copy=copy)

    def __len__(self) -> int:
        """Length of the first dimension."""
        return len(self.values)

    def __getattr__(self, name: str) -> Any:
        """What only xarray knows."""
        return getattr(self._whole(), name)


class ResultArrays:
    """The variables of a result in memory, by name.

    Args:
        path: the file.
        variables: all of them, coordinates included.
        attrs: attributes of the result.
    """

    def __init__(self, path: Path, variables: Mapping[str, ResultArray], attrs: Mapping[str, Any]) -> None:
        self._path, self.variables, self.attrs = path, variables, attrs
        self.coords = {name: one for name, one in variables.items() if name in COORDINATES or name in PATHS}
        self.data_vars = {name: one for name, one in variables.items() if name not in self.coords}
        self.nbytes = sum(one.values.nbytes for one in variables.values())
        self.sizes = self.dims = {
            dim: size for one in variables.values() for dim, size in zip(one.dims, one.values.shape, strict=True)
        }

    @cached_property
    def whole(self) -> xr.Dataset:
        """The same as xarray has it."""
        return open_result(self._path)

    def __getitem__(self, name: Any) -> Any:
        """A variable; of several, a dataset."""
        return self.variables[name] if isinstance(name, str) else self.whole[name]

    def __contains__(self, name: object) -> bool:
        """Whether there is such a variable."""
        return name in self.variables

    def __iter__(self) -> Iterator[str]:
        """Names of variables that are no coordinates."""
        return iter(self.data_vars)

    def __getattr__(self, name: str) -> Any:
        """What only xarray knows."""
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.whole, name)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the file."""
        if "whole" in self.__dict__:
            self.whole.close()


def open_arrays(path: Path) -> xr.Dataset:
    """Open a result that has just been written, to be summarised; from 256 MB on as `open_result` does.

    Raises:
        ResultError: it is damaged.
    """
    if path.stat().st_size >= LOAD_BELOW:
        return open_result(path)
    import netCDF4

    check_result(path)
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        size = {**dict.fromkeys(("node", "link", "contact", "body", "support"), 0)}
        size |= {name: dimension.size for name, dimension in file.dimensions.items()}
        leading = next(name for name in PATHS if name in size)
        dims = {leading: (leading,)} | {name: quantity.dims for name, quantity in COORDINATES.items()}
        dims |= {name: (leading, *quantity.dims) for name, quantity in VARIABLES.items()}
        declared = {leading: PATHS[leading], **COORDINATES, **VARIABLES}
        values = {
            name: _values(file, name, quantity, [size[dim] for dim in dims[name]])
            for name, quantity in declared.items()
            if is_present(quantity, size)
        }
        attrs = in_memory({key: file.getncattr(key) for key in file.ncattrs()})

    def of_dataset(name: str) -> Callable[[], xr.DataArray]:
        return lambda: found.whole[name]

    variables = {
        name: ResultArray(each, dims[name], declared[name].attributes, of_dataset(name))
        for name, each in values.items()
    }
    found = ResultArrays(path, variables, attrs)
    return cast("xr.Dataset", found)


def _values(file: Any, name: str, quantity: ResultVariable, shape: list[int]) -> NDArray[Any]:
    """Values of a variable; what is empty (no loads) is in no file."""
    values = np.asarray(file.variables[name][:]) if name in file.variables else np.full(shape, np.nan)
    if name in COORDINATES and quantity.unit == "1" and name not in NUMBERS:
        return np.array(values.tolist(), dtype=np.str_)
    return values
