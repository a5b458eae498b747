"""Rectangles under a point load and a moving force, frequencies of nets and circles: see `ropewalk.theory.membrane`."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments
from ropewalk.theory.membrane import Pair, _net_squares, _rectangle, rectangle_frequency

FloatArray = NDArray[np.float64]

_IMAGES = 6  # on each side: the next is below exp(-13 pi) of the first


def point_load(x: ArrayLike, y: ArrayLike, *, at: Pair, force: float, sides: Pair, tension: float | Pair) -> FloatArray:
    """Return the static deflection of a rectangle under a point load, in m; infinite at the load itself.

    Args:
        x: m, within 0..a; broadcasts with ``y``, within 0..b.
        y: see ``x``.
        at: place of the load, m, inside.
        force: N.
        sides: (a, b), m.
        tension: N/m, one or (N_x, N_y).

    Returns:
        The deflection in the direction of the force, exact to round-off everywhere.

    Raises:
        ValueError: an argument out of range.

    The sine series along one side, whose terms are products of sinh along the other, is the sum over images of
    logarithms: ``F/(4 pi sqrt(N_x N_y)) sum_k (L(y - y_0 - 2 k b) - L(y + y_0 - 2 k b))``, ``L(d) = ln(1 + sin(pi x/a)
    sin(pi x_0/a) / (sinh^2(pi d'/2a) + sin^2(pi (x - x_0)/2a)))``, ``d' = d sqrt(N_x/N_y)``. The images stand along the
    side on which they lie further apart. Derived here.
    """
    (a, b), (nx, ny) = _rectangle(sides, tension)
    x0, y0 = _inside(at, (a, b))
    (x,), (y,) = _arguments.within(0.0, a, x=x), _arguments.within(0.0, b, y=y)
    _arguments.finite(force=force)
    ratio = np.sqrt(nx / ny)
    if b * ratio < a:
        a, b, x, y, x0, y0, ratio = b, a, y, x, y0, x0, 1.0 / ratio
    product = np.sin(np.pi * x / a) * np.sin(np.pi * x0 / a)
    across = np.sin(0.5 * np.pi * (x - x0) / a) ** 2

    def logarithm(distance: FloatArray) -> FloatArray:
        along = np.sinh(np.minimum(0.5 * np.pi * ratio * np.abs(distance) / a, 300.0)) ** 2
        with np.errstate(divide="ignore"):
            return np.asarray(np.log1p(product / (along + across)))

    images = 2.0 * b * np.arange(-_IMAGES, _IMAGES + 1)
    total = sum(logarithm(y - y0 - shift) - logarithm(y + y0 - shift) for shift in images)
    return np.asarray(force / (4.0 * np.pi * np.sqrt(nx * ny)) * total)


def moving_force_mode(
    m: ArrayLike,
    n: ArrayLike,
    t: ArrayLike,
    *,
    force: float,
    speed: float,
    track: float,
    sides: Pair,
    tension: float | Pair,
    mass: float,
) -> FloatArray:
    """Return the amplitude of mode (m, n) of a rectangle under a moving force, in m.

    ``m``, ``n`` and ``t`` broadcast; the rest as in `moving_force`. ``q'' + w^2 q = 4 F/(a b mass) sin(n pi y_0/b)
    sin(W t)`` with ``W = m pi V/a`` from rest, until a/V; then free. ``q`` is the constant times ``(sin(W t) - W/w
    sin(w t))/(w^2 - W^2)``, written with ``(w + W)/2`` and ``(w - W)/2`` so that nothing cancels at resonance.
    """
    w = rectangle_frequency(m, n, sides=sides, tension=tension, mass=mass)
    (a, b), _ = _rectangle(sides, tension)
    _arguments.positive(speed=speed)
    _arguments.within(0.0, b, track=track)
    _arguments.finite(force=force, t=t)
    m, n, t = (np.asarray(value, dtype=np.float64) for value in (m, n, t))
    drive = m * np.pi * speed / a
    scale = 4.0 * force / (a * b * mass) * np.sin(n * np.pi * track / b)
    until = np.clip(t, 0.0, a / speed)
    s, d = 0.5 * (w + drive) * until, 0.5 * (w - drive) * until
    slow = np.sinc(d / np.pi)
    amplitude = until / (w + drive) * np.sin(s) * slow
    place = (np.sin(s) * np.cos(d) / (0.5 * (w + drive)) - until * np.cos(s) * slow) / (2.0 * w)
    after = np.maximum(t - a / speed, 0.0)
    rate = drive * amplitude
    return np.asarray(scale * (place * np.cos(w * after) + rate / w * np.sin(w * after)))


def moving_force(
    x: ArrayLike,
    y: ArrayLike,
    t: ArrayLike,
    *,
    force: float,
    speed: float,
    track: float,
    sides: Pair,
    tension: float | Pair,
    mass: float,
    modes: tuple[int, int] = (100, 100),
) -> FloatArray:
    """Return the deflection of a rectangle under a force that crosses it along x with constant speed, in m.

    Args:
        x: m, within 0..a; broadcasts with ``y`` (m, within 0..b) and ``t`` (s; at rest before 0).
        y: see ``x``.
        t: see ``x``; after a/speed the load is gone and the membrane vibrates freely.
        force: N.
        speed: m/s, positive; below, at or above the speed of waves.
        track: y of the path, m.
        sides: (a, b), m.
        tension: N/m, one or (N_x, N_y).
        mass: kg/m^2.
        modes: numbers of half waves along x and y.

    Raises:
        ValueError: an argument out of range.

    Sum of the modes, each in closed form, without damping: Fryba, Vibration of Solids and Structures under Moving
    Loads, for the plate, here with the membrane's frequencies. Terms fall off as 1/(m^2 + n^2), and the sum is infinite
    at the load: with N modes it is that of a patch of about a/N.
    """
    (a, b), _ = _rectangle(sides, tension)
    (x,), (y,) = _arguments.within(0.0, a, x=x), _arguments.within(0.0, b, y=y)
    if min(modes) < 1:
        raise ValueError(f"modes must be at least 1 each way, not {modes}")
    x, y, t = np.broadcast_arrays(x, y, np.asarray(t, dtype=np.float64))
    n = np.arange(1, modes[1] + 1)
    across = np.sin(np.pi * y[..., np.newaxis] * n / b)
    total = np.zeros(x.shape)
    for m in range(1, modes[0] + 1):
        amplitudes = moving_force_mode(
            m, n, t[..., np.newaxis], force=force, speed=speed, track=track, sides=sides, tension=tension, mass=mass
        )
        total += np.sin(np.pi * m * x / a) * np.sum(amplitudes * across, axis=-1)
    return total


def net_frequencies(*, cells: tuple[int, int], spacing: Pair, tension: float | Pair, mass: float) -> FloatArray:
    """Return the natural angular frequencies of a rectangular net across itself, in rad/s, (cells_x - 1, cells_y - 1).

    ``cells`` along x and y; ``spacing`` (h_x, h_y) of the nodes in m; ``tension`` of a string in N, one for both
    families or (T_x, T_y); ``mass`` of a node in kg, its strings have none. `ValueError` out of range. Entry (i - 1,
    j - 1): ``w^2 = 4/mass (T_x/h_x sin^2(i pi/(2 cells_x)) + T_y/h_y sin^2(j pi/(2 cells_y)))``, exact.
    """
    squares = _net_squares(cells, spacing, tension)
    _arguments.positive(mass=mass)
    return np.asarray(np.sqrt(squares / mass))


def circle_frequencies(*, radius: float, tension: float, mass: float, diameters: int = 0, count: int = 1) -> FloatArray:
    """Return the lowest ``count`` natural angular frequencies of a circle with ``diameters`` nodal lines, in rad/s.

    ``radius`` in m, ``tension`` in N/m, ``mass`` in kg/m^2. With nodal diameters each stands for two modes.
    `ValueError` out of range. ``j/R sqrt(N/mass)`` with the zeros j of the Bessel function of order ``diameters``.
    """
    from scipy.special import jn_zeros

    _arguments.positive(radius=radius, tension=tension, mass=mass)
    if diameters < 0 or count < 1 or diameters % 1 != 0 or count % 1 != 0:
        raise ValueError(
            f"diameters must be a whole number of at least 0 and count of at least 1, not {diameters} and {count}"
        )
    return np.asarray(jn_zeros(diameters, count) / radius * np.sqrt(tension / mass))


def _inside(at: Pair, sides: Pair) -> Pair:
    if not all(0.0 < place < side for place, side in zip(at, sides, strict=True)):
        raise ValueError(f"the load must stand inside the rectangle of {sides[0]:g} m x {sides[1]:g} m, not at {at}")
    return at
