"""One step of the Radau IIA method of order 5 for one strand: its stages and Newton's method on them.

Source: Hairer & Wanner, Solving Ordinary Differential Equations II, section IV.8. With D the inverse of the
Runge-Kutta matrix A, and Z the positions of the three stages beyond those at the start of the step, all rates follow
from Z: node velocities v = D Z / dt, velocities of the material w = v less what a moving load owes to its travel, and
accelerations (D w - (D 1) w_0) / dt. What is left is one balance of forces for each stage, with the Jacobian

    D^2/dt^2 (x) M  +  D/dt (x) C  +  1 (x) K,     M = rho h,  K = -df/dr,  C = -df/dv,

which the eigenvectors T of D split into one real and one complex system (mu^2 M + mu C + K) x = b with mu = eigenvalue
/ dt: block-tridiagonal, as large as one static problem each. The travel of the loads (X, xi, U at the stages) is
improved by fixed-point iteration between the Newton steps.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics.chain import (
    LINE_DAMPING,
    LOAD_WORK,
    MATERIAL,
    OFF,
    SHARED,
    STAY,
    Array,
    ChainBuffers,
    ChainState,
    Integers,
)
from ropewalk.mechanics.compiled import inner, kernel
from ropewalk.mechanics.link import link_force, pull, stretch
from ropewalk.mechanics.moving_contact import (
    force_at,
    has_arrived,
    link_of,
    look_up_integral,
    material_speed,
    part_of,
    slope,
    speed_at,
)
from ropewalk.solve.banded import substitute
from ropewalk.solve.jacobian import shifted
from ropewalk.solve.splitting import strain_rates
from ropewalk.solve.stages import RADAU

A, D = RADAU.A, RADAU.D
D_SUM = D.sum(axis=1)
# Weights of the embedded error estimate: dt times the derivative at the start less that of the collocation polynomial.
E = -RADAU.controller


def _modes() -> tuple[float, complex, NDArray[np.float64], NDArray[np.float64]]:
    """Real eigenvalue, complex eigenvalue a + ib, and T with T^-1 D T = diag(real, [[a, -b], [b, a]]), T^-1."""
    values, vectors = np.linalg.eig(D)
    i = int(np.argmin(np.abs(values.imag)))
    j = int(np.argmax(values.imag))
    real, pair = vectors[:, i].real, vectors[:, j]
    T = np.ascontiguousarray(np.column_stack([real / real[2], pair.real, -pair.imag]))
    return float(values[i].real), complex(values[j]), T, np.linalg.inv(T)


REAL, PAIR, T, T_INVERSE = _modes()

MOST_ITERATIONS = 10

# Entries of `counts`: Newton iterations, Jacobians, factorisations, steps that were taken back (all strands together).
ITERATIONS, JACOBIANS, FACTORS, REJECTIONS = 0, 1, 2, 3


class Workspace(NamedTuple):
    """Room for a step and what one step leaves to the next, so that the loop allocates nothing."""

    locations: ChainBuffers
    Z: Array  # (stage, axis, node) m, positions of the stages beyond those at the start
    last: Array  # the same of the last step taken
    r: Array  # (stage, axis, node) m
    w: Array  # (stage, axis, node) m/s, of the material
    g: Array  # (stage, axis, node) N, unbalanced forces
    X: Array  # (stage, node) m
    t: Array  # (stage, 1) s
    xi: Array  # (stage, load) m
    speed: Array  # (stage, load) m/s
    way: Array  # (stage, load) m, xi of the stages beyond that at the start
    step_ratio: Array  # (load,) mean speed over a step, per speed at its start: what the last attempt saw
    square: Array  # (stage,) 1/s^2, sum of eps_t^2 over the links of a strand
    q: Array  # (link,) N/m
    v: Array  # (axis, node) m/s, node velocities at the start
    f: Array  # (axis, node) N, unbalanced forces at the start
    error: Array  # (node, axis) m, embedded error estimate
    stiff: Array  # (part, node, axis, axis) N/m: blocks on, above and below the diagonal, entry = node on their left
    damp: Array  # (part, node, axis, axis) N s/m
    real: Array  # (part, node, axis, axis): diagonal, above, below, inverse, ratio of the real system
    pair: NDArray[np.complex128]  # the same of the complex one
    x: Array  # (node, axis)
    y: NDArray[np.complex128]  # (node, axis)
    location: Integers  # (load,) moving loads in the last step
    memory: Array  # (4,) see radau.py
    counts: Integers  # (4,) how often so far: ITERATIONS ... REJECTIONS

    @staticmethod
    def for_state(state: ChainState) -> Workspace:
        """A workspace of the right size, without memory."""
        dim, nodes, loads = *state.r.shape, state.xi.size
        stages, blocks = np.zeros((3, dim, nodes)), np.zeros((3, nodes, dim, dim))
        factors = np.zeros((5, nodes, dim, dim))
        per_load, plane = np.zeros((3, loads)), np.zeros((dim, nodes))
        return Workspace(
            locations=ChainBuffers.for_state(state),
            Z=stages.copy(), last=stages.copy(), r=stages.copy(), w=stages.copy(), g=stages.copy(),
            X=np.zeros((3, nodes)), t=np.zeros((3, 1)),
            xi=per_load.copy(), speed=per_load.copy(), way=per_load.copy(), step_ratio=np.ones(loads),
            square=np.zeros(3),
            q=np.zeros(nodes), v=plane.copy(), f=plane.copy(), error=np.zeros((nodes, dim)),
            stiff=blocks.copy(), damp=blocks.copy(), real=factors.copy(), pair=factors.astype(np.complex128),
            x=np.zeros((nodes, dim)), y=np.zeros((nodes, dim), dtype=np.complex128),
            location=np.full(loads, OFF), memory=np.zeros(4), counts=np.zeros(4, dtype=np.int64),
        )  # fmt: skip


@inner
def stage_of(state, space, j):
    """The state at stage j."""
    return ChainState(
        space.t[j],
        space.r[j],
        space.w[j],
        space.X[j],
        space.xi[j],
        space.speed[j],
        state.moving_load,
        state.hold,
        state.work,
    )


@inner
def _add_forces_beside(p, c, h, r, w, X, moving_load, speed, q, b):
    """Tension over length of the two links beside the riding node b, whose unstrained lengths are not h.

    Returns:
        What the damping of these two links adds to the sum of eps_t^2 over uniform links.
    """
    more = 0.0
    first = b - 1
    for k in range(moving_load.size):
        if moving_load[k] == b - 1:  # the link behind is the one ahead of another load, which looks after it
            first = b
    for i in range(first, b + 1):
        rest, rate = X[i + 1] - X[i], 0.0
        if c > 0.0:
            rate, uniform = strain_rates(r, w, X, moving_load, speed, i, stretch(r, i), h)
            more += rate * rate * rest / h - uniform * uniform
        q[i] = link_force(p, c, rest, rate, r, i)
    return more


@kernel
def balance(strands, loads, state, q, s, out):
    """Forces of links, loads, weight, drag and momentum flux on the inner nodes of strand s.

    Args:
        state: positions, velocities and travel at one instant.
        q: (link,) overwritten with tension over length.
        out: (axis, node) N, overwritten between the ends of the strand.

    Returns:
        Sum of eps_t^2 over uniform links of length h that dissipate as much as the links of the strand.
    """
    i0, i1, c, h = strands.first[s], strands.first[s] + strands.links[s], strands.damping[s], strands.h[s]
    p, m, drag = strands.law[s], strands.rho[s] * strands.h[s], strands.drag[s] * strands.rho[s] * strands.h[s]
    r, w, X, moving_load, speed, t, g = (
        state.r,
        state.w,
        state.X,
        state.moving_load,
        state.speed,
        state.t[0],
        strands.gravity,
    )
    square = pull(p, c, h, i0, i1, r, w, q)
    for k in range(moving_load.size):
        if i0 < moving_load[k] < i1:
            square += _add_forces_beside(p, c, h, r, w, X, moving_load, speed, q, moving_load[k])
    n = i1 - i0
    for a in range(r.shape[0]):
        x, u, qa, total, weight = r[a, i0 : i1 + 1], w[a, i0 : i1 + 1], q[i0:i1], out[a, i0 : i1 + 1], m * g[a]
        for i in range(1, n):
            total[i] = qa[i] * (x[i + 1] - x[i]) - qa[i - 1] * (x[i] - x[i - 1]) + (weight - drag * u[i])
    for k in range(moving_load.size):
        b = moving_load[k]
        if loads.strand[k] != s or b == OFF:
            continue
        if b >= 0:
            flux = m * speed[k] / (X[b + 1] - X[b - 1])
            for a in range(r.shape[0]):
                out[a, b] += force_at(loads, k, t, a) + flux * (w[a, b + 1] - w[a, b - 1])
                # The neighbours carry half the links that they really have, see _shift_weight in splitting.py.
                out[a, b - 1] += 0.5 * m * g[a] * ((X[b] - X[b - 1]) / h - 1.0)
                out[a, b + 1] += 0.5 * m * g[a] * ((X[b + 1] - X[b]) / h - 1.0)
        else:
            i = link_of(strands, loads, state, k)
            part = part_of(state, k, i)
            for a in range(r.shape[0]):
                F = force_at(loads, k, t, a)
                out[a, i] += (1.0 - part) * F
                out[a, i + 1] += part * F
    return square


@inner
def _patch(state, space, k, inverse_dt):
    """Velocities of the material at the node that rides with load k, from its positions at the stages."""
    b = state.moving_load[k]
    for j in range(3):
        for a in range(state.r.shape[0]):
            v = inverse_dt * (D[j, 0] * space.Z[0, a, b] + D[j, 1] * space.Z[1, a, b] + D[j, 2] * space.Z[2, a, b])
            space.w[j, a, b] = v - space.speed[j, k] * slope(space.r[j], space.X[j], b, a)


@inner
def _travel(strands, loads, state, space, k, dt):
    """Improve the travel of load k at the stages, and carry its node along.

    Returns:
        The largest change of xi at a stage, m.
    """
    b, t, xi = state.moving_load[k], state.t[0], state.xi[k]
    if loads.measure[k] == MATERIAL:
        first, count = loads.speed_first[k], loads.speed_count[k]
        begin = look_up_integral(loads.speed_time, loads.speed_value, loads.speed_path, first, count, t)
        for j in range(3):
            U, when = speed_at(loads, k, space.t[j, 0]), space.t[j, 0]
            way = look_up_integral(loads.speed_time, loads.speed_value, loads.speed_path, first, count, when) - begin
            if loads.at_end[k] == STAY and has_arrived(strands, loads, k, xi, way):
                way, U = 0.0, 0.0
            space.speed[j, k], space.way[j, k] = U, way
    else:
        for j in range(3):
            # Not yet into `speed`: that of this stage is still needed to read the velocities of the material.
            V = speed_at(loads, k, space.t[j, 0])
            space.way[j, k] = material_speed(strands, loads, stage_of(state, space, j), k, V)
        for j in range(3):
            space.speed[j, k] = space.way[j, k]
        for j in range(3):
            space.way[j, k] = dt * (
                A[j, 0] * space.speed[0, k] + A[j, 1] * space.speed[1, k] + A[j, 2] * space.speed[2, k]
            )
    moved = 0.0
    for j in range(3):
        shift = xi + space.way[j, k] - space.xi[j, k]
        space.xi[j, k] += shift
        moved = max(moved, abs(shift))
        if b >= 0:
            space.X[j, b] = space.xi[j, k]
            for a in range(state.r.shape[0]):
                carried = shift * slope(space.r[j], space.X[j], b, a)
                space.Z[j, a, b] += carried
                space.r[j, a, b] += carried
    if b >= 0:
        _patch(state, space, k, 1.0 / dt)
    return moved


@inner
def evaluate(strands, loads, state, space, s, dt):
    """Positions, velocities, travel and unbalanced forces (space.g) of all stages of strand s from space.Z.

    Returns:
        The largest change of a load's xi, m.
    """
    i0, i1, m = strands.first[s], strands.first[s] + strands.links[s], strands.rho[s] * strands.h[s]
    n, per = i1 - i0 + 1, 1.0 / dt
    for a in range(state.r.shape[0]):
        z1, z2, z3 = space.Z[0, a, i0 : i1 + 1], space.Z[1, a, i0 : i1 + 1], space.Z[2, a, i0 : i1 + 1]
        base = state.r[a, i0 : i1 + 1]
        for j in range(3):
            z, r, w = space.Z[j, a, i0 : i1 + 1], space.r[j, a, i0 : i1 + 1], space.w[j, a, i0 : i1 + 1]
            for i in range(n):
                r[i] = base[i] + z[i]
            d1, d2, d3 = per * D[j, 0], per * D[j, 1], per * D[j, 2]
            for i in range(n):
                w[i] = d1 * z1[i] + d2 * z2[i] + d3 * z3[i]
    moved = 0.0
    for k in range(state.xi.size):
        if loads.strand[k] == s and state.moving_load[k] >= 0:
            _patch(state, space, k, per)
    for k in range(state.xi.size):
        if loads.strand[k] == s and state.moving_load[k] != OFF:
            moved = max(moved, _travel(strands, loads, state, space, k, dt))
    for j in range(3):
        space.square[j] = balance(strands, loads, stage_of(state, space, j), space.q, s, space.g[j])
        d1, d2, d3, d0 = m * per * D[j, 0], m * per * D[j, 1], m * per * D[j, 2], m * per * D_SUM[j]
        for a in range(state.r.shape[0]):
            w1, w2, w3 = space.w[0, a, i0 : i1 + 1], space.w[1, a, i0 : i1 + 1], space.w[2, a, i0 : i1 + 1]
            w0, g = state.w[a, i0 : i1 + 1], space.g[j, a, i0 : i1 + 1]
            for i in range(1, n - 1):
                g[i] -= d1 * w1[i] + d2 * w2[i] + d3 * w3[i] - d0 * w0[i]
    return moved


@inner
def prepare(strands, space, s, dt):
    """Factorise both systems of strand s for steps of length dt; False if one is singular."""
    i0, i1, m = strands.first[s], strands.first[s] + strands.links[s], strands.rho[s] * strands.h[s]
    if i1 - i0 < 2:
        return True
    fine = shifted(REAL / dt, m, i0, i1, space.stiff, space.damp, space.real)
    return fine and shifted(PAIR / dt, m, i0, i1, space.stiff, space.damp, space.pair)


@inner
def _correct(space, i0, i1):
    """One Newton step: solve for space.g, change space.Z; returns the largest change, m."""
    dim, low, high, largest = space.Z.shape[1], i0 + 1, i1, 0.0
    for a in range(dim):
        for i in range(low, high):
            g1, g2, g3 = space.g[0, a, i], space.g[1, a, i], space.g[2, a, i]
            space.x[i, a] = T_INVERSE[0, 0] * g1 + T_INVERSE[0, 1] * g2 + T_INVERSE[0, 2] * g3
            space.y[i, a] = complex(
                T_INVERSE[1, 0] * g1 + T_INVERSE[1, 1] * g2 + T_INVERSE[1, 2] * g3,
                T_INVERSE[2, 0] * g1 + T_INVERSE[2, 1] * g2 + T_INVERSE[2, 2] * g3,
            )
    real, pair = space.real, space.pair
    substitute(real[1, low:high], real[3, low:high], real[4, low:high], space.x[low:high])
    substitute(pair[1, low:high], pair[3, low:high], pair[4, low:high], space.y[low:high])
    for a in range(dim):
        for i in range(low, high):
            x1, x2, x3 = space.x[i, a], space.y[i, a].real, space.y[i, a].imag
            d1 = T[0, 0] * x1 + T[0, 1] * x2 + T[0, 2] * x3
            d2 = T[1, 0] * x1 + T[1, 1] * x2 + T[1, 2] * x3
            d3 = T[2, 0] * x1 + T[2, 1] * x2 + T[2, 2] * x3
            space.Z[0, a, i] += d1
            space.Z[1, a, i] += d2
            space.Z[2, a, i] += d3
            change = max(abs(d1), abs(d2), abs(d3))
            if not change <= largest:  # lets what is not a number through
                largest = change
    return largest


@inner
def _newton(strands, loads, state, space, s, dt, enough):
    """Solve the stages of strand s; returns as `newton`."""
    i0, i1 = strands.first[s], strands.first[s] + strands.links[s]
    before, theta, done, iteration = 0.0, 0.0, False, 0
    while True:
        moved = evaluate(strands, loads, state, space, s, dt)
        if done:
            return iteration, theta
        if iteration == MOST_ITERATIONS:
            return 0, theta
        iteration += 1
        space.counts[ITERATIONS] += 1
        # The travel follows the positions of the iteration before: it does not tell how this one contracts.
        change = _correct(space, i0, i1) if i1 - i0 > 1 else moved
        if not np.isfinite(change):
            return 0, np.inf
        if iteration == 1:
            done = change <= 1e-3 * enough
        else:
            theta = change / before if before > 0.0 else 0.0
            done = change <= enough if theta >= 1.0 else change * theta <= enough * (1.0 - theta)
            hopeless = theta >= 1.0 or theta ** (MOST_ITERATIONS - iteration) * change > enough * (1.0 - theta)
            if hopeless and not done:
                return 0, theta
        before = change


@inner
def newton(strands, loads, state, space, dt, enough):
    """Solve the stages of all strands by simplified Newton iteration until the error left is below `enough` (m).

    Leaves everything evaluated at the solution.

    Returns:
        The most iterations of a strand, 0 if one does not converge; and the slowest contraction.
    """
    most, slowest = 1, 0.0
    for s in range(strands.first.size):
        iterations, theta = _newton(strands, loads, state, space, s, dt, enough)
        most, slowest = max(most, iterations), max(slowest, theta)
        if iterations == 0:
            return 0, slowest
    return most, slowest


@inner
def estimate(strands, state, space, s, dt):
    """Embedded error estimate of strand s: positions into space.error (m); returns the largest one over its nodes.

    Velocities count with the length of the step: as the positions that they would lead to.
    """
    i0, i1, m = strands.first[s], strands.first[s] + strands.links[s], strands.rho[s] * strands.h[s]
    low, high, mu, per, dim = i0 + 1, i1, REAL / dt, 1.0 / dt, state.r.shape[0]
    if high == low:
        return 0.0
    v, x, on, above, below = space.error, space.x, space.damp[0], space.damp[1], space.damp[2]
    for a in range(dim):
        for i in range(i0, i1 + 1):
            z1, z2, z3 = space.Z[0, a, i], space.Z[1, a, i], space.Z[2, a, i]
            v[i, a] = space.v[a, i] + per * (E[0] * z1 + E[1] * z2 + E[2] * z3)
    for i in range(low, high):
        for a in range(dim):
            w1, w2, w3 = space.w[0, a, i], space.w[1, a, i], space.w[2, a, i]
            total = space.f[a, i] + m * per * (E[0] * w1 + E[1] * w2 + E[2] * w3 - (E[0] + E[1] + E[2]) * state.w[a, i])
            total += mu * m * v[i, a]
            for b in range(dim):
                total += on[i, a, b] * v[i, b] + above[i, a, b] * v[i + 1, b] + below[i - 1, a, b] * v[i - 1, b]
            x[i, a] = total
    real = space.real
    substitute(real[1, low:high], real[3, low:high], real[4, low:high], x[low:high])
    largest = 0.0
    for i in range(low, high):
        square = 0.0
        for a in range(dim):
            rate = REAL * x[i, a] - dt * v[i, a]
            square = max(square, x[i, a] * x[i, a], rate * rate)
        if not square <= largest:
            largest = square
    for i in range(low, high):
        for a in range(dim):
            v[i, a] = x[i, a]
    return np.sqrt(largest)


@inner
def settle_accounts(strands, loads, state, space, s, dt):
    """Work done on strand s and lost in it in a step, by the quadrature of the method."""
    i0, i1, m = strands.first[s], strands.first[s] + strands.links[s], strands.rho[s] * strands.h[s]
    for j in range(3):
        weight = dt * A[2, j]
        now = stage_of(state, space, j)
        lost = strands.damping[s] * strands.h[s] * space.square[j]
        if strands.drag[s] > 0.0:
            total = 0.0
            for a in range(state.r.shape[0]):
                for i in range(i0 + 1, i1):
                    total += now.w[a, i] * now.w[a, i]
            lost += strands.drag[s] * m * total
        state.work[LINE_DAMPING] += weight * lost
        for k in range(state.xi.size):
            b, U = state.moving_load[k], now.speed[k]
            if loads.strand[k] != s or b == OFF:
                continue
            i, part = b, 0.0
            if b == SHARED:
                i = link_of(strands, loads, now, k)
                part = part_of(now, k, i)
            for a in range(state.r.shape[0]):
                if b >= 0:
                    v = now.w[a, b] + U * slope(now.r, now.X, b, a)
                else:
                    tangent = (now.r[a, i + 1] - now.r[a, i]) / (now.X[i + 1] - now.X[i])
                    v = (1.0 - part) * now.w[a, i] + part * now.w[a, i + 1] + U * tangent
                state.work[LOAD_WORK] += weight * force_at(loads, k, now.t[0], a) * v
