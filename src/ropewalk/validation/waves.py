"""Waves that a moving source sends out: Doppler's effect."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.validation.known_case import KnownCase
from ropewalk.validation.known_number import KnownNumber
from ropewalk.validation.publication import ELEMENTARY, Publication
from ropewalk.validation.taut_string import LENGTH, LINE, WAVE

FREQUENCY, ALPHA, UNTIL = 25.0, 0.3, 0.8
"""Hz of the force, its speed over that of the waves, and s until the first reflection comes back."""


def source() -> str:
    """A force that swings as it travels from the middle of a string."""
    t = np.linspace(0.0, UNTIL, round(UNTIL * FREQUENCY * 24.0) + 1)
    values = ", ".join(f"[0, {1e-6 * np.sin(2.0 * np.pi * FREQUENCY * s):.9e}]" for s in t)
    times = ", ".join(f"{s:.9f}" for s in t)
    line = LINE.format(length=LENGTH, elements=600)
    return (
        line
        + f"""
loads:
  source:
    kind: force
    on: string
    force: {{time: [{times}], value: [{values}]}}
    travel: {{speed: {ALPHA * WAVE!r}, from: {0.35 * LENGTH!r}}}
run: {{kind: dynamic, until: {UNTIL}, every: 0.001}}
"""
    )


def frequency_at(result: Any, place: float, first: float, last: float) -> float:
    """Of the velocity at a place between two instants, Hz, by its passages through zero upwards."""
    node = int(np.abs(result.xi.to_numpy() - place * LENGTH).argmin())
    z, t = result.velocity.sel(axis="z").to_numpy()[:, node], result.time.to_numpy()
    i = np.flatnonzero((z[:-1] < 0.0) & (z[1:] >= 0.0) & (t[:-1] > first) & (t[1:] < last))
    at = t[i] - z[i] * (t[i + 1] - t[i]) / (z[i + 1] - z[i])
    return float((at.size - 1) / (at[-1] - at[0]))


CASES = (
    KnownCase(
        "wave-doppler", "A force that swings 25 times a second travels along a string at 0.3 of the wave speed",
        Publication("Chr. Doppler, 1842: f/(1 - V/c) ahead of a moving source, f/(1 + V/c) behind it", ELEMENTARY),
        source,
        (
            KnownNumber("ahead", "frequency of the waves ahead", "Hz", "closed form", lambda: FREQUENCY / (1.0 - ALPHA),
                        lambda r: frequency_at(r, 0.8, 0.47, 0.79),
                        "17 links in a wave: the chain slows it down by 0.6 %", relative=6e-3),
            KnownNumber("behind", "frequency of the waves behind", "Hz", "closed form",
                        lambda: FREQUENCY / (1.0 + ALPHA), lambda r: frequency_at(r, 0.15, 0.22, 0.49),
                        "31 links in a wave", relative=6e-3),
        ),
        fault=("loads.source.travel.speed=0.28",),
    ),
)  # fmt: skip
