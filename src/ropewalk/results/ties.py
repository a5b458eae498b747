"""Ties: which bodies of loads hang on, or stand on, which contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ropewalk.results.frame import Array

if TYPE_CHECKING:
    import xarray as xr


def ties(dataset: xr.Dataset) -> list[tuple[int, int]]:
    """Pairs of a body and a contact that belong to one load: ropes of payloads, springs, legs."""
    bodies, contacts = dataset["body"].values.tolist(), dataset["load"].values.tolist()
    return [
        (i, k)
        for i, body in enumerate(bodies)
        for k, contact in enumerate(contacts)
        if body.partition(".")[0] == contact.partition(".")[0]
    ]


def tied(bodies: Array, contacts: Array, pairs: list[tuple[int, int]]) -> Array:
    """Straight pieces from contacts to bodies, those in view alone.

    Args:
        bodies: (body, axis) m.
        contacts: (contact, axis) m, NaN off the line.
        pairs: what belongs together.

    Returns:
        Array (piece, 2, axis): ends of each piece.
    """
    segments = np.array([(contacts[k], bodies[i]) for i, k in pairs]).reshape(-1, 2, bodies.shape[-1])
    return np.asarray(segments[np.isfinite(segments).all(axis=(1, 2))])
