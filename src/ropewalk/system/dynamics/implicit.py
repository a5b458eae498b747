"""Implicit motion: a method of Radau or Lobatto (`solve/stages.py`) on the same state and forces as the explicit ones.

Source: Hairer & Wanner, Solving Ordinary Differential Equations II, section IV.8. With Z the unknowns of the stages
less those at the start, velocities are V = D Z / dt, accelerations (D V - (D 1) v) / dt, and what is left is one
balance of forces for each stage. Its Jacobian

    D^2/dt^2 (x) M  +  D/dt (x) C  +  1 (x) K

falls apart into the modes of D. It has K and C of rest (`statics.py`), for the contacts as they stand; Newton's method
keeps it as long as it converges.
Forces are those of the kernels (`motion.GIVEN`), with dampers at the velocities of the stage. Coordinates without mass
have an equation without acceleration; multipliers of inextensible links have that of their lengths (`kept_lengths.py`).
Steps end where contacts come, leave or stop (`arrivals.py`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

from ropewalk.mechanics.chain import Array
from ropewalk.model.run import ACCURACY
from ropewalk.solve.radau import GROWTH, LOCAL, NEWTON, SAFETY
from ropewalk.solve.stages import Stages
from ropewalk.system.contact.arrivals import next_change
from ropewalk.system.contact.contact_record import ON
from ropewalk.system.dynamics import motion
from ropewalk.system.dynamics.carrier import System
from ropewalk.system.dynamics.kept_lengths import KeptLengths
from ropewalk.system.dynamics.memory import AtSheaves
from ropewalk.system.dynamics.rates import Forces, Powers
from ropewalk.system.elements.structure import STRUCK, WORKS
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.loads.loaded_structure import Carried, LoadedStructure

# Newton's error over the size of the structure, what rounding leaves of it, and the part of the error of a step that is
# taken where it gets no smaller: kinks are found to a billionth, and their rates to less.
_FINE, _ROUNDING, _STALLED = 1e-11, 1e-13, 1e-2
# Iterations, and the contraction from which on the Jacobian is taken anew, or the step is taken shorter.
_MOST, _SLOW = 20, 0.1
# Steps of almost equal length share their factors; below this part of the time ahead they are given up.
_SAME, _LEAST = 0.02, 1e-12
# By how much what is watched may be above zero where a step ends for it, and the least part of a step by which its end
# is taken nearer.
_JUST, _PART = 1e-8, 1e-3
# The first step, in those of explicit motion.
_FIRST = 4.0


class _Taken(NamedTuple):
    """A step that was taken: its length, s, and its stages."""

    dt: float
    Z: Array  # (stage, unknown)


class Implicit:
    """Implicit steps of a system.

    Args:
        system: what moves.
        rest: (axis, node) m, without loads.
        accuracy: wanted of positions over the whole motion, m.
        longest: step, s.
        first: about the stable step of explicit motion, s.
        method: its stages.
    """

    def __init__(
        self, system: System, rest: Array, accuracy: float, longest: float, first: float, method: Stages
    ) -> None:
        self.system, self._accuracy, self._longest, self._method = system, accuracy, longest, method
        carried = Carried(system.contacts, system.tables, system.bodies)
        self._loaded = LoadedStructure(system.structure, rest, carried, as_moving=True)
        size = float(np.ptp(rest, axis=1).max())
        self._potential = SystemPotential(system.structure, self._loaded, size)
        self._enough = max(min(NEWTON * LOCAL * accuracy, _FINE * size), _ROUNDING * size)
        self._first = min(_FIRST * first, longest)  # s, after a jump
        self.memory = np.array([self._first])  # s, the step to try next
        self.steps = 0
        self._watch: Callable[[], float] | None = None
        self._seen = False
        self._past: tuple[float, float] | None = None  # s, at which what is watched has been seen above zero, and that
        self._forces = Forces(system, self._loaded)
        self._lengths = KeptLengths(system, self._potential, self._forces)
        self._sheaves = AtSheaves(system)
        self._arrange()

    def to(self, end: float, watch: Callable[[], float] | None = None) -> int:
        """Go on to a time in s, or to where what is watched becomes positive; returns what has come of it."""
        self._watch, self._seen, self._past = self._watching(watch), False, None
        while True:
            found = next_change(self.system, end)
            status = self._go(end if found is None else found.before)
            if status != motion.RUNNING:
                return status
            if self._seen:
                if watch is not None and watch() > 0.0:
                    return status
                if (status := self._over_sheaves()) != motion.RUNNING:
                    return status
                self._seen, self._past = False, None
                continue
            if found is None:
                return status
            self.memory[0] = min(self._first, float(self.memory[0]))
            if self._change(found.after):
                return motion.AT_END

    def _watching(self, watch: Callable[[], float] | None) -> Callable[[], float] | None:
        """What is watched, with nodes and loads that come to sheaves."""
        sheaves = self._sheaves
        if not sheaves.any:
            return watch
        return lambda: max(sheaves.passed(), sheaves.stood(), -np.inf if watch is None else watch())

    def _over_sheaves(self) -> int:
        """Let nodes pass that have come to sheaves; returns what has come of it."""
        if self._sheaves.stood() > 0.0:
            return motion.AT_SHEAVE
        passes = self._sheaves.let_pass()
        self._potential.divide()
        self.system.advance(0.0, motion.LOOK)
        return motion.RUNNING if passes else motion.LINE_OUT

    def _change(self, t: float) -> bool:
        """Let contacts come, leave and stop at time t in s; returns whether one leaves that must not.

        Kinks of those that leave straighten at once, which takes less time than a step: what lines lose by it is lost.
        """
        system = self.system
        contacts, state, was = system.contacts, system.state, system.contacts["state"].copy()
        stored, lost = system.advance(0.0, motion.LOOK)[1], float(state.work[STRUCK])
        state.t[0] = t
        system.advance(0.0, motion.LOOK)
        contacts["kink"][(was == ON) & (contacts["state"] != ON)] = 0.0
        state.work[STRUCK] = lost + stored - system.advance(0.0, motion.LOOK)[1]
        off = (contacts["state"] != ON) & np.isfinite(state.s)
        return bool(((contacts["refuses"] == 1) & (contacts["been"] == 1) & off).any())

    def _arrange(self) -> None:
        """Take note of the unknowns: of nodes that move, and of coordinates of loads that are there."""
        self._loaded.stand_as(self.system.state, self.system.contacts)
        self._potential.arrange()
        bodies, free = self.system.bodies, self._potential.free
        stays = np.ones(self._loaded.weight.size, dtype=np.bool_)
        stays[: bodies.load.size] = bodies.gone[bodies.load] == 0
        begin = free.shape[1] - int(self._loaded.moves.sum())
        self._kept = np.concatenate([np.arange(begin), begin + np.flatnonzero(stays[self._loaded.moves])])
        own = np.flatnonzero(self._kept >= free.shape[1] - int(self._loaded.moves[self._loaded.own :].sum()))
        self._led = own  # places of given forces, which follow at once: no step begins with velocities of theirs
        none = sparse.csc_matrix((free.shape[0], self._lengths.count))  # multipliers move nothing
        self._free = sparse.hstack([free[:, self._kept], none], format="csc")
        alone = np.concatenate([np.zeros(self._kept.size), np.ones(self._lengths.count)])
        self._to_unknowns = splu((self._free.T @ self._free + sparse.diags(alone)).tocsc())
        self._gone = self._forces.taken()[1]  # m/s, of loads that are gone, which keep theirs
        self._gone[: self.system.state.r.size] = 0.0
        self._gone[np.unique(self._free.indices)] = 0.0
        self._gone[self.system.state.r.size + self._forces.ground.coordinates] = 0.0  # which move as the ground does
        self._last: _Taken | None = None
        self._factored = 0.0

    def _linearise(self) -> None:
        """Take stiffness and damping of what is there now."""
        loaded, potential, kept = self._loaded, self._potential, self._kept
        loaded.stand_as(self.system.state, self.system.contacts)
        loaded.contacts["speed"] = self.system.contacts["speed"]
        potential.arrange()
        memory = self._forces.memory
        potential.remember(self.system.buffers.lag, memory.softer, slips=memory.slips)
        shape, self._G = potential.taken(), self._lengths.linearise(kept)
        self._K, self._C, self._M = self._lengths.bordered(self._G, *(
            matrix[kept][:, kept].tocsc()
            for matrix in (potential.stiffness(shape), potential.damping(shape), potential.masses())
        ))  # fmt: skip
        memory.recall()
        nothing = (self._K.diagonal() == 0.0) & (self._C.diagonal() == 0.0) & (self._M.diagonal() == 0.0)
        nothing[kept.size :] = False  # of contacts in the air, see `Forces.at`
        self._K = (self._K + sparse.diags(nothing.astype(np.float64))).tocsc()
        self._factored = 0.0

    def _factor(self, dt: float) -> tuple[Callable[[Any], Any], ...]:
        """What solves for each mode of the stages, and, last, for the error."""
        if self._factored == 0.0 or abs(dt / self._factored - 1.0) > _SAME:
            first, *others = (self._solver(mode.value / dt) for mode in self._method.modes)
            value = self._method.modes[0].value
            self._solvers = (first, *others, first if value.imag == 0.0 else self._solver(abs(value) / dt))
            self._factored = dt
        return self._solvers

    def _solver(self, rate: complex) -> Callable[[Any], Any]:
        rate = rate.real if rate.imag == 0.0 else rate
        solve: Callable[[Any], Any] = splu((rate**2 * self._M + rate * self._C + self._K).tocsc()).solve
        return solve

    def _go(self, end: float) -> int:
        """Go on to a time in s up to which no contact changes."""
        state = self.system.state
        begin = float(state.t[0])
        self._forces.begin(min(float(self.memory[0]), end - begin), end)
        self._arrange()
        self._linearise()
        balance = self._balance()
        while (rest := end - float(state.t[0])) > _LEAST * (end - begin):
            wish = min(float(self.memory[0]), self._longest)
            dt = self._nearer(rest / max(np.ceil(rest / wish - 1e-9), 1.0))
            if dt < _LEAST * max(end, end - begin):
                return motion.NOT_FINITE
            taken = self._step(dt, balance)
            balance = balance if taken is None else taken
            if self._seen:  # the next step begins anew
                self.memory[0] = min(self._first, float(self.memory[0]))
                return motion.RUNNING
        state.t[0] = end
        return motion.RUNNING

    def _nearer(self, dt: float) -> float:
        """A step of dt in s, or a shorter one to where what is watched is about to become positive."""
        if self._past is None or self._watch is None:
            return dt
        now = self._watch()
        share = min(max((0.5 * _JUST - now) / (self._past[1] - now), _PART), 1.0 - _PART)
        return min(dt, share * (self._past[0] - float(self.system.state.t[0])))

    def _balance(self) -> Array:
        """Forces on the unknowns in the present state, N."""
        state = self.system.state
        shape, rates = self._forces.taken()
        return np.asarray(self._free.T @ self._forces.at(float(state.t[0]), shape, rates))

    def _step(self, dt: float, before: Array) -> Array | None:
        """Take a step of dt in s; gives forces on the unknowns before it for those after it, None: it is too long."""
        forces, state, t = self._forces, self.system.state, float(self.system.state.t[0])
        contacts = self.system.contacts.copy()
        shape, rates = forces.taken()
        v, self._pulls = self._to_unknowns.solve(self._free.T @ rates), self._lengths.pulls
        Z = self._newton(t, dt, shape, v)
        if Z is None:
            self._last, self.memory[0] = None, 0.4 * dt
            self._back(t, shape, rates)
            self._linearise()
            return None
        error = self._error(dt, Z, v, before)
        if not error <= 1.0:
            self._back(t, shape, rates)
            self.memory[0] = dt * max(0.2, SAFETY * error**-0.25)
            return None
        V = self._method.D @ Z / dt
        acceleration = self._free @ (self._method.D[-1] @ (V - v) / dt)
        powers, work, seen = Powers(forces, contacts), np.zeros(WORKS), -np.inf
        for j in range(Z.shape[0]):
            self._lengths.pull(self._pulls + Z[j, self._kept.size :])
            powers.see(*self._stage(t, dt, shape, Z, V, j))
            seen = seen if self._watch is None else max(seen, self._watch())
        if seen > _JUST:
            self._back(t, shape, rates)
            self._past = t + dt, seen
            return None
        self._seen = seen > 0.0
        if self._past is not None:  # Illinois's way
            self._past = self._past[0], 0.5 * self._past[1]
        for weight, power in zip(self._method.A[-1], powers.at_stages(dt, self._method.D), strict=True):
            work += dt * weight * power
        state.work[:] += work
        self._forces.memory.keep()
        force = powers.force
        if self._lengths.count or not self._quick:
            self._linearise()
        if n := self._lengths.count:
            own = self._G, self._M[:-n, :-n], self._free[:, :-n]
            force, acceleration = self._lengths.settle(*own)
        forces.react(acceleration)
        self._last, self.steps = _Taken(dt, Z), self.steps + 1
        self.memory[0] = min(dt * min(GROWTH, SAFETY * max(error, 1e-12) ** -0.25), self._longest)
        return np.asarray(self._free.T @ force)

    def _back(self, t: float, shape: Array, rates: Array) -> None:
        """Be again as before a step that was too long."""
        self._lengths.pull(self._pulls)
        self._forces.at(t, shape, rates)

    def _stage(self, t: float, dt: float, shape: Array, Z: Array, V: Array, j: int) -> tuple[float, Array, Array]:
        """Time, places and velocities of everything at stage j."""
        when = t + self._method.C[j] * dt
        moved = shape + self._free @ Z[j] + self._forces.driven(when) - self._forces.driven(t)
        return when, moved, self._free @ V[j] + self._forces.driven_rates(when) + self._gone

    def _left(self, t: float, shape: Array, rates: Array, z: Array) -> Array:
        """Forces on the unknowns at a stage whose unknowns have gone by z, N, and what lengths miss there, m^2."""
        n = self._kept.size
        self._lengths.pull(self._pulls + z[n:])
        out = np.asarray(self._free.T @ self._forces.at(t, shape, rates))
        out[n:] = -self._lengths.misses()
        return out

    def _guess(self, dt: float, v: Array) -> Array:
        """Stages as the polynomial of the step before goes on."""
        C = self._method.C
        if self._last is None:
            return np.outer(C * dt, v)
        later = C > 0.0
        at, x = np.concatenate([[0.0], C[later]]), 1.0 + C * dt / self._last.dt
        values = np.vstack([np.zeros(v.size), self._last.Z[later]])
        out = -np.tile(self._last.Z[-1], (C.size, 1))
        for i in range(at.size):
            basis = np.prod([(x - at[k]) / (at[i] - at[k]) for k in range(at.size) if k != i], axis=0)
            out += np.outer(basis, values[i])
        return out

    def _newton(self, t: float, dt: float, shape: Array, v: Array) -> Array | None:
        """Stages of a step, (stage, unknown); None: they are not found."""
        solvers, D = self._factor(dt), self._method.D
        Z, before, theta = self._guess(dt, v), np.inf, 0.0
        self._quick = True
        for iteration in range(_MOST):
            V = D @ Z / dt
            M_a = self._M @ (D @ (V - v) / dt).T
            g = np.array([self._left(*self._stage(t, dt, shape, Z, V, j), Z[j]) - M_a[:, j] for j in range(len(Z))])
            if not np.isfinite(g).all():
                return None
            step = np.zeros_like(Z)
            for (value, of_stages, share), solve in zip(self._method.modes, solvers, strict=False):
                x = solve((of_stages.real if value.imag == 0.0 else of_stages) @ g)
                step += np.outer(share, x).real
            Z = Z + step
            change = float(np.abs(self._free @ step.T).max(initial=0.0))
            theta = change / before
            self._quick = theta < _SLOW
            if change <= self._enough or (iteration > 0 and theta < 0.5 and theta * change <= 0.1 * self._enough):
                return Z
            if iteration > 1 and theta > 0.9:
                return Z if change <= _STALLED * LOCAL * min(self._accuracy, ACCURACY) else None
            before = change
        return None

    def _error(self, dt: float, Z: Array, v: Array, before: Array) -> float:
        """The embedded estimate of the error of a step, over what it may be."""
        V, controller, rate = self._method.D @ Z / dt, self._method.controller, abs(self._method.modes[0].value) / dt
        first, second = v - controller @ Z / dt, before - self._M @ (controller @ (V - v)) / dt
        first[self._led] = 0.0
        found = self._factor(dt)[-1](second + rate * (self._M @ first) + self._C @ first)
        return float(np.abs(self._free @ found).max(initial=0.0)) / (LOCAL * self._accuracy)
