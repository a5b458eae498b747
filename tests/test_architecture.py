"""The plan of the house, held by a machine: imports run downwards only, files stay small, the package is light."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

import ropewalk

HOUSE = Path(ropewalk.__file__).parent
# From the ground up; a module imports from its own storey and from those before it.
STOREYS = (("errors", "units", "hooks"), ("checkpoint",), ("model",), ("theory",), ("mechanics",), ("foreign",),
           ("results",), ("solve",), ("linear",), ("wires",), ("overhead",), ("webs",), ("system",), ("capabilities",),
           ("chains", "wiring"), ("simulate",), ("decouple",), ("coupling",), ("scenario",), ("resuming",),
           ("console",), ("cli", "__main__"))  # fmt: skip
# Wings above the house may look at everything; a wing not named here must be given its place first.
ABOVE = ("compare", "paper", "sweep", "cosim", "studio")
# Who may set closed forms beside the discrete solution.
USES_THEORY = ("theory", "linear", "compare", "paper")
LONGEST_FILE = 500
# Who computes.
SOLVERS = ("solve", "linear", "wires", "overhead", "webs", "chains", "wiring", "simulate")


def storey(name: str) -> int:
    for level, members in enumerate(STOREYS):
        if name in members:
            return level
    assert name in ABOVE, f"{name} has no place in the house: add it to STOREYS or ABOVE"
    return len(STOREYS)


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


def imported_modules(path: Path) -> Iterator[tuple[int, str]]:
    """Line and name within the package of every module of it that is imported."""
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
            inner = name.removeprefix("ropewalk.")
            if inner != name and HOUSE.joinpath(*inner.split(".")).with_suffix(".py").is_file():
                yield node.lineno, inner


def upward(path: Path, source: str | None = None) -> list[str]:
    own = part_of(path)
    found = []
    for line, other in imported_parts(path, source):
        if storey(other) > storey(own):
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
        for _, name in imported_modules(path):
            if name not in seen:
                seen.add(name)
                ahead.append(HOUSE.joinpath(*name.split(".")).with_suffix(".py"))
    return seen


@pytest.mark.parametrize(
    "part", ["mechanics", "foreign", "results", "solve", "wires", "overhead", "webs", "chains", "wiring"]
)
def test_the_machine_knows_no_theory_through_others_either(part: str) -> None:
    """What checks a result must not have made it."""
    found = {name for path in modules() if part_of(path) == part for name in reached_from(path)}
    assert found or part == "mechanics"
    assert {name for name in found if name.split(".")[0] in ("theory", "linear")} == set()


def test_results_know_no_solver_through_others_either() -> None:
    """What is shown of a run does not depend on who computed it."""
    found = {name for path in modules() if part_of(path) == "results" for name in reached_from(path)}
    assert "results.frame" in found
    assert {name for name in found if name.split(".")[0] in SOLVERS} == set()


def test_imports_run_downwards_only() -> None:
    assert [problem for path in modules() for problem in upward(path)] == []


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
    levels = [storey(name) for name in ("errors", "model", "theory", "mechanics", "results", "solve", "simulate",
                                        "scenario", "cli", "studio")]  # fmt: skip
    assert all(a < b for a, b in pairwise(levels))
