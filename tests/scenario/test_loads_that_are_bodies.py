"""Loads with a mass, a gait or a will of their own: what is written is meant, every mistake has its sentence."""

from __future__ import annotations

import json
import math
import warnings
from pathlib import Path
from typing import Any

import pytest
from pydantic import TypeAdapter

import ropewalk
from ropewalk.errors import ScenarioError
from ropewalk.model import AnyLoad, Load, Scenario
from ropewalk.model.parts import Parts
from ropewalk.model.places import margin
from ropewalk.results.contract import scenario_text
from ropewalk.scenario import dump, json_schema, loads

FILE = """\
gravity: 9.81
lines:
  rope: {start: [0, 0], end: [40, 0], length: 40 m, mass: 60 g/m, axial_stiffness: 60 kN, elements: 40}
loads:
  a: LOAD
run: RUN
"""
DYNAMIC = "{kind: dynamic, until: 2 s}"
MASS = "kind: mass, on: rope, mass: 80"
CAR = (
    "kind: vehicle, on: rope, travel: {speed: 3, from: 5}, wheels: {front: {at: 1}, rear: {at: -1, mass: 5}}, "
    "bodies: {box: {mass: 100, inertia: 30}}, springs: {f: {between: [box, front], stiffness: 9 kN/m, damping: 30}, "
    "r: {between: [rear, box], stiffness: 9 kN/m}}"
)
PAIR = (
    "kind: matrices, on: rope, travel: {speed: 3, from: 5}, coordinates: [box, wheel], mass: [[100, 0], [0, 5]], "
    "stiffness: [[9e3, -9e3], [-9e3, 9e3]], wheels: {w: {coordinate: wheel}}"
)
RIGHT = {
    "a mass that is carried along": f"{MASS}, travel: {{speed: 3}}",
    "a mass without tension jump": f"{MASS}, travel: {{speed: 3, margin: 20 cm}}, contact: frictionless, side: below, "
    "lift_off: true",
    "a mass that slides": f"{MASS}, travel: {{kind: free, from: 2, speed: -1, friction: 0.1, friction_model: block}}",
    "a mass that is driven": f"{MASS}, travel: {{kind: free, rolling: 1 %, viscous: 3, drive: {{time: [0, 1], "
    "value: [0, 5 N]}, driver: {speed: 3, force: 20}, brake: {force: 300, within: 5 m, at: both}, margin: 2 m}",
    "a mass that is pushed": f"{MASS}, travel: {{speed: 3}}, force: {{time: [0], value: [[1, 2, 3]]}}, air_drag: 0.3",
    "an oscillator": "kind: oscillator, on: rope, mass: 80, stiffness: [1 kN/m, 2 kN/m], damping: 3, "
    "travel: {speed: 1}",
    "an oscillator that may hop": "kind: oscillator, on: rope, mass: 80, stiffness: 1e4, wheel_mass: 2, "
    "lift_off: true, contact_stiffness: 1 MN/m, travel: {speed: 1}",
    "a trolley that swings": "kind: trolley, on: rope, mass: 80, payload: {mass: 300, length: 3, swing: 30°}, "
    "travel: {kind: free, at_end: leave}",
    "a trolley whose payload falls": "kind: trolley, on: rope, mass: 1, payload: {mass: 80, length: 3, at: [0, 0, 2], "
    "stiffness: 1 kN/m, damping: 3, air_drag: 0.2}, travel: {speed: 0, from: 20}",
    "a carriage": "kind: carriage, on: rope, mass: 1.4 t, wheel_mass: 80, rockers: [0.8 m], haul: {to: end, speed: -2, "
    "axial_stiffness: 20 MN}, cabin: {mass: 660, hanger: 5 m, inertia: 600}, travel: {kind: free, from: 20}",
    "a vehicle": CAR,
    "matrices": PAIR,
    "matrices with weights": f"{PAIR}, damping: [[1, 0], [0, 0]], weight: [981 N, 49.05 N], lift_off: true",
    "matrices with a part that spins": f"{PAIR}, damping: [[1, 5], [-5, 1]]",
    "footsteps": "kind: footsteps, on: rope, mass: 70, at_end: leave",
    "footsteps of one's own": "kind: footsteps, on: rope, mass: 70, from: 20, towards: start, overlap: 0.3, "
    "model: [{amplitude: 0.4}, {amplitude: 10 %, phase: 90 deg}]",
    "a walker": "kind: walker, on: rope",
    "a walker who tires": "kind: walker, on: rope, from: 3, push_off: 0.5, angle_of_attack: 68 deg, at_end: stay",
    "a stepper": 'kind: stepper, on: rope, model: "my/cat.py:Cat", options: {legs: 4, on: [1.5, {tail: 1e-7, x: {}}], '
    "tame: true, name: Tom}, every: 2 ms, from: 3",
    "a stepper that takes turns": 'kind: stepper, on: rope, model: "a:b", exchange: {scheme: iterated, order: 1, '
    "stiffness: 1 kN/m, damping: 3, tolerance: 1e-6, iterations: 9, warn: 0.1}",
    "an FMU": "kind: fmu, on: rope, file: cart.fmu, contacts: {w: {force: F, height: z}}, travel: {speed: 3}",
    "an FMU with all keys": "kind: fmu, on: rope, file: cart.fmu, contacts: {f: {at: 1, force: F.1, force_along: X, "
    "height: z, velocity: v, place: s, height_from: zero, force_factor: 1, motion_factor: -1}, r: {at: -1, gives: "
    "motion, force: G, height: y}}, travel: {speed: 3, measured: horizontal, from: 2, at_end: stay}, parameters: "
    "{m: 3, k.a: 1.5, on: true, name: x}, start_values: {z: 0}, every: 2 ms, exchange: {stiffness: 1 MN/m}, isolated: "
    "true, patience: 5 s",
}


