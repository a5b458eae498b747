"""Ties: which bodies of loads hang on, or stand on, which contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ropewalk.results.declared import declared
from ropewalk.results.frame import Array

if TYPE_CHECKING:
    import xarray as xr


ON_SPRINGS = ("oscillator", "vehicle", "matrices", "train")  # kinds of loads whose bodies are above their contacts


def hanging_bodies(dataset: xr.Dataset) -> Array:
    """Return the positions of bodies, (frame, body, axis) m; NaN of those of vehicles, which are above their wheels.

    Springs of vehicles have no length of their own: drawn at its position, a train would hang below its bridge.
    """
    place, loads = np.array(dataset["body_position"].values, dtype=float), declared(dataset, "loads")
    bodies = dataset["body"].values.tolist()
    above = [loads.get(body.partition(".")[0], {}).get("kind") in ON_SPRINGS for body in bodies]
    place[:, np.array(above, dtype=np.bool_)] = np.nan
    return place


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
