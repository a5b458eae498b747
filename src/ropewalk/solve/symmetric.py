"""Linear systems with a symmetric stiffness, and its lowest modes.

Two ways, with the same answer to round-off. `band`: the unknowns in the order of Cuthill and McKee, which keeps the
band narrow, and Cholesky's factor of the band. `sparse`: in an order of minimum degree, and SuperLU with pivots on the
diagonal. The order is found once for each pattern; what is factorised again is the numbers alone.
"""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import linalg
from scipy.sparse import csr_array, issparse
from scipy.sparse import linalg as sparse_linalg
from scipy.sparse.csgraph import reverse_cuthill_mckee

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.solve.lanczos import eigenpairs
from ropewalk.solve.one_thread import one_thread

Way = Literal["auto", "band", "sparse"]

# The band is chosen where width^2 < 2000 sqrt(unknowns). Its cost is unknowns * width^2; that of `sparse` goes with
# unknowns^1.5 in a net. Factorisation + one solution in ms on one core of two that were shared, so within a third or
# so; OpenBLAS, SuperLU, three unknowns for each node, nets with diagonals:
#
#                           unknowns   width        band        sparse
#   line of 1000 nodes          3000       5    0.5 + 0.1     2.2 + 0.3
#   footbridge, 900 nodes       2700      23    0.7 + 0.2     2.6 + 0.3
#   strip of 5 x 200            3000      29    1.5 + 0.2     4.6 + 0.2
#   net of 10 x 10               300      59    0.3 + 0.0     0.9 + 0.1
#   20 x 20                     1200     119    1.8 + 0.1     2.8 + 0.2
#   40 x 40                     4800     239     16 + 0.7      24 + 0.8
#   60 x 60                    10800     359     59 + 3        90 + 3
#   80 x 80                    19200     479    300 + 11      270 + 12
#   100 x 100                  30000     599    600 + 28      560 + 27
#   120 x 120                  43200     719   1100 + 49     1100 + 23
#   150 x 150                  67500     899   2300 + 130    2200 + 43
#   200 x 200                 120000    1199   6500 + 450    4000 + 61
#
# The rule goes over at 96 x 96, in the middle of the range in which both are as good. It is wrong where many lines
# leave one node: 100 of them with 30 nodes each have a width of 299, and take 73 ms instead of 8 ms.
_CROSSOVER = 2000.0
# A pivot that is less than this share of its diagonal is what rounding leaves of zero.
_ZERO = 1e-14
_DENSE = 400  # unknowns up to which all modes are computed, 30 ms
_SHIFTS = 10.0 ** np.arange(-8.0, 1.0)


class IndefiniteError(RopewalkError):
    """A stiffness that is not positive definite: the network can give way without being forced, or buckles.

    Attributes:
        unknown: the first, in the order of elimination, that yields for nothing.
    """

    def __init__(self, unknown: int) -> None:
        self.unknown = unknown
        super().__init__(
            f"the stiffness is not positive definite: unknown {unknown} meets no resistance, even while all unknowns "
            "that are eliminated after it are held; support the structure, pre-stress it, or add mass or damping"
        )

    def __reduce__(self) -> tuple[type[IndefiniteError], tuple[int]]:
        return IndefiniteError, (self.unknown,)


class _Places(NamedTuple):
    """Where the entries of matrices with one structure go."""

    indptr: Integers
    indices: Integers
    source: Integers  # entries of the matrix that are used
    target: Integers  # band: where these go
    order: tuple[Any, Any]  # sparse: structure of the reordered matrix


