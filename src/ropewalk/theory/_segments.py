"""Pieces of rope between supports and point loads: how far a piece reaches under the force at its beginning.

A piece of ``weight`` in N per unstrained metre, 0 for a straight one, and of ``compliance`` 1/EA, 0 for an
inextensible one. Heavy pieces obey Hooke's law, weightless ones either law.
"""

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ropewalk.theory import _arguments

__all__ = [
    "AxialLaw",
    "FloatArray",
    "PointLoad",
    "break_at_loads",
    "check_rope",
    "end_gradient",
    "log_sinhc",
    "reach",
    "reach_derivative",
    "solve_log_sinhc",
    "strain",
]

FloatArray = NDArray[np.float64]
AxialLaw = Literal["hooke", "second_piola_kirchhoff"]
PointLoad = tuple[float, tuple[float, float]]  # material coordinate in m, force (Fx, Fz) in N
_TINY = float(np.finfo(np.float64).tiny)


def check_rope(
    span: float, height: float, length: float, weight: float, axial_stiffness: float, law: AxialLaw
) -> float:
    """Return the compliance 1/EA; raise `ValueError` for a rope that is not one."""
    _arguments.positive(span=span, length=length)
    _arguments.finite(height=height)
    _arguments.not_negative(weight=weight)
    if not axial_stiffness > 0.0:
        raise ValueError(f"axial_stiffness must be positive, infinite for an inextensible rope, not {axial_stiffness}")
    if law not in ("hooke", "second_piola_kirchhoff"):
        raise ValueError(f"law must be 'hooke' or 'second_piola_kirchhoff', not {law!r}")
    if law != "hooke" and weight > 0.0:
        raise ValueError(f"law must be 'hooke' for a rope with weight, not {law!r}")
    distance = float(np.hypot(span, height))
    if np.isinf(axial_stiffness) and length <= distance:
        raise ValueError(f"an inextensible rope of {length:g} m does not hang between ends {distance:g} m apart")
    return 1.0 / axial_stiffness


def break_at_loads(loads: Sequence[PointLoad], length: float) -> tuple[FloatArray, FloatArray]:
    """Ends of the pieces, and the sum of the loads before each piece, shape (pieces, 2)."""
    ordered = sorted(loads, key=lambda load: load[0])
    places = np.array([place for place, _ in ordered], dtype=np.float64)
    forces = np.array([force for _, force in ordered], dtype=np.float64).reshape(-1, 2)
    if not np.all((places >= 0.0) & (places <= length)):
        raise ValueError(f"loads must stand on the rope, between 0 and its length {length:g}")
    if not np.all(np.isfinite(forces)):
        raise ValueError("the forces of the loads must be finite")
    return np.concatenate([[0.0], places, [length]]), np.vstack([np.zeros(2), np.cumsum(forces, axis=0)])


def strain(tension: FloatArray, compliance: float, law: AxialLaw = "hooke") -> FloatArray:
    """Strain under a tension, ``T = EA eps`` or ``T = EA (1 + eps) eps``."""
    ratio = np.asarray(tension) * compliance
    return ratio if law == "hooke" else np.asarray(ratio / (0.5 + np.sqrt(0.25 + ratio)))


def complementary(tension: FloatArray, compliance: float, law: AxialLaw = "hooke") -> FloatArray:
    """Integral of the stretch over the tension, J per unstrained metre."""
    eps = strain(tension, compliance, law)
    share = 0.5 if law == "hooke" else (0.5 + eps * (2.0 / 3.0)) / (1.0 + eps)
    return np.asarray(tension * (1.0 + share * eps))


def reach(
    force: FloatArray, length: FloatArray, weight: float, compliance: float, law: AxialLaw = "hooke"
) -> FloatArray:
    """Vectors from the beginning to the end of pieces whose internal force begins with ``force``, (..., 2).

    ``x = H s/EA + (H/w) [asinh(v/H)]`` and ``z = [v^2]/(2 w EA) + [sqrt(H^2 + v^2)]/w``, ``v = v_0 + w s``.
    """
    h, v = force[..., 0], force[..., 1]
    if weight == 0.0:
        tension = np.maximum(np.hypot(h, v), _TINY)
        return (length * (1.0 + strain(tension, compliance, law)))[..., np.newaxis] * (force / tension[..., np.newaxis])
    v_mean = v + 0.5 * weight * length
    t_mean = np.maximum(0.5 * (np.hypot(h, v) + np.hypot(h, v + weight * length)), _TINY)
    x = length * h * compliance + h * _length_by_tension(h, v, length, weight)
    z = length * v_mean * (compliance + 1.0 / t_mean)
    return np.stack([x, z], axis=-1)


