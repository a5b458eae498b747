"""Contact forces on the modes of a mesh that ring with its shortest waves, and so change with its elements."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ropewalk.model.load import GivenForces
from ropewalk.results.frame import Array, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.watch import Watch

_MUCH = 0.1  # of the mean force: changes from instant to instant in the median; 0.02 where contact forces converge
_FEWEST = 8  # instants, of which a median is taken


class RingingContactsWatch(Watch):
    """Watches the wheels of bodies in linear theory on beams."""

    def _prepare(self) -> None:
        self._own = [
            k for k, name in enumerate(self.loads)
            if (load := self.scenario.loads.get(name)) and not isinstance(load, GivenForces)
            and (line := self.scenario.lines.get(load.on)) and line.bending_stiffness
        ]  # fmt: skip
        self._forces = list[Array]()

    def see(self, frames: Frames) -> None:
        """Keep the vertical contact forces of some frames."""
        if self._own and self.scenario.run.kind == "linear":
            self._forces.append(np.array(frames.of["contact_force"][:, self._own, -1]))

    def messages(self, run_info: RunInfo) -> Iterator[str]:
        """Yield a warning for each load whose contact forces change much between output instants."""
        shares = dict[str, float]()
        forces = np.concatenate(self._forces) if self._forces and run_info.on_splines else np.zeros((0, 0))
        for force, k in zip(forces.T, self._own, strict=False):
            change = np.abs(np.diff(force))
            if np.isfinite(change).sum() >= _FEWEST and (mean := float(np.nanmean(np.abs(force)))) > 0.0:
                shares[self.loads[k]] = max(shares.get(self.loads[k], 0.0), float(np.nanmedian(change)) / mean)
        for name, share in shares.items():
            if share > _MUCH:
                yield (
                    f"contact forces of load {name} change by {100.0 * share:.0f} % of their mean from one output "
                    "instant to the next: in kind: linear wheels ring with the shortest waves of the mesh, and their "
                    "forces change with the number of elements; write kind: dynamic with geometry: linearised"
                )