class Solver:
    """Solves K x = b for many K with one pattern."""

    def __init__(self, pattern: Any, way: Way = "auto") -> None:
        """Choose the way and find the order of the unknowns.

        Args:
            pattern: sparse or dense matrix (unknown, unknown) whose entries that are not zero, stored zeros of a sparse
                matrix included, are where any K may have some; symmetric.
            way: `band`, `sparse`, or `auto` for the one that should be faster.

        Raises:
            ValueError: the pattern is not square or not symmetric, or there is no such way.
        """
        if way not in ("auto", "band", "sparse"):
            raise ValueError(f"way must be 'auto', 'band' or 'sparse', not {way!r}")
        graph = _structure(pattern)
        count = graph.shape[0]
        order = np.asarray(reverse_cuthill_mckee(graph, symmetric_mode=True), dtype=np.int64)
        place = np.empty_like(order)
        place[order] = np.arange(count)
        row = np.repeat(np.arange(count), np.diff(graph.indptr))
        self.unknowns = count
        self.width = int(np.abs(place[row] - place[graph.indices]).max(initial=0))
        """Number of diagonals beside the main one, in the order of Cuthill and McKee."""
        self.way: Literal["band", "sparse"]
        if way == "auto":
            self.way = "band" if self.width**2 < _CROSSOVER * np.sqrt(count) else "sparse"
        else:
            self.way = way
        if self.way == "sparse":
            # Any definite matrix with the pattern shows the order.
            ones = graph.astype(np.float64)
            ones.setdiag(ones.sum(axis=1) + 1.0)
            place = np.asarray(_lu(ones.tocsc(), "MMD_AT_PLUS_A").perm_c, dtype=np.int64)
            order = np.argsort(place)
        self._pattern, self._order, self._place = graph, order, place
        self._places: _Places | None = None
        self._band = np.zeros(0)
        self._factor: Any = None

    @property
    def is_definite(self) -> bool:
        """Whether there is a factor: the last K was positive definite."""
        return self._factor is not None

    def factorise(self, K: Any) -> None:
        """Take a stiffness, of which only the structure must be known before.

        Args:
            K: symmetric matrix (unknown, unknown), sparse or dense; the band reads its lower triangle.

        Raises:
            IndefiniteError: K is not positive definite, to round-off.
            ValueError: K has another size, entries outside of the pattern, or such that are not finite.
        """
        self._factor = None
        K = _csr(K)
        if K.shape[0] != self.unknowns:
            raise ValueError(f"this solver is for {self.unknowns} unknowns, not for a matrix of shape {K.shape}")
        if not np.all(np.isfinite(K.data)):
            row = int(np.searchsorted(K.indptr, np.flatnonzero(~np.isfinite(K.data))[0], side="right")) - 1
            raise ValueError(f"the stiffness has an entry that is not finite in row {row}")
        if self._places is None or not (
            np.array_equal(K.indptr, self._places.indptr) and np.array_equal(K.indices, self._places.indices)
        ):
            self._places = self._find_places(K)
        diagonal = K.diagonal()[self._order]
        if self.way == "band":
            self._factor = self._factorise_band(K, self._places, diagonal)
        else:
            self._factor = self._factorise_sparse(K, self._places, diagonal)

    def solve(self, b: ArrayLike) -> Array:
        """Return x of K x = b for the K factorised last; b and x are (unknown,) or (unknown, case).

        Raises:
            RopewalkError: there is no factor.
        """
        if self._factor is None:
            raise RopewalkError("there is no factor to solve with; factorise a positive definite stiffness first")
        right = np.asarray(b, dtype=np.float64)[self._order]
        x = np.empty_like(right)
        if self.way == "band":
            x[self._order] = linalg.cho_solve_banded((self._factor, True), right, check_finite=False)
        else:
            x[self._order] = self._factor.solve(right)
        return x

    def _find_places(self, K: csr_array) -> _Places:
        row = np.repeat(np.arange(self.unknowns), np.diff(K.indptr))
        keys, known = (
            np.repeat(np.arange(self.unknowns, dtype=np.int64), np.diff(m.indptr)) * self.unknowns + m.indices
            for m in (K, self._pattern)
        )
        outside = np.flatnonzero(~np.isin(keys, known, assume_unique=True))
        if outside.size:
            i, j = int(row[outside[0]]), int(K.indices[outside[0]])
            raise ValueError(f"the stiffness has an entry at ({i}, {j}) that is not in the pattern of this solver")
        i, j = self._place[row], self._place[K.indices]
        none = np.zeros(0, dtype=np.int64)
        if self.way == "band":
            source = np.flatnonzero(i >= j)
            i, j = i[source], j[source]
            return _Places(K.indptr.copy(), K.indices.copy(), source, j * (self.width + 1) + i - j, (none, none))
        # The matrix is symmetric: its rows are its columns.
        source = np.lexsort((i, j))
        ends = np.concatenate([[0], np.cumsum(np.bincount(j, minlength=self.unknowns))])
        order = (i[source].astype(np.int32), ends.astype(np.int32))
        return _Places(K.indptr.copy(), K.indices.copy(), source, none, order)

    def _factorise_band(self, K: csr_array, places: _Places, diagonal: Array) -> Array:
        if not self._band.size:
            self._band = np.empty(self.unknowns * (self.width + 1))
        self._band.fill(0.0)
        self._band[places.target] = K.data[places.source]
        band = self._band.reshape(self.unknowns, self.width + 1).T
        try:
            # In place: columns are contiguous, as LAPACK wants them.
            with one_thread():
                factor = linalg.cholesky_banded(band, lower=True, overwrite_ab=True, check_finite=False)
        except linalg.LinAlgError as error:
            minor = int(str(error).partition("-")[0])  # "7-th leading minor not positive definite"
            raise IndefiniteError(int(self._order[minor - 1])) from None
        self._require_definite(factor[0] ** 2, diagonal)
        return np.asarray(factor)

    def _factorise_sparse(self, K: csr_array, places: _Places, diagonal: Array) -> Any:
        from scipy.sparse import csc_array

        matrix = csc_array((K.data[places.source], *places.order), shape=K.shape)
        try:
            factor = _lu(matrix, "NATURAL")
        except RuntimeError as error:
            if "singular" not in str(error):
                raise
            raise IndefiniteError(self._first_zero(matrix)) from None
        # SuperLU leaves the diagonal only where a pivot is zero.
        off = np.flatnonzero(factor.perm_r != factor.perm_c)
        if off.size:
            raise IndefiniteError(int(self._order[off[0]]))
        # SuperLU may have sorted the columns once more, along the tree of elimination.
        self._require_definite(factor.U.diagonal()[factor.perm_c], diagonal)
        return factor

    def _first_zero(self, matrix: Any) -> int:
        """SuperLU does not say where a pivot is zero: with a little on the diagonal it is where no more is left."""
        little = _ZERO * (np.abs(matrix.diagonal()).max() or 1.0)
        factor = _lu((matrix + little * _unit(matrix)).tocsc(), "NATURAL")
        pivots = factor.U.diagonal()[factor.perm_c]
        return int(self._order[np.argmax(pivots <= 2.0 * little)])

    def _require_definite(self, pivots: Array, diagonal: Array) -> None:
        """Sylvester: a symmetric matrix is definite if all pivots are positive."""
        wrong = np.flatnonzero(~(pivots > _ZERO * np.abs(diagonal)))
        if wrong.size:
            raise IndefiniteError(int(self._order[wrong[0]]))


