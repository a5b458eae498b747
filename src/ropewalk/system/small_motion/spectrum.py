"""The spectrum of the system: small free motions in all directions about rest, damped, with what stands there."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import Layout, RunInfo
from ropewalk.results.running import TimeHistory
from ropewalk.results.spectrum import Spectrum
from ropewalk.solve.equations import Equations
from ropewalk.solve.free_vibration import free_vibration
from ropewalk.system.dynamics.moving import SystemMotion
from ropewalk.system.elements.compliance import AT_REST
from ropewalk.system.elements.winches import BAND
from ropewalk.system.equilibrium.constrained import ways
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.equilibrium.still import SystemStatics
from ropewalk.system.loads.loaded_structure import Carried, LoadedStructure, softness

_AGAIN = 4  # rounds in which a kink and the tension that it makes find each other


def spectrum(scenario: Scenario, how_many: int | None = None, *, with_loads: bool = False) -> Spectrum:
    """Natural frequencies, damping ratios and shapes of cable runs and joints at rest, the lowest ones.

    Args:
        scenario: what is there.
        how_many: of the lowest modes.
        with_loads: whether the loads stand at their start.

    Raises:
        RopewalkError: there is no such rest.
    """
    if not with_loads:
        scenario = scenario.model_copy(update={"loads": {}})
    still = SystemStatics(scenario, RunInfo(), 0.0, space=True)
    return free_vibration(equations_of(still), how_many)


def spectrum_at(scenario: Scenario, t: float, how_many: int | None = None) -> Spectrum:
    """The same at an instant of a motion in s, everything frozen as it is then: loads stay where they stand.

    Raises:
        RopewalkError: the motion does not come to the instant.
    """
    times = np.array([0.0, t] if t > 0.0 else [0.0])
    moving = SystemMotion(scenario, run_info := RunInfo(), times, axes=("x", "y", "z"))
    TimeHistory(moving, run_info).last()
    carried = Carried(moving.contacts, moving.tables, moving.bodies)
    loaded = LoadedStructure(moving.structure, moving.rest, carried)
    loaded.stand_as(moving.state, moving.contacts)
    potential = SystemPotential(moving.structure, loaded, float(np.ptp(moving.rest, axis=1).max()), part=AT_REST)
    if potential.structure.taut is not None:
        potential.buffers.tension[:] = moving.tension
    for _ in range(_AGAIN):  # what stands there presses as it does in motion, where contacts give way in a step
        potential.forces(potential.taken())
        for k in loaded.on:
            at, contact = slice(int(loaded.contacts[k]["first"]), None), loaded.contacts[k]
            axes = moving.rest.shape[0]
            given = softness(contact[None], axes)[0] @ moving.contacts[k]["N"][:axes]
            loaded.state.u[at][:axes] = contact["p"][:axes] + given
    return free_vibration(_equations(potential, potential.taken(), moving.displayed, moving.layout), how_many)


def equations_of(still: SystemStatics) -> Equations:
    """Equations of motion about rest with the loads at their start; contacts of forces have no mass."""
    shape = still.at_rest_with_loads()
    return _equations(_within_dead_bands(still.potential), shape, still.displayed, still.layout)


def _within_dead_bands(potential: SystemPotential) -> SystemPotential:
    """The same with the ends fixed that small motion leaves within the dead bands of their winches."""
    structure = potential.structure
    restrained = structure.restraints
    stands = restrained.winch[:, BAND] > 0.0
    if not stands.any():
        return potential
    fixed = restrained._replace(free=restrained.free * ~stands[:, None, None])
    structure = structure._replace(restraints=fixed)
    found = SystemPotential(structure, potential.loaded, potential.size, within=potential.within, part=AT_REST)
    found.forces(potential.taken())
    return found


def _equations(potential: SystemPotential, shape: Array, nodes: Integers, layout: Layout) -> Equations:
    """Equations of motion about a shape, as results show its nodes; friction holds what lies on saddles."""
    potential.stick(shape)
    K, M, C = potential.stiffness(shape), potential.masses(), potential.damping(shape)
    n = potential.structure.nodes.mass.size
    moves = potential.free.tocsr()[(nodes[:, None] + n * np.arange(3)).ravel()]
    position = potential.put(shape)[0][:, nodes].T.copy()
    if potential.structure.taut is not None:
        Z = sparse.csr_matrix(ways(potential, shape))
        K, M, C, moves = Z.T @ K @ Z, (Z.T @ M @ Z).tocsc(), (Z.T @ C @ Z).tocsc(), moves @ Z
    K = (0.5 * (K + K.T)).tocsc()
    return Equations("system", K, M, C, sparse.csr_matrix(moves), position, layout.node_line)
