"""Runs of kind linear: the closed forms through the pipeline, and the nonlinear chain in the limit of small forces.

Reference numbers of the taut string in units FL/P and L/c: alpha = V/c = 0.5, Vt = 0.75 L, x = 0.6 L: 1/3; free motion,
Vt = 1.6 L, x = 0.3 L: 2/15; alpha = 1.3: 0.217391304347826.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.errors import EquilibriumError, RopewalkError
from ropewalk.model import Dynamic, ForceTable, Line, Linear, MovingForce, Scenario, SpeedTable, Travel
from ropewalk.simulate import simulate
from ropewalk.theory import beam

F = 1e-3


def string(**changed: Any) -> Line:
    given: dict[str, Any] = {"start": (0.0, 0.0), "end": (1.0, 0.0), "tension": 1.0, "mass": 1.0,
                             "axial_stiffness": 1e8, "elements": 100}  # fmt: skip
    return Line(**(given | changed))


def force(speed: Any, size: Any = (0.0, -F), **more: Any) -> MovingForce:
    contact = more.pop("contact", "clamped")
    travel = Travel(speed=speed, measured="horizontal", at_end=more.pop("at_end", "leave"), **more)
    return MovingForce(on="string", force=size, travel=travel, contact=contact)


def linear(line: Line, *loads: MovingForce, until: float = 2.0, gravity: float = 0.0, **run: Any) -> xr.Dataset:
    named = {f"load {k}": one for k, one in enumerate(loads)}
    run = {"until": until, "every": 0.05} | run
    return simulate(Scenario(gravity=gravity, lines={"string": line}, loads=named, run=Linear(**run)))


def deflection(result: xr.Dataset, time: float, x: float) -> float:
    """In units F L / P."""
    at = result.sel(time=time, method="nearest")
    assert float(at.time) == pytest.approx(time, abs=1e-12)
    node = round(x * 100)
    return -float(at.position.sel(axis="z")[node]) / F


@pytest.mark.parametrize(
    ("alpha", "time", "x", "exact"),
    [(0.5, 1.5, 0.6, 1.0 / 3.0), (0.5, 3.2, 0.3, 2.0 / 15.0), (1.3, 0.75 / 1.3, 0.6, 0.217391304347826)],
)
def test_the_closed_form_of_the_taut_string(alpha: float, time: float, x: float, exact: float) -> None:
    result = linear(string(), force(alpha), until=time, every=time / 4.0)
    assert deflection(result, time, x) == pytest.approx(exact, rel=3e-6)  # the chain's wave speed, found from its rest


def test_a_load_from_the_far_end_is_the_mirror_image() -> None:
    there, back = linear(string(), force(0.5)), linear(string(), force(-0.5, start=1.0))
    assert back.position.sel(axis="z").values == pytest.approx(there.position.sel(axis="z").values[:, ::-1], abs=1e-12)


def test_loads_superpose() -> None:
    one, other = force(0.5), force(0.3, (0.0, -2.0 * F), start=0.4)
    both = linear(string(), one, other).position.sel(axis="z").values
    parts = [linear(string(), each).position.sel(axis="z").values for each in (one, other)]
    assert both == pytest.approx(parts[0] + parts[1], abs=1e-15)


def test_a_table_of_constant_values_is_the_constant() -> None:
    table = ForceTable(time=(0.0, 5.0), value=((0.0, -F), (0.0, -F)))
    plain = linear(string(), force(0.5), until=1.9)
    for load in (force(0.5, table), force(SpeedTable(time=(0.0, 5.0), value=(0.5, 0.5)))):
        assert linear(string(), load, until=1.9).position.values == pytest.approx(plain.position.values, abs=1e-12)


def test_the_published_number_of_modes_misses_half_of_the_deflection() -> None:
    """ "Walking the Line", Fig. 5: 49 modes at 0.9999 c give 0.220613 of 0.450022501 F L/P under the load at 0.9 L."""
    time = 0.9 / 0.9999
    exact, modal = (
        -float(linear(string(elements=10), force(0.9999), until=time, every=time, modes=m).contact_position[-1, 0, 1])
        for m in (None, 49)
    )
    assert exact / F == pytest.approx(0.450022501125, rel=3e-6)
    assert modal / F == pytest.approx(0.220613, abs=2e-6)


@pytest.mark.parametrize("alpha", [0.5, 1.4])
def test_the_nonlinear_chain_in_the_limit_of_small_forces(alpha: float) -> None:
    """Riding below the wave speed, shared above; both converge with the first order at the kink."""
    gaps = []
    for n in (50, 100, 200):
        line = Line(start=(0.0, 0.0), end=(1.0, 0.0), tension=1.0, mass=1.0, axial_stiffness=100.0, elements=n)
        loads = {
            "load": MovingForce(on="string", force=(0.0, -1e-5), travel=Travel(speed=alpha, measured="horizontal"))
        }
        both = [
            simulate(Scenario(gravity=0.0, lines={"string": line}, loads=loads, run=run)).position.values[-1]
            for run in (Dynamic(until=0.6 / alpha, every=0.6 / alpha, accuracy=1e-9), Linear(until=0.6 / alpha))
        ]
        gaps.append(float(np.abs(both[0] - both[1]).max()) / 1e-5)
    print("gaps", gaps)
    assert gaps[-1] < 0.02
    assert gaps[0] > 1.9 * gaps[2]  # about the first order, with ripples behind the kink


def test_a_beam_is_what_theory_says_along_its_line() -> None:
    line = string(bending_stiffness=0.02, foundation=3.0, drag=0.4, elements=20)
    result = linear(line, force(0.6), until=3.0)
    x, t = np.linspace(0.0, 1.0, 21), result.time.values
    exact = beam.moving_force(
        x[None, :], t[:, None], force=F, speed=0.6, length=1.0, bending_stiffness=0.02, mass=1.0, tension=1.0,
        foundation=3.0, damping=0.4,
    )  # fmt: skip
    assert -result.position.sel(axis="z").values == pytest.approx(exact, abs=1e-8 * F + 1e-6 * np.abs(exact).max())


def test_a_beam_with_little_bending_stiffness_follows_the_nonlinear_chain() -> None:
    line = {"start": (0.0, 0.0), "end": (1.0, 0.0), "tension": 1.0, "mass": 1.0, "axial_stiffness": 100.0}
    travel = Travel(speed=0.5, measured="horizontal")
    loads = {"load": MovingForce(on="string", force=(0.0, -1e-5), travel=travel)}
    chain = Line(**line, elements=200)  # type: ignore[arg-type]
    slender = Line(**line, elements=200, bending_stiffness=1e-6)  # type: ignore[arg-type]
    moved = [
        simulate(Scenario(gravity=0.0, lines={"string": one}, loads=loads, run=run)).position.values[-1]
        for one, run in (
            (chain, Dynamic(until=1.2, every=1.2, accuracy=1e-9)),
            (slender, Linear(until=1.2, modes=2000)),
        )
    ]
    assert moved[0] == pytest.approx(moved[1], abs=0.02 * 1e-5)


def test_its_own_weight_hangs_as_a_parabola() -> None:
    result = linear(string(tension=50.0), gravity=9.81, until=0.1)
    assert -float(result.position[0, 50, 1]) == pytest.approx(
        9.81 / (8.0 * 50.0), rel=2e-3
    )  # 0.16 % longer than its chord


def test_the_frictionless_contact_is_held_by_force_times_slope() -> None:
    """Drive force F^2 (2 alpha - 1)/(2 P (1 - alpha^2)) near the first support."""
    result = linear(string(), force(0.8, contact="frictionless"), until=0.5)
    exact = F**2 * (2.0 * 0.8 - 1.0) / (2.0 * (1.0 - 0.64))
    assert result.hold_force.values[3:, 0, 0] == pytest.approx(np.full(8, exact), rel=1e-5)


def test_kinetic_and_elastic_energy_are_those_of_the_theory() -> None:
    """E = F^2 V t / (2 P (1 - alpha^2)) until the first reflection."""
    result = linear(string(elements=1000), force(0.5), until=0.9)
    energy = result.energy.sel(form=["kinetic", "elastic"]).sum("form").values
    exact = F**2 * 0.5 * result.time.values / (2.0 * 0.75)
    assert energy == pytest.approx(exact, abs=2e-3 * exact[-1])  # sums over nodes at two kinks


def test_a_slack_line_has_no_linear_theory() -> None:
    with pytest.raises(EquilibriumError, match=r"requires a tension in equilibrium; write tension"):
        linear(string(tension=None, length=1.2), force(0.5))


def test_a_deep_rope_is_warned_of() -> None:
    result = linear(string(tension=None, length=1.2, axial_stiffness=1e6), force(0.5), gravity=9.81)
    assert "too far for small deflections" in result.attrs["warnings"]


def test_a_series_that_would_be_too_long_is_refused() -> None:
    with pytest.raises(RopewalkError, match=r"needs more than 2000 modes; write a number of modes"):
        linear(string(bending_stiffness=1e-9), force(0.5, start=0.3))


def test_a_series_of_modes_is_the_closed_form_where_there_is_one() -> None:
    """A table of equal values says the same as a number, but goes the way of forces that no closed form knows."""
    beam = string(bending_stiffness=0.02, foundation=3.0, drag=0.4, elements=20)
    table = ForceTable(time=(0.0, 5.0), value=((0.0, -F), (0.0, -F)))
    for line, modes in ((beam, None), (string(elements=20), 30)):
        closed, series = (linear(line, force(0.6, size), until=2.0, modes=modes) for size in ((0.0, -F), table))
        for name in ("position", "contact_position", "velocity"):
            gap = np.nanmax(np.abs(series[name].values - closed[name].values))
            # A millionth of the modes is left out, seen 9e-8; of rates, which are differences over 1e-6, as much again.
            assert gap < (1e-4 if name == "velocity" else 1e-6) * F, name


def test_a_series_of_modes_tends_to_a_force_that_starts_inside_a_string() -> None:
    """By images, with all modes; what is left out of the sum of 1/n^2 is a part of 1/n."""
    load = force(SpeedTable(time=(0.0, 1.0, 2.0), value=(0.5, 0.2, -0.3)), start=0.3)
    exact = linear(string(elements=20), load).position.values
    errors = [float(np.abs(linear(string(elements=20), load, modes=m).position.values - exact).max()) for m in (40, 80)]
    print("errors", errors, "order", np.log2(errors[0] / errors[1]))
    assert errors[1] < 5e-3 * F
    assert np.log2(errors[0] / errors[1]) == pytest.approx(1.0, abs=0.15)


def test_a_force_inside_a_beam_comes_to_its_static_deflection() -> None:
    """Set down suddenly on a beam with strong damping: F a b (L^2 - a^2 - b^2) / 6 L EI."""
    line = string(bending_stiffness=0.5, length=1.0, tension=None, drag=40.0, axial_stiffness=1.0, elements=20)
    found = linear(line, force(0.0, start=0.3), until=16.0)
    x = np.linspace(0.0, 1.0, 21)
    a, b = np.minimum(x, 0.3), 1.0 - np.maximum(x, 0.3)
    exact = -F * a * b * (1.0 - a**2 - b**2) / (6.0 * 0.5)
    z = found.position.sel(axis="z").values
    assert z[-1] == pytest.approx(exact, abs=2e-6 * np.abs(exact).max())  # modes that are left out, a millionth
    assert np.abs(z).max() == pytest.approx(np.abs(exact).max(), rel=0.05)  # overdamped but for the lowest modes
