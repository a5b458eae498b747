"""Rest: the shape of least potential energy of one strand under dead forces, between supports that may yield."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import kernel
from ropewalk.mechanics.link import link_force, stretch
from ropewalk.mechanics.stiffness import strand_blocks
from ropewalk.solve.banded import factorise, substitute
from ropewalk.solve.catenary_shooting import hang, p_scale, pulls
from ropewalk.solve.end_conditions import LENT, EndConditions
from ropewalk.solve.sensitivity import NotBesideError, Rests, Solve, present

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StrandAtRest:
    """A strand at rest."""

    position: Array  # (axis, node) m
    first_force: Array  # (axis,) N, force vector of the first link: the start value for a similar shape
    pull: Array  # (axis, link) N, force vectors of the links
    strain: Array  # (link,)
    residual: float  # largest unbalanced nodal force, N


@kernel
def residual(p, ell, f, r, force, out):
    """Unbalanced force on the inner nodes (node - 2, axis), minus the gradient of the potential energy; its maximum."""
    dim, n = r.shape[0], ell.size
    for i in range(n):
        q = link_force(p, 0.0, ell[i], 0.0, r, i)
        if not np.isfinite(q) and law.tension(p, -1.0) == 0.0:
            q = 0.0  # a slack link whose ends have met
        for a in range(dim):
            force[a, i] = q * (r[a, i + 1] - r[a, i])
    worst = 0.0
    for i in range(1, n):
        for a in range(dim):
            out[i - 1, a] = force[a, i] - force[a, i - 1] + f[a, i]
            if not abs(out[i - 1, a]) <= worst:  # written so that NaN is found
                worst = abs(out[i - 1, a])
    return worst


@kernel
def potential(p, ell, f, r):
    """Potential energy of a strand in J: stored energy minus the work of the dead forces."""
    total = 0.0
    for i in range(ell.size):
        square = 0.0
        for a in range(r.shape[0]):
            square += (r[a, i + 1] - r[a, i]) ** 2
        total += ell[i] * law.stored(p, np.sqrt(square) / ell[i] - 1.0)
        if i > 0:
            for a in range(r.shape[0]):
                total -= f[a, i] * r[a, i]
    return total


class _Stiffness:
    """The stiffness of the inner nodes, factorised. Python calls small kernels: one big kernel compiles for long."""

    def __init__(self, p: Array, ell: Array, dim: int) -> None:
        m = ell.size - 1
        self.p, self.ell = p, ell
        self.unit = float(p_scale(p) / ell.min())
        self.diagonal, self.inverse, self._unused = (np.zeros((m, dim, dim)) for _ in range(3))
        self.off, self.ratio, self._unused_off = (np.zeros((max(m - 1, 1), dim, dim)) for _ in range(3))

    def factorise(self, r: Array, shift: float, *, pulling: bool = False) -> bool:
        """Factorise with a shift, and without thrust if only pulling counts; False if it is not positive definite."""
        strand_blocks(self.p, 0.0, self.ell, r, self.diagonal, self.off, self._unused, self._unused_off)
        if pulling:
            _drop_thrust(self.p, self.ell, r, self.diagonal, self.off)
        axis = np.arange(r.shape[0])
        self.diagonal[:, axis, axis] += shift
        fine = factorise(self.diagonal, self.off, self.off, self.inverse, self.ratio)
        return bool(fine and _is_positive(self.inverse))

    def solve(self, x: Array) -> Array:
        """Solve for the right-hand side x (node - 2, axis), which is overwritten."""
        substitute(self.off, self.inverse, self.ratio, x)
        return x


@kernel
def _drop_thrust(p, ell, r, diagonal, off):
    """Leave out what makes the stiffness indefinite: the push of links in compression across their direction."""
    dim, n = r.shape[0], ell.size
    for i in range(n):
        length = stretch(r, i)
        across = -law.tension(p, length / ell[i] - 1.0) / length
        if not across > 0.0:
            continue
        for a in range(dim):
            for b in range(dim):
                part = -across * (r[a, i + 1] - r[a, i]) * (r[b, i + 1] - r[b, i]) / (length * length)
                if a == b:
                    part += across
                if i > 0:
                    diagonal[i - 1, a, b] += part
                if i < n - 1:
                    diagonal[i, a, b] += part
                if 0 < i < n - 1:
                    off[i - 1, a, b] -= part


@kernel
def _is_positive(blocks):
    """Whether symmetric blocks of order two or three are all positive definite."""
    for i in range(blocks.shape[0]):
        m = blocks[i]
        minor = m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0]
        if not (m[0, 0] > 0.0 and minor > 0.0):
            return False
        if m.shape[0] == 3:
            last = m[2, 0] * (m[0, 1] * m[1, 2] - m[0, 2] * m[1, 1])
            last -= m[2, 1] * (m[0, 0] * m[1, 2] - m[0, 2] * m[1, 0])
            if not last + m[2, 2] * minor > 0.0:
                return False
    return True


def _descend(stiffness: _Stiffness, f: Array, r: Array, tolerance: float, most: int) -> float:
    """Newton's method on the potential energy, with a shift where it is not convex; r is changed.

    Returns:
        The largest unbalanced force that is left, N.
    """
    p, ell, unit = stiffness.p, stiffness.ell, stiffness.unit
    force, g = np.zeros((r.shape[0], ell.size)), np.zeros((ell.size - 1, r.shape[0]))
    new = g.copy()
    worst = residual(p, ell, f, r, force, g)
    energy, shift, poor = potential(p, ell, f, r), 0.0, 0
    for _ in range(most):
        if worst <= tolerance or not np.isfinite(worst) or poor > (2 if worst < 1e7 * tolerance else 100):
            break
        fine, before = False, r.copy()
        if stiffness.factorise(r, shift) or stiffness.factorise(r, max(shift, 1e-14 * unit), pulling=True):
            x = stiffness.solve(g.copy())
            r[:, 1:-1] += x.T
            change = potential(p, ell, f, r) - energy
            now = residual(p, ell, f, r, force, new)
            # Where the change of energy is all rounding error, its slope along the step decides.
            level = abs(change) <= 1e-12 * abs(energy)
            falls = now < worst or (new * x).sum() > -0.8 * (g * x).sum() if level else change < 0.0
            fine = bool(np.isfinite(now) and falls)
        if fine:
            poor = poor + 1 if level and now > 0.5 * worst else 0
            worst, energy = now, energy + change
            g, new = new, g
            shift = 0.1 * shift if shift > 1e-13 * unit else 0.0
        else:
            r[:] = before
            shift = max(10.0 * shift, 1e-12 * unit)
            if shift > 1e3 * unit:
                break
    return float(worst)


def _leave_saddle(stiffness: _Stiffness, f: Array, r: Array) -> bool:
    """Move along a direction of negative curvature, if there is one and it leads to less energy; r is changed.

    A straight chain in compression is in balance, too, and where everything lies on one line nothing else tells
    which way to buckle.
    """
    if stiffness.factorise(r, 0.0):
        return False
    p, ell = stiffness.p, stiffness.ell
    shift = 1e-12 * stiffness.unit
    while not stiffness.factorise(r, shift):
        shift *= 2.0
        if not shift < 1e6 * stiffness.unit:
            return False
    dim, m = r.shape[0], ell.size - 1
    v = 1.0 + 0.5 * np.cos(2.0 * np.arange(m)[:, None] + np.arange(dim))
    for _ in range(12):
        v = stiffness.solve(v)
        v /= np.abs(v).max()
    energy, before, size = potential(p, ell, f, r), r.copy(), 0.5 * ell.min()
    for _ in range(40):
        for way in (size, -size):
            r[:, 1:-1] = before[:, 1:-1] + way * v.T
            if potential(p, ell, f, r) < energy - 1e-13 * abs(energy):
                return True
        size *= 0.5
    r[:] = before
    return False


def polish(p: Array, ell: Array, f: Array, r: Array, tolerance: float, most: int) -> float:
    """Move the nodes to the least potential energy nearby; r is changed.

    Returns:
        The largest unbalanced force that is left, N.
    """
    stiffness = _Stiffness(p, ell, r.shape[0])
    worst = _descend(stiffness, f, r, tolerance, most)
    for _ in range(20):
        if not _leave_saddle(stiffness, f, r):
            break
        worst = _descend(stiffness, f, r, tolerance, most)
    return worst


def hang_up(
    p: Array, ell: Array, f: Array, restrained: EndConditions, guess: Array | None = None
) -> tuple[Array, Array, float]:
    """Find the shape in which every link pulls, and the force vector of its first link.

    Args:
        p: axial law, see mechanics/law.py.
        ell: (link,) unstrained lengths, m.
        f: (axis, node) dead forces on the nodes, N, with those of the supports on the first and the last node.
        restrained: the supports.
        guess: (axis,) force vector of the first link of a similar shape, N; not needed.

    Returns:
        Force vector of the first link (axis,) N, positions (axis, node) m, and the gap that is left, m.

    Raises:
        EquilibriumError: there is no rest shape, or more than one.
    """
    r = np.empty((f.shape[0], ell.size + 1))
    length = float(ell.sum())
    if guess is not None and restrained.is_fast and f[:, 1:-1].any():
        R = np.array(guess)
        miss = float(hang(p, ell, f, restrained.place, restrained.rigid, 1e-13, R, r))
        if miss < 1e-9 * length:
            return R, r, miss
    span = restrained.place[1] - restrained.place[0]
    distance = float(np.linalg.norm(span))
    if restrained.is_fast and not np.any(f[:, 1:-1]) and length > distance * (1.0 + 1e-12):
        raise EquilibriumError(
            f"the line is slack (length {length:g} m over a distance of {distance:g} m) and nothing pulls on it: "
            "its rest shape is not determined; give gravity, a load, a shorter length or a tension"
        )
    if restrained.is_fast and p[0] == law.RIGID and length <= distance:
        raise EquilibriumError(
            f"an inextensible line of {length:g} m does not reach over the distance of its ends, {distance:g} m"
        )
    R = np.array(guess) if guess is not None else _first_force(p, f, span, length)
    scale = _scale(p, f)
    soft, loose = restrained.compliance(scale / length)
    lent = LENT * scale / length
    place = restrained.place.copy()
    miss = _hang(p, ell, f, place, soft, R, r)
    for _ in range(40):
        # What carries nothing follows the end: the spring that was lent there is without force when all is done.
        moved = np.stack([loose[0] @ (r[:, 0] - place[0]), loose[1] @ (r[:, -1] - place[1])])
        left = float(np.abs(moved).max()) * lent
        if not left > 1e-13 * max(float(np.abs(R).max()), 1e-3 * scale):
            break
        place += moved
        miss = _hang(p, ell, f, place, soft, R, r)
    else:
        raise EquilibriumError("a guided support slides away: nothing holds it along its rail; give it a stiffness")
    if not miss < 1e-6 * length:
        raise EquilibriumError(
            "no rest shape was found: the axial law cannot carry the load (its tension does not rise far enough), or "
            "the numbers are too far apart; check length, axial_stiffness, law and forces"
        )
    return R, r, float(miss)


def _hang(p: Array, ell: Array, f: Array, place: Array, soft: Array, R: Array, r: Array) -> float:
    """`hang` by easier steps where it does not succeed at once; R and r are changed. Returns the gap, m."""
    length, span = float(ell.sum()), place[1] - place[0]
    miss = hang(p, ell, f, place, soft, 1e-13, R, r)
    if not miss < 1e-9 * length:  # folds: links without tension; come to them step by step
        R[:] = _first_force(p, f, span, length)
        for smooth in 10.0 ** -np.arange(2.0, 11.0):
            miss = hang(p, ell, f, place, soft, smooth, R, r)
    if not miss < 1e-6 * length and p[0] == law.TABLE:  # a level part leaves the strain open: tilt it, ever less
        tilted, shape = _first_force(p, f, span, length), r.copy()
        for tilt in 10.0 ** -np.arange(1.0, 8.0):
            found = hang(_tilted(p, tilt), ell, f, place, soft, 1e-10, tilted, shape)
            if not found < 1e-6 * length:
                break
            miss, r[:], R[:] = found, shape, tilted
    return float(miss)


def at_rest(p: Array, ell: Array, f: Array, restrained: EndConditions, guess: Array | None = None) -> StrandAtRest:
    """Find the rest shape of one strand, see `hang_up`.

    Raises:
        EquilibriumError: there is no rest shape, or more than one.
    """
    rests, follows = present(), ell.size == 1 and restrained.is_fast and p[0] != law.RIGID
    if rests is not None and not follows:
        return _among(rests, p, ell, f, restrained, guess)
    return _solved(p, ell, f, restrained, guess)


def _among(
    rests: Rests, p: Array, ell: Array, f: Array, restrained: EndConditions, guess: Array | None
) -> StrandAtRest:
    """The same as one of the equilibria of a run, or beside them: the gap as a function of the first force.

    Raises:
        NotBesideError: links do not pull, or nothing holds an end along its rail.
    """
    loads, length = f.copy(), float(ell.sum())
    loads[:, 0] += restrained.force[0]
    loads[:, -1] += restrained.force[1]
    soft, loose = restrained.compliance(_scale(p, loads) / length)
    if loose.any():
        raise NotBesideError("nothing holds an end along its rail")

    def hanging(R: Array) -> tuple[Array, Array, StrandAtRest]:
        return _hanging(p, ell, loads, restrained.place, soft, R)

    def found() -> Array:
        rest = _solved(p, ell, f, restrained, guess)
        gap, _, shape = hanging(rest.first_force)
        pull = np.sqrt((shape.pull**2).sum(axis=0))
        if not (pull.min() > 1e-6 * pull.max() and np.abs(gap).max() <= 1e-9 * length):
            raise NotBesideError("some links do not pull")
        return rest.first_force

    def factorised(R: Array) -> Solve:
        yielding = hanging(R)[1]
        return lambda gap: np.asarray(np.linalg.solve(yielding, gap), dtype=np.float64)

    return hanging(rests.settle(found, lambda R: hanging(R)[0], factorised))[2]


def _hanging(p: Array, ell: Array, f: Array, place: Array, soft: Array, R: Array) -> tuple[Array, Array, StrandAtRest]:
    """The gap (axis,) in m that a first force leaves, by how much each of its parts closes it in m/N, and the shape."""
    pull = R[:, None] - np.concatenate([np.zeros((R.size, 1)), np.cumsum(f[:, 1:-1], axis=1)], axis=1)
    size = np.sqrt((pull * pull).sum(axis=0))
    strain = law.strains(np.tile(p, (size.size, 1)), size)
    along, across = ell / law.tangents(p, strain), ell * (1.0 + strain) / size
    way = pull / size
    yielding = across.sum() * np.eye(R.size) + (way * (along - across)) @ way.T + soft.sum(axis=0)
    begin = place[0] + soft[0] @ (R + f[:, 0])
    end = place[1] + soft[1] @ (f[:, -1] - pull[:, -1])
    r = np.concatenate([begin[:, None], begin[:, None] + np.cumsum(across * pull, axis=1)], axis=1)
    return end - r[:, -1], yielding, StrandAtRest(r, R, pull, strain, 0.0)


def _solved(p: Array, ell: Array, f: Array, restrained: EndConditions, guess: Array | None) -> StrandAtRest:
    """The same, solved for."""
    n, inner = ell.size, f
    if n == 1 and restrained.is_fast and p[0] != law.RIGID:
        r = np.array(restrained.place.T)
        d = r[:, 1] - r[:, 0]
        length = float(np.linalg.norm(d))
        pull = law.tension(p, length / ell[0] - 1.0) * d / length if length > 0.0 else 0.0 * d
        return StrandAtRest(r, pull, pull[:, None], np.array([length / ell[0] - 1.0]), 0.0)
    f = f.copy()
    f[:, 0] += restrained.force[0]
    f[:, -1] += restrained.force[1]
    R, r, miss = hang_up(p, ell, f, restrained, guess)
    pull, strain = np.empty((f.shape[0], n)), np.empty(n)
    least, scale, length = pulls(p, ell, f, R, pull, strain)
    if p[0] == law.RIGID:
        return StrandAtRest(r, R, pull, strain, 0.0)
    # Supports that yield turn the rounding of the forces into a gap.
    gap = 1e-12 * length
    if not restrained.is_fast:
        gap += 1e-14 * scale * float(restrained.compliance(_scale(p, f) / length)[0].max())
    if p[0] != law.TABLE and least > 1e-6 * scale and miss < gap:
        # Every link pulls: the energy is convex here, and the forces of this shape balance by construction.
        return StrandAtRest(r, R, pull, strain, 0.0)
    _open_up(ell, r)
    rounding = 1e-14 * p_scale(p) * float(np.abs(r).max()) / float(ell.min())  # of strains from positions
    hung = r.copy()
    worst = polish(p, ell, inner, r, 1e-14 * scale, 500)
    if not worst <= 1e-4 * scale + rounding:  # folds of a stiff line: a narrow valley, to be entered step by step
        r[:] = hung
        softer = min(1.0, 1e3 * scale / p_scale(p))
        for part in softer ** np.linspace(1.0, 0.0, max(2, round(-2.0 * np.log10(softer)) + 1)):
            worst = polish(_scaled(p, part), ell, inner, r, 1e-14 * scale, 500)
    if not worst <= 1e-4 * scale + rounding:
        raise EquilibriumError(f"the rest shape is not in balance: {worst:.3g} N are left over of {scale:.3g} N")
    d = np.diff(r, axis=1)
    lengths = np.sqrt((d * d).sum(axis=0))
    eps = lengths / ell - 1.0
    return StrandAtRest(r, R, law.tensions(p, eps) * d / np.where(lengths > 0.0, lengths, 1.0), eps, worst)


def _scale(p: Array, f: Array) -> float:
    """A force that stands for the stiffness of the line: its own, or, if it is rigid, what pulls at it."""
    return float(np.abs(f).sum()) or 1.0 if p[0] == law.RIGID else float(p_scale(p))


def _tilted(p: Array, tilt: float) -> Array:
    """A table with a part of its largest slope added to all its slopes."""
    q, n = p.copy(), int(p[1])
    q[2 + n : 2 + 2 * n] += tilt * float(p_scale(p)) * p[2 : 2 + n]
    return q


def _scaled(p: Array, part: float) -> Array:
    """A law of a part of the tension."""
    q = p.copy()
    q[2 + int(p[1]) if p[0] == law.TABLE else 2 :] *= part
    return q


def _open_up(ell: Array, r: Array) -> None:
    """Move nodes that have met a little apart: a link without length has no direction, and could push either way."""
    for i in np.flatnonzero((np.diff(r, axis=1) ** 2).sum(axis=0) < (1e-3 * ell) ** 2):
        if ((r[:, i + 1] - r[:, i]) ** 2).sum() < (1e-3 * ell[i]) ** 2:
            r[0, i + 1 if i + 2 < r.shape[1] else i] += 1e-2 * ell[i]


def _first_force(p: Array, f: Array, span: Array, length: float) -> Array:
    """A rough force vector at the first link: half the load, and a pull along the chord."""
    distance = float(np.linalg.norm(span))
    half: Array = 0.5 * f[:, 1:-1].sum(axis=1)
    pull = float(np.linalg.norm(half))
    if distance > length and p[0] != law.RIGID:
        pull += float(law.tension(p, distance / length - 1.0))
    return half + pull * span / distance if distance > 0.0 else half
