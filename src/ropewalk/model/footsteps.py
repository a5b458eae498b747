"""Footsteps: a person as a pair of given forces that step along."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

from pydantic import Field, GetCoreSchemaHandler, TypeAdapter, model_validator
from pydantic_core import core_schema

from ropewalk.errors import Refused, did_you_mean
from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.balance import SIDEWAYS, Balance
from ropewalk.model.position import Start
from ropewalk.model.quantity import Angle, Frequency, PositiveLength, PositiveMass, Share, Way
from ropewalk.model.travel import ON_NETS, Place

MOST_OVERLAP = 0.5
FirstFoot = Literal["left", "right"]
LATERAL = {"bachmann": (0.1, 0.1), "setra": (0.05,)}
"""Part of the weight with which people push to the side at f/2, 3f/2, ..., by author."""
YOUNG = (1.0, 2.8)
"""Steps per second for which Young's amplitudes were fitted."""


class Harmonic(Declaration):
    """One term of the force of a person who walks, as part of the weight: amplitude * sin(2 pi i f t - phase)."""

    amplitude: Share = Field(description="as part of the weight")
    phase: Angle = Field(default=0.0, description="lag of the term")


@dataclass(frozen=True)
class _Walk:
    """Annotation: the name of a published model, or a list of harmonics."""

    names: tuple[str, ...]
    optional: bool = False

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        harmonics: TypeAdapter[tuple[Harmonic, ...]] = TypeAdapter(tuple[Harmonic, ...])
        listed = "or a list of {amplitude, phase}"

        def read(value: Any, _: Any) -> Any:
            if value is None and self.optional:
                return None
            if isinstance(value, list | tuple):
                return harmonics.validate_python(value)
            if not isinstance(value, str):
                raise Refused("expected a model of the force", f"write {' or '.join(self.names)}, {listed}")
            if value not in self.names:
                known = f"choose from: {', '.join(self.names)}, {listed}"
                raise Refused("unknown model of the force", did_you_mean(value, self.names, otherwise=known))
            return value

        words = core_schema.literal_schema(list(self.names))
        inner: core_schema.CoreSchema = core_schema.union_schema([words, handler.generate_schema(tuple[Harmonic, ...])])
        if self.optional:
            inner = core_schema.nullable_schema(inner)
        return core_schema.no_info_wrap_validator_function(read, inner)


