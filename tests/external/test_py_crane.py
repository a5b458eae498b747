"""The crane FMU of py-crane on a rope: what it exerts is its masses times what they and gravity accelerate with."""

from __future__ import annotations

from importlib.metadata import distribution
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ropewalk.errors import RopewalkError
from ropewalk.model import Dynamic, Fmu, Line, MovingForce, Oscillator, Scenario, Stepper
from ropewalk.scenario import load
from ropewalk.simulate import simulate

pytest.importorskip("fmpy", reason='FMPy is not installed: pip install "ropewalk[external]"')

from hanging_crane import ALONG_WIRE, GRAVITY, HangingCrane  # of docs/external: see conftest.py

EXAMPLE = Path(__file__).parents[2] / "docs" / "external" / "crane-on-rope.yaml"
STEP = 0.01  # s
LOAD = {"wire.mass": 1000.0, "wire.boom[0]": 10.0}  # kg, m
LUFFING = {"der(boom.boom[1])": [[0.0, 0.1, 1.0], [0.0, -12.0, -12.0]]}  # s, degrees/s


@pytest.fixture(scope="module")
def crane() -> Any:
    pytest.importorskip("py_crane", reason='py-crane is not installed: pip install "ropewalk[external]"')
    return HangingCrane(0.0)  # so that all FMUs of this file take the modules that are installed


class Watched(HangingCrane):
    """A crane that keeps where it was and what it was borne with."""

    def reset(self, line: Any) -> None:
        super().reset(line)
        self.seen: list[tuple[float, ...]] = []
        self.own: list[float] = []
        self.across: list[float] = []
        self.foreseen: list[float] = []

    def step(self, t: float, h: float, line: Any) -> Any:
        borne = -float(line.force(0)[-1])
        touches = super().step(t, h, line)
        _, boom, wire = self.places
        load = boom + ALONG_WIRE * (wire - boom)
        self.seen.append((borne, self.height, load[2], load[0]))
        self.own.append(self.own_force[2])
        self.across.append(touches[0].force[0])
        self.foreseen.append(self.height + h * touches[0].motion[1])
        return touches


def hung(every: float = STEP, until: float = 1.0, **options: Any) -> tuple[Watched, Any]:
    """A heavy carrying rope of 40 m, on which it bounces at 1 Hz."""
    model = Watched(20.0, parameters=LOAD, **options)
    rope = Line.model_validate({
        "start": (0, 0), "end": (40, 0), "tension": 5e6, "mass": 50.0, "axial_stiffness": 1e9, "axial_damping": 1e6,
        "drag": 3.0, "elements": 40,
    })  # fmt: skip
    load = Stepper.model_validate(
        {"on": "rope", "model": model, "every": every, "exchange": {"stiffness": 1e6, "damping": 1e5}}
    )
    result = simulate(Scenario(lines={"rope": rope}, loads={"crane": load}, run=Dynamic(until=until, every=STEP)))
    assert result.attrs["outcome"] == "completed", result.attrs["advice"]
    return model, result


@pytest.fixture(scope="module")
def still(crane: Any) -> tuple[Watched, Any]:
    return hung()


@pytest.fixture(scope="module")
def luffed(crane: Any) -> dict[float, Watched]:
    return {every: hung(every, until=0.6, drives=LUFFING)[0] for every in (0.01, 0.005)}


def momentum_rate(model: Watched, every: float) -> tuple[np.ndarray, np.ndarray]:
    """What it is borne with, and masses times accelerations and gravity, by differences of what the FMU shows; N."""
    crane, load = model.masses
    borne, fixation, height, _ = np.array(model.seen).T
    rate = crane * (GRAVITY + np.diff(fixation, 2) / every**2) + load * (GRAVITY + np.diff(height, 2) / every**2)
    return borne[2:], rate  # the velocity changes between intervals: the force of the later one does it


def test_what_bears_the_crane_is_mass_times_acceleration(still: Any) -> None:
    model, _ = still
    borne, rate = momentum_rate(model, STEP)
    weight = GRAVITY * sum(model.masses)
    print(f"borne {borne.min():.6g} to {borne.max():.6g} N of a weight of {weight:.6g} N")
    assert np.ptp(borne) > weight  # it bounces
    assert borne == pytest.approx(rate, abs=1e-6 * weight)  # rounding of differences of places: 1e-15/1e-4 m/s^2


def test_the_rope_feels_that_force(still: Any) -> None:
    model, result = still
    borne = np.array(model.seen)[:, 0]
    on_rope = -result.contact_force.sel(axis="z", contact=0).to_numpy()
    mean = 0.5 * (on_rope[1:] + on_rope[:-1])  # of an interval, by its ends
    off = np.abs(mean - borne[1:])[1:].max() / borne.max()
    print(f"off by {off:.2e}")
    assert off < 0.01  # the damper jumps at an exchange by what was foreseen wrongly: c * jerk * step^2 = 600 N, 0.3 %


def test_it_foresees_where_it_will_be(still: Any) -> None:
    model, _ = still
    height = np.array(model.seen)[:, 1]
    wrong = np.abs(height[1:] - model.foreseen[:-1])[1:].max()
    print(f"wrong by {wrong:.2e} m")
    assert wrong < 2e-4  # m, change of acceleration * step^2; without the acceleration it is g * step^2 = 1e-3


def test_it_says_itself_what_its_frame_exerts_but_twice(still: Any) -> None:
    """`force` of py-crane 0.3.1 counts pedestal and boom twice and the load not at all."""
    model, _ = still
    crane, _ = model.masses
    fixation = np.array(model.seen)[:, 1]
    expected = -2.0 * crane * (GRAVITY + np.diff(fixation, 2) / STEP**2)
    assert np.array(model.own)[2:] == pytest.approx(expected, abs=1e-6 * crane * GRAVITY)


