"""Ropes at rest by shooting: integrate the rope from its start under a trial force, and walk the miss to zero.

A route independent of `rope` and of `balance`. The rope is integrated from its definition,
``dr/dxi = lam(|n|) n/|n|`` with ``n' = (0, weight)`` and jumps at the loads, by Gauss's quadrature and not by
catenary formulas. Where the tension is small the tangent turns within ``H/weight`` of the lowest point; panels
shrink towards it so that the complex zeros of the tension, ``v = +-i H``, stay one panel length away, and 16
points give the full 16 digits (Bernstein ellipse ``2 + sqrt(3)``: an error of ``3.7^-32``).

The trial force is moved by continuation: whatever point the first shot hits becomes the target, and the target
then walks straight to the support. Points that a rope can reach form a convex set and the reach grows
monotonically with the force, so the way is free.
"""

from collections.abc import Sequence

import numpy as np
from numpy import inf

from ropewalk.theory import _segments
from ropewalk.theory._segments import AxialLaw, FloatArray, PointLoad
from ropewalk.theory.rope import RestingRope

__all__ = ["resting", "shot"]

_ABSCISSAE, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_DEEPEST = 200  # halvings of a panel towards a point without tension


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
    """Return the same as `ropewalk.theory.rope.resting`, with the same arguments, by shooting from the start.

    `ValueError` also if a piece without weight is slack: its direction, and so the shot, is not defined.
    """
    compliance = _segments.check_rope(span, height, length, weight, axial_stiffness, law)
    breaks, drops = _segments.break_at_loads(loads, length)
    if weight == 0.0 and not np.any(drops) and length >= np.hypot(span, height):
        raise ValueError("a slack rope without weight or load has no definite shape: give a force")
    ends = np.array([span, height])
    passed = drops[breaks[:-1] < breaks[1:]]  # loads on the supports do not matter
    scale = weight * length + float(np.abs(passed - passed[0]).sum())
    if compliance > 0.0:
        scale = max(scale, (np.hypot(span, height) / length - 1.0) / compliance)
    mean = 0.5 * (passed[0] + passed[-1]) - np.array([0.0, 0.5 * weight * length])
    force = None
    for pull, turn in ((1.0, 0.0), (30.0, 0.0), (1.0, 0.6), (1.0, -0.6), (30.0, 0.6), (30.0, -0.6), (1e3, 0.0)):
        chord = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]) @ ends / np.hypot(span, height)
        force = _walk(ends, mean + pull * scale * chord, breaks, drops, weight, compliance, law)
        if force is not None:
            break
    else:
        raise ValueError("no shot hits the end: a piece without weight is slack, or the data are too extreme")
    nodes, _ = shot(force, breaks, drops, weight, compliance, law)
    starts = force - drops + np.stack([np.zeros(len(drops)), weight * breaks[:-1]], axis=1)
    return RestingRope(weight, compliance, breaks, nodes, starts)


def shot(
    force: FloatArray, breaks: FloatArray, drops: FloatArray, weight: float, compliance: float, law: AxialLaw
) -> tuple[FloatArray, FloatArray]:
    """Return start, loads and end of the rope that begins with ``force``, shape (pieces + 1, 2), and d(end)/d(force).

    ``breaks`` are the ends of the pieces in m, ``drops`` the sums of the loads before each piece in N, (pieces, 2).
    """
    nodes, slope = [np.zeros(2)], np.zeros((2, 2))
    for begin, end, drop in zip(breaks[:-1], breaks[1:], drops, strict=True):
        step, turn = _integrate(force - drop + np.array([0.0, weight * begin]), end - begin, weight, compliance, law)
        nodes.append(nodes[-1] + step)
        slope = slope + turn
    return np.array(nodes), slope


def _integrate(
    force: FloatArray, length: float, weight: float, compliance: float, law: AxialLaw
) -> tuple[FloatArray, FloatArray]:
    """Integrals of ``lam t`` and of its derivative by the force, ``t t/T' + (I - t t) lam/T``, over one piece."""
    edges = _panels(force, length, weight)
    half = 0.5 * np.diff(edges)[:, np.newaxis]
    xi = (0.5 * (edges[1:] + edges[:-1])[:, np.newaxis] + half * _ABSCISSAE).ravel()
    part = (half * _WEIGHTS).ravel()
    n = np.stack([np.full_like(xi, force[0]), force[1] + weight * xi], axis=1)
    tension = np.maximum(np.hypot(n[:, 0], n[:, 1]), 1e-300)
    tangent = n / tension[:, np.newaxis]
    eps = _segments.strain(tension, compliance, law)
    give = np.full_like(eps, compliance) if law == "hooke" else compliance / (1.0 + 2.0 * eps)
    reach = ((part * (1.0 + eps))[:, np.newaxis] * tangent).sum(axis=0)
    turn = part * (1.0 + eps) / tension
    along = np.einsum("i,ij,ik->jk", part * give - turn, tangent, tangent)
    return reach, turn.sum() * np.eye(2) + along


def _panels(force: FloatArray, length: float, weight: float) -> FloatArray:
    """Edges of panels, none longer than its middle is far from the complex zeros of the tension."""
    if weight == 0.0 or length == 0.0:
        return np.array([0.0, length])
    lowest, width = -force[1] / weight, abs(force[0]) / weight
    nearest = float(np.clip(lowest, 0.0, length))
    edges = {0.0, nearest, length}
    for far in (0.0, length):
        reach = far - nearest
        for _ in range(_DEEPEST):
            if abs(reach) <= np.hypot(nearest + 0.5 * reach - lowest, width):
                break
            reach *= 0.5
            edges.add(nearest + reach)
    return np.array(sorted(edges))


def _walk(
    ends: FloatArray,
    force: FloatArray,
    breaks: FloatArray,
    drops: FloatArray,
    weight: float,
    compliance: float,
    law: AxialLaw,
) -> FloatArray | None:
    """Force at the start of the rope that hits ``ends``: the target walks there from where the first shot hits."""
    size = float(breaks[-1] + np.hypot(*ends))
    nodes, slope = shot(force, breaks, drops, weight, compliance, law)
    first, done, step = nodes[-1], 0.0, 1.0
    for _ in range(2000):
        target = first + min(done + step, 1.0) * (ends - first)
        trial, hit, last, change = force, nodes[-1], np.inf, force
        trial_slope = slope
        for _ in range(30):
            try:
                change = np.linalg.solve(trial_slope, hit - target)
            except np.linalg.LinAlgError:
                break
            trial = trial - change
            shape, trial_slope = shot(trial, breaks, drops, weight, compliance, law)
            hit = shape[-1]
            miss = float(np.max(np.abs(hit - target)))
            if miss > 0.7 * last or not np.isfinite(miss):
                break
            last = miss
        # at the end the miss falls to roundings, of the length or through the force; on the way a loose hit does
        reached = last <= (1e-13 if done + step >= 1.0 else 1e-3 * step) * size
        reached |= bool(np.max(np.abs(change)) <= 1e-15 * float(np.max(np.abs(trial - drops))))
        if reached and done + step >= 1.0:
            return np.asarray(trial)
        if reached:
            done, force, nodes, slope, step = done + step, trial, shape, trial_slope, 2.0 * step
            step = min(step, 1.0 - done)
        else:
            step *= 0.5
            if step < 1e-6:
                break
    return None
