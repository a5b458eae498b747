"""The summary says what can be computed by hand from a small result."""

from __future__ import annotations

import json

import numpy as np
import pytest
import travelling_wave as wave

from ropewalk.results import Frame, Layout, Recorder, RunInfo, statistics, summary, text
from ropewalk.results.display_units import number
from ropewalk.results.frame import ENERGY_FORMS

NAN = np.nan
LAYOUT = Layout(
    axes=("x", "z"),
    node_line=("left", "left", "left", "right", "right"),
    node_xi=np.array([0.0, 1.0, 2.0, 0.0, 4.0]),
    link_line=("left", "left", "right"),
    link_xi=np.array([0.5, 1.5, 2.0]),
    contact_load=("cart",),
    support=("left.start", "left.end"),
)


NOTHING = (0.0,) * (len(ENERGY_FORMS) - 4)


def frame(time: float, **changes: object) -> Frame:
    values: dict[str, object] = {
        "position": [[0, 0], [1, -0.5], [2, 1], [2, 1], [6, 1]],
        "velocity": np.zeros((5, 2)),
        "tension": [10.0, 20.0, 5.0],
        "strain": [0.1, 0.2, 0.05],
        "contact_position": [[1.0, -0.5]],
        "contact_force": [[3.0, -4.0]],
        "hold_force": [[3.0, 0.0]],
        "contact_xi": [1.0],
        "contact_speed": [2.0],
        "contact_friction": [0.1],
        "contact_tension": [[10.0, 20.0]],
        "contact_state": [3.0],
        "contact_in_air": [0.0],
        "friction_power": [0.0],
        "body_position": np.zeros((0, 2)),
        "body_velocity": np.zeros((0, 2)),
        "reaction": [[-6.0, 8.0], [1.0, 0.0]],
        "energy": np.zeros(len(ENERGY_FORMS)),
        **changes,
    }
    return Frame(path=time, **{name: np.array(value, dtype=float) for name, value in values.items()})


OFF = {
    "contact_position": [[NAN, NAN]],
    "contact_force": [[NAN, NAN]],
    "hold_force": [[NAN, NAN]],
    "contact_xi": [NAN],
    "contact_speed": [NAN],
    "contact_friction": [NAN],
    "contact_tension": [[NAN, NAN]],
}
FRAMES = [
    frame(0.0, energy=[0, 0, 100, *NOTHING, 0]),
    frame(
        0.5,
        tension=[10, 20, -7],
        strain=[0.1, 0.2, -0.07],
        contact_force=[[0, -10]],
        hold_force=[[-2, 0]],
        contact_tension=[[30, 5]],
        reaction=[[-30, 40], [1, 0]],
        energy=[30, 20, 40, 10, *NOTHING[1:], 0.5],
    ),
    frame(1.0, position=[[0, 0], [1, 0.25], [2, 1], [2, 1], [6, 1]], energy=[35, 5, 40, 20, *NOTHING[1:], -0.1], **OFF),
]


def dataset(frames=FRAMES, **run_info):
    recorder = Recorder(LAYOUT, wave.scenario(), RunInfo(outcome="completed", **run_info))
    for entry in frames:
        recorder.append(entry)
    return recorder.close()


@pytest.fixture(scope="module")
def found():
    run_info = {"method": "rkn6", "reason": "undamped", "step": 1e-3, "steps": 1000, "wall_seconds": 0.25}
    return summary(dataset(**run_info, warnings=["compression"]))


def test_the_largest_tension_is_given_with_line_place_and_instant(found):
    expected = {"value": 20.0, "unit": "N", "line": "left", "xi": 1.5, "x": 1.5, "time": 0.0}
    assert found["largest_tension"] == expected


def test_compression_and_the_range_of_strain_are_found(found):
    where = {"line": "right", "xi": 2.0, "x": 4.0, "time": 0.5}
    assert found["smallest_tension"] == {"value": -7.0, "unit": "N", **where}
    assert found["smallest_strain"] == {"value": -0.07, "unit": "1", **where}
    assert found["largest_strain"]["value"] == 0.2


def test_sag_is_measured_from_the_inclined_chord(found):
    assert found["largest_sag"] == {"value": 1.0, "unit": "m", "line": "left", "xi": 1.0, "x": 1.0, "time": 0.0}


def test_a_vertical_line_has_no_sag():
    upright = frame(0.0, position=[[0, 0], [0.1, -1], [0, -2], [3, 0], [3, -4]])
    assert summary(dataset([upright]))["largest_sag"] is None


