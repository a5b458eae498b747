"""Extrapolation: paths of contacts on meshes without end, from two of them (L. F. Richardson)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ropewalk.results.files import ResultError

if TYPE_CHECKING:
    import xarray as xr

ALIKE = 0.9
"""Cosine of the angle between two changes from mesh to mesh, below which the next one goes elsewhere: what sudden
forces do on ropes has 0.1 to 0.7, and extrapolation makes it worse; beams, rest and modes have 0.96 and more."""


def extrapolated(dataset: xr.Dataset) -> xr.DataArray:
    """Give the positions of the contacts as they would be on a mesh without end.

    Args:
        dataset: a result with the error of its mesh (`mesh_error: true`, or `elements: auto`).

    Returns:
        `contact_position + contact_change / (2^p - 1)`, p the observed order: (time, contact, axis) m.

    Raises:
        ResultError: it has no such error, or its changes from mesh to mesh do not lead anywhere.
    """
    metadata = dataset.attrs
    if "contact_change" not in dataset or "mesh_order_of_contacts" not in metadata:
        raise ResultError(
            "the result has no contacts on two meshes; write mesh_error: true in the run, and run it again"
        )
    alike, order = float(metadata["mesh_alike_of_contacts"]), float(metadata["mesh_order_of_contacts"])
    if not alike >= ALIKE:
        raise ResultError(
            f"the changes of the contacts from mesh to mesh differ (cosine {alike:.2g}, {ALIKE} is needed): "
            "extrapolation would not be nearer; write more elements"
        )
    change = dataset["contact_change"].values / (2.0**order - 1.0)
    found: xr.DataArray = dataset["contact_position"] + change
    found.attrs = {"units": "m", "long_name": "position of the contact, extrapolated from two meshes"}
    return found
