"""Quantities as text: exact, without a unit registry for everyday units, and closed to mischief."""

from __future__ import annotations

import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ropewalk.errors import Refused
from ropewalk.units import to_si, written

READ = [
    ("100 kN", "N", 100e3),
    ("72 km/h", "m/s", 20.0),
    ("1.35 kg/m", "kg/m", 1.35),
    ("50 N*s", "N*s", 50.0),
    ("50 N s", "N*s", 50.0),
    ("50 N·s", "N*s", 50.0),
    ("9.81 m/s^2", "m/s^2", 9.81),
    ("9.81 m/s**2", "m/s^2", 9.81),
    ("9.81 m/s²", "m/s^2", 9.81),
    ("9.81 m s^-2", "m/s^2", 9.81),
    ("−800 N", "N", -800.0),
    ("19.5m", "m", 19.5),
    ("10 ms", "s", 0.01),
    ("10 µs", "s", 1e-5),
    ("0.1 1/s", "1/s", 0.1),
    ("0.1/s", "1/s", 0.1),
    ("2 Hz", "1/s", 2.0),
    ("2 %", "dimensionless", 0.02),
    ("1e5", "N", 1e5),
    (1e5, "N", 1e5),
    (100000, "N", 1e5),
    (".5 m", "m", 0.5),
    ("+1. m", "m", 1.0),
    ("3 ft", "m", 0.9144),
    ("1 lbf", "N", 4.4482216152605),
    ("12 kg/km", "kg/m", 0.012),
    ("100 kg*m/s^2", "N", 100.0),
    ("0 m", "m", 0.0),
    ("2 furlong", "m", 402.336804673),  # a unit that only the registry knows
    (np.float32(0.5), "m", 0.5),
    (np.int64(3), "m", 3.0),
    (Fraction(1, 4), "m", 0.25),
]


@pytest.mark.parametrize(("value", "unit", "number"), READ, ids=[f"{v!r} is {n:g} {u}" for v, u, n in READ])
def test_reads(value: object, unit: str, number: float) -> None:
    exact = "furlong" not in str(value)
    assert to_si(value, unit) == (number if exact else pytest.approx(number, rel=1e-9))


REFUSED = [
    ("5 kN/m", "N", "kN/m does not fit: expected a force; write it in N"),
    ("20 degC", "m", "expected a length"),
    ("20 K", "m", "K does not fit"),
    ("981 N", "kg", "N does not fit: expected a mass; write it in kg: 100 kg weigh as much"),
    ("nan m", "m", "cannot be read"),
    ("nan", "m", "cannot be read"),
    ("inf", "m", "cannot be read"),
    ("1e400 m", "m", "too large"),
    ("1e29 km", "m", "too large"),
    ("1e308 km", "m", "too large"),
    (float("nan"), "m", "not nan"),
    (10**400, "m", "too large"),
    (True, "m", "expected a length"),
    (None, "m", "expected a length"),
    ([1], "m", "expected a length"),
    (1j, "m", "expected a length"),
    ("", "m", "cannot be read"),
    ("m", "m", "cannot be read"),
    ("1,5 m", "m", "decimal point"),
    ("1_000 m", "m", "no separators"),
    ("1 m m", "m", "does not fit"),
    ("1 m^9^9", "m", "the unit cannot be read"),
    ("1 m)", "m", "the unit cannot be read"),
    ("1 __import__('os')", "m", "the unit cannot be read"),
    ("9**9**9 m", "m", "the unit cannot be read"),
    ("1 metr", "m", "unknown unit"),
    ("1 KN", "N", "did you mean kN"),
    ("5 Ns", "N*s", "did you mean"),
]


@pytest.mark.parametrize(("value", "unit", "words"), REFUSED, ids=[f"{str(r[0])[:20]}, {r[2]}" for r in REFUSED])
def test_refuses(value: object, unit: str, words: str) -> None:
    with pytest.raises(Refused) as caught:
        to_si(value, unit)
    assert words in str(caught.value)
    assert caught.value.remedy


@given(st.floats(-1e30, 1e30), st.sampled_from(["m", "N*s", "m/s^2", "dimensionless"]))
def test_what_is_written_reads_back_exactly(number: float, unit: str) -> None:
    assert to_si(written(number, unit), unit) == number


@given(st.text(max_size=30) | st.from_regex(r"[0-9.e+-]{1,8} ?[a-zA-Z%/*^0-9 ]{0,8}", fullmatch=True))
def test_no_text_escapes_with_another_error(text: str) -> None:
    try:
        number = to_si(text, "N")
    except Refused:
        return
    assert abs(number) <= 1e30


def test_everyday_units_do_not_import_the_registry_and_the_import_is_light() -> None:
    code = (
        "import sys; from ropewalk.scenario import load; load(sys.argv[1]);"
        "print(sorted({'pint', 'numba', 'scipy', 'xarray', 'matplotlib'} & set(sys.modules)))"
    )
    path = __file__.replace("\\", "/").rsplit("/tests/", 1)[0] + "/examples/moving-force.yaml"
    done = subprocess.run([sys.executable, "-c", code, path], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
