"""The spectrum of the chain, "Walking the Line. Traveling Forces vs Moving Masses", eq. 12."""

from __future__ import annotations

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from ropewalk.mechanics.chain import ChainBuffers, ChainState, Loads
from ropewalk.mechanics.link import link_force, link_force_vectors, pull, stretch_rate
from ropewalk.solve import eigenvalues
from ropewalk.solve.composition import VERLET
from ropewalk.solve.linearised import linearise
from ropewalk.solve.spectrum import spectrum
from ropewalk.solve.splitting import RUNNING
from ropewalk.solve.stops import Stops, advance
from spectrum_cases import CHAIN, LAWS, NO_FLOOR, TENSION_ONLY, closed_form, hanging, straight, strand, wavy


@pytest.mark.parametrize("law", ["hooke", "second_piola_kirchhoff"])
@pytest.mark.parametrize("dim", [2, 3])
def test_every_eigenvalue_of_a_taut_chain_is_that_of_the_closed_form(law, dim):
    found = spectrum(strand(50, law=LAWS[law], dim=dim), straight(50, dim=dim))
    across, along = closed_form(50, law)
    frequencies = np.sort(np.concatenate([*(dim - 1) * [across], along]))
    expected = np.sort(np.concatenate([frequencies, -frequencies]))
    assert found.unknowns == found.eigenvalues.size == 2 * dim * 49
    assert np.all(found.eigenvalues.real == 0.0)
    assert found.imaginary
    # solver: rounding of the largest eigenvalue of K/m, 1e5 times the smallest one
    assert np.sort(found.eigenvalues.imag) == pytest.approx(expected, rel=1e-11)


def test_the_catalogue_numbers_are_met():
    found = spectrum(strand(50), straight(50))
    assert found.lowest_frequency == pytest.approx(6.954458951426, rel=1e-11)
    assert found.highest_frequency == pytest.approx(1580.358633518, rel=1e-12)
    assert found.stiffness_ratio == pytest.approx(227.244, abs=5e-4)  # six digits are given
    assert found.stable_step == pytest.approx(2.0 / 1580.358633518, rel=1e-12)
    assert found.character == "oscillatory-stiff"
    printed = spectrum(strand(50, law=LAWS["second_piola_kirchhoff"]), straight(50))
    assert printed.lowest_frequency == pytest.approx(7.023659252, abs=5e-10)
    assert printed.highest_frequency == pytest.approx(1611.655902, abs=5e-7)


@pytest.mark.parametrize("law", [LAWS["second_piola_kirchhoff"], [1.0, 3.0, 9e3, 2e4, 1e5]], ids=["cubic", "series"])
@pytest.mark.parametrize("dim", [2, 3])
def test_jacobian_is_the_derivative_of_the_forces(law, dim):
    """Central differences of the forces that the step loop uses, with damping, drag and a riding node."""
    links = 7
    strands = strand(links, law=law, c=40.0, drag=0.7, dim=dim)
    r, X, moving_load = wavy(links, dim=dim)
    mass = strands.rho[0] * strands.h[0]

    def acceleration(r, w):
        q, f = np.zeros(links + 1), np.zeros_like(r)
        pull(strands.law[0], strands.damping[0], strands.h[0], 0, links, r, w, q)
        for i in (moving_load - 1, moving_load):
            rest = X[i + 1] - X[i]
            q[i] = link_force(strands.law[0], strands.damping[0], rest, stretch_rate(r, w, i) / rest, r, i)
        link_force_vectors(0, links, r, q, f)
        return ((f[:, 1:links] - f[:, : links - 1]) / mass - strands.drag[0] * w[:, 1:-1]).T.ravel()

    n = dim * (links - 1)
    expected = np.zeros((2 * n, 2 * n))
    expected[:n, n:] = np.eye(n)
    for j in range(n):
        node, axis = 1 + j // dim, j % dim
        for column, moved, step in ((j, 0, 1e-6), (n + j, 1, 1.0)):
            sides = []
            for sign in (1.0, -1.0):
                y = [r.copy(), np.zeros_like(r)]
                y[moved][axis, node] += sign * step
                sides.append(acceleration(*y))
            expected[n:, column] = (sides[0] - sides[1]) / (2.0 * step)
    assembled = linearise(strands, 0, r, X).jacobian()
    assert assembled == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())  # (step / h)^2 and cancellation
    found = spectrum(strands, (r, X)).eigenvalues
    own = np.linalg.eigvals(assembled)
    assert max(np.abs(own - value).min() for value in found) < 1e-9 * np.abs(own).max()


