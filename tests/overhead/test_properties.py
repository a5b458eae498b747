"""Elasticity, factors of waves and blow-off of overhead lines, against other routes to the same numbers."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from overhead_assembly import Hermite
from overhead_cases import EN_2002, formed
from ropewalk.cli.app import app
from ropewalk.errors import EquilibriumError
from ropewalk.model import Scenario
from ropewalk.overhead.lateral import wind_deflection
from ropewalk.overhead.properties import doppler_factor, elasticity_of, reflection, wave_speed
from ropewalk.simulate import simulate

EXAMPLE = Path(__file__).parents[2] / "examples" / "en50318-2002-250.yaml"
LINE: dict[str, Any] = {**EN_2002, "spans": {"count": 4, "length": "60 m"}, "analysed_spans": [2, 2]}


def test_the_elasticity_along_a_span_and_its_non_uniformity_are_those_of_hermite_elements() -> None:
    found = elasticity_of(formed({**LINE, "element": 0.25}), force=2.0)  # no dropper slackens
    # Wires that stretch a thousand times more easily keep their tension, as weights at their ends would let them.
    wires = {key: {**LINE[key], "axial_stiffness": "10 kN"} for key in ("contact_wire", "messenger_wire")}
    exact = Hermite(formed({**LINE, **wires, "ends": "anchored"}).plan, 0.1).elasticity(found.station)
    np.testing.assert_allclose(found.value, exact, rtol=4e-3)  # wires without EI have kinks; 0.25 m
    spread = (exact.max() - exact.min()) / (exact.max() + exact.min())
    assert found.non_uniformity == pytest.approx(spread, abs=2e-3)
    assert (found.station[0], found.station[-1]) == (60.0, 120.0)


def test_slack_droppers_yield_more_and_ends_do_not_count() -> None:
    firm, soft = (elasticity_of(formed(LINE), force=force, span=1) for force in (2.0, 200.0))
    assert (soft.value > (1.0 - 1e-9) * firm.value).all()
    assert (soft.value / firm.value).max() > 1.2
    assert firm.station[0] > 0.0  # the end of the wire does not rise
    with pytest.raises(EquilibriumError, match="has no span 5; write 1 to 4"):
        elasticity_of(formed(LINE), span=5)


def test_a_wave_is_reflected_at_a_dropper_as_the_coefficient_says() -> None:
    """A step of force starts waves of F / (2 sqrt(T m)); what comes back from a dropper is smaller by r, and turned."""
    line = {
        **EN_2002, "spans": {"count": 1, "length": "160 m"}, "droppers": {"at": [60], "stiffness": "10 MN/m"},
        "messenger_wire": {"mass": "2.14 kg/m", "tension": "16 kN", "bending_stiffness": 0}, "system_height": "8 m",
        "analysed_spans": [1, 1], "element": "0.2 m",
    }  # fmt: skip
    run = {"kind": "dynamic", "geometry": "linearised", "until": 0.5, "every": 0.01}
    load = {"kind": "force", "on": "line", "force": [0.0, 10.0],
            "travel": {"speed": 1e-6, "from": 80.0, "measured": "horizontal"}}  # fmt: skip
    found = simulate(Scenario.model_validate({"overhead_lines": {"line": line}, "loads": {"push": load}, "run": run}))
    wires = formed(line).plan.wires[:2]
    c = wave_speed(wires[0])
    assert c == pytest.approx(121.716, abs=1e-3)
    time, height = found.time.values, found.contact_position.values[:, 0, 1]

    def speed(begin: float, end: float) -> float:
        first, last = np.searchsorted(time, [begin, end])
        return float((height[last] - height[first]) / (time[last] - time[first]))

    away = 20.0  # m from the dropper; the end of the wire is 80 m off
    before, after = speed(0.05, 0.3), speed(2.0 * away / c + 0.04, 0.49)
    assert before == pytest.approx(10.0 / (2.0 * math.sqrt(20e3 * 1.35)), rel=1e-3)
    # sqrt(16000 * 2.14) / (sqrt(20000 * 1.35) + sqrt(16000 * 2.14)) = 0.5297
    assert reflection(*wires) == pytest.approx(0.52966, abs=1e-5)
    assert 1.0 - after / before == pytest.approx(reflection(*wires), abs=4e-3)


def test_the_doppler_factor_is_the_ratio_of_intervals_sent_and_met() -> None:
    """A pantograph sends two signals ahead; an obstacle throws them back, and it meets them closer together."""
    wire, v = formed(LINE).plan.wires[0], 70.0
    c, wall = wave_speed(wire), 400.0
    sent = np.array([0.0, 0.1])
    struck = sent + (wall - v * sent) / c
    met = (wall + c * struck) / (c + v)  # wall - c (t - struck) = v t
    assert doppler_factor(wire, v) == pytest.approx(float(np.diff(met)[0] / np.diff(sent)[0]), rel=1e-12)
    assert doppler_factor(wire, 0.0) == 1.0
    assert doppler_factor(wire, 130.0) < 0.0


@pytest.mark.parametrize(
    ("begin", "end", "load"), [(0.2, -0.2, 8.0), (0.3, 0.1, 5.0), (-0.2, -0.2, 8.0), (0.4, -0.4, 1.0)]
)
def test_wind_deflection_is_the_largest_of_the_string_both_ways(begin: float, end: float, load: float) -> None:
    span, tension = 60.0, 20e3
    x = np.linspace(0.0, span, 20001)
    chord, bow = begin + (end - begin) * x / span, load * x * (span - x) / (2.0 * tension)
    expected = max(np.abs(chord + bow).max(), np.abs(chord - bow).max())
    assert wind_deflection(span, begin, end, tension, load) == pytest.approx(float(expected), abs=1e-8)


def test_without_wind_the_wire_is_furthest_aside_at_a_support() -> None:
    assert wind_deflection(60.0, 0.2, -0.3, 20e3, 0.0) == 0.3


def call(*args: str) -> Any:
    return CliRunner().invoke(app, ["elasticity", *args])


def test_the_command_tells_of_lines_and_of_the_pantographs_below_them() -> None:
    coarse = ("--set", "overhead_lines.line.element=1 m")
    found = call(str(EXAMPLE), *coarse, "--json", "--side-load", "8 N/m")
    assert found.exit_code == 0, found.output
    line = json.loads(found.stdout)["line"]
    v, c = 250.0 / 3.6, math.sqrt(20e3 / 1.35)
    r = math.sqrt(16e3 * 1.07) / (math.sqrt(20e3 * 1.35) + math.sqrt(16e3 * 1.07))
    assert line["pantographs"]["pantograph"]["doppler"] == pytest.approx((c - v) / (c + v))
    assert line["pantographs"]["pantograph"]["amplification"] == pytest.approx(r * (c + v) / (c - v))
    assert line["wind_deflection"]["value"] == pytest.approx(8.0 * 60.0**2 / (8.0 * 20e3))
    table = " ".join(call(str(EXAMPLE), *coarse, "--side-load", "8 N/m").stdout.split())
    assert "amplification of pantograph 1.62" in table
    assert "lateral deflection of the contact wire under 8 N/m at most 180 mm" in table


def test_the_command_refuses_what_it_cannot_tell() -> None:
    bead = call(str(EXAMPLE.with_name("moving-force.yaml")))
    assert (bead.exit_code, "has no overhead line" in bead.stderr) == (2, True)
    for option, value, says in (("--force", "0 N", "above 0 N"), ("--side-load", "-1 N/m", "0 N/m or more")):
        refused = call(str(EXAMPLE), option, value)
        assert refused.exit_code == 2
        assert says in refused.stderr
    assert call(str(EXAMPLE), "--span", "11").exit_code == 2
