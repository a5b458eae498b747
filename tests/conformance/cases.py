"""The cases of the matrix: tables of short runs, each a scenario and a tool that it is given to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from .loads import KINDS, load, travel
from .structures import BY_NAME, DOWN, STRUCTURES, Structure, Tree


@dataclass(frozen=True)
class Case:
    """One question to the program: a scenario, and what is done with it."""

    table: str
    row: str
    structure: str
    load: str
    scenario: Tree
    tool: str = "run"
    options: Tree = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Unique, and readable."""
        return " / ".join(part for part in (self.table, self.row, self.structure, self.load) if part)


def dynamic(s: Structure, **more: Any) -> Tree:
    """A short motion."""
    return {"kind": "dynamic", "until": s.until, "every": 0.01, **s.run, **more}


def scenario(s: Structure, loads: Tree | None = None, run: Tree | None = None, **changes: Any) -> Tree:
    """A structure with loads and a run."""
    return {**s.parts, **changes, "loads": loads or {}, "run": run or dynamic(s)}


def _one(tree: Tree) -> Tree:
    return {"load": tree}


# -- Loads -------------------------------------------------------------------------------------------------------


def loads() -> Iterator[Case]:
    """Every kind of load on every structure, travelling as prescribed along the material."""
    for s in STRUCTURES:
        yield Case("loads", "none", s.name, "none", scenario(s))
        for kind in KINDS:
            yield Case("loads", "one", s.name, kind, scenario(s, _one(load(s, kind))))
        for row, pair in PAIRS.items():
            trees = {
                f"load {k}": load(s, kind, travel(s, **{"from": s.start + k * 0.13 * s.length}))
                for k, kind in enumerate(pair)
            }
            yield Case("loads", row, s.name, " and ".join(pair), scenario(s, trees))


def crab(s: Structure, moved: Tree) -> Tree:
    """A trolley that the second rope carries, too."""
    return load(s, "trolley", moved, also_on=["second"])


PAIRS = {"two alike": ("mass", "mass"), "two": ("force", "mass"), "two bodies": ("oscillator", "vehicle")}


CORE = [
    s for s in STRUCTURES
    if not s.twin and s.name not in ("damped", "piola", "polynomial", "tabulated", "inclined-stiff", "beam-damped",
                                     "bed", "gale", "awning", "slack-stiff-linearised", "staggered", "track", "cut",
                                     "hysteresis", "failing", "two-ropes")
]  # fmt: skip
"""Structures for tables of which the others would tell nothing new."""


# -- Travel ------------------------------------------------------------------------------------------------------


def ways(s: Structure) -> Iterator[tuple[str, Tree]]:
    """Ways to travel, by name."""
    for measured in ("material", "slip", "arc", "horizontal"):
        yield measured, travel(s, measured=measured)
    middle = s.start + 0.3 * s.length
    for measured in ("material", "horizontal"):
        yield f"backwards, {measured}", travel(s, speed=-s.speed, measured=measured, **{"from": middle})
    yield "standing", travel(s, speed=0.0)
    table = {"time": [0.0, 0.5 * s.until, s.until], "value": [s.speed, 1.1 * s.speed, 0.9 * s.speed]}
    yield "speed in a table", travel(s, speed=table)
    yield "from the start", travel(s, **{"from": 0.0})
    late = s.length - 0.4 * s.speed * s.until
    yield "leaves at the end", travel(s, at_end="leave", **{"from": late})
    yield "stays at the end", travel(s, at_end="stay", **{"from": late})
    yield "comes to the end", travel(s, at_end="refuse", **{"from": late})
    yield "free", travel(s, kind="free")
    yield "free with friction", travel(s, kind="free", friction=0.1, rolling=0.01)
    driver = {"speed": 1.5 * s.speed, "force": 2.0 * s.mass * DOWN}
    yield "free with driver", travel(s, kind="free", driver=driver)
    yield "free with brake", travel(s, kind="free", brake={"force": s.mass * DOWN, "within": s.length, "at": "both"})
    within = {"within": s.length, "at": "both"}
    eddy = {"rate": 2.0 * s.mass * DOWN / s.speed, "force": s.mass * DOWN, **within}
    yield "free with eddy-current brake", travel(s, kind="free", brake=eddy)
    yield "free with sprung brake", travel(s, kind="free", brake={"stiffness": s.mass * DOWN / s.length, **within})
    yield "free, leaves", travel(s, kind="free", at_end="leave", **{"from": late})


