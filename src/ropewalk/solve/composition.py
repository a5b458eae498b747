"""Coefficients of symmetric compositions: kicks b1 ... b(m+1) and drifts a1 ... am of one step.

`VERLET` has one stage (order 2). `RKN6` is the Runge-Kutta-Nystrom method SRKN-11-b of order 6 of S. Blanes and
P. C. Moan, J. Comput. Appl. Math. 142 (2002) 313-330, table 3.
"""

from __future__ import annotations

import numpy as np

VERLET = (np.array([0.5, 0.5]), np.array([1.0]))


def _rkn6() -> tuple[np.ndarray, np.ndarray]:
    b = [0.0414649985182624, 0.198128671918067, -0.0400061921041533, 0.0752539843015807, -0.0115113874206879]
    a = [0.123229775946271, 0.290553797799558, -0.127049212625417, -0.246331761062075, 0.357208872795928]
    b = [*b, 0.5 - sum(b)]
    return np.array(b + b[::-1]), np.array([*a, 1.0 - 2.0 * sum(a), *a[::-1]])


RKN6 = _rkn6()
