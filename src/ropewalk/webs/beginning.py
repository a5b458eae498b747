"""Beginnings of motion other than rest: a mode of a web, and a stored instant."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from ropewalk.errors import RopewalkError
from ropewalk.model.beginning import UP
from ropewalk.model.line import spatial
from ropewalk.model.run import Start
from ropewalk.results.stored import stored_instant
from ropewalk.solve.mode_of_structure import mode_of
from ropewalk.webs.laying import Laid
from ropewalk.webs.potential import Potential
from ropewalk.webs.rest import size_of
from ropewalk.webs.web import Integers, State

_AWAY = 1e-9  # of the size of a web: what is held this close is where it was


def begin_elsewhere(laid: Laid, state: State, start: Start, shown: Integers, axes: list[int]) -> None:
    """Put a web at rest, without its loads, into a mode or to where it was at a stored instant; the state is changed.

    Args:
        laid: the web.
        state: of rest.
        start: what the motion begins with.
        shown: (shown,) nodes in the order of results.
        axes: of results, numbers of x, y, z.

    Raises:
        RopewalkError: there is no such mode, or the file does not fit.
    """
    web, nodes = laid.web, laid.web.nodes
    if start.kind == "result":
        position, velocity = (values.T for values in stored_instant(start, shown.size, len(axes)))
        held = web.held.fixed[web.held.fixed < nodes]
        rest = state.r.copy()
        for column, a in enumerate(axes):
            state.r[shown, a], state.v[shown, a] = position[:, column], velocity[:, column]
        away = float(np.abs(state.r - rest)[held].max(initial=0.0))
        if away > _AWAY * size_of(rest[:nodes]):
            raise RopewalkError(
                f"{start.file}: a support stands {away:.3g} m elsewhere in the stored result; use the same lines and "
                "nets"
            )
        return
    assert start.amplitude is not None
    potential, way = Potential(web), np.array(spatial(start.direction or UP))
    free = potential.free
    if laid.plane:
        free = free[:, np.flatnonzero(potential.in_plane())]
    K = potential.stiffness(state.r)
    if laid.plane:
        inner = np.flatnonzero(potential.in_plane())
        K = K[inner][:, inner]
    M = free.T @ sparse.diags(np.repeat(web.body.mass, 3)) @ free
    on = None
    if start.line is not None:
        on = np.zeros(web.body.mass.size, dtype=np.bool_)
        for strand in laid.strands:
            if strand.name == start.line:
                on[strand.node] = True
    K = (0.5 * (K + K.T)).tocsc()
    state.r[:] += start.amplitude * mode_of(K, M.tocsc(), free, start.number or 1, way, on)
