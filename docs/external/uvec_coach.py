"""A coach of the package UVEC: car body, two bogies and four wheels on Hertzian contacts, ten degrees of freedom.

UVEC, "User defined VEhiCle models" of the group StemVibrations, is made for the finite elements of STEM; tried with
version 1.1.4, licence BSD 3-Clause. Its vehicle follows Zhai and Sun (1994) and integrates itself by Newmark's constant
mean acceleration. The force of a contact is that of the wheel and the rail at the end of the step: UVEC expects to be
called again and again for the same instant, which the adapter does until the force stays.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy
from typing import Any

import numpy as np
from UVEC.uvec_ten_dof_vehicle_2D.irregularities import calculate_joint_irregularities, calculate_rail_irregularity
from UVEC.uvec_ten_dof_vehicle_2D.uvec import compute_dynamic_solution

from ropewalk.errors import RopewalkError
from ropewalk.external.protocol import SeenLine, Touch
from ropewalk.mechanics.chain import Array

AGREED = 1e-6  # change of the contact forces, as a part of the static ones; what is left is a tenth of it or less
MOST = 60  # calls for one instant
WHEELS = [4, 5, 8, 9]
"""Which of the coordinates are wheels."""
_SAMPLES = 2001  # of the line at rest


class UvecCoach:
    """A coach that travels along the line at a constant speed; for a train write several, UVEC does not couple them.

    The options have the names, units and meaning of UVEC's parameters; heights count from the line at rest (when the
    model is reset), so that the coach sees a line as cambered as needed, and level ground before and behind it.

    Args:
        start: place of the centre of the car at the beginning, m from the start of the line; may be negative.
        speed: m/s along the line, m of unstrained length each second.
        cart_mass: of a car body, kg.
        cart_inertia: its moment of inertia in pitch, kg m^2.
        cart_stiffness: of the secondary suspension of one bogie, N/m.
        cart_damping: of the same, N s/m.
        bogie_mass: of a bogie frame, kg.
        bogie_inertia: its moment of inertia in pitch, kg m^2.
        wheel_mass: of a wheelset, kg.
        wheel_stiffness: of the primary suspension of one wheelset, N/m.
        wheel_damping: of the same, N s/m.
        bogie_distances: of the two bogies from the centre of the car, m, positive ahead.
        wheel_distances: of the two wheelsets from the centre of their bogie, m, positive ahead.
        contact_coefficient: G of the contact force (y/G)^p at the closing y, m/N^(1/p).
        contact_power: p, 1.5 for Hertz, 1 for a linear spring.
        irregularities: arguments of UVEC's random rail (f_min, f_max, N, Av, omega_c, seed), None for a smooth one.
        joint: arguments of UVEC's rail joint (location_joint in m from the start of the line, depth_joint,
            width_joint), None for none.

    Raises:
        RopewalkError: numbers do not fit.
    """

    contacts = 4

    def __init__(
        self, start: float, speed: float, *, cart_mass: float, cart_inertia: float, cart_stiffness: float,
        cart_damping: float, bogie_mass: float, bogie_inertia: float, wheel_mass: float, wheel_stiffness: float,
        wheel_damping: float, bogie_distances: Sequence[float], wheel_distances: Sequence[float],
        contact_coefficient: float, contact_power: float = 1.5,
        irregularities: Mapping[str, Any] | None = None, joint: Mapping[str, Any] | None = None,
    ) -> None:  # fmt: skip
        self._irregularities, self._place_of_joint = irregularities, joint
        for key, places in (("bogie_distances", bogie_distances), ("wheel_distances", wheel_distances)):
            if len(places) != 2 or abs(sum(places)) > 1e-9 or not any(places):
                wrong = f"{key} must be two, as far behind the middle as ahead of it, given {list(places)}"
                raise RopewalkError(f"{wrong}; write for example [-1.25, 1.25]")
        if contact_coefficient <= 0.0 or contact_power <= 0.0:
            given = f"{contact_coefficient:g} and {contact_power:g}"
            raise RopewalkError(f"contact_coefficient and contact_power must be positive, given {given}")
        self.speed = speed
        self.places = start + np.add.outer(bogie_distances, wheel_distances).ravel()  # (wheel,) m, at the beginning
        self.parameters: dict[str, Any] = {
            "n_carts": 1, "cart_mass": cart_mass, "cart_inertia": cart_inertia,
            "cart_stiffness": cart_stiffness, "cart_damping": cart_damping, "bogie_distances": list(bogie_distances),
            "bogie_mass": bogie_mass, "bogie_inertia": bogie_inertia, "wheel_distances": list(wheel_distances),
            "wheel_mass": wheel_mass, "wheel_stiffness": wheel_stiffness, "wheel_damping": wheel_damping,
            "contact_coefficient": contact_coefficient, "contact_power": contact_power, "gravity_axis": 1,
            "velocity": speed, "wheel_configuration": None, "irr_parameters": None, "joint_parameters": None,
            "initialisation_steps": None, "static_initialisation": False,
        }  # fmt: skip
        self.state: dict[str, Any] = {}
        self._instant = -1
        self._rest: tuple[Array, Array] | None = None

    @property
    def motion(self) -> tuple[Array, Array, Array]:
        """Displacements, velocities and accelerations of all coordinates, (coordinate,) each, m and rad, positive up.

        Body, its pitch (positive: nose down), and of each bogie the frame, its pitch and its two wheels. Displacements
        count from suspensions without load, wheels from rest.
        """
        u, v, a = (np.array(self.state[key], dtype=np.float64) for key in ("u", "v", "a"))
        return u, v, a

    @property
    def static_force(self) -> float:
        """Contact force of a wheel at rest, N, as UVEC shares the weight out."""
        p = self.parameters
        return 9.81 * float(p["wheel_mass"] + 0.5 * (p["bogie_mass"] + 0.5 * p["cart_mass"]))

    def reset(self, line: SeenLine) -> None:
        """Take the line for at rest, and begin anew, in equilibrium."""
        xi = np.linspace(0.0, line.length, _SAMPLES)
        self._rest = xi, np.array([line.at(s)[0][-1] for s in xi])
        self.state, self._instant = {}, -1

    def step(self, t: float, h: float, line: SeenLine) -> list[Touch]:
        """Go on by h to t with the rail as high as the line is under the wheels.

        Raises:
            RopewalkError: the contact forces do not settle, or a wheel lifts off where UVEC's law pulls.
        """
        if self._rest is None:
            self.reset(line)
        self._instant += 1
        xi = self.places + self.speed * t
        rail = np.array([self._rail(s, line) for s in xi])
        dim = line.at(0.0)[0].size
        return [Touch(s, (*(0.0,) * (dim - 1), -F), self.speed) for s, F in zip(xi, self._forces(rail, h), strict=True)]

    def get_state(self) -> Any:
        """Everything that changes in time."""
        return deepcopy((self.state, self._instant))

    def set_state(self, state: Any) -> None:
        """Be what it was when this state was got."""
        self.state, self._instant = deepcopy(state)

    def _rail(self, xi: float, line: SeenLine) -> float:
        """Height of the rail over that at rest, m."""
        height = 0.0
        if 0.0 <= xi <= line.length and self._rest is not None:
            height = float(line.at(xi)[0][-1] - np.interp(xi, *self._rest))
        if self._irregularities is not None:
            height += float(calculate_rail_irregularity(xi, **self._irregularities))
        if self._place_of_joint is not None:
            height += float(calculate_joint_irregularities(xi, **self._place_of_joint))
        return height

    def _forces(self, rail: Array, h: float) -> Array:
        """Contact forces at the end of the step, positive in compression, (wheel,) N."""
        static = self.static_force
        data = {
            "u": {number + 1: [0.0, height, 0.0] for number, height in enumerate(rail)},
            "theta": {}, "loads": {}, "time_index": self._instant, "dt": h, "state": self.state,
            "parameters": self.parameters,
        }  # fmt: skip
        before = np.full(rail.size, np.nan)
        for _ in range(MOST):
            with np.errstate(invalid="ignore"):  # a root of a negative closing, which UVEC makes zero
                data = compute_dynamic_solution(data)
            force = np.array([-load[1] for load in data["loads"].values()])
            if np.abs(force - before).max() <= AGREED * static:  # never true of the first one
                self._refuse_pull(rail)
                return force
            before = force
        raise RopewalkError(
            f"the contact forces of UVEC's wheels do not settle within {MOST} calls; shorten `every`, {h:g} s"
        )

    def _refuse_pull(self, rail: Array) -> None:
        """UVEC's law lets go of a wheel only where its power is not whole."""
        power, G = self.parameters["contact_power"], self.parameters["contact_coefficient"]
        if power != round(power):
            return
        closing = rail + G * self.static_force ** (1.0 / power) - np.array(self.state["u"])[WHEELS]
        if (closing < 0.0).any():
            raise RopewalkError(
                f"a wheel lifts off, which UVEC answers wrongly with contact_power {power:g}; write 1.5 for Hertz"
            )
