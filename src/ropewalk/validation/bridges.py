"""Trains on bridges, bridges of several spans, ballasted track."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.scenario.examples import examples
from ropewalk.theory import beam
from ropewalk.validation.beams import REST, bridge, lowest, motion, travelling
from ropewalk.validation.known_case import KnownCase, frequencies
from ropewalk.validation.known_number import KnownNumber
from ropewalk.validation.measured import of_line
from ropewalk.validation.publication import Publication

EN1991 = Publication(
    "EN 1991-2:2003, 6.4.6.1.1: the universal train HSLM-A1; its response by the series of L. Fryba, one axle after "
    "the "
    "other"
)
CANCELLATION = Publication(
    "H. Xia, H. L. Li, W. W. Guo and G. De Roeck, Vibration resonance and cancellation of simply supported bridges "
    "under "
    "moving train loads, J. Eng. Mech. 140 (2014); before it Y.-B. Yang, J.-D. Yau and L.-C. Hsu, Eng. Struct. 19 "
    "(1997)",
    "title, authors, year and DOI of the first; the second from memory",
)
CLAPEYRON = Publication(
    "B. P. E. Clapeyron, 1857, the equation of three moments; in every textbook of statics", "elementary"
)
TTB = Publication(
    "D. Cantero, TTB-2D: Train-Track-Bridge interaction simulation tool for Matlab, SoftwareX 20 (2022), 101253; run "
    "for "
    "this number with four elements between sleepers and 4000 steps a second",
    "the repository DanielCanteroNTNU/TTB-2D",
)
SHORT: dict[str, Any] = {"length": 20.0, "bending_stiffness": 16.2114e9, "mass": 10e3, "damping": 6283.0}
"""A bridge of 20 m with 5 Hz and 1 % of damping."""


def hslm_a1() -> Any:
    """Places of the axles of HSLM-A1 behind the first one, m: 18 coaches of 18 m, bogies of 2 m, 170 kN."""
    middle = 20.525 - 3.525 / 2.0 + 18.0
    ends = middle - 1.0 - (20.525 + 2.0)
    gaps = [3.0, 11.0, 3.0, 3.525, 2.0, ends, 2.0, *[16.0, 2.0] * 18, ends, 2.0, 3.525, 3.0, 11.0, 3.0]
    return np.concatenate([[0.0], np.cumsum(gaps)])


def train(speed: float) -> float:
    """Largest deflection at midspan under HSLM-A1, m, by nine modes."""
    places = hslm_a1()
    t = np.arange(0.0, (20.0 + places[-1]) / speed + 0.5, 0.002)
    one = beam.moving_force(10.0, t, force=170e3, speed=speed, modes=9, **SHORT)
    return float(sum(np.interp(t - place / speed, t, one, left=0.0) for place in places).max())


UNDAMPED: dict[str, Any] = {"length": 20.0, "bending_stiffness": 16.211389e9, "mass": 10e3}


def left_behind(speed: float) -> float:
    """Amplitude of the free first mode behind an axle of 200 kN, m: (2 F/(m L w^2)) (2 S/(1 - S^2)) |cos(pi/(2 S))|."""
    w = float(beam.natural_frequencies(1, **UNDAMPED)[0])
    S = np.pi * speed / (20.0 * w)
    return float(2.0 * 200e3 / (10e3 * 20.0 * w * w) * 2.0 * S / abs(1.0 - S * S) * abs(np.cos(0.5 * np.pi / S)))


def free_vibration(result: Any) -> float:
    """Largest deflection at midspan after the axle has gone, m."""
    gone = ~np.isfinite(result.contact_xi[:, 0].values) & (result.time.values > 0.3)
    return float(np.abs(result.position.sel(axis="z")[gone, result.sizes["node"] // 2]).max())


def axle(speed: float) -> str:
    """An axle on that bridge."""
    return bridge(40, 20.0, 16.211389e9, 10e3) + travelling("kind: force\n    force: [0, -200.0e+3]", speed) + motion(
        20.0 / speed + 0.5, 0.002)  # fmt: skip


PIER = "supports: {pier: {at: 10, kind: guided, along: [1, 0]}}"
ON_SPAN = "loads:\n  load: {kind: force, on: bridge, force: [0, -100.0e+3], travel: {speed: 0, from: 5}}\n"


def upward(result: Any, support: str) -> float:
    """Reaction of a support at last, N."""
    return float(result.reaction.sel(axis="z", support=f"bridge.{support}").to_numpy()[-1])


TWO_SPANS = float(np.sqrt(16.2114e9 / 10e3)) / 100.0
"""sqrt(EI/m)/l^2 of spans of 10 m."""

CASES = (
    KnownCase(
        "bridge-train", "The universal train HSLM-A1 crosses a railway bridge at 200 km/h", EN1991,
        lambda: examples()["bridge-hslm"],
        (
            KnownNumber("deflection", "largest deflection at midspan", "m", "series", lambda: train(200.0 / 3.6),
                lambda r: of_line(r, "midspan", "deflection"), "links of 1 m miss 0.01 %", relative=5e-4),
        ),
        fault=("lines.deck.bending_stiffness=17 GN*m^2",),
    ),
    KnownCase(
        "bridge-resonance", "The same train at 324 km/h = 5 Hz * 18 m: resonance with its coaches", EN1991,
        lambda: examples()["bridge-hslm"],
        (
            KnownNumber("deflection", "largest deflection at midspan", "m", "series", lambda: train(90.0),
                lambda r: of_line(r, "midspan", "deflection"),
                "0.01 Hz next to the frequency count at 1 % of damping", relative=8e-3),
        ),
        settings=("loads.train.travel.speed=324 km/h",), fault=("loads.train.travel.speed=315 km/h",),
    ),
    KnownCase(
        "bridge-cancellation", "An axle leaves an undamped bridge at rest: v = 2 f L/3, 240 km/h", CANCELLATION,
        axle(200.0 / 3.0),
        (
            KnownNumber("free", "free vibration behind the axle", "m", "closed form", lambda: 0.0, free_vibration,
                "40 links leave 2e-5 of the 3 mm under the axle", absolute=3e-7),
        ),
        fault=("loads.load.travel.speed=69",), quick=True,
    ),
    KnownCase(
        "bridge-left-behind", "The same axle at 300 km/h leaves most of its vibration behind", CANCELLATION,
        axle(250.0 / 3.0),
        (
            KnownNumber("free", "free vibration behind the axle", "m", "closed form", lambda: left_behind(250.0 / 3.0),
                free_vibration, "the first mode alone; the third adds 0.4 %, 40 links 0.1 %", absolute=2e-5),
        ),
        fault=("lines.bridge.bending_stiffness=15e9",), quick=True,
    ),
    KnownCase(
        "bridge-two-spans", "A force of 100 kN stands in the first of two equal spans", CLAPEYRON,
        bridge(80, 20.0, 16.2114e9, 10e3, PIER) + ON_SPAN + REST,
        (
            KnownNumber("pier", "reaction of the pier, 11/16 F", "N", "closed form", lambda: 11.0 / 16.0 * 1e5,
                lambda r: upward(r, "pier"), "second order of links of 0.25 m", relative=2e-3),
            KnownNumber("far-end", "pull of the far end, -3/32 F", "N", "closed form", lambda: -3.0 / 32.0 * 1e5,
                lambda r: upward(r, "end"), "as above", relative=6e-3),
        ),
        fault=("loads.load.force=[0, -102.0e+3]",), quick=True,
    ),
    KnownCase(
        "bridge-two-spans-frequencies", "Frequencies of a beam over two equal spans",
        Publication("S. P. Timoshenko and D. H. Young, Vibration Problems in Engineering: pi^2 and 3.9266^2"),
        bridge(80, 20.0, 16.2114e9, 10e3, PIER) + REST,
        (
            KnownNumber("first", "first frequency, pi^2 sqrt(EI/m)/l^2", "rad/s", "closed form",
                lambda: float(np.pi**2) * TWO_SPANS, lowest, "second order of 80 links", relative=1e-3),
            KnownNumber("second", "second frequency, 3.9266^2 sqrt(EI/m)/l^2", "rad/s", "closed form",
                lambda: 3.92660231**2 * TWO_SPANS, lambda s: lowest(s, 2), "second order of 80 links", relative=3e-3),
        ),
        fault=("lines.bridge.bending_stiffness=16.5e9",), answer=frequencies, quick=True,
    ),
    KnownCase(
        "bridge-ballasted-track", "A coach crosses a bridge with rails, pads, sleepers and ballast", TTB,
        lambda: examples()["bridge-ballasted-track"],
        (
            KnownNumber("deflection", "largest deflection at midspan", "m", "other program", lambda: 0.593224e-3,
                lambda r: of_line(r, "midspan", "deflection"), "28 links of bridge miss 2e-5 of it", absolute=2e-7),
        ),
        fault=("tracks.track.ballast.stiffness=145 MN/m", "lines.deck.bending_stiffness=1.81e12"),
    ),
)  # fmt: skip
