"""Values that change in time: a constant, a table, or (through the Python API) a callable."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, Self

from pydantic import Field, GetCoreSchemaHandler, TypeAdapter, model_validator
from pydantic_core import core_schema

from ropewalk.errors import Refused
from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.quantity import Displacement, Force, Speed, TableForce, TableSpeed, TableTime, Vector


def _clock(time: tuple[float, ...], values: int) -> list[Finding]:
    findings = []
    if len(time) != values:
        wrong = f"the table has different numbers of times ({len(time)}) and values ({values})"
        findings.append(Finding((), wrong, remedy="give one value for each time"))
    for index, (before, after) in enumerate(pairwise(time), start=1):
        if after < before:
            given = f"{after:g} s after {before:g} s"
            remedy = "sort the entries by time (two equal times make a jump)"
            findings.append(Finding(("time", index), "the times must not fall", given, remedy))
            break
    return findings


def _same_components(value: tuple[tuple[float, ...], ...], letter: str) -> list[Finding]:
    first = len(value[0])
    for index, vector in enumerate(value):
        if len(vector) != first:
            wrong = f"has {len(vector)} components, the first entry has {first}"
            remedy = f"write all entries as [{letter}x, {letter}z] or all as [{letter}x, {letter}y, {letter}z]"
            return [Finding(("value", index), wrong, str(list(vector)), remedy)]
    return []


class SpeedTable(Declaration):
    """A speed given at instants, linear in between and constant outside."""

    time: tuple[TableTime, ...] = Field(min_length=1, description="instants, not falling; two equal ones make a jump")
    value: tuple[TableSpeed, ...] = Field(min_length=1, description="speed at each instant")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        report("speed table", _clock(self.time, len(self.value)))
        return self


class DriveTable(Declaration):
    """A force along the line given at instants, linear in between and constant outside."""

    time: tuple[TableTime, ...] = Field(min_length=1, description="instants, not falling; two equal ones make a jump")
    value: tuple[TableForce, ...] = Field(min_length=1, description="force at each instant; positive: towards the end")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        report("drive table", _clock(self.time, len(self.value)))
        return self


class ForceTable(Declaration):
    """A force given at instants, linear in between and constant outside."""

    time: tuple[TableTime, ...] = Field(min_length=1, description="instants, not falling; two equal ones make a jump")
    value: tuple[Vector, ...] = Field(min_length=1, description="[Fx, Fz] or [Fx, Fy, Fz] at each instant")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        report("force table", _clock(self.time, len(self.value)) + _same_components(self.value, "F"))
        return self


class DisplacementTable(Declaration):
    """A displacement given at instants, linear in between and constant outside."""

    time: tuple[TableTime, ...] = Field(min_length=1, description="instants, rising")
    value: tuple[Displacement, ...] = Field(min_length=1, description="[ux, uz] or [ux, uy, uz] at each instant")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = _clock(self.time, len(self.value)) + _same_components(self.value, "u")
        for index, (before, after) in enumerate(pairwise(self.time), start=1):
            if after == before:
                given, remedy = f"{after:g} s twice", "a support cannot jump: give each instant once"
                findings.append(Finding(("time", index), "the times must rise", given, remedy))
                break
        report("displacement table", findings)
        return self


@dataclass(frozen=True)
class History:
    """Annotation: a constant, a table (in a file a block {time, value}), or a callable of time in s."""

    constant: Any
    table: type[Declaration]
    expected: str

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        constant: TypeAdapter[Any] = TypeAdapter(self.constant)

        def read(value: Any, _: Any) -> Any:
            if callable(value) or isinstance(value, self.table):
                return value
            if isinstance(value, Mapping):
                return self.table.model_validate(value)
            if isinstance(value, Declaration):
                raise Refused("this key takes another kind of table", self.expected)
            return constant.validate_python(value)

        def write(value: Any, info: core_schema.SerializationInfo) -> Any:
            if isinstance(value, self.table):
                return value.model_dump(mode=info.mode, by_alias=True)
            if callable(value):
                if info.mode_is_json():
                    raise ValueError("a callable cannot be written; give a table {time, value} instead")
                return value
            return constant.dump_python(value, mode="json" if info.mode_is_json() else "python")

        return core_schema.no_info_wrap_validator_function(
            read,
            core_schema.union_schema([handler.generate_schema(self.constant), handler.generate_schema(self.table)]),
            serialization=core_schema.plain_serializer_function_ser_schema(write, info_arg=True),
        )


SpeedHistory = Annotated[
    float | SpeedTable | Callable[[float], float],
    History(Speed, SpeedTable, "write a speed such as 10 m/s or a table {time: [...], value: [...]}"),
]
DriveHistory = Annotated[
    float | DriveTable | Callable[[float], float],
    History(Force, DriveTable, "write a force such as 200 N or a table {time: [...], value: [...]}"),
]
ForceHistory = Annotated[
    tuple[float, float] | tuple[float, float, float] | ForceTable | Callable[[float], tuple[float, ...]],
    History(Vector, ForceTable, "write [Fx, Fz] or a table {time: [...], value: [...]}"),
]
DisplacementHistory = Annotated[
    tuple[float, float] | tuple[float, float, float] | DisplacementTable | Callable[[float], tuple[float, ...]],
    History(Displacement, DisplacementTable, "write [ux, uz] or a table {time: [...], value: [...]}"),
]


def beginning(speed: Any) -> float:
    """Value in m/s of a history of a speed at time 0."""
    if isinstance(speed, SpeedTable):
        times, values = speed.time, speed.value
        i = max((i for i, t in enumerate(times) if t <= 0.0), default=-1)
        if i < 0 or i == len(times) - 1:
            return values[max(i, 0)]
        return values[i] - times[i] * (values[i + 1] - values[i]) / (times[i + 1] - times[i])
    return float(speed(0.0) if callable(speed) else speed)


def rows(history: Any) -> tuple[tuple[float, ...], ...]:
    """List the vectors of a history of forces or displacements; none of a callable."""
    if callable(history):
        return ()
    return (history,) if isinstance(history, tuple) else tuple(history.value)
