"""Implicit motion: Radau IIA of order 5 with adaptive steps, the whole loop compiled.

For lines whose Kelvin-Voigt damping makes the explicit step too small (docs/notes/implicit.md). Steps end exactly at
the instants asked for, and where a load changes its location on the chain: to rounding for the measure `material`, else
within 2 AIM of a link, as the speed depends on a state that is not known before.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import CONTACT, FRICTIONLESS, MATERIAL, OFF, ChainState, Loads
from ropewalk.mechanics.compiled import inner, kernel
from ropewalk.mechanics.moving_contact import ARRIVED, look_up_integral, node_velocity, speed_at
from ropewalk.solve.collocation import (
    FACTORS,
    JACOBIANS,
    MOST_ITERATIONS,
    REJECTIONS,
    Workspace,
    balance,
    estimate,
    newton,
    prepare,
    settle_accounts,
    stage_of,
)
from ropewalk.solve.jacobian import linearise
from ropewalk.solve.radau_iia import A, C
from ropewalk.solve.splitting import (
    END_OF_LINE,
    NO_CONVERGENCE,
    NOT_FINITE,
    RUNNING,
    TOO_MANY_STEPS,
    _gap,
    _is_due,
    _is_finite,
    _take_locations,
    loss,
)

# Entries of the workspace's memory.
NOW, LENGTH, WISH, FACTORISED = 0, 1, 2, 3
# A step's error may be this part of the tolerance (measured: then the run keeps it), Newton's error this part of that;
# without a tolerance it is this part of the length of the lines.
LOCAL, NEWTON, ROUNDING = 0.01, 5e-4, 1e-13
# The stage about which the Jacobian is taken: inside the step, as the links beside a moving load turn far during one.
MIDDLE = 1
# A step is longer than the one before by this much at most, and no more often rejected in a row than this.
GROWTH, SAFETY, MOST_REJECTIONS = 2.0, 0.9, 60
# Steps of almost equal length share their factors where Newton's method contracts fast; where it is slow, the Jacobian
# has had its day.
SAME_LENGTH, FAST, SLOW = 0.02, 0.05, 0.1
# Loads whose speed depends on the state aim this part of a link beyond their next node. Those that come out shorter, or
# longer by as much again, try once more with the speed that they have seen, but not if it is still further away.
AIM, FURTHER, MOST_TRIES = 1e-4, 0.1, 4


def workspace_for(loads: Loads, state: ChainState) -> Workspace:
    """A workspace for `advance_implicit`, to be kept for the whole run: it remembers the last step.

    Raises:
        ValueError: a load has a frictionless contact.
    """
    if np.any(loads.contact == FRICTIONLESS):
        raise ValueError("the frictionless contact needs an explicit method")
    return Workspace.for_state(state)


@inner
def _time_to(loads, k, t, U, distance, within):
    """Time that load k needs for a distance if its measured speed keeps its ratio to d xi / dt; `within` if longer."""
    V = speed_at(loads, k, t)
    if V == 0.0 or loads.speed_count[k] == 1:
        return min(distance / abs(U), within)
    time, value, path = loads.speed_time, loads.speed_value, loads.speed_path
    first, count = loads.speed_first[k], loads.speed_count[k]
    begin = look_up_integral(time, value, path, first, count, t)
    low, high = 0.0, within
    if speed_at(loads, k, t + high) * V < 0.0:  # it turns round on the way: no further than there
        for _ in range(60):
            middle = 0.5 * (low + high)
            if speed_at(loads, k, t + middle) * V > 0.0:
                low = middle
            else:
                high = middle
    low, per = 0.0, abs(U / V) * np.sign(V)
    if per * (look_up_integral(time, value, path, first, count, t + high) - begin) <= distance:
        return high
    for _ in range(60):
        middle = 0.5 * (low + high)
        if per * (look_up_integral(time, value, path, first, count, t + middle) - begin) < distance:
            low = middle
        else:
            high = middle
    return high


@inner
def _reach(strands, loads, state, target, step_ratio, until):
    """Time to the next event: a change of location, or `until`."""
    t = state.t[0]
    rest = until - t
    for k in range(state.xi.size):
        U = state.speed[k]
        if state.moving_load[k] == OFF or U == 0.0:
            continue
        gap = _gap(target[k], state.xi[k], U)
        if gap > 0.0:
            if loads.measure[k] != MATERIAL:
                gap += AIM * strands.h[loads.strand[k]]
            rest = min(rest, _time_to(loads, k, t, U * step_ratio[k], gap, rest))
    return rest


@inner
def _misses(strands, loads, state, space, dt):
    """Whether a step brings a load close to its next node, but not quite there, or beyond; notes all step ratios."""
    missed = False
    for k in range(state.xi.size):
        U, way = state.speed[k], space.way[2, k]
        if state.moving_load[k] == OFF or loads.measure[k] == MATERIAL or not U * way > 0.0:
            continue
        h, before = strands.h[loads.strand[k]], space.step_ratio[k]
        gap = _gap(space.locations.target[k], state.xi[k], U)
        beyond = abs(way) - gap
        if gap > 0.0 and -FURTHER * h < beyond:
            planned = _time_to(loads, k, state.t[0], U * before, abs(way), 2.0 * dt)
            space.step_ratio[k] = min(max(before * planned / dt, 0.5), 2.0)
            missed = missed or beyond < 0.0 or beyond > 2.0 * AIM * h
    return missed


@inner
def _begin(strands, loads, state, space):
    """Node velocities and forces at the start of a step."""
    space.v[:] = state.w
    for k in range(state.moving_load.size):
        b = state.moving_load[k]
        if b >= 0:
            for a in range(state.r.shape[0]):
                space.v[a, b] = node_velocity(state, b, a)
    for s in range(strands.first.size):
        balance(strands, loads, state, space.q, s, space.f)


@inner
def _predict(strands, loads, state, space, dt, smooth):
    """First guess of the stages: the last step's polynomial, or constant velocity where there is none."""
    t, before = state.t[0], space.memory[LENGTH]
    smooth = smooth and dt <= GROWTH * before
    for j in range(3):
        space.t[j, 0] = t + C[j] * dt
        space.X[j, :] = state.X
        for k in range(state.xi.size):
            space.speed[j, k] = state.speed[k]
            space.xi[j, k] = state.xi[k] + C[j] * dt * state.speed[k]
            if state.moving_load[k] >= 0:
                space.X[j, state.moving_load[k]] = space.xi[j, k]
        l1, l2, l3 = 0.0, 0.0, 0.0
        if smooth:
            x = 1.0 + C[j] * dt / before
            l1 = x / C[0] * (x - C[1]) * (x - 1.0) / ((C[0] - C[1]) * (C[0] - 1.0))
            l2 = x / C[1] * (x - C[0]) * (x - 1.0) / ((C[1] - C[0]) * (C[1] - 1.0))
            l3 = x * (x - C[0]) * (x - C[1]) / ((1.0 - C[0]) * (1.0 - C[1])) - 1.0
        for a in range(state.r.shape[0]):
            z, v = space.Z[j, a], space.v[a]
            y1, y2, y3 = space.last[0, a], space.last[1, a], space.last[2, a]
            if smooth:
                for i in range(z.size):
                    z[i] = l1 * y1[i] + l2 * y2[i] + l3 * y3[i]
            else:
                for i in range(z.size):
                    z[i] = C[j] * dt * v[i]
            for k in range(state.xi.size):  # nodes that have changed their role are not where they were
                for b in (state.moving_load[k], space.location[k]):
                    if b >= 0 and state.moving_load[k] != space.location[k]:
                        z[b] = C[j] * dt * v[b]


