"""Nonlinear waves from a point on a string without ends: transverse impact, and a force that starts to move.

The string obeys ``mass r_tt = (T t)_xi`` with Hooke's law ``T = EA e``, unit tangent t and stretch ``lam = 1
+ e``; it is straight, at rest and strained by ``prestrain`` until t = 0. A constant force that then starts
from xi = 0 with constant material speed U leaves a solution that depends on xi/t alone, of pieces with
constant velocity and constant r_xi: on either side a longitudinal front with ``c_l = sqrt(EA/mass)`` and,
slower, a kink with ``c_t = sqrt(T / (lam mass))``; between the kinks the contact. Behind the front the string
flows towards the contact with ``u = c_l (e - prestrain)``, so that

    r_xi = lam (cos g, +-sin g),   v = (+-(u - c_t lam (1 - cos g)), c_t lam sin g)   behind and ahead (+, -),

and the jumps ``[.] = ahead - behind`` at the contact close the system for e and g of the two sides:

    [v] + U [r_xi] = 0,    [T t] + mass U [v] + F = 0.

Impact (U = 0) goes back to Rakhmatulin and Cole; the moving force is derived in docs/notes. Axes: x along the
string, z across it; a force of either sign moves the string to its own side.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from ropewalk.theory import _arguments

__all__ = ["Contact", "SelfSimilarWave", "moving_force", "transverse_impact"]

FloatArray = NDArray[np.float64]
Contact = Literal["clamped", "frictionless"]
Pair = tuple[float, float]


@dataclass(frozen=True)
class SelfSimilarWave:
    """Solution in the variable xi/t around a point that carries a force; pairs are (behind, ahead) of it."""

    speed: float  # U, material speed of the contact, m/s
    axial_stiffness: float  # EA, N
    mass: float  # kg per unstrained metre
    prestrain: float
    strain: Pair  # next to the contact
    angle: Pair  # of the string next to the contact, rad: rise behind, fall ahead, with the force
    force: Pair  # (Fx, Fz) on the string, N

    @property
    def hold_force(self) -> float:
        """Force along the string that the contact needs, N, positive towards positive x."""
        return self.force[0]

    @property
    def front_speed(self) -> float:
        """Material speed c_l of the longitudinal fronts, m/s."""
        return float(np.sqrt(self.axial_stiffness / self.mass))

    @property
    def kink_speed(self) -> Pair:
        """Material speeds c_t of the kinks behind (running backwards) and ahead, m/s."""
        behind, ahead = (self.front_speed * float(np.sqrt(e / (1.0 + e))) for e in self.strain)
        return behind, ahead

    @property
    def tension(self) -> Pair:
        """Tension behind and ahead of the contact, N."""
        return self.axial_stiffness * self.strain[0], self.axial_stiffness * self.strain[1]

    @property
    def contact_velocity(self) -> FloatArray:
        """Velocity (x, z) of the contact in space, m/s: ``v + U r_xi``, the same from both sides."""
        v, r_xi = self._segments()
        return np.asarray(v[2] + self.speed * r_xi[2])

    @property
    def dissipation(self) -> float:
        """Power that is lost at the contact, W; negative when a motor is hidden there.

        ``U [W - T lam + mass U^2 lam^2 / 2]``, W the strain energy per unstrained length: the configurational
        (Eshelby) jump, equal to the power of the force less what the string takes up. With Hooke's law it is
        ``-U (1 - U^2/c_l^2) [T] (1 + mean strain)``.
        """
        behind, ahead = self.strain
        mean_stretch = 1.0 + 0.5 * (behind + ahead)
        drop = self.axial_stiffness * (behind - ahead)
        return self.speed * drop * mean_stretch * (1.0 - (self.speed / self.front_speed) ** 2)

    def jump_residual(self) -> FloatArray:
        """Return the residual of the two vector jump conditions at the contact, shape (4,), by c_l and EA."""
        segments = _sides(np.array([*self.strain, *self.angle]), self.prestrain)
        force = np.array(self.force) / self.axial_stiffness
        return np.real(_jumps(segments, self.speed / self.front_speed, force))

    def position(self, xi: ArrayLike, t: ArrayLike) -> FloatArray:
        """Return positions (x, z) in m at material coordinates ``xi`` in m and times ``t`` in s, (..., 2).

        The arguments broadcast; xi counts along the unstrained string from where the force sets in. Every
        piece of the solution is ``r = r_xi xi + v t``; before t = 0 the string lies at rest.
        """
        xi, t = np.broadcast_arrays(np.asarray(xi, dtype=np.float64), np.asarray(t, dtype=np.float64))
        v, r_xi = self._segments()
        piece = self._piece_of(xi, t)
        place = r_xi[piece] * xi[..., np.newaxis] + v[piece] * np.maximum(t, 0.0)[..., np.newaxis]
        return np.asarray(place)

    def velocity(self, xi: ArrayLike, t: ArrayLike) -> FloatArray:
        """Return velocities (x, z) in m/s, arguments as in `position`; on a front, the piece ahead."""
        xi, t = np.broadcast_arrays(np.asarray(xi, dtype=np.float64), np.asarray(t, dtype=np.float64))
        return self._segments()[0][self._piece_of(xi, t)]

    def gradient(self, xi: ArrayLike, t: ArrayLike) -> FloatArray:
        """Return r_xi (tangent times stretch), arguments as in `position`; on a front, the piece ahead."""
        xi, t = np.broadcast_arrays(np.asarray(xi, dtype=np.float64), np.asarray(t, dtype=np.float64))
        return self._segments()[1][self._piece_of(xi, t)]

    def _segments(self) -> tuple[FloatArray, FloatArray]:
        """Velocities and r_xi of the six pieces from left to right, shape (6, 2) each."""
        c_l, e0 = self.front_speed, self.prestrain
        sides = _sides(np.array([*self.strain, *self.angle]), e0)
        flow_behind, flow_ahead = (c_l * (e - e0) for e in self.strain)
        v = [[0, 0], [flow_behind, 0], c_l * sides.v_behind, c_l * sides.v_ahead, [-flow_ahead, 0], [0, 0]]
        stretch_behind, stretch_ahead = (1.0 + e for e in self.strain)
        r_xi = [
            [1.0 + e0, 0],
            [stretch_behind, 0],
            sides.r_xi_behind,
            sides.r_xi_ahead,
            [stretch_ahead, 0],
            [1.0 + e0, 0],
        ]
        return np.array(v, dtype=np.float64), np.array(r_xi, dtype=np.float64)

    def _piece_of(self, xi: FloatArray, t: FloatArray) -> NDArray[np.intp]:
        c_l, (c_behind, c_ahead) = self.front_speed, self.kink_speed
        piece = sum((xi >= speed * t).astype(np.intp) for speed in (-c_l, -c_behind, self.speed, c_ahead, c_l))
        return np.asarray(np.where(t > 0.0, piece, 0), dtype=np.intp)


def transverse_impact(*, velocity: float, axial_stiffness: float, mass: float, prestrain: float) -> SelfSimilarWave:
    """Return the wave from a point that suddenly moves across the string with constant velocity.

    ``velocity`` in m/s (of either sign), ``axial_stiffness`` in N, ``mass`` in kg/m, ``prestrain`` >= 0; else
    `ValueError`. Rakhmatulin; Cole: ``v = c_l sqrt(2 (e - e0) sqrt(e (1 + e)) - (e - e0)^2)``,
    ``sin g = v / (c_l sqrt(e (1 + e)))``, force ``2 EA e sin g``.
    """
    _require_string(axial_stiffness, mass, prestrain)
    _arguments.finite(velocity=velocity)
    v = abs(velocity) / float(np.sqrt(axial_stiffness / mass))
    bounds = [v, v ** (4 / 3)]
    if prestrain > 0.0:
        bounds.append(v**2 / float(np.sqrt(prestrain * (1.0 + prestrain))))

    def excess(gain: float) -> float:
        e = prestrain + gain
        return gain * (2.0 * float(np.sqrt(e * (1.0 + e))) - gain) - v**2

    strain, angle = _symmetric(_root(excess, min(bounds)), prestrain)
    angle = float(np.copysign(angle, velocity))
    force = 2.0 * axial_stiffness * strain * float(np.sin(angle))
    return SelfSimilarWave(0.0, axial_stiffness, mass, prestrain, (strain, strain), (angle, angle), (0.0, force))


def moving_force(
    *,
    force: float,
    speed: float,
    axial_stiffness: float,
    mass: float,
    prestrain: float,
    contact: Contact = "clamped",
) -> SelfSimilarWave:
    """Return the wave from a constant force that is switched on and moves with constant material speed.

    ``force`` is the component across the string in N, of either sign; ``speed`` >= 0 is d xi/dt in m/s;
    ``axial_stiffness`` in N, ``mass`` in kg/m, ``prestrain`` >= 0. The contact is "clamped" (no force along
    x, two tensions) or "frictionless" (one tension; `SelfSimilarWave.hold_force` is what that needs along x).
    `ValueError` for arguments out of range and where solutions of this kind end: the contact is not slower
    than the kink ahead of it, the string goes slack, or no tension keeps a frictionless contact going. A
    speed above that of kinks on the string at rest needs a force large enough to make the string ahead tauter
    without folding it back; smaller forces then make waves behind them only, which is another solution.

    The four jump conditions at the head of this module by Newton's method with exact derivatives, continued
    in speed from the force at rest, which is the transverse impact with ``2 EA e sin g = force``.
    """
    _require_string(axial_stiffness, mass, prestrain)
    _arguments.finite(force=force, speed=speed)
    if speed < 0.0:
        raise ValueError(f"speed must not be negative, not {speed}")
    if contact not in ("clamped", "frictionless"):
        raise ValueError(f"contact must be 'clamped' or 'frictionless', not {contact!r}")
    f, goal = force / axial_stiffness, speed / float(np.sqrt(axial_stiffness / mass))
    strain, angle = _force_at_rest(abs(f), prestrain)
    angle = float(np.copysign(angle, f))
    unknowns = np.array([strain, strain, angle, angle, 0.0])
    if f != 0.0:
        unknowns = _continue_in_speed(unknowns, goal, f, prestrain, contact)
    e_behind, e_ahead, g_behind, g_ahead, f_x = (float(value) for value in unknowns)
    wave = SelfSimilarWave(
        speed=speed,
        axial_stiffness=axial_stiffness,
        mass=mass,
        prestrain=prestrain,
        strain=(e_behind, e_ahead),
        angle=(g_behind, g_ahead),
        force=(f_x * axial_stiffness, force),
    )
    _require_own_kind(wave)
    return wave


def _require_own_kind(wave: SelfSimilarWave) -> None:
    """Refuse states where the contact is not slower than the kink, or that a faster kind of wave replaces."""
    speed, kink = wave.speed, wave.kink_speed[1]
    if speed > 0.0 and speed >= kink:
        raise ValueError(f"speed {speed:g} m/s is not below that of the kink, {kink:g} m/s")
    quiet_kink = wave.front_speed * float(np.sqrt(wave.prestrain / (1.0 + wave.prestrain)))
    if speed > 0.0 and speed >= quiet_kink and abs(wave.angle[1]) > 0.5 * np.pi:
        raise ValueError(
            f"speed {speed:g} m/s is above that of kinks on the string at rest, {quiet_kink:g} m/s,"
            " and the force is too small to raise it: the string ahead would have to fold back"
        )


@dataclass(frozen=True)
class _Sides:
    """Velocities and r_xi next to the contact, (x, z), in units of c_l; complex in the derivatives."""

    v_behind: NDArray[np.inexact]
    v_ahead: NDArray[np.inexact]
    r_xi_behind: NDArray[np.inexact]
    r_xi_ahead: NDArray[np.inexact]
    force_behind: NDArray[np.inexact]  # T t / EA
    force_ahead: NDArray[np.inexact]


def _sides(unknowns: NDArray[np.inexact], prestrain: float) -> _Sides:
    e_behind, e_ahead, g_behind, g_ahead = unknowns[:4]
    tangent_behind = np.array([np.cos(g_behind), np.sin(g_behind)])
    tangent_ahead = np.array([np.cos(g_ahead), -np.sin(g_ahead)])
    lam_behind, lam_ahead = 1.0 + e_behind, 1.0 + e_ahead
    w_behind, w_ahead = np.sqrt(e_behind * lam_behind), np.sqrt(e_ahead * lam_ahead)  # c_t lam
    drawn_behind = e_behind - prestrain - 2.0 * w_behind * np.sin(0.5 * g_behind) ** 2
    drawn_ahead = e_ahead - prestrain - 2.0 * w_ahead * np.sin(0.5 * g_ahead) ** 2
    return _Sides(
        v_behind=np.array([drawn_behind, w_behind * np.sin(g_behind)]),
        v_ahead=np.array([-drawn_ahead, w_ahead * np.sin(g_ahead)]),
        r_xi_behind=lam_behind * tangent_behind,
        r_xi_ahead=lam_ahead * tangent_ahead,
        force_behind=e_behind * tangent_behind,
        force_ahead=e_ahead * tangent_ahead,
    )


def _jumps(sides: _Sides, speed: float, force: NDArray[np.inexact]) -> NDArray[np.inexact]:
    """Residual of the kinematic and the dynamic jump condition at the contact, shape (4,)."""
    jump_v = sides.v_ahead - sides.v_behind
    kinematic = jump_v + speed * (sides.r_xi_ahead - sides.r_xi_behind)
    dynamic = sides.force_ahead - sides.force_behind + speed * jump_v + force
    return np.concatenate([kinematic, dynamic])


def _residual(
    unknowns: NDArray[np.inexact], speed: float, force: float, prestrain: float, contact: Contact
) -> NDArray[np.inexact]:
    f_x = unknowns[4]
    jumps = _jumps(_sides(unknowns, prestrain), speed, np.array([f_x, force]))
    condition = f_x if contact == "clamped" else unknowns[1] - unknowns[0]
    return np.append(jumps, condition)


def _continue_in_speed(
    unknowns: FloatArray, goal: float, force: float, prestrain: float, contact: Contact
) -> FloatArray:
    reached, step = 0.0, goal
    while reached < goal:
        speed = min(reached + step, goal)
        trial = _newton(unknowns, speed, force, prestrain, contact)
        if trial is not None and np.max(np.abs(trial[2:4] - unknowns[2:4])) < 0.25:  # stay on this branch
            unknowns, reached, step = trial, speed, 2.0 * step
            continue
        step = 0.5 * (speed - reached)
        if step < 1e-6 * goal:
            raise ValueError(
                f"no such wave beyond {reached / goal:.4g} of the speed: the contact meets the kink"
                " ahead, the string goes slack or a frictionless contact cannot be held; lower the speed or"
                " the force, or raise the prestrain"
            )
    return unknowns


def _newton(unknowns: FloatArray, speed: float, force: float, prestrain: float, contact: Contact) -> FloatArray | None:
    """Solve from a near solution; None if Newton's method does not settle on a taut, subcritical state."""
    derivative = np.empty((5, 5))
    for _ in range(12):
        residual = _residual(unknowns, speed, force, prestrain, contact)
        for j in range(5):
            shifted = unknowns.astype(np.complex128)
            shifted[j] += 1e-40j  # complex step: exact derivative of an analytic function
            derivative[:, j] = _residual(shifted, speed, force, prestrain, contact).imag / 1e-40
        try:
            change = np.linalg.solve(derivative, residual)
        except np.linalg.LinAlgError:
            return None
        unknowns = unknowns - change
        e_ahead = unknowns[1]
        if not np.all(unknowns[:2] > 0.0) or speed**2 * (1.0 + e_ahead) >= e_ahead:
            return None
        size = np.abs(unknowns)
        if np.all(np.abs(change[:4]) <= 1e-14 * size[:4].max() + 1e-12 * size[:4]):
            return unknowns
    return None


