"""The spectrum of a web at rest: natural frequencies of its small free motions, loads and damping left out."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_matrix, diags
from scipy.sparse.linalg import eigsh

from ropewalk.model.scenario import Scenario
from ropewalk.solve.spectrum import Spectrum
from ropewalk.webs.lengths import laid_at_rest
from ropewalk.webs.potential import Potential
from ropewalk.webs.rest import leave
from ropewalk.webs.solver import modes
from ropewalk.webs.web import Array

LOWEST = 20  # modes where no number is asked for
_DENSE = 400  # unknowns up to which all eigenvalues are found at once


def stiffness_and_mass(scenario: Scenario) -> tuple[csc_matrix, Array]:
    """Stiffness (unknown, unknown) in N/m and mass (unknown,) in kg of a web at rest without its loads.

    Raises:
        EquilibriumError: it has no rest.
    """
    laid, rest = laid_at_rest(scenario, 0.0)
    leave(laid.web)
    potential = Potential(laid.web)
    mass = potential.free.multiply(potential.free).T @ np.repeat(laid.web.body.mass, 3)
    return potential.stiffness(rest), np.asarray(mass)


def frequencies(scenario: Scenario, how_many: int) -> Array:
    """Lowest natural angular frequencies of a web at rest without its loads, rad/s; negative: growth rates in 1/s."""
    K, mass = stiffness_and_mass(scenario)
    return modes(K, mass, min(how_many, K.shape[0]))[0]


def spectrum(scenario: Scenario, how_many: int | None = None) -> Spectrum:
    """Natural frequencies of a web at rest, the lowest ones and the highest.

    Args:
        scenario: what is there.
        how_many: of the lowest modes.

    Raises:
        EquilibriumError: it has no rest.
    """
    K, mass = stiffness_and_mass(scenario)
    count = K.shape[0]
    found, _ = modes(K, mass, min(how_many or LOWEST, count))
    root = diags(1.0 / np.sqrt(mass))
    scaled = root @ K @ root
    if count <= _DENSE:
        top = float(np.linalg.eigvalsh(scaled.toarray())[-1])
    else:
        top = float(eigsh(scaled, k=1, which="LA", return_eigenvectors=False)[0])
    highest = float(np.sqrt(max(top, 0.0)))
    moving = found[found > 0.0]
    lowest = float(moving.min(initial=np.inf)) if moving.size else 0.0
    growing = found[found < 0.0]
    values = np.concatenate([1j * moving, -1j * moving, -growing, growing, [1j * highest, -1j * highest]])
    return Spectrum(
        name="web", unknowns=2 * count, lowest_frequency=lowest, highest_frequency=highest, slowest_damping_ratio=0.0,
        fastest_damping_ratio=0.0, largest_damping_ratio=0.0, smallest_eigenvalue=lowest, largest_eigenvalue=highest,
        imaginary=True, real_branches=False, unstable=int(growing.size), growth_rate=float(-growing.min(initial=0.0)),
        neutral=int((found == 0.0).sum()), damping_rate=0.0, eigenvalues=values[np.argsort(np.abs(values))],
        complete=False, method="lowest natural frequencies and the highest, without damping and loads",
    )  # fmt: skip
