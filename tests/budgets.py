"""Measure the size of the project by part, print it against the ceilings of budgets.yaml, and lower these."""

from __future__ import annotations

import ast
import re
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML

ROOT = Path(__file__).parent.parent
FILE = Path(__file__).with_name("budgets.yaml")
PACKAGE = ROOT / "src" / "ropewalk"

PARTS = {
    "engine": {"mechanics", "solve", "chains", "wires", "system", "linear", "overhead", "engine", "wiring.py",
               "capabilities.py", "checkpoint.py", "rigid_overhead_lines.py", "warming.py", "impact.py"},
    "external_and_cosim": {"external", "cosim", "controllers", "foreign"},
    "sweeps_and_designs": {"sweeps", "designs"},
    "compare": {"compare", "meshes", "coupling.py", "decouple.py"},
    "model": {"model"}, "results": {"results"}, "theory": {"theory"},
}  # fmt: skip
"""Folders and files of the package by part; all others are `other`."""
LONG, MANY = 34, 8  # lines and arguments of a function
COMPILED = (".cpp", ".hpp", ".h", ".inl", ".c", ".def")
PAGE = (".ts", ".tsx", ".css")


def python() -> list[Path]:
    """Return the Python files that the wheel holds or the build needs."""
    folders = (PACKAGE, ROOT / "build_core", ROOT / "examples")
    return sorted(path for folder in folders for path in folder.rglob("*.py"))


def compiled() -> list[Path]:
    """Return the files of the compiled core."""
    return sorted(path for path in (ROOT / "src").rglob("*") if path.suffix in COMPILED)


def part_of(path: Path) -> str:
    """Return the part that a file belongs to; the build of the core belongs to the engine."""
    if not path.is_relative_to(PACKAGE):
        return "other" if path.is_relative_to(ROOT / "examples") else "engine"
    first = path.relative_to(PACKAGE).parts[0]
    return next((part for part, members in PARTS.items() if first in members), "other")


def lines(paths: Iterable[Path]) -> int:
    """Return the number of lines of files."""
    return sum(len(path.read_text(encoding="utf-8").splitlines()) for path in paths)


def measured() -> dict[str, float]:
    """Return the present value of every budget."""
    found = Counter[str](dict.fromkeys((*PARTS, "other"), 0))
    for path in (*python(), *compiled()):
        found[part_of(path)] += lines([path])
    return {
        **found,
        "package": found.total(),
        "compiled": lines(compiled()),
        "page": lines(path for path in (ROOT / "studio" / "src").rglob("*") if path.suffix in PAGE),
        "tests": lines((ROOT / "tests").rglob("*.py")),
        **code(ast.parse(path.read_text(encoding="utf-8")) for path in python()),
        "words": sum(len(path.read_text(encoding="utf-8").split()) for path in pages()),
    }


def pages() -> Iterator[Path]:
    """Return the pages of the documentation, without those that `make docs` makes."""
    yield from (path for path in (ROOT / "docs").rglob("*.md") if "gallery" not in path.parts)
    yield from (ROOT / name for name in ("README.md", "CHANGELOG.md"))


def code(trees: Iterable[ast.Module]) -> dict[str, float]:
    """Return the number of statements, of long functions and of those with many arguments, and the coverage."""
    count = Counter[str]()
    for node in (node for tree in trees for node in ast.walk(tree)):
        count["statements"] += isinstance(node, ast.stmt)
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            continue
        if not node.name.startswith("_"):
            count["public"] += 1
            count["documented"] += ast.get_docstring(node) is not None
        if not isinstance(node, ast.ClassDef):
            count["long"] += (node.end_lineno or 0) - node.lineno + 1 > LONG
            count["many"] += len([*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]) > MANY
    return {
        "statements": count["statements"],
        f"functions_of_more_than_{LONG}_lines": count["long"],
        f"functions_of_more_than_{MANY}_arguments": count["many"],
        "docstring_coverage": round(count["documented"] / count["public"], 4),
    }


def budgets(file: Path = FILE) -> tuple[str, dict[str, dict[str, Any]]]:
    """Return the stage that is open and the budgets by name."""
    tree = YAML(typ="safe").load(file)
    return tree["stage"], {**tree["lines"], **tree["code"], **tree["documentation"]}


def limit(budget: dict[str, Any], stage: str) -> float:
    """Return the ceiling of a budget in a stage; a floor is negative."""
    if "floor" in budget:
        return -float(budget["floor"])
    rise = budget.get("rise", 0) if stage in budget.get("rises_in", ()) else 0
    return float(next(budget[key] for key in ("ceiling", "at_most", stage) if key in budget)) + rise


def exceeded(values: dict[str, float], file: Path = FILE) -> list[str]:
    """Return a line for every budget that is exceeded, has no value, or has no entry in the file."""
    stage, own = budgets(file)
    found = [f"{name}: {values[name]:g}, and {FILE.name} has no budget" for name in values.keys() - own.keys()]
    for name, budget in own.items():
        bound, value = limit(budget, stage), values.get(name, float("nan"))
        if not (-value if bound < 0 else value) <= bound:
            found.append(f"{name}: {value:g}, {'at least' if bound < 0 else 'at most'} {abs(bound):g}")
    return found


def lowered(text: str, values: dict[str, float]) -> str:
    """Return the text of the file with ceilings above the present values, and floors below them, replaced by these."""

    def replaced(match: re.Match[str]) -> str:
        name, head, bound = match["name"], match["head"], float(match["bound"])
        value = values.get(name, bound)
        best = max(bound, value) if head.endswith("floor: ") else min(bound, value)
        return f"{match['start']}{head}{best:.4f}" if head.endswith("floor: ") else f"{match['start']}{head}{best:.0f}"

    pattern = r"(?m)^(?P<start>  (?P<name>\w+): )(?P<head>\{(?:ceiling|floor): )(?P<bound>[\d.]+)"
    return re.sub(pattern, replaced, text)


def main() -> None:
    """Print the table; with `--lower` rewrite the file before."""
    values = measured()
    if "--lower" in sys.argv[1:]:
        FILE.write_text(lowered(FILE.read_text(encoding="utf-8"), values), encoding="utf-8")
    stage, own = budgets()
    print(f"stage: {stage}\n{'':36} {'now':>9} {'limit':>9} {'goal':>9}")
    for name, budget in own.items():
        print(f"{name:36} {values[name]:9g} {abs(limit(budget, stage)):9g} {budget['goal']:9g}")
    print("\n".join(exceeded(values)))


if __name__ == "__main__":
    main()
