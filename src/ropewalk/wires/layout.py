"""Names and coordinates of the results of wires."""

from __future__ import annotations

import numpy as np

from ropewalk.results.frame import Layout, uniform
from ropewalk.wires.mesh import Mesh
from ropewalk.wires.plan import Array, Integers, Spot, WirePlan
from ropewalk.wires.rest import rows, without_supports
from ropewalk.wires.task import WireTask


def axes_of(task: WireTask) -> list[int]:
    """The axes that results have, as numbers of x, y and z."""
    return [0, 1, 2] if task.space else [0, 2]


def supports_of(plan: WirePlan) -> tuple[tuple[str, ...], Integers]:
    """Names of all that holds wires, ends first, and which of them each hold is."""
    ends = [f"{wire.name}.{end}" for wire in plan.wires for end in ("start", "end")]
    arms = (plan.ties[i].name for i in _arms(plan))
    names = tuple(dict.fromkeys([*ends, *(hold.name for hold in plan.holds), *arms]))
    number = {name: i for i, name in enumerate(names)}
    return names, np.array([number[hold.name] for hold in plan.holds], dtype=np.int64)


def _arms(plan: WirePlan) -> list[int]:
    """Ties to the ground."""
    return [i for i, tie in enumerate(plan.ties) if not isinstance(tie.other, Spot)]


class Reactions:
    """Forces of all that holds wires on them.

    A mass at the end of a wire is part of the support there: what accelerates and carries it is no reaction.
    """

    def __init__(self, mesh: Mesh) -> None:
        names, self._which = supports_of(mesh.plan)
        self.ends: Integers = np.stack([mesh.strands.first, mesh.strands.first + mesh.strands.links], axis=1).ravel()
        mass = mesh.mass[self.ends] - mesh.own[self.ends]
        self._weight = np.zeros((self.ends.size, 3))
        self._weight[:, 2] = -mesh.plan.gravity * mass
        self._share = (mass / mesh.mass[self.ends])[:, None]  # of the mass of an end that is its support's
        self._supports, self._fixed = len(names), mesh.fixed[:, self.ends].T
        self._arms = _arms(mesh.plan)
        self._own = [names.index(mesh.plan.ties[i].name) for i in self._arms]
        self._low, self._ground = rows(mesh.ties.one, mesh.nodes)[self._arms], mesh.ties.ground[self._arms]

    def of(self, bare: Array, hold: Array, tie: Array, position: Array) -> Array:
        """Find them, (..., support, 3) N.

        Args:
            bare: (..., end, 3) N on the ends of wires but for what holds do.
            hold: (..., hold, 3) N.
            tie: (..., tie) N; those to the ground hold wires, too.
            position: (..., 3, node) m.
        """
        out, ends = np.zeros((*position.shape[:-2], self._supports, 3)), self.ends.size
        np.add.at(out.swapaxes(0, -2), self._which, np.asarray(hold).swapaxes(0, -2))
        if self._arms:
            low = (self._low @ position.reshape(-1, position.shape[-1]).T).T.reshape(*position.shape[:-1], -1)
            way = np.ascontiguousarray(self._ground - low.swapaxes(-1, -2))
            pull = tie[..., self._arms, None] * way / np.linalg.norm(way, axis=-1)[..., None]
            out[..., self._own, :] += pull
        restrained = out[..., :ends, :]
        inertia = self._share * (bare + restrained)
        out[..., :ends, :] = np.where(self._fixed, self._weight - bare, restrained + self._weight - inertia)
        return out


def layout_of(
    task: WireTask, mesh: Mesh, *, path: str = "time", external: tuple[str, ...] = (), sample: tuple[float, ...] = ()
) -> Layout:
    """The layout of a result.

    Args:
        path: its leading dimension.
        external: loads that are external models.
        sample: s, of samples, from an output instant back.
    """
    plan, strands = task.plan, mesh.strands
    # Beds carry some of the weight: how much is unknown.
    bedded = any(wire.bed for wire in plan.wires)
    return Layout(
        axes=tuple("xyz"[a] for a in axes_of(task)), contact_load=task.contacts,
        **uniform([wire.name for wire in plan.wires], strands.links, strands.h),
        support=supports_of(plan)[0], body=tuple(body.name for body in task.displayed),
        tie=tuple(tie.name for tie in plan.ties), tie_station=tuple(tie.spot.station for tie in plan.ties),
        external=external, watched=tuple(plan.watched),
        watched_station=tuple(spot.station for spot in plan.watched.values()), sample=sample, path=path,
        weight=float("nan") if bedded else float(plan.gravity * without_supports(mesh).sum()),
    )  # fmt: skip


def axial_force(mesh: Mesh, stretched: Array, r: Array) -> Array:
    """Force along the tangent in all links, N: what stretches them, and EI kappa^2.

    The bending energy is that of r'', whose force turns with the line: EA times the strain is the force along the
    tangent but for that part, on a line that hardly stretches -EI r' . d3r/ds3 = EI |r''|^2.

    Args:
        mesh: of the wires.
        stretched: (..., link) N, EA times the strain.
        r: (..., axis, node) m.
    """
    strands, parts = mesh.strands, []
    for a, (stiffness, h, clamped) in enumerate(zip(strands.stiffness, strands.h, strands.clamped, strict=True)):
        square = (np.diff(r[..., mesh.of(a)], 2, axis=-1) ** 2).sum(axis=-2) / h**4
        last = square.shape[-1] - 1
        beside = ((0, min(1, last)), (last, max(last - 1, 0)))
        begin, end = (
            side * np.maximum(2.0 * square[..., i] - square[..., j], 0.0)  # a hinge does not bend
            for side, (i, j) in zip(clamped, beside, strict=True)
        )
        square = np.concatenate([begin[..., None], square, end[..., None]], axis=-1)
        parts.append(0.5 * stiffness * (square[..., 1:] + square[..., :-1]))
    return np.asarray(stretched + np.concatenate(parts, axis=-1))
