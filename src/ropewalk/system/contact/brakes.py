"""Brakes of what travels freely: where they act along a line, and with what force."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import inlined


@inlined
def is_braked(contacts, k, s):
    """Whether the brake of contact k acts at s."""
    return s < contacts[k].brake_low or s > contacts[k].brake_high


@inlined
def pressed(contacts, k, s):
    """By how much contact k at s presses the spring of its brake, m; negative at the start of its line."""
    return max(s - contacts[k].brake_high, 0.0) + min(s - contacts[k].brake_low, 0.0)


@inlined
def pressed_energy(contacts, k, s):
    """Energy of the spring of the brake of contact k at s, J."""
    spring, way = contacts[k].spring, 0.0
    if spring > 0.0:
        way = pressed(contacts, k, s)
    return 0.5 * spring * way * way


@inlined
def eddy(contacts, k, s, speed):
    """Force of a brake that grows with speed, against it, N, and what it grows by, N s/m."""
    rate = contacts[k].braking if is_braked(contacts, k, s) else 0.0
    return (rate * speed, rate) if rate * abs(speed) <= contacts[k].brake else (np.sign(speed) * contacts[k].brake, 0.0)
