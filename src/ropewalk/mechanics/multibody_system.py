"""Fleets: all loads that have a mass, from their declarations to the arrays of `Bodies`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.assembly import components, drive_table
from ropewalk.mechanics.bodies import (
    ALONG_X,
    BUFFER,
    COORDINATE,
    EVEN,
    FREE,
    GIVEN,
    PULLS,
    PUSHES,
    TETHER,
    VEHICLE,
    Bodies,
    without_vehicles,
)
from ropewalk.mechanics.carriage_masses import carriage
from ropewalk.mechanics.chain import Array, Strands
from ropewalk.mechanics.compiled import filled_records, records
from ropewalk.mechanics.contact_points import ContactPoint
from ropewalk.mechanics.pantograph_matrices import vehicle_of as pantograph_of
from ropewalk.mechanics.proximity import shares_links
from ropewalk.mechanics.sideways import Sideways
from ropewalk.mechanics.vehicle_matrices import Body, VehicleMatrices
from ropewalk.model.carriage import Carriage
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.load import AnyLoad, ExternalModel, GivenForces
from ropewalk.model.matrices import Matrices
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.scenario import Scenario
from ropewalk.model.trolley import Payload, Trolley
from ropewalk.model.vehicle import Vehicle
from ropewalk.model.walker import Walker

# A wheel has its own place on the chain from this part of the mass of a link on.
HEAVY = 1.0
# Part of a link, within which a support bears a wheel: below, the piece between them would need smaller steps.
LEAST_CAPACITY, MOST_CAPACITY, CAPACITY_PER_MASS = 0.005, 0.25, 0.5
# Distance from a support at which the line ends for a mass, as a part of a link.
MARGIN = 0.25
# Light wheels that come closer than this many links would share a node, which carries the mass of one only: they get
# places of their own, and one of next to no mass borrows this part of that of a link, without weight.
SHARES_LINKS, BORROWED = 2.0, 0.2
# Mass of what only its owner moves, such as who is on firm ground, kg.
FIRM = 1e30
# Stretch of the rope of a payload under its weight where its stiffness is not given, m.
STRETCH = 1e-3


@dataclass(frozen=True)
class MultibodySystem:
    """All that has a mass, at the beginning."""

    bodies: Bodies
    displayed: tuple[Body, ...]
    interface_coordinates: Mapping[
        str, tuple[int, ...]
    ]  # of external loads: coordinates that stand for their contacts, in order


def multibody_system_of(
    scenario: Scenario, wheels: Sequence[ContactPoint], strands: Strands | None, axes: tuple[str, ...], until: float
) -> MultibodySystem:
    """Put together all loads of a scenario.

    Args:
        scenario: what is there.
        wheels: its wheels, in order.
        strands: its lines; what depends on the mesh is which wheels are heavy, and how far from supports they stay.
            None: nobody asks for that.
        axes: names of the axes.
        until: how long tables are needed, s.

    Raises:
        RopewalkError: a vehicle's matrices cannot be used.
    """
    dim = len(axes)
    bodies = without_vehicles(len(wheels))
    vehicles: list[VehicleMatrices] = []
    displayed: list[Body] = []
    interface_coordinates: dict[str, tuple[int, ...]] = {}
    for name, load in scenario.loads.items():
        if isinstance(load, GivenForces):
            continue
        on = [k for k, wheel in enumerate(wheels) if wheel.load == name]
        first = sum(v.coordinates for v in vehicles)
        vehicle: VehicleMatrices | None
        if isinstance(load, Pantograph):
            vehicle, own = pantograph_of(name, load, on, [wheels[k].ahead for k in on], dim, first)
        else:
            vehicle, own = _vehicle(name, load, on, dim, first, scenario.gravity, axes)
        if isinstance(load, Walker | Footsteps) and load.balance is not None and vehicle is not None:
            vehicle = _balancing(vehicle, on, Sideways.of(scenario, load, "left").side[0])
        displayed += own
        if vehicle is not None:
            vehicles.append(vehicle)
            if isinstance(load, ExternalModel):
                interface_coordinates[name] = tuple(range(first, first + vehicle.coordinates))
    _fill_wheels(bodies, wheels, dim)
    close = _crowd(scenario, wheels, strands, until) if strands is not None else set[int]()
    if strands is not None:
        _fit_to_mesh(bodies, wheels, strands, list(scenario.lines), vehicles, close)
    bodies = _with_drives(bodies, wheels, until)
    return MultibodySystem(_with_vehicles(bodies, vehicles), tuple(displayed), interface_coordinates)


def hung(payload: Payload, stiffness: float, gravity: float, axes: tuple[str, ...]) -> Array:
    """Where a payload hangs at the beginning, seen from its trolley, (axis,) m.

    Args:
        payload: what is declared of it.
        stiffness: of its rope, N/m.
        gravity: m/s^2.
        axes: names of the axes.
    """
    if payload.at is not None:
        return components(payload.at, axes)
    length = payload.length + payload.mass * gravity * np.cos(payload.swing) / stiffness
    way = np.zeros(len(axes))
    way[0], way[-1] = np.sin(payload.swing), -np.cos(payload.swing)
    return np.asarray(length * way)


def static_loads(load: Vehicle, gravity: float = 0.0) -> list[float]:
    """Forces in N with which the wheels of a vehicle press on level ground at rest, in order.

    Args:
        load: what is declared of it.
        gravity: that of the scenario, m/s^2, which acts on it if it has none of its own.
    """
    wheels = list(load.wheels.values())
    own = load.gravity if load.gravity is not None else gravity
    vehicle, _ = _sprung("", load, list(range(len(wheels))), 1, 0, own)
    if vehicle is None:
        return [wheel.mass * own for wheel in wheels]
    K, n = vehicle.K[: vehicle.coordinates, : vehicle.coordinates].copy(), vehicle.coordinates
    for buffer in vehicle.buffers:
        K[buffer["coordinate"], buffer["coordinate"]] += buffer["stiffness"]
    rest = np.linalg.solve(K, vehicle.load[:n])
    rigid = {k: row for (k, _), row in zip(vehicle.locations, vehicle.K[n:, :n] @ rest, strict=True)}
    soft = {buffer["wheel"]: -buffer["stiffness"] * rest[buffer["coordinate"]] for buffer in vehicle.buffers}
    return [float(soft[k] if k in soft else wheel.mass * own + rigid[k]) for k, wheel in enumerate(wheels)]


def _fill_wheels(bodies: Bodies, wheels: Sequence[ContactPoint], dim: int) -> None:
    for k, wheel in enumerate(wheels):
        record = bodies.wheels[k]
        record["mass"][: dim - 1] = wheel.mass + wheel.across
        record["mass"][dim - 1] = wheel.mass
        record["air_drag"], record["lift"] = wheel.air_drag, wheel.lift
        record["travel"] = EVEN if wheel.contact == "frictionless" else GIVEN
        if wheel.measured == "horizontal":
            record["travel"] = ALONG_X
        free = wheel.free
        if free is not None:
            record["travel"], record["rolling"], record["viscous"] = FREE, free.rolling, free.viscous
            record["driver"] = free.driver.force if free.driver is not None else 0.0


def _crowd(scenario: Scenario, wheels: Sequence[ContactPoint], strands: Strands, until: float) -> set[int]:
    """Wheels that come close to others."""
    forces = {name for name, load in scenario.loads.items() if isinstance(load, GivenForces)}
    h = dict(zip(scenario.lines, strands.h, strict=True))
    lengths = {name: float(h[name] * n) for name, n in zip(scenario.lines, strands.links, strict=True)}
    return shares_links(wheels, forces, {name: SHARES_LINKS * float(size) for name, size in h.items()}, lengths, until)


def _fit_to_mesh(
    bodies: Bodies,
    wheels: Sequence[ContactPoint],
    strands: Strands,
    lines: list[str],
    vehicles: list[VehicleMatrices],
    close: set[int],
) -> None:  # fmt: skip
    for k, (record, wheel) in enumerate(zip(bodies.wheels, wheels, strict=True)):
        s = lines.index(wheel.on)
        h, m, mass = float(strands.h[s]), float(strands.rho[s] * strands.h[s]), wheel.mass
        if k in close and mass < BORROWED * m:  # as the mesh is refined, what it borrows vanishes
            record["mass"] += BORROWED * m - mass
            _bear(vehicles, k, (mass - BORROWED * m) * strands.gravity)
            mass = BORROWED * m
        record["heavy"] = mass > 0.0 and (
            mass >= HEAVY * m
            or wheel.free is not None
            or wheel.lift != 0
            or wheel.margin is not None
            or record["travel"] in (EVEN, ALONG_X)
            or k in close
        )
        if record["heavy"]:
            record["clearance"] = h * np.clip(CAPACITY_PER_MASS * m / mass, LEAST_CAPACITY, MOST_CAPACITY)
        else:
            record["travel"] = GIVEN
        record["margin"] = wheel.margin if wheel.margin is not None else (MARGIN * h if record["heavy"] else 0.0)
        if wheel.free is not None and wheel.free.brake is not None:
            brake, length = wheel.free.brake, h * float(strands.links[s])
            record["brake"] = brake.force or 0.0
            if brake.at in ("start", "both"):
                record["brake_start"] = brake.within
            if brake.at in ("end", "both"):
                record["brake_end"] = length - brake.within


def _bear(vehicles: list[VehicleMatrices], k: int, force: Array) -> None:
    """Let a force in N on wheel k, (axis,), bear the weight of what it borrows."""
    locations = {location for vehicle in vehicles for location in vehicle.locations}
    own = [(k, axis) for axis in range(force.size) if (k, axis) not in locations and force[axis]]
    if own:
        vehicles.append(VehicleMatrices.of(0, own))
    for vehicle in vehicles:
        for j, (number, axis) in enumerate(vehicle.locations):
            if number == k:
                vehicle.load[vehicle.coordinates + j] += force[axis]


def _with_drives(bodies: Bodies, wheels: Sequence[ContactPoint], until: float) -> Bodies:
    tables = [drive_table(w.free.drive if w.free is not None else 0.0, until) for w in wheels]
    counts = np.array([t.size for t, _ in tables], dtype=np.int64)
    bodies.wheels["drive_count"] = counts
    bodies.wheels["drive_first"] = np.cumsum(counts) - counts
    none = np.zeros(0)
    return bodies._replace(
        drive_time=np.concatenate([none, *(t for t, _ in tables)]),
        drive_value=np.concatenate([none, *(v for _, v in tables)]),
    )


def _with_vehicles(bodies: Bodies, vehicles: list[VehicleMatrices]) -> Bodies:
    size = max((v.load.size for v in vehicles), default=1)
    places = max((len(v.locations) for v in vehicles), default=1) or 1
    count = len(vehicles)
    rows = records(count, VEHICLE)
    wheel, axis = np.zeros((count, places), dtype=np.int64), np.zeros((count, places), dtype=np.int64)
    M, C, K = (np.zeros((count, size, size)) for _ in range(3))
    load, first = np.zeros((count, size)), 0
    coordinates = records(sum(v.coordinates for v in vehicles), COORDINATE)
    for i, v in enumerate(vehicles):
        n = v.load.size
        M[i, :n, :n], C[i, :n, :n], K[i, :n, :n], load[i, :n] = v.M, v.C, v.K, v.load
        for j, (k, a) in enumerate(v.locations):
            wheel[i, j], axis[i, j] = k, a
        rows[i] = (first, v.coordinates, len(v.locations), v.C.any(), not (v.M - np.diag(np.diag(v.M))).any())
        for d, drag in v.drag.items():
            coordinates[first + d]["drag"] = drag
        first += v.coordinates
    return bodies._replace(
        vehicles=rows, wheel=wheel, axis=axis, M=M, C=C, K=K, load=load, coordinates=coordinates,
        tethers=filled_records(TETHER, [t for v in vehicles for t in v.tethers]),
        buffers=filled_records(BUFFER, [b for v in vehicles for b in v.buffers]),
        A=np.zeros((size, size + 2)), b=np.zeros(size),
    )  # fmt: skip


def _vehicle(
    name: str, load: AnyLoad, on: list[int], dim: int, first: int, gravity: float, axes: tuple[str, ...]
) -> tuple[VehicleMatrices | None, list[Body]]:
    """The vehicle above the wheels `on` of a load, if there is one, and what of it results show."""
    numbers = tuple(range(first, first + dim))
    if isinstance(load, Oscillator):
        soft = load.contact_stiffness is not None
        displayed = Body(name, on[0], 0.0, (-1,) * (dim - 1) + (first,) if soft else numbers, load.mass)
        return _oscillator(load, on[0], dim, first, gravity, axes), [displayed]
    if isinstance(load, Trolley):
        payload = load.payload
        stiffness = payload.stiffness or payload.mass * gravity / STRETCH
        tether = {
            "wheel": on[0], "first": first, "length": payload.length, "full": payload.length, "stiffness": stiffness,
            "damping": payload.damping, "way": PULLS, "on": 1,
        }  # fmt: skip
        vehicle = _particle(payload.mass, dim, gravity, payload.air_drag)
        vehicle.tethers.append(tether)
        return vehicle, [Body(f"{name}.payload", on[0], 0.0, numbers, payload.mass)]
    if isinstance(load, Carriage):
        return carriage(name, load, on, dim, first, gravity)
    if isinstance(load, Walker):
        vehicle = _particle(load.mass, dim, gravity, 0.0)
        for foot in on:
            vehicle.tethers.append(
                {
                    "wheel": foot, "first": first, "length": load.leg_length, "full": load.leg_length,
                    "stiffness": load.leg_stiffness, "damping": load.leg_damping, "way": PUSHES, "on": 0,
                }
            )  # fmt: skip
        return vehicle, [Body(name, on[0], 0.0, numbers, load.mass)]
    if isinstance(load, Footsteps) and load.balance is not None:  # a body that moves to the side alone
        vehicle = VehicleMatrices.of(1, [])
        vehicle.M[:] = load.mass
        return vehicle, []
    if isinstance(load, Vehicle):
        return _sprung(name, load, on, dim, first, gravity)
    if isinstance(load, Matrices):
        return _given(name, load, on, dim, first, gravity)
    if isinstance(load, ExternalModel):
        return _interface(load, on, dim), []
    return None, []


def _interface(load: ExternalModel, on: list[int], dim: int) -> VehicleMatrices | None:
    """Springs and dampers between the contacts of an external load and heights that its owner alone moves."""
    if not (load.exchange.stiffness or load.exchange.damping):
        return None
    vehicle = VehicleMatrices.of(len(on), [(k, dim - 1) for k in on])
    for i in range(len(on)):
        vehicle.M[i, i] = FIRM
        row = np.zeros(2 * len(on))
        row[i], row[len(on) + i] = 1.0, -1.0
        vehicle.join(row, load.exchange.stiffness, load.exchange.damping)
    return vehicle


def _particle(mass: float, dim: int, gravity: float, drag: float) -> VehicleMatrices:
    vehicle = VehicleMatrices.of(dim, [])
    vehicle.M[:] = mass * np.eye(dim)
    vehicle.load[-1] = -mass * gravity
    if drag:
        vehicle.drag[0] = drag
    return vehicle


def _balancing(walker: VehicleMatrices, on: list[int], left: Array) -> VehicleMatrices:
    """A person in space whose legs do not act to the side, where controllers/balance.py keeps her upright.

    One more coordinate is the offset of the foot that bears from the line. Nothing moves it but a step.
    """
    dim = walker.coordinates
    vehicle = VehicleMatrices.of(dim + 1, [(k, int(a)) for k in on for a in np.flatnonzero(left)])
    vehicle.M[:dim, :dim], vehicle.M[dim, dim] = walker.M, FIRM
    vehicle.load[:dim] = walker.load
    across = np.append(left, 0.0)
    vehicle.tethers += [{**tether, "across": across} for tether in walker.tethers]
    return vehicle


def _oscillator(
    load: Oscillator, wheel: int, dim: int, first: int, gravity: float, axes: tuple[str, ...]
) -> VehicleMatrices:
    k, c = (
        components(value, axes) if isinstance(value, tuple) else np.full(dim, value)
        for value in (load.stiffness, load.damping)
    )
    if load.contact_stiffness is not None:  # up and down only: mass, wheel, and the buffer below it
        vehicle = VehicleMatrices.of(2, [])
        vehicle.M[:] = np.diag([load.mass, load.wheel_mass])
        vehicle.join(np.array([1.0, -1.0]), float(k[-1]), float(c[-1]))
        vehicle.load[:] = -gravity * np.diag(vehicle.M)
        vehicle.buffers.append(
            {"wheel": wheel, "coordinate": first + 1, "stiffness": load.contact_stiffness, "side": _side(load.side)}
        )
        return vehicle
    vehicle = VehicleMatrices.of(dim, [(wheel, a) for a in range(dim)])
    for a in range(dim):
        vehicle.M[a, a] = load.mass
        row = np.zeros(2 * dim)
        row[a], row[dim + a] = 1.0, -1.0
        vehicle.join(row, float(k[a]), float(c[a]))
    vehicle.load[dim - 1] = -load.mass * gravity
    if load.air_drag:
        vehicle.drag[0] = load.air_drag
    return vehicle


def _side(side: str) -> int:
    return 1 if side == "above" else -1


def _sprung(
    name: str, load: Vehicle, on: list[int], dim: int, first: int, gravity: float
) -> tuple[VehicleMatrices | None, list[Body]]:
    """Bodies on springs: heights, pitches, and the heights of wheels with a soft contact; rigid wheels are places."""
    own = load.gravity if load.gravity is not None else gravity
    index: dict[tuple[str, str], int] = {}
    for part, body in load.bodies.items():
        index[part, "height"] = len(index)
        if body.inertia:
            index[part, "pitch"] = len(index)
    for part, wheel in load.wheels.items():
        if wheel.contact_stiffness is not None:
            index[part, "height"] = len(index)
    coordinates = len(index)
    locations = []
    for k, (part, wheel) in zip(on, load.wheels.items(), strict=True):
        if wheel.contact_stiffness is None:
            index[part, "height"] = len(index)
            locations.append((k, dim - 1))
    if not coordinates and own == gravity:
        return None, []
    vehicle = VehicleMatrices.of(coordinates, locations)
    displayed = []
    for j, wheel in enumerate(w for w in load.wheels.values() if w.contact_stiffness is None):
        vehicle.load[coordinates + j] = -wheel.mass * (own - gravity)  # with that of the scenario all wheels weigh
    for part, body in load.bodies.items():
        i = index[part, "height"]
        vehicle.M[i, i] = body.mass
        vehicle.load[i] = -body.mass * own
        if body.inertia:
            j = index[part, "pitch"]
            vehicle.M[j, j] = body.inertia
        wheels = {k: w.at for k, w in zip(on, load.wheels.values(), strict=True)}
        displayed.append(Body.over(f"{name}.{part}", wheels, body.at, (-1,) * (dim - 1) + (first + i,), body.mass))
    for k, (part, wheel) in zip(on, load.wheels.items(), strict=True):
        if wheel.contact_stiffness is not None:
            i = index[part, "height"]
            vehicle.M[i, i] = wheel.mass
            vehicle.load[i] = -wheel.mass * own
            vehicle.buffers.append(
                {"wheel": k, "coordinate": first + i, "stiffness": wheel.contact_stiffness, "side": _side(load.side)}
            )
    for spring in load.springs.values():
        row, at = np.zeros(len(index)), load.place_of(spring)
        for sign, part in zip((1.0, -1.0), spring.between, strict=True):
            row[index[part, "height"]] += sign
            if (part, "pitch") in index:
                row[index[part, "pitch"]] += sign * (at - load.bodies[part].at)
        vehicle.join(row, spring.stiffness, spring.damping)
    return vehicle, displayed


def _given(
    name: str, load: Matrices, on: list[int], dim: int, first: int, gravity: float
) -> tuple[VehicleMatrices | None, list[Body]]:
    """A vehicle given by matrices: the coordinates of its wheels put last, their own mass left to the wheels."""
    followers = [load.coordinates.index(wheel.coordinate) for wheel in load.wheels.values()]
    own = [i for i in range(len(load.coordinates)) if i not in followers]
    order = np.array([*own, *followers])
    pick = np.ix_(order, order)
    vehicle = VehicleMatrices.of(len(own), [(k, dim - 1) for k in on])
    M = np.array(load.mass)
    if np.linalg.eigvalsh(M).min() < -1e-9 * max(float(np.abs(M).max()), 1e-300):
        raise RopewalkError(f"load {name}: the mass matrix has a negative eigenvalue; check its signs")
    inner = M[np.ix_(own, own)]
    if own and np.linalg.eigvalsh(inner).min() <= 1e-12 * float(np.abs(M).max()):
        raise RopewalkError(f"load {name}: a coordinate without a wheel has no mass; give it some, or eliminate it")
    weight = np.array(load.weight) if load.weight is not None else M.sum(axis=1) * gravity
    vehicle.M[:], vehicle.K[:] = M[pick], np.array(load.stiffness)[pick]
    if load.damping is not None:
        vehicle.C[:] = np.array(load.damping)[pick]
    vehicle.load[:] = -weight[order]
    for i in range(len(own), order.size):
        vehicle.load[i] += vehicle.M[i, i] * gravity
        vehicle.M[i, i] = 0.0
    wheels, level = {k: w.at for k, w in zip(on, load.wheels.values(), strict=True)}, (-1,) * (dim - 1)
    displayed = [
        Body.over(f"{name}.{load.coordinates[i]}", wheels, 0.0, (*level, first + j), float(M[i, i]))
        for j, i in enumerate(own)
    ]
    is_more = any(part.any() for part in (vehicle.M, vehicle.C, vehicle.K, vehicle.load))  # than masses on wheels
    return (vehicle if own or is_more else None), displayed
