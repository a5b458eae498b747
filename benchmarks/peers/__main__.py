"""Error against CPU seconds of the peers that are installed: ``python -m benchmarks.peers --help``."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace

from . import PEERS
from .interface import release
from .measure import Row, cheapest, measure
from .problem import Array, Rope

CASES = {
    "undamped-200": Rope(),
    "damped-200": Rope(damping=50.0),
    "undamped-800": Rope(n=800, until=0.5),  # later no two integrators agree
}
TARGETS = (1e-2, 1e-3, 1e-4)


def print_case(case: str, wanted: list[str], limit: float, until: float | None) -> None:
    """Measure one case and print it: all settings, then the cheapest way to each target."""
    rope = CASES[case] if until is None else replace(CASES[case], until=until)
    peers = [peer for peer in PEERS if not wanted or any(word.lower() in peer.name.lower() for word in wanted)]
    print(f"\n{case}: {rope.n} links, damping {rope.damping:g} N s, {rope.until:g} s")
    print("Error: the largest over all nodes and output times, against the same chain")
    for peer in peers:
        print(f"  {peer.name} {release(peer.distribution)}: {peer.available() or 'installed'}")
    print(f"\n{'peer':16} {'setting':46} {'error m':>9} {'CPU s':>8}")
    rows: list[Row] = []
    motions: dict[Rope, tuple[Array, float]] = {}
    for row in measure(rope, peers, limit, motions=motions):
        rows.append(row)
        print(f"{row.peer:16} {row.setting!s:46} {row.error:9.1e} {row.seconds:8.3f}  {row.note}", flush=True)
    print()
    for chain, (_, doubt) in motions.items():
        law = "tension-only" if chain.tension_only else "Hooke"
        print(f"The reference with the {law} law is itself uncertain by {doubt:.0e} m.")
    print(f"\nCPU s to reach an error of\n{'':44}" + "".join(f"{target:>9.0e}" for target in TARGETS) + " m")
    best = [cheapest(rows, target) for target in TARGETS]
    for key in cheapest(rows, float("inf")):
        cells = (f"{found[key].seconds:9.3f}" if key in found else f"{'-':>9}" for found in best)
        print(f"{key[0]:16} {key[1]:27}" + "".join(cells))


def main(words: Sequence[str] | None = None) -> None:
    """Read the arguments and print the cases."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.peers", description="Error against CPU seconds of the peers that are installed."
    )
    parser.add_argument("--case", choices=[*CASES, "all"], default="undamped-200")
    parser.add_argument("--peer", action="append", default=[], help="part of a peer's name; may be repeated")
    parser.add_argument("--limit", type=float, default=5.0, help="skip what is predicted above these CPU seconds")
    parser.add_argument("--until", type=float, help="end in s; the undamped rope becomes chaotic late")
    arguments = parser.parse_args(words)
    for case in CASES if arguments.case == "all" else [arguments.case]:
        print_case(case, arguments.peer, arguments.limit, arguments.until)


if __name__ == "__main__":
    main()
