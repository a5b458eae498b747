"""A bead without friction on a rope: its motion by the phases of `ropewalk.theory.bead`."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments, _ellipse
from ropewalk.theory.bead import Slide, _clock, _motion, _swing

FloatArray = NDArray[np.float64]


def swing(
    t: ArrayLike,
    *,
    start: float,
    mass: float,
    span: float,
    height: float = 0.0,
    length: float,
    gravity: float = 9.81,
) -> Slide:
    """Return the motion of a bead without friction, released from rest at ``start`` at t = 0, by quadrature.

    ``t`` >= 0 in s, ``start`` in m, ``mass`` in kg; the rest and the errors as in `period`. The phase u of `period`
    runs by ``du/dt = sqrt(g depth (1 - k^2 sin^2 u))/h``; its integral is a Fourier series, here inverted by Newton's
    method.
    """
    _arguments.positive(mass=mass, gravity=gravity)
    (t,) = _arguments.within(0.0, np.inf, t=t)
    _arguments.finite(t=t)
    path = _ellipse.of_rope(span, height, length)
    half, scale = _swing(path, start), float(np.sqrt(gravity * path.depth))
    series, k = _clock(path, half), np.sin(0.5 * half)
    rate = scale / series[0].real  # of the mean phase
    turn = rate * t  # the quarter turn before the mean phase is symmetric: u = -pi/2 in both
    u = _invert(series, turn - 0.5 * np.pi)
    phi = path.lowest + 2.0 * np.arcsin(k * np.sin(u))
    sliding_speed = path.sliding_speed(phi)
    phi_rate = 2.0 * k * np.cos(u) * scale / sliding_speed  # dphi/du = 2 k cos u/sqrt(1 - k^2 sin^2 u)
    stops = np.arange(1.0, np.floor(np.max(turn, initial=0.0) / np.pi) + 1.0) * np.pi
    far = path.lowest + np.where(np.arange(len(stops)) % 2 == 0, half, -half)
    still = half == 0.0
    return _motion(
        path, phi, phi_rate, np.zeros_like(phi), mass, gravity,
        stops=(np.array([]) if still else stops / rate, np.array([]) if still else path.place(far)[0]), rests=still,
    )  # fmt: skip


def _invert(series: NDArray[np.complex128], turn: FloatArray) -> FloatArray:
    """The phase u at which the time, in units of the mean rate, from u = -pi/2 is ``turn + pi/2``."""
    orders = np.arange(1, len(series))
    waves = 2.0 * series[1:] / (1j * orders * series[0].real)

    def clock(u: FloatArray) -> FloatArray:
        return np.asarray(u + np.real((np.exp(1j * u[..., np.newaxis] * orders) - (-1j) ** orders) @ waves))

    rounds = 2.0 * np.pi * np.floor(turn / (2.0 * np.pi))
    rest = turn - rounds
    table = np.linspace(-np.pi, 2.0 * np.pi, 96 * max(len(series) // 8, 1))
    u = np.interp(rest, clock(table), table)
    for _ in range(5):  # quadratic from three digits
        rate = 1.0 + np.real(np.exp(1j * u[..., np.newaxis] * orders) @ (1j * orders * waves))
        u = u - (clock(u) - rest) / rate
    return np.asarray(u + rounds)
