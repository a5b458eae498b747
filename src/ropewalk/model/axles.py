"""Axles: the loads of a train as given forces that travel together, written down or built in by name."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache
from itertools import pairwise
from typing import Annotated, ClassVar, Literal, NamedTuple, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.history import SpeedHistory, SpeedTable
from ropewalk.model.quantity import AxleForces, Count, PositiveLength, Station, Stations
from ropewalk.model.train_sets import MeasuredTrainName, SprungTrainName, axle_loads
from ropewalk.model.travel import AtEnd, Course, Measure, Place

MOST = 1000
"""Axles of a train."""

UniversalTrainName = Literal[
    "HSLM-A1", "HSLM-A2", "HSLM-A3", "HSLM-A4", "HSLM-A5", "HSLM-A6", "HSLM-A7", "HSLM-A8", "HSLM-A9", "HSLM-A10"
]
TrainName = Literal[UniversalTrainName, SprungTrainName, MeasuredTrainName]


class _Universal(NamedTuple):
    """A universal train of EN 1991-2, table 6.3."""

    coaches: int  # between the end coaches
    length: float  # m, D of a coach
    bogie: float  # m, d between the axles of a bogie
    force: float  # N, P of an axle


HSLM_A: dict[str, _Universal] = {
    "HSLM-A1": _Universal(18, 18.0, 2.0, 170e3), "HSLM-A2": _Universal(17, 19.0, 3.5, 200e3),
    "HSLM-A3": _Universal(16, 20.0, 2.0, 180e3), "HSLM-A4": _Universal(15, 21.0, 3.0, 190e3),
    "HSLM-A5": _Universal(14, 22.0, 2.0, 170e3), "HSLM-A6": _Universal(13, 23.0, 2.0, 180e3),
    "HSLM-A7": _Universal(13, 24.0, 2.0, 190e3), "HSLM-A8": _Universal(12, 25.0, 2.5, 190e3),
    "HSLM-A9": _Universal(11, 26.0, 2.0, 210e3), "HSLM-A10": _Universal(11, 27.0, 2.0, 210e3),
}  # fmt: skip
_BOGIE, _BETWEEN, _COUPLED = 3.0, 11.0, 3.525  # m: power car, its inner axles, and from its last axle to the coach


@lru_cache(maxsize=len(HSLM_A))
def hslm_a(name: str) -> tuple[tuple[float, ...], float]:
    """The universal train HSLM-A of a name: distances of its axles behind the first one in m, and their force in N.

    A power car with two bogies, an end coach with a bogie of its own, coaches that share their bogies, whose middles
    are D apart, and the same backwards. An end coach begins halfway between the power car and its bogie.

    Source: EN 1991-2:2003, 6.4.6.1.1, figure 6.12 and table 6.3.
    """
    coaches, length, bogie, force = HSLM_A[name]
    power = (0.0, _BOGIE, _BOGIE + _BETWEEN, 2.0 * _BOGIE + _BETWEEN)
    end = power[-1] + _COUPLED
    first = power[-1] + 0.5 * _COUPLED + length  # the middle of the first shared bogie
    whole = 2.0 * first + coaches * length
    front = (*power, end, end + bogie)
    shared = (first + i * length + side * 0.5 * bogie for i in range(coaches + 1) for side in (-1.0, 1.0))
    return (*front, *shared, *(whole - at for at in reversed(front))), force


class Coaches(Declaration):
    """The same axles again and again."""

    count: Annotated[int, Count(1, MOST)] = Field(description="number of repetitions of the axles")
    length: PositiveLength = Field(description="spacing of the repetitions: length of a coach")


class TrainTravel(Course):
    """A prescribed advance of a train, whose axles come to the line and leave it one after the other."""

    at_end: ClassVar[AtEnd] = "leave"

    start: Station = Field(
        default=0.0,
        alias="from",
        description="position of the first axle, measured from the start of the line; negative: before it. The other "
        "axles follow, off the line at first. A train towards the start begins at the length of the line or beyond",
    )


@lru_cache(maxsize=64)  # they are asked for by many checks of one scenario
def _starts(behind: tuple[float, ...], measured: Measure, first: float, onward: float) -> tuple[Place, ...]:
    """Where axles stand that are so far behind the first one, m."""
    return tuple(Place(str(number), measured, first - onward * at) for number, at in enumerate(behind, start=1))


def onward(speed: SpeedHistory) -> float:
    """1 for a train of a speed towards the end of its line, -1 towards its start."""
    if callable(speed):
        return math.copysign(1.0, float(speed(0.0)))
    values = speed.value if isinstance(speed, SpeedTable) else (speed,)
    return next((math.copysign(1.0, value) for value in values if value), 1.0)


class Axles(Declaration):
    """A train as the forces of its axles, which travel together and press downwards.

    They are written down, once for a whole train or for a coach that is repeated, or those of a train that is known by
    name: the universal trains HSLM-A1 to HSLM-A10 of EN 1991-2, 6.4.6.1.1, and real ones from published tables. Axles
    that have not come to their line, or have left it, press on level ground. They have no mass; for sprung masses see
    train.
    """

    kind: Literal["axles"] = "axles"
    on: str = Field(description="name of the line")
    train: TrainName | None = Field(default=None, description="name of a built-in train, instead of forces and at")
    forces: AxleForces | None = Field(default=None, description="of the axles, downwards: one for all, or a list")
    at: Stations | None = Field(
        default=None, description="distances of the axles behind the first one, in rising order; the first is 0 m"
    )
    coaches: Coaches | None = Field(default=None, description="repetition of these axles")
    travel: TrainTravel = Field(
        description="motion of the train along the line, on to which it rolls and which it leaves"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = list(self._named() if self.train is not None else self._written())
        report("axles", findings or list(self._places()))
        return self

    def _named(self) -> Iterator[Finding]:
        for key in ("forces", "at", "coaches"):
            if getattr(self, key) is not None:
                remedy = f"leave {key} out, or write forces and at instead of train"
                yield Finding((key,), f"train {self.train} has its own axles", remedy=remedy)

    def _written(self) -> Iterator[Finding]:
        if self.forces is None:
            remedy = "add forces (of the axles, for example 170 kN), or train: HSLM-A1"
            yield Finding(("forces",), "is required without train", remedy=remedy)
        if self.at is None:
            remedy = "add at: distances behind the first axle, for example [0 m, 3 m], or train: HSLM-A1"
            yield Finding(("at",), "is required without train", remedy=remedy)
            return
        if self.at[0] != 0.0:
            remedy = "begin at 0 m, and write the position of the first axle in travel.from"
            yield Finding(("at", 0), "is not 0 m, the position of the first axle", f"{self.at[0]:g} m", remedy)
        for i, (one, two) in enumerate(pairwise(self.at), start=1):
            if not two > one:
                remedy = "sort them in rising order, and add up the forces of axles at one position"
                yield Finding(("at", i), "is not behind the preceding axle", f"{two:g} m after {one:g} m", remedy)
        if isinstance(self.forces, tuple) and len(self.forces) != len(self.at):
            given, remedy = f"{len(self.forces)} forces, {len(self.at)} positions", "write one for each, or one force"
            yield Finding(("forces",), "the numbers of forces and positions (at) differ", given, remedy)

    def _places(self) -> Iterator[Finding]:
        if self.train is None and self.at is not None and self.coaches is not None:
            if not self.coaches.length > self.at[-1]:
                wrong = f"the axles of a coach, {self.at[-1]:g} m long, overlap with the next coach"
                remedy = f"write more than {self.at[-1]:g} m"
                yield Finding(("coaches", "length"), wrong, f"{self.coaches.length:g} m", remedy)
            elif (count := len(self.axles)) > MOST:
                yield Finding(("coaches", "count"), "too many axles", f"{count}", f"at most {MOST} are computed")
        speed = self.travel.speed
        if isinstance(speed, SpeedTable) and min(speed.value) < 0.0 < max(speed.value):
            wrong, remedy = "the speed of a train must not change its sign", "write two loads, or one sign"
            yield Finding(("travel", "speed"), wrong, "a table", remedy)

    @property
    def axles(self) -> list[tuple[float, float]]:
        """Distances behind the first axle in m, and forces in N, downwards."""
        if self.train in HSLM_A:
            places, force = hslm_a(self.train)
            return [(at, force) for at in places]
        if self.train is not None:
            return axle_loads(self.train)
        assert self.at is not None
        assert self.forces is not None
        forces = self.forces if isinstance(self.forces, tuple) else (self.forces,) * len(self.at)
        again = range(self.coaches.count) if self.coaches is not None else (0,)
        length = self.coaches.length if self.coaches is not None else 0.0
        return [(i * length + at, force) for i in again for at, force in zip(self.at, forces, strict=True)]

    @property
    def length(self) -> float:
        """From the first axle to the last one, m."""
        return self.axles[-1][0]

    @property
    def onward(self) -> float:
        """1 for a train towards the end of its line, -1 towards its start."""
        return onward(self.travel.speed)

    def starts(self) -> list[Place]:
        """List where its axles stand at the beginning, also off the line."""
        behind = tuple(at for at, _ in self.axles)
        return list(_starts(behind, self.travel.measured, self.travel.start, self.onward))

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by: none."""
        yield from ()
