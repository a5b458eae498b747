"""Statistics of current collection say what can be computed by hand; table, figure, film and report tell them."""

from __future__ import annotations

import dataclasses
import json
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from ropewalk.model import Scenario
from ropewalk.results import Frame, Layout, Recorder, RunInfo, figure, film, html_report, summary, text
from ropewalk.results.acceptance import acceptance_of, against_en50318_2002, against_simple_ac
from ropewalk.results.contact_statistics import (
    contact_statistics,
    filtered,
    line_statistics,
    samples,
    scenario_of,
)
from ropewalk.results.frame import ENERGY_FORMS
from ropewalk.results.stage import Stage
from ropewalk.results.tempo import Tempo
from ropewalk.scenario import load, loads
from ropewalk.simulate import simulate

EXAMPLES = Path(__file__).parents[2] / "examples"
DT = 1e-3  # s
SPEED = 50.0  # m/s
LINE = {"spans": {"count": 4, "length": "50 m"}, "droppers": {"per_span": 1}, "analysed_spans": [2, 2]}
RIDE = {"kind": "pantograph", "on": "line", "model": "simple-ac", "travel": {"speed": "50 m/s"}}
RUN = {"kind": "dynamic", "until": "4 s", "every": "100 ms", "geometry": "linearised"}


def known(time):
    """A force of 100 N with 2 Hz, 10 Hz and 100 Hz in it, lost for 10 ms from 1.5 s on where that is asked for."""
    return (
        100.0 + 20.0 * np.sin(4.0 * np.pi * time) + 10.0 * np.sin(20 * np.pi * time) + 30 * np.sin(200 * np.pi * time)
    )


def ride(force=known, *, ends=None, **changes):
    """A result whose samples are known: a pantograph at 50 m/s, supports at 50, 100 and 150 m, two droppers."""
    ends = 0.1 * np.arange(41) if ends is None else np.array(ends)
    rows = 100
    layout = Layout(
        axes=("x", "z"), node_line=("line.contact",) * 2 + ("line.messenger",) * 2, node_xi=np.array([0, 200.0] * 2),
        link_line=("line.contact", "line.messenger"), link_xi=np.array([100.0, 100.0]), contact_load=("ride",),
        support=("line.contact.start",), tie=("line.2.1", "line.3.1", "line.arm.1"), tie_station=(75.0, 125.0, 50.0),
        watched=("line.support.1", "line.support.2", "line.support.3"), watched_station=(50.0, 100.0, 150.0),
        sample=tuple(DT * (np.arange(rows) - rows)),
    )  # fmt: skip
    scenario = Scenario.model_validate(
        {"title": "Known", "overhead_lines": {"line": LINE}, "loads": {"ride": RIDE | changes}, "run": RUN}
    )
    nothing, unknown = np.zeros(1), np.full((1, 2), np.nan)
    with Recorder(layout, scenario, RunInfo(outcome="completed", steps=1), None) as recorder:
        for i, end in enumerate(ends):
            time = end + np.array(layout.sample)
            there = (time > ends[i - 1] - 0.5 * DT) if i else np.zeros(rows, dtype=bool)

            def sampled(values, there=there):
                return np.where(there.reshape(-1, *[1] * (values.ndim - 1)), values, np.nan)

            slack = np.where(np.sin(2 * np.pi * time) < 0.0, 0.0, 60.0)
            hung = np.stack([np.full(rows, 80.0) + time, slack, np.zeros(rows)], axis=1)
            rise = np.stack(
                [0.05 * np.exp(-((time - at) ** 2) / 0.1) * k for at, k in ((1, 1), (2, 1.2), (3, 2))], axis=1
            )
            recorder.append(Frame(
                path=end, position=np.array([[0, 0], [200, 0], [0, 1.2], [200, 1.2]]), velocity=np.zeros((4, 2)),
                tension=np.array([20e3, 16e3]), strain=np.zeros(2), contact_position=unknown, contact_force=unknown,
                hold_force=unknown, contact_xi=nothing + SPEED * end, contact_speed=nothing + SPEED,
                contact_tension=unknown, contact_friction=nothing, contact_state=nothing + 3.0, contact_in_air=nothing,
                friction_power=nothing, body_position=np.zeros((0, 2)), body_velocity=np.zeros((0, 2)),
                reaction=np.zeros((1, 2)), energy=np.full(len(ENERGY_FORMS), np.nan), tie_force=hung[0],
                sampled_station=sampled((SPEED * time)[:, None]), sampled_force=sampled(force(time)[:, None]),
                sampled_height=sampled(0.01 * time[:, None]), sampled_tie_force=sampled(hung),
                sampled_uplift=sampled(rise),
            ))  # fmt: skip
    return recorder.close()


