"""Pantographs below overhead lines that overlap: their contacts with several wires taken together."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.model.overlap import course_of
from ropewalk.model.pantograph import Pantograph
from ropewalk.results.frame import Array

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario

Course = dict[int, tuple[str, float]]
"""Contacts with the lines that they belong to, and how far ahead of the pantograph's own line these begin, m."""


def courses(scenario: Scenario | None, contacts: list[str]) -> dict[str, Course]:
    """The contacts of all pantographs below several lines, in the order of these along x, by the pantograph's name."""
    out = {}
    for name, load in scenario.loads.items() if scenario is not None else ():
        if scenario is None or not isinstance(load, Pantograph) or load.on not in scenario.overhead_lines:
            continue
        lines = course_of(scenario.overhead_lines, load.on)
        if len(lines) > 1:
            labels = {key: name if key == load.on else f"{name}.{key}" for key in lines}
            out[name] = {contacts.index(labels[key]): (key, ahead) for key, ahead in lines.items()}
    return out


def together(scenario: Scenario | None, contacts: list[str], of: dict[str, Array]) -> dict[str, Array]:
    """Samples in which the first contact of each pantograph stands for all of its contact wires.

    Args:
        scenario: of the run.
        contacts: their names.
        of: `station` in m, `force` in N and `height` in m, (instant, contact).

    Returns:
        The same, with the force of the head, stations that go on along all lines, and the height of the wire that bears
        more of it, or is the lower one where none does; and `share` in N, what each contact has of the force. Nothing
        where no lines overlap.
    """
    several = courses(scenario, contacts)
    if not several:
        return {}
    out = {key: values.copy() for key, values in of.items()}
    for name, course in several.items():
        numbers, k = list(course), contacts.index(name)
        station, force, height = (of[key][:, numbers] for key in ("station", "force", "height"))
        on = np.isfinite(station) & np.isfinite(force)
        row, nowhere = np.arange(len(on)), ~on.any(axis=1)
        pressed, low = np.where(on, force, 0.0), np.where(on, height, np.inf)
        bears = np.where((pressed > 0.0).any(axis=1), pressed.argmax(axis=1), low.argmin(axis=1))
        along = station + [ahead for _, ahead in course.values()]
        out["force"][:, k], out["height"][:, k] = pressed.sum(axis=1), height[row, bears]
        out["station"][:, k] = along[row, on.argmax(axis=1)]
        for values in out.values():
            values[nowhere, k] = np.nan
    return out | {"share": of["force"]}


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
    several = courses(scenario, flat["load"].values.tolist())
    out: dict[str, list[dict[str, Any]]] = {name: [] for name in several}
    time = flat["time"].values
    for name, course in several.items():
        station = flat["station"].values[
            :, next(k for k, (_, ahead) in course.items() if flat["load"].values[k] == name)
        ]
        seen = station[np.isfinite(station)]
        onward = seen.size < 2 or seen[-1] >= seen[0]
        for pair in pairwise(list(course) if onward else reversed(course)):
            one, two = (np.nan_to_num(flat["share"].values[:, k]) > 0.0 for k in pair)
            if one.any() and two.any():
                step = float(np.median(np.diff(time)))
                out[name].append(
                    {
                        "from_line": course[pair[0]][0],
                        "to_line": course[pair[1]][0],
                        "first": float(station[np.flatnonzero(two)[0]]),
                        "last": float(station[np.flatnonzero(one)[-1]]),
                        "together": step * float((one & two).sum()),
                    }
                )
    return out
