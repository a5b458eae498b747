"""The rest shape of one strand between its supports under dead nodal forces, without a starting guess.

Every link of a hanging chain pulls. Its force vectors then follow from the one at the first link, R, by the balance
of the nodes, T_i = T_(i-1) - f_i, and the shape follows from the law. What is left is to find the R for which the
chain ends where it is held: the minimum of the complementary energy

    Phi(R) = sum_i ell_i C(|T_i|) - R . span + (R + f_0) . S_0 (R + f_0)/2 + (T_n - f_n) . S_n (T_n - f_n)/2,

where C(T) is the integral of the stretch from 0 to T, `span` joins the places of the supports, and S are their
compliances, zero where they are fixed. It is a convex function of two or three unknowns, whatever the number of links,
the sag or the stiffness (also if that is infinite: C(T) = T), so damped Newton steps find it from any start. It is the
Legendre dual of the potential energy, so its minimum is the shape of least potential energy; `equilibrium` then checks
and polishes that in the nodal positions where links do not pull.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import inner, kernel
from ropewalk.mechanics.elimination import solve_definite


@inner
def _phi(p, ell, f, span, soft, R, tiny, T, grad, hess):
    """Complementary energy with gradient and Hessian in R; T (axis,) is scratch."""
    dim, n = R.size, ell.size
    value = 0.0
    for a in range(dim):
        T[a] = R[a]
        value -= R[a] * span[a]
        grad[a] = -span[a]
        for b in range(dim):
            hess[a, b] = 0.0
    value += _support(soft[0], T, f, 0, 1.0, grad, hess)
    for i in range(n):
        square = tiny * tiny
        for a in range(dim):
            square += T[a] * T[a]
        size = np.sqrt(square)
        eps = law.strain(p, size)
        slope = max(law.tangent(p, eps), 1e-12 * p_scale(p))
        value += ell[i] * (size * (1.0 + eps) - law.stored(p, eps))
        along, across = ell[i] / slope, ell[i] * (1.0 + eps) / size
        for a in range(dim):
            grad[a] += across * T[a]
            hess[a, a] += across
            for b in range(dim):
                hess[a, b] += (along - across) * T[a] * T[b] / square
        if i < n - 1:
            for a in range(dim):
                T[a] -= f[a, i + 1]
    return value + _support(soft[1], T, f, n, -1.0, grad, hess)


@inner
def _support(soft, T, f, node, sign, grad, hess):
    """Add the complementary energy of a support, which yields to the pull T of the line and the force on its node."""
    dim, value = T.size, 0.0
    for a in range(dim):
        for b in range(dim):
            if soft[a, b] != 0.0:
                yielded = soft[a, b] * (T[b] + sign * f[b, node])
                grad[a] += yielded
                hess[a, b] += soft[a, b]
                value += 0.5 * (T[a] + sign * f[a, node]) * yielded
    return value


@kernel
def p_scale(p):
    """A stiffness that stands for the law, N: the one at rest, of a table the largest slope, 1 of a rigid one."""
    if p[0] == law.RIGID:
        return 1.0
    if p[0] != law.TABLE:
        return law.tangent(p, 1e-9)
    largest, n = 0.0, int(p[1])
    for i in range(n - 1):
        largest = max(largest, (p[3 + n + i] - p[2 + n + i]) / (p[3 + i] - p[2 + i]))
    return largest


@inner
def dot(a, b):
    """Scalar product."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@inner
def _newton_step(matrix, grad, step):
    """Solve matrix step = -grad for two or three unknowns, with a little shift if it is nearly singular; it is lost."""
    dim = grad.size
    trace = 0.0
    for a in range(dim):
        trace += matrix[a, a]
    for a in range(dim):
        matrix[a, a] += 1e-15 * trace
        step[a] = -grad[a]
    solve_definite(matrix, step, dim)


