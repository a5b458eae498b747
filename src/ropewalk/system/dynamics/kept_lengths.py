"""Lengths of inextensible links in implicit steps: their tensions are unknowns of the stages (docs/notes/implicit.md).

    M v' = f(r, v) - G' mu,   phi(r, t) = (l^2 - h^2)/2 = 0 at all stages,   T = h mu.

Places are put right at each stage, velocities at the end of each step: M dv + G' x = 0, G dv = -d phi/dt at v; then
tensions balance accelerations. Source: Hairer, Lubich & Roche, The Numerical Solution of Differential-Algebraic Systems
by Runge-Kutta Methods (1989), section 6.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

from ropewalk.mechanics.chain import Array
from ropewalk.system.dynamics.carrier import System
from ropewalk.system.dynamics.rates import Forces
from ropewalk.system.equilibrium.constrained import gradients, links_of
from ropewalk.system.equilibrium.statics import SystemPotential


class KeptLengths:
    """The constraints of a system that moves, none where all of its links stretch.

    Args:
        system: what moves.
        potential: of its lines with what stands on them.
        forces: of everything.
    """

    def __init__(self, system: System, potential: SystemPotential, forces: Forces) -> None:
        self._system, self._potential, self._forces = system, potential, forces
        self._links, self._h = links_of(system.structure)
        self.count = self._links.size

    @property
    def pulls(self) -> Array:
        """Multipliers mu as they are, (link,) N/m."""
        return np.asarray(self._system.buffers.tension[self._links] / self._h)

    def pull(self, pulls: Array) -> None:
        """Let links pull so, (link,) N/m."""
        self._system.buffers.tension[self._links] = self._h * pulls

    def misses(self) -> Array:
        """phi of all links where forces were looked at last, (link,) m^2; of what is linearised to the first order."""
        buffers, about = self._system.buffers, self._system.structure.about
        if about.links.size:
            rest = about.links[self._links]
            return np.asarray(rest["length"] * self._h * (buffers.strain[self._links] - rest["strain"]))
        return np.asarray(0.5 * (buffers.length[self._links] ** 2 - self._h**2))

    def linearise(self, kept: Array) -> sparse.csr_matrix:
        """Change of phi with those unknowns that are kept, as everything stands, (link, unknown) m."""
        self._potential.buffers.tension[self._links] = self._system.buffers.tension[self._links]
        return gradients(self._potential, self._potential.taken(), self._links)[:, kept].tocsr()

    def bordered(
        self, G: sparse.csr_matrix, *matrices: sparse.csc_matrix
    ) -> tuple[sparse.csc_matrix, ...]:  # fmt: skip
        """Stiffness, and then what multipliers have no part in, with multipliers as unknowns behind all others."""
        first, *others = matrices
        none = sparse.csc_matrix((self.count, self.count))
        whole = [sparse.bmat([[first, G.T], [G, None]], format="csc")]
        whole += [sparse.block_diag([matrix, none], format="csc") for matrix in others]
        return tuple(whole)

    def settle(self, G: sparse.csr_matrix, M: sparse.csc_matrix, free: sparse.csc_matrix) -> tuple[Array, Array]:
        """Let velocities keep lengths, and tensions keep what velocities do; the state is as after `Forces.at`.

        Args:
            G, M: changes of phi in m, and masses in kg, both of the unknowns.
            free: (place, unknown) what unknowns move.

        Returns:
            Forces on everything, N, and accelerations of all places, m/s^2.
        """
        forces, n, none = self._forces, free.shape[1], np.zeros(free.shape[1])
        t, (shape, rates) = float(self._system.state.t[0]), forces.taken()
        light = sparse.diags((M.diagonal() == 0.0).astype(np.float64))  # which nothing here moves
        solve = splu(sparse.bmat([[M + light, G.T], [G, None]], format="csc")).solve
        change = forces.differenced(t, shape, rates, self.misses)
        rates = rates + free @ solve(np.concatenate([none, -change]))[:n]
        turns = forces.bent(t, shape, rates, self.misses)
        found = solve(np.concatenate([free.T @ forces.at(t, shape, rates), -turns]))
        self.pull(self.pulls + found[n:])
        return forces.at(t, shape, rates), free @ found[:n]
