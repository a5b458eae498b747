"""Error against the continuum over CPU seconds: riding on a node, and sharing the force between two nodes.

Two references: the exact self-similar solution of a force that is switched on (a taut nonlinear string, the contact's
path), and a fine mesh of the slack rope with line damping (contact path and node positions). What a user of any peer
does is the second column, whatever the integrator: its error is that of the chain, not of time.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.moving_contact import contact_point
from ropewalk.model import Dynamic, Line, MovingForce, Scenario, Travel
from ropewalk.theory import selfsimilar

from .march import March, march

Array = np.ndarray


def measured(scenario: Scenario, times: Array, sharing: bool) -> tuple[March, Array]:
    """A motion and the path of its contact (time, axis)."""
    done = march(scenario, times, sharing)
    path = np.zeros((len(done.states), len(done.setting.axes)))
    for now, point in zip(done.states, path, strict=True):
        contact_point(done.setting.strands, done.setting.loads, now, 0, point)
    return done, path


def taut_string(elements: int, alpha: float) -> Scenario:
    """The string of the self-similar solution, EA = rho = 1, prestrain 0.05, F = 0.01 EA, from the middle."""
    speed = alpha * np.sqrt(0.05 / 1.05)
    return Scenario(
        gravity=0.0,
        lines={
            "string": Line(start=(0, 0), end=(2.1, 0), length=2.0, mass=1.0, axial_stiffness=1.0, elements=elements)
        },
        loads={
            "force": MovingForce(
                on="string", force=(0.0, -0.01), travel=Travel.model_validate({"speed": speed, "from": 1.0})
            )
        },
        run=Dynamic(until=0.95, every=0.95),
    )


def slack_rope(elements: int) -> Scenario:
    """The slack rope of the overview with Kelvin-Voigt damping of 50 N s, 800 N at 10 m/s."""
    return Scenario(
        lines={
            "rope": Line(
                start=(0, 0), end=(19.5, 0), length=20.0, mass=1.0, axial_stiffness=1e5, axial_damping=50.0,
                elements=elements,
            )
        },
        loads={"force": MovingForce(on="rope", force=(0.0, -800.0), travel=Travel(speed=10.0))},
        run=Dynamic(until=1.5, every=0.1, accuracy=1e-4),
    )  # fmt: skip


def self_similar(alpha: float = 0.46) -> None:
    """Print the error of the contact's velocity against the exact solution."""
    speed = alpha * np.sqrt(0.05 / 1.05)
    wave = selfsimilar.moving_force(
        force=0.01, speed=speed, axial_stiffness=1.0, mass=1.0, prestrain=0.05, contact="clamped"
    )
    print(f"\nTaut nonlinear string, U = {alpha} of the wave speed, against the exact solution: error of the contact's")
    print("horizontal velocity between 0.35 and 0.95 s, over what the nonlinearity adds to it")
    print(f"{'links':>6}{'riding':>12}{'CPU s':>9}{'sharing':>12}{'CPU s':>9}")
    for elements in (200, 400, 800, 1600, 3200):
        # All meshes see whole passages of nodes.
        h = 2.0 / elements
        times = np.round(np.array([0.35, 0.95]) * speed / h) * h / speed
        cells = []
        for sharing in (False, True):
            done, path = measured(taut_string(elements, alpha), times, sharing)
            way = (path[-1] - path[0])[0] / (times[-1] - times[0])
            miss = abs(way - wave.contact_velocity[0]) / abs(wave.contact_velocity[0] - 1.05 * speed)
            cells.append(f"{miss:12.1e}{done.seconds:9.3f}")
        print(f"{elements:6}" + "".join(cells))


def slack(finest: int = 800) -> None:
    """Print the error of contact path and node positions against a fine mesh."""
    times = np.arange(1, 16) * 0.1
    finely, reference = measured(slack_rope(finest), times, sharing=False)
    print(f"\nSlack rope with damping, t = 0.1 ... 1.5 s: rms error in m against {finest} links")
    print(f"{'links':>6}{'path':>9}{'nodes':>9}{'CPU s':>8}   riding   | sharing{'path':>9}{'nodes':>9}{'CPU s':>8}")
    for elements in (50, 100, 200):
        cells = []
        for sharing in (False, True):
            done, path = measured(slack_rope(elements), times, sharing)
            nodes = []
            for now, fine in zip(done.states, finely.states, strict=True):
                xi = np.arange(elements + 1) * float(done.setting.strands.h[0])
                there = np.array([np.interp(xi, fine.X, component) for component in fine.r])
                here = np.array([np.interp(xi, now.X, component) for component in now.r])
                nodes.append(np.sqrt(np.mean(np.sum((here - there) ** 2, axis=0))))
            rms = np.sqrt(np.mean(np.sum((path - reference) ** 2, axis=1)))
            cells.append(f"{rms:9.1e}{np.sqrt(np.mean(np.square(nodes))):9.1e}{done.seconds:8.3f}")
        print(f"{elements:6}{cells[0]}            |        {cells[1]}", flush=True)


def main() -> None:
    """Print both tables."""
    march(taut_string(20, 0.46), np.array([0.1]), sharing=False)  # compile, or load from the cache
    march(slack_rope(20), np.array([0.1]), sharing=False)
    self_similar()
    slack()
