"""How a line gives way under a contact beside its spline: the Green's function of the line less that of its links.

A point force P at x of a run moves it by P G(x), and the spline through its nodes by P g(x); the rest G - g is the tip
of the kink that links of finite length round off. It depends on what lies within some links: on the place within a
link, on a support close by and on zeta = (EI/h^2) / (T + EI/h^2), the part that bending has,

    G - g = h / (T + EI/h^2) * kappa(x, zeta).

Both are computed here, for a run of eighty links that is held at its ends and may turn there. Source of the exact one:
a taut beam under a point force, x (L - x) / (L T) less the part of bending, with its length sqrt(EI/T).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.compiled import lean, lean_inner
from ropewalk.mechanics.kernel_cache import kept
from ropewalk.system.elements.spline import WIDTH, share

# The arc of a link above its chord, over the one that a circle through its neighbours has: the length of a
# smooth curve is right to the fourth order of the mesh.
CORRECTION = 1.0
# The same of the change of the curvature between its ends. 4/15 would make waves right to the sixth order; more of it
# lets no wave of the links be slower than a kink at nine tenths of the speed of waves, which would radiate it.
SHORT = 1.0
# Bending energy of the change of the curvature, over h^2 times that of the curvature: exact to the fourth order.
SMOOTH = 1.0 / 6.0
# What the squares of second differences, and of their change, add to half the square of the length of a link.
ARC, SHORT_ARC = CORRECTION / 48.0, SHORT / 48.0
# Part of kappa within a run, below which it is kept from vanishing at ends: there a kink would be as stiff as the end,
# and what passes a joint or a support would meet it within a step. It is softer within a third of a link from them.
PART = 0.5
LEAST = 1e-9  # of kappa, which is nothing at supports
AT_REST = 1e-4  # the same of what stands still: hardly any
CELL, NEAR, PARTS, SHARES = 80, 8, 64, 33  # links of the run, tabled ones, places in each, values of zeta
# Factor of kappa under a contact at the part alpha of the speed of transverse waves, beside 1/(1 - alpha^2): from the
# Fourier transforms of a line and of its links under a steadily moving force, at these squares of alpha; the test of
# the table computes them anew. Beyond the last one links resolve no kink that is carried ahead of its waves.
KINETIC = np.array([
    (0.0, 0.04, 0.16, 0.25, 0.36, 0.49, 0.64, 0.7225, 0.81, 0.9025),
    (1.0, 1.0017, 1.0077, 1.0133, 1.0222, 1.0373, 1.0669, 1.0954, 1.1483, 1.2802),
])  # fmt: skip


@lru_cache(maxsize=4)
def compliances(correction: float = CORRECTION, part: float = PART) -> Array:
    """1/kappa and its slope with sqrt(zeta), (2, value of sqrt(zeta), place), for places in the first links of a run.

    As the least energy of all shapes of a kink, S(T) is concave; 1/kappa over zeta is, and begins as a root. Between
    its values it is interpolated so that S(T) stays concave and smooth: else a kink and its tension have several
    states of rest, and energy comes from nowhere where they jump from one to another.

    Args:
        correction: of the arc of links.
        part: PART or AT_REST.
    """
    name, shape = f"compliances-{correction!r}-{part!r}", (2, SHARES, NEAR * PARTS + 1)
    return kept(name, shape, lambda: _tabled(correction, part))


def _tabled(correction: float, part: float) -> Array:
    """The table itself: a third of a second's work, and more where many threads are wakened for it."""
    from scipy import linalg  # lazy: most runs find it kept
    from scipy.interpolate import CubicSpline

    places = np.arange(NEAR * PARTS + 1) / PARTS
    weights = np.zeros((places.size, CELL + 1))
    slope = np.zeros(WIDTH)
    for row, x in zip(weights, places, strict=True):
        weight = np.zeros(WIDTH)
        base = share(x, CELL, weight, slope)
        row[base : base + WIDTH] = weight
    one, two = np.diff(np.eye(CELL + 1), axis=0)[:, 1:-1], np.diff(np.eye(CELL + 1), 2, axis=0)[:, 1:-1]
    three = np.diff(np.pad(two, ((1, 1), (0, 0))), axis=0)
    inner = weights[:, 1:-1]
    found, root = np.empty((SHARES, places.size)), np.linspace(0.0, 1.0, SHARES)
    for row, zeta in zip(found, root**2, strict=True):
        taut = 1.0 - zeta  # T with T + EI/h^2 = 1
        K = taut * one.T @ one + (zeta + taut * correction / 12.0) * two.T @ two
        K = K + (zeta * SMOOTH + taut * SHORT / 24.0) * three.T @ three
        chain = (inner * linalg.solve(K, inner.T, assume_a="pos").T).sum(axis=1)
        row[:] = _exact(places, taut, zeta) - chain
        limit = part * row[(NEAR - 1) * PARTS :].mean()
        row[:] = np.where(row < limit, 0.5 * limit * (1.0 + (row / limit) ** 2), row)
    firm = CubicSpline(root, 1.0 / np.maximum(found, LEAST))
    return np.array([firm(root), firm.derivative()(root)])


