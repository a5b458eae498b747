"""Frames of a run of kind linear."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ropewalk.linear.body_response import BodyResponse, response_of
from ropewalk.linear.chord import Chord, chords
from ropewalk.linear.field import Field
from ropewalk.mechanics.chain import FRICTIONLESS, REFUSE, Array
from ropewalk.mechanics.moving_contact import force_at, speed_at
from ropewalk.mechanics.vehicle_matrices import Body
from ropewalk.model.load import GivenForces
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import ENERGY_FORMS, IN_AIR, MOVES, Contacts, Frame, RunInfo
from ropewalk.solve.start import PreparedRun
from ropewalk.solve.superposition import passed_an_end

_OF_LOADS = [ENERGY_FORMS.index(form) for form in ("load_kinetic", "load_potential")]
_IN_IMPACTS = ENERGY_FORMS.index("contact_dissipation")


def frames(setting: PreparedRun, scenario: Scenario, times: Array, run_info: RunInfo) -> Iterator[Frame]:
    """The frames at the given times, s.

    Raises:
        RopewalkError: what is asked is beyond the solutions that are known.
    """
    lines = chords(setting, scenario, run_info)
    fields = [Field(setting, scenario, s, chord) for s, chord in enumerate(lines)]
    _refuse_to_pass(setting, scenario, fields, times)
    bodies = {load.on: name for name, load in scenario.loads.items() if not isinstance(load, GivenForces)}
    responses = [
        response_of(setting, scenario, bodies[name], s, chord, times, run_info) if name in bodies else None
        for s, (name, chord) in enumerate(zip(scenario.lines, lines, strict=True))
    ]
    nodes = [
        response.nodes if response is not None else field.motion(field.places, times)
        for field, response in zip(fields, responses, strict=True)
    ]
    for i, t in enumerate(times):
        yield _frame(setting, fields, responses, nodes, i, float(t))


def _refuse_to_pass(setting: PreparedRun, scenario: Scenario, fields: list[Field], times: Array) -> None:
    """Refuse loads that would pass an end of a line whose length was not known before.

    Raises:
        RopewalkError: there is such a load.
    """
    for field in fields:
        slack = 1e-9 * field.chord.length
        for k in setting.on[field.s]:
            place = field.place(int(k), times)
            off = (place < -slack) | (place > field.chord.length + slack)
            if setting.loads.at_end[k] == REFUSE and off.any():
                name, t = setting.wheels[int(k)].load, float(times[int(off.argmax())])
                raise passed_an_end(name, t)


def _frame(
    setting: PreparedRun,
    fields: list[Field],
    responses: list[BodyResponse | None],
    nodes: list[tuple[Array, Array]],
    i: int,
    t: float,
) -> Frame:
    loads, dim, count = setting.loads, len(setting.axes), setting.xi.size
    seen = Contacts(count, dim)
    place, force, hold, both, xi, speed = seen.position, seen.force, seen.hold, seen.tension, seen.xi, seen.speed
    position, velocity, tension, strain, reaction = [], [], [], [], []
    energy = np.full(len(ENERGY_FORMS), np.nan)
    energy[:3] = 0.0
    if any(response is not None for response in responses):
        energy[_OF_LOADS] = 0.0
        energy[_IN_IMPACTS] = 0.0
    displayed = setting.multibody_system.displayed if setting.multibody_system is not None else ()
    body_place, body_speed = np.full((len(displayed), dim), np.nan), np.full((len(displayed), dim), np.nan)
    for field, response, (w, rate) in zip(fields, responses, nodes, strict=True):
        chord, s = field.chord, field.s
        r = field.point(field.places) + w[i]
        position.append(r)
        velocity.append(rate[i])
        links, step = field.places.size - 1, chord.length / (field.places.size - 1)
        tension.append(np.full(links, chord.tension))
        rest = setting.bare[s]
        stretch = rest.strain.mean() if rest is not None else 0.0
        strain.append(np.full(links, stretch if chord.is_string else chord.strain(setting.strands.gravity)))
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
        if response is not None:
            energy[_OF_LOADS] += _energies(response, chord, i)
            energy[_IN_IMPACTS] += response.loss[i]
            for j, k in enumerate(response.system.wheels):
                if not response.on[i, j]:
                    continue
                x = response.place[i, j]
                place[k] = field.point(np.array([x]))[0] + response.wheel[i, j] * chord.across[0]
                hold[k] = 0.0
                if loads.contact[k] == FRICTIONLESS:
                    hold[k] = -response.force[i, j] * response.slope[i, j] * chord.along
                force[k] = response.force[i, j] * chord.across[0] + hold[k]
                xi[k], speed[k], both[k] = x * chord.material / chord.length, speed_at(loads, int(k), t), chord.tension
                seen.state[k] = IN_AIR if response.in_air[i, j] else MOVES
            seen.in_air[response.system.wheels] = response.time_in_air[i]
            for b, body in enumerate(displayed):
                if body.wheel in response.system.wheels:
                    body_place[b], body_speed[b] = _body(response, chord, body, i)
            continue
        for k in setting.on[s]:
            found = field.contact(int(k), t)
            if found is None:
                continue
            x, place[k], slope = found
            given = np.array([force_at(loads, k, t, a) for a in range(dim)])
            hold[k] = 0.0
            if loads.contact[k] == FRICTIONLESS:  # what the slope throws back, or pulls on
                hold[k] = -float(given @ chord.across[0]) * slope * chord.along
            force[k], seen.state[k] = given + hold[k], MOVES
            xi[k], speed[k], both[k] = x * chord.material / chord.length, speed_at(loads, k, t), chord.tension
    return Frame(
        path=t,
        position=np.concatenate(position),
        velocity=np.concatenate(velocity),
        tension=np.concatenate(tension),
        strain=np.concatenate(strain),
        **seen.fields(),
        body_position=body_place,
        body_velocity=body_speed,
        reaction=np.array(reaction),
        energy=energy,
    )


def _energies(response: BodyResponse, chord: Chord, i: int) -> Array:
    """Kinetic and potential energy of the load, J."""
    moved = np.concatenate([response.body[i], response.wheel[i]])
    rates = np.concatenate([response.body_velocity[i], response.wheel_velocity[i]])
    return np.array(response.system.energies(moved, rates, response.velocity, float(chord.start[-1])))


def _body(response: BodyResponse, chord: Chord, body: Body, i: int) -> tuple[Array, Array]:
    """Place and velocity of a body. Heights count from the chord: in this theory loads do not feel the sag."""
    j = response.system.wheels.tolist().index(body.wheel)
    place = chord.start + (response.place[i, j] + body.ahead) * chord.along
    speed = response.velocity * chord.along
    if body.coordinates[-1] >= 0:
        c = response.system.coordinates.index(body.coordinates[-1])
        place[-1] += response.system.rest[c] - response.body[i, c]
        speed[-1] -= response.body_velocity[i, c]
    return place, speed
