"""Models of others on lines in calm air: a mass on a spring is the oscillator, an FMU what it is on a rope."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from external_cases import Mass, Sprung
from motion_cases import order
from ropewalk.capabilities import SYSTEM, engine_of
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

STRING = {"start": [0, 0], "end": [100, 0], "tension": 20e3, "mass": 1.0, "axial_stiffness": 2e6, "elements": 40}
OSCILLATOR = {"kind": "oscillator", "mass": 20.0, "stiffness": 4e3, "travel": {"speed": 20.0, "from": 5.0}}
CALM = {"wind": {"direction": [1, 0], "speed": 0.0}}


def goes(load: dict[str, Any], until: float = 0.8, every: float = 0.04, **line: Any) -> xr.Dataset:
    scenario = Scenario.model_validate({
        "lines": {"s": {**STRING, "wind_drag": 1e-9, **line}}, "loads": {"load": {"on": "s", **load}},
        "run": {"kind": "dynamic", "until": until, "every": every}, **CALM,
    })  # fmt: skip
    assert engine_of(scenario) is SYSTEM
    return simulate(scenario)


def stepper(model: Any, every: float, **more: Any) -> dict[str, Any]:
    return {"kind": "stepper", "model": model, "every": every, **more}


def height(result: xr.Dataset) -> np.ndarray:
    return np.asarray(result.contact_position.values[1:, 0, 1])


@pytest.fixture(scope="module")
def oscillator() -> np.ndarray:
    return height(goes(OSCILLATOR))


# Forces held over an interval, or those of a mass that goes on with the force of the last one: the first order, but for
# 4e-5 m that remain of how the front of a load that is put down suddenly goes through links of 2.5 m.
@pytest.mark.parametrize(
    ("model", "exchange", "largest", "window"),
    [
        (Sprung, {}, 3e-4, (0.85, 1.1)),
        (Mass, {"stiffness": 4e3}, 6e-5, (0.9, 1.2)),
        (Mass, {"scheme": "iterated", "stiffness": 4e3}, 6e-5, (0.95, 1.25)),
    ],
    ids=["force", "motion", "motion, iterated"],
)
def test_a_sprung_mass_of_somebody_elses_is_the_oscillator(
    model: Any, exchange: dict[str, Any], largest: float, window: tuple[float, float], oscillator: np.ndarray
) -> None:
    sizes, away = [8e-3, 4e-3, 2e-3], []
    for every in sizes:
        result = goes(stepper(model(), every, exchange=exchange))
        assert result.attrs["outcome"] == "completed"
        away.append(float(np.abs(height(result) - oscillator).max()))
        made = np.abs(result.energy.sel(form="imbalance").values).max()
        assert made < 1e-3 * float(result.exchange_work[-1, 0])  # the line keeps its energy
    assert away[-1] < largest  # m, of 0.2 m
    assert window[0] < order(sizes, away) < window[1]


class Comes:
    """None, one and two contacts in turn, each for a tenth of a second, with a force along the line as well."""

    contacts = 2

    def step(self, t: float, h: float, line: Any) -> list[tuple[Any, ...]]:
        return [(20.0 + 5.0 * n, (30.0, -100.0)) for n in range(int(t / 0.1 + 1e-9) % 3)]


@pytest.mark.parametrize("exchange", [{}, {"damping": 1e-9}], ids=["force", "with an interface"])
def test_contacts_come_and_go_and_energy_is_kept(exchange: dict[str, Any]) -> None:
    found = goes(stepper(Comes(), 0.02, exchange=exchange), 0.75, 0.025)
    assert found["load"].values.tolist() == ["load.1", "load.2"]
    on = np.isfinite(found.contact_xi.values)
    count = (found.time.values / 0.1 + 1e-9).astype(int) % 3
    assert (on.sum(axis=1) == count).all()
    force = found.contact_force.values[on[:, 0], 0]
    assert force == pytest.approx(np.tile([30.0, -100.0], (force.shape[0], 1)), abs=1e-3)  # found to 1e-11 of a link
    work = np.abs(found.energy.sel(form="load_work").values).max()
    assert work > 1.0
    missed = np.abs(found.energy.sel(form="imbalance").values).max()
    assert missed < 2e-4 * work  # twice what was seen; it goes down with the square of the step


class Hurries:
    """It goes faster and faster, and says how fast it is."""

    def step(self, t: float, h: float, line: Any) -> list[tuple[Any, ...]]:
        return [(20.0 + 25.0 * t * t, (0.0, -100.0), 50.0 * t)]


def test_a_contact_that_changes_its_speed_is_where_it_is_said_to_be() -> None:
    found = goes(stepper(Hurries(), 0.02))
    t = found.time.values
    # At exchanges it has slid short by a h^2/2, which it catches up with until the next one.
    assert found.contact_xi.values[:, 0] == pytest.approx(20.0 + 25.0 * t * t, abs=0.5 * 50.0 * 0.02**2 + 1e-9)


class Fails:
    def __init__(self, answer: Any) -> None:
        self.answer = answer

    def step(self, t: float, h: float, line: Any) -> Any:
        if t < 0.495:
            return [(5.0, (0.0, -100.0))]
        return self.answer / 0 if isinstance(self.answer, int) else self.answer


@pytest.mark.parametrize(("answer", "advice"), [(1, "ZeroDivisionError"), ([(5.0, (0.0, 1.0, 2.0))], "2 components")])
def test_a_model_that_fails_ends_the_run_with_what_there_is(answer: Any, advice: str) -> None:
    found = goes(stepper(Fails(answer), 0.01))
    assert found.attrs["outcome"] == "load failed"
    assert advice in found.attrs["advice"]
    assert "t = 0.5 s" in found.attrs["advice"]
    assert found.time.values[-1] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("at_end", "outcome"), [("leave", "completed"), ("stay", "completed"), ("refuse", "travel ended")]
)
def test_beyond_the_end_a_contact_leaves_stays_or_is_refused(at_end: str, outcome: str) -> None:
    found = goes(stepper(Fails([(125.0, (0.0, -100.0))]), 0.01, at_end=at_end))
    assert found.attrs["outcome"] == outcome
    xi, end = found.contact_xi.values[-1, 0], float(found.xi.values.max())
    assert np.isnan(xi) if at_end == "leave" else xi == pytest.approx(end if at_end == "stay" else 5.0)


def test_an_fmu_on_a_line_in_calm_air_is_that_on_a_rope(tmp_path: Path) -> None:
    pytest.importorskip("fmpy", reason="FMUs need FMPy")
    from external.fmus import c_fmu

    cart = {
        "kind": "fmu", "file": str(c_fmu(tmp_path)), "contacts": {"w": {"force": "force", "height": "height"}},
        "travel": {"speed": 20.0},
    }  # fmt: skip
    away = []
    for elements in (40, 80, 160):
        line = {"end": [20, 0], "tension": 1e4, "axial_stiffness": 1e6, "axial_damping": 200.0, "elements": elements}
        calm = goes(cart, 0.3, 0.01, **line)
        loads = {"load": {"on": "s", **cart}}
        rope = simulate(Scenario.model_validate({
            "lines": {"s": {**STRING, **line}}, "loads": loads, "run": {"kind": "dynamic", "until": 0.3, "every": 0.01},
        }))  # fmt: skip
        assert calm.attrs["outcome"] == rope.attrs["outcome"] == "completed", calm.attrs["advice"]
        away.append(float(np.abs(height(calm) - height(rope)).max()))
    print(away)
    assert away[-1] < 1e-3