@pytest.fixture(scope="module")
def result():
    return ride()


@pytest.fixture(scope="module")
def reference():
    return simulate(load(EXAMPLES / "en50318-2002-250.yaml", ["overhead_lines.line.element=0.5 m"]))


@pytest.fixture(scope="module")
def small():
    scenario = """
        title: Two below three spans
        overhead_lines:
          line: {spans: {count: 4, length: 50 m}, droppers: {per_span: 4}, element: 1 m, analysed_spans: [2, 3]}
        loads:
          first: {kind: pantograph, on: line, model: en50318-2002, travel: {speed: 50 m/s, from: 45 m}}
          second: {kind: pantograph, on: line, model: en50318-2002, travel: {speed: 50 m/s, from: 10 m}}
        run: {kind: dynamic, geometry: linearised, until: 2.2 s, every: 50 ms}
    """
    return simulate(loads(scenario))


def test_samples_stand_in_one_row_at_their_own_instants(result):
    flat = samples(result)
    # 40 intervals of 100 samples: the first frame has none.
    np.testing.assert_allclose(flat["time"], DT * np.arange(4000), atol=1e-12)
    for name, expected in (("station", SPEED * flat["time"]), ("force", known(flat["time"]))):
        np.testing.assert_allclose(flat[name].values[:, 0], expected.values, atol=1e-9)
    assert flat["tie_force"].dims == ("instant", "tie")
    assert flat["uplift"].dims == ("instant", "watched")
    assert not any(np.isnan(flat[name]).any() for name in ("station", "force", "height", "tie_force", "uplift"))


def test_a_last_interval_that_is_shorter_has_fewer_samples():
    flat = samples(ride(ends=[0.0, 0.1, 0.2, 0.25]))
    np.testing.assert_allclose(flat["time"], DT * np.arange(250), atol=1e-12)
    np.testing.assert_allclose(flat["force"].values[:, 0], known(flat["time"].values), atol=1e-9)


@pytest.mark.parametrize(("low", "high", "frequency"), [(0, 20, 20), (0, 5, 5), (5, 20, 5), (5, 20, 20)])
def test_the_filter_has_no_phase_and_halves_what_lies_at_its_limits(low, high, frequency):
    time = DT * np.arange(20_000)
    middle = slice(8000, 12_000)  # whole periods, far from the ends
    out = filtered(np.sin(2 * np.pi * frequency * time), DT, low, high)[middle]
    # -3 dB run twice; the bilinear map of the filter is exact at its limits.
    in_phase = 2 * np.mean(out * np.sin(2 * np.pi * frequency * time[middle]))
    aside = 2 * np.mean(out * np.cos(2 * np.pi * frequency * time[middle]))
    assert in_phase == pytest.approx(0.5, abs=1e-3)
    assert aside == pytest.approx(0.0, abs=1e-3)


def test_the_filter_leaves_gaps_and_slow_samples_alone():
    signal = np.full(1000, 7.0)
    signal[300:400] = np.nan
    np.testing.assert_allclose(filtered(signal, DT), signal, atol=1e-9)
    noise = np.random.default_rng(1).normal(size=200)
    np.testing.assert_array_equal(filtered(noise, 0.04), noise)  # 12.5 Hz is all that there is
    np.testing.assert_array_equal(filtered(noise, 0.2, 5.0, 20.0), 0.0)


