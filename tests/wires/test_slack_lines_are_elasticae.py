"""Slack lines with bending stiffness at rest, from ropes to rods: 25 of them against the heavy elastica.

The elastica is Kirchhoff's rod in its plane, solved by collocation (`scipy.integrate.solve_bvp`): beside the code, a
route with angles and moments instead of positions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from scipy.integrate import solve_bvp

from ropewalk.model import Scenario
from ropewalk.simulate import simulate, spectrum_of
from ropewalk.theory.rope import elastic_catenary

Array = NDArray[np.float64]
LENGTH, WEIGHT = 20.0, 9.81  # m, N/m
HALF = 0.5 * LENGTH
SPANS = [12.0, 14.0, 16.0, 18.0, 19.5]
STIFFNESSES = [1e-2, 1.0, 1e2, 1e3, 1e4]  # N m^2


@dataclass(frozen=True)
class Elastica:
    """Half of a line between ends at one height, from its lowest point."""

    sag: float  # m
    thrust: float  # N, horizontal, positive where the ends are pulled together
    tension: Array  # N, along the line
    curvature: Array  # 1/m


def elasticae(span: float, axial: float) -> list[Elastica]:
    """The rods of all stiffnesses, each found from the one before, the first from the catenary.

    With tension T = H cos(theta) + w s sin(theta) and moment M = EI theta': M' = (1 + T/EA) (H sin - w s cos)(theta).
    """
    s = HALF * (1.0 - np.linspace(1.0, 0.0, 401) ** 2)  # close together at the end, where the least stiff turns
    chain = elastic_catenary(span=span, height=0.0, length=LENGTH, weight=WEIGHT, axial_stiffness=axial)
    place, H = chain.position(s + HALF), float(chain.tension(np.array([HALF]))[0])
    angle = np.arctan(WEIGHT * s / H)
    y = np.stack([place[:, 0] - 0.5 * span, place[:, 1] + chain.sag, angle, STIFFNESSES[0] * np.gradient(angle, s)])
    given, found = np.array([H]), []
    for stiffness in STIFFNESSES:

        def slope(s: Array, y: Array, p: Array, stiffness: float = stiffness) -> Array:
            c, z = np.cos(y[2]), np.sin(y[2])
            longer = 1.0 + (p[0] * c + WEIGHT * s * z) / axial
            return np.stack([longer * c, longer * z, y[3] / stiffness, longer * (p[0] * z - WEIGHT * s * c)])

        def ends(low: Array, end: Array, _: Array) -> Array:
            return np.array([*low[:3], end[0] - 0.5 * span, end[3]])

        solved = solve_bvp(slope, ends, s, y, given, tol=1e-8, max_nodes=100_000)
        assert solved.success
        s, y, given = solved.x, solved.y, solved.p
        tension = given[0] * np.cos(y[2]) + WEIGHT * s * np.sin(y[2])
        found.append(Elastica(float(y[1, -1]), float(given[0]), tension, y[3] / stiffness))
    return found


def line(span: float, stiffness: float, elements: int, axial: float) -> Scenario:
    line = {"start": [0, 0], "end": [span, 0], "length": LENGTH, "mass": 1.0, "axial_stiffness": axial}
    line |= {"bending_stiffness": stiffness, "elements": elements}
    return Scenario.model_validate({"lines": {"line": line}, "run": {"kind": "equilibrium"}})


def rest(span: float, stiffness: float, elements: int, axial: float) -> xr.Dataset:
    found = simulate(line(span, stiffness, elements, axial))
    assert found.attrs["outcome"] == "completed"
    return found


def misses(found: xr.Dataset, exact: Elastica) -> list[float]:
    """Relative errors of the sag, and of the horizontal force by the forces there are."""
    sag, thrust = -float(found.position.values[0, :, 1].min()), -float(found.reaction[0, 0, 0])
    return [sag / exact.sag - 1.0, (thrust - exact.thrust) / max(abs(exact.thrust), WEIGHT)]


@pytest.mark.parametrize("span", SPANS)
def test_slack_lines_of_all_stiffnesses_rest_at_the_minimum_that_is_the_elastica(span: float) -> None:
    """EA = 100 kN, 80 links; 25 of 25 with those of the other spans."""
    for stiffness, exact in zip(STIFFNESSES, elasticae(span, 1e5), strict=True):
        found = rest(span, stiffness, 80, 1e5)
        miss = misses(found, exact)
        # Nodes without rotations bend as r'' says, which grows where links are longer: they bear EI times the squared
        # curvature less than the elastica, and are shorter by that over EA. Of a thin line it is nothing; the thickest
        # here has a radius of gyration of 0.3 m, and sags less by a part (pi 0.3 m / L)^2.
        thick = (np.pi / LENGTH) ** 2 * stiffness / 1e5
        least, explained = float(found.tension.min()), float(exact.tension.min())
        unstable = spectrum_of(line(span, stiffness, 40, 1e5), how_many=3).unstable
        print(f"EI {stiffness:g}: errors {miss}, thick {thick:.1e}, tension {least:.2f} ({explained:.2f}), {unstable}")
        assert unstable == 0  # in no direction in space does it give way
        assert abs(miss[0]) < 2e-4 + thick  # the mesh, and that
        z = found.position.values[0, :, 1]
        assert np.abs(z - z[::-1]).max() < 1e-8  # nothing is folded to one side
        # No link is pressed but by bending; in a fold it would be by kN.
        assert least > explained - 2e-2 * (WEIGHT * HALF + abs(explained))
        if stiffness <= 1.0:
            assert least > 0.0
        assert found.tension.values[0, 40] == pytest.approx(
            exact.tension[0], abs=2e-2 * (WEIGHT * HALF + abs(explained))
        )


@pytest.mark.parametrize("span", [14.0, 18.0])
def test_slack_lines_converge_to_the_elastica_with_the_second_order(span: float) -> None:
    """Lines that hardly stretch, however thick: sag and horizontal force, tension or thrust."""
    for stiffness, exact in zip(STIFFNESSES, elasticae(span, 1e9), strict=True):
        errors = np.array([misses(rest(span, stiffness, elements, 1e9), exact) for elements in (40, 80, 160)])
        order = np.log2(np.abs(errors[:-1] / errors[1:]))
        print(f"EI {stiffness:g}: errors {errors.ravel()}, orders {order.ravel()}")
        assert np.abs(errors[-1]).max() < 2e-4
        known = np.abs(errors[-1]) > 1e-6  # collocation is as good as that
        assert known[0]
        assert np.abs(order[:, known] - 2.0).max() < 0.03
