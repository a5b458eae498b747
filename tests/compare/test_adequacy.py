"""Adequacy maps: kept as they come, gone on with, never ended by a point; and right where an answer is known."""

from __future__ import annotations

import json
import os

import numpy as np
import pytest

import adequacy_cases as cases
from ropewalk.compare.adequacy import adequacy
from ropewalk.compare.axes import Axis
from ropewalk.compare.coverage import coverage_of, largest_block
from ropewalk.errors import RopewalkError, ScenarioError
from ropewalk.results import ResultError

X = Axis.linear("lines.string.tension", 1e3, 3e3, 3)
Y = Axis("lines.string.drag", (0.1, 0.2))


def mapped(measure=cases.plain, x=X, y=Y, given=None, **more):
    options = {"workers": 1, "tolerance": 150.0, **more}
    return adequacy(given or cases.scenario(), x, y, measure=measure, **options)


@pytest.fixture
def computed(tmp_path, monkeypatch):
    """Which points were computed since the last look."""
    file = tmp_path / "counted.txt"
    monkeypatch.setenv("COUNTED", str(file))

    def look():
        lines = file.read_text("utf-8").splitlines() if file.exists() else []
        file.unlink(missing_ok=True)
        return lines

    return look


@pytest.fixture
def store(tmp_path):
    return tmp_path / "map.jsonl"


def test_all_simpler_models_and_quantities_come_from_one_go():
    found = mapped()
    assert (found.models, found.quantities) == (("linear", "quasi-static"), ("deflection", "tension"))
    np.testing.assert_allclose(found.of(), [[100.0, 200.0, 300.0], [200.0, 400.0, 600.0]])
    np.testing.assert_allclose(found.of("quasi-static", "tension"), [[0.2] * 3, [0.4] * 3])
    assert np.isnan(found.of("linear", "tension")).all()
    with pytest.raises(ScenarioError, match="no such model, given 'lineer'; did you mean linear"):
        found.of("lineer")


def test_processes_give_the_same_as_none_with_one_thread_each():
    found, alone = mapped(cases.message_where, workers=2), mapped()
    np.testing.assert_array_equal(found.of(), alone.of())
    assert (found.of(quantity="threads") == 1.0).all()
    processes = set(found.of(quantity="process").ravel().tolist())
    assert os.getpid() not in processes
    assert 1 <= len(processes) <= 2


def test_a_map_goes_on_where_it_was_stopped(store, computed):
    with pytest.raises(KeyboardInterrupt, match="2 of 6 points are done and kept in"):
        mapped(cases.interrupted, store=store)
    assert computed() == ["1000 0.1", "2000 0.1"]
    seen = []
    found = mapped(cases.counted, store=store, progress=lambda *how_far: seen.append(how_far))
    assert computed() == ["3000 0.1", "1000 0.2", "2000 0.2", "3000 0.2"]
    assert seen == [(2, 6), (3, 6), (4, 6), (5, 6), (6, 6)]
    np.testing.assert_array_equal(found.distances, mapped().distances)
    mapped(cases.counted, store=store)
    assert computed() == []


def test_ctrl_c_stops_the_processes_too(store):
    with pytest.raises(KeyboardInterrupt, match="of 6 points are done and kept"):
        mapped(cases.interrupted, store=store, workers=2)
    assert not __import__("multiprocessing").active_children()
    assert json.loads(store.read_text("utf-8").splitlines()[0])["format"] == "ropewalk adequacy"


def test_a_line_that_a_kill_has_cut_is_computed_again(store, computed):
    mapped(cases.counted, store=store)
    whole, _ = store.read_bytes(), computed()
    store.write_bytes(whole[:-20])
    mapped(cases.counted, store=store)
    assert computed() == ["3000 0.2"]
    again = [json.loads(line) for line in store.read_text("utf-8").splitlines()]
    assert [line["point"] for line in again[1:]] == [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]
    store.write_bytes(whole[:10])  # killed while it wrote its very first line
    mapped(cases.counted, store=store)
    assert len(computed()) == 6


