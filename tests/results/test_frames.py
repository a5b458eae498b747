"""Frames that are made of many instants at once are those that are made one by one."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import travelling_wave as wave

import ropewalk
from resume_cases import case
from ropewalk.results import Recorder, frames, recorder
from ropewalk.results.frame import ENERGY_FORMS, RunInfo
from ropewalk.results.frames import Frames, NotedInstants, Waiting
from ropewalk.results.running import Ending, TimeHistory

SPENT = ("cpu_seconds", "wall_seconds", "compile_seconds")


def assert_same(one, other):
    assert set(one.variables) == set(other.variables)
    for name in one.variables:
        a, b = one[name].values, other[name].values
        assert np.array_equal(a, b, equal_nan=a.dtype.kind == "f"), name
    assert {k: v for k, v in one.attrs.items() if k not in SPENT} == {
        k: v for k, v in other.attrs.items() if k not in SPENT
    }


@pytest.mark.parametrize(
    "kind",
    [
        "beam, vehicle that lifts off", "network, mass", "membrane, mass", "pantograph, small motion", "force", "mass",
        "free mass", "vehicle that lifts off", "trolley", "rope, moving supports", "pantograph, large motion",
        "stiff line, moving supports", "frictionless mass",
    ],
)  # fmt: skip
def test_to_the_last_bit_frames_do_not_depend_on_how_many_are_made_at_once(kind, monkeypatch):
    scenario, found = case(kind), []
    for wait in (0.0, 1e9):
        monkeypatch.setattr(frames, "WAIT", wait)
        found.append(ropewalk.simulate(scenario))
    assert_same(*found)


class Engine:
    """Frames made from formulas, at instants that are gone to one by one."""

    looks_ahead, together, cosimulation = False, True, ()

    def __init__(self, ends=None):
        self.layout, self._ends, self._now = wave.layout(), ends, -1
        self._frames = list(wave.frames(self.layout))[:8]
        self.times = np.array([frame.path for frame in self._frames])

    def advance(self, i, most=1):
        self._now = None
        if i == self._ends:
            raise KeyboardInterrupt
        self._now = i
        return Ending("diverged", "not at all") if i == 5 else None

    def note(self):
        return NotedInstants(0, None) if self._now is None else NotedInstants(1, self._frames[self._now])

    def frames(self, notes):
        return Frames.together([noted.of for noted in notes])


def test_the_first_frame_waits_for_none_and_a_motion_that_breaks_down_ends_with_its_last_one(monkeypatch):
    monkeypatch.setattr(frames, "WAIT", 1e9)
    engine, run_info = Engine(), RunInfo()
    blocks = list(TimeHistory(engine, run_info).blocks())
    assert [len(block) for block in blocks] == [1, 5]
    assert [*blocks[0].path, *blocks[1].path] == engine.times[:6].tolist()
    assert run_info.outcome == "diverged"


def test_frames_that_wait_are_given_before_an_interrupt(monkeypatch):
    monkeypatch.setattr(frames, "WAIT", 1e9)
    engine, found = Engine(ends=4), list[float]()

    def take():
        for block in TimeHistory(engine, RunInfo()).blocks():
            found.extend(block.path)

    with pytest.raises(KeyboardInterrupt):
        take()
    assert found == engine.times[:4].tolist()


def test_no_more_frames_wait_than_there_is_room_for(monkeypatch):
    monkeypatch.setattr(frames, "WAIT", 1e9)
    waiting, one = Waiting(frames.SPACE // 3), NotedInstants(1, None)
    assert waiting.append(one, 0)  # the first one waits for none
    assert waiting.taken() == [(one, 0)]
    assert [waiting.append(one, i) for i in range(3)] == [False, False, True]
    assert Waiting(2 * frames.SPACE).append(one, 0)  # one larger than all the room


def test_what_is_recorded_at_once_is_what_is_recorded_one_by_one(tmp_path, monkeypatch):
    monkeypatch.setattr(recorder, "BLOCK_ROWS", 7)  # fewer than come at once
    layout, missing, found = wave.layout(), ENERGY_FORMS.index("imbalance"), []
    kept = list(wave.frames(layout))
    for i, frame in enumerate(kept):  # some energy gets lost, most of it once
        energy = frame.energy.copy()
        energy[missing] = 1e3 * i + (5e4 if i > 50 else 0.0)
        kept[i] = dataclasses.replace(frame, energy=energy)
    for name, size in (("one", 1), ("some", 40), ("all", len(kept))):
        with Recorder(layout, wave.scenario(), wave.run_info(), tmp_path / f"{name}.nc") as record:
            for i in range(0, len(kept), size):
                record.extend(Frames.together(kept[i : i + size]))
            found.append(record.close())
    assert "Energy residual" in found[0].attrs["doubts"]
    for other in found[1:]:
        assert_same(found[0], other)
