"""Crossings of trains by modes: exact in resonance, the same in sweeps as one by one."""

from __future__ import annotations

import numpy as np
import pytest

from ropewalk.linear.chord import Chord
from ropewalk.linear.steady import SteadyForces

DECK = Chord(np.zeros(2), np.array([1.0, 0.0]), np.array([[0.0, -1.0]]), 20.0, 20.0, 0.0, 10e3, 16.2114e9, 0.0, 0.0)


@pytest.mark.parametrize("beside", [0.0, 1e-12, 1e-6, -1e-4])
def test_an_undamped_mode_in_resonance_grows_as_it_must(beside: float) -> None:
    """q'' + w^2 q = F sin w t gives F (sin w t - w t cos w t) / 2 w^2, and beside it what depends on the speed smoothly.

    Forces over 20 m at k V = w turn by a half: F pi / 2 w^2 each, then they swing freely. Four come one after another.
    """
    L, F, k = DECK.length, 100e3, np.pi / DECK.length
    w = k**2 * np.sqrt(DECK.bending_stiffness / DECK.mass)
    V = w / k * (1.0 + beside)
    behind = np.array([0.0, 7.0, 16.0, 31.0])
    t = 1e-3 * np.arange(601.0)
    q, rate = SteadyForces(DECK, -behind, np.full(4, V), np.full(4, F), 1).coordinates(t)
    since = np.clip(t[:, None] - behind / (w / k), 0.0, None)
    on = np.minimum(since, L * k / w)
    known = np.sin(w * on) - w * on * np.cos(w * on)
    free = since > on  # from F (pi, 0) / 2 w^2 on
    known = np.where(free, np.pi * np.cos(w * (since - on)), known).sum(axis=1) * F / (2.0 * w**2)
    grown = np.where(free, -np.pi * np.sin(w * (since - on)), w * on * np.sin(w * on)).sum(axis=1) * F / (2.0 * w)
    slack = 1e-11 + 40.0 * abs(beside)  # phases of up to 2 pi V t / L = 19 come apart by so much
    np.testing.assert_allclose(q[:, 0], known, rtol=0.0, atol=slack * np.abs(known).max())
    np.testing.assert_allclose(rate[:, 0], grown, rtol=0.0, atol=slack * np.abs(grown).max())
