"""An overhead line in another condition than that in which it was fitted: droppers missing, wire worn, warm or cold.

Droppers have the lengths of the fitted line, its arms press as they did. Wires between anchored ends keep their
unstrained length S, but for its thermal expansion; their tensions follow from it (equation of state):

    S(T, EA') = (1 + alpha dT) S(T0, EA),   S = sum of the links' lengths l / (1 + T / EA)
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.model.condition import Condition
from ropewalk.wires.mesh import mesh_of
from ropewalk.wires.plan import Array, PointMass, Wire, WirePlan
from ropewalk.wires.rest import hung, rest_of

_CLOSE = 1e-9  # relative, of tensions
_ANCHORED = 2  # contact wire and messenger are the first wires; stitch wires keep their tension


def in_condition(
    plan: WirePlan, element: float, droppers: list[str], condition: Condition, *, anchored: bool
) -> tuple[WirePlan, list[int]]:
    """The plan of a line in another condition, and the numbers of the droppers that are left.

    Args:
        plan: of the fitted line; its ties begin with the droppers, its masses end with those below and above them.
        element: length of links, m.
        droppers: their names, `line.span.number`.
        condition: as declared.
        anchored: whether the ends of contact wire and messenger stand still.

    Raises:
        EquilibriumError: there are no tensions with which the wires hang between their ends.
    """
    gone = {f"{span}.{number}" for span, number in condition.missing_droppers}
    kept = [i for i, name in enumerate(droppers) if ".".join(name.rsplit(".", 2)[1:]) not in gone]
    count, longer = len(droppers), 1.0 + condition.expansion * condition.temperature_rise
    others, own = plan.masses[: len(plan.masses) - 2 * count], plan.masses[len(plan.masses) - 2 * count :]
    masses: tuple[PointMass, ...] = (*others, *(own[i] for i in kept), *(own[count + i] for i in kept))
    ties = [replace(plan.ties[i], length=plan.ties[i].length * longer) for i in kept]
    wires = (worn(plan.wires[0], condition.wear), *plan.wires[1:])
    changed = replace(plan, wires=wires, masses=masses, ties=(*ties, *plan.ties[count:]))
    if anchored and (condition.wear or condition.temperature_rise):
        changed = _tensioned(changed, element, longer * _unstrained(plan, element))
    return changed, kept


def worn(wire: Wire, wear: float) -> Wire:
    """A wire that has lost a part of its cross-section along a flat.

    Args:
        wire: as new.
        wear: lost part of the cross-section.
    """
    left = 1.0 - wear
    return replace(
        wire, mass=wire.mass * left, axial_stiffness=wire.axial_stiffness * left,
        bending_stiffness=wire.bending_stiffness * flat_bending(wear),
    )  # fmt: skip


def flat_bending(wear: float) -> float:
    """Second moment of area of a circle without a segment, about the level axis through its centroid, to the whole's.

    With t, half of the angle of the segment, of radius 1: segment area t - sin t cos t, first moment 2/3 sin^3 t,
    second moment (t - sin t cos t + 2 sin^3 t cos t) / 4, both about the centre.

    Args:
        wear: area of the segment over that of the circle.
    """
    if wear <= 0.0:
        return 1.0
    from scipy.optimize import brentq  # lazy: it takes long to import

    t = brentq(lambda t: t - math.sin(t) * math.cos(t) - wear * math.pi, 0.0, math.pi, xtol=1e-14)
    s, c = math.sin(t), math.cos(t)
    away = 2.0 / 3.0 * s**3 / (math.pi * (1.0 - wear))
    second = math.pi / 4.0 - 0.25 * (t - s * c + 2.0 * s**3 * c) - math.pi * (1.0 - wear) * away**2
    return float(second / (math.pi / 4.0))


def _unstrained(plan: WirePlan, element: float) -> Array:
    """Unstrained lengths of contact wire and messenger at rest, m."""
    mesh = mesh_of(plan, element)
    lengths = hung(mesh, rest_of(mesh).position)
    return np.array([lengths[mesh.of(i)][:-1].sum() for i in range(_ANCHORED)])


def _tensioned(plan: WirePlan, element: float, wanted: Array) -> WirePlan:
    """The plan with the tensions with which contact wire and messenger have the wanted unstrained lengths."""
    first = np.array([wire.tension for wire in plan.wires[:_ANCHORED]])
    stiff = np.array([wire.axial_stiffness for wire in plan.wires[:_ANCHORED]])

    def under(tension: Array) -> WirePlan:
        pairs = zip(plan.wires, tension, strict=False)
        taut = tuple(replace(wire, tension=float(T)) for wire, T in pairs)
        return replace(plan, wires=(*taut, *plan.wires[_ANCHORED:]))

    def excess(share: Array) -> Array:
        tension = first * np.exp(share)  # never in compression
        return np.asarray((_unstrained(under(tension), element) - wanted) / wanted * stiff / first)

    from scipy.optimize import root  # lazy: as above

    try:
        with np.errstate(all="ignore"):  # what overflows is no rest
            found = root(excess, np.zeros(_ANCHORED), tol=_CLOSE)
            error = float(np.abs(found.fun).max())
    except EquilibriumError:
        found = None
    if found is None or not (found.success and error <= 1e3 * _CLOSE):
        raise EquilibriumError(
            "no tensions are found with which the wires hang between their anchored ends; give less wear or a smaller "
            "change of temperature, or let weights keep the tension (ends: weights)"
        )
    return under(first * np.exp(found.x))
