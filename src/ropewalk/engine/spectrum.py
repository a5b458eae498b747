"""Spectrum: frequencies and modes of small motions about a state."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.sparse import diags_array
from scipy.sparse.linalg import eigsh

from ropewalk.engine.bound import Bound

Array = NDArray[np.float64]
_DENSE = 600
"""Number of unknowns up to which all eigenvalues are computed."""


class Eigenmodes(NamedTuple):
    """Modes of small undamped motions, by rising frequency."""

    squares: Array
    """(mode,) squares of angular frequencies, rad^2/s^2; a negative one belongs to a state that is not stable."""
    shapes: Array
    """(mode, axis, node) displacements; each has the modal mass 1 kg."""

    @property
    def frequencies(self) -> Array:
        """Return the frequencies, Hz; not a number where the state is not stable."""
        with np.errstate(invalid="ignore"):
            return np.asarray(np.sqrt(self.squares) / (2.0 * np.pi))


def find_modes(bound: Bound, count: int) -> Eigenmodes:
    """Return the lowest modes of K and M at the positions of the State, which should be an equilibrium.

    Args:
        bound: structure.
        count: number of modes; fewer if there are fewer unknowns.
    """
    free = bound.unknowns()
    scale = np.sqrt(bound.model.mobility[bound.model.mobility > 0.0])
    scaled = (diags_array(scale) @ free.T @ bound.linearise().stiffness @ free @ diags_array(scale)).tocsc()
    size = scale.size
    if size <= _DENSE or count >= size:
        squares, vectors = scipy.linalg.eigh(scaled.toarray(), subset_by_index=(0, min(count, size) - 1))
    else:
        below = -1e-9 * float(abs(scaled).max())  # K itself may be singular
        squares, vectors = eigsh(scaled, count, sigma=below, v0=np.ones(size))
    shapes = (free @ (scale[:, None] * vectors)).T.reshape(-1, *bound.model.mobility.shape)
    return Eigenmodes(squares, shapes)
