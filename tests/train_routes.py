"""Independent routes to trains on beams: sums of sine modes by recursion, residual vibrations, three moments.

Sources: L. Fryba, Vibration of Solids and Structures under Moving Loads (1999), chapter 1; Y.-B. Yang, J.-D. Yau and
L.-C. Hsu, Vibration of simple beams due to trains moving at high speeds, Engineering Structures 19 (1997), for the
speeds of resonance v = f D / k and of cancellation; EN 1991-2:2003, 6.4.6.1.1, of the trains HSLM-A the figure and the
table.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.signal import lfilter

Array = NDArray[np.float64]
FINE = 2e-4  # s, of the recursion


def hslm_a(coaches: int, length: float, bogie: float) -> Array:
    """Places of axles behind the first one, in m, bogie by bogie from the front.

    As tabulated by R. Karoumi (KTH, 2003) from prEN 1991-2:2002: 0, 3, 14, 17, 20.525 and 20.525 + d m of the power car
    and the first bogie; then the middle of a shared bogie D - 3.525/2 m behind 20.525 m, and again every D.
    """
    middle = 20.525 - 3.525 / 2.0 + length
    gaps = [3.0, 11.0, 3.0, 3.525, bogie]
    gaps += [middle - bogie / 2.0 - (20.525 + bogie), bogie]
    gaps += [length - bogie, bogie] * coaches
    gaps += [middle - bogie / 2.0 - (20.525 + bogie), bogie, 3.525, 3.0, 11.0, 3.0]
    return np.concatenate([[0.0], np.cumsum(gaps)])


@dataclass(frozen=True)
class Bridge:
    """A simply supported beam with Rayleigh damping."""

    length: float  # m
    mass: float  # kg/m
    stiffness: float  # N m^2
    alpha: float = 0.0  # 1/s
    beta: float = 0.0  # s

    def frequency(self, n: int) -> float:
        """Of mode n, rad/s."""
        return float((n * np.pi / self.length) ** 2 * np.sqrt(self.stiffness / self.mass))

    def mode(self, n: int, force: Array) -> tuple[Array, Array]:
        """Coordinate of mode n and its acceleration under modal forces at steps of FINE, linear in between."""
        w = self.frequency(n)
        c = self.alpha + self.beta * w * w
        A = np.array([[0.0, 1.0, 0.0, 0.0], [-w * w, -c, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 0.0]])
        E = expm(A * FINE)
        slope = np.diff(force, append=force[-1]) / FINE
        # y(i + 1) = E y(i) + given(i) from 0, each of the two eigenvectors by itself.
        roots, vectors = np.linalg.eig(E[:2, :2])
        given = np.linalg.solve(vectors, np.outer(E[:2, 2], force) + np.outer(E[:2, 3], slope))
        parts = [lfilter([0.0, 1.0], [1.0, -root], one) for root, one in zip(roots, given, strict=True)]
        out = (vectors @ np.array(parts)).real
        return out[0], force - c * out[1] - w * w * out[0]

    def crossing(self, places: Array, forces: Array | float, speed: float, after: float, modes: int = 9) -> Crossing:
        """A train whose first axle comes to the start at time 0, in m, N and m/s, and a time in s after it."""
        until = (self.length + places[-1]) / speed + after
        time = np.arange(0.0, until + FINE, FINE)
        place = speed * time[:, None] - places
        on = (place >= 0.0) & (place <= self.length)
        q, a = [], []
        for n in range(1, modes + 1):
            shape = np.where(on, np.sin(n * np.pi / self.length * place), 0.0)
            found = self.mode(n, 2.0 / (self.mass * self.length) * (shape * forces).sum(axis=1))
            q.append(found[0])
            a.append(found[1])
        return Crossing(self, time, np.array(q), np.array(a))


@dataclass(frozen=True)
class Crossing:
    """What the modes do (mode, instant)."""

    bridge: Bridge
    time: Array
    coordinate: Array  # m
    acceleration: Array  # m/s^2

    def _shape(self, x: float) -> Array:
        n = np.arange(1, self.coordinate.shape[0] + 1)
        return np.asarray(np.sin(n * np.pi * x / self.bridge.length))

    def deflection(self, x: float) -> Array:
        """At a place in m, (instant,) m."""
        return np.asarray(self._shape(x) @ self.coordinate)

    def filtered(self, x: float, cut_off: float) -> Array:
        """Acceleration at a place in m, (instant,) m/s^2, with what a Butterworth filter of the fourth order leaves of
        each frequency forwards and backwards, by Fourier's series."""
        a = self._shape(x) @ self.acceleration
        f = np.fft.rfftfreq(2 * a.size, FINE)
        return np.asarray(np.fft.irfft(np.fft.rfft(a, 2 * a.size) / (1.0 + (f / cut_off) ** 8), 2 * a.size)[: a.size])


def residual(bridge: Bridge, force: float, speed: float) -> float:
    """Amplitude of the free first mode behind a force that has crossed an undamped bridge, m.

    (2 F / (m L w^2)) (2 S / (1 - S^2)) |cos(pi / (2 S))| with S = pi v / (L w); Yang, Yau and Hsu (1997).
    """
    w = bridge.frequency(1)
    S = np.pi * speed / (bridge.length * w)
    still = 2.0 * force / (bridge.mass * bridge.length * w * w)
    return float(still * 2.0 * S / abs(1.0 - S * S) * abs(np.cos(np.pi / (2.0 * S))))


def moment_over_the_pier(places: Array, force: float, span: float) -> float:
    """Smallest moment over the pier of two equal spans under axles anywhere, N m: -F a (l^2 - a^2) / (4 l^2) of each,
    a from the outer support (equation of three moments)."""
    first = np.linspace(0.0, places[-1] + 2.0 * span, 40001)[:, None]
    at = first - places
    a = np.where(at <= span, at, 2.0 * span - at)
    return float((-force * np.where(a > 0.0, a * (span**2 - a**2), 0.0) / (4.0 * span**2)).sum(axis=1).min())


HIGH_SPEED = Bridge(20.0, 10e3, 16.2114e9, alpha=0.6283)
UNDAMPED = Bridge(20.0, 10e3, 16.211389e9)
_W = 2.0 * np.pi * np.array([6.5, 26.0])
SHORT = Bridge(15.0, 9e3, 7.8e9, 2.0 * 0.015 * _W[0] * _W[1] / _W.sum(), 2.0 * 0.015 / _W.sum())
COACHES = np.add.outer(26.4 * np.arange(12), np.array([0.0, 2.5, 19.0, 21.5])).ravel()
LONG_COACHES = np.add.outer(25.0 * np.arange(8), np.array([0.0, 2.5, 17.5, 20.0])).ravel()
