"""Trains of vehicles: their parts and weights, and their crossings against modes and bodies integrated elsewhere."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
import pytest

import vehicle_routes as routes
from ropewalk.compare.simpler_models import top_of
from ropewalk.decouple import without_feedback
from ropewalk.errors import ScenarioError
from ropewalk.mechanics.multibody_system import static_loads
from ropewalk.model import Axles, Scenario, Train
from ropewalk.model.train_sets import ORDER, axle_loads
from ropewalk.results.line_response import responses
from ropewalk.results.statistics import summary
from ropewalk.results.table import text
from ropewalk.scenario import dump, loads
from ropewalk.simulate import simulate
from train_routes import Bridge

DECK = """\
gravity: 0
lines:
  deck: {start: [0, 0], end: [20, 0], length: 20, mass: 10e3, axial_stiffness: 1e10, elements: 20,
         bending_stiffness: 16.211389e9, drag: 0.6283}
loads:
  train: {kind: train, on: deck, train: ICE 3, travel: {speed: 200 km/h}}
outputs: {places: {midspan: {on: deck, at: 10}}}
run: {kind: dynamic, geometry: linearised, until: crossing, every: 4 ms}
"""
BRIDGE = Bridge(20.0, 10e3, 16.211389e9, 0.6283)
COACH = """\
{length: 18, bodies: {box: {mass: 22e3, inertia: 8e5}, front: {mass: 3e3, inertia: 2.5e3, at: 8}},
 wheels: {one: {mass: 2e3, at: 9.5}, two: {mass: 2e3, at: 6.5}},
 springs: {ahead: {between: [box, front], stiffness: 6e5, damping: 2e4, at: 8},
           behind: {between: [box, next.front], stiffness: 6e5, damping: 2e4, at: -10},
           one: {between: [front, one], stiffness: 2e6, damping: 1e4},
           two: {between: [front, two], stiffness: 2e6, damping: 1e4}}}"""
BOGIE = """\
{length: 3, bodies: {front: {mass: 3e3, inertia: 2.5e3, at: 0.5}},
 wheels: {one: {mass: 2e3, at: 2}, two: {mass: 2e3, at: -1}},
 springs: {one: {between: [front, one], stiffness: 2e6, damping: 1e4},
           two: {between: [front, two], stiffness: 2e6, damping: 1e4}}}"""
ARTICULATED = (
    f"loads.train={{kind: train, on: deck, vehicles: {{coach: {COACH}, bogie: {BOGIE}}}, order: [2 coach, bogie], "
    "travel: {speed: 180 km/h}}"
)


def crossing(*settings: str) -> Any:
    result = simulate(loads(DECK, overrides=settings))
    assert result.attrs["outcome"] == "completed", (result.attrs["advice"], result.attrs["doubts"])
    return result


def midspan(result: Any) -> Any:
    return responses(result)[0]["deck"].at(10.0)["deflection"]


@lru_cache(maxsize=1)
def ice3() -> Any:
    return crossing()


@pytest.mark.parametrize("name", ORDER)
def test_vehicles_by_name_weigh_on_their_axles_as_the_train_of_forces_does(name: str) -> None:
    whole, known = Train(on="deck", train=name, travel={"speed": 1.0}).whole, axle_loads(name)
    assert static_loads(whole) == pytest.approx([force for _, force in known], rel=1e-12)
    assert [-wheel.at for wheel in whole.wheels.values()] == pytest.approx([at for at, _ in known], abs=1e-9)
    mass = sum(body.mass for body in whole.bodies.values()) + sum(wheel.mass for wheel in whole.wheels.values())
    assert sum(force for _, force in known) == pytest.approx(9.81 * mass, rel=1e-12)
    assert np.allclose(np.diff([at for at, _ in known]), np.diff([at for at, _ in known])[::-1]), "the same backwards"


def test_trains_by_name_stand_as_they_are_known() -> None:
    """From the first axle to the last one, m, number of axles and the load of all, kN.

    ICE 3: a Velaro E is 200.32 m long, with 3.51 m from each end to the first axle; 483 t. The others by their tables.
    """
    known = {
        "ICE 3": (193.30, 32, 4736.3), "Shinkansen S300": (395.0, 64, 8625.0), "ICE 2": (350.52, 56, 6936.0),
        "Talgo 350": (356.05, 40, 6800.0),
    }  # fmt: skip
    for name, (length, axles, load) in known.items():
        train = Axles(on="deck", train=name, travel={"speed": 1.0})
        assert train.length == pytest.approx(length)
        assert len(train.axles) == axles
        assert sum(force for _, force in train.axles) == pytest.approx(load * 1e3, rel=1e-4)


def test_a_train_of_ten_coordinates_a_vehicle_crosses_as_it_does_over_modes() -> None:
    """Deflection and contact forces of an ICE 3, with 10, 20 and 40 links: second order of the largest deflection.

    At all times it is between the first and the second order, for each wheel rolls on over a kink. Such blows ring in
    modes that neither route has: of the contact forces 2 % at most, 0.6 % rms, on any mesh.
    """
    parts = routes.named("ICE 3")
    speed = 200.0 / 3.6
    time, known, forces, bodies = routes.crossing(parts, BRIDGE, speed, 213.3 / speed)
    missed, over = [], []
    for elements in (10, 20, 40):
        result = ice3() if elements == 20 else crossing(f"lines.deck.elements={elements}")
        here = np.interp(result.time.values, time, known)
        missed.append(np.abs(midspan(result) - here).max() / known.max())
        over.append(midspan(result).max() / known.max() - 1.0)
    assert missed[1] < 0.01, missed
    assert missed[2] < 0.5 * missed[1] < 0.2 * missed[0], missed
    assert math.log2(over[0] / over[1]) > 1.8, over
    assert abs(over[2]) < 1e-3, over
    result = ice3()
    place = speed * result.time.values[:, None] - np.array(parts.wheels)[:, 1]
    inner = (place > 1.0) & (place < 19.0)
    frames = np.minimum(np.rint(result.time.values / 1e-3).astype(int), time.size - 1)
    found = -result.contact_force.values[..., -1]
    static = np.array([force for _, force in axle_loads("ICE 3")])
    off = ((found - forces[frames]) / static)[inner]
    assert np.abs(off).max() < 0.025
    assert np.sqrt(np.mean(off**2)) < 7e-3
    largest = summary(result)["trains"]["train"]["acceleration"]
    assert largest["value"] == pytest.approx(np.abs(bodies[:, ::3]).max(), rel=0.02)
    assert largest["of"].endswith(".body")


def test_wheels_come_with_their_static_force_and_energy_is_kept() -> None:
    result = ice3()
    found, static = -result.contact_force.values[..., -1], [force for _, force in axle_loads("ICE 3")]
    on = np.isfinite(found)
    assert not on[0, 1:].any(), "all but the first wheel begin before the deck"
    assert not on[-1, :-1].any(), "all have left, but the last one, which is at the end"
    calm = crossing("lines.deck.bending_stiffness=1e15", "lines.deck.elements=8", "run.until=0.5 s")  # a rigid deck
    pressing = -calm.contact_force.values[..., -1]
    known = np.broadcast_to(static, pressing.shape)
    assert np.allclose(pressing[np.isfinite(pressing)], known[np.isfinite(pressing)], rtol=2e-3)
    audit = summary(result)["energy"]["largest_imbalance"]
    assert audit["relative"] < 1e-3


def test_vehicles_calm_a_bridge_in_resonance() -> None:
    """At v = f D, 5 Hz * 24.775 m, forces swing the deck by 35.5 mm; vehicles take energy from it and load it."""
    speed = 5.0 * 24.775
    forces = crossing("loads.train.kind=axles", f"loads.train.travel.speed={speed} m/s")
    sprung = crossing(f"loads.train.travel.speed={speed} m/s")
    known = routes.crossing(routes.named("ICE 3"), BRIDGE, speed, 213.3 / speed)[1]
    assert midspan(sprung).max() == pytest.approx(known.max(), rel=0.01)
    assert 0.65 < midspan(sprung).max() / midspan(forces).max() < 0.8


def test_coaches_that_share_a_bogie_cross_as_they_do_over_modes() -> None:
    speed = 50.0
    result = crossing(ARTICULATED)
    parts = routes.articulated(2, 18.0, 8.0, (22e3, 8e5), (3e3, 2.5e3), 2e3, (2e6, 1e4), (6e5, 2e4))
    time, known, *_ = routes.crossing(parts, BRIDGE, speed, 59.0 / speed)
    assert np.abs(midspan(result) - np.interp(result.time.values, time, known)).max() < 0.012 * known.max()
    train = loads(DECK, overrides=[ARTICULATED]).loads["train"]
    assert isinstance(train, Train)
    own = static_loads(train.whole)
    end = 9.81 * (22e3 * 10.0 / 18.0 + 3e3 + 4e3) / 2.0, 9.81 * (22e3 * 8.0 / 18.0 + 3e3 + 4e3) / 2.0
    assert own[:2] == pytest.approx([end[0]] * 2)
    assert own[-2:] == pytest.approx([end[1]] * 2)
    assert sum(own) == pytest.approx(9.81 * (2 * 22e3 + 3 * 3e3 + 6 * 2e3))
    assert list(train.sections("train")) == ["train"], "all of it is joined"
    assert [name for name in result["body"].values.tolist() if name.endswith("box")] == ["train.1.box", "train.2.box"]


def test_a_train_is_told_as_one_load() -> None:
    result = ice3()
    assert result["load"].values.tolist()[:5] == [f"train.1.axle-{k}" for k in range(1, 5)] + ["train.2.axle-1"]
    found = summary(result)
    assert not found["contacts"], "no statistics for each of its axles"
    train = found["trains"]["train"]
    assert train["axles"] == 32
    assert train["least_force"]["value"] < 152e3 < train["largest_force"]["value"]
    pressing, place = -result.contact_force.values[..., -1], result.contact_xi.values
    with np.errstate(invalid="ignore"):
        pressing[(place < 1.0) | (place > 19.0)] = np.nan  # where links spread the blows of the kinks at the ends
    static = np.array([force for _, force in axle_loads("ICE 3")])
    assert train["unloading"]["value"] == pytest.approx(np.nanmax(1.0 - pressing / static))
    told = text(found)
    assert told.count("Train train") == 1
    assert "largest unloading" in told


def test_a_train_on_an_overhead_line_has_a_summary() -> None:
    springs = {name: {"between": ["box", name], "stiffness": 1652, "damping": 12} for name in ("front", "rear")}
    car = {"length": 1.2, "bodies": {"box": {"mass": 3, "inertia": 0.9}}, "springs": springs,
           "wheels": {"front": {"at": 0.3, "mass": 0.7}, "rear": {"at": -0.3, "mass": 0.7}}}  # fmt: skip
    wires = {"spans": {"count": 3, "length": 32}, "droppers": {"per_span": 3}, "element": 2, "analysed_spans": [2, 2],
             "contact_wire": {"drag": 0.05}, "messenger_wire": {"drag": 0.05}}  # fmt: skip
    train = {"kind": "train", "vehicles": {"car": car}, "order": ["2 car"], "on": "line",
             "travel": {"speed": 30, "from": 30}}  # fmt: skip
    run = {"kind": "linear", "until": 0.1, "every": 0.02}
    tree = {"overhead_lines": {"line": wires}, "loads": {"train": train}, "run": run}
    found = summary(simulate(Scenario.model_validate(tree)))["trains"]["train"]
    assert found["axles"] == 4
    assert 0.0 < found["largest_force"]["value"] < 100.0


def test_a_train_goes_either_way_and_starts_anywhere() -> None:
    """Backwards from the end; and a file that is written and read again is the same."""
    backwards = crossing("loads.train.travel={speed: -200 km/h, from: 20 m}")
    assert np.abs(midspan(backwards) - midspan(ice3())).max() < 1e-9
    scenario = loads(DECK, overrides=[ARTICULATED])
    assert loads(dump(scenario), "again.yaml") == scenario
    later = loads(DECK, overrides=["loads.train.travel.from=-50 m"])
    assert later.run.until == pytest.approx((20.0 + 50.0 + 193.3) * 3.6 / 200.0)


def test_a_vehicle_that_begins_before_the_line_is_one_whose_places_are_behind() -> None:
    """A half-car from level ground: `from: -5 m`, or wheels at negative places of a vehicle that starts at 0."""
    car = """loads.train={{kind: vehicle, on: deck, gravity: 9.81 m/s^2,
      bodies: {{box: {{mass: 1e4, inertia: 5e4, at: {0}}}}},
      wheels: {{front: {{mass: 900, at: {1}}}, rear: {{mass: 900, at: {2}}}}},
      springs: {{f: {{between: [box, front], stiffness: 6e5, damping: 1e4}},
                r: {{between: [box, rear], stiffness: 6e5, damping: 1e4}}}},
      travel: {{speed: 25 m/s, from: {3}, at_end: leave}}}}"""
    here = crossing(car.format(0.0, 2.5, -2.5, -5.0), "run.until=crossing")
    there = crossing(car.format(-5.0, -2.5, -7.5, 0.0), "run.until=crossing")
    assert np.array_equal(midspan(here), midspan(there))
    parts = routes.Parts(
        [(1e4, 5e4, 2.5)], [(900.0, 0.0), (900.0, 5.0)], [(0, -1, 6e5, 1e4, 0.0), (0, -2, 6e5, 1e4, 5.0)]
    )
    time, known, *_ = routes.crossing(parts, BRIDGE, 25.0, 1.0)
    begun = here.time.values - 0.1  # its front wheel comes to the deck after 2.5 m
    inside = (begun >= 0.0) & (begun <= 1.0)
    off = midspan(here)[inside] - np.interp(begun[inside], time, known)
    assert np.abs(off).max() < 0.01 * known.max()  # 20 links: 0.8 %
    pressing = -here.contact_force.values[inside, :, -1]
    assert pressing[np.isfinite(pressing[:, 0]), 0][0] == pytest.approx(9.81 * 5900.0, rel=1e-3)


MISTAKES = {
    "both": ("loads.train.order=[coach]", "loads.train.order", "train ICE 3 has its own vehicles"),
    "neither": ("loads.train.train=null", "loads.train.vehicles", "is required without train"),
    "order": (ARTICULATED.replace("2 coach", "2 coahc"), "loads.train.order.0", "no such vehicle"),
    "many": (ARTICULATED.replace("2 coach", "300 coach"), "loads.train.order", "has 301 vehicles"),
    "last": (
        ARTICULATED.replace(", bogie], travel", "], travel"), "loads.train.vehicles.coach.springs.behind.between",
        "no vehicle behind it",
    ),
    "next": (
        ARTICULATED.replace("next.front", "next.frnt"), "loads.train.vehicles.coach.springs.behind.between",
        "has no such body",
    ),
    "turns": (
        "loads.train.travel.speed={time: [0, 1], value: [10, -10]}", "loads.train.travel.speed", "not change its sign",
    ),
    "gone": ("loads.train.travel.from=50 m", "loads.train.travel.from", "has left deck before it begins"),
}  # fmt: skip


@pytest.mark.parametrize("which", MISTAKES)
def test_mistakes_are_told_with_their_remedies(which: str) -> None:
    setting, key, wrong = MISTAKES[which]
    with pytest.raises(ScenarioError) as error:
        loads(DECK, overrides=[setting])
    found = {problem.key: problem for problem in error.value.problems}
    assert key in found, found
    assert wrong in str(found[key])
    assert found[key].remedy
    assert len(error.value.problems) == 1, error.value.problems


def test_a_vehicle_before_the_line_leaves_it_at_the_end() -> None:
    mass = "loads.train={kind: mass, on: deck, mass: 100 kg, travel: {speed: 10 m/s, from: -5 m, at_end: leave}}"
    for setting, remedy in ((mass, "start at least 0 m"), (mass.replace("leave", "refuse"), "start at least 0 m")):
        with pytest.raises(ScenarioError, match=remedy):
            loads(DECK, overrides=[setting])


def test_what_does_not_know_trains_of_vehicles_says_so() -> None:
    scenario = loads(DECK)
    for ask in (without_feedback, top_of):
        with pytest.raises(ScenarioError, match="kind: axles"):
            ask(scenario)
