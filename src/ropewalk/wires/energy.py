"""The audit of motion on wires: energies half a step ago, where Störmer's method keeps them, and works up to there."""

from __future__ import annotations

import numpy as np

from ropewalk.results.frame import ENERGY_FORMS
from ropewalk.wires.equilibrium import Potential
from ropewalk.wires.large import LargeMotion, correction
from ropewalk.wires.mesh import Mesh, Riders
from ropewalk.wires.plan import Array
from ropewalk.wires.rest import rows, vertical_stiffness
from ropewalk.wires.riders import GIVEN, HELD, LOST, Pace
from ropewalk.wires.small import SmallMotion

_FORM = {form: i for i, form in enumerate(ENERGY_FORMS)}
_NONE = ("contact_dissipation", "support_work", "friction", "drive_work")


class Audit:
    """Energies and works of a motion; the first ones are the origin.

    In small motion `elastic` is all potential energy about rest, weights included.
    """

    def __init__(
        self, mesh: Mesh, riders: Riders, motion: LargeMotion | SmallMotion, start: Array, unstrained: Array
    ) -> None:
        self._mesh, self._riders, self._motion = mesh, riders, motion
        self._first: float | None = None
        self._damped = bool(mesh.strands.drag.any() or mesh.strands.retardation.any())
        self._damped |= bool(mesh.ties.damping.any() or mesh.holds.damping.any())
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
        """The energies in the order of ENERGY_FORMS, J."""
        motion, energy = self._motion, np.zeros(len(ENERGY_FORMS))
        velocity, mass = motion.velocity, self._mesh.mass
        along = np.array([motion.inertia if isinstance(motion, LargeMotion) else 1.0, 1.0, 1.0])
        energy[_FORM["kinetic"]] = 0.5 * float((mass * (along[:, None] * velocity**2)).sum())
        elastic, gravitational = self._stored()
        energy[_FORM["elastic"]], energy[_FORM["gravitational"]] = elastic, gravitational
        kinetic, potential = self._of_riders(motion.pace)
        energy[_FORM["load_kinetic"]], energy[_FORM["load_potential"]] = kinetic, potential
        given, held, lost = self._works(motion.pace)
        energy[_FORM["load_work"]], energy[_FORM["hold_work"]], energy[_FORM["load_damping"]] = given, held, lost
        # What wires and ties lose is not counted: it is what the rest leaves.
        total = float(energy[:3].sum()) + kinetic + potential + lost - given - held
        if self._first is None:
            self._first = total
        missing = total - self._first
        if self._damped:
            energy[_FORM["line_damping"]] = -missing
            missing = np.nan
        energy[_FORM["imbalance"]] = missing
        return energy

    def _stored(self) -> tuple[float, float]:
        motion = self._motion
        if isinstance(motion, LargeMotion):
            parts = []
            for r in motion.both:
                weights = float(((self._potential.force - self._more) * r).sum())
                parts.append((self._potential.energy(r) + weights, -weights))
            elastic, gravitational = np.mean(parts, axis=0)
            return float(elastic), float(gravitational)
        return float(np.mean([self._about_rest(motion, u) for u in motion.both])), 0.0

    def _about_rest(self, motion: SmallMotion, u: Array) -> float:
        """Potential energy of small motion, zero at rest."""
        s, ties, springs = motion.springs, len(self._mesh.plan.ties), 0.0
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
        assert ties == int(tie.sum())
        return 0.5 * float(u @ (self._stiffness @ u)) + springs

    def _of_riders(self, pace: Pace) -> tuple[float, float]:
        kinetic = potential = 0.0
        for i, n in enumerate(self._riders.size):
            q, last = pace.q[i, :n], pace.last[i, :n]
            rate = (q - last) / pace.step
            kinetic += 0.5 * float(rate @ self._riders.mass[i, :n, :n] @ rate)
            potential += 0.25 * float(q @ self._riders.stiffness[i, :n, :n] @ q)
            potential += 0.25 * float(last @ self._riders.stiffness[i, :n, :n] @ last)
        for k in range(self._riders.owner.size):
            spring, rest, here, before = self._riders.spring[k], self._riders.rest[k], pace.here[k], pace.before[k]
            if np.isnan(here[0]):
                continue
            rise = 0.5 * (here[0] - before[0]) if np.isfinite(before[0]) else 0.0
            potential -= rest * (here[0] + rise - self._riders.base[k])  # weights that a rider counts from
            if 0.0 < spring < np.inf and np.isfinite(pace.gap[k]):
                potential += 0.5 * (here[4] - here[3] - rest) * pace.gap[k]
        return kinetic, potential

    def _works(self, pace: Pace) -> tuple[float, float, float]:
        """Works up to half a step ago: to the last instant that was looked at, and half a step on."""
        here, before = pace.here, pace.before
        on = np.isfinite(here[:, 0]) & np.isfinite(before[:, 0])
        moved = here[on] - before[on]
        given = pace.work[GIVEN] + 0.5 * float((here[on, 3] * moved[:, 0]).sum())
        held = pace.work[HELD] - 0.5 * float((here[on, 4] * here[on, 2] * moved[:, 1]).sum())
        return float(given), float(held), float(pace.work[LOST])


def _shares(weight: Array) -> Array:
    return np.arange(weight.shape[1] // 2)[None, :]
