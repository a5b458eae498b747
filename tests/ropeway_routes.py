"""Numbers of examples of ropeways and cable cranes, read from their results."""

from __future__ import annotations

import numpy as np
import xarray as xr
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from ropewalk.results.ropeway import wheel_loads
from ropewalk.results.statistics import summary
from ropewalk.theory.rope import RestingRope, catenary, elastic_catenary


def wheels_of(result: xr.Dataset, name: str) -> list[int]:
    return [k for k, load in enumerate(result["load"].values) if str(load).partition(".")[0] == name]


def sway(result: xr.Dataset, name: str) -> np.ndarray:
    """Angle of the hanger from the vertical, towards +x, rad."""
    cabin = result.body_position.values[:, result.body.values.tolist().index(f"{name}.cabin")]
    away = cabin - result.contact_position.values[:, wheels_of(result, name)].mean(axis=1)
    return np.asarray(np.arctan2(away[:, 0], -away[:, -1]))


def sway_after(result: xr.Dataset, name: str, time: float) -> float:
    return float(np.abs(sway(result, name)[result.time.values > time]).max())


def sway_of_a_stop(speed: float, hanger: float, gravity: float = 9.81) -> float:
    """Largest angle of a pendulum whose pivot stops at once, by energy, rad."""
    return float(2.0 * np.arcsin(speed / (2.0 * np.sqrt(gravity * hanger))))


def pull_at_rest(result: xr.Dataset, name: str) -> float:
    return float(np.linalg.norm(result.hold_force.values[0, wheels_of(result, name)].sum(axis=0)))


def largest_over_least_wheel_load(result: xr.Dataset, name: str) -> float:
    loads = wheel_loads(result, name)[0]
    return float(loads.max() / loads.min())


def weight_on_wheels(result: xr.Dataset, name: str) -> float:
    """What the rope bears of a carriage across it and along it, and the hauling rope, at rest: its weight, N."""
    own = wheels_of(result, name)
    return float(result.hold_force.values[0, own, -1].sum() - result.contact_force.values[0, own, -1].sum())


def way(result: xr.Dataset, name: str) -> float:
    """What a carriage has gone until the end, along its line as it is, m."""
    place = result.contact_position.values[:, wheels_of(result, name)].mean(axis=1)
    return float(np.linalg.norm(np.diff(place, axis=0), axis=1).sum())


def pull_on_slopes(gravity: float = 9.81) -> float:
    """Mean of what both carriages of examples/ropeway-jig-back.yaml need on the slopes that they stand on, N."""
    level = 120.0 / np.hypot(120.0, 40.0)
    H, w = 500e3 * level * 1.03, 8.0 * gravity / level
    needed = 0.0
    for mass, side in ((1500.0, 1.0), (1100.0, -1.0)):
        slope = 1.0 / 3.0 + side * (mass * gravity / 4.0 + 30.0 * w) / H
        needed += 0.5 * mass * gravity * float(np.sin(np.arctan(slope)))
    return needed


def work_of_the_hoist(result: xr.Dataset) -> float:
    return float(summary(result)["energy"]["final"]["drive_work"])


def growth_of_the_sway(result: xr.Dataset) -> float:
    """Largest angle of the rope after it has been taken in over that before."""
    away = result.body_position.values[:, 0] - result.contact_position.values[:, 0]
    angle, time = np.abs(np.arctan2(away[:, 0], -away[:, -1])), result.time.values
    return float(angle[time > 22.0].max() / angle[(time > 2.0) & (time < 5.0)].max())


def tension_over_the_saddle(result: xr.Dataset) -> float:
    """Change of T + T^2/(2 EA) - w z of examples/ropeway-tramway.yaml from before its saddle to the end, at rest, N."""
    T, x, z = result.tension.values[0], result.position.values[0, :, 0], result.position.values[0, :, -1]
    same = T + T**2 / (2.0 * 220e6) - 11.7 * 9.81 * 0.5 * (z[1:] + z[:-1])
    return float(same[np.searchsorted(x, 70.0)] - same[-1])


def depth_of_the_carriage(result: xr.Dataset) -> float:
    """How far below the chord the carriage of examples/cable-crane-yarding.yaml stands at first, m."""
    x, z = result.contact_position.isel(time=0, contact=0).values
    return float(0.1 * x - z)


