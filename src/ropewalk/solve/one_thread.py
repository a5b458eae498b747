"""Linear algebra in one thread.

Its libraries divide factorisations of a millisecond among all processors, whose threads then wait for one another in
busy loops: where others work on the machine, that takes hundreds of times as long (docs/notes/speed.md).
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any


@contextmanager
def one_thread() -> Iterator[None]:
    """Let linear algebra be computed in one thread, by all of the process, as long as this lasts."""
    with _libraries().limit(limits=1, user_api="blas"):
        yield


@cache
def _libraries() -> Any:
    """Those of NumPy and SciPy, which are loaded when these are imported."""
    import scipy.linalg  # noqa: F401
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
