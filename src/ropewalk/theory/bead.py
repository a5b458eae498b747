"""Bead that slides on a weightless inextensible rope between two supports: a particle on an ellipse.

Both pieces of the rope stay straight, so that their lengths sum to the rope's and the bead moves on the ellipse of
`ropewalk.theory._ellipse`. With the speed v along it, its slope z', x' per eccentric angle and the pace h, the rope
presses the bead towards the inside by ``N = m (g x'/h + v^2 a b/h^3)``, and of the tensions behind and ahead

    (T_ahead + T_behind) sin(theta/2) = N,    (T_ahead - T_behind) cos(theta/2) = force of the rope along the path.

Without friction the energy decides: ``v^2 = 2 g (z_start - z)``. With it, the force along the path opposes the motion
by ``mu_e N``: a point block has ``mu_e = mu``, and a capstan, ``T_2/T_1 = exp(mu theta)``, has ``mu_e = tanh(mu
theta/2)/tan(theta/2)``, a little less. The bead stays where it stops if ``|z'/x'| <= mu_e``. Derived here; the same for
all masses but for the tensions.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments, _ellipse
from ropewalk.theory._ellipse import Ellipse

__all__ = ["Friction", "Slide", "period", "slide", "small_period"]

Friction = Literal["capstan", "block"]
FloatArray = NDArray[np.float64]

MOST_SAMPLES = 2**17  # of one swing: enough for a rope 1e-9 longer than the distance of its supports
MOST_STOPS = 10_000


@dataclass(frozen=True)
class Slide:
    """Motion of a bead: arrays of the shape of the times; m from the first support, z upwards, forces in N.

    ``stop_times`` (s) and ``stop_places`` (x in m), shape (stop,): the instants at which the speed is zero after the
    start. `rests`: it stays at the last of them, or never left the start. `slack_at`: the first time at which a piece
    of the rope is about to turn slack, in s, or None; from there on the arrays are NaN, for the bead leaves the
    ellipse.
    """

    x: FloatArray
    z: FloatArray
    x_velocity: FloatArray
    z_velocity: FloatArray
    tension_behind: FloatArray
    tension_ahead: FloatArray
    stop_times: FloatArray
    stop_places: FloatArray
    rests: bool
    slack_at: float | None


def small_period(*, span: float, height: float = 0.0, length: float, gravity: float = 9.81) -> float:
    """Return the period of small swings about the lowest point, in s.

    Args:
        span, height: the end support from the start support, m.
        length: of the rope, m.
        gravity: m/s^2.

    Raises:
        ValueError: an argument out of range, or a rope no longer than the distance of its supports.

    ``2 pi h/sqrt(g depth)`` with h at the lowest point; between level supports ``2 pi (L/2)/sqrt(g b)``.
    """
    _arguments.positive(gravity=gravity)
    path = _ellipse.of_rope(span, height, length)
    return float(2.0 * np.pi * path.sliding_speed(np.asarray(path.lowest)) / np.sqrt(gravity * path.depth))


def period(start: ArrayLike, *, span: float, height: float = 0.0, length: float, gravity: float = 9.81) -> FloatArray:
    """Return the period of a bead without friction that is released from rest at ``start`` (x in m), in s, any shape.

    The rest and the errors as in `small_period`; `ValueError` also where the rope would turn slack at the far turning
    point, which a steeply inclined rope may do. With ``phi = lowest + 2 arcsin(k sin u)``, ``k = sin(swing/2)``, the
    energy integral is ``T = (g depth)^-1/2 int_0^2pi h/sqrt(1 - k^2 sin^2 u) du``, smooth and periodic, so that equal
    samples give all digits.
    """
    _arguments.positive(gravity=gravity)
    path = _ellipse.of_rope(span, height, length)
    start = np.asarray(start, dtype=np.float64)
    scale = np.sqrt(gravity * path.depth)
    found = [2.0 * np.pi * _clock(path, _swing(path, float(x)))[0].real / scale for x in start.ravel()]
    return np.array(found).reshape(start.shape)


def slide(
    t: ArrayLike,
    *,
    start: float,
    speed: float = 0.0,
    mass: float,
    friction: Friction,
    coefficient: float,
    span: float,
    height: float = 0.0,
    length: float,
    gravity: float = 9.81,
) -> Slide:
    """Return the motion of a bead with friction, from its start at t = 0 over all its stops until the last time.

    Args:
        t: s, 0 or more, any shape.
        start: x on the lower half of the ellipse, m.
        speed: along the path, m/s, positive towards the end support.
        mass: kg.
        friction: a capstan or a point block (`ropewalk.theory.friction`), the same at rest and in motion.
        coefficient: 0 or more.
        span, height, length, gravity: as in `small_period`.

    Returns:
        The motion, each piece from stop to stop by Runge-Kutta with a relative error of 1e-12.

    Raises:
        ValueError: an argument out of range, or a start at which the bead does not keep both pieces of the rope taut.
    """
    _arguments.positive(mass=mass, gravity=gravity)
    _arguments.not_negative(coefficient=coefficient)
    _arguments.finite(speed=speed)
    if friction not in ("capstan", "block"):
        raise ValueError(f'friction must be "capstan" or "block", not {friction!r}')
    (t,) = _arguments.within(0.0, np.inf, t=t)
    _arguments.finite(t=t)
    path = _ellipse.of_rope(span, height, length)
    friction_limit = _friction_limit(path, friction, coefficient)
    phi = path.hanging(start)
    state, begin, end = np.array([phi, speed / path.sliding_speed(np.asarray(phi))]), 0.0, float(np.max(t, initial=0.0))
    flat = t.ravel()
    states, sense = np.full((2, flat.size), np.nan), np.zeros(flat.size)
    stops: list[tuple[float, float]] = []
    rests, slack_at = False, None
    while len(stops) <= MOST_STOPS:
        way = _way(path, friction_limit, state)
        if way == 0.0:
            rests = True
            states[:, flat >= begin] = state[:, np.newaxis]
            break
        piece, outcome = _until_stop(path, friction_limit, way, state, begin, end, gravity)
        covered = (flat >= begin) & (flat <= piece.t[-1])
        if np.any(covered):
            states[:, covered], sense[covered] = piece.sol(flat[covered]), way
        if outcome == "slack":
            slack_at = float(piece.t[-1])
        if outcome != "stop":
            break
        begin, state = float(piece.t[-1]), np.array([piece.y[0, -1], 0.0])
        stops.append((begin, float(path.place(state[0])[0])))
    else:
        raise ValueError(f"the bead stops more than {MOST_STOPS} times: give more friction or fewer seconds")
    phi, phi_rate = states.reshape(2, *t.shape)
    ratio = np.where(sense.reshape(t.shape) == 0.0, _hold(path, phi), -sense.reshape(t.shape) * friction_limit(phi))
    times, places = np.array(stops).reshape(-1, 2).T
    return _motion(path, phi, phi_rate, ratio, mass, gravity, stops=(times, places), rests=rests, slack_at=slack_at)


def _swing(path: Ellipse, start: float) -> float:
    """Signed half swing in the eccentric angle: from the lowest point back to the start."""
    half = path.lowest - path.hanging(start)
    far, _ = path.slope(np.asarray(path.lowest + half))
    if not far > 0.0:
        raise ValueError(f"released at {start} m the bead would slacken the rope beyond: start it lower")
    return half


def _clock(path: Ellipse, half: float) -> NDArray[np.complex128]:
    """Fourier coefficients of ``dt/du sqrt(g depth)``; the first is its mean."""
    k, samples = np.sin(0.5 * half), 32
    while True:
        sin = np.sin(2.0 * np.pi * np.arange(samples) / samples)
        phi = path.lowest + 2.0 * np.arcsin(k * sin)
        series = np.fft.rfft(path.sliding_speed(phi) / np.sqrt(1.0 - (k * sin) ** 2)) / samples
        kept = np.flatnonzero(np.abs(series) > 1e-15 * abs(series[0]))[-1] + 1
        if kept <= samples // 4:
            return np.asarray(series[:kept])
        if samples == MOST_SAMPLES:
            raise ValueError("the rope is too little longer than the distance of its supports: make it longer")
        samples *= 2


def _friction_limit(path: Ellipse, friction: Friction, coefficient: float) -> Callable[[FloatArray], FloatArray]:
    """``|T_ahead - T_behind|/(T_ahead + T_behind)`` in motion, signed with the sense of the eccentric angle."""

    def friction_limit(phi: FloatArray) -> FloatArray:
        half = path.half_turn(phi)
        amount = np.tanh(coefficient * half) if friction == "capstan" else coefficient * np.tan(half)
        return np.asarray(np.copysign(amount, np.cos(phi)))

    return friction_limit


def _hold(path: Ellipse, phi: FloatArray) -> FloatArray:
    """``(T_ahead - T_behind)/(T_ahead + T_behind)`` at rest, signed as the tensions are."""
    run, rise = path.slope(phi)
    return np.asarray(rise / run * path.b / (path.c * np.cos(phi)))


def _way(path: Ellipse, friction_limit: Callable[[FloatArray], FloatArray], state: FloatArray) -> float:
    """The sense in which the bead moves from here, 1 or -1, or 0 if friction holds it."""
    phi = np.asarray(state[0])
    if state[1] != 0.0:
        return float(np.sign(state[1]))
    _, rise = path.slope(phi)
    if rise == 0.0 or abs(float(_hold(path, phi))) <= min(abs(float(friction_limit(phi))), 1.0):  # a rope does not push
        return 0.0
    return float(-np.sign(rise))


def _until_stop(
    path: Ellipse,
    friction_limit: Callable[[FloatArray], FloatArray],
    way: float,
    state: FloatArray,
    begin: float,
    end: float,
    gravity: float,
) -> tuple[Any, Literal["stop", "slack", "end"]]:
    """Integrate the eccentric angle until the bead stops, a piece of the rope slackens, or the time is over."""
    from scipy.integrate import solve_ivp

    def press(phi: FloatArray, rate: FloatArray) -> FloatArray:  # N/m
        sliding_speed = path.sliding_speed(phi)
        return np.asarray(gravity * path.slope(phi)[0] / sliding_speed + path.a * path.b / sliding_speed * rate**2)

    def rates(_: float, y: FloatArray) -> list[float]:
        phi, rate = y
        sliding_speed, (_run, rise) = path.sliding_speed(phi), path.slope(phi)
        bend = -(path.c**2) * np.sin(phi) * np.cos(phi) / sliding_speed  # dh/dphi
        drag = way * abs(friction_limit(phi)) / np.tan(path.half_turn(phi)) * press(phi, rate)
        return [rate, (-gravity * rise / sliding_speed - drag - bend * rate**2) / sliding_speed]

    def stop(_: float, y: FloatArray) -> float:
        return float(way * y[1])

    def taut(_: float, y: FloatArray) -> float:
        return float(press(*y)) * (1.0 - abs(float(friction_limit(y[0]))))

    if not taut(begin, state) > 0.0:
        raise ValueError(
            "the bead does not keep both pieces of the rope taut where it starts: start it lower or faster"
        )
    for event in (stop, taut):
        event.terminal, event.direction = True, -1.0  # type: ignore[attr-defined]
    # The end lies a little later so that the last time is inside.
    piece = solve_ivp(
        rates, (begin, end + 1e-9 * max(end, 1.0)), state, method="DOP853", rtol=1e-12, atol=1e-13,
        events=(stop, taut), dense_output=True,
    )  # fmt: skip
    outcome: Literal["stop", "slack", "end"] = "end"
    if piece.t_events[0].size:
        outcome = "stop"
    elif piece.t_events[1].size:
        outcome = "slack"
    return piece, outcome


def _motion(
    path: Ellipse,
    phi: FloatArray,
    phi_rate: FloatArray,
    ratio: FloatArray,
    mass: float,
    gravity: float,
    *,
    stops: tuple[FloatArray, FloatArray],
    rests: bool,
    slack_at: float | None = None,
) -> Slide:
    """The places, velocities and tensions; ``ratio`` is that of the tensions' difference to their sum."""
    (x, z), (run, rise), sliding_speed = path.place(phi), path.slope(phi), path.sliding_speed(phi)
    press = mass * (gravity * run / sliding_speed + path.a * path.b / sliding_speed * phi_rate**2)
    mean = 0.5 * press * sliding_speed / path.b
    return Slide(
        x=x, z=z, x_velocity=np.asarray(run * phi_rate), z_velocity=np.asarray(rise * phi_rate),
        tension_behind=np.asarray(mean * (1.0 - ratio)), tension_ahead=np.asarray(mean * (1.0 + ratio)),
        stop_times=stops[0], stop_places=stops[1], rests=rests, slack_at=slack_at,
    )  # fmt: skip
