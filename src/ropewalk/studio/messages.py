"""What goes over the wire: a header in JSON, and arrays as 32-bit floats behind it."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np

from ropewalk.results.frame import Array, Layout


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


def runs_of(names: tuple[str, ...]) -> list[tuple[str, int, int]]:
    """Names that repeat as [name, first, how many]."""
    found = list[tuple[str, int, int]]()
    for i, name in enumerate(names):
        if found and found[-1][0] == name:
            found[-1] = (name, found[-1][1], found[-1][2] + 1)
        else:
            found.append((name, i, 1))
    return found


def described(layout: Layout) -> dict[str, Any]:
    """A layout as the page needs it."""
    return {
        "axes": layout.axes, "path": layout.path, "nodes": runs_of(layout.node_line),
        "links": runs_of(layout.link_line), "loads": layout.contact_load, "supports": layout.support,
        "bodies": layout.body, "cells": layout.cell,
    }  # fmt: skip
