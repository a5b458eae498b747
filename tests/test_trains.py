"""Trains of axles: their geometry, in every kind of run, and what resonates."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import train_routes as routes
from ropewalk.linear import field
from ropewalk.model.axles import HSLM_A, hslm_a
from ropewalk.results.line_response import responses
from ropewalk.results.statistics import summary
from ropewalk.results.table import text
from ropewalk.scenario import dump, loads
from ropewalk.simulate import simulate
from ropewalk.sweeps.sweeping import sweep

DECK = """\
gravity: 0
lines:
  deck: {start: [0, 0], end: [20, 0], length: 20, mass: 10e3, axial_stiffness: 1e10, elements: 20,
         bending_stiffness: 16.211389e9, drag: 0.6283}
loads:
  train: {kind: axles, on: deck, forces: [100 kN, 50 kN, 80 kN], at: [0, 3, 11], coaches: {count: 2, length: 15},
          travel: {speed: 200 km/h, from: -2 m}}
outputs: {places: {midspan: {on: deck, at: 10}}}
run: {kind: dynamic, geometry: linearised, until: crossing, every: 5 ms}
"""


def crossing(*settings: str) -> Any:
    result = simulate(loads(DECK, overrides=settings))
    assert result.attrs["outcome"] == "completed", (result.attrs["advice"], result.attrs["doubts"])
    return result


def deflection(result: Any) -> Any:
    return responses(result)[0]["deck"].deflection


@pytest.mark.parametrize("name", HSLM_A)
def test_the_universal_trains_stand_as_they_are_tabulated_elsewhere(name: str) -> None:
    places, force = hslm_a(name)
    known = HSLM_A[name]
    assert np.allclose(places, routes.hslm_a(known.coaches, known.length, known.bogie), rtol=0.0, atol=1e-9)
    assert len(places) == 14 + 2 * known.coaches
    assert np.allclose(np.diff(places), np.diff(places)[::-1]), "it is the same backwards"
    assert force == known.force


def test_a_train_is_one_load_with_all_its_axles() -> None:
    result = crossing()
    assert result["load"].values.tolist() == [f"train.{k}" for k in range(1, 7)]
    found = summary(result)
    assert list(found["trains"]) == ["train"]
    assert not found["contacts"], "no statistics for each of its axles"
    assert found["trains"]["train"]["axles"] == 6
    # The first coach and the first two axles of the next one fit on 20 m.
    assert found["trains"]["train"]["load"]["max"] == pytest.approx(380e3)
    assert text(found).count("train") == 1


def test_the_run_ends_when_the_last_axle_has_left() -> None:
    scenario = loads(DECK)
    assert scenario.run.until == pytest.approx((20.0 + 2.0 + 26.0) * 3.6 / 200.0)
    again = loads(dump(scenario), "again.yaml")
    assert "until: crossing" in dump(scenario)
    assert again == scenario == pickle.loads(pickle.dumps(scenario))
    later = loads(DECK, overrides=["run.until=crossing + 2 s", "loads.train.travel.speed=10 m/s"])
    assert later.run.until == pytest.approx(4.8 + 2.0)
    braking = "{time: [0 s, 2 s], value: [20 m/s, 10 m/s]}"  # 30 m in 2 s, and 18 m in 1.8 s
    assert loads(DECK, overrides=[f"loads.train.travel.speed={braking}"]).run.until == pytest.approx(3.8)


def test_engines_agree_on_a_train() -> None:
    """By sine modes and by steps in time: fourth order of the links, 3e-4 at any instant with 20; also backwards."""
    exact = deflection(crossing("run={kind: linear, until: crossing, every: 5 ms}"))
    largest = exact.max()
    moved = deflection(crossing())
    finer = deflection(crossing("lines.deck.elements=40"))[:, ::2]
    backwards = deflection(crossing("loads.train.travel={speed: -200 km/h, from: 22 m}"))[:, ::-1]
    missed = [np.abs(found - exact).max() / largest for found in (moved, finer)]
    assert missed[0] < 3.5e-4
    assert 2.9 < np.log2(missed[0] / missed[1]) < 4.0, missed  # short waves come out of step: 10/3
    assert np.abs(backwards - moved).max() < 1e-9 * largest


def test_many_forces_at_once_are_the_sum_of_each_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    run = "run={kind: linear, until: 1 s, every: 20 ms}"
    together = crossing(run)
    monkeypatch.setattr(field, "FEW", 100)
    apart = crossing(run)
    for name in ("position", "contact_position", "contact_force"):
        np.testing.assert_allclose(together[name].values, apart[name].values, rtol=0.0, atol=1e-10)
    # Rates are exact together, and differences by themselves.
    assert np.abs(together.velocity.values - apart.velocity.values).max() < 1e-4 * np.abs(apart.velocity.values).max()


def test_slow_motion_goes_on_until_the_last_axle_has_left() -> None:
    slow = crossing("run={kind: quasistatic, positions: 97}")
    on = np.isfinite(slow.contact_force.values[..., -1])
    assert on.any(axis=0).all()
    assert not on[0].any()
    assert slow.load_path.values[-1] == pytest.approx(48.0)
    # Statics of a beam under its axles, by superposition.
    x, L = responses(slow)[0]["deck"].xi, 20.0
    at = -2.0 + slow.load_path.values[:, None] - np.array([0.0, 3.0, 11.0, 15.0, 18.0, 26.0])
    known = np.zeros((at.shape[0], x.size))
    for place, force in zip(at.T, [100e3, 50e3, 80e3] * 2, strict=True):
        a = np.clip(place, 0.0, L)[:, None]
        low, high = np.minimum(x, a), L - np.maximum(x, a)
        known += force * low * high * (L**2 - low**2 - high**2) / (6.0 * 16.211389e9 * L)
    assert np.abs(deflection(slow) - known).max() < 5e-3 * known.max()  # second order of 20 links: 0.43 %


@pytest.mark.parametrize("speed", [162.0, 324.0])
def test_a_train_resonates_at_the_speed_of_its_coaches(speed: float) -> None:
    """v = f D / k, k = 2 and 1, with f = 5 Hz and D = 18 m; 4 % beside it the deck is calmer by far."""
    found = [
        summary(crossing(f"loads.train={{kind: axles, on: deck, train: HSLM-A1, travel: {{speed: {v} km/h}}}}"))[
            "lines"
        ]["midspan"]["acceleration"]["largest"]["value"]
        for v in (0.96 * speed, speed, 1.04 * speed)
    ]
    assert found[1] > 1.5 * max(found[0], found[2]), found


def test_a_rope_bears_a_train_at_rest_and_in_motion() -> None:
    rope = """\
