"""Taut strings: frequencies, travelling forces, masses and oscillators, waves, whirls."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.theory import chain, selfsimilar, string, whirl
from ropewalk.validation.known_case import KnownCase, frequencies
from ropewalk.validation.known_number import KnownNumber
from ropewalk.validation.measured import contact_depth, contact_force, deflection
from ropewalk.validation.publication import Publication

FRYBA = Publication(
    "L. Fryba, Vibration of Solids and Structures under Moving Loads, 3rd ed., Thomas Telford, 1999, ch. 18 (its "
    "series, "
    "summed)",
    "imprint of the book; the chapter from memory",
)
STRETCH = 1.001
"""Of the strings of 1 m, 1 N, 1 kg/m, EA = 1 kN: in the material coordinate they have the length 1/1.001 m and the
tension 1/1.001 N, exactly, for linearised motion."""
LENGTH, TENSION = 1.0 / STRETCH, 1.0 / STRETCH
WAVE = float(np.sqrt(TENSION))
UNIT: dict[str, Any] = {"length": LENGTH, "tension": TENSION, "mass": 1.0}
LINE = """
gravity: 0
lines:
  string: {{start: [0, 0], end: [1, 0], length: {length!r}, mass: 1, axial_stiffness: 1000, elements: {elements}}}
"""


def force(alpha: float, passages: float, elements: int = 200) -> str:
    """A small force at alpha times the wave speed, looked at after so many times of passage."""
    until = passages * LENGTH / (alpha * WAVE)
    return (
        LINE.format(length=LENGTH, elements=elements)
        + f"""
loads:
  force: {{kind: force, on: string, force: [0, -1.0e-6], travel: {{speed: {alpha * WAVE!r}, at_end: leave}}}}
run: {{kind: dynamic, until: {until!r}, every: {0.25 * until!r}}}
"""
    )


def deflected(alpha: float, passages: float, place: float = 0.5) -> float:
    """Of that string, by the closed form, m."""
    t = passages * LENGTH / (alpha * WAVE)
    return float(string.moving_force(place * LENGTH, t, force=1e-6, speed=alpha * WAVE, **UNIT))


def force_case(name: str, what: str, alpha: float, passages: float, **more: float) -> KnownCase:
    """The middle of the string at one instant."""
    row = KnownNumber(
        "middle", "deflection of the middle", "m", "closed form", lambda: deflected(alpha, passages),
        lambda result: deflection(result, 0.5 * LENGTH), "the kink at the load is smeared over one of 200 links",
        relative=more.get("relative", 2e-3),
    )  # fmt: skip
    return KnownCase(
        name, what, FRYBA, force(alpha, passages), (row,), quick=True, fault=("lines.string.mass=1.05",),
    )  # fmt: skip


WEIGHT = 1e-5
"""N per kg: so small compared with the tension that the motion is linear."""


def passing(load: str, alpha: float = 0.5, part: float = 0.9) -> str:
    """A load that passes a part of the string at alpha times the wave speed."""
    until = part * LENGTH / (alpha * WAVE)
    return (
        LINE.format(length=LENGTH, elements=200)
        + f"""
loads:
  load:
    on: string
    travel: {{speed: {alpha * WAVE!r}, at_end: leave}}
    {load}
