"""What travels does on joined lines, and on lines in calm air, what it does on a rope by itself.

Sources: the engine of ropes, which meets loads otherwise (`solve/`, `mechanics/moving_mass.py`); the beam with a spring
below its middle; conservation of energy.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.capabilities import ROPES, SYSTEM, engine_of
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

ROPE = {"start": [0, 0], "end": [20, 1], "length": 20.2, "mass": 1.0, "axial_stiffness": 1e5}
TRAVEL = {"from": 4.0, "speed": 6.0, "at_end": "leave"}
LOADS: dict[str, dict[str, Any]] = {
    "mass in air": {"kind": "mass", "mass": 30.0, "air_drag": 0.5, "travel": TRAVEL},
    "oscillator": {"kind": "oscillator", "mass": 30.0, "wheel_mass": 2.0, "stiffness": 5e3, "damping": 50.0,
                   "travel": TRAVEL},
    "trolley": {
        "kind": "trolley", "mass": 10.0, "travel": TRAVEL,
        "payload": {"mass": 20.0, "length": 2.0, "stiffness": 2e4, "damping": 20.0, "swing": 0.3, "air_drag": 0.2},
    },
    "vehicle": {
        "kind": "vehicle", "travel": TRAVEL,
        "bodies": {"car": {"mass": 30.0, "inertia": 10.0}},
        "wheels": {"front": {"at": 0.75, "mass": 1.0}, "rear": {"at": -0.75, "mass": 1.0}},
        "springs": {"a": {"between": ["car", "front"], "stiffness": 3e3, "damping": 50.0},
                    "b": {"between": ["car", "rear"], "stiffness": 3e3, "damping": 50.0}},
    },
}  # fmt: skip


def run(load: dict[str, Any], lines: dict[str, Any], until: float = 0.6, **more: Any) -> xr.Dataset:
    loads = {"load": load | {"on": "rope"}}
    asked = {"kind": "dynamic", "until": until, "every": 0.02, "method": "verlet"}
    scenario = Scenario.model_validate({"lines": lines, "loads": loads, "run": asked, **more})
    assert engine_of(scenario) is (SYSTEM if more else ROPES)
    result = simulate(scenario)
    assert result.attrs["outcome"] == "completed", result.attrs["doubts"] or result.attrs["advice"]
    return result


def in_two_ways(load: dict[str, Any], elements: int) -> list[xr.Dataset]:
    """On a rope by itself, and on one in calm air that it hardly feels."""
    rope = ROPE | {"elements": elements, "axial_damping": 2e3}
    calm = {"wind": {"direction": [1, 0], "speed": 0.0}}
    return [run(load, {"rope": rope}), run(load, {"rope": rope | {"wind_drag": 1e-9}}, **calm)]


@pytest.mark.parametrize("load", LOADS)
def test_a_line_in_calm_air_bears_it_as_a_rope_does(load: str) -> None:
    away = []
    for elements in (40, 80):
        rope, calm = in_two_ways(LOADS[load], elements)
        assert np.abs(calm.energy.sel(form="imbalance").values).max() < 0.05  # J, of some kJ; of ropes up to 2 J
        away.append(float(np.nanmax(np.abs(calm.contact_position.values - rope.contact_position.values))))
        if rope.sizes["body"]:
            assert np.abs(calm.body_position.values - rope.body_position.values).max() < 2.5 * away[-1] + 1e-3
    print(load, away)
    assert away[1] < 0.012  # m: the blow with which it is set down spreads over links
    assert away[1] < max(0.85 * away[0], 1e-3)  # below that, neither bends where the other does


def test_a_vehicle_leaves_a_joined_line_wheel_by_wheel() -> None:
    """Wheels of a vehicle leave one after the other; what it has of energy then stays with it."""
    travel = {"from": 0.8, "speed": 12.0, "at_end": "leave"}
    joined = {"kind": "joined", "to": "knot"}
    lines = {
        "rope": ROPE | {"length": None, "tension": 2e3, "end": [10, 0], "end_support": joined, "elements": 40},
        "far": ROPE | {"length": None, "tension": 2e3, "start": [10, 0], "end": [20, 0], "start_support": joined,
                       "elements": 40},
    }  # fmt: skip
    result = run(LOADS["vehicle"] | {"travel": travel}, lines, 1.4, joints={"knot": {}})
    on = np.isfinite(result.contact_xi.values)
    t = result.time.values
    for k, ahead in enumerate((0.75, -0.75)):
        expected = (t * 12.0 + 0.8 + ahead >= 0.0) & (t * 12.0 + 0.8 + ahead <= 10.0)
        assert (on[:, k] != expected).sum() <= 2  # the frames at its ends, and its margin
    energy = result.energy
    assert not on[-1].any()
    moved = np.abs(energy.sel(form="hold_work").values).max()
    assert np.abs(energy.sel(form="imbalance").values).max() < 5e-3 * moved
    for form in ("load_kinetic", "load_potential"):
        assert np.ptp(energy.sel(form=form).values[~on.any(axis=1) & (t > 1.0)]) == 0.0


def test_a_load_stays_at_the_end_of_a_joined_line() -> None:
    travel = {"from": 15.0, "speed": 6.0, "at_end": "stay"}
    calm = {"wind": {"direction": [1, 0], "speed": 0.0}}
    rope = ROPE | {"wind_drag": 1e-9, "elements": 40}
    result = run({"kind": "mass", "mass": 30.0, "travel": travel}, {"rope": rope}, 1.2, **calm)
    place = result.contact_xi.values[:, 0]
    assert place[-1] == pytest.approx(20.2 - 0.25 * 20.2 / 40)
    assert result.contact_speed.values[-1, 0] == 0.0
    turned = np.abs(result.energy.sel(form="load_work").values).max() + 30.0 * 6.0**2
    assert np.abs(result.energy.sel(form="imbalance").values).max() < 1e-2 * turned


@pytest.mark.parametrize("elements", [8, 16])
def test_a_beam_goes_on_where_a_hanger_holds_it(elements: int) -> None:
    """5 w L^4/(384 EI) less the hanger's R L^3/(48 EI), with R/k in it; cut there it would be two beams on a hinge."""
    L, EI, w, k = 4.0, 1e3, 9.81, 2e3
    beam = {"start": [0, 0], "end": [L, 0], "length": L, "mass": 1.0, "axial_stiffness": 1e6, "elements": elements,
            "bending_stiffness": EI}  # fmt: skip
    hanger = {"start": [L / 2, 3], "end": [L / 2, 0], "length": 3.0, "mass": 1e-6, "axial_stiffness": 3.0 * k,
              "elements": 2, "end_support": {"kind": "joined", "to": "rope", "at": L / 2}}  # fmt: skip
    load = {"kind": "force", "force": [0, -1.0], "travel": {"speed": 0.0, "from": 0.3}}
    result = run(load, {"rope": beam, "hanger": hanger}, 0.02, joints={})
    own, give = 5.0 * w * L**4 / (384.0 * EI), L**3 / (48.0 * EI)
    exact = own / (1.0 + give * k)
    middle = -float(result.position.values[0, elements // 2, 1])
    print(elements, middle / exact - 1.0)
    # Beside the hanger, whose force is a step of the shear force, to the second order; shortening by bowing, 1e-5.
    assert middle == pytest.approx(exact, rel=3e-2 * (8 / elements) ** 2 + 1e-4)
