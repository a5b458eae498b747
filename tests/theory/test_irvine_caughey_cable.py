"""Irvine and Caughey, The linear theory of free vibrations of a suspended cable, Proc. R. Soc. A 341 (1974)."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from ropewalk.theory import cable

CABLE = {"span": 100.0, "mass": 2.0, "horizontal_tension": 5e3, "axial_stiffness": 1e6}
UNIT = {"span": 1.0, "mass": 1.0, "horizontal_tension": 1.0}


@pytest.mark.parametrize(
    ("lambda_squared", "mode", "over_pi"),
    [
        (1.0, 1, 1.04020048680914),
        (4.0, 1, 1.15182280543743),
        (10.0, 1, 1.34512451139044),
        (4 * np.pi**2, 1, 2.0),
        (100.0, 1, 2.59718454463479),
        (16 * np.pi**2, 1, 2.73748578713851),
        (16 * np.pi**2, 2, 4.0),
        (np.inf, 1, 2.86059330624841),
    ],
)
def test_symmetric_frequencies_are_those_of_the_catalogue(lambda_squared: float, mode: int, over_pi: float) -> None:
    found = cable.natural_frequencies(modes=mode, lambda_squared=lambda_squared, **UNIT)
    assert found.symmetric[-1] / np.pi == pytest.approx(over_pi, abs=6e-15)  # 15 digits are given


def galerkin(lambda_squared: float, sines: int) -> NDArray[np.float64]:
    """omega-bar of the symmetric modes by sines: w'' + omega^2 w = lambda^2 * integral of w."""
    n = 2.0 * np.arange(sines) + 1.0
    area = np.sqrt(2.0) * 2.0 / (n * np.pi)
    return np.sqrt(np.linalg.eigvalsh(np.diag((n * np.pi) ** 2) + lambda_squared * np.outer(area, area)))


@pytest.mark.parametrize("lambda_squared", [0.0, 3.0, 60.0, 1e4])
def test_symmetric_frequencies_agree_with_galerkin(lambda_squared: float) -> None:
    found = cable.natural_frequencies(modes=4, lambda_squared=lambda_squared, **UNIT).symmetric
    # the sum over left-out sines falls as n^-3, times the strongest stretch
    assert found == pytest.approx(galerkin(lambda_squared, 150)[:4], rel=1e-5)


@settings(deadline=None)
@given(st.floats(0.0, 1e6), st.floats(0.0, 1e6))
def test_symmetric_frequencies_rise_with_the_parameter_within_their_intervals(first: float, second: float) -> None:
    low, high = cable.symmetric_roots(sorted([first, second]), modes=6)
    n = np.arange(1, 7)
    assert np.all(low <= high)
    assert np.all(low >= (n - 0.5) * np.pi)
    assert np.all(high <= (n + 0.5) * np.pi)


def test_parameter_follows_from_sag_or_tension() -> None:
    by_tension = cable.irvine_parameter(**CABLE)
    sag = 2.0 * 9.81 * 100.0**2 / (8 * 5e3)
    across = 2.0 * 9.81 * 100.0 / 5e3
    expected = across**2 * 100.0 / (5e3 * 100.0 * (1 + 8 * (sag / 100.0) ** 2) / 1e6)
    assert by_tension == pytest.approx(expected, rel=1e-14)
    by_sag = cable.irvine_parameter(span=100.0, mass=2.0, sag=sag, axial_stiffness=1e6)
    assert by_sag == pytest.approx(expected, rel=1e-14)
    steep = cable.irvine_parameter(inclination=0.5, **CABLE)
    lean = (across * np.cos(0.5)) ** 2
    assert steep == pytest.approx(lean * 1e6 / (5e3 * (1 + lean / 8)), rel=1e-14)
    inclined_sag = sag * np.cos(0.5)
    assert cable.irvine_parameter(
        span=100.0, mass=2.0, sag=inclined_sag, axial_stiffness=1e6, inclination=0.5
    ) == pytest.approx(steep, rel=1e-14)


def test_frequencies_carry_units_of_the_taut_string() -> None:
    found = cable.natural_frequencies(modes=3, **CABLE)
    unit = np.pi / 100.0 * np.sqrt(5e3 / 2.0)
    assert found.out_of_plane == pytest.approx(unit * np.arange(1, 4))
    assert found.antisymmetric == pytest.approx(2 * unit * np.arange(1, 4))
    assert found.symmetric == pytest.approx(
        2 / np.pi * unit * cable.symmetric_roots(cable.irvine_parameter(**CABLE), modes=3)
    )
    assert np.all(np.diff(found.in_plane) > 0.0)
    assert found.in_plane.shape == (6,)
    many = cable.natural_frequencies(modes=3, lambda_squared=[[1.0], [2.0]], **UNIT)
    assert many.symmetric.shape == (2, 1, 3)
    assert many.in_plane.shape == (2, 1, 6)


def test_limits_are_the_taut_string_and_the_inextensible_cable() -> None:
    taut = cable.natural_frequencies(modes=3, gravity=0.0, **CABLE)
    assert taut.symmetric == pytest.approx(taut.out_of_plane[0] * np.array([1.0, 3.0, 5.0]), rel=1e-14)
    stiff = cable.natural_frequencies(modes=3, **(CABLE | {"axial_stiffness": np.inf}))
    x = stiff.symmetric * 50.0 * np.sqrt(2.0 / 5e3)
    assert np.tan(x) == pytest.approx(x, rel=1e-12)  # steepness of the tangent
    assert cable.irvine_parameter(**(CABLE | {"axial_stiffness": np.inf})) == np.inf
    assert cable.irvine_parameter(**(CABLE | {"axial_stiffness": np.inf}), gravity=0.0) == 0.0
    assert cable.symmetric_roots(1e-300, modes=1) == pytest.approx(np.pi / 2)
    assert cable.symmetric_roots(1e300, modes=1) == pytest.approx(4.493409457909064)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"span": 0.0}, "^span must"),
        ({"mass": -1.0}, "^mass must"),
        ({"horizontal_tension": 0.0}, "^horizontal_tension must"),
        ({"horizontal_tension": None}, "horizontal_tension or sag"),
        ({"sag": 1.0}, "horizontal_tension or sag"),
        ({"axial_stiffness": 0.0}, "^axial_stiffness must"),
        ({"axial_stiffness": None}, "axial_stiffness or lambda_squared"),
        ({"axial_stiffness": None, "lambda_squared": -1.0}, "^lambda_squared must"),
        ({"axial_stiffness": None, "lambda_squared": np.nan}, "^lambda_squared must"),
        ({"modes": 0}, "^modes must"),
        ({"gravity": -1.0}, "^gravity must"),
        ({"inclination": 1.6}, "^inclination must"),
        ({"horizontal_tension": None, "sag": 0.0}, "^sag must"),
    ],
)
def test_nonsense_is_refused(changed: dict[str, float], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        cable.natural_frequencies(**({"modes": 2} | CABLE | changed))
