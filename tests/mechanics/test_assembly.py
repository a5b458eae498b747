"""From a scenario to arrays: strands, laws, tables of speeds and forces, and the integrals of speeds."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from ropewalk.mechanics import law
from ropewalk.mechanics.assembly import axes_of, components, loads_of, strands_of, tabulate
from ropewalk.mechanics.chain import (
    ARC,
    CLAMPED,
    FRICTIONLESS,
    HORIZONTAL,
    LEAVE,
    MATERIAL,
    REFUSE,
    SLIP,
    STAY,
    Loads,
)
from ropewalk.mechanics.contact_points import wheels_of
from ropewalk.mechanics.moving_contact import force_at, look_up_integral, speed_at
from ropewalk.model import (
    Equilibrium,
    ForceTable,
    Line,
    MovingForce,
    Polynomial,
    Scenario,
    SpeedTable,
    Tabulated,
    TensionOnly,
    Travel,
)

ROPE = Line(start=(0.0, 0.0), end=(20.0, 0.0), length=22.0, mass=2.0, axial_stiffness=1e5, elements=4)


def scenario(lines: dict[str, Line] | None = None, **loads: MovingForce) -> Scenario:
    return Scenario(lines=lines or {"rope": ROPE}, loads=loads, run=Equilibrium())


def load(on: str = "rope", force: object = (0.0, -700.0), contact: str = "clamped", **travel: object) -> MovingForce:
    return MovingForce(on=on, force=force, contact=contact, travel=Travel(**{"speed": 1.0, **travel}))


def way(loads: Loads, k: int, t: float) -> float:
    first, count = loads.speed_first[k], loads.speed_count[k]
    return float(look_up_integral(loads.speed_time, loads.speed_value, loads.speed_path, first, count, t))


def loads_in(scene, until):
    return loads_of(scene, wheels_of(scene), until)


def test_lines_become_strands_one_after_the_other() -> None:
    table = Tabulated(strain=(0.0, 0.1, 0.2), tension=(0.0, 10.0, 40.0))
    lines = {
        "rope": ROPE,
        "wire": Line(start=(0, 5), end=(9, 5), length=9.0, mass=0.5, law=table, elements=3, axial_damping=7.0),
        "web": Line(start=(0, 9), end=(9, 9), length=8.0, mass=0.1, axial_stiffness=3e3, law=TensionOnly(),
                    elements=1, drag=0.2),
    }  # fmt: skip
    strands = strands_of(scenario(lines), {"rope": 22.0, "wire": 9.0, "web": 8.0})
    assert strands.first.tolist() == [0, 5, 9]
    assert strands.links.tolist() == [4, 3, 1]
    assert strands.h.tolist() == [5.5, 3.0, 8.0]
    assert strands.rho.tolist() == [2.0, 0.5, 0.1]
    assert strands.damping.tolist() == [0.0, 7.0, 0.0]
    assert strands.drag.tolist() == [0.0, 0.0, 0.2]
    assert strands.gravity.tolist() == [0.0, -9.81]
    tensions = [law.tension(strands.law[s], eps) for s, eps in ((0, -0.01), (1, 0.15), (2, -0.01), (2, 0.01))]
    assert tensions == pytest.approx([-1e3, 25.0, 0.0, 30.0], rel=1e-14)


@pytest.mark.parametrize("count", range(1, 9))
def test_polynomials_of_every_length_are_packed_whole(count: int) -> None:
    coefficients = tuple(1e3 * (i + 1.0) for i in range(count))
    line = ROPE.model_copy(update={"law": Polynomial(coefficients=coefficients), "axial_stiffness": None})
    p = strands_of(scenario({"rope": line}), {"rope": 22.0}).law[0]
    expected = sum(c * 0.3 ** (i + 1) for i, c in enumerate(coefficients))
    assert law.tension(p, 0.3) == pytest.approx(expected, rel=1e-14)


def test_a_force_or_an_end_aside_opens_the_third_axis() -> None:
    assert axes_of(scenario(a=load())) == ("x", "z")
    assert axes_of(scenario(a=load(force=(0.0, 0.0, -700.0)))) == ("x", "z")
    assert axes_of(scenario(a=load(force=(0.0, 1.0, -700.0)))) == ("x", "y", "z")
    assert axes_of(scenario(a=load(force=ForceTable(time=(0, 1), value=((0, 0, 1), (0, 2, 1)))))) == ("x", "y", "z")
    aside = ROPE.model_copy(update={"end": (20.0, 1.0, 0.0)})
    assert axes_of(scenario({"rope": aside})) == ("x", "y", "z")
    assert components((1.0, 2.0), ("x", "y", "z")).tolist() == [1.0, 0.0, 2.0]
    assert components((1.0, 0.0, 2.0), ("x", "z")).tolist() == [1.0, 2.0]


def test_loads_keep_their_line_measure_contact_and_end() -> None:
    lines = {"rope": ROPE, "wire": ROPE.model_copy(update={"start": (0.0, 5.0), "end": (20.0, 5.0)})}
    loads = loads_in(
        scenario(
            lines,
            a=load("wire", measured="slip", at_end="stay"),
            b=load("rope", measured="arc", at_end="leave", contact="frictionless"),
            c=load("rope", measured="horizontal", start=3.0),
            d=load("wire", measured="material", start=9.0),
        ),
        1.0,
    )
    assert loads.strand.tolist() == [1, 0, 0, 1]
    assert loads.measure.tolist() == [SLIP, ARC, HORIZONTAL, MATERIAL]
    assert loads.at_end.tolist() == [STAY, LEAVE, REFUSE, REFUSE]
    assert loads.contact.tolist() == [CLAMPED, FRICTIONLESS, CLAMPED, CLAMPED]


def test_every_load_finds_its_own_part_of_the_tables() -> None:
    loads = loads_in(
        scenario(
            a=load(speed=3.0),
            b=load(speed=SpeedTable(time=(1, 2, 4), value=(0, 1, 5)), start=4.0, force=(1.0, -2.0)),
            c=load(
                speed=lambda t: 2.0 + t, start=8.0, force=ForceTable(time=(1.0, 3.0), value=((0.0, -1.0), (4.0, -5.0)))
            ),
        ),
        2.0,
    )
    for t, speeds in ((0.0, (3.0, 0.0, 2.0)), (1.5, (3.0, 0.5, 3.5)), (2.0, (3.0, 1.0, 4.0)), (9.0, (3.0, 5.0, 4.0))):
        assert [speed_at(loads, k, t) for k in range(3)] == pytest.approx(speeds, abs=1e-14)
    for t, forces in ((0.0, (0.0, -1.0)), (2.0, (2.0, -3.0)), (5.0, (4.0, -5.0))):
        assert [force_at(loads, 2, t, a) for a in range(2)] == pytest.approx(forces, abs=1e-14)
    assert [force_at(loads, 1, 7.0, a) for a in range(2)] == [1.0, -2.0]
    assert way(loads, 0, 2.5) == 7.5


@pytest.mark.parametrize("shift", [0.0, 1.5, -0.7, -2.0, -5.0, -9.0])
def test_integrals_of_speed_tables_count_from_zero_wherever_the_table_begins(shift: float) -> None:
    times = tuple(t + shift for t in (0.0, 1.0, 2.0, 2.0, 5.0))
    table = SpeedTable(time=times, value=(1.0, 3.0, -1.0, 4.0, 0.5))
    loads = loads_in(scenario(a=load(), b=load(speed=table, start=1.0)), 9.0)
    for t in (0.0, 0.3, 1.5, 2.0, 3.1, 6.0, 9.0):
        knots = [k for k in times if 0.0 < k < t]
        expected = quad(lambda x: speed_at(loads, 1, x), 0.0, t, points=knots or None, epsabs=1e-12)[0]
        assert way(loads, 1, t) == pytest.approx(expected, abs=1e-11)  # quadrature


@settings(deadline=None, max_examples=100)
@given(
    st.lists(st.tuples(st.integers(-500, 500), st.floats(-9.0, 9.0)), min_size=1, max_size=6, unique_by=lambda x: x[0]),
    st.floats(0.0, 8.0),
)
def test_the_integral_of_any_speed_table_grows_at_its_speed(entries: list[tuple[float, float]], t: float) -> None:
    entries = sorted((hundredths / 100.0, speed) for hundredths, speed in entries)
    table = SpeedTable(time=tuple(x for x, _ in entries), value=tuple(v for _, v in entries))
    loads = loads_in(scenario(a=load(speed=table)), 9.0)
    assert way(loads, 0, 0.0) == pytest.approx(0.0, abs=1e-13)  # roundings
    grid = np.unique([0.0, t, *(x for x, _ in entries if 0.0 < x < t)])
    speeds = np.array([speed_at(loads, 0, x) for x in grid])
    assert way(loads, 0, t) == pytest.approx(float(np.trapezoid(speeds, grid)), abs=1e-12)


@pytest.mark.parametrize(
    ("function", "corner"),
    [
        (lambda t: 3.0 + math.sin(7.0 * t), False),
        (lambda t: math.exp(-3.0 * t), False),
        (lambda t: max(t - 0.777, 0.0), True),
        (lambda t: 0.0, False),
        (lambda t: 1e-9 * t * t, False),
    ],
)
def test_callables_are_tabulated_within_the_tolerance(function: Callable[[float], float], corner: bool) -> None:
    times, values = tabulate(function, 4.0)
    fine = np.linspace(0.0, 4.0, 40001)
    exact = np.array([function(t) for t in fine])
    miss = np.abs(np.interp(fine, times, values) - exact).max()
    # the middle of an interval is tested: 4/3 of that for a parabola is not exceeded, a corner may stand beside it
    assert miss <= (4.0 if corner else 4.0 / 3.0) * 1e-6 * np.abs(exact).max()
    assert times[0] == 0.0
    assert times[-1] == 4.0
    assert np.all(np.diff(times) > 0.0)


def test_a_jump_in_a_callable_is_found_to_the_smallest_interval() -> None:
    times, values = tabulate(lambda t: 0.0 if t < 1.2345 else 5.0, 4.0)
    # 256 intervals halved 14 or 15 times; everything else is exact
    assert np.interp(1.2345 - 2e-6, times, values) == 0.0
    assert np.interp(1.2345 + 2e-6, times, values) == 5.0


def test_callable_forces_are_tabulated_component_by_component() -> None:
    loads = loads_in(scenario(a=load(force=lambda t: (math.cos(t), -700.0 + 90.0 * math.sin(5.0 * t)))), 3.0)
    for t in (0.0, 0.777, 1.9, 3.0):
        expected = (math.cos(t), -700.0 + 90.0 * math.sin(5.0 * t))
        # 1e-6 of the largest component
        assert [force_at(loads, 0, t, a) for a in range(2)] == pytest.approx(expected, abs=1.4e-6 * 790.0)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_callables_that_are_not_finite_are_refused(bad: float) -> None:
    with pytest.raises(ValueError, match="finite"):
        loads_in(scenario(a=load(speed=lambda t: bad if t > 1.0 else 1.0)), 2.0)
    with pytest.raises(ValueError, match="finite"):
        loads_in(scenario(a=load(force=lambda t: (0.0, bad))), 2.0)


def test_a_scenario_without_loads_has_empty_tables() -> None:
    loads = loads_in(scenario(), 1.0)
    assert loads.strand.size == loads.speed_time.size == loads.force_time.size == 0
    assert loads.force_value.shape == (2, 0)
