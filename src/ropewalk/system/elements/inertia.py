"""Axial inertia: nodes that are heavier for motion along their lines than across them, so that steps may be longer.

    M = m (1 + (f - 1) t t^T),   M^-1 = (1 - (1 - 1/f) t t^T) / m,   t: tangent of the line at rest.

The tangent stays that of rest: M is constant, so that the motion has an energy, m |v|^2 / 2 + (f - 1) m (t v)^2 / 2.
Where a line has turned by the angle a since, a link is as stiff as 1/f + sin^2 a of what it is without.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import lean_inner
from ropewalk.results.frame import RunInfo
from ropewalk.system.elements.structure import Inertia, Structure

# Part of the inertia of a line across its chord, by which it may be too large: twice that of frequencies.
MUCH = 0.05


def tangents(structure: Structure, r: Array) -> Array:
    """Unit tangents of all runs at their nodes, (axis, node)."""
    runs, out = structure.runs, np.zeros_like(r)
    for first, links in zip(runs.first, runs.links, strict=True):
        way = np.diff(r[:, first : first + links + 1], axis=1)
        way = way / np.linalg.norm(way, axis=0)
        both = np.hstack([way[:, :1], way[:, 1:] + way[:, :-1], way[:, -1:]])
        out[:, first : first + links + 1] = both / np.linalg.norm(both, axis=0)
    return out


def with_inertia(structure: Structure, rest: Array, factor: float) -> Structure:
    """The same structure with nodes that are a factor heavier along their lines, where these rest (axis, node) m."""
    along, nodes, restrained = tangents(structure, rest), structure.nodes, structure.restraints
    more = (factor - 1.0) * nodes.mass * along[:, None] * along[None]
    own = np.zeros_like(restrained.free)
    for e in range(restrained.mass.size):
        own[e] = restrained.free[e] @ more[:, :, restrained.members(e)].sum(axis=2) @ restrained.free[e]
    return structure._replace(inertia=Inertia(factor, np.where(nodes.light > 0.0, along, 0.0), own))


def stiffer(structure: Structure, r: Array, rest: Array) -> Array:
    """Part of their stiffness with which links (node,) act on what nodes are along them, at places of these in m.

    Args:
        structure: whose.
        r: (axis, node) m.
        rest: (axis, node) m, by which they are heavier.
    """
    factor, along = structure.inertia.factor, tangents(structure, rest)
    if structure.sheaves is not None:  # nodes that have passed are heavier along the line beyond
        along = np.where((structure.inertia.along != 0.0).any(axis=0), structure.inertia.along, along)
    way = np.diff(r, axis=1, append=r[:, -1:])
    way = np.divide(way, np.linalg.norm(way, axis=0), out=np.zeros_like(way), where=np.any(way != 0.0, axis=0))
    ends = [1.0 - (1.0 - 1.0 / factor) * (way * one).sum(axis=0) ** 2 for one in (along, np.roll(along, -1, axis=1))]
    return np.asarray(0.5 * (ends[0] + ends[1]))


def turn_passed(structure: Structure, ends: Integers) -> None:
    """Let nodes that have passed sheaves be heavier along the line beyond, as each was that passed before.

    Args:
        structure: whose.
        ends: (run,) last nodes of runs before.
    """
    along, runs = structure.inertia.along, structure.runs
    if structure.sheaves is None or not along.size:
        return
    for s in structure.sheaves.run.tolist():
        was, now = int(ends[s]), int(runs.first[s] + runs.links[s])
        along[:, now + 1 : was + 1] = along[:, [was + 1]]
        along[:, was + 1 : now + 1] = along[:, [was]]


def remark_inertia(run_info: RunInfo, factor: float, structure: Structure, rest: Array, line: Sequence[str]) -> None:
    """Note what an axial inertia slows down, and doubt it on lines that swing along themselves in part.

    Args:
        run_info: takes it.
        factor: by which they are heavier.
        structure: whose runs they are.
        rest: (axis, node) m.
        line: (run,) whose run each is.
    """
    run_info.warnings.append(
        f"run.axial_inertia of {factor:g} slows longitudinal waves by a factor of {factor**0.5:.3g}: tensions "
        "spread later"
    )
    for bodies, found in (("saddles", structure.saddles), ("sheaves", structure.sheaves)):
        if found is not None:
            run_info.warnings.append(f"run.axial_inertia multiplies masses that slide over {bodies} by {factor:g}")
    runs, along = structure.runs, tangents(structure, rest)
    for name in dict.fromkeys(line):
        own = [s for s, other in enumerate(line) if other == name]
        nodes = [np.arange(runs.first[s], runs.first[s] + runs.links[s] + 1) for s in own]
        parts = nodes if structure.sheaves is not None else [np.concatenate(nodes)]  # chords end at sheaves
        if (more := (factor - 1.0) * _across(rest, along, parts)) > MUCH:
            run_info.doubt(
                f"{name} has so much sag that its transverse motion has {100.0 * more:.2g} % more inertia",
                "transverse motion of a sagging line has a longitudinal part", "run.axial_inertia", "leave it out",
            )  # fmt: skip


def _across(rest: Array, along: Array, parts: Sequence[Integers]) -> float:
    """Mean square of what tangents of nodes have across the chord of their part of a line.

    Args:
        rest: (axis, node) m.
        along: (axis, node) tangents.
        parts: nodes of each.
    """
    total = 0.0
    for nodes in parts:
        chord = rest[:, nodes[-1]] - rest[:, nodes[0]]
        total += nodes.size - float((((chord / np.linalg.norm(chord)) @ along[:, nodes]) ** 2).sum())
    return total / sum(nodes.size for nodes in parts)


@lean_inner
def kick_along(structure, buffers, state, h):
    """Kick all nodes that no restraint moves, along their lines less; returns what drag takes, J."""
    nodes, t, v, f, lost = structure.nodes, structure.inertia.along, state.v, structure.inertia.factor, 0.0
    for i in range(v.shape[1]):
        light, x = h * nodes.light[i], 0.5 * h * nodes.drag[i]
        if light == 0.0:
            continue
        F = before = after = square = 0.0
        for a in range(v.shape[0]):
            F += t[a, i] * buffers.force[a, i]
            before += t[a, i] * v[a, i]
        along = ((1.0 - x / f) * before + light / f * F) / (1.0 + x / f)
        for a in range(v.shape[0]):
            after += t[a, i] * ((1.0 - x) * v[a, i] + light * buffers.force[a, i]) / (1.0 + x)
        for a in range(v.shape[0]):
            new = ((1.0 - x) * v[a, i] + light * buffers.force[a, i]) / (1.0 + x) + (along - after) * t[a, i]
            square += (0.5 * (new + v[a, i])) ** 2
            v[a, i] = new
        lost += nodes.drag[i] * nodes.mass[i] * square
    return h * lost


@lean_inner
def hold_back(structure, v, before):
    """Let nodes, whose velocities have changed to v as if they were not heavier along their lines, be so."""
    t, part = structure.inertia.along, 1.0 - 1.0 / structure.inertia.factor
    for i in range(t.shape[1]):
        gained = 0.0
        for a in range(t.shape[0]):
            gained += t[a, i] * (v[a, i] - before[a, i])
        for a in range(t.shape[0]):
            v[a, i] -= part * gained * t[a, i]
