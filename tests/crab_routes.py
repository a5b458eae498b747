"""A crab on ropes beside one another as elastic catenaries have it, solved apart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.optimize import root

from ropewalk.theory.rope import elastic_catenary

G = 9.81


class Hung(NamedTuple):
    """What ropes bear of a crab that hangs on them."""

    height: float  # m
    share: np.ndarray  # (rope,) of its weight
    pull: float  # N, of what holds it along x


def hung(x: float, stiffness: Sequence[float], weight: float, *, span: float, length: float, mass: float) -> Hung:
    """A crab whose frictionless wheels stand at x in m on anchored ropes that differ in stiffness (rope,), N.

    Each rope pulls alike before and behind its wheel, all are at one place there, and bear the weight in N together.

    Args:
        span, length: m, of each rope.
        mass: kg/m, of each.
    """

    def hang(v: np.ndarray) -> list[float]:
        wrong, borne = [], -1.0
        for EA, (s, level, up) in zip(stiffness, v[1:].reshape(-1, 3), strict=True):
            load = (s * length, (level * weight, -up * weight))
            rope = elastic_catenary(span=span, length=length, weight=mass * G, axial_stiffness=EA, loads=[load])
            (at, height), (behind, ahead) = rope.load_positions[0], rope.load_tensions[0]
            wrong += [(at - x) / span, height / span - v[0], (behind - ahead) / weight]
            borne += up
        return [borne, *wrong]

    parts = np.array(stiffness) / np.sum(stiffness)
    solved = root(hang, np.concatenate([[-0.05], *([x / span, 0.0, part] for part in parts)]), tol=1e-13)
    assert np.abs(hang(solved.x)).max() < 1e-10
    ropes = solved.x[1:].reshape(-1, 3)
    return Hung(float(solved.x[0] * span), ropes[:, 2], float(weight * ropes[:, 1].sum()))


def shares(result: xr.Dataset) -> np.ndarray:
    """Parts of the force of a crab on its ropes that each of them bears, (instant, rope)."""
    force = result.contact_force.values[:, :, -1]
    return np.asarray(force / force.sum(axis=1)[:, None])
