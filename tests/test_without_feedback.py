"""Without feedback on beams and networks: loads press as on rigid ground, against closed forms and known forces."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ropewalk import Scenario, feedback, simulate, without_feedback
from ropewalk.errors import ScenarioError
from ropewalk.model import MovingForce
from ropewalk.model.history import SpeedTable
from ropewalk.theory import beam

G = 9.81
# A steel rail of 20 m on two hinges: light deflections, so that its theory is that of small ones.
LENGTH, EI, MASS, TENSION = 20.0, 2e5, 50.0, 1e4
BEAM = {
    "start": [0, 0], "end": [LENGTH, 0], "tension": TENSION, "mass": MASS, "axial_stiffness": 1e8,
    "bending_stiffness": EI, "elements": 200,
}  # fmt: skip
ROPE = {"tension": 1e4, "mass": 1.0, "axial_stiffness": 1e6, "elements": 20}
STRUCTURES: dict[str, Any] = {
    "beam": {"lines": {"line": {**BEAM, "elements": 40}}},
    "small beam": {"lines": {"line": {**BEAM, "elements": 40}}, "run": {"geometry": "linearised"}},
    "joined": {
        "lines": {
            "line": {**ROPE, "start": [0, 0], "end": [LENGTH, 0]},
            "stay": {
                "start": [10, -5], "end": [10, 0], "length": 5.0, "mass": 1.0, "axial_stiffness": 1e5,
                "end_support": {"kind": "joined", "to": "line", "at": 10.0}, "elements": 5,
            },
        }
    },
    "wind": {
        "lines": {"line": {**ROPE, "start": [0, 0], "end": [LENGTH, 0], "wind_drag": 0.02}},
        "wind": {"direction": [1, 0], "speed": 5.0},
    },
    "net": {
        "nets": {
            "line": {
                "kind": "net", "corner": [0, 0, 0], "sides": [[8, 0, 0], [0, 4, 0]], "axial_stiffness": 1e4,
                "mass": 0.5, "tension": 500.0,
            }
        }
    },
}  # fmt: skip
VEHICLE = {
    "kind": "vehicle",
    "bodies": {"box": {"mass": 90.0, "inertia": 30.0, "at": 1.0}},
    "wheels": {"rear": {"at": 0.0, "mass": 5.0}, "front": {"at": 3.0, "mass": 6.0}},
    "springs": {
        "one": {"between": ["box", "rear"], "stiffness": 1e4},
        "two": {"between": ["box", "front"], "stiffness": 2e4},
    },
}


def scenario(structure: str, load: dict[str, Any], **run: Any) -> Scenario:
    """A load on a structure, at 4 m/s from 1 m on, or over a net."""
    tree = dict(STRUCTURES[structure])
    travel = {"speed": 4.0, "from": 1.0}
    if structure == "net":
        travel["path"] = [[1.0, 2.0], [7.0, 2.0]]
        travel["from"] = 0.0
    own = {"travel": travel}
    asked = {"kind": "dynamic", "until": 0.5, "every": 0.05, **tree.pop("run", {}), **run}
    return Scenario.model_validate({**tree, "loads": {"cart": {"on": "line", **own, **load}}, "run": asked})


@pytest.mark.parametrize("structure", STRUCTURES)
def test_a_mass_without_feedback_is_its_weight(structure: str) -> None:
    """The same motion as under a moving force of m g, to the last bit; with feedback it is another one."""
    heavy = scenario(structure, {"kind": "mass", "mass": 20.0})
    alone = without_feedback(heavy)
    assert alone.loads["cart"].kind == "force"
    assert alone.loads["cart"].force == pytest.approx((0.0, -20.0 * G), rel=1e-12)
    weight = scenario(structure, {"kind": "force", "force": list(alone.loads["cart"].force)})
    found, known, coupled = (simulate(one).position.values for one in (alone, weight, heavy))
    assert np.array_equal(found, known)
    assert np.abs(coupled - known).max() > 1e-2 * np.abs(known - known[0]).max()


def test_a_sprung_mass_on_a_beam_moves_it_as_a_moving_force_does() -> None:
    """The exact solution of Euler and Bernoulli; 200 elements and steps of the output leave 0.2 % of the largest."""
    load = {
        "kind": "oscillator", "mass": 300.0, "wheel_mass": 50.0, "stiffness": 5e5,
        "travel": {"speed": 12.0, "from": 0.0},
    }  # fmt: skip
    run = {"kind": "dynamic", "until": 1.5, "every": 0.1, "geometry": "linearised"}
    tree = {"lines": {"line": BEAM}, "loads": {"cart": {"on": "line", **load}}, "run": run}
    result = simulate(without_feedback(Scenario.model_validate(tree)))
    x, t = result.position.values[0, :, 0], result.time.values
    exact = beam.moving_force(
        x[None, :], t[:, None], force=350.0 * G, speed=12.0, length=LENGTH, bending_stiffness=EI, mass=MASS,
        tension=TENSION,
    )  # fmt: skip
    found = result.position.values[0, :, -1] - result.position.values[..., -1]
    assert np.abs(found - exact).max() < 2e-3 * np.abs(exact).max()


@pytest.mark.parametrize("structure", ["beam", "small beam"])
def test_a_vehicle_on_a_beam_becomes_its_axle_loads(structure: str) -> None:
    loads = without_feedback(scenario(structure, VEHICLE)).loads
    assert list(loads) == ["cart-rear", "cart-front"]
    # the lever rule: 2/3 of the box on the rear wheel, 1/3 on the front one; tolerance: a solution of small matrices
    assert loads["cart-rear"].force == pytest.approx((0.0, -G * 65.0), rel=1e-9)
    assert loads["cart-front"].force == pytest.approx((0.0, -G * 36.0), rel=1e-9)
    assert [load.travel.start for load in loads.values()] == [1.0, 4.0]


@pytest.mark.parametrize(("structure", "along"), [("beam", 0.0), ("small beam", 0.0), ("joined", 40.0), ("wind", 40.0)])
def test_a_mass_that_brakes_pushes_its_line_along_where_that_can_be_felt(structure: str, along: float) -> None:
    """d'Alembert: 20 kg at -2 m/s^2 push with 40 N; ground hangs through by 5e-6 of its length and swings a little."""
    speed = {"time": [0.0, 0.5], "value": [4.0, 3.0]}
    load = {"kind": "mass", "mass": 20.0, "travel": {"speed": speed, "from": 1.0}}
    (found,) = without_feedback(scenario(structure, load)).loads.values()
    force = np.atleast_2d(getattr(found.force, "value", found.force))
    middle = np.median(force, axis=0)
    assert middle == pytest.approx((along, -20.0 * G), rel=2e-3, abs=1e-9)
    assert found.travel.speed.value == (4.0, 3.0)