def test_mean_deviation_and_bands_are_those_put_in(result):
    found = contact_statistics(result)["ride"]
    assert (found.line, found.complete) == ("line", True)
    # Between 50 and 100 m: whole periods, but for the sample at both ends.
    assert (found.first, found.last) == pytest.approx((50.0, 100.0))
    assert found.speed == pytest.approx(SPEED)
    assert found.mean == pytest.approx(100.0, abs=0.1)
    # Sines of amplitude a have a / sqrt 2; the filter leaves 0.996 of 10 Hz, and at most 0.3 % of 100 Hz.
    assert found.deviation_low == pytest.approx(20.0 / np.sqrt(2), rel=5e-3)
    assert found.deviation_high == pytest.approx(10.0 / np.sqrt(2), rel=5e-3)
    assert found.deviation == pytest.approx(np.sqrt(250.0), rel=5e-3)
    assert found.raw_deviation == pytest.approx(np.sqrt(700.0), rel=2e-3)
    assert found.statistical_maximum == pytest.approx(100 + 3 * np.sqrt(250), rel=5e-3)
    assert found.relative_deviation == pytest.approx(np.sqrt(250) / 100, rel=5e-3)
    assert (found.lowest, found.highest) == pytest.approx((0.01, 0.02))
    assert found.loss == 0.0


def test_a_mean_force_that_is_asked_for_is_told_with_the_ratio(result):
    found = contact_statistics(result)["ride"]
    assert found.target == pytest.approx(0.00097 * 180.0**2 + 70.0)  # N, AC at 180 km/h
    assert found.target_ratio == pytest.approx(found.mean / 101.428)
    without = contact_statistics(ride(static_force="100 N"))["ride"]
    assert np.isnan(without.target)


def test_time_without_contact_counts_the_force_as_computed():
    lost = contact_statistics(ride(lambda t: np.where((t > 1.4995) & (t < 1.5095), 0.0, known(t))))["ride"]
    assert lost.loss == pytest.approx(10 / 1001)  # of the samples from 50 to 100 m, both included
    assert lost.minimum > 0.0  # a gap of 10 ms does not show below 20 Hz


def test_a_pantograph_that_passes_a_part_of_the_analysed_spans_says_so():
    part = contact_statistics(ride(ends=0.1 * np.arange(16)))["ride"]  # up to 75 m
    assert not part.complete
    assert part.last == pytest.approx(75.0, abs=0.1)
    never = contact_statistics(ride(ends=0.1 * np.arange(6)))["ride"]
    assert np.isnan(never.mean)
    assert "it was not in the analysed spans" in text(summary(ride(ends=0.1 * np.arange(6))))


def test_samples_too_far_apart_for_the_filter_are_told(result):
    coarse = result.isel(sample=slice(0, 100, 50)).assign_coords(sample=[-0.1, -0.05])
    assert contact_statistics(coarse)["ride"].fastest == pytest.approx(10.0)
    assert "too far apart for 20 Hz" in text(summary(coarse))
    assert "too far apart" not in text(summary(result))


def test_uplift_and_slackness_are_those_put_in(result):
    line = line_statistics(result)["line"]
    message = {name.removeprefix("line."): (s.uplift, s.analysed) for name, s in line.supports.items()}
    assert message == {
        "support.1": (pytest.approx(0.05), True), "support.2": (pytest.approx(0.06), True),
        "support.3": (pytest.approx(0.1), False),
    }  # fmt: skip
    assert contact_statistics(result)["ride"].uplift == pytest.approx(0.06)  # not beside the analysed spans
    assert list(line.droppers) == ["line.2.1", "line.3.1"]  # steady arms are no droppers
    taut, loose = line.droppers.values()
    assert (taut.smallest, taut.largest, taut.slack) == pytest.approx((80.0, 83.999, 0.0))
    # Negative for half of each second: 499 samples of it, beside its zeros, which rounding may give either sign.
    assert loose.slack == pytest.approx(0.5, abs=0.002)
    assert loose.slack_time == pytest.approx(4.0 * loose.slack)
    assert (taut.analysed, loose.analysed) == (True, False)


