"""Forces on coordinates of bodies that change in time, outside of kernels (`bodies.pushed_with` is the same there)."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.system.loads.bodies import BodyArrays


def pushes_at(bodies: BodyArrays, t: float) -> Array:
    """Forces that change in time, at time t in s, (coordinate,) N."""
    found = np.zeros(bodies.mass.size)
    for pushed in bodies.pushed:
        part = slice(int(pushed["first"]), int(pushed["first"] + pushed["count"]))
        found[int(pushed["coordinate"])] += np.interp(t, bodies.push_time[part], bodies.push_value[part])
    return found
