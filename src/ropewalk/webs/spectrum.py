"""The spectrum of webs: small free motions about rest or an instant, damped, with what stands on them."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse
from scipy.sparse import csc_matrix

from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import Account
from ropewalk.results.running import TimeHistory
from ropewalk.results.spectrum import Spectrum
from ropewalk.solve.equations import Equations, LinearBody
from ropewalk.solve.free_vibration import free_vibration
from ropewalk.solve.symmetric import modes
from ropewalk.webs.damping import damping_of
from ropewalk.webs.laying import Laid
from ropewalk.webs.lengths import laid_at_rest
from ropewalk.webs.moving import Motion
from ropewalk.webs.potential import Potential
from ropewalk.webs.rest import leave
from ropewalk.webs.seats import hold_on
from ropewalk.webs.still import Still
from ropewalk.webs.web import MASS, Array


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
    """Natural frequencies, damping ratios and shapes of a web at rest without its loads, the lowest ones.

    Args:
        scenario: what is there.
        how_many: of the lowest modes.

    Raises:
        EquilibriumError: it has no rest.
    """
    laid, rest = laid_at_rest(scenario, 0.0)
    leave(laid.web)
    return free_vibration(equations_of(laid, rest, 0.0), how_many)


def spectrum_with_loads(scenario: Scenario, how_many: int | None = None) -> Spectrum:
    """The same at rest with the loads at their start, and with the wind as it blows then.

    Raises:
        RopewalkError: there is no such rest.
    """
    still = Still(scenario, Account(), 0.0)
    rest = still.at_rest_with_loads()
    return free_vibration(equations_of(still.laid, rest, 0.0), how_many)


def spectrum_at(scenario: Scenario, t: float, how_many: int | None = None) -> Spectrum:
    """The same at an instant of a motion in s, everything frozen as it is then: loads stay where they stand.

    Raises:
        RopewalkError: the motion does not come to the instant.
    """
    web = Motion(scenario, account := Account(), np.array([0.0, t] if t > 0.0 else [0.0]))
    TimeHistory(web, account).last()
    return free_vibration(equations_of(web.laid, web.state.r, t), how_many)


def equations_of(laid: Laid, r: Array, t: float) -> Equations:
    """Equations of motion about places (node, 3) in m at time t in s; lines slip at sheaves without friction.

    Masses are clamped to where they stand, contacts of forces have none.
    """
    web, potential = laid.web, Potential(laid.web)
    free = potential.free
    K = potential.stiffness(r)
    M = (free.T @ sparse.diags(np.repeat(web.body.mass, 3)) @ free).tocsc()
    C = (free.T @ damping_of(web, t, r) @ free).tocsc()
    parts = [(s.name, s.node) for s in laid.strands]
    parts += [(sheet.name, vertex) for sheet, vertex in zip(laid.sheets, laid.vertex, strict=True)]
    nodes = np.concatenate([nodes for _, nodes in parts])
    names = tuple(name for name, nodes in parts for _ in nodes)
    rows = free.tocsr()
    moves = rows[(3 * nodes[:, None] + np.arange(3)).ravel()]
    bodies, none, seats = [], np.zeros((3, 3)), web.seats
    for k in np.flatnonzero(seats.kind == MASS):
        hold_on(web, k)
        at = sparse.lil_matrix((3, rows.shape[0]))
        p = int(seats.divided[k])
        for node, share in zip([web.nodes + k, web.links.one[p], web.links.other[p]], seats.hold[k], strict=True):
            for a in range(3):
                at[a, 3 * int(node) + a] += share
        bodies.append(LinearBody(seats.mass[k] * np.eye(3), none, none, sparse.csr_matrix(at.tocsr() @ rows)))
    K = (0.5 * (K + K.T)).tocsc()
    return Equations("web", K, M, C, moves, r[nodes], names).with_bodies(bodies)
