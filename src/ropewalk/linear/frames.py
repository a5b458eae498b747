"""Frames of a run of kind linear."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy.sparse as sparse

from ropewalk.linear.body_response import BodyResponse, response_of
from ropewalk.linear.chord import Chord, chords
from ropewalk.linear.field import Field
from ropewalk.mechanics.chain import FRICTIONLESS, REFUSE, Array
from ropewalk.mechanics.moving_contact import speed_at
from ropewalk.mechanics.vehicle_matrices import Body
from ropewalk.model.load import GivenForces
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import ENERGY_FORMS, IN_AIR, MOVES, Contacts, RunInfo
from ropewalk.results.frames import Frames, summed
from ropewalk.solve.start import PreparedRun
from ropewalk.solve.superposition import passed_an_end

_TERMS = 8  # of the static series for each element: the neglected ones change a support force by 4e-4 of the load


def reactions(chord: Chord, gravity: Array, moved: Array, rate: Array, place: Array, force: Array) -> Array:
    """Return the forces of both supports on the line, (instant, end, axis) N.

    Args:
        gravity: (axis,) m/s^2.
        moved, rate: (instant, node, axis) m from rest and m/s, at nodes at equal distances.
        place: (instant, load) m along the chord, NaN off the line.
        force: (instant, load, axis) N, of the loads on the line.
    """
    L, on, across = chord.length, np.isfinite(place), np.eye(chord.along.size) - np.outer(chord.along, chord.along)
    x, P = np.where(on, place, 0.0), np.where(on[..., None], force, 0.0)
    out = -np.einsum("etj,tja->tea", np.stack([1.0 - x / L, x / L]), P) - 0.5 * chord.mass * L * gravity
    out += np.outer([-1.0, 1.0], chord.tension * chord.along)
    n = moved.shape[1] - 1
    if chord.is_string:
        h = L / n
        near = np.stack([np.minimum(y, h) * (L - np.maximum(y, h)) for y in (x, L - x)]) / (L * chord.tension)
        static = np.einsum("etj,tja->tea", near, P @ across)
        return np.asarray(out - chord.tension / h * (moved[:, [1, -2]] - static))
    m = np.arange(1, _TERMS * n)
    k, sign = m * np.pi / L, np.where(m % 2 == 1, 1.0, -1.0)
    elastic, ends = chord.bending_stiffness * k**4 + chord.tension * k**2, np.stack([1.0 / k, sign / k], axis=1)
    follows = pressed(x, P @ across, k) * (2.0 / L) / (elastic + chord.foundation)
    sag = np.outer(across @ gravity, (1.0 + sign) * 2.0 * chord.mass / (L * k * (elastic + chord.foundation)))
    out += ((follows + sag) @ (chord.foundation * ends)).swapaxes(1, 2)
    shape = np.sin(np.outer(k, np.arange(1, n) * (L / n)))
    felt = moved[:, 1:-1] + chord.retardation * rate[:, 1:-1]
    other = (felt.swapaxes(1, 2) - follows @ shape) @ (2.0 / n * shape[: n - 1].T)
    return np.asarray(out - (other @ (elastic[:, None] * ends)[: n - 1]).swapaxes(1, 2))


def pressed(x: Array, force: Array, k: Array) -> Array:
    """(instant, axis, term) N, the sum of the forces times the sines at their places."""
    i, j = np.nonzero(force.any(axis=2))
    sines, rows = np.sin(np.outer(x[i, j], k)), (i, np.arange(i.size))
    size = x.shape[0], i.size
    parts = [sparse.csr_matrix((force[i, j, a], rows), shape=size) @ sines for a in range(force.shape[2])]
    return np.stack(parts, axis=1)


_MANY, _INSTANTS = 480, 200  # modes that stand for all, and instants among those of a run
_LEAST = 0.05  # of the largest value of a line: smaller values are compared with this
_REPORTED = 0.02  # of a value: errors from which on they are reported


def truncation_errors(chord: Chord, links: int, modes: int, place: Array, force: Array) -> dict[str, float]:
    """Return by how much the missing modes change the largest static values anywhere on a line, as parts of these.

    Args:
        links: between its nodes, at which values are compared.
        place: (instant, load) m along the chord, NaN off the line.
        force: (instant, load) N across it.
    """
    on = np.isfinite(place)
    rows = np.flatnonzero(on.any(axis=1))
    rows = rows[:: max(1, rows.size // _INSTANTS)]
    x, F = np.where(on, place, 0.0)[rows], np.where(on, force, 0.0)[rows]
    k: Array = np.arange(1.0, max(_MANY, 4 * modes) + 1.0) * (np.pi / chord.length)
    follows = pressed(x, F[..., None], k)[:, 0] / (
        chord.bending_stiffness * k**4 + chord.tension * k**2 + chord.foundation
    )
    shape = np.sin(np.outer(k, np.linspace(0.0, chord.length, links + 1)))
    moment = shape * k[:, None] ** 2
    quantities = {"deflection": shape, "bending moment": moment, "shear": np.diff(moment, axis=1)}
    if chord.is_string:
        quantities = {"deflection": shape, "slope": np.diff(shape, axis=1)}
    found = dict[str, float]()
    for name, terms in quantities.items():
        whole, kept = (np.abs(follows[:, :n] @ terms[:n]).max(axis=0, initial=0.0) for n in (k.size, modes))
        least = _LEAST * whole.max(initial=0.0)
        found[name] = float((np.abs(kept - whole) / np.maximum(whole, least or 1.0)).max())
    return found


def truncation_warning(name: str, chord: Chord, links: int, modes: int, place: Array, force: Array) -> str:
    """Return a warning of a line whose modes are too few for some quantity; empty where there is none.

    Args:
        chord, links, modes, place, force: see `truncation_errors`.
    """
    errors = truncation_errors(chord, links, modes, place, force)
    if max(errors.values()) <= _REPORTED:
        return ""
    enough = 2 * modes
    while enough < _MANY and max(truncation_errors(chord, links, enough, place, force).values()) > _REPORTED:
        enough *= 2
    missed = ", ".join(f"{100.0 * e:.2g} % of the {what}" for what, e in errors.items() if e > _REPORTED)
    remedy = f"write run.modes: {enough}, or leave it out" if enough < _MANY else "leave run.modes out"
    return f"line {name}: {modes} modes miss up to {missed} under these loads applied statically; {remedy}"


_OF_LOADS = [ENERGY_FORMS.index(form) for form in ("load_kinetic", "load_potential")]
_TOGETHER = 512  # frames that are made at once
_IN_IMPACTS = ENERGY_FORMS.index("contact_dissipation")


def frames(setting: PreparedRun, scenario: Scenario, times: Array, run_info: RunInfo) -> Iterator[Frames]:
    """The frames at the given times, s, some at a time.

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
    pressed = list[tuple[Array, Array]]()
    for first in range(0, times.size, _TOGETHER):
        found = _frames(setting, fields, responses, nodes, times, slice(first, min(first + _TOGETHER, times.size)))
        pressed.append((found.of["contact_xi"], found.of["contact_force"]))
        yield found
    run_info.warnings += _missed_by_modes(setting, fields, pressed)


