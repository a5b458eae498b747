"""Inextensible lines by implicit methods: orders of equations of index 3, and the same motion by explicit steps.

Source: Hairer, Lubich & Roche, The Numerical Solution of Differential-Algebraic Systems by Runge-Kutta Methods (1989),
table 2.3 and section 6: places of Radau IIA of s stages are of the order 2 s - 1, those of Lobatto IIIC of 2 s - 2.
Explicit steps (SHAKE) are another route: they find tensions after each drift, and know no velocities of constraints.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ropewalk.checkpoint import copied
from ropewalk.model import Scenario
from ropewalk.results.frame import ENERGY_FORMS, RunInfo
from ropewalk.results.running import TimeHistory
from ropewalk.system.dynamics.moving import SystemMotion

UNTIL = 0.4
IMBALANCE = ENERGY_FORMS.index("imbalance")
STANDS = {"kind": "mass", "mass": 5.0, "travel": {"speed": 0.0, "from": 4.0}}
GOES = {"kind": "mass", "mass": 5.0, "travel": {"speed": 5.0, "from": 2.0}}
ORDERS = {"implicit": 5.0, "rkn6": 6.0}


def rope(load: dict[str, Any] | None, run: dict[str, Any], **line: Any) -> Scenario:
    own = {"start": [0, 0], "end": [10, 0], "length": 11.0, "mass": 1.0, "elements": 12}
    own |= {"law": {"kind": "inextensible"}}
    loads = {"load": {"on": "rope", **load}} if load else {}
    asked = {"kind": "dynamic", "until": UNTIL, "every": UNTIL, **run}
    return Scenario.model_validate({"lines": {"rope": own | line}, "loads": loads, "run": asked})


def end_of(load: dict[str, Any] | None, method: str, steps: int, **keys: Any) -> Any:
    """The last frame of a motion in so many steps, however accurate they are."""
    run = {"method": method, "step": UNTIL / steps * (1 + 1e-9), **keys.pop("run", {})}
    run |= {} if method == "verlet" else {"accuracy": 1.0}
    run_info = RunInfo()
    motion = SystemMotion(rope(load, run, **keys), run_info, np.array([0.0, UNTIL]))
    found = TimeHistory(motion, run_info).last()
    assert run_info.outcome in ("running", "completed")
    return found


def away(one: Any, other: Any) -> np.ndarray:
    """How far places, velocities and tensions of two frames differ."""
    seen = ("position", "velocity", "tension")
    return np.array([np.abs(getattr(one, key) - getattr(other, key)).max() for key in seen])


@pytest.mark.parametrize("method", ORDERS)
@pytest.mark.parametrize("case", ["swings", "under a mass"])
def test_hairer_lubich_roche_1989_orders_of_places_velocities_and_tensions(case: str, method: str) -> None:
    """Velocities and tensions have the order of places, by what is done at the end of each step."""
    load = None if case == "swings" else STANDS
    more = {"run": {"start": {"kind": "mode", "amplitude": 0.3}}} if load is None else {}
    exact = end_of(load, "implicit", 96, **more)
    coarse, fine = (away(end_of(load, method, steps, **more), exact) for steps in (8, 16))
    orders = np.log2(coarse / fine)
    print("errors", fine, "orders", orders)
    assert (np.abs(orders[:2] - ORDERS[method]) < 0.5).all()
    assert orders[2] > ORDERS[method] - 0.5


@pytest.mark.parametrize("case", ["swings", "under a mass", "as a mass goes along"])
def test_it_is_the_motion_of_explicit_steps(case: str) -> None:
    """Verlet's steps of 1e-4 s miss 2e-8 m; what goes along passes links whose kinks are once differentiable."""
    load = {"swings": None, "under a mass": STANDS, "as a mass goes along": GOES}[case]
    more = {"run": {"start": {"kind": "mode", "amplitude": 0.3}}} if load is None else {}
    here, there = end_of(load, "implicit", 32, **more), end_of(load, "verlet", 4096, **more)
    missed = away(here, there)
    print(missed, here.energy[IMBALANCE], there.energy[IMBALANCE])
    if load is GOES:
        assert (missed[:2] < (3e-6, 1e-4)).all()
        assert missed[2] < 0.06 * float(np.abs(there.tension).max())  # kinks are tabled: their second change is rough
    else:
        assert (missed < (2e-7, 3e-6, 2e-2)).all()
    assert abs(float(here.energy[IMBALANCE])) < (2e-2 if load is GOES else 1e-5)  # J, of some 100 J


def test_lengths_and_their_rates_are_kept() -> None:
    load = {"kind": "oscillator", "mass": 5.0, "stiffness": 2e3, "damping": 20.0, "travel": {"speed": 5.0, "from": 2.0}}
    end = {"end_support": {"kind": "elastic", "stiffness": 1e4, "damping": 50.0, "mass": 5.0}}
    here, there = end_of(load, "implicit", 32, **end), end_of(load, "verlet", 8192, **end)
    assert np.abs(here.strain).max() < 1e-10
    assert (away(here, there)[:2] < (2e-5, 2e-3)).all()


@pytest.mark.parametrize("method", ORDERS)
def test_a_support_whose_speed_jumps_is_refused(method: str) -> None:
    """Between two entries of a table it moves evenly; at each of them all of the line would be struck."""
    way = {"time": [0.0, 0.2, 0.4], "value": [[0.0, 0.0], [-0.3, 0.0], [0.0, 0.0]]}
    end = {"end_support": {"kind": "moving", "displacement": way}}
    with pytest.raises(ValueError, match=f"{method} with a support that moves an inextensible line is not implemented"):
        rope(None, {"method": method}, **end)


def test_a_rope_that_stretches_may_be_joined_to_one_that_does_not() -> None:
    hanger = {"start": [5.5, 5], "end": [5.5, 0], "length": 6.2, "mass": 1.0, "elements": 6, "axial_stiffness": 1e4}
    found = []
    for method, steps in (("implicit", 64), ("verlet", 8192)):
        asked = rope(STANDS, {"method": method, "step": UNTIL / steps} | ({"accuracy": 1.0} if steps == 64 else {}))
        tree = asked.model_dump(mode="json", exclude_unset=True)
        tree["lines"]["hanger"] = {**hanger, "end_support": {"kind": "joined", "to": "rope", "at": 5.5}}
        run_info = RunInfo()
        motion = SystemMotion(Scenario.model_validate(tree), run_info, np.array([0.0, UNTIL]))
        found.append(TimeHistory(motion, run_info).last())
    print(away(*found))
    assert (away(*found)[:2] < (1e-5, 1e-3)).all()


def test_a_motion_goes_on_from_its_state_to_the_bit() -> None:
    """Tensions are a part of it: the next step begins with them."""
    times, asked = np.linspace(0.0, UNTIL, 5), rope(GOES, {"method": "implicit"})
    first, second = (SystemMotion(asked, RunInfo(), times) for _ in range(2))
    for i in range(3):
        assert first.advance(i) is None
    second.set_state(copied(first.get_state()))
    for motion in (first, second):
        for i in (3, 4):
            assert motion.advance(i) is None
    for own, other in zip(first.carrier.system.state, second.carrier.system.state, strict=True):
        np.testing.assert_array_equal(own, other)
    np.testing.assert_array_equal(first.tension, second.tension)
