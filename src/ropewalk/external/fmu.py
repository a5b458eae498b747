"""An FMU as a vehicle on a line: it is told how the line moves under its contacts, and answers with its forces."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ropewalk.checkpoint import Tree
from ropewalk.errors import RopewalkError
from ropewalk.external.confinement import lacking
from ropewalk.external.description import answered, mentioned, wiring_of
from ropewalk.external.isolation import Isolated
from ropewalk.external.leaving import watched
from ropewalk.external.protocol import SeenLine, Touch
from ropewalk.external.slave import Slave, Worker
from ropewalk.mechanics.assembly import speed_table
from ropewalk.mechanics.travelled import Travelled
from ropewalk.model.fmu import Fmu, FmuContact

# Part of a line, on both sides of a contact, over which its slope is taken at the beginning: about half a link.
_SLOPE = 0.005


class _Past(NamedTuple):
    """Stored state of a contact, the newest first."""

    heights: tuple[float, ...] = ()  # m, that it has been at
    places: tuple[float, ...] = ()  # m, xi that it has been at
    answers: tuple[float, ...] = ()  # m, heights that the FMU has given


class FmuState:
    """What an FMU and its place were at a time; the FMU forgets its part when nobody holds this any more."""

    def __init__(self, number: int, t: float, pasts: list[_Past], worker: Worker) -> None:
        self.number, self.t, self.pasts = number, t, pasts
        weakref.finalize(self, worker.forget, number).atexit = False


@dataclass(frozen=True)
class _FmuContact:
    """A contact with the numbers of its variables among the inputs and outputs."""

    declared: FmuContact
    start: float  # m, as the travel is measured
    stated: dict[str, int]
    answered: dict[str, int]


class FmuModel:
    """An FMU with the step protocol.

    Its contacts travel as declared. At every exchange it is told the height and the velocity of the line under them,
    and does a step; or the force on them, and answers with its own motion. The velocity is that of the contact, which
    moves along: the backward difference of its heights,

        v_n = (3 q_n - 4 q_{n-1} + q_{n-2}) / (2 h)        (q_1 - q_0) / h in the first step,

    of second order. At the beginning it is what the line's velocity there and its slope make of it.

    Args:
        name: of the load.
        load: as declared.
        until: end of the run, s.
        dim: number of axes.

    Raises:
        RopewalkError: FMPy is not installed.
        ScenarioError: the file is no FMU that can be used, or the load does not fit it.
    """

    def __init__(self, name: str, load: Fmu, until: float, dim: int) -> None:
        self._wiring = wiring_of(name, load)
        self._load, self._until, self._dim = load, until, dim
        self._travelled = Travelled(*speed_table(load.travel.speed, until))
        self._contacts: list[_FmuContact] = []
        inputs = outputs = 0
        for place, contact in zip(load.starts(), load.contacts.values(), strict=True):
            keys, others = mentioned(contact), answered(contact)
            numbers = {key: inputs + i for i, key in enumerate(keys)}
            self._contacts.append(
                _FmuContact(contact, place.start, numbers, {key: outputs + i for i, key in enumerate(others)})
            )
            inputs, outputs = inputs + len(keys), outputs + len(others)
        self._inputs, self._outputs = [0.0] * inputs, [0.0] * outputs
        self._worker: Worker | None = None
        self._watched = ExitStack()
        self._t = 0.0
        self._pasts: list[_Past] = []
        self._grounds: list[float] = []
        self._ends, self._way = (0.0, 0.0), 1.0  # m, places of the ends along x, and which way it goes
        if self._wiring.can_go_back:
            self.get_state: Callable[[], FmuState] | None = self._save
            self.set_state: Callable[[FmuState], None] | None = self._restore

    @property
    def diagnostics(self) -> list[str]:
        """What is to be known of it before it begins."""
        found = []
        if self._load.isolated and (walls := lacking()):
            remedy = "use --no-code to refuse FMUs of untrusted authors"
            found.append(
                f"{self._wiring.who} is isolated, but this system cannot confine it: it lacks {' and '.join(walls)}; "
                f"the FMU may do all that you may; {remedy}"
            )
        if self._wiring.unheard:
            names = ", ".join(self._wiring.unheard)
            remedy = "name them in its contacts (height, velocity, place, force), or say so by start_values"
            found.append(f"{self._wiring.who} has inputs that nothing sets, {names}: they stay as they begin; {remedy}")
        return found

    @property
    def contacts(self) -> int:
        """How many contacts it has."""
        return len(self._contacts)

    def reset(self, line: SeenLine) -> None:
        """Put the FMU to work, and its contacts on the line as it lies.

        Raises:
            RopewalkError: it cannot be loaded or initialised.
        """
        self.close()
        first, last = self._ends = float(line.at(0.0)[0][0]), float(line.at(line.length)[0][0])
        self._way = 1.0 if last >= first else -1.0
        self._t, self._pasts, self._grounds = 0.0, [_Past()] * self.contacts, []
        for contact in self._contacts:
            xi = min(max(self._place(contact, 0.0, line)[0], 0.0), line.length)
            is_zero = contact.declared.height_from == "zero"
            self._grounds.append(0.0 if is_zero else float(line.at(xi)[0][-1]))
        self._tell([self._look(k, 0.0, self._load.every, line) for k in range(self.contacts)], line)
        self._pasts = [_Past()] * self.contacts
        if self._load.isolated:
            self._worker = Isolated(self._wiring, self._load.patience)
        else:
            self._watched.enter_context(watched(self._wiring.who))
            self._worker = Slave(self._wiring)
        self._outputs = self._worker.begin(self._inputs, self._until)

    def step(self, t: float, h: float, line: SeenLine) -> list[Touch]:
        """Go on to time t in s, which is h after the last, with the line as it is then; answer with all contacts.

        Raises:
            RopewalkError: the FMU refuses the step or fails in it, or gives what is no number.
        """
        seen = [self._look(k, t, h, line) for k in range(self.contacts)]
        if t > 0.0:
            self._tell(seen, line)
            self._outputs = self._at_work.advance(self._t, h, self._inputs)
            self._t = t
        return [self._touch(k, *seen[k], h) for k in range(self.contacts)]

    def close(self) -> None:
        """Let the FMU go."""
        worker, self._worker = self._worker, None
        if worker is not None:
            worker.close()
        self._watched.close()

    @property
    def _at_work(self) -> Worker:
        if self._worker is None:
            raise RopewalkError(f"{self._wiring.who} has not been reset, or has been released")
        return self._worker

    def _save(self) -> FmuState:
        return FmuState(self._at_work.save(), self._t, list(self._pasts), self._at_work)

    def _restore(self, state: FmuState) -> None:
        self._at_work.restore(state.number)
        self._t, self._pasts = state.t, list(state.pasts)

    def pack_state(self, state: FmuState) -> Tree:
        """A state as data.

        Raises:
            RopewalkError: the FMU does not give it so.
        """
        if not self._wiring.can_pack:
            raise RopewalkError(f"{self._wiring.who} does not give its state as data (canSerializeFMUstate)")
        data, before = self._at_work.pack(state.number)
        return {"fmu": data, "before": before, "t": state.t, "pasts": [tuple(past) for past in state.pasts],
                "outputs": list(self._outputs)}  # fmt: skip

    def unpack_state(self, data: Tree) -> FmuState:
        """The state that was packed as data."""
        self._outputs = list(data["outputs"])
        number = self._at_work.unpack((data["fmu"], data["before"]))
        return FmuState(number, data["t"], [_Past(*past) for past in data["pasts"]], self._at_work)

    # -- The line under the contacts -----------------------------------------------------------------------------

    def _place(self, contact: _FmuContact, t: float, line: SeenLine) -> tuple[float, float]:
        """Where a contact is at time t, xi in m, beyond the ends of the line as far as it is from there; its speed."""
        now = np.array([t])
        along, speed = float(self._travelled.at(now, contact.start)[0]), float(self._travelled.speed(now)[0])
        if self._load.travel.measured == "material":
            return along, speed
        if along < 0.0:
            return along, speed
        first, last = self._ends
        x, span = first + self._way * along, abs(last - first)
        return (line.below(x) if along <= span else line.length + along - span), speed

    def _look(self, k: int, t: float, h: float, line: SeenLine) -> tuple[float, float, float, float]:
        """Where a contact is and how fast along the line, and the height and velocity of the line there."""
        contact, past, length = self._contacts[k], self._pasts[k], line.length
        xi, speed = self._place(contact, t, line)
        if self._load.travel.measured == "horizontal":
            ahead = self._place(contact, t + h, line)[0] if not past.places else xi
            speed = _rate(xi, past.places, h) if past.places else (ahead - xi) / h
        here = min(max(xi, 0.0), length)
        if here != xi and self._load.travel.at_end != "stay":  # off the line, as high as it was at its end
            height = past.heights[0] if past.heights else float(line.at(here)[0][-1])
            velocity = 0.0
        else:
            place, moving = line.at(here)
            height = float(place[-1])
            if past.heights:
                velocity = _rate(height, past.heights, h)
            else:
                velocity = float(moving[-1]) + _slope(line, here, max(abs(speed) * h, _SLOPE * length)) * speed
        self._pasts[k] = _Past((height, *past.heights[:1]), (xi, *past.places[:1]), past.answers)
        return xi, speed, height, velocity

    def _tell(self, seen: list[tuple[float, float, float, float]], line: SeenLine) -> None:
        for k, contact in enumerate(self._contacts):
            xi, _, height, velocity = seen[k]
            factor, inputs = contact.declared.motion_factor, self._inputs
            for key, number in contact.stated.items():
                if key == "height":
                    inputs[number] = (height - self._grounds[k]) / factor
                elif key == "velocity":
                    inputs[number] = velocity / factor
                elif key == "place":
                    inputs[number] = xi
                else:
                    inputs[number] = float(line.force(k)[-1]) / contact.declared.force_factor

    def _touch(self, k: int, xi: float, speed: float, _height: float, _velocity: float, h: float) -> Touch:
        contact, outputs = self._contacts[k], self._outputs
        number, force = contact.answered, [0.0] * self._dim
        if contact.declared.gives == "force":
            force[-1] = contact.declared.force_factor * outputs[number["force"]]
            if "force_along" in number:
                force[0] = outputs[number["force_along"]]
            return Touch(xi, force, speed)
        factor, past = contact.declared.motion_factor, self._pasts[k]
        height = self._grounds[k] + factor * outputs[number["height"]]
        if "velocity" in number:
            rise = factor * outputs[number["velocity"]]
        else:
            rise = _rate(height, past.answers, h) if past.answers else 0.0
            self._pasts[k] = past._replace(answers=(height, *past.answers[:1]))
        return Touch(xi, force, speed, (height, rise))


def _slope(line: SeenLine, xi: float, reach: float) -> float:
    """Slope of a line from as far behind a place as ahead of it: where it has a corner, the mean of both sides."""
    behind, ahead = max(xi - reach, 0.0), min(xi + reach, line.length)
    if ahead <= behind:
        return 0.0
    return float(line.at(ahead)[0][-1] - line.at(behind)[0][-1]) / (ahead - behind)


def _rate(now: float, before: tuple[float, ...], h: float) -> float:
    """Backward difference of values h apart, the newest of those before first."""
    if len(before) == 1:
        return (now - before[0]) / h
    return (3.0 * now - 4.0 * before[0] + before[1]) / (2.0 * h)
