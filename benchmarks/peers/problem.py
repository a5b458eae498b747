"""The rope that every peer solves: parameters, rest shape, right-hand sides and Jacobian.

A chain of ``n`` massless links with masses ``rho h`` at the inner nodes; a vertical force runs along it with
a constant material speed and is shared linearly between the two nodes of the link it stands on (hat
functions), because that is what a user of a general package does. Unknowns are interleaved node by node,
``(x, z, vx, vz)`` of inner node 1, 2, ..., which keeps the Jacobian within seven diagonals of the main one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_matrix

Array = NDArray[np.float64]
RightHandSide = Callable[[float, Array], Array]

# Half-widths of the Jacobian in the interleaved order: vz of a node depends on x of its left neighbour (7 below),
# vx of a node on z (3 above) or, with damping, on vz (5 above) of its right neighbour.
BAND_BELOW, BAND_ABOVE = 7, 5


@dataclass(frozen=True)
class Rope:
    """Slack rope between two fixed supports under a moving force; SI units, x along the span, z up."""

    n: int = 200
    damping: float = 0.0  # N s: T = EA eps + damping * eps_t
    length: float = 20.0
    span: float = 19.5
    mass: float = 1.0  # kg/m
    stiffness: float = 1e5  # EA in N
    gravity: float = 9.81
    force: float = -800.0  # N, along z
    speed: float = 10.0  # m/s, measured along the unstrained rope
    until: float = 1.9
    tension_only: bool = False  # True: no elastic force in a shortened link (cable programs)

    @property
    def h(self) -> float:
        """Unstrained length of a link in m."""
        return self.length / self.n

    @property
    def node_mass(self) -> float:
        """Lumped mass of an inner node in kg."""
        return self.mass * self.h

    @property
    def passage(self) -> float:
        """Time in s that the force needs from node to node; fixed steps should divide it."""
        return self.h / self.speed


def output_times(rope: Rope, every: float = 0.02) -> Array:
    """Times at which positions are compared: every 20 ms, which are passages of nodes for 100, 200 and 800
    links.
    """
    return every * np.arange(int(rope.until / every + 1e-9) + 1)


def passage_times(rope: Rope, start: float = 0.0, end: float | None = None) -> Array:
    """Times strictly between ``start`` and ``end`` at which the force passes an inner node (its time
    derivative jumps there).
    """
    end = rope.until if end is None else end
    times = np.arange(1, rope.n) * rope.passage
    return times[(times > start + 1e-12) & (times < end - 1e-12)]


def nodal_forces(rope: Rope, time: float) -> Array:
    """Vertical force of the load on all ``n + 1`` nodes (the shares of the supports included), shape (n +
    1,).
    """
    return rope.force * np.maximum(0.0, 1.0 - np.abs(rope.speed * time / rope.h - np.arange(rope.n + 1)))


def rest_shape(rope: Rope) -> Array:
    """Nodal positions at rest under gravity, shape (n + 1, 2).

    The link forces are ``t_i = t_0 + (0, i m g)``, so the shape follows from the two components of ``t_0``
    alone; Newton with backtracking on the complementary energy (convex) finds those for which the chain ends
    at the far support. Exact for the chain.
    """
    weight = rope.node_mass * rope.gravity
    lift = np.arange(rope.n) * weight
    sag = np.sqrt(max(3 / 8 * rope.span * (rope.length - rope.span), 1e-4 * rope.span**2))
    reaction = np.array([weight * rope.n * rope.span / (8 * sag), -0.5 * (rope.n - 1) * weight])

    def links(reaction: Array) -> tuple[Array, Array, Array]:
        pull = np.column_stack((np.full(rope.n, reaction[0]), reaction[1] + lift))
        size = np.hypot(pull[:, 0], pull[:, 1])
        return pull, size, rope.h * (1 / size + 1 / rope.stiffness)[:, None] * pull

    def energy(reaction: Array) -> float:
        size = links(reaction)[1]
        return float(np.sum(rope.h * (size + size**2 / (2 * rope.stiffness))) - reaction[0] * rope.span)

    for _ in range(60):
        pull, size, vectors = links(reaction)
        gap = vectors.sum(axis=0) - (rope.span, 0.0)
        if np.abs(gap).max() < 1e-13 * rope.length:
            break
        tangent = rope.h * (np.sum(1 / size + 1 / rope.stiffness) * np.eye(2) - (pull / size[:, None] ** 3).T @ pull)
        step = np.linalg.solve(tangent, -gap)
        scale = 1.0
        while energy(reaction + scale * step) > energy(reaction) * (1 + 1e-14) and scale > 1e-6:
            scale /= 2
        reaction = reaction + scale * step
    else:
        if np.abs(gap).max() > 1e-11 * rope.length:
            raise RuntimeError(f"the rest shape was not found, gap {gap}")
    positions = np.vstack((np.zeros((1, 2)), np.cumsum(links(reaction)[2], axis=0)))
    positions[-1] = (rope.span, 0.0)
    return positions


def initial_state(rope: Rope) -> Array:
    """Unknowns at rest, shape (4 (n - 1),)."""
    state = np.zeros((rope.n - 1, 4))
    state[:, :2] = rest_shape(rope)[1:-1]
    return state.ravel()


def positions_of(rope: Rope, states: Array) -> Array:
    """Positions of all nodes, shape (times, n + 1, 2), from states of shape (times, 4 (n - 1))."""
    states = np.asarray(states)
    positions = np.zeros((len(states), rope.n + 1, 2))
    positions[:, 1:-1] = states.reshape(len(states), rope.n - 1, 4)[:, :, :2]
    positions[:, -1, 0] = rope.span
    return positions


def numpy_rhs(rope: Rope) -> RightHandSide:
    """Right-hand side ``f(t, y)`` in plain NumPy: what a user without a compiler writes."""
    n, h = rope.n, rope.h
    positions = np.zeros((n + 1, 2))
    positions[-1, 0] = rope.span
    velocities = np.zeros((n + 1, 2))
    gravity = np.array([0.0, -rope.gravity])

    def f(time: float, y: Array) -> Array:
        state = y.reshape(n - 1, 4)
        positions[1:-1] = state[:, :2]
        velocities[1:-1] = state[:, 2:]
        delta = positions[1:] - positions[:-1]
        distance = np.sqrt(delta[:, 0] ** 2 + delta[:, 1] ** 2)
        strain = distance / h - 1
        tension = rope.stiffness * (np.maximum(strain, 0.0) if rope.tension_only else strain)
        if rope.damping:
            tension += rope.damping / (h * distance) * np.sum(delta * (velocities[1:] - velocities[:-1]), axis=1)
        pull = (tension / distance)[:, None] * delta
        out = np.empty_like(state)
        out[:, :2] = state[:, 2:]
        out[:, 2:] = (pull[1:] - pull[:-1]) / rope.node_mass + gravity
        place = rope.speed * time / h
        node = int(place)
        share = place - node
        if 1 <= node < n:
            out[node - 1, 3] += (1 - share) * rope.force / rope.node_mass
        if 0 <= node < n - 1:
            out[node, 3] += share * rope.force / rope.node_mass
        return out.ravel()

    return f


@njit(error_model="numpy", cache=True)
def _fill_rhs(time, y, out, pull, n, h, span, mass, stiffness, damping, gravity, force, speed, tension_only):
    """Write the time derivative of ``y`` into ``out``; ``pull`` is scratch, shape (2, n). Two plain loops, so
    that they vectorise.
    """
    for i in range(n):
        a, b = 4 * (i - 1), 4 * i
        x0 = z0 = u0 = w0 = z1 = u1 = w1 = 0.0
        x1 = span
        if i > 0:
            x0, z0, u0, w0 = y[a], y[a + 1], y[a + 2], y[a + 3]
        if i < n - 1:
            x1, z1, u1, w1 = y[b], y[b + 1], y[b + 2], y[b + 3]
        dx, dz = x1 - x0, z1 - z0
        inverse = 1.0 / np.sqrt(dx * dx + dz * dz)
        # tension divided by the distance
        elastic = stiffness * (1.0 / h - inverse)
        if tension_only and elastic < 0.0:
            elastic = 0.0
        factor = elastic + damping / h * inverse * inverse * (dx * (u1 - u0) + dz * (w1 - w0))
        pull[0, i] = factor * dx
        pull[1, i] = factor * dz
    for j in range(n - 1):
        out[4 * j] = y[4 * j + 2]
        out[4 * j + 1] = y[4 * j + 3]
        out[4 * j + 2] = (pull[0, j + 1] - pull[0, j]) / mass
        out[4 * j + 3] = (pull[1, j + 1] - pull[1, j]) / mass - gravity
    place = speed * time / h
    node = int(place)
    share = place - node
    if 1 <= node < n:
        out[4 * (node - 1) + 3] += (1.0 - share) * force / mass
    if 0 <= node < n - 1:
        out[4 * node + 3] += share * force / mass


def _parameters(rope: Rope) -> tuple:
    """Arguments of the compiled kernels, as floats whatever the user wrote, so that each kernel is compiled
    once.
    """
    numbers = (
        rope.h,
        rope.span,
        rope.node_mass,
        rope.stiffness,
        rope.damping,
        rope.gravity,
        rope.force,
        rope.speed,
    )
    return (rope.n, *map(float, numbers), rope.tension_only)


def numba_fill(rope: Rope) -> Callable[[float, Array, Array], None]:
    """Compiled right-hand side ``f(t, y, out)`` that writes into ``out`` (the form that SUNDIALS wants)."""
    parameters = _parameters(rope)
    pull = np.empty((2, rope.n))

    def fill(time: float, y: Array, out: Array) -> None:
        _fill_rhs(time, y, out, pull, *parameters)

    return fill


def numba_rhs(rope: Rope) -> RightHandSide:
    """Compiled right-hand side ``f(t, y)`` that returns a new array (the form that SciPy wants)."""
    parameters = _parameters(rope)
    pull = np.empty((2, rope.n))

    def f(time: float, y: Array) -> Array:
        out = np.empty_like(y)
        _fill_rhs(time, y, out, pull, *parameters)
        return out

    return f


@njit(error_model="numpy", cache=True)
def _fill_blocks(y, stiff, damp, n, h, span, mass, stiffness, damping, gravity, force, speed, tension_only):
    """Derivatives of each link's pull on its left node, by the link vector and its rate, divided by the nodal
    mass.
    """
    for i in range(n):
        a, b = 4 * (i - 1), 4 * i
        x0 = z0 = u0 = w0 = z1 = u1 = w1 = 0.0
        x1 = span
        if i > 0:
            x0, z0, u0, w0 = y[a], y[a + 1], y[a + 2], y[a + 3]
        if i < n - 1:
            x1, z1, u1, w1 = y[b], y[b + 1], y[b + 2], y[b + 3]
        dx, dz, du, dw = x1 - x0, z1 - z0, u1 - u0, w1 - w0
        distance = np.sqrt(dx * dx + dz * dz)
        ex, ez = dx / distance, dz / distance
        rate = ex * du + ez * dw
        slope = stiffness / h
        tension = stiffness * (distance / h - 1.0)
        if tension_only and tension < 0.0:
            slope = tension = 0.0
        tension += damping / h * rate
        side = tension / distance
        # d tension / d vector = slope e + damping/h (rate vector across e) / distance
        gx = slope * ex + damping / h * (du - rate * ex) / distance
        gz = slope * ez + damping / h * (dw - rate * ez) / distance
        stiff[i, 0] = (ex * gx + side * (1.0 - ex * ex)) / mass
        stiff[i, 1] = (ex * gz - side * ex * ez) / mass
        stiff[i, 2] = (ez * gx - side * ex * ez) / mass
        stiff[i, 3] = (ez * gz + side * (1.0 - ez * ez)) / mass
        damp[i, 0] = damping / h * ex * ex / mass
        damp[i, 1] = damping / h * ex * ez / mass
        damp[i, 2] = damp[i, 1]
        damp[i, 3] = damping / h * ez * ez / mass


def sparse_jacobian(rope: Rope) -> Callable[[float, Array], csc_matrix]:
    """Analytic Jacobian ``jac(t, y)`` as a CSC matrix whose pattern is found once and whose numbers are
    filled by compiled code.
    """
    n, parameters = rope.n, _parameters(rope)
    stiff, damp = np.empty((n, 4)), np.empty((n, 4))
    nodes = np.arange(n - 1)
    component = np.array([(0, 0), (0, 1), (1, 0), (1, 1)])
    rows, columns = (
        [np.concatenate((4 * nodes, 4 * nodes + 1))],
        [np.concatenate((4 * nodes + 2, 4 * nodes + 3))],
    )
    # order of the values: identity, then for each kind of unknown the blocks on, right of and left of the
    # diagonal
    kinds = (0, 2) if rope.damping else (0,)
    for kind in kinds:
        for row, column in ((nodes, nodes), (nodes[:-1], nodes[1:]), (nodes[1:], nodes[:-1])):
            rows.append((4 * row[:, None] + 2 + component[:, 0]).ravel())
            columns.append((4 * column[:, None] + kind + component[:, 1]).ravel())
    row, column = np.concatenate(rows), np.concatenate(columns)
    size = 4 * (n - 1)
    pattern = coo_array((np.arange(1, len(row) + 1), (row, column)), shape=(size, size)).tocsc()
    order = pattern.data - 1
    values = np.ones(len(row))

    def jacobian(time: float, y: Array) -> csc_matrix:
        _fill_blocks(y, stiff, damp, *parameters)
        at = 2 * (n - 1)
        for blocks in (stiff, damp)[: len(kinds)]:
            for part in (-(blocks[1:] + blocks[:-1]), blocks[1:-1], blocks[1:-1]):
                values[at : at + part.size] = part.ravel()
                at += part.size
        return csc_matrix((values[order], pattern.indices, pattern.indptr), shape=(size, size))

    return jacobian
