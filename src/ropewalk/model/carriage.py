"""Carriages of ropeways: wheels on rockers, a cabin that swings below, a hauling rope."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from ropewalk.errors import Refused
from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.contact import LIFT_OFF
from ropewalk.model.course import course
from ropewalk.model.history import SpeedHistory
from ropewalk.model.quantity import (
    AirDrag,
    Angle,
    AxialDamping,
    Count,
    FrictionCoefficient,
    Inertia,
    Lengths,
    LinearMass,
    Offset,
    PositiveForce,
    PositiveLength,
    PositiveMass,
    RotationalDamping,
    TurnAngle,
)
from ropewalk.model.run import Dynamic
from ropewalk.model.travel import FreeTravel, Place

MOST_LEVELS = 4
_LARGEST_EXPONENT = 700.0  # exponent of the largest number
"""Levels of rockers, one above the other: 16 wheels."""


class Cabin(Declaration):
    """A cabin on a rigid hanger that turns about the middle of the carriage, along the line and to the side."""

    mass: PositiveMass = Field(description="with its hanger and passengers")
    hanger: PositiveLength = Field(description="from the pivot at the carriage down to the centre of gravity")
    inertia: Inertia = Field(default=0.0, description="moment of inertia about the centre of gravity")
    damping: RotationalDamping = Field(
        default=0.0, description="of the damper between hanger and main rocker: moment over rate of the angle"
    )
    swing: Angle = Field(default=0.0, description="angle of the hanger from the vertical at the start, towards +x")
    air_drag: AirDrag = Field(default=0.0, description="force air_drag |v| v, v: relative velocity of the air")
    floor: Offset = Field(
        default=0.0, description="distance of its lowest point below the centre of gravity, for the clearance"
    )


class CounterRope(Declaration):
    """A counter rope from the carriage to the other end of its line, where a weight keeps its tension.

    At the carriage it pulls with its tension and `mass` * g * height, and its mass moves along; the inertia of the
    weight and of the rope beyond the station is left out.
    """

    tension: PositiveForce = Field(description="at the station, half of the weight of a sheave that it runs around")
    mass: LinearMass = Field(default=0.0, description="per length")
    axial_stiffness: PositiveForce | None = Field(
        default=None, description="its EA, which accelerates its mass (default: that of the hauling rope)"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.axial_stiffness is not None and not self.mass:
            wrong = "a counter rope without mass has no mass to accelerate"
            remedy = "give its mass, or leave axial_stiffness out"
            finding = Finding(("axial_stiffness",), wrong, f"{self.axial_stiffness:g} N", remedy)
            report("counter rope", [finding])
        return self


class DriveSheave(Declaration):
    """The sheave of the drive: the rope runs around it and back to the weight of the counter rope.

    It slips where one side pulls more than e^(friction wrap) times the other (Euler, Eytelwein), and holds that ratio
    while it does.
    """

    friction: FrictionCoefficient = Field(description="coefficient between rope and lining")
    wrap: TurnAngle = Field(description="angle by which the rope lies on it, for example 180 deg")

    @property
    def slip_ratio(self) -> float:
        """Ratio of the tensions of both sides from which on the rope slips."""
        return math.exp(min(self.friction * self.wrap, _LARGEST_EXPONENT))


class Haul(Declaration):
    """A hauling rope from the carriage along the line to a drive at one of its ends: an elastic rope that pulls.

    It is stretched between carriage and drive along the track rope, on rollers; its `mass` moves with it, and adds
    `mass` * g * height to the tension at the drive. With `sags` it hangs freely between the carriage, the saddles or
    inner supports of the line and the station: it is softer by that, and weighs on the carriage.
    """

    to: Literal["start", "end"] = Field(default="end", description="end of the line where the drive stands")
    speed: SpeedHistory | None = Field(
        default=None, description="at which the drive takes the rope in, a constant or a table {time, value}"
    )
    over_to: str | None = Field(
        default=None,
        description="name of another carriage, to which the rope runs on over a pulley that turns freely, instead of "
        "a speed: both carriages have opposite speeds",
    )
    axial_stiffness: PositiveForce = Field(description="EA of the rope")
    axial_damping: AxialDamping = Field(default=0.0, description="Kelvin-Voigt c of the rope")
    mass: LinearMass = Field(default=0.0, description="per length")
    elements: Annotated[int, Count(1, 1000)] | None = Field(
        default=None, description="masses that move with it, if it has `mass`: the more, the shorter its waves (4)"
    )
    beyond: Offset = Field(default=0.0, description="length of the rope between the end of the line and the drive")
    sags: bool = Field(
        default=False,
        description="whether it hangs freely between carriage, towers and station, and its counter rope as well; "
        "towers are `saddles` or `supports` of the line",
    )
    counter: CounterRope | None = Field(
        default=None, description="rope to the other end, of both carriages with over_to"
    )
    sheave: DriveSheave | None = Field(default=None, description="of the drive, on which it may slip")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        if (self.speed is None) == (self.over_to is None):
            wrong = "needs either a speed of its drive or a carriage at its other end"
            findings.append(Finding(("speed",), wrong, remedy="give speed, or over_to, and not both"))
        if self.sags and self.over_to is not None:
            wrong, remedy = "a rope to another carriage does not hang freely here", "leave sags out"
            findings.append(Finding(("sags",), wrong, remedy=remedy))
        if self.sags and not self.mass:
            findings.append(Finding(("mass",), "a rope without weight does not sag", remedy="give its mass"))
        if self.elements is not None and not self.mass:
            wrong = "a rope without mass has none that move with it"
            findings.append(Finding(("elements",), wrong, str(self.elements), "give its mass, or leave elements out"))
        if self.sheave is not None and (self.counter is None or self.over_to is not None):
            wrong = "the tension on its other side is not given" if self.counter is None else "it turns freely there"
            findings.append(Finding(("sheave",), wrong, remedy="give counter and speed, or leave sheave out"))
        report("haul", findings)
        return self


def _levels(value: tuple[float, ...]) -> tuple[float, ...]:
    if not 1 <= len(value) <= MOST_LEVELS:
        wrong, remedy = f"has {len(value)} levels of rockers", f"write 1 to {MOST_LEVELS} lengths: 2 to 16 wheels"
        raise Refused(wrong, remedy, given=str(list(value)))
    return value


def _rolls(value: Any) -> Any:
    kind = value.get("kind", "prescribed") if isinstance(value, dict) else getattr(value, "kind", None)
    if kind != "free":
        wrong = "a carriage rolls on its track rope as forces move it"
        remedy = "write kind: free with from, and haul with its speed, or a driver or drive"
        report("travel", [Finding(("kind",), wrong, str(kind), remedy)])
    return value


class Carriage(Declaration):
    """A carriage on 2, 4, 8 or 16 wheels on rockers, with a swinging cabin: a ropeway, a cable crane.

    Each rocker bears two smaller ones, or two wheels, at its ends and turns about its middle, so that all wheels bear
    alike. All moves in the plane of the line and to the side. Wheels roll without friction but for `rolling`; what
    moves them is the slope, the hauling rope, or a drive, driver or brake of `travel`, which push against the line. A
    driver acts at one wheel near the middle, drive, brake and viscous resistance at all alike.
    """

    kind: Literal["carriage"] = "carriage"
    on: str = Field(description="name of the line")
    mass: PositiveMass = Field(description="of the carriage with its wheels, without the cabin")
    wheel_mass: PositiveMass | None = Field(
        default=None, description="of each wheel (default: all wheels are half of the mass); rockers are the rest"
    )
    rockers: Annotated[Lengths, AfterValidator(_levels)] = Field(
        description="lengths of rockers between their ends, from those that bear two wheels up to the main one: one "
        "length for 2 wheels, two for 4, three for 8, four for 16"
    )
    cabin: Cabin | None = Field(default=None, description="pendulum below the carriage")
    haul: Haul | None = Field(default=None, description="hauling rope that moves it")
    travel: Annotated[FreeTravel, BeforeValidator(_rolls)] = Field(
        description="kind: free; `from` is where its middle starts; `speed` at the beginning is that of the hauling "
        "rope if there is one"
    )
    lift_off: bool = Field(default=False, description=LIFT_OFF)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        for level in range(1, len(self.rockers)):
            if self.rockers[level] <= sum(self.rockers[:level]):
                wrong = f"the rockers below reach {sum(self.rockers[:level]):g} m and would overlap"
                remedy = "write lengths that rise, each longer than all before it together"
                findings.append(Finding(("rockers", level), wrong, f"{self.rockers[level]:g} m", remedy))
        if self.wheel_mass is not None and self.wheel_mass * self.count >= self.mass:
            wrong = f"{self.count} wheels weigh as much as the carriage, and nothing is left for rockers"
            findings.append(
                Finding(("wheel_mass",), wrong, f"{self.wheel_mass:g} kg", f"below {self.mass:g} kg in all")
            )
        travel = self.travel
        if self.haul is not None and travel.driver is not None:
            wrong, remedy = "a driver and a hauling rope exclude each other", "leave one of them out"
            findings.append(Finding(("travel", "driver"), wrong, remedy=remedy))
        if self.haul is not None and travel.speed:
            wrong, remedy = "the hauling rope gives the speed", "leave it out"
            findings.append(Finding(("travel", "speed"), wrong, f"{travel.speed:g} m/s", remedy))
        if travel.at_end == "leave":
            wrong, remedy = "a carriage cannot leave its line", "write stay or refuse, or end the run before"
            findings.append(Finding(("travel", "at_end"), wrong, "leave", remedy))
        report("carriage", findings)
        return self

    @property
    def count(self) -> int:
        """Number of wheels."""
        return int(2 ** len(self.rockers))

    @property
    def places(self) -> tuple[float, ...]:
        """Places of the wheels, from the last one to the first, m ahead of the middle."""
        found = [0.0]
        for length in reversed(self.rockers):
            found = [at + side * 0.5 * length for at in found for side in (-1.0, 1.0)]
        return tuple(found)

    @property
    def of_wheel(self) -> float:
        """Mass of each wheel, kg."""
        return self.wheel_mass if self.wheel_mass is not None else 0.5 * self.mass / self.count

    @property
    def whole(self) -> float:
        """Mass of everything, kg."""
        return self.mass + (self.cabin.mass if self.cabin is not None else 0.0)

    def starts(self) -> list[Place]:
        """List where its wheels stand at the beginning."""
        return [Place(str(i), "material", self.travel.start + at) for i, at in enumerate(self.places, start=1)]

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by: none."""
        yield from ()