def test_kelvin_voigt_damps_longitudinal_modes_in_proportion_to_their_frequency():
    """Exact for a straight chain: ratio c omega / (2 EA) along it, none across it."""
    c = 0.5
    found = spectrum(strand(50, c=c), straight(50))
    across, along = closed_form(50)
    ratio = c * along / (2.0 * CHAIN["axial_stiffness"])
    damped = along * (-ratio + 1j * np.sqrt(1.0 - ratio**2))
    expected = np.concatenate([1j * across, -1j * across, damped, damped.conj()])
    assert max(np.abs(found.eigenvalues - value).min() / abs(value) for value in expected) < 1e-10
    assert found.fastest_damping_ratio == found.largest_damping_ratio == pytest.approx(ratio[-1], rel=1e-12)
    assert found.slowest_damping_ratio == 0.0
    assert np.all(found.eigenvalues.real <= 0.0)  # rounding errors do not make a stable line unstable
    assert (found.character, found.imaginary, found.real_branches) == ("damped", False, False)
    assert found.damping_rate == pytest.approx(c * along[-1] ** 2 / CHAIN["axial_stiffness"], rel=1e-12)


def test_strong_kelvin_voigt_damping_gives_real_negative_branches():
    c = 50.0
    found = spectrum(strand(50, c=c), straight(50))
    half = c * closed_form(50)[1][-1] ** 2 / CHAIN["axial_stiffness"] / 2.0
    fastest = -half - np.sqrt(half**2 - closed_form(50)[1][-1] ** 2)
    assert found.eigenvalues[-1] == pytest.approx(fastest, rel=1e-11)
    assert (found.character, found.real_branches) == ("dissipatively stiff", True)
    assert found.fastest_damping_ratio == pytest.approx(half / closed_form(50)[1][-1], rel=1e-12)


def test_drag_gives_every_mode_the_ratio_half_drag_over_frequency():
    drag = 2.0
    found = spectrum(strand(50, drag=drag), straight(50))
    frequencies = np.concatenate(closed_form(50))
    expected = -drag / 2.0 + 1j * np.sqrt(frequencies**2 - drag**2 / 4.0)
    upper = found.eigenvalues[found.eigenvalues.imag > 0.0]
    assert np.sort(upper.imag) == pytest.approx(np.sort(expected.imag), rel=1e-11)
    assert np.all(upper.real == -drag / 2.0)
    assert found.slowest_damping_ratio == pytest.approx(drag / 2.0 / frequencies.min(), rel=1e-11)
    assert found.fastest_damping_ratio == pytest.approx(drag / 2.0 / frequencies.max(), rel=1e-11)
    assert found.stable_step == pytest.approx(2.0 / frequencies.max(), rel=1e-11)  # drag costs no steps


def test_strong_drag_stops_slow_modes_but_is_not_stiff():
    found = spectrum(strand(50, drag=20.0), straight(50))
    omega = closed_form(50)[0][0]
    assert (found.character, found.real_branches) == ("damped", True)
    assert found.smallest_eigenvalue == pytest.approx(omega**2 / (10.0 + np.sqrt(100.0 - omega**2)), rel=1e-11)


SAGGING = {
    "undamped": {},
    "drag": {"drag": 0.3},
    "light": {"c": 5.0, "drag": 0.3},
    "heavy drag": {"c": 5.0, "drag": 400.0},
    "near critical": {"c": 130.0},
    "strong": {"c": 500.0, "drag": 1.0},
}


