"""Strings and beams on equal supports in equal distances: pass bands, propagation constants, moving force.

The line of mass m and tension T, of a beam also bending stiffness EI, rests every d on a spring k_s that carries a
mass m_s. From span to span a free wave is multiplied by ``exp(-i mu)``; mu is the propagation constant. Frequencies
with a real mu form the pass bands. String, with ``K = omega sqrt(m/T)``:

    cos(mu) = cos(K d) + (k_s - m_s omega^2)/(2 T K) sin(K d);

beam with ``b^4 = m omega^2/EI``:

    (k_s - m_s omega^2)/(4 EI b^3) [sinh(bd)/(cosh(bd) - cos(mu)) - sin(bd)/(cos(bd) - cos(mu))] = 1.

Brillouin, Wave Propagation in Periodic Structures; Mead, J. Sound Vib. 11 (1970) and 190 (1996).

Bands are counted, not searched: for a real mu the number of free waves below a frequency follows from that of the
bare line and a sign (Wittrick and Williams, 1971; derived here for one support in each period), so bisection finds
each of them, however close they lie. Band n of a string is the range between its frequencies at mu = 0 and pi. That
of a beam may reach below both, to a minimum in between, and there is at most one in each ``2 j pi < b d < (2 j + 1)
pi``, where the compliance rises with the frequency to that of the support (derived here).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments
from ropewalk.theory._floquet_integral import moving_force, moving_force_drag, moving_force_error
from ropewalk.theory._spans import SpanLayout

__all__ = [
    "BandDiagram",
    "band_diagram",
    "band_frequencies",
    "moving_force",
    "moving_force_drag",
    "moving_force_error",
    "pass_bands",
    "propagation_constant",
]

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True)
class BandDiagram:
    """The data of a figure of pass and stop bands."""

    propagation: FloatArray  # 0..pi, shape (points,)
    frequency: FloatArray  # rad/s, shape (points, bands), ascending along the bands
    pass_bands: FloatArray  # (lowest, highest) in rad/s up to the highest frequency shown, shape (n, 2)


def pass_bands(
    *,
    spacing: float,
    mass: float,
    support_stiffness: float,
    support_mass: float = 0.0,
    tension: float = 0.0,
    bending_stiffness: float = 0.0,
    highest: float,
) -> FloatArray:
    """Return the pass bands up to the frequency ``highest``: (from, to) in rad/s, ascending, shape (bands, 2).

    ``spacing`` of the supports in m, ``mass`` of the line in kg/m, ``tension`` in N, ``bending_stiffness`` in N m^2
    (0 for a string), ``support_stiffness`` in N/m, ``support_mass`` in kg, ``highest`` in rad/s. Nothing is damped.
    `ValueError` out of range.

    Bands that touch or overlap are one, and the last one is cut off at ``highest``. Without supports (stiffness and
    mass 0) everything passes. Rigid supports (infinite stiffness): a beam has bands; the spans of a string do not
    hear each other, and its bands have no width. Formulas at the head of this module.
    """
    spans = SpanLayout(spacing, mass, tension, bending_stiffness, support_stiffness, support_mass)
    _arguments.positive(highest=highest)
    count = int(max(np.max(_count(spans, np.array([highest]), mu)) for mu in (0.0, np.pi)))
    edges = _edges(spans, count + 2)
    edges = edges[edges[:, 0] <= highest]
    joined: list[list[float]] = []
    for low, high in edges[np.argsort(edges[:, 0])]:
        if joined and low <= joined[-1][1] * (1.0 + 4e-15):  # both found to a few roundings
            joined[-1][1] = max(joined[-1][1], high)
        else:
            joined.append([low, high])
    return np.minimum(np.array(joined, dtype=np.float64).reshape(-1, 2), highest)


def band_frequencies(
    propagation: ArrayLike,
    *,
    spacing: float,
    mass: float,
    support_stiffness: float,
    support_mass: float = 0.0,
    tension: float = 0.0,
    bending_stiffness: float = 0.0,
    bands: int,
) -> FloatArray:
    """Return the frequencies of the free waves with a real propagation constant, in rad/s, shape (..., ``bands``).

    ``propagation`` is mu in rad, of any size; the result is even and 2 pi-periodic in it and ascends along the
    bands, ``bands`` >= 1 of them. The rest and the errors as in `pass_bands`.
    """
    spans = SpanLayout(spacing, mass, tension, bending_stiffness, support_stiffness, support_mass)
    _arguments.finite(propagation=propagation)
    if bands < 1:
        raise ValueError(f"bands must be at least 1, not {bands}")
    mu = np.asarray(propagation, dtype=np.float64)
    return _frequencies(spans, np.abs(np.remainder(mu + np.pi, 2.0 * np.pi) - np.pi), bands)


def band_diagram(
    *,
    spacing: float,
    mass: float,
    support_stiffness: float,
    support_mass: float = 0.0,
    tension: float = 0.0,
    bending_stiffness: float = 0.0,
    bands: int = 4,
    points: int = 181,
) -> BandDiagram:
    """Return the frequencies of the first ``bands`` bands over the propagation constant, with the pass bands.

    ``points`` >= 2 equal steps of the propagation constant from 0 to pi. The rest and the errors as in
    `pass_bands`, whose bands go up to the largest frequency of the last band.
    """
    if points < 2:
        raise ValueError(f"points must be at least 2, not {points}")
    mu = np.linspace(0.0, np.pi, points)
    line = {
        "spacing": spacing,
        "mass": mass,
        "support_stiffness": support_stiffness,
        "support_mass": support_mass,
        "tension": tension,
        "bending_stiffness": bending_stiffness,
    }
    frequency = band_frequencies(mu, bands=bands, **line)
    return BandDiagram(mu, frequency, pass_bands(highest=float(np.max(frequency)), **line))


def propagation_constant(
    frequency: ArrayLike,
    *,
    spacing: float,
    mass: float,
    support_stiffness: float,
    support_mass: float = 0.0,
    tension: float = 0.0,
    bending_stiffness: float = 0.0,
    damping: float = 0.0,
    support_damping: float = 0.0,
) -> ComplexArray:
    """Return the complex propagation constants of the waves that go out towards +x, shape (..., 1) or (..., 2).

    ``frequency`` > 0 in rad/s, ``damping`` of the line in N s/m^2, ``support_damping`` in N s/m; the rest and the
    errors as in `pass_bands`. From one support to the next the wave is multiplied by ``exp(-i mu)``: the real part,
    in -pi..pi, is its phase and the imaginary part, zero or negative, how much it fades. Real ones are given as 0..pi;
    the wave towards -x is the negative. A string has one, a beam two, the one that fades less first. Beams on rigid
    supports have one; strings on them none that gets through, which is a `ValueError`.

    Roots of ``1 + D G(0) = 0``, linear or quadratic in cos(mu); formulas at the head of this module.
    """
    spans = SpanLayout(
        spacing, mass, tension, bending_stiffness, support_stiffness, support_mass, damping, support_damping
    )
    _arguments.finite(frequency=frequency)
    omega = np.asarray(frequency, dtype=np.complex128)
    if not np.all(omega.real > 0.0):
        raise ValueError("frequency must be positive")
    load, undamped = spans.load(omega), damping == support_damping == 0.0
    if bending_stiffness == 0.0:
        if spans.rigid:
            raise ValueError("support_stiffness must be finite: no wave of a string gets past a rigid support")
        k = np.sqrt(load / tension)
        cosine = np.cos(k * spacing) + spans.support(omega) * np.sin(k * spacing) / (2.0 * tension * k)
        return _arc(np.log(cosine[..., None] + 0.0j), undamped)
    near, root = spans.squares(load)
    theta, phi = np.sqrt(near) * spacing, np.sqrt((tension + root) / (2.0 * bending_stiffness)) * spacing
    # everything divided by cosh(phi)
    decay = np.exp(-2.0 * phi)
    tangent = -np.expm1(-2.0 * phi) / (1.0 + decay) * spacing / phi
    secant = 2.0 * np.exp(-phi) / (1.0 + decay)
    sine, cosine = np.sin(theta) * spacing / theta, np.cos(theta)
    middle, last = tangent - secant * sine, sine - tangent * cosine
    if spans.rigid:
        return _arc(np.log(-last / middle + 0.0j)[..., None], undamped)
    half = 0.5 * spans.support(omega)
    b, c = half * middle - root * (1.0 + secant * cosine), half * last + root * cosine
    split = np.sqrt(b**2 - 4.0 * root * secant * c)
    split = np.where((split * np.conj(b)).real < 0.0, -split, split)
    q = -0.5 * (b + split)
    # the large root by logarithms: its secant underflows long before the logarithm matters
    log_secant = np.log(2.0) - phi - np.log1p(decay)
    logs = np.stack([np.log(c / q), np.log(q / root) - log_secant], axis=-1)
    mu = _arc(logs, undamped)
    order = np.argsort(-mu.imag, axis=-1, kind="stable")
    return np.take_along_axis(mu, order, axis=-1)


def _arc(log_cosine: ComplexArray, undamped: bool) -> ComplexArray:
    """mu of log(cos mu), with the imaginary part zero or negative."""
    large = log_cosine.real > 20.0
    cosine = np.exp(np.where(large, 0.0, log_cosine))
    if undamped:  # then most cosines are real, but for the rounding of the logarithm
        cosine = np.where(np.abs(cosine.imag) <= 1e-13 * np.abs(cosine), cosine.real, cosine)
    mu = np.where(large, 1j * (log_cosine + np.log(2.0)), np.arccos(cosine + 0.0j))
    return np.asarray(np.where(mu.imag > 0.0, -mu, mu))


def _count(spans: SpanLayout, omega: FloatArray, mu: ArrayLike) -> NDArray[np.int64]:
    """Number of free waves of phase mu, 0..pi, below the frequency omega; broadcasts."""
    omega, mu = np.broadcast_arrays(omega, np.asarray(mu, dtype=np.float64))
    compliance, theta = _line_compliance(spans, omega, mu)
    round_trip = 2.0 * np.pi
    bare = np.ceil(np.maximum(theta - mu, 0.0) / round_trip) + np.ceil((theta + mu) / round_trip) - 1.0
    bare = np.where(theta > 0.0, np.maximum(bare, 0.0), 0.0)
    clamped = bare - (compliance < 0.0)
    if spans.rigid:
        return np.asarray(clamped, dtype=np.int64)
    stiffness = spans.support_stiffness - spans.support_mass * omega**2
    # D + 1/G < 0, without dividing
    freed = np.where(compliance < 0.0, 1.0 + stiffness * compliance > 0.0, 1.0 + stiffness * compliance < 0.0)
    return np.asarray(clamped + freed, dtype=np.int64)


def _line_compliance(spans: SpanLayout, omega: FloatArray, mu: FloatArray) -> tuple[FloatArray, FloatArray]:
    """G(0), real because nothing is damped, and the phase b d of the line's own wave."""
    shape = omega.shape
    flat = np.asarray(np.ravel(omega), dtype=np.complex128)
    phase = np.asarray(np.ravel(mu), dtype=np.complex128)
    with np.errstate(divide="ignore", invalid="ignore"):
        at_zero = spans.compliance(np.zeros(1), flat, phase)[:, 0].real
    at_zero = np.where(np.isfinite(at_zero), at_zero, 1e100)  # a pole belongs to the frequencies below it
    load = spans.load(flat)
    z = load / spans.tension if spans.bending_stiffness == 0.0 else spans.squares(load)[0]
    theta = np.sqrt(z.real) * spans.spacing
    return np.reshape(at_zero.astype(np.float64), shape), np.reshape(theta.astype(np.float64), shape)


