"""What is kept of a run: `largest_tension`, `max tension`, `std walker.speed`, `sigma pantographs.front`."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Callable, Sequence
from difflib import SequenceMatcher
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.errors import Problem, ScenarioError, did_you_mean
from ropewalk.mechanics.chain import Array
from ropewalk.results import named_numbers, named_texts, series_table
from ropewalk.results.after_start import AFTER_START
from ropewalk.results.contract import PATHS
from ropewalk.results.line_response import LEAST as LEAST_FRAMES
from ropewalk.sweeps.batch_means import half_width
from ropewalk.sweeps.keys import ends_with

if TYPE_CHECKING:
    import xarray as xr

Measured = dict[str, tuple[float | None, str]]
"""Values by the names that were asked for, with their units; None: the run has none."""

_MEASURES: dict[str, Callable[..., Any]] = {"max": np.max, "min": np.min, "mean": np.mean, "std": np.std}
_SAME = {"sigma": "std", "largest": "max", "smallest": "min", "average": "mean"}
# How numbers of a summary are called that are such a measure: before their name, and after it.
_BEFORE = {"max": "largest_", "min": "smallest_"}
_AFTER = {
    "max": ("max", "maximum"), "min": ("min", "minimum"), "mean": ("mean",), "std": ("std", "deviation"),
}  # fmt: skip
_INTERVAL = "interval of "
# What counts broken limits, and the text next to it that names them, in the entries of a summary that judge.
_COUNT, _NAMES, _JUDGED = "limits.failures", "limits.broken", frozenset({"pantographs"})
_OF_ALL = {"contact_force": "contacts.*.force.magnitude"}
_ALMOST = 0.9  # how much of a misprinted measure has to agree
_ALIKE, _ALIKE_IF_SHORT, _SHORT = 0.8, 0.66, 4  # how much of two words has to agree; of those of few letters less
_NONE = "a run of this kind has no such quantity"
_FORM = "write a name of the summary, or max, min, mean or std of one or of a column of the table of series"


def measured(dataset: xr.Dataset, names: Sequence[str]) -> Measured:
    """The quantities of a result.

    Args:
        dataset: a result.
        names: as above.

    Raises:
        ScenarioError: a result of this kind has no such quantities; with all that are unknown.
    """
    alike = (tuple(names), *_structure(dataset))
    if alike in _WANTED:
        try:
            return _Result(dataset, _WANTED[alike]).all(names)
        except ScenarioError:
            del _WANTED[alike]  # its summary has other numbers
    result = _Result(dataset)
    found = result.all(names)
    if len(_WANTED) == _MOST:
        _WANTED.clear()
    _WANTED[alike] = frozenset(name.partition(".")[0] for name in result.used)
    return found


_WANTED = dict[tuple[Any, ...], frozenset[str]]()
"""Entries of summaries that were needed, by names and structures of results: a summary takes longer than small runs."""
_MOST = 64


def _structure(dataset: xr.Dataset) -> tuple[Any, ...]:
    """What results have in common whose summaries have the same names."""
    sizes = tuple((str(name), size) for name, size in dataset.sizes.items() if name not in PATHS)
    labels = (tuple(dict.fromkeys(dataset[name].values.tolist())) for name in ("line", "load", "support"))
    return (sizes, *labels, *(name in dataset.sizes for name in PATHS))


def broken_name(name: str) -> str | None:
    """What the column is called that names the limits which a quantity counts; None of one that counts none."""
    return f"{name.strip().removesuffix(_COUNT)}{_NAMES}" if name.strip().endswith(_COUNT) else None


def broken_limits(dataset: xr.Dataset, names: Sequence[str]) -> dict[str, str]:
    """The limits that are broken, in words, by the quantities that count them; empty where none is.

    Args:
        dataset: a result.
        names: quantities of it.
    """
    counts = [name for name in names if broken_name(name) is not None]
    if not counts:
        return {}
    numbers, texts = named_numbers(dataset, _JUDGED), named_texts(dataset, _JUDGED)
    found = {name: _among(numbers, [name.strip()]) for name in counts}
    return {name: texts.get(str(broken_name(keys[0])), "") for name, keys in found.items() if len(keys) == 1}


class _Result:
    """The numbers of a result by their names; `used` are those that were asked for.

    Args:
        dataset: a result.
        only: entries of its summary that are looked at (default: all).
    """

    def __init__(self, dataset: xr.Dataset, only: frozenset[str] | None = None) -> None:
        self.numbers = named_numbers(dataset, only)
        self.used = set[str]()
        self._dataset = dataset

    @cached_property
    def series(self) -> dict[str, tuple[Array, str]]:
        """All that changes over the output instants: values and unit, by name."""
        found = {}
        table = series_table(self._dataset)
        for column in table.columns:
            name, _, unit = str(column).rpartition(" [")
            found[name] = table[column].to_numpy(dtype=np.float64), unit.removesuffix("]")
        return found

    def all(self, names: Sequence[str]) -> Measured:
        """The values, or all mistakes in the names."""
        problems, found = list[Problem](), Measured()
        for name in names:
            try:
                found[name] = self.one(name)
            except ScenarioError as error:
                problems += error.problems
        if problems:
            raise ScenarioError(problems)
        return found

    def one(self, asked: str) -> tuple[float | None, str]:
        """The value of one name."""
        name = _spoken(asked)
        if name != asked and not _among(self.numbers, [name]) and not self._has_static_parts():
            raise _unknown(asked, "this run has no static parts", "write outputs: {impact: true}")
        if name.startswith(_INTERVAL):
            return self._interval(name)
        measure, _, what = name.strip().partition(" ")
        measure, what = _SAME.get(measure, measure), what.strip()
        if measure in _MEASURES and what:
            return self._reduced(name, measure, what)
        keys = _among(self.numbers, [name.strip()])
        if len(keys) > 1:
            raise _unknown(name, f"may be {' or '.join(keys[:4])}", "write more of the name")
        if not keys:
            raise _unknown(name, _NONE, _remedy(name, self._names()))
        self.used.add(keys[0])
        return self.numbers[keys[0]]

    def _reduced(self, name: str, measure: str, what: str) -> tuple[float | None, str]:
        what = _OF_ALL.get(what, what)
        quantity, of, owner = what.partition(" of ")
        what = f"{owner.strip()}.{quantity.strip().replace('lateral ', 'lateral_')}" if of else what
        before = _BEFORE.get(measure, "") + what
        keys = _among(self.numbers, [before] * (measure in _BEFORE) + [f"{what}.{word}" for word in _AFTER[measure]])
        columns = [] if keys else _among(self.series, [what])
        if not keys and not columns:
            known = [f"{measure} {known}" for known in self._names(measure)]
            raise _unknown(name, _NONE, _remedy(name, [*known, *self.numbers]))
        if len(keys) + len(columns) > 1 and ("*" not in what or measure not in _BEFORE):
            found = " or ".join((keys or columns)[:4])
            raise _unknown(name, f"may be {found}", "write more of the name, or * in it for max and min of all")
        self.used.update(keys)
        if keys:
            self._refuse_coarse(name, keys)
            if len(keys) == 1:  # it is such a measure by itself
                return self.numbers[keys[0]]
            values = np.array([value for key in keys if (value := self.numbers[key][0]) is not None])
            unit = self.numbers[keys[0]][1]
        else:
            values = np.concatenate([self.series[column][0] for column in columns])
            unit = self.series[columns[0]][1]
        kept = values[np.isfinite(values)]
        return (float(_MEASURES[measure](kept)) if kept.size else None), unit

    def _interval(self, name: str) -> tuple[float | None, str]:
        """Half the width of the interval of a mean or deviation over time; None of records that are too short."""
        measure, _, what = name.removeprefix(_INTERVAL).strip().partition(" ")
        measure, columns = _SAME.get(measure, measure), _among(self.series, [what.strip()])
        if measure not in ("mean", "std") or len(columns) != 1:
            known = [f"{_INTERVAL}{measure} {column}" for column in self.series]
            remedy = did_you_mean(name, known, "write interval of mean, or std, and a column of the series")
            raise _unknown(name, "a run of this kind has no such interval", remedy)
        values, unit = self.series[columns[0]]
        return half_width(values, measure), unit

    def _refuse_coarse(self, name: str, keys: Sequence[str]) -> None:
        """Refuse accelerations that output instants are too far apart for."""
        frames = self._dataset.sizes.get("time", 0)
        if frames >= LEAST_FRAMES and any(".acceleration." in key and self.numbers[key][0] is None for key in keys):
            remedy = "write a run.every of a quarter of the period of outputs.cut_off, 8 ms for 30 Hz, or less"
            raise _unknown(name, "output instants are too far apart for it", remedy)

    def _has_static_parts(self) -> bool:
        return any(name.endswith(".static") for name in self.numbers)

    def _names(self, measure: str = "") -> list[str]:
        """What can be asked for: of a measure without the word for it."""
        if not measure:
            return list(self.numbers)
        first = _BEFORE.get(measure, " ")
        names = [known.removeprefix(first) for known in self.numbers if known.startswith(first)]
        last = [f".{word}" for word in _AFTER[measure]]
        names += [known[: -len(end)] for known in self.numbers for end in last if known.endswith(end)]
        of_all = [short for short, pattern in _OF_ALL.items() if fnmatch.filter(self.numbers, f"{pattern}.*")]
        return [*names, *of_all, *self.series]


def _spoken(name: str) -> str:
    """Names of static parts and impact factors as they are spoken, as the summary has them."""
    words = name.strip()
    if words.startswith("impact factor of "):
        quantity, of, owner = words.removeprefix("impact factor of ").rpartition(" of ")
        return f"{owner}.{quantity if of else 'deflection'}.impact"
    if words.startswith("static ") and " of " in words:
        quantity, _, owner = words.removeprefix("static ").partition(" of ")
        return f"{owner}.{quantity}.static"
    return name


def _among(known: Any, wanted: Sequence[str]) -> list[str]:
    """Names that are wanted, that end so, or that a pattern fits; the first of several wishes that finds any."""
    for wish in wanted:
        if wish in known:
            return [wish]
        found = [name for name in known if ends_with(name, wish)]
        found = [name for name in found if not name.startswith(AFTER_START)] or found  # the whole run comes first
        if "*" in wish:
            found = fnmatch.filter(known, wish)
        if found:
            return found
    return []


def _remedy(name: str, known: Sequence[str]) -> str:
    """What to write for a name that is not known: one with all of its words, those with most of them, or any."""
    wanted = _words(name)
    shared = {other: sum(_is_alike(word, _words(other)) for word in wanted) for other in dict.fromkeys(known)}
    most = max(shared.values(), default=0)
    measures = {word for word in re.split(r"[\s._]+", name) if word in {*_MEASURES, *_SAME}}

    def distance(other: str) -> tuple[int, int]:
        parts = re.split(r"[\s._]+", other)
        return len(measures.difference(parts)), len(parts)

    alike = sorted((other for other in shared if shared[other] == most > len(wanted) / 2), key=distance)
    if alike and most == len(wanted):
        return f"did you mean {alike[0]}?"
    first = "known with such a word" if alike else "known"
    some = [*(alike or shared)][:4]
    return f"{first}: {', '.join(some)}{', ...' if len(alike or shared) > 4 else ''}; {_FORM}"


def _words(name: str) -> list[str]:
    """Words of a name, without those of its measure, misprinted or not."""
    return [word for word in re.split(r"[\s._]+", name.lower()) if word and not _is_measure(word)]


def _is_measure(word: str) -> bool:
    likeness = max(SequenceMatcher(None, word, measure).ratio() for measure in (*_MEASURES, *_SAME))
    return likeness >= (_ALMOST if len(word) > _SHORT else 1.0)


def _is_alike(word: str, others: Sequence[str]) -> bool:
    """Whether a word is one of others, or two of them together, but for a misprint."""
    for other in (*others, *map("".join, pairwise(others))):
        least = _ALIKE if min(len(word), len(other)) > _SHORT else _ALIKE_IF_SHORT
        if word == other or SequenceMatcher(None, word, other).ratio() >= least:
            return True
    return False


def _unknown(name: str, wrong: str, remedy: str) -> ScenarioError:
    return ScenarioError([Problem("sweep.record", wrong, repr(name), remedy)])
