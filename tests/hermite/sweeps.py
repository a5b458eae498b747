"""Sweeps over all wires in Hermite elements: solving with the factorised step matrix, products with the mass matrix.

All numbers of a step stand in one flat array of rows. A row holds FIELDS fields of LANES numbers: lane k of row s is
node `k * part + s - reach - 1` of the wires, which stand one after the other. So LANES stretches of the wires are swept
side by side. The recurrences of the factorised step matrix forget their start within `reach` nodes, to round-off;
that many rows before and behind a stretch repeat the nodes of its neighbours.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import lean, lean_inner

# Each name is the first field of its own. W and D: 2 x 2 blocks of the factors L and 1 / D; R: right side; Y: solution
# of L y = r, then of the whole; U, V: displacement and velocity; H: history, whose product with the mass matrix belongs
# to the right side; E: mass / 420 and length of the element towards the next node; CU: what U is multiplied by in H;
# CR: what the right side is multiplied by in the next. Their order, and the gap, are such that no
# sweep reads, soon after it has written, what lies 4096 bytes further: the processor would wait for the one to be
# written as if it were the other.
E, H, Y, R, D, CU, V, CR, U, W, FIELDS = 0, 2, 4, 6, 8, 11, 12, 15, 16, 18, 22
LANES = 16
ROW = FIELDS * LANES

# Indices without a sign need no look at negative ones: without these the loops over the lanes do not vectorise.
_u = np.uint64
_o, _n, _l = _u(1), _u(ROW), _u(LANES)
_W0, _W1, _W2, _W3 = _u(W * LANES), _u((W + 1) * LANES), _u((W + 2) * LANES), _u((W + 3) * LANES)
_D0, _D1, _D2 = _u(D * LANES), _u((D + 1) * LANES), _u((D + 2) * LANES)
_R0, _R1, _Y0, _Y1 = _u(R * LANES), _u((R + 1) * LANES), _u(Y * LANES), _u((Y + 1) * LANES)
_U0, _U1, _V0, _V1 = _u(U * LANES), _u((U + 1) * LANES), _u(V * LANES), _u((V + 1) * LANES)
_H0, _H1, _E0, _E1 = _u(H * LANES), _u((H + 1) * LANES), _u(E * LANES), _u((E + 1) * LANES)
_CU, _CR = _u(CU * LANES), _u(CR * LANES)


@lean
def factorise(diagonal, coupling, W, D):
    """Factorise a symmetric block tridiagonal matrix.

    Args:
        diagonal: (node, 2, 2).
        coupling: (node, 2, 2) block of the row of this node in the column of the one before.
        W: (node, 2, 2) receives the factor L.
        D: (node, 2, 2) receives the inverse of the pivots.
    """
    for j in range(diagonal.shape[0]):
        p, q, r = diagonal[j, 0, 0], diagonal[j, 0, 1], diagonal[j, 1, 1]
        if j > 0:
            for a in range(2):
                for b in range(2):
                    W[j, a, b] = coupling[j, a, 0] * D[j - 1, 0, b] + coupling[j, a, 1] * D[j - 1, 1, b]
            p -= W[j, 0, 0] * coupling[j, 0, 0] + W[j, 0, 1] * coupling[j, 0, 1]
            q -= W[j, 0, 0] * coupling[j, 1, 0] + W[j, 0, 1] * coupling[j, 1, 1]
            r -= W[j, 1, 0] * coupling[j, 1, 0] + W[j, 1, 1] * coupling[j, 1, 1]
        det = p * r - q * q
        D[j, 0, 0], D[j, 1, 1] = r / det, p / det
        D[j, 0, 1] = D[j, 1, 0] = -q / det


@lean
def column(W, D, i, load, lo, hi, found):
    """Solve for a load on nodes i and i + 1, between nodes lo and hi; (hi - lo + 1, 2) into `found`."""
    y0, y1 = load[0], load[1]
    found[i - lo, 0], found[i - lo, 1] = y0, y1
    for j in range(i + 1, hi + 1):
        z0 = -W[j, 0, 0] * y0 - W[j, 0, 1] * y1
        z1 = -W[j, 1, 0] * y0 - W[j, 1, 1] * y1
        if j == i + 1:
            z0 += load[2]
            z1 += load[3]
        y0, y1 = z0, z1
        found[j - lo, 0], found[j - lo, 1] = y0, y1
    x0, x1 = 0.0, 0.0
    for j in range(hi, lo - 1, -1):
        y0, y1 = (found[j - lo, 0], found[j - lo, 1]) if j >= i else (0.0, 0.0)
        z0 = D[j, 0, 0] * y0 + D[j, 0, 1] * y1
        z1 = D[j, 1, 0] * y0 + D[j, 1, 1] * y1
        if j < hi:
            z0 -= W[j + 1, 0, 0] * x0 + W[j + 1, 1, 0] * x1
            z1 -= W[j + 1, 0, 1] * x0 + W[j + 1, 1, 1] * x1
        x0, x1 = z0, z1
        found[j - lo, 0], found[j - lo, 1] = x0, x1


@lean_inner
def _repeat_before(t, field, depth, reach, part):
    """Copy a field of two to the rows that repeat the last nodes of the lane before."""
    f, m, n = _u(field) * _l, _u(reach), _u(part)
    for q in range(_u(depth)):
        for c in range(_u(2)):
            to = (m - q) * _n + f + c * _l
            for k in range(_l - _o):
                t[to + k + _o] = t[to + k + n * _n]


@lean_inner
def _repeat_after(t, field, depth, reach, part):
    """Copy a field of two to the rows that repeat the first nodes of the lane behind."""
    f, m, n = _u(field) * _l, _u(reach) + _o, _u(part)
    for q in range(_u(depth)):
        for c in range(_u(2)):
            to = (m + n + q) * _n + f + c * _l
            for k in range(_l - _o):
                t[to + k] = t[to + k + _o - n * _n]


@lean_inner
def _forward(t, reach, part):
    """Y = L^-1 R, all lanes side by side."""
    _repeat_before(t, R, reach, reach, part)
    for s in range(_o, _u(reach) + _u(part) + _o):
        for k in range(_l):
            i = s * _n + k
            p0, p1 = t[i - (_n - _Y0)], t[i - (_n - _Y1)]
            t[i + _Y0] = t[i + _R0] - t[i + _W0] * p0 - t[i + _W1] * p1
            t[i + _Y1] = t[i + _R1] - t[i + _W2] * p0 - t[i + _W3] * p1
    _repeat_after(t, Y, reach, reach, part)


@lean
def predict(t, reach, part):
    """Y = S^-1 R."""
    _forward(t, reach, part)
    own, last = _u(reach) + _o, _u(part) + _u(2) * _u(reach)
    for k in range(_l):  # beyond the last row there is nothing
        t[(last + _o) * _n + k + _Y0] = t[(last + _o) * _n + k + _Y1] = 0.0
    for q in range(own, last + _o):
        s = last + own - q
        for k in range(_l):
            i = s * _n + k
            n0, n1, y0, y1 = t[i + (_n + _Y0)], t[i + (_n + _Y1)], t[i + _Y0], t[i + _Y1]
            t[i + _Y0] = t[i + _D0] * y0 + t[i + _D1] * y1 - t[i + (_n + _W0)] * n0 - t[i + (_n + _W2)] * n1
            t[i + _Y1] = t[i + _D1] * y0 + t[i + _D2] * y1 - t[i + (_n + _W1)] * n0 - t[i + (_n + _W3)] * n1


@lean
def move(t, reach, part, c):
    """U = S^-1 R, with the velocity and the history that belong to it; c = 2 / dt."""
    _forward(t, reach, part)
    own, end, last = _u(reach) + _o, _u(reach) + _u(part), _u(part) + _u(2) * _u(reach)
    for q in range(end, last):
        s = last + end - q
        for k in range(_l):
            i = s * _n + k
            n0, n1, y0, y1 = t[i + (_n + _U0)], t[i + (_n + _U1)], t[i + _Y0], t[i + _Y1]
            t[i + _U0] = t[i + _D0] * y0 + t[i + _D1] * y1 - t[i + (_n + _W0)] * n0 - t[i + (_n + _W2)] * n1
            t[i + _U1] = t[i + _D1] * y0 + t[i + _D2] * y1 - t[i + (_n + _W1)] * n0 - t[i + (_n + _W3)] * n1
    for q in range(own, end + _o):
        s = end + own - q
        for k in range(_l):
            i = s * _n + k
            n0, n1, y0, y1 = t[i + (_n + _U0)], t[i + (_n + _U1)], t[i + _Y0], t[i + _Y1]
            x0 = t[i + _D0] * y0 + t[i + _D1] * y1 - t[i + (_n + _W0)] * n0 - t[i + (_n + _W2)] * n1
            x1 = t[i + _D1] * y0 + t[i + _D2] * y1 - t[i + (_n + _W1)] * n0 - t[i + (_n + _W3)] * n1
            v0, v1 = c * (x0 - t[i + _U0]) - t[i + _V0], c * (x1 - t[i + _U1]) - t[i + _V1]
            t[i + _U0], t[i + _U1], t[i + _V0], t[i + _V1] = x0, x1, v0, v1
            t[i + _H0], t[i + _H1] = t[i + _CU] * x0 + 2.0 * c * v0, t[i + _CU] * x1 + 2.0 * c * v1


@lean
def weigh(t, reach, part):
    """R = M H + CR R, with the consistent mass of the elements."""
    _repeat_before(t, H, 1, reach, part)
    _repeat_after(t, H, 1, reach, part)
    own = _u(reach) + _o
    for s in range(own, own + _u(part)):
        for k in range(_l):
            i = s * _n + k
            h0, h1, n0, n1 = t[i + _H0], t[i + _H1], t[i + (_n + _H0)], t[i + (_n + _H1)]
            p0, p1, a, b = t[i - (_n - _H0)], t[i - (_n - _H1)], t[i + _E0], t[i - (_n - _E0)]
            la, lb = t[i + _E1], t[i - (_n - _E1)]
            n1, p1, ha, hb = la * n1, lb * p1, la * h1, lb * h1
            r0 = a * (156.0 * h0 + 22.0 * ha + 54.0 * n0 - 13.0 * n1)
            r0 += b * (156.0 * h0 - 22.0 * hb + 54.0 * p0 + 13.0 * p1)
            r1 = a * la * (22.0 * h0 + 4.0 * ha + 13.0 * n0 - 3.0 * n1)
            r1 -= b * lb * (22.0 * h0 - 4.0 * hb + 13.0 * p0 + 3.0 * p1)
            t[i + _R0] = r0 + t[i + _CR] * t[i + _R0]
            t[i + _R1] = r1 + t[i + _CR] * t[i + _R1]