def test_each_pantograph_has_the_uplift_of_its_own(small):
    """The supports at 50, 100 and 150 m; the second pantograph is 35 m behind the first."""
    flat, found = samples(small), contact_statistics(small)
    assert found["first"].uplift != found["second"].uplift
    below = np.flatnonzero(flat["watched"].to_index().str.startswith("line.support."))
    for k, name in enumerate(flat["load"].values.tolist()):
        own = []
        for w in below:
            away = np.abs(flat["station"].values - float(flat["watched_station"][w]))
            own.append(flat["uplift"].values[away[:, k] <= np.nanmin(away, axis=1), w].max(initial=-1.0))
        assert found[name].uplift == pytest.approx(max(own))
    whole = max(s.uplift for s in line_statistics(small)["line"].supports.values())
    assert max(one.uplift for one in found.values()) == pytest.approx(whole)
    assert text(summary(small)).count("largest uplift of a support") == 2


@pytest.mark.parametrize(
    ("travel", "spans", "message"),
    [
        ("{speed: 50 m/s, from: 100 m}", "[5, 6]", ""),
        ("{speed: 50 m/s, from: 130 m}", "[5, 6]", "starts 70 m before the analysed spans of line"),
        ("{speed: 50 m/s, from: 130 m}", "[5, 6]", "write loads.one.travel.from at least 100 m before them"),
        ("{speed: 50 m/s, from: 210 m}", "[5, 6]", "starts within the analysed spans"),
        ("{speed: 50 m/s, from: 310 m}", "[5, 6]", ""),  # it never comes there
        ("{speed: 50 m/s}", "[2, 6]", "write overhead_lines.line.analysed_spans or more spans"),
        ("{speed: -50 m/s, from: 400 m}", "[5, 6]", ""),
        ("{speed: -50 m/s, from: 390 m}", "[5, 7]", "starts 40 m before"),
    ],
)
def test_a_pantograph_that_starts_too_close_to_the_analysed_spans_is_told(travel, spans, message):
    scenario = loads(f"""
        overhead_lines:
          line: {{spans: {{count: 8, length: 50 m}}, droppers: {{per_span: 2}}, element: 2 m, analysed_spans: {spans}}}
        loads: {{one: {{kind: pantograph, on: line, model: en50318-2002, travel: {travel}}}}}
        run: {{kind: dynamic, geometry: linearised, until: 10 ms}}
    """)
    warnings = simulate(scenario).attrs["warnings"]
    assert message in warnings
    assert bool(message) == ("analysed spans" in warnings)


def test_an_uplift_of_nothing_is_written_as_nothing(result):
    found = summary(result)
    for entry in found["overhead_lines"]["line"]["supports"].values():
        entry["uplift"] = 1e-150
    assert "uplift at line.support.1     0 mm" in re.sub(" +0 mm", "     0 mm", text(found))
    assert "e-1" not in text(found)


def test_a_result_without_a_readable_scenario_is_taken_whole(result):
    without = result.assign_attrs(scenario="")
    found = contact_statistics(without)["ride"]
    assert (found.first, found.last) == pytest.approx((0.0, 200.0), abs=0.1)
    assert found.uplift == pytest.approx(0.1)
    assert list(line_statistics(without)["line"].droppers) == ["line.2.1", "line.3.1"]


def test_ranges_are_met_or_not(result):
    found = contact_statistics(result)["ride"]
    inside = {
        "mean": 116, "deviation": 28.2, "maximum": 190, "minimum": 54, "uplift": 0.0529, "loss": 0.0
    }  # fmt: skip
    good = dataclasses.replace(found, **inside)
    accepted = against_en50318_2002(good, 250 / 3.6)
    assert accepted.is_met
    assert len(accepted.checks) == 8
    for change in ({"mean": 121}, {"uplift": 0.056}, {"loss": 0.001}, {"deviation": np.nan}):
        assert not against_en50318_2002(dataclasses.replace(good, **change), 250 / 3.6).is_met
    assert not against_en50318_2002(good, 300 / 3.6).is_met
    assert against_simple_ac(good, 275 / 3.6).provisional
    assert "provisional" in against_simple_ac(good, 275 / 3.6).remark
    with pytest.raises(ValueError, match="no ranges for 270 km/h; there are some for 250 km/h and 300 km/h"):
        against_en50318_2002(good, 75.0)


