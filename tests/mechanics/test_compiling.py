"""What compiling tells, takes and leaves as it was."""

import gc
import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest

from ropewalk.mechanics.compiled import compiling, is_kept, reach


def made(**names):
    """Functions as if they were of a module of ours, each calling the one before it: first, second."""
    space = {"__name__": "ropewalk.made", **names}
    exec("def first(x):\n    return x + 1.0\ndef second(x):\n    return 2.0 * first(x)", space)
    return space


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
def test_compiling_is_told_and_timed_and_garbage_is_looked_for_as_before(monkeypatch):
    space = made()
    space["first"] = numba.njit(space["first"])
    outer = numba.njit(space["second"])
    message, garbage, kernels, seconds = [], gc.get_threshold(), compiling.kernels, compiling.seconds
    monkeypatch.setattr(compiling, "progress", lambda part, what: message.append((part, what, gc.get_threshold()[0])))
    assert outer(1.0) == 4.0
    assert [(part, what) for part, what, _ in message] == [
        (0.0, "made.second"),
        (0.0, "made.first"),
        (1.0, ""),
    ]  # of what has ended
    assert message[1][2] >= 100_000
    assert gc.get_threshold() == garbage
    assert compiling.kernels == kernels + 2
    assert compiling.seconds > seconds


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
def test_garbage_that_nobody_looks_for_is_left_alone():
    before = gc.get_threshold()
    gc.set_threshold(0)
    try:
        numba.njit(lambda x: x + 2.0)(1.0)
        assert gc.get_threshold()[0] == 0
    finally:
        gc.set_threshold(*before)


def test_what_a_kernel_reaches_is_known_before_it_is_compiled():
    space = made()
    space["first"] = numba.jit(space["first"])
    if not hasattr(space["first"], "py_func"):
        pytest.skip("nothing is compiled")
    assert reach(numba.njit(space["second"])) == {"ropewalk.made.first", "ropewalk.made.second"}


KEPT = """
import sys
import numba
from ropewalk.mechanics import kernel_cache
from ropewalk.mechanics.compiled import is_kept, kernel

@kernel
def double(x):
    return 2 * x

def told():
    return is_kept(double), is_kept(double, lambda kinds: kinds[0] == numba.types.float64)

print(*told())
double(1)
print(*told())
double(1.0)
print(*told())
kernel_cache.processor = lambda: "another"
print(*told())
"""


def test_what_is_kept_is_known_by_its_types_and_for_this_processor_only(tmp_path):
    (tmp_path / "one.py").write_text(KEPT)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache"), "NUMBA_DISABLE_JIT": "0"}
    run = subprocess.run(
        [sys.executable, str(tmp_path / "one.py")], env=environment, capture_output=True, text=True, check=False
    )
    assert run.stdout.splitlines() == ["False False", "True False", "True True", "False False"], run.stderr


def test_plain_python_lacks_nothing():
    assert is_kept(Path)
