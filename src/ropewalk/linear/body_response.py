"""A mass, an oscillator or a vehicle that travels over its line in the linear theory, coupled in both directions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import RopewalkError
from ropewalk.linear.capabilities import mass_inside
from ropewalk.linear.chord import Chord
from ropewalk.mechanics.chain import HORIZONTAL, MATERIAL, Array, Integers
from ropewalk.mechanics.moving_contact import speed_at
from ropewalk.model.capabilities import refusal
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.run import Linear
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.solve.multibody import Multibody, multibody_of
from ropewalk.solve.start import PreparedRun
from ropewalk.solve.superposition import restrained_by_pulling
from ropewalk.theory import beam, string
from ropewalk.theory.beam_flight import MODES
from ropewalk.theory.image_sum import travelling_force

# Stiffness of a string that is asked for by modes, as a part of P L^2: the highest of 1000 modes feels 1e-7 of it.
_NO_STIFFNESS = 1e-14
# Share of its weight by which the path over the sag would change the load of a body, from which on it is mentioned.
_FELT = 0.05
# Part of the length next to the far support, before which the force of a body on a string is tabulated; and by how much
# the distance from the support shrinks from one entry to the next there.
_LAST, _SHRINKS = 1e-9, 0.998
_DIFFERENCE = 1e-6
# Of deflections, if modes are added until it is reached, or if their number is given: contact forces converge later.
_TOLERANCE, _FINE = 1e-5, 1e-6


@dataclass(frozen=True)
class BodyResponse:
    """What a body on a line does at all instants; downwards is positive. NaN where the theory does not say."""

    system: Multibody
    velocity: float  # m/s along the chord
    place: Array  # (instant, wheel) m along the chord
    on: NDArray[np.bool_]  # (instant, wheel) whether between the supports
    wheel: Array  # (instant, wheel) displacement, m
    wheel_velocity: Array  # (instant, wheel) m/s
    slope: Array  # (instant, wheel) of the line below
    force: Array  # (instant, wheel) N, on the line
    in_air: NDArray[np.bool_]  # (instant, wheel)
    time_in_air: Array  # (instant, wheel) s
    body: Array  # (instant, coordinate) displacement from rest, m
    body_velocity: Array  # (instant, coordinate) m/s
    loss: Array  # (instant,) J, in impacts so far; NaN without lift_off
    nodes: tuple[Array, Array]  # deflection and velocity of the line, (instant, node, axis)


@dataclass(frozen=True)
class _Way:
    """How a load goes along its chord, seen from the end that it enters at: there 0, the far end at the length."""

    chord: Chord
    forward: bool
    speed: float  # m/s
    begin: Array  # (wheel,) m

    @property
    def start(self) -> float:
        return float(self.begin.max())

    def turned(self, x: Array) -> Array:
        """Places counted from the end of entry, or back."""
        return x if self.forward else self.chord.length - x


def response_of(
    setting: PreparedRun, scenario: Scenario, name: str, s: int, chord: Chord, times: Array, run_info: RunInfo
) -> BodyResponse:
    """The ride of load `name`, which is alone on line s.

    Raises:
        RopewalkError: what is asked is beyond the solutions that are known.
    """
    assert isinstance(scenario.run, Linear)
    load = scenario.loads[name]
    way = _way(setting, chord, np.flatnonzero([wheel.load == name for wheel in setting.wheels]))
    system = multibody_of(setting.loading, name, load, way.start - way.begin)
    _mention_sag(setting, name, way, run_info)
    nodes = np.linspace(0.0, chord.length, int(setting.strands.links[s]) + 1)
    lifts, modes = getattr(load, "lift_off", False), scenario.run.modes
    try:
        if chord.is_string and modes is None:
            return _on_string(system, way, nodes, times, name, run_info)
        return _on_beam(system, way, nodes, times, modes, name, run_info, lifts=lifts)
    except ValueError as error:
        if "is not reached" in str(error) and modes is None:
            cause = "wheels that are put down on a beam strike all its modes at once" if (way.start > 0.0) else (
                "a wheel with a mass hits a beam as it rolls on to it")  # fmt: skip
            raise RopewalkError(
                f"run.modes: the response to load {name} does not converge by adding modes to a tolerance of "
                f"{_TOLERANCE:g} ({cause}); write run.modes: 40 and compare with twice as many, or ask for kind: "
                f"dynamic{', or let it come from loads.' + name + '.travel.from: 0 m' if way.start > 0.0 else ''}"
            ) from error
        raise RopewalkError(f"load {name}: {error}") from error


def _way(setting: PreparedRun, chord: Chord, wheels: Integers) -> _Way:
    loads, first = setting.loads, int(wheels[0])
    measure, scale = loads.measure[first], 1.0
    if measure == MATERIAL:
        scale = chord.length / chord.material
    elif measure == HORIZONTAL:
        scale = 1.0 / abs(float(chord.along[0]))
    velocity = scale * speed_at(loads, first, 0.0)
    starts = setting.xi[wheels] if measure == MATERIAL else np.array([setting.wheels[int(k)].start for k in wheels])
    begin = scale * starts
    # A start at the far end is rounded, above all where the length follows from a tension.
    begin = np.where(np.abs(begin - chord.length) < 1e-9 * chord.length, chord.length, begin)
    forward = velocity > 0.0
    return _Way(chord, forward, abs(velocity), begin if forward else chord.length - begin)


def _mention_sag(setting: PreparedRun, name: str, way: _Way, run_info: RunInfo) -> None:
    gravity, L = setting.strands.gravity, way.chord.length
    size = float(np.linalg.norm(gravity))
    if size == 0.0:
        return
    depth = way.chord.sag(np.array([0.25, 0.5, 0.75]) * L, gravity) @ way.chord.across[0]
    felt = way.speed**2 * abs(float(depth[0] - 2.0 * depth[1] + depth[2])) / (0.25 * L) ** 2 / size
    if felt > _FELT:
        run_info.warnings.append(
            f"load {name} runs over the sag of its line so fast that this alone changes its weight by {felt:.2g} of "
            "itself; the linear theory lets it travel as if the line were level"
        )


def _on_beam(
    system: Multibody,
    way: _Way,
    nodes: Array,
    times: Array,
    modes: int | None,
    name: str,
    run_info: RunInfo,
    *,
    lifts: bool,
) -> BodyResponse:
    """By the modes of a beam; a string with a number of modes is one without stiffness."""
    chord, line = way.chord, way.chord.beam
    if chord.is_string:
        line["bending_stiffness"] = _NO_STIFFNESS * chord.tension * chord.length**2
        run_info.warnings.append(
            f"load {name}: on a string a sum of modes is wrong by about one part in their number, and the contact "
            "force by more; leave run.modes out for a single mass or oscillator"
        )
    task: dict[str, Any] = {"vehicle": _vehicle(system), "speed": way.speed, "start": way.start, **line}
    solved: beam.Flight | beam.Crossing
    if lifts:
        solved = beam.flying_vehicle(times, modes=modes or MODES, **task)
        wheel, rate, in_air = solved.wheel, solved.wheel_velocity, solved.in_air
        time_in_air, loss = solved.time_in_air, solved.impact_loss
    else:
        solved = beam.moving_vehicle(times, modes=modes, tolerance=_TOLERANCE if modes is None else _FINE, **task)
        wheel, rate, in_air = solved.deflection, solved.velocity, np.zeros_like(solved.deflection, dtype=bool)
        time_in_air, loss = np.zeros_like(solved.deflection), np.full(times.size, np.nan)
        if solved.contact_lost_at is not None:
            _mention_pull(name, solved.contact_lost_at, "lift_off: true lets it fly", run_info)
    along = way.turned(nodes)
    deflection, velocity = solved.beam_deflection(along), solved.beam_velocity(along)
    on = (solved.place >= 0.0) & (solved.place <= chord.length)
    under = np.clip(solved.place, 0.0, chord.length)
    slope = np.array([solved.beam_deflection(under[i], 1)[i] for i in range(times.size)])
    return BodyResponse(
        system, way.speed if way.forward else -way.speed, way.turned(solved.place), on, wheel, rate,
        slope if way.forward else -slope, solved.contact_force, in_air, time_in_air, solved.body,
        solved.body_velocity, loss, _vectors(chord, deflection, velocity),
    )  # fmt: skip


def _on_string(system: Multibody, way: _Way, nodes: Array, times: Array, name: str, run_info: RunInfo) -> BodyResponse:
    """By the delay equation of the contact force, which then travels along the string."""
    chord = way.chord
    if way.start != 0.0:
        raise refusal(mass_inside(name, way.start))
    line = {"length": chord.length, "tension": chord.tension, "mass": chord.mass}
    passage = chord.length / way.speed
    left = np.concatenate([np.linspace(1.0, 0.0, 6001)[:-1], np.exp(np.arange(0.0, np.log(_LAST), np.log(_SHRINKS)))])
    table = passage * (1.0 - np.unique(np.concatenate([left, [_LAST]]))[::-1])
    on = (times >= 0.0) & (times < passage)
    asked, place = np.where(on, times, 0.0), way.speed * times[:, None]
    own, history = (_contact(system, way, t, line) for t in (asked, table))
    if own.contact_lost_at is not None and own.contact_lost_at < min(times[-1], passage):
        _mention_pull(name, own.contact_lost_at, "kind: dynamic with lift_off: true lets it fly", run_info)
    # Beyond the last entry the force, however large, stands so close to the support that the string does not feel it.
    force = (table, history.contact_force)
    path = (table[[0, -1]], way.speed * table[[0, -1]])

    def deflection(x: Array, t: Array) -> Array:
        return travelling_force(x, t, path=path, force=force, **line)

    step = _DIFFERENCE * chord.length
    t, h = times[:, None], step / string.wave_speed(tension=chord.tension, mass=chord.mass)
    along = way.turned(nodes)[None, :]
    moved = deflection(along, t)
    rate = (deflection(along, t + h) - deflection(along, np.maximum(t - h, 0.0))) / (h + np.minimum(h, t))
    near = np.clip(place + np.array([-step, step]), 0.0, chord.length)
    sides = deflection(near, t)
    slope = (sides[:, 1] - sides[:, 0]) / np.maximum(near[:, 1] - near[:, 0], step)
    gone = np.where(on | (times < 0.0), 0.0, np.nan)[:, None]  # nothing is said of it beyond the line
    none = np.zeros((times.size, 1))
    if isinstance(own, string.OscillatorPassage):
        body, body_rate = own.body_deflection[:, None] + gone, own.body_velocity[:, None] + gone
    else:
        body, body_rate = np.zeros((times.size, 0)), np.zeros((times.size, 0))
    return BodyResponse(
        system, way.speed if way.forward else -way.speed, way.turned(place), on[:, None],
        own.deflection[:, None] + gone, own.velocity[:, None] + gone, (slope if way.forward else -slope)[:, None],
        own.contact_force[:, None] + gone, none > 0.0, none, body, body_rate, np.full(times.size, np.nan),
        _vectors(chord, moved, rate),
    )  # fmt: skip


def _contact(
    system: Multibody, way: _Way, t: Array, line: dict[str, float]
) -> string.MassPassage | string.OscillatorPassage:
    """Motion of the contact at times of the passage."""
    load = system.load
    total = float(system.mass.sum())
    # Everything grows with the weight, of which a further force is a part.
    task = {"speed": way.speed, "gravity": float(system.static_load[0]) / total} | line
    if isinstance(load, Oscillator):
        return string.moving_oscillator(
            t, sprung_mass=load.mass, contact_mass=load.wheel_mass, stiffness=float(system.stiffness[0, 0]),
            damping=float(system.damping[0, 0]), **task,
        )  # fmt: skip
    return string.moving_mass(t, load_mass=total, **task)


def _vehicle(body: Multibody) -> beam.Vehicle:
    return beam.Vehicle(body.mass, body.damping, body.stiffness, body.axles, body.static_load)


def _mention_pull(name: str, time: float, remedy: str, run_info: RunInfo) -> None:
    run_info.warnings.append(restrained_by_pulling(name, time, remedy))


def _vectors(chord: Chord, moved: Array, rate: Array) -> tuple[Array, Array]:
    return moved[:, :, None] * chord.across[0], rate[:, :, None] * chord.across[0]
