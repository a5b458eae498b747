"""What matters: effects of parameters beside closed forms."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from ropewalk.errors import RopewalkError, ScenarioError
from ropewalk.model import Sweep
from ropewalk.scenario import loads
from ropewalk.sweeps.command import plain
from ropewalk.sweeps.dataset import effects_table, sweep_table
from ropewalk.sweeps.plan import Plan
from ropewalk.sweeps.sensitivity import effects, points
from ropewalk.sweeps.sweeping import sweep
from ropewalk.sweeps.writing import read, write

pytest.importorskip("SALib")

BRIDGE = """\
gravity: 0
lines: {deck: {start: [0, 0], end: [20, 0], length: 20, mass: 10e3, bending_stiffness: 16e9, axial_stiffness: 1e10}}
loads: {train: {kind: axles, on: deck, forces: 100 kN, at: [0, 3, 9, 14], travel: {speed: 50}}}
run: {kind: linear, until: crossing, every: 20 ms, modes: 2}
"""
FORCE, MASS = (100.0, 200.0), (5.0, 10.0)
OVER = {"loads.train.forces": "uniform(100 kN, 200 kN)", "lines.deck.mass": "uniform(5 t/m, 10 t/m)"}
SAME_FREQUENCIES = {"lines.deck.bending_stiffness": "1.6e6 m^4/s^2 * mass"}


def sobol_indices_of_the_deflection() -> tuple[list[float], list[float]]:
    """Of c F / m, a product of independent factors F and 1 / m, whose moments are known."""
    (a, b), (c, d) = FORCE, MASS
    mean = (a + b) / 2.0, np.log(d / c) / (d - c)
    square = (a * a + a * b + b * b) / 3.0, 1.0 / (c * d)
    own = [s - m * m for s, m in zip(square, mean, strict=True)]
    whole = square[0] * square[1] - (mean[0] * mean[1]) ** 2
    first = [own[0] * mean[1] ** 2 / whole, own[1] * mean[0] ** 2 / whole]
    total = [own[0] * square[1] / whole, own[1] * square[0] / whole]
    return first, total


def test_the_variance_of_a_deflection_is_shared_by_force_and_mass_as_its_formula_says(tmp_path: Path) -> None:
    """512 cases: a bridge of known frequencies moves by c F / m. Estimates are within their intervals of 0.1 to 0.3."""
    found = sweep(
        loads(BRIDGE), OVER, derived=SAME_FREQUENCIES, record="max deflection of deck", combine="saltelli", count=128,
        workers=0,
    )  # fmt: skip
    assert found.sizes["case"] == 128 * 4
    assert found["parameter"].values.tolist() == found.attrs["parameters"]
    for name, known in zip(("first_order", "total"), sobol_indices_of_the_deflection(), strict=True):
        missed = np.abs(found[name].values[0] - known)
        assert missed.max() < 0.05
        assert (missed < found[f"{name}_interval"].values[0]).all()
        assert found[f"{name}_interval"].values.max() < 0.3
    assert len(sweep_table(found)) == 512
    table = effects_table(found)
    assert table is not None
    assert len(table) == len(plain(found)["effects"]) == 2
    json.dumps(plain(found))
    write(found, tmp_path / "effects.nc")
    again = read(tmp_path / "effects.nc")
    assert again is not None
    np.testing.assert_allclose(again["total"].values, found["total"].values)


def test_morris_tells_straight_from_curved_and_nothing() -> None:
    """y = 3 a + b^2: the effect of a is 3 everywhere, of b 1 +- 1/3 by steps of 2/3 on its grid, of c none."""
    at = points(3, "morris", 40, 1)
    found = effects("morris", at, {"y": 3.0 * at[:, 0] + at[:, 1] ** 2, "same": np.ones(len(at))}, 1)
    assert found["mean_effect"][0] == pytest.approx([3.0, 1.0, 0.0], abs=0.12)
    assert found["mean_effect"][0, 0] == pytest.approx(3.0, abs=1e-12)
    assert found["deviation_of_effects"][0] == pytest.approx([0.0, 1.0 / 3.0, 0.0], abs=0.03)
    assert np.isnan(found["mean_effect"][1]).all(), "what does not vary has no effects"


def test_sobol_indices_of_the_function_of_ishigami() -> None:
    """sin x + 7 sin^2 y + 0.1 z^4 sin x over (-pi, pi): 0.3139, 0.4424, 0, and in all 0.5576, 0.4424, 0.2437."""
    at = points(3, "saltelli", 2048, 2)
    x, y, z = ((2.0 * at - 1.0) * np.pi).T
    found = effects("saltelli", at, {"f": np.sin(x) + 7.0 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x)}, 2)
    first, last = 0.5 * (1.0 + 0.1 * np.pi**4 / 5.0) ** 2, 0.01 * np.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    parts = np.array([first, 49.0 / 8.0, 0.0])
    known = parts / (parts.sum() + last)
    assert found["first_order"][0] == pytest.approx(known, abs=0.01)
    assert found["total"][0] == pytest.approx((parts + np.array([last, 0.0, last])) / (parts.sum() + last), abs=0.01)


def test_a_quantity_that_a_case_lacks_has_no_effects() -> None:
    at = points(2, "saltelli", 8, 0)
    values = at[:, 0].copy()
    values[3] = np.nan
    assert np.isnan(effects("saltelli", at, {"y": values}, 0)["total"]).all()


def test_what_cannot_be_drawn_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    endless = {"loads.train.forces": "normal(100 kN, 1 kN)"}
    with pytest.raises(ScenarioError, match="requires a lowest and a highest value"):
        Plan.of(loads(BRIDGE), Sweep(over=endless, combine="morris", count=3))
    assert len(Plan.of(loads(BRIDGE), Sweep(over=endless, combine="saltelli", count=2)).rows) == 6

    def without(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr("ropewalk.sweeps.sensitivity.import_module", without)
    with pytest.raises(RopewalkError, match=r"ropewalk\[sensitivity\]"):
        points(2, "morris", 4, 0)