def test_another_map_is_refused_and_left_alone(store):
    mapped(store=store)
    before = store.read_bytes()
    for message, changes in (
        ("belongs to another scenario", {"given": cases.scenario(gravity=1.0)}),
        ("has another axis x", {"x": Axis.linear("lines.string.tension", 1e3, 3e3, 4)}),
        ("has another axis y", {"y": Axis.linear("lines.string.mass", 1, 2, 2)}),
    ):
        with pytest.raises(ResultError, match=f"{message}; choose another store, or delete it"):
            mapped(store=store, **changes)
    assert store.read_bytes() == before
    mapped(store=store, given=cases.scenario(title="Another name is no other scenario"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"version": 1', '"version": 99', "another version of the format (99 instead of 1)"),
        ('"ropewalk": "', '"ropewalk": "0.0.', "computed by another version of ropewalk, numbers may differ"),
        ('{"point": [0, 0]', '{"point": [7, 0]', "map.jsonl:2: this line cannot be read; delete it"),
        ('{"point": [0, 0]', '"point": [0, 0]', "map.jsonl:2: this line cannot be read; delete it"),
        ('{"format": "ropewalk adequacy"', 'lines: {"rope"', "exists and is no store of points; it is left alone"),
    ],
)
def test_a_store_that_cannot_be_trusted_is_refused(store, old, new, message):
    mapped(store=store)
    text = store.read_text("utf-8")
    assert old in text
    store.write_text(text.replace(old, new, 1), "utf-8")
    with pytest.raises(ResultError) as error:
        mapped(store=store)
    assert message in str(error.value)


def test_a_point_that_fails_is_kept_with_its_reason(store, computed):
    found = mapped(cases.failing, store=store)
    assert found.reasons == (
        ("", "diverged; try a smaller step", "a fault of ropewalk: ZeroDivisionError: float division by zero"),
        ("", "", ""),
    )
    np.testing.assert_array_equal(np.isnan(found.of()), [[False, True, True], [True, False, False]])
    message = json.loads(json.dumps(found.as_dict(), allow_nan=False))
    assert message["distances"]["linear"]["deflection"] == [[100.0, None, None], [None, 400.0, 600.0]]
    assert [fail["point"] for fail in message["failed"]] == [[1, 0], [2, 0]]
    assert (message["adequate"], message["points"]) == (1, 6)
    assert mapped(cases.counted, store=store).reasons == found.reasons
    assert computed() == []
    assert mapped(cases.counted, store=store, retry=True).reasons == (("", "", ""), ("", "", ""))
    assert computed() == ["2000 0.1", "3000 0.1"]


def test_a_process_that_dies_costs_one_point():
    found = mapped(cases.dying, x=Axis("lines.string.tension", (1e3, 2e3)), workers=2)
    assert [[reason[:11] for reason in row] for row in found.reasons] == [["", ""], ["the process", ""]]
    np.testing.assert_allclose(found.of(), [[100.0, 200.0], [np.nan, 400.0]])


def test_a_plane_without_any_answer_is_an_error():
    x, y = Axis("lines.string.tension", (2e3, 3e3)), Axis("lines.string.drag", (0.1, 0.1 + 1e-17 + 0.05))
    with pytest.raises(RopewalkError, match="no point of the plane could be computed; the first one because: no"):
        mapped(_refusing, x=x, y=y)


def _refusing(point):
    raise RopewalkError("no")


@pytest.mark.parametrize(
    ("x", "y", "message"),
    [
        ("load ratio=0.1:1:2", "loads.cart.force.1=-2:-1:2", "both change loads.cart.force"),
        ("speed ratio=0.1:1:2", "loads.cart.travel.speed=1:2:2", "both change loads.cart.travel.speed"),
        ("speed ratio=0.1:1:2", "run.until=1:2:2", "both change run.until"),
        ("lines.strong.tension=1:2:2", "gravity=1:2:2", "unknown key strong in lines"),
        ("lines.string.tensio=1:2:2", "gravity=1:2:2", "unknown key tensio"),
        ("lines.string.tension=1 m:2 m:2", "gravity=1:2:2", "m does not fit: expected a force"),
    ],
)
def test_axes_that_do_not_go_with_the_scenario_are_refused_before_anything_is_computed(x, y, message):
    with pytest.raises(ScenarioError, match=message):
        mapped(x=Axis.parse(x), y=Axis.parse(y))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"tolerance": 0.0}, "tolerance: must be positive, given 0"),
        ({"workers": 0}, "workers: must be at least 1"),
        ({"measure": None, "model": "lineer"}, "no such model, given 'lineer'; did you mean linear"),
        ({"measure": None, "quantity": "tention"}, "no such quantity, given 'tention'; did you mean tension"),
    ],
)
def test_what_is_asked_must_exist(changes, message):
    with pytest.raises(ScenarioError, match=message):
        mapped(**changes)


