"""Bodies of vehicles are located between their wheels, on lines in all directions and with wheels in any order."""

from __future__ import annotations

from itertools import permutations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk import load
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

HERE = Path(__file__).parent
COURSES: dict[str, tuple[list[float], list[float], float]] = {
    "+x": ([0, 0], [12, 0], 12.3),
    "-x": ([0, 0], [-12, 0], 12.3),
    "up": ([0, 0], [12, 6], 13.7),
    "down -x": ([0, 6], [-12, 0], 13.7),
    "y": ([0, 0, 0], [0, 12, 0], 12.3),
    "diagonal": ([0, 0, 0], [-8, 9, 2], 12.6),
}
STIFF = {"mass": 3, "axial_stiffness": 5e5, "bending_stiffness": 100, "elements": 12}
LINES: dict[str, dict[str, Any]] = {
    "wires": STIFF,
    "ropes": {"mass": 3, "axial_stiffness": 5e5, "elements": 12, "axial_damping": 10},
    "system": {**STIFF, "wind_drag": 1e-3},
}
RUNS: dict[str, dict[str, Any]] = {
    "dynamic": {"kind": "dynamic", "until": 0.02, "every": 0.02},
    "equilibrium": {"kind": "equilibrium"},
    "quasistatic": {"kind": "quasistatic", "positions": 3},
}


def car(wheels: dict[str, float], speed: float = 1.0, at: float = 0.0, start: float = 5.0) -> dict[str, Any]:
    body = {"mass": 10, "at": at, **({"inertia": 5} if len(wheels) > 1 else {})}
    springs = {name: {"between": ["box", name], "stiffness": 1e4, "damping": 50} for name in wheels}
    if len(wheels) == 1:  # above its centre of gravity
        springs = {name: {**spring, "at": at} for name, spring in springs.items()}
    return {
        "kind": "vehicle", "on": "s", "bodies": {"box": body}, "wheels": {n: {"at": x} for n, x in wheels.items()},
        "springs": springs, "travel": {"speed": speed, "from": start, "at_end": "leave"},
    }  # fmt: skip


def run(line: str, course: str, own: dict[str, Any], how: str = "dynamic") -> xr.Dataset:
    start, end, length = COURSES[course]
    given = {"start": start, "end": end, "length": length, **LINES[line]}
    tree: dict[str, Any] = {"lines": {"s": given}, "loads": {"car": own}, "run": RUNS[how]}
    if line == "system":
        tree["wind"] = {"speed": 0.1, "direction": [0, 1, 0]}
    return simulate(Scenario.model_validate(tree))


def level(result: xr.Dataset, i: int = 0) -> tuple[Any, dict[str, Any]]:
    """Level place of the body, and those of the wheels by name."""
    wheels = [str(name).rpartition(".")[2] for name in result["load"].values]
    places = dict(zip(wheels, result.contact_position.values[i, :, :-1], strict=True))
    return result.body_position.values[i, 0, :-1], places


def test_the_box_is_above_the_middle_of_the_wheels_of_a_line_towards_minus_x() -> None:
    found = simulate(load(HERE / "body-position.yaml"))
    box, wheels = level(found)
    assert box == pytest.approx(0.5 * (wheels["front"] + wheels["rear"]), abs=1e-9)
    assert box[0] == pytest.approx(-4.90, abs=0.05)  # as the slack line hangs


@pytest.mark.parametrize(
    ("how", "speed"), [("dynamic", 1.0), ("dynamic", -1.0), ("equilibrium", 1.0), ("quasistatic", 1.0)]
)
@pytest.mark.parametrize("course", COURSES)
@pytest.mark.parametrize("line", LINES)
def test_the_box_is_between_its_wheels(line: str, course: str, how: str, speed: float) -> None:
    own = {"front": 1.0, "rear": -1.0}
    one, two = (run(line, course, car(dict(order), speed), how) for order in (own.items(), reversed(own.items())))
    box, wheels = level(one)
    assert box == pytest.approx(0.5 * (wheels["front"] + wheels["rear"]), abs=1e-9)
    assert level(two)[0] == pytest.approx(box, abs=1e-6)  # equilibria to 1e-9 of the line


@pytest.mark.parametrize("course", ["-x", "up", "diagonal"])
@pytest.mark.parametrize("line", LINES)
def test_a_body_between_four_wheels_is_where_its_own_place_is(line: str, course: str) -> None:
    own = {"a": 1.5, "b": 1.0, "c": -1.0, "d": -1.5}
    for order in list(permutations(own))[::11]:
        box, wheels = level(run(line, course, car({name: own[name] for name in order}, at=0.5)))
        assert box == pytest.approx(0.75 * wheels["b"] + 0.25 * wheels["c"], abs=1e-9)
        box, wheels = level(run(line, course, car({name: own[name] for name in order}, at=3.0)))
        assert box == pytest.approx(1.5 * wheels["a"] - 0.5 * wheels["d"], abs=1e-9)


@pytest.mark.parametrize("course", COURSES)
@pytest.mark.parametrize("line", LINES)
def test_a_body_ahead_of_its_only_wheel_is_ahead_along_the_line(line: str, course: str) -> None:
    start, end, _ = COURSES[course]
    way = np.subtract(end, start)[:-1]
    box, wheels = level(run(line, course, car({"only": 0.0}, at=0.7)))
    (wheel,) = wheels.values()
    assert (box - wheel)[: way.size] == pytest.approx(0.7 * way / np.linalg.norm(way), abs=1e-9)


