"""Payloads below trolleys: how far they sway, how much their ropes or leashes pull, also between output instants."""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.mechanics.assembly import speed_table
from ropewalk.mechanics.travelled import Travelled
from ropewalk.model.trolley import Trolley
from ropewalk.results.contact_statistics import scenario_of
from ropewalk.results.contract import path_name
from ropewalk.results.declared import ties
from ropewalk.results.extremes import Summary, largest
from ropewalk.results.frame import Array, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.own_way import lowest
from ropewalk.results.peaks import sharp, too_far_apart
from ropewalk.results.watch import Watch

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario

SUFFIX = ".payload"  # of bodies that hang below trolleys
STRETCH = 1e-3  # m, by which its weight stretches the rope of a payload whose stiffness is not given


class HangingWatch(Watch):
    """Watches payloads for how far they are from their trolleys."""

    def _prepare(self) -> None:
        bodies = {name.removesuffix(SUFFIX): i for i, name in enumerate(self.layout.body) if name.endswith(SUFFIX)}
        self._hung = {  # body and contacts of each
            load: (i, [k for k, owner in enumerate(self.loads) if owner == load])
            for load, i in bodies.items() if self.layout.path == "time"
        }  # fmt: skip
        self._spans = {load: array("d") for load in self._hung}
        self._times = array("d")

    def see(self, frames: Frames) -> None:
        """Take note of frames."""
        for load, (body, on) in self._hung.items():
            span = frames.of["body_position"][:, body] - frames.of["contact_position"][:, on].mean(axis=1)
            self._spans[load].frombytes(np.ascontiguousarray(span, dtype=np.float64).tobytes())
        if self._hung:
            self._times.extend(frames.path)

    def messages(self, run_info: RunInfo) -> Iterator[str]:
        """The payloads whose largest pull stands out from those before and after."""
        path = np.array(self._times)
        for load, span in self._spans.items():
            pull = pull_of(self.scenario, load, np.array(span).reshape(path.size, len(self.layout.axes)), path)
            if pull is None or (i := sharp(np.nan_to_num(pull))) is None:
                continue
            yield too_far_apart(f"the largest pull of payload {load}", pull, path, i)


def pull_of(scenario: Scenario | None, load: str, span: Array, path: Array) -> Array | None:
    """Pull of the rope of a payload at some instants, N; None: the scenario tells of no payload.

    Args:
        scenario: with the load.
        load: its name.
        span: (instant, axis) m, from trolley to payload.
        path: (instant,) s.
    """
    declared = None if scenario is None else scenario.loads.get(load)
    if scenario is None or not isinstance(declared, Trolley):
        return None
    rope, length = declared.payload, np.linalg.norm(span, axis=1)
    slack = rope.length - Travelled(*speed_table(rope.hoist, float(path[-1]))).at(path)  # what has been taken in
    stiffness = (rope.stiffness or rope.mass * scenario.gravity / STRETCH) * rope.length / slack
    pull = stiffness * (length - slack)
    if rope.damping and path.size > 2:
        pull += rope.damping * np.gradient(length - slack, path, edge_order=2)
    return np.where(length > slack, np.maximum(pull, 0.0), np.where(np.isfinite(length), 0.0, np.nan))


def payload_summary(dataset: xr.Dataset) -> dict[str, Summary]:
    """Give for every payload, by the name of its load, how it hangs over the output instants.

    `sway` is the largest level distance from its trolley in m, `swing` the largest angle from the vertical of its rope
    in rad while it pulls, `speed` the largest speed in m/s, `pull` the largest pull of its rope in N, `slack` the share
    of the instants at which the rope does not pull; these two are None where the scenario is not known. `lowest_place`
    is its least height in m, and how far `below` the first one that is.

    The pull is k (l - L) + c dl/dt of the rope as declared, with the length l between trolley and payload; its rate is
    that of a parabola through three instants.

    Args:
        dataset: a result.
    """
    bodies, name = dataset["body"].values.tolist(), path_name(dataset)
    hung = [(i, k) for i, k in ties(dataset) if bodies[i].endswith(SUFFIX)]
    if not hung or not dataset.sizes[name]:
        return {}
    scenario, path = scenario_of(dataset), dataset[name].values
    found: dict[str, Summary] = {}
    for i in dict.fromkeys(i for i, _ in hung):
        load, on = bodies[i].removesuffix(SUFFIX), [k for body, k in hung if body == i]  # one contact for each line
        span = dataset["body_position"].values[:, i] - dataset["contact_position"].values[:, on].mean(axis=1)
        aside = np.linalg.norm(span[:, :-1], axis=1)
        angle = np.arctan2(aside, -span[:, -1])
        pull = pull_of(scenario, load, span, path) if name == "time" else None
        slack = None if pull is None else float(np.mean(pull[np.isfinite(pull)] <= 0.0))
        found[load] = {
            "sway": largest(dataset, aside, "m"),
            "swing": largest(dataset, angle if pull is None else np.where(pull > 0.0, angle, np.nan), "rad"),
            "speed": largest(dataset, np.linalg.norm(dataset["body_velocity"].values[:, i], axis=1), "m/s"),
            "pull": None if pull is None else largest(dataset, pull, "N"),
            "slack": {"value": slack, "unit": "1"},
            "lowest_place": lowest(
                dataset, dataset["body_position"].values[:, i, -1], np.ones(path.size, dtype=np.bool_)
            ),
        }
    return found
