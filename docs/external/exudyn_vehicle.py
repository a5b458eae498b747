"""A vehicle as a multibody system of the package Exudyn: a rigid body that pitches, on two sprung wheelsets.

Exudyn is a multibody program in C++ by J. Gerstmayr and others, University of Innsbruck; tried with version 1.13.6,
licence EXUDYN General License 1.0 (permissive, in the manner of BSD 3-Clause). It integrates implicitly, here by
Newmark's constant mean acceleration, with the line's heights linear between two exchanges. Whoever has a model of
another kind can take this file for a pattern: `_build` is all that knows of the vehicle.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface as items

from ropewalk.errors import RopewalkError
from ropewalk.external.protocol import SeenLine, Touch
from ropewalk.mechanics.chain import Array

_MOMENT = 1e-4  # s, in which the slope of the line at the beginning is looked at

_RESIDUAL = 1e-10  # of Newton's iterations, of the weight of the body


class ExudynVehicle:
    """A body with two wheelsets, in the vertical plane, that travels along the line at a constant speed.

    It begins in its equilibrium on the line as it finds it, and rolling along it. Its contacts are springs that hold on
    to the line: nothing lifts off. Before and behind the line the ground is as high as the line's ends.

    Args:
        start: place of the body's centre at the beginning, m from the start of the line; may be negative.
        speed: m/s along the line, m of unstrained length each second.
        body_mass: kg.
        body_inertia: moment of inertia in pitch, kg m^2.
        wheel_mass: of a wheelset, kg.
        stiffness: of the suspension of a wheelset, N/m.
        damping: of the same, N s/m.
        contact_stiffness: of a wheelset on the line, N/m.
        axles: places of the two wheelsets from the body's centre, m, positive ahead.
        gravity: m/s^2.
        steps: steps of Exudyn in one exchange.

    Raises:
        RopewalkError: numbers do not fit.
    """

    contacts = 2

    def __init__(
        self, start: float, speed: float, *, body_mass: float, body_inertia: float, wheel_mass: float,
        stiffness: float, contact_stiffness: float, damping: float = 0.0, axles: Sequence[float] = (1.0, -1.0),
        gravity: float = 9.81, steps: int = 1,
    ) -> None:  # fmt: skip
        if len(axles) != 2 or axles[0] * axles[1] >= 0.0:
            raise RopewalkError(f"axles must be two, one on either side of the centre, given {list(axles)}")
        positive = {"body_mass": body_mass, "body_inertia": body_inertia, "wheel_mass": wheel_mass,
                    "stiffness": stiffness, "contact_stiffness": contact_stiffness, "steps": steps}  # fmt: skip
        for key, value in positive.items():
            if value <= 0:
                raise RopewalkError(f"{key} must be positive, given {value:g}")
        self.start, self.speed, self.axles, self.gravity, self.steps = start, speed, np.array(axles), gravity, steps
        self.body_mass, self.body_inertia, self.wheel_mass = body_mass, body_inertia, wheel_mass
        self.stiffness, self.damping, self.contact_stiffness = stiffness, damping, contact_stiffness
        self._build()
        self._ready = False

    @property
    def motion(self) -> tuple[Array, Array]:
        """Displacements and velocities: body up, its pitch (ahead up), wheelsets; (coordinate,) m and rad."""
        q, v = (np.array(part) for part in self._mbs.systemData.GetSystemState()[:2])
        return q[[1, 2, 4, 6]], v[[1, 2, 4, 6]]

    def reset(self, line: SeenLine) -> None:
        """Begin anew in equilibrium on the line."""
        self._rail = self._heights(0.0, line)
        rise = (self._heights(_MOMENT, line) - self._heights(-_MOMENT, line)) / (2.0 * _MOMENT)  # m/s
        share = self.body_mass * self.gravity * self.axles[::-1] / (self.axles[::-1] - self.axles)  # (wheel,) N
        wheels = self._rail - (share + self.wheel_mass * self.gravity) / self.contact_stiffness
        locations = wheels - share / self.stiffness
        pitch = float(np.arcsin((locations[0] - locations[1]) / (self.axles[0] - self.axles[1])))
        body = locations[0] - self.axles[0] * np.sin(pitch)
        state = self._mbs.systemData.GetSystemState()
        state[0] = np.array([0.0, body, pitch, 0.0, wheels[0], 0.0, wheels[1]])
        turn = float(rise[0] - rise[1]) / ((self.axles[0] - self.axles[1]) * np.cos(pitch))
        rise_rate = float(rise[0]) - self.axles[0] * np.cos(pitch) * turn
        state[1] = np.array([0.0, rise_rate, turn, 0.0, rise[0], 0.0, rise[1]])
        self._mbs.systemData.SetSystemState(state)
        self._ready = True

    def step(self, t: float, h: float, line: SeenLine) -> list[Touch]:
        """Go on by h to t with the contacts on the line as it is.

        Raises:
            RopewalkError: Exudyn's solver gives up.
        """
        if not self._ready:
            self.reset(line)
        before, self._rail = self._rail, self._heights(t, line)
        if t > 0.0:
            for part in range(self.steps):
                first, last = (before + (self._rail - before) * (part + k) / self.steps for k in (0, 1))
                self._advance(first, last, t - h + part * h / self.steps, h / self.steps)
        force = self.contact_stiffness * (self._rail - self.motion[0][2:])
        none = (0.0,) * (line.at(0.0)[0].size - 1)
        return [
            Touch(self.start + a + self.speed * t, (*none, -F), self.speed)
            for a, F in zip(self.axles, force, strict=True)
        ]

    def get_state(self) -> Any:
        """Everything that changes in time."""
        return deepcopy((self._mbs.systemData.GetSystemState(), self._rail))

    def set_state(self, state: Any) -> None:
        """Be what it was when this state was got."""
        parts, self._rail = deepcopy(state)
        self._mbs.systemData.SetSystemState(parts)

    def _heights(self, t: float, line: SeenLine) -> Array:
        """Of the line under the wheelsets, m, (wheel,)."""
        xi = np.clip(self.start + self.axles + self.speed * t, 0.0, line.length)
        return np.array([line.at(s)[0][-1] for s in xi])

    def _build(self) -> None:
        """Put the multibody system together: x stays where it is, as nothing pulls along it."""
        mbs = exudyn.SystemContainer().AddSystem()
        node = mbs.AddNode(items.NodeRigidBody2D(referenceCoordinates=[0.0, 0.0, 0.0]))
        body = mbs.AddObject(items.RigidBody2D(mass=self.body_mass, inertia=self.body_inertia, nodeNumber=node))
        ground = mbs.AddMarker(items.MarkerNodeCoordinate(
            nodeNumber=mbs.AddNode(items.NodePointGround(referenceCoordinates=[0.0, 0.0, 0.0])), coordinate=0
        ))  # fmt: skip
        self._contacts = []
        weights = [(mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=body)), self.body_mass)]
        for place in self.axles:
            point = mbs.AddNode(items.NodePoint2D(referenceCoordinates=[place, 0.0]))
            wheel = mbs.AddObject(items.MassPoint2D(mass=self.wheel_mass, nodeNumber=point))
            axle = mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=wheel))
            location = mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=body, localPosition=[place, 0.0, 0.0]))
            mbs.AddObject(items.CartesianSpringDamper(
                markerNumbers=[axle, location], stiffness=[0.0, self.stiffness, 0.0], damping=[0.0, self.damping, 0.0]
            ))  # fmt: skip
            rise = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=point, coordinate=1))
            self._contacts.append(
                mbs.AddObject(
                    items.CoordinateSpringDamper(markerNumbers=[ground, rise], stiffness=self.contact_stiffness)
                )
            )
            weights.append((axle, self.wheel_mass))
        for marker, mass in weights:
            mbs.AddLoad(items.Force(markerNumber=marker, loadVector=[0.0, -mass * self.gravity, 0.0]))
        mbs.Assemble()
        self._mbs, self._settings = mbs, exudyn.SimulationSettings()
        times = self._settings.timeIntegration
        times.numberOfSteps, times.endTime, times.generalizedAlpha.useNewmark = 1, 0.0, True
        times.verboseMode, self._settings.solution.file.write = 0, False
        # In steady motion nothing is left to reduce: a residual counts by the weight. And steps cut short in secret
        # would not know where the line is then.
        times.newton.absoluteTolerance, times.adaptiveStep = _RESIDUAL * self.body_mass * 9.81, False
        self._solver = exudyn.MainSolverImplicitSecondOrder()
        self._solver.InitializeSolver(mbs, self._settings)

    def _advance(self, first: Array, last: Array, t: float, h: float) -> None:
        """One step of Exudyn while the line moves from the first heights to the last."""
        data, times = self._mbs.systemData, self._settings.timeIntegration
        data.SetSystemState(data.GetSystemState(), configuration=exudyn.ConfigurationType.Initial)
        times.startTime, times.endTime = t, t + h
        self._lift(first)  # of which the accelerations at the beginning come
        self._solver.InitializeSolverInitialConditions(self._mbs, self._settings)
        self._lift(last)
        if not self._solver.SolveSteps(self._mbs, self._settings):
            raise RopewalkError(f"Exudyn's solver gives up ({self._solver.GetErrorString()}); shorten `every`")

    def _lift(self, heights: Array) -> None:
        for contact, height in zip(self._contacts, heights, strict=True):
            self._mbs.SetObjectParameter(contact, "offset", float(height))
