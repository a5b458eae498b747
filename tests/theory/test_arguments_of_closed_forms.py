"""Closed forms refuse what is no number, with the name and what was given."""

from __future__ import annotations

import numpy as np
import pytest

from ropewalk.theory import _arguments


@pytest.mark.parametrize("junk", ["5", None, 10**400, np.nan, np.inf, -1.0, [1.0, 2.0], {}])
def test_what_is_no_positive_number_is_refused_by_name(junk):
    for check in (_arguments.positive, _arguments.not_negative):
        with pytest.raises(ValueError, match="mass must be finite and"):
            check(mass=junk)


@pytest.mark.parametrize("junk", ["5", None, 10**400, [1.0, np.nan]])
def test_what_is_not_finite_is_refused_by_name(junk):
    with pytest.raises(ValueError, match="place must be finite, not"):
        _arguments.finite(place=junk)
