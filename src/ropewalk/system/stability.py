"""How long a step of explicit motion may be."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.fleet import FIRM
from ropewalk.system.bodies import Bodies
from ropewalk.system.compliance import CORRECTION, SHORT
from ropewalk.system.inertia import stiffer
from ropewalk.system.structure import Structure
from ropewalk.webs.fabric import bounds_of_cells

# Part of the stable step that is used. A contact of a body gives way within a step so that it needs half of the square
# of the largest frequency, and leaves the other half.
SAFETY, WITHOUT_LOADS = 0.7, 0.9
SAFETY_OF_NETS = 0.5
# Largest eigenvalues of the differences of links: of the second one squared with that of its change, over 4.
_BENDING = 80.0 / 3.0
# Square of the angle by which lines are expected to turn from where they are heavier along than across.
_TURNED = 0.15**2
_ARCS = 1.0 + CORRECTION / 3.0 + 2.0 * SHORT / 3.0


def largest_step(structure: Structure, contacts: Any, bodies: Bodies, r: Array, rest: Array | None = None) -> float:
    """The step that is used at most, s: 2/omega (sqrt(1 + zeta^2) - zeta) with bounds of frequency and damping.

    Args:
        structure: what moves.
        contacts: of what it carries.
        bodies: what it carries.
        r: (axis, node) m.
        rest: (axis, node) m, if they are not there.
    """
    runs, steps = structure.runs, [np.inf]
    around, viscous = of_cells(structure)
    eased = stiffer(structure, r, r if rest is None else rest) if structure.inertia.along.size else None
    for s in np.flatnonzero(runs.firm == 0.0):
        part = slice(runs.first[s], runs.first[s] + runs.links[s] + 1)
        length = np.sqrt((np.diff(r[:, part], axis=1) ** 2).sum(axis=0))
        strain = np.concatenate([length / runs.h[s] - 1.0, [0.0]])
        stretched = law.tangents(runs.law[s], strain)
        taut = float(law.tensions(runs.law[s], strain).max()) * _ARCS
        h, rho = runs.h[s], runs.rho[s]
        stiffest, viscosity = float(stretched.max()), runs.damping[s]
        if eased is not None:
            own = np.minimum(eased[part][:-1] + _TURNED, 1.0)
            stiffest, viscosity = taut + float((own * stretched[:-1]).max()), viscosity * float(own.max())
        square = 4.0 * max(stiffest, taut) / (rho * h * h) + _BENDING * runs.bending[s] / (rho * h**4)
        square += runs.bed[s] / rho
        rate = 4.0 * viscosity / (rho * h * h)
        if around.size:  # edge cables bear cells, too
            square, rate = square + float(around[part].max()), rate + float(viscous[part].max())
            around[part] = 0.0
        steps.append(_stable(square, rate))
    steps.extend(_stable(float(k), float(c)) for k, c in zip(around, viscous, strict=True))
    for p, n in enumerate(bodies.size):
        M, K, C = (matrix[p, :n, :n] for matrix in (bodies.M, bodies.K, bodies.C))
        heavy = (np.diag(M) > 0.0) & (np.diag(M) < FIRM)  # only its owner moves what is firm
        if heavy.any():
            light = np.linalg.inv(M[np.ix_(heavy, heavy)])
            square = float(np.abs(np.linalg.eigvals(light @ K[np.ix_(heavy, heavy)])).max())
            rate = 0.5 * float(np.abs(np.linalg.eigvals(light @ C[np.ix_(heavy, heavy)])).max())
            steps.append(2.0 / max(math.hypot(math.sqrt(max(square, 0.0)), rate) + rate, 1e-300))
    for tether in bodies.tethers:  # at its end, and at the contact with no more than the mass of its own
        mobility = float(bodies.per_mass[int(tether["first"])] + contacts[tether["contact"]]["light"])
        pulled, taken = math.sqrt(float(tether["stiffness"]) * mobility), 0.5 * float(tether["damping"]) * mobility
        steps.append(2.0 / pulled * (math.hypot(1.0, taken / pulled) - taken / pulled))
    if structure.surfaces is not None:
        return SAFETY_OF_NETS * float(min(steps))
    return (SAFETY if contacts.size else WITHOUT_LOADS) * float(min(steps))


def _stable(square: float, rate: float) -> float:
    """The stable step, s, by bounds of the square of frequencies, 1/s^2, and of rates of decay, 1/s."""
    if square == 0.0:
        return np.inf if rate == 0.0 else 2.0 / rate
    zeta = 0.5 * rate / math.sqrt(square)
    return 2.0 / math.sqrt(square) * (math.hypot(1.0, zeta) - zeta)


def of_cells(structure: Structure) -> tuple[Array, Array]:
    """Bounds (node,) of the square of frequencies that cells make, 1/s^2, and of their rates of decay, 1/s."""
    surfaces, mass = structure.surfaces, structure.nodes.mass
    if surfaces is None:
        return np.zeros(0), np.zeros(0)
    fixed = [structure.holdings.members(int(e)) for e in np.flatnonzero(~structure.holdings.free.any(axis=(1, 2)))]
    moves = mass > 0.0
    moves[np.concatenate([np.zeros(0, dtype=np.int64), *fixed])] = False
    stiffness, damping = bounds_of_cells(surfaces.cells, mass.size)
    per_mass = np.divide(1.0, mass, out=np.zeros_like(mass), where=moves)
    return stiffness * per_mass, damping * per_mass
