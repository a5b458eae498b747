"""The lorry of examples/vehicle-on-rough-bridge.yaml over the modes of its bridge: another route to its numbers."""

from __future__ import annotations

import numpy as np
import xarray as xr
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from ropewalk.mechanics.profile_spectra import profile_of

LENGTH, MASS, STIFFNESS, SPEED, TYRE, SPRING, DAMPER = 25.0, 18358.0, 48.65e9, 25.0, 1.75e6, 6e5, 1e4
INERTIA = np.array([10500.0, 50000.0, 900.0, 900.0])
WEIGHT = np.array([103005.0, 0.0, 8829.0, 8829.0])
PLACES = np.array([-25.0, -20.0])  # of the rear and the front wheel at the beginning, m
MODES = 12  # the next one has 3e-5 of the deflection of the first


def over_its_modes(result: xr.Dataset) -> tuple[float, float]:
    """Largest deflection of midspan in m and largest contact force in N.

    Bodies begin as in the result: M u'' + C u' + K u = weights + tyres (p - u), and for each mode of the bridge
    m L/2 q'' + EI (n pi/L)^4 L/2 q = -F sin(n pi x/L).
    """
    s, z = profile_of("ISO 8608 B", 1, (0.5, 50.0), -40.0, 40.0)
    road = CubicSpline(s, z)
    n = np.arange(1, MODES + 1)
    rate = STIFFNESS * (n * np.pi / LENGTH) ** 4 / MASS
    arms = np.array([[1.0, -2.5], [1.0, 2.5]])  # of springs on box and pitch

    def tyres(t: float, u: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x = PLACES + SPEED * t
        on = (x >= 0.0) & (x <= LENGTH)
        shape = np.where(on[:, None], np.sin(np.outer(x, n) * np.pi / LENGTH), 0.0)
        return TYRE * (shape @ q + road(x) - u[2:]), shape

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        u, v, q, p = y[:4], y[4:8], y[8 : 8 + MODES], y[8 + MODES :]
        F, shape = tyres(t, u, q)
        spring = SPRING * (u[2:] - arms @ u[:2]) + DAMPER * (v[2:] - arms @ v[:2])
        force = np.concatenate([arms.T @ spring, F - spring]) - WEIGHT
        return np.concatenate([v, force / INERTIA, p, -rate * q - shape.T @ F * 2.0 / (MASS * LENGTH)])

    names = [str(name).split(".")[-1] for name in result["body"].values]
    own = [names.index(name) for name in ("box", "pitch", "axle-rear", "axle-front")]
    u, v = (result[key].to_numpy()[0, own, -1] for key in ("body_position", "body_velocity"))
    t = np.arange(0.0, 2.0005, 1e-3)
    found = solve_ivp(rates, (0.0, 2.0), [*u, *v, *np.zeros(2 * MODES)], t_eval=t, rtol=1e-8, atol=1e-10, max_step=1e-3)
    middle = found.y[8 : 8 + MODES].T @ np.sin(n * np.pi / 2.0)
    x = PLACES + SPEED * t[:, None]
    force = np.array([tyres(ti, yi[:4], yi[8 : 8 + MODES])[0] for ti, yi in zip(t, found.y.T, strict=True)])
    return float(-middle.min()), float(force[(x > 0.5) & (x < LENGTH - 0.5)].max())
