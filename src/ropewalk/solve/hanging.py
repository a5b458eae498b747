"""The rest shape of one strand between fixed ends under dead nodal forces, without a starting guess.

Every link of a hanging chain pulls. Its force vectors then follow from the one at the first link, R, by the balance
of the nodes, T_i = T_(i-1) - f_i, and the shape follows from the law. What is left is to find the R for which the
chain ends where it is held: the minimum of the complementary energy

    Phi(R) = sum_i ell_i C(|T_i|) - R . (end - start),   C(T) = integral of the stretch from 0 to T,

a convex function of two or three unknowns, whatever the number of links, the sag or the stiffness. Damped Newton
steps find it from any start. It is the Legendre dual of the potential energy, so its minimum is the shape of least
potential energy; `equilibrium` then checks and polishes that in the nodal positions.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import kernel


@kernel
def _phi(p, ell, f, span, R, tiny, T, grad, hess):
    """Complementary energy with gradient and Hessian in R; T (axis,) is scratch."""
    dim, n = R.size, ell.size
    value = 0.0
    grad[:] = 0.0
    hess[:] = 0.0
    for a in range(dim):
        T[a] = R[a]
        value -= R[a] * span[a]
        grad[a] = -span[a]
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
    return value


@kernel
def p_scale(p):
    """A stiffness that stands for the law, N: the one at rest, of a table the largest slope."""
    if p[0] != law.TABLE:
        return law.tangent(p, 1e-9)
    largest, n = 0.0, int(p[1])
    for i in range(n - 1):
        largest = max(largest, (p[3 + n + i] - p[2 + n + i]) / (p[3 + i] - p[2 + i]))
    return largest


@kernel
def _newton_step(hess, grad, step):
    """Solve hess step = -grad for two or three unknowns, with a little shift if it is nearly singular."""
    dim = grad.size
    trace = 0.0
    for a in range(dim):
        trace += hess[a, a]
    matrix = hess.copy()
    for a in range(dim):
        matrix[a, a] += 1e-15 * trace
        step[a] = -grad[a]
    for a in range(dim):
        for b in range(a + 1, dim):
            ratio = matrix[b, a] / matrix[a, a]
            for c in range(a, dim):
                matrix[b, c] -= ratio * matrix[a, c]
            step[b] -= ratio * step[a]
    for a in range(dim - 1, -1, -1):
        for c in range(a + 1, dim):
            step[a] -= matrix[a, c] * step[c]
        step[a] /= matrix[a, a]


@kernel
def _lay_out(p, ell, f, start, end, R, tiny, T, r):
    """Positions from the force vector of the first link; returns the distance by which the end is missed, m."""
    dim, n = r.shape[0], ell.size
    for a in range(dim):
        T[a] = R[a]
        r[a, 0] = start[a]
    for i in range(n):
        size = np.sqrt((T * T).sum() + tiny * tiny)
        stretch = ell[i] * (1.0 + law.strain(p, size)) / size
        for a in range(dim):
            r[a, i + 1] = r[a, i] + stretch * T[a]
            if i < n - 1:
                T[a] -= f[a, i + 1]
    miss = 0.0
    for a in range(dim):
        miss += (r[a, n] - end[a]) ** 2
        r[a, n] = end[a]
    return np.sqrt(miss)


@kernel
def hang(p, ell, f, start, end, smooth, R, r):
    """Find the hanging shape.

    Args:
        p: axial law, see mechanics/law.py.
        ell: (link,) unstrained lengths, m.
        f: (axis, node) dead forces on the nodes, N; those on the two held nodes are not looked at.
        start, end: (axis,) m.
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
    span = end - start
    tiny = smooth * (total if total > 0.0 else p_scale(p))
    grad, T, step, trial = np.zeros(dim), np.zeros(dim), np.zeros(dim), np.zeros(dim)
    hess = np.zeros((dim, dim))
    value = _phi(p, ell, f, span, R, tiny, T, grad, hess)
    miss = np.sqrt((grad * grad).sum())
    best = miss
    for _ in range(300):
        if not miss > 1e-15 * length:
            break
        _newton_step(hess, grad, step)
        descent = (grad * step).sum()
        size = 1.0
        found = False
        for _ in range(60):
            trial[:] = R + size * step
            new = _phi(p, ell, f, span, trial, tiny, T, grad, hess)
            now = np.sqrt((grad * grad).sum())
            if new <= value + 1e-4 * size * descent or now < 0.5 * miss:
                found = True
                break
            size *= 0.5
        if not found:  # rounding error reached: stay with the better of the two
            break
        stuck = now >= best and now < 1e-11 * length
        R[:] = trial
        value, miss = new, now
        best = min(best, now)
        if stuck:
            break
    return _lay_out(p, ell, f, start, end, R, tiny, T, r)
