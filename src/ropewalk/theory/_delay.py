"""A moving load on a taut string between two supports, slower than the waves: two delays, marched to the far support.

Lengths are counted in L, times in L/c, accelerations in g. Write v for the velocity of the rider's contact across the
string, and ``N = line m g n`` for the contact force, m the rider's mass, ``line = 2 rho L/m``. A force on the string
sends out two waves; the one to the left comes back from the support at time t if it left at ``beta t``, ``beta = (1 -
alpha)/(1 + alpha)``, the one to the right if it left at ``(t - t1)/beta``, ``t1 = 2/(1 + alpha)``. With Q and R for
the outgoing waves, as contributions to v,

    Q(t) = v(t) + beta Q(beta t),    R(t) = v(t) + R((t - t1)/beta) / beta,    n = Q + R - v,

and the rider's own equations, ``inertia z' = matrix z + drive - line n e_0`` with z_0 = v, close the system. Derived in
docs/notes/moving-mass-on-a-string.md.

The wave that bounces between rider and far support meets the rider at ``t_k = T (1 - beta^k)``, T = 1/alpha, and leaves
kinks there. Between, a time is ``t_k + s (t_(k+1) - t_k)``: in these terms the delay to the right is simply k - 1 at
the same s. R grows as ``beta^-k``.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ropewalk.theory import _panels

__all__ = ["DelayBody", "DelaySolution", "response"]

FloatArray = NDArray[np.float64]

REMAINDER = 1e-13  # the march ends with this part of the passage left
TOLERANCE = 1e-8  # of the last coefficients of a panel, of the largest value nearby
SMOOTH = 1e-13  # the same before the first meeting, where the solution has no kinks
LOOSEST = 1e4  # times the tolerance towards the end, where the time left makes errors of v count less
MOST_PANELS = 2000  # of a stretch
NARROWEST = 1e-12  # panel, of an interval between two meetings


@dataclass(frozen=True)
class DelayBody:
    """Equations ``inertia z' = matrix z + drive - line n e_0`` from z = 0, no inertia only in the first row."""

    inertia: FloatArray
    matrix: FloatArray
    drive: FloatArray
    line: float

    @property
    def size(self) -> int:
        return len(self.inertia)

    def closed(self) -> FloatArray:
        """Matrix with the string's resistance to z_0 itself."""
        matrix = self.matrix.copy()
        matrix[0, 0] -= self.line
        return matrix


