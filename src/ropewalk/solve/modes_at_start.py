"""Modes at the start: lines deflected in a mode of a string, at rest or whirling."""

from __future__ import annotations

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.assembly import components
from ropewalk.mechanics.chain import Array, ChainState
from ropewalk.mechanics.law import tensions
from ropewalk.model.beginning import UP
from ropewalk.model.run import Start
from ropewalk.solve.start import PreparedRun


def deflect(setting: PreparedRun, state: ChainState, start: Start) -> None:
    """Put lines at rest into a mode: `A sin(n pi xi / L)` across the line through the supports.

    Args:
        setting, state: the model and its state of rest; the state is changed.
        start: the mode; all lines have it, or the one that it names.
    """
    assert start.amplitude is not None
    for s, name in enumerate(setting.lines):
        if start.line not in (None, name):
            continue
        first, last = int(setting.strands.first[s]), int(setting.strands.first[s] + setting.strands.links[s])
        own = slice(first, last + 1)
        r, X, rest = state.r[:, own], state.X[own], np.diff(state.X[own])
        distance = float(np.linalg.norm(r[:, -1] - r[:, 0]))
        chord = (r[:, -1] - r[:, 0]) / distance
        direction = components(start.direction or UP, setting.axes)
        direction = direction - (direction @ chord) * chord
        direction /= np.linalg.norm(direction)
        deflection = start.amplitude * np.sin((start.number or 1) * np.pi * X / X[-1])
        deflection[[0, -1]] = 0.0
        before = _pulls(setting.strands.law[s], r, rest)
        try:
            r[:] = _evenly_stretched(r, direction[:, None] * deflection, chord)
        except ValueError as error:
            raise EquilibriumError(f"line {name}: {error}") from None
        pulls = _pulls(setting.strands.law[s], r, rest)
        if (pulls * np.diff(r, axis=1)).sum(axis=0).min() < 0.0:
            wrong, remedy = "deflected so far it would be pushed together", "write a smaller amplitude, or tighten it"
            raise EquilibriumError(f"line {name}: {wrong}; {remedy}")
        if start.whirl:
            change = np.diff(pulls - before, axis=1)
            inertia = setting.strands.rho[s] * setting.strands.h[s] * float((deflection**2).sum())
            square = -float((direction @ change) @ deflection[1:-1]) / inertia
            if not square > 0.0:
                wrong, remedy = "no tension holds it on a circle", "write more tension, or leave whirl out"
                raise EquilibriumError(f"line {name}: {wrong}; {remedy}")
            state.w[:, own] += np.sqrt(square) * np.cross(chord, direction)[:, None] * deflection


def _evenly_stretched(r: Array, across: Array, chord: Array) -> Array:
    """Deflect nodes and let them move along the chord so that all links get longer by the same part.

    Args:
        r: (axis, node) m, at rest.
        across: (axis, node) m, deflections across the chord, 0 at both ends.
        chord: (axis,) unit vector from end to end.
    """
    links = np.diff(r, axis=1)
    length, sideways = np.sqrt((links**2).sum(axis=0)), links - np.outer(chord, chord @ links) + np.diff(across, axis=1)
    needed = (sideways**2).sum(axis=0)
    distance = float(chord @ (r[:, -1] - r[:, 0]))

    def along(stretch: float) -> Array:
        return np.asarray(np.sqrt(np.maximum((stretch * length) ** 2 - needed, 0.0)))

    least = float(np.sqrt(needed / length**2).max())
    if (chord @ links).min() <= 0.0 or along(least).sum() > distance:
        raise ValueError("it hangs too steep for a mode of a string; tighten it, or make the amplitude smaller")
    from scipy.optimize import brentq  # lazy: few runs begin in a mode

    stretch = brentq(lambda x: along(x).sum() - distance, least, least + 2.0, xtol=1e-16, rtol=1e-15)
    moved = r + across
    moved[:, 1:-1] += np.outer(chord, np.cumsum(along(stretch) - chord @ links)[:-1])
    return moved


def _pulls(law: Array, r: Array, rest: Array) -> Array:
    """Force vectors (axis, link) of links of given unstrained lengths, N."""
    links = np.diff(r, axis=1)
    length = np.sqrt((links**2).sum(axis=0))
    return np.asarray(tensions(law, length / rest - 1.0) * links / length)
