"""How far the links of a chain are strained at an instant: what a motion asks after every output, in one call."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import exact_inner, kernel
from ropewalk.mechanics.link import stretch

LENGTH, REST, STIFFNESS, TENSION = range(4)


@exact_inner
def find_extremes(first, links, laws, r, X, out):
    """Write what `strained` gives to `out`."""
    for s in range(first.size):
        p, total = laws[s], 0.0
        length, rest, stiffness, least = 0.0, 0.0, law.tangent(p, 0.0), np.inf
        for i in range(first[s], first[s] + links[s]):
            own, span = stretch(r, i), X[i + 1] - X[i]
            lam = own / span
            T = law.tension(p, lam - 1.0)
            total += own
            length, rest, least = max(length, own), max(rest, span), min(least, T)
            stiffness = max(stiffness, law.tangent(p, lam - 1.0), T / lam)
        out[s, LENGTH], out[s, REST], out[s, STIFFNESS], out[s, TENSION] = length, rest, stiffness, least
        if np.isnan(total):
            for k in range(out.shape[1]):
                out[s, k] = np.nan


@kernel
def strained(first, links, laws, r, X):
    """Extremes over the links of each strand, (strand, 4), NaN where one is; to the last bit those of NumPy.

    They are the largest length in m, the largest unstrained one in m, the largest stiffness in N, T' or T/lam, and the
    smallest tension in N.

    Args:
        first, links: (strand,) first node and number of links.
        laws: (strand, parameter) numbers of their laws, see mechanics/law.py.
        r: (axis, node) m, positions.
        X: (node,) m, material coordinates.
    """
    out = np.empty((first.size, 4))
    find_extremes(first, links, laws, r, X, out)
    return out
