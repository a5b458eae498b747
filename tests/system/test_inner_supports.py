"""Lines that are held between their ends, in motion.

Sources: superposition of the exact modes of a beam over two spans (`continuous_beams.py`); a string with a spring and a
mass at a station by its characteristics (`held_strings.py`); the same thing said in other words.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from continuous_beams import EI, MASS, SPANS, Array, three_moments, under_a_moving_force
from example_routes import deck_under_a_vehicle
from held_strings import HeldString, MovingLoad, Station, crossed
from ropewalk.capabilities import SYSTEM, engine_of
from ropewalk.model import Scenario
from ropewalk.scenario import load
from ropewalk.simulate import simulate

EXAMPLES = Path(__file__).parents[2] / "examples"
BEARING = {"kind": "guided", "along": [1, 0]}
SPEED = 20.0  # m/s
STRAIN = 1e-4
ROPE = {"start": [0, 0], "end": [20, 0], "tension": 1e4, "mass": 1.0, "axial_stiffness": 1e8}


def moving(
    line: dict[str, Any], until: float, every: float, start: dict[str, Any] | None = None, **more: Any
) -> xr.Dataset:
    """A motion, which must be that of the system."""
    run = {"kind": "dynamic", "until": until, "every": every, "start": start or {"kind": "rest"}}
    scenario = Scenario.model_validate({"gravity": 0.0, "lines": {"line": line}, "run": run} | more)
    assert engine_of(scenario) is SYSTEM
    result = simulate(scenario)
    assert result.attrs["outcome"] == "completed", result.attrs["doubts"] or result.attrs["advice"]
    return result


def crossing(force: float, **travel: Any) -> dict[str, Any]:
    """A force downwards that crosses the line from its start."""
    travel = {"speed": SPEED, "at_end": "leave"} | travel
    return {"force": {"kind": "force", "on": "line", "force": [0, -force], "travel": travel}}


def beam(spans: tuple[float, ...], elements: int, bearing: dict[str, Any] = BEARING) -> dict[str, Any]:
    at, whole = np.cumsum(spans)[:-1].tolist(), sum(spans)
    line = {"start": [0, 0], "end": [whole, 0], "length": whole, "mass": MASS, "axial_stiffness": 1e8}
    line |= {"bending_stiffness": EI, "elements": elements}
    return line | {"supports": {f"pier{i}": {"at": s, **bearing} for i, s in enumerate(at)}}


def orders(errors: list[float]) -> Array:
    found = np.log2(np.divide(errors[:-1], errors[1:]))
    print("errors", errors, "orders", found)
    return np.asarray(found)


@pytest.mark.parametrize("spans", SPANS, ids=str)
def test_motion_of_beams_on_piers_begins_with_the_reactions_of_the_three_moment_equation(
    spans: tuple[float, ...],
) -> None:
    gravity = 1e-3  # m/s^2: so little that beams between fixed ends do not stretch
    exact = three_moments(spans, gravity * MASS)
    errors = []
    for n in (2, 4, 8):
        line = beam(spans, round(n * sum(spans)))
        found = moving(line, 1e-4, 1e-4, gravity=gravity).reaction.values[0, :, 1]
        errors.append(float(np.abs(found[[0, *range(2, found.size), 1]] / exact - 1.0).max()))
    assert errors[-1] < 1e-4
    assert orders(errors) == pytest.approx([3.0, 3.0], abs=0.02)


def test_a_force_crosses_a_pier_as_modes_of_two_spans_say() -> None:
    """Right to the third order of the mesh: at the pier the shear force jumps, and the contact does within links."""
    spans, errors = (7.2, 12.8), []
    for elements in (25, 50, 100):
        found = moving(beam(spans, elements), 1.0, 0.02, loads=crossing(1.0))
        exact = -under_a_moving_force(spans, SPEED, np.linspace(0.0, 20.0, elements + 1), found.time.values)
        errors.append(float(np.abs(found.position.values[:, :, 1] - exact).max() / np.abs(exact).max()))
        audit = found.energy
        work = float(np.abs(audit.sel(form="load_work")).max())
        assert float(np.abs(audit.sel(form="imbalance")).max()) < 1e-6 * work
    assert errors[-1] < 5e-5
    assert orders(errors) == pytest.approx([2.9, 2.9], abs=0.25)


@pytest.mark.parametrize(
    ("stiffness", "mass", "order"), [(2e3, 0.0, 1.4), (2e3, 5.0, 2.0), (0.0, 5.0, 2.0)], ids=["spring", "both", "mass"]
)
def test_a_string_on_a_spring_at_a_station_yields_to_a_force_as_its_characteristics_say(
    stiffness: float, mass: float, order: float
) -> None:
    """In the mean square; corners of the deflection, which pass a station without a mass, are right to the first."""
    at, errors = 7.2, []
    support = {"at": at / (1.0 + STRAIN), "kind": "elastic", "stiffness": [0.0, stiffness], "mass": mass}
    for elements in (25, 50, 100):
        line = ROPE | {"elements": elements, "supports": {"spring": support}}
        found = moving(line, 0.9, 0.01, loads=crossing(1e-3))
        node = int(np.abs(found.xi.values - support["at"]).argmin())
        string = HeldString(20.0, 1e4, 1.0 / (1.0 + STRAIN), Station(at, stiffness, mass=mass))
        exact = -crossed(string, SPEED * (1.0 + STRAIN), found.time.values, MovingLoad(force=1e-3))[0]
        away = found.position.values[:, node, 1] - exact
        errors.append(float(np.sqrt((away**2).mean()) / np.abs(exact).max()))
        reaction = found.reaction.sel(axis="z").values[:, 2]
        if not mass:
            np.testing.assert_allclose(reaction, -stiffness * found.position.values[:, node, 1], atol=1e-9)
    assert errors[-1] < 2e-3
    assert orders(errors) == pytest.approx([order, order], abs=0.25)


@pytest.mark.parametrize("kind", ["force", "mass"])
def test_a_rope_that_is_held_is_two_ropes_that_end_there(kind: str) -> None:
    """The same links, step for step, while the load is on the first of them."""
    moving_load = {"kind": kind, "on": "line", "travel": {"speed": SPEED, "from": 3.0}}
    moving_load |= {"force": [0, -500.0]} if kind == "force" else {"mass": 40.0}
    rope = {"mass": 1.0, "axial_stiffness": 1e6, "axial_damping": 50.0, "wind_drag": 0.01}
    wind = {"wind": {"direction": [1, 0], "speed": 0.0}, "gravity": 9.81}
    whole = rope | {"start": [0, 0], "end": [20, 0], "length": 19.8, "elements": 80}
    pier = {"at": 0.4 * 19.8, "kind": "fixed"}
    restrained = moving(whole | {"supports": {"saddle": pier}}, 0.2, 0.01, loads={"load": moving_load}, **wind)
    run = {"kind": "dynamic", "until": 0.2, "every": 0.01}
    ropes = {
        "line": rope | {"start": [0, 0], "end": [8, 0], "length": 0.4 * 19.8, "elements": 32},
        "far": rope | {"start": [8, 0], "end": [20, 0], "length": 0.6 * 19.8, "elements": 48},
    }
    tree = {"lines": ropes, "loads": {"load": moving_load}, "run": run | {"step": restrained.attrs["step"]}} | wind
    two = simulate(Scenario.model_validate(tree))
    kept = [*range(33), *range(34, 82)]  # the second rope begins where the first one ends
    np.testing.assert_allclose(restrained.position.values, two.position.values[:, kept], rtol=0, atol=1e-9)
    assert two.support.values.tolist() == ["line.start", "line.end", "far.start", "far.end"]
    at_saddle = two.reaction.values[:, 1] + two.reaction.values[:, 2]
    np.testing.assert_allclose(restrained.reaction.values[:, 2], at_saddle, rtol=0, atol=1e-5)


def test_a_pier_that_yields_to_all_is_none_and_one_that_hardly_yields_is_rigid() -> None:
    spans, loads = (8.0, 12.0), crossing(1.0)

    def course(bearing: dict[str, Any] | None) -> Array:
        line = beam(spans, 40, bearing or BEARING)
        if bearing is None:  # springs of nothing keep the engine
            line = line | {"supports": {"none": {"at": 8.0, "kind": "elastic", "stiffness": 0.0}}}
        return np.asarray(moving(line, 0.4, 0.02, loads=loads).position.values[:, :, 1])

    plain = course(None)
    size = np.abs(plain).max()
    assert np.abs(course({"kind": "elastic", "stiffness": [0.0, 1e-2]}) - plain).max() < 1e-5 * size
    assert np.abs(course({"kind": "elastic", "stiffness": [0.0, 1e11]}) - course(BEARING)).max() < 1e-5 * size
    assert np.abs(course(BEARING) - plain).max() > 0.5 * size


def test_a_pier_that_sinks_takes_the_beam_along() -> None:
    """Slowly against its slowest vibration, by s; then s over the deflection of a unit force there is its pull."""
    s, gone = 1e-3, 4.0
    table = {"time": [0.0, gone], "value": [[0, 0], [0, -s]]}
    line = beam((8.0, 12.0), 40, {"kind": "moving", "displacement": table}) | {"drag": 5.0}
    found = moving(line, 8.0, 1.0)
    node = int(np.abs(found.xi.values - 8.0).argmin())
    np.testing.assert_allclose(found.position.values[-1, node, 1], -s, rtol=1e-9)
    pull = 3.0 * EI * 20.0 / (8.0 * 12.0) ** 2 * s
    assert found.reaction.values[-1, 2, 1] == pytest.approx(-pull, rel=3e-3)  # mesh 1e-3, what still swings 1e-3
    work, damped = (float(found.energy.sel(form=form)[-1]) for form in ("support_work", "line_damping"))
    assert work - damped == pytest.approx(0.5 * pull * s, rel=1e-2)


def test_a_mass_rolls_over_a_pier_and_keeps_the_audit() -> None:
    """What is missing of the energy shrinks with the mesh."""
    moving_load = {"kind": "mass", "on": "line", "mass": 500.0, "travel": {"speed": SPEED, "from": 2.0}}
    line = beam((7.2, 12.8), 50) | {"length": 20.0}
    found = moving(line, 0.8, 0.01, gravity=9.81, loads={"mass": moving_load})
    audit = found.energy
    turned = float(np.abs(audit.sel(form=["kinetic", "load_kinetic", "elastic"])).sum("form").max())
    assert float(np.abs(audit.sel(form="imbalance")).max()) < 1e-4 * turned


def test_a_bead_rides_over_a_saddle_as_its_energy_says() -> None:
    """Light spans of 10 m yield by y = m g s (10 - s) / 10 T below it, and store half of that work: v^2 - g y is kept.

    Places one metre and more from the saddle, where what it stirs up is small; it is lost in waves (1 % of the change).
    """
    mass, speed, tension = 10.0, 8.0, 1e4
    bead = {"kind": "mass", "mass": mass, "on": "line", "travel": {"kind": "free", "speed": speed, "from": 6.0}}
    line = ROPE | {"mass": 0.05, "elements": 20, "supports": {"saddle": {"at": 10.0, "kind": "fixed"}}}
    found = moving(line, 1.0, 0.01, gravity=9.81, loads={"bead": bead}, start={"kind": "rest", "with_loads": True})
    xi, seen = (found[name].values[:, 0] for name in ("contact_xi", "contact_speed"))
    s = np.mod(xi, 10.0)
    yields = mass * 9.81 * s * (10.0 - s) / (10.0 * tension)
    exact = np.sqrt(speed**2 - 9.81 * (yields[0] - yields)) * seen[0] / speed
    away = np.interp([7.0, 8.0, 9.0, 11.0, 12.0, 13.0], xi, (seen - exact) / (exact.max() - exact.min()))
    print("of the change of its speed", away)
    assert np.abs(away).max() < 0.015
    audit = found.energy
    assert float(np.abs(audit.sel(form="imbalance")).max()) < 1e-6 * float(audit.sel(form="load_kinetic")[0])


def test_the_example_of_a_continuous_bridge_sinks_under_its_vehicle_as_modes_of_two_spans_say() -> None:
    """8, 12, 16 modes: 6.2812, 6.2842, 6.2855 mm, what is missing is of the part count^-3: 6.2863 mm without end."""
    eight, twelve = deck_under_a_vehicle(34.0, 8), deck_under_a_vehicle(34.0, 12)
    exact = twelve + (twelve - eight) / (1.5**3 - 1.0)
    result = simulate(load(EXAMPLES / "continuous-bridge.yaml"))
    node = int(np.abs(result.xi.values - 34.0).argmin())
    assert float(result.position.values[:, node, 1].min()) == pytest.approx(exact, abs=2e-6)
