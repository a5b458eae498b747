"""Pantographs: masses on springs that press against the contact wire from below."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from ropewalk.errors import Refused, did_you_mean
from ropewalk.model._base import Declaration, FieldReader, Finding, report
from ropewalk.model.head import PantographHead
from ropewalk.model.history import SpeedHistory, SpeedTable
from ropewalk.model.pantographs import PUBLISHED, TARGETS, Published
from ropewalk.model.quantity import (
    AirDrag,
    Masses,
    Offset,
    PositiveForce,
    PositiveStiffness,
    Quantity,
    RampTime,
    StiffnessList,
    Viscosity,
    ViscosityList,
)
from ropewalk.model.travel import Measure, Place
from ropewalk.units import written

LEADING, TRAILING = "leading", "trailing"
"""Strips in results; contacts of the second one have its name behind theirs."""
_LISTS = ("masses", "stiffness", "damping")


class PantographTravel(Declaration):
    """A prescribed advance along x."""

    speed: SpeedHistory = Field(description="a constant, or a table {time, value}; negative: towards the start")
    start: Offset = Field(default=0.0, alias="from", description="horizontal distance from the start of the line")
    at_end: Literal["refuse", "leave"] = Field(
        default="refuse", description="a pantograph that would pass an end of the line is refused, or leaves the line"
    )

    @property
    def measured(self) -> Measure:
        """What the speed counts."""
        return "horizontal"


@dataclass(frozen=True)
class _ForceOrTarget(FieldReader):
    """Annotation: a force, or the name of what a standard asks for."""

    when_written = "json-unless-none"

    def read(self, value: object) -> float | str:
        if isinstance(value, str) and value in TARGETS:
            return value
        if isinstance(value, str) and value[:1].isalpha():
            remedy = did_you_mean(value, TARGETS, otherwise=f"write {', '.join(TARGETS)} or a force such as 150 N")
            raise Refused("no such mean force", remedy)
        return Quantity("N", "positive").read(value)

    def write(self, value: float | str) -> str | float:
        return value if isinstance(value, str) else written(value, "N")

    def json_form(self) -> dict[str, Any]:
        force = Quantity("N", "positive").json_form()
        return {"anyOf": [{"enum": list(TARGETS)}, force]}


@dataclass(frozen=True)
class _FileOrEach(FieldReader):
    """Annotation: the name of a file, or of one for each of several lines."""

    def read(self, value: object) -> str | dict[str, str]:
        each = {"": value} if isinstance(value, str) else value
        if (
            not isinstance(each, dict)
            or not each
            or not all(isinstance(part, str) for pair in each.items() for part in pair)
        ):
            raise Refused(
                "expected the name of a file", "write rough.csv, or {first: one.csv, second: two.csv} by lines"
            )
        return value if isinstance(value, str) else dict(each)

    def json_form(self) -> dict[str, Any]:
        return {"anyOf": [{"type": "string"}, {"type": "object", "additionalProperties": {"type": "string"}}]}


class Pantograph(Declaration):
    """Two or three masses on springs that a force presses against an overhead line from below.

    It is a published one, named by `model`, or given by its masses, springs and dampers. The spring of its base is
    without force where the head stands as high as the contact wire at the supports; weights are not counted, the
    static force is the remainder of the raising force.
    """

    kind: Literal["pantograph"] = "pantograph"
    on: str = Field(description="name of the overhead line")
    model: str | None = Field(
        default=None, description=f"name of a published pantograph: {', '.join(PUBLISHED)}; or give masses and springs"
    )
    masses: Masses | None = Field(default=None, description="two or three, from the base to the head")
    stiffness: StiffnessList | None = Field(
        default=None, description="of the spring below each mass; the first stands on the roof and may be 0"
    )
    damping: ViscosityList | None = Field(default=None, description="of the damper parallel to each spring")
    travel: PantographTravel = Field(description="motion along the line")
    static_force: PositiveForce | None = Field(
        default=None, description="upwards on the lowest mass (default: that of the published pantograph)"
    )
    aerodynamic: AirDrag = Field(default=0.0, description="uplift aerodynamic * speed^2, added to the static force")
    aerodynamic_on: Literal["frame", "head"] = Field(default="frame", description="mass on which the uplift acts")
    mean_force: Annotated[float | str, _ForceOrTarget()] | None = Field(
        default=None,
        description="target mean contact force, instead of static and aerodynamic force: a value, or that of a "
        f"standard at its speed: {', '.join(TARGETS)}",
    )
    ramp: RampTime = Field(default=0.3, description="time in which all forces on it grow to their full size")
    contact_stiffness: PositiveStiffness = Field(default=50e3, description="of head and contact wire")
    contact_damping: Viscosity = Field(default=0.0, description="of head and contact wire")
    head: PantographHead | None = Field(
        default=None, description="strips, pitch and roll of the head (default: it is a point)"
    )
    irregularity: Annotated[str | dict[str, str], _FileOrEach()] | None = Field(
        default=None,
        description="name of a file with rows `x, z` in m: how much lower the head feels the contact wire to be (z < 0)"
        " or higher (z > 0) at x from the start of the line, linear in between; or of such files by the names of lines "
        "that overlap",
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        report("pantograph", [*(self._published() if self.model is not None else self._own()), *self._forces()])
        return self

    def starts(self) -> list[Place]:
        """List where it stands at the beginning."""
        return [Place(name, self.travel.measured, self.travel.start + ahead) for name, ahead in self.strips.items()]

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by: none."""
        yield from ()

    @property
    def parts(self) -> Published:
        """Its masses, springs and force, published or own; the force is a mean force if that is a name."""
        if self.model is not None:
            return PUBLISHED[self.model]
        masses, stiffness, damping = self.masses or (), self.stiffness or (), self.damping or ()
        return Published(masses, stiffness, damping, self.contact_stiffness, 0.0, "the scenario")

    @property
    def strips(self) -> dict[str, float]:
        """How far ahead of its middle, towards the end of the line, each strip is, m, by name; one has none."""
        if self.head is None or self.head.spacing is None:
            return {"": 0.0}
        half = 0.5 * self.head.spacing
        return {"": -half, TRAILING: half} if self.fastest < 0.0 else {"": half, TRAILING: -half}

    @property
    def fastest(self) -> float:
        """Its largest speed either way, m/s; of one that is a function of time, which goes ahead, 0."""
        speed = self.travel.speed
        found = max(speed.value, key=abs) if isinstance(speed, SpeedTable) else speed
        return found if isinstance(found, float) else 0.0

    @property
    def irregularities(self) -> dict[str, str]:
        """Names of files with irregularities, by lines."""
        given = self.irregularity or {}
        return {self.on: given} if isinstance(given, str) else given

    @property
    def wanted_mean(self) -> float | str | None:
        """Wanted mean contact force: N, or a name; None where forces are given instead."""
        if self.mean_force is not None or self.static_force is not None:
            return self.mean_force
        force = self.parts.force
        return force if isinstance(force, str) else None

    @property
    def pressed_with(self) -> float:
        """Static force, N."""
        force = self.parts.force if self.static_force is None else self.static_force
        return 0.0 if isinstance(force, str) or self.mean_force is not None else force

    def _published(self) -> Iterator[Finding]:
        if self.model not in PUBLISHED:
            remedy = did_you_mean(str(self.model), PUBLISHED)
            yield Finding(("model",), "no such published pantograph", repr(self.model), remedy)
        for key in _LISTS:
            if getattr(self, key) is not None:
                remedy = f"leave model out and give {', '.join(_LISTS)}, or leave {key} out"
                yield Finding((key,), f"the published pantograph {self.model} has its own", remedy=remedy)

    def _own(self) -> Iterator[Finding]:
        missing = [key for key in _LISTS if getattr(self, key) is None]
        if len(missing) == len(_LISTS):
            wrong = "the pantograph is not determined"
            remedy = f"add model ({' or '.join(PUBLISHED)}), or masses, stiffness and damping"
            yield Finding((), wrong, remedy=remedy)
            return
        for key in missing:
            remedy = f"add {key}: one value for each mass, from the base to the head"
            yield Finding((key,), "is required", remedy=remedy)
        if self.masses is not None and len(self.masses) not in (2, 3):
            count = f"{len(self.masses)} mass{'es' if len(self.masses) > 1 else ''}"
            yield Finding(
                ("masses",), "must be two or three", count, "give those of frame and head, or of two arms and the head"
            )
        elif self.masses is not None:
            for key in ("stiffness", "damping"):
                values = getattr(self, key)
                if values is not None and len(values) != len(self.masses):
                    given, remedy = f"{len(values)} for {len(self.masses)} masses", f"give {len(self.masses)} values"
                    yield Finding((key,), "does not go with the masses", given, remedy)
        for i, stiffness in enumerate(self.stiffness or ()):
            if i and stiffness == 0.0:
                remedy = "give the spring below this mass a stiffness; only the first, on the roof, may be 0"
                yield Finding(("stiffness", i), "the mass has no support", "0 N/m", remedy)

    def _forces(self) -> Iterator[Finding]:
        if self.aerodynamic_on == "head" and not self.aerodynamic:
            wrong, remedy = "there is no uplift", "add aerodynamic, or leave aerodynamic_on out"
            yield Finding(("aerodynamic_on",), wrong, self.aerodynamic_on, remedy)
        if self.mean_force is not None:
            for key in ("static_force", "aerodynamic"):
                if getattr(self, key):
                    remedy = f"give mean_force alone, or static_force and aerodynamic: leave {key} or mean_force out"
                    yield Finding((key,), "mean_force takes its place", f"{getattr(self, key):g}", remedy)
        elif self.static_force is None and self.model is None:
            remedy = "add static_force, for example 120 N, or mean_force, for example ac"
            yield Finding(("static_force",), "is required: no force acts upwards on the pantograph", remedy=remedy)
        elif self.static_force is None and self.aerodynamic:
            published = PUBLISHED.get(self.model or "")
            if published is not None and isinstance(published.force, str):
                wrong = f"the pantograph {self.model} is pressed with the mean force {published.force}"
                remedy = "add static_force, or leave aerodynamic out"
                yield Finding(("aerodynamic",), wrong, f"{self.aerodynamic:g} kg/m", remedy)
