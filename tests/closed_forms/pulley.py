"""Ropes at rest under frictionless loads: hold forces along x that make the tensions equal behind and ahead.

A load that runs on the rope without friction stands still off the lowest point only if it is held. The force of
the load with its hold force, on the rope, is then perpendicular to the mean ``t_behind + t_ahead`` of the tangents:
for a vertical load W the hold force is W times the slope of that mean. Along a path of such states hold force and
load feed the rope, ``hold dx = W dz + d(energy of the rope)``, so that W times the slope of the *path* is the hold
force of the weightless inextensible rope only, whose energy is constant. Derived here.

Unknown are the force at the start and, for every load, its material coordinate and its hold force; equations are
the two of the end, equal tensions, and the given place. Newton's method follows them from a rope that is solved.
"""

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
from numpy import inf

from ropewalk.theory import _segments
from ropewalk.theory import rope as clamped
from ropewalk.theory._segments import AxialLaw, FloatArray, PointLoad
from ropewalk.theory.rope import RestingRope

__all__ = ["Restrained", "resting"]

Restrained = Literal["horizontal", "material"]
_System = Callable[[FloatArray, float], tuple[FloatArray, FloatArray]]


def resting(
    *,
    span: float,
    height: float = 0.0,
    length: float,
    weight: float = 0.0,
    axial_stiffness: float = inf,
    law: AxialLaw = "hooke",
    loads: Sequence[PointLoad],
    restrained: Restrained = "horizontal",
    frictionless: Sequence[bool] | None = None,
) -> RestingRope:
    """Return a rope at rest under frictionless loads, hold forces included in `RestingRope.load_forces`.

    Arguments as in `ropewalk.theory.rope.resting`, but ``loads`` of ``(place, (Fx, Fz))`` are in the order in which
    they stand on the rope, and ``place`` is x in m if ``restrained`` is "horizontal" (beyond the supports, too: the
    rope then runs backwards there) or the material coordinate if it is "material". Fx is immaterial: the hold force
    makes up for it. With ``restrained="material"``, ``frictionless`` may tell which loads are; the others are clamped.

    `ValueError` for arguments out of range and where no hold force makes the tensions equal: out of the rope's
    reach, or on an elastic rope too near to a support, where the load slips off for any hold force.
    """
    compliance = _segments.check_rope(span, height, length, weight, axial_stiffness, law)
    if restrained not in ("horizontal", "material"):
        raise ValueError(f"restrained must be 'horizontal' or 'material', not {restrained!r}")
    free = np.ones(len(loads), dtype=bool) if frictionless is None else np.asarray(frictionless, dtype=bool)
    if free.shape != (len(loads),) or not loads or (restrained == "horizontal" and not np.all(free)):
        raise ValueError("loads must be given, all frictionless if held is 'horizontal', or frictionless for each")
    places = np.array([place for place, _ in loads], dtype=np.float64)
    forces = np.array([force for _, force in loads], dtype=np.float64).reshape(-1, 2)
    if not (np.all(np.isfinite(places)) and np.all(np.isfinite(forces))):
        raise ValueError("places and forces of the loads must be finite")
    rope = _Rope(span, height, length, weight, compliance, law)
    if restrained == "horizontal":
        forces[:, 0] = 0.0
        share = np.array([0.0, weight * length / (len(loads) + 1)])
        start = rope.weightless(places, forces[:, 1] - share[1])

        def system(y: FloatArray, done: float) -> tuple[FloatArray, FloatArray]:
            residual, jacobian, x = rope.equations(y, forces - (1.0 - done) * share, done * weight, free)
            k = len(places)
            residual[2 : 2 + k], jacobian[2 : 2 + k] = (x[0] - places) / length, x[1] / length
            return residual, jacobian
    else:
        if not (np.all((places > 0.0) & (places < length)) and np.all(np.diff(places) > 0.0)):
            raise ValueError(f"loads must stand on the rope, between 0 and {length:g}, in ascending order")
        start, left = rope.clamped(places, forces, free)

        def system(y: FloatArray, done: float) -> tuple[FloatArray, FloatArray]:
            residual, jacobian, _ = rope.equations(y, forces, weight, free)
            k = len(places)
            residual[2 : 2 + k], jacobian[2 : 2 + k] = (y[2 : 2 + k] - places) / length, 0.0
            jacobian[2 : 2 + k, 2 : 2 + k] = np.eye(k) / length
            residual[2 + k :] -= (1.0 - done) * left
            return residual, jacobian

    y = _follow(system, start, np.concatenate([[rope.size(forces)] * 2, [length] * len(loads),
                                               [rope.size(forces)] * len(loads)]), length)  # fmt: skip
    return rope.at_rest(y, forces)