@inner
def _lay_out(p, ell, f, place, soft, R, tiny, T, r):
    """Positions from the force vector of the first link; returns the distance by which the end is missed, m."""
    dim, n = r.shape[0], ell.size
    for a in range(dim):
        T[a] = R[a]
        r[a, 0] = place[0, a]
    for a in range(dim):
        for b in range(dim):
            r[a, 0] += soft[0, a, b] * (T[b] + f[b, 0]) if soft[0, a, b] != 0.0 else 0.0
    for i in range(n):
        size = np.sqrt(dot(T, T) + tiny * tiny)
        stretch = ell[i] * (1.0 + law.strain(p, size)) / size
        for a in range(dim):
            r[a, i + 1] = r[a, i] + stretch * T[a]
            if i < n - 1:
                T[a] -= f[a, i + 1]
    miss = 0.0
    for a in range(dim):
        end = place[1, a]
        for b in range(dim):
            end += soft[1, a, b] * (f[b, n] - T[b]) if soft[1, a, b] != 0.0 else 0.0
        miss += (r[a, n] - end) ** 2
        r[a, n] = end
    return np.sqrt(miss)


@kernel
def hang(p, ell, f, place, soft, smooth, R, r):
    """Find the hanging shape.

    Args:
        p: axial law, see mechanics/law.py.
        ell: (link,) unstrained lengths, m.
        f: (axis, node) dead forces on the nodes, N; those on the end nodes count where the supports are soft.
        place: (2, axis) places of the supports, m.
        soft: (2, axis, axis) their compliances, m/N.
        smooth: part of the load below which a tension is rounded off, as a link without tension has no direction.
        R: (axis,) force vector of the first link, N: start value in, result out.
        r: (axis, node) positions, overwritten, m.

    Returns:
        The distance by which the chain misses its end, m (rounding error if all went well, or NaN).
    """
    dim, n = r.shape[0], ell.size
    total, length = 0.0, 0.0
    for i in range(n):
        length += ell[i]
        for a in range(dim):
            if i > 0:
                total += abs(f[a, i])
    tiny = smooth * (total if total > 0.0 else 1e-9 * p_scale(p))
    span, grad, T, step, trial = np.empty(dim), np.empty(dim), np.empty(dim), np.empty(dim), np.empty(dim)
    for a in range(dim):
        span[a] = place[1, a] - place[0, a]
    hess = np.empty((dim, dim))
    value = _phi(p, ell, f, span, soft, R, tiny, T, grad, hess)
    miss = np.sqrt(dot(grad, grad))
    best = miss
    rounding = 1e-15 * np.sqrt(n) * length
    for _ in range(300):
        if not miss > rounding:
            break
        _newton_step(hess, grad, step)
        descent = dot(grad, step)
        size = 1.0
        found = False
        for _ in range(60):
            for a in range(dim):
                trial[a] = R[a] + size * step[a]
            new = _phi(p, ell, f, span, soft, trial, tiny, T, grad, hess)
            now = np.sqrt(dot(grad, grad))
            if new <= value + 1e-4 * size * descent or now < 0.5 * miss:
                found = True
                break
            size *= 0.5
        if not found:  # rounding error reached: stay with the better of the two
            break
        stuck = now >= best and now < 1e-11 * length
        for a in range(dim):
            R[a] = trial[a]
        value, miss = new, now
        best = min(best, now)
        if stuck:
            break
    return _lay_out(p, ell, f, place, soft, R, tiny, T, r)


@kernel
def pulls(p, ell, f, R, pull, strain):
    """Force vectors (axis, link) and strains (link,) of a hanging chain from the force vector of its first link.

    Returns:
        The least tension, the size of the forces in N, and the unstrained length in m.
    """
    dim, n = pull.shape
    least, scale, length, total = np.inf, 0.0, 0.0, 0.0
    for a in range(dim):
        scale = max(scale, abs(R[a]))
    for i in range(n):
        square = 0.0
        for a in range(dim):
            pull[a, i] = R[a] if i == 0 else pull[a, i - 1] - f[a, i]
            square += pull[a, i] * pull[a, i]
            total += abs(f[a, i]) if i > 0 else 0.0
        size = np.sqrt(square)
        strain[i] = law.strain(p, size)
        least = min(least, size)
        length += ell[i]
    return least, max(scale, total), length
