"""Frames of many instants at once, of plain lines under given forces between points that do not move.

What `frames.py` does for one state, with instants in front: to call NumPy for each of them would cost more than to move
ropes of some fifty links from one to the next. Where bodies or supports have states of their own, frames are built one
by one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ropewalk.mechanics.at_instants import forces_at, speeds_at, stored_totals
from ropewalk.mechanics.chain import FRICTIONLESS, OFF, Array, ChainState, Integers
from ropewalk.mechanics.law import tensions
from ropewalk.mechanics.moving_contact import link_of
from ropewalk.mechanics.notes import Notes, columns
from ropewalk.results.frame import MOVES, STICKS, Contacts
from ropewalk.results.frames import summed
from ropewalk.solve.hold_forces import coefficient_used
from ropewalk.solve.start import PreparedRun


@dataclass(frozen=True)
class ManyStates:
    """States at some instants, which come first."""

    t: Array  # (instant,) s
    r: Array  # (instant, axis, node) m
    w: Array  # (instant, axis, node) m/s
    X: Array  # (instant, node) m
    xi: Array  # (instant, load) m
    speed: Array  # (instant, load) m/s
    moving_load: Integers  # (instant, load)
    hold: Array  # (instant, load) N s
    work: Array  # (instant, work) J

    @staticmethod
    def of(notes: Sequence[Notes], state: ChainState) -> ManyStates:
        """What has been noted of a state."""
        t, *others = columns(notes, state)
        return ManyStates(t[:, 0], *others)

    def at(self, i: int) -> ChainState:
        """One of them."""
        others = (self.r, self.w, self.X, self.xi, self.speed, self.moving_load, self.hold, self.work)
        return ChainState(self.t[i : i + 1], *(array[i] for array in others))

    def moving_nodes(self, k: int) -> tuple[Integers, Integers]:
        """Instants at which a node rides with load k, and which."""
        rows = np.flatnonzero(self.moving_load[:, k] >= 0)
        return rows, self.moving_load[rows, k]


@dataclass(frozen=True)
class ManyLinks:
    """Strains, tensions and force vectors of all links (entries between strands are zero), with instants in front."""

    eps: Array
    T: Array
    f: Array  # (instant, axis, link) N
    elastic: Array  # (instant,) J

    @staticmethod
    def of(setting: PreparedRun, states: ManyStates) -> ManyLinks:
        """Look at the links of all strands."""
        strands, (count, dim, nodes) = setting.strands, states.r.shape
        v, U = states.w.copy(), np.zeros((count, nodes))
        for k in range(states.xi.shape[1]):
            rows, b = states.moving_nodes(k)
            U[rows, b] = states.speed[rows, k]
            v[rows, :, b] += states.speed[rows, k, None] * _slope(states, rows, b - 1, b + 1)
        eps, T, f = (np.zeros((count, *size)) for size in ((nodes - 1,), (nodes - 1,), (dim, nodes - 1)))
        elastic = np.zeros(count)
        for s in range(strands.first.size):
            i, j = int(strands.first[s]), int(strands.first[s] + strands.links[s])
            d, rest = np.diff(states.r[:, :, i : j + 1], axis=2), np.diff(states.X[:, i : j + 1], axis=1)
            length = np.sqrt((d * d).sum(axis=1))
            strain = length / rest - 1.0
            along = (d * np.diff(v[:, :, i : j + 1], axis=2)).sum(axis=1) / length
            rate = (along - np.diff(U[:, i : j + 1], axis=1) * length / rest) / rest
            pull = tensions(strands.law[s], strain.ravel()).reshape(strain.shape) + strands.damping[s] * rate
            eps[:, i:j], T[:, i:j], f[:, :, i:j] = strain, pull, pull[:, None] * d / length[:, None]
            elastic += stored_totals(strands.law[s], strain, rest)
        return ManyLinks(eps, T, f, elastic)


def _slope(states: ManyStates, rows: Integers, a: Integers, b: Integers) -> Array:
    """Change of place between two nodes with the material coordinate, (row, axis)."""
    run = states.X[rows, b] - states.X[rows, a]
    return np.asarray((states.r[rows, :, b] - states.r[rows, :, a]) / run[:, None])


def material_nodes(setting: PreparedRun, states: ManyStates) -> tuple[Array, Array]:
    """Positions and velocities of the material nodes, see `frames.py`."""
    r, w = states.r.copy(), states.w.copy()
    for k in range(states.xi.shape[1]):
        rows, b = states.moving_nodes(k)
        s, speed = int(setting.loads.strand[k]), states.speed[rows, k, None]
        home, here = (b - setting.strands.first[s]) * setting.strands.h[s], states.X[rows, b]
        a = np.where(home <= here, b - 1, b + 1)
        part = ((home - states.X[rows, a]) / (here - states.X[rows, a]))[:, None]
        v = states.w[rows, :, b] + speed * _slope(states, rows, b - 1, b + 1)
        r[rows, :, b] = (1.0 - part) * states.r[rows, :, a] + part * states.r[rows, :, b]
        w[rows, :, b] = (1.0 - part) * states.w[rows, :, a] + part * (v - speed * _slope(states, rows, a, b))
    return r, w


def energies_of_lines(setting: PreparedRun, states: ManyStates, elastic: Array, w: Array) -> dict[str, Array]:
    """Kinetic, elastic and gravitational energy of the lines, (instant,) J; w are velocities of the particles."""
    strands = setting.strands
    kinetic, gravitational = np.zeros(states.t.size), np.zeros(states.t.size)
    for s in range(strands.first.size):
        i, j = int(strands.first[s]), int(strands.first[s] + strands.links[s])
        m, g = strands.rho[s] * strands.h[s], strands.gravity[:, None]
        kinetic += 0.5 * m * summed(w[:, :, i + 1 : j] ** 2)
        gravitational -= m * summed(g * states.r[:, :, i + 1 : j])
        gravitational -= 0.5 * m * summed(g[:, 0] * (states.r[:, :, i] + states.r[:, :, j]))
    return {"kinetic": kinetic, "elastic": elastic, "gravitational": gravitational}


def reactions(setting: PreparedRun, links: ManyLinks) -> Array:
    """Forces of the supports on the lines (instant, support, axis), N, before the loads that stand on supports."""
    strands, out = setting.strands, []
    for s in range(strands.first.size):
        i, j = int(strands.first[s]), int(strands.first[s] + strands.links[s])
        half = 0.5 * strands.rho[s] * strands.h[s] * strands.gravity
        out += [-links.f[:, :, i] - half, links.f[:, :, j - 1] - half]
    return np.stack(out, axis=1)


def links_only(setting: PreparedRun, values: Array) -> Array:
    """Drop the entries that stand between two strands."""
    first, links = setting.strands.first, setting.strands.links
    return np.concatenate([values[:, int(i) : int(i + n)] for i, n in zip(first, links, strict=True)], axis=1)


def contacts(setting: PreparedRun, states: ManyStates, links: ManyLinks, mean_hold: Array, reaction: Array) -> Contacts:
    """What is told of loads; reactions (instant, support, axis) get those that stand on supports.

    Args:
        mean_hold: (instant, load) N, along x since the instant before.
    """
    strands, loads, (count, dim, _) = setting.strands, setting.loads, states.r.shape
    seen = Contacts(count, states.xi.shape[1], dim)
    for k in range(states.xi.shape[1]):
        s, on = int(loads.strand[k]), np.flatnonzero(states.moving_load[:, k] != OFF)
        times = np.ascontiguousarray(states.t[on])
        F = forces_at(loads, k, times, dim)
        seen.hold[on, k], seen.xi[on, k] = 0.0, states.xi[on, k]
        seen.speed[on, k] = speeds_at(loads, k, times)
        seen.state[on, k] = np.where(states.speed[on, k] != 0.0, MOVES, STICKS)
        rows, b = states.moving_nodes(k)
        seen.position[rows, k] = states.r[rows, :, b]
        seen.tension[rows, k] = links.T[rows[:, None], np.stack([b - 1, b], axis=1)]
        seen.friction[rows, k] = _friction_used(setting, states, links, k, rows, b)
        if loads.contact[k] == FRICTIONLESS:
            seen.hold[rows, k, 0] = mean_hold[rows, k]
        for q, row in enumerate(on.tolist()):
            if states.moving_load[row, k] >= 0:
                continue
            i = int(link_of(strands, loads, states.at(row), k))
            X, r = states.X[row], states.r[row]
            part = (states.xi[row, k] - X[i]) / (X[i + 1] - X[i])
            seen.position[row, k] = (1.0 - part) * r[:, i] + part * r[:, i + 1]
            seen.tension[row, k] = links.T[row, i]
            for node, share in ((i, 1.0 - part), (i + 1, part)):
                if node == strands.first[s]:
                    reaction[row, 2 * s] -= share * F[q]
                elif node == strands.first[s] + strands.links[s]:
                    reaction[row, 2 * s + 1] -= share * F[q]
        seen.force[on, k] = F + seen.hold[on, k]
    return seen


def _friction_used(
    setting: PreparedRun, states: ManyStates, links: ManyLinks, k: int, rows: Integers, b: Integers
) -> Array:
    """Friction coefficients that the pulls beside a riding node need, see `frames.py`, (row,)."""
    s = setting.loads.strand[k]
    flux = float(setting.strands.rho[s]) * states.speed[rows, k, None] ** 2
    behind = links.f[rows, :, b - 1] - flux * _slope(states, rows, b - 1, b)
    ahead = links.f[rows, :, b] - flux * _slope(states, rows, b, b + 1)
    size, other = (np.sqrt((one * one).sum(axis=1)) for one in (behind, ahead))
    found = np.full(rows.size, np.inf)
    fine = np.minimum(size, other) > 0.0
    cosine = (behind * ahead).sum(axis=1)[fine] / (size * other)[fine]
    angle, log = np.arccos(np.clip(cosine, -1.0, 1.0)), np.log(other[fine] / size[fine])
    model = setting.loads.friction_model[k]
    found[fine] = [coefficient_used(model, *pair) for pair in zip(log, angle, strict=True)]
    return found
