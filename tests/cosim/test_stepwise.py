"""Lines moved step by step from outside."""

from types import SimpleNamespace

import numpy as np
import pytest

import ropewalk
from ropewalk.cosim import Outside, stepwise
from ropewalk.errors import RopewalkError, ScenarioError

T, RHO, L = 2000.0, 0.5, 40.0
IMPEDANCE = 2.0 * np.sqrt(T * RHO)  # 2 rho c, N s/m


def string(loads=None, gravity=0.0, **run):
    line = ropewalk.Line(start=(0, 0), end=(L, 0), tension=T, mass=RHO, axial_stiffness=2e5, elements=160)
    run = {"kind": "dynamic", "until": 0.3, "every": 0.01, "method": "verlet", "step": 1e-4, **run}
    return ropewalk.Scenario(lines={"s": line}, loads=loads or {}, gravity=gravity, run=run)


def beam(loads=None, geometry="linearised", gravity=9.81):
    line = ropewalk.Line(
        start=(0, 0), end=(20.0, 0), tension=2e4, mass=2.0, axial_stiffness=1e7, bending_stiffness=500.0, elements=80
    )
    run = {"kind": "dynamic", "until": 0.2, "every": 0.01, "geometry": geometry}
    return ropewalk.Scenario(lines={"s": line}, loads=loads or {}, gravity=gravity, run=run)


def travelling(scenario, force, speed):
    return scenario({"f": ropewalk.MovingForce(on="s", force=(0, force), travel={"speed": speed, "from": 5.0})})


def test_a_string_answers_a_force_with_its_velocity():
    line = stepwise(string(), {"c": Outside("s")})
    line.set_force("c", 20.0, -10.0)
    before = line.at("s", 20.0)[0][-1]
    for _ in range(100):
        line.step(2e-3)
    # Mean velocity, as the links beside the contact ring; 1 % is what they lag behind.
    assert (line.output("c").place[-1] - before) / 0.2 == pytest.approx(-10.0 / IMPEDANCE, rel=0.01)


@pytest.mark.parametrize(("scenario", "h"), [(string, 1e-3), (beam, 1e-3)])
def test_a_force_pressed_from_outside_does_what_a_travelling_force_does(scenario, h):
    until = scenario().run.until
    line = stepwise(scenario(), {"c": Outside("s")}, step=h)
    for n in range(round(until / h)):
        line.set_force("c", 5.0 + 10.0 * n * h, -100.0, 10.0)
        line.step(h)
    result = ropewalk.simulate(travelling(scenario, -100.0, 10.0))
    expected = result.contact_position.isel(time=-1, contact=0).values
    # The chain seats its load at the beginning (a force that is put down shares the nodes of its link until it comes to
    # the next one); wires differ by the choice of their inner steps.
    deepest = abs(result.contact_position.sel(axis="z").values).max()
    assert line.output("c").place == pytest.approx(expected, abs=5e-3 * deepest)


@pytest.mark.parametrize("scenario", [string, beam])
@pytest.mark.parametrize("stiffness", [0.0, 1e4])
def test_going_back_repeats_what_was(scenario, stiffness):
    line = stepwise(scenario(), {"c": Outside("s", stiffness)}, step=1e-3)

    def go():
        xi = 5.0 + 10.0 * line.t
        if stiffness:
            line.set_motion("c", xi, -1.0 * line.t, -1.0, 10.0)
        else:
            line.set_force("c", xi, -100.0, 10.0)
        line.step(5e-3)
        return line.output("c")

    go()
    state = line.get_state()
    first = [go() for _ in range(4)]
    line.set_state(state)
    second = [go() for _ in range(4)]
    for a, b in zip(first, second, strict=True):
        assert np.array_equal(np.concatenate([a.place, a.velocity]), np.concatenate([b.place, b.velocity]))
        assert np.array_equal(a.force, b.force)


def test_forces_are_linear_over_a_step():
    ends = []
    for steps in (1, 50):
        line = stepwise(string(), {"c": Outside("s")})
        h = 0.05 / steps
        for n in range(steps):
            line.set_force("c", 20.0, -100.0 * n / steps, last=-100.0 * (n + 1) / steps)
            line.step(h)
        ends.append(line.output("c").place[-1])
    # 1e-3: a step of the motion more or less ends within each short one.
    assert ends[0] == pytest.approx(ends[1], rel=1e-3)


@pytest.mark.parametrize("scenario", [string, beam])
@pytest.mark.parametrize("stiffness", [0.0, 1e4])
def test_contacts_travel_and_rise_evenly_over_a_step(scenario, stiffness):
    found = []
    for steps in (1, 50):
        line, h = stepwise(scenario(), {"c": Outside("s", stiffness)}, step=1e-3), 0.05 / steps
        rest = line.at("s", 5.0)[0][-1]
        for n in range(steps):
            xi = 5.0 + 10.0 * n * h
            if stiffness:
                line.set_motion("c", xi, rest - 1.0 * n * h, -1.0, 10.0)
            else:
                line.set_force("c", xi, -100.0, 10.0)
            line.step(h)
        found.append(line.output("c").place)
    deepest = abs(found[1][-1] - rest)
    assert deepest > 1e-3
    assert found[0] == pytest.approx(found[1], abs=0.02 * deepest)  # as above


