"""The paper's figures can be drawn, and show what the models give."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ropewalk.paper import AVAILABLE, figure6, figures
from ropewalk.simulate import simulate


def test_figure_6_is_written_with_the_parameters_that_were_chosen(tmp_path: Path) -> None:
    done: list[float] = []
    written = figures(tmp_path / "new", only=[6], progress=done.append)
    assert [path.name for path in written] == ["figure-6.png"]
    assert written[0].stat().st_size > 20_000
    assert done == [1.0]
    assert 6 in AVAILABLE


def test_figure_6_names_every_parameter_of_its_rope() -> None:
    text = figure6.draw()._supxlabel.get_text()
    for part in ("L = 20 m", "X = 20 m", "rho = 1 kg/m", "EA = 100 kN", "F = 700 N", "V = 10 m/s"):
        assert part in text


def test_figure_6_motion_and_damped_rope_meet_their_paths() -> None:
    motion = figure6.scenario(elements=100)
    fast, slow = simulate(motion), figure6.damped(motion)
    rest = figure6.shape_at(slow, 15.0)
    load = fast.contact_position.values[-1, 0]
    # Statics has no doubt about 1e-4 m: the load on the heavy rope three quarters along (interpolated shapes).
    np.testing.assert_allclose(rest.contact_position.values[0], [14.907, -1.678], atol=2e-3)
    # In motion the rope lies higher there, by some centimetres, and the load a little less far.
    assert 0.02 < load[1] - rest.contact_position.values[0][1] < 0.15
    # dxi = V dt / (1 + eps), with 2 % strain in the mean of the way.
    assert fast.contact_xi.values[-1, 0] == pytest.approx(15.0 / 1.019, abs=0.02)
