"""Vehicles by themselves: linear systems on contact springs, moved from outside exactly over each step.

    M q'' + C q' + K q = p(t) - sum_k b_k (F_k - R_k),    F_k = R_k + k_k (e_k + b_k q - z_k) + c_k (b_k q' - z_k')

with heights q, the height z of the line at contact k and the force F upwards on it. Over a step, heights, velocities
and forces from outside are linear, so that the exponential of the system's matrix gives the motion without error. A
contact that may lift off is open while its force would pull; the instants at which it opens and closes are found.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, Literal, Self

import numpy as np
from scipy.linalg import expm

from ropewalk.errors import RopewalkError, did_you_mean
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.loading import loading_of
from ropewalk.model.line import Line, spatial
from ropewalk.model.load import GivenForces
from ropewalk.model.mass import MovingMass
from ropewalk.model.matrices import Matrices
from ropewalk.model.net import AnyNet
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.model.vehicle import Vehicle
from ropewalk.wires.lines import prescribed_motion_of, wire_of
from ropewalk.wires.prescribed_motion import PrescribedMotion
from ropewalk.wiring import task_of

Gives = Literal["force", "motion"]
_LOOKS = 20  # at contacts that may lift off, within a period of the fastest oscillation
_HALVINGS = 40
_MOST_CHANGES = 1000  # of contacts in a step
_TABLE = 2001  # instants at which what changes with a varying speed is kept


@dataclass(frozen=True)
class VehicleContact:
    """A contact of a vehicle."""

    name: str
    row: list[float]  # its height is base + row @ q
    behind: float  # m, behind the place of the vehicle
    stiffness: float  # N/m; infinite: none
    damping: float  # N s/m
    base: float  # m
    rest: float  # N upwards on the line where nothing is moved
    sign: float  # of forces on the line that push: 1 from below, -1 from above
    lifts: bool


@dataclass(frozen=True)
class Alone:
    """A vehicle without its line, as numbers that a file can hold."""

    kind: str
    mass: Array
    damping: Array
    stiffness: Array
    touches: tuple[VehicleContact, ...]
    spread: Array  # (coordinate, contact) how coordinates follow the heights of contacts at the beginning
    time: Array  # s, of the tables
    push: Array  # (time, coordinate) N
    place: Array  # (time,) m, along the line
    until: float = np.inf

    def written(self) -> str:
        """The same as JSON."""
        plain = {key: value.tolist() if isinstance(value, np.ndarray) else value for key, value in vars(self).items()}
        plain["touches"] = [vars(touch) for touch in self.touches]
        return json.dumps(plain, indent=1)

    @classmethod
    def read(cls, text: str) -> Self:
        """Read what `written` gave."""
        plain = json.loads(text)
        touches = tuple(VehicleContact(**touch) for touch in plain.pop("touches"))
        own: dict[str, Any] = {
            key: np.array(value, dtype=np.float64) if isinstance(value, list) else value for key, value in plain.items()
        }
        n = len(touches[0].row)
        for key in ("mass", "damping", "stiffness"):
            own[key] = own[key].reshape(n, n)
        return cls(touches=touches, **own)


def alone(scenario: Scenario, name: str, *, contact_stiffness: float | None = None) -> Alone:
    """A load of a scenario without its line.

    Args:
        scenario: of kind dynamic.
        name: of the load.
        contact_stiffness: N/m, of a spring below each contact that has none.

    Raises:
        RopewalkError: there is no such load, or it is none that can stand alone.
    """
    if name not in scenario.loads:
        raise RopewalkError(f"there is no load {name}; {did_you_mean(name, scenario.loads)}")
    load, run = scenario.loads[name], scenario.run
    if not isinstance(load, Pantograph | MovingMass | Oscillator | Vehicle | Matrices):
        why = "is only a force" if isinstance(load, GivenForces) else "is no linear system of masses and springs"
        raise RopewalkError(
            f"load {name} of kind {load.kind} {why}; kinds that can be exported are mass, oscillator, vehicle, "
            "matrices and "
            "pantograph"
        )
    if isinstance(load, Pantograph) and load.head is not None and load.head.roll is not None:
        raise RopewalkError(f"load {name}: a head that rolls has to know where the wire runs across it; leave roll out")
    if getattr(load, "irregularity", None) is not None:
        raise RopewalkError(f"load {name}: irregularity belongs to the line here; leave it out")
    if not hasattr(load.travel, "speed"):
        raise RopewalkError(f"load {name}: free travel depends on the line; prescribe travel.speed")
    until = run.until if isinstance(run, Dynamic) else 1.0
    lone = scenario.model_copy(update={"loads": {name: load}})
    if isinstance(load, Pantograph) or load.on in scenario.overhead_lines:
        apart = {key: line.model_copy(update={"overlap": None}) for key, line in lone.overhead_lines.items()}
        (prescribed_motion,) = task_of(lone.model_copy(update={"overhead_lines": apart})).prescribed_motions
    else:
        line = scenario.lines.get(load.on) or _level(scenario.nets[load.on], load)
        lone = lone.model_copy(update={"lines": {load.on: line}, "nets": {}, "hangers": {}, "tracks": {}})
        prescribed_motion, _ = prescribed_motion_of(loading_of(lone, until), name, load, 0, wire_of(load.on, line))
    if prescribed_motion.moving_load.size and not np.all(np.linalg.eigvalsh(prescribed_motion.moving_load.mass) > 0.0):
        raise RopewalkError(f"load {name}: a coordinate has no mass; give it one")
    touches = _touches(name, prescribed_motion, contact_stiffness)
    times, push = _tabled(prescribed_motion, until, load)
    return Alone(
        load.kind, prescribed_motion.moving_load.mass, prescribed_motion.moving_load.damping,
        prescribed_motion.moving_load.stiffness, touches,
        _spread(prescribed_motion, touches, load if isinstance(load, Pantograph) else None), times, push,
        prescribed_motion.place(times), until,
    )  # fmt: skip


def _level(net: AnyNet, load: MovingMass | Oscillator | Vehicle | Matrices) -> Line:
    """Level ground at the height of a net, as long as the way over it: all that a load without its net knows of it."""
    way = getattr(load.travel, "path", None) or ((0.0, 0.0), (1.0, 0.0))
    length = sum(math.dist(a, b) for a, b in pairwise(way)) or 1.0
    height = spatial(net.corner or (net.boundary or ((0.0, 0.0),))[0])[2]
    return Line(start=(0.0, height), end=(length, height), length=length, mass=1.0, axial_stiffness=1.0)


def _touches(
    name: str, prescribed_motion: PrescribedMotion, contact_stiffness: float | None
) -> tuple[VehicleContact, ...]:
    found = []
    for number, contact in enumerate(prescribed_motion.moving_load.contacts, start=1):
        stiffness = contact.stiffness
        if np.isinf(stiffness) and contact_stiffness is not None:
            stiffness = contact_stiffness
        row = [*contact.row, *[0.0] * (prescribed_motion.moving_load.size - len(contact.row))]
        found.append(
            VehicleContact(
                f"contact{number}", row, contact.behind, stiffness, contact.damping, contact.base, contact.rest,
                1.0 if contact.below else -1.0, contact.lifts_off,
            )
        )  # fmt: skip
    return tuple(found)


def _tabled(prescribed_motion: PrescribedMotion, until: float, load: Any) -> tuple[Array, Array]:
    """What is put on the coordinates, at instants between which it is as good as linear."""
    ramp = getattr(load, "ramp", 0.0)
    times = np.unique([0.0, min(ramp, until), until])
    if not isinstance(load.travel.speed, int | float):
        times = np.unique([*times, *np.linspace(0.0, until, _TABLE)])
    push = prescribed_motion.push(times)
    return times, np.broadcast_to(push, (times.size, prescribed_motion.moving_load.size)).copy()


def _spread(
    prescribed_motion: PrescribedMotion, touches: tuple[VehicleContact, ...], pantograph: Pantograph | None
) -> Array:
    """How coordinates follow the heights of contacts: with the least energy in the springs.

    Masses of a pantograph, whose base pulls them down, follow all as one, and its head pitches as its strips do.
    """
    n, k = prescribed_motion.moving_load.size, len(touches)
    rows = np.array([touch.row for touch in touches])
    if pantograph is not None:
        masses = len(pantograph.parts.masses)
        levers = rows[:, masses:]
        return np.vstack([np.full((masses, k), 1.0 / k), (levers / (levers**2).sum(axis=0)).T])
    K = prescribed_motion.moving_load.stiffness
    whole = np.block([[K, rows.T], [rows, np.zeros((k, k))]])
    given = np.vstack([np.zeros((n, k)), np.eye(k)])
    found: Array = np.linalg.lstsq(whole, given, rcond=None)[0]
    return found[:n]


@dataclass
class LoneVehicle:
    """A vehicle alone in motion.

    Args:
        vehicle: as exported.
        gives: force: heights of the line come in; motion: forces do.

    Raises:
        RopewalkError: it is to give forces, and a contact has no spring.
    """

    vehicle: Alone
    gives: Gives
    t: float = 0.0
    q: Array = field(default_factory=lambda: np.zeros(0))
    v: Array = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        vehicle = self.vehicle
        self._b = np.array([touch.row for touch in vehicle.touches])
        self._base = np.array([touch.base for touch in vehicle.touches])
        self._rest = np.array([touch.rest for touch in vehicle.touches])
        self._k = np.array([touch.stiffness for touch in vehicle.touches])
        self._c = np.array([touch.damping for touch in vehicle.touches])
        self._sign = np.array([touch.sign for touch in vehicle.touches])
        self._lifts = np.array([touch.lifts for touch in vehicle.touches])
        if self.gives == "force" and not np.isfinite(self._k).all():
            raise RopewalkError(
                "a contact without a spring cannot answer a motion with a force; give contact_stiffness, or let the "
                "vehicle give motion"
            )
        self._closed = (
            np.ones(self._k.size, dtype=bool) if self.gives == "force" else np.zeros(self._k.size, dtype=bool)
        )
        self._cache: dict[tuple[float, bytes], tuple[Array, Array, Array]] = {}
        self.q, self.v = np.zeros(vehicle.mass.shape[0]), np.zeros(vehicle.mass.shape[0])
        whole = vehicle.stiffness + (self._b.T * np.where(np.isfinite(self._k), self._k, 0.0)) @ self._b
        fastest = np.sqrt(max(np.linalg.eigvals(np.linalg.solve(vehicle.mass, whole)).real.max(initial=0.0), 1e-300))
        self._look = 2.0 * np.pi / fastest / _LOOKS

    def place(self, heights: Array, velocities: Array) -> None:
        """Let it rest within itself on contacts of given heights in m, and move with them as fast as given, in m/s.

        A pantograph begins at rest, as it does in a scenario.
        """
        self.q = self.vehicle.spread @ (heights - self._base)
        self.v = self.vehicle.spread @ velocities if self.vehicle.kind != "pantograph" else np.zeros_like(self.q)
        self._note_closed(heights, velocities)

    def push(self, t: float) -> Array:
        """What is put on its coordinates, N."""
        vehicle = self.vehicle
        return np.array([np.interp(t, vehicle.time, column) for column in vehicle.push.T])

    def forward(self, t: float) -> Array:
        """Places of its contacts along the line, (contact,) m."""
        place = float(np.interp(t, self.vehicle.time, self.vehicle.place))
        return place - np.array([touch.behind for touch in self.vehicle.touches])

    def forces(self, heights: Array, velocities: Array) -> Array:
        """Forces upwards on the line, N, which stands and moves as given."""
        raw = self._raw(self.q, self.v, heights, velocities)
        return np.where(self._lifts & (self._sign * raw < 0.0), 0.0, raw)

    def heights(self) -> tuple[Array, Array]:
        """Heights of its contacts in m, and their velocities in m/s."""
        return self._base + self._b @ self.q, self._b @ self.v

    def step(self, h: float, first: tuple[Array, Array], last: tuple[Array, Array]) -> None:
        """Go on by h seconds.

        Args:
            h: s.
            first, last: heights in m and velocities in m/s of the line at its contacts, at the beginning and at the
                end, linear in between; or forces on the line in N, twice, of a vehicle that gives motion.

        Raises:
            RopewalkError: contacts open and close without end.
        """
        done, changes = 0.0, 0
        begin = self.t
        watching = self.gives == "force" and bool(self._lifts.any())

        def given(part: float) -> tuple[Array, Array]:
            return tuple(a + part * (b - a) for a, b in zip(first, last, strict=True))  # type: ignore[return-value]

        while done < h:
            rest = h - done
            goes = min(rest, h / np.ceil(h / self._look)) if watching else rest
            goes = rest if rest - goes < 1e-9 * h else goes
            q, v = self._ahead(goes, given(done / h), given((done + goes) / h), begin + done)
            if watching:
                wrong = self._wrong(q, v, *given((done + goes) / h))
                if wrong.any():
                    goes = self._until_change(goes, done, h, given, begin)
                    q, v = self._ahead(goes, given(done / h), given((done + goes) / h), begin + done)
                    self.q, self.v = q, v
                    done += goes
                    self._note_closed(*given(done / h))
                    changes += 1
                    if changes > _MOST_CHANGES:
                        raise RopewalkError("contacts open and close without end; shorten the step, or add damping")
                    continue
            self.q, self.v, done = q, v, h if goes == rest else done + goes
        self.t = begin + h

    def _until_change(self, goes: float, done: float, h: float, given: Any, begin: float) -> float:
        """How long it takes until the first contact opens or closes, s; a little more."""
        low, high = 0.0, goes
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            q, v = self._ahead(middle, given(done / h), given((done + middle) / h), begin + done)
            if self._wrong(q, v, *given((done + middle) / h)).any():
                high = middle
            else:
                low = middle
        return high

    def _raw(self, q: Array, v: Array, heights: Array, velocities: Array) -> Array:
        return self._rest + self._k * (self._base + self._b @ q - heights) + self._c * (self._b @ v - velocities)

    def _wrong(self, q: Array, v: Array, heights: Array, velocities: Array) -> Array:
        """Contacts that are closed and would pull, or are open and would push."""
        pushes = self._sign * self._raw(q, v, heights, velocities) > 0.0
        found: Array = self._lifts & (pushes != self._closed)
        return found

    def _note_closed(self, heights: Array, velocities: Array) -> None:
        if self.gives == "force":
            pushes = self._sign * self._raw(self.q, self.v, heights, velocities) > 0.0
            self._closed = ~self._lifts | pushes

    def _ahead(self, h: float, first: tuple[Array, Array], last: tuple[Array, Array], t: float) -> tuple[Array, Array]:
        """Coordinates and velocities after h seconds, with contacts as they are."""
        n = self.q.size
        key = (h, self._closed.tobytes())
        found = self._cache.get(key)
        if found is None:
            found = self._propagator(h)
            if len(self._cache) > 64:
                self._cache.clear()
            self._cache[key] = found
        whole, begin, end = found
        f0 = self.push(t) + self._outer(*first)
        f1 = self.push(t + h) + self._outer(*last)
        x = whole @ np.concatenate([self.q, self.v]) + begin @ f0 + end @ f1
        return x[:n], x[n:]

    def _outer(self, one: Array, other: Array) -> Array:
        """Forces on the coordinates from outside."""
        if self.gives == "motion":
            return np.asarray(-self._b.T @ (one - self._rest))
        on = self._k * (self._base - one) - self._c * other
        return np.asarray(-self._b.T @ np.where(self._closed, on, -self._rest))

    def _propagator(self, h: float) -> tuple[Array, Array, Array]:
        """Matrices of a step: of the state, and of forces at its beginning and end, linear in between."""
        vehicle, n = self.vehicle, self.q.size
        on = self._closed
        K = vehicle.stiffness + (self._b.T[:, on] * self._k[on]) @ self._b[on]
        C = vehicle.damping + (self._b.T[:, on] * self._c[on]) @ self._b[on]
        inverse = np.linalg.inv(vehicle.mass)
        big = np.zeros((4 * n, 4 * n))
        big[:n, n : 2 * n] = np.eye(n)
        big[n : 2 * n, :n], big[n : 2 * n, n : 2 * n] = -inverse @ K, -inverse @ C
        big[n : 2 * n, 2 * n : 3 * n] = inverse
        big[2 * n : 3 * n, 3 * n :] = np.eye(n)
        found = expm(h * big)[: 2 * n]
        slope = found[:, 3 * n :] / h
        return found[:, : 2 * n], found[:, 2 * n : 3 * n] - slope, slope

    def get_state(self) -> Any:
        """All that changes, copied."""
        return self.t, self.q.copy(), self.v.copy(), self._closed.copy()

    def set_state(self, state: Any) -> None:
        """Go back to what `get_state` gave."""
        self.t, q, v, closed = state
        self.q, self.v, self._closed = q.copy(), v.copy(), closed.copy()


__all__ = ["Alone", "LoneVehicle", "VehicleContact", "alone"]
