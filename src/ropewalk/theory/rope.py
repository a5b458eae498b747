"""Ropes at rest between two supports: catenary, elastic catenary with point loads, weightless elastic rope.

The rope starts at (0, 0) and ends at (span, height), x along the span and z upwards, and is described along
its unstrained arc length xi. The internal force n(xi), which the part ahead exerts on the part behind, obeys
``n' = (0, weight)`` and jumps by minus the load at a point load. The rope is as long as the shape that n
gives it,

    r(length) - r(0) = integral of (1 + eps(|n|)) n/|n| d xi = (span, height),

which are two equations for the two components of n(0). They are the gradient of the complementary energy, a
convex function, so there is one solution and Newton's method with a line search finds it. Irvine, Cable
Structures, for the single elastic catenary; derived in docs/notes for the point loads.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from ropewalk.theory import _arguments

__all__ = ["AxialLaw", "PointLoad", "RestingRope", "catenary", "elastic_catenary", "weightless_elastic"]

FloatArray = NDArray[np.float64]
_TINY = float(np.finfo(np.float64).tiny)
AxialLaw = Literal["hooke", "second_piola_kirchhoff"]
PointLoad = tuple[float, tuple[float, float]]  # material coordinate in m, force (Fx, Fz) in N


@dataclass(frozen=True)
class RestingRope:
    """Equilibrium of a rope, in pieces between its supports and point loads; z upwards, forces in N."""

    weight: float  # N per unstrained metre, 0 for straight pieces
    compliance: float  # strain per tension, 1/N, of heavy pieces
    breaks: FloatArray  # material coordinates of the start, the loads in ascending order and the end, m
    nodes: FloatArray  # their positions, shape (pieces + 1, 2), m
    force: FloatArray  # internal force at the beginning of each piece, shape (pieces, 2)

    @property
    def start_reaction(self) -> FloatArray:
        """Force (x, z) of the start support on the rope."""
        return np.asarray(-self.force[0])

    @property
    def end_reaction(self) -> FloatArray:
        """Force (x, z) of the end support on the rope."""
        return np.asarray(self._force_at_piece_ends()[-1])

    @property
    def horizontal_tension(self) -> float:
        """Horizontal component of the tension at the start; constant unless a load pulls along x."""
        return float(self.force[0, 0])

    @property
    def load_positions(self) -> FloatArray:
        """Positions (x, z) of the loads, ascending in material coordinate, shape (loads, 2), m."""
        return self.nodes[1:-1]

    @property
    def load_tensions(self) -> FloatArray:
        """Tensions behind and ahead of each load, shape (loads, 2)."""
        behind, ahead = self._force_at_piece_ends()[:-1], self.force[1:]
        return np.asarray(np.linalg.norm(np.stack([behind, ahead], axis=1), axis=2))

    @property
    def sag(self) -> float:
        """Largest vertical depth below the straight line through the supports, m; 0 if nowhere below it."""
        (x_0, z_0), (x_1, z_1) = self.nodes[0], self.nodes[-1]
        slope = (z_1 - z_0) / (x_1 - x_0)
        points = self.nodes
        if self.weight > 0.0:
            parallel = self.breaks[:-1] + (slope * self.force[:, 0] - self.force[:, 1]) / self.weight
            points = np.vstack([points, self.position(np.clip(parallel, self.breaks[:-1], self.breaks[1:]))])
        return float(np.max(z_0 + slope * (points[:, 0] - x_0) - points[:, 1]))

    def position(self, xi: ArrayLike) -> FloatArray:
        """Return the positions (x, z) in m at material coordinates ``xi`` (m, 0..length), shape (..., 2).

        A slack piece of a weightless rope has no definite shape; it is drawn straight.
        """
        xi, piece = self._locate(xi)
        if self.weight == 0.0:
            columns = [np.interp(xi, self.breaks, self.nodes[:, axis]) for axis in (0, 1)]
            return np.stack(columns, axis=-1)
        covered = xi - self.breaks[piece]
        return np.asarray(self.nodes[piece] + _reach(self.force[piece], covered, self.weight, self.compliance))

    def tension(self, xi: ArrayLike) -> FloatArray:
        """Return the tension in N at material coordinates ``xi`` (m, 0..length); on a load, that ahead."""
        xi, piece = self._locate(xi)
        vertical = self.force[piece, 1] + self.weight * (xi - self.breaks[piece])
        return np.asarray(np.hypot(self.force[piece, 0], vertical))

    def _force_at_piece_ends(self) -> FloatArray:
        gain = self.weight * np.diff(self.breaks)
        return self.force + np.stack([np.zeros_like(gain), gain], axis=1)

    def _locate(self, xi: ArrayLike) -> tuple[FloatArray, NDArray[np.intp]]:
        xi = np.asarray(xi, dtype=np.float64)
        if not np.all((xi >= 0.0) & (xi <= self.breaks[-1])):
            raise ValueError(f"xi must lie on the rope, between 0 and its length {self.breaks[-1]:g}")
        piece = np.searchsorted(self.breaks, xi, side="right") - 1
        return xi, np.asarray(np.minimum(piece, len(self.force) - 1), dtype=np.intp)


def catenary(*, span: float, height: float = 0.0, length: float, weight: float) -> RestingRope:
    """Return the inextensible heavy rope.

    ``span`` > 0 and ``height`` are the end's position from the start's and ``length`` the rope's, in m,
    ``weight`` > 0 in N/m. `ValueError` for arguments out of range and for a rope not longer than the distance
    of its ends.

    ``z = a cosh(x/a)`` with ``a = H/weight`` from ``sqrt(length^2 - height^2) = 2 a sinh(u)``,
    ``u = span/(2 a)``, and the vertical forces at the ends from their sum ``weight height coth(u)``.
    """
    _arguments.positive(span=span, length=length, weight=weight)
    _arguments.finite(height=height)
    distance = float(np.hypot(span, height))
    if length <= distance:
        raise ValueError(f"a rope of {length:g} m does not hang between ends {distance:g} m apart")
    excess = (length - distance) * (length + distance) / span**2
    u = _solve_log_sinhc(0.5 * float(np.log1p(excess)))
    horizontal = weight * span / (2.0 * u)
    vertical = 0.5 * weight * (height / float(np.tanh(u)) - length)
    breaks, force = np.array([0.0, length]), np.array([[horizontal, vertical]])
    return _heavy_rope(breaks, force, weight, compliance=0.0)


def elastic_catenary(
    *,
    span: float,
    height: float = 0.0,
    length: float,
    weight: float,
    axial_stiffness: float,
    loads: Sequence[PointLoad] = (),
) -> RestingRope:
    """Return the heavy elastic rope (Hooke) with point loads clamped at material points.

    ``span`` > 0 and ``height`` are the end's position from the start's and ``length`` the unstrained length,
    in m (shorter, equal or longer than the distance), ``weight`` > 0 in N per unstrained metre,
    ``axial_stiffness`` in N. ``loads`` is a sequence of ``(xi, (Fx, Fz))``: material coordinate in m (0 and
    length included) and force on the rope in N, z upwards. `ValueError` for arguments out of range.

    Between loads, Irvine: ``x = H s/EA + (H/w) [asinh(v/H)]``, ``z = [v^2]/(2 w EA) + [sqrt(H^2 + v^2)]/w``,
    ``v = v_0 + w s``; written without the differences, so that light and taut ropes lose no digits.
    """
    _arguments.positive(span=span, length=length, weight=weight, axial_stiffness=axial_stiffness)
    _arguments.finite(height=height)
    breaks, drops = _break_at_loads(loads, length)
    pieces, compliance = np.diff(breaks), 1.0 / axial_stiffness
    offset = -drops + np.stack([np.zeros_like(pieces), weight * breaks[:-1]], axis=1)
    ends = np.array([span, height])

    def gap(force: FloatArray) -> tuple[FloatArray, FloatArray]:
        at_start = force + offset
        reach = _reach(at_start, pieces, weight, compliance).sum(axis=0)
        return reach - ends, _reach_derivative(at_start, pieces, weight, compliance)

    guess = _taut_guess(offset, pieces, weight, compliance, ends)
    force = _newton(gap, guess, distance=length + float(np.hypot(span, height)))
    return _heavy_rope(breaks, force + offset, weight, compliance)


def weightless_elastic(
    *,
    span: float,
    height: float = 0.0,
    length: float,
    axial_stiffness: float,
    load: PointLoad,
    law: AxialLaw = "hooke",
) -> RestingRope:
    """Return the weightless elastic rope with one point load clamped at a material point.

    ``span`` > 0 and ``height`` are the end's position from the start's and ``length`` the unstrained length,
    in m, ``axial_stiffness`` in N, ``load`` is ``(xi, (Fx, Fz))`` as in `elastic_catenary`. ``law`` is
    "hooke", ``T = EA eps``, or "second_piola_kirchhoff", ``T = EA lam (lam - 1)``, the printed eqs. 6-7 of
    "Walking the Line. Traveling Forces vs Moving Masses". A piece may be slack: the load then hangs from the
    other support. `ValueError` for arguments out of range, and for no force on a slack rope, which has no
    definite shape.

    Force balance ``n_ahead = n_behind - F`` with ``sum of length_i lam(|n_i|) n_i/|n_i| = (span, height)``.
    """
    _arguments.positive(span=span, length=length, axial_stiffness=axial_stiffness)
    _arguments.finite(height=height)
    if law not in ("hooke", "second_piola_kirchhoff"):
        raise ValueError(f"law must be 'hooke' or 'second_piola_kirchhoff', not {law!r}")
    breaks, drops = _break_at_loads([load], length)
    pieces, ends = np.diff(breaks), np.array([span, height])
    if not np.any(drops) and length >= np.hypot(span, height):
        raise ValueError("a slack rope without weight or load has no definite shape: give a force")
    half_slack = _hanging_rope(breaks, ends, drops[1], axial_stiffness, law)
    if half_slack is not None:
        return half_slack

    def gap(force: FloatArray) -> tuple[FloatArray, FloatArray]:
        reach, derivative = _straight_reach((force - drops) / axial_stiffness, pieces, law)
        return reach.sum(axis=0) - ends, derivative / axial_stiffness

    guess = _taut_guess(-drops, pieces, 0.0, 1.0 / axial_stiffness, ends)
    force = _newton(gap, guess, distance=length + float(np.hypot(span, height))) - drops
    place = _straight_reach(force / axial_stiffness, pieces, law)[0][0]
    return RestingRope(0.0, 0.0, breaks, np.stack([0.0 * ends, place, ends]), force)


def _hanging_rope(
    breaks: FloatArray, ends: FloatArray, pull: FloatArray, axial_stiffness: float, law: AxialLaw
) -> RestingRope | None:
    """Weightless rope whose load hangs from one support alone, if the other piece can be slack."""
    size, pieces = float(np.hypot(*pull)), np.diff(breaks)
    supports = np.stack([0.0 * ends, ends])
    for taut, slack in ((0, 1), (1, 0)):
        if size > 0.0:
            stretched = pieces[taut] * (1.0 + _strain(size / axial_stiffness, law))
            place = supports[taut] + stretched * (pull / size)
            if np.hypot(*(supports[slack] - place)) <= pieces[slack]:
                force = np.stack([pull, 0.0 * pull]) if taut == 0 else np.stack([0.0 * pull, -pull])
                return RestingRope(0.0, 0.0, breaks, np.stack([supports[0], place, supports[1]]), force)
    return None


def _heavy_rope(breaks: FloatArray, force: FloatArray, weight: float, compliance: float) -> RestingRope:
    steps = _reach(force, np.diff(breaks), weight, compliance)
    nodes = np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])
    return RestingRope(weight, compliance, breaks, nodes, force)


def _reach(force: FloatArray, length: FloatArray, weight: float, compliance: float) -> FloatArray:
    """Vector from the beginning to the end of heavy pieces whose internal force begins with ``force``."""
    h, v = force[..., 0], force[..., 1]
    v_mean = v + 0.5 * weight * length
    t_mean = np.maximum(0.5 * (np.hypot(h, v) + np.hypot(h, v + weight * length)), _TINY)
    x = length * h * compliance + h * _length_by_tension(h, v, length, weight)
    z = length * v_mean * (compliance + 1.0 / t_mean)
    return np.stack([x, z], axis=-1)


def _reach_derivative(force: FloatArray, length: FloatArray, weight: float, compliance: float) -> FloatArray:
    """Derivative of the summed `_reach` by the force: integral of ``I/EA + (I - t t)/|n|``, shape (2, 2)."""
    h, v = force[:, 0], force[:, 1]
    v_end = v + weight * length
    t_0, t_1 = np.maximum(np.hypot(h, v), _TINY), np.maximum(np.hypot(h, v_end), _TINY)
    zz = length / (t_0 + t_1) * (1.0 + (h / t_0) * (h / t_1) - (v / t_0) * (v_end / t_1))
    xz = -length / (t_0 + t_1) * ((h / t_0) * (v_end / t_1) + (v / t_0) * (h / t_1))
    xx = np.maximum(_length_by_tension(h, v, length, weight) - zz, 0.0)
    bend = np.array([[xx.sum(), xz.sum()], [xz.sum(), zz.sum()]])
    return np.asarray(bend + compliance * length.sum() * np.eye(2))


def _length_by_tension(h: FloatArray, v: FloatArray, length: FloatArray, weight: float) -> FloatArray:
    """Integral of d xi/|n| along a heavy piece, ``[asinh(v/h)]/weight`` without the difference."""
    rest = _tension_plus(h, v) + _tension_plus(h, -(v + weight * length))  # t_0 + t_1 - weight * length
    rest = np.maximum(rest, _TINY)
    ratio = 2.0 * weight * length / rest
    return np.where(ratio > 0.0, np.log1p(ratio) / np.where(ratio > 0.0, weight, 1.0), 2.0 * length / rest)


def _tension_plus(h: FloatArray, v: FloatArray) -> FloatArray:
    """``sqrt(h^2 + v^2) + v`` without cancellation."""
    tension = np.hypot(h, v)
    return np.where(v < 0.0, h * (h / np.maximum(tension + np.abs(v), _TINY)), tension + v)


def _strain(tension: float | FloatArray, law: AxialLaw) -> FloatArray:
    """Strain under a tension by EA."""
    if law == "hooke":
        return np.asarray(tension)
    return np.asarray(tension / (0.5 + np.sqrt(0.25 + tension)))


def _straight_reach(force: FloatArray, length: FloatArray, law: AxialLaw) -> tuple[FloatArray, FloatArray]:
    """Vectors along weightless pieces under forces by EA, and the derivative of their sum."""
    tension = np.maximum(np.hypot(force[:, 0], force[:, 1]), _TINY)
    tangent = force / tension[:, np.newaxis]
    stretch = 1.0 + _strain(tension, law)
    slope = np.ones_like(tension) if law == "hooke" else 1.0 / (2.0 * stretch - 1.0)
    along = tangent[:, :, np.newaxis] * tangent[:, np.newaxis, :]
    turn = (length * stretch / tension)[:, np.newaxis, np.newaxis] * (np.eye(2) - along)
    pull = (length * slope)[:, np.newaxis, np.newaxis] * along
    return (length * stretch)[:, np.newaxis] * tangent, (turn + pull).sum(axis=0)


def _taut_guess(
    offset: FloatArray, length: FloatArray, weight: float, compliance: float, ends: FloatArray
) -> FloatArray:
    """Force at the start of a taut rope: chord plus elongation is length plus the transverse load's slack."""
    total, distance = length.sum(), float(np.hypot(*ends))
    chord = ends / distance
    first = offset
    last = offset + np.stack([np.zeros_like(length), weight * length], axis=1)
    mean = (length[:, np.newaxis] * (first + last)).sum(axis=0) / (2.0 * total)
    p, q = ((side - mean) @ np.array([-chord[1], chord[0]]) for side in (first, last))
    slack = 0.5 * float((length * (p * p + p * q + q * q)).sum()) / (3.0 * total)
    excess = 1.0 - distance / total
    bound = float(np.cbrt(slack / compliance)) + max(-excess, 0.0) / compliance

    def balance(tension: float) -> float:
        return float((compliance * tension + excess) * tension**2 - slack)

    tension = brentq(balance, 0.0, 1.001 * bound, xtol=1e-6 * bound, rtol=1e-6) if bound > 0.0 else 0.0
    return np.asarray(max(float(tension), 1e-9 * bound) * chord - mean)


