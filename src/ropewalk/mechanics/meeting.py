"""When two loads on one line have met: closer together than the pieces of line between them allow."""

from __future__ import annotations

from ropewalk.mechanics.bodies import FREE
from ropewalk.mechanics.chain import OFF, SHARED
from ropewalk.mechanics.compiled import lean

# Wheels on one line meet when they are closer than this part of a link, at the mass of a link or less than that of a
# wheel; between heavier wheels a shorter piece is still no stiffer than a step allows. Sliding wheels come no closer
# to others than 0.02 of the way between them and the next point, but have met before: they shorten the piece between
# within few steps, and its energy with it.
MET, LEAST_MET, LEAST_MET_SLIDING = 0.25, 0.03, 0.1
# A contact without a place of its own meets a heavy wheel within these parts of a link: if it rides with a node, which
# must not come closer; if it is shared by two nodes, which the wheel must not take.
MET_MOVING_WITH, MET_SHARED = 0.25, 1.0


@lean
def have_met(strands, loads, state, bodies):
    """Whether two loads have met, of which one at least has a place of its own."""
    for p in range(bodies.ordered[0]):
        k = bodies.order[p]
        s, xi = loads.strand[k], state.xi[k]
        h = strands.h[s]
        if p > 0 and loads.strand[bodies.order[p - 1]] == s:
            j = bodies.order[p - 1]
            node, mass = strands.rho[s] * h, min(bodies.wheels[j].mass[0], bodies.wheels[k].mass[0])
            slides = bodies.wheels[j].travel == FREE or bodies.wheels[k].travel == FREE
            least = LEAST_MET_SLIDING if slides else LEAST_MET
            if xi - state.xi[j] < h * min(max(MET * node / mass, least), MET):
                return True
        for j in range(state.xi.size):
            least = MET_SHARED if state.moving_load[j] == SHARED else MET_MOVING_WITH
            if state.moving_load[j] > OFF and loads.strand[j] == s and abs(state.xi[j] - xi) < h * least:
                return True
    return False
