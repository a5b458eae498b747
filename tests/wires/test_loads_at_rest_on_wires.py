"""Lines with bending stiffness at rest under loads: against closed forms of beams, levers, ropes, and small motion."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.model import Scenario
from ropewalk.overhead.section import elasticity, section_of
from ropewalk.simulate import simulate
from ropewalk.wires.bearing import Bearing
from ropewalk.wires.mesh import mesh_of
from ropewalk.wires.plan import Contact, Hold, Spot, TravellingLoad, Wire, WirePlan
from ropewalk.wires.prescribed_motion import PrescribedMotion

LENGTH, EI = 10.0, 2e6
BEAM = {
    "start": [0, 0], "end": [LENGTH, 0], "length": LENGTH, "mass": 50.0, "axial_stiffness": 1e9,
    "bending_stiffness": EI, "elements": 40,
}  # fmt: skip
VEHICLE = {
    "kind": "vehicle", "on": "beam", "bodies": {"box": {"mass": 1000.0, "inertia": 500.0}},
    "wheels": {"front": {"at": 1.0, "mass": 10.0}, "rear": {"at": -1.0, "mass": 20.0}},
    "springs": {
        "front": {"between": ["box", "front"], "stiffness": 1e5},
        "rear": {"between": ["box", "rear"], "stiffness": 2e5},
    },
}  # fmt: skip


def run(
    load: dict[str, Any] | None, kind: str, gravity: float = 0.0, line: dict[str, Any] | None = None, **more: Any
) -> xr.Dataset:
    """A run of one load on a beam."""
    tree = {
        "gravity": gravity, "lines": {"beam": {**BEAM, **(line or {})}}, "loads": {"load": load} if load else {},
        "run": {"kind": kind, **more},
    }  # fmt: skip
    return simulate(Scenario.model_validate(tree))


def force(size: float, **travel: Any) -> dict[str, Any]:
    return {"kind": "force", "on": "beam", "force": [0.0, size], "travel": {"speed": 1.0, **travel}}


def at_load(a: np.ndarray | float) -> Any:
    """Deflection of a beam on two supports under a unit load at a, m/N."""
    return a**2 * (LENGTH - a) ** 2 / (3.0 * EI * LENGTH)


def test_the_path_of_a_slow_force_over_a_beam() -> None:
    """a^2 b^2 / (3 EI L), of the second order in the mesh; one newton is too little to make it longer."""
    errors = []
    for elements in (20, 40, 80):
        found = run(force(-1.0), "quasistatic", line={"elements": elements}, positions=21)
        assert found.attrs["outcome"] == "completed"
        np.testing.assert_allclose(found.load_path, np.linspace(0.0, LENGTH, 21), atol=1e-9)
        z = found.contact_position.values[:, 0, 1]
        errors.append(np.abs(z + at_load(np.linspace(0.0, LENGTH, 21))).max() / at_load(0.5 * LENGTH))
    print(errors)
    assert errors[-1] < 1e-3
    assert np.abs(np.log2(np.array(errors[:-1]) / errors[1:]) - 2.0).max() < 0.2


def test_the_influence_line_of_a_point_is_the_deflection_under_a_load_there() -> None:
    """Betti and Maxwell: what a load at x does at the quarter point, one at the quarter point does at x."""
    slow = run(force(-1.0), "quasistatic", positions=41).position.values[:, 10, 1]
    still = run(force(-1.0, **{"from": 0.25 * LENGTH}), "equilibrium").position.values[0, :, 1]
    # A contact at a node takes hold of the nodes around it: both sides differ by that much of the mesh.
    np.testing.assert_allclose(slow, still, atol=2e-3 * np.abs(still).max())


def test_a_force_on_a_beam_on_a_bed() -> None:
    """Winkler: F / (8 EI b^3) with b^4 = k / (4 EI), far from both ends."""
    bed = 5e5
    beta = (bed / (4.0 * EI)) ** 0.25
    line = {"end": [40.0, 0.0], "length": 40.0, "elements": 320, "foundation": bed}
    found = run(force(-1.0, **{"from": 20.0}), "equilibrium", line=line)
    assert found.contact_position.values[0, 0, 1] == pytest.approx(-1.0 / (8.0 * EI * beta**3), rel=2e-3)


def test_wheels_share_a_weight_as_levers_do_wherever_they_stand() -> None:
    """Two wheels: the shares follow from the places alone, before, on and behind the beam."""
    found = run({**VEHICLE, "travel": {"speed": 1.0, "at_end": "leave"}}, "quasistatic", gravity=9.81, positions=25)
    assert found.attrs["outcome"] == "completed"
    forces = found.contact_force.values[:, :, 1]
    np.testing.assert_allclose(forces[:, 0][np.isfinite(forces[:, 0])], -(500.0 + 10.0) * 9.81, rtol=1e-9)
    np.testing.assert_allclose(forces[:, 1][np.isfinite(forces[:, 1])], -(500.0 + 20.0) * 9.81, rtol=1e-9)
    assert np.isnan(forces[0, 1])
    assert np.isnan(forces[-1, 0])
    # springs under half of the weight of the box each; the front wheel stands on the beam, the rear one on the ground
    body = found.body_position.sel(body="load.box", axis="z").values
    wheel = found.contact_position.values[0, 0, 1]
    assert body[0] == pytest.approx(0.5 * wheel - 0.5 * 500.0 * 9.81 * (1e-5 + 5e-6), rel=1e-6)


def test_three_wheels_share_a_weight_as_beam_and_springs_yield() -> None:
    """Statically indeterminate: the flexibility of the beam, from its closed form, in series with the springs."""
    places, stiffness, weight = np.array([-2.0, 0.0, 2.0]), np.array([3e5, 2e5, 1e5]), 1e3 * 9.81
    names = ("rear", "middle", "front")
    vehicle = {
        "kind": "vehicle", "on": "beam", "bodies": {"box": {"mass": 1000.0, "inertia": 800.0}},
        "wheels": {name: {"at": float(at), "mass": 1.0} for name, at in zip(names, places, strict=True)},
        "springs": {
            name: {"between": ["box", name], "stiffness": float(k)} for name, k in zip(names, stiffness, strict=True)
        },
        "travel": {"speed": 1.0, "from": 4.0},
    }  # fmt: skip
    stiff = 100.0 * EI  # so that it bends little, and does not get longer
    line = {"bending_stiffness": stiff, "axial_stiffness": 1.0e8}
    bare = run(None, "equilibrium", gravity=9.81, line=line).position.values[0, :, 1]
    found = run(vehicle, "equilibrium", gravity=9.81, line=line)
    x = 4.0 + places
    a, b = np.minimum.outer(x, x), LENGTH - np.maximum.outer(x, x)
    flexible = a * b * (LENGTH**2 - a**2 - b**2) / (6.0 * stiff * LENGTH)
    sunk = -np.interp(x, np.linspace(0.0, LENGTH, bare.size), bare)
    # spring forces p: box height y and pitch q with y + q s - p / k = flexible (p + wheels) + sunk
    system = np.zeros((5, 5))
    system[:3, :3] = np.diag(1.0 / stiffness) + flexible
    system[:3, 3], system[:3, 4] = -1.0, -places
    system[3, :3], system[4, :3] = 1.0, places
    right = np.concatenate([-sunk - flexible @ np.full(3, 9.81), [weight, 0.0]])
    shares = np.linalg.solve(system, right)[:3] + 9.81
    forces = -found.contact_force.values[0, :, 1]
    np.testing.assert_allclose(forces, shares, rtol=1e-3)


@pytest.mark.parametrize("load", [
    {"kind": "mass", "mass": 500.0}, {"kind": "oscillator", "mass": 400.0, "wheel_mass": 100.0, "stiffness": 1e5},
    {k: v for k, v in VEHICLE.items() if k != "on"},
], ids=["mass", "oscillator", "vehicle"])  # fmt: skip
def test_what_begins_at_rest_with_its_loads_stays_at_rest(load: dict[str, Any]) -> None:
    standing = {**load, "on": "beam", "travel": {"speed": 0.0, "from": 4.0}}
    found = run(standing, "dynamic", gravity=9.81, until=0.1, every=0.01, start={"with_loads": True})
    assert found.attrs["outcome"] == "completed"
    assert np.ptp(found.position.values, axis=0).max() < 1e-9  # m; put down at once, it would go down by centimetres
    assert np.ptp(found.contact_force.values[:, :, 1], axis=0).max() < 1e-4  # N, of some 5000


def test_a_slow_mass_on_a_line_that_hardly_bends_goes_as_on_a_rope() -> None:
    """EI -> 0: the same path as that of the force of its weight on a chain; its links are polygons of second order."""
    rope = {
        "start": [0, 0], "end": [19, 4], "length": 20, "mass": 1.0, "axial_stiffness": 1e6, "elements": 160,
    }  # fmt: skip
    run_ = {"kind": "quasistatic", "positions": 9}
    travel = {"speed": 1.0, "from": 2.0}
    chain = {"lines": {"rope": rope}, "run": run_,
             "loads": {"a": {"kind": "force", "on": "rope", "force": [0, -98.1], "travel": travel}}}  # fmt: skip
    stiff = {"lines": {"rope": {**rope, "bending_stiffness": 1e-9}}, "run": run_,
             "loads": {"a": {"kind": "mass", "on": "rope", "mass": 10.0, "travel": travel}}}  # fmt: skip
    one, two = (simulate(Scenario.model_validate(tree)).contact_position.values[:-1, 0] for tree in (chain, stiff))
    np.testing.assert_allclose(two, one, atol=0.02)  # m, over a depth of 5 m: the spline rounds the kink over a link


def test_the_elasticity_of_an_overhead_line_is_that_of_small_motion() -> None:
    """With all geometry the tension in the wires rises a little: within half a percent at 100 N."""
    line = {"spans": {"count": 4, "length": 50.0}, "droppers": {"per_span": 5}, "element": 0.5}
    load = {"kind": "force", "on": "line", "force": [0.0, 100.0], "travel": {"speed": 1.0, "from": 50.0}}
    tree = {"overhead_lines": {"line": line}, "loads": {"push": load}, "run": {"kind": "quasistatic", "positions": 13}}
    scenario = Scenario.model_validate(tree)
    found = simulate(scenario)
    assert found.attrs["outcome"] == "completed"
    slight = {**load, "force": [0.0, 1e-3]}
    bare = simulate(Scenario.model_validate({**tree, "loads": {"push": slight}}))
    rise = (found.contact_position.values - bare.contact_position.values)[:, 0, 1] / 100.0
    section = section_of("line", scenario.overhead_lines["line"], 9.81)
    stations = 50.0 + found.load_path.values
    inside = stations < 149.0
    known = elasticity(section, 100.0, stations=stations[inside])[1]
    np.testing.assert_allclose(rise[inside], known, rtol=5e-3)


@pytest.mark.parametrize(("spans", "share"), [
    ((10.0, 10.0), [0.375, 1.25, 0.375]), ((10.0, 10.0, 10.0), [0.4, 1.1, 1.1, 0.4]),
])  # fmt: skip
def test_a_beam_over_several_spans_obeys_the_three_moment_equation(
    spans: tuple[float, ...], share: list[float]
) -> None:
    """Clapeyron: with moments M at inner supports M' l' + 2 M (l' + l) + M'' l = -w (l'^3 + l^3) / 4, equal spans."""
    whole, weight = sum(spans), 9.81 * 50.0
    wire = Wire("beam", (0.0, 0.0, 0.0), (whole, 0.0, 0.0), 0.0, 50.0, 1e9, 1e12, unstrained=whole)
    piers = tuple(
        Hold(f"pier {i}", Spot(0, float(at)), (0.0, 0.0, np.inf)) for i, at in enumerate(np.cumsum(spans)[:-1])
    )
    mesh = mesh_of(WirePlan((wire,), holds=piers), [int(8 * whole)])
    rest = np.full(mesh.nodes, whole / mesh.strands.links[0])
    bearing = Bearing(mesh, [], rest, space=False)
    found = bearing.stand(0.0, mesh.straight())
    ends = -bearing.potential.pull(found.position)[2, [0, -1]]
    inner = bearing.potential.hold_forces(found.position)[:, 2]
    np.testing.assert_allclose([ends[0], *inner, ends[1]], np.array(share) * weight * spans[0], rtol=1e-3)


def test_a_wheel_that_may_lift_off_does_not_pull() -> None:
    """A force upwards on a beam that is held down by a wheel of 10 kg: the wheel goes no further than its weight."""
    wire = Wire("beam", (0.0, 0.0, 0.0), (10.0, 0.0, 0.0), 0.0, 1e-3, EI, 1e9, unstrained=10.0)
    mesh = mesh_of(WirePlan((wire,)), [40])
    # a head on a spring from above whose rest length ends 1 mm above the wire: it does not touch, and must not hang on
    one = np.ones((1, 1))
    head = TravellingLoad("head", one, one, 1e3 * one, (Contact(0, (1.0,), stiffness=1e6, base=1e-3, lifts_off=True),))
    place = partial(np.full_like, fill_value=5.0)
    found = Bearing(mesh, [PrescribedMotion(head, place)], np.full(mesh.nodes, 0.25), space=False).stand(
        0.0, mesh.straight()
    )
    assert not found.touches[0]
    assert found.force[0] == 0.0
    restrained = TravellingLoad("head", one, one, 1e3 * one, (Contact(0, (1.0,), stiffness=1e6, base=1e-3),))
    pulled = Bearing(mesh, [PrescribedMotion(restrained, place)], np.full(mesh.nodes, 0.25), space=False).stand(
        0.0, mesh.straight()
    )
    assert pulled.force[0] > 0.5  # N, 1e3 N/m over a millimetre less what the beam gives way


def test_a_load_that_stands_still_has_no_path() -> None:
    with pytest.raises(ValueError, match="stands still has no path"):
        run({**VEHICLE, "travel": {"speed": 0.0, "from": 3.0}}, "quasistatic", gravity=9.81)
