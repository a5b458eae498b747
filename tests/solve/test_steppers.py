"""Loads that are Python objects: as good as given forces, what they see of the line, and what goes wrong with them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from motion_cases import order
from ropewalk.errors import RopewalkError
from ropewalk.model import Dynamic, Line, MovingForce, Scenario, Stepper, Travel
from ropewalk.simulate import simulate

PAGE = Path(__file__).parents[2] / "docs" / "steppers.md"
Answer = list[tuple[Any, ...]]


def run(load: Any, until: float = 1.0, **line: Any) -> xr.Dataset:
    """A damped rope of 20 m, 1 kg/m and EA = 100 kN, with 40 links."""
    shape = {"start": (0, 0), "end": (20, 0), "length": 19.9, "mass": 1.0, "axial_stiffness": 1e5, **line}
    ropes = {"rope": Line(axial_damping=20.0, elements=40, **shape)}
    return simulate(Scenario(lines=ropes, loads={"load": load}, run=Dynamic(until=until, every=until / 50)))


class Constant:
    """A force of 300 N that travels at 8 m/s; it says so, or is only seen in another place each time it is asked."""

    def __init__(self, *, says_speed: bool = True, speed: float = 8.0) -> None:
        self.says_speed, self.speed = says_speed, speed

    def step(self, t: float, h: float, line: Any) -> Answer:
        force = (0.0, -300.0)
        return [(2.0 + self.speed * t, force, self.speed) if self.says_speed else (2.0 + self.speed * t, force)]


def given(speed: float) -> xr.Dataset:
    travel = Travel.model_validate({"speed": speed, "from": 2.0})
    return run(MovingForce(on="rope", force=(0.0, -300.0), travel=travel))


def off(found: xr.Dataset, reference: xr.Dataset) -> float:
    return float(np.abs(found.contact_position.values - reference.contact_position.values).max())


def test_a_stepper_that_says_its_speed_is_the_given_force() -> None:
    reference, sizes = given(8.0), [0.08, 0.04, 0.02]
    found = [off(run(Stepper(on="rope", model=Constant(), every=every)), reference) for every in sizes]
    print(found)
    assert max(found) < 1e-3  # m of 2 m


def test_a_stepper_without_speed_comes_near_the_given_force_with_its_interval() -> None:
    reference, sizes = given(8.0), [0.02, 0.01, 0.005]
    found = [off(run(Stepper(on="rope", model=Constant(says_speed=False), every=every)), reference) for every in sizes]
    assert 0.85 < order(sizes, found) < 1.15


def test_a_stepper_that_stands_is_a_standing_force() -> None:
    found = run(Stepper(on="rope", model=Constant(speed=0.0), every=0.01))
    assert off(found, given(0.0)) < 1e-3


class Comes:
    """None, one and two contacts in turn, each for a tenth of a second; it notes what it sees of the line."""

    contacts = 2

    def __init__(self) -> None:
        self.seen: list[tuple[float, ...]] = []

    def reset(self, line: Any) -> None:
        self.seen = [(line.length,)]

    def step(self, t: float, h: float, line: Any) -> Answer:
        place, velocity = line.at(5.0)
        self.seen.append((t, h, *place, *velocity, line.below(float(place[0]))))
        return [(5.0 + 3.0 * n, (0.0, -100.0)) for n in range(int(t / 0.1 + 1e-9) % 3)]


def test_contacts_come_and_go_and_the_line_is_seen_as_it_is() -> None:
    model = Comes()
    found = run(Stepper(on="rope", model=model, every=0.02))
    assert found["load"].values.tolist() == ["load.1", "load.2"]
    on = ~np.isnan(found.contact_xi.values)
    t = found.time.values
    for start, expected in (
        (0.05, [False, False]),
        (0.15, [True, False]),
        (0.25, [True, True]),
        (0.35, [False, False]),
    ):
        i = int(np.argmin(np.abs(t - start)))
        assert on[i].tolist() == expected
    assert found.contact_xi.values[np.argmin(np.abs(t - 0.25))] == pytest.approx([5.0, 8.0])
    assert model.seen[0] == pytest.approx((19.9,))
    seen = np.array(model.seen[1:])
    assert seen[:, 0] == pytest.approx(0.02 * np.arange(len(seen)))
    assert seen[:, 6] == pytest.approx(5.0, abs=1e-9)  # straight below itself
    height = [np.interp(5.0, found.xi.values, found.position.values[i, :, 1]) for i in range(len(t))]
    assert seen[: len(t), 3] == pytest.approx(height, abs=0.01)  # output has nodes, she sees the riding one as well
    assert np.abs(seen[:, 5]).max() > 0.2
    assert np.abs(found.energy.sel(form="imbalance").values).max() < 1.0  # J of 80 J


class Fails:
    def __init__(self, answer: Any) -> None:
        self.answer = answer

    def step(self, t: float, h: float, line: Any) -> Any:
        if t < 0.495:
            return [(5.0, (0.0, -100.0))]
        return self.answer / 0 if isinstance(self.answer, int) else self.answer


@pytest.mark.parametrize(
    ("answer", "advice"),
    [
        (1, "ZeroDivisionError"),
        (None, "expected a list"),
        ([7], "each contact is"),
        ([("a", (0.0, 1.0))], "each contact is"),
        ([(5.0, (0.0, float("nan")))], "finite numbers"),
        ([(5.0, (0.0, 1.0, 2.0))], "2 components"),
        ([(1.0, (0.0, 1.0)), (2.0, (0.0, 1.0))], "2 contacts"),
    ],
)
def test_a_model_that_fails_ends_the_run_with_what_there_is(answer: Any, advice: str) -> None:
    found = run(Stepper(on="rope", model=Fails(answer), every=0.01))
    assert found.attrs["outcome"] == "load failed"
    assert advice in found.attrs["advice"]
    assert "t = 0.5 s" in found.attrs["advice"]
    assert found.time.values[-1] == pytest.approx(0.5)
    assert np.isfinite(found.position.values).all()


@pytest.mark.parametrize(
    ("at_end", "outcome"), [("leave", "completed"), ("stay", "completed"), ("refuse", "travel ended")]
)
def test_beyond_the_end_a_contact_leaves_stays_or_is_refused(at_end: str, outcome: str) -> None:
    found = run(Stepper(on="rope", model=Fails([(25.0, (0.0, -100.0))]), every=0.01, at_end=at_end))
    assert found.attrs["outcome"] == outcome
    xi = found.contact_xi.values[-1, 0]
    assert np.isnan(xi) if at_end == "leave" else xi == pytest.approx(19.9 if at_end == "stay" else 5.0)


SOURCE = """
class Two:
    contacts = 2
    def __init__(self, force=1.0):
        self.force = force
    def step(self, t, h, line):
        return [(5.0, (0.0, -self.force)), (9.0, (0.0, -self.force))]

