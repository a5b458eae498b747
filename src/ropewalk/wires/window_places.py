"""What a window on wires is around: contacts, and from then on ties that are cut."""

from __future__ import annotations

import numpy as np

from ropewalk.wires.mesh import Mesh
from ropewalk.wires.plan import Array, Integers
from ropewalk.wires.rest import ROUNDING
from ropewalk.wires.small_arrays import x_of


def window_places(mesh: Mesh, wires: Integers, stations: Array, until: float) -> Array:
    """Along x, what must move by itself up to an instant, (place,) m.

    Waves of a tie that is cut come from beyond a window around the contacts alone, which takes none for coming in.

    Args:
        mesh: the wires.
        wires: (contact,) on which contacts are.
        stations: (contact,) m, where.
        until: s.
    """
    cut = np.flatnonzero(mesh.ties.fails_at * (1.0 - ROUNDING) <= until)
    ties = mesh.ties.one
    contacts, ends = x_of(mesh, wires, stations), x_of(mesh, ties.wire[cut], ties.station[cut])
    return np.concatenate([contacts, ends])
