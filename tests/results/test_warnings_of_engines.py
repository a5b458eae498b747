"""Warnings and doubts that engines give: each is raised by its cause, and the remedy that it names removes it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from ropewalk.effort import foreseen
from ropewalk.model import Scenario
from ropewalk.scenario import load
from ropewalk.simulate import simulate

Tree = dict[str, Any]
STRING = {"start": [0, 0], "end": [10, 0], "tension": 1000.0, "mass": 0.1, "axial_stiffness": 1e5, "elements": 20}
STIFF = {
    "start": [0, 0], "end": [19, 0], "length": 20, "mass": 1.0, "axial_stiffness": 1e6, "elements": 40,
    "bending_stiffness": 10.0, "drag": 0.5,
}  # fmt: skip
SAMPLED = {"sample": 0.005}  # of the engine of stiff lines
FORCE = {"kind": "force", "force": [0.0, -49.05]}


def matching(words: str, line: Tree, load: Tree, until: float, every: float, run: Tree | None = None) -> list[str]:
    """Warnings and doubts with some words, of a load on a line."""
    own = {key: value for key, value in line.items() if value is not None}
    motion = {"kind": "dynamic", "until": until, "every": every} | (run or {})
    tree = {"lines": {"line": own}, "loads": {"w": {"on": "line", **load}}, "run": motion}
    found: xr.Dataset = simulate(Scenario.model_validate(tree))
    texts = f"{found.attrs['doubts']}\n{found.attrs['warnings']}".splitlines()
    return [text for text in texts if words in text]


def test_a_mass_as_fast_as_the_waves_of_a_line_on_a_pier_is_named_and_less_speed_or_more_tension_helps() -> None:
    def crossing(speed: float, tension: float) -> list[str]:
        pier = {"supports": {"pier": {"at": 7.0, "kind": "fixed"}}, "tension": tension}
        mass = {"kind": "mass", "mass": 1.0, "travel": {"speed": speed, "from": 0.5}}
        return matching("reaches the speed of the transverse waves", STRING | pier, mass, 5.5 / speed, 1e-3)

    (found,) = crossing(110.0, 1000.0)
    assert "(loads.w.travel.speed); let it go slower, or give the line more tension" in found
    assert not crossing(50.0, 1000.0)
    assert not crossing(110.0, 4000.0)


def test_compression_without_damping_is_reported_and_the_law_or_damping_removes_it() -> None:
    force = {"kind": "force", "force": [0.0, -100.0], "travel": {"speed": 20.0, "from": 3.0}}

    def pressed(**more: Any) -> list[str]:
        return matching("in compression without any damping", STRING | {"tension": 20.0} | more, force, 0.25, 2e-3)

    (found,) = pressed()
    assert "use law {kind: tension_only} or a little axial_damping" in found
    assert not pressed(law={"kind": "tension_only"})
    assert not pressed(axial_damping=1.0)


def test_a_mass_on_a_steep_stiff_line_is_named_and_a_rope_is_not_doubted() -> None:
    mass = {"kind": "mass", "mass": 5.0, "travel": {"speed": 3.0, "from": 2.0}}
    (found,) = matching("has a slope of", STIFF, mass, 0.05, 0.01, SAMPLED)
    assert "(lines.line.bending_stiffness); leave it out, if the line is a rope" in found
    assert not matching("has a slope of", STIFF | {"bending_stiffness": None}, mass, 0.05, 0.01)


def test_a_stiff_line_that_buckles_between_nodes_is_named_and_a_law_or_drag_helps() -> None:
    limp = STIFF | {"drag": None, "bending_stiffness": 1e-9, "elements": 200}
    force = FORCE | {"travel": {"speed": 3.0, "from": 5.0}}
    (found,) = matching("is compressed by", limp, force, 0.15, 0.01, SAMPLED)
    assert "leave it out and write law: {kind: tension_only}, or give more drag" in found
    assert not matching("is compressed by", limp | {"drag": 500.0}, force, 0.15, 0.01, SAMPLED)
    rope = limp | {"bending_stiffness": None, "law": {"kind": "tension_only"}}
    assert not matching("is compressed by", rope, force, 0.15, 0.01)


@pytest.mark.parametrize(("margin", "count"), [(None, 1), (1.0, 0)])
def test_a_mass_that_tears_at_its_support_is_reported_and_an_earlier_end_removes_it(
    margin: float | None, count: int
) -> None:
    slack = {
        "start": [0, 0], "end": [20, 0], "length": 20.2, "mass": 1.0, "axial_stiffness": 1e5, "elements": 40,
        "law": {"kind": "tension_only"},
    }  # fmt: skip
    travel = {"speed": 10.0, "from": 12.0, "at_end": "leave"} | ({} if margin is None else {"margin": margin})
    found = matching("left line and took", slack, {"kind": "mass", "mass": 80.0, "travel": travel}, 0.9, 0.01)
    assert len(found) == count
    assert all("increase travel.margin" in text for text in found)


def test_links_that_are_longer_than_rockers_are_reported_and_the_elements_that_it_names_remove_it() -> None:
    case = Path(__file__).parents[2] / "examples" / "ropeway-tower-brake.yaml"
    (found,) = [text for text in foreseen(load(case))[1] if "rocker" in text]
    elements = found.partition("elements: ")[2].partition(" ")[0]
    assert not [text for text in foreseen(load(case, [f"lines.track.elements={elements}"]))[1] if "rocker" in text]
