"""Observations: the part of a result that a reference keeps, independent of the mesh and of the engine.

A quantity is an array with the instants as its first axis; its name begins with its kind: `position`, `force` or
`energy`. Numbers are those of the summary.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.results.contract import path_name
from ropewalk.results.frame import ENERGY_FORMS
from ropewalk.results.statistics import summary

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

INSTANTS = 9
PLACES = np.linspace(0.0, 1.0, 9)
MOST = 6  # lines, contacts, supports, bodies, ties of which traces are kept
LOW_PASS = 20.0  # Hz, of low-passed contact forces
NAMES = (
    "axis", "load", "body", "side", "support", "form", "tie", "watched", "foreign", "compared", "hauled", "rope_end",
    "sheave", "corner", "direction",
)  # fmt: skip
"""Coordinates whose values do not depend on the mesh."""
UNSTABLE = frozenset({
    "xi", "x", "y", "z", "time", "load_path", "steps", "step", "frames", "cpu_seconds", "wall_seconds",
    "compile_seconds", "imbalance", "largest_imbalance", "mesh", "method",
})  # fmt: skip
"""Entries of a summary whose values are not compared: places and instants of extremes, and the effort."""


@dataclass
class Observation:
    """The answer to a case.

    Args:
        outcome: of the run; "refused" or "crashed" without a result.
        exit_code: of the command.
        note: message of a refusal or reason of an early end.
        structure: variables, coordinates, attributes and keys by label of the result.
        quantities: arrays (instant, ...) by name.
        numbers: of the summary by path.
        cpu: s.
    """

    outcome: str
    exit_code: int
    note: str = ""
    structure: dict[str, Any] = field(default_factory=dict)
    quantities: dict[str, Array] = field(default_factory=dict)
    numbers: dict[str, float] = field(default_factory=dict)
    cpu: float = 0.0


def add(observation: Observation, result: xr.Dataset, label: str = "") -> None:
    """Add a result to an observation."""
    found = summary(result)
    observation.structure[label or "result"] = {**structure_of(result), "summary": sorted(set(keys(found)))}
    observation.numbers |= {f"{label}{name}": value for name, value in numbers(found)}
    observation.quantities |= {_named(name, label): values for name, values in quantities(result)}


def add_plain(observation: Observation, answer: Any, label: str) -> None:
    """Add an answer of a tool in plain values: its keys and its numbers."""
    observation.structure[label] = {"keys": sorted(set(keys(answer)))}
    observation.numbers |= {f"{label}:{name}": value for name, value in numbers(answer)}


def _named(name: str, label: str) -> str:
    kind, _, rest = name.partition(":")
    return f"{kind}:{label + ' ' if label else ''}{rest}"


def structure_of(result: xr.Dataset) -> dict[str, Any]:
    """Return dimensions, types and units of all variables, names along dimensions, and keys of attributes."""
    return {
        "variables": {
            str(name): [list(map(str, value.dims)), value.dtype.kind, str(value.attrs.get("units", "")),
                        sorted(map(str, value.attrs))]
            for name, value in result.variables.items()
        },
        "names": {name: [str(v) for v in result[name].values] for name in NAMES if name in result.coords},
        "lines": list(dict.fromkeys(map(str, result["line"].values))) if "line" in result else [],
        "attributes": sorted(map(str, result.attrs)),
    }  # fmt: skip


def keys(value: Any, path: str = "") -> Iterator[str]:
    """Return the paths of all entries of nested dictionaries; entries of lists share one path."""
    if isinstance(value, dict):
        for key, entry in value.items():
            yield f"{path}/{key}"
            yield from keys(entry, f"{path}/{key}")
    elif isinstance(value, list):
        for entry in value:
            yield from keys(entry, f"{path}[]")


def numbers(value: Any, path: str = "") -> Iterator[tuple[str, float]]:
    """Return the finite numbers of nested dictionaries by path, without those that are not compared."""
    if isinstance(value, dict):
        for key, entry in value.items():
            if key not in UNSTABLE:
                yield from numbers(entry, f"{path}/{key}")
    elif isinstance(value, list | tuple):
        for k, entry in enumerate(value[:20]):
            yield from numbers(entry, f"{path}/{k}")
    elif isinstance(value, int | float) and not isinstance(value, bool) and np.isfinite(value):
        yield path, float(value)


def quantities(result: xr.Dataset) -> Iterator[tuple[str, Array]]:
    """Return the traces of a result."""
    path = np.asarray(result[path_name(result)].values, dtype=float)
    if not len(path):
        return
    frames = np.unique(np.linspace(0, len(path) - 1, INSTANTS).round().astype(int))
    yield from _of_lines(result, frames)
    yield from _of_contacts(result, frames, path)
    yield from _of_many(result, frames)
    energy = result["energy"].values
    for k, form in enumerate(ENERGY_FORMS):
        if form != "imbalance" and energy.size and np.isfinite(energy[:, k]).any():
            yield f"energy:{form}", energy[frames, k]


def some(count: int) -> list[int]:
    """Return indices of at most MOST of so many things, evenly distributed."""
    return sorted(set(np.linspace(0, count - 1, min(count, MOST)).round().astype(int).tolist())) if count else []


def _of_lines(result: xr.Dataset, frames: NDArray[np.int_]) -> Iterator[tuple[str, Array]]:
    position, owner = result["position"].values[frames], result["line"].values
    tension, link_owner = result["tension"].values[frames], result["link_line"].values
    nets = set(result["cell_net"].values.tolist()) if "cell_net" in result else set()
    names = list(dict.fromkeys(owner.tolist()))
    for name in (names[k] for k in some(len(names))):
        here, links = np.flatnonzero(owner == name), np.flatnonzero(link_owner == name)
        axes = result["axis"].values.tolist()
        if name in nets or len(here) < 2:
            z = position[:, here, -1]
            yield f"position:{name} heights", np.stack([z.mean(axis=1), z.min(axis=1), z.max(axis=1)], axis=1)
            continue
        for k, axis in enumerate(axes):
            along = _interpolated(result["xi"].values[here], position[:, here, k])
            yield f"position:{name} shape {axis}", along[:1]
            yield f"position:{name} displacement {axis}", along - along[:1]
        if links.size:
            own = tension[:, links]
            xi = result["link_xi"].values[links]
            yield f"force:{name} tension", np.stack([own[:, 0], own[:, -1], own.mean(axis=1)], axis=1)
            yield f"force:{name} tension along", _interpolated(xi, own) if links.size > 1 else own


def _interpolated(xi: Array, values: Array) -> Array:
    """Return (instant, place) of values (instant, node) at equal distances along a line."""
    at = xi[0] + PLACES * (xi[-1] - xi[0])
    return np.stack([np.interp(at, xi, row) for row in values])


def _of_contacts(result: xr.Dataset, frames: NDArray[np.int_], path: Array) -> Iterator[tuple[str, Array]]:
    own = some(result.sizes.get("contact", 0))
    axes = result["axis"].values.tolist()
    force = result["contact_force"].values
    for c in own:
        name = f"contact {c}"
        place = result["contact_position"].values[frames, c]
        for k, axis in enumerate(axes):
            yield f"position:{name} {axis}", place[:, k]
            yield f"force:{name} {axis}", force[frames, c, k]
            smooth = low_passed(path, force[:, c, k])
            yield f"force:{name} {axis} low-passed", smooth[frames]
            yield f"force:{name} {axis} low-passed extremes", np.array([[smooth.min(), smooth.max()]])
            yield f"impulse:{name} {axis}", _impulse(path, force[:, c, k])
        if "hold_force" in result:
            yield f"force:{name} hold", np.linalg.norm(result["hold_force"].values[frames, c], axis=-1)
        yield f"force:{name} tension", result["contact_tension"].values[frames, c]


def low_passed(path: Array, values: Array) -> Array:
    """Return the mean over a window of one period of LOW_PASS; NaN counts as 0."""
    values = np.nan_to_num(values)
    if len(path) < 3:
        return values
    width = max(1, round(1.0 / LOW_PASS / max(float(np.median(np.diff(path))), 1e-12)))
    width = min(width, len(path))
    kernel = np.ones(width)
    return np.convolve(values, kernel, "same") / np.convolve(np.ones_like(values), kernel, "same")


def _impulse(path: Array, values: Array) -> Array:
    return np.array([np.trapezoid(np.nan_to_num(values), path)])


def _of_many(result: xr.Dataset, frames: NDArray[np.int_]) -> Iterator[tuple[str, Array]]:
    axes = result["axis"].values.tolist()
    path = np.asarray(result[path_name(result)].values, dtype=float)
    for b in some(result.sizes.get("body", 0)):
        for k, axis in enumerate(axes):
            yield f"position:body {b} {axis}", result["body_position"].values[frames, b, k]
    for s in some(result.sizes.get("support", 0)):
        values = result["reaction"].values[:, s]
        for k, axis in enumerate(axes):
            yield f"force:support {s} {axis}", values[frames, k]
            yield f"force:support {s} {axis} low-passed", low_passed(path, values[:, k])[frames]
            yield f"impulse:support {s} {axis}", _impulse(path, values[:, k])
    for name in ("tie_force", "cell_tension", "haul_tension", "haul_slip", "sheave_station"):
        if name in result and result[name].size:
            yield from _listed(name, result[name].values[frames])


def _listed(name: str, values: Array) -> Iterator[tuple[str, Array]]:
    kind = "position" if name in ("haul_slip", "sheave_station") else "force"
    if name == "cell_tension":
        yield f"{kind}:{name}", np.concatenate([values.mean(axis=1), values.max(axis=1)], axis=1)
    else:
        for k in some(values.shape[1]):
            yield f"{kind}:{name} {k}", values[:, k].reshape(len(values), -1)


def exit_code(outcome: str) -> int:
    """Return the exit code that the command gives with an outcome."""
    return {"completed": 0, "doubtful": 4, "interrupted": 130}.get(outcome, 3)


RANK: Sequence[str] = ("completed", "doubtful", "stopped", "refused", "crashed")
"""Outcomes from the best to the worst; an early end of a run counts as stopped."""


def rank(outcome: str) -> int:
    """Return the place of an outcome in RANK."""
    return RANK.index(outcome) if outcome in RANK else RANK.index("stopped")
