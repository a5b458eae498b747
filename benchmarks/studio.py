"""The studio in a browser: frames a second, from the mouse to the rope, processors, memory, first paint."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np

from ropewalk.results.frame import Layout
from ropewalk.studio.share import PAGE, filled
from ropewalk.studio.streams import film

FRONT = Path(__file__).parents[1] / "studio"
NODES = (200, 500, 1000, 5000)
LINKS = (50, 200, 1000)
SIDES = (14, 32, 71)  # nodes of nets along each side
FRAMES = 200  # of a film, 60 to a second
PLAY, DRAG = 6.0, 10.0  # s of measurement
ROPE = """\
title: A slack rope
lines:
  rope: {start: [0, 0], end: [19.5, 0], length: 20 m, mass: 1 kg/m, axial_stiffness: 100 kN, elements: %d}
loads:
  walker: {kind: force, on: rope, force: [0, -800], travel: {speed: 10, measured: slip, from: 0}}
run: {kind: dynamic, until: 0.3 s, every: 10 ms}
"""


def page(layout: Layout, file: Path, **arrays: Any) -> Path:
    """A shared page of frames that nobody has computed: how fast they are shown does not depend on that."""
    given = {name: np.asarray(array, dtype=float) for name, array in arrays.items()}
    template = PAGE / ("share-space" if len(layout.axes) == 3 else "share") / "share.html"
    ended = {"title": file.stem, "outcome": "completed", "summary": "", "doubts": []}
    file.write_text(filled(template, film(layout, np.arange(FRAMES) / 60.0, given, {}), ended))
    return file


def rope(nodes: int, file: Path) -> Path:
    """A rope with waves on it, a load and two supports."""
    x, t = np.linspace(0, 20, nodes), np.arange(FRAMES)[:, None] / 60.0
    z = -0.02 * x * (20 - x) + 0.3 * np.sin(0.5 * np.pi * x) * np.sin(6.0 * t)
    zero, names = np.zeros(0), ("rope",) * nodes
    layout = Layout(("x", "z"), names, zero, names[1:], zero, ("load",), ("rope.start", "rope.end"))
    load = np.stack((np.linspace(1, 19, FRAMES), np.full(FRAMES, -1.0)), axis=-1)[:, None]
    return page(
        layout, file, position=np.stack((np.broadcast_to(x, z.shape), z), axis=-1),
        tension=1e3 + 400 * np.cos(0.5 * np.pi * x[1:] - 6.0 * t), contact_position=load,
        contact_force=np.tile([0.0, -800.0], (FRAMES, 1, 1)), hold_force=np.zeros((FRAMES, 1, 2)),
        reaction=np.tile([[-500.0, 400.0], [500.0, 400.0]], (FRAMES, 1, 1)),
    )  # fmt: skip


def net(side: int, file: Path) -> Path:
    """A net of side x side nodes that swings."""
    u, v = (part.ravel() for part in np.meshgrid(*[np.linspace(0, 6, side)] * 2))
    first = [i + side * j for j in range(side - 1) for i in range(side - 1)]
    cells = tuple(cell for a in first for cell in ((a, a + 1, a + side + 1), (a, a + side + 1, a + side)))
    t = np.arange(FRAMES)[:, None] / 60.0
    z = np.sin(np.pi * u / 6) * np.sin(np.pi * v / 6) * np.sin(6.0 * t)
    tension = 500 + 400 * np.sin(np.arange(len(cells)) / 40.0 + 6.0 * t)
    zero, shape = np.zeros(0), z.shape
    layout = Layout(("x", "y", "z"), ("net",) * u.size, zero, (), zero, (), (), cell=cells)
    position = np.stack((np.broadcast_to(u, shape), np.broadcast_to(v, shape), z), axis=-1)
    return page(layout, file, position=position, cell_tension=np.stack((tension, tension / 2), axis=-1))


def measured(what: str, given: str, seconds: float, between: Callable[[int], None] = lambda _: None) -> dict[str, Any]:
    """What studio/tests/speed.mjs finds."""
    command = ["node", "tests/speed.mjs", what, given, f"{seconds:g}"]
    with subprocess.Popen(command, cwd=FRONT, stdout=subprocess.PIPE, text=True) as browser:
        assert browser.stdout is not None
        for line in browser.stdout:
            if line.startswith("{"):
                found: dict[str, Any] = json.loads(line)
                if found["wrong"]:
                    raise RuntimeError("\n".join(found["wrong"]))
                return found
            between(browser.pid)
    raise RuntimeError(f"tests/speed.mjs {what}: no answer")


@contextmanager
def serving(folder: Path) -> Iterator[tuple[str, int]]:
    """A studio: its address, and the number of its process."""
    command = [sys.executable, "-m", "ropewalk", "studio", "--no-browser", "rope.yaml"]
    process = subprocess.Popen(command, cwd=folder, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stderr is not None
        found = re.search(r"http://127\.0\.0\.1:\d+/[\w-]+/", process.stderr.readline())
        assert found
        yield found[0], process.pid
    finally:
        process.terminate()
        with suppress(subprocess.TimeoutExpired):
            process.wait(60.0)
        process.kill()


def family(root: int) -> dict[int, list[str]]:
    """A process and those that it has begun, and what Linux's /proc tells of each from the number of its parent on."""
    told, ours = dict[int, list[str]](), {root}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            with suppress(OSError):
                told[int(entry.name)] = (entry / "stat").read_text().rpartition(")")[2].split()[1:]
    while more := {pid for pid, (parent, *_) in told.items() if int(parent) in ours} - ours:
        ours |= more
    return {pid: told[pid] for pid in ours & told.keys()}


