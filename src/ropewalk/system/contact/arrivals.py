"""When contacts whose travel is prescribed as material come to their lines, leave them or are stopped there.

A step of high order is of this order only where nothing jumps in it: it ends just before, and the next one begins just
after.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.system.contact.contact_record import GONE, ON, PRESCRIBED
from ropewalk.system.contact.tables import Tables
from ropewalk.system.elements.structure import Structure, SystemState

STOPPED = 3  # beside the states of contacts: at an end of its line
# Parts of the time ahead of which each is looked at; what comes and goes within one of them is not seen.
_PARTS = 16


class _Moving(Protocol):
    """What there is to look at."""

    @property
    def structure(self) -> Structure: ...

    @property
    def contacts(self) -> Any: ...

    @property
    def tables(self) -> Tables: ...

    @property
    def state(self) -> SystemState: ...


class Change(NamedTuple):
    """Instants just before and just after a contact comes, leaves or stops, s."""

    before: float
    after: float


def next_change(moving: _Moving, end: float) -> Change | None:
    """The next instant up to `end` in s at which a contact comes, leaves or stops; None: there is none."""
    t = float(moving.state.t[0])
    if not moving.contacts.size or t >= end:
        return None
    now = _states(moving, t)
    low = t
    for high in _instants(moving.tables, t, end):
        if (_states(moving, high) != now).any():
            break
        low = high
    else:
        return None
    while low < (middle := 0.5 * (low + high)) < high:
        if (_states(moving, middle) != now).any():
            high = middle
        else:
            low = middle
    return Change(low, float(high))


def _instants(tables: Tables, t: float, end: float) -> Array:
    knots = tables.speed_time[(tables.speed_time > t) & (tables.speed_time < end)]
    return np.unique(np.concatenate([knots, np.linspace(t, end, _PARTS + 1)[1:]]))


def _states(moving: _Moving, t: float) -> Integers:
    """AWAY, ON or STOPPED of each contact at time t in s."""
    found, lengths = np.zeros(moving.contacts.size, dtype=np.int64), moving.structure.lines.length
    tables = moving.tables
    for k, contact in enumerate(moving.contacts):
        if contact["state"] == GONE or contact["travel"] != PRESCRIBED:
            continue
        way, U = travelled(tables, contact, t)
        s, length = contact["begin"] + way, float(lengths[contact["line"]])
        low = contact["margin"] if U < 0.0 else 0.0
        high = length - (contact["margin"] if U > 0.0 else 0.0)
        if contact["stays"] and (s > high or (s < low and contact["been"])):
            found[k] = STOPPED
        elif low <= s <= high:
            found[k] = ON
    return found


def travelled(tables: Tables, contact: Any, t: float) -> tuple[float, float]:
    """What a contact has travelled up to a time t in s, m, and its speed then, m/s; as `travel.py` has it."""
    part = slice(int(contact["speed_first"]), int(contact["speed_first"] + contact["speed_count"]))
    time, value, path = tables.speed_time[part], tables.speed_value[part], tables.speed_path[part]
    i = max(int(np.searchsorted(time, t, side="right")) - 1, 0)
    U = float(np.interp(t, time, value))
    return float(path[i] + 0.5 * (t - time[i]) * (value[i] + U)), U
