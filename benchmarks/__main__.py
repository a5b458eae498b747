"""``python -m benchmarks``: all tables, or the one that is named."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from importlib import import_module
from typing import Any

TABLES = {
    "peers": "error against CPU time of other packages", "continuum": "a force on a node, and shared by two",
    "cost": "time per node and step, and a bare loop", "statics": "thousands of load positions, and MoorPy",
    "theory": "closed forms on large fields", "bodies": "masses, walkers, external models, Exudyn's sliding joint",
    "overhead": "overhead lines against real time (--whole: 10 000 spans)", "nets": "a mass on growing nets",
    "cosim": "an exchange with an FMU", "crossings": "all trains at all speeds over a bridge, by modes",
    "endurance": "long runs, large lines, large results, checkpoints",
    "gate": "yardsticks of engines; --part: contacts, errors, agreement, steps, overhead, setup, processes",
    "many": "an overhead line at speeds and tensions, ropes by the thousand (--whole)",
    "mesh": "errors of meshes and their estimates", "output": "output instants and large results",
    "studio": "frames a second in a browser, memory (--minutes)",
    "throughput": "sweeps and a plain loop",
}  # fmt: skip
"""What each module prints."""


def main() -> None:
    """Print the tables."""
    listed = "; ".join(f"{name}: {text}" for name, text in TABLES.items())
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("what", nargs="?", default="all", choices=["all", *TABLES], help=listed)
    parser.add_argument("--part", action="append", default=[], help="part of gate, all if none is named")
    parser.add_argument("--row", action="append", default=[], help="part of the names of problems of gate")
    parser.add_argument("--rounds", type=int, default=11, help="turns of which gate takes medians")
    parser.add_argument("--cold", action="append", default=[], help="example that gate runs without kernels, too")
    parser.add_argument("--minutes", type=float, default=5.0, help="that a film plays for studio")
    parser.add_argument("--whole", action="store_true", help="120 overhead lines and 10 000 ropes for many")
    given = parser.parse_args()
    arguments: dict[str, tuple[Any, ...]] = {
        "gate": (given.part, given.row, given.rounds, given.cold), "studio": (given.minutes,),
        "many": (given.whole,), "overhead": (given.whole,), "peers": (["--case", "all"],),
    }  # fmt: skip
    for name in TABLES if given.what == "all" else [given.what]:
        module = import_module("benchmarks.peers.__main__" if name == "peers" else f"benchmarks.{name}")
        table: Callable[..., None] = module.main
        table(*arguments.get(name, ()))


if __name__ == "__main__":
    main()
