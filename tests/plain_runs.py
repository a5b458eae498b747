"""Small runs of every engine, for kernels as plain Python: `NUMBA_DISABLE_JIT=1 python tests/plain_runs.py`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from ropewalk.model import Scenario
from ropewalk.scenario import load
from ropewalk.simulate import simulate

EXAMPLES = Path(__file__).parent.parent / "examples"
ROPE: dict[str, Any] = {
    "start": [0, 0], "end": [6, 0], "length": 5.9, "mass": 1.0, "axial_stiffness": 1e4, "axial_damping": 20.0,
    "elements": 6,
}  # fmt: skip
JOINED = {"kind": "joined", "to": "knot"}
NET = {"corner": [0, 0, 0], "sides": [[3, 0, 0], [0, 2, 0]], "cells": [3, 2]}
WAY = [[0.5, 0.6], [2.5, 1.4]]
GUST = {"direction": [0.2, 1], "speed": {"time": [0, 0.05], "value": [0.0, 20.0]}}


def on(kind: str, speed: float = 20.0, start: float = 0.5, **more: Any) -> dict[str, Any]:
    """A load that leaves its line within 0.3 s, or passes most of its nodes."""
    travel = {"speed": speed, "from": start, "at_end": "leave"}
    own = {"force": [0, -50]} if kind == "force" else {"mass": 3.0}
    return {"kind": kind, "on": "rope", **own, "travel": travel, **more}


def over(kind: str) -> dict[str, Any]:
    """A load that goes over the cells of a net within 0.3 s."""
    given = on(kind, 8.0, 0.2)
    given["travel"]["path"] = WAY
    return given | {"on": "net"} | ({"force": [0, 0, -50]} if kind == "force" else {})


def scenarios() -> dict[str, dict[str, Any]]:
    """What each run is, by name."""
    soft = {"kind": "elastic", "stiffness": 1e4, "damping": 10.0, "mass": 0.5}
    rail = {"kind": "guided", "along": [1, 0], "stiffness": 5e3, "mass": 0.5}
    sides = {"start_support": soft, "end_support": rail}
    chain: dict[str, list[dict[str, Any]]] = {
        "force": [on("force"), on("force", start=2.7)],
        "mass": [on("mass"), on("mass", start=2.7)],
        "oscillator": [on("oscillator", stiffness=1e3, damping=5.0)],
        "oscillator on a spring": [
            on("oscillator", stiffness=1e3, contact_stiffness=1e4, wheel_mass=0.3, lift_off=True)
        ],
        "mass that lifts off": [on("mass", lift_off=True)],
        "frictionless mass": [on("mass", contact="frictionless")],
        "free mass": [
            {"kind": "mass", "on": "rope", "mass": 3.0,
             "travel": {"kind": "free", "from": 2.5, "speed": 6.0, "friction": 0.1}}
        ],
    }  # fmt: skip
    lines = {"rope": ROPE}
    out: dict[str, dict[str, Any]] = {
        f"chain: {name}": {"lines": {"rope": {**ROPE, **sides}} if name == "mass" else lines,
                           "loads": {f"l{i}": load for i, load in enumerate(loads)}}
        for name, loads in chain.items()
    }  # fmt: skip
    out["chain: implicit"] = {"lines": lines, "loads": {"l": on("force")}, "run": {"method": "implicit"}}
    bare = {"rope": {key: value for key, value in lines["rope"].items() if key != "axial_damping"}}
    out["chain: rkn6"] = {"lines": bare, "loads": {"l": on("force")}, "run": {"method": "rkn6"}}
    steps = {"kind": "footsteps", "on": "rope", "mass": 60.0, "frequency": 2.5, "step_length": 0.7, "from": 1.0}
    out["chain: footsteps"] = {"lines": lines, "loads": {"l": steps}}
    stiff = {"rope": {**ROPE, "axial_damping": 0.0, "length": None, "tension": 200.0, "bending_stiffness": 5.0}}
    for geometry in ("nonlinear", "linearised"):
        for kind, more in (("force", {}), ("mass", {}), ("oscillator", {"stiffness": 1e3})):
            loads = {"l": on(kind, **more)}
            out[f"wires: {geometry}, {kind}"] = {"lines": stiff, "loads": loads, "run": {"geometry": geometry}}
    knot = {"lines": {"rope": {**ROPE, "end_support": JOINED, "start_support": soft},
                      "other": {**ROPE, "start": [12, 0], "end": [6, 0], "start_support": rail, "end_support": JOINED}},
            "joints": {"knot": {"mass": 1.0}}}  # fmt: skip
    wheel = {"rope": {**ROPE, "start": [-2, -1], "end": [6, 0], "length": 8.3, "elements": 8,
                      "sheaves": {"wheel": {"at": [0, 0], "friction": 0.1}}}}  # fmt: skip
    beyond = on("mass")
    beyond["travel"] |= {"from": 4.5}
    out["webs: joint"] = {
        **knot,
        "loads": {"f": on("force"), "m": {**on("mass", 15.0), "on": "other"}},
    }
    tight = {"rope": {**bare["rope"], "axial_stiffness": None, "length": 6.5, "law": {"kind": "inextensible"}, **sides}}
    out["system: inextensible"] = {"lines": tight, "loads": {"f": on("force"), "m": on("mass", 20.0, 2.0)}}
    out["webs: sheave"] = {"lines": wheel, "loads": {"m": beyond}}
    out["webs: wind"] = {"lines": {"rope": {**ROPE, "wind_drag": 0.1}}, "wind": GUST, "loads": {"m": on("mass")}}
    rubbed = on("force", start=2.0, contact="dragged", friction=0.1)
    out["webs: wind, rubbed"] = {
        "lines": {"rope": {**ROPE, "wind_drag": 0.1}}, "wind": GUST,
        "loads": {"m": on("mass", contact="frictionless"), "f": rubbed},
    }  # fmt: skip
    out["webs: heavier along"] = {**knot, "loads": {"f": on("force")}, "run": {"axial_inertia": 4.0}}
    thread = {"kind": "net", **NET, "axial_stiffness": 1e4, "mass": 0.2, "tension": 100.0, "axial_damping": 5.0}
    skin = {"kind": "membrane", **NET, "cells": [2, 2], "stiffness": 1e4, "mass": 0.5, "tension": 200.0, "damping": 5.0}
    cable = {"kind": "cable", "axial_stiffness": 1e5, "mass": 0.5, "tension": 500.0}
    for name, sheet in (("net", {**thread, "edge": cable}),
                        ("membrane", {**skin, "edge": {"kind": "soft", "stiffness": 1e4}})):  # fmt: skip
        out[f"webs: {name}"] = {"nets": {"net": sheet}, "loads": {"f": over("force"), "m": over("mass")}}
    for kind in ("quasistatic", "equilibrium"):
        run = {"kind": kind} | ({"positions": 4} if kind == "quasistatic" else {})
        out[f"chain: {kind}"] = {"lines": lines, "loads": {"l": on("force")}, "run": run}
        out[f"webs: {kind}"] = {**knot, "loads": {"l": on("force")}, "run": run}
    return out


def run(name: str, given: dict[str, Any]) -> str:
    """Run one; returns how it went."""
    asked = {"kind": "dynamic", **given.get("run", {})}
    if asked["kind"] == "dynamic":
        asked |= {"until": 0.1 if "nets" in given else 0.3, "every": 0.1}
    return str(simulate(Scenario.model_validate({**given, "run": asked})).attrs["outcome"])


def example(name: str) -> str:
    """A shipped example on a coarse mesh, for a few steps."""
    scenario = load(EXAMPLES / f"{name}.yaml")
    lines = {on: line.model_copy(update={"elements": 12}) for on, line in scenario.lines.items()}
    sections = {on: line.model_copy(update={"element": 5.5}) for on, line in scenario.overhead_lines.items()}
    run = scenario.run.model_copy(update={"until": 0.02, "every": 0.01})
    changed = scenario.model_copy(update={"lines": lines, "overhead_lines": sections, "run": run})
    return str(simulate(changed).attrs["outcome"])


CASES = ("bridge-vehicle-2004", "cable-crane-crab", "highline-walker", "leash-fall", "simple-ac-275", "zip-line")

if __name__ == "__main__":
    wanted = sys.argv[1:]
    for name, given in scenarios().items():
        if not wanted or any(word in name for word in wanted):
            print(f"{name}: {run(name, given)}", flush=True)
    for name in CASES:
        if not wanted or name in wanted:
            print(f"{name}: {example(name)}", flush=True)
