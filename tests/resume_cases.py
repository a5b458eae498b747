"""Small motions of every kind, for the tests of runs that are taken up again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import ropewalk
from ropewalk.model import Scenario
from ropewalk.scenario import loads

EXAMPLES = Path(__file__).parents[1] / "examples"
SMALL = {
    "force": ("moving-force", "run.until=0.3 s", "run.every=20 ms", "lines.rope.elements=20"),
    "mass": ("mass-approaching-support", "run.until=0.2 s", "run.every=20 ms"),
    "trolley": ("zip-line", "run.until=1 s", "run.every=0.1 s"),
    "walker": ("highline-walker", "run.until=1 s", "run.every=0.1 s"),
    "coach on a beam": ("bedded-line-vehicle", "run.until=0.05 s", "run.every=5 ms"),
    "pantograph, small motion": ("en50318-2002-250", "run.until=0.1 s", "run.every=10 ms"),
    "pantograph, large motion": (
        "en50318-2002-250", "run.until=0.02 s", "run.every=2 ms", "run.geometry=nonlinear", "run.axial_inertia=4",
    ),
    "dropper that fails": (
        "overhead-line-dropper-failure", "run.until=0.1 s", "run.every=10 ms",
        "overhead_lines.line.droppers.cut.time=35 ms",
    ),
    "sheaves": ("sheaves", "run.until=0.2 s", "run.every=20 ms"),
    "net": ("trampoline-net", "run.until=0.1 s", "run.every=10 ms"),
    "footbridge": ("suspension-footbridge", "run.until=0.4 s", "run.every=40 ms"),
}  # fmt: skip

ROPE = """
lines:
  s: {start: [0, 0], end: [100, 0], tension: 20 kN, mass: 1, axial_stiffness: 2 MN, elements: 40, axial_damping: %s}
loads: {m: %s}
run: {kind: dynamic, until: 0.4, every: 0.04%s}
"""
STEPS = """{kind: footsteps, on: s, mass: 70, frequency: 2.5 Hz, step_length: 0.7 m, overlap: 0.2, from: 20 m}"""
OSCILLATOR = """{kind: oscillator, on: s, mass: 20, stiffness: 4 kN/m, damping: 50 N*s/m,
  travel: {speed: 20, from: 5 m}}"""
STEPPER = """{kind: stepper, on: s, model: "external_cases:%s", every: 10 ms, exchange: {%s}}"""
VEHICLE = """{kind: vehicle, on: s, bodies: {box: {mass: 60, inertia: 20}}, wheels: {front: {at: 1 m},
  rear: {at: -1 m, mass: 5}}, springs: {front: {between: [box, front], stiffness: 9 kN/m, damping: 200},
  rear: {between: [box, rear], stiffness: 9 kN/m, damping: 200}}, travel: {speed: 20, from: 8 m}%s}"""
FREE = """{kind: mass, on: s, mass: 40, air_drag: 0.2, travel: {kind: free, speed: 6, from: 5 m, friction: 0.02,
  brake: {force: 200 N, within: 93 m}}}"""
MASS = "{kind: mass, on: s, mass: 20, travel: {speed: 20, from: 5 m}}"
WRITTEN = {
    "footsteps": (0, STEPS, ""),
    "oscillator": (0, OSCILLATOR, ""),
    "force, implicit": (1e4, "{kind: force, on: s, force: [0, -500], travel: {speed: 20, from: 5 m}}",
                        ", method: implicit"),
    "vehicle": (0, VEHICLE % "", ""),
    "free mass": (0, FREE, ""),
    "frictionless mass": (0, MASS.replace("travel", "contact: frictionless, travel"), ""),
    "stepper": (0, STEPPER % ("Sprung", "order: 2"), ""),
    "stepper, parallel": (0, STEPPER % ("Sprung", "scheme: parallel, damping: 20"), ""),
    "stepper, iterated": (0, STEPPER % ("Mass", "scheme: iterated, stiffness: 4e3"), ""),
}  # fmt: skip
SHAKEN = """start_support: {kind: elastic, stiffness: 100 kN/m, damping: 50 N*s/m, displacement: {time: [0, 0.1, 0.5],
    value: [[0, 0], [0, 0.05], [0, -0.05]]}}, end_support: {kind: moving, displacement: {time: [0, 0.5],
    value: [[0, 0], [0, 0.1]]}}, elements:"""
THROWN = """start_support: {kind: moving, displacement: {time: [0, 0.1, 0.2, 0.3], value: [[0, 0], [0, 0.3], [0, -0.3],
    [0, 0]]}}, elements:"""
SUPPORTS = {
    "rope, moving supports": "",
    "network, moving supports": "wind_drag: 0.01, ",
    "network, mass": "wind_drag: 0.01, ",
    "stiff line, moving supports": "bending_stiffness: 1e4, ",
    "small motion, moving supports": "bending_stiffness: 1e4, ",
}
STIFF = {
    "beam, vehicle": "vehicle", "beam, oscillator": "oscillator",
    "beam, stepper": "stepper", "beam, parallel": "stepper, parallel", "beam, iterated": "stepper, iterated",
}  # fmt: skip
WALKER = "{kind: walker, on: s, mass: 70, foot_mass: 1, leg_damping: 100, from: 20 m}"
AIRY = {
    "network, walker": WALKER, "network, walker on weightless feet": WALKER.replace("foot_mass: 1", "foot_mass: 0"),
    "network, balance": WALKER.replace("from", "balance: {}, from"),
    "network, stepper": WRITTEN["stepper"][1], "network, parallel": WRITTEN["stepper, parallel"][1],
    "network, iterated": WRITTEN["stepper, iterated"][1],
}  # fmt: skip
LEAVES = {"vehicle that lifts off": "", "beam, vehicle that lifts off": "bending_stiffness: 1e4, "}
AWNING = """
nets:
  awning: {kind: membrane, boundary: [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], spacing: 0.4, stiffness: 3e4,
    mass: 0.8, tension: 500, damping: 5, edge: {kind: clamped}}
