"""How far a load has come along its path, as its speed is measured: shapes for places of the loads, and their paths."""

from __future__ import annotations

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import HORIZONTAL, MATERIAL, SLIP, Array
from ropewalk.mechanics.moving_contact import force_at
from ropewalk.solve.loaded_equilibrium import LoadedStrand, stand
from ropewalk.solve.start import PreparedRun
from ropewalk.solve.vehicle_statics import agree, weights_of_wheels


def shapes(
    setting: PreparedRun, xi: Array, t: float, before: list[LoadedStrand] | None = None
) -> tuple[list[LoadedStrand], Array]:
    """The rest shapes of all strands with the loads at xi, and the forces at time t with which these press on them.

    What has a mass presses with its weight, vehicles as their springs share it among wheels of different heights.
    """
    loads, dim = setting.loads, len(setting.axes)
    given = np.array([[force_at(loads, k, t, a) for a in range(dim)] for k in range(xi.size)]).reshape(xi.size, dim)
    if setting.multibody_system is None:
        return _shapes(setting, xi, t, given, before), given
    bodies = setting.multibody_system.bodies
    given += weights_of_wheels(bodies, setting.strands.gravity).T
    found: list[LoadedStrand] = []

    def give_way(force: Array) -> Array:
        """Places (axis, wheel) of all wheels under forces of the vehicles."""
        found[:] = _shapes(setting, xi, t, given + force.T, before)
        return contact_places(setting, found)

    force = agree(bodies, give_way, np.zeros((dim, xi.size)))
    return found, given + force.T


def contact_places(setting: PreparedRun, stands: list[LoadedStrand]) -> Array:
    """Where all loads touch their lines, (axis, wheel) m."""
    place = np.zeros((len(setting.axes), setting.xi.size))
    for on, rest in zip(setting.on, stands, strict=True):
        place[:, on] = rest.r[:, rest.contact]
    return place


def _shapes(
    setting: PreparedRun, xi: Array, t: float, given: Array, before: list[LoadedStrand] | None
) -> list[LoadedStrand]:
    """The rest shapes of all strands under given forces (load, axis)."""
    out = []
    for s in range(setting.strands.first.size):
        on, contacts = setting.on[s], setting.contacts[s]
        similar = before[s] if before is not None else None
        try:
            out.append(stand(setting.strands, s, setting.restrained(s, t), xi[on], given[on].T, contacts, similar))
        except EquilibriumError as error:
            raise EquilibriumError(f"line {setting.lines[s]}: {error}") from None
    return out


class Measure:
    """How far a load has come along its path, as its speed is measured."""

    def __init__(self, setting: PreparedRun, k: int) -> None:
        self.setting, self.k = setting, k
        self.s = int(setting.loads.strand[k])
        self.kind = int(setting.loads.measure[k])
        self.number = int(np.flatnonzero(np.flatnonzero(setting.loads.strand == self.s) == k)[0])

    def of(self, xi: float, stands: list[LoadedStrand]) -> float:
        """Path up to xi: material coordinate, arc length or x; for slip the mean stretch there."""
        rest = stands[self.s]
        i = int(rest.contact[self.number])
        if self.kind == MATERIAL:
            return xi
        if self.kind == HORIZONTAL:
            return float(rest.r[0, i])
        length = np.sqrt((np.diff(rest.r, axis=1) ** 2).sum(axis=0))
        if self.kind == SLIP:
            lam = length / np.diff(rest.X)
            return float(0.5 * (lam[max(i - 1, 0)] + lam[min(i, lam.size - 1)]))
        return float(length[:i].sum())


def buffers(setting: PreparedRun, measure: Measure, begin: float, *, forward: bool) -> float:
    """Path from the start of a load to the end of its line, as measured (slip: by a first walk along the line)."""
    s, k = measure.s, measure.k
    strands, bare, xi = setting.strands, setting.bare[s], float(setting.xi[k])
    length = float(strands.links[s] * strands.h[s])
    if measure.kind == MATERIAL:
        buffers = length - xi if forward else xi
    elif measure.kind == HORIZONTAL:
        first, last = (float(end[0]) for end in setting.ends[s].place)
        buffers = last - begin if forward else begin - first
    elif measure.kind != SLIP:
        arc = float(np.sqrt((np.diff(bare.r, axis=1) ** 2).sum(axis=0)).sum()) if bare is not None else length
        buffers = arc - begin if forward else begin
    else:
        grid, places = np.linspace(xi, length if forward else 0.0, 101), setting.xi.copy()
        lam: list[float] = []
        stands = None
        for x in grid:
            places[k] = x
            try:
                stands, _ = shapes(setting, places, 0.0, stands)
            except EquilibriumError:  # the walk will end there and say why
                lam += [lam[-1]] * (grid.size - len(lam))
                break
            lam.append(measure.of(float(x), stands))
        buffers = abs(float(np.trapezoid(lam, grid)))
    return max(buffers, 1e-300)
