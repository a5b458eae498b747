"""The summary separates the transient of a start out of equilibrium from what follows it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import ropewalk
from ropewalk.results import summary, tables, text
from ropewalk.scenario import load, loads
from ropewalk.sweeps.quantities import measured

TENSION, MASS, SPAN = 10e3, 1.0, 20.0
ROPE = """
gravity: GRAVITY
lines: {rope: {start: [0, 0], end: [20, 0], tension: 10 kN, mass: 1, axial_stiffness: 1 MN, elements: 40, MORE}}
loads: {w: {kind: LOAD, on: rope, travel: {speed: SPEED, from: AT, at_end: leave}}}
run: {kind: dynamic, until: UNTIL, every: 1 ms, START}
"""
PLAIN = {"GRAVITY": "9.81", "MORE": "drag: 3 Hz", "LOAD": "mass, mass: 5", "SPEED": "0", "AT": "5", "UNTIL": "0.6"}


def run(start: str = "start: {kind: rest}", **changes: str):
    tree = ROPE.replace("START", start)
    for name, value in {**PLAIN, **changes}.items():
        tree = tree.replace(name, value)
    return ropewalk.simulate(loads(tree))


@pytest.mark.parametrize("at", ["5", "15", "10"])
def test_the_transient_of_a_load_set_down_ends_when_waves_have_returned(at):
    result = run(AT=at)
    own = summary(result)
    later = own["after_start"]
    far = max(float(at), SPAN - float(at))
    assert later["from"]["value"] == pytest.approx(1.1 * 2.0 * far / np.sqrt(TENSION / MASS), rel=0.02)  # it sags
    assert later["loads"] == ["w"]
    keep = result["time"].values >= later["from"]["value"]
    force = np.linalg.norm(result["contact_force"].values[keep, 0], axis=1)
    assert later["contacts"]["w"]["force"]["magnitude"]["max"] == pytest.approx(force.max())
    tension = result["tension"].values
    assert later["largest_tension"]["value"] == pytest.approx(tension[keep].max())
    assert own["largest_tension"]["value"] == pytest.approx(tension.max())  # the whole run, as before
    said = text(own)
    assert "Without the start-up transient" in said
    assert "after_start.largest_tension" in tables(result)["summary"]["quantity"].tolist()


@pytest.mark.parametrize("load", ["mass, mass: 5", "force, force: [0, -50]"])
def test_a_load_that_starts_at_speed_has_a_transient_though_it_starts_at_rest_with_the_line(load):
    if load.startswith("mass"):
        assert summary(run("start: {with_loads: true}", LOAD=load))["after_start"] is None
    own = summary(run("start: {with_loads: true}", LOAD=load, SPEED="10", UNTIL="0.4"))
    assert own["after_start"]["contacts"]["w"]["force"]["magnitude"]["max"] is not None


@pytest.mark.parametrize("change", [{"AT": "0", "SPEED": "10"}, {"UNTIL": "0.01"}])
def test_no_transient_is_cut_off_where_none_begins_or_nothing_is_left(change):
    own = summary(run(**change))
    if "AT" in change:
        assert own["after_start"] is None
        assert "tart-up transient" not in text(own)
    else:
        assert set(own["after_start"]) == {"from", "loads"}
        assert "after the run, so all values include it" in text(own)


@pytest.mark.parametrize(("bed", "stiffness"), [("", 0.0), (", foundation: 10 kN/m^2", 10e3)])
def test_the_transient_of_a_beam_is_that_of_its_first_mode(bed, stiffness):
    """Half a period of the first mode for a load at midspan, 1.1 times."""
    own = summary(run(MORE=f"bending_stiffness: 1 MN*m^2{bed}", AT="10"))
    wave = np.pi / SPAN
    first = np.sqrt((TENSION * wave**2 + 1e6 * wave**4 + stiffness) / MASS)  # rad/s
    assert own["after_start"]["from"]["value"] == pytest.approx(1.1 * np.pi / first, rel=0.02)


@pytest.mark.parametrize("inner", ["saddles: {s: {at: [12, HIGH], radius: 2}}", "supports: {s: {at: 12, kind: fixed}}"])
def test_the_span_of_a_load_ends_at_inner_supports_that_touch_the_line(inner):
    own = summary(run(MORE=inner.replace("HIGH", "0.2"), AT="4"))
    c = np.sqrt(own["largest_tension"]["value"] / MASS)
    assert own["after_start"]["from"]["value"] == pytest.approx(1.1 * 2.0 * 8.0 / c, rel=0.05)  # a node at 11.9 m
    if "saddles" in inner:  # far below the line
        own = summary(run(MORE=inner.replace("HIGH", "-2"), AT="4"))
        assert own["after_start"]["from"]["value"] == pytest.approx(1.1 * 2.0 * 16.0 / c, rel=0.05)


def test_names_of_quantities_mean_the_whole_run_unless_they_say_otherwise():
    result = run()
    whole, later = (
        measured(result, [name])[name][0]
        for name in ("w.force.magnitude.max", "after_start.contacts.w.force.magnitude.max")
    )
    own = summary(result)
    assert whole == own["contacts"]["w"]["force"]["magnitude"]["max"]
    assert later == own["after_start"]["contacts"]["w"]["force"]["magnitude"]["max"]


def test_wheel_loads_of_a_carriage_that_starts_at_speed_are_reported_apart_from_its_start():
    """Links of 4 m give 10.11 and 10.20 kN; those of 2 m 9.46 kN at 0.05 s and 10.10 kN at 3.95 s while braking."""
    case = Path(__file__).parent / "b-ropeway-brake.yaml"
    settings = ["lines.track.elements=290", "run.until=5 s"]
    own = summary(ropewalk.simulate(load(case, settings)))
    later = own["after_start"]
    assert 1.95 < later["from"]["value"] < 3.5  # after the first reflection from tower 1, before the brake acts
    whole, rest = (found["carriages"]["car"]["wheel_load"] for found in (own, later))
    assert whole["min"]["time"] < 0.3
    assert rest["min"]["time"] > 3.0
    assert rest["min"]["value"] > 1.005 * whole["min"]["value"]
    rows = text(own).partition("Without the start-up transient")[2].splitlines()
    assert [row for row in rows if row.startswith("car: least wheel load")]
