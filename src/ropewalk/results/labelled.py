"""Plain arrays as a labelled dataset."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from ropewalk.importing import lightly

if TYPE_CHECKING:
    import xarray as xr

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
