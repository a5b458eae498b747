"""Heads as rigid bodies: two strips, pitch and roll, against statics by hand, formulas, and equations written anew."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import ValidationError
from scipy.integrate import solve_ivp

from overhead_cases import EN_2002
from ropewalk.cosim.vehicle import alone
from ropewalk.errors import RopewalkError
from ropewalk.mechanics.pantograph_matrices import row_of
from ropewalk.model import Scenario
from ropewalk.model.pantograph import Pantograph
from ropewalk.overhead.lateral import across
from ropewalk.overhead.pantograph_loads import Above, moving_load_of
from ropewalk.results.contact_statistics import samples
from ropewalk.results.course import transitions
from ropewalk.results.frame import RunInfo
from ropewalk.results.statistics import summary
from ropewalk.simulate import simulate
from ropewalk.wires.frames import Wires
from ropewalk.wires.mesh import clamped_at, mesh_of, moving_loads_of
from ropewalk.wires.plan import Hold, Spot, Wire, WirePlan
from ropewalk.wires.prescribed_motion import PrescribedMotion
from ropewalk.wires.pressing import pressing
from ropewalk.wires.rest import rest_of, rows
from ropewalk.wires.task import Displayed, WireTask

Array = NDArray[np.float64]
S, D, B = 0.54, 0.4, 0.9  # m: between strips, between their springs, between horns
J, I = 0.3, 1.1  # kg m^2
K, C, TOUCH, PUSH = 4200.0, 12.0, 50e3, 120.0  # N/m, N s/m, N/m, N
FRAME, PAN, DAMPER = 15.0, 7.2, 90.0  # kg, kg, N s/m
PITCH = {"inertia": J, "spring_spacing": D}
ROLL = {"inertia": I, "spring_spacing": B}
HEAD = {"spacing": S, "pitch": PITCH, "roll": ROLL}
OWN: dict[str, Any] = {
    "on": "line", "masses": [FRAME, PAN], "stiffness": [0.0, K], "damping": [DAMPER, C], "static_force": PUSH,
    "travel": {"speed": 40.0},
}  # fmt: skip
LINE = EN_2002 | {
    "spans": {"count": 3, "length": "40 m"}, "droppers": {"per_span": 4, "stiffness": "100 kN/m"}, "element": "0.25 m",
    "analysed_spans": [2, 2], "steady_arms": {"stagger": "200 mm"},
}  # fmt: skip


def pantograph(head: dict[str, Any] | None = HEAD, **changes: Any) -> Pantograph:
    return Pantograph.model_validate(OWN | {"head": head} | changes)


def scenario(
    head: dict[str, Any] | None = HEAD, start: float = 50.0, line: dict[str, Any] = LINE, load: Any = None, **run: Any
) -> Scenario:
    if run.get("kind") != "equilibrium":
        run = {"kind": "dynamic", "geometry": "linearised", "until": 0.6, "every": 0.1} | run
    own = OWN | {"kind": "pantograph", "travel": {"speed": 50.0, "from": start}, "head": head} | (load or {})
    lines = line if "first" in line else {"line": line}
    return Scenario.model_validate({"overhead_lines": lines, "loads": {"front": own}, "run": run})


# --- statics, by hand ---


def test_strips_share_the_force_as_the_balance_of_moments_has_it() -> None:
    """(F1 - F2) s/2 = -k d^2/4 pitch, F1 - F2 = c (s pitch - h1 + h2), F1 + F2 the push."""
    load = moving_load_of("front", pantograph({"spacing": S, "pitch": PITCH}))
    motion = PrescribedMotion(load, np.zeros_like, push=lambda t: np.array([[PUSH, 0.0, 0.0]] * t.size))
    none = np.zeros(2)
    found = pressing(
        [motion], moving_loads_of([load]), 0.0, none, none, none, np.ones(2, dtype=bool), np.full(2, np.nan)
    )
    height = np.array([5e-3, 1e-3])
    force, pitch = found.given - found.stiffness @ height, found.coordinates(height)[2]
    turns = 0.25 * K * D**2
    assert pitch == pytest.approx(0.5 * TOUCH * S * 4e-3 / (turns + 0.5 * TOUCH * S**2), rel=1e-12)
    np.testing.assert_allclose(force, 0.5 * PUSH - np.array([1.0, -1.0]) * turns * pitch / S, rtol=1e-9)
    np.testing.assert_allclose(found.given, 0.5 * PUSH, rtol=1e-12)  # on a level rail
    assert abs(force[0] - force[1]) > 3.0


def test_a_line_at_rest_turns_the_head_as_its_forces_and_the_stagger_have_it() -> None:
    """At 50 m it is 10 m from a support at -200 mm to one at 200 mm: at -100 mm. Horns share as 1/2 +- y / b."""
    result = simulate(scenario(kind="equilibrium"))
    height = dict(zip(result["body"].values.tolist(), result["body_position"].values[0, :, -1], strict=True))
    force, y = result["contact_force"].values[0, :, -1], -0.1
    assert force.sum() == pytest.approx(PUSH, rel=1e-9)
    pitch = (height["front.head.leading"] - height["front.head.trailing"]) / S
    assert (force[0] - force[1]) * S / 2.0 == pytest.approx(-0.25 * K * D**2 * pitch, rel=1e-6)
    horns = {side: 0.5 * K * (height["front.frame"] - height[f"front.head.{side}"]) for side in ("left", "right")}
    stations = result["contact_xi"].values[0]
    assert stations == pytest.approx([50.0 + S / 2.0, 50.0 - S / 2.0])
    # Each strip presses at its own place: that ahead 2.7 mm farther to the left.
    mean = float(force @ (y + np.array([0.5, -0.5]) * S * 0.01)) / PUSH
    assert horns["left"] / PUSH == pytest.approx(0.5 + mean / B, rel=1e-6)
    assert horns["right"] / PUSH == pytest.approx(0.5 - mean / B, rel=1e-6)


def test_a_pan_with_its_mass_at_the_strips_and_springs_there_is_two_strips_apart() -> None:
    """J = m s^2 / 4 and d = s: each strip has half of the mass on half of the spring."""
    head = {"spacing": S, "pitch": {"inertia": 0.25 * PAN * S**2, "spring_spacing": S}}
    load = moving_load_of("front", pantograph(head))
    strips = np.vstack([np.eye(3)[0], *(contact.row for contact in load.contacts)])  # frame, strips
    back = np.linalg.inv(strips)
    np.testing.assert_allclose(back.T @ load.mass @ back, np.diag([FRAME, PAN / 2.0, PAN / 2.0]), atol=1e-12)
    half = K / 2.0
    wanted = [[K, -half, -half], [-half, half, 0.0], [-half, 0.0, half]]
    np.testing.assert_allclose(back.T @ load.stiffness @ back, wanted, atol=1e-9)


# --- on a rail: a wire of a million tons a metre ---

RAIL = WirePlan((Wire("rail", (0.0, 0.0, 0.0), (60.0, 0.0, 0.0), 1e9, 1e9),), gravity=0.0)
SPEED, START, WAVE = 20.0, 10.0, 3.0  # m/s, m, m


def rough(x: Array | float) -> Array:
    """Begins without a slope at both strips."""
    x = np.asarray(x, dtype=np.float64) - START - 0.5
    return np.where(x > 0.0, 4e-3 * np.sin(2.0 * np.pi * x / WAVE) * np.tanh(x) ** 2, 0.0)


def aside(x: Array | float) -> Array:
    return np.asarray(0.2 * np.cos(np.asarray(x, dtype=np.float64) / 2.5))


def ramp(t: Array | float) -> Array:
    return np.asarray(PUSH * np.clip(np.asarray(t) / 0.05, 0.0, 1.0) ** 2)


def on_the_rail(
    one: Pantograph, above: Above, step: float, first: Array, until: float, push: Callable[[Array], Array], speed: float
) -> tuple[Array, Array, Array]:
    """Instants, forces of the strips (instant, strip) N, and pitch, rad."""
    load = moving_load_of("front", one, {0: above})
    motion = PrescribedMotion(load, lambda t: START + speed * np.asarray(t), push=push, first=first)
    lever = row_of(one, ahead=1.0) - row_of(one)
    task = WireTask(
        RAIL,
        (motion,),
        tuple(f"strip {k}" for k in range(len(load.contacts))),
        (Displayed("pitch", 0, lever, 0.0),),
        1.0,
        "linearised",
    )
    times = np.linspace(0.0, until, 101)
    engine = Wires(task, times, RunInfo(), step, step)  # what is given is linear between samples
    notes = [engine.note() for i in range(times.size) if engine.advance(i) is None]
    of = engine.frames(notes).of
    return times, of["contact_force"][:, :, -1], of["body_position"][:, 0, -1]


def test_pitch_swings_on_a_rail_with_its_frequency() -> None:
    """omega^2 = (k d^2 / 4 + c s^2 / 2) / J, while both strips are on the rail."""
    one = pantograph({"spacing": S, "pitch": PITCH}, damping=[0.0, 0.0])
    level = PUSH / (2.0 * TOUCH)
    first = np.array([level + PUSH / K, level, 1e-3])
    t, force, pitch = on_the_rail(
        one, Above(), 1e-4, first, 0.2, lambda t: np.array([[PUSH, 0.0, 0.0]] * np.size(t)), 0.0
    )
    omega = math.sqrt((0.25 * K * D**2 + 0.5 * TOUCH * S**2) / J)
    assert force.min() > 40.0
    # Central differences swing faster by (omega dt)^2 / 24 = 1e-5, half a step ahead: 5 periods.
    np.testing.assert_allclose(pitch, 1e-3 * np.cos(omega * t), atol=1.5e-5)
    np.testing.assert_allclose(force[:, 0] - force[:, 1], TOUCH * S * pitch, atol=1e-2)


def test_strips_on_a_rough_rail_that_goes_from_side_to_side_against_the_equations_with_four_springs() -> None:
    one = pantograph(HEAD)

    def change(t: float, u: Array) -> Array:
        zf, zh, pitch, roll, vf, vh, vp, vr = u
        frame, pan, moment, tilt = float(ramp(t)) - DAMPER * vf, 0.0, 0.0, 0.0
        for x in (-D / 2.0, D / 2.0):  # quarters of the spring and of the damper, at the corners
            for y in (-B / 2.0, B / 2.0):
                up = 0.25 * (K * (zf - zh - x * pitch - y * roll) + C * (vf - vh - x * vp - y * vr))
                frame, pan, moment, tilt = frame - up, pan + up, moment + x * up, tilt + y * up
        for x in (-S / 2.0, S / 2.0):
            station = START + SPEED * t + x
            y = float(aside(station))
            down = TOUCH * max(zh + x * pitch + y * roll - float(rough(station)), 0.0)
            pan, moment, tilt = pan - down, moment - x * down, tilt - y * down
        return np.array([vf, vh, vp, vr, frame / FRAME, pan / PAN, moment / J, tilt / I])

    until = 0.4
    times = np.linspace(0.0, until, 101)
    exact = solve_ivp(change, (0.0, until), np.zeros(8), t_eval=times, rtol=1e-9, atol=1e-12, max_step=1e-3).y
    x = np.array([S / 2.0, -S / 2.0])
    stations = START + SPEED * times[:, None] + x
    heights = exact[1][:, None] + exact[2][:, None] * x + exact[3][:, None] * aside(stations)
    wanted = TOUCH * np.maximum(heights - rough(stations), 0.0)
    assert np.abs(wanted[:, 0] - wanted[:, 1]).max() > 30.0
    assert np.abs(exact[3]).max() > 0.02
    assert (wanted == 0.0).sum() > 5  # strips lose contact
    above, off = Above(rough=rough, aside=aside, widest=0.2), []
    for step in (4e-4, 2e-4):
        _, force, _ = on_the_rail(
            one,
            above,
            step,
            np.zeros(4),
            until,
            lambda t: ramp(t)[..., None] * np.eye(4)[0],
            SPEED,
        )
        off.append(float(np.abs(force - wanted).max()))
    assert off[1] < 0.5
    assert off[0] / off[1] == pytest.approx(4.0, rel=0.35)  # of the second order


def test_strips_at_one_place_on_a_rail_are_a_head_that_is_a_point() -> None:
    """With half of its contact stiffness each; and in the middle nothing makes it roll."""
    found = []
    for one in (pantograph({"spacing": 1e-9, "roll": ROLL}, contact_stiffness=0.5 * TOUCH), pantograph(None)):
        size = 2 + (one.head is not None)

        def push(t: Array, size: int = size) -> Array:
            return ramp(t)[..., None] * np.eye(size)[0]

        _, force, _ = on_the_rail(one, Above(rough=rough), 4e-4, np.zeros(size), 0.4, push, SPEED)
        found.append(force)
    np.testing.assert_allclose(found[0].sum(axis=1), found[1][:, 0], atol=5e-3)  # the rail yields by 1e-10 m/N
    assert found[1].max() > 200.0


# --- below overhead lines ---


def test_strips_two_links_apart_yield_as_a_string_does_under_both_of_them() -> None:
    """u(x) = sum F min(x, a) (l - max(x, a)) / (T l); a contact stiffness of 50 kN/m makes 0.1 mm 5 N."""
    length, tension, force = 40.0, 20e3, 60.0
    apart = {}
    for element in (0.25, 1.0):
        off = []
        for middle in 20.0 + element * np.array([0.0, 0.3, 0.5, 0.8]):
            x = middle + np.array([S / 2.0, -S / 2.0])
            holds = tuple(Hold(f"{a}", Spot(0, float(a)), (0.0,) * 3, force=(0.0, 0.0, force)) for a in x)
            wire = Wire("wire", (0.0, 0.0, 0.0), (length, 0.0, 0.0), tension, 1.35)
            mesh = mesh_of(WirePlan((wire,), holds=holds, gravity=0.0), element)
            at = clamped_at(mesh.strands, [hold.spot for hold in holds])
            height = rows(at, mesh.nodes) @ rest_of(mesh).position[2] + at.local * force
            low, high = np.minimum.outer(x, x), np.maximum.outer(x, x)
            off.append(np.abs(height - force * (low * (length - high)).sum(axis=1) / (tension * length)).max())
        apart[element] = max(off)
    assert apart[0.25] < 2e-6
    assert apart[1.0] > 1e-4  # refused


# --- runs ---


@pytest.mark.parametrize("geometry", ["linearised", "nonlinear"])
def test_what_guides_the_wire_across_a_head_that_rolls_is_in_the_audit(geometry: str) -> None:
    """F roll dy is 0.2 J on the way; what is left is that of a head that is a point: 0.15 J of large motion."""
    point, head = (
        simulate(scenario(head, 15.0, geometry=geometry, step=5e-4))["energy"].sel(form="imbalance").values
        for head in (None, HEAD)
    )
    assert np.abs(head - point).max() < 3e-3


def test_two_strips_go_over_from_one_contact_wire_to_the_other_one_after_the_other() -> None:
    """And the run the other way is the mirrored one."""
    heights = [0.0, 0.0, 0.12, 0.5]
    lines = {
        "first": LINE | {"heights": heights, "overlap": "second"},
        "second": LINE | {"heights": heights[::-1], "start": [40.0, 0.0]},
    }
    there = simulate(scenario(start=55.0, line=lines, load={"on": "first"}, step=5e-4))
    back = {"on": "second", "travel": {"speed": -50.0, "from": 160.0 - 55.0 - 40.0}}
    back_again = simulate(scenario(line=lines, load=back, step=5e-4))
    assert there["load"].values.tolist() == ["front", "front.trailing", "front.second", "front.second.trailing"]
    one, other = samples(there), samples(back_again)
    share, force = one["share"].values, one["force"].values[:, 0]
    np.testing.assert_allclose(force, share.sum(axis=1), rtol=1e-12)
    np.testing.assert_allclose(other["force"].values[:, 0], force, atol=1e-5)
    np.testing.assert_allclose(other["station"].values[:, 0], 120.0 - one["station"].values[:, 0], atol=1e-9)
    (passed,) = transitions(Scenario.model_validate_json(there.attrs["scenario"]), one)["front"]
    station, both = one["station"].values[:, 0], (share[:, :2].any(axis=1) & share[:, 2:].any(axis=1))
    assert passed["first"] == station[share[:, 2:].any(axis=1)][0]
    assert passed["last"] == station[share[:, :2].any(axis=1)][-1]
    assert passed["together"] == pytest.approx(1e-3 * both.sum())
    assert share.max(axis=0).min() > 30.0


def test_a_wide_head_in_statistics_has_the_sum_and_each_strip() -> None:
    result = simulate(scenario(start=30.0, until=1.6))
    found, flat = summary(result)["pantographs"]["front"], samples(result)
    strips = {key: {name: own["value"] for name, own in strip.items()} for key, strip in found["strips"].items()}
    assert sum(strip["mean"] for strip in strips.values()) == pytest.approx(found["mean"]["value"], rel=1e-9)
    assert max(strip["deviation"] for strip in strips.values()) < found["deviation"]["value"]
    assert strips["leading"]["deviation"] != strips["trailing"]["deviation"]
    np.testing.assert_allclose(flat["force"][:, 0], flat["share"].sum(axis=1), rtol=1e-12)
    np.testing.assert_allclose(flat["station"][:, 0], 30.0 + 50.0 * flat["time"], atol=1e-9)  # of the middle
    np.testing.assert_allclose(flat["station"][:, 1], 30.0 - S / 2.0 + 50.0 * flat["time"], atol=1e-9)
    # 200 mm aside the roll of a slow head is F y / (k b^2 / 4).
    slow = PUSH * 0.2 / (0.25 * K * B**2)
    assert found["rotations"]["roll"]["max"]["value"] == pytest.approx(slow, rel=0.3)
    assert found["rotations"]["roll"]["min"]["value"] == pytest.approx(-slow, rel=0.3)


def test_backwards_the_leading_strip_is_that_nearer_to_the_start() -> None:
    assert pantograph(travel={"speed": -40.0, "from": 50.0}).strips == {"": -S / 2.0, "trailing": S / 2.0}
    table = {"time": [0.0, 1.0], "value": [1.0, -30.0]}
    assert pantograph(travel={"speed": table}).strips == {"": -S / 2.0, "trailing": S / 2.0}
    assert pantograph().strips == {"": S / 2.0, "trailing": -S / 2.0}


def test_the_place_across_the_head_is_that_of_the_stagger_and_the_curve() -> None:
    line = scenario(line=LINE | {"radius": [0, 0, 1000.0]}).overhead_lines["line"]
    found = across(line, np.array([0.0, 10.0, 40.0, 60.0, 100.0, 120.0]))
    # Halfway along the third span: in the middle of its staggers, and 40^2 / (8 R) to the inside.
    np.testing.assert_allclose(found, [0.2, 0.1, -0.2, 0.0, 1.6 / 8.0, -0.2], atol=1e-12)


# --- elsewhere ---


def test_a_head_that_pitches_goes_to_other_programs_and_one_that_rolls_does_not() -> None:
    lone = alone(scenario({"spacing": S, "pitch": PITCH}), "front")
    assert [touch.behind for touch in lone.touches] == [-S / 2.0, S / 2.0]
    np.testing.assert_allclose(lone.spread @ [0.01, 0.01], [0.01, 0.01, 0.0], atol=1e-15)
    np.testing.assert_allclose(lone.spread @ [1e-3, -1e-3], [0.0, 0.0, 2e-3 / S], atol=1e-15)
    with pytest.raises(RopewalkError, match="a head that rolls has to know where the wire runs"):
        alone(scenario(), "front")


@pytest.mark.parametrize(
    ("head", "where", "message"),
    [
        ({}, "spacing", "is required with two strips"),
        ({"spacing": 0.0}, "spacing", "positive"),
        ({"strips": 3, "spacing": S}, "strips", "1 or 2"),
        ({"strips": 1}, "strips", "one strip that does not roll is a point"),
        ({"strips": 1, "roll": ROLL, "spacing": S}, "spacing", "one strip is in the middle of the head"),
        ({"strips": 1, "roll": ROLL, "pitch": PITCH}, "pitch", "has no pitching moment"),
        ({"spacing": S, "pitch": {"inertia": 0.0, "spring_spacing": D}}, "inertia", "positive"),
        ({"spacing": S, "roll": {"inertia": I}}, "spring_spacing", "required"),
    ],
)
def test_heads_that_cannot_be_are_refused(head: dict[str, Any], where: str, message: str) -> None:
    with pytest.raises(ValidationError, match=message) as caught:
        scenario(head)
    assert where in str(caught.value)


def test_strips_are_two_links_apart_and_start_on_the_line() -> None:
    with pytest.raises(
        ValidationError, match=r"less than 2 links .* of line apart.*overhead_lines.line.element: 0.27 m"
    ):
        scenario(line=LINE | {"element": 0.3})
    with pytest.raises(ValidationError, match=r"the strip trailing would start before the start of line.*0.27 m"):
        scenario(start=0.1)
