"""An overhead line for motion in all directions: wires where they run in plan view, links as stiff as they are."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ropewalk.model.overhead import OverheadLine
from ropewalk.overhead.forming import pulling
from ropewalk.overhead.lateral import across
from ropewalk.overhead.plan_view import CONTACT, MESSENGER, STITCH
from ropewalk.overhead.section import Section
from ropewalk.wires.plan import Array, SideForce, Spot, Wire


def at_full_stiffness(section: Section, line: OverheadLine) -> Section:
    """The same line with stitch wires whose last pieces are as stiff as the rest of them, for motion along it, too.

    Vertical motion alone would find them too stiff where they are inclined.
    """
    if line.stitch_wire is None:
        return section
    stiffness, rest, ties = line.stitch_wire.axial_stiffness / line.element, section.rest, list(section.plan.ties)
    for i, tie in enumerate(ties):
        if tie.lengthwise:
            assert isinstance(tie.other, Spot)
            reach, pull = float(rest.tie_distance[i]), float(rest.tie_force[i])
            ties[i] = pulling(tie.name, tie.spot, tie.other, stiffness, reach, pull)
    return replace(section, plan=replace(section.plan, ties=tuple(ties)))


def in_space(section: Section, line: OverheadLine) -> Section:
    """The same line where its wires run in plan view, for motion that goes sideways, too.

    Steady arms have their own stiffness then, and droppers that lean their own length. Wires that end aside of where
    they begin are inclined as a whole, as those that rise: their stations stay what they are.
    """
    plan, arms, view = section.plan, line.steady_arms, section.view
    give, x0 = arms.length / arms.axial_stiffness, plan.wires[CONTACT].start[0]

    def y(spot: Spot) -> float:
        return float(section.aside(np.array([spot.station]), spot.wire)[0])

    def inside(spot: Spot) -> float:
        return float(view.inside(spot.wire, view.station(spot.wire, np.array([spot.station])))[0])

    def level(x: float, wire: int) -> float:
        return x0 + (x - x0) * _shortened(section, min(wire, MESSENGER))

    def laid(i: int, wire: Wire) -> Wire:
        x, aside = level(wire.start[0], i), (y(Spot(i, 0.0)), y(Spot(i, wire.length)))
        along = (wire.end[0] - wire.start[0]) * _shortened(section, i)
        return replace(wire, start=(x, aside[0], wire.start[2]), end=(x + along, aside[1], wire.end[2]))

    wires = tuple(laid(i, wire) for i, wire in enumerate(plan.wires))

    def place(spot: Spot, rise: float) -> Array:
        start, end = np.array(wires[spot.wire].start), np.array(wires[spot.wire].end)
        x, aside, _ = start + spot.station / wires[spot.wire].length * (end - start)
        return np.array([x, aside if spot.wire > MESSENGER else y(spot), rise])

    ties = list(plan.ties)
    for number, tie in enumerate(ties):
        if tie.lengthwise:
            assert isinstance(tie.other, Spot)
            distance, way = float(section.rest.tie_distance[number]), section.rest.tie_way[number]
            apart = place(tie.other, distance * way[2]) - place(tie.spot, 0.0) - [0.0, inside(tie.spot), 0.0]
            reach, along = float(np.linalg.norm(apart)), abs(float(section.rest.tie_force[number] * way[0]))
            pull = along * reach / abs(float(apart[0]))
            link = pulling(tie.name, tie.spot, tie.other, tie.stiffness, reach, pull)
            ties[number] = replace(link, aside=-inside(tie.spot))
    for number, length in zip(section.droppers.values(), section.lengths, strict=True):
        high = ties[number].other
        assert isinstance(high, Spot)
        ties[number] = replace(ties[number], length=float(length), aside=inside(high))
    for number in section.arms.values():
        arm = ties[number]
        assert not isinstance(arm.other, Spot)
        x, aside, z = arm.other
        ties[number] = replace(
            arm, other=(level(x, CONTACT), aside + y(arm.spot), z), length=arms.length, stiffness=1.0 / give,
            pushes=1.0 / give,
        )  # fmt: skip
    holds = (
        replace(hold, place=(level(hold.place[0], hold.spot.wire), y(hold.spot), hold.place[2])) for hold in plan.holds
    )

    turned = []
    for i, (station, turn) in enumerate(zip(view.supports[1:-1], view.turns, strict=True)):
        less = view.stitch_tension if view.reach else 0.0
        for wire, own, less_there in ((CONTACT, station, 0.0), (MESSENGER, station, less)):
            turned.append(SideForce(Spot(wire, float(own)), float(turn * (plan.wires[wire].tension - less_there))))
        if less:  # what its links pull outwards, as they go on along it
            stitch = plan.wires[STITCH + i]
            for end in (0.0, stitch.length):
                turned.append(SideForce(Spot(STITCH + i, end), float(0.5 * turn * stitch.tension)))
    return replace(
        section,
        plan=replace(
            plan, wires=wires, ties=tuple(ties),
            holds=tuple(holds), sideways=tuple(force for force in turned if force.force),
        ),
    )  # fmt: skip


def near_rest(section: Section) -> Array:
    """About where its wires rest in space, (3, node) m: its rest without going aside, put aside."""
    mesh, position, x0 = section.mesh(), section.rest.position.copy(), section.plan.wires[CONTACT].start[0]
    for i, wire in enumerate(section.plan.wires):
        part, start = mesh.of(i), x0 + (wire.start[0] - x0) * _shortened(section, min(i, MESSENGER))
        position[0, part] = start + (position[0, part] - wire.start[0]) * _shortened(section, i)
        position[1, part] = section.aside(np.linspace(0.0, wire.length, int(mesh.strands.links[i]) + 1), i)
    return position


def bow_of(section: Section, line: OverheadLine) -> Array:
    """How far wires are to the left of where they are computed, along chords of the track, (node,) m."""
    mesh, out = section.mesh(), np.zeros(section.mesh().nodes)
    for i, wire in enumerate(section.plan.wires):
        station = section.view.station(i, np.linspace(0.0, wire.length, int(mesh.strands.links[i]) + 1))
        chord = np.interp(station, section.view.supports, section.view.stagger)
        out[mesh.of(i)] = across(line, station) - chord + section.view.inside(i, station)
    return out


def _shortened(section: Section, i: int) -> float:
    """How far a wire goes along x, over what it does in the plan without sideways motion."""
    wire = section.plan.wires[i]
    aside, rise = np.diff(section.aside(np.array([0.0, wire.length]), i))[0], wire.end[2] - wire.start[2]
    return math.sqrt(wire.length**2 - float(aside) ** 2 - rise**2) / (wire.end[0] - wire.start[0])
