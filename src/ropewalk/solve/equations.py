"""Linearised equations of motion of any structure, and of the linear bodies that stand on it: sparse matrices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy.linalg as linalg
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array

_RIGID = 1e-9  # of the compliance of what it stands on: a contact that yields less than this part of it is rigid
_LITTLE = 1e-14  # of the largest stiffness: what holds a contact that nothing holds


@dataclass(frozen=True, eq=False)
class LinearBody:
    """What stands on a structure: M u'' + C u' + K u = forces of the structure, u = (coordinates, contacts).

    A contact moves with the unknowns x of the structure by `at` x.
    """

    mass: Array  # (coordinate + contact,) squared, kg
    damping: Array  # N s/m
    stiffness: Array  # N/m
    at: sparse.csr_matrix  # (contact, unknown)

    @property
    def coordinates(self) -> int:
        """How many unknowns of its own it has."""
        return int(self.mass.shape[0] - self.at.shape[0])


@dataclass(frozen=True, eq=False)
class Equations:
    """K x + C x' + M x'' = 0 for small motions x about a state, and what these move."""

    name: str
    stiffness: Any  # (unknown, unknown) N/m, symmetric, sparse
    mass: Any  # kg, positive semidefinite, sparse
    damping: Any  # N s/m, sparse; no entries: there is none
    moves: Any  # (3 node, unknown), sparse: displacements x, y, z of one node after the other
    position: Array = field(default_factory=lambda: np.zeros((0, 3)))  # (node, 3) m, of the state
    line: tuple[str, ...] = ()  # (node,) names of what the nodes belong to

    @property
    def unknowns(self) -> int:
        """Number of displacements."""
        return int(self.stiffness.shape[0])

    def with_bodies(self, bodies: Sequence[LinearBody]) -> Equations:
        """The same with bodies, whose coordinates are put after the unknowns."""
        if not bodies:
            return self
        own = self.unknowns
        extra = sum(body.coordinates for body in bodies)
        K, M, C = (_grown(matrix, extra) for matrix in (self.stiffness, self.mass, self.damping))
        first = own
        for body in bodies:
            n = body.coordinates
            own_part = sparse.csr_matrix((np.ones(n), (np.arange(n), first + np.arange(n))), shape=(n, own + extra))
            along = sparse.vstack([own_part, sparse.csr_matrix(_wider(body.at, own + extra))], format="csr")
            K, M, C = (
                (matrix + along.T @ sparse.csr_matrix(part) @ along).tocsc()
                for matrix, part in ((K, body.stiffness), (M, body.mass), (C, body.damping))
            )
            first += n
        moves = _wider(sparse.csr_matrix(self.moves), own + extra)
        return Equations(self.name, K, M, C, moves, self.position, self.line)

    def without_massless(self) -> Equations:
        """The same with unknowns that have no mass expressed by the others, as they are in balance.

        What dampers do to them counts to the first order.

        Raises:
            RopewalkError: nothing has a mass.
        """
        M = sparse.csr_matrix(self.mass)
        heavy = M.diagonal() > 0.0
        if heavy.all():
            return self
        if not heavy.any():
            raise RopewalkError("there is no spectrum: nothing that moves has a mass")
        K = sparse.csc_matrix(self.stiffness)
        kept, gone = np.flatnonzero(heavy), np.flatnonzero(~heavy)
        inner, across = K[gone][:, gone].tocsc(), K[gone][:, kept]
        try:
            factor = splu(inner)
        except RuntimeError:  # slack beside it: where it is makes no difference
            little = _LITTLE * max(float(np.abs(K.diagonal()).max()), 1e-300)
            factor = splu((inner + little * sparse.identity(gone.size)).tocsc())
        used = np.flatnonzero(np.asarray(abs(across).sum(axis=0)).ravel())
        follow = sparse.lil_matrix((gone.size, kept.size))
        if used.size:
            follow[:, used] = -factor.solve(across[:, used].toarray())
        by = sparse.lil_matrix((K.shape[0], kept.size))
        by[kept, np.arange(kept.size)] = 1.0
        by[gone] = follow
        by = by.tocsr()
        return Equations(
            self.name, (by.T @ K @ by).tocsc(), (by.T @ M @ by).tocsc(), (by.T @ self.damping @ by).tocsc(),
            self.moves @ by, self.position, self.line,
        )  # fmt: skip


def sprung(
    mass: Array, damping: Array, stiffness: Array, row: Array, contacts: tuple[Array, Array], at: sparse.csr_matrix,
    stiffest: float,
) -> LinearBody:  # fmt: skip
    """A body whose contacts are joined to it by springs and dampers, or rigidly.

    Args:
        mass, damping, stiffness: of its coordinates q.
        row: (contact, coordinate), the contact of the body is at row q.
        contacts: compliance in m/N and damping in N s/m between the body and the structure, (contact,); what hardly
            yields is rigid.
        at: (contact, unknown), where the structure is at the contacts.
        stiffest: N/m, of the structure.

    Returns:
        The body with as many coordinates less as there are rigid contacts.
    """
    yields, damper = contacts
    rigid = yields * stiffest <= _RIGID
    n, count = row.shape[1], row.shape[0]
    # q = free p + follow contacts, so that row q is the place of each rigid contact
    free = linalg.null_space(row[rigid]) if rigid.any() else np.eye(n)
    follow = np.zeros((n, count))
    if rigid.any():
        follow[:, rigid] = np.linalg.pinv(row[rigid])
    by = np.hstack([free, follow])
    K, C = by.T @ stiffness @ by, by.T @ damping @ by
    for k in np.flatnonzero(~rigid):
        gap = row[k] @ by
        gap[free.shape[1] + k] -= 1.0
        K += np.outer(gap, gap) / yields[k]
        C += damper[k] * np.outer(gap, gap)
    return LinearBody(by.T @ mass @ by, C, K, at)


def _grown(matrix: Any, more: int) -> Any:
    """A sparse matrix with more rows and columns, empty ones."""
    return sparse.block_diag([matrix, sparse.csc_matrix((more, more))], format="csc") if more else matrix


def _wider(matrix: Any, columns: int) -> Any:
    return sparse.csr_matrix((matrix.data, matrix.indices, matrix.indptr), shape=(matrix.shape[0], columns))
