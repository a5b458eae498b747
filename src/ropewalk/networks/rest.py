"""Rest of a network, its contacts as they stand."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import scipy.sparse as sparse

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Integers
from ropewalk.networks.contact_location import divide, join, location
from ropewalk.networks.network import OFF, Array, Network
from ropewalk.networks.potential import NetworkPotential
from ropewalk.networks.relax import relaxed
from ropewalk.networks.sheaves import hop
from ropewalk.solve import minimum
from ropewalk.solve.symmetric import Way

# A node is at a sheave if it is closer than this part of a link.
_AT = 1e-4
_STICKS = 50.0  # coefficient of friction at which nothing slips


class Slip(NamedTuple):
    """How far lines have slipped over sheaves."""

    link: Integers  # (sheave,) that lies on it
    ahead: Array  # (sheave,) m, of that link before it


def stand(network: Network, r: Array, t: float) -> None:
    """Let all contacts stand where they are at time t; those that were not there before start on the straight line.

    Args:
        network: whose slots change.
        r: (node, 3) m; places of contacts change.
    """
    locations = network.locations
    hold_at(network, r, t)
    join(network)
    location(network, t)
    _refuse_at_sheaves(network)
    for k in range(locations.kind.size):
        if locations.kind[k] == OFF or locations.last[k] == locations.cell[k]:
            continue
        e = locations.cell[k]
        r[network.nodes + k] = locations.weight[k] @ r[[network.links.one[e], network.links.other[e]]]
        locations.last[k] = locations.cell[k]
    divide(network)


def _refuse_at_sheaves(network: Network) -> None:
    """Refuse contacts on links over which sheaves stand, which stand for these already.

    Raises:
        EquilibriumError: there is one.
    """
    if np.isin(network.locations.cell[network.locations.kind != OFF], network.sheaves.link).any():
        raise EquilibriumError("a load has come to a sheave, which it cannot pass; let it stay beside it")


def hold_at(network: Network, r: Array, t: float) -> None:
    """Put what moves as prescribed where it is at time t, in s; places r (node, 3) of fixed nodes change."""
    moves = network.restrained.moves
    for i, (n, k) in enumerate(zip(moves.node, moves.spring, strict=True)):
        part = slice(int(moves.first[i]), int(moves.first[i] + moves.entries[i]))
        place = moves.place[i] + [np.interp(t, moves.time[part], row[part]) for row in moves.value]
        if k >= 0:
            network.restrained.place[k] = place
        else:
            r[n] = place


def leave(network: Network) -> None:
    """Take all contacts off."""
    join(network)
    network.locations.kind[:] = OFF
    network.locations.last[:] = -1


def slip_of(network: Network) -> Slip:
    """How far lines have slipped over sheaves."""
    return Slip(network.sheaves.link.copy(), network.sheaves.ahead.copy())


def put_slip(network: Network, slip: Slip) -> None:
    """Let lines have slipped so far."""
    network.links.on[network.sheaves.link] = 1
    network.sheaves.link[:], network.sheaves.ahead[:] = slip
    network.links.on[network.sheaves.link] = 0


def size_of(r: Array) -> float:
    """Extent of a network, m."""
    return float(np.ptp(r, axis=0).max())


class _NetworkShape:
    """The potential energy of a network as a function of what may move, see `solve/minimum.py`."""

    def __init__(self, potential: NetworkPotential, start: Array) -> None:
        self.potential, self.network = potential, potential.network
        self.size, self.is_symmetric = size_of(start), not potential.rubs
        self.energy, self.out_of_balance = potential.energy, potential.out_of_balance
        self.stiffness, self.pattern, self.free = potential.stiffness, potential.pattern, potential.free
        self._slip = slip_of(self.network)

    def stability(self, r: Array) -> tuple[sparse.csc_matrix, Integers]:
        """Of lines stuck to sheaves that rub; of what lies in a plane, within that."""
        sheaves, potential = self.network.sheaves, self.potential
        potential.pull(r)
        friction, ahead = sheaves.friction.copy(), sheaves.ahead.copy()
        if potential.rubs:
            sheaves.friction[:] = _STICKS
            potential = NetworkPotential(self.network, rubs=True)
        K = potential.stiffness(r)
        sheaves.friction[:], sheaves.ahead[:] = friction, ahead
        inner = np.flatnonzero(potential.in_plane()) if not r[:, 1].any() else np.arange(K.shape[0])
        return 0.5 * (K + K.T).tocsc()[inner][:, inner], inner

    def moved(self, r: Array, step: Array) -> Array:
        return np.asarray(r + (self.potential.free @ step).reshape(-1, 3))

    def arrived(self, r: Array) -> tuple[Array, bool]:
        """Let nodes pass sheaves to which they have been brought; also says whether one did.

        Raises:
            EquilibriumError: a line runs out.
        """
        network = self.network
        if not network.sheaves.node.size:
            return r, False
        out = r.copy()
        _push_over(network, out)
        before = network.sheaves.link.copy()
        if not hop(network.links, network.sheaves, out, np.zeros_like(out)):
            raise EquilibriumError("a line runs over a sheave up to its end, or to the next sheave; make it longer")
        passed = bool((before != network.sheaves.link).any())
        if passed:
            _refuse_at_sheaves(network)
            self.potential.settle_slip()
        return out, passed

    def approaches(self, start: Array, way: Way) -> Iterator[Array]:
        """Where it has come nearly to rest, from where it was."""
        put_slip(self.network, self._slip)
        self.potential.settle_slip()
        near = relaxed(self.potential, start)
        if near is not None:
            yield near


def settle(network: Network, start: Array, *, rubs: bool = False, way: Way = "auto") -> Array:
    """Find the rest next to a shape, contacts as they stand, see `solve/minimum.py`.

    Args:
        network: lines slip at its sheaves.
        start: (node, 3) m.
        rubs: whether they rub there.
        way: of solving, see `solve/symmetric.py`.

    Returns:
        Places (node, 3), m.

    Raises:
        EquilibriumError: no rest was found.
    """
    if start.shape != network.body.force.shape:  # kernels would write beyond their arrays
        raise ValueError(
            f"a shape of {start.shape[0]} nodes and contacts for a network of {network.body.force.shape[0]}"
        )
    potential = NetworkPotential(network, rubs=rubs)
    found = minimum.settle(_NetworkShape(potential, start), start, way)
    potential.pull(found)
    return found


def _push_over(network: Network, r: Array) -> None:
    """Push nodes that have come close to a sheave beyond it, where the line pulls harder from there; r is changed.

    In the energy as a function of its place, a node that is about to pass sits on the tip of a cone.
    """
    links, sheaves = network.links, network.sheaves
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
