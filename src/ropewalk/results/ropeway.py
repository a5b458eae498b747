"""What an engineer of ropeways reads: wheel loads, sway of cabins, hauling ropes, saddles, clearance of the ground."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ropewalk.model.carriage import Carriage, Haul
from ropewalk.results.contact_statistics import contacts_by_load, scenario_of
from ropewalk.results.contract import path_name
from ropewalk.results.extremes import Summary, largest
from ropewalk.results.frame import Array
from ropewalk.results.ground import heights

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario


class Hauling(NamedTuple):
    """Tensions of a hauling rope and its counter rope, (instant,) N."""

    pull: Array  # of the hauling rope at the carriage
    drive: Array  # of the same at the drive
    counter: Array  # of the counter rope at the carriage
    slack_side: Array  # at the drive, on the side of the counter weight

    @staticmethod
    def of(tensions: Array) -> Hauling:
        """Those of one carriage, (instant, end of the rope) N."""
        return Hauling(*tensions.T)

    @property
    def ratio(self) -> Array:
        """Tension of the one side of the drive over that of the other, 1 or more, (instant,)."""
        one, other = np.maximum(self.drive, 1e-300), np.maximum(self.slack_side, 1e-300)
        return np.asarray(np.maximum(one / other, other / one))


# Part of the angle h/R by which links turn on a groove, from which on a node is taken to lie there.
TURNS = 0.1
_ENDS = {"max": np.nanargmax, "min": np.nanargmin}


def ropeway_summary(dataset: xr.Dataset) -> dict[str, Any]:
    """Give what ropeways are judged by, over the output instants, under `carriages`, `saddles` and `clearance`.

    For each carriage: `wheel_load`, the largest and the least force of a wheel across its rope, N, positive if it
    presses; `tension_ratio`, the least tension of the rope over the load of a wheel on it; `transverse_ratio`, over
    the force of all wheels of it together; `sway` and `side_sway`, the largest angles of the hanger from the vertical
    along the line and to the side, rad; `pull` of its hauling rope at the carriage and `drive_tension` at the drive,
    and `counter_pull` of its counter rope at the carriage, largest and least, N; `drive_ratio`, the largest ratio of
    the tensions on both sides of the sheave of the drive, and what friction bears there (Euler, Eytelwein); `slip`,
    the largest and the least length of rope that has slipped out over it, m. For each
    saddle: `deflection`, the largest and the least angle by which the rope turns over it, rad, 0 where it has lifted.
    `clearance`: the least height over the ground of `outputs.ground` of lines and of floors of cabins, m.

    Args:
        dataset: a result.
    """
    scenario, name = scenario_of(dataset), path_name(dataset)
    if scenario is None or not dataset.sizes[name]:
        return {"carriages": {}, "saddles": {}, "clearance": {}}
    carriages = {load: own for load, own in scenario.loads.items() if isinstance(own, Carriage)}
    return {
        "carriages": {load: _carriage(dataset, scenario, load, own) for load, own in carriages.items()},
        "saddles": _saddles(dataset, scenario),
        "clearance": _clearance(dataset, scenario, carriages),
    }


def _both(values: Array, unit: str, dataset: xr.Dataset, of: Sequence[str] = ()) -> Summary | None:
    """The largest and the least of values (instant,) or (instant, which), with when and of what; NaN is left out."""
    ends = {key: largest(dataset, values, unit, of, pick) for key, pick in _ENDS.items()}
    return {"unit": unit, **ends} if ends["max"] is not None else None


def courses(dataset: xr.Dataset) -> dict[str, dict[str, tuple[Array, str]]]:
    """What carriages go through, over the output instants, with units: (instant,), of wheel loads (instant, wheel).

    `wheel_load` across the rope, `sway` and `side_sway` of the hanger, `pull` and `counter_pull` of its ropes at the
    carriage, `drive_tension` at the drive, `drive_ratio` and `slip` over its sheave, as `ropeway_summary` has them;
    those that a carriage has.
    """
    if (scenario := scenario_of(dataset)) is None:
        return {}
    return {name: _course(dataset, scenario, name, load) for name, load in _carriages(scenario)}


def _course(dataset: xr.Dataset, scenario: Scenario, name: str, load: Carriage) -> dict[str, tuple[Array, str]]:
    wheels, bodies = contacts_by_load(dataset, Carriage)[name], dataset["body"].values.tolist()
    found = {"wheel_load": (wheel_loads(dataset, name), "N")}
    if load.cabin is not None:
        cabin = dataset["body_position"].values[:, bodies.index(f"{name}.cabin")]
        hanger = cabin - dataset["contact_position"].values[:, wheels].mean(axis=1)
        found["sway"] = np.arctan2(hanger[:, 0], -hanger[:, -1]), "rad"
        if hanger.shape[1] == 3:
            found["side_sway"] = np.arctan2(hanger[:, 1], -hanger[:, 2]), "rad"
    hauled = "hauled" in dataset.variables  # results of before it was written have not
    if (haul := _haul_of(scenario, name)) is not None and hauled:
        row = dataset["hauled"].values.tolist().index(name)
        ropes = Hauling.of(dataset["haul_tension"].values[:, row])
        found |= {"pull": (ropes.pull, "N"), "drive_tension": (ropes.drive, "N")}
        if haul.counter is not None:
            found["counter_pull"] = ropes.counter, "N"
        if haul.sheave is not None:
            found |= {"drive_ratio": (ropes.ratio, "1"), "slip": (dataset["haul_slip"].values[:, row], "m")}
    return found


def _carriage(dataset: xr.Dataset, scenario: Scenario, name: str, load: Carriage) -> Summary:
    wheels, course = contacts_by_load(dataset, Carriage)[name], _course(dataset, scenario, name, load)
    across = course["wheel_load"][0]
    tension = dataset["contact_tension"].values[:, wheels].min(axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(across > 0.0, tension / across, np.nan)
        whole = across.sum(axis=1)  # NaN while a wheel is off the line
        transverse = _both(np.where(whole > 0.0, tension.min(axis=1) / whole, np.nan), "1", dataset)
    of = [str(contact).partition(".")[2] for contact in dataset["load"].values[wheels]]
    least = _both(ratio, "1", dataset, of)
    found: Summary = {
        "wheel_load": _both(across, "N", dataset, of),
        "tension_ratio": None if least is None else least["min"],
        "transverse_ratio": None if transverse is None else transverse["min"],
    }
    for key in ("sway", "side_sway", "pull", "drive_tension", "counter_pull"):
        if key in course:
            found[key] = _both(*course[key], dataset)
    haul = _haul_of(scenario, name)
    if haul is not None and haul.sheave is not None and "slip" in course:
        friction = haul.sheave.slip_ratio
        sides = _both(*course["drive_ratio"], dataset)
        found["drive_ratio"] = None if sides is None else sides["max"] | {"friction_bears": friction}
        found["slip"] = _both(*course["slip"], dataset)
    return found


def _haul_of(scenario: Scenario, name: str) -> Haul | None:
    """The hauling rope of a carriage, be it its own or that of another one over a pulley."""
    own = {other: load.haul for other, load in _carriages(scenario) if load.haul is not None}
    return own.get(name) or next((haul for haul in own.values() if haul.over_to == name), None)


def _carriages(scenario: Scenario) -> list[tuple[str, Carriage]]:
    return [(name, load) for name, load in scenario.loads.items() if isinstance(load, Carriage)]


def wheel_loads(dataset: xr.Dataset, name: str) -> Array:
    """Forces of a carriage's wheels across their line, (instant, wheel) N, positive downwards: what they bear.

    Across is across the chord of the two nodes around the link that a wheel is on.
    """
    scenario, wheels = scenario_of(dataset), contacts_by_load(dataset, Carriage)[name]
    assert scenario is not None
    force, xi = dataset["contact_force"].values[:, wheels], dataset["contact_xi"].values[:, wheels]
    own = np.flatnonzero(dataset["line"].values == scenario.loads[name].on)
    station, place = dataset["xi"].values[own], dataset["position"].values[:, own]
    instants, out = np.arange(xi.shape[0]), np.full(xi.shape, np.nan)
    for j in range(xi.shape[1]):
        i = np.clip(np.searchsorted(station, np.nan_to_num(xi[:, j]), side="right") - 1, 0, own.size - 2)
        chord = place[instants, np.minimum(i + 2, own.size - 1)] - place[instants, np.maximum(i - 1, 0)]
        along = chord / np.linalg.norm(chord, axis=1)[:, None]
        part = force[:, j] - (force[:, j] * along).sum(axis=1)[:, None] * along
        out[:, j] = np.where(part[:, -1] <= 0.0, 1.0, -1.0) * np.linalg.norm(part, axis=1)
    return out


def _saddles(dataset: xr.Dataset, scenario: Scenario) -> dict[str, Summary]:
    found: dict[str, Summary] = {}
    for name, line in scenario.lines.items():
        place = dataset["position"].values[:, dataset["line"].values == name]
        for saddle, own in line.saddles.items():
            found[f"{name}.{saddle}"] = {"deflection": _both(deflection(place, own.at[0], own.radius), "rad", dataset)}
    return found


def deflection(place: Array, x: float, radius: float) -> Array:
    """Angles by which a rope turns over a saddle, (instant,) rad: between its links next to those that lie there.

    Args:
        place: (instant, node, axis) m.
        x: of the crown of the saddle, m.
        radius: of its groove, m.
    """
    links = np.diff(place, axis=1)
    length = np.linalg.norm(links, axis=2)
    slope = np.arctan2(links[:, :, -1], np.linalg.norm(links[:, :, :-1], axis=2))
    turn = slope[:, :-1] - slope[:, 1:]  # at inner nodes, positive over a saddle
    lies = turn > TURNS * 0.5 * (length[:, 1:] + length[:, :-1]) / radius
    out = np.zeros(place.shape[0])
    for i in range(place.shape[0]):
        near = np.flatnonzero(lies[i] & (np.abs(place[i, 1:-1, 0] - x) < radius))
        if near.size:
            crown = int(near[np.argmin(np.abs(place[i, 1 + near, 0] - x))])
            first = last = crown
            while first > 0 and lies[i, first - 1]:
                first -= 1
            while last < lies.shape[1] - 1 and lies[i, last + 1]:
                last += 1
            out[i] = slope[i, first] - slope[i, last + 1]
    return out


def _clearance(dataset: xr.Dataset, scenario: Scenario, carriages: dict[str, Carriage]) -> dict[str, Summary]:
    if not scenario.outputs.ground:
        return {}
    ground = np.array(scenario.outputs.ground)
    found: dict[str, Summary] = {}

    def note(name: str, place: Array, below: float) -> None:
        """Of places (instant, point, axis) in m whose lowest point is so far below."""
        height = heights(place, below, ground)
        if (both := _both(height, "m", dataset)) is not None:
            i = np.unravel_index(int(np.nanargmin(height)), height.shape)
            found[name] = both["min"] | {"x": float(place[(*i, 0)])}

    for name in scenario.lines:
        note(name, dataset["position"].values[:, dataset["line"].values == name], 0.0)
    bodies = dataset["body"].values.tolist()
    for name, load in carriages.items():
        if load.cabin is not None:
            note(f"{name}.cabin", dataset["body_position"].values[:, [bodies.index(f"{name}.cabin")]], load.cabin.floor)
    return found
