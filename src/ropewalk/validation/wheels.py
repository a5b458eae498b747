"""Ropes over saddles and sheaves, friction, and pendulums below trolleys."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.theory import friction
from ropewalk.theory.rope import elastic_catenary
from ropewalk.validation.known_case import KnownCase
from ropewalk.validation.known_number import KnownNumber
from ropewalk.validation.publication import Publication

CAPSTAN = Publication(
    "L. Euler, Remarques sur l'effet du frottement dans l'equilibre, 1762; J. A. Eytelwein, 1808: T2/T1 = exp(mu "
    "angle)",
    "the formula is elementary; the titles from memory",
)
ENERGY = Publication("conservation of energy", "elementary")
EA, CROWN = 1e6, 3.0


def tramway(length: float = 20.6, friction_: float = 0.0, gravity: float = 9.81, more: str = "") -> str:
    """A taut rope over a saddle of 2 m radius in its middle."""
    return f"""
gravity: {gravity}
lines:
  rope:
    start: [0, 0]
    end: [20, 0]
    length: {length}
    mass: 2
    axial_stiffness: 1.0e+6
    elements: 100
    saddles: {{tower: {{at: [10, {CROWN}], radius: 2, friction: {friction_}}}}}
    {more}
"""


PULLED = "end_support: {kind: moving, displacement: {time: [0, 1.2], value: [[0, 0], [0.3, 0]]}}\n    drag: 2\n    "
DRAWN = tramway(friction_=0.3, gravity=0.0, more=PULLED + "axial_damping: 300")


def log_ratio_over_angle(result: Any) -> float:
    """ln(T2/T1) over the angle of the saddle that the rope touches."""
    late, place = result.tension.to_numpy()[30:], result.position.to_numpy()[-1]
    (x, z), (u, w) = place[5] - place[0], place[-1] - place[-6]
    return float(np.log((late[:, -3] / late[:, 2]).mean()) / (np.arctan2(z, x) - np.arctan2(w, u)))


BEAD = """
loads:
  bead: {kind: mass, on: rope, mass: 0.1, travel: {kind: free, speed: 9, from: 3}}
run: {kind: dynamic, until: 1.6, every: 0.01}
"""


def speed_by_height(result: Any) -> float:
    """Smallest over largest 1/2 v^2 + g z of the bead."""
    place = result.contact_position.to_numpy()[:, 0]
    v = np.gradient(place, result.time.to_numpy(), axis=0)
    energy = (0.5 * (v**2).sum(axis=1) + 9.81 * place[:, 1])[2:-2]
    return float(energy.min() / energy.max())


def tension_by_height(result: Any) -> float:
    """Spread of T + T^2/(2 EA) - w z along the rope, over its mean."""
    T, z = result.tension.to_numpy()[-1], result.position.to_numpy()[-1, :, -1]
    same = T + T**2 / (2.0 * EA) - 2.0 * 9.81 * 0.5 * (z[1:] + z[:-1])
    return float(np.ptp(same) / same.mean())


SHEAVE = """
lines:
  rope:
    start: [0, 0]
    end: [12, 1]
    length: 13
    mass: 1.0e-6
    axial_stiffness: 1.0e+5
    elements: 20
    sheaves: {wheel: {at: [5, 3], friction: 0}}
run: {kind: equilibrium}
"""
WAYS = np.array([[-5.0, -3.0], [7.0, -2.0]])
TENSION = 1e5 * (float(np.hypot(*WAYS.T).sum()) / 13.0 - 1.0)
SUPPORT = -TENSION * (WAYS / np.hypot(*WAYS.T)[:, None]).sum(axis=0)
TIGHTROPE = """
lines: {rope: {start: [0, 0], end: [30, 0], length: 29.94, mass: 1.2, axial_stiffness: 10.0e+6, elements: 200}}
loads:
  walker:
    {kind: force, on: rope, force: [0, -800], contact: clamped, friction: 0.5, travel: {speed: 0, from: 6,
     measured: material}}
run: {kind: equilibrium}
"""


def foot() -> float:
    """Friction that a foot at 6 m needs as a capstan, by the elastic catenary."""
    rope = elastic_catenary(
        span=30.0, length=29.94, weight=1.2 * 9.81, axial_stiffness=1e7, loads=[(6.0, (0.0, -800.0))]
    )
    ahead = rope.force[1]
    angle = friction.turning_angle(ahead + rope.load_forces[0], ahead)
    behind, front = rope.load_tensions[0]
    return float(friction.capstan_coefficient(tension_behind=behind, tension_ahead=front, angle=angle))


def hanging(travel: str, mass: float, swing: float) -> str:
    """A payload of 100 kg on a rope of 2 m below a trolley on a firm line."""
    return f"""
