"""The spectrum of a web at rest: natural frequencies of its small free motions, loads and damping left out."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_matrix, diags

from ropewalk.model.scenario import Scenario
from ropewalk.solve.equations import Equations
from ropewalk.solve.free_vibration import free_vibration
from ropewalk.solve.spectrum import Spectrum
from ropewalk.solve.symmetric import modes
from ropewalk.webs.laying import Laid
from ropewalk.webs.lengths import laid_at_rest
from ropewalk.webs.potential import Potential
from ropewalk.webs.rest import leave
from ropewalk.webs.web import Array


def small_motion(scenario: Scenario) -> tuple[Laid, Array, csc_matrix, Array, csc_matrix]:
    """A web at rest without its loads: itself, places, stiffness and masses of the unknowns, and what these move.

    Raises:
        EquilibriumError: it has no rest.
    """
    laid, rest = laid_at_rest(scenario, 0.0)
    leave(laid.web)
    potential = Potential(laid.web)
    mass = potential.free.multiply(potential.free).T @ np.repeat(laid.web.body.mass, 3)
    return laid, rest, potential.stiffness(rest), np.asarray(mass), potential.free


def frequencies(scenario: Scenario, how_many: int) -> Array:
    """Lowest natural angular frequencies of a web at rest without its loads, rad/s; negative: growth rates in 1/s."""
    _, _, K, mass, _ = small_motion(scenario)
    return modes(K, mass, min(how_many, K.shape[0]))[0]


def spectrum(scenario: Scenario, how_many: int | None = None) -> Spectrum:
    """Natural frequencies and shapes of a web at rest, the lowest ones, and the highest frequency.

    Args:
        scenario: what is there.
        how_many: of the lowest modes.

    Raises:
        EquilibriumError: it has no rest.
    """
    laid, rest, K, mass, free = small_motion(scenario)
    parts = [(s.name, s.node) for s in laid.strands]
    parts += [(sheet.name, vertex) for sheet, vertex in zip(laid.sheets, laid.vertex, strict=True)]
    nodes = np.concatenate([nodes for _, nodes in parts])
    names = tuple(name for name, nodes in parts for _ in nodes)
    moves = free.tocsr()[(3 * nodes[:, None] + np.arange(3)).ravel()]
    none = csc_matrix(K.shape)
    return free_vibration(Equations("web", K, diags(mass).tocsc(), none, moves, rest[nodes], names), how_many)
