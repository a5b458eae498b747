"""Frequencies and deflection of lines whose tension varies: hanging chain, heavy column, and constant tension."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import j0, jn_zeros, y0

from ropewalk.theory import beam, string, varying_tension


def test_hanging_chain_is_that_of_bernoulli() -> None:
    computed = varying_tension.natural_frequencies(
        6, length=3.0, mass=0.7, tension=lambda x: 0.7 * 9.81 * (3.0 - x), ends="hanging"
    )
    assert computed == pytest.approx(0.5 * jn_zeros(0, 6) * math.sqrt(9.81 / 3.0), rel=1e-11)  # rounding


def test_line_held_at_both_ends_under_its_weight() -> None:
    """T = T0 + m g x: Bessel functions of 2 omega sqrt(T/m)/g."""
    low, length, mass, gravity = 40.0, 30.0, 1.2, 9.81

    def condition(omega: float) -> float:
        a, b = (2.0 * omega * math.sqrt(t / mass) / gravity for t in (low, low + mass * gravity * length))
        return float(j0(a) * y0(b) - j0(b) * y0(a))

    grid = np.linspace(0.05, 7.0, 400)
    signs = np.array([condition(w) for w in grid])
    roots = [
        brentq(condition, a, b, xtol=1e-14)
        for a, b, s, t in zip(grid[:-1], grid[1:], signs[:-1], signs[1:], strict=True)
        if s * t < 0
    ]
    computed = varying_tension.natural_frequencies(
        4, length=length, mass=mass, tension=lambda x: low + mass * gravity * x
    )
    assert computed == pytest.approx(roots[:4], rel=1e-10)


@pytest.mark.parametrize("kind", ["simply_supported", "clamped"])
def test_constant_tension_is_the_uniform_beam(kind: str) -> None:
    line = {"length": 2.0, "mass": 1.5, "bending_stiffness": 3.0, "foundation": 11.0, "ends": kind}
    computed = varying_tension.natural_frequencies(5, tension=lambda x: 20.0, **line)
    assert computed == pytest.approx(beam.natural_frequencies(5, tension=20.0, **line), rel=1e-10)


def test_constant_tension_without_stiffness_is_the_string() -> None:
    computed = varying_tension.natural_frequencies(5, length=2.0, mass=1.5, tension=lambda x: 6.0)
    c = string.wave_speed(tension=6.0, mass=1.5)
    assert computed == pytest.approx(np.arange(1, 6) * np.pi * c / 2.0, rel=1e-11)


def test_heavy_column_buckles_where_timoshenko_says() -> None:
    """Theory of Elastic Stability, 2.12: hinged ends, (q L) = 18.6 EI/L^2."""
    line = {"length": 1.0, "mass": 1.0, "bending_stiffness": 1.0}
    below, above = (lambda x, q=q: -q * (1.0 - x) for q in (18.5, 18.6))
    assert varying_tension.natural_frequencies(1, tension=below, **line)[0] < 1.0
    with pytest.raises(ValueError, match="buckles"):
        varying_tension.natural_frequencies(1, tension=above, **line)


def test_deflection_under_weight() -> None:
    x = np.linspace(0.0, 2.0, 9)
    sag = varying_tension.deflection(x, load=lambda x: 3.0, length=2.0, tension=lambda x: 5.0)
    assert sag == pytest.approx(3.0 * x * (2.0 - x) / 10.0, abs=1e-14)
    # T = 1 + x, one load: (T w')' = -1, w = A ln(1 + x) - x + A-free part, A = 2/ln 3 + ... from w(2) = 0
    sloped = varying_tension.deflection(x, load=lambda x: 1.0, length=2.0, tension=lambda x: 1.0 + x)
    assert sloped == pytest.approx(2.0 / math.log(3.0) * np.log1p(x) - x, abs=1e-10)
    restrained = varying_tension.deflection(
        1.0, load=lambda x: 1.0, length=2.0, tension=lambda x: 0.0 * x, bending_stiffness=1.0, ends="clamped"
    )
    assert restrained == pytest.approx(16.0 / 384.0, rel=1e-12)
    assert restrained.shape == ()


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"length": 0.0}, r"^length must"),
        ({"mass": 0.0}, r"^mass must"),
        ({"tolerance": 0.0}, r"^tolerance must"),
        ({"count": 0}, r"^count must"),
        ({"ends": "loose"}, r"^ends must"),
        ({"foundation": -1.0}, r"^foundation must"),
        ({"tension": lambda x: -x}, r"^tension must be positive inside"),
        ({"tension": lambda x: np.full_like(x, np.nan)}, r"^tension must be finite"),
        ({"tension": lambda x: 1.0 + (x > 0.3), "tolerance": 1e-13}, r"^tolerance 1e-13 is not reached"),
    ],
)
def test_nonsense_is_refused(changed: dict[str, object], said: str) -> None:
    arguments = {"count": 2, "length": 1.0, "mass": 1.0, "tension": lambda x: 1.0} | changed
    count = arguments.pop("count")
    with pytest.raises(ValueError, match=said):
        varying_tension.natural_frequencies(count, **arguments)