def _missed_by_modes(
    setting: PreparedRun, fields: list[Field], pressed: list[tuple[Array, Array]]
) -> Iterator[str]:  # fmt: skip
    """Warnings of lines on which a given number of modes leaves much of the static response out.

    Args:
        setting: the run.
        fields: its lines.
        pressed: places (instant, load), m, and forces of its loads, (instant, load, axis) N.
    """
    where, force = (np.concatenate(parts) for parts in zip(*pressed, strict=True))
    for field in fields:
        own, chord = setting.on[field.s], field.chord
        if field.modes is None or not own.size:
            continue
        place, name = where[:, own] * (chord.length / chord.material), setting.lines[field.s]
        across = force[:, own] @ chord.across[0]
        if warning := truncation_warning(name, chord, field.places.size - 1, field.modes, place, across):
            yield warning


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


def _frames(
    setting: PreparedRun,
    fields: list[Field],
    responses: list[BodyResponse | None],
    nodes: list[tuple[Array, Array]],
    times: Array,
    rows: slice,
) -> Frames:
    """The frames of some instants."""
    dim, t = len(setting.axes), times[rows]
    seen = Contacts(t.size, setting.xi.size, dim)
    position, velocity, tension, strain, reaction = [], [], [], [], []
    energy = np.full((t.size, len(ENERGY_FORMS)), np.nan)
    energy[:, :3] = 0.0
    if any(response is not None for response in responses):
        energy[:, _OF_LOADS] = 0.0
        energy[:, _IN_IMPACTS] = 0.0
    displayed = setting.multibody_system.displayed if setting.multibody_system is not None else ()
    body_place, body_speed = np.full((2, t.size, len(displayed), dim), np.nan)
    for field, response, (w, rate) in zip(fields, responses, nodes, strict=True):
        chord, s = field.chord, field.s
        moved = w[rows]
        r = field.point(field.places) + moved
        position.append(r)
        velocity.append(rate[rows])
        links, step = field.places.size - 1, chord.length / (field.places.size - 1)
        tension.append(np.full((t.size, links), chord.tension))
        rest = setting.bare[s]
        if chord.is_string:
            stretch = float(rest.strain.mean()) if rest is not None else 0.0
        else:
            stretch = chord.strain(setting.strands.gravity)
        strain.append(np.full((t.size, links), stretch))
        tilt = np.diff(r, axis=1) / step
        lumped = np.full(links + 1, chord.mass * step)
        lumped[[0, -1]] *= 0.5
        bent = np.diff(r, 2, axis=1) / step**2
        energy[:, 0] += 0.5 * (rate[rows] ** 2).sum(axis=2) @ lumped
        energy[:, 1] += 0.5 * chord.tension * step * summed((tilt - chord.along) ** 2)
        energy[:, 1] += 0.5 * chord.bending_stiffness * step * summed(bent**2)
        energy[:, 1] += 0.5 * chord.foundation * step * summed(moved**2)
        energy[:, 2] -= (r @ setting.strands.gravity) @ lumped
        if response is None:
            here = field.contacts(times, rows).fields()
            for name, values in seen.fields().items():
                values[:, setting.on[s]] = here[name]
        else:
            for i in range(rows.start, rows.stop):
                energy[i - rows.start, _OF_LOADS] += _energies(response, chord, i)
            energy[:, _IN_IMPACTS] += response.loss[rows]
            _bodies(seen, setting, field, response, t, rows)
            for b, body in enumerate(displayed):
                if body.wheel in response.system.wheels:
                    for i in range(t.size):
                        body_place[i, b], body_speed[i, b] = _body(response, field, body, rows.start + i)
        own = setting.on[s]
        place = seen.xi[:, own] * (chord.length / chord.material)
        supported = reactions(chord, setting.strands.gravity, moved, rate[rows], place, seen.force[:, own])
        reaction += [supported[:, 0], supported[:, 1]]
    return Frames(
        t,
        {
            "position": np.concatenate(position, axis=1), "velocity": np.concatenate(velocity, axis=1),
            "tension": np.concatenate(tension, axis=1), "strain": np.concatenate(strain, axis=1), **seen.fields(),
            "body_position": body_place, "body_velocity": body_speed, "reaction": np.stack(reaction, axis=1),
            "energy": energy,
        },
    )  # fmt: skip


