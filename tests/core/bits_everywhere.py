"""States after 10 000 steps on every platform that this machine can compile for and run: one hash for each structure.

    python tests/core/bits_everywhere.py [PART OF THE NAME OF A PLATFORM]

Needs the wheel `ziglang`, and node and qemu-aarch64 for what they run; what is missing is left out. A minute of CPU.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parents[2] / "build_core"))
from core_structures import net, parabola, rope
from ropewalk.engine import bound as bound_module
from ropewalk.engine import library as library_module
from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import Builder, RunProperties, SpringProperties

compiler, ROOT = import_module("compiler"), Path(__file__).parents[2]
ZIG = [sys.executable, "-m", "ziglang", "c++"]


def joined_ropes() -> Bound:
    """Two ropes of 100 curved links that meet in a node, under a force that travels."""
    builder, points = Builder(), parabola(0.0, 99.0, 200, 4.0)
    run = RunProperties(0.5, 1.0, 1e4)
    first, middle = builder.add_run(points[:, :101], run)
    again, last = builder.add_run(points[:, 100:], run)
    builder.fix(first, last)
    builder.join(again, middle)
    builder.add_force(0, [0.0, -300.0], 3.0, 2.0)
    return Bound(*builder.build(2))


def suspension_bridge() -> Bound:
    """A cable and a deck of 408 links each, 50 hangers, and a force that travels along the deck."""
    builder, cells, span = Builder(), 408, 200.0
    sag, deck = parabola(0.0, span, cells, 20.0), parabola(0.0, span, cells, 0.0)
    sag[1] += 22.0
    cable = builder.add_run(sag, RunProperties(0.5, 6.0, 60e6))
    floor = builder.add_run(deck, RunProperties(span / cells / 1.00075, 40.0, 80e6))
    builder.fix(*cable, *floor)
    for k in range(8, cells, 8):
        height = float(sag[1, k])
        middle = builder.add_node([sag[0, k], 0.5 * height], 0.3 * height)
        tie = SpringProperties(10e6 / height, 0.4998 * height, tension_only=True)
        builder.add_spring(cable[0] + k, middle, tie)
        builder.add_spring(middle, floor[0] + k, tie)
    builder.add_force(1, [0.0, -800.0], 3.0, 5.0)
    return Bound(*builder.build(2))


CASES: dict[str, tuple[Callable[[], Bound], int, float]] = {
    "rope": (lambda: rope(200), 10_000, 2.0**-10), "joined ropes": (joined_ropes, 10_000, 2.0**-10),
    "net": (lambda: net((99, 99), force=50.0, parts=2), 10_000, 2.0**-8),
    "bridge": (suspension_bridge, 500, 2.0**-15),
}  # fmt: skip
"""Structures, steps and their length, s. A bridge without dampers is chaotic: its later States would say no more."""

MAIN = """
typedef long I64;
extern "C" I64 rw_bind(char* const*, const I64*, I64*);
extern "C" I64 rw_advance(I64, char* const*, I64, I64, I64, double, const volatile int*, I64*);
static I64 call(I64 number, I64 a, I64 b, I64 c) {
    register I64 x8 __asm__("x8") = number, x0 __asm__("x0") = a, x1 __asm__("x1") = b, x2 __asm__("x2") = c;
    __asm__ volatile("svc 0" : "+r"(x0) : "r"(x8), "r"(x1), "r"(x2) : "memory");
    return x0;
}
alignas(64) static char pool[1 << 25];
extern "C" void _start() {
    struct { I64 steps; double dt; I64 sizes[3]; } head;
    I64 finding[3], done, result = 0;
    int stop = 0;
    const auto take = [](void* to, I64 bytes) {
        for (char* at = static_cast<char*>(to); bytes > 0;) {
            const I64 taken = call(63, 0, reinterpret_cast<I64>(at), bytes);
            if (taken <= 0) return false;
            at += taken, bytes -= taken;
        }
        return true;
    };
    char *bases[3], *at = pool;
    take(&head, sizeof head);
    for (int i = 0; i < 3; i++) bases[i] = at, at += (head.sizes[i] + 63) / 64 * 64, take(bases[i], head.sizes[i]);
    if (rw_bind(bases, head.sizes, finding)) call(93, 1, 0, 0);
    result = rw_advance(0, bases, 0, 1, head.steps, head.dt, &stop, &done);
    for (I64 sent = 0; sent < head.sizes[1];)
        sent += call(64, 1, reinterpret_cast<I64>(bases[1] + sent), head.sizes[1] - sent);
    call(93, result, 0, 0);
}
"""
"""A program for arm64 without a C library: reads a structure, takes steps, and writes the State."""

SCRIPT = """
import fs from 'fs';
const core = (await WebAssembly.instantiate(fs.readFileSync(process.argv[2]), {})).instance.exports;
const input = fs.readFileSync(0), view = new DataView(core.memory.buffer);
const start = (core.__heap_base.value + 63) & ~63;
const bases = start, sizes = start + 64, finding = start + 128, stop = start + 192;
let from = 40, at = start + 256, place = [];
for (let i = 0; i < 3; i++) {
    const size = Number(input.readBigInt64LE(16 + 8 * i));
    new Uint8Array(core.memory.buffer, at, size).set(input.subarray(from, from + size));
    view.setUint32(bases + 4 * i, at, true), view.setBigInt64(sizes + 8 * i, BigInt(size), true);
    place.push([at, size]), from += size, at += (size + 63) & ~63;
}
if (core.rw_bind(bases, sizes, finding)) process.exit(1);
const steps = input.readBigInt64LE(0), dt = input.readDoubleLE(8);
if (core.rw_advance(0n, bases, 0n, 1n, steps, dt, stop, stop + 8)) process.exit(2);
process.stdout.write(new Uint8Array(core.memory.buffer, ...place[1]));
"""
"""The same in WebAssembly."""


def hash_of(memory: bytes) -> str:
    """Return the first digits of the hash of a State."""
    return hashlib.sha256(memory).hexdigest()[:16]


def packed(bound: Bound, steps: int, dt: float) -> bytes:
    """Return a structure and its steps as the programs read them."""
    blocks = [each.memory for each in (bound.model, bound.state, bound.work)]
    head = struct.pack("<qd3q", steps, dt, *(each.size for each in blocks))
    return head + b"".join(each.tobytes() for each in blocks)


def compiled(folder: Path, target: str, words: list[str], linking: list[str]) -> Path:
    """Compile the baseline of the core for a target of zig, with more sources, into a program."""
    sources = sorted(map(str, (ROOT / "src" / "core").glob("*.cpp")))
    made, flags = folder / target, [each for each in compiler.FLAGS if each != "-Werror"]
    subprocess.run([*ZIG, "-target", target, *flags, *words, *sources, *linking, "-o", str(made)], check=True)
    return made


def by_program(command: list[str]) -> dict[str, str]:
    """Return the hash of each structure by a program that reads it."""
    return {
        name: hash_of(subprocess.run(command, input=packed(make(), *steps), stdout=subprocess.PIPE, check=True).stdout)
        for name, (make, *steps) in CASES.items()
    }


def by_library(path: Path, variant: str, calls: int = 1, threads: int = 1) -> dict[str, str]:
    """Return the hash of each structure by a library of this platform, in so many calls and threads."""
    core, found = library_module.library(path), dict[str, str]()
    bound_module.library = lambda: core  # type: ignore[attr-defined]
    for name, (make, steps, dt) in CASES.items():
        structure = make()
        for _ in range(calls):
            structure.advance(steps // calls, dt, variant, min(threads, structure.model.sizes["PARTS"]))
        found[name] = hash_of(structure.state.memory.tobytes())
    return found


def by_clang(folder: Path, variant: str) -> dict[str, str]:
    """Return the hash of each structure by a library that clang compiles."""
    os.environ["ROPEWALK_TARGET"] = compiler.platform_tag()
    shutil.copytree(ROOT / "src" / "core", folder / "src" / "core", dirs_exist_ok=True)
    return by_library(compiler.build(folder, folder), variant)


def by_wasm(folder: Path) -> dict[str, str]:
    """Return the hash of each structure by WebAssembly in node."""
    linking = ["-nostdlib", "-Wl,--no-entry", "-Wl,--export=__heap_base", "-Wl,--initial-memory=67108864",
               "-Wl,--export=rw_bind", "-Wl,--export=rw_advance"]  # fmt: skip
    (script := folder / "steps.mjs").write_text(SCRIPT, encoding="utf-8")
    return by_program(["node", str(script), str(compiled(folder, "wasm32-freestanding", [], linking))])


def by_arm(folder: Path) -> dict[str, str]:
    """Return the hash of each structure by a program for arm64 in qemu."""
    (source := folder / "main.cpp").write_text(MAIN, encoding="utf-8")
    program = compiled(folder, "aarch64-linux-musl", [str(source)], ["-nostdlib", "-static"])
    return by_program(["qemu-aarch64", str(program)])


def main(folder: Path, wanted: str = "") -> None:
    """Print the hashes, platform by platform."""
    native, names = library_module.PATH, library_module.variants()
    rows: dict[str, Callable[[], dict[str, str]]] = {f"g++ {name}": partial(by_library, native, name) for name in names}
    rows["10 calls"] = partial(by_library, native, names[-1], 10)
    if find_spec("ziglang"):
        rows |= {f"clang {name}": partial(by_clang, folder, name) for name in names}
        rows |= {"WebAssembly": partial(by_wasm, folder)} if shutil.which("node") else {}
        rows |= {"arm64": partial(by_arm, folder)} if shutil.which("qemu-aarch64") else {}
    rows["2 threads"] = partial(by_library, native, names[-1], 1, 2)  # needs two processors that nobody else uses
    for name, hashes in rows.items():
        if wanted in name:
            print(f"{name:16s}", *hashes().values(), flush=True)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        main(Path(made), *sys.argv[1:])
