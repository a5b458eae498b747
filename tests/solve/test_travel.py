"""Loads travel as they are told: measures of speed, ends of the line, several loads, tables, callables, space."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from motion_cases import slack_rope
from ropewalk.model import Dynamic, ForceTable, Line, MovingForce, Scenario, SpeedTable, Start, Travel
from ropewalk.simulate import simulate

WENT_THROUGH = (
    "completed",
    "doubtful",
)  # links of 1 m are coarse for a force set down in mid-span: 5 to 9 % of the energy


def taut(loads: dict[str, MovingForce], elements: int = 40, **run: Any) -> Scenario:
    """A taut rope of 20 m, 1 kg/m and EA = 50 kN, stretched by 2 %."""
    line = Line(start=(0, 0), end=(20.4, 0), length=20.0, mass=1.0, axial_stiffness=5e4, elements=elements)
    return Scenario(lines={"rope": line}, loads=loads, run=Dynamic(**{"until": 0.8, "every": 0.02, **run}))


def load(speed: Any = 10.0, force: Any = (0.0, -300.0), contact: str = "clamped", **travel: Any) -> MovingForce:
    return MovingForce(
        on="rope", force=force, contact=contact, travel=Travel.model_validate({"speed": speed, **travel})
    )


def test_material_travel_is_exact() -> None:
    result = simulate(taut({"a": load(10.0, **{"from": 3.0})}))
    np.testing.assert_allclose(result.contact_xi[:, 0], 3.0 + 10.0 * result.time, rtol=1e-12)


@pytest.mark.parametrize(("measured", "tolerance"), [("slip", 2e-3), ("arc", 1e-2), ("horizontal", 2e-3)])
def test_path_comes_out_as_measured(measured: str, tolerance: float) -> None:
    """The tolerances are a step of travel and half a link at the start; a wrong measure is 0.17 m off."""
    result = simulate(taut({"a": load(10.0, measured=measured)}, elements=100, every=0.002, step=2e-4))
    xi, place = result.contact_xi.values[:, 0], result.contact_position.values[:, 0]
    if measured == "horizontal":
        path = place[:, 0]
    elif measured == "slip":
        lam = 1.0 + result.contact_tension.values[:, 0].mean(axis=1) / 5e4
        path = np.concatenate(([0.0], np.cumsum(0.5 * (lam[1:] + lam[:-1]) * np.diff(xi))))
    else:
        nodes, path = result.position.values, []
        for frame, here, point in zip(nodes, xi, place, strict=True):
            passed = result.xi.values < here - 1e-9
            chain = np.vstack([frame[passed], point])
            path.append(np.sqrt((np.diff(chain, axis=0) ** 2).sum(axis=1)).sum())
        path = np.array(path)
    np.testing.assert_allclose(path, 10.0 * result.time, atol=tolerance)


def test_mirrored_travel_gives_the_mirrored_answer() -> None:
    forth = simulate(taut({"a": load(12.0, **{"from": 2.0})}))
    back = simulate(taut({"a": load(-12.0, **{"from": 18.0})}))
    mirrored = back.position.values[:, ::-1] * [-1.0, 1.0] + [20.4, 0.0]
    np.testing.assert_allclose(forth.position.values, mirrored, atol=1e-9)


def test_speed_table_with_a_turn_comes_back() -> None:
    table = SpeedTable(time=(0.0, 0.5, 0.5, 1.0), value=(8.0, 8.0, -8.0, -8.0))
    result = simulate(taut({"a": load(table, **{"from": 5.0})}, until=1.0))
    assert result.contact_xi.values[:, 0].max() == pytest.approx(9.0, abs=1e-9)
    assert result.contact_xi.values[-1, 0] == pytest.approx(5.0, abs=1e-9)
    assert result.attrs["outcome"] in WENT_THROUGH


def test_callables_and_tables_that_say_the_same_agree() -> None:
    def force(t: float) -> tuple[float, float]:
        return (0.0, -300.0 * np.sin(4.0 * t))

    times = np.linspace(0.0, 0.8, 4001)
    table = ForceTable(time=tuple(times), value=tuple(force(t) for t in times))
    called, tabled = (simulate(taut({"a": load(10.0, force=f)})) for f in (force, table))
    # Both interpolate the sine linearly, to 1e-6 of its value.
    np.testing.assert_allclose(called.position, tabled.position, atol=1e-6)


def test_a_load_that_leaves_lets_the_rope_swing_freely() -> None:
    result = simulate(taut({"a": load(50.0, at_end="leave")}, until=1.0))
    gone = result.time.values > 0.4 + 1e-9
    assert np.isnan(result.contact_xi.values[gone]).all()
    assert np.isfinite(result.contact_xi.values[~gone][:-1]).all()
    assert np.ptp(result.energy.sel(form="load_work").values[gone]) < 1e-12 * 300


def test_a_load_that_stays_ends_at_the_support_and_loads_it() -> None:
    result = simulate(taut({"a": load(50.0, at_end="stay")}, until=1.0))
    assert result.contact_xi.values[-1, 0] == pytest.approx(20.0)
    assert np.isfinite(result.contact_force.values).all()


@pytest.mark.parametrize("speed", [10.0, -10.0])
def test_the_line_ends_for_a_force_at_its_margin(speed: float) -> None:
    begin, end = (15.0, 16.8) if speed > 0.0 else (5.0, 3.2)
    place = {"from": begin, "margin": 3.2}
    leaves = simulate(taut({"a": load(speed, at_end="leave", **place)}, until=0.3))
    np.testing.assert_array_equal(np.isnan(leaves.contact_xi[:, 0]), leaves.time > 0.18 + 1e-9)
    stays = simulate(taut({"a": load(speed, at_end="stay", **place)}, until=0.3))
    # A load has arrived when it is a millionth of a link away.
    np.testing.assert_allclose(stays.contact_xi[-5:, 0], end, rtol=0.0, atol=1e-6)


def test_a_load_that_may_not_leave_ends_the_run_with_what_there_is() -> None:
    result = simulate(taut({"a": load(60.0, measured="slip")}, until=1.0))
    assert result.attrs["outcome"] == "travel ended"
    assert "at_end" in result.attrs["advice"]
    assert 0.3 < result.time.values[-1] < 0.36


def test_two_loads_of_half_the_force_at_one_place_nearly_make_one() -> None:
    one = simulate(taut({"a": load(10.0, **{"from": 1.0})}, elements=80))
    halves = {"a": load(force=(0.0, -150.0), **{"from": 1.0}), "b": load(force=(0.0, -150.0), **{"from": 1.02})}
    two = simulate(taut(halves, elements=80))
    # Each bends its link by itself: a difference of a tenth of a link of 25 cm, of which the run warns.
    assert "contacts a and b are 0.02 m apart" in two.attrs["warnings"]
    assert np.abs(one.position.values - two.position.values).max() < 0.03


def test_the_audit_closes_with_two_loads_a_little_more_than_a_link_apart() -> None:
    result = simulate(taut({"a": load(10.0, **{"from": 4.0}), "b": load(10.0, **{"from": 4.6})}, elements=40))
    turnover = np.abs(result.energy.sel(form="load_work").values).max()
    # 3.7 % at 40 links, 2.5 % at 80: both ride most of the time, and the kinks between them are 0.6 m apart.
    assert np.abs(result.energy.sel(form="imbalance").values).max() < 0.05 * turnover


def test_two_loads_on_one_link_both_count() -> None:
    near = {"a": load(10.0, **{"from": 4.0}), "b": load(10.0, **{"from": 4.2})}
    result = simulate(taut(near, elements=20))
    both = simulate(taut({"a": load(10.0, force=(0.0, -600.0), **{"from": 4.1})}, elements=20))
    assert result.attrs["outcome"] in WENT_THROUGH
    # One of twice the force half-way between them, on links of 1 m: alike to a part of a link.
    assert np.abs(result.position.values[:, :, 1].min(axis=1) - both.position.values[:, :, 1].min(axis=1)).max() < 0.12


@settings(max_examples=8, deadline=None)
@given(scale=st.floats(0.2, 5.0), speed=st.floats(2.0, 18.0))
def test_small_motions_are_linear_in_the_forces(scale: float, speed: float) -> None:
    def deflection(*loads: MovingForce) -> np.ndarray:
        scenario = taut(dict(zip("ab", loads, strict=False)), elements=30, until=0.3, every=0.1)
        result = simulate(scenario.model_copy(update={"gravity": 0.0}))
        return result.position.values[-1, :, 1] - result.position.values[0, :, 1]

    a, b = (
        load(speed, force=(0.0, -1e-5), **{"from": 12.0}),
        load(-speed, force=(0.0, -1e-5 * scale), **{"from": 5.7}),
    )
    alone, both = deflection(a), deflection(a, b)
    largest = np.abs(both).max()
    # 1e-5 N on 1000 N is linear to rounding in 20 m (1e-14 m on 1e-7 m). Scaling the force scales the answer.
    scaled = deflection(load(speed, force=(0.0, -1e-5 * scale), **{"from": 12.0}))
    np.testing.assert_allclose(scaled, scale * alone, atol=1e-6 * largest + 1e-13)
    # Forces superpose up to what the seat of one load does to the waves of the other: measured 0.7 % at 30 links.
    np.testing.assert_allclose(both, alone + deflection(b), atol=0.02 * largest)


def in_space(scenario: Scenario) -> Scenario:
    """The same scenario with a third axis: the force gets a sideways component of zero, the run a third coordinate."""
    line = scenario.lines["rope"]
    tilted = line.model_copy(update={"start": (0.0, 1.0, 0.0), "end": (line.end[0], 1.0, 0.0)})
    return scenario.model_copy(update={"lines": {"rope": tilted}})


@pytest.mark.parametrize("damping", [0.0, 50.0])
def test_plane_and_space_agree_without_sideways_forces(damping: float) -> None:
    plane = taut({"a": load(10.0)})
    plane = plane.model_copy(
        update={"lines": {"rope": plane.lines["rope"].model_copy(update={"axial_damping": damping})}}
    )
    flat, space = simulate(plane), simulate(in_space(plane))
    assert list(space.axis.values) == ["x", "y", "z"]
    np.testing.assert_allclose(space.position.values[:, :, [0, 2]], flat.position.values, atol=1e-9)
    np.testing.assert_allclose(space.position.values[:, :, 1], 1.0, atol=1e-12)


def test_several_lines_move_as_if_alone() -> None:
    alone = taut({"a": load(10.0)})
    line = alone.lines["rope"]
    other = line.model_copy(update={"start": (0.0, 5.0), "end": (20.4, 5.0), "elements": 25})
    both = alone.model_copy(update={"lines": {"other": other, "rope": line}})
    together = simulate(both)
    mine = together.isel(node=(together.line.values == "rope"))
    np.testing.assert_allclose(mine.position.values, simulate(alone).position.values, atol=1e-10)


def test_a_run_that_breaks_down_keeps_what_it_has() -> None:
    # A step far beyond the stable one is refused by `choose`, so break it with a force without bounds instead.
    def force(t: float) -> tuple[float, float]:
        return (0.0, -1e3 * np.exp(60.0 * t))

    result = simulate(taut({"a": load(10.0, force=force)}, until=0.8))
    assert result.attrs["outcome"] == "diverged"
    assert "tension_only" in result.attrs["advice"]
    assert 2 < result.sizes["time"] < 41
    assert np.isfinite(result.position.values).all()


def test_compression_without_damping_is_pointed_out() -> None:
    result = simulate(slack_rope(100, run={"until": 1.9, "every": 0.01}))
    assert "compression" in result.attrs["warnings"]
    assert "tension_only" in result.attrs["warnings"]


def test_a_stored_state_can_be_taken_up(tmp_path: Any) -> None:
    file = tmp_path / "first.nc"
    free = taut({"a": load(60.0, at_end="leave")}, until=0.5)
    simulate(free, file=file)
    whole = simulate(free.model_copy(update={"run": free.run.model_copy(update={"until": 0.8})}))
    rest = free.model_copy(
        update={"loads": {}, "run": Dynamic(until=0.3, every=0.02, start=Start(kind="result", file=str(file)))}
    )
    np.testing.assert_allclose(simulate(rest).position.values[-1], whole.position.values[-1], atol=1e-6)


def test_loads_at_rest_do_not_move_when_the_run_begins_with_them() -> None:
    standing = {"a": load(0.0, **{"from": 7.0})}
    result = simulate(taut(standing, start=Start(with_loads=True), until=0.5))
    np.testing.assert_allclose(result.position.values[-1], result.position.values[0], atol=1e-8)


def test_instants_that_differ_by_a_rounding_error_are_one() -> None:
    corner = 0.15
    forces = [
        ForceTable(time=(0.0, time, 0.8), value=((0.0, -300.0), (0.0, -100.0), (0.0, -300.0)))
        for time in (corner, np.nextafter(corner, 1.0))
    ]
    loads = {f"{i}": load(10.0, force, **{"from": 3.0 + 5.0 * i}) for i, force in enumerate(forces)}
    result = simulate(taut(loads, method="implicit"))  # which went on asking for a step of nothing
    assert result.outcome in WENT_THROUGH