class Broken:
    def __init__(self):
        raise ValueError("no such person")

number = 7
"""


@pytest.mark.parametrize("form", ["file", "module"])
def test_a_model_is_made_from_text_with_options(form: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "two_feet.py").write_text(SOURCE)
    monkeypatch.syspath_prepend(tmp_path)
    place = f"{tmp_path / 'two_feet.py'}:Two" if form == "file" else "two_feet:Two"
    found = run(Stepper(on="rope", model=place, every=0.01, options={"force": 50.0}), until=0.1)
    assert found.attrs["outcome"] == "completed"
    assert found.contact_force.values[-1, :, 1] == pytest.approx([-50.0, -50.0])


@pytest.mark.parametrize(
    ("name", "wrong"), [("Nobody", "cannot be found"), ("Broken", "no such person"), ("number", "no method step")]
)
def test_a_model_that_cannot_be_made_is_refused(name: str, wrong: str, tmp_path: Path) -> None:
    (tmp_path / "people.py").write_text(SOURCE)
    with pytest.raises(RopewalkError, match=wrong):
        run(Stepper(on="rope", model=f"{tmp_path / 'people.py'}:{name}"), until=0.1)


def test_the_walker_of_the_page_walks(capsys: pytest.CaptureFixture[str]) -> None:
    code = re.search(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert code is not None
    names: dict[str, Any] = {}
    exec(code[1], names)
    result, walker = names["result"], names["walk"].model
    assert result.attrs["outcome"] == "completed"
    assert -3.0 < float(capsys.readouterr().out.split()[0]) < -1.0  # m
    assert max(walker.feet) > 7.0  # m: from 4.5 m, half a metre every 0.7 s if she need not wait
    last = -result.contact_force.values[-40:, :, 1].sum(axis=1)
    assert last.mean() == pytest.approx(60.0 * 9.81, rel=0.05)
    lines = code[1].split("\n\n\n")[1].strip().splitlines()
    assert len(lines) <= 30
