"""Results do not depend on the direction in which a line runs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ropewalk
from ropewalk.scenario import loads

TENSION = 8000.0


def _cable(end: float, run: dict[str, Any], **keys: Any) -> dict[str, Any]:
    line = {"start": [0.0, 0.0], "end": [end, 0.0], "tension": TENSION, "mass": 0.5, "axial_stiffness": 1e6,
            "bending_stiffness": 100.0, "elements": 16, **keys}  # fmt: skip
    load = {"kind": "force", "on": "cable", "force": [0.0, -100.0], "travel": {"speed": 10.0, "from": 6.0}}
    return {"lines": {"cable": line}, "loads": {"force": load}, "run": run}


@pytest.mark.parametrize(
    "run",
    [{"kind": "equilibrium"}, {"kind": "quasistatic", "positions": 3}, {"kind": "dynamic", "until": 0.02}],
    ids=lambda run: run["kind"],
)
@pytest.mark.parametrize("keys", [{}, {"drag": 0.5}, {"foundation": 100.0}], ids=["plain", "drag", "bed"])
def test_a_cable_given_by_its_tension_has_it_whatever_its_direction(run: dict[str, Any], keys: dict[str, Any]) -> None:
    ahead, back = (ropewalk.simulate(ropewalk.Scenario(**_cable(end, run, **keys))) for end in (20.0, -20.0))
    size = float(np.abs(ahead["position"].values[..., 1]).max())
    np.testing.assert_allclose(back["position"].values[..., 1], ahead["position"].values[..., 1], atol=1e-6 * size)
    np.testing.assert_allclose(back["tension"].values, ahead["tension"].values, rtol=1e-6)  # rounding of equilibria


@pytest.mark.parametrize("end", [20.0, -20.0])
def test_supports_of_a_linearised_taut_beam_pull_it_outwards(end: float) -> None:
    text = f"""
lines:
  beam: {{start: [0, 0], end: [{end}, 0], tension: 10 kN, mass: 1.5, axial_stiffness: 2 MN,
    bending_stiffness: 10 kN*m^2, elements: 16}}
run: {{kind: dynamic, until: 1 ms, every: 1 ms, geometry: linearised}}
"""
    along = ropewalk.simulate(loads(text, "beam.yaml", [])).reaction.values[:, :, 0]
    assert along[0] == pytest.approx([-1e4 * np.sign(end), 1e4 * np.sign(end)], rel=1e-9)
