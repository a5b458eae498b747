"""Beams whose supports hold them along their axis, so that an axial force arises as they deflect."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.model.joint import Joined
from ropewalk.model.line import Line, spatial
from ropewalk.model.support import Fixed, Guided
from ropewalk.results.frame import RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.watch import Watch

if TYPE_CHECKING:
    from ropewalk.model import Scenario

_MUCH = 0.05  # of what bending bears, in the first mode of the longest span: from here on the axial force counts
_STRAIGHT = 1e-6  # relative difference of length and distance, beyond which tension or sag is intended
_ACROSS = 0.1  # cosine between rail and chord, below which a guided support holds along the chord


class AxialRestraintWatch(Watch):
    """Watches beams without a prescribed tension for the axial force that their supports cause."""

    def _prepare(self) -> None:
        loaded = {load.on for load in self.scenario.loads.values()}
        beams = {name: line for name, line in self.scenario.lines.items() if _is_untensioned(line)}
        self._links = {  # what is joined and bears no load is a strut, with an axial force from elsewhere
            name: self.links_of(name) for name, line in beams.items() if name in loaded or not line.is_joined
        }
        self._most = dict[str, tuple[float, float, float]]()  # share of bending, N, path

    def see(self, frames: Frames) -> None:
        """Take note of frames."""
        for name, links in self._links.items():
            if not links.size:
                continue
            pull = np.nan_to_num(frames.of["tension"][:, links]).mean(axis=1)
            i = int(pull.argmax())
            found = float(pull[i]) / _bending(self.scenario.lines[name]), float(pull[i]), float(frames.path[i])
            self._most[name] = max(self._most.get(name, found), found)

    def messages(self, run_info: RunInfo) -> Iterator[str]:
        """Yield a warning for each beam whose axial force bears much."""
        for name, (share, pull, path) in self._most.items():
            holders = list(_holders(self.scenario, name))
            if share <= _MUCH or len(holders) < 2:
                continue
            yield (
                f"beam {name} is held along its axis by {', '.join(key for key, _ in holders)}: as it deflects, an "
                f"axial force of up to {pull:.4g} N arises ({self.at(path)}) and carries "
                f"{100.0 * share:.3g} % of the load that its bending stiffness carries; "
                f"{_remedy(self.scenario.lines[name], holders)}"
            )


def _is_untensioned(line: Line) -> bool:
    """Return whether a line has bending stiffness, and neither a notable tension nor sag where nothing acts on it."""
    if not line.bending_stiffness or line.sheaves or line.saddles:
        return False
    if line.length is None:
        return (line.tension or 0.0) < _MUCH * _bending(line)
    return abs(line.length - line.distance) <= _STRAIGHT * line.distance


def _bending(line: Line) -> float:
    """Return the tension in N that bears as much as bending and bed in the first mode of the longest span."""
    length = line.length or line.distance
    knots = sorted([0.0, *(support.at for support in line.supports.values()), length])
    wave = math.pi / max(b - a for a, b in pairwise(knots))
    return line.bending_stiffness * wave**2 + line.foundation / wave**2


def _holders(scenario: Scenario, name: str) -> Iterator[tuple[str, bool]]:
    """Yield keys of the supports that hold a line along its chord, by way of lines that are joined to it, too.

    Each with whether it may be replaced by one that slides.
    """
    beam = scenario.lines[name]
    chord = np.subtract(spatial(beam.end), spatial(beam.start))
    joined = any(isinstance(support, Joined) for _, support in beam.ends())
    for other, line in scenario.lines.items():
        if other != name and not (joined and line.bending_stiffness and line.is_joined):
            continue
        supports = [*line.ends(), *((f"supports.{key}", inner) for key, inner in line.supports.items())]
        for key, support in supports:
            if isinstance(support, Joined):
                continue
            if isinstance(support, Guided):
                along = np.array(spatial(support.along))
                cosine = abs(float(along @ chord)) / float(np.linalg.norm(along) * np.linalg.norm(chord))
                if cosine > _ACROSS:
                    continue
            yield f"lines.{other}.{key}", not (isinstance(support, Fixed) and support.clamped)


def _remedy(line: Line, holders: list[tuple[str, bool]]) -> str:
    free = [key for key, slides in holders if slides]
    if not free:
        return "if an end can slide, leave clamped out there, or exclude the force by geometry: linearised"
    along = ", ".join(f"{b - a:.6g}" for a, b in zip(line.start, line.end, strict=True))
    rails = " and of ".join(free[1 - len(holders) :] if len(free) == len(holders) else free)
    kept = ", without a change of at" if "supports." in rails else ""
    return f"if they can slide, write {{kind: guided, along: [{along}]}} instead of {rails}{kept}"
