"""Runs the command line with a stand-in for the solver; the title of the scenario says how the run goes."""

from __future__ import annotations

import sys
import time
from dataclasses import replace
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "results"))

import travelling_wave as wave

from ropewalk.errors import EquilibriumError
from ropewalk.results import Recorder, RunInfo

ADVICE = "try a smaller step"


def simulate(scenario, *, file=None, overwrite=False, progress=None, begun=None, opened=None):
    run_info = RunInfo(method="rkn6", reason="undamped", step=1e-3, steps=181, wall_seconds=0.5)
    if scenario.title == "no equilibrium":
        raise EquilibriumError("the line is shorter than the distance of its ends")
    if scenario.title == "fault":
        raise ZeroDivisionError("float division by zero")
    plan = wave.layout()
    recorder = Recorder(plan, scenario, run_info, file, opened=opened)
    try:
        for count, frame in enumerate(wave.frames(plan, np.linspace(0.0, 1.8, 61))):
            if scenario.title == "no force":
                frame = replace(frame, contact_force=0.0 * frame.contact_force)
            recorder.append(frame)
            if progress is not None:
                progress((count + 1) / 61)
            if scenario.title == "breakdown" and count == 20:
                run_info.outcome, run_info.advice = "diverged", ADVICE
                break
            if scenario.title == "impossible" and count == 20:
                raise EquilibriumError("Newton found no rest shape")
            if scenario.title == "slow":
                print("step", count, file=sys.stderr, flush=True)
                time.sleep(0.02 if count < 20 else 60.0)  # until it is interrupted, however busy the machine is
    except KeyboardInterrupt:
        run_info.outcome = "interrupted"
    return recorder.close()


def figures(directory, only=None, progress=None):
    Path(directory).mkdir(exist_ok=True)
    for name in only or PAPER.AVAILABLE:
        (Path(directory) / f"figure-{name}.txt").write_text("drawn")
    if progress is not None:
        progress(1.0)


SIMULATE = ModuleType("ropewalk.simulate")
SIMULATE.simulate = simulate
SIMULATE.must_compile = lambda scenario: ""
SIMULATE.run_of = lambda scenario, run_info: None
SIMULATE.sample_warnings = lambda scenario: []
PAPER = ModuleType("ropewalk.paper")
PAPER.AVAILABLE = [3, 4, "table-1"]
PAPER.figures = figures
SIMULATE.spectrum_of = lambda scenario, *, at: SimpleNamespace(
    table=lambda: [("at", f"{at}"), ("largest frequency", "12.5 Hz")], as_dict=lambda: {"at": at}
)

if __name__ == "__main__":
    sys.modules["ropewalk.simulate"] = SIMULATE
    from ropewalk.__main__ import main

    sys.argv[0] = "ropewalk"
    main()