def scenario_of(load: str, run: str = DYNAMIC) -> Scenario:
    return loads(FILE.replace("LOAD", f"{{{load}}}").replace("RUN", run), "case.yaml")


def load_of(load: str) -> Any:
    return scenario_of(load).loads["a"]


@pytest.mark.parametrize("load", RIGHT.values(), ids=RIGHT)
def test_what_is_written_loads_again_exactly(load: str) -> None:
    scenario = scenario_of(load)
    assert loads(dump(scenario)) == scenario
    assert loads(scenario_text(scenario)) == scenario  # as it stands in a result


def test_every_kind_of_load_is_among_them() -> None:
    kinds = {load.split("kind: ")[1].split(",")[0] for load in RIGHT.values()}
    written = json_schema()["properties"]["loads"]["additionalProperties"]["oneOf"]
    assert len(kinds | {"force", "axles", "train", "crowd", "pantograph"}) == len(written)


REFUSED = [
    (
        f"{MASS}, travel: {{speed: 3, measured: arc}}",
        "travel.measured",
        "a mass that follows the arc length is unstable",
    ),
    # a travel
    (f"{MASS}, travel: {{friction: 0.1}}", "travel.kind", "is required; add kind: free"),
    (f"{MASS}, travel: {{knd: free}}", "travel.knd", "did you mean kind"),
    (f"{MASS}, travel: {{kind: fre}}", "travel.kind", "did you mean free"),
    (f"{MASS}, travel: {{}}", "travel.speed", "add speed"),
    (f"{MASS}, travel: {{speed: 1, mesured: arc}}", "travel.mesured", "did you mean measured"),
    (f"{MASS}, travel: fast", "travel", "prescribed | free"),
    (f"{MASS}, travel: {{kind: free, from: 41}}", "travel.from", "at most 40 m"),
    (f"{MASS}, travel: {{kind: free, driver: {{speed: 3}}}}", "travel.driver.force", "the most it can push"),
    (f"{MASS}, travel: {{kind: free, drive: [0, 1]}}", "travel.drive", "expected a force"),
    (f"{MASS}, travel: {{kind: free, drive: {{time: [1, 0], value: [1, 1]}}}}", "travel.drive.time.1", "sort"),
    (f"{MASS}, travel: {{kind: free, brake: {{force: 3, within: 1, at: nowhere}}}}", "travel.brake.at", "start, end"),
    ("kind: force, on: rope, force: [0, -1], travel: {kind: free, friction: 1}", "travel.kind", "without mass cannot"),
    # its ends: a quarter of a link of 1 m before the support
    (f"{MASS}, travel: {{speed: 20}}", "travel.speed", "write run.until: 1.987 s"),
    (f"{MASS}, travel: {{speed: -20, from: 20}}", "travel.speed", "start of rope at 0.9875 s"),
    (f"{MASS}, travel: {{speed: 20, margin: 4}}", "travel.speed", "write run.until: 1.8 s"),
    (f"{MASS}, travel: {{speed: 1, margin: 20}}", "travel.margin", "below 20 m"),
    # masses, oscillators, trolleys
    (f"{MASS}, travel: {{kind: free}}, contact: frictionless", "contact", "travel.friction"),
    (f"{MASS}, travel: {{speed: 1}}, contact: coulomb", "contact", "clamped, frictionless"),
    ("kind: mass, on: rope, mass: 0, travel: {speed: 1}", "mass", "above 0 kg"),
    ("kind: oscillator, on: rope, mass: 8, stiffness: 9, travel: {kind: free}", "wheel_mass", "add wheel_mass"),
    (
        "kind: oscillator, on: rope, mass: 8, stiffness: 9, travel: {speed: 1}, contact_stiffness: 9",
        "contact_stiffness",
        "write lift_off: true",
    ),
    (
        "kind: trolley, on: rope, mass: 8, travel: {speed: 1}, payload: {mass: 3, length: 3, swing: 1, at: [1, 1]}",
        "payload.swing",
        "not both",
    ),
    (
        "kind: trolley, on: rope, mass: 8, travel: {speed: 1}, payload: {mass: 3, length: 3, at: [1, -7]}",
        "payload.at",
        "check length and at",
    ),
    # vehicles
    (CAR.replace("[box, front]", "[bix, front]"), "springs.f.between.0", "did you mean box"),
    (CAR.replace("[box, front]", "box"), "springs.f.between", "write [body, wheel]"),
    (CAR.replace("[box, front]", "[box, front, rear]"), "springs.f.between", "expected two names"),
    (CAR.replace("[box, front]", "[rear, front]"), "springs.f.between", "between two wheels"),
    (CAR.replace("[box, front]", "[box, box]").replace("at: 1}", "at: 1, mass: 1}"), "springs.f.between", "box twice"),
    (CAR.replace("bodies: {", "bodies: {lid: {mass: 1}, "), "bodies.lid", "name it in a spring"),
    (CAR.replace(", inertia: 30", ""), "bodies.box.inertia", "no moment of inertia"),
    (CAR.replace("between: [", "at: 0, between: ["), "bodies.box.inertia", "no pitch stiffness"),
    (CAR.replace("wheels: {", "wheels: {mid: {}, "), "wheels.mid", "neither mass nor spring"),
    (CAR.replace("at: -1", "at: 1"), "wheels.rear.at", "same place as wheel front"),
    (CAR.replace("wheels: {", "wheels: {box: {mass: 1}, "), "wheels.box", "same name"),
    (CAR.replace("at: 1}", "at: 1, contact_stiffness: 9}"), "wheels.front.contact_stiffness", "lift_off: true"),
    (CAR.replace("from: 5", "from: 0.5"), "travel.from", "wheel rear would start before the start of rope"),
    (CAR.replace("from: 5", "from: 39.5"), "travel.from", "start at most 39 m"),
    (CAR.replace("at: 1}", "at: 70}"), "travel.from", "check the places (at)"),
    (CAR.replace("speed: 3", "speed: 17"), "travel.speed", "write run.until: 1.985 s"),  # 33.75 m for the front wheel
    (CAR.replace("speed: 3", "kind: free"), "travel.kind", "is prescribed"),
    # matrices
    (PAIR.replace("[0, 5]", "[0]"), "mass.1", "2 numbers in each row"),
    (PAIR.replace("[[100, 0], [0, 5]]", "[[100, 0]]"), "mass", "2 rows of 2"),
    (PAIR.replace("[0, 5]", "[1, 5]"), "mass.1.0", "not symmetric"),
    (PAIR.replace("[-9e3, 9e3]", "[9e3, 9e3]"), "stiffness.1.0", "the stiffness matrix is not symmetric"),
    (PAIR.replace("[0, 5]", "[0, -5]"), "mass.1.1", "check its signs"),
    (PAIR.replace("[0, 5]", "[0, 5 N]"), "mass.1.1", "expected a plain number"),
    (PAIR.replace("[0, 5]", "5"), "mass.1", "write [[a, b], [c, d]]"),
    (PAIR.replace("coordinate: wheel", "coordinate: weel"), "wheels.w.coordinate", "did you mean wheel"),
    (PAIR.replace("wheels: {", "wheels: {v: {at: 1, coordinate: wheel}, "), "wheels.w.coordinate", "its own coord"),
    (PAIR.replace("wheels: {", "wheels: {v: {coordinate: box}, "), "wheels.w.at", "same place as wheel v"),
    (PAIR.replace("[box, wheel]", "[wheel, wheel]"), "coordinates.1", "stands twice"),
    (f"{PAIR}, weight: [1]", "weight", "write 2 weights"),
    # who walks
    ("kind: footsteps, on: rope, mass: 70, model: yung", "model", "did you mean young"),
    ("kind: footsteps, on: rope, mass: 70, model: xx", "model", "or a list of {amplitude, phase}"),
    ("kind: footsteps, on: rope, mass: 70, model: 3", "model", "expected a model of the force"),
    ("kind: footsteps, on: rope, mass: 70, model: [{amplitude: 1, phas: 1}]", "model.0.phas", "did you mean phase"),
    ("kind: footsteps, on: rope, mass: 70, model: [{}]", "model.0.amplitude", "as part of the weight"),
    ("kind: footsteps, on: rope, mass: 70, frequency: 4 Hz", "frequency", "1 to 2.8 steps"),
    ("kind: footsteps, on: rope, mass: 70, frequency: 2 s", "frequency", "expected a frequency"),
    ("kind: footsteps, on: rope, mass: 70, overlap: 60 %", "overlap", "write 0 to 0.5"),
    ("kind: footsteps, on: rope, mass: 70, from: 39", "from", "write run.until: 1 s"),  # foot 2 at 40.4 m
    ("kind: footsteps, on: rope, mass: 70, from: 1, towards: start", "from", "beyond the start of rope at 1 s"),
    ("kind: footsteps, on: rope, mass: 70, from: 41", "from", "at most 40 m"),
    ("kind: walker, on: rope, angle_of_attack: 95 deg", "angle_of_attack", "69 deg"),
    ("kind: walker, on: rop", "on", "did you mean rope"),
    # models of one's own
    ("kind: stepper, on: rope, model: cat", "model", "write module:name"),
    ("kind: stepper, on: rope, model: 3", "model", "expected a model"),
    ('kind: stepper, on: rope, model: "a:b", options: [1]', "options", "write  name: value"),
    ('kind: stepper, on: rope, model: "a:b", options: {"a b": 1}', "options.a b", "letters, digits and _"),
    ('kind: stepper, on: rope, model: "a:b", options: {a: [1, .inf]}', "options.a.1", "stay below 1e+30"),
]


