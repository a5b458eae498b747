"""How it is said that something is not implemented: in one way, wherever that is found."""

from __future__ import annotations

from ropewalk.model._base import Finding, Path


def missing(path: Path, what: str, given: str = "", remedy: str = "", *, feature: str = "") -> Finding:
    """Say that a key, or a feature that it asks for, is not implemented for what an engine computes."""
    return Finding(path, f"{feature} is not implemented for {what}".strip(), given, remedy)
