"""Compile the core: with the compiler of the system where it knows C++20, else with the one of the wheel `ziglang`."""

from __future__ import annotations

import os
import platform
import shlex
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

ZIG = "ziglang==0.17.1"
FLAGS = (
    "-std=c++20", "-O3", "-g0", "-ffreestanding", "-fno-exceptions", "-fno-rtti", "-fno-threadsafe-statics",
    "-fvisibility=hidden", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math", "-Wall", "-Wextra", "-Werror",
)  # fmt: skip
CHECKED = ("-O1", "-g", "-fsanitize=undefined,bounds-strict", "-fsanitize-undefined-trap-on-error", "-DRW_CHECKED")
"""Flags of a build that stops at the first undefined operation, with GCC."""
ADDRESS = ("-O0", "-g1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-DRW_CHECKED")
"""Flags of a build with GCC's sanitizers, whose libraries must be loaded before it."""
PROBE = """template<class T> concept Sums = requires(T t) { t + t; };
template<Sums T> T twice(T x) { return x + x; }
int f() { return twice(1); }
"""


class Target(NamedTuple):
    """A platform: its name for zig, the name of the library, flags to compile and to link with."""

    zig: str
    library: str
    compiling: tuple[str, ...]
    linking: tuple[str, ...]


_ELF = ("-fPIC",), ("-shared", "-nostdlib", "-Wl,-Bsymbolic")
_MAC = "-shared", "-nostdlib", "-Wl,-install_name,@rpath/core.dylib"
TARGETS = {
    "manylinux_2_17_x86_64": Target("x86_64-linux-gnu.2.17", "core.so", *_ELF),
    "manylinux_2_17_aarch64": Target("aarch64-linux-gnu.2.17", "core.so", *_ELF),
    "macosx_11_0_arm64": Target("aarch64-macos.11.0", "core.dylib", ("-fPIC",), _MAC),
    "win_amd64": Target("x86_64-windows-gnu", "core.dll", ("-mno-stack-arg-probe",), ("-shared", "-nostdlib")),
    "wasm32": Target("wasm32-freestanding", "core.wasm", (), ("-nostdlib", "-Wl,--no-entry", "-Wl,--export-dynamic")),
}
"""Platforms by the tag of their wheels."""
VARIANTS = {
    "baseline": ("-DRW_WIDTH=2",),
    "avx2": ("-DRW_WIDTH=4", "-mavx2"),
    "avx512": ("-DRW_WIDTH=8", "-mavx512f", "-mavx512dq", "-mavx512vl", "-mprefer-vector-width=512"),
}
"""Flags of what is compiled once for each instruction set."""


def platform_tag() -> str:
    """Return the tag of wheels for the platform that is built for: this one, or ROPEWALK_TARGET."""
    if wished := os.environ.get("ROPEWALK_TARGET"):
        return wished
    arm = platform.machine().lower() in ("arm64", "aarch64")
    if sys.platform == "linux":
        return f"manylinux_2_17_{'aarch64' if arm else 'x86_64'}"
    return "macosx_11_0_arm64" if sys.platform == "darwin" else "win_amd64"


def system_compiler() -> list[str] | None:
    """Return the command of a compiler of the system that knows C++20: CXX, g++ or clang++; None if there is none."""
    if os.environ.get("ROPEWALK_TARGET"):
        return None
    for command in map(shlex.split, filter(None, (os.environ.get("CXX"), "g++", "clang++", "c++"))):
        if shutil.which(command[0]) and _compiles(command):
            return command
    return None


def _compiles(command: list[str]) -> bool:
    """Whether a compiler works: it may be an old one, or the stub of a system that has none."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, "probe.cpp")
        source.write_text(PROBE, encoding="utf-8")
        words = [*command, "-std=c++20", "-c", str(source), "-o", str(source.with_suffix(".o"))]
        return subprocess.run(words, capture_output=True, check=False).returncode == 0


def native_variant() -> str:
    """Return the widest variant that this processor runs, as far as its system tells; else the baseline."""
    features = Path("/proc/cpuinfo")
    words = set(features.read_text(encoding="utf-8").split()) if features.exists() else set()
    return "avx512" if {"avx512dq", "avx512vl"} <= words else "avx2" if "avx2" in words else "baseline"


def build(root: Path, folder: Path, *, checks: tuple[str, ...] = (), only: str = "") -> Path:
    """Compile the core into a library in a folder, and return its path. What has not changed is not compiled anew.

    Args:
        root: of the repository.
        folder: of the library; made if it does not exist.
        checks: flags of a build that checks itself, CHECKED or ADDRESS.
        only: one variant instead of all.

    Raises:
        RuntimeError: it does not compile, or there is no compiler.
    """
    tag = platform_tag()
    target, compiler = TARGETS[tag], system_compiler()
    objects = root / "build" / "core" / (f"{tag}-{'address' if checks == ADDRESS else 'checked'}" if checks else tag)
    objects.mkdir(parents=True, exist_ok=True)
    if compiler is None:
        compiler = [sys.executable, "-m", "ziglang", "c++", "-target", target.zig]
    flags = [*FLAGS, *target.compiling, *checks]
    jobs = list[tuple[list[str], Path]]()
    names = [name for name in VARIANTS if name == "baseline" or "86" in tag or "amd" in tag]
    linked = sum(1 << number for number, name in enumerate(names) if only in ("", name))
    for source in ("api", "assembly", "bind", "runtime", "sheaves"):
        words = [f"-DRW_LINKED={linked}"] if source == "api" else []
        jobs.append(([str(root / "src" / "core" / f"{source}.cpp"), *words], objects / f"{source}.o"))
    for name, own in VARIANTS.items():
        if name in names and only in ("", name):
            words = [str(root / "src" / "core" / "variant.cpp"), f"-DRW_VARIANT={name}", *own]
            jobs.append((words, objects / f"{name}.o"))
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(lambda job: _compiled([*compiler, *flags, *job[0]], job[1]), jobs))
    folder.mkdir(parents=True, exist_ok=True)
    library = folder / target.library
    hosted = [word for word in target.linking if checks != ADDRESS or word != "-nostdlib"]
    _run([*compiler, *hosted, *checks, "-o", str(library), *(str(made) for _, made in jobs)])
    return library


def _compiled(command: list[str], made: Path) -> None:
    """Compile one source, unless it is there as these words make it from files that have not changed since."""
    key, needs = made.with_suffix(".key"), made.with_suffix(".d")
    words = shlex.join(command)
    if made.exists() and key.exists() and key.read_text(encoding="utf-8") == words:
        names = needs.read_text(encoding="utf-8").replace("\\\n", " ").partition(":")[2].split()
        if all(Path(name).exists() and Path(name).stat().st_mtime <= made.stat().st_mtime for name in names):
            return
    _run([*command, "-MMD", "-MF", str(needs), "-c", "-o", str(made)])
    key.write_text(words, encoding="utf-8")


def _run(command: list[str]) -> None:
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        raise RuntimeError(f"the core cannot be compiled: {error}") from error
    if done.returncode:
        raise RuntimeError(f"the core cannot be compiled:\n{shlex.join(command)}\n{done.stderr or done.stdout}")


if __name__ == "__main__":
    ROOT = Path(__file__).parent.parent
    ONLY = native_variant() if sys.argv[1:] == ["native"] else ""
    print(build(ROOT, ROOT / "src" / "ropewalk" / "engine", only=ONLY))
