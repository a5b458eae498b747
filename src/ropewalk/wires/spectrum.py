"""The spectrum of wires at rest: natural frequencies of their small free motions in all directions, loads left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sparse

from ropewalk.solve.free_vibration import free_vibration, shaped
from ropewalk.solve.spectrum import Spectrum
from ropewalk.wires.equilibrium import Potential, allowed
from ropewalk.wires.mesh import Mesh
from ropewalk.wires.plan import Array
from ropewalk.wires.rest import bending_stiffness, rows
from ropewalk.wires.task import Task, ready


def spectrum(task: Task, how_many: int | None = None) -> Spectrum:
    """Natural frequencies, damping ratios and shapes of wires at rest, the lowest ones, and the highest frequency.

    Args:
        task: whose wires are meant; what travels on them is left out.
        how_many: of the lowest modes.

    Raises:
        RopewalkError: there is no rest.
    """
    _, start = ready(replace(task, journeys=(), contacts=(), shown=(), foreigners=()))
    mesh, r = start.mesh, start.position
    potential = Potential(mesh, start.unstrained)
    way = allowed(mesh)
    K, C = way.T @ potential.stiffness(r) @ way, way.T @ damping_of(potential, mesh, r) @ way
    mass = way.power(2).T @ np.tile(mesh.mass, 3)
    found, shapes = free_vibration("wires", K, mass, C if C.nnz else None, how_many)
    moved = (way @ shapes).T
    names = tuple(w.name for w, n in zip(mesh.plan.wires, mesh.strands.links, strict=True) for _ in range(int(n) + 1))
    return replace(found, modes=shaped(found, moved.reshape(-1, 3, mesh.nodes).transpose(0, 2, 1), r.T, names))


def damping_of(potential: Potential, mesh: Mesh, r: Array) -> sparse.csc_matrix:
    """Damping of all components (3 node, 3 node), N s/m: drag, retarded bending, dampers of ties and holds."""
    s, ties, holds = mesh.strands, mesh.ties, mesh.holds
    nodes = [int(n) + 1 for n in s.links]
    drag = np.repeat(s.drag, nodes) * mesh.own
    late = sparse.diags(np.repeat(s.retardation, nodes))
    bent = late @ bending_stiffness(mesh)
    hold, held = rows(holds.at, mesh.nodes), np.einsum("hja,hj,hjb->abh", holds.axes, holds.damping, holds.axes)
    tie = rows(ties.other, mesh.nodes) - rows(ties.one, mesh.nodes)
    d = (tie @ r.T).T + np.where(np.isfinite(ties.ground), ties.ground, 0.0).T
    way = d / np.sqrt((d**2).sum(axis=0))
    blocks = [
        [
            tie.T @ sparse.diags(ties.damping * way[a] * way[b]) @ tie
            + hold.T @ sparse.diags(held[a, b]) @ hold
            + (sparse.diags(drag) + bent if a == b else 0.0 * bent)
            for b in range(3)
        ]
        for a in range(3)
    ]
    C = sparse.bmat(blocks, format="csc")
    C.eliminate_zeros()
    return C
