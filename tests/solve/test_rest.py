"""Ropes at rest: the chain against the elastic catenary, robust from any start, and a true minimum of the energy.

Numbers: weightless elastic rope, elastic catenary (Irvine), the same with a point load; closed forms in theory.rope.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.assembly import pack, strands_of
from ropewalk.model import (
    Equilibrium,
    Hooke,
    Law,
    Line,
    MovingForce,
    Polynomial,
    Scenario,
    SecondPiolaKirchhoff,
    Tabulated,
    TensionOnly,
    Travel,
)
from ropewalk.simulate import simulate
from ropewalk.solve.end_conditions import EndConditions
from ropewalk.solve.equilibrium import StrandAtRest, at_rest, potential, residual
from ropewalk.solve.loaded_equilibrium import LoadedStrand, clamped, stand
from ropewalk.theory.rope import RestingRope, elastic_catenary, weightless_elastic

WEIGHT = 19.62  # N/m: 2 kg/m under 9.81 m/s^2
HEAVY: dict[str, float] = {"length": 22.0, "weight": WEIGHT, "axial_stiffness": 1e5}


def hooke(stiffness: float = 1e5) -> np.ndarray:
    return pack(Hooke(), stiffness)


def dead(elements: int, length: float, weight: float, dim: int = 2) -> np.ndarray:
    """Weight on the inner nodes of a chain."""
    f = np.zeros((dim, elements + 1))
    f[-1, 1:-1] = -weight * length / elements
    return f


def chain(
    elements: int,
    end: tuple[float, ...] = (20.0, 0.0),
    length: float = 22.0,
    weight: float = WEIGHT,
    p: np.ndarray | None = None,
) -> StrandAtRest:
    ell = np.full(elements, length / elements)
    place, p = np.array(end), hooke() if p is None else p
    return at_rest(p, ell, dead(elements, length, weight, place.size), EndConditions.fast(np.zeros(place.size), place))


def rope(elements: int, **changed: Any) -> Line:
    given: dict[str, Any] = {"start": (0.0, 0.0), "end": (20.0, 0.0), "length": 22.0, "mass": 2.0,
                             "axial_stiffness": 1e5, "elements": elements}  # fmt: skip
    return Line(**{name: value for name, value in (given | changed).items() if value is not None})


def scenario(line: Line, *loads: tuple[float, tuple[float, ...]], gravity: float = 9.81, **travel: Any) -> Scenario:
    moving = {
        f"load {k}": MovingForce(on="rope", force=force, travel=Travel(speed=1.0, start=xi, **travel))
        for k, (xi, force) in enumerate(loads)
    }
    return Scenario(gravity=gravity, lines={"rope": line}, loads=moving, run=Equilibrium())


def at_once(case: Scenario) -> xr.Dataset:
    """The one frame of a run of kind equilibrium."""
    return simulate(case).isel(load_path=0)


def loaded(elements: int, xi: float, force: tuple[float, float], gravity: float = 9.81, **changed: Any) -> LoadedStrand:
    line = rope(elements, **changed)
    strands = strands_of(scenario(line, (xi, force), gravity=gravity), {"rope": float(line.length or 0.0)})
    restrained = EndConditions.fast(np.zeros(2), np.array(line.end))
    return stand(strands, 0, restrained, np.array([xi]), np.array([force]).T, clamped(1))


def orders(errors: list[float]) -> np.ndarray:
    """Observed orders of convergence from errors on meshes halved one after the other."""
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


# --- against the elastic catenary -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("height", "changed"),
    [
        (0.0, {}),
        (0.0, {"length": 20.0}),
        (0.0, {"length": 19.0}),
        (3.0, {"axial_stiffness": 1e4}),
        (-7.0, {"length": 25.0}),
        (0.0, {"axial_stiffness": 1e2, "length": 18.0}),
        (2.0, {"length": 60.0}),
    ],
    ids=["5D slack", "5D level", "taut", "5D inclined", "steep", "soft", "deep"],
)
def test_the_chain_converges_to_the_elastic_catenary_with_the_second_order(
    height: float, changed: dict[str, float]
) -> None:
    data = HEAVY | changed
    exact = elastic_catenary(span=20.0, height=height, **data)
    shapes, pulls = [], []
    for elements in (40, 80, 160, 320):
        rest = chain(elements, (20.0, height), data["length"], WEIGHT, hooke(data["axial_stiffness"]))
        xi = np.linspace(0.0, data["length"], elements + 1)
        shapes.append(float(np.abs(rest.position.T - exact.position(xi)).max()))
        pulls.append(abs(float(rest.first_force[0]) - exact.horizontal_tension))
    print("orders", orders(shapes), orders(pulls))
    assert orders(shapes) == pytest.approx(2.0, abs=0.1)
    assert orders(pulls) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize(
    ("height", "changed", "horizontal"),
    [
        (0.0, {}, 252.56404091137),
        (0.0, {"length": 20.0}, 855.834877884037),
        (3.0, {"axial_stiffness": 1e4}, 230.5058362994),
    ],
)
def test_extrapolated_chain_gives_the_numbers_of_irvine(
    height: float, changed: dict[str, float], horizontal: float
) -> None:
    data = HEAVY | changed
    coarse, fine = (
        float(chain(n, (20.0, height), data["length"], WEIGHT, hooke(data["axial_stiffness"])).first_force[0])
        for n in (400, 800)
    )
    # what Richardson's extrapolation leaves is of fourth order in h / length = 1/400
    assert (4.0 * fine - coarse) / 3.0 == pytest.approx(horizontal, rel=1e-9)


@pytest.mark.parametrize("height", [0.0, -4.0])
def test_simulate_gives_the_elastic_catenary(height: float) -> None:
    result = at_once(scenario(rope(400, end=(20.0, height))))
    exact = elastic_catenary(span=20.0, height=height, **HEAVY)
    # order h^2: (22/400)^2/24 times curvatures of 0.1 1/m and tensions of 300 N
    assert result.position.to_numpy() == pytest.approx(exact.position(np.linspace(0.0, 22.0, 401)), abs=2e-4)
    assert result.tension.to_numpy() == pytest.approx(exact.tension((np.arange(400) + 0.5) * 0.055), rel=2e-4)
    assert result.reaction.to_numpy()[0] == pytest.approx(exact.start_reaction, rel=2e-4)
    assert result.reaction.to_numpy()[1] == pytest.approx(exact.end_reaction, rel=2e-4)


@pytest.mark.parametrize(
    ("xi", "horizontal", "place"),
    [
        (5.5, 742.247459584949, (3.95586524491478, -3.90148493918959)),
        (11.0, 947.152146966831, (10.0, -4.81791524851864)),
        (20.0, 378.751221624917, (19.1988730391743, -1.85333337473086)),
    ],
)
def test_a_point_load_gives_the_numbers_of_5e_with_the_second_order(
    xi: float, horizontal: float, place: tuple[float, float]
) -> None:
    """On 44, 88, ... links the loads at 5.5 and 11 stand on nodes, on 55 and 110 not; 20 m is a node on 44."""
    where, pull = [], []
    for elements in (44, 88, 176, 352):
        rest = loaded(elements, xi, (0.0, -700.0))
        where.append(float(np.linalg.norm(rest.r[:, rest.contact[0]] - place)))
        pull.append(abs(float(rest.first_force[0]) - horizontal))
    print("orders", orders(where), orders(pull))
    assert orders(where) == pytest.approx(2.0, abs=0.1)
    assert orders(pull) == pytest.approx(2.0, abs=0.1)
    assert pull[-1] < 1e-4 * horizontal  # about (22/352)^2 / 24 over the square of the catenary's parameter
    between = loaded(333, xi, (0.0, -700.0))
    assert np.linalg.norm(between.r[:, between.contact[0]] - place) < 2.0 * where[-1] * (352 / 333) ** 2


@pytest.mark.parametrize("elements", [1, 2, 3, 7, 100])
@pytest.mark.parametrize(
    ("xi", "place", "tensions"),
    [
        (10.0, (10.0, -4.30123479814642), (885.799042274557, 885.799042274557)),
        (15.0, (15.7181740559642, -3.36402343342115), (716.086543431259, 890.488891803585)),
        (18.0, (18.7543837994964, -1.76548028808644), (465.166092398723, 803.333243238956)),
    ],
)
def test_the_weightless_elastic_rope_of_5b_is_exact_on_any_mesh(
    elements: int, xi: float, place: tuple[float, float], tensions: tuple[float, float]
) -> None:
    line = rope(elements, length=20.0, axial_stiffness=1e4)
    result = at_once(scenario(line, (xi, (0.0, -700.0)), gravity=0.0))
    assert result.contact_position.to_numpy()[0] == pytest.approx(place, abs=1e-9)
    assert result.contact_tension.to_numpy()[0] == pytest.approx(tensions, rel=1e-9)
    assert result.reaction.sum("support").to_numpy() == pytest.approx([0.0, 700.0], abs=1e-9 * 700.0)


def test_the_law_of_the_printed_equations_gives_the_other_numbers_of_5b() -> None:
    line = rope(9, length=20.0, axial_stiffness=1e4, law=SecondPiolaKirchhoff())
    result = at_once(scenario(line, (15.0, (0.0, -700.0)), gravity=0.0))
    assert result.contact_position.to_numpy()[0] == pytest.approx((15.6921645731122, -3.28573423327046), abs=1e-9)


def test_a_slack_weightless_rope_takes_the_shape_its_load_gives_it() -> None:
    """Length 22 of 5B, and a load so near to the end that it hangs from it while the rest is slack."""
    line = rope(8, axial_stiffness=1e4)
    result = at_once(scenario(line, (16.0, (0.0, -700.0)), gravity=0.0))
    assert result.contact_position.to_numpy()[0] == pytest.approx((15.9813342631604, -5.01938211235652), abs=1e-9)
    for law in (Hooke(), TensionOnly()):
        line = rope(8, axial_stiffness=1e4, law=law)
        hanging = at_once(scenario(line, (21.0, (0.0, -700.0)), gravity=0.0))
        # a force of 1e-10 of the load's may be left in the slack part (equilibrium.py rounds folds off)
        assert hanging.contact_position.to_numpy()[0] == pytest.approx((20.0, -1.07), abs=1e-7)
        assert hanging.contact_tension.to_numpy()[0] == pytest.approx((0.0, 700.0), abs=1e-5)


@pytest.mark.parametrize("pull", [1.0, -1.0])
def test_a_load_can_pull_along_the_rope_and_upwards(pull: float) -> None:
    force = (300.0 * pull, 900.0)
    exact = elastic_catenary(span=20.0, loads=[(7.0, force)], **HEAVY)
    rest = loaded(440, 7.0, force)
    assert rest.r[:, rest.contact[0]] == pytest.approx(exact.load_positions[0], abs=1e-4)  # order h^2 = 2.5e-3


def test_a_load_on_a_support_goes_into_the_support() -> None:
    bare = at_once(scenario(rope(20)))
    for xi, support in ((0.0, 0), (22.0, 1)):
        result = at_once(scenario(rope(20), (xi, (50.0, -700.0))))
        assert result.position.to_numpy() == pytest.approx(bare.position.to_numpy(), abs=1e-12)
        taken = result.reaction.to_numpy()[support] - bare.reaction.to_numpy()[support]
        assert taken == pytest.approx([-50.0, 700.0], abs=1e-9)


def test_loads_in_space_pull_the_rope_aside() -> None:
    """A weightless rope hangs in the plane of its supports and its load: 5B turned about the x axis."""
    line = rope(6, length=20.0, axial_stiffness=1e4)
    result = at_once(scenario(line, (15.0, (0.0, 420.0, -560.0)), gravity=0.0))
    x, y, z = result.contact_position.to_numpy()[0]
    assert (x, y / 0.6, -z / 0.8) == pytest.approx((15.7181740559642,) + (3.36402343342115,) * 2, abs=1e-9)


# --- robust from any sensible start -----------------------------------------------------------------------------

LAWS: dict[str, np.ndarray] = {
    "hooke": hooke(),
    "stiff": hooke(1e12),
    "soft": hooke(1e2),
    "tension only": pack(TensionOnly(), 1e5),
    "second Piola-Kirchhoff": pack(SecondPiolaKirchhoff(), 1e5),
    "soft second Piola-Kirchhoff": pack(SecondPiolaKirchhoff(), 1e2),
    "cubic": pack(Polynomial(coefficients=(1e5, 1e6, 1e7)), None),
    "quintic": pack(Polynomial(coefficients=(1e5, -1e5, 1e7, 0.0, 1e9)), None),
    "table": pack(Tabulated(strain=(-0.1, 0.0, 0.001, 0.002, 0.1), tension=(-10, 0, 50, 100, 1e5)), None),
    "table that yields": pack(Tabulated(strain=(0.0, 0.001, 0.05, 0.1), tension=(0, 100, 100, 200)), None),
    "table from tension": pack(Tabulated(strain=(0.01, 0.02), tension=(100, 200)), None),
}
GEOMETRY: dict[str, tuple[tuple[float, ...], float]] = {
    "slack": ((20.0, 0.0), 22.0),
    "level with length = span": ((20.0, 0.0), 20.0),
    "taut": ((20.0, 0.0), 19.5),
    "rising": ((15.0, 12.0), 20.0),
    "falling": ((15.0, -12.0), 19.5),
    "nearly vertical loop": ((1e-6, 0.0), 22.0),
    "nearly vertical and taut": ((1e-6, -20.0), 19.9),
    "vertical": ((0.0, -20.0), 20.0),
    "vertical and slack": ((0.0, 10.0), 22.0),
    "both ends in one point": ((0.0, 0.0), 22.0),
    "huge sag": ((1.0, 0.0), 2000.0),
    "aside": ((12.0, 9.0, -3.0), 20.0),
}


def check_rest(rest: StrandAtRest, p: np.ndarray, length: float, f: np.ndarray, end: np.ndarray) -> None:
    """The rest shape is in balance, and no small disturbance lowers its potential energy."""
    n = f.shape[1] - 1
    ell, force, out = np.full(n, length / n), np.zeros((f.shape[0], n)), np.zeros((max(n - 1, 1), f.shape[0]))
    r = rest.position
    assert np.isfinite(r).all()
    assert np.array_equal(r[:, 0], np.zeros(f.shape[0]))
    assert np.array_equal(r[:, -1], end)
    load = float(np.abs(f[:, 1:-1]).sum())
    scale = max(load, float(np.abs(rest.first_force).max()))
    # strains are known to a rounding of the positions over the length of a link
    steepest = float(max(abs(p[2:5])) if p[0] == 0 else 2e6)
    rounding = 2e-15 * steepest * float(np.abs(r).max()) / ell[0]
    worst = residual(p, ell, f, r, force, out)
    assert worst <= 1e-8 * scale + rounding
    energy, rng = potential(p, ell, f, r), np.random.default_rng(1)
    noise = 1e-13 * abs(energy) + rounding * length
    for size in (1e-1, 1e-3, 1e-5):
        for _ in range(5):
            moved = r.copy()
            moved[:, 1:-1] += size * ell[0] * rng.normal(size=(f.shape[0], n - 1))
            assert potential(p, ell, f, moved) >= energy - noise


@pytest.mark.parametrize("geometry", GEOMETRY)
@pytest.mark.parametrize("law", LAWS)
def test_every_rope_finds_its_rest(law: str, geometry: str) -> None:
    end, length = GEOMETRY[geometry]
    if law.startswith("soft second") and geometry == "huge sag":
        pytest.skip("stretched beyond all reason")
    for elements in (2, 3, 10, 31):
        f = dead(elements, length, WEIGHT, len(end))
        rest = chain(elements, end, length, WEIGHT, LAWS[law])
        check_rest(rest, LAWS[law], length, f, np.array(end))


@pytest.mark.parametrize("geometry", ["slack", "level with length = span", "taut", "huge sag", "nearly vertical loop"])
def test_five_thousand_links_find_their_rest(geometry: str) -> None:
    end, length = GEOMETRY[geometry]
    rest = chain(5000, end, length)
    check_rest(rest, hooke(), length, dead(5000, length, WEIGHT), np.array(end))
    if geometry == "slack":
        exact = elastic_catenary(span=20.0, **HEAVY)
        assert float(rest.first_force[0]) == pytest.approx(exact.horizontal_tension, rel=1e-6)  # order h^2


@pytest.mark.parametrize("elements", [1, 2, 3])
def test_simulate_accepts_few_links(elements: int) -> None:
    result = at_once(scenario(rope(elements)))
    weight = 2.0 * 9.81 * 22.0
    assert result.reaction.sum("support").to_numpy() == pytest.approx([0.0, weight], abs=1e-10 * 1e5)


def test_a_single_link_with_both_ends_in_one_point_gives_numbers() -> None:
    result = at_once(scenario(rope(1, end=(0.0, 0.0), law=TensionOnly())))
    assert np.isfinite(result.reaction.to_numpy()).all()
    assert np.isfinite(result.tension.to_numpy()).all()


def test_an_odd_chain_in_a_loop_buckles_out_of_line() -> None:
    """With Hooke's law the middle link pushes: it lies level below, not folded in the line of the others."""
    r = chain(3, (0.0, 0.0)).position
    assert r[1, 1] == pytest.approx(r[1, 2], abs=1e-9)
    assert abs(r[0, 2] - r[0, 1]) == pytest.approx(22.0 / 3.0, rel=1e-2)  # but for its strain, about 1e-3


