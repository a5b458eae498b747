"""The point of a contact on its line: where it is, the direction of the line there, and how that turns."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import lean_inner
from ropewalk.system.elements.spline import WIDTH

# Length of the derivative by s, below which a line that is crushed loses its direction.
CRUSHED = 0.5


@lean_inner
def locate_point(structure, contacts, k, r, has_body):
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
    contacts[k].spread, contacts[k].spreading = spread, back / spread
    contacts[k].aligned, contacts[k].aligning = 1.0, 0.0
    if has_body and spread < CRUSHED:
        x = spread / CRUSHED
        contacts[k].aligned, contacts[k].aligning = x * x * (2.0 - x * x), 4.0 * x * (1.0 - x * x) / CRUSHED
    contacts[k].p[axes - 1] += contacts[k].rough
    contacts[k].along[axes - 1] += contacts[k].steep