@pytest.mark.parametrize(("load", "key", "says"), REFUSED, ids=[f"{key}: {says}" for _, key, says in REFUSED])
def test_the_mistake_has_one_problem_with_its_place_and_remedy(load: str, key: str, says: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        scenario_of(load)
    assert [problem.key for problem in caught.value.problems] == [f"loads.a.{key}"]
    row = str(caught.value)
    assert row.startswith("case.yaml:5: ")
    assert says in row
    assert caught.value.problems[0].remedy


@pytest.mark.parametrize("run", ["{kind: quasistatic}", "{kind: equilibrium}"])
@pytest.mark.parametrize("load", [RIGHT["a walker"]])
def test_only_a_run_in_time_knows_people(load: str, run: str) -> None:
    with pytest.raises(
        ScenarioError,
        match=r"loads\.a\.kind: is not implemented for equilibria and quasi-static runs of ropes, .*; ask",
    ):
        scenario_of(load, run)


@pytest.mark.parametrize("run", [DYNAMIC, "{kind: quasistatic}", "{kind: linear, until: 1}"])
def test_a_force_goes_on_without_margin(run: str) -> None:
    # 20 m/s for 2 s from 0: exactly to the end of 40 m
    assert scenario_of("kind: force, on: rope, force: [0, -1], travel: {speed: 20}", run)


def test_nobody_walks_and_no_rope_is_measured_by_a_weight_without_gravity() -> None:
    taut = FILE.replace("gravity: 9.81", "gravity: 0").replace("RUN", DYNAMIC)
    for load, key in ((RIGHT["a walker"], "kind"), (RIGHT["footsteps"], "kind"), (RIGHT["a trolley that swings"], "")):
        with pytest.raises(ScenarioError) as caught:
            loads(taut.replace("LOAD", f"{{{load}}}"))
        assert [p.key for p in caught.value.problems] == [f"loads.a.{key or 'payload.stiffness'}"]
    assert loads(taut.replace("LOAD", f"{{{RIGHT['a trolley whose payload falls']}}}"))


MEETINGS = [
    # the front wheel, 1 m ahead of 5 m, catches up at 2 m/s with the load at 8 m: after 1 s, at 9 m
    (CAR, "kind: force, on: rope, force: [0, -1], travel: {speed: 1, from: 8}", "travel.speed", "at 1 s, 9 m along"),
    # the rear wheel runs away from what follows it
    (CAR, "kind: force, on: rope, force: [0, -1], travel: {speed: 1, from: 3}", "", ""),
    (CAR, f"{MASS}, travel: {{kind: free, from: 6}}", "travel.from", "add the forces up"),
    (f"{MASS}, travel: {{kind: free, from: 6}}", CAR, "travel.from", "wheel front starts at the same place as load a"),
    (CAR, f"{MASS}, travel: {{kind: free, from: 8, speed: -3}}", "", ""),  # where it will go is not known
    (CAR, "kind: walker, on: rope, from: 4", "from", "same place as load a"),
]


@pytest.mark.parametrize(("first", "second", "key", "says"), MEETINGS)
def test_loads_do_not_pass_each_other_as_far_as_that_is_known(first: str, second: str, key: str, says: str) -> None:
    text = FILE.replace("LOAD", f"{{{first}}}\n  b: {{{second}}}").replace("RUN", DYNAMIC)
    if not key:
        assert len(loads(text).loads) == 2
        return
    with pytest.raises(ScenarioError, match=f"loads.b.{key}: .*") as caught:
        loads(text)
    assert len(caught.value.problems) == 1
    assert says in str(caught.value)


def test_every_load_says_where_it_stands() -> None:
    places = {name: load_of(text).starts() for name, text in RIGHT.items()}
    assert [tuple(place) for place in places["a vehicle"]] == [("front", "material", 6.0), ("rear", "material", 4.0)]
    assert [tuple(place) for place in places["matrices"]] == [("w", "material", 5.0)]
    assert [tuple(place) for place in places["a walker who tires"]] == [("", "material", 3.0)]
    assert [tuple(place) for place in places["an FMU with all keys"]] == [
        ("f", "horizontal", 3.0),
        ("r", "horizontal", 1.0),
    ]
    several = ("a carriage", "a vehicle", "an FMU with all keys")
    assert all(len(found) == 1 for name, found in places.items() if name not in several)


def test_the_line_ends_for_a_mass_a_quarter_of_a_link_before_its_support() -> None:
    def of(load: str) -> float:
        scenario = scenario_of(load)
        return margin(scenario.loads["a"], scenario.lines["rope"])

    assert of(RIGHT["a mass that is carried along"]) == 0.25
    assert of(RIGHT["a mass that is driven"]) == 2.0
    assert of("kind: force, on: rope, force: [0, -1], travel: {speed: 3}") == 0.0
    assert of(RIGHT["a walker"]) == 0.0


def test_a_spring_stands_where_it_says_or_at_its_wheel_or_at_the_first_body() -> None:
    lid = "springs: {l: {between: [lid, box], stiffness: 1}, m: {between: [box, lid], stiffness: 1, at: 8}, "
    car = load_of(CAR.replace("springs: {", lid).replace("bodies: {", "bodies: {lid: {mass: 1, at: 7, inertia: 2}, "))
    assert {name: car.place_of(spring) for name, spring in car.springs.items()} == {"l": 7, "m": 8, "f": 1, "r": -1}


def test_bodies_that_carry_only_each_other_are_found() -> None:
    loose = CAR.replace("bodies: {", "bodies: {lid: {mass: 1}, pin: {mass: 1}, ")
    with pytest.raises(ScenarioError, match="it is not connected to a wheel by springs") as caught:
        scenario_of(loose.replace("springs: {", "springs: {l: {between: [lid, pin], stiffness: 1}, "))
    assert [problem.key for problem in caught.value.problems] == ["loads.a.bodies.lid", "loads.a.bodies.pin"]


def test_what_leaves_the_plane_is_seen_in_every_load() -> None:
    plane = {name: scenario_of(text).is_plane for name, text in RIGHT.items()}
    assert [name for name, flat in plane.items() if not flat] == ["a mass that is pushed"]
    falls = RIGHT["a trolley whose payload falls"].replace("[0, 0, 2]", "[0, 1, 2]")
    assert not scenario_of(falls).is_plane
    assert not scenario_of("kind: force, on: rope, force: [0, 1, -1], travel: {speed: 1}").is_plane


def test_the_published_amplitudes_are_those_of_their_formulas() -> None:
    def amplitudes(words: str) -> list[float]:
        return [
            h.amplitude for h in load_of(f"kind: footsteps, on: rope, mass: 70, at_end: leave, {words}").harmonics()
        ]

    # Young at 2 Hz: 0.41 * 1.05, 0.069 + 0.0056 * 4, 0.033 + 0.0064 * 6, 0.013 + 0.0065 * 8 (rounding only)
    assert amplitudes("model: young") == pytest.approx([0.4305, 0.0914, 0.0714, 0.065], rel=1e-12)
    assert amplitudes("frequency: 2.6 Hz")[0] == 0.56
    assert amplitudes("model: bachmann, frequency: 2.2 Hz") == pytest.approx([0.45, 0.1, 0.1], rel=1e-12)
    assert amplitudes("model: bachmann, frequency: 1.5 Hz")[0] == 0.4
    assert amplitudes("model: bachmann, frequency: 3 Hz")[0] == 0.5
    own = load_of(RIGHT["footsteps of one's own"]).harmonics()
    assert [(h.amplitude, h.phase) for h in own] == [(0.4, 0.0), (0.1, pytest.approx(math.pi / 2, rel=1e-15))]


def test_an_angle_may_be_in_degrees() -> None:
    assert load_of(RIGHT["a trolley that swings"]).payload.swing == pytest.approx(math.pi / 6, rel=1e-15)
    assert load_of(RIGHT["a walker"]).angle_of_attack == math.radians(69.0)


class Cat:
    """A model that can step."""

    def step(self) -> None:
        """Do nothing."""


def stepper(**given: Any) -> ropewalk.Stepper:
    return ropewalk.Stepper(on="rope", **given)


def test_a_model_may_be_an_object_that_no_file_can_hold() -> None:
    cat = Cat()
    drive = ropewalk.FreeTravel(start=5.0, drive=lambda t: t, driver=ropewalk.Driver(speed=lambda t: 1.0, force=2.0))
    mass = ropewalk.MovingMass(on="rope", mass=1.0, travel=drive)
    scenario = scenario_of(CAR.replace("from: 5", "from: 20"))
    scenario = Scenario(lines=scenario.lines, loads={"cat": stepper(model=cat), "mass": mass})
    assert scenario.loads["cat"].model is cat  # type: ignore[union-attr]
    with pytest.raises(ScenarioError) as caught:
        dump(scenario)
    assert [problem.key for problem in caught.value.problems] == [
        "loads.cat.model",
        "loads.mass.travel.drive",
        "loads.mass.travel.driver.speed",
    ]
    assert "write its class or function as module:name" in str(caught.value)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert "test_loads_that_are_bodies.Cat" in scenario_text(scenario)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"model": Cat}, "make one: Cat"),
        ({"model": object()}, "an object that has step"),
        ({"model": Cat(), "options": {"legs": 4}}, "an object exists already"),
        ({"model": "cat:Cat", "options": {"friend": Cat()}}, "a file cannot hold this"),
    ],
)
def test_what_is_no_model_is_refused(given: dict[str, Any], says: str) -> None:
    with pytest.raises(ScenarioError, match=says):
        stepper(**given)


