"""Plain arrays as a labelled dataset."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from ropewalk.importing import lightly
from ropewalk.results import contract

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.results.frame import Layout

Labelled = tuple[tuple[str, ...], NDArray[Any], Mapping[str, Any]]
"""Names of dimensions, values, attributes."""


def dataset(
    variables: Mapping[str, Labelled], coordinates: Mapping[str, Labelled], attributes: Mapping[str, Any]
) -> xr.Dataset:
    """Label arrays.

    The same as `xarray.Dataset` gives, which however asks of each array whether it is one of Dask or Pint, and imports
    these for that: half of the first answer of a process. Of variables and indexes that are made already it does not.

    Args:
        variables: by name.
        coordinates: by name; one along the dimension of its own name is its index.
        attributes: of the whole.
    """
    with lightly():  # slow
        import pandas as pd
        import xarray as xr
        from xarray.indexes import PandasIndex

    indexes = {
        name: PandasIndex(pd.Index(values), name, values.dtype)
        for name, (dims, values, _) in coordinates.items()
        if dims == (name,)
    }
    made = {name: xr.Variable(*one, fastpath=True) for name, one in coordinates.items()}
    for name, index in indexes.items():
        made |= index.create_variables({name: made[name]})
    data = {name: xr.Variable(*one, fastpath=True) for name, one in variables.items()}
    return xr.Dataset(data, xr.Coordinates(made, indexes), attributes)


def of_frames(
    layout: Layout, path: NDArray[Any], arrays: Mapping[str, NDArray[Any]], attributes: Mapping[str, Any]
) -> xr.Dataset:
    """Label the arrays of some frames as a result has them.

    Args:
        layout: of the frames.
        path: (frame,) time in s, or load path in m.
        arrays: (frame, ...) by name.
        attributes: of the whole.
    """
    values, size, leading = contract.coordinate_values(layout), contract.sizes(layout), layout.path
    coordinates = {
        name: (q.dims, values[name], q.attributes)
        for name, q in contract.COORDINATES.items()
        if contract.is_present(q, size)
    }
    coordinates[leading] = ((leading,), path, contract.PATHS[leading].attributes)
    variables = {
        name: ((leading, *q.dims), arrays[name], q.attributes)
        for name, q in contract.VARIABLES.items()
        if name in arrays and contract.is_present(q, size)
    }
    return dataset(variables, coordinates, attributes)
