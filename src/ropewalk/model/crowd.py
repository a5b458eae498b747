"""Crowds: many people who walk on one line, each with a gait of her own."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.balance import SIDEWAYS, Balance
from ropewalk.model.footsteps import YOUNG, Footsteps
from ropewalk.model.quantity import Count, Frequency, Way
from ropewalk.model.spread import FrequencySpread, LengthSpread, MassSpread
from ropewalk.model.travel import ON_NETS, Place

MOST = 1000
"""People of a crowd."""


class Crowd(Declaration):
    """Many people on a line, each of them `footsteps` with a mass, a gait and a place that a seed decides.

    Places, instants within the first step and first feet are evenly random; masses, step frequencies and step lengths
    are normally distributed and independent of each other. They neither hinder nor follow one another. The same seed
    gives the same people everywhere, and more of them are those and further ones.
    """

    kind: Literal["crowd"] = "crowd"
    on: str = Field(description="name of the line")
    number: Annotated[int, Count(1, MOST)] = Field(
        description="number of people: on the line at first, or arriving at `rate`"
    )
    seed: Annotated[int, Count(0, 2**31 - 1)] = Field(default=1, description="of all that is random")
    mass: MassSpread = Field(
        default=MassSpread.as_written(mean=75.0, deviation=15.0),
        description="of each; 75 kg is usual for loads on footbridges",
    )
    frequency: FrequencySpread = Field(
        default=FrequencySpread.as_written(mean=1.87, deviation=0.186),
        description="steps per second (Zivanovic, Pavic and Reynolds, Eng. Struct. 29, 942, 2007)",
    )
    step_length: LengthSpread = Field(
        default=LengthSpread.as_written(mean=0.71, deviation=0.071), description="from foot to foot (the same source)"
    )
    model: Literal["bachmann", "young"] = Field(default="young", description="amplitudes of the vertical force")
    lateral: Literal["bachmann", "setra"] | None = Field(
        default=None, description="amplitudes of a given force to the side, or give `balance`"
    )
    balance: Balance | None = Field(
        default=None, description="lateral foot placement: people respond to a line that sways"
    )
    spread: Literal["random", "even"] = Field(
        default="random", description="distribution of the people along the line, or of their arrivals at `rate`"
    )
    rate: Frequency | None = Field(
        default=None, description="arrivals of people per second (default: all are on the line from the beginning)"
    )
    towards: Literal["end", "start", "both"] = Field(
        default="end", description="end of the line towards which they walk; both: each of them towards either"
    )
    at_end: Literal["again", "leave"] | None = Field(
        default=None,
        description="leave: people leave the line at its end; again: each is replaced by an equal person at the "
        "other end, so that their number is constant (default: again; with a rate: leave)",
    )
    path: Way | None = Field(default=None, description=ON_NETS)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings, steps = [], self.frequency
        if self.model == "young" and not YOUNG[0] <= steps.least <= steps.most <= YOUNG[1]:
            wrong = f"model young is for {YOUNG[0]:g} to {YOUNG[1]:g} steps per second"
            given = f"{steps.least:.3g} to {steps.most:.3g} Hz, three deviations to both sides"
            findings.append(Finding(("frequency",), wrong, given, "write model: bachmann, or a smaller deviation"))
        if self.lateral is not None and self.balance is not None:
            remedy = "leave one of them out: balance gives the force to the side by itself"
            findings.append(Finding(("balance",), "lateral and balance exclude each other", remedy=remedy))
        if self.rate is not None and self.at_end == "again":
            remedy = "leave rate out to keep their number, or write at_end: leave"
            findings.append(Finding(("at_end",), "people that arrive at a rate also leave", "again", remedy))
        report("crowd", findings)
        return self

    def people(self, length: float) -> list[Footsteps]:
        """All of them on a line, or on a way over a net, of a length in m.

        Every person takes eight numbers of the Mersenne twister, whose `random` is the same on all machines.
        """
        numbers, arrived, found = random.Random(self.seed), 0.0, []
        for i in range(self.number):
            heavy, quick, wide, place, phase, foot, way, wait = (numbers.random() for _ in range(8))
            frequency, step = self.frequency.at(quick), self.step_length.at(wide)
            onward = self.towards if self.towards != "both" else ("end" if way < 0.5 else "start")
            even = self.spread == "even"
            start = length * ((i + 0.5) / self.number if even else place)
            if self.rate is not None:
                arrived += (1.0 if even else -math.log1p(-wait)) / self.rate
                before = frequency * step * arrived
                start = -before if onward == "end" else length + before
            found.append(
                Footsteps(
                    on=self.on, mass=self.mass.at(heavy), frequency=frequency, step_length=step, model=self.model,
                    lateral=self.lateral, balance=self.balance, phase=phase,
                    first_foot="left" if foot < 0.5 else "right", start=start, towards=onward, at_end=self._at_end,
                    path=self.path,
                )
            )  # fmt: skip
        return found

    @property
    def _at_end(self) -> Literal["again", "leave"]:
        return self.at_end or ("again" if self.rate is None else "leave")

    def starts(self) -> list[Place]:
        """List where it begins: that of each person is asked of her."""
        return []

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by: a direction out of the plane where they push to the side."""
        if self.lateral is not None or self.balance is not None:
            yield SIDEWAYS


def is_one_of_many(name: str) -> bool:
    """Whether the load of a name is a person of a crowd: no name in a scenario has a dot."""
    return "." in name
