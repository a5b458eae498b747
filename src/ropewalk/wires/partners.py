"""Partners: external models on wires, which are asked between the rows of a run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ropewalk.checkpoint import Tree, copied
from ropewalk.errors import RopewalkError
from ropewalk.external.cosimulation_master import Bearer, ContactPush, CosimulationMaster, Pushes
from ropewalk.wires.contact_location import location_at, location_below
from ropewalk.wires.large import LargeMotion
from ropewalk.wires.mesh import Mesh
from ropewalk.wires.plan import Array, Contact, TravellingLoad
from ropewalk.wires.small import SmallMotion
from ropewalk.wires.spline import WIDTH
from ropewalk.wires.step_inputs import ABSENT, ON_WIRE, StepInputs

# A damper needs a spring beside it: one that nobody feels, N/m.
_NEXT_TO_NOTHING = 1e-6
SLIDES = 0.5  # part of a link: a contact said to be further from where it has slid to has been put elsewhere
Motion = LargeMotion | SmallMotion


@dataclass(frozen=True)
class WireExternalModel:
    """An external load of a task."""

    prescribed_motion: int
    cosimulation: Callable[[int, float], CosimulationMaster]  # from the number of axes and the reach of a contact in m


def moving_load_of(name: str, wire: int, contacts: int, stiffness: float, damping: float) -> TravellingLoad:
    """What an external load is to the wires: contacts without coordinates, whose springs end where they are told to."""
    none = np.zeros((0, 0))
    spring = max(stiffness, _NEXT_TO_NOTHING) if damping else stiffness
    contact = Contact(wire, material=True, stiffness=spring, damping=damping)
    return TravellingLoad(name, none, none, none, (contact,) * contacts)


@dataclass(frozen=True)
class NodeSnapshot:
    """Positions and velocities of all nodes as they were at an instant, (3, node) m and m/s."""

    r: Array
    v: Array

    def __call__(self, part: slice) -> tuple[Array, Array]:
        """Those of some nodes."""
        return self.r[:, part], self.v[:, part]


@dataclass
class WireLine:
    """A wire as an external model sees it; unstrained lengths are stations along it."""

    mesh: Mesh
    wire: int
    axes: list[int]
    piece: Callable[[slice], tuple[Array, Array]]  # positions and velocities of some nodes, (3, node) m and m/s
    length: float  # m
    soft: list[tuple[float, float]] = field(default_factory=list)  # of own contacts: station, force upwards

    def at(self, xi: float) -> tuple[Array, Array]:
        """Position in m and velocity in m/s of the wire at a station, (axis,)."""
        h = self.mesh.strands.h[self.wire]
        location = location_at(self.mesh, self.wire, xi / h)
        r, v = self.piece(slice(location.first, location.first + WIDTH))
        place, velocity = (r @ location.weight[0])[self.axes], (v @ location.weight[0])[self.axes]
        for station, force in self.soft:
            if abs(station - xi) < h:  # beside its spline the wire gives way to what stands on it
                place[-1] += location.local * force
        return place, velocity

    def below(self, x: float) -> float:
        """The station in m above or below a horizontal place x in m; beyond the ends it goes on evenly."""
        begin, along = self.mesh.strands.across[self.wire]
        even, length = (x - begin) / along, self.length
        if not 0.0 <= even <= length:
            return float(even)
        part = self.mesh.of(self.wire)
        place = np.zeros(self.mesh.nodes)
        place[part] = self.piece(part)[0][0]
        return location_below(self.mesh, self.wire, place, x).links * float(self.mesh.strands.h[self.wire])


@dataclass
class WirePartner(Bearer):
    """An external model on a wire while it moves.

    Args:
        cosimulation: with the model.
        columns: of the drive, of its contacts.
        wire: on which it is.
        mesh, motion: of the run.
        axes: that the run has.
        send: moves the wires on by the rows of a drive.
        sample: s, between two rows.
    """

    cosimulation: CosimulationMaster
    columns: range
    wire: int
    mesh: Mesh
    motion: Motion
    axes: list[int]
    send: Callable[[StepInputs], Any]
    sample: float
    pushes: Pushes = field(default_factory=list)
    inputs: Callable[[], StepInputs] | None = None
    _jumped: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._length = self.mesh.plan.wires[self.wire].length
        self.cosimulation.begin(self.line)

    @property
    def rows(self) -> int:
        """Rows of the run in an interval of the exchange."""
        return round(self.cosimulation.every / self.sample)

    def rows_left(self, row: int) -> int:
        """How many rows are left of the interval, at a row counted from the beginning of the run."""
        return self.rows - row % self.rows

    @property
    def line(self) -> WireLine:
        """The wire as it is now."""
        return self._seen(self.motion.piece)

    def frozen(self) -> WireLine:
        """The same, to be looked at later."""
        return self._seen(NodeSnapshot(self.motion.position, self.motion.velocity))

    def get_state(self) -> Tree:
        """What is remembered of the exchange, and what the contacts are doing."""
        pushes = [None if push is None else copied(push._asdict()) for push in self.pushes]

        def stored(line: WireLine) -> Tree:
            assert isinstance(line.piece, NodeSnapshot)
            return {"soft": list(line.soft), "r": line.piece.r.copy(), "v": line.piece.v.copy()}

        return {"turns": self.cosimulation.get_state(stored), "pushes": pushes, "jumped": list(self._jumped)}

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""

        def line(stored: Tree) -> WireLine:
            seen = self._seen(NodeSnapshot(stored["r"].copy(), stored["v"].copy()))
            return replace(seen, soft=list(stored["soft"]))

        self.cosimulation.set_state(tree["turns"], line)
        self.pushes = [None if push is None else ContactPush(**copied(push)) for push in tree["pushes"]]
        self._jumped = list(tree["jumped"])

    def ahead(self, pushes: Pushes, h: float) -> WireLine:
        """The wire as it would be after an interval with these forces; it stays where it is."""
        assert self.inputs is not None
        saved, inputs = self.motion.get_state(), self.inputs()
        before, self.pushes = self.pushes, pushes
        self.fill(inputs, 0, self._jumps(before, pushes))
        self.send(inputs)
        seen = self.frozen()
        self.pushes = before
        self.motion.set_state(saved)
        return seen

    def exchange(self, t: float, inputs: Callable[[], StepInputs]) -> None:
        """Ask the model at time t; the drive has the rows of the interval that begins, for looking ahead."""
        self.inputs = inputs
        pushes = self.cosimulation.ask(t, self)
        for push in pushes:
            if push is not None and (push.first[:-1].any() or push.last[:-1].any()):
                raise RopewalkError(
                    f"load {self.cosimulation.name}: at t = {t:g} s its model gave a force of {push.first.tolist()} N; "
                    "contacts of lines with bending stiffness and of overhead lines press vertically only: give [0, Fz]"
                )
        before, self.pushes = self.pushes, pushes
        self._jumped = self._jumps(before, pushes)

    def fill(self, inputs: StepInputs, row: int, jumps: list[float] | None = None) -> None:
        """Write into the rows of a drive what the contacts do; `row` rows of the interval are over."""
        every, count = self.cosimulation.every, inputs.station.shape[0]
        late, length = self.sample * (row + np.arange(count)), self._length
        part = late / every
        gap = self.motion.stepping.gap
        for number, (k, push) in enumerate(zip(self.columns, self.pushes, strict=True)):
            inputs.where[:, k] = ABSENT if push is None else ON_WIRE
            inputs.rough[:, k], inputs.given[:, k] = 0.0, 0.0
            if push is None:
                gap[k] = np.nan
                continue
            station = push.xi + push.speed * late
            inputs.where[:, k] = np.where((station >= 0.0) & (station <= length), ON_WIRE, ABSENT)
            inputs.station[:, k] = np.clip(station, 0.0, length)
            inputs.given[:, k] = push.first[-1] + part * (push.last[-1] - push.first[-1])
            if self.cosimulation.exchange.stiffness or self.cosimulation.exchange.damping:
                inputs.rough[:, k] = -(push.height + push.rise * late)
                if row == 0:
                    gap[k] += (self._jumped if jumps is None else jumps)[number]

    def _jumps(self, before: Pushes, now: Pushes) -> list[float]:
        """By how much the far ends of the interface are put elsewhere, m; dampers are not to notice that."""
        every, jumps = self.cosimulation.every, []
        for number, push in enumerate(now):
            old = before[number] if number < len(before) else None
            jumps.append(np.nan if push is None or old is None else push.height - old.height - old.rise * every)
        return jumps

    def _seen(self, piece: Callable[[slice], tuple[Array, Array]]) -> WireLine:
        first = self.columns.start
        soft = [
            (push.xi + push.speed * self.cosimulation.every, self._pressing(first + number, push))
            for number, push in enumerate(self.pushes)
            if push is not None
        ]
        return WireLine(self.mesh, self.wire, self.axes, piece, self._length, soft)

    def _pressing(self, k: int, push: ContactPush) -> float:
        """Force upwards on the wire at the end of an interval, N."""
        if not (self.cosimulation.exchange.stiffness or self.cosimulation.exchange.damping):
            return float(push.last[-1])
        force = float(self.motion.stepping.here[k, 4])
        return force if np.isfinite(force) else 0.0
