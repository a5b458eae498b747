"""Networks at rest: equilibrium with the loads at their start, and quasi-static motion along their paths."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.model.scenario import Scenario
from ropewalk.networks.frames import NetworkFrameBuilder
from ropewalk.networks.internal_forces import blown
from ropewalk.networks.network import OFF, Array
from ropewalk.networks.rest import Slip, put_slip, settle, size_of, slip_of, stand
from ropewalk.results.frame import Frame, Layout, RunInfo
from ropewalk.solve.following import quasistatic_motion, schedule

# Rounds in which a network finds its rest in the wind, and the move over its size that is none any more.
_ROUNDS, _NEAR = 100, 1e-10


class NetworkStatics:
    """A run without inertia: its layout, and its frames.

    Args:
        scenario: what is computed.
        run_info: filled in.
        until: how long the histories of the loads are needed, s.

    Raises:
        RopewalkError: the network cannot be laid out, or has no rest.
    """

    def __init__(self, scenario: Scenario, run_info: RunInfo, until: float) -> None:
        self._builder = NetworkFrameBuilder(scenario, run_info, until)
        self.network = self._builder.network
        run_info.method, run_info.reason = "rest", "least potential energy"

    @property
    def layout(self) -> Layout:
        """Names and coordinates of the result."""
        return self._builder.layout

    def loaded(self) -> Frame:
        """The only frame of an equilibrium: at rest with the loads at their start."""
        r = self._builder.rest.copy()
        stand(self.network, r, 0.0)
        r = self._settled(r, 0.0)
        self._builder.note_slack(r)
        return self._builder.build(r, 0.0, 0.0)

    def slowly(self, positions: int, turn: float | None) -> Iterator[Frame]:
        """Frames at equal steps of the path of the first load, until it comes to the end of its way.

        Args:
            positions: how many.
            turn: rad, see `solve/following.py`.

        Raises:
            EquilibriumError: the first load has no way, or there is no rest with the loads somewhere on it.
        """
        network, begin = self.network, (self._builder.rest, slip_of(self.network))

        def rest(t: float, near: tuple[Array, Slip] | None) -> tuple[Array, Slip]:
            r, slip = near if near is not None else begin
            r = r.copy()
            put_slip(network, slip)
            stand(network, r, t)
            r = self._settled(r, t)
            return r, slip_of(network)

        def places(shape: tuple[Array, Slip]) -> Array:
            return np.where((network.locations.kind != OFF)[:, None], shape[0][network.nodes :], np.nan)

        for at in quasistatic_motion(rest, places, *self._schedule(), positions, turn):
            r, slip = at.shape
            put_slip(network, slip)
            stand(network, r, at.t)
            yield self._builder.build(r, at.path, at.t)

    def _schedule(self) -> tuple[Array, Array]:
        """Times and paths of the first load."""
        course = self.network.course
        low, end = float(course.low[0]), float(course.high[0])
        own = slice(course.first[0], course.first[0] + course.knots[0])
        time, start, speed, slope = (a[own] for a in (course.time, course.place, course.speed, course.slope))

        def place(times: Array) -> Array:
            i = np.maximum(np.searchsorted(time, times, side="right") - 1, 0)
            late = np.maximum(times - time[i], 0.0)
            return np.asarray(start[i] + late * (speed[i] + 0.5 * slope[i] * late))

        return schedule(self._builder.laid.moving_loads[0].name, place, end, low)

    def _settled(self, r: Array, t: float) -> Array:
        """Rest (node, 3) in the wind as it blows at time t in s, next to the shape r: what it pushes at depends on it.

        Raises:
            EquilibriumError: there is none.
        """
        network = self.network
        if not network.wind.direction.any():
            return settle(network, r, rubs=True)
        own = network.body.force.copy()
        try:
            for _ in range(_ROUNDS):
                network.body.force[:] = own + blown(network, t, r)
                last, r = r, settle(network, r, rubs=True)
                if float(np.abs(r - last).max()) <= _NEAR * size_of(r):
                    return r
        finally:
            network.body.force[:] = own
        raise EquilibriumError("no equilibrium was found in the wind: lines flutter or lift; lower wind.speed")
