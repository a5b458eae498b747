"""Beams: frequencies, forces, masses and vehicles that cross them, elastic beds."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.theory import beam, foundation
from ropewalk.theory.beam_vehicle import oscillator
from ropewalk.validation.known_case import KnownCase, frequencies
from ropewalk.validation.known_number import KnownNumber
from ropewalk.validation.measured import acceleration, contact_force, deepest, deflection
from ropewalk.validation.publication import Publication

FRYBA = Publication(
    "L. Fryba, Vibration of Solids and Structures under Moving Loads, 3rd ed., Thomas Telford, 1999, ch. 1",
    "imprint of the book; the chapter from memory",
)
YANG_1997 = Publication(
    "Y.-B. Yang and J.-D. Yau, Vehicle-bridge interaction element for dynamic analysis, J. Struct. Eng. 123 (1997), "
    "1512-1518: its data; the numbers by 20 modes"
)
YANG_2004 = Publication(
    "Y.-B. Yang, C. W. Lin and J. D. Yau, Extracting bridge frequencies from the dynamic response of a passing "
    "vehicle, "
    "J. Sound Vib. 272 (2004), 471-493: its data; the numbers by 20 modes"
)
EULER = Publication("L. Euler and D. Bernoulli, 18th century; in every textbook of vibrations", "elementary")
UNIT: dict[str, Any] = {"length": 25.0, "bending_stiffness": 8.323e9, "mass": 2303.0}
SPEED = 100.0 / 3.6


def bridge(
    elements: int = 48, length: float = 25.0, stiffness: float = 8.323e9, mass: float = 2303.0, more: str = "",
) -> str:  # fmt: skip
    """A simply supported beam that does not stretch."""
    return f"""
gravity: 0
lines:
  bridge:
    start: [0, 0]
    end: [{length}, 0]
    length: {length}
    mass: {mass}
    bending_stiffness: {stiffness!r}
    axial_stiffness: 1.0e+10
    elements: {elements}
    {more}
