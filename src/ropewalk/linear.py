"""The standard approach: a scenario answered by the classical theory of small deflections (`run: {kind: linear}`).

Every line is a taut string, or with bending stiffness a beam, along the chord between its supports, with the mean
tension that it has at rest. Its material points move across the chord only, which the loads do not stretch; deflections
of all loads add up. This is what the nonlinear answer is compared with: exact within the theory, and wrong where the
theory is (near supports, at finite angles, beyond the wave speed).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ropewalk.errors import EquilibriumError, RopewalkError
from ropewalk.mechanics.chain import FRICTIONLESS, HORIZONTAL, LEAVE, MATERIAL, Array
from ropewalk.mechanics.rider import force_at, look_up_integral, speed_at
from ropewalk.model.run import Linear
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import ENERGY_FORMS, Account, Frame
from ropewalk.solve.start import Setting
from ropewalk.theory import beam, string
from ropewalk.theory.image_sum import travelling_force

# A line that hangs further through than this part of its chord is none of small deflections.
_SHALLOW = 1.0 / 8.0
# Steps for differences of exact deflections, as a part of the length or the time of a wave along it.
_DIFFERENCE = 1e-6
# Terms of the series for the sag of a beam under its own weight: they fall with the fifth power.
_SAG_TERMS = 201


@dataclass(frozen=True)
class _Chord:
    """A line as the theory sees it."""

    start: Array  # (axis,) m
    along: Array  # (axis,) unit vector
    across: Array  # (axis - 1, axis) unit vectors, the first one downwards
    length: float  # m, of the chord
    material: float  # m, unstrained
    tension: float  # N
    mass: float  # kg/m, per length of the chord
    bending_stiffness: float  # N m^2
    foundation: float  # N/m^2
    damping: float  # N s/m^2

    @property
    def is_string(self) -> bool:
        return self.bending_stiffness == 0.0

    @property
    def beam(self) -> dict[str, Any]:
        """The arguments that describe it as a beam."""
        return {
            "length": self.length, "bending_stiffness": self.bending_stiffness, "mass": self.mass,
            "tension": self.tension, "foundation": self.foundation, "damping": self.damping,
        }  # fmt: skip

    def sag(self, x: Array, gravity: Array) -> Array:
        """Deflection under its own weight across the chord, (place, axis) m."""
        weight = self.mass * float(gravity @ self.across[0])
        if self.is_string:
            depth = weight * x * (self.length - x) / (2.0 * self.tension)
        else:
            k = np.arange(1, _SAG_TERMS + 1, 2) * np.pi / self.length
            stiffness = self.bending_stiffness * k**4 + self.tension * k**2 + self.foundation
            depth = (4.0 * weight / (self.length * k * stiffness)) @ np.sin(np.outer(k, x))
        return np.asarray(depth[:, None] * self.across[0])


def chords(setting: Setting, scenario: Scenario, account: Account) -> list[_Chord]:
    """The lines as strings or beams along their chords; remarks go to the account.

    Raises:
        EquilibriumError: a line is slack: it has no tension to work with.
    """
    found = []
    for s, (name, line) in enumerate(scenario.lines.items()):
        rest = setting.bare[s]
        start, end = setting.ends[s].place
        length = float(np.linalg.norm(end - start))
        material = float(setting.strands.links[s] * setting.strands.h[s])
        tension = float(rest.tension.mean()) if rest is not None else 0.0
        if line.bending_stiffness == 0.0 and not tension > 0.0:
            raise EquilibriumError(
                f"line {name}: the linear theory needs a tension at rest; give tension, or less length"
            )
        along = (end - start) / length
        down = np.zeros_like(along)
        down[-1] = -1.0
        down -= (down @ along) * along
        if np.linalg.norm(down) < 1e-9:
            down[0] = 1.0  # a vertical line: across it is sideways
        across = [down / np.linalg.norm(down)]
        if along.size == 3:
            across.append(np.cross(along, across[0]))
        mass = float(setting.strands.rho[s]) * material / length
        found.append(
            _Chord(
                start,
                along,
                np.array(across),
                length,
                material,
                tension,
                mass,
                line.bending_stiffness,
                line.foundation,
                mass * line.drag,
            )
        )
        depth = float(np.abs(found[-1].sag(np.array([0.5 * length]), setting.strands.gravity)).max())
        if depth > _SHALLOW * length:
            account.warnings.append(
                f"line {name} hangs {depth:.3g} m through over {length:.3g} m: too far for small deflections"
            )
        if found[-1].is_string and (line.foundation or line.drag):
            account.warnings.append(
                f"line {name}: foundation and drag of a string are left out; give bending_stiffness"
            )
    return found


def frames(setting: Setting, scenario: Scenario, times: Array, account: Account) -> Iterator[Frame]:
    """The frames at the given times, s.

    Raises:
        RopewalkError: what is asked is beyond the solutions that are known.
    """
    lines = chords(setting, scenario, account)
    fields = [_Field(setting, scenario, s, chord) for s, chord in enumerate(lines)]
    nodes = [field.motion(field.places, times) for field in fields]
    for i, t in enumerate(times):
        yield _frame(setting, fields, nodes, i, float(t))


class _Field:
    """The deflection of one line under all its loads."""

    def __init__(self, setting: Setting, scenario: Scenario, s: int, chord: _Chord) -> None:
        assert isinstance(scenario.run, Linear)
        self.setting, self.s, self.chord, self.modes = setting, s, chord, scenario.run.modes
        self.until = scenario.run.until
        self.names = tuple(scenario.loads)
        self.places: Array = np.linspace(0.0, chord.length, int(setting.strands.links[s]) + 1)
        self.scales = {int(k): self._scale(int(k)) for k in setting.on[s]}

    def _scale(self, k: int) -> float:
        """Distance along the chord for each metre of the path as measured."""
        measure = self.setting.loads.measure[k]
        if measure == MATERIAL:
            return self.chord.length / self.chord.material
        return 1.0 / abs(float(self.chord.along[0])) if measure == HORIZONTAL else 1.0

    def place(self, k: int, t: Array) -> Array:
        """Where load k is along the chord, m."""
        loads = self.setting.loads
        first, count = loads.speed_first[k], loads.speed_count[k]
        tables = loads.speed_time, loads.speed_value, loads.speed_path
        way = np.array([look_up_integral(*tables, first, count, time) for time in np.ravel(t)]).reshape(np.shape(t))
        begin = float(self.setting.xi[k]) * self.chord.length / self.chord.material
        return np.asarray(begin + self.scales[k] * way)

    def deflection(self, k: int, a: int, x: Array, t: Array) -> Array:
        """Deflection in m in the direction `across[a]` under load k alone; x and t broadcast."""
        loads, chord = self.setting.loads, self.chord
        begin, V = float(self.place(k, np.zeros(1))[0]), self.scales[k] * speed_at(loads, k, 0.0)
        size = self._force(k, a)
        steady = loads.speed_count[k] == 1 and not callable(size) and not isinstance(size, tuple)
        from_end = steady and ((V > 0.0 and begin == 0.0) or (V < 0.0 and begin >= chord.length * (1.0 - 1e-12)))
        x = x if V > 0.0 else chord.length - x
        if chord.is_string:
            line = {"length": chord.length, "tension": chord.tension, "mass": chord.mass}
            if from_end:
                return string.moving_force(x, t, force=float(size), speed=abs(V), modes=self.modes, **line)
            if self.modes is not None:
                raise RopewalkError(
                    f"load {self.names[k]}: modes are for a constant force that enters at an end with constant speed; "
                    "leave run.modes out"
                )
            path = (np.array([0.0, self.until]), self.place(k, np.array([0.0, self.until])))
            way = path if loads.speed_count[k] == 1 else (lambda tau: self.place(k, tau))
            return travelling_force(x if V > 0.0 else chord.length - x, t, path=way, force=size, **line)
        if not from_end:
            raise RopewalkError(
                f"load {self.names[k]}: on a beam the linear theory here knows a constant force that enters at an end "
                "with constant speed"
            )
        return beam.moving_force(x, t, force=float(size), speed=abs(V), modes=self.modes, **chord.beam)

    def _force(self, k: int, a: int) -> Any:
        """Component of the force of load k across the chord: a number, or a table (times, values)."""
        loads = self.setting.loads
        entries = slice(loads.force_first[k], loads.force_first[k] + loads.force_count[k])
        values = self.chord.across[a] @ loads.force_value[:, entries]
        if values.size == 1:
            return float(values[0])
        times = np.concatenate(
            [[-1.0], loads.force_time[entries], [max(self.until, loads.force_time[entries][-1]) + 1.0]]
        )
        # A jump, two values at one instant, is a steep rise for a table whose times must increase.
        times[1:] = np.maximum(times[1:], times[:-1] + 1e-9 * self.until)
        return times, np.concatenate([values[:1], values, values[-1:]])

    def motion(self, x: Array, times: Array) -> tuple[Array, Array]:
        """Deflections and velocities (time, place, axis) of the line at places x under all loads."""
        moved, speed = (np.zeros((times.size, x.size, self.chord.along.size)) for _ in range(2))
        step = _DIFFERENCE * self.chord.length / self._wave_speed()
        for k in self.setting.on[self.s]:
            for a, direction in enumerate(self.chord.across):
                w = self.deflection(int(k), a, x[None, :], times[:, None])
                ahead = self.deflection(int(k), a, x[None, :], times[:, None] + step)
                behind = self.deflection(int(k), a, x[None, :], np.maximum(times[:, None] - step, 0.0))
                rate = (ahead - behind) / (step + np.minimum(step, times[:, None]))
                moved += w[:, :, None] * direction
                speed += rate[:, :, None] * direction
        return moved, speed

    def _wave_speed(self) -> float:
        if self.chord.is_string:
            return string.wave_speed(tension=self.chord.tension, mass=self.chord.mass)
        return float(beam.natural_frequencies(1, **self.chord.beam)[0]) * self.chord.length / np.pi

    def point(self, x: Array) -> Array:
        """Places on the chord with its sag, (place, axis) m."""
        chord = self.chord
        return np.asarray(chord.start + x[:, None] * chord.along + chord.sag(x, self.setting.strands.gravity))

    def contact(self, k: int, t: float) -> tuple[float, Array, float] | None:
        """Place along the chord, position and slope under load k; None while it is off the line."""
        x = float(self.place(k, np.array([t]))[0])
        if not 0.0 <= x <= self.chord.length:
            if self.setting.loads.at_end[k] == LEAVE:
                return None
            x = min(max(x, 0.0), self.chord.length)
        step = _DIFFERENCE * self.chord.length
        near = np.clip(np.array([x - step, x, x + step]), 0.0, self.chord.length)
        w, _ = self.motion(near, np.array([t]))
        slope = float((w[0, 2] - w[0, 0]) @ self.chord.across[0]) / (near[2] - near[0])
        return x, self.point(near[1:2])[0] + w[0, 1], slope


def _frame(setting: Setting, fields: list[_Field], nodes: list[tuple[Array, Array]], i: int, t: float) -> Frame:
    loads, dim, count = setting.loads, len(setting.axes), setting.xi.size
    nowhere = np.full((count, dim), np.nan)
    place, force, hold = nowhere, nowhere.copy(), nowhere.copy()
    xi, speed = np.full(count, np.nan), np.full(count, np.nan)
    both, friction = np.full((count, 2), np.nan), np.full(count, np.nan)
    position, velocity, tension, strain, reaction = [], [], [], [], []
    energy = np.full(len(ENERGY_FORMS), np.nan)
    energy[:3] = 0.0
    for field, (w, rate) in zip(fields, nodes, strict=True):
        chord, s = field.chord, field.s
        r = field.point(field.places) + w[i]
        position.append(r)
        velocity.append(rate[i])
        links, step = field.places.size - 1, chord.length / (field.places.size - 1)
        tension.append(np.full(links, chord.tension))
        rest = setting.bare[s]
        strain.append(np.full(links, rest.strain.mean() if rest is not None else 0.0))
        tilt = np.diff(r, axis=0) / step
        reaction += [-chord.tension * tilt[0], chord.tension * tilt[-1]]
        lumped = np.full(links + 1, chord.mass * step)
        lumped[[0, -1]] *= 0.5
        bent = np.diff(r, 2, axis=0) / step**2
        energy[0] += 0.5 * float(lumped @ (rate[i] ** 2).sum(axis=1))
        energy[1] += 0.5 * chord.tension * step * float(((tilt - chord.along) ** 2).sum())
        energy[1] += 0.5 * chord.bending_stiffness * step * float((bent**2).sum())
        energy[1] += 0.5 * chord.foundation * step * float((w[i] ** 2).sum())
        energy[2] -= float(lumped @ (r @ setting.strands.gravity))
        for k in setting.on[s]:
            found = field.contact(int(k), t)
            if found is None:
                continue
            x, place[k], slope = found
            given = np.array([force_at(loads, k, t, a) for a in range(dim)])
            hold[k] = 0.0
            if loads.contact[k] == FRICTIONLESS:  # what the slope throws back, or pulls on
                hold[k] = -float(given @ chord.across[0]) * slope * chord.along
            force[k] = given + hold[k]
            xi[k], speed[k], both[k] = x * chord.material / chord.length, speed_at(loads, k, t), chord.tension
    return Frame(
        path=t,
        position=np.concatenate(position),
        velocity=np.concatenate(velocity),
        tension=np.concatenate(tension),
        strain=np.concatenate(strain),
        contact_position=place,
        contact_force=force,
        hold_force=hold,
        contact_xi=xi,
        contact_speed=speed,
        contact_tension=both,
        contact_friction=friction,
        reaction=np.array(reaction),
        energy=energy,
    )
