"""All trains at all speeds: 1010 crossings by modes, beside full runs, and beside modes integrated elsewhere.

A bridge of 20 m, 5 Hz and 1 % of damping under HSLM-A1 to A10, 100 to 350 km/h in steps of 2.5 (EN 1991-2, 6.4.6).
"""

from __future__ import annotations

import time as clock
from collections.abc import Sequence
from statistics import median
from typing import Any

import numpy as np

import ropewalk
from ropewalk.model.axles import HSLM_A, hslm_a
from ropewalk.scenario import loads
from ropewalk.sweeps.by_modes import by_modes
from ropewalk.sweeps.case import computed
from ropewalk.sweeps.plan import Plan, asked

BRIDGE = """\
gravity: 0 m/s^2
lines:
  deck: {start: [0 m, 0 m], end: [20 m, 0 m], length: 20 m, mass: 10 t/m, bending_stiffness: 16.2114 GN*m^2,
         axial_stiffness: 10 GN, drag: 0.6283 Hz, elements: 20}
loads: {train: {kind: axles, on: deck, train: HSLM-A1, travel: {speed: 200 km/h}}}
outputs: {cut_off: 30 Hz}
run: {kind: linear, until: crossing + 1 s, every: 4 ms, modes: 3}
"""
SPEEDS = "100:350:2.5 km/h"
OVER = {"loads.train.train": list(HSLM_A), "loads.train.travel.speed": SPEEDS}
RECORD = ("max acceleration of deck", "max deflection of deck")
LENGTH, MASS, STIFFNESS, ALPHA = 20.0, 10e3, 16.2114e9, 0.6283


def deflection(places: Sequence[float], force: float, speed: float, modes: int = 3, step: float = 2e-4) -> float:
    """The largest deflection at 21 places, m, of modes integrated in steps of Newmark (average acceleration)."""
    behind, n = np.array(places), np.arange(1, modes + 1)
    w = (n * np.pi / LENGTH) ** 2 * np.sqrt(STIFFNESS / MASS)
    t = np.arange(0.0, (LENGTH + behind[-1]) / speed + 1.0, step)
    at = speed * t[:, None] - behind
    on = ((at >= 0.0) & (at <= LENGTH)).astype(float)
    f = (
        np.stack([(on * np.sin(k * np.pi / LENGTH * at)).sum(axis=1) for k in n], axis=1)
        * 2.0
        * force
        / (MASS * LENGTH)
    )
    q, v, largest = np.zeros(modes), np.zeros(modes), 0.0
    a, shape = f[0], np.sin(np.outer(n, np.linspace(0.0, np.pi, 21)))
    inverse = 1.0 / (1.0 + 0.5 * step * ALPHA + 0.25 * (step * w) ** 2)
    rows = np.zeros((t.size, modes))
    for i in range(1, t.size):
        ahead, faster = q + step * (v + 0.25 * step * a), v + 0.5 * step * a
        a = (f[i] - ALPHA * faster - w * w * ahead) * inverse
        q, v = ahead + 0.25 * step * step * a, faster + 0.5 * step * a
        rows[i] = q
    for first in range(0, t.size, 4096):
        largest = max(largest, float((rows[first : first + 4096] @ shape).max()))
    return largest


def cpu(call: Any) -> tuple[float, Any]:
    """CPU seconds of a call, and its answer."""
    begin = clock.process_time()
    found = call()
    return clock.process_time() - begin, found


def main() -> None:
    """Print the tables."""
    scenario = loads(BRIDGE)
    computed(Plan.of(scenario, asked(scenario, {"loads.train.train": ["HSLM-A1"]}, record=RECORD)).rows[0].case)
    planned, plan = cpu(lambda: Plan.of(scenario, asked(scenario, OVER, record=RECORD)))
    cases = [row.case for row in plan.rows if row.case is not None]
    taken = [cpu(lambda: [by_modes(case.scenario, case.record) for case in cases])[0] for _ in range(3)]
    whole, found = cpu(lambda: ropewalk.sweep(scenario, OVER, record=RECORD, workers=0))
    print(
        f"\n{len(cases)} crossings, CPU seconds: by modes {median(taken):.2f} ({min(taken):.2f} to {max(taken):.2f}),"
    )
    print(f"  all of ropewalk.sweep {whole:.2f}, of which reading and checking the scenarios {planned:.2f}")
    some = cases[50::101]
    full = [cpu(lambda case=case: ropewalk.simulate(case.scenario))[0] for case in some]
    run = "run={kind: dynamic, geometry: linearised, until: crossing + 1 s, every: 4 ms}"
    steps = loads(BRIDGE, overrides=[run])
    ropewalk.simulate(steps)
    stepped = median(cpu(lambda: ropewalk.simulate(steps))[0] for _ in range(3))
    each = median(taken) / len(cases)
    print(f"  one of them {1e3 * each:.2f} ms; as a run with all of its result {median(full) / each:.0f} times that, ")
    print(f"  in steps (geometry: linearised, HSLM-A1 at 200 km/h) {stepped / each:.0f} times\n")
    print("  train      largest acceleration      f D   deflection there   Newmark   full run")
    for train in HSLM_A:
        a = found["max acceleration of deck"].sel(train=train)
        w = found["max deflection of deck"].sel(train=train)
        at = float(a.idxmax("speed"))
        places, force = hslm_a(train)
        here = float(w.sel(speed=at))
        apart = deflection(places, force, at / 3.6)
        set_to = [f"loads.train.train={train}", f"loads.train.travel.speed={at!r} km/h"]
        with ropewalk.simulate(loads(BRIDGE, overrides=set_to)) as result:
            run = ropewalk.summary(result)["lines"]["deck"]["deflection"]["max"]
        print(
            f"  {train:9} {float(a.max()):6.2f} m/s^2 at {at:5.1f} km/h {18.0 * HSLM_A[train].length:6.0f} km/h "
            f"{1e3 * here:9.4f} mm {apart / here - 1.0:12.1e} {run / here - 1.0:10.1e}"
        )


if __name__ == "__main__":
    main()
