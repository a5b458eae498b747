"""Lines that give back less than they take: springs and sliders beside their laws."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import ropewalk
from ropewalk.model import Line, Scenario
from ropewalk.simulate import simulate

G = 9.81
EA = 1e4 / 0.18  # N, pinkTube
K, SHARE = 60e3, 0.1  # N, of the spring; half of what is lost of a ratio of 0.8
HALF = SHARE * EA  # N, by which the bound of friction grows with the strain
WEBBING = {"law": {"kind": "webbing", "name": "pinkTube"}, "hysteresis": {"ratio": 0.8, "stiffness": K}}
AS_TABLE = {
    "law": {"kind": "table", "strain": [0.0, 0.03, 0.1], "tension": [0.0, 0.03 * EA, 0.1 * EA]},
    "hysteresis": {"unloading": [0.0, 0.024 * EA, 0.08 * EA], "stiffness": K},
}


def pulled(low: float, high: float, law: dict[str, Any], *, until: float = 2.0, way: float = 0.0) -> Scenario:
    """A webbing of 10 m without weight that is pulled to and fro between two strains, each second once."""
    t = np.linspace(0.0, until, 101)
    u = 5.0 * (high - low) * (1.0 - np.cos(2.0 * np.pi * t))
    far = [10.0 * (1.0 + low), 0.0, 0.0] if way else [10.0 * (1.0 + low), 0.0]
    ahead = np.array([1.0, way, 0.0] if way else [1.0, 0.0])
    line = {
        "start": [0.0] * len(far), "end": far, "length": 10.0, "mass": 0.02, "elements": 2, "drag": 5.0, **law,
        "end_support": {
            "kind": "moving", "displacement": {"time": t.tolist(), "value": [(d * ahead).tolist() for d in u]}
        },
    }  # fmt: skip
    run = {"kind": "dynamic", "until": until, "every": 0.02}
    return Scenario.model_validate({"gravity": 0.0, "lines": {"webbing": line}, "run": run})


@pytest.mark.parametrize("law", [WEBBING, AS_TABLE])
def test_what_a_cycle_loses_is_the_area_of_its_loop(law: dict[str, Any]) -> None:
    """Corners in strain and force on the slider: q = f = b e when loading is over, from where it falls by k to -f."""
    low, high = 0.02, 0.06
    run = simulate(pulled(low, high, law))
    x = np.array([high, high * (K - HALF) / (K + HALF), low, low * (K + HALF) / (K - HALF)])
    y = HALF * x * [1.0, -1.0, -1.0, 1.0]
    area = 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    lost = run.energy.sel(form="hysteresis").to_numpy()
    assert lost[100] - lost[50] == pytest.approx(10.0 * area, rel=1e-3)  # waves along it
    tension, strain = run.tension.to_numpy()[:, 0], run.strain.to_numpy()[:, 0]
    assert tension[:25] == pytest.approx(EA * strain[:25], rel=1e-9)  # loading follows the law
    assert tension[[49, 99]] == pytest.approx(0.8 * EA * strain[[49, 99]], rel=1e-9)
    assert float(abs(run.energy.sel(form="imbalance")).max()) < 1e-3 * lost[-1]


def test_what_does_not_slip_loses_nothing_and_is_stiffer() -> None:
    """Between the curves it goes to and fro by the slope of their mean and the spring."""
    low, high = 0.05, 0.052
    run = simulate(pulled(low, high, WEBBING))
    lost = run.energy.sel(form="hysteresis").to_numpy()
    assert lost[25] > 0.0  # loading slips
    assert lost[100] == pytest.approx(lost[30], rel=1e-3)  # but for waves along it, which turn a little elsewhere
    tension, strain = run.tension.to_numpy()[30:, 0], run.strain.to_numpy()[30:, 0]
    slope = np.polyfit(strain, tension, 1)[0]
    assert slope == pytest.approx((1.0 - SHARE) * EA + K, rel=1e-4)


def stroke(e: float, q: float, to: float) -> tuple[float, float]:
    """Work per unstrained length of a stroke from strain e with the force q on the slider, N, and that behind it."""

    def friction(x: float) -> float:
        return min(q + K * (x - e), HALF * x) if to > e else max(q + K * (x - e), -HALF * x)

    corner = float(np.clip((K * e - q) / (K - HALF) if to > e else (K * e - q) / (K + HALF), *sorted((e, to))))
    work = quad(friction, e, corner)[0] + quad(friction, corner, to)[0]
    return work + 0.5 * (1.0 - SHARE) * EA * (to**2 - e**2), friction(to)


def test_a_person_who_is_set_on_a_line_bounces_less_and_less_by_the_areas_of_loops() -> None:
    """Where it turns, the fall of the weight is the work of the stroke; the webbing weighs 1 % of the person."""
    span, length, mass = 40.0, 39.0, 60.0
    line = {"start": [0, 0], "end": [span, 0], "length": length, "mass": 0.015, "elements": 8, **WEBBING}
    load = {"kind": "mass", "on": "webbing", "mass": mass, "travel": {"speed": 0.0, "from": 0.5 * length}}
    run = {"kind": "dynamic", "until": 9.0, "every": 0.02}
    found = simulate(Scenario.model_validate({"lines": {"webbing": line}, "loads": {"person": load}, "run": run}))
    z = found.contact_position.sel(axis="z").to_numpy()[:, 0]
    turns = z[1:-1][(z[1:-1] - z[:-2]) * (z[2:] - z[1:-1]) <= 0.0]

    def strain(depth: float) -> float:
        return float(np.hypot(span, 2.0 * depth)) / length - 1.0

    at, q, expected = -float(z[0]), HALF * strain(-z[0]), list[float]()
    for down in (True, False) * 3:

        def missed(depth: float, at: float = at, q: float = q) -> float:
            return (mass + 0.5 * 0.015 * length) * G * (depth - at) - length * stroke(strain(at), q, strain(depth))[0]

        new = float(brentq(missed, at + 0.3, 15.0) if down else brentq(missed, 0.05, at - 0.3))
        q, at = stroke(strain(at), q, strain(new))[1], new
        expected.append(-at)
    assert turns[:6] == pytest.approx(expected, rel=5e-3)
    swing = np.abs(np.diff(turns[:6]))
    assert swing[2] < 0.8 * swing[0]


def test_it_is_the_same_in_space_and_goes_on_from_where_it_was(tmp_path: Any) -> None:
    flat = simulate(pulled(0.02, 0.06, WEBBING, until=1.0))
    spatial = simulate(pulled(0.02, 0.06, WEBBING, until=1.0, way=1e-9))
    assert spatial.tension.to_numpy() == pytest.approx(flat.tension.to_numpy(), rel=1e-9)
    scenario = pulled(0.02, 0.06, WEBBING, until=1.0)
    half = scenario.model_copy(update={"run": scenario.run.model_copy(update={"until": 0.6})})
    simulate(half, file=tmp_path / "half.nc")
    on = ropewalk.resume(tmp_path / "half.nc", until=1.0)
    assert on.tension.to_numpy()[-1] == pytest.approx(flat.tension.to_numpy()[-1], rel=1e-9)
    assert float(on.energy.sel(form="hysteresis")[-1]) == pytest.approx(
        float(flat.energy.sel(form="hysteresis")[-1]), rel=1e-9
    )


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"hysteresis": {"stiffness": K}}, "there is no curve of unloading"),
    ({"hysteresis": {"ratio": 1.2, "stiffness": K}}, "would not be below the loading tension"),
    ({"hysteresis": {"ratio": 0.8, "unloading": [0, 1, 2], "stiffness": K}}, "exclude each other"),
    ({"hysteresis": {"unloading": [0, 1, 2], "stiffness": K}}, "at the strains of a table"),
    ({"hysteresis": {"ratio": 0.2, "stiffness": "1 kN"}}, "loading would not follow the law"),
    ({**AS_TABLE, "hysteresis": {"unloading": [0, 1e9, 2e9], "stiffness": K}}, "would exceed the loading tension"),
    ({**AS_TABLE, "hysteresis": {"unloading": [0, 1], "stiffness": K}}, "do not go with 3 strains"),
    ({**AS_TABLE, "hysteresis": {"unloading": [0, -1, 0], "stiffness": K}}, "the line would be in compression"),
    ({"law": {"kind": "polynomial", "coefficients": [1e5]}}, "write the law as a table"),
    ({"law": {"kind": "webbing"}}, "there is no stretch at 10 kN"),
    ({"law": {"kind": "webbing", "stretch": 0.1, "name": "pinkTube"}}, "exclude each other"),
    ({"axial_stiffness": 1e5}, "has a stiffness of its own"),
]


@pytest.mark.parametrize(("change", "message"), WRONG)
def test_what_does_not_fit_together_is_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Line.model_validate({"start": [0, 0], "end": [9, 0], "length": 9.0, "mass": 0.1, **WEBBING, **change})


@pytest.mark.parametrize(
    "run",
    [{"kind": "linear", "until": 1}, {"kind": "dynamic", "until": 1, "geometry": "linearised"},
     {"kind": "dynamic", "until": 1, "window": 5.0}],
)  # fmt: skip
def test_runs_that_do_not_follow_the_history_of_strain_are_refused(run: dict[str, Any]) -> None:
    line = {"start": [0, 0], "end": [10, 0], "length": 9.9, "mass": 0.1, **WEBBING}
    load = {"kind": "force", "on": "webbing", "force": [0, -10], "travel": {"speed": 1.0}}
    with pytest.raises(ValueError, match="hysteresis"):
        Scenario.model_validate({"lines": {"webbing": line}, "loads": {"f": load}, "run": run})


# Slow motion ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("positions", [4, 31])
@pytest.mark.parametrize("law", [WEBBING, AS_TABLE])
def test_a_slow_pull_to_and_fro_follows_the_curves_of_loading_and_unloading(
    law: dict[str, Any], positions: int
) -> None:
    """Whatever the steps, if they end where it turns: T = EA e; then T = (EA - b) e + q, q from b e by k to -b e."""
    table = {"time": [0.0, 1.0, 2.0, 3.0], "value": [[0.0, 0.0], [0.4, 0.0], [0.0, 0.0], [0.2, 0.0]]}
    line = {
        "start": [0.0, 0.0], "end": [10.2, 0.0], "length": 10.0, "mass": 0.02, "elements": 4, **law,
        "end_support": {"kind": "moving", "displacement": table},
    }  # fmt: skip
    slow = {"kind": "force", "on": "webbing", "force": [0.0, -1e-6], "travel": {"speed": 3.0, "from": 1.0}}
    tree = {"gravity": 0.0, "lines": {"webbing": line}, "loads": {"slow": slow}}
    run = simulate(Scenario.model_validate({**tree, "run": {"kind": "quasistatic", "positions": positions}}))
    strain, q, wanted = run.strain.to_numpy()[:, 0], HALF * 0.02, []
    for e, before in zip(strain, [0.02, *strain], strict=False):
        q = float(np.clip(q + K * (e - before), -HALF * e, HALF * e))
        wanted.append((EA - HALF) * e + q)
    assert strain[[0, (positions - 1) // 3, -1]] == pytest.approx([0.02, 0.06, 0.04], rel=1e-9)
    assert run.tension.to_numpy()[:, 0] == pytest.approx(wanted, rel=1e-8)
    assert wanted[2 * (positions - 1) // 3] == pytest.approx(0.8 * EA * 0.02)  # it has come down to the lower curve


def test_a_load_that_goes_slowly_over_webbing_leaves_it_as_a_motion_without_waves_does() -> None:
    """By steps of time, under much drag: behind the middle the webbing has been let off, and hangs deeper."""
    line = {"start": [0.0, 0.0], "end": [19.0, 0.0], "length": 18.5, "mass": 0.05, "elements": 20, **WEBBING}
    load = {"kind": "force", "on": "slackline", "force": [0.0, -700.0], "travel": {"speed": 1.0, "from": 1.0}}
    tree: dict[str, Any] = {"gravity": 0.0, "lines": {"slackline": line}, "loads": {"load": load}}
    slow = simulate(Scenario.model_validate({**tree, "run": {"kind": "quasistatic", "positions": 71}}))
    tree["lines"] = {"slackline": {**line, "drag": 20.0}}
    run = {"kind": "dynamic", "until": 16.0, "every": 0.25, "start": {"with_loads": True}}
    moved = simulate(Scenario.model_validate({**tree, "run": run}))
    x, z = (moved.contact_position.to_numpy()[:, 0, a] for a in (0, 1))
    at, depth = (slow.contact_position.to_numpy()[:, 0, a] for a in (0, 1))
    far = np.abs(np.interp(x, at, depth) - z)[4:]
    print(far.max(), depth.min(), np.interp([6.0, 13.0], at, depth))
    assert far.max() < 5e-3
