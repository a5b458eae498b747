"""Membranes and nets."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.theory import membrane
from ropewalk.validation.known_case import KnownCase, frequencies
from ropewalk.validation.known_number import KnownNumber
from ropewalk.validation.publication import Publication

RAYLEIGH = Publication("Rayleigh, The Theory of Sound I, ch. 9: membranes", "elementary")
SIDES = (4.0, 3.0)
SHEET = """
gravity: 0
nets:
  net:
    kind: {kind}
    corner: [0, 0, 0]
    sides: [[4, 0, 0], [0, 3, 0]]
    cells: [{cells}, {cells}]
    {own}
"""
MEMBRANE = SHEET.format(kind="membrane", cells=16, own="stiffness: 1.0e+8\n    mass: 0.3\n    tension: 500")
STIFF = "axial_stiffness: 1.0e+8\n    mass: 0.05\n    tension: 100"
NET = SHEET.format(kind="net", cells=12, own=STIFF)
AT_REST = "run: {kind: equilibrium}\n"
AT_NODE = """
loads:
  weight: {kind: force, on: net, force: [0, 0, -1.0e-3], travel: {speed: 0, path: [[1, 1], [3, 1]], at_end: stay}}
"""


def mode(number: int) -> Any:
    """Finds a frequency across the sheet, rad/s."""
    return lambda spectrum: float(spectrum.modes.frequency[number - 1])


def rectangle(m: int, n: int) -> float:
    """Of the membrane, rad/s."""
    return float(membrane.rectangle_frequency(m, n, sides=SIDES, tension=500.0, mass=0.3))


def under_the_weight() -> float:
    """Deflection of the node under 1 mN, m."""
    found = membrane.net_deflection(
        cells=(12, 12), at=(3, 4), force=1e-3, spacing=(4.0 / 12.0, 3.0 / 12.0), tension=100.0
    )
    return float(found[3, 4])


CASES = (
    KnownCase(
        "membrane-frequencies", "Natural frequencies of a rectangular membrane", RAYLEIGH, MEMBRANE + AT_REST,
        (
            KnownNumber("first", "mode (1, 1)", "rad/s", "closed form", lambda: rectangle(1, 1), mode(1),
                "second order of 16 x 16 cells", relative=8e-3, order=1.8),
            KnownNumber("second", "mode (2, 1)", "rad/s", "closed form", lambda: rectangle(2, 1), mode(2),
                "second order of 16 x 16 cells", relative=2e-2, order=1.8),
        ),
        fault=("nets.net.mass=0.32",), answer=frequencies, coarser=("nets.net.cells=[8, 8]",),
    ),
    KnownCase(
        "net-deflection", "A small weight at a node of a taut net",
        Publication("taut strings crossing each other, a finite double sum, derived in "
               "ropewalk.theory.membrane", "elementary"),
        NET + AT_NODE + AT_REST,
        (
            KnownNumber("depth", "deflection of the node", "m", "closed form", under_the_weight,
                lambda r: -float(np.min(r.position.sel(axis="z").to_numpy()[-1])),
                "stretch by the weight, squares of slopes of 1e-5", relative=1e-4),
        ),
        fault=("nets.net.tension=101",),
    ),
)  # fmt: skip
