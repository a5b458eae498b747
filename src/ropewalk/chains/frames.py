"""Frames of plain lines from states of the chain: material nodes, tensions, contacts, reactions, energy.

Many instants are computed at once: a call of NumPy costs more than it takes to move ropes of fifty links from one to
the next. Where controllers lead loads on the way, there is one instant at a time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ropewalk.chains.beside_wheels import BesideWheels, ManyNodes, SplitLinks
from ropewalk.chains.many_bodies import ManyBodies, displayed, energies_of_loads, lengths, onwards, put_located
from ropewalk.chains.many_ends import energies_of_ends, let_yield
from ropewalk.checkpoint import Tree, copied
from ropewalk.mechanics.at_instants import forces_at, speeds_at, stored_totals
from ropewalk.mechanics.bodies import (
    ALONG_X,
    CARRIED,
    EVEN,
    FLYING,
    FREE,
    GIVEN,
    INSIDE,
    LOCATED,
    MOVING_WITH,
    PARKED,
    WAITING,
    Bodies,
    are_weightless,
    noted_of,
)
from ropewalk.mechanics.chain import (
    CONTACT,
    DRIVE,
    FRICTION,
    FRICTIONLESS,
    HOLD_WORK,
    LINE_DAMPING,
    LOAD_DAMPING,
    LOAD_WORK,
    OFF,
    SUPPORT_WORK,
    Array,
    ChainState,
    Integers,
)
from ropewalk.mechanics.law import tensions
from ropewalk.mechanics.moving_contact import link_of
from ropewalk.mechanics.notes import Notes, columns
from ropewalk.results.audit import Audit
from ropewalk.results.frame import MOVES, OFF_LINE, STICKS, Contacts, Frame, Layout, uniform
from ropewalk.results.frames import Frames, summed
from ropewalk.solve.ends import ends_of
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
    bodies: ManyBodies | None = None

    @staticmethod
    def of(notes: Sequence[Notes], state: ChainState, bodies: Bodies | None) -> ManyStates:
        """What has been noted of a state and of bodies."""
        if bodies is None:
            t, *others = columns(notes, state)
            return ManyStates(t[:, 0], *others)
        t, *others = columns(notes, [*state, *noted_of(bodies)])
        own, of_bodies = others[: len(state) - 1], others[len(state) - 1 :]
        return replace(ManyStates(t[:, 0], *own), bodies=ManyBodies.of(bodies, state.r.shape[0], *of_bodies))

    @staticmethod
    def now(state: ChainState, bodies: Bodies | None) -> ManyStates:
        """The present state alone."""
        now: list[Any] = [array.copy()[None] for array in state]
        t, *others = now
        present = None if bodies is None else ManyBodies.now(bodies, state.r.shape[0])
        return replace(ManyStates(t[:, 0], *others), bodies=present)

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
    """Strains, tensions and force vectors of all links (entries between strands are zero), with instants in front.

    Where a wheel divides a link, its strain and tension are those in its middle, and its force vector is that at the
    support, if it is the last one, else that at its first node.
    """

    eps: Array
    T: Array
    f: Array  # (instant, axis, link) N
    elastic: Array  # (instant,) J
    beside: BesideWheels | None = None  # of wheels that have a place of their own

    @staticmethod
    def of(setting: PreparedRun, states: ManyStates) -> ManyLinks:
        """Look at the links of all strands."""
        strands, (count, dim, nodes) = setting.strands, states.r.shape
        v, U = states.w.copy(), np.zeros((count, nodes))
        for k in range(states.xi.shape[1]):
            rows, b = states.moving_nodes(k)
            U[rows, b] = states.speed[rows, k]
            v[rows, :, b] += states.speed[rows, k, None] * _slope(states, rows, b - 1, b + 1)
        points, split = ManyNodes(states.X, states.r, v, U), None
        if states.bodies is not None:
            points.place(states.bodies, states.speed)
            split = SplitLinks.of(strands, setting.loads.strand, states.xi, states.speed, points, states.bodies)
        eps, T, f = (np.zeros((count, *size)) for size in ((nodes - 1,), (nodes - 1,), (dim, nodes - 1)))
        elastic = np.zeros(count) if split is None else split.stored(count)
        for s in range(strands.first.size):
            i, j = int(strands.first[s]), int(strands.first[s] + strands.links[s])
            d, rest = np.diff(states.r[:, :, i : j + 1], axis=2), np.diff(states.X[:, i : j + 1], axis=1)
            length = np.sqrt((d * d).sum(axis=1))
            strain = length / rest - 1.0
            along = (d * np.diff(v[:, :, i : j + 1], axis=2)).sum(axis=1) / length
            rate = (along - np.diff(U[:, i : j + 1], axis=1) * length / rest) / rest
            pull = tensions(strands.law[s], strain.ravel()).reshape(strain.shape) + strands.damping[s] * rate
            eps[:, i:j], T[:, i:j], f[:, :, i:j] = strain, pull, pull[:, None] * d / length[:, None]
            if split is not None:  # those links are no straight ones
                own = (split.link >= i) & (split.link < j)
                rest[split.row[own], split.link[own] - i] = 0.0
            elastic += stored_totals(strands.law[s], strain, rest)
        if split is None or states.bodies is None:
            return ManyLinks(eps, T, f, elastic)
        beside = BesideWheels.of(split, points, T, f, states.bodies)
        split.put(strands, states.X, eps, T, f)
        return ManyLinks(eps, T, f, elastic, beside)


def _slope(states: ManyStates, rows: Integers, a: Integers, b: Integers) -> Array:
    """Change of place between two nodes with the material coordinate, (row, axis)."""
    run = states.X[rows, b] - states.X[rows, a]
    return np.asarray((states.r[rows, :, b] - states.r[rows, :, a]) / run[:, None])


def material_nodes(setting: PreparedRun, states: ManyStates) -> tuple[Array, Array]:
    """Positions and velocities of the material nodes: those that ride with loads are looked up on their links."""
    r, w = states.r.copy(), states.w.copy()
    if states.bodies is not None:
        put_located(setting, states.X, states.bodies, r, w)
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
    if (ends := ends_of(strands, setting.supports)) is not None:
        of_ends = energies_of_ends(ends, states.t, states.r, states.w)
        kinetic, elastic, gravitational = kinetic + of_ends[0], elastic + of_ends[1], gravitational + of_ends[2]
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


def contacts(
    setting: PreparedRun, states: ManyStates, links: ManyLinks, mean_hold: Array, reaction: Array, weightless: bool
) -> Contacts:
    """What is told of loads; reactions (instant, support, axis) get those that stand on supports.

    Args:
        mean_hold: (instant, load) N, along x since the instant before: from step to step it ripples where a load
            passes nodes.
        weightless: whether bodies only press as they are told to; motions of others note what they press with.
    """
    loads, bodies, (count, dim, _) = setting.loads, states.bodies, states.r.shape
    seen = Contacts(count, states.xi.shape[1], dim)
    for k in range(states.xi.shape[1]):
        on = np.flatnonzero((states.moving_load[:, k] != OFF) & (states.moving_load[:, k] != CARRIED))
        times = np.ascontiguousarray(states.t[on])
        F = forces_at(loads, k, times, dim) if bodies is None or weightless else bodies.on_line(on, k)
        seen.hold[on, k], seen.xi[on, k] = 0.0, states.xi[on, k]
        seen.speed[on, k] = speeds_at(loads, k, times)
        seen.state[on, k] = np.where(states.speed[on, k] != 0.0, MOVES, STICKS)
        rows, b = states.moving_nodes(k)
        seen.position[rows, k] = states.r[rows, :, b]
        seen.tension[rows, k] = links.T[rows[:, None], np.stack([b - 1, b], axis=1)]
        seen.friction[rows, k] = _friction_used(setting, states, links, k, rows, b)
        if loads.contact[k] == FRICTIONLESS:
            seen.hold[rows, k, 0] = mean_hold[rows, k]
        _share(setting, states, links, k, on, F, seen, reaction)
        seen.force[on, k] = F + seen.hold[on, k]
        if bodies is not None:
            _carried(setting, states, links, k, mean_hold, seen, reaction)
    if bodies is not None:
        seen.state = bodies.states(states.moving_load, states.speed)
        seen.in_air, seen.power = bodies.wheels["in_air"].copy(), bodies.wheels["power"].copy()
        _move_along(setting, states, bodies, seen.position)
    return seen


def _share(
    setting: PreparedRun, states: ManyStates, links: ManyLinks, k: int, on: Integers, F: Array, seen: Contacts,
    reaction: Array,
) -> None:  # fmt: skip
    """What is told of load k where it stands on a link, F of the instants `on`; supports bear what stands on theirs."""
    strands, loads, s = setting.strands, setting.loads, int(setting.loads.strand[k])
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


def _carried(
    setting: PreparedRun, states: ManyStates, links: ManyLinks, k: int, mean_hold: Array, seen: Contacts,
    reaction: Array,
) -> None:  # fmt: skip
    """What is told of wheel k where it has a place of its own."""
    bodies, beside, strands = states.bodies, links.beside, setting.strands
    assert bodies is not None
    assert beside is not None
    s, phase, travel = int(setting.loads.strand[k]), bodies.phase[:, k], bodies.fixed.wheels["travel"][k]
    carried = np.flatnonzero(states.moving_load[:, k] == CARRIED)
    seen.position[carried, k], seen.force[carried, k], seen.hold[carried, k] = bodies.r[carried, k], 0.0, 0.0
    seen.xi[carried, k] = np.where(phase[carried] == WAITING, np.nan, states.xi[carried, k])
    seen.speed[carried, k] = speeds_at(setting.loads, k, np.ascontiguousarray(states.t[carried]))
    rows, _ = bodies.are(FLYING, k)
    seen.speed[rows, k] = _product(bodies.v[rows, k], onwards(setting, states.r[rows], s))
    rows, link = bodies.are(PARKED, k)
    seen.force[rows, k] = bodies.on_line(rows, k)
    reaction[rows, 2 * s + (link != strands.first[s])] -= seen.force[rows, k]
    seen.tension[rows, k] = links.T[rows, link, None]
    rows = np.flatnonzero((phase == INSIDE) | (phase == LOCATED))
    vector, tangent, U = beside.vector[rows, k], beside.tangent[rows, k], states.speed[rows, k]
    seen.tension[rows, k] = beside.pull[rows, k]
    force = vector[..., 0] - vector[..., 1]
    force += (strands.rho[s] * U * U)[:, None] * (tangent[..., 1] - tangent[..., 0])
    own = strands.rho[s] * strands.h[s] * strands.gravity  # the weight of the particle that it carries is the line's
    force -= np.where((phase[rows] == LOCATED)[:, None], own, 0.0)
    seen.force[rows, k] = force
    if travel in (EVEN, ALONG_X):
        seen.hold[rows, k, 0] = mean_hold[rows, k]
    elif travel == GIVEN:  # what the line is gripped with
        mean = tangent[..., 0] + tangent[..., 1]
        mean /= lengths(mean)[:, None]
        seen.hold[rows, k] = _product(force, mean)[:, None] * mean
    if travel == FREE:
        seen.speed[rows, k] = U * (0.5 * (lengths(tangent[..., 0]) + lengths(tangent[..., 1])))


def _product(one: Array, other: Array) -> Array:
    """Scalar products of vectors (row, axis)."""
    total = np.zeros(len(one))
    for a in range(one.shape[1]):
        total += one[:, a] * other[:, a]
    return total


def _move_along(setting: PreparedRun, states: ManyStates, bodies: ManyBodies, places: Array) -> None:
    """Let wheels that ride as forces do be where they are, (instant, wheel, axis), and as fast as these."""
    for k in range(places.shape[1]):
        rows = np.flatnonzero((bodies.phase[:, k] == MOVING_WITH) & np.isfinite(places[:, k]).all(axis=1))
        bodies.r[rows, k] = places[rows, k]
        at_node, speed = states.moving_load[rows, k] >= 0, states.speed[rows, k, None]
        at, b = rows[at_node], states.moving_load[rows[at_node], k]
        bodies.v[at, k] = states.w[at, :, b] + speed[at_node] * _slope(states, at, b - 1, b + 1)
        at = rows[~at_node]
        i = np.array([link_of(setting.strands, setting.loads, states.at(row), k) for row in at.tolist()], np.int64)
        part = ((states.xi[at, k] - states.X[at, i]) / (states.X[at, i + 1] - states.X[at, i]))[:, None]
        w = states.w[at, :, i] + part * (states.w[at, :, i + 1] - states.w[at, :, i])
        bodies.v[at, k] = w + speed[~at_node] * _slope(states, at, i, i + 1)


def _friction_used(
    setting: PreparedRun, states: ManyStates, links: ManyLinks, k: int, rows: Integers, b: Integers
) -> Array:
    """Friction coefficients that the pulls beside a riding node need, less what turns the passing material, (row,)."""
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


def layout_of(setting: PreparedRun, path: str = "time") -> Layout:
    """Names and coordinates of the result of a run."""
    strands = setting.strands
    return Layout(
        axes=setting.axes,
        **uniform(setting.lines, strands.links, strands.h),
        contact_load=tuple(wheel.name for wheel in setting.wheels),
        body=tuple(body.name for body in setting.multibody_system.displayed)
        if setting.multibody_system is not None
        else (),
        support=tuple(f"{name}.{end}" for name in setting.lines for end in ("start", "end")),
        path=path,
        weight=-float((strands.rho * strands.h * strands.links).sum() * strands.gravity[-1]),
    )


_WORKS = {
    "line_damping": LINE_DAMPING, "contact_dissipation": CONTACT, "load_damping": LOAD_DAMPING, "friction": FRICTION,
    "load_work": LOAD_WORK, "hold_work": HOLD_WORK, "support_work": SUPPORT_WORK, "drive_work": DRIVE,
}  # fmt: skip


class ChainFrameBuilder:
    """Builds frames of a motion; the energy at the first one is the origin of the audit."""

    def __init__(self, setting: PreparedRun, bodies: Bodies | None = None) -> None:
        self.setting, self.bodies = setting, bodies
        self._weightless = bodies is not None and are_weightless(bodies)
        self.together = not self._weightless  # whether frames of many instants are built at once
        self._audit = Audit()
        self._work: Array | None = None  # at the first frame, J
        self._restrained: tuple[float, Array] = (0.0, np.zeros(setting.xi.size))

    def get_state(self) -> Tree:
        """The origin of the audit, and when hold forces were looked at last."""
        return copied({"audit": self._audit.get_state(), "work": self._work, "held": self._restrained})

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self._audit.set_state(tree["audit"])
        self._work, (since, impulse) = copied(tree["work"]), tree["held"]
        self._restrained = since, impulse.copy()

    def build(self, state: ChainState) -> Frame:
        """The frame of the present state."""
        return self.build_many(ManyStates.now(state, self.bodies))[0]

    def build_many(self, states: ManyStates) -> Frames:
        """The frames of some states that follow one another."""
        setting = self.setting
        links, (r, w) = ManyLinks.of(setting, states), material_nodes(setting, states)
        since, impulse = np.append(self._restrained[0], states.t), np.vstack([self._restrained[1], states.hold])
        step, pushed = np.diff(since)[:, None], np.diff(impulse, axis=0)
        mean_hold = np.where(step > 0.0, pushed / np.where(step > 0.0, step, 1.0), 0.0)
        self._restrained = float(since[-1]), impulse[-1].copy()
        self._work = states.work[0].copy() if self._work is None else self._work
        works = {form: states.work[:, at] - self._work[at] for form, at in _WORKS.items()}
        reaction = reactions(setting, links)
        seen = contacts(setting, states, links, mean_hold, reaction, self._weightless)
        if (ends := ends_of(setting.strands, setting.supports)) is not None:
            let_yield(setting, ends, states.t, states.X, states.r, states.w, reaction)
        beside, of_loads = (np.zeros((states.t.size, 0, r.shape[1])),) * 2, dict[str, Array]()
        if states.bodies is not None:
            beside = displayed(setting, states.r, states.bodies, seen.state != OFF_LINE)
            of_loads = energies_of_loads(setting, states.bodies)
        energy = self._audit.of(**energies_of_lines(setting, states, links.elastic, w), **of_loads, **works)
        return Frames(
            states.t,
            {
                "position": r.swapaxes(1, 2), "velocity": w.swapaxes(1, 2),
                "tension": links_only(setting, links.T), "strain": links_only(setting, links.eps),
                **seen.fields(), "body_position": beside[0], "body_velocity": beside[1], "reaction": reaction,
                "energy": energy,
            },
        )  # fmt: skip
