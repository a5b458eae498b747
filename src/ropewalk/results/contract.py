"""The contract of a result: names, dimensions, units and attributes, the same in memory and on disk.

xarray allows a coordinate name once in a dataset, so `line` and `xi` belong to the nodes and the links carry
`link_line` and `link_xi`. `links(dataset)` gives the link quantities with the short names, where no node is about.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import ropewalk
from ropewalk.checkpoint import ENGINE_NUMBER
from ropewalk.results.frame import ENERGY_FORMS, Layout, RunInfo

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario

CONVENTIONS = "ropewalk-result-1"
SIDES = ("behind", "ahead")
CORNERS = ("first", "second", "third")
DIRECTIONS = ("first", "second")
ROPE_ENDS = ("carriage", "drive", "counter", "beyond_drive")
CHECKPOINT = "checkpoint"  # variable of a result file that is no part of the result: see slots.py
LACKING = "not_resumable"  # attribute of a result file that has none: why
CURVATURE = "curvature"
"""Attribute: "fourth order" where bending is that of a spline through the nodes, by second differences elsewhere."""
STATIC = "static_part"  # attribute: largest static values as JSON, by line or place and quantity
PATH = "path"  # stands for the leading dimension, `time` or `load_path`

Attribute = str | int | float


@dataclass(frozen=True)
class ResultVariable:
    """A variable of the result: its dimensions after the leading one, its unit and what it is."""

    dims: tuple[str, ...]
    unit: str
    long_name: str

    @property
    def attributes(self) -> dict[str, Attribute]:
        """The attributes that go with the variable."""
        return {"units": self.unit, "long_name": self.long_name}


def _variables(**of: tuple[str, str, str]) -> dict[str, ResultVariable]:
    """Return variables by name, from the names of their dimensions, unit, and what they are."""
    return {name: ResultVariable(tuple(dims.split()), unit, what) for name, (dims, unit, what) in of.items()}


VARIABLES: Mapping[str, ResultVariable] = _variables(
    position=("node axis", "m", "position of the node"),
    velocity=("node axis", "m/s", "velocity of the node"),
    tension=("link", "N", "tension in the link"),
    strain=("link", "1", "strain of the link"),
    contact_position=("contact axis", "m", "position of the contact"),
    contact_force=("contact axis", "N", "force on the line at the contact, with driving force"),
    hold_force=("contact axis", "N", "driving force along the path that the prescribed travel requires"),
    contact_xi=("contact", "m", "material coordinate of the contact"),
    contact_speed=("contact", "m/s", "speed of the load as measured"),
    contact_tension=("contact side", "N", "tension behind and ahead of the load"),
    contact_friction=("contact", "1", "smallest friction coefficient that prevents sliding"),
    contact_state=(
        "contact",
        "1",
        "0: off the line, 1: in the air, 2: sticks to the line, 3: slides or rolls along it",
    ),
    contact_in_air=("contact", "s", "time that the load has been in the air so far"),
    friction_power=("contact", "W", "power lost to friction along the line"),
    body_position=("body axis", "m", "position of the body of a load"),
    body_velocity=("body axis", "m/s", "velocity of the body of a load"),
    reaction=("support axis", "N", "force of the support on the line"),
    energy=("form", "J", "energy of each form in the audit"),
    tie_force=("tie", "N", "tension in the tie"),
    sampled_station=("sample contact", "m", "position of the contact along the line, between outputs"),
    sampled_force=("sample contact", "N", "force upwards on the line at the contact, between outputs"),
    sampled_height=("sample contact", "m", "height of the contact, between outputs"),
    sampled_tie_force=("sample tie", "N", "tension in the tie, between outputs"),
    sampled_uplift=("sample watched", "m", "height of the watched point above equilibrium, between outputs"),
    haul_tension=("hauled rope_end", "N", "tension in the ropes that haul the carriage, at the end of the rope"),
    haul_slip=("hauled", "m", "length of the hauling rope that has slipped out over its drive"),
    sheave_station=("sheave", "m", "material coordinate of the line at the sheave (unstrained arc length)"),
    cell_tension=(
        "cell direction",
        "N/m",
        "tension per width: of a membrane the larger and the smaller one, of a net along u, v",
    ),
    contact_change=("compared axis", "m", "change of the contact position from the mesh with half the elements"),
    exchange_work=("foreign", "J", "sum of energies exchanged through the interface so far"),
    exchange_residual=("foreign", "J", "energy error of the exchange with the model so far"),
    exchange_peak=("foreign", "J", "largest energy error in one interval of exchange since the last output"),
)

PATHS: Mapping[str, ResultVariable] = _variables(
    time=("", "s", "time"),
    load_path=("", "m", "distance covered by the fastest load that still moves"),
)

COORDINATES: Mapping[str, ResultVariable] = _variables(
    axis=("axis", "1", "axis: x along the span, y sideways, z up"),
    line=("node", "1", "line of the node"),
    xi=("node", "m", "material coordinate of the node (unstrained arc length)"),
    link_line=("link", "1", "line of the link"),
    link_xi=("link", "m", "material coordinate of the middle of the link (unstrained arc length)"),
    load=("contact", "1", "load of the contact"),
    body=("body", "1", "body of a load other than its contacts"),
    side=("side", "1", "side of the load: behind is towards the start of the line"),
    support=("support", "1", "support of a line"),
    form=("form", "1", "form of energy"),
    tie=("tie", "1", "tie between lines, such as a dropper"),
    tie_station=("tie", "m", "position of the tie along its line"),
    watched=("watched", "1", "point of a line with sampled height"),
    watched_station=("watched", "m", "position of the watched point along its line"),
    sample=("sample", "s", "time of the sample after the output instant (negative: before it)"),
    **{"foreign": ("foreign", "1", "load that is an external model")},  # a name that results have
    compared=("compared", "1", "load of the contact that is compared with that on a coarser mesh"),
    hauled=("hauled", "1", "carriage on a hauling rope"),
    rope_end=("rope_end", "1", "end of a rope: at the carriage, at the drive, of the counter rope, beyond the drive"),
    sheave=("sheave", "1", "sheave over which a line runs"),
    corner=("corner", "1", "corner of a cell"),
    direction=("direction", "1", "direction of a tension in a cell"),
    cell_net=("cell", "1", "net or membrane of the cell"),
    cell_node=("cell corner", "1", "number of the node at the corner of the cell"),
)

NUMBERS = ("cell_node",)
"""Coordinates without a unit that are numbers, where all others are names."""

OPTIONAL = ("tie", "watched", "sample", "foreign", "compared", "cell", "corner", "direction", "hauled", "rope_end",
            "sheave")  # fmt: skip
"""Dimensions that only some results have: what needs them is left out of the others."""


def is_present(quantity: ResultVariable, size: Mapping[Any, int]) -> bool:
    """Whether a quantity belongs to a result with dimensions of these sizes."""
    return all(size.get(dim, 0) or dim not in OPTIONAL for dim in quantity.dims)


def _names(layout: Layout) -> dict[str, Sequence[str]]:
    """Names along every dimension that has some, by coordinate."""
    return {
        "axis": layout.axes,
        "line": layout.node_line,
        "link_line": layout.link_line,
        "load": layout.contact_load,
        "body": layout.body,
        "side": SIDES,
        "support": layout.support,
        "form": ENERGY_FORMS,
        "tie": layout.tie,
        "watched": layout.watched,
        "foreign": layout.external,
        "compared": layout.compared,
        "hauled": layout.hauled,
        "rope_end": ROPE_ENDS if layout.hauled else (),
        "sheave": layout.sheave,
        "corner": CORNERS if layout.cell else (),
        "direction": DIRECTIONS if layout.cell else (),
        "cell_net": layout.cell_net,
    }


def coordinate_values(layout: Layout) -> dict[str, NDArray[Any]]:
    """Values of all coordinates but the leading one: names as text, `xi` and `link_xi` in m."""
    values: dict[str, NDArray[Any]] = {name: np.array(text, dtype=np.str_) for name, text in _names(layout).items()}
    values["xi"] = np.array(layout.node_xi, dtype=np.float64)
    values["link_xi"] = np.array(layout.link_xi, dtype=np.float64)
    for name in ("tie_station", "watched_station", "sample"):
        values[name] = np.array(getattr(layout, name), dtype=np.float64)
    values["cell_node"] = np.array(layout.cell, dtype=np.float64).reshape(-1, len(CORNERS))
    return {name: values[name] for name in COORDINATES}


def sizes(layout: Layout) -> dict[str, int]:
    """Length of every dimension but the leading one."""
    named = {COORDINATES[name].dims[0]: len(names) for name, names in _names(layout).items()}
    return named | {"sample": len(layout.sample), "cell": len(layout.cell)}


def shapes(layout: Layout) -> dict[str, tuple[int, ...]]:
    """Shape of every variable in one frame."""
    size = sizes(layout)
    return {name: tuple(size[d] for d in quantity.dims) for name, quantity in VARIABLES.items()}


def numbers(layout: Layout) -> int:
    """How many bytes the numbers of one frame take."""
    return 8 * sum(math.prod(shape) for shape in shapes(layout).values())


def scenario_text(scenario: Scenario) -> str:
    """The whole scenario as JSON that can be run again; callables of the Python API appear by their name only."""

    def name(value: object) -> str:
        return f"<{getattr(value, '__module__', '')}.{getattr(value, '__qualname__', type(value).__name__)}>"

    tree = scenario.model_dump(by_alias=True, exclude_none=True)
    return json.dumps(tree, indent=1, ensure_ascii=False, default=name)


def scenario_attributes(scenario: Scenario) -> dict[str, Attribute]:
    """Attributes that are known before the run."""
    text = scenario_text(scenario)
    return {
        "Conventions": CONVENTIONS,
        "title": scenario.title,
        "source": f"ropewalk {ropewalk.__version__}",
        "ropewalk_version": ropewalk.__version__,
        "engine_number": ENGINE_NUMBER,
        "scenario": text,
        "scenario_sha256": hashlib.sha256(text.encode()).hexdigest(),
        **({"scenario_file": scenario.source_text} if scenario.source_text else {}),
    }


def run_info_attributes(run_info: RunInfo) -> dict[str, Attribute]:
    """Attributes that tell how the run went; doubts and warnings are lines of one text each."""
    return {
        "outcome": run_info.outcome,
        "advice": run_info.advice,
        "method": run_info.method,
        "reason": run_info.reason,
        "step": float(run_info.step),
        "steps": int(run_info.steps),
        "cpu_seconds": float(run_info.cpu_seconds),
        "wall_seconds": float(run_info.wall_seconds),
        "compile_seconds": float(run_info.compile_seconds),
        "audit": run_info.audit,
        "doubts": "\n".join(" ".join(str(doubt).split()) for doubt in run_info.doubts),
        "warnings": "\n".join(" ".join(warning.split()) for warning in run_info.warnings),
        **run_info.mesh,
        **run_info.window,
        **({CURVATURE: run_info.curvature} if run_info.curvature else {}),
        **({STATIC: json.dumps(run_info.static)} if run_info.static else {}),
    }


def doubts_of(dataset: xr.Dataset) -> tuple[str, ...]:
    """The reasons not to trust a run, a sentence each."""
    return tuple(text for text in str(dataset.attrs.get("doubts", "")).splitlines() if text)


def path_name(dataset: xr.Dataset) -> str:
    """Name of the leading dimension: `time` or `load_path`."""
    return "time" if "time" in dataset.dims else "load_path"


def links(dataset: xr.Dataset) -> xr.Dataset:
    """The link quantities alone (tension, strain), with coordinates `line(link)` and `xi(link)`."""
    nodes = [name for name in dataset.variables if "node" in dataset[name].dims]
    others = [name for name in dataset.data_vars if "link" not in dataset[name].dims]
    return dataset.drop_vars([*nodes, *others]).rename(link_line="line", link_xi="xi")
