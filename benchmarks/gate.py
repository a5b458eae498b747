"""Yardsticks of engines: ``python -m benchmarks gate --part PART``.

contacts   errors of problems with exact answers on three meshes, by all schemes
errors     CPU time to reach the same error, today's engines compared with the compiled core
agreement  differences of fields of today's system and the core on the same mesh
steps      CPU time per link and step, with the instruction sets of the core, and of a bare loop in C
overhead   the reference model of EN 50318:2002 against its ranges
setup      CPU time of the set-up for growing structures
processes  CPU time of commands on examples, and of fresh processes of either engine

All times are CPU time. What is compared is run in turn; ratios are medians of the ratios of each turn. What compares
the core runs in a process whose Numba is limited to AVX2, with kernels of its own (in the folder ROPEWALK_GATE_KERNELS,
if that is set).
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from statistics import median
from typing import Any, NamedTuple

import numpy as np
from platformdirs import user_cache_path

from ropewalk.engine.library import variants
from ropewalk.errors import RopewalkError
from ropewalk.model import Scenario
from ropewalk.system.equilibrium.form_finding import formed

from .bare import bare_loop
from .cost import joined_ropes, rope
from .nets import crossing
from .overhead import motion_alone, reference
from .problems import NEW, OLD, PROBLEMS, Problem, rms
from .processes import EXAMPLES, processes
from .schemes import CORE, ROPES, SPLINES, Core, Scheme, Timing
from .setup import setup

Array = np.ndarray
MARCH, LIMITED = "haswell", ("errors", "agreement", "steps")
WORK = 1e6
"""Links times steps of a measurement of `steps`, about."""


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Print a table in Markdown, its rows as they come."""
    print("\n| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(map(str, row)) + " |", flush=True)


def limited(part: str, words: Sequence[str]) -> None:
    """Run a part in a process whose Numba is limited to AVX2; the name of the processor alone leaves AVX-512 on."""
    kernels = os.environ.get("ROPEWALK_GATE_KERNELS") or str(user_cache_path("ropewalk-gate"))
    numba = {"NUMBA_CPU_NAME": MARCH, "NUMBA_CPU_FEATURES": "", "NUMBA_CACHE_DIR": kernels}
    command = [sys.executable, "-m", "benchmarks", "gate", "--part", part, *words]
    subprocess.run(command, env={**os.environ, **numba}, check=True)


def in_turn(timings: Mapping[str, Timing], rounds: int) -> dict[str, Array]:
    """Return CPU seconds (round,) of motions that are repeated in turn."""
    found = [{name: timing.repeat() for name, timing in timings.items()} for _ in range(rounds)]
    return {name: np.array([each[name] for each in found]) for name in timings}


# -- Errors against exact answers ----------------------------------------------------------------------------------


def contacts(rows: Sequence[str] = ()) -> None:
    """Print errors on three meshes and the order between the last two, by all schemes."""
    found = list[Sequence[object]]()
    for problem in PROBLEMS:
        if not rows or any(row in problem.name for row in rows):
            schemes = (OLD[problem.old] if problem.old else None, NEW, CORE if problem.core else None)
            cells = [cell for scheme in schemes for cell in _cells(problem, scheme)]
            found.append([problem.name, problem.measure, ", ".join(map(str, problem.meshes)), *cells])
    head = ["problem", "error", "links"]
    table([*head, *(word for name in ("with events", "on splines", "core") for word in (name, "order"))], found)


def _cells(problem: Problem, scheme: Scheme | None) -> tuple[str, str]:
    if scheme is None:
        return "", ""
    try:
        errors = [problem.error(scheme, n) for n in problem.meshes]
    except RopewalkError as refused:
        return str(refused).splitlines()[0][:28], ""
    return ", ".join(f"{error:.1e}" for error in errors), f"{np.log2(errors[-2] / errors[-1]):.1f}"


# -- Structures without an exact answer ----------------------------------------------------------------------------


def joined(elements: int) -> Scenario:
    """Two joined ropes of 10 m in so many links under a force."""
    return until(joined_ropes({"kind": "force", "force": (0.0, -300.0)}, elements), 0.2)


@lru_cache
def _formed_bridge(hangers: int) -> Scenario:
    lines = {
        "cable": {"start": [0, 22], "end": [200, 22], "length": 205.25, "mass": 6.0, "axial_stiffness": 60e6},
        "deck": {"start": [0, 0], "end": [200, 0], "tension": 60e3, "mass": 40.0, "axial_stiffness": 80e6},
    }
    load = {"kind": "force", "on": "deck", "force": [0, -800], "travel": {"speed": 5.0, "from": 0.5}}
    row = {"from": "cable", "to": "deck", "count": hangers, "mass": 0.6, "axial_stiffness": 10e6}
    return formed(Scenario.model_validate({
        "lines": {name: line | {"elements": 4 * hangers + 4} for name, line in lines.items()},
        "hangers": {"hanger": row}, "loads": {"load": load},
        "run": {"kind": "dynamic", "until": 0.3, "every": 0.3},
    }))  # fmt: skip


def bridge(elements: int, hangers: int = 50) -> Scenario:
    """A suspension bridge of 200 m with cable and deck of half of these links each, under a force on its first bay."""
    scenario = _formed_bridge(hangers)
    lines = {
        name: line.model_copy(update={"elements": elements // 2}) if name in ("cable", "deck") else line
        for name, line in scenario.lines.items()
    }
    return scenario.model_copy(update={"lines": lines})


def net(elements: int) -> Scenario:
    """The net of the benchmark of nets with so many cells each way, under a force along a thread."""
    scenario = crossing(elements + 1, 0.02)
    y = 3.0 * (elements // 2) / elements
    travel = {"speed": 1.0, "path": [[0.9, y], [3.1, y]], "from": 0.0}
    load = {"kind": "force", "on": "net", "force": [0.0, 0.0, -600.0], "travel": travel}
    tree = scenario.model_dump(exclude_unset=True, by_alias=True) | {"loads": {"load": load}}
    return Scenario.model_validate(tree)


def until(scenario: Scenario, end: float) -> Scenario:
    """Return a scenario whose run ends at another instant, s."""
    return scenario.model_copy(update={"run": scenario.run.model_copy(update={"until": end, "every": end})})


def shared(scenario: Scenario, size: int, coarse: int) -> Array:
    """Return numbers of the nodes, of so many, that a mesh shares with one of so many links in its first line or side.

    The cable of a bridge is left out.
    """
    if scenario.nets:
        cells = next(iter(scenario.nets.values())).cells[0]
        grid = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
        return grid[:: cells // coarse, :: cells // coarse].ravel()
    lines = list(scenario.lines.values())
    first, sizes = lines[0].elements, [(line.elements or 0) + 1 for line in lines]
    begin, found = size - sum(sizes), list[Array]()  # bays of a cable may have links more or less
    for count, is_cable in zip(sizes, [bool(len(lines) > 2), *[False] * len(lines)], strict=False):
        if not is_cable:
            found.append(begin + np.arange(0, count, first // coarse if count == first + 1 else 1))
        begin += count
    return np.concatenate(found)


def of_field(make: Callable[[int], Scenario], meshes: Sequence[int], lines: int = 1) -> Callable[[Scheme, int], float]:
    """Return the error of a field at the end of a run next to that of the core with twice as many links, rms, m.

    Args:
        make: structure with so many links.
        meshes: numbers of links.
        lines: number of lines that share these.
    """

    @lru_cache
    def field(scheme: Scheme, n: int) -> Array:
        scenario = make(n)
        position = scheme(scenario, np.array([0.0, scenario.run.until]))[-1].position
        return np.asarray(position[shared(scenario, len(position), meshes[0] // lines)])

    def error(scheme: Scheme, n: int) -> float:
        return rms(field(scheme, n) - field(CORE, 2 * meshes[-1]))

    return error


STRUCTURES = {
    "joined ropes": (joined, (50, 100, 200), 2), "bridge, 50 hangers": (bridge, (408, 816, 1632), 2),
    "net": (net, (25, 50, 100), 1),
}  # fmt: skip


# -- CPU time to equal error, and per link and step ---------------------------------------------------------------


def seconds_at(error: float, errors: Array, seconds: Array) -> float:
    """Return CPU seconds to reach an error, by powers between meshes; beyond them by the power of all."""
    x, y = np.log(errors), np.log(seconds)
    order = np.argsort(x)
    if x.min() <= np.log(error) <= x.max():
        return float(np.exp(np.interp(np.log(error), x[order], y[order])))
    return float(np.exp(np.polyval(np.polyfit(x, y, 1), np.log(error))))


def errors(rows: Sequence[str] = (), rounds: int = 11, coarser: int = 1) -> None:
    """Print the CPU time to reach the same error by today's best scheme and by the core.

    Args:
        rows: parts of the names of problems; none: all.
        rounds: turns of which medians are taken.
        coarser: what numbers of links are divided by.
    """
    problems = [problem for problem in PROBLEMS if problem.core]
    for name, (make, meshes, lines) in STRUCTURES.items():
        coarse = tuple(n // coarser for n in meshes)
        problems.append(Problem(name, "field, m, rms", meshes, "", of_field(make, coarse, lines), core=True))
    asked = (problem for problem in problems if not rows or any(row in problem.name for row in rows))
    found = (compared(problem, [n // coarser for n in problem.meshes], rounds) for problem in asked)
    table(["problem", "links", "today: errors", "core: errors", "at", "today, CPU ms", "core, CPU ms", "ratio"], found)


def agreement(rows: Sequence[str] = (), coarser: int = 1) -> None:
    """Print by how much fields of today's system and of the core differ on the same mesh, over the largest motion."""
    found = list[Sequence[object]]()
    for name, (make, meshes, _) in STRUCTURES.items():
        for n in (n // coarser for n in meshes if not rows or any(row in name for row in rows)):
            scenario = make(n)
            times = np.array([0.0, scenario.run.until])
            (start, today), (_, core) = (np.array([frame.position for frame in way(scenario, times)])
                                         for way in (SPLINES, CORE))  # fmt: skip
            moved, apart = float(np.abs(today - start).max()), core - today
            found.append([name, n, f"{moved:.3g}", f"{rms(apart) / moved:.1e}", f"{np.abs(apart).max() / moved:.1e}"])
    table(["field, same mesh", "links", "largest motion, m", "difference, rms", "largest"], found)


def compared(problem: Problem, meshes: Sequence[int], rounds: int) -> Sequence[object]:
    """Return a row of the table."""
    schemes: dict[str, Scheme] = {"splines": SPLINES, "core": CORE}
    if problem.old:
        schemes = {"events": OLD[problem.old], **schemes}
    missed: dict[str, list[float]] = {name: [] for name in schemes}
    spent: dict[str, list[Array]] = {name: [] for name in schemes}
    for n in meshes:
        timings = dict[str, Timing]()
        for name, scheme in schemes.items():
            asked, error = _asked(problem, scheme, n)
            missed[name].append(error)
            timings[name] = scheme.timing(asked)
        for name, seconds in in_turn(timings, rounds).items():
            spent[name].append(seconds)
    at = {name: np.array(errors) for name, errors in missed.items()}
    middle = min(at[name][len(meshes) // 2] for name in schemes if name != "core")
    error = float(np.clip(middle, max(e.min() for e in at.values()), min(e.max() for e in at.values())))
    taken = {
        name: np.array([seconds_at(error, at[name], turn) for turn in np.transpose(seconds)])
        for name, seconds in spent.items()
    }
    best = min((name for name in schemes if name != "core"), key=lambda name: median(taken[name].tolist()))
    ratio = median((taken["core"] / taken[best]).tolist())
    shown = [f"{best}: " + ", ".join(f"{e:.1e}" for e in at[best]), ", ".join(f"{e:.1e}" for e in at["core"])]
    times = [f"{1e3 * median(taken[name].tolist()):.1f}" for name in (best, "core")]
    return [problem.name, ", ".join(map(str, meshes)), *shown, f"{error:.1e}", *times, f"**{ratio:.2f}**"]


def _asked(problem: Problem, scheme: Scheme, n: int) -> tuple[Scenario, float]:
    """Return the scenario of a problem on a mesh, and its error by a scheme."""
    asked = list[Scenario]()

    def noting(scenario: Scenario, times: Array) -> list[Any]:
        asked.append(scenario)
        return scheme(scenario, times)

    error = problem.error(noting, n)
    return asked[-1], error


class Shape(NamedTuple):
    """A structure whose steps are timed."""

    name: str
    scenario: Scenario
    links: int
    """Links of a step; of a net, nodes."""
    today: Scheme = SPLINES


def shapes(coarser: int = 1) -> Iterator[Shape]:
    """Yield structures, with runs of about WORK links and steps.

    Args:
        coarser: what numbers of links are divided by.
    """
    for n in (200 // coarser, 800 // coarser):
        scenario = until(rope(n, 0.0), min(0.5, 1.1e-2 * WORK / n**2))
        run = scenario.run.model_copy(update={"method": "verlet"})
        yield Shape(f"one rope, {n} links", scenario.model_copy(update={"run": run}), n, ROPES)
    for n in (50 // coarser, 200 // coarser, 800 // coarser):
        yield Shape(f"joined ropes, {n} links", until(joined(n), min(0.5, 1e-2 * WORK / n**2)), n)
    hangers = 50 // coarser
    yield Shape(f"bridge, {hangers} hangers", bridge(16 * hangers + 16, hangers), 17 * hangers + 16)
    cells = 99 // coarser
    yield Shape(f"net, {cells + 1} x {cells + 1} nodes", until(net(cells), 0.005 * coarser), (cells + 1) ** 2)


def steps(rows: Sequence[str] = (), rounds: int = 11, coarser: int = 1) -> None:
    """Print CPU time per link and step (of nets: per node and step), ns."""
    cores = (f"core, {each}" for each in variants())
    head = ["ns", "today, AVX2", "bare C loop, AVX2", *cores, "core, avx2, over today", "over the bare loop"]
    asked = (shape for shape in shapes(coarser) if not rows or any(row in shape.name for row in rows))
    table(head, (timed(shape, rounds) for shape in asked))


def timed(shape: Shape, rounds: int) -> Sequence[object]:
    """Return a row of the table."""
    schemes = {"today": shape.today, **{each: Core(each) for each in variants()}}
    timings = {each: scheme.timing(shape.scenario) for each, scheme in schemes.items()}
    count = int(WORK / shape.links)
    timings["bare"] = Timing(bare_loop(shape.links, count, march=MARCH), count)
    spent = in_turn(timings, rounds)
    per = {each: 1e9 * spent[each] / timing.steps / shape.links for each, timing in timings.items()}
    cells = [f"{np.median(per[each]):.2f}" for each in ("today", "bare", *variants())]
    ratios = [f"**{np.median(per['avx2'] / per[each]):.2f}**" for each in ("today", "bare")]
    return [shape.name, *cells, *ratios]


def overhead() -> None:
    """Print the quantities of EN 50318:2002 with their ranges, and how much faster than real time motions are."""
    sys.path.append(str(EXAMPLES.with_name("tests")))  # modules of tests import each other by their names
    from tests.overhead.test_en50318_2002 import HALF, RANGES, passage

    found = list[Sequence[object]]()
    for speed in (250, 300):
        for element, settings in ((0.25, ()), (0.5, HALF)):
            eight = passage(speed, settings)
            inside = len(RANGES) - len(eight.outside(speed))
            found.append([speed, element, f"{inside} of {len(RANGES)}", *(f"{x:.1f}" for x in eight.eight.values())])
    table(["km/h", "element, m", "inside", *(name for name in RANGES)], found)
    rows = list[Sequence[object]]()
    for geometry in ("linearised", "nonlinear"):
        for element in (0.25, 0.5):
            seconds, step = motion_alone(reference(element=element, geometry=geometry), 0.5)
            rows.append([geometry, element, f"{1e3 * seconds:.1f}", f"{step:.3g}"])
    table(["300 km/h, 10 spans", "element, m", "CPU, ms per s of motion", "step, ms"], rows)


def main(parts: Sequence[str] = (), rows: Sequence[str] = (), rounds: int = 11, cold: Sequence[str] = ()) -> None:
    """Print the tables of some parts; none: all."""
    tables: dict[str, Callable[[], None]] = {
        "contacts": lambda: contacts(rows), "errors": lambda: errors(rows, rounds),
        "agreement": lambda: agreement(rows), "steps": lambda: steps(rows, rounds),
        "overhead": overhead, "setup": lambda: table(*setup()), "processes": lambda: processes(table, cold),
    }  # fmt: skip
    for part in parts or tables:
        if part in LIMITED and os.environ.get("NUMBA_CPU_NAME") != MARCH:
            limited(part, [*(word for row in rows for word in ("--row", row)), "--rounds", str(rounds)])
        else:
            print(f"\n{part}")
            tables[part]()
