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
from scipy import optimize

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.chain import CLAMPED, COULOMB, DRAGGED, FRICTIONLESS, Array, Integers
from ropewalk.system.friction import SHARP, STRAIGHT
from ropewalk.system.structure import Runs, Structure

# Forces of the line along itself come out to this part of those on it: above the rounding of shapes at rest.
_EQUAL = 1e-8
# Links from a contact, where its line is as beyond the kink.
_BESIDE = 1.5


def beside(contact: Any, runs: Runs, tension: Array) -> tuple[float, float]:
    """Tensions behind and ahead of a contact, N, where its line is as beyond the kink; `tension` of links, N."""
    run, first = int(contact["run"]), int(runs.first[contact["run"]])
    places = (int(np.floor(contact["x"] + way)) for way in (-_BESIDE, _BESIDE))
    behind, ahead = (float(tension[first + min(max(i, 0), int(runs.links[run]) - 1)]) for i in places)
    return behind, ahead


class Grip(NamedTuple):
    """The force of a contact on its line, as friction sees it."""

    along: float  # N, towards the end of the line
    across: float  # N
    half: float  # rad, half the angle by which the line turns

    @staticmethod
    def of(contact: Any, structure: Structure, s: float, tension: Array, axes: int) -> Grip:
        """What is known of a contact at s in m of its line; at its ends, the support bears all.

        What it takes to move it along the line is the change of all energy, its kink turns with it.
        """
        run, N, way = int(contact["run"]), contact["N"][:axes], contact["along"][:axes]
        runs = structure.runs
        if not 0.0 < s < structure.lines.length[contact["line"]]:
            return Grip(0.0, 0.0, 0.0)
        both, stretch = sum(beside(contact, runs, tension)), float(np.linalg.norm(way))
        if runs.firm[run] == 0.0:
            stretch = 1.0 + law.strain(runs.law[run], 0.5 * both)
        along = -float(contact["push"]) / stretch
        across = float(np.linalg.norm(N - (N @ way) / (way @ way) * way))
        if runs.firm[run] > 0.0:  # a net does not bend around a contact
            return Grip(along, across, 0.0)
        whole = both + 2.0 * float(runs.bending[run] / runs.h[run] ** 2)
        return Grip(along, across, float(np.arcsin(across / whole)) if across < whole else 0.5 * np.pi)

    def most(self, contact: Any) -> float:
        """Force along the line that the friction of a contact bears, N."""
        mu = float(contact["friction"])
        if contact["block"]:
            return mu / max(float(np.cos(self.half)), SHARP) * self.across
        return (float(np.tanh(mu * self.half) / np.sin(self.half)) if self.half > STRAIGHT else mu) * self.across

    def needed(self, contact: Any) -> float:
        """The friction coefficient that a contact needs at least."""
        if self.along == 0.0:
            return 0.0
        if self.across == 0.0:
            return np.inf
        ratio = abs(self.along) / self.across
        if contact["block"]:
            return float(ratio * np.cos(self.half))
        if self.half <= STRAIGHT:
            return ratio
        part = ratio * np.sin(self.half)
        return float(np.arctanh(part) / self.half) if part < 1.0 else np.inf


class Holding:
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
            slips = [k for k in stands if k not in slides and self._slips(contacts[k], s[k])]
            if not slips:
                return shape
            for k in slips:
                sign[k] = np.sign(self._grip(contacts[k], s[k]).along)
            slides = slides + slips
        return self._balance(contacts, s, slides, sign, settle, shape)

    def _grip(self, contact: Any, s: float) -> Grip:
        return Grip.of(contact, self._structure, s, self._tension, self._axes)

    def _slips(self, contact: Any, s: float) -> bool:
        grip = self._grip(contact, s)
        return abs(grip.along) > grip.most(contact) + _EQUAL * grip.across

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
            out = np.empty(len(slides))
            for i, k in enumerate(slides):
                grip = self._grip(contacts[k], s[k])
                out[i] = grip.along
                if sign[k] != 0.0:
                    out[i] -= sign[k] * grip.most(contacts[k])
            return out / size

        first = contacts["hold"][slides] / size
        for i, k in enumerate(slides):
            if first[i] == 0.0:  # as on a line that stays as it is
                grip, way = self._grip(contacts[k], s[k]), contacts[k]["along"][: self._axes]
                level = self._structure.runs.ahead[contacts[k]["run"]]
                first[i] = -grip.along * float(np.linalg.norm(way)) / float(way @ level) / size
        solved = optimize.root(miss, first, method="hybr", options={"xtol": 1e-12, "eps": 1e-7})
        if np.abs(miss(solved.x)).max() > _EQUAL:
            raise EquilibriumError("nothing holds a load there: the force that it takes grows beyond all bounds")
        return found


def on_friction(load: str, kind: int, contact: Any, needed: float) -> str:
    """What to know of the friction of a contact that stands or is held on its line; empty where there is nothing."""
    given = float(contact["friction"])
    if kind == CLAMPED and needed > given > 0.0:
        return (
            f"load {load} needs a friction coefficient of {needed:.3g}: the {given:g} that was given does not suffice"
        )
    if kind == COULOMB and contact["hold"] != 0.0:
        return f"load {load} slips: friction {given:g} does not hold it, a force of {float(contact['hold']):.4g} N does"
    return ""
