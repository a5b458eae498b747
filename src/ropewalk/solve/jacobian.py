"""Jacobian of the moving chain, one strand at a time, and the systems of implicit steps that follow from it."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import inner, kernel
from ropewalk.solve.banded import factorise


@kernel
def linearise(strands, state, v, s, stiff, damp):
    """Jacobian of the forces on the inner nodes of strand s, moving loads and momentum flux included.

    Args:
        state: the instant about which to linearise.
        v: (axis, node) m/s, node velocities.
        stiff, damp: (part, node, axis, axis), overwritten: -df/dr and -df/dv, and in `damp` what the flux terms
            add to the inertia. The block above the diagonal in row i, and that below it in row i + 1, have the entry i.
    """
    i0, i1, c = strands.first[s], strands.first[s] + strands.links[s], strands.damping[s]
    p, m = strands.law[s], strands.rho[s] * strands.h[s]
    r, X, dim = state.r, state.X, state.r.shape[0]
    for i in range(i0, i1 + 1):
        for a in range(dim):
            for b in range(dim):
                stiff[0, i, a, b] = 0.0
                damp[0, i, a, b] = strands.drag[s] * m if a == b else 0.0
    for i in range(i0, i1):
        rest, square, along, spread = X[i + 1] - X[i], 0.0, 0.0, 0.0
        for k in range(state.moving_load.size):  # how fast the material beside moving loads grows
            if state.moving_load[k] == i + 1:
                spread += state.speed[k]
            elif state.moving_load[k] == i:
                spread -= state.speed[k]
        for a in range(dim):
            square += (r[a, i + 1] - r[a, i]) ** 2
            along += (r[a, i + 1] - r[a, i]) * (v[a, i + 1] - v[a, i])
        length = np.sqrt(square)
        eps = length / rest - 1.0
        rate = (along / length - length * spread / rest) / rest
        across = (law.tension(p, eps) + c * rate) / length
        per_length = (law.tangent(p, eps) - c * spread / rest) / rest
        for a in range(dim):
            da = (r[a, i + 1] - r[a, i]) / length
            for b in range(dim):
                db = (r[b, i + 1] - r[b, i]) / length
                turning = (v[b, i + 1] - v[b, i] - db * along / length) / length
                k = (per_length - across) * da * db + c / rest * da * turning + (across if a == b else 0.0)
                d = c / rest * da * db
                stiff[0, i, a, b] += k
                stiff[0, i + 1, a, b] += k
                stiff[1, i, a, b], stiff[2, i, a, b] = -k, -k
                damp[0, i, a, b] += d
                damp[0, i + 1, a, b] += d
                damp[1, i, a, b], damp[2, i, a, b] = -d, -d
    for k in range(state.moving_load.size):
        b = state.moving_load[k]
        if i0 < b < i1:
            flux = 2.0 * m * state.speed[k] / (X[b + 1] - X[b - 1])
            for a in range(dim):
                damp[1, b, a, a] -= flux
                damp[2, b - 1, a, a] += flux


@inner
def shifted(mu, m, i0, i1, stiff, damp, out):
    """Factors of mu^2 M + mu C + K, into out (diagonal, above, below, inverse, ratio)."""
    square, dim = mu * mu * m, stiff.shape[2]
    for part in range(3):
        for i in range(i0 + 1, i1):
            for a in range(dim):
                for b in range(dim):
                    out[part, i, a, b] = mu * damp[part, i, a, b] + stiff[part, i, a, b]
                if part == 0:
                    out[part, i, a, a] += square
    low, high = i0 + 1, i1
    return factorise(out[0, low:high], out[1, low:high], out[2, low:high], out[3, low:high], out[4, low:high])