@pytest.mark.parametrize(
    ("change", "title"),
    [
        ("run.until=8 s", "EN 50318:2002 reference model at 250 km/h"),
        ("overhead_lines.line.droppers.pushes=100 kN/m", "EN 50318:2002 reference model at 250 km/h"),
        ("loads.pantograph.travel.speed=300 km/h", "EN 50318:2002 reference model at 300 km/h"),
        ("loads.pantograph.travel.speed=260 km/h", None),
        ("overhead_lines.line.contact_wire.tension=20.001 kN", None),
        ("overhead_lines.line.contact_wire.bending_stiffness=195", None),
        ("overhead_lines.line.spans.count=12", None),
        ("loads.pantograph.static_force=125 N", None),
    ],
)
def test_the_reference_model_is_known_by_its_data(change, title, result):
    found = contact_statistics(result)["ride"]
    more = ["run.until=6 s"] if "speed=" in change else []
    scenario = load(EXAMPLES / "en50318-2002-250.yaml", [*more, change])
    compared = acceptance_of(scenario, "pantograph", found)
    assert (compared and compared.title) == title
    assert acceptance_of(scenario, "pantograph", dataclasses.replace(found, complete=False)) is None


def test_the_reference_model_is_told_beside_its_ranges(reference):
    found = summary(reference)
    compared = found["pantographs"]["pantograph"]["acceptance"]
    assert [c["quantity"] for c in compared["checks"] if not c["inside"]] == []
    assert compared["met"]
    table = text(found)
    assert "EN 50318:2002 reference model at 250 km/h\nmean force Fm" in table
    assert "8 of 8" in table
    assert "not a certification" in table
    json.dumps(found, allow_nan=False)


def test_dropper_lengths_are_read_off_the_first_frame(reference):
    # The nodes of droppers are 0.2 mm off the smooth wires of elements of 0.5 m; both wires, and the form itself.
    from ropewalk.overhead.section import section_of

    section = section_of("line", scenario_of(reference).overhead_lines["line"])
    droppers = line_statistics(reference)["line"].droppers
    np.testing.assert_allclose([droppers[name].length for name in section.droppers], section.lengths, atol=1e-3)


def test_the_table_tells_of_pantographs_and_leaves_out_what_is_unknown(small):
    without = small.assign(energy=small["energy"].where(small["form"] == "kinetic"))
    found = summary(without)
    table = text(found)
    headings = re.findall(r"\n\n(.+)\n", table)
    pantographs = ["Pantograph first", "Pantograph second"]
    assert headings == ["Lines", "Supports", *pantographs, "Overhead line line", "Energy at the end", "Method"]
    assert "no audit was kept" in table
    assert "all 10 " in table
    assert len(re.findall(r"\nline\.(?:contact|messenger|support|arm)\S* ", table)) == 3
    assert "uplift at line.support.2" in table
    assert found["pantographs"]["first"]["mean"]["value"] == contact_statistics(small)["first"].mean
    assert found["pantographs"]["first"]["acceptance"] is None
    assert len(found["overhead_lines"]["line"]["droppers"]) == 16


def test_other_results_have_no_pantographs(make):
    found = summary(make())
    assert (found["pantographs"], found["overhead_lines"]) == ({}, {})
    assert (contact_statistics(make()), line_statistics(make())) == ({}, {})


def test_the_figure_shows_what_the_statistics_say(reference):
    fig = figure(reference)
    found = contact_statistics(reference)["pantograph"]
    force, height, droppers = fig.axes[:3]
    levels = {tuple(line.get_ydata()) for line in force.lines if len(line.get_ydata()) == 2}
    for level in (found.mean, found.statistical_maximum, found.statistical_minimum):
        assert (level, level) in levels
    supports = line_statistics(reference)["line"].supports.values()
    marks = next(line for line in height.lines if line.get_marker() == "^")
    np.testing.assert_allclose(marks.get_ydata(), [support.uplift for support in supports])
    assert height.get_ylabel() == "height (mm)"  # axes show another unit than they are drawn in
    assert len(droppers.collections[0].get_segments()) == 90
    for ax in fig.axes:
        assert re.search(r"\(.+\)$", ax.get_ylabel()), ax.get_title("left")


