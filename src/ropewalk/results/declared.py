"""What a result says was declared, as the tree of its scenario's text, and which bodies hang on which contacts."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results.frame import Array

if TYPE_CHECKING:
    import xarray as xr


def declared(dataset: xr.Dataset, block: str) -> dict[str, dict[str, Any]]:
    """Declarations by name of a block of the scenario of a result, `loads` or `lines`; none where it has no text."""
    found = _tree(str(dataset.attrs.get("scenario", "")))
    return (found.get(block) or {}) if isinstance(found, dict) else {}


def line_of(contact: str, loads: Mapping[str, Any]) -> str:
    """The line of a contact as declared; those of a load on several lines have the name of theirs.

    Args:
        contact: its name, that of its load first.
        loads: of each load the lines that it is `on` and `also_on`.
    """
    name, _, part = contact.partition(".")
    load = loads.get(name, {})
    return part if part in (load.get("also_on") or ()) else str(load.get("on", ""))


@lru_cache(maxsize=4)
def _tree(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return {}


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
