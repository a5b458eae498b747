"""How kernels are compiled: in one place, so that all agree.

`error_model="numpy"` lets loops with a square root or a division vectorise (no exception for a zero divisor); what
is not finite is found by the callers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numba
import numpy as np
from numba.core import event as events

from ropewalk.interrupts import note_compiling
from ropewalk.mechanics.kernel_cache import keep

config: Any = numba.config  # its stubs do not know what is read from the environment


def njit(**options: Any) -> Any:
    """A decorator of kernels."""
    compiled: Any = numba.njit
    return lambda function: keep(compiled(**options)(function))


_common: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True}
# A product and a sum may become one operation with one rounding. Never "nnan" or "ninf": NaN and inf must be found.
_fused = {"contract", "nsz"}

kernel: Any = njit(**_common)
# Called by other kernels only: without the wrapper for Python calls it compiles in half the time.
inner: Any = njit(**_common, no_cpython_wrapper=True)
# The same for what allocates nothing, not even for a slice that is assigned: then no references to arrays need to be
# counted, which would cost a locked instruction for each array that is handed on and a fifth of the compile time.
lean: Any = njit(**_common, _nrt=False, fastmath=_fused)
lean_inner: Any = njit(**_common, _nrt=False, fastmath=_fused, no_cpython_wrapper=True)
# Put whole into its caller: arrays are handed on as ten numbers each, a dozen of them cost as much as twenty nodes.
inlined: Any = njit(**_common, _nrt=False, fastmath=_fused, no_cpython_wrapper=True, forceinline=True)
# Sums may be re-ordered so that loops with a sum vectorise; nothing may rely on the order.
summing: Any = njit(**_common, _nrt=False, fastmath={"reassoc", *_fused})


class _Compiling(events.Listener):
    """Says when the compiler is at work, which must not be interrupted halfway."""

    def on_start(self, event: events.Event) -> None:
        note_compiling(True)

    def on_end(self, event: events.Event) -> None:
        note_compiling(False)


# Not of its lock: that is taken as well to fetch a kernel from the cache.
events.register("numba:compile", _Compiling())


def records(count: int, kind: np.dtype[Any]) -> Any:
    """Empty records, (count,): kernels reach fields as attributes, which plain Python knows of a class of its own only.

    With NUMBA_DISABLE_JIT=1 all kernels run as plain Python, which finds indices that are out of bounds.
    """
    empty = np.zeros(count, kind)
    return empty.view(np.recarray) if config.DISABLE_JIT else empty


def entry_of(dispatcher: Any, arguments: Sequence[Any]) -> Callable[..., Any]:
    """The compiled code for arguments of these types, to be called again with others of the same types and layouts.

    Finding out the types of sixty arrays costs as much as thousands of nodes: once is enough. What is None counts as
    left out, so that everybody without it shares one kernel in the cache.
    """
    if not hasattr(dispatcher, "compile"):  # plain Python
        return dispatcher  # type: ignore[no-any-return]
    kinds = [numba.types.Omitted(None) if argument is None else numba.typeof(argument) for argument in arguments]
    return dispatcher.compile(tuple(kinds))  # type: ignore[no-any-return]
