"""What a result says was declared, as the tree of its scenario's text: also of models that no text can make again."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr


def declared(dataset: xr.Dataset, block: str) -> dict[str, dict[str, Any]]:
    """Declarations by name of a block of the scenario of a result, `loads` or `lines`; none where it has no text."""
    found = _tree(str(dataset.attrs.get("scenario", "")))
    return (found.get(block) or {}) if isinstance(found, dict) else {}


def line_of(contact: str, loads: Mapping[str, Any]) -> str:
    """The line of a contact as declared; those of a load on several lines have the name of theirs.

    Args:
        contact: its name, that of its load first.
        loads: of each load the lines that it is `on` and `also_on`.
    """
    name, _, part = contact.partition(".")
    load = loads.get(name, {})
    return part if part in (load.get("also_on") or ()) else str(load.get("on", ""))


@lru_cache(maxsize=4)
def _tree(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return {}
