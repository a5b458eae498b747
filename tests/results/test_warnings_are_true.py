"""Warnings and doubts of runs: each is raised by its cause, and the remedy that it names removes it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.model import Scenario
from ropewalk.simulate import simulate

STRING = {"start": [0, 0], "end": [10, 0], "tension": 1000.0, "mass": 0.1, "axial_stiffness": 1e5, "elements": 20}
Tree = dict[str, Any]


def reported(tree: Tree) -> list[str]:
    """All warnings and doubts of a run."""
    found: xr.Dataset = simulate(Scenario.model_validate(tree))
    return [text for key in ("doubts", "warnings") for text in str(found.attrs[key]).splitlines()]


def matching(tree: Tree, words: str) -> list[str]:
    return [text for text in reported(tree) if words in text]


def on_string(load: Tree, run: Tree | None = None, **line: Any) -> Tree:
    string = {key: value for key, value in (STRING | line).items() if value is not None}
    motion = {"kind": "dynamic", "until": 0.1, "every": 2e-3} | (run or {})
    return {"lines": {"string": string}, "loads": {"w": {"on": "string", **load}}, "run": motion}


def mass(speed: float = 10.0, **more: Any) -> Tree:
    return {"kind": "mass", "mass": 1.0, "travel": {"speed": speed, "from": 1.0}} | more


VEHICLE = {
    "kind": "vehicle", "bodies": {"box": {"mass": 500.0}}, "wheels": {"a": {"mass": 50.0}}, "lift_off": True,
    "springs": {"s": {"between": ["box", "a"], "stiffness": 1e5, "damping": 1e3}},
    "travel": {"speed": 20.0, "from": 2.0},
}  # fmt: skip
SOFT = {"wheels": {"a": {"mass": 50.0, "contact_stiffness": 1e7}}}
STIFF = {"wheels": {"a": {"mass": 50.0, "contact_stiffness": 1e8}}}


def over_a_bump(folder: Path, height: float, until: float, every: float, **vehicle: Any) -> Tree:
    """A vehicle that lands behind a bump of a beam."""
    x = np.linspace(0.0, 10.0, 101)
    z = height * np.maximum(0.0, 1.0 - np.abs(x - 4.0) / 0.5)
    np.savetxt(folder / "bump.csv", np.stack([x, z], axis=1), delimiter=",")
    beam = {
        "start": [0, 0], "end": [10, 0], "length": 10.0, "mass": 500.0, "axial_stiffness": 1e9, "elements": 20,
        "bending_stiffness": 1e8, "profile": {"file": str(folder / "bump.csv")},
    }  # fmt: skip
    run = {"kind": "dynamic", "until": until, "every": every}
    return {"lines": {"beam": beam}, "loads": {"w": VEHICLE | {"on": "beam"} | vehicle}, "run": run}


def test_the_impulse_of_a_rigid_wheel_is_named_and_a_contact_stiffness_removes_it(tmp_path: Path) -> None:
    (found,) = matching(over_a_bump(tmp_path, 0.01, 0.15, 5e-4), "alone, ")
    assert "a rigid contact hits the line" in found
    assert "(loads.w.wheels); write lift_off: true and a contact_stiffness" in found
    assert not matching(over_a_bump(tmp_path, 0.01, 0.15, 5e-4, **SOFT), "alone, ")


def test_the_impact_of_a_soft_wheel_is_named_and_a_smaller_output_interval_removes_it(tmp_path: Path) -> None:
    (found,) = matching(over_a_bump(tmp_path, 0.02, 0.35, 2e-3, **STIFF), "alone, ")
    assert "contact_stiffness" not in found  # it has one
    assert "(run.every); write a smaller run.every" in found
    assert not matching(over_a_bump(tmp_path, 0.02, 0.35, 5e-4, **STIFF), "alone, ")


def test_a_mass_has_no_contact_stiffness_to_write(tmp_path: Path) -> None:
    tree = over_a_bump(tmp_path, 0.005, 0.12, 5e-4)
    tree["loads"]["w"] = {"kind": "mass", "on": "beam", "mass": 550.0, "lift_off": True, "travel": VEHICLE["travel"]}
    (found,) = matching(tree, "alone, ")
    assert "write kind: vehicle with a contact_stiffness" in found


def test_a_peak_of_tension_between_output_instants_is_reported_and_a_smaller_interval_removes_it() -> None:
    def pulled(every: float) -> Tree:
        """A string whose end moves out and back within 60 ms."""
        table = {"time": [0.0, 0.1, 0.13, 0.16, 9.0], "value": [[0, 0], [0, 0], [0.05, 0], [0, 0], [0, 0]]}
        string = STRING | {"axial_damping": 50.0, "end_support": {"kind": "moving", "displacement": table}}
        return {"lines": {"string": string}, "run": {"kind": "dynamic", "until": 0.3, "every": every}}

    (found,) = matching(pulled(0.026), "the largest tension")
    assert found.endswith("write a smaller run.every")
    assert not matching(pulled(1e-3), "the largest tension")


def test_a_load_that_is_set_down_is_reported_and_an_equilibrium_or_a_start_at_an_end_removes_it() -> None:
    (found,) = matching(on_string(mass()), "set down suddenly")
    assert "write run.start: {with_loads: true}, or let it start at an end" in found
    assert not matching(on_string(mass(), {"start": {"with_loads": True}}), "set down suddenly")
    assert not matching(on_string(mass(travel={"speed": 10.0})), "set down suddenly")


@pytest.mark.parametrize(
    ("load", "more", "says", "remedy"),
    [
        (mass(), {"gravity": 0.0}, "(gravity); write gravity", {"gravity": 9.81}),
        (
            {"kind": "force", "force": [0.0, 0.0], "travel": {"speed": 10.0, "from": 1.0}}, {},
            "(loads.w.force); give it a force",
            {"loads": {"w": {"kind": "force", "on": "string", "force": [0.0, -9.0], "travel": {"speed": 10.0}}}},
        ),
    ],
)  # fmt: skip
def test_a_load_that_never_presses_is_named_and_its_remedy_helps(
    load: Tree, more: Tree, says: str, remedy: Tree
) -> None:
    tree = on_string(load) | more
    (found,) = matching(tree, "never exerts a force")
    assert says in found
    assert not matching(tree | remedy, "never exerts a force")


def test_a_load_that_is_never_on_its_line_is_named_and_a_later_end_or_another_start_helps() -> None:
    def arriving(start: float, until: float) -> Tree:
        wheels = {"kind": "vehicle", "bodies": {}, "wheels": {"a": {"mass": 1.0}}}
        return on_string(wheels | {"travel": {"speed": 10.0, "from": start, "at_end": "leave"}}, {"until": until})

    (found,) = matching(arriving(-2.0, 0.1), "is never on string")
    assert "write a start on the line, or a later end of the run" in found
    assert not matching(arriving(-2.0, 0.4), "is never on string")
    assert not matching(arriving(1.0, 0.1), "is never on string")


def test_a_wheel_that_pulls_is_reported_and_lift_off_removes_it(tmp_path: Path) -> None:
    tied = over_a_bump(tmp_path, 0.01, 0.15, 5e-4, lift_off=False)
    (found,) = matching(tied, "contact is lost")
    assert found.endswith("write lift_off: true to let it leave the line")
    assert not matching(over_a_bump(tmp_path, 0.01, 0.15, 5e-4), "contact is lost")


def test_a_line_below_the_ground_is_reported_and_tension_or_ground_remove_it() -> None:
    def hung(tension: float, ground: float) -> Tree:
        line = STRING | {"tension": tension, "mass": 5.0}
        outputs = {"ground": [[0.0, ground], [10.0, ground]]}
        return {"lines": {"string": line}, "outputs": outputs, "run": {"kind": "equilibrium"}}

    (found,) = matching(hung(1000.0, -0.1), "below the ground")
    assert "raise the supports or the tension, or correct outputs.ground" in found
    assert not matching(hung(1e5, -0.1), "below the ground")
    assert not matching(hung(1000.0, -2.0), "below the ground")


def test_a_line_that_would_break_is_named_and_strength_or_less_load_helps() -> None:
    """A string of 1 kN whose load of 100 N adds some tension."""
    load = {"kind": "force", "force": [0.0, -100.0], "travel": {"speed": 10.0, "from": 4.0}}
    (found,) = matching(on_string(load, strength=1010.0), "would break")
    assert "increase strength, reduce the load" in found
    assert not matching(on_string(load, strength=2e3), "would break")
    assert not matching(on_string(load | {"force": [0.0, -1.0]}, strength=1010.0), "would break")


def test_a_slack_line_without_weight_is_named_and_a_straight_one_is_not() -> None:
    def still(length: float, gravity: float = 0.0) -> Tree:
        spring = {
            "start": [0, 0], "end": [0, -1], "length": length, "mass": 0.1, "axial_stiffness": 100.0, "elements": 4,
            "end_support": {"kind": "joined", "to": "bob"},
        }  # fmt: skip
        run = {"kind": "dynamic", "until": 1e-3, "every": 1e-3}
        return {"gravity": gravity, "joints": {"bob": {"mass": 1.0}}, "lines": {"spring": spring}, "run": run}

    (found,) = matching(still(1.2), "slack and has no weight")
    assert "give gravity" in found
    assert not matching(still(1.0), "slack and has no weight")
    assert not matching(still(1.2, 9.81), "slack and has no weight")


def test_dampers_that_push_are_reported_and_push_less_with_half_the_damping() -> None:
    """A slack rope that is drawn in: what pushes is its axial damping."""

    def push(damping: float) -> float:
        ends = {"kind": "moving", "displacement": {"time": [0.0, 0.1, 9.0], "value": [[0, 0], [-0.3, 0], [-0.3, 0]]}}
        rope = {
            "start": [0, 0], "end": [10, 0], "tension": 200.0, "mass": 0.1, "axial_stiffness": 1e4, "elements": 20,
            "law": {"kind": "tension_only"}, "axial_damping": damping, "end_support": ends,
        }  # fmt: skip
        run = {"kind": "dynamic", "until": 0.3, "every": 2e-3}
        found = matching({"lines": {"rope": rope}, "run": run}, "has a compressive force of")
        return float(found[0].partition("force of ")[2].partition(" N")[0]) if found else 0.0

    assert push(200.0) > push(100.0) > 0.0
