"""Rest of wires with all geometry: the least potential energy, by Newton's method."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from ropewalk.results.frames import summed
from ropewalk.solve import minimum
from ropewalk.solve.minimum import newton
from ropewalk.solve.symmetric import Way
from ropewalk.wires.mesh import Mesh
from ropewalk.wires.plan import Array, Integers
from ropewalk.wires.pressing import Pressing
from ropewalk.wires.rest import beds, bending_stiffness, rows, spring, ties_springs
from ropewalk.wires.spline import WIDTH

_PARTS = 8  # in which constant forces are put on, where rest is hard to find
_ROUNDS, _ON_RAIL = 5, 1e-14  # in which ends are brought onto their rails, and how closely, of the longest wire


class WirePotential:
    """Potential energy of wires, its gradient and its second derivatives, as functions of all positions (3, node).

    Args:
        mesh: the wires and what is attached to them.
        rest: (node,) m, unstrained length of the link behind each node.
        force: (3, node) N, constant forces beside gravity.

    Attributes:
        pressing: what stands on the wires: interpolation (contact, node) of the heights there, and how it presses.
        share: part of all constant forces, and of what stands there, that is put on.
        place: (..., hold, 3) m, where holds are without force.
        given: (hold, 3) m, by which what holds fast is moved against its force, so that it gives way to none.

    Where `failed` is asked for, it says which ties pull no more, (..., tie).
    """

    def __init__(self, mesh: Mesh, rest: Array, force: Array | None = None) -> None:
        self.mesh, self.nodes = mesh, mesh.nodes
        self.pressing: tuple[sparse.csr_matrix, Pressing] | None = None
        self.share = 1.0
        s, plan = mesh.strands, mesh.plan
        behind = np.ones(mesh.nodes, dtype=np.bool_)
        behind[s.first + s.links] = False
        self._link = np.flatnonzero(behind)
        self._rest = rest[self._link]
        self._EA = np.repeat([wire.axial_stiffness for wire in plan.wires], s.links)
        # Deflections from straight lines: their bending energy is small beside the rounding of that of whole positions.
        self._bend, self._unbent = bending_stiffness(mesh), _unbent(mesh)
        self._bed, self._level = beds(mesh), mesh.straight()[2]
        self._tie = rows(mesh.ties.other, mesh.nodes) - rows(mesh.ties.one, mesh.nodes)
        self._ground = np.where(np.isfinite(mesh.ties.ground), mesh.ties.ground, 0.0)
        self._pull, self._push = ties_springs(mesh)
        self._hold = rows(mesh.holds.at, mesh.nodes)
        self._stiff = spring(mesh.holds.stiffness, mesh.holds.at.local[:, None])
        self.place, self.given = mesh.holds.place, np.zeros_like(mesh.holds.place)
        self.force = np.zeros((3, mesh.nodes)) if force is None else force.copy()
        self.force[1] += mesh.sideways
        self.force[2] -= plan.gravity * mesh.mass
        self.force += (self._hold.T @ mesh.holds.force).T

    def tension(self, r: Array) -> Array:
        """Tension of all links, N, at positions (..., 3, node)."""
        tension: Array = self._EA * (_size(self._apart(r)) / self._rest - 1.0)
        return tension

    def _apart(self, r: Array) -> Array:
        """From one end of each link to the other, (..., 3, link) m."""
        found: Array = r[..., self._link + 1] - r[..., self._link]
        return found

    def _ties(self, r: Array, failed: NDArray[np.bool_] | None = None) -> tuple[Array, Array, Array, Array]:
        d = _times(self._tie, r) + self._ground.T
        length = _size(d)
        longer = length - self.mesh.ties.length
        k = np.where(longer > 0.0, self._pull, self._push)
        if failed is not None:
            k = np.where(failed, 0.0, k)
        return d, length, longer, k

    def tie_forces(self, r: Array, failed: NDArray[np.bool_] | None = None) -> Array:
        """Forces of all ties, positive in tension, (..., tie) N."""
        _, _, longer, k = self._ties(r, failed)
        return np.asarray(k * longer)

    def hold_forces(self, r: Array) -> Array:
        """Forces of all holds on their wires, (..., hold, 3) N."""
        return self._restrained(r) + self.mesh.holds.force

    def _stretched(self, r: Array) -> Array:
        """By how much the springs of holds pull their wires along their axes, (..., hold, 3) m."""
        away = self.place + self.given - _times(self._hold, r).swapaxes(-1, -2)
        axes: Array = self.mesh.holds.axes
        return np.asarray(sum(axes[:, :, a] * away[..., a, None] for a in range(3)))

    def off_rails(self, r: Array) -> Array:
        """How far ends, and points of beams, stand off what holds them fast, against its forces, (hold, 3) m."""
        holds = self.mesh.holds
        across = np.isinf(holds.stiffness) & ((holds.node >= 0) | (holds.at.local == 0.0))[:, None]
        return np.asarray(np.einsum("hja,hj,hjb,hb->ha", holds.axes, across, holds.axes, self.place - self._hold @ r.T))

    def _restrained(self, r: Array) -> Array:
        """Forces of the springs of all holds on their wires, (..., hold, 3) N."""
        force, axes = self._stiff * self._stretched(r), self.mesh.holds.axes
        return np.asarray(sum(axes[:, j] * force[..., j, None] for j in range(3)))

    def energy(self, r: Array, failed: NDArray[np.bool_] | None = None) -> float:
        """Potential energy, J."""
        return float(self.energies(r[None], failed)[0])

    def energies(self, r: Array, failed: NDArray[np.bool_] | None = None) -> Array:
        """Potential energies at some instants, (instant,) J, which positions have in front, (instant, 3, node) m."""
        strain = self.tension(r) / self._EA
        *_, longer, k = self._ties(r, failed)
        away = r - self._unbent
        double = summed(self._EA * self._rest * strain**2) + summed(away * _times(self._bend, away))
        for part in (self._bed * (r[:, 2] - self._level) ** 2, k * longer**2, self._stiff * self._stretched(r) ** 2):
            double += summed(part)
        given = summed(self.force * r)
        if self.pressing is not None:
            at, loads = self.pressing
            height = _times(at, r[:, 2])
            given += summed(height * (loads.given - 0.5 * _times(loads.stiffness, height)))
        return np.asarray(0.5 * double - self.share * given)

    def pull(self, r: Array, failed: NDArray[np.bool_] | None = None) -> Array:
        """Forces on all nodes, (..., 3, node) N."""
        d = self._apart(r)
        along = (self.tension(r) / _size(d))[..., None, :] * d
        out = self.share * self.force - _times(self._bend, r - self._unbent)
        if self.pressing is not None:
            at, loads = self.pressing
            presses = loads.given - _times(loads.stiffness, _times(at, r[..., 2, :]))
            out[..., 2, :] += self.share * _times(at.T, presses)
        out[..., self._link] += along
        out[..., self._link + 1] -= along
        out[..., 2, :] -= self._bed * (r[..., 2, :] - self._level)
        d, length, longer, k = self._ties(r, failed)
        out -= _times(self._tie.T, (k * longer / length)[..., None, :] * d)
        restrained: Array = out + _times(self._hold.T, self._restrained(r).swapaxes(-1, -2))
        return restrained

    def bare_pull(self, r: Array, failed: NDArray[np.bool_] | None = None) -> Array:
        """The same without what holds do."""
        bare: Array = self.pull(r, failed) - _times(self._hold.T, self.hold_forces(r).swapaxes(-1, -2))
        return bare

    def stiffness(self, r: Array, failed: NDArray[np.bool_] | None = None) -> sparse.csc_matrix:
        """Second derivatives, (3 node, 3 node), component by component."""
        d = r[:, self._link + 1] - r[:, self._link]
        length = np.sqrt((d**2).sum(axis=0))
        q, axial = self.tension(r) / length, self._EA / self._rest
        e, (way, far, longer, k) = d / length, self._ties(r, failed)
        u, N = way / far, k * longer / far
        same = np.eye(3)[:, :, None]
        links = (axial - q) * e[:, None] * e[None] + q * same
        ties = (k - N) * u[:, None] * u[None] + N * same
        values = np.concatenate([
            (links[:, :, None] * np.array([1.0, 1.0, -1.0, -1.0])[:, None]).ravel(),
            (ties[:, :, None] * self._shares).ravel(),
        ])  # fmt: skip
        K = sparse.coo_matrix((values, self._places), shape=(3 * self.nodes, 3 * self.nodes)).tocsc() + self._constant
        if self.pressing is None:
            return K
        at, loads = self.pressing
        return K + self._upwards(at.T @ sparse.csr_matrix(self.share * loads.stiffness) @ at)

    def _upwards(self, own: sparse.csr_matrix) -> sparse.csc_matrix:
        """What joins heights alone (node, node), among all components."""
        own, up = own.tocoo(), 2 * self.nodes
        return sparse.csc_matrix((own.data, (own.row + up, own.col + up)), shape=(3 * self.nodes, 3 * self.nodes))

    @property
    def pattern(self) -> sparse.csc_matrix:
        """Where the stiffness may have entries, whatever the shape is, (3 node, 3 node)."""
        if self.pressing is None:
            return self._always
        at, loads = self.pressing
        return self._always + self._upwards(abs(at).T @ sparse.csr_matrix(np.abs(loads.stiffness)) @ abs(at))

    @cached_property
    def _always(self) -> sparse.csc_matrix:
        """Where links, ties and what is constant have entries."""
        row, column = self._places
        entries = (np.ones(row.size), (row, column))
        return sparse.coo_matrix(entries, shape=(3 * self.nodes, 3 * self.nodes)).tocsc() + abs(self._constant)

    @cached_property
    def _shares(self) -> Array:
        """Products of the weights with which nodes share the ends of ties, (pair of nodes, tie)."""
        ties = self.mesh.ties
        weight = np.concatenate([-ties.one.weight, ties.other.weight], axis=1).T
        products: Array = (weight[:, None] * weight[None]).reshape((2 * WIDTH) ** 2, weight.shape[1])
        return products

    @cached_property
    def _places(self) -> tuple[Integers, Integers]:
        """Rows and columns of the entries of links and ties."""
        ties, axes = self.mesh.ties, self.nodes * np.arange(3)
        i, j = self._link, self._link + 1
        near = np.concatenate([at.base[:, None] + np.arange(WIDTH) for at in (ties.one, ties.other)], axis=1).T
        pairs = (
            (np.stack([i, j, i, j]), np.stack([i, j, j, i])),
            (np.repeat(near, 2 * WIDTH, axis=0), np.tile(near, (2 * WIDTH, 1))),
        )
        row = [np.broadcast_to(one + axes[:, None, None, None], (3, 3, *one.shape)).ravel() for one, _ in pairs]
        column = [np.broadcast_to(two + axes[:, None, None], (3, 3, *two.shape)).ravel() for _, two in pairs]
        return np.concatenate(row), np.concatenate(column)

    @cached_property
    def _constant(self) -> sparse.csc_matrix:
        """What bending, beds and holds add, whatever the shape is."""
        axes = self.mesh.holds.axes
        restrained = np.einsum("hja,hj,hjb->abh", axes, self._stiff, axes)
        blocks = [[self._hold.T @ sparse.diags(restrained[a, b]) @ self._hold for b in range(3)] for a in range(3)]
        for a in range(3):
            blocks[a][a] = blocks[a][a] + self._bend
        blocks[2][2] = blocks[2][2] + sparse.diags(self._bed)
        found: sparse.csc_matrix = sparse.bmat(blocks, format="csc")
        found.eliminate_zeros()
        return found


def _times(matrix: sparse.spmatrix | Array, values: Array) -> Array:
    """A matrix times vectors (..., entry)."""
    *shape, count = values.shape
    product = matrix @ values.reshape(math.prod(shape), count).T
    return np.asarray(product.T.reshape(*shape, matrix.shape[0]))


def _size(vectors: Array) -> Array:
    """Lengths of vectors (..., 3, what)."""
    x, y, z = (vectors[..., a, :] for a in range(3))
    return np.asarray(np.sqrt(x * x + y * y + z * z))


def _unbent(mesh: Mesh) -> Array:
    """Wires without bending, as they leave their starts straight towards their ends, unstretched, (3, node) m."""
    parts = []
    for i, wire in enumerate(mesh.plan.wires):
        start, way = np.array(wire.start), np.subtract(wire.end, wire.start)
        along = np.arange(mesh.strands.links[i] + 1.0) * mesh.strands.h[i]
        parts.append(start[:, None] + way[:, None] / np.linalg.norm(way) * along)
    return np.concatenate(parts, axis=1)


def movable(mesh: Mesh, *, space: bool) -> NDArray[np.bool_]:
    """Which components of which nodes may move, (3, node)."""
    free = ~mesh.fixed
    if not space:
        free[1] = False
    return free


def allowed(mesh: Mesh) -> sparse.csc_matrix:
    """Directions in which nodes may move in space, unit vectors: (3 node, direction), along a rail where one holds."""
    free, n, holds = movable(mesh, space=True), mesh.nodes, mesh.holds
    columns = [(np.array([i]), np.ones(1)) for i in np.flatnonzero(free)]
    for node, axes, stiffness in zip(holds.node, holds.axes, holds.stiffness, strict=True):
        if node < 0 or not np.isinf(stiffness).any():
            continue
        own = node + n * np.arange(3)
        columns = [column for column in columns if column[0][0] not in own]
        columns += [(own, way) for way in axes[~np.isinf(stiffness)] if not (way[mesh.fixed[:, node]] != 0.0).any()]
    row, column, value = (
        np.concatenate(parts)
        for parts in zip(*((at, np.full(at.size, j), way) for j, (at, way) in enumerate(columns)), strict=True)
    )
    return sparse.csc_matrix((value, (row, column)), shape=(3 * n, len(columns)))


@dataclass(frozen=True)
class WireBalance:
    """Wires at rest."""

    position: Array  # (3, node) m
    tension: Array  # (link,) N


class _WireShape:
    """The potential energy of wires as a function of what may move, see `solve/minimum.py`."""

    is_symmetric = True

    def __init__(self, potential: WirePotential, failed: NDArray[np.bool_] | None, *, space: bool) -> None:
        self.potential, self.failed = potential, failed
        self.size = float(max(wire.length for wire in potential.mesh.plan.wires))
        self._free = np.flatnonzero(movable(potential.mesh, space=space))
        self.free = sparse.identity(3 * potential.nodes, format="csc")[:, self._free]

    def energy(self, r: Array) -> float:
        return self.potential.energy(r, self.failed)

    def out_of_balance(self, r: Array) -> Array:
        return np.asarray(self.potential.pull(r, self.failed).ravel()[self._free])

    def stiffness(self, r: Array) -> sparse.csc_matrix:
        return self.potential.stiffness(r, self.failed)[self._free][:, self._free]

    def convex(self, r: Array) -> sparse.csc_matrix:
        return self.stiffness(r)

    def pattern(self, r: Array) -> sparse.csc_matrix:
        return self.potential.pattern[self._free][:, self._free]

    def stability(self, r: Array) -> tuple[sparse.csc_matrix, Integers]:
        return self.stiffness(r), np.arange(self._free.size)

    def part(self, r: Array, way: Array) -> str:
        node = int(np.abs(way).reshape(3, -1).max(axis=0).argmax())
        return "a wire near ({:.4g}, {:.4g}, {:.4g}) m".format(*r[:, node])

    def moved(self, r: Array, step: Array) -> Array:
        out = r.copy()
        out.reshape(-1)[self._free] += step
        return out

    def arrived(self, r: Array) -> tuple[Array, bool]:
        return r, False

    def approaches(self, start: Array, way: Way) -> Iterator[Array]:
        """Where it rests while constant forces are put on in parts."""
        r: Array | None = start
        try:
            for part in range(1, _PARTS):
                self.potential.share = part / _PARTS
                r = newton(self, r, way)[0] if r is not None else None
        finally:
            self.potential.share = 1.0
        if r is not None:
            yield r


def settle(
    potential: WirePotential, start: Array, failed: NDArray[np.bool_] | None = None, *, space: bool = False
) -> WireBalance:
    """Find the rest next to a shape, see `solve/minimum.py`.

    Args:
        potential: of the wires.
        start: (3, node) m.
        failed: (tie,) whether it pulls no more; None: all do.
        space: whether anything moves sideways.

    Raises:
        EquilibriumError: no rest was found.
    """
    r = minimum.settle(_WireShape(potential, failed, space=space), start)
    return WireBalance(r, potential.tension(r))


def settle_on_rails(
    potential: WirePotential, start: Array, failed: NDArray[np.bool_] | None = None, *, space: bool = False
) -> WireBalance:
    """As `settle`; ends then stand on their rails exactly, and not but for what a stiff spring gives way."""
    found = settle(potential, start, failed, space=space)
    size = max(wire.length for wire in potential.mesh.plan.wires)
    for _ in range(_ROUNDS):
        off = potential.off_rails(found.position)
        if np.abs(off).max(initial=0.0) <= _ON_RAIL * size:
            break
        potential.given = potential.given + off
        found = settle(potential, found.position, failed, space=space)
    return found