def _frequencies(spans: SpanLayout, mu: FloatArray, bands: int) -> FloatArray:
    """The first frequencies for mu in 0..pi, by bisection of the count."""
    n = np.arange(1, bands + 1)
    b = (n + 3.0) * np.pi / spans.spacing  # supports raise the count of the bare line by -1 at the least
    high = np.sqrt((spans.bending_stiffness * b**2 + spans.tension) * b**2 / spans.mass)
    mu, high = np.broadcast_arrays(mu[..., None], high)
    low = np.zeros(high.shape)
    while True:
        middle = 0.5 * (low + high)
        if np.all((middle <= low) | (middle >= high) | (high < 1e-14 * np.max(high))):
            return np.where(low == 0.0, 0.0, high)
        below = _count(spans, middle, mu) >= n
        low, high = np.where(below, low, middle), np.where(below, middle, high)


def _edges(spans: SpanLayout, bands: int) -> FloatArray:
    """Lowest and highest frequency of each band, shape (bands, 2)."""
    ends = _frequencies(spans, np.array([0.0, np.pi]), bands)
    edges = np.stack([np.min(ends, axis=0), np.max(ends, axis=0)], axis=-1)
    if spans.bending_stiffness > 0.0 and not spans.rigid and spans.support_stiffness > 0.0:
        for fold, mu in _folds(spans, float(edges[-1, 1])):
            band = int(_count(spans, np.array([fold * (1.0 - 1e-9)]), mu)[0])
            if band < bands:
                edges[band, 0] = min(edges[band, 0], fold)
    return edges


