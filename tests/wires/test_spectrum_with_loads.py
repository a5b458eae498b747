"""Natural frequencies of stiff lines with what stands on them against frequency equations; and at instants."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import fsolve

from loaded_spectra import nearest, of_beam, of_string, rigid, roots, sprung
from ropewalk.errors import RopewalkError
from ropewalk.model import Scenario
from ropewalk.simulate import spectrum_of
from ropewalk.solve.spectrum import Modes

LENGTH, MASS, EI = 10.0, 50.0, 2e6
BEAM = {"start": [0, 0], "end": [LENGTH, 0], "length": LENGTH, "mass": MASS, "axial_stiffness": 1e9}
BEAM |= {"bending_stiffness": EI}
TAUT = {"start": [0, 0], "end": [LENGTH, 0], "tension": 1e4, "mass": 2.0, "axial_stiffness": 1e9}
TAUT |= {"bending_stiffness": 1e-3}  # sqrt(EI / T) is 0.3 mm: a string, but for 6e-5 of its frequencies at its ends
MESHES = (20, 40, 80)
STANDS = {"speed": 0.0, "measured": "material", "from": 0.5 * LENGTH}
DYNAMIC = {"kind": "dynamic", "until": 0.02}


def found(elements: int, line: dict[str, Any], load: dict[str, Any] | None, **more: Any) -> Modes:
    at, gravity = more.pop("at", None), more.pop("gravity", 0.0)
    loads = {"loads": {"load": {"on": "line", "travel": STANDS, **load}}} if load is not None else {}
    lines = {"line": {**line, "elements": elements}}
    run = more.pop("run", {"kind": "equilibrium"})
    scenario = Scenario.model_validate({"gravity": gravity, "lines": lines, **loads, "run": run})
    modes = spectrum_of(scenario, how_many=more.pop("how_many", 16), at=at).modes
    assert modes is not None
    return modes


class Pressing:
    """A model that presses with a constant force."""

    def step(self, t, contacts):
        return [(0.0, -1.0)]


HEAVY = {"kind": "mass", "mass": 400.0}
SPRUNG = {"kind": "oscillator", "mass": 400.0, "stiffness": 4e5}


@pytest.mark.parametrize(
    ("load", "acts"),
    [
        (HEAVY, rigid(400.0)),
        (SPRUNG, sprung(400.0, 4e5)),
        ({**SPRUNG, "wheel_mass": 60.0}, sprung(400.0, 4e5, wheel=60.0)),
    ],
    ids=["mass", "oscillator", "oscillator on a wheel"],
)
def test_a_beam_that_carries_a_load_solves_its_frequency_equation_with_the_second_order(load, acts) -> None:
    exact = roots(of_beam(LENGTH, EI, MASS), acts, 3, 700.0)
    errors = np.array([np.abs(nearest(found(n, BEAM, load), exact) / exact - 1.0) for n in MESHES])
    order = np.log2(errors[:-1] / errors[1:])
    print("exact", exact, "errors", errors, "orders", order)
    assert errors[-1].max() < 4e-3  # (n pi h / L)^2 / 12 with n = 5 for the third mode of a heavily laden beam: 3.2e-3
    assert np.abs(order[-1] - 2.0).max() < 0.1
    bare = found(80, BEAM, None).frequency[0]
    assert exact[0] < 0.8 * bare  # what is looked at is no small thing


@pytest.mark.parametrize(
    ("load", "acts"),
    [({"kind": "mass", "mass": 5.0}, rigid(5.0)),
     ({"kind": "oscillator", "mass": 5.0, "stiffness": 3e3}, sprung(5.0, 3e3))],
    ids=["mass", "oscillator"],
)  # fmt: skip
@pytest.mark.parametrize("place", [5.0, 3.21])
def test_a_taut_line_that_carries_a_load_solves_that_of_a_string(load, acts, place) -> None:
    exact = roots(of_string(LENGTH, place, 1e4, 2.0), acts, 4, 150.0)
    travel = {**STANDS, "from": place}
    errors = np.array([np.abs(nearest(found(n, TAUT, {**load, "travel": travel}), exact) / exact - 1.0)
                       for n in (40, 80, 160)])  # fmt: skip
    print("exact", exact, "errors", errors, "orders", np.log2(errors[:-1] / errors[1:]))
    assert errors[-1].max() < 1.5e-3  # (n pi h / L)^2 / 24 with n = 5: 4e-4, and the bending at the load


def test_a_damper_between_beam_and_mass_damps_each_mode_as_the_complex_equation_says() -> None:
    load = {**SPRUNG, "damping": 3e3}
    receptance, acts = of_beam(LENGTH, EI, MASS), sprung(400.0, 4e5, 3e3)
    modes = found(160, BEAM, load)
    for start in roots(receptance, sprung(400.0, 4e5), 2, 400.0):

        def miss(parts):
            w = complex(*parts)
            value = 1.0 / receptance(w) - acts(w)
            return [value.real * 1e-5, value.imag * 1e-5]

        w = complex(*fsolve(miss, [start, 0.01 * start], xtol=1e-12))
        i = int(np.abs(modes.frequency - start).argmin())
        print("ratio", modes.ratio[i], w.imag / abs(w))
        assert modes.ratio[i] == pytest.approx(w.imag / abs(w), rel=1e-3)  # the mesh
        assert w.imag / abs(w) > 0.004


def test_without_its_loads_a_motion_has_the_spectrum_of_the_line_alone() -> None:
    bare = found(20, BEAM, None).frequency
    assert found(20, BEAM, HEAVY, run=DYNAMIC).frequency == pytest.approx(bare, rel=1e-12)
    with_loads = found(20, BEAM, HEAVY, run={**DYNAMIC, "start": {"with_loads": True}}).frequency
    assert with_loads[0] < 0.8 * bare[0]


def test_a_wheel_of_a_vehicle_given_by_matrices_may_have_no_mass_or_all_of_it() -> None:
    """A quarter car in two forms: its wheel as a coordinate of its own, or as the oscillator does it."""
    K, wheel = [[4e5, -4e5], [-4e5, 4e5]], {"axle": {"at": 0.0, "coordinate": "z"}}
    for mass in (0.0, 60.0):
        quarter = {"kind": "matrices", "coordinates": ["q", "z"], "mass": [[400.0, 0.0], [0.0, mass]]}
        quarter |= {"stiffness": K, "wheels": wheel}
        given, known = found(40, BEAM, quarter), found(40, BEAM, {**SPRUNG, "wheel_mass": mass})
        assert given.frequency == pytest.approx(known.frequency, rel=1e-9)


@pytest.mark.parametrize("at", [None, 0.02])
def test_small_motion_with_its_loads_has_the_spectrum_of_the_line_that_does_not_sag(at) -> None:
    """Tensions of rest stay: the mass hangs on the line as it does without gravity."""
    run = {**DYNAMIC, "geometry": "linearised", "start": {"with_loads": True}}
    small = found(20, TAUT, HEAVY, run=run, at=at, gravity=0.05)
    weightless = found(20, TAUT, HEAVY)
    assert small.frequency == pytest.approx(weightless.frequency, rel=1e-3)  # the line itself sags by 0.1 mm
    full = found(20, TAUT, HEAVY, gravity=0.05)  # the mass makes it sag by 5 mm, and 500 N tighter
    assert np.abs(full.frequency / small.frequency - 1.0).max() > 0.01


SAGGING = {**TAUT, "length": 10.02, "axial_stiffness": 1e5, "bending_stiffness": 2.0}
del SAGGING["tension"]


@pytest.mark.parametrize("load", [{"kind": "force", "force": [0, -300]}, {"kind": "mass", "mass": 30.0}], ids=str)
def test_an_instant_of_a_line_that_stands_still_has_the_spectrum_of_that_rest(load) -> None:
    """A motion that begins at rest with its loads, which do not travel, stays there."""
    own = {"gravity": 9.81, "how_many": 12}
    rest = found(40, SAGGING, load, **own)
    still = found(40, SAGGING, load, run={**DYNAMIC, "start": {"with_loads": True}}, at=0.02, **own)
    bare = found(40, SAGGING, None, **own)
    assert still.frequency == pytest.approx(rest.frequency, rel=1e-5)  # the stencil of motion finds rest to 1e-6
    assert np.abs(bare.frequency / rest.frequency - 1.0).max() > 0.1
    assert still.position == pytest.approx(rest.position, abs=1e-5)


def test_a_line_that_a_force_has_slowly_displaced_has_the_spectrum_of_its_rest_under_it() -> None:
    slowly = {"time": [0.0, 4.0, 9.0], "value": [[0, 0], [0, -300], [0, -300]]}
    line, own = {**SAGGING, "drag": 4.0}, {"gravity": 9.81, "how_many": 10}
    later = found(80, line, {"kind": "force", "force": slowly}, run={"kind": "dynamic", "until": 9.0}, at=9.0, **own)
    there = found(80, line, {"kind": "force", "force": [0, -300]}, **own)
    assert later.frequency == pytest.approx(there.frequency, rel=1e-3)  # correction of the stencil, by the mesh
    before = found(80, line, {"kind": "force", "force": slowly}, run={"kind": "dynamic", "until": 9.0}, at=0.0, **own)
    assert before.frequency == pytest.approx(found(80, line, None, **own).frequency, rel=1e-6)


def test_models_of_ones_own_have_no_matrices() -> None:
    model = {"kind": "stepper", "model": Pressing(), "every": 0.01, "on": "line"}
    scenario = {"lines": {"line": {**BEAM, "elements": 20}}, "loads": {"load": model}, "run": DYNAMIC}
    with pytest.raises(RopewalkError, match=r"loads\.load\.kind: is not implemented for the spectrum with loads"):
        spectrum_of(Scenario.model_validate(scenario), at=0.01)
