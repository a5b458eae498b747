"""Which method and which step: read off the spectrum (docs/notes/choice-of-method.md)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ropewalk.mechanics.bodies import Bodies
from ropewalk.mechanics.chain import FRICTIONLESS, Array, ChainState, Loads, Strands, Supports
from ropewalk.mechanics.law import tangent
from ropewalk.model.run import ACCURACY
from ropewalk.solve.strained import STIFFNESS, TENSION, strained

# Explicit while it needs fewer steps than this for every link of the line; beyond, the implicit method is faster: a
# load passes links, and each passage costs it a handful of steps whatever their number (docs/notes/implicit.md).
MOST_EXPLICIT_STEPS_PER_LINK = 1000
# Accuracy over the length of the line that Verlet's method keeps with its stable step; the error is of second order.
COARSE = 4e-4
# Times that damping makes a step shorter, from which on it is told.
MUCH_SHORTER = 10.0
# Part of the stable step that is used: the tangent of the law and the locations of the loads change on the way.
SAFETY = 0.9
# omega dt up to which the sixth-order method is used: it is stable up to 9.07 but for two narrow bands, the first of
# them from 3.1414 to 3.1423.
RKN6_LIMIT = 3.1
# Part of the sixth-order step that is used once a chain has been seen in compression: it amplifies every error until
# the end of the run, and so aims at a twentieth of it (docs/notes/speed.md).
COMPRESSED = 0.6
# The same once more for masses: they pass nodes, steps are cut there and at outputs, and a chain whose steps vary in a
# rhythm is unstable before its limit (docs/notes/moving-mass.md).
SAFETY_WITH_MASSES = 0.75
# Strain below which a link is in compression: rounding.
PUSHES = 1e-9
# Drag times step up to which the sixth-order method is used: it also goes backwards in time, where drag drives.
DRAGGED = 0.1
# Links beside a riding node are as short as half a link: the largest frequency and damping rate that this can give.
LOCATION_FREQUENCY, LOCATION_DAMPING = 1.13, 1.28
# The same where an end yields, whose half mass hangs on such a link.
LOCATION_FREQUENCY_AT_END, LOCATION_DAMPING_AT_END = 1.28, 1.62


@dataclass(frozen=True)
class Bounds:
    """Bounds of the spectrum of the chain: what limits an explicit step."""

    frequency: float  # largest angular frequency, rad/s
    damping: float  # largest eigenvalue of (mass matrix)^-1 (damping matrix), 1/s


@dataclass(frozen=True)
class Choice:
    """The method of a run, its largest step in s, and why."""

    method: str
    step: float
    reason: str
    compressed: float = 1.0  # part of the step that is kept from when an undamped line is seen in compression


def bounds(
    strands: Strands,
    r: Array,
    X: Array,
    with_moving_loads: bool,
    supports: Supports | None = None,
    loads: Loads | None = None,
    bodies: Bodies | None = None,
    extremes: Array | None = None,
) -> Bounds:
    """Upper bounds of the largest frequency and damping rate of the chain in its present state.

    On a uniform chain they are sharp: omega = (2/h) sqrt(k/rho), with the larger of T' and T/lam for k, and
    4 c / (rho h^2) for the damping. An end that yields carries half a link: without a spring nothing changes, a spring
    k on the mass m adds k/m to omega^2 at most. Its damper does not matter (ends.py).

    Args:
        strands, r, X, supports, loads, bodies: see mechanics/chain.py and bodies.py.
        with_moving_loads: whether nodes ride with loads.
        extremes: what `strained` gives, if it is known.
    """
    extremes = strained(strands.first, strands.links, strands.law, r, X) if extremes is None else extremes
    yields = supports is not None and bool(supports.free.any())
    frequency = damping = 0.0
    for s in range(strands.first.size):
        if strands.links[s] < 2 and not yields:
            continue
        h, rho = float(strands.h[s]), float(strands.rho[s])
        frequency = max(frequency, 2.0 / h * np.sqrt(float(extremes[s, STIFFNESS]) / rho))
        damping = max(damping, 4.0 * float(strands.damping[s]) / (rho * h * h))
    if with_moving_loads:
        frequency *= LOCATION_FREQUENCY_AT_END if yields else LOCATION_FREQUENCY
        damping *= LOCATION_DAMPING_AT_END if yields else LOCATION_DAMPING
    if bodies is not None and loads is not None:
        part = _locations_of_masses(strands, loads, bodies)
        frequency, damping = max(frequency, frequency * part), max(damping, damping * part * part)
        frequency = np.hypot(frequency, vehicle_frequency(strands, loads, bodies))
    if supports is not None and yields:
        frequency = np.hypot(frequency, _spring_frequency(strands, supports))
    return Bounds(float(frequency), float(damping))


def _locations_of_masses(strands: Strands, loads: Loads, bodies: Bodies) -> float:
    """Largest frequency of a uniform chain with a heavy wheel in one of its links, over that without.

    A fit to the eigenvalues for all places that moving_mass.py lets a wheel take; right to 15 %, on the safe side.
    """
    part = 1.0
    for k, wheel in enumerate(bodies.wheels):
        if wheel["heavy"]:
            s = loads.strand[k]
            ratio = strands.rho[s] * strands.h[s] / wheel["mass"][: strands.gravity.size].min()
            part = max(part, float(np.sqrt(1.33 + 1.3 * ratio)))
    return part


def vehicle_frequency(strands: Strands, loads: Loads, bodies: Bodies) -> float:
    """Largest frequency of the vehicles, to which the line adds nothing but the masses of nodes, rad/s."""
    from scipy.linalg import eigh  # half of what a run without vehicles would import of SciPy

    dim, most = strands.gravity.size, 0.0
    s = loads.strand
    node = strands.rho[s] * strands.h[s]
    masses = bodies.wheels["mass"][:, :dim] + np.where(bodies.wheels["heavy"] == 1, 0.0, node)[:, None]
    for v, vehicle in enumerate(bodies.vehicles):
        n, count, first = int(vehicle["coordinates"]), int(vehicle["wheels"]), int(vehicle["first"])
        size = n + count
        K, M = bodies.K[v, :size, :size].copy(), bodies.M[v, :size, :size].copy()
        for j in range(count):
            M[n + j, n + j] += masses[bodies.wheel[v, j], bodies.axis[v, j]]
        for buffer in bodies.buffers:  # the contact below it moves as well
            i = int(buffer["coordinate"]) - first
            if 0 <= i < n:
                K[i, i] += buffer["stiffness"]
                most = max(most, float(buffer["stiffness"] / masses[buffer["wheel"], dim - 1]))
        for tether in bodies.tethers:
            if tether["first"] == first:
                K[:dim, :dim] += tether["stiffness"] * np.eye(dim)
                most = max(most, float(tether["stiffness"] / masses[tether["wheel"]].min()))
        if size:
            most = max(most, float(eigh(K, M, eigvals_only=True)[-1]))
    # The places of wheels and the coordinates above them may swing against each other: the sum bounds both.
    return float(np.sqrt(2.0 * most))


def _spring_frequency(strands: Strands, supports: Supports) -> float:
    """Largest frequency of an end on its spring alone, rad/s."""
    stiffest = np.linalg.eigvalsh(supports.stiffness)[:, -1]
    mass = np.repeat(0.5 * strands.rho * strands.h, 2) + supports.mass
    return float(np.sqrt(np.max(stiffest / mass)))


def is_compressed(strands: Strands, r: Array, X: Array, extremes: Array | None = None) -> bool:
    """Whether some link pushes: across it the chain is unstable then, and disturbances grow.

    Args:
        strands, r, X: see mechanics/chain.py.
        extremes: what `strained` gives, if it is known.
    """
    extremes = strained(strands.first, strands.links, strands.law, r, X) if extremes is None else extremes
    return any(least < -PUSHES * tangent(p, 0.0) for least, p in zip(extremes[:, TENSION], strands.law, strict=True))


def verlet_step(limits: Bounds) -> float:
    """Largest step of the Verlet method in s, from its stability limit (omega dt)^2 / 4 + lambda_c dt = 1."""
    rate = 0.5 * (limits.damping + np.hypot(limits.damping, limits.frequency))
    return float(SAFETY / rate) if rate > 0.0 else np.inf


def rkn6_step(limits: Bounds, relative_accuracy: float) -> float:
    """Step of the sixth-order method in s, from the wanted accuracy over the length of the line.

    omega dt = 3.1 gave errors far below 5e-5 of the length on slack and on taut ropes; the error falls with the
    sixth power.
    """
    part = min(RKN6_LIMIT, 3.1 * (relative_accuracy / 5e-5) ** (1.0 / 6.0))
    return part / limits.frequency if limits.frequency > 0.0 else np.inf


def choose(
    strands: Strands,
    loads: Loads,
    state: ChainState,
    *,
    method: str,
    step: float | None,
    accuracy: float | None,
    duration: float,
    supports: Supports | None = None,
    bodies: Bodies | None = None,
    guided: bool = False,
) -> Choice:
    """Choose method and step for a motion.

    Args:
        strands, loads, state: the model at the start.
        method: auto, explicit, verlet, rkn6 or implicit.
        step: largest step wanted by the user, s, or None.
        accuracy: wanted accuracy in time of the positions, m; None: the usual one, which Verlet's stable step keeps.
        duration: how long the run is, s.
        supports: what holds the ends; None: points that do not move.
        bodies: what has a mass of its own; None: nothing has.
        guided: whether loads decide on the way what they do.
    """
    limits = bounds(strands, state.r, state.X, bool(loads.strand.size), supports, loads, bodies)
    damped = limits.damping > 0.0
    dampers = supports is not None and bool(supports.damping.any())
    explicit_only = _explicit_only(loads, supports, bodies, guided)
    explicit = verlet_step(limits) * (SAFETY_WITH_MASSES if bodies is not None else 1.0)
    relative = (ACCURACY if accuracy is None else accuracy) / float((strands.h * strands.links).max())
    facts = f"largest frequency {limits.frequency:.4g} rad/s"
    if damped:
        facts += f", largest damping rate {limits.damping:.4g} 1/s"
    wanted, compressed = method, 1.0
    if method in ("auto", "explicit"):
        needed = duration / explicit if np.isfinite(explicit) else 0.0
        most = MOST_EXPLICIT_STEPS_PER_LINK * int(strands.links.max())
        if damped and needed > most and method == "auto":
            wanted, why = "implicit", f"damping makes the chain stiff: {needed:.2g} explicit steps would be needed"
            if explicit_only:
                wanted, why = "verlet", f"{needed:.2g} explicit steps, required for {explicit_only}"
        elif damped:
            wanted, why = "verlet", f"lightly damped: {needed:.2g} explicit steps are cheaper than implicit ones"
        elif bodies is not None:
            wanted, why = "verlet", "masses that pass nodes are of second order in time"
        elif dampers:
            wanted, why = "verlet", "dampers at supports: the sixth order would be lost"
        elif float(strands.drag.max(initial=0.0)) * rkn6_step(limits, relative) > DRAGGED:
            wanted = "verlet"
            why = "the drag of lines is too large for the sixth order, which has negative substeps"
        elif relative >= COARSE:
            wanted, why = "verlet", "undamped, and a coarse accuracy is enough"
        else:
            wanted, why = "rkn6", "undamped: imaginary spectrum, the sixth order is the most efficient"
    else:
        why = "requested"
    if wanted == "rkn6":
        own = rkn6_step(limits, relative) if step is None else RKN6_LIMIT / max(limits.frequency, 1e-300)
        compressed = COMPRESSED if step is None else 1.0
    elif wanted == "verlet":
        own = explicit
        if accuracy is not None and step is None and relative < COARSE:
            own *= float(np.sqrt(relative / COARSE))
            why += f"; the step is smaller than the stable one for an accuracy of {accuracy:.3g} m"
    else:
        own = duration
    if step is not None and step > own and wanted != "implicit":
        why += f"; the requested step ({step:.3g} s) is above the stable one ({own:.3g} s), which is used"
    return Choice(wanted, min(own, step) if step is not None else own, f"{why} ({facts})", compressed)


def cut_by_damping(strands: Strands, state: ChainState, choice: Choice) -> tuple[int, float] | None:
    """The line whose axial damping makes explicit steps much shorter than they would be without, and how many times."""
    if choice.method != "verlet":
        return None
    limits = bounds(strands, state.r, state.X, False)
    times = verlet_step(Bounds(limits.frequency, 0.0)) / verlet_step(limits) if limits.damping > 0.0 else 1.0
    rates = strands.damping / (strands.rho * strands.h**2)
    return (int(np.argmax(rates)), float(times)) if times > MUCH_SHORTER else None


def _explicit_only(loads: Loads, supports: Supports | None, bodies: Bodies | None, guided: bool) -> str:
    """What the implicit method does not know, in words; nothing if it knows all that there is."""
    if bodies is not None:
        return "a load with a mass"
    if guided:
        return "a load with a controller"
    if np.any(loads.contact == FRICTIONLESS):
        return "a frictionless contact"
    if supports is not None and (supports.free.any() or (supports.motion_count > 1).any()):
        return "a support that yields or moves"
    return ""
