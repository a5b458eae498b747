"""Ropes at rest by the balance of forces at the loads: the unknowns are where the loads stand.

A route independent of `rope` and of `shooting`. Every piece is a rope between known ends, solved on its own; at
each load the pull of the piece behind, the pull of the piece ahead and the load must cancel. The potential energy
of a rope is a convex function of where its loads stand, and this balance is its gradient; Newton's method with a
line search finds the place.


A heavy piece of length s over dx > 0 and dz, with the half sum q and the half difference p of asinh(v/H) at its
ends and kappa = weight s/(2 EA), obeys

    dz = s tanh(q) (1 + kappa coth p),    dx cosh(q) sinh(p) = s (p + kappa),    2 H cosh(q) sinh(p) = weight s;

q follows from the first, and the second is one decreasing function of p. Derived here from Irvine's equations.
Without elasticity, kappa = 0, it is the catenary's ``dx sinh(p)/p = sqrt(s^2 - dz^2)``. Where a rope is so stiff
that roundings of places spoil the forces, and where it is inextensible, the pulls become unknowns, too; heavy pieces
then share their formula with `rope`, and `shooting` alone is independent of it.
"""

from collections.abc import Sequence

import numpy as np
from numpy import hypot, inf, isinf, log, log1p, tanh

from ropewalk.theory import _convex, _segments
from ropewalk.theory._segments import AxialLaw, FloatArray, PointLoad
from ropewalk.theory.rope import RestingRope

__all__ = ["heavy_piece", "resting", "straight_piece"]

_SLACK = 1e-9  # stiffness of slack pieces without weight, by force and length: keeps Newton's matrix regular


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
    """Return the same as `ropewalk.theory.rope.resting`, with the same arguments, by the balance at the loads."""
    compliance = _segments.check_rope(span, height, length, weight, axial_stiffness, law)
    breaks, drops = _segments.break_at_loads(loads, length)
    segments, ends = np.diff(breaks), np.array([span, height])
    if weight == 0.0 and not np.any(drops) and length >= hypot(span, height):
        raise ValueError("a slack rope without weight or load has no definite shape: give a force")
    # loads in one place, to the roundings of places, act as one; loads on a support go into it
    long = segments > 1e-13 * length
    forces = np.diff(drops[long], axis=0)
    scale = float(np.abs(forces).sum()) + weight * length
    inner = breaks[1:-1][long[:-1]] if long[-1] else breaks[1:-1][long[:-1]][:-1]
    guess = np.outer(inner / length, ends)
    rope = (guess, ends, segments[long], forces, weight, compliance, law, scale)
    places, pulls = _elastic(*rope) or _stiffened(*rope)
    index = np.concatenate([[0], np.cumsum(long)])
    nodes = np.vstack([np.zeros(2), places, ends])[index]
    force = pulls[np.minimum(index[:-1], len(pulls) - 1)]
    for i in np.flatnonzero(~long):
        # a piece without length carries what its neighbour carries, but for the loads between them
        near = int(np.argmin(np.where(long, np.abs(np.arange(len(long)) - i), len(long))))
        force[i] = pulls[index[near]] + drops[near] - drops[i] + [0.0, weight * (breaks[i] - breaks[near])]
    return RestingRope(weight, compliance, breaks, nodes, force)