@pytest.mark.parametrize("damping", SAGGING.values(), ids=SAGGING)
@pytest.mark.parametrize("dim", [2, 3])
def test_iteration_and_dense_solver_agree(damping, dim):
    strands, at = hanging(60, 22.0, 20.0, 1.0, 1e5, dim, rise=1.0, **damping)
    whole, ends = spectrum(strands, at), spectrum(strands, at, how_many=4)
    assert (whole.complete, ends.complete) == (True, False)
    # the slowest eigenvalues suffer most from the rounding of the dense solver
    tolerance = 1e-8
    for value in ends.eigenvalues:
        assert np.abs(whole.eigenvalues - value).min() < tolerance * abs(value)
    # None is left out: as many slow ones as asked for, and the same ones.
    slow = np.abs(whole.eigenvalues[:8])
    assert np.abs(ends.eigenvalues[:8]) == pytest.approx(slow, rel=tolerance)
    for name in ("lowest_frequency", "highest_frequency", "slowest_damping_ratio", "fastest_damping_ratio"):
        assert getattr(ends, name) == pytest.approx(getattr(whole, name), rel=tolerance, abs=1e-15)
    for name in ("smallest_eigenvalue", "largest_eigenvalue", "damping_rate", "stable_step", "largest_damping_ratio"):
        assert getattr(ends, name) == pytest.approx(getattr(whole, name), rel=tolerance)
    assert ends.character == whole.character


def test_creeping_modes_are_found_where_damping_is_so_strong_that_they_are_the_slowest():
    strands, at = hanging(60, 22.0, 20.0, 1.0, 1e5, rise=1.0, c=5e4)
    whole, ends = spectrum(strands, at), spectrum(strands, at, how_many=4)
    assert whole.smallest_eigenvalue == pytest.approx(1e5 / 5e4, rel=2e-6)  # k / c, up to mass
    assert ends.smallest_eigenvalue == pytest.approx(whole.smallest_eigenvalue, rel=1e-6)
    assert ends.largest_eigenvalue == pytest.approx(whole.largest_eigenvalue, rel=1e-9)


@pytest.mark.parametrize("seed", [0, 1])
def test_the_fastest_decay_is_found_where_it_is_that_of_a_few_links(seed):
    """A table of two slopes: stiff links lie beside links in which the damping prevails."""
    law = [2.0, 4.0, -1.0, 0.0, 0.05, 1.0, -1e3, 0.0, 1e3, 5e4]
    r, X = straight(51, stretch=1.05)
    r += 0.04 * np.random.default_rng(seed).standard_normal(r.shape)
    strands = strand(51, law=law, c=30.0)
    whole, ends = spectrum(strands, (r, X)), spectrum(strands, (r, X), how_many=1)
    assert ends.largest_eigenvalue == pytest.approx(whole.largest_eigenvalue, rel=1e-9)


@pytest.mark.parametrize(
    ("squared", "symmetric"), [(1.0, 1.04020048680914), (10.0, 1.34512451139044), (100.0, 2.5971845)]
)
def test_slow_frequencies_of_a_flat_cable_are_those_of_irvine_and_caughey(squared, symmetric):
    """Irvine and Caughey (1974): out of plane n pi, antisymmetric 2 n pi, symmetric from tan x = x - (4/lam^2) x^3."""
    span, rho, g, flatness = 100.0, 1.0, 10.0, 0.02  # flatness: weight over horizontal force
    H = rho * g * span / flatness
    EA = squared * H * (1.0 + flatness**2 / 8.0) / flatness**2

    def reach(length):
        return H * length / EA + 2.0 * H / (rho * g) * np.arcsinh(rho * g * length / (2.0 * H))

    length = brentq(lambda x: reach(x) - span, 0.5 * span, 1.5 * span, xtol=1e-13)
    strands, at = hanging(400, length, span, rho, EA, dim=3, g=g)
    found = spectrum(strands, at, how_many=6)
    upper = np.sort(found.eigenvalues.imag[found.eigenvalues.imag > 0.0])[:6]
    expected = np.sort([symmetric, 1.0, 2.0, 2.0, 3.0])
    scaled = upper * span * np.sqrt(rho / H) / np.pi
    near = [np.abs(scaled - value).min() / value for value in expected]
    # the theory is linear in the sag: squares of the flatness and strains are left out; mesh: (3 pi / 2 n)^2 / 6
    assert max(near) < 2e-4


