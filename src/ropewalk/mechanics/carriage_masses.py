"""Masses of carriages: those of rockers and cabins as quadratic forms of velocities of wheels."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.vehicle_matrices import Body, VehicleMatrices
from ropewalk.model.carriage import Carriage


def carriage_masses(load: Carriage) -> tuple[Array, Array]:
    """Masses of a carriage without those of its wheels, in each direction alike.

    The middle of a rocker is the mean of the wheels below it. It is a uniform bar of the length L: with the velocity v
    of its middle and u of one end as seen from the other it has m/2 (v^2 + u^2/12). A cabin of the mass m and the
    moment of inertia I on a hanger of the length l has m/2 w^2 + I/2 (w - v)^2/l^2, w: velocity of its centre.

    Returns:
        Mass matrix (coordinate, coordinate) in kg of cabin and wheels, in this order, and masses with weight.
    """
    own = int(load.cabin is not None)
    M, groups = np.zeros((own + load.count, own + load.count)), [[own + i] for i in range(load.count)]
    rest = load.mass - load.count * load.of_wheel
    lengths = sum(length * load.count / 2 ** (level + 1) for level, length in enumerate(load.rockers))
    for length in load.rockers:
        for behind, ahead in zip(groups[::2], groups[1::2], strict=True):
            mean, apart = np.zeros((2, M.shape[0]))
            for part, sign in ((behind, -1.0), (ahead, 1.0)):
                mean[part], apart[part] = 0.5 / len(part), sign / len(part)
            M += rest * length / lengths * (np.outer(mean, mean) + np.outer(apart, apart) / 12.0)
        groups = [behind + ahead for behind, ahead in zip(groups[::2], groups[1::2], strict=True)]
    weight: Array = M.sum(axis=1)
    if load.cabin is not None:
        weight[0] = load.cabin.mass
        hanger = np.array([1.0, *[-1.0 / load.count] * load.count])
        M[0, 0] += load.cabin.mass
        M += load.cabin.inertia / load.cabin.hanger**2 * np.outer(hanger, hanger)
    return M, weight


def carriage(
    name: str, load: Carriage, on: list[int], dim: int, first: int, gravity: float
) -> tuple[VehicleMatrices, list[Body]]:
    """Rockers, whose masses move with wheels, and a cabin.

    Args:
        name: of the load.
        load: what is declared of it.
        on: its wheels.
        dim: number of axes.
        first: its first coordinate.
        gravity: m/s^2.
    """
    vehicle = VehicleMatrices.of(dim if load.cabin is not None else 0, [(k, a) for k in on for a in range(dim)])
    M, weight = carriage_masses(load)
    for a in range(dim):
        vehicle.M[a::dim, a::dim] = M
    vehicle.load[dim - 1 :: dim] = -gravity * weight
    if load.cabin is None:
        return vehicle, []
    if load.cabin.air_drag:
        vehicle.drag[0] = load.cabin.air_drag
    return vehicle, [Body(f"{name}.cabin", on[0], 0.0, tuple(range(first, first + dim)), load.cabin.mass)]
