"""The reference model of EN 50318:2002 on the core: form finding, pantograph, motion, and the quantities of its table.

    python tests/core_overhead.py    prints all of them for both speeds, meshes and kinds of motion

Ranges and evaluation are those of tests/overhead/test_en50318_2002.py.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from time import process_time
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt
from scipy.sparse import diags
from scipy.sparse.linalg import spsolve

from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import Builder, RunProperties, SpringProperties
from ropewalk.engine.equilibrium import find_equilibrium
from ropewalk.model.overhead import stations_of
from ropewalk.model.overhead_wire import OverheadWire
from ropewalk.scenario import load

Array = NDArray[np.float64]
EXAMPLES = Path(__file__).parents[1] / "examples"
RANGES = {
    "mean": {250: (110, 120), 300: (110, 120)},
    "sigma": {250: (26, 31), 300: (32, 40)},
    "mean + 3 sigma": {250: (190, 210), 300: (210, 230)},
    "mean - 3 sigma": {250: (20, 40), 300: (-5, 20)},
    "maximum": {250: (175, 210), 300: (190, 225)},
    "minimum": {250: (50, 75), 300: (30, 55)},
    "uplift": {250: (48, 55), 300: (55, 65)},
    "loss": {250: (0, 0), 300: (0, 0)},
}
"""N; of the uplift mm, of the loss of contact % of the time."""
FIRST, LAST, START, END = 240.0, 360.0, 10.0, 590.0  # m; between the first two the force is evaluated
STEPS = {0.5: 2e-3, 0.25: 1.25e-3}
"""s, of the linearised motion by its links; the nonlinear one goes in 0.97 of the time of axial waves along a link."""


class Passage(NamedTuple):
    """What a run gives: the eight quantities, standard deviation of the raw force, CPU time of a second of motion."""

    eight: dict[str, float]
    raw: float
    cpu: float

    def outside(self, speed: int) -> list[str]:
        """Return the quantities that are not in their ranges."""
        found = {key: (self.eight[key], both[speed]) for key, both in RANGES.items()}
        return [f"{key} {x:.4g} not in {a}..{b}" for key, (x, (a, b)) in found.items() if not a <= x <= b]


def settle(bound: Bound) -> None:
    """Newton's method without a search along the line: pulls of 20 kN at 600 m leave energies to 1e-6 J only."""
    free = bound.unknowns()
    along = np.zeros(bound.state.position.shape)
    along[0] = 1.0  # N/m: nothing keeps both wires together from sliding along
    for _ in range(30):
        at = bound.linearise()
        residual = free.T @ at.forces.ravel()
        rounding = float((abs(at.stiffness) @ np.abs(bound.state.position.ravel())).max()) * np.finfo(float).eps
        if np.abs(residual).max() <= rounding:
            return
        step = spsolve((free.T @ (at.stiffness + diags(along.ravel())) @ free).tocsc(), residual)
        bound.state.position[:] += (free @ step).reshape(bound.state.position.shape)
    raise AssertionError(f"no equilibrium: {np.abs(residual).max():.3g} N")


def with_steady_droppers(bound: Bound, count: int) -> Bound:
    """Put what the first springs bear at rest into the weights: kicked by all of it, a line at rest would jitter."""
    model = bound.model.copy()
    begin, end = model.spring_begin[:count], model.spring_end[:count]
    chord = bound.state.position[:, end] - bound.state.position[:, begin]
    length = np.sqrt((chord**2).sum(axis=0))
    pull = chord / length * (model.spring_stiffness[:count] * np.maximum(length - model.spring_length[:count], 0.0))
    model.spring_steady[:, :count] = pull
    for axis in range(2):
        np.add.at(model.weight[axis], begin, pull[axis])
        np.add.at(model.weight[axis], end, -pull[axis])
    return Bound(model, bound.state)


