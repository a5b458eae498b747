"""Elementary functions of the core: within 2 units in the last place, and the same bits everywhere."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest
from numpy.typing import NDArray

from ropewalk.engine.library import Elementary, elementary, variants

Array = NDArray[np.float64]
BITS = "b7219909aa3518e5"
"""Hash of all values below: of every processor, compiler and variant."""
PRECISE = pytest.mark.skipif(np.finfo(np.longdouble).nmant < 63, reason="long doubles have no more digits here")


def cases() -> dict[str, tuple[Elementary, Array, Array]]:
    """Arguments over all sizes, near zeros and poles, beside multiples of pi/2, and of large angles."""
    draw, count = np.random.default_rng(1), 20_000
    sizes = np.ldexp(draw.uniform(1.0, 2.0, count), draw.integers(-960, 960, count))  # without a function of libm
    ratio, sign = draw.uniform(0.0, 1.0, count), draw.choice([-1.0, 1.0], count)
    zero, near = np.zeros(count), 1.0 + 1e-3 * draw.uniform(-1.0, 1.0, count)
    quarters = draw.integers(1, 2**40, count) * (0.5 * np.pi)
    return {
        "exp": ("exp", draw.uniform(-700.0, 709.0, count), zero), "exp of small": ("exp", near - 1.0, zero),
        "log": ("log", sizes, zero), "log near 1": ("log", near, zero), "log of ratios": ("log", 0.5 + ratio, zero),
        "sin": ("sin", 8.0 * sign * ratio, zero), "sin of large": ("sin", sign * sizes, zero),
        "sin near zeros": ("sin", quarters, zero), "sin of times": ("sin", 3e6 * ratio, zero),
        "cos": ("cos", 8.0 * sign * ratio, zero), "cos of large": ("cos", sign * sizes, zero),
        "cos near zeros": ("cos", quarters, zero), "cos of times": ("cos", 3e6 * ratio, zero),
        "atan2": ("atan2", draw.uniform(-1.0, 1.0, count), draw.uniform(-1.0, 1.0, count)),
        "atan2 of sizes": ("atan2", sign * sizes, np.sqrt(sizes[::-1])),
        "atan2 of ratios": ("atan2", ratio, zero + 1.0),
        "pow": ("pow", 0.5 + ratio, draw.uniform(-500.0, 500.0, count)),
        "pow near 1": ("pow", 1.0 + 1e-3 * (near - 1.0), 1e6 * ratio),
        "pow of contacts": ("pow", 10.0 * ratio, draw.choice([1.5, 2.0 / 3.0, 0.5, 2.0], count)),
    }  # fmt: skip


CASES = cases()
SPECIAL = np.array(
    [0.0, -0.0, 1.0, -1.0, np.inf, -np.inf, np.nan, 5e-324, 1e-310, 1e308, -2.5, -3.0, 2.0, 0.5, 709.78, -745.0]
)


def of_numpy(name: Elementary, x: Array, y: Array) -> Array:
    with np.errstate(all="ignore"):
        if name in ("atan2", "pow"):
            return np.asarray({"atan2": np.arctan2, "pow": np.power}[name](x, y))
        return np.asarray(getattr(np, name)(x))


@PRECISE
@pytest.mark.parametrize("name", CASES)
def test_errors_are_below_two_units_in_the_last_place(name: str) -> None:
    function, x, y = CASES[name]
    exact = of_numpy(function, x.astype(np.longdouble), y.astype(np.longdouble))
    size = np.abs(exact)
    seen = (size > 1e-305) & (size < 1e305)
    units = np.abs(elementary(function, x, y) - exact)[seen] / np.spacing(size[seen].astype(float))
    assert seen.sum() > 0.9 * seen.size
    assert float(units.max()) < 2.0


@pytest.mark.parametrize("function", ["exp", "log", "sin", "cos", "atan2", "pow"])
def test_limits_are_those_of_c(function: Elementary) -> None:
    x, y = (grid.ravel() for grid in np.meshgrid(SPECIAL, SPECIAL))
    found, expected = elementary(function, x, y), of_numpy(function, x, y)
    is_number = ~np.isnan(expected)
    np.testing.assert_array_equal(np.isnan(found), ~is_number)
    np.testing.assert_allclose(found[is_number], expected[is_number], rtol=5e-16, atol=5e-324)
    if function == "atan2":
        np.testing.assert_array_equal(np.signbit(found), np.signbit(expected))


def test_bits_are_the_same_on_every_platform_and_in_every_variant() -> None:
    for variant in variants():
        found = hashlib.sha256()
        for function, x, y in CASES.values():
            found.update(elementary(function, x, y, variant).tobytes())
        assert found.hexdigest()[:16] == BITS, variant
