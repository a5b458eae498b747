"""Cases of capabilities that neither the matrix nor an example shows."""

from __future__ import annotations

from collections.abc import Iterator
from zlib import crc32

from conformance.bases import BASES
from conformance.cases import dynamic, scenario
from conformance.keys import Change, changes
from conformance.loads import load, travel
from conformance.structures import BY_NAME, Tree

EACH = 2  # changes of each key to each choice
RESUMED = (
    ("string", "mass"), ("slack", "walker"), ("inextensible", "oscillator"), ("stiff", "vehicle"), ("beam", "force"),
    ("beam-linearised", "train"), ("overhead", "pantograph"), ("overhead-linearised", "pantograph"), ("hung", "mass"),
    ("ring", "oscillator"), ("sheave", "force"), ("shoe", "trolley"), ("wind", "footsteps"), ("net", "mass"),
    ("membrane", "force"), ("hysteresis", "mass"), ("cut", "mass"), ("rough", "vehicle"), ("track", "axles"),
)  # fmt: skip
"""Structures and loads of motions that are resumed from a checkpoint halfway."""
OVERHEAD = ("overhead", "staggered", "stitched", "failing", "overlap")
STILL = {"kind": "equilibrium"}
GRADIENTS = (("string", "force"), ("slack", "mass"), ("beam", "force"), ("stiff", "mass"))
PLACE = {"places": {"quarter": {"on": "rope", "at": 5.0}}, "impact": True}

Answered = tuple[str, Tree, str, Tree]
"""Name, scenario, tool and options."""


def additional() -> Iterator[Answered]:
    """Return the additional cases."""
    for name, tree in BASES.items():
        yield f"base / {name}", tree, "run", {}
    for change in variations():
        yield (
            f"key / {change.base} / {'.'.join(change.place)} / {change.name} = {change.choice[:60]}",
            change.tree(),
            "run",
            {},
        )
    for name, kind in RESUMED:
        s = BY_NAME[name]
        yield f"resume / {name} / {kind}", scenario(s, {"load": load(s, kind)}), "resume", {}
    for name in OVERHEAD:
        s = BY_NAME[name]
        yield f"elasticity / {name}", scenario(s, {"load": load(s, "pantograph")}), "elasticity", {}
    for name, kind in GRADIENTS:
        s = BY_NAME[name]
        yield f"gradient / {name} / {kind}", scenario(s, {"load": load(s, kind)}, STILL), "gradient", {}
    for name in ("beam", "beam-linearised", "piers", "stepped", "bed"):
        for kind in ("vehicle", "axles", "train"):
            s = BY_NAME[name]
            yield f"impact / {name} / {kind}", scenario(s, {"load": load(s, kind)}, outputs=PLACE), "run", {}
    yield from _functions_of_time()
    yield from _linear()
    for name in ("beam-linearised", "bed-linearised", "overhead-linearised", "overhead"):
        s = BY_NAME[name]
        kind = "pantograph" if s.family == "overhead" else "vehicle"
        yield f"window found / {name}", scenario(s, {"load": load(s, kind)}, dynamic(s, window="auto")), "run", {}


def _functions_of_time() -> Iterator[Answered]:
    """Python functions of time for force, speed, drive and displacement."""
    for name in ("string", "slack", "beam", "overhead-linearised", "hung"):
        s = BY_NAME[name]
        loads = {"load": load(s, "force")}
        yield f"functions of time / force / {name}", scenario(s, loads), "functions of time", {"of": "force"}
    for name in ("string", "beam"):
        s = BY_NAME[name]
        loads = {"load": load(s, "mass", travel(s, kind="free", drive=1.0))}
        yield f"functions of time / drive / {name}", scenario(s, loads), "functions of time", {"of": "drive"}
        parts = s.with_line(end_support={"kind": "moving", "displacement": [0.0, 0.02]})
        tree = scenario(s, {"load": load(s, "mass")}, lines=parts["lines"])
        yield f"functions of time / displacement / {name}", tree, "functions of time", {"of": "displacement"}


def _linear() -> Iterator[Answered]:
    """Loads that lift off or travel freely in linear theory, and trains whose peaks follow from modes."""
    for name in ("string", "beam", "piers", "hung"):
        s = BY_NAME[name]
        run = {"kind": "linear", "until": s.until, "every": 0.01}
        for kind in ("mass", "oscillator", "vehicle"):
            yield (
                f"linear, lifts off / {name} / {kind}",
                scenario(s, {"load": load(s, kind, lift_off=True)}, run),
                "run",
                {},
            )
        moved = travel(s, kind="free", friction=0.05)
        yield f"linear, free / {name}", scenario(s, {"load": load(s, "mass", moved)}, run), "run", {}
        if s.family != "stiff":
            continue
        axles = {"kind": "axles", "train": "HSLM-A1", "on": s.on, "travel": {"speed": s.speed, "from": s.start}}
        yield f"sweep / {name}", scenario(s, {"load": axles}, run), "sweep", {}


def variations() -> Iterator[Change]:
    """Return, of every key of the schema and every choice, EACH of the places where it can be changed."""
    found: dict[tuple[str, str], list[Change]] = {}
    for base in BASES:
        for change in changes(base):
            found.setdefault((change.name, change.choice), []).append(change)
    for places in found.values():
        yield from sorted(places, key=lambda change: crc32(change.message.encode()))[:EACH]
