"""Moving bodies: a sliding mass beside Exudyn's joint, a walker, the step protocol, a mass beside a force."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time as clock
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

import ropewalk
from ropewalk.controllers.assembly import controllers_of
from ropewalk.mechanics.chain import ChainState
from ropewalk.model import Dynamic, FreeTravel, Line, MovingForce, MovingMass, Scenario, Start, Travel
from ropewalk.model.stepper import Stepper
from ropewalk.simulate import output_times
from ropewalk.solve.carrier import RopeCarrier
from ropewalk.solve.choice import choose
from ropewalk.solve.initial_loads import place_loads, resting_forces
from ropewalk.solve.motion import Progress, move
from ropewalk.solve.splitting import RUNNING
from ropewalk.solve.start import setting_of, start_state

from .peers import exudyn_sliding as exudyn
from .peers.exudyn_sliding import Slide
from .peers.interface import Failed, release

Array = np.ndarray
WALKER = Path(__file__).parents[1] / "examples" / "highline-walker.yaml"


@dataclass(frozen=True)
class LoneVehicle:
    """A motion: path of the first load (time, axis) in m, CPU seconds of the motion alone, and of its guides."""

    path: Array
    seconds: float
    steps: int
    asked: float


class _Timed:
    """A guide whose CPU seconds are counted."""

    def __init__(self, controller: Any) -> None:
        self.controller, self.seconds = controller, 0.0

    def begin(self) -> None:
        self.controller.begin()

    def next(self, t: float) -> float:
        return float(self.controller.next(t))

    def act(self) -> None:
        begin = clock.process_time()
        self.controller.act()
        self.seconds += clock.process_time() - begin


def ride(scenario: Scenario, timed: bool = False) -> LoneVehicle:
    """Move a scenario through its outputs, from rest; `timed`: count what its guides take, which costs a little."""
    run, setting = scenario.run, setting_of(scenario, 0.0)
    state = start_state(setting, run.start.with_loads, resting_forces(setting.loading))
    bodies, progress = place_loads(setting, state), Progress()
    controllers: Sequence[Any] = []
    if bodies is not None:
        controllers = controllers_of(RopeCarrier(setting, state, bodies, setting.loads), setting.loading, scenario)
    if timed:
        controllers = [_Timed(controller) for controller in controllers]
    for controller in controllers:
        controller.begin()
    path, dim = [_place(bodies, state)], state.r.shape[0]
    begin = clock.process_time()
    choice = choose(
        setting.strands, setting.loads, state, method=run.method, step=run.step, accuracy=run.accuracy,
        duration=run.until, supports=setting.supports, bodies=bodies,
    )  # fmt: skip
    times = output_times(run)[1:]
    for now in move(
        setting.strands,
        setting.loads,
        state,
        choice,
        run.precision,
        times,
        progress,
        setting.supports,
        bodies,
        controllers,
    ):
        path.append(_place(bodies, now))
    seconds = clock.process_time() - begin
    if progress.status != RUNNING:
        raise Failed(": ".join(progress.message()))
    asked = sum(controller.seconds for controller in controllers) if timed else 0.0
    return LoneVehicle(np.array(path)[:, :dim], seconds, progress.steps, asked)


def _place(bodies: Any, state: ChainState) -> Array:
    return np.array(bodies.wheels["r"][0]) if bodies is not None else np.full(3, np.nan)


def usual(scenario: Scenario, times: int = 5) -> LoneVehicle:
    """The ride of median CPU time out of several, after one that compiles or loads from the cache."""
    ride(scenario)
    rides = sorted((ride(scenario) for _ in range(times)), key=lambda done: done.seconds)
    return rides[times // 2]


# -- A mass that slides ------------------------------------------------------------------------------------------


def slide_scenario(slide: Slide, elements: int, step: float | None) -> Scenario:
    """The sliding mass as a scenario."""
    return Scenario(
        gravity=slide.gravity,
        lines={
            "rope": Line(
                start=(0.0, 0.0), end=(slide.span, 0.0), length=slide.length, mass=slide.density,
                axial_stiffness=slide.stiffness, elements=elements,
            )
        },
        loads={
            "mass": MovingMass(
                on="rope", mass=slide.mass, travel=FreeTravel.model_validate({"from": slide.start, "friction": 0.0})
            )
        },
        run=Dynamic(until=slide.until, every=0.05, step=step, start=Start(with_loads=True)),
    )  # fmt: skip


def distance(path: Array, other: Array) -> float:
    """Largest distance of two paths at the same instant, m."""
    return float(np.sqrt(((path - other) ** 2).sum(axis=1)).max())


def limit(coarse: Array, fine: Array) -> Array:
    """What a path of first order in the step tends to, from two steps, the second half the first."""
    return 2.0 * fine - coarse


OURS = (25, 50, 100, 200, 400, 800)
FINEST = 1600
# Elements and steps in s: the error of the joint in time is proportional to elements times step.
THEIRS = {
    25: (1e-3, 5e-4, 2.5e-4, 1.25e-4),
    50: (1e-3, 5e-4, 2.5e-4, 1.25e-4, 6.25e-5),
    100: (5e-4, 2.5e-4, 1.25e-4),
    200: (5e-4, 2.5e-4, 1.25e-4),
}
TARGETS = (3e-2, 1e-2, 5e-3)


def sliding() -> None:
    """Print errors and CPU seconds of both, and the ratio at equal error."""
    slide = Slide()
    print(f"\nA mass of {slide.mass:g} kg slides along a rope from rest; largest error of its path, m, and CPU s")
    times = output_times(slide_scenario(slide, 25, None).run)
    exact = ride(slide_scenario(slide, FINEST, None)).path
    others = [ride(slide_scenario(slide, *case)).path for case in ((FINEST, 2e-5), (FINEST // 2, None))]
    print(f"  ropewalk's reference: {FINEST} links, ends at {_end(exact)} m; half the links and a shorter")
    print(f"  step change it by {max(distance(exact, other) for other in others):.1e} m")
    ours = {}
    for elements in OURS:
        done = usual(slide_scenario(slide, elements, None))
        ours[elements] = distance(done.path, exact), done.seconds
        print(
            f"  ropewalk {elements:5} links, own step        {ours[elements][0]:9.1e}{'':11}{done.seconds:9.3f}",
            flush=True,
        )
    if reason := exudyn.available():
        print(f"  {exudyn.name}: {reason}")
        return
    exudyn.path(slide, times[:2], 25, 1e-3)  # loads the library
    runs: dict[tuple[int, float], tuple[Array, float]] = {}
    for elements, steps in THEIRS.items():
        for step in steps:
            try:
                path, seconds = exudyn.path(slide, times, elements, step)
                for _ in range(2 if seconds < 1.0 else 0):
                    seconds = min(seconds, exudyn.path(slide, times, elements, step)[1])
            except Failed as failure:
                print(f"  Exudyn   {elements:5} elements, step {step:.3g} s: {failure}")
                continue
            runs[elements, step] = path, seconds
    limits = {n: limit(runs[n, steps[-2]][0], runs[n, steps[-1]][0]) for n, steps in THEIRS.items()}
    own = limits[max(limits)]
    print(f"  Exudyn {release(exudyn.distribution)}, extrapolated to steps of 0; with so many elements it ends at")
    for elements, path in limits.items():
        print(f"    {elements:4}: {_end(path)} m, {distance(path, exact):.1e} m off ropewalk's reference")
    print(f"  {'':38}{'own ref.':>9}{'ropewalk':>10}{'CPU s':>10}")
    theirs = {}
    for (elements, step), (path, seconds) in runs.items():
        theirs[elements, step] = distance(path, own), seconds
        print(
            f"  Exudyn   {elements:5} elements, step {step:8.2e} {theirs[elements, step][0]:9.1e}"
            f"{distance(path, exact):10.1e}{seconds:10.3f}"
        )
    print("  CPU s to come as close as this to one's own reference:")
    for target in TARGETS:
        best = [min((s for e, s in rows.values() if e <= target), default=np.inf) for rows in (ours, theirs)]
        much = f"{best[1]:.2f}, {best[1] / best[0]:.0f} times as much" if best[1] < np.inf else "with none of these"
        print(f"    {target:.0e} m: ropewalk {best[0]:.3f}, Exudyn {much}")


def _end(path: Array) -> str:
    return f"({path[-1, 0]:.4f}, {path[-1, 1]:.4f})"


# -- A walker ----------------------------------------------------------------------------------------------------


def walker() -> None:
    """Print what a minute of walking costs: the example on a longer line of 200 links."""
    overrides = [
        "run.until=60 s", "lines.webbing.end=[100 m, 0 m]", "lines.webbing.elements=200",
        "loads.walker.at_end=stay",
    ]  # fmt: skip
    scenario = ropewalk.load(WALKER, overrides)
    ride(scenario)
    rides = sorted((ride(scenario) for _ in range(3)), key=lambda done: done.seconds)
    done, guided = rides[1], ride(scenario, timed=True)
    per = 1e9 * (done.seconds - guided.asked) / done.steps / 200
    print("\nA walker, 60 s on a highline of 100 m with 200 links")
    print(
        f"  {done.seconds:.2f} CPU s, {done.steps} steps; {per:.1f} ns per node and step without the guide, which "
        f"takes {guided.asked:.2f} s; the first foot ends at x = {done.path[-1, 0]:.1f} m"
    )


# -- The step protocol -------------------------------------------------------------------------------------------


class Strolling:
    """The least that a model can do: the same force at a place that moves on."""

    contacts = 1

    def step(self, t: float, h: float, line: Any) -> Iterable[Any]:
        return ((5.0 + 2.0 * t, (0.0, -300.0), 2.0),)


def taut(elements: int) -> Line:
    """A taut rope of 20 m."""
    return Line(start=(0, 0), end=(20.2, 0), length=20.0, mass=1.0, axial_stiffness=1e5, elements=elements)


def protocol() -> None:
    """Print the cost of asking a model, beside the same force with the same steps."""
    print("\nStep protocol, microseconds per question beyond kind: force with the same steps of 0.1 ms (median of 5)")
    for elements in (50, 200):
        for every in (1e-3, 2e-4, 1e-4):
            travel = Travel.model_validate({"speed": 2.0, "from": 5.0})
            force = MovingForce(on="rope", force=(0.0, -300.0), travel=travel)
            asked = Stepper.model_validate({"on": "rope", "model": Strolling(), "every": every, "from": 5.0})
            run = Dynamic(until=2.0, every=0.5, step=1e-4, method="verlet")
            alone, done = (
                usual(Scenario(lines={"rope": taut(elements)}, loads={"load": load}, run=run))
                for load in (force, asked)
            )
            cost = 1e6 * (done.seconds - alone.seconds) / (run.until / every)
            print(
                f"  {elements:4} links, every {1e3 * every:4.1f} ms: {cost:6.1f}   ({done.steps} steps; kind: force "
                f"{1e6 * alone.seconds / alone.steps:.2f} a step)",
                flush=True,
            )


# -- A mass beside a force ---------------------------------------------------------------------------------------


def travelling(elements: int, mass: bool) -> Scenario:
    """A mass of 30 kg, or its weight, at 10 m/s along a taut rope."""
    travel = Travel.model_validate({"speed": 10.0, "from": 5.0})
    load = MovingMass(on="rope", mass=30.0, travel=travel) if mass else None
    return Scenario(
        lines={"rope": taut(elements)},
        loads={"load": load or MovingForce(on="rope", force=(0.0, -30.0 * 9.81), travel=travel)},
        run=Dynamic(until=1.0, every=0.25, method="verlet"),
    )


def beside_force() -> None:
    """Print the cost of a step with a mass over that with a force; events with a node are included."""
    print("\nA mass of 30 kg beside its weight as a force, microseconds per step (median of 7, in turn)")
    for elements in (100, 200, 400, 800, 1600):
        costs = []
        for mass in (False, True):
            scenario = travelling(elements, mass)
            costs.append([])
            ride(scenario)
            for _ in range(7):
                done = ride(scenario)
                costs[-1].append((1e6 * done.seconds / done.steps, done.steps, done.seconds))
        force, heavy = (median(costs_of) for costs_of in costs)
        print(
            f"  {elements:5} links: {force[0]:7.2f} and {heavy[0]:7.2f}, ratio {heavy[0] / force[0]:5.2f}; "
            f"steps {force[1]} and {heavy[1]}, whole run {heavy[2] / force[2]:5.2f}",
            flush=True,
        )


# -- Compilation -------------------------------------------------------------------------------------------------

FIRST_RUN = """
import time
from benchmarks.bodies import ride, travelling
for mass in {masses}:
    begin = time.process_time(), time.perf_counter()
    ride(travelling(50, mass))
    print(time.process_time() - begin[0], time.perf_counter() - begin[1])
"""


def cold() -> None:
    """Print what is compiled by the first run with a force, and by the first with a mass, from an empty cache."""
    print("\nFirst runs of a process, s")
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
        for label, masses in (("nothing compiled yet", (False, True)), ("kernels from the cache", (True,))):
            for mass, (cpu, wall) in zip(masses, _rows(masses, environment), strict=True):
                kind = "with a mass" if mass else "with a force"
                print(f"  {label:24} {kind:14} {cpu:6.1f} CPU, {wall:6.1f} wall", flush=True)


def _rows(masses: tuple[bool, ...], environment: dict[str, str]) -> Iterator[tuple[float, float]]:
    done = subprocess.run(
        [sys.executable, "-c", FIRST_RUN.format(masses=masses)],
        env=environment, capture_output=True, text=True, check=True, cwd=Path(__file__).parents[1],
    )  # fmt: skip
    for line in done.stdout.splitlines():
        cpu, wall = map(float, line.split())
        yield cpu, wall


def main() -> None:
    """Print all tables."""
    sliding()
    walker()
    protocol()
    beside_force()
    cold()


if __name__ == "__main__":
    main()
