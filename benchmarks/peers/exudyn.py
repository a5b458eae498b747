"""Exudyn: `MassPoint2D` bodies, `ConnectorSpringDamper` links, one nodal load for each mass.

The load's share is a symbolic user function, which Exudyn evaluates in C++ at every stage of every method (a
Python function for each node would take nearly all the time). Its vector argument carries the node's material
coordinate, so one function serves all nodes. Implicit: generalised-alpha (spectral radius 0.9, modified
Newton, sparse LU). Explicit: velocity Verlet, RK44 and RK67 with fixed steps that divide the time from node
to node, DOPRI5 with step control, which has to be restarted at each output time because Exudyn gives no dense
output. Its ALE cable with a moving support is another discretisation, hence not here.
"""

from __future__ import annotations

import itertools
import sys
from time import process_time
from typing import Any

import numpy as np

from .interface import Failed, Setting, missing, rows_by_step, silent, steps_per_passage
from .problem import Array, Rope, rest_shape

name = "Exudyn"
distribution = "exudyn"

# steps that divide the time from node to node for 100, 200, 400 and 800 links
settings = (
    *(Setting("generalised-alpha", size, "step", True) for size in (2.5e-3, 1.25e-3, 2.5e-4, 5e-5, 2.5e-5, 1.25e-5)),
    *(Setting("velocity Verlet", size, "step", True) for size in (2.5e-4, 1.25e-4, 5e-5, 2.5e-5, 1.25e-5)),
    *(Setting("RK44", size, "step", True) for size in (2.5e-4, 1.25e-4, 5e-5, 2.5e-5)),
    *(Setting("RK67", size, "step", True) for size in (1.25e-4, 1e-4, 5e-5, 2.5e-5, 1.25e-5)),
    *(Setting("DOPRI5", size) for size in (1e-3, 1e-5, 1e-7, 1e-9)),
)


def available() -> str | None:
    """None if Exudyn can be used, else the reason."""
    return missing("exudyn", distribution)


def suits(rope: Rope, setting: Setting) -> str | None:
    """None, or that an explicit step is above the limit of the links' axial vibration and damping."""
    if setting.kind == "tolerance" or setting.method == "generalised-alpha":
        return None
    highest = 2 / rope.h * np.sqrt(rope.stiffness / rope.mass)
    ratio = 2 * rope.damping / (rope.mass * rope.h**2) / highest
    # Verlet takes damping explicitly; Runge-Kutta: 2.8 on either axis for order 4, less on the imaginary one for 6
    limit = (np.sqrt(1 + ratio**2) - ratio) * 2 if setting.method == "velocity Verlet" else 2.8 / max(1, 2 * ratio)
    if setting.size * highest > 1.2 * limit:
        return f"unstable: the step is above {limit / highest:.1e} s"
    return None


def chain(rope: Rope) -> Rope:
    """The peer solves the rope as it stands."""
    return rope