lines: {{rope: {{start: [0, 0], end: [10, 0], tension: 1.0e+8, mass: 1000, axial_stiffness: 1.0e+10, elements: 11}}}}
loads:
  crab:
    kind: trolley
    on: rope
    mass: {mass}
    payload: {{mass: 100, length: 2, stiffness: 1.0e+7, swing: {swing}}}
    travel: {{{travel}, from: {5.0 / 1.01!r}}}
run: {{kind: dynamic, until: 6, every: 0.01, start: {{with_loads: true}}}}
"""


def period(result: Any) -> float:
    """Of the payload relative to the trolley, s, between passages from right to left."""
    x = (result.body_position.sel(axis="x").isel(body=0) - result.contact_position.sel(axis="x").isel(contact=0)).values
    t, i = result.time.values, np.flatnonzero((x[:-1] > 0.0) & (x[1:] <= 0.0))
    return float(np.diff(t[i] + (t[i + 1] - t[i]) * x[i] / (x[i] - x[i + 1])).mean())


def wide_swing(swing: float) -> float:
    """Period of a pendulum of 2 m, s: 4 sqrt(l/g) K(sin^2(swing/2))."""
    from scipy.special import ellipk

    return float(4.0 * np.sqrt(2.0 / 9.81) * ellipk(np.sin(0.5 * swing) ** 2))


FALL = """
lines: {rope: {start: [0, 0], end: [10, 0], tension: 1.0e+8, mass: 1000, axial_stiffness: 1.0e+10, elements: 10}}
loads:
  person:
    kind: trolley
    on: rope
    mass: 1
    payload: {mass: 70, length: 1.5, stiffness: 8.0e+3, at: [0.001, 0]}
    travel: {speed: 0, from: 5}
