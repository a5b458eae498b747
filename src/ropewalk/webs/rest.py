"""Rest of a web: the least potential energy, by Newton's method."""

from __future__ import annotations

import warnings

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.solve.symmetric import IndefiniteError, Solver, Way
from ropewalk.webs.potential import Potential
from ropewalk.webs.relax import relaxed
from ropewalk.webs.seats import divide, join, seat
from ropewalk.webs.sheaves import hop
from ropewalk.webs.web import OFF, ON_LINE, WORKS, Array, Web

# A node is at a sheave if it is closer than this part of a link.
_AT = 1e-4
_FULL_STEPS, _MOST_STEPS = 40, 2000
_LONGEST = 0.2  # of the size of the web: longer steps are cut
_ALMOST = 1e-8  # of its size: steps this small are taken although rounding may hide that the energy falls
_STICKS = 50.0  # coefficient of friction at which nothing slips
_ROUNDING = 1e-11  # of the largest stiffness: what rounding may take from the smallest one
_SHAKE = 1e-3  # of its size, by which a web that is only balanced is disturbed
_CLOSE = 1e-12  # of its size: a step this small is the last one, as is the first that is no smaller than before


def stand(web: Web, r: Array, t: float) -> None:
    """Let all contacts stand where they are at time t; those that were not there before start on the straight line.

    Args:
        web: whose slots change.
        r: (node, 3) m; places of contacts change.
    """
    seats = web.seats
    hold_at(web, r, t)
    join(web)
    seat(web, t)
    for k in range(seats.kind.size):
        if seats.kind[k] == OFF or seats.last[k] == seats.cell[k]:
            continue
        e, w = seats.cell[k], seats.weight[k]
        corner = [web.links.one[e], web.links.other[e]] if seats.on[k] == ON_LINE else list(web.cells.node[e])
        r[web.nodes + k] = w[: len(corner)] @ r[corner]
        seats.last[k] = seats.cell[k]
    seats.before[:] = seats.weight
    divide(web)


def hold_at(web: Web, r: Array, t: float) -> None:
    """Put what moves as prescribed where it is at time t, in s; places r (node, 3) of fixed nodes change."""
    moves = web.held.moves
    for i, (n, k) in enumerate(zip(moves.node, moves.spring, strict=True)):
        part = slice(int(moves.first[i]), int(moves.first[i] + moves.entries[i]))
        place = moves.place[i] + [np.interp(t, moves.time[part], row[part]) for row in moves.value]
        if k >= 0:
            web.held.place[k] = place
        else:
            r[n] = place


def leave(web: Web) -> None:
    """Take all contacts off."""
    join(web)
    web.seats.kind[:] = OFF
    web.seats.last[:] = -1


def size_of(r: Array) -> float:
    """Extent of a web, m."""
    return float(np.ptp(r, axis=0).max())


def settle(web: Web, start: Array, *, rubs: bool = False, way: Way = "auto") -> Array:
    """Find the rest next to a shape, contacts as they stand.

    Newton's method in full steps, which may climb the walls of the narrow valley that lines which hardly stretch make
    of the energy. If that does not converge, the web relaxes first; and at last it goes downhill only.

    Args:
        web: lines slip at its sheaves.
        start: (node, 3) m.
        rubs: whether they rub there.
        way: of solving, see `solve/symmetric.py`.

    Returns:
        Places (node, 3), m.

    Raises:
        EquilibriumError: no rest was found.
    """
    if start.shape != web.body.force.shape:  # kernels would write beyond their arrays
        raise ValueError(f"a shape of {start.shape[0]} nodes and contacts for a web of {web.body.force.shape[0]}")
    potential = Potential(web, rubs=rubs)
    if potential.unknowns() == 0:
        return start.copy()
    ahead, links = web.sheaves.ahead.copy(), web.sheaves.link.copy()
    found = _stable(potential, _newton(potential, start, way), way)
    if found is None:
        if web.sheaves.node.size:  # begin again where it was
            web.links.on[web.sheaves.link] = 1
            web.sheaves.link[:], web.sheaves.ahead[:] = links, ahead
            web.links.on[web.sheaves.link] = 0
        potential = Potential(web, rubs=rubs)
        near = relaxed(potential, start)
        found = _stable(potential, _newton(potential, near, way), way) if near is not None else None
        if found is None:
            found = _downhill(potential, near if near is not None else start, way)
            if not _is_least(potential, found, way):
                found = _shaken(potential, found, way)
    potential.pull(found)
    return found