def test_arrays_are_taken_as_matrices_and_tuples_as_lists() -> None:
    np = pytest.importorskip("numpy")
    wheels = {"w": ropewalk.MatrixWheel(coordinate="a")}
    travel = ropewalk.Travel(speed=1.0)
    given = ropewalk.Matrices(
        on="rope", coordinates=("a", "b"), mass=np.eye(2), stiffness=np.zeros((2, 2)), wheels=wheels, travel=travel
    )
    assert given.mass == ((1.0, 0.0), (0.0, 1.0))
    assert stepper(model="a:b", options={"x": (1, np.float64(2.0), np.arange(2))}).options == {"x": [1, 2.0, [0, 1]]}


def test_a_load_that_is_wrong_keeps_the_others_from_nothing() -> None:
    bad: AnyLoad | None = None
    right: AnyLoad = TypeAdapter(Load).validate_python(json.loads('{"kind": "walker", "on": "rope"}'))
    line = scenario_of(CAR).lines["rope"]
    parts = Parts({"rope": line}, {"bad": bad, "good": right}, None, 9.81, {"bad": "rope", "good": "rope"})
    assert [name for name, *_ in parts.complete()] == ["good"]
    assert parts.loads_on("rope") == ["bad", "good"]


def test_the_loads_of_the_page_load() -> None:
    page = (Path(__file__).parents[2] / "docs" / "file" / "loads.md").read_text(encoding="utf-8")
    block = page.split("## Loads that are bodies")[1].split("```yaml\n")[1].split("```")[0]
    text = FILE.partition("loads:")[0] + block + f"run: {DYNAMIC}\n"
    assert {load.kind for load in loads(text).loads.values()} == {"mass", "trolley", "vehicle", "footsteps", "walker"}


