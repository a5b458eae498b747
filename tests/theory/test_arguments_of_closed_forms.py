"""Closed forms refuse what is no number, and numbers of which powers overflow, with the name and what was given."""

from __future__ import annotations

import numpy as np
import pytest

from ropewalk.theory import _arguments, periodic

SPAN = {"spacing": 10.0, "mass": 1.0, "support_stiffness": 1e3, "tension": 1e3, "bending_stiffness": 1e3}


@pytest.mark.parametrize("junk", ["5", None, 10**400, np.nan, np.inf, -1.0, [1.0, 2.0], {}])
def test_what_is_no_positive_number_is_refused_by_name(junk):
    for check in (_arguments.positive, _arguments.not_negative):
        with pytest.raises(ValueError, match="mass must be finite and"):
            check(mass=junk)


@pytest.mark.parametrize("junk", ["5", None, 10**400, [1.0, np.nan]])
def test_what_is_not_finite_is_refused_by_name(junk):
    with pytest.raises(ValueError, match="place must be finite, not"):
        _arguments.finite(place=junk)


@pytest.mark.parametrize("bending_stiffness", [0.0, 1e3])
@pytest.mark.parametrize(
    ("name", "value"),
    [("spacing", 1e-300), ("spacing", 1e300), ("tension", 1e300), ("tension", 1e-200), ("mass", 1e-320)],
)
def test_spans_beyond_all_numbers_are_refused_at_once(name, value, bending_stiffness):
    """A spacing of 1e-300 m was searched for ever."""
    line = SPAN | {"bending_stiffness": bending_stiffness, name: value}
    with pytest.raises(ValueError, match=f"{name} .*beyond the range of computers"):
        periodic.band_diagram(**line)
    with pytest.raises(ValueError, match=f"{name} .*beyond the range of computers"):
        periodic.pass_bands(highest=1.0, **line)