def _stable(potential: Potential, found: Array | None, way: Way) -> Array | None:
    """The same if the energy is least there; None if not. Without friction Newton's method has seen to that."""
    return found if found is None or not potential.rubs or _is_least(potential, found, way) else None


def _is_least(potential: Potential, r: Array, way: Way) -> bool:
    """Whether the energy is least there, lines stuck to sheaves that rub; of what lies in a plane, within that."""
    sheaves = potential.web.sheaves
    potential.pull(r)
    friction, ahead = sheaves.friction.copy(), sheaves.ahead.copy()
    if potential.rubs:
        sheaves.friction[:] = _STICKS
        potential = Potential(potential.web, rubs=True)
    K = potential.stiffness(r)
    sheaves.friction[:], sheaves.ahead[:] = friction, ahead
    inner = np.flatnonzero(potential.in_plane()) if not r[:, 1].any() else np.arange(K.shape[0])
    K = 0.5 * (K + K.T).tocsc()[inner][:, inner]
    scale = float(np.abs(K.diagonal()).max(initial=0.0))
    K = (K + _ROUNDING * scale * sparse.identity(inner.size)).tocsc()
    try:
        Solver(K, way).factorise(K)
    except IndefiniteError:
        return False
    return True


def _shaken(potential: Potential, found: Array, way: Way) -> Array:
    """The rest to which a web goes from one in which it is only balanced, as a line pushed at its end.

    Raises:
        EquilibriumError: there is none nearby.
    """
    shake = np.random.default_rng(0).standard_normal(found.shape)
    if not found[:, 1].any():
        shake[:, 1] = 0.0
    moved = potential.free @ (potential.free.T @ shake.ravel())
    near = relaxed(potential, found + _SHAKE * size_of(found) * moved.reshape(-1, 3))
    best = _stable(potential, _newton(potential, near, way), way) if near is not None else None
    if best is None:
        raise EquilibriumError(
            "the web is only balanced at rest, not stable: lines are pushed together; check joints.force, supports and "
            "lengths, or give lines law: {kind: tension_only}"
        )
    return best


def _hop(potential: Potential, r: Array) -> tuple[Array, bool]:
    """Let nodes pass sheaves to which Newton's method has brought them; also says whether one did.

    Raises:
        EquilibriumError: a line runs out.
    """
    web = potential.web
    if not web.sheaves.node.size:
        return r, False
    out = r.copy()
    _push_over(web, out)
    before = web.sheaves.link.copy()
    if not hop(web.links, web.sheaves, out, np.zeros_like(out), web.body.mass, np.zeros(WORKS)):
        raise EquilibriumError("a line runs over a sheave up to its end, or to the next sheave; make it longer")
    passed = bool((before != web.sheaves.link).any())
    if passed:
        potential.settle_slip()
    return out, passed


