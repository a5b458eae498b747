"""The format as a JSON schema, for editors, forms and the reference page."""

from __future__ import annotations

from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from ropewalk.model import Scenario


class _Untitled(GenerateJsonSchema):
    """Leaves out the titles that only repeat the keys."""

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False


def json_schema() -> dict[str, Any]:
    """Describe the file as a JSON schema (draft 2020-12); quantities carry their SI unit as `unit`."""
    schema = Scenario.model_json_schema(by_alias=True, schema_generator=_Untitled)
    _tidy(schema)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _tidy(node: Any) -> None:
    """Ask for `kind` where it tells variants apart; drop the null of optional keys: files leave them out."""
    if isinstance(node, list):
        for entry in node:
            _tidy(entry)
    if not isinstance(node, dict):
        return
    options = node.get("anyOf")
    if isinstance(options, list) and {"type": "null"} in options:
        rest = [option for option in options if option != {"type": "null"}]
        del node["anyOf"]
        node.update(rest[0] if len(rest) == 1 else {"anyOf": rest})
        if node.get("default", 0) is None:
            del node["default"]
    kind = node.get("properties", {}).get("kind", {})
    if isinstance(kind, dict) and "const" in kind:
        kind.pop("default", None)
        if not kind.pop("optional", False):  # the kind that is meant where none is written
            node["required"] = ["kind", *(key for key in node.get("required", []) if key != "kind")]
    if "default" in node:
        node["default"] = _written(node["default"])
    for entry in node.values():
        _tidy(entry)


def _written(value: Any) -> Any:
    """Copy a value without its nulls."""
    if not isinstance(value, dict):
        return value
    return {key: _written(entry) for key, entry in value.items() if entry is not None}
