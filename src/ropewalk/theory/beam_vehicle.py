"""Linear vehicle on wheels: what travels over a beam, as matrices of mass, damping and stiffness."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments

__all__ = ["Vehicle", "oscillator", "point_mass", "rigid_body", "row_of_forces"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Vehicle:
    """A linear multi-body vehicle; its wheels follow the beam, or level ground next to it.

    ``mass``, ``damping`` and ``stiffness`` are symmetric matrices over all coordinates, **bodies first, then one
    coordinate per wheel**, counted downwards from the state of rest on level ground; the mass matrix of the bodies must
    be positive definite. ``axles`` are the distances of the wheels behind the front of the vehicle in m, >= 0;
    ``static_load`` the wheel loads at rest in N. `ValueError` where shapes or values do not fit.

    The contact force of a wheel is its static load less its row of ``mass u'' + damping u' + stiffness u``.
    """

    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    axles: FloatArray
    static_load: FloatArray

    def __post_init__(self) -> None:
        for name in ("mass", "damping", "stiffness", "axles", "static_load"):
            value = np.array(getattr(self, name), dtype=np.float64)
            _arguments.finite(**{name: value})
            object.__setattr__(self, name, value)
        wheels, size = self.axles.size, len(self.mass)
        if self.axles.ndim != 1 or wheels == 0 or self.static_load.shape != (wheels,):
            raise ValueError("axles and static_load must be lists of one length, with one value for every wheel")
        if np.any(self.axles < 0.0):
            raise ValueError("axles must not be negative: they are distances behind the front of the vehicle")
        for name in ("mass", "damping", "stiffness"):
            matrix = getattr(self, name)
            if matrix.shape != (size, size) or size < wheels:
                raise ValueError(f"{name} must be square, with a row for every body coordinate and every wheel")
            if not np.allclose(matrix, matrix.T, rtol=1e-9, atol=1e-12 * np.max(np.abs(matrix), initial=0.0)):
                raise ValueError(f"{name} must be symmetric")
        if np.any(np.linalg.eigvalsh(self.mass[: self.bodies, : self.bodies]) <= 0.0):
            raise ValueError("mass must be positive definite for the body coordinates, which come first")

    @property
    def bodies(self) -> int:
        """Number of body coordinates."""
        return len(self.mass) - len(self.axles)

    @property
    def heavy_wheels(self) -> bool:
        """Whether the contact forces depend on the accelerations of the wheels."""
        return bool(np.any(self.mass[self.bodies :, self.bodies :]))

    def natural_frequencies(self) -> FloatArray:
        """Return the circular frequencies of the undamped bodies with all wheels on level ground, in rad/s."""
        inside = slice(0, self.bodies)
        ratio = np.linalg.solve(self.mass[inside, inside], self.stiffness[inside, inside])
        return np.sort(np.sqrt(np.maximum(np.linalg.eigvals(ratio).real, 0.0)))


def row_of_forces(forces: ArrayLike, axles: ArrayLike) -> Vehicle:
    """Return a train of constant forces (N) at the distances ``axles`` (m) behind the first: no inertia at all."""
    forces = np.atleast_1d(np.asarray(forces, dtype=np.float64))
    nothing = np.zeros((len(forces), len(forces)))
    return Vehicle(nothing, nothing, nothing, np.atleast_1d(np.asarray(axles, dtype=np.float64)), forces)


def point_mass(load_mass: float, *, gravity: float = 9.81) -> Vehicle:
    """Return a mass (kg) in rigid contact under its weight; ``gravity`` in m/s^2."""
    _arguments.not_negative(load_mass=load_mass)
    _arguments.finite(gravity=gravity)
    nothing = np.zeros((1, 1))
    return Vehicle(np.array([[load_mass]]), nothing, nothing, np.zeros(1), np.array([load_mass * gravity]))


def oscillator(
    load_mass: float,
    *,
    load_stiffness: float,
    load_damping: float = 0.0,
    wheel_mass: float = 0.0,
    gravity: float = 9.81,
) -> Vehicle:
    """Return a mass (kg) on a spring (N/m) and damper (N s/m) above a wheel (kg) in rigid contact.

    ``load_mass`` and ``load_stiffness`` are positive, the rest not negative; ``gravity`` in m/s^2.
    """
    _arguments.positive(load_mass=load_mass, load_stiffness=load_stiffness)
    _arguments.not_negative(load_damping=load_damping, wheel_mass=wheel_mass)
    _arguments.finite(gravity=gravity)
    link = np.array([[1.0, -1.0], [-1.0, 1.0]])
    weight = np.array([(load_mass + wheel_mass) * gravity])
    masses = np.diag([load_mass, wheel_mass])
    return Vehicle(masses, load_damping * link, load_stiffness * link, np.zeros(1), weight)


def rigid_body(
    load_mass: float,
    *,
    pitch_inertia: float,
    centre: float,
    axles: ArrayLike,
    load_stiffness: ArrayLike,
    load_damping: ArrayLike = 0.0,
    wheel_mass: ArrayLike = 0.0,
    gravity: float = 9.81,
) -> Vehicle:
    """Return a rigid body with bounce and pitch on two or more sprung axles.

    ``load_mass`` in kg and ``pitch_inertia`` in kg m^2, positive; ``axles`` and ``centre`` (of mass) are distances in m
    behind the front of the vehicle; ``load_stiffness`` (N/m, positive), ``load_damping`` (N s/m) and ``wheel_mass``
    (kg) for every axle or one for all. Body coordinates: bounce in m, downwards; pitch in rad, positive when the front
    goes down. Wheel loads at rest are those of the springs on level ground.
    """
    _arguments.positive(load_mass=load_mass, pitch_inertia=pitch_inertia)
    _arguments.finite(centre=centre, gravity=gravity)
    axles = np.asarray(axles, dtype=np.float64)
    if axles.ndim != 1 or len(np.unique(axles)) < 2:
        raise ValueError("axles must name two or more different places: on one axle the body would tip over")
    k, c, wheels = (
        np.broadcast_to(np.asarray(a, dtype=np.float64), axles.shape)
        for a in (load_stiffness, load_damping, wheel_mass)
    )
    if not (np.all(k > 0.0) and np.all(c >= 0.0) and np.all(wheels >= 0.0)):
        raise ValueError("load_stiffness must be positive, load_damping and wheel_mass must not be negative")
    stretch = np.hstack([np.ones((len(axles), 1)), (centre - axles)[:, np.newaxis], -np.eye(len(axles))])
    stiffness = stretch.T @ (k[:, np.newaxis] * stretch)
    rest = np.linalg.solve(stiffness[:2, :2], [load_mass * gravity, 0.0])
    return Vehicle(
        np.diag([load_mass, pitch_inertia, *wheels]),
        stretch.T @ (c[:, np.newaxis] * stretch),
        stiffness,
        axles,
        k * (stretch[:, :2] @ rest) + wheels * gravity,
    )
