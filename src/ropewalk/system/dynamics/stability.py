"""How long a step of explicit motion may be."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.multibody_system import FIRM
from ropewalk.system.assembling.assembled import Assembled
from ropewalk.system.contact.contact_record import BODY
from ropewalk.system.contact.tables import Tables
from ropewalk.system.contact.yielding import AXIAL, stiffness_at_rest
from ropewalk.system.elements.compliance import CORRECTION, NEAR, PARTS, SHARES, SHORT, compliances
from ropewalk.system.elements.inertia import stiffer
from ropewalk.system.elements.membrane_elements import bounds_of_cells
from ropewalk.system.elements.structure import Buffers, Structure
from ropewalk.system.loads.bodies import BodyArrays

# Part of the stable step that is used. A contact of a body gives way within a step so that it needs half of the square
# of the largest frequency, and leaves the other half.
SAFETY, WITHOUT_LOADS = 0.7, 0.9
SAFETY_OF_NETS = 0.5
# The same of inextensible lines, whose tension grows, and what of it is left when it has; part of a link that a load
# goes on in a step there.
HARD, GROWN, PASSED = 0.5, 0.8, 0.2
# Largest eigenvalues of the differences of links: of the second one squared with that of its change, over 4.
_BENDING = 80.0 / 3.0
# Times that damping makes a step shorter, and steps of a run, from which on it is told.
MUCH_SHORTER, MANY = 3.0, 100_000
# Square of the angle by which lines are expected to turn from where they are heavier along than across.
_TURNED = 0.15**2
# Stiffness of a link that sticks at a sheave near one of its ends, over its own: that of a fortieth of it is stable.
_STUCK = 15.0
_SHARED = 0.7  # sum of the squares of the parts of nodes in the point of a contact, at most
_ARCS = 1.0 + CORRECTION / 3.0 + 2.0 * SHORT / 3.0


def largest_step(structure: Structure, contacts: Any, bodies: BodyArrays, r: Array, rest: Array | None = None) -> float:
    """The step that is used at most, s: 2/omega (sqrt(1 + zeta^2) - zeta) with bounds of frequency and damping.

    Args:
        structure: what moves.
        contacts: of what it carries.
        bodies: what it carries.
        r: (axis, node) m.
        rest: (axis, node) m, if they are not there.
    """
    steps = [_stable(square, rate) for square, rate in _of_lines(structure, r, rest)]
    steps.extend(_of_bodies(contacts, bodies))
    steps.extend(_of_rigid(structure, contacts))
    if structure.surfaces is not None:
        return SAFETY_OF_NETS * float(min(steps, default=np.inf))
    return (SAFETY if contacts.size else WITHOUT_LOADS) * float(min(steps, default=np.inf))


def shortened(structure: Structure, r: Array) -> tuple[float, int]:
    """How many times axial damping makes steps shorter than waves along lines do, at most, and of which run."""
    runs, found = structure.runs, [(1.0, 0)]
    for s in np.flatnonzero((runs.damping > 0.0) & (runs.law[:, 0] != law.RIGID)).tolist():
        stretched, tensions = _strained(structure, r, s)
        per_mass = 4.0 / (_of_run(structure, s)[0] * float(runs.h[s]) ** 2)
        taut = stiffness_at_rest(runs.law[s], runs.hysteresis[s])  # which a line is that hangs slack now
        square = per_mass * max(float(stretched.max()), taut, float(tensions.max()) * _ARCS)
        found.append((_stable(square, 0.0) / _stable(square, per_mass * float(runs.damping[s])), s))
    return max(found)


def largest_frequency(structure: Structure, contacts: Any, bodies: BodyArrays, r: Array) -> float:
    """A bound of the largest frequency where nothing gives way within a step, rad/s.

    Squares of frequencies of springs that act on the same masses add up at most: those of lines, of bodies, of supports
    and of contacts, with each as far from the ends of its run as kinks have their whole compliance.
    """
    runs, restrained, mass = structure.runs, structure.restraints, structure.nodes.mass
    square = max((line for line, _ in _of_lines(structure, r)), default=0.0)
    square += (2.0 / min(_of_bodies(contacts, bodies), default=np.inf)) ** 2
    springs = [
        float(np.linalg.eigvalsh(restrained.stiffness[e])[-1])
        / float(restrained.mass[e] + mass[restrained.members(e)].sum())
        for e in np.flatnonzero(restrained.stiffness.any(axis=(1, 2))).tolist()
    ]
    table, pressed = compliances()[0][:, (NEAR - 1) * PARTS :].max(axis=1), [0.0]
    for contact in contacts[contacts["kind"] == BODY]:
        for s in structure.lines.first[contact["line"]] + np.arange(structure.lines.runs[contact["line"]]):
            part, crowd = slice(runs.first[s], runs.first[s] + runs.links[s] + 1), (contacts["line"] == contact["line"])
            bending = _of_run(structure, s)[1] / runs.h[s] ** 2
            whole = max(float(_strained(structure, r, s)[1].max()), 0.0) + bending
            root = math.sqrt(bending / whole) if whole > 0.0 else 0.0
            firm = float(runs.firm[s]) or whole / runs.h[s] * float(table[int(np.ceil(root * (SHARES - 1)))])
            if runs.firm[s] == 0.0 and runs.law[s, 0] != law.RIGID:
                firm = max(firm, stiffness_at_rest(runs.law[s], runs.hysteresis[s]) / (AXIAL * runs.h[s]))
            near = float(structure.nodes.mobile[part].max())
            pressed.append(firm * (float(contact["light"]) + near * int(crowd.sum())))
    return math.sqrt(square + max(springs, default=0.0) + max(pressed))


def _of_run(structure: Structure, s: int) -> tuple[float, float, float]:
    """Mass per length, bending stiffness and bed of run s; of one that varies, the least and the largest ones."""
    runs, segments = structure.runs, structure.segments
    if segments is None:
        return float(runs.rho[s]), float(runs.bending[s]), float(runs.bed[s])
    part = slice(runs.first[s], runs.first[s] + runs.links[s] + 1)
    rho = segments.rho[part].min() or runs.rho[s]  # those of edge cables are not there
    return float(rho), float(segments.bending[part].max()), float(segments.bed[part].max())


def _strained(structure: Structure, r: Array, s: int) -> tuple[Array, Array]:
    """Tangents of the law and tensions of the links of run s and of one without strain, N."""
    runs = structure.runs
    part = slice(runs.first[s], runs.first[s] + runs.links[s] + 1)
    length = np.sqrt((np.diff(r[:, part], axis=1) ** 2).sum(axis=0))
    strain = np.concatenate([length / runs.h[s] - 1.0, [0.0]])
    return law.tangents(runs.law[s], strain) + runs.hysteresis[s, 0], law.tensions(runs.law[s], strain)


def _of_lines(structure: Structure, r: Array, rest: Array | None = None) -> list[tuple[float, float]]:
    """Bounds of squares of frequencies, 1/s^2, and of rates of decay, 1/s, of runs and cells."""
    runs, found = structure.runs, list[tuple[float, float]]()
    around, viscous = of_cells(structure)
    eased = stiffer(structure, r, r if rest is None else rest) if structure.inertia.along.size else None
    tied, taken = np.zeros((2, structure.nodes.mass.size))
    if structure.ties is not None:
        tied, taken = structure.ties.bounds(structure.nodes.mass)
        beyond = int((runs.first + runs.links).max()) + 1  # masses between ties
        found.extend(zip(tied[beyond:].tolist(), taken[beyond:].tolist(), strict=True))
    if structure.saddles is not None:
        tied = tied + structure.saddles.bounds(structure.nodes.mass)
    for s in np.flatnonzero(runs.firm == 0.0).tolist():
        part = slice(runs.first[s], runs.first[s] + runs.links[s] + 1)
        if runs.law[s, 0] == law.RIGID:  # see `_of_rigid`
            continue
        stretched, tensions = _strained(structure, r, s)
        taut, h = float(tensions.max()) * _ARCS, runs.h[s]
        rho, bending, bed = _of_run(structure, s)
        stiffest, viscosity = float(stretched.max()), runs.damping[s]
        if eased is not None:
            own = np.minimum(eased[part][:-1] + (_TURNED if rest is None else 0.0), 1.0)
            stiffest, viscosity = taut + float((own * stretched[:-1]).max()), viscosity * float(own.max())
        square = 4.0 * max(stiffest, taut) / (rho * h * h) + _BENDING * bending / (rho * h**4)
        square += bed / rho + float(tied[part].max())
        rate = 4.0 * viscosity / (rho * h * h) + float(taken[part].max())
        if around.size:  # edge cables bear cells, too
            square, rate = square + float(around[part].max()), rate + float(viscous[part].max())
            around[part] = 0.0
        found.append((square, rate))
    found.extend(_at_sheaves(structure, r, eased, rest is not None))
    return found + [(float(k), float(c)) for k, c in zip(around, viscous, strict=True)]


def _of_rigid(structure: Structure, contacts: Any) -> list[float]:
    """Steps in s of inextensible lines: transverse waves, and bodies on kinks, under a tension that may grow."""
    runs, steps = structure.runs, []
    for s in np.flatnonzero(runs.law[:, 0] == law.RIGID):
        assert structure.taut is not None
        pull = float(structure.taut[runs.first[s] : runs.first[s] + runs.links[s]].max())
        bears = waves_of(structure, contacts, int(s)) * max(pull, 0.0) / (runs.rho[s] * runs.h[s] ** 2)
        steps.append(HARD / SAFETY * _stable(bears, 0.0))
    return steps


def _of_bodies(contacts: Any, bodies: BodyArrays) -> list[float]:
    """Stable steps of bodies and tethers, s."""
    steps = []
    for p, n in enumerate(bodies.size):
        M, K, C = (matrix[p, :n, :n] for matrix in (bodies.M, bodies.K, bodies.C))
        heavy = (np.diag(M) > 0.0) & (np.diag(M) < FIRM)  # only its owner moves what is firm
        if heavy.any():
            light = np.linalg.inv(M[np.ix_(heavy, heavy)])
            square = float(np.abs(np.linalg.eigvals(light @ K[np.ix_(heavy, heavy)])).max())
            rate = 0.5 * float(np.abs(np.linalg.eigvals(light @ C[np.ix_(heavy, heavy)])).max())
            steps.append(2.0 / max(math.hypot(math.sqrt(max(square, 0.0)), rate) + rate, 1e-300))
    if bodies.carriages.bars.size:
        steps.extend(_of_carriages(contacts, bodies))
    for tether in bodies.tethers:  # at its end, and at the contact with no more than the mass of its own
        mobility = float(bodies.per_mass[int(tether["first"])] + contacts[tether["contact"]]["light"])
        stiffer = float(tether["length"] / tether["shortest"])  # when it has been taken in
        pulled, taken = (
            math.sqrt(stiffer * float(tether["stiffness"]) * mobility),
            0.5 * float(tether["damping"]) * mobility,
        )
        steps.append(2.0 / (math.hypot(pulled, taken) + taken))
    return steps


def _of_carriages(contacts: Any, bodies: BodyArrays) -> Iterator[float]:
    """Stable steps of bars and hauling ropes, s: those of all carriages together, by sums that are bounds."""
    count, dim = bodies.mass.size, int(bodies.axis.max()) + 1
    inverse = np.diag(bodies.per_mass)
    for p, n in enumerate(bodies.size):
        own = bodies.at[p, :n]
        if np.diag(bodies.M[p, :n, :n]).min() > 0.0:
            inverse[np.ix_(own, own)] = np.linalg.inv(bodies.M[p, :n, :n])
    square, rate = bodies.carriages.bounds(inverse, dim)
    for haul in bodies.carriages.hauls:
        for first, wheels in ((haul["first"], haul["wheels"]), (haul["other"], haul["others"])):
            if first >= 0:  # it pulls at the mean of its wheels
                pulled = np.zeros(count)
                pulled[contacts["first"][first : first + wheels]] = 1.0 / wheels
                light = float(pulled @ inverse @ pulled)
                of_rope = _of_rope(haul, light)
                square, rate = square + of_rope[0], rate + of_rope[1]
    yield _stable(square, rate)


def _of_rope(haul: Any, carriage: float) -> tuple[float, float]:
    """Bounds of the square of a frequency, 1/s^2, and of a rate, 1/s, of a hauling rope and its counter rope.

    Half a spring is between carriage and first mass, 2 k (1/M + 1/m), the others are no more than 4 k/m.

    Args:
        haul: its record.
        carriage: 1/kg, what a force on its carriage accelerates.
    """
    n, length = int(haul["masses"]), float(haul["length"])
    stiff, damps = (float(haul[key]) / length * max(2 * n, 1) for key in ("stiffness", "damping"))
    light = carriage + (3.0 * n / (float(haul["mass"]) * length) if n else 0.0)
    square = stiff * light
    if haul["counter_mass"] > 0.0:  # on half of its spring
        near, k, m = float(haul["counter_place"][0]), float(haul["counter_stiffness"]), float(haul["counter_mass"])
        square += 2.0 * k / near * (carriage + 1.0 / (m * near))
    return square, damps * light


def _at_sheaves(structure: Structure, r: Array, eased: Array | None, known: bool) -> Iterator[tuple[float, float]]:
    """Bounds of squares of frequencies, 1/s^2, and of rates, 1/s, beside sheaves and of what these hang on.

    The stiffness k of the link over a sheave acts on how much the ways to it are longer together, c u with c of
    magnitudes 1, 2 and 1 at most. It is no more than that of springs from each of the three nodes to the ground, of
    k c^2 x with 1/x adding up to 1.
    """
    sheaves, runs, restrained, mass = structure.sheaves, structure.runs, structure.restraints, structure.nodes.mass
    if sheaves is None:
        return
    for q, (node, s) in enumerate(zip(sheaves.node, sheaves.run, strict=True)):
        e, h, m = int(runs.first[s] + runs.links[s]), float(runs.h[s]), float(runs.rho[s] * runs.h[s])
        length = np.linalg.norm(r[:, e] - r[:, node]) + np.linalg.norm(r[:, e + 1] - r[:, node])
        strain = np.array([float(length) / h - 1.0, 0.0])
        stretched, taut = (float(f(runs.law[s], strain).max()) for f in (law.tangents, law.tensions))
        k = max(stretched, taut * _ARCS) / h
        own = k * (_STUCK if sheaves.friction[q] > 0.0 else 1.0)
        if structure.is_linearised:  # where there is friction, it sticks where it is, in two pieces
            shortest = min(float(sheaves.ahead[q]), h - float(sheaves.ahead[q]))
            own = max(k, 0.5 * k * h / shortest) if sheaves.friction[q] > 0.0 else k
        carrier = int(np.searchsorted(restrained.first, np.flatnonzero(restrained.node == node)[0], side="right")) - 1
        M = (
            float(restrained.mass[carrier] + mass[restrained.members(carrier)].sum())
            if restrained.free[carrier].any()
            else np.inf
        )
        x = np.geomspace(1.01, 1e4, 400)  # of the sheave
        less, pull = 1.0, 0.0
        if eased is not None:  # nodes beside it are heavier along their lines
            less = min(float(eased[[e - 1, e + 1]].max()) + (0.0 if known else _TURNED), 1.0)
            pull = taut * _ARCS / h
        square = np.maximum((2.0 * pull + less * (2.0 * k + 2.0 * own / (1.0 - 1.0 / x))) / m, 4.0 * own * x / M)
        yield float(square.min()), 4.0 * less * float(runs.damping[s]) / (m * h)


def waves_of(structure: Structure, contacts: Any, s: int) -> float:
    """Square of the largest frequency on inextensible run s, with bodies that stand on it, over T/(rho h^2)."""
    runs, lines, found = structure.runs, structure.lines, 4.0 * _ARCS
    for contact in contacts[contacts["kind"] == BODY]:
        first = lines.first[contact["line"]]
        if first <= s < first + lines.runs[contact["line"]]:
            here = (_SHARED + runs.rho[s] * runs.h[s] * float(contact["light"])) * float(compliances()[0, 0].max())
            found = max(found, 4.0 * _ARCS + here)
    return found


def limit_tension(structure: Structure, contacts: Any, buffers: Buffers) -> None:
    """Note how far tensions of inextensible lines may grow before steps are too long for their waves."""
    if (tight := buffers.tight) is None:
        return
    for s in np.flatnonzero(structure.runs.law[:, 0] == law.RIGID):
        part = slice(structure.runs.first[s], structure.runs.first[s] + structure.runs.links[s])
        tight.fast[part] *= waves_of(structure, contacts, int(s))
    tight.time[3] = (2.0 * GROWN) ** 2


def while_passing(structure: Structure, contacts: Any, tables: Tables) -> float:
    """The time in s in which no load of prescribed speed goes on further than it may on inextensible lines."""
    runs, least = structure.runs, np.inf
    for contact in contacts:
        run = structure.lines.first[contact["line"]]
        if runs.law[run, 0] == law.RIGID:
            part = slice(contact["speed_first"], contact["speed_first"] + contact["speed_count"])
            fastest = float(np.abs(tables.speed_value[part]).max(initial=0.0))
            least = min(least, PASSED * float(runs.h[run]) / max(fastest, 1e-300))
    return float(least)


def _stable(square: float, rate: float) -> float:
    """The stable step, s, by bounds of the square of frequencies, 1/s^2, and of rates of decay, 1/s."""
    if square == 0.0:
        return np.inf if rate == 0.0 else 2.0 / rate
    zeta = 0.5 * rate / math.sqrt(square)
    return 2.0 / math.sqrt(square) / (math.hypot(1.0, zeta) + zeta)  # sqrt(1 + zeta^2) - zeta rounds to 0


def of_cells(structure: Structure) -> tuple[Array, Array]:
    """Bounds (node,) of the square of frequencies that cells make, 1/s^2, and of their rates of decay, 1/s."""
    surfaces, mass = structure.surfaces, structure.nodes.mass
    if surfaces is None:
        return np.zeros(0), np.zeros(0)
    fixed = [structure.restraints.members(int(e)) for e in np.flatnonzero(~structure.restraints.free.any(axis=(1, 2)))]
    moves = mass > 0.0
    moves[np.concatenate([np.zeros(0, dtype=np.int64), *fixed])] = False
    stiffness, damping = bounds_of_cells(surfaces.cells, mass.size)
    per_mass = np.divide(1.0, mass, out=np.zeros_like(mass), where=moves)
    return stiffness * per_mass, damping * per_mass


def cut_by_damping(assembled: Assembled, r: Array, steps: float) -> list[str]:
    """The line whose axial damping makes a long run much longer than it would be without.

    Args:
        assembled: what moves.
        r: (axis, node) m.
        steps: of the run.
    """
    if steps < MANY:
        return []
    times, run = shortened(assembled.structure, r)
    if times <= MUCH_SHORTER or run >= len(assembled.line):
        return []
    return [
        f"lines.{assembled.line[run]}.axial_damping reduces the stable step by a factor of {times:.2g}: lower it, or "
        "write fewer elements"
    ]
