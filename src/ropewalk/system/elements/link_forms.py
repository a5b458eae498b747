"""Links and second differences of all lines as matrices, and where the stiffness at rest has entries of them.

They are of which nodes are those of which run, not of where nodes are: a rest is looked for many times over the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.system.elements.compliance import ARC, SHORT_ARC
from ropewalk.system.elements.structure import Structure


class Products:
    """The matrix A diag(c) B as a function of c.

    Args:
        A: (row, factor).
        B: (factor, column).
    """

    def __init__(self, A: sparse.spmatrix, B: sparse.spmatrix) -> None:
        A, B = A.tocsc(), B.tocsr()
        A.eliminate_zeros()
        self._shape = A.shape[0], B.shape[1]
        of_B = np.diff(B.indptr)
        factor = np.repeat(np.arange(A.shape[1]), np.diff(A.indptr))  # of each entry of A
        with_it = of_B[factor]  # entries of B that an entry of A meets
        one = np.repeat(np.arange(A.nnz), with_it)
        other = np.arange(one.size) + np.repeat(B.indptr[factor] - np.cumsum(with_it) + with_it, with_it)
        place = A.indices[one].astype(np.int64) * self._shape[1] + B.indices[other]
        places, target = np.unique(place, return_inverse=True)
        row, self._column = np.divmod(places, self._shape[1])
        self._begin = np.searchsorted(row, np.arange(self._shape[0] + 1))
        entries = A.data[one] * B.data[other], (target, factor[one])
        self._by_factor = sparse.csr_matrix(entries, shape=(places.size, A.shape[1]))

    def of(self, c: Array) -> sparse.csr_matrix:
        """The matrix, (row, column), for the factors c."""
        return sparse.csr_matrix((self._by_factor @ c, self._column, self._begin), shape=self._shape)


def scaled(rows: sparse.csr_matrix, c: Array) -> sparse.csr_matrix:
    """diag(c) rows."""
    data = rows.data * np.repeat(c, np.diff(rows.indptr))
    return sparse.csr_matrix((data, rows.indices, rows.indptr), shape=rows.shape)


_KEPT, _LARGE = 2, 20_000
"""How many are kept, of no more than so many nodes: larger ones take more memory than they save time."""
Entries = list[tuple[Array, Integers, Integers]]
"""Of matrices: values, rows and columns."""


@dataclass(frozen=True)
class LinkForms:
    """Forms are linear in the places of nodes along an axis.

    Args:
        one: links, (node, node).
        two: second differences, (node, node).
        three: second differences beside links, (node, node).
        weight: of the bending energy of second differences, (node,).
        arcs: links that are arcs, 1 or 0, (node,).
        across: stiffness across links, by forms and bed.
        lengthened: change of squares of lengths, by forms.
    """

    one: sparse.csr_matrix
    two: sparse.csr_matrix
    three: sparse.csr_matrix
    weight: Array
    arcs: Array
    across: Products
    lengthened: Products

    @staticmethod
    def of(structure: Structure, axes: int, coordinates: int) -> LinkForms:
        """Those of a structure in so many axes, on which loads have so many coordinates."""
        runs, n = structure.runs, structure.nodes.mass.size
        bends = runs.arcs.astype(np.bool_) | (runs.bending != 0.0) | (structure.segments is not None)
        columns = (runs.first, runs.links, runs.clamped[:, 0], runs.clamped[:, 1], runs.arcs, bends)
        rows = tuple(zip(*(column.tolist() for column in columns), strict=True))
        return (_kept if n <= _LARGE else _of)(rows, n, axes, coordinates)


def _of(rows: tuple[tuple[int, int, bool, bool, float, bool], ...], n: int, axes: int, coordinates: int) -> LinkForms:
    """By first node, links, whether clamped at either end, arcs and whether it bends, of each run."""
    nothing: tuple[Array, Integers, Integers] = np.zeros(0), np.zeros(0, np.int64), np.zeros(0, np.int64)
    of_one: Entries = [nothing]
    of_two: Entries = [nothing]
    weight, arcs = np.ones(n), np.ones(n)
    for first, links, begins, ends, arc, bends in rows:
        arcs[first : first + links] = arc
        _add(of_one, np.arange(first, first + links), (-1.0, 0), (1.0, 1))
        if not bends:  # straight links
            continue
        _add(of_two, np.arange(first + 1, first + links), (1.0, -1), (-2.0, 0), (1.0, 1))
        for end, way, clamped in ((first, 1, begins), (first + links, -1, ends)):
            weight[end] = 0.5
            if clamped:
                _add(of_two, np.array([end]), (-2.0, 0), (2.0, way))
    one, two = (
        sparse.csr_matrix((value, (row, column)), shape=(n, n))
        for value, row, column in (map(np.concatenate, zip(*to, strict=True)) for to in (of_one, of_two))
    )
    three = one @ two  # links are between second differences as between nodes
    forms, none = sparse.vstack([one, two, three]), sparse.csr_matrix((0, coordinates))
    all_forms = sparse.block_diag([*(forms for _ in range(axes)), none], format="csr")
    bed = sparse.eye(n, all_forms.shape[1], n * (axes - 1))  # of places along the last axis
    across = sparse.vstack([all_forms, bed])
    pair, twice = sparse.diags([np.ones(n), np.ones(n - 1)], [0, 1]), sparse.diags(2.0 * arcs)
    links_by_forms = sparse.hstack([sparse.identity(n), ARC * twice @ pair, SHORT_ARC * twice])
    lengthened = Products(sparse.hstack([links_by_forms for _ in range(axes)]), all_forms)
    return LinkForms(one, two, three, weight, arcs, Products(across.T, across), lengthened)


def _add(to: Entries, node: Integers, *stencil: tuple[float, int]) -> None:
    """Entries of rows of nodes: values, and in which columns beside the nodes."""
    to.extend((np.full(node.size, value), node, node + beside) for value, beside in stencil)


_kept = lru_cache(_KEPT)(_of)
