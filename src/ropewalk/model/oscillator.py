"""Oscillators: a mass on a spring on a wheel."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.contact import CONTACT_STIFFNESS, LIFT_OFF, SIDE, Side, one_sided, soft_contact
from ropewalk.model.quantity import AirDrag, Mass, PositiveMass, PositiveStiffness, Stiffnesses, Viscosities
from ropewalk.model.travel import AnyTravel, FreeTravel, Place


class Oscillator(Declaration):
    """A mass on springs and dampers on a wheel that runs on the line."""

    kind: Literal["oscillator"] = "oscillator"
    on: str = Field(description="name of the line")
    mass: PositiveMass = Field(description="on the springs")
    stiffness: Stiffnesses = Field(
        description="of the springs, one value for all directions or [kx, kz], in space [kx, ky, kz]"
    )
    damping: Viscosities = Field(
        default=0.0, description="of the dampers, one value or [cx, cz], in space [cx, cy, cz]"
    )
    wheel_mass: Mass = Field(default=0.0, description="of the wheel; a free travel needs it")
    travel: AnyTravel = Field(description="motion of its wheel along the line, prescribed or free")
    lift_off: bool = Field(default=False, description=LIFT_OFF)
    side: Side = Field(default="above", description=SIDE)
    contact_stiffness: PositiveStiffness | None = Field(default=None, description=CONTACT_STIFFNESS)
    air_drag: AirDrag = Field(
        default=0.0, description="coefficient of the force air_drag |v| v, v: velocity of the air relative to the mass"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = soft_contact(("contact_stiffness",), self.contact_stiffness, lift_off=self.lift_off)
        findings += one_sided(self.side, lift_off=self.lift_off)
        if self.contact_stiffness is not None:
            findings += self._upright()
        if isinstance(self.travel, FreeTravel) and not self.wheel_mass:
            remedy = "add wheel_mass, for example a hundredth of mass, or prescribe the travel"
            findings.append(Finding(("wheel_mass",), "is required for free travel", remedy=remedy))
        report("oscillator", findings)
        return self

    def _upright(self) -> Iterator[Finding]:
        """What goes with motion in all directions, which a soft contact does not let the mass have."""
        wrong = "with contact_stiffness the mass moves up and down only"
        for key in ("stiffness", "damping"):
            value = getattr(self, key)
            if isinstance(value, tuple):
                yield Finding((key,), wrong, str(list(value)), f"write {value[-1]:g}, or leave contact_stiffness out")
        if self.air_drag:
            remedy = "leave air_drag or contact_stiffness out"
            yield Finding(("air_drag",), wrong, f"{self.air_drag:g} kg/m", remedy)
        if isinstance(self.travel, FreeTravel):
            remedy = "give its speed and leave kind out, or leave contact_stiffness out"
            yield Finding(("travel", "kind"), f"{wrong}, and its place is prescribed", "free", remedy)

    def starts(self) -> list[Place]:
        """List where its wheel stands at the beginning."""
        return [Place("", self.travel.measured, self.travel.start)]

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by: none."""
        yield from ()