loads: {m: {kind: mass, on: awning, mass: 8, travel: {speed: 3, path: [[0.5, 0.5], [1.6, 1.4]], at_end: stay}}}
run: {kind: dynamic, until: 0.1, every: 0.01}
"""
NETS = {"membrane, mass": AWNING}
KINDS = (*SMALL, *WRITTEN, *STIFF, *SUPPORTS, *AIRY, *LEAVES, *NETS)


def case(kind: str, *settings: str) -> Scenario:
    """A small motion."""
    if kind in SMALL:
        name, *given = SMALL[kind]
        return ropewalk.load(EXAMPLES / f"{name}.yaml", [*given, *settings])
    if kind in SUPPORTS:
        damping, load, _ = WRITTEN["footsteps"] if kind.startswith("network") else WRITTEN["oscillator"]
        load = MASS if kind.endswith("mass") else load
        more = ", geometry: linearised" if kind.startswith("small") else ""
        text = (ROPE % (damping, load, more)).replace("elements:", SUPPORTS[kind] + SHAKEN)
        text = text.replace("axial_damping: 0", "drag: 0.1")
        return loads(text + ("wind: {speed: 5, direction: [1, 0]}" if kind[0] == "n" else ""), "rope.yaml", settings)
    if kind in AIRY:
        text = (ROPE % (10, AIRY[kind], "")).replace("elements:", "wind_drag: 0.01, elements:")
        return loads(text + "wind: {speed: 5, direction: [1, 0]}", "rope.yaml", settings)
    if kind in NETS:
        return loads(NETS[kind], "net.yaml", settings)
    if kind in LEAVES:
        text = ROPE % (0, VEHICLE % ", lift_off: true", "")
        return loads(text.replace("elements:", LEAVES[kind] + THROWN), "rope.yaml", settings)
    text = ROPE % WRITTEN[STIFF.get(kind, kind)]
    if kind in STIFF:
        text = text.replace("elements:", "bending_stiffness: 1e4, elements:")
    return loads(text, "rope.yaml", settings)


class Stateless:
    """A model that cannot tell its state."""

    def step(self, t: float, h: float, line: Any) -> list[tuple[float, tuple[float, float], float]]:
        """One contact that goes along the line."""
        return [(5.0 + 20.0 * t, (0.0, -100.0), 20.0)]
