"""Hold forces: what keeps loads in their places where the tensions beside them are not free.

Beside a frictionless load they are equal. Friction lets them differ, T_ahead/T_behind = exp(+-L(angle)), up to

    L = mu angle                     (capstan: the line bends around the contact)
    L = 2 artanh(mu tan(angle/2))    (block: a point that presses against the line in the middle of the angle)

where `angle` is that by which the line turns at the load. A load that cannot stay by friction is held by a horizontal
force. With the shape of a hanging chain known from the force vector R of its first link (catenary_shooting.py), R and
the hold forces are the roots of a few equations: the line ends where it is held, and the ratio of tensions comes
out right.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.chain import BLOCK, COULOMB, DRAGGED, FRICTIONLESS, Array, Integers
from ropewalk.mechanics.compiled import kernel
from ropewalk.solve.end_conditions import LENT, EndConditions
from ropewalk.solve.equilibrium import hang_up

# A load is not held by forces so many times larger: its path ends where they grow beyond all bounds.
_MOST = 1e5
# Tensions beside a load come out to this part of the forces: well above the rounding of the root finder.
_EQUAL = 1e-10


@dataclass(frozen=True)
class StrandContacts:
    """The loads on a strand: how they are held."""

    at: Integers  # (load,) index of the point
    kind: Integers  # CLAMPED, FRICTIONLESS, COULOMB or DRAGGED
    friction: Array  # coefficient, NaN where none is given
    model: Integers  # CAPSTAN or BLOCK
    ahead: Array  # +1 or -1: the direction of travel
    between: Array  # (axis, load, 2) N, weight between each contact and its links, behind and ahead


@kernel
def log_ratio(model, mu, angle):
    """Largest log of the ratio of tensions that friction lets be, and its derivative with respect to the angle."""
    if model != BLOCK:
        return mu * angle, mu
    half = np.tan(0.5 * angle)
    constraint = mu * half
    if constraint >= 1.0:
        return np.inf, 0.0
    return 2.0 * np.arctanh(constraint), mu * (1.0 + half * half) / (1.0 - constraint * constraint)


@kernel
def coefficient_used(model, log_of_ratio, angle):
    """The friction coefficient that a ratio of tensions needs at least."""
    if abs(log_of_ratio) < 1e-12:
        return 0.0
    if model != BLOCK:
        return abs(log_of_ratio) / angle if angle > 0.0 else np.inf
    return np.tanh(0.5 * abs(log_of_ratio)) / np.tan(0.5 * angle) if angle > 0.0 else np.inf


@kernel
def _beside(A, B):
    """Sizes of two pulls, the angle between them, and its gradients with respect to both, (axis,) each."""
    a, b = np.sqrt((A * A).sum()) + 1e-300, np.sqrt((B * B).sum()) + 1e-300
    cosine = (A * B).sum() / (a * b)
    across = A / a - cosine * B / b  # perpendicular to B
    sine = np.sqrt((across * across).sum())
    angle = np.arctan2(sine, cosine)
    safe = max(sine, 1e-150)
    return a, b, angle, (cosine * A / a - B / b) / (safe * a), (cosine * B / b - A / a) / (safe * b)


@kernel
def _equations(p, ell, f, span, soft, at, between, sign, mu, model, R, H, residual, jacobian):
    """What is left of the equations for R and the hold forces H, and their Jacobian."""
    dim, n, m = R.size, ell.size, H.size
    T, before, block = R.copy(), R.copy(), np.zeros((dim, dim))
    jacobian[:] = 0.0
    residual[:] = 0.0
    for a in range(dim):
        residual[a] = -span[a]
        for b in range(dim):
            residual[a] += soft[0, a, b] * (R[b] + f[b, 0])
            jacobian[a, b] += soft[0, a, b]
    for i in range(n):
        if i > 0:
            before[:] = T
            T -= f[:, i]
            for j in range(m):
                if at[j] == i:
                    T[0] -= H[j]
            for k in range(m):
                if at[k] == i:
                    A, B = T + between[:, k, 1], before - between[:, k, 0]
                    size_a, size_b, angle, angle_a, angle_b = _beside(A, B)
                    most, slope = log_ratio(model[k], mu[k], angle)
                    q = np.exp(sign[k] * most)
                    residual[dim + k] = size_a - q * size_b
                    turning = q * size_b * sign[k] * slope
                    to_A, to_B = A / size_a - turning * angle_a, -q * B / size_b - turning * angle_b
                    jacobian[dim + k, :dim] = to_A + to_B
                    for j in range(m):
                        if at[j] <= i:
                            jacobian[dim + k, dim + j] -= to_A[0]
                        if at[j] < i:
                            jacobian[dim + k, dim + j] -= to_B[0]
        square = (T * T).sum() + 1e-300
        size = np.sqrt(square)
        eps = law.strain(p, size)
        along, across = ell[i] / law.tangent(p, eps), ell[i] * (1.0 + eps) / size
        for a in range(dim):
            residual[a] += across * T[a]
            for b in range(dim):
                block[a, b] = (along - across) * T[a] * T[b] / square
            block[a, a] += across
        _add(block, i, at, jacobian)
    for a in range(dim):
        for b in range(dim):
            residual[a] += soft[1, a, b] * (T[b] - f[b, n])
    _add(soft[1], n, at, jacobian)


@kernel
def _add(block, i, at, jacobian):
    """Add the derivative of a stretch of link i, which feels R and all hold forces before it."""
    dim = block.shape[0]
    for a in range(dim):
        for b in range(dim):
            jacobian[a, b] += block[a, b]
        for j in range(at.size):
            if at[j] <= i:
                jacobian[a, dim + j] -= block[a, 0]


@kernel
def _solve(p, ell, f, place, soft, at, between, sign, mu, model, scale, R, H):
    """Newton's method for R and H, which are changed; False if it does not converge."""
    dim, m, length = R.size, H.size, ell.sum()
    residual, jacobian = np.zeros(dim + m), np.zeros((dim + m, dim + m))
    weights = np.empty(dim + m)
    weights[:dim], weights[dim:] = 1.0 / length, 1.0 / scale
    span = place[1] - place[0]
    _equations(p, ell, f, span, soft, at, between, sign, mu, model, R, H, residual, jacobian)
    miss = np.abs(residual * weights).max()
    old_R, old_H = R.copy(), H.copy()
    for _ in range(60):
        if not np.isfinite(miss):
            return False
        if miss < 1e-14:
            return True
        step = np.linalg.solve(jacobian, -residual)
        part, before = 1.0, miss
        old_R[:], old_H[:] = R, H
        for _ in range(30):
            R[:], H[:] = old_R + part * step[:dim], old_H + part * step[dim:]
            _equations(p, ell, f, span, soft, at, between, sign, mu, model, R, H, residual, jacobian)
            miss = np.abs(residual * weights).max()
            if miss < before:
                break
            part *= 0.5
        if not miss < before:  # rounding error reached, or stuck
            R[:], H[:] = old_R, old_H
            return before < 1e-11
    return miss < 1e-11


