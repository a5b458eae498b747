"""Form finding: what holds an overhead line at rest as it is wanted, and how long its droppers are.

The wires have constant tension, so that their heights are linear in the forces on them. The contact wire is led
through the wanted heights at droppers and supports; the forces that this takes are the pulls of the droppers, and
together with the droppers' weights they load the messenger and the stitch wires, which hang from their supports.

Along the line a stitch wire pulls at the messenger with its tension: between its clamps the messenger has so much less.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg

from ropewalk.errors import EquilibriumError
from ropewalk.wires.mesh import Mesh, Places, clamped_at, mesh_of
from ropewalk.wires.plan import Array, Hold, PointMass, Spot, WirePlan, WireTie
from ropewalk.wires.rest import moving, rest_of, restrained_shape, rows, vertical_stiffness

_MOST_ROUNDS = 50
_CLOSE = 1e-10  # m, of dropper lengths from round to round, where their weight follows from their length


@dataclass(frozen=True)
class Hanger:
    """A dropper to be: the contact wire below, a messenger or stitch wire above."""

    name: str
    low: Spot
    high: Spot
    height: float  # m, wanted for the contact wire
    aside: float  # m, of the upper from the lower end in plan view
    fails_at: float = math.inf  # s


@dataclass(frozen=True)
class Dropper:
    """What all droppers have in common."""

    stiffness: float  # N/m
    pushes: float  # N/m
    damping: float  # N s/m
    mass: float  # kg
    mass_per_length: float  # kg/m
    clamps: tuple[float, float]  # kg, on the contact wire and above
    strength: float = math.inf  # N


@dataclass(frozen=True)
class StitchEnd:
    """The last piece of a stitch wire, from its end to its clamp on the messenger."""

    name: str
    low: Spot  # on the stitch wire
    high: Spot  # on the messenger
    tension: float  # N, along x
    along: float  # m, how far the clamp is from the end along x, with its sign
    stiffness: float  # N/m


@dataclass(frozen=True)
class FormFindingTask:
    """What is wanted of an overhead line at rest."""

    plan: WirePlan  # wires, point masses, and holds that are constant forces
    element: float  # m
    hangers: tuple[Hanger, ...]
    dropper: Dropper
    links: tuple[StitchEnd, ...]
    levels: tuple[tuple[Spot, float], ...]  # points held at heights in m: the contact wire, and then the messenger
    hints: str  # what may be changed, for errors


@dataclass(frozen=True)
class Form:
    """An overhead line at rest."""

    ties: tuple[WireTie, ...]  # droppers, and then links of stitch wires
    masses: tuple[PointMass, ...]
    restraint: Array  # (level,) N upwards that it takes to hold the levels
    lengths: Array  # (hanger,) m unstrained, in space
    pull: Array  # (hanger,) N
    mesh: Mesh  # its wires
    z: Array  # (node,) m, heights of the control points of all wires

    def heights(self, spots: Sequence[Spot]) -> Array:
        """Heights of the splines at points of wires, m."""
        return np.asarray(rows(clamped_at(self.mesh.strands, spots), self.mesh.nodes) @ self.z, dtype=np.float64)


def form_by_heights(task: FormFindingTask) -> Form:
    """Find the lengths of droppers with which the contact wire has the wanted heights.

    Raises:
        EquilibriumError: a dropper would have to push, or to be shorter than nothing.
    """
    dropper, hangers = task.dropper, task.hangers
    contact = [i for i, (spot, _) in enumerate(task.levels) if spot.wire == 0]
    above = [i for i, (spot, _) in enumerate(task.levels) if spot.wire != 0]
    heights = np.array([hanger.height for hanger in hangers])
    wanted = np.array([height for _, height in task.levels])
    mesh = mesh_of(task.plan, task.element)
    low, high = (clamped_at(mesh.strands, spots) for spots in _ends(hangers))
    level = clamped_at(mesh.strands, [spot for spot, _ in task.levels])
    at_low, at_high = rows(low, mesh.nodes), rows(high, mesh.nodes)
    bare = rows(mesh.holds.at, mesh.nodes).T @ mesh.holds.force[:, 2] - task.plan.gravity * mesh.mass
    # Each wire is led through its points; what stands above is not yet loaded, and is led through its supports.
    through = _together(low, _some(level, contact + above))
    points = np.concatenate([heights, wanted[contact + above]])
    lengths = np.zeros(len(hangers))
    for _ in range(_MOST_ROUNDS):
        below, atop = _weights(task, lengths)
        load = bare - task.plan.gravity * (at_low.T @ below + at_high.T @ atop)
        z, force = _shape(mesh, task, through, points, load)
        pull = force[: len(hangers)]
        hung, lift = _shape(
            mesh, task, _some(level, above), wanted[above], load - at_high.T @ pull, slice(mesh.of(0).stop, None)
        )
        hung[mesh.of(0)] = z[mesh.of(0)]
        upright = at_high @ hung - at_low @ hung - pull * (1.0 / dropper.stiffness + low.local + high.local)
        _check(task, pull, upright)
        before, lengths = lengths, _leaning(hangers, upright)
        if np.abs(lengths - before).max(initial=0.0) <= _CLOSE or not dropper.mass_per_length:
            break
    restraint = np.zeros(len(task.levels))
    restraint[contact], restraint[above] = force[len(hangers) : len(hangers) + len(contact)], lift
    ties = _droppers(task, lengths) + _links(task, mesh, hung)
    return Form(ties, _lumps(task, lengths), restraint, lengths, pull, mesh, hung)


def form_by_lengths(task: FormFindingTask, lengths: Array) -> Form:
    """Find how the line rests with droppers of given unstrained lengths, its levels held; droppers may be slack.

    Raises:
        EquilibriumError: there is no rest.
    """
    masses, droppers, ends = _lumps(task, lengths), _droppers(task, lengths), [link.low for link in task.links]
    links: tuple[WireTie, ...] = ()
    turned = np.zeros(0)
    if task.links:  # the tension that they should have does not depend on the droppers, their length a little
        guess = form_by_heights(task)
        links, turned = guess.ties[len(task.hangers) :], guess.heights(ends)
    fast = tuple(
        Hold(f"level {i}", spot, (0.0, 0.0, np.inf), place=(0.0, 0.0, height))
        for i, (spot, height) in enumerate(task.levels)
    )
    own = slice(len(task.plan.holds), len(task.plan.holds) + len(fast))
    for _ in range(_MOST_ROUNDS):
        holds = (*task.plan.holds, *fast)
        mesh = mesh_of(replace(task.plan, masses=masses, ties=(*droppers, *links), holds=holds), task.element)
        rest, before = rest_of(mesh), turned
        links = _links(task, mesh, rest.position[2])
        pull = rest.tie_force[: len(droppers)]
        form = Form((*droppers, *links), masses, rest.hold_force[own], lengths, pull, mesh, rest.position[2])
        turned = form.heights(ends)
        if np.abs(turned - before).max(initial=0.0) <= _CLOSE:
            break
    return form


def _shape(
    mesh: Mesh, task: FormFindingTask, places: Places, heights: Array, load: Array, wires: slice = slice(None)
) -> tuple[Array, Array]:
    """Shape of wires led through heights, with links between stitch wires and messenger; and the forces it takes.

    Without such links each wire has its own; nodes of those that are asked for are `wires`.
    """
    if not task.links:
        return restrained_shape(mesh, places, heights, load, wires)
    A, stiff = _geometric(mesh, task.links)
    K = vertical_stiffness(mesh) + A.T @ sparse.diags(stiff) @ A
    C, free, chord = rows(places, mesh.nodes), moving(mesh), mesh.straight()[2]
    system = sparse.bmat([[K[free][:, free], -C[:, free].T], [C[:, free], sparse.diags(places.local)]], format="csc")
    found = scipy.sparse.linalg.spsolve(system, np.concatenate([(load - K @ chord)[free], heights - C @ chord]))
    if not np.isfinite(found).all():
        raise EquilibriumError(f"the wires of {task.plan.wires[0].name} have no equilibrium; check the stitch wires")
    z, count = chord.copy(), int(free.sum())
    z[free] += found[:count]
    return z, found[count:]


def _geometric(mesh: Mesh, links: tuple[StitchEnd, ...]) -> tuple[sparse.csr_matrix, Array]:
    """How far links' ends stand apart, (link, node), and their stiffness by their tension, N/m."""
    low, high = (clamped_at(mesh.strands, spots) for spots in _ends(links))
    stiff = np.array([link.tension / abs(link.along) for link in links])
    return rows(high, mesh.nodes) - rows(low, mesh.nodes), stiff


