"""What the declarations say about a key of the file: its block, its neighbours, its unit, its meaning."""

from __future__ import annotations

from types import NoneType
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic.fields import FieldInfo

from ropewalk.model import Scenario
from ropewalk.model._base import Declaration, Variants, declarations_in
from ropewalk.model.quantity import marks_of
from ropewalk.scenario.source import Key


def block_at(key: Key, tree: Any, start: type[Declaration] = Scenario) -> type[Declaration] | None:
    """Find the declaration that reads the block at a key, None for names or where it is not certain."""
    annotation = _annotation_at(key, tree, start)
    return None if get_origin(annotation) is dict else _declaration(annotation, _value_at(key, tree))


def is_block_of_names(key: Key, tree: Any) -> bool:
    """Whether the keys at this place are names given by the user (lines, loads)."""
    return get_origin(_annotation_at(key, tree)) is dict


def known_keys(block: type[Declaration]) -> dict[str, FieldInfo]:
    """List the keys of a block as they are written in a file."""
    return {field.alias or name: field for name, field in block.model_fields.items()}


def choices_of(field: FieldInfo) -> list[str]:
    """List the words that a key accepts, empty where it is not a choice."""
    for kind in (field.annotation, *get_args(field.annotation)):
        if get_origin(kind) is Literal:
            return [str(word) for word in get_args(kind)]
    return []


def _annotation_at(key: Key, tree: Any, start: type[Declaration] = Scenario) -> Any:
    annotation: Any = start
    value = tree
    for part in key:
        if isinstance(value, list) and part.isdecimal():
            value = value[int(part)] if int(part) < len(value) else None
            continue  # the entries are what the annotation of the list says
        if get_origin(annotation) is dict:
            annotation = get_args(annotation)[1]
        else:
            block = _declaration(annotation, value)
            field = known_keys(block).get(part) if block is not None else None
            if field is None:
                return None
            marks = [mark for mark in field.metadata if isinstance(mark, Variants)]
            annotation = Annotated[field.annotation, marks[0]] if marks else _given(field.annotation)
        value = value.get(part) if isinstance(value, dict) else None
    return annotation


def _given(annotation: Any) -> Any:
    """What a block of names is that may be left out."""
    kinds = [kind for kind in get_args(annotation) if kind is not NoneType]
    return kinds[0] if len(kinds) == 1 and get_origin(kinds[0]) is dict else annotation


def _declaration(annotation: Any, value: Any) -> type[Declaration] | None:
    models = declarations_in(annotation)
    if len(models) > 1:
        default = next((mark.default for mark in marks_of(annotation) if isinstance(mark, Variants)), None)
        kind = value.get("kind", default) if isinstance(value, dict) else None
        models = [model for model in models if model.model_fields["kind"].default == kind]
    return models[0] if len(models) == 1 else None


def _value_at(key: Key, tree: Any) -> Any:
    for part in key:
        tree = tree.get(part) if isinstance(tree, dict) else None
    return tree
