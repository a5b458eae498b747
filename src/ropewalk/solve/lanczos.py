"""Lanczos iteration for a few eigenpairs of large symmetric matrices, with a cause where it does not converge."""

from __future__ import annotations

from typing import Any

from scipy.sparse.linalg import ArpackError, eigsh

from ropewalk.errors import RopewalkError

_VECTORS, _RESTARTS = 60, 50  # of the second attempt: more than usual, and restarts for each unknown


def eigenpairs(matrix: Any, how_many: int, **options: Any) -> Any:
    """Return `how_many` eigenpairs of a symmetric matrix.

    A second attempt takes more vectors, which many alike eigenvalues need.

    Args:
        matrix: (n, n), sparse or an operator.
        how_many: of them.
        options: of `scipy.sparse.linalg.eigsh`.

    Raises:
        RopewalkError: neither attempt converges.
    """
    try:
        return eigsh(matrix, k=how_many, **options)
    except ArpackError:
        count = matrix.shape[0]
        try:
            return eigsh(
                matrix, k=how_many, ncv=min(count, 2 * how_many + _VECTORS), maxiter=_RESTARTS * count, **options
            )
        except ArpackError as error:
            wrong = f"{how_many} modes of {count} unknowns do not converge ({' '.join(str(error).split())})"
            cause = "many are alike, or stiffnesses and masses lie too many orders of magnitude apart"
            raise RopewalkError(f"{wrong}: {cause}; ask for fewer modes, lower elements, or check units") from error
