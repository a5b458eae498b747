"""The end of a run: a time, or as long as the loads take to cross their lines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from ropewalk.errors import Refused
from ropewalk.model._base import FieldReader
from ropewalk.model.quantity import Quantity
from ropewalk.units import written

CROSSING = "crossing"
_FORM = "write a time, crossing, or crossing + 2 s"


class Crossing(float):
    """A time in s that follows from the loads, and what is to come after it; 1 s as long as it is not found."""

    more: float = 0.0  # s

    @staticmethod
    def of(time: float, more: float) -> Crossing:
        """The end of a run whose loads have crossed by a time in s."""
        found = Crossing(time + more)
        found.more = more
        return found

    @property
    def text(self) -> str:
        """As it is written in scenarios."""
        return f"{CROSSING} + {written(self.more, 's')}" if self.more else CROSSING


@dataclass(frozen=True)
class RunEnd(Quantity):
    """Annotation: a positive time, or until all loads have crossed."""

    unit: str = "s"
    __get_pydantic_core_schema__ = FieldReader.__get_pydantic_core_schema__  # that of Quantity reads plain numbers only

    def read(self, value: object) -> float:
        if isinstance(value, Crossing):
            return value
        if not (isinstance(value, str) and value.strip().startswith(CROSSING)):
            return Quantity("s", "positive").read(value)
        rest = value.strip().removeprefix(CROSSING).strip()
        if not rest:
            return Crossing.of(1.0, 0.0)
        if not rest.startswith("+"):
            raise Refused("expected a time", _FORM, given=repr(value))
        return Crossing.of(1.0, Quantity("s", "not negative").read(rest[1:].strip()))

    def write(self, value: float) -> str | float:
        return value.text if isinstance(value, Crossing) else written(value, "s")

    def json_form(self) -> dict[str, Any]:
        return {"anyOf": [Quantity("s", "positive").json_form(), {"enum": [CROSSING]}]}


Until = Annotated[float, RunEnd()]
