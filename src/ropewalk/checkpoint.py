"""Checkpoints: all that changes in a run as a tree of arrays and plain values; copied, put back, as bytes and back.

A tree is a dict, list or tuple of trees, an array, bytes, or a text, number, truth value or None. Whatever is in motion
gives one with `get_state` and takes it with `set_state`, for rollback, copies and files alike. As bytes it is JSON text
and the bare bytes of its arrays with a checksum: nothing in it is ever executed.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import RopewalkError

Tree = Any
Arrays = dict[str, NDArray[Any]]

ENGINE_NUMBER = 1
"""Number of the numerical method: raised whenever the state of a run, or the numbers that follow from it, change."""

_MAGIC = b"ropewalk"
_HEAD = len(_MAGIC) + 8 + 32  # then the number of bytes that follow, and their SHA-256
_TYPES = re.compile(r"[<|](f8|f4|i8|i4|i2|i1|u8|u4|u2|u1|b1|c16|c8|V[1-9][0-9]{0,5})")


class CheckpointError(RopewalkError):
    """A state that cannot be stored, or does not fit."""


def arrays_of(group: Any, *names: str) -> Arrays:
    """The arrays of a named tuple themselves, those of tuples within it among them; all, or those with these names."""
    found: Arrays = {}
    for name in names or group._fields:
        value = getattr(group, name)
        if isinstance(value, np.ndarray):
            found[name] = value
        elif hasattr(value, "_fields"):
            found |= {f"{name}.{inner}": array for inner, array in arrays_of(value).items()}
    return found


def copied(tree: Tree) -> Tree:
    """A tree, or a named tuple of arrays, that shares nothing that changes with the first."""
    if isinstance(tree, np.ndarray):
        return _copy(tree)
    if isinstance(tree, dict):
        return {key: copied(value) for key, value in tree.items()}
    if isinstance(tree, list | tuple):
        parts = [copied(value) for value in tree]
        return type(tree)(*parts) if hasattr(tree, "_fields") else type(tree)(parts)
    return tree


def put(arrays: Arrays, values: Tree) -> None:
    """Write values into arrays in place: compiled code keeps those that it was given.

    Raises:
        CheckpointError: they are not of the same names, shapes and types.
    """
    if not isinstance(values, Mapping) or arrays.keys() != values.keys():
        raise CheckpointError("the state is that of another run: it has other parts")
    for name, array in arrays.items():
        here, value = _bare(array), values[name]
        there = _bare(value) if isinstance(value, np.ndarray) else np.zeros(0, "V1")
        if here.shape != there.shape or here.dtype != there.dtype:
            raise CheckpointError(f"the state is that of another run: {name} is of another size or type")
        here[...] = there


class Changing(Protocol):
    """What is in motion in some arrays of its own alone: they are all of its state."""

    def _changing(self) -> dict[str, Arrays]:
        """The arrays that change, in groups."""

    def get_state(self) -> Tree:
        """All that changes."""
        return {name: copied(arrays) for name, arrays in self._changing().items()}

    def set_state(self, tree: Tree) -> None:
        """Be what it was when `get_state` gave this."""
        for name, arrays in self._changing().items():
            put(arrays, tree[name])


def _copy(array: NDArray[Any]) -> NDArray[Any]:
    """A copy; NumPy takes up to a hundred microseconds for the fields of records, and one for their bytes."""
    if array.dtype.names is None:
        return array.copy()
    copy: NDArray[Any] = _bare(array).copy().view(array.dtype).view(type(array))
    return copy


def _bare(array: NDArray[Any]) -> NDArray[Any]:
    """Records as bytes without meaning, all else as it is."""
    array = np.asarray(array)
    return array.view(f"V{array.dtype.itemsize}") if array.dtype.names else array


def to_bytes(tree: Tree) -> bytes:
    """A tree as bytes.

    Raises:
        CheckpointError: something in it is no data.
    """
    parts: list[bytes] = []
    text = json.dumps(_plain(tree, "state", parts), separators=(",", ":")).encode()
    body = b"".join((len(text).to_bytes(8, "little"), text, *parts))
    return b"".join((_MAGIC, len(body).to_bytes(8, "little"), hashlib.sha256(body).digest(), body))


def from_bytes(data: bytes | memoryview) -> Tree:
    """The tree that `to_bytes` has written, whatever stands behind it.

    Raises:
        CheckpointError: it is torn, or no such thing.
    """
    data = memoryview(data)
    size = int.from_bytes(data[len(_MAGIC) : len(_MAGIC) + 8], "little")
    body = data[_HEAD : _HEAD + size]
    if bytes(data[: len(_MAGIC)]) != _MAGIC or len(body) != size or size < 8:
        raise CheckpointError("is no checkpoint")
    if hashlib.sha256(body).digest() != bytes(data[_HEAD - 32 : _HEAD]):
        raise CheckpointError("is torn: its checksum is wrong")
    end = 8 + int.from_bytes(body[:8], "little")
    try:
        tree, _ = _tree(json.loads(bytes(body[8:end])), body[end:])
    except (ValueError, TypeError, LookupError, AttributeError, RecursionError) as error:
        raise CheckpointError("is no checkpoint") from error
    return tree


def _plain(tree: Tree, where: str, parts: list[bytes]) -> Any:
    """What stands for a tree in JSON; the bytes of its arrays are added to the parts."""
    if isinstance(tree, np.generic):
        tree = tree.item()
    if tree is None or isinstance(tree, bool | int | float | str):
        return tree
    if isinstance(tree, list):
        return [_plain(value, f"{where}[{i}]", parts) for i, value in enumerate(tree)]
    if isinstance(tree, tuple) and not hasattr(tree, "_fields"):
        return {"tuple": [_plain(value, f"{where}[{i}]", parts) for i, value in enumerate(tree)]}
    if isinstance(tree, dict) and all(isinstance(key, str) for key in tree):
        return {"dict": {key: _plain(value, f"{where}.{key}", parts) for key, value in tree.items()}}
    if isinstance(tree, bytes):
        parts.append(tree)
        return {"bytes": len(tree)}
    if isinstance(tree, np.ndarray):
        array = _bare(tree)
        kind = array.dtype.str
        if _TYPES.fullmatch(kind):
            parts.append(array.tobytes())
            return {"array": [kind, *array.shape]}
    kind = type(tree).__name__
    raise CheckpointError(f"{where} is no data (of type {kind}): it cannot be stored")


def _tree(plain: Any, rest: memoryview) -> tuple[Tree, memoryview]:
    """The tree that JSON stands for, and what its arrays have left of the bytes."""
    if isinstance(plain, list):
        found = []
        for each in plain:
            value, rest = _tree(each, rest)
            found.append(value)
        return found, rest
    if not isinstance(plain, dict):
        return plain, rest
    ((kind, inner),) = plain.items()
    if kind == "tuple":
        found, rest = _tree(inner, rest)
        return tuple(found), rest
    if kind == "dict":
        values = {}
        for key, each in inner.items():
            values[key], rest = _tree(each, rest)
        return values, rest
    if kind == "bytes":
        return bytes(_cut(rest, inner)), rest[inner:]
    if kind != "array" or not _TYPES.fullmatch(inner[0]):
        raise ValueError("an array of no known type")
    dtype, shape = np.dtype(inner[0]), tuple(int(n) for n in inner[1:])
    if min(shape, default=0) < 0:
        raise ValueError("an array of no size")
    size = math.prod(shape) * dtype.itemsize
    return np.frombuffer(_cut(rest, size), dtype).reshape(shape).copy(), rest[size:]


def _cut(rest: memoryview, size: int) -> memoryview:
    if not 0 <= size <= len(rest):
        raise ValueError("the file has fewer bytes than declared")
    return rest[:size]
