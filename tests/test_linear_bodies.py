"""Masses, oscillators and vehicles in runs of kind linear: published numbers, the theory's own answers, refusals.

Yang and Yau 1997 and Yang, Lin and Yau 2004: a sprung mass on a simple beam. Strings: the delay equation of
docs/notes/moving-mass-on-a-string.md, deflections in units m g L/P and forces in m g over V t/L.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.capabilities import SUPERPOSED, engine_of
from ropewalk.errors import RopewalkError, ScenarioError
from ropewalk.model import Line, Linear, MovingForce, Scenario, Travel
from ropewalk.scenario import loads as read
from ropewalk.simulate import simulate
from ropewalk.theory import beam, beam_vehicle, string

G = 9.81
YAU = {"length": 25.0, "bending_stiffness": 2.87e9 * 2.90, "mass": 2303.0, "speed": 100 / 3.6}
LIN = {"length": 25.0, "bending_stiffness": 27.5e9 * 0.12, "mass": 4800.0, "speed": 10.0}
# On rollers: with 10 kN instead of EA the beam's sag stretches it by less than 0.1 N.
BRIDGE = "{start: [0, 0], end: [25, 0], length: 25, axial_stiffness: 10 kN, elements: 20, mass: %g, "
BRIDGE += "bending_stiffness: %g}"


def run(line: str, load: str, instants: str, *, gravity: float = G, others: str = "") -> xr.Dataset:
    text = f"gravity: {gravity}\nlines: {{line: {line}}}\nloads:\n  a: {{on: line, {load}}}\n{others}"
    return simulate(read(f"{text}run: {{kind: linear, {instants}}}\n", name="case.yaml"))


def bridge(case: dict[str, float], load: str, instants: str) -> xr.Dataset:
    travel = f"travel: {{speed: {case['speed']}, measured: horizontal, at_end: leave}}"
    return run(BRIDGE % (case["mass"], case["bending_stiffness"]), f"{load}, {travel}", instants)


def height(values: xr.DataArray) -> np.ndarray:
    return np.asarray(values.sel(axis="z").values)


def at_midspan(result: xr.Dataset) -> np.ndarray:
    z = height(result.position)[:, 10]
    return np.asarray(z[0] - z)


@pytest.mark.parametrize(
    ("load", "largest"),
    [("kind: oscillator, mass: 5750, stiffness: 1595e3", 0.0024073013), ("kind: mass, mass: 5750", 0.0024266681)],
)
def test_yang_and_yau_1997(load: str, largest: float) -> None:
    result = bridge(YAU, load, "until: 0.44, every: 1 ms, modes: 20")
    assert "contact" not in result.attrs["warnings"]  # 20 modes miss some of the shear
    assert at_midspan(result).max() == pytest.approx(largest, abs=5e-8)  # tolerance 1e-5 of the theory's default


def test_yang_lin_and_yau_2004() -> None:
    result = bridge(LIN, "kind: oscillator, mass: 1200, stiffness: 500e3", "until: 1.65, every: 2 ms, modes: 20")
    assert at_midspan(result).max() == pytest.approx(1.2738549e-3, abs=3e-8)
    acceleration = -np.gradient(height(result.body_velocity)[:, 0], result.time.values)
    assert acceleration.max() == pytest.approx(0.031704, abs=2e-4)  # differences over 2 ms at 13 and 20 rad/s
    assert acceleration.min() == pytest.approx(-0.036866, abs=2e-4)
    # At rest on its spring, above a beam that bends under its own weight unnoticed.
    assert result.body_position.values[0, 0] == pytest.approx([0.0, -1200 * G / 500e3], rel=1e-12)
    assert result.body_position.sel(axis="x").values[-1, 0] == pytest.approx(16.5)


UNIT = "{start: [0, 0], end: [1, 0], length: 1, mass: 1, axial_stiffness: 1, bending_stiffness: 1, elements: 20}"
HEAVY = "kind: mass, mass: 0.5, force: [0, -1], travel: {speed: %r, measured: horizontal, at_end: leave}" % (np.pi / 2)


def test_a_pulling_contact_is_warned_of_and_flies_where_it_may() -> None:
    """(mu, alpha) = (0.5, 0.5): least contact force -1.71 weights, largest deflection 2.022125 F L^3/48 EI."""
    restrained = run(UNIT, HEAVY, "until: 0.6366, every: 0.3 ms, modes: 30", gravity=0.0)
    assert "contact is lost at t = 0.5" in restrained.attrs["warnings"]
    assert "lift_off: true lets it fly" in restrained.attrs["warnings"]
    pressed = -height(restrained.contact_force)[:, 0]
    assert np.nanmin(pressed) == pytest.approx(-1.71, abs=5e-3)  # digits given
    assert 48.0 * at_midspan(restrained).max() == pytest.approx(2.022125, abs=1e-4)  # steps of output
    free = run(UNIT, f"{HEAVY}, lift_off: true", "until: 1, every: 2.5 ms, modes: 30", gravity=0.0)
    t = free.time.values
    assert "contact" not in free.attrs["warnings"]
    assert np.nanmin(-height(free.contact_force)[:, 0]) == pytest.approx(0.0, abs=1e-9)
    lost = beam.flying_vehicle(t, vehicle=beam_vehicle.point_mass(0.5, gravity=2.0), speed=np.pi / 2, **PLAIN)
    left, landed = lost.left_at[0], lost.landed_at[0]
    flying = (t > left) & (t < 2.0 / np.pi)
    assert flying.sum() > 10
    assert set(free.contact_state.values[flying, 0]) == {1.0}  # in the air
    assert set(free.contact_state.values[t < left, 0]) == {3.0}  # moves along the line
    assert set(free.contact_state.values[t > 2.0 / np.pi, 0]) == {0.0}  # past the line
    assert free.contact_in_air.values[-1, 0] == pytest.approx(landed - left, rel=1e-6)
    assert height(free.contact_position)[flying, 0] == pytest.approx(-lost.wheel[flying, 0], abs=1e-9)
    dissipated = free.energy.sel(form="contact_dissipation").values
    assert dissipated == pytest.approx(lost.impact_loss, rel=1e-9)
    assert dissipated[-1] > 0.0


PLAIN = {"length": 1.0, "bending_stiffness": 1.0, "mass": 1.0, "modes": 30}

CAR = """kind: vehicle, travel: {speed: %s, from: %s, measured: horizontal, at_end: leave},
      wheels: {front: {at: 0, mass: 50}, rear: {at: -3, mass: 60}}, bodies: {box: {mass: 1000, inertia: 2000, at: -1}},
      springs: {f: {between: [box, front], stiffness: 200 kN/m, damping: 900},
                r: {between: [box, rear], stiffness: 100 kN/m, damping: 700}}"""
SAME = beam_vehicle.rigid_body(
    1000.0, pitch_inertia=2000.0, centre=1.0, axles=[0.0, 3.0], load_stiffness=[2e5, 1e5], load_damping=[900.0, 700.0],
    wheel_mass=[50.0, 60.0],
)  # fmt: skip


@pytest.mark.parametrize(("place", "lift"), [(0, ""), (0, ", lift_off: true"), (3, "")], ids=["in", "may fly", "on it"])
def test_a_vehicle_on_two_axles_is_what_theory_says(place: float, lift: str) -> None:
    line = BRIDGE % (2303.0, 8.323e9)
    result = run(line, CAR % (20, place) + lift, "until: 1.6 s, every: 40 ms, modes: 5")
    t, x = result.time.values, np.linspace(0.0, 25.0, 21)
    task: dict[str, Any] = {"vehicle": SAME, "speed": 20.0, "start": place, "modes": 5} | YAU | {"speed": 20.0}
    theory = beam.flying_vehicle(t, **task) if lift else beam.moving_vehicle(t, **task)
    deflection = theory.beam_deflection(x)
    scale = np.abs(deflection).max()
    assert height(result.position)[0] - height(result.position) == pytest.approx(deflection, abs=1e-6 * scale)
    assert -height(result.velocity) == pytest.approx(theory.beam_velocity(x), abs=1e-4 * scale)
    on = (theory.place >= 0.0) & (theory.place <= 25.0)
    assert np.all(np.isfinite(result.contact_xi.values) == on)
    assert -height(result.contact_force)[on] == pytest.approx(theory.contact_force[on], rel=1e-5)
    assert result.contact_position.sel(axis="x").values[on] == pytest.approx(theory.place[on], abs=1e-9)
    rest = -1000 * G / 3e5  # the axles at 2:1 and the springs at 2:1 give way alike
    at = np.clip(theory.place, 0.0, 25.0)
    sag = 2303.0 * G * at * (25.0**3 - 50.0 * at**2 + at**3) / (24.0 * 8.323e9)  # of a uniform beam
    box = height(result.body_position)[:, 0] + sag @ [2 / 3, 1 / 3]
    assert box == pytest.approx(rest - theory.body[:, 0], abs=1e-5 * scale)
    assert result.body_position.sel(axis="x").values[:, 0] == pytest.approx(theory.place[:, 0] - 1.0)
    assert -height(result.body_velocity)[:, 0] == pytest.approx(theory.body_velocity[:, 0], abs=1e-4 * scale)


def test_matrices_are_the_vehicle_that_they_describe() -> None:
    line = BRIDGE % (2303.0, 8.323e9)
    order = [1, 3, 0, 2]  # pitch, rear, bounce, front
    M, C, K = (a[np.ix_(order, order)].tolist() for a in (SAME.mass, SAME.damping, SAME.stiffness))
    matrices = (
        f"kind: matrices, coordinates: [pitch, rear, bounce, front], mass: {M}, damping: {C}, stiffness: {K}, "
        f"weight: [0 N, {60 * G} N, {1000 * G} N, {50 * G} N], "
        "wheels: {rear: {at: -3, coordinate: rear}, front: {coordinate: front}}, "
        "travel: {speed: 20, measured: horizontal, at_end: leave}"
    )
    instants = "until: 1.2 s, every: 0.1 s, modes: 4"
    one, two = run(line, matrices, instants), run(line, CAR % (20, 0), instants)
    assert height(one.position) == pytest.approx(height(two.position), abs=1e-10)
    assert height(one.contact_force)[:, ::-1] == pytest.approx(height(two.contact_force), rel=1e-9, nan_ok=True)
    assert height(one.body_position)[:, 1] == pytest.approx(height(two.body_position)[:, 0], abs=1e-10)


@pytest.mark.parametrize("load", ["kind: mass, mass: 300", "kind: oscillator, mass: 300, stiffness: 1 kN/m"])
@pytest.mark.parametrize("stiffness", ["0", "2 MN*m^2"])
def test_from_the_far_end_is_the_mirror_image(load: str, stiffness: str) -> None:
    line = "{start: [0, 0], end: [40, 0], tension: 200 kN, mass: 10, axial_stiffness: 40 MN, elements: 40, "
    line += f"bending_stiffness: {stiffness}}}"
    modes = "" if stiffness == "0" else ", modes: 6"
    there, back = (
        run(line, f"{load}, contact: frictionless, {travel}" if "mass," in load else f"{load}, {travel}",
            f"until: 0.6, every: 0.1{modes}")
        for travel in (
            "travel: {speed: 60, measured: horizontal, at_end: leave}",
            "travel: {speed: -60, from: 40, measured: horizontal, at_end: leave}",
        )
    )  # fmt: skip
    assert height(back.position) == pytest.approx(height(there.position)[:, ::-1], abs=1e-9)
    assert height(back.contact_force) == pytest.approx(height(there.contact_force), rel=1e-9)
    hold = there.hold_force.sel(axis="x").values
    assert back.hold_force.sel(axis="x").values == pytest.approx(-hold, rel=1e-6, abs=1e-6)
    assert (np.abs(hold).max() > 1.0) == ("kind: mass" in load)


STRING = "{start: [0, 0], end: [1, 0], tension: 1, mass: 1, axial_stiffness: 1e8, elements: 50}"


def on_string(alpha: float, kappa: float, *, more: str = "", instants: str = "") -> xr.Dataset:
    """A mass 2/kappa of weight 1 on a string, without gravity for the string itself."""
    mass = f"kind: mass, mass: {2.0 / kappa}, force: [0, -1]"
    travel = f"travel: {{speed: {alpha}, measured: horizontal, at_end: leave}}"
    instants = instants or f"until: {1.5 / alpha}, every: {0.05 / alpha}"
    return run(STRING, f"{mass}, {travel}{more}", instants, gravity=0.0)


@pytest.mark.parametrize(
    ("alpha", "kappa", "path"),
    [
        (0.5, 2.0, [0.01728790107, 0.08819020575, 0.26123624, 0.4441557, 0.445899]),
        (0.8, 2.0, [0.00719259544, 0.03995775577, 0.13338866, 0.2549321, 0.335346]),
        (0.2, 2.0, [0.07110279440, 0.22221460279, 0.312407, 0.167982, 0.100613]),
        (0.5, 0.5, [0.00481727084, 0.02850122303, 0.10432087, 0.2146828, 0.280308]),
    ],
)
def test_a_mass_on_a_string_follows_the_delay_equation(alpha: float, kappa: float, path: list[float]) -> None:
    result = on_string(alpha, kappa)
    at = [2, 5, 10, 15, 18]
    # in these units of later values 2e-6; the chain's wave speed, found from its rest, is right to 1e-8
    assert -height(result.contact_position)[at, 0] == pytest.approx(path, abs=3e-6)
    if (alpha, kappa) == (0.5, 2.0):
        pressed = [0.36798391844, 0.69698930326, 0.93424798614, 2.468469, 4.812715]
        assert -height(result.contact_force)[at, 0] == pytest.approx(pressed, rel=3e-6)
    # The line under the mass is where the mass is: nodes at every second hundredth.
    nodes = height(result.position)
    on = [2, 4, 8, 12, 16]
    assert [nodes[i, round(2.5 * i)] for i in on] == pytest.approx(height(result.contact_position)[on, 0], abs=5e-6)
    assert np.all(np.isnan(result.contact_xi.values[20:, 0]))  # it has left, and the string swings on
    assert np.abs(nodes[21:]).max() > 0.01


def test_a_string_after_the_passage_swings_freely() -> None:
    """Its period is 2 L/c."""
    result = on_string(0.5, 2.0, instants="until: 4.5, every: 0.5")
    z = height(result.position)
    assert z[5] == pytest.approx(z[9], abs=3e-6)  # the force is tabulated
    assert np.abs(z[5] - z[6]).max() > 0.1


def test_a_light_mass_is_a_moving_force() -> None:
    result = on_string(0.5, 2e6, more=", contact: frictionless")
    t, x = result.time.values, np.linspace(0.0, 1.0, 51)
    exact = string.moving_force(x, t[:, np.newaxis], force=1.0, speed=0.5, length=1.0, tension=1.0, mass=1.0)
    assert -height(result.position) == pytest.approx(exact, abs=5e-6)  # of the mass 1e-6
    # it is held by F^2 (2 alpha - 1)/(2 P (1 - alpha^2)) = 0 here, until the first wave comes back
    assert result.hold_force.sel(axis="x").values[2:13, 0] == pytest.approx(np.zeros(11), abs=5e-6)


def test_faster_than_the_waves_the_string_is_at_rest_before_the_mass() -> None:
    result = on_string(1.5, 2.0)
    assert height(result.contact_position)[1:20, 0] == pytest.approx(np.zeros(19), abs=1e-7)
    assert height(result.contact_force)[1:20, 0] == pytest.approx(-np.ones(19))
    assert np.abs(height(result.position)).max() > 0.1


def test_an_oscillator_on_a_string_is_what_theory_says() -> None:
    load = "kind: oscillator, mass: 300, stiffness: [1, 8 kN/m], damping: 500, wheel_mass: 30, "
    load += "travel: {speed: 60, measured: horizontal, at_end: leave}"
    line = "{start: [0, 2], end: [40, 2], tension: 200 kN, mass: 10.005, axial_stiffness: 400 MN, elements: 40}"
    result = run(line, load, "until: 0.8, every: 0.05")
    t = result.time.values
    on = t < 40 / 60 - 1e-9
    exact = string.moving_oscillator(
        t[on], sprung_mass=300.0, contact_mass=30.0, stiffness=8e3, damping=500.0, speed=60.0, length=40.0,
        tension=200e3, mass=10.005 / 1.0005 * (1.0 + (10.0 * G * 40.0 / 200e3) ** 2 / 24.0),
    )  # fmt: skip
    force = -height(result.contact_force)[on, 0]
    # mass per metre of chord: of an arc, and stretched
    assert force[1:] == pytest.approx(exact.contact_force[1:], rel=1e-4)
    x = 60.0 * t
    sag = 10.005 / 1.0005 * (1.0 + (10.0 * G * 40.0 / 200e3) ** 2 / 24.0) * G * x * (40.0 - x) / 400e3  # a parabola
    body = height(result.body_position)[:, 0] + sag
    assert body[on] == pytest.approx(2.0 - 300 * G / 8e3 - exact.body_deflection, abs=1e-5)
    assert np.all(np.isnan(body[~on]))  # what it does behind the line is not said
    assert "runs over the sag of its line so fast" in result.attrs["warnings"]  # (V/c)^2 = 0.18


def test_lost_contact_on_a_string_is_warned_of() -> None:
    line = "{start: [0, 0], end: [1, 0], tension: 1, mass: 0.05, axial_stiffness: 1e8, elements: 20}"
    load = "kind: mass, mass: 1, force: [0, -1], travel: {speed: 0.35, measured: horizontal, at_end: leave}"
    result = run(line, load, "until: 3, every: 0.1", gravity=0.0)
    exact = string.moving_mass(0.1, load_mass=1.0, gravity=1.0, speed=0.35, length=1.0, tension=1.0, mass=0.05)
    assert exact.contact_lost_at is not None
    assert f"contact is lost at t = {exact.contact_lost_at:.4g} s" in result.attrs["warnings"]
    assert "kind: dynamic with lift_off: true lets it fly" in result.attrs["warnings"]


def test_modes_of_a_string_converge_slowly_and_say_so() -> None:
    exact = height(on_string(0.5, 2.0).contact_position)[10, 0]
    gaps = []
    for modes in (50, 100):
        result = on_string(0.5, 2.0, instants=f"until: 1, every: 0.5, modes: {modes}")
        assert "wrong by about one part in their number" in result.attrs["warnings"]
        gaps.append(height(result.contact_position)[-1, 0] - exact)
    assert gaps[0] == pytest.approx(0.26124 - 0.25806, abs=2e-5)  # theory, section 2
    assert gaps[1] == pytest.approx(0.5 * gaps[0], rel=0.05)


def test_the_hold_force_gives_what_line_and_load_gain() -> None:
    """Energies of line and load, less the work of a frictionless contact that is pulled along, stay."""
    load = "kind: mass, mass: 5750, contact: frictionless, travel: {speed: 27.78, measured: horizontal}"
    line = (BRIDGE % (2303.0, 8.323e9)).replace("elements: 20", "elements: 400")
    result = run(line, load, "until: 0.8, every: 2 ms, modes: 5")
    forms = ["kinetic", "elastic", "gravitational", "load_kinetic", "load_potential"]
    total = result.energy.sel(form=forms).sum("form").values
    power = 27.78 * result.hold_force.sel(axis="x").values[:, 0]
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * 2e-3)])
    # The sag of the line is not a part of the theory: what its weight and its tension store cancels with bending.
    assert total - total[0] == pytest.approx(work, abs=0.02 * np.abs(work).max())
    assert np.isnan(result.energy.sel(form="load_damping").values).all()


def test_the_tension_of_a_beam_is_that_of_its_length_along_its_sag() -> None:
    """A slender one hangs as a rope does, a stiff one bears its weight by bending and is hardly stretched."""
    slack = {"start": (0.0, 0.0), "end": (10.0, 0.0), "length": 10.02, "mass": 2.0, "axial_stiffness": 1e6}
    lines = {f"EI {EI:g}": Line(**slack, bending_stiffness=EI) for EI in (0.0, 1e-6, 1e7)}  # type: ignore[arg-type]
    result = simulate(Scenario(lines=lines, run=Linear(until=1e-3)))
    rope, *limit = (float(result.tension.values[0, i]) for i in (0, 100, 200))
    assert limit[0] == pytest.approx(rope, rel=3e-3)  # parabola and catenary at 2.6 % sag
    assert limit[1] == pytest.approx(1e6 * (10.0 / 10.02 - 1.0), rel=1e-3)  # compressed


RIGID = "{start: [0, 0], end: [1, 0], length: 1, mass: 1, axial_stiffness: 1, bending_stiffness: 1}"
TAUT = "{start: [0, 0], end: [1, 0], tension: 1, mass: 0.001, axial_stiffness: 1e3}"
SLOPE = RIGID.replace("[1, 0]", "[1, 0.1]").replace("length: 1,", "length: 1.1,")


@pytest.mark.parametrize(
    ("line", "load", "key", "says"),
    [
        (RIGID, "kind: trolley, mass: 1, travel: {speed: 0.1}, payload: {mass: 1, length: 1}", "kind",
         "not implemented"),
        (RIGID, "kind: mass, mass: 1, travel: {kind: free}", "travel.kind", "given free; ask for kind: dynamic"),
        (RIGID, "kind: mass, mass: 1, travel: {speed: 1, at_end: stay}", "travel.at_end", "write leave"),
        (RIGID, "kind: mass, mass: 1, lift_off: true, side: below, travel: {speed: 0.1}", "side", "write above"),
        (RIGID, "kind: mass, mass: 1, air_drag: 1, travel: {speed: 0.1}", "air_drag", "leave it out"),
        (RIGID, "kind: oscillator, mass: 1, stiffness: 1, lift_off: true, contact_stiffness: 9, travel: {speed: 0.1}",
         "contact_stiffness", "given 9 N/m; leave it out"),
        (RIGID, "kind: vehicle, travel: {speed: 0.1}, lift_off: true, wheels: {w: {mass: 1, contact_stiffness: 9}}",
         "wheels.w.contact_stiffness", "given 9 N/m; leave it out"),
        (TAUT, "kind: mass, mass: 1, lift_off: true, travel: {speed: 0.1}", "lift_off", "lift-off on a line"),
    ],
)  # fmt: skip
def test_what_is_not_known_is_refused_with_advice(line: str, load: str, key: str, says: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        run(line, load, "until: 1")
    assert [problem.key for problem in caught.value.problems] == [f"loads.a.{key}"]
    assert says in str(caught.value)


BY_MODES = {
    "its speed varies": (RIGID, "kind: mass, mass: 1, travel: {speed: {time: [0, 9], value: [1, 2]}, at_end: leave}"),
    "it stands": (RIGID, "kind: mass, mass: 1, travel: {speed: 0, from: 0.5}"),
    "along the arc": (RIGID, "kind: mass, mass: 1, travel: {speed: 1, measured: arc, at_end: leave}"),
    "a force aside": (RIGID, "kind: mass, mass: 1, force: [1, 0], travel: {speed: 0.1}"),
    "uphill": (SLOPE, "kind: mass, mass: 1, travel: {speed: 0.1}"),
    "a vehicle on a string": (TAUT, "kind: vehicle, travel: {speed: 0.1}, wheels: {w: {mass: 1}}"),
    "inside a string": (TAUT, "kind: mass, mass: 1, travel: {speed: 0.1, from: 0.5}"),
    "beside another": (RIGID, "kind: mass, mass: 1, travel: {speed: 0.1}}, b: {kind: force, on: line, force: [0, -1], "
                              "travel: {speed: 0.1, from: 0.5}"),
}  # fmt: skip


@pytest.mark.parametrize(("line", "load"), BY_MODES.values(), ids=BY_MODES)
def test_what_has_no_closed_form_goes_by_the_modes_of_its_own_rest(line: str, load: str) -> None:
    tree = f"{{lines: {{line: {line}}}, loads: {{a: {{on: line, {load}}}}}, run: {{kind: linear, until: 1}}}}"
    assert engine_of(read(tree, name="case.yaml")) is SUPERPOSED


def test_a_mass_that_starts_inside_a_string_moves_as_it_does_step_by_step() -> None:
    """Small motion by another engine, on a level string and uphill; the contact force is that of the mesh, too."""
    for end in ([20, 0], [20, 6]):
        line = {"start": [0, 0], "end": end, "tension": 1e4, "mass": 1.0, "axial_stiffness": 1e6, "elements": 60}
        load = {"kind": "mass", "on": "line", "mass": 20.0, "travel": {"speed": 20.0, "from": 5.0}}
        ways = {"kind": "linear"}, {"kind": "dynamic", "geometry": "linearised"}
        modes, steps = (
            simulate(Scenario.model_validate(
                {"lines": {"line": line}, "loads": {"a": load}, "run": {**way, "until": 0.5, "every": 0.05}}
            )) for way in ways
        )  # fmt: skip
        moved = steps.contact_position.values - steps.contact_position.values[0]
        away = np.abs(modes.contact_position.values - steps.contact_position.values).max()
        print(away, np.abs(moved[..., 1]).max())
        assert np.abs(moved[..., 1]).max() > 0.1
        assert away < 5e-4


def test_what_the_theory_refuses_is_said_of_the_load() -> None:
    with pytest.raises(RopewalkError, match=r"^load a: speed must be 0 or at least"):
        run(TAUT, "kind: mass, mass: 1, travel: {speed: 0.1}", "until: 1")
    with pytest.raises(RopewalkError, match=r"^load a: nothing keeps its coordinates"):
        run(
            RIGID, "kind: matrices, coordinates: [a, w], mass: [[1, 0], [0, 1]], stiffness: [[0, 0], [0, 0]], "
            "wheels: {w: {coordinate: w}}, travel: {speed: 0.1}", "until: 1",
        )  # fmt: skip


def test_forces_on_other_lines_are_not_disturbed() -> None:
    lines = {name: Line(start=(0.0, 0.0), end=(1.0, 0.0), tension=1.0, mass=1.0, axial_stiffness=1e8, elements=10)
             for name in ("a", "b")}  # fmt: skip
    travel = Travel(speed=0.5, measured="horizontal")
    force = MovingForce(on="b", force=(0.0, -1e-3), travel=travel)
    text = "kind: mass, on: a, mass: 1, force: [0, -1], travel: {speed: 0.5, measured: horizontal}"
    mass = read(f"gravity: 0\nlines: {{a: {TAUT}}}\nloads: {{m: {{{text}}}}}\nrun: {{kind: linear, until: 1}}\n").loads
    until = Linear(until=1.0, every=0.25)
    both = simulate(Scenario(gravity=0.0, lines=lines, loads={"f": force, **mass}, run=until))
    alone = simulate(Scenario(gravity=0.0, lines={"b": lines["b"]}, loads={"f": force}, run=until))
    assert both.position.values[:, 11:] == pytest.approx(alone.position.values)
    assert both.contact_position.values[:, 0] == pytest.approx(alone.contact_position.values[:, 0])
    assert np.abs(both.position.values[-1, :11, 1]).max() > 0.1


def test_a_vehicle_that_starts_on_a_beam_names_the_key_that_helps() -> None:
    """Put down at once it strikes all modes: adding modes does not converge, a number of them is what can be had."""
    car = (
        "kind: vehicle, travel: {speed: 20, from: 5, at_end: leave}, wheels: {front: {at: 1, mass: 10}, "
        "rear: {at: -1, mass: 10}}, bodies: {box: {mass: 1000, inertia: 500}}, springs: {f: {between: [box, front], "
        "stiffness: 9e5, damping: 3000, at: 1}, r: {between: [rear, box], stiffness: 9e5, at: -1}}"
    )
    line = (
        "{start: [0, 0], end: [25, 0], length: 25, mass: 2303, axial_stiffness: 1e9, bending_stiffness: 8.3e9, "
        "elements: 40}"
    )
    with pytest.raises(RopewalkError, match=r"run\.modes: .*load a.* write run\.modes: 40.*loads\.a\.travel\.from"):
        run(line, car, "until: 0.5 s")
