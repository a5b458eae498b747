"""Ropes at rest between two supports under point loads clamped at material points, with or without weight.

The rope starts at (0, 0) and ends at (span, height), x along the span and z upwards, and is described along
its unstrained arc length xi. The internal force n(xi), which the part ahead exerts on the part behind, obeys
``n' = (0, weight)`` and jumps by minus the load at a point load.
The rope is as long as the shape that n gives it,

    r(length) - r(0) = integral of (1 + eps(|n|)) n/|n| d xi = (span, height),

which are two equations for the two components of n(0). They are the gradient of the complementary energy, a
convex function, so there is one solution and Newton's method with a line search finds it. Irvine, Cable
Structures, for the single elastic catenary; derived in docs/notes for the point loads. `shooting` and `balance`
solve the same ropes without this function.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy import inf
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments, _complementary, _convex, _segments
from ropewalk.theory._segments import AxialLaw, FloatArray, PointLoad

__all__ = [
    "AxialLaw",
    "PointLoad",
    "RestingRope",
    "catenary",
    "elastic_catenary",
    "resting",
    "weightless_elastic",
    "weightless_inextensible",
]


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
    def load_forces(self) -> FloatArray:
        """Forces (x, z) of the loads on the rope, hold forces included, shape (loads, 2)."""
        return np.asarray(self._force_at_piece_ends()[:-1] - self.force[1:])

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
        return np.asarray(self.nodes[piece] + _segments.reach(self.force[piece], covered, self.weight, self.compliance))

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


def resting(
    *,
    span: float,
    height: float = 0.0,
    length: float,
    weight: float = 0.0,
    axial_stiffness: float = inf,
    law: AxialLaw = "hooke",
    loads: Sequence[PointLoad] = (),
) -> RestingRope:
    """Return a rope at rest with any number of point loads clamped at material points.

    ``span`` > 0 and ``height`` are the end's position from the start's and ``length`` the unstrained length,
    in m; ``weight`` >= 0 in N per unstrained metre; ``axial_stiffness`` in N, infinite for an inextensible rope.
    ``loads`` is a sequence of ``(xi, (Fx, Fz))``: material coordinate in m (0 and length included) and force on
    the rope in N, z upwards. ``law`` is "hooke", ``T = EA eps``, or, without weight, "second_piola_kirchhoff",
    ``T = EA lam (lam - 1)``, the printed eqs. 6-7 of "Walking the Line. Traveling Forces vs Moving Masses".
    Pieces without weight may be slack, and the load hang below a support. `ValueError` for arguments out of
    range, for an inextensible rope not longer than the distance of its ends, and for no force on a slack rope
    without weight, which has no definite shape.
    """
    compliance = _segments.check_rope(span, height, length, weight, axial_stiffness, law)
    breaks, drops = _segments.break_at_loads(loads, length)
    segments, ends = np.diff(breaks), np.array([span, height])
    distance = float(np.hypot(span, height))
    if weight == 0.0:
        if not np.any(drops) and length >= distance:
            raise ValueError("a slack rope without weight or load has no definite shape: give a force")
        partly_slack = _partly_slack(breaks, ends, drops, compliance, law)
        if partly_slack is not None:
            return partly_slack
    offset = -drops + np.stack([np.zeros_like(segments), weight * breaks[:-1]], axis=1)
    energy = _complementary.of_rope(offset, segments, weight, compliance, law, ends)
    force = _convex.minimise(energy.gradient, energy.start(), scale=length + distance) + energy.offset
    if weight > 0.0:
        return _from_start(breaks, force, weight, compliance, law)
    return _from_both_ends(breaks, force, compliance, law, ends)


def catenary(
    *, span: float, height: float = 0.0, length: float, weight: float, loads: Sequence[PointLoad] = ()
) -> RestingRope:
    """Return the inextensible heavy rope, its arguments as in `resting`.

    Without loads in closed form: ``z = a cosh(x/a)`` with ``a = H/weight`` from
    ``sqrt(length^2 - height^2) = 2 a sinh(u)``, ``u = span/(2 a)``, and the vertical forces at the ends from
    their sum ``weight height coth(u)``.
    """
    _arguments.positive(weight=weight)
    if loads:
        return resting(span=span, height=height, length=length, weight=weight, loads=loads)
    _segments.check_rope(span, height, length, weight, inf, "hooke")
    distance = float(np.hypot(span, height))
    excess = (length - distance) * (length + distance) / span**2
    u = _segments.solve_log_sinhc(0.5 * float(np.log1p(excess)))
    horizontal = weight * span / (2.0 * u)
    vertical = 0.5 * weight * (height / float(np.tanh(u)) - length)
    return _from_start(np.array([0.0, length]), np.array([[horizontal, vertical]]), weight, 0.0, "hooke")


def elastic_catenary(
    *,
    span: float,
    height: float = 0.0,
    length: float,
    weight: float,
    axial_stiffness: float,
    loads: Sequence[PointLoad] = (),
) -> RestingRope:
    """Return the heavy elastic rope (Hooke), shorter, equal or longer than its span; arguments as in `resting`.

    Between loads, Irvine: ``x = H s/EA + (H/w) [asinh(v/H)]``, ``z = [v^2]/(2 w EA) + [sqrt(H^2 + v^2)]/w``,
    ``v = v_0 + w s``; written without the differences, so that light and taut ropes lose no digits.
    """
    _arguments.positive(weight=weight, axial_stiffness=axial_stiffness)
    return resting(span=span, height=height, length=length, weight=weight, axial_stiffness=axial_stiffness, loads=loads)


def weightless_elastic(
    *,
    span: float,
    height: float = 0.0,
    length: float,
    axial_stiffness: float,
    loads: Sequence[PointLoad],
    law: AxialLaw = "hooke",
) -> RestingRope:
    """Return the elastic rope without weight, its arguments as in `resting`.

    Force balance ``n_ahead = n_behind - F`` with ``sum of length_i lam(|n_i|) n_i/|n_i| = (span, height)``.
    """
    _arguments.positive(axial_stiffness=axial_stiffness)
    return resting(span=span, height=height, length=length, axial_stiffness=axial_stiffness, law=law, loads=loads)


def weightless_inextensible(
    *, span: float, height: float = 0.0, length: float, loads: Sequence[PointLoad]
) -> RestingRope:
    """Return the inextensible rope without weight, a polygon; its arguments as in `resting`.

    One load stands where two circles about the supports meet; between level supports
    ``x = (span^2 + s^2 - (length - s)^2)/(2 span)``. Nearer to the end than ``length - s =
    (length^2 - span^2)/(2 length)`` a vertical load hangs below the support and leaves the long piece slack.
    """
    if len(loads) != 1:
        return resting(span=span, height=height, length=length, loads=loads)
    _segments.check_rope(span, height, length, 0.0, inf, "hooke")
    breaks, drops = _segments.break_at_loads(loads, length)
    if not np.any(drops):
        raise ValueError("a slack rope without weight or load has no definite shape: give a force")
    ends = np.array([span, height])
    hanging = _partly_slack(breaks, ends, drops, 0.0, "hooke")
    return hanging if hanging is not None else _two_circles(breaks, ends, drops[1])


def _two_circles(breaks: FloatArray, ends: FloatArray, pull: FloatArray) -> RestingRope:
    """Both pieces straight and taut: the triangle over the supports with the pieces as sides."""
    behind, ahead = np.diff(breaks)
    distance = float(np.hypot(*ends))
    # the foot of the height on the chord, and the height by Heron's formula without cancellation (Kahan)
    foot = 0.5 * (distance + (behind - ahead) * (behind + ahead) / distance)
    perimeter = (behind + ahead + distance) * (behind + ahead - distance)
    height = np.sqrt(perimeter * (distance - (behind - ahead)) * (distance + (behind - ahead))) / (2.0 * distance)
    chord = ends / distance
    normal = np.array([-chord[1], chord[0]])
    place = foot * chord + np.copysign(height, pull @ normal) * normal
    first, second = place / behind, (ends - place) / ahead
    turn = first[0] * second[1] - first[1] * second[0]
    # pull = T_behind first - T_ahead second
    tension_behind = (pull[0] * second[1] - pull[1] * second[0]) / turn
    tension_ahead = (pull[0] * first[1] - pull[1] * first[0]) / turn
    force = np.stack([tension_behind * first, tension_ahead * second])
    return RestingRope(0.0, 0.0, breaks, np.stack([0.0 * ends, place, ends]), force)


def _partly_slack(
    breaks: FloatArray, ends: FloatArray, drops: FloatArray, compliance: float, law: AxialLaw
) -> RestingRope | None:
    """Weightless rope of which a piece, and all others under the same force, is slack, if there is such a state."""
    segments = np.diff(breaks)
    for candidate in drops[segments > 0.0]:
        force = candidate - drops
        slack = ~np.any(force, axis=1)
        steps = _segments.reach(force, segments, 0.0, compliance, law)
        gap, spare = ends - steps[~slack].sum(axis=0), float(segments[slack].sum())
        if np.hypot(*gap) <= spare:
            steps[slack] = gap * (segments[slack] / spare)[:, np.newaxis]
            nodes = np.vstack([np.zeros(2), np.cumsum(steps, axis=0)[:-1], ends])
            return RestingRope(0.0, 0.0, breaks, nodes, force)
    return None


def _from_start(breaks: FloatArray, force: FloatArray, weight: float, compliance: float, law: AxialLaw) -> RestingRope:
    steps = _segments.reach(force, np.diff(breaks), weight, compliance, law)
    return RestingRope(weight, compliance, breaks, np.vstack([np.zeros(2), np.cumsum(steps, axis=0)]), force)


def _from_both_ends(
    breaks: FloatArray, force: FloatArray, compliance: float, law: AxialLaw, ends: FloatArray
) -> RestingRope:
    nodes = _from_start(breaks, force, 0.0, compliance, law).nodes
    nodes[-1] = ends
    return RestingRope(0.0, 0.0, breaks, nodes, force)
