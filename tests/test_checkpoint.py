"""The changing state of a run as bytes: all of it comes back, and nothing in a stranger's bytes does harm."""

from __future__ import annotations

import hashlib
import json
import math
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from ropewalk.checkpoint import CheckpointError, arrays_of, copied, from_bytes, put, to_bytes

RECORD = np.dtype([("x", "f8"), ("code", "i4"), ("r", "f8", (3,))], align=True)


class Inner(NamedTuple):
    q: NDArray[np.float64]


class Group(NamedTuple):
    r: NDArray[np.float64]
    room: Inner
    step: float


def test_a_tree_comes_back_to_the_last_bit() -> None:
    tree = {
        "a": np.array([0.1, -0.0, np.nan, np.inf, 5e-324]), "b": np.arange(6).reshape(2, 3).T, "none": None,
        "c": (1, 2.5, "text", b"\x00\xff"), "d": [{"e": np.zeros((0, 3))}, True], "nan": math.nan, "big": 2**80,
        "complex": np.array([1 + 2j]), "flags": np.array([True, False]), "third": 1.0 / 3.0,
    }  # fmt: skip
    back = from_bytes(to_bytes(tree))
    assert back.keys() == tree.keys()
    for name, value in tree.items():
        if isinstance(value, np.ndarray):
            assert back[name].dtype == value.dtype
            assert np.array_equal(back[name], value, equal_nan=True)
            assert back[name].tobytes() == np.ascontiguousarray(value).tobytes()
    assert (back["c"], back["big"], back["third"]) == (tree["c"], tree["big"], tree["third"])
    assert math.isnan(back["nan"])
    assert back["d"][0]["e"].shape == (0, 3)
    assert back["d"][1] is True


def test_values_are_put_in_place_records_among_them() -> None:
    group, records = Group(np.ones(3), Inner(np.arange(2.0)), 0.5), np.zeros(2, RECORD)
    records["r"][1] = 1.0, 2.0, 3.0
    arrays = {**arrays_of(group), "records": records}
    kept = from_bytes(to_bytes(copied(arrays)))
    assert arrays.keys() == {"r", "room.q", "records"}
    group.r[:], group.room.q[:] = 7.0, 7.0
    records["r"] = 7.0
    put(arrays, kept)
    assert group.r.tolist() == [1.0, 1.0, 1.0]
    assert group.room.q.tolist() == [0.0, 1.0]
    assert records["r"][1].tolist() == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    "values",
    [{"r": np.zeros(4)}, {"r": np.zeros(3, np.int64)}, {"r": [0.0, 0.0, 0.0]}, {"x": np.zeros(3)}, {}, None],
)
def test_values_that_do_not_fit_are_refused(values: Any) -> None:
    array = np.ones(3)
    with pytest.raises(CheckpointError, match="the state is that of another run"):
        put({"r": array}, values)
    assert array.tolist() == [1.0, 1.0, 1.0]


@pytest.mark.parametrize("thing", [object(), {1: 2}, {"f": print}, [np.array([None])], Inner(np.zeros(1))])
def test_what_is_no_data_is_refused_with_its_place(thing: Any) -> None:
    with pytest.raises(CheckpointError, match=r"^state\.motion.* is no data"):
        to_bytes({"motion": thing})


def test_every_torn_byte_is_noticed() -> None:
    data = to_bytes({"r": np.arange(3.0), "n": 1})
    for i in range(len(data)):
        torn = bytearray(data)
        torn[i] ^= 1
        with pytest.raises(CheckpointError):
            from_bytes(bytes(torn))
        with pytest.raises(CheckpointError):
            from_bytes(data[:i])


def forged(text: str, rest: bytes = b"") -> bytes:
    """Bytes with a right checksum."""
    body = len(text).to_bytes(8, "little") + text.encode() + rest
    return b"ropewalk" + len(body).to_bytes(8, "little") + hashlib.sha256(body).digest() + body


@pytest.mark.parametrize(
    "text",
    [
        '{"array": ["|O", 1]}', '{"array": ["<f8", -1]}', '{"array": ["<f8", 1000000000000]}', '{"array": []}',
        '{"array": ["<f8", "1e9"]}', '{"array": [["<f8"], 1]}', '{"bytes": 99}', '{"bytes": -1}',
        '{"call": "os.system"}', '{"dict": [1]}', '{"dict": {}, "tuple": []}', "{", "[" * 100_000, '{"tuple": 3}',
    ],
)  # fmt: skip
def test_strange_bytes_do_no_harm(text: str) -> None:
    with pytest.raises(CheckpointError, match="is no checkpoint"):
        from_bytes(forged(text, b"12345678"))


def test_a_forged_whole_is_read() -> None:
    assert from_bytes(forged(json.dumps({"tuple": [1, {"bytes": 2}]}), b"ab")) == (1, b"ab")