"""


def motion(until: float, every: float) -> str:
    """Linearised motion."""
    return f"run: {{kind: dynamic, geometry: linearised, until: {until!r}, every: {every!r}}}\n"


def travelling(kind: str, speed: float) -> str:
    """A load of that kind that crosses."""
    return f"loads:\n  load:\n    on: bridge\n    travel: {{speed: {speed!r}, at_end: leave}}\n    {kind}\n"


FORCE = "kind: force\n    force: [0, -50.0e+3]"
BODY = """kind: matrices
    coordinates: [body, wheel]
    mass: [[{mass}, 0], [0, {wheel}]]
    stiffness: [[{k}, -{k}], [-{k}, {k}]]
    damping: [[{c}, -{c}], [-{c}, {c}]]
    weight: [{weight}, {wheel_weight}]
    wheels: {{wheel: {{coordinate: wheel}}}}"""


def sprung(mass: float, k: float, c: float = 0.0, wheel: float = 0.0) -> str:
    """A mass on a spring and damper above a wheel, with its weight."""
    return BODY.format(mass=mass, wheel=wheel, k=k, c=c, weight=9.81 * mass, wheel_weight=9.81 * wheel)


def largest_force_deflection() -> float:
    """Largest deflection at midspan under 50 kN before it leaves, m."""
    peak = beam.moving_force_peak(force=5e4, speed=SPEED, x=12.5, free_vibration=False, **UNIT)
    return peak.deflection


def crossing(t: Any, **more: Any) -> beam.Crossing:
    """The sprung mass of Yang and Yau by 20 modes."""
    return beam.moving_oscillator(t, load_mass=5750.0, load_stiffness=1595e3, speed=SPEED, modes=20, **UNIT, **more)


def light_cart(t: Any) -> beam.Crossing:
    """That of Yang, Lin and Yau by 20 modes."""
    return beam.moving_oscillator(
        t,
        load_mass=1200.0,
        load_stiffness=500e3,
        speed=10.0,
        modes=20,
        length=25.0,
        bending_stiffness=3.3e9,
        mass=4800.0,
    )


def lorry() -> beam.Crossing:
    """A lorry in the manner of Biggs, by 20 modes."""
    vehicle = oscillator(32e3, load_stiffness=6e6, load_damping=3e4, wheel_mass=4e3)
    return beam.moving_vehicle(
        np.linspace(0.0, 1.2, 601), vehicle=vehicle, speed=25.0, length=30.0, bending_stiffness=12e9, mass=6e3,
        damping=0.62 * 6e3, modes=20, tolerance=1e-4,
    )  # fmt: skip


def clamped(count: int) -> float:
    """Frequency of a beam clamped at both ends, rad/s."""
    return float(beam.natural_frequencies(count, ends="clamped", **UNIT)[-1])


def lowest(spectrum: Any, number: int = 1) -> float:
    """Frequency of a mode up and down, rad/s."""
    shapes = spectrum.modes.shape
    upright = [k for k in range(len(shapes)) if np.abs(shapes[k, :, 2]).max() > 0.5]
    return float(spectrum.modes.frequency[upright[number - 1]])


REST = "run: {kind: equilibrium}\n"
BUILT_IN = "start_support: {kind: fixed, clamped: true}\n    end_support: {kind: fixed, clamped: true}"
TRACK: dict[str, Any] = {"bending_stiffness": 10e6, "foundation": 5e6, "mass": 600.0, "damping": 10800.0}
STILL: dict[str, Any] = {"bending_stiffness": 10e6, "foundation": 5e6, "mass": 600.0}
NEAR = np.linspace(-5.0, 5.0, 2001)
"""Places about the force, m."""

CASES = (
    KnownCase(
        "beam-frequencies", "Natural frequencies of a simply supported beam", EULER, bridge() + REST,
        (
            KnownNumber("first", "first frequency", "rad/s", "closed form",
                lambda: float(beam.natural_frequencies(1, **UNIT)[0]), lowest, "second order of 48 links",
                relative=5e-4, order=1.9),
            KnownNumber("third", "third frequency", "rad/s", "closed form",
                lambda: float(beam.natural_frequencies(3, **UNIT)[2]), lambda s: lowest(s, 3),
                "second order of 48 links: nine times as much", relative=4e-3, order=1.9),
        ),
        fault=("lines.bridge.bending_stiffness=8.5e9",), answer=frequencies, coarser=("lines.bridge.elements=24",),
        quick=True,
    ),
    KnownCase(
        "beam-clamped", "Natural frequency of a beam clamped at both ends", EULER, bridge(more=BUILT_IN) + REST,
        (
            KnownNumber("first", "first frequency, 4.7300^2 sqrt(EI/m)/L^2", "rad/s", "closed form", lambda: clamped(1),
                        lowest, "second order of 48 links", relative=2e-3, order=1.8),
        ),
        fault=("lines.bridge.bending_stiffness=8.5e9",), answer=frequencies, coarser=("lines.bridge.elements=24",),
        quick=True,
    ),
    KnownCase(
        "beam-tensioned", "Natural frequency of a beam under tension", EULER,
        bridge(more="").replace("length: 25.0\n", "tension: 10.0e+6\n") + REST,
        (
            KnownNumber("first", "first frequency, with EI and T", "rad/s", "closed form",
                lambda: float(beam.natural_frequencies(1, tension=1e7, length=25.0, bending_stiffness=8.323e9,
                                                       mass=2303.0)[0]),
                lowest, "second order of 48 links", relative=5e-4),
        ),
        settings=("lines.bridge.axial_stiffness=1e13",), fault=("lines.bridge.tension=12e6",),
        answer=frequencies, quick=True,
    ),
    KnownCase(
        "beam-force", "A force of 50 kN crosses a simply supported beam at 100 km/h", FRYBA,
        bridge(elements=24) + travelling(FORCE, SPEED) + motion(0.9, 0.001),
        (
            KnownNumber("deflection", "largest deflection at midspan", "m", "series", largest_force_deflection,
                lambda r: deepest(r, 12.5), "fourth order of 24 links; outputs every 1 ms at a flat maximum",
                relative=2e-4),
        ),
        fault=("lines.bridge.bending_stiffness=8.5e9",),
    ),
    KnownCase(
        "beam-impact-factor", "Largest impact factor of a force on a beam, at 0.617 of the critical speed",
        Publication("M. Olsson, On the fundamental moving load problem, J. Sound Vib. 145 (1991), 299-307, for the "
               "problem; the "
               "number by all modes", "title, author, journal, volume, pages"),
        bridge(elements=64) + travelling(FORCE, 0.617 * float(beam.resonance_speeds(1, **UNIT)[0]))
        + motion(25.0 / (0.617 * float(beam.resonance_speeds(1, **UNIT)[0])), 0.001),
        (
            KnownNumber("factor", "largest deflection at midspan over F L^3/(48 EI)", "", "series",
                lambda: float(beam.impact_factor(0.617 * beam.resonance_speeds(1, **UNIT)[0], x=12.5,
                                                 free_vibration=False, **UNIT)),
                lambda r: deepest(r, 12.5) / (5e4 * 25.0**3 / (48.0 * 8.323e9)), "fourth order of 64 links; 1 ms",
                relative=2e-4),
        ),
        fault=("loads.load.travel.speed=90",), quick=True,
    ),
    KnownCase(
        "beam-sprung-mass", "A sprung mass crosses a bridge", YANG_1997,
        bridge(elements=24) + travelling(sprung(5750.0, 1595e3), SPEED) + motion(0.9, 0.001),
        (
            KnownNumber("deflection", "largest deflection at midspan", "m", "series",
                lambda: float(crossing(0.371118).beam_deflection(12.5).max()), lambda r: deepest(r, 12.5),
                "fourth order of 24 links", relative=2e-4, order=2.5),
            KnownNumber("acceleration", "largest acceleration of the mass upwards", "m/s^2", "series",
                lambda: -float(crossing(np.linspace(0.446, 0.45, 21)).body_acceleration.min()),
                lambda r: float(acceleration(r).max()), "24 links", relative=4e-3),
        ),
        fault=("loads.load.stiffness=[[1.7e6, -1.7e6], [-1.7e6, 1.7e6]]", "lines.bridge.mass=2400"),
        coarser=("lines.bridge.elements=12",),
    ),
    KnownCase(
        "beam-light-cart", "A light cart on a spring takes up the frequency of the bridge", YANG_2004,
        bridge(stiffness=3.3e9, mass=4800.0) + travelling(sprung(1200.0, 5e5), 10.0) + motion(2.5, 0.002),
        (
            KnownNumber("deflection", "largest deflection at midspan", "m", "series",
                lambda: float(light_cart(np.linspace(1.32, 1.327, 15)).beam_deflection(12.5).max()),
                lambda r: deepest(r, 12.5), "fourth order of 48 links", relative=1e-4),
            KnownNumber("acceleration", "largest acceleration of the cart upwards", "m/s^2", "series",
                lambda: -float(light_cart(np.linspace(1.33, 1.345, 31)).body_acceleration.min()),
                lambda r: float(acceleration(r).max()), "48 links, between outputs", relative=1e-3),
        ),
        fault=("loads.load.stiffness=[[5.5e5, -5.5e5], [-5.5e5, "
               "5.5e5]]", "lines.bridge.bending_stiffness=3.4e9"),
    ),
    KnownCase(
        "beam-mass", "A mass crosses a bridge in rigid contact",
        Publication("R. Willis (1849) and G. G. Stokes (1849) for the problem; Fryba (1999) for the convective "
                    "terms; the "
               "number by 20 modes", "authors and years, in later lists of references; the chapters from memory"),
        bridge() + travelling("kind: matrices\n    coordinates: [wheel]\n    mass: [[5750]]\n    stiffness: [[0]]\n"
                              "    weight: [56407.5]\n    wheels: {wheel: {coordinate: wheel}}", SPEED)
        + motion(0.9, 0.001),
        (
            KnownNumber("deflection", "largest deflection at midspan", "m", "series",
                lambda: float(beam.moving_mass(np.linspace(0.34, 0.42, 161), load_mass=5750.0, speed=SPEED, modes=20,
                                               tolerance=1e-6, **UNIT).beam_deflection(12.5).max()),
                lambda r: deepest(r, 12.5), "fourth order of 48 links", relative=1e-4),
        ),
        fault=("loads.load.mass=[[6500]]",),
    ),
    KnownCase(
        "beam-lorry", "A lorry with a sprung and an unsprung mass crosses a highway bridge",
        Publication("in the manner of J. M. Biggs, Introduction to Structural Dynamics, McGraw-Hill, 1964",
               "title, publisher and year of the book; the numbers are ours by 20 modes"),
        bridge(length=30.0, stiffness=12e9, mass=6e3, more="drag: 0.62")
        + travelling(sprung(32e3, 6e6, 3e4, 4e3), 25.0) + motion(1.2, 0.002),
        (
            KnownNumber("deflection", "largest deflection at midspan", "m", "series",
                lambda: float(lorry().beam_deflection(15.0).max()), lambda r: deepest(r, 15.0),
                "fourth order of 48 links", relative=2e-4),
            KnownNumber("force", "contact force in the "
                                 "middle", "N", "series", lambda: float(lorry().contact_force[300, 0]),
                lambda r: contact_force(r, 0.6), "48 links", relative=1e-2),
        ),
        fault=("loads.load.weight=[330e3, 39240]", "lines.bridge.bending_stiffness=12.4e9"),
    ),
    KnownCase(
        "beam-bed", "A force stands on a long beam on an elastic bed",
        Publication("E. Winkler, Die Lehre von der Elasticitaet und Festigkeit, Prag, 1867; M. Hetenyi, Beams on "
                    "Elastic "
               "Foundation, University of Michigan Press", "authors, titles and publishers, in a later list of "
               "references"),
        bridge(elements=320, length=40.0, stiffness=10e6, mass=600.0, more="foundation: 5.0e+6")
        + "loads:\n  load: {kind: force, on: bridge, force: [0, -100.0e+3], travel: {speed: 0, from: 20}}\n" + REST,
        (
            KnownNumber("deflection", "deflection under the force, F (k/(4 EI))^(1/4)/(2 k)", "m", "closed form",
                lambda: 1e5 * (5e6 / (4.0 * 10e6)) ** 0.25 / (2.0 * 5e6), lambda r: deflection(r, 20.0),
                "second order of links of 0.125 m; 20 m on each side instead of endless", relative=2e-3),
            KnownNumber("rise", "rise 5 m next to the force", "m", "closed form",
                lambda: -float(foundation.steady_state(5.0, force=1e5, speed=0.0, **STILL)),
                lambda r: -deflection(r, 25.0), "as above", relative=5e-3),
        ),
        fault=("lines.bridge.foundation=5.2e6",), quick=True,
    ),
    KnownCase(
        "beam-bed-moving", "A force travels at 290 km/h along a long beam on a damped elastic bed",
        Publication("S. P. Timoshenko (1926) and J. T. Kenney, Steady-state vibrations of beam on elastic foundation "
                    "for "
               "moving load, J. Appl. Mech. 21 (1954); Fryba (1999), ch. 13"),
        bridge(elements=320, length=80.0, stiffness=10e6, mass=600.0, more="foundation: 5.0e+6\n    drag: 18")
        + travelling("kind: force\n    force: [0, -100.0e+3]", 290.0 / 3.6) + motion(0.55, 0.002),
        (
            KnownNumber("deflection", "largest deflection of the middle", "m", "closed form",
                lambda: float(foundation.steady_state(NEAR, force=1e5, speed=290.0 / 3.6, **TRACK).max()),
                lambda r: deepest(r, 40.0), "links of 0.25 m; 40 m after the force has come it is nearly steady",
                relative=1e-2),
        ),
        fault=("lines.bridge.foundation=5.3e6",), quick=True,
    ),
)  # fmt: skip
