"""The spectrum of wires: small free motions in all directions, about rest or an instant, with what stands on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from ropewalk.results.frame import IN_AIR, OFF_LINE, RunInfo
from ropewalk.results.running import TimeHistory
from ropewalk.results.spectrum import Spectrum
from ropewalk.solve.equations import Equations, LinearBody, sprung
from ropewalk.solve.free_vibration import free_vibration
from ropewalk.wires.bearing import Bearing
from ropewalk.wires.contact_location import Location, location_at
from ropewalk.wires.equilibrium import WirePotential, allowed
from ropewalk.wires.frames import Wires
from ropewalk.wires.layout import axes_of
from ropewalk.wires.mesh import Mesh, MovingLoads, moving_loads_of
from ropewalk.wires.plan import Array
from ropewalk.wires.prescribed_motion import ON_GROUND, PrescribedMotion
from ropewalk.wires.rest import beds, rows, ties_springs, vertical_stiffness
from ropewalk.wires.task import WireStart, WireTask, ready


@dataclass(frozen=True)
class _State:
    """Wires, and where the contacts of loads stand on them."""

    mesh: Mesh
    unstrained: Array  # (node,) m
    position: Array  # (3, node) m, about which is linearised
    shape: Array  # (3, node) m, which says whether ties are tight: in small motion another one
    prescribed_motions: tuple[PrescribedMotion, ...] = ()
    locations: tuple[Location | None, ...] = ()  # of each contact; None: it is on no wire
    ground: NDArray[np.bool_] | None = None  # (contact,) whether it is on level ground instead


def spectrum(task: WireTask, how_many: int | None = None) -> Spectrum:
    """Natural frequencies, damping ratios and shapes of wires at rest, without what travels on them.

    Args:
        task: whose wires are meant.
        how_many: of the lowest modes.

    Raises:
        RopewalkError: there is no rest.
    """
    _, start = ready(
        replace(task, prescribed_motions=(), contacts=(), displayed=(), external_models=(), with_loads=False)
    )
    return free_vibration(_equations(_bare(start)), how_many)


def spectrum_with_loads(task: WireTask, how_many: int | None = None) -> Spectrum:
    """The same at rest with what travels, where it begins.

    Raises:
        RopewalkError: there is no such rest.
    """
    if task.geometry == "linearised":
        return spectrum_at(task, 0.0, how_many=how_many)
    task, start = ready(task)
    borne = Bearing(start.mesh, task.prescribed_motions, start.unstrained, space=task.space).stand(0.0, start.position)
    locations = tuple(location if on else None for location, on in zip(borne.locations, borne.touches, strict=True))
    beside = _beside(task)
    ground = np.array([location is None for location in borne.locations], dtype=np.bool_) & beside
    state = _State(
        start.mesh, start.unstrained, borne.position, borne.position, task.prescribed_motions, locations, ground
    )
    return free_vibration(_equations(state), how_many)


def spectrum_at(
    task: WireTask, t: float, *, sample: float | None = None, step: float | None = None, how_many: int | None = None
) -> Spectrum:
    """The same at an instant of a motion, everything frozen as it is then: loads stay where they stand.

    Args:
        task: what moves.
        t: s.
        sample, step: s, of the motion.
        how_many: of the lowest modes.

    Raises:
        RopewalkError: the motion does not come to the instant.
    """
    run = Wires(task, np.array([0.0, t] if t > 0.0 else [0.0]), run_info := RunInfo(), sample, step)
    frame = TimeHistory(run, run_info).last()
    start, mesh = run.start, run.mesh
    shape = start.position.copy()
    shape[axes_of(task)] = frame.position.T
    position = start.position if start.rest is not None else shape
    wire, h = run.moving_loads.wire, mesh.strands.h
    off = np.isin(frame.contact_state, (OFF_LINE, IN_AIR))
    locations = tuple(
        None if off[k] else location_at(mesh, int(wire[k]), float(frame.contact_xi[k]) / float(h[wire[k]]))
        for k in range(off.size)
    )
    ground = (frame.contact_state == OFF_LINE) & _beside(run.task)
    return free_vibration(
        _equations(_State(mesh, start.unstrained, position, shape, run.task.prescribed_motions, locations, ground)),
        how_many,
    )


def _beside(task: WireTask) -> NDArray[np.bool_]:
    """Of each contact, whether there is level ground beside its wire."""
    return np.array(
        [j.beside == ON_GROUND for j in task.prescribed_motions for _ in j.moving_load.contacts], dtype=np.bool_
    )


def _bare(start: WireStart) -> _State:
    return _State(start.mesh, start.unstrained, start.position, start.position)


def _equations(state: _State) -> Equations:
    """Equations of motion of the wires, and of what stands on them."""
    mesh, r = state.mesh, state.position
    potential = WirePotential(mesh, state.unstrained)
    way = allowed(mesh)
    K = way.T @ (potential.stiffness(r) + _loosened(potential, mesh, r, state.shape)) @ way
    C = way.T @ damping_of(potential, mesh, r, state.shape) @ way
    M = way.T @ sparse.diags(np.tile(mesh.mass, 3)) @ way
    names = tuple(w.name for w, n in zip(mesh.plan.wires, mesh.strands.links, strict=True) for _ in range(int(n) + 1))
    # Displacements of one node after the other, from components one after the other.
    order = np.arange(3 * mesh.nodes).reshape(3, mesh.nodes).T.ravel()
    wires = Equations("wires", K.tocsc(), M.tocsc(), C.tocsc(), way.tocsr()[order], r.T, names)
    return wires.with_bodies(_bodies(state, way, float(np.abs(K.diagonal()).max(initial=0.0))))


def _aside(state: _State) -> Array:
    """How far wires are to the left of the middle of their loads, (contact,) m."""
    contacts = [contact for motion in state.prescribed_motions for contact in motion.moving_load.contacts]
    aside = np.zeros(len(contacts))
    for k, (contact, location) in enumerate(zip(contacts, state.locations, strict=True)):
        if location is not None:
            aside[k] = contact.aside(np.array([location.links * state.mesh.strands.h[contact.wire]]))[0]
    return aside


def _bodies(state: _State, way: sparse.csc_matrix, stiffest: float) -> Sequence[LinearBody]:
    """What stands on the wires; its contacts move up and down only, as in motion."""
    if not state.prescribed_motions:
        return []
    moving_loads: MovingLoads = moving_loads_of(
        [prescribed_motion.moving_load for prescribed_motion in state.prescribed_motions]
    )
    assert state.ground is not None
    found = []
    for i, n in enumerate(moving_loads.size):
        touching = [k for k in np.flatnonzero(moving_loads.owner == i) if state.locations[k] is not None]
        resting = [k for k in np.flatnonzero((moving_loads.owner == i) & state.ground) if state.locations[k] is None]
        if not n or not touching:
            continue
        mine = np.array(sorted(touching + resting), dtype=np.int64)
        at, local = sparse.lil_matrix((mine.size, way.shape[0])), np.zeros(mine.size)
        for j, k in enumerate(mine):
            location = state.locations[k]
            if location is not None:
                first = 2 * state.mesh.nodes + location.first
                at[j, first : first + location.weight.shape[1]] = location.weight[0]
                local[j] = location.local
        spring = moving_loads.spring[mine]
        with np.errstate(divide="ignore"):
            yields = np.maximum(local, -0.5 / spring) + 1.0 / spring
        rows = moving_loads.rows(_aside(state))[mine, :n]
        found.append(
            sprung(
                moving_loads.mass[i, :n, :n], moving_loads.damping[i, :n, :n], moving_loads.stiffness[i, :n, :n],
                rows,
                (yields, moving_loads.damper[mine]), at.tocsr() @ way, stiffest,
            )
        )  # fmt: skip
    return found


def _stretched(
    potential: WirePotential, mesh: Mesh, r: Array
) -> tuple[sparse.csr_matrix, Array, Array, NDArray[np.bool_]]:
    """Ties as rows of nodes, their directions (3, tie), lengths in m, and whether each is tight."""
    ties = mesh.ties
    tie = rows(ties.other, mesh.nodes) - rows(ties.one, mesh.nodes)
    d = (tie @ r.T).T + np.where(np.isfinite(ties.ground), ties.ground, 0.0).T
    far = np.sqrt((d**2).sum(axis=0))
    return tie, d / far, far, potential.tie_forces(r) > 0.0


def _loosened(potential: WirePotential, mesh: Mesh, r: Array, shape: Array) -> sparse.csc_matrix:
    """What the stiffness at r changes by where ties are as tight or slack as in another shape, (3 node, 3 node)."""
    tie, way, far, tight = _stretched(potential, mesh, r)
    now = _stretched(potential, mesh, shape)[3]
    pull, push = ties_springs(mesh)
    k = np.where(now, pull, push) - np.where(tight, pull, push)
    N = k * (far - mesh.ties.length) / np.where(far > 0.0, far, 1.0)
    blocks = [
        [tie.T @ sparse.diags((k - N) * way[a] * way[b] + (N if a == b else 0.0)) @ tie for b in range(3)]
        for a in range(3)
    ]
    return sparse.bmat(blocks, format="csc")


def damping_of(potential: WirePotential, mesh: Mesh, r: Array, shape: Array) -> sparse.csc_matrix:
    """Damping of all components (3 node, 3 node), N s/m: drag, retardation, dampers of tight ties and of holds."""
    s, ties, holds = mesh.strands, mesh.ties, mesh.holds
    nodes = [int(n) + 1 for n in s.links]
    drag = np.repeat(s.drag, nodes) * mesh.own
    late = sparse.diags(np.repeat(s.retardation, nodes))
    # Tension and bending, of all components alike; all of a wire's tension, as in motion, whatever reliefs take over.
    whole = mesh._replace(relief=np.zeros_like(mesh.relief))
    felt = late @ (vertical_stiffness(whole) - sparse.diags(beds(mesh)))
    hold, restrained = rows(holds.at, mesh.nodes), np.einsum("hja,hj,hjb->abh", holds.axes, holds.damping, holds.axes)
    tie, way = _stretched(potential, mesh, r)[:2]
    c = np.where(_stretched(potential, mesh, shape)[3], ties.damping, 0.0)
    blocks = [
        [
            tie.T @ sparse.diags(c * way[a] * way[b]) @ tie
            + hold.T @ sparse.diags(restrained[a, b]) @ hold
            + (sparse.diags(drag) + felt if a == b else 0.0 * felt)
            for b in range(3)
        ]
        for a in range(3)
    ]
    C = sparse.bmat(blocks, format="csc")
    C.eliminate_zeros()
    return C
