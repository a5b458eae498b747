"""Fits against closed forms: tension of a string from its frequencies, mass and tension from a motion."""

from __future__ import annotations

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import design_cases as cases
import ropewalk
from ropewalk.cli.app import app
from ropewalk.errors import RopewalkError, ScenarioError

MASS = "lines.string.mass"
LINKS = 20


def string():
    """A string without a load that counts."""
    lines = {"string": cases.TREE["lines"]["string"] | {"elements": LINKS}}
    loads = {"man": cases.TREE["loads"]["man"] | {"force": [0, -1e-6]}}
    return cases.scenario(lines=lines, loads=loads)


def frequency(tension, mode):
    """Of a string of beads, Hz: w = 2 sqrt(T / m l) sin(k pi / 2 n), with beads m and links l (Lagrange)."""
    link = 10.0 / LINKS
    stretch = 1.0 + tension / cases.AXIAL
    # Mass is per unstretched metre: of each link mass * link / stretch stands over its length.
    return float(np.sqrt(tension * stretch) / link * np.sin(0.5 * np.pi * mode / LINKS) / np.pi)


def test_tension_from_measured_frequencies_is_that_of_the_beaded_string(tmp_path):
    """Three frequencies of 1.7 kN in closed form, with the rounding of a file: to 1e-5."""
    file = tmp_path / "measured.csv"
    rows = [f"frequency {mode}, {frequency(1700.0, mode):.6f} Hz, 0.01 Hz" for mode in (1, 2, 3)]
    file.write_text("\n".join(["quantity, value, deviation", *rows]), encoding="utf-8")
    found = ropewalk.fit(string(), {cases.TENSION: "0.5:4 kN"}, file)
    assert found.numbers[cases.TENSION][0] == pytest.approx(1700.0, rel=1e-5)
    # f = c sqrt T to a part of T / EA: df/dT = f / 2T, so that sigma_T = sigma_f / |J| to that part.
    slopes = np.array([frequency(1700.0, mode) / 3400.0 for mode in (1, 2, 3)])
    assert found.deviations[cases.TENSION] == pytest.approx(0.01 / np.sqrt(slopes @ slopes), rel=0.03)
    low, high = found.intervals[cases.TENSION]
    assert (high - low) / 2 == pytest.approx(4.303 * found.deviations[cases.TENSION], rel=1e-3)  # Student, 2 freedoms
    assert found.at_bounds == []
    assert found.scenario.lines["string"].tension == pytest.approx(1700.0, rel=1e-5)


def test_tension_from_a_noisy_motion_lies_in_its_interval(tmp_path):
    """The linear theory of 1.3 kN with noise of 2 % of the largest deflection."""
    run = {"kind": "linear", "until": 0.3, "every": 0.02}
    loads = {"man": cases.TREE["loads"]["man"] | {"travel": {"speed": 10, "from": 0}}}
    truth = cases.scenario(run=run, loads=loads, lines={
        "string": cases.TREE["lines"]["string"] | {"tension": 1300, "elements": 6}})  # fmt: skip
    model = truth.model_copy(update={"lines": {"string": truth.lines["string"].model_copy(update={"tension": 1000.0})}})
    with ropewalk.simulate(truth) as result:
        times = result["time"].values[1:]
        sag = ropewalk.tables(result)["series"]["string.largest_sag [m]"].to_numpy()[1:]
    noise = 0.02 * sag.max() * np.random.default_rng(3).standard_normal(sag.size)
    rows = [f"{t:.6f}, {1e3 * value:.9f}" for t, value in zip(times, sag + noise, strict=True)]
    file = tmp_path / "series.csv"
    file.write_text("\n".join(["time [s], string.largest_sag [mm]", *rows]), encoding="utf-8")
    found = ropewalk.fit(model, {cases.TENSION: "0.5:4 kN"}, file)
    low, high = found.intervals[cases.TENSION]
    assert low < 1300.0 < high
    assert 2.0 < high - low < 300.0
    assert found.residual == pytest.approx(0.02 * sag.max(), rel=0.5)


def test_what_data_do_not_determine_has_no_interval():
    """Frequencies know tension over mass only."""
    data = {f"frequency {mode}": frequency(1700.0, mode) for mode in (1, 2, 3)}
    found = ropewalk.fit(string(), {cases.TENSION: "0.5:4 kN", MASS: "0.5:2 kg/m"}, data)
    assert np.isnan(list(found.deviations.values())).all()
    tension, mass = (found.numbers[key][0] for key in (cases.TENSION, MASS))
    ratio = 1700.0 * (1.0 + 1700.0 / cases.AXIAL)
    assert tension * (1.0 + tension / cases.AXIAL) / mass == pytest.approx(ratio, rel=1e-5)


@pytest.mark.parametrize(
    ("data", "wrong"),
    [
        ({"frequency 0": 1.0}, "no such frequency"),
        ({"largest_sga": 1.0}, "did you mean largest_sag"),
        ({"largest_sag": "1 apple"}, "apple"),
        ({}, "fewer data than unknowns"),
    ],
)
def test_mistakes_are_told(data, wrong):
    with pytest.raises(ScenarioError, match=wrong):
        ropewalk.fit(string(), {cases.TENSION: "0.5:4 kN"}, data)


def test_the_command_writes_the_scenario_with_its_comments(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "string.yaml").write_text(cases.TEXT, encoding="utf-8")
    with ropewalk.simulate(cases.scenario()) as result:
        sag = ropewalk.summary(result)["largest_sag"]["value"]
    (tmp_path / "data.csv").write_text(f"quantity,value\nlargest_sag,{1e3 * sag!r} mm\nlargest_sag,{1e3 * sag!r} mm\n")
    words = ["fit", "string.yaml", "--data", "data.csv", "--vary", "lines.string.tension=0.6:4 kN", "-o", "fitted.yaml"]
    done = CliRunner().invoke(app, [*words, "--json"])
    assert done.exit_code == 0, done.output
    message = json.loads(done.stdout)
    assert float(message["values"][cases.TENSION].split()[0]) == pytest.approx(1.0, rel=1e-6)
    assert "# of steel" in (tmp_path / "fitted.yaml").read_text("utf-8")
    words[5] = "lines.string.tension=1.2:4 kN"
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 4
    assert "at a bound" in done.stderr


def test_a_model_that_cannot_run_is_told(tmp_path):
    file = tmp_path / "data.csv"
    file.write_text("time [s], force\n0, 1\n1, 2\n", encoding="utf-8")
    with pytest.raises((RopewalkError, ScenarioError), match="no such series"):
        ropewalk.fit(string(), {cases.TENSION: "0.5:4 kN"}, file)