run: {{kind: dynamic, until: {until!r}, every: {until / 400.0!r}}}
"""
    )


MASS = f"kind: mass\n    mass: 1\n    force: [0, {-WEIGHT:f}]"
OSCILLATOR = f"""kind: matrices
    coordinates: [body, wheel]
    mass: [[1, 0], [0, 0]]
    stiffness: [[5, -5], [-5, 5]]
    weight: [{WEIGHT:f}, 0]
    wheels: {{wheel: {{coordinate: wheel}}}}"""


def mass_passage(t: float) -> string.MassPassage:
    """Of 1 kg at half the wave speed."""
    return string.moving_mass(t, load_mass=1.0, speed=0.5 * WAVE, gravity=WEIGHT, **UNIT)


def at(part: float, alpha: float) -> float:
    """Instant at which the load has done a part of its way, s."""
    return part * LENGTH / (alpha * WAVE)


KINK = float(np.sqrt(0.05 / 1.05))
SPEED = 0.46 * KINK


def rate_of_contact(result: object) -> float:
    """Mean velocity downwards of the contact of the self-similar solution, from 0.35 s on, m/s."""
    t, z = result.time.to_numpy(), -result.contact_position.to_numpy()[:, 0, 1]  # type: ignore[attr-defined]
    late = t >= 0.35
    return float(np.polyfit(t[late], z[late], 1)[0])


def whirls_per_second(result: object) -> float:
    """How often the middle goes round the x-axis, Hz."""
    r = result.position.to_numpy()  # type: ignore[attr-defined]
    y, z = r[:, r.shape[1] // 2, 1:].T
    return float(np.polyfit(result.time, np.unwrap(np.arctan2(-y, z)), 1)[0]) / (2.0 * np.pi)  # type: ignore[attr-defined]


CASES = (
    KnownCase(
        "string-frequencies", "Natural frequencies of a taut string",
        Publication("Rayleigh, The Theory of Sound I, ch. 6, and J.-L. Lagrange's loaded string; f = n/(2 L) sqrt(P/m)",
               "elementary"),
        LINE.format(length=LENGTH, elements=100) + "run: {kind: equilibrium}\n",
        (
            KnownNumber("first", "first frequency", "rad/s", "closed form", lambda: np.pi * WAVE / LENGTH,
                lambda s: s.lowest_frequency, "second order of 100 links: (pi/100)^2/24", relative=6e-5, order=1.9),
            KnownNumber("of-the-chain", "the same of a chain of 100 links", "rad/s", "closed form",
                lambda: float(chain.transverse_frequencies(links=100, length=LENGTH, axial_stiffness=1e3, mass=1.0,
                                                           stretch=STRETCH)[0]),
                lambda s: s.lowest_frequency, "the chain is solved exactly (Lagrange's loaded string)", relative=1e-7),
        ),
        fault=("lines.string.mass=1.01",), answer=frequencies, coarser=("lines.string.elements=50",), quick=True,
    ),
    force_case("string-force-slow", "A force travels along a taut string at half the wave speed", 0.5, 0.6),
    force_case("string-force-reflected", "The same after it has left: waves come back from both supports", 0.5, 1.6),
    force_case("string-force-near-critical", "A force at 0.85 of the wave speed", 0.85, 0.75),
    force_case("string-force-fast", "A force that is twice as fast as the waves", 2.0, 0.75),
    KnownCase(
        "string-mass", "A mass as heavy as the string passes it at half the wave speed",
        Publication("C. E. Smith, Motions of a stretched string carrying a moving mass particle, J. Appl. Mech. 31 "
                    "(1964); "
               "B. Dyniewicz and C. I. Bajer, Paradox of a particle's trajectory moving on a string, Arch. Appl. Mech. "
               "79 (2009); solved here by the delay equation of the contact force",
               "title and abstract of the second; the first from memory"),
        passing(MASS),
        (
            KnownNumber("depth", "depth of the mass in the middle", "m", "closed form",
                lambda: float(mass_passage(at(0.5, 0.5)).deflection), lambda r: contact_depth(r, at(0.5, 0.5)),
                "200 links, of the second order; the support bears a part of the load on the first "
                "link", relative=5e-4),
            KnownNumber("depth-late", "depth at 0.8 of the way", "m", "closed form",
                lambda: float(mass_passage(at(0.8, 0.5)).deflection), lambda r: contact_depth(r, at(0.8, 0.5)),
                "as above", relative=5e-4),
            KnownNumber("force", "contact force at 0.6 of the way", "N", "closed form",
                lambda: float(mass_passage(at(0.6, 0.5)).contact_force), lambda r: contact_force(r, at(0.6, 0.5)),
                "as above", relative=5e-4),
        ),
        fault=("loads.load.mass=1.2",), quick=True,
    ),
    KnownCase(
        "string-oscillator", "A mass on a spring passes a string at half the wave speed",
        Publication("L. Fryba (1999), ch. 18, for the string; the coupling solved here by the delay equation of the "
                    "contact "
               "force", "imprint of the book; the chapter from memory"),
        passing(OSCILLATOR),
        (
            KnownNumber("depth", "depth of the contact in the middle", "m", "closed form",
                lambda: float(string.moving_oscillator(at(0.5, 0.5), sprung_mass=1.0, stiffness=5.0, speed=0.5 * WAVE,
                                                       gravity=WEIGHT, **UNIT).deflection),
                lambda r: contact_depth(r, at(0.5, 0.5)), "200 links", relative=5e-4),
            KnownNumber("force", "contact force at 0.8 of the way", "N", "closed form",
                lambda: float(string.moving_oscillator(at(0.8, 0.5), sprung_mass=1.0, stiffness=5.0, speed=0.5 * WAVE,
                                                       gravity=WEIGHT, **UNIT).contact_force),
                lambda r: contact_force(r, at(0.8, 0.5)), "200 links", relative=5e-4),
        ),
        fault=("loads.load.stiffness=[[7, -7], [-7, 7]]",),
    ),
    KnownCase(
        "string-self-similar", "A force is switched on and travels along a string that it stretches: nonlinear waves",
        Publication("J. D. Cole, C. B. Dougherty and J. H. Huth, Constant-strain waves in strings, J. Appl. Mech. 20 "
               "(1953), "
               "and H. A. Rakhmatulin (1945), for the jump conditions; the moving force derived here"),
        f"""
