"""From a scenario with stiff lines to a task: lines become wires, loads become moving loads."""

from __future__ import annotations

from functools import partial

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import MATERIAL, Loads
from ropewalk.mechanics.loading import Loading
from ropewalk.mechanics.moving_contact import force_at
from ropewalk.mechanics.travelled import Travelled
from ropewalk.model.line import Line, spatial
from ropewalk.model.load import AnyLoad, GivenForces
from ropewalk.model.support import Guided
from ropewalk.solve.multibody import Multibody, multibody_of
from ropewalk.wires.ends import compliance, kinds_of, lengthened
from ropewalk.wires.plan import Array, Contact, TravellingLoad, Wire
from ropewalk.wires.prescribed_motion import ON_GROUND, PrescribedMotion
from ropewalk.wires.task import Displayed


def wire_of(name: str, line: Line) -> Wire:
    """A line as a wire; its tension is that of the straight line of given length, or what pulls at a guided end.

    Supports that give way along the line, and their displacements there at the beginning, count.
    """
    EA, pulled, length = line.axial_stiffness or 0.0, _pulled(line), line.length or np.inf
    reach = line.distance + lengthened(line)
    tension = line.tension if line.tension is not None else EA * (reach - length) / (length + EA * compliance(line))
    if pulled is not None:
        tension = pulled
    return Wire(
        name, spatial(line.start), spatial(line.end), tension, line.mass, line.bending_stiffness, EA,
        line.alpha, line.beta, line.foundation, kinds_of(line), line.length, stretched=False,
    )  # fmt: skip


def _pulled(line: Line) -> float | None:
    """What pulls outwards along x at an end that nothing else holds along it, N: the least of both."""
    found = [
        sign * support.force * float(np.sign(support.along[0]))
        for sign, support in zip((-1.0, 1.0), (line.start_support, line.end_support), strict=True)
        if isinstance(support, Guided) and support.along[0] and not support.stiffness
    ]
    return min(found, default=None)


def prescribed_motion_of(
    loading: Loading, name: str, load: AnyLoad, number: int, wire: Wire
) -> tuple[PrescribedMotion, Multibody | None]:
    """The prescribed motion of a load on its wire, and how it was put together if it has a mass.

    Args:
        number: of the wire.
        wire: the line that it travels on, or a contact wire.

    Raises:
        RopewalkError: its matrices cannot be used.
    """
    wheels = np.flatnonzero([wheel.load == name for wheel in loading.wheels])
    starts = np.array([loading.wheels[int(k)].start for k in wheels])
    behind = starts.max() - starts
    material = bool(loading.loads.measure[wheels[0]] == MATERIAL)
    scale = 1.0 if material else wire.length / abs(wire.end[0] - wire.start[0])
    course = _course(loading.loads, int(wheels[np.argmax(starts)]), scale)
    place, settled = partial(course.at, start=scale * float(starts.max())), course.settled
    if isinstance(load, GivenForces):
        up, none = len(loading.axes) - 1, np.zeros((0, 0))
        contacts = [Contact(number, behind=float(scale * d), stiffness=0.0, material=material) for d in behind]
        moving_load = TravellingLoad(name, none, none, none, tuple(contacts))

        def given(times: Array) -> Array:
            found = np.empty((times.size, wheels.size))
            for i, k in enumerate(wheels):
                steady = loading.loads.force_count[k] == 1
                instants = times[:1] if steady else times
                found[:, i] = [force_at(loading.loads, int(k), float(t), up) for t in instants]
            return found

        return PrescribedMotion(moving_load, place, given=given, settled=settled), None
    system = multibody_of(loading, name, load, behind)
    moving_load = _moving_load(system, name, load, number, scale * behind, wire.start[2], material=material)
    return PrescribedMotion(moving_load, place, settled=settled, beside=ON_GROUND, stands=True), system


def _course(loads: Loads, k: int, scale: float) -> Travelled:
    """Return the travel of load k along its wire: `scale` times as fast as its speed says."""
    part = slice(int(loads.speed_first[k]), int(loads.speed_first[k] + loads.speed_count[k]))
    return Travelled(loads.speed_time[part], scale * loads.speed_value[part])


def _moving_load(
    system: Multibody, name: str, load: AnyLoad, wire: int, behind: Array, ground: float, *, material: bool
) -> TravellingLoad:
    """Coordinates and heavy wheels move up from rest on ground as high as the start; light wheels follow the wire."""
    M, C, K = system.mass, system.damping, system.stiffness
    own = M.shape[0] - behind.size
    light = np.array([j for j in range(own, M.shape[0]) if M[j, j] == 0.0], dtype=np.int64)
    keep = np.array([i for i in range(M.shape[0]) if i not in light], dtype=np.int64)
    reduced = K[np.ix_(keep, keep)].copy(), C[np.ix_(keep, keep)].copy()
    lifts, below = bool(getattr(load, "lift_off", False)), getattr(load, "side", "above") == "below"
    contacts = []
    for j, distance in enumerate(behind):
        location, row, stiffness, damping = own + j, np.zeros(keep.size), np.inf, 0.0
        if location in light:
            stiffness, damping = float(K[location, location]), float(C[location, location])
            row = -K[location, keep] / stiffness
            if not np.allclose(C[location, keep], -damping * row, rtol=1e-9, atol=1e-12 * (damping + 1e-300)):
                raise RopewalkError(
                    f"load {name}: springs and dampers of a wheel without mass join it to different places; give the "
                    "wheel a mass"
                )
            reduced[0][:] -= stiffness * np.outer(row, row)
            reduced[1][:] -= damping * np.outer(row, row)
        else:
            row[np.flatnonzero(keep == location)[0]] = 1.0
        rest = -float(system.static_load[j])
        contacts.append(
            Contact(
                wire, tuple(row), float(distance), material=material, stiffness=stiffness, damping=damping,
                base=ground, rest=rest, below=below, lifts_off=lifts,
            )
        )  # fmt: skip
    return TravellingLoad(name, M[np.ix_(keep, keep)], reduced[1], reduced[0], tuple(contacts))


def displayed_of(loading: Loading, system: Multibody, prescribed_motion: int, wire: Wire) -> list[Displayed]:
    """The bodies of a load that results show: what moves up and down."""
    assert loading.multibody_system is not None
    heavy = int((np.diag(system.mass) > 0.0).sum())
    found = []
    for body in loading.multibody_system.displayed:
        if body.wheel in system.wheels and body.coordinates[-1] in system.coordinates:
            c = system.coordinates.index(body.coordinates[-1])
            base = wire.start[2] + float(system.rest[c])
            own = system.wheels.tolist()
            between = tuple((own.index(k), part) for k, part, _ in body.between)
            row, wheel, ahead = np.eye(heavy)[c], own.index(body.wheel), 0.0 if between else body.ahead
            found.append(Displayed(body.name, prescribed_motion, row, base, ahead, wheel, between))
    return found
