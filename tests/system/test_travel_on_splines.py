"""How contacts on splines advance, leave their line and give way.

Sources: a string that is stretched evenly, on which all measures of a travel are known; free flight, a parabola; the
balance of a contact without friction on a taut inclined line; and the same mechanics said in other words: a soft
contact is a spring below a wheel, a person who walks is one force for each step.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ropewalk import Scenario, simulate
from ropewalk.mechanics.footfall import Footfall
from ropewalk.model.footsteps import Footsteps
from ropewalk.results.frame import IN_AIR, MOVES, Frame
from system_cases import frames_of, imbalance, line, scenario, with_steps_of

STRAIN = 0.25
ROPE = {"end": [20, 0], "tension": None, "length": 20.4, "axial_stiffness": 1e5, "elements": 40}


def xi(frames: list[Frame]) -> np.ndarray:
    return np.array([frame.contact_xi[0] for frame in frames])


@pytest.mark.parametrize("measured", ["material", "slip", "arc", "horizontal"])
def test_on_an_evenly_stretched_string_all_measures_are_known(measured: str) -> None:
    """The force is so small that it bends nothing; the string is a quarter longer than unstrained."""
    lines = {"s": line(end=[10, 0], tension=None, length=10.0 / (1.0 + STRAIN), axial_stiffness=1e3, elements=10)}
    travel = {"speed": 2.0, "from": 3.0, "measured": measured}
    frames = frames_of(
        scenario(lines, {"p": {"kind": "force", "on": "s", "force": [0, -1e-6], "travel": travel}}, 2.0, 0.1)
    )
    t = np.array([frame.path for frame in frames])
    expected = 3.0 + 2.0 * t if measured == "material" else (3.0 + 2.0 * t) / (1.0 + STRAIN)
    assert np.abs(xi(frames) - expected).max() < 1e-9
    assert frames[-1].contact_speed[0] == pytest.approx(2.0)


@pytest.mark.parametrize("kind", ["force", "mass"])
def test_horizontally_it_goes_as_told_on_a_rope_that_swings(kind: str) -> None:
    load = {"kind": kind, "on": "r", "travel": {"speed": 5.0, "from": 4.0, "measured": "horizontal"}}
    load |= {"force": [0, -300.0]} if kind == "force" else {"mass": 30.0}
    frames = frames_of(scenario({"r": line(**ROPE)}, {"p": load}, 1.5, 0.05, gravity=9.81))
    places = np.array([frame.contact_position[0, 0] for frame in frames])
    message = 4.0 + 5.0 * np.array([frame.path for frame in frames])
    # A mass stands on the tip of its kink, which leans as the line does.
    assert np.abs(places - message).max() < (1e-9 if kind == "force" else 0.05)
    assert np.ptp(np.diff(xi(frames))) > 1e-3  # along the line it is not even
    assert imbalance(frames) < 2e-3


@pytest.mark.parametrize("travel", [{"speed": 5.0}, {"kind": "free", "speed": 5.0}], ids=["prescribed", "free"])
def test_what_is_thrown_up_flies_and_lands(travel: dict[str, Any]) -> None:
    push = {"time": [0.0, 0.3, 0.31, 0.36, 0.37], "value": [[0, 0], [0, 0], [0, 2500], [0, 2500], [0, 0]]}
    load = {"kind": "mass", "mass": 20.0, "on": "r", "lift_off": True, "force": push, "travel": {"from": 5.0} | travel}
    rope = line(**ROPE, axial_damping=100.0, drag=1.0)
    frames = frames_of(scenario({"r": rope}, {"p": load}, 1.5, 0.02, gravity=9.81))
    t, flies = (
        np.array([frame.path for frame in frames]),
        np.array([frame.contact_state[0] == IN_AIR for frame in frames]),
    )
    alone = np.flatnonzero(flies & (t > 0.38))
    alone = alone[: int(np.argmax(np.append(np.diff(alone), 2) > 1)) + 1]  # the first flight
    place = np.array([frames[i].contact_position[0] for i in alone])
    assert alone.size > 10
    assert np.abs(np.diff(place[:, 0], 2)).max() < 1e-9
    assert np.abs(np.diff(place[:, 1], 2) + 9.81 * 0.02**2).max() < 1e-9
    assert all(not frames[i].contact_force.any() for i in alone)
    assert frames[-1].contact_state[0] == MOVES
    assert np.diff(xi(frames)[-3:]).mean() == pytest.approx(0.1, rel=1e-9) or "kind" in travel
    assert imbalance(frames) < 5e-3


def test_a_bead_on_a_strongly_damped_rope_slides_where_smaller_steps_say() -> None:
    """Before its end the rope turns around the bead: within a step the damper of that kink is 12 times its spring.

    With the rate of the step before in its place, the bead was thrown back and forth with 4e5 N.
    """
    rope = line(end=[19, 0], tension=None, length=20.0, axial_stiffness=1e6, axial_damping=200.0, elements=200)
    load = {"kind": "mass", "mass": 5.0, "on": "r", "travel": {"kind": "free", "speed": 3.0, "from": 19.52}}
    asked = scenario({"r": rope}, {"p": load}, 0.105, 0.035, gravity=9.81)
    found = [frames_of(asked), frames_of(with_steps_of(asked, 0.3))]
    coarse, fine = (xi(frames)[-1] for frames in found)
    assert coarse == pytest.approx(fine, abs=1e-6)  # second order: a third of 1.65e-5 s leaves 1e-8 m
    assert max(imbalance(frames) for frames in found) < 1e-3


def test_a_soft_contact_is_a_spring_below_the_wheel() -> None:
    """The same vehicle once on contact stiffnesses, once with its wheels as bodies above others without mass."""
    springs = {"s": {"between": ["b", "f"], "stiffness": 4e3, "damping": 50.0}}
    soft = {
        "kind": "vehicle", "on": "s", "bodies": {"b": {"mass": 40.0}}, "springs": springs, "lift_off": True,
        "wheels": {"f": {"mass": 4.0, "contact_stiffness": 5e4}}, "travel": {"speed": 4.0, "from": 2.0},
    }  # fmt: skip
    other = soft | {
        "bodies": {"b": {"mass": 40.0}, "f": {"mass": 4.0}}, "lift_off": False, "wheels": {"w": {"mass": 0.0}},
        "springs": springs | {"c": {"between": ["f", "w"], "stiffness": 5e4}},
    }  # fmt: skip
    string = line(end=[10, 0], tension=5e3, axial_stiffness=1e6, elements=40)
    given = [scenario({"s": string}, {"p": load}, 1.2, 0.02, gravity=9.81) for load in (soft, other)]

    def apart(part: float) -> float:
        runs = [frames_of(with_steps_of(one, part)) for one in given]
        force = np.array([[frame.contact_force[0, 1] for frame in frames] for frames in runs])
        assert force.max() < 0.0  # it presses all the time
        return float(np.abs(force[0] - force[1]).max() / np.abs(force).max())

    assert apart(1.0) < 1e-6


@pytest.mark.parametrize("at_end", ["leave", "stay"])
def test_a_person_who_walks_is_one_force_for_each_step(at_end: str) -> None:
    """Steps of 2 m on 10 m: the fifth would lead beyond the end."""
    keys = {"mass": 70.0, "frequency": 2.0, "step_length": 2.5, "from": 1.0, "at_end": at_end, "on": "s"}
    gait = Footsteps.model_validate({"kind": "footsteps", **keys})
    string = line(end=[10, 0], tension=5e3, axial_stiffness=1e6, elements=40)
    loads: dict[str, Any] = {}
    for step in range(6):
        land, leave = 0.5 * step, 0.5 * (step + 1.0 + gait.overlap)
        place = 1.0 + 2.5 * step
        if place > 10.0:  # beyond the end, or on the support
            break
        t = np.unique(np.append(Footfall(gait, step % 2, 9.81).instants(3.0), [land, leave, 2.0 - 1e-9]))
        force = Footfall(gait, step % 2, 9.81)(t) * ((t >= land) & (t <= leave))[:, None]
        if at_end == "leave":
            force *= (t < 2.0)[:, None]
        travel = {"speed": 0.0, "from": place}
        loads[f"step{step}"] = {
            "kind": "force", "on": "s", "force": {"time": t.tolist(), "value": force.tolist()}, "travel": travel,
        }  # fmt: skip
    walks = frames_of(scenario({"s": string}, {"p": {"kind": "footsteps", **keys}}, 2.8, 0.1, gravity=9.81))
    forces = frames_of(scenario({"s": string}, loads, 2.8, 0.1, gravity=9.81))
    moved = np.abs(walks[-1].position - walks[0].position).max()
    assert moved > 0.02
    if at_end == "stay":
        assert np.nanmax(walks[-1].contact_xi) == pytest.approx(walks[-1].contact_xi[1])
        walks = [frame for frame in walks if frame.path < 2.05]  # then it stands on the support
    apart = max(np.abs(a.position - b.position).max() for a, b in zip(walks, forces, strict=False))
    # Kinks of feet that are taken up straighten within a link's passage of waves, those of forces as they vanish.
    assert apart < 2e-3 * moved


def test_a_force_without_friction_is_held_across_its_line() -> None:
    """On a line that falls by one in four: N is across it, the hold F / 4 up the line."""
    taut = line(start=[0, 5], end=[20, 0], tension=1e6, axial_stiffness=1e8, elements=20)
    load = {"kind": "force", "on": "s", "force": [0, -100.0], "contact": "frictionless"}
    frames = frames_of(scenario({"s": taut}, {"p": load | {"travel": {"speed": 5.0, "from": 4.0}}}, 1.0, 0.1))
    for frame in frames:
        assert frame.hold_force[0] == pytest.approx([-25.0, 0.0], rel=2e-3)
        assert frame.contact_force[0] == pytest.approx([-25.0, -100.0], rel=2e-3)
    assert imbalance(frames) < 1e-3


@pytest.mark.parametrize("damping", [0.0, 100.0])
def test_a_bead_that_rubs_slides_as_with_events_where_waves_are_damped_and_says_so_where_not(damping: float) -> None:
    """Over 1.34 m within 1.5 s; 0.28 m further where waves shake it. At rest links of half a metre are 2 cm off."""
    rope = {
        "start": [0, 0], "end": [20, 0], "length": 22.0, "mass": 0.1, "axial_stiffness": 1e6, "elements": 50,
        "axial_damping": damping,
    }  # fmt: skip
    load = {"kind": "mass", "mass": 10.0, "on": "r", "travel": {"kind": "free", "friction": 0.1, "from": 6.98}}
    run = {"kind": "dynamic", "until": 1.5, "every": 0.5, "start": {"kind": "rest", "with_loads": True}}
    tree = {"loads": {"p": load}, "run": run}
    windy = {"lines": {"r": rope | {"wind_drag": 0.1}}, "wind": {"direction": [1, 0], "speed": 0.0}}
    exact, found = (simulate(Scenario.model_validate(tree | more)) for more in ({"lines": {"r": rope}}, windy))
    away = (found["contact_position"] - exact["contact_position"]).values[:, 0, 0]
    print(away)
    assert ("they shake the contact" in found.attrs["warnings"]) == (damping == 0.0)
    if damping:
        assert np.abs(away - away[0]).max() < 0.02  # measured 0.009
