"""The audit of motion on wires: energies half a step ago, where Störmer's method keeps them, and works up to there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.checkpoint import Tree
from ropewalk.mechanics.notes import Notes, columns
from ropewalk.results.audit import Audit
from ropewalk.results.frames import summed
from ropewalk.wires.equilibrium import WirePotential
from ropewalk.wires.large import LargeMotion
from ropewalk.wires.mesh import Mesh, MovingLoads
from ropewalk.wires.moving_loads import (
    ASIDE,
    DAMPED,
    FORCE,
    GAP,
    GIVEN,
    GIVEN_FORCE,
    HEIGHT,
    LOCAL,
    LOST,
    MOVED,
    PLACE,
    RESTRAINED,
    ROUGH,
    SLOPE,
    TAKEN,
    TURNED,
)
from ropewalk.wires.plan import Array
from ropewalk.wires.rest import vertical_stiffness
from ropewalk.wires.restraints import AHEAD, NOW
from ropewalk.wires.small import SmallMotion
from ropewalk.wires.spline import WIDTH
from ropewalk.wires.threads import correction

_NOTHING = 1e-100  # J: small motion begins with 1e-150 m instead of nothing, and weights are lifted so far


class Then(NamedTuple):
    """What energies are found of, unchanged by what comes; of several instants, with these in front of all."""

    both: Array  # of the motion
    q: Array  # of its stepping, as are the others
    last: Array
    here: Array
    before: Array
    work: Array
    moved: Array  # (holder, 3) m
    failed: NDArray[np.bool_]  # (tie,) whether it pulls no more

    @staticmethod
    def of(motion: LargeMotion | SmallMotion) -> Then:
        """Copies of what is known now, at one instant."""
        stepping = motion.stepping
        own = (stepping.q, stepping.last, stepping.here, stepping.before, stepping.work, motion.holders.moved)
        copies = (array[None].copy() for array in own)
        return Then._make([np.array(motion.both)[None], *copies, motion.failed[None, :, 0] < np.inf])

    @staticmethod
    def noted(motion: LargeMotion | SmallMotion, both: Array, notes: Notes) -> Then:
        """What has been noted on the way, see `through` of motions."""
        *own, failed = columns([notes], motion.sources)
        gone = np.empty(failed.shape[:2], dtype=np.bool_)
        gone[:, motion.tie_number] = failed[:, :, 0] < np.inf
        return Then._make([both, *own, gone])

    @staticmethod
    def together(thens: Sequence[Then]) -> Then:
        """The same of several instants."""
        each: Any = zip(*thens, strict=True)
        return Then(*(np.concatenate(own) for own in each))


class Energies:
    """Energies and works of a motion; the first ones are the origin.

    In small motion `elastic` is all potential energy about rest, weights included.
    """

    def __init__(
        self, mesh: Mesh, moving_loads: MovingLoads, motion: LargeMotion | SmallMotion, start: Array, unstrained: Array
    ) -> None:
        self._mesh, self._moving_loads, self._motion = mesh, moving_loads, motion
        self._audit = Audit()
        self._unsqueezed = np.full(moving_loads.owner.size, np.nan)  # J, stored in each contact at first
        bending = (motion.threads if isinstance(motion, LargeMotion) else motion.stencil).bending
        corrected = mesh._replace(strands=mesh.strands._replace(stiffness=bending))
        if isinstance(motion, LargeMotion):
            axes = [0, 1, 2] if motion.both[0].shape[0] == 3 else [0, 2]
            more = np.zeros((3, mesh.nodes))
            more[axes] = correction(mesh, start[axes], bending)
            self._more, self._potential = more, WirePotential(corrected, unstrained, more)
        else:
            self._stiffness = vertical_stiffness(corrected)

    def of(self, then: Then) -> Array:
        """Those of some instants, (instant, form) in the order of ENERGY_FORMS, J."""
        motion, work = self._motion, then.work.T
        if isinstance(motion, LargeMotion):
            along = np.array([motion.inertia, 1.0, 1.0])
            kinetic = 0.5 * summed(self._mesh.mass * (along[:, None] * motion.seen(then.both)[1] ** 2))
        else:
            rate = (then.both[:, 0] - then.both[:, 1]) / motion.stepping.step
            kinetic = 0.5 * summed(self._mesh.mass * rate**2)
        elastic, gravitational = self._stored(then)
        moving, potential = self._of_moving_loads(then)
        squeezed, given, restrained, taken = self._at_contacts(then)
        energy = self._audit.of(
            kinetic=kinetic, elastic=elastic, gravitational=gravitational, load_kinetic=moving,
            load_potential=potential + squeezed, line_damping=work[DAMPED], contact_dissipation=taken - squeezed,
            load_damping=work[LOST], load_work=given, hold_work=restrained, support_work=work[MOVED],
        )  # fmt: skip
        energy[np.abs(energy) < _NOTHING] = 0.0
        return energy

    def get_state(self) -> Tree:
        """The first energies."""
        return {"audit": self._audit.get_state(), "unsqueezed": self._unsqueezed.copy()}

    def set_state(self, tree: Tree) -> None:
        """Count from these."""
        self._audit.set_state(tree["audit"])
        self._unsqueezed[:] = tree["unsqueezed"]

    def _stored(self, then: Then) -> tuple[Array, Array]:
        motion = self._motion
        if isinstance(motion, LargeMotion):
            parts = np.zeros((2, 2, len(then.both)))
            for j, instant in enumerate((AHEAD, NOW)):
                self._potential.place = self._places(motion, then.moved[:, :, instant])
                weights = summed((self._potential.force - self._more) * then.both[:, j])
                parts[:, j] = self._potential.energies(then.both[:, j], then.failed) + weights, -weights
            return parts[0].mean(axis=0), parts[1].mean(axis=0)
        parts_of_both = [
            self._about_rest(motion, then.both[:, j], then.moved[:, :, at], then.failed)
            for j, at in enumerate((AHEAD, NOW))
        ]
        return np.mean(parts_of_both, axis=0), np.zeros(len(then.both))

    def _places(self, motion: LargeMotion, displaced: Array) -> Array:
        """Where holds are without force when holders are displaced by (instant, holder) m, (instant, hold, 3) m."""
        holders, place = motion.holders, np.tile(self._mesh.holds.place, (len(displaced), 1, 1))
        axes = [0, 1, 2] if holders.way.shape[1] == 3 else [0, 2]
        for hold, way, moved in zip(holders.hold, holders.way, displaced.T, strict=True):
            place[:, hold, axes] += way * moved[:, None]
        return place

    def _about_rest(self, motion: SmallMotion, u: Array, displaced: Array, failed: NDArray[np.bool_]) -> Array:
        """Potential energy of small motion, zero at rest, (instant,) J.

        Args:
            motion: the motion.
            u: (instant, node) m.
            displaced: (instant, holder) m, by how much holders are then.
            failed: (instant, tie) whether they pull no more.
        """
        holders, restrained = motion.holders, np.zeros(len(u))
        if holders.fast < holders.hold.size:
            elastic = slice(holders.fast, None)
            points = (holders.weight * u.take(holders.base[:, None] + np.arange(WIDTH), axis=1)).sum(axis=2)
            stretched = (displaced - holders.way[:, 0] * points)[:, elastic]
            restrained = 0.5 * summed(holders.stiffness[elastic] * stretched**2)
        s = motion.springs
        one, other = s.weight[:, : s.weight.shape[1] // 2], s.weight[:, s.weight.shape[1] // 2 :]
        share = np.arange(s.weight.shape[1] // 2)
        apart = (one * u.take(s.one[:, None] + share, axis=1)).sum(axis=2)
        apart += (other * u.take(s.other[:, None] + share, axis=1)).sum(axis=2)
        whole, tie = ~failed[:, s.number], s.pull > 0.0
        springs = 0.5 * summed(np.where(whole, s.across * apart**2, 0.0))
        k, p, rest, along = s.pull[tie], s.push[tie], s.rest[tie], (s.way * apart)[:, tie]
        before = np.where(rest > 0.0, rest, rest * p / k)
        after = rest + k * along
        stored = 0.5 * np.where(whole[:, tie], np.where(after > 0.0, after**2 / k, p * (after / k) ** 2), 0.0)
        stored -= 0.5 * np.where(rest > 0.0, rest**2 / k, p * (rest / k) ** 2)
        springs += summed(stored - before * along)
        return np.asarray(0.5 * summed(u * (self._stiffness @ u.T).T) + springs + restrained)

    def _of_moving_loads(self, then: Then) -> tuple[Array, Array]:
        """Kinetic and potential energy of all loads without their contacts, J; weights count from their bases."""
        moving_loads, (kinetic, potential) = self._moving_loads, np.zeros((2, len(then.q)))
        for i, n in enumerate(moving_loads.size):
            q, last = then.q[:, i, :n], then.last[:, i, :n]
            rate = (q - last) / self._motion.stepping.step
            kinetic += 0.5 * summed(rate[:, :, None] * moving_loads.mass[i, :n, :n] * rate[:, None])
            own = moving_loads.owner == i
            weight = moving_loads.rest[own] @ moving_loads.row[own][:, :n]
            for u in (q, last):
                springs = summed(u[:, :, None] * moving_loads.stiffness[i, :n, :n] * u[:, None])
                potential += 0.25 * springs - 0.5 * summed(u * weight)
        return kinetic, potential

    def _at_contacts(self, then: Then) -> tuple[Array, Array, Array, Array]:
        """Energy stored in all contacts, and works up to half a step ago: given, holding, and taken up by contacts, J.

        Known is the last instant that was looked at, and the one before: it goes on as it did for half a step.
        """
        moving_loads, here, before = self._moving_loads, then.here, then.before
        there = np.isfinite(here[:, :, HEIGHT])
        on = there & np.isfinite(before[:, :, HEIGHT])
        now, moved = (np.where(on[:, :, None], each, 0.0) for each in (here, here - before))
        touches, outside = moving_loads.spring > 0.0, moving_loads.size[moving_loads.owner] == 0
        rough = np.where(touches, 0.5 * now[:, :, FORCE] * moved[:, :, ROUGH], 0.0)
        given, restrained, taken = (then.work[:, form] for form in (GIVEN, RESTRAINED, TAKEN))
        given = given + 0.5 * summed(now[:, :, GIVEN_FORCE] * moved[:, :, HEIGHT]) - summed(rough[:, outside])
        restrained = (
            restrained
            - 0.5 * summed(now[:, :, FORCE] * now[:, :, SLOPE] * moved[:, :, PLACE])
            - summed(rough[:, ~outside])
            + 0.5 * summed((now[:, :, FORCE] * now[:, :, TURNED] * moved[:, :, ASIDE])[:, touches])
        )
        taken = taken + 0.5 * summed((now[:, :, FORCE] * moved[:, :, GAP])[:, touches])
        stored = np.zeros(len(here))
        for k in np.flatnonzero(there.any(axis=0) & touches):
            at = np.flatnonzero(there[:, k])
            gap = here[at, k, GAP] + 0.5 * moved[at, k, GAP]
            energy = self._squeezed(int(k), gap, here[at, k, LOCAL])
            if np.isnan(self._unsqueezed[k]):
                self._unsqueezed[k] = energy[0]
            stored[at] += energy - self._unsqueezed[k]
        return stored, given, restrained, taken

    def _squeezed(self, k: int, gap: Array, local: Array) -> Array:
        """Potential energy of the force at contact k, where load and spline overlap by gaps in m, (instant,) J."""
        moving_loads = self._moving_loads
        rest, yields = (
            moving_loads.rest[k],
            local + (0.0 if np.isinf(moving_loads.spring[k]) else 1.0 / moving_loads.spring[k]),
        )
        gives = yields > 0.0
        more = np.where(gives, gap - local * rest, 0.0) / np.where(gives, yields, 1.0)
        stored = rest * gap + 0.5 * yields * more**2
        if not moving_loads.lifts[k]:
            return np.asarray(stored)
        free = (moving_loads.sign[k] * (rest + more) < 0.0) | (~gives & (moving_loads.sign[k] * gap < 0.0))
        return np.asarray(np.where(free, 0.5 * rest**2 * (2.0 * local - yields), stored))
