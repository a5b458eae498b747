"""The audit of motion on wires: energies half a step ago, where Störmer's method keeps them, and works up to there."""

from __future__ import annotations

import numpy as np

from ropewalk.checkpoint import Tree
from ropewalk.results.audit import Audit
from ropewalk.wires.equilibrium import Potential
from ropewalk.wires.holding import AHEAD, NOW
from ropewalk.wires.large import LargeMotion, correction
from ropewalk.wires.mesh import Mesh, Riders
from ropewalk.wires.plan import Array
from ropewalk.wires.rest import rows, vertical_stiffness
from ropewalk.wires.riders import (
    DAMPED,
    FORCE,
    GAP,
    GIVEN,
    GIVEN_FORCE,
    HEIGHT,
    HELD,
    LOCAL,
    LOST,
    MOVED,
    PLACE,
    ROUGH,
    SLOPE,
    TAKEN,
    Pace,
)
from ropewalk.wires.small import SmallMotion
from ropewalk.wires.spline import WIDTH

_NOTHING = 1e-100  # J: small motion begins with 1e-150 m instead of nothing, and weights are lifted so far


class Energies:
    """Energies and works of a motion; the first ones are the origin.

    In small motion `elastic` is all potential energy about rest, weights included.
    """

    def __init__(
        self, mesh: Mesh, riders: Riders, motion: LargeMotion | SmallMotion, start: Array, unstrained: Array
    ) -> None:
        self._mesh, self._riders, self._motion = mesh, riders, motion
        self._audit = Audit()
        self._unsqueezed = np.full(riders.owner.size, np.nan)  # J, stored in each contact at first
        bending = (motion.threads if isinstance(motion, LargeMotion) else motion.stencil).bending
        corrected = mesh._replace(strands=mesh.strands._replace(stiffness=bending))
        if isinstance(motion, LargeMotion):
            axes = [0, 1, 2] if motion.both[0].shape[0] == 3 else [0, 2]
            more = np.zeros((3, mesh.nodes))
            more[axes] = correction(mesh, start[axes], bending)
            self._more, self._potential = more, Potential(corrected, unstrained, more)
        else:
            self._stiffness = vertical_stiffness(corrected)
            self._ties = rows(mesh.ties.other, mesh.nodes) - rows(mesh.ties.one, mesh.nodes)

    def now(self) -> Array:
        """Those of now in the order of ENERGY_FORMS, J."""
        motion, velocity = self._motion, self._motion.velocity
        along = np.array([motion.inertia if isinstance(motion, LargeMotion) else 1.0, 1.0, 1.0])
        kinetic = 0.5 * float((self._mesh.mass * (along[:, None] * velocity**2)).sum())
        elastic, gravitational = self._stored()
        moving, potential = self._of_riders(motion.pace)
        squeezed, given, held, taken = self._at_contacts(motion.pace)
        energy = self._audit.of(
            kinetic=kinetic, elastic=elastic, gravitational=gravitational, load_kinetic=moving,
            load_potential=potential + squeezed, line_damping=motion.pace.work[DAMPED],
            contact_dissipation=taken - squeezed, load_damping=motion.pace.work[LOST], load_work=given, hold_work=held,
            support_work=motion.pace.work[MOVED],
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

    def _stored(self) -> tuple[float, float]:
        motion = self._motion
        if isinstance(motion, LargeMotion):
            parts = []
            for r, instant in zip(motion.both, (AHEAD, NOW), strict=True):
                self._potential.place = self._places(motion, instant)
                weights = float(((self._potential.force - self._more) * r).sum())
                parts.append((self._potential.energy(r) + weights, -weights))
            elastic, gravitational = np.mean(parts, axis=0)
            return float(elastic), float(gravitational)
        both = zip(motion.both, (AHEAD, NOW), strict=True)
        return float(np.mean([self._about_rest(motion, u, instant) for u, instant in both])), 0.0

    def _places(self, motion: LargeMotion, instant: int) -> Array:
        """Where holds are without force now, or a step ago, (hold, 3) m."""
        holders, place = motion.holders, self._mesh.holds.place.copy()
        axes = [0, 1, 2] if holders.way.shape[1] == 3 else [0, 2]
        for hold, way, moved in zip(holders.hold, holders.way, holders.moved[:, instant], strict=True):
            place[hold, axes] += way * moved
        return place

    def _about_rest(self, motion: SmallMotion, u: Array, instant: int) -> float:
        """Potential energy of small motion, zero at rest."""
        holders, held = motion.holders, 0.0
        if holders.fast < holders.hold.size:
            elastic = slice(holders.fast, None)
            points = (holders.weight * u[holders.base[:, None] + np.arange(WIDTH)]).sum(axis=1)
            stretched = (holders.moved[:, instant] - holders.way[:, 0] * points)[elastic]
            held = 0.5 * float((holders.stiffness[elastic] * stretched**2).sum())
        s, springs = motion.springs, 0.0
        apart = np.einsum("ek,ek->e", s.weight[:, : s.weight.shape[1] // 2], u[s.one[:, None] + _shares(s.weight)])
        apart += np.einsum("ek,ek->e", s.weight[:, s.weight.shape[1] // 2 :], u[s.other[:, None] + _shares(s.weight)])
        springs += 0.5 * float((s.across * apart**2).sum())
        tie = s.pull > 0.0
        k, p, rest, along = s.pull[tie], s.push[tie], s.rest[tie], (s.way * apart)[tie]
        before = np.where(rest > 0.0, rest, rest * p / k)
        after = rest + k * along
        stored = 0.5 * np.where(after > 0.0, after**2 / k, p * (after / k) ** 2)
        stored -= 0.5 * np.where(rest > 0.0, rest**2 / k, p * (rest / k) ** 2)
        springs += float((stored - before * along).sum())
        return 0.5 * float(u @ (self._stiffness @ u)) + springs + held

    def _of_riders(self, pace: Pace) -> tuple[float, float]:
        """Kinetic and potential energy of all riders without their contacts, J; weights count from their bases."""
        riders, kinetic, potential = self._riders, 0.0, 0.0
        for i, n in enumerate(riders.size):
            rate = (pace.q[i, :n] - pace.last[i, :n]) / pace.step
            kinetic += 0.5 * float(rate @ riders.mass[i, :n, :n] @ rate)
            own = riders.owner == i
            weight = riders.rest[own] @ riders.row[own][:, :n]
            for q in (pace.q[i, :n], pace.last[i, :n]):
                potential += 0.25 * float(q @ riders.stiffness[i, :n, :n] @ q) - 0.5 * float(weight @ q)
        return kinetic, potential

    def _at_contacts(self, pace: Pace) -> tuple[float, float, float, float]:
        """Energy stored in all contacts, and works up to half a step ago: given, holding, and taken up by contacts, J.

        Known is the last instant that was looked at, and the one before: it goes on as it did for half a step.
        """
        here, before = pace.here, pace.before
        on = np.isfinite(here[:, HEIGHT]) & np.isfinite(before[:, HEIGHT])
        now, moved = here[on], here[on] - before[on]
        given, held, taken = (pace.work[form] for form in (GIVEN, HELD, TAKEN))
        given += 0.5 * float((now[:, GIVEN_FORCE] * moved[:, HEIGHT]).sum())
        held -= 0.5 * float((now[:, FORCE] * now[:, SLOPE] * moved[:, PLACE]).sum())
        touches, outside = self._riders.spring[on] > 0.0, self._riders.size[self._riders.owner[on]] == 0
        rough = np.where(touches, 0.5 * now[:, FORCE] * moved[:, ROUGH], 0.0)
        given, held = given - float(rough[outside].sum()), held - float(rough[~outside].sum())
        taken += 0.5 * float((now[:, FORCE] * moved[:, GAP])[touches].sum())
        stored = 0.0
        for k in np.flatnonzero(np.isfinite(here[:, HEIGHT]) & (self._riders.spring > 0.0)):
            late = 0.5 * (here[k, GAP] - before[k, GAP]) if on[k] else 0.0
            energy = self._squeezed(int(k), float(here[k, GAP] + late), float(here[k, LOCAL]))
            if np.isnan(self._unsqueezed[k]):
                self._unsqueezed[k] = energy
            stored += energy - self._unsqueezed[k]
        return stored, float(given), float(held), float(taken)

    def _squeezed(self, k: int, gap: float, local: float) -> float:
        """Potential energy of the force at contact k, where rider and spline overlap by a gap in m, J."""
        riders = self._riders
        rest, yields = riders.rest[k], local + (0.0 if np.isinf(riders.spring[k]) else 1.0 / riders.spring[k])
        more = (gap - local * rest) / yields if yields > 0.0 else 0.0
        if riders.lifts[k] and (riders.sign[k] * (rest + more) < 0.0 or (yields <= 0.0 and riders.sign[k] * gap < 0.0)):
            return float(0.5 * rest**2 * (2.0 * local - yields))
        return float(rest * gap + 0.5 * yields * more**2)


def _shares(weight: Array) -> Array:
    return np.arange(weight.shape[1] // 2)[None, :]
