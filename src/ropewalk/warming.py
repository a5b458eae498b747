"""Kernels compiled ahead of the first run: for images, clusters and teaching rooms."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.compiled import compiling
from ropewalk.mechanics.kernel_cache import folder, processor
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.scenario import dump, loads
from ropewalk.simulate import simulate
from ropewalk.sweeps.pool import cores, each

_BRIEFLY = 1e-4  # s of a motion: what compiles, compiles in its first steps
_ROPE = """
lines:
  rope: {{start: [0, 0], end: [19.5, 0], length: 20 m, mass: 1, axial_stiffness: 100 kN, {line}elements: 40}}
loads:
  one: {{kind: {load}, on: rope, travel: {{speed: 5, from: 1 m}}}}
run: {{kind: dynamic, until: 0.1 ms{run}}}
"""
_TAUT = """
joints: {{knot: {{}}}}
lines:
  one: {{start: [0, 0], end: [10, 0], end_support: {{kind: joined, to: knot}}, tension: 20 kN, mass: 1,
    axial_stiffness: 2 MN, {line}elements: 20}}
  two: {{start: [10, 0], end: [20, 0], start_support: {{kind: joined, to: knot}}, tension: 20 kN, mass: 1,
    axial_stiffness: 2 MN, {line}elements: 20}}
loads:
  load: {{kind: {load}, on: one, travel: {{speed: 5, from: 1 m}}}}
run: {{kind: dynamic, until: 0.1 ms}}
"""
# Kernels of the system are compiled for plain structures, and for those with anything of this kind.
_SADDLE = """
lines:
  rope: {{start: [0, 0], end: [20, 0], length: 20.6 m, mass: 2, axial_stiffness: 1 MN, elements: 40,
    saddles: {{tower: {{at: [10, 3], radius: 2}}}}}}
loads:
  one: {{kind: {load}, on: rope, travel: {{speed: 5, from: 3 m}}}}
run: {{kind: dynamic, until: 0.1 ms}}
"""
_NET = """
nets:
  net: {{kind: net, corner: [0, 0, 0], sides: [[3, 0, 0], [0, 2, 0]], cells: [6, 4], mesh: 500 mm,
    axial_stiffness: 12 kN, mass: 0.02, tension: 40}}
loads:
  one: {{kind: {load}, on: net, travel: {{speed: 1, path: [[0.6, 1], [2.4, 1]]}}}}
run: {{kind: dynamic, until: 0.1 ms, start: {{with_loads: true}}}}
"""
_OVERHEAD = """
overhead_lines:
  line: {{spans: {{count: 2, length: 50}}, contact_wire: {{mass: 1, tension: 15 kN}}, droppers: {{per_span: 5}},
    messenger_wire: {{mass: 0.6, tension: 10 kN}}, system_height: 1.4}}
loads: {{one: {{kind: pantograph, on: line, model: en50318-2002, static_force: 100, travel: {{speed: 20}}}}}}
run: {{kind: dynamic, until: 0.1 ms, geometry: {geometry}}}
"""
_YIELDING = "end_support: {kind: elastic, stiffness: [100 kN/m, 100 kN/m], mass: 1}, "
_FORCE, _MASS, _STIFF = "force, force: [0, -500]", "mass, mass: 10", "bending_stiffness: 1 kN*m^2, "
COMMON: dict[str, tuple[str, ...]] = {
    "lines with saddles, sheaves or segments, nets": (_SADDLE.format(load=_MASS), _NET.format(load=_MASS)),
    "joined lines": (_TAUT.format(line="", load=_FORCE), _TAUT.format(line="", load=_MASS)),
    "a rope": (
        _ROPE.format(line="", load=_FORCE, run=""),
        _ROPE.format(line="", load=_MASS, run=""),
        _ROPE.format(line="axial_damping: 50, ", load=_MASS, run=""),
        _ROPE.format(line=_YIELDING, load=_MASS, run=""),
        _ROPE.format(line=_YIELDING, load=_FORCE, run=""),
    ),
    "a beam, a stiff cable, an overhead line": (
        _ROPE.format(line=_STIFF, load=_MASS, run=", geometry: linearised").replace("length: 20 m", "tension: 20 kN"),
        _ROPE.format(line=_STIFF, load=_MASS, run=""),
        _OVERHEAD.format(geometry="linearised"),
        _OVERHEAD.format(geometry="nonlinear"),
    ),
    "a rope by the implicit method": (_ROPE.format(line="axial_damping: 50, ", load=_FORCE, run=", method: implicit"),),
}
"""What most runs need: scenarios, in groups that share kernels, those first that take longest."""


def alone(name: str, scenario: Scenario) -> dict[str, tuple[str, ...]]:
    """A group of one scenario."""
    return {name: (dump(scenario),)}


def warm_up(
    groups: Mapping[str, Sequence[str]],
    workers: int | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> dict[str, str]:
    """Compile the kernels that scenarios need, groups side by side in processes of their own.

    Args:
        groups: texts of scenarios, by a name for each group.
        workers: processes; None: one for each core.
        progress: called with what is being done and the part that is done.

    Returns:
        What was done for each group, a phrase.

    Raises:
        RopewalkError: a scenario cannot be run, or a process died.
    """
    waiting = [name for name, texts in groups.items() if not _mark(tuple(texts)).exists()]
    done = dict.fromkeys(groups, "there already")
    if not waiting:
        return done
    progress = progress or (lambda what, part: None)
    progress("compiling", 0.0)
    tasks = ((name, tuple(groups[name])) for name in waiting)
    answers = each(tasks, _compile, min(workers or cores(), len(waiting)), None)
    for finished, ((name, texts), answer) in enumerate(answers, 1):
        if answer is None:
            raise RopewalkError(f"{name}: the process that compiled died; call again, with one worker")
        kernels, seconds = answer
        _mark(texts).touch()
        done[name] = f"{kernels} kernels compiled in {seconds:.0f} s" if kernels else "there already"
        progress("compiling", finished / len(waiting))
    return done


def _mark(texts: Sequence[str]) -> Path:
    """A file among the kernels that says that those of some scenarios are there for this processor."""
    return folder() / f"warm-{hashlib.sha256(repr((texts, processor())).encode()).hexdigest()[:16]}"


def _compile(group: tuple[str, Sequence[str]]) -> tuple[int, float] | None:
    """Kernels compiled for scenarios, and the seconds that took."""
    for text in group[1]:
        scenario = loads(text)
        if isinstance(scenario.run, Dynamic):
            brief = {"until": min(_BRIEFLY, scenario.run.until), "every": min(_BRIEFLY, scenario.run.until)}
            scenario = scenario.model_copy(update={"run": scenario.run.model_copy(update=brief)})
        simulate(scenario)
    return compiling.kernels, compiling.seconds
