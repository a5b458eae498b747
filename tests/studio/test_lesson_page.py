"""The walk through the lesson in docs/studio.md: its numbers are those that the steps of the lesson give."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from ropewalk import calc
from ropewalk.scenario import loads
from ropewalk.simulate import simulate
from ropewalk.studio.lesson import LESSON
from ropewalk.studio.poses import Asked, Dragging

PAGE = (Path(__file__).parents[2] / "docs" / "studio.md").read_text(encoding="utf-8")
WALK = PAGE.split("## The lesson, step by step")[1].split("\n## ")[0]


def told(step: int) -> list[float]:
    """The numbers in bold of a step on the page."""
    part = WALK.split(f"**{step}. ")[1].split(f"**{step + 1}. ")[0]
    return [float(number) for number in re.findall(r"\*\*([\d.]+)(?: k?[mNs])?\*\*", part)]


def test_the_lesson_itself_tells_the_numbers_of_the_page() -> None:
    for k, step in enumerate(LESSON, 1):
        numbers = [float(number.split()[0]) for _, number in step["expect"]]
        assert numbers == told(k), step["title"]


def at(step: int, x: float, contact: str) -> tuple[float, float, float, float]:
    """Depth of the load below the supports in m, tension beside it and hold force in N, and friction, at x in m."""
    pose = Dragging(loads(LESSON[step - 1]["scenario"])).posed(Asked("walker", x, contact))
    frame = pose.frame
    hold = float(np.linalg.norm(frame.hold_force[0]))
    return (
        -float(frame.contact_position[0, -1]),
        float(frame.contact_tension[0].max()),
        hold,
        float(frame.contact_friction[0]),
    )


def contact_force(step: int) -> tuple[np.ndarray, np.ndarray]:
    """Instants in s, and what the mass presses with, N."""
    result = simulate(loads(LESSON[step - 1]["scenario"]))
    return result.time.values, -result.contact_force.values[:, 0, -1]


def test_the_page_tells_the_titles_of_all_steps() -> None:
    assert re.findall(r"^\*\*(\d)\. (.*?)\.?\*\*", WALK, flags=re.MULTILINE) == [
        (str(k), step["title"]) for k, step in enumerate(LESSON, 1)
    ]


def test_a_taut_string_is_that_of_the_linear_theory() -> None:
    own, theory = 0.5 * 9.81 * 100.0 / (2.0 * 8e3), 200.0 * 100.0 / (8e3 * 20.0)
    deep, _, _, _ = at(1, 10.0, "clamped")
    assert told(1) == pytest.approx([deep, own + theory], abs=6e-4)


def test_a_slack_rope_is_that_of_the_calculator() -> None:
    deep, tension, _, _ = at(2, 9.75, "clamped")
    answer = calc.span(span=19.5, length=20.0, mass=1.0, load=800.0 / 9.81, axial_stiffness=100e3)
    assert told(2) == pytest.approx([deep, 1e-3 * tension], rel=2e-3)
    assert deep == pytest.approx(answer["sag"], rel=5e-3)


def test_the_hold_force_and_the_friction_instead_of_it() -> None:
    held, rubbing = at(3, 3.0, "frictionless"), at(3, 3.0, "clamped")
    assert told(3) == pytest.approx([held[2], rubbing[3]], rel=5e-3)


def test_a_mass_presses_otherwise_than_it_weighs_until_its_wave_comes_back() -> None:
    (time, force), last = contact_force(4), contact_force(5)
    meets = 2.0 * 20.0 / (np.sqrt(2e3 / 1.0) + 22.0)  # of the linear theory; the mass has raised the tension by then
    early, later = (time > 0.0) & (time < 0.5), (time >= 0.5) & (time < 0.65)
    assert told(4) == pytest.approx([force[early].min(), force[early].max()], rel=5e-3)
    most, force = force[early].max(), last[1]
    leap = float(time[later][np.argmax(force[later] > 1.1 * most)])
    assert told(5) == pytest.approx([leap, force[later].max()], rel=5e-3)
    assert 0.9 * meets < leap < meets


def test_a_page_without_scripts_says_what_is_needed() -> None:
    page = (Path(__file__).parents[2] / "studio" / "index.html").read_text(encoding="utf-8")
    text = page.split("<noscript>")[1].split("</noscript>")[0]
    assert "JavaScript" in text
    assert "ropewalk run" in text
