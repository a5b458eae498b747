"""What is loaded equals what was meant, and what is written loads again."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ropewalk.errors import ScenarioError
from ropewalk.model import (
    Dynamic,
    Equilibrium,
    ForceTable,
    Hooke,
    Line,
    MovingForce,
    Polynomial,
    Quasistatic,
    Scenario,
    SpeedTable,
    Start,
    Tabulated,
    TensionOnly,
    Travel,
)
from ropewalk.scenario import dump, load, loads, save, template


def test_the_contract_example_means_what_it_says() -> None:
    path = Path(__file__).parents[2] / "examples" / "moving-force.yaml"
    assert load(path) == Scenario(
        title="Moving force on a slack rope",
        gravity=9.81,
        lines={
            "rope": Line(
                start=(0.0, 0.0),
                end=(19.5, 0.0),
                length=20.0,
                mass=1.0,
                axial_stiffness=100e3,
                law=Hooke(),
                axial_damping=50.0,
                elements=100,
            )
        },
        loads={
            "walker": MovingForce(on="rope", force=(0.0, -800.0), travel=Travel(speed=10.0, measured="slip", start=0.0))
        },
        run=Dynamic(until=1.5, every=0.01),
    )


def test_an_anchor_is_a_value_written_twice() -> None:
    text = """
lines:
  a: &a {start: [0, 0], end: [1, 0], tension: 1 kN, mass: 1, axial_stiffness: 1e5}
  b: {<<: *a, mass: 2 kg/m}
"""
    lines = loads(text).lines
    assert lines["b"] == lines["a"].model_copy(update={"mass": 2.0})


def test_a_mistake_behind_a_merge_has_the_line_of_the_anchor() -> None:
    text = """lines:
  a: &a {start: [0, 0], end: [1, 0], tension: 1 kN,
    mass: 1 m, axial_stiffness: 1e5}
  b:
    <<: *a
"""
    with pytest.raises(ScenarioError) as caught:
        loads(text, "f")
    assert [(p.line, p.key) for p in caught.value.problems] == [(3, "lines.a.mass"), (3, "lines.b.mass")]


numbers = st.floats(1e-3, 1e3)
signed = st.floats(-1e9, 1e9)
times = st.lists(st.floats(0, 10), min_size=1, max_size=4).map(lambda t: tuple(sorted(t)))
vectors = st.tuples(signed, signed) | st.tuples(signed, signed, signed)
laws = st.sampled_from([Hooke(), TensionOnly()])
titles = st.text(st.characters(codec="utf-8"), max_size=20)
names = st.from_regex(r"[a-z0-9 _-]*[a-z0-9_-]", fullmatch=True).map(str.strip).filter(bool) | st.sampled_from(
    ["on", "null", "true", "1", "1e5", "ü", "<<", "a: b", "#", "'", '"', "-", "~"]
)


@st.composite
def tables(draw: st.DrawFn) -> ForceTable:
    time = draw(times)
    size = draw(st.sampled_from([2, 3]))
    return ForceTable(time=time, value=tuple((draw(signed),) * size for _ in time))  # type: ignore[arg-type]


@st.composite
def scenarios(draw: st.DrawFn) -> Scenario:
    law = draw(laws | st.just(Polynomial(coefficients=(1e5, 1.0))) | st.just(Tabulated(strain=(0, 1), tension=(0, 5))))
    stiffness = draw(numbers) if isinstance(law, Hooke | TensionOnly) else None
    line = Line(
        start=(0.0, draw(numbers)),
        end=(draw(st.floats(10, 1e3)), 0.0, draw(signed)),
        tension=draw(numbers),
        mass=draw(numbers),
        axial_stiffness=stiffness,
        law=law,
        elements=draw(st.integers(1, 1000)),
    )
    name = draw(names)
    speed = draw(times.map(lambda t: SpeedTable(time=t, value=tuple(1.0 for _ in t))) | st.just(2.5))
    travel = Travel(speed=speed, measured=draw(st.sampled_from(["slip", "arc", "material"])), at_end="leave")
    load = MovingForce(on=name, force=draw(vectors | tables()), travel=travel)
    start = draw(st.sampled_from([Start(), Start(with_loads=True), Start(kind="result", file="a b.nc", time=0.5)]))
    until = draw(numbers)
    dynamic = Dynamic(until=until, every=until / 7, start=start)
    run = draw(st.sampled_from([dynamic, Quasistatic(positions=5), Equilibrium()]))
    return Scenario(title=draw(titles), lines={name: line}, loads={draw(names): load}, run=run)


@settings(max_examples=60, deadline=None)
@given(scenarios())
def test_what_is_written_loads_again_exactly(scenario: Scenario) -> None:
    assert loads(dump(scenario)) == scenario


def test_a_file_that_is_saved_loads_again(tmp_path: Path, example: str) -> None:
    scenario = loads(example.replace("Moving", "Ünbewegt"))
    save(scenario, tmp_path / "a.yaml")
    assert load(tmp_path / "a.yaml") == scenario


def test_a_callable_cannot_be_written(example: str) -> None:
    scenario = loads(example)
    load = MovingForce(
        on="rope", force=lambda t: (0.0, -t), travel=Travel(speed=lambda t: math.sin(t), measured="slip")
    )
    with pytest.raises(ScenarioError) as caught:
        dump(scenario.model_copy(update={"loads": {"walker": load}}))
    assert [problem.key for problem in caught.value.problems] == ["loads.walker.force", "loads.walker.travel.speed"]


@pytest.mark.parametrize("name", ["my-rope", "a: b # c", 'q"uote', "", "line\nbreak", "null", "{x", "ünicode"])
def test_the_template_loads_whatever_its_name(name: str) -> None:
    text = template(name)
    assert loads(text).title == (" ".join(name.split()) or "untitled")
    assert text.count("#") > 10


def test_the_python_api_reads_units_and_arrays() -> None:
    line = Line(start=np.zeros(2), end=["19.5 m", 0], length="20 m", mass="1 kg/m", axial_stiffness="1e5")  # type: ignore[arg-type]
    assert (line.start, line.end, line.length) == ((0.0, 0.0), (19.5, 0.0), 20.0)


def test_the_python_api_finds_what_does_not_fit_together(example: str) -> None:
    scenario = loads(example)
    with pytest.raises(ScenarioError) as caught:
        Scenario(lines=scenario.lines, loads=scenario.loads, run=Dynamic(until=1, every=2), gravity=0)
    assert [problem.key for problem in caught.value.problems] == ["lines.rope.length", "run.every"]
    assert "at most 1 s" in str(caught.value)
