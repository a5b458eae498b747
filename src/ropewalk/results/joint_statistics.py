"""Joints with a mass in the summary of a result: where they are, and the force of the lines on them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.results.contact_statistics import scenario_of
from ropewalk.results.contract import path_name
from ropewalk.results.declared import declared
from ropewalk.results.display_units import Column, Row, number
from ropewalk.results.extremes import Summary, span, vector
from ropewalk.results.frame import Array

if TYPE_CHECKING:
    import xarray as xr

MANY, LARGEST = 8, 3  # with more joints than this only so many of them get rows
_ENDS = {"start": 0, "end": -1}


def joint_summary(dataset: xr.Dataset) -> dict[str, Summary]:
    """Give for every joint with a mass its `mass`, its range of places, and the `force` of the lines on it.

    Places are ranges over the output instants by axis, with the `last` one. The force is the resultant of the tensions
    of the lines that end there, N. Where shear or sheaves pull as well it is m (a + g), less the constant force on the
    joint, with the acceleration from velocities at the output instants.

    Args:
        dataset: a result.
    """
    joints, lines = declared(dataset, "joints"), declared(dataset, "lines")
    if not dataset.sizes[path_name(dataset)]:
        return {}
    found = {}
    for name, joint in joints.items():
        ends = [
            (line, end)
            for line, own in lines.items() for end in _ENDS
            if (own.get(f"{end}_support") or {}).get("to") == name
        ]  # fmt: skip
        if joint.get("mass") and ends:
            stiff = any(lines[line].get("bending_stiffness") for line, _ in ends)
            carries = any(
                wheel.get("to") == name for line in lines.values() for wheel in (line.get("sheaves") or {}).values()
            )
            by_tension = np.sum([_pull(dataset, line, end) for line, end in ends], axis=0)
            force = _inertia(dataset, joint, ends[0]) if stiff or carries else by_tension
            found[name] = _joint(dataset, float(joint["mass"]), ends, force)
    return found


def _inertia(dataset: xr.Dataset, joint: Summary, end: tuple[str, str]) -> Array:
    """Force of the lines on a joint from its motion, (frame, axis) N."""
    scenario, path = scenario_of(dataset), dataset[path_name(dataset)].values
    own = np.flatnonzero(dataset["line"].values == end[0])[_ENDS[end[1]]]
    speed = np.nan_to_num(dataset["velocity"].isel(node=int(own)).values)
    moves = path_name(dataset) == "time" and path.size > 2
    needed = np.gradient(speed, path, axis=0, edge_order=2) if moves else np.zeros_like(speed)
    needed[:, -1] += 0.0 if scenario is None else scenario.gravity
    constant = np.zeros(speed.shape[1])
    given = joint.get("force") or (0.0, 0.0)
    constant[[0, -1]] = given[0], given[-1]
    if len(given) == 3 and constant.size == 3:
        constant[1] = given[1]
    return np.asarray(float(joint["mass"]) * needed - constant)


def _joint(dataset: xr.Dataset, mass: float, ends: list[tuple[str, str]], force: Array) -> Summary:
    place, axes = _nodes(dataset, *ends[0])[:, 0], dataset["axis"].values.tolist()
    places = {axis: {"unit": "m", **span(place[:, k]), "last": place[-1, k]} for k, axis in enumerate(axes)}
    return {"mass": {"value": mass, "unit": "kg"}, "place": places, "force": vector(dataset, force)}


def _nodes(dataset: xr.Dataset, line: str, end: str) -> Array:
    """Places of the last node of a line at one end and of the one before it, (frame, 2, axis) m."""
    own = np.flatnonzero(dataset["line"].values == line)
    pair = own[:2] if end == "start" else own[:-3:-1]
    return np.asarray(dataset["position"].isel(node=pair).values)


def _pull(dataset: xr.Dataset, line: str, end: str) -> Array:
    """Force of a line on what its end is joined to, (frame, axis) N."""
    links = np.flatnonzero(dataset["link_line"].values == line)
    tension = dataset["tension"].isel(link=links[_ENDS[end]]).values
    there = _nodes(dataset, line, end)
    away = there[:, 1] - there[:, 0]
    return np.asarray(tension[:, None] * away / np.linalg.norm(away, axis=1)[:, None])


def joint_rows(joints: dict[str, Summary], say: Column) -> Iterator[Row]:
    """Rows of a table: joints with a mass, of many the heaviest ones.

    Args:
        joints: of the summary.
        say: numbers in words.
    """
    order = sorted(joints, key=lambda name: -joints[name]["mass"]["value"]) if len(joints) > MANY else list(joints)
    for name in order[: LARGEST if len(joints) > MANY else None]:
        joint = joints[name]
        yield f"Joint {name}", "", ""
        yield "mass", f"{number(joint['mass']['value'])} kg", ""
        for axis, own in joint["place"].items():
            moves = own["max"] - own["min"] > 1e-9
            last = f"{say.place(own['last'])} at the end" if moves else ""
            ends = f"{say.place(own['min'], with_unit=False)} to {say.place(own['max'])}"
            yield f"place {axis}", ends if moves else say.place(own["last"]), last
        force = joint["force"]
        yield "largest force of the lines on it", say(force["value"], "N"), say.instant_and_components(force)