@inner
def _accept(strands, loads, state, space, dt):
    """Go on to the end of the step."""
    for s in range(strands.first.size):
        settle_accounts(strands, loads, state, space, s, dt)
    for j in range(3):
        stage = stage_of(state, space, j)
        state.work[CONTACT] += dt * A[2, j] * loss(strands, loads, stage, stage.w)
    space.last[:] = space.Z
    for a in range(state.r.shape[0]):
        for s in range(strands.first.size):
            for i in range(strands.first[s] + 1, strands.first[s] + strands.links[s]):
                state.r[a, i] = space.r[2, a, i]
                state.w[a, i] = space.w[2, a, i]
    for k in range(state.xi.size):
        space.location[k] = state.moving_load[k]
        if state.moving_load[k] != OFF:
            state.xi[k], state.speed[k] = space.xi[2, k], space.speed[2, k]
            if state.moving_load[k] >= 0:
                state.X[state.moving_load[k]] = state.xi[k]
    state.t[0] += dt
    space.memory[NOW], space.memory[LENGTH] = state.t[0], dt


@inner
def _has_moved(moving_load, location):
    """Whether a load has another location than in the last step."""
    moved = False
    for k in range(moving_load.size):
        moved = moved or moving_load[k] != location[k]
    return moved


@inner
def _error(strands, state, space, dt):
    """Largest embedded error estimate of all strands, m."""
    largest = 0.0
    for s in range(strands.first.size):
        error = estimate(strands, state, space, s, dt)
        if not error <= largest:
            largest = error
    return largest


