"""Influence lines of a suspension footbridge from slow motion: theorems of Maxwell and Betti, and of Müller-Breslau.

They hold for small loads about a rest of any structure; the loads here are a percent of a person, and differences are
taken between one upwards and one downwards, which leaves the third order.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

import ropewalk
from ropewalk.model import Scenario

Array = NDArray[np.float64]
BRIDGE = Path(__file__).parents[2] / "examples" / "suspension-footbridge.yaml"
FORCE, MOVED = 8.0, 1e-4  # N, m
# Without loads links are arcs, under loads straight: on this mesh supports bear by 0.2 % more then.
NOTHING = "loads={test: {kind: force, on: deck, force: [0.0, -1e-9], travel: {speed: 1.0}}}"


def bridge(*settings: str) -> Scenario:
    return ropewalk.load(BRIDGE, ["loads={}", "run={kind: equilibrium}", *settings])


@cache
def length() -> float:
    """Unstrained length of the deck, which its tension makes: it must be the same where a support is moved."""
    found = ropewalk.simulate(bridge())
    return float(found.xi.values[found.line.values == "deck"][-1])


def given(*settings: str) -> Scenario:
    return bridge("lines.deck.tension=null", f"lines.deck.length={length()!r}", *settings)


def deck(found: xr.Dataset) -> tuple[Array, Array]:
    """Places of the nodes of the deck along it, and their heights in all frames, m."""
    on = found.line.values == "deck"
    return found.xi.values[on], found.position.values[:, on, -1]


def loaded(force: float) -> xr.Dataset:
    """A force downwards at 41 places from one end to the other."""
    load: dict[str, Any] = {"kind": "force", "on": "deck", "force": [0.0, -force]}
    load["travel"] = {"speed": 1.0, "measured": "material", "from": 0.0}
    tree = given().model_dump(mode="json", by_alias=True, exclude_unset=True)
    tree |= {"loads": {"test": load}, "run": {"kind": "quasistatic", "positions": 41}}
    found = ropewalk.simulate(Scenario.model_validate(tree))
    assert found.attrs["outcome"] == "completed"
    return found


@cache
def changes() -> tuple[Array, Array, Array, xr.DataArray]:
    """Places of nodes and of the load, the heights of nodes (load, node) per N, and the support forces per N."""
    down, up = loaded(FORCE), loaded(-FORCE)
    x, z = deck(down)
    return x, down.load_path.values, (z - deck(up)[1]) / (2 * FORCE), (down.reaction - up.reaction) / (2 * FORCE)


def test_what_a_load_here_does_there_a_load_there_does_here() -> None:
    """Maxwell and Betti, between all pairs of places."""
    x, at, heights, _ = changes()
    found = np.array([[np.interp(there, x, heights[np.abs(at - here).argmin()]) for there in at] for here in at])
    inner = found[1:-1, 1:-1]
    print("largest", inner.min(), "asymmetry", np.abs(inner - inner.T).max())
    assert np.abs(inner - inner.T).max() < 5e-4 * np.abs(inner).max()
    assert np.abs(inner[:, 5] - inner[:, -6]).max() > 0.1 * np.abs(inner).max()


@pytest.mark.parametrize(("support", "axis"), [("cable.start", 0), ("cable.start", 1), ("deck.end", 0)])
def test_the_influence_line_of_a_support_force_is_the_shape_of_the_deck_where_that_support_is_moved(
    support: str, axis: int
) -> None:
    """Müller-Breslau: per N downwards the force changes by what the deck rises, per metre by which it is moved."""
    x, at, _, reactions = changes()
    line, side = support.split(".")
    shapes = []
    for way in (MOVED, -MOVED):
        by = [way if a == axis else 0.0 for a in (0, 1)]
        moved = f"{{kind: moving, displacement: {by}}}"
        shapes.append(deck(ropewalk.simulate(given(f"lines.{line}.{side}_support={moved}", NOTHING))))
    rise = (shapes[0][1][0] - shapes[1][1][0]) / (2 * MOVED)
    known = np.interp(at, x, rise)
    found = reactions.sel(support=support).values[:, axis]
    print("known", known[::5], "found", found[::5], np.abs(found - known).max())
    assert np.abs(known).max() > 0.3
    assert found[1:-1] == pytest.approx(known[1:-1], abs=5e-4 * np.abs(known).max())