TRAVELLING = ("force", "mass", "oscillator", "trolley", "vehicle", "matrices")


def travels() -> Iterator[Case]:
    """Every way to travel for everything that travels, on every structure; of crabs, that on two ropes."""
    for s in CORE:
        kinds = ("pantograph", "mass") if s.family == "overhead" else TRAVELLING
        for way, tree in ways(s):
            for kind in kinds:
                if way.startswith("free") and kind in ("force", "vehicle", "matrices", "pantograph"):
                    continue  # no such key in the schema
                if kind == "pantograph" and ("measured" in tree or tree.get("at_end") == "stay"):
                    continue
                yield Case("travel", way, s.name, kind, scenario(s, _one(load(s, kind, tree))))
    for way, tree in ways(ropes := BY_NAME["two-ropes"]):
        along = tree if "kind" in tree else {"measured": "horizontal", **tree}
        run = dynamic(ropes, start={"with_loads": True})  # set down, ropes that hang differently press differently
        yield Case("travel", way, ropes.name, "crab", scenario(ropes, _one(crab(ropes, along)), run))


# -- Supports ----------------------------------------------------------------------------------------------------


def supports(s: Structure) -> Iterator[tuple[str, Tree]]:
    """Supports, by name, with numbers that go with the structure."""
    line = s.line()
    k = 50.0 * s.mass * DOWN  # N/m: the weight of a load moves it by 20 mm
    pull = 1e4 if "tension" in line else 0.5 * DOWN * line["mass"] * s.length
    yield "clamped", {"kind": "fixed", "clamped": True}
    yield "elastic", {"kind": "elastic", "stiffness": 10.0 * k}
    yield "elastic, two stiffnesses", {"kind": "elastic", "stiffness": [20.0 * k, 5.0 * k]}
    yield "elastic, damped, with mass", {
        "kind": "elastic", "stiffness": 10.0 * k, "damping": 0.02 * k, "mass": 0.2 * s.mass,
    }  # fmt: skip
    table = {"time": [0.0, 0.5 * s.until, s.until], "value": [[0.0, 0.0], [0.0, 0.02], [0.0, 0.0]]}
    yield "elastic, shaken", {"kind": "elastic", "stiffness": 10.0 * k, "displacement": table}
    yield "moving", {"kind": "moving", "displacement": table}
    yield "moved", {"kind": "moving", "displacement": [0.0, 0.05]}
    yield "counterweight", {"kind": "guided", "along": [1.0, 0.0], "force": pull}
    yield "counterweight with mass", {
        "kind": "guided", "along": [1.0, 0.0], "force": pull, "mass": 0.2 * s.mass, "damping": 0.02 * k,
    }  # fmt: skip
    yield "winch", {
        "kind": "guided", "along": [1.0, 0.0], "force": pull, "damping": 0.02 * k,
        "winch": {"speed_limit": 0.5, "dead_band": 0.01 * pull},
    }  # fmt: skip
    yield "slider on a spring", {"kind": "guided", "along": [0.0, 1.0], "stiffness": 10.0 * k}
    yield "inclined slider on a spring", {"kind": "guided", "along": [1.0, 1.0], "stiffness": 10.0 * k}


def supported() -> Iterator[Case]:
    """Every support at the end of every line, without and with loads, at rest and in motion."""
    for s in CORE:
        if "lines" not in s.parts or s.name == "ring":
            continue
        for name, tree in supports(s):
            for row, changes in _supported(s, name, tree):
                parts = s.with_line(**changes)
                for kind in ("none", "force", "mass", "vehicle"):
                    found = _one(load(s, kind)) if kind != "none" else {}
                    yield Case("supports", row, s.name, kind, scenario(s, found, lines=parts["lines"]))
                rest = {"kind": "equilibrium"}
                yield Case("supports", row, s.name, "at rest", scenario(s, None, rest, lines=parts["lines"]))


