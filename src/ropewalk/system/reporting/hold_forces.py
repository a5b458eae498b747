"""Hold forces at rest: what keeps loads in their places where the tensions beside them are not free.

Without friction nothing is won by moving a contact along its line: the tensions T beside it are alike. Friction lets
them differ by up to R |N|, N the part of its force across the line, with half the angle by which that turns there,

    sin(half) = |N| / (2 (T + EI/h^2)),   R = tanh(mu half) / sin(half)  (capstan)  or  mu / cos(half)  (block).

A load that friction does not hold is held by a horizontal force.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.chain import CLAMPED, COULOMB, DRAGGED, FRICTIONLESS, Array, Integers
from ropewalk.system.contact.friction import SHARP, STRAIGHT
from ropewalk.system.elements.segments import bending_of
from ropewalk.system.elements.structure import Runs, Structure

# Forces of the line along itself come out to this part of those on it: above the rounding of shapes at rest.
_EQUAL = 1e-8
_BALANCED = 1e-6  # residual of a level force; rounding on a line of 10 GN alone makes 1e-8
# Links from a contact, where its line is as beyond the kink.
_BESIDE = 1.5


def beside(contacts: Any, runs: Runs, tension: Array, begin: Integers) -> Array:
    """Tensions behind and ahead of contacts, (contact, 2) N, where their lines are as beyond the kinks.

    Args:
        contacts: records.
        runs: of their lines.
        tension: of links, N.
        begin: (contact,) where in that the links begin among which each is.
    """
    run = contacts["run"]
    link = np.floor(contacts["x"][:, None] + np.array([-_BESIDE, _BESIDE])).astype(np.int64)
    link = np.minimum(np.maximum(link, 0), runs.links[run][:, None] - 1)
    return np.asarray(tension[link + (begin + runs.first[run])[:, None]])


class FrictionDemand(NamedTuple):
    """The forces of contacts on their lines, as friction sees them, (contact,)."""

    along: Array  # N, towards the end of the line
    across: Array  # N
    half: Array  # rad, half the angle by which the line turns

    @staticmethod
    def of(contacts: Any, structure: Structure, s: Array, both: Array, axes: int) -> FrictionDemand:
        """What is known of contacts at s in m of their lines; at the ends of these, the support bears all.

        What it takes to move one along its line is the change of all energy, its kink turns with it.

        Args:
            contacts: records.
            structure: what they stand on.
            s: (contact,) m.
            both: (contact, 2) N, tensions beside them.
            axes: of space.
        """
        runs, run, pull = structure.runs, contacts["run"], both.sum(axis=1)
        N, way = contacts["N"][:, :axes], contacts["along"][:, :axes]
        inside, on_net = (s > 0.0) & (s < structure.lines.length[contacts["line"]]), runs.firm[run] > 0.0
        square = (way * way).sum(axis=1)
        on_line = 1.0 + law.strains(runs.law[run], 0.5 * pull)
        lags = runs.hysteresis[run, 0] > 0.0  # its strain is no function of its tension
        along = -contacts["push"] / np.where(on_net | lags, np.sqrt(square), on_line)
        part = (N * way).sum(axis=1) / np.where(square > 0.0, square, 1.0)
        across = np.linalg.norm(N - part[:, None] * way, axis=1)
        whole = pull + 2.0 * bending_of(structure, contacts) / runs.h[run] ** 2
        turns = across < whole
        half = np.where(turns, np.arcsin(np.where(turns, across, 0.0) / np.where(turns, whole, 1.0)), 0.5 * np.pi)
        half[on_net] = 0.0  # a net does not bend around a contact
        return FrictionDemand(*(np.where(inside, each, 0.0) for each in (along, across, half)))

    def most(self, contacts: Any) -> Array:
        """Forces along their lines that the friction of contacts bears, N."""
        mu, half, bends = contacts["friction"], self.half, self.half > STRAIGHT
        bent = np.tanh(mu * half) / np.where(bends, np.sin(half), 1.0)
        point = mu / np.maximum(np.cos(half), SHARP)
        return np.asarray(np.where(contacts["block"] == 1, point, np.where(bends, bent, mu)) * self.across)

    def needed(self, contacts: Any) -> Array:
        """The friction coefficients that contacts need at least."""
        pressed, bends = self.across > 0.0, self.half > STRAIGHT
        ratio = np.abs(self.along) / np.where(pressed, self.across, 1.0)
        part = ratio * np.sin(self.half)
        bears = bends & (part < 1.0)
        bent = np.where(bears, np.arctanh(np.where(bears, part, 0.0)) / np.where(bends, self.half, 1.0), np.inf)
        around = np.where(bends, bent, ratio)
        found = np.where(contacts["block"] == 1, ratio * np.cos(self.half), around)
        return np.where(self.along == 0.0, 0.0, np.where(pressed, found, np.inf))


class HoldForces:
    """The hold forces of given forces that stand on lines.

    Args:
        kind: (contact,) CLAMPED, FRICTIONLESS, COULOMB or DRAGGED.
        ahead: (contact,) +1 or -1, the direction of travel.
        structure: what they stand on.
        tension: of its links, N, as they are found.
        axes: of space.
    """

    def __init__(self, kind: Integers, ahead: Array, structure: Structure, tension: Array, axes: int) -> None:
        self._kind, self._ahead, self._structure, self._tension, self._axes = kind, ahead, structure, tension, axes

    def hold(self, contacts: Any, s: Array, on: Integers, settle: Callable[[Array], Array], shape: Array) -> Array:
        """Shape at rest with the hold forces that contacts on their lines need, which are noted with them.

        Args:
            contacts: records, changed.
            s: (contact,) m, where they are on their lines.
            on: numbers of those on their lines.
            settle: finds the rest next to a shape.
            shape: with the forces that contacts hold now.

        Raises:
            EquilibriumError: nothing holds one of them there, or there is no rest.
        """
        length = self._structure.lines.length[contacts["line"]]
        kinds = FRICTIONLESS, COULOMB, DRAGGED
        inner = [k for k in on.tolist() if self._kind[k] in kinds and 0.0 < s[k] < length[k]]
        contacts["hold"][np.setdiff1d(np.arange(contacts.size), inner)] = 0.0
        stands = [k for k in inner if self._kind[k] == COULOMB]
        contacts["hold"][stands] = 0.0
        sign = np.where(self._kind == DRAGGED, self._ahead, 0.0)
        slides = [k for k in inner if self._kind[k] != COULOMB]
        for _ in range(len(stands) + 1):
            shape = self._balance(contacts, s, slides, sign, settle, shape)
            friction_demand = self._friction_demand(contacts, s, stands)
            too_much = (
                np.abs(friction_demand.along) > friction_demand.most(contacts[stands]) + _EQUAL * friction_demand.across
            )
            slips = [i for i, k in enumerate(stands) if k not in slides and too_much[i]]
            if not slips:
                return shape
            for i in slips:
                sign[stands[i]] = np.sign(friction_demand.along[i])
            slides = slides + [stands[i] for i in slips]
        return self._balance(contacts, s, slides, sign, settle, shape)

    def _friction_demand(self, contacts: Any, s: Array, which: list[int]) -> FrictionDemand:
        own = contacts[which]
        both = beside(own, self._structure.runs, self._tension, np.zeros(len(which), dtype=np.int64))
        return FrictionDemand.of(own, self._structure, s[which], both, self._axes)

    def _balance(
        self, contacts: Any, s: Array, slides: list[int], sign: Array, settle: Callable[[Array], Array], shape: Array
    ) -> Array:
        """Shape at rest in which friction bears all that it can, of contacts that slide."""
        found = settle(shape)
        if not slides:
            return found
        size = float(np.abs(contacts["N"][slides]).max())
        if size == 0.0:
            return found

        def miss(hold: Array) -> Array:
            nonlocal found
            contacts["hold"][slides] = hold * size
            found = settle(found)
            friction_demand = self._friction_demand(contacts, s, slides)
            return np.asarray((friction_demand.along - sign[slides] * friction_demand.most(contacts[slides])) / size)

        first, friction_demand = contacts["hold"][slides] / size, self._friction_demand(contacts, s, slides)
        for i, k in enumerate(slides):
            if first[i] == 0.0:  # as on a line that stays as it is
                way, level = contacts[k]["along"][: self._axes], self._structure.runs.ahead[contacts[k]["run"]]
                first[i] = -friction_demand.along[i] * float(np.linalg.norm(way)) / float(way @ level) / size
        from scipy.optimize import root  # lazy: it takes long to import

        solved = root(miss, first, method="hybr", options={"xtol": 1e-12, "eps": 1e-7})
        if np.abs(miss(solved.x)).max() > _BALANCED:
            raise EquilibriumError("nothing holds a load there: the force that it takes grows beyond all bounds")
        return found


def on_friction(load: str, kind: int, contact: Any, needed: float) -> str:
    """What to know of the friction of a contact that stands or is held on its line; empty where there is nothing."""
    given = float(contact["friction"])
    if kind == CLAMPED and needed > given > 0.0:
        return f"load {load} needs a friction coefficient of {needed:.3g}, more than the given {given:g}"
    if kind == COULOMB and contact["hold"] != 0.0:
        return f"load {load} slips: friction {given:g} does not hold it, a force of {float(contact['hold']):.4g} N does"
    return ""
