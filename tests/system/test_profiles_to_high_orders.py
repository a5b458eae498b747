"""Implicit methods and the sixth order over profiles: on the line, and on the ground before it.

Sources: an oscillator whose base goes up and down, in closed form; the same motion in smaller steps.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from profile_cases import HEIGHT, MASS, STIFFNESS, base_excited, read, rig, rows
from ropewalk.simulate import simulate

FINE = {"kind": "dynamic", "geometry": "linearised", "accuracy": 1e-5}


@pytest.mark.parametrize("method", ["implicit", "rkn6"])
@pytest.mark.parametrize(("start", "axle"), [(0.0, 0.0), (-10.0, 0.0), (-10.0, 200.0)])
def test_a_sprung_mass_is_a_base_excited_oscillator(method: str, start: float, axle: float, tmp_path: Path) -> None:
    """It comes from the ground to the line; the beam bends by 4e-4 of the height of the wave."""
    run = {**FINE, "method": method, "until": 0.7, "every": 0.05}
    found = simulate(read(rig({"file": rows(tmp_path / "sine.csv")}, run, start, axle)))
    assert found.attrs["outcome"] == "completed", found.attrs["advice"]
    y = base_excited(found["time"].to_numpy(), start)[0]
    body = found["body_position"].to_numpy()[:, 0, 1] + MASS * 9.81 / STIFFNESS
    print(np.abs(body - y).max() / HEIGHT, np.abs(found["energy"].sel(form="imbalance")).max().item())
    assert np.abs(body - y).max() < 5e-4 * HEIGHT
    missed = float(np.abs(found["energy"].sel(form="imbalance")).max())
    assert missed < 0.5  # 140 J of the waves, 44 kJ of the travel


@pytest.mark.parametrize("method", ["implicit", "rkn6"])
def test_rows_bend_and_do_not_jump(method: str, tmp_path: Path) -> None:
    """On the ground alone: third derivatives jump from row to row, which steps of any length pass: order 4 and more."""

    def error(steps: int) -> float:
        run: dict[str, Any] = {**FINE, "method": method, "until": 0.8, "every": 0.8, "step": 0.8 / steps * (1 + 1e-9)}
        scenario = rig({"file": rows(tmp_path / "sine.csv", 0.02)}, {**run, "accuracy": 1.0}, -19.0)
        scenario["lines"]["deck"] |= {"bending_stiffness": 1e8, "elements": 4}
        found = simulate(read(scenario))
        y = base_excited(found["time"].to_numpy(), -19.0)[0]
        return float(np.abs(found["body_position"].to_numpy()[:, 0, 1] + MASS * 9.81 / STIFFNESS - y).max())

    coarse, fine = error(16), error(32)
    print(coarse, fine, np.log2(coarse / fine))
    assert np.log2(coarse / fine) > 4.0
    assert fine < 2e-3 * HEIGHT
