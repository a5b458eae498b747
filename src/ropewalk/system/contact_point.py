"""The point of a contact on its line: where it is, the direction of the line there, and how that turns."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import lean_inner
from ropewalk.system.spline import WIDTH


@lean_inner
def locate_point(structure, contacts, k, r):
    """Note the point of the spline at contact k, which is at its place s, and the direction of the line there."""
    run, base, axes = contacts[k].run, contacts[k].near, r.shape[0]
    h, most = structure.runs.h[run], min(WIDTH, structure.runs.links[run] + 1)
    square, back = 0.0, 0.0
    for a in range(axes):
        here, slope, second = 0.0, 0.0, 0.0
        for j in range(most):
            here += contacts[k].weight[j] * r[a, base + j]
            slope += contacts[k].slope[j] * r[a, base + j]
            second += contacts[k].second[j] * r[a, base + j]
        contacts[k].p[a], contacts[k].along[a] = here, slope / h
        contacts[k].tangent[a], contacts[k].turns[a] = slope / h, second / (h * h)
        square += contacts[k].tangent[a] ** 2
        back += contacts[k].tangent[a] * contacts[k].turns[a]
    square = max(square, 1e-300)
    spread = np.sqrt(square)
    for a in range(axes):
        contacts[k].turns[a] = (contacts[k].turns[a] - back / square * contacts[k].tangent[a]) / spread
        contacts[k].tangent[a] /= spread
    contacts[k].spread = spread
    contacts[k].p[axes - 1] += contacts[k].rough
    contacts[k].along[axes - 1] += contacts[k].steep
