"""What goes over the wire: a header in JSON, and arrays as 32-bit floats behind it."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results.contract import path_name
from ropewalk.results.frame import Array

if TYPE_CHECKING:
    import xarray as xr


def packed(header: Mapping[str, Any], arrays: Mapping[str, Array]) -> bytes:
    """A header, and arrays that it names with their shapes, as bytes.

    The length of the header in bytes (4, little-endian), the header padded so that what follows begins at a multiple
    of four, and the numbers one array after the other (little-endian, C order).
    """
    kept = {name: np.ascontiguousarray(array, dtype="<f4") for name, array in arrays.items() if array.size}
    text = json.dumps({**header, "arrays": [[name, array.shape] for name, array in kept.items()]}, allow_nan=False)
    head = text.encode()
    head += b" " * (-len(head) % 4)
    return b"".join((struct.pack("<I", len(head)), head, *(array.tobytes() for array in kept.values())))


def described(dataset: xr.Dataset) -> dict[str, Any]:
    """Return the layout of a result as the page needs it."""

    def names(key: str) -> list[str]:
        return [str(name) for name in dataset[key].values] if key in dataset.variables else []

    cells = dataset["cell_node"].values.astype(int).tolist() if "cell_node" in dataset.variables else []
    return {
        "axes": names("axis"), "path": path_name(dataset), "nodes": _runs_of(names("line")), "cells": cells,
        "links": _runs_of(names("link_line")), "loads": names("load"), "supports": names("support"),
    }  # fmt: skip


def _runs_of(names: list[str]) -> list[tuple[str, int, int]]:
    """Return names that repeat as [name, first, how many]."""
    found, first = list[tuple[str, int, int]](), 0
    for name, same in groupby(names):
        found.append((name, first, len([*same])))
        first += found[-1][2]
    return found
