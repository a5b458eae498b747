"""How kernels are compiled: in one place, so that all agree.

`error_model="numpy"` lets loops with a square root or a division vectorise (no exception for a zero divisor); what
is not finite is found by the callers.
"""

from __future__ import annotations

import gc
import time as clock
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numba
import numpy as np
from numba.core import event as events

from ropewalk.interrupts import note_compiling
from ropewalk.mechanics.kernel_cache import keep
from ropewalk.mechanics.kernel_parts import ApartCompiler, PartCompiler

config: Any = numba.config  # its stubs do not know what is read from the environment


class Kernel:
    """A function that is compiled: Numba is given it when something is asked of it.

    That takes a tenth of a millisecond, and of what a run imports, three of four are called by kernels that are there.

    Args:
        function: as it is written.
        compiler: what compiles it.
        options: of Numba.
    """

    def __init__(self, function: Callable[..., Any], compiler: type[PartCompiler], options: dict[str, Any]) -> None:
        self.py_func, self._compiler, self._options = function, compiler, options

    @cached_property
    def dispatcher(self) -> Any:
        """What Numba makes of it."""
        compiled: Any = numba.njit
        return keep(compiled(**self._options, pipeline_class=self._compiler)(self.py_func))

    @property
    def _numba_type_(self) -> Any:  # for which Numba asks, where it stands in another kernel
        return self.dispatcher._numba_type_

    def __call__(self, *given: Any, **named: Any) -> Any:
        """What it computes."""
        return self.dispatcher(*given, **named)

    def __getattr__(self, name: str) -> Any:
        """As Numba has it."""
        if "py_func" not in self.__dict__:  # of a copy that is being made
            raise AttributeError(name)
        return getattr(self.dispatcher, name)


def njit(compiler: type[PartCompiler] = PartCompiler, **options: Any) -> Any:
    """A decorator of kernels."""
    return lambda function: function if config.DISABLE_JIT else Kernel(function, compiler, options)


_common: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True, "forceinline": False}
# A product and a sum may become one operation with one rounding. Never "nnan" or "ninf": NaN and inf must be found.
_fused = {"contract", "nsz"}

kernel: Any = njit(**_common)
# Called by other kernels only: without the wrapper for Python calls it compiles in half the time.
inner: Any = njit(**_common, no_cpython_wrapper=True)
# The same for what allocates nothing, not even for a slice that is assigned: then no references to arrays need to be
# counted, which would cost a locked instruction for each array that is handed on and a fifth of the compile time.
lean: Any = njit(**_common, _nrt=False, fastmath=_fused)
lean_inner: Any = njit(**_common, _nrt=False, fastmath=_fused, no_cpython_wrapper=True)
# The same with one rounding for each operation, as NumPy has it.
exact_inner: Any = njit(**_common, _nrt=False, no_cpython_wrapper=True)
# Put whole into its caller: arrays are handed on as ten numbers each, a dozen of them cost as much as twenty nodes.
inlined: Any = njit(**{**_common, "forceinline": True}, _nrt=False, fastmath=_fused, no_cpython_wrapper=True)
# Sums may be re-ordered so that loops with a sum vectorise; nothing may rely on the order.
summing: Any = njit(**_common, _nrt=False, fastmath={"reassoc", *_fused})
# A loop put whole into its caller, whose arrays share no memory: all of a link or a node is done in one go.
apart: Any = njit(
    ApartCompiler,
    **{**_common, "forceinline": True},
    _nrt=False,
    fastmath={"reassoc", *_fused},
    no_cpython_wrapper=True,
)


# Objects after which Python looks for cycles while it compiles: with its usual 700 that is a tenth of the time.
_GARBAGE = 100_000


