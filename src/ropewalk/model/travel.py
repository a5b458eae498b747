"""Travel: how a load advances along its line."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, NamedTuple, Self

from pydantic import BeforeValidator, Field, model_validator

from ropewalk.model._base import Declaration, Finding, Variants, report
from ropewalk.model.contact import FrictionModel
from ropewalk.model.history import DriveHistory, SpeedHistory
from ropewalk.model.position import Start, StartOffset
from ropewalk.model.quantity import (
    FrictionCoefficient,
    PositiveForce,
    PositiveLength,
    PositiveStiffness,
    PositiveViscosity,
    Speed,
    Viscosity,
    Way,
)

Measure = Literal["material", "slip", "arc", "horizontal"]
"""What the speed counts: dxi/dt, (1 + mean eps) dxi/dt, arc length from the start, or x."""
AtEnd = Literal["refuse", "leave", "stay"]

_MARGIN = (
    "distance from a support, along the unstrained line, at which the line ends for the load "
    "(default: a quarter of a link for loads with a mass, 0 for forces and on nets)"
)
ON_NETS = "on nets: points [u, v] of its path, straight in between"


class Place(NamedTuple):
    """Where a wheel or foot of a load stands at the beginning."""

    label: str  # of the wheel, empty where a load has only one
    measured: Measure
    start: float  # m from the start of the line


class Course(Declaration):
    """A prescribed advance: speed and its measure."""

    kind: Literal["prescribed"] = Field(default="prescribed", json_schema_extra={"optional": True})
    speed: SpeedHistory = Field(description="a constant, or a table {time, value}; negative: towards the start")
    measured: Measure = Field(default="material", description="coordinate to which the speed refers")


class Travel(Course):
    """A prescribed advance: speed, its measure, where it begins, what happens at the end of the line."""

    start: Start = Field(
        default=0.0,
        alias="from",
        description="distance from the start of the line: material length for `material`, arc length in equilibrium "
        "for `slip` and `arc`, horizontal distance for `horizontal`; negative: before the line, for "
        "vehicles that roll on to it and leave it at its end; {x: 5 m} or middle: the point of the line "
        "at that x, or at midspan, in the initial state",
    )
    at_end: AtEnd = Field(
        default="refuse",
        description="at an end of the line a load is refused, leaves the line, or stops there",
    )
    margin: PositiveLength | None = Field(default=None, description=_MARGIN)
    path: Way | None = Field(default=None, description=ON_NETS)


class Driver(Declaration):
    """A controller that holds a speed by a force of limited size."""

    speed: SpeedHistory = Field(description="to hold, along the line: a constant, or a table {time, value}")
    force: PositiveForce = Field(description="the most it can push or brake with")


class Brake(Declaration):
    """A brake near the ends of a line: blocks, eddy currents or a spring between the load and the line.

    `force` alone is friction: a constant force against the motion, as long as there is one. With `rate` the force is in
    proportion to the speed, as that of an eddy-current brake below its critical speed, and `force` the most that it is.
    `stiffness` is that of a spring or bungee that the load meets where the brake begins, and that pushes it back.
    """

    force: PositiveForce | None = Field(
        default=None, description="with which it brakes; with `rate` the most of that, and without it there is no limit"
    )
    rate: PositiveViscosity | None = Field(default=None, description="force over speed of an eddy-current brake")
    stiffness: PositiveStiffness | None = Field(default=None, description="of a spring that is free where it begins")
    within: PositiveLength = Field(description="distance from the end of the line, along it, where it acts")
    at: Literal["start", "end", "both"] = Field(default="end", description="end of the line at which it acts")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.force is None and self.is_blocks:
            remedy = "give force, rate (force over speed) or stiffness (of a spring)"
            report("brake", [Finding((), "the brake has no force", remedy=remedy)])
        return self

    @property
    def is_blocks(self) -> bool:
        """Whether it has no other force than a constant one."""
        return self.rate is None and self.stiffness is None


class FreeTravel(Declaration):
    """A free advance: the load moves along the line as the forces on it demand.

    These are its weight, the line's own push, friction, resistance and drag, a drive, a driver and a brake. Friction
    and rolling resistance act together: the first grows with the bend of the line around the contact, the second with
    the contact force, rolling * |contact force|.
    """

    kind: Literal["free"] = "free"
    start: StartOffset = Field(
        default=0.0,
        alias="from",
        description="unstrained length from the start of the line; {x: 5 m} or middle: as of prescribed travel",
    )
    speed: Speed = Field(default=0.0, description="at the beginning, along the line; negative: towards the start")
    friction: FrictionCoefficient = Field(default=0.0, description="coefficient of the sliding contact")
    friction_model: FrictionModel = Field(
        default="capstan",
        description="capstan: the line bends around the contact, T2/T1 = exp(mu angle); "
        "block: a point, |T2 - T1| = mu (T1 + T2) tan(angle/2)",
    )
    rolling: FrictionCoefficient = Field(default=0.0, description="coefficient of rolling resistance")
    viscous: Viscosity = Field(default=0.0, description="resistance proportional to the speed along the line")
    drive: DriveHistory = Field(
        default=0.0, description="force along the line on the load: a constant, or a table {time, value}"
    )
    driver: Driver | None = Field(default=None, description="controller that holds a speed, in addition to the drive")
    brake: Brake | None = Field(default=None, description="brake near the end of the line")
    at_end: AtEnd = Field(
        default="stay",
        description="at an end of the line a load is refused, leaves the line, or is stopped there",
    )
    margin: PositiveLength | None = Field(default=None, description=_MARGIN)
    path: Way | None = Field(default=None, description=ON_NETS)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.friction_model != "capstan" and not self.friction:
            wrong = "a model of friction without a coefficient"
            remedy = "add friction, for example 0.3, or leave it out"
            report("free travel", [Finding(("friction_model",), wrong, self.friction_model, remedy)])
        return self

    @property
    def measured(self) -> Measure:
        """What `from` counts."""
        return "material"


AnyTravel = Annotated[Travel | FreeTravel, Variants("travel", default="prescribed")]
"""Any travel; one without `kind` is prescribed."""


def prescribed_only(why: str) -> BeforeValidator:
    """Make the annotation of a travel that must be prescribed, with the reason as a sentence."""

    def read(value: Any) -> Any:
        kind = value.get("kind") if isinstance(value, Mapping) else getattr(value, "kind", None)
        if kind == "free":
            report("travel", [Finding(("kind",), why, "free", "write a travel with its speed, and leave kind out")])
        return value

    return BeforeValidator(read)
