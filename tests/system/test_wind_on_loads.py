"""Wind on loads: drag k |u| u by the velocity u of the air as they see it, against closed forms.

Along a level rope without gravity m v' = k (W - v)^2 from rest is v = W k W t / (m + k W t) (separation of variables);
at rest in a side wind a payload hangs by atan(k W^2 / (m g)).
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from ropewalk.model import Scenario
from ropewalk.results.statistics import summary
from ropewalk.simulate import simulate
from ropewalk.system.elements.structure import IN_BODIES, LOADED, WORKS
from ropewalk.system.loads import bodies as kernels

M, K, W = 80.0, 4.0, 10.0  # kg, kg/m, m/s
ROPE = {"start": [0, 0], "end": [60, 0], "tension": 20e3, "mass": 0.5, "axial_stiffness": 1e7, "elements": 12}


def test_a_wind_takes_a_mass_along_and_does_the_work_that_it_gets_and_loses() -> None:
    load = {"kind": "mass", "on": "rope", "mass": M, "air_drag": K, "travel": {"kind": "free", "from": 5.0}}
    run = {"kind": "dynamic", "until": 2.0, "every": 0.1}
    wind = {"direction": [1, 0], "speed": W}
    scenario = {"gravity": 0.01, "lines": {"rope": ROPE}, "loads": {"m": load}, "wind": wind, "run": run}
    result = simulate(Scenario.model_validate(scenario))
    assert result.attrs["outcome"] == "completed"
    t, x = result.time.to_numpy(), result.contact_position.to_numpy()[:, 0, 0]
    # The rope is stretched by the force on it, at first 400 N: 1 mm. Verlet's method takes the drag of each step by the
    # speed before it, first order.
    assert x - x[0] == pytest.approx(W * t - M / K * np.log1p(K * W * t / M), abs=5e-3)
    v = W * K * W * t[-1] / (M + K * W * t[-1])
    energy = summary(result)["energy"]
    assert energy["final"]["load_work"] == pytest.approx(M * v * W, rel=2e-3)
    assert energy["final"]["load_damping"] == pytest.approx(M * v * (W - 0.5 * v), rel=2e-3)
    assert abs(energy["largest_imbalance"]["value"]) < 1e-4 * M * v * W


def test_the_implicit_method_feels_the_wind_as_steps_of_the_second_order_do() -> None:
    load = {
        "kind": "oscillator",
        "on": "rope",
        "mass": M,
        "stiffness": 2e4,
        "air_drag": K,
        "travel": {"speed": 0.0, "from": 30.0},
    }
    paths = []
    for method, step in (("verlet", 1e-4), ("rkn6", 2e-3)):
        run = {"kind": "dynamic", "until": 0.5, "every": 0.05, "method": method, "step": step}
        scenario = {
            "lines": {"rope": ROPE},
            "loads": {"m": load},
            "wind": {"direction": [0, 1], "speed": W},
            "run": run,
        }
        result = simulate(Scenario.model_validate(scenario))
        energy = summary(result)["energy"]
        assert abs(energy["largest_imbalance"]["value"]) < 1e-3 * energy["turnover"]
        assert energy["final"]["load_work"] != 0.0
        paths.append(result.body_position.values[:, 0, -1])
    assert paths[1] == pytest.approx(paths[0], abs=2e-3 * float(np.ptp(paths[0])))


def test_what_the_air_does_in_a_step_is_booked_to_the_last_digit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps from rest in a wind that blows aslant; the kernel as plain Python."""
    for name in ("look_up", "_push_by_wind"):
        function = getattr(kernels, name)
        monkeypatch.setattr(kernels, name, getattr(function, "py_func", function))
    direction, h, steps = np.array([0.6, 0.8]), 1e-3, 2000
    wind = SimpleNamespace(time=np.zeros(1), speed=np.array([W]), direction=direction)
    blown = np.array([(2, K)], dtype=kernels.BLOWN).view(np.recarray)
    bodies = SimpleNamespace(
        blown=blown, gone=np.array([kernels.STAYS]), load=np.zeros(4, np.int64), per_mass=np.full(4, 1.0 / M)
    )
    state: Any = SimpleNamespace(t=np.zeros(1), r=np.zeros((2, 3)), w=np.zeros(4), work=np.zeros(WORKS))
    for _ in range(steps):
        kernels._push_by_wind(wind, bodies, state, h)
    v = W * K * W * h * steps / (M + K * W * h * steps)
    assert state.w == pytest.approx([0.0, 0.0, *(v * direction)], rel=1e-3)  # first order
    stored = 0.5 * M * float(state.w @ state.w)
    assert state.work[LOADED] == pytest.approx(M * W * float(state.w[2:] @ direction), rel=1e-12)
    assert state.work[IN_BODIES] == pytest.approx(state.work[LOADED] - stored, rel=1e-12)


def test_a_payload_hangs_aside_in_a_side_wind() -> None:
    line = {**ROPE, "start": [0, 0, 0], "end": [60, 0, 0], "wind_drag": 1e-30}
    payload = {"mass": 50.0, "length": 4.0, "stiffness": 1e6, "air_drag": 0.6}
    load = {"kind": "trolley", "on": "rope", "mass": 1e3, "payload": payload, "travel": {"speed": 0.0, "from": 30.0}}
    scenario = {"lines": {"rope": line}, "loads": {"m": load}, "wind": {"direction": [0, 1, 0], "speed": 20.0}}
    result = simulate(Scenario.model_validate({**scenario, "run": {"kind": "equilibrium"}}))
    away = result.body_position.values[0, 0] - result.contact_position.values[0, 0]
    assert away[1] / -away[2] == pytest.approx(0.6 * 20.0**2 / (50.0 * 9.81), rel=1e-6)
    assert away[0] == pytest.approx(0.0, abs=1e-6)


def test_wind_that_nothing_feels_is_refused_and_a_load_is_enough() -> None:
    load: dict[str, Any] = {"kind": "mass", "on": "rope", "mass": M, "travel": {"speed": 1.0}}
    run = {"kind": "dynamic", "until": 1.0}
    tree = {"lines": {"rope": ROPE}, "wind": {"direction": [1, 0], "speed": W}, "run": run}
    with pytest.raises(ValidationError, match=r"wind acts on nothing.*wind_drag.*or a load air_drag"):
        Scenario.model_validate({**tree, "loads": {"m": load}})
    Scenario.model_validate({**tree, "loads": {"m": {**load, "air_drag": K}}})