def _exact(x: Array, taut: float, bending: float) -> Array:
    """Displacement under a unit force of a taut beam of CELL links, which is held at its ends."""
    L = float(CELL)
    if bending == 0.0:
        return x * (L - x) / (L * taut)
    if taut < 1e-6:  # the difference of two large parts
        beam: Array = x**2 * (L - x) ** 2 / (3.0 * bending * L)
        return beam
    reach = np.sqrt(bending / taut)
    a, b, c = (1.0 - np.exp(-2.0 * d / reach) for d in (x, L - x, L))
    return np.asarray((x * (L - x) / L - 0.5 * reach * a * b / c) / taut)


@lean_inner
def _at_root(table, i, j, g):
    """kappa and its first two derivatives with sqrt(zeta) at place i, a part g of the way from value j to the next."""
    h = 1.0 / (SHARES - 1)
    s0, s1, d0, d1 = table[0, j, i], table[0, j + 1, i], h * table[1, j, i], h * table[1, j + 1, i]
    c2, c3 = 3.0 * (s1 - s0) - 2.0 * d0 - d1, 2.0 * (s0 - s1) + d0 + d1
    firm = s0 + g * (d0 + g * (c2 + g * c3))
    first, second = (d0 + g * (2.0 * c2 + 3.0 * g * c3)) / h, (2.0 * c2 + 6.0 * g * c3) / (h * h)
    kappa = 1.0 / firm
    return kappa, -first * kappa**2, (2.0 * first**2 * kappa - second) * kappa**2


@lean
def compliance(x, n, root, table, out):
    """kappa at x links along a run of n links, its changes with sqrt(zeta) and with x, and the second with the former.

    Between two places it is the cubic that has the slopes of their neighbours: what passes along feels its second
    change with the place.

    Args:
        root: sqrt(zeta).
        table: see `compliances`.
        out: (4,), overwritten.
    """
    y, side = (x, 1.0) if x <= 0.5 * n else (n - x, -1.0)
    if y > NEAR - 1:  # from there on it is the same in all links
        y = NEAR - 1 + (y - np.floor(y))
    p, q = max(y, 0.0) * PARTS, min(max(root, 0.0), 1.0) * (SHARES - 1)
    i, j = min(int(p), NEAR * PARTS - 1), min(int(q), SHARES - 2)
    f, g = p - i, q - j
    before, after = max(i - 1, 0), i + 2 if i + 2 <= NEAR * PARTS else (NEAR - 1) * PARTS + 1
    a, b, c, d = (
        -0.5 * f * (1.0 - f) ** 2,
        1.0 + f * f * (1.5 * f - 2.5),
        f * (0.5 + f * (2.0 - 1.5 * f)),
        -0.5 * f * f * (1.0 - f),
    )
    kappa0, first0, second0 = _at_root(table, before, j, g)
    kappa1, first1, second1 = _at_root(table, i, j, g)
    kappa2, first2, second2 = _at_root(table, i + 1, j, g)
    kappa3, first3, second3 = _at_root(table, after, j, g)
    out[0] = a * kappa0 + b * kappa1 + c * kappa2 + d * kappa3
    out[1] = a * first0 + b * first1 + c * first2 + d * first3
    out[3] = a * second0 + b * second1 + c * second2 + d * second3
    a, b = -0.5 + f * (2.0 - 1.5 * f), f * (4.5 * f - 5.0)
    c, d = 0.5 + f * (4.0 - 4.5 * f), f * (1.5 * f - 1.0)
    out[2] = side * PARTS * (a * kappa0 + b * kappa1 + c * kappa2 + d * kappa3)


@lean
def kinetic(square, table):
    """Factor of kappa at a square of alpha, see KINETIC, and its change with that."""
    i, last = 0, table.shape[1] - 2
    while i < last and square > table[0, i + 1]:
        i += 1
    slope = (table[1, i + 1] - table[1, i]) / (table[0, i + 1] - table[0, i])
    return table[1, i] + slope * (min(square, table[0, i + 1]) - table[0, i]), slope


@lean_inner
def stiffness(whole, bending, h, n, factor, x, free, again, table, out):
    """S = 1/(h kappa/whole + free), its change with the tension, the part of it that is not `free`, and its curvature.

    In compression it goes on in a straight line.

    Args:
        whole: N, tension and EI/h^2.
        bending: N, EI/h^2.
        h: m.
        n: links of the run.
        factor: of kappa in tension, of a kink that is carried along.
        x: links along it.
        free: m/N, what else gives way.
        again: more than 0: `out` is that of this place, which is what it was where nothing bends.
        table, out: see `compliance`; out is left as it was at x.
    """
    zeta, straight = 0.0, bending > 0.0 and whole <= bending
    if bending > 0.0:
        zeta = 1.0 if straight else bending / whole
    root = np.sqrt(zeta)
    if bending > 0.0 or again == 0:
        compliance(x, n, root, table, out)
    kappa = max(out[0], LEAST)
    first, second = -out[1] / kappa**2, (2.0 * out[1] ** 2 / kappa - out[3]) / kappa**2  # of 1/kappa
    moving = kappa * (1.0 + (1.0 - zeta) * (factor - 1.0))
    slope = (1.0 - 0.5 * root * first * kappa) / (h * moving)
    S, curve = whole / (h * moving), 0.0
    if straight:
        S = bending / (h * moving) + (whole - bending) * slope
    elif zeta > 0.0:
        curve = -0.25 * root * (first - root * second) / (whole * h)
    taken = 1.0
    if S > 0.0:
        taken = 1.0 / (1.0 + free * S)
    curve = (curve - 2.0 * free * slope**2 * taken) * taken * taken
    return S * taken, slope * taken * taken, taken, curve
