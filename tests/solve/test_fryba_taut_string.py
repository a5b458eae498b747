"""The chain under a small travelling force is the taut string of the classical theory.

Source: L. Fryba, Vibration of Solids and Structures under Moving Loads, ch. 18; the closed form of
`ropewalk.theory.string`.
"""

from __future__ import annotations

import numpy as np
import pytest

from motion_cases import order, taut_string
from ropewalk.simulate import simulate
from ropewalk.theory import string


def error(elements: int, alpha: float, passages: float) -> float:
    """Root mean square difference of the deflection over force, at four instants, in units of L / P."""
    scenario = taut_string(elements, alpha, passages)
    line, load = scenario.lines["string"], scenario.loads["force"]
    result = simulate(scenario)
    lam = 1.0 / line.length
    exact = string.moving_force(
        result.xi.values[None, :], result.time.values[:, None],
        force=1e-6, speed=load.travel.speed, length=line.length, tension=1.0 / lam, mass=line.mass,
    )  # fmt: skip
    return float(np.sqrt(np.mean((-result.position.sel(axis="z").values - exact) ** 2))) / 1e-6


@pytest.mark.parametrize(
    ("alpha", "passages", "largest"),
    # Largest error at 400 links: about twice what a kink smeared over one link must give.
    [(0.5, 0.75, 3e-4), (0.5, 1.6, 5e-4), (0.85, 0.75, 2e-3), (1.3, 0.75, 6e-4), (2.0, 0.75, 2e-4)],
)
def test_deflection_converges_at_first_order(alpha: float, passages: float, largest: float) -> None:
    links = [100, 200, 400]
    errors = [error(n, alpha, passages) for n in links]
    assert errors[-1] < largest
    # The solution has a kink that travels with the load: first order in the mean is what a chain can give. Near the
    # wave speed the layer ahead of the load, (1 - alpha) c t thick, is only just resolved and the order is higher.
    rate = order([1.0 / n for n in links], errors)
    assert 0.9 < rate < (1.6 if alpha == 0.85 else 1.1)


def test_at_the_wave_speed_the_jump_at_the_load_gets_thinner_with_the_links() -> None:
    # The exact deflection jumps at the load, so the largest error stays; the mean one falls as h^0.33, the width of
    # the front of a lattice wave.
    links = [100, 400, 1600]
    rate = order([1.0 / n for n in links], [error(n, 1.0, 0.8) for n in links])
    assert 0.25 < rate < 0.5
