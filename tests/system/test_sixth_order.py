"""The sixth order of Blanes and Moan's method in all that stands and moves on lines, as far as contacts are smooth.

Where something damps it is that of Lobatto's method IIIC.

Source of the order: the same motion in a quarter of the smallest steps. Source of the motion in a mode: the
eigenvectors of stiffness and mass at rest.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg as linalg

from ropewalk.capabilities import ROPES, SYSTEM, engine_of
from ropewalk.model import Scenario
from ropewalk.results.frame import ENERGY_FORMS, RunInfo
from ropewalk.system.dynamics.moving import SystemMotion
from ropewalk.system.equilibrium.still import SystemStatics
from ropewalk.system.small_motion.spectrum import equations_of
from system_cases import frames_of, imbalance, line, scenario

SOFT = {"axial_stiffness": 10.0, "elements": 8}
UNTIL = 0.5
STANDS, GOES = {"speed": 0.0, "from": 0.3}, {"speed": 0.4, "from": 0.3}
YIELDS = {"start_support": {"kind": "elastic", "stiffness": [50.0, 50.0], "mass": 0.01}}


def force(travel: dict[str, Any]) -> dict[str, Any]:
    return {"on": "r", "kind": "force", "force": [0, -0.2], "travel": travel}


def mass(travel: dict[str, Any]) -> dict[str, Any]:
    return {"on": "r", "kind": "mass", "mass": 0.3, "travel": travel}


def oscillator(travel: dict[str, Any], wheel: float = 0.2) -> dict[str, Any]:
    wheel_mass = {"wheel_mass": wheel} if wheel else {}
    return {"on": "r", "kind": "oscillator", "mass": 0.3, "stiffness": 5.0, "travel": travel, **wheel_mass}


def moving(load: dict[str, Any] | None, steps: int, method: str = "rkn6", **keys: Any) -> Scenario:
    """A soft string with a load, in so many steps."""
    run = {"kind": "dynamic", "until": UNTIL, "every": UNTIL, "method": method, "step": UNTIL / steps * (1 + 1e-9)}
    run |= keys.pop("run", {})
    loads, more = {} if load is None else {"load": load}, {"gravity": keys.pop("gravity", 1.0), "run": run}
    if "wind_drag" in keys:
        more["wind"] = {"direction": [0.3, 1.0], "speed": 3.0}
    return scenario({"r": line(**{**SOFT, **keys})}, loads, UNTIL, UNTIL, **more)


def end_of(asked: Scenario) -> np.ndarray:
    """Where everything is at the end of a motion."""
    frame = frames_of(asked, np.array([0.0, UNTIL]))[-1]
    return np.concatenate([frame.position.ravel(), frame.body_position.ravel()])


MODE = {"start": {"kind": "mode", "amplitude": 0.1}}
SMOOTH: dict[str, tuple[Any, dict[str, Any]]] = {
    "free": (None, {"run": MODE}),
    "force that stands": (force(STANDS), {}),
    "mass that stands": (mass(STANDS), {}),
    "vehicle": (oscillator(STANDS), {}),
    "vehicle without wheel mass": (oscillator(STANDS, 0.0), {}),
    "support that yields": (force(STANDS), YIELDS),
    "force that moves, small motion": (force(GOES), {"run": {"geometry": "linearised"}}),
}


@pytest.mark.parametrize(("load", "keys"), SMOOTH.values(), ids=SMOOTH)
def test_the_order_is_the_sixth_where_forces_are_smooth(load: Any, keys: dict[str, Any]) -> None:
    """From 16 to 32 steps; beyond, errors come to the rounding. A moving force is four times differentiable."""
    exact = end_of(moving(load, 256, **keys))
    coarse, fine = (np.abs(end_of(moving(load, steps, **keys)) - exact).max() for steps in (16, 32))
    print(f"errors {coarse:.3g}, {fine:.3g}, order {np.log2(coarse / fine):.3f}")
    assert 5.9 < np.log2(coarse / fine) < 6.15


@pytest.mark.parametrize("load", [force(GOES), mass(GOES), oscillator(GOES)], ids=["force", "mass", "vehicle"])
@pytest.mark.parametrize("stiff", [{}, {"bending_stiffness": 0.02}], ids=["string", "stiff"])
def test_what_moves_along_is_far_better_than_with_verlet(load: Any, stiff: dict[str, Any]) -> None:
    """Parts of kinks in links are once differentiable: the error is of the second to the third order in the end.

    As many forces are found in 11 times as many steps of Verlet's method.
    """
    exact = end_of(moving(load, 256, **stiff))
    sixth = np.abs(end_of(moving(load, 16, **stiff)) - exact).max()
    second = np.abs(end_of(moving(load, 176, "verlet", **stiff)) - exact).max()
    print(f"rkn6 {sixth:.3g}, Verlet {second:.3g}")
    assert sixth < 6e-8  # what kinks leave over
    assert sixth < second / 100


def test_small_motion_follows_the_modes_of_the_spectrum() -> None:
    """A mode of the whole string, released, is a cosine in time, to the sixth order."""
    tree = {"r": line(**SOFT)}
    still = SystemStatics(scenario(tree, {}, 1.0, 1.0, run={"kind": "equilibrium"}), RunInfo(), 0.0, space=True)
    found = equations_of(still)
    K, M = found.stiffness.toarray(), found.mass.toarray()
    omega = np.sqrt(linalg.eigh(K, M, eigvals_only=True))
    run = {**MODE, "geometry": "linearised"}
    begin = frames_of(moving(None, 16, run=run, gravity=0.0), np.array([0.0, UNTIL]))
    shape = begin[0].position[:, 1] - found.position[:, 2]
    first = omega[np.abs(omega - np.pi).argmin()]
    missed = [
        np.abs(frames_of(moving(None, steps, run=run, gravity=0.0), np.array([0.0, UNTIL]))[-1].position[:, 1]
               - found.position[:, 2] - shape * np.cos(first * UNTIL)).max()
        for steps in (4, 8)
    ]  # fmt: skip
    print(missed)
    assert missed[1] < 1e-9
    assert 5.5 < np.log2(missed[0] / missed[1]) < 6.5


CAR: dict[str, Any] = {
    "on": "r", "kind": "vehicle", "bodies": {"box": {"mass": 0.2, "inertia": 0.01}},
    "wheels": {"front": {"at": 0.1, "mass": 0.05}, "rear": {"at": -0.1, "mass": 0.05}},
    "springs": {"a": {"between": ["box", "front"], "stiffness": 5.0},
                "b": {"between": ["box", "rear"], "stiffness": 5.0}},
}  # fmt: skip


def test_what_comes_and_leaves_does_so_between_two_steps() -> None:
    """The audit closes, and Verlet's method in small steps comes to the same."""
    car = CAR | {"travel": {"speed": 0.6, "from": 0.0, "at_end": "leave"}}
    times, run = np.linspace(0.0, 2.0, 11), {"until": 2.0, "every": 0.2}
    at = [frames_of(moving(car, steps, run=run, mass=0.5), times) for steps in (16, 32)]
    fine = frames_of(moving(car, 4096, "verlet", run=run, mass=0.5), times)
    assert np.isnan(at[0][0].contact_xi[1]) or at[0][0].contact_xi[1] < 0.0  # the rear wheel is still to come
    for coarse in at:
        away = max(np.abs(a.position - b.position).max() for a, b in zip(coarse, fine, strict=True))
        print(f"away {away:.3g}, imbalance {imbalance(coarse):.3g}, {imbalance(fine):.3g}")
        assert away < 1e-3
        assert imbalance(coarse) < 3e-3


