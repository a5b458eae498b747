"""From a state of the chain to a frame of the result: material nodes, tensions, contacts, reactions, energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ropewalk.chains import many_frames as many
from ropewalk.chains.load_states import (
    StrandPoints,
    contact_state,
    displayed_bodies,
    light_wheels,
    load_energies,
    located_nodes,
    points_of,
)
from ropewalk.chains.many_bodies import displayed, energies_of_loads
from ropewalk.chains.many_ends import let_yield
from ropewalk.checkpoint import Tree, copied
from ropewalk.mechanics.bodies import (
    ALONG_X,
    CARRIED,
    EVEN,
    FLYING,
    FREE,
    GIVEN,
    LOCATED,
    PARKED,
    WAITING,
    Bodies,
    are_weightless,
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
)
from ropewalk.mechanics.law import stored_total, tensions
from ropewalk.mechanics.moving_contact import force_at, link_of, part_of, speed_at
from ropewalk.results.audit import Audit
from ropewalk.results.frame import MOVES, STICKS, Contacts, Frame, Layout, uniform
from ropewalk.results.frames import Frames
from ropewalk.solve.ends import drives_at, ends_of
from ropewalk.solve.hold_forces import coefficient_used
from ropewalk.solve.start import PreparedRun, onward


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


@dataclass(frozen=True)
class _Segments:
    """Strains, tensions and force vectors of the links of all strands (entries between strands are zero).

    Where a wheel divides a link, its strain and tension are those in its middle, and its force vector is that at the
    support, if it is the last one, else that at its first node.
    """

    eps: Array
    T: Array
    f: Array
    elastic: float
    beside: dict[int, tuple[Array, Array, Array]]  # per wheel: tensions (2,), force vectors and tangents r' (axis, 2)


def _segments(setting: PreparedRun, state: ChainState, bodies: Bodies | None) -> _Segments:
    strands = setting.strands
    r, v, X = state.r, node_velocities(setting, state), state.X
    count = X.size - 1
    eps, T, f, elastic = np.zeros(count), np.zeros(count), np.zeros((r.shape[0], count)), 0.0
    U, beside = mesh_speeds(state), {}
    for s in range(strands.first.size):
        i, j = int(strands.first[s]), int(strands.first[s] + strands.links[s])
        if bodies is None:
            points = StrandPoints(X[i : j + 1], r[:, i : j + 1], v[:, i : j + 1], U[i : j + 1], np.full(j + 1 - i, -1))
        else:
            points = points_of(setting, state, bodies, s, v, U)
        d, rest = np.diff(points.r, axis=1), np.diff(points.X)
        length = np.sqrt((d * d).sum(axis=0))
        strain = length / rest - 1.0
        rate = ((d * np.diff(points.v, axis=1)).sum(axis=0) / length - np.diff(points.U) * length / rest) / rest
        pull = tensions(strands.law[s], strain) + strands.damping[s] * rate
        vector = pull * d / length
        elastic += stored_total(strands.law[s], strain, rest)
        for at in np.flatnonzero(points.wheel >= 0):
            near = slice(at - 1, at + 1)
            beside[int(points.wheel[at])] = pull[near], vector[:, near], d[:, near] / rest[near]
        if rest.size > j - i:  # some link is divided
            homes = X[i : j + 1]
            middle = np.searchsorted(points.X, 0.5 * (homes[1:] + homes[:-1])) - 1
            begin = np.searchsorted(points.X, homes[:-1])
            begin[-1] = rest.size - 1
            eps[i:j], T[i:j], f[:, i:j] = strain[middle], pull[middle], vector[:, begin]
        else:
            eps[i:j], T[i:j], f[:, i:j] = strain, pull, vector
    return _Segments(eps, T, f, elastic, beside)


def mesh_speeds(state: ChainState) -> Array:
    """d X / dt of every node: the speed of the load that it carries, or zero, m/s."""
    U = np.zeros(state.X.size)
    for k, b in enumerate(state.moving_load):
        if b >= 0:
            U[b] = state.speed[k]
    return U


def node_velocities(setting: PreparedRun, state: ChainState) -> Array:
    """Velocities of the nodes themselves: riding nodes move with their loads, m/s."""
    v = state.w.copy()
    for k, b in enumerate(state.moving_load):
        if b >= 0:
            v[:, b] += state.speed[k] * (state.r[:, b + 1] - state.r[:, b - 1]) / (state.X[b + 1] - state.X[b - 1])
    return v


def _material_nodes(setting: PreparedRun, state: ChainState, bodies: Bodies | None) -> tuple[Array, Array]:
    """Positions and velocities of the material nodes: those that ride with loads are looked up on their sub-links."""
    r, w = state.r.copy(), state.w.copy()
    if bodies is not None:
        located_nodes(setting, state, bodies, r, w)
    v = node_velocities(setting, state)
    for k, b in enumerate(state.moving_load):
        if b < 0:
            continue
        s = int(setting.loads.strand[k])
        home = (b - setting.strands.first[s]) * setting.strands.h[s]
        a = b - 1 if home <= state.X[b] else b + 1
        f = (home - state.X[a]) / (state.X[b] - state.X[a])
        tangent = (state.r[:, b] - state.r[:, a]) / (state.X[b] - state.X[a])
        r[:, b] = (1.0 - f) * state.r[:, a] + f * state.r[:, b]
        w[:, b] = (1.0 - f) * state.w[:, a] + f * (v[:, b] - state.speed[k] * tangent)
    return r, w


def _links_only(setting: PreparedRun, values: Array) -> Array:
    """Drop the entries that stand between two strands."""
    keep = [values[int(i) : int(i + n)] for i, n in zip(setting.strands.first, setting.strands.links, strict=True)]
    return np.concatenate(keep)


def _of_lines(setting: PreparedRun, state: ChainState, elastic: float, w: Array) -> dict[str, float]:
    """Kinetic, elastic and gravitational energy of the lines and of what yields or moves with their ends, J.

    Args:
        w: (axis, node) m/s, velocities of the particles.
    """
    strands = setting.strands
    kinetic = gravitational = 0.0
    for s in range(strands.first.size):
        i, j = int(strands.first[s]), int(strands.first[s] + strands.links[s])
        m = strands.rho[s] * strands.h[s]
        kinetic += 0.5 * m * float((w[:, i + 1 : j] ** 2).sum())
        gravitational -= m * float((strands.gravity[:, None] * state.r[:, i + 1 : j]).sum())
        gravitational -= 0.5 * m * float((strands.gravity * (state.r[:, i] + state.r[:, j])).sum())
    ends = ends_of(strands, setting.supports)
    if ends is not None:
        kinetic += 0.5 * float((ends.mass * (state.w[:, ends.node] ** 2).sum(axis=0)).sum())
        r, t = state.r[:, ends.node].T, float(state.t[0])
        for e, number in enumerate(ends.number):
            moved = r[e] - setting.restrained(number // 2, t).place[number % 2]
            elastic += 0.5 * float(moved @ ends.stiffness[e] @ moved)
            gravitational -= float(ends.force[e] @ r[e])
    return {"kinetic": kinetic, "elastic": elastic, "gravitational": gravitational}


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
        setting, loads, bodies = self.setting, self.setting.loads, self.bodies
        segments = _segments(setting, state, bodies)
        r, w = _material_nodes(setting, state, bodies)
        dim, count, t = r.shape[0], state.xi.size, float(state.t[0])
        seen = Contacts(count, dim)
        place, force, hold, both, xi, speed = (
            seen.position, seen.force, seen.hold, seen.tension, seen.xi, seen.speed
        )  # fmt: skip
        reaction = _reactions(setting, segments.f)
        # The hold force of a chain ripples while a load passes a node: its mean since the last frame is reported.
        since, impulse = self._restrained
        mean_hold = (state.hold - impulse) / (t - since) if t > since else np.zeros(count)
        self._restrained = (t, state.hold.copy())
        for k in range(count):
            b = int(state.moving_load[k])
            if bodies is not None:
                seen.state[k] = contact_state(state, bodies, k)
                if b == CARRIED:
                    at = self._of_body(state, bodies, segments, k, float(mean_hold[k]), reaction)
                    place[k], force[k], hold[k], both[k], xi[k], speed[k] = at
                    continue
            if b == OFF:
                continue
            s = int(loads.strand[k])
            F = np.array([force_at(loads, k, t, a) for a in range(dim)])
            if bodies is not None and not self._weightless:
                F = bodies.wheels["on_line"][k, :dim].copy()
            if bodies is None:
                seen.state[k] = MOVES if state.speed[k] != 0.0 else STICKS
            hold[k] = 0.0
            if b >= 0:
                place[k], both[k] = state.r[:, b], segments.T[[b - 1, b]]
                seen.friction[k] = _friction_used(setting, state, segments, k, b)
                if loads.contact[k] == FRICTIONLESS:
                    hold[k, 0] = mean_hold[k]
            else:
                i = int(link_of(setting.strands, loads, state, k))
                part = part_of(state, k, i)
                place[k] = (1.0 - part) * state.r[:, i] + part * state.r[:, i + 1]
                both[k] = segments.T[i]
                for node, share in ((i, 1.0 - part), (i + 1, part)):
                    if node == setting.strands.first[s]:
                        reaction[2 * s] -= share * F
                    elif node == setting.strands.first[s] + setting.strands.links[s]:
                        reaction[2 * s + 1] -= share * F
            force[k] = F + hold[k]
            xi[k], speed[k] = state.xi[k], speed_at(loads, k, t)
        _let_yield(setting, state, reaction)
        of_loads = dict[str, float]()
        beside = np.zeros((0, dim)), np.zeros((0, dim))
        if bodies is not None:
            light_wheels(setting, state, bodies, place)
            seen.in_air, seen.power = bodies.wheels["in_air"].copy(), bodies.wheels["power"].copy()
            of_loads, beside = load_energies(setting, bodies), displayed_bodies(setting, state.r, bodies)
        return Frame(
            path=t,
            position=r.T,
            velocity=w.T,
            tension=_links_only(setting, segments.T),
            strain=_links_only(setting, segments.eps),
            **seen.fields(),
            body_position=beside[0],
            body_velocity=beside[1],
            reaction=reaction,
            energy=self._audit.of(**_of_lines(setting, state, segments.elastic, w), **of_loads, **self._works(state)),
        )

    def build_many(self, states: many.ManyStates) -> Frames:
        """The frames of some states that follow one another, see `many_frames.py`."""
        setting = self.setting
        links, (r, w) = many.ManyLinks.of(setting, states), many.material_nodes(setting, states)
        since, impulse = np.append(self._restrained[0], states.t), np.vstack([self._restrained[1], states.hold])
        step, pushed = np.diff(since)[:, None], np.diff(impulse, axis=0)
        mean_hold = np.where(step > 0.0, pushed / np.where(step > 0.0, step, 1.0), 0.0)
        self._restrained = float(since[-1]), impulse[-1].copy()
        self._work = states.work[0].copy() if self._work is None else self._work
        works = {form: states.work[:, at] - self._work[at] for form, at in _WORKS.items()}
        reaction = many.reactions(setting, links)
        seen = many.contacts(setting, states, links, mean_hold, reaction)
        if (ends := ends_of(setting.strands, setting.supports)) is not None:
            let_yield(setting, ends, states.t, states.X, states.r, states.w, reaction)
        beside, of_loads = (np.zeros((states.t.size, 0, r.shape[1])),) * 2, dict[str, Array]()
        if states.bodies is not None:
            beside, of_loads = displayed(setting, states.r, states.bodies), energies_of_loads(setting, states.bodies)
        energy = self._audit.of(**many.energies_of_lines(setting, states, links.elastic, w), **of_loads, **works)
        return Frames(
            states.t,
            {
                "position": r.swapaxes(1, 2), "velocity": w.swapaxes(1, 2),
                "tension": many.links_only(setting, links.T), "strain": many.links_only(setting, links.eps),
                **seen.fields(), "body_position": beside[0], "body_velocity": beside[1], "reaction": reaction,
                "energy": energy,
            },
        )  # fmt: skip

    def _of_body(
        self, state: ChainState, bodies: Bodies, segments: _Segments, k: int, mean_hold: float, reaction: Array
    ) -> tuple[Array, Array, Array, Array, float, float]:
        """Place, force on the line, hold force, tensions, xi and speed of a wheel that has its own place."""
        record, dim, s = bodies.wheels[k], state.r.shape[0], int(self.setting.loads.strand[k])
        place, force, hold, both = record["r"][:dim].copy(), np.zeros(dim), np.zeros(dim), np.full(2, np.nan)
        phase, xi, speed = int(record["phase"]), float(state.xi[k]), float(speed_at(self.setting.loads, k, state.t[0]))
        if phase == WAITING:
            return place, force, hold, both, np.nan, speed
        if phase == FLYING:
            return place, force, hold, both, xi, float(record["v"][:dim] @ onward(self.setting, state.r, s))
        if phase == PARKED:
            force = record["on_line"][:dim].copy()
            i = int(record["at"])
            reaction[2 * s + (0 if i == self.setting.strands.first[s] else 1)] -= force
            return place, force, hold, np.repeat(segments.T[i], 2), xi, speed
        both, vector, tangent = segments.beside[k]
        U = float(state.speed[k])
        force = vector[:, 0] - vector[:, 1] + self.setting.strands.rho[s] * U * U * (tangent[:, 1] - tangent[:, 0])
        if phase == LOCATED:  # the weight of the particle that it carries is the line's own
            force -= self.setting.strands.rho[s] * self.setting.strands.h[s] * self.setting.strands.gravity
        if record["travel"] in (EVEN, ALONG_X):
            hold[0] = mean_hold
        elif record["travel"] == GIVEN:  # what the line is gripped with
            mean = tangent.sum(axis=1)
            mean = mean / np.linalg.norm(mean)
            hold = (force @ mean) * mean
        if record["travel"] == FREE:
            speed = U * float(np.linalg.norm(tangent, axis=0).mean())
        return place, force, hold, both, xi, speed

    def _works(self, state: ChainState) -> dict[str, float]:
        """Works since the first frame, J."""
        self._work = state.work.copy() if self._work is None else self._work
        return {form: float(state.work[at] - self._work[at]) for form, at in _WORKS.items()}


def _reactions(setting: PreparedRun, f: Array) -> Array:
    """Forces of the supports on the lines (support, axis), N, before the loads that stand on supports."""
    strands = setting.strands
    out = []
    for s in range(strands.first.size):
        i, j = int(strands.first[s]), int(strands.first[s] + strands.links[s])
        half = 0.5 * strands.rho[s] * strands.h[s] * strands.gravity
        out += [-f[:, i] - half, f[:, j - 1] - half]
    return np.array(out)


def _let_yield(setting: PreparedRun, state: ChainState, reaction: Array) -> None:
    """Make reactions of points that do not move, changed in place, those of supports that yield or move.

    On half a link at the end act the line, the loads there, and the reaction; the latter is all that the line knows of
    spring, damper, rail and mass.
    """
    strands, supports, t = setting.strands, setting.supports, float(state.t[0])
    ends = ends_of(strands, supports)
    if ends is None:
        return
    drives = drives_at(ends, t)
    for e, number in enumerate(ends.number):
        i, s = ends.node[e], number // 2
        drag = strands.drag[s] * ends.half[e] * state.w[:, i]
        # Beside a load, the link that the end carries half of is not uniform.
        uneven = 0.5 * strands.rho[s] * float(np.diff(state.X[ends.link[e] : ends.link[e] + 2])[0]) - ends.half[e]
        reaction[number] += drag - uneven * strands.gravity
        if ends.free[e]:
            place = setting.restrained(int(s), t).place[number % 2]
            given = ends.force[e] + ends.stiffness[e] @ (place - state.r[:, i])
            given += supports.damping[number] @ (drives[:, e] - state.w[:, i])
            push = supports.free[number] @ (given - reaction[number])
            reaction[number] += ends.half[e] / ends.mass[e] * push


def _friction_used(setting: PreparedRun, state: ChainState, segments: _Segments, k: int, b: int) -> float:
    """Friction coefficient that the pulls beside a riding node need, less what turns the passing material."""
    s, U = setting.loads.strand[k], float(state.speed[k])
    flux = float(setting.strands.rho[s]) * U * U / np.diff(state.X[b - 1 : b + 2])
    behind, ahead = (segments.f[:, b - 1 : b + 1] - flux * np.diff(state.r[:, b - 1 : b + 2], axis=1)).T
    sizes = np.linalg.norm(behind), np.linalg.norm(ahead)
    if not min(sizes) > 0.0:
        return float("inf")
    turn = np.arccos(np.clip(behind @ ahead / (sizes[0] * sizes[1]), -1.0, 1.0))
    return float(coefficient_used(setting.loads.friction_model[k], np.log(sizes[1] / sizes[0]), turn))
