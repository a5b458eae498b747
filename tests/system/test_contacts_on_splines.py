"""The spline of contacts, and how a line gives way beside it.

Sources: I. J. Schoenberg's quasi-interpolation by splines for the polynomials; the Green's functions of taut beams; and
the Fourier transforms of a line and of its links under a force that moves steadily.
"""

from __future__ import annotations

import numpy as np
import pytest

from ropewalk.system.elements.compliance import CELL, CORRECTION, KINETIC, PARTS, SHARES, SHORT, compliance, compliances
from ropewalk.system.elements.spline import SHARPENED, WIDTH, share


def at(x: float, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Weights of all nodes in the point at x and in its derivative."""
    own, slope = np.zeros(WIDTH), np.zeros(WIDTH)
    first = share(x, n, own, slope)
    out = np.zeros((2, max(n + 1, first + WIDTH)))
    out[:, first : first + WIDTH] = own, slope
    return out[0, : n + 1], out[1, : n + 1]


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_it_goes_through_polynomials_up_to_the_third_degree(degree: int) -> None:
    nodes = np.arange(21.0) - 10.0
    for x in np.linspace(4.0, 16.0, 37):
        weight, slope = at(float(x), 20)
        assert weight @ nodes**degree == pytest.approx((x - 10.0) ** degree, abs=1e-11)
        assert slope @ nodes**degree == pytest.approx(degree * (x - 10.0) ** max(degree - 1, 0), abs=1e-11)


@pytest.mark.parametrize("n", [2, 3, 5, 7, 30])
def test_it_is_smooth_at_nodes_and_ends_in_the_end_nodes(n: int) -> None:
    for node in range(1, n):
        for before, after in zip(at(node - 1e-9, n), at(node + 1e-9, n), strict=True):
            assert np.abs(before - after).max() < 1e-8  # of slopes of a few per link
    for end in (0, n):
        expected = np.eye(n + 1)[end]
        assert np.abs(at(float(end), n)[0] - expected).max() < 1e-14
    assert np.abs(at(0.3 * n, n)[0] - at(0.7 * n, n)[0][::-1]).max() < 1e-14


def test_the_compliance_beside_it_is_positive_and_hardly_depends_on_the_place_in_a_link() -> None:
    kappa = 1.0 / compliances()[0]
    inside = kappa[:, 4 * PARTS :]  # beyond four links from a support it is as on a long line
    assert (kappa[:, 1:] > 0.0).all()
    assert (np.ptp(inside, axis=1) < 0.06 * inside.mean(axis=1)).all()
    assert kappa.shape[0] == SHARES


@pytest.mark.parametrize("x", [0.1, 0.5, 2.3, 40.4])
def test_the_stiffness_of_a_kink_is_concave_in_the_tension(x: float) -> None:
    """S = T/kappa(EI/(h^2 T)) is the least energy of all shapes of a kink over d^2/2, and linear in T for each of them.

    Not quite where bending is nearly all: there the run of the table is too short for its ends not to be felt.
    """
    T, out, found = np.geomspace(1.2, 1e4, 20001), np.zeros(4), []
    for tension in T:
        compliance(x, CELL, float(np.sqrt(1.0 / tension)), compliances(), out)
        found.append(tension / out[0])
    slope = np.diff(found) / np.diff(T)
    assert (np.diff(slope) < 1e-9 * slope[0]).all()


def test_kinks_that_are_carried_along_are_as_in_the_transform() -> None:
    k = np.linspace(1e-2, 60.0, 600_001)
    k = 0.5 * (k[1:] + k[:-1])
    s = np.sin(0.5 * k) ** 2
    links = 4.0 * s + CORRECTION / 12.0 * 16.0 * s**2 + SHORT / 24.0 * 64.0 * s**3
    spline = (np.sin(0.5 * k) / (0.5 * k)) ** 6 * (1.0 + 4.0 * SHARPENED * s)

    def kappa(square: float) -> float:
        # a little damping stands for the principal value where links have a wave as fast as the kink
        gap = 1.0 / (k * k * (1.0 - square)) - (spline**2 / (links - square * k * k * (1.0 + 3e-4j))).real
        return float((gap.sum() * (k[1] - k[0]) + 1.0 / (60.0 * (1.0 - square))) / np.pi)

    still = kappa(0.0)
    found = [kappa(square) * (1.0 - square) / still for square in KINETIC[0]]
    assert np.abs(found - KINETIC[1]).max() < 2e-3  # the table has four digits, the sum three at 0.95
    assert still == pytest.approx((1.0 / compliances()[0, 0, 4 * PARTS :]).mean(), rel=0.03)  # the mean over a link
