"""Motions of networks and nets that begin in a mode or at a stored instant."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import curve_fit

from net_cases import net
from ropewalk.errors import RopewalkError
from ropewalk.model import Scenario
from ropewalk.simulate import simulate, spectrum_of
from web_cases import HUNG, SPAN, cross_tree

AMPLITUDE = 1e-4
NET = net(cells=[8, 6])


def first_upwards(tree: dict[str, Any], number: int = 1) -> float:
    modes = spectrum_of(Scenario.model_validate({**tree, "run": {"kind": "equilibrium"}}), how_many=20).modes
    assert modes is not None
    up = [w for w, s in zip(modes.frequency, modes.shape, strict=True) if (s[:, 2] ** 2).sum() > 0.5 * (s**2).sum()]
    return float(up[number - 1])


def swinging(tree: dict[str, Any], w: float, **start: Any) -> tuple[float, float, float, Any]:
    """Frequency and amplitude over those known, largest miss of the harmonic that fits best; and the result."""
    run = {"kind": "dynamic", "until": 12.0 * np.pi / w, "every": 0.1 * np.pi / w}
    result = simulate(Scenario.model_validate(
        {**tree, "run": {**run, "start": {"kind": "mode", "amplitude": AMPLITUDE, **start}}}
    ))  # fmt: skip
    rest = simulate(Scenario.model_validate({**tree, "run": {"kind": "dynamic", "until": 1e-3}})).position[0]
    z = (result.position - rest).sel(axis="z").values
    top, t = int(np.abs(z[0]).argmax()), result.time.values
    (a, b, found), _ = curve_fit(
        lambda t, a, b, w: a * np.cos(w * t) + b * np.sin(w * t), t, z[:, top], p0=(z[0, top], 0.0, w)
    )
    miss = np.abs(a * np.cos(found * t) + b * np.sin(found * t) - z[:, top]).max()
    print(found / w - 1.0, np.hypot(a, b) / z[0, top] - 1.0, miss / AMPLITUDE)
    return found / w, np.hypot(a, b) / abs(z[0, top]), miss / AMPLITUDE, result


@pytest.mark.parametrize("number", [1, 2])
def test_a_network_released_in_a_mode_swings_as_its_spectrum_says_and_its_amplitude_stays(number) -> None:
    tree = {**HUNG, "gravity": 9.81}
    w, amplitude, miss, result = swinging(tree, first_upwards(tree, number), number=number)
    assert w == pytest.approx(1.0, abs=1e-3)  # the step, (w dt)^2 / 24 of the modes; amplitude^2
    assert amplitude == pytest.approx(1.0, rel=5e-3)
    assert miss < 0.01
    imbalance = float(np.abs(result.energy.sel(form="imbalance")).max())
    assert imbalance < 0.01 * float(result.energy.sel(form="kinetic").max())


def test_a_network_in_space_begins_in_the_mode_of_the_line_that_is_named() -> None:
    for name in SPAN:
        start = {"line": name, "direction": [0.0, 0.0, 1.0]}
        run = {"kind": "dynamic", "until": 0.01, "start": {"kind": "mode", "amplitude": AMPLITUDE, **start}}
        result = simulate(Scenario.model_validate({**cross_tree(), "run": run}))
        z = np.abs(result.position.sel(axis="z").values[0])
        own = np.array([line == name for line in result.line.values])
        assert z.max() == pytest.approx(AMPLITUDE, rel=1e-6)
        assert z[own].max() >= 0.5 * AMPLITUDE


def test_a_net_released_in_a_mode_swings_as_its_spectrum_says() -> None:
    tree = {"gravity": 0.0, "nets": {"net": NET}}
    w, amplitude, miss, _ = swinging(tree, first_upwards(tree), direction=[0.0, 0.0, 1.0])
    assert w == pytest.approx(1.0, abs=1e-3)
    assert amplitude == pytest.approx(1.0, rel=5e-3)
    assert miss < 0.01


def test_a_motion_that_goes_on_from_a_stored_instant_is_the_one_that_was_not_interrupted(tmp_path) -> None:
    tree = {**HUNG, "gravity": 9.81}
    run = {"kind": "dynamic", "until": 0.4, "every": 0.02, "start": {"kind": "mode", "amplitude": 0.1}}
    file = tmp_path / "whole.nc"
    whole = simulate(Scenario.model_validate({**tree, "run": run}), file=file)
    again = {**run, "until": 0.2, "start": {"kind": "result", "file": str(file), "time": 0.2}}
    later = simulate(Scenario.model_validate({**tree, "run": again}))
    for key in ("position", "velocity"):
        miss = float(np.abs(later[key].values - whole[key].values[10:]).max())
        print(key, miss)
        assert miss < (1e-12 if key == "position" else 1e-11)  # rounding, over steps of 1e-4 s
        assert float(np.abs(np.diff(whole[key].values[10:], axis=0)).max()) > 1e-3
    other = {**tree, "lines": {**tree["lines"], "rope": {**tree["lines"]["rope"], "end": [20, 0.5]}}}
    with pytest.raises(RopewalkError, match=r"a support stands 0\.5 m elsewhere"):
        simulate(Scenario.model_validate({**other, "run": again}))


def test_nets_do_not_whirl() -> None:
    run = {"kind": "dynamic", "until": 0.1, "start": {"kind": "mode", "amplitude": 1e-3, "whirl": True}}
    with pytest.raises(ValueError, match=r"a net has no axis to whirl about"):
        Scenario.model_validate({"gravity": 0.0, "nets": {"net": NET}, "run": run})
