"""Natural frequencies of the straight, uniformly stretched chain of links between two fixed ends.

``links`` massless elastic links of unstrained length ``h = length/links`` join nodes of mass ``mass * h``.
They are the frequencies that a spectrum of the discrete line must show; as ``links`` grows they tend to those
of the string and of the bar. Derived in docs/notes; "Walking the Line. Traveling Forces vs Moving Masses",
eq. 12.
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["AxialLaw", "longitudinal_frequencies", "transverse_frequencies"]

FloatArray = NDArray[np.float64]
AxialLaw = Literal["hooke", "second_piola_kirchhoff"]


def transverse_frequencies(
    *, links: int, length: float, axial_stiffness: float, mass: float, stretch: float, law: AxialLaw = "hooke"
) -> FloatArray:
    """Return the ``links - 1`` angular frequencies across the chain, ascending, in rad/s.

    ``length`` in m and ``mass`` in kg/m count along the unstrained chain, ``axial_stiffness`` in N,
    ``stretch`` is strained by unstrained length. ``law`` is "hooke", ``T = EA (stretch - 1)``, or
    "second_piola_kirchhoff", the paper's printed eqs. 6-7, ``T = EA stretch (stretch - 1)``. `ValueError` for
    a chain in compression, which is unstable, and for arguments out of range. All frequencies vanish at
    ``stretch`` 1.

    ``omega_j = (2/h) sqrt(T / (stretch * mass)) sin(j pi / (2 links))``, j = 1..links-1.
    """
    _require_chain(links, length, axial_stiffness, mass, stretch)
    if stretch < 1.0:
        raise ValueError(f"a chain in compression is unstable: stretch must be at least 1, not {stretch}")
    strain = stretch - 1.0
    secant = _by_law(law, strain / stretch, strain)
    return _branch(links, length) * float(np.sqrt(axial_stiffness * secant / mass))


def longitudinal_frequencies(
    *, links: int, length: float, axial_stiffness: float, mass: float, stretch: float, law: AxialLaw = "hooke"
) -> FloatArray:
    """Return the ``links - 1`` angular frequencies along the chain, ascending, in rad/s.

    Arguments as in `transverse_frequencies`; compression is allowed as long as the law still stiffens against
    it. `ValueError` where it does not (second Piola-Kirchhoff below ``stretch`` 1/2) and for arguments out of
    range.

    ``omega_j = (2/h) sqrt(T'(stretch) / mass) sin(j pi / (2 links))``, ``T' = EA`` or ``EA (2 stretch - 1)``.
    """
    _require_chain(links, length, axial_stiffness, mass, stretch)
    tangent = _by_law(law, 1.0, 2.0 * stretch - 1.0)
    if tangent < 0.0:
        raise ValueError(f"the law softens in compression: stretch must be at least 1/2, not {stretch}")
    return _branch(links, length) * float(np.sqrt(axial_stiffness * tangent / mass))


def _branch(links: int, length: float) -> FloatArray:
    j = np.arange(1, links)
    return np.asarray(2.0 * links / length * np.sin(0.5 * np.pi * j / links))


def _by_law(law: AxialLaw, hooke: float, second_piola_kirchhoff: float) -> float:
    if law == "hooke":
        return hooke
    if law == "second_piola_kirchhoff":
        return second_piola_kirchhoff
    raise ValueError(f"law must be 'hooke' or 'second_piola_kirchhoff', not {law!r}")


def _require_chain(links: int, length: float, axial_stiffness: float, mass: float, stretch: float) -> None:
    if links < 1:
        raise ValueError(f"links must be at least 1, not {links}")
    named = {"length": length, "axial_stiffness": axial_stiffness, "mass": mass, "stretch": stretch}
    for name, value in named.items():
        if not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"{name} must be finite and positive, not {value}")