def reach_derivative(
    force: FloatArray, length: FloatArray, weight: float, compliance: float, law: AxialLaw = "hooke"
) -> FloatArray:
    """Derivative of `reach` by the force, the integral of ``t t/T' + (I - t t) lam/T``, shape (pieces, 2, 2)."""
    h, v = force[..., 0], force[..., 1]
    if weight == 0.0:
        tension = np.maximum(np.hypot(h, v), _TINY)
        tangent = force / tension[..., np.newaxis]
        stretch = 1.0 + strain(tension, compliance, law)
        give = compliance * np.ones_like(tension) if law == "hooke" else compliance / (2.0 * stretch - 1.0)
        along = tangent[..., :, np.newaxis] * tangent[..., np.newaxis, :]
        turn = (length * stretch / tension)[..., np.newaxis, np.newaxis] * (np.eye(2) - along)
        return np.asarray(turn + (length * give)[..., np.newaxis, np.newaxis] * along)
    v_end = v + weight * length
    t_0, t_1 = np.maximum(np.hypot(h, v), _TINY), np.maximum(np.hypot(h, v_end), _TINY)
    zz = length / (t_0 + t_1) * (1.0 + (h / t_0) * (h / t_1) - (v / t_0) * (v_end / t_1))
    xz = -length / (t_0 + t_1) * ((h / t_0) * (v_end / t_1) + (v / t_0) * (h / t_1))
    xx = np.maximum(_length_by_tension(h, v, length, weight) - zz, 0.0)
    bend = np.stack([np.stack([xx, xz], axis=-1), np.stack([xz, zz], axis=-1)], axis=-1)
    return np.asarray(bend + compliance * length[..., np.newaxis, np.newaxis] * np.eye(2))


def end_gradient(force: FloatArray, compliance: float, law: AxialLaw = "hooke") -> FloatArray:
    """Derivative of `reach` by the length of the piece, dr/dxi at its end, where the force is ``force``."""
    tension = np.maximum(np.hypot(force[..., 0], force[..., 1]), _TINY)
    return (1.0 + strain(tension, compliance, law))[..., np.newaxis] * (force / tension[..., np.newaxis])


def log_sinhc(u: float) -> float:
    """Return log(sinh(u)/u) for u >= 0 without cancellation."""
    if u > 1.0:
        return u + float(np.log1p(-np.exp(-2.0 * u)) - np.log(2.0 * u))
    series = 0.0
    for k in range(9, 0, -1):
        series = u * u / (2 * k * (2 * k + 1)) * (1.0 + series)
    return float(np.log1p(series))


def solve_log_sinhc(value: float) -> float:
    """Solve log(sinh(u)/u) = value > 0."""
    from scipy.optimize import brentq

    low = float(np.sqrt(6.0 * value))
    high = 1.1 * low
    while log_sinhc(high) < value:
        high *= 2.0
    return float(brentq(lambda u: log_sinhc(u) - value, 0.999 * low, high, xtol=1e-15 * low, rtol=1e-15))


def _length_by_tension(h: FloatArray, v: FloatArray, length: FloatArray, weight: float) -> FloatArray:
    """Integral of d xi/|n| along a heavy piece, ``[asinh(v/h)]/weight`` without the difference."""
    rest = _tension_plus(h, v) + _tension_plus(h, -(v + weight * length))  # t_0 + t_1 - weight * length
    rest = np.maximum(rest, 1e-250)  # a vertical piece without tension at its lowest point
    ratio = 2.0 * weight * length / rest
    return np.where(ratio > 0.0, np.log1p(ratio) / np.where(ratio > 0.0, weight, 1.0), 2.0 * length / rest)


def _tension_plus(h: FloatArray, v: FloatArray) -> FloatArray:
    """``sqrt(h^2 + v^2) + v`` without cancellation."""
    tension = np.hypot(h, v)
    return np.where(v < 0.0, h * (h / np.maximum(tension + np.abs(v), _TINY)), tension + v)
