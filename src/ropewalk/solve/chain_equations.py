"""Equations of motion of ropes in space about a state, with bodies that stand on them and ends that yield.

All loads stay on their particles, also those that travel freely; what waits or is parked stands on firm ground.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.bodies import FLYING, INSIDE, LOCATED, MOVING_WITH, PULLS, Bodies
from ropewalk.mechanics.chain import OFF, Array, ChainState, Integers
from ropewalk.mechanics.contact_points import wheels_of
from ropewalk.mechanics.moving_contact import link_of, part_of
from ropewalk.mechanics.multibody_system import multibody_system_of
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.scenario import Scenario
from ropewalk.solve.coupled_equilibrium import settle_together
from ropewalk.solve.equations import Equations, LinearBody
from ropewalk.solve.linearised import link_blocks
from ropewalk.solve.spectrum import in_space
from ropewalk.solve.start import PreparedRun

_SPACE = ("x", "y", "z")


def hang_down(setting: PreparedRun, state: ChainState, bodies: Bodies) -> None:
    """Let everything rest together, with payloads straight below their trolleys; `state` and `bodies` are changed."""
    if not bodies.tethers.size:
        return
    settle_together(setting, state, bodies)
    dim = state.r.shape[0]
    for tether in bodies.tethers:
        own = int(tether["first"])
        v = int(np.searchsorted(bodies.vehicles["first"], own, side="right")) - 1
        below = bodies.wheels["r"][tether["wheel"], :dim].copy()
        below[-1] -= tether["length"] - bodies.load[v, dim - 1] / tether["stiffness"]
        bodies.coordinates["q"][own : own + dim] = below


@dataclass(frozen=True)
class _ChainPoints:
    """Nodes and heavy wheels of all strands, one strand after the other, then wheels in the air."""

    r: Array  # (3, point) m
    mass: Array  # (point, 3) kg
    at: dict[int, int]  # point of each node
    own: dict[int, int]  # point of each heavy wheel
    line: tuple[str, ...]


def equations_of(scenario: Scenario, setting: PreparedRun, state: ChainState, bodies: Bodies | None) -> Equations:
    """Equations of motion about a state.

    Args:
        scenario: what is there.
        setting, state: the model as it is.
        bodies: all that has a mass; None: nothing has.

    Raises:
        RopewalkError: a load has no equations of motion.
    """
    space = None if bodies is None else _in_space(scenario, setting, bodies)
    X, r, points = _points(setting, state, bodies, space)
    count = r.shape[1]
    K, C = sparse.lil_matrix((3 * count, 3 * count)), sparse.lil_matrix((3 * count, 3 * count))
    strands, moves = setting.strands, np.ones((count, 3), dtype=np.bool_)
    basis = sparse.lil_matrix(sparse.identity(3 * count))
    blocks_K, blocks_C = [], []
    for s, first in enumerate(strands.first):
        begin, end = points.at[int(first)], points.at[int(first + strands.links[s])]
        own, ell = np.ascontiguousarray(r[:, begin : end + 1]), np.diff(X[begin : end + 1])
        if not (np.isfinite(own).all() and np.all(ell > 0.0)):
            raise RopewalkError("there is no spectrum: positions are not finite, or a link has no length")
        stiff, damp = np.zeros((ell.size, 3, 3)), np.zeros((ell.size, 3, 3))
        link_blocks(strands.law[s], float(strands.damping[s]), ell, own, stiff, damp)
        blocks_K.append(_chained(stiff, begin, count))
        blocks_C.append(_chained(damp, begin, count))
        carries = np.array([points.at[int(i)] for i in range(int(first), int(first + strands.links[s]) + 1)])
        drag = strands.drag[s] * strands.rho[s] * strands.h[s]
        C[3 * carries[:, None] + np.arange(3), 3 * carries[:, None] + np.arange(3)] = drag
        for side, at in enumerate((begin, end)):
            _hold(setting, 2 * s + side, at, points.mass, moves, K, C, basis)
    K, C = sparse.csc_matrix(K) + sum(blocks_K), sparse.csc_matrix(C) + sum(blocks_C)
    free = sparse.csc_matrix(basis)[:, np.flatnonzero(moves.ravel())]
    M = sparse.diags(points.mass.ravel())
    displayed = free.tocsr()[: 3 * len(points.line)]
    name = setting.lines[0] if len(setting.lines) == 1 else "all lines"
    lines = Equations(
        name, (free.T @ K @ free).tocsc(), (free.T @ M @ free).tocsc(), (free.T @ C @ free).tocsc(), displayed,
        r[:, : len(points.line)].T, points.line,
    )  # fmt: skip
    if bodies is None or space is None:
        return lines
    on = _Contacts(setting, state, bodies, points, free)
    moving_with = [LinearBody(np.diag(m), np.zeros((3, 3)), np.zeros((3, 3)), at) for m, at in on.moving_with(space)]
    return lines.with_bodies([*moving_with, *_vehicles(bodies, space, on)])


def _chained(block: Array, begin: int, count: int) -> sparse.csc_matrix:
    """The matrix of links in a chain of points from `begin` on, from its blocks (link, axis, axis)."""
    i = 3 * (begin + np.arange(block.shape[0]))[:, None, None]
    a, b = np.arange(3)[:, None], np.arange(3)[None, :]
    row, column, value = [], [], []
    for one, two, sign in ((0, 0, 1.0), (3, 3, 1.0), (0, 3, -1.0), (3, 0, -1.0)):
        row.append((i + one + a + 0 * b).ravel())
        column.append((i + two + 0 * a + b).ravel())
        value.append(sign * block.ravel())
    entries = np.concatenate(value), (np.concatenate(row), np.concatenate(column))
    return sparse.coo_matrix(entries, shape=(3 * count, 3 * count)).tocsc()


def _points(
    setting: PreparedRun, state: ChainState, bodies: Bodies | None, space: Bodies | None
) -> tuple[Array, Array, _ChainPoints]:
    """Material coordinates (point,) and places (3, point) of nodes and heavy wheels, and what they are."""
    strands, r = setting.strands, in_space(state.r)
    places, X, mass = [np.zeros((3, 0))], list[float](), list[Array]()
    at, own, line = dict[int, int](), dict[int, int](), list[str]()
    wheels = np.zeros((0, 3)) if bodies is None else _wheels(bodies, state.r.shape[0])
    for s, first in enumerate(strands.first):
        last, m = int(first + strands.links[s]), float(strands.rho[s] * strands.h[s])
        stand = [(float(state.X[i]), int(i), -1) for i in range(int(first), last + 1)]
        for k in setting.on[s] if bodies is not None else ():
            assert bodies is not None
            if bodies.wheels["phase"][k] == INSIDE:
                stand.append((float(state.xi[k]), -1, int(k)))
        located = {} if bodies is None else {
            int(bodies.wheels["at"][k]): int(k) for k in setting.on[s] if bodies.wheels["phase"][k] == LOCATED
        }  # fmt: skip
        for x, i, k in sorted(stand):
            number = len(X)
            X.append(x)
            line.append(setting.lines[s])
            if i >= 0:
                at[i] = number
                k = located.get(i, -1)
            if k >= 0:
                assert space is not None
                own[k] = number
            body = space.wheels["mass"][k] if k >= 0 and space is not None else np.zeros(3)
            mass.append(body + (m if i >= 0 else 0.0))
            places.append((wheels[k] if k >= 0 else r[:, i])[:, None])
    displayed = tuple(line)
    for k in range(wheels.shape[0]):
        if bodies is not None and space is not None and bodies.wheels["phase"][k] == FLYING:
            own[k] = len(X)
            X.append(0.0)
            mass.append(space.wheels["mass"][k])
            places.append(wheels[k][:, None])
    whole = np.concatenate(places, axis=1)
    return np.array(X), whole, _ChainPoints(whole, np.array(mass), at, own, displayed)


def _hold(
    setting: PreparedRun, number: int, at: int, mass: Array, moves: NDArray[np.bool_], K: sparse.lil_matrix,
    C: sparse.lil_matrix, basis: sparse.lil_matrix,
) -> None:  # fmt: skip
    """Let an end move in the free directions of its support only, on its springs and dampers."""
    supports, own, strand = setting.supports, slice(3 * at, 3 * at + 3), number // 2
    free, k, c = _widened([matrix[number] for matrix in (supports.free, supports.stiffness, supports.damping)])
    sizes, ways = np.linalg.eigh(free)
    basis[own, own] = ways
    moves[at] = sizes > 0.5
    K[own, own], C[own, own] = k, C[own, own].toarray() + c
    half = 0.5 * float(setting.strands.rho[strand] * setting.strands.h[strand])
    mass[at] = half + supports.mass[number]


def _widened(matrices: list[Array]) -> list[Array]:
    """Matrices of a support in the plane as in space: if it is alike in x and z it is so in y, and else it holds y."""
    if matrices[0].shape[0] == 3:
        return matrices
    alike = all(np.allclose(m, m[0, 0] * np.eye(2), rtol=1e-12, atol=0.0) for m in matrices)
    out = []
    for matrix in matrices:
        wide = np.zeros((3, 3))
        wide[np.ix_([0, 2], [0, 2])] = matrix
        wide[1, 1] = matrix[0, 0] if alike else 0.0
        out.append(wide)
    return out


def _wheels(bodies: Bodies, dim: int) -> Array:
    """Places of all wheels, (wheel, 3) m."""
    return np.asarray(in_space(bodies.wheels["r"][:, :dim].T).T)


def _in_space(scenario: Scenario, setting: PreparedRun, bodies: Bodies) -> Bodies:
    """All that has a mass as it moves in space, at the beginning; in a plane its springs act sideways as along x."""
    if len(setting.axes) == 3:
        return bodies
    loads = {}
    for name, load in scenario.loads.items():
        if isinstance(load, Oscillator):
            change = {}
            for key in ("stiffness", "damping"):
                values = getattr(load, key)
                if isinstance(values, tuple):
                    change[key] = (values[0], values[0], values[1])
            load = load.model_copy(update=change)
        loads[name] = load
    scenario = scenario.model_copy(update={"loads": loads})
    g = setting.strands.gravity
    strands = setting.strands._replace(gravity=np.array([g[0], 0.0, g[1]]))
    return multibody_system_of(scenario, wheels_of(scenario), strands, _SPACE, 0.0).bodies


class _Contacts:
    """Where the wheels of loads are on their lines."""

    def __init__(
        self, setting: PreparedRun, state: ChainState, bodies: Bodies, points: _ChainPoints, free: sparse.csc_matrix
    ) -> None:
        self._free, self._size = free.tocsr(), free.shape[0]
        self._places: dict[int, tuple[tuple[int, float], ...]] = {k: ((i, 1.0),) for k, i in points.own.items()}
        self._moving_with = []
        for k in range(state.xi.size):
            b = int(state.moving_load[k])
            if bodies.wheels["phase"][k] != MOVING_WITH or b <= OFF:
                continue
            self._moving_with.append(k)
            if b >= 0:
                self._places[k] = ((points.at[b], 1.0),)
                continue
            i = int(link_of(setting.strands, setting.loads, state, k))
            part = float(part_of(state, k, i))
            self._places[k] = ((points.at[i], 1.0 - part), (points.at[i + 1], part))

    def stands(self, k: int) -> bool:
        """Whether wheel k is on a line, or in the air; else on firm ground or away."""
        return k in self._places

    def rows(self, wheel: Integers, axis: Integers) -> sparse.csr_matrix:
        """Displacements of wheels along axes x, y, z, (place, unknown)."""
        out = sparse.lil_matrix((wheel.size, self._size))
        for j, (k, a) in enumerate(zip(wheel, axis, strict=True)):
            for i, part in self._places.get(int(k), ()):
                out[j, 3 * i + int(a)] = part
        return sparse.csr_matrix(out.tocsr() @ self._free)

    def moving_with(self, space: Bodies) -> list[tuple[Array, sparse.csr_matrix]]:
        """Masses (axis,) of wheels that follow nodes, and where these are."""
        return [
            (space.wheels["mass"][k], self.rows(np.full(3, k), np.arange(3)))
            for k in self._moving_with
            if space.wheels["mass"][k].any()
        ]


@dataclass(frozen=True)
class _Spring:
    """A spring and a damper between coordinates of a vehicle and a wheel."""

    stiffness: Array  # (axis, axis) N/m
    damping: Array  # N s/m
    first: int  # of the coordinates
    wheel: int
    axes: tuple[int, ...]


def _springs(bodies: Bodies, space: Bodies, place: Array, dim: int) -> list[_Spring]:
    """Tethers that pull and buffers that push, as they are now."""
    found = []
    for tether, now in zip(space.tethers, bodies.tethers, strict=True):
        q, k = int(now["first"]), int(tether["wheel"])
        d = in_space(bodies.coordinates["q"][q : q + dim][:, None])[:, 0] - place[k]
        length, stiff = float(np.linalg.norm(d)), float(tether["stiffness"])
        longer = length - float(now["length"])
        if not now["on"] or (now["way"] == PULLS and longer <= 0.0):
            continue
        along = np.outer(d, d) / length**2
        K = stiff * along + stiff * longer / length * (np.eye(3) - along)
        found.append(_Spring(K, float(tether["damping"]) * along, int(tether["first"]), k, (0, 1, 2)))
    for buffer, now in zip(space.buffers, bodies.buffers, strict=True):
        k = int(buffer["wheel"])
        deep = float(now["side"]) * (place[k, 2] - float(bodies.coordinates["q"][int(now["coordinate"])]))
        if deep > 0.0:
            K = np.array([[float(buffer["stiffness"])]])
            found.append(_Spring(K, np.zeros((1, 1)), int(buffer["coordinate"]), k, (2,)))
    return found


def _vehicles(bodies: Bodies, space: Bodies, on: _Contacts) -> list[LinearBody]:
    """What stands above the wheels, those vehicles that are on a line."""
    found, dim = [], 3 if space is bodies else 2
    springs = _springs(bodies, space, _wheels(bodies, dim), dim)
    for v, vehicle in enumerate(space.vehicles):
        n, first, count = int(vehicle["coordinates"]), int(vehicle["first"]), int(vehicle["wheels"])
        wheel, axis = space.wheel[v, :count].tolist(), space.axis[v, :count].tolist()
        M, C, K = (matrix[v, : n + count, : n + count] for matrix in (space.M, space.C, space.K))
        for spring in springs:
            i, width, size = spring.first - first, len(spring.axes), M.shape[0]
            if not 0 <= i < n:
                continue
            row = np.zeros((width, size + width))
            row[:, i : i + width], row[:, size:] = np.eye(width), -np.eye(width)
            M, C, K = (np.pad(matrix, (0, width)) for matrix in (M, C, K))
            K, C = K + row.T @ spring.stiffness @ row, C + row.T @ spring.damping @ row
            wheel, axis = [*wheel, *(spring.wheel for _ in spring.axes)], [*axis, *spring.axes]
        if any(on.stands(k) for k in wheel):
            found.append(LinearBody(M, C, K, on.rows(np.array(wheel, dtype=np.int64), np.array(axis, dtype=np.int64))))
    return found
