"""Motions by the engine of the whole system, whichever engine would be chosen for them."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.capabilities import Engine
from ropewalk.model import Linear, Scenario
from ropewalk.model.run import every_of
from ropewalk.results.frame import ENERGY_FORMS, Frame, RunInfo
from ropewalk.results.running import TimeHistory
from ropewalk.simulate import output_times, simulate
from ropewalk.system.dynamics.moving import SystemMotion
from ropewalk.system.small_motion.superposed import Superposed

ROPE = {"start": [0, 0], "end": [20, 1], "length": 20.4, "mass": 1.0, "axial_stiffness": 1e5, "elements": 40}
TRIPOD = {
    "deck": {**ROPE, "axial_damping": 30.0},
    "stay": {"start": [9, 6], "end": [10, -1.5], "end_support": {"kind": "joined", "to": "deck", "at": 10.2},
             "length": 8.6, "mass": 0.4, "axial_stiffness": 4e4, "elements": 10},
}  # fmt: skip
"""A rope that sags, and the same with another one that holds it to the side."""


def computed(
    asked: Scenario, engine: Engine, monkeypatch: pytest.MonkeyPatch, outcomes: tuple[str, ...] = ("completed",)
) -> xr.Dataset:
    """The result by an engine, whichever would be chosen, with an outcome that may be."""
    monkeypatch.setattr(sys.modules["ropewalk.simulate"], "engine_of", lambda _: engine)
    found = simulate(asked)
    monkeypatch.undo()
    assert found.attrs["outcome"] in outcomes
    return found


def missed(result: xr.Dataset) -> float:
    """What the audit misses at most, of what the line stores in the meantime, J/J."""
    energy = {form: result["energy"].values[:, i] for i, form in enumerate(result["form"].values)}
    return float(np.abs(energy["imbalance"]).max() / np.ptp(energy["elastic"]))


def with_steps_of(scenario: Scenario, part: float) -> Scenario:
    """The same in steps of a part of those that would be taken."""
    step = part * SystemMotion(scenario, RunInfo(), np.array([0.0, scenario.run.until]))._step
    return scenario.model_copy(update={"run": scenario.run.model_copy(update={"step": step})})


def frames_of(scenario: Scenario, times: np.ndarray | None = None) -> list[Frame]:
    """All frames of a motion, which must come to its end."""
    run = scenario.run
    if times is None:
        times = np.arange(0.0, run.until + 0.5 * every_of(run), every_of(run))
    run_info = RunInfo()
    frames = list(TimeHistory(SystemMotion(scenario, run_info, times), run_info).frames())
    assert run_info.outcome == "running", run_info.advice
    assert len(frames) == times.size
    return frames


def imbalance(frames: list[Frame]) -> float:
    """What the energy audit misses at most, over the largest energy of loads and lines in motion."""
    missed = max(abs(frame.energy[ENERGY_FORMS.index("imbalance")]) for frame in frames)
    moving = [ENERGY_FORMS.index(form) for form in ("kinetic", "load_kinetic", "load_work", "hold_work")]
    return float(missed / max(np.abs(frame.energy[moving]).max() for frame in frames))


def superposed(scenario: Scenario, run_info: RunInfo | None = None) -> list[Frame]:
    """The same motion by kind: linear."""
    run = Linear(until=scenario.run.until, every=scenario.run.every)
    return list(Superposed(scenario, run, output_times(run), run_info or RunInfo()).frames())


def changes(frames: list[Frame], of: str) -> np.ndarray:
    """Of all frames from the first one."""
    values = np.array([getattr(frame, of) for frame in frames])
    return np.asarray(values - values[0])


def line(**keys: Any) -> dict[str, Any]:
    """A taut line of 1 m, 1 kg/m and 1 N."""
    return {"start": [0, 0], "end": [1, 0], "tension": 1.0, "mass": 1.0, "axial_stiffness": 1e4} | keys


def scenario(lines: dict[str, Any], loads: dict[str, Any], until: float, every: float, **keys: Any) -> Scenario:
    """A motion of lines without weight."""
    run = {"kind": "dynamic", "until": until, "every": every}
    return Scenario.model_validate({"gravity": 0.0, "lines": lines, "loads": loads, "run": run} | keys)


HELD_TAUT: dict[str, Any] = {
    "start": [0, 0, 0], "end": [20, 0, 0], "tension": 8e3, "mass": 2.0, "axial_stiffness": 1e9, "elements": 20,
}  # fmt: skip


def deck_on_a_hanger(elements: int) -> dict[str, Any]:
    """A stiff deck that hangs from a rope by one hanger in the middle."""
    hanger = {
        "start": [10, 0, 3], "end": [10, 0, 0], "length": 1.2, "mass": 0.2, "axial_stiffness": 1e6, "elements": 4,
        "start_support": {"kind": "joined", "to": "cable", "at": 10.2},
        "end_support": {"kind": "joined", "to": "deck", "at": 10.0},
    }  # fmt: skip
    cable = {
        **HELD_TAUT,
        "axial_stiffness": 1e6,
        "tension": None,
        "length": 20.4,
        "start": [0, 0, 3],
        "end": [20, 0, 3],
        "elements": elements,
    }
    deck = {
        **HELD_TAUT,
        "axial_stiffness": 1e6,
        "tension": None,
        "length": 20.0,
        "bending_stiffness": 5e4,
        "elements": elements,
    }
    return {"cable": cable, "deck": deck, "hanger": hanger}
