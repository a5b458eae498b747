"""What must not be trusted of motions, and why."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ropewalk.checkpoint import Arrays
from ropewalk.mechanics.assembly import speed_table
from ropewalk.mechanics.chain import CLAMPED, COULOMB, Array
from ropewalk.mechanics.contact_points import ContactPoint
from ropewalk.mechanics.loading import Loading
from ropewalk.model.carriage import Carriage
from ropewalk.model.joint import Joined
from ropewalk.model.law import Inextensible
from ropewalk.model.load import GivenForces
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.model.travel import FreeTravel, Travel
from ropewalk.model.trolley import Trolley
from ropewalk.results.frame import RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.ropeway import Hauling
from ropewalk.system.assembling.assembled import Assembled
from ropewalk.system.contact.contact_record import BODY, ON, PRESCRIBED
from ropewalk.system.contact.contacts import FASTEST
from ropewalk.system.elements.segments import mass_of
from ropewalk.system.elements.structure import Buffers, Structure
from ropewalk.system.reporting.hold_forces import on_friction
from ropewalk.system.reporting.sticking_friction import StickingFriction

# Part of a run for which a load may be faster than the waves of its line, as where that is slack for a while.
LONG = 0.2


class ContactDoubts:
    """What has been said of the contacts of a motion, and what is counted before it is."""

    def __init__(
        self, loading: Loading, contacts: Any, structure: Structure, run_info: RunInfo,
        instants: int,
    ) -> None:  # fmt: skip
        self.loading, self.structure, self.run_info, self._instants = loading, structure, run_info, instants
        self._fast = np.zeros(contacts.size, dtype=np.int64)  # frames in which each was faster than waves
        self._slipped = np.zeros(contacts.size, dtype=np.int64)  # 1: it has been said that friction is not enough
        clamped, coulomb = loading.loads.contact == CLAMPED, loading.loads.contact == COULOMB
        self._may_slip = (clamped & (contacts["friction"] > 0.0)) | coulomb

    def changing(self) -> Arrays:
        """What changes."""
        return {"fast": self._fast, "slipped": self._slipped}

    def doubt_speeds(self, path: Array, contacts: Any) -> None:
        """Doubt kinks that are carried along faster than transverse waves."""
        runs, run = self.structure.runs, np.where(contacts["state"] == ON, contacts["run"], 0)
        kinked = (contacts["state"] == ON) & (contacts["kind"] == BODY) & (runs.bending[run] == 0.0)
        square = mass_of(self.structure, contacts) * contacts["speed"] ** 2
        fast = kinked & (square > FASTEST * np.maximum(contacts["tension"], 0.0)) & (square > 0.0)
        before, count = self._fast.copy(), np.cumsum(fast, axis=0)
        self._fast += count[-1]
        for k in np.flatnonzero((before <= LONG * self._instants) & (self._fast > LONG * self._instants)):
            i = int(np.argmax(fast[:, k] & (before[k] + count[:, k] > LONG * self._instants)))
            wheel = self.loading.wheels[k]
            self._doubt(wheel.name, wheel.load, float(contacts["speed"][i, k]), float(path[i]))

    def ask_friction(self, frames: Frames, contacts: Any) -> None:
        """Note once where the friction of a prescribed travel is not enough."""
        needed, asked = frames.of["contact_friction"], (contacts["state"] == ON) & (contacts["travel"] == PRESCRIBED)
        for i, k in zip(*np.nonzero(asked & self._may_slip & (self._slipped == 0)), strict=True):
            kind, contact = int(self.loading.loads.contact[k]), contacts[i, k]
            found = on_friction(self.loading.wheels[k].name, kind, contact, float(needed[i, k]))
            if found and not self._slipped[k]:
                self._slipped[k] = 1
                self.run_info.warnings.append(f"at t = {frames.path[i]:.4g} s, {found}")

    def _doubt(self, name: str, load: str, speed: float, t: float) -> None:
        if any(doubt.key == f"loads.{load}.travel.speed" for doubt in self.run_info.doubts):
            return
        self.run_info.doubt(
            f"load {name}: a mass at {speed:.4g} m/s reaches the speed of the transverse waves of its line at t = "
            f"{t:.4g} s",
            "its contact force is wrong once it is as fast as the waves", f"loads.{load}.travel.speed",
            "let it go slower, or give the line more tension",
        )  # fmt: skip


# Part of the largest tension with which an inextensible line may be pushed together.
_PUSHED = 0.1
# Part of the weight of a load on several lines, with which each may draw it down: where it is set down, they differ.
_LITTLE = 1e-2
# Strain of a hauling rope up to which it is slack: rounding.
_SLACK = 1e-9
# Tension over EA of a line at rest that nothing pulls at.
_NOTHING = 1e-10
# Part of a cell up to which a node is where something is joined.
_BESIDE = 1e-6
# Part of gravity from which on what a curve would push with is told.
_FELT = 0.02
# Length of links over the smallest rocker from which on single wheels on a saddle are not resolved.
_COARSE = 1.5


def coarse_for_wheels(scenario: Scenario) -> Iterator[str]:
    """Carriages on lines over saddles, in words, whose smallest rockers are shorter than links by a good part.

    A carriage of 8 t over a saddle of 50 m had least wheel loads of 9.1, 15.9 and 14.8 kN on links of 2.5, 1.25 and 0.6
    times its smallest rocker of 0.8 m.
    """
    for name, load in scenario.loads.items():
        line = scenario.lines.get(load.on)
        if not isinstance(load, Carriage) or line is None or not line.saddles or line.segments:
            continue
        length = line.distance if line.length is None else line.length
        times = length / line.elements / load.rockers[0]
        if times > _COARSE:
            yield (
                f"links of {load.on} are {times:.2g} times as long as the smallest rocker of {name}: over a saddle "
                "loads of single wheels are wrong by tens of per cent, and the force of the saddle with them; write "
                f"lines.{load.on}.elements: {math.ceil(length / load.rockers[0])} or more"
            )


def not_pushed_outwards(scenario: Scenario) -> Iterator[str]:
    """Loads with a mass on curves of overhead lines, in words, whose chords are laid out straight.

    What they miss is told from a fiftieth of gravity on: a payload would hang a degree aside.
    """
    for name, load in scenario.loads.items():
        line, travel = scenario.overhead_lines.get(load.on), getattr(load, "travel", None)
        if line is None or isinstance(load, GivenForces) or not isinstance(travel, Travel | FreeTravel):
            continue
        until = scenario.run.until if isinstance(scenario.run, Dynamic) else 0.0
        fastest = float(np.abs(speed_table(travel.speed, until)[1]).max())
        outwards = fastest**2 * max(abs(k) for k in line.curvatures)
        if outwards > _FELT * scenario.gravity:
            yield (
                f"{name} follows the curve of {load.on} along straight chords: the centrifugal force of the curve is "
                f"neglected, with {outwards:.2g} m/s^2 at {fastest:.3g} m/s"
            )


def doubt_sticking(run_info: RunInfo, t: float, where: str) -> None:
    """Doubt once small motion in which lines stick where friction bears less than that asks for, at t in s."""
    what = f"a line sticks at {where} in linearised motion, which requires more than its friction from t = {t:.4g} s on"
    if not any(doubt.what.startswith(what.partition(",")[0]) for doubt in run_info.doubts):
        wrong = "the line would slip there, with a smaller difference of tensions"
        run_info.doubt(what, wrong, "", "write kind: dynamic with geometry: nonlinear")


def ask_sticking(
    friction: StickingFriction, structure: Structure, x: Array, buffers: Buffers, run_info: RunInfo, t: float
) -> None:  # fmt: skip
    """Doubt once motion that is linearised where friction holds what it does not bear, by the forces of now at t in s.

    Nodes that friction holds are taken to have no inertia across what presses them, as on saddles that stand fast.
    """
    if structure.saddles is not None and friction.rubbed(buffers.force.ravel(), x.ravel())[1]:
        doubt_sticking(run_info, t, "a saddle")
    if friction.slips_over(structure.sheaves):
        doubt_sticking(run_info, t, "a sheave")


def turned_far(t: float, step: float, stable: float) -> str:
    """Return the warning that lines have turned out of the direction of their axial inertia.

    Args:
        t: instant, s.
        step: of the run, s.
        stable: largest step that is stable for certain, s.
    """
    return (
        f"at t = {t:.4g} s lines have turned so far that run.axial_inertia is of less use: the step of {step:.3g} s is "
        f"stable for certain only below {stable:.3g} s; write a smaller run.step"
    )


def joined_beside(scenario: Scenario, assembled: Assembled) -> Iterator[str]:
    """Lines, in words, that are not joined to nets where it was asked for but at the node next to that."""
    nets = {} if assembled.nets is None else {sheet.name: sheet for sheet in assembled.nets.membranes}
    for name, line in scenario.lines.items():
        for key, end in (("start_support", line.start_support), ("end_support", line.end_support)):
            if not isinstance(end, Joined) or end.to not in nets:
                continue
            assert isinstance(end.at, tuple)
            node, away = nets[end.to].near(end.at)
            if away > _BESIDE * float(np.sqrt(nets[end.to].surface.areas.mean())):
                place = ", ".join(f"{x:.4g}" for x in nets[end.to].surface.plan[node])
                yield (
                    f"lines.{name}.{key}: the line is joined to the nearest node of {end.to}, at [{place}], {away:.3g} "
                    f"m from where it should be; write a smaller nets.{end.to}.mesh, or join it there"
                )


def doubt_saddles(scenario: Scenario, run_info: RunInfo, frames: Frames, line: Sequence[str]) -> None:
    """Doubt lines that pass below a saddle from the beginning: there rest was found on the wrong side of it."""
    for name, own in scenario.lines.items():
        if not own.saddles:
            continue
        place = frames.of["position"][0, np.array([one == name for one in line])]
        for saddle, body in own.saddles.items():
            key = f"lines.{name}.saddles.{saddle}"
            near = np.abs(place[:, 0] - body.at[0]) < body.radius
            low = near.any() and place[near, -1].max() < body.at[-1] - body.radius
            if low and all(doubt.key != key for doubt in run_info.doubts):
                cause = "the search for its equilibrium started from a line that is too long"
                run_info.doubt(
                    f"line {name} passes below saddle {saddle}", cause, key,
                    f"give lines.{name} less length, at most that of the straight path over its saddles",
                )  # fmt: skip


def doubt_wheels(scenario: Scenario, run_info: RunInfo, frames: Frames, wheels: Sequence[ContactPoint]) -> None:
    """Doubt carriages and loads on several lines whose wheels would leave the rope, where nothing lets them."""
    for k, wheel in enumerate(wheels):
        load, key, remedy = scenario.loads[wheel.load], f"loads.{wheel.load}.lift_off", "write lift_off: true"
        most = 0.0
        if isinstance(load, Trolley) and load.also_on:
            key, remedy = f"lines.{wheel.on}", "let all of its lines sag alike: change a length or a tension"
            most = _LITTLE * (load.mass + load.payload.mass) * scenario.gravity
        elif not isinstance(load, Carriage) or load.lift_off:
            continue
        if any(doubt.key == key for doubt in run_info.doubts):
            continue
        lifts = frames.of["contact_force"][:, k, -1] > most
        if lifts.any():
            t = float(frames.path[int(np.argmax(lifts))])
            run_info.doubt(
                f"wheel {wheel.part} of {wheel.load} would leave its rope at t = {t:.4g} s",
                "it is drawn down there, as if there were a rail above it", key, remedy,
            )  # fmt: skip


def judge_hauling_ropes(
    scenario: Scenario, run_info: RunInfo, frames: Frames, hauled: Sequence[str], deep: Array
) -> None:  # fmt: skip
    """Warn of hauling ropes that are slack, for they only pull, and of those that slip; doubt ropes that sag deeply.

    Args:
        scenario: what is there.
        run_info: notes what is found.
        frames: what is judged.
        hauled: carriages that ropes haul.
        deep: (instant, rope) largest weight of a span of each rope over its tension.
    """
    own = [name for name, load in scenario.loads.items() if isinstance(load, Carriage) and load.haul is not None]
    for e, name in enumerate(own):
        load = scenario.loads[name]
        assert isinstance(load, Carriage)
        row, haul = hauled.index(name), load.haul
        assert haul is not None
        found, slipped = Hauling.of(frames.of["haul_tension"][:, row]), frames.of["haul_slip"][:, row]
        slack = found.pull <= _SLACK * haul.axial_stiffness
        _warn(run_info, frames.path, slack, f"the hauling rope of {name} is slack", "the carriage is then not driven")
        if haul.sheave is not None:
            bears = haul.sheave.slip_ratio
            what = f"the hauling rope of {name} slips on the sheave of its drive"
            so = (
                f"friction transmits a tension ratio of at most {bears:.3g}, and the drive no longer prescribes the "
                f"speed of {name}"
            )
            _warn(run_info, frames.path, np.abs(slipped) > 0.0, what, so)
        key, sags = f"loads.{name}.haul.sags", deep[:, e] > 1.0
        if sags.any() and all(doubt.key != key for doubt in run_info.doubts):
            i = int(np.argmax(sags))
            run_info.doubt(
                f"the hauling rope of {name} weighs {deep[i, e]:.3g} times its tension between two rollers at "
                f"t = {frames.path[i]:.4g} s, and sags by more than an eighth of their distance",
                "its sag is that of a shallow rope", key, "give it more tension by counter, or leave sags out",
            )  # fmt: skip


def _warn(run_info: RunInfo, path: Array, when: Any, what: str, so: str) -> None:
    """Note when something is so for the first time, once."""
    text = f"{what} at t = "
    if when.any() and not any(warning.startswith(text) for warning in run_info.warnings):
        run_info.warnings.append(f"{text}{path[int(np.argmax(when))]:.4g} s: {so}")


def doubt_struts(scenario: Scenario, run_info: RunInfo, on: Sequence[str], tension: Array, when: str) -> None:
    """Doubt inextensible lines that are pushed together: there they are bars, which fold as the mesh lets them.

    Args:
        scenario: what is there.
        run_info: takes the doubts.
        on: (link,) names of the lines of links.
        tension: (link,) N.
        when: in words.
    """
    rigid = [name for name, line in scenario.lines.items() if isinstance(line.law, Inextensible)]
    if not rigid:
        return
    pull = {name: tension[np.array(on) == name] for name in rigid}
    largest = max(float(np.abs(own).max()) for own in pull.values())
    for name, own in pull.items():
        key = f"lines.{name}.law"
        if float(own.min()) < -_PUSHED * largest and all(doubt.key != key for doubt in run_info.doubts):
            run_info.doubt(
                f"line {name} is pushed together {when}, and folds as its elements let it",
                "it is inextensible, and slack there", key, "give it an axial_stiffness with law: tension_only",
            )  # fmt: skip


def doubt_slack(scenario: Scenario, run_info: RunInfo, on: Sequence[str], tension: Array) -> None:
    """Doubt shapes of lines without stiffness that nothing pulls at: without weight any other is as good.

    Args:
        scenario: what is there.
        run_info: takes the doubts.
        on: (link,) names of the lines of links.
        tension: (link,) N, at rest.
    """
    if scenario.gravity != 0.0:
        return
    for name, line in scenario.lines.items():
        if line.has_bending_stiffness or (line.length or 0.0) <= line.distance * (1.0 + _SLACK):
            continue  # it is straight
        mine = np.array([own == name for own in on])
        if np.abs(tension[mine]).max() < _NOTHING * (line.axial_stiffness or 1.0):
            run_info.doubt(
                f"line {name} is slack and has no weight: its equilibrium is not unique",
                "it is longer than the distance of its supports, and gravity is 0", f"lines.{name}.length",
                "give gravity, or make it shorter",
            )  # fmt: skip
