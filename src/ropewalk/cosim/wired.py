"""Wires moved from outside: stiff lines and overhead lines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from ropewalk.checkpoint import Tree, copied
from ropewalk.cosim.outside import ContactInput, ContactOutput, Outside, Stepwise
from ropewalk.errors import RopewalkError
from ropewalk.model.load import ExternalModel
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.wires.frames import SAMPLE, Wires
from ropewalk.wires.layout import supports_of
from ropewalk.wires.mesh import places_of
from ropewalk.wires.plan import Array, Contact, Spot, TravellingLoad
from ropewalk.wires.prescribed_motion import PrescribedMotion, inputs_of
from ropewalk.wires.step_inputs import ABSENT, ON_WIRE, Record, StepInputs
from ropewalk.wiring import task_of

_WHOLE = 1e-6  # of an inner step, up to which a step is a whole number of them
_CONTACT_WIRE = ".contact"


class Wired(Stepwise):
    """Stiff lines and overhead lines moved from outside; see `Stepwise`.

    Inner steps are of one length: a step must be a whole number of them.

    Args:
        scenario: of kind dynamic.
        outside: its contacts from outside, by name.
        step: that it will be moved by, or a part of it, s; None: 1 ms.
    """

    def __init__(self, scenario: Scenario, outside: Mapping[str, Outside], step: float | None = None) -> None:
        super().__init__(scenario, outside)
        run = scenario.run
        assert isinstance(run, Dynamic)
        external = [name for name, load in scenario.loads.items() if isinstance(load, ExternalModel)]
        if external:
            raise RopewalkError(
                f"load {external[0]} is an external model, which is not supported on lines that are moved from "
                "outside; leave it out"
            )
        task = task_of(scenario)
        names = [wire.name for wire in task.plan.wires]
        self._wire = {name: names.index(_wire_of(name, scenario, names)) for name in _lines(scenario)}
        self._own = len(task.contacts)  # contacts of the scenario's own loads come first
        prescribed_motions = tuple(self._prescribed_motion(name, contact) for name, contact in self.outside.items())
        task = replace(
            task,
            prescribed_motions=(*task.prescribed_motions, *prescribed_motions),
            contacts=(*task.contacts, *self.outside),
        )
        whole = step if step is not None else SAMPLE
        self._run = Wires(task, np.array([0.0, whole]), RunInfo(), whole, run.step)
        self.inner = whole / self._run.steps
        self.motion = self._run.motion
        self._steps = 0
        self._record: Any = None

    def _prescribed_motion(self, name: str, contact: Outside) -> PrescribedMotion:
        none, k = np.zeros((0, 0)), contact.stiffness
        touch = Contact(
            self._wire[contact.on], material=True, stiffness=k, damping=contact.damping, below=contact.side == "below",
            lifts_off=contact.side is not None,
        )  # fmt: skip
        return PrescribedMotion(TravellingLoad(name, none, none, none, (touch,)), np.zeros_like)

    @property
    def t(self) -> float:  # type: ignore[override]
        """The time it has come to, s."""
        return self._steps * self.inner

    @property
    def dim(self) -> int:
        """Number of axes."""
        return len(self._run.axes)

    def step(self, h: float) -> None:
        """Go on by h seconds.

        Raises:
            RopewalkError: that is no whole number of inner steps, or the motion does not get there.
        """
        count = round(h / self.inner)
        if count < 1 or abs(h / self.inner - count) > _WHOLE * count:
            raise RopewalkError(
                f"a step of {h:g} s was requested, but wires advance by whole inner steps of {self.inner:.6g} s; "
                "say beforehand by which step it will be moved"
            )
        record = self.motion.go(self._inputs(count * self.inner), count)
        self._steps += count
        if not self._run.is_sane():
            raise RopewalkError(f"the motion grew beyond all bounds at t = {self.t:.6g} s; write a smaller step")
        self._record = record
        self._go_on(h)

    def _inputs(self, h: float) -> StepInputs:
        """What the loads do during a step, and all contacts from outside."""
        task = self._run.task
        inputs = inputs_of(task.plan, task.prescribed_motions, self.t + np.array([0.0, h]))
        for j, (name, contact_input) in enumerate(self.contact_inputs.items()):
            k, length = self._own + j, self.length(self.outside[name].on)
            on = 0.0 <= contact_input.xi <= length
            inputs.where[:, k] = ON_WIRE if on else ABSENT
            if not on:
                continue
            inputs.station[:, k] = contact_input.xi, min(max(contact_input.xi + contact_input.speed * h, 0.0), length)
            if self.outside[name].is_sprung:  # the spring feels by how much the wire is above the body
                inputs.rough[:, k] = -contact_input.height, -contact_input.height - contact_input.rise * h
            else:
                inputs.given[:, k] = contact_input.first[-1], contact_input.last[-1]
        return inputs

    def _vector(self, name: str, force: float | tuple[float, ...]) -> tuple[float, ...]:
        vector = super()._vector(name, force)
        if any(vector[:-1]):
            raise RopewalkError(f"contact {name}: only vertical forces are supported on this line, given {vector} N")
        return vector

    def length(self, line: str) -> float:
        """What stations of a line count up to, m."""
        return self._run.task.plan.wires[self._wire[line]].length

    def at(self, line: str, xi: float) -> tuple[Array, Array]:
        """Position in m and velocity in m/s of a line, (axis,)."""
        place, velocity, _ = self._look(line, xi)
        return place, velocity

    def _look(self, line: str, xi: float) -> tuple[Array, Array, Array]:
        """Position, velocity, and change of position per station."""
        mesh, a = self._run.mesh, self._wire[line]
        h, axes = float(mesh.strands.h[a]), self._run.axes
        inside = min(max(xi, 0.0), self.length(line))
        ahead, behind = min(inside + 0.5 * h, self.length(line)), max(inside - 0.5 * h, 0.0)
        at = places_of(mesh.strands, [Spot(a, inside), Spot(a, behind), Spot(a, ahead)])
        width = np.arange(at.weight.shape[1])
        r, v = self.motion.position[axes], self.motion.velocity[axes]
        spots = [r[:, base + width] @ weight for base, weight in zip(at.base, at.weight, strict=True)]
        velocity = v[:, int(at.base[0]) + width] @ at.weight[0]
        return spots[0], velocity, (spots[2] - spots[1]) / (ahead - behind)

    def below(self, line: str, x: float) -> float:
        """The xi in m of a line above or below a horizontal place x in m."""
        mesh, a = self._run.mesh, self._wire[line]
        row = self.motion.position[0, mesh.of(a)]
        stations = float(mesh.strands.h[a]) * np.arange(row.size)
        return float(np.interp(x, row, stations) if row[-1] > row[0] else np.interp(-x, -row, stations))

    def output(self, name: str) -> ContactOutput:
        """What is seen of a contact now."""
        contact_input, outside = self._contact_input(name), self.outside[name]
        on = bool(0.0 <= contact_input.xi <= self.length(outside.on))
        place, velocity, tangent = self._look(outside.on, contact_input.xi if np.isfinite(contact_input.xi) else 0.0)
        velocity, force = velocity + contact_input.speed * tangent, np.zeros(self.dim)
        k = self._own + list(self.outside).index(name)
        if on:
            force[-1] = (
                self._spring(outside, k, contact_input, place, velocity)
                if outside.is_sprung
                else contact_input.first[-1]
            )
            place = place.copy()
            place[-1] += self._local(outside.on, contact_input.xi) * force[-1]  # next to the spline the wire yields
        return ContactOutput(place, velocity, float(tangent[-1] / tangent[0]) if tangent[0] else np.inf, force)

    def _spring(self, outside: Outside, k: int, contact_input: ContactInput, place: Array, velocity: Array) -> float:
        """Force on the wire of a contact's spring and damper, N; the wire yields next to its spline."""
        gap = contact_input.height - place[-1]
        last = self.motion.stepping.gap[k]
        faster = (gap - last) / self.inner if np.isfinite(last) else contact_input.rise - velocity[-1]
        force = gap / (self._local(outside.on, contact_input.xi) + 1.0 / outside.stiffness) + outside.damping * faster
        if outside.side is None:
            return float(force)
        return float(min(force, 0.0) if outside.side == "above" else max(force, 0.0))

    def _local(self, line: str, xi: float) -> float:
        return float(places_of(self._run.mesh.strands, [Spot(self._wire[line], xi)]).local[0])

    def support_forces(self) -> dict[str, Array]:
        """Forces of the ends of all wires on them, by name, (axis,) N; of holds as at the last step's beginning."""
        known = self._record is not None
        hold = self.motion.hold_at_rest + self._record.hold[0] if known else self._run.holds_at_first()
        tie = self.motion.tie_at_rest + self._record.tie[0] if known else self._run.ties_at_first()
        return dict(zip(supports_of(self._run.task.plan)[0], self._run.reactions(hold, tie), strict=True))

    def get_state(self) -> Tree:
        """All that changes, copied."""
        contact_inputs = {name: asdict(contact_input) for name, contact_input in self.contact_inputs.items()}
        record = None if self._record is None else copied(self._record._asdict())
        return {"motion": self.motion.get_state(), "steps": self._steps, "record": record, "hands": contact_inputs}

    def set_state(self, state: Tree) -> None:
        """Go back to what `get_state` gave."""
        self.motion.set_state(state["motion"])
        self._steps = state["steps"]
        self._record = None if state["record"] is None else Record(**copied(state["record"]))
        self.contact_inputs.update(
            {name: ContactInput(**contact_input) for name, contact_input in state["hands"].items()}
        )


def _lines(scenario: Scenario) -> list[str]:
    return [*scenario.lines, *scenario.overhead_lines]


def _wire_of(name: str, scenario: Scenario, wires: list[str]) -> str:
    """The wire that a line is, or an overhead line's contact wire."""
    if name in scenario.lines:
        return name
    found = [wire for wire in wires if wire.startswith(f"{name}.")]
    return next((wire for wire in found if wire.endswith(_CONTACT_WIRE)), found[0])


__all__ = ["Wired"]
