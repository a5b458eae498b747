"""Tables as they were run, with command, date, machine and versions; and the page that shows them.

    python -m benchmarks.record NAME ...      run tables, twice each, and keep them in benchmarks/tables/NAME.json
    python -m benchmarks.record --page        write docs/benchmarks.md from what is kept

A run is a process of its own. Its text is kept as it was printed; the second run says how far numbers scatter.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import re
import resource
import subprocess
import sys
import time as clock
from datetime import date
from pathlib import Path
from statistics import median
from typing import Any

from .peers.interface import release

ROOT = Path(__file__).parents[1]
KEPT = ROOT / "benchmarks" / "tables"
PAGE = ROOT / "docs" / "benchmarks.md"
PEERS = ("scipy", "scikit-sundae", "moordyn", "moorpy", "exudyn")
OURS = ("ropewalk", "numpy", "numba")
NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")

TABLES = {
    "peers": ("The same chain compared with other packages", "-m benchmarks peers"),
    "damped": ("One rope of it: 200 links, damped", "-m benchmarks.peers --case damped-200"),
    "continuum": ("What sharing the force between nodes costs", "-m benchmarks continuum"),
    "cost": ("Cost per node and step", "-m benchmarks cost"),
    "statics": ("Thousands of places of a load", "-m benchmarks statics"),
    "theory": ("Closed forms on large fields", "-m benchmarks theory"),
    "crossings": ("All trains at all speeds", "-m benchmarks crossings"),
    "mesh": ("The error of the mesh compared with the estimate", "-m benchmarks mesh"),
    "bodies": ("Moving bodies", "-m benchmarks bodies"),
    "nets": ("A mass that crosses a net", "-m benchmarks nets"),
    "overhead": ("Overhead lines against real time", "-m benchmarks overhead"),
    "cosim": ("An exchange with an FMU", "-m benchmarks cosim"),
    "output": ("Instants of output, large results", "-m benchmarks output"),
    "throughput": ("Sweeps compared with a loop", "-m benchmarks throughput"),
    "many": ("Many runs in one sweep", "-m benchmarks many --whole"),
    "endurance": ("Long runs, large lines", "-m benchmarks endurance"),
    "gate": ("Schemes for contacts, one exact answer", "-m benchmarks gate --part contacts"),
    "gate-errors": ("The compiled core: CPU time to the same error", "-m benchmarks gate --part errors"),
    "gate-agreement": ("The compiled core next to today's system", "-m benchmarks gate --part agreement"),
    "gate-steps": ("The compiled core: CPU time per link and step", "-m benchmarks gate --part steps"),
    "gate-setup": ("Set-up of growing structures", "-m benchmarks gate --part setup"),
    "gate-processes": ("Commands as whole processes, warm and cold", "-m benchmarks gate --part processes"),
    "gate-overhead": ("EN 50318:2002 and its ranges", "-m benchmarks gate --part overhead"),
    "studio": ("Moves, films and memory of the studio", "-m benchmarks studio"),
    "vbi2d": ("Comparison with VBI-2D", "-m benchmarks.vbi2d FOLDER"),
    "ttb2d": ("Comparison with TTB-2D", "-m benchmarks.ttb2d FOLDER"),
}
"""Titles and commands, by name."""

ELSEWHERE = {
    "peers": ("notes/speed.md#the-same-chain-the-force-shared-between-nodes-by-everybody", "2026-11-21"),
    "continuum": ("notes/speed.md#the-continuum-what-sharing-the-force-costs", "2026-11-21"),
    "cost": ("notes/speed.md#cost-per-node-and-step", "2026-11-21"),
    "bodies": ("notes/speed.md#moving-bodies", "2026-11-21"),
    "nets": ("notes/speed.md#nets", "2026-11-22"),
    "overhead": ("notes/speed.md#overhead-lines-against-real-time", "2026-11-21"),
    "cosim": ("notes/speed.md#moving-bodies", "2026-11-22"),
    "output": ("notes/speed.md#output", "2026-11-25"),
    "throughput": ("sweep.md#where-it-was", "2026-11-26"),
    "gate": ("notes/gate-of-contacts.md", "2026-11-25"),
    "gate-errors": ("notes/core.md#the-gate", "2026-11-28"),
    "gate-agreement": ("notes/core.md#the-gate", "2026-11-28"),
    "gate-steps": ("notes/core.md#the-gate", "2026-11-28"),
    "gate-setup": ("notes/core.md#the-gate", "2026-11-28"),
    "gate-processes": ("notes/core.md#the-gate", "2026-11-28"),
    "mesh": ("notes/error-of-the-mesh.md", "2026-11-25"),
    "statics": ("notes/speed.md#statics", "2026-11-21"),
    "theory": ("notes/speed.md#closed-forms", "2026-11-21"),
    "crossings": ("notes/trains.md", "2026-11-26"),
    "vbi2d": ("notes/profiles.md", "2026-11-25"),
    "ttb2d": ("notes/track.md", "2026-11-25"),
}
"""Where numbers of tables that are not kept stand, with the day on which they were last written there."""


def machine() -> dict[str, Any]:
    """What the tables were run on."""
    info = Path("/proc/cpuinfo")
    found = re.search(r"model name\s*: (.*)", info.read_text(encoding="utf-8")) if info.is_file() else None
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    name = found[1] if found else platform.processor() or platform.machine()
    return {"processor": name, "cores": os.cpu_count(), "memory": round(memory), "system": platform.system()}


def run(name: str, times: int) -> dict[str, Any]:
    """Run a table so many times; its texts with all that they hang on.

    Raises:
        CalledProcessError: it fails.
    """
    arguments = TABLES[name][1].split()
    texts, seconds, load = [], [], [os.getloadavg()[0]]
    for _ in range(times):
        wall, cpu = clock.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([sys.executable, *arguments], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True)
        spent = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds.append([spent.ru_utime + spent.ru_stime - cpu.ru_utime - cpu.ru_stime, clock.monotonic() - wall])
        texts.append(done.stdout.strip("\n"))
        load.append(os.getloadavg()[0])
    versions = {one: release(one) for one in (*OURS, *PEERS)}
    return {
        "command": f"python {TABLES[name][1]}", "date": date.today().isoformat(), "machine": machine(),
        "python": platform.python_version(), "versions": versions, "load": load, "seconds": seconds, "texts": texts,
    }  # fmt: skip


def scatter(texts: list[str]) -> str:
    """How far numbers of the second text are from those of the first, in words."""
    if len(texts) < 2:
        return "It was run once."
    first, second = (NUMBER.findall(text) for text in texts[:2])
    if len(first) != len(second):
        return "It was run twice; the second run printed other rows, and is not compared."
    pairs = [(float(a), float(b)) for a, b in zip(first, second, strict=True) if a != b and float(a) * float(b) > 0.0]
    if not pairs:
        return "It was run twice, with the same numbers."
    off = [max(a, b) / min(a, b) - 1.0 for a, b in pairs]
    return (f"It was run twice: {len(pairs)} of {len(first)} numbers came out otherwise the second time, "
            f"by {100 * median(off):.0f} % in the median and {100 * max(off):.0f} % at most.")  # fmt: skip


def section(name: str, kept: dict[str, Any]) -> list[str]:
    """A table that is kept."""
    host, ends = kept["machine"], {min(kept["load"]), max(kept["load"])}
    load = " to ".join(f"{value:.1f}" for value in sorted(ends))
    when = "before and after" if len(kept["load"]) > 1 else "before"
    peers = ", ".join(f"{one} {kept['versions'][one]}" for one in PEERS if kept["versions"][one] != "-")
    ours = ", ".join(f"{one} {kept['versions'][one]}" for one in OURS)
    cpu, wall = (sum(both[k] for both in kept["seconds"]) / len(kept["seconds"]) for k in (0, 1))
    ran = f"`{kept['command']}`, {kept['date']}: {cpu:.0f} s of CPU, {wall:.0f} s on the clock."
    on = (
        f"{host['processor']}, {host['cores']} shared cores, {host['memory']} GB, {host['system']}; load {load} "
        f"(processes that wanted a core, mean of a minute, {when}); Python {kept['python']}, {ours}; "
        f"{f'peers installed: {peers}' if peers else 'no peer takes part'}."
    )
    title, text = TABLES[name][0], kept["texts"][0]
    return [f"## {title}", "", f"{ran} {scatter(kept['texts'])}", "", "```text", text, "```", "", on, ""]


def page() -> str:
    """The page of all tables: those that are kept, then where the others stand."""
    kept = {
        name: json.loads(path.read_text(encoding="utf-8"))
        for name in TABLES
        if (path := KEPT / f"{name}.json").is_file()
    }
    rows = [HEAD]
    for name, table in kept.items():
        rows += section(name, table)
    rows += [
        "## Not run for this page",
        "",
        NOT_RUN,
        "",
        "| table | command | its numbers | written |",
        "|---|---|---|---|",
    ]
    for name, (place, day) in ELSEWHERE.items():
        if name not in kept:
            title, command = TABLES[name]
            rows.append(f"| {title} | `python {command}` | [{place.partition('#')[0]}]({place}) | {day} |")
    return "\n".join(rows) + "\n"


HEAD = """\
<!-- Written by  python -m benchmarks.record --page  from benchmarks/tables: do not edit. -->