@dataclass(frozen=True)
class DelayClock:
    """Times of the meetings with the wave from the far support, and places between them."""

    alpha: float

    @property
    def beta(self) -> float:
        return (1.0 - self.alpha) / (1.0 + self.alpha)

    @property
    def stay(self) -> float:
        return 1.0 / self.alpha

    def meeting(self, k: int) -> float:
        return float(-self.stay * np.expm1(k * np.log(self.beta)))

    def width(self, k: int) -> float:
        return float(2.0 / (1.0 + self.alpha) * self.beta**k)

    def place(self, t: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
        """Interval and place 0..1 in it."""
        left = np.maximum(1.0 - t * self.alpha, 0.1 * REMAINDER)
        k = np.where(t < self.width(0), 0, np.maximum(np.floor(np.log(left) / np.log(self.beta) + 1e-14), 1.0))
        s = np.where(k == 0, t / self.width(0), (1.0 - left * self.beta**-k) / (1.0 - self.beta))
        return k.astype(np.intp), np.clip(s, 0.0, 1.0)


@dataclass
class _Panels:
    """Panels so far, in the order of time: state, Q and R as polynomials."""

    key: FloatArray  # k + s at the start
    start: FloatArray  # s
    width: FloatArray  # in s
    interval: NDArray[np.intp]  # k
    coefficients: FloatArray  # (panel, field, degree)
    count: int = 0

    @classmethod
    def none(cls, fields: int) -> "_Panels":
        key, start, width = np.zeros((3, 64))
        return cls(key, start, width, np.zeros(64, np.intp), np.zeros((64, fields, _panels.ORDER)))

    def add(self, k: int, edges: FloatArray, coefficients: FloatArray) -> None:
        last = self.count + len(edges) - 1
        while last > len(self.key):
            for name in ("key", "start", "width", "interval", "coefficients"):
                old = getattr(self, name)
                setattr(self, name, np.concatenate([old, np.zeros_like(old)]))
        new = slice(self.count, last)
        self.key[new], self.start[new], self.width[new] = k + edges[:-1], edges[:-1], np.diff(edges)
        self.interval[new], self.coefficients[new] = k, coefficients
        self.count = last

    def find(self, k: NDArray[np.intp], s: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
        """Panel and place 0..1 in it."""
        index = np.maximum(np.searchsorted(self.key[: self.count], k + s, side="right") - 1, 0)
        return index, np.clip((s - self.start[index]) / self.width[index], 0.0, 1.0)

    def at(self, field: int, k: NDArray[np.intp], s: FloatArray) -> FloatArray:
        index, place = self.find(k, s)
        return _panels.at(self.coefficients[index, field], place)

    def edges(self, k: int) -> FloatArray:
        """Starts of the panels of an interval."""
        low, high = np.searchsorted(self.interval[: self.count], [k, k + 1])
        return self.start[low:high]


@dataclass(frozen=True)
class DelaySolution:
    """The march's answer."""

    clock: DelayClock
    moving_load: DelayBody
    panels: _Panels
    deflection: FloatArray  # at the start of each panel, and at the end

    def _at(self, t: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
        return self.panels.find(*self.clock.place(t))

    def state(self, row: int, t: FloatArray) -> FloatArray:
        """Row of z at times 0..T."""
        index, place = self._at(t)
        return _panels.at(self.panels.coefficients[index, row], place)

    def force(self, t: FloatArray) -> FloatArray:
        """Contact force over the moving load's weight, ``line n``."""
        index, place = self._at(t)
        return _panels.at(self._force_coefficients()[index], place)

    def path(self, t: FloatArray) -> FloatArray:
        """Deflection under the rider."""
        index, place = self._at(t)
        width = self.panels.width[index] * self.clock.width(0) * self.clock.beta ** self.panels.interval[index]
        return self.deflection[index] + width * _panels.integral_at(self.panels.coefficients[index, 0], place)

    @property
    def end(self) -> float:
        """Deflection at the far support; the mean force over the last bounces has its sign."""
        return float(self.deflection[-1])

    def contact_lost(self) -> float | None:
        """First time at which the contact would have to pull, or None."""
        places = np.linspace(0.0, 1.0, 2 * _panels.ORDER)
        coefficients = self._force_coefficients()
        values = _panels.at(coefficients[:, np.newaxis, :], places[np.newaxis, :])
        largest = np.maximum.accumulate(np.abs(values).ravel())
        beginning = len(places) * len(self.panels.edges(0))
        pulls = values.ravel() < -1e-9 * np.maximum(largest, largest[beginning - 1])  # N = 0 at the start
        if not np.any(pulls):
            return None
        first = int(np.argmax(pulls))
        index, inside = divmod(first, len(places))
        low, high = places[max(inside - 1, 0)], places[inside]
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if _panels.at(coefficients[index], middle) > 0.0 else (low, middle)
        k, s = int(self.panels.interval[index]), self.panels.start[index] + high * self.panels.width[index]
        return self.clock.meeting(k) + float(s) * self.clock.width(k)

    def _force_coefficients(self) -> FloatArray:
        fields = self.panels.coefficients[: self.panels.count]
        return self.moving_load.line * (fields[:, -2] + fields[:, -1] - fields[:, 0])


def response(alpha: float, moving_load: DelayBody) -> DelaySolution:
    """Return the passage of a moving load with speed ``alpha`` (0 < alpha < 1) times that of the waves."""
    clock = DelayClock(alpha)
    panels = _Panels.none(moving_load.size + 2)
    first, state = _beginning(clock, moving_load, panels)
    deepest = int(np.ceil(np.log(REMAINDER) / np.log(clock.beta)))
    for k in range(deepest):
        start, width = clock.meeting(k), clock.width(k)
        s = first if k == 0 else 0.0
        while s < 1.0:
            # No further than the wave from the left is known.
            until = min(((start + s * width) / clock.beta - start) / width, 1.0)
            until = 1.0 if until > 1.0 - 1e-9 else until
            state = _stretch(clock, moving_load, panels, k, (s, until), state)
            s = until
    used = slice(0, panels.count)
    widths = panels.width[used] * clock.width(0) * clock.beta ** panels.interval[used]
    steps = widths * panels.coefficients[used, 0, 0]
    return DelaySolution(clock, moving_load, panels, np.concatenate([[0.0], np.cumsum(steps)]))


def _beginning(clock: DelayClock, moving_load: DelayBody, panels: _Panels) -> tuple[float, FloatArray]:
    """Put down the power series of the first moments; return the place in interval 0 that it reaches and the state."""
    closed, beta = moving_load.closed(), clock.beta
    rate = np.max(np.abs(closed) / np.where(moving_load.inertia > 0.0, moving_load.inertia, np.inf)[:, np.newaxis])
    reach = min(0.5, (1.0 - beta) / max(rate * clock.width(0), 1e-300))
    series = np.zeros((_panels.ORDER + 4, moving_load.size))
    waves = np.zeros(len(series))
    for j in range(len(series)):
        if j > 0:
            change = moving_load.matrix @ series[j - 1] + moving_load.drive * (j == 1)
            change[0] -= moving_load.line * waves[j - 1]
            series[j] = np.where(
                moving_load.inertia > 0.0,
                change / np.where(moving_load.inertia > 0.0, moving_load.inertia, 1.0) / j,
                0.0,
            )
        if moving_load.inertia[0] == 0.0:
            given = moving_load.matrix[0, 1:] @ series[j, 1:] + moving_load.drive[0] * (j == 0)
            series[j, 0] = given / (moving_load.line / (1.0 - beta ** (j + 1)) - moving_load.matrix[0, 0])
        waves[j] = series[j, 0] / (1.0 - beta ** (j + 1))
    width = reach * clock.width(0)
    powers = (width * _panels.POINTS[:, np.newaxis]) ** np.arange(len(series))
    values = np.column_stack([powers @ series, powers @ waves, powers @ series[:, 0]])
    panels.add(0, np.array([0.0, reach]), (_panels.FIT @ values).T[np.newaxis])
    return reach, width ** np.arange(len(series)) @ series


def _stretch(
    clock: DelayClock, moving_load: DelayBody, panels: _Panels, k: int, span: tuple[float, float], state: FloatArray
) -> FloatArray:
    """March over places ``span`` of interval k from a state; return the state at the end."""
    before = panels.edges(k - 1)[::2] if k else np.zeros(0)
    inside = before[(before > span[0] + NARROWEST) & (before < span[1] - NARROWEST)]
    edges = np.concatenate([[span[0]], inside, [span[1]]])
    tolerance = TOLERANCE * min(clock.beta**-k, LOOSEST) if k else SMOOTH
    while True:
        coefficients, end = _solve(clock, moving_load, panels, k, edges, state)
        # The waves alone decide: they hold the force, and a stiff spring's length is small differences of velocities.
        waves = coefficients[:, [0, moving_load.size, moving_load.size + 1]]
        tail = np.max(np.abs(waves[:, :, -2:]), axis=(1, 2))
        poor = (tail > tolerance * np.max(np.abs(waves))) & (np.diff(edges) > NARROWEST)
        if not np.any(poor) or len(edges) > MOST_PANELS:
            panels.add(k, edges, coefficients)
            return end
        edges = np.sort(np.concatenate([edges, 0.5 * (edges[:-1] + edges[1:])[poor]]))


def _solve(
    clock: DelayClock, moving_load: DelayBody, panels: _Panels, k: int, edges: FloatArray, state: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Collocate at the Gauss points of all panels; return coefficients (panel, field, degree) and the last state."""
    size, order = moving_load.size, _panels.ORDER
    s = edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * _panels.POINTS
    left = clock.beta * panels.at(size, *clock.place(clock.beta * (clock.meeting(k) + s * clock.width(k))))
    right = panels.at(size + 1, np.full(s.shape, k - 1), s) / clock.beta if k else np.zeros_like(s)
    step = np.diff(edges) * clock.width(k)
    closed, identity = moving_load.closed(), np.eye(order)
    known = np.repeat(moving_load.drive[np.newaxis, :, np.newaxis], len(step), axis=0) * np.ones(order)
    known[:, 0] -= moving_load.line * (left + right)

    matrix = np.zeros((len(step), size, order, size, order))
    given = np.zeros((len(step), size, order, size + 1))  # what comes from each row of the state, and the rest
    for row in range(size):
        if moving_load.inertia[row] > 0.0:
            total = step[:, np.newaxis, np.newaxis] * _panels.SUM_TO_POINTS
            given[:, row, :, row] = moving_load.inertia[row]
        else:
            total = np.broadcast_to(identity, (len(step), order, order))
        for column in range(size):
            matrix[:, row, :, column] = -closed[row, column] * total
        matrix[:, row, :, row] += moving_load.inertia[row] * identity
        given[:, row, :, size] = np.einsum("pij,pj->pi", total, known[:, row])
    parts = np.linalg.solve(
        matrix.reshape(len(step), size * order, size * order), given.reshape(len(step), size * order, size + 1)
    ).reshape(len(step), size, order, size + 1)

    # From the state at the start of each panel to that at its end, one after the other.
    change = np.einsum("rc,pcks->prks", closed, parts)
    change[..., size] += known
    end = np.einsum("k,prks->prs", _panels.SUM, change) * step[:, np.newaxis, np.newaxis]
    heavy = moving_load.inertia > 0.0
    end = np.where(heavy[:, np.newaxis], end / np.where(heavy, moving_load.inertia, 1.0)[:, np.newaxis], 0.0)
    end[:, :, :size] += np.diag(heavy)
    starts = [state]
    for panel in end:
        starts.append(panel[:, :size] @ starts[-1] + panel[:, size])
    states = np.einsum("prks,ps->prk", parts[..., :size], np.array(starts[:-1])) + parts[..., size]
    fields = np.concatenate(
        [states, (states[:, 0] + left)[:, np.newaxis], (states[:, 0] + right)[:, np.newaxis]], axis=1
    )
    return fields @ _panels.FIT.T, starts[-1]
