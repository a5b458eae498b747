"""Where compiled kernels are kept, and that nothing else is taken for them."""

import ast
import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ropewalk.mechanics import kernel_cache
from ropewalk.mechanics.kernel_cache import HOLD_KERNELS, PACKAGE

KERNEL = """
import sys
from ropewalk.mechanics.compiled import kernel

@kernel
def inner(x):
    return x + {}

@kernel
def outer(x):
    return 2 * inner(x)

print(outer(3), sum(outer.stats.cache_hits.values()))
"""


def ran(folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder / "cache"), **variables}
    command = [sys.executable, str(folder / "one.py")]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)


def kept(folder: Path) -> list[Path]:
    return sorted(folder.glob("cache/kernels-*/*/one.outer*"))


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    """A program and its kernels, for all who spoil a copy."""
    folder = tmp_path_factory.mktemp("compiled") / "program"
    folder.mkdir()
    (folder / "one.py").write_text(KERNEL.format(1))
    assert ran(folder).stdout == "8 0\n"
    assert ran(folder).stdout == "8 1\n"
    return folder


@pytest.fixture
def program(compiled, tmp_path):
    return Path(shutil.copytree(compiled, tmp_path / compiled.name))


def test_every_folder_that_holds_kernels_is_looked_at():
    """Kernels, and constants that are compiled into them; elsewhere only what is made of these and of its own file."""
    for path in PACKAGE.rglob("*.py"):
        source = path.read_text(encoding="utf-8")
        taken = {
            alias.name
            for node in ast.walk(ast.parse(source))
            if isinstance(node, ast.ImportFrom) and node.module == "ropewalk.mechanics.compiled"
            for alias in node.names
        }
        if taken <= {"compiling", "is_kept"}:  # who watches the compiler makes no kernels
            continue
        is_looked_at = path.relative_to(PACKAGE).parts[0] in HOLD_KERNELS
        for node in ast.parse(source).body:
            module = getattr(node, "module", None) or ""
            if module.startswith("ropewalk.") and module.split(".")[1] not in HOLD_KERNELS:
                assert is_looked_at, f"{path}: {module} may be compiled in"
                constants = [alias.name for alias in node.names if alias.name.isupper() or alias.name[0] == "_"]
                assert not constants, f"{path}: {constants} may be compiled in"


def test_another_state_of_any_kernel_has_another_folder(tmp_path, monkeypatch):
    for name in HOLD_KERNELS:
        (tmp_path / name).mkdir()
        (tmp_path / name / "one.py").write_text("a = 1")
    monkeypatch.setattr(kernel_cache, "PACKAGE", tmp_path)
    now = kernel_cache.digest.__wrapped__
    before = now()
    assert now() == before
    (tmp_path / HOLD_KERNELS[-1] / "one.py").write_text("a = 2")
    assert now() != before


