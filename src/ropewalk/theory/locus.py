"""Locus of a load that is moved slowly along a rope: where it stands, both tensions and the force that holds it.

One load at a time, in a family of places. `ellipse` is the closed form for the frictionless load on a weightless
inextensible rope, which runs on an ellipse about the supports; `frictionless` and `clamped` take every rope of
`ropewalk.theory.pulley` and `ropewalk.theory.rope`.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy import inf
from numpy.typing import ArrayLike

from ropewalk.theory import _arguments, _segments, friction, pulley, rope
from ropewalk.theory._segments import AxialLaw, FloatArray

__all__ = ["Locus", "clamped", "ellipse", "frictionless"]


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


def clamped(
    *,
    span: float,
    height: float = 0.0,
    length: float,
    weight: float = 0.0,
    axial_stiffness: float = inf,
    law: AxialLaw = "hooke",
    force: tuple[float, float],
    xi: ArrayLike,
) -> Locus:
    """Return the locus of a load clamped at the material coordinates ``xi`` (m, 0..length), any shape.

    ``force`` is (Fx, Fz) on the rope in N, z upwards; the rest as in `ropewalk.theory.rope.resting`. No force
    holds it but the clamp, and the rope may hang slack on one side.
    """

    def at(place: float) -> rope.RestingRope:
        if weight == 0.0 and np.isinf(axial_stiffness):
            return rope.weightless_inextensible(span=span, height=height, length=length, loads=[(place, force)])
        return rope.resting(
            span=span, height=height, length=length, weight=weight, axial_stiffness=axial_stiffness, law=law,
            loads=[(place, force)],
        )  # fmt: skip

    found = _along(at, xi, force, "xi")
    return replace(found, hold=np.zeros_like(found.hold))


def frictionless(
    *,
    span: float,
    height: float = 0.0,
    length: float,
    weight: float = 0.0,
    axial_stiffness: float = inf,
    law: AxialLaw = "hooke",
    force: tuple[float, float],
    x: ArrayLike | None = None,
    xi: ArrayLike | None = None,
) -> Locus:
    """Return the locus of a frictionless load, held at ``x`` or at the material coordinates ``xi``, in m, any shape.

    ``force`` is (Fx, Fz) on the rope in N, z upwards, without the hold force along x that is found; the rest as in
    `ropewalk.theory.pulley.resting`. `ValueError` unless just one of ``x`` and ``xi`` is given.
    """
    if (x is None) == (xi is None):
        raise ValueError("just one of x and xi must be given")
    places, restrained = (x, "horizontal") if xi is None else (xi, "material")

    def at(place: float) -> rope.RestingRope:
        return pulley.resting(
            span=span, height=height, length=length, weight=weight, axial_stiffness=axial_stiffness, law=law,
            loads=[(place, force)], restrained="horizontal" if restrained == "horizontal" else "material",
        )  # fmt: skip

    assert places is not None
    return _along(at, places, force, "x" if xi is None else "xi")


def _along(at: Callable[[float], rope.RestingRope], places: ArrayLike, force: tuple[float, float], name: str) -> Locus:
    places = np.asarray(places, dtype=np.float64)
    _arguments.finite(**{name: places})
    found = []
    for place in places.ravel():
        state = at(float(place))
        behind, ahead = state.load_forces[0] + state.force[1], state.force[1]
        tensions = state.load_tensions[0]
        slack = tensions <= 0.0
        tangent = sum(n / t for n, t in zip((behind, ahead), tensions, strict=True) if t > 0.0)
        angle = 0.0 if np.any(slack) else float(friction.turning_angle(behind, ahead))
        run, rise = (float(value) for value in np.broadcast_to(tangent, 2))
        slope = rise / run if run != 0.0 else float(np.copysign(inf, rise))
        hold = float(state.load_forces[0, 0]) - force[0]
        found.append([state.breaks[1], *state.load_positions[0], *tensions, hold, angle, slope])
    columns = np.array(found, dtype=np.float64).reshape(-1, 8).T
    return Locus(*(column.reshape(places.shape) for column in columns))
