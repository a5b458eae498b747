"""Hauling ropes whose mass moves, that sag from tower to tower, and slip on the sheave of their drive."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import brentq

from ropewalk.model import Scenario
from ropewalk.results.statistics import summary
from ropewalk.simulate import simulate
from ropewalk.theory.rope import elastic_catenary

G = 9.81
M = 500.0  # kg
TRACK = {
    "start": [0.0, 0.0], "end": [60.0, 20.0], "tension": "2 MN", "mass": 20.0, "axial_stiffness": "200 MN",
    "elements": 12,
}  # fmt: skip
LEVEL = {**TRACK, "end": [60.0, 0.0]}
JERK = {"time": [0.0, 0.1, 0.2], "value": [0.0, 0.2, 0.0]}  # 2 cm are taken in


def run(line: dict[str, Any], haul: dict[str, Any], until: float, start: float = 30.0) -> xr.Dataset:
    car = {"kind": "carriage", "on": "rope", "mass": M, "rockers": [0.8], "haul": haul,
           "travel": {"kind": "free", "from": start}}  # fmt: skip
    asked = {"kind": "dynamic", "until": until, "every": 0.02, "start": {"with_loads": True}}
    result = simulate(Scenario.model_validate({"lines": {"rope": line}, "loads": {"car": car}, "run": asked}))
    assert result.attrs["outcome"] == "completed", result.attrs["doubts"]
    return result


def tensions(result: xr.Dataset, end: str) -> np.ndarray:
    return np.asarray(result.haul_tension.sel(rope_end=end).values[:, 0])


def frequency(result: xr.Dataset, way: np.ndarray) -> float:
    """Angular frequency of the carriage along a way, after the jerk."""
    time, s = result.time.values, result.contact_position.values.mean(axis=1) @ way
    late = time > 0.3
    time, s = time[late], s[late] - 0.5 * (s[late].max() + s[late].min())
    up = np.flatnonzero((s[:-1] < 0.0) & (s[1:] >= 0.0))
    at = time[up] - s[up] * 0.02 / (s[up + 1] - s[up])
    return float(2.0 * np.pi * (at.size - 1) / (at[-1] - at[0]))


def test_the_drive_bears_the_weight_of_the_rope_by_its_height() -> None:
    result = run(TRACK, {"axial_stiffness": 2e7, "speed": 0.0, "mass": 5.0}, 0.1)
    rise = 20.0 - result.contact_position.values[:, :, 1].mean(axis=1)
    assert tensions(result, "drive") - tensions(result, "carriage") == pytest.approx(5.0 * G * rise, rel=1e-3)


def test_the_drive_accelerates_the_rope_and_the_carriage_its_counter_rope() -> None:
    """T_drive - T_carriage = m l a with the length l that is left, and the counter rope pulls with T + m' l' a."""
    a = 2.0
    haul = {"axial_stiffness": 2e7, "axial_damping": 2e5, "mass": 5.0, "counter": {"tension": 6e3, "mass": 3.0},
            "speed": {"time": [0.0, 3.0], "value": [0.0, 3.0 * a]}}  # fmt: skip
    result = run(LEVEL, haul, 3.0, start=20.0)
    late = result.time.values > 1.5
    place = result.contact_position.values[late, :, 0].mean(axis=1)
    near = 60.0 - place
    back = tensions(result, "counter")[late]
    # It sways about what it bears by 1 %; means over some periods.
    assert np.mean(back - 6e3) == pytest.approx(3.0 * np.mean(place) * a, rel=0.02)
    assert np.mean(tensions(result, "carriage")[late] - back) == pytest.approx(M * a, rel=0.02)
    added = tensions(result, "drive")[late] - tensions(result, "carriage")[late]
    assert np.mean(added) == pytest.approx(5.0 * np.mean(near) * a, rel=0.02)
    first, last = added[: added.size // 2], added[added.size // 2 :]
    ratio = np.mean(near[: added.size // 2]) / np.mean(near[added.size // 2 :])
    assert np.mean(first) / np.mean(last) == pytest.approx(ratio, rel=0.03)  # as it gets shorter
    assert abs(summary(result)["energy"]["largest_imbalance"]["value"]) < 5.0  # J, of 9 kJ


def test_a_carriage_swings_on_a_rope_of_its_own_mass_as_waves_say() -> None:
    """x tan x = m l/M, x = omega l/c, of a bar with a mass at its end (Rayleigh, Theory of Sound, 1894, art. 151).

    About sqrt(k/(M + m l/3)); with few masses as of these by hand.
    """
    EA, mass, length = 2e6, 16.0, 30.0
    x = brentq(lambda x: x * np.tan(x) - mass * length / M, 1e-3, 0.5 * np.pi - 1e-9)
    exact = x / length * np.sqrt(EA / mass)
    assert exact == pytest.approx(np.sqrt(EA / length / (M + mass * length / 3.0)), rel=0.02)
    found = []
    for elements in (1, 2, 8):
        haul = {"axial_stiffness": EA, "mass": mass, "elements": elements, "speed": JERK,
                "counter": {"tension": 2e4}}  # fmt: skip
        result = run(LEVEL, haul, 6.0)
        found.append(frequency(result, np.array([1.0, 0.0])))
        assert abs(summary(result)["energy"]["largest_imbalance"]["value"]) < 0.05  # J
    # By the mean strain of 1 %, and because the track gives way: without mass it is 1.0 % more, too.
    assert found[2] == pytest.approx(exact, rel=0.015)
    by_hand = [np.sqrt(_least(n, EA, mass, length)) for n in (1, 2, 8)]
    assert by_hand[2] == pytest.approx(exact, rel=1e-3)
    for i in (0, 1):  # zeros are seen every 20 ms
        assert found[i] / found[2] == pytest.approx(by_hand[i] / by_hand[2], rel=2e-3)


def _least(n: int, EA: float, mass: float, length: float) -> float:
    """Square of the lowest frequency of a carriage on n masses, 1/s^2."""
    k = n * EA / length * np.array([2.0, *np.ones(n - 1), 2.0])
    K = np.diag([*(k[:-1] + k[1:]), k[-1]]) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
    M_inverse = np.diag([*np.full(n, n / (mass * length)), 1.0 / M])
    return float(np.linalg.eigvals(M_inverse @ K).real.min())


def test_a_rope_swings_on_without_loss() -> None:
    haul = {"axial_stiffness": 2e6, "mass": 5.0, "speed": JERK, "counter": {"tension": 2e4, "mass": 2.0}}
    result = run(LEVEL, haul, 12.0)
    s, time = result.contact_position.values[:, :, 0].mean(axis=1), result.time.values
    early, late = (np.ptp(s[(time > a) & (time < a + 2.0)]) for a in (1.0, 10.0))
    assert late == pytest.approx(early, rel=0.01)


def test_a_rope_that_sags_from_tower_to_tower_is_as_soft_as_catenaries_over_rollers() -> None:
    """Rollers without friction: T + T^2/(2 EA) - w z is the same on both sides, and the spans share one length."""
    line = {**TRACK, "supports": {"low": {"kind": "fixed", "at": "10 m"}, "high": {"kind": "fixed", "at": "45 m"}}}
    EA, m = 4e6, 5.0
    haul = {"axial_stiffness": EA, "mass": m, "sags": True, "speed": JERK, "counter": {"tension": 1500.0}}
    result = run(line, haul, 6.0)
    length = float(np.hypot(60.0, 20.0))
    way = np.array([60.0, 20.0]) / length
    late = result.time.values > 0.3
    middle = result.contact_position.values[late].mean(axis=(0, 1))
    w = m * G

    def unstrained(T: float, place: np.ndarray) -> float:
        """Length of all spans from the carriage on, where the rope pulls along the track with T there, N."""
        total, ends, rest = 0.0, [place, 45.0 * way, length * way], T
        for a, b in pairwise(ends):
            span, up = b - a

            def rope(own: float, span: float = span, up: float = up) -> Any:
                return elastic_catenary(span=span, height=up, length=own, weight=w, axial_stiffness=EA)

            chord = float(np.hypot(span, up))
            own = brentq(lambda L, rest=rest: rope(L).force[0] @ way - rest, 0.95 * chord, 1.05 * chord, xtol=1e-12)
            total += own
            # of shallow ropes: the pull along the chord gains the weight of the rope by its height
            rest += w * up
        return total

    T = float(np.mean(np.sqrt(tensions(result, "carriage")[late] ** 2 - (0.5 * w * (45.0 * way - middle)[0]) ** 2)))
    rope = unstrained(T, middle)

    def pull(ds: float) -> float:
        return brentq(lambda T: unstrained(T, middle + ds * way) - rope, 0.8 * T, 1.3 * T, xtol=1e-9)

    stiffness = (pull(-0.005) - pull(0.005)) / 0.01
    straight = EA / (length - float(middle @ way))
    assert stiffness < 0.8 * straight  # it sags indeed
    # A third of the rope swings along; sag in 1 % of the spans; the track gives way below the wheels.
    mass = M + m * (length - float(middle @ way)) / 3.0
    assert frequency(result, way) == pytest.approx(np.sqrt(stiffness / mass), rel=0.02)
    # Half of the span ahead weighs on the carriage, across the track.
    pressed = -result.contact_force.values[0].sum(axis=0) @ np.array([-way[1], way[0]])
    own = 0.5 * w * 45.0 * way[0] * (1.0 - 30.0 / 45.0) / way[0]
    assert pressed == pytest.approx((M * G + own) * way[0], rel=5e-3)


@pytest.mark.parametrize("mass", [0.0, 0.5])
def test_a_drive_slips_at_the_ratio_of_euler_and_eytelwein(mass: float) -> None:
    """The sheave bears T e^(friction wrap), and what the slope asks for beyond lets the carriage go."""
    T = 2e3
    haul = {"axial_stiffness": 2e6, "speed": 0.0, "mass": mass, "counter": {"tension": T},
            "sheave": {"friction": 0.1, "wrap": np.pi}}  # fmt: skip
    result = run(TRACK, haul, 1.0)
    assert "slips on the sheave of its drive at t = 0.02 s" in result.attrs["warnings"]
    bears = T * np.exp(0.1 * np.pi)
    late = result.time.values > 0.3
    assert np.mean(tensions(result, "drive")[late]) == pytest.approx(bears, rel=2e-3)
    sine, rise = np.sin(np.arctan(1.0 / 3.0)), 10.0
    rope = mass * np.hypot(30.0, 10.0)
    a = (M * G * sine + mass * G * rise - (bears - T)) / (M + rope)
    speed = np.gradient(result.contact_position.values.mean(axis=1) @ np.array([3.0, 1.0]) / np.sqrt(10.0), 0.02)
    fall = np.polyfit(result.time.values[late], speed[late], 1)[0]
    assert fall == pytest.approx(-a, rel=0.02)
    way = np.linalg.norm(np.diff(result.contact_position.values.mean(axis=1)[[0, -1]], axis=0))
    # Beside what goes, the rope is eased: it is stretched by less than before.
    eased = 30.0 * (1.0 + 1.0 / 9.0) ** 0.5 * (T + M * G * sine - bears) / 2e6
    assert result.haul_slip.values[-1, 0] == pytest.approx(way + eased, rel=0.03)
    found = summary(result)["carriages"]["car"]
    assert found["drive_ratio"]["friction_bears"] == pytest.approx(np.exp(0.1 * np.pi))
    assert found["slip"]["max"]["value"] == result.haul_slip.values[-1, 0]


def test_a_rope_that_sags_deeply_is_doubted() -> None:
    car = {"kind": "carriage", "on": "rope", "mass": 50.0, "rockers": [0.8], "travel": {"kind": "free", "from": 10.0},
           "haul": {"axial_stiffness": 2e6, "speed": 0.0, "mass": 5.0, "sags": True}}  # fmt: skip
    asked = {"kind": "dynamic", "until": 0.02, "every": 0.02, "start": {"with_loads": True}}
    result = simulate(Scenario.model_validate({"lines": {"rope": TRACK}, "loads": {"car": car}, "run": asked}))
    assert "between two rollers" in result.attrs["doubts"]
