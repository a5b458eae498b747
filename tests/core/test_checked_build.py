"""A build that stops at the first undefined operation and index out of an array: same bits, and nothing stops it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from core_structures import STRUCTURES
from ropewalk.engine import bound, library
from ropewalk.engine.library import variants

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.skipif(shutil.which("g++") is None, reason="the checks are those of GCC")


def built(checks: str, folder: Path) -> Path:
    """Compile the core with the flags of that name."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT / "build_core"))
        compiler = import_module("compiler")
        return compiler.build(ROOT, folder, checks=getattr(compiler, checks))


@pytest.fixture(scope="module")
def checked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return built("CHECKED", tmp_path_factory.mktemp("core"))


def test_elementary_functions_have_the_same_bits(checked: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    angles = np.linspace(-3e6, 3e6, 20_001)
    fast, core = library.elementary("sin", angles), library.library(checked)
    monkeypatch.setattr(library, "library", lambda: core)
    np.testing.assert_array_equal(library.elementary("sin", angles), fast)


@pytest.mark.parametrize("kind", STRUCTURES)
def test_motions_have_the_same_bits(kind: str, checked: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fast, core = STRUCTURES[kind](), library.library(checked)
    fast.advance(100, 1e-4)
    at = fast.linearise()
    monkeypatch.setattr(bound, "library", lambda: core)
    for variant in variants():
        slow = STRUCTURES[kind]()
        slow.advance(100, 1e-4, variant)
        np.testing.assert_array_equal(slow.state.memory, fast.state.memory)
        np.testing.assert_array_equal(slow.linearise().stiffness.data, at.stiffness.data)
        assert slow.potentials() == fast.potentials()


def fuzz(library: Path, **environment: str) -> None:
    """Spoil blocks for two seconds in a process of its own."""
    command = [sys.executable, str(ROOT / "tests" / "core" / "fuzz_interface.py"), str(library), "2", "0"]
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=120, check=False, env=os.environ | environment
    )
    assert done.returncode == 0, done.stderr
    rounds, _, computed = done.stdout.split()[:3]
    assert int(rounds) > int(computed) > 100


@pytest.mark.skipif(sys.platform != "linux", reason="guard pages are those of mprotect")
def test_spoilt_blocks_touch_nothing_outside(checked: Path) -> None:
    fuzz(checked)


@pytest.mark.skipif(sys.platform != "linux", reason="the sanitizers are loaded before Python")
def test_sanitizers_of_addresses_find_nothing(tmp_path: Path) -> None:
    """Arrays on the stack, too, which functions get as pointers."""
    names = [
        subprocess.run(["g++", f"-print-file-name=lib{name}.so"], capture_output=True, text=True, check=True).stdout
        for name in ("asan", "ubsan")
    ]
    if not all(Path(name.strip()).is_absolute() for name in names):
        pytest.skip("this compiler has no sanitizers")
    fuzz(built("ADDRESS", tmp_path), LD_PRELOAD=" ".join(map(str.strip, names)), ASAN_OPTIONS="detect_leaks=0")