@pytest.mark.parametrize("damping", [{}, {"drag": 3.0}, {"c": 50.0}, {"c": 50.0, "drag": 1.0}], ids=str)
@pytest.mark.parametrize("dim", [2, 3])
def test_compression_is_reported_as_unstable(damping, dim):
    strands, at = strand(40, dim=dim, **damping), straight(40, stretch=0.999, dim=dim)
    own = np.linalg.eigvals(linearise(strands, 0, *at).jacobian())
    for found in (spectrum(strands, at), spectrum(strands, at, how_many=4)):
        assert found.character == "unstable"
        assert found.unstable == 39 * (dim - 1) == (own.real > 1e-6).sum()  # every transverse mode
        assert found.growth_rate == pytest.approx(own.real.max(), rel=1e-10)
        assert found.smallest_eigenvalue == pytest.approx(np.abs(own).min(), rel=1e-8)
        assert found.eigenvalues.real.max() == pytest.approx(found.growth_rate, rel=1e-10)
        for value in found.eigenvalues:
            assert np.abs(own - value).min() < 1e-8 * abs(value)
    assert (spectrum(strands, at).eigenvalues.real > 1e-6).sum() == found.unstable


@pytest.mark.parametrize("how_many", [None, 3])
@pytest.mark.parametrize("c", [0.0, 3.0])
def test_modes_without_stiffness_are_counted_and_left_out_of_the_ratio(c, how_many):
    """A line exactly at its unstrained length resists along its axis only; a slack one that cannot push not at all."""
    found = spectrum(strand(40, c=c), straight(40, stretch=1.0), how_many=how_many)
    along = 2.0 / 0.5 * np.sqrt(1e4 / 0.1) * np.sin(np.arange(1, 4) * np.pi / 80.0)
    lowest = along[0]
    assert (found.neutral, found.unstable) == (39, 0)
    assert found.lowest_frequency == pytest.approx(lowest, rel=1e-10)
    assert found.smallest_eigenvalue == pytest.approx(lowest, rel=1e-10)
    slow = np.abs(found.eigenvalues[np.abs(found.eigenvalues) > 0.0][:6:2])
    assert slow == pytest.approx(along, rel=1e-9)
    slack = spectrum(strand(40, law=TENSION_ONLY), straight(40, stretch=0.9), how_many=how_many)
    assert (slack.neutral, slack.unstable, slack.highest_frequency) == (78, 0, 0.0)
    assert slack.as_dict()["stable_verlet_step_s"] is None


def test_a_hundred_thousand_links_take_seconds():
    n = 100_000
    spectrum(strand(100), straight(100), how_many=2)  # compiles
    began = time.process_time()
    found = spectrum(strand(n), straight(n))
    assert time.process_time() - began < 30.0  # 2 s on an idle core
    across, along = closed_form(n)
    assert found.lowest_frequency == pytest.approx(across[0], rel=1e-10)
    assert found.highest_frequency == pytest.approx(along[-1], rel=1e-12)
    assert np.abs(found.eigenvalues[:12:2]) == pytest.approx(across[:6], rel=1e-10)
    assert found.unstable == 0


def test_many_damped_links_have_the_closed_form_at_both_ends():
    n, c = 20_000, 0.0005
    found = spectrum(strand(n, c=c), straight(n))
    across, along = closed_form(n)
    ratio = c * along[-1] / 2e4
    # the dense way would lose ten digits here
    assert np.abs(found.eigenvalues[:12:2]) == pytest.approx(across[:6], rel=1e-12)
    assert found.eigenvalues[-1] == pytest.approx(along[-1] * (-ratio + 1j * np.sqrt(1.0 - ratio**2)), rel=1e-12)
    assert found.fastest_damping_ratio == pytest.approx(ratio, rel=1e-12)


