"""What a motion asks of its links after every output, beside the same as NumPy finds it."""

from __future__ import annotations

import numpy as np
import pytest

from ropewalk.mechanics.law import tangents, tensions
from ropewalk.solve.strained import strained

LAWS = {
    "linear": (0.0, -np.inf, 1e4, 0.0, 0.0),
    "tension only": (0.0, 0.0, 1e4, 0.0, 0.0),
    "cubic": (0.0, -np.inf, 1e4, 0.0, 3e6),
}


def twin(first, links, laws, r, X):
    rows = []
    for i, n, p in zip(first, links, laws, strict=True):
        d, rest = np.diff(r[:, i : i + n + 1], axis=1), np.diff(X[i : i + n + 1])
        length = np.sqrt((d * d).sum(axis=0))
        lam = length / rest
        slopes = [tangents(p, lam - 1.0).max(), tangents(p, np.zeros(1))[0], (tensions(p, lam - 1.0) / lam).max()]
        rows.append((length.max(), rest.max(), max(slopes), tensions(p, lam - 1.0).min()))
    return np.array(rows)


def chain(axes):
    rng = np.random.default_rng(3)
    first, links = np.array([0, 8]), np.array([7, 12])
    X = np.concatenate([np.arange(8.0), 0.5 * np.arange(13.0)])
    r = rng.normal(scale=0.05, size=(axes, 21))
    r[0] += X
    return first, links, r, X


@pytest.mark.parametrize("axes", [2, 3])
@pytest.mark.parametrize("law", LAWS)
def test_extremes_are_those_of_numpy_to_the_last_bit(axes, law):
    first, links, r, X = chain(axes)
    laws = np.array([LAWS[law], LAWS["linear"]])
    np.testing.assert_array_equal(strained(first, links, laws, r, X), twin(first, links, laws, r, X))


@pytest.mark.parametrize("node", [0, 4, 7])
def test_what_is_not_a_number_stays_none(node):
    first, links, r, X = chain(2)
    r[1, node] = np.nan
    found = strained(first, links, np.array([LAWS["linear"]] * 2), r, X)
    assert np.isnan(found[0]).all()
    assert np.isfinite(found[1]).all()
