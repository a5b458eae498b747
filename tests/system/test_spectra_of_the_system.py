"""Natural frequencies of beams of networks, and of what stands on them, about rest.

Sources: the taut beam in closed form, and its frequency equations with a mass and an oscillator (`loaded_spectra`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from loaded_spectra import of_beam, rigid, roots, sprung
from motion_cases import order
from ropewalk.errors import ScenarioError
from ropewalk.model import Scenario
from ropewalk.simulate import spectrum_of

BEAM = {
    "start": [0, 0], "end": [1, 0], "length": 1.0, "mass": 1.0, "axial_stiffness": 1e6, "bending_stiffness": 1.0,
    "wind_drag": 1e-30,
}  # fmt: skip


def frequencies(load: dict[str, Any] | None = None, elements: int = 32, speed: float = 0.0, **line: Any) -> np.ndarray:
    """Angular frequencies of a hinged beam in calm air, rad/s, ascending; of both planes."""
    loads = {"load": {**load, "on": "beam", "travel": {"speed": 0.0, "from": 0.5}}} if load else {}
    modes = spectrum_of(Scenario.model_validate({
        "gravity": 0.0, "wind": {"direction": [1, 0], "speed": speed}, "run": {"kind": "equilibrium"},
        "lines": {"beam": {**BEAM, "elements": elements, **line}}, "loads": loads,
    }), how_many=8).modes  # fmt: skip
    assert modes is not None
    return modes.frequency


def test_a_beam_on_a_foundation_swings_higher_in_its_plane() -> None:
    """w^2 = EI k^4 + bed, across the plane without bed: with the fourth power of the mesh."""
    links, missed = [16, 32], []
    k = np.pi * np.arange(1, 4)
    known = np.sort(np.concatenate([k**2, np.sqrt(k**4 + 500.0)]))
    for elements in links:
        found = frequencies(elements=elements, foundation=500.0)[: known.size]
        missed.append(float(np.abs(found / known - 1.0).max()))
    print(missed)
    assert missed[-1] < 2e-4
    assert 3.7 < order([1.0 / n for n in links], missed) < 4.3


@pytest.mark.parametrize("kind", ["mass", "oscillator"])
def test_what_stands_on_a_beam_swings_with_it(kind: str) -> None:
    load = {"kind": "mass", "mass": 0.5} if kind == "mass" else {"kind": "oscillator", "mass": 0.5, "stiffness": 51.3}
    law = rigid(0.5) if kind == "mass" else sprung(0.5, 51.3)
    known = roots(of_beam(1.0, 1.0, 1.0), law, 2, 100.0)
    found = frequencies(load)
    nearest = [float(found[np.abs(found - w).argmin()]) for w in known]
    print(known, nearest)
    assert nearest == pytest.approx(list(known), rel=3e-4)


def test_damping_by_wind_is_refused_where_it_is_not_known() -> None:
    with pytest.raises(ScenarioError, match=r"wind\.speed"):
        frequencies(speed=3.0)
