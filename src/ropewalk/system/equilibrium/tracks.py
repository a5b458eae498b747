"""Tracks: sleepers, and the ballast below them, as masses between ties that act across the rail.

Under each sleeper stand one above the other

    rail - pad - sleeper - ballast - mass of ballast - subgrade - ground,   and on bridges   sleeper - ballast - bridge,

where the mass of the ballast moves with the bridge. Ties have no elongation in the levelled track, whose rail lies as
it is drawn, and each of them bears the weight above it: preloads, and the lengths of those above bridges, which bend.
Sideways, in space, ties are as stiff as upright; along the rail they bear nothing.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from ropewalk.mechanics.assembly import components
from ropewalk.mechanics.chain import Array
from ropewalk.model.line import Line
from ropewalk.model.scenario import Scenario
from ropewalk.model.support import Fixed
from ropewalk.model.track import Ballast, Pads, Subgrade, Track
from ropewalk.system.assembling.assembled import Assembled, Attached
from ropewalk.system.elements.structure import Nodes, Restraints, Structure
from ropewalk.system.elements.ties import MassNode, Point, Tie, ties_of
from ropewalk.system.equilibrium.rest import at_rest, settle

# Rounds in which lengths of ties above bridges are found, and by how much of the structure they still change.
_ROUNDS, _NEAR = 20, 1e-12


class _Mass(NamedTuple):
    """A mass between ties."""

    mass: float  # kg
    place: Array  # (axis,) m


class _Row(NamedTuple):
    """What a track adds to a structure."""

    masses: list[_Mass]
    on_bridges: list[tuple[Point, float]]  # kg
    ties: list[Tie]
    of: list[int]  # of each tie: 0: none of these; 1: above a bridge; 2: on the ground


def on_ends(scenario: Scenario) -> Scenario:
    """The same with rails that their ends hold as long as sleepers do not."""
    fixed = {"start_support": Fixed(), "end_support": Fixed()}
    rails = {track.rail: scenario.lines[track.rail].model_copy(update=fixed) for track in scenario.tracks.values()}
    return scenario.model_copy(update={"lines": {**scenario.lines, **rails}})


def with_tracks(scenario: Scenario, assembled: Assembled) -> Assembled:
    """The structure of a scenario with the sleepers of its tracks, if there are any.

    Args:
        scenario: what is there.
        assembled: its lines.

    Raises:
        EquilibriumError: it has no rest.
    """
    if not scenario.tracks:
        return assembled
    structure, near = assembled.structure, assembled.near.copy()
    names = {name for track in scenario.tracks.values() for name in (track.rail, *track.over)}
    for s, (first, links) in enumerate(zip(structure.runs.first, structure.runs.links, strict=True)):
        if assembled.line[s] in names:  # they rest about as they are drawn
            part, line = slice(first, first + links + 1), scenario.lines[assembled.line[s]]
            near[:, part] = _drawn(line, assembled, assembled.station[part] / _length(assembled, assembled.line[s]))
    n, rows = near.shape[1], list[_Row]()
    for track in scenario.tracks.values():
        rows.append(_row_of(scenario, track, assembled, n + sum(len(row.masses) for row in rows)))
    masses = [mass for row in rows for mass in row.masses]
    ties, of = [tie for row in rows for tie in row.ties], np.array([kind for row in rows for kind in row.of])
    near = np.hstack([near, np.array([mass.place for mass in masses]).T])
    gravity = np.zeros(len(assembled.axes))
    gravity[-1] = -scenario.gravity
    borne = [one for row in rows for one in row.on_bridges]
    nodes = _nodes(structure.nodes, structure.restraints, np.array([mass.mass for mass in masses]), borne, gravity)
    structure = structure._replace(nodes=nodes, ties=ties_of(ties, len(assembled.axes)))
    own = np.repeat(np.arange(len(rows)), [len(row.ties) for row in rows])
    grounded = [i for i in range(len(rows)) if (of[own == i] == 2).any()]
    pairs = zip(own.tolist(), of.tolist(), strict=True)
    holds = np.array([grounded.index(i) if kind == 2 else -1 for i, kind in pairs], dtype=np.int64)
    supports = tuple(f"{name}.subgrade" for i, name in enumerate(scenario.tracks) if i in grounded)
    attached = Attached((), (), supports, holds, (), (), sparse.csr_matrix((0, near.shape[1])))
    station = np.concatenate([assembled.station, np.full(len(masses), np.nan)])
    if scenario.gravity and (of == 1).any():
        near = _levelled(structure, near, n, of == 1, gravity, within=scenario.is_plane)
    return replace(assembled, structure=structure, near=near, station=station, attached=attached)


def _length(assembled: Assembled, line: str) -> float:
    """Unstrained length of a line, m."""
    runs = assembled.structure.runs
    own = [s for s, name in enumerate(assembled.line) if name == line]
    return float((runs.h[own] * runs.links[own]).sum())


def _drawn(line: Line, assembled: Assembled, part: Array) -> Array:
    """Places at parts of the way from the start of a line to its end, (axis, place) m."""
    start, end = (components(point, assembled.axes)[:, None] for point in (line.start, line.end))
    return np.asarray(start + (end - start) * part)


def _point(scenario: Scenario, assembled: Assembled, name: str, at: float) -> Point:
    """A point of a line at an unstrained length from its start, m."""
    runs, line = assembled.structure.runs, scenario.lines[name]
    own = [s for s, other in enumerate(assembled.line) if other == name]
    begin = assembled.structure.lines.begin[own]
    s = own[max(int(np.searchsorted(begin, at, side="right")) - 1, 0)]
    links, h = int(runs.links[s]), float(runs.h[s])
    along = min(max((at - float(assembled.structure.lines.begin[s])) / h, 0.0), float(links))
    pull = (line.axial_stiffness or 0.0) * (line.distance / line.length - 1.0) if line.length else line.tension
    return Point(int(runs.first[s]), links, h, along, max(pull or 0.0, 0.0), float(runs.bending[s]))


def _row_of(scenario: Scenario, track: Track, assembled: Assembled, first: int) -> _Row:
    """Sleepers of a track, their masses from node `first` on, with what is above and below them."""
    row, rail, axes = _Row([], [], [], []), scenario.lines[track.rail], len(assembled.axes)
    length, g = _length(assembled, track.rail), scenario.gravity
    places = track.places(length)
    bound = np.concatenate([[0.0], 0.5 * np.add(places[:-1], places[1:]), [length]])
    place = _drawn(rail, assembled, np.array(places) / length).T

    def add(mass: float, i: int) -> MassNode:
        row.masses.append(_Mass(mass, place[i]))
        return MassNode(first + len(row.masses) - 1)

    def join(low: MassNode | Point, high: MassNode | Point | Array, what: Pads | Ballast | Subgrade, pull: float,
             apart: Array, kind: int) -> None:  # fmt: skip
        for a in range(1, axes):
            way, preload = np.eye(axes)[a], pull if a == axes - 1 else 0.0
            k, c = (what.stiffness, what.stiffness), (what.damping, what.damping)
            row.ties.append(Tie(low, high, float(apart[a]), k, c, preload, way))
            row.of.append(kind)

    for i, at in enumerate(places):
        above = g * rail.mass * float(bound[i + 1] - bound[i])  # N
        sleeper, none = add(track.sleepers.mass, i), np.zeros(axes)
        join(sleeper, _point(scenario, assembled, track.rail, at), track.pads, -above, none, 0)
        above += g * track.sleepers.mass
        spot = track.under(rail, at, length, scenario.lines)
        if spot is not None:
            ballast, bridge = track.on_bridge or track.ballast, scenario.lines[spot.line]
            below = _point(scenario, assembled, spot.line, spot.part * _length(assembled, spot.line))
            apart = place[i] - _drawn(bridge, assembled, np.array([spot.part]))[:, 0]
            join(below, sleeper, ballast, -above, apart, 1)
            row.on_bridges.append((below, ballast.mass))
            continue
        base = add(track.ballast.mass, i)
        join(base, sleeper, track.ballast, -above, none, 0)
        join(base, place[i], track.subgrade, above + g * track.ballast.mass, none, 2)
    return row


def _nodes(
    nodes: Nodes, restraints: Restraints, more: Array, borne: Iterable[tuple[Point, float]], gravity: Array
) -> Nodes:
    """Nodes with what stands on bridges, which those beside it bear as levers do, and with masses between ties."""
    added = np.zeros(nodes.mass.size)
    for point, load in borne:
        i = min(int(point.at), point.links - 1)
        added[point.first + i] += (1.0 - point.at + i) * load
        added[point.first + i + 1] += (point.at - i) * load
    together = added.copy()  # with all that a restraint keeps together
    for e in range(restraints.mass.size):
        together[restraints.members(e)] = added[restraints.members(e)].sum()
    mass = np.concatenate([nodes.mass + added, more])
    light = nodes.light / (1.0 + nodes.light * added)
    mobile = nodes.mobile / (1.0 + nodes.mobile * together)
    force = np.hstack([nodes.force + gravity[:, None] * added, gravity[:, None] * more])
    drag = nodes.drag * nodes.mass / np.maximum(nodes.mass + added, 1e-300)  # of lines alone
    none = np.zeros(more.size)
    return Nodes(
        mass, np.concatenate([light, 1.0 / more]), np.concatenate([mobile, 1.0 / more]), force,
        np.concatenate([drag, none]), np.concatenate([nodes.level, none]),
    )  # fmt: skip


def _levelled(
    structure: Structure, near: Array, first: int, above: NDArray[np.bool_], gravity: Array, *, within: bool
) -> Array:
    """Let ties above bridges be as long as they are when these have bent, and sleepers are where they are drawn.

    Args:
        structure: whose ties change.
        near: (axis, node) m, as drawn.
        first: of the sleepers.
        above: (tie,) whether it is one of these.
        gravity: (axis,) m/s^2.
        within: whether only what stays in the plane needs to be stable.

    Returns:
        (axis, node) m, at rest.
    """
    ties, size = structure.ties, float(np.ptp(near, axis=1).max())
    assert ties is not None
    structure, r = at_rest(structure, gravity, near, within=within)
    for _ in range(_ROUNDS):
        wanted = np.hstack([r[:, :first], near[:, first:]])
        longer = np.where(above, ties.look(wanted)[2], 0.0)
        ties.length[:] += longer
        if np.abs(longer).max() <= _NEAR * size:
            break
        r = settle(structure, r, within=within)
    return r
