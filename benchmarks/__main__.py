"""``python -m benchmarks``: all tables, or the one that is named."""

from __future__ import annotations

import argparse
import sys

from . import (
    accuracy,
    bodies,
    cold,
    continuum,
    cosim,
    cost,
    crossings,
    endurance,
    gate,
    many,
    mesh,
    nets,
    output,
    overhead,
    scaling,
    statics,
    studio,
    theory,
    throughput,
)
from .peers import __main__ as peers


def main() -> None:
    """Print what was asked for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument(
        "what", nargs="?", default="all",
        choices=["all", "peers", "continuum", "cost", "cold", "statics", "theory", "bodies", "overhead",
                 "nets", "cosim", "crossings", "endurance", "gate", "many", "mesh", "output", "scaling", "studio",
                 "throughput", "accuracy"],
        help="peers: error against CPU time beside other packages; continuum: riding beside sharing; cost: scaling; "
        "cold: first runs without and with compiled kernels; "
        "statics: thousands of load positions, and MoorPy; theory: closed forms on large fields; "
        "bodies: masses, walkers, models of one's own, and Exudyn's sliding joint; overhead: against real time; "
        "nets: a mass on nets of more and more nodes; cosim: what an exchange with an FMU costs; "
        "crossings: all trains at all speeds over a bridge, by modes; "
        "throughput: sweeps beside a plain loop; scaling: on more processes, simulated; "
        "many: an overhead line at speeds and tensions, ropes by the thousand (--whole); "
        "endurance: long runs, large lines, large results, checkpoints; "
        "studio: frames a second in a browser, from the mouse to the rope, memory (--minutes); "
        "output: what output instants and first runs cost, and large results; "
        "mesh: errors of meshes beside what is told of them; "
        "accuracy: error of a path over CPU time, against exact ones; "
        "gate: one problem, two schemes for contacts, one exact answer (only rows whose names contain --row)",
    )  # fmt: skip
    parser.add_argument("--row", action="append", default=[], help="part of the names of rows of gate")
    parser.add_argument("--minutes", type=float, default=5.0, help="that a film plays for studio")
    parser.add_argument("--whole", action="store_true", help="120 overhead lines and 10 000 ropes for many")
    asked = parser.parse_args()
    what = asked.what
    if what in ("all", "continuum"):
        continuum.main()
    if what in ("all", "cost"):
        cost.main()
    if what in ("all", "cold"):
        cold.main()
    if what in ("all", "statics"):
        statics.main()
    if what in ("all", "theory"):
        theory.main()
    if what in ("all", "bodies"):
        bodies.main()
    if what in ("all", "overhead"):
        overhead.main(whole=asked.whole)
    if what in ("all", "nets"):
        nets.main()
    if what in ("all", "cosim"):
        cosim.main()
    if what in ("all", "crossings"):
        crossings.main()
    if what in ("all", "endurance"):
        endurance.main()
    if what in ("all", "output"):
        output.main()
    if what in ("all", "studio"):
        studio.main(asked.minutes)
    if what in ("all", "throughput"):
        throughput.main()
    if what in ("all", "scaling"):
        scaling.main()
    if what in ("all", "many"):
        many.main(asked.whole)
    if what in ("all", "gate"):
        gate.main(asked.row)
    if what in ("all", "mesh"):
        mesh.main()
    if what in ("all", "accuracy"):
        accuracy.main()
    if what in ("all", "peers"):
        sys.argv = ["benchmarks.peers", "--case", "all"]
        peers.main()


if __name__ == "__main__":
    main()
