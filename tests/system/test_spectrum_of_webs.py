"""Natural frequencies of networks with a mass and with dampers against an assembly of their own; and at instants."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import eig, eigh

from ropewalk.model import Scenario
from ropewalk.simulate import spectrum_of
from ropewalk.solve.spectrum import Modes
from web_cases import EA, HUNG, RHO, SPAN, TENSION, N, cross

Array = NDArray[np.float64]


def standing(place: float, mass: float) -> dict[str, Any]:
    return {"kind": "mass", "on": "west", "mass": mass, "travel": {"speed": 0.0, "from": place}}


def modes_of(scenario: Scenario, how_many: int = 12, **more: Any) -> Modes:
    found = spectrum_of(scenario, how_many=how_many, **more).modes
    assert found is not None
    return found


def assembled(
    place: float | None, mass: float, damping: float = 0.0, drag: float = 0.0, links_each: int = N
) -> tuple[Array, Array, Array]:
    """K, C and M of the same cross of straight links: a node more where the mass divides one; all ends held."""
    points, links = [np.zeros(3)], []
    masses = [0.0]
    for name in SPAN:
        start, T = np.array(SPAN[name], dtype=float), TENSION[name]
        stretch, span = 1.0 + T / EA, float(np.linalg.norm(SPAN[name]))
        rest = span / stretch / links_each
        at = [(i * rest, RHO[name] * rest) for i in range(1, links_each)]
        if place is not None and name == "west":
            at = sorted([*at, (place, mass)])
        begin, last = -1, 0.0  # -1: the fixed end
        for x, m in [*at, (links_each * rest, 0.5 * RHO[name] * rest)]:
            end = 0 if m == 0.5 * RHO[name] * rest and x == links_each * rest else len(points)
            if end:
                points.append(start * (1.0 - x * stretch / span))
                masses.append(m)
            else:
                masses[0] += m
            links.append((begin, end, x - last, -start / span, T))
            begin, last = end, x
    size = 3 * len(points)
    K, C = np.zeros((size, size)), np.zeros((size, size))
    for i, j, rest, e, T in links:
        along = np.outer(e, e)
        block = EA / rest * along + T / (rest * (1.0 + T / EA)) * (np.eye(3) - along)
        for matrix, part in ((K, block), (C, damping / rest * along)):
            for a, b, sign in ((i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)):
                if a >= 0 and b >= 0:
                    matrix[3 * a : 3 * a + 3, 3 * b : 3 * b + 3] += sign * part
    M = np.repeat(masses, 3)
    if place is None:
        C += drag * np.diag(M)
    return K, C, np.diag(M)


@pytest.mark.parametrize(("place", "mass", "off"), [(3.1, 4.0, 2e-3), (7.5, 0.4, 2e-3), (None, 0.0, 5e-4)])
def test_a_network_that_carries_a_mass_has_the_frequencies_of_another_assembly(place, mass, off) -> None:
    coarse, fine = (
        np.sqrt(eigh(K, M, eigvals_only=True, subset_by_index=(0, 11)))
        for K, _, M in (assembled(place, mass, links_each=n) for n in (24, 48))
    )
    exact = fine + (fine - coarse) / 3.0  # straight links are of the second order
    found = modes_of(cross(standing(place, mass) if place is not None else None, damped={"elements": 24})).frequency
    print(found / exact - 1.0)
    assert found == pytest.approx(exact, rel=off)
    bare = modes_of(cross(damped={"elements": 24})).frequency
    assert place is None or np.abs(bare / exact - 1.0).max() > 0.05


def test_axial_dampers_and_drag_damp_a_network_as_the_quadratic_eigenvalue_problem_says() -> None:
    K, C, M = assembled(None, 0.0, damping=300.0, drag=0.6, links_each=24)
    n = K.shape[0]
    one, none = np.eye(n), np.zeros((n, n))
    values = eig(np.block([[none, one], [-K, -C]]), np.block([[one, none], [none, M]]), right=False)
    modes = modes_of(cross(damped={"axial_damping": 300.0, "drag": 0.6, "elements": 24}), how_many=216)
    for w, ratio in zip(modes.frequency[:24], modes.ratio, strict=False):
        seen = complex(-ratio * w, w * np.sqrt(1.0 - ratio**2))
        nearest = values[np.abs(values - seen).argmin()]
        # Straight links are of the second order: (k h)^2/24, 1.2 % for waves of 12 links.
        assert nearest.imag == pytest.approx(seen.imag, rel=1.5e-2)
        assert nearest.real == pytest.approx(seen.real, rel=1e-2)
    assert (modes.ratio > 1.2 * 0.3 / modes.frequency).any()  # axial ones
    assert modes.ratio[0] == pytest.approx(0.3 / modes.frequency[0], rel=1e-6)  # transverse: drag alone


@pytest.mark.parametrize("kind", [{"kind": "mass", "mass": 60.0}, {"kind": "force", "force": [0, -500]}])
def test_an_instant_of_a_network_that_stands_still_has_the_spectrum_of_that_rest(kind) -> None:
    load = {**kind, "on": "rope", "travel": {"speed": 0.0, "from": 14.2}}
    dynamic = {"kind": "dynamic", "until": 0.05, "step": 1e-3, "start": {"with_loads": True}}
    rest = modes_of(Scenario.model_validate({**HUNG, "loads": {"load": load}, "run": {"kind": "equilibrium"}}))
    still = Scenario.model_validate({**HUNG, "loads": {"load": load}, "run": dynamic})
    # Kinks under masses give way in a step, by its square: twice that with 2.2 ms.
    off = 2e-3 if "mass" in kind else 1e-6
    assert modes_of(still, at=0.05).frequency == pytest.approx(rest.frequency, rel=off)
    assert modes_of(still).frequency == pytest.approx(rest.frequency, rel=1e-9)
    bare = modes_of(Scenario.model_validate({**HUNG, "run": {"kind": "equilibrium"}}))
    assert np.abs(bare.frequency / rest.frequency - 1.0).max() > 0.1