@dataclass
class StrandHoldForces:
    """A strand with contacts, to which hold forces are added."""

    p: Array
    ell: Array
    f: Array  # (axis, point) N, supports included
    restrained: EndConditions
    contacts: StrandContacts
    first_force: Array | None  # of a similar shape, N

    def forces(self, guess: Array) -> Array:
        """Find the hold forces of all loads, along x, N.

        Raises:
            EquilibriumError: there are none.
        """
        contacts, count = self.contacts, self.contacts.at.size
        inside = (contacts.at > 0) & (contacts.at < self.ell.size)
        sign = np.where(contacts.kind == DRAGGED, -contacts.ahead, 0.0)
        always = ((contacts.kind == FRICTIONLESS) | (contacts.kind == DRAGGED)) & inside
        mu = np.where((contacts.kind == FRICTIONLESS) | np.isnan(contacts.friction), 0.0, contacts.friction)
        loaded = (contacts.kind == COULOMB) & inside
        slips = np.zeros(count, dtype=bool)
        hold = np.zeros(count)
        for _ in range(4 + 2 * count):
            moving = always | slips
            hold = np.zeros(count)
            if moving.any():
                hold[moving] = self._restrained(np.flatnonzero(moving), sign[moving], mu[moving], guess[moving])
            if not loaded.any():
                break
            last = slips.copy()
            logs, angles = self.ratios(hold)
            for k in np.flatnonzero(loaded):
                if slips[k] and hold[k] * sign[k] < 0.0:
                    slips[k] = False  # it would have to be kept from coming back: friction suffices
                elif not slips[k] and abs(logs[k]) > log_ratio(contacts.model[k], mu[k], angles[k])[0] * (1.0 + 1e-9):
                    slips[k], sign[k] = True, np.sign(logs[k])
            if np.array_equal(last, slips):
                break
        return hold

    def ratios(self, hold: Array) -> tuple[Array, Array]:
        """Logs of the ratios of tensions ahead and behind, and the angles by which the line turns, (load,) each."""
        A, B = self._pulls(hold)
        logs, angles = np.zeros(A.shape[1]), np.zeros(A.shape[1])
        for k in range(A.shape[1]):
            a, b, angles[k], _, _ = _beside(A[:, k], B[:, k])
            logs[k] = np.log(a / b)
        return logs, angles

    def _pulls(self, hold: Array) -> tuple[Array, Array]:
        """Pulls just ahead of the contacts and just behind them, (axis, load) each."""
        f, at, between = self.f.copy(), self.contacts.at, self.contacts.between
        np.add.at(f[0], at, hold)
        first, _, _ = hang_up(self.p, self.ell, f, self.restrained, self.first_force)
        self.first_force = first
        pulls = first[:, None] - np.concatenate([np.zeros((f.shape[0], 1)), np.cumsum(f[:, 1:-1], axis=1)], axis=1)
        ahead, behind = np.minimum(at, self.ell.size - 1), np.maximum(at - 1, 0)
        return pulls[:, ahead] + between[:, :, 1], pulls[:, behind] - between[:, :, 0]

    def _restrained(self, which: NDArray[np.int64], sign: Array, mu: Array, guess: Array) -> Array:
        contacts, scale = self.contacts, float(np.abs(self.f[:, self.contacts.at]).max()) or 1.0
        at, between, model = contacts.at[which], np.ascontiguousarray(contacts.between[:, which]), contacts.model[which]
        stiffness = np.abs(self.f).sum() if self.p[0] == law.RIGID else law.tangent(self.p, 1e-9)
        lent, first = float(stiffness) / float(self.ell.sum()), self.first_force
        soft, loose = self.restrained.compliance(lent)
        for start in (guess, np.zeros(which.size)):
            R = hang_up(self.p, self.ell, self.f, self.restrained, first)[0] if first is None else first.copy()
            hold, place, fine = start.copy(), self.restrained.place.copy(), False
            for _ in range(20):  # a spring that was lent to a loose direction follows its end, as in `hang_up`
                args = at, between, sign, mu, model, scale
                try:
                    fine = _solve(self.p, self.ell, self.f, place, soft, *args, R, hold)
                except np.linalg.LinAlgError:
                    fine = False
                if not fine or not loose.any():
                    break
                pulls = np.stack([R + self.f[:, 0], self.f[:, 1:].sum(axis=1) - R])
                pulls[1, 0] += hold.sum()
                moved = np.einsum("eab,ebc,ec->ea", loose, soft, pulls)
                if np.abs(moved).max() * LENT * lent <= 1e-12 * np.abs(R).max():
                    break
                place += moved
            if fine and np.abs(hold).max() < _MOST * scale:
                self.first_force = R
                return hold
        return self._searched(which, sign, mu, scale, guess)

    def _searched(self, which: NDArray[np.int64], sign: Array, mu: Array, scale: float, guess: Array) -> Array:
        """The slow way: the shape anew for every trial of the hold forces."""
        from scipy.optimize import root

        def miss(x: Array) -> Array:
            hold = np.zeros(self.contacts.at.size)
            hold[which] = x * scale
            A, B = self._pulls(hold)
            out = np.empty(which.size)
            for j, k in enumerate(which):
                a, b, angle, _, _ = _beside(A[:, k], B[:, k])
                out[j] = (a - np.exp(sign[j] * log_ratio(self.contacts.model[k], mu[j], angle)[0]) * b) / scale
            return out

        first = self.first_force
        for start in (guess / scale, np.zeros(which.size)):
            self.first_force = first
            try:
                found = root(miss, start, tol=1e-13)
            except EquilibriumError:
                continue
            size = float(np.abs(found.x).max())
            if np.abs(found.fun).max() <= _EQUAL * max(1.0, size) and size < _MOST:
                return np.asarray(found.x * scale)
        raise EquilibriumError(
            "no horizontal force gives the tensions beside a load that slides: it cannot be held so near to a support; "
            "begin or end further from it, lower the force, or write contact: clamped"
        )
