"""A vehicle in Exudyn against our own of the same data on a rope, and its eigenfrequencies on rigid ground."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ropewalk.errors import RopewalkError
from ropewalk.model import Vehicle
from ropewalk.scenario import load
from ropewalk.simulate import simulate

pytest.importorskip("exudyn", reason='Exudyn is not installed: pip install "ropewalk[external]"')

from exudyn_vehicle import ExudynVehicle  # of docs/external: see conftest.py

EXAMPLE = Path(__file__).parents[2] / "docs" / "external" / "exudyn-vehicle.yaml"
PLAIN = {
    "body_mass": 1000.0, "body_inertia": 1500.0, "wheel_mass": 1.0, "stiffness": 2e5, "contact_stiffness": 2e8,
    "axles": [1.5, -1.2],
}  # fmt: skip


class Rigid:
    """Ground that rises by a slope, and may be lifted."""

    length = 100.0

    def __init__(self, slope: float = 0.0) -> None:
        self.slope, self.height = slope, 0.0

    def at(self, xi: float) -> tuple[np.ndarray, np.ndarray]:
        return np.array([xi, self.height + self.slope * xi]), np.zeros(2)


def own(options: dict[str, Any]) -> Vehicle:
    """The same trolley as a load of kind vehicle."""
    places = dict(zip(("front", "rear"), options["axles"], strict=True))
    wheel = {"mass": options["wheel_mass"], "contact_stiffness": options["contact_stiffness"]}
    spring = {"stiffness": options["stiffness"], "damping": options["damping"]}
    return Vehicle.model_validate({
        "on": "rope",
        "bodies": {"body": {"mass": options["body_mass"], "inertia": options["body_inertia"]}},
        "wheels": {name: {"at": place, **wheel} for name, place in places.items()},
        "springs": {name: {"between": ["body", name], **spring} for name in places},
        "travel": {"speed": options["speed"], "from": options["start"]},
        "lift_off": True,
    })  # fmt: skip


def off(found: np.ndarray, known: np.ndarray) -> float:
    """Largest difference, of the largest known value."""
    return float(np.abs(found - known).max() / np.abs(known).max())


def test_exudyn_on_a_rope_is_our_own_vehicle_of_the_same_data(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(EXAMPLE.parent)  # its model is a file next to it
    scenario = load(EXAMPLE)
    options = scenario.loads["trolley"].options
    result = simulate(scenario)
    known = simulate(scenario.model_copy(update={"loads": {"trolley": own(options)}}))
    z = [r.position.sel(axis="z").to_numpy() for r in (result, known)]
    rope = off(z[0] - z[1][0], z[1] - z[1][0])
    force = [r.contact_force.sel(axis="z").to_numpy() for r in (result, known)]
    contact = off(*force)
    print(f"rope {rope:.2e}, contact forces {contact:.2e}")
    assert force[1].max() < -300.0  # N: nothing lifts off
    assert rope < 2e-3  # 6e-4 at 0.5 ms
    assert contact < 5e-3  # 2.4e-3


def test_it_swings_on_rigid_ground_with_its_eigenfrequencies() -> None:
    front, rear = PLAIN["axles"]
    k = PLAIN["stiffness"] / (1.0 + PLAIN["stiffness"] / PLAIN["contact_stiffness"])  # with its contact behind it
    stiffness = k * np.array([[2.0, front + rear], [front + rear, front**2 + rear**2]])
    values, shapes = np.linalg.eig(np.linalg.solve(np.diag([PLAIN["body_mass"], PLAIN["body_inertia"]]), stiffness))
    h, steps = 1e-3, 2000
    model, ground = ExudynVehicle(10.0, 0.0, **PLAIN), Rigid()
    model.reset(ground)
    rest = model.motion[0][:2]
    model.step(0.0, h, ground)
    found = []
    for n in range(1, steps + 1):
        ground.height = 0.01  # m, at once: in the mean of the first step half of it
        model.step(n * h, h, ground)
        found.append(model.motion[0][:2] - rest)
    t = h * (np.arange(1, steps + 1) - 0.5)
    parts = np.linalg.solve(shapes, [-0.01, 0.0])
    exact = np.array([0.01, 0.0]) + (shapes * parts @ np.cos(np.sqrt(values)[:, None] * t)).T
    apart = [off(np.array(found)[:, i], exact[:, i]) for i in (0, 1)]
    print(f"eigenfrequencies {np.sqrt(np.sort(values))} rad/s, rise {apart[0]:.2e}, pitch {apart[1]:.2e}")
    assert max(apart) < 5e-3  # Newmark is late by (22 rad/s * 1 ms)^2 / 24 of 44 rad: 9e-4, and the wheels have a mass


def test_it_begins_in_equilibrium_and_rolls_along_a_slope() -> None:
    slope, speed, h = 0.05, 4.0, 1e-3
    model, ground = ExudynVehicle(10.0, speed, **PLAIN), Rigid(slope)
    forces = [[touch.force[-1] for touch in model.step(n * h, h, ground)] for n in range(50)]
    front, rear = PLAIN["axles"]
    share = np.array([-rear, front]) / (front - rear) * PLAIN["body_mass"] + PLAIN["wheel_mass"]
    assert np.array(forces) == pytest.approx(np.tile(-9.81 * share, (50, 1)), rel=2e-5)  # pitch is not slope: slope^3/3
    one, two = (model.step(n * h, h, ground)[0] for n in (50, 51))
    assert two.xi - one.xi == pytest.approx(h * one.speed, rel=1e-9)
    velocity = model.motion[1]
    assert velocity[[0, 2, 3]] == pytest.approx([speed * slope] * 3, rel=1e-3)
    assert velocity[1] == pytest.approx(0.0, abs=1e-4)


def test_steps_within_an_exchange_come_to_the_same_as_short_exchanges() -> None:
    places = []
    for steps in (1, 4):
        model, ground = ExudynVehicle(10.0, 0.0, **PLAIN, steps=steps), Rigid()
        h = 1e-3 * steps
        for n in range(round(0.2 / h) + 1):
            ground.height = n * h * 0.1  # m, linear in time
            model.step(n * h, h, ground)
        places.append(model.motion[0])
    assert places[0] == pytest.approx(places[1], rel=1e-6)


def test_it_goes_back_to_a_state() -> None:
    model, ground = ExudynVehicle(10.0, 3.0, **PLAIN, damping=2e3), Rigid()
    model.reset(ground)
    ground.height = 0.01
    for n in range(5):
        model.step(n * 1e-3, 1e-3, ground)
    state, found = model.get_state(), []
    for is_back in (False, True):
        if is_back:
            model.set_state(state)
        found.append([model.step(n * 1e-3, 1e-3, ground)[0].force[-1] for n in range(5, 9)])
    assert found[0] == pytest.approx(found[1], rel=1e-10)  # Newton may come from elsewhere
    assert np.ptp(found[0]) > 10.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"axles": [1.0, 2.0]}, "axles must be two, one on either side of the centre"),
        ({"axles": [1.0]}, "axles must be two"),
        ({"stiffness": 0.0}, "stiffness must be positive, given 0"),
    ],
)
def test_numbers_that_do_not_fit_are_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(RopewalkError, match=message):
        ExudynVehicle(10.0, 0.0, **{**PLAIN, **changes})


def test_a_solver_that_gives_up_is_an_error() -> None:
    model, ground = ExudynVehicle(10.0, 0.0, **PLAIN), Rigid()
    model.reset(ground)
    ground.height = math.nan
    with pytest.raises(RopewalkError):
        model.step(1e-3, 1e-3, ground)
