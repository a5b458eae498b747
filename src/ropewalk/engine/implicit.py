"""Implicit motion: Radau's method of two stages, with the K and C of the elements."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from ropewalk.engine.bound import Advance, Bound
from ropewalk.errors import RopewalkError

Array = NDArray[np.float64]
_A = np.array([[5.0, -1.0], [9.0, 3.0]]) / 12.0
_TOLERANCE = 1e-13
"""Last change of positions in Newton's method over the size of the structure."""


def advance_implicitly(bound: Bound, steps: int, dt: float, iterations: int = 30) -> Advance:
    """Take steps of Radau's method IIA of the third order, which is stable however large they are.

    Hairer and Wanner, Solving Ordinary Differential Equations II, 1996, section IV.5.

    Args:
        bound: structure without loads.
        steps: number of steps.
        dt: step, s.
        iterations: largest number of steps of Newton's method in each; if they do not suffice, the motion ends
            as `diverged` in the last State that was computed.

    Raises:
        RopewalkError: the structure has loads.
    """
    if bound.model.sizes["CONTACTS"]:
        raise RopewalkError("implicit steps do not move loads; use Bound.advance")
    state, velocities = bound.state, bound.velocities()
    for count in range(steps):
        if bound.stop.value:
            return Advance(count, "stopped")
        position = state.position.copy()
        stages = _solve_stages(bound, velocities, dt, iterations)
        if stages is None:
            state.position[:] = position
            return Advance(count, "diverged")
        state.position[:] = position + dt * np.tensordot(_A[1], stages, 1)
        state.velocity[:] = velocities = stages[1]
        state.predicted[:] = velocities[:, : state.predicted.shape[1]]
        state.lag[:] = 0.0
        state.time[:] += dt
    return Advance(steps, "done")


def _solve_stages(bound: Bound, velocities: Array, dt: float, iterations: int) -> Array | None:
    """Return the velocities (stage, axis, node) of both stages by Newton's method; None if it does not converge."""
    free, position = bound.unknowns(), bound.state.position.copy()
    mass = sparse.diags_array(1.0 / bound.model.mobility[bound.model.mobility > 0.0])
    size, stages = float(np.ptp(position)), np.array([velocities, velocities])
    for _ in range(iterations):
        tangents = []
        for row, stage in zip(_A, stages, strict=True):
            bound.state.position[:] = position + dt * np.tensordot(row, stages, 1)
            tangents.append(bound.linearise(stage))
        impulses = dt * _A @ [free.T @ each.forces.ravel() for each in tangents]
        K, C = ([free.T @ getattr(each, name) @ free for each in tangents] for name in ("stiffness", "damping"))
        blocks = [
            [(i == k) * mass + dt * _A[i, k] * C[k] + dt**2 * sum(_A[i, j] * _A[j, k] * K[j] for j in (0, 1))
             for k in (0, 1)]
            for i in (0, 1)
        ]  # fmt: skip
        gains = np.array([mass @ (each - velocities)[bound.model.mobility > 0.0] for each in stages])
        try:
            change = splu(sparse.block_array(blocks, format="csc")).solve((impulses - gains).ravel())
        except RuntimeError:  # exactly singular
            return None
        if not np.all(np.isfinite(change)):
            return None
        stages += (change.reshape(2, -1) @ free.T).reshape(stages.shape)
        if dt * float(np.abs(change).max(initial=0.0)) <= _TOLERANCE * size:
            return stages
    return None
