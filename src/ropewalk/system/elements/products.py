"""Sums of A diag(c) B for other c each time and the same sparse A and B, whose pattern is found once.

For some hundred nodes the arithmetic of such a product is nothing beside what it takes to search for its pattern.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics.chain import Array


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
