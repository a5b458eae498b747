"""Overhead lines of the EN 50318 reference models, as declarations."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ropewalk.model import Scenario
from ropewalk.model.overhead import OverheadLine
from ropewalk.overhead.section import CONTACT, Section, section_of
from ropewalk.results.contact_statistics import filtered, samples
from ropewalk.results.frame import RunInfo
from ropewalk.wires.frames import Wires
from ropewalk.wires.mesh import clamped_at
from ropewalk.wires.plan import Spot
from ropewalk.wires.rest import WiresAtRest, rest_of, rows
from ropewalk.wiring import task_of

EN_2002: dict[str, Any] = {
    "spans": {"count": 10, "length": "60 m"},
    "contact_wire": {"mass": "1.35 kg/m", "tension": "20 kN", "bending_stiffness": 0},
    "messenger_wire": {"mass": "1.07 kg/m", "tension": "16 kN", "bending_stiffness": 0},
    "droppers": {"at": [5, 10.5, 17, 23.5, 30, 36.5, 43, 49.5, 55], "stiffness": "100 kN/m"},
    "system_height": "1.2 m",
    "steady_arms": {"mass": 1 / 3},
    "analysed_spans": [5, 6],
    "element": 0.5,
}
"""EN 50318:2002; its acceptance table is for wires without bending stiffness."""

SIMPLE_AC: dict[str, Any] = {
    "spans": {"count": 6, "length": "55 m"},
    "contact_wire": {"mass": "1.35 kg/m", "tension": "22 kN", "bending_stiffness": 195},
    "messenger_wire": {"mass": "1.08 kg/m", "tension": "16 kN", "bending_stiffness": 131.7},
    "droppers": {
        "at": [4.5, 10.25, 16, 21.75, 27.5, 33.25, 39, 44.75, 50.5],
        "stiffness": "200 kN/m",
        "mass_per_length": "0.117 kg/m",
        "contact_clamp": "0.165 kg",
        "messenger_clamp": "0.195 kg",
    },
    "pre_sag": ["0 mm", "24 mm", "41 mm", "52 mm", "55 mm", "52 mm", "41 mm", "24 mm", "0 mm"],
    "steady_arms": {"mass_per_length": "0.73 kg/m", "length": "1.2 m", "stagger": "200 mm", "free": True},
    "messenger_supports": {"stiffness": "500 kN/m"},
    "element": 0.5,
}
"""Benchmark of Bruni et al. (2015), with fewer spans."""


DAMPED = {"drag": 0.0125, "retardation": "100 us"}  # as of the simple AC line


def long_line(
    spans: int, window: float | str | None, damping: dict[str, Any] | None = None, speed: float = 300.0, **changed: Any
) -> Scenario:
    """The reference model of so many spans at a speed in km/h, in a window in m, with links of 0.5 m."""
    wires = {key: EN_2002[key] | (damping or {}) for key in ("contact_wire", "messenger_wire")}
    own = {"spans": {"count": spans, "length": "60 m"}, "element": "0.5 m", "analysed_spans": None}
    run = {"kind": "dynamic", "until": (60.0 * spans - 20.0) / (speed / 3.6), "every": 0.05, "window": window}
    run |= changed.pop("run", {})
    travel = {"speed": f"{speed} km/h", "from": "10 m"}
    load = {"kind": "pantograph", "on": "line", "model": "en50318-2002", "travel": travel}
    line, run = ({k: v for k, v in block.items() if v is not None} for block in (EN_2002 | wires | own | changed, run))
    return Scenario.model_validate({"overhead_lines": {"line": line}, "loads": {"head": load}, "run": run})


def force(result: xr.Dataset, first: float, last: float) -> np.ndarray:
    """Filtered force between two stations in m."""
    found = samples(result).isel(contact=0)
    station = found.station.values
    return filtered(found.force.values, 1e-3)[(station > first) & (station < last)]


def off(a: xr.Dataset, b: xr.Dataset, first: float, last: float) -> dict[str, float]:
    """By how much two runs differ: statistics of force in N, rms of its difference, largest uplift in mm."""
    one, other = (force(result, first, last) for result in (a, b))
    rise = [np.nanmax(result.sampled_uplift.values, axis=(0, 1))[1:-1] for result in (a, b)]
    found = {
        "mean": one.mean() - other.mean(), "sigma": one.std() - other.std(), "largest": one.max() - other.max(),
        "smallest": one.min() - other.min(), "rms": np.sqrt(np.mean((one - other) ** 2)),
        "uplift": 1e3 * float(np.abs(rise[0] - rise[1]).max()),
    }  # fmt: skip
    print({key: round(float(value), 3) for key, value in found.items()})
    return {key: abs(float(value)) for key, value in found.items()}


def formed(line: dict[str, Any], **changes: Any) -> Section:
    return section_of("section", OverheadLine.model_validate(line | changes))


def rested(section: Section) -> tuple[WiresAtRest, NDArray[np.float64]]:
    """Rest of a section by its plan alone, and heights of the contact wire there: at the droppers, at the supports."""
    mesh = section.mesh()
    rest = rest_of(mesh)
    stations = np.concatenate([section.stations, section.supports[1:-1]])
    at = clamped_at(mesh.strands, [Spot(CONTACT, float(x)) for x in stations])
    pull = np.zeros(stations.size)
    pull[: section.stations.size] = rest.tie_force[: section.stations.size]
    for i, label in enumerate(f"{section.name}.arm.{k}" for k in range(1, section.supports.size - 1)):
        if label in section.holds:
            pull[section.stations.size + i] = rest.hold_force[section.holds[label]]
        elif label in section.arms:
            arm = section.arms[label]
            pull[section.stations.size + i] = rest.tie_force[arm] * rest.tie_way[arm, 2]
    weights = [hold for hold in section.plan.holds if hold.name.endswith(".weight")]
    for hold in weights:
        pull[section.stations.size :][np.isclose(section.supports[1:-1], hold.spot.station)] += hold.force[2]
    return rest, rows(at, mesh.nodes) @ rest.position[2] + at.local * pull


def runs_that_go_on(asked: Scenario) -> tuple[Wires, Wires]:
    """A motion after 36 output instants of 0.05 s, and another one that took it up from its 24th."""
    times = np.arange(0.0, 2.0, 0.05)
    first, second = (Wires(task_of(asked), times, RunInfo()) for _ in range(2))
    for i in range(24):
        first.advance(i)
    second.set_state(first.get_state())
    for i in range(24, 36):
        first.advance(i)
        second.advance(i)
    return first, second
