"""Bodies: coordinates with masses, dampers and springs between them, which stand on the line at their contacts.

    M u'' + C u' + K u = force - N,   u = (places of contacts, coordinates).

A contact without mass has no equation of motion: there the springs above are in balance with the line below.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import lean_inner
from ropewalk.system.contacts import AWAY, ON, stiffen
from ropewalk.system.structure import IN_BODIES, STRUCK

# Rounds of Newton's method for contacts without mass, and the part of a link to which their places are found.
ROUNDS, SETTLED = 40, 1e-11


class Bodies(NamedTuple):
    """All of them; a part is a set of coordinates that springs, dampers or a mass matrix join."""

    mass: Array  # (coordinate,) kg, where it is lumped
    per_mass: Array  # (coordinate,) 1/kg, about what a force on it accelerates; 0: without mass
    force: Array  # (coordinate,) N, weights
    contact: Integers  # (coordinate,) the contact whose place it is, -1: none
    axis: Integers  # (coordinate,)
    alone: Integers  # (coordinate,) 1: it belongs to no part
    size: Integers  # (part,) number of coordinates
    at: Integers  # (part, size)
    M: Array  # (part, size, size) kg, with lumped masses
    C: Array  # N s/m
    K: Array  # N/m
    inverse: Array  # (2, part, size, size) 1/kg, of M + h/2 C for kicks of the length h: a step, and half a step
    weightless: Integers  # (part,) number of its coordinates that have no mass
    A: Array  # (size, size) room
    b: Array  # (size,)
    f: Array  # (coordinate,) N
    old: Array  # (coordinate,) m


def with_step(bodies: Bodies, dt: float) -> Bodies:
    """The same for steps of a given length in s."""
    inverse = np.zeros_like(bodies.inverse)
    for i, h in enumerate((dt, 0.5 * dt)):
        for p, n in enumerate(bodies.size):
            heavy = np.flatnonzero(np.diag(bodies.M[p])[:n] > 0.0)
            own = (bodies.M[p] + 0.5 * h * bodies.C[p])[np.ix_(heavy, heavy)]
            inverse[i, p][np.ix_(heavy, heavy)] = np.linalg.inv(own)
    return bodies._replace(inverse=inverse)


@lean_inner
def _solve(A, b, n):
    """Solve A x = b in place, by elimination with pivoting."""
    for c in range(n):
        pivot = c
        for i in range(c + 1, n):
            if abs(A[i, c]) > abs(A[pivot, c]):
                pivot = i
        if pivot != c:
            for j in range(c, n):
                A[c, j], A[pivot, j] = A[pivot, j], A[c, j]
            b[c], b[pivot] = b[pivot], b[c]
        for i in range(c + 1, n):
            factor = A[i, c] / A[c, c]
            for j in range(c, n):
                A[i, j] -= factor * A[c, j]
            b[i] -= factor * b[c]
    for c in range(n - 1, -1, -1):
        for j in range(c + 1, n):
            b[c] -= A[c, j] * b[j]
        b[c] /= A[c, c]


@lean_inner
def balance(structure, room, contacts, bodies, state, table, out, since):
    """Put coordinates without mass where springs above and the line below are in balance, by Newton's method.

    Args:
        since: s, since this was done before; 0: nothing has moved since, and velocities are known.
    """
    A, b, rate = bodies.A, bodies.b, 1.0 / since if since > 0.0 else 0.0
    for c in range(bodies.mass.size):
        if bodies.alone[c] == 1 and bodies.per_mass[c] == 0.0 and contacts[bodies.contact[c]].state == ON:
            state.u[c] = contacts[bodies.contact[c]].p[bodies.axis[c]]  # nothing above moves or holds it
    for p in range(bodies.size.size):
        if bodies.weightless[p] == 0:
            continue
        n = bodies.size[p]
        for i in range(n):
            bodies.old[bodies.at[p, i]] = state.u[bodies.at[p, i]]
        for _ in range(ROUNDS):
            for i in range(n):
                c = bodies.at[p, i]
                k, a = bodies.contact[c], bodies.axis[c]
                for j in range(n):
                    A[i, j] = 0.0
                if bodies.per_mass[c] > 0.0 or (k >= 0 and contacts[k].state == AWAY):
                    A[i, i], b[i] = 1.0, state.u[c]
                    continue
                b[i] = bodies.force[c] + (contacts[k].given[a] if k >= 0 else 0.0)
                for j in range(n):
                    d = bodies.at[p, j]
                    A[i, j] = bodies.K[p, i, j]
                    if bodies.per_mass[d] > 0.0 or rate == 0.0:
                        b[i] -= bodies.C[p, i, j] * state.w[d]
                    else:
                        A[i, j] += bodies.C[p, i, j] * rate
                        b[i] += bodies.C[p, i, j] * rate * bodies.old[d]
                if k >= 0:
                    stiffen(structure, room, contacts, state, table, out, k)
                    for j in range(n):  # N changes by S and by the tension that the kink makes
                        d = bodies.at[p, j]
                        if bodies.contact[d] == k:
                            stiff = contacts[k].rise * contacts[k].d[a] * contacts[k].d[bodies.axis[d]]
                            stiff += contacts[k].moving if d == c else 0.0
                            A[i, j] += stiff
                            b[i] += stiff * state.u[d]
                    b[i] -= contacts[k].moving * contacts[k].d[a]
            _solve(A, b, n)
            most = 0.0
            for i in range(n):
                c = bodies.at[p, i]
                k = bodies.contact[c]
                if bodies.per_mass[c] == 0.0:
                    if k >= 0 and contacts[k].state == ON:
                        most = max(most, abs(b[i] - state.u[c]) / structure.runs.h[contacts[k].run])
                    state.u[c] = b[i]
            if most < SETTLED:
                break
        for i in range(n):
            c = bodies.at[p, i]
            if bodies.per_mass[c] == 0.0 and rate > 0.0:
                state.w[c] = (state.u[c] - bodies.old[c]) * rate


@lean_inner
def kick(contacts, bodies, state, h, half):
    """Kick all bodies for the time h.

    Args:
        half: 1 for half a step, 0 for a whole one.
    """
    f, u, w = bodies.f, state.u, state.w
    for c in range(f.size):
        k = bodies.contact[c]
        f[c] = bodies.force[c]
        if k >= 0:
            f[c] += contacts[k].given[bodies.axis[c]] - contacts[k].N[bodies.axis[c]]
    for p in range(bodies.size.size):
        n, lost = bodies.size[p], 0.0
        for i in range(n):
            c = bodies.at[p, i]
            for j in range(n):
                d = bodies.at[p, j]
                f[c] -= bodies.K[p, i, j] * u[d] + bodies.C[p, i, j] * w[d]
        for i in range(n):
            gain = 0.0
            for j in range(n):
                gain += bodies.inverse[half, p, i, j] * f[bodies.at[p, j]]
            bodies.b[i] = h * gain
        for i in range(n):
            c = bodies.at[p, i]
            for j in range(n):
                d = bodies.at[p, j]
                lost += (w[c] + 0.5 * bodies.b[i]) * bodies.C[p, i, j] * (w[d] + 0.5 * bodies.b[j])
        for i in range(n):
            w[bodies.at[p, i]] += bodies.b[i]
        state.work[IN_BODIES] += h * lost
    for c in range(f.size):
        if bodies.alone[c] == 1:
            w[c] += h * f[c] * bodies.per_mass[c]
        k = bodies.contact[c]
        if k >= 0 and contacts[k].state == AWAY:  # on level ground
            state.work[STRUCK] += 0.5 * bodies.mass[c] * w[c] * w[c]
            w[c] = 0.0


@lean_inner
def drift(bodies, state, h):
    """Move all bodies for the time h."""
    for c in range(state.u.size):
        if bodies.per_mass[c] > 0.0:
            state.u[c] += h * state.w[c]
