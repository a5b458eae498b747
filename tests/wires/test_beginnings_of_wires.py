"""Motions of stiff and overhead lines that begin in a mode, at a stored instant, or at rest with their loads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import curve_fit

from overhead_cases import EN_2002
from ropewalk.errors import RopewalkError, ScenarioError
from ropewalk.model import Scenario
from ropewalk.simulate import simulate, spectrum_of
from ropewalk.theory import beam

LENGTH, MASS, EI, AMPLITUDE = 10.0, 50.0, 2e6, 1e-3
BEAM = {"start": [0, 0], "end": [LENGTH, 0], "length": LENGTH, "mass": MASS, "axial_stiffness": 1e9}
BEAM |= {"bending_stiffness": EI, "elements": 40}
CLAMPED = {"kind": "fixed", "clamped": True}
OVERHEAD: dict[str, Any] = {
    **EN_2002, "spans": {"count": 3, "length": "60 m"}, "analysed_spans": [2, 2], "element": 1.0,
}  # fmt: skip


def run_of(tree: dict[str, Any], file: Path | None = None, **run: Any) -> Any:
    return simulate(Scenario.model_validate({"gravity": 0.0, **tree, "run": {"kind": "dynamic", **run}}), file=file)


def fitted(time: np.ndarray, z: np.ndarray, near: float) -> tuple[float, float, float]:
    """Frequency, amplitude and largest miss of the harmonic that fits best."""
    (a, b, w), _ = curve_fit(lambda t, a, b, w: a * np.cos(w * t) + b * np.sin(w * t), time, z, p0=(z[0], 0.0, near))
    miss = np.abs(a * np.cos(w * time) + b * np.sin(w * time) - z).max()
    return float(w), float(np.hypot(a, b)), float(miss)


@pytest.mark.parametrize("geometry", ["nonlinear", "linearised"])
@pytest.mark.parametrize("number", [1, 3])
@pytest.mark.parametrize("ends", ["hinged", "clamped"])
def test_a_beam_released_in_a_mode_swings_as_euler_and_bernoulli_say_and_its_amplitude_stays(
    geometry, number, ends
) -> None:
    supports = {"start_support": CLAMPED, "end_support": CLAMPED} if ends == "clamped" else {}
    known = {"ends": "clamped"} if ends == "clamped" else {}
    exact = beam.natural_frequencies(number, length=LENGTH, bending_stiffness=EI, mass=MASS, **known)[-1]
    period = 2.0 * np.pi / exact
    start = {"kind": "mode", "number": number, "amplitude": AMPLITUDE}
    result = run_of({"lines": {"beam": {**BEAM, **supports}}}, until=6.0 * period, every=period / 20.0, start=start,
                    geometry=geometry)  # fmt: skip
    z = result.position.sel(axis="z").values
    top = int(np.abs(z[0]).argmax())
    assert np.abs(z[0]).max() == pytest.approx(AMPLITUDE, rel=1e-9)
    w, amplitude, miss = fitted(result.time.values, z[:, top], exact)
    print(w / exact - 1.0, amplitude / AMPLITUDE - 1.0, miss / AMPLITUDE)
    assert w == pytest.approx(exact, rel=1e-3 * (number + 1.0) ** 2)  # (n pi h / L)^2 / 12, clamped twice that
    assert amplitude == pytest.approx(AMPLITUDE, rel=2e-3)  # the step: a half of it at the beginning
    assert miss < 5e-3 * AMPLITUDE


def released(element: float, geometry: str) -> float:
    """By which part the frequency of an overhead line released in its first mode upwards misses its spectrum."""
    tree = {"gravity": 9.81, "overhead_lines": {"line": {**OVERHEAD, "element": element}}}
    modes = spectrum_of(Scenario.model_validate({**tree, "run": {"kind": "equilibrium"}})).modes
    assert modes is not None
    up = next(w for w, s in zip(modes.frequency, modes.shape, strict=True) if (s[:, 2] ** 2).sum() > 0.5 * (s**2).sum())
    start = {"kind": "mode", "amplitude": AMPLITUDE, "line": "line"}
    result = run_of(tree, until=4.0, every=0.02, start=start, geometry=geometry)
    z = result.position.sel(axis="z").values
    rest = run_of(tree, until=0.02, every=0.02, geometry=geometry).position.sel(axis="z").values[0]
    top = int(np.abs(z[0] - rest).argmax())
    w, _, miss = fitted(result.time.values, z[:, top] - rest[top], up)
    print(w / up - 1.0, miss / AMPLITUDE)
    assert miss < 0.02 * AMPLITUDE
    return w / up - 1.0


def test_an_overhead_line_released_in_a_mode_swings_as_its_spectrum_says() -> None:
    """The stencil of motion is corrected for smooth waves; modes have kinks at droppers: that costs the first order."""
    coarse, fine = released(1.0, "nonlinear"), released(0.5, "nonlinear")
    assert abs(coarse) < 0.01
    assert 1.7 < coarse / fine < 2.3
    assert abs(2.0 * fine - coarse) < 5e-4
    # Small motion knows nothing of how the wires stretch, and of what moves along x.
    assert abs(released(1.0, "linearised")) < 0.03


@pytest.mark.parametrize("geometry", ["nonlinear", "linearised"])
def test_a_motion_that_goes_on_from_a_stored_instant_is_the_one_that_was_not_interrupted(geometry, tmp_path) -> None:
    tree = {"lines": {"beam": {**BEAM, "tension": 1e5, "length": None}}}
    first = {"kind": "mode", "number": 2, "amplitude": AMPLITUDE}
    del tree["lines"]["beam"]["length"]
    whole = run_of(tree, tmp_path / "whole.nc", until=0.2, every=0.01, start=first, geometry=geometry)
    again = {"kind": "result", "file": str(tmp_path / "whole.nc"), "time": 0.1}
    later = run_of(tree, until=0.1, every=0.01, start=again, geometry=geometry)
    for key in ("position", "velocity"):
        size = float(np.abs(whole[key].values[10:] - whole[key].values[:1]).max())
        miss = float(np.abs(later[key].values - whole[key].values[10:]).max())
        print(key, size, miss)
        assert size > 1e-4
        assert miss < 1e-12 * (1.0 if key == "position" else 1e4)  # rates: differences of places over a step of 1e-4 s
    elsewhere = {"lines": {"beam": {**tree["lines"]["beam"], "end": [LENGTH, 1.0]}}}
    with pytest.raises(RopewalkError, match="an end stands 1 m elsewhere"):
        run_of(elsewhere, until=0.1, start=again, geometry=geometry)


LOADS = {
    "force": {"kind": "force", "force": [0, -5e3]},
    "mass": {"kind": "mass", "mass": 400.0},
    "oscillator": {"kind": "oscillator", "mass": 400.0, "stiffness": 4e5, "wheel_mass": 20.0},
    "soft": {"kind": "oscillator", "mass": 400.0, "stiffness": 4e5},
}


@pytest.mark.parametrize("name", LOADS)
def test_small_motion_that_begins_at_rest_with_its_loads_stays_there(name) -> None:
    load = {**LOADS[name], "on": "beam", "travel": {"speed": 0.0, "measured": "material", "from": 3.3}}
    tree = {"gravity": 9.81, "lines": {"beam": {**BEAM, "foundation": 1e4, "tension": 1e5}}, "loads": {"load": load}}
    del tree["lines"]["beam"]["length"]
    own = {"until": 0.3, "every": 0.01, "geometry": "linearised"}
    result = run_of(tree, start={"with_loads": True}, **own)
    moved = run_of(tree, **own).position
    z = result.position
    assert np.abs(z - z[0]).max() < 1e-10  # rounding of what the stencil adds up, over 1e4 steps
    assert np.abs(moved - moved[0]).max() > 1e-3  # and else it would fall into the line
    force = result.contact_force.sel(axis="z").values[:, 0]
    weight = {"force": 5e3, "mass": 400.0 * 9.81, "oscillator": 420.0 * 9.81, "soft": 400.0 * 9.81}[name]
    assert force == pytest.approx(-weight, rel=1e-6)


def test_droppers_that_a_force_slackens_are_slack_from_the_beginning() -> None:
    lift = {"kind": "force", "on": "line", "force": [0, 600.0], "travel": {"speed": 0.0, "from": 90.0}}
    tree = {"gravity": 9.81, "overhead_lines": {"line": OVERHEAD}, "loads": {"lift": lift}}
    result = run_of(tree, until=0.5, every=0.05, start={"with_loads": True}, geometry="linearised")
    slack = result.tie_force.values <= 1e-9
    assert 0 < slack[0].sum() < slack.shape[1]
    assert np.array_equal(slack, np.broadcast_to(slack[0], slack.shape))
    assert float(np.abs(result.position - result.position[0]).max()) < 1e-9


def test_modes_that_stiff_lines_do_not_have_are_refused() -> None:
    tree = {"lines": {"beam": BEAM}}
    with pytest.raises(ValueError, match=r"a window with start\.kind: .* is not implemented"):
        run_of(tree, until=0.1, start={"kind": "mode", "amplitude": 1e-3}, geometry="linearised", window=5.0)
    with pytest.raises((ValueError, ScenarioError), match="no such line"):
        run_of(tree, until=0.1, start={"kind": "mode", "amplitude": 1e-3, "line": "bean"})
