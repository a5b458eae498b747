"""Build what is released into dist/: sdist, a wheel for each platform and the WebAssembly module.

All of it from one machine with the pinned compiler. Each library exports the names rw_* and needs no other library, so
it runs on every Linux that the tag of its wheel admits.
"""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path
from time import perf_counter

import compiler
import lief

ROOT = Path(__file__).parent.parent
DIST = ROOT / "dist"
LINKERS = {"__dso_handle", "_mh_dylib_header", "DllMainCRTStartup"}
SYSTEM = "/usr/lib/libSystem.B.dylib"
"""Names that linkers add, and the library that macOS always has."""


def build(kind: str) -> None:
    """Build the sdist or a wheel with the packages that are installed here."""
    words = ["--no-isolation", "--skip-dependency-check", "--outdir", str(DIST), kind, str(ROOT)]
    subprocess.run([sys.executable, "-m", "build", *words], check=True, stdout=subprocess.DEVNULL)


def check_symbols(name: str, content: bytes) -> int:
    """Return the number of names that a library exports.

    Raises:
        ValueError: it exports others than rw_*, or needs another library.
    """
    library = lief.parse(list(content))
    names = {str(each.name).removeprefix("_") for each in library.exported_functions} - LINKERS
    needs = {str(getattr(each, "name", each)) for each in library.libraries} - {"@rpath/core.dylib", SYSTEM}
    if wrong := [each for each in names if not each.startswith("rw_")] + sorted(needs):
        raise ValueError(f"{name}: {', '.join(wrong)}")
    return len(names)


def build_library(tag: str) -> str:
    """Build the wheel or the module of a platform; return its name, sizes and the time that it took."""
    begin, os.environ["ROPEWALK_TARGET"] = perf_counter(), tag
    if tag == "wasm32":
        made = compiler.build(ROOT, DIST)
        return f"{made.name}  {made.stat().st_size / 1e3:.0f} kB  {perf_counter() - begin:.1f} s"
    build("--wheel")
    wheel = next(DIST.glob(f"*{tag}.whl"))
    with zipfile.ZipFile(wheel) as packed:
        content = packed.read(f"ropewalk/engine/{compiler.TARGETS[tag].library}")
    names, size, seconds = check_symbols(wheel.name, content), wheel.stat().st_size, perf_counter() - begin
    return f"{wheel.name}  {size / 1e6:.1f} MB, core {len(content) / 1e3:.0f} kB, {names} names  {seconds:.1f} s"


def main() -> None:
    """Build and check everything, and try what runs here in fresh environments; an argument names constraints."""
    build("--sdist")
    for tag in compiler.TARGETS:
        print(build_library(tag), flush=True)
    del os.environ["ROPEWALK_TARGET"]
    for package in (*DIST.glob("*.tar.gz"), *DIST.glob(f"*{compiler.platform_tag()}.whl")):
        subprocess.run([ROOT / ".ci" / "try-package", sys.executable, package, *sys.argv[1:]], check=True)


if __name__ == "__main__":
    main()