def _build(exu: Any, rope: Rope) -> tuple[Any, Any, list]:
    """Container, system and what must be kept alive; node i of the chain is node i of the system, coordinates
    start from rest.
    """
    import exudyn.itemInterface as item
    from exudyn.advancedUtilities import CreateSymbolicUserFunction

    container = exu.SystemContainer()
    system = container.AddSystem()
    shape = rest_shape(rope)
    ground = system.AddObject(item.ObjectGround())
    spring = {
        "referenceLength": rope.h,
        "stiffness": rope.stiffness / rope.h,
        "damping": rope.damping / rope.h,
    }
    esym = exu.symbolic
    per_link, speed, force = 1 / rope.h, rope.speed, rope.force

    def share(mbs, t, loadVector):  # the names are Exudyn's
        return [0, force * esym.max(1 - esym.abs(speed * t - loadVector[0]) * per_link, 0), 0]

    user = CreateSymbolicUserFunction(system, share, "loadVectorUserFunction", itemTypeName="LoadForceVector")
    markers = [system.AddMarker(item.MarkerBodyPosition(bodyNumber=ground, localPosition=[0, 0, 0]))]
    for i in range(1, rope.n):
        node = system.AddNode(item.NodePoint2D(referenceCoordinates=list(shape[i])))
        system.AddObject(item.MassPoint2D(mass=rope.node_mass, nodeNumber=node))
        markers.append(system.AddMarker(item.MarkerNodePosition(nodeNumber=node)))
        system.AddLoad(
            item.LoadForceVector(markerNumber=markers[-1], loadVector=[0, -rope.node_mass * rope.gravity, 0])
        )
        system.AddLoad(
            item.LoadForceVector(markerNumber=markers[-1], loadVector=[i * rope.h, 0, 0], loadVectorUserFunction=user)
        )
    markers.append(system.AddMarker(item.MarkerBodyPosition(bodyNumber=ground, localPosition=[rope.span, 0, 0])))
    for pair in itertools.pairwise(markers):
        system.AddObject(item.ObjectConnectorSpringDamper(markerNumbers=list(pair), **spring))
    system.Assemble()
    return container, system, [user]


def run(rope: Rope, times: Array, setting: Setting) -> tuple[Array, float]:
    """Positions at ``times`` and the CPU seconds of the solver (building and assembling the system not
    included).
    """
    sys.exudynFast = True  # the build without range checks; heeded at the first import only
    with silent():  # the import greets
        import exudyn as exu

    exu.config.printToConsole = False
    container, system, _keep = _build(exu, rope)
    options = exu.SimulationSettings()
    options.solution.file.write = False
    options.solution.sensors.active = False
    options.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    motion = options.timeIntegration
    motion.verboseMode = 0
    motion.generalizedAlpha.spectralRadius = 0.9
    positions = np.zeros((len(times), rope.n + 1, 2))
    shape = rest_shape(rope)
    positions[:] = shape

    def keep_positions(row: int) -> None:
        # displacements from the reference; GetODE2CoordinatesTotal corrupted memory in version 1.13.6
        positions[row, 1:-1] = shape[1:-1] + system.systemData.GetODE2Coordinates().reshape(rope.n - 1, 2)

    solver = {
        "generalised-alpha": exu.DynamicSolverType.GeneralizedAlpha,
        "velocity Verlet": exu.DynamicSolverType.VelocityVerlet,
        "RK67": exu.DynamicSolverType.RK67,
        "RK44": exu.DynamicSolverType.RK44,
        "DOPRI5": exu.DynamicSolverType.DOPRI5,
    }[setting.method]
    try:
        if setting.kind == "step":
            step = rope.passage / steps_per_passage(rope, setting.size)
            total = round((times[-1] - times[0]) / step)
            wanted = rows_by_step(times, step)

            def after_step(mbs: Any, time: float) -> bool:
                row = wanted.get(round((time - times[0]) / step))
                if row is not None:
                    keep_positions(row)
                return True

            system.SetPostStepUserFunction(after_step)
            motion.automaticStepSize = False
            motion.adaptiveStep = False
            motion.startTime, motion.endTime, motion.numberOfSteps = times[0], times[-1], total
            begin = process_time()
            system.SolveDynamic(options, solverType=solver)
            seconds = process_time() - begin
        else:
            motion.absoluteTolerance = motion.relativeTolerance = setting.size
            motion.minimumStepSize = 1e-9
            seconds = 0.0
            for row in range(1, len(times)):
                motion.startTime, motion.endTime = times[row - 1], times[row]
                motion.numberOfSteps = 100  # sets the first and the largest step
                begin = process_time()
                system.SolveDynamic(options, solverType=solver, updateInitialValues=True)
                seconds += process_time() - begin
                keep_positions(row)
    except (RuntimeError, ValueError) as error:
        raise Failed(str(error).strip().splitlines()[0][:100]) from error
    finally:
        container.Reset()
    if not np.isfinite(positions).all():
        raise Failed("the motion is not finite")
    return positions, seconds
