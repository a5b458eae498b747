"""What is known of footbridges under crowds by other ways: SETRA's equivalent number, the theory of the pendulum."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ropewalk.model import Crowd
from ropewalk.theory.lateral_balance import sway_growth

FREQUENCY, RATIO, MASS, LENGTH = 1.1, 0.007, 900.0, 60.0
"""Of the lateral mode of examples/footbridge-lock-in.yaml: Hz, over critical, kg/m, m."""


def setra(number: int, ratio: float, mass: float, length: float, force: float = 280.0) -> float:
    """Largest vertical acceleration in m/s^2 under a sparse crowd, for a mode of half waves of a sine.

    10.8 sqrt(N xi) people spread over the deck press in resonance, each with 280 N, with the sign of the mode (SETRA,
    Footbridges, technical guide, 2006, 2.3 and 2.4).

    Args:
        number: of people.
        ratio: damping over critical.
        mass: kg/m.
        length: m.
        force: N.
    """
    return 10.8 * (number * ratio) ** 0.5 * force * (2.0 / np.pi) / (2.0 * ratio * 0.5 * mass * length)


def growth_of_the_sway(result: xr.Dataset) -> float:
    """Growth rate of the first lateral mode from 10 s on, 1/s."""
    shape, w = np.sin(np.pi * result.xi.values / LENGTH), 2.0 * np.pi * FREQUENCY
    q, v = (result[key].sel(axis="y").values @ shape for key in ("position", "velocity"))
    late = result.time.values >= 10.0
    return float(np.polyfit(result.time.values[late], 0.5 * np.log(q**2 + (v / w) ** 2)[late], 1)[0])


def growth_by_theory(number: int) -> float:
    """The same of the pendulum's theory, 1/s."""
    people = Crowd(on="deck", number=number).people(LENGTH)
    root = sway_growth(
        FREQUENCY, damping_rate=4.0 * np.pi * RATIO * FREQUENCY, modal_mass=0.5 * MASS * LENGTH, leg_length=1.17,
        mass=[person.mass for person in people], step_time=[1.0 / person.frequency for person in people],
    )  # fmt: skip
    return root.real
