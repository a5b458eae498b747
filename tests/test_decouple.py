"""Loads without feedback are the forces that they exert on rigid ground, and the comparison shows what that changes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ropewalk import Scenario, feedback, without_feedback
from ropewalk.errors import RopewalkError, ScenarioError
from ropewalk.model import ForceTable, SpeedTable
from ropewalk.scenario import dump
from ropewalk.theory import string

G = 9.81


def scenario(load, end=(20.0, 0.0), run=None, **line):
    rope = {
        "start": [0.0, 0.0], "end": list(end), "tension": 2e4, "mass": 1.0, "axial_stiffness": 1e6, "elements": 20,
        **line,
    }  # fmt: skip
    run = run or {"kind": "dynamic", "until": 1.0, "every": 0.01}
    return Scenario.model_validate({"lines": {"rope": rope}, "loads": {"cart": {"on": "rope", **load}}, "run": run})


def mass(kilograms, speed=10.0, **more):
    return {"kind": "mass", "mass": kilograms, "travel": {"speed": speed, "from": 1.0}, **more}


VEHICLE = {
    "kind": "vehicle",
    "bodies": {"box": {"mass": 90.0, "inertia": 30.0, "at": 1.0}},
    "wheels": {"rear": {"at": 0.0, "mass": 5.0}, "front": {"at": 3.0, "mass": 6.0}},
    "springs": {
        "one": {"between": ["box", "rear"], "stiffness": 1e4},
        "two": {"between": ["box", "front"], "stiffness": 2e4},
    },
    "travel": {"speed": 8.0, "from": 2.0},
}


def test_what_rests_within_itself_becomes_its_static_axle_loads():
    loads = without_feedback(scenario(VEHICLE)).loads
    assert list(loads) == ["cart-rear", "cart-front"]
    # the lever rule: 2/3 of the box on the rear wheel, 1/3 on the front one; tolerance: a solution of small matrices
    assert loads["cart-rear"].force == pytest.approx((0.0, -G * 65.0), rel=1e-9)
    assert loads["cart-front"].force == pytest.approx((0.0, -G * 36.0), rel=1e-9)
    assert [load.travel.start for load in loads.values()] == [2.0, 5.0]


def test_a_mass_becomes_its_weight_and_what_else_is_given():
    plain = without_feedback(scenario(mass(3.0))).loads["cart"]
    assert (plain.kind, plain.force) == ("force", pytest.approx((0.0, -3.0 * G)))
    table = {"time": [0.0, 1.0], "value": [[5.0, 0.0], [0.0, -7.0]]}
    pushed = without_feedback(scenario(mass(3.0, force=table, contact="frictionless"))).loads["cart"]
    np.testing.assert_allclose(pushed.force.value, [[5.0, -3.0 * G], [0.0, -3.0 * G - 7.0]])
    assert pushed.contact == "frictionless"


def test_a_wheel_that_comes_from_before_the_line_waits_for_its_turn():
    run = {"kind": "linear", "until": 1.0}
    travel = {"speed": 8.0, "from": 0.0, "at_end": "leave", "measured": "horizontal"}
    wheels = {"rear": {"at": -4.0, "mass": 5.0}, "front": {"at": 0.0, "mass": 6.0}}
    springs = {**VEHICLE["springs"]}
    bodies = {"box": {"mass": 90.0, "inertia": 30.0, "at": -2.0}}
    coming = {**VEHICLE, "travel": travel, "wheels": wheels, "springs": springs, "bodies": bodies}
    rear = without_feedback(scenario(coming, run=run, bending_stiffness=1e4)).loads["cart-rear"]
    assert rear.travel.start == pytest.approx(0.0, abs=1e-8)
    assert (rear.travel.speed.time, rear.travel.speed.value) == (
        (0.0, 0.5, 0.5),
        (0.0, 0.0, 8.0),
    )
    assert (rear.force.time, rear.force.value[:2]) == ((0.0, 0.5, 0.5), ((0.0, 0.0), (0.0, 0.0)))
    assert rear.force.value[-1][1] == pytest.approx(-50.0 * G)


def test_a_swinging_payload_pulls_as_a_pendulum():
    swing, length = 0.2, 1.0
    trolley = {
        "kind": "trolley", "mass": 2.0, "payload": {"mass": 30.0, "length": length, "swing": swing, "stiffness": 3e5},
        "travel": {"speed": 3.0, "from": 2.0},
    }  # fmt: skip
    run = {"kind": "dynamic", "until": 2.0, "every": 0.01}
    load = without_feedback(scenario(trolley, run=run)).loads["cart"]
    time, (across, up) = np.array(load.force.time), np.array(load.force.value).T
    # By momentum over half a period, from one turning point to the other (T = 2 pi sqrt(l/g) (1 + swing^2/16), l with
    # the stretch of 1 mm): the pull across vanishes in the mean, that up and down is the weight. Tolerance: half a link
    # of ground hangs on the contact, 5e-3 of the weight.
    half = math.pi * math.sqrt((length + 1e-3) / G) * (1.0 + swing**2 / 16.0)
    first = (time > 0.02) & (time <= 0.02 + 2.0 * half)
    assert up[first].mean() == pytest.approx(-32.0 * G, rel=0.01)
    assert abs(across[first].mean()) < 0.01 * 30.0 * G
    peak = 30.0 * G * np.sin(swing) * np.cos(swing)  # T = m g cos(swing) at a turning point, across
    near = np.abs(time - half) < 0.03
    assert across[near].mean() == pytest.approx(-peak, rel=0.03)  # ground takes up ripples of a few per cent


def test_a_free_mass_rolls_down_ground_as_down_an_inclined_plane():
    free = {"kind": "mass", "mass": 20.0, "travel": {"kind": "free", "from": 2.0, "at_end": "leave"}}
    angle = math.atan2(5.0, 20.0)
    load = without_feedback(scenario(free, end=(20.0, -5.0), tension=5e4)).loads["cart"]
    speed = load.travel.speed
    assert isinstance(speed, SpeedTable)
    # tolerance: half a link of ground hangs on the contact
    assert speed.value[-1] == pytest.approx(G * math.sin(angle), rel=5e-3)
    force = np.array(load.force.value if isinstance(load.force, ForceTable) else [load.force])[200:].mean(axis=0)
    normal = 20.0 * G * math.cos(angle) * np.array([-math.sin(angle), -math.cos(angle)])
    np.testing.assert_allclose(force, normal, atol=0.01 * 20.0 * G)


def test_a_walker_becomes_feet_that_stand():
    run = {"kind": "dynamic", "until": 1.5, "every": 0.01}
    walker = {"kind": "walker", "mass": 60.0, "foot_mass": 1.0, "from": 4.0}
    cut = without_feedback(scenario(walker, run=run, elements=40))
    assert {name.rsplit("-", 1)[0] for name in cut.loads} == {"cart-left", "cart-right"}
    assert all(load.travel.speed == 0.0 for load in cut.loads.values())
    time = np.linspace(0.3, 1.2, 500)
    total = sum(np.interp(time, load.force.time, np.array(load.force.value)[:, 1]) for load in cut.loads.values())
    assert total.mean() == pytest.approx(-60.0 * G, rel=0.1)  # no whole number of steps
    dump(cut)  # it can be written


STRING = {"tension": 1.0, "mass": 1.0, "axial_stiffness": 1e6, "elements": 50}
WEAK = 1e-3  # m/s^2, so that deflections are small


def on_string(every=0.02, **load):
    """A load on a taut string of unit length, mass and tension: waves run at 1 m/s."""
    load = {"travel": {"speed": 0.5, "measured": "horizontal", "at_end": "leave"}, **load}
    made = scenario(load, end=(1.0, 0.0), run={"kind": "linear", "until": 1.0, "every": every}, **STRING)
    return feedback(made.model_copy(update={"gravity": WEAK}))


def rms(found):
    return found.wheels["cart"]["contact_force"]["rms_difference"]["relative"]


def test_the_difference_grows_with_the_mass_and_vanishes_with_it():
    # Entering at the support, the contact force grows from 0 to the weight within T0 = m / (2 rho c): over a time that
    # goes as m the whole force differs, so that its mean square goes as m and its root as m^0.5; what the deflection
    # makes goes as m.
    found = {m: on_string(every=1e-3, kind="mass", mass=m) for m in (0.05, 0.1, 1.0, 4.0)}
    off = [rms(one) for one in found.values()]
    lines = [abs(one.lines["rope"]["largest_deflection"]["relative"]) for one in found.values()]
    print("rms difference of the force over the mass", off, "of the largest deflection", lines)
    assert off == sorted(off)
    assert np.log2(off[1] / off[0]) == pytest.approx(0.5, abs=0.1)  # the jump at t = 0 counts for one output
    assert lines[0] < 0.1 * lines[-1]


def test_the_linear_theory_gives_the_known_numbers_of_both():
    # Theory 2b, alpha = 0.5, kappa = 2: y(L/2) in mgL/P, and the closed form of the moving force; the string sags by
    # an eighth of that by itself.
    found = on_string(kind="mass", mass=1.0)
    y, plain = (
        -float(r.contact_position.sel(contact=0, axis="z").sel(time=1.0)) / WEAK - 0.125
        for r in (found.coupled, found.without)
    )
    line = {"length": 1.0, "tension": 1.0, "mass": 1.0}
    exact = float(string.moving_force(x=0.5, t=1.0, force=1.0, speed=0.5, **line))
    assert y == pytest.approx(0.2612362397707865, rel=1e-4)  # the tolerance of the solver of delay equations
    assert plain == pytest.approx(exact, rel=1e-6)  # the string of EA = 1e6 P is a little tauter than P
    relative = found.lines["rope"]["largest_deflection"]["relative"]
    assert f"{abs(100 * relative):.0f}" in found.verdict
    assert "must not be replaced" in found.verdict


def test_a_stiff_oscillator_is_its_mass_and_a_soft_one_its_force():
    stiff, soft = (on_string(kind="oscillator", mass=1.0, stiffness=k, damping=0.0) for k in (1e4, 1e-3))
    assert rms(soft) < 1e-3  # of the order of stiffness over P/L
    # the mass on its spring of 1e-4 m per unit of force follows the string with a lag of 0.01 s
    assert rms(stiff) == pytest.approx(rms(on_string(kind="mass", mass=1.0)), rel=0.05)
    assert "may be replaced" in soft.verdict


def test_the_comparison_is_told_for_lines_supports_and_wheels():
    trolley = {
        "kind": "trolley", "mass": 2.0, "payload": {"mass": 80.0, "length": 1.0, "stiffness": 5e4},
        "travel": {"kind": "free", "from": 3.0},
    }  # fmt: skip
    run = {"kind": "dynamic", "until": 2.0, "every": 0.02, "start": {"with_loads": True}}
    found = feedback(scenario(trolley, end=(20.0, -2.0), tension=4e3, axial_damping=50.0, run=run))
    message = found.as_dict()
    assert list(message["supports"]) == ["rope.start", "rope.end"]
    assert message["wheels"]["cart"]["contact_force"]["mean"]["without"]["value"] == pytest.approx(82.0 * G, rel=0.05)
    # it runs down the hollow that it makes itself, which ground has not
    assert message["wheels"]["cart"]["contact_force"]["largest_difference"]["value"] > 10.0
    rows = {row[0]: row for row in found.table()}
    assert rows["largest deflection of rope"][1].endswith(" m")
    assert rows["contact force of cart, mean"][1].endswith(" N")


def test_what_cannot_be_compared_says_so(tmp_path):
    run = {"kind": "dynamic", "until": 1.0, "start": {"kind": "result", "file": str(tmp_path / "a.nc")}}
    with pytest.raises(ScenarioError, match="start from rest"):
        without_feedback(scenario(mass(3.0), run=run))
    force = {"kind": "force", "force": [0.0, -10.0], "travel": {"speed": 1.0, "from": 1.0}}
    with pytest.raises(RopewalkError, match="supports dynamic and linear"):
        feedback(scenario(force, run={"kind": "quasistatic"}))
    same = scenario(force)
    assert without_feedback(same) is same
