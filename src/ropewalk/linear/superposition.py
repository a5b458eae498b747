"""The motion of a structure in its modes under forces and bodies that travel over it.

Where contacts are, and how a point of the structure there is made of its places, is known beforehand. Given forces drive
the modes; bodies move by M u'' + C u' + K u = f - N, with the forces N of the structure on their contacts, whose places
are the first coordinates of each:

    u = p + E y + N / S,   y = sum of the modes + what follows without them,

where p is the point at rest and S the stiffness of the kink below, which no mode has. Steps are Radau's of three stages
for the bodies, and exact for the modes, whose forces are polynomials through those stages. They are halved until nothing
changes any more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
import scipy.linalg as linalg
from numpy.typing import NDArray

from ropewalk.linear.modal import RATE_AT_END, STAGES, Complex, Modes, Step
from ropewalk.mechanics.chain import Array, Integers

_ROOT = np.sqrt(6.0)
RADAU: Array = np.array(
    [
        [(88.0 - 7.0 * _ROOT) / 360.0, (296.0 - 169.0 * _ROOT) / 1800.0, (-2.0 + 3.0 * _ROOT) / 225.0],
        [(296.0 + 169.0 * _ROOT) / 1800.0, (88.0 + 7.0 * _ROOT) / 360.0, (-2.0 - 3.0 * _ROOT) / 225.0],
        [(16.0 - _ROOT) / 36.0, (16.0 + _ROOT) / 36.0, 1.0 / 9.0],
    ]
)
TOLERANCE = 1e-6  # of the largest displacement: what half the steps may change
_HALVINGS = 9


class Touch(NamedTuple):
    """Contacts at an instant; those that are off their lines are left out."""

    contact: Integers  # (here,) which these are
    near: Integers  # (here,) first place of the first axis that shares each point
    weight: Array  # (here, place) how the next places share it
    soft: Array  # (here,) m/N, of the kink below
    point: Array  # (here, axis) m, at rest
    way: Array  # (here, axis) m/s, velocity of that point
    force: Array  # (here, axis) N, given


class Course(Protocol):
    """What contacts do, which the structure does not change."""

    def at(self, t: float, on: NDArray[np.bool_]) -> Touch:
        """Those that are on their lines, as said, at an instant in s."""


@dataclass(frozen=True)
class Bodies:
    """What stands on contacts; (coordinate,) or (coordinate, coordinate)."""

    mass: Array  # kg
    damping: Array  # N s/m
    stiffness: Array  # N/m
    force: Array  # N
    first: Integers  # (contact,) first coordinate of each; -1: its force is given
    load: Integers  # (coordinate,) whose it is


@dataclass(frozen=True)
class Stretch:
    """A time between two events, during which the same contacts are on their lines."""

    begin: float  # s
    end: float
    on: NDArray[np.bool_]  # (contact,)
    gone: frozenset[int]  # loads that have left for good
    shown: bool  # whether its end is an instant of output


@dataclass
class Moment:
    """The state at an instant."""

    z: Complex  # (mode,)
    u: Array  # (coordinate,) m
    w: Array  # (coordinate,) m/s
    force: Array  # (contact, axis) N, on the structure; NaN off its line
    place: Array  # (place,) displacement, m
    velocity: Array  # (place,) m/s
    acceleration: Array  # (place,) m/s^2


class _Pressed(NamedTuple):
    """What has pressed on the structure in a step."""

    h: float  # s
    touches: list[Touch]  # (stage,)
    force: Array  # (stage, contact and axis) N


class Superposition:
    """Motion from rest.

    Args:
        modes: of the structure.
        course: of all contacts.
        bodies: on them.
        axes: how many.
    """

    def __init__(self, modes: Modes, course: Course, bodies: Bodies, axes: int) -> None:
        self.modes, self.course, self.bodies, self._axes = modes, course, bodies, axes
        self._nodes = modes.shape.shape[0] // axes
        self._steps: dict[float, Step] = {}

    def moments(self, stretches: Sequence[Stretch], longest: float, start: tuple[Array, Array]) -> tuple[list[Moment], float, float]:
        """States at all instants of output, the first one included.

        Args:
            stretches: of the whole time, one after the other.
            longest: s, of a step to begin with.
            start: places and velocities of bodies, m and m/s.

        Returns:
            The states, the longest step in s, and what steps twice as long changed of the largest displacement.
        """
        found, missed = self._pass(stretches, longest, start), np.inf
        for _ in range(_HALVINGS):
            longest *= 0.5
            finer = self._pass(stretches, longest, start)
            places = np.array([moment.place for moment in finer])
            before = np.array([moment.place for moment in found])
            scale = float(np.abs(places).max(initial=0.0))
            missed = float(np.abs(places - before).max(initial=0.0)) / scale if scale > 0.0 else 0.0
            forces = np.array([moment.force for moment in finer]), np.array([moment.force for moment in found])
            most = float(np.nanmax(np.abs(forces[0]), initial=0.0))
            if most > 0.0 and self.bodies.mass.size:
                missed = max(missed, 1e-2 * float(np.nanmax(np.abs(forces[0] - forces[1]), initial=0.0)) / most)
            found = finer
            if missed <= TOLERANCE:
                break
        return found, longest, missed

    def _pass(self, stretches: Sequence[Stretch], longest: float, start: tuple[Array, Array]) -> list[Moment]:
        """The same with steps of a given length at most, s."""
        z, (u, w) = np.zeros(self.modes.rate.size, dtype=np.complex128), (part.copy() for part in start)
        first = stretches[0]
        found, before = [self._look(first.begin, first.on, z, u, w, None)], first.on
        for stretch in stretches:
            self._arrive(stretch, before, z, u, w)
            before, span = stretch.on, stretch.end - stretch.begin
            count = max(1, int(np.ceil(span / longest - 1e-9)))
            step = self._step_of(span / count)
            for i in range(count):
                z, u, w, press = self._go(step, stretch, stretch.begin + i * step.h, z, u, w)
            if stretch.shown:
                found.append(self._look(stretch.end, stretch.on, z, u, w, press))
        return found

    def _step_of(self, h: float) -> Step:
        key = float(f"{h:.12e}")
        if key not in self._steps:
            self._steps[key] = Step(self.modes.rate, h)
        return self._steps[key]

    def _shares(self, touch: Touch) -> Array:
        """How places share unit forces of all contacts, (place, contact and axis)."""
        E = np.zeros((self._axes * self._nodes, touch.contact.size * self._axes))
        for i, (near, weight) in enumerate(zip(touch.near, touch.weight, strict=True)):
            for a in range(self._axes):
                used = weight != 0.0
                E[a * self._nodes + near + np.flatnonzero(used), i * self._axes + a] = weight[used]
        return E

    def _rows(self, touch: Touch) -> tuple[Complex, Complex]:
        """Displacements of modes at all contacts (contact and axis, mode), and how forces there drive them."""
        here = touch.near[:, None] + np.arange(touch.weight.shape[1])
        here = np.minimum(here, self._nodes - 1)  # beyond the last one weights are zero
        at = here[:, None, :] + self._nodes * np.arange(self._axes)[None, :, None]
        shape = np.einsum("cj,cajk->cak", touch.weight, self.modes.shape[at])
        driven = np.einsum("cj,kcaj->cak", touch.weight, self.modes.driven[:, at])
        size = touch.contact.size * self._axes, self.modes.rate.size
        return shape.reshape(size), driven.reshape(size)

    def _held(self, stretch: Stretch) -> NDArray[np.bool_]:
        """Which coordinates stand still: of contacts off their lines, and of loads that are gone."""
        held = np.isin(self.bodies.load, list(stretch.gone))
        for first, on in zip(self.bodies.first, stretch.on, strict=True):
            if first >= 0 and not on:
                held[first : first + self._axes] = True
        return held

    def _arrive(self, stretch: Stretch, before: NDArray[np.bool_], z: Complex, u: Array, w: Array) -> None:
        """Put contacts that come to their lines on them, with the velocity of their points; what stands still rests."""
        comes = stretch.on & ~before
        if comes.any():
            touch = self.course.at(stretch.begin, comes)
            shape, _ = self._rows(touch)
            for i, k in enumerate(touch.contact):
                own, rows = self.bodies.first[k] + np.arange(self._axes), shape[self._axes * i : self._axes * (i + 1)]
                if self.bodies.first[k] >= 0:
                    u[own] = touch.point[i] + (rows @ z).real
                    w[own] = touch.way[i] + (rows @ (self.modes.rate * z)).real
        w[self._held(stretch)] = 0.0

    def _go(
        self, step: Step, stretch: Stretch, t: float, z: Complex, u: Array, w: Array
    ) -> tuple[Complex, Array, Array, _Pressed]:
        """One step; the state after it, and what has pressed on the structure."""
        touches = [self.course.at(t + c * step.h, stretch.on) for c in STAGES]
        rows = [self._rows(touch) for touch in touches]
        if self.bodies.mass.size:
            N, u, w = self._press(step, stretch, touches, rows, z, u, w)
        else:
            N = np.array([touch.force.ravel() for touch in touches])
        z = step.decay[2] * z
        for i, (_, driven) in enumerate(rows):
            z = z + step.weight[2, i] * (N[i] @ driven)
        return z, u, w, _Pressed(step.h, touches, N)

    def _press(
        self, step: Step, stretch: Stretch, touches: list[Touch], rows: list[tuple[Complex, Complex]], z: Complex,
        u: Array, w: Array,
    ) -> tuple[Array, Array, Array]:  # fmt: skip
        """Forces of all contacts at the stages (stage, contact and axis), and the bodies at the end of a step."""
        b, A, h = self.bodies, self._axes, step.h
        contact = touches[0].contact
        first, size = np.repeat(b.first[contact], A), contact.size * A
        own = np.flatnonzero(first >= 0)  # forces that are found
        coordinate = first[own] + np.tile(np.arange(A), contact.size)[own]
        given = np.array([np.where(first >= 0, 0.0, touch.force.ravel()) for touch in touches])
        n, m = u.size, own.size
        G = np.zeros((3 * size, 3 * size))
        known = np.zeros((3, size))
        for j, (shape, _) in enumerate(rows):
            known[j] = touches[j].point.ravel() + (shape @ (step.decay[j] * z)).real
            for i, (_, driven) in enumerate(rows):
                G[j * size : (j + 1) * size, i * size : (i + 1) * size] = ((shape * step.weight[j, i]) @ driven.T).real
            if self.modes.left_out:
                G[j * size : (j + 1) * size, j * size : (j + 1) * size] += self.modes.remainder(self._shares(touches[j]))[1]
        known += (G @ given.ravel()).reshape(3, size)
        at = (size * np.arange(3)[:, None] + own).ravel()
        soft = np.concatenate([np.repeat(touch.soft, A)[own] for touch in touches])
        # Unknowns: velocities of bodies at the stages, then forces.
        J, right = np.zeros((3 * n + 3 * m, 3 * n + 3 * m)), np.zeros(3 * n + 3 * m)
        held = self._held(stretch)
        pushed = np.zeros((n, m))
        pushed[coordinate, np.arange(m)] = 1.0
        square = RADAU @ RADAU
        pull = (b.force - b.stiffness @ u) * h
        scale = 1.0 / np.maximum(np.abs(np.diag(b.mass)) + h * np.abs(np.diag(b.damping)) + h * h * np.abs(np.diag(b.stiffness)), 1e-300)
        scale = np.minimum(scale, 1e12)
        for j in range(3):
            r = slice(j * n, (j + 1) * n)
            for i in range(3):
                c = slice(i * n, (i + 1) * n)
                J[r, c] = RADAU[j, i] * h * b.damping + square[j, i] * h * h * b.stiffness
                J[r, 3 * n + i * m : 3 * n + (i + 1) * m] = RADAU[j, i] * h * pushed
            J[r, r] += b.mass
            right[r] = b.mass @ w + RADAU[j].sum() * pull
        # Places of contacts are those of the structure below, and of its kink.
        low = 3 * n
        for j in range(3):
            r = slice(low + j * m, low + (j + 1) * m)
            for i in range(3):
                J[r, i * n : (i + 1) * n] = -RADAU[j, i] * h * pushed.T
            right[r] = u[coordinate] - known[j, own]
        J[low:, low:] = G[np.ix_(at, at)] + np.diag(soft)
        rows_of = np.tile(scale, 3)
        J[:low] *= rows_of[:, None]
        right[:low] *= rows_of
        still = np.flatnonzero(np.tile(held, 3))
        J[still], right[still] = 0.0, 0.0
        J[still, still] = 1.0
        x = _solve(J, right)
        rates, N = x[:low].reshape(3, n), given
        N[:, own] = x[low:].reshape(3, m)
        return N, u + h * (RADAU[2] @ rates), rates[2].copy()

    def _look(
        self, t: float, on: NDArray[np.bool_], z: Complex, u: Array, w: Array, pressed: _Pressed | None
    ) -> Moment:  # fmt: skip
        """Everything at an instant, to which a step has led; None: nothing has moved yet."""
        touch, rate = self.course.at(t, on), self.modes.rate
        _, driven = self._rows(touch)
        given = np.repeat(self.bodies.first[touch.contact], self._axes) < 0
        N = np.where(given, touch.force.ravel(), 0.0) if pressed is None else pressed.force[2]
        force = np.full((on.size, self._axes), np.nan)
        force[touch.contact] = N.reshape(-1, self._axes)
        place, velocity, acceleration = (
            (self.modes.shape @ part).real for part in (z, rate * z, rate * (rate * z + N @ driven))
        )  # fmt: skip
        if self.modes.left_out and N.size:
            follows = [N @ self.modes.remainder(self._shares(touch))[0].T]
            if pressed is not None:
                follows = [
                    self.modes.remainder(self._shares(at))[0] @ own
                    for at, own in zip(pressed.touches, pressed.force, strict=True)
                ]
                velocity = velocity + np.tensordot(RATE_AT_END / pressed.h, follows, axes=1)
            place = place + follows[-1]
        return Moment(z, u.copy(), w.copy(), force, place, velocity, acceleration)


def _solve(J: Array, right: Array) -> Array:
    """The solution of small equations."""
    return np.asarray(linalg.solve(J, right, check_finite=False)) if right.size else right