def _force_at_rest(force: float, prestrain: float) -> Pair:
    """Strain and angle under a constant force at rest, ``force = 2 e sin g``, all by EA."""
    square = force**2 * float(np.sqrt(2.0)) / 4.0
    bounds = [max(square**0.4, square**0.5)]
    if prestrain > 0.0:
        bounds.append(force**2 / 4.0 * float(np.sqrt(1.0 + prestrain)) / prestrain**1.5)

    def excess(gain: float) -> float:
        e = prestrain + gain
        return 4.0 * e * gain / (1.0 + e) * (2.0 * float(np.sqrt(e * (1.0 + e))) - gain) - force**2

    return _symmetric(_root(excess, min(bounds)), prestrain)


def _symmetric(gain: float, prestrain: float) -> Pair:
    """Strain and angle of a contact at rest where the strain has grown by ``gain``: ``cos g = 1 - q``."""
    e = prestrain + gain
    q = gain / float(np.sqrt(e * (1.0 + e))) if gain > 0.0 else 0.0
    return e, 2.0 * float(np.arcsin(np.sqrt(0.5 * q)))


def _root(increasing: Callable[[float], float], bound: float) -> float:
    """Root between 0 and an upper bound of its size."""
    if bound == 0.0:
        return 0.0
    root = brentq(increasing, 0.0, bound * (1.0 + 1e-9), xtol=1e-14 * bound, rtol=1e-14, maxiter=500)
    return float(root)


def _require_string(axial_stiffness: float, mass: float, prestrain: float) -> None:
    for name, value in {"axial_stiffness": axial_stiffness, "mass": mass}.items():
        if not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"{name} must be finite and positive, not {value}")
    if not (np.isfinite(prestrain) and prestrain >= 0.0):
        raise ValueError(f"prestrain must be finite and not negative, not {prestrain}")
