"""A build that stops at the first undefined operation runs to its end, with the bits of the fast one."""

from __future__ import annotations

import shutil
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from ropewalk.engine import library

ROOT = Path(__file__).parents[2]


@pytest.mark.skipif(shutil.which("g++") is None, reason="the checks are those of GCC")
def test_checked_build_has_the_same_bits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "build_core"))
    checked = library.library(import_module("compiler").build(ROOT, tmp_path, checked=True))
    angles = np.linspace(-3e6, 3e6, 20_001)
    fast = library.elementary("sin", angles)
    monkeypatch.setattr(library, "library", lambda: checked)
    np.testing.assert_array_equal(library.elementary("sin", angles), fast)
