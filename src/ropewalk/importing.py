"""Imports that take no longer than they must, since the first answer of a process is mostly imports.

NumPy, SciPy and Numba bring along what no run asks for: such modules are there, and executed when something is asked
of them. And Python looks for cycles among all that is imported, over and over, though it stays.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import LazyLoader
from types import ModuleType

SELDOM_USED = ("numpy.ctypeslib", "numpy.f2py", "numpy.testing", "yaml")
"""SciPy takes all names of NumPy, and Numba looks whether it is configured by a file."""
_GARBAGE = 200_000  # objects after which Python looks for cycles meanwhile: more than a run imports


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
    """Import the required modules only."""
    outermost, threshold, modules = _later not in sys.meta_path, gc.get_threshold(), len(sys.modules)
    if outermost:
        sys.meta_path.insert(0, _later)
    if threshold[0]:
        gc.set_threshold(max(_GARBAGE, threshold[0]), *threshold[1:])
    try:
        yield
    finally:
        if outermost:
            sys.meta_path.remove(_later)
        if len(sys.modules) > modules and not gc.get_freeze_count():  # else what others have frozen would thaw, too
            gc.freeze()  # together these take all objects for old ones: no look at any of them is needed for that
            gc.unfreeze()
        gc.set_threshold(*threshold)
