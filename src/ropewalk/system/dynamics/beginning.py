"""Beginnings of motion: where loads rest; a mode of the structure, at rest or whirling; a stored instant."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import HORIZONTAL, MATERIAL, Array, Integers
from ropewalk.model.beginning import UP
from ropewalk.model.line import spatial
from ropewalk.model.run import Start
from ropewalk.results.stored import stored_instant, stored_stations
from ropewalk.solve.mode_of_structure import mode_of
from ropewalk.system.contact.contact_record import FREE
from ropewalk.system.contact.travel import CLOSE, ROUNDS
from ropewalk.system.elements.inertia import turn_passed
from ropewalk.system.elements.sheaves_at_rest import run_over
from ropewalk.system.elements.structure import Buffers, Structure, SystemState
from ropewalk.system.equilibrium.constrained import bring, ways
from ropewalk.system.equilibrium.rest import settled_in_wind
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.loads.loaded_structure import LoadedStructure

_AWAY = 1e-9  # of the size of a structure: what is held this close is where it was


def begin_elsewhere(
    structure: Structure, state: SystemState, start: Start, displayed: Integers, of_line: Sequence[str], *,
    within: bool, apart: Sequence[str] = (),
) -> None:  # fmt: skip
    """Put a structure at rest, without its loads, into a mode or to where it was at a stored instant.

    Args:
        structure: what moves.
        state: of rest; its places and velocities of nodes are changed.
        start: what the motion begins with.
        displayed: nodes in the order of results.
        of_line: the line of each of these.
        within: whether it stays in the plane.
        apart: overhead lines, each of which has a mode of its own.

    Raises:
        RopewalkError: there is no such mode, or the file does not fit.
    """
    if start.kind == "result":
        _restore(structure, state, start, displayed)
        return
    assert start.amplitude is not None
    potential = SystemPotential(
        structure, LoadedStructure(structure, state.r), float(np.ptp(state.r, axis=1).max()), within=within
    )
    way, number, rest = np.array(spatial(start.direction or UP)), start.number or 1, state.r.copy()
    lines: list[str | None] = [one for one in apart if start.line in (None, one)]
    for name in lines or [start.line]:
        own = [line for line in dict.fromkeys(of_line) if name in (None, line) or line.startswith(f"{name}.")]
        on = np.zeros(rest.shape[1], dtype=np.bool_)
        on[displayed] = np.isin(of_line, own)
        mode = partial(_mode, potential, rest, number, on=None if name is None else on, alone=bool(apart))
        shape, _ = mode(way)
        if start.whirl:  # a quarter of a period later it is where the mode at right angles to it is now
            beside, omega = mode(np.cross(_chord(rest[:, displayed], of_line, own[0]), way))
            state.v[:] += start.amplitude * omega * beside
        state.r[:] += start.amplitude * shape
    if structure.taut is not None:
        solve = sparse.linalg.lsqr(potential.free, state.v.ravel(), atol=0.0, btol=0.0)[0]
        r, rate = bring(potential, state.r.ravel(), solve)
        state.r[:], state.v[:] = r.reshape(state.r.shape), (potential.free @ rate).reshape(state.v.shape)


def begin_in_wind(structure: Structure, state: SystemState, buffers: Buffers) -> None:
    """Put a structure without its loads to its equilibrium in the wind as it blows at t = 0.

    Args:
        structure: what moves.
        state: of the equilibrium in calm air; its places of nodes are changed.
        buffers: of the motion, whose tensions of inextensible links are changed.

    Raises:
        EquilibriumError: there is none.
    """
    size = float(np.ptp(state.r, axis=1).max())
    potential = SystemPotential(structure, LoadedStructure(structure, state.r.copy()), size)
    if structure.saddles is not None:  # friction there holds lines where they lie in calm air
        slips = potential.how
        potential.stick(potential.taken())
        potential.how = slips
    shape = settled_in_wind(potential, potential.taken(), 0.0)
    potential.forces(shape)
    state.r[:] = potential.put(shape)[0]
    if buffers.tight is not None:
        buffers.tension[:] = potential.buffers.tension


def _mode(
    potential: SystemPotential, rest: Array, number: int, way: Array, *, on: NDArray[np.bool_] | None, alone: bool
) -> tuple[Array, float]:
    """Shape (axis, node) of a mode whose largest displacement is 1, and its frequency, rad/s; of some nodes alone."""
    axes, n = rest.shape
    at = rest.ravel()
    K, inner = potential.stability(at)
    if alone and on is not None:
        own = np.asarray(abs(potential.free[:, inner][np.tile(on, axes)]).sum(axis=0)).ravel() > 0.0
        K, inner = K[own][:, own], inner[own]
    M = potential.masses()[inner][:, inner]
    free = potential.free[:, inner].tocsr()
    if potential.structure.taut is not None:
        Z = sparse.csr_matrix(ways(potential, at, inner))
        K, M, free = Z.T @ K @ Z, Z.T @ M @ Z, free @ Z
    component = {2: (0, 2), 3: (0, 1, 2)}[axes]  # of x, y, z
    place = np.add.outer(3 * np.arange(n), component).T.ravel()  # rows of nodes one after the other
    spread = sparse.csr_matrix((np.ones(axes * n), (place, np.arange(axes * n))), shape=(3 * n, axes * n))
    K = (0.5 * (K + K.T)).tocsc()
    shape = mode_of(K, M.tocsc(), spread @ free, number, way, on)
    out = shape[:, component].T
    # What the shape is in the unknowns: they are displacements of nodes.
    q = sparse.linalg.lsqr(free, out.ravel(), atol=0.0, btol=0.0)[0]
    return out, float(np.sqrt((q @ (K @ q)) / (q @ (M @ q))))


def _chord(r: Array, of_line: Sequence[str], line: str) -> Array:
    """Unit vector from the start to the end of a line."""
    own = np.flatnonzero(np.array(of_line) == line)
    way = r[:, own[-1]] - r[:, own[0]]
    return np.asarray(way / np.linalg.norm(way))


def _restore(structure: Structure, state: SystemState, start: Start, displayed: Integers) -> None:
    """Put all nodes to where they were at a stored instant."""
    rest, restrained = state.r.copy(), structure.restraints
    state.r[:, displayed], state.v[:, displayed] = stored_instant(start, displayed.size, rest.shape[0])
    if structure.sheaves is not None:
        stations = stored_stations(start, structure.sheaves.node.size)
        ends = structure.runs.first + structure.runs.links
        run_over(structure.sheaves, structure.runs, structure.lines, stations)
        turn_passed(structure, ends)
    seen, away = set(displayed.tolist()), 0.0
    for e in range(restrained.mass.size):
        nodes = restrained.members(e)
        known = next((int(node) for node in nodes if int(node) in seen), None)
        if known is None:  # a saddle or a sheave that stands fast, of which results say nothing
            continue
        state.r[:, nodes], state.v[:, nodes] = state.r[:, [known]], state.v[:, [known]]
        tied = np.eye(rest.shape[0]) - restrained.free[e]
        if restrained.entries[e] <= 1:
            away = max(away, float(np.abs(tied @ (state.r[:, known] - rest[:, known])).max()))
    if away > _AWAY * float(np.ptp(rest, axis=1).max()):
        raise RopewalkError(
            f"{start.file}: a support stands {away:.3g} m elsewhere in the stored result; use the same lines"
        )


def measure_from_rest(contacts: Any, state: SystemState, locate: Callable[[], object]) -> None:
    """Let prescribed travel begin where loads rest on their lines, which have given way under them.

    They keep the material on which they begin without loads; what is measured along x or an arc is counted from there.

    Args:
        contacts: records; where their travel begins is changed.
        state: at rest, with places along lines.
        locate: puts all contacts where they are now.
    """
    rests, u = state.s.copy(), state.u.copy()
    own = (contacts["travel"] != FREE) & (contacts["measure"] != MATERIAL) & (contacts["moved"] == 0)
    own &= contacts["led"] == 0
    for _ in range(ROUNDS):
        contacts["been"][own], state.u[:] = 0, u  # of a body that leans its contact is beside it
        locate()
        miss = np.where(own, rests - state.s, 0.0)
        if np.abs(miss).max(initial=0.0) <= CLOSE * np.abs(rests).max(initial=0.0):
            break
        along = np.linalg.norm(contacts["along"], axis=1)
        contacts["begin"] += miss * np.where(contacts["measure"] == HORIZONTAL, contacts["along"][:, 0], along)
