"""Many runs in one sweep: an overhead line at speeds and tensions, and ropes by the thousand.

By default a part of them; the whole, 120 runs of ten spans and 10 000 ropes of 50 links, takes many minutes.
"""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path
from typing import Any

import ropewalk
from ropewalk.scenario import load, loads

from .throughput import used

LINE = Path(__file__).parents[1] / "examples" / "en50318-2002-300.yaml"
WIRE, SPEED = "overhead_lines.line.contact_wire.tension", "loads.pantograph.travel.speed"
TENSIONS = {False: "20 kN", True: "16 kN, 20 kN, 24 kN"}
SPEEDS = {False: "200:300:100 km/h", True: "155:350:5 km/h"}
"""Of a part, and of the whole."""
ROPES = {False: 100, True: 10_000}
ROPE = """\
lines: {rope: {start: [0, 0], end: [50, 0], length: 52, mass: 1, axial_stiffness: 1e5, elements: 50}}
loads: {man: {kind: force, on: rope, force: [0, -100], travel: {speed: 1, from: 20}}}
run: {kind: equilibrium}
"""


def swept(name: str, call: Any) -> Any:
    """Make a sweep, and tell what it took."""
    before, found = os.getloadavg()[0], list[Any]()
    wall, cpu = used(lambda: found.append(call()))
    outcomes = found[0]["outcome"].values.ravel().tolist()
    count = len(outcomes)
    print(f"  {name}: {count} cases ({dict(Counter(outcomes))}) in {wall:.1f} s, {cpu:.1f} s of processors,")
    print(f"    {1e3 * cpu / count:.1f} ms each; load of the machine {before:.1f} to {os.getloadavg()[0]:.1f}")
    return found[0]


def main(whole: bool = False) -> None:
    """Print what was measured."""
    print("\nMany runs in one sweep, processes of all cores\n")
    over = {SPEED: SPEEDS[whole], WIRE: TENSIONS[whole]}
    until = {"run.until": f"580 m / {SPEED}"}
    record = ("max contact_force", "min contact_force")
    line = swept(
        "overhead line of 10 spans",
        lambda: ropewalk.sweep(load(LINE), over, derived=until, record=record, workers=None),
    )
    most = line["max contact_force"]
    print(f"    largest contact force {float(most.min()):.0f} to {float(most.max()):.0f} N")
    forces = {"loads.man.force.1": f"linear(-50 N, -150 N, {ROPES[whole]})"}
    ropes = swept("ropes of 50 links at rest", lambda: ropewalk.sweep(loads(ROPE), forces, record="max tension"))
    found = ropes["max tension"]
    print(f"    largest tension {float(found.min()):.2f} to {float(found.max()):.2f} N")


if __name__ == "__main__":
    main()
