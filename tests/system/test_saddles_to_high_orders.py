"""Implicit methods and the sixth order over saddles: without friction, which would jump.

Sources: Verlet's method in small steps, which is another one.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ropewalk.model import Scenario
from system_cases import frames_of, imbalance

UNTIL = 0.5


def rope(steps: int, method: str, friction: float = 0.0, **keys: Any) -> Scenario:
    """A soft rope over a saddle, on which a mass is set down."""
    line = {
        "start": [0, 0], "end": [1, 0.1], "length": 1.06, "mass": 1.0, "axial_stiffness": 20.0, "elements": 12,
        "saddles": {"tower": {"at": [0.5, 0.2], "radius": 0.3, "friction": friction}}, **keys,
    }  # fmt: skip
    run = {"kind": "dynamic", "until": UNTIL, "every": UNTIL, "method": method, "step": UNTIL / steps * (1 + 1e-9)}
    run |= {} if method == "verlet" else {"accuracy": 0.9}
    load = {"on": "r", "kind": "mass", "mass": 0.2, "travel": {"speed": 0.0, "from": 0.2}}
    return Scenario.model_validate({"gravity": 1.0, "lines": {"r": line}, "loads": {"m": load}, "run": run})


@pytest.mark.parametrize("damping", [0.0, 0.02])
@pytest.mark.parametrize("method", ["implicit", "rkn6"])
def test_a_rope_swings_over_a_saddle_as_by_verlets_method(method: str, damping: float) -> None:
    """Nodes touch and leave it: forces bend and do not jump, at the cost of the order once each."""
    times = np.array([0.0, UNTIL])
    exact = frames_of(rope(65536, "verlet", axial_damping=damping), times)[-1].position
    frames = {steps: frames_of(rope(steps, method, axial_damping=damping), times) for steps in (64, 128)}
    second = np.abs(frames_of(rope(128, "verlet", axial_damping=damping), times)[-1].position - exact).max()
    errors = [float(np.abs(at[-1].position - exact).max()) for at in frames.values()]
    print(f"errors {errors}, Verlet {second:.3g}, audit {imbalance(frames[128]):.3g}")
    assert errors[1] < 0.1 * second
    assert imbalance(frames[128]) < 5e-4


@pytest.mark.parametrize("method", ["implicit", "rkn6"])
def test_dry_friction_is_refused_for_what_it_is(method: str) -> None:
    with pytest.raises(ValueError, match=rf"{method} with dry friction on saddles .*jumps .*auto or verlet"):
        rope(64, method, 0.2)
