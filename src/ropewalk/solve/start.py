"""How a run begins: unstrained lengths, the places of the loads, and the state of rest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.assembly import strands_of, supports_of
from ropewalk.mechanics.chain import (
    HORIZONTAL,
    MATERIAL,
    SHARED,
    SHARING,
    WORKS,
    Array,
    ChainState,
    Integers,
    Loads,
    Strands,
    Supports,
)
from ropewalk.mechanics.contact_points import ContactPoint
from ropewalk.mechanics.law import RIGID, strain
from ropewalk.mechanics.loading import Loading, loading_of
from ropewalk.mechanics.moving_contact import CAPACITY, force_at, link_of, part_of, speed_at
from ropewalk.mechanics.multibody_system import MultibodySystem
from ropewalk.model.axles import Axles
from ropewalk.model.capabilities import refusal
from ropewalk.model.line import Line
from ropewalk.model.scenario import Scenario
from ropewalk.model.support import Moving
from ropewalk.model.train import TrainSection
from ropewalk.model.trolley import Payload, Trolley
from ropewalk.solve.capabilities import margin_without_mass
from ropewalk.solve.end_conditions import EndConditions, ends_at
from ropewalk.solve.ends import location_ends
from ropewalk.solve.equilibrium import at_rest
from ropewalk.solve.hold_forces import StrandContacts
from ropewalk.solve.loaded_equilibrium import NOTHING, LoadedStrand, contacts_on, stand
from ropewalk.solve.sensitivity import present

# Parts of a length by which shorter ones are tried, at first; and of the distance of the ends, below which none is.
_SHORTER, _SHORTEST = 1e-3, 1e-3


@dataclass(frozen=True)
class PreparedRun:
    """A scenario made ready for a run."""

    axes: tuple[str, ...]
    lines: tuple[str, ...]
    strands: Strands
    loads: Loads
    supports: Supports
    ends: tuple[EndConditions, ...]  # what holds each strand at the beginning
    bare: tuple[LoadedStrand | None, ...]  # each strand at rest without loads; None: not determined without them
    xi: Array  # (load,) m, where the loads begin; negative: before the start of the line
    wheels: tuple[ContactPoint, ...]
    multibody_system: MultibodySystem | None  # what has a mass; None if nothing has
    payloads: Mapping[str, Payload]  # of trolleys

    @cached_property
    def loading(self) -> Loading:
        """What its loads are."""
        return Loading(self.axes, self.strands.gravity, self.wheels, self.loads, self.multibody_system)

    @cached_property
    def on(self) -> tuple[Integers, ...]:
        """The loads on each strand."""
        return tuple(np.flatnonzero(self.loads.strand == s) for s in range(self.strands.first.size))

    @cached_property
    def contacts(self) -> tuple[StrandContacts, ...]:
        """How the loads on each strand are held."""
        return tuple(contacts_on(self.loads, on) for on in self.on)

    @cached_property
    def is_restrained_still(self) -> bool:
        """Whether no support moves as prescribed."""
        return bool((self.supports.motion_count == 1).all())

    def restrained(self, s: int, t: float) -> EndConditions:
        """What holds strand s at time t in s."""
        if self.is_restrained_still:
            return self.ends[s]
        return ends_at(self.supports, s, t, self.strands.gravity)


def setting_of(scenario: Scenario, until: float) -> PreparedRun:
    """Make a scenario ready: lengths found where tensions are given, strands at rest, loads placed.

    Args:
        scenario: what is there.
        until: how long the histories of the loads are needed, s.

    Raises:
        EquilibriumError: a line has no rest shape, or a load would begin beyond the end of its line.
        ScenarioError: a line ends before its support for a contact without mass.
    """
    lengths = {
        name: line.length if line.length is not None else _length_for_tension(scenario, name, line)
        for name, line in scenario.lines.items()
    }
    strands = strands_of(scenario, lengths)
    loading = loading_of(scenario, until, strands)
    axes, wheels, loads = loading.axes, loading.wheels, loading.loads
    if loading.multibody_system is not None:
        for wheel, mass in zip(wheels, loading.multibody_system.bodies.wheels["mass"][:, len(axes) - 1], strict=True):
            if wheel.margin is not None and not mass:
                raise refusal(margin_without_mass(wheel.load, wheel.margin))
    payloads = {name: load.payload for name, load in scenario.loads.items() if isinstance(load, Trolley)}
    supports = supports_of(scenario, until)
    ends = tuple(ends_at(supports, s, 0.0, strands.gravity) for s in range(len(scenario.lines)))
    nothing, none = np.zeros(0), np.zeros((len(axes), 0))
    bare: list[LoadedStrand | None] = []
    for s, name in enumerate(scenario.lines):
        try:
            bare.append(stand(strands, s, ends[s], nothing, none, NOTHING))
        except EquilibriumError as error:
            if not any(load.on == name for load in scenario.loads.values()):
                raise EquilibriumError(f"line {name}: {error}") from None
            bare.append(None)  # slack and without weight: loads may still give it a shape
    xi = [_place(scenario, strands, bare, loads, k, wheel) for k, wheel in enumerate(wheels)]
    return PreparedRun(
        axes, tuple(scenario.lines), strands, loads, supports, ends, tuple(bare), np.array(xi, dtype=float),
        wheels, loading.multibody_system, payloads,
    )  # fmt: skip


def _length_for_tension(scenario: Scenario, name: str, line: Line) -> float:
    """Unstrained length for which the mean tension at rest is the given one."""
    assert line.tension is not None
    wanted = line.tension

    def mean_tension(length: float) -> float:
        strands = strands_of(lone, {name: length})
        rest = stand(strands, 0, restrained, np.zeros(0), np.zeros((strands.gravity.size, 0)), NOTHING)
        return float(rest.tension.mean())

    lone = scenario.model_copy(update={"lines": {name: line}, "loads": {}})
    unit = strands_of(lone, {name: 1.0})
    law, restrained = unit.law[0], ends_at(supports_of(lone, 0.0), 0, 0.0, unit.gravity)
    distance = line.distance
    if isinstance(line.start_support, Moving) or isinstance(line.end_support, Moving):  # as displaced at time zero
        distance = float(np.linalg.norm(restrained.place[1] - restrained.place[0]))
    stretched = distance / (1.0 + float(strain(law, line.tension)))
    if not np.isfinite(stretched):
        raise EquilibriumError(f"line {name}: the axial law never reaches the tension of {line.tension:g} N")
    if scenario.gravity == 0.0 and restrained.is_fast:
        return stretched

    def miss(x: float) -> float:
        return mean_tension(x) - wanted

    def search() -> float:
        """Weight adds sag, so that the length lies above that of the straight line; supports that yield bring it below.
        More length is less tension."""
        low = high = stretched * (1.0 + 1e-9) if law[0] == RIGID else stretched
        shorter = _SHORTER
        while not restrained.is_fast and miss(low) < 0.0:
            low, shorter = low * (1.0 - shorter), min(2.0 * shorter, 0.5)
            if low < _SHORTEST * line.distance:
                raise EquilibriumError(f"line {name}: its supports yield to less than {wanted:g} N; give length")
        while miss(high) > 0.0:
            high *= 1.1
            if high > 1e3 * line.distance:
                what = f"a mean tension of {wanted:g} N is too little for its weight"
                raise EquilibriumError(f"line {name}: {what}; give more, or length")
        if low == high:
            return low
        from scipy.optimize import brentq  # lazy: where lengths are given it would be a quarter of the start

        return float(brentq(miss, low, high, xtol=1e-15 * high, rtol=1e-15))

    rests = present()
    return search() if rests is None else rests.root(search, miss)


def _place(
    scenario: Scenario, strands: Strands, bare: list[LoadedStrand | None], loads: Loads, k: int, wheel: ContactPoint
) -> float:
    """Material coordinate at which load k begins; the distance of the ends stands for the far one.

    Raises:
        EquilibriumError: it would begin beyond the end of its line.
    """
    s, start, line = int(loads.strand[k]), wheel.start, scenario.lines[wheel.on]
    length = float(strands.links[s] * strands.h[s])
    rest, measure = bare[s], loads.measure[k]
    if measure == MATERIAL or start <= 0.0:
        if start > length * (1.0 + 1e-9) and not (line.length is None and np.isclose(start, line.distance, 1e-9)):
            _check_comes(wheel, length, scenario)
            return start if line.length is not None else length + (start - line.distance)
        return min(start, length)
    if rest is None:
        raise EquilibriumError(
            f"load {wheel.name}: without loads the equilibrium of its line is not determined, and travel.from cannot "
            "be "
            "measured on it; give gravity, or measured: material"
        )
    if measure == HORIZONTAL:
        along = np.abs(rest.r[0] - rest.r[0, 0])
    else:
        along = np.concatenate(([0.0], np.cumsum(np.sqrt((np.diff(rest.r, axis=1) ** 2).sum(axis=0)))))
    if start > along[-1] * (1.0 + 1e-9):
        _check_comes(wheel, float(along[-1]), scenario)
        return length * start / float(along[-1])
    if measure == HORIZONTAL and np.any(np.diff(along) <= 0.0):
        i = int(np.argmax(along >= start))
        low = max(i - 1, 0)
        part = (start - along[low]) / (along[i] - along[low]) if along[i] > along[low] else 0.0
        return float(rest.X[low] + part * (rest.X[i] - rest.X[low]))
    return float(min(np.interp(start, along, rest.X), length))


def _check_comes(wheel: ContactPoint, end: float, scenario: Scenario) -> None:
    """Refuse a wheel that begins beyond the end of its line (m, as measured), unless it is of a train.

    Raises:
        EquilibriumError: another load does.
    """
    load = scenario.loads[wheel.load]
    if not isinstance(load, Axles | TrainSection):
        key = "travel.from" if hasattr(load, "travel") else "from"
        raise EquilibriumError(
            f"load {wheel.name} would begin {wheel.start:g} m along its line, which ends at {end:g} m; change {key}"
        )


def onward(setting: PreparedRun, r: Array, s: int) -> Array:
    """Level direction (axis,) from the start of strand s to its end, a unit vector; zero if it only rises.

    Args:
        r: (axis, node) m.
    """
    first = int(setting.strands.first[s])
    way: Array = r[:, first + int(setting.strands.links[s])] - r[:, first]
    way[-1] = 0.0
    return way / (float(np.linalg.norm(way)) or 1.0)


def start_state(setting: PreparedRun, with_loads: bool, resting: Array | None = None) -> ChainState:
    """The state of rest under gravity (and the loads at their start, if wanted), every load in the location of a force.

    Args:
        setting: the model.
        with_loads: let the loads rest on the line.
        resting: (axis, wheel) N, what bodies at rest press on the line with.
    """
    strands, loads = setting.strands, setting.loads
    dim, nodes = len(setting.axes), int((strands.links + 1).sum())
    count = setting.xi.size
    X = np.concatenate([np.arange(n + 1) * h for n, h in zip(strands.links, strands.h, strict=True)])
    state = ChainState(
        t=np.zeros(1), r=np.zeros((dim, nodes)), w=np.zeros((dim, nodes)), X=X, xi=setting.xi.copy(),
        speed=np.zeros(count), moving_load=np.full(count, SHARED), hold=np.zeros(count), work=np.zeros(WORKS),
    )  # fmt: skip
    _take_first_locations(strands, loads, state)
    for s in range(strands.first.size):
        i, j = int(strands.first[s]), int(strands.first[s] + strands.links[s])
        f = np.zeros((dim, j - i + 1))
        # Every node bears half of its two links; beside a riding node these are not uniform.
        half = strands.rho[s] * strands.gravity[:, None] * 0.5 * np.diff(X[i : j + 1])
        f[:, :-1] += half
        f[:, 1:] += half
        for k in range(count):
            if with_loads and loads.strand[k] == s and state.xi[k] >= 0.0:
                F = np.array([force_at(loads, k, 0.0, a) for a in range(dim)])
                if resting is not None:
                    F += resting[:, k]
                if state.moving_load[k] >= 0:
                    f[:, state.moving_load[k] - i] += F
                else:
                    link = link_of(strands, loads, state, k)
                    part = part_of(state, k, link)
                    f[:, link - i] += (1.0 - part) * F
                    f[:, link - i + 1] += part * F
        bare = setting.bare[s]
        guess = bare.first_force if bare is not None else None
        rest = at_rest(strands.law[s], np.diff(X[i : j + 1]), f, setting.ends[s], guess)
        state.r[:, i : j + 1] = rest.position
    location_ends(strands, setting.supports, state)
    return state


def _take_first_locations(strands: Strands, loads: Loads, state: ChainState) -> None:
    """Let each load ride with its nearest node where that one is free and inside the line."""
    for k in range(state.xi.size):
        s, xi = int(loads.strand[k]), float(state.xi[k])
        if xi < 0.0:
            continue
        first, n, h = int(strands.first[s]), int(strands.links[s]), float(strands.h[s])
        ahead = speed_at(loads, k, 0.0) >= 0.0
        nearest = int(np.floor(xi / h + 0.5)) if ahead else int(np.ceil(xi / h - 0.5))
        j = first + nearest
        if not 0 < nearest < n or j in state.moving_load or loads.contact[k] == SHARING:
            continue
        if state.X[j + 1] - xi >= CAPACITY * h and xi - state.X[j - 1] >= CAPACITY * h:
            state.moving_load[k] = j
            state.X[j] = xi