def depth_at_its_tension(result: xr.Dataset, force: float = 60e3, gravity: float = 9.81) -> float:
    """The same by the equilibrium of a shallow rope whose end a force pulls along the chord, m.

    The vertical force at the end follows from moments about the start, H from the rail; the rope's weight w is even
    along x, and the moment about the carriage gives its height.
    """
    x = float(result.contact_position.isel(time=0, contact=0).values[0])
    span, L = float(result.position.isel(time=0).values[-1, 0]), 203.0
    w, P = 1.5 * gravity * L / span, 1.5e3 * gravity
    # V L = H h + P x + w L^2 / 2, H ux + V uz = F
    more, (ux, uz) = (P * x + 0.5 * w * span**2) / span, np.array([200.0, 20.0]) / np.hypot(200.0, 20.0)
    H = (force - uz * more) / (ux + 0.1 * uz)
    return (P * x * (span - x) / span + 0.5 * w * x * (span - x)) / H


def largest_pull_of_the_winch(result: xr.Dataset) -> float:
    """Largest force along its rail once it runs, N."""
    reaction = result.reaction.sel(support="skyline.end").values[12:]
    return float((reaction @ np.array([200.0, 20.0]) / np.hypot(200.0, 20.0)).max())


def share_of_the_first_rope(result: xr.Dataset, gravity: float = 9.81) -> float:
    """Part of the crab that the first rope of examples/cable-crane-two-ropes.yaml bears, by what it pulls up with."""
    place, lines = result.position.values[0], result.line.values
    pull, of = result.tension.values[0], result.link_line.values
    up = 0.0
    for name in ("new ahead", "new behind"):
        way = np.diff(place[lines == name][-2:], axis=0)[0]  # the last link ends at the crab
        up -= pull[of == name][-1] * way[-1] / np.linalg.norm(way)
    return float((up - 1.255 * 12.0 * gravity * 2.0) / (8e3 * gravity))


def share_by_catenaries(gravity: float = 9.81) -> float:
    """The same of two elastic catenaries that sag alike under what each bears of the crab in the middle."""
    weight = 8e3 * gravity

    def rope(load: float, stiffness: float) -> RestingRope:
        return elastic_catenary(
            span=200.0, length=200.8, weight=12.0 * gravity, axial_stiffness=stiffness, loads=[(100.4, (0.0, -load))]
        )

    def gap(load: float) -> float:
        return float(rope(load, 220e6).load_positions[0, 1] - rope(weight - load, 110e6).load_positions[0, 1])

    return float(brentq(gap, 0.3 * weight, 0.9 * weight)) / weight


def beside_a_pendulum(
    result: xr.Dataset, name: str, length: float = 4.0, mass: float = 800.0, inertia: float = 0.0,
    damping: float = 400.0, gravity: float = 9.81,
) -> float:  # fmt: skip
    """Largest difference in rad from a pendulum, integrated apart, whose pivot goes as the middle of the wheels.

    (I + m l^2) w'' + m l (x'' cos w + (g + z'') sin w) + c (w' - a') = 0; a: angle of the rocker, against which its
    damper acts.
    """
    time, places = result.time.values, result.contact_position.values[:, wheels_of(result, name)]
    x, z = (CubicSpline(time, places[:, :, axis].mean(axis=1)) for axis in (0, 1))
    rocker = places[:, -1] - places[:, 0]
    a = CubicSpline(time, np.arctan2(rocker[:, 1], rocker[:, 0]))

    def rate(t: float, y: np.ndarray) -> list[float]:
        push = x(t, 2) * np.cos(y[0]) + (gravity + z(t, 2)) * np.sin(y[0])
        moment = mass * length * push + damping * (y[1] - a(t, 1))
        return [y[1], -moment / (inertia + mass * length**2)]

    exact = solve_ivp(rate, (0.0, time[-1]), [0.0, 0.0], t_eval=time, rtol=1e-6, atol=1e-8, max_step=0.05).y[0]
    return float(np.abs(sway(result, name) - exact).max())


def largest_sway(result: xr.Dataset, name: str) -> float:
    return float(np.abs(sway(result, name)).max())