def edged() -> Iterator[Case]:
    """Every edge of every net and membrane."""
    edges = {
        "clamped edge": {"kind": "clamped"},
        "soft edge": {"kind": "soft", "stiffness": "50 kN/m^2"},
        "soft edge, damped": {"kind": "soft", "stiffness": "50 kN/m^2", "damping": "50 N*s/m^2"},
        "edge cable": {"kind": "cable", "axial_stiffness": "2 MN", "mass": 0.5, "tension": "3 kN"},
    }
    for s in STRUCTURES:
        for row, edge in edges.items() if s.is_surface else ():
            nets = {s.on: {**s.parts["nets"][s.on], "edge": edge}}
            for kind in ("none", "force", "mass"):
                found = _one(load(s, kind)) if kind != "none" else {}
                yield Case("edges", row, s.name, kind, scenario(s, found, nets=nets))
            yield Case("edges", row, s.name, "at rest", scenario(s, None, {"kind": "equilibrium"}, nets=nets))


def _supported(s: Structure, name: str, tree: Tree) -> Iterator[tuple[str, Tree]]:
    """At the end; a counterweight or a winch sets the tension, beside a length or, to be refused, beside a tension."""
    line = s.line()
    if name.startswith(("counterweight", "winch")) and "tension" in line:
        length = 20.0 * (1.0 - 0.01)
        yield name, {"end_support": tree, "tension": None, "length": length}
        if name == "counterweight":
            yield "counterweight and tension", {"end_support": tree}
    else:
        yield name, {"end_support": tree}
    if name in ("elastic", "moving"):
        yield f"{name}, at the start", {"start_support": tree}


# -- Runs --------------------------------------------------------------------------------------------------------


def runs(s: Structure) -> Iterator[tuple[str, Tree]]:
    """Kinds and ways of runs, by name."""
    yield "equilibrium", {"kind": "equilibrium"}
    yield "quasi-static", {"kind": "quasistatic", "positions": 5}
    yield "quasi-static, turns", {"kind": "quasistatic", "positions": 5, "turn": "5 deg"}
    yield "linear theory", {"kind": "linear", "until": s.until, "every": 0.01}
    yield "linear theory, modes", {"kind": "linear", "until": s.until, "every": 0.01, "modes": 20}
    if not s.run:
        yield "linearised", dynamic(s, geometry="linearised")
    for method in ("explicit", "verlet", "rkn6", "implicit"):
        yield method, dynamic(s, method=method)
    yield "rests with loads", dynamic(s, start={"with_loads": True})
    yield "from a mode", dynamic(s, start={"kind": "mode", "amplitude": 0.02})
    yield "whirls", dynamic(s, start={"kind": "mode", "amplitude": 0.02, "whirl": True})
    yield "axial inertia", dynamic(s, axial_inertia=4.0)
    yield "window", dynamic(s, window=8.0, **({} if s.run else {"geometry": "linearised"}))
    if s.family == "overhead" and not s.run:
        yield "window, all geometry", dynamic(s, window=20.0)


def gusts(s: Structure) -> Iterator[tuple[str, Tree]]:
    """Winds that change, by name."""
    if "wind" in s.parts:
        speed = s.parts["wind"]["speed"]
        for row, begin in (("linear theory, gusts", 0.5 * speed), ("linear theory, no mean wind", -speed)):
            yield row, {**s.parts["wind"], "speed": {"time": [0.0, s.until], "value": [begin, speed]}}


RUNNING = ("none", "force", "mass", "vehicle")