class Compiling(events.Listener):
    """What the compiler does: it must not be interrupted halfway, its time is told apart, and it may be watched."""

    def __init__(self) -> None:
        self.seconds = 0.0  # so far in this process
        self.kernels = 0  # begun so far, Numba's own included
        self.progress: Callable[[float, str], None] | None = None  # gets the part that is done, and what is begun
        self._depth, self._since, self._garbage = 0, 0.0, gc.get_threshold()
        self._ahead, self._begun = set[str](), set[str]()  # kernels that the outermost may call, and those begun

    def on_start(self, event: events.Event) -> None:
        """A kernel is begun, maybe within another one."""
        note_compiling(True)
        dispatcher = event.data["dispatcher"]
        if self._depth == 0:
            self._since, self._ahead = clock.perf_counter(), reach(dispatcher)
            self._begun.clear()
            self._garbage = gc.get_threshold()
            gc.set_threshold(max(_GARBAGE, self._garbage[0]) if self._garbage[0] else 0, *self._garbage[1:])
        self._depth += 1
        self.kernels += 1
        if (name := _name(dispatcher)) in self._ahead:
            self._begun.add(name)
            self._tell(name.removeprefix("ropewalk."))

    def on_end(self, event: events.Event) -> None:
        """It is done."""
        note_compiling(False)
        self._depth -= 1
        if self._depth == 0:
            gc.set_threshold(*self._garbage)
            self.seconds += clock.perf_counter() - self._since
            self._begun |= self._ahead
            self._tell("")

    def _tell(self, what: str) -> None:
        if self.progress is not None and self._ahead:
            self.progress((len(self._begun) - min(self._depth, len(self._begun))) / len(self._ahead), what)


compiling = Compiling()
# Not of its lock: that is taken as well to fetch a kernel from the cache.
events.register("numba:compile", compiling)


def is_kept(dispatcher: Any, fits: Callable[[tuple[Any, ...]], bool] = lambda kinds: True) -> bool:
    """Whether the machine code of a kernel is in its cache, for types of arguments that fit; plain Python has it."""
    kept = getattr(getattr(dispatcher, "_cache", None), "signatures", None)
    return kept is None or any(fits(kinds) for kinds in kept())


def reach(dispatcher: Any) -> set[str]:
    """Names of all kernels that a kernel may call, itself included: no more than these must be compiled for it."""
    found, ahead = set[str](), [dispatcher]
    while ahead:
        kernel = ahead.pop()
        if not hasattr(kernel, "py_func") or (name := _name(kernel)) in found or not name.startswith("ropewalk."):
            continue
        found.add(name)
        function = kernel.py_func
        ahead.extend(function.__globals__.get(other) for other in function.__code__.co_names)
    return found


def _name(dispatcher: Any) -> str:
    function = dispatcher.py_func
    return f"{function.__module__}.{function.__name__}"


def records(count: int, kind: np.dtype[Any]) -> Any:
    """Empty records, (count,): kernels reach fields as attributes, which plain Python knows of a class of its own only.

    With NUMBA_DISABLE_JIT=1 all kernels run as plain Python, which finds indices that are out of bounds.
    """
    empty = np.zeros(count, kind)
    return empty.view(np.recarray) if config.DISABLE_JIT else empty


def filled_records(kind: np.dtype[Any], rows: Sequence[Mapping[str, Any]]) -> Any:
    """Records, (row,), with the fields that each row names."""
    filled = records(len(rows), kind)
    for record, row in zip(filled, rows, strict=True):
        for name, value in row.items():
            record[name] = value
    return filled


def entry_of(dispatcher: Any, arguments: Sequence[Any]) -> Callable[..., Any]:
    """The compiled code for arguments of these types, to be called again with others of the same types and layouts.

    Finding out the types of sixty arrays costs as much as thousands of nodes: once is enough. What is None counts as
    left out, so that everybody without it shares one kernel in the cache.
    """
    if not hasattr(dispatcher, "compile"):  # plain Python
        return dispatcher  # type: ignore[no-any-return]
    kinds = [numba.types.Omitted(None) if argument is None else numba.typeof(argument) for argument in arguments]
    return dispatcher.compile(tuple(kinds))  # type: ignore[no-any-return]
