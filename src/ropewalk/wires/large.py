"""Large motion of wires, explicit: nodes move along, up and (in space) sideways; tensions follow from the stretch.

Störmer's method for all components. The stencil corrects the dispersion of transverse waves as in small motion. Waves
along the wires are tens of times faster than all else: the wires and what holds them alone follow them by inner steps,
while ties and moving loads push once in each step (docs/notes/wires.md).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ropewalk.checkpoint import Arrays, Changing, arrays_of
from ropewalk.mechanics.compiled import entry_of, inlined, lean, lean_inner
from ropewalk.mechanics.notes import Notes, numbers_of, write_note
from ropewalk.wires.absorbing_layer import absorb
from ropewalk.wires.damping import EVERY
from ropewalk.wires.large_window import Following, follow_waves
from ropewalk.wires.mesh import Mesh, MovingLoads, places_of
from ropewalk.wires.moving_loads import (
    CHANGES,
    DAMPED,
    advance_moving_loads,
    begin,
    between,
    between_rows,
    contact_force,
    enforce_contact,
    local_at,
    local_under,
    note,
    settle_accounts,
    stepping_of,
    sweeps_of,
)
from ropewalk.wires.plan import Array, Integers
from ropewalk.wires.restraints import MOVES, constraint, coordinates, holders_of, move_places, restrain
from ropewalk.wires.spline import WIDTH, weights
from ropewalk.wires.springs import add_tie_forces, link_springs_of, steady_of
from ropewalk.wires.step_inputs import ABSENT, ON_WIRE, Record, StepInputs
from ropewalk.wires.threads import components, threads_of
from ropewalk.wires.window_places import window_places
from ropewalk.wires.wire_steps import are_strains_small, lost_in_wires, move_wires

_CLOSE = 1e-9  # links: how closely a place of given x is sought


@inlined
def _seek(x, s, n, place, w):
    """Place in links on a wire, whose nodes have the coordinates x, where its x is `place`: from s, by Newton."""
    base = weights(s, n, w)
    for _ in range(20):
        here, slope = 0.0, 0.0
        for j in range(WIDTH):
            here += w[0, j] * x[base + j]
            slope += w[1, j] * x[base + j]
        step = (place - here) / slope
        s = min(max(s + step, 0.0), float(n))
        base = weights(s, n, w)
        if abs(step) < _CLOSE:
            break
    return s, base


@inlined
def _location(strands, moving_loads, stepping, x, z, inputs, row, part, k, w):
    """Where contact k is on its wire, whose nodes are at x and z: whether there, links, first node, height, and slope.

    Before the start and beyond the end there is level ground, as high as these. The slope is one per link.
    """
    a, place, height, slope = moving_loads.wire[k], between(inputs.station, row, part, k), 0.0, 0.0
    first, n, h = strands.first[a], strands.links[a], strands.h[a]
    s, base = min(max(place / h, 0.0), float(n)), 0
    on = abs(s - place / h) < _CLOSE
    if moving_loads.material[k] or not on:
        base = first + weights(s, n, w)
    else:
        guess = stepping.place[k] if np.isfinite(stepping.place[k]) else s
        begin, end = strands.across[a, 0], strands.across[a, 1]
        s, base = _seek(x[first : first + n + 1], min(max(guess, 0.0), float(n)), n, begin + end * place, w)
        stepping.place[k] = s
        base += first
    for j in range(WIDTH):
        height += w[0, j] * z[base + j]
        slope += w[1, j] * z[base + j]
    return on, s, base, height, slope


@inlined
def _touch(strands, threads, moving_loads, stepping, now, other, inputs, record, row, step, steps, k, w):
    """What contact k does during a step."""
    part, up, local = step / steps, now.shape[0] - 1, 0.0
    if inputs.where[row, k] == ABSENT:
        return
    on, s, base, height, slope = _location(strands, moving_loads, stepping, now[0], now[up], inputs, row, part, k, w)
    if on:
        local = local_under(strands, moving_loads, k, s)
    given, rough = between(inputs.given, row, part, k), between(inputs.rough, row, part, k)
    aside = between(inputs.aside, row, part, k)
    force = given + contact_force(moving_loads, stepping, k, height + rough, local, aside)
    note(moving_loads, stepping, record, row, step, k, height, s, slope, given, force, local, rough, aside)
    if on:
        for j in range(WIDTH):
            other[up, base + j] += threads.kick[up, base + j] * w[0, j] * force


@inlined
def _join(strands, threads, moving_loads, stepping, other, inputs, record, row, step, steps, k, w):
    """What keeps the rigid contact k together at the end of a step."""
    part, up, soft, local = (step + 1.0) / steps, other.shape[0] - 1, 0.0, 0.0
    if inputs.where[row, k] == ABSENT:
        return
    on, s, base, height, _ = _location(strands, moving_loads, stepping, other[0], other[up], inputs, row, part, k, w)
    if on:
        local = max(local_at(strands, moving_loads.wire[k], s), 0.0)
        for j in range(WIDTH):
            soft += w[0, j] * w[0, j] * threads.gain[up, base + j]
    force = enforce_contact(moving_loads, stepping, k, height + between(inputs.rough, row, part, k), soft, local)
    if step == 0:
        record.force[row, k] += force
    if on:
        for j in range(WIDTH):
            other[up, base + j] += threads.gain[up, base + j] * w[0, j] * force


@lean
def advance(strands, threads, link_springs, holders, window, still, watched, moving_loads, stepping, level, slope, now,
            other, buffers, q, inner, inputs, record, steps, sweeps, both, notes, w):  # fmt: skip
    """Go on by all rows of the record, of one output instant after the other, which come first in inputs and record.

    Args:
        both: (instant, 2, axis, node) m, takes positions at each instant and an inner step before; without instants,
            nothing is noted.
        notes: of the rest.
    """
    rows = record.force.shape[1] * steps * inner
    for i in range(record.force.shape[0]):
        if i < both.shape[0]:
            for a in range(now.shape[0]):
                for j in range(now.shape[1]):
                    both[i, 0, a, j], both[i, 1, a, j] = now[a, j], other[a, j]
            write_note(notes)
        given = StepInputs(inputs.station[i], inputs.where[i], inputs.rough[i], inputs.given[i], inputs.push[i],
                           inputs.time[i], inputs.aside[i])  # fmt: skip
        found = Record(record.force[i], record.height[i], record.body[i], record.tie[i], record.hold[i],
                       record.watched[i])  # fmt: skip
        small = are_strains_small(strands, threads, window, now)
        _advance_rows(strands, threads, link_springs, holders, window, still, watched, moving_loads, stepping, level,
                      slope, now, other, buffers, q, small, inner, given, found, steps, sweeps, w)  # fmt: skip
        if rows % 2 == 1:
            now, other = other, now


@lean_inner
def _advance_rows(strands, threads, link_springs, holders, window, still, watched, moving_loads, stepping, level, slope,
                  now, other, buffers, q, small, inner, inputs, record, steps, sweeps, w):  # fmt: skip
    """Go on by all rows of the record.

    Args:
        window: what moves.
        still: (axis, node) m, positions at rest.
        level: (node,) m, heights at which beds are without force.
        slope: (end, axis) m, differences of the first two nodes that clamped ends ask for.
        now, other: (axis, node) m, at the present instant and a step before it; they change places with every step.
        buffers, q: (node,) room.
        small: whether all strains are below SMALL_STRAIN.
        inner: steps of the wires alone in each step.
        steps: in each row.
        sweeps: over all that is rigid, in each step.
        w: (3, WIDTH) room for weights of a spline.
    """
    axes, whole, dt = now.shape[0], record.force.shape[0] * steps, stepping.step / inner
    every = min(max(1, EVERY // inner), max(1, whole // 4))
    for row in range(record.force.shape[0]):
        for p in window.watched:
            for k in range(WIDTH):
                i = watched.base[p] + k
                record.watched[p, row] += watched.weight[p, k] * (now[axes - 1, i] - still[axes - 1, i])
        for i in range(moving_loads.size.size):
            for c in range(moving_loads.size[i]):
                record.body[row, i, c] = stepping.q[i, c]
        for step in range(steps):
            move_places(holders, between_rows(inputs.time, row, (step + 1.0 / inner) / steps))
            move_wires(strands, threads, window, now, other, buffers, q, level, slope, small, dt)
            t = between_rows(inputs.time, row, step / steps)
            add_tie_forces(link_springs, window.slow, now, other, threads.kick, stepping.step, stepping.work,
                           record.tie, row, step == 0, t)  # fmt: skip
            add_tie_forces(link_springs, window.fast, now, other, threads.gain, dt, stepping.work, record.tie,
                           row, step == 0, t)  # fmt: skip
            begin(moving_loads, stepping, inputs.push, row, step / steps)
            for k in range(moving_loads.owner.size):
                _touch(strands, threads, moving_loads, stepping, now, other, inputs, record, row, step, steps, k, w)
            advance_moving_loads(moving_loads, stepping)
            restrain(holders, window.elastic[0], window.elastic[1], now, other, threads.gain, dt, stepping.work,
                     record.hold, row, step == 0)  # fmt: skip
            for sweep in range(sweeps):
                constraint(holders, window.rigid[0], window.rigid[1], other, threads.gain, stepping.work, record.hold,
                           row, step == 0, sweep == 0)  # fmt: skip
                for k in range(moving_loads.owner.size):
                    if np.isinf(moving_loads.spring[k]):
                        _join(strands, threads, moving_loads, stepping, other, inputs, record, row, step, steps, k, w)
            settle_accounts(moving_loads, stepping)
            absorb(strands, window, threads.mass[axes - 1], now, other, 1, dt, stepping.step, stepping.work, 1)
            follow_waves(window, still, now, other, dt, stepping.work)
            gone = row * steps + step
            now, other = other, now
            for part in range(inner):
                if part > 0:
                    move_places(holders, between_rows(inputs.time, row, (step + (part + 1.0) / inner) / steps))
                    move_wires(strands, threads, window, now, other, buffers, q, level, slope, small, dt)
                    add_tie_forces(link_springs, window.fast, now, other, threads.gain, dt, stepping.work,
                                   record.tie, row, False, t)  # fmt: skip
                    restrain(holders, window.elastic[0], window.elastic[1], now, other, threads.gain, dt, stepping.work,
                             record.hold, row, False)  # fmt: skip
                    constraint(holders, window.rigid[0], window.rigid[1], other, threads.gain, stepping.work,
                               record.hold, row, False, True)  # fmt: skip
                    follow_waves(window, still, now, other, dt, stepping.work)
                    now, other = other, now
                if part == inner // 2 and threads.damped and gone % every == 0:  # in the middle between two pushes
                    lost = lost_in_wires(strands, threads, window, now, other, dt)
                    stepping.work[DAMPED] += min(every, whole - gone) * stepping.step * lost


class LargeMotion(Changing):
    """A motion in the plane, or in space, under way.

    Args:
        mesh: the wires and what is attached to them.
        position: (3, node) m at rest.
        rest: (node,) m, unstrained length of the link behind each node.
        moving_loads: what travels.
        step: s.
        q: (moving load, C) m, first coordinates, at rest.
        inner: steps of the wires alone in each step; 1 where contacts are rigid.
        inertia: factor on the mass for motion along x, which lets the step grow by its root.
        space: whether anything moves sideways.
        window: half width of what moves around the contacts, m; everything if infinite.
        hold_at_rest: (hold, 3) N, forces of all holds at rest; needed where a window is finite.
    """

    def __init__(
        self, mesh: Mesh, position: Array, rest: Array, moving_loads: MovingLoads, step: float, q: Array,
        inner: int = 1, inertia: float = 1.0, *, space: bool = False, window: float = np.inf,
        hold_at_rest: Array | None = None,
    ) -> None:  # fmt: skip
        self.mesh, self.moving_loads, self.rest, axes = mesh, moving_loads, rest, [0, 1, 2] if space else [0, 2]
        self.inertia, self.inner = inertia, inner
        self.threads = threads_of(mesh, position[axes], rest, step / inner, inner, inertia)
        self.link_springs = link_springs_of(mesh, position)
        steady = steady_of(self.link_springs, mesh.nodes)
        self.threads.fall[1:] += (steady if space else steady[1:]) * self.threads.gain[1:]
        self.holders = holders_of(mesh, self.threads.gain, axes, position[axes], mesh.holds.place)
        self.stepping = stepping_of(moving_loads, step, q, np.full(moving_loads.owner.size, np.nan))
        self.watched = places_of(mesh.strands, list(mesh.plan.watched.values()))
        straight = mesh.straight()[axes]
        self._level, ends = np.ascontiguousarray(straight[-1]), mesh.strands.first + mesh.strands.links
        self._slope = np.empty((2 * ends.size, len(axes)))
        self._slope[0::2] = (straight[:, mesh.strands.first + 1] - straight[:, mesh.strands.first]).T
        self._slope[1::2] = (straight[:, ends - 1] - straight[:, ends]).T
        self._r = [np.ascontiguousarray(position[axes]) for _ in range(2)]  # now, a step before
        self._side = position[1].copy()
        self._still, self._of_holds = position[axes], hold_at_rest
        self.set_window(window)
        self._buffers = np.zeros(mesh.nodes), np.zeros(mesh.nodes)
        self.tie_at_rest = self.link_springs.rest
        self._w = np.zeros((3, WIDTH))
        self._advance: Callable[..., object] | None = None

    def set_window(self, window: float) -> None:
        """Let only what is so far around the contacts move from now on, m; everything if infinite."""
        step = self.stepping.step / self.inner
        self.window = Following(
            self.mesh, self._still, window, step, self.inertia, self.link_springs, self.holders, self.watched
        )
        self.hold_at_rest = self.mesh.holds.force if self._of_holds is None or self.window.is_whole else self._of_holds

    def begin(self, position: Array, velocity: Array) -> None:
        """Go on from positions in m and velocities of half an inner step before in m/s, (3, node)."""
        axes, step = components(self._r[0]), self.stepping.step
        self._r[0][:] = position[axes]
        self._r[1][:] = self._r[0] - velocity[axes] * (step / self.inner)
        self.link_springs.last[:] = link_springs_of(self.mesh, position - step * velocity).last
        self.holders.here[:], self.holders.last[:] = (coordinates(self.holders, r) for r in self._r)

    @property
    def position(self) -> Array:
        """Positions of all nodes now, (3, node) m."""
        self.window.settle(self._r)
        return self._spread(self._r[0], self._side)

    @property
    def velocity(self) -> Array:
        """Velocities of all nodes half an inner step ago, (3, node) m/s."""
        self.window.settle(self._r)
        return self._spread((self._r[0] - self._r[1]) * (self.inner / self.stepping.step), np.zeros_like(self._side))

    @property
    def failed(self) -> Array:
        """(tie, 2) when ties failed, s, and under which force, N; infinite: they have not."""
        return self.link_springs.failed

    def piece(self, part: slice) -> tuple[Array, Array]:
        """Positions in m and velocities in m/s of some nodes, (3, node)."""
        now, last = self._r[0][:, part], self._r[1][:, part]
        rate = (now - last) * (self.inner / self.stepping.step)
        side = self._side[part]
        return self._spread(now, side), self._spread(rate, np.zeros_like(side))

    @property
    def both(self) -> list[Array]:
        """Positions of all nodes now and an inner step ago, (3, node) m."""
        self.window.settle(self._r)
        return [self._spread(r, self._side) for r in self._r]

    def seen(self, both: Array) -> tuple[Array, Array]:
        """Positions in m and velocities in m/s of all nodes, (instant, 3, node), whatever `both` was at these instants.

        Args:
            both: (instant, 2, 3, node) m.
        """
        return both[:, 0], (both[:, 0] - both[:, 1]) * (self.inner / self.stepping.step)

    def _changing(self) -> dict[str, Arrays]:
        """Arrays that change; the present and the last instant in this order, whichever array holds them."""
        now, last = self._r
        springs = arrays_of(self.link_springs, "last", "rate", "failed")
        return {
            "pace": arrays_of(self.stepping, *CHANGES), "springs": springs, "holders": arrays_of(self.holders, *MOVES),
            "nodes": {"now": now, "last": last}, "window": self.window.changing(),
        }  # fmt: skip

    def _spread(self, values: Array, aside: Array) -> Array:
        return values.copy() if values.shape[0] == 3 else np.vstack([values[0], aside, values[1]])

    def strain(self, position: Array) -> Array:
        """Strain of the links behind all nodes at positions (..., axis, node) in m (of last nodes: without meaning)."""
        step = np.diff(position, axis=-1, append=position[..., -1:])
        return np.asarray(np.sqrt((step**2).sum(axis=-2)) / self.rest - 1.0)

    def go(self, inputs: StepInputs, steps: int = 1) -> Record:
        """Go on by the rows of the drive but the last, `steps` steps each."""
        record = self._go(inputs.together(), steps, np.zeros((0, 2, 0, 0)), self.empty_notes(0)).first()
        if not self.window.is_whole:  # of what stands still nothing was recorded: it is counted from rest
            near = self.window.holds_within()
            record.hold[:, near] += (self.mesh.holds.force - self.hold_at_rest)[near]
        return record

    def through(self, inputs: StepInputs, steps: int, both: Array, notes: Notes) -> Record:
        """Go on by the rows of the drive but the last, of one output instant after the other, which come first.

        Args:
            inputs: with the instants before all rows; the window is all that there is.
            steps: in each row.
            both: (instant, 2, 3, node) m, takes positions at each instant and an inner step before.
            notes: `empty_notes` for the rest.
        """
        axes = components(self._r[0])
        own = np.empty((len(both), 2, *self._r[0].shape))
        record = self._go(inputs, steps, own, notes)
        both[:, :, 1] = self._side
        both[:, :, axes] = own
        return record

    @property
    def sources(self) -> list[Array]:
        """What is noted at an instant besides positions, in the order of `Then`."""
        stepping = self.stepping
        own = [stepping.q, stepping.last, stepping.here, stepping.before, stepping.work]
        return [*own, self.holders.moved, self.link_springs.failed]

    @property
    def tie_number(self) -> Integers:
        """Number of the tie of each spring."""
        return np.arange(self.link_springs.length.size)

    def empty_notes(self, most: int) -> Notes:
        """Room for notes of some instants."""
        return Notes.empty(numbers_of(self.sources), most)

    def _go(self, inputs: StepInputs, steps: int, both: Array, notes: Notes) -> Record:
        plan, on = self.mesh.plan, inputs.where == ON_WIRE
        instants, rows = inputs.time.shape[0], inputs.time.shape[1] - 1
        record = Record.of(rows, self.moving_loads, len(plan.ties), len(plan.holds), self.watched, instants)
        wires = np.broadcast_to(self.moving_loads.wire, on.shape)[on]
        x = window_places(self.mesh, wires, inputs.station[on], float(inputs.time.max()))
        window = self.window.around(x, self._r, self.threads.mass, self.stepping.work)
        arguments = (
            self.mesh.strands, self.threads, self.link_springs, self.holders, window, self.window.still, self.watched,
            self.moving_loads, self.stepping, self._level, self._slope, *self._r, *self._buffers, self.inner, inputs,
            record, steps, sweeps_of(self.moving_loads, self.holders.fast), both, notes, self._w,
        )  # fmt: skip
        if self._advance is None:
            self._advance = entry_of(advance, arguments)
        self._advance(*arguments)
        if instants * rows * steps * self.inner % 2:
            self._r.reverse()
        return record.turned()
