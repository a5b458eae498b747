"""Rest of the system: least energy, the loads on links shared among nodes, and what is linearised about it."""

from __future__ import annotations

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.compiled import records
from ropewalk.solve import minimum
from ropewalk.system import constrained
from ropewalk.system.loaded_structure import LoadedStructure
from ropewalk.system.sheaves import STICKS
from ropewalk.system.statics import SystemPotential
from ropewalk.system.structure import REST, About, Structure


def settle(structure: Structure, start: Array, *, within: bool = False) -> Array:
    """Places of all nodes at rest without loads next to a shape (axis, node), m; `within` as of `Potential`.

    Raises:
        EquilibriumError: no rest was found.
    """
    potential = SystemPotential(
        structure, LoadedStructure(structure, start), float(np.ptp(start, axis=1).max()), within=within
    )
    try:
        return least(potential, start.ravel()).reshape(start.shape)
    except EquilibriumError as error:
        remedy = "; where a node comes to rest right at a sheave, choose another number of elements"
        raise EquilibriumError(f"{error}{remedy if structure.sheaves is not None else ''}") from error


def least(potential: SystemPotential, start: Array) -> Array:
    """The rest next to a shape, at which inextensible links have their lengths.

    Raises:
        EquilibriumError: there is none.
    """
    found = minimum.settle if potential.structure.taut is None else constrained.settle
    return found(potential, start)


def at_rest(structure: Structure, gravity: Array, start: Array, *, within: bool = False) -> tuple[Structure, Array]:
    """A structure with the loads on its links shared among nodes as at rest, and the places of all nodes there.

    Where a run ends free to turn, its point reflection takes the load on it for one that jumps to its opposite there.
    Arcs and bending, right to the fourth order, see that jump two nodes further: with the load w on a link, the rows of
    the first nodes are (1 + 2/12) w, (1 - 1/24) w under tension and (1 + 1/18) w, (1 + 1/72) w in bending for the shape
    of a constant load. They get as much of what the end node would bear.

    Args:
        structure: with each node bearing half of the links beside it.
        gravity: (axis,) m/s^2.
        start: (axis, node) m, about where its nodes rest.
        within: whether only what stays in the plane needs to be stable.

    Raises:
        EquilibriumError: no rest was found.
    """
    rest, runs = settle(structure, start, within=within), structure.runs
    restrained, segments = structure.restraints, structure.segments
    fast = {
        int(node) for e in range(restrained.mass.size) if not restrained.free[e].any()
        for node in restrained.members(e)
    }  # fmt: skip
    T, shift, force = tensions(structure, rest), np.zeros_like(runs.shift), structure.nodes.force.copy()
    over = set() if structure.sheaves is None else set(structure.sheaves.run.tolist())  # they end beside sheaves
    for s, (first, links, h) in enumerate(zip(runs.first, runs.links, runs.h, strict=True)):
        for side, (end, way, link) in enumerate(((first, 1, first), (first + links, -1, first + links - 1))):
            of = (runs.bending[s], runs.rho[s]) if segments is None else (segments.bending[end], segments.rho[end])
            bending, rho = of[0] / h**2, of[1]
            whole = max(T[link], 0.0) + bending
            if runs.clamped[s, side] or whole == 0.0 or links < 2 or not runs.arcs[s]:  # there are no two nodes beside
                continue
            if s - 1 + side in over:  # where they end changes
                continue
            zeta = bending / whole
            parts = np.array([(1.0 - zeta) / 6.0 + zeta / 18.0, (zeta - 1.0) / 24.0 + zeta / 72.0])
            for part, node in zip((-parts.sum(), *parts), (0, 1, 2), strict=True):
                force[:, end + way * node] += part * rho * h * gravity
            if end in fast:  # elsewhere the inertia of links acts as the wind does, and is lumped
                shift[s, side] = parts
    shared = structure._replace(runs=runs._replace(shift=shift), nodes=structure.nodes._replace(force=force))
    return shared, settle(shared, rest, within=within)


def about_rest(structure: Structure, rest: Array) -> Structure:
    """The same structure, linearised about places of its nodes at rest (axis, node) in m."""
    potential, found = SystemPotential(structure, LoadedStructure(structure, rest), 1.0), records(rest.shape[1], REST)
    potential.forces(rest.ravel())
    buffers, runs = potential.buffers, structure.runs
    for key in ("strain", "tension", "length", "pull"):
        found[key] = getattr(buffers, key)
    for s, (first, links) in enumerate(zip(runs.first, runs.links, strict=True)):
        found["slope"][first : first + links] = law.tangents(runs.law[s], buffers.strain[first : first + links])
    return structure._replace(about=About(np.array([rest, buffers.bent]), found))


def tensions(structure: Structure, r: Array) -> Array:
    """Tensions of all links, each by its first node, at places of the nodes (axis, node) in m; N."""
    potential = SystemPotential(structure, LoadedStructure(structure, r), 1.0, how=STICKS)
    potential.forces(r.ravel())
    return potential.buffers.tension