@dataclass(frozen=True)
class Reference:
    """The line and its pantograph, to be moved.

    Args:
        links: length of a link, m.
        linearised: whether nodes move upwards only and tensions do not change.
        step: s, of springs and pantograph; None: as STEPS say.
        inner: steps of the wires in each of these.
        speed: km/h.
    """

    links: float
    linearised: bool
    speed: int
    step: float | None = None
    inner: int = 1

    @property
    def dt(self) -> float:
        """Step of springs and pantograph, s."""
        if self.step is not None:
            return self.step
        if self.linearised:
            return STEPS[self.links]
        wires = (self.line.contact_wire, self.line.messenger_wire)
        return 0.97 * self.links * self.inner / max(float(np.sqrt(w.axial_stiffness / w.mass)) for w in wires)

    @property
    def line(self):  # type: ignore[no-untyped-def]
        """The declaration of the line."""
        return load(EXAMPLES / f"en50318-2002-{self.speed}.yaml").overhead_lines["line"]

    def run(self, wire: OverheadWire) -> RunProperties:
        """Links of a wire, with what corrects the speed of waves across to the fourth order of mesh and step."""
        T, h, c = wire.tension, self.links, np.sqrt(wire.tension / wire.mass)
        EI = wire.bending_stiffness + T * (h**2 - (c * self.dt / self.inner) ** 2) / 12.0
        if self.linearised:
            return RunProperties(h, wire.mass, 0.0, bending_stiffness=EI, curved=False, tension=T, taut=True)
        stretch = 1.0 + T / wire.axial_stiffness
        return RunProperties(h / stretch, wire.mass * stretch, wire.axial_stiffness, bending_stiffness=EI, curved=False)

    def add_wire(self, builder: Builder, wire: OverheadWire, height: float) -> int:
        """Add a wire that weights pull at both ends; return its first node."""
        links = round(self.line.length / self.links)
        points = np.array([self.links * np.arange(links + 1), np.full(links + 1, height)])
        first, last = builder.add_run(points, self.run(wire))
        builder.fix(*(range(first, last + 1) if self.linearised else ()), axes=[0])
        builder.fix(first, last, axes=[1])
        return first

    def bound(self, builder: Builder, wires: list[tuple[int, OverheadWire]], forces: list[tuple[int, float]]) -> Bound:
        """Bind, with pulls of weights at the ends of wires, and forces upwards on nodes, N."""
        model, state = builder.build()
        for first, wire in wires if not self.linearised else ():
            last = first + round(self.line.length / self.links)
            model.weight[0, [first, last]] = -wire.tension, wire.tension
        for node, force in forces:
            model.weight[1, node] += force
        return Bound(model, state)

    def build(self) -> Bound:
        """Find the line at rest, and press the pantograph on it."""
        line = self.line
        contact, messenger, arm = line.contact_wire, line.messenger_wire, line.steady_arms.moving_mass
        supports = np.array(stations_of(line))
        places = np.concatenate([x + np.array(at) for x, at in zip(supports, line.dropper_places, strict=False)])
        droppers, arms = (np.rint(x / self.links).astype(int) for x in (places, supports[1:-1]))
        middle = round(0.5 * line.length / self.links)
        # The contact wire where it is wanted, and what holds it there.
        alone = Builder()
        self.add_wire(alone, contact, 0.0)
        for node in arms:
            alone.add_mass(node, arm)
        alone.fix(*droppers, *arms, axes=[1])
        alone.fix(middle, axes=[0])
        lower = self.bound(alone, [(0, contact)], [])
        assert find_equilibrium(lower).outcome == "found"
        held = -lower.forces()[1]
        # The messenger under these.
        above = Builder()
        self.add_wire(above, messenger, line.system_height)
        above.fix(*arms, axes=[1])
        above.fix(middle, axes=[0])
        upper = self.bound(above, [(0, messenger)], [(i, -held[i]) for i in droppers])
        assert find_equilibrium(upper).outcome == "found"
        return self.together(lower, upper, droppers, arms, held)

    def together(self, lower: Bound, upper: Bound, droppers: Array, arms: Array, held: Array) -> Bound:
        """Both wires and the pantograph at rest, on the way."""
        line, builder = self.line, Builder(inner_steps=self.inner, samples=1000)
        low = self.add_wire(builder, line.contact_wire, 0.0)
        high = self.add_wire(builder, line.messenger_wire, line.system_height)
        k = line.droppers.stiffness
        apart = upper.state.position[:, droppers] - lower.state.position[:, droppers]
        lengths = np.sqrt((apart**2).sum(axis=0)) - held[droppers] / k
        for node, length in zip(droppers, lengths, strict=True):
            builder.add_spring(low + node, high + node, SpringProperties(k, float(length), tension_only=True))
        for node in arms:
            builder.add_mass(low + node, line.steady_arms.moving_mass)
            builder.fix(high + node, axes=[1])
        builder.watched.extend(int(low + node) for node in arms)
        parts = load(EXAMPLES / f"en50318-2002-{self.speed}.yaml").loads["pantograph"].parts
        below = base = builder.add_node([START, -float(len(parts.masses))], 0.0)
        builder.fix(base)
        for mass, stiffness, damping in zip(parts.masses, parts.stiffness, parts.damping, strict=True):
            node = builder.add_node([START, float(below - base - len(parts.masses) + 1)], mass)
            builder.fix(node, axes=[0])
            builder.add_spring(below, node, SpringProperties(stiffness, 1.0, damping))
            below = node
        builder.add_collector(0, below, parts.contact_stiffness)
        bodies = [(node, 9.81 * mass) for node, mass in zip(range(base + 1, below + 1), parts.masses, strict=True)]
        forces = [(int(low + i), float(held[i])) for i in arms] + bodies + [(base + 1, float(parts.force))]
        bound = self.bound(builder, [(low, line.contact_wire), (high, line.messenger_wire)], forces)
        for first, wire in ((low, lower), (high, upper)):
            bound.state.position[:, first : first + wire.state.position.shape[1]] = wire.state.position
        settle(bound)
        bound.state.velocity[0, base:] = bound.state.predicted[0, base:] = self.speed / 3.6
        return with_steady_droppers(bound, droppers.size)

    def passage(self, variant: str | None = None) -> Passage:
        """Move it and evaluate the force."""
        bound, dt, v = self.build(), self.dt, self.speed / 3.6
        steps = int((END - START) / v / dt)
        begin = process_time()
        force, height = bound.record(steps, dt, variant)
        cpu = (process_time() - begin) / (steps * dt)
        station = START + v * dt * np.arange(steps)
        smooth = sosfiltfilt(butter(4, 20.0, fs=1.0 / dt, output="sos"), force[0])
        inside = (station >= FIRST) & (station <= LAST)
        F, raw = smooth[inside], force[0, inside]
        mean, sigma = F.mean(), F.std()
        uplift = 1e3 * (height[3:6] - height[3:6, :1]).max()
        lost = 100.0 * (raw == 0.0).mean()
        values = (mean, sigma, mean + 3.0 * sigma, mean - 3.0 * sigma, F.max(), F.min(), uplift, lost)
        return Passage(dict(zip(RANGES, map(float, values), strict=True)), float(raw.std()), cpu)


def main() -> None:
    """Print the table."""
    for linearised in (True, False):
        for links in (0.5, 0.25):
            for speed in (250, 300):
                inner = 1 if linearised else round(3.5 / links)
                reference = Reference(links, linearised, speed, inner=inner)
                found = reference.passage("avx2")
                kind = "linearised" if linearised else "nonlinear"
                print(f"{kind} {links} m {speed} km/h, step {1e3 * reference.dt:.4g} ms with {inner} inner ones:")
                print("   ", {key: round(x, 2) for key, x in found.eight.items()}, found.outside(speed))
                print(f"    raw sigma {found.raw:.4g} N, CPU {1e3 * found.cpu:.3g} ms a second", flush=True)


if __name__ == "__main__":
    main()
