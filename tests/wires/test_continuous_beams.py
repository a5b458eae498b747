"""Beams over several spans, on rigid and elastic bearings, and their influence lines, against the force method.

Sources: Clapeyron's equation of three moments; Müller-Breslau's principle; and the dynamic equation of three moments of
spans that vibrate (Timoshenko and Young, Vibration problems in engineering).
"""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from scipy.optimize import brentq

from continuous_beams import EI, MASS, SPANS, Array, influence, over_unlike_spans, sunk, three_moments
from ropewalk.model import Scenario
from ropewalk.simulate import simulate
from ropewalk.wires.bearing import Bearing
from ropewalk.wires.mesh import mesh_of
from ropewalk.wires.plan import Contact, Hold, Spot, TravellingLoad, Wire, WirePlan
from ropewalk.wires.prescribed_motion import PrescribedMotion
from ropewalk.wires.spectrum import spectrum
from ropewalk.wires.task import WireTask

GRAVITY = 1e-3  # m/s^2: so little that beams between fixed ends do not stretch
NONE = np.zeros((0, 0))


def plan(spans: tuple[float, ...], stiffness: float = np.inf, gravity: float = 0.0, across: bool = False) -> WirePlan:
    """A beam whose inner supports hold it upwards, and sideways too if it is to stay in its plane."""
    whole = sum(spans)
    wire = Wire("beam", (0.0, 0.0, 0.0), (whole, 0.0, 0.0), 0.0, MASS, EI, 1e10, unstrained=whole)
    at = np.cumsum(spans)[:-1].tolist()
    sideways = np.inf if across else 0.0
    piers = [Hold(f"pier {s:g}", Spot(0, s), (0.0, sideways, stiffness), place=(s, 0.0, 0.0)) for s in at]
    return WirePlan((wire,), holds=tuple(piers), gravity=gravity)


def reactions(given: WirePlan, per_metre: int, force: float = 0.0, place: float = 0.0) -> Array:
    """Forces of all supports upwards, N, with a force downwards at a place."""
    mesh = mesh_of(given, [round(per_metre * given.wires[0].length)])
    moving_load = TravellingLoad("force", NONE, NONE, NONE, (Contact(0, stiffness=0.0),))
    prescribed_motion = PrescribedMotion(
        moving_load, partial(np.full_like, fill_value=place), given=lambda t: np.full((t.size, 1), -force)
    )
    bearing = Bearing(mesh, [prescribed_motion], np.full(mesh.nodes, 1.0 / per_metre), space=False)
    found = bearing.stand(0.0, mesh.straight()).position
    ends = -bearing.potential.pull(found)[2, [0, -1]]
    return np.array([ends[0], *bearing.potential.hold_forces(found)[:, 2], ends[1]])


def orders(errors: list[float]) -> Array:
    found = np.log2(np.divide(errors[:-1], errors[1:]))
    print("errors", errors, "orders", found)
    return np.asarray(found)


@pytest.mark.parametrize("spans", SPANS, ids=str)
def test_unlike_spans_share_a_weight_as_the_three_moment_equation_says_with_the_second_order(
    spans: tuple[float, ...],
) -> None:
    exact = three_moments(spans, GRAVITY * MASS)
    assert exact.sum() == pytest.approx(GRAVITY * MASS * sum(spans))
    given = plan(spans, gravity=GRAVITY)
    errors = [float(np.abs(reactions(given, n) / exact - 1.0).max()) for n in (1, 2, 4, 8)]
    assert errors[-1] < 1e-3
    assert orders(errors)[1:] == pytest.approx([2.0, 2.0], abs=0.06)


@pytest.mark.parametrize("stiffness", [np.inf, 2e5], ids=["rigid", "elastic"])
@pytest.mark.parametrize("spans", SPANS, ids=str)
def test_influence_lines_of_inner_supports_are_the_shapes_of_mueller_breslau(
    spans: tuple[float, ...], stiffness: float
) -> None:
    """A unit load wherever it stands; 2e5 N/m take about half of what rigid supports do."""
    x = np.linspace(0.0, sum(spans), 15)  # some within links
    exact, errors = influence(spans, x, stiffness), []
    for per_metre in (2, 4, 8):
        found = np.array([reactions(plan(spans, stiffness), per_metre, 1.0, float(place)) for place in x])
        np.testing.assert_allclose(found.sum(axis=1), 1.0, atol=1e-7)
        errors.append(float(np.abs(found[:, 1:-1] - exact).max()))
    assert errors[-1] < 1e-3
    assert orders(errors) == pytest.approx([2.0, 2.0], abs=0.13)


