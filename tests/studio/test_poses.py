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
