"""The plan of the house, held by a machine: imports run downwards only, files stay small, the package is light."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path

import pytest

import ropewalk

HOUSE = Path(ropewalk.__file__).parent
# From the ground up; a module imports from its own layer and from those before it.
LAYERS = (
    ("errors", "units", "hooks", "importing", "interrupts", "permission", "renamed"), ("checkpoint",), ("model",),
    ("theory",), ("mechanics", "engine"), ("external",),
    ("controllers",), ("results",), ("solve",), ("linear",), ("wires",), ("overhead",), ("system",),
    ("capabilities",), ("chains", "wiring"), ("meshes",), ("impact", "start_positions"), ("simulate",), ("effort",),
    ("rigid_overhead_lines",), ("decouple",),
    ("coupling",), ("scenario",), ("resuming",), ("cli",), ("__main__",),
)  # fmt: skip
# Of the system, in the same way; what works is asked without any of them.
SYSTEM = (
    ("capabilities", "several_lines", "lines_over_sheaves", "methods"), ("elements",), ("contact",), ("loads",),
    ("assembling",), ("reporting",), ("equilibrium",), ("dynamics",), ("small_motion",),
)  # fmt: skip
# Extensions above the layers may look at everything; one not named here must be given its place first.
ABOVE = ("calc", "compare", "paper", "sweeps", "designs", "cosim", "studio", "warming", "validation")
# Who may set closed forms beside the discrete solution.
USES_THEORY = ("theory", "linear", "calc", "compare", "paper", "validation")
LONGEST_FILE = 500
# Who computes.
SOLVERS = ("solve", "linear", "wires", "overhead", "chains", "wiring", "simulate")


def layer(name: str) -> int:
    for level, members in enumerate(LAYERS):
        if name in members:
            return level
    assert name in ABOVE, f"{name} has no layer: add it to LAYERS or ABOVE"
    return len(LAYERS)


def modules() -> list[Path]:
    return sorted(path for path in HOUSE.rglob("*.py") if path != HOUSE / "__init__.py")


def part_of(path: Path) -> str:
    return path.relative_to(HOUSE).parts[0].removesuffix(".py")


def imported_parts(path: Path, source: str | None = None) -> Iterator[tuple[int, str]]:
    """Line and top-level part of every import from the package, wherever it stands in the module."""
    package = ["ropewalk", *path.relative_to(HOUSE).parts[:-1]]
    for node in ast.walk(ast.parse(source if source is not None else path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) + 1 - node.level] if node.level else []
            origin = ".".join([*base, *([node.module] if node.module else [])])
            names = [f"{origin}.{alias.name}" for alias in node.names] if origin == "ropewalk" else [origin]
        else:
            continue
        for name in names:
            first, *rest = name.split(".")
            if first == "ropewalk" and rest and not rest[0].startswith("__version"):
                yield node.lineno, rest[0]


def file_of(name: str) -> Path:
    """File of a module or package of the package, which need not exist."""
    place = HOUSE.joinpath(*name.split("."))
    return place / "__init__.py" if place.is_dir() else place.with_suffix(".py")


@cache
def imported_modules(path: Path) -> set[str]:
    """Names within the package of all modules and packages of it that are imported, wherever in the module."""
    found = set[str]()
    package = ["ropewalk", *path.relative_to(HOUSE).parts[:-1]]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) + 1 - node.level] if node.level else []
            origin = ".".join([*base, *([node.module] if node.module else [])])
            names = [origin, *(f"{origin}.{alias.name}" for alias in node.names)]
        else:
            continue
        for name in names:
            if not name.startswith("ropewalk."):
                continue
            parts = name.split(".")[1:]
            for depth in range(1, len(parts) + 1):  # packages on the way are executed, too
                inner = ".".join(parts[:depth])
                if file_of(inner).is_file():
                    found.add(inner)
    return found


def upward(path: Path, source: str | None = None) -> list[str]:
    own = part_of(path)
    found = []
    for line, other in imported_parts(path, source):
        if layer(other) > layer(own):
            found.append(f"{path.relative_to(HOUSE)}:{line} imports {other}")
        elif other == "theory" and own not in USES_THEORY:
            found.append(f"{path.relative_to(HOUSE)}:{line} uses theory, which only checks")
        elif own == "theory" and other != "theory":
            found.append(f"{path.relative_to(HOUSE)}:{line} imports {other}: theory stands alone")
    return found


def reached_from(start: Path) -> set[str]:
    """All modules of the package that one imports, directly or through others, wherever the import stands."""
    seen, ahead = set[str](), [start]
    while ahead:
        path = ahead.pop()
        for name in imported_modules(path):
            if name not in seen:
                seen.add(name)
                ahead.append(file_of(name))
    return seen


MACHINE = ("checkpoint", "model", "mechanics", "external", "controllers", "results", "solve", "wires", "overhead",
           "system", "chains", "wiring")  # fmt: skip


@pytest.mark.parametrize("part", MACHINE)
def test_the_machine_knows_no_theory_through_others_either(part: str) -> None:
    """What checks a result must not have made it."""
    found = {name for path in modules() if part_of(path) == part for name in reached_from(path)}
    assert found or part == "checkpoint"
    assert {name for name in found if name.split(".")[0] in ("theory", "linear")} == set()


def test_what_the_engines_support_is_known_without_theory() -> None:
    """The linear theory declares what it supports beside the engines, apart from how it computes."""
    found = reached_from(HOUSE / "capabilities.py")
    assert {name for name in found if name.split(".")[0] in ("theory", "linear")} == {"linear", "linear.capabilities"}


def test_packages_on_the_way_are_followed() -> None:
    """`from ropewalk.results import open_result` executes the package, and what that imports."""
    found = reached_from(HOUSE / "resuming.py")
    assert {"results", "results.files", "results.recorder"} <= found


REST = """
import sys
from ropewalk.model import Scenario
from ropewalk.simulate import simulate
line = {"start": [0, 0], "end": [9, 0], "length": 10, "mass": 1, "axial_stiffness": 1e5, "elements": 4}
joined = {"end": [5, -2], "length": 5.5, "end_support": {"kind": "joined", "to": "knot"}}
other = line | joined | {"start": [9, 0]}
for more in ({"lines": {"a": line}}, {"lines": {"a": line | {"bending_stiffness": 1.0}}},
             {"joints": {"knot": {}}, "lines": {"a": line | joined, "b": other}}):
    assert simulate(Scenario.model_validate(more | {"run": {"kind": "equilibrium"}})).attrs["outcome"] == "completed"
