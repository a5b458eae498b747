"""Splines of wires: what they reproduce, how smooth they are, and the compliance that makes up for what they round."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ropewalk.wires.mesh import mesh_of, places_of
from ropewalk.wires.plan import Spot, Wire, WirePlan
from ropewalk.wires.rest import restrained_shape, rows, vertical_stiffness
from ropewalk.wires.spline import WIDTH, points

LINKS = 24


def at(s, n=LINKS):
    base, w = points(np.atleast_1d(np.asarray(s, dtype=float)), np.full(np.size(s), n))
    full = np.zeros((np.size(s), 3, n + 1))
    for k, b in enumerate(base):
        full[k, :, b : b + WIDTH] = w[k]
    return full


def taut(stiffness=0.0, tension=2e4, length=12.0):
    return Wire("wire", (0.0, 0.0, 0.0), (length, 0.0, 0.0), tension, 1.35, stiffness)


@given(st.floats(3.0, LINKS - 3.0))
def test_cubics_are_reproduced_with_their_derivatives(s):
    x = np.arange(LINKS + 1.0)
    for power in range(4):
        value, slope, bend = at(s)[0] @ (x - 10.0) ** power
        y = s - 10.0
        assert value == pytest.approx(y**power, abs=1e-9)
        assert slope == pytest.approx(power * y ** max(power - 1, 0), abs=1e-9)
        assert bend == pytest.approx(power * (power - 1) * y ** max(power - 2, 0), abs=1e-8)


@given(st.floats(0.0, LINKS))
def test_straight_lines_are_reproduced_to_their_ends(s):
    x = np.arange(LINKS + 1.0)
    value, slope, bend = at(s)[0] @ (2.0 * x - 3.0)
    assert (value, slope, bend) == pytest.approx((2.0 * s - 3.0, 2.0, 0.0), abs=1e-9)


def test_weights_and_two_derivatives_are_continuous_where_a_load_passes_a_node():
    node = np.arange(1.0, LINKS)
    jump = np.abs(at(node + 1e-9) - at(node - 1e-9)).max(axis=(0, 2))
    assert jump == pytest.approx((0.0, 0.0, 0.0), abs=2e-8)  # slopes of the second derivative are of order 1


def test_a_wave_is_seen_to_the_fourth_order():
    """The plain B-spline would see it too low by (k h)^2 / 6."""
    x = np.arange(LINKS + 1.0)
    s = np.linspace(8.0, 16.0, 41)
    errors = [np.abs(at(s)[:, 0] @ np.cos(k * x) - np.cos(k * s)).max() for k in (0.4, 0.2)]
    assert 3.7 < np.log2(errors[0] / errors[1]) < 4.1


@pytest.mark.parametrize("stiffness", [0.0, 195.0])
@pytest.mark.parametrize("place", [6.0, 6.125, 6.4, 2.7])
def test_a_point_force_on_a_stiff_string_moves_its_point_as_the_closed_form_says(stiffness, place):
    """p (L - p) / (T L) less what stiffness takes: exact, though the spline rounds the kink; links of 0.5 m."""
    wire = taut(stiffness)
    mesh, T, L = mesh_of(WirePlan((wire,), gravity=0.0), 0.5), wire.tension, wire.length
    spot = places_of(mesh.strands, [Spot(0, place)])
    shape, force = restrained_shape(mesh, spot, np.array([0.01]), np.zeros(mesh.nodes))
    reach = np.sqrt(stiffness / T)
    exact = place * (L - place) / (T * L)
    if reach:
        exact -= reach / T * np.sinh(place / reach) * np.sinh((L - place) / reach) / np.sinh(L / reach)
    # A string to rounding; of a stiff one the local compliance is a polynomial but for 1e-6 of the whole
    assert 0.01 / force[0] == pytest.approx(exact, rel=1e-9 if stiffness == 0.0 else 1e-6)
    assert (rows(spot, mesh.nodes) @ shape)[0] < 0.01


def test_without_the_local_compliance_the_kink_is_rounded():
    wire = taut()
    mesh = mesh_of(WirePlan((wire,), gravity=0.0), 0.5)
    spot = places_of(mesh.strands, [Spot(0, 6.0)])
    exact = 6.0 * 6.0 / (wire.tension * 12.0)
    _, rounded = restrained_shape(mesh, spot._replace(local=np.zeros(1)), np.array([0.01]), np.zeros(mesh.nodes))
    assert 0.01 / rounded[0] < 0.999 * exact


@pytest.mark.parametrize(("ends", "number"), [(("held", "held"), np.pi), (("clamped", "clamped"), 4.730040745)])
def test_frequencies_of_a_beam_converge_with_the_second_order(ends, number):
    """(beta L)^2 sqrt(EI / rho) / L^2, Timoshenko, Vibration Problems in Engineering."""
    exact = number**2 * np.sqrt(195.0 / 1.35) / 12.0**2
    errors = []
    for n in (20, 40, 80):
        wire = Wire("beam", (0.0, 0.0, 0.0), (12.0, 0.0, 0.0), 0.0, 1.35, 195.0, ends=ends)
        mesh = mesh_of(WirePlan((wire,)), [n])
        K, m = vertical_stiffness(mesh).toarray()[1:-1, 1:-1], mesh.mass[1:-1]
        found = np.sqrt(np.linalg.eigvalsh(K / np.sqrt(np.outer(m, m)))[0])
        errors.append(abs(found / exact - 1.0))
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert orders == pytest.approx([2.0, 2.0], abs=0.1)


def test_frequencies_of_a_stiff_string_on_a_bed():
    """omega_n^2 = (T k^2 + EI k^4 + bed) / rho with k = n pi / L: the spectrum of the lattice has it in closed form."""
    wire = Wire("wire", (0.0, 0.0, 0.0), (12.0, 0.0, 0.0), 2e4, 1.35, 195.0, bed=3e3)
    mesh = mesh_of(WirePlan((wire,)), [120])
    K, m = vertical_stiffness(mesh).toarray()[1:-1, 1:-1], mesh.mass[1:-1]
    found = np.linalg.eigvalsh(K / np.sqrt(np.outer(m, m)))[:3]
    k, h = np.arange(1, 4) * np.pi / 12.0, 0.1
    lattice = (2.0 * np.sin(0.5 * k * h) / h) ** 2
    assert found == pytest.approx((2e4 * lattice + 195.0 * lattice**2 + 3e3) / 1.35, rel=1e-10)
    assert found == pytest.approx((2e4 * k**2 + 195.0 * k**4 + 3e3) / 1.35, rel=1e-3)
