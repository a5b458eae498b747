"""The answer to a case: a scenario is read, a tool is run, and the result becomes an observation."""

from __future__ import annotations

import json
import os
import time
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

from conformance.structures import Tree
from conformance.working import read_scenario

from .observing import Observation, add, add_plain, exit_code, rank


def answer(tree: Callable[[], Tree], tool: str = "run", options: Tree | None = None) -> Observation:
    """Run a tool on the scenario that a function returns, and observe its answer; errors become outcomes."""
    from ropewalk.errors import RopewalkError, ScenarioError

    begin = time.process_time()
    found = Observation("completed", 0)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            TOOLS[tool](tree(), options or {}, found)
    except ScenarioError as error:
        note = "\n".join(f"{problem.key}: {problem.wrong}" for problem in error.problems)
        found = Observation("refused", 2, note)
    except RopewalkError as error:
        found = Observation("stopped", 3, str(error))
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        found = Observation(
            "crashed", 1, f"{type(error).__name__}: {error} ({Path(where.filename).name}:{where.lineno})"
        )
    found.cpu = time.process_time() - begin
    return found


def _simulated(tree: Tree, found: Observation, label: str = "", **more: Any) -> Any:
    from ropewalk.simulate import simulate

    result = simulate(read_scenario(tree), **more)
    _observed(result, found, label)
    return result


def _observed(result: Any, found: Observation, label: str) -> None:
    add(found, result, label)
    outcome = str(result.attrs["outcome"])
    if rank(outcome) > rank(found.outcome):
        text = result.attrs["doubts"] if outcome == "doubtful" else result.attrs["advice"]
        found.outcome, found.exit_code, found.note = outcome, exit_code(outcome), str(text)


def _run(tree: Tree, options: Tree, found: Observation) -> None:
    _simulated(tree, found)


def _feedback(tree: Tree, options: Tree, found: Observation) -> None:
    from ropewalk.coupling import feedback

    answer = feedback(read_scenario(tree))
    add_plain(found, answer.as_dict(), "feedback")
    _observed(answer.coupled, found, "coupled")
    _observed(answer.without, found, "without")


def _compare(tree: Tree, options: Tree, found: Observation) -> None:
    from ropewalk.compare import model_hierarchy

    answer = model_hierarchy(read_scenario(tree))
    add_plain(found, answer.as_dict(), "compare")


def _adequacy(tree: Tree, options: Tree, found: Observation) -> None:
    from ropewalk.compare.adequacy import adequacy
    from ropewalk.compare.axes import Axis

    load = tree["loads"]["load"]
    speed = load["travel"]["speed"]
    size = "loads.load.mass" if load["kind"] == "mass" else "run.until"
    base = load["mass"] if load["kind"] == "mass" else tree["run"]["until"]
    axes = Axis("loads.load.travel.speed", (0.5 * speed, speed)), Axis(size, (0.5 * base, base))
    answer = adequacy(read_scenario(tree), *axes, workers=1)
    add_plain(found, answer.as_dict(), "adequacy")


def _export_load(tree: Tree, options: Tree, found: Observation) -> None:
    _export(tree, "load", found, contact_stiffness=1e6)


def _export_line(tree: Tree, options: Tree, found: Observation) -> None:
    owners = {**tree.get("lines", {}), **tree.get("overhead_lines", {}), **tree.get("nets", {})}
    _export(tree, next(iter(owners)), found)


def _export(tree: Tree, owner: str, found: Observation, **more: Any) -> None:
    import re
    import zipfile

    from ropewalk.cosim.export import export

    file = Path(f"export-{os.getpid()}.fmu")
    try:
        export(read_scenario(tree), owner, file, **more)
        with zipfile.ZipFile(file) as archive:
            text = archive.read("modelDescription.xml").decode()
        found.structure["export"] = {"variables": sorted(set(re.findall(r'<ScalarVariable[^>]* name="([^"]*)"', text)))}
    finally:
        file.unlink(missing_ok=True)


def _go_on(tree: Tree, options: Tree, found: Observation) -> None:
    from ropewalk.simulate import simulate

    file = Path(f"before-{os.getpid()}.nc")
    try:
        with simulate(read_scenario(tree), file=file, overwrite=True) as before:
            _observed(before, found, "before")
        again = {**tree, "run": {**tree["run"], "start": {"kind": "result", "file": str(file)}}}
        _simulated(again, found, "after")
    finally:
        file.unlink(missing_ok=True)


