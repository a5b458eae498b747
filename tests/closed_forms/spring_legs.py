"""Walking on two springs: the phases of a step, the map from one step to the next, and its periodic gaits."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments

__all__ = ["Gait", "SpringLegs", "Walk", "gaits", "walk"]

FloatArray = NDArray[np.float64]
Event = Callable[[float, FloatArray], float]

NUDGE = 1e-5  # m and m/s, for the derivatives of the step map: an error of 1e-9
TRIALS = 48  # heights at which a periodic gait is looked for


@dataclass(frozen=True)
class SpringLegs:
    """A point mass on two massless springs: kg, m at rest, N/m, the angle of the landing leg to the ground in rad."""

    mass: float
    leg_length: float
    stiffness: float
    attack_angle: float
    gravity: float = 9.81

    def __post_init__(self) -> None:
        _arguments.positive(
            mass=self.mass, leg_length=self.leg_length, stiffness=self.stiffness, gravity=self.gravity
        )  # fmt: skip
        if not 0.0 < self.attack_angle < 0.5 * np.pi:
            raise ValueError(f"attack_angle must lie between 0 and pi/2 rad, not {self.attack_angle}")

    @property
    def landing_height(self) -> float:
        """Height of the mass at which the leg in the air touches the ground, in m."""
        return self.leg_length * float(np.sin(self.attack_angle))

    def energy(self, height: float, speed: float, rise: float = 0.0) -> float:
        """Return the energy in J with one leg, upright, on the ground: ``height`` in m, the velocities in m/s."""
        kinetic = 0.5 * self.mass * (speed**2 + rise**2)
        return kinetic + self.mass * self.gravity * height + 0.5 * self.stiffness * (self.leg_length - height) ** 2

    def speed(self, energy: float, height: float, rise: float = 0.0) -> float:
        """Return the forward speed in m/s that goes with an ``energy`` in J. `ValueError` if it is too little."""
        square = 2.0 * (energy - self.energy(height, 0.0, rise)) / self.mass
        if not square >= 0.0:
            raise ValueError(f"an energy of {energy} J is too little for a height of {height} m")
        return float(np.sqrt(square))

    def push(self, place: FloatArray, foot: float) -> FloatArray:
        """Return the force (2, ...) of the leg on the mass in N, at ``place`` (x, y, ...) in m."""
        x, y = place[0] - foot, place[1]
        length = np.hypot(x, y)
        force = self.stiffness * (self.leg_length / length - 1.0)
        return np.stack([force * x, force * y])


@dataclass(frozen=True)
class _BipedalStep:
    """Three phases from one upright stance to the next: what integrated them, with the feet on the ground, in m."""

    phases: tuple[Any, Any, Any]
    old: float
    new: float

    @property
    def end(self) -> FloatArray:
        return np.asarray(self.phases[2].y[:, -1])

    def feet(self, phase: int) -> tuple[float, ...]:
        return ((self.old,), (self.old, self.new), (self.new,))[phase]


@dataclass(frozen=True)
class Walk:
    """A walk: arrays over the times (t,), over the feet in the order of landing (foot,), both for the forces.

    ``x``, ``y`` (m, y upwards from the ground) and their velocities (m/s) of the mass; ``forces`` (t, foot, 2): each
    leg's on the mass in N, zero in the air. The foot ``feet[i]`` (m) lands at ``landings[i]`` and leaves at
    ``departures[i]`` (s; NaN if before t = 0 or not seen). ``upright`` (stance,): the times at which the leg is
    upright.
    """

    x: FloatArray
    y: FloatArray
    x_velocity: FloatArray
    y_velocity: FloatArray
    forces: FloatArray
    feet: FloatArray
    landings: FloatArray
    departures: FloatArray
    upright: FloatArray


@dataclass(frozen=True)
class Gait:
    """A periodic symmetric gait: height and speed with the leg upright, and what follows from them, in SI units.

    ``largest_force``: of the ground, vertical, both legs together, in N. ``multipliers``: the eigenvalues of the step
    map in height and climb at constant energy; the gait is stable if they lie inside the unit circle.
    """

    height: float
    speed: float
    step_time: float
    step_length: float
    largest_force: float
    multipliers: NDArray[np.complex128]

    @property
    def mean_speed(self) -> float:
        """Return the step length by the step time, in m/s."""
        return self.step_length / self.step_time


def walk(t: ArrayLike, legs: SpringLegs, *, height: float, speed: float, rise: float = 0.0) -> Walk:
    """Return the walk on rigid level ground that begins with the leg upright over the foot at x = 0, at t = 0.

    Args:
        t: s, 0 or more, shape (t,).
        legs: the walker.
        height: of the mass above the ground, m.
        speed: forwards, m/s.
        rise: upwards, m/s.

    Returns:
        The walk, integrated with a relative error of 1e-12 from event to event.

    Raises:
        ValueError: an argument out of range, or the walker falls or takes off; when and why is said.

    Geyer, Seyfarth and Blickhan, Proc. R. Soc. B 273 (2006): the mass is driven by its weight and by one or two
    springs. A leg lands at a fixed angle when the mass has sunk to ``leg_length sin(attack_angle)``, and leaves at its
    length at rest.
    """
    (t,) = _arguments.within(0.0, np.inf, t=t)
    if t.ndim != 1 or not np.all(np.isfinite(t)):
        raise ValueError("t must be one row of finite times")
    _arguments.finite(speed=speed, rise=rise)
    last = float(np.max(t, initial=0.0))
    state, now = np.array([0.0, height, speed, rise]), 0.0
    steps: list[_BipedalStep] = []
    while not steps or now <= last:
        steps.append(_step(legs, state, now, steps[-1].new if steps else 0.0))
        state, now = steps[-1].end, float(steps[-1].phases[2].t[-1])
    motion, forces = np.empty((4, len(t))), np.zeros((len(t), len(steps) + 1, 2))
    for number, step in enumerate(steps):
        for phase, solved in enumerate(step.phases):
            covered = (t >= solved.t[0]) & (t <= solved.t[-1])
            if not np.any(covered):
                continue
            motion[:, covered] = solved.sol(t[covered])
            forces[covered] = 0.0
            for shift, foot in enumerate(step.feet(phase)):
                foot_number = number + shift + (1 if phase == 2 else 0)
                forces[covered, foot_number] = legs.push(motion[:, covered], foot).T
    x, y, x_velocity, y_velocity = motion
    return Walk(
        x=x,
        y=y,
        x_velocity=x_velocity,
        y_velocity=y_velocity,
        forces=forces,
        feet=np.array([0.0] + [step.new for step in steps]),
        landings=np.array([np.nan] + [step.phases[0].t[-1] for step in steps]),
        departures=np.array([step.phases[1].t[-1] for step in steps] + [np.nan]),
        upright=np.array([0.0] + [step.phases[2].t[-1] for step in steps]),
    )


def gaits(legs: SpringLegs, *, energy: float) -> tuple[Gait, ...]:
    """Return the symmetric gaits that repeat every step with an ``energy`` in J, ascending in height.

    There may be none. Symmetric: the mass neither climbs nor sinks when the leg is upright. The height there is the
    unknown, the climb one step later is to vanish; zeros are looked for between the landing height and the length of
    the leg, on a grid, and then refined to rounding. The derivatives of the step map are central differences.
    `ValueError` for an energy that is not positive.
    """
    from scipy.optimize import brentq

    _arguments.positive(energy=energy)

    def rise(height: float) -> float:
        return float(_next(legs, energy, height, 0.0)[1])

    heights = np.linspace(legs.landing_height, legs.leg_length, TRIALS + 2)[1:-1]
    climbs = []
    for height in heights:
        try:
            climbs.append(rise(height))
        except ValueError:
            climbs.append(np.nan)
    found = []
    for low, high, below, above in zip(heights[:-1], heights[1:], climbs[:-1], climbs[1:], strict=True):
        if not below * above <= 0.0:
            continue
        try:
            height = float(brentq(rise, low, high, xtol=1e-15, rtol=1e-14))
            back = _next(legs, energy, height, 0.0)
        except ValueError:  # a fall between the two
            continue
        if abs(back[0] - height) < 1e-9 * legs.leg_length and abs(back[1]) < 1e-7:
            found.append(_gait(legs, energy, height))
    return tuple(found)


def _gait(legs: SpringLegs, energy: float, height: float) -> Gait:
    speed = legs.speed(energy, height)
    step = _step(legs, np.array([0.0, height, speed, 0.0]), 0.0, 0.0)
    columns = []
    for nudge in ((NUDGE, 0.0), (0.0, NUDGE)):
        ahead = _next(legs, energy, height + nudge[0], nudge[1])
        behind = _next(legs, energy, height - nudge[0], -nudge[1])
        columns.append((ahead - behind) / (2.0 * NUDGE))
    return Gait(
        height=height,
        speed=speed,
        step_time=float(step.phases[2].t[-1]),
        step_length=step.new,
        largest_force=_largest_force(legs, step),
        multipliers=np.linalg.eigvals(np.array(columns).T).astype(np.complex128),
    )


def _next(legs: SpringLegs, energy: float, height: float, rise: float) -> FloatArray:
    """Height and climb one step later."""
    start = np.array([0.0, height, legs.speed(energy, height, rise), rise])
    return _step(legs, start, 0.0, 0.0).end[[1, 3]]


def _largest_force(legs: SpringLegs, step: _BipedalStep) -> float:
    """Of both legs, vertical: sampled, and refined about the largest sample."""
    from scipy.optimize import minimize_scalar

    largest = 0.0
    for phase, solved in enumerate(step.phases):

        def force(t: Any, solved: Any = solved, feet: Sequence[float] = step.feet(phase)) -> Any:
            return sum(legs.push(solved.sol(t), foot)[1] for foot in feet)

        times = np.linspace(solved.t[0], solved.t[-1], 65)
        best = int(np.argmax(force(times)))
        bounds = times[max(best - 1, 0)], times[min(best + 1, 64)]
        near = minimize_scalar(lambda t, force=force: -force(t), bounds=bounds, method="bounded")
        largest = max(largest, float(-near.fun), float(np.max(force(times))))
    return largest


def _step(legs: SpringLegs, state: FloatArray, begin: float, old: float) -> _BipedalStep:
    """From upright over the foot ``old`` to upright over the next one."""

    def length(y: FloatArray, foot: float) -> float:
        return float(np.hypot(y[0] - foot, y[1]))

    def excess(foot: float) -> Event:
        return lambda _, y: length(y, foot) - legs.leg_length

    if not (legs.landing_height < state[1] < legs.leg_length and state[2] > 0.0):
        raise ValueError(
            f"upright at t = {begin:.4g} s, the mass must move forwards and stand between {legs.landing_height:g} m, "
            f"where the other leg lands, and the leg's length {legs.leg_length:g} m, not at {state[1]:.6g} m with "
            f"{state[2]:.4g} m/s"
        )
    low: Event = lambda _, y: float(y[1]) - legs.landing_height  # noqa: E731
    first = _phase(legs, (old,), state, begin, (low, -1.0), {"takes off": (excess(old), 1.0), **_turns()})
    state, now = first.y[:, -1], first.t[-1]
    new = float(state[0] + legs.leg_length * np.cos(legs.attack_angle))
    second = _phase(
        legs, (old, new), state, now, (excess(old), 1.0), {"is thrown off the new leg": (excess(new), 1.0), **_turns()}
    )
    state, now = second.y[:, -1], second.t[-1]
    over: Event = lambda _, y: float(y[0]) - new  # noqa: E731
    third = _phase(legs, (new,), state, now, (over, 1.0), {"takes off": (excess(new), 1.0), **_turns()})
    return _BipedalStep((first, second, third), old, new)


def _turns() -> dict[str, tuple[Event, float]]:
    return {"falls": (lambda _, y: float(y[1]), -1.0), "turns back": (lambda _, y: float(y[2]), -1.0)}


def _phase(
    legs: SpringLegs,
    feet: tuple[float, ...],
    state: FloatArray,
    begin: float,
    goal: tuple[Event, float],
    failures: dict[str, tuple[Event, float]],
) -> Any:
    """Integrate over the springs at ``feet`` until the goal changes its sign; `ValueError` for what comes before it."""
    from scipy.integrate import solve_ivp

    def rates(_: float, y: FloatArray) -> list[float]:
        force = np.sum([legs.push(y, foot) for foot in feet], axis=0) / legs.mass
        return [y[2], y[3], force[0], force[1] - legs.gravity]

    events = [goal, *failures.values()]
    watched = []
    for event, direction in events:

        def watch(t: float, y: FloatArray, event: Event = event) -> float:
            return event(t, y)

        watch.terminal, watch.direction = True, direction  # type: ignore[attr-defined]
        watched.append(watch)
    horizon = 20.0 * float(np.sqrt(legs.leg_length / legs.gravity))
    solved = solve_ivp(
        rates, (begin, begin + horizon), state, method="DOP853", rtol=1e-12, atol=1e-13, events=watched,
        dense_output=True,
    )  # fmt: skip
    if solved.t_events[0].size:
        return solved
    for name, times in zip(failures, solved.t_events[1:], strict=True):
        if times.size:
            raise ValueError(
                f"the walker {name} at t = {times[0]:.4g} s: change the energy, the stiffness or the attack angle"
            )
    raise ValueError(f"the walker stands still from t = {begin:.4g} s on: give more energy")
