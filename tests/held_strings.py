"""A taut string that is held at a station, and what crosses it: its characteristics.

A point force on a string is felt as far as its waves have come, and ends of the string are mirrors. So deflections are
impulses at earlier times, `u = c/2T sum of +-I(earlier)`: a force, masses and what holds the string make ordinary
equations of that, with delays (Fryba's mass on a string by Smith's delay equation, with more than one body).
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FINE = 20_000  # steps, of the second order: 1e-6 of the deflection and less
BACK_AND_FORTH = 4  # images in the ends to each side


class Station(NamedTuple):
    """What holds a string at a place in m: N/m, N s/m and kg."""

    at: float
    stiffness: float = 0.0
    damping: float = 0.0
    mass: float = 0.0


class HeldString(NamedTuple):
    """A string of a length in m, under a tension in N, of kg/m."""

    length: float
    tension: float
    mass: float
    station: Station


class MovingLoad(NamedTuple):
    """What comes to the string at an instant in s, with a force in N and a mass in kg."""

    enters: float = 0.0
    force: float = 1.0
    mass: float = 0.0


def crossed(string: HeldString, speed: float, times: Array, *moving_loads: MovingLoad) -> tuple[Array, Array]:
    """Deflection in m of a string at its station, and below each of what crosses it, (rider, time).

    Args:
        string: at rest at first.
        speed: m/s, of all riders.
        times: s, increasing from 0.
        riders: who enter at its start, in the direction that it has there; none has come to its end.
    """
    u, below = _crossed(string, speed, tuple(times.tolist()), moving_loads)
    return u.copy(), below.copy()


@cache
def _crossed(
    string: HeldString, speed: float, times: tuple[float, ...], moving_loads: tuple[MovingLoad, ...]
) -> tuple[Array, Array]:
    """The same, computed once for what is looked at on several meshes."""
    at, stiffness, damping, restrained = string.station
    c = float(np.sqrt(string.tension / string.mass))
    half, t = 0.5 * c / string.tension, np.linspace(0.0, times[-1], FINE + 1)
    dt, images = float(t[1]), 2.0 * string.length * np.arange(-BACK_AND_FORTH, BACK_AND_FORTH + 1)
    sign, far = np.repeat([1.0, -1.0], images.size), np.tile(images, 2)
    all_of_them, others = np.ones(sign.size, dtype=np.bool_), (sign < 0.0) | (far != 0.0)
    given, w, before = (
        np.zeros((len(moving_loads), t.size)) for _ in range(3)
    )  # impulse, deflection, what acts beside
    entered = np.zeros(len(moving_loads))
    back, u, rate, way = (np.zeros_like(t) for _ in range(4))  # impulse of the station, its deflection

    def felt(impulse: Array, at_time: Array, which: Array, i: int) -> float:
        seen = np.interp(np.clip(at_time, 0.0, t[i]), t[: i + 1], impulse[: i + 1])
        return float(sign[which] @ seen)

    def of_moving_load(r: int, x: float, i: int, which: Array) -> float:
        moves = sign[which] * speed
        away = x - far[which] + moves * moving_loads[r].enters
        return felt(given[r], np.minimum((c * t[i] - away) / (c - moves), (c * t[i] + away) / (c + moves)), which, i)

    def of_station(x: float, i: int, which: Array) -> float:
        return felt(back, t[i] - np.abs(x - far[which] - sign[which] * at) / c, which, i)

    for i in range(1, t.size):
        for impulse in (*given, back):  # to be felt at once
            impulse[i] = 2.0 * impulse[i - 1] - impulse[max(i - 2, 0)]
        for r, (enters, force, mass) in enumerate(moving_loads):
            if t[i] <= enters:
                given[r, i] = 0.0
                continue
            x = speed * (t[i] - enters)
            beside = sum(of_moving_load(k, x, i, others if k == r else all_of_them) for k in range(len(moving_loads)))
            beside -= of_station(x, i, all_of_them)
            if mass:  # m w' = p + F t - I and w = half (I + beside), p from the slope that it comes onto
                if t[i - 1] <= enters:
                    before[r, i - 1] = entered[r] = mass * half * beside / (t[i] - enters)
                before[r, i] = entered[r] + force * (t[i] - enters) + beside
                known = 0.5 * (before[r, i - 1] + before[r, i] - w[r, i - 1] / half)
                w[r, i] = (mass / dt * w[r, i - 1] + known) / (mass / dt + 0.5 / half)
                given[r, i] = w[r, i] / half - beside
            else:
                given[r, i] = force * (t[i] - enters)
                w[r, i] = half * (given[r, i] + beside)
        free = half * sum(of_moving_load(r, at, i, all_of_them) for r in range(len(moving_loads)))
        free -= half * of_station(at, i, others)
        # u = free - half I and I = k U + d u + m u', with U the integral of u
        reach = way[i - 1] + 0.5 * dt * u[i - 1]
        if restrained:
            pull = free / half - stiffness * reach
            yielding = 1.0 / half + damping + 0.5 * dt * stiffness
            u[i] = (u[i - 1] + 0.5 * dt * (rate[i - 1] + pull / restrained)) / (1.0 + 0.5 * dt * yielding / restrained)
            rate[i] = 2.0 * (u[i] - u[i - 1]) / dt - rate[i - 1]
        else:
            u[i] = (free - half * stiffness * reach) / (1.0 + half * (damping + 0.5 * dt * stiffness))
        way[i] = reach + 0.5 * dt * u[i]
        back[i] = (free - u[i]) / half
    return np.interp(times, t, u), np.array([np.interp(times, t, own) for own in w])