class Footsteps(Declaration):
    """A person as given forces: two feet that alternate, each at its own place.

    Foot n = 0, 1, 2, ... lands `step_length` beyond the one before at the time (n - phase) / frequency and stays for
    (1 + overlap) / frequency; while two feet stand, the force goes over from one to the other. Together they press
    with mg (1 + sum of a_i sin(2 pi i f t - phase_i)), t from when foot 0 landed, whatever the line does:
    `kind: walker` is who responds. With `lateral` they push to the side of the first foot with
    mg (sum of b_j sin(2 pi (2j - 1) f/2 t - phase_j)), level and across the chord of the line, or across the path on a
    net, each foot with its share: the left one to the left, the right one to the right. With `balance` the person
    responds to how the line moves to the side, and to that alone.
    """

    kind: Literal["footsteps"] = "footsteps"
    on: str = Field(description="name of the line")
    mass: PositiveMass = Field(description="of the person; only its weight acts")
    frequency: Frequency = Field(default=2.0, description="steps per second")
    step_length: PositiveLength = Field(default=0.7, description="from foot to foot, along the unstrained line")
    model: Annotated[Literal["bachmann", "young"] | tuple[Harmonic, ...], _Walk(("bachmann", "young"))] = Field(
        default="young", description="amplitudes of the force: bachmann, young, or a list of {amplitude, phase}"
    )
    lateral: Annotated[
        Literal["bachmann", "setra"] | tuple[Harmonic, ...] | None, _Walk(("bachmann", "setra"), optional=True)
    ] = Field(
        default=None,
        description="amplitudes of the force to the side, at half the frequency of the steps and its odd multiples: "
        "bachmann, setra, or a list of {amplitude, phase}",
    )
    balance: Balance | None = Field(
        default=None,
        description="lateral foot placement, instead of a given lateral force: the times of steps are fixed, their "
        "positions follow the body, which the motion of the line excites",
    )
    first_foot: FirstFoot = Field(default="left", description="the foot that stands at the beginning: left or right")
    phase: Share = Field(default=0.0, description="part of a step that is over at the beginning, below 1")
    overlap: Share = Field(
        default=0.2,
        description="part of a step during which both feet stand, up to 0.5; 0.2 is ordinary walking, in which a foot "
        "stands for 60 % of a stride of two steps (Perry, Gait Analysis, 1992)",
    )
    start: Start = Field(
        default=0.0,
        alias="from",
        description="unstrained length from the start to the first foot; negative: before the line; {x: 5 m} or "
        "middle: as of prescribed travel",
    )
    towards: Literal["end", "start"] = Field(default="end", description="end of the line towards which it steps")
    at_end: Literal["refuse", "leave", "stay", "again"] = Field(
        default="refuse",
        description="at an end of the line a person is refused, leaves the line, stops there, or is replaced by an "
        "equal person at the other end (again); with leave a person may also begin before the line",
    )
    path: Way | None = Field(default=None, description=ON_NETS)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        if self.overlap > MOST_OVERLAP:
            wrong, remedy = "double support lasts at most half a step", "write 0 to 0.5"
            findings.append(Finding(("overlap",), wrong, f"{self.overlap:g}", remedy))
        if self.model == "young" and not YOUNG[0] <= self.frequency <= YOUNG[1]:
            wrong = f"model young is for {YOUNG[0]:g} to {YOUNG[1]:g} steps per second"
            remedy = "write the amplitudes as a list of {amplitude, phase}"
            findings.append(Finding(("frequency",), wrong, f"{self.frequency:g} Hz", remedy))
        if self.phase >= 1.0:
            findings.append(Finding(("phase",), "is a part of one step", f"{self.phase:g}", "write 0 to below 1"))
        if self.lateral and self.balance is not None:
            remedy = "leave one of them out: balance gives the force to the side by itself"
            findings.append(Finding(("balance",), "lateral and balance exclude each other", remedy=remedy))
        report("footsteps", findings)
        return self

    def starts(self) -> list[Place]:
        """List where the first foot stands at the beginning."""
        return [Place("", "material", self.start)]

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by: a direction out of the plane where it pushes to the side."""
        if self.lateral or self.balance is not None:
            yield SIDEWAYS

    @property
    def onward(self) -> float:
        """1 for who walks towards the end of the line, -1 towards its start."""
        return 1.0 if self.towards == "end" else -1.0

    def lateral_harmonics(self) -> tuple[Harmonic, ...]:
        """List the terms of the force to the side: at half the frequency of the steps, 3/2 of it, and so on.

        Bachmann: 0.1 at f/2 and at 3f/2, without a lag (Bachmann, Ammann et al., Vibration Problems in Structures,
        Birkhaeuser 1995, after measurements that Bachmann and Ammann report, Vibrations in Structures, IABSE 1987).
        SETRA: 0.05 at f/2 (Footbridges, technical guide, 2006).
        """
        if self.lateral is None or not isinstance(self.lateral, str):
            return self.lateral or ()
        return tuple(Harmonic(amplitude=amplitude) for amplitude in LATERAL[self.lateral])

    def harmonics(self) -> tuple[Harmonic, ...]:
        """List the terms of the force, the first at the frequency of the steps.

        Bachmann and Ammann: a1 = 0.4 at 2 Hz rising to 0.5 at 2.4 Hz (constant outside), a2 = a3 = 0.1 with a lag of
        pi/2. Young: a1 = 0.41 (f - 0.95) up to 0.56, a2 = 0.069 + 0.0056 * 2f, a3 = 0.033 + 0.0064 * 3f,
        a4 = 0.013 + 0.0065 * 4f; he gives no lags, they are 0 here.
        """
        if not isinstance(self.model, str):
            return self.model
        f = self.frequency
        if self.model == "bachmann":
            first, lag = min(max(0.4 + 0.25 * (f - 2.0), 0.4), 0.5), 1.5707963267948966
            return Harmonic(amplitude=first), *(Harmonic(amplitude=0.1, phase=lag) for _ in range(2))
        first = min(max(0.41 * (f - 0.95), 0.0), 0.56)
        higher = (0.069 + 0.0056 * 2.0 * f, 0.033 + 0.0064 * 3.0 * f, 0.013 + 0.0065 * 4.0 * f)
        return tuple(Harmonic(amplitude=amplitude) for amplitude in (first, *higher))