@kernel
def advance_implicit(strands, loads, state, space, until, tolerance, longest, most):
    """Move `state` to the time `until`.

    Args:
        strands, loads, state: see mechanics/chain.py; state is changed.
        space: from `workspace_for`, the same one from call to call.
        until: time to stop at, s.
        tolerance: of the positions, m; infinite: equal steps of `longest` from event to event.
        longest: largest step, s (may be infinite if `tolerance` is not).
        most: largest number of steps.

    Returns:
        Status (RUNNING when `until` is reached, else what went wrong) and the number of steps taken.
    """
    memory, target = space.memory, space.locations.target
    end, steps, rejected, tries = until - 1e-12 * max(1.0, abs(until)), 0, 0, 0
    allowed, enough = LOCAL * tolerance, NEWTON * LOCAL * tolerance
    if tolerance == np.inf:
        for s in range(strands.first.size):
            enough = min(enough, ROUNDING * strands.h[s] * strands.links[s])
    smooth = memory[LENGTH] > 0.0 and memory[NOW] == state.t[0]
    if not smooth:
        memory[WISH], memory[FACTORISED], space.location[:] = np.inf, 0.0, OFF
    near = ARRIVED * strands.h.min()
    due, begun, new, stale, theta = True, False, not smooth, False, 0.0
    while state.t[0] < end:
        if due:
            if _take_locations(strands, loads, state, space.locations):
                return END_OF_LINE, steps
            due = False
        if not begun:
            _begin(strands, loads, state, space)
            if not _is_finite(state.r, space.f):
                return NOT_FINITE, steps
            new = new or _has_moved(state.moving_load, space.location)
            begun, stale = True, not new
        rest = _reach(strands, loads, state, target, space.step_ratio, until)
        dt = rest / max(np.ceil(rest / min(memory[WISH], longest) - 0.05), 1.0)
        _predict(strands, loads, state, space, dt, smooth)
        if new:
            for a in range(state.r.shape[0]):
                for i in range(state.r.shape[1]):
                    space.r[MIDDLE, a, i] = state.r[a, i] + space.Z[MIDDLE, a, i]
            for s in range(strands.first.size):
                linearise(strands, stage_of(state, space, MIDDLE), space.v, s, space.stiff, space.damp)
            new, stale, memory[FACTORISED] = False, False, 0.0
            space.counts[JACOBIANS] += 1
        if abs(dt - memory[FACTORISED]) > (SAME_LENGTH if theta < FAST else 1e-9) * dt:
            for s in range(strands.first.size):
                prepare(strands, space, s, dt)
            memory[FACTORISED] = dt
            space.counts[FACTORS] += 1
        iterations, theta = newton(strands, loads, state, space, dt, enough)
        if iterations == 0 and stale:
            new = True
            continue
        if iterations > 0 and tries < MOST_TRIES and _misses(strands, loads, state, space, dt):
            tries += 1
            continue
        wish, error = 0.5 * dt, np.inf
        if iterations > 0:
            error, wish = 0.0, np.inf
            if tolerance < np.inf:
                error = _error(strands, state, space, dt) / allowed
                effort = 2.0 * MOST_ITERATIONS / (2.0 * MOST_ITERATIONS + iterations)
                wish = dt * SAFETY * effort * max(error, 1e-30) ** -0.25
        if not error <= 1.0:
            rejected += 1
            space.counts[REJECTIONS] += 1
            if rejected > MOST_REJECTIONS:
                return NO_CONVERGENCE, steps
            memory[WISH] = max(wish, 0.1 * dt) if np.isfinite(wish) else 0.1 * dt
            continue
        _accept(strands, loads, state, space, dt)
        steps += 1
        memory[WISH] = min(wish, memory[WISH] if rejected > 0 else max(GROWTH * dt, memory[WISH]))
        rejected, tries, begun, smooth, new = 0, 0, False, True, theta > SLOW
        due = _is_due(target, state.xi, state.speed, state.moving_load, near)
        if steps >= most and state.t[0] < end:
            return TOO_MANY_STEPS, steps
    return RUNNING, steps
