"""Loads whose start is measured along their line, and that stand elsewhere in x."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.model.position import position_in_x
from ropewalk.results.frame import Array, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.watch import Watch

if TYPE_CHECKING:
    from ropewalk.model import AnyLoad, Line

_MUCH = 0.02  # of the span; to stand a foot or two off the middle of a highline is nothing to ask about


class StartPositionWatch(Watch):
    """Compares where loads stand in the first frame with where their starts would be along the chord."""

    _first: tuple[Array, Array] | None = None  # positions and xi of contacts, m

    def see(self, frames: Frames) -> None:
        """Take note of frames."""
        if self._first is None:
            self._first = frames.of["contact_position"][0].copy(), frames.of["contact_xi"][0].copy()

    def messages(self, run_info: RunInfo) -> Iterator[str]:
        """Yield a warning for each load that stands elsewhere by a relevant part of the span."""
        for name, load in self.scenario.loads.items():
            line, travel = self.scenario.lines.get(load.on), getattr(load, "travel", load)
            if (
                line is None
                or position_in_x(load) is not None
                or (load.kind == "trolley" and load.also_on)
                or not load.starts()
            ):
                continue
            measured, start = load.starts()[0].measured, float(getattr(travel, "start", math.nan))
            contact, origin = self._contact(name, load, start), np.array(line.start[:-1])
            if contact is None or start == 0.0 or measured == "horizontal" or _is_intended(line, start):
                continue  # a model of its own, whose start is 0, says itself where it is
            place, reach = contact
            level: Array = np.array(line.end[:-1]) - origin
            if (span := float(np.linalg.norm(level))) == 0.0:
                continue
            along = float((place[: level.size] - origin) @ level) / span
            away = min(abs(along - start), abs(along - start * span / line.distance))
            if away > _MUCH * span:
                key = f"loads.{name}.{'travel.' if travel is not load else ''}from"
                where = ", ".join(f"{axis} = {r:.4g} m" for axis, r in zip("xy", place[: level.size], strict=False))
                yield (
                    f"load {name} starts at {where}, {along:.4g} m from the start of {load.on} measured horizontally: "
                    f"{key}: {start:.6g} m is measured along the unstrained line, which is {reach:.4g} m long between "
                    f"supports {line.distance:.4g} m apart{_remedy(load, line, start)}"
                )

    def _contact(self, name: str, load: AnyLoad, start: float) -> tuple[Array, float] | None:
        """Return the position of the contact that begins at the start of a load, and the last xi of its line, m."""
        assert self._first is not None
        own = [k for k, each in enumerate(self.loads) if each == name]
        starts = load.starts()
        pairs = list(zip(own, starts, strict=True)) if len(own) == len(starts) else [(k, starts[0]) for k in own[:1]]
        at = next((k for k, place in pairs if place.start == start), None)
        if at is None or not np.isfinite(self._first[0][at]).all():
            return None
        nodes = self.layout.node_xi[self.nodes_of(load.on)]
        return self._first[0][at], float(nodes.max(initial=0.0))


def _is_intended(line: Line, start: float) -> bool:
    """Return whether a start is plainly a part of a declared length, or of a way over sheaves, and not of the span."""
    half = math.isclose(start, 0.5 * line.distance, rel_tol=1e-3)
    return bool(line.sheaves or line.saddles) or ((line.length or 0.0) > line.distance and not half)


def _remedy(load: AnyLoad, line: Line, start: float) -> str:
    """Return the remedy, for loads and directions that have one."""
    if load.kind in ("axles", "train", "stepper", "fmu", "matrices") or line.end[0] == line.start[0]:
        return "; write the length along it at which the load is to begin"
    part = start / line.distance * (line.end[0] - line.start[0])
    x = line.start[0] + math.copysign(min(abs(start), abs(line.end[0] - line.start[0])), part)
    return f"; write from: {{x: {x:.6g} m}} to begin there, or from: middle for the middle of the span"
