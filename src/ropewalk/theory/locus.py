"""Locus of a load that is moved slowly along a rope: its position, both tensions and the driving force.

A frictionless load on a weightless inextensible rope moves on an ellipse about the supports.
"""

from dataclasses import dataclass

import numpy as np
from numpy import inf
from numpy.typing import ArrayLike

from ropewalk.theory import _segments, friction
from ropewalk.theory._segments import FloatArray

__all__ = ["Locus", "ellipse"]


@dataclass(frozen=True)
class Locus:
    """Places of a load and forces on it, arrays of one shape; z upwards."""

    xi: FloatArray  # material coordinate, m
    x: FloatArray  # position, m
    z: FloatArray
    tension_behind: FloatArray  # N
    tension_ahead: FloatArray  # N
    hold: FloatArray  # force along x that holds the load, on the rope, beyond the given force, N
    turning_angle: FloatArray  # by which the rope turns at the load, rad; 0 next to a slack piece
    slope: FloatArray  # dz/dx of the mean t_behind + t_ahead of the tangents; of the taut piece next to a slack one


def ellipse(*, span: float, height: float = 0.0, length: float, load: ArrayLike, x: ArrayLike) -> Locus:
    """Return the locus of a frictionless load on a weightless inextensible rope, in closed form.

    ``span`` > 0 and ``height`` are the end's position from the start's in m, ``length`` in m, longer than their
    distance d; ``load`` > 0 in N, downwards, and ``x`` in m, arrays that broadcast. Beyond the supports, as far as
    the ellipse goes, the rope runs backwards. `ValueError` for arguments out of range.

    With ``A = (L^2 - d^2 + 2 x span)/(2 L)``, ``B = height/L`` the piece behind is ``A + B z`` long, and
    ``z = (A B - sqrt(A^2 - (1 - B^2) x^2))/(1 - B^2)``; between level supports the ellipse with the semi-axes
    ``L/2`` and ``sqrt(L^2 - span^2)/2``. The hold force is the load times its slope. Derived here.
    """
    _segments.check_rope(span, height, length, 0.0, inf, "hooke")
    load, x = (np.asarray(value, dtype=np.float64) for value in (load, x))
    load, x = np.broadcast_arrays(load, x)
    if not np.all((load > 0.0) & np.isfinite(load)):
        raise ValueError("load must be finite and positive, downwards")
    distance = float(np.hypot(span, height))
    spare = (length - distance) * (length + distance) / (2.0 * length)
    inside = spare * (spare + 2.0 * x * (span - x) / length)
    if not np.all(inside > 0.0):
        reach = float(np.sqrt(0.25 * span**2 + 0.5 * spare * length))
        raise ValueError(f"x must lie inside the ellipse, between {0.5 * span - reach:g} and {0.5 * span + reach:g}")
    root, b = np.sqrt(inside), height / length
    a, flat = spare + x * span / length, (1.0 - b) * (1.0 + b)
    z = (a * b - root) / flat
    slope = (b * span / length - spare * (span - 2.0 * x) / (length * root)) / flat
    xi = a + b * z
    behind = np.stack([x, z], axis=-1) / xi[..., np.newaxis]
    ahead = np.stack([span - x, height - z], axis=-1) / (length - xi)[..., np.newaxis]
    tension = load / (ahead[..., 1] - behind[..., 1])
    angle = friction.turning_angle(behind, ahead)
    return Locus(xi, np.array(x), z, tension, tension.copy(), load * slope, angle, slope)