def test_a_body_on_one_side_lets_go():
    line = stepwise(string(), {"c": Outside("s", 5e3, side="above"), "held": Outside("s", 5e3)})
    places = {"c": 10.0, "held": line.length("s") - 10.0}
    for name, xi in places.items():
        line.set_motion(name, xi, -0.05)
    line.step(0.02)
    assert line.output("c").force[-1] == pytest.approx(line.output("held").force[-1], rel=1e-6)  # rounding
    assert line.output("c").force[-1] < -10.0
    for name, xi in places.items():
        line.set_motion(name, xi, 0.3)
    line.step(0.02)
    assert line.output("c").force[-1] == 0.0
    assert line.output("held").force[-1] > 10.0


def test_supports_bear_the_weight_and_what_is_pressed():
    line = stepwise(beam(), {"c": Outside("s")}, step=1e-3)
    forces = line.support_forces()
    weight = 9.81 * 2.0 * 20.0
    assert forces["s.start"][-1] + forces["s.end"][-1] == pytest.approx(weight, rel=1e-9)


def test_large_motion_of_wires_is_moved_as_well():
    small, large = (stepwise(beam(geometry=geometry), {"c": Outside("s", 1e4)}, step=1e-3) for geometry in
                    ("linearised", "nonlinear"))  # fmt: skip
    heights = []
    for line in (small, large):
        rest = line.at("s", 10.0)[0][-1]
        for n in range(40):
            line.set_motion("c", 10.0, rest - 0.1 * n * 1e-3, -0.1)
            line.step(1e-3)
        heights.append(line.output("c").place[-1] - rest)
    assert heights[0] == pytest.approx(heights[1], rel=0.02)  # 4 mm of 20 m: as good as linear


def test_wires_go_on_by_whole_inner_steps_only():
    line = stepwise(beam(), {"c": Outside("s")}, step=1e-3)
    with pytest.raises(RopewalkError, match="whole inner steps"):
        line.step(1.37e-5)


def test_what_cannot_be_moved_is_refused():
    with pytest.raises(ScenarioError, match="write kind: dynamic"):
        stepwise(string().model_copy(update={"run": ropewalk.model.Equilibrium()}), {})
    with pytest.raises(ScenarioError, match="did you mean s"):
        stepwise(string(), {"c": Outside("S")})
    line = stepwise(string(), {"c": Outside("s")})
    with pytest.raises(RopewalkError, match="use set_force"):
        line.set_motion("c", 1.0, 0.0)
    with pytest.raises(RopewalkError, match="did you mean c"):
        line.set_force("C", 1.0, 0.0)
    with pytest.raises(RopewalkError, match="3 components"):
        line.set_force("c", 1.0, (0.0, 1.0, 2.0))
    with pytest.raises(RopewalkError, match="only vertical forces"):
        stepwise(beam(), {"c": Outside("s")}, step=1e-3).set_force("c", 1.0, (1.0, 1.0))


def test_a_contact_beyond_the_end_lets_go():
    line = stepwise(string(), {"c": Outside("s")})
    length = line.length("s")
    line.set_force("c", length - 0.05, -10.0, 10.0)
    line.step(0.01)
    assert line.output("c").force[-1] == 0.0
    line.step(0.01)
    assert line.t == pytest.approx(0.02)


def test_a_line_on_which_somebody_walks_goes_back_with_her():
    walker = ropewalk.model.Footsteps.model_validate(
        {"on": "s", "mass": 70.0, "frequency": 2.0, "step_length": 0.7, "overlap": 0.2, "from": 5.0}
    )
    line = stepwise(string({"walker": walker}, gravity=9.81), {"c": Outside("s")})

    def go():
        for _ in range(70):  # over a landing
            line.set_force("c", 30.0, -100.0)
            line.step(0.01)
        return line.output("c")

    go()
    state = line.get_state()
    first = go()
    line.set_state(state)
    assert all(np.array_equal(a, b) for a, b in zip(first, go(), strict=True))


def test_a_model_without_a_state_cannot_go_back():
    model = ropewalk.Stepper(on="s", model=SimpleNamespace(step=lambda t, h, line: [(5.0, (0.0, -1.0))]), every=0.01)
    line = stepwise(string({"model": model}), {"c": Outside("s")})
    line.step(0.01)
    with pytest.raises(RopewalkError, match="load model: its model has no get_state and no set_state"):
        line.get_state()
