"""Trains of vehicles: bodies on springs on wheels, one vehicle behind the other, written down or built in by name."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from ropewalk.errors import Refused, did_you_mean
from ropewalk.model._base import Declaration, FieldReader, Finding, report
from ropewalk.model.axles import TrainTravel, onward
from ropewalk.model.contact import LIFT_OFF
from ropewalk.model.history import SpeedTable
from ropewalk.model.quantity import Acceleration, Name, PositiveLength
from ropewalk.model.train_sets import ORDER, VEHICLES, BogieVehicle, G, SprungTrainName, middles
from ropewalk.model.travel import Place, Travel
from ropewalk.model.vehicle import WEIGHT, RigidBody, Spring, Vehicle, Wheel, check_parts, place_of

MOST = 200
"""Vehicles of a train."""
NEXT = "next."
"""What stands before the name of a body of the vehicle behind."""


@dataclass(frozen=True)
class _Names(FieldReader):
    """Annotation: names in order, of which one that comes several times may be written with its number, 8 coach."""

    def read(self, value: object) -> tuple[str, ...]:
        remedy = "write [locomotive, 8 coach, locomotive]"
        if not isinstance(value, list | tuple) or not value or not all(isinstance(name, str) for name in value):
            raise Refused("expected a list of names", remedy)
        found: list[str] = []
        for entry in value:
            several = re.fullmatch(r"(\d{1,4}) +(\S.*)", entry)
            found += [several[2]] * int(several[1]) if several else [entry]
        if not 0 < len(found) <= MOST:
            raise Refused(f"has {len(found)} vehicles", f"write 1 to {MOST} of them", given=str(len(found)))
        return tuple(found)

    def json_form(self) -> dict[str, Any]:
        return {"type": "array", "items": {"type": "string"}, "minItems": 1}


class TrainVehicle(Declaration):
    """A vehicle of a train; places count forwards from its middle.

    A spring between one of its bodies and `next.` with a body of the vehicle behind stands on that: so two coaches
    share a bogie, which is one of the vehicle behind.
    """

    length: PositiveLength = Field(description="from where the vehicle before it ends to where the next one begins")
    bodies: dict[Name, RigidBody] = Field(default_factory=dict, description="the sprung bodies, by name")
    wheels: dict[Name, Wheel] = Field(min_length=1, description="the wheels, by name")
    springs: dict[Name, Spring] = Field(default_factory=dict, description="springs between them, by name")

    @property
    def behind(self) -> dict[str, str]:
        """Bodies of the next vehicle that its springs stand on, by the springs that do."""
        ends = [(name, end) for name, spring in self.springs.items() for end in spring.between]
        return {name: end.removeprefix(NEXT) for name, end in ends if end.startswith(NEXT)}


class TrainSection(Vehicle):
    """Vehicles of a train that springs join, as one vehicle whose point 0 is the first wheel of the train."""

    kind: Literal["train"] = "train"  # type: ignore[assignment]
    onward: float = 1.0

    @property
    def length(self) -> float:
        """From the first wheel of the train to its own last one, m."""
        return max(abs(wheel.at) for wheel in self.wheels.values())


class Train(Declaration):
    """Vehicles behind one another, with vertical motion and pitch, that roll on to a line and off it.

    They are written down, or those of a train that is known by name. Wheels that have not come to the line, or have
    left it, stand on level ground or follow the profile there. Couplers bear nothing up and down; bogies may be shared.
    """

    kind: Literal["train"] = "train"
    on: str = Field(description="name of the line")
    train: SprungTrainName | None = Field(
        default=None, description="name of a built-in train, instead of vehicles and order"
    )
    vehicles: dict[Name, TrainVehicle] | None = Field(default=None, description="the kinds of vehicles, by name")
    order: Annotated[tuple[str, ...], _Names()] | None = Field(
        default=None, description="names of the vehicles from the front, [locomotive, 8 coach]; default: one of each"
    )
    travel: TrainTravel = Field(
        description="motion of the train along the line, on to which it rolls and which it leaves"
    )
    gravity: Acceleration = Field(default=G, description=WEIGHT)
    lift_off: bool = Field(default=False, description=LIFT_OFF)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        report("train", list(self._named() if self.train is not None else self._written()))
        report("train", list(self._turns()))
        return self

    def _named(self) -> Iterator[Finding]:
        for key in ("vehicles", "order"):
            if getattr(self, key) is not None:
                remedy = f"leave {key} out, or write vehicles instead of train"
                yield Finding((key,), f"train {self.train} has its own vehicles", remedy=remedy)

    def _written(self) -> Iterator[Finding]:
        if not self.vehicles:
            remedy = "add vehicles, by name, or train: ICE 3"
            yield Finding(("vehicles",), "is required without train", remedy=remedy)
            return
        for index, name in enumerate(self.order or ()):
            if name not in self.vehicles:
                yield Finding(("order", index), "no such vehicle", repr(name), did_you_mean(name, self.vehicles))
                return
        followed: list[tuple[str, str | None]] = [*pairwise(self._order), (self._order[-1], None)]
        for one, two in dict.fromkeys(followed):
            for spring, end in self.vehicles[one].behind.items():
                path = ("vehicles", one, "springs", spring, "between")
                if two is None:
                    remedy = f"let another vehicle, with bogies of its own, follow {one}"
                    yield Finding(path, "the last vehicle has no vehicle behind it", NEXT + end, remedy)
                elif end not in self.vehicles[two].bodies:
                    remedy = did_you_mean(end, self.vehicles[two].bodies)
                    yield Finding(path, f"vehicle {two}, which follows {one}, has no such body", NEXT + end, remedy)
                    return
        for name, vehicle in self.vehicles.items():
            for found in check_parts(
                vehicle.bodies, vehicle.wheels, vehicle.springs, lift_off=self.lift_off,
                carriers=[NEXT + end for end in vehicle.behind.values()],
            ):  # fmt: skip
                yield replace(found, path=("vehicles", name, *found.path))

    def _turns(self) -> Iterator[Finding]:
        speed = self.travel.speed
        if isinstance(speed, SpeedTable) and min(speed.value) < 0.0 < max(speed.value):
            wrong, remedy = "the speed of a train must not change its sign", "write two loads, or one sign"
            yield Finding(("travel", "speed"), wrong, "a table", remedy)

    @property
    def _order(self) -> tuple[str, ...]:
        if self.train is not None:
            return ORDER[self.train]
        return self.order or tuple(self.vehicles or ())

    @property
    def composition(self) -> list[tuple[str, TrainVehicle]]:
        """The vehicles from the front, with their names."""
        if self.train is None:
            assert self.vehicles is not None
            return [(name, self.vehicles[name]) for name in self._order]
        own = {name: on_bogies(vehicle) for name, vehicle in VEHICLES[self.train].items()}
        return [(name, own[name]) for name in self._order]

    @property
    def whole(self) -> TrainSection:
        """The train as one vehicle: 1.box is the box of the first one."""
        return self._section(1, self.composition)

    def sections(self, name: str) -> dict[str, TrainSection]:
        """The train in pieces that nothing joins, by names that make its bodies those of the whole train `name`."""
        found, row = dict[str, TrainSection](), self.composition
        ends = [number for number, (_, vehicle) in enumerate(row, start=1) if not vehicle.behind]
        for first, last in zip([1, *(end + 1 for end in ends[:-1])], ends, strict=True):
            label = name if len(ends) == 1 else f"{name}.{first}" + (f"-{last}" if last > first else "")
            found[label] = self._section(first, row[first - 1 : last], numbered=last > first or len(ends) == 1)
        return found

    def _section(self, number: int, row: list[tuple[str, TrainVehicle]], *, numbered: bool = True) -> TrainSection:
        """Vehicles from one of a number on, whose parts have their numbers in front of their names, or have not."""
        way, begin = onward(self.travel.speed), middles([vehicle.length for _, vehicle in self.composition])
        first = max(
            wheel.at - middle
            for (_, vehicle), middle in zip(self.composition, begin, strict=True)
            for wheel in vehicle.wheels.values()
        )
        bodies, wheels, springs = dict[str, RigidBody](), dict[str, Wheel](), dict[str, Spring]()
        for k, (_, vehicle) in enumerate(row, start=number):
            ahead = begin[k - 1] + first

            def called(part: str, k: int = k) -> str:
                if part.startswith(NEXT):
                    return f"{k + 1}.{part.removeprefix(NEXT)}"
                return f"{k}.{part}" if numbered else part

            for name, body in vehicle.bodies.items():
                bodies[called(name)] = body.model_copy(update={"at": way * (body.at - ahead)})
            for name, wheel in vehicle.wheels.items():
                wheels[called(name)] = wheel.model_copy(update={"at": way * (wheel.at - ahead)})
            for name, spring in vehicle.springs.items():
                one, two = spring.between
                at = way * (place_of(spring, vehicle.bodies, vehicle.wheels) - ahead)
                springs[called(name)] = spring.model_copy(update={"between": (called(one), called(two)), "at": at})
        travel = Travel.model_construct(
            speed=self.travel.speed, measured=self.travel.measured, start=self.travel.start, at_end="leave"
        )
        return TrainSection.model_construct(
            on=self.on, bodies=bodies, wheels=wheels, springs=springs, travel=travel, gravity=self.gravity,
            lift_off=self.lift_off, onward=way,
        )  # fmt: skip

    @property
    def length(self) -> float:
        """From the first wheel to the last one, m."""
        return self.whole.length

    def starts(self) -> list[Place]:
        """List where its wheels stand at the beginning, also off the line."""
        return self.whole.starts()

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by: none."""
        yield from ()