def test_the_step_is_chosen_by_the_accuracy() -> None:
    """Ten times less of it takes the sixth root of ten more steps, and errors stay below what was asked for."""
    exact = end_of(moving(mass(STANDS), 256))
    for accuracy in (1e-3, 1e-6, 1e-9):
        asked = moving(mass(STANDS), 1, run={"step": None, "accuracy": accuracy})
        assert np.abs(end_of(asked) - exact).max() < accuracy


def test_energy_is_kept_to_the_order() -> None:
    frames = frames_of(moving(oscillator(STANDS), 32, run={"every": 0.1}), np.linspace(0.0, UNTIL, 6))
    assert max(abs(f.energy[ENERGY_FORMS.index("imbalance")]) for f in frames) < 1e-11


DAMPED: dict[str, tuple[Any, dict[str, Any]]] = {
    "Kelvin-Voigt damping": (None, {"axial_damping": 0.05, "run": MODE}),
    "the drag of lines": (force(STANDS), {"drag": 0.3}),
    "dampers at supports": (
        force(STANDS), {"start_support": {**YIELDS["start_support"], "damping": [2.0, 2.0]}, "axial_damping": 0.05}
    ),
    "dampers or the drag of loads": (oscillator(STANDS) | {"damping": 0.5}, {"axial_damping": 0.05}),
    "the same without wheel mass": (oscillator(STANDS, 0.0) | {"damping": 0.5}, {"axial_damping": 0.05}),
    "wind": (force(STANDS), {"wind_drag": 0.5}),
    "damped, small motion": (oscillator(STANDS) | {"damping": 0.5}, {"drag": 0.3, "run": {"geometry": "linearised"}}),
}  # fmt: skip


