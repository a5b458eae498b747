"""Zip line: a pulley rolls down a rope, which hangs at every instant as if the pulley stood there.

Held by a level force, a pulley without friction has the same tension T on both sides; let go, that force drives it. On
its way m v dv = (H_ahead - H_behind) dx - (rolling N + k |v + w| (v + w)) ds, N the force on the rope, w a headwind.
The potential energy of the rope, its weight and stretch, is so accounted for; its kinetic energy is not.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, inf, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from ropewalk.calc.answer import CalcValue
from ropewalk.calc.calculator import Calculator
from ropewalk.calc.common import AXIAL_STIFFNESS, GRAVITY, LENGTH, ROPE_MASS, SPAN, depth, force, height
from ropewalk.calc.hanging import hang, reach
from ropewalk.calc.rope_spans import bare

PLACES = 80
"""Places on the way, denser near the anchors."""


@dataclass(frozen=True)
class Way:
    """Where the pulley stands, (place,): unstrained length behind it, x and z in m; tensions and forces in N."""

    s: NDArray[np.float64]
    x: NDArray[np.float64]
    z: NDArray[np.float64]
    tension: NDArray[np.float64]
    largest: NDArray[np.float64]
    drive: NDArray[np.float64]
    load: NDArray[np.float64]


@dataclass(frozen=True)
class Descent:
    """Along the path, (place,): distance m, speed m/s, time s; the energy J that a brake must take."""

    distance: NDArray[np.float64]
    speed: NDArray[np.float64]
    time: NDArray[np.float64]
    arrival: int
    to_brake: float


def way(
    span: float, height: float, length: float, mass: float, axial_stiffness: float, gravity: float, load: float,
    brake_distance: float, margin: float,
) -> Way:  # fmt: skip
    """All places of the pulley, from the upper margin to the lower one; the start is above the end.

    Raises:
        ValueError: the rope does not reach, or the margins and the brake leave no way.
    """
    first, last = margin, length - margin
    arrival = length - brake_distance
    if not first < arrival <= last:
        raise ValueError("margin and brake_distance leave no travel on the rope")
    share = 0.5 * (1.0 - np.cos(np.linspace(0.0, pi, PLACES)))
    s = np.unique(np.concatenate([first + (last - first) * share, [arrival]]))
    weight, P, compliance = mass * gravity, load * gravity, 1.0 / axial_stiffness
    rows = np.empty((s.size, 6))
    middle = int(np.argmin(abs(s - 0.5 * length)))
    rest = hang(span, height, length, weight, axial_stiffness, s[middle] / length, P)
    begin = np.array([rest.start[0], rest.start[1], rest.start[0]])
    for places in (range(middle, s.size), range(middle - 1, -1, -1)):
        y = begin.copy()
        for i in places:
            y = _equal_tensions(y, float(s[i]), span, height, length, weight, compliance, P)
            if i == middle:
                begin = y.copy()
            H, V, H2 = (float(value) for value in y)
            x, z = reach(H, V, float(s[i]), weight, compliance)
            at = V + weight * float(s[i])
            end = at + P + weight * (length - float(s[i]))
            tension = hypot(H, at)
            rows[i] = x, z, tension, max(tension, hypot(H, V), hypot(H2, end)), H2 - H, hypot(P, H2 - H)
    return Way(s, *rows.T)


def _equal_tensions(
    y: NDArray[np.float64], s: float, span: float, height: float, length: float, weight: float, compliance: float,
    P: float,
) -> NDArray[np.float64]:  # fmt: skip
    """Solve for (H, V) at the start and H ahead of a pulley at s."""

    def miss(y: NDArray[np.float64]) -> NDArray[np.float64]:
        H, V, H2 = (float(value) for value in y)
        at = V + weight * s
        x, z = reach(H, V, s, weight, compliance)
        dx, dz = reach(H2, at + P, length - s, weight, compliance)
        T, T2 = hypot(H, at), hypot(H2, at + P)
        return np.array([(x + dx - span) / length, (z + dz - height) / length, (T - T2) / (T + T2)])

    now = miss(y)
    for _ in range(60):
        if np.abs(now).max() < 1e-12:
            break
        jacobian = np.empty((3, 3))
        for k in range(3):
            step = 1e-7 * (abs(y[k]) + 1e-6 * P)
            trial = y.copy()
            trial[k] += step
            jacobian[:, k] = (miss(trial) - now) / step
        try:
            change = np.linalg.solve(jacobian, -now)
        except np.linalg.LinAlgError:
            break
        size = 1.0
        while size > 1e-4:
            new = y + size * change
            if new[0] > 0.0 and new[2] > 0.0 and np.abs(ahead := miss(new)).max() < np.abs(now).max():
                break
            size *= 0.5
        else:
            break
        y, now = new, ahead
    if not np.abs(now).max() < 1e-8:
        raise ValueError("no position of the pulley exists: the rope is too slack next to the anchors; enlarge margin")
    return y


def course(
    way: Way, load: float, gravity: float, rolling: float, air_drag: float, headwind: float, length: float,
    brake_distance: float, push: float,
) -> Descent:  # fmt: skip
    """How the pulley rolls along the path, without the brake.

    Raises:
        ValueError: it stops on the way.
    """
    steps = np.hypot(np.diff(way.x), np.diff(way.z))
    distance = np.concatenate([[0.0], np.cumsum(steps)])
    gained = 0.5 * (way.drive[1:] + way.drive[:-1]) * np.diff(way.x)
    normal = 0.5 * (way.load[1:] + way.load[:-1])
    arrival = int(np.argmin(abs(way.s - (length - brake_distance))))
    energy = np.zeros(way.s.size)
    energy[0] = 0.5 * load * push**2

    def drag(E: float) -> float:
        v = sqrt(max(2.0 * E / load, 0.0)) + headwind
        return air_drag * abs(v) * v

    for i in range(arrival):
        trial = energy[i] + gained[i] - (rolling * normal[i] + drag(float(energy[i]))) * steps[i]
        mean = 0.5 * (drag(float(energy[i])) + drag(float(trial)))
        energy[i + 1] = energy[i] + gained[i] - (rolling * normal[i] + mean) * steps[i]
        if energy[i + 1] <= 0.0:
            raise ValueError(f"it stops {distance[i + 1]:.3g} m down the rope; give it a push, or a steeper rope")
    speed = np.sqrt(2.0 * energy[: arrival + 1] / load)
    time = np.concatenate([[0.0], np.cumsum(2.0 * steps[:arrival] / (speed[1:] + speed[:-1]))])
    to_brake = float(energy[arrival] + gained[arrival:].sum())
    return Descent(distance, speed, time, arrival, max(to_brake, 0.0))


_OF_BRAKE = "for a stop between brake_distance and margin before the lower anchor"

zipline = Calculator(
    "zipline",
    "Zip line: speed along the rope and at the brake, tension, and required braking.",
    (
        SPAN,
        height("of the lower anchor above the upper one: negative"),
        LENGTH,
        ROPE_MASS,
        AXIAL_STIFFNESS,
        CalcValue("load", "kg", "mass of the person with the trolley", search=(1.0, 1e5), typical=100.0),
        CalcValue("rolling", "dimensionless", "resistance over load", default=0.0, search=(1e-4, 1.0), zero=True),
        CalcValue("air_drag", "kg/m", "0.5 rho c A of the person", default=0.0, search=(1e-4, 1e3), zero=True),
        CalcValue("headwind", "m/s", "wind against the motion; negative: from behind", low=-inf, default=0.0,
                 search=(0.01, 100.0), zero=True),
        CalcValue("push", "m/s", "speed at the beginning", default=0.0, search=(0.01, 100.0), zero=True),
        CalcValue("brake_distance", "m", "of the beginning of the brake from the lower anchor, along the rope",
                 default=10.0, search=(0.1, 1e3)),
        CalcValue("margin", "m", "distance of the start of the travel from the upper anchor, and of its end from the "
                                 "lower one",
                 default=1.0, search=(0.1, 1e2)),
        GRAVITY,
    ),
    (
        depth("bare_sag", "with nobody on the rope"),
        force("bare_tension", "level part of the tension, with nobody on the rope"),
        depth("largest_depth", "of the pulley below the straight line between the anchors"),
        force("largest_tension", "largest along the rope"),
        CalcValue("arrival_speed", "m/s", "at the start of the brake", search=(1e-3, 1e3)),
        CalcValue("top_speed", "m/s", "on the way"),
        CalcValue("time", "s", "until the brake"),
        CalcValue("energy", "J", "that the brake must take, that of the slope behind it included"),
        force("brake_force", f"constant, {_OF_BRAKE}"),
        CalcValue("deceleration", "m/s^2", "mean of such a stop, on the level"),
        CalcValue("brake_spring", "N/m", f"stiffness of a spring {_OF_BRAKE}"),
        force("brake_spring_force", "largest of that spring"),
        CalcValue("brake_damping", "N*s/m", "of an eddy-current brake that stops it over that distance, on the level"),
    ),
    {
        "bare": bare,
        "bare_sag": lambda bare: bare.sag,
        "bare_tension": lambda bare: bare.start[0],
        "way": way,
        "largest_depth": lambda way, span, height: float(np.max(height / span * way.x - way.z)),
        "largest_tension": lambda way: float(way.largest.max()),
        "course": course,
        "arrival_speed": lambda course: float(course.speed[-1]),
        "top_speed": lambda course: float(course.speed.max()),
        "time": lambda course: float(course.time[-1]),
        "energy": lambda course: course.to_brake,
        "brake_way": lambda course: float(course.distance[-1] - course.distance[course.arrival]),
        "brake_force": lambda energy, brake_way: energy / brake_way,
        "deceleration": lambda arrival_speed, brake_way: arrival_speed**2 / (2.0 * brake_way),
        "brake_spring": lambda energy, brake_way: 2.0 * energy / brake_way**2,
        "brake_damping": lambda load, arrival_speed, brake_way: load * arrival_speed / brake_way,
        "brake_spring_force": lambda energy, brake_way: 2.0 * energy / brake_way,
    },
    points=16,
)  # fmt: skip
"""Quasi-static rope, dynamic pulley."""