TAUT = """\
lines:
  rope: {start: [0, 0], end: [40, 0], tension: 2 kN, mass: 60 g/m, axial_stiffness: 60 kN, elements: 40, MORE}
loads:
  a: LOAD
run: {kind: dynamic, until: 1 s}
"""


def said(load: str, more: str = "", run: str = "") -> list[str]:
    """What a load on a taut line is refused with; nothing, if it is fine."""
    text = TAUT.replace("LOAD", f"{{{load}}}").replace(", MORE", more).replace("until: 1 s", f"until: 1 s{run}")
    try:
        loads(text)
    except ScenarioError as error:
        return [str(problem) for problem in error.problems]
    return []


@pytest.mark.parametrize(
    ("load", "key"),
    [
        (f"{MASS}, travel: {{kind: free, from: 60}}", "travel.from"),
        (f"{MASS}, travel: {{speed: 1, from: 60, at_end: leave}}", "travel.from"),
        ("kind: force, on: rope, force: [0, -1], travel: {speed: 1, from: 60}", "travel.from"),
        (CAR.replace("from: 5", "from: 60"), "travel.from"),
        ("kind: footsteps, on: rope, mass: 70, from: 60", "from"),
        ("kind: walker, on: rope, from: 60", "from"),
    ],
)
def test_a_start_beyond_a_line_of_given_tension_is_refused_before_it_runs(load: str, key: str) -> None:
    """Its length is not known exactly; a start further than the sag could make it is off the line for certain."""
    (problem,) = said(load)
    assert f"loads.a.{key}" in problem
    assert "beyond the end of rope" in problem
    assert not said(f"{MASS}, travel: {{kind: free, from: 40.1}}")


