"""Arrays are labelled as xarray does it itself, without asking whose they are."""

from __future__ import annotations

import numpy as np
import travelling_wave as wave
import xarray as xr

from ropewalk.results import contract
from ropewalk.results.labelled import Labelled, dataset


def parts() -> tuple[dict[str, Labelled], dict[str, Labelled]]:
    """Variables and coordinates of a result, with names, numbers and a dimension without any."""
    layout = wave.layout()
    values, size = contract.coordinate_values(layout), contract.sizes(layout)
    coordinates: dict[str, Labelled] = {
        name: (q.dims, values[name], q.attributes)
        for name, q in contract.COORDINATES.items()
        if contract.is_present(q, size)
    }
    coordinates["time"] = (("time",), np.linspace(0.0, 1.0, 5), {"units": "s"})
    shapes = contract.shapes(layout)
    rng = np.random.default_rng(1)
    variables: dict[str, Labelled] = {
        name: (("time", *q.dims), rng.random((5, *shapes[name])), q.attributes)
        for name, q in contract.VARIABLES.items()
        if contract.is_present(q, size)
    }
    return variables, coordinates


def test_it_is_what_xarray_makes() -> None:
    variables, coordinates = parts()
    own, other = dataset(variables, coordinates, {"title": "a"}), xr.Dataset(variables, coordinates, {"title": "a"})
    assert own.identical(other)
    assert repr(own) == repr(other)
    assert list(own.indexes) == list(other.indexes)
    for name in other.variables:
        assert own[name].dtype == other[name].dtype
        assert type(own[name].variable) is type(other[name].variable)
        assert own[name].encoding == other[name].encoding
    for name in other.indexes:
        assert own.indexes[name].dtype == other.indexes[name].dtype
        assert own.indexes[name].name == name


def test_it_is_selected_from_and_joined_as_xarray_makes_it() -> None:
    variables, coordinates = parts()
    own, other = dataset(variables, coordinates, {}), xr.Dataset(variables, coordinates, {})
    at = {"time": 0.3, "method": "nearest"}
    assert own.sel(**at).identical(other.sel(**at))
    assert xr.concat([own.isel(time=[0]), other.isel(time=[1])], "time").identical(other.isel(time=[0, 1]))
    assert own["position"].max("time").identical(other["position"].max("time"))


def test_values_are_not_copied() -> None:
    variables, coordinates = parts()
    assert np.shares_memory(dataset(variables, coordinates, {})["position"].values, variables["position"][1])
