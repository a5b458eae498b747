"""Pantographs as moving loads on wires: coordinates are the heights of the masses in m, from the base to the head."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.pantographs import mean_force
from ropewalk.overhead.section import CONTACT, Section, elasticity
from ropewalk.wires.mesh import Mesh, places_of
from ropewalk.wires.plan import Array, Contact, Spot, TravellingLoad
from ropewalk.wires.rest import WiresAtRest, rows

_ITS_OWN = MappingProxyType({CONTACT: 0.0})


@dataclass(frozen=True)
class PantographForces:
    """Forces on the masses of a pantograph, N: what presses it to the wire, and the rest length of its base's spring.

    In the mean over time the contact feels the pressing force less that of the base's spring. Where a mean contact
    force F is wanted, base * (lift + give F) is added for it.
    """

    static: float  # N on the lowest mass
    uplift: float  # N/(m/s)^2
    on_head: bool  # whether the uplift acts there
    target: float | str | None  # mean contact force wanted instead, N or by name
    base: float  # N/m, spring of the base
    level: float  # m, height at which it is without force
    lift: float  # m, mean height of the contact over `level`
    give: float  # m/N, by which base and wire approach each other
    ramp: float  # s
    size: int  # number of masses

    def __call__(self, time: Array | float, speed: Array | float) -> Array:
        """Forces at instants in s and speeds in m/s, (..., mass) N upwards."""
        time, speed = np.asarray(time, dtype=np.float64), np.asarray(speed, dtype=np.float64)
        grown = np.clip(time / self.ramp, 0.0, 1.0) if self.ramp > 0.0 else np.ones_like(time)
        force = np.zeros((*np.broadcast_shapes(time.shape, speed.shape), self.size))
        if self.target is None:
            force[..., 0] += grown * self.static
            force[..., -1 if self.on_head else 0] += grown * self.uplift * speed**2
        else:
            mean = self.wanted(speed)
            force[..., 0] += grown * (mean + self.base * (self.lift + self.give * mean))
        force[..., 0] += self.base * self.level
        return force

    def wanted(self, speed: Array) -> Array:
        """Wanted mean contact force, N."""
        if isinstance(self.target, str):
            name = self.target
            return np.asarray(np.vectorize(lambda v: mean_force(name, v))(speed), dtype=np.float64)
        return np.full_like(speed, self.target)


def moving_load_of(name: str, pantograph: Pantograph, wires: Mapping[int, float] = _ITS_OWN) -> TravellingLoad:
    """A pantograph below contact wires: its head pushes each of them, and may lose contact.

    Args:
        name: of the load.
        pantograph: as declared.
        wires: numbers of the contact wires in the plan, and how far ahead of its line's start each begins, m.
    """
    parts = pantograph.parts
    size = len(parts.masses)
    # Spring and damper i stand between masses i - 1 and i, those of the base on the roof.
    apart = np.eye(size) - np.eye(size, k=-1)
    head = (0.0,) * (size - 1) + (1.0,)
    contacts = tuple(
        Contact(
            wire, head, behind=ahead, stiffness=pantograph.contact_stiffness, damping=pantograph.contact_damping,
            below=True, lifts_off=True,
        )
        for wire, ahead in wires.items()
    )  # fmt: skip
    return TravellingLoad(
        name, np.diag(parts.masses), apart.T @ np.diag(parts.damping) @ apart,
        apart.T @ np.diag(parts.stiffness) @ apart, contacts,
    )  # fmt: skip


def push_of(pantograph: Pantograph, level: float, lift: float = 0.0) -> PantographForces:
    """Forces on its masses.

    Args:
        pantograph: as declared.
        level: height of the contact wire at the supports, m.
        lift: mean height of the contact over it in the run, m; see `expected_lift`.
    """
    give = sum(1.0 / k for k in (*pantograph.parts.stiffness[1:], pantograph.contact_stiffness))
    return PantographForces(
        pantograph.pressed_with, pantograph.aerodynamic, pantograph.aerodynamic_on == "head", pantograph.wanted_mean,
        pantograph.parts.stiffness[0], level, lift, give, pantograph.ramp, len(pantograph.parts.masses),
    )  # fmt: skip


def start_of(
    pantograph: Pantograph, mesh: Mesh, rest: WiresAtRest, wire: int = CONTACT, rough: float = 0.0, ahead: float = 0.0
) -> Array:
    """First heights of all masses in m: the head just touches the wire, and no spring between masses is pressed.

    Args:
        rough: m, irregularity there.
        ahead: m, by which the wire begins ahead of the pantograph's line.

    Raises:
        RopewalkError: it starts off the line.
    """
    station, length = pantograph.travel.start - ahead, mesh.plan.wires[wire].length
    if not 0.0 <= station <= length:
        raise RopewalkError(
            f"the pantograph starts at {station:g} m, off the overhead line of {length:g} m; "
            f"write travel.from: 0 m to {length:g} m"
        )
    at = places_of(mesh.strands, [Spot(wire, station)])
    height = float((rows(at, mesh.nodes) @ rest.position[2])[0]) + rough
    return np.full(len(pantograph.parts.masses), height)


def expected_lift(section: Section, force: float, points: int = 9) -> float:
    """Mean height of a contact with a given mean force over the ends of the contact wire, m, as if it moved slowly.

    Args:
        section: the line.
        force: mean contact force, N.
        points: stations along the first analysed span at which the rise is found.
    """
    first, last = section.analysed
    span = int(np.searchsorted(section.supports, first, side="right")) - 1
    begin, end = section.supports[span], section.supports[span + 1]
    stations = begin + (np.arange(points) + 0.5) * (end - begin) / points
    _, rise = elasticity(section, force, stations=stations)
    mesh = section.mesh()
    along = np.arange(first, last, section.element)
    level = section.is_level[np.searchsorted(section.supports, along, side="right") - 1]
    along = along[level] if level.any() else along  # where the wire rises out of reach another one is pressed
    heights = rows(places_of(mesh.strands, [Spot(CONTACT, float(x)) for x in along]), mesh.nodes)
    return float((heights @ section.rest.position[2]).mean()) - section.level + force * float(rise.mean())
