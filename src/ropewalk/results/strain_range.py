"""Strains compared with the range in which the law of their line is known: misprints and mistaken units."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.model.net import AnyNet, Membrane
from ropewalk.model.plausibility import StrainRange, known_strain, strain_range
from ropewalk.results.frame import RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.watch import Watch

if TYPE_CHECKING:
    from ropewalk.model import Scenario

_EPS = 1e-9


class StrainRangeWatch(Watch):
    """Watches lines, overhead wires and surfaces for the strain that is farthest beyond the range of its law."""

    def _prepare(self) -> None:
        layout, scenario = self.layout, self.scenario
        names = list(dict.fromkeys(layout.link_line))
        self._ranges = {name: _range_of(scenario, name) for name in names}
        self._low = np.array([self._ranges[name].low for name in layout.link_line])
        self._high = np.array([self._ranges[name].high for name in layout.link_line])
        self._worst = dict[str, tuple[float, float, int, float, float, float]]()
        self._widths = {
            name: _stiffness_per_width(net) for name, net in scenario.nets.items() if name in layout.cell_net
        }
        self._surfaces = dict[str, tuple[float, float, float]]()  # strain, tension per width in N/m, path

    def see(self, frames: Frames) -> None:
        """Take note of frames."""
        for name, stiffness in self._widths.items():
            pull = np.nan_to_num(frames.of["cell_tension"][:, np.array(self.layout.cell_net) == name].max(axis=(1, 2)))
            most = int(pull.argmax())
            found = float(pull[most]) / stiffness, float(pull[most]), float(frames.path[most])
            self._surfaces[name] = max(self._surfaces.get(name, found), found)
        strain = np.nan_to_num(frames.of["strain"])
        beyond = np.maximum(strain - self._high, self._low - strain)
        if not beyond.size or beyond.max() <= _EPS:
            return
        for name in {self.layout.link_line[int(link)] for link in np.flatnonzero((beyond > _EPS).any(axis=0))}:
            own = self.links_of(name)
            i, k = np.unravel_index(int(beyond[:, own].argmax()), (len(frames), own.size))
            link, value = int(own[k]), float(beyond[i, own[k]])
            if value > self._worst.get(name, (0.0,))[0]:
                pull, x = float(frames.of["tension"][i, link]), self._x(frames.of["position"][i], name, link)
                self._worst[name] = value, float(strain[i, link]), link, float(frames.path[i]), pull, x

    def _x(self, position: np.ndarray, name: str, link: int) -> float:
        """Return x of the middle of a link, m."""
        own = self.nodes_of(name)
        return float(np.interp(self.layout.link_xi[link], self.layout.node_xi[own], position[own, 0]))

    def messages(self, run_info: RunInfo) -> Iterator[str]:
        """Yield a warning for each line, with place, instant, strain, tension, limit and remedy."""
        for name, (strain, pull, path) in self._surfaces.items():
            known_high, reason = known_strain(_speed(self.scenario.nets[name]))
            if strain > known_high:
                yield (
                    f"{name} has a strain of about {100.0 * strain:.3g} % and a tension of {pull:.4g} N/m, "
                    f"{self.at(path)}; its law is known up to {100.0 * known_high:.3g} % ({reason}): check "
                    f"nets.{name} and the loads for mistaken units"
                )
        for name, (_, strain, link, path, pull, x) in self._worst.items():
            known = self._ranges[name]
            limit = known.high if strain > 0.0 else known.low
            yield (
                f"{name} has a strain of {100.0 * strain:.3g} % and a tension of {pull:.4g} N at x = {x:.4g} m, "
                f"xi = {self.layout.link_xi[link]:.4g} m, {self.at(path)}; its law is known up to "
                f"{100.0 * limit:.3g} % ({known.reason}): {_remedy(self.scenario, name)}"
            )


def _range_of(scenario: Scenario, name: str) -> StrainRange:
    """Return the strains between which the law of a line or overhead wire is known."""
    if name in scenario.lines:
        return strain_range(scenario.lines[name])
    owner = name.partition(".")[0]
    known = owner in scenario.overhead_lines
    return StrainRange(-np.inf, 0.01 if known else np.inf, "up to which copper wires and ropes are elastic")


def _speed(net: AnyNet) -> float:
    """Return the speed of waves along the threads or in the skin of a net, m/s."""
    return math.sqrt((net.stiffness if isinstance(net, Membrane) else net.axial_stiffness) / net.mass)


def _stiffness_per_width(net: AnyNet) -> float:
    """Return the stiffness per width in N/m; infinite for a net whose mesh is not declared."""
    if isinstance(net, Membrane):
        return net.stiffness
    return math.inf if net.mesh is None else net.axial_stiffness / net.mesh


def _remedy(scenario: Scenario, name: str) -> str:
    line = scenario.lines.get(name)
    if line is None:
        return "check tensions, stiffnesses and loads for mistaken units"
    keys = "law" if line.axial_stiffness is None else "axial_stiffness"
    size = "tension" if line.length is None else f"length ({line.length:g} m, its path is {line.distance:g} m)"
    return f"check lines.{name}.{keys} and {size}, and the loads, for mistaken units"