class _Rope:
    """Equations of a rope with frictionless and clamped loads, for ``y = n(0), xi, hold forces``."""

    def __init__(
        self, span: float, height: float, length: float, weight: float, compliance: float, law: AxialLaw
    ) -> None:
        self.ends = np.array([span, height])
        self.length, self.weight, self.compliance, self.law = length, weight, compliance, law

    def size(self, forces: FloatArray) -> float:
        """A force to measure others by."""
        taut = float(np.hypot(*self.ends)) / self.length - 1.0
        pull = taut / self.compliance if taut > 0.0 else 0.0
        return float(np.abs(forces).sum()) + self.weight * self.length + pull

    def equations(
        self, y: FloatArray, forces: FloatArray, weight: float, free: np.ndarray
    ) -> tuple[FloatArray, FloatArray, tuple[FloatArray, FloatArray]]:
        """Miss at the end and tension differences by derivative; rows 2..2+k are left for the places; x of loads."""
        k = len(forces)
        _, force, segments = self._unpack(y, forces, weight)
        law, compliance = self.law, self.compliance
        reach = _segments.reach(force, segments, weight, compliance, law)
        turn = _segments.reach_derivative(force, segments, weight, compliance, law)
        at_end = force + np.stack([0.0 * segments, weight * segments], axis=1)
        grow = _segments.end_gradient(at_end, compliance, law)
        step = np.zeros((k + 1, 2, 2 + 2 * k))  # derivative of every piece's reach by y
        step[:, :, :2] = turn
        for i in range(k + 1):
            step[i, :, 2 + k : 2 + k + i] -= turn[i, :, :1]
            if i < k:
                step[i, :, 2 + i] += grow[i]
            if i > 0:
                step[i, :, 1 + i] += weight * turn[i, :, 1] - grow[i]
        size = self.size(forces)
        residual, jacobian = np.zeros(2 + 2 * k), np.zeros((2 + 2 * k, 2 + 2 * k))
        residual[:2] = (reach.sum(axis=0) - self.ends) / self.length
        jacobian[:2] = step.sum(axis=0) / self.length
        for j in range(k):
            row = 2 + k + j
            if not free[j]:
                residual[row], jacobian[row, row] = y[row] / size, 1.0 / size
                continue
            for n, passed, sign in ((at_end[j], j, -1.0), (force[j + 1], j + 1, 1.0)):
                tension = float(np.hypot(*n))
                tangent = n / max(tension, 1e-300)
                residual[row] += sign * tension / size
                jacobian[row, :2] += sign * tangent / size
                jacobian[row, 2 + j] += sign * weight * tangent[1] / size
                jacobian[row, 2 + k : 2 + k + passed] -= sign * tangent[0] / size
        x = np.cumsum(reach[:-1, 0]), np.cumsum(step[:-1, 0], axis=0)
        return residual, jacobian, x

    def at_rest(self, y: FloatArray, forces: FloatArray) -> RestingRope:
        """Put the solution in its clothes."""
        xi, force, segments = self._unpack(y, forces, self.weight)
        steps = _segments.reach(force, segments, self.weight, self.compliance, self.law)
        nodes = np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])
        if self.weight == 0.0:
            nodes[-1] = self.ends
        return RestingRope(self.weight, self.compliance, np.concatenate([[0.0], xi, [self.length]]), nodes, force)

    def clamped(self, places: FloatArray, forces: FloatArray, free: np.ndarray) -> tuple[FloatArray, FloatArray]:
        """A start for loads at material points: no hold forces yet, and the remainder of the tension equations."""
        k = len(places)
        if self.weight == 0.0 and k == 1 and free[0]:
            return self._balanced_on_circles(float(places[0]), -float(forces[0, 1])), np.zeros(1)
        start = clamped.resting(
            span=self.ends[0], height=self.ends[1], length=self.length, weight=self.weight,
            axial_stiffness=1.0 / self.compliance if self.compliance else inf, law=self.law,
            loads=[(xi, (force[0], force[1])) for xi, force in zip(places, forces, strict=True)],
        )  # fmt: skip
        y = np.concatenate([start.force[0], places, np.zeros(k)])
        residual, _, _ = self.equations(y, forces, self.weight, free)
        return y, residual[2 + k :]

    def _unpack(self, y: FloatArray, forces: FloatArray, weight: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Material coordinates of the loads, force at the beginning of every piece, lengths of the pieces."""
        k = len(forces)
        xi = y[2 : 2 + k]
        total = forces + np.stack([y[2 + k :], np.zeros(k)], axis=1)
        force = y[:2] - np.vstack([np.zeros(2), np.cumsum(total, axis=0)])
        force[1:, 1] += weight * xi
        return xi, force, np.diff(np.concatenate([[0.0], xi, [self.length]]))

    def weightless(self, x: FloatArray, forces: FloatArray) -> FloatArray:
        """Start for loads held at x: one tension all along, two roots for the height and length of a polygon."""
        from scipy.optimize import brentq

        dx = np.diff(np.concatenate([[0.0], x, [self.ends[0]]]))
        drops = np.concatenate([[0.0], np.cumsum(forces)])
        least, size = 0.5 * float(np.ptp(drops)), self.size(np.stack([0.0 * forces, forces], axis=1))

        def polygon(tension: float) -> tuple[FloatArray, FloatArray]:
            """Vertical force and rise of every piece, so that the rises add up to the height."""

            def rise(v_0: float) -> FloatArray:
                v = v_0 - drops
                flat = np.sqrt(np.maximum((tension - v) * (tension + v), 0.0))
                return np.where(dx == 0.0, 0.0, np.abs(dx) * v / np.maximum(flat, 1e-300))

            low, high = drops.max() - tension, drops.min() + tension
            v_0, clip = 0.5 * (low + high), 1e-14 * tension
            missing = [self.ends[1] - float(rise(edge).sum()) for edge in (low + clip, high - clip)]
            if missing[0] <= 0.0 or missing[1] >= 0.0:  # a vertical piece takes what is missing
                side = 0 if missing[0] <= 0.0 else 1
                v_0 = (low, high)[side]
                edge = rise((low + clip, high - clip)[side])
                edge[np.argmax(drops) if side == 0 else np.argmin(drops)] += missing[side]
                return v_0 - drops, edge
            v_0 = brentq(lambda v: float(rise(v).sum()) - self.ends[1], low + clip, high - clip, xtol=1e-9 * tension)
            return v_0 - drops, rise(v_0)

        def slack(log_tension: float) -> float:
            tension = least + size * float(np.exp(log_tension))
            stretched = self.length * (1.0 + float(_segments.strain(np.asarray(tension), self.compliance, self.law)))
            return float(np.log(np.hypot(dx, polygon(tension)[1]).sum() / stretched))

        if not (size > 0.0 and slack(-30.0) > 0.0):
            raise ValueError("a slack rope without weight or load has no definite shape: give a force")
        if slack(30.0) >= 0.0:
            raise ValueError(f"places of the loads must be within the reach of a rope of {self.length:g} m")
        tension = least + size * float(np.exp(brentq(slack, -30.0, 30.0, xtol=1e-9)))
        v, dz = polygon(tension)
        h = np.copysign(np.sqrt(np.maximum((tension - v) * (tension + v), 0.0)), dx)
        reach = np.hypot(dx, dz)
        xi = np.cumsum(reach)[:-1] * (self.length / reach.sum())
        return np.concatenate([[h[0], v[0]], xi, -np.diff(h)])

    def _balanced_on_circles(self, xi: float, load: float) -> FloatArray:
        """Start for one load at a material point: both pieces stretched alike, their ends on circles that meet."""
        from scipy.optimize import brentq

        distance, rest = float(np.hypot(*self.ends)), self.length - xi
        chord = self.ends / distance
        down = np.array([chord[1], -chord[0]]) * (1.0 if load >= 0.0 else -1.0)

        def pull(stretch: float) -> tuple[float, FloatArray, FloatArray]:
            """Tension and tangents."""
            a, b = xi * stretch, rest * stretch
            foot = 0.5 * (distance + (a - b) * (a + b) / distance)
            depth = np.sqrt(max((a + b + distance) * (a + b - distance), 0.0)) / (2.0 * distance)
            depth *= np.sqrt(max((distance - (a - b)) * (distance + (a - b)), 0.0))
            place = foot * chord + depth * down
            eps = stretch - 1.0
            tension = eps * (1.0 if self.law == "hooke" else stretch) / self.compliance if self.compliance else 1.0
            return tension, place / a, (self.ends - place) / b

        def carried(stretch: float) -> float:
            tension, behind, ahead = pull(stretch)
            return tension * float(ahead[1] - behind[1]) * (1.0 if load >= 0.0 else -1.0)

        least, most = max(1.0, distance / self.length), distance / max(abs(rest - xi), 1e-3 * self.length)
        if self.compliance == 0.0:
            stretch = 1.0 if most > 1.0 else 0.0
        else:
            trials = np.append(least + (most - least) * np.logspace(-15.0, 0.0, 200), most) if most > least else [least]
            above = [trial for trial in trials if carried(float(trial)) >= abs(load)]
            stretch = brentq(lambda s: carried(s) - abs(load), least, above[0], xtol=1e-15) if above else 0.0
        if load == 0.0 or stretch == 0.0:
            raise ValueError(f"no hold force makes the tensions equal at the material coordinate {xi:g} m")
        tension, behind, ahead = pull(float(stretch))
        if self.compliance == 0.0:
            tension = load / float(ahead[1] - behind[1])
        return np.array([*(tension * behind), xi, tension * float(behind[0] - ahead[0])])


def _follow(system: _System, y: FloatArray, scales: FloatArray, length: float) -> FloatArray:
    """Solve ``system(y, 1) = 0`` from a solution of ``system(y, 0) = 0``, in steps that Newton's method allows."""
    k = (len(y) - 2) // 2
    done, step = 0.0, 1.0
    for _ in range(400):
        trial, last = y, inf
        for _ in range(25):
            residual, jacobian = system(trial, done + step)
            miss = float(np.max(np.abs(residual)))
            floor = miss <= 1e-11 and miss >= 0.5 * last
            if not np.isfinite(miss) or (miss > 10.0 * last and miss > 1e-11) or miss <= 1e-15 or floor:
                break
            last = miss
            try:
                trial = trial - np.linalg.solve(jacobian * scales, residual) * scales
            except np.linalg.LinAlgError:
                miss = inf
                break
            ordered = np.concatenate([[0.0], trial[2 : 2 + k], [length]])
            if not np.all(np.diff(ordered) > 0.0):
                miss = inf
                break
        # a soft rope knows a second, far larger hold force in the same place: stay on the branch
        near = float(np.max(np.abs((trial - y) / scales))) <= 0.3 * (1.0 + float(np.max(np.abs(y / scales))))
        if miss <= 1e-11 and near:
            y, done = trial, done + step
            if done >= 1.0:
                return y
            step = min(2.0 * step, 1.0 - done)
        else:
            step *= 0.5
            if step < 1e-9:
                break
    raise ValueError("no hold force makes the tensions equal: a load slips off at a support, or data are too extreme")