def processor_time(root: int) -> float:
    """CPU time of a process and of those that it has begun, s."""
    return sum(int(told[10]) + int(told[11]) for told in family(root).values()) / os.sysconf("SC_CLK_TCK")


def memory_of(root: int) -> float:
    """Memory of a process and of those that it has begun, what they share counted once, MB."""
    size = 0
    for pid in family(root):
        with suppress(OSError):
            size += int(re.findall(r"^Pss: +(\d+) kB", Path(f"/proc/{pid}/smaps_rollup").read_text(), re.M)[0])
    return size / 1e3


def films(folder: Path) -> None:
    """Print frames a second while a film plays with its curves beside it."""
    print(
        f"\nFilms that play for {PLAY:g} s, curves beside them, at most 60 frames a second; nets by WebGL in software"
    )
    print("              frames/s   CPU of the browser, a frame   first paint")
    films = [(f"rope of {nodes:5d}", rope, nodes) for nodes in NODES]
    films += [(f"net of {side**2:6d}", net, side) for side in SIDES]
    for name, made, size in films:
        marks = list[float]()
        shown = str(made(size, folder / "film.html"))
        found = measured("play", shown, PLAY, lambda pid: marks.append(processor_time(pid)))  # noqa: B023
        each = 1e3 * (marks[1] - marks[0]) / found["frames"]
        rate = 1e3 * found["frames"] / found["ms"]
        print(f"  {name}  {rate:8.1f}  {each:24.0f} ms  {found['paints'][0]:9.0f} ms")


def drags(folder: Path) -> None:
    """Print equilibria a second under a mouse that moves 60 times a second, and what they cost."""
    print(f"\nA load dragged by the mouse for {DRAG:g} s; ms from the mouse to the picture; first paint, median of 5")
    print("  links  equilibria/s  of moves/s  median  95 %  CPU of an equilibrium: server  browser  first paint")
    for links in LINKS:
        (folder / "rope.yaml").write_text(ROPE % links)
        marks = list[tuple[float, float]]()
        with serving(folder) as (address, pid):
            found = measured(
                "drag",
                address,
                DRAG,
                lambda own: marks.append((processor_time(pid), processor_time(own))),  # noqa: B023
            )
        seconds, delays = found["ms"] / 1e3, np.array(found["delays"])
        half, most = np.percentile(delays, [50, 95])
        server, browser = (1e3 * (after - before) / delays.size for before, after in zip(*marks, strict=True))
        rates = f"{delays.size / seconds:12.1f}  {found['moves'] / seconds:10.1f}  {half:6.0f}  {most:4.0f}"
        print(f"  {links:5d}  {rates}  {server:26.1f} ms  {browser:4.1f} ms  {np.median(found['paints']):8.0f} ms")


def growth(what: str, seconds: np.ndarray, size: np.ndarray) -> None:
    """Print how a memory in MB grows after a fifth of the time."""
    late = seconds > 0.2 * seconds[-1]
    fit = np.polyfit(seconds[late], size[late], 1)
    spread = np.std(size[late] - np.polyval(fit, seconds[late]))
    ends = f"{size[0]:7.1f} MB, at the end {size[-1]:7.1f} MB"
    print(f"  {what:8} {ends}, {3600 * fit[0]:+6.2f} MB an hour, scatter {spread:.2f} MB")


def memory(folder: Path, minutes: float) -> None:
    """Print how the page's memory grows while a film of 1000 nodes plays again and again."""
    heap = np.array(measured("stay", str(rope(1000, folder / "rope.html")), 60.0 * minutes)["heap"])
    print(f"\nA film of 1000 nodes played for {minutes:g} min, heap of the page after its garbage is gone")
    growth("page", heap[:, 0], heap[:, 1] / 1e6)
    print(f"  {heap[0, 2]:.0f} nodes of the document, at the end {heap[-1, 2]:.0f}")


def memory_dragged(folder: Path, minutes: float) -> None:
    """Print how the memory of page and server grows while a load is dragged for two seconds of twenty."""
    (folder / "rope.yaml").write_text(ROPE % 200)
    sizes = list[float]()
    with serving(folder) as (address, pid):
        found = measured("linger", address, 60.0 * minutes, lambda _: sizes.append(memory_of(pid)))
    heap = np.array(found["heap"])
    print(f"\nA load on 200 links dragged for 2 s of every 20 s, {minutes:g} min; the server with its workers")
    growth("page", heap[:, 0], heap[:, 1] / 1e6)
    growth("server", heap[:, 0], np.array(sizes))


def main(minutes: float = 5.0) -> None:
    """Print all tables."""
    if not (FRONT / "node_modules" / "playwright-core").is_dir() or not (PAGE / "index.html").is_file():
        print("\nstudio: the front end is not built: make studio")
        return
    print(f"\nstudio: load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores as it begins")
    with tempfile.TemporaryDirectory() as place:
        drags(Path(place))
        films(Path(place))
        memory(Path(place), minutes)
        memory_dragged(Path(place), minutes)
    print(f"load {os.getloadavg()[0]:.1f} as it ends")
