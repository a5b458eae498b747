"""Independent routes to numbers of the examples with bodies: quasi-static catenaries, energy, modes of beams."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from closed_forms import slow_loads
from continuous_beams import mode_of_two_spans, wave_numbers
from ropewalk.theory import beam, foundation
from ropewalk.theory.beam_crossing import Crossing
from ropewalk.theory.beam_vehicle import oscillator, rigid_body
from ropewalk.theory.rope import elastic_catenary

G = 9.81


def zip_line_speed(mass: float = 79.0, rolling: float = 0.015, drag: float = 0.35, end: float = 131.1) -> float:
    """Speed at the brake of a rider on the catenary that her weight shapes: m v v' = m g sin - rolling - drag, m/s."""
    rope = {"span": 150.0, "height": -14.0, "length": 151.1, "weight": 0.55 * G, "axial_stiffness": 6e6}
    xi = np.linspace(3.0, end, 120)
    places = np.array(
        [elastic_catenary(**rope, loads=[(s, (0.0, -mass * G))]).load_positions[0] for s in xi]  # type: ignore[arg-type]
    )
    way = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(places, axis=0).T))))

    def rate(s: float, v2: np.ndarray) -> list[float]:
        slope = np.interp(s, 0.5 * (way[1:] + way[:-1]), -np.diff(places[:, 1]) / np.diff(way))
        return [2.0 * (G * slope - rolling * G * math.sqrt(1.0 - slope**2)) - 2.0 * drag / mass * v2[0]]

    return math.sqrt(float(solve_ivp(rate, (0.0, way[-1]), [0.0], rtol=1e-8, max_step=1.0).y[0, -1]))


def slope_where_it_stands(result: xr.Dataset) -> float:
    """Of the way of a pulley without friction with 94 kg on the rope of zip-line-brake.yaml, where that run ends."""
    x = float(result.contact_position[-1, 0, 0])
    way = slow_loads.frictionless(
        span=150.0, height=-14.0, length=150.9, weight=0.55 * G, axial_stiffness=6e6, force=(0.0, -94.0 * G), x=x
    )
    return float(way.slope)


def highline_tension() -> float:
    """Of the main line of highline-backup-cut.yaml under a person and its loops, N: an elastic catenary."""
    stiffness, loops = 55.6e3, 6.0 * 10.75 * 0.05 / 63.0
    bare = elastic_catenary(
        span=63.0, length=63.0 / (1.0 + 1500.0 / stiffness), weight=(0.06 + loops) * G, axial_stiffness=stiffness,
        loads=[(0.5 * 63.0 / (1.0 + 1500.0 / stiffness), (0.0, -57.0 * G))],
    )  # fmt: skip
    return float(np.hypot(*bare.start_reaction))


def bounces(result: xr.Dataset) -> float:
    """Frequency of the last bounces of highline-bounce.yaml in Hz, by its turns."""
    t, z = result.time.to_numpy(), result.contact_position.to_numpy()[:, 0, -1]
    turns = np.flatnonzero((z[1:-1] - z[:-2]) * (z[2:] - z[1:-1]) <= 0.0) + 1
    return 2.0 / float(t[turns[-1]] - t[turns[-5]])


def bounces_without_slip(result: xr.Dataset) -> float:
    """The same of a mass on two straight pieces without weight, as stiff as what does not slip, where it stands, Hz."""
    z, mass, length = result.contact_position.to_numpy()[:, 0, -1], 57.0, 63.0 / (1.0 + 1500.0 / 55.6e3)
    turns = z[np.flatnonzero((z[1:-1] - z[:-2]) * (z[2:] - z[1:-1]) <= 0.0) + 1]
    depth = -0.5 * float(turns[-1] + turns[-2])
    half = math.hypot(31.5, depth)
    tension, stiffness = 0.5 * mass * G * half / depth, 0.9 * 1e4 / 0.18 + 55.6e3
    up = stiffness / (0.5 * length) * (depth / half) ** 2 + tension / half * (31.5 / half) ** 2
    return math.sqrt(2.0 * up / (mass + 0.06 * length / 3.0)) / (2.0 * math.pi)


def deepest_without_losses() -> float:
    """Lowest place of a person of 70 kg who falls into the leash of leash-fall.yaml, if no energy got lost, m.

    Two straight halves of webbing without mass, tension T0 at rest, and the leash, in equilibrium with the largest
    force; energy from the level of the line.
    """
    a, b, T0, EA, k, length, m = 15.0, 25.0, 2000.0, 140e3, 8e3, 1.5, 70.0
    rest = (a + b) / (1.0 + T0 / EA)

    def line(depth: float) -> tuple[float, float]:
        """Force that holds the line down, N, and what it stores above its rest, J; the ring slides: one tension."""
        long = math.hypot(a, depth) + math.hypot(b, depth)
        T = EA * (long / rest - 1.0)
        stored = 0.5 * (T * T - T0 * T0) / EA * rest
        return T * (depth / math.hypot(a, depth) + depth / math.hypot(b, depth)), stored

    def surplus(depth: float) -> float:
        force, stored = line(depth)
        longer = force / k
        return m * G * (depth + length + longer) - stored - 0.5 * k * longer**2

    depth = brentq(surplus, 1.0, 20.0)
    return -(depth + length + line(depth)[0] / k)


