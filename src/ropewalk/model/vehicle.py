"""Vehicles: bodies on springs on wheels, several of them behind each other."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from ropewalk.errors import Refused, did_you_mean
from ropewalk.model._base import Declaration, FieldReader, Finding, report
from ropewalk.model.contact import CONTACT_STIFFNESS, LIFT_OFF, SIDE, Side, one_sided, soft_contact
from ropewalk.model.quantity import (
    Acceleration,
    Inertia,
    Mass,
    Name,
    PositiveMass,
    PositiveStiffness,
    Station,
    Viscosity,
)
from ropewalk.model.travel import Place, Travel, prescribed_only


class RigidBody(Declaration):
    """A rigid body of a vehicle: it moves up and down and, if it has an inertia, pitches about its centre."""

    mass: PositiveMass = Field(description="of the body")
    inertia: Inertia = Field(default=0.0, description="moment of inertia about its centre; 0: it does not pitch")
    at: Station = Field(default=0.0, description="place of its centre along the vehicle")


class Wheel(Declaration):
    """A wheel, axle or unsprung mass that runs on the line."""

    at: Station = Field(default=0.0, description="place along the vehicle, ahead of its point 0 if positive")
    mass: Mass = Field(default=0.0, description="unsprung, that follows the line")
    contact_stiffness: PositiveStiffness | None = Field(default=None, description=CONTACT_STIFFNESS)


@dataclass(frozen=True)
class _TwoNames(FieldReader):
    """Annotation: two names in a list."""

    def read(self, value: object) -> tuple[str, str]:
        if not isinstance(value, list | tuple) or len(value) != 2 or not all(isinstance(name, str) for name in value):
            raise Refused("expected two names", "write [body, wheel] or [body, body]")
        return value[0], value[1]

    def json_form(self) -> dict[str, Any]:
        return {"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2}


class Spring(Declaration):
    """A vertical spring with a damper parallel to it, between two parts of a vehicle."""

    between: Annotated[tuple[str, str], _TwoNames()] = Field(description="names of a body and a wheel, or two bodies")
    stiffness: PositiveStiffness = Field(description="of the spring")
    damping: Viscosity = Field(default=0.0, description="of the damper")
    at: Station | None = Field(
        default=None,
        description="place along the vehicle (default: that of the wheel, or of the centre of the first body)",
    )


WEIGHT = "gravity on the load, also if that of the scenario is 0"


class Vehicle(Declaration):
    """Bodies on springs on wheels, with vertical motion and pitch, pulled along as prescribed.

    Places `at` count along the line and forwards from the point 0 of the vehicle, which is where `travel` says. All
    distances between wheels are kept in what the travel measures. One that leaves at the end may begin before the line:
    wheels off it stand on level ground, or follow the profile there.
    """

    kind: Literal["vehicle"] = "vehicle"
    on: str = Field(description="name of the line")
    bodies: dict[Name, RigidBody] = Field(default_factory=dict, description="the sprung bodies, by name")
    wheels: dict[Name, Wheel] = Field(min_length=1, description="the wheels, by name")
    springs: dict[Name, Spring] = Field(default_factory=dict, description="springs between them, by name")
    travel: Annotated[Travel, prescribed_only("the travel of a vehicle is prescribed")] = Field(
        description="motion of its point 0; wheels with a positive `at` run ahead of it towards the end of the line"
    )
    gravity: Acceleration | None = Field(default=None, description=f"{WEIGHT} (default: that of the scenario)")
    lift_off: bool = Field(default=False, description=LIFT_OFF)
    side: Side = Field(default="above", description=SIDE)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = list(check_parts(self.bodies, self.wheels, self.springs, lift_off=self.lift_off))
        report("vehicle", [*findings, *one_sided(self.side, lift_off=self.lift_off)])
        return self

    def starts(self) -> list[Place]:
        """List where its wheels stand at the beginning; negative: before the start of the line."""
        return [Place(name, self.travel.measured, self.travel.start + w.at) for name, w in self.wheels.items()]

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by: none."""
        yield from ()

    def place_of(self, spring: Spring) -> float:
        """Place of a spring along the vehicle in m."""
        return place_of(spring, self.bodies, self.wheels)


def place_of(spring: Spring, bodies: Mapping[str, RigidBody], wheels: Mapping[str, Wheel]) -> float:
    """Place in m of a spring along a vehicle of some bodies and wheels."""
    if spring.at is not None:
        return spring.at
    first = next((name for name in spring.between if name in wheels), spring.between[0])
    return wheels[first].at if first in wheels else bodies[first].at


