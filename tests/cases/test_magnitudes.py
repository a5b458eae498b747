"""Absurd but finite numbers are refused with key and remedy, and `check` ends soon whatever the numbers are."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path
from time import process_time
from typing import Any

import pytest
from typer.testing import CliRunner

from ropewalk.cli import console
from ropewalk.cli.app import app
from ropewalk.cli.deadline import Overdue, deadline
from ropewalk.effort import MOST_NODES, about, foreseen
from ropewalk.errors import RopewalkError, ScenarioError
from ropewalk.model import Scenario
from ropewalk.model.magnitudes import check_steps, not_computable
from ropewalk.results.frame import RunInfo
from ropewalk.scenario import load
from ropewalk.simulate import run_of
from ropewalk.system.assembling.membranes import sheet_of

HERE = Path(__file__).parent
REFUSED = {
    "a-light-rope": "lines.rope.mass",
    "b-damped-joined": "lines.rope.axial_damping",
    "c-damped-plain": "lines.rope.axial_damping",
    "c2-damped-winch": "lines.s.axial_damping",
    "d-light-beam": "lines.track.mass",
}


@pytest.mark.parametrize("name", REFUSED)
def test_an_absurd_number_is_refused_with_its_key(name: str) -> None:
    found = CliRunner().invoke(app, ["check", str(HERE / f"{name}.yaml")])
    assert found.exit_code == 2
    assert f": {REFUSED[name]}: " in found.output
    assert "check its unit" in found.output
    assert found.output.count("\n") == 1


@pytest.mark.parametrize("name", ["b-damped-joined", "c-damped-plain"])
def test_the_damping_that_the_remedy_names_is_accepted(name: str) -> None:
    file = HERE / f"{name}.yaml"
    with pytest.raises(ScenarioError) as caught:
        load(file)
    most = re.search(r"write at most (\S+ N\*s)", str(caught.value))
    assert most
    scenario = load(file, [f"lines.rope.axial_damping={most[1]}"])
    words, _ = foreseen(scenario)
    assert words.startswith("dynamic")


ROPE: dict[str, Any] = {
    "start": [0, 0], "end": [20, 0], "tension": 1e4, "mass": 1.0, "axial_stiffness": 1e6, "elements": 8
}  # fmt: skip
DYNAMIC = {"kind": "dynamic", "until": 0.1}


@pytest.mark.parametrize(
    ("key", "value", "run"),
    [
        ("mass", 1e-30, DYNAMIC), ("mass", 1e-12, DYNAMIC),
        ("mass", 1e-12, {"kind": "linear", "until": 1}),
        ("axial_stiffness", 1e18, DYNAMIC), ("axial_stiffness", 1e30, DYNAMIC), ("axial_damping", 1e12, DYNAMIC),
        ("axial_damping", 1e30, DYNAMIC), ("axial_damping", 1e10, DYNAMIC), ("drag", 1e30, DYNAMIC),
        ("drag", 1e12, DYNAMIC),
    ],
)  # fmt: skip
def test_absurd_numbers_of_lines_are_refused_in_all_runs_that_need_them(
    key: str, value: float, run: dict[str, Any]
) -> None:
    for turned in (ROPE, ROPE | {"start": [20, 0], "end": [0, 0]}, ROPE | {"end": [0, 20]}):
        with pytest.raises(ScenarioError) as caught:
            Scenario(**{"lines": {"s": turned | {key: value}, "other": ROPE}, "run": run})
        assert [problem.key for problem in caught.value.problems] == [f"lines.s.{key}"]
        assert caught.value.problems[0].remedy


@pytest.mark.parametrize("line", [{}, {"mass": 1e-4}, {"axial_damping": 1e5}, {"axial_stiffness": 1e9}, {"drag": 1e3}])
def test_unusual_numbers_are_not(line: dict[str, Any]) -> None:
    Scenario.model_validate({"lines": {"s": ROPE | line}, "run": DYNAMIC})


def test_an_equilibrium_may_have_lines_with_next_to_no_mass() -> None:
    Scenario.model_validate({"lines": {"s": ROPE | {"mass": 1e-16}}, "run": {"kind": "equilibrium"}})


def test_a_step_that_makes_countless_steps_is_refused() -> None:
    check_steps(10.0, 1e-6)
    check_steps(10.0, None)
    for step in (1e-30, 0.0):
        with pytest.raises(ScenarioError, match=r"run\.until: the motion would take .* steps of"):
            check_steps(10.0, step)


def test_failing_arithmetic_names_the_numbers_that_are_extreme() -> None:
    tree = {"loads": {"w": {"mass": 1e-20, "stiffness": 5.0, "damping": [0.0, 1e20]}}}
    refused = not_computable(tree, ZeroDivisionError("division by zero"))
    assert refused is not None
    assert [problem.key for problem in refused.problems] == ["loads.w.mass", "loads.w.damping[1]"]
    assert not_computable({"mass": 5.0}, ZeroDivisionError()) is None


def test_a_mesh_of_millions_is_not_built_by_check() -> None:
    scenario = Scenario.model_validate({"lines": {"s": ROPE | {"elements": 10_000_000}}, "run": DYNAMIC})
    assert foreseen(scenario)[0].startswith(f"dynamic: {10_000_001} nodes")
    assert MOST_NODES < 10_000_000


def test_a_run_that_needs_too_much_memory_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    def huge(*_: Any) -> None:
        raise MemoryError("Unable to allocate 346. GiB")

    monkeypatch.setattr(import_module("ropewalk.simulate"), "_motion", huge)
    scenario = Scenario.model_validate({"lines": {"s": ROPE}, "run": DYNAMIC})
    with pytest.raises(RopewalkError, match=r"needs more memory than there is \(Unable to allocate 346\. GiB\); lower"):
        run_of(scenario, RunInfo())


NET: dict[str, Any] = {"kind": "membrane", "stiffness": 1e5, "mass": 0.3, "tension": 500.0}
LAID_OUT: dict[str, dict[str, Any]] = {
    "parallelogram": {"corner": [0, 0, 0], "sides": [[4, 0, 0], [1, 3, 0]], "cells": [8, 6]},
    "default cells": {"corner": [0, 0, 0], "sides": [[4, 0, 0], [0, 3, 0]]},
    "outline": {"boundary": [[0, 0, 0], [9, 0, 0], [9, 6, 0], [4, 3, 0], [0, 6, 0]], "spacing": 0.3},
}


@pytest.mark.parametrize("layout", LAID_OUT.values(), ids=LAID_OUT)
def test_nodes_of_a_net_are_counted_before_it_is_meshed(layout: dict[str, Any]) -> None:
    net = Scenario.model_validate({"nets": {"n": NET | layout}, "run": {"kind": "equilibrium"}}).nets["n"]
    vertices = len(sheet_of("n", net).surface.plan)
    assert net.nodes == (vertices if net.boundary is None else pytest.approx(vertices, rel=0.1))  # of triangles: 7 %


@pytest.mark.parametrize("layout", [{"cells": [2000, 2000]}, {"spacing": 1e-4}, {"spacing": 1e-9}])
def test_nets_of_millions_of_nodes_are_not_meshed_by_check(layout: dict[str, Any]) -> None:
    """A result of two frames of the smallest is not too large."""
    place = "parallelogram" if "cells" in layout else "outline"
    tree = {"nets": {"n": NET | LAID_OUT[place] | layout}, "run": DYNAMIC | {"every": DYNAMIC["until"]}}
    if "cells" in layout:
        assert foreseen(Scenario.model_validate(tree))[0].startswith(f"dynamic: {2001**2} nodes")
    else:
        with pytest.raises(ValueError, match="lower elements or cells of nets"):
            Scenario.model_validate(tree)


def test_check_gives_up_a_beginning_that_takes_long(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def forever(_: Scenario) -> Any:
        while True:
            pass

    monkeypatch.setattr("ropewalk.effort.foreseen", forever)
    monkeypatch.setattr(console, "PATIENCE", 0.1)
    file = tmp_path / "s.json"
    file.write_text(
        '{"lines": {"s": {"start": [0,0], "end": [9,0], "tension": 1e3, "mass": 1, "axial_stiffness": 1e6}}}'
    )
    found = CliRunner().invoke(app, ["check", str(file)])
    assert found.exit_code == 0, found.output
    assert "the start of the run was not evaluated within 0.1 s of computing time" in found.output


def test_a_deadline_is_heard_although_everything_is_caught() -> None:
    def stubborn() -> None:
        with deadline(0.05):
            try:
                while True:
                    pass
            except BaseException:
                while True:
                    pass

    with pytest.raises(Overdue):
        stubborn()


def test_a_deadline_waits_where_llvm_would_drop_its_exception() -> None:
    """Raised there it was lost, and LLVM went on without machine code, up to a crash."""
    found: dict[str, Any] = {"__name__": "llvmlite.binding.ffi", "process_time": process_time, "ends": []}
    exec("def busy(until):\n while process_time() < until: pass\n ends.append(process_time())", found)

    def work() -> None:
        with deadline(0.05):
            found["busy"](process_time() + 0.2)
            while True:
                pass

    with pytest.raises(Overdue):
        work()
    assert found["ends"]


def test_numbers_beyond_whole_ones_are_told_in_words() -> None:
    assert about(1e40).endswith(" h")