def _bodies(seen: Contacts, setting: PreparedRun, field: Field, response: BodyResponse, t: Array, rows: slice) -> None:
    """Put down what frames tell of the wheels of a load with a mass."""
    loads, chord, across = setting.loads, field.chord, field.chord.across[0]
    seen.in_air[:, response.system.wheels] = response.time_in_air[rows]
    for j, k in enumerate(response.system.wheels):
        on = np.flatnonzero(response.on[rows, j])
        there = on + rows.start
        x, force = response.place[there, j], response.force[there, j]
        seen.position[on, k] = field.point(x) + response.wheel[there, j, None] * across
        hold = np.zeros((on.size, across.size))
        if loads.contact[k] == FRICTIONLESS:
            hold = (-force * response.slope[there, j])[:, None] * chord.along
        seen.hold[on, k], seen.force[on, k] = hold, force[:, None] * across + hold
        seen.xi[on, k] = x * chord.material / chord.length
        seen.speed[on, k] = [speed_at(loads, int(k), time) for time in t[on]]
        seen.tension[on, k] = chord.tension
        seen.state[on, k] = np.where(response.in_air[there, j], IN_AIR, MOVES)


def _energies(response: BodyResponse, chord: Chord, i: int) -> Array:
    """Kinetic and potential energy of the load, J."""
    moved = np.concatenate([response.body[i], response.wheel[i]])
    rates = np.concatenate([response.body_velocity[i], response.wheel_velocity[i]])
    return np.array(response.system.energies(moved, rates, response.velocity, float(chord.start[-1])))


def _body(response: BodyResponse, field: Field, body: Body, i: int) -> tuple[Array, Array]:
    """Place of a body on the sag of the line, and its velocity, without the sag: here loads do not feel it."""
    system, chord = response.system, field.chord
    j = system.wheels.tolist().index(body.wheel)
    place = chord.start + (response.place[i, j] + field.scales[body.wheel] * body.ahead) * chord.along
    speed = response.velocity * chord.along
    if body.coordinates[-1] >= 0:
        c, own = system.coordinates.index(body.coordinates[-1]), response.body.shape[1]
        sag = chord.sag(np.clip(response.place[i], 0.0, chord.length), field.setting.strands.gravity)[:, -1]
        follows = np.linalg.lstsq(system.stiffness[:own, :own], -system.stiffness[:own, own:] @ sag)[0]
        place[-1] += system.rest[c] - response.body[i, c] + follows[c]
        speed[-1] -= response.body_velocity[i, c]
    return place, speed
