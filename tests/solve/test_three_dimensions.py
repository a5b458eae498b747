"""The chain in three dimensions: whirls, sagging cables, sideways loads, and what must not depend on the axes.

Sources: Kirchhoff, Vorlesungen ueber Mechanik, and Carrier, Q. Appl. Math. 3 (1945), in `ropewalk.theory.whirl`, which
has the skipping rope, too; Irvine and Caughey, Proc. R. Soc. A 341 (1974), in `ropewalk.theory.cable`; Fryba, ch. 18,
in `ropewalk.theory.string`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation

from closed_forms import whirls
from motion_cases import order, taut_string
from ropewalk.errors import ScenarioError
from ropewalk.model import Dynamic, Line, Scenario
from ropewalk.model.run import Start
from ropewalk.scenario import loads as from_text
from ropewalk.simulate import simulate, spectrum_of
from ropewalk.solve.choice import choose
from ropewalk.solve.motion import Progress, move
from ropewalk.solve.start import setting_of, start_state
from ropewalk.theory import cable, string, whirl

GAIN = 100.0 * (0.05 * np.pi) ** 2 / 4.0  # EA/P (pi A/L)^2 / 4 of the catalogue's case: EA/P = 100, A/L = 0.05
COSIMULATION = 2.0


def swinging(slope: float, elements: int, *, circular: bool) -> tuple[xr.Dataset, float, dict[str, float]]:
    """A string of 1 N, 1 kg/m and 1 m in its first mode of a given slope at the supports, at the gain above.

    Along it waves are sqrt(EA/P) = 10 pi 0.05 / slope times as fast as across: as the slope falls, so does what the
    theory leaves out, its square and the inertia along the line.
    """
    amplitude, stiffness = slope / np.pi, 4.0 * GAIN / slope**2
    about = {"length": 1.0, "tension": 1.0, "mass": 1.0, "axial_stiffness": stiffness}
    rest = 1.0 / (1.0 + 1.0 / stiffness)
    until = COSIMULATION * 2.0 * np.pi / float(whirl.whirl_frequency(amplitude, **about))
    line = Line(
        start=(0, 0), end=(1, 0), length=rest, mass=1.0 / rest, axial_stiffness=stiffness, elements=elements
    )  # fmt: skip
    start = Start(kind="mode", amplitude=amplitude, whirl=circular)
    run = Dynamic(until=until, every=until / 200, accuracy=1e-4, start=start)
    return simulate(Scenario(gravity=0.0, lines={"string": line}, run=run)), amplitude, about


def whirl_rate(slope: float, elements: int) -> float:
    """Angular speed of the middle over that of the theory."""
    result, amplitude, about = swinging(slope, elements, circular=True)
    y, z = result.position.values[:, elements // 2, 1:].T
    angle = np.unwrap(np.arctan2(-y, z))
    assert np.hypot(y, z) == pytest.approx(amplitude, rel=0.1 * slope**2)  # a circle, as far as the theory goes
    rate = np.polyfit(result.time.values, angle, 1)[0]
    assert np.abs(result.energy.sel(form="imbalance")).max() < 1e-6
    return float(rate / whirl.whirl_frequency(amplitude, **about))


def in_the_limit(coarse: float, fine: float) -> float:
    """The limit of numbers of second order from a mesh and one of half its links."""
    return (4.0 * fine - coarse) / 3.0


def test_a_circular_whirl_turns_at_the_rate_of_kirchhoff_and_carrier() -> None:
    rates = [whirl_rate(0.05 * np.pi, n) for n in (20, 40, 80)]
    assert 1.9 < order([1 / 20, 1 / 40], [rates[1] - rates[0], rates[2] - rates[1]]) < 2.1
    limits = [in_the_limit(*rates[1:]), in_the_limit(whirl_rate(0.025 * np.pi, 40), whirl_rate(0.025 * np.pi, 80))]
    # The theory leaves out squares of the slope, 0.025 at first: a hundredth of that is what it costs.
    assert limits[0] * 1.27155427531352 == pytest.approx(1.27155427531352, rel=3e-4)
    assert 1.8 < order([2.0, 1.0], [1.0 - limit for limit in limits]) < 2.4  # 2, and a tenth by what the step adds


def planar_miss(slope: float, elements: int) -> float:
    """Largest distance of the middle from the theory's swing, over the amplitude."""
    result, amplitude, about = swinging(slope, elements, circular=False)
    exact = whirls.planar_motion(result.time.values, amplitude=amplitude, **about)
    return float(np.abs(result.position.values[:, elements // 2, -1] - exact).max()) / amplitude


def test_a_planar_swing_is_that_of_kirchhoff_and_carrier() -> None:
    misses = [planar_miss(slope, 80) for slope in (0.1 * np.pi, 0.05 * np.pi, 0.025 * np.pi)]
    assert misses[1] < 0.03  # of two periods, 13 rad: 0.2 % of the frequency
    assert misses[0] > 2.0 * misses[1] > 3.0 * misses[2]  # towards the mesh's own 80^-2
    result, amplitude, about = swinging(0.025 * np.pi, 80, circular=False)
    z, t = result.position.values[:, 40, -1], result.time.values
    down = np.flatnonzero((z[:-1] > 0.0) & (z[1:] <= 0.0))
    crossings = t[down] + (t[1] - t[0]) * z[down] / (z[down] - z[down + 1])
    omega = 2.0 * np.pi / float(np.diff(crossings)[0])
    # Straight lines between outputs: 1e-4 of a period; the mesh: 2e-4.
    assert omega / np.pi == pytest.approx(1.20686467611556, rel=6e-4)
    assert float(whirls.planar_frequency(amplitude, **about)) / np.pi == pytest.approx(1.20686467611556, rel=1e-9)


ROPE: dict[str, float] = {"span": 1.0, "length": 1.2, "mass": 1.0, "angular_speed": 2.0 * np.pi}


def skipping(elements: int) -> np.ndarray:
    """A chain of EA = 1 MN that whirls as a rigid shape, found as an equilibrium with its centrifugal forces."""
    exact, h = whirls.skipping_rope(**ROPE), ROPE["length"] / elements
    x = np.linspace(0.0, 1.0, 4001)
    y = exact.shape(x)
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    guess = np.interp(np.linspace(0.0, way[-1], elements + 1), way, x)
    guess = np.array([guess, exact.shape(guess)])

    def unbalanced(inner: np.ndarray) -> np.ndarray:
        r = guess.copy()
        r[:, 1:-1] = inner.reshape(2, -1)
        d = np.diff(r, axis=1)
        length = np.sqrt((d * d).sum(axis=0))
        force = np.diff(1e6 * (length / h - 1.0) * d / length, axis=1)
        force[1] += ROPE["mass"] * h * ROPE["angular_speed"] ** 2 * r[1, 1:-1]
        return force.ravel()

    found = guess.copy()
    found[:, 1:-1] = fsolve(unbalanced, guess[:, 1:-1].ravel(), xtol=1e-13).reshape(2, -1)
    return found


def test_a_skipping_rope_whirls_as_one_shape_however_large() -> None:
    """The inextensible limit: EA = 1 MN at 6 N."""
    exact, misses = whirls.skipping_rope(**ROPE), []
    assert exact.radius == pytest.approx(0.301974384951906, rel=1e-12)
    for n in (20, 40):
        shape = skipping(n)
        misses.append(abs(shape[1].max() / exact.radius - 1.0))
    assert misses[-1] < 2e-3
    assert 1.8 < order([1 / 20, 1 / 40], misses) < 2.2
    line = Line(start=(0, 0, 0), end=(1, 0, 0), length=1.2, mass=1.0, axial_stiffness=1e6, elements=40)
    far = Line(start=(0, 5, 0), end=(1, 5, 0), tension=1.0, mass=1e-3, axial_stiffness=10.0, elements=2)
    scenario = Scenario(lines={"rope": line, "far": far}, run=Dynamic(until=1.0, every=0.25))
    setting = setting_of(scenario, 1.0)
    state = start_state(setting, with_loads=False)
    setting.strands.gravity[:] = 0.0  # it was there to give the slack rope some shape at rest
    own = slice(0, 41)
    state.r[:, own] = [shape[0], 0.0 * shape[1], shape[1]]
    state.w[:, own] = [0.0 * shape[1], -ROPE["angular_speed"] * shape[1], 0.0 * shape[1]]
    choice = choose(setting.strands, setting.loads, state, method="verlet", step=None, accuracy=1e-5, duration=1.0)
    progress, tension = Progress(), []
    for now in move(setting.strands, setting.loads, state, choice, 1e-5, np.array([0.25, 0.5, 1.0]), progress):
        angle = ROPE["angular_speed"] * float(now.t[0])
        turned = np.array([shape[0], -shape[1] * np.sin(angle), shape[1] * np.cos(angle)])
        # Round-off of the shape, and of many steps: any force out of balance would show at once.
        assert now.r[:, own] == pytest.approx(turned, abs=1e-5)
        stretch = np.sqrt((np.diff(now.r[:, own], axis=1) ** 2).sum(axis=0)) * 40 / 1.2
        tension.append(1e6 * (stretch.max() - 1.0))
    # The first link has the tension of its middle; second order, and the shape's own ripples.
    assert tension == pytest.approx([exact.largest_tension] * 3, rel=5e-3)


def test_out_of_the_plane_a_sagging_cable_has_the_frequencies_of_a_string() -> None:
    """Irvine and Caughey: out of the plane n pi, in it 2 n pi and the roots of their equation."""
    span, tension, weight, stiffness, turn = 100.0, 1.0, 0.001, 1000.0, 0.7
    ends = {"start": (0, 0, 0), "end": (span * np.cos(turn), span * np.sin(turn), 0)}
    mass = weight / 9.81
    line = Line(**ends, tension=tension, mass=mass, axial_stiffness=stiffness, elements=200)
    found = spectrum_of(Scenario(lines={"cable": line}), how_many=None)
    setting = setting_of(Scenario(lines={"cable": line}), 0.0)
    assert setting.bare[0] is not None
    H = float(np.linalg.norm(setting.bare[0].pull[:2, 0]))
    omega = np.sort(found.eigenvalues.imag[found.eigenvalues.imag > 0.0])[:8] * span * np.sqrt(mass / H)
    theory = cable.natural_frequencies(
        modes=5, span=span, mass=mass, horizontal_tension=H, axial_stiffness=stiffness
    )  # fmt: skip
    expected = np.sort(np.concatenate([theory.out_of_plane, theory.in_plane]))[:8] * span * np.sqrt(mass / H)
    assert expected[0] == pytest.approx(np.pi, rel=1e-12)
    print(omega / np.pi, expected / np.pi)
    # The square of the sag ratio of 1/80, times a few.
    assert omega == pytest.approx(expected, rel=2e-3)


V: dict[str, Any] = {"speed": 10.0, "from": 2.0, "at_end": "leave"}
UPWARDS = {"time": [0, 0.1, 0.1, 0.25, 0.25], "value": [[0, 0], [0, 0], [0, 1500.0], [0, 1500.0], [0, 0]]}
TWO_WHEELS: dict[str, Any] = {
    "kind": "vehicle",
    "bodies": {"body": {"mass": 40.0, "inertia": 10.0}},
    "wheels": {"front": {"at": 0.5, "mass": 5.0}, "rear": {"at": -0.5, "mass": 5.0}},
    "springs": {
        "front": {"between": ["body", "front"], "stiffness": 1e4},
        "rear": {"between": ["body", "rear"], "stiffness": 1e4, "damping": 100.0},
    },
    "travel": V,
}
SOFT: dict[str, Any] = {"kind": "oscillator", "mass": 40.0, "stiffness": 1e4, "damping": 50.0, "wheel_mass": 4.0}
FREE: dict[str, Any] = {"kind": "free", "from": 2.0, "speed": 8.0}
LOADS: dict[str, dict[str, Any]] = {
    "force": {"kind": "force", "force": [30.0, -400.0], "travel": {**V, "measured": "slip"}},
    "arc": {"kind": "force", "force": [30.0, -400.0], "travel": {**V, "measured": "arc"}},
    "force at x": {"kind": "force", "force": [0, -400.0], "travel": {**V, "measured": "horizontal"}},
    "frictionless": {"kind": "force", "force": [0, -400.0], "contact": "frictionless", "travel": V},
    "mass": {"kind": "mass", "mass": 40.0, "travel": {**V, "measured": "slip"}},
    "light mass": {"kind": "mass", "mass": 0.4, "travel": V},
    "leaving": {"kind": "mass", "mass": 40.0, "travel": {**V, "from": 17.0}},
    "mass at x": {"kind": "mass", "mass": 40.0, "travel": {**V, "measured": "horizontal"}},
    "frictionless mass": {"kind": "mass", "mass": 40.0, "contact": "frictionless", "travel": V},
    "lifted": {"kind": "mass", "mass": 40.0, "lift_off": True, "force": UPWARDS, "travel": V},
    "free": {"kind": "mass", "mass": 40.0, "air_drag": 0.5, "travel": {**FREE, "friction": 0.05, "rolling": 0.01}},
    "oscillator": {**SOFT, "travel": V},
    "soft contact": {**SOFT, "lift_off": True, "contact_stiffness": 1e5, "travel": V},
    "trolley": {"kind": "trolley", "mass": 10.0, "payload": {"mass": 30.0, "length": 2, "swing": 0.3}, "travel": FREE},
    "vehicle": TWO_WHEELS,
    "hopping vehicle": {**TWO_WHEELS, "lift_off": True},
    "coming vehicle": {**TWO_WHEELS, "travel": {**V, "from": 0.0}},
}  # fmt: skip
ROPE_OF_20: dict[str, Any] = {
    "start": [0, 0], "end": [20, 1], "length": 19.9, "mass": 1.0, "axial_stiffness": 1e5, "elements": 20,
}  # fmt: skip
# Far away, and it does not change how fine the steps are: links as long, waves as fast.
FAR: dict[str, Any] = {**ROPE_OF_20, "start": [0, 50, 0], "end": [20, 50, 1]}
SHORT: dict[str, Any] = {"kind": "dynamic", "until": 0.4, "every": 0.1, "step": 2e-4}


def run_of(lines: dict[str, Any], load: dict[str, Any] | None = None, **more: Any) -> xr.Dataset:
    loads_on = {} if load is None else {"load": {**load, "on": "rope"}}
    return simulate(Scenario.model_validate({"lines": lines, "loads": loads_on, "run": SHORT, **more}))


def same_in_space(lines: dict[str, Any], load: dict[str, Any] | None, **more: Any) -> None:
    """Run lines of a plane once more beside a line far away, and compare."""
    plane, space = run_of(lines, load, **more), run_of({**lines, "far": FAR}, load, **more)
    assert (plane.sizes["axis"], space.sizes["axis"]) == (2, 3)
    own = slice(0, plane.sizes["node"])
    position = space.position.values[:, own]
    assert np.all(position[:, :, 1] == 0.0)
    # Round-off: 20 m, a few thousand steps; forces are differences of those, times EA / h.
    assert position[:, :, [0, 2]] == pytest.approx(plane.position.values, abs=1e-10)
    for name in ("contact_force", "contact_position", "body_position"):
        if name in plane and plane[name].size:
            flat = space[name].values[:, :, [0, 2]]
            assert flat == pytest.approx(plane[name].values, abs=1e-5, nan_ok=True)
            assert not np.nan_to_num(space[name].values[:, :, 1]).any()
    reaction = space.reaction.values[:, : plane.sizes["support"]]
    assert reaction[:, :, [0, 2]] == pytest.approx(plane.reaction.values, abs=1e-5)
    for name in ("contact_in_air", "contact_state"):
        assert np.array_equal(space[name].values, plane[name].values)


@pytest.mark.parametrize("damping", [0.0, 50.0])
@pytest.mark.parametrize("name", LOADS)
def test_a_plane_scenario_is_the_same_in_space(name: str, damping: float) -> None:
    same_in_space({"rope": {**ROPE_OF_20, "axial_damping": damping}}, LOADS[name])


SUPPORTS: dict[str, dict[str, Any]] = {
    "elastic": {"kind": "elastic", "stiffness": 4e4, "damping": 200.0, "mass": 2.0},
    "guided": {"kind": "guided", "along": [1.0, 0.2], "force": 200.0, "stiffness": 2e4, "damping": 50.0, "mass": 3.0},
    "moving": {"kind": "moving", "displacement": {"time": [0, 0.1, 0.2], "value": [[0, 0], [0.05, 0.1], [0, 0]]}},
}


@pytest.mark.parametrize("support", SUPPORTS)
def test_supports_of_the_plane_are_the_same_in_space(support: str) -> None:
    rope = {**ROPE_OF_20, "end_support": SUPPORTS[support], "axial_damping": 50.0, "drag": 0.2}
    same_in_space({"rope": rope}, LOADS["force"])


def test_implicit_motion_of_the_plane_is_the_same_in_space() -> None:
    implicit = {**SHORT, "until": 0.1, "method": "implicit", "step": 1e-3}
    same_in_space({"rope": {**ROPE_OF_20, "axial_damping": 500.0}}, LOADS["force"], run=implicit)


@pytest.mark.parametrize("contact", ["clamped", "frictionless", "coulomb"])
def test_slow_motion_of_the_plane_is_the_same_in_space(contact: str) -> None:
    force = {**LOADS["force"], "contact": contact, **({"friction": 0.1} if contact == "coulomb" else {})}
    rope, slow = {**ROPE_OF_20, "length": 22.5}, {"kind": "quasistatic", "positions": 9}
    plane, space = run_of({"rope": rope}, force, run=slow), run_of({"rope": rope, "far": FAR}, force, run=slow)
    flat = space.position.values[:-1, : plane.sizes["node"]]  # the end of a path is found to 1e-5 m only
    assert flat[:, :, [0, 2]] == pytest.approx(plane.position.values[:-1], abs=1e-8)  # the tolerance of rest
    assert flat[:, :, 1] == pytest.approx(0.0, abs=1e-8)


def turned(scenario: dict[str, Any], turn: Rotation) -> dict[str, Any]:
    """A scenario with all its vectors turned."""

    def vector(value: list[float]) -> list[float]:
        return list(turn.apply(value if len(value) == 3 else [value[0], 0.0, value[1]]))

    def walk(key: str, value: Any) -> Any:
        if key in ("start", "end", "force", "along", "displacement", "at", "direction") and isinstance(value, list):
            return vector(value)
        if key in ("force", "displacement") and isinstance(value, dict):
            return {**value, "value": [vector(row) for row in value["value"]]}
        return {k: walk(k, v) for k, v in value.items()} if isinstance(value, dict) else value

    return {key: walk(key, value) for key, value in scenario.items()}


ANYWHERE = ("force", "arc", "mass", "light mass", "free", "oscillator")  # what does not know up and down
ABOUT_Z = (*ANYWHERE, "leaving", "lifted", "soft contact", "trolley", "vehicle", "hopping vehicle", "coming vehicle")
component = st.floats(-1.0, 1.0)


@st.composite
def scenarios(draw: st.DrawFn, weightless: bool) -> tuple[dict[str, Any], Rotation]:
    """A rope with a load in space, and a rotation that leaves alone what the file cannot turn."""
    sway, rise, push = draw(component), draw(component), [300.0 * draw(component) for _ in range(2)]
    name = draw(st.sampled_from(ANYWHERE if weightless else ABOUT_Z))
    load = {**LOADS[name], "on": "rope"}
    if load["kind"] == "force":
        load["force"] = [30.0, push[0], -400.0 + push[1]]
    elif load["kind"] == "mass" and name != "lifted":
        load["force"] = {"time": [0.0, 0.2], "value": [[0.0, 0.0, 0.0], [30.0, *push]]}
    elif load["kind"] == "trolley":
        payload = {"mass": 30.0, "length": 2.0, "at": [0.6, push[0] / 300.0, -1.5]}
        load["payload"] = payload if not weightless else {**payload, "stiffness": 1e5}
    support = dict(draw(st.sampled_from([{"kind": "fixed"}, *SUPPORTS.values()])))
    if support["kind"] == "guided":
        support["along"] = [1.0, sway, 0.2]
    if support["kind"] == "moving":
        support["displacement"] = {"time": [0, 0.1, 0.2], "value": [[0, 0, 0], [0.05, sway, 0.1], [0, 0, 0]]}
    rope = {
        **ROPE_OF_20, "start": [0.0, 0.0, 0.0], "end": [20.0, 2.0 * sway, 2.0 * rise],
        "axial_damping": draw(st.sampled_from([0.0, 50.0])), "drag": draw(st.sampled_from([0.0, 0.2])),
        "end_support": support,
    }  # fmt: skip
    scenario = {"lines": {"rope": rope}, "loads": {"load": load}, "run": {**SHORT, "method": "verlet"}}
    if weightless:
        numbers = st.integers(0, 2**32 - 1)
        return {**scenario, "gravity": 0.0}, Rotation.random(random_state=np.random.RandomState(draw(numbers)))
    return scenario, Rotation.from_euler("z", draw(st.floats(-3.1, 3.1)))


def the_same_turned(case: tuple[dict[str, Any], Rotation]) -> None:
    scenario, turn = case
    one, two = (simulate(Scenario.model_validate(s)) for s in (scenario, turned(scenario, turn)))
    assert one.attrs["outcome"] == two.attrs["outcome"]
    assert one.attrs["outcome"] in ("completed", "doubtful")  # 20 links are coarse for a load set down in mid-span
    for name, size in (("position", 1e-8), ("contact_position", 1e-8), ("body_position", 1e-8), ("reaction", 1e-2)):
        if not one[name].size:
            continue
        a, b = (result[name].values.reshape(-1, result.sizes["axis"]) for result in (one, two))
        a = a if a.shape[1] == 3 else np.insert(a, 1, 0.0, axis=1)
        b = b if b.shape[1] == 3 else np.insert(b, 1, 0.0, axis=1)
        kept = np.isfinite(a).all(axis=1)
        # Round-off of 2000 steps, where links are 1e5 times as stiff as they are heavy.
        assert turn.apply(a[kept]) == pytest.approx(b[kept], abs=size), name
    for name, size in (("tension", 1e-3), ("energy", 1e-4)):
        assert one[name].values == pytest.approx(two[name].values, abs=size), name


@given(scenarios(weightless=False))
@settings(deadline=None, max_examples=40)
def test_turned_about_the_vertical_a_scenario_gives_the_turned_result(case: tuple[dict[str, Any], Rotation]) -> None:
    the_same_turned(case)


@given(scenarios(weightless=True))
@settings(deadline=None, max_examples=25)
def test_turned_in_any_way_without_gravity_a_scenario_gives_the_turned_result(
    case: tuple[dict[str, Any], Rotation],
) -> None:
    the_same_turned(case)


@pytest.mark.parametrize("speed", [0.5, 0.8])
def test_a_force_pushes_a_string_sideways_as_it_does_down(speed: float) -> None:
    """Two linear theories at once: each direction has the deflection of Fryba's string."""
    scenario = taut_string(400, speed, 0.75)
    load = scenario.loads["force"]
    push = 1e-6 * np.array([0.0, 0.6, -0.8])
    sideways = scenario.model_copy(update={"loads": {"force": load.model_copy(update={"force": tuple(push)})}})
    result, line = simulate(sideways), scenario.lines["string"]
    exact = string.moving_force(
        result.xi.values[None, :], result.time.values[:, None], force=1e-6, speed=load.travel.speed,
        length=line.length, tension=line.length, mass=line.mass,
    )  # fmt: skip
    for axis, part in (("y", 0.6), ("z", -0.8)):
        miss = result.position.sel(axis=axis).values / 1e-6 - part * exact / 1e-6
        assert np.sqrt(np.mean(miss**2)) < 2e-3 * abs(part)  # the kink is smeared over a link, 1/400: less than that


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.5])
def test_a_mass_pushed_in_any_direction_is_that_of_the_string(angle: float) -> None:
    weight, length, until = 1e-5, 1.0 / (1.0 + 1e-4), 1.6
    way = np.array([0.0, np.sin(angle), -np.cos(angle)])
    line = {"start": [0, 0, 0], "end": [1, 0, 0], "length": length, "mass": 1.0, "axial_stiffness": 1e4}
    load = {"kind": "mass", "on": "rope", "mass": 1.0, "force": list(weight * way), "travel": {"speed": 0.5}}
    run = {"kind": "dynamic", "until": until, "every": until / 50}
    result = run_of({"rope": {**line, "elements": 100}, "far": {**line, "start": [0, 5, 0], "end": [1, 5, 0]}}, load,
                    gravity=0.0, run=run)  # fmt: skip
    exact = string.moving_mass(
        result.time.values, load_mass=1.0, speed=0.5, length=length, tension=length, mass=1.0, gravity=weight
    )
    found = result.contact_position.values[:, 0] / weight
    along = found @ way
    # The plane's own errors (test_moving_mass.py): first order of what a support bears of the first link.
    assert along == pytest.approx(exact.deflection / weight, abs=2e-3)
    aside = np.cross(found, way)[:, 0]
    assert np.abs(aside).max() < 1e-4  # of order 1: the weight is a millionth of what would couple the directions


SWAY = {"kind": "moving", "displacement": {"time": [0, 0.4, 0.8], "value": [[0, 0, 0], [0, 0.5, 0], [0, 0, 0]]}}
# Part of the energy turned over that 80 links may miss: as much as where the support moves up and down instead.
AUDITED = {
    "mass": 6e-3, "light mass": 2e-2, "frictionless mass": 6e-3, "lifted": 6e-3, "free": 6e-3, "oscillator": 6e-3,
    "soft contact": 6e-3, "trolley": 1e-2, "swinging trolley": 1e-2, "hopping vehicle": 6e-3,
}  # fmt: skip
ASIDE = {
    "swinging trolley": {**LOADS["trolley"], "payload": {"mass": 30.0, "length": 2.0, "at": [0.6, 1.2, -1.4]}},
    "lifted": {
        **LOADS["lifted"],
        "force": {"time": [0.1, 0.1, 0.25, 0.25], "value": [[0, 0, 0], *[[0, 300, 900]] * 2, [0, 0, 0]]},
    },
}


@pytest.mark.parametrize("name", AUDITED)
def test_the_audit_closes_with_the_mesh_where_all_is_pushed_sideways(name: str) -> None:
    links, missed = [20, 40, 80], []
    for n in links:
        rope = {**ROPE_OF_20, "elements": n, "end_support": SWAY, "axial_damping": 20.0}
        load = ASIDE[name] if name in ASIDE else LOADS[name]
        result = run_of({"rope": rope}, load, run={"kind": "dynamic", "until": 0.8, "every": 0.01})
        assert result.attrs["outcome"] == "completed", result.attrs["advice"]
        energy = {str(form): result.energy.sel(form=form).values for form in result.form.values}
        moved = energy["kinetic"] + energy["load_kinetic"]
        missed.append(float(np.abs(energy["imbalance"]).max() / np.abs(np.diff(moved)).sum()))
    print(name, missed)
    assert name not in ("lifted", "soft contact") or result.contact_in_air.values[-1, 0] > 0.05
    assert np.abs(result.contact_position.values[:, 0, 1]).max() > 0.1  # there is something sideways
    assert missed[-1] < AUDITED[name]
    assert order([1.0 / n for n in links], missed) > 0.4 or missed[-1] < 2e-4


def test_a_spring_sideways_has_its_own_stiffness() -> None:
    """The body of an oscillator on a wheel that starts to move sideways at a constant speed: y = v (t - sin(w t)/w)."""
    ramp = {"kind": "moving", "displacement": {"time": [0, 1], "value": [[0, 0, 0], [0, 0.1, 0]]}}
    rope = {
        "start": [0, 0], "end": [2, 0], "tension": 5e4, "mass": 1e-2, "axial_stiffness": 1e6, "elements": 4,
        "start_support": ramp, "end_support": ramp,
    }  # fmt: skip
    load = {
        "kind": "oscillator",
        "mass": 2.0,
        "stiffness": [900.0, 400.0, 1600.0],
        "travel": {"speed": 0, "measured": "slip", "from": 1},
    }
    result = run_of({"rope": rope}, load, gravity=0.0, run={"kind": "dynamic", "until": 0.9, "every": 0.01})
    t, omega = result.time.values, np.sqrt(400.0 / 2.0)
    # The string gives way, k = 4 P/L = 1e5 N/m in series: 0.4 % of the stiffness.
    assert result.body_position.values[:, 0, 1] == pytest.approx(0.1 * (t - np.sin(omega * t) / omega), abs=3e-4)
    assert result.body_position.values[:, 0, [0, 2]] == pytest.approx(np.array([[1.0, 0.0]] * t.size), abs=1e-9)


def test_an_elastic_support_gives_way_as_each_of_its_springs_says() -> None:
    stiffness = np.array([4e4, 1e3, 2e4])
    rope = {**ROPE_OF_20, "end_support": {"kind": "elastic", "stiffness": list(stiffness), "damping": [1, 2, 3]}}
    force = {"kind": "force", "force": [0, 50.0, -400.0], "travel": {"speed": 1, "from": 12}}
    result = run_of({"rope": rope}, force, run={"kind": "equilibrium"})
    moved = result.position.values[0, -1] - [20.0, 0.0, 1.0]
    assert moved[1] > 0.02  # 31 N of the 50 N
    assert stiffness * moved == pytest.approx(-result.reaction.values[0, 1], rel=1e-6)


PLANE = """
lines:
  rope:
    start: [0, 0]
    end: [20, 0]
    length: 20.5
    mass: 1
    axial_stiffness: 1e5
    end_support: {kind: elastic, stiffness: [40 kN/m, 20 kN/m], damping: [1, 2]}
  %s: {start: [0, 0], end: [20, %s, 0], length: 21, mass: 1, axial_stiffness: 1e5}
loads:
  sprung: {kind: oscillator, on: rope, mass: 8, stiffness: [1, 2], damping: [1, 2], travel: {speed: 1}}
run: {kind: dynamic, until: 1 s}
"""


def test_two_springs_are_for_the_plane_and_refused_in_space() -> None:
    from_text(PLANE % ("other", "0"), "plane.yaml")
    with pytest.raises(ScenarioError) as caught:
        from_text(PLANE % ("other", "3"), "space.yaml")
    assert str(caught.value).splitlines() == [
        f"space.yaml:{line}: {key}{name}: lines.other leaves the x-z plane, and two values do not define the "
        f"direction y, given {given}; write [{k}x, {k}y, {k}z]{more}, or one value for all directions"
        for line, key, values in ((9, "lines.rope.end_support.", "[40000, 20000]"), (12, "loads.sprung.", "[1, 2]"))
        for name, k, given, more in (("damping", "c", "[1, 2]", " (cy: 0 for none)"), ("stiffness", "k", values, ""))
    ]


ASKEW = """
lines:
  rope: {start: [0, 0], end: [20, 3, 0], length: 20.5, mass: 1, axial_stiffness: 1e5}
loads:
  a: {kind: force, on: rope, force: [0, -1], travel: {speed: 1, measured: horizontal, at_end: leave}}
  b: {kind: mass, on: rope, mass: 1, contact: frictionless, travel: {speed: 1, from: 2, at_end: leave}}
run: {kind: dynamic, until: 1 s}
"""


def test_what_goes_by_x_is_refused_on_a_line_that_does_not_run_along_it() -> None:
    with pytest.raises(ScenarioError) as caught:
        from_text(ASKEW, "askew.yaml")
    assert str(caught.value).splitlines() == [
        "askew.yaml:5: loads.a.travel.measured: horizontal means along x, and the ends of rope differ in y, "
        "given horizontal; write slip or material, or turn the axes so that rope extends along x",
        "askew.yaml:6: loads.b.contact: the force that holds such a contact acts along x, and the ends of rope differ "
        "in y, given frictionless; write clamped, or turn the axes so that rope extends along x",
    ]
    from_text(ASKEW.replace("[20, 3, 0]", "[20, 0, 0]"), "along.yaml")
