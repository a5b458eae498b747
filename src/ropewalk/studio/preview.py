"""Picture of a scenario before it is computed: lines between their declared points, loads where they start."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.model.joint import Joined
from ropewalk.model.line import spatial
from ropewalk.results.contract import scenario_attributes
from ropewalk.results.frame import IN_AIR, Array, Contacts, Layout
from ropewalk.results.labelled import of_frames

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario

_POINTS = 41  # of each straight piece, so that loads are near one


def preview(scenario: Scenario) -> xr.Dataset | None:
    """Return a frame of what a scenario declares; None where it has neither lines nor nets."""
    found = list(_lines(scenario))
    if not found:
        return None
    shapes = {name: _subdivide(np.array([spatial(point) for point in corners])) for name, corners in found}
    xi = {name: np.append(0.0, np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))) for name, p in shapes.items()}
    axes = ("x", "z") if all(not shape[:, 1].any() for shape in shapes.values()) else ("x", "y", "z")
    starts = [
        (f"{name}.{place.label}".rstrip("."), scenario.carrier_of(load), place.start)
        for name, load in scenario.loads.items() for place in load.starts()
    ]  # fmt: skip
    columns = [0, 2] if len(axes) == 2 else [0, 1, 2]
    contacts = Contacts(1, len(starts), len(axes))
    for k, (_, line, start) in enumerate(starts):
        if line in shapes and line not in scenario.nets and 0.0 <= start <= xi[line][-1]:
            contacts.xi[0, k], contacts.state[0, k] = start, IN_AIR
            contacts.position[0, k] = [np.interp(start, xi[line], shapes[line][:, a]) for a in columns]
    names = [name for name, shape in shapes.items() for _ in shape]
    links = [name for name, shape in shapes.items() for _ in shape[1:]]
    supports = (
        f"{name}.{key.removesuffix('_support')}"
        for name, line in scenario.lines.items() for key, support in line.ends() if not isinstance(support, Joined)
    )  # fmt: skip
    layout = Layout(
        axes=axes, node_line=tuple(names), node_xi=np.concatenate([*xi.values()]), link_line=tuple(links),
        link_xi=np.zeros(len(links)), contact_load=tuple(name for name, _, _ in starts), support=tuple(supports),
    )  # fmt: skip
    still: dict[str, Array] = {
        "position": np.concatenate([*shapes.values()])[None, :, columns], "tension": np.zeros((1, len(links))),
        "reaction": np.zeros((1, len(layout.support), len(axes))), "body_position": np.zeros((1, 0, len(axes))),
    }  # fmt: skip
    return of_frames(layout, np.zeros(1), {**still, **contacts.fields()}, scenario_attributes(scenario))


def _lines(scenario: Scenario) -> Iterator[tuple[str, list[Any]]]:
    """Names and corners of lines, hangers, wires, and outlines of nets."""
    hung = {name: line for row in scenario.hangers for name, line in scenario.hung(row).items()}
    for name, line in (scenario.lines | hung).items():
        between = [*(sheave.at for sheave in line.sheaves.values()), *(saddle.at for saddle in line.saddles.values())]
        yield name, [line.start, *between, line.end]
    for name, wires in scenario.overhead_lines.items():
        x, y, z = spatial(wires.start)
        at = [x, *(x + np.cumsum(wires.span_lengths)).tolist()]
        heights = [z + height for height in wires.registered]
        yield f"{name}.contact", [(a, y, height) for a, height in zip(at, heights, strict=True)]
        yield f"{name}.messenger", [(a, y, h + wires.system_height) for a, h in zip(at, heights, strict=True)]
    for name, net in scenario.nets.items():
        if net.boundary is not None:
            yield name, [*net.boundary, net.boundary[0]]
        elif net.corner is not None and net.sides is not None:
            corner, (one, other) = np.array(net.corner), np.array(net.sides)
            yield name, [corner, corner + one, corner + one + other, corner + other, corner]


def _subdivide(corners: Array) -> Array:
    """Return points on straight pieces between corners (corner, 3), m."""
    parts = [np.linspace(a, b, _POINTS)[:-1] for a, b in pairwise(corners)]
    return np.concatenate([*parts, corners[-1:]])