@pytest.mark.parametrize("line", LINES)
def test_coordinates_of_matrices_are_at_the_point_of_their_travel(line: str) -> None:
    K = [[2e4, 0, -1e4, -1e4], [0, 2e4, -1e4, 1e4], [-1e4, -1e4, 1e4, 0], [-1e4, 1e4, 0, 1e4]]
    wheels = {"front": {"at": 1.0, "coordinate": "f"}, "rear": {"at": -1.0, "coordinate": "r"}}
    mass = np.diag([10.0, 5.0, 1.0, 1.0]).tolist()
    places = []
    for order in (("front", "rear"), ("rear", "front")):
        own = {
            "kind": "matrices", "on": "s", "coordinates": ["z", "pitch", "f", "r"], "mass": mass, "stiffness": K,
            "wheels": {name: wheels[name] for name in order}, "weight": [98.1, 0, 9.81, 9.81],
            "travel": {"speed": 1.0, "from": 5.0, "at_end": "leave"},
        }  # fmt: skip
        box, found = level(run(line, "-x", own))
        assert box == pytest.approx(0.5 * (found["front"] + found["rear"]), abs=1e-9)
        places.append(box)
    assert places[0] == pytest.approx(places[1], abs=1e-9)


@pytest.mark.parametrize("speed", [10.0, -10.0])
@pytest.mark.parametrize("line", LINES)
def test_a_body_without_wheels_on_its_line_is_beyond_the_end_or_nowhere(line: str, speed: float) -> None:
    """It is nowhere where nothing moves its wheels on."""
    start, end, length = COURSES["-x"]
    own = car({"front": 1.0, "rear": -1.0}, speed, start=9.0 if speed > 0 else 3.0)
    tree: dict[str, Any] = {
        "lines": {"s": {"start": start, "end": end, "length": length, **LINES[line]}}, "loads": {"car": own},
        "run": {"kind": "dynamic", "until": 0.6, "every": 0.1},
    }  # fmt: skip
    if line == "system":
        tree["wind"] = {"speed": 0.1, "direction": [0, 1]}
    found = simulate(Scenario.model_validate(tree))
    x, off = found.body_position.values[:, 0, 0], (found.contact_state == 0).all(axis=1).values
    assert off.any()
    assert np.isfinite(x[~off]).all()
    assert np.isnan(x[off]).all() or ((x[off] < -12.0) if speed > 0 else (x[off] > 0.0)).all()


@pytest.mark.parametrize("bending", [0.0, 1e5])
@pytest.mark.parametrize("measured", ["material", "horizontal"])
@pytest.mark.parametrize("end", [[30, 0], [24, 18], [-30, 0]])
def test_a_box_is_in_the_middle_of_its_wheels_on_a_stretched_line(
    end: list[float], measured: str, bending: float
) -> None:
    """In linear theory, too, where the distance of wheels is one along the unstrained line or one in x."""
    if measured == "horizontal" and end[0] < 0.0:
        return  # refused
    line = {"start": [0, 0], "end": end, "tension": 1e4, "mass": 0.5, "axial_stiffness": 2e5, "elements": 16,
            "bending_stiffness": bending}  # fmt: skip
    springs = {name: {"between": ["box", name], "stiffness": 2e3, "damping": 20} for name in ("rear", "front")}
    wheels = {"rear": {"at": -1.0, "mass": 1}, "front": {"at": 1.0, "mass": 1}}
    load = {"kind": "vehicle", "on": "r", "bodies": {"box": {"mass": 4, "inertia": 2}}, "wheels": wheels,
            "springs": springs, "travel": {"speed": 20, "measured": measured, "at_end": "leave"}}  # fmt: skip
    run = {"kind": "linear", "until": 0.3, "every": 0.1}
    found = simulate(Scenario.model_validate({"lines": {"r": line}, "loads": {"v": load}, "run": run}))
    middle = found.contact_position.values[1:, :, 0].mean(axis=1)
    assert found.body_position.values[1:, 0, 0] == pytest.approx(middle, abs=1e-9)


@pytest.mark.parametrize(("stiff", "sag"), [(True, 9.5e-3), (False, 0.11)], ids=["beam", "string"])
@pytest.mark.parametrize("speed", [3.0, -3.0])
def test_bodies_in_linear_theory_are_above_the_line_as_drawn(stiff: bool, sag: float, speed: float) -> None:
    """The motion with its geometry linearised says so, too; deflections by the load differ by the mesh."""
    line = {"start": [0, 0], "end": [16, 0], "mass": 100, "elements": 16, "axial_stiffness": 1e9}
    line |= {"length": 16, "bending_stiffness": 9e7} if stiff else {"tension": 2.8e5}
    bob = {"kind": "oscillator", "on": "s", "mass": 50, "wheel_mass": 10, "stiffness": 5e3, "damping": 100,
           "travel": {"from": 0 if speed > 0 else 16, "speed": speed}}  # fmt: skip
    common = {"until": 2.0, "every": 0.5}
    both = [
        simulate(Scenario.model_validate({"lines": {"s": line}, "loads": {"bob": bob}, "run": {**how, **common}}))
        for how in ({"kind": "linear", "modes": 30}, {"kind": "dynamic", "geometry": "linearised"})
    ]
    place, right = (result.body_position.values[:, 0] for result in both)
    assert np.ptp(right[:, 1]) > 0.7 * sag  # the sag is felt
    np.testing.assert_allclose(place, right, atol=0.1 * sag)
