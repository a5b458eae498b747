"""A rope that lifts off its saddle is warned about, and its sag is that of the span without the saddle."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import brentq

import ropewalk
from ropewalk.model import Scenario
from ropewalk.results import summary
from ropewalk.scenario import load

FOLDER = Path(__file__).parent
FORCE, WEIGHT, RISE = 60e3, 98.1, 40.0
REVERSED = (
    "lines={track: {start: [0 m, 40 m], saddles: {tower: {at: [100 m, 0 m], radius: 10 m}}, end: [200 m, 0 m], "
    "start_support: {kind: guided, along: [-1, 0], force: 60 kN}, length: 203 m, mass: 10 kg/m, "
    "axial_stiffness: 100 MN, elements: 60}}"
)


def found(*settings: str, name: str = "b-rope-above-tower", elements: int = 60) -> dict:
    return summary(ropewalk.simulate(load(FOLDER / f"{name}.yaml", [*settings, f"lines.track.elements={elements}"])))


def lifted(result: dict) -> list[str]:
    return [warning for warning in result["warnings"] if "does not touch saddle" in warning]


def catenary_sag(span: float) -> float:
    """Largest depth below the chord of an inextensible catenary with the horizontal force FORCE, m."""
    a = FORCE / WEIGHT
    x0 = brentq(lambda x: a * (np.cosh((span - x) / a) - np.cosh(x / a)) - RISE, -1e3, 1e3)
    x = np.linspace(0.0, span, 2001)
    return float((RISE * x / span - a * (np.cosh((x - x0) / a) - np.cosh(x0 / a))).max())


@pytest.mark.parametrize("direction", [(), (REVERSED,)], ids=["forward", "reversed"])
def test_a_rope_above_its_tower_is_warned_about_and_sags_between_its_ends(direction):
    result = ropewalk.simulate(load(FOLDER / "b-rope-above-tower.yaml", [*direction, "lines.track.elements=60"]))
    own = summary(result)
    (warning,) = lifted(own)
    ends = result["position"].values[0, [0, -1], 0]
    assert own["largest_sag"]["value"] == pytest.approx(catenary_sag(abs(ends[1] - ends[0])), rel=2e-3)  # it stretches
    height = np.interp(100.0, result["position"].values[0, :, 0], result["position"].values[0, :, 1])
    assert "saddle tower" in warning
    assert float(re.search(r"up to ([\d.]+) m above", warning)[1]) == pytest.approx(height, abs=0.01)


def test_only_the_tower_without_contact_is_named_and_spanned():
    own = found(name="b-ropeway-as-asked", elements=290)
    (warning,) = lifted(own)
    assert "saddle tower 2" in warning
    assert own["largest_sag"]["value"] == pytest.approx(13.8, abs=0.05)
    assert 380.0 < own["largest_sag"]["x"] < 1140.0


@pytest.mark.parametrize("remedy", ["raise", "less tension"])
def test_the_remedies_bring_the_rope_onto_the_saddle(remedy):
    (warning,) = lifted(found())
    gap = float(re.search(r"by more than ([\d.]+) m", warning)[1])
    settings = [f"lines.track.saddles.tower.at=[100 m, {1.05 * gap} m]"]
    if remedy == "less tension":
        assert "or give the line less tension" in warning
        settings = ["lines.track.end_support.force=20 kN", "lines.track.length=207 m"]
    own = found(*settings)
    assert not lifted(own)
    assert own["supports"]["track.tower"]["value"] > 0.0


def test_in_a_motion_the_warning_names_the_instant():
    (warning,) = lifted(found("run={kind: dynamic, until: 0.02, every: 0.01}"))
    assert "from t = 0 s on" in warning


def test_a_rope_found_below_its_saddle_is_doubtful_until_links_are_short_enough():
    own = found(name="b-ropeway-as-asked", elements=145)
    (doubt,) = [doubt for doubt in own["doubts"] if "below the crown" in doubt]
    assert own["outcome"] == "doubtful"
    assert "saddle tower 1" in doubt
    elements = int(re.search(r"lines.track.elements: (\d+) or more", doubt)[1])
    own = found(name="b-ropeway-as-asked", elements=elements)
    assert own["outcome"] == "completed"
    assert own["supports"]["track.tower 1"]["value"] == pytest.approx(154e3, rel=0.01)  # 200 elements: 154.2 kN


SLACK = {"start": [0, 0], "end": [240, 30], "mass": 8.0, "axial_stiffness": 100e6, "elements": 240}
ONE, TWO = {"a": [80, 20]}, {"a": [80, 10], "b": [160, 15]}


def slack(crowns: dict, length: float, radius: float = 8.0, load: float = 0.0, **run: object) -> xr.Dataset:
    saddles = {name: {"at": at, "radius": radius} for name, at in crowns.items()}
    travel = {"speed": 2.0, "from": 120.0}
    loads = {"loads": {"m": {"kind": "mass", "on": "track", "mass": load, "travel": travel}}} if load else {}
    line = {**SLACK, "length": length, "saddles": saddles}
    return ropewalk.simulate(
        Scenario.model_validate({"lines": {"track": line}, **loads, "run": run or {"kind": "equilibrium"}})
    )


@pytest.mark.parametrize(
    ("crowns", "length", "run"),
    [(ONE, 246.0, {}), (TWO, 243.0, {}), (TWO, 243.0, {"kind": "dynamic", "until": 0.02, "every": 0.01})],
    ids=["one", "two", "dynamic"],
)
def test_a_slack_rope_between_fixed_ends_lies_on_its_saddles(crowns, length, run):
    result = slack(crowns, length, **run)
    x, z = result["position"].values[0].T
    for at in crowns.values():
        assert np.interp(at[0], x, z) == pytest.approx(at[1], abs=0.05)  # straight links over a groove
    assert result.attrs["outcome"] == "completed"
    assert 19e3 < result["tension"].values.max() < 25e3  # as over sheaves at the crowns: 20.3 and 22.4 kN, not 1.3 MN


def test_a_rope_that_its_load_pulls_past_fine_saddles_lies_on_larger_ones():
    high = {"a": [80, 20], "b": [160, 30]}
    doubts = summary(slack(high, 245.0, load=3e3))["doubts"]
    assert all("the search for its equilibrium has passed the saddle" in doubt for doubt in doubts)
    radius = float(re.search(r"saddles.a.radius: ([\d.]+) m", doubts[0])[1])
    own = summary(slack(high, 245.0, radius, load=3e3))
    assert own["outcome"] == "completed"
    assert not own["doubts"]
