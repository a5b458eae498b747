"""Fabrics of triangles with constant strain: two families of threads, or an isotropic sheet; both pull only.

With X the material coordinates and x the places of the corners, F = [x2 - x1, x3 - x1] [X2 - X1, X3 - X1]^-1.

Threads along the two material axes have the stretches |F e1| and |F e2| and the tension per width A (stretch - 1),
where that is positive. In a right triangle whose legs are threads this is exactly half of the links along its legs: a
net of cells halved by diagonals is the net of its threads.

A sheet has the Green strain E = (F^T F - 1)/2 with the principal values e1 >= e2 and the relaxed energy of tension
field theory (Pipkin, IMA J. Appl. Math. 36, 85, 1986; Steigmann, Proc. R. Soc. A 429, 141, 1990):
A/(2 (1 - nu^2)) (e1^2 + e2^2 + 2 nu e1 e2) where e2 > -nu e1, A e1^2 / 2 where it is wrinkled, 0 where it is slack.

    fabrics: kind, A_u, A_v, c_u, c_v  or  kind, A, nu, c, -
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.compiled import inlined, lean, lean_inner
from ropewalk.system.elements.cells import THREADS, Cells


@inlined
def _gradient(cells, e, r, F):
    """Deformation gradient (3, 2) of a cell."""
    i, j, k = cells.node[e, 0], cells.node[e, 1], cells.node[e, 2]
    for a in range(3):
        p, q = r[j, a] - r[i, a], r[k, a] - r[i, a]
        F[a, 0] = p * cells.inverse[e, 0] + q * cells.inverse[e, 2]
        F[a, 1] = p * cells.inverse[e, 1] + q * cells.inverse[e, 3]


@inlined
def _principal(F):
    """Green strains e1 >= e2 and the direction (cos, sin) of the first."""
    xx, yy, xy = 0.0, 0.0, 0.0
    for a in range(3):
        xx += F[a, 0] * F[a, 0]
        yy += F[a, 1] * F[a, 1]
        xy += F[a, 0] * F[a, 1]
    xx, yy, xy = 0.5 * (xx - 1.0), 0.5 * (yy - 1.0), 0.5 * xy
    middle, half = 0.5 * (xx + yy), 0.5 * (xx - yy)
    radius = np.sqrt(half * half + xy * xy)
    if radius < 1e-300:
        return middle, middle, 1.0, 0.0
    angle = 0.5 * np.arctan2(xy, half)
    return middle + radius, middle - radius, np.cos(angle), np.sin(angle)


@lean_inner
def tensions(cells, e, r, F):
    """Tension per width of a cell, N/m: of threads along u and v, of a sheet the larger and the smaller one."""
    _gradient(cells, e, r, F)
    p = cells.fabrics[cells.membrane_elements[e]]
    if p[0] == THREADS:
        u = np.sqrt(F[0, 0] * F[0, 0] + F[1, 0] * F[1, 0] + F[2, 0] * F[2, 0])
        v = np.sqrt(F[0, 1] * F[0, 1] + F[1, 1] * F[1, 1] + F[2, 1] * F[2, 1])
        return p[1] * max(u - 1.0, 0.0), p[2] * max(v - 1.0, 0.0)
    e1, e2, _, _ = _principal(F)
    if e1 <= 0.0:
        return 0.0, 0.0
    # Force per width of the deformed sheet itself, which is not less where it wrinkles: stretch along over that across.
    along, across = np.sqrt(1.0 + 2.0 * e1), np.sqrt(max(1.0 + 2.0 * max(e2, -p[2] * e1), 1e-12))
    if e2 <= -p[2] * e1:
        return p[1] * e1 * along / across, 0.0
    c = p[1] / (1.0 - p[2] * p[2])
    return c * (e1 + p[2] * e2) * along / across, c * (e2 + p[2] * e1) * across / along


@lean
def _note_tensions(cells, r, F, out):
    for i in range(out.shape[0]):
        for e in range(out.shape[1]):
            out[i, e, 0], out[i, e, 1] = tensions(cells, e, r[i].T, F)


def tensions_of(cells: Cells, count: int, r: Array) -> Array:
    """Tensions per width (instant, cell, 2) of the first cells at places r (instant, axis, node), N/m."""
    out = np.zeros((len(r), count, 2))
    _note_tensions(cells, np.ascontiguousarray(r), np.zeros((3, 2)), out)
    return out


@lean_inner
def stored(cells, e, r, F):
    """Energy stored in a cell, J."""
    _gradient(cells, e, r, F)
    p = cells.fabrics[cells.membrane_elements[e]]
    if p[0] == THREADS:
        u = np.sqrt(F[0, 0] * F[0, 0] + F[1, 0] * F[1, 0] + F[2, 0] * F[2, 0])
        v = np.sqrt(F[0, 1] * F[0, 1] + F[1, 1] * F[1, 1] + F[2, 1] * F[2, 1])
        eu, ev = max(u - 1.0, 0.0), max(v - 1.0, 0.0)
        return 0.5 * cells.area[e] * (p[1] * eu * eu + p[2] * ev * ev)
    e1, e2, _, _ = _principal(F)
    if e1 <= 0.0:
        return 0.0
    if e2 <= -p[2] * e1:
        return 0.5 * cells.area[e] * p[1] * e1 * e1
    return 0.5 * cells.area[e] * p[1] / (1.0 - p[2] * p[2]) * (e1 * e1 + e2 * e2 + 2.0 * p[2] * e1 * e2)


@inlined
def _sheet_stress(p, e1, e2, c, s):
    """Second Piola-Kirchhoff stress xx, yy, xy of a sheet."""
    if e1 <= 0.0:
        return 0.0, 0.0, 0.0
    if e2 <= -p[2] * e1:
        one, two = p[1] * e1, 0.0
    else:
        k = p[1] / (1.0 - p[2] * p[2])
        one, two = k * (e1 + p[2] * e2), k * (e2 + p[2] * e1)
    return one * c * c + two * s * s, one * s * s + two * c * c, (one - two) * c * s


@inlined
def _spread(cells, e, P, f):
    """Add the forces of a first Piola-Kirchhoff stress P (3, 2) to the corners of a cell."""
    i, j, k, A = cells.node[e, 0], cells.node[e, 1], cells.node[e, 2], cells.area[e]
    for a in range(3):
        at_j = A * (P[a, 0] * cells.inverse[e, 0] + P[a, 1] * cells.inverse[e, 1])
        at_k = A * (P[a, 0] * cells.inverse[e, 2] + P[a, 1] * cells.inverse[e, 3])
        f[j, a] -= at_j
        f[k, a] -= at_k
        f[i, a] += at_j + at_k


@lean_inner
def add_membrane_forces(cells, begin, end, r, f, F, P):
    """Add the elastic forces of the cells `begin` ... `end` - 1 to f (node, 3)."""
    for e in range(begin, end):
        _gradient(cells, e, r, F)
        p = cells.fabrics[cells.membrane_elements[e]]
        if p[0] == THREADS:
            u = np.sqrt(F[0, 0] * F[0, 0] + F[1, 0] * F[1, 0] + F[2, 0] * F[2, 0])
            v = np.sqrt(F[0, 1] * F[0, 1] + F[1, 1] * F[1, 1] + F[2, 1] * F[2, 1])
            qu = p[1] * max(u - 1.0, 0.0) / max(u, 1e-12)
            qv = p[2] * max(v - 1.0, 0.0) / max(v, 1e-12)
            for a in range(3):
                P[a, 0], P[a, 1] = qu * F[a, 0], qv * F[a, 1]
        else:
            e1, e2, c, s = _principal(F)
            xx, yy, xy = _sheet_stress(p, e1, e2, c, s)
            for a in range(3):
                P[a, 0], P[a, 1] = F[a, 0] * xx + F[a, 1] * xy, F[a, 0] * xy + F[a, 1] * yy
        _spread(cells, e, P, f)


@lean_inner
def damp_cells(cells, begin, end, r, v, f, F, P, V):
    """Add the Kelvin-Voigt forces of the cells `begin` ... `end` - 1 to f.

    Returns:
        Power lost, W.
    """
    lost = 0.0
    for e in range(begin, end):
        p = cells.fabrics[cells.membrane_elements[e]]
        if p[3] == 0.0 and p[4] == 0.0:
            continue
        _gradient(cells, e, r, F)
        _gradient(cells, e, v, V)
        if p[0] == THREADS:
            for b in range(2):
                square, along = 0.0, 0.0
                for a in range(3):
                    square += F[a, b] * F[a, b]
                    along += F[a, b] * V[a, b]
                rate = along / max(square, 1e-24)  # rate of the stretch over the stretch
                lost += cells.area[e] * p[3 + b] * rate * along
                for a in range(3):
                    P[a, b] = p[3 + b] * rate * F[a, b]
        else:
            xx, yy, xy = 0.0, 0.0, 0.0
            for a in range(3):
                xx += F[a, 0] * V[a, 0]
                yy += F[a, 1] * V[a, 1]
                xy += 0.5 * (F[a, 0] * V[a, 1] + F[a, 1] * V[a, 0])
            xx, yy, xy = p[3] * xx, p[3] * yy, p[3] * xy
            lost += cells.area[e] * (xx * xx + yy * yy + 2.0 * xy * xy) / p[3]
            for a in range(3):
                P[a, 0], P[a, 1] = F[a, 0] * xx + F[a, 1] * xy, F[a, 0] * xy + F[a, 1] * yy
        _spread(cells, e, P, f)
    return lost


def bounds_of_cells(cells: Cells, nodes: int) -> tuple[Array, Array]:
    """Sums of absolute stiffness (N/m) and damping (N s/m) of the cells around each of so many nodes."""
    b, area, p = cells.inverse, cells.area, cells.fabrics[cells.membrane_elements]
    g = np.stack([[-b[:, 0] - b[:, 2], -b[:, 1] - b[:, 3]], [b[:, 0], b[:, 1]], [b[:, 2], b[:, 3]]])  # corner, axis
    threads, sheet = p[:, 0] == THREADS, p[:, 1] / (1.0 - np.minimum(p[:, 2], 0.99) ** 2)
    sums, size = np.abs(g).sum(axis=0), np.sqrt((g**2).sum(axis=1))
    stiffness, damping = np.zeros((2, nodes))
    for corner in range(3):
        along = [area * np.abs(g[corner, a]) * sums[a] for a in range(2)]
        whole = area * size[corner] * size.sum(axis=0)
        k = np.where(threads, p[:, 1] * along[0] + p[:, 2] * along[1], sheet * whole)
        c = np.where(threads, p[:, 3] * along[0] + p[:, 4] * along[1], p[:, 3] * whole)
        np.add.at(stiffness, cells.node[:, corner], k)
        np.add.at(damping, cells.node[:, corner], c)
    return stiffness, damping


@inlined
def _sheet_tangent(p, e1, e2, c, s, D):
    """dS/dE (4, 4) of a sheet over index pairs xx, xy, yx, yy, without slack."""
    for m in range(4):
        for n in range(4):
            D[m, n] = 0.0
    one = c, s
    two = -s, c
    if e2 <= -p[2] * e1:
        turn = p[1] * e1 / (e1 - e2)
        for a in range(2):
            for b in range(2):
                for g in range(2):
                    for d in range(2):
                        mixed = 0.5 * (one[a] * two[b] + two[a] * one[b]) * (one[g] * two[d] + two[g] * one[d])
                        D[2 * a + b, 2 * g + d] = p[1] * one[a] * one[b] * one[g] * one[d] + turn * mixed
        return
    k, nu = p[1] / (1.0 - p[2] * p[2]), p[2]
    D[0, 0], D[3, 3], D[0, 3], D[3, 0] = k, k, k * nu, k * nu
    shear = 0.5 * k * (1.0 - nu)
    D[1, 1], D[1, 2], D[2, 1], D[2, 2] = shear, shear, shear, shear


@lean_inner
def cell_stiffness(cells, e, r, K, F, D):
    """Write the tangent stiffness (9, 9) of a cell to K."""
    for m in range(9):
        for n in range(9):
            K[m, n] = 0.0
    _gradient(cells, e, r, F)
    p = cells.fabrics[cells.membrane_elements[e]]
    b = cells.inverse[e]
    g = (-b[0] - b[2], -b[1] - b[3]), (b[0], b[1]), (b[2], b[3])
    A = cells.area[e]
    if p[0] == THREADS:
        for w in range(2):
            length = np.sqrt(F[0, w] * F[0, w] + F[1, w] * F[1, w] + F[2, w] * F[2, w])
            if length <= 1.0:
                continue
            q = p[1 + w] * (length - 1.0) / length
            for a in range(3):
                for d in range(3):
                    C = (p[1 + w] - q) * F[a, w] * F[d, w] / (length * length)
                    if a == d:
                        C += q
                    for m in range(3):
                        for n in range(3):
                            K[3 * m + a, 3 * n + d] += A * g[m][w] * g[n][w] * C
        return
    e1, e2, co, si = _principal(F)
    if e1 <= 0.0:
        return
    xx, yy, xy = _sheet_stress(p, e1, e2, co, si)
    _sheet_tangent(p, e1, e2, co, si, D)
    S = (xx, xy), (xy, yy)
    for m in range(3):
        for n in range(3):
            q = 0.0
            for al in range(2):
                for be in range(2):
                    q += g[m][al] * S[al][be] * g[n][be]
            for a in range(3):
                for d in range(3):
                    total = q if a == d else 0.0
                    for al in range(2):
                        for be in range(2):
                            inner = 0.0
                            for ga in range(2):
                                for de in range(2):
                                    inner += F[a, ga] * D[2 * ga + al, 2 * de + be] * F[d, de]
                            total += g[m][al] * inner * g[n][be]
                    K[3 * m + a, 3 * n + d] += A * total
