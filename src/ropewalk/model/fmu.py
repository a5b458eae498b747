"""FMUs: vehicles of other programs, as the Functional Mock-up Interface packs them (FMI 2.0 and 3.0, co-simulation)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

from pydantic import Field, StrictBool, model_validator

from ropewalk.errors import Refused
from ropewalk.model._base import Declaration, FieldReader, Finding, report
from ropewalk.model.exchange import Exchange
from ropewalk.model.history import SpeedHistory
from ropewalk.model.quantity import Name, Number, Offset, PositiveTime, Station, Way
from ropewalk.model.travel import ON_NETS, AtEnd, Place
from ropewalk.units import LARGEST

Value = bool | int | float | str


@dataclass(frozen=True)
class _Values(FieldReader):
    """Annotation: values of variables by name."""

    def read(self, value: Any) -> dict[str, Value]:
        if not isinstance(value, Mapping):
            raise Refused("expected a block of values", "write  variable: value  in it")
        findings = []
        for name, entry in value.items():
            if not isinstance(name, str):
                remedy = "write it as text"
                findings.append(Finding((str(name),), "not the name of a variable", repr(name)[:60], remedy))
            elif not isinstance(entry, bool | int | float | str):
                remedy = "write a number in the unit of the FMU, true, false, or text"
                findings.append(Finding((name,), "not a value of a variable", repr(entry)[:60], remedy))
            elif isinstance(entry, float | int) and not abs(entry) <= LARGEST:
                findings.append(Finding((name,), "the number is too large, or none", remedy=f"stay below {LARGEST:g}"))
        report("values", findings)
        return dict(value)

    def json_form(self) -> dict[str, Any]:
        return {"type": "object", "additionalProperties": {"type": ["number", "boolean", "string"]}}


Values = Annotated[dict[str, Value], _Values()]


class FmuTravel(Declaration):
    """A prescribed advance: the line pushes or holds the vehicle along as it needs."""

    speed: SpeedHistory = Field(description="a constant, or a table {time, value}; negative: towards the start")
    measured: Literal["material", "horizontal"] = Field(
        default="material", description="coordinate to which the speed refers"
    )
    start: Offset = Field(
        default=0.0, alias="from", description="distance of the vehicle from the start of the line, as measured"
    )
    at_end: AtEnd = Field(
        default="leave", description="at an end of the line a contact leaves it, stops there, or is refused"
    )
    path: Way | None = Field(default=None, description=ON_NETS)


class FmuContact(Declaration):
    """Where an FMU touches the line, and its variables there: what is not named is not handed over."""

    at: Station = Field(default=0.0, description="distance ahead of the place of the vehicle, along its travel")
    gives: Literal["force", "motion"] = Field(
        default="force",
        description="force: the FMU is given the motion of the line and answers with a force; motion: it is given the "
        "force and answers with the height of its contact (needs exchange.stiffness)",
    )
    force: str = Field(description="variable of the vertical force")
    force_along: str | None = Field(default=None, description="variable of the force along x, on the line")
    height: str | None = Field(default=None, description="variable of the height of the contact")
    velocity: str | None = Field(default=None, description="variable of the velocity of the contact, up and down")
    place: str | None = Field(default=None, description="variable that is set to the place along the line")
    height_from: Literal["start", "zero"] = Field(
        default="start", description="reference of heights: the line at the start of the contact, or z = 0"
    )
    force_factor: Number = Field(
        default=-1.0,
        description="the force upwards on the line is the variable times this: -1 for a vehicle above with contact "
        "forces positive in compression, 1 for a pantograph below",
    )
    motion_factor: Number = Field(
        default=1.0, description="the height in m, upwards, is the variable times this: -1 where it counts downwards"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        if self.gives == "motion" and self.height is None:
            remedy = "name the output variable of the height of its contact"
            findings.append(Finding(("height",), "is required by gives: motion", remedy=remedy))
        if self.gives == "motion" and self.force_along is not None:
            wrong, remedy = "is for contacts with gives: force", "leave it out"
            findings.append(Finding(("force_along",), wrong, repr(self.force_along), remedy))
        for key in ("force_factor", "motion_factor"):
            if getattr(self, key) == 0.0:
                findings.append(Finding((key,), "must not be zero", "0", "write 1 or -1"))
        report("contact", findings)
        return self


class Fmu(Declaration):
    """A vehicle of another program, packed as an FMU for co-simulation."""

    kind: Literal["fmu"] = "fmu"
    on: str = Field(description="name of the line or overhead line")
    file: str = Field(description="the .fmu file, looked for from the folder in which the command runs")
    contacts: dict[Name, FmuContact] = Field(description="its contacts, by name")
    travel: FmuTravel = Field(description="motion along the line")
    parameters: Values = Field(default_factory=dict, description="variable: value, set before it begins")
    start_values: Values = Field(
        default_factory=dict, description="variable: value, of inputs and states at the beginning, and kept of inputs"
    )
    every: PositiveTime = Field(default=1e-3, description="interval at which line and FMU exchange (macro step)")
    exchange: Exchange = Field(
        default=Exchange.as_written(), description="exchange of forces and motions between line and FMU"
    )
    isolated: StrictBool = Field(
        default=False, description="run it in a process of its own: a crash of the FMU then ends the run in order"
    )
    patience: PositiveTime = Field(
        default=30.0, description="isolated: wall-clock timeout of an FMU that does not answer"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        if not self.contacts:
            remedy = "add one: name: {force: ..., height: ...}"
            findings.append(Finding(("contacts",), "is empty: the vehicle has no contact with the line", remedy=remedy))
        for name, contact in self.contacts.items():
            if contact.gives == "motion" and not self.exchange.stiffness:
                wrong = f"is required: contact {name} gives its motion, which acts through a contact spring"
                remedy = "give the stiffness of the contact, for example 1e6 N/m"
                findings.append(Finding(("exchange", "stiffness"), wrong, remedy=remedy))
                break
        report("fmu", findings)
        return self

    @property
    def is_motion_given(self) -> bool:
        """Whether contacts give their motion."""
        return any(contact.gives == "motion" for contact in self.contacts.values())

    def starts(self) -> list[Place]:
        """List where its contacts stand at the beginning."""
        way = -1.0 if isinstance(self.travel.speed, float) and self.travel.speed < 0.0 else 1.0
        return [
            Place(name, self.travel.measured, self.travel.start + way * contact.at)
            for name, contact in self.contacts.items()
        ]

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by: none are known."""
        yield from ()
