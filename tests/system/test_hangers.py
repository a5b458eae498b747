"""Rows of hangers: what they hold rests where it is wanted, and the cable above it as statics has it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ropewalk.errors import ScenarioError
from ropewalk.model.scenario import Scenario
from ropewalk.scenario import load, loads
from ropewalk.simulate import simulate, spectrum_of
from ropewalk.system.equilibrium.form_finding import formed

BRIDGE = Path(__file__).parents[2] / "examples" / "suspension-bridge.yaml"
SPAN, GRAVITY = 40.0, 9.81


def bridge(**changes: Any) -> dict[str, Any]:
    """The example as a tree, with other values of its row of hangers."""
    tree: dict[str, Any] = json.loads(load(BRIDGE).model_dump_json(by_alias=True, exclude_unset=True))
    tree["hangers"]["hanger"] |= changes
    tree["hangers"]["hanger"] = {k: v for k, v in tree["hangers"]["hanger"].items() if v is not None}
    return {**tree, "run": {"kind": "equilibrium"}, "loads": {}}


def test_the_deck_rests_level_and_the_hangers_upright() -> None:
    """Within what form finding allows, 4e-7 m; a string between hangers sags beside."""
    scenario = load(BRIDGE, ["run.until=0.1 s"])
    found = simulate(scenario)
    place, line = found["position"].to_numpy()[0], found["line"].to_numpy()
    deck, cable = place[line == "deck"], place[line == "cable"]
    for i in range(1, 10):
        head, foot = place[line == f"hanger-{i}"]
        assert foot[1] == pytest.approx(1.0, abs=5e-7)
        assert head[0] == pytest.approx(foot[0], abs=5e-7)
    assert deck[:, 1].min() < 0.99  # T = 60 kN bears 4 m of 40 kg/m: w l^2/(8 T) = 13 mm
    # Horizontal force of the cable by moments about midspan, weights where they act: links of 6 kg/m where they are,
    # hangers, and the deck on nine of them. What is known is the rest shape; a link is a chord of its arc.
    T, links = found["tension"].to_numpy()[0], found["link_line"].to_numpy()
    middle = cable.shape[0] // 2
    xi = found["xi"].to_numpy()[line == "cable"]
    weight = 6.0 * GRAVITY * np.diff(xi)
    moment, lines = 0.0, formed(scenario).lines
    for w, x in zip(weight, 0.5 * (cable[1:, 0] + cable[:-1, 0]), strict=True):
        moment += w * min(x, SPAN - x) / 2.0
    for i in range(1, 10):
        head = place[line == f"hanger-{i}"][0]
        force = T[links == f"hanger-{i}"].mean() + 0.5 * 0.6 * GRAVITY * lines[f"hanger-{i}"].length
        moment += force * min(head[0], SPAN - head[0]) / 2.0
    H = T[links == "cable"][middle - 1 : middle + 1].mean()
    assert H * (6.0 - cable[middle, 1]) == pytest.approx(moment, rel=1e-3)  # T beside the middle has 2e-4 of slope
    # The parabola of an even weight: H = w L^2/(8 f). The cable is heavier per span where it is steep: 0.2 %.
    row = scenario.hung("hanger").values()
    even = GRAVITY * (40.0 + 6.0 * 40.99 / SPAN + 0.6 * sum(one.length for one in row if one.length) / SPAN)
    assert pytest.approx(even * SPAN**2 / (8.0 * (6.0 - cable[middle, 1])), rel=3e-3) == H


def test_camber_and_places() -> None:
    """Hangers at places of their own hold the deck on a parabola."""
    scenario = loads(json.dumps(bridge(count=None, at=[6.0, 14.0, 20.0, 30.0], camber=0.2)))
    found = simulate(scenario)
    place, line = found["position"].to_numpy()[0], found["line"].to_numpy()
    for i in range(1, 5):
        foot = place[line == f"hanger-{i}"][-1]
        part = foot[0] / SPAN
        assert foot[1] == pytest.approx(1.0 + 0.8 * part * (1.0 - part), abs=5e-6)  # rest of polygons, not of splines


def test_the_same_bridge_line_by_line_has_the_same_spectrum() -> None:
    """Hangers written one by one, as form finding has them: the block is no more than that."""
    scenario = load(BRIDGE)
    by_lines = Scenario.model_validate(formed(scenario).model_dump(by_alias=True))
    assert len(by_lines.lines) == 11
    assert not by_lines.hangers
    one, other = (spectrum_of(each, how_many=4).modes.frequency for each in (scenario, by_lines))
    assert np.abs(one / other - 1.0).max() < 1e-9


MISTAKES = {
    "no such line": ({"from": "cabel"}, "from", "did you mean cable"),
    "one line": ({"from": "deck"}, "to", "is the line that they hang from"),
    "no places": ({"count": None}, "count", "the positions are not determined"),
    "both": ({"at": [3.0]}, "count", "exclude each other"),
    "places that fall": ({"count": None, "at": [5.0, 4.0]}, "at", "places must rise"),
    "beyond the end": ({"count": None, "at": [41.0]}, "at", "not between the ends of deck"),
}


@pytest.mark.parametrize("case", MISTAKES)
def test_mistakes_are_told_at_their_key(case: str) -> None:
    changes, key, says = MISTAKES[case]
    with pytest.raises(ScenarioError) as error:
        loads(json.dumps(bridge(**changes)))
    (problem,) = error.value.problems
    assert problem.key == f"hangers.hanger.{key}"
    assert says in f"{problem.wrong} {problem.remedy}"


def test_a_cable_that_is_too_low_is_told() -> None:
    tree = bridge()
    tree["lines"]["cable"] |= {"start": [0.0, 2.0], "end": [40.0, 2.0]}
    with pytest.raises(ScenarioError, match="does not hang above deck"):
        loads(json.dumps(tree))


def test_what_changes_meshes_is_refused() -> None:
    with pytest.raises(ScenarioError, match="not implemented for rows of hangers"):
        loads(json.dumps(bridge() | {"run": {"kind": "equilibrium", "mesh_error": True}}))
