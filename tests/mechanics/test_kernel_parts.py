"""Kernels as parts of others, made machine code where Python calls them."""

import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest
from numba.core.compiler import Flags
from numba.core.targetconfig import TargetConfig

from ropewalk.mechanics import kernel_parts

PROGRAM = """
import sys
import numba
from ropewalk.mechanics.compiled import inner, kernel

@inner
def root(x):
    if x < 0.0:
        raise ValueError("negative")
    return x**0.5

@inner
def twice(x):
    return 2.0 * root(x)

@kernel
def outer(x):
    return twice(x) + root(x)

@kernel
def other(x):
    return outer(x) + twice(x)

for name in sys.argv[1:]:
    print(globals()[name](4.0), sum(globals()[name].stats.cache_hits.values()), sum(root.stats.cache_hits.values()))
try:
    other(-1.0)
except ValueError as error:
    print(error)
print([next(iter(f.overloads.values())).library.made for f in (root, outer) if f.overloads])
"""


OTHER = "generic" if numba.config.CPU_NAME != "generic" else numba.core.codegen.ll.get_host_cpu_name()


@pytest.fixture
def program(tmp_path):
    (tmp_path / "one.py").write_text(PROGRAM)

    def run(*names: str, **variables: str) -> list[str]:
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache"), **variables}
        command = [sys.executable, str(tmp_path / "one.py"), *names]
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.splitlines()

    return run


def test_what_only_kernels_call_is_no_machine_code(program):
    assert program("outer", "other") == ["6.0 0 0", "10.0 0 0", "negative", "[False, True]"]


def test_what_is_kept_is_found_by_itself_and_as_a_part(program):
    program("outer")
    assert program("outer") == ["6.0 1 0", "negative", "[True]"]  # whole, without its parts
    assert program("other") == ["10.0 1 0", "negative", "[]"]


def test_a_part_that_is_spoilt_is_compiled_anew(program, tmp_path):
    program("outer")
    for file in tmp_path.glob("cache/*/parts/*"):
        file.write_bytes(file.read_bytes()[:-9])
    for file in tmp_path.glob("cache/*/*/one.ou*"):
        file.unlink()
    for file in tmp_path.glob("cache/*/*/one.oth*"):
        file.unlink()
    assert program("outer", "other")[:3] == ["6.0 0 0", "10.0 0 0", "negative"]


def test_of_what_is_kept_for_another_processor_only_machine_code_is_made(program, tmp_path):
    program("outer")
    here = set(tmp_path.glob("cache/*/*/one.outer*.nbc"))
    assert program("outer", NUMBA_CPU_NAME=OTHER) == ["6.0 1 0", "negative", "[True]"]
    (there,) = set(tmp_path.glob("cache/*/*/one.outer*.nbc")) - here
    when = there.stat().st_mtime_ns
    assert program("outer", NUMBA_CPU_NAME=OTHER) == ["6.0 1 0", "negative", "[True]"]
    assert there.stat().st_mtime_ns == when  # it is kept there, too


def test_what_is_kept_for_another_processor_is_compiled_anew_without_its_parts(program, tmp_path):
    program("outer")
    for file in tmp_path.glob("cache/*/parts/*"):
        file.unlink()
    assert program("outer", NUMBA_CPU_NAME=OTHER) == ["6.0 0 0", "negative", "[False, True]"]


def test_options_of_the_compiler_are_those_that_numba_gives():
    flags = Flags()
    assert flags.values() == {name: getattr(flags, name) for name in flags.options}
    flags.nrt, flags.error_model = True, "numpy"
    assert flags.values() == {name: getattr(flags, name) for name in flags.options}
    assert flags == flags.copy() != Flags()
    assert TargetConfig.values is kernel_parts._values


def test_nothing_else_is_kept_with_the_parts(program, tmp_path):
    program("outer", "other")
    for file in tmp_path.glob("cache/*/parts/*"):
        assert kernel_parts.Stored(Path(file)).is_whole


APART = """
import numpy as np
from ropewalk.mechanics.compiled import apart, inlined, lean

@inlined
def add(x, y):
    for i in range(x.size):
        y[i] += x[i]

@apart
def add_apart(x, y):
    for i in range(x.size):
        y[i] += x[i]

@lean
def outer(x, y):
    add(x, y)
    add_apart(x, y)

y = np.zeros(3)
outer(np.arange(3.0), y)
print(*y)
for f in add, add_apart:
    text = str(next(iter(f.overloads.values())).library._get_module_for_linking())
    print(next(line for line in text.splitlines() if line.startswith("define") and "add" in line).count("noalias"))
"""


def test_what_is_said_to_share_no_memory_does_so_for_the_compiler(tmp_path):
    (tmp_path / "one.py").write_text(APART)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    command = [sys.executable, str(tmp_path / "one.py")]
    found = subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.splitlines()
    assert found[0] == "0.0 2.0 4.0"
    assert int(found[2]) > int(found[1])  # besides where results go, the arrays
