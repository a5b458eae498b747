"""Two loads at one place are one load of twice the size, or a warning names the two contacts that are too close."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from ropewalk import load
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

FILE = Path(__file__).parent / "two-halves.yaml"
ROPE: dict[str, Any] = {
    "start": [0, 0], "end": [19.5, 0], "length": 20, "mass": 1.0, "axial_stiffness": 1e5, "axial_damping": 50.0,
    "bending_stiffness": 100.0, "elements": 20,
}  # fmt: skip
RIGID = {"start": [0, 0], "end": [19.5, 0], "length": 20, "mass": 1.0, "law": {"kind": "inextensible"}, "elements": 20}
SHORT = {"kind": "dynamic", "until": 0.3, "every": 0.05}
STILL = {"kind": "equilibrium"}
WARNING = "closer than a link of"


def pressed(x: float, size: float, kind: str = "force", speed: float = 10.0) -> dict[str, Any]:
    what = {"force": [0.0, -size]} if kind == "force" else {"mass": size / 9.81}
    return {"kind": kind, "on": "r", "travel": {"speed": speed, "from": x}, **what}


def answer(line: dict[str, Any], loads: dict[str, Any], run: dict[str, Any], **more: Any) -> xr.Dataset:
    return simulate(Scenario.model_validate({"lines": {"r": line}, "loads": loads, "run": run, **more}))


def halves(gap: float = 2e-5, kind: str = "force", size: float = 400.0) -> dict[str, Any]:
    return {"a": pressed(7.3, size, kind), "b": pressed(7.3 + gap, size, kind)}


@pytest.mark.xfail(strict=True, reason="one engine, stage 2")
def test_two_halves_have_the_tension_of_the_whole() -> None:
    assert float(simulate(load(FILE)).tension.max()) == pytest.approx(3478.0, rel=1e-3)


@pytest.mark.xfail(strict=True, reason="one engine, stage 2")
def test_two_halves_on_an_inextensible_line_have_the_tension_of_the_whole() -> None:
    one, two = (answer(RIGID, loads, SHORT) for loads in ({"a": pressed(7.3, 800.0)}, halves()))
    assert float(two.tension.max()) == pytest.approx(float(one.tension.max()), rel=0.01)


def test_two_halves_are_named_and_the_remedy_is_one_load() -> None:
    result = simulate(load(FILE))
    text = next(text for text in str(result.warnings).splitlines() if WARNING in text)
    assert text.startswith("contacts a and b are 2e-05 m apart")
    assert "write one load with the sum of both" in text
    whole = simulate(load(FILE, ["loads.a.force=[0 N, -800 N]", "loads.b.force=[0 N, 0 N]"]))
    assert WARNING not in whole.warnings
    assert float(whole.tension.max()) == pytest.approx(3478.0, rel=1e-3)


@pytest.mark.parametrize("kind", ["force", "mass"])
@pytest.mark.parametrize("run", [STILL, SHORT])
def test_every_kind_of_load_and_run_names_them(kind: str, run: dict[str, Any]) -> None:
    result = answer(ROPE, halves(kind=kind), run)
    assert WARNING in result.warnings


def test_on_an_inextensible_line_the_results_are_unreliable() -> None:
    result = answer(RIGID, halves(), SHORT)
    assert result.outcome == "doubtful"
    assert WARNING in result.doubts


@pytest.mark.parametrize(
    ("line", "loads", "run"),
    [
        (ROPE, halves(gap=1.5), SHORT),  # more than a link
        (ROPE, halves(size=1.0), SHORT),  # the line hardly turns there
        ({**ROPE, "bending_stiffness": 1e5, "length": 19.5}, halves(), SHORT),  # bending bears it, without a kink
        ({**ROPE, "bending_stiffness": 0.0}, halves(), STILL),  # a node at each load
        ({**ROPE, "bending_stiffness": 0.0, "supports": {"p": {"kind": "fixed", "at": 15, "position": [14.6, -1]}}},
         halves(), STILL),
    ],
)  # fmt: skip
def test_contacts_that_are_right_are_not_named(
    line: dict[str, Any], loads: dict[str, Any], run: dict[str, Any]
) -> None:
    assert WARNING not in str(answer(line, loads, run).warnings)


def test_more_elements_end_the_warning() -> None:
    loads = halves(gap=0.6)
    text = next(text for text in str(answer(ROPE, loads, SHORT).warnings).splitlines() if WARNING in text)
    assert "write lines.r.elements: 34 or more" in text
    assert WARNING not in answer({**ROPE, "elements": 34}, loads, SHORT).warnings


@pytest.mark.parametrize(
    ("kind", "close", "remedy"),
    [("force", WARNING, "write lines.r.elements: 50 or more"),
     ("mass", "within one link", "raise lines.r.elements (now 20) to 50")],
)  # fmt: skip
def test_what_begins_at_nearly_one_place_of_a_rope_is_to_be_one_load(kind: str, close: str, remedy: str) -> None:
    rope, begin = {**ROPE, "bending_stiffness": 0.0}, {"kind": "dynamic", "until": 0.01, "every": 0.01}
    found = answer(rope, halves(kind=kind), begin)
    text = next(text for text in str(found.warnings).splitlines() if close in text)
    assert text.endswith("write one load with the sum of both")
    assert close not in answer(rope, {"a": pressed(7.3, 800.0, kind)}, begin).warnings
    assert remedy in answer(rope, halves(gap=0.4, kind=kind), begin).warnings