def asked() -> Iterator[Case]:
    """Every kind of run of every structure, without and with loads."""
    for s in (*CORE, BY_NAME["track"], BY_NAME["hysteresis"], BY_NAME["failing"]):
        kinds = ("none", "pantograph") if s.family == "overhead" else RUNNING
        for row, run in runs(s):
            for kind in kinds:
                if kind == "none" and run["kind"] == "quasistatic":
                    continue  # quasi-static runs are those of loads
                found = _one(load(s, kind)) if kind != "none" else {}
                yield Case("runs", row, s.name, kind, scenario(s, found, run))
        for row, wind in gusts(s):
            for kind in kinds:
                found = _one(load(s, kind)) if kind != "none" else {}
                yield Case("runs", row, s.name, kind, scenario(s, found, dict(runs(s))["linear theory"], wind=wind))
        for kind in kinds:
            found = _one(load(s, kind)) if kind != "none" else {}
            yield Case("runs", "without gravity", s.name, kind, scenario(s, found, gravity=0.0))


# -- Contacts ----------------------------------------------------------------------------------------------------


def contacts(s: Structure) -> Iterator[tuple[str, str, Tree, Tree]]:
    """Row, kind of load, its travel, its keys."""
    free, way = travel(s, kind="free", friction=0.1), travel(s)
    off = {"lift_off": True}
    for contact in ("frictionless", "coulomb", "dragged"):
        own = {"contact": contact} | ({"friction": 0.3} if contact != "frictionless" else {})
        yield contact, "force", way, own
    yield "is friction enough?", "force", way, {"friction": 0.3}
    yield "frictionless", "mass", way, {"contact": "frictionless"}
    yield "block friction", "force", way, {"contact": "dragged", "friction": 0.3, "friction_model": "block"}
    yield "block friction", "mass", {**free, "friction_model": "block"}, {}
    for kind in ("mass", "oscillator", "trolley", "vehicle", "matrices"):
        yield "may lift off", kind, way, off
        yield "may lift off below", kind, way, {**off, "side": "below"}
    up = 3.0 * s.mass * DOWN
    thrown = {"time": [0.0, 0.3 * s.until, 0.4 * s.until, 0.4 * s.until], "value": [[0, 0], [0, up], [0, up], [0, 0]]}
    yield "is thrown off", "mass", way, {**off, "force": thrown}
    yield "is thrown off, free", "mass", free, {**off, "force": thrown}
    soft = {"contact_stiffness": 500.0 * s.mass * DOWN}
    yield "soft contact", "oscillator", way, {**off, **soft}


def touching() -> Iterator[Case]:
    """Every kind of contact on every structure, in motion and, of forces, quasi-static."""
    slow = {"kind": "quasistatic", "positions": 5}
    for s in CORE:
        if s.family == "overhead":
            continue
        for row, kind, way, own in contacts(s):
            tree = _one(load(s, kind, way, **own))
            yield Case("contacts", row, s.name, kind, scenario(s, tree))
            if kind == "force":
                yield Case("contacts", f"{row}, slowly", s.name, kind, scenario(s, tree, slow))


# -- Tools -------------------------------------------------------------------------------------------------------


def tools() -> Iterator[Case]:
    """Every tool on every structure, with a force, a mass and a vehicle."""
    for s in CORE:
        kinds = ("pantograph",) if s.family == "overhead" else ("force", "mass", "vehicle")
        for kind in kinds:
            tree = scenario(s, _one(load(s, kind)))
            for tool in ("feedback", "compare", "adequacy", "export load", "export line", "go on", "show"):
                if tool in ("export line", "adequacy") and kind == "vehicle":
                    continue
                yield Case("tools", tool, s.name, kind, tree, tool)
            yield Case("tools", "spectrum with loads", s.name, kind, tree, "spectrum", {"at": s.until})
        yield Case("tools", "spectrum", s.name, "none", scenario(s), "spectrum")


def cases() -> list[Case]:
    """All cases, in the order of the tables."""
    return [case for table in TABLES.values() for case in table()]


TABLES = {
    "loads": loads, "travel": travels, "supports": supported, "edges": edged, "runs": asked, "contacts": touching,
    "tools": tools,
}  # fmt: skip
