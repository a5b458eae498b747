"""Natural frequencies of ropes with what stands on them, at rest and at instants, and with ends that yield."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from loaded_spectra import nearest, of_string, rigid, roots, sprung
from ropewalk.errors import RopewalkError
from ropewalk.model import Scenario
from ropewalk.simulate import spectrum_of
from ropewalk.solve.spectrum import Modes

LENGTH, TENSION, MASS = 20.0, 1e3, 0.5
STRING = {"start": [0, 0], "end": [LENGTH, 0], "tension": TENSION, "mass": MASS, "axial_stiffness": 1e9}
SLACK = {"start": [0, 0], "end": [19.5, 0], "length": 20.0, "mass": 1.0, "axial_stiffness": 1e5}
DYNAMIC = {"kind": "dynamic", "until": 0.2}


def found(elements: int, line: dict[str, Any], load: dict[str, Any] | None, **more: Any) -> Modes:
    at, gravity, how_many = more.pop("at", None), more.pop("gravity", 0.0), more.pop("how_many", 16)
    run, place = more.pop("run", {"kind": "equilibrium"}), more.pop("place", 0.5 * LENGTH)
    travel = {"speed": 0.0, "measured": "material", "from": place}
    loads = {"loads": {"load": {"on": "line", "travel": travel, **load}}} if load is not None else {}
    lines = {"line": {**line, "elements": elements}}
    scenario = Scenario.model_validate({"gravity": gravity, "lines": lines, **loads, "run": run})
    modes = spectrum_of(scenario, how_many=how_many, at=at).modes
    assert modes is not None
    return modes


@pytest.mark.parametrize("place", [10.0, 6.3])
@pytest.mark.parametrize(
    ("load", "acts"),
    [({"kind": "mass", "mass": 8.0}, rigid(8.0)),
     ({"kind": "mass", "mass": 0.05}, rigid(0.05)),  # less than a link: it rides with a node
     ({"kind": "oscillator", "mass": 8.0, "stiffness": 900.0}, sprung(8.0, 900.0)),
     ({"kind": "oscillator", "mass": 8.0, "stiffness": 900.0, "wheel_mass": 1.5}, sprung(8.0, 900.0, wheel=1.5))],
    ids=["mass", "light mass", "oscillator", "oscillator on a wheel"],
)  # fmt: skip
def test_a_string_that_carries_a_load_solves_its_frequency_equation_with_the_second_order(load, acts, place) -> None:
    exact = roots(of_string(LENGTH, place, TENSION, MASS), acts, 4, 60.0)
    errors = np.array(
        [np.abs(nearest(found(n, STRING, load, place=place), exact) / exact - 1.0) for n in (40, 80, 160)]
    )
    print("exact", exact, "errors", errors, "orders", np.log2(errors[:-1] / errors[1:]))
    assert errors[-1].max() < 1e-3  # (n pi h / L)^2 / 24 with n = 7: 7.9e-4
    if place == 10.0:  # where it stands between two nodes the error jumps
        assert np.abs(np.log2(errors[-2] / errors[-1]) - 2.0).max() < 0.1


def test_a_mass_in_the_middle_of_a_string_solves_the_tangent_equation_of_textbooks() -> None:
    """cot(k L / 2) = k m / (2 rho), up and down and sideways alike."""
    mass = 8.0
    k = brentq(
        lambda k: np.cos(0.5 * k * LENGTH) - 0.5 * k * mass / MASS * np.sin(0.5 * k * LENGTH), 1e-6, np.pi / LENGTH
    )
    w = k * np.sqrt(TENSION / MASS)
    frequency = found(200, STRING, {"kind": "mass", "mass": mass}).frequency
    assert frequency[:2] == pytest.approx([w, w], rel=2e-5)


def test_a_trolley_on_a_string_swings_like_a_double_pendulum_of_springs() -> None:
    """A payload below a mass on a light string: m1 x1'' = -k x1 + N (x2 - x1) / l, m2 x2'' = -N (x2 - x1) / l."""
    m1, m2, length, g = 20.0, 60.0, 2.0, 9.81
    light = {**STRING, "mass": 1e-3, "tension": 5e4, "axial_stiffness": 1e7}
    trolley = {"kind": "trolley", "mass": m1, "payload": {"mass": m2, "length": length, "stiffness": 1e9}}
    modes = found(40, light, trolley, gravity=g, how_many=6)
    N = m2 * g
    tension = 5e4
    k = 4.0 * tension / LENGTH
    K = np.array([[k + N / length, -N / length], [-N / length, N / length]])
    exact = np.sqrt(np.linalg.eigvals(np.linalg.solve(np.diag([m1, m2]), K)).real)
    sideways = [w for w, s in zip(modes.frequency, modes.shape, strict=True) if np.abs(s[:, 1]).max() > 1e-6]
    # Under the weight the string is pulled tighter by (sag / span)^2 EA and more: 0.3 %
    assert sideways[0] == pytest.approx(exact.min(), rel=2e-3)


def test_a_damper_under_a_load_damps_by_as_much_as_the_complex_equation_says() -> None:
    load = {"kind": "oscillator", "mass": 8.0, "stiffness": 900.0, "damping": 20.0}
    receptance, acts = of_string(LENGTH, 10.0, TENSION, MASS), sprung(8.0, 900.0, 20.0)
    modes = found(160, STRING, load)
    for start in roots(receptance, sprung(8.0, 900.0), 2, 30.0):
        w = complex(start, 0.01 * start)
        for _ in range(100):  # Newton's method
            d = 1e-6 * abs(w)
            f, slope = (1.0 / receptance(w) - acts(w)), 0.0
            slope = ((1.0 / receptance(w + d) - acts(w + d)) - (1.0 / receptance(w - d) - acts(w - d))) / (2.0 * d)
            w -= f / slope
        i = int(np.abs(modes.frequency - start).argmin())
        pair = modes.ratio[np.abs(modes.frequency - start) < 1e-6 * start]
        print(start, modes.ratio[i], w.imag / abs(w), pair)
        assert modes.ratio[i] == pytest.approx(w.imag / abs(w), rel=1e-3)
        assert w.imag / abs(w) > 0.004


@pytest.mark.parametrize("load", [{"kind": "mass", "mass": 80.0}, {"kind": "force", "force": [0, -800]},
                                  {"kind": "oscillator", "mass": 80.0, "stiffness": 2e4}])  # fmt: skip
def test_an_instant_of_a_rope_that_stands_still_has_the_spectrum_of_that_rest(load) -> None:
    own = {"gravity": 9.81, "place": 7.0}
    rest = found(40, SLACK, load, **own)
    still = found(40, SLACK, load, run={**DYNAMIC, "start": {"with_loads": True}}, at=0.2, **own)
    assert still.frequency == pytest.approx(rest.frequency, rel=1e-6)
    bare = found(40, SLACK, load, run=DYNAMIC, **own)
    assert np.abs(bare.frequency / rest.frequency - 1.0).max() > 0.1


def test_an_end_on_a_spring_solves_its_frequency_equation() -> None:
    """k L cot(k L) = -stiffness L / T across; the end slides on a rail, without mass."""
    for stiffness, guess in ((50.0, (0.5, 1.0)), (5e3, (0.9, 1.0))):
        support = {"kind": "elastic", "stiffness": [1e12, stiffness]}
        modes = found(200, {**STRING, "end_support": support}, None)
        K = stiffness / TENSION
        k = brentq(lambda k, K=K: k * np.cos(k * LENGTH) + K * np.sin(k * LENGTH),
                   guess[0] * np.pi / LENGTH, guess[1] * np.pi / LENGTH)  # fmt: skip
        w = k * np.sqrt(TENSION / MASS)
        assert np.abs(modes.frequency - w).min() < 2e-4 * w
        assert modes.frequency[
            np.abs(modes.frequency - np.pi / LENGTH * np.sqrt(TENSION / MASS)).argmin()
        ] == pytest.approx(np.pi / LENGTH * np.sqrt(TENSION / MASS), rel=1e-4)  # sideways it is held


def test_walkers_and_models_of_ones_own_have_no_matrices() -> None:
    walker = {"kind": "walker", "on": "line", "from": 1.0}
    scenario = {"lines": {"line": {**SLACK, "elements": 40}}, "loads": {"load": walker}, "run": DYNAMIC}
    with pytest.raises(RopewalkError, match=r"loads\.load\.kind: is not implemented for the spectrum with loads"):
        spectrum_of(Scenario.model_validate(scenario), at=0.1)