def heavy_piece(step: FloatArray, length: float, weight: float, compliance: float) -> FloatArray:
    """Return the internal force (H, v) at the beginning of a heavy piece over ``step`` (dx, dz), in N.

    ``length`` in m, ``weight`` > 0 in N per unstrained metre, ``compliance`` 1/EA in 1/N. Not finite if the piece
    is inextensible and too short.
    """
    from scipy.optimize import brentq

    dx, dz = abs(float(step[0])), float(step[1])
    kappa = 0.5 * weight * length * compliance
    distance = hypot(dx, dz)
    spare = (length - distance) * (length + distance)
    if compliance == 0.0 and spare <= 0.0:
        return np.full(2, np.nan)
    if dx == 0.0:
        return _vertical_piece(dz, length, weight, kappa)

    def excess(p: float) -> float:
        more = kappa / tanh(p)
        rise = dz / (1.0 + more)
        if abs(rise) >= length:
            return -inf
        # log((s^2 - rise^2)/dx^2), without the difference of s and dx where they are close
        inside = (spare + dz * dz * (more / (1.0 + more)) * (1.0 + 1.0 / (1.0 + more))) / dx**2
        straight = log1p(inside) if abs(inside) < 0.5 else log((length - rise) / dx * ((length + rise) / dx))
        return float(log1p(kappa / p) - _segments.log_sinhc(p) + 0.5 * straight)

    if kappa == 0.0:
        p = _segments.solve_log_sinhc(0.5 * log1p(spare / dx**2))
    else:
        low = high = 1.0
        while excess(low) <= 0.0:
            low *= 0.25
        while excess(high) > 0.0:
            high *= 2.0
        while isinf(excess(high)):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if excess(middle) > 0.0 else (low, middle)
            if high - low <= 4e-16 * high:
                break
        p = low if isinf(excess(high)) else float(brentq(excess, low, high, xtol=1e-300, rtol=1e-15))
    tangent = dz / (length * (1.0 + kappa / tanh(p)))
    horizontal = 0.5 * weight * dx / (p + kappa)  # from the second and third equation
    vertical = 0.5 * weight * length * (tangent / tanh(p) - 1.0)
    return np.array([np.copysign(horizontal, step[0]), vertical])


def straight_piece(step: FloatArray, length: float, compliance: float, law: AxialLaw = "hooke") -> FloatArray:
    """Return the internal force in N of a piece without weight over ``step``, zero where it is slack."""
    distance = hypot(*step)
    eps = distance / length - 1.0
    if eps <= 0.0:
        return np.zeros(2)
    tension = eps / compliance * (1.0 if law == "hooke" else 1.0 + eps)
    return np.asarray(tension / distance * step)


def _vertical_piece(dz: float, length: float, weight: float, kappa: float) -> FloatArray:
    """A loop, or a piece stretched along the vertical: ``tanh(q) coth(p)`` where cosh(q) or p is infinite."""
    tangent = dz / (length * (1.0 + kappa))
    lifted = tangent if abs(tangent) <= 1.0 else np.sign(dz) * (abs(dz) / length - 1.0) / kappa
    return np.array([0.0, 0.5 * weight * length * (lifted - 1.0)])


def _steps(places: FloatArray, ends: FloatArray) -> FloatArray:
    return np.diff(np.vstack([np.zeros(2), places, ends]), axis=0)


def _pulls(steps: FloatArray, segments: FloatArray, weight: float, compliance: float, law: AxialLaw) -> FloatArray:
    """Internal force at the beginning of every piece."""
    if weight > 0.0:
        return np.array([heavy_piece(step, s, weight, compliance) for step, s in zip(steps, segments, strict=True)])
    return np.array([straight_piece(step, s, compliance, law) for step, s in zip(steps, segments, strict=True)])


def _elastic(
    places: FloatArray,
    ends: FloatArray,
    segments: FloatArray,
    forces: FloatArray,
    weight: float,
    compliance: float,
    law: AxialLaw,
    scale: float,
) -> tuple[FloatArray, FloatArray] | None:
    """Places where the pulls behind and ahead cancel the loads, and the pulls; nothing if the rope is too stiff.

    Places are all that is known here, and a very stiff rope turns their roundings into forces.
    """
    if compliance == 0.0:
        return None
    gain = np.stack([0.0 * segments, weight * segments], axis=1)
    soft = _SLACK * scale / float(segments.sum())
    far = float(segments.sum()) * (1.0 + scale * compliance) + float(hypot(*ends))

    def miss(flat: FloatArray) -> tuple[FloatArray, FloatArray]:
        pulls = _pulls(_steps(flat.reshape(-1, 2), ends), segments, weight, compliance, law)
        residual = (pulls + gain)[:-1] - pulls[1:] - forces
        return residual.ravel(), _assembled(_stiffness(pulls, segments, weight, compliance, law, soft))

    if len(places):
        try:
            places = _convex.minimise(miss, places.ravel(), scale, longest=far).reshape(-1, 2)
        except (ValueError, np.linalg.LinAlgError):
            return None
    return places, _pulls(_steps(places, ends), segments, weight, compliance, law)


def _stiffness(
    pulls: FloatArray, segments: FloatArray, weight: float, compliance: float, law: AxialLaw, soft: float
) -> FloatArray:
    """Derivative of every piece's pull by its step, shape (pieces, 2, 2)."""
    stiffness = np.tile(soft * np.eye(2), (len(segments), 1, 1))
    taut = np.any(pulls != 0.0, axis=1) & np.all(np.isfinite(pulls), axis=1)
    give = _segments.reach_derivative(pulls[taut], segments[taut], weight, compliance, law)
    stiffness[taut] = np.linalg.inv(give)
    return stiffness


