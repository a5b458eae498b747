"""Response of an endless line on periodic supports to a constant force that moves with constant speed.

A force F at y = V t is, for each x, a sum of waves ``exp(-i q x)`` shaken with ``omega = q V`` and the phase ``q d``
per span. With the compliance G and the support stiffness D of `Spans`, and ``Delta = EI q^4 + T q^2 - m omega^2 + i
omega damping``, the field with ``w(x + d, t + d/V) = w(x, t)`` is

    w = F/pi Re integral_0^inf [exp(-i q x) - D G(x)/(1 + D G(0))]/Delta exp(i q y) d q,    0 <= x <= d.

What makes it computable:
- G has a pole, ``exp(-i q x)/(d Delta)`` of the bare line: near q = 0, where the bracket would cancel, the rest ``R
  = G - exp(-i q x)/(d Delta)`` is taken from a circle around 0 by Cauchy's formula.
- ``1/[EI (q^2 + r^2) (q^2 + s^2)]``, of a string ``1/[(T - m V^2) (q^2 + s^2)]``, has a known integral and the kink
  under the force; without it the integrand falls faster.
- Panels of quadrature begin and end where the undamped line has a free wave, and are halved until they agree.
- An undamped line radiates along poles on the path. There the force is taken as ``exp(e t)`` and the result
  extrapolated to e = 0: waves then go where their group velocity carries them.

Derived here; Jezequel, J. Appl. Mech. 48 (1981), and Mead, Wave Propagation in Continuous Periodic Structures, J.
Sound Vib. 190 (1996), for the method.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments
from ropewalk.theory._quadrature import Integrand, adaptive
from ropewalk.theory._spans import SpanLayout

__all__ = ["moving_force", "moving_force_drag", "moving_force_error"]

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complexfloating[Any, Any]]

FIRST_ZONES, MOST_ZONES = 8, 4096  # of length pi/d in q
# Where both cancel, as ahead of a force that outruns its waves, the tolerance is of a part of the known one.
LEAST = 1e-2
GROWTHS = 0.02 * 0.5 ** np.arange(4)  # of the force per span it passes, for the extrapolation


def moving_force(
    x: ArrayLike,
    place: ArrayLike,
    *,
    force: float,
    speed: float,
    spacing: float,
    mass: float,
    support_stiffness: float,
    support_mass: float = 0.0,
    tension: float = 0.0,
    bending_stiffness: float = 0.0,
    damping: float = 0.0,
    support_damping: float = 0.0,
    tolerance: float = 1e-5,
) -> FloatArray:
    """Return the deflection at ``x`` when the moving force is at ``place`` = V t, in m; both in m, they broadcast.

    Supports are at all multiples of ``spacing``; the line has no ends and the force comes from infinity. ``force``
    in N, ``speed`` >= 0 in m/s (0: the limit, the force at rest at ``place``), ``damping`` of the line in N s/m^2,
    ``support_damping`` in N s/m; the rest as in `pass_bands`. The deflection under the load over a span is
    ``moving_force(y, y)``. Without any damping it is the limit of vanishing damping, good within some tens of spans
    of the load.

    ``tolerance`` is relative to the largest deflection asked for or under the load at mid-span, whichever is
    larger, or to a hundredth of what the line has there without supports, where all of that is less.
    `ArithmeticError` where it is not reached (`moving_force_error` tells by how much), as at a speed at which a wave
    keeps pace with the load undamped. Undamped strings far below their wave speed take long. `ValueError` for
    arguments out of range, for supports without stiffness, and for a string at its wave speed.
    """
    spans = SpanLayout(
        spacing, mass, tension, bending_stiffness, support_stiffness, support_mass, damping, support_damping
    )
    deflection, error, scale = _deflection(spans, x, place, force, speed, tolerance)
    if error > tolerance * scale:
        raise ArithmeticError(
            f"the Floquet integral has an error of {error:.1e} m, more than the tolerance {tolerance:g} of "
            f"{scale:.1e} m: add damping, keep away from speeds at which waves keep pace, or allow more"
        )
    return deflection


def moving_force_error(
    x: ArrayLike,
    place: ArrayLike,
    *,
    force: float,
    speed: float,
    spacing: float,
    mass: float,
    support_stiffness: float,
    support_mass: float = 0.0,
    tension: float = 0.0,
    bending_stiffness: float = 0.0,
    damping: float = 0.0,
    support_damping: float = 0.0,
    tolerance: float = 1e-5,
) -> tuple[FloatArray, float]:
    """Return the deflection of `moving_force`, reached or not, and an estimate of its largest error, both in m.

    Arguments as there. The estimate adds up the differences of the last two halvings of all panels, the share of
    the last octave of q for what lies beyond, and the last step of the extrapolation.
    """
    spans = SpanLayout(
        spacing, mass, tension, bending_stiffness, support_stiffness, support_mass, damping, support_damping
    )
    deflection, error, _ = _deflection(spans, x, place, force, speed, tolerance)
    return deflection, error


def moving_force_drag(
    *,
    force: float,
    speed: float,
    spacing: float,
    mass: float,
    support_stiffness: float,
    support_mass: float = 0.0,
    tension: float = 0.0,
    bending_stiffness: float = 0.0,
    damping: float = 0.0,
    support_damping: float = 0.0,
    tolerance: float = 1e-4,
) -> float:
    """Return the mean force along the line that keeps the moving force going, in N, zero or positive.

    Arguments and errors as in `moving_force`; ``tolerance`` relative to the result. Times ``spacing`` it is the
    work that the line takes up per span, by damping or, undamped, by radiation. It is minus ``force`` times the
    mean slope under the load, ``F^2/pi Re integral i q A dq`` with the mean A of the integrand over a span.
    """
    spans = SpanLayout(
        spacing, mass, tension, bending_stiffness, support_stiffness, support_mass, damping, support_damping
    )
    _require(spans, force, speed, tolerance)
    if speed == 0.0 or force == 0.0:
        return 0.0
    values, errors, _ = _limit(spans, speed, tolerance, lambda growth: _mean_slope(spans, speed, growth))
    drag = float(values[0])
    if errors > tolerance * abs(drag):
        raise ArithmeticError(f"the drag has a relative error of {errors / abs(drag):.1e}, more than {tolerance:g}")
    return force**2 * drag


def _deflection(
    spans: SpanLayout, x: ArrayLike, place: ArrayLike, force: float, speed: float, tolerance: float
) -> tuple[FloatArray, float, float]:
    """Deflection, error, and the deflection that the tolerance refers to."""
    _require(spans, force, speed, tolerance)
    _arguments.finite(x=x, place=place)
    points, y = np.broadcast_arrays(np.asarray(x, dtype=np.float64), np.asarray(place, dtype=np.float64))
    shape, d = points.shape, spans.spacing
    # the last one is the load at mid-span, for the scale
    points, y = np.append(points, 0.5 * d), np.append(y, 0.5 * d)
    if speed == 0.0:
        values, error = _at_rest(spans, points, y, tolerance)
        scale = float(np.max(np.abs(values)))
        return force * values[:-1].reshape(shape), abs(force) * error, abs(force) * scale
    cell = np.floor(points / d) * d
    points, y = points - cell, y - cell
    kink = _Kink.of(spans, speed)

    x_unlike, x_index = np.unique(points, return_inverse=True)
    y_unlike, y_index = np.unique(y, return_inverse=True)

    def integrand(growth: float) -> Integrand:
        field = _field(spans, x_unlike, speed, growth)

        def product(q: FloatArray) -> ComplexArray:
            column = q[:, None]
            smooth = field(q) - kink.transform(column) * np.exp(-1j * column * x_unlike)
            return np.asarray(smooth[:, x_index] * np.exp(1j * column * y_unlike)[:, y_index])

        return product

    known = kink.shape(points - y)
    values, error, scale = _limit(spans, speed, tolerance, integrand, known)
    return force * (known + values)[:-1].reshape(shape), abs(force) * error, abs(force) * scale


def _at_rest(spans: SpanLayout, x: FloatArray, y: FloatArray, tolerance: float) -> tuple[FloatArray, float]:
    """Deflection per force at rest, and its error.

    All q that differ by 2 pi/d meet the same G, and their sum is G again: ``w = 1/(2 pi) integral over mu of G(x - y)
    - D G(x) G(-y)/(1 + D G(0))``. Periodic, so equal steps converge fast; they keep off the pole at mu = 0.
    """
    d = spans.spacing
    between, x_cell, y_cell = x - y, np.floor(x / d), np.floor(-y / d)
    gap_cell = np.floor(between / d)
    previous: FloatArray | None = None
    for steps in 2 ** np.arange(5, 14):
        mu = (2.0 * np.pi * (np.arange(steps) + 0.5) / steps)[:, None]
        places = np.concatenate([between - gap_cell * d, x - x_cell * d, -y - y_cell * d, np.zeros(1)])
        at = spans.compliance(np.clip(places, 0.0, d), np.zeros(steps, dtype=np.complex128), mu[:, 0] + 0.0j)
        direct, there, here = (at[:, j * len(x) : (j + 1) * len(x)] for j in range(3))
        own = at[:, -1:] + (0.0 if spans.rigid else 1.0 / spans.support_stiffness)
        field = direct * np.exp(-1j * mu * gap_cell) - there * here * np.exp(-1j * mu * (x_cell + y_cell)) / own
        result = np.mean(field.real, axis=0)
        if previous is not None:
            change = float(np.max(np.abs(result - previous)))
            if change < 0.01 * tolerance * float(np.max(np.abs(result))):
                break
        previous = result
    return result, change


def _require(spans: SpanLayout, force: float, speed: float, tolerance: float) -> None:
    _arguments.finite(force=force)
    _arguments.not_negative(speed=speed)
    _arguments.positive(tolerance=tolerance)
    if spans.support_stiffness == 0.0:
        raise ValueError("support_stiffness must be positive: without supports the deflection knows no bound")
    if spans.bending_stiffness == 0.0 and spans.tension == spans.mass * speed**2:
        raise ValueError("speed must not be the wave speed of the string: the deflection knows no bound there")


def _limit(
    spans: SpanLayout,
    speed: float,
    tolerance: float,
    integrand: Callable[[float], Integrand],
    known: FloatArray | float = 0.0,
) -> tuple[FloatArray, float, float]:
    """Real part of the integral over pi, extrapolated to no growth where nothing is damped; error; scale."""
    damped = spans.damping > 0.0 or spans.support_damping > 0.0
    growths = np.zeros(1) if damped else GROWTHS * speed / spans.spacing
    least = LEAST * float(np.max(np.abs(known)))
    column: list[FloatArray] = []
    error = 0.0
    for growth in growths:
        value, quadrature = _integrate(integrand(float(growth)), spans, speed, tolerance, known, 0.1 * least)
        previous, column = column, [value]
        for j, older in enumerate(previous):
            column.append(column[j] + (column[j] - older) / (2.0 ** (j + 1) - 1.0))
        error = max(error, quadrature)
    if len(growths) > 1:  # the weights of the extrapolation add up to 6.4
        error = 6.4 * error + float(np.max(np.abs(column[-1] - column[-2])))
    return column[-1], error, max(float(np.max(np.abs(column[-1] + known))), least)


@dataclass(frozen=True)
class _Kink:
    """A transform that falls like the integrand and whose integral is known."""

    factor: float
    s: float
    r: float  # infinite for a string

    @staticmethod
    def of(spans: SpanLayout, speed: float) -> "_Kink":
        effective, s = spans.tension - spans.mass * speed**2, 2.0 / spans.spacing
        if spans.bending_stiffness == 0.0:
            return _Kink(effective, s, np.inf)
        return _Kink(spans.bending_stiffness, s, float(np.sqrt(max(effective / spans.bending_stiffness, 4.0 * s**2))))

    def transform(self, q: FloatArray) -> FloatArray:
        second = 1.0 if np.isinf(self.r) else q**2 + self.r**2
        return 1.0 / (self.factor * (q**2 + self.s**2) * second)

    def shape(self, distance: FloatArray) -> FloatArray:
        xi = np.abs(distance)
        near = np.exp(-self.s * xi) / (2.0 * self.s * self.factor)
        if np.isinf(self.r):
            return near
        return (near - np.exp(-self.r * xi) / (2.0 * self.r * self.factor)) / (self.r**2 - self.s**2)


def _field(spans: SpanLayout, x: FloatArray, speed: float, growth: float) -> Integrand:
    """The integrand at the points x, 0..d, for the load at y = 0."""
    rest = _rest_near_zero(spans, np.append(x, 0.0), speed, growth)

    def field(q: FloatArray) -> ComplexArray:
        omega = q * speed - 1j * growth
        wave = np.exp(-1j * q[:, None] * x)
        bare = spans.stiffness(q + 0.0j, omega)[:, None]
        result = np.empty(wave.shape, dtype=np.complex128)
        near = q < rest.reach
        far = ~near
        if np.any(far):
            at = spans.compliance(np.append(x, 0.0), omega[far], q[far] * spans.spacing + 0.0j)
            if spans.rigid:
                ratio = at[:, :-1] / at[:, -1:]
            else:
                support = spans.support(omega[far])[:, None]
                ratio = support * at[:, :-1] / (1.0 + support * at[:, -1:])
            result[far] = (wave[far] - ratio) / bare[far]
        if np.any(near):
            at = rest(q[near])
            own, there = at[:, -1:], at[:, :-1]
            flexibility, support = _support(spans, omega[near])
            above = wave[near] * (flexibility + support * own) - support * there
            below = (flexibility + support * own) * bare[near] + support / spans.spacing
            result[near] = above / below
        return result

    return field


def _mean_slope(spans: SpanLayout, speed: float, growth: float) -> Integrand:
    """i q times the integrand at the load, averaged over a span."""
    rest = _rest_near_zero(spans, np.zeros(1), speed, growth)

    def slope(q: FloatArray) -> ComplexArray:
        omega = q * speed - 1j * growth
        bare = spans.stiffness(q + 0.0j, omega)
        own = np.empty(q.shape, dtype=np.complex128)
        near = q < rest.reach
        own[near] = rest(q[near])[:, 0]
        far = ~near
        at = spans.compliance(np.zeros(1), omega[far], q[far] * spans.spacing + 0.0j)[:, 0]
        own[far] = at - 1.0 / (spans.spacing * bare[far])
        flexibility, support = (part[:, 0] for part in _support(spans, omega))
        above = flexibility + support * own
        return np.asarray(1j * q * above / (above * bare + support / spans.spacing))[:, None]

    return slope


def _support(spans: SpanLayout, omega: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """A support as the pair (1, D), a rigid one as (0, 1)."""
    one = np.ones((len(omega), 1), dtype=np.complex128)
    return (0.0 * one, one) if spans.rigid else (one, spans.support(omega)[:, None])


@dataclass(frozen=True)
class _Remainder:
    """R inside a circle of wavenumbers from its values on it."""

    reach: float
    nodes: ComplexArray
    values: ComplexArray

    def __call__(self, q: FloatArray) -> ComplexArray:
        kernel = self.nodes / (self.nodes - q[:, None]) / len(self.nodes)
        return np.asarray(kernel @ self.values)


def _rest_near_zero(spans: SpanLayout, x: FloatArray, speed: float, growth: float) -> _Remainder:
    step = 2.0 * np.pi / spans.spacing
    radius = 0.25 * step
    while True:  # no pole of another branch within twice the radius
        least = step - 2.0 * radius
        omega = 2.0 * radius * speed + growth
        load = omega * (spans.mass * omega + spans.damping)
        if (spans.bending_stiffness * least**2 + spans.tension) * least**2 > 1.5 * load:
            break
        radius *= 0.5
    nodes = radius * np.exp(2j * np.pi * (np.arange(48) + 0.5) / 48)
    omega_nodes = nodes * speed - 1j * growth
    bare = spans.spacing * spans.stiffness(nodes, omega_nodes)[:, None]
    compliance = spans.compliance(x, omega_nodes, nodes * spans.spacing)
    return _Remainder(0.5 * radius, nodes, compliance - np.exp(-1j * nodes[:, None] * x) / bare)


def _integrate(
    f: Integrand, spans: SpanLayout, speed: float, tolerance: float, known: FloatArray | float, least: float
) -> tuple[FloatArray, float]:
    """Real part of the integral of f over q > 0, over pi, and its error.

    Every octave is summed twice, fading out and whole: a sharp end would leave its own waves in the result. What is
    left of a kink of w in y then falls with the last q and is extrapolated.
    """
    zone = np.pi / spans.spacing

    def octave(start: float, end: float) -> tuple[FloatArray, FloatArray, float]:
        def parts(q: FloatArray) -> ComplexArray:
            t = np.clip((q - start) / (end - start), 0.0, 1.0)
            fading = 1.0 - t**4 * (35.0 - t * (84.0 - t * (70.0 - 20.0 * t)))
            value = f(q) / np.pi
            return np.concatenate([value * fading[:, None], value], axis=1)

        edges = _breakpoints(spans, speed, start, end, 2 * round((end - start) / zone))
        twice = np.concatenate([np.broadcast_to(known + total, (points,))] * 2)
        both, missed = adaptive(parts, edges, tolerance, twice, least)
        return both[:points], both[points:], missed

    points = f(np.array([0.1 * zone])).shape[1]
    total: FloatArray | float = 0.0
    faded, whole, error = octave(0.0, FIRST_ZONES * zone)
    total, last, best, end = whole, faded, faded, FIRST_ZONES
    while True:
        faded, whole, missed = octave(end * zone, 2 * end * zone)
        result, error, end = total + faded, error + missed, 2 * end
        better = 2.0 * result - last  # where a kink is met the rest falls as 1/q
        change = float(np.max(np.abs(better - best)))
        if change < 0.3 * tolerance * max(float(np.max(np.abs(known + better))), least) or end >= MOST_ZONES:
            return better, error + change
        total, last, best = total + whole, result, better


def _breakpoints(spans: SpanLayout, speed: float, low: float, high: float, panels: int) -> FloatArray:
    """Ends of panels: equal steps, the free waves of the undamped line, and where it nearly has one."""
    even = np.linspace(low, high, panels + 1)
    if speed == 0.0:
        return even
    rate = 1.0 if spans.bending_stiffness > 0.0 else 1.0 + speed * float(np.sqrt(spans.mass / spans.tension))
    q = np.linspace(low, high, int(np.ceil((high - low) * spans.spacing * rate / 0.15)) + 1)[1:]
    value = spans.free_wave_equation(q, speed)
    change = np.sign(value[:-1]) != np.sign(value[1:])
    a, b, side = q[:-1][change], q[1:][change], np.sign(value[:-1][change])
    for _ in range(45):
        middle = 0.5 * (a + b)
        same = np.sign(spans.free_wave_equation(middle, speed)) == side
        a, b = np.where(same, middle, a), np.where(same, b, middle)
    size = np.abs(value)
    dip = (size[1:-1] < size[:-2]) & (size[1:-1] < size[2:]) & ~change[:-1] & ~change[1:]
    edges = np.unique(np.concatenate([even, 0.5 * (a + b), q[1:-1][dip]]))
    # two ends that are one but for rounding make an empty panel
    return np.asarray(edges[np.append(True, np.diff(edges) > 1e-13 * high)])
