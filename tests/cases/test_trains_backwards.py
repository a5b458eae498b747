"""Trains that run towards the start of a line are the mirror images of those that run towards its end."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk import load
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

HERE = Path(__file__).parent
SPAN = {"start": [0, 0], "end": [50, 0]}
BEAM = {
    **SPAN, "length": 50, "mass": 1e4, "bending_stiffness": 5e10, "axial_stiffness": 1e10, "elements": 12,
    "end_support": {"kind": "guided", "along": [1, 0]},
}  # fmt: skip
ROPE = {**SPAN, "tension": 1e6, "mass": 10, "axial_stiffness": 1e8, "elements": 12, "axial_damping": 1e3}
HANGER = {
    "start": [25, 10], "end": [25, 0], "length": 10, "mass": 1, "axial_stiffness": 1e7, "elements": 2,
    "end_support": {"kind": "joined", "to": "b", "at": 25},
}  # fmt: skip
PIER = {"pier": {"at": 25, "kind": "guided", "along": [1, 0]}}
STRUCTURES: dict[str, dict[str, Any]] = {
    "beam": {"b": BEAM}, "pier": {"b": {**BEAM, "supports": PIER}}, "rope": {"b": ROPE},
    "joined": {"b": BEAM, "h": HANGER},
}  # fmt: skip
AXLES = {"kind": "axles", "on": "b", "forces": [1e4, 2e4, 3e4], "at": [0, 3, 18]}
COACH = {
    "length": 12, "bodies": {"box": {"mass": 1000, "inertia": 5000}}, "wheels": {"r": {"at": -4}, "f": {"at": 4}},
    "springs": {n: {"between": ["box", n], "stiffness": 1e6, "damping": 5e3} for n in "rf"},
}  # fmt: skip
TRAIN = {"kind": "train", "on": "b", "vehicles": {"c": COACH}, "order": ["2 c"]}
RUNS = {
    "dynamic": {"kind": "dynamic", "until": 1.3, "every": 0.13},
    "linearised": {"kind": "dynamic", "geometry": "linearised", "until": 1.3, "every": 0.13},
    "quasistatic": {"kind": "quasistatic", "positions": 8},
}


def run(structure: str, train: dict[str, Any], how: str, speed: float, start: float) -> xr.Dataset:
    own = {**train, "travel": {"speed": speed, "from": start}}
    tree = {"lines": STRUCTURES[structure], "loads": {"t": own}, "run": RUNS[how]}
    return simulate(Scenario.model_validate(tree))


def mirrored(result: xr.Dataset) -> np.ndarray[Any, Any]:
    """Vertical forces of supports, start and end of the line exchanged."""
    force: np.ndarray[Any, Any] = result.reaction.values[..., 1].copy()
    force[:, [0, 1]] = force[:, [1, 0]]
    return force


def test_three_axles_cross_a_pier_backwards_as_forwards() -> None:
    asked = load(HERE / "axles-backwards.yaml", ["lines.b.elements=20", "run.every=50 ms"])
    axles = asked.loads["t"]
    ahead = axles.travel.model_copy(update={"speed": 20.0, "start": 0.0})
    forwards = simulate(asked.model_copy(update={"loads": {"t": axles.model_copy(update={"travel": ahead})}}))
    back = mirrored(simulate(asked))
    assert back == pytest.approx(forwards.reaction.values[..., 1], abs=1e-4 * 267e3)  # rounding of nonlinear steps
    assert back[:, 2].max() == pytest.approx(267e3, rel=0.02)  # over the pier, with 100 elements


@pytest.mark.parametrize("how", RUNS)
@pytest.mark.parametrize("train", [AXLES, TRAIN], ids=["axles", "vehicles"])
@pytest.mark.parametrize("structure", STRUCTURES)
def test_reactions_are_those_of_the_mirrored_run(structure: str, train: dict[str, Any], how: str) -> None:
    there, back = run(structure, train, how, 20.0, -1.0), run(structure, train, how, -20.0, 51.0)
    assert back.attrs["outcome"] == there.attrs["outcome"] == "completed"
    expected = there.reaction.values[..., 1]
    assert np.ptp(expected, axis=0).max() > 1e4  # the train is felt
    # Where lines are joined the node of the joint is found anew; all else is rounding.
    assert mirrored(back) == pytest.approx(
        expected, abs=(2e-4 if structure == "joined" else 1e-5) * np.abs(expected).max()
    )