def _assembled(stiffness: FloatArray) -> FloatArray:
    """Stiffness of the inner nodes of a row of pieces."""
    k = len(stiffness) - 1
    matrix = np.zeros((2 * k, 2 * k))
    for j in range(k):
        matrix[2 * j : 2 * j + 2, 2 * j : 2 * j + 2] = stiffness[j] + stiffness[j + 1]
        if j:
            matrix[2 * j : 2 * j + 2, 2 * j - 2 : 2 * j] = matrix[2 * j - 2 : 2 * j, 2 * j : 2 * j + 2] = -stiffness[j]
    return matrix


def _stiffened(
    places: FloatArray,
    ends: FloatArray,
    segments: FloatArray,
    forces: FloatArray,
    weight: float,
    compliance: float,
    law: AxialLaw,
    scale: float,
) -> tuple[FloatArray, FloatArray]:
    """Places and pulls of a stiff or inextensible rope: soft at first, then ever stiffer.

    A piece that is nearly straight turns roundings of its ends into any tension, so that places alone do not say
    enough; places and pulls together do, with the balance at the loads and ``reach(pull) = step``.
    """
    soft = max(compliance, 1e-2 / scale)
    found = _elastic(places, ends, segments, forces, weight, soft, law, scale)
    if found is None:
        raise ValueError("no balance found: the data are too extreme for double precision")
    places, pulls = found
    while soft > compliance:
        size = max(scale, float(np.abs(pulls).max()))
        soft = max(0.2 * soft, compliance) if soft * size > 1e-15 else compliance
        places, pulls = _mixed(places, pulls, ends, segments, forces, weight, soft, law, scale)
    return places, pulls


def _mixed(
    places: FloatArray,
    pulls: FloatArray,
    ends: FloatArray,
    segments: FloatArray,
    forces: FloatArray,
    weight: float,
    compliance: float,
    law: AxialLaw,
    scale: float,
) -> tuple[FloatArray, FloatArray]:
    """Newton's method for places and pulls of all pieces but slack ones without weight."""
    k, length, best = len(places), float(segments.sum()), inf
    gain = np.stack([0.0 * segments, weight * segments], axis=1)
    taut = np.ones(len(segments), dtype=bool) if weight > 0.0 else np.any(pulls != 0.0, axis=1)
    matrix = np.zeros((4 * k + 2, 4 * k + 2))
    matrix[: 2 * k, 2 * k :] = np.eye(2 * k, 2 * k + 2) - np.eye(2 * k, 2 * k + 2, 2)
    matrix[2 * k :, : 2 * k] = -matrix[: 2 * k, 2 * k :].T * np.repeat(taut, 2)[:, np.newaxis]
    for _ in range(30):
        residual = ((pulls + gain)[:-1] - pulls[1:] - forces).ravel()
        gap = _segments.reach(pulls, segments, weight, compliance, law) - _steps(places, ends)
        turn = np.tile(np.eye(2), (len(segments), 1, 1))
        turn[taut] = _segments.reach_derivative(pulls[taut], segments[taut], weight, compliance, law)
        for i, block in enumerate(turn):
            at = slice(2 * k + 2 * i, 2 * k + 2 * i + 2)
            matrix[at, at] = block
        gap[~taut] = 0.0
        change = np.linalg.solve(matrix, -np.concatenate([residual, gap.ravel()]))
        places, pulls = places + change[: 2 * k].reshape(-1, 2), pulls + change[2 * k :].reshape(-1, 2)
        pulls[~taut] = 0.0
        miss = float(np.abs(gap).max() / length + (np.abs(residual).max() / scale if k else 0.0))
        if miss <= 1e-15 or (miss <= 1e-11 and miss >= 0.5 * best):
            break
        best = min(best, miss)
    else:
        raise ValueError("no balance found: a piece is about to become slack, or the data are too extreme")
    if np.any(np.hypot(*_steps(places, ends)[~taut].T) > segments[~taut] * (1.0 + 1e-12)):
        raise ValueError("a piece is about to become slack: the balance does not find out which")
    return places, pulls