@pytest.mark.parametrize(
    ("support", "refused"),
    [
        ("{kind: guided, along: [1, 0], force: 500 N}", True),
        ("{kind: guided, along: [2, 1], force: 1789 N}", True),  # 2 kN along the line, and yet one too many
        ("{kind: guided, along: [1, 0], force: 2 kN}", True),
        ("{kind: guided, along: [0, 1], force: 5 N}", False),
        ("{kind: guided, along: [1, 0], force: 500 N, stiffness: 10 kN/m}", False),
        ("{kind: guided, along: [1, 0], stiffness: 10 kN/m}", False),
    ],
)
@pytest.mark.parametrize("key", ["start_support", "end_support"])
def test_a_tension_does_not_go_with_a_counterweight(key: str, support: str, refused: bool) -> None:
    problems = said("kind: force, on: rope, force: [0, -1], travel: {speed: 1}", f", {key}: {support}")
    assert bool(problems) == refused
    if refused:
        assert "lines.rope.tension" in problems[0]
        assert f"lines.rope.{key}.force" in problems[0]


def test_gyroscopic_damping_is_for_small_motion_but_in_a_window() -> None:
    spins = f"{PAIR}, damping: [[1, 5], [-5, 1]]"
    assert not said(spins)
    assert not said(spins, ", bending_stiffness: 1")
    assert not said(spins, ", bending_stiffness: 1", ", geometry: linearised")
    (problem,) = said(spins, ", bending_stiffness: 1", ", geometry: linearised, window: 1 m")
    assert "loads.a.damping" in problem
    assert not said(f"{PAIR}, damping: [[1, 5], [5, 1]]", ", bending_stiffness: 1")


def test_a_margin_leaves_room_on_a_line_of_given_tension_too() -> None:
    free = "kind: mass, on: rope, mass: 1, travel: {kind: free, speed: 1, from: 5, margin: MARGIN}"
    assert any("longer than half" in message for message in said(free.replace("MARGIN", "30 m")))
    assert not said(free.replace("MARGIN", "2 m"))
