"""Saddles: round bodies on which lines lie, from which they lift, and over which they slip and rub.

A node at d from the centre of a saddle of the radius R, at a along its axis and rho off it, is pressed in by

    g = R + a^2 / (2 G) - rho > 0,   V = 1/2 k g^2,

with the radius G of its groove across the line, and k the stiffness of a link: the line sinks in by its strain times
h^2/R, less than the sagitta of a link. Its friction is Coulomb's, of the impulses of a kick: what they bear stops,
so that what sticks does not creep,

    |m dv| <= mu k g h,

and over an arc of nodes tensions differ by exp(mu angle), to the first order of the links on it. Forces act on the
saddle, which has a node of its own, as on the line.

To the first order about rest, what is in touch there stays so, and friction holds it: such a node goes with the saddle
but for the way in which it is pressed, and what acts across that acts on the saddle, which is so much heavier.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics import law
from ropewalk.mechanics.assembly import components, pack
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import inlined, lean_inner
from ropewalk.model.scenario import Scenario
from ropewalk.system.elements.elements_about_rest import (
    ElementsAboutRest,
    add_forces_about_rest,
    gathered,
    is_little,
    stored_about_rest,
)

# Radius of the groove across the line over that along it.
_GROOVE = 0.05
_NEAR = 1.5  # radii, within which nodes may come to touch a saddle
_STRETCHED = 1e-6  # strain at which the stiffness of links is looked up: some laws have none where they are slack


class Saddles(NamedTuple):
    """All saddles; one entry for each, if not said otherwise."""

    node: Integers  # its own
    first: Integers  # first node of its line
    last: Integers
    radius: Array  # m
    groove: Array  # m
    friction: Array
    k: Array  # N/m
    axis: Array  # (saddle, axis) unit vector; zero in a plane
    way: Array  # (axis,) room: change of g with the place of a node
    about: ElementsAboutRest = ElementsAboutRest.nothing()  # of nodes in touch, each with that of its saddle
    stuck_nodes: Integers = np.zeros((0, 2), dtype=np.int64)  # (stuck, 2) in small motion, and their saddles
    press: Array = np.zeros((0, 0))  # (stuck, axis) unit vectors that press them
    heavier: Array = np.zeros((0, 0, 0))  # (restraint, axis, axis) kg, of these with their saddles

    @staticmethod
    def nothing(axes: int) -> Saddles:
        """Of lines that lie on none."""
        i, x = np.zeros(0, dtype=np.int64), np.zeros(0)
        return Saddles(i, i, i, x, x, x, x, np.zeros((0, axes)), np.zeros(axes))

    def touched(self, r: Array) -> list[tuple[int, Integers, Array, Array, Array]]:
        """Saddles that are touched, the nodes that touch them, g in m, its gradient (axis, node) and its slope."""
        found = []
        for e in range(self.node.size):
            nodes = np.arange(self.first[e], self.last[e] + 1)
            d = r[:, nodes] - r[:, [self.node[e]]]
            d[-1] += self.radius[e]
            aside = self.axis[e] @ d
            across = d - np.outer(self.axis[e], aside)
            rho = np.linalg.norm(across, axis=0)
            g = self.radius[e] + aside**2 / (2.0 * self.groove[e]) - rho
            on = np.flatnonzero(g > 0.0)
            if on.size:
                unit = across[:, on] / np.maximum(rho[on], 1e-300)
                slope = np.outer(self.axis[e], aside[on]) / self.groove[e] - unit
                found.append((e, nodes[on], g[on], slope, unit / np.sqrt(np.maximum(rho[on], 1e-300))))
        return found

    def stiffness(self, r: Array) -> sparse.csc_matrix:
        """Second derivatives of V, (place, place) N/m; linearised: at rest."""
        node, K, *_ = (self.about.node, self.about.stiffness) if self.about.are_there else self._touching(r)
        return gathered(node, K, r.shape[1], r.shape[0])

    def _touching(self, r: Array) -> tuple[Integers, Array, Array, Array]:
        """Nodes in touch and those of their saddles, their stiffness, N/m, forces, N, and energies, J."""
        axes = r.shape[0]
        node, K, force, stored = list[tuple[int, int]](), list[Array](), list[Array](), list[float]()
        for e, nodes, g, slope, unit in self.touched(r):
            flat = np.eye(axes) - np.outer(self.axis[e], self.axis[e])
            for i, depth, p, u in zip(nodes.tolist(), g, slope.T, unit.T, strict=True):
                curved = np.outer(self.axis[e], self.axis[e]) / self.groove[e] - flat * float(u @ u) + np.outer(u, u)
                block, pull = self.k[e] * (np.outer(p, p) + depth * curved), -self.k[e] * depth * p
                node.append((i, int(self.node[e])))
                K.append(np.block([[block, -block], [-block, block]]))
                force.append(np.concatenate([pull, -pull]))
                stored.append(0.5 * float(self.k[e] * depth**2))
        count, size = len(node), 2 * axes
        return (
            np.array(node, dtype=np.int64).reshape(count, 2), np.array(K).reshape(count, size, size),
            np.array(force).reshape(count, size), np.array(stored),
        )  # fmt: skip

    def about_rest(self, rest: Array, mass: Array, restraint: Integers, free: Array) -> Saddles:
        """The same, linearised about places of all nodes at rest (axis, node) in m.

        Args:
            rest: (axis, node) m.
            mass: (node,) kg.
            restraint: (saddle,) that holds each.
            free: (restraint, axis, axis) projections onto the directions in which they may move.
        """
        node, K, force, stored = self._touching(rest)
        stuck, axes = self.stuck(rest), rest.shape[0]
        heavier = np.zeros_like(free)
        for e, i, way in stuck:
            P = free[restraint[e]]
            heavier[restraint[e]] += mass[i] * P @ (np.eye(axes) - np.outer(way, way)) @ P
        return self._replace(
            about=ElementsAboutRest.of(node, rest, force, K, np.zeros_like(K), stored),
            stuck_nodes=np.array([(i, self.node[e]) for e, i, _ in stuck], dtype=np.int64).reshape(-1, 2),
            press=np.array([way for *_, way in stuck]).reshape(-1, axes), heavier=heavier,
        )  # fmt: skip

    def stuck(self, r: Array) -> list[tuple[int, int, Array]]:
        """Nodes that lie on saddles with friction: saddle, node, and the unit vector (axis,) that presses it."""
        return [
            (e, int(i), p / np.linalg.norm(p))
            for e, nodes, _, slope, _ in self.touched(r) if self.friction[e] > 0.0
            for i, p in zip(nodes, slope.T, strict=True)
        ]  # fmt: skip

    def pressing(self, r: Array) -> dict[int, float]:
        """Forces in N with which nodes are pressed into saddles, by node."""
        return {
            int(i): float(self.k[e] * depth * np.linalg.norm(p))
            for e, nodes, g, slope, _ in self.touched(r)
            for i, depth, p in zip(nodes, g, slope.T, strict=True)
        }  # fmt: skip

    def sticking(self, free: sparse.csc_matrix, r: Array) -> sparse.csc_matrix:
        """Ways (place, unknown) in which nodes may move a little where friction holds those on saddles.

        They go with their saddles, and are pressed into these: it takes a force to overcome friction, however small the
        motion is.
        """
        n, moved = r.shape[1], free.tolil()
        gone, more = list[int](), list[tuple[Array, Array]]()
        for e, i, way in self.stuck(r):
            at, own = np.arange(r.shape[0]) * n + i, np.arange(r.shape[0]) * n + self.node[e]
            gone.extend(c for row in moved.rows[at] for c in row)
            moved[at] = moved[own]
            more.append((at, way))
        kept = np.setdiff1d(np.arange(free.shape[1]), gone)
        pressed = sparse.lil_matrix((free.shape[0], len(more)))
        for c, (at, way) in enumerate(more):
            pressed[at, c] = way
        return sparse.hstack([moved.tocsc()[:, kept], pressed], format="csc")

    def neighbours(self, r: Array) -> sparse.csc_matrix:
        """Which places may feel which, of nodes that come near saddles, (place, place)."""
        n = r.shape[1]
        touch = sparse.lil_matrix((n, n))
        for e in range(self.node.size):
            nodes = np.arange(self.first[e], self.last[e] + 1)
            away = np.linalg.norm(r[:, nodes] - r[:, [self.node[e]]], axis=0)
            near = nodes[away < _NEAR * self.radius[e]]
            touch[near, near] = touch[near, self.node[e]] = touch[self.node[e], near] = 1.0
            touch[self.node[e], self.node[e]] = 1.0
        axes = np.ones((r.shape[0], r.shape[0]))
        return sparse.kron(axes, touch.tocsc(), format="csc")

    def damping(self, r: Array) -> sparse.csc_matrix:
        """None: friction acts in motion only."""
        return sparse.csc_matrix((r.size, r.size))

    def bounds(self, mass: Array) -> Array:
        """Bounds (node,) of squares of frequencies that touching makes, 1/s^2."""
        out = np.zeros(mass.size)
        for e in range(self.node.size):
            part = slice(self.first[e], self.last[e] + 1)
            light = np.divide(1.0, mass[part], out=np.zeros(mass[part].size), where=mass[part] > 0.0)
            out[part] += self.k[e] * light
        return out


def saddles_of(
    scenario: Scenario, sections: Sequence[tuple[str, Integers, Array]], first: Sequence[int], h: Sequence[float],
    begin: int, axes: tuple[str, ...],
) -> Saddles | None:  # fmt: skip
    """The arrays of saddles; None: there are none.

    Args:
        scenario: what is there.
        sections: runs: line, nodes as laid out, stations in m.
        first: (run,) their first nodes.
        h: (run,) m, length of their links.
        begin: the first of the nodes of saddles.
        axes: names of the axes.
    """
    found: list[tuple[Any, ...]] = []
    for name, line in scenario.lines.items():
        runs = [s for s, (own, *_) in enumerate(sections) if own == name]
        for saddle in line.saddles.values():
            chord = components(line.end, axes) - components(line.start, axes)
            axis = np.zeros(len(axes))
            if len(axes) == 3:
                level = np.array([-chord[1], chord[0], 0.0])
                axis = level / max(float(np.linalg.norm(level)), 1e-300)
            found.append((
                begin + len(found), first[runs[0]], first[runs[-1]] + sections[runs[-1]][1].size - 1, saddle.radius,
                saddle.friction, axis, line, min(h[s] for s in runs),
            ))  # fmt: skip
    if not found:
        return None
    columns: Any = zip(*found, strict=True)
    node, start, last, radius, friction, axes_of_saddles, lines, link = columns
    slope = [law.tangents(pack(line.law, line.axial_stiffness), np.array([_STRETCHED]))[0] for line in lines]
    k = [float(EA) / own for EA, own in zip(slope, link, strict=True)]
    R = np.array(radius)
    return Saddles(
        np.array(node, dtype=np.int64), np.array(start, dtype=np.int64), np.array(last, dtype=np.int64), R, _GROOVE * R,
        np.array(friction, dtype=float), np.array(k), np.array(axes_of_saddles), np.zeros(len(axes)),
    )  # fmt: skip


@inlined
def lie_on(saddles):
    """Whether there are any: asked where a call would hand all arrays on."""
    if saddles is None:
        return False
    return saddles.node.size > 0


@lean_inner
def _depth(saddles, r, e, i):
    """How deep node i is in saddle e, g in m; if it is, `way` becomes the change of g with the place of the node."""
    last, aside, square = r.shape[0] - 1, 0.0, 0.0
    own = saddles.node[e]
    if abs(r[0, i] - r[0, own]) > 2.0 * saddles.radius[e] and last == 1:  # far away
        return -1.0
    for a in range(last + 1):
        d = r[a, i] - r[a, own]
        if a == last:
            d += saddles.radius[e]
        saddles.way[a] = d
        aside += d * saddles.axis[e, a]
    for a in range(last + 1):
        saddles.way[a] -= aside * saddles.axis[e, a]
        square += saddles.way[a] ** 2
    rho = np.sqrt(square)
    g = saddles.radius[e] + aside * aside / (2.0 * saddles.groove[e]) - rho
    if g > 0.0:
        for a in range(last + 1):
            saddles.way[a] = aside / saddles.groove[e] * saddles.axis[e, a] - saddles.way[a] / max(rho, 1e-300)
    return g


@lean_inner
def add_saddle_forces(saddles, r, force):
    """Add the forces of all saddles on nodes, and back on the saddles."""
    if saddles is None:
        return
    if is_little(saddles.about):
        add_forces_about_rest(saddles.about, r, force)
        return
    for e in range(saddles.node.size):
        own = saddles.node[e]
        for i in range(saddles.first[e], saddles.last[e] + 1):
            g = _depth(saddles, r, e, i)
            if g > 0.0:
                for a in range(r.shape[0]):
                    F = saddles.k[e] * g * saddles.way[a]
                    force[a, i] -= F
                    force[a, own] += F


@lean_inner
def stored_in_saddles(saddles, r):
    """Energy of what is pressed into saddles, J."""
    total = 0.0
    if saddles is None:
        return total
    if is_little(saddles.about):
        return stored_about_rest(saddles.about, r)
    for e in range(saddles.node.size):
        for i in range(saddles.first[e], saddles.last[e] + 1):
            total += 0.5 * saddles.k[e] * max(_depth(saddles, r, e, i), 0.0) ** 2
    return total


@lean_inner
def rub_on_saddles(saddles, inertia, light, r, v, force, h):
    """Let friction act in a kick of the length h that nodes have got; returns what it takes, J.

    Where nodes are heavier along their lines, by f - 1, so is what friction has to stop: M u.
    """
    lost = 0.0
    if saddles is None:
        return lost
    if is_little(saddles.about):
        return lost
    heavier = inertia.factor - 1.0 if inertia.along.shape[1] > 0 else 0.0
    for e in range(saddles.node.size):
        if saddles.friction[e] == 0.0:
            continue
        own = saddles.node[e]
        for i in range(saddles.first[e], saddles.last[e] + 1):
            if light[i] == 0.0:
                continue
            g = _depth(saddles, r, e, i)
            if g <= 0.0:
                continue
            into = steep = square = across = along = pulled = 0.0
            for a in range(r.shape[0]):
                into += (v[a, i] - v[a, own]) * saddles.way[a]
                steep += saddles.way[a] ** 2
                if heavier != 0.0:
                    across += inertia.along[a, i] * saddles.way[a]
                    pulled += inertia.along[a, i] * force[a, i]
            if heavier != 0.0:
                for a in range(r.shape[0]):
                    flat = inertia.along[a, i] - across / steep * saddles.way[a]
                    along += flat * (v[a, i] - v[a, own])
            for a in range(r.shape[0]):
                momentum = v[a, i] - v[a, own] - into / steep * saddles.way[a]
                if heavier != 0.0:
                    momentum += heavier * along * (inertia.along[a, i] - across / steep * saddles.way[a])
                square += momentum**2
            speed = np.sqrt(square)
            if speed == 0.0:
                continue
            part = min(saddles.friction[e] * saddles.k[e] * g * np.sqrt(steep) * h * light[i] / speed, 1.0)
            for a in range(r.shape[0]):
                u = v[a, i] - v[a, own]
                change = part * (u - into / steep * saddles.way[a])
                momentum, kicked = change, force[a, i]
                if heavier != 0.0:
                    momentum += part * heavier * along * (inertia.along[a, i] - across / steep * saddles.way[a])
                    kicked -= heavier / (1.0 + heavier) * pulled * inertia.along[a, i]
                # At the mean of the velocities before and behind the kick: what sticks loses nothing.
                lost += momentum * (u - 0.5 * (change + h * light[i] * kicked)) / light[i]
                v[a, i] -= change
                force[a, own] += momentum / (light[i] * h)
    return lost


@lean_inner
def carried_along(saddles, e, a, c):
    """What nodes that friction holds in small motion add to the mass of restraint e in directions a and c, kg."""
    if saddles is None:
        return 0.0
    return saddles.heavier[e, a, c] if saddles.heavier.shape[0] > 0 else 0.0


@lean_inner
def bear_on(saddles, v, drag, mass, force):
    """Let saddles bear what acts on the nodes that friction holds there, but for what presses them."""
    if saddles is None:
        return
    for c in range(saddles.stuck_nodes.shape[0]):
        i, own = saddles.stuck_nodes[c, 0], saddles.stuck_nodes[c, 1]
        pressed = into = 0.0
        for a in range(v.shape[0]):
            pressed += saddles.press[c, a] * force[a, i]
            into += saddles.press[c, a] * v[a, i]
        for a in range(v.shape[0]):
            along = force[a, i] - saddles.press[c, a] * pressed
            force[a, i] -= along
            force[a, own] += along - drag[i] * mass[i] * (v[a, i] - saddles.press[c, a] * into)


@lean_inner
def go_along(saddles, v):
    """Let the nodes that friction holds on saddles go with these, but for the way in which they are pressed."""
    if saddles is None:
        return
    for c in range(saddles.stuck_nodes.shape[0]):
        i, own = saddles.stuck_nodes[c, 0], saddles.stuck_nodes[c, 1]
        into = 0.0
        for a in range(v.shape[0]):
            into += saddles.press[c, a] * (v[a, i] - v[a, own])
        for a in range(v.shape[0]):
            v[a, i] = v[a, own] + saddles.press[c, a] * into
