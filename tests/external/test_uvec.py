"""A coach of UVEC on a bridge against our own vehicle of the same data, and against the modes of the beam."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ropewalk.errors import RopewalkError
from ropewalk.model import Dynamic, Line, Matrices, Scenario, Stepper
from ropewalk.scenario import load
from ropewalk.simulate import simulate
from ropewalk.theory import beam
from ropewalk.theory.beam_vehicle import Vehicle

pytest.importorskip("UVEC", reason='UVEC is not installed: pip install "ropewalk[external]"')

from uvec_coach import UvecCoach  # of docs/external: see conftest.py

EXAMPLE = Path(__file__).parents[2] / "docs" / "external" / "uvec-on-bridge.yaml"
DATA = {
    "cart_mass": 44e3, "cart_inertia": 1.9e6, "cart_stiffness": 0.86e6, "cart_damping": 40e3,
    "bogie_mass": 5.6e3, "bogie_inertia": 7.5e3,
    "wheel_mass": 1.6e3, "wheel_stiffness": 2.4e6, "wheel_damping": 48e3,
    "bogie_distances": [-8.75, 8.75], "wheel_distances": [-1.25, 1.25],
}  # fmt: skip
CONTACT = 4e7  # N/m, rail on its pads: on the rail alone a wheelset rings beyond any step
LENGTH, MASS, STIFFNESS, DRAG = 30.0, 10e3, 52.5e9, 1.0
SPEED, START = 50.0, -10.0
EVERY = 1e-3  # s; UVEC's own error, of (wheel frequency 25 Hz * step)^2: 0.2 % of the period
UNTIL = 1.0  # the last wheel leaves


class Rigid:
    """Level ground that may be lifted."""

    length = 30.0

    def __init__(self) -> None:
        self.height = 0.0

    def at(self, xi: float) -> tuple[np.ndarray, np.ndarray]:
        return np.array([xi, self.height]), np.zeros(2)


class Watched(UvecCoach):
    """A coach that keeps what happened to it."""

    def reset(self, line: Any) -> None:
        super().reset(line)
        self.forces: list[list[float]] = []
        self.accelerations: list[np.ndarray] = []

    def step(self, t: float, h: float, line: Any) -> Any:
        touches = super().step(t, h, line)
        self.forces.append([-touch.force[-1] for touch in touches])
        self.accelerations.append(self.motion[2])
        return touches


def static_force() -> float:
    """Of a wheel, N."""
    return 9.81 * (DATA["wheel_mass"] + 0.5 * (DATA["bogie_mass"] + 0.5 * DATA["cart_mass"]))


def coach(power: float = 1.0, kind: Any = UvecCoach, **changes: Any) -> Any:
    """With a contact of the same stiffness at rest whatever its power is: G = p F^(1 - 1/p) / k."""
    G = power * static_force() ** (1.0 - 1.0 / power) / CONTACT
    return kind(**{"start": START, "speed": SPEED, "contact_coefficient": G, "contact_power": power, **DATA, **changes})


def matrices() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """M, C, K of the same coach, heights up, with the lower ends of the contact springs as last coordinates."""
    M, C, K = (np.zeros((14, 14)) for _ in range(3))

    def join(i: int, arm: float, turn: int, j: int, k: float, c: float) -> None:
        apart = np.zeros(14)
        apart[[i, turn, j]] = 1.0, -arm, -1.0
        K[:] += k * np.outer(apart, apart)
        C[:] += c * np.outer(apart, apart)

    M[0, 0], M[1, 1] = DATA["cart_mass"], DATA["cart_inertia"]
    for b, far in enumerate(DATA["bogie_distances"]):
        bogie = 2 + 4 * b
        M[bogie, bogie], M[bogie + 1, bogie + 1] = DATA["bogie_mass"], DATA["bogie_inertia"]
        join(0, far, 1, bogie, DATA["cart_stiffness"], DATA["cart_damping"])
        for w, near in enumerate(DATA["wheel_distances"]):
            wheel, contact = bogie + 2 + w, 10 + 2 * b + w
            M[wheel, wheel] = DATA["wheel_mass"]
            join(bogie, near, bogie + 1, wheel, DATA["wheel_stiffness"], DATA["wheel_damping"])
            join(wheel, 0.0, 1, contact, CONTACT, 0.0)
    return M, C, K


PLACES = np.add.outer(DATA["bogie_distances"], DATA["wheel_distances"]).ravel()


def crossing(load: Any) -> Any:
    line = Line(
        start=(0, 0), end=(LENGTH, 0), length=LENGTH, mass=MASS, bending_stiffness=STIFFNESS, axial_stiffness=1e11,
        drag=DRAG, elements=48,
    )  # fmt: skip
    run = Dynamic(until=UNTIL, every=EVERY, geometry="linearised")
    result = simulate(Scenario(lines={"bridge": line}, loads={"coach": load}, run=run, gravity=0.0))
    assert result.attrs["outcome"] == "completed", result.attrs["advice"]
    return result


def on_uvec(power: float, every: float = EVERY) -> tuple[Any, Watched]:
    model = coach(power, Watched)
    stepper = Stepper.model_validate({"on": "bridge", "model": model, "every": every, "exchange": {"order": 1}})
    return crossing(stepper), model


def own() -> Matrices:
    M, C, K = matrices()
    weight = 9.81 * np.diag(M) * [1, 0, 1, 0, 1, 1, 1, 0, 1, 1, 0, 0, 0, 0]
    return Matrices.model_validate({
        "on": "bridge", "coordinates": [f"q{i}" for i in range(14)],
        "mass": M.tolist(), "damping": C.tolist(), "stiffness": K.tolist(), "weight": weight.tolist(),
        "wheels": {
            f"wheel{i}": {"at": place - PLACES.max(), "coordinate": f"q{10 + i}"} for i, place in enumerate(PLACES)
        },
        "travel": {"speed": SPEED, "at_end": "leave"},
    })  # fmt: skip


@pytest.fixture(scope="module")
def linear() -> tuple[Any, Watched]:
    return on_uvec(1.0)


@pytest.fixture(scope="module")
def monolithic() -> Any:
    return crossing(own())


@pytest.fixture(scope="module")
def modal() -> Any:
    M, C, K = matrices()
    axles = PLACES.max() - PLACES
    t = np.arange(0.0, UNTIL + 1e-9, EVERY)
    return beam.moving_vehicle(
        t, vehicle=Vehicle(M, C, K, axles, np.full(4, static_force())), speed=SPEED, length=LENGTH,
        bending_stiffness=STIFFNESS, mass=MASS, damping=DRAG * MASS, modes=20, tolerance=1e-3,
    )  # fmt: skip


def middle(result: Any) -> np.ndarray:
    z = result.position.sel(axis="z").to_numpy()
    return z[:, z.shape[1] // 2] - z[0, z.shape[1] // 2]


def off(found: np.ndarray, known: np.ndarray) -> float:
    """Largest difference, of the largest known value."""
    return float(np.abs(found - known).max() / np.abs(known).max())


def test_uvec_on_a_bridge_is_our_own_vehicle_of_the_same_data(linear: Any, monolithic: Any) -> None:
    result, _ = linear
    deflection = off(middle(result), middle(monolithic))
    force, known = (-r.contact_force.sel(axis="z").to_numpy() for r in (result, monolithic))
    both = np.isfinite(force) & np.isfinite(known) & (force != 0.0) & (known != 0.0)
    dynamic = off((force - static_force())[both], (known - static_force())[both])
    print(f"deflection {deflection:.2e}, dynamic part of the contact forces {dynamic:.2e}")
    assert both.mean() > 0.4
    assert deflection < 5e-4  # 5e-5 found, of the second order in the step
    assert dynamic < 0.01  # 0.6 %: the wheels ring at 25 Hz from where they enter, and Newmark rings a little late


def test_its_bodies_accelerate_as_the_modes_of_the_beam_say(linear: Any, modal: Any) -> None:
    result, model = linear
    assert off(middle(result), -modal.beam_deflection(0.5 * LENGTH)) < 3e-3  # 48 elements, 20 modes
    found, known = np.array(model.accelerations), -modal.body_acceleration
    for name, coordinate in {"body": 0, "pitch": 1, "rear frame": 2, "front frame": 6}.items():
        apart = off(found[:, coordinate], known[:, coordinate])
        print(f"acceleration, {name}: {apart:.2e}")
        assert apart < 0.01


def test_a_hertzian_contact_moves_bridge_and_body_as_its_tangent_does(linear: Any) -> None:
    result, model = on_uvec(1.5, EVERY)
    known, tangent = linear
    acceleration = np.array(model.accelerations)[:, 0]
    apart = off(middle(result), middle(known)), off(acceleration, np.array(tangent.accelerations)[:, 0])
    print(f"deflection {apart[0]:.2e}, acceleration of the body {apart[1]:.2e}")
    assert max(apart) < 0.01


@pytest.mark.parametrize("power", [1.0, 1.5])
def test_it_begins_in_equilibrium_and_stays_there(power: float) -> None:
    model = coach(power, start=15.0, speed=0.0)
    for n in range(20):
        touches = model.step(n * 1e-3, 1e-3, Rigid())
        assert [touch.xi for touch in touches] == list(model.places)
        assert [touch.force[-1] for touch in touches] == pytest.approx([-static_force()] * 4, rel=1e-9)  # rounding
    assert np.abs(model.motion[1]).max() < 1e-9  # m/s


def test_its_contacts_travel_as_fast_as_they_say() -> None:
    model, ground = coach(1.0, start=10.0, speed=20.0), Rigid()
    one, two = (model.step(n * 1e-3, 1e-3, ground) for n in (0, 1))
    for before, after in zip(one, two, strict=True):
        assert after.xi - before.xi == pytest.approx(1e-3 * before.speed, rel=1e-9)


def test_it_goes_back_to_a_state() -> None:
    model, ground = coach(1.5, start=15.0, speed=0.0), Rigid()
    model.reset(ground)
    for n in range(5):
        ground.height = 1e-4 * n
        model.step(n * 1e-3, 1e-3, ground)
    state, found = model.get_state(), []
    for is_back in (False, True):
        if is_back:
            model.set_state(state)
        ground.height = 4e-4
        found.append([model.step(n * 1e-3, 1e-3, ground)[0].force[-1] for n in range(5, 9)])
    assert found[0] == found[1]
    assert np.ptp(found[0]) > 10.0  # N: something happens


def test_rail_joints_and_random_rails_are_those_of_uvec() -> None:
    from UVEC.uvec_ten_dof_vehicle_2D.irregularities import calculate_joint_irregularities, calculate_rail_irregularity

    joint, rough = {"location_joint": 5.0, "depth_joint": 1e-3}, {"N": 50, "seed": 3}
    model = coach(1.5, start=15.0, speed=0.0, joint=joint, irregularities=rough)
    model.step(0.0, 1e-3, Rigid())
    for xi, wheel in zip(model.places, (4, 5, 8, 9), strict=True):  # they begin at rest on the rail as it is
        rail = calculate_joint_irregularities(xi, **joint) + calculate_rail_irregularity(xi, **rough)
        assert model.motion[0][wheel] == pytest.approx(rail, rel=1e-9)
    assert model.motion[0][4] != model.motion[0][5]


def test_a_wheel_that_lifts_off_is_let_go_by_hertz_and_refused_otherwise() -> None:
    ground = Rigid()
    models = {power: coach(power, start=15.0, speed=0.0) for power in (1.5, 1.0)}
    for model in models.values():
        model.reset(ground)
        model.step(0.0, 1e-3, ground)
    ground.height = -0.01  # m, at once
    assert {touch.force[-1] for touch in models[1.5].step(1e-3, 1e-3, ground)} == {0.0}
    with pytest.raises(RopewalkError, match="a wheel lifts off, which UVEC answers wrongly with contact_power 1"):
        models[1.0].step(1e-3, 1e-3, ground)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bogie_distances": [-8.0, 9.0]}, "bogie_distances must be two, as far behind"),
        ({"wheel_distances": [0.0]}, "wheel_distances must be two"),
        ({"contact_coefficient": 0.0}, "contact_coefficient and contact_power must be positive, given 0 and 1"),
    ],
)
def test_numbers_that_do_not_fit_are_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(RopewalkError, match=message):
        coach(**changes)


def test_contact_forces_that_do_not_settle_are_refused() -> None:
    model, ground = coach(1.0, start=15.0, speed=0.0), Rigid()
    model.reset(ground)
    model.step(0.0, 0.05, ground)
    ground.height = 1e-3
    with pytest.raises(RopewalkError, match=r"do not settle within 60 calls; shorten `every`, 0.05 s"):
        model.step(0.05, 0.05, ground)


def test_the_example_is_this_coach_and_deflects_the_bridge_as_the_modes_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(EXAMPLE.parent)  # its model is a file next to it
    scenario = load(EXAMPLE)
    assert {key: scenario.loads["coach"].options[key] for key in DATA} == DATA
    # 4.2808 mm by 12 modes with the tangents of the contacts at rest; 48 elements, steps of 1 ms: 0.2 %.
    assert -middle(simulate(scenario)).min() == pytest.approx(4.2808e-3, abs=1.5e-5)
