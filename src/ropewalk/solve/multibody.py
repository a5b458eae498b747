"""A load with a mass as a linear multibody system of its own: heights of its bodies and of its wheels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.bodies import Bodies
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.loading import Loading
from ropewalk.mechanics.moving_contact import force_at
from ropewalk.model.load import AnyLoad
from ropewalk.model.oscillator import Oscillator


@dataclass(frozen=True)
class Multibody:
    """A load as M u'' + C u' + K u = forces of the line on its wheels, and what leads back to the load.

    Coordinates are those of the bodies first, then one for each wheel.
    """

    load: AnyLoad
    wheels: Integers  # (wheel,) contacts of the result
    mass: Array  # (coordinate and wheel, coordinate and wheel) kg
    damping: Array  # N s/m
    stiffness: Array  # N/m
    axles: Array  # (wheel,) m behind the foremost one
    static_load: Array  # (wheel,) N, on the line at rest on level ground
    coordinates: tuple[int, ...]  # number in the multibody system of each body coordinate
    rest: Array  # (coordinate,) value at rest on level ground, of heights over it, m
    weights: Array  # (coordinate and wheel,) N
    carried: float  # kg, of all that moves along

    def energies(self, body: Array, rates: Array, velocity: float, level: float) -> tuple[float, float]:
        """Kinetic and potential energy, J, the latter zero at height 0.

        Args:
            body: displacements of coordinates and wheels downwards, m.
            rates: their velocities, m/s.
            velocity: along the line, m/s.
            level: height of the line's chord, m.
        """
        height = np.concatenate([self.rest, np.zeros(self.wheels.size)]) - body
        kinetic = 0.5 * self.carried * velocity**2 + 0.5 * float(rates @ self.mass @ rates)
        stored = 0.5 * float(height @ self.stiffness @ height)
        return kinetic, stored + float(self.weights @ height) + float(self.weights.sum()) * level


def multibody_of(loading: Loading, name: str, load: AnyLoad, axles: Array) -> Multibody:
    """Put together the vehicle of a load: of an oscillator the height alone, of the rest everything.

    Args:
        axles: (wheel,) m, distances of the wheels behind the foremost one.

    Raises:
        RopewalkError: the coordinates are not held by springs, or have no mass, or are turned by gyroscopic forces.
    """
    assert loading.multibody_system is not None
    bodies, dim = loading.multibody_system.bodies, len(loading.axes)
    wheels = np.flatnonzero([wheel.load == name for wheel in loading.wheels])
    mass = bodies.wheels["mass"][wheels, dim - 1]
    carried = float(bodies.wheels["mass"][wheels, 0].sum())
    own = np.zeros(0, dtype=np.int64)
    M, K, C, given = np.diag(mass), np.zeros((mass.size, mass.size)), np.zeros((mass.size, mass.size)), np.zeros(0)
    first = 0
    if (i := _vehicle_of(bodies, wheels)) is not None:
        count, first = int(bodies.vehicles[i]["coordinates"]), int(bodies.vehicles[i]["first"])
        own = np.arange(count)
        if isinstance(load, Oscillator):
            carried += load.mass
            own = own if load.contact_stiffness is not None else own[dim - 1 :]
        M, C, K, given = _matrices(bodies, i, own, wheels, dim - 1)
        M[np.arange(own.size, len(M)), np.arange(own.size, len(M))] += mass
    restrained = slice(0, own.size)
    if (np.linalg.eigvalsh(M[restrained, restrained]) <= 0.0).any():
        raise RopewalkError(f"load {name}: a coordinate of its bodies has no mass; check its mass matrix")
    gravity = -float(loading.gravity[-1])
    weights = np.concatenate([np.zeros(own.size), mass * gravity])
    weights[: given.size] += given
    push = np.array([-force_at(loading.loads, int(k), 0.0, dim - 1) for k in wheels])
    try:
        rest = np.linalg.solve(K[restrained, restrained], -weights[restrained])
    except np.linalg.LinAlgError:
        raise RopewalkError(
            f"load {name}: nothing keeps its coordinates where they are; check its stiffness matrix"
        ) from None
    static = weights[own.size :] + push + K[own.size :, restrained] @ rest
    numbers = tuple(int(first + d) for d in own)
    return Multibody(load, wheels, M, C, K, axles, static, numbers, rest, weights, carried)


def _vehicle_of(bodies: Bodies, wheels: Integers) -> int | None:
    """The number of the vehicle that stands on wheels, rigidly or on contact stiffnesses; None: they are all of it."""
    for i, vehicle in enumerate(bodies.vehicles):
        first, count = int(vehicle["first"]), int(vehicle["coordinates"])
        soft = [b["wheel"] for b in bodies.buffers if first <= b["coordinate"] < first + count]
        if np.isin([*bodies.wheel[i, : vehicle["wheels"]], *soft], wheels).any():
            return i
    return None


def _matrices(bodies: Bodies, i: int, own: Integers, wheels: Integers, up: int) -> tuple[Array, Array, Array, Array]:
    """Mass, damping and stiffness of coordinates and wheels, and their weights; a soft contact is a wheel on a spring.

    Args:
        i: which vehicle.
        own: its coordinates.
        wheels: contacts, in the order of the rows.
        up: the vertical axis.
    """
    count, places, first = (int(bodies.vehicles[i][key]) for key in ("coordinates", "wheels", "first"))
    size = own.size + wheels.size
    M, C, K, weight = np.zeros((size, size)), np.zeros((size, size)), np.zeros((size, size)), np.zeros(size)
    to, source = list(range(own.size)), own.tolist()
    for j, wheel in enumerate(wheels, start=own.size):
        mine = np.flatnonzero((bodies.wheel[i, :places] == wheel) & (bodies.axis[i, :places] == up))
        if mine.size:
            to.append(j)
            source.append(count + int(mine[0]))
        for buffer in bodies.buffers:
            if buffer["wheel"] == wheel and first <= buffer["coordinate"] < first + count:
                pair = np.ix_([int(buffer["coordinate"]) - first, j], [int(buffer["coordinate"]) - first, j])
                K[pair] += buffer["stiffness"] * np.array([[1.0, -1.0], [-1.0, 1.0]])
    put, pick = np.ix_(to, to), np.ix_(source, source)
    M[put] += bodies.M[i][pick]
    C[put] += bodies.C[i][pick]
    K[put] += bodies.K[i][pick]
    weight[to] = -bodies.load[i][source]
    return M, C, K, weight
