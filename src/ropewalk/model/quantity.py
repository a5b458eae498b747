"""Types of fields: quantities, points and vectors with units, counts, names; each refuses in one sentence."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, get_args

from pydantic import AfterValidator, GetCoreSchemaHandler, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import InitErrorDetails, core_schema

from ropewalk.errors import Refused
from ropewalk.model._base import FieldReader
from ropewalk.units import SMALLEST, to_si, written

Sign = Literal["any", "positive", "not negative"]


@dataclass(frozen=True)
class Quantity(FieldReader):
    """Annotation: a float in an SI unit, read from a number or from text with a unit.

    Args:
        unit: the SI unit.
        sign: which values are accepted.
        tiny: accept magnitudes below 1e-30 (entries of tables, components of vectors), too.
    """

    unit: str
    sign: Sign = "any"
    tiny: bool = False

    def read(self, value: object) -> float:
        number = to_si(value, self.unit)
        unit = "" if self.unit == "dimensionless" else f" {self.unit}"
        if self.sign == "positive" and number <= 0.0:
            raise Refused("must be positive", f"write a value above 0{unit}")
        if self.sign == "not negative" and number < 0.0:
            raise Refused("must not be negative", f"write 0{unit} or more")
        if 0.0 < abs(number) < SMALLEST and not self.tiny:
            alternative = "" if self.sign == "positive" else " or write 0"
            raise Refused("the number is too small to calculate with", f"stay above {SMALLEST:g}{unit}{alternative}")
        return number

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        return core_schema.no_info_before_validator_function(
            self.read,
            core_schema.float_schema(),
            serialization=core_schema.plain_serializer_function_ser_schema(
                lambda value: written(value, self.unit), when_used="json-unless-none"
            ),
        )

    def json_form(self) -> dict[str, Any]:
        schema: dict[str, Any] = {"type": ["number", "string"], "unit": self.unit}
        if self.sign != "any":
            schema["exclusiveMinimum" if self.sign == "positive" else "minimum"] = 0
        return schema


@dataclass(frozen=True)
class Components(FieldReader):
    """Annotation: two or three quantities, [x, z] or [x, y, z], kept as a tuple of floats."""

    unit: str

    def read(self, value: object) -> tuple[float, ...]:
        entries = value.tolist() if hasattr(value, "tolist") else value  # NumPy arrays
        if isinstance(entries, str | Mapping) or not isinstance(entries, list | tuple):
            raise Refused("expected a list of components", "write [x, z] or [x, y, z]")
        if len(entries) not in (2, 3):
            count = "1 component" if len(entries) == 1 else f"{len(entries)} components"
            raise Refused(f"has {count} instead of 2 or 3", "write [x, z] or [x, y, z]")
        one = Quantity(self.unit, tiny=True)
        numbers, details = [], []
        for index, entry in enumerate(entries):
            try:
                numbers.append(one.read(entry))
            except Refused as error:
                details.append(InitErrorDetails(type="value_error", loc=(index,), input=entry, ctx={"error": error}))
        if details:
            raise ValidationError.from_exception_data("components", details)
        return tuple(numbers)

    def write(self, value: tuple[float, ...]) -> list[str | float]:
        return [written(component, self.unit) for component in value]

    def json_form(self) -> dict[str, Any]:
        items = {"type": ["number", "string"], "unit": self.unit}
        return {"type": "array", "items": items, "minItems": 2, "maxItems": 3}


@dataclass(frozen=True)
class OneOrEach(FieldReader):
    """Annotation: one quantity for all directions, or two or three of them, [x, z] or [x, y, z]."""

    unit: str
    sign: Sign = "any"

    def read(self, value: object) -> float | tuple[float, ...]:
        one = Quantity(self.unit, self.sign)
        if hasattr(value, "tolist"):
            value = value.tolist()
        if not isinstance(value, list | tuple):
            return one.read(value)
        numbers = Components(self.unit).read(value)
        for index, number in enumerate(numbers):
            try:
                one.read(number)
            except Refused as error:
                given = InitErrorDetails(type="value_error", loc=(index,), input=value[index], ctx={"error": error})
                raise ValidationError.from_exception_data("components", [given]) from None
        return numbers

    def write(self, value: float | tuple[float, ...]) -> str | float | list[str | float]:
        return Components(self.unit).write(value) if isinstance(value, tuple) else written(value, self.unit)

    def json_form(self) -> dict[str, Any]:
        one = Quantity(self.unit, self.sign).json_form()
        return {"anyOf": [one, {"type": "array", "items": one, "minItems": 2, "maxItems": 3}]}


@dataclass(frozen=True)
class Rows(FieldReader):
    """Annotation: a list of lists of plain numbers, or an array, kept as a tuple of tuples of floats."""

    def read(self, value: object) -> tuple[tuple[float, ...], ...]:
        entries = value.tolist() if hasattr(value, "tolist") else value
        expected = Refused("expected a list of rows", "write [[a, b], [c, d]]")
        if not isinstance(entries, list | tuple):
            raise expected
        one = Quantity("dimensionless", tiny=True)
        rows: list[tuple[float, ...]] = []
        details = []
        for index, entry in enumerate(entries):
            if not isinstance(entry, list | tuple):
                details.append(InitErrorDetails(type="value_error", loc=(index,), input=entry, ctx={"error": expected}))
                continue
            numbers = []
            for column, cell in enumerate(entry):
                try:
                    numbers.append(one.read(cell))
                except Refused as error:
                    place, context = (index, column), {"error": error}
                    details.append(InitErrorDetails(type="value_error", loc=place, input=cell, ctx=context))
            rows.append(tuple(numbers))
        if details:
            raise ValidationError.from_exception_data("rows", details)
        return tuple(rows)

    def json_form(self) -> dict[str, Any]:
        cell = {"type": ["number", "string"], "unit": "dimensionless"}
        return {"type": "array", "items": {"type": "array", "items": cell}}


@dataclass(frozen=True)
class Listed(FieldReader):
    """Annotation: a list of quantities, kept as a tuple of floats.

    Args:
        unit: the SI unit.
        sign: which values are accepted.
        one: accept one quantity instead of a list, too.
        nested: accept a list of lists, too, kept as a tuple of tuples.
    """

    when_written = "json-unless-none"
    unit: str
    sign: Sign = "any"
    one: bool = False
    nested: bool = False

    @property
    def _remedy(self) -> str:
        unit = "" if self.unit == "dimensionless" else f" {self.unit}"
        forms = ([f"1{unit}"] if self.one else []) + [f"[1{unit}, 2{unit}]"]
        return f"write {' or '.join(forms)}" + (" or a list of such lists" if self.nested else "")

    def read(self, value: object) -> float | tuple[Any, ...]:
        entries = value.tolist() if hasattr(value, "tolist") else value
        quantity = Quantity(self.unit, self.sign, tiny=self.sign != "positive")
        if isinstance(entries, str | int | float) and self.one:
            return quantity.read(entries)
        if not isinstance(entries, list | tuple):
            raise Refused("expected a list", self._remedy)
        if not entries:
            raise Refused("the list is empty", self._remedy)
        inner = Listed(self.unit, self.sign)
        deep = self.nested and isinstance(entries[0], list | tuple)
        read, numbers, details = inner.read if deep else quantity.read, [], []
        for index, entry in enumerate(entries):
            try:
                if not deep and isinstance(entry, list | tuple):
                    raise Refused("a list among single values" if index else "a list within the list", self._remedy)
                numbers.append(read(entry))
            except Refused as error:
                details.append(InitErrorDetails(type="value_error", loc=(index,), input=entry, ctx={"error": error}))
            except ValidationError as error:
                for found in error.errors():
                    place, context = (index, *found["loc"]), {"error": found["ctx"]["error"]}
                    details.append(InitErrorDetails(type="value_error", loc=place, input=found["input"], ctx=context))
        if details:
            raise ValidationError.from_exception_data("list", details)
        return tuple(numbers)

    def write(self, value: Any) -> Any:
        return [self.write(entry) for entry in value] if isinstance(value, tuple) else written(value, self.unit)

    def json_form(self) -> dict[str, Any]:
        one = Quantity(self.unit, self.sign).json_form()
        row = {"type": "array", "items": one, "minItems": 1}
        rows = [{"type": "array", "items": row, "minItems": 1}] if self.nested else []
        choices = ([one] if self.one else []) + [row, *rows]
        return choices[0] if len(choices) == 1 else {"anyOf": choices}


AUTO = "auto"


class Auto(int):
    """A number that is yet to be found, written `auto`; whoever does not look for it takes it as it is."""


class AutoLength(float):
    """A length that is yet to be found, written `auto`; whoever does not look for it takes it as it is."""


@dataclass(frozen=True)
class LengthOrAuto(FieldReader):
    """Annotation: a length above 0 in m, read from a number or from text with a unit, or `auto`, which is infinite."""

    when_written = "json-unless-none"

    def read(self, value: object) -> float:
        if value == AUTO or isinstance(value, AutoLength):
            return AutoLength("inf")
        try:
            return Quantity("m", "positive").read(value)
        except Refused as error:
            raise Refused(error.wrong, f"{error.remedy}, or {AUTO}") from None

    def write(self, value: float) -> str | float:
        return AUTO if isinstance(value, AutoLength) else written(value, "m")

    def json_form(self) -> dict[str, Any]:
        return {"anyOf": [Quantity("m", "positive").json_form(), {"enum": [AUTO]}]}


@dataclass(frozen=True)
class Count(FieldReader):
    """Annotation: a whole number between two bounds, or, where `auto` says which one stands for it, `auto`."""

    least: int
    most: int
    auto: int | None = None

    def read(self, value: object) -> int:
        bounds = f"write a whole number from {self.least} to {self.most}"
        if self.auto is not None:
            if value == AUTO or isinstance(value, Auto):
                return Auto(self.auto)
            bounds += f", or {AUTO}"
        if isinstance(value, str):
            try:
                value = float(value) if len(value) < 40 else None
            except ValueError:
                value = None
        if hasattr(value, "item"):  # NumPy integers
            value = value.item()
        if isinstance(value, bool) or not isinstance(value, int | float) or value != value // 1:
            raise Refused("expected a whole number", bounds)
        if not self.least <= value <= self.most:
            raise Refused("is too small" if value < self.least else "is too large", bounds)
        return int(value)

    def write(self, value: int) -> str | int:
        return AUTO if isinstance(value, Auto) else value

    def json_form(self) -> dict[str, Any]:
        number = {"type": "integer", "minimum": self.least, "maximum": self.most}
        return number if self.auto is None else {"anyOf": [number, {"enum": [AUTO]}]}


def _name(name: str) -> str:
    if not name.strip():
        raise Refused("a name must not be empty", "give it a name, for example rope", given=repr(name))
    if name != name.strip() or not name.isprintable() or any(mark in name for mark in ".[]"):
        remedy = "use letters, digits, - and _ (dots separate the parts of a key, as in lines.rope.length)"
        raise Refused("the name cannot be used in keys", remedy, given=repr(name))
    return name


Name = Annotated[str, AfterValidator(_name)]
Point = Annotated[tuple[float, float] | tuple[float, float, float], Components("m")]
"""A place [x, z] or [x, y, z]: x along the span, z up, y sideways."""
Vector = Annotated[tuple[float, float] | tuple[float, float, float], Components("N")]
"""A force [Fx, Fz] or [Fx, Fy, Fz]."""

Displacement = Annotated[tuple[float, float] | tuple[float, float, float], Components("m")]
"""A displacement [ux, uz] or [ux, uy, uz]."""
Direction = Annotated[tuple[float, float] | tuple[float, float, float], Components("dimensionless")]
"""A direction [x, z] or [x, y, z] of any length."""
Stiffnesses = Annotated[float | tuple[float, float] | tuple[float, float, float], OneOrEach("N/m", "positive")]
BearingStiffnesses = Annotated[
    float | tuple[float, float] | tuple[float, float, float], OneOrEach("N/m", "not negative")
]
Viscosities = Annotated[float | tuple[float, float] | tuple[float, float, float], OneOrEach("N*s/m", "not negative")]

Spot = Annotated[float | tuple[float, float] | tuple[float, float, float], OneOrEach("m")]
Way = Annotated[tuple[tuple[float, ...], ...], Listed("m", nested=True)]
Matrix = Annotated[tuple[tuple[float, ...], ...], Rows()]

Offset = Annotated[float, Quantity("m", "not negative")]
Width = Annotated[float, Quantity("m", "not negative")]
PositiveLength = Annotated[float, Quantity("m", "positive")]
PositiveLengthOrAuto = Annotated[float, LengthOrAuto()]
PositiveTime = Annotated[float, Quantity("s", "positive")]
PositiveForce = Annotated[float, Quantity("N", "positive")]
PositiveMass = Annotated[float, Quantity("kg", "positive")]
PositiveSpeed = Annotated[float, Quantity("m/s", "positive")]
PositiveStiffness = Annotated[float, Quantity("N/m", "positive")]
Frequency = Annotated[float, Quantity("Hz", "positive")]
Station = Annotated[float, Quantity("m")]
"""A place along a vehicle, ahead of its point 0 if positive."""
Force = Annotated[float, Quantity("N")]
Stiffness = Annotated[float, Quantity("N/m", "not negative")]
Viscosity = Annotated[float, Quantity("N*s/m", "not negative")]
PositiveViscosity = Annotated[float, Quantity("N*s/m", "positive")]
Mass = Annotated[float, Quantity("kg", "not negative")]
FrictionCoefficient = Annotated[float, Quantity("dimensionless", "not negative")]
Inertia = Annotated[float, Quantity("kg*m^2", "not negative")]
PositiveInertia = Annotated[float, Quantity("kg*m^2", "positive")]
RotationalDamping = Annotated[float, Quantity("N*m*s", "not negative")]
AirDrag = Annotated[float, Quantity("kg/m", "not negative")]
Share = Annotated[float, Quantity("dimensionless", "not negative")]
Angle = Annotated[float, Quantity("rad")]
TurnAngle = Annotated[float, Quantity("rad", "positive")]
MassPerLength = Annotated[float, Quantity("kg/m", "positive")]
AxialDamping = Annotated[float, Quantity("N*s", "not negative")]
BendingStiffness = Annotated[float, Quantity("N*m^2", "not negative")]
BedStiffness = Annotated[float, Quantity("N/m^2", "not negative")]
Rate = Annotated[float, Quantity("1/s", "not negative")]
Acceleration = Annotated[float, Quantity("m/s^2", "not negative")]
Speed = Annotated[float, Quantity("m/s")]
TableTime = Annotated[float, Quantity("s", tiny=True)]
TableForce = Annotated[float, Quantity("N", tiny=True)]
TableSpeed = Annotated[float, Quantity("m/s", tiny=True)]
TableStrain = Annotated[float, Quantity("dimensionless", tiny=True)]
Number = Annotated[float, Quantity("dimensionless")]
Factor = Annotated[float, Quantity("dimensionless", "positive")]
Retardation = Annotated[float, Quantity("s", "not negative")]
"""Time by which a damping force that grows with the stiffness lags: beta of Rayleigh damping."""
RampTime = Annotated[float, Quantity("s", "not negative")]
LinearMass = Annotated[float, Quantity("kg/m", "not negative")]
Lengths = Annotated[tuple[float, ...], Listed("m", "positive")]
Places = Annotated[tuple[float, ...] | tuple[tuple[float, ...], ...], Listed("m", "not negative", nested=True)]
"""One list for every span, or one for each."""
LengthRows = Annotated[tuple[float, ...] | tuple[tuple[float, ...], ...], Listed("m", "positive", nested=True)]
Sags = Annotated[
    float | tuple[float, ...] | tuple[tuple[float, ...], ...], Listed("m", "not negative", one=True, nested=True)
]
Heights = Annotated[tuple[float, ...], Listed("m")]
Radii = Annotated[float | tuple[float, ...], Listed("m", one=True)]
Staggers = Annotated[float | tuple[float, ...], Listed("m", one=True)]
Frequencies = Annotated[tuple[float, ...], Listed("Hz", "positive")]
Stations = Annotated[tuple[float, ...], Listed("m", "not negative")]
AxleForces = Annotated[float | tuple[float, ...], Listed("N", "positive", one=True)]
Masses = Annotated[tuple[float, ...], Listed("kg", "positive")]
StiffnessList = Annotated[tuple[float, ...], Listed("N/m", "not negative")]
ViscosityList = Annotated[tuple[float, ...], Listed("N*s/m", "not negative")]


def unit_of(field: FieldInfo) -> str:
    """Find the unit of a quantity, empty for anything else."""
    for mark in (*field.metadata, *marks_of(field.annotation)):
        if isinstance(mark, Quantity | Components | Listed):
            return mark.unit
    return ""


def marks_of(annotation: Any) -> list[Any]:
    """List what annotations say, however deep."""
    metadata = list(getattr(annotation, "__metadata__", ()))
    return metadata + [mark for part in get_args(annotation) for mark in marks_of(part)]