@one_thread()
def modes(K: Any, mass: ArrayLike, how_many: int) -> tuple[Array, Array]:
    """Return the lowest natural frequencies and their shapes, K x = w^2 M x with a lumped mass.

    Args:
        K: symmetric stiffness (unknown, unknown), sparse or dense.
        mass: of each unknown (unknown,), positive, kg.
        how_many: modes wanted; fewer if there are not as many unknowns.

    Returns:
        Frequencies (mode,) in rad/s, ascending; where K is not definite, zeros and, as negative numbers, the rates in
        1/s at which the network gives way. Shapes (unknown, mode) with x^T M x = 1 and a positive largest component.

    Raises:
        ValueError: a mass that is not positive, sizes that do not fit, fewer than one mode.
    """
    K = _csr(K)
    masses = np.asarray(mass, dtype=np.float64)
    count = K.shape[0]
    if masses.shape != (count,):
        raise ValueError(f"mass must be of shape ({count},) as the stiffness has so many unknowns, not {masses.shape}")
    if not np.all(np.isfinite(masses) & (masses > 0.0)):
        raise ValueError(f"every mass must be finite and positive, but unknown {int(np.argmin(masses > 0.0))} has not")
    if how_many < 1:
        raise ValueError(f"how_many must be at least 1, not {how_many}")
    root = np.sqrt(masses)
    row = np.repeat(np.arange(count), np.diff(K.indptr))
    scaled = csr_array((K.data / (root[row] * root[K.indices]), K.indices, K.indptr), shape=K.shape)
    scaled = csr_array(0.5 * (scaled + scaled.T))  # roundings may leave a zero on one side of the diagonal only
    bound = float(np.asarray(abs(scaled).sum(axis=1)).max(initial=0.0))  # Gershgorin: of all squares of frequencies
    how_many = min(how_many, count)
    if count <= _DENSE or how_many > count // 4:
        squares, vectors = linalg.eigh(scaled.toarray(), subset_by_index=(0, how_many - 1))
    else:
        squares, vectors = _lowest(scaled, bound, how_many)
    # Roundings add up like random steps; count instead of its root would take the first mode of a fine mesh for none.
    squares = np.where(np.abs(squares) <= np.sqrt(count) * np.finfo(np.float64).eps * bound, 0.0, squares)
    largest = np.take_along_axis(vectors, np.abs(vectors).argmax(axis=0)[np.newaxis], axis=0)
    shapes = vectors * np.sign(largest) / root[:, np.newaxis]
    return np.sign(squares) * np.sqrt(np.abs(squares)), shapes