def _links(task: FormFindingTask, mesh: Mesh, z: Array) -> tuple[WireTie, ...]:
    """Links of such a length that they pull as they should."""
    if not task.links:
        return ()
    A, _ = _geometric(mesh, task.links)
    found = []
    for link, rise in zip(task.links, A @ z, strict=True):
        reach = float(np.hypot(link.along, rise))
        pull = link.tension * reach / abs(link.along)
        found.append(pulling(link.name, link.low, link.high, link.stiffness, reach, pull))
    return tuple(found)


def pulling(name: str, low: Spot, high: Spot, stiffness: float, reach: float, pull: float) -> WireTie:
    """A link of a stitch wire of a stiffness in N/m that is `reach` in m long where it pulls with a force in N."""
    return WireTie(name, low, high, stiffness, reach - pull / stiffness, stiffness, lengthwise=True)


def _ends(things: tuple[Hanger, ...] | tuple[StitchEnd, ...]) -> tuple[list[Spot], list[Spot]]:
    return [thing.low for thing in things], [thing.high for thing in things]


def _weights(task: FormFindingTask, lengths: Array) -> tuple[Array, Array]:
    """Masses at the ends of droppers, below and above, kg: clamps, and half of each dropper."""
    half = 0.5 * (task.dropper.mass + task.dropper.mass_per_length * lengths)
    return task.dropper.clamps[0] + half, task.dropper.clamps[1] + half


