"""The lowest frequencies of overhead lines against another assembly: cubic Hermite elements, written for this test."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import eigsh

from overhead_cases import EN_2002, formed
from ropewalk.model import Scenario
from ropewalk.simulate import spectrum_of
from ropewalk.wires.plan import Plan, Spot

Array = NDArray[np.float64]
LINE: dict[str, Any] = {
    **EN_2002,
    "spans": {"count": 3, "length": "60 m"},
    "contact_wire": {"mass": "1.35 kg/m", "tension": "20 kN", "bending_stiffness": 195},
    "messenger_wire": {"mass": "1.07 kg/m", "tension": "16 kN", "bending_stiffness": 131.7},
    "analysed_spans": [2, 2],
}
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
class Riding:
    """Two masses on springs below a point of the contact wire."""

    spot: Spot
    masses: tuple[float, float]
    stiffness: tuple[float, float]
    contact: float


class Hermite:
    """Two wires with droppers between them, level spans, nodes every h metres, where all that is attached lies."""

    def __init__(self, plan: Plan, h: float) -> None:
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
        K, f = np.zeros((size, size)), np.zeros(size)
        for w, wire in enumerate(plan.wires):
            for e in range(self.links):
                at = 2 * (w * self.count + e) + np.arange(4)
                K[np.ix_(at, at)] += bending(h, wire.bending_stiffness) + tensed(h, wire.tension)
                f[at] -= wire.mass * plan.gravity * h * np.array([0.5, h / 12.0, 0.5, -h / 12.0])
        for lump in plan.masses:
            f[2 * self.node(lump.spot)] -= lump.mass * plan.gravity
        ends = [2 * (w * self.count + e) for w in range(2) for e in (0, self.links)]
        above = [hold for hold in plan.holds if hold.spot.wire == 1 and np.isinf(hold.stiffness[2])]
        supports = [2 * self.node(hold.spot) for hold in above]
        arms = [2 * self.node(hold.spot) for hold in plan.holds if hold.force[2]]
        level = [2 * self.node(tie.spot) for tie in plan.ties]
        z = np.zeros(size)
        z[[*ends[2:], *supports]] = plan.wires[1].start[2]
        contact = np.arange(2 * self.count)
        free = np.setdiff1d(contact, [*ends, *arms, *level])
        z[free] = np.linalg.solve(K[np.ix_(free, free)], f[free])
        pull = (K @ z - f)[level]
        for tie, N in zip(plan.ties, pull, strict=True):
            assert isinstance(tie.other, Spot)
            f[2 * self.node(tie.other)] -= N
        free = np.setdiff1d(contact + contact.size, [*ends, *supports])
        z[free] = np.linalg.solve(K[np.ix_(free, free)], (f - K @ z)[free])
        return z[0::2], pull

    def frequencies(self, riding: Riding | None = None) -> Array:
        """All natural angular frequencies, rad/s."""
        size, h, more = 5 * 2 * self.count, self.h, 2 if riding is not None else 0
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
        if riding is not None:
            at = np.array([size, size + 1, 5 * self.node(riding.spot) + Z])
            M.add(at[:2], np.diag(riding.masses))
            low, high = riding.stiffness
            K.add(at[:2], np.array([[low + high, -high], [-high, high]]))
            K.add(at[1:], riding.contact * np.array([[1.0, -1.0], [-1.0, 1.0]]))
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
        free = np.setdiff1d(np.arange(size + more), fixed)
        stiff, heavy = (matrix.sum()[free][:, free] for matrix in (K, M))
        squares = np.sort(eigsh(stiff, 16, heavy, sigma=-1.0, return_eigenvectors=False))
        return np.sqrt(squares[squares > 1e-6])  # both wires together may slide along x


def known(plan: Plan, riding: Riding | None = None) -> Array:
    """Ten frequencies of Hermite elements of 0.5 and 0.25 m, extrapolated: chords of the sag converge with h^2."""
    coarse, fine = (Hermite(plan, h).frequencies(riding)[:10] for h in (0.5, 0.25))
    assert np.abs(fine / coarse - 1.0).max() < 1e-3
    return fine + (fine - coarse) / 3.0


def test_the_first_ten_frequencies_of_an_overhead_line_are_those_of_hermite_elements() -> None:
    exact, errors = known(formed(LINE).plan), []
    for element in (2.0, 1.0, 0.5):
        scenario = {"overhead_lines": {"section": {**LINE, "element": element}}, "run": {"kind": "equilibrium"}}
        found = spectrum_of(Scenario.model_validate(scenario), how_many=12)
        assert found.modes is not None
        errors.append(np.abs(found.modes.frequency[:10] / exact - 1.0))
    worst = np.array(errors).max(axis=1)
    order = np.log2(worst[:-1] / worst[1:])
    print("exact", exact, "errors", np.array(errors), "orders", order)
    assert worst[-1] < 1.5e-4
    assert np.abs(order[-1] - 2.0) < 0.2  # on the coarsest mesh errors of several kinds meet


def test_a_pantograph_under_the_contact_wire_changes_them_as_it_does_those_of_hermite_elements() -> None:
    own = Riding(Spot(0, 80.0), (20.0, 10.0), (1.0, 7000.0), 5e4)  # held by next to nothing: it does not lift
    line = {**LINE, "ends": "anchored"}  # between weights it may slide, and rounding moves it by centimetres
    exact, bare = known(formed(line).plan, own), known(formed(line).plan)
    pantograph = {
        "kind": "pantograph", "on": "section", "travel": {"speed": 0.0, "from": 80.0}, "masses": own.masses,
        "stiffness": own.stiffness, "damping": [0.0, 0.0], "contact_stiffness": own.contact, "static_force": 1e-6,
    }  # fmt: skip
    scenario = {"overhead_lines": {"section": line}, "loads": {"head": pantograph}, "run": {"kind": "equilibrium"}}
    modes = spectrum_of(Scenario.model_validate(scenario), how_many=12).modes
    assert modes is not None
    print(exact / bare - 1.0, modes.frequency[:10] / exact - 1.0)
    assert modes.frequency[:10] == pytest.approx(exact, rel=1.5e-4)  # as without it
    assert np.abs(exact / bare - 1.0).max() > 0.02
