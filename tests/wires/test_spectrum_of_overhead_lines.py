"""The lowest frequencies of overhead lines against another assembly: cubic Hermite elements, written for this test."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import eigh

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


class Hermite:
    """Two wires with droppers between them, all level spans, nodes every h metres at which all that is attached lies."""

    def __init__(self, plan: Plan, h: float) -> None:
        self.plan, self.h, self.links = plan, h, round(plan.wires[0].length / h)
        self.count = self.links + 1

    def node(self, spot: Spot) -> int:
        at = spot.station / self.h
        assert abs(at - round(at)) < 1e-9
        return spot.wire * self.count + round(at)

    def heights(self) -> Array:
        """Heights of all nodes at rest, (node,) m: linear statics of tensed beams and springs."""
        size, h = 2 * 2 * self.count, self.h
        K, f = np.zeros((size, size)), np.zeros(size)
        for w, wire in enumerate(self.plan.wires):
            for e in range(self.links):
                at = 2 * (w * self.count + e) + np.arange(4)
                K[np.ix_(at, at)] += bending(h, wire.bending_stiffness) + tensed(h, wire.tension)
                f[at] -= wire.mass * self.plan.gravity * h * np.array([0.5, h / 12.0, 0.5, -h / 12.0])
        for lump in self.plan.masses:
            f[2 * self.node(lump.spot)] -= lump.mass * self.plan.gravity
        for tie in self.plan.ties:
            assert isinstance(tie.other, Spot)
            at = 2 * np.array([self.node(tie.spot), self.node(tie.other)])
            K[np.ix_(at, at)] += tie.stiffness * np.array([[1.0, -1.0], [-1.0, 1.0]])
            f[at] += tie.stiffness * tie.length * np.array([-1.0, 1.0])
        z, fixed = np.zeros(size), {}
        for w, wire in enumerate(self.plan.wires):
            fixed |= {2 * w * self.count: wire.start[2], 2 * (w * self.count + self.links): wire.end[2]}
        for hold in self.plan.holds:
            if np.isinf(hold.stiffness[2]):
                fixed[2 * self.node(hold.spot)] = hold.place[2]
            else:
                f[2 * self.node(hold.spot)] += hold.force
        z[list(fixed)] = list(fixed.values())
        free = np.setdiff1d(np.arange(size), list(fixed))
        z[free] = np.linalg.solve(K[np.ix_(free, free)], (f - K @ z)[free])
        return z[0::2]

    def frequencies(self, mass_at: tuple[Spot, float] | None = None) -> Array:
        """All natural angular frequencies, rad/s."""
        size, h, z = 5 * 2 * self.count, self.h, self.heights()
        K, M = np.zeros((size, size)), np.zeros((size, size))
        for w, wire in enumerate(self.plan.wires):
            for e in range(self.links):
                i = w * self.count + e
                rise = z[i + 1] - z[i]
                L = float(np.hypot(h, rise))
                c, s = h / L, rise / L
                T, rho = wire.tension / c, wire.mass * c  # what is given is tension along x and mass for each metre of x
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
                K[np.ix_(at, at)] += turn.T @ own @ turn
                M[np.ix_(at, at)] += turn.T @ lump @ turn
                K[np.ix_(aside, aside)] += across
                M[np.ix_(aside, aside)] += inertia(L, rho)
        for lump_ in self.plan.masses:
            at = 5 * self.node(lump_.spot) + np.array([X, Y, Z])
            M[at, at] += lump_.mass
        if mass_at is not None:  # up and down only
            at = 5 * self.node(mass_at[0]) + Z
            M[at, at] += mass_at[1]
        for tie in self.plan.ties:
            assert isinstance(tie.other, Spot)
            one, other = self.node(tie.spot), self.node(tie.other)
            reach = z[other] - z[one]
            pull = tie.stiffness * (reach - tie.length)
            assert pull > 0.0
            for a, k in ((X, pull / reach), (Y, pull / reach), (Z, tie.stiffness)):
                at = 5 * np.array([one, other]) + a
                K[np.ix_(at, at)] += k * np.array([[1.0, -1.0], [-1.0, 1.0]])
        fixed = [5 * n + a for w in range(2) for n in (w * self.count, w * self.count + self.links) for a in (Y, Z)]
        for hold in self.plan.holds:
            fixed += [5 * self.node(hold.spot) + a for a, k in zip((X, Y, Z), hold.stiffness, strict=True) if k > 0.0]
        free = np.setdiff1d(np.arange(size), fixed)
        squares = eigh(K[np.ix_(free, free)], M[np.ix_(free, free)], eigvals_only=True, subset_by_index=(0, 15))
        return np.sqrt(squares[squares > 1e-6])  # both wires together may slide along x


def test_the_first_ten_frequencies_of_an_overhead_line_are_those_of_hermite_elements() -> None:
    plan = formed(LINE).plan
    known = Hermite(plan, 0.5).frequencies()[:10]
    errors = []
    for element in (2.0, 1.0, 0.5):
        scenario = {"overhead_lines": {"section": {**LINE, "element": element}}, "run": {"kind": "equilibrium"}}
        found = spectrum_of(Scenario.model_validate(scenario), how_many=12)
        assert found.modes is not None
        errors.append(np.abs(found.modes.frequency[:10] / known - 1.0))
    order = np.log2(errors[-2] / errors[-1])
    print("known", known, "errors", np.array(errors), "order", order)
    assert errors[-1].max() < 1e-4


@pytest.mark.parametrize("mass", [20.0, 200.0])
def test_a_mass_under_the_contact_wire_changes_them_as_it_does_those_of_hermite_elements(mass) -> None:
    plan = formed(LINE).plan
    raise NotImplementedError
