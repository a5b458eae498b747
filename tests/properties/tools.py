"""Relations between ways to compute a scenario: resumed, with other output instants, by the command, in a sweep."""

from __future__ import annotations

import json
import tempfile
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING

import numpy as np

from .compare import FORCES, MODEST, PLACES, Sides
from .geometry import with_fields
from .running import DONE, REFUSED, STOPPED, Outcome, attempt, read, run
from .trees import Tree, loads_of

if TYPE_CHECKING:
    import xarray as xr

EXACT = 1e-9
"""A run that is resumed takes the same steps."""


def resumed(tree: Tree, rng: Random) -> Sides:
    """Run to half the time, and resume."""
    from ropewalk.resuming import resume
    from ropewalk.simulate import simulate

    half = {**tree, "run": {**tree["run"], "until": 4 * tree["run"]["every"]}}

    def compute() -> xr.Dataset:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "half.nc"
            first = simulate(read(half), file=file)
            if first.attrs["outcome"] not in ("completed", "doubtful"):
                return first.load()
            first.close()
            return resume(file, tree["run"]["until"]).load()

    return Sides(run(tree), attempt(compute), tolerance=EXACT)


def more_output(tree: Tree, rng: Random) -> Sides:
    """Keep three times as many instants."""
    finer = {**tree, "run": {**tree["run"], "every": tree["run"]["every"] / 3}}
    stops = any(load.get("travel", {}).get("at_end") == "stay" for load in loads_of(tree))  # with a blow
    quiet = "geometry" in tree["run"] or tree["run"]["kind"] == "linear"
    only = (*PLACES, *FORCES) if quiet and not stops else PLACES
    right = with_fields(run(finer), lambda f: {key: values[::3] for key, values in f.items()})
    return Sides(run(tree), right, tolerance=MODEST, only=only)


def command_line(tree: Tree, rng: Random) -> Sides:
    """Run a file by the command."""
    from ropewalk.cli.app import app
    from ropewalk.results import open_result

    with tempfile.TemporaryDirectory() as folder:
        file, result = Path(folder) / "scenario.yaml", Path(folder) / "result.nc"
        file.write_text(json.dumps(tree), encoding="utf-8")
        try:
            with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
                code = app(["run", str(file), "-o", str(result), "--quiet"], standalone_mode=False) or 0
        except SystemExit as end:
            code = int(end.code or 0)
        if code in (0, 4):
            return Sides(run(tree), attempt(lambda: open_result(result).load()), tolerance=EXACT)
    return Sides(run(tree), Outcome(REFUSED if code == 2 else STOPPED, text=f"exit code {code}"))


def sweep_of_one(tree: Tree, rng: Random) -> Sides | None:
    """Compute the scenario as the only case of a sweep."""
    from ropewalk.sweeps.sweeping import sweep

    left = run(tree)
    if left.kind != DONE or not any(name == "tension" for name, _ in left.fields):
        return None
    try:
        found = sweep(read(tree), {"gravity": [tree["gravity"]]}, record="max tension, min tension", workers=0)
        values = [float(found[name].values.ravel()[0]) for name in ("max tension", "min tension")]
    except Exception as error:
        return Sides(left, Outcome("crash", text=f"sweep: {type(error).__name__}: {error}"))
    tension = [values for (name, _), values in left.fields.items() if name == "tension"]
    own = [max(float(np.max(v)) for v in tension), min(float(np.min(v)) for v in tension)]
    key = "tension", "largest and smallest"
    one, other = (Outcome(DONE, {key: np.array(v)}) for v in (own, values))
    return Sides(one, other, tolerance=EXACT, path=False)
