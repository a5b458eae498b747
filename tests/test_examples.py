"""Every example loads, runs to its end, and gives the physical number that it is known for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import crab_routes as crabs
import example_routes as routes
import footbridge_routes as footbridges
import overhead_routes as overhead
import ropeway_routes as ropeways
import train_routes as trains
import vehicle_routes as vehicles
from ropewalk.results.contact_statistics import contact_statistics
from ropewalk.results.statistics import summary
from ropewalk.scenario import load
from ropewalk.simulate import simulate
from ropewalk.theory import friction
from ropewalk.theory.highline import stand
from ropewalk.theory.rope import RestingRope, elastic_catenary
from rough_bridge import over_its_modes

SHORT = ("run.until=2 s", "run.every=50 ms")
NEAR = crabs.hung(20.0, (220e6, 110e6), 8e3 * 9.81, span=200.0, length=200.8, mass=12.0)
TOWER_CABIN = 5.0, 6.6e3, 6e3, 12e3  # hanger, m, mass, kg, inertia, kg m^2, and damper, N m s
CUT_SOON = ("lines.main.cut.time=0.2 s", "run.until=1.5 s")
FOLDER = Path(__file__).parent.parent / "examples"


@dataclass(frozen=True)
class Known:
    """What is known of an example: a number of its result, by how much it may be off, and how it is shortened; a value
    that takes long is a function."""

    what: str
    number: Callable[[xr.Dataset], float]
    value: float | Callable[[], float]
    tolerance: float
    settings: tuple[str, ...] = ()


def lowest_point_of_the_path(result: xr.Dataset) -> float:
    return -float(result.contact_position.sel(axis="z", contact=0).min())


def time_of_the_lowest_point(result: xr.Dataset) -> float:
    return float(result.time[result.contact_position.sel(axis="z", contact=0).argmin("time")])


def exact(result: xr.Dataset, frame: int, weight: float, axial_stiffness: float) -> RestingRope:
    """The elastic catenary with the loads of one frame, between the ends that the supports have there."""
    now = result.isel(load_path=frame)
    span, height = np.diff(now.position.to_numpy()[[0, -1]], axis=0)[0]
    loads = list(zip(now.contact_xi.to_numpy(), map(tuple, now.contact_force.to_numpy()), strict=True))
    return elastic_catenary(span=span, height=height, length=float(result.xi[-1]), weight=weight,
                            axial_stiffness=axial_stiffness, loads=loads)  # fmt: skip


def friction_of(rope: RestingRope, k: int) -> float:
    """Coefficient that load k needs as a capstan."""
    ahead = rope.force[k + 1]
    angle = friction.turning_angle(ahead + rope.load_forces[k], ahead)
    behind, front = rope.load_tensions[k]
    return float(friction.capstan_coefficient(tension_behind=behind, tension_ahead=front, angle=angle))


TIGHTROPE = elastic_catenary(
    span=30.0, length=29.94, weight=1.2 * 9.81, axial_stiffness=1e7, loads=[(14.97, (0.0, -800.0))]
)


def off_the_catenary(weight: float, axial_stiffness: float) -> Callable[[xr.Dataset], float]:
    """Largest distance of a load from where the elastic catenary has it, over a few frames, m."""

    def gap(result: xr.Dataset) -> float:
        frames = range(0, result.sizes["load_path"] - 1, 9)
        place = result.contact_position.to_numpy()
        start = result.position.to_numpy()[:, 0]
        return max(
            float(np.abs(start[k] + exact(result, k, weight, axial_stiffness).load_positions - place[k]).max())
            for k in frames
        )

    return gap


def last_but_one_friction(result: xr.Dataset) -> float:
    """Coefficient of the foot ahead, just before it stands on the support, less that of the elastic catenary."""
    rope = exact(result, -2, 3.0 * 9.81, 2e5)
    return float(result.contact_friction[-2, 1]) - friction_of(rope, 1)


def where_friction_ends(result: xr.Dataset) -> float:
    """Path after which the foot ahead needs more than the given coefficient of 0.6, m, by the elastic catenary."""
    frames = range(result.sizes["load_path"] - 1)
    needed = np.array([friction_of(exact(result, k, 3.0 * 9.81, 2e5), 1) for k in frames])
    said = float(result.attrs["warnings"].split("front foot")[0].rsplit("load path ", 1)[1].split(" m")[0])
    return said - float(result.load_path[int(np.argmax(needed > 0.6))])


def whirls_per_second(result: xr.Dataset) -> float:
    """How often the middle goes round the x-axis, Hz."""
    y, z = result.position.values[:, result.sizes["node"] // 2, 1:].T
    return float(np.polyfit(result.time.values, np.unwrap(np.arctan2(-y, z)), 1)[0]) / (2.0 * np.pi)


def rolling_resistance(result: xr.Dataset) -> float:
    """Coefficient of the front wheel halfway, from the tensions of the elastic catenary."""
    return friction_of(exact(result, 30, 8.0 * 9.81, 1.2e8), 1)


def speed_of_the_moving_load(result: xr.Dataset) -> float:
    """Speed of the person under the pulley where the brake begins, m/s."""
    i = int(np.argmax(result.contact_xi.values[:, 0] >= 131.1))
    return float(np.hypot(*result.body_velocity.values[i, 0]))


def deepest_place(result: xr.Dataset) -> float:
    """Lowest z of the first body, m."""
    return float(result.body_position.values[:, 0, 1].min())


def depth_of_the_mass(result: xr.Dataset) -> float:
    """How deep the mass is in the middle of the string, m."""
    return float(-np.interp(5.0, result.contact_position[:, 0, 0], result.contact_position[:, 0, 1]))


def force_before_the_end(result: xr.Dataset) -> float:
    """Contact force at 90 % of the string over the weight."""
    force = -result.contact_force.values[:, 0, 1]
    return float(np.interp(9.0, result.contact_position[:, 0, 0], force)) / (4.0 * 9.81)


def tension_by_height(result: xr.Dataset) -> float:
    """Change of T + T^2/(2 EA) - w z from just before the saddle to the end, at rest, N."""
    T, z, x = (
        result.tension.values[0], result.position.values[0, :, 1], result.position.values[0, :, 0]
    )  # fmt: skip
    same = T + T**2 / (2.0 * 55e6) - 4.2 * 9.81 * 0.5 * (z[1:] + z[:-1])
    return float(same[np.searchsorted(x, 105.0)] - same[-1])


def tension_in_the_middle(result: xr.Dataset) -> float:
    """Tension while the walker is between 18 and 22 m, in the mean over her steps and the time of a bounce, N."""
    body = result.body_position.values[:, 0, 0]
    return float(result.tension.values[(body > 18.0) & (body < 22.0)].mean())


def deflection_at_midspan(result: xr.Dataset) -> float:
    """Largest, from rest, m."""
    z = result.position.sel(axis="z").to_numpy()
    return float((z[0] - z)[:, z.shape[1] // 2].max())


def acceleration_of_the_body(result: xr.Dataset) -> np.ndarray:
    """Upwards, m/s^2."""
    return np.gradient(np.gradient(result.body_position[:, 0, -1].to_numpy(), result.time), result.time)


def least_contact_force(result: xr.Dataset) -> float:
    """Smallest pressure of the first wheel on the line well inside of it, N."""
    force, xi = -result.contact_force[:, 0, -1].to_numpy(), result.contact_xi[:, 0].to_numpy()
    return float(force[(xi > 0.05 * float(result.xi[-1])) & (xi < 0.95 * float(result.xi[-1]))].min())


def collection(name: str, scale: float = 1.0) -> Callable[[xr.Dataset], float]:
    """A statistic of the pantograph."""
    return lambda result: scale * float(getattr(contact_statistics(result)["pantograph"], name))


def collected(*known: tuple[str, float, float]) -> list[Known]:
    """Statistics of a pantograph in N, the uplift in mm: their names, what is known of them, and how closely."""
    return [
        Known(name, collection(name, 1e3 if name == "uplift" else 1.0), value, apart) for name, value, apart in known
    ]


def reaction_upwards(result: xr.Dataset) -> float:
    """Sum of all reactions in the first frame, N."""
    return float(result.reaction.sel(axis="z")[0].sum())


def weight_of_the_footbridge() -> float:
    """From the lengths in the file, and of the deck from its tension, N."""
    scenario = load(FOLDER / "suspension-footbridge.yaml")
    deck = 40.0 / (1.0 + 60e3 / 80e6)
    return 9.81 * sum(line.mass * (line.length or deck) for line in scenario.lines.values())


def off_the_parabola(result: xr.Dataset) -> float:
    """Tension of the cable at midspan in the first frame less w L^2/(8 f), N."""
    place, tension = result.position.values[0], result.tension.values[0]
    sag = 6.0 - float(place[result.line.values == "cable", 1].min())
    row = load(FOLDER / "suspension-bridge.yaml").hung("hanger").values()
    even = 9.81 * (40.0 + 6.0 * 40.99 / 40.0 + 0.6 * sum(one.length or 0.0 for one in row) / 40.0)
    return float(tension[result.link_line.values == "cable"].min()) - even * 40.0**2 / (8.0 * sag)


def rough_deflection(result: xr.Dataset) -> float:
    """Largest deflection of midspan of the rough bridge, over that by modes."""
    return -float(result.position[:, 15, 1].min()) / over_its_modes(result)[0]


def rough_force(result: xr.Dataset) -> float:
    """Largest force of a tyre on the rough bridge, over that by modes."""
    x = np.array([-25.0, -20.0]) + 25.0 * result.time.values[:, None]
    within = (x > 0.5) & (x < 24.5)
    return -float(result.contact_force.values[:, :, 1][within].min()) / over_its_modes(result)[1]


def tension_above_the_counterweight(result: xr.Dataset) -> float:
    """Of the last link of the rope in the first frame, N."""
    return float(result.tension[0].values[result.link_line.values == "rope"][-1])


def lowest_of_the_deck(result: xr.Dataset) -> float:
    """Smallest z of the middle of the longer span, m."""
    at = int(np.abs(result.xi.values - 34.0).argmin())
    return float(result.position.sel(axis="z")[:, at].min())


def largest_ratio_at_the_sheaves(result: xr.Dataset) -> float:
    """Largest ratio of the tensions in the two links beside a sheave over exp(mu angle), in motion."""
    rope = result.position.values[:, result.line.values == "rope"]
    tension = result.tension.values[:, result.link_line.values == "rope"]
    found = []
    for place in ((10.0, 12.0), (50.0, 12.0)):
        for r, T in zip(rope, tension, strict=True):
            e = int(np.abs(0.5 * (r[1:] + r[:-1]) - place).sum(axis=1).argmin())
            one, two = np.array(place) - r[e - 1], r[e + 2] - np.array(place)
            angle = np.arccos(one @ two / np.linalg.norm(one) / np.linalg.norm(two))
            ratio = T[e + 1] / T[e - 1]
            found.append(max(ratio, 1.0 / ratio) / np.exp(0.05 * angle))
    return max(found)


def audit(result: xr.Dataset) -> float:
    """Largest imbalance over the energy turned over."""
    energy = summary(result)["energy"]
    return float(energy["largest_imbalance"]["value"]) / float(energy["turnover"])


def of_lines(result: xr.Dataset, owner: str, quantity: str, which: str = "max") -> float:
    """A largest value that the summary tells of a line or a place."""
    found = summary(result)["lines"][owner][quantity][which]
    return float(found["value"] if isinstance(found, dict) else found)


def free_vibration_of_the_deck(result: xr.Dataset) -> float:
    """Largest deflection at midspan after the axle has gone, m."""
    gone = ~np.isfinite(result.contact_xi[:, 0].values) & (result.time.values > 0.3)
    return float(np.abs(result.position.sel(axis="z")[gone, result.sizes["node"] // 2]).max())


TRAIN = trains.HIGH_SPEED.crossing(trains.hslm_a(18, 18.0, 2.0), 170e3, 200.0 / 3.6, 1.0)
RESONANT = trains.HIGH_SPEED.crossing(trains.hslm_a(18, 18.0, 2.0), 170e3, 324.0 / 3.6, 1.0, modes=5)
COACHES = trains.SHORT.crossing(trains.COACHES, 112e3, 206.0 / 3.6, 0.5)


def articulated() -> float:
    """Ten coaches of examples/bridge-articulated-train.yaml on eleven shared bogies over five modes, m."""
    coaches = vehicles.articulated(
        10, 18.7, 9.35, (22525.0, 810e3), (2900.0, 2508.0), 1900.0, (2e6, 12e3), (580e3, 20e3)
    )  # fmt: skip
    bridge = trains.Bridge(20.0, 10e3, 16.2114e9, 0.6283)
    return float(vehicles.crossing(coaches, bridge, 46.75, 210.0 / 46.75)[1].max())


STANDING = stand(span=40.0, standing_tension=1500.0, stiffness=55e3, mass=57.0)
CRAB = elastic_catenary(
    span=120.0, length=120.8, weight=9.0 * 9.81, axial_stiffness=1.2e8, loads=[(30.0, (0.0, -6500.0 * 9.81))]
)
LORRY = routes.lorry_crossing()
"""Modules of packages that are not always there, by example."""
KNOWN = {
    # Converged answers on which two formulations agree; tests/overhead/test_en50318_2002.py has all quantities and the
    # ranges of acceptance. 0.25 m and 1 ms leave 0.4 N of sigma.
    "en50318-2002-250.yaml": collected(("mean", 116.0, 0.2), ("deviation", 28.2, 0.5), ("uplift", 52.9, 0.5)),
    "en50318-2002-300.yaml": collected(("mean", 115.3, 0.2), ("deviation", 33.3, 0.5), ("uplift", 60.2, 0.6)),
    "overhead-line-limits.yaml": [
        # What presses it is in balance with the mean of the force, but for what swings in at the ends of three spans.
        Known("static force by the balance of means, N", lambda r: overhead.static_force(r, "front"), 100.0, 0.4),
        # Alone the rear one keeps them, as the front one does: sigma 24 N.
        Known("limits that the front one breaks", lambda r: overhead.failures(r, "front"), 0.0, 0.0),
        Known("limits that the rear one breaks", lambda r: overhead.failures(r, "rear"), 2.0, 0.0),
        Known("audit, part of the energy", audit, 0.0, 0.04),
    ],
    "overhead-line-overlap.yaml": [
        # Along both lines, of which now the one and now the other bears the head.
        Known("static force by the balance of means, N", lambda r: overhead.static_force(r, "front"), 100.0, 0.5),
        Known("limits that the front one breaks", lambda r: overhead.failures(r, "front"), 0.0, 0.0),
        Known("limits that the rear one breaks", lambda r: overhead.failures(r, "rear"), 2.0, 0.0),
        Known("audit, part of the energy", audit, 0.0, 0.02),
    ],
    "overhead-line-head.yaml": [
        # Two strips, 50 kN/m each; two spans only.
        Known(
            "static force by the balance of means, N",
            lambda r: overhead.static_force(r, "front", springs=(4200.0, 100e3)),
            100.0,
            1.0,
        ),
        # 900 mm between the horns; the head does not swing in roll for long, at 5 Hz with damping.
        Known("moment of the springs at the horns over that of the wire", overhead.roll_over_moment, 1.0, 0.05),
        Known("limits that are broken", lambda r: overhead.failures(r, "front"), 0.0, 0.0),
        Known("audit, part of the energy", audit, 0.0, 0.005),
    ],
    "overhead-line-missing-dropper.yaml": [
        # A string of 13 m under its weight, 0.9 * 1.35 kg/m at 20 kN: q L^2 / (8 T). Bending rounds its ends off.
        Known(
            "sag in the gap at rest, m",
            lambda r: overhead.sag_without_a_dropper(r, 323.5, 336.5),
            0.9 * 1.35 * 9.81 * 13.0**2 / (8.0 * 20e3),
            6e-4,
        ),
        Known("static force by the balance of means, N", lambda r: overhead.static_force(r, "pantograph"), 110.0, 0.5),
        Known("audit, part of the energy", audit, 0.0, 0.01),
    ],
    "overhead-line-stitch-wire.yaml": [
        # The messenger's 21 kN but for the 3.5 kN of the stitch wire beside it.
        Known("tension over a support, N", lambda r: overhead.messenger_over_a_support(r, 130.0), 17.5e3, 5.0),
        # (T1 + T2) L / R of both wires, to the outside of a curve to the left.
        Known("lateral pull at a support, N", lambda r: overhead.lateral_pull(r, 2), -(27e3 + 21e3) * 65.0 / 5e3, 0.5),
        Known("audit, part of the energy", audit, 0.0, 0.01),
    ],
    "overhead-line-dropper-failure.yaml": [
        Known("pull of the dropper once it has failed, N", overhead.pull_after_failure, 0.0, 0.0),
        Known("static force by the balance of means, N", lambda r: overhead.static_force(r, "front"), 110.0, 0.5),
        Known("audit, part of the energy", audit, 0.0, 0.01),
    ],
    "overhead-line-dc.yaml": [
        # Three masses: 110 N and 0.012 (160 km/h)^2 are in balance with the means of force and height.
        Known(
            "force on the lowest mass, N",
            lambda r: overhead.static_force(r, "pantograph", 160.0, (15500.0, 7000.0, 50e3)),
            110.0 + 0.012 * (160.0 / 3.6) ** 2,
            0.3,
        ),
        Known("limits that are broken", lambda r: overhead.failures(r, "pantograph"), 0.0, 0.0),
        Known("audit, part of the energy", audit, 0.0, 0.01),
    ],
    "overhead-line-cold.yaml": [
        # A level wire that may not shorten: T + EA alpha dT. The messenger, which sags less, pulls it up a little.
        Known(
            "tension of the contact wire, N",
            lambda r: overhead.tension_at_first(r, "line.contact"),
            10e3 + 12e6 * 1.7e-5 * 30.0,
            60.0,
        ),
        Known("audit, part of the energy", audit, 0.0, 0.01),
    ],
    # Known: the mean force that is asked for, and the answers of an independent calculation, in the plane, with other
    # elements and another filter: to 4 % of the deviations, 8 N of the extremes, 3 mm. The pantograph presses with what
    # the slow rise of the wire demands; in motion it rises 1 to 2 cm higher, and the spring of its base takes 2 and 3 N
    # of the mean. Of the provisional ranges, recalled and not seen in the standard, both this and that calculation
    # miss the one of the smallest force at 320 km/h (55 to 82 N); here the mean (166.5 N) and the uplift (64 mm) miss
    # theirs, too, by 0.4 N and 0.8 mm.
    "simple-ac-275.yaml": collected(
        ("mean", 143.4, 2.5),
        ("deviation", 35.3, 1.2),
        ("deviation_low", 26.2, 0.8),
        ("deviation_high", 22.7, 0.8),
        ("maximum", 241.0, 8.0),
        ("minimum", 75.0, 5.0),
        ("uplift", 45.0, 3.0),
        ("loss", 0.0, 0.0),
    ),
    "simple-ac-320.yaml": collected(
        ("mean", 169.3, 4.0),
        ("deviation", 59.9, 2.0),
        ("deviation_low", 41.8, 1.2),
        ("deviation_high", 42.4, 1.6),
        ("maximum", 309.0, 8.0),
        ("minimum", 45.0, 5.0),
        ("uplift", 62.5, 3.0),
        ("loss", 0.0, 0.0),
    ),
    "bridge-sprung-mass.yaml": [
        # 20 modes (tests/theory). Second order of 48 links: 2.4157, 2.4094, 2.4078 mm with 24, 48, 96.
        Known("deflection at midspan, m", deflection_at_midspan, 2.4073013e-3, 4e-6),
        Known("largest acceleration up, m/s^2", lambda r: float(acceleration_of_the_body(r).max()), 0.14797, 5e-4),
        Known("and down", lambda r: float(acceleration_of_the_body(r).min()), -0.14219, 5e-4),
    ],
    "bridge-vehicle-2004.yaml": [
        # 20 modes, as above; of the acceleration 48 links miss 0.4 %.
        Known("deflection at midspan, m", deflection_at_midspan, 1.2738549e-3, 2e-6),
        Known("largest acceleration up, m/s^2", lambda r: float(acceleration_of_the_body(r).max()), 0.036866, 2e-4),
        Known("and down", lambda r: float(acceleration_of_the_body(r).min()), -0.031704, 2e-4),
    ],
    "bridge-biggs.yaml": [
        Known("deflection at midspan, m", deflection_at_midspan, float(LORRY.beam_deflection(15.0).max()), 4e-5),
        Known("smallest contact force, N", least_contact_force, float(LORRY.contact_force[30:570].min()), 2e3),
    ],
    "bridge-hslm.yaml": [
        # By nine modes. The links of 1 m miss 0.2 % of the deflection and of the second frequency 0.03 %, outputs every
        # 4 ms see the peak of the acceleration to 0.3 %.
        Known(
            "deflection at midspan, m",
            lambda r: of_lines(r, "midspan", "deflection"),
            float(TRAIN.deflection(10.0).max()),
            2.5e-5,
        ),
        Known(
            "acceleration at midspan, m/s^2",
            lambda r: of_lines(r, "midspan", "acceleration"),
            float(np.abs(TRAIN.filtered(10.0, 30.0)).max()),
            0.05,
        ),
        # At resonance, 324 km/h = 5 Hz * 18 m, the deck swings 45 mm with 40 m/s^2. Damping bounds it, and 0.01 Hz
        # beside the frequency count: 0.5 %.
        Known(
            "deflection at 324 km/h, m",
            lambda r: of_lines(r, "midspan", "deflection"),
            float(RESONANT.deflection(10.0).max()),
            2.5e-4,
            ("loads.train.travel.speed=324 km/h",),
        ),
        Known(
            "acceleration at 324 km/h, m/s^2",
            lambda r: of_lines(r, "midspan", "acceleration"),
            float(np.abs(RESONANT.filtered(10.0, 30.0)).max()),
            0.4,
            ("loads.train.travel.speed=324 km/h",),
        ),
    ],
    "bridge-cancellation.yaml": [
        # All odd modes cancel, and the others do not move midspan; 40 links leave 0.2 % of the 3 mm under the axle.
        Known("free vibration behind the axle, m", free_vibration_of_the_deck, 0.0, 1.2e-5),
        # The third mode adds (1/3)^5 of the first, 0.4 %; 40 links 0.1 %.
        Known(
            "the same at 300 km/h, m",
            free_vibration_of_the_deck,
            trains.residual(trains.UNDAMPED, 200e3, 300.0 / 3.6),
            2e-5,
            ("loads.axle.travel.speed=300 km/h",),
        ),
    ],
    "continuous-bridge-train.yaml": [
        # Positions every fiftieth of the line, 0.8 m, miss up to 0.3 % of a smooth minimum; the corner over the pier is
        # put back to the second order of the links of 1 m.
        Known(
            "static moment over the pier, N m",
            lambda r: -of_lines(r, "pier", "moment", "static"),
            trains.moment_over_the_pier(trains.LONG_COACHES, 140e3, 20.0),
            1.2e4,
        ),
    ],
    "ropeway-saddle.yaml": [
        # T + T^2/(2 EA) - w z, at rest the same on both sides of the saddle; links of 1 m on its arc of 1.3 m.
        Known("tension by height over the saddle, N", tension_by_height, 0.0, 120.0, ("run.until=0.1 s",)),
        Known("audit, part of the energy", audit, 0.0, 1e-4, ("loads.cabin.travel.from=100 m", "run.until=2 s")),
    ],
    "ropeway-soft-stop.yaml": [
        # By energy; the pivot gives way by a part of 1e-3, and peaks are seen every 50 ms. The speed across the hanger
        # is that along the rope times 0.995.
        Known(
            "sway after a stop at once, rad",
            lambda r: ropeways.sway_after(r, "at once", 1.0),
            ropeways.sway_of_a_stop(1.99, 4.0),
            0.004,
        ),
        Known("sway after two steps, rad", lambda r: ropeways.sway_after(r, "in two steps", 3.1), 0.0, 0.01),
    ],
    "ropeway-jig-back.yaml": [
        # Slopes by hand, 1/3 +- (W/4 + 60 w/2)/H with H = 474 kN and 3 % more under load: the mean of what 1.5 t at
        # 3/4 and 1.1 t at 1/4 of the span need.
        Known(
            "pull of the hauling rope at rest, N",
            lambda r: ropeways.pull_at_rest(r, "full"),
            ropeways.pull_on_slopes(),
            25.0,
        ),
        # What the one goes the other comes, but for what the rope and the rails stretch by.
        Known("ways of both over each other", lambda r: ropeways.way(r, "full") / ropeways.way(r, "empty"), 1.0, 3e-3),
        Known("audit, part of the energy", audit, 0.0, 1e-3),
    ],
    "ropeway-tower-speed.yaml": [
        # Places of pivots every 50 ms, and splines through them.
        Known("first cabin beside a pendulum, rad", lambda r: ropeways.beside_a_pendulum(r, "constant"), 0.0, 3e-4),
        Known("second cabin beside a pendulum, rad", lambda r: ropeways.beside_a_pendulum(r, "regulated"), 0.0, 3e-4),
        # The course at least halves the sway.
        Known(
            "sway of the second over that of the first",
            lambda r: ropeways.largest_sway(r, "regulated") / ropeways.largest_sway(r, "constant"),
            0.0,
            0.5,
        ),
        Known("audit, part of the energy", audit, 0.0, 1e-3),
    ],
    "ropeway-counter-rope.yaml": [
        # The line has links of 7 m, on which the wheels stand: their slope is that of a rope to 0.1 %.
        Known(
            "tension at the drive over that of catenaries",
            ropeways.tension_at_the_drive_over_a_catenary,
            1.0,
            2e-3,
            ("run.until=0.1 s",),
        ),
        # It brakes on its way up, and both ropes stay taut.
        Known("hauling rope taut: least pull over 10 kN, capped", ropeways.least_pull_of_the_haul, 1.0, 1e-12),
        Known("audit, part of the energy", audit, 0.0, 1e-3),
    ],
    "ropeway-slipping-drive.yaml": [
        # The cabin goes on swinging with a part of the energy, and the ropes stretch before they slip.
        Known("slip over that of the friction", ropeways.slip_over_that_of_the_friction, 1.0, 0.1),
        Known("audit, part of the energy", audit, 0.0, 1e-3),
    ],
    "ropeway-tramway.yaml": [
        # Frictionless wheels and, at rest, saddles leave it as it is; links of 0.8 m on an arc of 1.5 m.
        Known("tension by height, N", ropeways.tension_over_the_saddle, 0.0, 400.0, ("run.until=0.1 s",)),
        Known(
            "weight on rope and hauling rope, N",
            lambda r: ropeways.weight_on_wheels(r, "car"),
            4e3 * 9.81,
            4.0,
            ("run.until=0.1 s",),
        ),
        Known(
            "largest over least wheel load",
            lambda r: ropeways.largest_over_least_wheel_load(r, "car"),
            1.0,
            0.015,
            ("run.until=0.1 s",),
        ),
    ],
    "ropeway-tower-brake.yaml": [
        # Wheels swing with the rope by 3 % there, and the counterweight by 1 %; on 600 links 1.0044.
        Known("depth of the wheels over that at rest", ropeways.depth_in_the_second_span, 1.0, 0.01),
        # Places of wheels every 50 ms, which shake as they roll over nodes, and splines through them.
        Known("cabin beside a pendulum, rad", lambda r: ropeways.beside_a_pendulum(r, "car", *TOWER_CABIN), 0.0, 2e-3),
        Known("hauling rope taut", lambda r: ropeways.least_pull_of_the_haul(r, 3e3), 1.0, 1e-12),
        Known("audit, part of the energy", audit, 0.0, 1e-3),
    ],
    "cable-crane-two-ropes.yaml": [
        # Polygons of 40 links instead of catenaries.
        Known("part of the first rope", ropeways.share_of_the_first_rope, ropeways.share_by_catenaries(), 1e-4),
    ],
    "cable-crane-travelling-on-two-ropes.yaml": [
        # Polygons of 20 links instead of catenaries.
        Known("part of the new rope at 20 m", lambda r: float(crabs.shares(r)[0, 0]), NEAR.share[0], 1e-4, SHORT),
        Known("height there, m", lambda r: float(r.contact_position[0, 0, 1]), NEAR.height, 1e-3, SHORT),
        Known("pull of the hauling rope, N", lambda r: float(r.hold_force[0, :, 0].sum()), NEAR.pull, 20.0, SHORT),
        Known("audit, part of the energy", audit, 0.0, 1e-4, SHORT),
    ],
    "cable-crane-yarding.yaml": [
        Known(
            "depth of the carriage beside that of a shallow rope at 60 kN",
            lambda r: ropeways.depth_of_the_carriage(r) / ropeways.depth_at_its_tension(r),
            1.0,
            2e-3,
            ("run.until=10 s",),
        ),
        # Dead band and damper leave it between 60 + 1 kN, where it begins to pay out, and 60 + 1 + 4 * 0.5 kN.
        Known("largest pull of the winch, N", ropeways.largest_pull_of_the_winch, 62e3, 1e3, ("run.until=10 s",)),
        Known("audit, part of the energy", audit, 0.0, 1e-6, ("run.until=10 s",)),
    ],
    "cable-crane-hoist.yaml": [
        # m g times what is taken in, and 2 % for what swings: the rope pulls more, and the energy of the sway grows.
        Known("work of the hoist, J", ropeways.work_of_the_hoist, 3000.0 * 9.81 * 8.0, 6e3),
        Known("sway grows by", ropeways.growth_of_the_sway, (20.0 / 12.0) ** 0.75, 0.1),
    ],
    "bridge-damage.yaml": [
        # 14 modes of 96 Hermite elements (tests/stepped_beams.py); 48 links are of the second order at steps, 0.01 %.
        Known("deflection at midspan, m", lambda r: of_lines(r, "midspan", "deflection"), 4.944813e-3, 2e-6),
        Known("at the damage, m", lambda r: of_lines(r, "damage", "deflection"), 4.609465e-3, 2e-6),
    ],
    "footbridge-crowd.yaml": [
        # SETRA's is the 95th of 100 crowds on a mode by itself; this is one crowd on a deck with two modes nearby.
        Known(
            "peak acceleration, m/s^2",
            lambda r: of_lines(r, "deck", "acceleration"),
            footbridges.setra(40, 0.006, 1060.0, 40.0),
            1.0,
        ),
    ],
    "footbridge-lock-in.yaml": [
        # The forces of the gait itself are still felt 10 s after the start: a tenth.
        Known("growth rate of the sway, 1/s", footbridges.growth_of_the_sway, footbridges.growth_by_theory(60), 0.006),
    ],
    "bridge-coaches.yaml": [
        # By nine modes with their own ratios; errors as of bridge-hslm.yaml.
        Known(
            "deflection at midspan, m",
            lambda r: of_lines(r, "midspan", "deflection"),
            float(COACHES.deflection(7.5).max()),
            2.5e-5,
        ),
        Known(
            "acceleration at midspan, m/s^2",
            lambda r: of_lines(r, "midspan", "acceleration"),
            float(np.abs(COACHES.filtered(7.5, 30.0)).max()),
            0.05,
        ),
    ],
    "bridge-ice3.yaml": [
        # Over five modes, tests/vehicle_routes.py; the links of 1 m miss 0.56 %.
        Known("deflection at midspan, m", lambda r: of_lines(r, "midspan", "deflection"), 5.8337e-3, 4e-5),
        Known(
            "largest contact force, N",
            lambda r: summary(r)["trains"]["train"]["largest_force"]["value"],
            157986.0,
            1500.0,  # its peak at midspan is flat; blows at the ends ring by 1 %
        ),
    ],
    "bridge-articulated-train.yaml": [
        # The same; the links miss 0.2 %.
        Known("deflection at midspan, m", lambda r: of_lines(r, "midspan", "deflection"), articulated, 3e-5),
    ],
    "continuous-bridge.yaml": [
        # By modes, with their cube: tests/system/test_inner_supports.py.
        Known("lowest place of the longer span, m", lowest_of_the_deck, -6.2863e-3, 2e-6),
    ],
    "bedded-line-vehicle.yaml": [
        Known("deflection in the middle, m", deflection_at_midspan, routes.track_under_a_bogie(), 6e-5),
        # The bogie still swings a little from where it entered, so that its axle loads are not quite the static ones.
        Known("that of an endless track, m", deflection_at_midspan, routes.endless_track_under_two_axles(), 3e-4),
    ],
    "zip-line.yaml": [
        # The rope is lighter than she is but not massless: it moves with her, and she swings. 2.5 % are missing.
        Known("speed at the brake, m/s", speed_of_the_moving_load, routes.zip_line_speed(), 0.35),
        # First order in the links of 1 m: 2.5e-3.
        Known("audit, part of the energy", audit, 0.0, 4e-3),
    ],
    "zip-line-brake.yaml": [
        # Eddy currents hold nobody: she stands where rolling (0.015) and the wind on her (0.003 of her weight) do.
        Known("slope of her way where she stops", routes.slope_where_it_stands, 0.0, 0.018),
        Known("audit, part of the energy", audit, 0.0, 1e-3),
    ],
    "zip-line-bungee.yaml": [
        # Of 22 m of bungee; the rope, as heavy as she is, moves with her, and she swings: 2 % of the speed, 0.4 m.
        Known(
            "furthest place, m without strain",
            lambda r: float(r.contact_xi.max()),
            routes.furthest_on_a_bungee(),
            0.5,
            ("run.until=16 s",),
        ),
        Known("audit, part of the energy", audit, 0.0, 1e-3, ("run.until=16 s",)),
    ],
    "highline-backup-cut.yaml": [
        # The elastic catenary with the loops' mass spread over it; they hang on it at six places, and pull a little.
        Known("tension at rest, N", lambda r: float(r.tension[0].max()), routes.highline_tension(), 25.0, CUT_SOON),
        Known("audit, part of the energy", audit, 0.0, 2e-3, CUT_SOON),
    ],
    "highline-overload.yaml": [
        # The knot bears 2.8 kN, and a step later nothing; links beside it are as taut as it is, but for waves.
        Known("largest tension of the main line, N", routes.largest_of_the_main_line, 2.8e3, 90.0),
        Known("audit, part of the energy", audit, 0.0, 2e-3),
    ],
    "highline-bounce.yaml": [
        # Small bounces on webbing as stiff as where nothing slips: they still are 0.5 m wide, frames 50 ms apart.
        Known(
            "frequency over that of two pieces", lambda r: routes.bounces(r) / routes.bounces_without_slip(r), 1.0, 0.02
        ),
        # Printed by slacktivity.com for wider bounces, from 1.6 to 3.6 kN: see docs/notes/highlines.md.
        Known("frequency, Hz", routes.bounces, 0.35, 0.02),
        Known("audit, part of the energy", audit, 0.0, 1e-4),
    ],
    "leash-fall.yaml": [
        # Without damping she would go 4.6 cm deeper.
        Known(
            "deepest place, m", lambda r: float(r.body_position[:, 0, 1].min()), routes.deepest_without_losses(), 0.06
        ),
        Known("audit, part of the energy", audit, 0.0, 2e-3),
    ],
    "mass-approaching-support.yaml": [
        # The string sags by its own weight, w L^2/(8P), and its curvature w/P makes the mass heavier by V^2 w/P; then
        # table 2b of the inertial string, alpha = 0.5, kappa = 2. Left is the stretch: T rises by 3 %, so that
        # 1 % is missing.
        Known("depth in the middle, m", depth_of_the_mass, 0.0981 * (0.2612362 * 1.25 + 0.125), 6e-4),
        # A regression number. The linear string says 4.8127 * 1.25 = 6.0 there, and infinite at the end; the rope is
        # 7 % tighter by then, and its waves, which the force jumps with, come earlier.
        Known("contact force at 0.9 L over weight", force_before_the_end, 6.9, 0.4),
    ],
    "cable-crane-crab.yaml": [
        # At rest with the crab: second order of the links of 2 m.
        Known("tension at rest, N", lambda r: float(r.tension[0].max()), float(CRAB.tension(0.0)), 60.0),
        # The winch holds the speed but for what it needs to keep in step with a moving rope.
        Known("largest speed, m/s", lambda r: float(r.contact_speed.max()), 6.0, 0.05),
        Known("speed at the end, m/s", lambda r: float(r.contact_speed[-1, 0]), 0.0, 0.02),
    ],
    "highline-walker.yaml": [
        # Two straight weightless halves; she bounces by 15 %, and a walk of 2.5 s is a bit more than one bounce.
        Known("tension in the middle, N", tension_in_the_middle, float(STANDING.tensions[0]), 60.0),
        Known("audit, part of the energy", audit, 0.0, 0.03),
    ],
    "tightrope.yaml": [
        # 200 straight links for the rope's own sag: w h^2/(8 P) = 2e-6 m less deep.
        Known("depth in the middle, m", lowest_point_of_the_path, float(-TIGHTROPE.load_positions[0, 1]), 3e-6),
        # The tension of the first link is that of its middle: weight of half a link, w h/2 sin(0.04) = 0.04 N.
        Known("largest tension, N", lambda r: float(r.tension.max()), float(TIGHTROPE.tension(0.0)), 0.05),
    ],
    "heavy-slack-line.yaml": [
        # Second order of the links of 0.135 m: curvature w/H = 0.022/m, (h^2/8) w/H = 5e-5 m.
        Known("feet off the exact line, m", off_the_catenary(3.0 * 9.81, 2e5), 0.0, 1e-4),
        # The same over a span of 25 m, in angles of 1 rad, at tensions of a ratio of 2.
        Known("coefficient near the tree, less the exact one", last_but_one_friction, 0.0, 1e-4),
        # The remark gives the path with four digits.
        Known("where friction ends, less the exact path, m", where_friction_ends, 0.0, 6e-4),
    ],
    "cable-crane.yaml": [
        # Second order of the links of 4 m: (h^2/8) w/H = 9e-4 m.
        Known("wheels off the exact rope, m", off_the_catenary(8.0 * 9.81, 1.2e8), 0.0, 1e-3),
        # The same over a span of 240 m, a part of 4e-6, in angles of 0.1 rad at a wheel.
        Known("rolling resistance of the exact rope", rolling_resistance, 0.02, 4e-5),
        # By the counterweight, at the end that is free to slide.
        Known("horizontal reaction at the end, N", lambda r: float(r.reaction[-1, 1, 0]), 180e3, 1e-3),
    ],
    "whirling-string.yaml": [
        # The theory leaves out squares of the slope of 0.16: 2e-4. The 60 links: 3e-4. (The whirl of 1 m, its mass over
        # the stretched length.)
        Known("whirls per second", whirls_per_second, 1.27155427531352 * 50.0 * np.sqrt(1.01), 0.05),
        Known("audit, J", lambda r: float(np.abs(r.energy.sel(form="imbalance")).max()), 0.0, 1e-5),
    ],
    "trampoline-net.yaml": [
        # At rest the edge bears the person and the net: threads of 20 g/m every 100 mm both ways over 24 m^2 are 9.6 kg
        # as laid out, 40 N in 12 kN shorter. Half a thread along the edge is missing or not: 0.3 kg.
        Known("reaction at the start, N", reaction_upwards, (80.0 + 9.6 / (1.0 + 40.0 / 12e3)) * 9.81, 3.0),
        # It grows late in undamped nets: 5 % at 0.1 ms, 0.1 % at 0.06 ms, which is chosen.
        Known("audit, part of the energy", audit, 0.0, 0.005),
    ],
    "suspension-bridge.yaml": [
        # H = w L^2/(8 f) of an even weight; the cable is heavier per span where it is steep: 0.2 %, 40 N.
        Known(
            "tension of the cable at midspan less that of a parabola, N",
            off_the_parabola,
            0.0,
            60.0,
            ("run.until=2 s",),
        ),
        Known("audit, part of the energy", audit, 0.0, 1e-4, ("run.until=2 s",)),
    ],
    "bridge-ballasted-track.yaml": [
        # TTB-2D with four elements between sleepers and 4000 steps a second (benchmarks/ttb2d.py): 0.593224 mm. 28
        # links of bridge miss 2e-5 of it.
        Known("deflection at midspan, m", lambda r: of_lines(r, "midspan", "deflection"), 0.593224e-3, 2e-7),
        # Of the first order of the step, by dampers.
        Known("audit, part of the energy", audit, 0.0, 5e-3),
    ],
    "vehicle-on-rough-bridge.yaml": [
        # Twelve modes of the bridge under the same lorry (tests/rough_bridge.py); 30 elements, output every 2 ms.
        Known("deflection of midspan over that of another route", rough_deflection, 1.0, 5e-4),
        Known("largest contact force over that of another route", rough_force, 1.0, 2e-3),
    ],
    "suspension-footbridge.yaml": [
        # Cable 6 kg/m, deck 40 kg/m and hangers 0.6 kg/m by their unstrained lengths, without the walker. The deck is
        # longer than a straight one of this tension by its waves between the hangers: 1.3 mm, 0.5 N.
        Known("reaction at the start, N", reaction_upwards, weight_of_the_footbridge(), 1.0, ("run.until=2 s",)),
        Known("audit, part of the energy", audit, 0.0, 1e-4, ("run.until=2 s",)),
    ],
    "sheaves.yaml": [
        # The counterweight of 800 kg and the rope between it and the sheave; the rope bends over a point there, and its
        # nodes have a mass: what a link weighs may be missing.
        Known("tension above the counterweight at rest, N", tension_above_the_counterweight, 800.0 * 9.81, 5.0),
        # Slip begins at exp(0.05 * angle): never above, and reached while the load bounces.
        Known("largest ratio over exp(mu angle)", largest_ratio_at_the_sheaves, 1.0, 0.01),
        Known("audit, part of the energy", audit, 0.0, 2e-5),
    ],
    "moving-force.yaml": [
        # 3.061, 3.072, 3.082, 3.087, 3.090 m with 50, 100, 200, 400, 800 links: first order, towards 3.092 m. The
        # tolerance is one and a half times what 100 links miss.
        Known("depth of the path, m", lowest_point_of_the_path, 3.092, 0.03),
        # A flat minimum, looked at every 10 ms.
        Known("when the load is lowest, s", time_of_the_lowest_point, 0.88, 0.015),
    ],
}


@pytest.mark.parametrize("name", sorted(path.name for path in FOLDER.iterdir()))
def test_an_example_runs_and_gives_its_number(name: str) -> None:
    assert name in KNOWN, f"examples/{name} has no number here: every example asserts one"
    settings = {known.settings for known in KNOWN[name]}
    results = {s: simulate(load(FOLDER / name, s)) for s in settings}
    for result in results.values():
        assert result.attrs["outcome"] == "completed", result.attrs["advice"]
        assert np.isfinite(result.position.values).all()
    for known in KNOWN[name]:
        found = known.number(results[known.settings])
        value = known.value() if callable(known.value) else known.value
        print(f"{name}: {known.what}: {found:.6g}, known {value:g}")
        assert found == pytest.approx(value, abs=known.tolerance), known.what


def test_every_known_example_is_there() -> None:
    assert set(KNOWN) <= {path.name for path in FOLDER.iterdir()}
