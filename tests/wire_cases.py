"""Small tasks on single wires, and their courses, for tests against closed forms."""

from __future__ import annotations

import numpy as np

from ropewalk.results.frame import RunInfo
from ropewalk.results.running import TimeHistory
from ropewalk.theory.beam_vehicle import Vehicle
from ropewalk.wires.frames import Wires
from ropewalk.wires.plan import Contact, Spot, TravellingLoad, Wire, WirePlan
from ropewalk.wires.prescribed_motion import ON_GROUND, PrescribedMotion
from ropewalk.wires.task import WireTask

NONE = np.zeros((0, 0))


def straight(length, tension, mass, stiffness=0.0, **more):
    """A level wire, stretched by a tenth of a percent at most."""
    EA = more.pop("axial_stiffness", max(1e3 * tension, 1e8))
    return Wire("wire", (0.0, 0.0, 0.0), (length, 0.0, 0.0), tension, mass, stiffness, EA, **more)


def force(size, speed, start=0.0):
    """A force downwards that travels."""
    moving_load = TravellingLoad("force", NONE, NONE, NONE, (Contact(0, stiffness=0.0),))
    return PrescribedMotion(moving_load, lambda t: start + speed * t, given=lambda t: np.full((t.size, 1), -size))


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
        moving_load = TravellingLoad("vehicle", vehicle.mass, vehicle.damping, vehicle.stiffness, contacts)
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
        moving_load = TravellingLoad("vehicle", vehicle.mass[:own, :own], C, K, contacts)
    return PrescribedMotion(moving_load, lambda t: speed * t, beside=ON_GROUND)


def course(
    wire, prescribed_motions, times, links, *, geometry="linearised", watched=None, sample=None, step=None, plan=None
):
    """Frames of a run, without gravity on the wire."""
    spots = {f"{x:g}": Spot(0, x) for x in (watched if watched is not None else [0.5 * wire.length])}
    plan = plan or WirePlan((wire,), gravity=0.0, watched=spots)
    task = WireTask(plan, tuple(prescribed_motions),
                    tuple(j.moving_load.name for j in prescribed_motions for _ in j.moving_load.contacts),
                element=[links] * len(plan.wires), geometry=geometry)  # fmt: skip
    run_info = RunInfo()
    wires = Wires(task, times, run_info, sample if sample is not None else float(times[1] - times[0]), step)
    return list(TimeHistory(wires, run_info).frames()), run_info
