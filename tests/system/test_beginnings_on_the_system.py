"""Motions of networks, of lines in calm air and of stiff lines that begin in a mode, whirling, or where another ended.

Sources: the modes of a taut string and of a taut hinged beam, omega^2 = k^2 (T + EI k^2) / rho with k = n pi / L; the
spectrum of the same structure; motion that is not interrupted.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from motion_cases import order
from ropewalk.capabilities import SYSTEM, engine_of
from ropewalk.model import Scenario
from ropewalk.simulate import simulate
from ropewalk.system.small_motion.spectrum import spectrum
from system_cases import HELD_TAUT, deck_on_a_hanger

L, T, RHO = 20.0, HELD_TAUT["tension"], HELD_TAUT["mass"]
CALM: dict[str, Any] = {"wind": {"direction": [1, 0], "speed": 0.0}, "gravity": 0.0}


def moving(
    lines: dict[str, Any], start: dict[str, Any], until: float, every: float, out: Path | None = None, **more: Any
) -> xr.Dataset:
    run = {"kind": "dynamic", "until": until, "every": every, "start": start, **more.pop("run", {})}
    asked = Scenario.model_validate({"lines": lines, "run": run, **CALM, **more})
    assert engine_of(asked) is SYSTEM
    return simulate(asked, file=out)


@pytest.mark.parametrize("stiffness", [0.0, 2e4])
@pytest.mark.parametrize("number", [1, 3])
def test_a_whirling_line_goes_round_as_fast_as_its_mode_swings(stiffness: float, number: int) -> None:
    """In a circle of constant radius, right-handed from start to end; frequencies are right to the fourth order."""
    k, away, radius, sizes = number * np.pi / L, [], 1e-6, (12, 18, 30)
    omega = k * np.sqrt((T + stiffness * k * k) * (1.0 + T / 1e9) / RHO)  # of the mass of a stretched metre
    line = HELD_TAUT | {"wind_drag": 1e-9} | ({"bending_stiffness": stiffness} if stiffness else {})
    start = {"kind": "mode", "number": number, "amplitude": radius, "direction": [0, 0, 1], "whirl": True}
    for n in sizes:
        until = 4.0 * np.pi / omega
        found = moving({"r": {**line, "elements": n}}, start, until, until / 40.0, run={"step": 1e-5 * 12.0 / n})
        at = n // (2 * number)  # a crest
        y, z = found.position.values[:, at, 1], found.position.values[:, at, 2]
        assert np.hypot(y, z) == pytest.approx(radius, rel=1e-3)
        phase = np.unwrap(np.arctan2(-y, z))  # x to the right, right-handed: from z towards -y
        away.append(abs(phase[-1] - 4.0 * np.pi))
    print(away, order([1.0 / n for n in sizes], away))
    assert away[-1] < 1e-2
    assert order([1.0 / n for n in sizes], away) > 3.0


@pytest.mark.parametrize(("direction", "axis"), [([0, 1], 1), ([0, 1, 0], 1)], ids=["up", "sideways"])
def test_a_network_swings_in_the_mode_that_it_begins_with(direction: list[int], axis: int) -> None:
    """Small motion from a mode is cos(omega t) of it, with omega of the spectrum; the second order of the amplitude."""
    start = {"kind": "mode", "number": 1, "amplitude": 1e-5, "direction": direction}
    lines, weight = deck_on_a_hanger(16), {"gravity": 9.81, "joints": {}}
    own = Scenario.model_validate({"lines": lines, "run": {"kind": "equilibrium"}, **CALM, **weight})
    found = spectrum(own, 12)
    assert found.modes is not None
    run = moving(lines, start, 0.5, 0.01, **weight)
    rest = moving(lines, {"kind": "rest"}, 0.5, 0.5, **weight).position.values[:1]
    if len(direction) == 3:  # in the plane there is no y
        rest = np.insert(rest, 1, 0.0, axis=2)
    moved = run.position.values - rest
    top = int(np.abs(moved[0, :, axis]).argmax())
    assert np.linalg.norm(moved[0], axis=1).max() == pytest.approx(1e-5, rel=1e-6)
    assert abs(moved[0, top, axis]) > 0.5e-5
    swings = np.cos(np.outer(run.time.values, found.modes.frequency))
    missed = np.abs(moved[:, None] - moved[0] * swings[:, :, None, None]).max(axis=(0, 2, 3))
    assert missed.min() < 2e-2 * 1e-5


def test_a_motion_goes_on_from_a_stored_instant(tmp_path: Path) -> None:
    lines, weight = deck_on_a_hanger(16), {"gravity": 9.81, "joints": {}}
    start = {"kind": "mode", "number": 2, "amplitude": 0.02}
    whole = moving(lines, start, 0.4, 0.1, **weight)
    path = tmp_path / "first.nc"
    moving(lines, start, 0.2, 0.1, path, **weight)
    rest = moving(lines, {"kind": "result", "file": str(path)}, 0.2, 0.1, **weight)
    assert rest.position.values[-1] == pytest.approx(whole.position.values[-1], abs=1e-9)
    assert np.abs(rest.velocity.values).max() > 0.01
