"""Profiles of roads and tracks from their power spectral densities.

A profile is a sum of waves with random phases, z = sum a_i cos(2 pi n_i s + phi_i), a_i^2/2 = integral of G over band i
(Shinozuka & Deodatis 1991). The bands are equal in the logarithm of n, so that a profile does not repeat itself.

Spectra G(n), one-sided, n in cycles/m:

    ISO 8608:2016   G = G0 (n/n0)^-2, n0 = 0.1 1/m, G0 = 16e-6 m^3 for class A, four times as much for each class
    FRA             G = 2 pi k A Wc^2 / (W^2 (W^2 + Wc^2)), W = 2 pi n, k = 0.25, Wc = 0.8245 rad/m
    German          G = 2 pi A Wc^2 / ((W^2 + Wr^2)(W^2 + Wc^2)), Wc = 0.8246, Wr = 0.0206 rad/m

Sources of the two: Garg & Dukkipati 1984, Dynamics of railway vehicle systems; Claus & Schiehlen 1998.
"""

from __future__ import annotations

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array

_ISO = 16e-6, 0.1  # m^3 of class A, 1/m
_FRA = 0.25, 0.8245  # k, rad/m
_FRA_ROUGHNESS = {1: 1.2107e-4, 2: 1.0181e-4, 3: 0.6816e-4, 4: 0.5376e-4, 5: 0.2095e-4, 6: 0.0339e-4}  # m^2 rad/m
_GERMAN = 0.8246, 0.0206  # rad/m
_GERMAN_ROUGHNESS = {"low": 4.032e-7, "high": 10.80e-7}  # m^2 rad/m
_USUAL = {"ISO": (0.35, 90.0), "FRA": (1.524, 304.8), "German": (3.0, 150.0)}  # m
# Bands of a spectrum; places in the shortest wave at which it is taken: a spline through them is right to 1e-4.
_BANDS, _PLACES = 1000, 20
_BLOCK, _MOST_BLOCKS = 1024, 10_000  # of these: half a gigabyte


def usual_wavelengths(spectrum: str) -> tuple[float, float]:
    """The shortest and the longest wave that a spectrum is meant for, m."""
    return _USUAL[spectrum.split()[0]]


def density(spectrum: str, n: Array) -> Array:
    """Power spectral density of a profile.

    Args:
        spectrum: its name with its class, as in a scenario.
        n: 1/m, wave numbers in cycles.

    Returns:
        One-sided density, m^3.
    """
    family, *_, grade = spectrum.split()
    if family == "ISO":
        whole, at = _ISO
        return np.asarray(whole * 4.0 ** "ABCDEFGH".index(grade) * (n / at) ** -2)
    square = (2.0 * np.pi * n) ** 2
    if family == "FRA":
        k, cut = _FRA
        found = k * _FRA_ROUGHNESS[int(grade)] * cut**2 / (square * (square + cut**2))
    else:
        cut, low = _GERMAN
        found = _GERMAN_ROUGHNESS[grade] * cut**2 / ((square + low**2) * (square + cut**2))
    return np.asarray(2.0 * np.pi * found)


def profile_of(
    spectrum: str, seed: int, wavelengths: tuple[float, float], begin: float, end: float
) -> tuple[Array, Array]:
    """Places and heights of a profile; the same heights at the same places, whatever part of it is asked for.

    Args:
        spectrum: its name with its class.
        seed: of the phases.
        wavelengths: m, the shortest and the longest.
        begin: m, where it is needed from.
        end: m, up to where.

    Returns:
        Places s and heights z, (place,) m.
    """
    shortest, longest = wavelengths
    edges = np.geomspace(1.0 / longest, 1.0 / shortest, _BANDS + 1)
    n = np.sqrt(edges[1:] * edges[:-1])
    a = np.sqrt(2.0 * density(spectrum, n) * np.diff(edges))
    phase = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, _BANDS)
    step = shortest / _PLACES
    first, last = int(np.floor(begin / step)) - 1, int(np.ceil(end / step)) + 1
    # cos(x + y) by blocks: two products of matrices instead of a cosine for every place and wave
    count = (last - first) // _BLOCK + 1
    if count > _MOST_BLOCKS:
        raise RopewalkError(
            f"a profile of {end - begin:g} m with waves from {shortest:g} m on needs {count * _BLOCK:.1e} heights, "
            f"more than {_MOST_BLOCKS * _BLOCK:.1e}; raise its shortest wavelength, or check the length"
        )
    blocks = 2.0 * np.pi * np.outer((first + _BLOCK * np.arange(count)) * step, n) + phase
    within = 2.0 * np.pi * np.outer(n, np.arange(_BLOCK) * step)
    z = (a * np.cos(blocks)) @ np.cos(within) - (a * np.sin(blocks)) @ np.sin(within)
    size = last - first + 1
    return np.arange(first, last + 1.0) * step, np.asarray(z.ravel()[:size])