gravity: 0
lines: {{string: {{start: [0, 0], end: [2.1, 0], length: 2, mass: 1, axial_stiffness: 1, elements: 384}}}}
loads:
  force:
    {{kind: force, on: string, force: [0, -0.01], contact: clamped, travel: {{speed: {SPEED!r}, from: 1}}}}
run: {{kind: dynamic, until: 0.95, every: 0.01}}
""",
        (
            KnownNumber("rate", "velocity of the force across the string", "m/s", "closed form",
                lambda: abs(float(selfsimilar.moving_force(force=0.01, speed=SPEED, axial_stiffness=1.0, mass=1.0,
                                                           prestrain=0.05).contact_velocity[1])),
                rate_of_contact, "384 links, of the first order", relative=5e-3),
        ),
        fault=("lines.string.axial_stiffness=1.1",), quick=True,
    ),
    KnownCase(
        "string-whirl", "A taut string whirls in a circle of large radius",
        Publication("G. F. Carrier, On the non-linear vibration problem of the elastic string, Q. Appl. Math. 3 (1945)",
               "author, journal and result, in his note of 1949 there; volume from memory"),
        """
gravity: 0
lines: {string: {start: [0, 0], end: [1, 0], tension: 100, mass: 0.01, axial_stiffness: 10000, elements: 60}}
run:
  kind: dynamic
  until: 50 ms
  every: 0.25 ms
  accuracy: 0.1 mm
  start: {kind: mode, number: 1, amplitude: 50 mm, direction: [0, 1], whirl: true}
""",
        (
            KnownNumber("frequency", "turns per second of a circle of 50 mm on 1 m", "Hz", "closed form",
                lambda: float(whirl.whirl_frequency(0.05, length=1.0, tension=100.0, mass=0.01 / 1.01,
                                                    axial_stiffness=1e4)) / (2.0 * np.pi),
                whirls_per_second, "the theory leaves out squares of the slope, 2e-4; 60 links, 3e-4", relative=8e-4),
        ),
        fault=("lines.string.axial_stiffness=9500",), quick=True,
    ),
)  # fmt: skip
