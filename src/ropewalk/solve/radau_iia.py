"""Coefficients of the Radau IIA method of order 5, of three stages.

Source: Hairer & Wanner, Solving Ordinary Differential Equations II, section IV.5, table 5.6.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_S = np.sqrt(6.0)
C: NDArray[np.float64] = np.array([(4.0 - _S) / 10.0, (4.0 + _S) / 10.0, 1.0])
"""Stages, over the length of a step; the last one is its end."""
A: NDArray[np.float64] = np.array(
    [
        [(88.0 - 7.0 * _S) / 360.0, (296.0 - 169.0 * _S) / 1800.0, (-2.0 + 3.0 * _S) / 225.0],
        [(296.0 + 169.0 * _S) / 1800.0, (88.0 + 7.0 * _S) / 360.0, (-2.0 - 3.0 * _S) / 225.0],
        [(16.0 - _S) / 36.0, (16.0 + _S) / 36.0, 1.0 / 9.0],
    ]
)
