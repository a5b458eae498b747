"""What lower layers ask of higher ones without importing them: the package itself puts the answers here."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

unsupported: Callable[[Any], Iterable[Any]]
"""Of the parts of a scenario (`model.parts.Parts`), findings (`model.Finding`) of what no engine implements yet."""
problems: Callable[[Any, type, dict[str, Any]], Sequence[Any]]
"""Of pydantic's error, the declaration and what it was given, each `errors.Problem`."""