def _lumps(task: FormFindingTask, lengths: Array) -> tuple[PointMass, ...]:
    """All point masses."""
    ends = zip(_ends(task.hangers), _weights(task, lengths), strict=True)
    found = [PointMass(spot, float(m)) for spots, masses in ends for spot, m in zip(spots, masses, strict=True)]
    return (*task.plan.masses, *found)


def _droppers(task: FormFindingTask, lengths: Array) -> tuple[WireTie, ...]:
    """The droppers; one that leans by `aside` is as if it stood upright with sqrt(length^2 - aside^2)."""
    dropper, found = task.dropper, []
    for hanger, length in zip(task.hangers, lengths, strict=True):
        square = float(length) ** 2 - hanger.aside**2
        if square <= 0.0:
            raise EquilibriumError(
                f"dropper {hanger.name} of {length:.4g} m cannot lean {abs(hanger.aside):.4g} m aside; "
                "make it longer, or let the messenger keep the stagger of the contact wire"
            )
        upright = float(np.sqrt(square))
        found.append(
            WireTie(
                hanger.name, hanger.low, hanger.high, dropper.stiffness, upright, dropper.pushes, dropper.damping,
                strength=dropper.strength, fails_at=hanger.fails_at,
            )
        )  # fmt: skip
    return tuple(found)


def _leaning(hangers: tuple[Hanger, ...], upright: Array) -> Array:
    aside = np.array([hanger.aside for hanger in hangers], dtype=np.float64)
    return np.asarray(np.hypot(upright, aside), dtype=np.float64)


def _check(task: FormFindingTask, pull: Array, upright: Array) -> None:
    short, pushed = np.flatnonzero(upright <= 0.0), np.flatnonzero(pull <= 0.0)
    if short.size:
        worst = task.hangers[_first_of_the_least(upright)].name
        raise EquilibriumError(
            f"dropper {worst} would have to be {upright.min():.4g} m long ({short.size} of {upright.size} are too "
            f"short): the wire above hangs too low; {task.hints}"
        )
    if pushed.size:
        worst = task.hangers[_first_of_the_least(pull)].name
        raise EquilibriumError(
            f"dropper {worst} would have to push with {-pull.min():.4g} N in equilibrium ({pushed.size} of "
            f"{pull.size}): "
            "pre_sag is larger than the sag of the wire without this dropper; write less pre_sag, a smoother one, or "
            "leave droppers out"
        )


def _first_of_the_least(values: Array) -> int:
    return int(np.argmax(values <= values.min() + 1e-4))


def _some(places: Places, which: list[int]) -> Places:
    return Places(*(array[which] for array in places))  # type: ignore[arg-type]


def _together(one: Places, other: Places) -> Places:
    return Places(*(np.concatenate(pair) for pair in zip(one, other, strict=True)))