def test_two_equal_spans_have_the_influence_line_of_the_handbook() -> None:
    """x (3 l^2 - x^2) / (2 l^3) up to the middle support."""
    x = np.linspace(0.0, 10.0, 11)
    assert influence((10.0, 10.0), x)[:, 0] == pytest.approx(x * (300.0 - x**2) / 2e3)


@pytest.mark.parametrize("spans", SPANS, ids=str)
def test_unlike_spans_swing_as_the_three_moment_equation_of_vibrating_spans_says(spans: tuple[float, ...]) -> None:
    exact, errors = over_unlike_spans(spans, 4), []
    for per_metre in (2, 4, 8):
        task = WireTask(plan(spans, across=True), (), (), element=[round(per_metre * sum(spans))])
        modes = spectrum(task, 10).modes
        assert modes is not None
        found = modes.frequency[:8:2]  # each comes twice, up and sideways
        errors.append(float(np.abs(found / exact - 1.0).max()))
    assert errors[-1] < 1e-3
    assert orders(errors) == pytest.approx([2.0, 2.0], abs=0.15)


def test_an_elastic_bearing_below_the_middle_bears_what_the_force_method_says_and_lifts_even_modes_only() -> None:
    """R = (5 w L^4 / 384) / (L^3 / 48 + EI / k); 1 + k y(L/2) = 0 with the receptance of the beam in its middle."""
    whole, k = 20.0, 2e5
    given = plan((10.0, 10.0), k, gravity=GRAVITY)
    exact = 5.0 / 384.0 * GRAVITY * MASS * whole**4 / (whole**3 / 48.0 + EI / k)
    at_rest = [abs(float(reactions(given, n)[1]) / exact - 1.0) for n in (1, 2, 4)]
    assert orders(at_rest) == pytest.approx([2.0, 2.0], abs=0.1)

    def equation(b: float) -> float:
        p = 0.5 * b * whole  # y(L/2) = (tan p - tanh p) / (4 EI b^3)
        return float(np.cos(p) * (1.0 - 0.25 * k / (EI * b**3) * (np.tanh(p) - np.tan(p))))

    grid = np.linspace(0.05, 0.9, 2000)
    signs = np.sign([equation(b) for b in grid])
    even = [brentq(equation, grid[i], grid[i + 1]) for i in np.flatnonzero(signs[:-1] != signs[1:])]
    known = np.sort([*even, *(np.array([2.0, 4.0]) * np.pi / whole)])[:4] ** 2 * np.sqrt(EI / MASS)
    assert known[0] > 1.5 * (np.pi / whole) ** 2 * np.sqrt(EI / MASS)
    errors = []
    for links in (40, 80, 160):
        modes = spectrum(WireTask(plan((10.0, 10.0), k), (), (), element=[links]), 12).modes
        assert modes is not None
        errors.append(float(max(np.abs(modes.frequency / w - 1.0).min() for w in known)))
    assert errors[-1] < 2e-3
    assert orders(errors) == pytest.approx([2.0, 2.0], abs=0.1)


BRIDGE, BEARINGS = 20.0, (4e5, 6e5)  # m, N/m


def test_influence_lines_of_a_bridge_on_elastic_bearings_are_levers_and_deflections() -> None:
    """As a user gets them from slow motion: both support forces exactly, the deflection of a point by Maxwell.

    Deflection at x under a unit load at a: that of the beam, and that of the line between its sinking ends.
    """
    errors = []
    for elements in (40, 80, 160):
        support = [{"kind": "elastic", "stiffness": k} for k in BEARINGS]
        beam = {"start": [0, 0], "end": [BRIDGE, 0], "length": BRIDGE, "mass": MASS, "axial_stiffness": 1e9}
        beam |= {"bending_stiffness": EI, "elements": elements, "start_support": support[0], "end_support": support[1]}
        force = {"kind": "force", "on": "beam", "force": [0, -1.0], "travel": {"speed": 1.0}}
        run = {"kind": "quasistatic", "positions": 41}
        tree = {"gravity": 0.0, "lines": {"beam": beam}, "loads": {"force": force}, "run": run}
        found = simulate(Scenario.model_validate(tree))
        assert found.attrs["outcome"] == "completed"
        a = found.load_path.values
        np.testing.assert_allclose(found.reaction[:, :, 1], np.stack([1.0 - a / BRIDGE, a / BRIDGE], 1), atol=1e-8)
        x = 0.25 * BRIDGE
        exact = sunk(x, a, BRIDGE) + (1 - a / BRIDGE) * 0.75 / BEARINGS[0] + a / BRIDGE * 0.25 / BEARINGS[1]
        errors.append(float(np.abs(-found.position.values[:, elements // 4, 1] / exact - 1.0).max()))
    assert errors[-1] < 2e-3
    assert orders(errors) == pytest.approx([2.0, 2.0], abs=0.15)
