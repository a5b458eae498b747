"""Ding, Chen, Yang 2012, Convergence of Galerkin truncation ... under a moving load (J. Sound Vib.): linear part.

The data are those of their table 2, with the normalised values as printed (speed 0.01165 sqrt(E/rho), bed
97.552 EA/L^2, damping 39.263 A sqrt(rho E)/L). The published peaks were read off their figure 7.
"""

import math

import numpy as np
import pytest

from ropewalk.theory import beam, foundation

YOUNG, DENSITY, AREA, LENGTH = 6.998e9, 2373.0, 0.3, 160.0
SPEED = 0.01165 * math.sqrt(YOUNG / DENSITY)
LINE = {
    "bending_stiffness": YOUNG * 0.00225,
    "mass": DENSITY * AREA,
    "foundation": 97.552 * YOUNG * AREA / LENGTH**2,
    "damping": 39.263 * AREA * math.sqrt(DENSITY * YOUNG) / LENGTH,
}
LOAD = {"force": 212669.22, "speed": SPEED}


@pytest.mark.parametrize(
    ("modes", "deflection", "place", "published", "error"),
    [
        # the cubic part of their bed and the reading of the figure: 1.3 % and 0.4 %
        (50, 6.495874486e-3, 79.49, 6.578e-3, 9e-5),
        (200, 7.608942645e-3, 79.77, 7.58e-3, 3e-5),
        (2000, 7.617083747e-3, 79.80, None, None),
    ],
)
def test_deflection_with_the_load_at_midspan(
    modes: int, deflection: float, place: float, published: float | None, error: float | None
) -> None:
    x = np.linspace(79.0, 80.5, 151)
    w = beam.moving_force(x, 80.0 / SPEED, length=LENGTH, modes=modes, **LOAD, **LINE)
    assert np.max(w) == pytest.approx(deflection, abs=6e-13)  # digits given
    assert x[np.argmax(w)] == pytest.approx(place, abs=1e-9)
    if published is not None:
        assert np.max(w) == pytest.approx(published, abs=error)


def test_long_beam_is_an_infinite_one() -> None:
    assert foundation.steady_state(0.0, **LOAD, **LINE) == pytest.approx(0.00752040619205, abs=5e-15)  # digits given
    assert foundation.steady_state(-0.202, **LOAD, **LINE) == pytest.approx(0.00761708892, abs=5e-12)  # digits given
    x = np.linspace(60.0, 95.0, 36)
    infinite = foundation.steady_state(x - 80.0, **LOAD, **LINE)
    for kind in ("simply_supported", "clamped"):
        w = beam.moving_force(x, 80.0 / SPEED, length=LENGTH, ends=kind, tolerance=1e-7, **LOAD, **LINE)
        assert w == pytest.approx(infinite, abs=1e-7)  # what is left of the supports and of the start
