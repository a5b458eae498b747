"""Rest of wires with all geometry, and its second derivatives: elasticae, buckling, frequencies, the catenary."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sparse
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipj, ellipk, ellipkinc

from ropewalk.model import Scenario
from ropewalk.scenario.loading import loads
from ropewalk.simulate import simulate
from ropewalk.theory import beam
from ropewalk.theory.rope import elastic_catenary
from ropewalk.wires.equilibrium import WirePotential, movable, settle
from ropewalk.wires.mesh import mesh_of
from ropewalk.wires.plan import Array, EndKind, Wire, WirePlan
from ropewalk.wires.pressing import Pressing
from ropewalk.wires.task import WireTask, ready
from ropewalk.wiring import task_of

L, EI, RHO = 2.0, 3.0, 0.7
EA = 1e8  # hardly stretches: forces of EI / L^2 strain it by 1e-8
ENDS: dict[str, EndKind] = {"simply_supported": "held", "clamped": "clamped"}


def potential(links: int, tension: float = 0.0, ends: tuple[EndKind, EndKind] = ("held", "held"), bed: float = 0.0,
              stretchy: float = EA) -> WirePotential:  # fmt: skip
    """A straight wire of length L that is stretched, or compressed, by the given tension, without gravity."""
    wire = Wire("wire", (0.0, 0.0, 0.0), (L, 0.0, 0.0), tension, RHO, EI, stretchy, bed=bed, ends=ends)
    mesh = mesh_of(WirePlan((wire,), gravity=0.0), [links])
    return WirePotential(mesh, np.full(mesh.nodes, L / links / (1.0 + tension / stretchy)))


# Large deflection


def bent_cantilever(alpha: float) -> tuple[float, float]:
    """How far the tip goes aside, and back, over the length; alpha = P L^2 / EI (Bisshopp and Drucker 1945).

    With p^2 = (1 + sin(angle of the tip)) / 2 and theta = arcsin(1 / (p sqrt 2)): sqrt(alpha) = K(p) - F(p, theta),
    aside 1 - 2 (E(p) - E(p, theta)) / sqrt(alpha), back 1 - sqrt(2 sin(angle) / alpha).
    """

    def long(m: float) -> float:
        return float(ellipk(m) - ellipkinc(np.arcsin(np.sqrt(0.5 / m)), m))

    m = float(brentq(lambda m: long(m) - np.sqrt(alpha), 0.5 + 1e-12, 1.0 - 1e-12, xtol=1e-15))
    turned = ellipe(m) - ellipeinc(np.arcsin(np.sqrt(0.5 / m)), m)
    return float(1.0 - 2.0 * turned / np.sqrt(alpha)), float(1.0 - np.sqrt(2.0 * (2.0 * m - 1.0) / alpha))


@pytest.mark.parametrize(
    ("alpha", "aside", "back"), [(1.0, 0.30172, 0.05643), (2.0, 0.49346, 0.16064), (5.0, 0.71379, 0.38763)]
)
def test_a_cantilever_bends_as_the_elastica(alpha: float, aside: float, back: float) -> None:
    exact = np.array(bent_cantilever(alpha))
    assert exact == pytest.approx([aside, back], abs=1e-5)  # digits given
    errors = []
    for links in (20, 40, 80):
        shape = potential(links, ends=("clamped", "free"))
        shape.force[2, -1] = alpha * EI / L**2
        found = settle(shape, shape.mesh.straight()).position
        errors.append(np.abs([found[2, -1] / L - exact[0], 1.0 - found[0, -1] / L - exact[1]]))
        # At rest indeed: nothing is left of the force but rounding of EA.
        assert np.abs(shape.pull(found)[:, 1:]).max() < 1e-5 * EI / L**2
    assert (errors[-1] < 3e-4).all()
    # Second order, with a little of higher ones at 20 links.
    assert np.log2(errors[0] / errors[1]) == pytest.approx([2.0, 2.0], abs=0.1)
    assert np.log2(errors[1] / errors[2]) == pytest.approx([2.0, 2.0], abs=0.05)


@pytest.mark.parametrize("angle", [0.3, 1.0, 2.0])
def test_a_strut_beyond_buckling_is_an_elastica(angle: float) -> None:
    """Pinned ends brought together (Timoshenko and Gere, Theory of Elastic Stability).

    With k = sin(angle / 2), angle that of the ends: distance (2 E/K - 1) L, height k L / K, force 4 K^2 EI / L^2.
    """
    m = np.sin(0.5 * angle) ** 2
    K, E = ellipk(m), ellipe(m)
    high, thrust, errors = np.sqrt(m) / K * L, 4.0 * K**2 * EI / L**2, []
    for links in (20, 40, 80):
        s = np.linspace(0.0, L, links + 1)
        _, cn, _, am = ellipj(2.0 * K * s / L - K, m)
        found = np.stack([L / K * (ellipeinc(am, m) + E) - s, 0.0 * s, high * cn])
        assert found[0, -1] == pytest.approx((2.0 * E / K - 1.0) * L, rel=1e-12)
        for stretchy in (1e3, 1e4, 1e5, 1e6):  # links, shorter than their arcs, would be thrown off by a large EA
            shape = potential(links, -thrust, stretchy=stretchy)  # so long that it has the length L under the force
            found = settle(shape, found).position
        errors.append(np.abs([found[2].max() / high - 1.0, -shape.pull(found)[0, 0] / thrust - 1.0]))
    assert (errors[-1] < 2e-3).all()
    # Where it is inclined the force strains it less: by 1e-6 at most, which the flattest height feels tenfold.
    assert np.log2(errors[0] / errors[1]) == pytest.approx([2.0, 2.0], abs=0.1)
    assert np.log2(errors[1] / errors[2]) == pytest.approx([2.0, 2.0], abs=0.1)


# Buckling


def least(shape: WirePotential) -> float:
    """Smallest eigenvalue of the stiffness of the straight wire."""
    free = movable(shape.mesh, space=False).ravel()
    K = shape.stiffness(shape.mesh.straight())[free][:, free].toarray()
    return float(np.linalg.eigvalsh(K)[0])


def buckling(links: int, ends: str, bed: float = 0.0) -> float:
    """Compression at which that is zero, N."""
    near = beam.buckling_force(length=L, bending_stiffness=EI, foundation=bed, ends=ends)  # type: ignore[arg-type]
    kinds = (ENDS[ends], ENDS[ends])
    return float(brentq(lambda N: least(potential(links, -N, kinds, bed)), 0.7 * near, 1.2 * near, rtol=1e-10))


@pytest.mark.parametrize(("ends", "euler"), [("simply_supported", 1.0), ("clamped", 4.0)])
def test_it_buckles_under_eulers_load(ends: str, euler: float) -> None:
    exact = euler * np.pi**2 * EI / L**2
    errors = [abs(buckling(links, ends) / exact - 1.0) for links in (10, 20, 40)]
    assert errors[-1] < 2.5e-3
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([2.0, 2.0], abs=0.1)


@pytest.mark.parametrize("ends", ["simply_supported", "clamped"])
@pytest.mark.parametrize("bed", [30.0, 3e3])
def test_on_a_bed_it_buckles_into_more_waves(ends: str, bed: float) -> None:
    exact = beam.buckling_force(length=L, bending_stiffness=EI, foundation=bed, ends=ends)  # type: ignore[arg-type]
    errors = [abs(buckling(links, ends, bed) / exact - 1.0) for links in (20, 40, 80)]
    assert errors[-1] < 2e-3
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([2.0, 2.0], abs=0.15)


def test_beyond_that_the_straight_wire_is_no_minimum() -> None:
    Euler = np.pi**2 * EI / L**2
    assert least(potential(40, -0.99 * Euler)) > 0.0 > least(potential(40, -1.01 * Euler))


# Frequencies


@pytest.mark.parametrize("ends", ["simply_supported", "clamped"])
@pytest.mark.parametrize(("tension", "bed"), [(0.0, 0.0), (40.0, 0.0), (-5.0, 0.0), (40.0, 300.0), (-12.0, 300.0)])
def test_frequencies_of_stretched_bedded_and_compressed_wires(ends: str, tension: float, bed: float) -> None:
    line = {"length": L, "bending_stiffness": EI, "mass": RHO, "tension": tension, "foundation": bed}
    exact = np.sort(beam.natural_frequencies(6, ends=ends, **line))[:3]  # type: ignore[arg-type]
    errors = []
    for links in (20, 40, 80):
        shape = potential(links, tension, (ENDS[ends], ENDS[ends]), bed)
        n, up = shape.mesh.nodes, slice(1, -1)
        K = shape.stiffness(shape.mesh.straight()).toarray()[2 * n :, 2 * n :][up, up]
        m = shape.mesh.mass[up]
        found = np.sqrt(np.linalg.eigvalsh(K / np.sqrt(np.outer(m, m)))[:3])
        errors.append(found / exact - 1.0)
    assert np.abs(errors[-1]).max() < 8e-3
    # Of the second order. Tension and bending miss with one sign, so no error is by chance small.
    assert np.log2(np.abs(errors[1] / errors[2])) == pytest.approx([2.0] * 3, abs=0.1)


# A wire of given length


@pytest.mark.parametrize(("length", "height"), [(20.6, 0.0), (24.0, 3.0), (19.97, 0.0)])
def test_a_wire_without_stiffness_hangs_as_the_elastic_catenary(length: float, height: float) -> None:
    """Slack, very slack and uneven, and taut; as a declared line comes to rest."""
    span, mass, stretchy = 20.0, 1.3, 2e5
    exact = elastic_catenary(span=span, height=height, length=length, weight=mass * 9.81, axial_stiffness=stretchy)
    errors: list[Array] = []
    for links in (25, 50, 100):
        tension = max(stretchy * (float(np.hypot(span, height)) / length - 1.0), 0.0)
        wire = Wire("wire", (0.0, 0.0, 0.0), (span, 0.0, height), tension, mass, 0.0, stretchy, unstrained=length)
        _, start = ready(WireTask(WirePlan((wire,)), (), (), element=[links]))
        xi = np.linspace(0.0, length, links + 1)
        d = np.diff(start.position, axis=1)
        pulled = stretchy * (np.sqrt((d**2).sum(axis=0)) / start.unstrained[:-1] - 1.0)
        errors.append(
            np.array([
                np.abs(start.position[[0, 2]].T - exact.position(xi)).max() / exact.sag,
                np.abs(pulled / exact.tension(0.5 * (xi[1:] + xi[:-1])) - 1.0).max(),
            ])
        )  # fmt: skip
    assert (errors[-1] < 3e-4).all()
    # Of a taut wire the tension is that of its chord: what is left is rounding, and its shape is found exactly.
    for coarse, fine in zip(errors[1], errors[2], strict=True):
        assert fine < 1e-9 or np.log2(coarse / fine) == pytest.approx(2.0, abs=0.1)


SLACK = {"length": 20.0, "mass": 1.0, "stretchy": 1e5}


def slack(span: float, stiffness: float, gravity: float = 9.81) -> tuple[WirePotential, Array]:
    """A wire of 20 m between ends at one height, as a declared line comes to rest."""
    wire = Wire(
        "wire", (0.0, 0.0, 0.0), (span, 0.0, 0.0), SLACK["stretchy"] * (span / SLACK["length"] - 1.0), SLACK["mass"],
        stiffness, SLACK["stretchy"], unstrained=SLACK["length"],
    )  # fmt: skip
    _, start = ready(WireTask(WirePlan((wire,), gravity=gravity), (), (), element=[80]))
    return WirePotential(start.mesh, start.unstrained), start.position


def definite(shape: WirePotential, position: Array) -> bool:
    free = movable(shape.mesh, space=False).ravel()
    return float(np.linalg.eigvalsh(shape.stiffness(position)[free][:, free].toarray())[0]) > 0.0


@pytest.mark.parametrize("span", [10.0, 12.5, 15.0, 17.5, 19.5])
def test_a_slack_wire_hangs_where_its_energy_is_least(span: float) -> None:
    """From 5 % to 100 % longer than its span, from a rope to a rod; bending costs energy, so it grows with it."""
    free = elastic_catenary(span=span, height=0.0, length=20.0, weight=9.81, axial_stiffness=SLACK["stretchy"])
    energies = []
    for stiffness in (0.1, 1.0, 10.0, 100.0, 1000.0):
        shape, position = slack(span, stiffness)
        assert definite(shape, position)
        assert np.abs(position[2] - position[2, ::-1]).max() < 1e-6  # nothing is folded to one side
        energies.append(shape.energy(position))
        if stiffness == 0.1:
            assert -position[2].min() == pytest.approx(free.sag, rel=1e-3)  # 80 links
            assert shape.tension(position).min() > 0.0
    assert np.all(np.diff(energies) > 0.0)


def test_without_weight_a_slack_wire_is_an_elastica() -> None:
    """20 m between ends 15 m apart: 2 E/K - 1 = 3/4; the height is k L / K."""
    shape, position = slack(15.0, 1000.0, gravity=0.0)
    m = float(brentq(lambda m: 2.0 * ellipe(m) / ellipk(m) - 1.75, 0.01, 0.9, xtol=1e-15))
    assert definite(shape, position)
    assert np.abs(position[2]).max() == pytest.approx(np.sqrt(m) / ellipk(m) * 20.0, rel=1e-3)  # 80 links


def test_the_search_for_rest_leaves_a_saddle() -> None:
    """A straight strut beyond Euler's load is at rest, but not for long: it ends as the elastica of its length."""
    shape = potential(40, -4.0 * np.pi**2 * EI / L**2, stretchy=1e4)
    straight = shape.mesh.straight()
    assert np.abs(shape.pull(straight)[:, 1:-1]).max() < 1e-9
    found = settle(shape, straight)
    assert definite(shape, found.position)
    assert np.abs(found.position[2]).max() > 0.01 * L


