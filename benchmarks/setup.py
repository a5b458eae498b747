"""CPU time from a scenario to the first step, for growing structures, and how it grows."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ropewalk.model import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.scenario import load
from ropewalk.simulate import run_of

from .nets import crossing
from .overhead import EXAMPLE, reference


def hung(hangers: int) -> Scenario:
    """A suspension bridge with so many hangers every 4 m, and four links between them."""
    span = 4.0 * (hangers + 1)
    lines = {
        "cable": {"start": [0, 0.1 * span + 2], "end": [span, 0.1 * span + 2], "length": 1.026 * span, "mass": 6.0,
                  "axial_stiffness": 60e6, "elements": 4 * hangers + 4},
        "deck": {"start": [0, 0], "end": [span, 0], "tension": 60e3, "mass": 40.0, "axial_stiffness": 80e6,
                 "elements": 4 * hangers + 4},
    }  # fmt: skip
    row = {"from": "cable", "to": "deck", "count": hangers, "mass": 0.6, "axial_stiffness": 10e6}
    force = {"kind": "force", "on": "deck", "force": [0, -800], "travel": {"speed": 5.0, "from": 0.5}}
    run = {"kind": "dynamic", "until": 0.3, "every": 0.3}
    return Scenario.model_validate({"lines": lines, "hangers": {"row": row}, "loads": {"force": force}, "run": run})


def strung(spans: int) -> Scenario:
    """An overhead line of so many spans of 60 m with links of 0.5 m."""
    return reference(spans, 0.5, geometry="linearised", window=180.0, until=2.0)


def loaded(axles: int) -> Scenario:
    """A bridge under a train of coaches with three axles each."""
    scenario = load(EXAMPLE.with_name("bridge-coaches.yaml"), ("loads.train.at=[0 m, 2.5 m, 19 m]",))
    train = scenario.loads["train"]
    coaches = train.coaches.model_copy(update={"count": axles // 3})
    return scenario.model_copy(update={"loads": {"train": train.model_copy(update={"coaches": coaches})}})


GROWING: dict[str, tuple[Callable[[int], Scenario], tuple[int, ...]]] = {
    "hangers of a bridge": (hung, (16, 31, 62, 125, 250, 500)),
    "nodes a side of a net": (lambda n: crossing(n, 0.1), (50, 100, 200)),
    "spans of an overhead line": (strung, (50, 100, 200, 400)), "axles on a bridge": (loaded, (75, 150, 300, 600)),
}  # fmt: skip
"""Structures by what grows in them."""


def setup(sizes: Mapping[str, Sequence[int]] | None = None) -> tuple[list[str], list[list[object]]]:
    """Return head and rows of the table.

    Args:
        sizes: other numbers than those of GROWING; what is not named is left out.
    """
    rows = list[list[object]]()
    for name, (make, usual) in GROWING.items():
        if sizes is not None and name not in sizes:
            continue
        counts, spent = list(usual if sizes is None else sizes[name]), list[float]()
        run_of(make(counts[0]), RunInfo())  # kernels are loaded
        for count in counts:
            scenario = make(count)
            begin = clock.process_time()
            run_of(scenario, RunInfo())
            spent.append(clock.process_time() - begin)
        power = np.log(spent[-1] / spent[-2]) / np.log(counts[-1] / counts[-2])
        texts = [" / ".join(map(str, counts)), " / ".join(f"{each:.2f}" for each in spent)]
        rows.append([name, *texts, f"{power:.2f}"])
    return ["set-up", "sizes", "CPU, s", "exponent of the last doubling"], rows
