"""Payloads on ropes and leashes whose largest pull falls between output instants, at which alone it is looked at."""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.mechanics.assembly import speed_table
from ropewalk.mechanics.travelled import Travelled
from ropewalk.model.trolley import Trolley
from ropewalk.results.frame import Array, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.peaks import sharp, too_far_apart
from ropewalk.results.watch import Watch

if TYPE_CHECKING:
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
