"""Steppers: loads that are Python objects of the user's own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from ropewalk.errors import Refused
from ropewalk.model._base import Declaration, FieldReader, Finding, Path, report
from ropewalk.model.exchange import Exchange
from ropewalk.model.quantity import Offset, PositiveTime, Way
from ropewalk.model.travel import ON_NETS, AtEnd, Place
from ropewalk.units import LARGEST

_DEEPEST = 20


@dataclass(frozen=True)
class _Model(FieldReader):
    """Annotation: an object with `step`, or text that says where to find what makes one."""

    def read(self, value: Any) -> Any:
        remedy = "write module:name or file.py:name, or give an object that has step"
        if isinstance(value, str):
            home, _, name = value.rpartition(":")
            if not home.strip() or not name.isidentifier() or not value.isprintable():
                raise Refused("cannot be read as the place of a model", remedy)
            return value
        if isinstance(value, type):
            raise Refused("a class is not a model yet", f"make one: {value.__name__}(...), or name it as text")
        if not callable(getattr(value, "step", None)):
            raise Refused("expected a model", remedy)
        return value

    def write(self, value: Any) -> str:
        if not isinstance(value, str):
            raise ValueError("an object cannot be written; write its class or function as module:name")
        return value

    def json_form(self) -> dict[str, Any]:
        return {"type": "string"}


@dataclass(frozen=True)
class _Options(FieldReader):
    """Annotation: arguments by name, of values that a file can hold."""

    def read(self, value: Any) -> dict[str, Any]:
        if not isinstance(value, Mapping):
            raise Refused("expected a block of arguments", "write  name: value  in it")
        findings: list[Finding] = []
        for name in value:
            if not isinstance(name, str) or not name.isidentifier():
                wrong, remedy = "not the name of an argument", "use letters, digits and _"
                findings.append(Finding((str(name),), wrong, repr(name)[:60], remedy))
        report("options", findings)
        read = {name: _plain(entry, (name,), findings) for name, entry in value.items()}
        report("options", findings)
        return read

    def json_form(self) -> dict[str, Any]:
        return {"type": "object"}


class Stepper(Declaration):
    """Any Python object with the step protocol: it sees the line and says with what it presses on it."""

    kind: Literal["stepper"] = "stepper"
    on: str = Field(description="name of the line")
    model: Annotated[Any, _Model()] = Field(
        description="class or function that returns the model, module:name or file.py:name; from Python also the "
        "object itself"
    )
    options: Annotated[dict[str, Any], _Options()] = Field(
        default_factory=dict, description="its arguments: numbers, text, truth values, lists and blocks"
    )
    every: PositiveTime = Field(default=1e-3, description="interval of the exchange")
    exchange: Exchange = Field(
        default=Exchange.as_written(), description="exchange of forces and motions between line and model"
    )
    start: Offset = Field(default=0.0, alias="from", description="unstrained length from the start of the line")
    at_end: AtEnd = Field(
        default="leave",
        description="at an end of the line a model leaves it, stops there, or is refused",
    )
    path: Way | None = Field(default=None, description=ON_NETS)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.options and not isinstance(self.model, str):
            wrong, remedy = "an object exists already", "leave options out, or write its class or function as text"
            report("stepper", [Finding(("options",), wrong, ", ".join(self.options)[:60], remedy)])
        return self

    def starts(self) -> list[Place]:
        """List where it stands at the beginning."""
        return [Place("", "material", self.start)]

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by: none are known."""
        yield from ()


def _plain(value: Any, path: Path, findings: list[Finding]) -> Any:
    """Copy a value of which only numbers, text, truth values, lists and blocks may be part."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, bool | str):
        return value
    if isinstance(value, int | float):
        if not abs(value) <= LARGEST:
            remedy = f"stay below {LARGEST:g}"
            findings.append(Finding(path, "the number is too large, or none", remedy=remedy))
        return value
    if isinstance(value, list | tuple) and len(path) < _DEEPEST:
        return [_plain(entry, (*path, index), findings) for index, entry in enumerate(value)]
    if isinstance(value, Mapping) and len(path) < _DEEPEST and all(isinstance(key, str) for key in value):
        return {key: _plain(entry, (*path, key), findings) for key, entry in value.items()}
    remedy = "write numbers, text, truth values, lists or blocks of names"
    findings.append(Finding(path, "a file cannot hold this", f"{type(value).__name__}", remedy))
    return value
