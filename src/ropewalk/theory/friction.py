"""Friction that a load needs in order to stand still on a rope, by two models: capstan and point block.

A load parts the tensions of the rope behind and ahead of it, and the rope turns by ``angle`` at the load. As a
capstan, the rope wraps round a small wheel that holds it with Coulomb friction everywhere (Euler, Eytelwein); as
a point block, one normal and one tangential force act along the bisectors of the kink:

    capstan      |ln(T_ahead/T_behind)| <= mu angle
    point block  |T_ahead - T_behind| <= mu (T_ahead + T_behind) tan(angle/2)

They agree for small angles. Under a vertical load of weight W the block needs the slope of the mean tangent
``t_behind + t_ahead``, hold force by W of the frictionless contact in the same place. Derived here.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments

__all__ = [
    "capstan_coefficient",
    "point_block_coefficient",
    "turning_angle",
]

FloatArray = NDArray[np.float64]


def turning_angle(tangent_behind: ArrayLike, tangent_ahead: ArrayLike) -> FloatArray:
    """Return the angle in rad, 0..pi, by which the rope turns at the load.

    The arguments are the directions of the rope behind and ahead, both in the sense of growing xi, shape (..., 2),
    of any length, such as the internal forces there. `ValueError` for vectors that have no direction.
    """
    behind, ahead = np.asarray(tangent_behind, dtype=np.float64), np.asarray(tangent_ahead, dtype=np.float64)
    _arguments.vectors(2, tangent_behind=behind, tangent_ahead=ahead)
    _arguments.finite(tangent_behind=behind, tangent_ahead=ahead)
    if not (np.all(np.any(behind != 0.0, axis=-1)) and np.all(np.any(ahead != 0.0, axis=-1))):
        raise ValueError("tangent_behind and tangent_ahead must have a direction, so not be zero")
    cross = behind[..., 0] * ahead[..., 1] - behind[..., 1] * ahead[..., 0]
    return np.asarray(np.abs(np.arctan2(cross, np.sum(behind * ahead, axis=-1))))


def capstan_coefficient(*, tension_behind: ArrayLike, tension_ahead: ArrayLike, angle: ArrayLike) -> FloatArray:
    """Return the coefficient that a wrapped rope needs, ``|ln(T_ahead/T_behind)|/angle``.

    Tensions >= 0 in N, ``angle`` >= 0 in rad, arrays broadcast. Infinite if one side is slack or if different
    tensions meet without a turn, 0 for equal tensions. `ValueError` for arguments out of range.
    """
    behind, ahead, angle = _sides(tension_behind, tension_ahead, angle, np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        needed = np.log1p(np.abs(ahead - behind) / np.minimum(ahead, behind)) / angle
    return np.where(behind == ahead, 0.0, needed)


def point_block_coefficient(*, tension_behind: ArrayLike, tension_ahead: ArrayLike, angle: ArrayLike) -> FloatArray:
    """Return the coefficient that a point block needs, ``|T_ahead - T_behind|/((T_ahead + T_behind) tan(angle/2))``.

    Arguments as in `capstan_coefficient`, ``angle`` at most pi. Finite if one side is slack, ``cot(angle/2)``.
    """
    behind, ahead, angle = _sides(tension_behind, tension_ahead, angle, np.pi)
    with np.errstate(divide="ignore", invalid="ignore"):
        needed = np.abs(ahead - behind) / ((ahead + behind) * np.tan(0.5 * angle))
    return np.where(behind == ahead, 0.0, needed)


def _sides(
    tension_behind: ArrayLike, tension_ahead: ArrayLike, angle: ArrayLike, largest: float
) -> tuple[FloatArray, ...]:
    _arguments.finite(tension_behind=tension_behind, tension_ahead=tension_ahead, angle=angle)
    tensions = _arguments.within(0.0, np.inf, tension_behind=tension_behind, tension_ahead=tension_ahead)
    return *tensions, *_arguments.within(0.0, largest, angle=angle)