@pytest.mark.parametrize("structure", STRUCTURES)
@pytest.mark.parametrize("with_loads", [False, True])
def test_the_comparison_tells_what_feedback_changes(structure: str, with_loads: bool) -> None:
    found = feedback(scenario(structure, {"kind": "mass", "mass": 2.0}, start={"with_loads": with_loads}))
    assert found.wheels["cart"]["contact_force"]["mean"]["without"]["value"] == pytest.approx(2.0 * G, rel=1e-6)
    assert found.lines["line"]["largest_deflection"]["with"]["value"] > 0.0
    assert "rigid ground" in found.verdict
    assert json.dumps(found.as_dict(), allow_nan=False)
    assert found.table()


SPANS: dict[str, Any] = {"spans": {"count": 3, "length": 40.0}, "droppers": {"per_span": 4}, "element": 1.0}


def below(pantograph: dict[str, Any], until: float, **lines: Any) -> Scenario:
    """A pantograph below an overhead line, from 50 m on."""
    load = {"kind": "pantograph", "on": "line", "model": "en50318-2002", "travel": {"speed": 30.0, "from": 30.0}}
    tree = {"overhead_lines": {"line": SPANS, **lines}, "loads": {"front": {**load, **pantograph}}}
    return Scenario.model_validate({**tree, "run": {"kind": "dynamic", "until": until, "geometry": "linearised"}})


