"""A stand-in for a solver: frames made from formulas, a tent that travels with its load along a sagging line."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ropewalk.model import Scenario
from ropewalk.results.frame import ENERGY_FORMS, Frame, Layout, RunInfo

SPAN, SAG, FORCE, SPEED, UNTIL = 19.5, 2.5, 800.0, 10.0, 1.8


def scenario(title: str = "Moving force on a slack rope", load: bool = True) -> Scenario:
    travel = {"speed": SPEED, "measured": "slip", "from": 0.0}
    walker = {"kind": "force", "on": "rope", "force": [0.0, -FORCE], "travel": travel}
    rope = {"start": [0.0, 0.0], "end": [SPAN, 0.0], "length": 20.0, "mass": 1.0, "axial_stiffness": 1e5}
    return Scenario.model_validate(
        {
            "title": title,
            "lines": {"rope": rope},
            "loads": {"walker": walker} if load else {},
            "run": {"kind": "dynamic", "until": UNTIL, "every": 0.01},
        }
    )


def layout(links: int = 40, loads: tuple[str, ...] = ("walker",), path: str = "time", axes: str = "xz") -> Layout:
    xi = np.linspace(0.0, 20.0, links + 1)
    return Layout(
        axes=tuple(axes),
        node_line=("rope",) * (links + 1),
        node_xi=xi,
        link_line=("rope",) * links,
        link_xi=(xi[1:] + xi[:-1]) / 2,
        contact_load=loads,
        support=("rope.start", "rope.end"),
        path=path,
    )


def run_info() -> RunInfo:
    return RunInfo(method="rkn6", reason="undamped, largest frequency 3.1e3 1/s", step=5e-4, steps=3600)


def _shape(x: np.ndarray, at: float) -> np.ndarray:
    """Height of the line at x while the load is at `at`: a parabola that the load draws into a tent."""
    depth = 4 * SAG * at * (SPAN - at) / SPAN**2
    tent = np.where(x < at, x / max(at, 1e-9), (SPAN - x) / max(SPAN - at, 1e-9))
    ripple = 0.08 * np.sin(6 * np.pi * x / SPAN) * np.sin(0.9 * at)
    return -0.6 * 4 * x * (SPAN - x) / SPAN**2 - depth * tent + ripple


def frames(plan: Layout, times: np.ndarray | None = None) -> Iterator[Frame]:
    """Frames at `times` (s); the load is off the line before the start and behind the end."""
    times = np.linspace(0.0, UNTIL, 181) if times is None else times
    here = plan.node_xi / plan.node_xi[-1] * SPAN
    for time in times:
        yield _frame(plan, here, float(time))


def _frame(plan: Layout, x: np.ndarray, time: float) -> Frame:
    at = SPEED * time + 0.2
    z = _shape(x, at)
    rate = (_shape(x, at + 1e-4) - z) / 1e-4 * SPEED
    middle = plan.link_xi / plan.link_xi[-1] * SPAN
    tension = 1500 + 900 * np.sin(np.pi * at / SPAN) + np.where(middle < at, 120.0, -120.0) + 15 * middle
    height = float(_shape(np.array([at]), at)[0])
    hold = 60.0 * np.cos(np.pi * at / SPAN)
    contacts, plane = len(plan.contact_load), plan.axes.index("z")

    def vector(rows: int, across: object, up: object) -> np.ndarray:
        out = np.zeros((rows, len(plan.axes)))
        out[:, 0], out[:, plane] = across, up
        return out

    off = np.nan if not 0.0 < at < SPAN else 1.0
    kinetic = 0.5 * float(np.mean(rate**2)) * 20.0
    gravity = 9.81 * 20.0 * float(np.mean(z))
    elastic = 40.0 + 30.0 * np.sin(np.pi * at / SPAN)
    work = kinetic + gravity + elastic + 10 * time - 20 * time
    known = kinetic, elastic, gravity, 10 * time, work, 20 * time
    return Frame(
        path=time,
        position=vector(len(x), x, z),
        velocity=vector(len(x), 0.0, rate),
        tension=tension,
        strain=tension / 1e5,
        contact_position=vector(contacts, at, height) * off,
        contact_force=vector(contacts, hold, -FORCE) * off,
        hold_force=vector(contacts, hold, 0.0) * off,
        contact_xi=np.full(contacts, at / SPAN * 20.0) * off,
        contact_friction=np.zeros(contacts) * off,
        contact_state=np.full(contacts, 3.0 if off == 1.0 else 0.0),
        contact_in_air=np.zeros(contacts),
        friction_power=np.zeros(contacts),
        body_position=np.zeros((0, len(plan.axes))),
        body_velocity=np.zeros((0, len(plan.axes))),
        contact_speed=np.full(contacts, SPEED) * off,
        contact_tension=np.full((contacts, 2), [1620.0, 1380.0]) * off,
        reaction=vector(2, [-tension[0], tension[-1]], [300.0, 400.0 + 100 * time]),
        energy=np.array([*known, *np.zeros(len(ENERGY_FORMS) - len(known) - 1), 0.02 * np.sin(9 * time)]),
    )
