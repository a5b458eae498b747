"""What loads with a mass leave in results: bodies in pictures, time in the air, friction, the last speed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import travelling_wave as wave

from ropewalk.results import Recorder, figure, single, summary, text
from ropewalk.results.declared import tied, ties
from ropewalk.results.stage import Stage
from ropewalk.results.tempo import tempo

TIMES = 0.1 * np.arange(11)


def crane(loads=("crab",), path="time"):
    """A crab with its payload 1 m below; it is in the air for a while, loses power, and stops after 0.6 s."""
    plan = replace(wave.layout(links=8, loads=loads, path=path), body=(f"{loads[0].partition('.')[0]}.payload",))
    count = len(loads)
    with Recorder(plan, wave.scenario(), wave.run_info()) as recorder:
        for time, frame in zip(TIMES, wave.frames(plan, TIMES), strict=True):
            stopped, flown = time > 0.65, min(max(time - 0.2, 0.0), 0.1)
            recorder.append(
                replace(
                    frame,
                    contact_state=np.full(count, 2.0 if stopped else (1.0 if 0.2 <= time < 0.3 else 3.0)),
                    contact_in_air=np.full(count, flown),
                    contact_speed=np.full(count, 0.0 if stopped else 4.0 + time),
                    friction_power=np.full(count, 0.0 if stopped else 100.0 * time),
                    contact_friction=np.full(count, 0.1),
                    body_position=frame.contact_position[:1] - np.array([0.0, 1.0]),
                    body_velocity=np.zeros((1, 2)),
                )
            )
    return recorder.close()


def test_the_summary_tells_air_friction_and_the_last_speed():
    found = summary(crane())["contacts"]["crab"]
    assert found["share_in_air"] == pytest.approx(0.1)
    assert found["friction_power"] == {"value": pytest.approx(60.0), "unit": "W", "time": pytest.approx(0.6)}
    assert found["friction_work"] == {"value": pytest.approx(21.0), "unit": "J"}  # by trapezia, to 0.7 s
    assert found["last_speed"] == {"value": pytest.approx(4.6), "unit": "m/s", "time": pytest.approx(0.6)}
    table = text(summary(crane()))
    for row in ("in the air 10 % of its time", "last speed 4.600 m/s t = 0.6000 s before it leaves or stops"):
        assert row.split() in [line.split() for line in table.splitlines()]


def test_a_load_that_is_still_moving_has_no_last_speed(result):
    found = summary(result.isel(time=slice(0, 100)))["contacts"]["walker"]
    assert found["last_speed"] is None
    assert not found["share_in_air"]


def test_the_table_leaves_out_forms_of_energy_that_stay_zero_and_json_keeps_them(result):
    found = summary(result)
    table = text(found)
    assert "dissipated by friction" not in table
    assert "work of the loads" in table
    assert found["energy"]["final"]["friction"] == 0.0
    assert "friction" in found["energy"]["always_zero"]


def test_bodies_are_drawn_and_tied_to_the_contacts_of_their_own_load():
    result = crane(("crab.front", "crab.rear"))
    assert ties(result) == [(0, 0), (0, 1)]
    spots = np.array([[1.0, 0.0], [np.nan, np.nan]])
    assert tied(np.array([[1.0, -1.0]]), spots, ties(result)).tolist() == [[[1.0, 0.0], [1.0, -1.0]]]
    ax = single(result, "shapes").axes[0]
    assert "path of crab.payload" in [line.get_label() for line in ax.lines]
    assert ax.get_ylim()[0] < float(result["body_position"].sel(axis="z").min())  # it is in view
    heights = single(result, "contact_height").axes[0]
    np.testing.assert_allclose(heights.lines[-1].get_ydata(), result["body_position"].values[:, 0, 1])


def test_a_film_shows_bodies_and_what_ties_them():
    result = crane()
    stage = Stage(result, tempo(result))
    description = stage._arrays.picture
    description.symbols = [replace(symbol, kind="trolley") for symbol in description.symbols]
    stage.picture(4)
    places = (result[name].values[4, 0] for name in ("contact_position", "body_position"))
    ends = stage._panel.transData.transform(list(places))
    assert any(np.allclose(stroke, ends) for stroke in stage._strokes.get_segments())


def test_the_overview_has_the_panels_that_there_is_something_to_show_in(result):
    def titles(drawn):
        return {ax.get_title("left") for ax in figure(drawn).axes} - {""}

    free = crane().pipe(lambda r: r.assign(hold_force=(0.0 * r["hold_force"]).assign_attrs(r["hold_force"].attrs)))
    assert {"Contact force on the line", "Power lost to friction", "Speed of the load"} <= titles(free)
    assert "Hold force on the line" not in titles(free)
    assert {"Energy residual", "Hold force on the line"} <= titles(result)
    slow = titles(crane(path="load_path"))
    assert "Friction needed" in slow
    assert "Energy residual" not in slow


def test_the_tensions_beside_several_loads_have_a_colour_for_each_load():
    lines = [line for line in single(crane(("a", "b")), "tension").axes[0].lines if " " in line.get_label()][-4:]
    looks = {line.get_label(): (line.get_color(), line.get_linestyle()) for line in lines}
    assert looks["behind a"][0] == looks["ahead of a"][0] != looks["behind b"][0]
    assert len(set(looks.values())) == 4
