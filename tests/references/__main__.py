"""References by one command: `make references` compares this state of the program with them.

python -m references                     compare all cases (in tests/)
python -m references record --shards 16  record what the shard files lack, one shard after another
python -m references merge               write the reference file from the shard files
python -m references planted             count the cases that detect each planted change
"""

from __future__ import annotations

import argparse
from pathlib import Path

from . import recording
from .cases import cases, selected


def main() -> None:
    """Run a command."""
    asked = _arguments()
    COMMANDS[asked.command](asked)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m references", description=__doc__)
    parser.add_argument("command", choices=COMMANDS, nargs="?", default="compare")
    parser.add_argument("--only", nargs="+", default=[], help="cases whose names contain one of these texts")
    parser.add_argument("--shard", default="0/1", help="i/n: every n-th case, beginning with i (from 0)")
    parser.add_argument("--shards", type=int, default=16, help="number of shard files")
    parser.add_argument("--folder", type=Path, default=Path("../out/references"), help="shard files and scratch files")
    parser.add_argument("--workers", type=int, default=1, help="processes")
    return parser.parse_args()


def record(asked: argparse.Namespace) -> None:
    """Record the cases that the shard files lack."""
    every = selected(cases(), asked.only, asked.shard)
    scratch = asked.folder.resolve() / "scratch"
    for k in range(asked.shards):
        own = [case for case in every if case.shard % asked.shards == k]
        recording.record_shard(own, asked.folder / f"shard-{k:02}.bin", scratch, asked.workers)


COMMANDS = {"record": record}

if __name__ == "__main__":
    main()
