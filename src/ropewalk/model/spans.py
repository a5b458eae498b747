"""Spans of an overhead line, as a number of equal ones or as a list, and which of them statistics speak of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import Field, GetCoreSchemaHandler, TypeAdapter
from pydantic_core import core_schema

from ropewalk.errors import Refused
from ropewalk.model._base import Declaration, FieldReader
from ropewalk.model.quantity import Count, Lengths, PositiveLength

MOST_SPANS = 10_000


class Spans(Declaration):
    """Spans of one length."""

    count: Annotated[int, Count(1, MOST_SPANS)] = Field(description="number of spans")
    length: PositiveLength = Field(description="of each span, from support to support")


@dataclass(frozen=True)
class ListOrSpans:
    """Annotation: a list of lengths, or a block {count, length}."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        lengths: TypeAdapter[Any] = TypeAdapter(Lengths)

        def read(value: Any, _: Any) -> Any:
            if isinstance(value, Spans | Mapping):
                return Spans.model_validate(value)
            if not isinstance(value, list | tuple) and not hasattr(value, "tolist"):
                raise Refused("expected spans", "write {count: 10, length: 60 m}, or a list of all lengths")
            return lengths.validate_python(value)

        def write(value: Any, info: core_schema.SerializationInfo) -> Any:
            mode: Literal["json", "python"] = "json" if info.mode_is_json() else "python"
            return value.model_dump(mode=mode) if isinstance(value, Spans) else lengths.dump_python(value, mode=mode)

        return core_schema.no_info_wrap_validator_function(
            read,
            core_schema.union_schema([handler.generate_schema(Lengths), handler.generate_schema(Spans)]),
            serialization=core_schema.plain_serializer_function_ser_schema(write, info_arg=True),
        )


@dataclass(frozen=True)
class FirstAndLast(FieldReader):
    """Annotation: two counts, the numbers of the first and the last span."""

    def read(self, value: object) -> tuple[int, int]:
        entries = value.tolist() if hasattr(value, "tolist") else value
        if not isinstance(entries, list | tuple) or len(entries) != 2:
            raise Refused("expected two numbers", "write [first, last], counted from 1, for example [5, 6]")
        first, last = (Count(1, MOST_SPANS).read(entry) for entry in entries)
        return first, last

    def json_form(self) -> dict[str, Any]:
        one = {"type": "integer", "minimum": 1, "maximum": MOST_SPANS}
        return {"type": "array", "items": one, "minItems": 2, "maxItems": 2}