def held_by_catenaries(
    place: np.ndarray, way: np.ndarray, start: np.ndarray, end: np.ndarray, weight: float,
    haul: tuple[float, float], counter: tuple[float, float],
) -> tuple[RestingRope, np.ndarray]:  # fmt: skip
    """The hauling rope and the pull in N of the counter rope that hold a weight there on frictionless wheels.

    Args:
        place: (axis,) m.
        way: (axis,) unit vector along the track.
        start: (axis,) m, where the counter rope ends.
        end: (axis,) m, where the drive is.
        weight: N.
        haul: N, EA, and N/m, of the hauling rope.
        counter: N, its tension at the start, and N/m, of the counter rope.
    """
    x, z = place - start
    chord = float(np.hypot(x, z))

    def tension(length: float) -> float:
        return float(np.linalg.norm(catenary(span=x, height=z, length=length, weight=counter[1]).force[0]))

    length = brentq(lambda L: tension(L) - counter[0], (1.0 + 1e-5) * chord, 1.2 * chord, xtol=1e-12)
    back = -catenary(span=x, height=z, length=length, weight=counter[1]).end_reaction
    far, up = end - place
    chord = float(np.hypot(far, up))

    def rope(length: float) -> RestingRope:
        return elastic_catenary(span=far, height=up, length=length, weight=haul[1], axial_stiffness=haul[0])

    own = brentq(lambda L: (rope(L).force[0] + back) @ way - weight * way[1], 0.99 * chord, 1.2 * chord, xtol=1e-12)
    return rope(own), back


def tension_at_the_drive_over_a_catenary(result: xr.Dataset) -> float:
    """Of examples/ropeway-counter-rope.yaml at first, over that of the catenaries that hold its carriage there."""
    places = result.contact_position.values[0]
    place, way = places.mean(axis=0), (places[-1] - places[0]) / np.linalg.norm(places[-1] - places[0])
    ends = np.array([0.0, 0.0]), np.array([400.0, 150.0])
    rope, _ = held_by_catenaries(place, way, *ends, 4e3 * 9.81, (25e6, 1.8 * 9.81), (30e3, 1.5 * 9.81))
    first = summary(result.isel(time=slice(0, 1)))["carriages"]["car"]["drive_tension"]["max"]["value"]
    return float(first / np.linalg.norm(rope.end_reaction))


def slip_over_that_of_the_friction(result: xr.Dataset) -> float:
    """Length that slips in examples/ropeway-slipping-drive.yaml over that in which friction takes its kinetic energy.

    Of 4 t and both ropes at 6 m/s, by what the sheave bears, T e^(friction wrap), less weights and the counter rope.
    """
    g, slip = 9.81, result.haul_slip.values[:, 0]
    begins, ends = int(np.argmax(slip > 0.0)), int(np.argmax(slip > slip[-1] - 1e-3))
    place = result.contact_position.values.mean(axis=1)[[begins, ends]]
    (x, z), way = place.mean(axis=0), float(np.linalg.norm(place[1] - place[0]))
    steep = float(np.diff(place, axis=0)[0, 1]) / way
    mass = 4e3 + 1.8 * np.hypot(400.0 - x, 80.0 - z) + 1.5 * np.hypot(x, z)
    bears = (25e3 + 1.5 * g * 80.0) * np.exp(0.16 * np.pi) - 1.8 * g * (80.0 - z)
    brakes = bears - (25e3 + 1.5 * g * z) + 4e3 * g * steep
    return float(slip[-1] / (0.5 * mass * 6.0**2 / brakes))


def least_pull_of_the_haul(result: xr.Dataset, least: float = 10e3) -> float:
    """Least pull of the hauling rope of a carriage over another in N, 1 at most: whether it is taut."""
    return float(min(1.0, summary(result)["carriages"]["car"]["pull"]["min"]["value"] / least))


def depth_in_the_second_span(result: xr.Dataset, after: float = 12.0) -> float:
    """Mean depth of the wheels of examples/ropeway-tower-brake.yaml below the chord from x = 250 m to the upper end,
    over that of a shallow rope with its weight and four forces; from `after` in s on, about one swing of the rope."""
    gaps, depths = [], []
    for place, wheels in zip(result.position.values, result.contact_position.values, strict=True):
        start, end = place[np.searchsorted(place[:, 0], 250.0)], place[-1]
        span, slope = end[0] - start[0], (end[1] - start[1]) / (end[0] - start[0])
        x = wheels[:, 0] - start[0]
        own = 11.7 * 9.81 * np.hypot(1.0, slope) * x * (span - x) / 2.0
        loads = sum(2e3 * 9.81 * np.minimum(x, a) * (span - np.maximum(x, a)) / span for a in x)
        gaps.append((start[1] + slope * x - wheels[:, 1]).mean())
        depths.append(((own + loads) / 600e3).mean())
    late = result.time.values > after
    return float(np.mean(gaps, where=late) / np.mean(depths, where=late))
