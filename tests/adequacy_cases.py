"""Stand-ins for the measure of a point, in a module of their own: other processes must find them."""

from __future__ import annotations

import os
from pathlib import Path

from ropewalk import Scenario
from ropewalk.errors import RopewalkError

ROPE = {"start": [0.0, 0.0], "end": [10.0, 0.0], "tension": 1000.0, "mass": 0.1, "axial_stiffness": 1e6, "elements": 20}


def scenario(load=None, run=None, **changes):
    """A force of 10 N that runs along a string with waves of 100 m/s."""
    load = load or {"kind": "force", "force": [0.0, -10.0], "travel": {"speed": 50.0}}
    run = run or {"kind": "dynamic", "until": 0.08, "every": 0.001}
    tree = {"title": "String", "gravity": 0.0, "lines": {"string": ROPE}, "loads": {"cart": {"on": "string", **load}}}
    return Scenario.model_validate({**tree, "run": run, **changes})


def parameters(point):
    """Tension and drag of the string: what the axes of most tests change."""
    line = point.lines["string"]
    return line.tension, line.drag


def plain(point):
    """Distances that are easy to foretell."""
    tension, drag = parameters(point)
    return {
        "linear": {"deflection": drag * tension, "tension": None},
        "quasi-static": {"deflection": drag, "tension": 2.0 * drag},
    }


def counted(point):
    """The same, leaving a trace in the file that COUNTED names."""
    with Path(os.environ["COUNTED"]).open("a", encoding="utf-8") as stream:
        stream.write("{:g} {:g}\n".format(*parameters(point)))
    return plain(point)


def interrupted(point):
    """Ctrl-C at the third point."""
    if parameters(point) == (3000.0, 0.1):
        raise KeyboardInterrupt
    return counted(point)


def failing(point):
    """One point is refused, one has a fault, and one has no number."""
    tension, drag = parameters(point)
    if (tension, drag) == (2000.0, 0.1):
        raise RopewalkError("diverged\ntry a smaller step")
    if (tension, drag) == (3000.0, 0.1):
        raise ZeroDivisionError("float division by zero")
    if (tension, drag) == (1000.0, 0.2):
        return {"linear": {"deflection": float("inf")}}
    return plain(point)


def dying(point):
    """At one point the process dies, without a word."""
    if parameters(point) == (1000.0, 0.2):
        os._exit(7)
    return plain(point)


def message_where(point):
    """Tells in which process it is computed, and how many threads that may use."""
    threads = float(os.environ.get("OMP_NUM_THREADS", "0"))
    return {"linear": {**plain(point)["linear"], "process": float(os.getpid()), "threads": threads}}
