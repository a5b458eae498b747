"""Nets and membranes divided into triangles: places, cells, fabrics and what holds their edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.model.line import spatial
from ropewalk.model.net import AnyNet, CableEdge, ClampedEdge, Net, SoftEdge
from ropewalk.system.assembling.surface import Surface, locate, polygon, rectangle
from ropewalk.system.elements.cells import SHEET, THREADS

_SPARE = 1e-4  # what is laid out without tension begins as if it were longer by this share, as nothing holds it flat


@dataclass(frozen=True, eq=False)
class MembraneMesh:
    """A net or membrane as laid out."""

    name: str
    net: AnyNet
    surface: Surface
    origin: Array  # (3,) m, of the plan
    axes: Array  # (2, 3) unit vectors of the plan
    skew: Array  # (2, 2) from [u, v] along the sides to the plan
    scale: Array  # (2,) unstrained over laid-out length
    membrane_elements: Array  # (7,) row of `Cells.fabrics`
    density: float  # kg/m^2 of the unstrained surface
    corners: Integers  # vertices at the corners of the outline

    @property
    def place(self) -> Array:
        """About where all vertices are, (vertex, 3) m: as laid out, but what has no tension sags within its rim."""
        flat = self.origin + self.surface.plan @ self.axes
        spare = float(self.scale.max()) - 1.0
        if spare < 0.0:
            return np.asarray(flat)
        from scipy.spatial import KDTree  # lazy: it takes a while to import

        away = KDTree(self.surface.plan[self.surface.rim]).query(self.surface.plan)[0]
        radius = float(away.max()) or 1.0
        sag = 2.0 * radius * float(np.sqrt(0.375 * max(spare, _SPARE)))  # of a parabola as long as the threads
        normal = np.cross(*self.axes)
        down = np.array([0.0, 0.0, -1.0]) if abs(normal[2]) > 1e-3 else normal
        return np.asarray(flat + (sag * (away / radius) * (2.0 - away / radius))[:, None] * down)

    @property
    def weight(self) -> Array:
        """Mass of each vertex: a quarter of the cells around it, within an outline a third of the triangles, kg."""
        areas = self.surface.areas * self.scale[0] * self.scale[1]
        share = np.full(self.surface.triangle.shape, 1.0 / 3.0)
        if self.net.boundary is None:  # halves of a cell follow each other; the corners on its diagonal belong to both
            other_half = np.arange(len(share)).reshape(-1, 1) ^ 1
            share = np.where(self.surface.across == other_half, 0.5, 0.25)
        mass = np.zeros(self.surface.plan.shape[0])
        np.add.at(mass, self.surface.triangle, share * (self.density * areas)[:, None])
        return mass

    def in_plan(self, way: Array) -> Array:
        """Places in the plan of places [u, v] (n, 2) in m."""
        return np.asarray(way @ self.skew.T)

    def near(self, place: tuple[float, ...]) -> tuple[int, float]:
        """The vertex next to a place [u, v], and how far away it is, m."""
        away = np.hypot(*(self.surface.plan - self.in_plan(np.array([place]))).T)
        return int(away.argmin()), float(away.min())

    def cell_at(self, place: Array, what: str) -> int:
        """The triangle in which a place (2,) of the plan lies.

        Raises:
            RopewalkError: it lies outside.
        """
        cell, _ = locate(self.surface, place)
        if cell < 0:
            raise RopewalkError(
                f"{what} leads over [{place[0]:.4g}, {place[1]:.4g}] m, which is beyond the edge of {self.name}"
            )
        return int(cell)


def sheet_of(name: str, net: AnyNet) -> MembraneMesh:
    """Lay out a net or membrane.

    Raises:
        RopewalkError: its outline cannot be divided.
    """
    try:
        surface, origin, axes, skew, corners = _parallelogram(net) if net.boundary is None else _outline(net)
    except ValueError as error:
        raise RopewalkError(f"nets: {name}: {error}") from None
    scale = _scale(net)
    if isinstance(net, Net):
        across = _mesh(net)
        A = net.axial_stiffness / (across * scale[::-1])
        c = net.axial_damping / (across * scale[::-1])
        membrane_elements = np.array([THREADS, *A, *c, *scale])
        density = float((net.mass / (across * scale[::-1])).sum())
    else:
        membrane_elements = np.array([SHEET, net.stiffness, net.poisson, net.damping, 0.0, *scale])
        density = net.mass
    return MembraneMesh(name, net, surface, origin, axes, skew, scale, membrane_elements, density, corners)


def _mesh(net: Net) -> Array:
    """Distance of the threads that run along u, and of those along v, as laid out, m."""
    if net.mesh is not None:
        return np.full(2, net.mesh)
    assert net.sides is not None
    a, b = (float(np.linalg.norm(spatial(side))) for side in net.sides)
    m, n = net.divisions
    return np.array([b / n, a / m])


def _parallelogram(net: AnyNet) -> tuple[Surface, Array, Array, Array, Integers]:
    assert net.corner is not None
    assert net.sides is not None
    first, second = (np.array(spatial(side)) for side in net.sides)
    a, b = float(np.linalg.norm(first)), float(np.linalg.norm(second))
    along = first / a
    across = second - (second @ along) * along
    across /= np.linalg.norm(across)
    skew = np.array([[1.0, second @ along / b], [0.0, second @ across / b]])
    m, n = net.divisions
    flat = rectangle((a, b), (m, n))
    surface = Surface(flat.plan @ skew.T, flat.triangle, flat.across, flat.rim)
    corners = np.array([0, m, (m + 1) * (n + 1) - 1, (m + 1) * n])
    return surface, np.array(spatial(net.corner)), np.array([along, across]), skew, corners


def _outline(net: AnyNet) -> tuple[Surface, Array, Array, Array, Integers]:
    assert net.boundary is not None
    assert net.spacing is not None
    points = np.array([spatial(point) for point in net.boundary])
    origin, size = points[0], float(np.ptp(points, axis=0).max())
    normal = 0.5 * np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    if np.linalg.norm(normal) < 1e-9 * size**2:
        raise ValueError("boundary: the outline has no area")
    normal /= np.linalg.norm(normal)
    off = float(np.abs((points - origin) @ normal).max())
    if off > 1e-6 * size:
        raise ValueError(f"boundary: the corners do not lie in one plane, by {off:.3g} m; nets are laid out flat")
    along = points[1] - points[0]
    along = along / np.linalg.norm(along)
    axes = np.array([along, np.cross(normal, along)])
    plan = (points - origin) @ axes.T
    surface = polygon(plan, net.spacing)
    corners = np.array([int(np.hypot(*(surface.plan - corner).T).argmin()) for corner in plan])
    return surface, origin, axes, np.eye(2), corners


def _scale(net: AnyNet) -> Array:
    """Unstrained over laid-out length along u and v."""
    if net.slack is not None:
        return np.full(2, net.slack)
    if net.tension is None:
        return np.ones(2)
    tension = np.broadcast_to(np.array(net.tension, dtype=float), 2)
    if isinstance(net, Net):
        return np.asarray(1.0 / (1.0 + tension / net.axial_stiffness))
    return _biaxial(net.stiffness, net.poisson, tension)


def _biaxial(stiffness: float, poisson: float, tension: Array) -> Array:
    """Unstrained over laid-out length of a sheet under two tensions per width as laid out.

    With the stretches s, the strains e = (s^2 - 1)/2 and S = A/(1 - nu^2) (e_i + nu e_j): N_i = s_i/s_j S_i, which is
    solved for by Newton's method.
    """
    stretch = 1.0 + (tension - poisson * tension[::-1]) / stiffness
    k = stiffness / (1.0 - poisson**2)
    couple = np.array([[1.0, poisson], [poisson, 1.0]])
    for _ in range(50):
        S = k * couple @ (0.5 * (stretch**2 - 1.0))
        ratio = stretch / stretch[::-1]
        miss = ratio * S - tension
        J = ratio[:, None] * k * couple * stretch
        J += np.array([[S[0] / stretch[1], -ratio[0] * S[0] / stretch[1]],
                       [-ratio[1] * S[1] / stretch[0], S[1] / stretch[0]]])  # fmt: skip
        step = np.linalg.solve(J, miss)
        stretch = stretch - step
        if np.abs(step).max() < 1e-14:
            break
    return np.asarray(1.0 / stretch)


def restrained_at_edge(sheet: MembraneMesh) -> tuple[Integers, Integers, Array, Array]:
    """What holds the edge: fixed vertices; vertices on springs, with stiffness (N/m) and damping (N s/m) of each."""
    edge, rim, none = sheet.net.edge, sheet.surface.rim, np.zeros(0, dtype=np.int64)
    if isinstance(edge, ClampedEdge):
        return rim, none, np.zeros(0), np.zeros(0)
    if isinstance(edge, CableEdge):
        return sheet.corners, none, np.zeros(0), np.zeros(0)
    assert isinstance(edge, SoftEdge)
    plan = sheet.surface.plan[rim]
    piece = np.hypot(*(np.roll(plan, -1, axis=0) - plan).T)
    share = 0.5 * (piece + np.roll(piece, 1))
    return none, rim, edge.stiffness * share, edge.damping * share