# --- properties -------------------------------------------------------------------------------------------------


@st.composite
def ropes(draw: st.DrawFn) -> tuple[Line, list[tuple[float, tuple[float, float]]]]:
    end = (draw(st.floats(1.0, 30.0)), draw(st.floats(-15.0, 15.0)))
    distance = float(np.hypot(*end))
    length = distance * draw(st.floats(0.9, 2.5))
    kind = draw(st.sampled_from(["hooke", "tension_only", "spk", "table", "polynomial"]))
    stiffness: float | None = 10.0 ** draw(st.floats(3.5, 7.0))
    law: Law = {"hooke": Hooke(), "tension_only": TensionOnly(), "spk": SecondPiolaKirchhoff()}.get(kind, Hooke())
    if kind == "table":
        law = Tabulated(strain=(-0.1, 0.0, 0.01, 0.05), tension=(-10.0, 0.0, 500.0, 9e3))
    if kind == "polynomial":
        law = Polynomial(coefficients=(stiffness, stiffness, stiffness))
    line = Line(
        start=(0.0, 0.0), end=end, length=length, mass=draw(st.floats(0.05, 5.0)), elements=draw(st.integers(2, 40)),
        law=law, axial_stiffness=None if kind in ("table", "polynomial") else stiffness,
    )  # fmt: skip
    places = draw(st.lists(st.integers(0, 1000), max_size=3, unique=True))
    force = st.floats(-800.0, 800.0)
    return line, [(part / 1000 * length, (draw(force), draw(force))) for part in places]


