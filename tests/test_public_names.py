"""The public names: all there, all documented, none of them loaded before it is used."""

from __future__ import annotations

import ast
import importlib
import subprocess
import sys
from pathlib import Path

import pytest

import ropewalk
from ropewalk.model import DECLARATIONS

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "docs" / "reference.md"


def run(script: str) -> subprocess.CompletedProcess[str]:
    """Run a script in an interpreter of its own: other tests import what they like."""
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120, check=False)


@pytest.mark.parametrize("name", ropewalk.__all__)
def test_every_public_name_is_there_and_has_a_docstring(name: str) -> None:
    assert getattr(ropewalk, name).__doc__


def test_the_names_are_listed_once_in_order_and_by_dir() -> None:
    assert list(ropewalk.__all__) == sorted(set(ropewalk.__all__))
    assert set(ropewalk.__all__) <= set(dir(ropewalk))


def test_a_name_that_is_not_there_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'simulation'"):
        _ = ropewalk.simulation


def test_type_checkers_see_the_same_names() -> None:
    tree = ast.parse((ROOT / "src" / "ropewalk" / "__init__.py").read_text(encoding="utf-8"))
    blocks = [node for node in tree.body if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"]
    imports = [node for block in blocks for node in block.body if isinstance(node, ast.ImportFrom)]
    seen = {alias.asname or alias.name for node in imports for alias in node.names} - {"*"}
    assert sorted(seen | set(DECLARATIONS)) == ropewalk.__all__


def test_the_reference_page_is_up_to_date(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(ROOT / "docs")
    make_reference = importlib.import_module("make_reference")
    assert PAGE.read_text(encoding="utf-8") == make_reference.page(), "run  python docs/make_reference.py"
    closed_forms = PAGE.with_name("theory.md").read_text(encoding="utf-8")
    assert closed_forms == make_reference.theory_page(), "run  python docs/make_reference.py"


def test_importing_the_package_loads_nothing_but_python_itself() -> None:
    script = (
        "import sys; before = set(sys.modules); import ropewalk; "
        "new = {name.partition('.')[0] for name in set(sys.modules) - before}; "
        "print(sorted(new - set(sys.stdlib_module_names) - {'ropewalk'}))"
    )
    assert run(script).stdout == "[]\n"


def test_simulate_stays_the_function_whatever_is_imported_first() -> None:
    # `ropewalk.simulate` is a module, too, and Python sets a module in its package when it is imported.
    script = (
        "import ropewalk.simulate; from ropewalk.simulate import simulate; "
        "import ropewalk; assert ropewalk.simulate is simulate; "
        "from ropewalk import simulate as again; assert again is simulate; print('fine')"
    )
    done = run(script)
    assert done.stdout == "fine\n", done.stderr
