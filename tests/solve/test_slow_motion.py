"""Slow motion: every measured path comes out right, frictionless contacts even out, supports and energy balance.

Numbers: ellipse, weightless elastic rope, heavy rope with point loads; closed forms in ropewalk.theory.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.errors import EquilibriumError
from ropewalk.model import ForceTable, Line, MovingForce, Quasistatic, Scenario, SpeedTable, TensionOnly, Travel
from ropewalk.simulate import simulate
from ropewalk.solve.load_schedule import horizon
from ropewalk.solve.quasistatic import LoadPosition, walk
from ropewalk.solve.start import setting_of
from ropewalk.theory.rope import elastic_catenary

LOAD = 700.0
MEASURES = ["material", "slip", "arc", "horizontal"]
every_measure = pytest.mark.parametrize("measured", MEASURES)
every_contact = pytest.mark.parametrize("contact", ["clamped", "frictionless"])


def rope(**changed: Any) -> Line:
    given: dict[str, Any] = {"start": (0.0, 0.0), "end": (20.0, 0.0), "length": 22.0, "mass": 2.0,
                             "axial_stiffness": 1e4, "elements": 22}  # fmt: skip
    return Line(**(given | changed))


def load(force: Any = (0.0, -LOAD), contact: str = "clamped", on: str = "rope", **travel: Any) -> MovingForce:
    return MovingForce(on=on, force=force, contact=contact, travel=Travel(**({"speed": 1.0} | travel)))


def case(line: Line, *loads: MovingForce, gravity: float = 9.81, positions: int = 11) -> Scenario:
    moving = {f"load {k}": one for k, one in enumerate(loads)}
    return Scenario(gravity=gravity, lines={"rope": line}, loads=moving, run=Quasistatic(positions=positions))


def slow(line: Line, *loads: MovingForce, gravity: float = 9.81, positions: int = 11) -> xr.Dataset:
    result = simulate(case(line, *loads, gravity=gravity, positions=positions))
    presses = any(one.force != (0.0, 0.0) for one in loads)
    assert result.attrs["outcome"] == ("completed" if presses else "doubtful"), result.attrs["advice"]
    return result


def places(scenario: Scenario) -> list[LoadPosition]:
    assert isinstance(scenario.run, Quasistatic)
    return list(walk(setting_of(scenario, horizon(scenario)), scenario.run.positions))


def numbers(result: xr.Dataset, name: str) -> np.ndarray:
    return np.asarray(result[name].to_numpy())


def arc_to_contact(result: xr.Dataset, k: int = 0) -> np.ndarray:
    """Length of the line from its start to contact k, through the positions of nodes and contacts alone."""
    h, out = 22.0 / (result.sizes["node"] - 1), []
    for nodes, xi, contacts in zip(
        numbers(result, "position"), numbers(result, "contact_xi"), numbers(result, "contact_position"), strict=True
    ):
        points = [*((i * h, node) for i, node in enumerate(nodes)), *zip(xi, contacts, strict=True)]
        way = [point for place, point in sorted(points, key=lambda p: p[0]) if place < xi[k]]
        out.append(float(np.linalg.norm(np.diff([*way, contacts[k]], axis=0), axis=1).sum()))
    return np.array(out)


# --- the measured path ------------------------------------------------------------------------------------------


@every_contact
@pytest.mark.parametrize("speed", [1.0, -2.5])
def test_a_horizontal_path_moves_the_contact_by_the_path(contact: str, speed: float) -> None:
    result = slow(rope(length=19.0), load(contact=contact, measured="horizontal", start=9.0, speed=speed))
    x, path = numbers(result, "contact_position")[:, 0, 0], numbers(result, "load_path")
    assert x == pytest.approx(x[0] + np.sign(speed) * path, abs=1e-9)
    assert x[-1] == pytest.approx(20.0 if speed > 0 else 0.0, abs=1e-9)
    assert np.diff(path) == pytest.approx(path[-1] / 10.0, rel=1e-12)


@every_contact
@pytest.mark.parametrize("speed", [1.0, -1.0])
def test_an_arc_path_is_the_change_of_the_length_behind_the_contact(contact: str, speed: float) -> None:
    scenario = case(rope(elements=10), load(contact=contact, measured="arc", start=11.0, speed=speed), positions=9)
    result = simulate(scenario)  # a frictionless load cannot be held beside the support: frames up to there
    assert result.sizes["load_path"] >= 6
    arc, path = arc_to_contact(result), numbers(result, "load_path")
    assert arc == pytest.approx(arc[0] + speed * path, abs=1e-9)


@every_contact
def test_a_slip_path_is_the_sum_of_mean_stretches(contact: str) -> None:
    found = places(case(rope(length=18.5), load(contact=contact, measured="slip", start=2.0), positions=401))
    stretch = []
    for place in found:
        stand = place.stands[0]
        eps = stand.strain
        i = int(stand.contact[0])
        stretch.append(1.0 + 0.5 * (eps[max(i - 1, 0)] + eps[min(i, eps.size - 1)]))
    lam, xi = np.array(stretch), np.array([place.xi[0] for place in found])
    path = np.cumsum(0.5 * (lam[1:] + lam[:-1]) * np.diff(xi))
    # the last position may stop at the end of the line; where that is, a walk of 101 positions has told before;
    # the step is chosen for errors of 1e-6 of the path, as is the trapezoidal sum here
    assert path[:-1] == pytest.approx([place.path for place in found[1:-1]], abs=4e-5)
    assert found[-1].xi[0] == pytest.approx(18.5, abs=5e-3)


def test_the_slip_path_does_not_depend_on_the_number_of_positions() -> None:
    def middle(positions: int) -> float:
        found = places(case(rope(length=19.0, elements=3), load(measured="slip", start=2.0), positions=positions))
        return float(found[(positions - 1) // 2].xi[0])

    finest = middle(1025)
    # steps in between keep the error of the path below 1e-6 of it; steps of the positions alone would miss by 1e-3
    assert [middle(n) for n in (3, 9, 33, 129)] == pytest.approx([finest] * 4, abs=2e-5)


def test_a_material_path_moves_the_load_by_equal_steps_of_the_line() -> None:
    result = slow(rope(), load(start=2.0))
    assert numbers(result, "contact_xi")[:, 0] == pytest.approx(np.linspace(2.0, 22.0, 11), abs=1e-12)
    assert numbers(result, "load_path") == pytest.approx(np.linspace(0.0, 20.0, 11), abs=1e-12)


def test_loads_with_different_measures_keep_pace() -> None:
    result = simulate(
        case(
            rope(elements=7),
            load(measured="horizontal", start=2.0, speed=0.5),
            load(force=(0.0, -300.0), measured="arc", start=9.0, speed=1.0),
            load(force=(0.0, -150.0), measured="material", start=14.0, speed=0.25),
        )
    )
    path = numbers(result, "load_path")
    x, arc = numbers(result, "contact_position")[:, 0, 0], arc_to_contact(result, 1)
    fast = path <= 11.0  # until the second load has come to the end, which is the fastest
    assert fast.sum() >= 4
    assert x[fast] == pytest.approx(x[0] + 0.5 * path[fast], abs=1e-9)
    assert arc[fast] == pytest.approx(arc[0] + path[fast], abs=1e-9)
    assert numbers(result, "contact_xi")[fast, 2] == pytest.approx(14.0 + 0.25 * path[fast], abs=1e-9)


def test_a_speed_table_that_turns_round_is_followed_there_and_back() -> None:
    speed = SpeedTable(time=(0.0, 4.0, 8.0), value=(1.0, 1.0, -1.0))
    found = places(case(rope(), load(start=3.0, speed=speed), positions=201))
    xi, path = np.array([place.xi[0] for place in found]), np.array([place.path for place in found])
    assert xi.max() == pytest.approx(3.0 + 5.0, abs=0.05)  # 4 m and 1 m more while it slows down; a step is 0.07 m
    assert xi[-1] == pytest.approx(0.0, abs=1e-6)  # tables are followed on 20000 steps of time
    assert path[-1] == pytest.approx(5.0 + 8.0, abs=1e-6)
    assert np.diff(path) == pytest.approx(path[-1] / 200.0, rel=1e-9)


def test_callables_are_followed_like_tables() -> None:
    """The force grows with the time that the path takes: xi = t + t^2 / 20."""
    speed, force = (lambda t: 1.0 + 0.1 * t), (lambda t: (0.0, -100.0 - 50.0 * t))
    found = places(case(rope(), load(force=force, speed=speed)))
    end = -10.0 + math.sqrt(100.0 + 20.0 * 22.0)
    assert found[-1].xi[0] == pytest.approx(22.0, abs=1e-6)  # tables are followed on 20000 steps of time
    assert found[-1].given[0] == pytest.approx([0.0, -100.0 - 50.0 * end], rel=1e-6)
    table = ForceTable(time=(0.0, 20.0), value=((0.0, -100.0), (0.0, -1100.0)))
    other = places(case(rope(), load(force=table, speed=SpeedTable(time=(0.0, 20.0), value=(1.0, 3.0)))))
    assert [place.xi[0] for place in found] == pytest.approx([place.xi[0] for place in other], abs=1e-6)
    assert found[5].stands[0].r == pytest.approx(other[5].stands[0].r, abs=1e-5)


# --- statics along the path ------------------------------------------------------------------------------------


@pytest.mark.parametrize("elements", [1, 4, 20])
def test_a_clamped_load_passes_through_the_numbers_of_5b(elements: int) -> None:
    line = rope(length=20.0, elements=elements)
    result = slow(line, load(), gravity=0.0, positions=41)
    for frame, place, tensions in (
        (20, (10.0, -4.30123479814642), (885.799042274557, 885.799042274557)),
        (30, (15.7181740559642, -3.36402343342115), (716.086543431259, 890.488891803585)),
        (36, (18.7543837994964, -1.76548028808644), (465.166092398723, 803.333243238956)),
    ):
        assert numbers(result, "contact_position")[frame, 0] == pytest.approx(place, abs=1e-8)
        assert numbers(result, "contact_tension")[frame, 0] == pytest.approx(tensions, rel=1e-8)
        assert numbers(result, "hold_force")[frame, 0] == pytest.approx([0.0, 0.0], abs=0.0)


@pytest.mark.parametrize("elements", [1, 4, 20])
def test_a_pulley_passes_through_the_numbers_of_5b(elements: int) -> None:
    """The hold force on the line points to +x, uphill: it keeps the load from running back to the middle."""
    line = rope(length=20.0, elements=elements)
    load_ = load(contact="frictionless", measured="horizontal", start=10.0)
    result = simulate(case(line, load_, gravity=0.0, positions=3)).isel(load_path=1, contact=0)
    assert result.contact_position.to_numpy() == pytest.approx((15.0, -3.7070901273379), abs=1e-8)
    assert result.contact_tension.to_numpy() == pytest.approx([837.821869567776] * 2, rel=1e-8)
    assert result.hold_force.to_numpy() == pytest.approx([140.331412274603, 0.0], rel=1e-8)
    assert result.contact_force.to_numpy() == pytest.approx([140.331412274603, -LOAD], rel=1e-8)


def test_a_frictionless_load_on_a_stiff_light_rope_follows_the_ellipse() -> None:
    """5A: x = 5 gives z = 4.0818 and T/W = 1.1174; the hold force is W times the slope of the path."""
    line = rope(axial_stiffness=1e8, mass=1e-4, elements=11)
    result = slow(line, load(contact="frictionless", measured="horizontal", start=5.0), positions=3)
    x, z = numbers(result, "contact_position")[0, 0]
    half, depth = 11.0, 0.5 * math.sqrt(22.0**2 - 20.0**2)
    # strains of 1e-5 and a rope of 0.02 N beside a load of 700 N
    assert z == pytest.approx(-depth * math.sqrt(1.0 - ((x - 10.0) / half) ** 2), abs=3e-4)
    slope = depth * (x - 10.0) / half**2 / math.sqrt(1.0 - ((x - 10.0) / half) ** 2)
    assert numbers(result, "hold_force")[0, 0, 0] == pytest.approx(LOAD * slope, rel=1e-3)


def test_the_hold_force_is_the_load_times_the_slope_of_the_path() -> None:
    """On a rope that stores next to nothing; the slope is a numerical derivative along the result."""
    line = rope(axial_stiffness=1e8, mass=1e-4, elements=11)
    result = slow(line, load(contact="frictionless", measured="horizontal", start=4.0, speed=0.1), positions=161)
    x, z = numbers(result, "contact_position")[:, 0].T
    inner = slice(1, 120)  # beyond, the path bends too quickly for a difference over 0.2 m
    slope = (z[2:] - z[:-2]) / (x[2:] - x[:-2])
    hold = numbers(result, "hold_force")[1:-1, 0, 0]
    # differences over 0.2 m of a path with third derivatives up to 0.02 1/m^2
    assert hold[inner] == pytest.approx(LOAD * slope[inner], abs=0.15)


@pytest.mark.parametrize("stiffness", [3e3, 1e5])
def test_what_load_and_hold_force_do_is_stored_in_the_line_to_the_second_order(stiffness: float) -> None:
    """Heavy, soft ropes, too: d(elastic + gravitational) = hold dx - W dz along a frictionless path."""

    def imbalance(elements: int) -> float:
        line = rope(axial_stiffness=stiffness, length=20.0, elements=elements)
        result = simulate(case(line, load(contact="frictionless", start=5.05), positions=601))
        result = result.isel(load_path=slice(0, 360))  # it cannot be held beside the support
        (x, z), hold = numbers(result, "contact_position")[:, 0].T, numbers(result, "hold_force")[:, 0, 0]
        work = np.cumsum(0.5 * (hold[1:] + hold[:-1]) * np.diff(x) - LOAD * np.diff(z))
        energy = result.energy.sel(form=["elastic", "gravitational"]).sum("form").to_numpy()
        return float(np.abs(energy[1:] - energy[0] - work).max() / np.abs(work).max())

    coarse, fine = imbalance(22), imbalance(44)
    print("misses", coarse, fine, "order", math.log2(coarse / fine))
    assert fine < 2e-3
    assert math.log2(coarse / fine) == pytest.approx(2.0, abs=0.3)  # the largest of a curve that waves over the nodes


@every_measure
@pytest.mark.parametrize("length", [19.0, 20.0, 22.0])
def test_tensions_are_equal_on_both_sides_of_a_frictionless_contact(measured: str, length: float) -> None:
    result = simulate(case(rope(length=length), load(contact="frictionless", measured=measured, start=6.0)))
    behind, ahead = numbers(result, "contact_tension")[:, 0].T
    inside = (numbers(result, "contact_xi")[:, 0] > 0.0) & (numbers(result, "contact_xi")[:, 0] < length)
    assert inside.sum() >= 7
    # 1e-10 of the forces, and positions rounded over pieces much shorter than a link
    assert behind[inside] == pytest.approx(ahead[inside], rel=1e-8)


@every_contact
@every_measure
def test_supports_carry_weight_loads_and_hold_forces(contact: str, measured: str) -> None:
    result = simulate(
        case(
            rope(end=(20.0, 4.0)),
            load(contact=contact, measured=measured, start=4.0),
            load(force=(50.0, -300.0), contact=contact, measured=measured, start=12.0),
        )
    )
    assert result.sizes["load_path"] >= 6
    total = numbers(result, "reaction").sum(axis=1) + numbers(result, "contact_force").sum(axis=1)
    expected = np.tile([0.0, 2.0 * 9.81 * 22.0], (total.shape[0], 1))
    assert total == pytest.approx(expected, abs=1e-6)  # positions rounded over short pieces, of tensions near 1 kN
    given = numbers(result, "contact_force") - numbers(result, "hold_force")
    assert given == pytest.approx(np.tile([[0.0, -LOAD], [50.0, -300.0]], (total.shape[0], 1, 1)), abs=1e-9)
    assert np.all(numbers(result, "velocity") == 0.0)
    assert np.all(numbers(result, "contact_speed") == 0.0)


# --- two loads, nodes, supports ---------------------------------------------------------------------------------


def test_two_heavy_loads_agree_with_the_elastic_catenary() -> None:
    scenario = case(rope(elements=440), load(start=4.0), load(force=(80.0, -200.0), start=9.3, speed=2.0), positions=4)
    for place in places(scenario)[:3]:
        exact = elastic_catenary(
            span=20.0, length=22.0, weight=19.62, axial_stiffness=1e4,
            loads=[(place.xi[0], (0.0, -LOAD)), (place.xi[1], (80.0, -200.0))],
        )  # fmt: skip
        stand = place.stands[0]
        # order h^2: 0.05^2 / 24 over lengths of some metres
        found = stand.r[:, stand.contact].T
        assert found == pytest.approx(exact.load_positions, abs=1e-4)


@every_contact
def test_two_loads_on_one_link_stand_as_on_a_fine_mesh(contact: str) -> None:
    """Without weight the mesh does not matter, so one link for both loads is as good as a hundred."""
    loads = load(start=6.0, contact=contact), load(force=(0.0, -200.0), start=6.4, contact=contact)
    shapes = [
        slow(rope(length=19.0, elements=n), *loads, gravity=0.0, positions=5).isel(load_path=slice(0, 4))
        for n in (1, 2, 100)
    ]
    for name in ("contact_position", "contact_tension", "hold_force", "contact_force"):
        for other in shapes[1:]:
            assert numbers(other, name) == pytest.approx(numbers(shapes[0], name), rel=1e-8, abs=1e-7)


def test_a_load_on_a_node_is_the_limit_of_loads_beside_it() -> None:
    found = {}
    for offset in (0.0, 1e-8, -1e-8, 1e-11):
        scenario = case(rope(), load(start=7.0 + offset, contact="frictionless"), positions=2)
        found[offset] = places(scenario)[0].stands[0]
    on = found.pop(0.0)
    assert on.X.size == 23  # no point of its own
    for beside in found.values():
        # the place moves by the offset; pieces of 1e-8 m keep 8 digits of their strain
        assert beside.r[:, beside.contact[0]] == pytest.approx(on.r[:, on.contact[0]], abs=1e-7)
        assert beside.hold == pytest.approx(on.hold, abs=1e-4)
        assert beside.position == pytest.approx(on.position, abs=1e-7)


@every_contact
def test_a_load_on_a_support_leaves_the_line_alone(contact: str) -> None:
    result = slow(rope(length=19.0), load(contact=contact), positions=3)
    bare = slow(rope(length=19.0), load(force=(0.0, 0.0)), positions=3)
    for frame, support in ((0, 0), (2, 1)):
        one = result.isel(load_path=frame)
        assert one.hold_force.to_numpy() == pytest.approx(0.0, abs=0.0)
        assert one.contact_position.to_numpy()[0] == pytest.approx([20.0 * support, 0.0], abs=0.0)
        assert one.position.to_numpy() == pytest.approx(bare.position.to_numpy()[frame], abs=1e-12)
        assert one.reaction.to_numpy()[support, 1] == pytest.approx(LOAD + 0.5 * 2.0 * 9.81 * 19.0, rel=1e-9)


def test_two_loads_in_one_place_act_as_one() -> None:
    scenario = case(rope(), load(start=3.0, speed=2.0), load(force=(0.0, -100.0), start=7.0), positions=5)
    met = places(scenario)
    together = next(place for place in met if place.xi[0] > 11.0)
    assert together.xi[0] > together.xi[1]  # passed each other: loads on a line at rest do not mind
    scenario = case(rope(), load(start=7.0), load(force=(0.0, -100.0), start=3.0, speed=3.0), positions=16)
    for place in places(scenario):
        stand = place.stands[0]
        assert np.isfinite(stand.r).all()
        assert stand.force.sum(axis=1) == pytest.approx([0.0, -800.0], abs=1e-12)


def test_lines_without_loads_rest_beside_the_others() -> None:
    lines = {"rope": rope(), "wire": rope(start=(0.0, 5.0), end=(20.0, 5.0), elements=6)}
    scenario = Scenario(lines=lines, loads={"w": load()}, run=Quasistatic(positions=5))
    result = simulate(scenario)
    wire = numbers(result, "position")[:, 23:]
    assert wire == pytest.approx(np.tile(wire[0], (5, 1, 1)), abs=1e-9)


# --- slack ropes, and what cannot be ------------------------------------------------------------------------------


@pytest.mark.parametrize("law", [None, TensionOnly()])
def test_past_the_turning_point_the_load_hangs_below_the_support(law: TensionOnly | None) -> None:
    """5A: beyond L - s = (L^2 - X^2) / (2 L) = 1.909 m one part of a slack weightless rope carries everything."""
    line = rope(axial_stiffness=1e8, elements=5, **({"law": law} if law else {}))
    found = simulate(case(line, load(start=1.0), gravity=0.0, positions=22))
    assert found.attrs["outcome"] == "no rest shape"  # on the support itself nothing pulls on the rope any more
    xi, place = numbers(found, "contact_xi")[:, 0], numbers(found, "contact_position")[:, 0]
    for s, (x, z) in zip(xi, place, strict=True):
        if 1.0 <= s < 1.9:
            expected = (0.0, -s)
        elif s > 20.1:
            expected = (20.0, s - 22.0)
        else:
            x_material = (400.0 + s**2 - (22.0 - s) ** 2) / 40.0
            expected = (x_material, -math.sqrt(s**2 - x_material**2))
        assert (x, z) == pytest.approx(expected, abs=3e-4)  # strains of 1e-5


def test_a_frictionless_load_that_cannot_be_held_ends_the_walk_with_advice() -> None:
    result = simulate(case(rope(), load(contact="frictionless")))
    assert result.attrs["outcome"] == "no rest shape"
    assert "so near to a support" in result.attrs["advice"]
    assert "write contact: clamped" in result.attrs["advice"]
    assert result.sizes["load_path"] == 1


def test_a_load_that_would_move_off_its_line_has_no_path() -> None:
    with pytest.raises(EquilibriumError, match="move off it"):
        places(case(rope(), load(speed=lambda t: -1.0 - t)))


def test_a_start_along_an_undetermined_line_is_refused_with_advice() -> None:
    with pytest.raises(EquilibriumError, match=r"load load 0: without loads.*give gravity, or measured: material"):
        simulate(case(rope(), load(measured="arc", start=5.0), gravity=0.0))