def _lowest(matrix: csr_array, bound: float, how_many: int) -> tuple[Array, Array]:
    """Lowest eigenpairs by inverse iteration about a shift below all of them."""
    solver = Solver(matrix)
    shift = 0.0
    for shift in (0.0, *(1.01 * bound * _SHIFTS)):
        try:
            solver.factorise(matrix + shift * _unit(matrix))
            break
        except IndefiniteError:
            continue
    inverse = sparse_linalg.LinearOperator(matrix.shape, matvec=solver.solve, dtype=np.float64)
    # A fixed start gives the same answer each time; it has a share of every mode, symmetric or not.
    start = np.random.default_rng(1).uniform(0.5, 1.5, matrix.shape[0])
    inverses, vectors = eigenpairs(inverse, how_many, which="LA", v0=start)
    squares = 1.0 / inverses - shift
    order = np.argsort(squares)
    return squares[order], vectors[:, order]


def _unit(matrix: csr_array) -> csr_array:
    count = matrix.shape[0]
    return csr_array((np.ones(count), np.arange(count), np.arange(count + 1)), shape=matrix.shape)


def _lu(matrix: Any, order: str) -> Any:
    return sparse_linalg.splu(matrix, permc_spec=order, diag_pivot_thresh=0.0, options={"SymmetricMode": True})


def _csr(matrix: Any) -> csr_array:
    """A square matrix in rows with sorted columns, each entry once."""
    rows = csr_array(matrix if issparse(matrix) else np.asarray(matrix, dtype=np.float64), dtype=np.float64)
    if rows.ndim != 2 or rows.shape[0] != rows.shape[1]:
        raise ValueError(f"a stiffness is square, not of shape {rows.shape}")
    if not rows.has_canonical_format:
        rows = rows.copy()
        rows.sum_duplicates()
    return rows


def _structure(pattern: Any) -> csr_array:
    """Ones where the pattern has entries, and on the diagonal."""
    rows = _csr(pattern)
    ones = csr_array((np.ones(rows.nnz, dtype=np.int8), rows.indices, rows.indptr), shape=rows.shape)
    ones = csr_array(ones + _unit(rows).astype(np.int8))
    ones.data[:] = 1
    ones.sort_indices()
    if (ones != ones.T).nnz:
        raise ValueError("the pattern of a stiffness is symmetric; give every entry (i, j) its (j, i)")
    return ones