def _folds(spans: SpanLayout, highest: float) -> list[tuple[float, float]]:
    """Minima of the bands of a beam strictly between mu = 0 and pi, as (frequency, mu)."""
    d = spans.spacing
    found = []
    most = highest if spans.support_mass == 0.0 else min(highest, np.sqrt(spans.support_stiffness / spans.support_mass))

    def frequency(theta: float) -> float:
        b = theta / d
        return float(np.sqrt((spans.bending_stiffness * b**2 + spans.tension) * b**2 / spans.mass))

    def parts(theta: float) -> tuple[float, float, float]:
        """Roots of the weights of sin and sinh, both divided by cosh, and phi."""
        phi = float(np.sqrt(theta**2 + spans.tension * d**2 / spans.bending_stiffness))
        secant = 2.0 * np.exp(-phi) / (1.0 + np.exp(-2.0 * phi))
        return np.sqrt(max(np.sin(theta), 0.0) / theta * secant), np.sqrt(np.tanh(phi) / phi), phi

    def excess(theta: float) -> float:
        """Largest compliance of line and support in series over mu, times positive factors: rises with theta."""
        s, h, phi = parts(theta)
        gap = 1.0 - np.cos(theta) * 2.0 * np.exp(-phi) / (1.0 + np.exp(-2.0 * phi))
        stiffness = spans.support_stiffness - spans.support_mass * frequency(theta) ** 2
        # with both sides divided by cosh(phi); 2 EI (a^2 + b^2)/d^3 is the unit of stiffness
        unit = 2.0 * spans.bending_stiffness * (theta**2 + phi**2) / d**3
        return float(unit * gap - stiffness * (s + h) ** 2)

    window = 0
    while frequency(max(2.0 * np.pi * window, 1e-3)) < most:
        low, high = max(2.0 * np.pi * window, 1e-6), (2.0 * window + 1.0) * np.pi
        if excess(low) < 0.0 < excess(high):
            for _ in range(60):
                theta = 0.5 * (low + high)
                low, high = (theta, high) if excess(theta) < 0.0 else (low, theta)
            s, h, phi = parts(high)
            secant = 2.0 * np.exp(-phi) / (1.0 + np.exp(-2.0 * phi))
            cosine = (s / secant + h * np.cos(high)) / (s + h) if secant > 0.0 else np.inf
            if cosine < 1.0 and frequency(high) <= most:
                found.append((frequency(high), float(np.arccos(cosine))))
        window += 1
    return found