def _show(tree: Tree, options: Tree, found: Observation) -> None:
    """The text of the summary without its numbers; no figure is drawn."""
    from ropewalk.results import summary, text

    result = _simulated(tree, found)
    lines = text(summary(result)).splitlines()
    found.structure["text"] = {"lines": len(lines) > 0}


def _resume(tree: Tree, options: Tree, found: Observation) -> None:
    from ropewalk.resuming import resume
    from ropewalk.simulate import simulate

    file = Path(f"resumed-{os.getpid()}.nc")
    until = tree["run"]["until"]
    half = {**tree, "run": {**tree["run"], "until": 0.5 * until}}
    try:
        simulate(read_scenario(half), file=file, overwrite=True).close()
        with resume(file, until) as result:
            _observed(result, found, "")
    finally:
        file.unlink(missing_ok=True)


def _elasticity(tree: Tree, options: Tree, found: Observation) -> None:
    from ropewalk.overhead.properties import properties

    add_plain(found, properties(read_scenario(tree), 100.0, None, 5.0), "elasticity")


def _gradient(tree: Tree, options: Tree, found: Observation) -> None:
    from ropewalk.designs.gradient import gradient

    load = tree["loads"]["load"]
    key = "loads.load.mass" if load["kind"] == "mass" else "gravity"
    result = gradient(read_scenario(tree), "largest_tension", key, workers=1)
    add_plain(found, {name: result[name].values.ravel().tolist() for name in ("gradient", "error")}, "gradient")
    found.structure["gradient"]["attributes"] = sorted(map(str, result.attrs))


def _functions_of_time(tree: Tree, options: Tree, found: Observation) -> None:
    """A Python function of time in place of the force and the speed, the drive or the displacement."""
    import math

    from ropewalk.simulate import simulate

    scenario = read_scenario(tree)
    until, load = scenario.run.until, scenario.loads["load"]

    def pulse(value: Any) -> Any:
        size = value if isinstance(value, tuple) else (value,)

        def at(t: float) -> Any:
            values = [part * math.sin(math.pi * t / until) for part in size]
            return values if isinstance(value, tuple) else values[0]

        return at

    if options["of"] == "displacement":
        line = scenario.lines["rope"]
        end = _changed(line.end_support, displacement=pulse(line.end_support.displacement))
        own = {"lines": {**scenario.lines, "rope": _changed(line, end_support=end)}}
    elif options["of"] == "drive":
        own = {"loads": {"load": _changed(load, travel=_changed(load.travel, drive=pulse(load.travel.drive)))}}
    else:
        speed = load.travel.speed
        moved = _changed(load.travel, speed=lambda t: speed * (1.0 + 0.2 * t / until))
        own = {"loads": {"load": _changed(load, travel=moved, force=pulse(load.force))}}
    _observed(simulate(_changed(scenario, **own)), found, "")


def _changed(declaration: Any, **changes: Any) -> Any:
    """Return a declaration with changes, checked anew."""
    own = {name: getattr(declaration, name) for name in type(declaration).model_fields}
    return type(declaration)(**own | changes)


def _sweep(tree: Tree, options: Tree, found: Observation) -> None:
    from ropewalk.sweeps.sweeping import sweep

    speed = tree["loads"]["load"]["travel"]["speed"]
    over = {"loads.load.travel.speed": [0.8 * speed, speed]}
    result = sweep(read_scenario(tree), over, record="max tension, max deflection", workers=0)
    names = [str(name) for name in result.data_vars if name != "seconds"]
    add_plain(found, {name: result[name].values.ravel().tolist() for name in names}, "sweep")


def _spectrum(tree: Tree, options: Tree, found: Observation) -> None:
    from ropewalk.simulate import spectrum_of

    values = spectrum_of(read_scenario(tree), **options).as_dict()
    json.dumps(values, allow_nan=False)
    add_plain(found, values, "spectrum")


TOOLS: dict[str, Callable[[Tree, Tree, Observation], None]] = {
    "run": _run, "feedback": _feedback, "compare": _compare, "adequacy": _adequacy, "export load": _export_load,
    "export line": _export_line, "go on": _go_on, "show": _show, "spectrum": _spectrum,
    "resume": _resume, "elasticity": _elasticity, "gradient": _gradient, "functions of time": _functions_of_time,
    "sweep": _sweep,
}  # fmt: skip
