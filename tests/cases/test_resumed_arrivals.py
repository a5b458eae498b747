"""Runs that are resumed with a later end are one run, whatever is allocated up to its end."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ropewalk
from ropewalk import load
from ropewalk.model import Scenario
from ropewalk.results.files import ResultError
from ropewalk.simulate import simulate

HERE = Path(__file__).parent
SPAN = {"start": [0, 0], "end": [20, 0]}
BEAM = {**SPAN, "length": 20, "mass": 500, "bending_stiffness": 1e8, "axial_stiffness": 1e9, "elements": 10}
ROPE = {**SPAN, "tension": 1e4, "mass": 5, "axial_stiffness": 1e6, "elements": 10, "axial_damping": 20}
HANGER = {
    "start": [10, 5], "end": [10, 0], "length": 5, "mass": 1, "axial_stiffness": 1e6, "elements": 2,
    "end_support": {"kind": "joined", "to": "b", "at": 10},
}  # fmt: skip
FEET = {"kind": "footsteps", "on": "b", "mass": 70, "from": 1}
BACK = {**FEET, "from": 18, "towards": "start", "lateral": "bachmann"}
TABLE = {"time": [0, 0.5, 2], "value": [[0, -1], [0, -1e3], [0, 0]]}
PUSH = {
    "kind": "force", "on": "b", "force": TABLE, "travel": {"from": 5, "speed": {"time": [0, 1, 2], "value": [1, 2, 0]}},
}  # fmt: skip
LATE = {"kind": "crowd", "on": "b", "number": 2, "rate": 2.0}
AXLES = {"kind": "axles", "on": "b", "forces": 1e3, "at": [0, 3], "travel": {"speed": 8, "from": -6}}
CASES: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "beam, people and a force after them": ({"b": BEAM}, {"one": FEET, "two": BACK, "push": PUSH}),
    "beam, crowd that comes": ({"b": BEAM}, {"people": LATE}),
    "joined, feet": ({"b": BEAM, "h": HANGER}, {"one": FEET}),
    "rope, crowd": ({"b": ROPE}, {"people": {**LATE, "rate": 3.0}}),
    "rope, feet": ({"b": ROPE}, {"one": FEET}),
    "beam, train that comes late": ({"b": BEAM}, {"train": AXLES}),
}


def check(one: Scenario, two: Scenario, file: Path) -> Any:
    """Compare a run with one that is resumed, and return its result."""
    whole = simulate(one)
    simulate(two, file=file).close()
    with ropewalk.resume(file, one.run.until) as found:
        for name in ("position", "contact_force", "contact_position"):
            np.testing.assert_allclose(found[name].values, whole[name].values, rtol=0.0, atol=1e-9)
        return found.load()


def test_feet_go_on_after_a_short_run(tmp_path: Path) -> None:
    asked = load(HERE / "resumed-footsteps.yaml", ["run.until=2.4 s"])
    found = check(asked, load(HERE / "resumed-footsteps.yaml"), tmp_path / "out.nc")
    force, x = found.contact_force.values[..., 1], found.contact_position.values[..., 0]
    assert -force[9, 1] == pytest.approx(552.2, abs=0.1)  # at 1.8 s, known to four digits
    assert -force[10, 1] == pytest.approx(686.7, abs=0.1)  # the weight, as the foot lands alone
    assert x[9, 1] == pytest.approx(3.1, abs=1e-3)  # rows of the beam move by microns
    assert x[9:, 0] == pytest.approx([np.nan, 3.8, 3.8, 3.8], abs=1e-3, nan_ok=True)


@pytest.mark.parametrize("case", CASES)
def test_a_resumed_run_is_one_run(case: str, tmp_path: Path) -> None:
    lines, loads = CASES[case]
    one, two = (
        Scenario.model_validate({"lines": lines, "loads": loads, "run": {"kind": "dynamic", "until": t, "every": 0.2}})
        for t in (1.4, 0.4)
    )
    check(one, two, tmp_path / "out.nc")


def test_a_longer_run_that_is_refused_is_refused_on_resume_and_the_remedy_works(tmp_path: Path) -> None:
    tree = {"lines": {"b": BEAM}, "loads": {"one": {**FEET, "from": 18}}}
    short = Scenario.model_validate({**tree, "run": {"kind": "dynamic", "until": 0.4, "every": 0.2}})
    simulate(short, file=tmp_path / "out.nc").close()
    with pytest.raises(
        ResultError, match=r"cannot be continued until 3 s.*a foot lands beyond.*write run.until: 1.5 s"
    ):
        ropewalk.resume(tmp_path / "out.nc", 3.0)
    with ropewalk.resume(tmp_path / "out.nc", 1.5) as found:
        assert found.attrs["outcome"] == "completed"
