"""Small vertical motion of wires about their rest, explicit: constant tensions, droppers that slacken, moving loads.

Störmer's method, with a stencil whose bending stiffness is corrected so that waves on a string travel with the right
speed to the fourth order in mesh and step (docs/notes/wires.md).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ropewalk.checkpoint import Arrays, Changing, arrays_of
from ropewalk.mechanics.compiled import entry_of, inlined, lean, lean_inner
from ropewalk.mechanics.notes import Notes, numbers_of, write_note
from ropewalk.wires.absorbing_layer import absorb, layers
from ropewalk.wires.damping import EVERY
from ropewalk.wires.mesh import Mesh, MovingLoads, Places, places_of
from ropewalk.wires.moving_loads import (
    CHANGES,
    DAMPED,
    MOVED,
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
from ropewalk.wires.rest import WiresAtRest
from ropewalk.wires.restraints import (
    A_STEP_AGO,
    AHEAD,
    MOVES,
    NOW,
    coordinate,
    coordinates,
    give_way,
    holders_of,
    move_places,
    restrain,
    write_force,
)
from ropewalk.wires.small_arrays import Springs, Watched, WireWindow, springs_of, stencil_of, x_of
from ropewalk.wires.small_springs import add_spring_forces
from ropewalk.wires.small_stencil import losses, move
from ropewalk.wires.spline import WIDTH, weights_between
from ropewalk.wires.step_inputs import ABSENT, ON_WIRE, Record, StepInputs
from ropewalk.wires.window_places import window_places

_NOTHING = 1e-150  # m
_CLOSE = 1e-9  # links, beyond an end: nothing
_LATE = 0.5  # share of the next and of the last instant in what rigid holds keep
_HALF_PAGE = 256  # numbers of 8 bytes


@lean
def advance(strands, stencil, springs, holders, window, watched, moving_loads, stepping, level, now, other, buffers,
            inputs, record, steps, sweeps, both, notes, w):  # fmt: skip
    """Go on by all rows of the record, of one output instant after the other, which come first in inputs and record.

    Args:
        both: (instant, 2, node) m, takes displacements at each instant and a step before; without instants, nothing is
            noted.
        notes: of the rest.
    """
    rows = record.force.shape[1] * steps
    for i in range(record.force.shape[0]):
        if i < both.shape[0]:
            for j in range(now.size):
                both[i, 0, j], both[i, 1, j] = now[j], other[j]
            write_note(notes)
        given = StepInputs(inputs.station[i], inputs.where[i], inputs.rough[i], inputs.given[i], inputs.push[i],
                           inputs.time[i], inputs.aside[i])  # fmt: skip
        found = Record(record.force[i], record.height[i], record.body[i], record.tie[i], record.hold[i],
                       record.watched[i])  # fmt: skip
        _advance_rows(strands, stencil, springs, holders, window, watched, moving_loads, stepping, level, now, other,
                      buffers, given, found, steps, sweeps, w)  # fmt: skip
        if rows % 2 == 1:
            now, other = other, now


@lean_inner
def _advance_rows(strands, stencil, springs, holders, window, watched, moving_loads, stepping, level, now, other,
                  buffers, inputs, record, steps, sweeps, w):  # fmt: skip
    """Go on by all rows of the record.

    Args:
        level: (node,) m, heights at rest.
        now, other, buffers: (node,) m above rest, at the present instant and a step before it, which change places with
            every step; and room.
        steps: in each row.
        sweeps: over all that is rigid, in each step.
        w: (3, WIDTH) room for weights of a spline.
    """
    whole = record.force.shape[0] * steps
    every = min(EVERY, max(1, whole // 4))
    # What holds do is written for several axes; here it is one. Arrays take this shape once: in each step it costs.
    here, ahead, gain = now.reshape(1, -1), other.reshape(1, -1), stencil.gain.reshape(1, -1)
    for row in range(record.force.shape[0]):
        _look(watched, window, now, record.watched, row)
        for i in range(moving_loads.size.size):
            for c in range(moving_loads.size[i]):
                record.body[row, i, c] = stepping.q[i, c]
        for step in range(steps):
            move_places(holders, between_rows(inputs.time, row, (step + 1.0) / steps))
            move(strands, stencil, window, now, other, buffers, stepping.step)
            t = between_rows(inputs.time, row, step / steps)
            add_spring_forces(springs, window, now, other, stencil.gain, stepping, record, row, step, t)
            begin(moving_loads, stepping, inputs.push, row, step / steps)
            for k in range(moving_loads.owner.size):
                _touch(
                    strands,
                    moving_loads,
                    stepping,
                    level,
                    now,
                    other,
                    stencil.gain,
                    inputs,
                    record,
                    row,
                    step,
                    steps,
                    k,
                    w,
                )
            advance_moving_loads(moving_loads, stepping)
            restrain(holders, window.elastic[0], window.elastic[1], here, ahead, gain, stepping.step, stepping.work,
                     record.hold, row, step == 0)  # fmt: skip
            gone = row * steps + step
            count = min(every, whole - gone) if gone % every == 0 else 0  # steps whose losses are looked at here
            absorb(strands, window, stencil.mass, here, ahead, 0, stepping.step, stepping.step, stepping.work, count)
            for sweep in range(sweeps):
                _constraint(holders, window, here, ahead, gain, stepping.work, record, row, step, sweep == 0)
                for k in range(moving_loads.owner.size):
                    if np.isinf(moving_loads.spring[k]):
                        _join(
                            strands,
                            moving_loads,
                            stepping,
                            level,
                            other,
                            stencil.gain,
                            inputs,
                            record,
                            row,
                            step,
                            steps,
                            k,
                            w,
                        )
            _stand(strands, window, now, other)
            settle_accounts(moving_loads, stepping)
            if stencil.damped and count > 0:
                lost = losses(strands, stencil, window, now, other, buffers, stepping.step)
                stepping.work[DAMPED] += count * lost
            now, other = other, now
            here, ahead = ahead, here


@inlined
def _look(watched, window, now, found, row):
    for e in range(window.watched[0], window.watched[1]):
        for k in range(WIDTH):
            found[watched.number[e], row] += watched.weight[e, k] * now[watched.base[e] + k]


@inlined
def _stand(strands, window, now, other):
    """Let nodes beyond the borders of the window stand still, whatever ties and holds did to them."""
    for a in range(strands.first.size):
        first, n = strands.first[a], window.beyond[a]
        low, high, end = first + window.low[a], first + window.high[a], first + strands.links[a] + 1
        for i in range(max(low - n, first), low):
            other[i] = now[i]
        for i in range(high, min(high + n, end)):
            other[i] = now[i]


@inlined
def _location(strands, moving_loads, level, moved, inputs, row, part, k, w):
    """Where contact k is: whether on its wire, links along it, first node, height, and slope per link.

    Before the start and beyond the end there is level ground, as high as these.
    """
    a, height, slope = moving_loads.wire[k], 0.0, 0.0
    place, n = between(inputs.station, row, part, k) / strands.h[a], strands.links[a]
    s = min(max(place, 0.0), float(n))
    base = strands.first[a] + weights_between(s, n, strands.level[a, 0], strands.level[a, 1], w)
    for j in range(WIDTH):
        z = level[base + j] + moved[base + j]
        height += w[0, j] * z
        slope += w[1, j] * z
    return abs(s - place) < _CLOSE, s, base, height, slope


@inlined
def _touch(strands, moving_loads, stepping, level, now, other, gain, inputs, record, row, step, steps, k, w):
    """What contact k does during a step."""
    part, local = step / steps, 0.0
    if inputs.where[row, k] == ABSENT:
        return
    on, s, base, height, slope = _location(strands, moving_loads, level, now, inputs, row, part, k, w)
    if on:
        local = local_under(strands, moving_loads, k, s)
    given, rough = between(inputs.given, row, part, k), between(inputs.rough, row, part, k)
    aside = between(inputs.aside, row, part, k)
    force = given + contact_force(moving_loads, stepping, k, height + rough, local, aside)
    note(moving_loads, stepping, record, row, step, k, height, s, slope, given, force, local, rough, aside)
    if on:
        for j in range(WIDTH):
            other[base + j] += gain[base + j] * w[0, j] * force


@inlined
def _constraint(holders, window, now, other, gain, work, record, row, step, begins):
    """What rigid holds do at the end of a step: they keep the mean over three instants, which costs no energy."""
    for e in range(window.fast[0], window.fast[1]):
        if begins:
            holders.last[e], holders.here[e], holders.force[e] = holders.here[e], coordinate(holders, e, now), 0.0
        moved = holders.moved[e]
        late, height = moved[A_STEP_AGO] + moved[AHEAD], coordinate(holders, e, other)
        mean = _LATE * (height + holders.last[e] - late) + (1.0 - 2.0 * _LATE) * (holders.here[e] - moved[NOW])
        local = holders.local[e]
        F = -(mean + local * holders.force[e]) / (local + _LATE * (holders.soft[e] - local))
        holders.force[e] += F
        work[MOVED] += 0.5 * F * (moved[AHEAD] - moved[A_STEP_AGO])
        if step == 0:
            write_force(holders, e, F, record.hold, row)
        give_way(holders, e, other, gain, F)


@inlined
def _join(strands, moving_loads, stepping, level, other, gain, inputs, record, row, step, steps, k, w):
    """What keeps the rigid contact k together at the end of a step."""
    part, soft, local = (step + 1.0) / steps, 0.0, 0.0
    if inputs.where[row, k] == ABSENT:
        return
    on, s, base, height, _ = _location(strands, moving_loads, level, other, inputs, row, part, k, w)
    if on:
        local = max(local_at(strands, moving_loads.wire[k], s), 0.0)
        for j in range(WIDTH):
            soft += w[0, j] * w[0, j] * gain[base + j]
    force = enforce_contact(moving_loads, stepping, k, height + between(inputs.rough, row, part, k), soft, local)
    if step == 0:
        record.force[row, k] += force
    if on:
        for j in range(WIDTH):
            other[base + j] += gain[base + j] * w[0, j] * force


class SmallMotion(Changing):
    """A motion about rest under way.

    Args:
        mesh: the wires and what is attached to them.
        rest: their rest.
        moving_loads: what travels.
        step: time step, s.
        q: (moving load, C) m, first coordinates, at rest.
        window: half width of what moves around the contacts, m; everything if infinite.
    """

    def __init__(
        self, mesh: Mesh, rest: WiresAtRest, moving_loads: MovingLoads, step: float, q: Array, window: float = np.inf
    ) -> None:
        self.mesh, self.rest, self.moving_loads, strands = mesh, rest, moving_loads, mesh.strands
        self.stencil = stencil_of(mesh, step)
        self.stepping = stepping_of(moving_loads, step, q, np.zeros(moving_loads.owner.size))
        springs = springs_of(mesh, rest)
        order = np.argsort(springs.x, kind="stable")
        self.springs = Springs(*(np.ascontiguousarray(array[order]) for array in springs))  # type: ignore[arg-type]
        blank = np.zeros((1, mesh.nodes))
        self.holders = holders_of(mesh, self.stencil.gain[None], [2], blank, np.zeros_like(mesh.holds.place))
        self._sweeps = sweeps_of(moving_loads, self.holders.fast)
        self.level = np.ascontiguousarray(rest.position[2])
        self.watched = places_of(mesh.strands, list(mesh.plan.watched.values()))
        self._watched = _looked_at(mesh, self.watched)
        self.tie_at_rest = np.maximum(rest.tie_force, 0.0)
        self.hold_at_rest = np.zeros((rest.hold_force.size, 3))
        self.hold_at_rest[:, 2] = rest.hold_force
        # Not quite zero: what arrives early of a wave is below the smallest normal number, and slow to compute with.
        nothing = np.where(self.stencil.gain > 0.0, _NOTHING, 0.0)
        self._u = _apart(nothing)  # now, a step before
        self._buffers, self._w = np.zeros(mesh.nodes), np.zeros((3, WIDTH))
        fast, count = self.holders.fast, self.holders.x.size
        whole = (0, self.springs.x.size), (0, fast), (fast, count), (0, self._watched.x.size)
        laden = np.stack([self.stencil.first[:-1], self.stencil.first[1:]], axis=1)
        self._beyond = np.ceil(WIDTH * (strands.h.max() / strands.h + 1.0)).astype(np.int64)
        self._whole = WireWindow(
            np.zeros_like(strands.links), strands.links + 1, *layers(mesh, np.inf), self._beyond, laden, *whole
        )
        self.set_window(window)
        self._advance: Callable[..., object] | None = None

    def set_window(self, window: float) -> None:
        """Let only what is so far around the contacts move from now on, m; everything if infinite."""
        self.window, self._layers = window, layers(self.mesh, window)
        self._low, self._high = self._whole.low, self._whole.high  # what moved last

    def begin(self, u: Array, velocity: Array) -> None:
        """Go on from displacements in m and velocities of half a step before in m/s, (node,) upwards."""
        moves = self.stencil.gain > 0.0
        self._u[0][moves] = u[moves]
        self._u[1][moves] = self._u[0][moves] - velocity[moves] * self.stepping.step
        springs, before, k = self.springs, self._u[1], np.arange(WIDTH)
        shares = before[springs.one[:, None] + k], before[springs.other[:, None] + k]
        springs.last[:] = (springs.weight * np.concatenate(shares, axis=1)).sum(axis=1)
        self.holders.here[:], self.holders.last[:] = (coordinates(self.holders, u[None]) for u in self._u)

    @property
    def position(self) -> Array:
        """Positions of all nodes now, (3, node) m."""
        return np.vstack([self.rest.position[:2], self.level + self._u[0]])

    @property
    def velocity(self) -> Array:
        """Velocities of all nodes half a step ago, (3, node) m/s."""
        still = np.zeros((2, self.mesh.nodes))
        return np.vstack([still, (self._u[0] - self._u[1]) / self.stepping.step])

    @property
    def failed(self) -> Array:
        """(tie, 2) when ties failed, s, and under which force, N; infinite: they have not."""
        found = np.empty_like(self.springs.failed)
        found[self.springs.number] = self.springs.failed
        return found

    def piece(self, part: slice) -> tuple[Array, Array]:
        """Positions in m and velocities in m/s of some nodes, (3, node)."""
        now, last = self._u[0][part], self._u[1][part]
        x, y = self.rest.position[:2, part]
        still = np.zeros_like(x)
        return np.array([x, y, self.level[part] + now]), np.array([still, still, (now - last) / self.stepping.step])

    @property
    def both(self) -> list[Array]:
        """Displacements of all nodes now and a step ago, (node,) m."""
        return self._u

    def seen(self, both: Array) -> tuple[Array, Array]:
        """Positions in m and velocities in m/s of all nodes, (instant, 3, node), whatever `both` was at these instants.

        Args:
            both: (instant, 2, node) m.
        """
        r, v = (np.zeros((len(both), 3, self.mesh.nodes)) for _ in range(2))
        r[:, :2], r[:, 2] = self.rest.position[:2], self.level + both[:, 0]
        v[:, 2] = (both[:, 0] - both[:, 1]) / self.stepping.step
        return r, v

    def _changing(self) -> dict[str, Arrays]:
        """Arrays that change; the present and the last instant in this order, whichever array holds them."""
        (now, last), springs = self._u, arrays_of(self.springs, "last", "rate", "failed")
        return {
            "pace": arrays_of(self.stepping, *CHANGES), "springs": springs, "holders": arrays_of(self.holders, *MOVES),
            "nodes": {"now": now, "last": last},
        }  # fmt: skip

    def go(self, inputs: StepInputs, steps: int = 1) -> Record:
        """Go on by the rows of the drive but the last, `steps` steps each."""
        return self._go(
            inputs.together(), steps, self._window(inputs), np.zeros((0, 2, 0)), self.empty_notes(0)
        ).first()

    def through(self, inputs: StepInputs, steps: int, both: Array, notes: Notes) -> Record:
        """Go on by the rows of the drive but the last, of one output instant after the other, which come first.

        Args:
            inputs: with the instants before all rows; the window is all that there is.
            steps: in each row.
            both: (instant, 2, node) m, takes displacements at each instant and a step before.
            notes: `empty_notes` for the rest.
        """
        return self._go(inputs, steps, self._whole, both, notes)

    @property
    def sources(self) -> list[Array]:
        """What is noted at an instant besides displacements, in the order of `Then`."""
        stepping = self.stepping
        own = [stepping.q, stepping.last, stepping.here, stepping.before, stepping.work]
        return [*own, self.holders.moved, self.springs.failed]

    @property
    def tie_number(self) -> Integers:
        """Number of the tie of each spring."""
        return self.springs.number

    def empty_notes(self, most: int) -> Notes:
        """Room for notes of some instants."""
        return Notes.empty(numbers_of(self.sources), most)

    def _go(self, inputs: StepInputs, steps: int, window: WireWindow, both: Array, notes: Notes) -> Record:
        instants, rows, plan = inputs.time.shape[0], inputs.time.shape[1] - 1, self.mesh.plan
        record = Record.of(rows, self.moving_loads, len(plan.ties), len(plan.holds), self.watched, instants)
        arguments = (
            self.mesh.strands, self.stencil, self.springs, self.holders, window, self._watched, self.moving_loads,
            self.stepping, self.level, *self._u, self._buffers, inputs, record, steps, self._sweeps, both, notes,
            self._w,
        )  # fmt: skip
        if self._advance is None:
            self._advance = entry_of(advance, arguments)
        self._advance(*arguments)
        if (instants * rows * steps) % 2:
            self._u.reverse()
        return record.turned()

    def _window(self, inputs: StepInputs) -> WireWindow:
        if not np.isfinite(self.window):
            return self._whole
        strands, on = self.mesh.strands, inputs.where == ON_WIRE
        wires = np.broadcast_to(self.moving_loads.wire, on.shape)[on]
        if wires.size == 0:
            self._low, self._high = self._whole.low, self._whole.high
            return self._whole
        x = window_places(self.mesh, wires, inputs.station[on], float(inputs.time.max()))
        begin, end, edge = x.min() - self.window, x.max() + self.window, WIDTH * strands.h.max()
        each = strands.across[:, 1] * strands.h  # x of a link
        low = np.clip(np.floor((begin - strands.across[:, 0]) / each), 0, strands.links + 1).astype(np.int64)
        high = np.clip(np.ceil((end - strands.across[:, 0]) / each), 0, strands.links + 1).astype(np.int64)
        high = np.maximum(low, high)
        self._stop(low, high)
        fast, x = self.holders.fast, self.holders.x
        parts = [  # all that shares a node which moves, and watched points that share no other
            (first + int(np.searchsorted(x, begin - edge)), first + int(np.searchsorted(x, end + edge)))
            for x, first in ((self.springs.x, 0), (x[:fast], 0), (x[fast:], fast))
        ]
        seen = self._watched.x
        parts.append((int(np.searchsorted(seen, begin + edge)), int(np.searchsorted(seen, end - edge))))
        ends = np.sort([strands.across[:, 0], strands.across[:, 0] + each * strands.links], axis=0)
        near = (ends[1] > begin - 2.0 * edge) & (ends[0] < end + 2.0 * edge)  # also wires that only ties reach to
        beyond = np.where(near, self._beyond, 0)
        return WireWindow(low, high, *self._layers, beyond, self._laden(low, high), *parts)

    def _stop(self, low: Integers, high: Integers) -> None:
        """Let what the window leaves, as it begins to move nodes from low to high of each wire, stand still."""
        now, last = self._u
        for a, first in enumerate(self.mesh.strands.first):
            begin, end = self._low[a], self._high[a]
            for part in slice(first + begin, first + min(end, low[a])), slice(first + max(begin, high[a]), first + end):
                if part.stop > part.start:
                    rate = (now[part] - last[part]) / self.stepping.step
                    self.stepping.work[DAMPED] += 0.5 * float((self.stencil.mass[part] * rate**2).sum())  # lost
                    last[part] = now[part]
        self._low, self._high = low, high

    def _laden(self, low: Integers, high: Integers) -> Integers:
        """Which of the laden nodes of each wire lie between two of its nodes."""
        first, laden, found = self.stencil.first, self.stencil.laden, []
        for a, i in enumerate(self.mesh.strands.first):
            own = laden[first[a] : first[a + 1]]
            found.append(first[a] + np.searchsorted(own, [i + low[a], i + high[a]]))
        return np.array(found, dtype=np.int64)


def _apart(values: Array) -> list[Array]:
    """Two copies that begin half a page apart: arrays at equal places of their pages hinder each other in a cache."""
    second = values.size + (_HALF_PAGE - values.size) % (2 * _HALF_PAGE)
    buffers = np.empty(second + values.size)
    copies = [buffers[: values.size], buffers[second:]]
    for copy in copies:
        copy[:] = values
    return copies


def _looked_at(mesh: Mesh, watched: Places) -> Watched:
    x = x_of(mesh, watched.wire, watched.station)
    order = np.argsort(x, kind="stable")
    return Watched(watched.base[order], np.ascontiguousarray(watched.weight[order]), x[order], order)
