"""Crossings of trains by modes: exact in resonance, the same in sweeps as one by one."""

from __future__ import annotations

import numpy as np
import pytest

from ropewalk.linear.chord import Chord
from ropewalk.linear.steady import SteadyForces
from ropewalk.scenario import loads
from ropewalk.simulate import simulate
from ropewalk.sweeps.by_modes import by_modes
from ropewalk.sweeps.quantities import measured

DECK = Chord(np.zeros(2), np.array([1.0, 0.0]), np.array([[0.0, -1.0]]), 20.0, 20.0, 0.0, 10e3, 16.2114e9, 0.0, 0.0)


@pytest.mark.parametrize("beside", [0.0, 1e-12, 1e-6, -1e-4])
def test_an_undamped_mode_in_resonance_grows_as_it_must(beside: float) -> None:
    """q'' + w^2 q = F sin w t gives F (sin w t - w t cos w t) / 2 w^2, and beside it nearly that.

    Forces over 20 m at k V = w turn by a half: F pi / 2 w^2 each, then they swing freely. Four come one after another.
    """
    L, F, k = DECK.length, 100e3, np.pi / DECK.length
    w = k**2 * np.sqrt(DECK.bending_stiffness / DECK.mass)
    V = w / k * (1.0 + beside)
    behind = np.array([0.0, 7.0, 16.0, 31.0])
    t = 1e-3 * np.arange(601.0)
    q, rate = SteadyForces(DECK, -behind, np.full(4, V), np.full(4, F), 1).coordinates(t)
    since = np.clip(t[:, None] - behind / (w / k), 0.0, None)
    on = np.minimum(since, L * k / w)
    known = np.sin(w * on) - w * on * np.cos(w * on)
    free = since > on  # from F (pi, 0) / 2 w^2 on
    known = np.where(free, np.pi * np.cos(w * (since - on)), known).sum(axis=1) * F / (2.0 * w**2)
    grown = np.where(free, -np.pi * np.sin(w * (since - on)), w * on * np.sin(w * on)).sum(axis=1) * F / (2.0 * w)
    slack = 1e-11 + 40.0 * abs(beside)  # phases of up to 2 pi V t / L = 19 come apart by so much
    np.testing.assert_allclose(q[:, 0], known, rtol=0.0, atol=slack * np.abs(known).max())
    np.testing.assert_allclose(rate[:, 0], grown, rtol=0.0, atol=slack * np.abs(grown).max())


BRIDGE = """\
gravity: 0
lines:
  deck: {start: [0, 0], end: [20, 0], length: 20, mass: 10e3, axial_stiffness: 1e10, elements: 20,
         bending_stiffness: 16.2114e9, drag: 0.6283}
loads: {train: {kind: axles, on: deck, train: HSLM-A1, travel: {speed: 324 km/h}}}
outputs: {places: {quarter: {on: deck, at: 5.4}}}
run: {kind: linear, until: crossing + 0.5 s, every: 8 ms, modes: 5}
"""
RECORD = (
    "max acceleration of deck",
    "max deflection of quarter",
    "min deflection of deck",
    "min acceleration of quarter",
)


@pytest.mark.parametrize(
    "settings",
    [
        (),
        ("run.modes=40", "loads.train.travel.from=-3.7 m", "gravity=9.81"),
        ("lines.deck.start=[1 m, 2 m, 0 m]", "lines.deck.end=[17 m, 14 m, 1 m]", "lines.deck.drag=null",
         "lines.deck.damping={ratio: 2 %, at: [5 Hz]}"),
        ("loads.train={kind: axles, on: deck, forces: [9e3, 7e3, 8e3, 5e3], at: [0, 2, 9, 12], travel: {speed: 60}}",
         "lines.deck.bending_stiffness=null", "lines.deck.length=19.99", "run.every=5 ms"),
    ],
    ids=["level", "many modes", "in space", "a string"],
)  # fmt: skip
def test_what_sweeps_read_of_modes_is_what_the_result_has(settings: tuple[str, ...]) -> None:
    """To rounding: what is done to modes is linear, and done to the result otherwise."""
    scenario = loads(BRIDGE, overrides=settings)
    found = by_modes(scenario, RECORD)
    assert found is not None
    with simulate(scenario) as result:
        assert result.attrs["outcome"] == "completed"
        known = measured(result, RECORD)
    for name, (value, unit) in known.items():
        assert found[name] == (pytest.approx(value, rel=1e-9), unit), name


@pytest.mark.parametrize(
    "settings",
    [
        ("run.kind=dynamic", "run.geometry=linearised", "run.modes=null"),
        ("run.every=10 ms",),
        ("run={kind: linear, until: 1 s, every: 8 ms}", "loads.train.travel.from=-100 m"),
        ("loads.train={kind: axles, on: deck, forces: 9 kN, at: [0, 2, 9], travel: {speed: 60}}",),
        ("loads.train={kind: axles, on: deck, forces: 1e-4, at: [0, 2, 9, 12], travel: {speed: 9}}", "run.every=4 ms"),
        ("loads.man={kind: force, on: deck, force: [0, -1], travel: {speed: 1, from: 3, at_end: leave}}",),
        ("loads.train.travel.measured=horizontal",),
    ],
    ids=["in steps", "too coarse", "never there", "closed forms", "presses on nothing", "other loads", "measured"],
)  # fmt: skip
def test_what_only_a_run_can_tell_is_left_to_it(settings: tuple[str, ...]) -> None:
    assert by_modes(loads(BRIDGE, overrides=settings), RECORD) is None


def test_what_modes_do_not_tell_is_left_to_the_run() -> None:
    assert by_modes(loads(BRIDGE), [*RECORD, "max moment of deck"]) is None
