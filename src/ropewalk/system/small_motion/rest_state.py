"""A structure at rest without loads as small motion about it knows it: matrices, forces and energy, what holds it.

Lines that do not stretch move in the ways that keep their lengths to the first order,

    G y = 0,   M y'' + C y' + K y = f + G^T lambda,

and their tensions change by the lambda that balance what is left. Friction holds what lies on saddles, and lines at
sheaves that have any: at rest tensions on both sides of these are equal, and it takes a finite motion to overcome it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics.chain import Array
from ropewalk.results.frame import RunInfo
from ropewalk.system.assembling.assembled import Attached
from ropewalk.system.elements.air import stiffness_by_wind
from ropewalk.system.elements.sheaves import LITTLE
from ropewalk.system.elements.structure import Structure
from ropewalk.system.elements.ties import Ties
from ropewalk.system.equilibrium.constrained import gradients, links_of, ways
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.loads.loaded_structure import LoadedStructure
from ropewalk.system.reporting.sticking_friction import StickingFriction

_ROUNDING = 1e-9  # of the largest pull at rest: no more than rounding pushes


class TiesAboutRest:
    """All ties of a structure, and which of them would have slackened or gripped.

    Args:
        rest: (axis, node) m.
    """

    def __init__(self, ties: Ties, rest: Array, attached: Attached) -> None:
        self._way, length, self._longer = ties.look(rest)
        side = np.where(self._longer > 0.0, 0, 1)
        every = np.arange(side.size)
        self._k, self._c, self._pull = ties.k[every, side], ties.c[every, side], ties.forces(rest)
        turns = ~ties.way.any(axis=1)
        self._turn = np.where(turns, self._pull / np.where(length > 0.0, length, 1.0), 0.0)
        self._parts, self._attached = ties.parts(rest.shape[1]), attached
        self._differs = np.flatnonzero(ties.k[:, 0] != ties.k[:, 1])  # where it is longer and where it is shorter
        self._noted: set[int] = set()

    def forces(self, x: Array, v: Array) -> tuple[Array, Array]:
        """Forces (tie,) and what each does to its second end (tie, axis), N.

        Args:
            x: (axis, node) m, from rest.
            v: m/s.
        """
        away, rate = np.asarray(self._parts @ x.T), np.asarray(self._parts @ v.T)
        along = (self._way * away).sum(axis=1)
        force = self._pull + self._k * along + self._c * (self._way * rate).sum(axis=1)
        across = away - along[:, None] * self._way
        return force, force[:, None] * self._way + self._turn[:, None] * across

    def doubt(self, x: Array, t: float, run_info: RunInfo) -> None:
        """Doubt the run once for each tie that would have slackened, or gripped, by time t in s."""
        along = (self._way * np.asarray(self._parts @ x.T)).sum(axis=1)
        little = _ROUNDING * float(np.abs(self._pull).max(initial=0.0))
        for e in self._differs.tolist():
            slack = self._longer[e] <= 0.0
            past = self._longer[e] + along[e]
            if e in self._noted or (past > 0.0) != slack or abs(past) * max(self._k[e], 1.0) <= little:
                continue
            self._noted.add(e)
            if len(self._noted) == 1:
                name = self._attached.tie[e] if e < len(self._attached.tie) else "a tie"
                what = f"at t = {t:.4g} s {name} would {'pull, which is slack' if slack else 'be slack, which is taut'}"
                cause = "linear theory includes only the droppers that are taut in equilibrium"
                run_info.doubt(f"{what} at rest", cause, "run.kind", "ask for kind: dynamic, geometry: linearised")


class RestState:
    """A structure at rest without loads: its matrices, forces and energy to the second order.

    Args:
        structure: with all its geometry.
        rest: (axis, node) m.
        pushed: (place,) N, by the wind, in which it rests; None: in calm air.
    """

    def __init__(self, structure: Structure, rest: Array, pushed: Array | None = None) -> None:
        size = float(np.ptp(rest, axis=1).max())
        potential = SystemPotential(structure, LoadedStructure(structure, rest), size)
        if structure.taut is not None:
            potential.buffers.tension[:] = structure.taut
        shape, n = rest.ravel(), rest.shape[1]
        self.friction = StickingFriction(structure, rest)
        potential.stick(shape)
        K, M, C = potential.stiffness(shape), potential.masses(), potential.damping(shape)
        self.free = potential.free.tocsr()
        self._air: sparse.csc_matrix | None = None
        self.uneven: sparse.csc_matrix | None = None  # N/m, of what turns with the lines: not symmetric
        self._pushed = np.zeros(rest.size) if pushed is None else pushed
        if pushed is not None:
            self._air = stiffness_by_wind(structure, rest, 0.0)
        self._links, self._h = links_of(structure)
        if self._links.size:
            self._all = potential.rows(rest)[self._links].tocsr()  # change of l^2/2 with all places
            self._own, self._to = gradients(potential, shape, self._links).toarray(), self.free
            Z = sparse.csr_matrix(ways(potential, shape))
            K, M, C = Z.T @ K @ Z, (Z.T @ M @ Z).tocsc(), (Z.T @ C @ Z).tocsc()
            self.free = (self.free @ Z).tocsr()
        if self._air is not None:
            self.uneven = (self.free.T @ self._air @ self.free).tocsc()
        self.equations = ((0.5 * (K + K.T)).tocsc(), M, C)
        self.mass = np.tile(structure.nodes.mass, rest.shape[0])  # (place,) kg
        self._elastic = potential.stored(shape)
        potential.forces(shape)
        self._force = potential.buffers.force.ravel().copy()  # N, of lines, cells and weights
        self._weight = structure.nodes.force.ravel().copy()
        # The same of every place by itself, without what holds it.
        restraints = structure.restraints
        bare = structure._replace(
            restraints=restraints._replace(
                stiffness=np.zeros_like(restraints.stiffness), damping=np.zeros_like(restraints.damping)
            )
        )
        whole = SystemPotential(bare, LoadedStructure(bare, rest), potential.size, how=LITTLE)
        if structure.taut is not None:
            whole.buffers.tension[:] = structure.taut
        whole.free = sparse.identity(shape.size, format="csc")
        self._K, self._C = whole.stiffness(shape), whole.damping(shape)
        self._axes = rest.shape[0]
        self._laid: Any = None
        if structure.surfaces is not None:
            self._laid = sparse.block_diag([structure.surfaces.shares(n)] * rest.shape[0]).tocsr()

    def forces(self, x: Array, v: Array, gusts: float) -> Array:
        """Forces of lines, cells, dampers, weights and wind on all places that have gone by x from rest, N."""
        by_air = (1.0 + gusts) * self._pushed - (0.0 if self._air is None else self._air @ x)
        return np.asarray(self._force - self._K @ x - self._C @ v + by_air)

    def stored(self, x: Array) -> float:
        """Energy in lines and cells, J."""
        return self._elastic - float((self._force - self._weight) @ x) + 0.5 * float(x @ (self._K @ x))

    def kept(self, force: Array) -> tuple[Array, Array]:
        """What tensions of links that do not stretch add to forces on all places, with inertia, so that these balance.

        Returns:
            Changes of tensions (node,), by the first node of each link, and all forces (place,), N.
        """
        pulled = np.zeros(force.size // self._axes)
        if not self._links.size:
            return pulled, force
        x = np.linalg.lstsq(self._own.T, self._to.T @ force, rcond=None)[0]
        pulled[self._links] = self._h * x
        return pulled, np.asarray(force - self._all.T @ x)

    def handed(self, force: Array) -> Array:
        """The same forces where ways on nets hand them over to the cells below, N."""
        if self._laid is None:
            return force
        on_ways = np.asarray(self._laid.sum(axis=1)).ravel() != 0.0
        return np.asarray(np.where(on_ways, 0.0, force) + self._laid.T @ np.where(on_ways, force, 0.0))
