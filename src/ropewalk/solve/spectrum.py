"""The spectrum of a line at an instant: what decides method and step ("Walking the Line", eq. 12).

J is the Jacobian of the first-order system of all positions and velocities of the inner nodes, 2 dim (n - 1) unknowns
for a line of n links. Undamped, its eigenvalues are imaginary however stiff the line is: "oscillatory-stiff".
Kelvin-Voigt damping that is strong for the mesh gives real negative ones: "dissipatively stiff". See linearised.py for
what is linearised, eigenvalues.py for how.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.sparse import diags

from ropewalk.mechanics.chain import Array, ChainState, Strands
from ropewalk.results.spectrum import Modes, Spectrum
from ropewalk.solve.eigenvalues import Eigenvalues, by_size, ends, every
from ropewalk.solve.linearised import Linearised, linearise
from ropewalk.solve.symmetric import modes

LOWEST = 20  # modes whose shapes are kept where no number is asked for
# A line with no more unknowns than this is treated densely: a second or two at most.
DENSE = 1500
# How many modes at each end are computed of a larger one.
HOW_MANY = 6


def spectrum(
    strands: Strands,
    at: ChainState | tuple[Array, Array],
    *,
    how_many: int | None = None,
    names: Sequence[str] = (),
) -> Spectrum:
    """Find the spectrum of all lines at an instant.

    Args:
        strands: the lines.
        at: a state, or positions (axis, node) in m and material coordinates (node,) in m.
        how_many: eigenvalues of this many modes at each end, by iteration; by default all of a line with up to
            1500 unknowns, and 6 of a larger one.
        names: names of the lines.

    Raises:
        RopewalkError: positions are not finite, or a link has no length.
        ValueError: `how_many` is below 1.
    """
    if how_many is not None and how_many < 1:
        raise ValueError(f"how_many must be at least 1, not {how_many}")
    r, X = (at.r, at.X) if isinstance(at, ChainState) else at
    each = []
    for s, first in enumerate(strands.first):
        place = r[:, first : first + strands.links[s] + 1].T
        each.append(_of_line(linearise(strands, s, r, X), names[s] if names else f"{s}", how_many, place))
    return each[0] if len(each) == 1 else _together(each)


def in_space(r: Array) -> Array:
    """Positions (axis, node) with all three axes: what moves in a plane can leave it in small motions."""
    return r if r.shape[0] == 3 else np.stack([r[0], np.zeros_like(r[0]), r[1]])


def _lowest_modes(line: Linearised, name: str, how_many: int | None, place: Array) -> Modes | None:
    """The lowest modes of a line in space that are at rest stable; None in the plane."""
    dim = place.shape[1]
    if dim != 3 or not line.size:
        return None
    K, C = (_sparse(band) for band in line.bands)
    w, shapes = modes(K, np.ones(line.size), min(how_many or LOWEST, line.size))
    moving = w > 0.0
    w, shapes = w[moving], shapes[:, moving]
    loss = (shapes * (C @ shapes)).sum(axis=0) + line.drag * (shapes**2).sum(axis=0)
    moved = np.zeros((w.size, place.shape[0], 3))
    moved[:, 1:-1] = shapes.T.reshape(w.size, place.shape[0] - 2, 3)
    return Modes(w, loss / (2.0 * w), unit(moved), place, (name,) * place.shape[0])


def unit(moved: Array) -> Array:
    """Shapes (mode, node, 3) scaled so that the largest displacement is 1."""
    size = np.linalg.norm(moved, axis=2).max(axis=1, initial=0.0)
    return np.asarray(moved / np.where(size > 0.0, size, 1.0)[:, None, None])


def _sparse(band: Array) -> Any:
    """A symmetric matrix from its lower band (row, offset)."""
    n, offsets = band.shape[0], range(min(band.shape[1], band.shape[0]))
    lower = diags([band[: n - k, k] for k in offsets], [-k for k in offsets])
    return (lower + lower.T - diags(band[:, 0])).tocsr()


def _of_line(line: Linearised, name: str, how_many: int | None, place: Array) -> Spectrum:
    small = 2 * line.size <= DENSE if how_many is None else line.size <= 2 * how_many + 2
    found: Eigenvalues = every(line) if small else ends(line, how_many or HOW_MANY)
    sizes = np.abs(found.values)
    sizes = sizes[sizes > 0.0]
    first, last = found.frequency[:1], found.frequency[-1:]
    largest_ratio = float(found.ratio.max(initial=0.0))
    return Spectrum(
        name=name,
        unknowns=2 * line.size,
        lowest_frequency=float(first.sum()),
        highest_frequency=float(last.sum()),
        slowest_damping_ratio=float(found.ratio[:1].sum()),
        fastest_damping_ratio=float(found.ratio[-1:].sum()),
        largest_damping_ratio=largest_ratio,
        smallest_eigenvalue=float(sizes.min(initial=math.inf)) if sizes.size else 0.0,
        largest_eigenvalue=float(sizes.max(initial=0.0)),
        imaginary=not line.is_damped and line.drag == 0.0,
        real_branches=largest_ratio >= 1.0,
        unstable=line.below(-line.zero) if line.size else 0,
        growth_rate=line.growth_rate(),
        neutral=found.neutral,
        damping_rate=line.highest(of_damping=True) if line.is_damped else 0.0,
        eigenvalues=found.values,
        complete=found.complete,
        method=found.method,
        modes=_lowest_modes(line, name, how_many, place),
    )


def _together(each: list[Spectrum]) -> Spectrum:
    moving = [line for line in each if line.highest_frequency > 0.0] or each
    slowest = min(moving, key=lambda line: line.lowest_frequency)
    fastest = max(moving, key=lambda line: line.highest_frequency)
    smallest = [line.smallest_eigenvalue for line in each if line.smallest_eigenvalue > 0.0]
    return Spectrum(
        name="all lines",
        unknowns=sum(line.unknowns for line in each),
        lowest_frequency=slowest.lowest_frequency,
        highest_frequency=fastest.highest_frequency,
        slowest_damping_ratio=slowest.slowest_damping_ratio,
        fastest_damping_ratio=fastest.fastest_damping_ratio,
        largest_damping_ratio=max(line.largest_damping_ratio for line in each),
        smallest_eigenvalue=min(smallest, default=0.0),
        largest_eigenvalue=max(line.largest_eigenvalue for line in each),
        imaginary=all(line.imaginary for line in each),
        real_branches=any(line.real_branches for line in each),
        unstable=sum(line.unstable for line in each),
        growth_rate=max(line.growth_rate for line in each),
        neutral=sum(line.neutral for line in each),
        damping_rate=max(line.damping_rate for line in each),
        eigenvalues=by_size(np.concatenate([line.eigenvalues for line in each])),
        complete=all(line.complete for line in each),
        method="; ".join(dict.fromkeys(line.method for line in each)),
        lines=tuple(each),
        modes=_all_modes([line.modes for line in each if line.modes is not None]),
    )


def _all_modes(parts: list[Modes]) -> Modes | None:
    """The modes of several lines as modes of all of them, in the order of their frequencies."""
    if not parts:
        return None
    frequency, ratio = (np.concatenate([getattr(part, key) for part in parts]) for key in ("frequency", "ratio"))
    position, line = np.concatenate([part.position for part in parts]), tuple(n for part in parts for n in part.line)
    shape, mode, node = np.zeros((frequency.size, position.shape[0], 3)), 0, 0
    for part in parts:
        shape[mode : mode + part.frequency.size, node : node + len(part.line)] = part.shape
        mode, node = mode + part.frequency.size, node + len(part.line)
    order = np.argsort(frequency, kind="stable")[:LOWEST]
    return Modes(frequency[order], ratio[order], shape[order], position, line)
