"""Linear algebra in one thread: threads of the libraries wait in busy loops for one another (docs/notes/speed.md)."""

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
