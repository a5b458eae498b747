"""Exudyn's sliding joint: a mass that slides without friction along a rope.

The rope is of `ANCFCable2D` elements (cubic in position and slope, Hooke's law) without bending stiffness, which a taut
rope bears; the mass is a `MassPoint2D` on a frictionless `ObjectJointSliding2D`. Generalised-alpha with spectral radius
0.9 and modified Newton steps, which are five times cheaper than full ones here; sparse LU. In version 1.13.6 the joint
was solved neither by trapezoidal steps (spectral radius 1 or `TrapezoidalIndex2`) nor in its formulation of index 2.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np

from ropewalk.theory.rope import resting

from .interface import Failed, missing, rows_by_step, silent
from .problem import Array

name = "Exudyn"
distribution = "exudyn"


@dataclass(frozen=True)
class Slide:
    """A mass released on a rope that rests under it; SI units, x along the span, z up."""

    length: float = 20.0
    span: float = 19.5
    density: float = 1.0  # kg/m
    stiffness: float = 1e5  # EA in N
    gravity: float = 9.81
    mass: float = 40.0
    start: float = 3.0  # m, unstrained, from the start of the rope
    until: float = 2.0

    def place(self, elements: int) -> tuple[int, float]:
        """The element on which the mass begins, and how far within it, m."""
        h = self.length / elements
        element = int(self.start / h + 1e-9)
        return element, self.start - element * h


def available() -> str | None:
    """None if Exudyn can be used, else the reason."""
    return missing("exudyn", distribution)


def path(slide: Slide, times: Array, elements: int, step: float, bending: float = 0.0) -> tuple[Array, float]:
    """The mass at ``times`` as (time, axis) in m, and the CPU seconds of the solver alone.

    The rest shape is Exudyn's own, with the weight of the mass on its element; raises `Failed`.
    """
    sys.exudynFast = True  # the build without range checks; heeded at the first import only
    with silent():  # the import greets
        import exudyn as exu

    exu.config.printToConsole = False
    moved = _at_rest(exu, slide, elements, bending)
    container, system, body = _build(exu, slide, elements, bending, moved, riding=True)
    options = _options(exu)
    motion = options.timeIntegration
    motion.verboseMode = 0
    motion.generalizedAlpha.spectralRadius = 0.9
    motion.newton.useModifiedNewton = True
    motion.newton.relativeTolerance, motion.newton.absoluteTolerance = 1e-6, 1e-10
    motion.automaticStepSize = motion.adaptiveStep = False
    motion.endTime, motion.numberOfSteps = times[-1], round(times[-1] / step)
    positions, wanted = np.full((len(times), 2), np.nan), rows_by_step(times, step)
    positions[0] = _on_element(slide, elements, moved)

    def after_step(mbs: Any, time: float) -> bool:
        row = wanted.get(round(time / step))
        if row is not None:
            positions[row] = mbs.GetObjectOutputBody(body, exu.OutputVariableType.Position)[:2]
        return True

    system.SetPostStepUserFunction(after_step)
    try:
        begin = process_time()
        system.SolveDynamic(options, solverType=exu.DynamicSolverType.GeneralizedAlpha)
        seconds = process_time() - begin
    except (RuntimeError, ValueError) as error:
        raise Failed(str(error).strip().splitlines()[0][:100]) from error
    finally:
        container.Reset()
    if not np.isfinite(positions).all():
        raise Failed("the motion is not finite")
    return positions, seconds


def _options(exu: Any) -> Any:
    options = exu.SimulationSettings()
    options.solution.file.write = False
    options.solution.sensors.active = False
    options.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    return options


def _reference(slide: Slide, elements: int) -> Array:
    """Nodes with their slopes (node, 4) on a straight line; strains count from the elements' lengths alone."""
    X = np.linspace(0.0, slide.span, elements + 1)
    return np.column_stack((X, np.zeros_like(X), np.ones_like(X), np.zeros_like(X)))


def _on_element(slide: Slide, elements: int, moved: Array) -> Array:
    """Where the cubic of its element puts the mass, m."""
    element, within = slide.place(elements)
    h = slide.length / elements
    u, nodes = within / h, (_reference(slide, elements) + moved)[element : element + 2]
    values, slopes = np.array([1 - 3 * u**2 + 2 * u**3, 3 * u**2 - 2 * u**3]), h * u * (1 - u) * np.array([1 - u, -u])
    return np.asarray(values @ nodes[:, :2] + slopes @ nodes[:, 2:])