def lorry_crossing() -> Crossing:
    """The lorry of bridge-biggs.yaml on its bridge, by 20 modes."""
    lorry = oscillator(32e3, load_stiffness=6e6, load_damping=3e4, wheel_mass=4e3)
    t = np.linspace(0.0, 1.2, 601)
    return beam.moving_vehicle(
        t, vehicle=lorry, speed=25.0, length=30.0, bending_stiffness=12e9, mass=6e3, damping=0.62 * 6e3, modes=20,
        tolerance=1e-4,
    )  # fmt: skip


TRACK = {"bending_stiffness": 10e6, "foundation": 5e6, "mass": 600.0, "damping": 18.0 * 600.0}


def track_under_a_bogie() -> float:
    """Largest deflection in the middle of the track of bedded-line-vehicle.yaml, by 90 modes, m."""
    bogie = rigid_body(12e3, pitch_inertia=15e3, centre=1.25, axles=[0.0, 2.5], load_stiffness=1e6, load_damping=4e4,
                       wheel_mass=1800.0)  # fmt: skip
    t = np.linspace(0.4, 0.65, 251)
    crossing = beam.moving_vehicle(t, vehicle=bogie, speed=290.0 / 3.6, length=80.0, modes=90, tolerance=1e-3, **TRACK)
    return float(crossing.beam_deflection(40.0).max())


def endless_track_under_two_axles() -> float:
    """The same of an endless track under the static loads of the axles, m."""
    axle = (6000.0 + 1800.0) * G
    x = np.linspace(-10.0, 5.0, 3001)
    return float(foundation.several_loads(x, forces=[axle] * 2, places=[0.0, -2.5], speed=290.0 / 3.6, **TRACK).max())


def deck_under_a_vehicle(x: float, modes: int = 12) -> float:
    """Smallest height in m of a point of the deck of continuous-bridge.yaml, by exact modes."""
    one, two, EI, rho, v, steps, until = 20.0, 28.0, 15e9, 5e3, 20.0, 4800, 2.4
    body, axle, k, c = 27e3, 3e3, 4e6, 4e4
    b, along = wave_numbers((one, two), modes), np.linspace(0.0, one + two, 9601)
    shape = np.array([mode_of_two_spans(n, one, two, along) for n in b])
    modal = rho * np.trapezoid(shape**2, along)
    square, curve = b**4 * EI / rho, CubicSpline(along, shape.T)
    under = np.stack([curve(v * np.linspace(0.0, until, 2 * steps + 1), order) for order in (0, 1, 2)])

    def rates(half: int, state: Any) -> Any:
        q, p, y, w = state[:modes], state[modes:-2], state[-2], state[-1]
        f, df, ddf = under[:, half]
        spring = k * (f @ q - y) + c * (f @ p + v * df @ q - w)
        push = (body + axle) * G + axle * (2.0 * v * df @ p + v * v * ddf @ q) + spring
        given, share = -square * q - f / modal * push, f / modal
        faster = given - share * (axle * f @ given) / (1.0 + axle * f @ share)  # Sherman and Morrison, for the axle
        return np.concatenate([p, faster, [w, spring / body]])

    state, dt, at = np.zeros(2 * modes + 2), until / steps, np.array([mode_of_two_spans(n, one, two, x) for n in b])
    least = 0.0
    for i in range(steps):
        k1 = rates(2 * i, state)
        k2 = rates(2 * i + 1, state + 0.5 * dt * k1)
        k3 = rates(2 * i + 1, state + 0.5 * dt * k2)
        state = state + dt / 6.0 * (k1 + 2.0 * (k2 + k3) + rates(2 * i + 2, state + dt * k3))
        least = min(least, float(at @ state[:modes]))
    return least


def largest_of_the_main_line(result: xr.Dataset) -> float:
    """Largest tension in examples/highline-overload.yaml, N, of its main line beside the knot."""
    links = (result.link_line == "main") & (result.link_xi > 12.0) & (result.link_xi < 15.0)
    return float(result.tension.where(links, drop=True).max())


def furthest_on_a_bungee(mass: float = 75.0, air: float = 0.35, wind: float = 5.0, rolling: float = 0.015) -> float:
    """How far along the rope of zip-line-bungee.yaml a rider comes, m without strain: v v' by forces along it.

    At each place the rope is the elastic catenary with her weight there; what draws her along is the difference of its
    tensions, and drag, rolling and the bungee of 25 N/m from 100.9 m on.
    """
    xi = np.linspace(3.0, 149.0, 147)
    ropes = [
        elastic_catenary(
            span=150.0, height=-12.0, length=150.9, weight=0.55 * G, axial_stiffness=6e6, loads=[(s, (0.0, -mass * G))]
        )
        for s in xi
    ]  # fmt: skip
    drawn = CubicSpline(xi, [rope.load_tensions[0] @ [1.0, -1.0] for rope in ropes])
    place = CubicSpline(xi, [rope.load_positions[0] for rope in ropes])

    def rate(s: float, v2: np.ndarray) -> list[float]:
        way, level = float(np.hypot(*place(s, 1))), float(place(s, 1)[0])
        relative = math.sqrt(max(v2[0], 0.0)) - wind * level / way
        force = float(drawn(s)) / way - rolling * mass * G * level / way - air * abs(relative) * relative
        return [2.0 * way / mass * (force - 25.0 * max(s - 100.9, 0.0))]

    def stops(s: float, v2: np.ndarray) -> float:
        return float(v2[0]) if s > 10.0 else 1.0

    stops.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(rate, (3.0, 149.0), [0.0], rtol=1e-8, max_step=0.5, events=stops)
    return float(found.t[-1])
