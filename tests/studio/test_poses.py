"""A load under the pointer stands in the equilibrium that `simulate` finds, whatever was asked before."""

from __future__ import annotations

import numpy as np
import pytest

import ropewalk
from ropewalk.scenario import loads
from ropewalk.studio.poses import Asked, Dragging
from studio_server import SHORT

LENGTH = 20.5  # m, by hand


def test_every_place_is_an_equilibrium_whatever_was_asked_before() -> None:
    dragging = Dragging(loads(SHORT))
    longer = {"line": {"length": LENGTH}}
    asked = [
        Asked("walker", 6.0), Asked("walker", 6.5), Asked("walker", 12.0), Asked("walker", 12.0, weight=300.0),
        Asked("walker", 12.0, "frictionless", weight=300.0), Asked("walker", 12.0, **longer), Asked("walker", 5.0),
    ]  # fmt: skip
    for one in asked:
        pose = dragging.posed(one)
        assert pose.frame.contact_position[0, 0] == pytest.approx(one.x, abs=1e-3 * 19.5)  # below a pixel of the page
        text = SHORT.replace("measured: slip, from: 0 m", f"from: {pose.xi!r} m, measured: material")
        text = text[: text.index("run:")].replace("-800 N", f"-{one.weight or 800.0} N")
        text = text.replace("    force:", f"    contact: {one.contact}\n    force:")
        if one.line:
            text = text.replace("length: 20 m", f"length: {LENGTH} m")
        expected = ropewalk.simulate(loads(f"{text}run: {{kind: equilibrium}}\n")).isel(time=0, missing_dims="ignore")
        expected = expected.isel(load_path=0, missing_dims="ignore")
        for name in ("position", "tension", "hold_force"):  # the same solver: to rounding of xi in the text
            np.testing.assert_allclose(getattr(pose.frame, name), expected[name], rtol=1e-9, atol=1e-9)


def test_wind_by_hand_is_that_of_a_scenario() -> None:
    coarse = SHORT.replace("elements: 50", "elements: 10")
    pose = Dragging(loads(coarse)).posed(Asked("walker", 6.0, wind=30.0, line={"wind_drag": 0.05}))
    text = coarse.replace("measured: slip, from: 0 m", f"from: {pose.xi!r} m, measured: material")
    text = text[: text.index("run:")].replace("    force:", "    contact: clamped\n    force:")
    text = text.replace("elements: 10", "elements: 10\n    wind_drag: 50 mm")
    wind = "wind: {direction: [1, 0], speed: 30 m/s}\nrun: {kind: equilibrium}\n"
    expected = ropewalk.simulate(loads(text + wind)).isel(load_path=0)
    for name in ("position", "tension"):
        np.testing.assert_allclose(getattr(pose.frame, name), expected[name], rtol=1e-9, atol=1e-9)
    assert pose.linear is not None  # the theory has no wind


def test_a_line_in_the_wind_of_its_scenario_is_dragged_and_let_go_in_it() -> None:
    windy = SHORT.replace("    elements: 50", "    elements: 10\n    wind_drag: 50 mm").replace(
        "run:", "wind: {direction: [1, 0], speed: 30 m/s}\nrun:"
    )
    dragging = Dragging(loads(windy))
    by_hand = Asked("walker", 6.0, wind=30.0)
    pose, same = dragging.posed(Asked("walker", 6.0)), Dragging(loads(windy)).posed(by_hand)
    np.testing.assert_allclose(pose.frame.tension, same.frame.tension, rtol=1e-9)
    assert np.abs(dragging.posed(Asked("walker", 6.0, wind=0.0)).frame.tension / pose.frame.tension - 1.0).max() > 1e-3
    assert dragging.released(Asked("walker", 6.0), pose.xi).wind == dragging.scenario.wind
    assert dragging.released(by_hand, pose.xi).wind == dragging.scenario.wind
    assert dragging.released(Asked("walker", 6.0, wind=0.0), pose.xi).wind is None
