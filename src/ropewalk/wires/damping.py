"""What wires lose to Rayleigh damping: drag takes alpha m v^2, retardation beta v K v.

Retardation acts with the velocity of half a step ago, so what it takes is its product with the mean of the velocities
before and after: where waves are hardly resolved in time the two differ.
"""

from __future__ import annotations

from ropewalk.mechanics.compiled import summing

EVERY = 16
"""Steps of the wires, after which it is looked at again: what is lost in them changes slowly."""


@summing
def dissipated(now, after, felt, part, mass, drag, late, t, b, bed, first, last):
    """What a wire loses in a step, times its length, J s.

    Args:
        now, after: (node,) m, one component at the beginning of the step and at its end.
        felt: (node,) m, such that part * (felt - now) is how far nodes came in the step before.
        mass: (node,) kg.
        drag: 1/s.
        late: s, retardation.
        t, b, bed: N/m, stiffness against differences, second differences and displacements of nodes.
        first, last: whether the wire is clamped at its first node, and at its last.
    """
    n, lost, total = now.size, 0.0, 0.0
    if drag > 0.0:
        for i in range(n):
            d = (after[i] - now[i]) + part * (felt[i] - now[i])
            total += mass[i] * d * d
        lost += 0.25 * drag * total
    if late == 0.0:
        return lost
    u, v, w = now[1:], after[1:], felt[1:]  # slices let the loop vectorise
    x, y, z = now[2:], after[2:], felt[2:]
    total, bent = 0.0, 0.0
    for i in range(n - 2):
        d, e, f = part * (felt[i] - now[i]), part * (w[i] - u[i]), part * (z[i] - x[i])
        D, E, F = d + (after[i] - now[i]), e + (v[i] - u[i]), f + (y[i] - x[i])
        total += (e - d) * (E - D)
        bent += (d - 2.0 * e + f) * (D - 2.0 * E + F)
    d, e = part * (felt[n - 2] - now[n - 2]), part * (felt[n - 1] - now[n - 1])
    total += (e - d) * ((e - d) + (after[n - 1] - now[n - 1]) - (after[n - 2] - now[n - 2]))
    lost += 0.5 * late * (t * total + b * bent)
    if bed > 0.0:
        total = 0.0
        for i in range(n):
            d = part * (felt[i] - now[i])
            total += d * (d + after[i] - now[i])
        lost += 0.5 * late * bed * total  # held ends do not move
    for clamped, e, i in ((first, 0, 1), (last, n - 1, n - 2)):
        if clamped:
            d = part * ((felt[i] - now[i]) - (felt[e] - now[e]))
            lost += late * b * d * (d + (after[i] - now[i]) - (after[e] - now[e]))
    return lost
