"""The measure of an energy balance: how much energy has changed its form."""

from __future__ import annotations

import numpy as np

from ropewalk.results.frame import ENERGY_FORMS, Array

AUDIT = "imbalance"


def turnover(energy: Array) -> Array:
    """Energy that has changed its form since the start, in J: half the sum of all changes.

    Args:
        energy: array (frame, form) in J, in the order of ENERGY_FORMS.

    Returns:
        Array (frame,).
    """
    forms = [k for k, form in enumerate(ENERGY_FORMS) if form != AUDIT]
    moved: Array = np.nansum(np.abs(energy[:, forms] - energy[:1, forms]), axis=1) / 2
    return moved
