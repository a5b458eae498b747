"""Equilibria that the core's forces and matrices lead to: exact solutions, bad drawings, unstable states."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import brentq

from core_structures import bridge, tripod
from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import Builder, RunProperties, SpringProperties
from ropewalk.engine.equilibrium import find_equilibrium

Array = NDArray[np.float64]
SPAN, LENGTH, MASS, EA = 20.0, 20.3, 1.0, 1e4


def drawing(kind: str, links: int) -> Array:
    """Points from which the search begins."""
    part, draw = np.arange(links + 1) / links, np.random.default_rng(1)
    shapes = {"straight": 0.0 * part, "arch": 3.0 * np.sin(np.pi * part), "zigzag": 0.3 * (np.arange(links + 1) % 2),
              "noise": 2.0 * draw.normal(size=links + 1), "sag": -2.4 * np.sin(np.pi * part)}  # fmt: skip
    points = np.array([SPAN * part, shapes[kind]])
    points[1, [0, -1]] = 0.0
    return points


def slack_rope(links: int, kind: str = "sag", tension_only: bool = False, EA: float = EA) -> Bound:
    builder = Builder()
    run = RunProperties(LENGTH / links, MASS, EA, tension_only=tension_only)
    builder.fix(*builder.add_run(drawing(kind, links), run))
    return Bound(*builder.build())


def elastic_catenary(EA: float = EA) -> tuple[float, float]:
    """Horizontal force, N, and height of the middle, m (Irvine, Cable Structures, 1981, eqs. 1.22 and 1.24)."""
    w, V = MASS * 9.81, MASS * 9.81 * LENGTH / 2.0

    def span(H: float) -> float:
        return float(H * LENGTH / EA + 2.0 * H / w * np.arcsinh(V / H))

    H = float(brentq(lambda each: span(each) - SPAN, 10.0, 1e4, xtol=1e-12))
    return H, -(w * LENGTH**2 / (8.0 * EA) + H / w * (np.sqrt(1.0 + (V / H) ** 2) - 1.0))


STIFF = 1e6  # N: rounding of positions leaves forces of 1e-8 N, so that the search ends there at the latest


def test_slack_rope_hangs_as_the_elastic_catenary() -> None:
    """Of the fourth order: a twelfth of the load on an end link acts further in. With loads at nodes alone: second."""
    H, middle = elastic_catenary(STIFF)
    errors = []
    for links in (10, 20, 40):
        bound = slack_rope(links, EA=STIFF)
        assert find_equilibrium(bound, 30).residual < 1e-7
        pull = bound.forces()[0, 0]
        errors.append((abs(bound.state.position[1, links // 2] - middle), abs(pull - H)))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    print("elastic catenary", H, middle, errors, orders)
    assert np.all(np.abs(orders[:, 0] - 4.0) < 0.1)
    assert abs(orders[1, 1] - 4.0) < 0.1
    assert errors[-1][0] < 3e-7  # m of 1.52 m
    assert errors[-1][1] < 7e-6  # N of 324 N


def test_soft_rope_hangs_as_the_elastic_catenary() -> None:
    """Tensions that are constant along links leave an error of the second order, a thousandth of that of the loads."""
    H, middle = elastic_catenary()
    bound = slack_rope(40)
    assert find_equilibrium(bound).outcome == "found"
    assert bound.state.position[1, 20] == pytest.approx(middle, abs=4e-7)  # 0.11 mm with loads at nodes alone
    assert bound.forces()[0, 0] == pytest.approx(H, abs=1.4e-4)  # 0.086 N


def test_joined_runs_hang_as_one() -> None:
    """A rope that is cut and joined again; a joint is a hinge, with an end of either run."""
    apart = []
    for factor in (1, 2, 4):
        links, at = 20 * factor, 8 * factor
        whole, builder, points = slack_rope(links, EA=STIFF), Builder(), drawing("sag", links)
        run = RunProperties(LENGTH / links, MASS, STIFF)
        first, joint = builder.add_run(points[:, : at + 1], run)
        again, last = builder.add_run(points[:, at:], run)
        builder.fix(first, last)
        builder.join(again, joint)
        joined = Bound(*builder.build())
        for each in (whole, joined):
            assert find_equilibrium(each, 30).residual < 1e-7
        apart.append(float(np.abs(np.delete(joined.state.position, again, axis=1) - whole.state.position).max()))
    orders = np.log2(np.array(apart[:-1]) / apart[1:])
    print("joined", apart, orders)
    assert np.all(np.abs(orders - 3.0) < 0.2)  # without: 2; next to the joint
    assert apart[-1] < 6e-8


@pytest.mark.parametrize("links", [8, 16])
def test_hinged_beam_under_its_weight_is_as_exact(links: int) -> None:
    """Hinged: 5 w L^4/(384 EI) in the middle, exact at nodes but for how it stretches."""
    length, EI, w = 10.0, 1e6, 9.81e-3
    builder = Builder()
    points = np.array([np.linspace(0.0, length, links + 1), np.zeros(links + 1)])
    first, last = builder.add_run(points, RunProperties(length / links, 1e-3, 1e3, bending_stiffness=EI))
    builder.fix(first)
    builder.fix(last, axes=[1])
    bound = Bound(*builder.build())
    assert find_equilibrium(bound, 10).residual < 1e-6 * w * length
    exact = -5.0 * w * length**4 / (384.0 * EI)
    assert bound.state.position[1, links // 2] == pytest.approx(
        exact, rel=1e-9
    )  # 3 % with loads at nodes alone, 8 links


@pytest.mark.parametrize("kind", ["straight", "arch", "zigzag", "noise"])
@pytest.mark.parametrize("tension_only", [False, True])
def test_equilibrium_does_not_depend_on_the_drawing(kind: str, tension_only: bool) -> None:
    bound, good = slack_rope(40, kind, tension_only), slack_rope(40)
    assert find_equilibrium(good).outcome == "found"
    found = find_equilibrium(bound)
    assert found.outcome == "found"
    assert found.iterations < 60
    np.testing.assert_allclose(bound.state.position, good.state.position, rtol=0, atol=1e-9)


def test_three_springs_bear_a_weight_as_their_triangle_says() -> None:
    """A weight on two equal springs: 2 k (l - L) sin(angle) = m g."""
    builder = Builder()
    left, right = builder.add_node([-3.0, 0.0], 0.0), builder.add_node([3.0, 0.0], 0.0)
    knot = builder.add_node([0.4, -0.1], 10.0)
    builder.fix(left, right)
    for end in (left, right):
        builder.add_spring(end, knot, SpringProperties(200.0, 3.0, tension_only=True))
    bound = Bound(*builder.build())
    assert find_equilibrium(bound).outcome == "found"

    def lift(z: float) -> float:
        length = np.hypot(3.0, z)
        return float(2.0 * 200.0 * (length - 3.0) * z / length - 98.1)

    assert bound.state.position[:, knot] == pytest.approx([0.0, -brentq(lift, 0.1, 5.0, xtol=1e-13)], abs=1e-10)


@pytest.mark.parametrize("make", [bridge, tripod, lambda: bridge(3, 30.0)])
def test_structure_in_equilibrium_stays_there(make: type[Bound]) -> None:
    bound = make()  # type: ignore[call-arg]
    assert find_equilibrium(bound).outcome == "found"
    begin = bound.state.position.copy()
    bound.advance(2000, 1e-4)
    np.testing.assert_allclose(bound.state.position, begin, rtol=0, atol=1e-10)


def test_equilibrium_without_stability_is_named() -> None:
    """A mass exactly above its spring, which pushes."""
    builder = Builder()
    foot, top = builder.add_node([0.0, 0.0], 0.0), builder.add_node([0.0, 0.9], 1.0)
    builder.fix(foot)
    builder.add_spring(foot, top, SpringProperties(98.1, 1.0))
    found = find_equilibrium(Bound(*builder.build()))
    assert found.outcome == "unstable"


def test_mass_without_support_has_no_equilibrium() -> None:
    builder = Builder()
    builder.add_node([0.0, 0.0], 1.0)
    assert find_equilibrium(Bound(*builder.build())).outcome == "not found"


def test_node_held_along_one_axis_slides_along_the_other() -> None:
    builder = Builder()
    top, ring = builder.add_node([1.0, 0.0], 0.0), builder.add_node([0.0, 5.0], 1.0)
    builder.fix(top)
    builder.fix(ring, axes=[0])
    builder.add_spring(top, ring, SpringProperties(100.0, 0.5, tension_only=True))
    bound = Bound(*builder.build())
    assert find_equilibrium(bound).outcome == "found"
    x, z = bound.state.position[:, ring]
    assert x == 0.0
    assert z < -0.09
    assert bound.forces()[1, ring] == pytest.approx(0.0, abs=1e-10)
