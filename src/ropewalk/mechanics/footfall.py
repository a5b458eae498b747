"""Footfalls: when and how strongly the feet of a person with a given gait press on the line."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.model.footsteps import Footsteps

# Samples of the force in each step: linear in between, the fourth harmonic is right to 1e-3 of its amplitude.
SAMPLES = 200


@dataclass(frozen=True)
class Footfall:
    """The force of one foot of a person, every second step of hers.

    Both feet together press with G (1 + sum a_i sin(2 pi i f t - phi_i)). While both stand, the share of the one that
    has landed grows from 0 to 1 as (1 - cos(pi s)) / 2.
    """

    gait: Footsteps
    foot: int  # 0: that of steps 0, 2, 4, ...; 1: that of steps 1, 3, 5, ...
    gravity: float  # m/s^2

    def __call__(self, t: float | Array) -> Array:
        """Force (..., 2) in N on the line at the times t in s: [Fx, Fz]."""
        t = np.asarray(t, dtype=float)
        vertical = -self._total(t) * self._share(t)
        return np.stack((np.zeros_like(vertical), vertical), axis=-1)

    def instants(self, until: float) -> Array:
        """Times up to `until` between which the force may be interpolated, s."""
        step = 1.0 / self.gait.frequency
        count = int(np.ceil(until / step)) + 1
        fine = np.linspace(0.0, step, SAMPLES, endpoint=False)
        within = np.unique(np.concatenate((fine, [self.gait.overlap * step])))
        return np.asarray((step * np.arange(count)[:, None] + within).ravel())

    def _total(self, t: Array) -> Array:
        f = self.gait.frequency
        terms = (
            term.amplitude * np.sin(2.0 * np.pi * i * f * t - term.phase)
            for i, term in enumerate(self.gait.harmonics(), start=1)
        )
        return np.asarray(self.gait.mass * self.gravity * (1.0 + np.sum([*terms, np.zeros_like(t)], axis=0)))

    def _share(self, t: Array) -> Array:
        """Part of the force that this foot bears."""
        number = np.floor(t * self.gait.frequency * (1.0 + 1e-15))
        into = t * self.gait.frequency - number  # part of the present step that is over
        grown = np.ones_like(t)
        if self.gait.overlap > 0.0:
            grown = 0.5 - 0.5 * np.cos(np.pi * np.clip(into / self.gait.overlap, 0.0, 1.0))
        grown = np.where(number == 0, 1.0, grown)  # the first foot stands from the beginning
        return np.where(number % 2 == self.foot, grown, 1.0 - grown)
