"""A worker: cases in, verdicts out, one a line; it runs in a process of its own, which may die of a case."""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import sys
import time
import traceback
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from .judging import CRASH, REFUSED, STOPPED, WORKS, WRONG, Verdict, judge
from .loads import fmu_file, matrices, travel
from .structures import BY_NAME, STRUCTURES, Tree

BROKEN_OFF = "breaks off at once"  # what `compare` says of a motion that diverges in its first step
ASIDE = 1e-3  # m: nodes that carry a load are stored where they rest along the line, by interpolation


def answer(case: Tree) -> Tree:
    """The verdict on one case, as plain values."""
    from ropewalk.errors import RopewalkError, ScenarioError

    begin = time.process_time()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = _TOOLS[case["tool"]](case["scenario"], case["options"])
    except ScenarioError as error:
        found = Verdict(REFUSED, "\n".join(f"{problem.key}: {problem.wrong}" for problem in error.problems))
    except RopewalkError as error:
        found = Verdict(STOPPED if BROKEN_OFF in str(error) else REFUSED, str(error))
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{Path(where.filename).name}:{where.lineno} {where.name}"
        found = Verdict(CRASH, f"{type(error).__name__}: {error} ({place})")
    return {**found.as_dict(), "cpu": round(time.process_time() - begin, 3)}


def read_scenario(tree: Tree) -> Any:
    """The scenario, as from a file."""
    from ropewalk.scenario.loading import loads

    return loads(json.dumps(tree), "matrix.json")


def _run(tree: Tree, options: Tree) -> Verdict:
    from ropewalk.simulate import simulate

    return judge(simulate(read_scenario(tree)))


def _feedback(tree: Tree, options: Tree) -> Verdict:
    from ropewalk.coupling import feedback

    found = feedback(read_scenario(tree))
    json.dumps(found.as_dict(), allow_nan=False)
    return _worst(judge(found.coupled), judge(found.without))


def _compare(tree: Tree, options: Tree) -> Verdict:
    from ropewalk.compare import model_hierarchy

    found = model_hierarchy(read_scenario(tree))
    json.dumps(found.as_dict(), allow_nan=False)
    assert found.verdict
    good = [step.result for step in found.models.values() if step.result is not None and not step.reason]
    return _worst(Verdict(WORKS), *map(judge, good))


def _adequacy(tree: Tree, options: Tree) -> Verdict:
    from ropewalk.compare.adequacy import adequacy
    from ropewalk.compare.axes import Axis

    load = tree["loads"]["load"]
    (speed,) = (load["travel"]["speed"],)
    size = "loads.load.mass" if load["kind"] == "mass" else "run.until"
    base = load["mass"] if load["kind"] == "mass" else tree["run"]["until"]
    found = adequacy(
        read_scenario(tree),
        Axis("loads.load.travel.speed", (0.5 * speed, speed)),
        Axis(size, (0.5 * base, base)),
        workers=1,
    )
    if not np.isfinite(found.of()).any():
        said = "; ".join(reason for row in found.reasons for reason in row if reason)
        return Verdict(REFUSED, said or _why_not_linear(tree))
    return Verdict(WORKS)


def _why_not_linear(tree: Tree) -> str:
    """Why nothing is known of how far the linear theory is from the full model."""
    from ropewalk.compare import model_hierarchy

    steps = model_hierarchy(read_scenario(tree)).models
    step = steps["linear"]
    step = steps[step.same_as] if step.same_as else step
    return step.reason or "; ".join(step.doubts) or "no distances"


def _export_load(tree: Tree, options: Tree) -> Verdict:
    return _export(tree, "load", contact_stiffness=1e6)


def _export_line(tree: Tree, options: Tree) -> Verdict:
    return _export(
        tree, next(iter({**tree.get("lines", {}), **tree.get("overhead_lines", {}), **tree.get("nets", {})}))
    )