def test_a_mode_that_the_iteration_leaves_out_is_noticed(monkeypatch):
    calls = []

    def forgetful(operator, k, **options):
        calls.append(k)
        if len(calls) > 1:
            return eigenvalues.eigsh_of_scipy(operator, k, **options)
        mu, shapes = eigenvalues.eigsh_of_scipy(operator, k + 1, **options)
        others = np.argsort(mu)[[0, *range(2, k + 1)]]
        return mu[others], shapes[:, others]

    monkeypatch.setattr(eigenvalues, "eigsh_of_scipy", eigenvalues.eigsh, raising=False)
    monkeypatch.setattr(eigenvalues, "eigsh", forgetful)
    found = spectrum(strand(50), straight(50), how_many=3)
    assert calls == [3, 3, 3]
    assert np.abs(found.eigenvalues[:6:2]) == pytest.approx(closed_form(50)[0][:3], rel=1e-11)


@pytest.mark.parametrize("c", [0.0, 0.1, 2.0, 50.0])
def test_the_verlet_method_is_stable_up_to_the_stable_step_and_not_beyond(c):
    """The kernel itself, with the fastest mode excited a little."""
    links = 20
    strands = strand(links, c=c)
    r, X = straight(links)
    limit = spectrum(strands, (r, X)).stable_step
    shape = np.zeros_like(r)
    shape[0, 1:-1] = 1e-7 * (-1.0) ** np.arange(1, links) * np.sin(np.pi * np.arange(1, links) / links)

    def amplitude(step):
        none, whole = np.zeros(0), np.zeros(0, dtype=np.int64)
        loads = Loads(
            *4 * [whole], none, whole, whole, none, none, none, whole, whole, none, np.zeros((2, 0)), none, whole
        )
        state = ChainState(
            np.zeros(1), r + shape, np.zeros_like(r), X.copy(), none, none.copy(), whole, none.copy(), np.zeros(4)
        )
        status, steps = advance(
            strands,
            loads,
            state,
            ChainBuffers.for_state(state),
            *VERLET,
            Stops.to(600 * step),
            step * (1 + 1e-9),
            10**6,
        )
        assert (status, steps) == (RUNNING, 600)
        return np.abs(state.r - r).max() / 1e-7

    assert amplitude(0.995 * limit) < 5.0
    assert amplitude(1.01 * limit) > 20.0


def random_chain(data):
    links = data.draw(st.integers(2, 6))
    dim = data.draw(st.sampled_from([2, 3]))
    return links, dim, *wavy(links, data.draw(st.integers(0, 10**6)), dim)[:2]


@settings(max_examples=25, deadline=None)
@given(st.data(), st.floats(0.01, 100.0), st.floats(0.01, 100.0))
def test_eigenvalues_scale_with_the_root_of_stiffness_over_mass(data, k, rho):
    links, dim, r, X = random_chain(data)
    base = spectrum(strand(links, dim=dim), (r, X)).eigenvalues
    law = [0.0, NO_FLOOR, 1e4 * k, 0.0, 0.0]
    scaled = spectrum(strand(links, rho=0.1 * rho, law=law, dim=dim), (r, X)).eigenvalues
    assert scaled**2 == pytest.approx(base**2 * k / rho, abs=1e-12 * np.abs(scaled[-1]) ** 2)


@settings(max_examples=25, deadline=None)
@given(st.data(), st.floats(0.0, 10.0))
def test_a_rotation_of_the_line_leaves_its_spectrum(data, c):
    links, dim, r, X = random_chain(data)
    matrix = Rotation.random(rng=data.draw(st.integers(0, 1000))).as_matrix()
    space = np.zeros((3, links + 1))
    space[[0, -1]] = r[[0, -1]]
    if dim == 3:
        space[1] = r[1]
    base = spectrum(strand(links, c=c, dim=3), (space, X))
    turned = spectrum(strand(links, c=c, dim=3), (matrix @ space, X))
    size = base.largest_eigenvalue
    assert np.poly(turned.eigenvalues / size) == pytest.approx(np.poly(base.eigenvalues / size), abs=1e-9)
    assert (turned.unstable, turned.neutral) == (base.unstable, base.neutral)
