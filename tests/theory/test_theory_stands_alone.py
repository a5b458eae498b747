"""The wing's own rule: it depends on NumPy and SciPy only, so that it can check everything else."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import ropewalk.theory

# The standard library as far as it is used, beside NumPy and SciPy.
ALLOWED = {"collections", "dataclasses", "importlib", "numpy", "scipy", "types", "typing", "warnings"}


def test_theory_imports_nothing_but_numpy_scipy_and_itself() -> None:
    for source in Path(ropewalk.theory.__file__).parent.glob("*.py"):
        for statement in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
            if isinstance(statement, ast.Import):
                names = [alias.name for alias in statement.names]
            elif isinstance(statement, ast.ImportFrom):
                names = [statement.module or "."]
            else:
                continue
            for name in names:
                own = name == "ropewalk.theory" or name.startswith("ropewalk.theory.")
                assert own or name.split(".")[0] in ALLOWED, f"{source.name} imports {name}"


def test_public_names_exist_and_are_listed() -> None:
    for name in ropewalk.theory.__all__:
        module = getattr(ropewalk.theory, name)
        assert module.__all__ == sorted(module.__all__, key=lambda item: (item.islower(), item))
        for public in module.__all__:
            assert hasattr(module, public)


def test_string_loads_no_root_finders_and_the_wing_loads_on_demand() -> None:
    script = """
import sys, ropewalk
before = set(sys.modules)
import ropewalk.theory.string
assert "scipy.optimize" not in set(sys.modules) - before
import ropewalk.theory
assert ropewalk.theory.chain.transverse_frequencies
"""
    subprocess.run([sys.executable, "-c", script], check=True, timeout=60)


def test_unknown_names_are_attribute_errors() -> None:
    with pytest.raises(AttributeError, match="beam_of_light"):
        _ = ropewalk.theory.beam_of_light
