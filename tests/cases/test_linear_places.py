"""Loads of linear runs stand where they begin, in any measure, and trains come from either end."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk import load
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

FILE = Path(__file__).parent / "linear-horizontal.yaml"
BEAM = {"mass": 2000.0, "bending_stiffness": 1e10, "axial_stiffness": 1e8, "elements": 10, "length": 30.0}
TENSE = {"mass": 2000.0, "bending_stiffness": 1e10, "axial_stiffness": 1e10, "elements": 10, "tension": 1e7}
STRING = {"tension": 1e5, "mass": 10.0, "axial_stiffness": 1e7, "elements": 10}
LINES = {"beam": BEAM, "beam given by tension": TENSE, "string": STRING}
MEASURES = ["material", "horizontal", "arc", "slip"]


def run(line: dict[str, Any], end: list[float], gravity: float = 0.0, until: float = 0.1, **own: Any) -> xr.Dataset:
    given = {
        "gravity": gravity, "lines": {"b": {"start": [0, 0], "end": end, **line}}, "loads": {"w": {"on": "b", **own}},
        "run": {"kind": "linear", "until": until, "every": 0.05},
    }  # fmt: skip
    return simulate(Scenario.model_validate(given))


@pytest.mark.parametrize("measured", MEASURES)
def test_a_force_begins_where_it_is_asked_for(measured: str) -> None:
    found = simulate(load(FILE, [f"loads.F.travel.measured={measured}"])).contact_position.values[:, 0, 0]
    assert found == pytest.approx([6.0, 6.05, 6.1], abs=1e-6)


@pytest.mark.parametrize("measured", MEASURES)
@pytest.mark.parametrize("name", LINES)
def test_forces_on_inclined_lines_begin_and_move_as_measured(name: str, measured: str) -> None:
    own = {"kind": "force", "force": [0, -1.0], "travel": {"speed": 2.0, "from": 6.0, "measured": measured}}
    place = run(LINES[name], [24.0, 18.0], **own).contact_position.values[:, 0]
    way = place[:, 0] if measured == "horizontal" else np.linalg.norm(place, axis=1)
    assert way == pytest.approx([6.0, 6.1, 6.2], rel=1.1e-2 if measured == "material" else 1e-4)  # strain of 1 %, none


@pytest.mark.parametrize("measured", MEASURES)
@pytest.mark.parametrize("name", LINES)
def test_axles_that_run_backwards_are_the_mirror_image(name: str, measured: str) -> None:
    own = {"kind": "axles", "forces": 1e4}
    rows = [[0, 3.13, 7.77], [0, 2.01, 4.03, 6.06, 8.07]]  # each by itself, and all together
    for at in rows[: 1 if name == "string" else 2]:
        both = [
            run(
                LINES[name],
                [30.0, 0.0],
                until=1.5,
                at=at,
                travel={"speed": V, "from": start, "measured": measured},
                **own,
            )
            for V, start in ((10.0, 0.0), (-10.0, 30.0))
        ]
        there, back = (one.position.values[..., 1] for one in both)
        assert np.abs(there).max() > 0.0
        assert back[:, ::-1] == pytest.approx(there, abs=1e-9 * np.abs(there).max())
        there, back = (one.reaction.values[1:, :, 1] for one in both)
        assert back[:, ::-1] == pytest.approx(there, abs=1e-6 * np.abs(there).max())


def test_a_mass_comes_from_the_far_end_of_a_string_given_by_its_tension() -> None:
    own = {"kind": "mass", "mass": 5.0}
    both = [
        run(STRING, [30.0, 0.0], 9.81, 1.0, travel={"speed": V, "from": start, "at_end": "leave"}, **own)
        for V, start in ((20.0, 0.0), (-20.0, 30.0))
    ]
    there, back = (one.position.values[..., 1] for one in both)
    assert back[:, ::-1] == pytest.approx(there, abs=1e-9)


@pytest.mark.parametrize("kind", [{"kind": "mass", "mass": 5.0}, {"kind": "oscillator", "mass": 4.0, "wheel_mass": 1.0,
                                                                 "stiffness": 1e3}])  # fmt: skip
def test_a_load_starts_between_the_ends_of_a_string_in_either_direction(kind: dict[str, Any]) -> None:
    length = float(run(STRING, [30.0, 0.0], 9.81, **kind, travel={"speed": 20.0, "from": 12.0}).xi.values[-1])
    both = [
        run(STRING, [30.0, 0.0], 9.81, **kind, travel={"speed": V, "from": start})
        for V, start in ((20.0, 12.0), (-20.0, length - 12.0))
    ]
    there, back = (one.position.values[..., 1] for one in both)
    assert np.abs(there).max() > 1e-3
    assert back[:, ::-1] == pytest.approx(there, abs=1e-9)


def test_a_train_of_vehicles_that_runs_backwards_is_the_mirror_image() -> None:
    car = {
        "length": 8.0, "bodies": {"box": {"mass": 9e3, "inertia": 2e4}},
        "wheels": {"f": {"at": 2.0, "mass": 100.0}, "r": {"at": -2.0, "mass": 100.0}},
        "springs": {name: {"between": ["box", name], "stiffness": 2e6, "damping": 8e4} for name in "fr"},
    }  # fmt: skip
    own: dict[str, Any] = {"kind": "train", "vehicles": {"car": car}}
    both = []
    for V, start in ((20.0, -1.5), (-20.0, 31.5)):
        load = {"on": "b", **own, "travel": {"speed": V, "from": start}}
        given = {"gravity": 0.0, "lines": {"b": {"start": [0, 0], "end": [30, 0], **BEAM}}, "loads": {"w": load}}
        how = {"kind": "linear", "until": 0.4, "every": 0.1, "modes": 6}
        both.append(simulate(Scenario.model_validate({**given, "run": how})).position.values[..., 1])
    assert np.abs(both[0]).max() > 1e-6
    assert both[1][:, ::-1] == pytest.approx(both[0], abs=1e-12)
