"""Gradients against closed forms and complex steps through them."""

from __future__ import annotations

import numpy as np
import pytest

import design_cases as cases
import ropewalk
from ropewalk.errors import RopewalkError, ScenarioError
from ropewalk.results import named_numbers
from ropewalk.scenario import loads
from ropewalk.solve.sensitivity import NotBesideError, Rests

FORCE = "loads.man.force.1"


def sag(tension, force, axial=cases.AXIAL, length=10.0):
    """Of a massless string under a force in its middle, of complex arguments, too: Newton's method on

    2 T sin a = F, T = EA (L / cos a / L0 - 1), L0 = L / (1 + T0 / EA)."""
    tangent = force / (2.0 * tension) + 0j
    for _ in range(60):
        stretch = (1.0 + tension / axial) * np.sqrt(1.0 + tangent**2)
        root = np.sqrt(1.0 + tangent**2)
        residual = 2.0 * axial * (stretch - 1.0) * tangent / root - force
        slope = 2.0 * axial * ((1.0 + tension / axial) - 1.0 / root**3)
        tangent = tangent - residual / slope
    return 0.5 * length * tangent


def test_of_rest_as_complex_steps_through_the_closed_form():
    """Two straight halves. Direct: what is left is rounding, 1e-16 of the sag over a step of 1e-4."""
    found = ropewalk.gradient(cases.scenario(), "largest_sag", [cases.TENSION, FORCE], workers=0)
    beside = ropewalk.gradient(cases.scenario(), "largest_sag", [cases.TENSION, FORCE], workers=0, step=1e-3)
    step = 1e-30j
    exact = [
        float(sag(1000.0 + step, cases.FORCE).imag / 1e-30),
        -float(sag(1000.0, cases.FORCE + step).imag / 1e-30),  # the key is the force upwards
    ]
    for one, route, close, told in ((found, "direct", 1e-9, 1e-8), (beside, "differences", 1e-6, 1e-4)):
        assert one.attrs["route"] == route
        np.testing.assert_allclose(one["gradient"].values[0], exact, rtol=close)
        assert (one["error"].values > np.abs(one["gradient"].values - exact)).all()
        assert (one["error"].values < told * np.abs(exact)).all()
    assert found["key_units"].values.tolist() == ["N", "N"]
    assert found["quantity_units"].values.tolist() == ["m"]


def hanging(span, length, mass, axial, links=50, g=9.81):
    """Largest tension and sag of a chain of elastic links, of complex arguments, too: Newton's method on the force
    (H, V) of its first link, with which links reach over the span."""
    each = length / links
    down = np.arange(links) * mass * each * g
    force = np.array([mass * g * span, 0.5 * (1 / links - 1) * mass * g * length], dtype=complex)
    for _ in range(40):
        H, V = force[0], force[1] + down
        T = np.sqrt(H * H + V * V)
        across, along = each * (1.0 / T + 1.0 / axial), each / T**3
        gap = np.array([span - (across * H).sum(), -(across * V).sum()])
        K = [[(across - along * H * H).sum(), -(along * H * V).sum()],
             [-(along * H * V).sum(), (across - along * V * V).sum()]]  # fmt: skip
        step = np.linalg.solve(np.array(K), gap)
        force = force + step * min(1.0, 0.5 * np.abs(force).max() / max(np.abs(step).max(), 1e-300))
    z = np.cumsum(across * V)
    return np.array([T[np.argmax(T.real)], -z[np.argmin(z.real)]])


def test_of_a_hanging_chain_as_complex_steps_through_its_balance():
    """To 1e-8: of the axial stiffness the sag knows so little (1e-7 m/N) that rounding takes the rest."""
    rope = {"start": [0, 0], "end": [10, 0], "length": 10.5, "mass": 1, "axial_stiffness": 1e5, "elements": 50}
    scenario = ropewalk.Scenario.model_validate({"title": "", "lines": {"rope": rope}, "run": {"kind": "equilibrium"}})
    keys, own = ["end.0", "length", "mass", "axial_stiffness"], [10.0, 10.5, 1.0, 1e5]
    found = ropewalk.gradient(scenario, "largest_tension, largest_sag", [f"lines.rope.{key}" for key in keys])
    exact = np.array([hanging(*(x + 1e-30j * (i == k) for i, x in enumerate(own))).imag / 1e-30 for k in range(4)]).T
    assert found.attrs["route"] == "direct"
    np.testing.assert_allclose(found["gradient"].values, exact, rtol=1e-8)
    assert (np.abs(found["gradient"].values - exact) < found["error"].values).all()


def test_of_the_catenary():
    """L = 2 a sinh(D / 2 a), H = w a: dH/dw = H / w of any chain, dH/dL = w / (2 sinh u - 2 u cosh u), u = D / 2 a,
    which of 200 links is right to the second order of their length, 1.4e-5 (four times that for 100)."""
    from scipy.optimize import brentq

    u = brentq(lambda u: 10.0 * np.sinh(u) / u - 10.5, 0.1, 2.0, xtol=1e-15)
    weight = 9.81
    exact = weight / (2.0 * np.sinh(u) - 2.0 * u * np.cosh(u))
    apart = []
    for links in (100, 200):
        rope = {"start": [0, 0], "end": [10, 0], "length": 10.5, "mass": 1, "elements": links}
        tree = {
            "title": "",
            "lines": {"rope": rope | {"law": {"kind": "inextensible"}}},
            "run": {"kind": "equilibrium"},
        }
        scenario, pull = ropewalk.Scenario.model_validate(tree), "supports.rope.end.components.x.max"
        found = ropewalk.gradient(scenario, pull, ["lines.rope.length", "lines.rope.mass"])
        with ropewalk.simulate(scenario) as result:
            whole = named_numbers(result)[pull][0]
        assert found.attrs["route"] == "direct"
        assert found["gradient"].values[0, 1] == pytest.approx(whole, rel=1e-9)
        apart.append(found["gradient"].values[0, 0] / exact - 1.0)
    assert abs(apart[1]) < 2e-5
    assert apart[0] / apart[1] == pytest.approx(4.0, rel=0.05)


