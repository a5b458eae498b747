"""Meshes that are chosen for an accuracy, and what is told of them."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mesh_cases import PROBLEMS, Problem, motion, scenario, taut
from ropewalk.errors import RopewalkError
from ropewalk.meshes import choosing
from ropewalk.meshes.estimate import Estimate
from ropewalk.model import Scenario
from ropewalk.results import open_result, summary, text
from ropewalk.results.files import ResultError
from ropewalk.resuming import resume
from ropewalk.scenario import dump, loads
from ropewalk.simulate import simulate

ACCURACY = {
    "a force crosses a taut string": 1e-7,
    "a force crosses two joined strings": 4e-8,
    "a rope hangs under a force": 1e-4,
    "a force crosses a beam": 1e-7,
}


def on_auto(problem: Problem, accuracy: float) -> Scenario:
    given = problem.on(problem.elements).model_dump(mode="json", by_alias=True, exclude_none=True)
    for line in given["lines"].values():
        line["elements"] = "auto"
    given["run"]["accuracy"] = f"{accuracy} m"
    return Scenario.model_validate(given)


@pytest.mark.parametrize("name", ACCURACY)
def test_a_chosen_mesh_keeps_the_accuracy(name: str) -> None:
    problem, wanted = PROBLEMS[name], ACCURACY[name]
    result = simulate(on_auto(problem, wanted))
    assert result.attrs["mesh_error"] <= wanted
    assert problem.miss(result) < 2.0 * wanted  # estimates are never too small by more
    assert "chosen for an accuracy" in result.attrs["mesh"]


def test_a_coarser_accuracy_takes_fewer_links() -> None:
    problem = PROBLEMS["a rope hangs"]
    sizes = [simulate(on_auto(problem, accuracy)).sizes["link"] for accuracy in (1e-3, 1e-4, 1e-5)]
    assert sizes[0] < sizes[1] < sizes[2]
    assert sizes[2] < 6 * sizes[1]  # an error of the second order falls tenfold with 3.2 times the links


def test_joined_lines_get_links_of_one_length() -> None:
    given = on_auto(PROBLEMS["a force crosses two joined strings"], 1e-6).model_dump(mode="json", by_alias=True)
    given["lines"]["second"] |= {"end": ["1.5 m", "0 m"], "length": "1 m"}
    given["run"]["until"] = "0.5 s"
    links = simulate(Scenario.model_validate({k: v for k, v in given.items() if v is not None})).link_line.values
    assert np.sum(links == "second") == 2 * np.sum(links == "first")


def whipped(elements: int, **line: Any) -> Scenario:
    """A slack rope that is pushed together under a mass, without damping: its motion is chaotic."""
    rope = {"start": [0, 0], "end": [15, 0], "length": 20, "mass": 1, "axial_stiffness": 1e5, "elements": elements}
    load = {"kind": "mass", "on": "rope", "mass": 40, "travel": {"speed": 10}}
    run = motion(1.8, 40, mesh_error=True)
    return scenario({"rope": rope | line}, {"mass": load}, run, gravity=9.81)


def test_what_does_not_converge_is_doubtful() -> None:
    result = simulate(whipped(80))
    assert result.attrs["outcome"] == "doubtful"
    assert "do not converge as meshes get finer" in result.attrs["doubts"]
    assert result.attrs["mesh_error"] > 1.0


def test_an_accuracy_beyond_the_finest_mesh_is_doubtful(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(choosing, "MOST", 100)
    result = simulate(on_auto(PROBLEMS["a rope hangs"], 1e-5))
    assert result.sizes["link"] == 64
    assert result.attrs["outcome"] == "doubtful"
    assert "are estimated to miss" in result.attrs["doubts"]


def test_a_mesh_too_coarse_for_what_is_asked_is_left_out() -> None:
    """40 half waves are no mode of 16 or 32 links."""
    start = {"kind": "mode", "number": 40, "amplitude": 1e-7}
    line = taut(100) | {"elements": "auto"}
    result = simulate(scenario({"string": line}, {}, motion(0.02, start=start, accuracy=1e-7)))
    assert result.sizes["link"] >= 4 * 64
    assert result.attrs["mesh_error"] <= 1e-7


def test_an_error_that_cannot_be_estimated_is_doubtful() -> None:
    start = {"kind": "mode", "number": 40, "amplitude": 1e-7}
    result = simulate(scenario({"string": taut(64)}, {}, motion(0.02, start=start, mesh_error=True)))
    assert "the error of the mesh cannot be estimated" in result.attrs["doubts"]
    assert "mesh_error" not in result.attrs
    assert summary(result)["mesh"]["error"]["value"] is None


def test_the_error_is_in_the_file_and_the_summary(tmp_path: Path) -> None:
    given = on_auto(PROBLEMS["a force crosses a taut string"], 2e-7)
    file = tmp_path / "string.nc"
    simulate(given, file=file).close()
    with open_result(file) as result:
        found = summary(result)
        again = loads(result.attrs["scenario"], "again.json")
        links = result.sizes["link"]
    assert 0.0 < found["mesh"]["error"]["value"] <= 2e-7
    assert found["mesh"]["of_contacts"]["value"] <= found["mesh"]["error"]["value"]
    assert "estimated error" in text(found)
    assert again.lines["string"].elements == links  # what was run can be run again
    simulate(given, file=file).close()  # is one of the same scenario
    with pytest.raises(ResultError, match="the error of its mesh is that of a run from its beginning"):
        resume(file, 3.0)


def test_elements_auto_are_written_and_stand_for_a_hundred_elsewhere() -> None:
    given = on_auto(PROBLEMS["a rope hangs"], 1e-3)
    assert "elements: auto" in dump(given)
    assert loads(given.model_dump_json(by_alias=True, exclude_none=True), "a.json") == given
    assert given.lines["rope"].elements == 100


LINE = "lines: {{rope: {{start: [0, 0], end: [9, 0], length: 10, mass: 1, axial_stiffness: 1e5, elements: {}}}}}\n"
REFUSED = {
    "rests need an accuracy": (LINE.format("auto") + "run: {kind: equilibrium}", "is required by elements: auto"),
    "an accuracy of rest needs auto": (
        LINE.format("40") + "run: {kind: equilibrium, accuracy: 1 mm}", "is for elements: auto",
    ),
    "linear theory": (LINE.format("auto") + "run: {kind: linear, until: 1}", "geometrically nonlinear"),
    "elements that four does not divide": (
        LINE.format("50") + "run: {kind: equilibrium, mesh_error: true}", "write 48 or 52",
    ),
    "turns": (
        LINE.format("40") + "loads: {a: {kind: force, on: rope, force: [0, -1], travel: {speed: 1}}}\n"
        "run: {kind: quasistatic, turn: 5 deg, mesh_error: true}",
        "mesh-dependent",
    ),
    "results to start from": (
        LINE.format("40") + "run: {kind: dynamic, until: 1, start: {kind: result, file: a.nc}, mesh_error: true}",
        "a state that is on one mesh",
    ),
    "models of others": (
        LINE.format("40") + "loads: {a: {kind: stepper, on: rope, model: 'a.py:b'}}\n"
        "run: {kind: dynamic, until: 1, mesh_error: true}",
        "an external model",
    ),
    "outlines": (
        "nets: {n: {kind: membrane, boundary: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], spacing: 0.1, mass: 1, stiffness: 10}}"
        "\nrun: {kind: equilibrium, mesh_error: true}",
        "an outline has one mesh only",
    ),
    "threads that are the cells": (
        "nets: {n: {kind: net, corner: [0, 0, 0], sides: [[1, 0, 0], [0, 1, 0]], cells: [8, 8], mass: 1,"
        " axial_stiffness: 10}}\nrun: {kind: equilibrium, mesh_error: true}",
        "cannot be refined",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_what_has_no_meshes_is_refused(what: str) -> None:
    given, message = REFUSED[what]
    with pytest.raises(RopewalkError) as caught:
        loads(given, "a.yaml")
    assert message in str(caught.value)


def test_an_estimate_is_that_of_richardson() -> None:
    """Meshes need not be halves of each other."""
    sizes, error = (1.0 / 20.0, 1.0 / 50.0, 1.0 / 80.0), 3.0
    exact, places = np.array([1.0, 2.0]), [np.array([1.0, 2.0]) + error * h**1.7 for h in sizes]
    found = Estimate.of(sizes, *(np.array([[b - a]]) for a, b in pairwise(places)))
    assert found.order == pytest.approx(1.7, abs=1e-9)
    assert found.error == pytest.approx(float(np.linalg.norm(places[-1] - exact)), rel=1e-9)
    assert found.alike == pytest.approx(1.0)
    assert not found.doubt


@pytest.mark.parametrize("elements", [40, "auto"])
def test_nodes_at_inner_supports_need_not_be_those_of_other_meshes(elements: int | str) -> None:
    """A support at 0.3 of the length has a node with ten links, which 11 have not."""
    line = {
        "start": [0, 0], "end": [10, 0], "length": 10.0, "mass": 1.0, "axial_stiffness": 1e6,
        "bending_stiffness": 1e3, "elements": elements, "supports": {"pier": {"kind": "fixed", "at": 3.0}},
    }  # fmt: skip
    more = {"accuracy": 1e-4} if elements == "auto" else {"mesh_error": True}
    result = simulate(scenario({"beam": line}, {}, {"kind": "equilibrium", **more}, gravity=9.81))
    assert 0.0 < result.attrs["mesh_error"] < 1e-3
    assert result.sizes["link"] % 10 == 0
