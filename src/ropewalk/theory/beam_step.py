"""What a beam does under the wheels within a step in time: linear in the contact forces and in the state before.

Collocation at the four Gauss points. Under wheels without mass every mode is solved exactly for the cubic polynomials
that the contact forces are then; under wheels with mass, where that would be unstable, the modes are collocated, too.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ropewalk.theory.beam_modes import Beam, Modes
from ropewalk.theory.beam_response import GAUSS, ExactStep, GaussStep

__all__ = ["BeamUnderWheels", "Track"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Track:
    """A beam with the modes that are kept, and wheels at ``start + speed t - axles`` along it."""

    beam: Beam
    series: Modes
    speed: float
    axles: FloatArray
    start: float = 0.0

    def place(self, t: FloatArray) -> FloatArray:
        """Places of the wheels, (*t.shape, wheel) m."""
        return np.asarray(self.start + self.speed * t[..., np.newaxis] - self.axles)

    def shapes(self, place: FloatArray, on: NDArray[np.bool_], derivative: int) -> FloatArray:
        """Eigenfunctions under the wheels, (*place.shape, mode); 0 under those that are not ``on`` the beam."""
        shape = self.series.shape(np.clip(place, 0.0, self.beam.length), derivative)
        return np.asarray(shape * np.broadcast_to(on, place.shape)[..., np.newaxis])

    @property
    def enters(self) -> FloatArray:
        """Times at which the wheels enter, s; the speed must be positive."""
        return (self.axles - self.start) / self.speed

    @property
    def leaves(self) -> FloatArray:
        """Times at which they leave, s."""
        return self.enters + self.beam.length / self.speed


class BeamUnderWheels:
    """The line under the wheels in steps of one size h."""

    def __init__(self, track: Track, h: float, *, exact: bool) -> None:
        self.track, self.h = track, h
        kind = ExactStep if exact else GaussStep
        self.modes = kind(track.series.frequency, track.beam.decay, h)
        self.end = self.modes.response(np.array([h]))

    def prepare(self, begins: FloatArray, on: NDArray[np.bool_]) -> tuple[list[FloatArray], list[FloatArray]]:
        """Return the maps to coordinate, velocity and acceleration of the line under the wheels, at once.

        From the forces, (step, stage, wheel, stage of the force, wheel of the force), and from the state q, v of the
        modes at the beginning, (step, stage, wheel, 2, mode).
        """
        speed = self.track.speed
        place = self.track.place(begins[:, np.newaxis] + self.h * GAUSS.c)
        shape, slope, bend = (speed**d * self.track.shapes(place, on, d) for d in range(3))
        by_force = [a.transpose(1, 2, 0)[:, :, np.newaxis] * shape[:, np.newaxis] for a in self.modes.by_force]
        by_state = [
            np.stack([a.T, b.T], axis=1)[:, np.newaxis]
            for a, b in zip(self.modes.from_q, self.modes.from_v, strict=True)
        ]
        # Coordinate, velocity and acceleration of the wheels from acceleration, velocity and coordinate of the modes.
        parts: list[dict[int, FloatArray]] = [{2: shape}, {1: shape, 2: slope}, {0: shape, 1: 2.0 * slope, 2: bend}]
        wheel_force, wheel_state = [], []
        for part in parts:
            force_terms = [np.einsum("piwn,pijxn->piwjx", a, by_force[k], optimize=True) for k, a in part.items()]
            wheel_force.append(np.sum(force_terms, axis=0))
            wheel_state.append(np.sum([a[..., np.newaxis, :] * by_state[k] for k, a in part.items()], axis=0))
        self.shape = shape
        return wheel_force, wheel_state
