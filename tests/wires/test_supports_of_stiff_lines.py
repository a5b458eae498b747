"""Ends of stiff lines on springs, dampers, rails, masses, and ends that move: exact solutions, and the chain."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from ropewalk.capabilities import SYSTEM, engine_of
from ropewalk.cosim import stepwise
from ropewalk.model import Scenario
from ropewalk.results.frame import ENERGY_FORMS
from ropewalk.simulate import simulate, spectrum_of
from ropewalk.wires.bending import shares
from ropewalk.wires.plan import Array, Hold, Spot, Wire, WirePlan
from ropewalk.wires.spectrum import spectrum
from ropewalk.wires.task import WireTask

GEOMETRIES = ("linearised", "nonlinear")
LENGTH, MASS, EI = 10.0, 50.0, 2e6
BEARING = 4e5  # N/m, of a support; a load in the middle sinks with it about as much as the beam bends


def scenario(line: dict[str, Any], run: dict[str, Any], gravity: float = 0.0, **loads: Any) -> Scenario:
    return Scenario.model_validate({"gravity": gravity, "lines": {"line": line}, "loads": loads, "run": run})


def beam(elements: int, **supports: Any) -> dict[str, Any]:
    return {
        "start": [0, 0], "end": [LENGTH, 0], "length": LENGTH, "mass": MASS, "axial_stiffness": 1e9,
        "bending_stiffness": EI, "elements": elements, **supports,
    }  # fmt: skip


def both(**support: Any) -> dict[str, Any]:
    """The same at both ends, fast along the beam at the start: springs along it would have nothing to do."""
    return {"start_support": support, "end_support": support}


# -- At rest -------------------------------------------------------------------------------------------------------


def test_a_beam_on_elastic_bearings_sinks_by_their_share_of_a_load_in_the_middle() -> None:
    """P L^3 / (48 EI) + P / (2 k): the second exactly, whatever the mesh; the first of its second order."""
    load = {"kind": "force", "on": "line", "force": [0, -1.0], "travel": {"speed": 0.0, "from": 0.5 * LENGTH}}
    errors, exact = [], LENGTH**3 / (48.0 * EI)
    for elements in (10, 20, 40):
        sunk = []
        for support in ({"kind": "fixed"}, {"kind": "elastic", "stiffness": BEARING}):
            result = simulate(scenario(beam(elements, **both(**support)), {"kind": "equilibrium"}, force=load))
            sunk.append(-float(result.contact_position[0, 0, 1]))
            np.testing.assert_allclose(result.reaction[0, :, 1], [0.5, 0.5], rtol=1e-9)
        assert sunk[1] - sunk[0] == pytest.approx(0.5 / BEARING, rel=1e-7)  # of deflections of 1e-5 m, rounded at 1e-13
        errors.append(abs(sunk[0] / exact - 1.0))
    print("errors", errors, "orders", np.log2(np.divide(errors[:-1], errors[1:])))
    assert errors[-1] < 2e-3
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([2.0, 2.0], abs=0.1)


TAUT = {"start": [0, 0], "end": [20, 0], "mass": 1.0, "axial_stiffness": 1e6, "elements": 80}
YIELDING = {
    "springs": {"kind": "elastic", "stiffness": [2e5, 5e4], "mass": 10.0},
    "vertical rail": {"kind": "guided", "along": [0, 1], "stiffness": 1e5},
    "inclined rail": {"kind": "guided", "along": [1, 1], "stiffness": 2.5e5, "force": 300.0},
}


@pytest.mark.parametrize("gravity", [0.0, 9.81])
@pytest.mark.parametrize("support", YIELDING.values(), ids=YIELDING)
def test_a_tension_is_the_mean_one_at_rest_whatever_yields(support: dict[str, Any], gravity: float) -> None:
    """On the chain and, with next to no stiffness, on wires: the same shape, and the same support forces."""
    rope, wire = (
        simulate(scenario({**TAUT, "tension": 1e4, "end_support": support, **more}, {"kind": "equilibrium"}, gravity))
        for more in ({}, {"bending_stiffness": 1e-9})
    )
    for result in (rope, wire):
        assert float(result.tension.mean()) == pytest.approx(1e4, rel=2e-6)
    np.testing.assert_allclose(wire.position, rope.position, atol=2e-7)  # 1e-6 of a tension, over EA / L
    np.testing.assert_allclose(wire.reaction, rope.reaction, atol=0.05)  # a rail holds as 1e12 N/m
    assert float(wire.reaction[0, :, 1].sum()) == pytest.approx(gravity * float(wire.xi.max()), abs=0.05)


def test_a_slow_force_finds_supports_where_they_are_then() -> None:
    """A support that sinks by u tilts the beam: the place of the load sinks by u x / L, at any instant."""
    table = {"time": [0.0, 1.0], "value": [[0, 0], [0, -0.01]]}
    load = {"kind": "force", "on": "line", "force": [0, -1e-3], "travel": {"speed": LENGTH, "from": 0.0}}
    line = beam(40, end_support={"kind": "moving", "displacement": table})
    result = simulate(scenario(line, {"kind": "quasistatic", "positions": 11}, force=load))
    x = result.load_path.values
    assert result.contact_position.values[:, 0, 1] == pytest.approx(-0.01 * (x / LENGTH) ** 2, abs=1e-7)


# -- Frequencies ---------------------------------------------------------------------------------------------------


def on_springs(stiffness: float, mass: float) -> Array:
    """The three lowest frequencies of a beam on two springs with masses, rad/s.

    y = cosines, sines and their hyperbolic twins of b x, with y'' = 0 and EI y''' = -/+ (k - M omega^2) y at its ends.
    """

    def determinant(b: float) -> float:
        omega2 = EI * b**4 / MASS
        k, x = (stiffness - mass * omega2) / (EI * b**3), b * LENGTH
        c, s, C, S = np.cos(x), np.sin(x), np.cosh(x), np.sinh(x)
        rows = [
            [-1.0, 0.0, 1.0, 0.0], [k, -1.0, k, 1.0],
            [-c, -s, C, S], [s - k * c, -c - k * s, S - k * C, C - k * S],
        ]  # fmt: skip
        return float(np.linalg.det(np.array(rows) / np.array([1.0, 1.0, C, C])[:, None]))

    b = np.linspace(0.02, 1.2, 2000)
    signs = np.sign([determinant(v) for v in b])
    roots = [brentq(determinant, b[i], b[i + 1], xtol=1e-14) for i in np.flatnonzero(signs[:-1] != signs[1:])[:3]]
    return np.array(roots) ** 2 * np.sqrt(EI / MASS)


def near(frequencies: Array, exact: Array) -> Array:
    return np.array([frequencies[np.abs(frequencies - w).argmin()] for w in exact])


@pytest.mark.parametrize("mass", [0.0, 100.0])
def test_a_beam_on_two_springs_has_the_frequencies_of_its_characteristic_equation(mass: float) -> None:
    exact, errors = on_springs(BEARING, mass), []
    assert exact[0] < 0.95 * np.pi**2 / LENGTH**2 * np.sqrt(EI / MASS)
    for elements in (20, 40, 80):
        support = {"kind": "elastic", "stiffness": BEARING, "mass": mass}
        modes = spectrum_of(scenario(beam(elements, **both(**support)), {"kind": "equilibrium"}), how_many=12).modes
        assert modes is not None
        errors.append(np.abs(near(modes.frequency, exact) / exact - 1.0))
    order = np.log2(np.divide(errors[:-1], errors[1:]))
    print("exact", exact, "errors", errors, "orders", order)
    assert (errors[-1] < 2e-3).all()
    assert order == pytest.approx(np.full((2, 3), 2.0), abs=0.15)


def over_spans(spans: int) -> Array:
    """Frequencies of a beam over equal spans, rad/s, from the three-moment equation of vibrating spans.

    With p = b l, M_j = sin(pi j n / spans) and ends that may turn: coth p - cot p + (1/sin p - 1/sinh p) cos(pi n /
    spans) = 0, and sin p = 0 of spans that do not feel each other.
    """

    def unlike(p: float, n: int) -> float:
        restrained = np.sin(p) * np.cosh(p) - np.cos(p) * np.sinh(p)
        return float((restrained + (np.sinh(p) - np.sin(p)) * np.cos(np.pi * n / spans)) / np.cosh(p))

    found = [np.pi]
    for n in range(1, spans):
        p = np.linspace(0.5, 1.6 * np.pi, 400)
        signs = np.sign([unlike(v, n) for v in p])
        found += [brentq(unlike, p[i], p[i + 1], args=(n,)) for i in np.flatnonzero(signs[:-1] != signs[1:])]
    return np.sort(found)[:spans] ** 2 * np.sqrt(EI / MASS) * (spans / LENGTH) ** 2


@pytest.mark.parametrize("spans", [2, 3])
def test_a_beam_over_several_spans_has_the_frequencies_of_the_three_moment_equation(spans: int) -> None:
    wire = Wire("beam", (0.0, 0.0, 0.0), (LENGTH, 0.0, 0.0), 0.0, MASS, EI, 1e9, unstrained=LENGTH)
    stations = LENGTH / spans * np.arange(1, spans)
    piers = tuple(Hold(f"pier {s:g}", Spot(0, float(s)), (0.0, np.inf, np.inf), place=(s, 0.0, 0.0)) for s in stations)
    exact, errors = over_spans(spans), []
    for links in (48, 96, 192):
        modes = spectrum(
            WireTask(WirePlan((wire,), holds=piers, gravity=0.0), (), (), element=[links]), 2 * spans + 2
        ).modes
        assert modes is not None
        errors.append(np.abs(near(modes.frequency, exact) / exact - 1.0))
    print("exact", exact, "errors", errors, "orders", np.log2(np.divide(errors[:-1], errors[1:])))
    assert (errors[-1] < 1e-3).all()
    # At a pier the spline rounds the jump of the third derivative, so the order comes to 2 from below.
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(np.full((2, spans), 2.0), abs=0.12)


# -- In motion -----------------------------------------------------------------------------------------------------

STRING: dict[str, Any] = {
    "start": [0, 0], "end": [10, 0], "tension": 1e3, "mass": 0.1, "axial_stiffness": 1e6, "bending_stiffness": 1e-9,
}  # fmt: skip
IMPEDANCE = 10.0  # N s/m, sqrt(tension mass per length) but for its strain of a thousandth
RISE, HIGH = 0.04, 1e-3  # s, m: a smooth rise of one end; waves take 0.1 s to the other


def rises(t: float) -> tuple[float, float]:
    s = min(max(t / RISE, 0.0), 1.0)
    return 0.0, HIGH * s**4 * (35.0 - 84.0 * s + 70.0 * s**2 - 20.0 * s**3)


def rate(t: float) -> float:
    s = min(max(t / RISE, 0.0), 1.0)
    return HIGH / RISE * 140.0 * (s * (1.0 - s)) ** 3


def shaken(elements: int, support: dict[str, Any], until: float = 0.19, **run: Any) -> Any:
    """A string whose start rises; waves have come to its end and not back again."""
    start = {"kind": "moving", "displacement": rises}
    line = {**STRING, "elements": elements, "start_support": start, "end_support": support}
    return simulate(scenario(line, {"kind": "dynamic", "until": until, "every": 2e-3, **run}))


ENDS = {
    "spring": (300.0, 0.0, 0.0), "dashpot": (1e-3, 5.0, 0.0), "strong dashpot": (1e-3, 1e6, 0.0),
    "mass": (1e-3, 0.0, 0.2), "all": (500.0, 8.0, 0.1),
}  # fmt: skip


@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize(("k", "c", "m"), ENDS.values(), ids=ENDS)
def test_an_elastic_end_answers_a_wave_as_an_oscillator_with_the_impedance_of_the_string(
    k: float, c: float, m: float, geometry: str
) -> None:
    """m q'' + (c + Z) q' + k q = 2 Z f' for a wave f that comes to it, as w = f(t - x/a) + g(t + x/a) says."""
    a = np.sqrt(1e4 / (1.001 if geometry == "nonlinear" else 1.0))  # tension over mass, of the unstrained line
    Z = 0.1 * a

    def right(t: float, y: Array) -> tuple[float, float]:
        force = 2.0 * Z * rate(t - delay) - (c + Z) * y[1] - k * y[0]
        return (y[1], force / m) if m else ((2.0 * Z * rate(t - delay) - k * y[0]) / (c + Z), 0.0)

    errors, delay = [], 0.0
    for elements in (50, 100):
        result = shaken(elements, {"kind": "elastic", "stiffness": [1e6, k], "damping": c, "mass": m},
                        geometry=geometry)  # fmt: skip
        t, delay = result.time.values, float(result.xi.max()) / a
        exact = solve_ivp(right, (0.0, t[-1]), (0.0, 0.0), t_eval=t, rtol=1e-10, atol=1e-14, max_step=1e-3).y[0]
        errors.append(np.abs(result.position.values[:, -1, 1] - exact).max() / HIGH)
    print(geometry, "errors", errors, "order", np.log2(errors[0] / errors[1]))
    assert errors[1] < 5e-3
    assert errors[1] < 0.5 * errors[0] or errors[1] < 1e-4


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_a_dashpot_of_the_impedance_of_the_string_takes_up_all_of_a_wave(geometry: str) -> None:
    """What the moving end has given, the dashpot has dissipated; nothing comes back, and the audit closes."""
    support = {"kind": "elastic", "stiffness": [1e6, 1e-3], "damping": [0.0, IMPEDANCE]}
    result = shaken(200, support, until=0.3, geometry=geometry)
    energy = {form: result.energy.values[:, i] for i, form in enumerate(ENERGY_FORMS)}
    given = energy["support_work"][-1]
    assert given == pytest.approx(IMPEDANCE * HIGH**2 / RISE * 700.0 / 429.0, rel=5e-3)  # Z times the integral of f'^2
    assert energy["line_damping"][-1] == pytest.approx(given, rel=5e-3)
    assert energy["kinetic"][-1] < 1e-4 * given
    assert np.abs(energy["imbalance"]).max() < 2e-3 * given
    assert result.position.values[-1, :, 1] == pytest.approx(np.full(201, HIGH), abs=1e-2 * HIGH)


ROPE: dict[str, Any] = {
    "start": [0, 0], "end": [19.0, 1.0], "length": 19.3, "mass": 1.0, "axial_stiffness": 5e4, "elements": 120,
}  # fmt: skip
TABLE = {"time": [0.05, 0.25, 0.5], "value": [[0, 0], [0.05, -0.1], [0, 0]]}


def swings(t: float) -> tuple[float, float]:
    """Without corners: at one the two engines send other short waves."""
    s = np.sin(np.pi * min(t / 0.5, 1.0)) ** 4
    return 0.05 * s, -0.1 * s


KINDS: dict[str, dict[str, Any]] = {
    "elastic": {"kind": "elastic", "stiffness": 1e4},
    "elastic with dashpot and mass": {"kind": "elastic", "stiffness": [2e4, 5e3], "damping": [50, 200], "mass": 3.0},
    "shaken": {"kind": "elastic", "stiffness": 1e4, "damping": 100.0, "mass": 2.0, "displacement": swings},
    "counterweight": {"kind": "guided", "along": [1, 0], "force": 400.0, "mass": 10.0, "damping": 20.0},
    "vertical rail": {"kind": "guided", "along": [0, 1], "stiffness": 5e3, "mass": 2.0},
    "inclined rail": {"kind": "guided", "along": [1, 1], "stiffness": 1e4, "damping": 100.0, "force": 200.0},
    "moving": {"kind": "moving", "displacement": swings},
    "moved": {"kind": "moving", "displacement": [0.1, -0.3]},
}


@pytest.mark.parametrize("support", KINDS.values(), ids=KINDS)
def test_a_line_without_stiffness_moves_on_any_support_as_a_rope(support: dict[str, Any]) -> None:
    """Two engines, one motion: a slack, inclined rope whose start is moved along and up."""

    def moves(t: float) -> tuple[float, float]:
        s = min(t / 0.4, 1.0)
        return 0.1 * s**3 * (10 - 15 * s + 6 * s * s), 0.2 * s**3 * (10 - 15 * s + 6 * s * s)

    run = {"kind": "dynamic", "until": 0.6, "every": 0.02}
    line = {**ROPE, "start_support": {"kind": "moving", "displacement": moves}, "end_support": support, "drag": 0.3}
    rope, wire = (simulate(scenario({**line, **more}, run, 9.81)) for more in ({}, {"bending_stiffness": 1e-9}))
    assert rope.attrs["outcome"] == wire.attrs["outcome"] == "completed"
    assert list(rope.support.values) == list(wire.support.values)
    away = np.abs(wire.position - rope.position).max(dim="node")
    forces = np.abs(wire.reaction - rope.reaction).max().item() / np.abs(rope.reaction).max().item()
    works = {form: [float(r.energy.sel(form=form)[-1]) for r in (rope, wire)] for form in ENERGY_FORMS[:8]}
    print("away", away.max().item(), "reaction", forces, works)
    # Waves across are corrected on wires, and lag behind by (k h)^2 / 24 on the chain; moved by 0.2 m.
    assert away.max().item() < 1e-3
    assert forces < 0.05
    imbalance = np.abs(wire.energy.sel(form="imbalance")).max().item()
    assert imbalance < 2e-3 * max(abs(works["support_work"][1]), 1.0)
    for form in ("support_work", "line_damping"):
        assert works[form][1] == pytest.approx(works[form][0], rel=0.02, abs=0.02), form


BEARINGS = both(kind="elastic", stiffness=BEARING, damping=2e3, mass=20.0)


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_a_force_over_a_beam_on_bearings_closes_its_audit(geometry: str) -> None:
    load = {"kind": "force", "on": "line", "force": [0, -1e3], "travel": {"speed": 20.0, "from": 2.0}}
    run = {"kind": "dynamic", "until": 0.3, "every": 1e-2, "geometry": geometry}
    energy = simulate(scenario(beam(40, **BEARINGS), run, force=load)).energy
    turned = np.abs(energy.sel(form="load_work")).max().item()
    assert float(energy.sel(form="line_damping")[-1]) > 0.02 * turned
    assert np.abs(energy.sel(form="imbalance")).max().item() < 2e-3 * turned


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_what_accelerates_a_beam_is_its_load_and_what_the_bearings_show(geometry: str) -> None:
    """In every step, to rounding: with dampers, and without what accelerates the masses of the bearings."""
    load = {"kind": "force", "on": "line", "force": [0, -1e3], "travel": {"speed": 20.0, "from": 4.0}}
    step = 5e-5
    run = {"kind": "dynamic", "until": 0.01, "every": step, "step": step, "geometry": geometry}
    result = simulate(scenario(beam(40, **BEARINGS), run, force=load))
    mass = MASS * LENGTH / 40 * shares(40, fourth=geometry == "linearised")
    momentum = result.velocity.values[:, :, 1] @ mass  # half a step before each instant
    assert np.diff(momentum)[1:] / step == pytest.approx(
        (result.reaction.values[:, :, 1].sum(axis=1) - 1e3)[1:-1], abs=1e-3
    )


@pytest.mark.parametrize("damping", [1e3, 1e9])
def test_no_dashpot_shortens_the_step(damping: float) -> None:
    run = {"kind": "dynamic", "until": 0.1, "every": 0.01}
    found = [
        simulate(scenario({**STRING, "elements": 50, "end_support": {"kind": "elastic", "stiffness": 1e4,
                           "damping": c}}, run, 9.81, force={"kind": "force", "on": "line", "force": [0, -50.0],
                           "travel": {"speed": 40.0, "from": 5.0}}))
        for c in (0.0, damping)
    ]  # fmt: skip
    assert found[1].attrs["step"] == found[0].attrs["step"]
    assert found[1].attrs["outcome"] == "completed"
    if damping == 1e9:
        assert np.ptp(found[1].position.values[:, -1], axis=0) == pytest.approx(0.0, abs=1e-6)


def test_co_simulation_tells_the_forces_of_supports_that_yield() -> None:
    support = {"kind": "elastic", "stiffness": 1e4, "mass": 1.0}
    run = {"kind": "dynamic", "until": 0.1, "every": 0.01}
    moving = stepwise(scenario({**STRING, "elements": 50, "end_support": support}, run, 9.81), {}, step=1e-3)
    for _ in range(3):
        place, _ = moving.at("line", 10.0)
        moving.step(1e-3)
    found = moving.support_forces()
    assert list(found) == ["line.start", "line.end"]
    assert found["line.end"][1] == pytest.approx(-1e4 * float(place[1]) - 9.81, rel=1e-6)  # without its own weight


@pytest.mark.parametrize(("change", "key"), [
    ({"end_support": {"kind": "guided", "along": [1, 1], "stiffness": 1e4}}, "end_support.along"),
    ({"end_support": {"kind": "moving", "displacement": TABLE}}, "end_support.displacement"),
    ({"end": [10, 2], "end_support": {"kind": "elastic", "stiffness": 1e4}}, "end_support"),
])  # fmt: skip
def test_vertical_small_motion_refuses_supports_that_change_its_tensions(change: dict[str, Any], key: str) -> None:
    """Without a window, which asks for it, the system moves them."""
    run = {"kind": "dynamic", "until": 0.1, "geometry": "linearised"}
    assert engine_of(scenario({**STRING, **change}, run)) is SYSTEM
    with pytest.raises(ValidationError, match=r"in linearised motion tensions are constant") as message:
        scenario({**STRING, **change}, run | {"window": 1.0})
    assert f"lines.line.{key}" in str(message.value)


def test_an_inclined_rail_holds_across_itself_and_nothing_more() -> None:
    """A whole scene without weight may be turned: a rail across the line is inclined then, and its springs are too."""
    found = []
    for angle in (0.0, 0.6):
        c, s = np.cos(angle), np.sin(angle)
        rail = {"kind": "guided", "along": [-s, c], "stiffness": BEARING, "damping": 1e3, "mass": 30.0}
        line = beam(20, end=[LENGTH * c, LENGTH * s], end_support=rail)
        load = {"kind": "force", "on": "line", "force": [1e3 * s, -1e3 * c], "travel": {"speed": 0.0, "from": LENGTH}}
        if angle == 0.0:
            rest = simulate(scenario(line, {"kind": "equilibrium"}, force=load))
            assert float(rest.position[0, -1, 1]) == pytest.approx(-1e3 / BEARING, rel=1e-5)
        found.append(spectrum_of(scenario(line, {"kind": "equilibrium"}), how_many=8))
    for level, turned in [found]:
        assert level.modes is not None
        assert turned.modes is not None
        np.testing.assert_allclose(turned.modes.frequency, level.modes.frequency, rtol=1e-6)
        np.testing.assert_allclose(turned.modes.ratio, level.modes.ratio, atol=1e-9)
        assert turned.highest_frequency == pytest.approx(level.highest_frequency, rel=1e-6)


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_an_end_on_a_spring_as_stiff_as_rock_stays_where_a_fixed_one_does(geometry: str) -> None:
    """The step becomes as short as half a link on that spring asks for."""
    load = {"kind": "force", "on": "line", "force": [0, -50.0], "travel": {"speed": 40.0, "from": 5.0}}
    run = {"kind": "dynamic", "until": 0.05, "every": 0.01, "geometry": geometry}
    line = {**STRING, "elements": 50, "end_support": {"kind": "elastic", "stiffness": 1e8}}
    rock = simulate(scenario(line, run, 9.81, force=load))
    assert rock.attrs["outcome"] == "completed"
    line, run = {**line, "end_support": {"kind": "fixed"}}, {**run, "step": rock.attrs["step"]}
    fixed = simulate(scenario(line, run, 9.81, force=load))
    np.testing.assert_allclose(rock.position, fixed.position, atol=2e-5)  # 1 kN move the end by 1e-5 m
