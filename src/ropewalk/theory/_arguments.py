"""Checks of arguments, with messages that name the argument, what was given and what is allowed."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["finite", "not_negative", "positive", "vectors", "within"]


def _is_finite(value: ArrayLike) -> bool:
    """Whether it is a finite number; text is none, nor is an integer of 400 digits."""
    try:
        return bool(np.isfinite(value))
    except (TypeError, ValueError):
        return False


def positive(**values: float) -> None:
    """Raise `ValueError` unless all values are finite and positive."""
    for name, value in values.items():
        if not (_is_finite(value) and value > 0.0):
            raise ValueError(f"{name} must be finite and positive, not {value}")


def not_negative(**values: float) -> None:
    """Raise `ValueError` unless all values are finite and zero or positive."""
    for name, value in values.items():
        if not (_is_finite(value) and value >= 0.0):
            raise ValueError(f"{name} must be finite and not negative, not {value}")


def finite(**values: ArrayLike) -> None:
    """Raise `ValueError` unless all values, which may be arrays, are finite."""
    for name, value in values.items():
        try:
            good = bool(np.all(np.isfinite(value)))
        except TypeError:  # no numbers
            good = False
        if not good:
            raise ValueError(f"{name} must be finite, not {value!r}")


def within(low: float, high: float, **values: ArrayLike) -> tuple[NDArray[np.float64], ...]:
    """Return the values as arrays; raise `ValueError` unless they all lie between low and high, ends included."""
    arrays = []
    for name, value in values.items():
        array = np.asarray(value, dtype=np.float64)
        if not np.all((array >= low) & (array <= high)):
            raise ValueError(f"{name} must lie between {low:g} and {high:g}")
        arrays.append(array)
    return tuple(arrays)


def vectors(size: int, **values: ArrayLike) -> None:
    """Raise `ValueError` unless all values have ``size`` numbers along their last axis."""
    for name, value in values.items():
        shape = np.shape(value)
        if not shape or shape[-1] != size:
            raise ValueError(f"{name} must have {size} numbers along its last axis, not the shape {shape}")
