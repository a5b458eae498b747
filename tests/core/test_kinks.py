"""Compliance of a contact beside the spline of its run: difference of the Green's functions of a line and its links."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import Builder, RunProperties

Array = NDArray[np.float64]
LINKS, FORCE = 60, 1e-6
FAR = (30.0, 30.13, 30.25, 30.4, 30.5, 30.71, 30.97)


def taut_beam(bending: float, place: float) -> Bound:
    """Links of 1 m; T + EI/h^2 = 1 N, of which bending bears a part; a small force at so many links."""
    taut = 1.0 - bending
    stretch = 1.0 + taut / 1e6
    builder, points = Builder(gravity=0.0), np.array([np.arange(LINKS + 1.0), np.zeros(LINKS + 1)])
    run = RunProperties(1.0 / stretch, 1.0, 1e6, bending_stiffness=bending)
    builder.fix(*builder.add_run(points, run))
    builder.add_force(0, [0.0, FORCE], place / stretch, 0.0)
    return Bound(*builder.build())


def exact(x: float, bending: float) -> float:
    """Deflection of a taut, hinged beam under a unit force (Timoshenko, Strength of Materials II, ch. 2)."""
    L, taut = float(LINKS), 1.0 - bending
    if bending == 0.0:
        return x * (L - x) / (L * taut)
    if taut == 0.0:
        return x**2 * (L - x) ** 2 / (3.0 * bending * L)
    reach = np.sqrt(bending / taut)
    a, b, c = (1.0 - np.exp(-2.0 * each / reach) for each in (x, L - x, L))
    return float((x * (L - x) / L - 0.5 * reach * a * b / c) / taut)


def compliances(x: float, bending: float) -> tuple[float, float]:
    """That of the core, and what links and their spline lack next to the exact line, m/N."""
    bound = taut_beam(bending, x)
    weights = bound.forces()[1] / FORCE
    inside = slice(LINKS + 2, 2 * LINKS + 1)  # transverse
    stiffness = bound.linearise().stiffness[inside, inside].tocsc()
    weights[[0, -1]] = 0.0
    yields = float(weights[1:-1] @ splu(stiffness).solve(weights[1:-1]))
    return float(bound.contacts().point[1, 0]) / FORCE, exact(x, bending) - yields


@pytest.mark.parametrize(("bending", "part"), [(0.0, 2e-3), (0.04, 1e-2), (0.3, 1.4e-2), (0.7, 2e-2), (1.0, 2.5e-2)])
def test_line_gives_way_between_nodes_as_exact(bending: float, part: float) -> None:
    """So a force in equilibrium is where it is on a continuous line. Nodes alone would miss a fifth of h F/T."""
    found, right = np.array([compliances(x, bending) for x in FAR]).T
    print(bending, np.abs(found / right - 1.0).max())
    np.testing.assert_allclose(found, right, rtol=part)


def test_string_gives_way_near_its_end_as_exact() -> None:
    """But for the last third of a link, where the compliance is kept from vanishing: a quarter is left at the end."""
    found, right = np.array([compliances(x, 0.0) for x in (0.4, 0.6, 0.9, 1.3, 2.2, LINKS - 0.6)]).T
    np.testing.assert_allclose(found, right, rtol=1e-2)
    end, inside = compliances(1e-6, 0.0)[0], compliances(30.0, 0.0)[0]
    assert end == pytest.approx(0.25 * inside, rel=3e-2)
