"""Small tasks on single wires, and their courses, for tests against closed forms."""

from __future__ import annotations

import numpy as np

from ropewalk.results.frame import Account
from ropewalk.results.running import TimeHistory
from ropewalk.theory.beam_vehicle import Vehicle
from ropewalk.wires.frames import Wires
from ropewalk.wires.journey import ON_GROUND, Journey
from ropewalk.wires.plan import Contact, Plan, Rider, Spot, Wire
from ropewalk.wires.task import Task

NONE = np.zeros((0, 0))


def straight(length, tension, mass, stiffness=0.0, **more):
    """A level wire, stretched by a tenth of a percent at most."""
    EA = more.pop("axial_stiffness", max(1e3 * tension, 1e8))
    return Wire("wire", (0.0, 0.0, 0.0), (length, 0.0, 0.0), tension, mass, stiffness, EA, **more)


def force(size, speed, start=0.0):
    """A force downwards that travels."""
    rider = Rider("force", NONE, NONE, NONE, (Contact(0, stiffness=0.0),))
    return Journey(rider, lambda t: start + speed * t, given=lambda t: np.full((t.size, 1), -size))


def rolling(vehicle: Vehicle, speed):
    """A vehicle of the theory with wheels that all have a mass, or none, as a rider that comes from level ground."""
    own = vehicle.bodies
    wheels = range(vehicle.axles.size)
    if vehicle.heavy_wheels:
        size = vehicle.mass.shape[0]
        rows = [tuple(np.eye(size)[own + j]) for j in wheels]
        contacts = tuple(
            Contact(0, rows[j], float(vehicle.axles[j]), rest=-float(vehicle.static_load[j])) for j in wheels
        )
        rider = Rider("vehicle", vehicle.mass, vehicle.damping, vehicle.stiffness, contacts)
    else:
        K, C = vehicle.stiffness[:own, :own].copy(), vehicle.damping[:own, :own].copy()
        contacts = ()
        for j in wheels:
            k, c = vehicle.stiffness[own + j, own + j], vehicle.damping[own + j, own + j]
            row = -vehicle.stiffness[own + j, :own] / k
            K, C = K - k * np.outer(row, row), C - c * np.outer(row, row)
            contacts += (
                Contact(
                    0, tuple(row), float(vehicle.axles[j]), stiffness=k, damping=c, rest=-float(vehicle.static_load[j])
                ),
            )
        rider = Rider("vehicle", vehicle.mass[:own, :own], C, K, contacts)
    return Journey(rider, lambda t: speed * t, beside=ON_GROUND)


def course(wire, journeys, times, links, *, geometry="linearised", watched=None, sample=None, step=None, plan=None):
    """Frames of a run, without gravity on the wire."""
    spots = {f"{x:g}": Spot(0, x) for x in (watched if watched is not None else [0.5 * wire.length])}
    plan = plan or Plan((wire,), gravity=0.0, watched=spots)
    task = Task(plan, tuple(journeys), tuple(j.rider.name for j in journeys for _ in j.rider.contacts),
                element=[links] * len(plan.wires), geometry=geometry)  # fmt: skip
    account = Account()
    wires = Wires(task, times, account, sample if sample is not None else float(times[1] - times[0]), step)
    return list(TimeHistory(wires, account).frames()), account