def test_a_load_that_swings_pulls_a_little_late(luffed: Any) -> None:
    """The load's acceleration as seen from the fixation is that of the interval before: of the first order."""
    off = {}
    for every, model in luffed.items():
        borne, rate = momentum_rate(model, every)
        off[every] = float(np.abs(borne - rate)[5:].mean() / borne.max())
        _, fixation, height, _ = np.array(model.seen).T
        assert np.ptp(height - fixation) > 0.5  # m, that the boom has lifted it
    print(off)
    assert off[0.01] < 2e-3
    assert off[0.005] < off[0.01]


def test_a_load_that_swings_pulls_the_rope_along(luffed: Any) -> None:
    model = luffed[0.01]
    x = np.array(model.seen)[:, 3]
    pulled = np.array(model.across)[3:]
    assert np.abs(pulled).max() > 50.0  # N
    assert pulled == pytest.approx(-model.masses[1] * np.diff(x, 2)[:-1] / 0.01**2, abs=1e-6 * np.abs(pulled).max())


def test_a_mass_of_its_other_fmu_on_a_rope_is_our_own_oscillator(crane: Any) -> None:
    """HarmonicOscillator6D by kind: fmu, with no spring of its own, on the spring of the interface.

    The FMU of 0.3.1 takes its force for an acceleration (x'' = -k/m x - c/m v + f), hence the factor.
    """
    mass, stiffness, damping = 50.0, 2e4, 100.0
    file = next(str(each.locate()) for each in distribution("py-crane").files or [] if "Oscillator6D.fmu" in each.name)
    hook = {"gives": "motion", "force": "f[2]", "height": "x[2]", "velocity": "v[2]", "force_factor": -mass}
    free = {f"{name}[{i}]": 0.0 for name in "kc" for i in range(6)}
    travel = {"speed": 0.0, "from": 12.0}
    external = Fmu.model_validate({
        "on": "rope", "file": file, "contacts": {"hook": hook}, "travel": travel, "parameters": free, "every": 2e-3,
        "exchange": {"stiffness": stiffness, "damping": damping},
    })  # fmt: skip
    own = Oscillator.model_validate(
        {"on": "rope", "mass": mass, "stiffness": stiffness, "damping": damping, "travel": travel}
    )
    rope = Line.model_validate({
        "start": (0, 0), "end": (20, 0), "tension": 2e4, "mass": 1.0, "axial_stiffness": 5e6, "axial_damping": 50.0,
        "elements": 80,
    })  # fmt: skip
    walker = MovingForce.model_validate({"on": "rope", "force": [0, -800], "travel": {"speed": 5.0, "from": 1.0}})
    run = Dynamic(until=1.0, every=0.01)
    results = [
        simulate(Scenario(lines={"rope": rope}, loads={"walker": walker, "mass": load}, run=run, gravity=0.0))
        for load in (external, own)
    ]
    found, known = (r.position.sel(axis="z").to_numpy() for r in results)
    shape = np.abs(found - known).max() / np.abs(known).max()
    found, known = (r.contact_force.sel(axis="z", contact=1).to_numpy() for r in results)
    force = np.abs(found - known).max() / np.abs(known).max()
    print(f"rope {shape:.2e}, force {force:.2e}")
    assert shape < 2e-3
    assert force < 0.02  # our own mass has springs along the rope, too


def test_the_example_bounces_about_the_weight_of_the_crane(crane: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(EXAMPLE.parent)  # its model is a file next to it
    result = simulate(load(EXAMPLE))
    assert result.attrs["outcome"] == "completed", result.attrs["advice"]
    force = -result.contact_force.sel(axis="z", contact=0).to_numpy()
    inner = force[1:-1]
    first, second = 1 + np.flatnonzero((inner > force[:-2]) & (inner >= force[2:]) & (inner > force.mean()))[:2]
    # The bounce is damped, and the force is largest a little before the crane turns round: 2.3 % more than 12 t.
    assert force[first:second].mean() == pytest.approx(12e3 * GRAVITY, abs=3.5e3)


def test_without_a_spring_it_is_refused(crane: Any) -> None:
    rope = Line.model_validate({"start": (0, 0), "end": (40, 0), "tension": 5e6, "mass": 50.0, "axial_stiffness": 1e9})
    load = Stepper.model_validate({"on": "rope", "model": HangingCrane(20.0), "every": STEP})
    result = simulate(Scenario(lines={"rope": rope}, loads={"crane": load}, run=Dynamic(until=0.2, every=0.1)))
    assert result.attrs["outcome"] == "load failed"
    assert "nothing carries the crane; give exchange.stiffness" in result.attrs["advice"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"file": "MobilCrane.fmu"}, "there is no FMU MobilCrane.fmu; did you mean MobileCrane.fmu"),
        ({"parameters": {"wire.mas": 1.0}}, "has no variable wire.mas; did you mean wire.mass"),
        ({"drives": {"boom.angle": 1.0}}, "has no variable boom.angle"),
        ({"file": "HarmonicOscillator6D.fmu"}, r"has no variable d_velocity\[0\]"),
    ],
)
def test_what_is_not_there_is_named(crane: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(RopewalkError, match=message):
        HangingCrane(20.0, **options)


def test_without_the_package_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    def absent(name: str) -> Any:
        raise __import__("importlib.metadata").metadata.PackageNotFoundError(name)

    monkeypatch.setattr("hanging_crane.distribution", absent)
    with pytest.raises(RopewalkError, match=r'not installed; pip install py-crane, or pip.*"ropewalk\[external\]"'):
        HangingCrane(20.0)