assert not [name for name in sys.modules if name.startswith("ropewalk.theory")]
"""
MOTION = """
import sys
from ropewalk.scenario import load
from ropewalk.simulate import simulate
begun = load(sys.argv[1])
simulate(begun.model_copy(update={"run": begun.run.model_copy(update={"until": 1e-4, "every": 1e-4})}))
print(*sys.modules)
"""
EXAMPLES = HOUSE.parents[1] / "examples"


@pytest.mark.parametrize(
    ("example", "spared"),
    [
        ("moving-force", ("theory", "wires.", "overhead")),
        ("simple-ac-275", ("theory", "chains")),
    ],
)
def test_a_motion_imports_what_it_uses(example: str, spared: tuple[str, ...]) -> None:
    """In plain Python, where nothing is compiled."""
    run = subprocess.run(
        [sys.executable, "-c", MOTION, str(EXAMPLES / f"{example}.yaml")], capture_output=True, text=True, timeout=600,
        check=False, env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    loaded = [name for name in run.stdout.split() if not name.endswith(".capabilities")]
    assert "ropewalk.solve" in loaded
    assert not [
        name for name in loaded if name.removeprefix("ropewalk.").startswith(spared) and name[:9] == "ropewalk."
    ]
    if example == "moving-force":  # whose length is given
        assert "scipy.optimize" not in loaded


def test_no_engine_loads_the_theory_as_it_runs() -> None:
    run = subprocess.run([sys.executable, "-c", REST], capture_output=True, text=True, timeout=300, check=False)
    assert run.returncode == 0, run.stderr


def test_results_know_no_solver_through_others_either() -> None:
    """What is shown of a run does not depend on who computed it."""
    found = {name for path in modules() if part_of(path) == "results" for name in reached_from(path)}
    assert "results.frame" in found
    assert {name for name in found if name.split(".")[0] in SOLVERS} == set()


def test_imports_run_downwards_only() -> None:
    assert [problem for path in modules() for problem in upward(path)] == []


def test_within_the_system_too() -> None:
    floors = {name: level for level, members in enumerate(SYSTEM) for name in members}
    found = [
        f"{path.relative_to(HOUSE)} imports {name}"
        for path in modules()
        if part_of(path) == "system" and (own := path.relative_to(HOUSE).parts[1].removesuffix(".py")) != "__init__"
        for name in imported_modules(path)
        if name.startswith("system.") and floors[name.split(".")[1]] > floors[own]
    ]
    assert found == []


# What draws itself when it is asked to knows its picture, which knows it.
DRAW_THEMSELVES = {("compare.adequacy", "compare.map_figure"), ("compare.result", "compare.figure")}


def circles(imports: dict[str, set[str]]) -> list[set[str]]:
    """Modules that reach themselves through others, in sets that reach each other."""
    reached = {name: set(found) for name, found in imports.items()}
    for middle in imports:
        for found in reached.values():
            if middle in found:
                found |= reached[middle]
    return [{other for other in reached[name] if name in reached.get(other, ())} for name in imports
            if name in reached[name]]  # fmt: skip


def test_no_files_import_each_other() -> None:
    """Not for types or lazily either."""
    packages = {path.parent for path in HOUSE.rglob("__init__.py")}
    names = {path: ".".join(path.relative_to(HOUSE).with_suffix("").parts) for path in modules()
             if path.parent in packages and path.name != "__init__.py"}  # fmt: skip
    imports = {name: imported_modules(path) & set(names.values()) for path, name in names.items()}
    for one, other in DRAW_THEMSELVES:
        assert other in imports[one]
        imports[one].discard(other)
    assert circles(imports) == []


def test_a_circle_is_seen() -> None:
    found = circles({"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": {"a"}})
    assert found == [{"b", "c"}, {"b", "c"}]


@pytest.mark.parametrize(
    ("where", "source"),
    [
        ("mechanics/law.py", "from ropewalk.solve.banded import factorise"),
        ("mechanics/law.py", "def f():\n    import ropewalk.simulate"),
        ("mechanics/law.py", "from ..solve import banded"),
        ("model/line.py", "from ropewalk import simulate"),
        ("theory/rope.py", "from ropewalk.errors import RopewalkError"),
        ("solve/start.py", "from ropewalk.theory.rope import catenary"),
        ("results/frame.py", "from ropewalk.scenario import load"),
        ("results/frame.py", "from ropewalk.solve.start import Setting"),
    ],
)
def test_an_upward_import_is_seen(where: str, source: str) -> None:
    assert len(upward(HOUSE / where, source)) == 1


@pytest.mark.parametrize(
    ("where", "source"),
    [
        ("solve/start.py", "from ropewalk.mechanics.law import strain\nimport numpy"),
        ("theory/rope.py", "from ropewalk.theory import string\nfrom . import chain"),
        ("results/files.py", "from ropewalk import __version__\nfrom .frame import Frame"),
    ],
)
def test_a_downward_import_is_no_problem(where: str, source: str) -> None:
    assert upward(HOUSE / where, source) == []


def test_no_file_has_grown_past_its_noun() -> None:
    lengths = {path.relative_to(HOUSE).as_posix(): len(path.read_text("utf-8").splitlines()) for path in modules()}
    assert {name: count for name, count in lengths.items() if count > LONGEST_FILE} == {}


def test_the_package_and_its_declarations_are_light() -> None:
    script = """
import sys
before = set(sys.modules)
import ropewalk
loaded = set(sys.modules) - before
heavy = {"numba", "matplotlib", "xarray", "scipy", "netCDF4", "pint"} & loaded
assert not heavy, heavy
import ropewalk.model
heavy = {"numba", "matplotlib", "xarray", "scipy", "netCDF4", "pint"} & (set(sys.modules) - before)
assert not heavy, heavy
"""
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False)
    assert run.returncode == 0, run.stderr


def test_the_storeys_are_in_the_order_of_the_plan() -> None:
    levels = [layer(name) for name in ("errors", "model", "theory", "mechanics", "results", "solve", "simulate",
                                        "scenario", "cli", "studio")]  # fmt: skip
    assert all(a < b for a, b in pairwise(levels))
