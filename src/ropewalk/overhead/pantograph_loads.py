"""Pantographs as moving loads on wires, with the coordinates of `mechanics/pantograph_matrices.py`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.pantograph_matrices import matrices_of, rotations_of, row_of
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.pantographs import mean_force
from ropewalk.overhead.plan_view import CONTACT
from ropewalk.overhead.section import Section, elasticity
from ropewalk.wires.mesh import Mesh, places_of
from ropewalk.wires.plan import Array, Contact, Spot, TravellingLoad, nothing
from ropewalk.wires.rest import WiresAtRest, rows


@dataclass(frozen=True)
class Above:
    """A contact wire above a pantograph."""

    ahead: float = 0.0  # m, by which it begins ahead of the pantograph's line
    rough: Callable[[Array], Array] = nothing  # stations of it to its irregularity, m
    aside: Callable[[Array], Array] = nothing  # stations of it to how far to the left of the middle it runs, m
    widest: float = 0.0  # m, the largest distance aside


_ITS_OWN = MappingProxyType({CONTACT: Above()})


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
    masses: int  # their number
    size: int  # number of coordinates, the first of which are their heights

    def __call__(self, time: Array | float, speed: Array | float) -> Array:
        """Forces at instants in s and speeds in m/s, (..., mass) N upwards."""
        time, speed = np.asarray(time, dtype=np.float64), np.asarray(speed, dtype=np.float64)
        grown = np.clip(time / self.ramp, 0.0, 1.0) if self.ramp > 0.0 else np.ones_like(time)
        force = np.zeros((*np.broadcast_shapes(time.shape, speed.shape), self.size))
        if self.target is None:
            force[..., 0] += grown * self.static
            force[..., self.masses - 1 if self.on_head else 0] += grown * self.uplift * speed**2
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


def moving_load_of(name: str, pantograph: Pantograph, wires: Mapping[int, Above] = _ITS_OWN) -> TravellingLoad:
    """A pantograph below contact wires: the strips of its head push each of them, and may lose contact.

    Args:
        name: of the load.
        pantograph: as declared.
        wires: the contact wires by their numbers in the plan.
    """
    mass, damping, stiffness = matrices_of(pantograph)
    middle = row_of(pantograph)
    contacts = tuple(
        Contact(
            wire, tuple(row_of(pantograph, place)), behind=above.ahead - place, stiffness=pantograph.contact_stiffness,
            damping=pantograph.contact_damping, below=True, lifts_off=True, rough=above.rough,
            turn=tuple(row_of(pantograph, aside=1.0) - middle), aside=above.aside, widest=above.widest,
        )
        for wire, above in wires.items()
        for place in pantograph.strips.values()
    )  # fmt: skip
    return TravellingLoad(name, mass, damping, stiffness, contacts)


def push_of(pantograph: Pantograph, level: float, lift: float = 0.0) -> PantographForces:
    """Forces on its masses.

    Args:
        pantograph: as declared.
        level: height of the contact wire at the supports, m.
        lift: mean height of the contact over it in the run, m; see `expected_lift`.
    """
    touching = pantograph.contact_stiffness * len(pantograph.strips)
    give = sum(1.0 / k for k in (*pantograph.parts.stiffness[1:], touching))
    masses = len(pantograph.parts.masses)
    return PantographForces(
        pantograph.pressed_with, pantograph.aerodynamic, pantograph.aerodynamic_on == "head", pantograph.wanted_mean,
        pantograph.parts.stiffness[0], level, lift, give, pantograph.ramp, masses,
        masses + len(rotations_of(pantograph)),
    )  # fmt: skip


def start_of(
    pantograph: Pantograph, mesh: Mesh, rest: WiresAtRest, wire: int = CONTACT, above: Above = _ITS_OWN[CONTACT]
) -> Array:
    """First heights of all masses in m: the head just touches the wire, and no spring between masses is pressed.

    It stands level: the angles of its head are 0.

    Args:
        above: what is known of that wire.

    Raises:
        RopewalkError: it starts off the line.
    """
    station, length = pantograph.travel.start - above.ahead, mesh.plan.wires[wire].length
    if not 0.0 <= station <= length:
        raise RopewalkError(
            f"the pantograph starts at {station:g} m, off the overhead line of {length:g} m; "
            f"write travel.from: 0 m to {length:g} m"
        )
    at = places_of(mesh.strands, [Spot(wire, station)])
    height = float((rows(at, mesh.nodes) @ rest.position[2])[0] + above.rough(np.array([station]))[0])
    return np.array([height] * len(pantograph.parts.masses) + [0.0] * len(rotations_of(pantograph)))


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