# Benchmarks

What ropewalk costs, and what others cost for the same. Every table is the text that its command printed, with the day,
the machine and the versions; `make bench` prints all of them on yours, `make peers` installs the other packages, and
`python -m benchmarks.record NAME` keeps a table for this page.

**How to read it.** The machine has two cores that others use at the same time. Times are CPU seconds, not those of a
clock, but what shares caches and memory makes them longer, too: under load they scatter by a third, and only **ratios
within a table** carry over to another machine. With each table stands how far its numbers moved in a second run,
or that there was none. Settings of the other packages that are coarser or finer than needed were tried, of ours no more
than of theirs; how, and what is unfair in which direction, is in [the note on speed](notes/speed.md).
"""

NOT_RUN = "Each was run on the day on which its numbers were written, or before, with machine and conditions."


def main() -> None:
    """Run and keep what was asked for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.record", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of tables: {', '.join(TABLES)}")
    parser.add_argument("--times", type=int, default=2, help="how often each is run")
    parser.add_argument("--page", action="store_true", help="write docs/benchmarks.md")
    asked = parser.parse_args()
    if unknown := set(asked.names) - TABLES.keys():
        parser.error(f"no such table: {', '.join(sorted(unknown))}")
    KEPT.mkdir(exist_ok=True)
    for name in asked.names:
        (KEPT / f"{name}.json").write_text(json.dumps(run(name, asked.times), indent=1) + "\n", encoding="utf-8")
        print(f"{name}: kept", flush=True)
    if asked.page:
        PAGE.write_text(page(), encoding="utf-8")
        print(f"{PAGE.relative_to(ROOT)} written")


if __name__ == "__main__":
    main()