def test_each_pantograph_has_a_panel_of_its_force_and_a_look_of_its_own(small):
    fig = figure(small)
    assert [ax.get_title("left") for ax in fig.axes[:2]] == ["Contact force of first", "Contact force of second"]
    heights = [line for line in fig.axes[2].lines if line.get_label().startswith("contact of ")]
    assert len({line.get_color() for line in heights}) == len({line.get_marker() for line in heights}) == 2


def test_a_film_follows_the_pantograph(small, tmp_path):
    film(small, tmp_path / "film.gif", frames=5)
    with Image.open(tmp_path / "film.gif") as gif:
        assert gif.n_frames == 5
    stage = Stage(small, Tempo(np.array([10, 30]), 40, "real speed"))
    first, last = stage.picture(0), stage.picture(1)
    assert first.shape == (*stage.size[::-1], 3)
    assert (first != last).any()
    np.testing.assert_array_equal(stage.picture(0), first)  # nothing is left over from other frames
    low, high = stage._figure.axes[0].get_xlim()
    assert high == -low >= 45.0
    assert [ax.get_ylabel() for ax in stage._figure.axes[1:]] == ["(mm)", "(N)"]
    assert "times as large" in stage._panel.get_title("right")


def test_slack_droppers_have_another_colour(small):
    slack = int(np.argmax((small["tie_force"].values <= 0.0).sum(axis=1)))
    stage = Stage(small, Tempo(np.array([0, slack]), 40, ""))
    stage.picture(1)
    colours = {tuple(colour) for colour in stage._droppers.get_colors()}
    assert len(colours) == 2


def test_a_report_needs_nothing_else_and_tells_everything(reference):
    page = html_report(reference)
    assert not re.search(r"https?://|<script|<link|@import|url\(", page)
    sources = re.findall(r'<img [^>]*src="([^"]{0,30})', page)
    assert set(sources) == {"data:image/png;base64,iVBORw0K"[:30]}
    for part in ("Summary", "Figures", "Structure", "Results", "Method", "Scenario"):
        assert f"<h2>{part}</h2>" in page
    for block in ("Overhead line line", "Pantograph pantograph"):
        assert page.count(f'<th class="block" colspan="3">{block}</th>') == 2  # data, and results
    assert page.count("inside ") >= 8
    assert "not a certification" in page
    spans = re.findall(r"<tr><td>(\d+)( \*)?</td><td>[\d.]+ m</td><td>60 m</td>", page)
    assert spans == [(str(k), " *" if k in (5, 6) else "") for k in range(1, 11)]
    assert re.findall(r"<td>(\d+|\d+ to \d+)</td><td>(?:[\d.]{5}, ){8}[\d.]{5}</td>", page) == ["1 to 10"]
    assert reference.attrs["scenario_sha256"] in page
    assert "    element: 0.5 m" in page


def test_a_report_of_any_result_has_its_table_and_its_figure(make):
    result = make().assign_attrs(title="<b>Rope</b>", warnings="watch & learn")
    page = html_report(result)
    assert "<h1>&lt;b&gt;Rope&lt;/b&gt;</h1>" in page
    assert "watch &amp; learn" in page
    assert page.count("<img ") >= 1
    assert '<th class="block" colspan="3">Lines</th>' in page


def test_the_command_line_writes_reports(result, tmp_path, monkeypatch):
    from typer.testing import CliRunner

    from ropewalk.cli.app import app

    monkeypatch.chdir(tmp_path)
    result.to_netcdf("out.nc")
    done = CliRunner().invoke(app, ["show", "out.nc", "-o", "report.html"])
    assert done.exit_code == 0, done.output
    assert Path("report.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    refused = CliRunner().invoke(app, ["show", "out.nc", "-o", "report.doc"])
    assert refused.exit_code == 2
    assert ".mp4, .html" in refused.output
