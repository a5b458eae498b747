"""Imports that take no longer than they must: the first answer of a process is mostly imports.

NumPy, SciPy and Numba bring along what no run asks for. Its modules are there, but are executed when something is asked of
them.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import LazyLoader
from types import ModuleType

SELDOM_USED = ("numpy.ctypeslib", "numpy.f2py", "numpy.testing", "pydoc", "yaml")
"""SciPy takes all names of NumPy, and Numba looks whether it is configured by a file."""


class _Later:
    """Finds modules that are executed when something is asked of them."""

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        found = PathFinder.find_spec(name, path, target) if name in SELDOM_USED else None
        if found is not None and found.loader is not None:
            found.loader = LazyLoader(found.loader)
        return found


_later = _Later()


@contextmanager
def lightly() -> Iterator[None]:
    """Import what is needed, without what comes along with it."""
    outermost = _later not in sys.meta_path
    if outermost:
        sys.meta_path.insert(0, _later)
    try:
        yield
    finally:
        if outermost:
            sys.meta_path.remove(_later)