@settings(deadline=None, max_examples=60)
@given(ropes())
def test_any_rope_is_in_balance_and_its_supports_carry_weight_and_loads(
    case: tuple[Line, list[tuple[float, tuple[float, float]]]],
) -> None:
    line, loads = case
    result = at_once(scenario(line, *loads))
    assert line.length is not None
    weight = np.array([0.0, -line.mass * 9.81 * line.length])
    total = weight + sum((np.array(force) for _, force in loads), np.zeros(2))
    largest = float(np.abs(result.tension.to_numpy()).max())
    size = largest + float(np.abs(weight).sum()) + sum(float(np.abs(force).sum()) for _, force in loads)
    # positions rounded over pieces that may be very short where a load stands beside a node
    stiffness = line.axial_stiffness or 1e7
    assert result.reaction.sum("support").to_numpy() == pytest.approx(-total, abs=1e-7 * size + 1e-12 * stiffness)
    assert result.hold_force.to_numpy() == pytest.approx(0.0, abs=0.0)


@settings(deadline=None, max_examples=25)
@given(
    st.tuples(st.floats(0.5, 30.0), st.floats(-15.0, 15.0)),
    st.floats(0.95, 3.0),
    st.floats(3.0, 8.0),
    st.integers(2, 40),
    st.lists(st.tuples(st.floats(-500, 500), st.floats(-500, 500)), min_size=3, max_size=3),
)
def test_any_chain_rests_in_a_minimum_of_its_energy(
    end: tuple[float, float], slack: float, log_stiffness: float, elements: int, pulls: list[tuple[float, float]]
) -> None:
    length, p = slack * float(np.hypot(*end)), hooke(10.0**log_stiffness)
    f = dead(elements, length, WEIGHT)
    for i, pull in zip((1, elements // 2, elements - 1), pulls, strict=True):
        f[:, i] += pull
    rest = at_rest(p, np.full(elements, length / elements), f, EndConditions.fast(np.zeros(2), np.array(end)))
    check_rest(rest, p, length, f, np.array(end))


@settings(deadline=None, max_examples=25)
@given(st.floats(0.95, 3.0), st.floats(3.0, 7.0), st.integers(-20, 20), st.integers(-20, 20))
def test_rest_scales_with_the_units(slack: float, log_stiffness: float, metres: int, newtons: int) -> None:
    """Powers of two, so that scaling makes no rounding: the same steps are taken."""
    m, n, stiffness = 2.0**metres, 2.0**newtons, 10.0**log_stiffness
    small = chain(13, (10.0, 2.0), 10.0 * slack + 1.0, 5.0, hooke(stiffness))
    large = chain(13, (10.0 * m, 2.0 * m), (10.0 * slack + 1.0) * m, 5.0 * n / m, hooke(stiffness * n))
    assert large.position / m == pytest.approx(small.position, abs=1e-9)  # a step more or less at the same point
    assert large.first_force / n == pytest.approx(small.first_force, rel=1e-9, abs=1e-9)


@settings(deadline=None, max_examples=25)
@given(st.floats(0.95, 3.0), st.floats(-10.0, 10.0), st.floats(3.0, 7.0), st.integers(0, 1000))
def test_the_mirrored_rope_is_the_mirror_image(slack: float, height: float, log_stiffness: float, place: int) -> None:
    part = place / 1000
    length, stiffness = slack * float(np.hypot(20.0, height)), 10.0**log_stiffness
    one = loaded(17, part * length, (90.0, -300.0), end=(20.0, height), length=length, axial_stiffness=stiffness)
    two = loaded(
        17, length - part * length, (-90.0, -300.0), end=(20.0, -height), length=length, axial_stiffness=stiffness
    )
    turned = np.array([[20.0], [height]]) + two.position[:, ::-1] * np.array([[-1.0], [1.0]])
    # a part that hangs almost without tension moves far for small forces, and a load beside a node moves the node
    assert one.position == pytest.approx(turned, abs=1e-6 * length)


# --- tension instead of length ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("tension", "gravity", "changed"),
    [
        (2e3, 9.81, {}),
        (300.0, 9.81, {}),
        (2e4, 9.81, {"end": (15.0, 9.0)}),
        (5e3, 0.0, {}),
        (2e3, 9.81, {"axial_stiffness": 1e7}),
        (2e3, 9.81, {"law": SecondPiolaKirchhoff(), "axial_stiffness": 1e4}),
        (2e3, 9.81, {"law": Tabulated(strain=(0.0, 0.01, 0.05), tension=(0.0, 1e3, 9e3)), "axial_stiffness": None}),
        (2e3, 9.81, {"elements": 1}),
    ],
)
def test_a_line_given_by_its_tension_has_that_mean_tension_at_rest(
    tension: float, gravity: float, changed: dict[str, Any]
) -> None:
    line = rope(**({"elements": 30, "length": None, "tension": tension} | changed))
    result = at_once(scenario(line, gravity=gravity))
    assert float(result.tension.mean()) == pytest.approx(tension, rel=1e-9)


def test_a_tension_too_low_for_the_weight_is_refused_with_advice() -> None:
    with pytest.raises(EquilibriumError, match=r"line rope.*too little for its weight; give more"):
        at_once(scenario(rope(30, length=None, tension=10.0)))


def test_a_tension_that_the_law_never_gives_is_refused() -> None:
    law = Polynomial(coefficients=(1e5, -1e6))
    with pytest.raises(EquilibriumError, match="never reaches the tension of 9000 N"):
        at_once(scenario(rope(30, length=None, tension=9e3, law=law, axial_stiffness=None)))


# --- what has no rest shape ---------------------------------------------------------------------------------------


def test_a_slack_weightless_line_is_refused_with_advice() -> None:
    with pytest.raises(EquilibriumError, match=r"slack.*not determined; give gravity, a load"):
        chain(10, weight=0.0)
    line = rope(10)
    with pytest.raises(EquilibriumError, match=r"line rope.*slack.*give gravity"):
        at_once(scenario(line, (0.0, (0.0, -700.0)), gravity=0.0))


def test_a_law_that_cannot_carry_the_load_is_refused_with_advice() -> None:
    law = Polynomial(coefficients=(1e5, -1e6))  # at most 2500 N
    with pytest.raises(EquilibriumError, match=r"axial law cannot carry.*check length, axial_stiffness, law"):
        at_once(scenario(rope(10, law=law, axial_stiffness=None), (11.0, (0.0, -6e3))))


def test_a_load_that_begins_beyond_its_line_is_refused() -> None:
    with pytest.raises(EquilibriumError, match=r"load 0 would begin 30 m along its line.*change travel.from"):
        at_once(scenario(rope(10), (30.0, (0.0, -700.0)), measured="arc"))


# --- where loads begin ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("measured", ["material", "arc", "slip", "horizontal"])
def test_loads_begin_where_their_measure_says_on_the_unloaded_line(measured: str) -> None:
    exact = elastic_catenary(span=20.0, height=3.0, **(HEAVY | {"axial_stiffness": 1e4}))
    line = rope(400, end=(20.0, 3.0), axial_stiffness=1e4)
    xi = float(at_once(scenario(line, (6.0, (0.0, -1e-6)), measured=measured)).contact_xi[0])
    grid = np.linspace(0.0, xi, 2001)
    if measured == "material":
        assert xi == 6.0
    elif measured == "horizontal":
        assert exact.position(xi)[0] == pytest.approx(6.0, abs=1e-4)  # order h^2
    else:
        stretch = 1.0 + exact.tension(grid) / 1e4
        assert float(np.trapezoid(stretch, grid)) == pytest.approx(6.0, abs=1e-5)  # order h^2 of the tension alone


# --- without the compiler ---------------------------------------------------------------------------------------


def test_rest_is_the_same_without_the_compiler() -> None:
    script = (
        "import numpy as np\n"
        "from ropewalk.mechanics.assembly import pack\n"
        "from ropewalk.model import Hooke\n"
        "from ropewalk.solve.equilibrium import at_rest\n"
        "from ropewalk.solve.end_conditions import EndConditions\n"
        "f = np.zeros((2, 7)); f[1, 1:-1] = -19.62 * 22 / 6\n"
        "ends = EndConditions.fast(np.zeros(2), np.array([20.0, 0.0]))\n"
        "rest = at_rest(pack(Hooke(), 1e5), np.full(6, 22 / 6), f, ends)\n"
        "print(repr(float(rest.position[1].min())))\n"
    )
    run = subprocess.run(
        [sys.executable, "-c", script], env={**os.environ, "NUMBA_DISABLE_JIT": "1"}, cwd=Path(__file__).parent,
        capture_output=True, text=True, timeout=120, check=True,
    )  # fmt: skip
    assert float(run.stdout) == pytest.approx(float(chain(6).position[1].min()), rel=1e-12)


def test_theory_and_chain_agree_on_a_load_that_hangs_from_one_support() -> None:
    exact: RestingRope = weightless_elastic(span=20.0, length=22.0, axial_stiffness=1e4, loads=[(2.0, (0.0, -700.0))])
    rest = loaded(11, 1.0, (0.0, -700.0), gravity=0.0, axial_stiffness=1e4)
    assert exact.load_positions[0] != pytest.approx([0.0, -1.07])
    assert rest.r[:, rest.contact[0]] == pytest.approx([0.0, -1.07], abs=1e-7)