LOOSE = """
lines:
  beam: {start: [0, 0], end: [25, 0], length: 25 m, mass: 2303, axial_stiffness: 10 GN, bending_stiffness: 8.323e9,
         elements: 48, start_support: {kind: guided, along: [1, 0], force: 0},
         end_support: {kind: guided, along: [1, 0], force: 0}}
run: {kind: equilibrium}
"""


def test_what_may_stand_anywhere_stays_where_it_is() -> None:
    """A beam on two rollers comes closer by what its bow takes, on both sides."""
    x = simulate(loads(LOOSE, "beam.yaml"))["position"].values[0, :, 0]
    assert x[0] + x[-1] == pytest.approx(25.0, abs=0.01)  # what rounding leaves of forces moves it a little
    assert 24.9999 < x[-1] - x[0] < 25.0


def test_the_stiffness_is_the_derivative_of_the_forces() -> None:
    """Links, bending, droppers, arms and stagger, and a load on top, by central differences."""
    line = {"spans": {"count": 2, "length": 40.0}, "droppers": {"per_span": 3}, "element": 2.0,
            "steady_arms": {"stagger": "200 mm"}}  # fmt: skip
    tree = {"overhead_lines": {"line": line}, "run": {"kind": "dynamic", "until": 1.0}}
    start = ready(task_of(Scenario.model_validate(tree)))[1]
    potential = WirePotential(start.mesh, start.unstrained)
    r = start.position + 1e-3 * np.random.default_rng(0).standard_normal(start.position.shape)
    at = np.zeros((2, start.mesh.nodes))
    at[0, 5:11], at[1, 20:26] = 1.0 / 6.0, 1.0 / 6.0
    one = np.array([[3e3, -1e3], [-1e3, 2e3]])
    none = np.zeros((0, 2))
    potential.pressing = (sparse.csr_matrix(at), Pressing(np.array([10.0, -20.0]), one, none[:, 0], none))
    found, h = potential.stiffness(r).toarray(), 1e-6
    known = np.zeros_like(found)
    for i in range(r.size):
        step = np.zeros(r.size)
        step[i] = h
        apart = potential.pull(r + step.reshape(r.shape)) - potential.pull(r - step.reshape(r.shape))
        known[:, i] = -apart.ravel() / (2.0 * h)
    np.testing.assert_allclose(found, known, atol=1e-7 * np.abs(found).max())
    way = np.random.default_rng(1).standard_normal(r.shape)
    slope = (potential.energy(r + h * way) - potential.energy(r - h * way)) / (2.0 * h)
    assert slope == pytest.approx(-float((potential.pull(r) * way).sum()), rel=1e-6)