def _at_rest(exu: Any, slide: Slide, elements: int, bending: float) -> Array:
    """Displacements of nodes and slopes at rest under the weight of rope and mass, (node, 4) m."""
    X = np.linspace(0.0, slide.length, elements + 1)
    weight = (0.0, -slide.mass * slide.gravity)
    rope = resting(
        span=slide.span, length=slide.length, weight=slide.density * slide.gravity, axial_stiffness=slide.stiffness,
        loads=[(slide.start, weight)],
    )  # fmt: skip
    places = rope.position(X)
    guess = np.column_stack((places, np.gradient(places, X, axis=0))) - _reference(slide, elements)
    container, system, _ = _build(exu, slide, elements, bending, guess, riding=False)
    options = _options(exu)
    solver = options.staticSolver
    solver.verboseMode, solver.numberOfLoadSteps = 0, 1
    solver.newton.relativeTolerance, solver.newton.absoluteTolerance, solver.newton.maxIterations = 1e-10, 1e-8, 200
    try:
        system.SolveStatic(options)
        return np.array(system.systemData.GetODE2Coordinates()).reshape(elements + 1, 4)
    except (RuntimeError, ValueError) as error:
        raise Failed("no rest shape") from error
    finally:
        container.Reset()


def _build(exu: Any, slide: Slide, elements: int, bending: float, moved: Array, riding: bool) -> tuple[Any, Any, Any]:
    """Container, system, and the mass riding on the joint, or None: then its weight presses on its element."""
    import exudyn.itemInterface as item

    container = exu.SystemContainer()
    system = container.AddSystem()
    h = slide.length / elements
    nodes = [
        system.AddNode(item.NodePoint2DSlope1(referenceCoordinates=list(at), initialCoordinates=list(by)))
        for at, by in zip(_reference(slide, elements), moved, strict=True)
    ]
    element, within = slide.place(elements)
    cables = []
    for i in range(elements):
        cables.append(
            system.AddObject(
                item.ObjectANCFCable2D(
                    length=h, massPerLength=slide.density, axialStiffness=slide.stiffness, bendingStiffness=bending,
                    nodeNumbers=[nodes[i], nodes[i + 1]],
                )
            )
        )  # fmt: skip
        marker = system.AddMarker(item.MarkerBodyMass(bodyNumber=cables[-1]))
        system.AddLoad(item.LoadMassProportional(markerNumber=marker, loadVector=[0, -slide.gravity, 0]))
    ground = system.AddMarker(
        item.MarkerNodeCoordinate(nodeNumber=system.AddNode(item.NodePointGround()), coordinate=0)
    )
    for node in (nodes[0], nodes[-1]):
        for axis in (0, 1):
            end = system.AddMarker(item.MarkerNodeCoordinate(nodeNumber=node, coordinate=axis))
            system.AddObject(item.ObjectConnectorCoordinate(markerNumbers=[ground, end]))
    body = None
    if riding:
        at = _on_element(slide, elements, moved)
        node = system.AddNode(item.NodePoint2D(referenceCoordinates=list(at)))
        body = system.AddObject(item.MassPoint2D(mass=slide.mass, nodeNumber=node))
        pressed = system.AddMarker(item.MarkerBodyPosition(bodyNumber=body))
        markers = [system.AddMarker(item.MarkerBodyCable2DCoordinates(bodyNumber=cable)) for cable in cables]
        place = item.NodeGenericData(initialCoordinates=[element, slide.start], numberOfDataCoordinates=2)
        system.AddObject(
            item.ObjectJointSliding2D(
                markerNumbers=[pressed, markers[element]], slidingMarkerNumbers=markers,
                slidingMarkerOffsets=[i * h for i in range(elements)], nodeNumber=system.AddNode(place),
            )
        )  # fmt: skip
    else:
        pressed = system.AddMarker(item.MarkerBodyPosition(bodyNumber=cables[element], localPosition=[within, 0, 0]))
    system.AddLoad(item.LoadForceVector(markerNumber=pressed, loadVector=[0, -slide.mass * slide.gravity, 0]))
    system.Assemble()
    return container, system, body
