"""Where lines over saddles are before their rest is known."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.assembly import pack
from ropewalk.mechanics.chain import Array
from ropewalk.model.joint import Sheave
from ropewalk.model.line import Line, spatial
from ropewalk.model.scenario import Scenario
from ropewalk.model.support import Fixed, Moving
from ropewalk.system.assembling.laid import Laid, lay
from ropewalk.system.equilibrium.split_lines import LineShape

_CORNERS = 181  # of the shortest way over a saddle


def laid_over_saddles(
    scenario: Scenario, lengths: Mapping[str, float], rest: Callable[[Scenario], LineShape]
) -> tuple[Laid, Array]:
    """Lines laid out without their saddles, and about where their nodes rest on them, (node, 3) m.

    Taut lines are stretched evenly along the shortest way over the saddles; others run over small sheaves at the
    crowns, at which they slip until tensions are equal, or along the shortest way where that fails.

    Args:
        scenario: what is there.
        lengths: of all lines without strain, m.
        rest: finds the shape at rest of lines over sheaves.
    """
    lines = scenario.lines
    plain = scenario.model_copy(
        update={"lines": {name: line.model_copy(update={"saddles": {}}) for name, line in lines.items()}}
    )
    ways = {name: _shortest(line) for name, line in lines.items() if line.saddles}
    known = all(line.length is not None for line in lines.values())
    if known and all(_is_taut(lines[name], way, scenario.gravity) for name, way in ways.items()):
        return _along(plain, ways, lengths)
    slipping = dict(plain.lines)
    for name, line in lines.items():
        wheels = {own: Sheave(at=saddle.at) for own, saddle in line.saddles.items()}
        slipping[name] = slipping[name].model_copy(update={"sheaves": {**line.sheaves, **wheels}})
    try:
        over = rest(plain.model_copy(update={"lines": slipping}))
    except EquilibriumError:
        if not known:
            raise
        return _along(plain, ways, lengths)
    laid = lay(plain, lengths, over={at: place for at, place in over.over.items() if at[1] in lines[at[0]].sheaves})
    out = over.on(laid)
    for own in laid.strands:
        for saddle in lines[own.name].saddles.values() if own.name in lines else ():
            centre = np.array(spatial(saddle.at)) - [0.0, 0.0, saddle.radius]
            away = out[own.node] - centre
            far = np.maximum(saddle.radius / np.linalg.norm(away, axis=1), 1.0)
            out[own.node] = centre + away * far[:, None]
    return laid, out


def _lengths(places: Array) -> Array:
    """Lengths from the first of some places to each of them, m."""
    return np.append(0.0, np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1)))


def _is_taut(line: Line, way: Array, gravity: float) -> bool:
    """Whether a line of known length that is stretched evenly along a way bears more than its weight."""
    assert line.length is not None
    strain = np.array([max(_lengths(way)[-1] / line.length - 1.0, 0.0)])
    tension = float(law.tensions(pack(line.law, line.axial_stiffness), strain)[0])
    return tension > max(line.mass * gravity * line.length, 0.0) and all(
        isinstance(end, Fixed | Moving) for _, end in line.ends()
    )


def _along(scenario: Scenario, ways: Mapping[str, Array], lengths: Mapping[str, float]) -> tuple[Laid, Array]:
    """Lines laid out, some of them stretched evenly along ways, (corner, 3) m."""
    laid = lay(scenario, lengths)
    out = laid.place.copy()
    for strand in laid.strands:
        if (way := ways.get(strand.name)) is not None:
            at, upto = strand.station / strand.station[-1], _lengths(way)
            out[strand.node] = np.stack([np.interp(at * upto[-1], upto, own) for own in way.T], axis=1)
    return laid, out


def _shortest(line: Line) -> Array:
    """Corners of the shortest way from the start of a line over its saddles to its end, (corner, 3) m."""
    start, end = np.array(spatial(line.start)), np.array(spatial(line.end))
    turn = np.linspace(0.0, np.pi, _CORNERS)
    along = (end - start) * [1.0, 1.0, 0.0]
    along = along / max(float(np.linalg.norm(along)), 1e-300)
    places = [start[None], end[None]]
    for saddle in line.saddles.values():
        centre = np.array(spatial(saddle.at)) - [0.0, 0.0, saddle.radius]
        places.append(
            centre + saddle.radius * (np.outer(-np.cos(turn), along) + np.outer(np.sin(turn), [0.0, 0.0, 1.0]))
        )
    every = np.concatenate(places)
    way = (every - start) @ along
    inside = np.flatnonzero((way >= 0.0) & (way <= way[1]))
    upper: list[int] = []
    for i in inside[np.lexsort((every[inside, 2], way[inside]))].tolist():  # the upper hull, corner by corner
        while len(upper) > 1 and _is_below(way, every[:, 2], upper[-2], upper[-1], i):
            upper.pop()
        upper.append(i)
    return np.asarray(every[upper])


def _is_below(x: Array, z: Array, i: int, j: int, k: int) -> bool:
    """Whether corner j is not above the way from i to k."""
    return bool((z[j] - z[i]) * (x[k] - x[i]) <= (z[k] - z[i]) * (x[j] - x[i]))
