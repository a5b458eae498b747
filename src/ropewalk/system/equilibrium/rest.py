"""Rest of the system: least energy, the loads on links shared among nodes, and what is linearised about it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import copy

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.compiled import lean, records
from ropewalk.model.load import AnyLoad
from ropewalk.solve import minimum
from ropewalk.system.elements.cables import add_wind_forces
from ropewalk.system.elements.sheaves import STICKS
from ropewalk.system.elements.sheaves_at_rest import about_rest as sheaves_about_rest
from ropewalk.system.elements.structure import REST, About, Structure
from ropewalk.system.equilibrium import constrained
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.loads.loaded_structure import LoadedStructure

# Rounds in which lines find their rest in the wind, and the move over their size that is none any more.
_ROUNDS, _NEAR = 100, 1e-10
# Tension over axial stiffness from which on a line without bending stiffness is slack.
_LIMP = 1e-12


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
        remedy = "; if a node lies exactly at a sheave in equilibrium, choose another number of elements"
        raise EquilibriumError(f"{error}{remedy if structure.sheaves is not None else ''}") from error


def least(potential: SystemPotential, start: Array, *, close: bool = False) -> Array:
    """The rest next to a shape, or close by or not at all, at which inextensible links have their lengths.

    Raises:
        EquilibriumError: there is none.
    """
    if potential.structure.taut is not None:
        return constrained.settle(potential, start)
    if close:
        return minimum.nearest(potential, start)
    try:
        return minimum.settle(potential, start)
    except EquilibriumError:
        if (firm := _pushing(potential)) is None:
            raise
        return minimum.settle(potential, minimum.settle(firm, start))


def _pushing(potential: SystemPotential) -> SystemPotential | None:
    """The same with links that push where theirs are slack, and so without any stiffness; None if none are."""
    runs, found = potential.structure.runs, copy(potential)
    rows = np.array([law.pushing(row) for row in runs.law])
    if np.array_equal(rows, runs.law):
        return None
    found.structure = potential.structure._replace(runs=runs._replace(law=rows))
    return found


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
    rest = settle(structure, start, within=within)
    shared = with_ends(structure, gravity, tensions(structure, rest))
    return shared, settle(shared, rest, within=within)


def with_ends(structure: Structure, gravity: Array, tension: Array) -> Structure:
    """The same with the loads on its links shared among nodes as at rest, see `at_rest`; `tension` of links, N."""
    restrained, runs = structure.restraints, structure.runs
    fast = {
        int(node) for e in range(restrained.mass.size) if not restrained.free[e].any()
        for node in restrained.members(e)
    }  # fmt: skip
    shift, force = np.zeros_like(runs.shift), structure.nodes.force.copy()
    for s, side, parts in ends_of(structure, tension):
        end, way = (runs.first[s], 1) if side == 0 else (runs.first[s] + runs.links[s], -1)
        rho = runs.rho[s] if structure.segments is None else structure.segments.rho[end]
        for part, node in zip((-parts.sum(), *parts), (0, 1, 2), strict=True):
            force[:, end + way * node] += part * rho * runs.h[s] * gravity
        if end in fast:  # elsewhere the inertia of links acts as the wind does, and is lumped
            shift[s, side] = parts
    return structure._replace(runs=runs._replace(shift=shift), nodes=structure.nodes._replace(force=force))


def ends_of(structure: Structure, tension: Array) -> Iterator[tuple[int, int, Array]]:
    """Runs and sides at which the next two nodes bear parts (2,) of the load on a link for the end."""
    runs, segments = structure.runs, structure.segments
    over = set() if structure.sheaves is None else set(structure.sheaves.run.tolist())  # they end beside sheaves
    for s, (first, links, h) in enumerate(zip(runs.first, runs.links, runs.h, strict=True)):
        for side, (end, link) in enumerate(((first, first), (first + links, first + links - 1))):
            bending = float(runs.bending[s] if segments is None else segments.bending[end]) / h**2
            whole = max(tension[link], 0.0) + bending
            if runs.clamped[s, side] or whole == 0.0 or links < 2 or not runs.arcs[s]:  # there are no two nodes beside
                continue
            if s - 1 + side in over:  # where they end changes
                continue
            zeta = bending / whole
            yield s, side, np.array([(1.0 - zeta) / 6.0 + zeta / 18.0, (zeta - 1.0) / 24.0 + zeta / 72.0])


def about_rest(structure: Structure, rest: Array) -> Structure:
    """The same structure, linearised about places of its nodes at rest (axis, node) in m."""
    potential, found = SystemPotential(structure, LoadedStructure(structure, rest), 1.0), records(rest.shape[1], REST)
    potential.forces(rest.ravel())
    buffers, runs = potential.buffers, structure.runs
    for key in ("strain", "tension", "length", "pull"):
        found[key] = getattr(buffers, key)
    for s, (first, links) in enumerate(zip(runs.first, runs.links, strict=True)):
        if runs.law[s, 0] == law.RIGID:  # what its tension changes by is an unknown of its own
            continue
        found["slope"][first : first + links] = law.tangents(runs.law[s], buffers.strain[first : first + links])
    about = About(np.array([rest, buffers.bent]), found)
    surfaces = None if structure.surfaces is None else structure.surfaces.about_rest(rest)
    sheaves = None if structure.sheaves is None else sheaves_about_rest(structure.sheaves, runs, rest)
    saddles, restrained = structure.saddles, structure.restraints
    if saddles is not None:
        own = [int(np.flatnonzero(restrained.node == node)[0]) for node in saddles.node]
        by = np.searchsorted(restrained.first, own, side="right") - 1
        saddles = saddles.about_rest(rest, structure.nodes.mass, by, restrained.free)
    return structure._replace(about=about, surfaces=surfaces, sheaves=sheaves, saddles=saddles)


def refuse_limp(structure: Structure, line: Sequence[str], loads: Mapping[str, AnyLoad]) -> None:
    """Refuse runs that resist nothing across themselves to the first order about rest, least where loads stand.

    Links of others may be pushed together a little: with these their rest is stable. Ways on nets only lie there.

    Args:
        structure: linearised.
        line: (run,) names.
        loads: that travel over it.

    Raises:
        EquilibriumError: there is such a run.
    """
    runs, links = structure.runs, structure.about.links
    for s in np.flatnonzero((runs.bending == 0.0) & (runs.firm == 0.0)).tolist():
        tension = links["tension"][runs.first[s] : runs.first[s] + runs.links[s]]
        bears = any(load.on == line[s] for load in loads.values())
        weakest = float(tension.min() if bears else np.abs(tension).max())
        EA = float(law.tangent(runs.law[s], 0.0))
        if weakest <= (_LIMP * EA if np.isfinite(EA) else 0.0):
            raise EquilibriumError(
                f"{line[s]} is slack in equilibrium, and in linearised motion only its tension carries transverse "
                "loads: write "
                "geometry: nonlinear, or give it less length"
            )


def tensions(structure: Structure, r: Array) -> Array:
    """Tensions of all links, each by its first node, at places of the nodes (axis, node) in m; N."""
    potential = SystemPotential(structure, LoadedStructure(structure, r), 1.0, how=STICKS)
    potential.forces(r.ravel())
    return potential.buffers.tension


@lean
def _add_wind_forces(structure, buffers, r, v, t):
    """Forces of the wind on what stands still, to `room.air`."""
    add_wind_forces(structure, buffers, r, v, t, 0.0)


def settled_in_wind(potential: SystemPotential, shape: Array, t: float, *, close: bool = False) -> Array:
    """Rest in the wind as it blows at time t in s, next to a shape: what it pushes at depends on it.

    Args:
        potential: of the structure.
        shape: as of the potential.
        t: s.
        close: whether it is close by or not wanted.

    Raises:
        EquilibriumError: there is none.
    """
    structure = potential.structure
    if not structure.wind.direction.any():
        return least(potential, shape, close=close)
    potential.loaded.set_wind(t)
    for done in range(_ROUNDS):
        r = potential.put(shape)[0]
        _add_wind_forces(structure.for_kernels, potential.buffers.for_kernels(structure), r, np.zeros_like(r), t)
        if done and np.array_equal(potential.blown, potential.buffers.air):  # as in calm air
            return shape
        potential.blown[:] = potential.buffers.air
        last, shape = shape, least(potential, shape, close=close)
        if float(np.abs(shape - last).max()) <= _NEAR * potential.size:
            return shape
    raise EquilibriumError("no equilibrium was found in the wind: lines flutter or lift; lower wind.speed")