LOAD, SPEED = Axis("load ratio", (0.01, 0.1, 1.0)), Axis("speed ratio", (0.1, 0.2, 0.3, 0.4))


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        (
            "aaaa aaaa ....",
            "67 % of the plane (8 of 12 points): for load ratios up to 0.1 at any speed ratio from 0.1 to 0.4",
        ),
        ("aaa. aaa. ....", "50 % of the plane (6 of 12 points): for load ratios up to 0.1 with speed ratios up to 0.3"),
        (
            ".a.. .a.. .aa.",
            ": for speed ratio 0.2 at any load ratio from 0.01 to 1, and at 1 more point",
        ),
        ("aaaa aaaa aaaa", "everywhere in the plane; the largest error is at speed ratio 0.1 and load ratio 0.01"),
        (".... .... ....", "nowhere in the plane; the smallest error is at speed ratio 0.1 and load ratio 0.01 (40 %)"),
        ("aa?? .... ....", "speed ratio 0.1 and load ratio 0.1 (40 %); 2 points have no answer"),
        ("aa?? .... ....", "on 17 % of the plane (2 of 12 points): for load ratio 0.01 with speed ratios up to 0.2"),
        ("???? ???? ????", "deflection: the linear theory has no answer anywhere in the plane"),
    ],
)
def test_the_verdict_says_where(rows, message):
    distance = np.array([[{"a": 0.01, ".": 0.4, "?": np.nan}[sign] for sign in row] for row in rows.split()])
    assert message in str(coverage_of(distance, SPEED, LOAD, "linear", "deflection", 0.05))


def test_the_largest_block_is_found():
    good = np.array([[1, 1, 0, 1, 1], [1, 1, 0, 1, 1], [0, 0, 1, 1, 1], [1, 1, 1, 1, 0]], dtype=bool)
    assert largest_block(good) == (0, 2, 3, 4)
    row = np.array([[True, False, True]])
    assert largest_block(row) == largest_block(row.T) == (0, 0, 0, 0)  # of equal ones the first


def test_a_figure_names_axes_tolerance_and_what_failed():
    found = mapped(cases.failing, tolerance=300.0)
    figure = found.figure()
    figure.canvas.draw()
    ax, bar = figure.axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("tension of string (N)", "drag of string (1/s)")
    texts = [text.get_text() for text in figure.texts]
    assert "Where the linear theory is within 30000 % of the full model: deflection" in texts[0].replace("\n", " ")
    assert "× failed (2)   ○ nothing to compare" in texts[1]
    assert "30000 %" in [label.get_text() for label in bar.get_yticklabels()]
    several = mapped().figure(["linear", "quasi-static"])
    several.canvas.draw()
    titles = [ax.get_title("left") for ax in several.axes[:2]]
    assert titles == ["The linear theory: on 17 %", "The quasi-static theory: on 100 %"]


def test_slow_theory_misses_the_travelling_wave_by_what_the_closed_form_says():
    # Before waves come back to the load it is at F x/(P(1 + alpha)), at rest at F x(1 - x/L)/P; the run ends at
    # x = 0.4 L, where both are largest.
    x, y = Axis.linear("speed ratio", 0.3, 0.5, 3), Axis("load ratio", (5e-4, 5e-3))
    fine = cases.scenario(lines={"string": cases.ROPE | {"elements": 80}})  # 40 links lose 8 % of the energy at 0.5
    found = adequacy(fine, x, y, model="quasi-static", workers=1)
    exact = np.abs(1.0 - 0.6 * (1.0 + np.array(x.values)))
    # 80 links: the path of the load is of first order, half a link of 32
    np.testing.assert_allclose(found.of(), np.tile(exact, (2, 1)), atol=0.03)
    # small loads on a taut string: the linear theory is right, up to the links
    assert (found.of("linear") < 0.03).all()
    assert (found.of("moving force") == 0.0).all()
