"""What lower storeys ask of higher ones without importing them: the package itself puts the answers here."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

unsupported: Callable[[Any], Iterable[Any]]
"""Of the parts of a scenario (`model.parts.Parts`), findings (`model.Finding`) of what no engine implements yet."""
