"""Inextensible lines linearised about rest: Irvine's frequencies in motion, modes, implicit steps, stiff lines.

Source: Irvine and Caughey, "The linear theory of free vibrations of a suspended cable" (1974), its limit of infinite
lambda^2. Superposition of the modes among the ways that keep lengths (`kind: linear`) is another route to the same
motion, implicit steps with tensions as unknowns a third.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from ropewalk.model import Scenario
from ropewalk.simulate import simulate
from ropewalk.theory import cable

RIGID: dict[str, Any] = {"law": {"kind": "inextensible"}}
STANDS: dict[str, Any] = {"kind": "mass", "mass": 5.0, "travel": {"speed": 0.0, "from": 4.0}}
LOADS: dict[str, dict[str, Any]] = {
    "force": {"kind": "force", "force": [0, -50], "travel": {"speed": 2.0, "from": 2.0}},
    "mass": {"kind": "mass", "mass": 5.0, "travel": {"speed": 5.0, "from": 2.0}},
    "oscillator": {"kind": "oscillator", "mass": 5.0, "stiffness": 2e3, "travel": {"speed": 5.0, "from": 2.0}},
    "bead": {"kind": "mass", "mass": 5.0, "travel": {"kind": "free", "from": 2.0}},
}


def moved(
    load: dict[str, Any] | None, law: dict[str, Any] = RIGID, run: dict[str, Any] | None = None, **line: Any
) -> Any:
    own = {"start": [0, 0], "end": [10, 0], "length": 11.0, "mass": 1.0, "elements": 12, **law, **line}
    asked = {"kind": "dynamic", "geometry": "linearised", "until": 0.4, "every": 0.1} | (run or {})
    if asked["kind"] == "linear":
        del asked["geometry"]
    loads = {"load": {"on": "rope", **load}} if load else {}
    return simulate(Scenario.model_validate({"lines": {"rope": own}, "loads": loads, "run": asked}))


@pytest.mark.parametrize(("number", "family", "which"), [(1, "antisymmetric", 0), (2, "symmetric", 0)])
def test_irvine_caughey_1974_modes_swing_at_their_frequencies(number: int, family: str, which: int) -> None:
    """Half a period of the exact frequency later a mode of any amplitude is on the other side; sag 1/40 of the span.

    Irvine's parabola misses 6e-4 of the frequency, the mesh and the step 2e-3 of the second mode: angles of that.
    """
    span, sag = 40.0, 1.0
    length = span * (1.0 + 8.0 / 3.0 * (sag / span) ** 2 - 32.0 / 5.0 * (sag / span) ** 4)
    exact = cable.natural_frequencies(modes=4, span=span, mass=1.0, sag=sag, lambda_squared=np.inf)
    half = np.pi / float(getattr(exact, family)[which])
    run = {
        "until": half,
        "every": half,
        "step": half / 100,
        "start": {"kind": "mode", "number": number, "amplitude": 1.0},
    }
    line = {"end": [span, 0], "length": length, "elements": 16}
    shape = moved(None, run=run, **line).position.values
    rest = moved(None, run={"until": half, "every": half}, **line).position.values[0]
    np.testing.assert_allclose(shape[1] - rest, rest - shape[0], atol=4e-3)  # m of 1 m


@pytest.mark.parametrize("way", ["modes", "implicit"])
def test_it_is_the_motion_by_another_route(way: str) -> None:
    """Steps of the second order come to it: a mass is set down on the line."""
    asked = {"modes": {"kind": "linear"}, "implicit": {"method": "implicit", "step": 0.02, "accuracy": 1.0}}[way]
    exact = moved(STANDS, run=asked).position.values
    errors = [np.abs(moved(STANDS, run={"step": step}).position.values - exact).max() for step in (8e-3, 4e-3, 2e-3)]
    orders = [np.log2(a / b) for a, b in pairwise(errors)]
    print(errors, orders)
    assert errors[-1] < 5e-5  # m, of 0.2 m
    assert all(1.8 < order < 2.2 for order in orders)


def test_tensions_are_those_of_implicit_steps() -> None:
    run = {"method": "implicit", "step": 0.02, "accuracy": 1.0}
    exact, found = moved(STANDS, run=run).tension.values, moved(STANDS, run={"step": 1e-3}).tension.values
    assert np.abs(found - exact)[1:].max() < 5e-3  # N, of 154 N


def test_by_modes_an_instant_has_the_tensions_of_steps_whatever_was_shown_before() -> None:
    """Steps of 1 ms: what contacts give way in a step, and waves of its first touch, which modes do not have."""
    own = {"kind": "linear", "until": 0.4}
    many, one = (moved(LOADS["mass"], run={**own, "every": every}).tension.values[-1] for every in (0.1, 0.4))
    assert many == pytest.approx(one, rel=1e-6)  # steps of modes are not the same
    steps = moved(LOADS["mass"], run={"every": 0.4, "step": 1e-3}).tension.values
    print(np.abs(one - steps[-1]).max(), np.abs(steps[-1] - steps[0]).max())
    assert one == pytest.approx(steps[-1], abs=1e-3 * float(np.abs(steps[-1] - steps[0]).max()))


def test_a_winch_pays_out_in_small_motion_as_on_a_stiff_line() -> None:
    end = {"kind": "guided", "along": [1, 0], "force": 100.0, "mass": 5.0, "winch": {"speed_limit": 1.0}}
    found = moved(LOADS["mass"], run={"step": 2e-3}, end_support=end)
    errors = [
        np.abs(
            moved(LOADS["mass"], {"axial_stiffness": EA}, end_support=end).position.values - found.position.values
        ).max()
        for EA in (5e4, 1e5)
    ]
    print(errors, np.ptp(found.position.values[:, -1, 0]))
    assert errors[1] < 0.65 * errors[0] < 0.02  # m
    assert np.ptp(found.position.values[:, -1, 0]) > 0.05  # m, along its rail


def test_all_geometry_differs_from_it_by_the_square_of_the_amplitude() -> None:
    """Half of a mode differs by a quarter."""
    off = []
    for amplitude in (0.1, 0.05):
        run = {"step": 2e-3, "start": {"kind": "mode", "number": 2, "amplitude": amplitude}}
        both = [moved(None, run={"geometry": g, **run}).position.values for g in ("linearised", "nonlinear")]
        off.append(np.abs(both[0] - both[1]).max())
    print(off)
    assert 1.8 < np.log2(off[0] / off[1]) < 2.2


def test_a_load_that_rests_stays_at_rest() -> None:
    load = {**STANDS, "travel": {"speed": 1e-9, "from": 2.0}}
    found = moved(load, run={"start": {"with_loads": True}})
    assert np.abs(found.velocity.values).max() < 1e-7  # m/s