def _newton(
    gap: Callable[[FloatArray], tuple[FloatArray, FloatArray]], force: FloatArray, distance: float
) -> FloatArray:
    """Minimise the complementary energy, whose gradient is the gap left at the end support."""
    residual, derivative = gap(force)
    for _ in range(200):
        change = -np.linalg.solve(derivative, residual)
        descent = float(residual @ change)
        fraction = 1.0
        trial, trial_derivative = gap(force + change)
        while float(trial @ change) > -0.5 * descent and fraction > 1e-12:
            fraction *= 0.5
            trial, trial_derivative = gap(force + fraction * change)
        settled = bool(
            np.max(np.abs(change)) <= 1e-13 * np.max(np.abs(force)) or np.max(np.abs(residual)) <= 1e-15 * distance
        )
        if settled:
            return force + fraction * change
        force, residual, derivative = force + fraction * change, trial, trial_derivative
    raise ValueError("no equilibrium found: the data are too extreme for double precision")


def _solve_log_sinhc(value: float) -> float:
    """Solve log(sinh(u)/u) = value > 0."""

    def excess(u: float) -> float:
        if u > 1.0:
            return u + float(np.log1p(-np.exp(-2.0 * u)) - np.log(2.0 * u)) - value
        series = 0.0
        for k in range(9, 0, -1):
            series = u * u / (2 * k * (2 * k + 1)) * (1.0 + series)
        return float(np.log1p(series)) - value

    low = float(np.sqrt(6.0 * value))
    high = 1.1 * low
    while excess(high) < 0.0:
        high *= 2.0
    return float(brentq(excess, 0.999 * low, high, xtol=1e-15 * low, rtol=1e-15))


def _break_at_loads(loads: Sequence[PointLoad], length: float) -> tuple[FloatArray, FloatArray]:
    """Ends of the pieces, and the sum of the loads before each piece, shape (pieces, 2)."""
    ordered = sorted(loads, key=lambda load: load[0])
    places = np.array([place for place, _ in ordered], dtype=np.float64)
    forces = np.array([force for _, force in ordered], dtype=np.float64).reshape(-1, 2)
    if not np.all((places >= 0.0) & (places <= length)):
        raise ValueError(f"loads must stand on the rope, between 0 and its length {length:g}")
    if not np.all(np.isfinite(forces)):
        raise ValueError("the forces of the loads must be finite")
    return np.concatenate([[0.0], places, [length]]), np.vstack([np.zeros(2), np.cumsum(forces, axis=0)])
