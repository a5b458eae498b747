"""Another assembly of overhead lines, for tests: two wires of cubic Hermite elements, joined by tight droppers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import eigsh, splu

from ropewalk.wires.plan import Spot, WirePlan

Array = NDArray[np.float64]
X, Z, TURN, Y, YAW = range(5)  # degrees of freedom of a node: in the plane and out of it, slopes of the wire


def bending(L: float, EI: float) -> Array:
    """Stiffness of a beam element against deflections and slopes at its two ends."""
    K = [[12.0, 6 * L, -12.0, 6 * L], [6 * L, 4 * L * L, -6 * L, 2 * L * L],
         [-12.0, -6 * L, 12.0, -6 * L], [6 * L, 2 * L * L, -6 * L, 4 * L * L]]  # fmt: skip
    return EI / L**3 * np.array(K)


def tensed(L: float, T: float) -> Array:
    """Geometric stiffness of the same under tension."""
    K = [[36.0, 3 * L, -36.0, 3 * L], [3 * L, 4 * L * L, -3 * L, -L * L],
         [-36.0, -3 * L, 36.0, -3 * L], [3 * L, -L * L, -3 * L, 4 * L * L]]  # fmt: skip
    return T / (30.0 * L) * np.array(K)


def inertia(L: float, rho: float) -> Array:
    """Consistent mass of the same."""
    M = [[156.0, 22 * L, 54.0, -13 * L], [22 * L, 4 * L * L, 13 * L, -3 * L * L],
         [54.0, 13 * L, 156.0, -22 * L], [-13 * L, -3 * L * L, -22 * L, 4 * L * L]]  # fmt: skip
    return rho * L / 420.0 * np.array(M)


class Assembly:
    """A symmetric sparse matrix that is the sum of blocks."""

    def __init__(self, size: int) -> None:
        self.size, self.parts = size, list[tuple[Array, Array, Array]]()

    def add(self, at: NDArray[np.int64], block: Array) -> None:
        self.parts.append((np.repeat(at, at.size), np.tile(at, at.size), block.ravel()))

    def sum(self) -> csc_matrix:
        row, column, value = (np.concatenate(parts) for parts in zip(*self.parts, strict=True))
        return csc_matrix((value, (row, column)), shape=(self.size, self.size))


@dataclass(frozen=True)
class MovingWith:
    """Two masses on springs below a point of the contact wire."""

    spot: Spot
    masses: tuple[float, float]
    stiffness: tuple[float, float]
    contact: float


class Hermite:
    """Two wires with droppers between them, level spans, nodes every h metres, where all that is attached lies."""

    def __init__(self, plan: WirePlan, h: float) -> None:
        self.plan, self.h, self.links = plan, h, round(plan.wires[0].length / h)
        self.count = self.links + 1

    def node(self, spot: Spot) -> int:
        at = spot.station / self.h
        assert abs(at - round(at)) < 1e-9
        return spot.wire * self.count + round(at)

    def rest(self) -> tuple[Array, Array]:
        """Heights of all nodes at rest, (node,) m, and pulls of the droppers in N: linear statics of tensed beams.

        The contact wire is level at droppers and arms, as wanted, which says what they bear.
        """
        size, h, plan = 2 * 2 * self.count, self.h, self.plan
        parts, f = Assembly(size), np.zeros(size)
        for w, wire in enumerate(plan.wires):
            for e in range(self.links):
                at = 2 * (w * self.count + e) + np.arange(4)
                parts.add(at, bending(h, wire.bending_stiffness) + tensed(h, wire.tension))
                f[at] -= wire.mass * plan.gravity * h * np.array([0.5, h / 12.0, 0.5, -h / 12.0])
        for lump in plan.masses:
            f[2 * self.node(lump.spot)] -= lump.mass * plan.gravity
        ends = [2 * (w * self.count + e) for w in range(2) for e in (0, self.links)]
        above = [hold for hold in plan.holds if hold.spot.wire == 1 and np.isinf(hold.stiffness[2])]
        supports = [2 * self.node(hold.spot) for hold in above]
        arms = [2 * self.node(hold.spot) for hold in plan.holds if hold.force[2]]
        level = [2 * self.node(tie.spot) for tie in plan.ties]
        K, z = parts.sum(), np.zeros(size)
        z[[*ends[2:], *supports]] = plan.wires[1].start[2]
        contact = np.arange(2 * self.count)
        free = np.setdiff1d(contact, [*ends, *arms, *level])
        z[free] = splu(K[free][:, free]).solve(f[free])
        pull = (K @ z - f)[level]
        for tie, N in zip(plan.ties, pull, strict=True):
            assert isinstance(tie.other, Spot)
            f[2 * self.node(tie.other)] -= N
        free = np.setdiff1d(contact + contact.size, [*ends, *supports])
        z[free] = splu(K[free][:, free]).solve((f - K @ z)[free])
        return z[0::2], pull

    def matrices(self, moving_with: MovingWith | None = None) -> tuple[csc_matrix, csc_matrix, NDArray[np.int64]]:
        """Stiffness and mass about rest of all degrees of freedom, and which of them are free."""
        size, h, more = 5 * 2 * self.count, self.h, 2 if moving_with is not None else 0
        z, pulls = self.rest()
        K, M = Assembly(size + more), Assembly(size + more)
        for w, wire in enumerate(self.plan.wires):
            for e in range(self.links):
                i = w * self.count + e
                rise = z[i + 1] - z[i]
                L = float(np.hypot(h, rise))
                c, s = h / L, rise / L
                T, rho = wire.tension / c, wire.mass * c  # given are tension along x and mass per metre of x
                across = bending(L, wire.bending_stiffness) + tensed(L, T)
                turn = np.zeros((6, 10))  # along, across, slope at both ends, from the degrees of freedom of the nodes
                for end in range(2):
                    turn[3 * end : 3 * end + 2, 5 * end + X : 5 * end + Z + 1] = [[c, s], [-s, c]]
                    turn[3 * end + 2, 5 * end + TURN] = 1.0
                bar = wire.axial_stiffness / L * np.array([[1.0, -1.0], [-1.0, 1.0]])
                own, lump = np.zeros((6, 6)), np.zeros((6, 6))
                own[np.ix_([0, 3], [0, 3])] = bar
                own[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = across
                lump[np.ix_([0, 3], [0, 3])] = rho * L / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
                lump[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = inertia(L, rho)
                at, aside = 5 * i + np.arange(10), 5 * i + np.array([Y, YAW, 5 + Y, 5 + YAW])
                K.add(at, turn.T @ own @ turn)
                M.add(at, turn.T @ lump @ turn)
                K.add(aside, across)
                M.add(aside, inertia(L, rho))
        for lump_ in self.plan.masses:
            at = 5 * self.node(lump_.spot) + np.array([X, Y, Z])
            M.add(at, lump_.mass * np.eye(3))
        if moving_with is not None:
            at = np.array([size, size + 1, 5 * self.node(moving_with.spot) + Z])
            M.add(at[:2], np.diag(moving_with.masses))
            low, high = moving_with.stiffness
            K.add(at[:2], np.array([[low + high, -high], [-high, high]]))
            K.add(at[1:], moving_with.contact * np.array([[1.0, -1.0], [-1.0, 1.0]]))
        for tie, pull in zip(self.plan.ties, pulls, strict=True):
            assert isinstance(tie.other, Spot)
            one, other = self.node(tie.spot), self.node(tie.other)
            reach = z[other] - z[one]
            assert pull > 0.0
            for a, k in ((X, pull / reach), (Y, pull / reach), (Z, tie.stiffness)):
                at = 5 * np.array([one, other]) + a
                K.add(at, k * np.array([[1.0, -1.0], [-1.0, 1.0]]))
        fixed = [5 * n + a for w in range(2) for n in (w * self.count, w * self.count + self.links) for a in (Y, Z)]
        fixed += [
            5 * (w * self.count + e) + X
            for w, wire in enumerate(self.plan.wires)
            for kind, e in zip(wire.ends, (0, self.links), strict=True)
            if kind != "free"
        ]
        for hold in self.plan.holds:
            fixed += [5 * self.node(hold.spot) + a for a, k in zip((X, Y, Z), hold.stiffness, strict=True) if k > 0.0]
        return K.sum(), M.sum(), np.setdiff1d(np.arange(size + more), fixed)

    def frequencies(self, moving_with: MovingWith | None = None) -> Array:
        """The lowest natural angular frequencies, rad/s."""
        K, M, free = self.matrices(moving_with)
        stiff, heavy = K[free][:, free], M[free][:, free]
        squares = np.sort(eigsh(stiff, 16, heavy, sigma=-1.0, return_eigenvectors=False))
        return np.sqrt(squares[squares > 1e-6])  # both wires together may slide along x

    def elasticity(self, stations: Array) -> Array:
        """Rise of the contact wire under a force upwards there, over the force, (station,) m/N."""
        K, _, free = self.matrices()
        at = np.searchsorted(free, [5 * self.node(Spot(0, float(x))) + Z for x in stations])
        pushes = np.zeros((free.size, at.size))
        pushes[at, np.arange(at.size)] = 1.0
        rise = splu(K[free][:, free]).solve(pushes)
        return np.asarray(rise[at, np.arange(at.size)])
