"""Rest of structures with inextensible links: least potential energy among the shapes that keep their lengths.

    K dr + G' dmu = F - G' mu,   G dr = -phi,

by Newton's method from a shape close by. F are all other forces, G the changes of phi = (l^2 - h^2)/2 with the shape.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import scipy.linalg
import scipy.sparse as sparse
import scipy.sparse.linalg

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.model.law import Hooke, Inextensible
from ropewalk.model.line import Line
from ropewalk.model.scenario import Scenario
from ropewalk.model.support import Fixed, Guided
from ropewalk.system.elements.structure import Structure

_ROUNDS, _CLOSE, _LONGEST = 60, 1e-11, 0.1
# Axial stiffness over the weight of all lines, of those whose shape inextensible ones begin with.
_STIFF = 1e4
_NEUTRAL = 1e-14  # of the sum of squares, what keeps equations for the first tensions regular
# Roundings of the size of a structure to which lengths can be kept: links are differences of places.
_ROUNDINGS = 8.0


def links_of(structure: Structure) -> tuple[Integers, Array]:
    """Inextensible links by their first node, and their lengths in m."""
    runs, none = structure.runs, np.zeros(0)
    rigid = np.flatnonzero(runs.law[:, 0] == law.RIGID).tolist() if structure.taut is not None else []
    links = [runs.first[s] + np.arange(runs.links[s]) for s in rigid]
    lengths = [np.full(runs.links[s], runs.h[s]) for s in rigid]
    return np.concatenate([none.astype(np.int64), *links]), np.concatenate([none, *lengths])


def nearly(scenario: Scenario) -> Scenario:
    """The same without loads, and with lines that rest close by where those cannot be laid out as chains.

    These are lines that hardly stretch for inextensible ones, and ends that are held for the rollers of beams: without
    bending stiffness a line slides down from there.
    """
    weight = sum(line.mass * (line.length or line.distance) for line in scenario.lines.values()) * scenario.gravity
    weight += sum(joint.mass * scenario.gravity + abs(joint.force[-1]) for joint in scenario.joints.values())
    stiff = {"law": Hooke(), "axial_stiffness": _STIFF * max(weight, 1.0)}
    lines = {
        name: line.model_copy(update=(stiff if isinstance(line.law, Inextensible) else {}) | _restrained(line))
        for name, line in scenario.lines.items()
    }
    return scenario.model_copy(update={"loads": {}, "lines": lines})


def _restrained(line: Line) -> dict[str, Fixed]:
    """Ends of a beam that nothing pulls along their rails, held."""
    ends = line.ends() if line.bending_stiffness else ()
    return {key: Fixed() for key, end in ends if isinstance(end, Guided) and not (end.stiffness or end.force)}


def _of_links(G: sparse.csr_matrix) -> sparse.csc_matrix:
    both = (G @ G.T).tocsc()
    return both + _NEUTRAL * both.diagonal().sum() * sparse.identity(both.shape[0], format="csc")


def gradients(potential: Any, shape: Array, links: Integers) -> sparse.csr_matrix:
    """Change of l^2/2 of some links with the unknowns, kinks included, (link, unknown) m."""
    potential.forces(shape)
    r, _ = potential.put(shape)
    rows, on = potential.rows(r), potential.loaded.on
    if on.size and not potential.structure.is_linearised:
        slope = sparse.diags(potential.loaded.contacts["by_tension"][on])
        rows = rows + potential.borne().T @ slope @ potential.stretched()
    return (rows.tocsr() @ potential.free)[links]


def ways(potential: Any, shape: Array, inner: Integers | None = None) -> Array:
    """Directions in which unknowns, all or some, may move, (unknown, direction): all changes that keep lengths."""
    links, _ = links_of(potential.structure)
    G = gradients(potential, shape, links)
    return np.asarray(scipy.linalg.null_space((G if inner is None else G[:, inner]).toarray()))


def bring(potential: Any, shape: Array, rate: Array) -> tuple[Array, Array]:
    """The shape next to one that has about the right lengths at which it has, and rates (unknown,) that keep these.

    Raises:
        EquilibriumError: there is none.
    """
    (links, h), out = links_of(potential.structure), shape.copy()
    enough = float(h.max()) * max(1e-14 * float(h.max()), _ROUNDINGS * float(np.spacing(potential.size)))
    for _ in range(_ROUNDS):
        G = gradients(potential, out, links)
        phi = 0.5 * (potential.buffers.length[links] ** 2 - h**2)
        if np.abs(phi).max() <= enough:
            return out, rate - G.T @ scipy.sparse.linalg.spsolve(_of_links(G), G @ rate)
        out = potential.moved(out, -G.T @ scipy.sparse.linalg.spsolve(_of_links(G), phi))
    raise EquilibriumError("inextensible lines cannot begin so far from their rest; write a smaller amplitude")


def settle(potential: Any, start: Array) -> Array:
    """The rest next to a shape of a potential energy (`statics.Potential`); notes the tensions there.

    Raises:
        EquilibriumError: there is none.
    """
    structure, buffers = potential.structure, potential.buffers
    links, h = links_of(structure)
    shape, size = start.copy(), potential.size
    if not structure.taut.any():
        buffers.tension[links] = 0.0
        out, G = potential.out_of_balance(shape), gradients(potential, shape, links)
        buffers.tension[links] = h * np.abs(scipy.sparse.linalg.spsolve(_of_links(G), G @ out))  # hanging lines pull
    before = np.inf
    for _ in range(_ROUNDS):
        K, out = potential.stiffness(shape), potential.out_of_balance(shape)
        G, phi = gradients(potential, shape, links), 0.5 * (buffers.length[links] ** 2 - h**2)
        whole = sparse.bmat([[K, G.T], [G, None]], format="csc")
        with warnings.catch_warnings():  # what comes of singular equations is no number
            warnings.simplefilter("ignore", scipy.sparse.linalg.MatrixRankWarning)
            step = scipy.sparse.linalg.spsolve(whole, np.concatenate([out, -phi]))
        moved, pulled = step[: out.size], step[out.size :]
        longest = float(np.abs(moved).max())
        if not np.isfinite(longest):
            break
        part = min(1.0, _LONGEST * size / max(longest, 1e-300))
        shape = potential.moved(shape, part * moved)
        buffers.tension[links] += part * h * pulled
        if longest <= _CLOSE * size or (longest >= before and longest <= 1e3 * _CLOSE * size):
            if not potential.loaded.on.size:
                structure.taut[:] = buffers.tension
            return np.asarray(shape)
        before = longest
    raise EquilibriumError("inextensible lines find no rest; check their lengths, supports and joints")