def on_bogies(vehicle: BogieVehicle) -> TrainVehicle:
    """A vehicle with a body on two bogies, front and rear, on four wheelsets: ten coordinates, those of wheels too."""
    bogies = {"front": vehicle.axles[:2], "rear": vehicle.axles[2:]}
    middle = {name: 0.5 * sum(axles) for name, axles in bogies.items()}
    (k1, c1), (k2, c2) = vehicle.primary, vehicle.secondary
    bodies = {"body": RigidBody(mass=vehicle.body, inertia=vehicle.body_inertia, at=0.5 * sum(middle.values()))}
    springs = {}
    for name, at in middle.items():
        bodies[name] = RigidBody(mass=vehicle.bogie, inertia=vehicle.bogie_inertia, at=at)
        springs[f"{name}-secondary"] = Spring(between=("body", name), stiffness=k2, damping=c2, at=at)
    wheels = {}
    for number, (name, at) in enumerate(((name, at) for name, axles in bogies.items() for at in axles), start=1):
        wheels[f"axle-{number}"] = Wheel(at=at, mass=vehicle.wheelset)
        springs[f"primary-{number}"] = Spring(between=(name, f"axle-{number}"), stiffness=k1, damping=c1)
    return TrainVehicle(length=vehicle.length, bodies=bodies, wheels=wheels, springs=springs)
