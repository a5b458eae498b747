"""Stages of implicit Runge-Kutta methods whose last one is the end of the step, and what follows from their matrix.

Source: Hairer & Wanner, Solving Ordinary Differential Equations II, sections IV.5 (tables 5.6, 5.12), IV.8.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.solve import radau_iia

_Array = NDArray[np.float64]
_S = np.sqrt(5.0)


class Mode(NamedTuple):
    """A share of all stages that is solved for by itself; of pairs that are conjugate it is one, counted twice."""

    value: complex  # eigenvalue of D
    of_stages: NDArray[np.complex128]  # (stage,) how much of it each stage has
    share: NDArray[np.complex128]  # (stage,) what each stage takes of it, the part of its conjugate included


class Stages(NamedTuple):
    """An implicit Runge-Kutta method."""

    C: _Array  # (stage,) over the length of a step
    A: _Array  # (stage, stage); the last row has the weights
    D: _Array  # inverse of A
    controller: _Array  # (stage,) weights of the rate at the start, of a polynomial through it and all later stages
    modes: tuple[Mode, ...]

    @staticmethod
    def of(C: _Array, A: _Array) -> Stages:
        """The method with these coefficients."""
        later = np.flatnonzero(C > 0.0)
        D: _Array = np.linalg.inv(A).astype(np.float64)
        controller = np.zeros(C.size)
        for i in later:
            others = [C[k] for k in later if k != i]
            controller[i] = np.prod([-c / (C[i] - c) for c in others]) / C[i]
        values, vectors = np.linalg.eig(D)  # of real numbers, for pairs that are conjugate to the last bit
        values, vectors = values.astype(np.complex128), vectors.astype(np.complex128)
        inverse = np.linalg.inv(vectors)
        modes = [
            Mode(complex(values[i]), inverse[i], vectors[:, i] * complex(1.0 if values[i].imag == 0.0 else 2.0))
            for i in np.flatnonzero(values.imag >= 0.0)
        ]
        return Stages(C, A, D, controller, tuple(sorted(modes, key=lambda mode: abs(mode.value.imag))))


RADAU = Stages.of(radau_iia.C, radau_iia.A)
"""Radau IIA of order 5."""
LOBATTO = Stages.of(
    np.array([0.0, (5.0 - _S) / 10.0, (5.0 + _S) / 10.0, 1.0]),
    np.array(
        [
            [5.0, -5.0 * _S, 5.0 * _S, -5.0],
            [5.0, 15.0, 10.0 - 7.0 * _S, _S],
            [5.0, 10.0 + 7.0 * _S, 15.0, -_S],
            [5.0, 25.0, 25.0, 5.0],
        ]
    )
    / 60.0,
)
"""Lobatto IIIC of order 6."""
