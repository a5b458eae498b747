"""Lessons of the studio: their numbers are those of runs and formulas, and their kept results are up to date."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from ropewalk.results import ResultError, line_response, summary
from ropewalk.results.contract import path_name
from ropewalk.scenario import load
from ropewalk.simulate import simulate
from ropewalk.studio import lesson
from ropewalk.studio.lesson import FOLDER, kept_result, lessons
from ropewalk.theory.moving_mass import moving_mass

ROOT = Path(__file__).parents[2]
NAMES = sorted(file.name.removesuffix(".yaml") for file in FOLDER.glob("*.yaml") if file.stem != "lessons")
ROUNDING = 2.0**-14  # m, of kept positions


@cache
def run(name: str) -> xr.Dataset:
    return simulate(load(FOLDER / f"{name}.yaml"))


def numbers(name: str) -> list[float]:
    """Numbers of an answer."""
    return [float(number.split()[0]) for one in lessons() if one["name"] == name for _, number in one["expect"]]


def height(name: str, x: float) -> np.ndarray:
    """Height over the straight line in mm of the node that begins at x in m, at all instants."""
    position = run(name).position.values
    return 1e3 * position[:, np.argmin(np.abs(position[0, :, 0] - x)), -1]


@pytest.mark.parametrize("name", NAMES)
def test_a_kept_result_is_that_of_a_new_run(name: str) -> None:
    (kept, ended), now = kept_result(name), run(name)
    path = path_name(now)
    assert ended["outcome"] == now.attrs["outcome"] == "completed"
    assert not ended["warnings"]
    assert kept.attrs["scenario_sha256"] == now.attrs["scenario_sha256"]
    np.testing.assert_allclose(kept[path], now[path], rtol=1e-6)  # single precision
    np.testing.assert_allclose(kept.position, now.position, atol=2 * ROUNDING)  # kept rounded; other processors


@pytest.mark.parametrize("name", NAMES)
def test_a_kept_result_has_the_curves_of_the_places_of_its_scenario(name: str) -> None:
    dataset, ended = kept_result(name)
    shown = {place for group in ended["curves"]["groups"] for place in group["curves"]}
    assert shown == {curve.rpartition(".")[0] for curve, _, _ in line_response.histories(dataset)}
    assert bool(shown) == ("places" in (FOLDER / f"{name}.yaml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", NAMES)
def test_a_kept_result_is_small(name: str) -> None:
    assert (FOLDER / f"{name}.nc.xz").stat().st_size < 300_000


def test_a_kept_result_of_another_engine_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    kept_result("wave")
    monkeypatch.setattr(lesson, "ENGINE_NUMBER", lesson.ENGINE_NUMBER + 1)
    with pytest.raises(ResultError, match=r"lesson wave: .* by engine 1; .* engine 2\. Renew it with `make lessons`"):
        kept_result("wave")


@pytest.mark.parametrize("name", ["", "other", "../lessons/wave", "*"])
def test_nothing_but_kept_results_is_opened(name: str) -> None:
    with pytest.raises(ResultError, match="there is no kept result"):
        kept_result(name)


def test_there_are_five_lessons_each_with_one_question_and_its_scenario() -> None:
    page = (ROOT / "docs" / "studio.md").read_text(encoding="utf-8")
    listed = re.findall(r"^(\d)\. \*\*(.*?)\*\*: (.*?\?)$", page, flags=re.MULTILINE | re.DOTALL)
    own = [(str(k), one["title"], one["question"]) for k, one in enumerate(lessons(), 1)]
    assert [(k, title, question.replace("\n   ", " ")) for k, title, question in listed] == own
    for one in lessons():
        assert one["scenario"] == (FOLDER / f"{one['name']}.yaml").read_text(encoding="utf-8")
        assert one["question"].count("?") == 1


def test_a_load_below_the_support_is_held_by_its_weight_times_span_over_length() -> None:
    force, span, length = 800.0, 19.5, 20.0
    hold, depth, friction = numbers("support")
    assert hold == pytest.approx(force * span / length)
    assert depth == pytest.approx((length**2 - span**2) / (2.0 * length), abs=0.005)
    now, clamped = run("support"), run("support.beside")
    x, z = now.contact_position.values[-1, 0]
    assert x == pytest.approx(span, abs=0.005)
    assert float(now.hold_force[-1, 0, 0]) == pytest.approx(hold, rel=0.01)  # stretches by 0.1 %, and is 0.002 m before
    assert -z == pytest.approx(depth, abs=0.025)  # of the longer rope, with half of its weight
    assert float(clamped.contact_friction[-1, 0]) == pytest.approx(friction, abs=0.05)
    assert -float(clamped.contact_position[-1, 0, 1]) == pytest.approx(0.1, abs=0.001)
    assert not clamped.hold_force.values.any()


def test_a_trough_comes_back_and_the_fixed_support_feels_twice_the_force() -> None:
    when, moving, fixed = numbers("wave")
    tension, mass, speed = 1600.0, 1.0, 0.6  # N, kg/m, m/s: 6 mm in 10 ms
    c = np.sqrt(tension / mass)
    assert when == pytest.approx(0.05 + 30.0 / c)
    assert [moving, fixed] == pytest.approx([mass * c * speed, 2.0 * mass * c * speed])
    middle, time = height("wave", 10.0), run("wave").time.values
    assert time[middle.argmin()] == pytest.approx(when, abs=0.011)  # an output interval
    assert time[middle.argmax()] == pytest.approx(0.30, abs=0.001)
    at_ends = np.abs(run("wave").reaction.values[:, :, 1]).max(axis=0)
    assert at_ends == pytest.approx([moving, fixed], rel=0.01)  # the pulse has kinks, which the mesh disperses


def test_a_mass_presses_with_nothing_at_first_and_then_with_more_than_its_weight() -> None:
    time, force = run("mass").time.values, -run("mass").contact_force.values[:, 0, -1]
    at = [force[1], force[50], force.max()]
    assert time[[1, 50]] == pytest.approx([0.01, 0.5])
    assert numbers("mass") == pytest.approx(at, abs=0.5)
    curved = 1.0 + 22.0**2 / 2000.0  # the sag of the string by its own weight, which the theory leaves out
    linear = moving_mass(time, load_mass=10.0, speed=22.0, length=20.0, tension=2000.0, mass=1.0)
    theory = curved * linear.contact_force
    assert theory[[50, 65]] == pytest.approx([125.0, 306.0], abs=0.5)
    assert force[5:55] == pytest.approx(theory[5:55], rel=0.07)  # the string is stretched by 0.2 %
    assert time[force.argmax()] == pytest.approx(0.64, abs=0.011)
    assert np.ptp(run("mass.beside").contact_force.values[:, 0, -1]) == 0.0


def test_a_bridge_resonates_where_coaches_follow_at_its_frequency() -> None:
    speed, first, largest, slower = numbers("bridge")
    frequency = 0.5 * np.pi * np.sqrt(29.545e9 / 10e3) / 30.0**2
    assert speed == pytest.approx(3.6 * frequency * 25.0, abs=0.1)
    down, time = -height("bridge", 15.0), run("bridge").time.values
    assert [down[time < 1.0 / frequency].max(), down.max()] == pytest.approx([first, largest], abs=0.5)
    assert -height("bridge.beside", 15.0).min() == pytest.approx(slower, abs=0.05)
    largest_in_period = [down[(time >= k / frequency) & (time < (k + 1) / frequency)].max() for k in range(10)]
    assert np.all(np.diff(largest_in_period) > 2.0)


def test_droppers_make_the_contact_force_vary_more_than_spans() -> None:
    mean, slow, fast, waves = numbers("pantograph")
    assert waves == pytest.approx(3.6 * np.sqrt(20e3 / 1.35), abs=0.5)
    fields = summary(run("pantograph"))["pantographs"]["pantograph"]
    found = [fields[key]["value"] for key in ("mean", "deviation_low", "deviation_high")]
    assert found == pytest.approx([mean, slow, fast], abs=0.5)


def test_a_page_without_scripts_says_what_is_needed() -> None:
    page = (ROOT / "studio" / "index.html").read_text(encoding="utf-8")
    text = page.split("<noscript>")[1].split("</noscript>")[0]
    assert "JavaScript" in text
    assert "ropewalk run" in text