def _taken_in(name: str, load: Carriage, haul: Haul, length: float, run: Any) -> Iterator[Finding]:
    """Find drives that take in more rope than there is between carriage and drive."""
    speed = haul.speed
    if not isinstance(run, Dynamic) or callable(speed) or speed is None:
        return
    there = haul.beyond + (length - load.travel.start if haul.to == "end" else load.travel.start)
    most = max(piece.place(piece.begin + piece.duration) for piece in course(speed, 0.0, run.until))
    if most >= there:
        wrong = f"takes in {most:.4g} m of rope until {run.until:g} s, and {there:.4g} m are there"
        yield Finding(("loads", name, "haul", "speed"), wrong, remedy="let it stop before, or end the run before")


def _hangs(name: str, haul: Haul, line: Any, gravity: float) -> Iterator[Finding]:
    """Find counter ropes that would hang to the ground."""
    counter = haul.counter
    if counter is not None and counter.tension <= (weight := counter.mass * gravity * line.distance):
        wrong = f"less than the weight of the rope, {weight:.4g} N: its sag would be too large, or it would fall"
        path = ("loads", name, "haul", "counter", "tension")
        yield Finding(path, wrong, f"{counter.tension:.4g} N", "give it more tension")


def check_carriages(parts: Any) -> Iterator[Finding]:
    """Find hauling ropes without an end, and wheels that would be off their line."""
    drawn = set[str]()  # what ropes over pulleys run to
    for name, load in parts.loads.items():
        if not isinstance(load, Carriage):
            continue
        if load.on in parts.nets or load.on in parts.overhead:
            wrong = "a carriage rolls along a rope, and neither nets nor overhead lines are one"
            yield Finding(("loads", name, "on"), wrong, load.on, "name one of lines")
            continue
        line = parts.lines.get(load.on)
        first, last = load.starts()[0].start, load.starts()[-1].start
        if line is not None and (first <= 0.0 or last >= (line.length or line.distance)):
            wrong = f"its wheels would be at {first:g} to {last:g} m, beyond the end of {load.on}"
            yield Finding(
                ("loads", name, "travel", "from"), wrong, f"{load.travel.start:g} m", "start further from the ends"
            )
        if load.haul is not None and load.haul.speed is not None and line is not None:
            yield from _taken_in(name, load, load.haul, line.length or line.distance, parts.run)
        if load.haul is not None and line is not None:
            yield from _hangs(name, load.haul, line, parts.gravity)
        if load.haul is None or load.haul.over_to is None:
            continue
        path, other = ("loads", name, "haul", "over_to"), parts.loads.get(load.haul.over_to)
        if load.haul.over_to == name or (load.haul.over_to in parts.loads and not isinstance(other, Carriage | None)):
            yield Finding(path, "is no other carriage", load.haul.over_to, "name another load of kind carriage")
        elif load.haul.over_to not in parts.loads:
            yield Finding(path, "no such load", load.haul.over_to, "name another load of kind carriage")
        elif other is not None and (other.haul is not None or load.haul.over_to in drawn):
            wrong, remedy = "that carriage has another hauling rope", "give each carriage one hauling rope"
            yield Finding(path, wrong, load.haul.over_to, remedy)
        elif other is not None and other.travel.driver is not None:
            wrong, remedy = "that carriage has a driver, which this rope would pull at", "leave the driver out"
            yield Finding(path, wrong, load.haul.over_to, remedy)
        drawn.add(load.haul.over_to)
