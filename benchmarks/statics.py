"""Statics: thousands of load positions on a chain, and the cases that MoorPy can do, side by side.

MoorPy (https://github.com/NREL/MoorPy) solves the elastic catenary of each line in closed form, as `theory.rope` does,
and searches the place where a free point between two of them is in balance. A chain of straight links is exact to the
second order of its links, so that it is compared at the same error.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from ropewalk.model import Equilibrium, Line, MovingForce, Quasistatic, Scenario, Travel
from ropewalk.simulate import simulate
from ropewalk.solve.loaded_equilibrium import NOTHING, stand
from ropewalk.solve.quasistatic import walk
from ropewalk.solve.start import setting_of
from ropewalk.theory.rope import elastic_catenary

from .peers.interface import missing, release, silent

Array = np.ndarray

SPAN, LENGTH, WEIGHT, STIFFNESS, LOAD, GRAVITY = 20.0, 22.0, 19.62, 1e5, 700.0, 9.81
PLACES = np.linspace(1.0, 21.0, 81)  # of the load, m along the rope
POSITIONS, LINKS = 2000, 200
TARGETS = (1e-2, 1e-3, 1e-4, 1e-5)


@dataclass(frozen=True)
class Row:
    """One way to solve a case: its error and CPU seconds of one solution."""

    package: str
    setting: str
    error: float
    seconds: float


def rope(elements: int, contact: str = "clamped", measured: str = "material") -> Scenario:
    """The rope, with a load that walks to its end, or frictionless to where it can still be held."""
    stop = {"time": (0.0, 18.0, 18.0), "value": (1.0, 1.0, 0.0)}
    way = {"speed": stop, "from": 1.5} if contact == "frictionless" else {"speed": 1.0}
    travel = Travel.model_validate(way | {"measured": measured})
    load = MovingForce.model_validate({"on": "rope", "force": (0.0, -LOAD), "contact": contact, "travel": travel})
    line = Line(
        start=(0.0, 0.0), end=(SPAN, 0.0), length=LENGTH, mass=WEIGHT / GRAVITY, axial_stiffness=STIFFNESS,
        elements=elements,
    )  # fmt: skip
    return Scenario(gravity=GRAVITY, lines={"rope": line}, loads={"load": load}, run=Quasistatic(positions=POSITIONS))


def seconds(solve: Callable[[], object], least: float = 0.2) -> float:
    """CPU seconds of one call: the best of three rounds, each of as many calls as take `least` s."""
    begin = clock.process_time()
    solve()
    once = clock.process_time() - begin
    count = max(1, round(least / max(once, 1e-6)))
    rounds = []
    for _ in range(3):
        begin = clock.process_time()
        for _ in range(count):
            solve()
        rounds.append((clock.process_time() - begin) / count)
    return min(rounds)


def many_positions() -> None:
    """Print the cost of thousands of positions: the whole run with its result in memory, and the walk alone."""
    print(f"\n{POSITIONS} load positions on a heavy rope of {LINKS} links, CPU s")
    print(f"{'contact':14}{'measured':12}{'simulate()':>12}{'bare walk':>12}")
    for contact, measured in (("clamped", "material"), ("clamped", "horizontal"), ("frictionless", "material")):
        scenario = rope(LINKS, contact, measured)
        setting = setting_of(scenario, LENGTH)

        def whole(scenario=scenario):
            return simulate(scenario)

        def bare(setting=setting):
            return sum(1 for _ in walk(setting, POSITIONS))

        print(f"{contact:14}{measured:12}{seconds(whole, 0.0):12.2f}{seconds(bare, 0.0):12.2f}", flush=True)


def single(counts: tuple[int, ...] = (25, 50, 100, 200, 400, 800, 1600)) -> Iterator[Row]:
    """The rope under its weight alone: relative error of the horizontal tension."""
    exact = elastic_catenary(span=SPAN, length=LENGTH, weight=WEIGHT, axial_stiffness=STIFFNESS)

    def miss(tension: float) -> float:
        return abs(tension / exact.horizontal_tension - 1.0)

    for n in counts:
        setting = setting_of(rope(n).model_copy(update={"run": Equilibrium()}), 0.0)

        def chain(setting=setting):
            return stand(setting.strands, 0, setting.ends[0], np.empty(0), np.empty((2, 0)), NOTHING)

        yield Row("ropewalk", f"chain, {n} links", miss(chain().pull[0, 0]), seconds(chain))
    yield Row(
        "ropewalk", "theory.rope", 0.0,
        seconds(lambda: elastic_catenary(span=SPAN, length=LENGTH, weight=WEIGHT, axial_stiffness=STIFFNESS)),
    )  # fmt: skip
    if missing("moorpy", "moorpy"):
        return
    with silent():
        from moorpy.Catenary import catenary
    for tolerance in (1e-3, 1e-6, 1e-12):

        def closed(tolerance=tolerance):
            return catenary(SPAN, 0.0, LENGTH, STIFFNESS, WEIGHT, CB=-1000.0, Tol=tolerance)

        yield Row("MoorPy", f"catenary, tol {tolerance:.0e}", miss(abs(closed()[2])), seconds(closed))


def loaded(counts: tuple[int, ...] = (25, 50, 100, 200, 400, 800, 1600)) -> Iterator[Row]:
    """The rope with a load in many places: largest error of its position in m, time of one place."""
    exact = np.array([_exact(xi) for xi in PLACES])

    def off(places: Array) -> float:
        return float(np.sqrt(((places - exact) ** 2).sum(axis=1)).max())

    for n in counts:
        setting = setting_of(rope(n), LENGTH)
        contacts = setting.contacts[0]
        force = np.array([[0.0], [-LOAD]])

        def chain(setting=setting, contacts=contacts, force=force):
            found, rest = [], None
            for xi in PLACES:
                rest = stand(setting.strands, 0, setting.ends[0], np.array([xi]), force, contacts, rest)
                found.append(rest.r[:, rest.contact[0]])
            return np.array(found)

        yield Row("ropewalk", f"chain, {n} links", off(chain()), seconds(chain) / PLACES.size)
    yield Row("ropewalk", "theory.rope", 0.0, seconds(lambda: [_exact(xi) for xi in PLACES]) / PLACES.size)
    if missing("moorpy", "moorpy"):
        return
    for tolerance in (5e-2, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9):
        system = _two_lines(float(PLACES[0]))

        def moorpy(system=system, tolerance=tolerance):
            with silent():
                return _walked_by_moorpy(system, tolerance)

        moorpy()  # starts from an arbitrary place the first time
        name = f"two lines, tol {tolerance:.0e}{' (default)' if tolerance == 5e-2 else ''}"
        yield Row("MoorPy", name, off(moorpy()), seconds(moorpy) / PLACES.size)


def print_rows(title: str, unit: str, rows: Iterator[Row]) -> None:
    """Print all rows, and the cheapest way of both packages to each error."""
    print(f"\n{title}\n{'package':10} {'setting':30} {'error ' + unit:>12} {'CPU ms':>9}")
    found = []
    for row in rows:
        found.append(row)
        print(f"{row.package:10} {row.setting:30} {row.error:12.1e} {1e3 * row.seconds:9.3f}", flush=True)
    ways = {
        "ropewalk, chain": [row for row in found if row.setting.startswith("chain")],
        "ropewalk, theory.rope": [row for row in found if row.setting.startswith("theory")],
        "MoorPy": [row for row in found if row.package == "MoorPy"],
    }
    print(f"CPU ms to reach an error of\n{'':24}" + "".join(f"{target:>9.0e}" for target in TARGETS))
    best = {name: [_cheapest(rows, target) for target in TARGETS] for name, rows in ways.items() if rows}
    for name, cells in best.items():
        print(f"{name:24}" + "".join(f"{1e3 * cell:9.3f}" if cell else f"{'-':>9}" for cell in cells))
    if "MoorPy" in best:
        ratios = zip(best["MoorPy"], best["ropewalk, chain"], strict=True)
        print(
            f"{'MoorPy over the chain':24}" + "".join(f"{a / b:8.1f}x" if a and b else f"{'-':>9}" for a, b in ratios)
        )


def main() -> None:
    """Print all tables."""
    many_positions()
    print(f"\nMoorPy {release('moorpy')}: {missing('moorpy', 'moorpy') or 'installed'}")
    print_rows("A heavy rope", "of H", single())
    print_rows(f"The same with a load of {LOAD:g} N, {PLACES.size} places one after the other", "m", loaded())


def _cheapest(rows: list[Row], target: float) -> float | None:
    return min((row.seconds for row in rows if row.error <= target), default=None)


def _exact(xi: float) -> Array:
    place: Array = elastic_catenary(
        span=SPAN, length=LENGTH, weight=WEIGHT, axial_stiffness=STIFFNESS, loads=[(float(xi), (0.0, -LOAD))]
    ).load_positions[0]
    return place


def _two_lines(xi: float):
    """MoorPy's two lines in air that meet at a free point with a weight."""
    with silent():
        import moorpy

        system = moorpy.System(depth=1000.0, rho=0.0, g=GRAVITY)
        system.lineTypes["rope"] = {
            "name": "rope", "EA": STIFFNESS, "w": WEIGHT, "m": WEIGHT / GRAVITY, "d_vol": 0.0, "notes": "",
        }  # fmt: skip
        system.addPoint(1, [0.0, 0.0, -100.0])
        system.addPoint(1, [SPAN, 0.0, -100.0])
        system.addPoint(0, [xi * SPAN / LENGTH, 0.0, -105.0], m=LOAD / GRAVITY, DOFs=[0, 2])
        system.addLine(xi, "rope", pointA=1, pointB=3)
        system.addLine(LENGTH - xi, "rope", pointA=3, pointB=2)
        system.initialize()
    return system


def _walked_by_moorpy(system, tolerance: float) -> Array:
    found = []
    for xi in PLACES:
        system.lineList[0].setL(xi)
        system.lineList[1].setL(LENGTH - xi)
        system.solveEquilibrium(tol=tolerance)
        x, _, z = system.pointList[2].r
        found.append((x, z + 100.0))
    return np.array(found)
