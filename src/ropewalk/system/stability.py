"""How long a step of explicit motion may be."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Array
from ropewalk.system.bodies import Bodies
from ropewalk.system.compliance import CORRECTION, SHORT
from ropewalk.system.structure import Structure

# Part of the stable step that is used: contacts give way within a step so that they need no less than the half of it.
SAFETY = 0.5
# Largest eigenvalues of the differences of links: of the second one squared with that of its change, over 4.
_BENDING = 80.0 / 3.0
_ARCS = 1.0 + CORRECTION / 3.0 + 2.0 * SHORT / 3.0


def largest_step(structure: Structure, contacts: Any, bodies: Bodies, r: Array) -> float:
    """The step that is used at most, s: 2/omega (sqrt(1 + zeta^2) - zeta) with bounds of frequency and damping.

    Args:
        structure: what moves.
        contacts: of what it carries.
        bodies: what it carries.
        r: (axis, node) m, at rest.
    """
    runs, steps = structure.runs, [np.inf]
    for s in range(runs.first.size):
        part = slice(runs.first[s], runs.first[s] + runs.links[s] + 1)
        length = np.sqrt((np.diff(r[:, part], axis=1) ** 2).sum(axis=0))
        strain = np.concatenate([length / runs.h[s] - 1.0, [0.0]])
        stretched = float(law.tangents(runs.law[s], strain).max())
        taut = float(law.tensions(runs.law[s], strain).max()) * _ARCS
        h, rho = runs.h[s], runs.rho[s]
        square = 4.0 * max(stretched, taut) / (rho * h * h) + _BENDING * runs.bending[s] / (rho * h**4)
        square += runs.bed[s] / rho
        zeta = 2.0 * runs.damping[s] / (rho * h * h) / np.sqrt(square) if square > 0.0 else 0.0
        steps.append(2.0 / np.sqrt(square) * (np.sqrt(1.0 + zeta**2) - zeta) if square > 0.0 else np.inf)
    for p, n in enumerate(bodies.size):
        M, K, C = (matrix[p, :n, :n] for matrix in (bodies.M, bodies.K, bodies.C))
        heavy = np.diag(M) > 0.0
        if heavy.any():
            light = np.linalg.inv(M[np.ix_(heavy, heavy)])
            square = float(np.abs(np.linalg.eigvals(light @ K[np.ix_(heavy, heavy)])).max())
            rate = 0.5 * float(np.abs(np.linalg.eigvals(light @ C[np.ix_(heavy, heavy)])).max())
            omega = math.sqrt(max(square, 1e-300))
            steps.append(2.0 / omega * (math.hypot(1.0, rate / omega) - rate / omega))
    for tether in bodies.tethers:  # at its end, and at the contact with no more than the mass of its own
        mobility = float(bodies.per_mass[int(tether["first"])] + contacts[tether["contact"]]["light"])
        pulled, taken = math.sqrt(float(tether["stiffness"]) * mobility), 0.5 * float(tether["damping"]) * mobility
        steps.append(2.0 / pulled * (math.hypot(1.0, taken / pulled) - taken / pulled))
    return SAFETY * float(min(steps))
