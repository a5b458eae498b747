"""Natural frequencies of beams of networks, and of what stands on them, about rest.

Sources: the taut beam in closed form, and its frequency equations with a mass and an oscillator (`loaded_spectra`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from loaded_spectra import of_beam, rigid, roots, sprung
from motion_cases import order
from ropewalk.model import Scenario
from ropewalk.simulate import spectrum_of
from ropewalk.system.elements.air import damping_by_wind
from ropewalk.system.elements.structure import Buffers
from ropewalk.system.equilibrium.rest import _add_wind_forces, at_rest
from ropewalk.system.equilibrium.structures import structure_of

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


def test_wind_damps_a_string_twice_as_much_along_itself_as_across() -> None:
    """rho/2 d |u| u across the string: rho d V for what moves with the wind, rho/2 d V for what moves across it."""
    V, d, rho, m, links, missed = 8.0, 0.04, 1.225, 0.5, [32, 64], []
    string = {"start": [0, 0, 0], "end": [20, 0, 0], "tension": 2e4, "mass": m, "axial_stiffness": 1e7, "wind_drag": d}
    for elements in links:
        modes = spectrum_of(Scenario.model_validate({
            "gravity": 0.0, "wind": {"direction": [0.6, 0.8, 0], "speed": V}, "run": {"kind": "equilibrium"},
            "lines": {"string": {**string, "elements": elements}},
        }), how_many=6).modes  # fmt: skip
        assert modes is not None
        sideways = np.abs(modes.shape[:, :, 1]).max(axis=1) > 0.5
        assert np.array_equal(np.sort(sideways), [False] * 3 + [True] * 3)
        # N s/m^2 of the unstrained string, which is stretched by T/EA; wind along it does nothing.
        per = rho * d * 0.8 * V * np.where(sideways, 1.0, 0.5) * (1.0 + 2e4 / 1e7)
        missed.append(float(np.abs(modes.ratio / (per / (2.0 * m * modes.frequency)) - 1.0).max()))
    print(missed)
    assert missed[-1] < 6e-3  # the velocity of a link is the mean of those of its ends
    assert 1.9 < order([1.0 / n for n in links], missed) < 2.1


@pytest.mark.parametrize("sheaves", [{}, {"wheel": {"at": [5, 3]}}])
def test_damping_by_wind_is_what_its_forces_change_by(sheaves: dict[str, Any]) -> None:
    line = {"start": [0, 0], "end": [12, 1], "length": 14.0, "mass": 1.0, "axial_stiffness": 1e5, "elements": 12}
    asked = Scenario.model_validate({
        "lines": {"line": {**line, "wind_drag": 0.3, "sheaves": sheaves}}, "run": {"kind": "equilibrium"},
        "wind": {"direction": [1, 2, 0.3], "speed": 7.0},
    })  # fmt: skip
    assembled = structure_of(asked, 0.0, ("x", "y", "z"))
    structure, rest = at_rest(assembled.structure, np.array([0.0, 0.0, -9.81]), assembled.near)
    r = rest + 0.05 * np.random.default_rng(1).normal(size=rest.shape)

    def air(v: np.ndarray) -> np.ndarray:
        room = Buffers.of(structure, 3)
        _add_wind_forces(structure.for_kernels, room.for_kernels(structure), r, v.reshape(r.shape), 0.0)
        return room.air.ravel()

    seen = [(air(-way) - air(way)) / 2e-6 for way in 1e-6 * np.eye(r.size)]
    assert pytest.approx(np.array(seen), abs=1e-8) == damping_by_wind(structure, r, 0.0).toarray().T  # rounding