def _export(tree: Tree, what: str, **more: Any) -> Verdict:
    from ropewalk.cosim.export import export

    file = Path(f"export-{os.getpid()}.fmu")
    try:
        export(read_scenario(tree), what, file, **more)
        return Verdict(WORKS) if file.stat().st_size > 0 else Verdict(WRONG, "the FMU is empty")
    finally:
        file.unlink(missing_ok=True)


def _go_on(tree: Tree, options: Tree) -> Verdict:
    from ropewalk.simulate import simulate

    file = Path(f"before-{os.getpid()}.nc")
    try:
        with simulate(read_scenario(tree), file=file) as before:
            first = judge(before)
            last = before["position"].values[-1].copy()
        again = {**tree, "run": {**tree["run"], "start": {"kind": "result", "file": str(file)}}}
        result = simulate(read_scenario(again))
        away = float(np.abs(result["position"].values[0] - last).max())
        if away > ASIDE:
            return Verdict(WRONG, f"goes on {away:.3g} m away from where the line was")
        return _worst(first, judge(result))
    finally:
        file.unlink(missing_ok=True)


def _show(tree: Tree, options: Tree) -> Verdict:
    from ropewalk.results import export, figure, summary, text
    from ropewalk.simulate import simulate

    result = simulate(read_scenario(tree))
    found = summary(result)
    json.dumps(found, allow_nan=False)
    assert text(found)
    picture, data = Path(f"shown-{os.getpid()}.png"), Path(f"shown-{os.getpid()}.pvd")
    try:
        figure(result).savefig(picture, dpi=40)
        export(result, data)
    finally:
        for file in Path().glob(f"shown-{os.getpid()}*"):
            if file.is_file():
                file.unlink()
    return judge(result)


def _spectrum(tree: Tree, options: Tree) -> Verdict:
    from ropewalk.simulate import spectrum_of

    found = spectrum_of(read_scenario(tree), **options)
    values = found.as_dict()
    json.dumps(values, allow_nan=False)
    return Verdict(WORKS)


def _worst(*verdicts: Verdict) -> Verdict:
    order = ("CRASH", "WRONG", "refused", "stopped", "doubtful", "works")
    return min(verdicts, key=lambda verdict: order.index(verdict.verdict))


_TOOLS = {
    "run": _run, "feedback": _feedback, "compare": _compare, "adequacy": _adequacy, "export load": _export_load,
    "export line": _export_line, "go on": _go_on, "show": _show, "spectrum": _spectrum,
}  # fmt: skip


def furnish(folder: Path) -> None:
    """Put into a folder what scenarios name: a model of one's own, and vehicles as FMUs."""
    from ropewalk.cosim.export import export

    folder.mkdir(parents=True, exist_ok=True)
    (folder / "pressing.py").write_text((Path(__file__).parent / "pressing.py").read_text())
    for kg in sorted({structure.mass for structure in STRUCTURES}):
        s = next(s for s in STRUCTURES if s.mass == kg)
        base = BY_NAME["string"]
        tree = {**base.parts, "loads": {"load": {**matrices(s), "on": "rope", "travel": travel(base)}}}
        tree["run"] = {"kind": "dynamic", "until": 1.0}
        with contextlib.suppress(ImportError):
            export(
                read_scenario(tree),
                "load",
                folder / fmu_file(kg),
                contact_stiffness=2.0 * kg * (2.0 * np.pi * 3.0) ** 2,
            )


def main() -> None:
    """Answer lines of JSON on stdin by lines of JSON on stdout; nothing else gets to stdout."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    os.chdir(sys.argv[1])
    import faulthandler

    faulthandler.enable()
    with contextlib.suppress(ImportError):
        # Before any FMU that ropewalk wrote: it brings a pythonfmu of its own, and `export` would not know its classes.
        importlib.import_module("pythonfmu")
    for text in sys.stdin:
        answers.write(json.dumps(answer(json.loads(text))) + "\n")
        answers.flush()


if __name__ == "__main__":
    main()
