"""An independent route to vehicles on a beam: its sine modes and all bodies together, by Runge and Kutta's method.

Heights z upwards. Of a wheel on the beam z = sum q_n sin(n pi x/L) with x = V t - b, so that

    z'' = s.q'' + 2 V s'.q' + V^2 s''.q,   N = m (g + z'') + k (z - z_above) + c (z' - z_above'),
    m L/2 (q'' + c_b q' + w^2 q) = -sum s N;

off it z = 0. Sources: Y.-B. Yang, J.-D. Yau and Y.-S. Wu, Vehicle-Bridge Interaction Dynamics (2004), for vehicles of
ten coordinates; L. Fryba, Vibration of Solids and Structures under Moving Loads (1999), for the terms of the speed.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ropewalk.model.train_sets import ORDER, VEHICLES, middles
from train_routes import Bridge

Array = NDArray[np.float64]
G = 9.81


@dataclass
class Parts:
    """Bodies (mass, inertia, place), wheels (mass, place) and springs (upper, lower, stiffness, damping, place).

    Places are m behind the first wheel. Upper parts are bodies; lower ones bodies, or wheels: -1 is the first wheel.
    """

    bodies: list[tuple[float, float, float]] = field(default_factory=list)
    wheels: list[tuple[float, float]] = field(default_factory=list)
    springs: list[tuple[int, int, float, float, float]] = field(default_factory=list)


def named(name: str) -> Parts:
    """A train by name: each vehicle of a body on two bogies on four wheelsets."""
    own, parts = [VEHICLES[name][vehicle] for vehicle in ORDER[name]], Parts()
    first = own[0].front - 0.5 * own[0].wheelbase
    for vehicle, middle in zip(own, middles([vehicle.length for vehicle in own]), strict=True):
        front = middle - 0.5 * vehicle.length + vehicle.front - first
        body = len(parts.bodies)
        parts.bodies.append((vehicle.body, vehicle.body_inertia, front + 0.5 * vehicle.bogies))
        for at in (front, front + vehicle.bogies):
            bogie = len(parts.bodies)
            parts.bodies.append((vehicle.bogie, vehicle.bogie_inertia, at))
            parts.springs.append((body, bogie, *vehicle.secondary, at))
            for side in (-0.5, 0.5):
                place = at + side * vehicle.wheelbase
                parts.wheels.append((vehicle.wheelset, place))
                parts.springs.append((bogie, -len(parts.wheels), *vehicle.primary, place))
    return parts


def articulated(
    coaches: int, length: float, ahead: float, body: tuple[float, float], bogie: tuple[float, float], wheelset: float,
    primary: tuple[float, float], secondary: tuple[float, float],
) -> Parts:  # fmt: skip
    """Coaches on bogies of 3 m that they share, whose middles are a length apart; centres are so far behind a bogie."""
    parts, middles = Parts(), [1.5 + length * k for k in range(coaches + 1)]
    for at in middles:
        parts.bodies.append((*bogie, at))
        for place in (at - 1.5, at + 1.5):
            parts.wheels.append((wheelset, place))
            parts.springs.append((len(parts.bodies) - 1, -len(parts.wheels), *primary, place))
    for k in range(coaches):
        parts.bodies.append((*body, middles[k] + ahead))
        parts.springs += [(coaches + 1 + k, k + side, *secondary, middles[k + side]) for side in (0, 1)]
    return parts


def crossing(parts: Parts, bridge: Bridge, speed: float, until: float, modes: int = 5, step: float = 1e-3) -> tuple[
    Array, Array, Array, Array
]:  # fmt: skip
    """A crossing that begins with the first wheel at the start of the beam.

    Returns:
        Times in s; deflection of midspan downwards in m; contact forces (time, wheel) in N, NaN off the beam; vertical
        accelerations of the bodies (time, body) in m/s^2.
    """
    n, L = np.arange(1, modes + 1), bridge.length
    w2 = np.array([bridge.frequency(int(k)) ** 2 for k in n])
    damping = bridge.alpha + bridge.beta * w2
    count, wheels = len(parts.bodies), len(parts.wheels)
    mass = np.array([x for m, inertia, _ in parts.bodies for x in (m, inertia)])
    weight = np.array([x for m, _, _ in parts.bodies for x in (m * G, 0.0)])
    m, behind = np.array(parts.wheels).T
    K, C = np.zeros((2 * count, 2 * count)), np.zeros((2 * count, 2 * count))
    up, stiff, damp = np.zeros((wheels, 2 * count)), np.zeros(wheels), np.zeros(wheels)
    for a, b, k, c, at in parts.springs:
        row = np.zeros(2 * count)
        row[2 * a], row[2 * a + 1] = 1.0, parts.bodies[a][2] - at  # pitch lifts what is ahead of the centre
        if b < 0:
            up[-b - 1], stiff[-b - 1], damp[-b - 1] = row, k, c
            continue
        row[2 * b], row[2 * b + 1] = -1.0, -(parts.bodies[b][2] - at)
        K, C = K + k * np.outer(row, row), C + c * np.outer(row, row)
    rest = np.linalg.solve(K + (up.T * stiff) @ up, -weight)

    def rates(t: float, y: Array) -> tuple[Array, Array, Array]:
        u, v = y[: 2 * count], y[2 * count : 4 * count]
        q, p = y[4 * count : 4 * count + modes], y[4 * count + modes :]
        x = speed * t - behind
        on = (x >= 0.0) & (x <= L)
        wave = n * np.pi / L
        s = np.where(on[:, None], np.sin(np.outer(x, wave)), 0.0)
        turn = np.where(on[:, None], wave * np.cos(np.outer(x, wave)), 0.0)
        bend = -s * wave**2
        z, rate = s @ q, s @ p + speed * (turn @ q)
        carried = 2.0 * speed * (turn @ p) + speed**2 * (bend @ q)
        spring = stiff * (z - up @ u) + damp * (rate - up @ v)
        bridge_mass = 0.5 * bridge.mass * L
        M = bridge_mass * np.eye(modes) + (s.T * m) @ s
        load = -bridge_mass * (damping * p + w2 * q) - s.T @ (m * (G + carried) + spring)
        acceleration = np.linalg.solve(M, load)
        force = np.where(on, m * (G + s @ acceleration + carried) + spring, np.nan)
        bodies = (up.T @ spring - K @ u - C @ v - weight) / mass
        return np.concatenate([v, bodies, p, acceleration]), force, bodies[::2]

    steps = round(until / step)
    y = np.concatenate([rest, np.zeros(2 * count + 2 * modes)])
    middle, forces, bodies = np.zeros(steps + 1), np.zeros((steps + 1, wheels)), np.zeros((steps + 1, count))
    shape = np.sin(0.5 * n * np.pi)
    for i in range(steps + 1):
        t = i * step
        a, forces[i], bodies[i] = rates(t, y)
        middle[i] = -shape @ y[4 * count : 4 * count + modes]
        b = rates(t + 0.5 * step, y + 0.5 * step * a)[0]
        c = rates(t + 0.5 * step, y + 0.5 * step * b)[0]
        d = rates(t + step, y + step * c)[0]
        y = y + step / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    return np.arange(steps + 1) * step, middle, forces, bodies
