"""Footfalls: when and how strongly the feet of a person with a given gait press on the line."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.sideways import Sideways
from ropewalk.model.footsteps import Footsteps

# Samples of the force in each step: linear in between, the fourth harmonic is right to 1e-3 of its amplitude.
SAMPLES = 200


def stands_at(gait: Footsteps, number: Array | Integers, length: float) -> Array:
    """Where steps (step,) of a person stand along a line of a length in m, if she steps on it, m."""
    place = gait.start + gait.onward * gait.step_length * np.asarray(number, dtype=float)
    if gait.at_end == "stay":
        place = np.clip(place, 0.0, length)
    if gait.at_end == "again":
        place = np.mod(place, length)
    return place


def footfalls(gait: Footsteps, foot: int, length: float, until: float) -> tuple[Array, Array]:
    """Times in s at which a foot lands or is taken up, and where along a line of a length in m it stands from then on.

    In the air it stands nowhere, which is not a number. Who would step off an end stays there, leaves the line with
    both feet, goes on at the other end, or, if that is to be refused, stands beyond it. Who leaves may come late.

    Args:
        gait: of the person.
        foot: 0: that of steps 0, 2, 4, ...; 1: that of steps 1, 3, 5, ...
        length: m.
        until: s.

    Returns:
        Times (landing or take-off,) from 0, and places, m.
    """
    period = 1.0 / gait.frequency
    number = np.arange(int(np.ceil(until / period)) + 3)
    place = stands_at(gait, number, length)
    own = number[foot::2]
    begin, end = (own - gait.phase) * period, (own + 1.0 + gait.overlap - gait.phase) * period
    times = np.maximum(np.column_stack([begin, end]).ravel(), 0.0)
    on, left = (place >= 0.0) & (place <= length), np.inf
    if gait.at_end == "leave":
        place = np.where(on, place, np.nan)
        came = int(np.argmax(on)) if on.any() else number.size
        gone = np.flatnonzero(~on[came:])
        left = (came + gone[0] - gait.phase) * period if gone.size else np.inf
    places = np.column_stack([place[own], np.full(own.size, np.nan)]).ravel()
    if np.isfinite(left):
        times, places = np.append(times[times < left], left), np.append(places[times < left], np.nan)
    return (times, places) if foot == 0 else (np.append(0.0, times), np.append(np.nan, places))


@dataclass(frozen=True)
class Footfall:
    """The force of one foot of a person, every second step of hers.

    Both feet together press with G (1 + sum a_i sin(2 pi i f t - phi_i)), and to the side of the first foot with
    G sum b_j sin(pi (2 j - 1) f t - psi_j), t from the landing of the first foot. While both stand, the share of the
    one that has landed grows from 0 to 1 as (1 - cos(pi s)) / 2.
    """

    gait: Footsteps
    foot: int  # 0: that of steps 0, 2, 4, ...; 1: that of steps 1, 3, 5, ...
    gravity: float  # m/s^2
    side: Sideways | None = None  # to the side of the first foot, if it pushes there

    def __call__(self, t: float | Array) -> Array:
        """Force (..., axis) in N on the line at the times t in s: [Fx, Fz], [Fx, Fy, Fz] if it pushes to the side."""
        t = np.asarray(t, dtype=float) + self.gait.phase / self.gait.frequency
        vertical = -self._total(t) * self._share(t)
        if self.side is not None:
            push, side = self._push(t) * self._share(t), self.side.at(self._place(t, self.side.length))
            return np.stack((side[..., 0] * push, side[..., 1] * push, vertical), axis=-1)
        return np.stack((np.zeros_like(vertical), vertical), axis=-1)

    def instants(self, until: float) -> Array:
        """Times up to `until` between which the force may be interpolated, s."""
        step = 1.0 / self.gait.frequency
        count = int(np.ceil(until / step)) + 2
        fine = np.linspace(0.0, step, SAMPLES, endpoint=False)
        within = np.unique(np.concatenate((fine, [self.gait.overlap * step])))
        times = (step * np.arange(count)[:, None] + within).ravel() - self.gait.phase * step
        return np.asarray(times if self.gait.phase == 0.0 else np.append(0.0, times[times > 0.0]))

    def _total(self, t: Array) -> Array:
        f = self.gait.frequency
        terms = (
            term.amplitude * np.sin(2.0 * np.pi * i * f * t - term.phase)
            for i, term in enumerate(self.gait.harmonics(), start=1)
        )
        return np.asarray(self.gait.mass * self.gravity * (1.0 + np.sum([*terms, np.zeros_like(t)], axis=0)))

    def _push(self, t: Array) -> Array:
        """Force of both feet to the side of the first one."""
        f = self.gait.frequency
        terms = (
            term.amplitude * np.sin(np.pi * (2 * j - 1) * f * t - term.phase)
            for j, term in enumerate(self.gait.lateral_harmonics(), start=1)
        )
        return np.asarray(self.gait.mass * self.gravity * np.sum([*terms, np.zeros_like(t)], axis=0))

    def _place(self, t: Array, length: float) -> Array:
        """Where this foot stands along a way of a length in m, or stood last, m."""
        number = np.floor(t * self.gait.frequency * (1.0 + 1e-15))
        return stands_at(self.gait, np.maximum(number - (number - self.foot) % 2, self.foot), length)

    def _share(self, t: Array) -> Array:
        """Part of the force that this foot bears."""
        number = np.floor(t * self.gait.frequency * (1.0 + 1e-15))
        into = t * self.gait.frequency - number  # part of the present step that is over
        grown = np.ones_like(t)
        if self.gait.overlap > 0.0:
            grown = 0.5 - 0.5 * np.cos(np.pi * np.clip(into / self.gait.overlap, 0.0, 1.0))
        grown = np.where(number == 0, 1.0, grown)  # the first foot stands from the beginning
        return np.where(number % 2 == self.foot, grown, 1.0 - grown)
