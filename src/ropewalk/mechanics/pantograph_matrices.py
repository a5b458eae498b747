"""Matrices of pantographs: coordinates are the heights of the masses in m, from the base to the head.

After them come the pitch of the head, with what is in front up, and its roll, with what is on the left up, in rad. At
its middle the head stands at z; a strip that is x ahead touches a wire that is y aside at z + x pitch + y roll.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.vehicle_matrices import BESIDE, MIDDLE, Body, VehicleMatrices
from ropewalk.model.head import HeadRotation
from ropewalk.model.pantograph import Pantograph

MASSES = {2: ("frame", "head"), 3: ("lower", "upper", "head")}
"""Names of the masses in results, from the base to the head, by how many there are."""


def rotations_of(pantograph: Pantograph) -> dict[str, HeadRotation]:
    """Rotations of its head, pitch before roll, whose angles are coordinates after the heights of its masses."""
    head = pantograph.head
    both = {} if head is None else {"pitch": head.pitch, "roll": head.roll}
    return {name: rotation for name, rotation in both.items() if rotation is not None}


def row_of(pantograph: Pantograph, ahead: float = 0.0, aside: float = 0.0) -> Array:
    """Height of a point of its head by its coordinates, (coordinate,).

    Args:
        pantograph: as declared.
        ahead: m, of the middle of the head.
        aside: m, to the left of it.
    """
    lever = {"pitch": ahead, "roll": aside}
    heights = np.eye(len(pantograph.parts.masses))[-1]
    return np.array([*heights, *(lever[name] for name in rotations_of(pantograph))])


def matrices_of(pantograph: Pantograph) -> tuple[Array, Array, Array]:
    """Masses, dampers and springs (coordinate, coordinate), without those of the contact; kg, N s/m and N/m."""
    parts, rotations = pantograph.parts, rotations_of(pantograph).values()
    size = len(parts.masses)
    # Spring and damper i stand between masses i - 1 and i, those of the base on the roof.
    apart = np.eye(size) - np.eye(size, k=-1)
    # Half of those below the head stand half of a distance from its middle: as a spring against its rotation d^2 / 4.
    lever = [0.25 * rotation.spring_spacing**2 for rotation in rotations]
    damping, stiffness = np.zeros((2, size + len(lever), size + len(lever)))
    for matrix, own in ((damping, parts.damping), (stiffness, parts.stiffness)):
        matrix[:size, :size] = apart.T @ np.diag(own) @ apart
        matrix[size:, size:] = np.diag([own[-1] * square for square in lever])
    inertia = [rotation.inertia for rotation in rotations]
    return np.diag([*parts.masses, *inertia]), damping, stiffness


def vehicle_of(
    name: str, pantograph: Pantograph, on: Sequence[int], ahead: Sequence[float], dim: int, first: int
) -> tuple[VehicleMatrices, list[Body]]:
    """A pantograph above contacts without mass, as a vehicle is on wheels, and what results show of it.

    Args:
        name: of the load.
        pantograph: as declared; its head does not roll.
        on: numbers of its contacts.
        ahead: m, by how much the strip of each is ahead of the middle of the head.
        dim: how many axes there are.
        first: number of its first coordinate.
    """
    M, C, K = matrices_of(pantograph)
    n = M.shape[0]
    vehicle = VehicleMatrices.of(n, [(k, dim - 1) for k in on])
    for whole, part in ((vehicle.M, M), (vehicle.C, C), (vehicle.K, K)):
        whole[:n, :n] = part
    for j, place in enumerate(ahead):
        row = np.concatenate([row_of(pantograph, place), -np.eye(len(on))[j]])
        vehicle.join(row, pantograph.contact_stiffness, pantograph.contact_damping)
    masses = pantograph.parts.masses
    level = (BESIDE, *(MIDDLE,) * (dim - 2))
    others = tuple(k for k, place in zip(on, ahead, strict=True) if place == ahead[0])[1:]
    displayed = [
        Body(f"{name}.{part}", on[0], -ahead[0], (*level, first + i), masses[i], others)
        for i, part in enumerate(MASSES[len(masses)])
    ]
    return vehicle, displayed
