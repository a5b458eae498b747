"""Modes of a structure that moves little: rates, shapes, and how forces drive them, step by step exactly.

    M y'' + C y' + K y = f(t),   y = Re sum shape_k z_k,   z_k' = rate_k z_k + driven_k f

with one complex z_k for each mode that swings, and two real ones for each that does not. Damping that couples modes is
no different: then they are those of the first-order equations. What is left out of the sum follows the forces at once,
y = (K^-1 - sum of the modes at rest) f, by one factorisation of K: the number of modes changes how the structure
swings, and not what it does under forces at rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg as linalg
import scipy.sparse as sparse
from numpy.typing import NDArray

from ropewalk.errors import EquilibriumError, RopewalkError
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.solve.free_vibration import lowest
from ropewalk.solve.one_thread import one_thread
from ropewalk.solve.radau_iia import C as STAGES
from ropewalk.solve.symmetric import Solver

Complex = NDArray[np.complex128]

MOST = 1200  # unknowns up to which all modes are taken, some seconds
AMONG = 400  # modes that are taken of more unknowns, if nothing is said
_FIRM = 1e-9  # of the least square of a frequency: resistance by which the others follow where something drifts
_ALONE = 1e-10  # of the damping of two modes: what couples them is nothing
_APART = 1e-6  # of a frequency: damping that is as close to the critical one is taken this much off it
_CLEAN = 1e-7  # of all rates: what coupled modes miss of their equations
_POWERS: Array = np.asarray(np.linalg.inv(np.vander(STAGES, increasing=True)).T, dtype=np.float64)
"""(stage, power) of the polynomials that are one at a stage and zero at the others."""
RATE_AT_END: Array = _POWERS @ np.arange(3.0)
"""(stage,) what their rates are at the end, over the length of a step."""


@dataclass(frozen=True)
class ModalBasis:
    """Modes of a structure, and what follows without them.

    Args:
        rate: (mode,) 1/s.
        shape: (place, mode), displacements of all places; places are axis by axis.
        driven: (place, mode), by forces there.
        left_out: whether there are more modes.
        stiffness: (unknown, unknown) N/m.
        free: (place, unknown), places moved by unknowns.
        frequency: (mode,) rad/s, without damping.
        still: (place, mode), undamped modes over their frequencies, but for those of what drifts.
        drift: (unknown, drifting mode) what resists nothing, and (unknown, drifting mode) its momenta at 1/s, or none.
        begin: (mode,) m, where all is let go.
    """

    rate: Complex
    shape: Complex
    driven: Complex
    left_out: bool
    stiffness: Any
    free: Any
    frequency: Array
    still: Array
    drift: tuple[Array, Array]
    begin: Complex

    @staticmethod
    def of(
        K: Any, M: Any, C: Any, free: Any, count: int | None = None, drifting: float = 0.0,
        uneven: Any = None, begin: Array | None = None,
    ) -> ModalBasis:  # fmt: skip
        """The lowest modes, of equations of motion (unknown, unknown).

        Args:
            K, M, C: sparse; N/m, kg, N s/m.
            free: (place, unknown), sparse.
            count: how many; None: all that the mesh has, or many.
            drifting: rad/s, next to nothing, given to what resists nothing to the first order; 0: that is refused.
            uneven: N/m, what K has besides, not symmetric, which what is left out does not feel, sparse; None: nothing.
            begin: (unknown,) m, displacements from which all is let go; None: from rest.

        Raises:
            EquilibriumError: something resists nothing to the first order.
        """
        unknowns = K.shape[0]
        if not (M.diagonal() > 0.0).all():
            raise EquilibriumError("something that moves has no mass: kind: linear needs one everywhere; give a mass")
        wanted = min(count or (unknowns if unknowns <= MOST else AMONG), unknowns)
        w, phi = lowest(K, M, wanted)
        drifts = (w == 0.0) & (drifting > 0.0)
        if drifts.any():
            least = 1.0 if drifts.all() else float(w[~drifts].min())
            K = (K + _FIRM * least**2 * M).tocsc()
            w = np.where(drifts, drifting, w)
        if not (w > 0.0).all():
            raise EquilibriumError(
                "the structure has a displacement without stiffness (singular tangent stiffness); give it tension or "
                "bending stiffness, or ask for kind: dynamic"
            )
        D = np.asarray(phi.T @ (C @ phi))
        own = np.diag(D)
        coupled = np.abs(D - np.diag(own)) > _ALONE * max(float(np.abs(own).max(initial=0.0)), 1e-300)
        places = free @ phi
        more = (places / w)[:, ~drifts], (phi[:, drifts], M @ phi[:, drifts])
        start = np.zeros(w.size) if begin is None else phi.T @ (M @ begin)
        if coupled.any() or uneven is not None:
            turning = np.zeros_like(D) if uneven is None else np.asarray(phi.T @ (uneven @ phi))
            rate, shape, driven = _coupled(w, D, turning)
            let_go = rate * (driven @ start) + driven @ (D @ start)  # velocities undone that the rates bring along
            return ModalBasis(rate, places @ shape, places @ driven.T, wanted < unknowns, K, free, w, *more, let_go)
        rate, which, by = alone(w, own)
        shape, let_go = places[:, which], (rate + own[which]) * by * start[which]
        return ModalBasis(rate, shape.astype(np.complex128), shape * by, wanted < unknowns, K, free, w, *more, let_go)

    def remainder(self, at: Array) -> tuple[Array, Array]:
        """What follows without modes where forces act.

        Args:
            at: (place, force), how the places share a unit force.

        Returns:
            Displacements of all places (place, force) and of where the forces act (force, force), m/N.
        """
        if not self.left_out:
            return np.zeros(at.shape), np.zeros((at.shape[1], at.shape[1]))
        if at.shape[0] > MOST:
            moved = self._followed(at)
            return moved, np.asarray(at.T @ moved)
        if "flexibility" not in self.__dict__:  # one table is faster than a solution for each force of each step
            object.__setattr__(self, "flexibility", self._followed(np.eye(at.shape[0])))
        used = np.flatnonzero(at.any(axis=1))
        moved = np.asarray(self.__dict__["flexibility"][:, used] @ at[used])
        return moved, np.asarray(at[used].T @ moved[used])

    def _followed(self, at: Array) -> Array:
        """Displacements of all places (place, force) without modes, m/N."""
        drift, momentum = self.drift
        pushed = self.free.T @ at
        follows = self._solver.solve(pushed - momentum @ (drift.T @ pushed))
        moved = self.free @ (follows - drift @ (momentum.T @ follows)) - self.still @ (self.still.T @ at)
        return np.asarray(moved)

    @property
    def _solver(self) -> Solver:
        if "solver" not in self.__dict__:
            solver = Solver(abs(self.stiffness) + sparse.identity(self.stiffness.shape[0]))
            solver.factorise(0.5 * (self.stiffness + self.stiffness.T))
            object.__setattr__(self, "solver", solver)
        found: Solver = self.__dict__["solver"]
        return found


def alone(w: Array, damping: Array) -> tuple[Complex, Integers, Complex]:
    """Modes that do not know of each other: their rates, 1/s, which undamped modes they are, and how these are driven.

    Args:
        w: (undamped,) natural frequencies, rad/s.
        damping: (undamped,) force over momentum, 1/s.
    """
    d = 0.5 * damping
    d = np.where(np.abs(d - w) < _APART * w, (1.0 + _APART) * w, d)
    swings = d < w
    root = np.sqrt((d**2 - w**2).astype(np.complex128))  # +i nu, or real
    last = np.flatnonzero(~swings)
    own = np.where(swings, 2.0, 1.0) / (2.0 * root)
    rate = np.concatenate([-d + root, (-d - root)[last]])
    return rate, np.append(np.arange(w.size), last), np.append(own, -own[last])


@one_thread()
def _coupled(w: Array, D: Array, S: Array) -> tuple[Complex, Complex, Complex]:
    """Modes of the first-order equations, (w q)' = w q', q'' = -w (w q) - S q - D q' + f.

    Raises:
        RopewalkError: they are not independent.
    """
    n = w.size
    A = np.block([[np.zeros((n, n)), np.diag(w)], [-np.diag(w) - S / w, -D]])
    values, vectors = linalg.eig(A)
    try:
        inverse = np.linalg.inv(vectors)
    except np.linalg.LinAlgError:
        inverse = np.full_like(vectors, np.inf)
    scale = float(np.abs(values).max())
    missed = np.abs((vectors * values) @ inverse - A).max()
    if not missed <= _CLEAN * scale:
        raise RopewalkError(
            "damped modes of the structure coincide and cannot be separated; change a damping by a thousandth"
        )
    kept = np.flatnonzero(values.imag >= 0.0)
    twice = np.where(values[kept].imag > 0.0, 2.0, 1.0)
    return values[kept], vectors[:n, kept] / w[:, None], twice[:, None] * inverse[kept, n:]


class ModalStep:
    """Steps of one length: how all modes go on, forces being polynomials through their values at the stages.

    Args:
        rate: (mode,) 1/s.
        h: s.
    """

    def __init__(self, rate: Complex, h: float) -> None:
        self.h = h
        z = rate * (h * STAGES[:, None])
        self.decay: Complex = np.exp(z)
        """(stage, mode)."""
        phi, factor = _exponentials(z), np.array([1.0, 1.0, 2.0])
        powers = h * factor[:, None, None] * STAGES[None, :, None] ** np.arange(1, 4)[:, None, None] * phi
        self.weight: Complex = np.einsum("im,mjk->jik", _POWERS, powers)
        """(stage, stage of the force, mode) s."""


def _exponentials(z: Complex) -> Complex:
    """phi_1 to phi_3 of z, (3, ...): phi_1 = (e^z - 1)/z, phi_(j+1) = (phi_j - 1/j!)/z; by series where |z| < 1."""
    far = np.where(np.abs(z) < 1.0, 1.0, z)
    one = (np.exp(far) - 1.0) / far
    two = (one - 1.0) / far
    three = (two - 0.5) / far
    near, term = np.where(np.abs(z) < 1.0, z, 0.0), np.ones_like(z)
    sums, factorial = np.zeros((3, *z.shape), dtype=np.complex128), 1.0
    for power in range(20):
        parts = np.array([1.0 / (power + 1.0), 1.0, 1.0])
        parts[1] = parts[0] / (power + 2.0)
        parts[2] = parts[1] / (power + 3.0)
        sums += parts.reshape(3, *(1,) * z.ndim) * (term / factorial)
        term, factorial = term * near, factorial * (power + 1.0)
    return np.where(np.abs(z) < 1.0, sums, np.array([one, two, three]))