lines: {rope: {start: [0, 0], end: [20, 0], length: 20.05, mass: 2, axial_stiffness: 500 kN, axial_damping: 100,
               elements: 40}}
loads: {train: {kind: axles, on: rope, forces: 200 N, at: [0, 3, 11], travel: {speed: 8 m/s, from: 12 m}}}
run: {kind: equilibrium}
"""
    rest = simulate(loads(rope))
    pressing = -rest.contact_force.values[0, :, -1]
    assert pressing == pytest.approx([200.0] * 3)
    carried = rest.reaction.values[0, :, -1].sum()
    assert carried == pytest.approx(600.0 + 2.0 * 20.05 * 9.81, rel=1e-6)


def test_a_sweep_knows_how_long_its_trains_are(tmp_path: Any) -> None:
    deck = DECK.replace(
        "forces: [100 kN, 50 kN, 80 kN], at: [0, 3, 11], coaches: {count: 2, length: 15}", "train: HSLM-A1"
    )
    found = sweep(
        loads(deck),
        {"loads.train.train": ["HSLM-A1", "HSLM-A10"], "loads.train.travel.speed": ["50 m/s", "100 m/s"]},
        record="max acceleration of deck, max deflection of midspan, trains.train.last",
        store=tmp_path / "sweep.jsonl",
        workers=0,
    )
    assert (found["outcome"].values == "completed").all()
    last = found["trains.train.last"].values
    for row, name in enumerate(("HSLM-A1", "HSLM-A10")):
        away = 20.0 + 2.0 + hslm_a(name)[0][-1]  # m, of the last axle from the end of the deck
        assert last[row] == pytest.approx([away / 50.0, away / 100.0], abs=5e-3)
    assert (found["max acceleration of deck"].values > 0.0).all()
