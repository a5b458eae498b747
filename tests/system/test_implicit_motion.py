"""The implicit method of order 5 in all that moves with dampers.

Sources: the same motion in smaller steps, that of Verlet's method, and for small motion the exponential of the matrix
of M r'' + C r' + K r = 0 about rest.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg as linalg

from ropewalk.capabilities import ROPES, SYSTEM, engine_of
from ropewalk.model import Scenario
from ropewalk.results.frame import ENERGY_FORMS, RunInfo
from ropewalk.results.running import TimeHistory
from ropewalk.system.dynamics.moving import SystemMotion
from ropewalk.system.equilibrium.still import SystemStatics
from ropewalk.system.small_motion.spectrum import equations_of
from system_cases import frames_of, line, scenario

DAMPED: dict[str, Any] = {"axial_stiffness": 10.0, "elements": 8, "axial_damping": 0.05}
YIELDS = {"start_support": {"kind": "elastic", "stiffness": [50.0, 50.0], "damping": [2.0, 2.0], "mass": 0.01}}
MODE = {"start": {"kind": "mode", "amplitude": 0.1}}
STANDS, GOES = {"speed": 0.0, "from": 0.3}, {"speed": 0.4, "from": 0.3}
UNTIL = 0.5
IMBALANCE = ENERGY_FORMS.index("imbalance")


def force(travel: dict[str, Any]) -> dict[str, Any]:
    return {"on": "r", "kind": "force", "force": [0, -0.2], "travel": travel}


def oscillator(travel: dict[str, Any], **keys: Any) -> dict[str, Any]:
    own = {"kind": "oscillator", "mass": 0.3, "stiffness": 5.0, "damping": 0.5}
    return {"on": "r", **own, "travel": travel, **keys}


def moving(load: dict[str, Any] | None, steps: float, method: str = "implicit", **keys: Any) -> Scenario:
    """A soft, damped string with a load, in so many steps, however accurate they are."""
    run = {"kind": "dynamic", "until": UNTIL, "every": UNTIL, "method": method, "step": UNTIL / steps * (1 + 1e-9)}
    run |= ({"accuracy": 1.0} if method == "implicit" else {}) | keys.pop("run", {})
    loads, more = {} if load is None else {"load": load}, {"gravity": keys.pop("gravity", 1.0), "run": run}
    if "wind_drag" in keys:
        more["wind"] = {"direction": [0.3, 1.0], "speed": 3.0}
    return scenario({"r": line(**{**DAMPED, **keys})}, loads, UNTIL, UNTIL, **more)


def end_of(asked: Scenario) -> tuple[np.ndarray, float]:
    """Where everything is at the end of a motion, and what its audit misses, J."""
    frame = frames_of(asked, np.array([0.0, UNTIL]))[-1]
    return np.concatenate([frame.position.ravel(), frame.body_position.ravel()]), abs(float(frame.energy[IMBALANCE]))


SMOOTH: dict[str, tuple[Any, dict[str, Any]]] = {
    "free": (None, {"run": MODE}),
    "force, support with a damper": (force(STANDS), YIELDS),
    "oscillator": (oscillator(STANDS, wheel_mass=0.2), {"drag": 0.3}),
    "oscillator without wheel mass": (oscillator(STANDS), {}),
    "wind": (force(STANDS), {"wind_drag": 0.5, "axial_damping": 0.0}),
    "stiff": (oscillator(STANDS), {"bending_stiffness": 0.02}),
}


@pytest.mark.parametrize(("load", "keys"), SMOOTH.values(), ids=SMOOTH)
def test_the_order_is_the_fifth_and_the_audit_closes(load: Any, keys: dict[str, Any]) -> None:
    """Verlet's method comes to the same; with strains as differences in time it is of the first order where they damp.

    It finds contacts without mass as if links above them were not damped, and misses 3e-5 of it.
    """
    exact, _ = end_of(moving(load, 192, **keys))
    (coarse, missed), (fine, less) = (end_of(moving(load, steps, **keys)) for steps in (24, 48))
    errors = [float(np.abs(one - exact).max()) for one in (coarse, fine)]
    other, _ = end_of(moving(load, 4096, "verlet", **keys))
    away = float(np.abs(other - exact).max())
    order = np.log2(errors[0] / errors[1])
    print(f"errors {errors}, order {order:.3f}, Verlet {away:.3g}, audit {missed:.3g}, {less:.3g}")
    assert 4.7 < order < 5.2
    assert away < 5e-5
    assert less < 3e-7  # of a sudden force on what is damped, by any method


def test_small_motion_is_the_exponential_of_its_matrix() -> None:
    keys = {**YIELDS, "drag": 0.3}
    still = SystemStatics(
        scenario({"r": line(**{**DAMPED, **keys})}, {}, 1.0, 1.0, run={"kind": "equilibrium"}),
        RunInfo(),
        0.0,
        space=True,
    )
    found = equations_of(still)
    K, M, C = (matrix.toarray() for matrix in (found.stiffness, found.mass, found.damping))
    run = {**MODE, "geometry": "linearised"}
    frames = frames_of(moving(None, 32, run=run, gravity=0.0, **keys), np.array([0.0, UNTIL]))
    moves = found.moves.toarray()
    begin, end = (np.insert(frame.position, 1, 0.0, axis=1) - found.position for frame in frames)
    assert np.abs(begin).max() > 0.05
    first = np.linalg.lstsq(moves, begin.ravel(), rcond=None)[0]
    n = first.size
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    then = (linalg.expm(A * UNTIL) @ np.concatenate([first, np.zeros(n)]))[:n]
    missed = np.abs(moves @ then - end.ravel()).max()
    print(missed)
    assert missed < 1e-9


def test_what_moves_along_agrees_with_small_steps_of_verlet() -> None:
    """Parts of kinks in links are once differentiable: of the second order there, from errors of 1e-6 on."""
    for load in (force(GOES), oscillator(GOES, wheel_mass=0.2)):
        here, missed = end_of(moving(load, 24))
        there, _ = end_of(moving(load, 8192, "verlet"))
        print(np.abs(here - there).max(), missed)
        assert np.abs(here - there).max() < 2e-6
        assert missed < 2e-6


def test_strong_damping_takes_few_steps() -> None:
    """Explicit steps are as short as rho h^2 / 2 c; the tolerance that is asked for is kept."""
    strong = {"axial_damping": 50.0, "elements": 32, "run": {"step": None, "accuracy": 1e-4, **MODE}}
    run_info, times = RunInfo(), np.array([0.0, UNTIL])
    found = list(TimeHistory(SystemMotion(moving(None, 1, **strong), run_info, times), run_info).frames())[-1]
    assert run_info.outcome == "running"
    explicit = RunInfo()
    SystemMotion(moving(None, 1, "verlet", **{**strong, "run": {"step": None, **MODE}}), explicit, times)
    exact, _ = end_of(moving(None, 64, **{**strong, "run": MODE}))
    print(run_info.steps, UNTIL / explicit.step)
    assert run_info.steps < UNTIL / explicit.step / 100
    assert np.abs(found.position.ravel() - exact).max() < 1e-4


def test_loads_leave_between_steps() -> None:
    car = oscillator({"speed": 0.8, "from": 0.7, "at_end": "leave"}, wheel_mass=0.2)
    here, missed = end_of(moving(car, 48, axial_damping=0.5))
    there, _ = end_of(moving(car, 4096, "verlet", axial_damping=0.5))
    print(np.abs(here - there).max(), missed)
    assert np.abs(here - there).max() < 2e-2  # its kink straightens at once, and not within a hundredth of a second
    assert missed < 2e-4


@pytest.mark.parametrize(
    ("feature", "load"),
    {
        "free travel": oscillator({"kind": "free", "from": 0.3}, wheel_mass=0.2),
        "contacts that come off": oscillator(GOES, wheel_mass=0.2, lift_off=True),
        "travel that is measured as arc": oscillator({"speed": 1.0, "measured": "arc"}),
        "a load with a controller": {
            "on": "r", "kind": "footsteps", "mass": 0.1, "step_length": 0.1, "frequency": 1.0,
        },
    }.items(),
)  # fmt: skip
def test_what_jumps_is_refused(feature: str, load: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=f"implicit with {feature} is not implemented"):
        moving(load, 16, bending_stiffness=0.02)


def test_ropes_with_masses_go_to_the_engine_that_bears_them() -> None:
    assert engine_of(moving(oscillator(GOES), 16)) is SYSTEM
    assert engine_of(moving(force(GOES), 16)) is ROPES