def test_without_feedback_a_pantograph_presses_as_below_a_rigid_wire() -> None:
    """Two masses on springs below a contact spring to something fixed, as EN 50318 has them, by SciPy."""
    known = without_feedback(below({}, 2.0))
    force = known.loads["front"]
    assert isinstance(force, MovingForce)
    assert (force.on, force.travel.start, force.travel.speed) == ("line", pytest.approx(30.0), 30.0)
    M, k, c, touch = np.array([15.0, 7.2]), (50.0, 4200.0), (90.0, 10.0), 50e3
    K = np.array([[k[0] + k[1], -k[1]], [-k[1], k[1] + touch]])
    C = np.array([[c[0] + c[1], -c[1]], [-c[1], c[1]]])

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        push = np.array([120.0 * min(t / 0.3, 1.0), 0.0])
        return np.concatenate([y[2:], (push - K @ y[:2] - C @ y[2:]) / M])

    t, values = np.array(force.force.time), np.array(force.force.value)
    exact = touch * solve_ivp(rate, (0.0, 2.0), np.zeros(4), t_eval=t, rtol=1e-9, atol=1e-12, max_step=0.01).y[1]
    assert exact.min() > -1e-9  # it does not leave the wire
    assert values[:, 1] == pytest.approx(exact, abs=0.3)  # N; contact wires give way by 5e-6 m of the head's 2.4 mm
    assert np.abs(values[:, 0]).max() == 0.0


def test_without_feedback_a_pantograph_goes_over_to_the_line_beside() -> None:
    """One wire rises by 0.4 m, the other comes down: below rigid ones the lower bears, and both where they cross."""
    first = {**SPANS, "heights": [0.0, 0.0, 0.02, 0.4], "overlap": "next"}
    then = {**SPANS, "heights": [0.4, 0.02, 0.0, 0.0], "start": [40.0, 0.0]}
    tree = below({"travel": {"speed": 20.0, "from": 30.0}}, 3.4, line=first, next=then)
    known = without_feedback(tree)
    assert list(known.loads) == ["front", "front-next"]
    one, other = (known.loads[name] for name in known.loads)
    assert (one.on, other.on) == ("line", "next")
    t = np.array(one.force.time)
    ours, theirs = (np.array(load.force.value)[:, 1] for load in (one, other))
    crossing = (80.0 - 30.0) / 20.0  # s, at the support at 80 m, where both are 0.02 m up
    speed = other.travel.speed
    assert isinstance(speed, SpeedTable)
    gone = np.trapezoid(speed.value, speed.time)
    assert other.travel.start + gone == pytest.approx(30.0 + 20.0 * 3.4 - 40.0, abs=0.05)  # m on that line
    assert np.abs(theirs[t < crossing - 0.4]).max() < 1e-6
    assert np.abs(ours[t > crossing + 0.6]).max() < 1e-6
    assert (ours + theirs)[t > 2.8].mean() == pytest.approx(120.0, abs=3.0)
    found = feedback(tree)
    assert set(found.wheels) == {"front", "front.next"}
    assert found.lines["next.contact"]["largest_deflection"]["with"]["value"] > 1e-3
    assert json.dumps(found.as_dict(), allow_nan=False)


def test_models_of_ones_own_on_beams_are_refused_with_a_place() -> None:
    own = {"kind": "stepper", "model": "nowhere:Model", "every": 0.01, "from": 1.0}
    tree = {**STRUCTURES["beam"], "loads": {"model": {"on": "line", **own}}, "run": {"kind": "dynamic", "until": 0.5}}
    with pytest.raises(ScenarioError, match=r"loads\.model\.kind: is not implemented for a run without feedback"):
        without_feedback(Scenario.model_validate(tree))
