"""A task: wires, what travels on them, and how closely it is to be computed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from ropewalk.wires.journey import Journey
from ropewalk.wires.mesh import Mesh, mesh_of, places_of
from ropewalk.wires.plan import Array, Plan, Spot
from ropewalk.wires.rest import Rest, rest_of

Geometry = Literal["nonlinear", "linearised"]


@dataclass(frozen=True)
class Shown:
    """A coordinate of a rider that results show as a body: how high it is, and where."""

    name: str
    journey: int
    row: Array  # (coordinate,) height over `base`
    base: float  # m
    ahead: float = 0.0  # m ahead of the place of the rider


@dataclass(frozen=True)
class Task:
    """What is computed."""

    plan: Plan
    journeys: tuple[Journey, ...]
    contacts: tuple[str, ...]  # name of each contact in results
    shown: tuple[Shown, ...] = ()
    element: float | list[int] = 0.25  # m, or the number of links of each wire
    geometry: Geometry = "nonlinear"
    window: float = np.inf  # m on both sides of the contacts, beyond which nothing moves; linearised only
    inertia: float = 1.0  # factor on the mass along x; nonlinear only
    space: bool = False  # whether anything moves sideways
    watched: dict[str, Spot] = field(default_factory=dict)


def ready(task: Task) -> tuple[Task, Mesh, Rest]:
    """Divide the wires and find their rest; contacts whose base is NaN begin at the height of their wire.

    Raises:
        RopewalkError: something is attached off its wire, or there is no rest.
    """
    mesh = mesh_of(task.plan, task.element)
    rest = rest_of(mesh)
    zero, journeys = np.zeros(1), []
    for journey in task.journeys:
        contacts = []
        for contact in journey.rider.contacts:
            if np.isnan(contact.base):
                station = float(journey.place(zero)[0]) - contact.behind
                height = height_at(mesh, rest, contact.wire, station) + float(journey.rough(np.array([station]))[0])
                contact = replace(contact, base=height)
            contacts.append(contact)
        journeys.append(replace(journey, rider=replace(journey.rider, contacts=tuple(contacts))))
    return replace(task, journeys=tuple(journeys)), mesh, rest


def height_at(mesh: Mesh, rest: Rest, wire: int, station: float) -> float:
    """Height of a wire at rest, m; beyond its ends, of the end."""
    inside = min(max(station, 0.0), mesh.plan.wires[wire].length)
    at = places_of(mesh.strands, [Spot(wire, inside)])
    base = int(at.base[0])
    return float(at.weight[0] @ rest.position[2, base : base + at.weight.shape[1]])