def test_support_forces_have_magnitude_instant_and_component_ranges(found):
    components = {"x": {"min": -30.0, "max": -6.0}, "z": {"min": 8.0, "max": 40.0}}
    assert found["supports"]["left.start"] == {"value": 50.0, "unit": "N", "time": 0.5, "components": components}


def test_contact_statistics_leave_out_the_time_off_the_line(found):
    cart = found["contacts"]["cart"]
    assert cart["force"]["magnitude"] == {"mean": 7.5, "std": 2.5, "min": 5.0, "max": 10.0}
    assert cart["force"]["z"] == {"mean": -7.0, "std": 3.0, "min": -10.0, "max": -4.0}
    assert cart["share_on_line"] == pytest.approx(2 / 3)
    assert cart["tension_jump"] == {"value": -25.0, "unit": "N", "min": -25.0, "max": 10.0, "time": 0.5}
    assert cart["hold_force"]["components"]["x"] == {"min": -2.0, "max": 3.0}
    assert (cart["hold_force"]["value"], cart["hold_force"]["time"]) == (3.0, 0.0)


def test_the_imbalance_is_compared_with_the_energy_turned_over(found):
    assert found["energy"]["turnover"] == 60.0
    worst = {"value": 0.5, "unit": "J", "relative": 0.5 / 60.0, "time": 0.5}
    assert found["energy"]["largest_imbalance"] == worst
    assert found["energy"]["final"]["line_damping"] == 20.0


def test_the_method_is_told_with_its_pace(found):
    method = found["method"]
    assert (method["name"], method["reason"], method["steps"]) == ("rkn6", "undamped", 1000)
    assert method["step"] == {"value": 1e-3, "unit": "s"}
    assert method["real_time_factor"] == 4.0
    assert found["warnings"] == ["compression"]


def test_the_summary_is_json_without_nan_even_if_nothing_is_known():
    for case in (dataset(), dataset([]), dataset([frame(0.0, **OFF)]), dataset([frame(0.0, tension=[NAN] * 3)])):
        assert json.loads(json.dumps(summary(case), allow_nan=False))["outcome"] == "completed"
        assert "completed" in text(summary(case))
    assert summary(dataset([]))["largest_tension"] is None
    assert summary(dataset([frame(0.0, **OFF)]))["contacts"]["cart"]["force"]["magnitude"]["mean"] is None


def test_a_large_result_is_read_in_pieces_with_the_same_answer(result, monkeypatch):
    whole = summary(result)
    monkeypatch.setattr(statistics, "BLOCK_BYTES", 20_000)
    assert len(list(statistics.blocks(result))) > 5
    assert summary(result) == whole


def test_a_quasistatic_result_has_no_pace_and_places_on_the_load_path(make):
    found = summary(make(wave.layout(path="load_path"), run_info=RunInfo(wall_seconds=0.5)))
    assert found["method"]["real_time_factor"] is None
    assert "load_path" in found["largest_tension"]
    assert "load path = " in text(found)


def test_computing_is_told_from_compiling(make):
    found = summary(make(run_info=RunInfo(wall_seconds=2.5, compile_seconds=2.0)))
    rows = [line.split() for line in text(found).splitlines()]
    assert found["method"]["compiling"] == {"value": 2.0, "unit": "s"}
    assert found["method"]["real_time_factor"] == pytest.approx(3.6)  # of a motion of 1.8 s
    assert ["time", "taken", "500", "ms", "3.60", "times", "real", "time"] in rows
    assert ["compilation", "2.00", "s", "once;", "kernels", "are", "then", "cached"] in rows


def test_the_table_answers_the_first_questions(found):
    table = text(found)
    for row in (
        "largest tension                 20.00 N  left at x = 1.500 m, xi = 1.500 m  t = 0 s",
        "largest sag                     1.000 m  left at x = 1.000 m, xi = 1.000 m  t = 0 s",
        "left.start                      50.00 N  t = 0.5000 s  x: -30.00 to -6.00 N  z: 8.00 to 40.00 N",
        "time taken                      250 ms  4.00 times real time",
        "warning: compression",
    ):
        assert row.split() in [line.split() for line in table.splitlines()]


@pytest.mark.parametrize(
    ("value", "written"),
    [(None, "–"), (0.0, "0"), (2669.4, "2669"), (0.026694, "0.02669"), (-3.14159, "-3.142"), (2.5e7, "2.500e+07")],
)
def test_numbers_have_four_digits(value, written):
    assert number(value) == written
