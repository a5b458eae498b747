"""Loci of loads that are moved slowly along any rope, clamped or frictionless, as `ropewalk.theory.locus.Locus`."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy import inf
from numpy.typing import ArrayLike

from closed_forms import pulley
from ropewalk.theory import _arguments, friction, rope
from ropewalk.theory._segments import AxialLaw
from ropewalk.theory.locus import Locus


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
    `closed_forms.pulley.resting`. `ValueError` unless just one of ``x`` and ``xi`` is given.
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
