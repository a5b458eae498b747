"""Public names that have changed: the old ones work for one release and say what they are called now."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from functools import wraps
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


def warn_renamed(old: str, new: str, depth: int = 3) -> None:
    """Say that a name has changed.

    Args:
        old: the name as it was used.
        new: the name as it is.
        depth: how many calls above this one it was used.
    """
    warnings.warn(f"{old} was renamed to {new}; it will be removed in the next release", DeprecationWarning, depth)


def with_old_arguments(names: Mapping[str, str]) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Let a function also be called with keyword arguments as they were named before.

    Args:
        names: the old names with the new ones.
    """

    def decorated(function: Callable[P, T]) -> Callable[P, T]:
        @wraps(function)
        def called(*given: Any, **named: Any) -> T:
            for old in names.keys() & named.keys():
                warn_renamed(f"{function.__name__}({old}=...)", f"{function.__name__}({names[old]}=...)")
                named[names[old]] = named.pop(old)
            return function(*given, **named)

        return called

    return decorated
