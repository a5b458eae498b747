"""Pantographs with several contacts, below lines that overlap or with two strips: their contacts taken together."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ropewalk.model.overlap import course_of
from ropewalk.model.pantograph import LEADING, Pantograph
from ropewalk.results.frame import Array

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario


class Touched(NamedTuple):
    """The contact wire of a line above a pantograph."""

    ahead: float  # m, by which the line begins ahead of the pantograph's own
    strips: dict[str, tuple[int, float]]  # by name: number of its contact, and how far ahead of the head's middle, m


Course = dict[str, Touched]
"""The lines of a pantograph in their order along x, by name."""


def courses(scenario: Scenario | None, contacts: list[str]) -> dict[str, Course]:
    """The lines and contacts of all pantographs with several contacts, by the pantograph's name."""
    out = {}
    for name, load in scenario.loads.items() if scenario is not None else ():
        if scenario is None or not isinstance(load, Pantograph) or load.on not in scenario.overhead_lines:
            continue
        lines, course = course_of(scenario.overhead_lines, load.on), Course()
        for key, ahead in lines.items():
            wire = name if key == load.on else f"{name}.{key}"
            course[key] = Touched(ahead, {
                strip or LEADING: (contacts.index(f"{wire}.{strip}" if strip else wire), place)
                for strip, place in load.strips.items()
            })  # fmt: skip
        if len(lines) * len(load.strips) > 1:
            out[name] = course
    return out


def together(scenario: Scenario | None, contacts: list[str], of: dict[str, Array]) -> dict[str, Array]:
    """Samples in which the first contact of each pantograph stands for all of its strips and contact wires.

    Args:
        scenario: of the run.
        contacts: their names.
        of: `station` in m, `force` in N and `height` in m, (instant, contact).

    Returns:
        The same, with the force of the head, stations of its middle that go on along all lines, and the height of the
        wire that bears more of it, or is the lower one where none does, in the mean of the strips; and `share` in N,
        what each contact has of the force. Nothing where all pantographs have one contact.
    """
    several = courses(scenario, contacts)
    if not several:
        return {}
    out = {key: values.copy() for key, values in of.items()}
    for name, course in several.items():
        touched = [(each.ahead - place, k) for each in course.values() for k, place in each.strips.values()]
        numbers, k = [number for _, number in touched], contacts.index(name)
        on = np.isfinite(of["station"][:, numbers]) & np.isfinite(of["force"][:, numbers])
        row, nowhere = np.arange(len(on)), ~on.any(axis=1)
        pressed, height = np.where(on, of["force"][:, numbers], 0.0), np.where(on, of["height"][:, numbers], 0.0)
        of_line = (len(on), len(course), -1)  # contacts line by line
        count, force = on.reshape(of_line).sum(axis=2), pressed.reshape(of_line).sum(axis=2)
        level = np.where(count, height.reshape(of_line).sum(axis=2) / np.maximum(count, 1), np.inf)
        bears = np.where((force > 0.0).any(axis=1), force.argmax(axis=1), level.argmin(axis=1))
        along = of["station"][:, numbers] + [ahead for ahead, _ in touched]
        out["force"][:, k], out["height"][:, k] = pressed.sum(axis=1), level[row, bears]
        out["station"][:, k] = along[row, on.argmax(axis=1)]
        for values in out.values():
            values[nowhere, k] = np.nan
    return out | {"share": of["force"]}


def shared(share: Array, numbers: list[int]) -> Array:
    """What some contacts have of a force together, (instant,) N; NaN where all of them are off their wires."""
    own = share[:, numbers]
    return np.where(np.isnan(own).all(axis=1), np.nan, np.nansum(own, axis=1))


def on_lines(course: Course, share: Array) -> dict[str, Array]:
    """What each contact wire has of the force of a head, (instant,) N, by the names of lines."""
    return {key: shared(share, [k for k, _ in each.strips.values()]) for key, each in course.items()}


def on_strips(course: Course, share: Array) -> dict[str, Array]:
    """What each strip has of the force of a head, (instant,) N, by their names; nothing of a single one."""
    names = list(next(iter(course.values())).strips)
    found = {name: shared(share, [each.strips[name][0] for each in course.values()]) for name in names}
    return found if len(names) > 1 else {}


def transitions(scenario: Scenario | None, flat: xr.Dataset) -> dict[str, list[dict[str, Any]]]:
    """Where pantographs go over from one contact wire to the next, by their names.

    Args:
        scenario: of the run.
        flat: what `samples` gives.

    Returns:
        For each overlap that a pantograph has come to, the lines that it comes from and goes to, the stations in m
        along its own line from which it presses on the latter and up to which on the former, and for how long in s on
        both at once.
    """
    names = flat["load"].values.tolist()
    several = {name: course for name, course in courses(scenario, names).items() if len(course) > 1}
    out: dict[str, list[dict[str, Any]]] = {name: [] for name in several}
    time = flat["time"].values
    for name, course in several.items():
        station, share = flat["station"].values[:, names.index(name)], on_lines(course, flat["share"].values)
        seen = station[np.isfinite(station)]
        onward = seen.size < 2 or seen[-1] >= seen[0]
        for pair in pairwise(list(course) if onward else reversed(course)):
            one, two = (np.nan_to_num(share[line]) > 0.0 for line in pair)
            if one.any() and two.any():
                step = float(np.median(np.diff(time)))
                first, last = float(station[two.argmax()]), float(station[np.flatnonzero(one)[-1]])
                places = {"first": first, "last": last, "together": step * float((one & two).sum())}
                out[name].append({"from_line": pair[0], "to_line": pair[1], **places})
    return out
