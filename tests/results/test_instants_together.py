"""Output instants that a motion comes to without Python: what is written does not depend on how many they are."""

from __future__ import annotations

import numpy as np
import pytest

import ropewalk
from resume_cases import case
from ropewalk.chains.moving import Chain
from ropewalk.model import Scenario
from ropewalk.results import frames
from ropewalk.results.frame import RunInfo
from ropewalk.results.frames import Waiting
from ropewalk.results.running import TimeHistory
from ropewalk.scenario import loads
from ropewalk.simulate import run_of
from ropewalk.solve.motion import ChainMotion
from ropewalk.system.dynamics import intervals
from ropewalk.system.dynamics.moving import SystemMotion
from ropewalk.wires.frames import Wires

SPENT = ("cpu_seconds", "wall_seconds", "compile_seconds")
ROPE = """
lines: {rope: {start: [0, 0], end: [%s m, 0], length: 20 m, mass: 1, axial_stiffness: 100 kN, elements: 20%s}}
loads: {one: {kind: force, on: rope, force: %s, travel: {speed: %s, from: 1 m%s}}}
run: {kind: dynamic, until: 0.6, every: 5 ms%s}
"""
STEPS = "{time: [0, 0.0131, 0.05, 0.2003, 0.4], value: [[0, 0], [0, -800], [0, -100], [0, -2000], [0, 0]]}"
SPEEDS = "{time: [0, 0.0131, 0.05, 0.2, 0.6], value: [10, 12, 11, 20, 5]}"
STIFFENS = ROPE.replace("axial_stiffness: 100 kN", "law: {kind: polynomial, coefficients: [1e5, 0, 3e8]}")
JOINED = """
joints: {knot: {}}
lines:
  one: {start: [0, 0], end: [10, 0], end_support: {kind: joined, to: knot}, tension: 20 kN, mass: 1,
    axial_stiffness: 2 MN, elements: 10}
  two: {start: [10, 0], end: [20, 0], start_support: {kind: joined, to: knot}, tension: 20 kN, mass: 1,
    axial_stiffness: 2 MN, elements: 10}
loads: {load: {kind: %s, on: one, travel: {speed: 80, from: 1 m%s}}}
run: {kind: dynamic, until: 0.2, every: 1 ms}
"""
BEAM = """
lines: {beam: {start: [0, 0], end: [20, 0], tension: 20 kN, mass: 10, axial_stiffness: 10 MN, elements: 20,
  bending_stiffness: 1 MN*m^2%s}}
loads: {load: {kind: %s, on: beam, travel: {speed: 60, from: 1 m, at_end: leave}}}
run: {kind: dynamic, geometry: linearised, until: 0.4, every: %s}
"""
CASES = {
    "rope": ROPE % (19.5, "", "[0, -800]", 10, "", ""),
    "rope, verlet": ROPE % (19.5, ", axial_damping: 20", "[0, -800]", 10, "", ""),
    "rope in compression": ROPE.replace("5 ms", "6 ms") % (18, "", "[0, -800]", 10, "", ", accuracy: 1 mm"),
    "rope that stiffens": STIFFENS % (19.99, "", "[0, -9000]", 30, "", ""),
    "rope, tables": ROPE % (19.5, "", STEPS, SPEEDS, "", ""),
    "rope to its end": ROPE % (19.5, "", "[0, -800]", 60, ", measured: slip", ""),
    "rope, implicit": ROPE % (19.5, ", axial_damping: 2000", "[0, -800]", 10, "", ", method: implicit"),
    "joined ropes, force": JOINED % ("force, force: [0, -500]", ", at_end: stay"),
    "joined ropes, mass that stops the run": JOINED % ("mass, mass: 10", ""),
    "joined ropes, oscillator": JOINED % ("oscillator, mass: 10, stiffness: 4 kN/m, damping: 50", ", at_end: stay"),
    "beam, oscillator": BEAM % ("", "oscillator, mass: 100, stiffness: 20 kN/m, damping: 500", "1 ms"),
    "beam, force": BEAM % ("", "force, force: [0, -500]", "1 ms"),
    "beam, mass, samples": BEAM % (", drag: 0.5", "mass, mass: 100", "7 ms"),
}  # fmt: skip
OF_OTHERS = (
    "force", "footsteps", "network, mass", "network, moving supports", "net", "pantograph, small motion",
    "dropper that fails", "beam, vehicle that lifts off", "small motion, moving supports", "mass", "free mass",
    "frictionless mass", "vehicle", "vehicle that lifts off", "trolley", "rope, moving supports",
    "stiff line, moving supports", "pantograph, large motion",
)  # fmt: skip


def scenario(name: str) -> Scenario:
    return loads(CASES[name], "case.yaml") if name in CASES else case(name)


