"""Models with the step protocol that the tests of exchanges share."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import expm

G = 9.81
Answer = list[tuple[Any, ...]]


class Sprung:
    """A mass on a spring and a damper above its contact, exact where the contact moves evenly over an interval."""

    def __init__(
        self, mass: float = 20.0, stiffness: float = 4e3, damping: float = 0.0, speed: float = 20.0,
        start: float = 5.0, *, coming: bool = False,
    ) -> None:  # fmt: skip
        self.mass, self.stiffness, self.damping, self.speed, self.start = mass, stiffness, damping, speed, start
        self.coming = coming  # from level ground

    def reset(self, line: Any) -> None:
        self.level = self.w = float(line.at(self.start)[0][-1])
        rate = 0.0 if self.coming else self.speed * slope(line, self.start)
        self.y = np.array([-self.mass * G / self.stiffness, rate])
        self.t, self.rates = 0.0, (rate, rate)

    def get_state(self) -> Any:
        return self.w, self.y.copy(), self.t, self.rates

    def set_state(self, state: Any) -> None:
        self.w, self.y, self.t, self.rates = state[0], state[1].copy(), *state[2:]

    def step(self, t: float, h: float, line: Any) -> Answer:
        xi = self.start + self.speed * t
        k, c, m = self.stiffness, self.damping, self.mass
        if t > self.t + 1e-12:
            w = float(line.at(min(xi, line.length))[0][-1])
            dt, begin = t - self.t, self.w - self.level
            rate = (w - self.w) / dt
            A = np.zeros((4, 4))  # of (y, y', w, 1)
            A[0, 1] = 1.0
            A[1] = -k / m, -c / m, k / m, c / m * rate - G
            A[2, 3] = rate
            self.y = (expm(A * dt) @ [*self.y, begin, 1.0])[:2]
            # The velocity at the end of the interval: the backward difference of second order.
            self.rates = (1.5 * rate - 0.5 * (self.rates[1] if self.t > 0.0 else rate), rate)
            self.w, self.t = w, t
        force = k * (self.y[0] - self.w + self.level) + c * (self.y[1] - self.rates[0])
        return [(xi, (0.0, force), self.speed)]


class Mass:
    """A mass that gives its motion: the spring of the interface carries it."""

    def __init__(self, mass: float = 20.0, carried_by: float = 4e3, speed: float = 20.0, start: float = 5.0) -> None:
        self.mass, self.stiffness, self.speed, self.start = mass, carried_by, speed, start

    def reset(self, line: Any) -> None:
        self.z = float(line.at(self.start)[0][-1]) - self.mass * G / self.stiffness
        self.v, self.t = self.speed * slope(line, self.start), 0.0

    def get_state(self) -> Any:
        return self.z, self.v, self.t

    def set_state(self, state: Any) -> None:
        self.z, self.v, self.t = state

    def step(self, t: float, h: float, line: Any) -> Answer:
        if t > self.t + 1e-12:
            dt, a = t - self.t, -G - float(line.force()[-1]) / self.mass
            self.z, self.v, self.t = self.z + dt * (self.v + 0.5 * a * dt), self.v + a * dt, t
        return [(self.start + self.speed * t, (0.0, 0.0), self.speed, (self.z, self.v))]


class Dashpot:
    """A damper from the sky, and a force: F = -100 N - c v with the mean velocity of the last interval."""

    def __init__(self, damping: float, place: float = 50.0, force: float = 100.0) -> None:
        self.damping, self.place, self.force = damping, place, force

    def reset(self, line: Any) -> None:
        self.z = float(line.at(self.place)[0][-1])

    def get_state(self) -> float:
        return self.z

    def set_state(self, state: float) -> None:
        self.z = state

    def step(self, t: float, h: float, line: Any) -> Answer:
        before, self.z = self.z, float(line.at(self.place)[0][-1])
        return [(self.place, (0.0, -self.force - self.damping * (self.z - before) / h))]


def slope(line: Any, xi: float) -> float:
    """Slope of a line about a place, over half a metre."""
    return float(line.at(xi + 0.25)[0][-1] - line.at(xi - 0.25)[0][-1]) / 0.5
