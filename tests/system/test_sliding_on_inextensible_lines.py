"""What slides on inextensible lines: with drag, drivers and brakes, on straight ropes and on slack ones.

A bead on a straight rope that does not stretch is a particle: with drag it comes to its terminal speed exponentially,
with a brake it stops after v^2/2a, and what slows it down pulls at the upper end of the rope. Equilibria with friction
are the reference of given forces that rub.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from ropewalk.model import Scenario
from ropewalk.simulate import simulate

G, MASS, DRAG, WEIGHT, ROPE = 9.80665, 5.0, 20.0, 300.0, 10.0
RIGID: dict[str, Any] = {"law": {"kind": "inextensible"}}


def down(travel: dict[str, Any], step: float, until: float = 1.0) -> Any:
    """A bead on 10 m of rope of 1 kg/m that a weight of 300 N pulls straight down."""
    end = {"kind": "guided", "along": [0.0, 1.0], "force": -WEIGHT}
    line = {"start": [0, 0], "end": [0, -9.5], "length": ROPE, "mass": 1.0, "elements": 10, "end_support": end, **RIGID}
    load = {"on": "rope", "kind": "mass", "mass": MASS, "travel": {"kind": "free", "from": 2.0, **travel}}
    run = {"kind": "dynamic", "until": until, "every": 0.1, "step": step}
    return simulate(Scenario.model_validate({"lines": {"rope": line}, "loads": {"bead": load}, "run": run}))


def pull(result: Any) -> float:
    """Reaction at the upper end in the last frame, N."""
    return float(result.reaction.values[-1, 0, -1])


def test_drag_brings_a_bead_to_its_terminal_speed_exponentially() -> None:
    """v = m g/c (1 - exp(-c t/m)); friction is found with the place after a step, of the first order in that."""
    fastest, rate, errors = MASS * G / DRAG, DRAG / MASS, []
    for step in (8e-3, 4e-3, 2e-3):
        found = down({"viscous": DRAG}, step)
        t = found.time.values
        gone = fastest * (t - (1.0 - np.exp(-rate * t)) / rate)
        errors.append(np.abs(found.contact_xi.values[:, 0] - 2.0 - gone).max())
    print(errors)
    assert errors[-1] < 4e-3  # m, of 1.85 m
    assert all(1.5 < a / b < 2.2 for a, b in pairwise(errors))
    assert float(found.contact_speed.values[-1, 0]) == pytest.approx(fastest * (1.0 - np.exp(-rate)), abs=3e-3)
    assert pull(found) == pytest.approx(WEIGHT + ROPE * G + DRAG * float(found.contact_speed.values[-1, 0]), rel=1e-3)


def test_a_brake_stops_it_and_holds_it() -> None:
    """s = v^2/2a with a = F/m - g; then its weight hangs at the rope."""
    errors = []
    for step in (4e-3, 2e-3):
        found = down({"speed": 3.0, "brake": {"force": 100.0, "within": ROPE, "at": "both"}}, step)
        errors.append(float(found.contact_xi.values[-1, 0]) - 2.0 - 0.5 * 3.0**2 / (100.0 / MASS - G))
    print(errors, pull(found))
    assert abs(errors[1]) < 6e-3  # m, of 0.44 m
    assert float(found.contact_speed.values[-1, 0]) == 0.0
    assert pull(found) == pytest.approx(WEIGHT + (ROPE + MASS) * G, rel=1e-3)


def test_a_driver_holds_its_speed_and_one_of_too_little_force_does_not() -> None:
    found = down({"driver": {"speed": 1.0, "force": 200.0}}, 4e-3)
    np.testing.assert_allclose(np.diff(found.contact_xi.values[2:, 0]), 0.1, atol=1e-5)
    assert pull(found) == pytest.approx(WEIGHT + (ROPE + MASS) * G, rel=1e-3)
    weak = down({"driver": {"speed": -1.0, "force": 20.0}}, 4e-3)
    wanted = 2.0 + 0.5 * (G - 20.0 / MASS) * weak.time.values**2
    np.testing.assert_allclose(weak.contact_xi.values[:, 0], wanted, atol=2e-2)  # of 2.9 m, first order in the step


def test_an_eddy_current_brake_slows_it_as_drag_does() -> None:
    found = down({"speed": 3.0, "brake": {"rate": DRAG, "within": ROPE, "at": "both"}}, 2e-3)
    slowest = MASS * G / DRAG
    wanted = slowest + (3.0 - slowest) * np.exp(-DRAG / MASS * found.time.values)
    np.testing.assert_allclose(
        found.contact_speed.values[1:, 0], wanted[1:], atol=1.5e-2
    )  # m/s: of the first order in the step


SLIDES: dict[str, dict[str, Any]] = {
    "drag": {"viscous": 10.0, "speed": 3.0},
    "more drag": {"viscous": 100.0, "speed": 3.0},
    "driver": {"driver": {"speed": 4.5, "force": 98.0}, "speed": 3.0},
    "driver from rest": {"driver": {"speed": 2.0, "force": 98.0}},
    "brake": {"brake": {"force": 50.0, "within": 11.0, "at": "both"}, "speed": 3.0},
    "eddy currents": {"brake": {"rate": 20.0, "force": 40.0, "within": 11.0, "at": "both"}, "speed": 3.0},
    "spring": {"brake": {"stiffness": 50.0, "within": 9.5}, "speed": 3.0},
}


def slack(load: dict[str, Any], law: dict[str, Any] = RIGID, elements: int = 12, **run: Any) -> Any:
    line = {"start": [0, 0], "end": [10, 0], "length": 11.0, "mass": 1.0, "elements": elements, **law}
    asked = {"kind": "dynamic", "until": 0.4, "every": 0.1, **run}
    return simulate(
        Scenario.model_validate({"lines": {"rope": line}, "loads": {"load": {"on": "rope", **load}}, "run": asked})
    )


def bead(name: str) -> dict[str, Any]:
    return {"kind": "mass", "mass": MASS, "travel": {"kind": "free", "from": 2.0, **SLIDES[name]}}


def imbalance(result: Any) -> float:
    moving = result.energy.sel(form="kinetic") + result.energy.sel(form="load_kinetic")
    return float(abs(result.energy.sel(form="imbalance")).max() / moving.max())


@pytest.mark.parametrize("name", SLIDES)
def test_the_audit_closes_and_lengths_are_kept(name: str) -> None:
    """Of kinetic energy 1.5 %: a bead at 3 m/s is set down at once, 12 links, steps of 18 ms."""
    found = slack(bead(name))
    assert found.attrs["outcome"] == "completed"
    assert imbalance(found) < 1.5e-2
    assert np.abs(found.strain.values).max() < 1e-8


RUBS: dict[str, dict[str, Any]] = {
    "coulomb": {"contact": "coulomb", "friction": 0.2},
    "dragged": {"contact": "dragged", "friction": 0.2},
    "dragged back": {"contact": "dragged", "friction": 0.2, "travel": {"speed": -0.01, "from": 3.0}},
    "block": {"contact": "coulomb", "friction": 0.2, "friction_model": "block"},
    "holds by itself": {"contact": "coulomb", "friction": 1.0},
}


@pytest.mark.parametrize("name", RUBS)
def test_a_force_that_rubs_is_held_as_at_rest(name: str) -> None:
    """50 N that have grown slowly and go at 1 cm/s over a line with drag; 12 and 24 links."""
    load = {"kind": "force", "travel": {"speed": 0.01, "from": 3.0}, **RUBS[name]}
    grows = {"time": [0.0, 3.0, 100.0], "value": [[0.0, 0.0], [0.0, -50.0], [0.0, -50.0]]}
    way, off = load["travel"]["speed"], []
    for elements in (12, 24):
        line = {"start": [0, 0], "end": [10, 0], "length": 11.0, "mass": 1.0, "elements": elements, "drag": 4.0}
        rope = {"rope": line | RIGID}
        run = {"kind": "dynamic", "until": 6.0, "every": 3.0}
        found = simulate(Scenario.model_validate(
            {"lines": rope, "loads": {"load": {"on": "rope", "force": grows, **load}}, "run": run}
        ))  # fmt: skip
        there = {"on": "rope", "force": [0, -50], **load, "travel": {"speed": way, "from": 3.0 + 6.0 * way}}
        slow = simulate(Scenario.model_validate(
            {"lines": rope, "loads": {"load": there}, "run": {"kind": "quasistatic", "positions": 2}}
        ))  # fmt: skip
        off.append(abs(float(found.hold_force.values[-1, 0, 0] - slow.hold_force.values[0, 0, 0])))
        assert found.attrs["outcome"] == "completed"
    print(off)
    assert off[1] < 0.3  # N, of 50 N
    if name == "holds by itself":
        assert off == [0.0, 0.0]
