"""This package on the peers' own problem: the same chain, the force shared between two nodes like theirs.

Nobody would use ropewalk so (it rides on a node instead, see docs/notes/travelling-node.md); here it makes the
comparison one of integrators alone. "auto" is what a user who sets nothing but the accuracy gets.
"""

from __future__ import annotations

import numpy as np

from ropewalk.model import Dynamic, Line, MovingForce, Scenario, Travel
from ropewalk.solve.splitting import RUNNING
from ropewalk.solve.start import start_state

from ..march import march
from .interface import Failed, Setting
from .problem import Array, Rope

name = "ropewalk"
distribution = "ropewalk"
settings = (
    Setting("auto", 1e-2, aligned=True),
    Setting("auto", 1e-3, aligned=True),
    Setting("auto", 1e-4, aligned=True),
    *(Setting("verlet", step, "step", aligned=True) for step in (2e-4, 1e-4, 5e-5, 2.5e-5, 1.25e-5)),
    *(Setting("rkn6", step, "step", aligned=True) for step in (7e-4, 5e-4, 4e-4, 3e-4, 2e-4, 1e-4)),
)


def available() -> str | None:
    """Always there."""
    return None


def suits(rope: Rope, setting: Setting) -> str | None:
    """The sixth-order method does not take damping."""
    return "damped: verlet instead" if setting.method == "rkn6" and rope.damping else None


def chain(rope: Rope) -> Rope:
    """The very chain of the rope."""
    return rope


def scenario(rope: Rope, method: str, accuracy: float, step: float | None) -> Scenario:
    """The rope as a scenario."""
    return Scenario(
        gravity=rope.gravity,
        lines={
            "rope": Line(
                start=(0.0, 0.0), end=(rope.span, 0.0), length=rope.length, mass=rope.mass,
                axial_stiffness=rope.stiffness, axial_damping=rope.damping, elements=rope.n,
            )
        },
        loads={
            "force": MovingForce(
                on="rope", force=(0.0, rope.force), travel=Travel(speed=rope.speed, measured="material")
            )
        },
        run=Dynamic(until=rope.until, method=method, accuracy=accuracy, step=step),
    )  # fmt: skip


def run(rope: Rope, times: Array, setting: Setting) -> tuple[Array, float]:
    """Positions (time, node, axis) and CPU seconds."""
    given = setting.kind == "step"
    what = scenario(rope, setting.method, 1e-3 if given else setting.size, setting.size if given else None)
    march(what, times[1:2], sharing=True)  # compiles, or loads from the cache
    done = march(what, times[1:], sharing=True)
    if done.status != RUNNING:
        raise Failed(f"status {done.status}")
    start = start_state(done.setting, with_loads=False)
    return np.array([state.r.T for state in (start, *done.states)]), done.seconds