run: {kind: dynamic, until: 0.8, every: 0.002}
"""
PULL = 70.0 * 9.81 * (1.0 + float(np.sqrt(1.0 + 2.0 * 8e3 * 1.5 / (70.0 * 9.81))))
ZIP = """
lines: {line: {start: [0, 0], end: [100, -10], tension: 2.0e+6, mass: 0.1, axial_stiffness: 1.0e+8, elements: 40}}
loads: {pulley: {kind: mass, on: line, mass: 50, travel: {kind: free, from: 5, friction: 0.03}}}
run: {kind: dynamic, until: 8, every: 0.1, start: {with_loads: true}}
"""


def leash(result: Any) -> float:
    """Largest length of the rope between trolley and payload, m."""
    z = result.contact_position.to_numpy()[:, 0, -1] - result.body_position.to_numpy()[:, 0, -1]
    return float(z.max())


def slid(result: Any) -> float:
    """How far the contact has come, m."""
    place = result.contact_position.to_numpy()[:, 0]
    return float(np.hypot(*(place[-1] - place[0])))


PENDULUM = Publication("Chr. Huygens, 1673, and A.-M. Legendre's complete elliptic integral", "elementary")

CASES = (
    KnownCase(
        "saddle-friction", "A rope is drawn over a saddle with friction", CAPSTAN,
        DRAWN + "run: {kind: dynamic, until: 1.2, every: 0.02}\n",
        (
            KnownNumber("coefficient", "ln(T2/T1) over the angle", "", "closed form", lambda: 0.3, log_ratio_over_angle,
                "drag of 2/s along both spans adds up to 0.5 %", relative=1.5e-2),
        ),
        fault=("lines.rope.saddles.tower.friction=0.32",),
    ),
    KnownCase(
        "saddle-tension", "A heavy rope rests on a smooth saddle",
        Publication("T + T^2/(2 EA) - w z is the same all along a smooth rope; statics of ropes", "elementary"),
        tramway() + "run: {kind: equilibrium}\n",
        (
            KnownNumber("spread", "spread of T + T^2/(2 EA) - w z over its mean", "", "closed form", lambda: 0.0,
                tension_by_height, "links of 0.2 m on an arc", absolute=2e-3),
        ),
        fault=("gravity=0",),
    ),
    KnownCase(
        "saddle-bead", "A light bead slides over the saddle by its energy", ENERGY, tramway() + BEAD,
        (
            KnownNumber("energy", "smallest over largest energy per mass", "", "closed form",
                lambda: 1.0, speed_by_height,
                "the rope takes 1e-4 of it as it is set down; differences over 20 ms", absolute=4e-4),
            KnownNumber("crown", "greatest height", "m", "closed form", lambda: CROWN,
                lambda r: float(r.contact_position.to_numpy()[:, 0, 1].max()), "outputs every 10 ms", absolute=1e-3),
        ),
        fault=("loads.bead.travel.friction=0.02", "lines.rope.saddles.tower.at=[10, 2.99]"),
    ),
    KnownCase(
        "sheave-bisector", "A light rope runs over a sheave without friction",
        Publication("statics: one tension, a support force along the bisector", "elementary"), SHEAVE,
        (
            KnownNumber("tension", "tension", "N", "closed form", lambda: TENSION,
                lambda r: float(r.tension.to_numpy()[0].mean()),
                "the rope weighs 0.1 mN", relative=1e-5),
            KnownNumber("support", "upward force of the sheave on the rope", "N", "closed form",
                lambda: float(SUPPORT[1]),
                lambda r: float(r.reaction.sel(support="rope.wheel", axis="z")[0]), "as above", relative=1e-5),
        ),
        fault=("lines.rope.length=13.01",), quick=True,
    ),
    KnownCase(
        "foot-friction", "A foot stands on a tightrope, 6 m from its end", CAPSTAN, TIGHTROPE,
        (
            KnownNumber("coefficient", "friction that keeps it there", "", "closed form", foot,
                lambda r: float(r.contact_friction.to_numpy()[-1].ravel()[0]), "second order of 200 links",
                absolute=2e-6, relative=2e-4),
        ),
        fault=("lines.rope.length=29.95",), quick=True,
    ),
    KnownCase(
        "pendulum-small", "A payload swings below a trolley that is kept in its place", PENDULUM,
        hanging("speed: 0", 2e3, 0.02),
        (
            KnownNumber("period", "period, 2 pi sqrt(l/g)", "s", "closed form",
                lambda: 2.0 * np.pi * float(np.sqrt(2.0 / 9.81)),
                period, "the line gives by 0.1 mm", relative=2e-4),
        ),
        fault=("loads.crab.payload.length=2.01",), quick=True,
    ),
    KnownCase(
        "pendulum-wide", "The same with a swing of 1.2 rad", PENDULUM, hanging("speed: 0", 2e3, 1.2),
        (
            KnownNumber("period", "period, 4 sqrt(l/g) K", "s", "closed form", lambda: wide_swing(1.2), period,
                "the line gives by 0.1 mm", relative=2e-4),
        ),
        fault=("loads.crab.payload.length=2.01",),
    ),
    KnownCase(
        "pendulum-free-trolley", "A payload swings below a trolley of 300 kg that rolls",
        Publication("motion about the common centre of mass: 2 pi sqrt(l M/(g (M + m)))", "elementary"),
        hanging("kind: free", 300.0, 0.05),
        (
            KnownNumber("period", "period", "s", "closed form",
                lambda: 2.0 * np.pi * float(np.sqrt(2.0 * 300.0 / (9.81 * 400.0))), period,
                "the swing of 0.05 rad lengthens it by 2e-4, the sag of the line more", relative=1e-3),
        ),
        fault=("loads.crab.payload.length=2.02",),
    ),
    KnownCase(
        "leash-fall", "A person falls 1.5 m into a leash without losses",
        Publication("conservation of energy: m g (1 + sqrt(1 + 2 k h/(m g)))", "elementary"),
        FALL,
        (
            KnownNumber("length", "largest length of the leash", "m", "closed form", lambda: 1.5 + PULL / 8e3, leash,
                "the line gives by 0.1 mm, instants of 2 ms", relative=2e-4),
            KnownNumber("force", "largest force on the line, with the trolley's weight", "N", "closed form",
                lambda: PULL + 9.81, lambda r: float(-r.contact_force.sel(axis="z").min()),
                "the line swings under the pull", relative=2e-3),
        ),
        fault=("loads.person.payload.stiffness=8200",), quick=True,
    ),
    KnownCase(
        "zip-line", "A pulley slides down a taut line of 10 % with a coefficient of friction of 0.03",
        Publication("a body on an inclined plane: s = g (sin - mu cos) t^2/2", "elementary"), ZIP,
        (
            KnownNumber("way", "way in 8 s", "m", "closed form",
                lambda: 0.5 * 9.81 * (10.0 - 0.03 * 100.0) / float(np.hypot(100.0, 10.0)) * 64.0, slid,
                "the line sags by 6 mm under the pulley", relative=1e-3),
        ),
        fault=("loads.pulley.travel.friction=0.031",), quick=True,
    ),
)  # fmt: skip