SAGS = "lines: {{a: {{start: [0, 0], end: [100, 3], {line}, mass: 1, axial_stiffness: 2 MN, elements: 10}}}}\n"
MAN = "loads: {man: {kind: force, on: a, force: [0, -800], travel: {speed: 1, from: 33 m, measured: material}}}\n"
KNOT = """\
joints: {knot: {}}
lines:
  a: {start: [0, 0], end: [50, 0], end_support: {kind: joined, to: knot}, length: 51, mass: 1, axial_stiffness: 2e6}
  b: {start: [50, 0], start_support: {kind: joined, to: knot}, end: [100, 0], length: 50.2, mass: 2,
    axial_stiffness: 2e6}
"""
BEAM = "lines: {a: {start: [0, 0], end: [50, 0], length: 50, mass: 90, axial_stiffness: 1e9, bending_stiffness: 1e8}}\n"
REST, SLOW = "run: {kind: equilibrium}", "run: {kind: quasistatic, positions: 4}"


@pytest.mark.parametrize(
    ("text", "key", "close"),
    [  # differences are right to 1e-8, less where the shape changes much or, as of beams, rounding is felt
        pytest.param(SAGS.format(line="tension: 20 kN") + MAN + REST, "lines.a.tension", 1e-8, id="tension"),
        pytest.param(SAGS.format(line="tension: 20 kN") + MAN + SLOW, "lines.a.mass", 1e-7, id="quasistatic"),
        pytest.param(
            SAGS.format(line="length: 100.5, end_support: {kind: elastic, stiffness: 100 kN/m}") + MAN + REST,
            "lines.a.end_support.stiffness", 1e-8, id="elastic support",
        ),
        pytest.param(KNOT + MAN + REST, "lines.b.length", 1e-6, id="network"),
        pytest.param(BEAM + MAN + REST, "lines.a.mass", 1e-6, id="beam"),
    ],
)  # fmt: skip
def test_direct_as_runs_beside(text, key, close):
    direct, beside = (ropewalk.gradient(loads(text), "largest_sag", key, workers=0, step=step) for step in (None, 1e-3))
    assert direct.attrs["route"] == "direct"
    assert float(direct["gradient"][0, 0]) == pytest.approx(float(beside["gradient"][0, 0]), rel=close)
    apart = abs(float(direct["gradient"][0, 0] - beside["gradient"][0, 0]))
    assert apart < 2.0 * float(direct["error"][0, 0] + beside["error"][0, 0])  # which are estimates


def test_what_does_not_follow_is_run_beside_and_says_why():
    sagging = SAGS.format(line="length: 100.5")
    slips = sagging + MAN.replace("force: [0", "contact: frictionless, force: [0") + REST
    goes = sagging + MAN.replace("material", "slip") + SLOW
    for text, why in ((slips, "loads that slip"), (goes, "positions that are determined during the run")):
        found = ropewalk.gradient(loads(text), "largest_tension", "lines.a.mass", workers=0)
        assert (found.attrs["route"], found.attrs["why"]) == ("differences", why)


def test_another_stiffness_than_the_own_is_found_out():
    rests = Rests()
    for again, load in ((False, 1.0), (True, 1.001)):
        with rests.running(again=again):
            arguments = (lambda: np.array([0.5]), lambda x, load=load: load - 2.0 * x, lambda _: lambda out: out / 2.5)
            if again:
                with pytest.raises(NotBesideError, match="the stiffness"):
                    rests.settle(*arguments)
            else:
                rests.settle(*arguments)


def test_of_the_linear_theory_in_proportion():
    """Deflections of the linear theory are F times what depends on the line: the derivative is their quotient."""
    run = {"kind": "linear", "until": 0.1, "every": 0.02}
    more = {"man": cases.TREE["loads"]["man"] | {"travel": {"speed": 10, "from": 0}}}
    scenario = cases.scenario(run=run, loads=more)
    found = ropewalk.gradient(scenario, "largest_sag", FORCE, workers=0)
    with ropewalk.simulate(scenario) as result:
        whole = ropewalk.summary(result)["largest_sag"]["value"]
    assert float(found["gradient"][0, 0]) == pytest.approx(-whole / cases.FORCE, rel=1e-9)


@pytest.mark.parametrize(
    ("of", "to", "more", "wrong"),
    [
        ("largest_sga", cases.TENSION, {}, "did you mean largest_sag"),
        ("largest_sag", "lines.string.tensoin", {}, "did you mean lines.string.tension"),
        ("largest_sag", "run.kind", {}, "only numbers other than 0"),
        ("largest_sag", "loads.man.force.0", {}, "only numbers other than 0"),
        ("largest_sag", cases.TENSION, {"step": 0.9}, "part of the value"),
    ],
)
def test_mistakes_are_told(of, to, more, wrong):
    with pytest.raises(ScenarioError, match=wrong):
        ropewalk.gradient(cases.scenario(), of, to, workers=0, **more)


def test_a_run_without_a_value_has_no_gradient():
    more = {"man": cases.TREE["loads"]["man"] | {"travel": {"speed": 1, "from": 9.9999}}}
    with pytest.raises(RopewalkError, match=r"there is no gradient: .*would begin"):
        ropewalk.gradient(cases.scenario(loads=more), "largest_sag", "loads.man.travel.from", workers=0)