def test_a_kernel_that_is_whole_is_taken_from_where_it_is_kept(program):
    assert ran(program).stdout == "8 1\n"


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
@pytest.mark.parametrize("damage", ["cut", "flipped", "empty"])
def test_a_spoilt_kernel_is_compiled_anew(program, ending, damage):
    for path in kept(program):
        if path.suffix == f".{ending}":
            data = bytearray(path.read_bytes())
            data[len(data) // 2] ^= 1
            path.write_bytes({"cut": data[:-7], "flipped": data, "empty": b""}[damage])
    again = ran(program)
    assert (again.stdout, again.stderr) == ("8 0\n", "")
    assert ran(program).stdout == "8 1\n"


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
def test_a_kernel_of_a_module_that_has_gone_is_compiled_anew(program, ending):
    """As one that was kept by a test, whose modules nobody else can import; what it names cannot be read then."""
    for path in kept(program):
        if path.suffix == f".{ending}":
            data = b"cmodule_that_has_gone\nname\n."  # what pickle writes for a name of that module
            path.write_bytes(hashlib.sha256(data).digest() + data)
    again = ran(program)
    assert (again.stdout, again.stderr) == ("8 0\n", "")
    assert ran(program).stdout == "8 1\n"


def test_where_nothing_can_be_written_kernels_last_as_long_as_temporary_files(tmp_path, monkeypatch):
    monkeypatch.setattr(kernel_cache, "_places", lambda: [Path(os.devnull) / "a", Path(os.devnull) / "b"])
    monkeypatch.setattr(kernel_cache.tempfile, "tempdir", str(tmp_path))
    with pytest.warns(RuntimeWarning, match=r"kept in .* as long as that lasts.*NUMBA_CACHE_DIR names another folder"):
        found = kernel_cache.folder.__wrapped__()
    assert tmp_path in found.parents
    assert found.parent.stat().st_mode & 0o077 == 0


@pytest.mark.skipif(not hasattr(os, "symlink"), reason="no links")
def test_a_temporary_folder_of_somebody_else_is_not_used(tmp_path, monkeypatch):
    (tmp_path / "theirs").mkdir()
    (tmp_path / f"ropewalk-{os.getuid()}").symlink_to(tmp_path / "theirs")
    monkeypatch.setattr(kernel_cache.tempfile, "tempdir", str(tmp_path))
    assert not list(kernel_cache._passing().glob("*"))
    assert not list((tmp_path / "theirs").glob("*"))
    assert kernel_cache._passing() != tmp_path / f"ropewalk-{os.getuid()}"


def test_kernels_that_an_image_brings_along_are_taken_over(tmp_path, monkeypatch):
    image, own = tmp_path / "image", tmp_path / "own"
    brought = image / f"kernels-{kernel_cache.digest()}" / "one"
    brought.mkdir(parents=True)
    (brought / "a.nbc").write_bytes(b"code")
    monkeypatch.setattr(kernel_cache, "_places", lambda: [image, own])
    is_writable = kernel_cache._is_writable
    monkeypatch.setattr(kernel_cache, "_is_writable", lambda place: image not in place.parents and is_writable(place))
    assert (kernel_cache.folder.__wrapped__() / "one" / "a.nbc").read_bytes() == b"code"


def test_kernels_of_few_states_of_the_sources_are_kept(tmp_path, monkeypatch):
    for i in range(6):
        (tmp_path / f"kernels-{i}").mkdir()
        os.utime(tmp_path / f"kernels-{i}", (i, i))
    monkeypatch.setattr(kernel_cache, "_places", lambda: [tmp_path])
    kernel_cache.folder.__wrapped__()
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        ["kernels-4", "kernels-5", f"kernels-{kernel_cache.digest()}"]
    )


def test_a_full_disk_costs_no_run(program):
    """What can be computed is computed; that it will be compiled again is said once."""
    limited = "import resource\nresource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))\n"
    (program / "one.py").write_text(limited + KERNEL.format(5))
    found = ran(program)
    assert found.stdout == "16 0\n"
    assert found.stderr.count("RuntimeWarning: compiled kernels cannot be kept in") == 1


def test_processes_that_keep_kernels_at_once_do_not_mix_them_up(tmp_path, monkeypatch):
    """Both have looked into the index before either has written to it; what gets lost is compiled again."""
    one, other, third = (kernel_cache._Files(str(tmp_path), "kernel", 1) for _ in range(3))
    save_data = one._save_data

    def late(name, data):
        other.save("float64", "code for float64")
        save_data(name, data)

    monkeypatch.setattr(other, "_load_index", dict)
    monkeypatch.setattr(one, "_save_data", late)
    one.save("int64", "code for int64")
    kinds = ("int64", "float64")
    assert all(third.load(kind) in (None, f"code for {kind}") for kind in kinds)
    assert any(third.load(kind) is not None for kind in kinds)


def test_what_is_compiled_beside_a_kernel_from_the_cache_is_as_it_would_be_alone(program):
    """Loading reads nothing in that only the compiler needs; the compiler still finds it."""
    more = (
        "import sys\nsys.path.insert(0, '.')\nimport numpy as np\nfrom one import kernel, outer\n\n"
        "@kernel\ndef other(x):\n    a = np.arange(x)\n    return outer(x) + a[1:].sum()\n\n"
        "print(other(4), sum(outer.stats.cache_hits.values()))\n"
    )
    (program / "two.py").write_text(more)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(program / "cache")}
    found = subprocess.run(
        [sys.executable, "two.py"], cwd=program, env=environment, capture_output=True, text=True, check=True
    )
    assert found.stdout.splitlines() == ["8 1", "16 1"]


def test_an_array_is_computed_once_and_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(kernel_cache, "folder", lambda: tmp_path)
    made = []

    def make():
        made.append(1)
        return np.arange(6.0).reshape(2, 3) / 7.0

    first, second = (kernel_cache.kept("table", (2, 3), make) for _ in range(2))
    assert len(made) == 1
    np.testing.assert_array_equal(first, second)
    second[0, 0] = 5.0  # it may be written to
    (tmp_path / "table").write_bytes((tmp_path / "table").read_bytes()[:-1] + b"x")
    np.testing.assert_array_equal(kernel_cache.kept("table", (2, 3), make), first)
    assert len(made) == 2  # spoilt
    np.testing.assert_array_equal(kernel_cache.kept("table", (2, 3), make), first)
    assert len(made) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["table"]