def check_parts(
    bodies: Mapping[str, RigidBody], wheels: Mapping[str, Wheel], springs: Mapping[str, Spring], *, lift_off: bool,
    carriers: Collection[str] = (),
) -> Iterator[Finding]:  # fmt: skip
    """Find what does not fit together in a vehicle.

    Args:
        bodies: by name.
        wheels: by name.
        springs: by name.
        lift_off: whether wheels may leave the line.
        carriers: names of what else bears it, such as bodies of another vehicle.
    """
    findings = [*_names(bodies, wheels, springs, carriers), *_wheels(wheels, springs, lift_off)]
    yield from findings or _bodies(bodies, wheels, springs, carriers)  # who is joined to whom is known


def _names(
    bodies: Mapping[str, RigidBody], wheels: Mapping[str, Wheel], springs: Mapping[str, Spring],
    carriers: Collection[str],
) -> Iterator[Finding]:  # fmt: skip
    shared = [name for name in wheels if name in bodies]
    for name in shared:
        wrong, remedy = "a body has the same name", "give every part of the vehicle its own name"
        yield Finding(("wheels", name), wrong, remedy=remedy)
    if shared:
        return  # what a spring means is not known
    known = [*bodies, *wheels, *carriers]
    for name, spring in springs.items():
        unknown = [end for end in spring.between if end not in known]
        for end in dict.fromkeys(unknown):
            path = ("springs", name, "between", spring.between.index(end))
            yield Finding(path, "no such body or wheel", repr(end), did_you_mean(end, known))
        if unknown:
            continue
        if spring.between[0] == spring.between[1]:
            wrong, remedy = "a spring must join two different parts", "name a body and a wheel, or two bodies"
            yield Finding(("springs", name, "between"), wrong, f"{spring.between[0]} twice", remedy)
        elif all(end not in bodies for end in spring.between):
            wrong, remedy = "a spring between two wheels carries no load", "name a body and a wheel, or two bodies"
            yield Finding(("springs", name, "between"), wrong, " and ".join(spring.between), remedy)


def _wheels(wheels: Mapping[str, Wheel], springs: Mapping[str, Spring], lift_off: bool) -> Iterator[Finding]:
    sprung = {end for spring in springs.values() for end in spring.between}
    for name, wheel in wheels.items():
        if not wheel.mass and name not in sprung:
            remedy = "give it a mass, name it in a spring, or leave it out"
            yield Finding(("wheels", name), "a wheel with neither mass nor spring", remedy=remedy)
        yield from soft_contact(("wheels", name, "contact_stiffness"), wheel.contact_stiffness, lift_off=lift_off)
    for (one, first), (two, second) in combinations(wheels.items(), 2):
        if _same(first.at, second.at):
            remedy = "write another position (at), or combine both wheels"
            yield Finding(("wheels", two, "at"), f"at the same place as wheel {one}", f"{second.at:g} m", remedy)


def _bodies(
    bodies: Mapping[str, RigidBody], wheels: Mapping[str, Wheel], springs: Mapping[str, Spring],
    carriers: Collection[str],
) -> Iterator[Finding]:  # fmt: skip
    carried = {*wheels, *carriers}
    for _ in springs:
        carried |= {end for s in springs.values() if carried & set(s.between) for end in s.between}
    for name, body in bodies.items():
        places = [place_of(spring, bodies, wheels) for spring in springs.values() if name in spring.between]
        if not places:
            yield Finding(("bodies", name), "the body has no springs and would fall", remedy="name it in a spring")
        elif name not in carried:
            remedy = "join it, or a body that carries it, to a wheel"
            yield Finding(("bodies", name), "it is not connected to a wheel by springs", remedy=remedy)
        elif body.inertia and all(_same(place, places[0]) for place in places):
            wrong = "the body has no pitch stiffness: all its springs are at one position"
            remedy = "place springs at two positions (at), or leave inertia out"
            yield Finding(("bodies", name, "inertia"), wrong, f"{body.inertia:g} kg*m^2", remedy)
        elif not body.inertia and not all(_same(place, body.at) for place in places):
            wrong = "its springs are off its centre, and it has no moment of inertia"
            remedy = f"give it an inertia, or place its springs at {body.at:g} m"
            yield Finding(("bodies", name, "inertia"), wrong, remedy=remedy)


def _same(one: float, two: float) -> bool:
    return math.isclose(one, two, rel_tol=1e-9, abs_tol=1e-9)
