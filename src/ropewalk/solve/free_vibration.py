"""Small free motions of any structure about rest, from its stiffness, its lumped masses and its damping."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.sparse import diags
from scipy.sparse.linalg import eigsh

from ropewalk.mechanics.chain import Array
from ropewalk.solve.spectrum import LOWEST, Modes, Spectrum, unit
from ropewalk.solve.symmetric import modes

_DENSE = 400  # unknowns up to which the highest frequency is found with all others


def free_vibration(
    name: str, K: Any, mass: Array, damping: Any = None, how_many: int | None = None
) -> tuple[Spectrum, Array]:
    """Natural frequencies and damping ratios of K x + C x' + M x'' = 0, the lowest ones and the highest frequency.

    A ratio is x^T C x / (2 w) with the undamped shape x, x^T M x = 1: exact where damping does not couple the modes,
    and right to first order where it is small.

    Args:
        name: of the structure.
        K: (unknown, unknown) N/m, symmetric, sparse.
        mass: (unknown,) kg, positive.
        damping: C (unknown, unknown) N s/m; None: there is none.
        how_many: of the lowest modes.

    Returns:
        The spectrum, and the shapes of its lowest modes (unknown, mode).
    """
    count = K.shape[0]
    found, shapes = modes(K, mass, min(how_many or LOWEST, count))
    root = diags(1.0 / np.sqrt(mass))
    scaled = root @ K @ root
    if count <= _DENSE:
        top = float(np.linalg.eigvalsh(scaled.toarray())[-1])
    else:
        top = float(eigsh(scaled, k=1, which="LA", return_eigenvectors=False)[0])
    highest = float(np.sqrt(max(top, 0.0)))
    loss = np.zeros(found.size) if damping is None else (shapes * (damping @ shapes)).sum(axis=0)
    ratio = np.divide(loss, 2.0 * found, out=np.zeros_like(loss), where=found > 0.0)
    moving, growing = found > 0.0, found[found < 0.0]
    w, zeta = found[moving], ratio[moving]
    rate, swing = w * zeta, w * np.sqrt(np.maximum(1.0 - zeta**2, 0.0))
    spread = w * np.sqrt(np.maximum(zeta**2 - 1.0, 0.0))  # beyond oscillation: two real eigenvalues
    pairs = [-rate + spread + 1j * swing, -rate - spread - 1j * swing]
    values = np.concatenate([*pairs, -growing, growing, [1j * highest, -1j * highest]])
    sizes = np.abs(values)[np.abs(values) > 0.0]
    damped = damping is not None and bool(loss.any())
    found_here = Spectrum(
        name=name, unknowns=2 * count, lowest_frequency=float(w.min(initial=np.inf)) if w.size else 0.0,
        highest_frequency=highest, slowest_damping_ratio=float(zeta[:1].sum()),
        fastest_damping_ratio=float(zeta[-1:].sum()), largest_damping_ratio=float(zeta.max(initial=0.0)),
        smallest_eigenvalue=float(sizes.min(initial=np.inf)) if sizes.size else 0.0, largest_eigenvalue=highest,
        imaginary=not damped, real_branches=bool((zeta >= 1.0).any()), unstable=int(growing.size),
        growth_rate=float(-growing.min(initial=0.0)), neutral=int((found == 0.0).sum()), damping_rate=0.0,
        eigenvalues=values[np.argsort(np.abs(values))], complete=False,
        method="lowest natural frequencies and the highest",
        modes=Modes(w, zeta),
    )  # fmt: skip
    return found_here, shapes[:, moving]


def shaped(found: Spectrum, moved: Array, position: Array, line: tuple[str, ...]) -> Modes:
    """The modes of a spectrum with their shapes, of which the largest displacement is 1.

    Args:
        found: with the frequencies of its modes.
        moved: (mode, node, 3) displacements.
        position: (node, 3) m, at rest.
        line: (node,) names of what the nodes belong to.
    """
    assert found.modes is not None
    return replace(found.modes, shape=unit(moved), position=position, line=line)
