"""The motion of a structure in its modes under forces and bodies that travel over it.

Where contacts are, and how a point of the structure there is made of its places, is known beforehand. Given forces
drive the modes; bodies move by M u'' + C u' + K u = f - N, with the forces N of their contacts on the structure, whose
places are coordinates:

    u = p + E y + N / S,   y = sum of the modes + what follows without them,

where p is the point at rest and S the stiffness of the kink below, which no mode has. Steps are Radau's of three stages
for the bodies, and exact for the modes, whose forces are polynomials through those stages. They are halved until
nothing changes any more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.solve.modal import RATE_AT_END, Complex, ModalBasis, ModalStep
from ropewalk.solve.radau_iia import A as RADAU
from ropewalk.solve.radau_iia import C as STAGES

# What half the steps may change of the largest displacement, and how many times more of the largest contact force, in
# which the shortest waves of the mesh ring on.
TOLERANCE, _RINGING = 1e-5, 100.0
_HALVINGS = 9
_ROUNDING = 1e-12  # of the coordinates of contacts: displacements as small are rounding
_SEEN = 4.0  # rad in a step, by which a wheel on a kink may swing so that half the step shows another force


class ContactsAtInstant(NamedTuple):
    """Contacts at an instant; those that are off their lines are left out."""

    contact: Integers  # (here,) which these are
    near: Integers  # (here,) first place of the first axis that shares each point
    weight: Array  # (here, place) how the next places share it
    soft: Array  # (here,) m/N, of the kink below
    point: Array  # (here, axis) m, at rest
    way: Array  # (here, axis) m/s, velocity of that point
    force: Array  # (here, axis) N, given


class ContactHistory(Protocol):
    """What contacts do, which the structure does not change."""

    def at(self, t: float, on: NDArray[np.bool_]) -> ContactsAtInstant:
        """Those that are on their lines, as said, at an instant in s."""

    def beside(self, t: float, on: NDArray[np.bool_]) -> Array:
        """Velocities (contact, axis) with which the ground moves those that are not, m/s."""


@dataclass(frozen=True)
class ModalBodies:
    """What stands on contacts; (coordinate,) or (coordinate, coordinate)."""

    mass: Array  # kg
    damping: Array  # N s/m
    stiffness: Array  # N/m
    force: Array  # N
    first: Integers  # (contact,) first coordinate of each; -1: its force is given
    load: Integers  # (coordinate,) whose it is
    pushes: Callable[[float], Array] | None = None  # s to more forces, (coordinate,) N

    def pushed(self, t: float) -> Array:
        """Forces at time t in s, (coordinate,) N."""
        return self.force if self.pushes is None else self.force + self.pushes(t)


class Gusts(NamedTuple):
    """A force on all places that keeps its pattern."""

    force: Array  # (place,) N
    part: Callable[[float], float]  # s to how much of it there is then, and just before

    @staticmethod
    def none(places: int) -> Gusts:
        """Nothing blows."""
        return Gusts(np.zeros(places), lambda t: 0.0)


@dataclass(frozen=True)
class Stretch:
    """A time between two events, during which the same contacts are on their lines."""

    begin: float  # s
    end: float
    on: NDArray[np.bool_]  # (contact,)
    gone: frozenset[int]  # loads that have left for good
    displayed: bool  # whether its end is an instant of output


@dataclass
class Moment:
    """The state at an instant."""

    u: Array  # (coordinate,) m
    w: Array  # (coordinate,) m/s
    force: Array  # (contact, axis) N, on the structure; NaN off its line
    place: Array  # (place,) displacement, m
    velocity: Array  # (place,) m/s
    acceleration: Array  # (place,) m/s^2
    gusts: float  # part of their force


class _Pressed(NamedTuple):
    """What has pressed on the structure in a step."""

    h: float  # s
    touches: list[ContactsAtInstant]  # (stage,)
    force: Array  # (stage, contact and axis) N
    gusts: Array  # (stage,) parts of their force


class _Seen(NamedTuple):
    """An instant of output."""

    z: Complex
    u: Array
    w: Array
    force: Array  # (contact, axis) N
    touch: ContactsAtInstant
    pressing: Array  # (contact on its line and axis,) N
    gusts: float  # part of their force
    pressed: _Pressed | None  # in the step before it


class _Small(NamedTuple):
    """Equations of bodies in a step, but for what the structure adds."""

    own: Integers  # (force,) which of contacts and axes
    coordinate: Integers  # (force,) on which it acts
    left: Array  # (unknown, unknown)
    scale: Array  # (row of bodies,)
    still: Integers  # rows of what stands still


class Superposition:
    """Motion from where the modes begin.

    Args:
        modes: of the structure.
        course: of all contacts.
        bodies: on them.
        axes: how many.
        gusts: that push at all of the structure; None: there are none.
    """

    def __init__(
        self, modes: ModalBasis, course: ContactHistory, bodies: ModalBodies, axes: int, gusts: Gusts | None = None
    ) -> None:
        self.modes, self.course, self.bodies, self._axes = modes, course, bodies, axes
        self._nodes = modes.shape.shape[0] // axes
        self._steps: dict[float, ModalStep] = {}
        self._small: dict[tuple[float, bytes, frozenset[int]], _Small] = {}
        self._loads = [int(bodies.load[first]) if first >= 0 else -1 for first in bodies.first]  # of each contact
        self.gusts = Gusts.none(modes.shape.shape[0]) if gusts is None else gusts
        self._blown: Complex = self.gusts.force @ modes.driven  # (mode,)
        self._leans = modes.remainder(self.gusts.force[:, None])[0][:, 0]  # (place,) m, without modes

    def longest(self, touch: ContactsAtInstant) -> float:
        """Return a step that shows how bodies oscillate on their springs, and wheels on the kinks below, s.

        Much longer ones would damp this, and half of them, too: that they agree would say nothing.
        """
        b, (shape, driven) = self.bodies, self._rows(touch)
        mass = np.diag(b.mass)
        light = np.divide(1.0, mass, out=np.zeros(mass.size), where=mass > 0.0)
        square = float((np.diag(b.stiffness) * light).max(initial=0.0))
        yields = (shape * driven * self.modes.rate).real.sum(axis=1)[
            self._axes - 1 :: self._axes
        ]  # 1/kg, below contacts
        for k, soft, below in zip(touch.contact, touch.soft, yields, strict=True):
            if b.first[k] >= 0 and (own := light[b.first[k] + self._axes - 1]) > 0.0:
                square = max(square, (own + below) / soft / _SEEN**2)
        return float(1.0 / np.sqrt(square)) if square > 0.0 else np.inf

    @np.errstate(over="ignore", invalid="ignore")  # of steps that are too long, which are halved
    def moments(
        self, stretches: Sequence[Stretch], longest: float, start: tuple[Array, Array]
    ) -> tuple[list[Moment], float, float]:
        """States at all instants of output, the first one included.

        Args:
            stretches: of the whole time, one after the other.
            longest: s, of a step to begin with.
            start: places and velocities of bodies, m and m/s.

        Returns:
            The states, the longest step in s, and what steps twice as long changed of the largest displacement.
        """
        (found, forces), missed = self._pass(stretches, longest, start), np.inf
        places = self._places(found)
        ends = [self.course.at(one.begin, one.on).point for one in (stretches[0], stretches[-1])]
        least = _ROUNDING * max(float(np.abs(point).max(initial=0.0)) for point in ends)
        for _ in range(_HALVINGS):
            longest *= 0.5
            forces_before, place_before = forces, places
            found, forces = self._pass(stretches, longest, start)
            places = self._places(found)
            missed = _differ(places, place_before)
            if self.bodies.mass.size:
                missed = max(missed, _differ(forces, forces_before) / _RINGING)
            if float(np.abs(places).max(initial=0.0)) <= least:  # nothing moves, as bodies without weight
                missed = 0.0
            if missed <= TOLERANCE:
                break
        moments = [self._moment(one, place) for one, place in zip(found, places, strict=True)]
        return moments, longest, missed

    def _pass(
        self, stretches: Sequence[Stretch], longest: float, start: tuple[Array, Array]
    ) -> tuple[list[_Seen], Array]:
        """The same with steps of a given length at most, s; and contact forces at the ends of all stretches, N."""
        z, (u, w) = self.modes.begin.copy(), (part.copy() for part in start)
        first = stretches[0]
        self._balance(first, z, u, w)
        found, before = [self._look(first.begin, first.on, z, u, w, None)], first.on
        forces = list[Array]()
        for stretch in stretches:
            self._arrive(stretch, before, z, u, w)
            before, span = stretch.on, stretch.end - stretch.begin
            count = max(1, int(np.ceil(span / longest - 1e-9)))
            step = self._step_of(span / count)
            for i in range(count):
                z, u, w, press = self._go(step, stretch, stretch.begin + i * step.h, z, u, w)
            if stretch.displayed or self.bodies.mass.size:
                seen = self._look(stretch.end, stretch.on, z, u, w, press)
                forces.append(np.nan_to_num(seen.force))
                found += [seen] if stretch.displayed else []
        return found, np.array(forces)

    def _step_of(self, h: float) -> ModalStep:
        key = float(f"{h:.12e}")
        if key not in self._steps:
            self._steps[key] = ModalStep(self.modes.rate, h)
        return self._steps[key]

    def shares(self, touch: ContactsAtInstant) -> Array:
        """How places share unit forces of all contacts, (place, contact and axis)."""
        E = np.zeros((self._axes * self._nodes, touch.contact.size * self._axes))
        for i, (near, weight) in enumerate(zip(touch.near, touch.weight, strict=True)):
            for a in range(self._axes):
                used = weight != 0.0
                E[a * self._nodes + near + np.flatnonzero(used), i * self._axes + a] = weight[used]
        return E

    def neglected(self, touch: ContactsAtInstant) -> tuple[Array, Array]:
        """Return how far unit forces upwards move their contacts at rest without modes, and in all, (contact,) m/N."""
        at = self.shares(touch)[:, self._axes - 1 :: self._axes]
        left = np.diagonal(self.modes.remainder(at)[1])
        return left, left + ((self.modes.still.T @ at) ** 2).sum(axis=0)

    def _rows(self, touch: ContactsAtInstant) -> tuple[Complex, Complex]:
        """Displacements of modes at all contacts (contact and axis, mode), and how forces there drive them."""
        here = touch.near[:, None] + np.arange(touch.weight.shape[1])
        here = np.minimum(here, self._nodes - 1)  # beyond the last one weights are zero
        at = here[:, None, :] + self._nodes * np.arange(self._axes)[None, :, None]
        shape = np.einsum("cj,cajk->cak", touch.weight, self.modes.shape[at])
        driven = np.einsum("cj,cajk->cak", touch.weight, self.modes.driven[at])
        size = touch.contact.size * self._axes, self.modes.rate.size
        return shape.reshape(size), driven.reshape(size)

    def _restrained(self, stretch: Stretch) -> NDArray[np.bool_]:
        """Which coordinates stand still: of contacts off their lines, and of loads that are gone."""
        restrained = np.isin(self.bodies.load, list(stretch.gone))
        for first, on in zip(self.bodies.first, stretch.on, strict=True):
            if first >= 0 and not on:
                restrained[first : first + self._axes] = True
        return restrained

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
            self._balance(stretch, z, u, w)
        restrained = self._restrained(stretch)
        w[restrained] = self._grounded(stretch, stretch.begin)[restrained]

    def _grounded(self, stretch: Stretch, t: float) -> Array:
        """Velocities that the ground gives bodies at time t in s, (coordinate,) m/s."""
        out, rates = np.zeros(self.bodies.mass.shape[0]), self.course.beside(t, stretch.on)
        for first, rate, on, load in zip(self.bodies.first, rates, stretch.on, self._loads, strict=True):
            if first >= 0 and not on and load not in stretch.gone:
                out[first : first + self._axes] = rate
        return out

    def _balance(self, stretch: Stretch, z: Complex, u: Array, w: Array) -> None:
        """Put coordinates without mass where springs and dampers above and the structure below are in balance."""
        b, touch = self.bodies, self.course.at(stretch.begin, stretch.on)
        light = np.flatnonzero((np.diag(b.mass) == 0.0) & ~self._restrained(stretch))
        if not light.size:
            return
        firm, pull = np.zeros(u.size), b.pushed(stretch.begin) - b.damping @ w
        under = touch.point.ravel() + (self._rows(touch)[0] @ z).real
        for i, k in enumerate(touch.contact):
            if b.first[k] >= 0:
                own = b.first[k] + np.arange(self._axes)
                firm[own] = 1.0 / touch.soft[i]
                pull[own] += touch.force[i]
                pull[own] += firm[own] * under[self._axes * i : self._axes * (i + 1)]
        others = np.setdiff1d(np.arange(u.size), light)
        K = b.stiffness + np.diag(firm)
        u[light] = np.linalg.solve(K[np.ix_(light, light)], pull[light] - K[np.ix_(light, others)] @ u[others])

    def _go(
        self, step: ModalStep, stretch: Stretch, t: float, z: Complex, u: Array, w: Array
    ) -> tuple[Complex, Array, Array, _Pressed]:
        """One step; the state after it, and what has pressed on the structure."""
        touches = [self.course.at(t + c * step.h, stretch.on) for c in STAGES]
        rows = [self._rows(touch) for touch in touches]
        gusts = np.array([self.gusts.part(t + c * step.h) for c in STAGES])
        if self.bodies.mass.size:
            N, u, w = self._contact_forces(step, stretch, t, touches, rows, gusts, z, u, w)
        else:
            N = np.array([touch.force.ravel() for touch in touches])
        z = step.decay[2] * z
        for i, (_, driven) in enumerate(rows):
            z = z + step.weight[2, i] * (N[i] @ driven + gusts[i] * self._blown)
        return z, u, w, _Pressed(step.h, touches, N, gusts)

    def _contact_forces(
        self, step: ModalStep, stretch: Stretch, t: float, touches: list[ContactsAtInstant], rows: list[tuple[Complex,
        Complex]], gusts: Array, z: Complex, u: Array, w: Array,
    ) -> tuple[Array, Array, Array]:  # fmt: skip
        """Forces of all contacts at the stages (stage, contact and axis), and the bodies at the end of a step.

        Unknowns are velocities of bodies at the stages, then forces that are found.
        """
        b, h, n = self.bodies, step.h, u.size
        small = self._equations_of(step, stretch)
        own, coordinate, size = small.own, small.coordinate, rows[0][0].shape[0]
        N = np.array([touch.force.ravel() for touch in touches])
        given = np.zeros((3, n))  # on bodies
        given[:, coordinate], N[:, own] = N[:, own], 0.0
        G, known = np.zeros((3, size, 3, size)), np.zeros((3, size))
        for j, (shape, _) in enumerate(rows):
            free = step.decay[j] * z + (gusts @ step.weight[j]) * self._blown
            known[j] = touches[j].point.ravel() + (shape @ free).real
            for i, (_, driven) in enumerate(rows):
                G[j, :, i] = ((shape * step.weight[j, i]) @ driven.T).real
            if self.modes.left_out:
                shares = self.shares(touches[j])
                G[j, :, j] += self.modes.remainder(shares)[1]
                known[j] += gusts[j] * (self._leans @ shares)
        known += np.tensordot(G, N, axes=2)
        J, right = small.left.copy(), np.zeros(small.left.shape[0])
        low, m = 3 * n, own.size
        pushed = np.array([b.pushed(t + c * h) for c in STAGES])
        right[:low] = small.scale * (b.mass @ w + h * RADAU @ (given + pushed - b.stiffness @ u)).ravel()
        grounded = [self._grounded(stretch, t + c * step.h) for c in STAGES] if small.still.size else []
        right[small.still] = np.concatenate([np.zeros(0), *grounded])[small.still] if grounded else 0.0
        right[low:] = (u[coordinate] - known[:, own]).ravel()
        J[low:, low:] = G[:, own][:, :, :, own].reshape(3 * m, 3 * m)
        soft = np.concatenate([np.repeat(touch.soft, self._axes)[own] for touch in touches])
        J[low + np.arange(3 * m), low + np.arange(3 * m)] += soft
        x = np.linalg.solve(J, right)
        rates = x[:low].reshape(3, n)
        N[:, own] = x[low:].reshape(3, m)
        return N, u + h * (RADAU[2] @ rates), rates[2].copy()

    def _equations_of(self, step: ModalStep, stretch: Stretch) -> _Small:
        """Equations of bodies for steps of one length with the same contacts on their lines."""
        key = (step.h, stretch.on.tobytes(), stretch.gone)
        if key in self._small:
            return self._small[key]
        b, A, h, n = self.bodies, self._axes, step.h, self.bodies.mass.shape[0]
        contact = np.flatnonzero(stretch.on)
        first = np.repeat(b.first[contact], A)
        own = np.flatnonzero(first >= 0)
        coordinate, m = first[own] + np.tile(np.arange(A), contact.size)[own], own.size
        pushed = np.zeros((n, m))
        pushed[coordinate, np.arange(m)] = 1.0
        low = 3 * n
        left = np.zeros((low + 3 * m, low + 3 * m))
        left[:low, :low] = np.kron(np.eye(3), b.mass) + np.kron(h * RADAU, b.damping)
        left[:low, :low] += np.kron(h * h * RADAU @ RADAU, b.stiffness)
        left[:low, low:] = np.kron(h * RADAU, pushed)
        left[low:, :low] = -np.kron(h * RADAU, pushed.T)  # what touches is where the structure and its kink are
        size = sum(part * np.abs(np.diag(of)) for part, of in ((1.0, b.mass), (h, b.damping), (h * h, b.stiffness)))
        scale = np.tile(1.0 / np.maximum(size, 1e-12), 3)
        left[:low] *= scale[:, None]
        still = np.flatnonzero(np.tile(self._restrained(stretch), 3))
        left[still] = 0.0
        left[still, still] = 1.0
        self._small[key] = _Small(own, coordinate, left, scale, still)
        return self._small[key]

    def _look(
        self, t: float, on: NDArray[np.bool_], z: Complex, u: Array, w: Array, pressed: _Pressed | None
    ) -> _Seen:  # fmt: skip
        """An instant, to which a step has led; None: nothing has moved yet."""
        touch = self.course.at(t, on)
        N = touch.force.ravel() if pressed is None else pressed.force[2]
        under = touch.point.ravel() + (self._rows(touch)[0] @ z).real
        for i, k in enumerate(touch.contact if pressed is None else ()):
            if self.bodies.first[k] >= 0:  # nothing has moved
                own, row = u[self.bodies.first[k] + np.arange(self._axes)], slice(self._axes * i, self._axes * (i + 1))
                N[row] = (own - under[row]) / touch.soft[i]
        force = np.full((on.size, self._axes), np.nan)
        force[touch.contact] = N.reshape(-1, self._axes)
        gusts = self.gusts.part(t) if pressed is None else float(pressed.gusts[2])
        return _Seen(z, u.copy(), w.copy(), force, touch, N, gusts, pressed)

    def _places(self, seen: Sequence[_Seen]) -> Array:
        """Displacements at instants, (instant, place) m."""
        found = (np.array([one.z for one in seen]) @ self.modes.shape.T).real
        if self.modes.left_out:
            for row, one in zip(found, seen, strict=True):
                row += self.modes.remainder(self.shares(one.touch))[0] @ one.pressing + one.gusts * self._leans
        return np.asarray(found)

    def _moment(self, seen: _Seen, place: Array) -> Moment:
        """Everything at an instant."""
        rate, pressed = self.modes.rate, seen.pressed
        driven = seen.pressing @ self._rows(seen.touch)[1] + seen.gusts * self._blown
        speeds = np.array([rate * seen.z, rate * (rate * seen.z + driven)])
        velocity, acceleration = (speeds @ self.modes.shape.T).real
        if self.modes.left_out and pressed is not None:
            follows = [
                self.modes.remainder(self.shares(at))[0] @ own + part * self._leans
                for at, own, part in zip(pressed.touches, pressed.force, pressed.gusts, strict=True)
            ]
            velocity = velocity + np.tensordot(RATE_AT_END / pressed.h, follows, axes=1)
        return Moment(seen.u, seen.w, seen.force, place, velocity, acceleration, seen.gusts)


def passed_an_end(load: str, t: float) -> RopewalkError:
    """Say that a load has passed an end of its line at t in s, which it must not."""
    return RopewalkError(
        f"loads.{load}.travel.at_end: the load has passed an end of its line at t = {t:.4g} s; write leave, or end the "
        "run before"
    )


def restrained_by_pulling(wheel: str, t: float, remedy: str) -> str:
    """Say that a wheel would have left its line at t in s."""
    return (
        f"load {wheel}: contact is lost at t = {t:.4g} s, from where on this solution holds the wheel to the line by "
        f"pulling; {remedy}"
    )


def _differ(values: Array, before: Array) -> float:
    """Largest difference over the largest value."""
    most = float(np.abs(values).max(initial=0.0))
    if not (np.isfinite(most) and np.isfinite(before).all()):
        return np.inf
    return float(np.abs(values - before).max(initial=0.0)) / most if most != 0.0 else 0.0
