"""From what is noted of the motion of wires to frames of the result, of many instants at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.checkpoint import Tree
from ropewalk.results.frame import IN_AIR, MOVES, Contacts
from ropewalk.results.frames import Frames, summed
from ropewalk.wires.contact_location import links_below
from ropewalk.wires.energy import Energies, Then
from ropewalk.wires.equilibrium import WirePotential
from ropewalk.wires.large import LargeMotion
from ropewalk.wires.layout import Reactions, axes_of, axial_force
from ropewalk.wires.mesh import Mesh, MovingLoads
from ropewalk.wires.plan import Array, Integers
from ropewalk.wires.rest import beds, vertical_stiffness
from ropewalk.wires.small import SmallMotion
from ropewalk.wires.spline import WIDTH, points
from ropewalk.wires.step_inputs import ON_WIRE, Record, StepInputs
from ropewalk.wires.task import WireTask

_NOTHING = 1e-100  # m: small motion begins with a little more than nothing


class WireNote(NamedTuple):
    """What frames of some instants, which come first, are made of, unchanged by what comes."""

    t: Array  # (instant,) s
    then: Then
    where: Integers  # (instant, contact) as in `StepInputs`
    station: Array  # (instant, 2, contact) m, now and a sample later
    force: Array  # (instant, contact) N, of the step that follows, as are heights, ties and holds
    height: Array  # (instant, contact) m
    tie: Array  # (instant, tie) N
    hold: Array  # (instant, hold, 3) N
    stations: Array  # (instant, sample, contact) m, since the frame before, as is what was recorded
    recorded: tuple[Array, Array, Array, Array]  # forces, heights, ties, watched points

    @staticmethod
    def of(t: Array, then: Then, inputs: StepInputs, now: Record, stations: Array, before: Record) -> WireNote:
        """What is known at t in s, (instant,), with what comes next and what came before, instants first."""
        later = min(1, inputs.station.shape[1] - 1)
        return WireNote(
            t, then, inputs.where[:, 0], inputs.station[:, [0, later]], now.force[:, 0], now.height[:, 0],
            now.tie[:, 0], now.hold[:, 0], stations, (before.force, before.height, before.tie, before.watched),
        )  # fmt: skip

    @staticmethod
    def together(notes: Sequence[WireNote]) -> WireNote:
        """The same of several notes, one after the other."""
        if len(notes) == 1:
            return notes[0]
        t, thens, *others, recorded = zip(*notes, strict=True)
        rest: Any = (np.concatenate(own) for own in others)
        before = tuple(np.concatenate(own) for own in zip(*recorded, strict=True))
        return WireNote._make([np.concatenate(t), Then.together(thens), *rest, before])


class Pictures:
    """What makes frames; the energies of the first one are the origin of its audit.

    Args:
        task: what is computed.
        mesh: of its wires.
        moving_loads: on them.
        motion: of both.
        sample: s, from one sample to the next.
        potential: of a large motion.
        energies: of them.
    """

    def __init__(
        self, task: WireTask, mesh: Mesh, moving_loads: MovingLoads, motion: LargeMotion | SmallMotion, sample: float,
        potential: WirePotential | None, energies: Energies,
    ) -> None:  # fmt: skip
        self.task, self.mesh, self.moving_loads, self.motion, self.sample = task, mesh, moving_loads, motion, sample
        self.axes, self._supports, self._energies = axes_of(task), Reactions(mesh), energies
        self._in_air = np.zeros(moving_loads.owner.size)  # s, of each contact up to the last frame
        ends, links = self._supports.ends, mesh.strands.links
        self._first = np.concatenate([[0], np.cumsum(links)[:-1]])  # (wire,) number of its first link
        self._links = np.concatenate([i + np.arange(n) for i, n in zip(mesh.strands.first, links, strict=True)])
        self._stiffness = np.repeat([wire.axial_stiffness for wire in task.plan.wires], links)
        self._potential, self._bow = potential, task.bow
        if potential is None:
            # As in the steps: a correction of the bending stiffness counts at the ends, too.
            assert isinstance(motion, SmallMotion)
            corrected = mesh._replace(strands=mesh.strands._replace(stiffness=motion.stencil.bending))
            self._end_stiffness = vertical_stiffness(corrected)[ends]
            at_rest = (self._end_stiffness - vertical_stiffness(mesh)[ends]) @ motion.level  # which is not corrected
            self._late = np.repeat(mesh.strands.retardation, links + 1)
            self._risen = (beds(mesh) * mesh.straight()[2])[ends] + at_rest
            self._end_weight = task.plan.gravity * mesh.mass[ends]
            self._strained = mesh.tension[self._links] / self._stiffness

    def get_state(self) -> Tree:
        """The origin of the audit, and how long contacts have been in the air."""
        return {"energies": self._energies.get_state(), "in_air": self._in_air.copy()}

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self._energies.set_state(tree["energies"])
        self._in_air[:] = tree["in_air"]

    def build(self, notes: Sequence[WireNote]) -> Frames:
        """The frames of some notes."""
        t, then, where, station, force, height, tie, hold, stations, before = WireNote.together(notes)
        motion, lifts = self.motion, self.moving_loads.lifts
        r, v = motion.seen(then.both)
        displayed = r if self._bow is None else r + np.array([[0.0], [1.0], [0.0]]) * self._bow
        if isinstance(motion, LargeMotion):
            strain = motion.strain(r[:, self.axes])[:, self._links]
            tension = axial_force(self.mesh, self._stiffness * strain, r)
        else:
            strain = np.broadcast_to(self._strained, (len(r), self._strained.size))
            tension = self._stiffness * strain
        tie = tie + motion.tie_at_rest
        in_air = np.cumsum([self._in_air, *self.sample * ((before[0] == 0.0) & lifts).sum(axis=1)], axis=0)[1:]
        self._in_air[:] = in_air[-1]
        places, rates = self._bodies(then, station, r)
        watched = np.where(np.abs(before[3]) < _NOTHING, 0.0, before[3])
        of = {
            "position": displayed[:, self.axes].swapaxes(1, 2), "velocity": v[:, self.axes].swapaxes(1, 2),
            "tension": tension, "strain": strain, "body_position": places, "body_velocity": rates,
            **self._contacts(displayed, tension, where == ON_WIRE, station, force, height, in_air).fields(),
            "reaction": self.reactions(motion.hold_at_rest + hold, tie, r, v, then.failed, self._on_ends(
                where == ON_WIRE, station[:, 0], force, r)),
            "energy": self._energies.of(then),
            "tie_force": tie, "sampled_station": stations, "sampled_force": before[0], "sampled_height": before[1],
            "sampled_tie_force": before[2] + motion.tie_at_rest, "sampled_uplift": watched,
        }  # fmt: skip
        return Frames(t, of)

    def _contacts(
        self, r: Array, tension: Array, on: Array, station: Array, force: Array, height: Array, in_air: Array
    ) -> Contacts:
        seen, strands = Contacts(*on.shape, len(self.axes)), self.mesh.strands
        seen.position[on], seen.force[on], seen.hold[on] = 0.0, 0.0, 0.0
        seen.position[on, -1], seen.force[on, -1] = height[on], force[on]
        for k in np.flatnonzero(on.any(axis=0)):
            at, a = np.flatnonzero(on[:, k]), int(self.moving_loads.wire[k])
            links, first, weight = self._locations(int(k), station[at, 0, k], r[at])
            for i, axis in enumerate(self.axes[:-1]):
                seen.position[at, k, i] = _value(r[at, axis], first, weight)
            seen.xi[at, k] = links * strands.h[a]
            own = self._first[a] + np.minimum(links.astype(np.int64), strands.links[a] - 1)
            seen.tension[at, k] = tension[at, own][:, None]
        counted = np.where(self.moving_loads.material, 1.0, np.abs(strands.across[self.moving_loads.wire, 1]))
        seen.speed[on] = (counted * (station[:, 1] - station[:, 0]) / self.sample)[on]
        seen.state[on] = np.where(self.moving_loads.lifts & (force == 0.0), IN_AIR, MOVES)[on]
        seen.in_air = in_air
        return seen

    def _locations(self, k: int, station: Array, r: Array) -> tuple[Array, Integers, Array]:
        """Where contact k is on its wire at some instants, at an end if it is beyond that.

        Args:
            k: the contact.
            station: (instant,) m.
            r: (instant, 3, node) m.

        Returns:
            Links from the start of the wire (instant,), first of the nodes that share the point, and their parts
            (instant, WIDTH).
        """
        a, strands = int(self.moving_loads.wire[k]), self.mesh.strands
        inside = np.minimum(np.maximum(station, 0.0), self.task.plan.wires[a].length)
        if isinstance(self.motion, LargeMotion) and not self.moving_loads.material[k]:
            begin, along = strands.across[a]
            x = begin + along * inside
            links = links_below(self.mesh, a, r[:, 0], x)
        else:
            links = inside / float(strands.h[a])
        base, weight = points(links, np.full(links.size, strands.links[a]), np.tile(strands.level[a], (links.size, 1)))
        return links, base + strands.first[a], weight[:, 0]

    def _bodies(self, then: Then, station: Array, r: Array) -> tuple[Array, Array]:
        """Places and velocities of bodies, (instant, body, axis) m and m/s."""
        out = np.zeros((2, len(r), len(self.task.displayed), len(self.axes)))
        for i, body in enumerate(self.task.displayed):
            wheels, n = np.flatnonzero(self.moving_loads.owner == body.prescribed_motion), body.row.size
            q, last = then.q[:, body.prescribed_motion, :n], then.last[:, body.prescribed_motion, :n]
            x = np.zeros((2, len(r)))
            for k, part in [(int(wheels[wheel]), part) for wheel, part in body.shares]:
                a = int(self.moving_loads.wire[k])
                along, length = float(self.mesh.strands.across[a, 1]), self.task.plan.wires[a].length
                for later, own in enumerate((station[:, 0, k], station[:, 1, k])):
                    _, first, weight = self._locations(k, own, r)
                    beyond = own - np.minimum(np.maximum(own, 0.0), length)
                    x[later] += part * (_value(r[:, 0], first, weight) + along * beyond)
            out[0, :, i, 0], out[0, :, i, -1] = x[0] + np.sign(along) * body.ahead, body.base + summed(q * body.row)
            out[1, :, i, 0], out[1, :, i, -1] = (
                (x[1] - x[0]) / self.sample,
                (q - last) @ body.row / self.motion.stepping.step,
            )
        return out[0], out[1]

    def _on_ends(self, on: NDArray[np.bool_], station: Array, force: Array, r: Array) -> Array:
        """Parts of contact forces that the spline puts on ends of wires, (instant, end) N upwards."""
        ends = self._supports.ends
        out = np.zeros((len(r), ends.size))
        for k in np.flatnonzero(on.any(axis=0)):
            at = np.flatnonzero(on[:, k])
            _, first, weight = self._locations(int(k), station[at, k], r[at])
            for e, node in enumerate(ends):
                j = node - first
                near = (j >= 0) & (j < WIDTH)
                out[at[near], e] += weight[near, j[near]] * force[at[near], k]
        return out

    def reactions(
        self, hold: Array, tie: Array, r: Array, v: Array, failed: NDArray[np.bool_], pressed: Array | float = 0.0
    ) -> Array:
        """Forces of all that holds wires on them, (instant, support, axis) N.

        Args:
            hold: (instant, hold, 3) N, those of holds.
            tie: (instant, tie) N, those of ties.
            r, v: (instant, 3, node) m and m/s.
            failed: (instant, tie) whether ties pull no more.
            pressed: (instant, end) N, of contacts on the ends, upwards.
        """
        strands, supports = self.mesh.strands, self._supports
        if self._potential is not None:
            bare = self._potential.bare_pull(r, failed)[..., supports.ends].swapaxes(1, 2)
            bare[..., 2] += pressed
            return supports.of(bare, hold, tie, r)[..., self.axes]
        bare = np.zeros((len(r), supports.ends.size, 3))
        bare[..., 2] = self._risen - (self._end_stiffness @ (r[:, 2] + self._late * v[:, 2]).T).T
        bare[..., 2] += pressed - self._end_weight
        force = supports.of(bare, hold, tie, r)
        along = np.sign(strands.across[:, 1]) * strands.tension  # towards +x or -x
        force[:, : 2 * strands.first.size, 0] = np.stack([-along, along], axis=1).ravel()
        return force[..., self.axes]


def _value(values: Array, first: Integers, weight: Array) -> Array:
    """What splines through values (instant, node) are where nodes from the first on share a point by their weights."""
    near = np.take_along_axis(values, first[:, None] + np.arange(WIDTH), axis=1)
    return np.asarray((near * weight).sum(axis=1))
