"""Scenarios that several tests of the motion share."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.model import Dynamic, Line, MovingForce, Scenario, Travel


def taut_string(
    elements: int, alpha: float, passages: float, *, force: float = 1e-6, outputs: int = 4, **run: Any
) -> Scenario:
    """A string of tension 1 N and unit span that a small force passes at `alpha` times the wave speed.

    In the material coordinate the small motion is exactly that of a linear string of the length L0, the tension
    P / lam and the mass rho. `passages` is the duration over the time of one passage.
    """
    tension, stiffness, mass = 1.0, 1e3, 1.0
    lam = 1.0 + tension / stiffness
    length = 1.0 / lam
    speed = alpha * np.sqrt(tension / (lam * mass))
    until = passages * length / speed
    return Scenario(
        gravity=0.0,
        lines={
            "string": Line(
                start=(0.0, 0.0), end=(1.0, 0.0), length=length, mass=mass, axial_stiffness=stiffness, elements=elements
            )
        },
        loads={
            "force": MovingForce(on="string", force=(0.0, -force), travel=Travel(speed=speed, at_end="leave")),
        },
        run=Dynamic(until=until, every=until / outputs, **run),
    )


def long_string(elements: int, speed: float, contact: str, until: float, **run: Any) -> Scenario:
    """The string of the self-similar solution: EA = rho = 1, prestrain 0.05, a force of 0.01 EA from the middle.

    It is 2 m long, so that no wave returns from its boundaries from its ends before t = 1 s.
    """
    return Scenario(
        gravity=0.0,
        lines={
            "string": Line(
                start=(0.0, 0.0), end=(2.1, 0.0), length=2.0, mass=1.0, axial_stiffness=1.0, elements=elements
            )
        },
        loads={
            "force": MovingForce(
                on="string",
                force=(0.0, -0.01),
                travel=Travel.model_validate({"speed": speed, "from": 1.0}),
                contact=contact,
            )
        },
        run=Dynamic(until=until, every=until, **run),
    )


def slack_rope(elements: int, damping: float = 0.0, **changes: Any) -> Scenario:
    """The rope of the overview: 20 m between supports 19.5 m apart, and 800 N that travel at 10 m/s."""
    travel = {"speed": 10.0, "measured": "material", **changes.pop("travel", {})}
    load = {"on": "rope", "force": (0.0, -800.0), **changes.pop("load", {})}
    run = {"until": 1.0, "every": 0.1, **changes.pop("run", {})}
    line = {
        "start": (0.0, 0.0), "end": (19.5, 0.0), "length": 20.0, "mass": 1.0, "axial_stiffness": 1e5,
        "axial_damping": damping, "elements": elements, **changes.pop("line", {}),
    }  # fmt: skip
    return Scenario(
        lines={"rope": Line(**line)},
        loads={"walker": MovingForce(travel=Travel.model_validate(travel), **load)},
        run=Dynamic(**run),
        **changes,
    )


def order(sizes: list[float], errors: list[float]) -> float:
    """Observed order of convergence: the slope of log(error) over log(size)."""
    rate = float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])
    print(f"observed order {rate:.3f} from errors {errors}")
    return rate
