"""Wheels before and behind their lines, which the ground there moves by the profile: in implicit steps."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.system.contact.arrivals import travelled
from ropewalk.system.contact.contact_record import AWAY, BODY, PRESCRIBED
from ropewalk.system.dynamics.carrier import System


class RoughGround:
    """The coordinates of a system that rough ground moves up and down, until a contact comes or leaves."""

    def __init__(self, system: System) -> None:
        self._system, contacts = system, system.contacts
        knots = system.structure.lines.profiles.knots[contacts["line"]]
        rolls = (contacts["rolls"] == 1) & (knots > 0) & (contacts["led"] == 0) & (contacts["clear"] == 0)
        away = (contacts["state"] == AWAY) & (contacts["kind"] == BODY) & (contacts["travel"] == PRESCRIBED)
        self._on = np.flatnonzero(rolls & away)
        self.coordinates = contacts["first"][self._on] + system.state.r.shape[0] - 1

    def moved(self, t: float) -> Array:
        """Height, speed and acceleration of each at time t in s, (3, coordinate) m, m/s, m/s^2."""
        system, out = self._system, np.zeros((3, self._on.size))
        profiles, dt = system.structure.lines.profiles, 1e-6
        for i, contact in enumerate(system.contacts[self._on]):
            (way, U), line = travelled(system.tables, contact, t), contact["line"]
            s, faster = float(contact["begin"]) + way, (travelled(system.tables, contact, t + dt)[1] - U) / dt
            part = slice(int(profiles.first[line]), int(profiles.first[line] + profiles.knots[line]))
            begin, c = profiles.s[part], profiles.c[:, part]
            k = int(np.clip(np.searchsorted(begin, s, side="right") - 1, 0, begin.size - 1))
            x, cubic = s - begin[k], np.polynomial.Polynomial(c[:, k])
            if not begin[0] < s < begin[-1]:  # level beyond
                x, cubic = 0.0, np.polynomial.Polynomial(c[:1, k])
            slope, bend = cubic.deriv()(x), cubic.deriv(2)(x)
            out[:, i] = cubic(x), slope * U, bend * U * U + slope * faster
        return out
