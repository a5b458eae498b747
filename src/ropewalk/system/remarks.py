"""What is remarked of motions: what must not be trusted, and why."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ropewalk.mechanics.contact_points import ContactPoint
from ropewalk.model.carriage import Carriage
from ropewalk.model.scenario import Scenario
from ropewalk.model.travel import FreeTravel
from ropewalk.results.frame import RunInfo
from ropewalk.results.frames import Frames


def shaken(scenario: Scenario) -> list[str]:
    """Loads that rub by themselves on lines whose own waves nothing damps (docs/notes/contacts-on-splines.md)."""
    return [
        f"loads.{name} slides with friction on {load.on}, along which waves are not damped: they shake the contact, "
        f"and friction bears less than it should; give lines.{load.on} an axial_damping"
        for name, load in scenario.loads.items()
        if isinstance(travel := getattr(load, "travel", None), FreeTravel) and travel.friction > 0.0
        if (line := scenario.lines.get(load.on)) is not None and not line.axial_damping
    ]


def doubt_saddles(scenario: Scenario, run_info: RunInfo, frames: Frames, line: Sequence[str]) -> None:
    """Doubt lines that pass below a saddle from the beginning: there rest was found on the wrong side of it."""
    for name, own in scenario.lines.items():
        place = frames.of["position"][0, np.array([one == name for one in line])]
        for saddle, body in own.saddles.items():
            key = f"lines.{name}.saddles.{saddle}"
            near = np.abs(place[:, 0] - body.at[0]) < body.radius
            low = near.any() and place[near, -1].max() < body.at[-1] - body.radius
            if low and all(doubt.key != key for doubt in run_info.doubts):
                cause = "its rest was sought from a line that is too long"
                run_info.doubt(
                    f"line {name} passes below saddle {saddle}", cause, key,
                    f"give lines.{name} less length, at most that of the straight way over its saddles",
                )  # fmt: skip


def doubt_wheels(scenario: Scenario, run_info: RunInfo, frames: Frames, wheels: Sequence[ContactPoint]) -> None:
    """Doubt carriages whose wheels would leave the rope, where nothing lets them."""
    for k, wheel in enumerate(wheels):
        load, key = scenario.loads[wheel.load], f"loads.{wheel.load}.lift_off"
        if not isinstance(load, Carriage) or load.lift_off or any(doubt.key == key for doubt in run_info.doubts):
            continue
        lifts = frames.of["contact_force"][:, k, -1] > 0.0
        if lifts.any():
            t = float(frames.path[int(np.argmax(lifts))])
            run_info.doubt(
                f"wheel {wheel.part} of {wheel.load} would leave its rope at t = {t:.4g} s",
                "it is drawn down there, as if there were a rail above it", key, "write lift_off: true",
            )  # fmt: skip
