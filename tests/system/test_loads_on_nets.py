"""Loads of all kinds on nets and membranes, whose ways are laid on the cells: the same as on a line, where it can be.

Sources: the spectrum of what stands there; a strip of parallel threads, each of which is a rope; a pendulum.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from ropewalk.model import Scenario
from ropewalk.simulate import simulate, spectrum_of
from ropewalk.system.assembling.surface import polygon, rectangle
from ropewalk.system.assembling.surface_paths import patch

Tree = dict[str, Any]
NET: Tree = {
    "kind": "net", "corner": [0.0, 0.0, 0.0], "sides": [[4.0, 0.0, 0.0], [0.0, 3.0, 0.0]], "cells": [12, 9],
    "axial_stiffness": 1e5, "mass": 0.1, "tension": 500.0,
}  # fmt: skip
PATH = [[0.5, 1.4], [3.5, 1.6]]


def case(load: Tree, run: Tree, gravity: float = 9.81, **net: Any) -> Scenario:
    parts: Tree = {"nets": {"net": {**NET, **net}}, "loads": {"load": {"on": "net", **load}}, "run": run}
    return Scenario.model_validate({**parts, "gravity": gravity})


def done(load: Tree, run: Tree, gravity: float = 9.81, **net: Any) -> Any:
    found = simulate(case(load, run, gravity, **net))
    assert found.attrs["outcome"] == "completed", found.attrs["advice"]
    return found


def motion(until: float = 0.6, **more: Any) -> Tree:
    return {"kind": "dynamic", "until": until, "every": until / 60, **more}


def travel(**more: Any) -> Tree:
    return {"speed": 3.0, "path": PATH, "at_end": "stay", **more}


@pytest.mark.parametrize("surface", [rectangle((4.0, 3.0), (8, 6)), polygon([[0, 0], [4, 0], [5, 3], [1, 4]], 0.4)])
def test_parts_of_vertices_are_right_for_quadratic_surfaces(surface: Any) -> None:
    u, v = surface.plan.T
    height = 1.0 + 0.3 * u - 0.7 * v + 0.2 * u * u - 0.4 * u * v + 0.1 * v * v
    for place in np.random.default_rng(1).uniform([1.0, 1.0], [3.0, 2.5], (40, 2)):
        near, part = patch(surface, place)
        x, y = place
        exact = 1.0 + 0.3 * x - 0.7 * y + 0.2 * x * x - 0.4 * x * y + 0.1 * y * y
        assert part @ height[near] == pytest.approx(exact, abs=1e-10)


def test_a_place_at_the_rim_is_where_its_two_vertices_are() -> None:
    surface = rectangle((4.0, 3.0), (8, 6))
    near, part = patch(surface, np.array([1.3, 0.0]))
    used = near[np.abs(part) > 1e-12]
    assert sorted(surface.plan[used, 0]) == pytest.approx([1.0, 1.5])
    assert surface.plan[used, 1] == pytest.approx([0.0, 0.0])


def frequency_seen(heights: NDArray[np.float64], times: NDArray[np.float64]) -> float:
    """Of a free swing, by the zeros of its departure from the mean of its extremes."""
    x = heights - 0.5 * (heights.max() + heights.min())
    i = np.flatnonzero(x[1:] * x[:-1] < 0.0)
    zeros = times[i] + x[i] / (x[i] - x[i + 1]) * (times[i + 1] - times[i])
    return float(np.pi * (zeros.size - 1) / (zeros[-1] - zeros[0]))


def test_an_oscillator_on_a_net_swings_as_the_spectrum_of_both_says() -> None:
    """Its spring is so soft that it hardly moves the net, which yields beside it."""
    load = {"kind": "oscillator", "mass": 5.0, "stiffness": 2e3, "travel": travel(speed=0.0)}
    known = spectrum_of(case(load, motion(start={"with_loads": True}), gravity=1e-3), how_many=1).modes.frequency[0]
    seen = done(load, motion(4.0, every=5e-3), gravity=1e-3)
    height = seen.body_position.sel(axis="z").values[:, 0]
    assert frequency_seen(height, seen.time.values) == pytest.approx(known, rel=2e-3)  # the first frame is no rest
    assert known < 0.95 * np.sqrt(2e3 / 5.0)  # the net does give way


@pytest.mark.parametrize("kind", ["mass", "oscillator", "vehicle", "trolley", "matrices"])
def test_all_that_travels_on_a_net_keeps_the_energy(kind: str) -> None:
    own: dict[str, Tree] = {
        "mass": {"mass": 4.0},
        "oscillator": {"mass": 3.0, "wheel_mass": 1.0, "stiffness": 2e3},
        "trolley": {"mass": 1.0, "payload": {"mass": 3.0, "length": 0.5}},
        "vehicle": {
            "bodies": {"car": {"mass": 3.0, "inertia": 0.2}},
            "wheels": {"front": {"at": 0.3, "mass": 0.5}, "rear": {"at": -0.3, "mass": 0.5}},
            "springs": {"a": {"between": ["car", "front"], "stiffness": 2e3},
                        "b": {"between": ["car", "rear"], "stiffness": 2e3}},
        },
        "matrices": {
            "coordinates": ["body", "wheel"], "mass": [[3.0, 0.0], [0.0, 1.0]],
            "stiffness": [[2e3, -2e3], [-2e3, 2e3]], "wheels": {"wheel": {"coordinate": "wheel"}},
        },
    }  # fmt: skip
    missed = []
    for step in (1e-4, 5e-5):
        start = {"from": 0.5} if kind == "vehicle" else {}
        found = done({"kind": kind, **own[kind], "travel": travel(**start)}, motion(step=step))
        missed.append(float(np.abs(found.energy.sel(form="imbalance")).max()))
        most = float(np.abs(found.contact_force.sel(axis="z")).max())
        assert 20.0 < most < 400.0  # presses, and as what weighs 39 N
    print(kind, missed)
    assert missed[1] < 2e-3  # of several J
    assert missed[1] < 0.5 * missed[0] or missed[0] < 1e-5  # of second order in the step


def test_a_bead_slides_down_an_inclined_net_as_on_an_inclined_plane() -> None:
    """On a stiff taut plane at 30 degrees: s = g sin(30) t^2 / 2, with Coulomb friction g (sin - mu cos)."""
    slope = {"sides": [[4.0 * np.cos(np.pi / 6), 0.0, -2.0], [0.0, 3.0, 0.0]], "tension": 5e4, "axial_stiffness": 1e7}
    for mu in (0.0, 0.3):
        free = {"kind": "free", "friction": mu, "from": 0.1, "path": [[0.5, 1.5], [3.5, 1.5]], "at_end": "stay"}
        if mu:
            free["friction_model"] = "block"
        found = done({"kind": "mass", "mass": 1.0, "travel": free}, motion(0.6, every=0.01), **slope)
        way = found.contact_xi.values[:, 0] - 0.1
        exact = 0.5 * 9.81 * (0.5 - mu * np.cos(np.pi / 6)) * found.time.values**2
        print(mu, np.abs(way - exact).max(), exact.max())
        # The net gives way by 1 mm, and the bead is in a hollow that goes with it.
        assert np.abs(way - exact).max() < 0.01 * exact.max()


def test_a_walker_crosses_a_net() -> None:
    legs = {"leg_stiffness": 1750.0, "leg_damping": 20.0, "foot_mass": 0.2}
    load = {"kind": "walker", "mass": 10.0, **legs, "path": PATH}
    found = done(load, motion(1.5, step=1e-4))
    feet = np.nansum(found.contact_force.sel(axis="z").values, axis=1)
    assert -feet.mean() == pytest.approx(98.1, rel=0.25)  # a few steps, not whole periods
    assert np.nanmax(found.contact_xi.values) > 1.0
    assert float(np.abs(found.energy.sel(form="imbalance")).max()) < 0.05


def test_the_spectrum_at_an_instant_is_that_of_rest_where_nothing_moves() -> None:
    load = {"kind": "mass", "mass": 2.0, "travel": travel(speed=0.0)}
    run = motion(0.2, start={"with_loads": True})
    rest = spectrum_of(case(load, run), how_many=4).modes.frequency
    later = spectrum_of(case(load, run), at=0.1, how_many=4).modes.frequency
    assert later == pytest.approx(rest, rel=1e-6)  # to which the rest is found, and what a step leaves
