"""Free waves on straight lines: strings, tensioned beams, either of them on an elastic foundation.

The line obeys ``mass w_tt + bending_stiffness w_xxxx - tension w_xx + foundation w = 0``. A wave ``exp(i (omega t
- k x))`` has

    mass omega^2 = bending_stiffness k^4 + tension k^2 + foundation.

Graff, Wave Motion in Elastic Solids, chapters 1 and 3; Fryba, Vibration of Solids and Structures under Moving
Loads. A string is the line with ``bending_stiffness`` 0. Compression is a negative tension; the line must stay
stable: ``tension >= -2 sqrt(foundation bending_stiffness)``, and not be all zero.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments

__all__ = [
    "cut_off_frequency",
    "excited_wavenumbers",
    "frequency",
    "group_velocity",
    "minimum_phase_velocity",
    "phase_velocity",
    "wavenumbers",
]

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


def frequency(
    wavenumber: ArrayLike,
    *,
    mass: float,
    tension: float = 0.0,
    bending_stiffness: float = 0.0,
    foundation: float = 0.0,
) -> FloatArray:
    """Return the angular frequency of a free wave, in rad/s, zero or positive, shape of ``wavenumber``.

    ``wavenumber`` in rad/m, ``mass`` in kg/m, ``tension`` in N, ``bending_stiffness`` in N m^2, ``foundation`` in
    N/m^2. `ValueError` for arguments out of range and for a line that compression would buckle. Formula at the
    head of this module.
    """
    k = _line(wavenumber, mass, tension, bending_stiffness, foundation)
    return np.sqrt(_stiffness(k, tension, bending_stiffness, foundation) / mass)


def phase_velocity(
    wavenumber: ArrayLike,
    *,
    mass: float,
    tension: float = 0.0,
    bending_stiffness: float = 0.0,
    foundation: float = 0.0,
) -> FloatArray:
    """Return the phase velocity omega/k, in m/s, with the sign of ``wavenumber``.

    Arguments and errors as in `frequency`. At wavenumber 0 it is the limit from above: ``sqrt(tension/mass)``
    without foundation, infinite with one.
    """
    k = _line(wavenumber, mass, tension, bending_stiffness, foundation)
    if foundation == 0.0:
        return _sign(k) * np.sqrt((bending_stiffness * k**2 + tension) / mass)
    safe = np.where(k == 0.0, 1.0, k)
    return np.where(k == 0.0, np.inf, np.sqrt(_stiffness(safe, tension, bending_stiffness, foundation) / mass) / safe)


def group_velocity(
    wavenumber: ArrayLike,
    *,
    mass: float,
    tension: float = 0.0,
    bending_stiffness: float = 0.0,
    foundation: float = 0.0,
) -> FloatArray:
    """Return the group velocity d omega / d k, at which the energy travels, in m/s.

    Arguments and errors as in `frequency`. ``(2 bending_stiffness k^3 + tension k) / (mass omega)``; at wavenumber
    0 it is the limit from above.
    """
    k = _line(wavenumber, mass, tension, bending_stiffness, foundation)
    if foundation == 0.0:  # k cancels
        whole = bending_stiffness * k**2 + tension
        safe = np.where(whole == 0.0, 1.0, whole)
        return _sign(k) * np.where(whole == 0.0, 0.0, (whole + bending_stiffness * k**2) / np.sqrt(mass * safe))
    whole = _stiffness(k, tension, bending_stiffness, foundation)
    safe = np.where(whole == 0.0, 1.0, whole)  # only on the verge of buckling, where the branches cross
    return np.where(whole == 0.0, 0.0, (2.0 * bending_stiffness * k**3 + tension * k) / np.sqrt(mass * safe))


def wavenumbers(
    frequency: ArrayLike,
    *,
    mass: float,
    tension: float = 0.0,
    bending_stiffness: float = 0.0,
    foundation: float = 0.0,
) -> ComplexArray:
    """Return the wavenumbers that go out towards +x at a given frequency, in rad/m, shape (..., 1) or (..., 2).

    ``frequency`` >= 0 in rad/s; the rest and the errors as in `frequency`. A string has one, a beam two. Real: the
    wave carries energy towards +x (its phase runs backwards, k < 0, only under compression). Imaginary part
    negative: it fades towards +x, as both do below the cut-off. The other waves are the negatives of these.
    Roots of the equation at the head of this module, a quadratic one in k^2.
    """
    _line(0.0, mass, tension, bending_stiffness, foundation)
    _arguments.finite(frequency=frequency)
    omega = np.asarray(frequency, dtype=np.float64)
    if np.any(omega < 0.0):
        raise ValueError("frequency must not be negative")
    excess = mass * omega**2 - foundation
    if bending_stiffness == 0.0:
        if tension == 0.0:
            raise ValueError("tension or bending_stiffness must be positive: without both nothing travels")
        squares = (excess / tension)[..., None] + 0.0j
    else:
        root = np.sqrt(tension**2 + 4.0 * bending_stiffness * excess + 0.0j)
        half = -0.5 * (tension + np.copysign(1.0, tension) * root)  # 0 only where both roots are
        near = np.where(half == 0.0, 0.0, -excess / np.where(half == 0.0, 1.0, half))
        with np.errstate(over="ignore", invalid="ignore"):
            far = half / bending_stiffness
        far = np.where(np.isfinite(far), far, -np.inf)  # almost a string
        squares = np.stack([near, far], axis=-1)
    k = np.sqrt(squares)  # real part not negative
    k = np.where(k.imag > 0.0, -k, k)
    backward = (k.imag == 0.0) & (2.0 * bending_stiffness * squares.real + tension < 0.0)
    return np.asarray(np.where(backward, -k, k), dtype=np.complex128)


def cut_off_frequency(
    *, mass: float, tension: float = 0.0, bending_stiffness: float = 0.0, foundation: float = 0.0
) -> float:
    """Return the lowest frequency at which a wave travels, in rad/s.

    Arguments and errors as in `frequency`. ``sqrt(foundation/mass)``; a beam under compression has its lowest at
    ``k^2 = -tension/(2 bending_stiffness)``, ``sqrt((foundation - tension^2/(4 bending_stiffness))/mass)``.
    """
    _line(0.0, mass, tension, bending_stiffness, foundation)
    relief = tension**2 / (4.0 * bending_stiffness) if tension < 0.0 else 0.0
    return float(np.sqrt(max(foundation - relief, 0.0) / mass))


def minimum_phase_velocity(
    *, mass: float, tension: float = 0.0, bending_stiffness: float = 0.0, foundation: float = 0.0
) -> float:
    """Return the smallest phase velocity, in m/s: the critical speed of a constant moving force.

    Arguments and errors as in `frequency`. ``sqrt((tension + 2 sqrt(foundation bending_stiffness)) / mass)``, at
    ``k = (foundation/bending_stiffness)^(1/4)``; of a string on a foundation it is the limit of short waves, of a
    beam without foundation that of long ones. Fryba; Timoshenko for the rail.
    """
    _line(0.0, mass, tension, bending_stiffness, foundation)
    return float(np.sqrt(max(tension + 2.0 * np.sqrt(foundation * bending_stiffness), 0.0) / mass))


def excited_wavenumbers(
    speed: ArrayLike,
    frequency: ArrayLike = 0.0,
    *,
    mass: float,
    tension: float = 0.0,
    bending_stiffness: float = 0.0,
    foundation: float = 0.0,
    damping: float = 0.0,
) -> ComplexArray:
    """Return the wavenumbers that a moving harmonic load excites, in rad/m, shape (..., 4), of a string (..., 2).

    ``speed`` in m/s and ``frequency`` of the load in rad/s broadcast; ``damping`` of the foundation in N s/m^2; the
    rest as in `frequency`. A root k stands for ``exp(i (Omega t - k (x - V t)))``: at rest one counts ``omega =
    Omega + k V`` (Doppler). Real roots of the undamped line are waves that the load radiates, ahead of it where
    the group velocity exceeds V (`group_velocity` of k; for omega < 0 of -k). The others are the field
    near the load: with negative imaginary part ahead of it, positive behind. Sorted by real, then imaginary part.
    `ValueError` out of range and for a string at exactly its wave speed, where a root is infinite.

    Roots of ``bending_stiffness k^4 + tension k^2 + foundation + i damping omega - mass omega^2 = 0``.
    """
    _line(0.0, mass, tension, bending_stiffness, foundation)
    _arguments.finite(speed=speed, frequency=frequency)
    _arguments.not_negative(damping=damping)
    v, o = np.broadcast_arrays(np.asarray(speed, dtype=np.float64), np.asarray(frequency, dtype=np.float64))
    square = tension - mass * v**2 + 0.0j
    linear = -2.0 * mass * o * v + 1j * damping * v
    constant = foundation + 1j * damping * o - mass * o**2
    if bending_stiffness == 0.0:
        if np.any(square == 0.0):
            raise ValueError("speed must not be the wave speed of the string: a wavenumber is infinite there")
        coefficients = [constant, linear, square]
    else:
        coefficients = [constant, linear, square, 0.0 * square, bending_stiffness + 0.0 * square]
    roots = _roots(np.stack(np.broadcast_arrays(*coefficients), axis=-1))
    # simple real roots come out real to a few roundings
    scale = np.max(np.abs(roots), axis=-1, keepdims=True, initial=0.0)
    real = np.abs(roots.imag) <= 1e-12 * scale if damping == 0.0 else np.zeros(roots.shape, dtype=np.bool_)
    return np.sort_complex(np.where(real, roots.real, roots))


def _roots(ascending: ComplexArray) -> ComplexArray:
    """Roots of polynomials, coefficients along the last axis: eigenvalues of the scaled companion matrix."""
    degree = ascending.shape[-1] - 1
    monic = ascending[..., :-1] / ascending[..., -1:]
    # k = scale * z makes all coefficients of the polynomial in z at most 1
    powers = degree - np.arange(degree)
    scale = np.max(np.abs(monic) ** (1.0 / powers), axis=-1)
    safe = np.where(scale == 0.0, 1.0, scale)[..., None]
    companion = np.zeros((*monic.shape[:-1], degree, degree), dtype=np.complex128)
    companion[..., np.arange(1, degree), np.arange(degree - 1)] = 1.0
    companion[..., :, -1] = -monic / safe**powers
    z = np.linalg.eigvals(companion)
    for _ in range(2):  # Newton steps make good what the eigenvalue solver lost on simple small roots
        value, slope = np.ones_like(z), np.zeros_like(z)
        for j in range(degree - 1, -1, -1):
            slope = slope * z + value
            value = value * z - companion[..., j, -1, None]
        usable = np.abs(slope) > 1e-6 * (np.abs(z) + 1e-3) ** (degree - 1)
        z = z - np.where(usable, value / np.where(usable, slope, 1.0), 0.0)
    return np.asarray(z * safe)


def _stiffness(k: FloatArray, tension: float, bending_stiffness: float, foundation: float) -> FloatArray:
    # rounding may leave a trace below zero on the verge of buckling
    return np.maximum((bending_stiffness * k**2 + tension) * k**2 + foundation, 0.0)


def _sign(k: FloatArray) -> FloatArray:
    return np.where(k < 0.0, -1.0, 1.0)


def _line(
    wavenumber: ArrayLike, mass: float, tension: float, bending_stiffness: float, foundation: float
) -> FloatArray:
    _arguments.positive(mass=mass)
    _arguments.not_negative(bending_stiffness=bending_stiffness, foundation=foundation)
    _arguments.finite(wavenumber=wavenumber, tension=tension)
    least = -2.0 * np.sqrt(foundation * bending_stiffness)
    if tension < least * (1.0 + 1e-14):
        raise ValueError(f"tension must be at least {least:g} or the line buckles, not {tension}")
    if tension == bending_stiffness == foundation == 0.0:
        raise ValueError("tension, bending_stiffness and foundation must not all be 0")
    return np.asarray(wavenumber, dtype=np.float64)
