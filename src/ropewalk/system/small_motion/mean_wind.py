"""Wind as small motion knows it: rest in the mean wind, what changes about it, and gusts.

A wind of the speed U + u(t) pushes at what stands still with F (1 + 2 u/U) to the first order, F of the mean wind U.
About the rest in this, air damps and turns with the lines (`elements/air.py`). Motion begins where lines rest in calm
air, as it does with all geometry.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg

from ropewalk.mechanics.chain import Array
from ropewalk.model.mean_speed import MeanSpeed
from ropewalk.results.frame import RunInfo
from ropewalk.solve.crossings import CLOSE
from ropewalk.solve.superposition import Gusts
from ropewalk.system.elements.structure import Structure
from ropewalk.system.equilibrium.rest import settled_in_wind
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.loads.loaded_structure import LoadedStructure

_STRONG = 0.5  # of the mean: gusts of which a quarter of the mean force is left out
_FAR = 0.3  # of the way from calm air to the rest in the wind: what linear theory may miss of it


class RestInWind:
    """A structure where it rests in the mean wind.

    Args:
        structure: with all its geometry.
        calm: (axis, node) m, at rest in calm air.
        speed: of the wind.
        until: end of the run, s.
        within: whether only what stays in the plane needs to be stable.

    Raises:
        EquilibriumError: there is no such rest.
    """

    def __init__(self, structure: Structure, calm: Array, speed: MeanSpeed, until: float, *, within: bool) -> None:
        self._wind, self._mean, self._until = structure.wind, speed.mean, until
        steady = structure.wind._replace(time=np.zeros(1), speed=np.array([speed.mean]))
        self.structure = structure._replace(wind=steady)
        size = float(np.ptp(calm, axis=1).max())
        potential = SystemPotential(self.structure, LoadedStructure(self.structure, calm), size, within=within)
        if structure.saddles is not None:  # friction there holds lines where they lie in calm air
            slips = potential.how
            potential.stick(potential.taken())
            potential.how = slips
        shape = settled_in_wind(potential, potential.taken(), 0.0)
        self.rest = potential.put(shape)[0].copy()
        self.pushed: Array = potential.blown.ravel().copy()  # (place,) N, by the mean wind
        self.moved: Array = (calm - self.rest).ravel()  # (place,) m, from there to where motion begins

    def doubt_start(self, K: sparse.csc_matrix, free: sparse.csr_matrix, run_info: RunInfo) -> None:
        """Doubt a run that begins, in calm air, farther from its rest than linear theory reaches.

        Args:
            K: (unknown, unknown) N/m, about the rest in the wind.
            free: (place, unknown), places moved by unknowns.
            run_info: of the run.
        """
        known = -free @ np.asarray(scipy.sparse.linalg.spsolve(K, free.T @ self.pushed)).reshape(-1)
        missed, way = (float(np.abs(part).max(initial=0.0)) for part in (known - self.moved, self.moved))
        if missed > _FAR * way:
            what = f"the mean wind moves lines by up to {way:.2g} m, and linear theory misses {missed:.2g} m of that"
            cause = "that far from calm air, where motion begins, their stiffness is another one"
            run_info.doubt(what, cause, "wind.speed", "ask for kind: dynamic")

    @property
    def gusts(self) -> Gusts:
        """Their force on all places."""
        return Gusts(self.pushed, self._part)

    @property
    def instants(self) -> Array:
        """Between which the wind changes in proportion with time, s."""
        return self._wind.time

    def _part(self, t: float) -> float:
        """How much more the wind pushes at t in s, and just before, than the mean one, over its force."""
        time, speed = self._wind.time, self._wind.speed
        i = int(np.searchsorted(time, t - CLOSE * self._until))
        if i in (0, time.size):
            U = float(speed[min(i, time.size - 1)])
        else:
            U = float(speed[i - 1] + (t - time[i - 1]) / (time[i] - time[i - 1]) * (speed[i] - speed[i - 1]))
        return 2.0 * (U / self._mean - 1.0)


def unknowns_at(moved: Array, free: sparse.csr_matrix) -> Array:
    """Unknowns that are nearest to displacements of all places (place,) in m.

    Args:
        moved: of the places.
        free: (place, unknown), places moved by unknowns.
    """
    normal = (free.T @ free).tocsc()
    return np.asarray(scipy.sparse.linalg.spsolve(normal, free.T @ moved)).reshape(-1)


def doubt_gusts(speed: MeanSpeed, run_info: RunInfo) -> None:
    """Doubt a run in whose gusts linear theory leaves much of their force out."""
    if speed.most > _STRONG * abs(speed.mean):
        missed = (speed.most / speed.mean) ** 2
        what = f"gusts change the wind by up to {speed.most:.3g} m/s about its mean of {speed.mean:.3g} m/s"
        cause = f"drag grows with its square: linear theory leaves out up to {missed:.2g} of the mean force"
        run_info.doubt(what, cause, "wind.speed", "ask for kind: dynamic")
