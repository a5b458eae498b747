"""The reference file: references of all cases in a few megabytes.

Values are integers in units of a QUARTER of their tolerance, differences from instant to instant, as planes of bytes,
compressed by LZMA. Names and structures that several cases share are stored once.
"""

from __future__ import annotations

import hashlib
import json
import lzma
import math
from collections.abc import Hashable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .tolerances import Held, Reference

FILE = Path(__file__).with_name("references.xz")
QUARTER = 0.25
STEPS = 32  # tolerances per decade
LOWEST = -12  # decade of the smallest tolerance
NAN = 2**31 - 1
MOST = 2**30  # of an integer: values that are larger get coarser units


class _Table:
    """Values that are stored once."""

    def __init__(self) -> None:
        self.values: list[Any] = []
        self._places: dict[Hashable, int] = {}

    def place(self, value: Any) -> int:
        """Return the index of a value, which is added if it is new."""
        key = json.dumps(value, sort_keys=True)
        if key not in self._places:
            self._places[key] = len(self.values)
            self.values.append(value)
        return self._places[key]


def code_of(tolerance: float) -> int:
    """Return the number that stands for a tolerance, rounded up."""
    return max(0, math.ceil(STEPS * (math.log10(tolerance) - LOWEST) - 1e-9))


def tolerance_of(code: int) -> float:
    """Return the tolerance that a number stands for."""
    return float(10.0 ** (code / STEPS + LOWEST))


def write(references: Iterable[Reference], file: Path = FILE) -> None:
    """Write the reference file."""
    tables = {name: _Table() for name in ("structures", "names", "shapes")}
    integers: list[NDArray[np.int64]] = []
    floats: list[float] = []
    cases = []
    for found in references:
        labels = {label: tables["structures"].place(value) for label, value in found.structure.items()}
        codes = []
        for held in found.quantities.values():
            code = max(code_of(held.tolerance), code_of(_most(held.values) / (QUARTER * MOST)))
            codes.append(code)
            integers.append(_integers(held.values, tolerance_of(code)))
        floats.extend(value for value, _ in found.numbers.values())
        cases.append([
            found.name, found.mark, found.outcome, found.exit_code, found.keys, labels,
            tables["names"].place(list(found.quantities)),
            tables["shapes"].place([list(held.values.shape) for held in found.quantities.values()]), codes,
            tables["names"].place(list(found.numbers)), [code_of(own) for _, own in found.numbers.values()],
            round(found.cpu, 2),
        ])  # fmt: skip
    whole = np.concatenate([*integers, np.empty(0, np.int64)])
    planes = (whole << 1 ^ whole >> 63).astype("<u8").view(np.uint8).reshape(-1, 8)[:, :5].T.tobytes()
    singles = np.array(floats, dtype="<f4").view(np.uint8).reshape(-1, 4).T.tobytes()
    head = json.dumps({
        **{name: table.values for name, table in tables.items()}, "cases": _columns(cases), "integers": len(whole),
        "floats": len(floats),
    }, separators=(",", ":")).encode()  # fmt: skip
    data = len(head).to_bytes(8, "little") + head + planes + singles
    file.write_bytes(lzma.compress(data, preset=9 | lzma.PRESET_EXTREME))


def read(file: Path = FILE) -> dict[str, Reference]:
    """Return all references by name."""
    data = lzma.decompress(file.read_bytes())
    size = 8 + int.from_bytes(data[:8], "little")
    head = json.loads(data[8:size])
    count = head["integers"]
    planes = np.frombuffer(data, np.uint8, 5 * count, size).reshape(5, count)
    folded = sum(planes[k].astype(np.int64) << 8 * k for k in range(5)) if count else np.empty(0, np.int64)
    whole = (folded >> 1) ^ -(folded & 1)
    singles = np.frombuffer(data, np.uint8, 4 * head["floats"], size + 5 * count).reshape(4, -1)
    floats = np.ascontiguousarray(singles.T).view("<f4").ravel().astype(float)
    found, at, place = {}, 0, 0
    for row in zip(*head["cases"], strict=True):
        name, mark, outcome, exit_code, keys, labels, quantities, shapes, codes, paths, own, cpu = row
        structure = {label: head["structures"][index] for label, index in labels.items()}
        case = Reference(name, mark, outcome, exit_code, keys, structure, cpu=cpu)
        for quantity, shape, code in zip(head["names"][quantities], head["shapes"][shapes], codes, strict=True):
            size, tolerance = math.prod(shape), tolerance_of(code)
            case.quantities[quantity] = Held(_values(whole[at : at + size].reshape(shape), tolerance), tolerance)
            at += size
        for path, code in zip(head["names"][paths], own, strict=True):
            case.numbers[path] = float(floats[place]), tolerance_of(code)
            place += 1
        found[name] = case
    return found


def digest(file: Path = FILE) -> str:
    """Return the hash of the reference file."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def _columns(cases: list[list[Any]]) -> list[list[Any]]:
    return [list(column) for column in zip(*cases, strict=True)]


def _integers(values: NDArray[np.float64], tolerance: float) -> NDArray[np.int64]:
    """Return differences along the first axis in units; NaN is a value of its own."""
    absent = np.isnan(values)
    whole = np.rint(np.where(absent, 0.0, values) / (QUARTER * tolerance)).astype(np.int64)
    for k in range(1, len(whole)):  # an absent value repeats the one before: its difference is 0
        whole[k] = np.where(absent[k], whole[k - 1], whole[k])
    change = np.diff(whole, axis=0, prepend=np.zeros_like(whole[:1]))
    return np.where(absent, NAN, change).ravel()


def _values(change: NDArray[np.int64], tolerance: float) -> NDArray[np.float64]:
    absent = change == NAN
    units = np.cumsum(np.where(absent, 0, change), axis=0)
    return np.where(absent, np.nan, units * (QUARTER * tolerance))


def _most(values: NDArray[np.float64]) -> float:
    return max(float(np.nanmax(np.abs(values), initial=0.0)), 1e-300)