@pytest.mark.parametrize(("load", "keys"), DAMPED.values(), ids=DAMPED)
def test_the_order_is_the_sixth_where_something_damps(load: Any, keys: dict[str, Any]) -> None:
    """From 16 to 32 steps; the method of order 5, which is another one, comes to the same."""
    coarse_run = {**keys.get("run", {}), "accuracy": 1.0}
    exact, coarse, fine = (end_of(moving(load, n, **{**keys, "run": coarse_run})) for n in (160, 16, 32))
    errors = [float(np.abs(one - exact).max()) for one in (coarse, fine)]
    other = end_of(moving(load, 96, "implicit", **{**keys, "run": coarse_run}))
    print(f"errors {errors}, order {np.log2(errors[0] / errors[1]):.3f}, other {np.abs(other - exact).max():.3g}")
    assert 5.7 < np.log2(errors[0] / errors[1]) < 6.15
    assert np.abs(other - exact).max() < errors[0]


def test_a_damped_mode_is_a_damped_cosine() -> None:
    """Small motion of the whole string with drag gamma: exp(-gamma t/2) (cos w t + gamma/2w sin w t)."""
    gamma = 0.8
    still = SystemStatics(
        scenario({"r": line(**SOFT)}, {}, 1.0, 1.0, run={"kind": "equilibrium"}), RunInfo(), 0.0, space=True
    )
    found = equations_of(still)
    omega = np.sqrt(linalg.eigh(found.stiffness.toarray(), found.mass.toarray(), eigvals_only=True))
    first = omega[np.abs(omega - np.pi).argmin()]
    run, w = {**MODE, "geometry": "linearised", "accuracy": 1.0}, np.sqrt(first**2 - 0.25 * gamma**2)
    factor = np.exp(-0.5 * gamma * UNTIL) * (np.cos(w * UNTIL) + 0.5 * gamma / w * np.sin(w * UNTIL))
    missed = []
    for steps in (8, 16):
        begin, end = frames_of(moving(None, steps, run=run, gravity=0.0, drag=gamma), np.array([0.0, UNTIL]))
        away = [frame.position[:, 1] - found.position[:, 2] for frame in (begin, end)]
        missed.append(np.abs(away[1] - away[0] * factor).max())
    print(missed, np.log2(missed[0] / missed[1]))
    assert missed[1] < 1e-11
    assert 5.7 < np.log2(missed[0] / missed[1]) < 6.3


REFUSED = {
    "free travel": mass({"kind": "free", "from": 0.3}),
    "travel that is measured as horizontal": mass({"speed": 1.0, "measured": "horizontal"}),
    "contacts that come off": mass(GOES) | {"lift_off": True},
}


@pytest.mark.parametrize(("feature", "load"), REFUSED.items(), ids=REFUSED)
def test_what_jumps_is_refused(feature: str, load: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=f"rkn6 with {feature} is not implemented"):
        moving(load, 16, bending_stiffness=0.02)


LIMP = {"axial_damping": {"axial_damping": 0.05, "foundation": 0.5}, "wind": {"wind_drag": 0.5, "axial_damping": 0.05}}


@pytest.mark.parametrize("method", ["rkn6", "implicit"])
@pytest.mark.parametrize("keys", LIMP.values(), ids=LIMP)
def test_a_force_on_a_damped_rope_takes_no_shorter_steps_than_a_mass(method: str, keys: dict[str, Any]) -> None:
    """Its place has neither mass nor stiffness, and no speed that a step begins with: else its error is all of that.

    With it steps went down to 1e-6 of this. The other method in small steps comes to the same.
    """
    steps, ends = [], []
    for load in (force(GOES), mass(GOES)):
        asked = moving(load, 1, method, **keys, run={"step": None, "accuracy": 1e-5})
        run_info = RunInfo()
        motion = SystemMotion(asked, run_info, np.array([0.0, UNTIL]))
        assert motion.advance(1) is None
        steps.append(run_info.steps)
        ends.append(motion.state.r[:, motion.displayed].T.ravel())
    other = {"rkn6": "implicit", "implicit": "rkn6"}[method]
    fine = end_of(moving(force(GOES), 160, other, **keys, run={"accuracy": 1.0}))
    print(steps, np.abs(ends[0] - fine[: ends[0].size]).max())
    assert steps[0] < 2 * steps[1] + 20
    assert np.abs(ends[0] - fine[: ends[0].size]).max() < 1e-5


def test_ropes_with_masses_go_to_the_engine_that_bears_them() -> None:
    assert engine_of(moving(mass(GOES), 16)) is SYSTEM
    assert engine_of(moving(force(GOES), 16)) is ROPES
    assert engine_of(moving(mass(GOES), 16, "verlet")) is ROPES