def with_at_most(most: int, monkeypatch, name: str):
    monkeypatch.setattr(Waiting, "ask", lambda self: most)
    return ropewalk.simulate(scenario(name))


def one_by_one(monkeypatch, name: str):
    """By calls of Python for each instant, and what it looks at there."""
    with monkeypatch.context() as patch:
        patch.setattr(ChainMotion, "goes_through", False)
        patch.setattr(SystemMotion, "_intervals", lambda self, i, most: intervals.Intervals.nowhere(self.bodies))
        patch.setattr(Wires, "_count_through", lambda self, i, most: 1)
        return with_at_most(1, patch, name)


@pytest.mark.parametrize("name", [*CASES, *OF_OTHERS])
def test_to_the_last_bit_results_do_not_depend_on_how_many_instants_come_at_once(name, monkeypatch):
    one = one_by_one(monkeypatch, name)
    for most in (1, 7, 10_000):
        other = with_at_most(most, monkeypatch, name)
        assert set(one.variables) == set(other.variables)
        for key in one.variables:
            a, b = one[key].values, other[key].values
            assert np.array_equal(a, b, equal_nan=a.dtype.kind == "f"), key
        for key in set(one.attrs) - set(SPENT):
            assert one.attrs[key] == other.attrs[key], key


@pytest.mark.parametrize(
    ("name", "engine", "most"),
    [
        ("rope", Chain, 3), ("rope, tables", Chain, 3), ("rope in compression", Chain, 3),
        ("joined ropes, force", SystemMotion, 3), ("beam, oscillator", Wires, 4), ("mass", Chain, 4),
        ("stiff line, moving supports", Wires, 4),
    ],
)  # fmt: skip
def test_python_wakes_when_all_instants_are_done(name, engine, most, monkeypatch):
    """The first one, all others, and that before which an engine that looks ahead is stored; a rope wakes to look."""
    monkeypatch.setattr(Waiting, "ask", lambda self: 10_000)
    run, calls = run_of(scenario(name), RunInfo()), list[int]()
    assert isinstance(run, TimeHistory)
    assert isinstance(run.engine, engine)
    advance = run.engine.advance
    monkeypatch.setattr(run.engine, "advance", lambda i, most: calls.append(i) or advance(i, most))
    assert sum(len(block) for block in run.blocks()) == run.total
    assert len(calls) <= most


def test_steps_of_many_lengths_take_several_calls(monkeypatch):
    """Instants that are meant to be equally far apart differ by rounding; the kernel is handed a few lengths only."""
    monkeypatch.setattr(intervals, "KINDS", 2)
    found = with_at_most(10_000, monkeypatch, "joined ropes, force")
    monkeypatch.undo()
    whole = with_at_most(10_000, monkeypatch, "joined ropes, force")
    assert np.array_equal(found["position"].values, whole["position"].values)


def test_as_many_instants_come_at_once_as_the_last_ones_leave_time_for(monkeypatch):
    """First one by one, then eight times as many as before at most, within a tenth of a second and 16 MB."""
    now = [100.0]
    monkeypatch.setattr(frames.clock, "monotonic", lambda: now[0])
    waiting, asked, blocks = Waiting(frames.SPACE // 1000), list[int](), list[int]()
    for _ in range(12):
        asked.append(waiting.ask())
        now[0] += 2e-3 * asked[-1]
        if waiting.append(frames.NotedInstants(asked[-1], None), {}):
            blocks.append(len(waiting))
            waiting.taken()
    assert asked[:2] == [1, 8]
    assert blocks[0] == 1  # the first frame waits for none
    assert set(blocks[1:]) <= {49, 50}  # a tenth of a second of them
    quick = Waiting(frames.SPACE // 100)
    for expected in (1, 8, 64, 28):  # 28 are all that there is memory for beside 72
        assert quick.ask() == expected
        quick.append(frames.NotedInstants(expected, None), {})
        if expected == 1:
            quick.taken()


def test_what_is_raised_on_the_way_leaves_what_was_noted_and_no_state_to_go_on_from(monkeypatch):
    monkeypatch.setattr(Waiting, "ask", lambda self: 10)
    run = run_of(scenario("rope"), RunInfo())
    assert isinstance(run, TimeHistory)
    through = run.engine.motion.through

    def interrupted(times, notes):
        if times[0] < 0.1:
            return through(times, notes)
        through(times[:4], notes)
        raise KeyboardInterrupt

    monkeypatch.setattr(run.engine.motion, "through", interrupted)
    found = list[float]()
    assert run.get_state() is not None

    def take():
        for block in run.blocks():
            found.extend(block.path)

    with pytest.raises(KeyboardInterrupt):
        take()
    count = len(found)
    assert count > 20
    np.testing.assert_array_equal(found, run.engine.times[:count])
    assert run.get_state() is None
