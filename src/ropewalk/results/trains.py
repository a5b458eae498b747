"""Trains and crowds, each as a whole: axles and people on the line, contact forces, accelerations of vehicles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics.multibody_system import static_loads
from ropewalk.model.axles import Axles
from ropewalk.model.crowd import Crowd
from ropewalk.model.train import Train, TrainVehicle
from ropewalk.results.contact_statistics import contacts_by_load, scenario_of
from ropewalk.results.contract import path_name
from ropewalk.results.extremes import largest
from ropewalk.results.frame import Array
from ropewalk.results.line_response import accelerations

if TYPE_CHECKING:
    import xarray as xr


def trains_in(dataset: xr.Dataset) -> dict[str, list[int]]:
    """The contacts of each train, by its name."""
    return contacts_by_load(dataset, Axles, Train)


def crowds_in(dataset: xr.Dataset) -> dict[str, list[int]]:
    """The contacts of each crowd, by its name."""
    return contacts_by_load(dataset, Crowd)


def grouped_contacts(dataset: xr.Dataset) -> set[int]:
    """Return the numbers of contacts that belong to trains and crowds, whose single axles and feet are not drawn."""
    return {k for own in (*trains_in(dataset).values(), *crowds_in(dataset).values()) for k in own}


def crowd_summary(dataset: xr.Dataset) -> dict[str, Any]:
    """Of each crowd how many there are, how many at most on the line, and what they press with on it, in all."""
    out = {}
    for name, own in crowds_in(dataset).items():
        there, total = _pressing(dataset, own)
        people = there.reshape(len(there), -1, 2).any(axis=2).sum(axis=1)
        load = {"unit": "N", "max": float(total.max(initial=0.0)), "mean": float(total.sum()) / max(total.size, 1)}
        out[name] = {"people": len(own) // 2, "most_on_line": int(people.max(initial=0)), "load": load}
    return out


def _pressing(dataset: xr.Dataset, own: list[int]) -> tuple[NDArray[np.bool_], Array]:
    """Which contacts are on the line, (frame, contact), and what all of them press with, (frame,) N."""
    there = np.isfinite(dataset["contact_xi"].values[:, own])
    pressing = np.nan_to_num(-dataset["contact_force"].values[:, own, -1])
    return there, np.where(there, pressing, 0.0).sum(axis=1)


def train_summary(dataset: xr.Dataset) -> dict[str, Any]:
    """Of each train what it presses with on its line, in all, and when its first axle comes and its last one goes.

    Of one of vehicles also the largest and the least contact force, the part of the static one that the axle most
    unloaded loses, and the largest acceleration of a vehicle's heaviest body.
    """
    scenario, out, path = scenario_of(dataset), {}, dataset[path_name(dataset)].values
    unit = str(dataset[path_name(dataset)].attrs["units"])
    for name, own in trains_in(dataset).items():
        there, total = _pressing(dataset, own)
        on = np.flatnonzero(there.any(axis=1))
        out[name] = {
            "axles": len(own), "most_on_line": int(there.sum(axis=1).max(initial=0)),
            "load": {"unit": "N", "max": float(total.max(initial=0.0))},
            "first": {"unit": unit, "value": path[on[0]] if on.size else None},
            "last": {"unit": unit, "value": path[on[-1]] if on.size else None},
        }  # fmt: skip
        load = scenario.loads[name] if scenario is not None else None
        if isinstance(load, Train) and scenario is not None:
            out[name] |= _forces(dataset, own, load) | _accelerations(dataset, name, load, scenario.outputs.cut_off)
    return out


def _forces(dataset: xr.Dataset, own: list[int], load: Train) -> dict[str, Any]:
    """Extreme contact forces, and the largest unloading of an axle.

    Not in the links at the ends of the line: the kink between ground and line there gives wheels a blow, which links
    spread as they please.
    """
    pressing, names = -dataset["contact_force"].values[:, own, -1], dataset["load"].values[own].tolist()
    lines, place = dataset["line"].values.astype(str), dataset["contact_xi"].values[:, own]
    of_line = (lines == load.on) | np.char.startswith(lines, f"{load.on}.")  # wires of an overhead line, too
    nodes = np.unique(dataset["xi"].values[of_line])
    with np.errstate(invalid="ignore"):
        pressing[(place < nodes[1]) | (place > nodes[-2])] = np.nan
    static = np.array(static_loads(load.whole))
    unloading = 1.0 - pressing / static
    return {
        "largest_force": largest(dataset, pressing, "N", names),
        "least_force": largest(dataset, pressing, "N", names, np.nanargmin),
        "unloading": largest(dataset, unloading, "1", names),
    }


def _accelerations(dataset: xr.Dataset, name: str, load: Train, cut_off: float) -> dict[str, Any]:
    """The largest acceleration of the heaviest body of a vehicle on bogies, up or down, low-pass filtered."""
    known = dataset["body"].values.tolist() if "body" in dataset.coords else []
    row = [vehicle for _, vehicle in load.composition]
    chosen = [_heaviest(vehicle, _borne(vehicle)) for vehicle in row]
    if not any(chosen):  # all bodies stand on wheels
        chosen = [_heaviest(vehicle, set(vehicle.bodies)) for vehicle in row]
    ends = [f".{number}.{body}" for number, body in enumerate(chosen, start=1) if body]
    found = [k for k, body in enumerate(known) if body.partition(".")[0] == name and body.endswith(tuple(ends))]
    values = accelerations(dataset, "body_velocity", found, cut_off) if found else None
    if values is None:
        return {"acceleration": None}
    return {"acceleration": largest(dataset, np.abs(values), "m/s^2", [known[k] for k in found])}


def _borne(vehicle: TrainVehicle) -> set[str]:
    """Names of bodies that stand on other bodies alone."""
    on_wheels = {end for spring in vehicle.springs.values() if set(spring.between) & set(vehicle.wheels)
                 for end in spring.between}  # fmt: skip
    return set(vehicle.bodies) - on_wheels


def _heaviest(vehicle: TrainVehicle, among: set[str]) -> str:
    return max(among, key=lambda body: vehicle.bodies[body].mass, default="")
