"""How a motion of plain ropes begins: at rest, in a mode, or as a stored result ended."""

from __future__ import annotations

import numpy as np

from ropewalk.errors import EquilibriumError, RopewalkError
from ropewalk.mechanics.assembly import components
from ropewalk.mechanics.bodies import Bodies
from ropewalk.mechanics.chain import Array, ChainState
from ropewalk.mechanics.law import tensions
from ropewalk.model.beginning import UP
from ropewalk.model.run import Dynamic, Start
from ropewalk.model.scenario import Scenario
from ropewalk.results.stored import stored_instant
from ropewalk.solve.ends import ends_of, location_ends
from ropewalk.solve.initial_loads import place_loads
from ropewalk.solve.start import PreparedRun, start_state
from ropewalk.solve.vehicle_statics import resting_forces


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


def initial_state(setting: PreparedRun, scenario: Scenario) -> tuple[ChainState, Bodies | None]:
    """The first state of a motion, and all that has a mass."""
    run = scenario.run
    assert isinstance(run, Dynamic)
    state = start_state(setting, run.start.with_loads, resting_forces(setting.loading))
    if run.start.kind == "result":
        take_up(setting, state, run.start)
        _check_ends(setting, state)
        location_ends(setting.strands, setting.supports, state)
    elif run.start.kind == "mode":
        deflect(setting, state, run.start)
    return state, place_loads(setting, state, run.start.with_loads)


def _check_ends(setting: PreparedRun, state: ChainState) -> None:
    """Refuse to take up a motion at supports that are prescribed to stand elsewhere: the line would be torn there."""
    ends = ends_of(setting.strands, setting.supports)
    for number, node in zip(ends.number, ends.node, strict=True) if ends is not None else ():
        s, side = divmod(int(number), 2)
        restrained = setting.restrained(s, float(state.t[0]))
        stuck = np.eye(len(setting.axes)) - restrained.free[side]
        away = float(np.linalg.norm(stuck @ (state.r[:, node] - restrained.place[side])))
        if away > 1e-9 * setting.strands.h[s] * setting.strands.links[s]:
            name = f"lines: {setting.lines[s]}: {('start', 'end')[side]}_support"
            raise RopewalkError(
                f"{name} stands {away:.3g} m elsewhere in the stored result; let its place and displacement begin there"
            )


def take_up(setting: PreparedRun, state: ChainState, start: Start) -> None:
    """Put positions and velocities of a stored instant into a state at its beginning; the loads begin anew.

    Args:
        setting, state: the model and its state of rest; the state is changed.
        start: file and time (the last instant if None).

    Raises:
        RopewalkError: the file does not fit the lines, or has no such time.
    """
    position, velocity = stored_instant(start, state.X.size, state.r.shape[0])
    state.r[:], state.w[:] = position, velocity
    strands = setting.strands
    for k, b in enumerate(state.moving_load):  # a riding node begins on the link that its load stands on
        if b < 0:
            continue
        s = int(setting.loads.strand[k])
        i, j = int(strands.first[s]), int(strands.first[s] + strands.links[s])
        home = np.arange(j - i + 1) * strands.h[s]
        for values, stored in ((state.r, position), (state.w, velocity)):
            values[:, b] = [np.interp(state.X[b], home, component) for component in stored[:, i : j + 1]]
