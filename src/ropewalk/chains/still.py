"""Plain ropes at rest: equilibrium with the loads at their start, and slow motion of the loads along their ways."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ropewalk.chains.frames import layout_of
from ropewalk.chains.many_bodies import ManyBodies, displayed
from ropewalk.model.scenario import Scenario
from ropewalk.results.audit import energies
from ropewalk.results.frame import STICKS, Contacts, Frame, Layout, RunInfo
from ropewalk.solve.diagnostics import Diagnostics
from ropewalk.solve.loaded_equilibrium import View
from ropewalk.solve.path_measure import shapes
from ropewalk.solve.quasistatic import LoadPosition, walk
from ropewalk.solve.start import PreparedRun, setting_of
from ropewalk.solve.vehicle_statics import loaded_bodies, potential_of


class ChainStatics:
    """A run without inertia: its layout, and its frames.

    Args:
        scenario: what is computed.
        run_info: filled in.
        until: how long the histories of the loads are needed, s.

    Raises:
        EquilibriumError: a line has no rest shape.
    """

    def __init__(self, scenario: Scenario, run_info: RunInfo, until: float) -> None:
        self.setting, self.run_info = setting_of(scenario, until), run_info
        run_info.method, run_info.reason = "rest", "least potential energy"
        self._diagnostics = Diagnostics(self.setting, tuple(scenario.loads))

    @property
    def layout(self) -> Layout:
        """Names and coordinates of the result."""
        return layout_of(self.setting, "load_path")

    def loaded(self) -> Frame:
        """The only frame of an equilibrium."""
        xi = self.setting.xi
        marks, left = np.zeros(xi.size), np.zeros(xi.size, dtype=np.bool_)
        return self._frame(LoadPosition(0.0, 0.0, xi, marks, *shapes(self.setting, xi, 0.0), left))

    def slowly(self, positions: int, turn: float | None) -> Iterator[Frame]:
        """Yield frames at equal steps of the load path, until all loads have left their lines or stopped.

        Args:
            positions: how many.
            turn: rad, see `solve/following.py`.

        Raises:
            EquilibriumError: no load moves, or there is no equilibrium with the loads somewhere on their path.
        """
        for place in walk(self.setting, positions, turn):
            yield self._frame(place)

    def _frame(self, place: LoadPosition) -> Frame:
        self.run_info.warnings += self._diagnostics.on(place)
        return loaded_frame(self.setting, place)


def loaded_frame(setting: PreparedRun, at: LoadPosition) -> Frame:
    """The frame of loads standing still; supports that move are taken at the time of the place."""
    strands, dim, count = setting.strands, len(setting.axes), at.xi.size
    seen = Contacts(count, dim)
    position, tension, strain, reaction = [], [], [], []
    elastic = gravitational = 0.0
    for s, rest in enumerate(at.stands):
        on, last = setting.on[s], rest.X.size - 1
        view = View.of(rest, strands.law[s], float(strands.h[s]))
        position.append(view.position)
        tension.append(view.tension)
        strain.append(view.strain)
        elastic, gravitational = elastic + view.elastic, gravitational + view.gravitational
        seen.position[on], seen.force[on], seen.tension[on] = rest.r[:, rest.contact].T, rest.force.T, rest.beside
        seen.friction[on] = rest.friction
        left, right = -rest.pull[:, 0] - rest.weight[:, 0], rest.pull[:, -1] - rest.weight[:, -1]
        for k, i in enumerate(rest.contact):
            if at.left[on[k]]:  # the ground bears it, not the support
                continue
            if i == 0:
                left = left - rest.force[:, k]
            elif i == last:
                right = right - rest.force[:, k]
        reaction += [left, right]
        restrained = setting.restrained(s, at.t)
        if not restrained.is_fast:
            ends = rest.r[:, [0, -1]].T
            moved = ends - restrained.place
            elastic += 0.5 * float(np.einsum("ea,eab,eb", moved, restrained.stiffness, moved))
            gravitational -= float((restrained.force * moved).sum())
    nodes, bodies = np.concatenate(position), np.zeros((0, dim))
    potential = 0.0
    if setting.multibody_system is not None:
        loaded = loaded_bodies(setting.multibody_system.bodies, seen.position.T)
        bodies = displayed(setting, nodes.T[None], ManyBodies.now(loaded, dim), ~at.left[None])[0][0]
        potential = potential_of(loaded, setting.strands.gravity)
    seen.hold, seen.xi, seen.speed = seen.force - at.given, at.xi.copy(), np.zeros(count)
    seen.state[:] = STICKS
    seen.leave(at.left)
    return Frame(
        path=at.path,
        position=nodes,
        velocity=np.zeros_like(nodes),
        tension=np.concatenate(tension),
        strain=np.concatenate(strain),
        **seen.fields(),
        body_position=bodies,
        body_velocity=np.zeros_like(bodies),
        reaction=np.array(reaction),
        energy=energies(elastic=elastic, gravitational=gravitational, load_potential=potential),
    )
