"""The common base of all declarations, and the one way in which a field chooses between several of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self, get_args

from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationError
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import InitErrorDetails, core_schema

from ropewalk import hooks
from ropewalk.errors import Refused, ScenarioError, did_you_mean, nearest

Path = tuple[str | int, ...]
"""Where a value stands in a scenario: ("loads", "walker", "force", 1)."""


if TYPE_CHECKING:
    _Base = BaseModel
else:

    class _Refusing(type(BaseModel)):
        """Makes declarations that are called wrongly in Python say so as files do: with the key, and what to do.

        Blocks within a declaration are not called, and their mistakes come together with all others.
        """

        def __call__(cls, *given, **keys):
            try:
                return super().__call__(*given, **keys)
            except ValidationError as error:
                raise ScenarioError(hooks.problems(error, cls, keys)) from None

    class _Base(BaseModel, metaclass=_Refusing):
        pass


class Declaration(_Base):
    """A frozen, self-checking statement of what is there; it holds no numerics."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, populate_by_name=True, arbitrary_types_allowed=True,
        defer_build=True,  # what checks it is made with the first of its kind: a process has but few kinds
    )  # fmt: skip

    @classmethod
    def as_written(cls, **keys: Any) -> Self:
        """Make one for a default, whose keys are known to be right: nothing is prepared to check them."""
        return cls.model_construct(**keys)


@dataclass(frozen=True)
class Finding:
    """Something wrong within a declaration: where (relative to it), what, what was given, what to do."""

    path: Path
    wrong: str
    given: str = ""
    remedy: str = ""


def report(title: str, findings: Iterable[Finding]) -> None:
    """Raise one ValidationError that holds all findings, each at its own place; do nothing without findings.

    Raises:
        ValidationError: there is at least one finding.
    """
    details = [
        InitErrorDetails(
            type="value_error",
            loc=finding.path,
            input=finding.given,
            ctx={"error": Refused(finding.wrong, finding.remedy, finding.given)},
        )
        for finding in findings
    ]
    if details:
        raise ValidationError.from_exception_data(title, details)


class FieldReader:
    """Base of annotations: `read` makes the value, `write` (optional) what a file has, `json_form` the schema."""

    write: ClassVar[Any] = None
    when_written: ClassVar[Literal["json", "json-unless-none"]] = "json"

    def read(self, value: Any) -> Any:
        """Make the value of a field from what is written."""
        raise NotImplementedError

    def json_form(self) -> dict[str, Any]:
        """Return the JSON schema of what may be written."""
        raise NotImplementedError

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        written = None
        if self.write is not None:
            written = core_schema.plain_serializer_function_ser_schema(self.write, when_used=self.when_written)
        return core_schema.no_info_plain_validator_function(self.read, serialization=written)

    def __get_pydantic_json_schema__(self, _: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return self.json_form()


@dataclass(frozen=True)
class Variants:
    """Annotation: the value is one of several declarations, distinguished by `kind`, which must be written.

    It replaces a tagged union so that errors stand at the key itself and an unknown kind gives exactly one.

    Args:
        what: what the declarations are, for messages.
        default: the kind that is meant where none is written; empty: it must be written.
    """

    what: str
    default: str = ""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        kinds = {model.model_fields["kind"].default: model for model in declarations_in(source)}

        def read(value: Any) -> Any:
            if isinstance(value, tuple(kinds.values())):
                return value
            if not isinstance(value, Mapping):
                raise Refused(f"expected a {self.what}", f"write a block with kind: {' | '.join(kinds)}")
            if "kind" not in value:
                slip = nearest("kind", [key for key in value if isinstance(key, str)])
                if slip is not None and not any(slip in model.model_fields for model in kinds.values()):
                    report(self.what, [Finding((slip,), "unknown key", remedy="did you mean kind?")])
                if not self.default or (other := _other_kind(value, kinds, self.default)):
                    remedy = f"add kind: {' | '.join(kinds) if not self.default else other}"
                    report(self.what, [Finding(("kind",), "is required", remedy=remedy)])
            kind = value.get("kind", self.default)
            if not isinstance(kind, str) or kind not in kinds:
                remedy = did_you_mean(kind if isinstance(kind, str) else "", kinds)
                report(self.what, [Finding(("kind",), f"unknown kind of {self.what}", repr(kind), remedy)])
            return kinds[kind].model_validate(value)

        # Schemas of the kinds are not built here: a process needs those of its own loads only.
        return core_schema.no_info_plain_validator_function(read, metadata={"kinds": kinds})

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        kinds: dict[str, type[Declaration]] = schema["metadata"]["kinds"]
        for model in kinds.values():
            model.model_rebuild()
        choices = {kind: model.__pydantic_core_schema__ for kind, model in kinds.items()}
        if len(choices) == 1:
            return handler(*choices.values())
        return handler(core_schema.tagged_union_schema(choices, discriminator="kind"))


def _other_kind(value: Mapping[Any, Any], kinds: Mapping[str, type[Declaration]], default: str) -> str:
    """Find the kind that has the keys which the default kind has not, empty if there are none."""

    def unknown(model: type[Declaration]) -> set[Any]:
        fields = model.model_fields.items()
        return set(value) - {key for name, field in fields for key in (name, field.alias)}

    external = unknown(kinds[default])
    return next((kind for kind, model in kinds.items() if external and not external & unknown(model)), "")


def declarations_in(annotation: Any) -> list[type[Declaration]]:
    """List the declarations that an annotation names, however deep."""
    if isinstance(annotation, type) and issubclass(annotation, Declaration):
        return [annotation]
    return [model for part in get_args(annotation) for model in declarations_in(part)]
