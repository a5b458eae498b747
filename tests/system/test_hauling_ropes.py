"""Hauling ropes that sag, and counter ropes, against elastic catenaries, Ernst's stiffness and Euler's sheave."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.hanging_rope import hang_by_tension_entry
from ropewalk.model import Scenario
from ropewalk.results.statistics import summary
from ropewalk.simulate import simulate
from ropewalk.system.loads.hauling_ropes import tension_entry
from ropewalk.theory.rope import catenary, elastic_catenary
from ropeway_routes import held_by_catenaries

G = 9.81
TRACK = {
    "start": [0.0, 0.0], "end": [60.0, 20.0], "tension": "2 MN", "mass": 20.0, "axial_stiffness": "200 MN",
    "elements": 12,
}  # fmt: skip
LEVEL = {**TRACK, "end": [60.0, 0.0]}
HAUL = {"axial_stiffness": 2e6, "speed": 0.0, "mass": 5.0, "sags": True, "counter": {"tension": 3e3, "mass": 4.0}}


def run(line: dict[str, Any], haul: dict[str, Any], until: float, **more: Any) -> xr.Dataset:
    car = {"kind": "carriage", "on": "rope", "mass": 500.0, "rockers": [0.8], "haul": haul,
           "travel": {"kind": "free", "from": 30.0}, **more}  # fmt: skip
    asked = {"kind": "dynamic", "until": until, "every": 0.02, "start": {"with_loads": True}}
    return simulate(Scenario.model_validate({"lines": {"rope": line}, "loads": {"car": car}, "run": asked}))


def test_a_rope_of_given_tension_is_the_taut_catenary() -> None:
    rope = catenary(span=200.0, height=60.0, length=210.0, weight=12.0)
    tension = float(np.linalg.norm(rope.end_reaction))
    assert hang_by_tension_entry(200.0, 60.0, tension, 12.0) == pytest.approx(tuple(rope.force[0]), rel=1e-8)


@pytest.mark.parametrize("taut", [10.0, 40.0])  # tension over the weight of the rope
def test_a_shallow_rope_is_as_stiff_as_ernst_says(taut: float) -> None:
    """Pull and 1/k = L/EA + (w l)^2 L/(12 T^3) (Ernst 1965, Dischinger 1949) beside an elastic catenary.

    Right to the sag, 1/80 and 1/320, and to the strain, by which L is longer than it was.
    """
    span, EA, w = 200.0, 1e7, 12.0

    def pull(more: float) -> float:
        rope = elastic_catenary(span=span + more, height=0.0, length=length, weight=w, axial_stiffness=EA)
        return float(rope.force[0][0])

    length = span * (1.0 + 1.0 / (24.0 * taut**2) - taut * w * span / EA)
    T = pull(0.0)
    soft = (w * span) ** 2 / 24.0
    assert tension_entry(span / length - 1.0, soft, EA) == pytest.approx(T, rel=0.1 / taut)
    compliance = 2e-3 / (pull(1e-3) - pull(-1e-3))
    assert compliance == pytest.approx(span / EA + (w * span) ** 2 * span / (12.0 * T**3), rel=0.2 / taut + T / EA)
    more = [tension_entry((span + way) / length - 1.0, soft, EA) for way in (-1e-3, 1e-3)]
    assert 2e-3 / (more[1] - more[0]) == pytest.approx(compliance, rel=0.2 / taut + T / EA)


def test_a_carriage_at_rest_is_held_by_two_catenaries() -> None:
    result = run(TRACK, HAUL, 0.4)
    assert result.attrs["outcome"] == "completed", result.attrs["doubts"]
    place = result.contact_position.values[0].mean(axis=0)
    ahead = np.diff(result.contact_position.values[0], axis=0)[0]
    rope, counter = held_by_catenaries(
        place, ahead / np.linalg.norm(ahead), np.zeros(2), np.array([60.0, 20.0]), 500.0 * G, (2e6, 5.0 * G),
        (3e3, 4.0 * G),
    )  # fmt: skip
    found = summary(result)["carriages"]["car"]
    for key in ("max", "min"):  # nothing moves
        # Its sag is that of a shallow rope: right to (w l/T)^2/24 = 4e-3 of what sags.
        assert found["pull"][key]["value"] == pytest.approx(np.linalg.norm(rope.force[0]), rel=1e-3)
        assert found["drive_tension"][key]["value"] == pytest.approx(np.linalg.norm(rope.end_reaction), rel=1e-3)
        assert found["counter_pull"][key]["value"] == pytest.approx(np.linalg.norm(counter), rel=1e-5)
    # Ropes that sag weigh on the carriage, each with more than half of itself as it hangs below its chord.
    line = result.contact_force.values[0].sum(axis=0) - result.hold_force.values[0].sum(axis=0)
    assert -line[1] == pytest.approx(500.0 * G, rel=1e-3)
    pressed = -result.contact_force.values[0, :, 1].sum()
    assert pressed == pytest.approx(500.0 * G - (rope.force[0] + counter)[1], rel=4e-3)


def test_a_carriage_on_a_rope_that_sags_swings_as_stiff_as_that() -> None:
    """Along the track, omega^2 = dF/ds / M with the pull of both catenaries as the carriage goes by ds."""
    start = {"time": [0.0, 0.1, 0.2], "value": [0.0, 0.2, 0.0]}  # 2 cm are taken in
    result = run(TRACK, {**HAUL, "speed": start}, 4.0)
    assert result.attrs["outcome"] == "completed", result.attrs["doubts"]
    place, time = result.contact_position.values.mean(axis=1), result.time.values
    way = np.array([60.0, 20.0]) / np.hypot(60.0, 20.0)
    s = (place - place[time > 0.3].mean(axis=0)) @ way
    late = np.flatnonzero((s[:-1] < 0.0) & (s[1:] >= 0.0) & (time[1:] > 0.3))
    at = time[late] - s[late] * 0.02 / (s[late + 1] - s[late])
    middle = place[time > 0.3].mean(axis=0)
    rope, _ = held_by_catenaries(
        middle, way, np.zeros(2), np.array([60.0, 20.0]), 500.0 * G, (2e6, 5.0 * G), (3e3, 4.0 * G)
    )

    def force(ds: float) -> float:
        far, up = np.array([60.0, 20.0]) - middle - ds * way
        back = hang_by_tension_entry(*(middle + ds * way) * [1.0, -1.0], 3e3, 4.0 * G)
        length = float(rope.breaks[-1])
        haul = elastic_catenary(span=far, height=up, length=length, weight=5.0 * G, axial_stiffness=2e6).force[0]
        return float(np.array(haul) @ way + np.array([-back[0], back[1]]) @ way)

    stiffness = (force(-0.01) - force(0.01)) / 0.02
    # A third of the hauling rope swings along, and all of the counter rope. The track gives way below the wheels, and
    # its slope turns as they go on: 1 % of the frequency.
    mass = 500.0 + 5.0 * float(np.hypot(60.0, 20.0) * 0.5) / 3.0 + 4.0 * float(np.hypot(60.0, 20.0) * 0.5)
    assert 2.0 * np.pi * (at.size - 1) / (at[-1] - at[0]) == pytest.approx(np.sqrt(stiffness / mass), rel=0.02)
    assert abs(summary(result)["energy"]["largest_imbalance"]["value"]) < 0.05  # J


def test_a_counter_rope_keeps_the_hauling_rope_taut_while_the_drive_brakes() -> None:
    """On a level track the hauling rope bears T - M a with the tension T of the counter rope, at a = 2 m/s^2."""
    speed = {"time": [0.0, 1.0, 3.0], "value": [4.0, 4.0, 0.0]}
    haul = {"axial_stiffness": 2e7, "axial_damping": 2e5, "speed": speed, "counter": {"tension": 4e3}}
    result = run(LEVEL, {**haul, "sheave": {"friction": 0.3, "wrap": "180 deg"}}, 3.0)
    assert result.attrs["outcome"] == "completed", result.attrs["doubts"]
    assert "slack" not in result.attrs["warnings"]
    found = summary(result)["carriages"]["car"]
    both = result.hold_force.values[:, :, 0].sum(axis=1)
    assert both[result.time.values > 2.0].mean() == pytest.approx(-500.0 * 2.0, rel=0.03)
    # It begins to brake at once, as a mass on a spring: it swings to less than twice of M a.
    assert 4e3 - 500.0 * 4.0 < found["pull"]["min"]["value"] < 4e3 - 500.0 * 2.0
    assert found["pull"]["min"]["value"] == pytest.approx(4e3 + both.min(), rel=1e-6)
    assert found["counter_pull"]["max"]["value"] == pytest.approx(4e3)
    assert found["drive_ratio"]["value"] == pytest.approx(4e3 / found["drive_tension"]["min"]["value"], rel=1e-9)
    assert found["drive_ratio"]["friction_bears"] == pytest.approx(np.exp(0.3 * np.pi))


def test_two_carriages_over_a_pulley_feel_the_tension_of_their_counter_rope() -> None:
    """Accelerated as two weights on a slope, and drawn by the tension of the weight beside that."""
    lines = {"rope": TRACK, "other": {**TRACK, "start": [0.0, 4.0], "end": [60.0, 24.0]}}
    car = {"kind": "carriage", "on": "rope", "mass": 300.0, "rockers": [0.8], "travel": {"kind": "free", "from": 30.0},
           "haul": {"axial_stiffness": 2e7, "over_to": "back", "counter": {"tension": 1e3}}}  # fmt: skip
    back = {**car, "on": "other", "mass": 200.0, "haul": None}
    asked = {"kind": "dynamic", "until": 1.0, "every": 0.02, "start": {"with_loads": True}}
    result = simulate(Scenario.model_validate({"lines": lines, "loads": {"car": car, "back": back}, "run": asked}))
    pull = np.linalg.norm(result.hold_force.values[:, :2].sum(axis=1), axis=1)
    weights = 2.0 * 300.0 * 200.0 / 500.0 * G * np.sin(np.arctan(1.0 / 3.0))
    assert pull[10:].mean() == pytest.approx(weights, rel=0.01)  # both ropes together
    found = summary(result)["carriages"]["car"]["drive_tension"]
    assert found["min"]["value"] + found["max"]["value"] == pytest.approx(2.0 * (weights + 1e3), rel=0.05)


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"mass": 0.0}, "does not sag"),
    ({"counter": None, "sheave": {"friction": 0.2, "wrap": 3.0}}, "the tension on its other side is not given"),
    ({"counter": {"tension": 2e3, "mass": 5.0}}, "less than the weight of the rope"),
    ({"speed": None, "over_to": "car"}, "does not hang freely here"),
    ({"mass": 0.0, "sags": False, "elements": 8}, "a rope without mass has none that move with it"),
    ({"counter": {"tension": 3e3, "axial_stiffness": 1e6}}, "a counter rope without mass has no mass to accelerate"),
]


@pytest.mark.parametrize(("change", "message"), WRONG)
def test_ropes_that_cannot_be_are_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        run(TRACK, HAUL | change, 0.1)


def test_a_rope_that_cannot_hold_its_carriage_says_so() -> None:
    down = {**TRACK, "start": [0.0, 20.0], "end": [60.0, 0.0]}
    with pytest.raises(EquilibriumError, match="cannot hold it where it begins"):
        run(down, {**HAUL, "counter": None}, 0.1)
