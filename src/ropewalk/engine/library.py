"""The compiled core: found, loaded and checked once."""

from __future__ import annotations

import ctypes
import sys
from functools import cache
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.errors import RopewalkError

VERSION = 3
"""Version of the interface that is spoken here."""
VARIANTS = ("baseline", "avx2", "avx512")
"""Instruction sets that the core is compiled for, by their numbers; elsewhere than on x86-64 only the first."""
Elementary = Literal["exp", "log", "sin", "cos", "atan2", "pow"]
_FUNCTIONS: tuple[str, ...] = get_args(Elementary)
PATH = Path(__file__).with_name({"win32": "core.dll", "darwin": "core.dylib"}.get(sys.platform, "core.so"))
"""Path of the library."""
_NUMBER, _ADDRESS, _DOUBLES = ctypes.c_int64, ctypes.c_void_p, ctypes.POINTER(ctypes.c_double)
_ARGUMENTS: dict[str, list[Any]] = {
    "version": [], "has_variant": [_NUMBER], "elementary": [*[_NUMBER] * 3, *[_DOUBLES] * 3],
    "layout": [_NUMBER, _ADDRESS, _ADDRESS], "bind": [_ADDRESS] * 3,
    "advance": [_NUMBER, _ADDRESS, *[_NUMBER] * 3, ctypes.c_double, _ADDRESS, _ADDRESS],
    "forces": [_ADDRESS] * 3, "energies": [_ADDRESS] * 2, "contacts": [_ADDRESS] * 2,
    "entries": [_ADDRESS], "linearise": [_ADDRESS] * 7,
    "sheaves": [_ADDRESS] * 2, "pass": [_ADDRESS],
}  # fmt: skip
"""Arguments of the functions of the core, which return whole numbers."""


@cache
def library(path: Path = PATH) -> ctypes.CDLL:
    """Load the core.

    Args:
        path: of the library.

    Raises:
        RopewalkError: it has not been compiled, or is of another version than this package.
    """
    try:
        found = ctypes.CDLL(str(path))
    except OSError as error:
        raise RopewalkError(
            f"{path.name}: the compiled core cannot be loaded ({error}); install ropewalk anew"
        ) from error
    for name, arguments in _ARGUMENTS.items():
        function = getattr(found, f"rw_{name}", None)
        if function is not None:  # else of another version
            function.argtypes, function.restype = arguments, ctypes.c_int64
    if (version := found.rw_version()) != VERSION:
        raise RopewalkError(
            f"{path.name}: the compiled core has version {version} of the interface, this package needs {VERSION}; "
            "install ropewalk anew (in a checkout: make core)"
        )
    found.rw_fields.argtypes, found.rw_fields.restype = [], ctypes.c_char_p
    return found


def variants() -> tuple[str, ...]:
    """Return the instruction sets that run on this processor, the widest last."""
    return tuple(name for number, name in enumerate(VARIANTS) if library().rw_has_variant(number))


def elementary(name: Elementary, x: ArrayLike, y: ArrayLike = 0.0, variant: str | None = None) -> NDArray[np.float64]:
    """Return the values of an elementary function of the core, which has the same bits on every platform.

    Args:
        name: of the function.
        x: first argument, any shape.
        y: second argument of `atan2` (where it is the abscissa) and `pow`, broadcast against x.
        variant: instruction set; None: the widest one.
    """
    number = VARIANTS.index(variant or variants()[-1])
    first, second = (np.ascontiguousarray(each, dtype=np.float64) for each in np.broadcast_arrays(x, y))
    values = np.empty_like(first)
    pointers = (each.ctypes.data_as(_DOUBLES) for each in (first, second, values))
    if library().rw_elementary(number, _FUNCTIONS.index(name), values.size, *pointers):
        raise RopewalkError(f"the core has no variant {variant} for this processor; use {', '.join(variants())}")
    return values
