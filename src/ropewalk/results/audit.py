"""The energy audit: energies stored, works done, the residual of their balance, and the energy throughput."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ropewalk.checkpoint import Tree
from ropewalk.results.frame import ENERGY_FORMS, Array

if TYPE_CHECKING:
    from ropewalk.model import Scenario

AUDIT = "imbalance"
ROUNDING = 1e-10  # of the largest energy: the rounding errors of sums and equilibria
_UNSTRAINED = 1e-10  # strain below which a line is without force

GIVEN = ("load_work", "hold_work", "support_work", "drive_work")


def energies(**forms: Array | float) -> Array:
    """Energies stored and works since the start in the order of ENERGY_FORMS, J, the last dimension of the result.

    What is not named is zero; what is may be numbers, or arrays (instant,).
    """
    instants = max(map(np.shape, forms.values()), key=len, default=())
    found = np.zeros((*instants, len(ENERGY_FORMS)))
    for form, value in forms.items():
        found[..., ENERGY_FORMS.index(form)] = value
    return found


class Audit:
    """Whether energy is kept: stored and spent less given, as at the first frame. What differs is the imbalance."""

    def __init__(self) -> None:
        self._first: float | None = None

    def of(self, **forms: Array | float) -> Array:
        """Energies of frames as by `energies`, the imbalance with them, J."""
        energy = energies(**forms)
        given = [ENERGY_FORMS.index(form) for form in GIVEN]
        total = energy.sum(axis=-1) - 2.0 * energy[..., given].sum(axis=-1)
        self._first = float(total.flat[0]) if self._first is None else self._first
        energy[..., ENERGY_FORMS.index(AUDIT)] = total - self._first
        return energy

    def get_state(self) -> Tree:
        """The origin."""
        return self._first

    def set_state(self, tree: Tree) -> None:
        """Count from there."""
        self._first = tree


def turnover(energy: Array, first: Array | None = None) -> Array:
    """Return the energy throughput since the start, J: half the sum of all changes of forms of energy.

    Args:
        energy: array (frame, form) in J, in the order of ENERGY_FORMS.
        first: (form,) J, at the start; None: the first of these.

    Returns:
        Array (frame,).
    """
    forms = [k for k, form in enumerate(ENERGY_FORMS) if form != AUDIT]
    begin = energy[0] if first is None else first
    moved: Array = np.nansum(np.abs(energy[:, forms] - begin[forms]), axis=1) / 2
    return moved


def rounding(scenario: Scenario | None, energy: Array) -> float:
    """Return the energy residual that rounding alone may leave, J.

    Args:
        scenario: whose lines are at rest only to a strain of 1e-10.
        energy: array (frame, form) in J, in the order of ENERGY_FORMS.
    """
    lines = () if scenario is None else scenario.lines.values()
    elastic = sum((line.axial_stiffness or 0.0) * (line.length or line.distance) for line in lines)
    largest = float(np.abs(np.nan_to_num(np.delete(energy, ENERGY_FORMS.index(AUDIT), axis=-1))).max(initial=0.0))
    return max(ROUNDING * largest, _UNSTRAINED**2 * elastic)
