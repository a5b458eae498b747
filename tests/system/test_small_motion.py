"""The linear theory of lines that do not stretch, and of lines over sheaves and saddles.

Sources: the same motion with all geometry under a small load; waves along a rope that friction holds on its saddle.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ropewalk.errors import RopewalkError
from ropewalk.model import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.simulate import spectrum_of
from system_cases import changes, frames_of, superposed, with_steps_of

SLACK = {"start": [0, 0], "end": [20, 1], "length": 20.4, "mass": 1.0, "law": {"kind": "inextensible"}, "elements": 24}
TAUT = {"start": [0, 0], "end": [20, 0], "length": 19.95, "mass": 1.0, "axial_stiffness": 1e5, "elements": 40}
OVER = {"at": [12.0, 1.0]}
LINES: dict[str, dict[str, Any]] = {
    "inextensible": SLACK,
    "free sheave": {**TAUT, "sheaves": {"tower": OVER}},
    "sheave that holds": {**TAUT, "sheaves": {"tower": {**OVER, "friction": 0.3}}},
    "smooth saddle": {**TAUT, "saddles": {"tower": {"at": [12.0, 0.5], "radius": 2.0}}},
    "saddle that holds": {**TAUT, "saddles": {"tower": {"at": [12.0, 0.5], "radius": 2.0, "friction": 0.3}}},
}


def motion(line: str, size: float = 1.0, load: dict[str, Any] | None = None, until: float = 0.3) -> Scenario:
    load = {"kind": "force", "force": [0.3 * size, -size]} if load is None else load
    load = {"on": "rope", "travel": {"speed": 6.0, "from": 4.0}} | load
    run = {"kind": "dynamic", "until": until, "every": until / 6.0}
    tree = {"gravity": 9.81, "lines": {"rope": LINES[line]}, "loads": {"a": load}, "run": run}
    return Scenario.model_validate(tree)


@pytest.mark.parametrize("line", LINES)
@pytest.mark.parametrize("kind", ["force", "mass"])
def test_it_is_what_all_geometry_tends_to_as_the_load_vanishes(line: str, kind: str) -> None:
    """What differs of places goes with the square of the load, but for the error of the steps."""
    away = []
    for size in (8.0, 2.0):
        load = {"kind": "mass", "mass": size / 9.81} if kind == "mass" else None
        scenario = motion(line, size, load)
        linear, full = superposed(scenario), frames_of(scenario)
        one, other = (changes(frames, "position") for frames in (linear, full))
        away.append(float(np.abs(one - other).max() / np.abs(one).max()))
    print(away)
    # What travels makes kinks, and those of lines that do not stretch are right to the first order of links in motion.
    assert away[1] < (0.035 if line == "inextensible" else 0.012)
    assert away[1] < 0.45 * away[0]


def test_tensions_of_what_does_not_stretch_balance_the_load() -> None:
    """What a light mass changes of tensions and of what supports bear, until its waves come to the supports."""
    scenario = motion("inextensible", load={"kind": "mass", "mass": 0.1})
    linear, full = superposed(scenario), frames_of(with_steps_of(scenario, 0.25))
    for of in ("tension", "reaction"):
        one, other = (changes(frames, of)[:4] for frames in (linear, full))
        away = np.abs(one - other).max() / np.abs(other).max()
        print(of, away)
        assert away < 0.08, of  # twice what was seen


def test_links_keep_their_lengths_to_the_first_order() -> None:
    frames = superposed(motion("inextensible", 5.0))
    rest, moved = frames[0].position, frames[-1].position - frames[0].position
    stretched = (np.diff(rest, axis=0) * np.diff(moved, axis=0)).sum(axis=1)
    # The line is one of arcs, whose lengths hardly differ from those of their chords.
    assert np.abs(stretched).max() < 2e-3 * np.abs(np.diff(moved, axis=0)).max() * np.abs(np.diff(rest, axis=0)).max()


def test_what_friction_does_not_bear_is_doubted() -> None:
    for line, where in (("sheave that holds", "a sheave"), ("saddle that holds", "a saddle")):
        for size, doubted in ((1.0, False), (800.0, True)):
            run_info = RunInfo()
            superposed(motion(line, size), run_info)
            assert any(f"sticks at {where}" in doubt.what for doubt in run_info.doubts) is doubted


def test_a_load_does_not_pass_a_sheave() -> None:
    scenario = motion("free sheave", load={"kind": "mass", "mass": 0.1, "travel": {"speed": 20.0, "from": 9.0}})
    with pytest.raises(RopewalkError, match=r"loads\.a\.travel: .*reaches a sheave"):
        superposed(scenario)


def test_waves_along_a_rope_that_friction_holds_on_its_saddle_stay_on_their_side() -> None:
    """sqrt(EA/rho) / (2 L) of the longer side; without friction about that of the whole rope."""
    EA, rho = 2e4, 1.0  # slow waves along, among those across
    frequencies = {}
    for friction in (0.0, 0.3):
        line = {**TAUT, "axial_stiffness": EA, "length": 18.0, "elements": 60,
                "saddles": {"tower": {"at": [12.0, 0.0], "radius": 0.5, "friction": friction}}}  # fmt: skip
        run = {"kind": "equilibrium"}
        scenario = Scenario.model_validate({"gravity": 0.01, "lines": {"rope": line}, "run": run})
        modes = spectrum_of(scenario, how_many=40).modes
        assert modes is not None
        along = (np.abs(modes.shape[..., 0]) ** 2).sum(axis=1) / (np.abs(modes.shape) ** 2).sum(axis=(1, 2))
        frequencies[friction] = float(modes.frequency[along > 0.7].min()) / (2.0 * np.pi)
    wave = np.sqrt(EA / rho)
    print(frequencies, wave / 36.0, wave / (2.0 * 10.8))
    assert frequencies[0.3] == pytest.approx(wave / (2.0 * 10.8), rel=0.03)  # up to a link of where it touches
    assert frequencies[0.0] == pytest.approx(wave / (2.0 * 18.0), rel=0.03)