def _push_over(web: Web, r: Array) -> None:
    """Push nodes that have come close to a sheave beyond it, where the line pulls harder from there; r is changed.

    In the energy as a function of its place, a node that is about to pass sits on the tip of a cone.
    """
    links, sheaves = web.links, web.sheaves
    for k in range(sheaves.node.size):
        e, b = int(sheaves.link[k]), int(sheaves.node[k])
        whole = links.rest[e]
        for near, onto, own in ((links.one[e], e - 1, 0), (links.other[e], e + 1, 1)):
            if not sheaves.first[k] <= onto <= sheaves.last[k] or np.linalg.norm(r[near] - r[b]) > _AT * whole:
                continue
            far = links.one[onto] if own == 0 else links.other[onto]
            way = r[near] - r[far]
            length = float(np.linalg.norm(way))
            packed = links.laws[links.law[onto]]
            if sheaves.tension[k, 1 - own] > law.tension(packed, length / links.rest[onto] - 1.0):
                r[near] = r[b] + 1e-9 * whole * way / length


def _newton(potential: Potential, start: Array, way: Way) -> Array | None:
    """Newton's method in full steps, cut where they are long; None if it does not converge."""
    r, size, before = start.copy(), size_of(start), np.inf
    solver: Solver | None = None
    for _ in range(_FULL_STEPS):
        K, out = potential.stiffness(r), potential.out_of_balance(r)
        definite = not potential.rubs
        if definite:
            solver = solver or Solver(potential.pattern(r), way)
            try:
                solver.factorise(K)
                step = solver.solve(out)
            except IndefiniteError:
                definite = False
        if not definite:  # a saddle on the way, or friction, which makes the stiffness unsymmetric
            step = _solved(K, out)
        largest = float(np.abs(step).max())
        if not np.isfinite(largest):
            return None
        move = potential.free @ (step * min(1.0, _LONGEST * size / max(largest, 1e-300)))
        try:
            r, passed = _hop(potential, r + move.reshape(-1, 3))
        except EquilibriumError:  # a step too far
            return None
        if passed:
            solver, before = None, np.inf
            continue
        if largest <= _CLOSE * size or before <= largest <= _ALMOST * size:
            return r if definite or potential.rubs else None
        before = largest
    return None


def _solved(K: sparse.csc_matrix, out: Array) -> Array:
    """Solution of K x = out, not finite where K is singular: the caller sees to it."""
    if not np.isfinite(K.data).all():
        return np.full_like(out, np.nan)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return np.asarray(scipy.sparse.linalg.splu(K).solve(out))
        except RuntimeError:
            return np.full_like(out, np.nan)


def _downhill(potential: Potential, start: Array, way: Way) -> Array:
    """Newton's method with a shift that grows until the stiffness is definite and the energy falls."""
    r, size, shift, before = start.copy(), size_of(start), 0.0, np.inf
    energy = potential.energy(r)
    solver: Solver | None = None
    for _ in range(_MOST_STEPS):
        K, out = potential.stiffness(r), potential.out_of_balance(r)
        scale = float(np.abs(K.diagonal()).max())
        unit = sparse.identity(out.size, format="csc")
        solver = solver or Solver(potential.pattern(r) + unit, way)
        while True:
            try:
                solver.factorise(K + shift * scale * unit)
                step = solver.solve(out)
                largest = float(np.abs(step).max())
            except IndefiniteError:
                largest = np.inf
            if np.isfinite(largest):
                cut = min(1.0, _LONGEST * size / max(largest, 1e-300))
                tried = r + (potential.free @ (cut * step)).reshape(-1, 3)
                lower = potential.energy(tried)
                if float(step @ out) >= 0.0 and (lower <= energy or largest < _ALMOST * size):
                    break
            if shift > 1e6:
                raise EquilibriumError("the web finds no rest; check what holds it, and whether it is compressed")
            shift = max(1e-12, 10.0 * shift)
        r, passed = _hop(potential, np.asarray(tried))
        energy = lower
        if passed:
            solver, energy = None, potential.energy(r)
        shift = 0.1 * shift if shift > 1e-12 else 0.0
        if largest <= _CLOSE * size or (before <= largest <= _ALMOST * size and shift <= 1e-9):
            return r
        before = largest
    raise EquilibriumError(f"the web found no rest in {_MOST_STEPS} steps; check what holds it")
